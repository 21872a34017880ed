"""Orbits, branches, basins and exponents of machines of several bodies.

Numbers of two and three modules: exact linear flow between events with enumeration of modes, and DOP853 with a Moreau step, which agree to
1e-13 in V; multipliers to the digits that are printed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from problems import CAPSULE_1, CAPSULE_3, CAPSULE_7, Worm, chain, module
from rows import each_row
from stickslip.dynamics.attractors import settled_motions as rule, starts_run_on
from stickslip.dynamics.derivatives.tangents import jacobian_of, orders_differ
from stickslip.dynamics.stroboscopic.differences import difference_jacobian
from stickslip.dynamics.stroboscopic.strobe_maps import (
    coordinates,
    flight,
    state_at_rest,
    strobe_map,
    strobe_orbit,
    strobe_points,
    strobe_states,
)
from stickslip.maths import pi, sin

#: Central differences with steps of 1e-6 of the scales: their error is some 1e-12 of curvature and 1e-16/1e-6 of rounding.
DIFFERENCES = 2e-8
#: Steps are chosen for the motion, and a change of a bristle dies out in a layer that they need not resolve: at 1e-12 it is off by 4e-8.
STIFF = 1e-7
RISING = [0.0, math.pi / 2, math.pi]
KNOWN = {
    "in phase": ((0.0, 0.0), 0.002383491055471, [0.555131359, 0.0, 0.0]),
    "a quarter": ((0.0, math.pi / 2), 0.002938713863365, [0.456696996, 0.012462307, 0.0]),
    "antiphase": ((0.0, math.pi), 0.011119895989126, [0.46120368 + 0.30143666j, 0.46120368 - 0.30143666j, 0.43483457]),
    "three": (
        tuple(RISING),
        0.002622117520593,
        [0.593773565, -0.518006822, 0.006906895 + 0.008750577j, 0.006906895 - 0.008750577j, 0.0],
    ),
}


@dataclass(frozen=True, eq=False)
class Tow(ss.Machine):
    """A shaken head tows a sledge; both may stand on a belt, and a spring may hold the sledge."""

    friction: Any
    push: float = 0.3
    stiffness: float = 300.0
    speed: float = 0.0
    ground: Any = None

    period = 0.03

    def bodies(self):
        shaken = ss.Body(0.07, force=lambda t, x, v: self.push * sin(2 * pi / self.period * t))
        return {"head": shaken, "sledge": ss.Body(0.03)}

    def contacts(self):
        return {name: ss.Contact(name, self.friction, on=self.speed) for name in ("head", "sledge")}

    def links(self):
        held = {} if self.ground is None else {("sledge", None): self.ground}
        return {("head", "sledge"): ss.Spring(self.stiffness, 0.1), **held}


@dataclass(frozen=True, eq=False)
class Alone(ss.Machine):
    """A robot that lists its parts."""

    robot: Any

    @property
    def period(self):
        return self.robot.period

    def bodies(self):
        def force(t, x, v):
            return self.robot.total_mass * self.robot.acceleration(t, x, v, 0.0)

        return {"block": ss.Body(self.robot.total_mass, force=force)}

    def contacts(self):
        return {"pad": ss.Contact("block", self.robot.friction, load=self.robot.load)}


@dataclass(frozen=True, eq=False)
class Rider(ss.Machine):
    """A mass that lies on a shaken cart: no spring, so that no force depends on where it lies."""

    friction: Any
    push: float = 0.9

    period = 0.03

    def bodies(self):
        return {"cart": ss.Body(0.07, force=lambda t, x, v: self.push * sin(2 * pi / self.period * t)), "rider": ss.Body(0.03)}

    def contacts(self):
        return {"wheel": ss.Contact("cart", self.friction, load=1.0), "seat": ss.Contact("rider", self.friction, on="cart", load=0.3)}


LOW, HIGH = ss.Coulomb(0.1, 0.2), ss.Coulomb(0.1, 0.2, f_plus=0.15, f_minus=0.3)
LUGRE = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)


def lugre_chain(phase):
    return ss.Chain((LUGRE, LUGRE), link=ss.Spring(1200.0, 0.4), phases=(0.0, phase))


def off_by(orbit):
    """How far the monodromy matrix is from differences of the map, in scales."""
    at = coordinates(orbit.model)
    sizes = at.scales[: at.smooth]
    J = difference_jacobian(orbit.model, orbit.state, orbit.period, orbit.rtol)
    return float(np.max(abs(orbit.monodromy - J) / sizes[:, None] * sizes))


@pytest.fixture(scope="module")
def orbits():
    return {name: ss.periodic_orbit(chain(*phases)) for name, (phases, *_) in KNOWN.items()}


# ---- the strobe state ----
def test_coordinates_are_velocities_inner_states_and_differences_by_name():
    assert coordinates(chain(0.0, 1.0)).names == ("v.module 1", "v.module 2", "l.module 2")
    assert coordinates(lugre_chain(1.0)).names == ("v.module 1", "v.module 2", "z.module 1.0", "z.module 2.0", "l.module 2")
    assert coordinates(Tow(LOW, ground=ss.Spring(50.0))).names == ("v.head", "v.sledge", "x.head", "x.sledge")
    assert coordinates(Rider(LUGRE.friction)).names == ("v.cart", "v.rider", "z.wheel.0", "z.seat.0")
    assert coordinates(Worm(0.1, 0.2, frequency=2.0)).names == ("v.head",)  # the centre of mass alone moves by itself
    assert coordinates(LUGRE).names == ("v", "z")


def test_the_map_gives_the_strobe_states_of_a_run():
    """The lanes that keep a record and those that do not give the same bits; a batch gives what its cases give alone."""
    pair = chain(0.0, 1.0)
    states = np.array([[0.02, -0.01, 1e-5], [0.0, 0.03, -2e-5]])
    ends = strobe_map(pair, states, 7)
    for state, end, way in zip(states, ends.state, ends.displacement, strict=True):
        run = flight(pair, state, 7)
        assert np.array_equal(strobe_states(run)[0], state)
        np.testing.assert_allclose(strobe_states(run)[-1], end, atol=1e-15)
        assert way == pytest.approx(np.mean(run.strobe_x[-1] - run.strobe_x[0]), abs=1e-15)
    assert coordinates(pair).start(states)["v"]["module 2"].tolist() == [-0.01, 0.03]


def test_a_run_from_rest_starts_where_the_coordinates_say():
    pair = chain(0.0, 1.0, link=ss.Spring(1200.0, 0.4, length=0.05))
    assert state_at_rest(pair).tolist() == [[0.0, 0.0, -0.05]]
    assert ss.periodic_orbit(pair).mean_velocity == pytest.approx(ss.periodic_orbit(chain(0.0, 1.0)).mean_velocity, rel=1e-9)


# ---- orbits ----
@pytest.mark.parametrize("name", KNOWN)
def test_orbits_of_chains_have_the_mean_velocity_and_the_multipliers_of_the_reference(name, orbits):
    orbit, (_, V, multipliers) = orbits[name], KNOWN[name]
    assert orbit.mean_velocity == pytest.approx(V, rel=1e-11) and orbit.stable
    np.testing.assert_allclose(orbit.multipliers, multipliers, atol=2e-9 if name != "antiphase" else 6e-9)  # the digits that are printed
    assert off_by(orbit) < DIFFERENCES and orbit.evidence == "tangent of the system along the orbit, through every switch"


def test_as_many_multipliers_are_exactly_zero_as_contacts_rest_at_one_instant(orbits):
    zeros = {name: int(np.sum(orbit.multipliers == 0.0)) for name, orbit in orbits.items()}
    assert zeros == {"in phase": 2, "a quarter": 1, "antiphase": 0, "three": 1}


def test_contacts_that_switch_together_are_followed_in_both_orders(orbits):
    """In phase all switches of the two modules come together, and as neither stops the other their order does not matter."""
    run = orbits["in phase"].run
    assert np.max(np.sum(np.diff(run.pieces.mode, axis=0) != 0, axis=1)) == 2
    assert not orders_differ(run.model, orbits["in phase"].state)
    assert orbits["in phase"].patterns == {"module 1": "+-0", "module 2": "+-0"}


def test_sensitivities_of_the_mean_velocity_through_four_events():
    def V(phase, mu):
        own = (module(ss.Coulomb(mu, 0.21)),) * 2
        return ss.periodic_orbit(chain(0.0, phase, modules=own)).mean_velocity

    h = 1e-4  # errors of h² and of 1e-14/h
    assert (V(2 + h, 0.15) - V(2 - h, 0.15)) / (2 * h) == pytest.approx(0.0084111490, rel=1e-7)
    assert (V(2, 0.15 + h / 10) - V(2, 0.15 - h / 10)) / (h / 5) == pytest.approx(-0.2055046907, rel=1e-7)


def test_an_orbit_of_a_lugre_chain_is_what_a_long_run_settles_on():
    pair = lugre_chain(math.pi / 2)
    orbit = ss.periodic_orbit(pair)
    run = ss.solve(pair, periods=60, settle=40, rtol=1e-10)
    assert orbit.mean_velocity == pytest.approx(0.002560519884429, rel=1e-9)
    assert ss.mean_velocity(run) == pytest.approx(orbit.mean_velocity, rel=1e-8)
    assert coordinates(pair).distance(strobe_states(run)[-1], orbit.state) < 1e-8
    assert off_by(orbit) < DIFFERENCES and orbit.stable


@pytest.mark.parametrize(
    ("machine", "V", "multipliers"),
    [
        (CAPSULE_1, 0.165538436583, None),
        (CAPSULE_3, 0.039424641879, [0.0558001 + 0.1795645j, 0.0558001 - 0.1795645j, 0.0]),
        (CAPSULE_7, 0.024995142088, [0.437051911, 0.026178176, 0.0]),
    ],
)  # fmt: skip
def test_orbits_of_capsules(machine, V, multipliers):
    """An elastic stop is a force, and one that throws back a reset: disturbances are followed through both."""
    orbit = ss.periodic_orbit(machine)
    assert orbit.mean_velocity == pytest.approx(V, rel=1e-10)
    assert off_by(orbit) < DIFFERENCES
    if multipliers is not None:
        np.testing.assert_allclose(orbit.multipliers, multipliers, atol=1e-7)


def test_a_worm_forgets_everything_when_its_feet_hold():
    """Prescribed distances leave one velocity, and where two feet rest together it is lost."""
    orbit = ss.periodic_orbit(Worm(0.1, 0.3, frequency=2.0))
    assert orbit.mean_velocity == pytest.approx(0.012, abs=1e-13) and abs(orbit.multipliers).max() < 1e-9


@pytest.mark.parametrize(
    ("machine", "within"),
    [
        (Tow(LOW), DIFFERENCES), (Tow(HIGH), DIFFERENCES), (Tow(LOW, ground=ss.Spring(50.0), speed=0.02), DIFFERENCES),
        (Rider(LUGRE.friction), STIFF),
    ],
    ids=["tow", "static above kinetic", "a belt and a wall", "rider"],
)  # fmt: skip
def test_the_monodromy_matrix_of_any_machine_is_the_slope_of_its_map(machine, within):
    """Static friction above kinetic makes every break-away a jump, whose instant depends on the spring and on the other body."""
    orbit = ss.periodic_orbit(machine)
    assert off_by(orbit) < within and orbit.residual < 1e-11


def test_a_robot_that_lists_its_parts_has_the_orbit_of_the_robot():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    listed, plain = ss.periodic_orbit(Alone(robot)), ss.periodic_orbit(robot)
    assert listed.names == ("v.block",) and listed.patterns == {"pad": "+-"}
    np.testing.assert_allclose(listed.multipliers, plain.multipliers, rtol=1e-9)
    assert listed.mean_velocity == pytest.approx(plain.mean_velocity, rel=1e-12)


def test_a_body_that_rests_all_the_time_is_neutral_and_not_unstable():
    """The sledge may stand anywhere nearby: the multiplier of that is 1, and the head forgets."""
    orbit = ss.periodic_orbit(Tow(HIGH, ground=ss.Spring(50.0)))
    assert orbit.patterns["sledge"] == "0" and orbit.mean_velocity == pytest.approx(0.0, abs=1e-15)
    assert abs(orbit.multipliers[0]) == pytest.approx(1.0, abs=1e-8) and abs(orbit.multipliers[1]) < 1.0
    assert "neutral" in repr(orbit) and "may rest anywhere nearby" in orbit.evidence


# ---- branches, basins, exponents ----
def test_a_branch_along_the_phase_passes_the_known_chains(orbits):
    branch = ss.continuation(chain(0.0, 1.8), parameter="phases.1", start=1.5, stop=math.pi, step=0.2)
    assert branch.ended == "it reached the end of the range"
    assert branch.orbits[-1].mean_velocity == pytest.approx(KNOWN["antiphase"][1], rel=1e-11)
    assert branch.at(math.pi / 2).mean_velocity == pytest.approx(KNOWN["a quarter"][1], rel=1e-11)
    assert branch.points.patterns.sel(contact="module 1").values[-1] == "+-"
    assert ss.plot.continuation(branch).get_ylabel().startswith("mean velocity")
    for special in branch.special:  # the patterns differ on its two sides
        beside = [branch.at(special.value + side).patterns for side in (-1e-6, 1e-6)]
        assert beside[0] != beside[1]
    assert [s.kind for s in branch.special] == ["type-border"] * 2


def test_a_capsule_doubles_its_period_where_its_runs_do():
    """The flip of the published capsule's preset: continuation against runs on both sides, and both in one picture."""
    branch = ss.continuation(ss.presets.capsule, parameter="omega", start=1.19, stop=1.17)
    (flip,) = (special for special in branch.special if special.kind == "flip")
    assert flip.value == pytest.approx(1.1765165116, abs=1e-9)
    assert flip.orbit.differences[0] == pytest.approx(-1.0, abs=1e-6), "by differences of the strobe map"
    beside = ss.bifurcation(ss.presets.capsule, parameter="omega", values=flip.value + np.array([-4e-3, 4e-3]), settle=1500, follow=False)
    assert beside.period.values.tolist() == [[2, 1]]
    doubled = branch.doubled(stop=1.17)
    ax = ss.plot.continuation([branch, doubled], diagram=beside)
    assert ax.get_ylabel() == "velocity of body on the strobe (mm/s)"
    assert {"flip", "unstable", "brute force"} <= {text.get_text() for text in ax.get_legend().get_texts()}
    drawn = ss.plot.continuation(doubled, "v.inner", special=False).lines
    states = [state[1] for state in strobe_states(doubled.orbits[-1].run)[:2]]
    assert {min(states), max(states)} <= {float(y) for line in drawn for y in line.get_ydata()}, "both strobe points are drawn"
    states = [state[1] for state in strobe_states(doubled.at(flip.value - 4e-3).run)[:2]]
    assert sorted(states) == pytest.approx(sorted(beside["v.inner"].values[0, 0, -2:]), abs=1e-6)
    assert ss.plot.continuation(branch, "mean_velocity").get_ylabel().startswith("mean velocity")
    assert ss.plot.bifurcation(beside).get_ylabel() == ax.get_ylabel()


