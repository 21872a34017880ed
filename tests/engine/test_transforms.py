"""What is made of a system: its mirror image, another beginning of time, and integrals that ride along."""

from __future__ import annotations

import math

import numpy as np
import pytest

import problems
import stickslip as ss
from engine.transformed_systems import mirrored, shifted
from problems import chain
from stickslip.engine import lanes, tableaux
from stickslip.engine.tangent import with_observables
from stickslip.engine.trace import trace
from stickslip.models.machine_adapter import machine_of
from stickslip.solvers.lane_tables import CaseTable


def robot(law=None, drive=None):
    return ss.Robot(0.06259, 0.00948, drive or ss.Harmonic(6e-4, 65.4 * math.pi), law or ss.Coulomb(0.15, 0.21))


MACHINES = {
    "robot": robot(),
    "chain": chain(0.0, math.pi / 2),
    "hits": problems.CAPSULE_7,
    "elastic stop": problems.CAPSULE_1,
    "jumps": robot(drive=ss.drives.TwoPhase.example()),
    "bristle": ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4),
    "memory": robot(ss.friction.GMS.example()),
    "prescribed distances": problems.WORMS["P3e"][0],
}


def run(machine, made, state, periods=3):
    """The way and the states at the end of a run of what is made of a machine's system."""
    dynamic, mechanics = machine_of(machine).has_inner_states, machine_of(machine).mechanics
    kernel = lanes.kernel_of(machine, tableaux.RODAS5P if dynamic else None, False, made=made)
    width = 2 * mechanics.coordinates + sum(law.states + law.modes for law in mechanics.laws)
    start = CaseTable(machine, kernel, np.zeros((1, width)), machine.period)
    begin = np.concatenate([[0.0], state, np.zeros(kernel.states - len(state) + kernel.modes)])[None]
    return lanes.run(kernel, start.rows, begin, lanes.Job(periods, 0, False, 1e-10, 0.75, 1e6)).end[0]


def moving(machine, seed=0):
    """A state in which all bodies move, and nothing else is off its place."""
    system, state = trace(machine), np.zeros(trace(machine).states)
    state[: system.coordinates] = 0.03 * np.random.default_rng(seed).normal(size=system.coordinates)
    return state


QUICK = ("robot", "hits", "jumps")  # the others in full runs: each is a kernel of its own
SOME = [pytest.param(name, marks=[] if name in QUICK else pytest.mark.slow) for name in MACHINES]


@pytest.mark.parametrize("name", SOME)
def test_a_machine_in_the_mirror_does_the_mirrored_motion(name):
    """Forwards and backwards have different friction; what the engine writes knows no side by itself."""
    machine, state = MACHINES[name], moving(MACHINES[name])
    there, here = run(machine, mirrored, -state), run(machine, None, state)
    np.testing.assert_allclose(there, -here, rtol=1e-13, atol=1e-14 * np.max(abs(here)))


@pytest.mark.parametrize("name", SOME)
def test_a_machine_that_begins_later_is_where_the_other_one_goes_on(name):
    """Twice later by parts that make up a period is the machine itself: clocks and impulses come back to their places."""
    machine, state = MACHINES[name], moving(MACHINES[name])

    def around(system):
        return shifted(shifted(system, 0.3), 0.7)

    here = run(machine, None, state)
    within = 1e-6 if machine_of(machine).has_inner_states else 1e-12  # steps held to 1e-10 end elsewhere; bristles are of 1e-7 m
    np.testing.assert_allclose(run(machine, around, state), here, rtol=within, atol=1e-13 * np.max(abs(here)))


def test_a_quarter_of_a_period_later_the_drive_is_a_quarter_ahead():
    """By a robot whose drive has that phase: the tones cos and sin of two harmonics."""
    first, later = (ss.MultiHarmonic(omega=200.0, amplitudes=(6e-4, 1e-4), phases=p) for p in ((0.0, 0.4), (math.pi / 2, 0.4 + math.pi)))

    def ahead(system):
        return shifted(system, 0.25)

    here, there = run(robot(drive=later), None, [0.01]), run(robot(drive=first), ahead, [0.01])
    np.testing.assert_allclose(there, here, rtol=1e-12, atol=1e-15)


def test_an_observable_is_an_integral_that_no_event_disturbs():
    """The integral of v is the way; the motion beside it is the same to the last bit, and its way to rounding of a sum of periods."""

    def observed(system):
        return with_observables(system, {"way": system.y[0], "time": system.graph.constant(1.0)})

    machine = robot()
    alone, (x, v, way, time) = run(machine, None, [0.0], 7), run(machine, observed, [0.0], 7)
    assert v == alone[1] and x == pytest.approx(alone[0], rel=1e-15) and way == pytest.approx(x, rel=1e-12)
    assert time == pytest.approx(7 * machine.period, rel=1e-14)
