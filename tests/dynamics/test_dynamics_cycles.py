"""Limit cycles of mechanisms that nothing drives: a block on a belt, a pulled mass; how long they take, and where they end."""

from __future__ import annotations

import math

import numpy as np
import pytest

import stickslip as ss
from rows import each_row

STATIC = ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)
LUGRE_1995 = ss.LuGre(1.0, 1.0, 1.5, 1.5, sigma0=1e5, sigma1=1e5**0.5, sigma2=0.4, v_s=1e-3)
WEAK = ss.Stribeck(1.0, 1.0, 1.5, 1.5, v_s=0.2)


def belt(friction=STATIC, speed=0.1, **given):
    return ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=speed, friction=friction, **given)


def pull(friction=STATIC, speed=0.1):
    return ss.PulledMass(mass=1.0, stiffness=2.0, speed=speed, friction=friction)


def closed_period(v):
    """O3: t_slip = (2/w)(pi - atan(D w / v)), t_stick = 2 D / v."""
    D, w = 0.25, math.sqrt(2)
    return 2 / w * (math.pi - math.atan(D * w / v)) + 2 * D / v


def later(run, cycle, turns):
    """How far a long run is from itself so many cycles before, in v, over a cycle."""
    t = run.pieces.t[-1] - np.linspace(0, cycle.duration, 200)
    return float(np.max(abs(run.at(t)["v"] - run.at(t - turns * cycle.duration)["v"])))


@each_row("make", [belt, pull])
def test_the_cycle_of_the_belt_is_the_closed_one(make):
    cycle = ss.periodic_orbit(make())
    assert closed_period(0.1) == pytest.approx(7.6112592541013, abs=1e-12)
    assert cycle.duration == pytest.approx(closed_period(0.1), abs=1e-10)
    assert cycle.type == "stick-slip" and cycle.residual < 1e-11 and cycle.period_time == cycle.duration
    assert cycle.multipliers.tolist() == [0.0] and abs(cycle.differences[0]) < 1e-6
    assert cycle.mean_velocity == pytest.approx(0.0 if make is belt else 0.1, abs=1e-12)
    assert [e.kind for e in cycle.events] == ["stick", "slip"] and "stick-slip" in repr(cycle)
    rest = np.diff(cycle.run.pieces.t)[cycle.run.pieces.mode[:, 0] == 0].sum()
    assert rest == pytest.approx(2 * 0.25 / 0.1, abs=1e-10)


def test_every_kind_of_guess_leads_to_the_same_cycle():
    model = belt()
    cycle = ss.periodic_orbit(model)
    for guess in (cycle, dict(x=0.7, v=0.1), ss.solve(model, duration=40.0)):
        assert ss.periodic_orbit(model, guess=guess).duration == pytest.approx(cycle.duration, abs=1e-12)


def test_cycles_along_the_belts_speed():
    """At every point the closed period; the branch is a labelled dataset."""
    b = ss.continuation(belt(), parameter="speed", start=0.1, stop=0.4, step=0.2)
    assert [ss.plot.continuation(b, quantity).lines[0].get_xdata()[0] for quantity in ("x", "duration")] == [100.0, 100.0]  # mm/s
    with pytest.raises(ss.InputError, match="observable = 'pattern'; allowed is one of x, v, mean_velocity"):
        ss.plot.continuation(b, "pattern")
    for v, duration in zip(b.values, b.points.duration.values, strict=True):
        assert duration == pytest.approx(closed_period(v), abs=1e-10)
    assert b.special == [] and b.points.duration.attrs["units"] == "s" and "end of the range" in b.ended
    assert b.at(0.25).duration == pytest.approx(closed_period(0.25), abs=1e-10)
    with pytest.raises(ss.InputError, match="limit cycles"):
        b.doubled()


def test_what_comes_to_rest_has_no_cycle():
    with pytest.raises(ss.SolveError, match="slides on steadily"):
        ss.periodic_orbit(belt(ss.Coulomb(1.0, 1.0), damping=0.5))


@pytest.mark.slow
@pytest.mark.parametrize("make", [belt, pull])
def test_lugre_cycles(make):
    """L2: 6.36271982 s; a long run repeats after it; multipliers by differences of the flow."""
    model = make(LUGRE_1995)
    cycle = ss.periodic_orbit(model)
    assert cycle.duration == pytest.approx(6.36271982, abs=1e-8)
    assert cycle.names == ("x", "v", "z") and len(cycle.multipliers) == 2 and cycle.stable
    np.testing.assert_allclose(np.sort(abs(cycle.multipliers)), np.sort(abs(cycle.differences)), atol=1e-6)
    run = ss.solve(model, duration=20 * cycle.duration, rtol=1e-9)
    assert later(run, cycle, 3) < 1e-6
    fastest = np.max(cycle.run.v) if make is pull else 0.1 - np.min(cycle.run.v)  # over what it rubs on
    assert float(fastest) == pytest.approx(0.369816, abs=1e-6)


