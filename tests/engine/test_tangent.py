"""Exact derivatives: small changes that are carried along a motion, against differences of exact runs and numbers of the reference.

Differences: two steps of central differences and Richardson's extrapolation; its error is some h^4 of the fifth derivative and 1e-16/h of
rounding, with h = 2e-5 of a number's size below 1e-9 unless a map bends much, which the two steps show.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import problems
import stickslip as ss
from problems import chain, module
from rows import each_row
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.dynamics.derivatives.slopes import number_slopes, start_changes
from stickslip.dynamics.derivatives.tangents import Directions, changes_along, jacobian_of
from stickslip.dynamics.periodic.given_states import states_of
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, flow_map, state_at_rest, strobe_map
from stickslip.engine import lanes
from stickslip.engine.tangent import tangent
from stickslip.engine.trace import numbers_of, trace
from stickslip.maths import sin

slow = pytest.mark.slow
STEP = 2e-5
BELT = ss.BlockOnBelt(1.0, 2.0, 0.1, ss.Coulomb(0.2, 0.2, f_plus=0.3, f_minus=0.3), load=1.0)


def robot(law=None, drive=None):
    return ss.Robot(0.06259, 0.00948, drive or ss.Harmonic(6e-4, 65.4 * math.pi), law or ss.Coulomb(0.15, 0.21))


MACHINES = {
    "chain of two": chain(0.0, math.pi / 2),
    "capsule with restitution": problems.CAPSULE_7,
    "capsule with an elastic stop": problems.CAPSULE_1,
    "three masses at prescribed distances": problems.WORMS["P3e"][0],
    "an instant within the period": problems.MASSES["K3"][0],
    "jumps whose instants move": robot(drive=ss.drives.TwoPhase.example()),
    "a belt, no period": BELT,
}
MORE = {
    "other modules": problems.COUPLED["M2j"][0],
    "impacts twice a period": problems.CAPSULE_3,
    "three blocks": problems.ThreeBlocks(),
    "clutches, bodies on bodies": problems.Clutches(),
    "a period by formula": robot(drive=ss.drives.ThreePhase.example()),
    "pieces": robot(drive=ss.drives.Trapezoid.example()),
    "friction that varies": robot().replace(track=ss.tracks.VaryingFriction(ss.Incline(0.03), depth=0.3)),
} | {law.__name__: robot(law.example()) for law in (ss.CoulombViscous, ss.Stribeck, ss.friction.Tabulated, ss.Viscous)}


def start_of(machine, seed=1):
    """A state that is not special: where a run has been after some periods, moved a little."""
    at, random = coordinates(machine), np.random.default_rng(seed)
    state = state_at_rest(machine) if machine.period is None else strobe_map(machine, state_at_rest(machine), 12).state
    return (state + 0.03 * at.scales * random.normal(size=state.shape))[0]


def ends(machine, state, span):
    """State and way after two periods, or a span."""
    found = strobe_map(machine, state, 2) if span is None else flow_map(machine, state, span)
    return np.append(found.state[0], found.displacement)


def richardson(f, x):
    """The derivative at 0 of f(step), and how far the two steps differ."""
    one, half = ((f(h) - f(-h)) / (2 * h) for h in (x, x / 2))
    return (4 * half - one) / 3, abs(one - half)


def directions_of(machine):
    """Names of the states and numbers that may change by themselves, each with its size."""
    own, at = dict(leaves(machine)), coordinates(machine)
    numbers = {name: abs(float(own[name])) or 1e-3 for name in numbers_of(machine) if not name.endswith(("drive.omega", "length"))}
    if isinstance(machine, ss.Robot):
        numbers |= {name: float(own[name]) for name in own if name == "drive.omega"}
    return dict(zip(at.names, at.scales, strict=True)), {name: size for name, size in numbers.items() if own[name] != 0}


@pytest.mark.parametrize("name", [*MACHINES, *(pytest.param(name, marks=slow) for name in MORE)])
def test_changes_by_the_start_and_by_every_number_are_those_of_exact_runs(name):
    machine = (MACHINES | MORE)[name]
    state, span = start_of(machine), 9.0 if machine.period is None else None
    places, numbers = directions_of(machine)
    sizes, count = [*places.values(), *numbers.values()], len(places) + len(numbers)
    starts = np.vstack([np.diag(list(places.values())), np.zeros((len(numbers), len(places)))])
    along = {n: sizes[i] * np.eye(count)[i] for i, n in enumerate(numbers, start=len(places))}
    found = changes_along(machine, np.tile(state, (count, 1)), starts, 1 if span else 2, Directions(along, span=span))
    exact = np.column_stack([found.change, found.way_change])
    units = np.append(coordinates(machine).scales, np.max(coordinates(machine).scales) * (span or 2 * float(machine.period)))
    own, bent = dict(leaves(machine)), 0
    for i, what in enumerate([*places, *numbers]):

        def moved(h, i=i, what=what):
            if i < len(places):
                return ends(machine, state + h * starts[i], span)
            return ends(replace_leaf(machine, {what: own[what] + h * sizes[i]}), state, span)

        differences, apart = richardson(moved, STEP)
        size = max(np.max(abs(differences / units)), 1e-3)
        bent += np.max(apart / units) > 1e-6 * size  # a map that bends so much says little by differences
        assert np.max(abs(exact[i] - differences) / units) <= 1e-7 * size + np.max(apart / units), what
    assert bent <= 1


@each_row("name", [*MACHINES, *MORE])
def test_the_step_of_every_tangent_can_be_written(name):
    """Also along every number; nothing is compiled. (A multiple of a sum had no rule.)"""
    machine = (MACHINES | MORE)[name]
    assert lanes.step_of(tangent(trace(machine), wrt=tuple(directions_of(machine)[1])), None, True).lines


def test_the_motion_itself_is_the_same_to_the_last_bit():
    """Changes ride along: no step, no event and no other state knows of them."""
    for machine in (MACHINES["chain of two"], MACHINES["capsule with restitution"], MACHINES["three masses at prescribed distances"]):
        state = start_of(machine)
        alone, together = strobe_map(machine, state, 5), changes_along(machine, state[None], np.ones((1, len(state))), 5)
        assert np.array_equal(alone.state, together.state)


def test_changes_of_a_chain_of_periods_are_products():
    machine = MACHINES["capsule with restitution"]
    state = start_of(machine)
    middle = strobe_map(machine, state, 2).state[0]
    together = jacobian_of(machine, middle, 3) @ jacobian_of(machine, state, 2)
    scales = coordinates(machine).scales
    np.testing.assert_allclose(jacobian_of(machine, state, 5) / scales[:, None] * scales, together / scales[:, None] * scales, atol=1e-12)


# ---- the mean velocity ----
def test_sensitivities_of_two_modules_are_those_of_the_reference():
    """Through four events; the reference has Richardson's differences of an independent exact solver."""
    found = ss.dynamics.sensitivity(chain(0.0, 2.0), wrt=["phases.1", "modules.*.friction.mu_plus"])
    assert found["phases.1"] == pytest.approx(0.0084111490, rel=1e-7)
    assert found["modules.*.friction.mu_plus"] == pytest.approx(-0.2055046907, rel=1e-7)
    assert found.velocity == pytest.approx(ss.periodic_orbit(chain(0.0, 2.0)).mean_velocity, rel=1e-12)


