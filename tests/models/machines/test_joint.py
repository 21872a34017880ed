"""Joints: hunting, the stick band, compensation, backlash, sampled control; each against a computation of another kind."""

from __future__ import annotations

import dataclasses
import itertools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stickslip as ss
from rows import each_row
from stickslip.basics.fields import leaves

J, FK, FS = 0.01, 0.02, 0.03
DRY, EVEN = ss.Coulomb(FK, FK, f_plus=FS, f_minus=FS), ss.Coulomb(FK, FK)
GAINS = {"kp": 2.0, "ki": 4.0, "kd": 0.1}
HUNTING = ss.Joint(inertia=J, friction=DRY, control=ss.machines.PID(**GAINS, target=0.5))
SWING = ss.Harmonic(amplitude=0.3, frequency=0.5)


def plain_hunting(end: float, Fs: float, kp: float = 2.0, ki: float = 4.0, kd: float = 0.1, target: float = 0.5):
    """A PID controlled inertia with dry friction: rest in closed form, slides by DOP853. The state at the end and all rests."""
    t, y, rests = 0.0, np.zeros(3), []
    while t < end:
        pull = kp * (target - y[0]) + y[2] - kd * y[1]
        if y[1] == 0.0 and abs(pull) <= Fs * (1 - 1e-15):
            e = target - y[0]
            lasts = (math.copysign(Fs, e) - pull) / (ki * e)
            rests.append((t, e, lasts))
            if t + lasts > end:
                y[2] += ki * e * (end - t)
                break
            t, y[2], side = t + lasts, math.copysign(Fs, e) - kp * e, math.copysign(1.0, e)
        else:
            side = math.copysign(1.0, pull if y[1] == 0.0 else y[1])

        def rates(s, u, side=side):
            return [u[1], (kp * (target - u[0]) + u[2] - kd * u[1] - side * FK) / J, ki * (target - u[0])]

        def turns(s, u, side=side):
            return side * u[1]

        turns.terminal, turns.direction = True, -1
        slide = solve_ivp(rates, (t, end), y, method="DOP853", rtol=1e-12, atol=1e-15, events=turns)
        t, y = slide.t[-1], slide.y[:, -1].copy()
        if slide.status == 1:
            y[1] = 0.0
    return y, rests


def plain_sampled(end: float, dt: float, Fs: float, kp: float, ki: float, kd: float, target):
    """The same with samples: between them the torque is constant, and arcs are parabolas."""
    q = v = t = total = 0.0
    last = target(0.0)
    for k in range(round(end / dt)):
        e = target(k * dt) - q
        total += ki * dt * e
        u, last, left = kp * e + total + kd * (e - last) / dt, e, dt
        while left > 0.0:
            if v == 0.0:
                if abs(u) <= Fs:
                    break
                v, side = 0.0, math.copysign(1.0, u)
            else:
                side = math.copysign(1.0, v)
            a = (u - side * FK) / J
            stop = -v / a if side * a < 0.0 else math.inf
            step = min(left, stop)
            q, v, left = q + v * step + 0.5 * a * step * step, v + a * step, left - step
            if step == stop:
                v = 0.0
    return q, v, t


def test_hunting_is_that_of_a_plain_computation():
    end = 60.0
    y, rests = plain_hunting(end, FS)
    run = ss.solve(HUNTING, duration=end)
    sticks = [event.t for event in run.events if event.kind == "stick"]
    assert len(rests) > 5 and len(sticks) == len(rests)
    assert np.allclose(sticks, [t for t, *_ in rests], rtol=0, atol=1e-7)  # DOP853 at 1e-12, amplified by a rest's length 2 Fs/(ki e)
    assert abs(run.x[-1] - y[0]) < 1e-8
    assert abs(run.controllers["control"]["integral"][-1] - y[2]) < 1e-8


def test_hunting_is_a_limit_cycle():
    *_, (_, first, _), (_, second, _) = plain_hunting(200.0, FS)[1]
    assert abs(abs(first) - abs(second)) < 1e-3 * abs(second)
    run = ss.solve(HUNTING, duration=200.0, start={"x": {"joint": 0.3}})  # from elsewhere to the same amplitude
    late = run.x[run.t > 150.0] - 0.5
    assert late.max() == pytest.approx(abs(second), rel=2e-3) and late.min() == pytest.approx(-abs(second), rel=2e-3)


