"""Single terms of the formulas, each against what the equation in the docstring says of it alone."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import stickslip as ss
from rows import each_row
from stickslip.basics.errors import Problems
from stickslip.models.drives.beam_notes import largest_slope
from stickslip.models.drives.cantilever import cantilever_eigenvalues, mode_shape
from stickslip.models.drives.drive import agree
from stickslip.models.drives.drive_adapter import drive_of
from stickslip.models.drives.fourier import series_range
from stickslip.models.drives.patch_moment import modal_amplitudes
from stickslip.models.forces import check_law, slip_ratio
from stickslip.models.friction.bristle import _draw, _mix
from stickslip.models.friction.law import field_numbers
from stickslip.models.friction.law_adapter import adapted, is_law, law_of
from stickslip.models.friction.sides import by_side

LOAD = 0.7
#: Laws whose force has a viscous term of its own, and arguments of the rest of it: inner states, their rates, memories.
WITH_OIL = {
    "lugre": ((1e-7, 2e-4), ()), "elastoplastic": ((1e-7, 2e-4), ()), "gms": (((1e-7,) * 4, (0.0,) * 4), ((0, 1, 0, 1),)),
}  # fmt: skip


# laws -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", WITH_OIL)
@each_row("v", [0.3, -0.3])
def test_the_viscous_term_opposes_motion_in_every_law_that_has_one(name, v):
    """R at v less R at rest, with inner states and their rates held: sigma2 v."""
    law, ((z, zdot), mode) = ss.friction.LAWS[name].example(), WITH_OIL[name]
    assert law.force(v, z, zdot, LOAD, *mode) - law.force(0.0, z, zdot, LOAD, *mode) == pytest.approx(law.sigma2 * v, rel=1e-9)


@each_row("name", ["dahl", "lugre", "elastoplastic"])
def test_the_typical_deflection_is_that_of_sliding_fast_on_average_of_both_ways(name):
    """Where the rate vanishes at a speed far above the Stribeck velocity: mu N / sigma0."""
    law = ss.friction.LAWS[name].example()
    ends = [brentq(lambda z, v=v: law.rate(v, z, LOAD), 0.0, 2 * v * law.scale(LOAD) / abs(v), xtol=1e-20) for v in (1.0, -1.0)]
    assert law.scale(LOAD) == pytest.approx(0.5 * (ends[0] - ends[1]), rel=1e-6)


def test_the_typical_deflections_of_elements_are_where_each_slips_on_average_of_both_ways():
    law = ss.friction.GMS.example()
    limits = [
        0.5 * (law.mu_plus + law.mu_minus) * LOAD * share / (part * law.sigma0)
        for part, share in zip(law.stiffness, law.weights, strict=True)
    ]
    assert law.scale(LOAD) == pytest.approx(limits, rel=1e-12)
    for k, z in enumerate(limits):
        here = tuple(z if i == k else 0.0 for i in range(4))
        forward, backward = (law.switches(v, h, LOAD, (0,) * 4)[1 + k] for v, h in ((10.0, here), (-10.0, tuple(-x for x in here))))
        assert forward[0] + backward[0] == pytest.approx(0.0, abs=1e-12 * LOAD)
        assert forward[1] == backward[1] == tuple(int(i == k) for i in range(4))  # it alone slips then


def test_the_typical_deflection_of_the_reset_integrator_is_its_bound_on_average_of_both_ways():
    law = ss.friction.ResetIntegrator.example()
    (_, _, forward), (_, _, backward) = law.switches(0.1, 0.0, LOAD, (0,))[1:]
    assert law.scale(LOAD) == pytest.approx(0.5 * (forward - backward), rel=1e-12)


def test_the_typical_deflection_of_bristles_is_the_mean_force_over_the_stiffness():
    law = ss.friction.Bristle.example()
    assert law.scale(LOAD) == pytest.approx([0.5 * (law.mu_plus + law.mu_minus) * LOAD / law.sigma0] * law.bristles, rel=1e-12)


def test_bristles_draw_by_splitmix64():
    """The published generator's first numbers from seed 0, as its reference implementation gives them."""
    golden = 0x9E3779B97F4A7C15
    assert [_mix(golden * k & (1 << 64) - 1) for k in (1, 2, 3)] == [0xE220A8397B1DCDAF, 0x6E789E6AA1B965F4, 0x06C45D188009454F]


