"""Machines of several bodies by the exact solver: the numbers of the collection, and every event against the judge in plain Python."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

import problems
import stickslip as ss
from models.machines.test_several_bodies import assert_phases, last_period
from rows import each_row
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, strobe_map

ROWS = {**problems.COUPLED, **problems.MASSES}


@each_row("row", ROWS)
def test_exact_runs_have_the_reference_numbers(row):
    machine, periods, velocity, tolerance, events = ROWS[row]
    run = ss.solve(machine, periods=2 * periods)
    assert run.method == "exact"
    assert last_period(run) == pytest.approx([velocity] * len(run.bodies), abs=tolerance)
    if events:
        assert_phases(run, events)


def test_identical_modules_in_phase_move_as_one():
    """M2a: two contacts start and stop at one instant, and each has its events."""
    run = ss.solve(problems.chain(0.0, 0.0), periods=300)
    assert last_period(run) == pytest.approx([0.002383491055471] * 2, rel=1e-12)
    assert_phases(run, [(0.0500366358, (0, 0)), (0.0728072666, (1, 1)), (0.6347786446, (-1, -1))])


def test_two_feet_of_one_body_rest_and_break_away_together():
    """M2h: modules on a rigid link with phases 0 and 2 are one module whose amplitude is A cos 1."""
    run = ss.solve(problems.chain(0.0, 2.0, link=ss.machines.Rigid()), periods=100)
    assert run.method == "exact" and last_period(run) == pytest.approx([0.000217301001732] * 2, rel=1e-11)


@pytest.mark.parametrize("row", problems.WORMS)
def test_worms_have_the_reference_numbers(row):
    """Feet at prescribed distances hand over in one instant; V = 3 a f exactly where one always holds."""
    machine, velocity, tolerance = problems.WORMS[row]
    run = ss.solve(machine, periods=60)
    assert run.method == "exact" and last_period(run) == pytest.approx([velocity] * 3, abs=tolerance)


def test_hits_of_a_capsule_are_events_with_the_rate_of_the_gap():
    """C3: two hits a period."""
    run = ss.solve(problems.CAPSULE_3, periods=240)
    T = run.period_time
    hits = [event for event in run.events if event.kind == "hit" and event.t > 239 * T]
    assert [(event.t / T) % 1 for event in hits] == pytest.approx([0.2239834690, 0.9352746224], abs=1e-10)
    assert [event.velocity for event in hits] == pytest.approx([-1.0695823230, -3.3208859451], abs=1e-9)
    assert {event.part for event in hits} == {"inner-capsule"}
    (twice,) = np.nonzero(run.t == hits[-1].t)  # v stands there before and after the hit
    assert np.diff(run.v[twice], axis=0)[0] @ [1.0, problems.CAPSULE_3.mass] == pytest.approx(0.0, abs=1e-12)


def agrees(machine, judge="dop853", **options):
    """Assert that a run has the events of the judge's, at the same instants."""
    ours, theirs = (ss.solve(machine, **options, **more) for more in ({}, {"method": judge, "rtol": 1e-12}))
    assert ours.method == "exact" and theirs.method == judge
    mine, other = (sorted(run.events, key=lambda event: (round(event.t, 8), event.part, event.kind)) for run in (ours, theirs))
    assert [(e.kind, e.part, e.before, e.after) for e in mine] == [(e.kind, e.part, e.before, e.after) for e in other]
    assert [e.t for e in mine] == pytest.approx([e.t for e in other], abs=1e-10)
    return ours


def test_three_blocks_in_a_row_have_the_events_of_the_judge():
    start = {"x": [-1.0, 1.0, -1.0], "v": [-1.0, 1.0, 1.0]}
    assert len(agrees(problems.ThreeBlocks(), duration=5.0, start=start).events) > 8


def test_four_inertias_with_three_clutches_have_the_events_of_the_judge():
    run = agrees(problems.Clutches(), periods=3)
    assert len(run.events) > 20
    assert abs(run.slip[run.mode == 0]).max() < 1e-14
    assert np.all((abs(run.friction_force) <= problems.Clutches().mu * run.load * (1 + 1e-12))[run.mode == 0])


@pytest.mark.parametrize(
    "drive", [ss.drives.TwoPhase(stroke=1e-3, u1=0.05, u2=0.2), ss.drives.BangBang.example()], ids=lambda d: type(d).__name__
)
def test_modules_with_drives_in_pieces_may_be_shifted(drive):
    """The breaks and jumps of each module come at instants of its own."""
    module = ss.Robot(problems.BODY, problems.INNER, drive, problems.LOW)
    agrees(problems.chain(0.0, 1.3, modules=(module, module)), periods=3)


