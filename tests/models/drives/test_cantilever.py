"""The clamped beam with a tip mass: eigenvalues to the last digit, none missed; shapes, masses and answers by two methods."""

import mpmath
import numpy as np
import pytest

import stickslip as ss
from pairs import each_once
from rows import each_row
from stickslip.models.drives import patch_moment as couple
from stickslip.models.drives.cantilever import cantilever_eigenvalues, modal_mass, mode_shape

RATIOS = (0.0, 1e-6, 0.3, 1.0, 1.2, 40.0, 1e4, 1e9)
#: Eq. 3.5 by a second program: R -> beta_i L.
KNOWN = {0.0: (1.875104069, 4.694091133, 7.854757438), 1.0: (1.24791741, 4.031139437, 7.134132241)}


def exact(b, ratio):
    """Eq. 3.5 over cosh b, in fifty digits."""
    return 1 / mpmath.cosh(b) + mpmath.cos(b) + ratio * b * (mpmath.cos(b) * mpmath.tanh(b) - mpmath.sin(b))


def finite_elements(ratio, count):
    """Stiffness and mass of the unit beam in Hermite elements, clamped; unknowns are (u, u') at the nodes behind the clamp."""
    h = 1 / count
    k = np.array(
        [[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2], [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h**2, -6 * h, 4 * h**2]]
    )
    m = np.array(
        [
            [156, 22 * h, 54, -13 * h],
            [22 * h, 4 * h**2, 13 * h, -3 * h**2],
            [54, 13 * h, 156, -22 * h],
            [-13 * h, -3 * h**2, -22 * h, 4 * h**2],
        ]
    )
    K, M = np.zeros((2, 2 * count + 2, 2 * count + 2))
    for e in range(count):
        K[2 * e : 2 * e + 4, 2 * e : 2 * e + 4] += k / h**3
        M[2 * e : 2 * e + 4, 2 * e : 2 * e + 4] += m * h / 420
    M[-2, -2] += ratio
    return K[2:, 2:], M[2:, 2:]


def solutions(b, s, d):
    """Derivative d of cos bs, sin bs, cosh bs and sinh bs."""
    hyperbolic = (np.cosh(b * s), np.sinh(b * s))
    turn = d * np.pi / 2
    return b**d * np.array([np.cos(b * s + turn), np.sin(b * s + turn), hyperbolic[d % 2], hyperbolic[1 - d % 2]])


def by_conditions(b, ratio, end):
    """u(1) for a unit couple on 0 < s < end: eight constants of the two parts of the beam from eight conditions."""
    A, right = np.zeros((8, 8)), np.zeros(8)
    A[0, :4], A[1, :4] = solutions(b, 0, 0), solutions(b, 0, 1)
    for d in range(4):
        A[2 + d, :4], A[2 + d, 4:] = solutions(b, end, d), -solutions(b, end, d)
    right[4] = 1.0  # the curvature falls by the couple over EI
    A[6, 4:] = solutions(b, 1, 2)
    A[7, 4:] = solutions(b, 1, 3) + ratio * b**4 * solutions(b, 1, 0)
    return solutions(b, 1, 0) @ np.linalg.solve(A, right)[4:]


# eigenvalues ------------------------------------------------------------------------------------------------------


@each_row("ratio", KNOWN)
def test_the_first_eigenvalues_are_those_of_the_books(ratio):
    assert cantilever_eigenvalues(ratio, 3) == pytest.approx(KNOWN[ratio], abs=1e-9)  # the digits printed there


@each_row("ratio", RATIOS)
def test_fifty_eigenvalues_are_right_to_the_last_digit(ratio):
    # Bisection ends between neighbouring floats; the equation adds a few roundings of sin, cos and exp: 1e-15 with room.
    with mpmath.workdps(50):
        for b in map(float, cantilever_eigenvalues(ratio, 50)):
            low, high = (exact(mpmath.mpf(b) * (1 + side * mpmath.mpf("1e-15")), mpmath.mpf(ratio)) for side in (-1, 1))
            assert low * high < 0, b


