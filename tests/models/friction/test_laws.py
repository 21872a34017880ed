"""Every friction law: the claims that all of them share, closed forms, and what is said of bad input."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, fields
from functools import cache

import numpy as np
import pytest

import stickslip as ss
from registries import examples
from rows import each_row
from stickslip.analysis.bench.contact import MovedContact
from stickslip.analysis.bench.probe import Probe
from stickslip.analysis.bench.setup import Setup
from stickslip.analysis.law_claims.moved_contact import burst, moved, shaken
from stickslip.basics.fields import leaves
from stickslip.dynamics.attractors.basins import on_grid
from stickslip.dynamics.periodic.periodic_orbits import states_of
from stickslip.dynamics.stroboscopic.strobe_maps import state_at_rest
from stickslip.inverse.identification.law_forces import driven_force
from stickslip.inverse.identification.motions import PrescribedMotion
from stickslip.maths import asinh, exp, log, where
from stickslip.models.friction.law_adapter import adapted, mirrored_law
from stickslip.testing import Claim, LawReport, check_law

#: Every law, and sums of each kind: set-valued, with a state, with memory.
EVERY = examples(ss.friction.LAWS) | {
    "dry and oil": ss.Stribeck.example() + ss.Viscous.example(),
    "bristle and oil": ss.Viscous.example() + ss.LuGre.example(),
    "elements and oil": ss.friction.GMS.example() + ss.Viscous.example(),
    "one element": ss.friction.GMS.example().replace(stiffness=(1.0,), weights=(1.0,)),
    "one bristle": ss.friction.Bristle.example().replace(bristles=1),
    "film and oil": ss.friction.TanhCoulomb.example() + ss.Viscous.example(),
}
every_law = each_row("law", EVERY.values(), ids=EVERY)

#: Canudas de Wit et al. 1995, with a load of 1 N: Fc = 1 N, Fs = 1.5 N.
LUGRE_1995 = ss.LuGre(1.0, 1.0, 1.5, 1.5, sigma0=1e5, sigma1=math.sqrt(1e5), sigma2=0.4, v_s=1e-3)


def integrated(law, velocity, end, load=1.0, z0=0.0, times=None):
    """The inner state of a contact that is moved as prescribed, by an integrator that is not ours."""
    from scipy.integrate import solve_ivp

    size = law.scale(load)
    run = solve_ivp(
        lambda t, z: [law.rate(velocity(t), float(z[0]), load)], (0, end), [z0], method="DOP853", rtol=1e-12,
        atol=1e-14 * size, t_eval=times, max_step=end / 20,
    )  # fmt: skip
    return run.y[0]


# claims over every law -------------------------------------------------------------------------------------------


@cache
def checked(name):
    """The report on a law, which more than one claim is read from."""
    return check_law(EVERY[name])


@each_row("name", EVERY)
def test_every_law_holds_the_claims(name):
    report = checked(name)
    assert report.passed, report
    assert len(report.claims) >= 6


@pytest.mark.slow
@each_row("law", EVERY.values(), ids=EVERY)
def test_every_law_holds_the_claims_under_another_load(law):
    """The paper's weight; ElastoPlastic's z_ba stays below mu N / sigma0 there."""
    assert check_law(law, load=0.9).passed


def is_damped(law):
    """Whether its force depends on the rates of its inner states."""
    law = adapted(law)
    at_rest, moving = (tuple(rate for _ in range(law.states)) for rate in (0.0, 1.0))
    z, mode = law.start(1.0), (0,) * law.modes
    return law.force(0.01, z, moving, 1.0, mode) != law.force(0.01, z, at_rest, 1.0, mode)


@each_row("name", [*(name for name, law in EVERY.items() if not is_damped(law)), "resetintegrator"])
def test_only_bristles_with_damping_give_back_energy(name):
    """And `ResetIntegrator` does not, whose damping acts only while it sticks."""
    assert checked(name)["energy given back"].value == 0, checked(name)


@every_law
def test_a_law_is_copied_with_changes_and_compared(law):
    name, value = next(((n, x) for n, x in leaves(law) if not n[-1].isdigit() or n[-2] != "."), (None, None))
    assert law.replace() == law
    if name is not None:
        assert law.replace({name: 1.1 * value + 1e-9}) != law


def test_one_of_several_numbers_of_a_law_of_ones_own_is_changed():
    @dataclass(frozen=True)
    class Limits:
        limits: tuple[float, ...]

        def sliding(self, v, load):
            return where(v > 0, self.limits[0], -self.limits[1]) * load

        def breakaway(self, load):
            return -self.limits[1] * load, self.limits[0] * load

    robot = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=6e-4).replace(friction=Limits((0.1, 0.2)))
    assert robot.replace({"friction.limits.0": 0.15}).friction == Limits((0.15, 0.2))
    with pytest.raises(ss.InputError, match="'5' is not a field; known: 0, 1"):
        robot.replace({"friction.limits.5": 0.15})


@each_row("name", ss.friction.LAWS)
def test_a_study_file_holds_every_law(name):
    robot = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=6e-4).replace(friction=EVERY[name])
    assert ss.Robot.from_toml(robot.to_toml()).friction == EVERY[name]


@each_row("name", ss.friction.LAWS)
def test_every_approximation_says_so(name):
    law = EVERY[name]
    assert bool(getattr(law, "approximation", "")) == (name in ("tanhcoulomb", "deadband", "karnopp"))
    if name in ("tanhcoulomb", "deadband", "karnopp"):
        assert law.notes(1.0) == [law.approximation]


@every_law
def test_friction_of_a_large_load_is_that_of_a_small_one_for_dry_sliding(law):
    """Three times the load gives three times the steady friction force, less the viscous part, which is taken out at both."""
    if hasattr(law, "sliding"):
        v = 0.01
        wet = law.sliding(v, 0.0)
        assert law.sliding(v, 3.0) - wet == pytest.approx(3 * (law.sliding(v, 1.0) - wet), rel=1e-12, abs=1e-15)


def test_a_law_that_is_wrong_in_many_ways_is_told_all_of_them():
    @dataclass(frozen=True)
    class Wrong:
        """A bristle that moves at rest, adds a force to a stiffness and pushes forwards only.

        Parameters
        ----------
        stiffness : float
            Stiffness [N/m].
        """

        stiffness: float

        def rate(self, v, z, load):
            return v + 1e-3 - abs(v) * z * self.stiffness / load

        def force(self, v, z, zdot, load):
            return self.stiffness * z + self.stiffness

    with pytest.raises(ss.InputError) as raised:
        check_law(Wrong(stiffness=1e4))
    told = {problem.split(":")[0] for problem in raised.value.problems}
    assert told == {"rest at v = 0", "mirror symmetry", "change of units"}


@dataclass(frozen=True)
class Leaning:
    """Dry friction that leans to one side, which is the other side for who looks from there: its mirror image is its own affair.

    Parameters
    ----------
    mu : float
        Friction coefficient [-].
    lean : float
        Force on the body for each newton of load [-].
    """

    mu: float
    lean: float

    def sliding(self, v, load):
        return (where(v > 0, self.mu, -self.mu) + self.lean) * load

    def breakaway(self, load):
        return (self.lean - self.mu) * load, (self.lean + self.mu) * load

    def mirrored(self):
        return Leaning(self.mu, -self.lean)


def test_there_is_one_mirror_image_of_a_law():
    law = Leaning(mu=0.2, lean=0.05)
    assert check_law(law)["mirror symmetry"].value == 0.0
    robot = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=6e-4).replace(friction=law)
    assert ss.dynamics.mirrored(robot).friction == Leaning(0.2, -0.05)
    both = ss.friction.Sum(law, ss.Viscous(0.1, 0.3))
    assert mirrored_law(both) == ss.friction.Sum(Leaning(0.2, -0.05), ss.Viscous(0.3, 0.1))
    assert mirrored_law(mirrored_law(both)) == both


@every_law
def test_a_law_is_asked_in_one_way_whatever_its_sort(law):
    """The adapter's states are a tuple; what it gives is what the law gives when it is called by hand."""
    known = adapted(law)
    z = tuple(0.3 * size for size in known.scale(0.7) or ()) if known.states else ()
    mode, v = (0,) * known.modes, 2e-3
    force, rates = known.response(v, z, 0.7, mode, applied=0.05)
    assert len(rates) == len(z) == len(known.start(0.7)) == known.states
    if not known.dynamic:
        assert force == law.sliding(v, 0.7) and known.limits(0.7) == tuple(law.breakaway(0.7))
        return
    own = z[0] if len(z) == 1 else z
    rate = law.rate(v, own, 0.7, *([mode] if known.switching else []))
    more = [*([mode] if known.switching else []), *([0.05] if known.needs_applied else [])]
    assert rates == (rate if isinstance(rate, tuple) else (rate,))
    assert force == law.force(v, own, rate, 0.7, *more)


