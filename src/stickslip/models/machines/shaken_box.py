"""A box on the ground that an unbalanced rotor shakes: it slides, hops and lands on one foot, or tips and rocks on two."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.maths import cos, sin
from stickslip.basics.quantities import GRAVITY, MASS, Rule, at_least, positive, quantity
from stickslip.models.machines.in_the_plane import InThePlane
from stickslip.models.machines.parts import Body, Contact

_BELOW_ONE = Rule(lambda e: (e >= 0) & (e < 1), "from 0 to below 1")
RESTITUTION = quantity("restitution", "1", "e", example=0.3, rule=_BELOW_ONE, range=(0.0, 0.95))


@dataclass(frozen=True, eq=False)
class ShakenBox(InThePlane):
    r"""A box on the ground with an unbalanced rotor in it, which slides, hops and lands.

    .. math:: m\ddot x = U\omega^2\cos\omega t - \sum R_i, \qquad m\ddot z = U\omega^2\sin\omega t - m g + \sum N_i

    Without a `width` it has one foot and does not turn. With a width and a height it is a block of that size, on the corners of its base:
    it tips and rocks too, with the angle as a third coordinate, and the rotor's force acts at its middle. Coordinates are x, the height z
    of its base in the middle, and the angle, all zero where it stands.

    Parameters
    ----------
    mass : float
        Mass m, with the rotor [kg].
    unbalance : float
        U, mass of the rotor times the distance of its centre of mass from its axis [kg m]; zero for a box that nothing shakes.
    omega : float
        Angular frequency of the rotor [rad/s].
    friction : Coulomb or any law that rests exactly
        Friction law of the feet; proportional to the load, with static friction as large as kinetic.
    restitution : float
        Newton's coefficient of restitution of a landing, 0 <= restitution < 1 [-].
    width, height : float, optional
        Size of a block on two feet [m]; both or none.
    gravity : float
        Acceleration of gravity [m/s^2].

    Examples
    --------
    Housner's block of 0.2 m by 1 m, let go from 0.1 rad: each hit leaves it 1 - 3/2 sin^2 of its rate, by the angle of its diagonal.

    >>> import numpy as np
    >>> import stickslip as ss
    >>> block = ShakenBox(1.0, 0.0, 10.0, ss.Coulomb(1.0, 1.0), width=0.2, height=1.0)
    >>> run = ss.solve(block, duration=1.5, start=block.tilted(0.1))
    >>> first, second = [event for event in run.events if event.kind == "landing"][:2]
    >>> bool(abs(second.velocity / first.velocity - (1 - 1.5 * np.sin(np.arctan(0.2)) ** 2)) < 1e-9)
    True
    """

    mass: float = field(metadata=MASS)
    unbalance: float = field(metadata=quantity("unbalance", "kg m", "U", example=2e-4, rule=at_least(0.0)))
    omega: float = field(metadata=quantity("angular frequency", "rad/s", r"\omega", example=100.0, rule=positive))
    friction: Any
    restitution: float = field(default=0.0, metadata=RESTITUTION)
    width: float | None = field(default=None, metadata=quantity("width", "m", "b", example=0.1, rule=positive))
    height: float | None = field(default=None, metadata=quantity("height", "m", "H", example=0.2, rule=positive))
    gravity: float = field(default=9.81, metadata=GRAVITY)

    kind: ClassVar[str] = "shaken_box"  # its name in a study file

    @property
    def coordinates(self) -> tuple[str, ...]:  # type: ignore[override]
        """x and z, and the angle of a block on two feet."""
        return ("x", "z") if self.width is None else ("x", "z", "angle")

    @property
    def velocity_scale(self) -> Any:
        """What gravity, and the rotor, do in a part of the period [m/s]."""
        return (self.gravity + self.unbalance * self.omega * self.omega / self.mass) / self.omega

    @property
    def inertia_of_box(self) -> Any:
        """Moment of inertia of a homogeneous block about its middle [kg m^2]."""
        return 0.0 if self.width is None or self.height is None else self.mass * (self.width**2 + self.height**2) / 12

    def _check(self, problems: Problems) -> None:
        if (self.width is None) != (self.height is None):
            given = "width" if self.height is None else "height"
            problems.add(f"{given} is given alone; allowed are both, for a block on two feet, or none; type width=0.1, height=0.2")
        super()._check(problems)

    def tilted(self, angle: Any) -> dict[str, Any]:
        """A start at rest in which a block stands on one of its corners: the right one at an angle above zero, leaning forwards [rad].

        Raises
        ------
        ValueError
            For a box on one foot, which does not turn.
        """
        if self.width is None or self.height is None:
            raise ValueError("a box on one foot does not turn; type width=0.1, height=0.2 for a block on two feet")
        half, tall, side, lean = 0.5 * self.width, 0.5 * self.height, 1.0 if angle > 0 else -1.0, abs(angle)
        x = side * (half - half * cos(lean) + tall * sin(lean))
        return {"x": {"x": x, "z": tall * cos(lean) + half * sin(lean) - tall, "angle": -angle}, "v": {}}

    def bodies(self) -> Mapping[str, Any]:
        """The box, with the force of its rotor."""
        size, w = self.unbalance * self.omega * self.omega, self.omega
        turns = () if self.width is None else (0.0,)

        def shaken(t: Numeric, x: Any, v: Any) -> Any:
            return (size * cos(w * t), size * sin(w * t), *turns)

        return {"box": Body(self.mass, inertia=self.inertia_of_box, force=shaken)}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """The middle of the box, and its angle."""
        if self.height is None:
            return {"box": (q["x"], q["z"])}
        return {"box": (q["x"], q["z"] + 0.5 * self.height, q["angle"])}

    def contacts(self) -> Mapping[str, Any]:
        """Its feet."""
        ground: dict[str, Any] = {"hold": "push", "restitution": self.restitution}
        if self.width is None or self.height is None:
            return {"foot": Contact("box", self.friction, **ground)}
        low = -0.5 * self.height
        return {
            "left": Contact("box", self.friction, at=(-0.5 * self.width, low), **ground),
            "right": Contact("box", self.friction, at=(0.5 * self.width, low), **ground),
        }