@pytest.mark.slow
def test_the_branch_goes_back_to_equal_phases():
    """Down to modules in phase, where all events of both come together."""
    branch = ss.continuation(chain(0.0, 1.5), parameter="phases.1", start=math.pi / 2, stop=0.0)
    assert branch.orbits[-1].mean_velocity == pytest.approx(KNOWN["in phase"][1], rel=1e-11)


def test_basins_over_two_velocities_are_what_single_runs_settle_on():
    pair, axis = chain(0.0, 1.0), [-0.05, 0.0, 0.04]
    found = ss.basins(pair, settle=150, **{"v.module 1": axis, "v.module 2": axis})
    assert found.map.sizes == {"v.module 1": 3, "v.module 2": 3} and found.map["v.module 1"].units == "m/s"
    for i, j in ((0, 2), (2, 1)):
        run = ss.solve(pair, periods=200, settle=150, start={"v": {"module 1": axis[i], "module 2": axis[j]}})
        assert float(found.map.mean_velocity[i, j]) == pytest.approx(ss.mean_velocity(run), rel=1e-10)
    assert found.attractors[0].orbit.stable and found.fractions == [1.0]


def test_bodies_that_stop_anywhere_are_one_attractor():
    """Below the border of rest both modules stop where they happen to be, at another length of the spring each time.

    The starts are so slow that the spring, at most 5e-5 m longer, pulls with .06 N; friction bears .1 N, of which the drive asks .04 N.
    """
    pair = chain(0.0, 1.0, modules=(module(amplitude=1e-4),) * 2)
    found = ss.basins(pair, settle=20, **{"v.module 1": [-0.008, 0.0, 0.01], "v.module 2": [0.0]})
    ends = strobe_map(pair, [[v, 0.0, 0.0] for v in (-0.008, 0.0, 0.01)], 20).state
    assert np.ptp(ends[:, 2]) > 1e-5 and not ends[:, :2].any()
    assert len(found.attractors) == 1 and found.attractors[0].mean_velocity == 0.0


