"""TRUTH section 2: the Coulomb robot on paper, its borders, and its exact periodic motion."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import stickslip as ss
from rows import each_row
from stickslip.analysis.closed_form import (
    border_i_iii,
    border_ii_i,
    border_ii_iii,
    border_iii_iv,
    coulomb_type,
    mean_without_rest,
    periodic,
    stays_at_rest,
)
from stickslip.presets import coulomb_robot

# A root of order 1 found to the last bit carries a few rounding errors of 1e-16; TRUTH's tolerance of 1e-12 leaves room for its last digit.
DIGITS = 1e-12
alphas = st.floats(0.02, 1.3)


def test_rest_if_and_only_if_both_alphas_reach_one():  # T1
    assert stays_at_rest([1.0, 1.0, 0.999999], [1.0, 1.5, 2.0]).tolist() == [True, True, False]
    assert periodic([1.0, 1.0, 0.999999], [1.0, 1.5, 2.0]).type.tolist() == ["rest", "rest", "II"]


def test_the_motion_without_rest_is_its_formula():  # T2, T10
    assert float(mean_without_rest(0.4, 0.5)) == pytest.approx(0.122475359974498, abs=DIGITS)
    p = periodic(0.4, 0.5)
    assert (float(p.mean), float(p.forward), str(p.type)) == pytest.approx((0.122475359974498, 5 / 9, "IV"), abs=DIGITS)


def test_the_formula_without_rest_agrees_with_the_arcs():
    from stickslip.solvers.set_valued import solve_rows

    plus, minus = np.meshgrid([0.05, 0.2, 0.3, 0.5], [0.05, 0.25, 0.4, 0.53])
    never = coulomb_type(plus, minus) == "IV"
    plus, minus = plus[never], minus[never]
    rows = np.stack([plus, minus, plus, minus, 0 * plus, 0 * plus], axis=1)
    raw = solve_rows(rows, 1000, "auto")
    assert len(plus) > 8
    # the strobe point is followed to 1e-14 and contracts by 1 - 0.2 at the slowest
    assert raw["displacement"] / (2 * np.pi) == pytest.approx(mean_without_rest(plus, minus), abs=1e-12)


def test_frictionless_and_one_sided_friction_have_limits():
    assert mean_without_rest([0.0, 0.0, 0.3], [0.0, 0.3, 0.0]).tolist() == pytest.approx(
        [0, np.sqrt(1 - 0.09), -np.sqrt(1 - 0.09)], abs=1e-15
    )


def test_borders_have_their_known_values():  # T3 to T6
    assert border_iii_iv([1.0, 2.0]) == pytest.approx([0.537029272146315, 0.284485276155916], abs=DIGITS)
    assert border_i_iii(2.0) == pytest.approx(0.406899269748192, abs=DIGITS)
    assert border_ii_i() == 1.0
    assert border_ii_iii([0.9, 1.0]) == pytest.approx([0.110433505278347, 0.2172336], abs=5e-8)
    assert float(border_ii_iii(0.9)) == pytest.approx(0.110433505278347, abs=DIGITS)
    assert np.isnan(border_i_iii(20.0))  # there type III ends in type II


@each_row(
    ("alphas", "type_", "mean", "fractions"),
    [
        ((0.5, 1.2), "II", 0.201452203333669, (0.5241295584, 1 - 0.5241295584, 0)),  # T7
        ((0.7, 0.9), "I", 0.0615227380297986, (0.3890396524, 0.1657688566 + 0.2283168943, 0.2168745967)),  # T8
        ((0.4, 0.8), "III", 0.269172787549942, (0.5891171251, 0.1061806613, 0.3047022137)),  # T9
    ],
)
def test_periodic_motions_have_their_known_values(alphas, type_, mean, fractions):
    p = periodic(*alphas)
    assert str(p.type) == type_
    assert float(p.mean) == pytest.approx(mean, abs=DIGITS)
    assert (float(p.forward), float(p.stick), float(p.backward)) == pytest.approx(fractions, abs=1e-10)  # as printed


def test_static_friction_delays_break_away():  # T11
    p = periodic(0.5, 1.2, static=(0.8, 1.4))
    assert (float(p.mean), str(p.type)) == pytest.approx((0.170822286993, "II"), abs=1e-12)


def test_the_borders_and_the_arcs_tell_the_same_types():
    plus, minus = np.meshgrid(np.linspace(0.013, 1.29, 90), np.linspace(0.017, 1.27, 90))
    p = periodic(plus, minus)
    assert (p.type == coulomb_type(plus, minus)).all()
    assert set(p.type.ravel()) == {"rest", "I", "II", "III", "IV"}


def test_borders_part_the_types_they_are_named_for():
    k = np.array([1.2, 2.0])
    step = 1e-9  # far above rounding, far below any other border
    for border, below, above in ((border_iii_iv, "IV", "III"), (border_i_iii, "III", "I")):
        a = border(k)
        assert coulomb_type((1 - step) * a, (1 - step) * k * a).tolist() == [below] * 2
        assert coulomb_type((1 + step) * a, (1 + step) * k * a).tolist() == [above] * 2
    larger = np.array([0.6, 0.9])
    assert coulomb_type(border_ii_iii(larger) - step, larger).tolist() == ["II", "II"]
    assert coulomb_type(border_ii_iii(larger) + step, larger).tolist() == ["III", "III"]


@settings(max_examples=60, deadline=None)
@given(alphas, alphas)
def test_the_mirror_image_moves_the_other_way(plus, minus):
    p, q = periodic(plus, minus), periodic(minus, plus)
    # a few roundings of times near 2 pi, over 2 pi; a slide that ends at a grazing angle loses the root of them at most
    assert float(p.mean) == pytest.approx(-float(q.mean), abs=1e-12)
    assert (float(p.forward), str(p.type)) == pytest.approx((float(q.backward), str(q.type)), abs=1e-7)


@settings(max_examples=60, deadline=None)
@given(alphas, alphas)
def test_it_goes_where_friction_is_lower(plus, minus):
    assert float(periodic(plus, minus).mean) * (minus - plus) >= -1e-13


@settings(max_examples=40, deadline=None)
@given(alphas, alphas, st.floats(1, 1.4), st.floats(1, 1.4))
def test_fractions_add_up_also_with_static_friction(plus, minus, up, down):
    p = periodic(plus, minus, static=(up * plus, down * minus))
    assert float(p.forward + p.stick + p.backward) == pytest.approx(1, abs=1e-12)


@each_row("alphas", [(1e-5, 2e-5), (1e-6, 2e-6), (1e-7, 1.5e-7)])
def test_next_to_frictionless_the_mean_is_the_formulas_or_none(alphas):
    """Such a body takes more periods to settle than anybody runs: the formula needs none, and without one there is no mean."""
    robot, higher = coulomb_robot(*alphas), tuple(1.5 * a for a in alphas)
    assert ss.analysis.periodic_mean_velocity(robot) == pytest.approx(float(mean_without_rest(*alphas)), rel=1e-15)
    p = periodic(*alphas, static=higher)
    assert np.isnan([p.mean, p.forward, p.stick, p.backward]).all() and str(p.type) == "other"
    static = robot.replace(friction=ss.Coulomb(*alphas, f_plus=higher[0], f_minus=higher[1]))
    assert np.isnan(ss.analysis.periodic_mean_velocity(static))


def test_break_away_at_the_sliding_friction_is_no_static_friction():
    plus, minus = np.array([0.4, 0.7, 0.5]), np.array([0.5, 0.9, 1.2])
    without, with_it = periodic(plus, minus), periodic(plus, minus, static=(plus, minus))
    for name in ("mean", "forward", "stick", "backward", "type"):
        assert np.array_equal(getattr(without, name), getattr(with_it, name)), name


def test_a_body_that_slides_down_by_itself_has_no_period():
    with pytest.raises(ss.InputError, match="zero or more"):
        periodic(-0.1, 0.5)


def test_borders_of_the_rig_at_1_7_degrees():  # P9 [mm], as printed
    arcs_per_metre = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=1.0, law="coulomb")
    mu, friction = arcs_per_metre.mass_ratio, arcs_per_metre.friction
    unit = arcs_per_metre.gravity / (mu * arcs_per_metre.drive.omega**2)  # alpha = coefficient * unit / A
    k = friction.mu_minus / friction.mu_plus
    at = [friction.mu_plus / 1.0, friction.mu_minus / 1.0, friction.mu_plus / border_i_iii(k), friction.mu_plus / border_iii_iv(k)]
    assert [round(1e3 * unit * float(a), 5) for a in at] == [0.26545, 0.37027, 0.55297, 0.64711]
