"""The solver in plain Python: every kind of law, of drive and of event, against closed forms."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.maths import where

COULOMB = ss.Coulomb(0.2, 0.2)


def plain(model, **arguments):
    return ss.solve(model, **{"method": "dop853", "rtol": 1e-12, **arguments})


@dataclass(frozen=True)
class Pushed:
    """A mass of 1 kg under the polynomial force sum f_k t^k; its load is 1 + slope t."""

    friction: object
    force: tuple[float, ...] = (0.0,)
    slope: float = 0.0
    velocity_scale: ClassVar[float] = 1.0
    total_mass: ClassVar[float] = 1.0
    time_scale: ClassVar[float] = 1.0
    cyclic: ClassVar[bool] = True
    period: ClassVar[None] = None

    def contact_velocity(self, v):
        return v

    def load(self, t, x):
        return 1.0 + self.slope * t

    def acceleration(self, t, x, v, R):
        return sum(f * t**k for k, f in enumerate(self.force)) - R


# events -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", ["dop853", "radau"])
@each_row("gap", [1e-2, 1e-4, 1e-8])
def test_two_reversals_within_one_step_are_both_found(method, gap):
    """v = (t - 1)^2 - gap without friction: zeros at 1 -+ sqrt(gap), 2e-4 apart for the last."""
    run = plain(Pushed(ss.Coulomb(0.0, 0.0), (-2.0, 2.0)), duration=3.0, start={"v": 1.0 - gap}, method=method)
    assert [(e.kind, e.after) for e in run.events] == [("reversal", -1), ("reversal", 1)]
    assert [e.t for e in run.events] == pytest.approx([1 - math.sqrt(gap), 1 + math.sqrt(gap)], abs=1e-12 / math.sqrt(gap))


@each_row("gap", [1e-4, 1e-10])
def test_a_velocity_that_only_comes_close_to_zero_makes_no_event(gap):
    run = plain(Pushed(ss.Coulomb(0.0, 0.0), (-2.0, 2.0)), duration=3.0, start={"v": 1.0 + gap})
    assert run.events == [] and run.v.min() >= gap * (1 - 1e-4)


@each_row("over", [1e-3, 1e-8, 1e-12])
def test_a_force_that_hardly_exceeds_break_away_is_not_missed(over):
    """The offered force .2 (1 + over) - .2 (t - 1)^2 passes the limit .2 for 2 sqrt(over) seconds only."""
    run = plain(Pushed(COULOMB, (0.2 * over, 0.4, -0.2)), duration=1.5)
    away = 1 - math.sqrt(over)
    assert run.events[0].kind == "slip" and run.events[0].t == pytest.approx(away, abs=1e-15 / math.sqrt(over))
    still = plain(Pushed(COULOMB, (-0.2 * over, 0.4, -0.2)), duration=1.5)
    assert still.events == []


def test_static_friction_holds_longer_than_kinetic():
    """Offered force t, Fs = .5, Fk = .2: v = (t^2 - .25)/2 - .2 (t - .5) from t = .5 on."""
    run = plain(Pushed(ss.Coulomb(0.2, 0.2, f_plus=0.5, f_minus=0.5), (0.0, 1.0)), duration=1.0)
    assert [(e.kind, e.t) for e in run.events] == [("slip", pytest.approx(0.5, rel=1e-15))]
    assert run.v[-1] == pytest.approx(0.5 * 0.75 - 0.1, rel=1e-14)


def test_a_load_that_falls_lets_the_body_go_and_then_ends_the_run():
    """Load 1 - t/2, force .1: break-away where .2 (1 - t/2) = .1; the contact is lost at t = 2."""
    run = plain(Pushed(COULOMB, (0.1,), -0.5), duration=5.0)
    assert [(e.kind, e.t) for e in run.events] == [("slip", pytest.approx(1.0, rel=1e-15)), ("contact lost", pytest.approx(2.0, rel=1e-15))]
    assert run.status == "contact lost: the load fell to zero" and run.t[-1] == run.events[-1].t
    assert run.v[-1] == pytest.approx(0.1 - 0.05, rel=1e-14)  # .1 - .2 (1 - t/2) over the last second


@pytest.mark.parametrize("method", ["dop853", "radau"])
def test_contact_is_lost_under_a_dynamic_law_too(method):
    """There the bristle grows infinitely stiff as the load falls to zero."""
    law = ss.LuGre(0.2, 0.2, 0.3, 0.3, 20.0, 1.0, 0.0, 0.01)
    run = plain(Pushed(law, (1.0,), -0.5), duration=5.0, method=method, rtol=1e-6)
    assert run.lost_contact and run.t[-1] == pytest.approx(2.0, abs=1e-10)
    assert abs(run.at(1.999)["friction_force"]) < 0.01  # it falls with the load, but for the damping of the bristle


def test_contact_lost_while_stuck_and_in_a_batch():
    run = plain(Pushed(COULOMB, (0.0,), -0.5), duration=5.0)
    assert [e.kind for e in run.events] == ["contact lost"] and run.t[-1] == pytest.approx(2.0, rel=1e-15)
    many = plain(Pushed(COULOMB, slope=np.array([-0.5, 0.5])), duration=5.0)
    assert many.status_counts == {"finished": 1, "contact lost: the load fell to zero": 1}
    assert many.motion_type.tolist() == ["unsolved", "rest"]


def test_no_contact_at_the_start_is_said():
    @dataclass(frozen=True)
    class Lifted(Pushed):
        def load(self, t, x):
            return t - 1.0

    with pytest.raises(ss.InputError, match="the load is -1 N at the start, so there is no contact"):
        plain(Lifted(COULOMB), duration=1.0)


# laws -------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Smooth:
    """A dynamic law without inner states."""

    c: float
    states: ClassVar[int] = 0

    def rate(self, v, z, load):
        assert z == ()
        return ()

    def force(self, v, z, zdot, load):
        return self.c * v


@dataclass(frozen=True)
class Holds:
    """It balances whatever else pushes the body."""

    gain: float = 1.0
    states: ClassVar[int] = 0

    def rate(self, v, z, load):
        return ()

    def force(self, v, z, zdot, load, applied):
        return self.gain * applied


@dataclass(frozen=True)
class Odometer:
    """Friction that grows by one step at each whole distance; two memories count the same, one the reversals."""

    step: float
    distance: float
    modes: ClassVar[int] = 3

    def rate(self, v, z, load, mode):
        return abs(v)

    def force(self, v, z, zdot, load, mode):
        return where(v > 0, 1.0, -1.0) * self.step * (1.0 + mode[0]) * load

    def switches(self, v, z, load, mode):
        left = [(1.0 + mode[k]) * self.distance - z for k in (0, 1)]
        return [
            (left[0], (mode[0] + 1, mode[1], mode[2]), None),
            (left[1], (mode[0], mode[1] + 1, mode[2]), None),
            (abs(v), (mode[0], mode[1], mode[2] + 1), None),
        ]


@dataclass(frozen=True)
class Resets:
    """A spring that is cut where it is stretched by `reach`, and begins anew."""

    k: float
    reach: float
    modes: ClassVar[int] = 1
    scalar_only: ClassVar[bool] = True

    def rate(self, v, z, load, mode):
        return v

    def force(self, v, z, zdot, load, mode):
        return self.k * z

    def switches(self, v, z, load, mode):
        return [(self.reach - abs(z), (1 - mode[0],), 0.0)]


def test_a_law_without_states_is_a_smooth_force():
    run = plain(Pushed(Smooth(2.0), (1.0,)), duration=2.0)
    assert run.v == pytest.approx(0.5 * (1 - np.exp(-2 * run.t)), abs=1e-12) and run.z is None


def test_a_law_may_ask_for_the_force_that_holds():
    run = plain(Pushed(Holds(), (1.0, 3.0)), duration=2.0, start={"v": 0.25})
    assert np.all(run.v == 0.25) and run.friction_force == pytest.approx(1 + 3 * run.t, rel=1e-14)
    assert plain(Pushed(Holds(0.5), (1.0,)), duration=2.0).v[-1] == pytest.approx(1.0, rel=1e-13)


def test_memories_switch_where_they_should_also_two_at_one_instant():
    """v dv/dx = -s (1 + n) over each distance d: the energy v^2/2 falls by s d, 2 s d, ..."""
    run = plain(Pushed(Odometer(0.1, 0.3)), duration=1.8, start={"v": 1.0})
    events = [e for e in run.events if e.kind == "switch"]
    times = sorted({round(e.t, 10) for e in events})
    energy, t = 0.5, 0.0
    for n in range(4):
        v, energy = math.sqrt(2 * energy), energy - 0.1 * (1 + n) * 0.3
        t += (v - math.sqrt(2 * energy)) / (0.1 * (1 + n))
        assert times[n] == pytest.approx(t, rel=1e-9)
    assert len(times) == 4 and run.pieces.memory[-1].tolist() == [4, 4, 0]
    assert abs(ss.energy(run).residual).max() < 1e-10


def test_a_switch_on_v_counts_every_reversal():
    """It waits for v = 0 alone: the reversals are those of the force .5 - t, the distances do not count."""
    run = plain(Pushed(Odometer(0.0, 1e9), (0.5, -1.0)), duration=2.0)
    assert [(e.kind, e.t) for e in run.events] == [("reversal", pytest.approx(1.0, rel=1e-13))]
    assert run.pieces.memory[-1].tolist() == [0, 0, 1]


def test_a_switch_may_set_the_inner_state():
    """Constant velocity would need no force; here every stretch of the spring to .1 costs k .1^2/2 of energy."""
    run = ss.solve(Pushed(Resets(3.0, 0.1)), duration=1.0, rtol=1e-11, start={"v": 1.0})
    assert run.method == "dop853"  # a law that cannot be traced comes here by itself
    switches = [e for e in run.events if e.kind == "switch"]
    cut = len(switches)
    assert cut == 9 and abs(run.z).max() <= 0.1 * (1 + 1e-12)
    assert 0.5 * run.v[-1] ** 2 + 1.5 * run.z[-1] ** 2 == pytest.approx(0.5 - cut * 1.5 * 0.01, rel=1e-10)
    assert run.at(switches[-1].t)["x"] == pytest.approx(0.1 * cut, rel=1e-11)


def test_a_law_that_switches_without_end_is_stopped(monkeypatch):
    monkeypatch.setattr("stickslip.solvers.plain.marching._EVENTS", 200)

    @dataclass(frozen=True)
    class Nervous(Odometer):
        def switches(self, v, z, load, mode):
            return [(1e-9 + 0.0 * z - z, (1 - mode[0], 0, 0), 0.0)]

    with pytest.raises(ss.SolveError, match=r"at t = .* contact .* slip velocity is .* accumulate"):
        plain(Pushed(Nervous(0.0, 1.0)), duration=1.0, start={"v": 1.0}, rtol=1e-3)


# drives -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Jolts:
    """The inner mass is still but for two jolts in each second, to and fro; it can also be pushed for half the period."""

    size: float
    push: float = 0.0
    period: ClassVar[float] = 1.0
    omega: ClassVar[float] = 2 * math.pi
    amplitude: ClassVar[float] = 1.0
    velocity_scale: ClassVar[float] = 1.0
    breaks: ClassVar[tuple[float, ...]] = (0.25, 0.5)

    @property
    def jumps(self):
        return ((0.0, self.size), (0.5, -self.size))

    def _phase(self, t):
        return t - np.floor(t)

    def position(self, t):
        return 0.0 * t

    def velocity(self, t):
        s = self._phase(t)
        return np.where(s < 0.25, self.push * s, np.where(s < 0.5, self.push * (0.5 - s), 0.0)) + np.where(s < 0.5, self.size, 0.0)

    def acceleration(self, t):
        s = self._phase(t)
        return np.where(s < 0.25, self.push, np.where(s < 0.5, -self.push, 0.0)) + 0.0


class Robot(ss.Robot):
    """A robot whose drive jolts it."""

    @property
    def impulses(self):
        return tuple((t, -self.mass_ratio * jump) for t, jump in self.drive.jumps)

    @property
    def breaks(self):
        return self.drive.breaks

    @property
    def velocity_scale(self):
        return 1.0


def jolted(size, push=0.0, mu=(0.1, 0.2)):
    return Robot(body_mass=3.0, inner_mass=1.0, drive=Jolts(size, push), friction=ss.Coulomb(*mu), gravity=10.0)


def test_jolts_throw_the_body_and_friction_stops_it():
    """-+J = size/4 each half second: the body comes to rest after J/(mu g) and J^2/(2 mu g) further on."""
    run = plain(jolted(0.4), periods=4)
    slides = 0.1**2 / (2 * np.array([2.0, 1.0]))  # backwards at whole seconds, forwards at halves
    moved = np.array([slides[1], *([slides[1] - slides[0]] * 3)])  # no impulse at the very start, when nothing was still before
    assert np.diff(run.strobe_x) == pytest.approx(moved, rel=1e-12)
    assert [(e.kind, e.before, e.after) for e in run.events[:4]] == [
        ("impulse", 0, 1), ("stick", 1, 0), ("impulse", 0, -1), ("stick", -1, 0),
    ]  # fmt: skip
    assert [e.t for e in run.events[:4]] == pytest.approx([0.5, 0.6, 1.0, 1.05], rel=1e-13)
    assert run.strobe_v[1:] == pytest.approx([-0.1] * 4, rel=1e-13)  # a strobe state is the state after the impulse
    assert ss.motion(run).period == 1


def test_impulses_and_breaks_balance_their_energy():
    """Pieces are parabolas: the balance closes to rounding, and what the actuator does is what friction takes."""
    run = plain(jolted(0.4, push=4.0, mu=(0.02, 0.05)), periods=12)
    e = ss.energy(run)
    assert np.all(e.friction > 0) and abs(e.residual).max() < 1e-11
    steady = slice(6, None)
    assert e.actuator[steady] - e.friction[steady] == pytest.approx(e.kinetic[steady], abs=1e-3)  # the inner mass keeps its own energy


def test_an_impulse_stands_twice_in_the_columns():
    run = plain(jolted(0.4), periods=2, samples=10)
    at = np.flatnonzero(run.t == 0.5)
    assert run.v[at] == pytest.approx([0.0, 0.1], abs=1e-15) and run.xi_rate[at] == pytest.approx([0.4, 0.0], abs=1e-9)
    assert run.mode[at].tolist() == [0, 1] and np.all(np.diff(run.t) >= 0)


def test_an_impulse_on_a_moving_body_turns_it_round():
    """Without friction the velocity is a staircase, v = -J or 0."""
    run = plain(jolted(0.4, mu=(0.0, 0.0)), periods=3, start={"v": 0.05})
    assert [(e.kind, e.before, e.after) for e in run.events] == [("impulse", 1, 1), ("impulse", 1, 1), ("impulse", 1, 1)] + [
        ("impulse", 1, 1)
    ] * 2
    assert run.at(np.array([0.3, 0.7, 1.2]))["v"] == pytest.approx([0.05, 0.15, 0.05], abs=1e-15)


@pytest.mark.parametrize("method", ["dop853", "radau", "lsoda", "bdf"])
def test_a_run_is_as_good_between_steps_as_the_integrator_says(method):
    """Radau's curve between two steps is a cubic: by a parabola it would be wrong hundreds of times more than at the steps."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4)
    run, true = ss.solve(robot, periods=1, method=method), ss.solve(robot, periods=1, rtol=1e-11)
    at = run.pieces.t[1:-1]
    between = at[:-1] + 0.25 * np.diff(at)
    missed = [abs(run.at(t)["v"] - true.at(t)["v"]).max() for t in (at, between)]
    assert missed[1] < 10 * missed[0]