@pytest.mark.parametrize("name", ["in phase", "a quarter"])
def test_exponents_of_a_chain_are_the_logarithms_of_its_multipliers(name, orbits):
    orbit = orbits[name]
    found = ss.lyapunov(orbit.model, periods=20, settle=60)
    with np.errstate(divide="ignore"):
        np.testing.assert_allclose(found.spectrum, np.log(abs(orbit.multipliers)), atol=1e-9)


def test_exponents_of_a_rotating_pair_have_its_sum_and_the_neighbours_its_mean(orbits):
    """A pair of multipliers turns, so single exponents come as slowly as 1/n; the volume shrinks evenly."""
    orbit = orbits["antiphase"]
    found = ss.lyapunov(orbit.model, periods=40, settle=80)
    assert found.spectrum.sum() == pytest.approx(np.log(abs(orbit.multipliers)).sum(), abs=1e-6)
    batch = chain(0.0, 1.0).replace({"phases.1": np.array([math.pi, 2.0])})
    largest, error = ss.dynamics.largest_exponents(batch, periods=100, settle=80)
    assert abs(largest[0] - math.log(abs(orbit.multipliers[0]))) < max(4 * error[0], 0.005)
    told = ss.verdict(orbit.model, periods=20, settle=80)
    assert (told.kind, told.period) == ("periodic", 1) and told.orbit.mean_velocity == pytest.approx(KNOWN["antiphase"][1], rel=1e-11)


