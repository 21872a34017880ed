"""Every solve ends: with its motion, or with a sentence that says where it stopped."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from pairs import each_once
from problems import chain
from rows import each_row
from stickslip.basics.status import STATUS, Status
from stickslip.maths import maximum, minimum, where
from stickslip.solvers import stepping
from stickslip.solvers.stopped import Changes, location


@dataclass(frozen=True, eq=False)
class Pulled(ss.Machine):
    """A body of 1 kg on a spring and a damper, far from the spring's zero, pulled by a force that grows with time."""

    friction: Any
    stiffness: float
    rate: float
    start: float = 0.5
    time_scale = 0.1

    def bodies(self):
        rest = self.start + 0.2 / self.stiffness  # at the start the spring pulls with all that static friction bears
        damping = 2.0 * self.stiffness**0.5

        def force(t, x, v):
            return self.stiffness * (rest - x) + self.rate * t - damping * v

        return {"body": ss.Body(1.0, force=force)}

    def contacts(self):
        return {"body": ss.Contact("body", self.friction, load=1.0)}


@each_row(("rate", "stiffness"), each_once([1e-6, 1e-8, 1e-10], [1e3, 1e4]))
def test_a_body_breaks_away_where_rounding_hides_the_sign_of_its_acceleration(stiffness, rate):
    # m x'' + c x' + k (x - x0) = rate t after break-away at t = 0, c = 2 sqrt(k m): after the transient x lags the force by c/k
    T = 10.0
    run = ss.solve(Pulled(ss.Coulomb(0.2, 0.2), stiffness, rate), duration=T, start={"x": {"body": 0.5}})
    moved = rate / stiffness * (T - 2.0 / stiffness**0.5)
    # the position has an ulp of 1.1e-16, and break-away is later by what the spring's rounding, 0.5 ulp * k, is of the rate of the force
    assert run.x[-1] - 0.5 == pytest.approx(moved, abs=4e-16)
    assert len(run.events) == 1 and run.counts["steps"] < 2000


class MotorPID:
    """A PID controller of a motor's position through the current of the motor, with a limited voltage."""

    states, sample, scales = ("integral", "current"), None, (1.0, 1.0)

    def __init__(self, joint):
        self.joint = joint

    def start(self, t, x, v):
        return (0.0, 0.0)

    def rates(self, t, x, v, z):
        error = self.joint.target - x["motor"]
        volts = maximum(minimum(40.0 * error + 60.0 * z[0] - 0.5 * v["motor"], 24.0), -24.0)
        return (error, (volts - z[1] - 0.5 * v["motor"]) / self.joint.inductance)

    def sampled(self, t, x, v, z):
        return z

    def forces(self, t, x, v, z):
        return {"motor": 0.5 * z[1]}


@dataclass(frozen=True, eq=False)
class ServoJoint(ss.Machine):
    """Two inertias with a flexible shaft between them, friction on both."""

    motor: Any
    load: Any
    inductance: float = 0.005
    target: float = 0.5
    time_scale = 0.1

    def bodies(self):
        return {"motor": ss.Body(0.01), "load": ss.Body(0.05)}

    def links(self):
        return {("motor", "load"): ss.Spring(50.0, 0.02, cubic=200.0)}

    def contacts(self):
        return {"motor": ss.Contact("motor", self.motor, load=1.0), "load": ss.Contact("load", self.load, load=1.0)}

    def controllers(self):
        return {"pid": MotorPID(self)}


def test_a_servo_joint_settles_to_its_target_in_few_steps():
    friction = [ss.Stribeck(mu, mu, f, f, v_s=0.1) for mu, f in ((0.05, 0.08), (0.1, 0.18))]
    run = ss.solve(ServoJoint(*friction), duration=20.0)
    # the integral of the error brings the motor to its target; the load rests where the shaft's torque is within its static friction
    assert run.status == "finished" and abs(run.x[-1, 0] - 0.5) < 1e-9
    twist = run.x[-1, 1] - run.x[-1, 0]
    assert abs(50.0 * twist + 200.0 * twist**3) <= 0.18 * (1 + 1e-6)
    assert run.counts["steps"] < 5000 and run.counts["rejected"] < run.counts["steps"] / 10