@each_row("method", ["dop853", "radau", "lsoda", "bdf"])
def test_breaks_are_not_stepped_over(method):
    """Without friction and jolts the body goes the drive's way: v = -xi'/4, a triangle in each period."""
    run = plain(jolted(0.0, push=4.0, mu=(0.0, 0.0)), periods=2, method=method, rtol=1e-10)
    assert run.v == pytest.approx(-0.25 * run.xi_rate, abs=1e-11)
    assert run.strobe_x == pytest.approx(-0.25 * 4.0 * 0.25**2 * np.arange(3), abs=1e-10)


def rig(drive, mu=(0.15, 0.25), ratio=0.1315):
    return ss.Robot(body_mass=1 - ratio, inner_mass=ratio, drive=drive, friction=ss.Coulomb(*mu))


@pytest.mark.parametrize(("u1", "u2", "velocity"), [(0.1, 0.1, 0.000470057764186), (0.05, 0.4, 0.003305)])
def test_two_phase_drives_move_as_on_paper(u1, u2, velocity):
    """D1, both phases end at rest: V = J^2 (1/mu+ - 1/mu-)/(2 g T). D2, the fast phase ends sliding."""
    run = plain(rig(ss.drives.TwoPhase(stroke=0.01, u1=u1, u2=u2)), periods=6)
    assert ss.mean_velocity(run) == pytest.approx(velocity, rel=1e-11)
    balance = ss.energy(run)
    assert balance.actuator[-1] == pytest.approx(balance.friction[-1], rel=1e-11) and abs(balance.residual).max() < 1e-11