def test_the_same_phase_at_both_modules_moves_nothing():
    """A shift in time; and all that is known of V under a change of units is in its derivatives too."""
    pair = chain(0.0, 2.0)
    assert abs(ss.dynamics.sensitivity(pair, wrt="phases.*").mean_velocity[0]) < 1e-15
    found = ss.dynamics.sensitivity(pair)
    assert "modules.0.drive.omega" not in found.names  # alone it leaves the machine without a period
    by_mass = found.names[0] == "modules.0.body_mass"
    masses = [n for n in found.names if n.endswith("mass")] + ["link.stiffness", "link.damping"]
    assert by_mass and abs(sum(found.relative[found.names.index(n)] for n in masses)) < 1e-11  # V knows ratios of masses and forces only


@each_row("make", [lambda: robot(), lambda: problems.CAPSULE_3], ids=["robot", "capsule"])
def test_the_frequency_counts_as_differences_say(make):
    """The period changes with it: time, instants and the mean are all measured anew."""
    machine = make()
    name = "drive.omega" if isinstance(machine, ss.Robot) else "omega"
    value = dict(leaves(machine))[name]

    def V(h):
        return ss.periodic_orbit(machine.replace({name: value * (1 + h)})).mean_velocity

    differences, apart = richardson(V, 1e-4)
    assert ss.dynamics.sensitivity(machine, wrt=name).mean_velocity[0] * value == pytest.approx(float(differences), abs=float(apart))


