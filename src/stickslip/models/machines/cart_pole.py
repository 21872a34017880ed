"""A pendulum on a cart that rubs on a rail and is pushed to and fro."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from stickslip.basics.maths import cos, sin
from stickslip.basics.quantities import DAMPING, GRAVITY, STIFFNESS, positive, quantity
from stickslip.models.machines.in_the_plane import PUSH, PUSHED_AT, PushedOnSpring
from stickslip.models.machines.parts import Body, Contact


@dataclass(frozen=True, eq=False)
class CartPole(PushedOnSpring):
    r"""A cart on a rail with a pendulum on it, pushed by :math:`F\sin\omega t`; the load of the rail follows from the swing.

    .. math:: (M + m)\ddot x + m l(\ddot\varphi\cos\varphi - \dot\varphi^2\sin\varphi) = F\sin\omega t - kx - c\dot x - R(\dot x, N),
              \qquad \ddot x\cos\varphi + l\ddot\varphi + g\sin\varphi = 0

    .. math:: N = (M + m)g + m l(\ddot\varphi\sin\varphi + \dot\varphi^2\cos\varphi)

    Coordinates are x of the cart and the angle of the pendulum, which hangs at 0. Small swings without friction and push have
    :math:`\omega_0^2 = (g/l)(1 + m/M)`.

    Parameters
    ----------
    cart, bob : float
        Masses M and m [kg].
    length : float
        l, from the hinge to the bob [m].
    friction : Coulomb or any law that rests exactly and is proportional to the load
        Friction law of the rail, which holds the cart on both sides.
    push, omega : float
        Amplitude F and angular frequency of the force on the cart [N], [rad/s].
    stiffness, damping : float, optional
        k and c of a spring that holds the cart [N/m], [N s/m]; without a stiffness there is none, and the cart may travel.
    gravity : float
        Acceleration of gravity [m/s^2].

    References
    ----------
    S. A. Campbell, S. Crawford and K. Morris, Friction and the inverted pendulum stabilization problem, J. Dyn. Syst. Meas. Control 130
    (2008) 054502: that friction of the cart decides how it swings.

    Examples
    --------
    Half a period of small swings after it was let go the bob is at the other side.

    >>> import math
    >>> import stickslip as ss
    >>> free = CartPole(cart=1.0, bob=0.3, length=0.5, friction=ss.Coulomb(0.0, 0.0))
    >>> half = math.pi / math.sqrt(9.81 / 0.5 * (1 + 0.3 / 1.0))
    >>> run = ss.solve(free, duration=half, start={"x": {"angle": 1e-5}})
    >>> f"{run.coordinates['angle'][-1] / 1e-5:.9f}"
    '-1.000000000'
    """

    cart: float = field(metadata=quantity("mass of the cart", "kg", "M", example=1.0, rule=positive))
    bob: float = field(metadata=quantity("mass of the bob", "kg", "m", example=0.3, rule=positive))
    length: float = field(metadata=quantity("length of the pendulum", "m", r"\ell", example=0.5, rule=positive))
    friction: Any
    push: float = field(default=0.0, metadata=PUSH)
    omega: float = field(default=5.0, metadata=PUSHED_AT)
    stiffness: float | None = field(default=None, metadata=STIFFNESS | {"example": 20.0})
    damping: float = field(default=0.0, metadata=DAMPING)
    gravity: float = field(default=9.81, metadata=GRAVITY)

    kind: ClassVar[str] = "cart_pole"  # its name in a study file
    coordinates: ClassVar[tuple[str, ...]] = ("x", "angle")

    def bodies(self) -> Mapping[str, Any]:
        """The cart, which is pushed, and the bob."""
        return {"cart": Body(self.cart, force=self._push()), "bob": Body(self.bob)}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """The cart at the height 0, and the bob."""
        return {"cart": (q["x"], 0.0), "bob": (q["x"] + self.length * sin(q["angle"]), -self.length * cos(q["angle"]))}

    def outlines(self, t: Any, q: Any) -> list[Any]:
        """The rod from the cart to the bob."""
        places = self.places(t, q)
        return [(places["cart"], places["bob"])]

    def contacts(self) -> Mapping[str, Any]:
        """The rail."""
        return {"rail": Contact("cart", self.friction, hold="both")}