@pytest.mark.slow
def test_the_stick_slip_cycle_ends_at_a_critical_speed():
    """Weakening friction and damping: by continuation, and by halving between runs that go on sticking and runs that do not."""
    model = belt(WEAK, damping=0.3)
    b = ss.continuation(model, parameter="speed", start=0.6, stop=1.0)
    ((kind, value, cycle),) = b.special
    assert kind == "type-border" and cycle.type == "slip" and b.orbits[0].stable
    back = b.orbits[-1]
    assert back.type == "slip" and back.multipliers[0] > 1.0 and b.values[-1] == 0.6, "it goes back as the cycle that only slides"

    def sticks(speed):
        run = ss.solve(belt(WEAK, speed, damping=0.3), duration=40.0, start=dict(x=0.3, v=speed))
        return sum(event.kind == "stick" for event in run.events) > 3

    low, high = 0.6, 0.75
    for _ in range(26):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if sticks(middle) else (low, middle)
    assert value == pytest.approx(low, abs=1e-7)
    with pytest.raises(ss.SolveError):
        ss.periodic_orbit(belt(WEAK, value + 1e-3, damping=0.3))


@pytest.mark.parametrize("kind", [ss.BlockOnBelt, ss.PulledMass])
def test_cycles_that_lie_side_by_side_are_not_followed(kind):
    """Without damping and stiction a mass swings on its spring at any amplitude below the speed: folds there would be rounding."""
    machine = kind(1.0, 2.0, 0.1, ss.Coulomb(mu_plus=0.2, mu_minus=0.2), load=1.0)
    start = {"x": 0.12, "v": 0.05} if kind is ss.BlockOnBelt else {"x": -0.08, "v": 0.05}
    cycle = ss.periodic_orbit(machine, guess=start)
    assert cycle.type == "slip" and cycle.duration == pytest.approx(2 * np.pi / np.sqrt(2.0), rel=1e-9)
    assert cycle.stability == "neutral" and not cycle.stable and "neutral" in repr(cycle)
    with pytest.raises(ss.SolveError, match=r"at speed = 0\.1 such motions form a continuous family.*damping"):
        ss.continuation(machine, parameter="speed", start=0.1, stop=0.15, guess=start)
    branch = ss.continuation(machine, parameter="speed", start=0.1, stop=0.15, points=60)
    assert "continuous family" in branch.ended and not branch.special


def test_a_mass_that_a_constant_force_speeds_up_for_ever_is_named_as_the_reason():
    pushed = ss.ForcedOscillator(mass=1.0, stiffness=0.0, damping=0.0, force=0.5, omega=1.0, friction=ss.Coulomb(0.3, 0.3), bias=0.4)
    with pytest.raises(ss.SolveError, match=r"grows by the same amount in every drive period.*a damping that is not 0"):
        ss.periodic_orbit(pushed)


def test_a_flow_without_a_period_that_comes_to_rest_is_steady_and_has_no_cycle():
    flow = ss.SwitchingFlow({0: lambda t, y, n: (y[1], -0.2 * y[1] - y[0] * n.k)}, numbers={"k": 1.0}, states=("x", "v"))
    (only,) = ss.basins(flow, x=[-1.0, 1.0], settle=20).attractors
    assert only.kind == "steady" and np.max(np.abs(only.state)) < 1e-9
    with pytest.raises(ss.SolveError, match=r"no cycle was found: in .* the run comes to rest; give guess="):
        ss.continuation(flow, parameter="k", start=1.0, stop=2.0)


@each_row("turns", [2, 3, 4])
def test_a_cycle_that_repeats_earlier_than_was_asked_is_given_once_and_says_so(turns):
    once, asked = ss.periodic_orbit(belt()), ss.periodic_orbit(belt(), period=turns)
    assert once.period == asked.period == 1 and asked.duration == pytest.approx(closed_period(0.1), abs=1e-10)
    assert asked.notes == (f"it repeats after 1 of the {turns} turns that were asked for",) and once.notes == ()
    assert len(asked.events) == 2 and asked.residual < 1e-11


def test_a_branch_of_cycles_that_repeat_earlier_has_their_period():
    branch = ss.continuation(belt(), parameter="speed", start=0.1, stop=0.12, period=2)
    assert branch.period == 1 and branch.orbits[-1].duration == pytest.approx(closed_period(0.12), abs=1e-9)
