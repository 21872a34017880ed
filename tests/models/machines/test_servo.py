"""A joint under a motor, with delay and saturation, and with friction that depends on torques: closed forms, and published models."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from rows import each_row

DATA = Path(os.environ.get("STICKSLIP_DATA", "")) / "bam"
ONE, J = ss.Coulomb(1.0, 1.0), 0.02
MOTOR = ss.machines.Motor(k_t=1.5, resistance=5.0, supply=12.0)
DRY = ss.machines.ServoLoad(base=0.1, viscous=0.05)


def test_no_load_speed_and_the_saturated_supply():
    """k_t (U - k_t w)/R = c w + F; 100 V are no more than the supply's 12 V, nor is a limit of 6 V more than 6 V."""
    for command, limit, U in ((9.0, None, 9.0), (100.0, None, 12.0), (-100.0, None, -12.0), (100.0, 6.0, 6.0)):
        joint = ss.Joint(inertia=J, friction=ONE, load=DRY, motor=MOTOR, voltage=command, limit=limit)
        speed = ss.solve(joint, duration=4.0).v[-1]
        assert speed == pytest.approx((1.5 * U / 5.0 - np.sign(U) * 0.1) / (1.5**2 / 5.0 + 0.05), rel=1e-12)


def test_a_stalled_motor_and_one_whose_terminals_are_joined():
    """It breaks away at the voltage whose stall torque is the friction; and the back-EMF damps as k_t^2/R."""
    sine = ss.drives.HarmonicForce(4.0, omega=2.0)
    run = ss.solve(ss.Joint(inertia=J, friction=ONE, load=DRY, motor=MOTOR, voltage=sine), periods=1)
    assert run.events[0].t == pytest.approx(np.arcsin(0.1 / (1.5 / 5.0) / 4.0) / 2.0, rel=1e-12)
    t, damping = 0.05, 1.5**2 / 5.0 + 0.05
    short = ss.solve(ss.Joint(inertia=J, friction=ONE, load=DRY, motor=MOTOR), duration=t, start=dict(v={"joint": 3.0}))
    assert short.v[-1] == pytest.approx((3.0 + 0.1 / damping) * np.exp(-damping * t / J) - 0.1 / damping, rel=1e-12)


def test_drive_and_back_drive_efficiency_of_a_gear():
    """Under N = mu |tau_m - tau_e| a weight W is lifted from W (1 + mu)/(1 - mu) on, and sinks below W (1 - mu)/(1 + mu)."""
    mu, W = 0.2, 0.5
    gear = ss.machines.ServoLoad(base=0.0, motor=mu, external=mu)
    for phase, ratio, side in ((np.pi / 6, (1 + mu) / (1 - mu), 1), (5 * np.pi / 6, (1 - mu) / (1 + mu), -1)):
        ramp = ss.drives.HarmonicForce(2 * W, omega=1.0, phase=phase)  # it begins at W and rises, or falls
        joint = ss.Joint(inertia=J, friction=ONE, load=gear, torque=ramp, gravity_torque=W, angle=np.pi / 2)
        run = ss.solve(joint, duration=1.0)
        breaks = np.arcsin(ratio / 2) if side > 0 else np.pi - np.arcsin(ratio / 2)
        assert run.events[0].t == pytest.approx(breaks - phase, rel=1e-12) and np.sign(run.v[-1]) == side


def test_a_delayed_command_is_that_of_earlier():
    """A sine that comes a quarter of a period later; and samples that act two of them later, against the judge."""
    late = ss.Joint(inertia=J, friction=ONE, load=DRY, torque=ss.drives.HarmonicForce(1.0, omega=4.0, phase=0.0), delay=np.pi / 8)
    turned = late.replace(torque=ss.drives.HarmonicForce(1.0, omega=4.0, phase=-np.pi / 2), delay=0.0)
    ends = [ss.solve(joint, periods=2).v[-1] for joint in (late, turned)]
    assert ends[0] == pytest.approx(ends[1], abs=1e-12 * 20.0)
    control = ss.machines.PID(kp=30.0, ki=5.0, kd=0.0, target=ss.Harmonic(amplitude=0.8, frequency=0.5), sample=0.02)
    joint = ss.Joint(inertia=J, friction=ONE, load=DRY, motor=MOTOR, gravity_torque=0.5, delay=0.04, control=control)
    run, judged = ss.solve(joint, periods=1), ss.solve(joint, periods=1, method="dop853", rtol=1e-11)
    assert joint.mechanics.controllers.states == (("torque", "integral", "error", "queued 1", "queued 2"),)
    np.testing.assert_allclose(run.v[-1], judged.v[-1], rtol=0, atol=1e-9 * abs(run.v).max())
    assert ss.Joint.from_toml(joint.to_toml()) == joint and abs(ss.energy(run).residual).max() < 1e-10


