"""Known traps of stick-slip solvers, each with a robot that steps into it: on the Taylor arcs, and on the closed ones if there are any."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from scipy.optimize import brentq

import stickslip as ss
from rows import each_row
from stickslip.analysis.phases import two_phase
from stickslip.solvers import stepping
from stickslip.solvers.request import request
from stickslip.solvers.settings import Settings
from twins import StickSlip

HARMONIC = ss.Harmonic(amplitude=2.0, omega=1.0)


def unit(friction, drive=HARMONIC, **more):
    """A robot of 2 kg at g = 1 whose free body has the acceleration sin(t)."""
    return ss.Robot(body_mass=1.0, inner_mass=1.0, drive=drive, friction=friction, gravity=1.0, **more)


def dry(plus, minus, f_plus=None, f_minus=None):
    return ss.Coulomb(plus, minus, f_plus or plus, f_minus or minus)


def taylor(model, periods, **start):
    """The Taylor arcs also of a robot that has closed ones."""
    return stepping.run(request(model, Settings(periods=periods, rtol=1e-9, start=start, samples=4)), None, 1e-9)


def closed(model, periods, **start):
    run = ss.solve(model, periods=periods, start=start, samples=4)
    assert "arcs" in run.counts
    return run


both = pytest.mark.parametrize("arcs", [taylor, closed])


def changes(run):
    return [(e.kind, e.after) for e in run.events]


def times(run):
    return np.array([e.t for e in run.events])


def told(twin):
    """The changes of mode of a twin, and when."""
    modes = [mode for *_, mode in twin.arcs]
    names = ["stick" if b == 0 else "slip" if a == 0 else "reversal" for a, b in pairwise(modes)]
    return list(zip(names, modes[1:], strict=True)), np.array([float(t) for t, *_ in twin.arcs[1:]])


# reversals, and two events at one instant -------------------------------------------------------------------------


@both
def test_an_event_function_that_starts_at_zero_is_no_event(arcs):
    """After each reversal the new guard, -v instead of v, begins at zero: two events per period, half a period apart."""
    run = arcs(unit(dry(0.2, 0.3)), 100, v=0.5)
    assert {e.kind for e in run.events} == {"reversal"}
    assert np.bincount((times(run) // run.period_time).astype(int)).tolist() == [1] + [2] * 99
    _, when = told(StickSlip(0.2, 0.3, 0.2, 0.3, w=0.5).run(3))
    assert times(run)[: len(when)] == pytest.approx(when, abs=1e-13)
    assert np.diff(times(run)).min() > 1.5


@both
@each_row("over", [-1e-6, -1e-9, -1e-12, 1e-12, 1e-9, 1e-6])
def test_a_body_stops_at_the_instant_when_the_force_reaches_break_away(arcs, over):
    """It comes to rest where the force is the backward limit and a little `over`: it reverses, or rests for that moment."""
    plus, minus = 0.6, 0.5
    when = math.pi + math.asin(minus + over)
    start = plus * when - 1 + math.cos(when)
    run = arcs(unit(dry(plus, minus)), 2, v=start)
    names, instants = told(StickSlip(plus, minus, plus, minus, w=start).run(2))
    assert changes(run) == names and names[0] == (("reversal", -1) if over > 0 else ("stick", 0))
    assert times(run) == pytest.approx(instants, abs=1e-13)  # two roundings of times near 10


@both
def test_a_body_stops_and_breaks_away_at_one_and_the_same_instant(arcs):
    """Rounding chooses between a reversal and a rest of 1e-16 s; the motion is the same."""
    when = math.pi + math.asin(0.5)
    start = 0.6 * when - 1 + math.cos(when)
    run = arcs(unit(dry(0.6, 0.5)), 2, v=start)
    twin = StickSlip(0.6, 0.5, 0.6, 0.5, w=start).run(2)
    first = [e for e in run.events if abs(e.t - when) < 1e-6]
    assert [e.kind for e in first] in (["reversal"], ["stick", "slip"]) and first[-1].after == -1
    assert [e.t for e in first] == pytest.approx([when] * len(first), abs=2e-8)  # the root of a rounding: the velocity is a parabola
    assert run.strobe_x == pytest.approx([0.0, *(float(x) for x, _ in twin.strobes)], abs=1e-15 * 2 * np.pi * 10)


@each_row("late", [-1e-9, -1e-13, 0.0, 1e-13, 1e-9])
def test_a_body_comes_to_rest_at_the_instant_of_an_impulse(late):
    """It slides u2-phase long, t2 = J/(mu g), and is thrown again at that instant: J = mu (u1 + u2)."""
    ratio, g, (u1, u2), (plus, minus) = 0.1315, 9.81, (0.05, 0.4), (0.15, 0.25)
    sliding = ratio * (u1 + u2) / (plus * g)
    drive = ss.drives.TwoPhase(stroke=u2 * sliding * (1 + late), u1=u1, u2=u2)
    robot = ss.Robot(body_mass=1 - ratio, inner_mass=ratio, drive=drive, friction=dry(plus, minus))
    run = ss.solve(robot, periods=8, samples=4)
    slides = ratio**2 * (u1 + u2) ** 2 / (2 * g)  # times 1/mu: the whole slide of a throw
    assert ss.mean_velocity(run) == pytest.approx(slides * (1 / plus - 1 / minus) / drive.period, rel=1e-11 + 10 * abs(late))
    assert ss.mean_velocity(run) == pytest.approx(float(two_phase(drive, ratio, plus, minus)), rel=1e-12)
    kinds = [e.kind for e in run.events if 2.1 < e.t / drive.period < 7.9]
    assert kinds.count("impulse") == 11 and set(kinds) <= {"impulse", "stick"}
    assert kinds.count("stick") <= kinds.count("impulse")


@both
def test_motion_without_friction_that_touches_zero_in_every_period_goes_on(arcs):
    """v = 1 - cos t: break-away limits, force and velocity are all zero at once, 1000 times."""
    run = arcs(unit(dry(0.0, 0.0)), 1000)
    assert run.x[-1] == pytest.approx(2000 * math.pi, rel=1e-13)
    assert run.v.min() > -1e-14 and len(run.events) <= 2000
    assert np.abs(np.remainder(times(run) + 1, run.period_time) - 1).max() < 1e-6


# break-away -------------------------------------------------------------------------------------------------------


@both
def test_break_away_waits_for_the_static_limit(arcs):
    """Slips begin at arcsin f and not at arcsin mu."""
    run = arcs(unit(dry(0.5, 1.2, 0.8, 1.4)), 20)
    slips = np.array([e.t for e in run.events if e.kind == "slip"])
    assert len(slips) == 20 and slips - run.period_time * np.arange(20) == pytest.approx(math.asin(0.8), abs=1e-13)
    assert (run.strobe_x[20] - run.strobe_x[10]) / (20 * math.pi) == pytest.approx(0.170822286993, abs=1e-12)


@both
def test_a_force_that_only_just_reaches_the_static_limit_moves_nothing(arcs):
    """sin t touches the limit 1; a limit that is 1e-12 lower is passed for 2.8e-6 s, which is not missed."""
    assert arcs(unit(dry(0.5, 0.5, 1.0, 1.0)), 50).events == []
    assert arcs(unit(dry(0.5, 0.5, 1.0 + 1e-12, 1.0 + 1e-12)), 50).events == []
    run = arcs(unit(dry(0.5, 2.0, 1.0 - 1e-12, 2.0)), 50)
    assert [e.kind for e in run.events] == ["slip", "stick"] * 50
    slips = times(run)[::2] - run.period_time * np.arange(50)
    assert slips == pytest.approx(math.asin(1.0 - 1e-12), abs=1e-15 / math.sqrt(2e-12) + 1e-13)  # a rounding of the force, by its slope


def test_a_condition_on_time_alone_is_found_inside_a_long_step():
    """Held by Karnopp's law nothing limits the step. It breaks away where sin wt = f; v' = sin wt - f in the band, sin wt - mu beyond."""
    w, law = 3.0, ss.friction.Karnopp(0.5, 0.5, 0.8, 0.8, width=0.01)
    run = ss.solve(unit(law, ss.Harmonic(amplitude=2 / w**2, omega=w)), periods=1, rtol=1e-9)
    away = math.asin(0.8) / w

    def gained(t, start, resists):
        return (np.cos(w * start) - np.cos(w * t)) / w - resists * (t - start)

    beyond = brentq(lambda t: gained(t, away, 0.8) - 0.01, away, 1.5 / w, xtol=1e-16)
    held, band, free = np.linspace(0, away, 50), np.linspace(away, beyond, 50), np.linspace(beyond, 3.0 / w, 50)
    assert run.at(held)["v"] == pytest.approx(0.0, abs=1e-8)
    assert run.at(band)["v"] == pytest.approx(gained(band, away, 0.8), abs=1e-8)
    assert run.at(free)["v"] == pytest.approx(0.01 + gained(free, beyond, 0.5), abs=1e-8)


def test_where_two_laws_hold_a_body_only_their_sum_is_told():
    """How two contacts share a load at rest is indeterminate. A model has one contact; a sum holds with both limits."""
    both_laws = dry(0.1, 0.2, 0.3, 0.4) + dry(0.4, 0.6, 0.5, 0.7)
    assert both_laws.breakaway(2.0) == pytest.approx((-2.2, 1.6))
    run, one = closed(unit(both_laws), 3), closed(unit(dry(0.5, 0.8, 0.8, 1.1)), 3)
    assert changes(run) == changes(one) and times(run) == pytest.approx(times(one), abs=1e-14)
    stuck = run.mode == 0
    assert stuck.any() and run.friction_force[stuck] == pytest.approx(2.0 * np.sin(run.t[stuck]), abs=1e-13)  # what holds the body
    with pytest.raises(ss.InputError, match="allowed is an object with sliding and breakaway"):
        unit((dry(0.1, 0.2), dry(0.4, 0.6)))


# grazing ----------------------------------------------------------------------------------------------------------


@both
@each_row("above", [-1e-6, -1e-10, -1e-13, 1e-13, 1e-10, 1e-6])
def test_a_velocity_that_grazes_zero_rests_or_does_not(arcs, above):
    """It comes down to `above` where the force is just the limit: below zero it rests for sqrt(2 |above|/cos)."""
    r = 0.3
    start = r * (2 * math.pi + math.asin(r)) + math.sqrt(1 - r * r) - 1 + above
    run = arcs(unit(dry(r, 0.5)), 2, v=start)
    names, instants = told(StickSlip(r, 0.5, r, 0.5, w=start).run(2))
    assert changes(run) == names and len(names) == (1 if above > 0 else 3)
    assert times(run) == pytest.approx(instants, abs=2e-15 / math.sqrt(abs(above)) + 1e-13)


@each_row("missing", [1e-6, 1e-9, 1e-12])
def test_a_thousand_periods_of_the_smallest_slips_are_the_same_by_both_arcs(missing):
    """mu = 1 - missing: in each period a slip of 9 sqrt(2 missing)/2 seconds and 4.5 missing^2 metres, and none is missed."""
    robot = unit(dry(1 - missing, 1.2))
    run, exact = taylor(robot, 1000), closed(robot, 1000)
    assert changes(run) == changes(exact) == [("slip", 1), ("stick", 0)] * 1000
    assert times(run) == pytest.approx(times(exact), abs=1e-10 * robot.period)
    assert run.x[-1] == pytest.approx(exact.x[-1], rel=1e-15 / missing + 1e-8)
    assert exact.x[-1] / 1000 == pytest.approx(4.5 * missing**2, rel=1e-3 + missing)


@dataclass(frozen=True)
class Humps:
    """v' = sin 2t + a sin(t - pi/4) - r while it slides: two humps, between which the velocity comes down to `above`; then rest.

    In 30 digits: the amplitude a for which it does, and every event of a period. f is the static limit.
    """

    above: float
    f: Any
    r: Any = 0.25

    def __post_init__(self):
        with mp.workdps(30):
            a = mp.findroot(lambda a: self.velocity(self.low(a), a) - self.above, (0.3, 0.8), solver="anderson", tol=1e-50)
        object.__setattr__(self, "a", a)

    def force(self, t, a):
        return mp.sin(2 * t) + a * mp.sin(t - mp.pi / 4)

    def velocity(self, t, a, start=None):
        start = self.reaches(self.f, a, 0.1, 0.6) if start is None else start
        return (mp.cos(2 * start) - mp.cos(2 * t)) / 2 + a * (mp.cos(start - mp.pi / 4) - mp.cos(t - mp.pi / 4)) - self.r * (t - start)

    def reaches(self, level, a, lo, hi):
        return mp.findroot(lambda t: self.force(t, a) - level, (lo, hi), solver="anderson", tol=1e-50)

    def low(self, a):
        return self.reaches(self.r, a, 2.5, 3.5)

    def events(self):
        with mp.workdps(30):
            a, low = self.a, self.low(self.a)
            found = [self.reaches(self.f, a, 0.1, 0.6)]
            if self.above < 0:
                found.append(
                    mp.findroot(lambda t: self.velocity(t, a), (low - 3 * mp.sqrt(-self.above), low), solver="anderson", tol=1e-50)
                )
                found.append(self.reaches(self.f, a, low, 3.6) if self.f > self.r else low)
            found.append(mp.findroot(lambda t: self.velocity(t, a, None if self.above > 0 else found[-1]), (4.5, 6), solver="anderson"))
            return np.array([float(t) for t in found])

    def robot(self):
        drive = ss.MultiHarmonic(omega=1.0, amplitudes=(2 * float(self.a), 0.5), phases=(-math.pi / 4, 0.0))
        return unit(dry(self.r, 4.0, self.f, 4.0), drive, track=ss.Incline(tilt=0.0))


@pytest.mark.parametrize("f", [0.25, 0.3], ids=["kinetic", "static"])
@pytest.mark.parametrize("above", [1e-6, 1e-10, -1e-10, -1e-6])
def test_a_thousand_grazing_periods_neither_chatter_nor_miss_an_event(above, f):
    """The velocity of a double slip just touches zero, or just does not, in every period; rest forgets the rounding of the last one."""
    humps = Humps(above, f)
    run, expected = ss.solve(humps.robot(), periods=1000, samples=4), humps.events()
    names = ["slip", "stick"] * (1 if above > 0 else 2)
    assert [e.kind for e in run.events] == names * 1000
    found = times(run).reshape(1000, -1) - run.period_time * np.arange(1000)[:, None]
    assert found == pytest.approx(np.tile(expected, (1000, 1)), abs=1e-10 * run.period_time)
    assert (np.ptp(found, axis=0) < 1e-11).all()


# where events are, when the arcs have no closed form --------------------------------------------------------------


def retraced(run, side_speed, offered, limits):
    """The events of a run as zeros of formulas, one after another, each sought beside the one that was told.

    `side_speed(side, t0)` is v(t) of a slide that begins from rest at t0; while it is stuck `offered(t)` lies between the limits.
    Between two events no sign changes, so none was missed.
    """
    t0, mode, found = mp.mpf(0), 0, []
    for event in run.events:
        inside = [t0 + (event.t - t0) * mp.mpf(k) / 60 for k in range(1, 60)]
        if mode == 0:
            assert event.kind == "slip" and all(limits[0] < offered(t) < limits[1] for t in inside)
            level = limits[1] if event.after > 0 else limits[0]
            t0 = mp.findroot(lambda t, level=level: offered(t) - level, event.t)
        else:
            speed = side_speed(mode, t0)
            assert all(mode * speed(t) > 0 for t in inside)
            t0 = mp.findroot(speed, (event.t - 1e-4, event.t + 1e-4), solver="anderson", tol=1e-30)
        mode = event.after
        found.append(float(t0))
    return np.array(found)


def test_events_of_viscous_friction_are_those_of_its_exponential_arcs():
    """v' = sin t -+ r - c v has v = C e^(-ct) + (c sin t - cos t)/(1 + c^2) -+ r/c."""
    law = ss.CoulombViscous(0.3, 0.5, 0.4, 0.6, viscous=0.8, quadratic=0.0)  # c = viscous/mass = .4
    run, c = ss.solve(unit(law), periods=3), mp.mpf("0.4")
    assert changes(run)[:2] == [("slip", 1), ("reversal", -1)]

    def side_speed(side, t0):
        r = mp.mpf("0.3") if side > 0 else -mp.mpf("0.5")

        def steady(t):
            return (c * mp.sin(t) - mp.cos(t)) / (1 + c**2) - r / c

        return lambda t: steady(t) - steady(t0) * mp.exp(-c * (t - t0))

    with mp.workdps(30):
        exact = retraced(run, side_speed, mp.sin, (-mp.mpf("0.6"), mp.mpf("0.4")))
    assert len(exact) == len(run.events) >= 6
    assert times(run) == pytest.approx(exact, abs=1e-13)