BENT = 0.4  # of what it is in steady sliding


@dataclass(frozen=True)
class LuGre(ss.LuGre):
    """The bristle model whose bristles are bent before anything moves; of the same name, so that its kernels are LuGre's."""

    def start(self, load):
        return BENT * self.mu_plus * load / self.sigma0


BENT_LAW = LuGre(0.15, 0.21, 0.18, 0.24, sigma0=2e4, sigma1=20.0, sigma2=0.4, v_s=2e-3)
BENT_ROBOT = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=6e-4).replace(friction=BENT_LAW)


@each_row("method", ["auto", "radau"])
def test_a_run_from_rest_begins_where_the_law_says(method):
    begun = BENT_LAW.start(BENT_ROBOT.load(0.0, 0.0))
    free = ss.solve(BENT_ROBOT, periods=2, method=method, rtol=1e-8)
    assert free.z[0] == begun > 0
    given = ss.solve(BENT_ROBOT, periods=2, method=method, rtol=1e-8, start={"z": begun})
    assert np.array_equal(free.v, given.v)
    assert ss.solve(BENT_ROBOT, periods=2, method=method, start={"z": 0.0}).z[0] == 0.0
    assert ss.solve(BENT_ROBOT, periods=2, method=method, start={"v": 0.01}).z[0] == begun


def test_every_case_of_a_batch_begins_where_its_own_law_says():
    robots = BENT_ROBOT.replace({"friction.mu_plus": np.array([0.12, 0.15]), "body_mass": np.array([[0.05], [0.06], [0.07]])})
    loads = np.broadcast_to(robots.load(0.0, 0.0), (3, 2)).ravel()
    wanted = BENT * np.tile([0.12, 0.15], 3) * loads / BENT_LAW.sigma0
    np.testing.assert_allclose(state_at_rest(robots)[:, 1], wanted, rtol=1e-15)
    assert not state_at_rest(robots)[:, 0].any()


def test_dynamics_bench_and_sums_begin_where_the_law_says():
    begun = BENT_LAW.start(BENT_ROBOT.load(0.0, 0.0))
    assert states_of(None, BENT_ROBOT).tolist() == [[0.0, begun]]
    assert states_of({"v": 0.01}, BENT_ROBOT).tolist() == [[0.01, begun]]
    assert states_of({"z": 0.0}, BENT_ROBOT).tolist() == [[0.0, 0.0]]
    assert on_grid({"v": np.array([0.0, 0.1])}, BENT_ROBOT).tolist() == [[0.0, begun], [0.1, begun]]
    assert MovedContact(Probe(BENT_LAW, 0.7), 1e-3).z == (BENT_LAW.start(0.7),)
    assert adapted(BENT_LAW + ss.Viscous.example()).start(0.7) == (BENT_LAW.start(0.7),)
    assert adapted(ss.LuGre.example() + ss.Viscous.example()).start(0.7) == (0.0,)


def test_a_sum_is_called_what_its_parts_are_called():
    law = ss.Viscous.example() + ss.Coulomb.example() + ss.Viscous.example()
    assert adapted(law).name == "Viscous + Coulomb + Viscous"
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4).replace(friction=ss.Dahl.example() + ss.Viscous.example())
    assert ss.solve(robot, periods=2).provenance["kinds"]["law"] == "Dahl + Viscous"


@each_row("law", [law for law in EVERY.values() if adapted(law).dynamic and adapted(law).states])
def test_a_sum_says_of_inner_states_what_the_law_alone_says(law):
    alone, both = adapted(law), adapted(law + ss.Viscous(0.0, 0.0))
    z = tuple(1.1 * size for size in alone.scale(0.7) or (0.3,) * alone.states)
    for asked in ("states", "modes", "random", "compiles", "has_start"):
        assert getattr(both, asked) == getattr(alone, asked), asked
    for asked in ("start", "scale", "slip_length"):
        assert getattr(both, asked)(0.7) == getattr(alone, asked)(0.7), asked
    assert both.creep_velocity(z, 0.7) == alone.creep_velocity(z, 0.7)
    assert both.velocity_scale() == alone.velocity_scale()
    at_rest_all_the_time = PrescribedMotion(np.array([0.0, 1.0]), np.zeros(2), np.full(2, 0.7), np.zeros(2), 0, False, "still")
    held = BENT_LAW.sigma0 * BENT_LAW.start(0.7)
    assert driven_force(BENT_LAW, at_rest_all_the_time).ravel().tolist() == pytest.approx([held, held], rel=1e-12)


@each_row(("begun", "told"), [(math.nan, "finite numbers"), ((0.0, 1.0), "start gives 2 values"), ("bent", "cannot be computed")])
def test_a_start_that_is_none_is_told(begun, told):
    class Wrong(ss.LuGre):
        def start(self, load):
            return begun

    numbers = {f.name: getattr(BENT_LAW, f.name) for f in fields(BENT_LAW)}
    with pytest.raises(ss.InputError, match=told):
        ss.solve(BENT_ROBOT.replace(friction=Wrong(**numbers)), periods=2)


