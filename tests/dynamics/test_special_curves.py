"""Curves of folds, flips and Neimark-Sacker points in two parameters, and the special points on them, with closed answers."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from dynamics.test_dynamics_special import Fed
from rows import each_row
from stickslip.dynamics.continuation.special_points.accuracy import Special

of_map = ss.SwitchingFlow.of_map
HENON = of_map(lambda y, n: (1 - n.a * y[0] ** 2 + y[1], n.b * y[0]), {"a": 0.1, "b": 0.3}, ("x", "y"))
CUBIC = of_map(lambda y, n: (n.p + n.q * y[0] - y[0] ** 3,), {"p": -0.5, "q": 1.3}, ("x",))
TURN = np.pi / 3


def first(branch, kind):
    return next(s for s in branch.special if s.kind == kind)


def met(curve):
    return [m.kind for m in curve.special]


def certain(meeting, expected):
    """Each parameter lies as near to the closed one as its accuracy says, and that is small."""
    for value, exact, accuracy in zip(meeting.values, expected, meeting.accuracy, strict=True):
        assert abs(value - exact) <= accuracy < 1e-8


@pytest.fixture(scope="module")
def henon():
    """Branches of Henon's map at b = 0.3, through its fold and its flip, and one at a = 1 through the line b = -1."""
    fold = ss.continuation(HENON, parameter="a", start=0.1, stop=-0.3, guess={"x": 0.7, "y": 0.2}, points=40)
    flip = ss.continuation(HENON, parameter="a", start=0.1, stop=1.0, guess={"x": 0.7, "y": 0.2})
    pair = ss.continuation(HENON.replace(a=1.0), parameter="b", start=-0.8, stop=-1.1, guess={"x": 0.45, "y": -0.36})
    return {"fold": fold, "flip": flip, "neimark-sacker": pair}


@pytest.mark.parametrize(
    ("kind", "a", "resonance", "where"),
    [("fold", lambda b: -((1 - b) ** 2) / 4, "R1", (-1.0, -1.0)), ("flip", lambda b: 3 * (1 - b) ** 2 / 4, "R2", (3.0, -1.0))],
)
def test_curves_of_henons_map_are_closed_and_their_resonances_lie_where_areas_are_kept(henon, kind, a, resonance, where):
    """a = -(1 - b)^2/4 and 3 (1 - b)^2/4; the product of the multipliers is -b, so both are 1, or -1, at b = -1."""
    curve = ss.dynamics.special_curve(henon[kind], first(henon[kind], kind), "b", stop=-1.2)
    assert np.all(abs(curve.values[:, 0] - a(curve.values[:, 1])) <= curve.accuracy.max(axis=1) + 1e-12) and curve.accuracy.max() < 1e-9
    assert met(curve) == [resonance] and curve.ended == "it reached the end of the range"
    certain(curve.special[0], where)


@each_row(
    ("stop", "found", "last"),
    [(4.0, {"R3": 1.25, "R2": 3.0}, "R2"), (-1.5, {"R4": 0.0, "R1": -1.0}, "R1")],
)
def test_a_neimark_sacker_curve_ends_at_the_resonances_of_its_closed_angle(henon, stop, found, last):
    """At b = -1 the pair turns by an angle with cosine 1 - sqrt(1 + a)."""
    curve = ss.dynamics.special_curve(henon["neimark-sacker"], first(henon["neimark-sacker"], "neimark-sacker"), "a", stop=stop)
    assert np.all(abs(curve.values[:, 0] + 1.0) < 1e-9) and met(curve) == list(found)
    for meeting in curve.special:
        certain(meeting, (-1.0, found[meeting.kind]))
    assert f"({last})" in curve.ended and np.allclose(curve.values[-1], curve.special[-1].values)


def test_two_curves_of_folds_end_in_a_cusp():
    """p + (q - 1) x - x^3 = 0 has a double root where 27 p^2 = 4 (q - 1)^3."""
    branch = ss.continuation(CUBIC, parameter="p", start=-0.5, stop=0.3, guess={"x": -0.9})
    curve = ss.dynamics.special_curve(branch, first(branch, "fold"), "q", stop=0.5)
    p, q = curve.values.T
    np.testing.assert_allclose(27 * p**2, 4 * (q - 1) ** 3, rtol=0, atol=1e-10)
    assert met(curve) == ["cusp"] and p[0] > 0 > p[-1], "it goes through the cusp to the other curve, and back"
    certain(curve.special[0], (0.0, 1.0))


