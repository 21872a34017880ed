"""Robots, laws, drives and tracks of a user's own that change one method: every way to solve them agrees with plain Python."""

import dataclasses
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

import stickslip as ss
from rows import each_row
from stickslip import maths
from stickslip.analysis.motion import coulomb_twin
from stickslip.dynamics.stroboscopic.strobe_maps import strobe_map
from stickslip.maths import cos, pi, sin, where
from stickslip.models.position_dependence import knows_position
from stickslip.solvers.closed_arcs import dimensionless_arcs, handles

OMEGA = 65.4 * np.pi
record = dataclasses.dataclass(frozen=True, eq=False)
RIG = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb", incline="gravity")
PARTS: dict[str, Any] = dict(body_mass=RIG.body_mass, inner_mass=RIG.inner_mass, drive=RIG.drive, friction=RIG.friction, track=RIG.track)
CLOSE = 1e-9  # of A mu omega: dop853 at rtol 1e-11 over six periods


@record
class Shaken:
    """A drive with the names of Harmonic's numbers, and a phase and a second harmonic besides."""

    amplitude: float
    omega: float
    phase: float = 0.0
    second: float = 0.0

    @property
    def period(self):
        return 2 * pi / self.omega

    def position(self, t):
        return self.amplitude * (sin(self.omega * t + self.phase) + 0.25 * self.second * sin(2 * self.omega * t))

    def velocity(self, t):
        return self.amplitude * self.omega * (cos(self.omega * t + self.phase) + 0.5 * self.second * cos(2 * self.omega * t))

    def acceleration(self, t):
        return -self.amplitude * self.omega**2 * (sin(self.omega * t + self.phase) + self.second * sin(2 * self.omega * t))


@record
class Rubbing(ss.Coulomb):
    """Coulomb's law in name: its friction is `factor` times that and grows with the speed."""

    factor: float = 1.0
    slope: float = 0.0

    def sliding(self, v, load):
        return self.factor * super().sliding(v, load) + self.slope * v

    def breakaway(self, load):
        backward, forward = super().breakaway(load)
        return self.factor * backward, self.factor * forward


@record
class Changed(ss.Robot):
    """A robot on a belt, with a wind, a second shaker of the same frequency, and a load that its drive changes."""

    wind: float = 0.0
    sway: float = 0.0
    ripple: float = 0.0
    drag: float = 0.0
    belt: float = 0.0

    def contact_velocity(self, v):
        return v - self.belt

    def load(self, t, x):
        return super().load(t, x) * (1 + self.ripple * sin(self.drive.omega * t))

    def acceleration(self, t, x, v, R):
        return super().acceleration(t, x, v, R) + self.wind + self.sway * sin(self.drive.omega * t) - self.drag * v


def changed(phase=0.0, second=0.0, factor=1.0, slope=0.0, wind=0.0, sway=0.0, ripple=0.0, drag=0.0, belt=0.0, amplitude=6e-4):
    """A robot with some of these terms; where a number is zero the term is not there."""
    return Changed(
        **{**PARTS, "drive": Shaken(amplitude, OMEGA, phase, second), "friction": Rubbing(0.15, 0.2, factor=factor, slope=slope)},
        wind=wind, sway=sway, ripple=ripple, drag=drag, belt=belt,
    )  # fmt: skip


def some(low, high):
    """A number of six decimals that is zero half of the time."""
    return st.one_of(st.just(0.0), st.floats(low, high).map(lambda x: round(x, 6)))


TERMS = dict(
    phase=some(-3, 3), second=some(-0.8, 0.8), slope=some(0.0, 0.5), wind=some(-0.3, 0.3), sway=some(-8, 8), ripple=some(-0.7, 0.7),
    drag=some(0.0, 5.0), belt=some(-0.02, 0.02), factor=st.floats(0.5, 1.3),
)  # fmt: skip


def plain_run(robot, periods, v=0.0):
    return ss.solve(robot, periods=periods, settle=0, method="dop853", rtol=1e-11, start={"v": v}, keep="trajectory")


def way_of(run):
    return run.strobe_x[-1] - run.strobe_x[0]