@dataclass(frozen=True)
class Ageing:
    """Rate-and-state friction, aging law, with the logarithm of the contact's age as its state (Rice et al. 2001)."""

    a: float
    b: float
    mu: float
    v_0: float
    length: float

    def rate(self, v, z, load):
        return (self.v_0 * exp(-z) - abs(v)) / self.length

    def force(self, v, z, zdot, load):
        return self.a * load * asinh(v / (2 * self.v_0) * exp((self.mu + self.b * z) / self.a))

    def start(self, load):
        return log(self.v_0 / 0.1)

    def scale(self, load):
        return 1.0


AGEING = Ageing(a=0.02, b=0.015, mu=0.3, v_0=0.01, length=0.01)


def test_a_state_may_be_an_age():
    report = check_law(AGEING)
    assert report["rest at v = 0"].value == 0.0 and report["mirror symmetry"].value < 1e-12
    assert Setup(AGEING, 1.0, 1.0).typical_speed == 0.01  # it has no stiffness to ring on


def test_steady_sliding_from_the_start_that_the_law_says_stays_steady():
    """At 0.1 m/s the age is length / speed, whose logarithm `start` gives, and friction is mu + (a - b) ln(v/v_0) of the load."""
    force = (0.3 + 0.005 * math.log(10.0)) * 1.0
    pulled = ss.PulledMass(mass=1.0, stiffness=20.0, speed=0.1, friction=AGEING, load=1.0)
    run = ss.solve(pulled, duration=1.0, start={"v": 0.1, "x": -force / 20.0}, method="radau", rtol=1e-9)
    assert abs(run.v - 0.1).max() < 1e-9 and abs(run.z - math.log(0.1)).max() < 1e-8  # rtol; asinh for a logarithm: exp(-2 mu/a) = 1e-13


def test_memories_that_nothing_switches_are_refused():
    @dataclass(frozen=True)
    class Forgotten(ss.Dahl):
        modes = 2

    with pytest.raises(ss.InputError, match="modes = 2 and no switches"):
        ss.PulledMass(mass=1.0, stiffness=2.0, speed=0.1, friction=Forgotten(0.2, 0.2, 1e4))


def test_a_wrong_number_of_inner_states_is_told_by_every_method():
    @dataclass(frozen=True)
    class Doubled:
        k: float
        states = 2

        def rate(self, v, z, load):
            return v

        def force(self, v, z, zdot, load):
            return self.k * z[0]

    pulled = ss.PulledMass(mass=1.0, stiffness=2.0, speed=0.1, friction=Doubled(1e2))
    for method in ("auto", "dop853"):
        with pytest.raises(ss.InputError, match="rate gives 1 values; the law has 2 inner states"):
            ss.solve(pulled, duration=0.1, method=method)


def test_a_motor_is_no_friction():
    @dataclass(frozen=True)
    class Motor:
        mu: float = 0.2

        def sliding(self, v, load):
            return where(v > 0, -self.mu, self.mu) * load

        def breakaway(self, load):
            return -self.mu * load, self.mu * load

    report = check_law(Motor, raise_=False)
    assert {claim.name for claim in report.failures} == {"friction opposes motion", "a closed cycle costs energy"}
    assert report["a closed cycle costs energy"].value == pytest.approx(-1, abs=1e-6)


def test_a_law_with_if_differs_from_its_arrays():
    @dataclass(frozen=True)
    class If:
        mu: float = 0.2

        def sliding(self, v, load):
            return self.mu * load * (v > 0) - self.mu * load * (v < 0)

        def breakaway(self, load):
            return -self.mu * load, self.mu * load

    with pytest.raises((ss.InputError, TypeError)):
        check_law(If)


# LuGre -----------------------------------------------------------------------------------------------------------


def lugre_force(t, v, law=LUGRE_1995):
    """F at constant velocity from z = 0: g(1 - E) + sigma1 v E + sigma2 v with E = exp(-sigma0 v t/g)."""
    g = law.coefficient(v)
    E = math.exp(-law.sigma0 * v * t / g)
    return g * (1 - E) + law.sigma1 * v * E + law.sigma2 * v


def test_lugre_at_constant_velocity():
    v, t = 2e-3, 1e-3
    z = integrated(LUGRE_1995, lambda _: v, t)[-1]
    force = LUGRE_1995.force(v, z, LUGRE_1995.rate(v, z, 1.0), 1.0)
    assert lugre_force(t, v) == pytest.approx(0.700979803090, abs=5e-13)
    assert force == pytest.approx(lugre_force(t, v), rel=1e-10)