# drives -----------------------------------------------------------------------------------------------------------


def test_a_vertical_vibration_inside_another_adds_to_the_load():
    """m times the second difference of both heights; it would be twice one of them if the inner one were taken for the outer."""
    inner = ss.drives.VerticalVibration(ss.Harmonic(amplitude=5e-4, omega=200.0), amplitude=1e-4, phase=0.3)
    outer = ss.drives.VerticalVibration(inner, amplitude=4e-5, phase=1.1, harmonic=2)
    robot = ss.Robot(body_mass=0.06, inner_mass=0.01, drive=outer, friction=ss.Coulomb(0.2, 0.2))
    t, h = np.linspace(0.0, outer.period, 17), 1e-6
    rise = sum((d.vertical_position(t + h) - 2 * d.vertical_position(t) + d.vertical_position(t - h)) / h**2 for d in (inner, outer))
    assert robot.load(t, 0.0) == pytest.approx(0.07 * 9.81 + 0.01 * rise, abs=1e-5)  # differences: 1e-19 m / h^2 = 1e-7, h^2 omega^4 less
    assert np.ptp(rise) > 4.0 and math.isclose(robot.load(0.0, 0.0), 0.07 * 9.81 + 0.01 * outer.vertical_acceleration(0.0))


# found by mutants that no other test noticed ------------------------------------------------------------------------


@each_row("law", [ss.Stribeck(0.1, 0.2, f_plus=None, f_minus=None, v_s=1e-3), ss.Stribeck(0.1, 0.2, f_plus=0.3, f_minus=0.4, v_s=1e-3)])
def test_rest_bears_the_static_friction_of_each_side(law):
    forward, backward = (0.1, 0.2) if law.f_plus is None else (0.3, 0.4)
    assert law.breakaway(LOAD) == pytest.approx((-backward * LOAD, forward * LOAD), rel=1e-15)


def test_bristles_that_slide_have_the_friction_of_their_side():
    law = ss.LuGre(0.1, 0.2, f_plus=0.3, f_minus=0.4, sigma0=1e5, sigma1=1.0, sigma2=0.0, v_s=1e-3)
    assert [law.coefficient(v) for v in (1.0, -1.0, 1e-12, -1e-12)] == pytest.approx([0.1, 0.2, 0.3, 0.4], rel=1e-9)


@each_row(("u1", "u2"), [(0.02, 0.05), (0.05, 0.02)])
def test_the_scale_of_two_phases_is_the_faster_one(u1, u2):
    assert ss.drives.TwoPhase.example().replace({"u1": u1, "u2": u2}).velocity_scale == 0.05


@each_row("phase", [0.0, math.pi])
def test_the_energy_of_a_drive_that_is_faster_one_way_is_that_of_the_faster(phase):
    drive = ss.MultiHarmonic(amplitudes=(1e-4, 5e-5), omega=200.0, phases=(0.0, phase))
    speeds = drive.velocity(np.linspace(0.0, drive.period, 20_001))
    assert abs(speeds.max() + speeds.min()) > 0.1 * speeds.max()
    assert drive.specific_energy == pytest.approx(0.5 * max(speeds.max(), -speeds.min()) ** 2, rel=1e-6)


def test_the_drive_force_is_what_the_inner_mass_does_to_the_body():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb")
    run = ss.solve(robot, periods=1, settle=0, method="dop853")
    assert run.drive_force == pytest.approx(-robot.inner_mass * robot.drive.acceleration(run.t), rel=1e-12)


