"""Limit cycles of machines of several bodies, and of joints with a controller: what a single block gives, and what long runs do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import stickslip as ss

STATIC = ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)
LUGRE = ss.LuGre(1.0, 1.0, 1.5, 1.5, sigma0=1e5, sigma1=1e5**0.5, sigma2=0.4, v_s=1e-3)


@dataclass(frozen=True, eq=False)
class Blocks(ss.Machine):
    """Two blocks on a belt, each on a spring to the wall, and a spring between them."""

    speed: float
    between: float
    friction: Any
    second: float = 1.0

    def bodies(self):
        return {"first": ss.Body(1.0), "second": ss.Body(self.second)}

    def contacts(self):
        return {name: ss.Contact(name, self.friction, on=self.speed, load=1.0) for name in ("first", "second")}

    def links(self):
        return {("first", None): ss.Spring(2.0), ("second", None): ss.Spring(2.0), ("first", "second"): ss.Spring(self.between)}


def test_two_equal_blocks_move_as_one_does_and_that_is_unstable():
    """In phase the spring between them does nothing, so that the cycle is the closed one; a disturbance out of phase grows."""
    cycle = ss.periodic_orbit(Blocks(0.1, 0.5, STATIC))
    assert cycle.duration == pytest.approx(7.6112592541013, abs=1e-11)
    assert cycle.patterns == {"first": "0-", "second": "0-"} and cycle.type == "stick-slip" and cycle.stability == "unstable"
    assert abs(cycle.multipliers - cycle.differences).max() < 1e-4 and abs(cycle.mean_velocity) < 1e-12


def test_unequal_blocks_settle_on_their_cycle_at_the_rate_of_its_multiplier():
    machine = Blocks(0.1, 0.5, STATIC, second=1.3)
    cycle = ss.periodic_orbit(machine)
    assert cycle.stable and cycle.multipliers[0] == pytest.approx(0.16815, abs=1e-4)
    off = {**cycle.start, "x": {"first": cycle.start["x"]["first"], "second": cycle.start["x"]["second"] + 1e-4}}
    run = ss.solve(machine, duration=4 * cycle.duration, start=off).with_axes
    path = [float(run.at(np.array([k * cycle.duration]))["x"][0, 1]) for k in (1, 2, 3)]  # later or earlier on the cycle, for good
    assert (path[2] - path[1]) / (path[1] - path[0]) == pytest.approx(cycle.multipliers[0], rel=1e-2)


def test_blocks_under_a_dynamic_law_have_a_cycle_too():
    cycle = ss.periodic_orbit(Blocks(0.1, 0.5, LUGRE, second=1.3))
    assert cycle.stable and cycle.residual < 1e-11
    assert np.allclose(cycle.multipliers[:2], cycle.differences[:2], atol=1e-6)


@pytest.fixture(scope="module")
def hunting():
    return ss.periodic_orbit(ss.presets.servo())


def test_a_joint_hunts_on_a_cycle_that_long_runs_come_to(hunting):
    run = ss.solve(ss.presets.servo(), duration=120.0)
    sticks = [event.t for event in run.events if event.kind == "stick"]
    error = abs(0.5 - np.array([float(run.at(t)["x"]) for t in sticks]))
    last = float(np.max(abs(0.5 - hunting.run.x)))
    assert hunting.duration == pytest.approx(sticks[-1] - sticks[-3], abs=1e-6)
    assert error[-1] == pytest.approx(last, abs=1e-8) and hunting.pattern == "0-0+" and hunting.stable
    rates = (error[4:10] - last) / (error[2:8] - last)  # from one turn to the next
    assert np.allclose(rates, hunting.multipliers[0], atol=1e-3) and hunting.multipliers[1] == 0.0


def test_hunting_is_continued_in_a_gain(hunting):
    """More integral action shortens the rests; at the end the cycle found anew is the one that was followed."""
    branch = ss.continuation(ss.presets.servo(), parameter="control.ki", start=0.04, stop=0.06, guess=hunting, step=0.1)
    durations = [orbit.duration for orbit in branch.orbits]
    assert (np.diff(durations) < 0).all() and all(orbit.stable for orbit in branch.orbits)
    anew = ss.periodic_orbit(ss.presets.servo().replace({"control.ki": float(branch.values[-1])}))
    assert anew.duration == pytest.approx(durations[-1], rel=1e-8)


def test_a_joint_that_comes_to_rest_has_no_cycle():
    calm = ss.presets.servo().replace({"control.ki": 0.0})
    with pytest.raises(ss.SolveError, match="it rests, or slides on steadily"):
        ss.periodic_orbit(calm)


def test_two_blocks_in_phase_gain_stability_as_their_spring_stiffens():
    """The multiplier of the motion out of phase falls through 1, where unequal motions branch off, and through -1."""
    branch = ss.continuation(Blocks(0.1, 0.5, STATIC), parameter="between", start=0.5, stop=2.5, step=0.1)
    assert [special.kind for special in branch.special] == ["branch-point", "flip"]
    for special, multiplier in zip(branch.special, (1.0, -1.0), strict=True):
        there = ss.periodic_orbit(Blocks(0.1, special.value, STATIC), guess=special.orbit)
        assert there.differences[0] == pytest.approx(multiplier, abs=1e-4) and special.accuracy < 1e-7


def test_a_chain_that_nothing_drives_comes_to_rest():
    chain = ss.Chain(ss.machines.Bodies(mass=0.05, count=3, friction=ss.Coulomb(0.1, 0.3)), link=ss.Spring(10.0))
    run = ss.solve(chain, duration=3.0, start={"x": {"body 1": 0.1}})
    assert abs(run.v).max() > 0.1 and (run.v[-1] == 0.0).all()