def test_lugre_linearised_at_rest_rings_as_the_paper_says():
    """omega = sqrt(sigma0/m), zeta = (sigma1 + sigma2)/(2 sqrt(sigma0 m)); the Jacobian at rest is taken by differences."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=1e-6)
    law, m, load = robot.friction, robot.total_mass, robot.load(0.0, 0.0)

    def slope(v, z):
        return -law.force(v, z, law.rate(v, z, load), load) / m, law.rate(v, z, load)

    steps = (1e-9, 1e-13)
    columns = [np.subtract(slope(*e), slope(0.0, 0.0)) / h for e, h in zip(np.diag(steps), steps, strict=True)]
    root = np.linalg.eigvals(np.array(columns).T)[0]
    assert abs(root) == pytest.approx(2355.9, abs=0.05)
    assert -root.real / abs(root) == pytest.approx(0.2946, abs=5e-5)


def test_lugre_gives_back_energy_only_where_barabanov_and_ortega_allow_it():
    """With sigma1 = sigma2 mu/(f - mu) it is passive; far above, a slow push and a burst draw energy from nothing."""
    base = ss.LuGre(0.2, 0.2, 0.3, 0.3, sigma0=1e4, sigma1=0.8, sigma2=0.4, v_s=1e-3)
    assert not base.cautions(1.0)
    assert check_law(base)["energy given back"].value == 0
    active = base.replace(sigma1=100.0)
    assert active.cautions(1.0) and not adapted(active).notes(1.0)
    assert check_law(active)["energy given back"].value > 0.5


def test_work_of_a_burst_is_its_integral():
    """W = integral of F v dt with the closed form of F: slow from z = 0 until z is steady, then fast from there."""
    law, slow, fast, stroke = LUGRE_1995, 1e-5, 0.1, 5e-4  # 30 relaxation lengths
    run = burst(Probe(law, 1.0), stroke, slow, fast)
    g, G = law.coefficient(slow), law.coefficient(fast)
    first = g * stroke - g * g / law.sigma0 + law.sigma1 * slow * g / law.sigma0 + law.sigma2 * slow * stroke
    z0, length = g / law.sigma0, G / law.sigma0
    second = G * stroke + (g - G) * length + law.sigma2 * fast * stroke + law.sigma1 * fast * (length - z0)
    assert run["loss"] == pytest.approx(second, rel=1e-6)
    assert run["force"] == pytest.approx(G + law.sigma2 * fast, rel=1e-6)
    slow_part = moved(Probe(law, 1.0), [(stroke / slow, lambda t: slow)], last=1)
    assert slow_part["loss"] == pytest.approx(first, rel=1e-6)


# Dahl ------------------------------------------------------------------------------------------------------------


@each_row("strokes", [0.2, 1.0, 3.0])
def test_dahl_hysteresis_of_a_steady_stroke(strokes):
    """i = 1 between -a and a: peak Fc tanh(sigma a/Fc), loss per cycle 4 Fc a - 4 Fc^2/sigma tanh(sigma a/Fc)."""
    Fc, sigma = 0.2, 4e5
    a = strokes * Fc / sigma
    law = ss.Dahl(mu_plus=0.2, mu_minus=0.2, sigma0=sigma)
    omega = 10.0
    times = np.linspace(0, 2 * math.pi / omega, 4001)
    peak = Fc * math.tanh(sigma * a / Fc)
    z = integrated(law, lambda t: a * omega * math.sin(omega * t), times[-1], z0=-peak / sigma, times=times)  # from -a
    assert sigma * z.max() == pytest.approx(peak, rel=1e-10)
    power = law.sigma0 * z * a * omega * np.sin(omega * times)
    from scipy.integrate import simpson

    halves = [simpson(power[part], x=times[part]) for part in (slice(0, 2001), slice(2000, 4001))]  # smooth on each half
    assert sum(halves) == pytest.approx(4 * Fc * a - 4 * Fc**2 / sigma * math.tanh(sigma * a / Fc), rel=1e-10)


@each_row(
    ("exponent", "curve"),
    [(1.0, lambda x: 1 - math.exp(-x)), (2.0, lambda x: 1 - 1 / (1 + x)), (0.5, lambda x: 1 - max(1 - x / 2, 0) ** 2),
     (1.5, lambda x: 1 - (1 + x / 2) ** -2)],
)  # fmt: skip
def test_dahl_virgin_curve(exponent, curve):
    """u' = -|u|^i sgn(u) with u = 1 - F/Fc, x = sigma x/Fc. With i = 1/2 sliding is reached at x = 2."""
    law = ss.Dahl(mu_plus=0.3, mu_minus=0.2, sigma0=1e5, exponent=exponent)
    reach = 0.3 / 1e5
    ways = np.array([0.1, 0.5, 1.0, 1.9])
    z = integrated(law, lambda _: reach, ways[-1], times=ways)
    assert law.sigma0 * z / 0.3 == pytest.approx([curve(x) for x in ways], abs=1e-10)


def test_dahl_returns_from_beyond_the_other_sides_limit():
    """Forwards friction is larger: on reversal u = 1 + F/Fc_minus > 1; and z above its limit falls back to it (u < 0)."""
    law = ss.Dahl(mu_plus=0.3, mu_minus=0.1, sigma0=1e5, exponent=0.5)
    assert law.rate(-1.0, 3e-6, 1.0) == pytest.approx(-2.0)  # -|1 + 3|^(1/2)
    assert law.rate(1.0, 6e-6, 1.0) == pytest.approx(-1.0)  # u = -1
    assert law.rate(1.0, 3e-6, 1.0) == pytest.approx(0.0, abs=1e-9)


# elasto-plastic --------------------------------------------------------------------------------------------------


def test_elasto_plastic_is_lugre_without_an_elastic_range_once_it_slides():
    law = ss.friction.ElastoPlastic(1.0, 1.0, 1.5, 1.5, sigma0=1e5, sigma1=math.sqrt(1e5), sigma2=0.4, v_s=1e-3, z_ba=0.7e-5)
    for v in (1e-4, 1e-3, 1e-2):
        z = LUGRE_1995.coefficient(v) / 1e5
        assert law.rate(v, z, 1.0) == pytest.approx(0, abs=1e-16)
        assert law.rate(v, 1.3 * z, 1.0) == pytest.approx(LUGRE_1995.rate(v, 1.3 * z, 1.0), rel=1e-12)
        assert law.rate(-v, z, 1.0) == -v  # unloading is elastic


def test_elasto_plastic_does_not_drift_below_its_elastic_limit():
    """A force that stays below sigma0 z_ba moves the body to and fro; LuGre creeps under the same load (Dupont et al. 2002)."""
    from scipy.integrate import solve_ivp

    plastic = ss.friction.ElastoPlastic(1.0, 1.0, 1.5, 1.5, sigma0=1e5, sigma1=math.sqrt(1e5), sigma2=0.4, v_s=1e-3, z_ba=0.7e-5)

    def drift(law):
        def slope(t, y):
            _, v, z = map(float, y)
            rate = law.rate(v, z, 1.0)
            return [v, 0.4 + 0.2 * math.sin(2 * math.pi * t) - law.force(v, z, rate, 1.0), rate]

        run = solve_ivp(slope, (0, 2), [0.0, 0.0, 0.0], method="LSODA", rtol=1e-9, atol=[1e-15, 1e-13, 1e-15])
        return run.y[0] - run.y[2]

    assert np.abs(drift(plastic)).max() <= 1e-12
    assert drift(LUGRE_1995)[-1] > 1e-6


@each_row(("share", "alpha"), [(0.0, 0.0), (0.5, 0.5), (1.0, 1.0), (0.25, 0.5 - 0.5 * math.sqrt(0.5))])
def test_elasto_plastic_blend(share, alpha):
    """alpha is 0 at z_ba, 1/2 half way, 1 at z_ss, a sine between."""
    law = ss.friction.ElastoPlastic(0.2, 0.4, None, None, sigma0=1e5, sigma1=0.0, sigma2=0.0, v_s=1e-3, z_ba=1e-6, z_ba_minus=3e-6)
    for side, steady, elastic in ((1, 2e-6, 1e-6), (-1, 4e-6, 3e-6)):
        z = elastic + share * (steady - elastic)
        assert law.rate(side * 0.1, side * z, 1.0) == pytest.approx(side * 0.1 * (1 - alpha * z / steady), rel=1e-9, abs=1e-12)


def test_elasto_plastic_says_where_it_is_elastic_too_far():
    law = ss.friction.ElastoPlastic(0.2, 0.4, None, None, sigma0=1e5, sigma1=0.0, sigma2=0.0, v_s=1e-3, z_ba=3e-6)
    assert law.notes(1.0) == [
        "ElastoPlastic for v > 0: z_ba = 3e-06 m is not below mu N / sigma0 = 2e-06 m, so the contact is elastic up to 0.99 of that"
    ]
    assert not law.notes(2.0)
    assert law.rate(1e-3, 1.97e-6, 1.0) == 1e-3  # elastic
    assert law.rate(1e-3, 2e-6, 1.0) == 0.0  # it slides