def test_exponents_of_a_machine_of_ones_own():
    machine = Tow(LOW)
    orbit, found = ss.periodic_orbit(machine), ss.lyapunov(machine, periods=20, settle=100)
    with np.errstate(divide="ignore"):
        np.testing.assert_allclose(found.spectrum, np.log(abs(orbit.multipliers)), atol=1e-6)
    assert ss.dynamics.largest_exponents(machine, periods=40, settle=100)[0][0] == pytest.approx(found.largest, abs=1e-6)


def test_a_diagram_and_a_map_over_the_phase():
    values = [1.0, 2.0, math.pi]
    found = ss.bifurcation(chain(0.0, 1.0), parameter="phases.1", values=values, settle=150, points=8, follow=False)
    assert found["v.module 1"].attrs["long_name"] == "velocity of module 1 on the strobe" and "v_max" not in found
    assert float(found.mean_velocity[0, -1]) == pytest.approx(KNOWN["antiphase"][1], rel=1e-10)
    told = ss.dynamics.chaos_map(lambda phase: chain(0.0, 1.0).replace({"phases.1": phase}), phase=values, settle=150, periods=20)
    assert told.period.values.tolist() == [1, 1, 1]
    assert float(told.exponent[-1]) == pytest.approx(math.log(abs(KNOWN["antiphase"][2][0])), abs=1e-5)


