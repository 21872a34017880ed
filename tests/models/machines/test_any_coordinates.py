"""Machines in coordinates of their own: places of bodies, a matrix of inertia, or a kinetic energy."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

import stickslip as ss
from rows import each_row
from stickslip.basics.errors import InputError
from stickslip.basics.fields import leaves
from stickslip.engine.symbolic import SPAN
from stickslip.engine.trace import trace
from stickslip.engine.values import values_of
from stickslip.maths import cos, sin
from stickslip.models.machine_adapter import machine_of
from stickslip.models.pushed import pushed
from stickslip.solvers.plain.choosing import after_event
from stickslip.solvers.plain.plain_equations import ContactModes, Equations

COULOMB = ss.Coulomb(0.1, 0.1)
LUGRE = ss.friction.LuGre(0.1, 0.1, 0.1, 0.1, sigma0=1e5, sigma1=100.0, sigma2=0.0, v_s=0.01)


class CartPole(ss.machines.CartPole):
    """A pendulum on a cart that is pushed to and fro; the rail bears the weight of both."""

    def contacts(self):
        return {"rail": ss.Contact("cart", self.friction, load=(self.cart + self.bob) * 9.81)}


class ByMatrix(CartPole):
    """The same by its matrix of inertia; the weight is a force."""

    def bodies(self):
        return {}

    def places(self, t, q):
        return None

    def inertia(self, q):
        c = self.bob * self.length * cos(q["angle"])
        return ((self.cart + self.bob, c), (c, self.bob * self.length**2))

    def forces(self, t, q, u):
        return {"x": self.push * sin(self.omega * t), "angle": -9.81 * self.bob * self.length * sin(q["angle"])}

    def contacts(self):
        return {"rail": ss.Contact("x", self.friction, load=(self.cart + self.bob) * 9.81)}


class ByEnergy(ByMatrix):
    """The same by its kinetic energy."""

    def inertia(self, q):
        return None

    def kinetic(self, q, u):
        along, up = u["x"] + self.length * cos(q["angle"]) * u["angle"], self.length * sin(q["angle"]) * u["angle"]
        return 0.5 * self.cart * u["x"] ** 2 + 0.5 * self.bob * (along**2 + up**2)


class Arm(ss.machines.TwoLinkArm):
    """Two links under a law whose joints have loads."""

    def contacts(self):
        return {name: ss.Contact(name, self.shoulder, load=load) for name, load in (("shoulder", 8.0), ("elbow", 4.0))}


def arm(law, torque=6.0, omega=3.0):
    """One with numbers of its own."""
    return Arm(1.2, 0.8, 0.5, 0.25, 0.2, 0.03, 0.02, law, law, torque, omega=omega)


@dataclass(frozen=True, eq=False)
class DoublePole(ss.Machine):
    """Two pendulums, one below the other, on a cart."""

    friction: Any
    coordinates = ("x", "first", "second")
    period = 1.0

    def bodies(self):
        return {"cart": ss.Body(1.1), "upper": ss.Body(0.4), "lower": ss.Body(0.3)}

    def places(self, t, q):
        x, z = q["x"] + 0.5 * sin(q["first"]), -0.5 * cos(q["first"])
        return {"cart": (q["x"], 0.0), "upper": (x, z), "lower": (x + 0.7 * sin(q["second"]), z - 0.7 * cos(q["second"]))}

    def contacts(self):
        return {"rail": ss.Contact("cart", self.friction, hold="both")}


POLE, START = CartPole(1.0, 0.3, 0.5, COULOMB, 4.0, 5.0), {"x": {"angle": 0.5}, "v": {}}
ARM = arm(ss.Coulomb(0.2, 0.2))


def by_hand_pole(q, u):
    """Matrix of inertia and what is on the other side, without friction and push, of the cart with pendulum."""
    c, s, ml = np.cos(q[1]), np.sin(q[1]), 0.3 * 0.5
    return np.array([[1.3, ml * c], [ml * c, ml * 0.5]]), np.array([ml * s * u[1] ** 2, -9.81 * ml * s])


def by_hand_arm(q, u):
    """The same of two links: Spong and Vidyasagar's planar elbow, angles from the downward vertical."""
    m1, m2, l1, c1, c2, i1, i2, g = 1.2, 0.8, 0.5, 0.25, 0.2, 0.03, 0.02, 9.81
    c, h = np.cos(q[1]), m2 * l1 * c2 * np.sin(q[1])
    M11 = m1 * c1**2 + m2 * (l1**2 + c2**2 + 2 * l1 * c2 * c) + i1 + i2
    M12 = m2 * (c2**2 + l1 * c2 * c) + i2
    g1 = (m1 * c1 + m2 * l1) * g * np.sin(q[0]) + m2 * c2 * g * np.sin(q[0] + q[1])
    g2 = m2 * c2 * g * np.sin(q[0] + q[1])
    right = [h * (2 * u[0] * u[1] + u[1] ** 2) - g1, -h * u[0] ** 2 - g2]
    return np.array([[M11, M12], [M12, m2 * c2**2 + i2]]), np.array(right)