def test_equal_static_and_kinetic_friction_does_not_hunt():
    run = ss.solve(HUNTING.replace(friction=EVEN), duration=60.0)
    rests = [abs(0.5 - float(run.at(event.t)["x"])) for event in run.events if event.kind == "stick"]
    assert all(later < 0.9 * before for before, later in itertools.pairwise(rests))
    assert abs(0.5 - run.x[-1]) < 0.2 * max(abs(0.5 - run.x[run.t > 1.0]))


@each_row("start", [-1.0, 0.1, 0.49, 2.0])
def test_without_integral_it_stands_still_within_the_stick_band(start):
    pd = HUNTING.replace({"control.ki": 0.0})
    run = ss.solve(pd, duration=5.0, start={"x": {"joint": start}})
    error = 0.5 - run.x[-1]
    assert run.v[-1] == 0.0 and run.mode[-1] == 0
    assert abs(error) <= FS / 2.0 + 1e-12
    assert run.friction_force[-1] == pytest.approx(2.0 * error, abs=1e-12)


def test_judge_agrees_with_and_without_samples():
    for control in (ss.machines.PID(**GAINS, target=SWING), ss.machines.PID(**GAINS, target=SWING, sample=0.02, feedforward=FK)):
        joint = ss.Joint(inertia=J, friction=DRY, gravity_torque=0.05, control=control)
        exact, judge = ss.solve(joint, periods=3), ss.solve(joint, periods=3, method="dop853", rtol=1e-10)
        t = np.linspace(0.0, 6.0, 301)
        assert np.max(abs(exact.at(t)["x"] - judge.at(t)["x"])) < 1e-9
        assert exact.controllers["control"].states == judge.controllers["control"].states


def test_sampled_control_is_that_of_a_plain_loop():
    gains, dt = {"kp": 2.0, "ki": 4.0, "kd": 0.1}, 0.015625
    for friction, Fs in ((DRY, FS), (EVEN, FK)):
        q, v, _ = plain_sampled(4.0, dt, Fs, **gains, target=lambda t: 0.5)
        run = ss.solve(ss.Joint(inertia=J, friction=friction, control=ss.machines.PID(**gains, target=0.5, sample=dt)), duration=4.0)
        assert abs(run.x[-1] - q) < 1e-12 and abs(run.v[-1] - v) < 1e-11
    q, v, _ = plain_sampled(4.0, dt, FS, **gains, target=SWING.position)
    run = ss.solve(ss.Joint(inertia=J, friction=DRY, control=ss.machines.PID(**gains, target=SWING, sample=dt)), periods=2)
    assert abs(run.x[-1] - q) < 1e-12 and abs(run.v[-1] - v) < 1e-11


@pytest.mark.slow
def test_fast_samples_are_continuous_control():
    def end(sample):
        joint = ss.Joint(inertia=J, friction=EVEN, control=ss.machines.PID(**GAINS, target=SWING, sample=sample))
        return float(ss.solve(joint, periods=1).x[-1])

    whole = end(None)
    errors = [abs(end(dt) - whole) for dt in (1 / 256, 1 / 1024)]
    assert errors[1] < 0.4 * errors[0] < 0.02  # first order: a quarter


def test_samples_and_targets_without_a_common_period_have_a_duration():
    half = ss.Joint(inertia=J, friction=EVEN, control=ss.machines.PID(**GAINS, target=SWING, sample=0.75))
    assert half.period == pytest.approx(6.0) and half.cycles == (3,)
    never = half.replace({"control.sample": math.sqrt(0.5)})
    assert never.period is None and "no period" in never.notes[0]
    run = ss.solve(never, duration=3.0)
    assert np.isfinite(run.x).all()
    with pytest.raises(ss.InputError, match="has no period"):
        ss.solve(never, periods=3)