def agree_with_plain_python(robot, periods=6, v=0.0):
    """solve, sweep and the strobe map against scipy on plain Python: position and velocity after some periods."""
    plain, scale = plain_run(robot, periods, v), 6e-4 * OMEGA * robot.mass_ratio
    run = ss.solve(robot, periods=periods, settle=0, start={"v": v}, keep="trajectory")
    grid = ss.sweep(robot, periods=periods, settle=0, start={"v": v})
    ends = strobe_map(robot, [[v]], periods)
    span, T = CLOSE * scale * periods, float(robot.period)
    assert way_of(run) == pytest.approx(way_of(plain), abs=span * T)
    assert float(grid.mean_velocity) * periods * T == pytest.approx(way_of(plain), abs=span * T)
    assert ends.displacement[0] == pytest.approx(way_of(plain), abs=span * T)
    assert [run.strobe_v[-1], ends.state[0, 0]] == pytest.approx([plain.strobe_v[-1]] * 2, abs=CLOSE * scale)


@settings(max_examples=5, deadline=None, suppress_health_check=list(HealthCheck))
@given(**TERMS)
def test_a_robot_with_extra_terms_moves_as_plain_python_says(**terms):
    agree_with_plain_python(changed(**terms))


@pytest.mark.slow
@settings(max_examples=300, deadline=None, suppress_health_check=list(HealthCheck))
@given(**TERMS, v=some(-0.02, 0.02))
def test_three_hundred_robots_with_extra_terms_move_as_plain_python_says(v, **terms):
    agree_with_plain_python(changed(**terms), v=v)


OPEN = [dict(phase=0.4), dict(second=0.5), dict(slope=0.2), dict(ripple=0.4), dict(drag=2.0), dict(sway=-12.0), dict(belt=0.01)]
CLOSED = [dict(), dict(factor=1.2), dict(wind=0.2), dict(sway=4.0), dict(factor=0.8, wind=-0.1, sway=-3.0)]


@each_row("terms", OPEN)
def test_one_term_that_is_no_sine_and_no_constant_opens_the_arcs(terms):
    assert "depends on" in handles(changed(**terms))


@each_row("terms", CLOSED)
def test_sines_and_constants_keep_the_arcs_closed_and_their_numbers_are_those_of_the_equations(terms):
    robot = changed(**terms)
    assert handles(robot) is None
    arcs, T = dimensionless_arcs(robot), robot.period
    N = robot.load(0.0, 0.0)
    for phase in (0.1, 0.3, 0.9):
        t, push = phase * T, arcs.drive[0] * np.sin(2 * np.pi * phase)
        assert push - arcs.resist_plus[0] == pytest.approx(robot.acceleration(t, 0.0, 0.01, robot.friction.sliding(0.01, N)), abs=1e-12)
        assert push + arcs.resist_minus[0] == pytest.approx(robot.acceleration(t, 0.0, -0.01, robot.friction.sliding(-0.01, N)), abs=1e-12)


def test_the_mean_of_the_closed_formula_is_that_of_the_changed_robot():
    for terms in CLOSED:
        robot = changed(**terms)
        run = plain_run(robot, 16)
        assert ss.analysis.periodic_mean_velocity(robot) == pytest.approx(float(np.diff(run.strobe_x)[-1] / robot.period), abs=1e-9)
    opened = changed(ripple=0.4)
    run = plain_run(opened, 16)
    assert ss.analysis.periodic_mean_velocity(opened) == pytest.approx(float(np.diff(run.strobe_x)[-1] / opened.period), abs=1e-9)


def test_a_batch_in_which_one_term_is_zero_for_some_is_solved_case_by_case_alike():
    ripple = np.array([0.0, 0.3, -0.6])
    many = ss.solve(changed(ripple=ripple), periods=6, settle=0, keep="summary").mean_velocity
    each = [way_of(plain_run(changed(ripple=float(r)), 6)) / (6 * changed().period) for r in ripple]
    assert many == pytest.approx(each, abs=1e-9 * 6e-4 * OMEGA)