def test_events_of_stribeck_friction_are_where_a_series_of_twenty_digits_has_them():
    """v' = sin t -+ (mu + (f - mu) exp(-(v/v_s)^2)) - c v."""
    mu, f, v_s, c = (0.3, 0.5), (0.4, 0.6), 0.2, 0.1
    run = ss.solve(unit(ss.Stribeck(*mu, *f, v_s=v_s, exponent=1.0, viscous=2 * c)), periods=2)

    def side_speed(side, t0):
        kinetic, static = (mu[0], f[0]) if side > 0 else (mu[1], f[1])

        def slope(t, v):
            return mp.sin(t) - side * (kinetic + (static - kinetic) * mp.exp(-side * v / v_s)) - c * v

        return mp.odefun(slope, t0, mp.mpf(0))

    with mp.workdps(20):
        exact = retraced(run, side_speed, mp.sin, (-f[1], f[0]))
    assert len(exact) == len(run.events) >= 3
    assert times(run) == pytest.approx(exact, abs=1e-12)


# contact lost -----------------------------------------------------------------------------------------------------


def lifted(b, law, phase=0.4):
    """The load is W (1 + b sin(omega t + phase))."""
    drive = ss.drives.VerticalVibration(ss.Harmonic(amplitude=4e-4, omega=200.0), amplitude=0.0, phase=phase + math.pi)
    robot = ss.Robot(body_mass=0.0626, inner_mass=0.0095, drive=drive, friction=law)
    return robot.replace({"drive.amplitude": b * robot.total_mass * robot.gravity / (robot.inner_mass * 200.0**2)})