def test_three_phase_drives_move_as_on_paper():
    """D3: pushed by w2 forwards, braked under w3; rest before the next push."""
    ratio, g, u1, (w1, w2, w3) = 0.1315, 9.81, 0.3, (10.0, 60.0, 12.0)
    u3 = u1 * math.sqrt((1 / w1 + 1 / w2) / (1 / w2 + 1 / w3))
    a2, a3 = ratio * w2 - 0.15 * g, ratio * w3 + 0.15 * g
    v2, T = a2 * (u1 + u3) / w2, u1 / w1 + (u1 + u3) / w2 + u3 / w3
    run = plain(rig(ss.drives.ThreePhase(u1=u1, w1=w1, w2=w2, w3=w3)), periods=4)
    assert ss.mean_velocity(run) == pytest.approx(v2**2 * (1 / a2 + 1 / a3) / (2 * T), rel=1e-11)
    assert ss.mean_velocity(run) == pytest.approx(0.015990705704, abs=5e-13)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_load_in_step_with_the_motion_drives_the_body(sign):
    """D5, averaging: V/a = .435130859037 for b = .5, phi = pi/2. It starts near there; 40 periods, error of the order of epsilon."""
    ratio, omega, epsilon, b = 0.1315, 300.0, 0.002, 0.5
    a = ratio * 1e-3 * omega  # amplitude of the free body's velocity, -a cos(omega t)
    lift = b * 9.81 / (ratio * omega**2)
    drive = ss.drives.VerticalVibration(ss.Harmonic(amplitude=1e-3, omega=omega), amplitude=lift, phase=-sign * math.pi / 2)
    mu = epsilon * a * omega / 9.81
    run = plain(rig(drive, mu=(mu, mu)), periods=40, start={"v": a * (0.435 * sign - 1)}, rtol=1e-8, samples=4)
    assert (run.strobe_x[-1] - run.strobe_x[20]) / (20 * run.period_time) / a == pytest.approx(0.435130859037 * sign, abs=5e-3)