# generalised Maxwell slip ----------------------------------------------------------------------------------------


def maxwell(attraction=1e6, **changes):
    """Elements that slip with a constant force: a flat Stribeck curve."""
    return ss.friction.GMS(0.2, 0.2, None, None, sigma0=1e5, v_s=1e-3, attraction=attraction, **changes)


def virgin(x, law, limit=0.2):
    """Force after a way x from fresh: every element is a spring up to its share of the limit."""
    return sum(
        min(kappa * law.sigma0 * x, alpha * limit) if x >= 0 else max(kappa * law.sigma0 * x, -alpha * limit)
        for kappa, alpha in zip(law.stiffness, law.weights, strict=True)
    )


@each_row("way", [0.3e-6, 1.2e-6, 2.5e-6, 5e-6, 12e-6])
def test_masing_the_unloading_branch_is_the_virgin_curve_doubled(way):
    """F(x_r - d) = F_r - 2 f(d/2). Slipping elements sit at their limit exactly, since the curve is flat and they begin there."""
    law, speed, turn = maxwell(), 1e-5, 6e-6
    probe = Probe(law, 1.0)
    there = (turn / speed, lambda t: speed)
    assert moved(probe, [there], last=1)["force"] == pytest.approx(virgin(turn, law), rel=1e-6)
    # v passes zero between the two strokes: half a sine ends at rest
    half = math.pi * turn / (2 * speed)
    back = (way / speed, lambda t: -speed)
    run = moved(probe, [(half, lambda t: speed * math.sin(math.pi * t / half)), back], last=1)
    assert run["force"] == pytest.approx(virgin(turn, law) - 2 * virgin(way / 2, law), rel=1e-6)


def test_gms_elements_slip_one_after_another_and_stick_together():
    law = maxwell()
    sticks = (0, 0, 0, 0)
    z = (0.4e-6, 0.4e-6, 0.4e-6, 0.4e-6)  # the first yields at .1 * .2/(.4 * 1e5) = .5e-6
    guards = [float(g) for g, _, _ in law.switches(1e-5, z, 1.0, sticks)]
    assert guards[0] == 1e-5
    assert guards[1] == pytest.approx(0.1 * 0.2 - 0.4 * 1e5 * 0.4e-6)
    assert [mode for _, mode, _ in law.switches(1e-5, z, 1.0, (1, 0, 0, 0))] == [
        sticks, (1, 0, 0, 0), (1, 1, 0, 0), (1, 0, 1, 0), (1, 0, 0, 1),
    ]  # fmt: skip


def test_gms_slides_on_the_stribeck_curve():
    """In steady sliding every element carries its share: R = N g(v) + sigma2 v, both ways, and goes there in a time S/C."""
    law = ss.friction.GMS.example()
    for v in (1e-3, -1e-3, 2e-2, -2e-2):
        g = {1: 0.15 + 0.03 * math.exp(-((v / 2e-3) ** 2)), -1: 0.21 + 0.03 * math.exp(-((v / 2e-3) ** 2))}[1 if v > 0 else -1]
        side = math.copysign(1, v)
        z = tuple(side * a * g / (k * law.sigma0) for a, k in zip(law.weights, law.stiffness, strict=True))
        assert law.rate(v, z, 1.0, (1,) * 4) == pytest.approx((0.0,) * 4, abs=1e-12)
        assert law.force(v, z, (0.0,) * 4, 1.0, (1,) * 4) == pytest.approx(side * g + law.sigma2 * v, rel=1e-12)
        more = tuple(1.1 * zi for zi in z)
        rates = law.rate(v, more, 1.0, (1,) * 4)
        assert rates == pytest.approx([-0.1 * zi * law.attraction / g for zi in z], rel=1e-9)


def test_one_element_of_gms_is_a_spring_and_a_slider():
    law = maxwell(stiffness=(1.0,), weights=(1.0,))
    a = 5e-6  # yields at 2e-6
    run = shaken(Probe(law, 1.0), 2 * a, 1e-3)
    assert run["loss"] == pytest.approx(4 * 0.2 * (a - 2e-6), rel=1e-6)


# bristles and the reset integrator -------------------------------------------------------------------------------


def test_bristles_hold_mu_on_average():
    """Sixty snaps and more of each of 20 bristles: the mean of 1200 draws errs by about 1 %; 5 % are allowed."""
    law = ss.friction.Bristle(mu_plus=0.2, mu_minus=0.3, sigma0=1e4, bristles=20, seed=3)
    probe = Probe(law, 1.0)
    for side, mu in ((1.0, 0.2), (-1.0, 0.3)):
        reach, step = 1.5 * mu / 1e4, 0.02
        z, mode, forces = (0.0,) * 20, (0,) * 20, []
        for k in range(1500):
            z = tuple(zi + side * step * reach for zi in z)
            for i, (guard, _, _) in enumerate(probe.switches(side, z, mode)):
                if guard <= 0:
                    _, mode, z = probe.switches(side, z, mode)[i]
            if k > 300:
                forces.append(law.force(side, z, z, 1.0, mode))
        assert np.mean(forces) == pytest.approx(side * mu, rel=0.05)
        assert np.std(forces) / mu == pytest.approx(math.sqrt(1 / 12 / 20) * 1.5, rel=0.5)


def test_bristles_can_be_repeated_and_differ_by_seed():
    from stickslip.models.friction.bristle import _draw

    draws = [_draw(0, i, k) for i in range(100) for k in range(100)]
    assert draws == [_draw(0, i, k) for i in range(100) for k in range(100)]
    assert len(set(draws)) == 10_000
    assert _draw(1, 0, 0) != _draw(0, 0, 0) != _draw(0, 0, 1) != _draw(0, 1, 0)
    from scipy.stats import kstest

    assert kstest(draws, "uniform").pvalue > 1e-3


def test_the_reset_integrator_breaks_away_at_f_and_slides_at_mu():
    law = ss.friction.ResetIntegrator(0.15, 0.21, 0.18, 0.24, sigma0=4e5, sigma1=0.0)
    for side, mu, f in ((1, 0.15, 0.18), (-1, 0.21, 0.24)):
        edge = side * mu / 4e5
        guards = [guard for guard, _, _ in law.switches(side * 1e-3, edge, 1.0, (0,))]
        assert guards[1 if side > 0 else 2] == pytest.approx(0, abs=1e-20)
        assert law.force(side * 1e-3, edge, 0.0, 1.0, (0,)) == pytest.approx(side * f)
        assert law.force(side * 1e-3, edge, 0.0, 1.0, (side,)) == side * mu
        assert law.rate(side * 1e-3, edge, 1.0, (side,)) == 0
        _, mode, z = law.switches(0.0, edge, 1.0, (side,))[0]
        assert (mode, z) == ((0,), edge)