@each_row("ratio", [0.0, 0.01, 0.5, 1.0, 7.0, 300.0])
def test_none_is_missed_and_none_is_twice(ratio):
    b = cantilever_eigenvalues(ratio, 40)
    fine = np.linspace(1e-3, 0.5 * (b[-1] + cantilever_eigenvalues(ratio, 41)[-1]), 400_001)
    value = 1 / np.cosh(fine) + np.cos(fine) + ratio * fine * (np.cos(fine) * np.tanh(fine) - np.sin(fine))
    assert np.count_nonzero(value[1:] * value[:-1] < 0) == 40 and np.all(np.diff(b) > 0)


def test_a_tip_mass_lowers_every_eigenvalue_but_not_below_that_of_a_pinned_tip():
    free = cantilever_eigenvalues(0.0, 30)
    loaded = cantilever_eigenvalues(np.geomspace(1e-3, 1e6, 10), 30)
    i = np.arange(30)
    pinned = i * np.pi + np.where(i > 0, np.arctan(np.tanh(i * np.pi + np.pi / 4)), 0.0)  # within 4e-7 of the root
    assert np.all(np.diff(loaded, axis=0) < 0) and np.all(loaded < free) and np.all(loaded > pinned - 1e-6)


@each_row("ratio", [0.0, 1.2])
def test_finite_elements_find_the_same_frequencies(ratio):
    from scipy.linalg import eigh

    found = eigh(*finite_elements(ratio, 60), eigvals_only=True)[:6] ** 0.25
    assert found == pytest.approx(cantilever_eigenvalues(ratio, 6), rel=3e-6)  # error of mode n: (b h)^4/1440


def test_many_ratios_at_once_are_the_same_as_one_by_one():
    ratios = np.array([[0.0, 0.5], [1.0, 30.0]])
    many = cantilever_eigenvalues(ratios, 4)
    assert many.shape == (2, 2, 4) and np.array_equal(many[1, 0], cantilever_eigenvalues(1.0, 4))


def test_the_four_hundredth_mode_neither_overflows_nor_warns():
    b = cantilever_eigenvalues(1.2, 400)
    shapes = mode_shape(b[-1], np.linspace(0, 1, 101))
    assert abs(b[-1] - 399.25 * np.pi) < 0.01 and abs(shapes).max() < 2.5


@each_row(("ratio", "n"), [(-1.0, 3), (np.nan, 3), ("heavy", 3), ([1.0, np.inf], 3), (1.0, 0), (1.0, 2.5), (1.0, True)])
def test_bad_arguments_are_named(ratio, n):
    with pytest.raises(ss.InputError, match=r"type for example (tip_mass_ratio=1.2|n=5)"):
        ss.drives.cantilever_eigenvalues(ratio, n)


def test_all_bad_arguments_are_named_at_once():
    with pytest.raises(ss.InputError) as caught:
        ss.drives.cantilever_eigenvalues(-1.0, 0)
    assert len(caught.value.problems) == 2


# shapes and masses ------------------------------------------------------------------------------------------------


@each_row("ratio", [0.0, 1.2, 50.0])
def test_shapes_satisfy_the_boundary_conditions_and_the_equation(ratio):
    b = cantilever_eigenvalues(ratio, 12)
    zero = 1e-12  # of b^derivative
    assert abs(mode_shape(b, 0.0)).max() < zero and abs(mode_shape(b, 0.0, 1) / b).max() < zero
    assert abs(mode_shape(b, 1.0, 2) / b**2).max() < zero
    assert abs(mode_shape(b, 1.0, 3) / b**3 + ratio * b * mode_shape(b, 1.0)).max() < zero * max(1.0, ratio * b[-1])
    s = np.linspace(0, 1, 7)[:, None]
    assert mode_shape(b, s, 4) == pytest.approx(b**4 * mode_shape(b, s), rel=1e-9, abs=1e-9 * b[-1] ** 4)


@each_row("derivative", [1, 2, 3])
def test_derivatives_of_a_shape_are_its_derivatives(derivative):
    b, s, h = cantilever_eigenvalues(1.2, 5), 0.37, 1e-5
    slope = (mode_shape(b, s + h, derivative - 1) - mode_shape(b, s - h, derivative - 1)) / (2 * h)
    assert mode_shape(b, s, derivative) == pytest.approx(slope, rel=1e-6)  # h^2 b^2/6 and rounding over h


