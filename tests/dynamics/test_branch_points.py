"""Branch points: where two branches of motions cross, with closed answers, and the branches that leave there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stickslip as ss
from rows import each_row
from stickslip.maths import cos, pi

of_map = ss.SwitchingFlow.of_map
PITCHFORK = of_map(lambda y, n: ((1 + n.p) * y[0] - y[0] ** 3,), {"p": -0.1}, ("x",))
TRANSCRITICAL = of_map(lambda y, n: ((1 + n.p) * y[0] - y[0] ** 2,), {"p": -0.1}, ("x",))
LORENZ = ss.SwitchingFlow(
    {0: lambda t, y, n: (10 * (y[1] - y[0]), n.r * y[0] - y[1] - y[0] * y[2], y[0] * y[1] - 8 / 3 * y[2])},
    {}, 1.0, {"r": 0.5}, ("x", "y", "z"),
)  # fmt: skip
CASES = {  # flow, its number, from where to where, where two branches cross, and the parameter on the other one
    "pitchfork": (PITCHFORK, "p", -0.1, 0.3, 0.0, lambda y: y[0] ** 2),
    "transcritical": (TRANSCRITICAL, "p", -0.1, 0.3, 0.0, lambda y: y[0]),
    "Lorenz": (LORENZ, "r", 0.5, 2.0, 1.0, lambda y: 1.0 + 3 / 8 * y[0] ** 2),
}


@pytest.mark.parametrize("name", CASES)
def test_branch_points_and_the_branches_that_cross_there_are_where_closed_forms_say(name):
    """1e-10: what derivatives by differences leave of a multiplier."""
    flow, parameter, start, stop, value, closed = CASES[name]
    branch = ss.continuation(flow, parameter=parameter, start=start, stop=stop, guess={flow.states[0]: 0.0})
    (point,) = branch.special
    assert point.kind == "branch-point" and abs(point.value - value) <= point.accuracy < 1e-9
    other = branch.switched()
    assert [s.kind for s in other.special] == ["branch-point"] and len(other.orbits) > 20
    np.testing.assert_allclose(other.values, [closed(o.state) for o in other.orbits], rtol=0, atol=1e-8)
    x = np.array([o.state[0] for o in other.orbits])
    assert np.all(np.diff(x) > 0) or np.all(np.diff(x) < 0), "one branch, from one end to the other"
    assert branch.ended == "it reached the end of the range"


@each_row(("name", "breaks"), [("pitchfork", True), ("Lorenz", True), ("transcritical", False)])
def test_only_a_crossing_of_images_is_called_symmetry_breaking(name, breaks):
    flow, parameter, start, stop, _, _ = CASES[name]
    branch = ss.continuation(flow, parameter=parameter, start=start, stop=stop, guess={flow.states[0]: 0.0})
    assert ("symmetry breaking" in " ".join(branch.special[0].orbit.notes)) == breaks


def test_a_pitchfork_seen_from_its_curved_branch_is_a_branch_point_and_no_fold():
    branch = ss.continuation(PITCHFORK, parameter="p", start=0.3, stop=-0.1, guess={"x": 0.3**0.5})
    assert [s.kind for s in branch.special] == ["branch-point"] and abs(branch.special[0].value) <= branch.special[0].accuracy
    assert branch.orbits[-1].state[0] == pytest.approx(-(0.3**0.5), abs=1e-9)
    straight = branch.switched(stop=-0.1)
    assert max(abs(o.state[0]) for o in straight.orbits) < 1e-12 and straight.values.min() == pytest.approx(-0.1)


@pytest.mark.parametrize("gap", [1e-5, -1e-6])
def test_branches_that_only_come_near_one_another_have_no_branch_point_and_are_not_confused(gap):
    """x to (1 + p) x - x^3 + gap: the branch of p < 0 goes on on the side of the gap, where p x - x^3 + gap = 0."""
    flow = of_map(lambda y, n: ((1 + n.p) * y[0] - y[0] ** 3 + n.gap,), {"p": -0.1, "gap": gap}, ("x",))
    branch = ss.continuation(flow, parameter="p", start=-0.1, stop=0.3, guess={"x": 0.0})
    assert branch.special == [] and np.sign(branch.orbits[-1].state[0]) == np.sign(gap) and abs(branch.orbits[-1].state[0]) > 0.5


def test_a_crossing_can_be_switched_back_at():
    branch = ss.continuation(TRANSCRITICAL, parameter="p", start=-0.1, stop=0.3, guess={"x": 0.0})
    back = branch.switched().switched()
    assert max(abs(o.state[0]) for o in back.orbits) < 1e-12 and np.ptp(back.values) == pytest.approx(0.4)


def test_a_branch_without_a_branch_point_says_what_can_be_switched_at():
    branch = ss.continuation(PITCHFORK, parameter="p", start=-0.3, stop=-0.1, guess={"x": 0.0})
    with pytest.raises(ss.InputError, match="there is no branch-point on this branch; allowed is one of"):
        branch.switched()


# ---- a mass on a cubic spring: a motion that is its own image half a period later ----
@dataclass(frozen=True, eq=False)
class Ueda(ss.Machine):
    """A mass on a cubic spring, pushed by a cosine."""

    push: float
    friction: Any
    damping: float = 0.0

    @property
    def period(self):
        """Of the push [s]."""
        return 2 * pi

    def bodies(self):
        """One mass."""
        return {"mass": ss.Body(1.0, force=lambda t, x, v: self.push * cos(t) - self.damping * v)}

    def contacts(self):
        """It rubs under a load of 1 N."""
        return {"track": ss.Contact("mass", self.friction, load=1.0)}

    def links(self):
        """To the ground."""
        return {("mass", None): ss.Spring(0.0, 0.0, cubic=1.0)}


DUFFING = ss.SwitchingFlow(
    {0: lambda t, y, n: (y[1], -0.2 * y[1] - y[0] ** 3 + n.push * cos(t))}, {}, 2 * np.pi, {"push": 2.0}, ("x", "v")
)  # fmt: skip


def half_map(push, state):
    """State and derivative half a period later, by another integrator, with the signs changed: a map whose square is the strobe map."""

    def rates(t, y):
        J = np.array([[0.0, 1.0], [-3 * y[0] ** 2, -0.2]])
        return [y[1], -0.2 * y[1] - y[0] ** 3 + push * np.cos(t), *(J @ y[2:].reshape(2, 2)).ravel()]

    end = solve_ivp(rates, (0, np.pi), [*state, 1, 0, 0, 1], method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    return -end[:2], -end[2:].reshape(2, 2)


def test_the_symmetry_of_a_forced_motion_breaks_where_its_half_map_has_a_multiplier_of_minus_one():
    branch = ss.continuation(DUFFING, parameter="push", start=2.3, stop=2.5)
    ((_, push, orbit),) = branch.special
    assert "half a period later" in orbit.notes[1]
    image, slopes = half_map(push, orbit.state)
    np.testing.assert_allclose(image, orbit.state, atol=1e-7)  # along the new branch a state is known to the root of rounding alone
    fixed = orbit.state + np.linalg.solve(np.eye(2) - slopes, image - orbit.state)  # one round of Newton's method
    multiplier = np.linalg.eigvals(half_map(push, fixed)[1])
    assert min(abs(multiplier + 1.0)) < 1e-8 and branch.special[0].accuracy < 1e-8
    one, *_, other = branch.switched().orbits
    np.testing.assert_allclose(half_map(2.5, one.state)[0], other.state, atol=1e-8)


def test_the_curve_of_a_pitchfork_is_closed_where_its_symmetry_stays():
    """x to (1 + p - q^2) x - x^3: p = q^2."""
    flow = of_map(lambda y, n: ((1 + n.p - n.q**2) * y[0] - y[0] ** 3,), {"p": -0.1, "q": 0.0}, ("x",))
    branch = ss.continuation(flow, parameter="p", start=-0.1, stop=0.3, guess={"x": 0.0})
    curve = ss.dynamics.special_curve(branch, branch.special[0], "q", stop=0.5)
    assert curve.kind == "branch-point" and curve.ended == "it reached the end of the range"
    np.testing.assert_allclose(curve.values[:, 0], curve.values[:, 1] ** 2, rtol=0, atol=1e-9)
    assert curve.accuracy[:, 0].max() < 1e-9


def test_two_branches_that_come_apart_end_the_curve_of_their_crossing():
    """x to (1 + p) x - x^2 + q: they cross at q = 0 alone."""
    flow = of_map(lambda y, n: ((1 + n.p) * y[0] - y[0] ** 2 + n.q,), {"p": -0.1, "q": 0.0}, ("x",))
    branch = ss.continuation(flow, parameter="p", start=-0.1, stop=0.3, guess={"x": 0.0})
    curve = ss.dynamics.special_curve(branch, branch.special[0], "q", stop=0.5)
    assert len(curve.values) == 1 and curve.ended == "the two branches separate as q changes: no symmetry preserves their crossing"


def test_symmetry_breaking_in_two_parameters_scales_as_the_equation_does():
    flow = ss.SwitchingFlow(
        {0: lambda t, y, n: (y[1], -0.2 * y[1] - n.k * y[0] ** 3 + n.push * cos(t))}, {}, 2 * np.pi, {"push": 2.3, "k": 1.0}, ("x", "v")
    )
    branch = ss.continuation(flow, parameter="push", start=2.3, stop=2.5)
    curve = ss.dynamics.special_curve(branch, branch.special[0], "k", stop=1.1, step=0.1)
    assert curve.ended == "it reached the end of the range"
    np.testing.assert_allclose(curve.values[:, 0] * np.sqrt(curve.values[:, 1]), branch.special[0].value, rtol=0, atol=1e-8)  # x by sqrt(k)


@pytest.mark.slow
def test_a_machine_breaks_its_symmetry_where_the_same_flow_does():
    start = Ueda(push=2.3, friction=ss.Viscous(0.2, 0.2))
    (here,) = ss.continuation(start, parameter="push", start=2.3, stop=2.5, guess=ss.solve(start, periods=80)).special
    (there,) = ss.continuation(DUFFING, parameter="push", start=2.3, stop=2.5).special
    assert here.kind == "branch-point" and abs(here.value - there.value) <= here.accuracy + there.accuracy < 1e-8


@pytest.mark.slow
def test_the_symmetry_of_a_motion_with_bristles_breaks_too():
    law = ss.LuGre(0.02, 0.02, f_plus=0.03, f_minus=0.03, sigma0=100.0, sigma1=0.1, sigma2=0.0, v_s=0.1)
    start = Ueda(push=2.3, friction=law, damping=0.2)
    branch = ss.continuation(start, parameter="push", start=2.3, stop=2.5, guess=ss.solve(start, periods=80))
    (point,) = branch.special
    assert point.kind == "branch-point" and point.accuracy < 1e-8 and "half a period later" in point.orbit.notes[1]
    assert min(abs(point.orbit.differences - 1.0)) < 1e-6, "by differences of the strobe map"
    other = branch.switched(points=10)
    low, high = other.orbits[0], other.orbits[-1]
    aside = [orbit.run.x.max() + orbit.run.x.min() for orbit in (low, high)]
    assert aside[0] * aside[1] < 0, "one swings more to the front, the other to the back"
    assert abs(low.state - high.state).max() > 0.01