def by_hand_double(q, u):
    """The same of a cart with two pendulums, by Lagrange's equations: angles from the downward vertical, each its own."""
    both, l1, l2, g, c, s = 0.7, 0.5, 0.7, 9.81, np.cos(q), np.sin(q)
    M12, M13, M23 = both * l1 * c[1], 0.3 * l2 * c[2], 0.3 * l1 * l2 * np.cos(q[1] - q[2])
    turned = 0.3 * l1 * l2 * np.sin(q[1] - q[2])
    right = [both * l1 * s[1] * u[1] ** 2 + 0.3 * l2 * s[2] * u[2] ** 2, -turned * u[2] ** 2 - both * g * l1 * s[1],
             turned * u[1] ** 2 - 0.3 * g * l2 * s[2]]  # fmt: skip
    return np.array([[1.8, M12, M13], [M12, both * l1**2, M23], [M13, M23, 0.3 * l2**2]]), np.array(right)


@each_row(
    "machine, by_hand",
    [(POLE, by_hand_pole), (ByMatrix(1.0, 0.3, 0.5, COULOMB, 4.0, 5.0), by_hand_pole),
     (ByEnergy(1.0, 0.3, 0.5, COULOMB, 4.0, 5.0), by_hand_pole), (ARM, by_hand_arm), (DoublePole(COULOMB), by_hand_double)],
    ids=["places", "matrix", "kinetic energy", "two links", "two pendulums on a cart"],
)  # fmt: skip
def test_equations_are_those_by_hand(machine, by_hand):
    """Matrix and accelerations at 1000 random states; sums of a few products: 1e-13 of their size."""
    draw, m = np.random.default_rng(20261129), machine.mechanics
    for q, u in draw.uniform(-2.0, 2.0, (1000, 2, len(m.bodies))):
        M, h = by_hand(q, u)
        assert np.allclose(np.array(m.matrix(0.0, tuple(q))), M, rtol=0, atol=1e-14)
        assert np.allclose(
            m.accelerations(0.0, tuple(q), tuple(u), (0.0,) * len(m.contacts)), np.linalg.solve(M, h), rtol=1e-12, atol=1e-11
        )


@each_row("law, end, rtol", [(COULOMB, (0.2832083, 0.70112725), 1e-9), (LUGRE, (0.28927224, 0.70470768), 1e-9)], ids=["Coulomb", "LuGre"])
def test_a_cart_with_a_pendulum_is_that_of_scipy(law, end, rtol):
    """Five periods by hand-written SciPy programs, of rtol 1e-11 (events) and 1e-9 (Radau)."""
    run = ss.solve(POLE.replace(friction=law), periods=5, start=START, rtol=rtol)
    assert np.allclose(run.x[-1], end, rtol=0, atol=3e-8)


def test_three_ways_to_say_it_are_one_machine():
    """Places, matrix and kinetic energy: runs of five periods agree to rounding that grows tenfold or so in a period."""
    ends = [ss.solve(made(1.0, 0.3, 0.5, COULOMB, 1.5, 5.0), periods=5, start=START).x[-1] for made in (CartPole, ByMatrix, ByEnergy)]
    assert np.allclose(ends[1:], ends[0], rtol=0, atol=1e-11)