# the solver beside the exact one ----------------------------------------------------------------------------------


def test_a_grazing_robot_neither_chatters_nor_misses_an_event():
    """alpha_plus = 1 - 1e-9: it slips forwards for 1.4e-5 of a period in each, which the exact arcs confirm."""
    law = ss.Coulomb(1 - 1e-9, 1.2)
    robot = ss.Robot(body_mass=1.0, inner_mass=1.0, drive=ss.Harmonic(amplitude=2.0, omega=1.0), friction=law, gravity=1.0)
    run, exact = plain(robot, periods=40, samples=4), ss.solve(robot, periods=40, samples=4)
    assert len(run.events) == len(exact.events) == 80
    # what sin gains over its limit is rounded with the phase, up to 251: times to sqrt(2 * 3e-14), slides to their cubes
    assert [e.t for e in run.events] == pytest.approx([e.t for e in exact.events], abs=1e-7)
    assert run.x[-1] == pytest.approx(exact.x[-1], rel=1e-2)


def test_plain_events_are_those_of_the_exact_arcs():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb", incline="gravity")
    run, exact = plain(robot, periods=10), ss.solve(robot, periods=10)
    assert [(e.kind, e.after) for e in run.events] == [(e.kind, e.after) for e in exact.events]
    assert [e.t for e in run.events] == pytest.approx([e.t for e in exact.events], abs=1e-12 * 10 * robot.period)
    assert run.strobe_x == pytest.approx(exact.strobe_x, abs=1e-11 * float(exact.x.max()))