@each_row(
    "given, said",
    [
        (dict(voltage=3.0), "motor=ss.machines.Motor(k_t=1.5, resistance=5.0)"),
        (dict(motor=MOTOR, torque=1.0), "type voltage="),
        (dict(motor=MOTOR, current=1.0), "a motor without a resistance"),
        (dict(delay=0.01, control=ss.machines.PID(2.0, 0.0, 0.1, 0.5)), "sample=1e-3"),
        (dict(delay=0.015, control=ss.machines.PID(2.0, 0.0, 0.1, 0.5, sample=0.01)), "not a whole number of samples"),
        (dict(load=lambda t, x, v, forces: abs(forces["torque"])), "forces has no 'torque'"),
        (dict(load=lambda a, b, c, d, e: 1.0), "of t, x, v and forces"),
        (dict(load=lambda t, x: 1.0, load_gain=0.1), "leave load_gain out"),
        (dict(motor=3.0), "allowed is a Motor"),
    ],
    ["no motor", "torque", "current", "continuous", "half a sample", "unknown force", "five arguments", "two loads", "no motor at all"],
)
def test_a_joint_that_contradicts_itself_is_refused(given, said):
    with pytest.raises(ss.InputError) as refused:
        ss.Joint(inertia=0.01, friction=ss.Coulomb(0.1, 0.1), **given)
    assert said in str(refused.value)


@pytest.mark.slow
def test_friction_of_the_torque_is_fitted_from_a_log_of_torque_and_angle():
    """The recorded torque is the motor's in the load; six numbers, each in its interval widened by half, from other ones."""
    load, sine = ss.machines.ServoLoad(base=0.05, viscous=0.02, motor=0.15, external=0.15), ss.drives.HarmonicForce(1.2, omega=3.0)
    true = ss.Joint(inertia=0.02, friction=ONE, load=load, torque=sine, gravity_torque=0.6)
    run, draw = ss.solve(true, periods=4), np.random.default_rng(0)
    t = np.arange(0, run.t[-1], 2e-3)
    angle, torque = np.interp(t, run.t, run.x) + draw.normal(0, 2e-5, len(t)), sine.at(t % sine.period) + draw.normal(0, 5e-3, len(t))
    log = ss.Record.of(t, {"q [rad]": angle, "tau [N m]": torque}, roles={"q": "position", "tau": "force"})
    other = true.replace(torque=0.0, inertia=0.03, load=load.replace(base=0.1, viscous=0.05, motor=0.05, external=0.05))
    truth = {"inertia": 0.02, "gravity_torque": 0.6, "load.base": 0.05, "load.viscous": 0.02, "load.motor": 0.15, "load.external": 0.15}
    fit = ss.identify(
        log, other, free={name: (0.2 * value, 5.0 * value) for name, value in truth.items()}, sensor={"offset": None}, starts=4
    )
    for name, value in truth.items():
        low, high = fit.interval(name)
        assert abs(value - 0.5 * (low + high)) < 0.75 * (high - low) < 0.1 * value, name


# ---- published models ----
def published(p, q, v, motor, external):
    """Friction of Duclusaud et al. (2024) as their library has it, in floats of its own."""
    s = np.exp(-(abs(v / p.get("dtheta_stribeck", 1.0)) ** p.get("alpha", 1.0))) if "alpha" in p else 0.0
    F = p["friction_base"] + s * p.get("friction_stribeck", 0.0)
    for part, weight in (("", 1.0), ("_stribeck", s)):
        both = p.get("load_friction_base" if not part else "load_friction_stribeck", 0.0)
        of = (p.get(f"load_friction_{side}{part}", both) for side in ("external", "motor"))
        F += weight * abs(next(of) * external - next(of) * motor)
    if external * motor < 0:
        F += s * (p.get("load_friction_external_quad", 0.0) * external**2 if abs(external) < abs(motor) else 0.0)
        F += s * (p.get("load_friction_motor_quad", 0.0) * motor**2 if abs(external) > abs(motor) else 0.0)
    return F + p["friction_viscous"] * abs(v)