def test_energy_is_balanced_to_rounding_and_what_rests_rests_exactly():
    for machine, start in ((POLE, START), (ByEnergy(1.0, 0.3, 0.5, COULOMB, 1.5, 5.0), START), (ARM, {"x": {"elbow": 0.4}})):
        assert np.max(abs(ss.energy(ss.solve(machine, periods=5, start=start)).residual)) < 1e-13
    run = ss.solve(POLE.replace({"push": 1.5}), periods=6, start=START)
    rests = run.contacts["rail"].mode == 0
    assert rests.any() and np.all(run.v[rests, 0] == 0.0)
    assert np.all(abs(run.contacts["rail"].friction_force[rests]) <= 0.1 * 1.3 * 9.81 * (1 + 1e-12))

    machine = arm(ss.Coulomb(0.2, 0.2, 0.35, 0.3))  # static friction above kinetic: what rested stays if it can, as the judge decides
    eq, judge, rng = trace(machine), Equations(machine), np.random.default_rng(1)
    for _ in range(120):
        t, *q, side = rng.uniform(0, 2), *rng.uniform(-3, 3, 2), float(rng.choice([-1, 1]))
        known = {eq.t.name: t, SPAN: machine.period} | dict(leaves(machine))
        known |= dict(zip([of.name for of in (*eq.y, *eq.modes)], (0.0, 0.0, *q, side, 0.0), strict=True))
        after = eq.switches[eq.signs].modes  # of the first joint, whose slip has come to zero
        values = values_of(eq.graph, known, after)
        decided = after_event(judge, t, np.array([*q, 0.0, 0.0]), ContactModes((int(side), 0), ((), ())), [0])[1]
        assert tuple(int(values[mode.number]) for mode in after) == decided.sides[:2]


@pytest.mark.slow
def test_gradients_under_a_law_with_inner_states_hold_more_than_the_tolerance_of_the_run():
    """A run of rtol 1e-6: its gradients agree with differences of runs of 1e-12 to 3e-8."""
    pole = POLE.replace(friction=LUGRE)
    found = ss.dynamics.sensitivity(ss.solve(pole, periods=2, start=START), wrt=["length", "push"])
    for i, name in enumerate(found.names):

        def end(h, name=name, value=found.values[i]):
            moved = ss.solve(pole.replace({name: value * (1 + h)}), periods=2, start=START, rtol=1e-12)
            return np.r_[moved.mean_velocity, moved.v[-1], moved.x[-1, 1]]

        one, half = ((end(h) - end(-h)) / (2 * h * found.values[i]) for h in (1e-4, 5e-5))
        exact = np.r_[found.mean_velocity[i], found.state[i][[0, 1, 3]]]
        assert np.max(abs(exact - (4 * half - one) / 3)) < 3e-8 * np.max(abs(exact))


def test_a_load_from_another_coordinate_makes_modes_flutter():
    """The mode-coupling brake is linear while it slides: it goes as the exponential of its matrix, which grows from `critical` on."""
    for damping in (0.0, 0.1):
        pad = ss.presets.mode_coupling(mu=0.45, damping=damping, speed=-1.0)
        along, askew, across = pad.stiffnesses

        def matrix(mu, c=damping, along=along, askew=askew, across=across):
            return np.array([[0, 0, 1, 0], [0, 0, 0, 1], [-along, mu * 11.0 - askew, -c, 0], [-askew, -across, 0, -c]])

        A, still = matrix(0.45), np.zeros(4)
        still[:2] = np.linalg.solve(-A[2:, :2], [-0.45 * 10.0, 0.0])
        start = still + np.array([0.0, 0.05, 0.0, 0.0])
        run = ss.solve(pad, duration=20.0, start={"x": dict(zip("xz", start[:2], strict=True))})
        assert len(run.events) == 0
        assert np.allclose(np.r_[run.x[-1], run.v[-1]], still + expm(20.0 * A) @ (start - still), rtol=0, atol=1e-11)
        below, above = (max(np.linalg.eigvals(matrix(pad.critical + part)).real) for part in (-1e-6, 1e-6))
        assert below < 1e-7 < above < 1e-2


def test_bodies_are_where_places_say():
    run = ss.solve(POLE, periods=2, start=START)
    angle, bob = run.coordinates["angle"], run.bodies["bob"]
    assert list(run.bodies) == ["cart", "bob"] and angle[0] == 0.5
    assert np.allclose(bob.x, run.coordinates["x"] + 0.5 * np.sin(angle), rtol=0, atol=1e-15)
    assert np.allclose(bob.z, -0.5 * np.cos(angle), rtol=0, atol=1e-15)
    assert np.allclose(bob.v_z, 0.5 * np.sin(angle) * run.v[:, 1], rtol=0, atol=1e-14)
    assert np.all(run.bodies["cart"].z == 0.0) and np.all(ss.solve(ARM, periods=1).bodies["upper"].angle[:1] == 0.0)