@pytest.mark.parametrize("terms", [dict(wind=0.1, factor=1.1), dict(ripple=0.3, slope=0.1), dict(second=0.3, phase=0.2)])
def test_orbits_branches_and_basins_of_a_changed_robot_come_back_in_plain_python(terms):
    robot = changed(**terms)
    scale = 6e-4 * OMEGA * float(robot.mass_ratio)

    def comes_back(model, state, period, V):
        run = plain_run(model, period, float(state[0]))
        assert run.strobe_v[-1] == pytest.approx(float(state[0]), abs=1e-8 * scale)
        assert way_of(run) / (period * model.period) == pytest.approx(V, abs=1e-8 * scale)

    orbit = ss.periodic_orbit(robot)
    comes_back(robot, orbit.state, orbit.period, orbit.mean_velocity)
    branch = ss.continuation(robot, parameter="drive.amplitude", start=6e-4, stop=6.3e-4, points=6)
    for found in (branch.orbits[0], branch.orbits[-1]):
        comes_back(found.model, found.state, found.period, found.mean_velocity)
    basins = ss.basins(robot, v=np.array([-0.01, 0.01]), settle=60)
    for attractor in basins.attractors:
        comes_back(robot, np.ravel(attractor.state), attractor.period, attractor.mean_velocity)


def test_the_type_of_motion_and_the_alphas_are_those_of_the_equations():
    """A law that calls itself Coulomb's and rubs half as much again; its alphas are not those of its fields."""
    robot = changed(factor=1.5)
    grid = ss.sweep(robot, periods=40)
    arcs = dimensionless_arcs(robot)
    assert float(grid.alpha_plus) == pytest.approx(float(arcs.resist_plus[0] / arcs.drive[0]), rel=1e-14)
    run = ss.solve(robot, periods=40)
    assert ss.motion(run).type == str(grid.motion_type.values) == ss.motion(ss.solve(robot, periods=40, method="dop853", rtol=1e-10)).type
    with pytest.raises(ss.InputError, match="alpha_plus"):
        ss.dynamics.coulomb_borders(ss.map(robot, **{"drive.amplitude": [5e-4, 6e-4], "ripple": [0.2, 0.3]}, periods=4, settle=2))


def test_the_power_of_the_actuator_leaves_out_what_else_drives_the_body():
    """Wind works on the body as gravity does; with a second shaker nobody knows from the columns which of the two worked."""
    robot = changed(wind=0.2)
    grid = ss.sweep(robot, periods=60, settle="auto")
    run = ss.solve(robot, periods=60)
    energy = ss.energy(run)
    assert float(grid.drive_power) == pytest.approx(float(energy.drive[-1] / robot.period), rel=1e-9)
    assert np.isnan(ss.sweep(changed(sway=4.0), periods=60, settle="auto").get("drive_power", np.nan))


# the position -----------------------------------------------------------------------------------------------------


@record
class Patched(ss.Robot):
    """A robot on a track whose friction changes from place to place."""

    patch: float = 0.4

    def load(self, t, x):
        return super().load(t, x) * (1 + self.patch * sin(3e3 * x))


@record
class Behind(ss.Robot):
    """A load that depends on the place in one half of a period only: nothing of it shows at t = 0."""

    def load(self, t, x):
        return super().load(t, x) * where(sin(self.drive.omega * t) > 0, 1.0, 1 + 0.3 * sin(3e3 * x))


def test_the_position_is_a_state_where_the_equations_know_it():
    assert not knows_position(RIG) and knows_position(Patched(**PARTS)) and knows_position(Behind(**PARTS))
    robot = Patched(**PARTS)
    run, plain = ss.solve(robot, periods=6, settle=0), plain_run(robot, 6)
    assert run.strobe_x == pytest.approx(plain.strobe_x, abs=1e-13)


def test_a_robot_on_a_belt_is_carried_by_it():
    """Galilei: it moves as the robot at rest does, and the belt's speed is added."""
    robot, still = changed(belt=0.01), ss.solve(changed(), periods=6, settle=0)
    run = ss.solve(robot, periods=6, settle=0, start={"v": 0.01})
    assert run.strobe_x == pytest.approx(still.strobe_x + 0.01 * still.strobe_times, abs=1e-14)
    assert ss.mean_velocity(run) == pytest.approx(float(ss.sweep(robot, periods=6, settle=0, start={"v": 0.01}).mean_velocity), abs=1e-13)
    ends = strobe_map(robot, [[0.01]], 6)
    assert ends.displacement[0] == pytest.approx(run.strobe_x[-1], abs=1e-14)


# what cannot be solved is said ------------------------------------------------------------------------------------


@record
class Geared(ss.Robot):
    def contact_velocity(self, v):
        return 0.5 * v


@record
class Detuned(ss.Robot):
    """Its load comes back after another time than its drive."""

    rate: float = 1.37

    def load(self, t, x):
        return super().load(t, x) * (1 + 0.3 * sin(self.rate * self.drive.omega * t))