@each_row("ratio", [0.0, 1.2, 50.0])
def test_modes_are_orthogonal_with_the_tip_mass_counted(ratio):
    b = cantilever_eigenvalues(ratio, 20)
    nodes, weights = np.polynomial.legendre.leggauss(120)  # exact for products of modes up to b = 60
    shapes, tip = mode_shape(b[:, None], 0.5 * (nodes + 1)), mode_shape(b, 1.0)
    masses = (shapes * 0.5 * weights) @ shapes.T + ratio * np.outer(tip, tip)
    assert np.allclose(masses, np.diag(modal_mass(b, ratio)), atol=1e-10)


# under a couple ---------------------------------------------------------------------------------------------------


@each_row(("ratio", "end"), [(0.0, 0.2), (1.2, 0.4), (10.0, 0.9)])
def test_the_static_deflection_is_reached_by_the_modes(ratio, end):
    b = cantilever_eigenvalues(ratio, 400)
    static = end * (1 - end / 2)
    total = (couple.tip_participation(b, ratio, end) / b**4).sum()
    assert total == pytest.approx(static, rel=1e-7)  # without tip mass the terms fall as b^-3
    assert couple.tip_in_closed_form(0.05, ratio, end) == pytest.approx(static, rel=1e-4)  # and dynamics as R b^4/3


def test_the_known_forced_deflection():
    assert couple.tip_in_closed_form(0.6, 1.0, 0.4) == pytest.approx(0.33826656453, abs=1e-11)
    assert couple.tip_by_modes(0.36, 1.0, 0.4, 200).real == pytest.approx(0.33826656453, abs=1e-9)  # what modes 201 on add


@each_row(("ratio", "b"), each_once([0.0, 1.0, 12.0], [0.6, 1.1, 3.0, 5.5, 9.0]))
def test_closed_form_modes_and_boundary_conditions_agree(ratio, b):
    closed = couple.tip_in_closed_form(b, ratio, 0.3)
    assert closed == pytest.approx(by_conditions(b, ratio, 0.3), rel=1e-8)  # the condition of the eight equations grows as e^b
    assert couple.tip_by_modes(b**2, ratio, 0.3, 300).real == pytest.approx(closed, rel=1e-6, abs=1e-9)


def test_finite_elements_under_the_same_couple_agree():
    K, M = finite_elements(1.0, 50)
    push = np.zeros(len(K))
    push[2 * 20 - 1] = 1.0  # on the slope at s = 0.4; its counterpart is taken by the clamp
    for b in (0.6, 3.0):
        u = np.linalg.solve(K - b**4 * M, push)[-2]
        assert u == pytest.approx(couple.tip_in_closed_form(b, 1.0, 0.4), rel=1e-5)


def test_structural_damping_is_a_complex_frequency():
    eta, omega, ratio, end = 0.03, 1.6, 1.0, 0.4
    closed = couple.tip_in_closed_form(np.sqrt(omega / np.sqrt(1 + 1j * eta)), ratio, end) / (1 + 1j * eta)
    b = cantilever_eigenvalues(ratio, 300)
    modes = (couple.tip_participation(b, ratio, end) / (b**4 * (1 + 1j * eta) - omega**2)).sum()
    assert abs(closed - modes) < 1e-8 * abs(closed)


def test_at_a_resonance_the_tip_lags_the_couple_by_a_right_angle():
    b = cantilever_eigenvalues(1.2, 1)[0]
    tip = couple.tip_by_modes(b**2, 1.2, 0.3, 8, damping=1e-4)
    assert np.angle(tip) == pytest.approx(-np.pi / 2, abs=1e-3)
    assert abs(tip) == pytest.approx(couple.tip_participation(b, 1.2, 0.3) / (2e-4 * b**4), rel=1e-3)


def test_remembered_roots_are_those_of_an_array_and_cannot_be_changed():
    found = cantilever_eigenvalues(1.2, 6)
    assert found is cantilever_eigenvalues(1.2, 6)
    assert (found == cantilever_eigenvalues([0.5, 1.2], 6)[1]).all()
    with pytest.raises(ValueError, match="read-only"):
        found[0] = 0.0