def lost_at(b, phase=0.4):
    return (math.pi + math.asin(1 / b) - phase) / 200.0


LAWS = {
    "coulomb": dry(0.15, 0.21, 0.18, 0.24),
    "lugre": ss.LuGre(0.15, 0.21, 0.18, 0.24, sigma0=2e4, sigma1=20.0, sigma2=0.4, v_s=2e-3),
}
each_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)


@each_law
@each_row("b", [1 + 1e-8, 1.01, 1.5, 4.0])
def test_contact_is_lost_where_the_load_falls_to_zero(law, b):
    """sin(omega t + phase) = -1/b. Under a law with inner states the load's zero is found to some 1e-11 of the load, by its slope."""
    run, digits = ss.solve(lifted(b, law), periods=5), 3e-16 if hasattr(law, "sliding") else 2e-11
    last = run.events[-1]
    assert run.lost_contact and run.status == "contact lost: the load fell to zero"
    assert (last.kind, last.t) == ("contact lost", pytest.approx(lost_at(b), rel=1e-14 + digits / math.sqrt(b - 1)))
    assert run.t[-1] == last.t and sum(e.kind == "contact lost" for e in run.events) == 1


@each_law
def test_contact_is_kept_where_the_load_only_just_stays_positive(law):
    run = ss.solve(lifted(1 - 1e-8, law), periods=5)
    assert (
        run.status == "finished" and "contact lost" not in {e.kind for e in run.events} and run.t[-1] == pytest.approx(5 * run.period_time)
    )


@each_law
def test_contact_lost_in_a_batch_is_a_status_of_its_case(law):
    """The others go on; the one alone tells the same."""
    many = ss.solve(lifted(np.array([0.5, 1.5, 0.9, 4.0]), law), periods=5)
    assert many.status.tolist() == [0, 6, 0, 6]
    assert many.status_counts == {"finished": 2, "contact lost: the load fell to zero": 2}
    assert many.motion_type[[1, 3]].tolist() == ["unsolved"] * 2 and many.periods_run.tolist() == [5, 0, 5, 0]
    assert np.isfinite(many.mean_velocity).tolist() == [True, False, True, False]
    alone = ss.solve(lifted(0.9, law), periods=5, keep="summary")
    assert float(alone.mean_velocity) == many.mean_velocity[2]