@pytest.mark.slow
def test_torque_and_target_of_other_periods_come_back_together():
    torque = ss.Joint(
        inertia=J, friction=EVEN, torque=(np.linspace(0.0, 3.0, 61), 0.05 * np.sin(2 * np.pi * np.linspace(0.0, 3.0, 61) / 3.0))
    )
    both = torque.replace(control=ss.machines.PID(kp=0.5, ki=0.0, kd=0.05, target=ss.drives.Trapezoid.example().replace(period=2.0)))
    assert both.period == pytest.approx(6.0) and both.cycles == (2, 3)
    exact, judge = ss.solve(both, periods=2), ss.solve(both, periods=2, method="dop853", rtol=1e-10)
    assert abs(exact.x[-1] - judge.x[-1]) < 1e-8


def test_feedforward_of_friction_reduces_the_tracking_error():
    def error(part):
        run = ss.solve(ss.presets.servo(target=SWING, ki=0.0, kp=5.0, compensation=part, static=1.0), periods=6)
        late = run.t > 4.0
        return float(np.sqrt(np.mean((SWING.position(run.t[late]) - run.x[late]) ** 2)))

    without, half, whole = error(0.0), error(0.5), error(1.0)
    assert whole < 0.5 * half < 0.5 * without


def test_a_stiff_gear_without_backlash_is_a_rigid_one():
    rigid = ss.Joint(inertia=J, friction=DRY, gear_ratio=10.0, motor_inertia=1e-4, control=ss.machines.PID(0.2, 0.0, 0.01, target=SWING))
    elastic = rigid.replace(gear_stiffness=2e4, gear_damping=2.0)
    a, b = ss.solve(rigid, periods=1).x[-1], ss.solve(elastic, periods=1)
    assert abs(a - b.x[-1]) < 1e-4  # a torque of some 0.1 N m winds it up by 5e-6 rad
    assert set(b.bodies) == {"joint", "motor"} and b.x.ndim == 1


@pytest.mark.slow
def test_backlash_makes_a_limit_cycle_that_the_judge_finds_too():
    servo = ss.Joint(
        inertia=J, friction=ss.Coulomb(1e-3, 1e-3), gear_ratio=1.0, motor_inertia=J, backlash=0.02, gear_stiffness=50.0, gear_damping=0.05,
        control=ss.machines.PID(kp=2.0, ki=6.0, kd=0.12, target=0.0), angle=0.0,
    )  # fmt: skip
    run = ss.solve(servo, duration=12.0, start={"x": {"joint": 0.05, "motor": 0.05}})
    assert np.ptp(run.x[run.t > 9.0]) > 0.01
    without = ss.solve(servo.replace(backlash=0.0), duration=12.0, start={"x": {"joint": 0.05, "motor": 0.05}})
    assert np.ptp(without.x[without.t > 9.0]) < 0.2 * np.ptp(run.x[run.t > 9.0])
    short, judge = (
        ss.solve(servo, duration=2.0, start={"x": {"joint": 0.05, "motor": 0.05}}, **how)
        for how in ({}, {"method": "dop853", "rtol": 1e-10})
    )
    t = np.linspace(0.0, 2.0, 101)
    assert np.max(abs(short.at(t)["x"] - judge.at(t)["x"])) < 1e-9


def test_load_that_grows_with_gravity_holds_at_a_steeper_angle():
    """At rest G sin q = F (1 + gain G sin q), so that sin q = F/(G (1 - gain F))."""
    joint = ss.Joint(inertia=J, friction=EVEN, torque=0.0, gravity_torque=0.1, load_gain=10.0)
    last = math.asin(FK / (0.1 * (1 - 10.0 * FK)))
    below, above = (ss.solve(joint.replace(angle=last * part), duration=2.0) for part in (0.999, 1.001))
    assert np.ptp(below.x) == 0.0 and np.ptp(above.x) > 0.0


@pytest.mark.slow
def test_bristles_under_sampled_control_are_the_judges():
    joint = ss.Joint(
        inertia=J, friction=ss.LuGre(FK, FK, FS, FS, sigma0=100.0, sigma1=0.3, sigma2=1e-3, v_s=0.05),
        control=ss.machines.PID(**GAINS, target=SWING, sample=0.05),
    )  # fmt: skip
    lanes, judge = ss.solve(joint, periods=2, rtol=1e-9), ss.solve(joint, periods=2, method="radau", rtol=1e-9)
    assert abs(lanes.x[-1] - judge.x[-1]) < 1e-6 and abs(lanes.v[-1] - judge.v[-1]) < 1e-5