def test_a_contact_that_moves_otherwise_is_refused():
    with pytest.raises(ss.InputError, match="contact_velocity"):
        ss.solve(Geared(**PARTS), periods=2)


@each_row("solve", [lambda r: ss.solve(r, periods=2), lambda r: ss.periodic_orbit(r), lambda r: ss.solve(r, periods=2, method="rk4")])
def test_equations_that_do_not_come_back_after_their_period_are_refused(solve):
    with pytest.raises(ss.InputError, match="load is another one a period later"):
        solve(Detuned(**PARTS))
    assert handles(Detuned(**PARTS, rate=2.0)) is not None
    assert ss.solve(Detuned(**PARTS), periods=2, method="dop853").status


@record
class Softer(ss.LuGre):
    """LuGre in name, with half the force."""

    def force(self, v, z, zdot, load):
        return 0.5 * super().force(v, z, zdot, load)


class Skewed(ss.Harmonic):
    def acceleration(self, t):
        return super().acceleration(t) * (1 + 0.3 * cos(self.omega * t))


@record
class Faded:
    """A law with the names of kinetic coefficients, that slides otherwise at speed."""

    mu_plus: float
    mu_minus: float

    def sliding(self, v, load):
        return where(v > 0, self.mu_plus, -self.mu_minus) * load * (1 + 0.5 * v * v / (1e-4 + v * v))

    def breakaway(self, load):
        return -self.mu_minus * load, self.mu_plus * load


def test_the_dimensionless_form_is_refused_where_a_subclass_has_other_equations():
    lugre = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)
    assert ss.analysis.dimensionless(lugre).mu == lugre.mass_ratio
    parts = {f.name: getattr(lugre.friction, f.name) for f in dataclasses.fields(lugre.friction)}
    for robot in (dataclasses.replace(lugre, friction=Softer(**parts)), lugre.replace(drive=Skewed(6e-4, omega=OMEGA))):
        with pytest.raises(ss.InputError, match=r"are not those of Eq\. 5\.1"):
            ss.analysis.dimensionless(robot)


def test_a_mirror_image_that_is_none_is_refused():
    turned = ss.dynamics.mirrored(changed(ripple=0.0))
    assert turned.acceleration(0.003, 0.0, -0.01, -0.05) == pytest.approx(-changed().acceleration(0.003, 0.0, 0.01, 0.05), rel=1e-12)
    assert dataclasses.astuple(ss.dynamics.mirrored(RIG.replace(friction=Faded(0.1, 0.2))).friction) == (0.2, 0.1)
    for robot in (changed(wind=0.1), changed(sway=2.0)):
        with pytest.raises(ss.InputError, match="the acceleration is another one"):
            ss.dynamics.mirrored(robot)


def test_a_start_at_another_phase_is_refused_where_the_robot_keeps_the_time_itself():
    with pytest.raises(ss.InputError, match="keeps the time in its own equations"):
        ss.basins(changed(ripple=0.3), phase=[0.25], settle=2)


def test_harmonics_are_not_put_on_a_drive_that_is_harmonic_in_name_only():
    with pytest.raises(ss.InputError, match="the drive is Skewed"):
        ss.virtual_rig(RIG.replace(drive=Skewed(6e-4, omega=OMEGA)), harmonics=(0.05, 0.0))


def test_the_explorer_shows_no_robot_that_is_another_one():
    from stickslip.show.explorer.from_robot import state_of

    for robot in (Changed(**PARTS), RIG.replace(friction=Rubbing(0.15, 0.2))):
        with pytest.raises(ss.InputError, match="the page has no control"):
            state_of(robot)


def test_alphas_are_those_of_kinetic_coefficients_and_not_of_fields_with_their_names():
    assert coulomb_twin(RIG.replace(friction=Faded(0.1, 0.1))) is None
    assert coulomb_twin(RIG.replace(friction=ss.friction.Tabulated.example())) is None
    twin = coulomb_twin(RIG.replace(friction=ss.Stribeck.example()))
    assert (twin.friction.mu_plus, twin.friction.mu_minus) == (0.15, 0.21)
    robot = changed(factor=1.5)
    assert coulomb_twin(robot) is robot


# kinds: structures instead of numbers -----------------------------------------------------------------------------