@pytest.mark.slow
def test_scipy_settles_the_servo_joint_alike():
    friction = [ss.Stribeck(mu, mu, f, f, v_s=0.1) for mu, f in ((0.05, 0.08), (0.1, 0.18))]
    ours, judged = (ss.solve(ServoJoint(*friction), duration=12.0, **given) for given in ({}, {"method": "dop853", "rtol": 1e-10}))
    assert len(ours.events) == len(judged.events)
    np.testing.assert_allclose(ours.x[-1], judged.x[-1], rtol=0, atol=1e-12)


@dataclass(frozen=True, eq=False)
class Relay(ss.Machine):
    """A body under bang-bang control along x + lead v: a sliding mode, which no event can leave."""

    gain: float
    lead: float = 1.0
    friction: Any = ss.Coulomb(0.01, 0.01)  # noqa: RUF009
    time_scale = 0.5

    def bodies(self):
        return {"cart": ss.Body(1.0, force=lambda t, x, v: -self.gain * where(x + self.lead * v > 0, 1.0, -1.0))}

    def contacts(self):
        return {"cart": ss.Contact("cart", self.friction, load=1.0)}


@pytest.mark.parametrize("method", ["auto", "dop853"])
def test_a_relay_that_chatters_ends_with_its_instant_its_contact_and_its_slip(method):
    # from x = 0.3 at rest with -(gain + friction) it arrives at x + v = 0 where 0.3 - a t^2/2 = a t, with a = gain - friction
    a = 2.0 - 0.01
    t = np.sqrt(1.0 + 0.6 / a) - 1.0
    with pytest.raises(ss.SolveError, match=r"where contact 'cart' .* slip velocity is .*tanh") as error:
        ss.solve(Relay(2.0), duration=5.0, start={"x": {"cart": 0.3}}, method=method)
    told = str(error.value)
    assert error.value.status == Status.CHATTERS and STATUS[Status.CHATTERS] in told
    assert f"at t = {t:.6f}" in told and f"slip velocity is {-a * t:.5f}" in told


def test_a_case_that_chatters_is_a_status_and_the_others_are_right():
    gains = np.array([0.0, 2.0, 0.0, 3.0, 0.005])
    found = ss.solve(Relay(gains), duration=2.0, start={"x": {"cart": 0.3}, "v": {"cart": 0.1}})
    assert found.status.tolist() == [0, 9, 0, 9, 0]
    assert STATUS[9] in found.status_counts
    # without a relay the body stops at once: 0.1 m/s against 0.01 m/s^2 lasts 10 s, so that it moves v t - mu t^2/2
    expected = 0.1 * 2.0 - 0.01 * 2.0**2 / 2
    np.testing.assert_allclose(found.displacement[[0, 2]], expected, rtol=1e-12)
    assert np.isnan(found.mean_velocity[[1, 3]]).all()
    alone = ss.solve(Relay(0.005), duration=2.0, start={"x": {"cart": 0.3}, "v": {"cart": 0.1}}, keep="summary")
    assert found.displacement[4] == alone.displacement


@pytest.mark.parametrize("method", ["auto", "dop853"])
def test_a_batch_says_at_which_instant_contact_and_slip_a_case_ended(method):
    gains = np.array([0.0, 2.0, 3.0])
    found = ss.solve(Relay(gains), duration=2.0, start={"x": {"cart": 0.3}, "v": {"cart": 0.1}}, method=method)
    assert list(found.failures) == [(1,), (2,)] and "2 of 3 cases, the first of them case 1: the run stopped at t" in found.notes[0]
    for (case,), sentence in found.failures.items():
        # it goes on against gain + friction for 0.1/a, and back with gain - friction until x + v = 0
        slower, faster = gains[case] - 0.01, gains[case] + 0.01
        back = np.sqrt(1.0 + 2.0 * (0.3 + 0.005 / faster) / slower) - 1.0
        t, slip = (float(re.search(pattern, sentence)[1]) for pattern in (r"at t = (\S+) s", r"slip velocity .*?is (\S+) m/s"))
        assert [t, slip] == pytest.approx([0.1 / faster + back, -slower * back], rel=1e-8) and "contact 'cart'" in sentence