def sampled(**changes):
    base = ss.Joint(inertia=J, friction=EVEN, gravity_torque=0.05, control=ss.machines.PID(**GAINS, target=SWING, sample=0.05))
    return base.replace({name.replace("__", "."): value for name, value in changes.items()})


def test_periodic_orbit_of_a_sampled_joint_has_the_multipliers_of_differences():
    from stickslip.dynamics.derivatives.tangents import jacobian_of
    from stickslip.dynamics.stroboscopic.differences import difference_jacobian

    joint = sampled()
    orbit = ss.periodic_orbit(joint)
    assert np.allclose(jacobian_of(joint, orbit.state), difference_jacobian(joint, orbit.state), rtol=1e-5, atol=1e-7)
    assert abs(orbit.multipliers).max() < 1.0


def test_exponents_of_a_sampled_joint_are_the_logarithms_of_its_multipliers():
    """QR of the tangent in every period against Newton's orbit. What the last sample held is forgotten: the torque or the error."""
    joint = sampled()
    spectrum, multipliers = ss.lyapunov(joint, periods=50).spectrum, abs(ss.periodic_orbit(joint).multipliers)
    kept = multipliers > 1e-12
    assert np.allclose(spectrum[kept], np.log(multipliers[kept]), rtol=1e-6) and np.isneginf(spectrum[~kept]).all() and 0 < kept.sum() < 5
    assert ss.verdict(joint, periods=50, settle=100).kind == "periodic"


def test_the_strobe_point_at_the_end_of_a_run_is_that_of_a_longer_one():
    """A sample that falls on the end of the run is taken, as an impulse is that does."""
    short, long = (ss.solve(sampled(), periods=periods) for periods in (2, 3))
    assert np.allclose(short._strobe_inner[-1], long._strobe_inner[2], rtol=1e-9, atol=1e-12, equal_nan=True)


def ends(joint, name, value, at=None, **how):
    run = ss.solve(joint.replace({name: value}), **how)
    k = -1 if at is None else np.flatnonzero(run.t <= at)[-1]
    return np.array([run.v[k], *(run.controllers["control"][state][k] for state in ("torque", "integral", "error")), run.x[k]])


@each_row("name", ["control.kp", "control.ki", "control.kd", "inertia", "friction.mu_plus", "control.target.amplitude"])
def test_derivatives_of_a_sampled_run_are_those_of_differences(name):
    joint, how = sampled(), {"periods": 3, "at": 4.0}  # after the sample at the end of the second period
    found = ss.dynamics.sensitivity(ss.solve(joint, periods=2), wrt=name)
    value = dict(leaves(joint))[name]
    h = 1e-5 * value
    differences = (ends(joint, name, value + h, **how) - ends(joint, name, value - h, **how)) / (2 * h)
    size = 1e-4 * abs(differences) + 1e-6 * np.max(abs(differences))
    assert found.states == ("v.joint", "torque.control", "integral.control", "error.control", "x.joint")
    assert (abs(np.ravel(found.state) - differences) < size).all()


def test_derivative_by_the_time_between_samples():
    """Samples move with it; nothing else does, as a number for a target has no period."""
    joint = ss.Joint(inertia=J, friction=EVEN, gravity_torque=0.05, control=ss.machines.PID(**GAINS, target=0.5, sample=0.05))
    how, h = {"duration": 0.97}, 1e-7
    found = ss.dynamics.sensitivity(ss.solve(joint, **how), wrt="control.sample")
    differences = (ends(joint, "control.sample", 0.05 + h, **how) - ends(joint, "control.sample", 0.05 - h, **how)) / (2 * h)
    assert np.allclose(np.ravel(found.state), differences, rtol=1e-4, atol=1e-5 * abs(differences).max())


def test_a_period_that_samples_do_not_divide_is_told():
    with pytest.raises(ss.InputError, match="do not repeat after the period"):
        ss.dynamics.sensitivity(sampled(), wrt="control.sample")