def pendulum(p, inertia, G, torque, end):
    """The published pendulum by SciPy and short code of its own: sliding until v = 0, resting until the net torque is the friction."""
    from scipy.integrate import solve_ivp
    from scipy.optimize import brentq

    net = lambda t, q, v: torque(t, v) - G * np.sin(q)  # noqa: E731
    bears = lambda t, q: published(p, q, 0.0, torque(t, 0.0), -G * np.sin(q)) - abs(net(t, q, 0.0))  # noqa: E731
    t, q, v, side = 0.0, 0.3, 0.0, 0
    while t < end:
        if side == 0:
            times = np.linspace(t, end, 2001)
            first = next((k for k, at in enumerate(times) if bears(at, q) < 0), None)
            if first is None:
                break
            t = brentq(bears, times[first - 1], times[first], (q,), xtol=1e-14, rtol=1e-14) if first else t
            side = int(np.sign(net(t, q, 0.0)))

        def rates(t, y, side=side):
            return y[1], (net(t, *y) - side * published(p, y[0], y[1], torque(t, y[1]), -G * np.sin(y[0]))) / inertia

        stop = lambda at, y, side=side, begun=t: side * y[1] if at > begun + 1e-6 else 1.0  # noqa: E731
        stop.terminal, stop.direction = True, -1
        run = solve_ivp(rates, (t, end), (q, 0.0), "DOP853", rtol=1e-11, atol=1e-12, events=stop, max_step=0.02)
        t, q, v, side = run.t[-1], run.y[0, -1], run.y[1, -1], 0
    return q, v


@pytest.mark.skipif(not DATA.is_dir(), reason="STICKSLIP_DATA has no folder bam")
@each_row("model", ["m1", "m2", "m3", "m4", "m5", "m6"])
def test_the_published_friction_models_of_a_servo(model):
    """MX-106 with a pendulum under 8 V of 0.4 Hz: the joint, and the published equations in SciPy."""
    p = json.loads((DATA / f"mx106_{model}.json").read_text())
    load, motor = ss.machines.ServoLoad.from_bam(p), ss.machines.Motor(k_t=p["kt"], resistance=p["R"])
    inertia, G, w = p["armature"] + 0.5 * 0.15**2, 0.5 * 9.81 * 0.15, 2 * np.pi * 0.4
    sine = ss.drives.HarmonicForce(8.0, omega=w)
    joint = ss.Joint(inertia=inertia, friction=ONE, load=load, motor=motor, voltage=sine, gravity_torque=G, angle=0.3)
    run = ss.solve(joint, duration=4.0)
    q, v = pendulum(p, inertia, G, lambda t, v: p["kt"] / p["R"] * (8.0 * np.sin(w * t) - p["kt"] * v), 4.0)
    assert len(run.events) >= 3 and (run.x[-1], run.v[-1]) == (pytest.approx(q, abs=1e-10), pytest.approx(v, abs=1e-10))


@pytest.mark.skipif(not DATA.is_dir(), reason="STICKSLIP_DATA has no folder bam")
def test_all_parameter_sets_are_read_and_written():
    """37 sets: the load at some state is that of the published formula, before and after to_bam, and what is written is what was read."""
    sets = sorted(DATA.glob("*.json"))
    for path in sets:
        p = json.loads(path.read_text())
        load = ss.machines.ServoLoad.from_bam(p)
        written = load.to_bam()
        assert written == {name: p[name] for name in written}, path.name
        for one in (load, ss.machines.ServoLoad.from_bam(load.to_bam())):
            for v, motor, external in ((0.4, 0.3, -0.7), (-1.5, 0.9, -0.2), (0.1, 0.5, 0.4)):
                value = one(0.0, 0.0, v, {"motor": motor, "gravity": external})
                assert value == pytest.approx(published(p, 0.0, v, motor, external), rel=1e-13), path.name
    assert len(sets) == 37
