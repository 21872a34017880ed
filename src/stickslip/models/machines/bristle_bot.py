"""A robot on tilted bristles that bend, which an unbalanced rotor shakes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import cos, pi, sin, sqrt
from stickslip.basics.quantities import GRAVITY, MASS, Rule, at_least, positive, quantity
from stickslip.models.friction import LAWS
from stickslip.models.friction.law import Law
from stickslip.models.machines.in_the_plane import InThePlane
from stickslip.models.machines.parts import Body, Contact, Spring

_LEANS = Rule(lambda angle: (angle > 0) & (angle < pi / 2), "an angle above 0 and below pi/2 [rad]")
_TIP = 1e-9  # mass of the tips, which the model says is none, as a part of that of the body


@dataclass(frozen=True, eq=False)
class Lubricated(Law):
    """Friction that is proportional to the load and to the velocity, R = mu N v: the law of Cicconofri and DeSimone's bristle-bot.

    Parameters
    ----------
    mu : float
        Friction force for each newton of load and each m/s [s/m].

    Examples
    --------
    >>> Lubricated(2.0).sliding(v=0.5, load=3.0)
    3.0
    """

    mu: float = field(metadata=quantity("lubricated friction for each newton", "s/m", r"\mu_{v}", example=1.0, rule=at_least(0.0)))

    def sliding(self, v: Numeric, load: Numeric) -> Any:
        """The friction force [N]."""
        return self.mu * v * load

    def breakaway(self, load: Numeric) -> tuple[Any, Any]:
        """Nothing is held at rest [N]."""
        return 0.0 * load, 0.0 * load


@dataclass(frozen=True, eq=False)
class BristleBot(InThePlane):
    r"""A body on tilted bristles that bend, with an unbalanced rotor: it goes by the friction that the rotor's beat modulates.

    .. math:: m\ddot x = a\,U\omega^2\cos\omega t - R(w, N), \qquad
              N = m g + m\ddot z - U\omega^2\sin\omega t, \quad z = L\cos\varphi, \quad w = \dot x - L\dot\varphi\cos\varphi

    Bristles have no mass, and a torsion spring and a damper at the body, k and c; their tips trail behind and stay on the ground. The angle
    of the bristles from the vertical, :math:`\varphi`, is `tilt` where the robot stands. Coordinates are x of the body and `bend`,
    :math:`\varphi` less `tilt`. While the rotor's force is small beside the weight, and acts up and down alone (a = 0), the mean velocity
    is `expanded`.

    Parameters
    ----------
    mass : float
        Mass m, with the rotor [kg].
    length : float
        Length L of the bristles [m].
    tilt : float
        Angle of the bristles from the vertical while the robot stands [rad]; relaxed they are at `relaxed`.
    stiffness, damping : float
        k and c of all bristles together [N m/rad], [N m s/rad].
    unbalance : float
        U, mass of the rotor times the distance of its centre of mass from its axis [kg m].
    omega : float
        Angular frequency of the rotor [rad/s].
    friction : Lubricated, Coulomb or any law that rests exactly and is proportional to the load
        Friction law of the tips.
    along : float
        a, the part of the rotor's force that acts along the track too: 0 is the vertical beat of the published model, which two
        rotors make that turn against each other, 1 one rotor, -1 one that turns the other way.
    gravity : float
        Acceleration of gravity [m/s^2].

    References
    ----------
    G. Cicconofri and A. DeSimone, Motility of a model bristle-bot: a theoretical analysis, Int. J. Non-Linear Mech. 76 (2015) 233-239,
    arXiv:1410.8153.
    A. DeSimone and A. Tatone, Crawling motility through the analysis of model locomotors: two case studies, Eur. Phys. J. E 35 (2012) 85.

    Examples
    --------
    >>> import stickslip as ss
    >>> bot = BristleBot(0.02, 0.01, 0.45, 0.015, 2e-5, 5e-7, 100.0, ss.machines.Lubricated(1.0))
    >>> orbit = ss.periodic_orbit(bot)
    >>> print(f"{orbit.mean_velocity * 1e6:.3f} um/s by the orbit, {bot.expanded * 1e6:.3f} um/s by the expansion")
    5.714 um/s by the orbit, 5.713 um/s by the expansion
    """

    mass: float = field(metadata=MASS)
    length: float = field(metadata=quantity("length of the bristles", "m", "L", example=0.01, rule=positive, shown="mm"))
    tilt: float = field(metadata=quantity("tilt of the bristles", "rad", r"\alpha", example=0.4, rule=_LEANS, shown="°"))
    stiffness: float = field(metadata=quantity("stiffness of the bristles", "N m/rad", "k", example=0.015, rule=positive))
    damping: float = field(metadata=quantity("damping of the bristles", "N m s/rad", "c", example=2e-5, rule=at_least(0.0)))
    unbalance: float = field(metadata=quantity("unbalance", "kg m", "U", example=5e-7, rule=at_least(0.0)))
    omega: float = field(metadata=quantity("angular frequency", "rad/s", r"\omega", example=100.0, rule=positive))
    friction: Any
    along: float = field(default=0.0, metadata=quantity("part of the rotor's force along the track", "1", "a", example=0.0))
    gravity: float = field(default=9.81, metadata=GRAVITY)

    kind: ClassVar[str] = "bristle_bot"  # its name in a study file
    coordinates: ClassVar[tuple[str, ...]] = ("x", "bend")
    part_kinds: ClassVar[dict[str, Any]] = {"friction": {**LAWS, "lubricated": Lubricated}}

    @property
    def force(self) -> Any:
        """Force of the rotor [N]."""
        return self.unbalance * self.omega**2

    @property
    def relaxed(self) -> Any:
        """Angle of the bristles from the vertical without a load [rad]."""
        return self.tilt - self.mass * self.gravity * self.length * sin(self.tilt) / self.stiffness

    @property
    def expanded(self) -> Any:
        """Its mean velocity under lubricated friction to second order in a vertical force of the rotor [m/s]."""
        pressed, yields, arm = self._softened
        rise, w, inertia = self.length * sin(self.tilt), self.omega, self.mass * self.omega
        slip = arm * w * inertia / (1j * inertia + pressed)  # of the tip, for an angle of 1
        swing = self.force * rise / (yields + 1j * w * self.damping - inertia * w * rise**2 - pressed * arm * slip)
        lost = 2 * self.mass * self.gravity * sin(self.tilt) * (inertia**2 + pressed**2)
        drives = w * inertia * (self.damping + pressed * arm**2) - yields * pressed
        return abs(swing) ** 2 * w * inertia * cos(self.tilt) / lost * drives

    @property
    def reversal(self) -> Any:
        """The angular frequency at which `expanded` changes its sign: the robot goes backwards below it, forwards above [rad/s]."""
        pressed, yields, arm = self._softened
        return sqrt(yields * pressed / (self.mass * (self.damping + pressed * arm**2)))

    @property
    def _softened(self) -> tuple[Any, Any, Any]:
        """Friction of a standing robot for each m/s, the stiffness that its weight leaves, and the height of the body."""
        weight, arm = self.mass * self.gravity, self.length * cos(self.tilt)
        return self._mu * weight, self.stiffness - weight * arm, arm

    @property
    def _mu(self) -> Any:
        """That of lubricated friction."""
        if not isinstance(self.friction, Lubricated):
            raise ValueError(
                f"the expansion is for lubricated friction, and friction is {type(self.friction).__name__}; "
                "type friction=ss.machines.Lubricated(1.0), or take ss.periodic_orbit(robot).mean_velocity"
            )
        return self.friction.mu

    def bodies(self) -> Mapping[str, Any]:
        """The body, with the force of its rotor, and the tips of the bristles."""
        size, w, along = self.force, self.omega, self.along

        def shaken(t: Numeric, x: Any, v: Any) -> Any:
            return (along * size * cos(w * t), size * sin(w * t))

        return {"body": Body(self.mass, force=shaken), "tip": Body(_TIP * self.mass)}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """The body above its bristles, and their tips."""
        angle = self.tilt + q["bend"]
        return {"body": (q["x"], self.length * cos(angle)), "tip": (q["x"] - self.length * sin(angle), 0.0)}

    def outlines(self, t: Any, q: Any) -> list[Any]:
        """A bristle, from its tip to the body."""
        places = self.places(t, q)
        return [(places["tip"], places["body"])]

    def links(self) -> Mapping[Any, Any]:
        """The springs of the bristles."""
        return {("bend", None): Spring(self.stiffness, self.damping, length=self.relaxed - self.tilt)}

    def contacts(self) -> Mapping[str, Any]:
        """The tips on the ground."""
        return {"tip": Contact("tip", self.friction, hold="both")}