def test_batch_and_sweep_are_the_single_runs():
    kps = [1.5, 2.0, 2.5]
    grid = ss.sweep(sampled(), **{"control.kp": kps}, periods=4, settle=2)
    single = [ss.mean_velocity(ss.solve(sampled(control__kp=kp), periods=4, settle=2)) for kp in kps]
    assert np.allclose(grid.mean_velocity.values, single, rtol=1e-9, atol=1e-12)
    assert grid.velocity_max.dims == ("control.kp",)
    times = ss.sweep(sampled(), **{"control.sample": [0.05, 0.04]}, periods=4)
    one = ss.solve(sampled(control__sample=0.04), periods=4, keep="summary")
    assert float(times.velocity_max[1]) == pytest.approx(float(one.velocity_max), rel=1e-9)


def test_energy_of_sampled_control_is_balanced():
    for joint, how in ((sampled(), {"periods": 3}), (HUNTING, {"duration": 5.0})):
        assert ss.energy(ss.solve(joint, **how)).worst < 1e-9


def test_a_run_comes_back_from_its_file(tmp_path):
    run = ss.solve(sampled(), periods=2)
    again = ss.load(run.save(tmp_path / "run.nc"))
    assert again.model == run.model
    assert np.array_equal(again.controllers["control"]["torque"], run.controllers["control"]["torque"])
    assert ss.Joint.from_toml(HUNTING.to_toml()) == HUNTING and ss.Joint.from_toml(sampled().to_toml()) == sampled()


def test_what_is_no_controller_is_told():
    class Cart(ss.Machine):
        def bodies(self):
            return {"cart": ss.Body(1.0)}

        def controllers(self):
            return {"hold": self.part}

    class Hold:
        states, sample, scales = ("force",), None, (1.0,)

        def start(self, t, x, v):
            return 0.0, 0.0

        def rates(self, t, x, v, z):
            return (0.0,)

        def sampled(self, t, x, v, z):
            return z

        def forces(self, t, x, v, z):
            return {"carte": 1.0}

    for part, words in (
        (3.0, ["has no states, no sample"]),
        (
            Hold(),
            ["start gives 2 numbers; allowed is one for each of the states force", "acts on 'carte', which is not a body; did"],
        ),
    ):
        made = dataclasses.dataclass(frozen=True, eq=False)(type("Made", (Cart,), {"part": part}))
        with pytest.raises(ss.InputError) as told:
            made()
        assert all(any(word in problem for problem in told.value.problems) for word in words), told.value


def test_all_that_is_wrong_is_said_at_once():
    with pytest.raises(ss.InputError) as told:
        ss.Joint(inertia=-1.0, friction=DRY, backlash=-0.1, gear_ratio=0.0)
    assert len(told.value.problems) == 3
    for words in ("inertia", "backlash", "gear_ratio"):
        assert any(words in problem for problem in told.value.problems)
    with pytest.raises(ss.InputError) as told:
        ss.machines.PID(kp=-1.0, ki=math.nan, kd=0.1, target="there", sample=0.0, feedback="hand")
    assert len(told.value.problems) >= 4
    with pytest.raises(ss.InputError, match=r"control = .*allowed is a PID; type control=ss\.machines\.PID"):
        ss.Joint(inertia=1.0, friction=DRY, control=lambda t: 1.0)
    with pytest.raises(ss.InputError, match="no at; allowed is a torque"):
        ss.Joint(inertia=1.0, friction=DRY, torque=EVEN)


def test_a_joint_whose_friction_vanishes_at_rest_runs():
    """The size of what its controller holds came from friction at rest alone, was zero, and so were its steps."""
    pid = ss.machines.PID(kp=2.6, ki=3.4, kd=0.2, target=0.155, sample=0.02)
    joint = ss.Joint(inertia=0.015, friction=ss.Viscous(0.0052, 0.0012), control=pid, angle=-0.46)
    judged = ss.solve(joint, duration=0.5, method="dop853", rtol=1e-12)
    assert ss.solve(joint, duration=0.5).x[-1] == pytest.approx(judged.x[-1], abs=1e-10)
