"""Contacts whose slip is a sum of coefficients times velocities: points of bodies that are known by their modes, levers, gears."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.errors import InputError
from stickslip.maths import pi, sin

COULOMB, LUGRE = ss.Coulomb(0.3, 0.4), ss.friction.LuGre(0.3, 0.3, 0.35, 0.35, sigma0=1e3, sigma1=3.0, sigma2=0.0, v_s=0.1)
STRIBECK = ss.Stribeck(0.2, 0.2, 0.3, 0.3, v_s=0.1, exponent=1.0)


@dataclass(frozen=True, eq=False)
class BowedString(ss.Machine):
    """A string by its first modes of 0.5 g each, bowed at a part of its length with constant force."""

    bow: float
    press: float
    place: float
    friction: Any
    modes: Any = 10
    time_scale = 0.005
    velocity_scale = 0.1

    def bodies(self):
        return {f"mode {j}": ss.Body(0.5e-3) for j in range(1, self.modes + 1)}

    def links(self):
        omega = {j: 2 * math.pi * 200.0 * j for j in range(1, self.modes + 1)}
        return {(f"mode {j}", None): ss.Spring(0.5e-3 * w**2, 0.5e-3 * 2 * 0.002 * w) for j, w in omega.items()}

    def contacts(self):
        shape = {f"mode {j}": sin(j * pi * self.place) for j in range(1, self.modes + 1)}
        return {"bow": ss.Contact(shape, self.friction, on=self.bow, load=self.press)}


@dataclass(frozen=True, eq=False)
class Lever(ss.Machine):
    """Two oscillators that rub at two points, whose slips both decide."""

    ratio: float
    push: float
    friction: Any
    omega: float = 2.2
    other: Any = -0.9

    @property
    def period(self):
        return 2 * pi / self.omega

    def bodies(self):
        return {"a": ss.Body(1.0, force=lambda t, x, v: self.push * sin(self.omega * t)), "b": ss.Body(0.5)}

    def links(self):
        return {("a", None): ss.Spring(4.0, 0.1), ("b", None): ss.Spring(9.0, 0.05)}

    def contacts(self):
        return {
            "tip": ss.Contact({"a": 1.0, "b": self.ratio}, self.friction, load=1.0),
            "root": ss.Contact({"a": 0.4, "b": self.other}, self.friction, on=0.05, load=0.8),
        }


def test_a_bowed_string_of_ten_modes_is_that_of_scipy():
    """125 events in 0.2 s and 2.42249e-4 m of the first mode, by a hand-written SciPy program to 1e-10 and 1e-13."""
    run = ss.solve(BowedString(0.1, 1.0, 0.2, ss.Stribeck(0.2, 0.2, 0.8, 0.8, v_s=0.1, exponent=1.0)), duration=0.2)
    assert (run.method, len(run.events)) == ("exact", 125)
    assert run.x[-1][0] == pytest.approx(2.422494e-4, abs=3e-10)


@each_row("law, method, rtol, apart", [(COULOMB, "dop853", 1e-12, 1e-10), (STRIBECK, "dop853", 1e-12, 1e-10)], ids=["Coulomb", "Stribeck"])
def test_two_contacts_that_share_coordinates_are_those_of_the_judge(law, method, rtol, apart):
    """Bodies that two contacts brake with different coefficients: events of both, also of rest, at the same instants."""
    run, judge = (ss.solve(Lever(0.6, 1.2, law), periods=6, **given) for given in ({}, {"method": method, "rtol": rtol}))
    assert len(run.events) == len(judge.events) > 20
    assert {e.kind for e in run.events} == {"stick", "slip", "reversal"}
    assert max(abs(a.t - b.t) for a, b in zip(run.events, judge.events, strict=True)) < apart
    assert np.allclose(run.x[-1], judge.x[-1], rtol=0, atol=apart)


def test_friction_acts_on_each_coordinate_by_its_coefficient():
    """Force of friction times row over mass is what it changes the accelerations by, and at rest the slip keeps still."""
    run = ss.solve(Lever(0.6, 1.2, COULOMB), periods=4)
    at = run.at(np.linspace(1.0, 11.0, 400))
    g, m = np.array([[1.0, 0.6], [0.4, -0.9]]), np.array([1.0, 0.5])
    free = np.stack([1.2 * np.sin(2.2 * at["t"]), 0 * at["t"]], 1) - at["x"] * [4.0, 9.0] - at["v"] * [0.1, 0.05]
    assert np.allclose(at["acceleration"], (free - at["friction_force"] @ g) / m, rtol=0, atol=1e-12)
    assert np.allclose(at["slip"], at["v"] @ g.T - [0.0, 0.05], rtol=0, atol=1e-14)
    rests = at["mode"] == 0
    assert rests.any() and np.max(abs((at["acceleration"] @ g.T)[rests])) < 1e-12


def test_the_energy_balance_of_rows_is_exact_to_rounding():
    assert np.max(abs(ss.energy(ss.solve(Lever(0.6, 3.0, COULOMB), periods=6)).residual)) < 1e-13


def test_one_coefficient_of_one_is_a_contact_of_that_body():
    """To the last bit: the row is asked, not how it was written."""

    class Plain(Lever):
        def contacts(self):
            return {"tip": ss.Contact("a", self.friction, load=1.0)}

    class ByRow(Lever):
        def contacts(self):
            return {"tip": ss.Contact({"a": 1.0, "b": 0.0}, self.friction, load=1.0)}

    a, b = (ss.solve(made(0.6, 3.0, COULOMB), periods=3) for made in (Plain, ByRow))
    assert np.array_equal(a.x, b.x) and [e.t for e in a.events] == [e.t for e in b.events]


def test_multipliers_of_rows_are_those_of_differences():
    """The map over one period by differences of 1e-6 about an orbit that rests for a while."""
    lever = Lever(0.6, 1.5, ss.Coulomb(0.3, 0.3), omega=1.0)
    orbit = ss.periodic_orbit(lever)
    names, base = ("a", "b"), np.concatenate([orbit.run.x[0], orbit.run.v[0]])
    assert {e.kind for e in orbit.run.events} >= {"stick", "slip"}

    def after(state):
        start = {"x": dict(zip(names, state[:2], strict=True)), "v": dict(zip(names, state[2:], strict=True))}
        run = ss.solve(lever, periods=1, start=start)
        return np.concatenate([run.x[-1], run.v[-1]])

    step = 1e-6
    map_of = np.array([(after(base + step * e) - after(base - step * e)) / (2 * step) for e in np.eye(4)]).T
    expected = sorted(abs(np.linalg.eigvals(map_of)))
    assert np.allclose(sorted(abs(orbit.multipliers)), expected, rtol=0, atol=1e-5)


def test_a_law_with_inner_states_rubs_on_rows_too():
    """Rosenbrock steps to 1e-9 against themselves to 1e-11, and rows in the equations as written."""
    lever = Lever(0.6, 3.0, LUGRE)
    one, other = (ss.solve(lever, periods=4, rtol=rtol) for rtol in (1e-9, 1e-11))
    assert np.allclose(one.x[-1], other.x[-1], rtol=0, atol=1e-7)
    text = ss.latex(lever)
    assert r"w_{\mathrm{tip}} &= \mathrm{ratio} \, v_{b} + v_{a}" in text


@each_row(
    "row, options, words",
    [
        ({"a": 1.0, "c": 2.0}, {"load": 1.0}, "'c', which is not a body"),
        ({}, {"load": 1.0}, "nothing decides its slip"),
        ({"a": 0.0}, {"load": 1.0}, "nothing decides its slip"),
        ({"a": "much"}, {"load": 1.0}, "a coefficient, positive or negative"),
        ({"a": 0.5}, {}, "type load=1.0"),
        ({"a": 0.5}, {"load": 1.0, "on": "b"}, "{..., 'b': -1.0}"),
        ({"a": 0.5}, {"load": 1.0, "restitution": 0.3}, "type restitution=None"),
        ("a", {"hold": "both"}, "it is for machines that say where bodies are"),
        ("a", {"load": 1.0, "at": (0.1, 0.0)}, "it is for machines that say where bodies are"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_row_is_said_with_what_to_type(row, options, words):
    class Wrong(Lever):
        def contacts(self):
            return {"tip": ss.Contact(row, self.friction, **options)}

    with pytest.raises(InputError, match=re.escape(words)):
        Wrong(0.6, 3.0, COULOMB)


def test_slips_that_follow_from_one_another_go_to_the_judge():
    lever = Lever(0.6, 3.0, COULOMB, other=0.24)  # 0.4 times the other row
    with pytest.raises(InputError, match="the slips of some follow from those of others"):
        ss.solve(lever, periods=1, method="exact")