@each_row("name", ["lugre", "stribeck", "elastoplastic", "gms"])
def test_without_static_coefficients_the_slowest_motion_has_the_kinetic_ones(name):
    """f = None is f = mu, on each side: the Stribeck curve is flat, and equal numbers named twice give the same forces."""
    law = ss.friction.LAWS[name].example().replace(f_plus=None, f_minus=None)
    named = law.replace(f_plus=law.mu_plus, f_minus=law.mu_minus)
    if hasattr(law, "coefficient"):
        assert [law.coefficient(v) for v in (1e-12, 1.0, -1e-12, -1.0)] == [law.mu_plus] * 2 + [law.mu_minus] * 2
    assert adapted(law).limits(LOAD) == adapted(named).limits(LOAD) == pytest.approx((-law.mu_minus * LOAD, law.mu_plus * LOAD))
    states = adapted(law).states
    for v in (1e-12, 0.3, -1e-12, -0.3):
        z, mode = (1e-8,) * states, (0,) * adapted(law).modes
        assert adapted(law).response(v, z, LOAD, mode) == adapted(named).response(v, z, LOAD, mode)


def test_a_dynamic_law_holds_what_its_static_coefficients_bear_and_one_that_names_one_side_only_is_not_asked():
    assert adapted(ss.LuGre.example()).limits(LOAD) == pytest.approx((-0.24 * LOAD, 0.18 * LOAD), rel=1e-15)

    @dataclass(frozen=True)
    class Forwards:
        mu_plus: float = 0.2

        def rate(self, v, z, load):
            return v

        def force(self, v, z, zdot, load):
            return z

    @dataclass(frozen=True)
    class Backwards(Forwards):
        mu_plus: None = None
        f_minus: float = 0.3

    assert adapted(Forwards()).limits(LOAD) is None and adapted(Backwards()).limits(LOAD) is None


@each_row(("mode", "coefficient"), [(1, 0.15), (-1, -0.21)])
def test_the_spring_of_the_reset_integrator_is_at_its_bound_when_sliding_ends(mode, coefficient):
    """Also where the load, and with it the bound, changed since sliding began."""
    law = ss.friction.ResetIntegrator.example()
    bound = coefficient * LOAD / law.sigma0
    assert law.switches(0.0, 0.3 * bound, LOAD, (mode,))[0][1:] == ((0,), pytest.approx(bound, rel=1e-15))
    assert adapted(law).passed_zero((0.3 * bound,), LOAD, (mode,), side=mode) == ((pytest.approx(bound, rel=1e-15),), (0,))
    assert law.switches(0.0, 0.3 * bound, LOAD, (0,))[0][2] == 0.3 * bound
    assert law.force(mode * 1e-3, bound, 0.0, LOAD, (mode,)) == pytest.approx(coefficient * LOAD, rel=1e-15)


@each_row(("v", "coefficient"), [(0.1, 0.15), (-0.1, -0.21)])
def test_a_bristle_snaps_at_one_and_a_half_mean_deflections_to_somewhere_before(v, coefficient):
    """1.5 mu N/sigma0, and drawn evenly from there to 0, by the docstring of the law."""
    law = ss.friction.Bristle.example()
    reach = 1.5 * coefficient * LOAD / law.sigma0
    for i, (guard, mode, z) in enumerate(law.switches(v, (reach,) * 10, LOAD, (0,) * 10)):
        assert guard == pytest.approx(0.0, abs=1e-15 * LOAD) and mode == (0,) * i + (1,) + (0,) * (9 - i)
        assert z[:i] + z[i + 1 :] == (reach,) * 9 and 0.0 <= z[i] / reach < 1.0
    assert [guard for guard, _, _ in law.switches(v, (0.0,) * 10, LOAD, (0,) * 10)] == pytest.approx([abs(reach)] * 10, rel=1e-15)