def test_statuses_and_results_do_not_depend_on_how_often_a_kernel_returns(monkeypatch):
    from stickslip.engine import lanes

    gains, run = np.array([0.0, 2.0, 0.005]), lanes.run
    whole = ss.solve(Relay(gains), duration=2.0, start={"x": {"cart": 0.3}})
    monkeypatch.setattr(lanes, "run", lambda *given, **named: run(*given, **{**named, "slice_calls": 7}))
    parts = ss.solve(Relay(gains), duration=2.0, start={"x": {"cart": 0.3}})
    assert whole.status.tolist() == parts.status.tolist() == [0, 9, 0]
    assert whole.displacement.tobytes() == parts.displacement.tobytes()


def test_a_budget_of_steps_ends_a_run_with_the_instant_it_has_reached(monkeypatch):
    monkeypatch.setattr(stepping, "BUDGET_APERIODIC", 50)
    with pytest.raises(ss.SolveError, match=r"at t = \d.* slip velocity is .*step budget used up") as error:
        ss.solve(replace(Pulled(ss.Coulomb(0.2, 0.2), 1e4, 1e-6)), duration=10.0, start={"x": {"body": 0.5}})
    assert error.value.status == Status.BUDGET


def test_the_judge_has_a_budget_of_steps_too(monkeypatch):
    from stickslip.solvers.plain import marching

    monkeypatch.setattr(marching, "_LEAST", 20)
    monkeypatch.setattr(marching, "_STEPS", 1)
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb")
    with pytest.raises(ss.SolveError, match=r"at t = .* contact .* slip velocity is .*step budget used up.*radau"):
        ss.solve(robot, periods=20, method="dop853")
    found = ss.solve(robot, periods=20, method="dop853", keep="summary")
    assert found.status == Status.BUDGET and found.notes == [found.failures[()]]


def test_the_contact_that_switches_most_is_named(monkeypatch):
    from stickslip.models.machine_adapter import machine_of

    mechanics = machine_of(ServoJoint(ss.Coulomb(0.1, 0.1), ss.Coulomb(0.1, 0.1))).mechanics
    told = location(mechanics, 0.5, [0.1, 0.2], Changes.of(np.array([[1, 0], [1, -1], [1, 0], [0, -1]])))
    assert told == "at t = 0.5 s, where contact 'load' has changed its mode 3 times in 4 steps and its slip velocity is 0.2 m/s"
    # alone and in a batch, of what has used up its budget while modes changed all the time
    monkeypatch.setattr(stepping, "BUDGET", 5)
    pair, words = chain(0.0, 0.3), STATUS[Status.CHATTERS]
    with pytest.raises(ss.SolveError, match=re.escape(words)) as alone:
        ss.solve(pair, periods=300)
    both = ss.solve(pair.replace({"phases.1": np.array([0.3, 0.3])}), periods=300)
    assert both.status_counts == {words: 2} and both.failures[(1,)] == str(alone.value) and "times in 1000 steps" in both.failures[(0,)]


@pytest.mark.parametrize("quadratic", [0.0, 2.0])
def test_what_only_oil_brakes_decays_as_the_closed_form_says_where_the_drive_is_off(quadratic):
    # m v' = -c v - d v^2 from v0: v = r v0 / (r + d v0 (1 - r)/c), with r = exp(-c t/m); the position is the logarithm of the same
    c, m, v0 = 1.5, 1.1, 2.0
    oil = ss.Viscous(c, c, quadratic, quadratic)
    robot = ss.Robot(body_mass=1.0, inner_mass=0.1, drive=ss.Harmonic(0.0, 2 * np.pi), friction=oil)
    run, ratio = ss.solve(robot, periods=2, start={"v": v0}), quadratic * v0 / c
    r = np.exp(-c * run.t[-1] / m)
    x = m / quadratic * np.log1p(ratio * (1 - r)) if quadratic else m * v0 / c * (1 - r)
    # a step leaves out terms of 1e-16 of 1 pm/s and rounds some 17 terms of its polynomial: 1e-14 over the few dozen steps
    np.testing.assert_allclose([run.v[-1], run.x[-1]], [r * v0 / (1 + ratio * (1 - r)), x], rtol=1e-14)
    assert run.counts["steps"] < 200