def test_a_run_that_has_not_settled_has_the_derivatives_of_its_own_mean():
    machine, periods, settle = robot(ss.Coulomb(0.15, 0.21)), 9, 4

    def V(h):
        return ss.mean_velocity(ss.solve(machine.replace({"friction.mu_minus": 0.21 + h}), periods=periods, settle=settle))

    differences, apart = richardson(V, 1e-5)
    found = ss.dynamics.sensitivity(ss.solve(machine, periods=periods, settle=settle), wrt="friction.mu_minus")
    assert found.mean_velocity[0] == pytest.approx(float(differences), abs=float(apart) + 1e-9)


def test_laws_with_inner_states_go_the_same_way():
    """Steps are held to 1e-12; differences of steps of 1e-5 are good to 1e-6."""
    machine = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)

    def V(h):
        return ss.periodic_orbit(machine.replace({"drive.amplitude": 6e-4 * (1 + h)})).mean_velocity

    found = ss.dynamics.sensitivity(machine, wrt="drive.amplitude")
    assert found.mean_velocity[0] * 6e-4 == pytest.approx(float(richardson(V, 1e-4)[0]), rel=1e-6)


class Bent(ss.LuGre):
    """Bristles that the load has bent before a run begins."""

    def start(self, load):
        return self.mu_plus * load / self.sigma0


@dataclass(frozen=True, eq=False)
class Pressed(ss.Machine):
    """Two bodies; where the second stands decides how strongly it is pressed down."""

    stiffness: float
    gap: float
    friction: Any

    def bodies(self):
        return {"cam": ss.Body(1.0, position=self.gap), "pad": ss.Body(1.0, position=2.0 * self.gap)}

    def contacts(self):
        return {"pad": ss.Contact("pad", self.friction, load=lambda t, x: self.stiffness * x)}


@each_row("start", [{}, {"x": {"cam": 0.1}}, {"x": {"pad": 0.7}, "v": {"cam": 1.0}}, {"z": {"pad": 1e-3}}])
def test_a_run_begins_to_change_where_it_begins(start):
    """Positions that are asked for stay; bristles that nobody asked for are those of the load there."""
    machine, h = Pressed(30.0, 0.2, Bent.example()), 1e-4
    found = start_changes(machine, start, {name: np.eye(3)[i] for i, name in enumerate(("stiffness", "gap", "friction.sigma0"))}, 3)
    for row, (name, value) in zip(found, (("stiffness", 30.0), ("gap", 0.2), ("friction.sigma0", machine.friction.sigma0)), strict=True):
        above, below = (states_of(start or None, machine.replace({name: value * (1 + step)}))[0] for step in (h, -h))
        assert np.allclose(row, (above - below) / (2 * h * value), rtol=1e-7, atol=1e-13), name


def test_a_body_that_may_stand_anywhere_says_so():
    """Below the border of rest nothing moves it, and nothing holds the others together but the spring."""
    still = chain(0.0, 1.0, modules=(module(amplitude=1e-4),) * 2)
    found = ss.dynamics.sensitivity(ss.periodic_orbit(still, guess=state_at_rest(still)[0]), wrt="phases.1")
    assert found.mean_velocity[0] == 0.0 and "a multiplier is 1" in found.notes[0]