def test_the_reset_integrator_loses_what_its_loop_encloses():
    """Between -a and a in steady state: slide at mu N to the end, unload (f/mu sigma0 z), load the other way, slide again."""
    law = ss.friction.ResetIntegrator(0.2, 0.2, 0.3, 0.3, sigma0=1e5, sigma1=0.0)
    a, edge = 10e-6, 2e-6
    run = shaken(Probe(law, 1.0), 2 * a, 1e-3)
    # each stroke: from -edge to 0 the spring gives back 1/2 f edge, from 0 to edge it takes the same, then mu N slides
    assert run["loss"] == pytest.approx(2 * 0.2 * (2 * a - 2 * edge), rel=1e-6)


# set-valued laws -------------------------------------------------------------------------------------------------


def test_quadratic_friction_opposes_both_ways():
    law = ss.CoulombViscous(0.1, 0.2, viscous=2.0, quadratic=30.0)
    assert law.sliding(0.1, 10.0) == pytest.approx(1.0 + 0.2 + 0.3)
    assert law.sliding(-0.1, 10.0) == pytest.approx(-2.0 - 0.2 - 0.3)
    same = ss.Coulomb(0.1, 0.2) + ss.Viscous(2.0, 2.0, 30.0, 30.0)
    for v in (-0.3, -1e-6, 1e-6, 0.2):
        assert same.sliding(v, 10.0) == pytest.approx(law.sliding(v, 10.0), rel=1e-14)
    assert same.breakaway(10.0) == law.breakaway(10.0)


@each_row("exponent", [0.5, 1.0, 1.3, 2.0, 3.0])
def test_stribeck_takes_any_exponent(exponent):
    law = ss.Stribeck(0.1, 0.2, 0.15, 0.3, v_s=1e-2, exponent=exponent, viscous=0.5)
    for v in (1e-5, 3e-3, 1e-2, 0.1, -2e-3, -0.1):
        mu, f = (0.1, 0.15) if v > 0 else (0.2, 0.3)
        expected = math.copysign(2.0 * (mu + (f - mu) * math.exp(-(abs(v / 1e-2) ** exponent))), v) + 0.5 * v
        assert law.sliding(v, 2.0) == pytest.approx(expected, rel=1e-11)
    assert law.coefficient(0.0) == pytest.approx(0.3, rel=2e-6)  # blunted: 1e-12^(1/2) at the worst exponent
    assert law.breakaway(2.0) == (-0.6, 0.3)


def test_stribeck_is_exact_and_smooth_at_exponents_one_and_two():
    from stickslip.engine.symbols import Graph
    from stickslip.engine.values import values_of
    from stickslip.models.friction.sides import power, signed_power

    for x in (-0.3, 0.0, 1e-200, 0.7):
        assert power(x, 1.0) == abs(x)
        assert power(x, 2.0) == x * x
        assert signed_power(x, 1.0) == x
    graph = Graph()
    x, p = graph.variable("x"), graph.case("p")
    for make in (power, signed_power):
        slope = graph.derivative(make(x, p), x)
        for exponent in (0.5, 1.0, 1.5, 2.0):
            assert math.isfinite(values_of(graph, {"x": 0.0, "p": exponent})[slope.number])


def test_stribeck_with_arrays_of_exponents_is_each_of_them():
    exponents = np.array([0.7, 1.0, 2.0])
    law = ss.Stribeck.example()
    many = law.replace(exponent=exponents).sliding(3e-3, 1.0)
    assert many == pytest.approx([law.replace(exponent=float(e)).sliding(3e-3, 1.0) for e in exponents], rel=1e-14)


def test_a_table_is_fritsch_and_butlands_cubic():
    """SciPy's PCHIP is written apart from ours; the knots include a turning point, a flat piece and two points only."""
    from scipy.interpolate import PchipInterpolator

    rng = np.random.default_rng(5)
    tables = [
        ((0.0, 1e-3, 2e-3, 5e-3, 6e-3), (0.3, 0.2, 0.2, 0.25, 0.1)),
        ((0.0, 1.0), (0.3, 0.2)),
        ((0.0, 0.1, 0.5), (0.2, 0.3, 0.25)),
        (tuple(np.cumsum(rng.uniform(0.01, 1, 12))), tuple(rng.uniform(0.1, 0.3, 12))),
    ]
    for speed, mu in tables:
        law = ss.friction.Tabulated(speed=speed, mu_plus=mu, mu_minus=mu[::-1])
        x = np.linspace(speed[0], speed[-1], 501)[1:]
        assert law.coefficient(x) == pytest.approx(PchipInterpolator(speed, mu)(x), abs=1e-14)
        assert law.coefficient(-x) == pytest.approx(PchipInterpolator(speed, mu[::-1])(x), abs=1e-14)
        assert law.coefficient(2 * speed[-1]) == mu[-1]
        assert law.breakaway(2.0) == (-2 * mu[-1], 2 * mu[0])


def test_a_fine_table_is_the_law_that_it_was_read_from():
    """Cubic interpolation: the error falls like h^3 or better (the slopes are of second order)."""
    errors = []
    for count in (20, 40, 80):
        speed = np.linspace(0, 1e-2, count)
        law = ss.Stribeck(0.1, 0.2, 0.15, 0.3, v_s=2e-3)
        table = ss.friction.Tabulated(
            speed=tuple(speed), mu_plus=tuple(law.coefficient(speed + 1e-30)), mu_minus=tuple(law.coefficient(-speed))
        )
        x = np.linspace(1e-4, 9.9e-3, 977)
        errors.append(np.abs(table.coefficient(x) - law.coefficient(x)).max())
    assert errors[0] > 4 * errors[1] > 16 * errors[2]


# approximations --------------------------------------------------------------------------------------------------


def test_approximations_are_coulomb_far_from_rest():
    for law in (
        ss.friction.TanhCoulomb(0.15, 0.21, 1e-4),
        ss.friction.DeadBand(0.15, 0.21, 1e-4),
        ss.friction.Karnopp(0.15, 0.21, None, None, 1e-4),
    ):
        probe = Probe(law, 2.0)
        assert probe.force(0.01, (), ()) == pytest.approx(0.3, rel=1e-12)
        assert probe.force(-0.01, (), ()) == pytest.approx(-0.42, rel=1e-12)
        assert law.rate(0.01, (), 2.0) == ()


def test_karnopp_balances_up_to_break_away():
    law = ss.friction.Karnopp(0.15, 0.21, 0.18, 0.24, width=1e-3)
    for applied, expected in ((0.0, 0.0), (0.3, 0.3), (0.5, 0.36), (-0.4, -0.4), (-0.6, -0.48)):
        assert law.force(5e-4, (), (), 2.0, applied) == pytest.approx(expected)
    assert law.force(2e-3, (), (), 2.0, 0.0) == pytest.approx(0.3)