def test_the_mean_velocity_of_a_body_and_of_the_centre_of_mass():
    run = ss.solve(problems.chain(0.0, math.pi / 2), periods=200)
    whole = ss.mean_velocity(run)
    assert whole == pytest.approx(0.002938713863365, abs=1e-14)
    assert [ss.mean_velocity(run, body=body) for body in (0, "module 2")] == pytest.approx([whole, whole], abs=1e-14)
    with pytest.raises(ss.InputError, match="module 1"):
        ss.mean_velocity(run, body="tail")


def test_a_batch_of_chains_has_the_velocities_of_single_runs():
    phases = np.linspace(0.3, 3.0, 5)
    many = ss.solve(problems.chain(0.0, 0.0).replace({"phases.1": phases}), periods=300)
    one = [ss.mean_velocity(ss.solve(problems.chain(0.0, phase), periods=300)) for phase in phases]
    assert many.mean_velocity == pytest.approx(one, abs=1e-14)


def test_relabelled_modules_move_alike_and_are_fastest_in_antiphase():
    """M2f: V(phi) = V(-phi)."""
    phases = np.linspace(0.2, math.pi, 12)
    pair = problems.chain(0.0, 0.0)
    ahead, behind = (ss.solve(pair.replace({"phases.1": sign * phases}), periods=400).mean_velocity for sign in (1.0, -1.0))
    assert ahead == pytest.approx(behind, abs=1e-13)
    assert np.argmax(ahead) == len(phases) - 1


@pytest.mark.parametrize(("part", "velocity"), [(0.1, 0.013499221218459), (0.03, 0.013777958842997)])
def test_of_little_friction_the_mean_velocity_tends_to_that_of_averaging(part, velocity):
    """M2m: the sum of N_i asin(V / a_i) is that of both coefficients' difference, over small friction; .013879347947520 in the limit."""
    module = problems.module(ss.Coulomb(0.15 * part, 0.21 * part))
    run = ss.solve(problems.chain(0.0, math.pi / 2, modules=(module, module)), periods=round(400 / part))
    assert last_period(run) == pytest.approx([velocity] * 2, rel=1e-9)


def test_the_power_of_two_modules_in_antiphase():
    """M2u: joules in a period, of each contact, of the damper and of the drives."""
    run = ss.solve(problems.chain(0.0, math.pi), periods=200)
    balance = ss.energy(run)
    assert balance.friction[-1] == pytest.approx(2 * 1.0293e-4, rel=1e-4)
    assert balance.damping[-1] == pytest.approx(4.5525075e-5, rel=1e-7)
    assert balance.drive[-1] == pytest.approx(2.51393012e-4, rel=1e-8)
    power, weight = balance.drive[-1] / run.period_time, 2 * (problems.BODY + problems.INNER) * 9.81
    assert power == pytest.approx(8.220551e-3, rel=1e-6)
    assert power / ss.mean_velocity(run) == pytest.approx(0.739265142, rel=1e-8)  # J/m
    assert power / ss.mean_velocity(run) / weight == pytest.approx(0.522813389, rel=1e-8)  # cost of transport


@each_row("phase", [0.0, 1.0, math.pi])
def test_a_pair_starts_where_either_module_alone_would(phase):
    """M2w: at rest with a relaxed spring the border is that of one module, mu+ P g / (m omega^2), at any phase."""
    border = 0.15 * (problems.BODY + problems.INNER) * 9.81 / (problems.INNER * (65.4 * math.pi) ** 2)
    assert border == pytest.approx(0.26500326e-3, abs=5e-12)  # its last printed digit is 1e-11
    for amplitude, moves in ((border * (1 - 1e-9), False), (border * (1 + 1e-6), True)):
        run = ss.solve(problems.chain(0.0, phase, modules=(problems.module(amplitude=amplitude),) * 2), periods=3)
        assert bool(np.any(run.mode != 0)) == moves


@dataclass(frozen=True, eq=False)
class LaterWorm(problems.Worm):
    """The worm, whose wave is somewhere else when it starts."""

    begin: float = 0.0

    def links(self):
        omega = 2 * math.pi * self.frequency
        first, last = (problems.Wave(self.amplitude, omega, self.begin + phase, "cosines") for phase in (0.0, self.lag))
        return {("head", "middle"): first, ("middle", "tail"): last}


def test_feet_that_take_over_from_one_another_do_not_chatter():
    """At the handover two slips are zero at once, as well as the instant is known; every thirtieth start went to and fro there for ever."""
    random = np.random.default_rng(0)
    worms = LaterWorm(0.2, 0.2, 5.0, begin=random.uniform(-3, 3, 400))
    ends = strobe_map(worms, random.normal(size=(400, 1)) * 0.03, 3)
    assert np.all(ends.status == 0)
    worm = LaterWorm(0.2, 0.2, 5.0, begin=-0.46387667)
    start = coordinates(worm).start(np.array([0.01]))
    one, judge = (ss.solve(worm, periods=3, settle=0, start=start, **more) for more in ({}, {"method": "dop853", "rtol": 1e-12}))
    np.testing.assert_allclose(one.strobe_v, judge.strobe_v, atol=1e-13)
