"""Springs, dampers and elastic stops between points and angles of bodies in the plane."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.errors import InputError
from stickslip.maths import cos, pi, sin

START = {"x": {"elbow": 0.4}}


@dataclass(frozen=True, eq=False)
class TiedArm(ss.Machine):
    """Two links with friction in both joints, tied to a wall, to a bead on a rod, to a point that is moved, and to each other."""

    friction: Any
    stiffness: float = 40.0
    height: float = 0.2
    omega: float = 3.0
    coordinates = ("shoulder", "elbow", "y")

    @property
    def period(self):
        return 2 * pi / self.omega

    def bodies(self):
        arms = {"upper": ss.Body(1.2, inertia=0.03), "lower": ss.Body(0.8, inertia=0.02)}
        return {**arms, "bead": ss.Body(0.3), "slide": ss.Body(0.2)}

    def places(self, t, q):
        a, b = q["shoulder"], q["shoulder"] + q["elbow"]
        x, z = 0.5 * sin(a), -0.5 * cos(a)
        arms = {"upper": (0.5 * x, 0.5 * z, a), "lower": (x + 0.2 * sin(b), z - 0.2 * cos(b), b)}
        return {**arms, "bead": (0.4, q["y"]), "slide": q["y"]}

    def forces(self, t, q, u):
        return {"shoulder": 6 * sin(self.omega * t)}

    def links(self):
        P, Angle = ss.Point, ss.machines.Angle
        return {
            (P("upper", at=(0.1, 0.05)), P(None, at=(0.6, self.height))): ss.Spring(self.stiffness, 0.3, 0.2),
            (P("lower", at=(0.0, -0.2)), "bead"): (ss.Spring(30.0, 0.1, 0.1), ss.Spring(1.0)),
            (P("bead"), P(None, at=lambda t: (0.4 + 0.05 * sin(2 * self.omega * t), 0.7))): ss.Spring(20.0, length=0.3),
            (Angle("lower"), None): ss.Spring(0.5, 0.01, 0.1),
            (Angle("upper"), Angle("lower")): ss.machines.Link(
                force=lambda t, turn, rate: 0.8 * turn + 0.02 * rate + 0.1 * sin(self.omega * t)
            ),
            ("slide", None): ss.Spring(9.0),
            ("elbow", None): ss.Spring(1.0),
        }

    def stops(self):
        return {(ss.Point("lower"), ss.Point(None, at=(0.1, -1.1))): ss.Stop(gap=0.35, stiffness=500.0, side=-1)}

    def contacts(self):
        return {name: ss.Contact(name, self.friction, load=load) for name, load in (("shoulder", 8.0), ("elbow", 4.0))}


ARM = TiedArm(ss.Coulomb(0.1, 0.1))


@pytest.fixture(scope="module")
def run():
    return ss.solve(ARM, periods=3, start=START)


def test_links_pull_as_their_energies_by_hand_say():
    """The generalized force of springs is what their energy loses along each coordinate: differences of step 1e-6, error 1e-10."""

    def energy(a, e, y):
        b, x, z = a + e, 0.5 * np.sin(a), -0.5 * np.cos(a)
        upper = 0.5 * x + 0.1 * np.cos(a) - 0.05 * np.sin(a), 0.5 * z + 0.1 * np.sin(a) + 0.05 * np.cos(a)
        tip = x + 0.4 * np.sin(b), z - 0.4 * np.cos(b)
        wall, bead = np.hypot(upper[0] - 0.6, upper[1] - 0.2), np.hypot(tip[0] - 0.4, tip[1] - y)
        turned = 0.25 * (b - 0.1) ** 2 + 0.4 * e**2 + 0.5 * e**2
        return 20.0 * (wall - 0.2) ** 2 + 15.0 * (bead - 0.1) ** 2 + 0.5 * bead**2 + 10.0 * (abs(0.7 - y) - 0.3) ** 2 + 4.5 * y**2 + turned

    q, h = np.array([0.3, -0.4, 0.2]), 1e-6
    tied, bare = ARM.mechanics, type("Bare", (TiedArm,), {"links": lambda self: {}})(ARM.friction).mechanics
    gained = np.subtract(*(of.applied(0.0, tuple(q), (0.0,) * 3) for of in (tied, bare)))
    by_hand = [-(energy(*(q + h * e)) - energy(*(q - h * e))) / (2 * h) for e in np.eye(3)]
    assert np.allclose(gained, by_hand, rtol=0, atol=1e-8)


def test_an_arm_that_is_tied_is_that_of_the_judge(run):
    """The same events at the same instants to 1e-10: the judge derives distances and what they pull by itself."""
    judge = ss.solve(ARM, duration=0.85 * ARM.period, start=START, method="dop853", rtol=1e-12)
    events = [event for event in run.events if event.t < judge.t[-1]]
    assert run.method == "exact" and len(events) == len(judge.events) > 6
    assert max(abs(a.t - b.t) for a, b in zip(events, judge.events, strict=True)) < 1e-10
    assert np.allclose(run.at(judge.t[-1])["x"], judge.x[-1], rtol=0, atol=1e-10)


def test_energy_and_mirror_image_know_links_of_points(run):
    other = ss.solve(ss.mirrored(ARM), periods=3, start={"x": {"elbow": -0.4}})
    assert np.allclose(-run.x[-1], other.x[-1], rtol=0, atol=1e-12)
    assert np.max(abs(ss.energy(run).residual)) < 1e-13


@dataclass(frozen=True, eq=False)
class Hung(ss.Machine):
    """A cart on a rail that a spring on a point above pulls up or down."""

    friction: Any
    coordinates = ("x",)

    def bodies(self):
        return {"cart": ss.Body(2.0)}

    def places(self, t, q):
        return {"cart": (q["x"], 0.0)}

    def links(self):
        return {("cart", ss.Point(None, at=(0.0, 0.3))): ss.Spring(100.0, length=0.2)}

    def contacts(self):
        return {"rail": ss.Contact("cart", self.friction, hold="both")}


def test_a_spring_presses_on_a_rail_or_lifts_from_it():
    """N = |m g - k (d - l) 0.3/d| at every instant; and the run of the judge."""
    hung, start = Hung(ss.Coulomb(0.05, 0.05)), {"x": {"x": 0.4}}
    run, judge = (ss.solve(hung, duration=1.0, start=start, **given) for given in ({}, {"method": "dop853", "rtol": 1e-12}))
    assert np.allclose(run.x[-1], judge.x[-1], rtol=0, atol=1e-10) and len(run.events) == len(judge.events)
    d = np.hypot(run.x[1:, 0], 0.3)
    assert np.allclose(run.load[1:, 0], abs(2.0 * 9.81 - 100.0 * (d - 0.2) * 0.3 / d), rtol=1e-12)


def tied(ends, part=None):
    return {"links": lambda self: {ends: ss.Spring(1.0) if part is None else part}}


@each_row(
    "changed, words",
    [
        (tied(("bob", None)), "'bob' is not a coordinate and not a body, which links join"),
        (tied((ss.Point("bob"), None)), "'bob' is not a body"),
        (tied((ss.Point("upper", at=0.1), ss.Point(None))), "at = 0.1; allowed is (x, z)"),
        (tied(("upper", None)), "type ss.Point(None, at=(0.0, 0.0))"),
        (tied(("elbow", "upper")), "joins a coordinate and a point"),
        (tied((ss.machines.Angle("bead"), None)), "places() gives 'bead' no angle"),
        (tied(("upper", ss.Point(None, at=(0.0, -0.25)))), "its ends coincide where all coordinates are zero"),
        (tied((None, "elbow")), "the first of which is not the ground"),
        (tied(("upper", "lower"), ss.machines.Rigid()), "a distance that is kept belongs into places(t, q)"),
        ({"stops": lambda self: {("elbow", None): ss.Stop(gap=0.1, restitution=0.5)}}, "stops with restitution are not there yet"),
    ],
)  # fmt: skip
def test_links_that_join_nothing_are_refused_with_what_to_type(changed, words):
    with pytest.raises(InputError, match=re.escape(words)):
        type("Other", (TiedArm,), changed)(ARM.friction)
