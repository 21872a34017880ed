"""A block on a wedge that is free to go back, or shaken on a spring."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from stickslip.basics.maths import cos, pi, sin
from stickslip.basics.quantities import DAMPING, GRAVITY, STIFFNESS, Rule, positive, quantity
from stickslip.models.machines.in_the_plane import PUSH, PUSHED_AT, PushedOnSpring
from stickslip.models.machines.parts import Body, Contact

_STEEP = Rule(lambda slope: (slope > -pi / 2) & (slope < pi / 2), "an angle between -pi/2 and pi/2 [rad]")
_SHOWN = 0.1  # m: how far beyond its block pictures draw the wedge


@dataclass(frozen=True, eq=False)
class BlockOnWedge(PushedOnSpring):
    r"""A block that rubs on a wedge, which slides on the ground without friction: free, or on a spring and pushed to and fro.

    .. math:: N = \frac{m g\cos\alpha}{1 + \frac{m}{M}\sin\alpha\,(\sin\alpha - \mu\cos\alpha)}, \qquad
              M\ddot x = -N(\sin\alpha - \mu\cos\alpha), \qquad m\ddot s\sin\alpha = m g - N(\cos\alpha + \mu\sin\alpha)

    for a free wedge, while the block slides down. Coordinates are x of the wedge and `down`, s, the way of the block along the slope; the
    load of the face follows from the motion of both. With :math:`\mu \ge \tan\alpha` the block stays where it is, and on a wedge that is
    pushed by :math:`F\sin\omega t` it creeps down.

    Parameters
    ----------
    wedge, block : float
        Masses M and m [kg].
    slope : float
        Angle of the face below the horizontal, forwards [rad].
    friction : Coulomb or any law that rests exactly and is proportional to the load
        Friction law of the face, which holds the block on both sides.
    push, omega : float
        Amplitude F and angular frequency of the force on the wedge [N], [rad/s].
    stiffness, damping : float, optional
        k and c of a spring that holds the wedge [N/m], [N s/m]; without a stiffness there is none, and the wedge may travel.
    gravity : float
        Acceleration of gravity [m/s^2].

    Examples
    --------
    >>> import numpy as np
    >>> import stickslip as ss
    >>> free = BlockOnWedge(wedge=2.0, block=0.5, slope=0.5, friction=ss.Coulomb(0.2, 0.2))
    >>> run, c, s = ss.solve(free, duration=1.0), np.cos(0.5), np.sin(0.5)
    >>> load = 0.5 * 9.81 * c / (1 + 0.5 / 2.0 * s * (s - 0.2 * c))
    >>> print(f"{run.load[-1, 0]:.9f} N, by hand {load:.9f} N")
    4.153258220 N, by hand 4.153258220 N
    """

    wedge: float = field(metadata=quantity("mass of the wedge", "kg", "M", example=2.0, rule=positive))
    block: float = field(metadata=quantity("mass of the block", "kg", "m", example=0.5, rule=positive))
    slope: float = field(metadata=quantity("slope of the face", "rad", r"\alpha", example=0.5, rule=_STEEP, shown="°"))
    friction: Any
    push: float = field(default=0.0, metadata=PUSH)
    omega: float = field(default=5.0, metadata=PUSHED_AT)
    stiffness: float | None = field(default=None, metadata=STIFFNESS | {"example": 20.0})
    damping: float = field(default=0.0, metadata=DAMPING)
    gravity: float = field(default=9.81, metadata=GRAVITY)

    kind: ClassVar[str] = "block_on_wedge"  # its name in a study file
    coordinates: ClassVar[tuple[str, ...]] = ("x", "down")

    def bodies(self) -> Mapping[str, Any]:
        """The wedge, which is pushed, and the block."""
        return {"wedge": Body(self.wedge, force=self._push()), "block": Body(self.block)}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """The upper end of the face, at the height 0, and the block on it."""
        return {"wedge": (q["x"], 0.0), "block": (q["x"] + q["down"] * cos(self.slope), -q["down"] * sin(self.slope))}

    def outlines(self, t: Any, q: Any) -> list[Any]:
        """The wedge, down to a little beyond where the block gets in these instants."""
        down = np.asarray(q["down"])
        low, high = min(0.0, float(np.min(down))) - _SHOWN, max(0.0, float(np.max(down))) + _SHOWN
        along, fallen = cos(self.slope), sin(self.slope)
        top, foot = (q["x"] + low * along, -low * fallen), (q["x"] + high * along, -high * fallen)
        return [(top, foot, (top[0], foot[1]), top)]

    def contacts(self) -> Mapping[str, Any]:
        """The face."""
        return {"face": Contact("block", self.friction, on="wedge", hold="both")}