def test_a_neimark_sacker_point_of_the_delayed_logistic_map_and_its_curve():
    """x to r x (1 - y), y to x + e y: the determinant is 1 at r = 2 for e = 0, and along its curve (see below)."""
    flow = of_map(lambda y, n: (n.r * y[0] * (1 - y[1]), y[0] + n.e * y[1]), {"r": 1.6, "e": 0.0}, ("x", "y"))
    branch = ss.continuation(flow, parameter="r", start=1.6, stop=2.4, guess={"x": 0.4, "y": 0.4})
    point = first(branch, "neimark-sacker")
    assert abs(point.value - 2.0) <= point.accuracy < 1e-8 and "rotates by 0.16666666" in point.orbit.notes[0]
    curve = ss.dynamics.special_curve(branch, point, "e", stop=0.3)
    r, e = curve.values.T  # y = 1 - 1/r, x = (1 - e) y: the derivative ((1, -r x), (1, e)) has the determinant e + (1 - e)(r - 1)
    np.testing.assert_allclose(e + (1 - e) * (r - 1), 1.0, rtol=0, atol=1e-10)


@pytest.mark.parametrize(
    ("other", "kind"),
    [
        (lambda y, n: (-(1 + n.q) * y[1] + y[1] ** 3,), "fold-flip"),
        (
            lambda y, n: (
                (1 + n.q) * (np.cos(TURN) * y[1] - np.sin(TURN) * y[2]) - y[1] ** 3,
                (1 + n.q) * (np.sin(TURN) * y[1] + np.cos(TURN) * y[2]) - y[2] ** 3,
            ),
            "fold-neimark-sacker",
        ),
    ],
)
def test_a_fold_meets_a_flip_or_a_turning_pair_where_two_motions_side_by_side_say(other, kind):
    """x to p + x - x^2 folds at p = 0; beside it motions that double, or turn, at q = 0."""
    states = ("x", "y", "z")[: 1 + len(other([0.0] * 3, type("n", (), {"q": 0.0})))]
    flow = of_map(lambda y, n: (n.p + y[0] - y[0] ** 2 + 0.1 * y[1], *other(y, n)), {"p": 0.2, "q": -0.2}, states)
    branch = ss.continuation(flow, parameter="p", start=0.2, stop=-0.1, guess={"x": 0.4}, points=30)
    curve = ss.dynamics.special_curve(branch, first(branch, "fold"), "q", stop=0.2)
    assert met(curve) == [kind]
    certain(curve.special[0], (0.0, 0.0))


def test_the_pair_of_a_linear_oscillator_with_a_spring_is_followed_through_its_resonances():
    """A machine: multipliers exp((a/2 +- i sqrt(1 - a^2/4)) 2 pi/omega), so a = 0; 1/omega = 4/3 and 5/4 turns."""
    free = lambda a, omega=0.7: ss.ForcedOscillator(1.0, 1.0, 1.0, omega, Fed(a, 0.0))  # noqa: E731
    branch = ss.continuation(free, parameter="a", start=-0.2, stop=0.1, step=0.2)
    curve = ss.dynamics.special_curve(branch, branch.special[0], "omega", stop=0.9)
    assert np.all(abs(curve.values[:, 0]) <= curve.accuracy[:, 0] + 1e-12) and curve.accuracy.max() < 1e-8
    assert met(curve) == ["R3", "R4"]
    certain(curve.special[0], (0.0, 0.75))
    certain(curve.special[1], (0.0, 0.8))


@pytest.mark.slow
def test_a_fold_of_limit_cycles_with_bristles_is_the_same_from_a_branch_beside_it():
    """A block on a belt under LuGre: the curve of its fold in speed and damping, held against a branch at its last damping."""
    law = ss.LuGre(1.0, 1.0, f_plus=1.5, f_minus=1.5, sigma0=100.0, sigma1=5.0, sigma2=0.0, v_s=0.2)
    belt = lambda speed, damping=0.3: ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=speed, damping=damping, friction=law)  # noqa: E731
    ways = {"parameter": "speed", "start": 0.5, "stop": 0.65, "guess": {"x": 0.6, "v": 0.5}}
    branch = ss.continuation(belt, **ways)
    curve = ss.dynamics.special_curve(branch, first(branch, "fold"), "damping", stop=0.32)
    (speed, damping), unsure = curve.values[-1], curve.accuracy[-1, 0]
    assert curve.orbits[-1].duration > 0 and unsure < 1e-8
    fold = first(ss.continuation(belt, damping=damping, **ways), "fold")
    assert abs(fold.value - speed) <= fold.accuracy + unsure + 1e-9


def test_what_has_no_curve_says_which_special_points_have_one():
    branch = ss.continuation(CUBIC, parameter="p", start=-0.5, stop=0.3, guess={"x": -0.9})
    with pytest.raises(ss.InputError, match="it is a hopf; allowed are fold, flip, neimark-sacker"):
        ss.dynamics.special_curve(branch, Special("hopf", 0.0, branch.orbits[0]), "q", 0.5)