@each_row(
    ("call", "said"),
    [
        (lambda: ss.dynamics.sensitivity(chain(0.0, 2.0), wrt="drive.amplitud"), "'drive.amplitud' is not a number of Chain; .*amplitude"),
        (lambda: ss.dynamics.sensitivity(chain(0.0, 2.0), wrt="modules.0.drive.omega"), r"do not repeat after the period; .*'\*.omega'"),
        (lambda: ss.dynamics.sensitivity(robot(), wrt=[]), "wrt is empty"),
        (lambda: ss.dynamics.sensitivity(3), "3 is neither a machine"),
        (lambda: ss.dynamics.sensitivity(ss.PulledMass(1.0, 2.0, 0.1, ss.Coulomb(1.0, 1.0))), "PulledMass has no period, .*ss.solve"),
        (lambda: ss.dynamics.sensitivity(robot().replace({"drive.amplitude": np.array([5e-4, 6e-4])})), "is a batch"),
        (lambda: ss.dynamics.sensitivity(robot(ss.friction.Bristle(0.15, 0.21, 4e5))), "plain numbers only"),
        (lambda: tangent(trace(robot()), wrt=("mass",)), "'mass' is none of them"),
    ],
)  # fmt: skip
def test_what_has_no_derivative_here_says_why(call, said):
    with pytest.raises(ss.InputError, match=said):
        call()


# ---- where there is none ----
@dataclass(frozen=True, eq=False)
class Touching(ss.Machine):
    """v' = -sin t while it slides: from v = 2 it touches v = 0 at t = pi and goes on."""

    period = 2 * math.pi

    def bodies(self):
        return {"body": ss.Body(1.0, force=lambda t, x, v: 0.2 - sin(t))}

    def contacts(self):
        return {"pad": ss.Contact("body", ss.Coulomb(0.2, 0.2), load=1.0)}


def test_a_switch_that_is_touched_and_not_crossed_leaves_no_derivative():
    """On one side of it the body goes on (1), on the other it comes to rest and forgets (0)."""
    found = [float(jacobian_of(Touching(), np.array([v]))[0, 0]) for v in (2.1, 2.0, 1.9)]
    assert found[0] == 1.0 and math.isnan(found[1]) and found[2] == 0.0
    orbit = ss.periodic_orbit(Touching(), guess=[2.0])
    assert np.isnan(orbit.multipliers).all() and "touched without being crossed" in orbit.evidence and not orbit.stable


def test_numbers_behind_a_formula_have_slopes_too():
    """The period 2 pi/omega, by the machine's own line."""
    machine = robot()
    (slope,) = number_slopes(machine, {"drive.omega": np.ones(1)}, lambda m: [m.mechanics.period])
    omega = 65.4 * math.pi
    assert float(slope[0]) == pytest.approx(-2 * math.pi / omega**2, rel=1e-14)


def test_what_dwells_at_the_edge_of_a_dead_band_is_still_there_when_an_impulse_comes():
    """The body comes to the edge of Karnopp's band and stays: it has no rates before the impulse, whatever rounding makes of the edge."""
    law = ss.friction.Karnopp(mu_plus=0.0127, mu_minus=0.0199, f_plus=0.0195, f_minus=0.0199, width=1.3e-4)
    drive = ss.drives.TwoPhase(stroke=0.074, u1=0.25, u2=1.22)
    robot = ss.Robot(body_mass=0.0153, inner_mass=9e-4, drive=drive, friction=law, gravity=1.955)

    def speed(u1: float) -> float:
        return ss.mean_velocity(ss.solve(robot.replace({"drive.u1": u1}), periods=2, rtol=1e-11))

    step = 1e-4 * drive.u1
    differences = (speed(drive.u1 + step) - speed(drive.u1 - step)) / (2 * step)
    found = ss.dynamics.sensitivity(ss.solve(robot, periods=2, rtol=1e-11), "drive.u1")["drive.u1"]
    assert found == pytest.approx(differences, rel=1e-7)