def test_a_table_whose_curve_begins_or_ends_flat_stays_flat_there():
    for mu in ((0.2, 0.2, 0.1, 0.1), (0.1, 0.1, 0.2, 0.2)):
        law = ss.friction.Tabulated(speed=(0.01, 0.02, 0.03, 0.05), mu_plus=mu, mu_minus=(0.3, 0.25, 0.2, 0.1))
        assert [law.coefficient(v) for v in (1e-3, 0.011, 0.017, 0.02, 0.03, 0.041, 0.05, 1.0)] == pytest.approx(
            [mu[0]] * 4 + [mu[-1]] * 4, rel=1e-14
        )
        assert [law.coefficient(v) for v in (-1e-3, -0.01, -0.02, -0.05, -1.0)] == pytest.approx([0.3, 0.3, 0.25, 0.1, 0.1], rel=1e-14)


def test_what_is_no_tuple_of_numbers_is_no_several_numbers():
    assert field_numbers((0.1, np.zeros(2))) == (0.1, pytest.approx(np.zeros(2)))
    assert [field_numbers(wrong) for wrong in (None, [0.1, 0.2], ("fast", 0.2), 0.1)] == [()] * 4


@each_row("turned", [False, True])
def test_a_sum_with_random_bristles_is_random_and_not_compiled_whichever_comes_first(turned):
    parts = [ss.friction.Bristle.example(), ss.Viscous.example()]
    law = ss.friction.Sum(*parts[::-1]) if turned else ss.friction.Sum(*parts)
    assert adapted(law).random and not adapted(law).compiles and adapted(law).states == adapted(law).modes == 10
    calm = ss.friction.Sum(ss.Dahl.example(), ss.Viscous.example())
    assert not adapted(calm).random and adapted(calm).compiles


@dataclass(frozen=True)
class Held:
    """Dry friction of 0.2 and oil, with a breakaway of its own."""

    held: float = 0.2
    oil: float = 0.0

    def sliding(self, v, load):
        return by_side(v, 0.2, -0.2) * load + self.oil * v

    def breakaway(self, load):
        return -self.held * load, self.held * load


@each_row("oil", [0.0, 2.0])
def test_rest_may_bear_less_than_slow_sliding_by_rounding_and_no_more(oil):
    """The slowest sliding is asked at 1e-12 m/s, where oil adds 1e-11 of the force; allowed is a millionth of the force at 1 mm/s."""
    for held, good in ((0.2, True), (0.2 * (1 - 9e-7), True), (0.2 * (1 - 3e-6), False), (0.19, False)):
        problems = Problems("Robot")
        check_law(Held(held, oil), problems)
        assert bool(problems.mistakes) is not good


def test_only_the_error_that_arrays_cause_is_taken_for_theirs():
    """A law that fails in another way, or without arrays, is told where it is traced; one that is never traced takes numbers alone."""

    @dataclass(frozen=True)
    class Fails(Held):
        error: Any = None
        scalar_only: bool = False

        def breakaway(self, load):
            raise self.error

    many, values = np.array([0.2, 0.3]), ValueError("which?")
    laws = [Fails(many, error=values), Fails(error=values), Fails(many, error=KeyError()), Fails(many, error=values, scalar_only=True)]
    found = []
    for law in laws:
        problems = Problems("Robot")
        check_law(law, problems)
        found.append(problems.mistakes)
    assert "cannot take numbers that are arrays (which?)" in found[0][0] and found[1:] == [[], [], []]


@each_row("name", sorted(set(ss.drives.DRIVES) - {"reversed", "verticalvibration"}))
def test_frequency_and_period_are_inverse(name):
    drive = ss.drives.DRIVES[name].example()
    assert drive.frequency * drive.period == pytest.approx(1.0, rel=1e-15)
    assert drive.omega == pytest.approx(2 * math.pi * drive.frequency, rel=1e-15)