LOADS = ["1.0", "(1 + 0.3*cos(w*t))", "(1 + 0.2*sin(2*w*t + 1.0))", "(1 + 0.3*sin(2e3*x))", "exp(0.2*sin(w*t))", "(1.3 - 0.3*cos(w*t)**2)"]
PUSHES = ["0.0", "0.2", "3.0*sin(w*t)", "3.0*cos(w*t)", "-0.8*v", "2.0*sin(3*w*t)*cos(w*t)", "2.0*tanh(2.0*sin(w*t))", "-20.0*x"]
SLIDES = ["1.0", "1.4", "(1 + 0.3*exp(-(v/0.004)**2))", "(1 + 5.0*abs(v))", "where(abs(v) > 0.01, 0.9, 1.0)"]
DRIVES = ["sin(w*t)", "-sin(w*t)", "sin(w*t) + 0.4*sin(2*w*t)", "cos(w*t - 1.5707963267948966)", "sin(w*t)*(1 + 0.3*cos(w*t))"]


def written(load, push, slide, drive):
    """A robot of four expressions, with the classes' own names."""
    space = {name: getattr(maths, name) for name in maths.__all__} | {"ss": ss, "record": record}
    exec(
        f"""
@record
class Coulomb(ss.Coulomb):
    def sliding(self, v, load):
        return super(Coulomb, self).sliding(v, load) * {slide}
    def breakaway(self, load):
        low, high = super(Coulomb, self).breakaway(load)
        return 1.4 * low, 1.4 * high
class Harmonic(ss.Harmonic):
    def acceleration(self, t):
        w = self.omega
        return -self.amplitude * w**2 * ({drive})
@record
class Robot(ss.Robot):
    def load(self, t, x):
        w = self.drive.omega
        return super(Robot, self).load(t, x) * {load}
    def acceleration(self, t, x, v, R):
        w = self.drive.omega
        return super(Robot, self).acceleration(t, x, v, R) + {push}
""",
        space,
    )
    parts = {**PARTS, "drive": space["Harmonic"](6e-4, omega=OMEGA), "friction": space["Coulomb"](0.12, 0.16)}
    return space["Robot"](**parts)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(30))
def test_thirty_robots_of_random_methods_move_as_plain_python_says(seed):
    rng = np.random.default_rng(seed)
    chosen = [str(rng.choice(texts)) for texts in (LOADS, PUSHES, SLIDES, DRIVES)]
    robot = written(*chosen)
    plain = plain_run(robot, 6)
    run = ss.solve(robot, periods=6, settle=0, keep="trajectory")
    scale = 6e-4 * OMEGA * robot.mass_ratio
    assert run.strobe_x == pytest.approx(plain.strobe_x, abs=6 * CLOSE * scale * robot.period), chosen
    grid = ss.sweep(robot, periods=6, settle=0)
    assert float(grid.mean_velocity) == pytest.approx(way_of(plain) / (6 * robot.period), abs=6 * CLOSE * scale), chosen


@record
class Sled:
    """A pushed mass of a user's own, with nothing but what the contract asks for (`stickslip.basics.contracts.OneContact`)."""

    mass: float
    push: float
    omega: float
    friction: Any
    load = 1.0

    @property
    def period(self):
        return 2 * pi / self.omega

    @property
    def total_mass(self):
        return self.mass

    @property
    def velocity_scale(self):
        return self.push / (self.mass * self.omega)

    def acceleration(self, t, x, v, R):
        return (self.push * sin(self.omega * t) - R) / self.mass

    def contact_velocity(self, v):
        return v


def test_a_machine_with_nothing_but_the_contract_is_taken_like_a_robot():
    sled = Sled(mass=1.0, push=0.5, omega=10.0, friction=ss.Coulomb(0.15, 0.21))
    run, judge = ss.solve(sled, periods=40), ss.solve(sled, periods=40, method="dop853", rtol=1e-11)
    assert run.method == "exact" and judge.x[-1] == pytest.approx(run.x[-1], abs=40 * CLOSE * sled.velocity_scale * sled.period)
    assert run.notes == [] and ss.motion(run).type == ss.motion(judge).type
    assert ss.energy(run).worst < 1e-9
    found = ss.sweep(lambda push=0.5: Sled(1.0, push, 10.0, sled.friction), push=[0.5, 0.6], periods=40)
    assert float(found.mean_velocity[0]) == pytest.approx(ss.mean_velocity(run), rel=1e-9)
