"""A rod that slides on one foot: Painlevé's example."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import cos, sin, sqrt
from stickslip.basics.quantities import GRAVITY, MASS, positive, quantity
from stickslip.models.machines.in_the_plane import PUSH, PUSHED_AT, InThePlane
from stickslip.models.machines.parts import Body, Contact


@dataclass(frozen=True, eq=False)
class SlidingRod(InThePlane):
    r"""A uniform rod whose foot slides along a rail, with friction: beyond some angles no load follows from its motion.

    .. math:: m\ddot x_c = F\sin\omega t - R(\dot x, N), \qquad m\ddot z_c = N - m g, \qquad
              \tfrac{1}{12} m L^2\ddot\varphi = -\tfrac12 L\,(N\cos\varphi - (F\sin\omega t - R)\sin\varphi)

    with the place :math:`x_c = x + \tfrac12 L\cos\varphi`, :math:`z_c = \tfrac12 L\sin\varphi` of its middle. Coordinates are x of the
    foot and the angle above the rail: at 0 the rod lies forwards, at :math:`\pi/2` it stands. A push acts on the foot. From

    .. math:: \mu = 4/3 \text{ on}, \quad\text{while } \tfrac12\bigl(3\mu - \sqrt{9\mu^2 - 16}\bigr) < |\tan\varphi| <
              \tfrac12\bigl(3\mu + \sqrt{9\mu^2 - 16}\bigr),

    sliding has no load or two (Painlevé's paradox), and a run that comes there ends with that status: `borders`.

    Parameters
    ----------
    mass : float
        Mass m [kg].
    length : float
        Length L [m].
    friction : Coulomb or any law that rests exactly and is proportional to the load
        Friction law of the foot, which a rail holds on both sides.
    push, omega : float
        Amplitude F and angular frequency of the force on the foot [N], [rad/s].
    gravity : float
        Acceleration of gravity [m/s^2].

    References
    ----------
    P. Painlevé, Sur les lois du frottement de glissement, C. R. Acad. Sci. Paris 121 (1895) 112-115.
    F. Génot and B. Brogliato, New results on Painlevé paradoxes, Eur. J. Mech. A/Solids 18 (1999) 653-677.

    Examples
    --------
    >>> import stickslip as ss
    >>> rod = SlidingRod(mass=1.0, length=1.0, friction=ss.Coulomb(1.5, 1.5))
    >>> run = ss.solve(rod, duration=0.5, start={"x": {"angle": 1.5}, "v": {"x": 3.0, "angle": -1.0}})
    >>> print(run.status)
    friction presses back on its contact so strongly that no load, or more than one, follows from the motion (Painlevé)
    >>> bool(abs(run.coordinates["angle"][-1] - rod.borders(1.5)[1]) < 1e-9)
    True
    """

    mass: float = field(metadata=MASS)
    length: float = field(metadata=quantity("length of the rod", "m", "L", example=1.0, rule=positive))
    friction: Any
    push: float = field(default=0.0, metadata=PUSH)
    omega: float = field(default=5.0, metadata=PUSHED_AT)
    gravity: float = field(default=9.81, metadata=GRAVITY)

    kind: ClassVar[str] = "sliding_rod"  # its name in a study file
    coordinates: ClassVar[tuple[str, ...]] = ("x", "angle")

    @property
    def velocity_scale(self) -> Any:
        """What its tip has when it falls from upright [m/s]."""
        return sqrt(3 * self.gravity * self.length)

    @staticmethod
    def borders(mu: float) -> tuple[float, float]:
        """The two angles between which sliding under a friction coefficient of 4/3 or more is inconsistent [rad].

        Raises
        ------
        ValueError
            For a smaller coefficient, under which the rod slides at any angle.
        """
        from math import atan, sqrt

        if not mu >= 4 / 3:
            raise ValueError(f"mu = {mu!r}: from 4/3 on sliding is inconsistent at some angles, and below it at none; type mu=1.5")
        root = sqrt(max(9 * mu**2 - 16, 0.0))
        return atan(0.5 * (3 * mu - root)), atan(0.5 * (3 * mu + root))

    def bodies(self) -> Mapping[str, Any]:
        """The rod."""
        return {"rod": Body(self.mass, inertia=self.mass * self.length**2 / 12)}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """Its middle, and its angle."""
        half = 0.5 * self.length
        return {"rod": (q["x"] + half * cos(q["angle"]), half * sin(q["angle"]), q["angle"])}

    def outlines(self, t: Any, q: Any) -> list[Any]:
        """From its foot to its other end."""
        return [((q["x"], 0.0), (q["x"] + self.length * cos(q["angle"]), self.length * sin(q["angle"])))]

    def forces(self, t: Numeric, q: Any, u: Any) -> dict[str, Any]:
        """The push on its foot."""
        return {"x": self.push * sin(self.omega * t)}

    def contacts(self) -> Mapping[str, Any]:
        """Its foot."""
        return {"foot": Contact("rod", self.friction, at=(-0.5 * self.length, 0.0), hold="both")}