def test_a_bang_bang_drive_is_the_same_by_whatever_fixes_its_period():
    drive = ss.drives.BangBang(a1=20.0, a2=45.0, period=0.03)
    for name in ("frequency", "stroke", "t1", "t2"):
        assert ss.drives.BangBang(a1=20.0, a2=45.0, **{name: getattr(drive, name)}).period == pytest.approx(0.03, rel=1e-14)


def test_the_velocity_scale_of_a_drive_that_names_none_is_its_largest_of_sixty_four_instants():
    class Saw:
        period = 0.7

        def velocity(self, t):
            return -(t / self.period % 1.0)

    assert drive_of(Saw()).velocity_scale == pytest.approx(63 / 64, rel=1e-14)


@each_row(("frequency", "end", "place"), [(30.0, 0.4, 0.16), (5.0, 0.2, 0.22), (0.5, 0.2, 1.0)])
def test_the_largest_slope_of_a_beam_is_found_wherever_it_lies(frequency, end, place):
    """Against 960 places; the slope of six modes has a wavelength of 0.4 or more, so that 24 places miss 5 per cent at most."""
    s = np.linspace(0.0, 1.0, 961)[:, None]
    amplitudes = modal_amplitudes(frequency, 10.0, end, 6, 0.02)
    slopes = abs((amplitudes * mode_shape(cantilever_eigenvalues(10.0, 6), s, derivative=1)).sum(axis=-1))
    assert float(s[slopes.argmax(), 0]) == pytest.approx(place, abs=0.02)
    assert largest_slope(frequency, 10.0, end, 6, 0.02) == pytest.approx(slopes.max(), rel=0.05)


@each_row(("share", "remarks"), [(0.5, 0), (0.97, 0), (1.03, 1)])
def test_a_vertical_vibration_lifts_the_body_once_its_inertia_is_more_than_the_weight(share, remarks):
    """m a Omega^2 against (M + m) g = 0.687 N; the least load is found to a thousandth of it at 64 instants."""
    inner, period = ss.Harmonic(amplitude=1e-5, omega=200.0), 2 * math.pi / 200.0
    height = share * 0.07 * 9.81 / 0.01 * (period / (2 * math.pi)) ** 2
    robot = ss.Robot(
        body_mass=0.06, inner_mass=0.01, drive=ss.drives.VerticalVibration(inner, amplitude=height), friction=ss.Coulomb(0.2, 0.2)
    )
    assert len(robot.notes) == remarks


def test_a_sum_changes_over_the_smaller_of_its_velocities():
    slow, fast = (ss.Stribeck(0.1, 0.1, f_plus=0.2, f_minus=0.2, v_s=v_s) for v_s in (1e-3, 5e-3))
    dry = ss.Coulomb(0.1, 0.1)
    assert [law.velocity_scale() for law in (slow + fast, fast + slow, dry + fast)] == [1e-3, 1e-3, 5e-3]


def of_the_slope(cosines, sines):
    """Extremes of a series at the zeros of its slope, a polynomial in exp(i angle) whose roots are eigenvalues."""
    k = np.arange(1, len(cosines) + 1)
    half = 0.5j * k * (np.array(cosines) - 1j * np.array(sines))
    angles = np.angle(np.roots([*half[::-1], 0.0, *half.conj()]))
    return extremes_of(np.cos(np.outer(angles, k)) @ cosines + np.sin(np.outer(angles, k)) @ sines)


def extremes_of(values):
    return float(values.min()), float(values.max())