# ---- sections ----
def test_sections_of_a_chain_have_an_axis_of_bodies(orbits):
    run = orbits["a quarter"].run
    points = ss.dynamics.strobe(run, settle=0)
    assert points.v.dims == ("point", "body") and points.v.sel(body="module 2")[0] == orbits["a quarter"].state[1]
    section = ss.dynamics.poincare(ss.solve(run.model, periods=120), on="v.module 1", direction=1)
    assert section.phase[-1] == pytest.approx(0.1103776907, abs=1e-9)  # module 1 starts forwards
    assert section.displacement[-1] == pytest.approx(KNOWN["a quarter"][1] * run.period_time, rel=1e-9)


# ---- what is refused ----
@each_row(
    ("call", "said"),
    [
        (lambda: ss.dynamics.switching_flow(chain(0.0, 1.0)), "allowed is one body on one contact, .* its modes are those of one contact"),
        (lambda: ss.basins(chain(0.0, 1.0), v=[0.0]), "'v' is not a coordinate of the start; known: v.module 1, v.module 2"),
        (lambda: ss.periodic_orbit(chain(0.0, 1.0), guess={"v": {"module 3": 1.0}}), "has no 'module 3'; did you mean"),
        (lambda: ss.periodic_orbit(chain(0.0, 1.0), guess=[0.0]), "allowed are the numbers v.module 1, v.module 2, l.module 2"),
        (lambda: ss.periodic_orbit(chain(0.0, 1.0).replace({"link.stiffness": 0.0})), "they drift apart and never come back"),
        (lambda: ss.dynamics.poincare(ss.solve(chain(0.0, 1.0), periods=2)), "'v' is not a column with one number .*; known: x.module 1"),
    ],
)  # fmt: skip
def test_what_cannot_take_several_bodies_says_what_to_type(call, said):
    with pytest.raises(ss.InputError, match=said):
        call()