def test_an_orbit_a_sweep_and_the_mirror_image_go_through_the_same_doors():
    orbit = ss.periodic_orbit(POLE)
    assert orbit.residual < 1e-12 and np.all(abs(orbit.multipliers) < 1)
    grid = ss.sweep(POLE, length=[0.4, 0.5], periods=3, settle=0)
    assert grid.sizes["length"] == 2 and np.all(grid["status"] == 0)
    run, other = ss.solve(POLE, periods=3, start=START), ss.solve(ss.mirrored(POLE), periods=3, start={"x": {"angle": -0.5}})
    assert np.allclose(run.x[-1], -other.x[-1], rtol=0, atol=1e-12)
    text = ss.latex(POLE)
    assert r"\ddot x \left(M + m\right)" in text and r"\dot{\mathrm{angle}}^{2}" in text


def with_(**methods):
    """The cart and pole with other methods."""
    return type("Other", (CartPole,), methods)


RAIL = lambda self: {"rail": ss.Contact("cart", self.friction, load=1.0)}  # noqa: E731


@each_row(
    "changed, words",
    [
        ({"coordinates": ("x", "x")}, 'type coordinates = ("x", "angle")'),
        ({"places": lambda self, t, q: {"cart": (q["x"], 0.0), "bob": (q["x"], 1.0)}}, "nothing moves with the coordinate 'angle' alone"),
        ({"places": lambda self, t, q: {"cart": (q["y"], 0.0)}}, "'y' is not a coordinate"),
        ({"places": lambda self, t, q: {"cart": (q["x"], 0.0)}}, "bodies() has 'bob', and places() has not"),
        ({"places": lambda self, t, q: None}, "neither places nor inertia nor kinetic is given"),
        ({"inertia": lambda self, q: ((1.0, 0.0), (0.0, 1.0))}, "places and inertia are given"),
        ({"places": lambda self, t, q: {"cart": (q["x"], 0.0), "bob": (q["x"] + sin(q["angle"]), sin(t))}}, "places() vary with time"),
        ({"forces": lambda self, t, q, u: {"y": 1.0}}, "forces() has 'y', which is not a coordinate"),
        ({"contacts": lambda self: {"rail": ss.Contact({"y": 1.0}, self.friction, load=1.0)}}, "'y', which is not a coordinate"),
        ({"contacts": lambda self: {"rail": ss.Contact({"x": 0.0}, self.friction, load=1.0)}}, "nothing decides its slip"),
        ({"contacts": lambda self: {"rail": ss.Contact("cart", self.friction)}}, "type load=1.0"),
        ({"contacts": lambda self: {"rail": ss.Contact("cart", self.friction, load=1.0, hold="push")}}, "leave load out"),
        ({"stops": lambda self: {("x", None): ss.Stop(gap=0.1, restitution=0.5)}}, "stops with restitution are not there yet"),
        ({"links": lambda self: {("bob", None): ss.Spring(3.0)}}, "type ss.Point(None, at=(0.0, 0.0))"),
        ({"principal": "bob"}, "principal = 'bob'"),
        ({"contacts": lambda self: {"rail": ss.Contact("cart", self.friction, at=(0.1, 0.0, 0.0), load=1.0)}}, "type at=(0.1, 0.0)"),
        ({"contacts": lambda self: {"rail": ss.Contact("cart", self.friction, at=(0.1, np.nan), load=1.0)}}, "at[1] = nan"),
        ({"contacts": lambda self: {"hinge": ss.Contact("angle", self.friction, at=(0.1, 0.0), load=1.0)}}, "with a body's name"),
        ({"places": lambda self, t, q: {"cart": (q["x"], 0.0), "bob": (0.0, q["angle"] ** 2)}}, "at the start, where x = 0, angle = 0"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_coordinates_is_said_with_what_to_type(changed, words):
    with pytest.raises(InputError, match=re.escape(words)):
        ss.solve(with_(**changed)(1.0, 0.3, 0.5, COULOMB, 4.0, 5.0), duration=0.1)


def test_forces_of_a_simulation_act_along_the_coordinates():
    pole = CartPole(1.0, 0.3, 0.5, COULOMB, 4.0, 5.0)
    sim, run = ss.simulation(pole), ss.solve(pole, periods=2)
    state = sim.step(0.3, inputs={"force on x": 0.0})
    assert state["x"] == pytest.approx(run.at(0.3)["x"], rel=1e-9)
    there, force = machine_of(pushed(pole).replace({"applied.1": 0.2})).mechanics, 0.2
    at = (0.1, (0.0, 0.4), (0.2, 0.3), (0.0,))
    gained = np.subtract(there.accelerations(*at), pole.mechanics.accelerations(*at))
    matrix = [[1.3, 0.15 * np.cos(0.4)], [0.15 * np.cos(0.4), 0.075]]
    assert matrix @ gained == pytest.approx([0.0, force], abs=1e-12)
