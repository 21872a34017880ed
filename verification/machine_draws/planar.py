"""Random machines in the plane: one to four bodies, one or two points that push, or a rail, under laws that may rest exactly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

import stickslip as ss
from stickslip.maths import cos, pi, sin


@dataclass(frozen=True, eq=False)
class Planar(ss.Machine):
    """What all of them have: forces of one frequency, or none."""

    friction: Any
    restitution: float
    push: float
    omega: float

    @property
    def period(self) -> Any:
        """That of the forces [s]."""
        return 2 * pi / self.omega

    def foot(self, body: str, at: Any = None, law: Any = None) -> Any:
        """A point that pushes on the ground."""
        return ss.Contact(body, self.friction if law is None else law, at=at, hold="push", restitution=self.restitution)

    def shaken(self, phase: float = 0.0) -> Any:
        """A force that turns round."""
        return lambda t, x, v: (self.push * sin(self.omega * t + phase), 1.3 * self.push * cos(self.omega * t + phase))


@dataclass(frozen=True, eq=False)
class Box(Planar):
    """A block on the corners of its base."""

    half: float
    tall: float
    coordinates = ("x", "z", "angle")

    def bodies(self) -> dict[str, Any]:
        """The block, of one kilogram."""
        return {"box": ss.Body(1.0, inertia=(self.half**2 + self.tall**2) / 3, force=self.shaken())}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """Its middle, and how it is turned."""
        return {"box": (q["x"], q["z"] + self.tall, q["angle"])}

    def contacts(self) -> dict[str, Any]:
        """Both corners."""
        return {name: self.foot("box", (side * self.half, -self.tall)) for name, side in (("left", -1.0), ("right", 1.0))}


@dataclass(frozen=True, eq=False)
class Crawler(Planar):
    """Two bodies that may hop, joined by a spring that is pulled in turns."""

    stiffness: float
    second: float
    coordinates = ("rear x", "rear z", "front x", "front z")

    def bodies(self) -> dict[str, Any]:
        """Rear and front."""
        return {"rear": ss.Body(1.0, force=self.shaken()), "front": ss.Body(self.second, force=self.shaken(1.0))}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """Each where its coordinates say."""
        return {"rear": (q["rear x"], q["rear z"]), "front": (0.5 + q["front x"], q["front z"])}

    def links(self) -> dict[Any, Any]:
        """A spring."""
        return {("rear", "front"): ss.Spring(self.stiffness, 0.01 * self.stiffness, length=0.5)}

    def contacts(self) -> dict[str, Any]:
        """A foot below each."""
        return {name: self.foot(name) for name in ("rear", "front")}


@dataclass(frozen=True, eq=False)
class Walker(Planar):
    """Two legs at a hip with a torsion spring, each with a point at its end: what one of them bears the other one feels."""

    stiffness: float
    hip: float
    coordinates = ("x", "z", "rear", "front")

    def bodies(self) -> dict[str, Any]:
        """The hip and two legs."""
        leg = ss.Body(0.4, inertia=0.4 * 0.3**2 / 12)
        return {"hip": ss.Body(self.hip, force=self.shaken()), "rear leg": leg, "front leg": leg}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """Legs hang from the hip."""
        legs = {f"{name} leg": (q["x"] + 0.15 * sin(q[name]), q["z"] - 0.15 * cos(q[name]), q[name]) for name in ("rear", "front")}
        return {"hip": (q["x"], q["z"]), **legs}

    def links(self) -> dict[Any, Any]:
        """Legs are held apart."""
        return {("rear", "front"): ss.Spring(self.stiffness, 0.02 * self.stiffness, length=-0.6)}

    def contacts(self) -> dict[str, Any]:
        """The ends of the legs."""
        return {name: self.foot(f"{name} leg", (0.0, -0.15)) for name in ("rear", "front")}


@dataclass(frozen=True, eq=False)
class Hopper(Planar):
    """A box on one foot with a mass on a spring in it."""

    stiffness: float
    second: float
    coordinates = ("x", "z", "stretch")

    def bodies(self) -> dict[str, Any]:
        """Box and mass."""
        return {"box": ss.Body(1.0), "mass": ss.Body(self.second, force=self.shaken())}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """One above the other."""
        return {"box": (q["x"], q["z"]), "mass": (q["x"], q["z"] + 0.3 + q["stretch"])}

    def forces(self, t: Any, q: Any, u: Any) -> dict[str, Any]:
        """The spring."""
        return {"stretch": -self.stiffness * q["stretch"]}

    def contacts(self) -> dict[str, Any]:
        """Its foot."""
        return {"foot": self.foot("box")}


@dataclass(frozen=True, eq=False)
class Cart(Planar):
    """A cart on a rail with two pendulums."""

    length: float
    second: float
    coordinates = ("x", "first", "other")

    def bodies(self) -> dict[str, Any]:
        """Cart and bobs."""
        return {"cart": ss.Body(1.0, force=self.shaken()), "first": ss.Body(0.5), "other": ss.Body(self.second)}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """The second pendulum hangs from the first."""
        x, z = q["x"] + self.length * sin(q["first"]), -self.length * cos(q["first"])
        return {"cart": (q["x"], 0.0), "first": (x, z), "other": (x + 0.4 * sin(q["other"]), z - 0.4 * cos(q["other"]))}

    def contacts(self) -> dict[str, Any]:
        """The rail."""
        return {"rail": ss.Contact("cart", self.friction, hold="both")}


FORMS = ("box", "crawler", "walker", "hopper", "cart")


def drawn(form: str, seed: int) -> tuple[Any, dict[str, Any], int]:
    """A machine of a form, a start, and how many periods it runs."""
    rng = np.random.default_rng([seed, FORMS.index(form)])
    mu = rng.uniform(0.02, 1.2 if form == "box" else 0.7, 2)
    law = ss.Coulomb(*mu) if rng.random() < 0.7 else ss.Coulomb(mu[0], mu[0])
    e = float(rng.choice([0.0, rng.uniform(0.0, 0.8)]))
    weight = {"box": 9.81, "crawler": 9.81, "walker": 9.81 * 1.3, "hopper": 15.0, "cart": 15.0}[form]
    push, omega = rng.uniform(0.0, 1.2) * weight, rng.uniform(8.0, 40.0)
    of = (law, e, push, omega)
    v = {"x": float(rng.normal() * rng.choice([0.0, 1.0]))} if form != "crawler" else {"rear x": rng.normal(), "front x": rng.normal()}
    if form == "box":
        half, tall = rng.uniform(0.05, 0.4, 2)
        tilt = float(rng.choice([0.0, rng.uniform(-1.0, 1.0)]))
        low = -min(side * half * np.sin(tilt) - tall * np.cos(tilt) for side in (1, -1)) - tall
        return Box(*of, half, tall), {"x": {"angle": tilt, "z": low + rng.uniform(0.0, 0.2)}, "v": v}, 3
    if form == "crawler":
        return Crawler(*of, rng.uniform(20, 300), rng.uniform(0.3, 2.0)), {"x": {"front z": rng.choice([0.0, 0.1])}, "v": v}, 4
    if form == "walker":
        rear, front = rng.uniform(-0.7, -0.1), rng.uniform(0.1, 0.7)
        high = 0.3 * max(np.cos(rear), np.cos(front)) + rng.uniform(0.0, 0.1)
        return Walker(*of, rng.uniform(0.2, 5.0), rng.uniform(0.3, 2.0)), {"x": {"rear": rear, "front": front, "z": high}, "v": v}, 2
    if form == "hopper":
        return Hopper(*of, rng.uniform(50, 500), rng.uniform(0.2, 1.0)), {"x": {"stretch": rng.uniform(-0.4, 0.2)}, "v": v}, 4
    return (
        Cart(*of, rng.uniform(0.3, 1.0), rng.uniform(0.2, 1.0)),
        {"x": {"first": rng.uniform(-1, 1), "other": rng.uniform(-1, 1)}, "v": v},
        2,
    )