def test_a_run_of_other_bodies_is_no_guess():
    run = ss.solve(chain(0.0, 1.0), periods=2)
    with pytest.raises(ss.InputError, match=r"the run has bodies module 1, module 2 .*allowed is a run of bodies head, sledge"):
        ss.periodic_orbit(Tow(LOW), guess=run)
    with pytest.raises(ss.InputError, match="allowed is one body on one contact"):
        ss.periodic_orbit(module(), guess=run)


def test_the_monodromy_matrix_of_a_run_that_does_not_repeat():
    """The slope of seven periods from any start is the product of the seven of one."""
    pair, state = chain(0.0, 1.0), np.array([0.02, -0.01, 1e-5])
    run, sizes = flight(pair, state, 7), coordinates(pair).scales
    one_by_one = np.eye(3)
    for begun in strobe_states(run)[:-1]:
        one_by_one = jacobian_of(pair, begun) @ one_by_one
    scaled = abs(jacobian_of(pair, state, 7) - one_by_one) / sizes[:, None] * sizes
    assert scaled.max() < 1e-8


def _random_machine(random, number):
    if number % 2:
        own = tuple(
            module(ss.Coulomb(*random.uniform(0.05, 0.4, 2)), amplitude=random.uniform(3e-4, 9e-4), body=random.uniform(0.03, 0.12))
            for _ in range(2)
        )
        return chain(0.0, random.uniform(-3, 3), modules=own, link=ss.Spring(random.uniform(100, 3000), random.uniform(0, 1)))
    kinetic = random.uniform(0.05, 0.3, 2)
    law = ss.Coulomb(*kinetic, *(kinetic * random.uniform(1, 2, 2)))
    return Tow(law, push=random.uniform(0.1, 0.6), stiffness=random.uniform(50, 1000), speed=random.choice([0.0, 0.03]))


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(2, 12))])
def test_the_monodromy_matrix_of_random_machines_is_the_slope_of_their_maps(seed):
    """From random starts, with all sorts of switches in up to three periods.

    Near a grazing the map bends: by how much says the difference of twice the step, three times the error of the single one.
    """
    random = np.random.default_rng(seed)
    for number in range(8):
        machine, periods = _random_machine(random, number), int(random.integers(1, 4))
        at = coordinates(machine)
        state = 0.5 * random.normal(size=len(at.names)) * at.scales
        matrix = jacobian_of(machine, state, periods)
        slope, twice = (difference_jacobian(machine, state, periods, step=step) for step in (1e-6, 2e-6))
        sizes = at.scales / at.scales[:, None]
        assert np.max(abs(matrix - slope) * sizes) < DIFFERENCES + np.max(abs(twice - slope) * sizes)