# what is said of bad input ---------------------------------------------------------------------------------------


STATIC = "(static friction is not below kinetic friction); type f_plus=None for equal ones"
BAD = [
    (lambda: ss.Stribeck(0.2, 0.2, 0.1, None, v_s=1e-3),
     f"f_plus = 0.1 is below mu_plus = 0.2; allowed is f_plus >= mu_plus {STATIC}"),
    (lambda: ss.Stribeck(0.2, 0.2, None, None, v_s=1e-3, exponent=0),
     "exponent = 0.0; allowed is a number from 0.01 to 20, mostly 1 or 2; type for example exponent=1"),
    (lambda: ss.Dahl(0.2, 0.2, sigma0=-1.0), "sigma0 = -1.0; allowed is a positive stiffness [N/m]; type for example sigma0=400000"),
    (lambda: maxwell(weights=(0.5, 0.4), stiffness=(0.5, 0.5)),
     "weights = (0.5, 0.4) sum to 0.9; allowed are shares that sum to 1; divide each by their sum"),
    (lambda: ss.friction.Tabulated((), (), ()), "speed has 0 values; allowed is a table of two or more; type for example speed=(0.0, 0.1)"),
    (lambda: maxwell(weights=()), "weights is empty; allowed is one share or more; type for example weights=(0.5, 0.5)"),
    (lambda: maxwell(weights=(0.5, 0.5)), "stiffness has 4 values and weights 2; allowed is one of each for every element"),
    (lambda: maxwell(weights=(1.5, -0.5), stiffness=(0.5, 0.5)),
     "weights[1] = -0.5; allowed is several positive numbers that sum to 1; type for example weights=(0.1, 0.2, 0.3, 0.4)"),
    (lambda: maxwell(weights=1.0, stiffness=(1.0,)),
     "weights = 1.0; allowed is a tuple of numbers; type for example weights=(0.1, 0.2, 0.3, 0.4)"),
    (lambda: ss.friction.Tabulated((0.0, 1.0, 1.0), (0.1, 0.1, 0.1), (0.1, 0.1, 0.1)),
     "the table is not single-valued: speed[2] = 1.0 after speed[1] = 1.0; allowed is one coefficient for a speed; remove one, or put "
     "their mean"),
    (lambda: ss.friction.Tabulated((0.0, 2.0, 1.0), (0.1, 0.1, 0.1), (0.1, 0.1, 0.1)),
     "the table does not rise: speed[2] = 1.0 after speed[1] = 2.0; allowed are rising speeds; sort the table by speed"),
    (lambda: ss.friction.Tabulated((0.0, 1.0), (0.1, -0.1), (0.1, 0.1)),
     "mu_plus[1] = -0.1; allowed is several coefficients, zero or more; type for example mu_plus=(0.18, 0.165, 0.151, 0.15, 0.17)"),
    (lambda: ss.friction.Tabulated((0.0, 1.0), (0.1, math.nan), (0.1, 0.1)),
     "mu_plus[1] = nan; allowed is several coefficients, zero or more; type for example mu_plus=(0.18, 0.165, 0.151, 0.15, 0.17)"),
    (lambda: ss.friction.Tabulated((0.0, 1.0), (0.1, 0.1, 0.1), (0.1, 0.1)),
     "mu_plus has 3 values and speed 2; allowed is one coefficient for every speed"),
    (lambda: ss.friction.Tabulated((0.0,), (0.1,), (0.1,)),
     "speed has 1 values; allowed is a table of two or more; type for example speed=(0.0, 0.1)"),
    (lambda: ss.friction.Tabulated((0.0, 1.0), (0.2, 0.1), (0.1, 0.1), f_plus=0.15),
     "f_plus = 0.15 is below mu_plus[0] = 0.2; allowed is f_plus >= mu_plus[0]; type f_plus=None for equal ones"),
    (lambda: ss.friction.Bristle(0.2, 0.2, 1e5, bristles=0),
    "bristles = 0; allowed is a whole number from 1; type for example bristles=10"),
    (lambda: ss.friction.Bristle(0.2, 0.2, 1e5, seed=1.5), "seed = 1.5; allowed is a whole number from 0; type for example seed=0"),
    (lambda: ss.friction.DeadBand(0.2, 0.2, width=0.0), "width = 0.0; allowed is a positive velocity [m/s]; type for example width=0.001"),
    (lambda: ss.Dahl.example() + ss.LuGre.example(),
     "Dahl and LuGre both have inner states; allowed is one such law; write one law with both"),
    (lambda: ss.Coulomb.example() + ss.friction.GMS.example(),
     "Coulomb and GMS: one has inner states and the other sticks; allowed beside a law with inner states is one without static "
     "friction, such as ss.Viscous"),
    (lambda: ss.friction.Karnopp.example() + ss.Viscous.example(),
     "Karnopp balances the other forces at rest, so nothing can be added to it; use ss.Coulomb, solved exactly"),
    (lambda: ss.Coulomb.example() + 1.0,
     "1.0 is not a friction law; allowed are two laws; type for example ss.Dahl(...) + ss.Viscous(...)"),
]  # fmt: skip


@each_row(("make", "said"), BAD, ids=[said[:40] for _, said in BAD])
def test_bad_input_is_told_what_to_type(make, said):
    with pytest.raises(ss.InputError) as raised:
        make()
    assert raised.value.problems == (said,)


@each_row(
    ("limits", "said"),
    [
        (lambda load: 0.3 * load, "gives 0.3; allowed are two forces"),
        (lambda load: (0.3 * load, -0.3 * load), "gives (0.3, -0.3), the larger force first"),
        (lambda load: (-0.2 * load, 0.2 * load), "less than its friction while it slides slowly (-0.3 and 0.3)"),
    ],
)
def test_a_law_of_ones_own_whose_breakaway_cannot_be_is_told_before_anything_runs(limits, said):
    @dataclass(frozen=True)
    class Own:
        mu: float

        def sliding(self, v, load):
            return where(v > 0, self.mu, -self.mu) * load

        def breakaway(self, load):
            return limits(load)

    with pytest.raises(ss.InputError, match=re.escape(said)):
        ss.presets.piezo_rig(tilt_deg=0.0, amplitude=5e-4).replace(friction=Own(0.3))


@each_row("sides", [(0.0, 0.4), (0.4, 0.0)])
def test_friction_of_one_direction_only_is_a_law(sides):
    """Nothing holds at rest, and how near to rest friction is looked at is measured on its own side."""
    law = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=5e-4).replace(friction=ss.Viscous(*sides)).friction
    assert (law.sliding(-0.1, 1.0), law.sliding(0.1, 1.0)) == (-0.1 * sides[1], 0.1 * sides[0])


