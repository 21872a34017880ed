"""Random machines in the plane: one to four bodies, one to four contacts that push, hold or have loads, under set-valued laws."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

import stickslip as ss
from stickslip.maths import cos, pi, sin, where


@dataclass(frozen=True, eq=False)
class Planar(ss.Machine):
    """What all of them have: forces of one frequency, or none."""

    friction: Any
    restitution: float
    push: float
    omega: float
    slope: float
    wave: float
    curved: bool

    @property
    def period(self) -> Any:
        """That of the forces [s]."""
        return 2 * pi / self.omega

    def foot(self, body: str, at: Any = None, law: Any = None) -> Any:
        """A point that pushes on the ground."""
        law = self.friction if law is None else law
        return ss.Contact(body, law, on=self.ground() if self.curved else None, at=at, hold="push", restitution=self.restitution)

    def ground(self) -> Any:
        """A slope with waves."""
        return lambda x: self.slope * x + self.wave * (1.0 - cos(5.0 * x))

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
class Leg(Planar):
    """A hip with a motor on one leg, whose joint rubs, on ground that pushes or on a rail."""

    load: float
    held: bool
    coordinates = ("x", "z", "angle")

    def bodies(self) -> dict[str, Any]:
        """Hip and leg."""
        return {"hip": ss.Body(0.5, force=self.shaken()), "leg": ss.Body(0.4, inertia=0.4 * 0.3**2 / 12)}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """The leg hangs from the hip."""
        leg = q["x"] + 0.15 * sin(q["angle"]), q["z"] - 0.15 * cos(q["angle"]), q["angle"]
        return {"hip": (q["x"], q["z"]), "leg": leg}

    def forces(self, t: Any, q: Any, u: Any) -> dict[str, Any]:
        """A motor with a spring, and one that holds the hip over its start."""
        return {"angle": 0.3 * sin(self.omega * t) - 2.0 * q["angle"], "x": -3.0 * q["x"]}

    def contacts(self) -> dict[str, Any]:
        """Joint and foot."""
        at = (0.0, -0.15)
        foot = ss.Contact("leg", self.friction, at=at, hold="both") if self.held else self.foot("leg", at)
        return {"joint": ss.Contact("angle", ss.CoulombViscous(1.0, 0.8, viscous=0.01), load=self.load), "foot": foot}


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
    """A cart on a rail with two pendulums, whose first hinge rubs or does not."""

    length: float
    second: float
    hinge: float
    hinged: bool
    coordinates = ("x", "first", "other")

    def bodies(self) -> dict[str, Any]:
        """Cart and bobs."""
        return {"cart": ss.Body(1.0, force=self.shaken()), "first": ss.Body(0.5), "other": ss.Body(self.second)}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """The second pendulum hangs from the first."""
        x, z = q["x"] + self.length * sin(q["first"]), -self.length * cos(q["first"])
        return {"cart": (q["x"], 0.0), "first": (x, z), "other": (x + 0.4 * sin(q["other"]), z - 0.4 * cos(q["other"]))}

    def contacts(self) -> dict[str, Any]:
        """The rail, and a hinge."""
        hinge = {"hinge": ss.Contact("first", ss.CoulombViscous(1.0, 1.0, viscous=0.02), load=self.hinge)} if self.hinged else {}
        return {"rail": ss.Contact("cart", self.friction, hold="both"), **hinge}


@dataclass(frozen=True, eq=False)
class Rod(Planar):
    """A rod that slides on its foot, which may leave the ground or not."""

    half: float
    held: bool
    coordinates = ("x", "z", "angle")

    def bodies(self) -> dict[str, Any]:
        """The rod, of one kilogram."""
        return {"rod": ss.Body(1.0, inertia=self.half**2 / 3, force=self.shaken())}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """Its middle, from its foot."""
        return {"rod": (q["x"] + self.half * cos(q["angle"]), q["z"] + self.half * sin(q["angle"]), q["angle"])}

    def contacts(self) -> dict[str, Any]:
        """Its foot."""
        at = (-self.half, 0.0)
        return {"foot": ss.Contact("rod", self.friction, at=at, hold="both") if self.held else self.foot("rod", at)}


@dataclass(frozen=True, eq=False)
class Wedge(Planar):
    """A block on a wedge that a spring holds."""

    stiffness: float
    second: float
    tilt: float
    coordinates = ("x", "down")

    def bodies(self) -> dict[str, Any]:
        """Wedge and block."""
        return {"wedge": ss.Body(1.0, force=self.shaken()), "block": ss.Body(self.second)}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """The block goes down the face of the wedge."""
        return {"wedge": (q["x"], 0.0), "block": (q["x"] + q["down"] * cos(self.tilt), -q["down"] * sin(self.tilt))}

    def forces(self, t: Any, q: Any, u: Any) -> dict[str, Any]:
        """Springs at both."""
        return {"x": -self.stiffness * q["x"], "down": -self.stiffness * q["down"]}

    def contacts(self) -> dict[str, Any]:
        """Its face."""
        return {"face": ss.Contact("block", self.friction, on="wedge", hold="both")}


@dataclass(frozen=True, eq=False)
class Arm(Planar):
    """Up to four links that hang from one another, with friction in their joints, some under loads that their torques make."""

    loads: tuple[float, ...]
    by_torque: float
    coordinates = ("1", "2", "3", "4")

    @property
    def lengths(self) -> tuple[float, ...]:
        """Those of the links [m]."""
        return (0.5, 0.4, 0.3, 0.2)

    def bodies(self) -> dict[str, Any]:
        """Links of one kilogram for each metre."""
        return {f"link {n}": ss.Body(r, inertia=r**3 / 12) for n, r in zip(self.coordinates, self.lengths, strict=False)}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """Each hangs from the one before it."""
        x, z, places = 0.0, 0.0, {}
        for n, r in zip(self.coordinates, self.lengths, strict=False):
            half_x, half_z = 0.5 * r * sin(q[n]), -0.5 * r * cos(q[n])
            places[f"link {n}"] = (x + half_x, z + half_z, q[n])
            x, z = x + 2 * half_x, z + 2 * half_z
        return places

    def torque(self, t: Any) -> Any:
        """What drives the first joint."""
        return self.push * sin(self.omega * t)

    def forces(self, t: Any, q: Any, u: Any) -> dict[str, Any]:
        """A motor."""
        return {"1": self.torque(t)}

    def contacts(self) -> dict[str, Any]:
        """Its joints: the first against the ground, each other one against the link before it."""
        names, joints = self.coordinates, {}
        for n, (name, load) in enumerate(zip(names, self.loads, strict=False)):
            of = lambda t, q, load=load, name=name: load + self.by_torque * abs(self.torque(t)) + 0.2 * load * cos(q[name])  # noqa: E731
            row = {name: 1.0, **({names[n - 1]: -1.0} if n else {})}
            joints[f"joint {name}"] = ss.Contact(row, self.friction, load=of)
        return joints


class Arm1(Arm):
    """One link."""

    coordinates = ("1",)


class Arm2(Arm):
    """Two links."""

    coordinates = ("1", "2")


class Arm3(Arm):
    """Three links."""

    coordinates = ("1", "2", "3")


@dataclass(frozen=True, eq=False)
class Weakening:
    """Friction that falls with speed by a law of its own, static above kinetic."""

    mu: float
    back: float
    static: float

    def sliding(self, v: Any, load: Any) -> Any:
        """By a quotient."""
        return where(v > 0.0, self.mu, -self.back) * (1.0 + 0.4 / (1.0 + 30.0 * abs(v))) * load

    def breakaway(self, load: Any) -> tuple[Any, Any]:
        """Above that of the slowest slip."""
        return -1.4 * self.static * self.back * load, 1.4 * self.static * self.mu * load


@dataclass(frozen=True)
class Form:
    """The laws under which a form is drawn, its weight, and the largest kinetic coefficient."""

    laws: tuple[str, ...]
    weight: float
    most: float = 0.7


FORMS = {
    "box": Form(("even", "uneven", "stribeck"), 9.81, 1.2),
    "crawler": Form(("uneven", "table"), 9.81),
    "walker": Form(("static", "weakening"), 9.81 * 1.3),
    "hopper": Form(("stribeck", "table"), 15.0),
    "cart": Form(("weakening", "stribeck"), 15.0),
    "rod": Form(("uneven", "static"), 9.81, 1.1),
    "wedge": Form(("table", "static"), 15.0, 0.6),
    "leg": Form(("stribeck", "even", "uneven"), 9.0),
    "arm": Form(("viscous", "sum", "static"), 2.0),
}


def law_drawn(rng: Any, kind: str, most: float) -> Any:
    """A law that may rest exactly, with kinetic coefficients up to the largest."""
    a, b = rng.uniform(0.02, most, 2)
    s, v_s = rng.uniform(1.0, 1.6, 2), rng.uniform(0.02, 0.5)
    if kind == "table":
        fall = np.array([1.5, 1.2, 1.0, 1.1])
        return ss.friction.Tabulated((0.0, v_s, 3 * v_s, 10 * v_s), tuple(a * fall), tuple(b * fall), 1.5 * s[0] * a, 1.5 * s[1] * b)
    return {
        "even": lambda: ss.Coulomb(a, a),
        "uneven": lambda: ss.Coulomb(a, b),
        "static": lambda: ss.Coulomb(a, b, a * s[0], b * s[1]),
        "stribeck": lambda: ss.Stribeck(a, b, a * s[0], b * s[1], v_s=v_s, exponent=2.0),
        "weakening": lambda: Weakening(a / 1.4, b / 1.4, s[0]),
        "viscous": lambda: ss.CoulombViscous(a, b, a * s[0], b * s[1], viscous=rng.uniform(0.0, 0.3)),
        "sum": lambda: ss.Stribeck(a, b, a * s[0], b * s[1], v_s=v_s) + ss.Viscous(0.1, 0.2),
    }[kind]()


def drawn(form: str, seed: int) -> tuple[Any, dict[str, Any], int]:
    """A machine of a form, a start, and how many periods it runs."""
    of_form = FORMS[form]
    rng = np.random.default_rng([seed, list(FORMS).index(form), 3])
    law = law_drawn(rng, str(rng.choice(of_form.laws)), of_form.most)
    e = float(rng.choice([0.0, rng.uniform(0.0, 0.8)]))
    push, omega = rng.uniform(0.0, 1.2) * of_form.weight, rng.uniform(8.0, 40.0)
    held = form in ("rod", "leg") and bool(rng.random() < 0.4)
    curved = form in ("crawler", "walker", "hopper") and bool(rng.random() < 0.4)
    ground = (rng.uniform(-0.3, 0.3), float(rng.choice([0.0, rng.uniform(0.0, 0.02)])), curved) if curved else (0.0, 0.0, False)
    of = (law, e, push, omega, *ground)
    speed = float(rng.normal() * rng.choice([0.0, 1.0]))
    if form == "box":
        half, tall = rng.uniform(0.05, 0.4, 2)
        tilt = float(rng.choice([0.0, rng.uniform(-1.0, 1.0)]))
        low = -min(side * half * np.sin(tilt) - tall * np.cos(tilt) for side in (1, -1)) - tall
        return Box(*of, half, tall), {"x": {"angle": tilt, "z": low + rng.uniform(0.0, 0.2)}, "v": {"x": speed}}, 3
    if form == "crawler":
        machine = Crawler(*of, rng.uniform(20, 300), rng.uniform(0.3, 2.0))
        rear, front = (float(machine.ground()(x)) if curved else 0.0 for x in (0.0, 0.5))
        x = {"rear z": rear + (0.05 if curved else 0.0), "front z": front + (0.1 if curved else rng.choice([0.0, 0.1]))}
        return machine, {"x": x, "v": {"rear x": rng.normal(), "front x": rng.normal()}}, 4
    if form == "walker":
        rear, front = rng.uniform(-0.7, -0.1), rng.uniform(0.1, 0.7)
        high = 0.3 * max(np.cos(rear), np.cos(front)) + rng.uniform(0.0, 0.1) + 0.15 * curved
        start = {"x": {"rear": rear, "front": front, "z": high}, "v": {"x": speed}}
        return Walker(*of, rng.uniform(0.2, 5.0), rng.uniform(0.3, 2.0)), start, 2
    if form == "hopper":
        machine = Hopper(*of, rng.uniform(50, 500), rng.uniform(0.2, 1.0))
        return machine, {"x": {"stretch": rng.uniform(-0.4, 0.2), "z": 0.05 * curved}, "v": {"x": 0.0 if curved else speed}}, 4
    if form == "rod":
        high = 0.0 if held else float(rng.choice([0.0, rng.uniform(0.0, 0.3)]))
        start = {"x": {"z": high, "angle": rng.uniform(0.6, 2.5)}, "v": {"x": speed, "angle": rng.normal() * (high > 0)}}
        return Rod(*of, rng.uniform(0.2, 1.0), held), start, 1
    if form == "wedge":
        machine = Wedge(*of, rng.uniform(50, 500), rng.uniform(0.2, 1.0), rng.uniform(0.1, 1.0))
        return machine, {"x": {"down": rng.uniform(-0.1, 0.1)}, "v": {"down": speed}}, 6
    if form == "arm":
        count = int(rng.integers(1, 5))
        loads, torque = tuple(rng.uniform(0.1, 1.5, count)), float(rng.choice([0.0, rng.uniform(0.0, 0.5)]))
        machine = (Arm1, Arm2, Arm3, Arm)[count - 1](*of, loads, torque)
        x, v = ({name: rng.normal() * size for name in machine.coordinates} for size in (0.7, 0.5))
        return machine, {"x": x, "v": v}, 4
    if form == "leg":
        high = 0.3 * np.cos(0.4) if held else float(0.3 * np.cos(0.4) + rng.choice([0.0, 0.1]))
        machine = Leg(*of, rng.uniform(0.05, 0.4), held)
        return machine, {"x": {"z": high, "angle": 0.4}, "v": {"x": speed}}, 3
    machine = Cart(*of, rng.uniform(0.3, 1.0), rng.uniform(0.2, 1.0), rng.uniform(0.02, 0.5), bool(rng.random() < 0.5))
    return machine, {"x": {"first": rng.uniform(-1, 1), "other": rng.uniform(-1, 1)}, "v": {"x": speed}}, 2