def test_lines_of_several_are_those_of_each_and_add_up_to_its_power():
    """Parseval over one motion period; and equal modules have the lines of one robot alone."""
    robot = module()
    alone = ss.dynamics.spectrum(ss.solve(robot, periods=60))
    run = ss.solve(chain(0.0, 0.0), periods=60)
    both = ss.dynamics.spectrum(run)
    assert both.amplitude.dims == ("body", "order") and both.body.values.tolist() == ["module 1", "module 2"]
    for name in run.bodies:
        own = ss.dynamics.spectrum(run, body=name)
        assert np.array_equal(own.amplitude, both.amplitude.sel(body=name)) and np.array_equal(own.phase, both.phase.sel(body=name))
        assert own.amplitude.values == pytest.approx(alone.amplitude.values, abs=1e-9 * float(alone.amplitude.max()))
    R = ss.dynamics.spectrum(run, "friction_force", contact=1, harmonics=400)
    assert R.amplitude.attrs["units"] == "N" and R.amplitude.dims == ("order",)
    t = run.strobe_times[-2] + (np.arange(20000) + 0.5) * run.period_time / 20000
    square = np.mean(run.at(t)["friction_force"][:, 1] ** 2)
    power = float(R.amplitude[0] ** 2 + 0.5 * (R.amplitude[1:] ** 2).sum())
    assert power == pytest.approx(square, rel=2e-3)  # the lines beyond 400 of a force that jumps: some 1/(pi^2 400)
    for asked, said in [
        ({"body": "module 3"}, "allowed are 'module 1', 'module 2' or 0 to 1"),
        ({"contact": 0}, "contact = 0, but v is a column of each body; type body='module 1'"),
        ({"column": "vv"}, "is not a column"),
    ]:
        with pytest.raises(ss.InputError, match=said):
            ss.dynamics.spectrum(run, **asked)


@each_row(("settle", "run_on"), [(6, True), (40, False)])
def test_a_state_that_the_strobe_map_does_not_change_by_a_bit_is_not_run_on_and_has_the_same_points(settle, run_on, monkeypatch):
    """The map is a function of the state, so what it leaves as it is it always leaves; others are run on for as long as they were."""
    alone = Alone(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb"))
    states = np.linspace(-0.05, 0.05, 6)[:, None]
    end = strobe_map(alone, states, settle, 1e-9)
    points, ways = strobe_orbit(alone, end.state, 64, 1e-9)
    asked = []
    monkeypatch.setattr(starts_run_on, "strobe_points", lambda *rest: asked.append(rest) or strobe_points(*rest))
    found = rule.settled_motions(alone, states, coordinates(alone), rule.Settling(settle, settle, 1e-9))
    assert np.array_equal(found.points, np.moveaxis(points, 0, 1)) and np.array_equal(found.ways, ways.T)
    assert (found.kind == "periodic").all()
    assert bool(asked) == run_on