@each_row(
    ("cosines", "sines"),
    [
        ((0.0, 0.7, -0.5, 1.8), (1.3, 0.2, -0.3, -1.0)),  # two maxima nearly as high: the highest point of a grid lies beside the lower one
        *np.random.default_rng(3).normal(size=(5, 2, 4)),
        *np.random.default_rng(4).normal(size=(5, 2, 9)),
    ],
)
def test_the_extremes_of_a_series_are_those_at_the_zeros_of_its_slope(cosines, sines):
    """Both of its own, and in one array with others."""
    assert series_range(cosines, sines) == pytest.approx(of_the_slope(cosines, sines), rel=1e-13)
    low, high = series_range([np.array([0.0, c]) for c in cosines], [np.array([1.0, s]) for s in sines])
    assert (low[1], high[1]) == pytest.approx(of_the_slope(cosines, sines), rel=1e-13)
    stroke = ss.drives.Recorded(period=0.03, cosines=tuple(map(float, cosines)), sines=tuple(map(float, sines))).stroke
    assert stroke == pytest.approx(high[1] - low[1], rel=1e-13)
    assert series_range([0.0] * len(cosines), [0.0] * len(sines)) == (0.0, 0.0)


def test_a_law_has_both_methods_of_its_kind():
    methods = dict.fromkeys(("sliding", "breakaway", "rate", "force"))
    assert all(is_law(type("Law", (), {a: methods[a], b: methods[b]})()) for a, b in (("sliding", "breakaway"), ("rate", "force")))
    assert not any(is_law(type("Law", (), {name: None})()) for name in methods)


def test_numbers_of_a_bristle_are_drawn_by_the_published_generator():
    """A word equal to the state makes it zero, so that each draw is the first from seed 0."""
    first = 0xE220A8397B1DCDAF
    assert _draw(0, first, first) == (first >> 11) * 2.0**-53


@each_row("missing", ["w1", "w2", "w3"])
def test_the_acceleration_that_is_missing_is_named(missing):
    given = {name: 10.0 for name in ("w1", "w2", "w3") if name != missing}
    with pytest.raises(ss.InputError) as caught:
        ss.drives.ThreePhase(u1=0.3, **given)
    assert [problem.split(";")[0] for problem in caught.value.problems] == [f"{missing} is missing"]


def test_ten_thousand_modes_are_as_many_as_are_asked_for():
    assert cantilever_eigenvalues(1.0, 10_000)[-1] == pytest.approx(9_999.25 * math.pi, rel=1e-7)  # pinned, as tan b = tanh b says
    with pytest.raises(ss.InputError, match="n = 10001"):
        cantilever_eigenvalues(1.0, 10_001)


@each_row("size", [1e-4, 1.0, 1e4])
def test_numbers_given_for_one_thing_agree_to_nine_digits_of_any_size(size):
    assert agree(size, size * (1 + 5e-10)) and not agree(size, size * (1 + 2e-9))


@each_row("v", [0.02, -3.0])
def test_the_slip_ratio_is_what_the_bristle_does_not_follow(v):
    """Eq. 2.6 with v far above v_s: 1 - (dz/dt)/v = z/z_s, with z_s = mu N/sigma0 on the side of v."""
    robot = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=6e-4, law="lugre")
    law, N = robot.friction, robot.load(0.0, 0.0)
    steady = (law.mu_plus if v > 0 else -law.mu_minus) * N / law.sigma0
    shares = np.array([0.0, 0.3, 1.0])
    ratios = slip_ratio(law_of(robot), robot.velocity_scale, math.copysign(1, v), np.full(3, v), N, (shares * steady)[None])
    assert ratios == pytest.approx(shares, abs=1e-12)


@each_row(("degrees", "remarks"), [(8.0, 0), (9.0, 1), (-11.0, 0), (-12.0, 1)])
def test_a_body_slides_by_itself_where_the_slope_is_steeper_than_its_friction(degrees, remarks):
    """tan 8.53 degrees = 0.15 downhill, and 0.21 = tan 11.86 degrees where downhill is backwards."""
    robot = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=6e-4, law="coulomb")
    robot = robot.replace(friction=ss.Coulomb(0.15, 0.21), track=ss.Incline(math.radians(degrees)))
    assert sum("slides by itself" in note for note in robot.notes) == remarks