def test_check_law_wants_numbers_and_one_law():
    @dataclass(frozen=True)
    class Bare:
        mu: float

        def sliding(self, v, load):
            return where(v > 0, self.mu, -self.mu) * load

        def breakaway(self, load):
            return -self.mu * load, self.mu * load

    with pytest.raises(ss.InputError, match=r"Bare: mu has no example; type mu: float = field\(metadata=ss.quantities.quantity\("):
        check_law(Bare)
    with pytest.raises(ss.InputError, match="mu_plus of the law are arrays; allowed is one law, no batch"):
        check_law(ss.Coulomb.example().replace(mu_plus=np.array([0.1, 0.12])))
    with pytest.raises(ss.InputError, match="is not a law"):
        check_law("Coulomb")
    report = check_law(Bare(mu=0.2))
    assert report.passed
    assert math.isnan(report["change of units"].value)


def test_a_claim_that_a_report_does_not_have_is_an_error_that_names_those_it_has():
    report = LawReport("Coulomb", (Claim("passive", True, 0.0, "energy given back"),))
    assert report["passive"].passed
    with pytest.raises(ss.InputError, match="has no claim 'pasive'; did you mean 'passive'"):
        report["pasive"]


def test_check_law_says_what_is_wrong_in_a_class():
    @dataclass(frozen=True)
    class NoRest:
        mu: float = 0.2

        def sliding(self, v, load):
            return where(v > 0, self.mu, -self.mu) * load

    @dataclass(frozen=True)
    class OneForce(NoRest):
        def breakaway(self, load):
            return self.mu * load

    @dataclass(frozen=True)
    class Swapped(NoRest):
        def sliding(self, load, v):
            return where(v > 0, self.mu, -self.mu) * load

        def breakaway(self, load):
            return -self.mu * load, self.mu * load

    @dataclass(frozen=True)
    class Python(NoRest):
        def sliding(self, v, load):
            if v > 0:
                return self.mu * load * math.exp(-v)
            return -self.mu * load * math.exp(v)

        def breakaway(self, load):
            return -self.mu * load, self.mu * load

    for law, words in (
        (NoRest, r"it has sliding and no breakaway; type def breakaway\(self, load\)"),
        (OneForce, r"breakaway gives 0.2; allowed are two forces; type return backward, forward"),
        (Swapped, r"sliding takes \(load, v\); allowed is \(v, load\)"),
        (
            Python,
            r"(?s)arrays agree with numbers: it takes no array .*never `if`, math or numpy.*symbols agree with numbers: it takes no symbol",
        ),
    ):
        with pytest.raises(ss.InputError, match=words):
            check_law(law)
    assert not check_law(Python, raise_=False).passed


def test_a_list_in_a_law_of_your_own_is_told_what_to_type():
    @dataclass(frozen=True)
    class Mine:
        mu: float

        def sliding(self, v, load):
            return where(v > 0, self.mu, -self.mu) * load

        def breakaway(self, load):
            return -self.mu * load, self.mu * load

    rig = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, incline="gravity")
    with pytest.raises(ss.InputError, match=r"friction.mu = \[0.1, 0.2\]; allowed is a number or an array; type for example mu=np.array"):
        rig.replace(friction=Mine([0.1, 0.2]))
    assert rig.replace(friction=Mine(np.array([0.1, 0.2]))).friction.mu.size == 2


# powers with an exponent that is a field -----------------------------------------------------------------------------


@dataclass(frozen=True)
class Powers:
    """A set-valued law whose friction has powers of the load and of the speed."""

    mu: float
    p: float
    v_0: float

    def sliding(self, v, load):
        return where(v > 0, 1.0, -1.0) * self.mu * load**self.p * (1 + (abs(v) / self.v_0) ** self.p)

    def breakaway(self, load):
        return -self.mu * load**self.p, self.mu * load**self.p


@dataclass(frozen=True)
class Bending:
    """A bristle that stiffens by a power of its deflection."""

    mu: float
    p: float
    sigma0: float

    def rate(self, v, z, load):
        return v - abs(v) * z * self.sigma0 / (self.mu * load)

    def force(self, v, z, zdot, load):
        return self.sigma0 * z * (1 + pow(abs(self.sigma0 * z / load), self.p))


@dataclass(frozen=True)
class Signed(Bending):
    """The same with a power of what may be negative."""

    def force(self, v, z, zdot, load):
        return self.sigma0 * z * (1 + (self.sigma0 * z / load) ** self.p)


@each_row("law", [Powers(0.15, 0.7, 0.1), Bending(0.15, 0.5, 4e5)], ids=["set-valued", "dynamic"])
def test_a_power_whose_exponent_is_a_field_is_taken_from_rest_on(law):
    """Powers below 1 have no slope at v = 0 and z = 0, where each run begins."""
    assert check_law(law, raise_=False)["symbols agree with numbers"].passed
    rig = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, incline="gravity").replace(friction=law)
    ours, judge = (ss.solve(rig, periods=4, settle=2, **method) for method in ({}, {"method": "radau"}))
    assert ours.x[-1] == pytest.approx(judge.x[-1], rel=1e-4)  # both with a relative tolerance of 1e-6 over some 20 arcs
    assert "^{p}" in ss.latex(law)


def test_a_power_of_what_may_be_negative_is_told_what_to_write():
    rig = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, incline="gravity")
    with pytest.raises(ss.InputError, match=r"sign of z0 .* write abs\(v\)\*\*self\.p, or v \* abs\(v\)\*\*\(self\.p - 1\)"):
        ss.solve(rig.replace(friction=Signed(0.15, 2.0, 4e5)), periods=2)


@each_row(
    "given, full",
    [
        (lambda: ss.Coulomb(0.2), ss.Coulomb(0.2, 0.2)),
        (lambda: ss.Coulomb(mu=0.2), ss.Coulomb(0.2, 0.2)),
        (lambda: ss.Coulomb(0.2, f_plus=0.3), ss.Coulomb(0.2, 0.2, 0.3, 0.3)),
        (lambda: ss.Stribeck(mu=0.2, f=0.3, v_s=1e-3), ss.Stribeck(0.2, 0.2, 0.3, 0.3, v_s=1e-3)),
        (lambda: ss.Coulomb(0.1, 0.2).replace(mu=0.3), ss.Coulomb(0.3, 0.3)),
        (lambda: ss.Coulomb(0.1, 0.2, f_plus=0.3), ss.Coulomb(mu_minus=0.2, mu_plus=0.1, f_plus=0.3, f_minus=None)),
    ],
    ids=["first place", "mu", "one side", "mu and f", "replace", "both sides"],
)
def test_one_coefficient_is_that_of_both_directions(given, full):
    assert given() == full


def test_a_coefficient_for_both_directions_and_one_for_one_of_them_are_refused():
    with pytest.raises(ss.InputError, match=r"mu = 0\.1 is for both directions, and mu_plus is given too"):
        ss.Coulomb(mu=0.1, mu_plus=0.2)
