"""A pad on a belt that two springs hold askew: the minimal model of brake squeal by the coupling of two modes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.maths import cos, pi, sin, sqrt
from stickslip.basics.quantities import DAMPING, MASS, STIFFNESS, positive, quantity
from stickslip.models.forces import check_law
from stickslip.models.machines.machine import Machine
from stickslip.models.machines.parts import Body, Contact


def _spring(number: int, example: float) -> dict[str, Any]:
    return STIFFNESS | {"label": f"stiffness of spring {number}", "symbol": f"k_{{{number}}}", "example": example}


def _angle(number: int, example: float) -> dict[str, Any]:
    return quantity(f"direction of spring {number}", "rad", rf"\alpha_{{{number}}}", example=example, shown="°")


@dataclass(frozen=True, eq=False)
class ModeCoupling(Machine):
    r"""A pad that is pressed on a moving belt and held by two springs askew: above a friction coefficient its two modes flutter.

    .. math:: m\ddot x + c\dot x + k_{xx}x + k_{xz}z = -R(\dot x - v, N), \qquad
              m\ddot z + c\dot z + k_{xz}x + k_{zz}z = 0, \qquad N = F - k_3 z

    .. math:: k_{xx} = \sum k_i\cos^2\alpha_i, \quad k_{xz} = \sum k_i\sin\alpha_i\cos\alpha_i, \quad
              k_{zz} = \sum k_i\sin^2\alpha_i + k_3

    Friction, which is mu times the force of the contact's own spring, makes the stiffness matrix unsymmetric: two frequencies approach each
    other as mu grows, and above the coefficient `critical` the pad squeals; it sticks in each turn then, or loses its load.
    Coordinates are x along the belt and z, the height, both zero where the springs are relaxed and the load is F.

    Parameters
    ----------
    mass : float
        Mass m of the pad [kg].
    k1, k2 : float
        Stiffnesses of the two springs that hold it [N/m].
    alpha1, alpha2 : float
        Their directions from that of the belt [rad].
    k3 : float
        Stiffness of the contact [N/m].
    preload : float
        F, the force that presses the pad down, and its load without friction [N].
    speed : float
        v, velocity of the belt [m/s].
    friction : Coulomb or any law
        Friction law of the pad.
    damping : float
        c, in both directions [N s/m].

    References
    ----------
    N. Hoffmann, M. Fischer, R. Allgaier and L. Gaul, A minimal model for studying properties of the mode-coupling type instability in
    friction induced oscillations, Mech. Res. Commun. 29 (2002) 197-205.

    Examples
    --------
    >>> import stickslip as ss
    >>> print(f"{ss.presets.mode_coupling(damping=0.0).critical:.6f}")
    0.472377
    >>> runs = [ss.solve(ss.presets.mode_coupling(mu), duration=200.0) for mu in (0.4, 0.5)]
    >>> [bool(abs(run.v[-1]).max() > 1e-3) for run in runs]
    [False, True]
    """

    mass: float = field(metadata=MASS)
    k1: float = field(metadata=_spring(1, 11.0))
    k2: float = field(metadata=_spring(2, 20.0))
    alpha1: float = field(metadata=_angle(1, 2.617993877991494))
    alpha2: float = field(metadata=_angle(2, 0.5235987755982988))
    k3: float = field(metadata=_spring(3, 11.0) | {"label": "stiffness of the contact", "rule": positive})
    preload: float = field(metadata=quantity("force that presses the pad down", "N", "F", example=10.0, rule=positive))
    speed: float = field(metadata=quantity("velocity of the belt", "m/s", "v", example=-1.0))
    friction: Any
    damping: float = field(default=0.0, metadata=DAMPING)

    kind: ClassVar[str] = "mode_coupling"  # its name in a study file
    coordinates: ClassVar[tuple[str, ...]] = ("x", "z")
    gravity: ClassVar[float] = 0.0

    @property
    def time_scale(self) -> Any:
        """Period of the stiffer of its directions [s]."""
        return 2 * pi / sqrt(self.stiffnesses[2] / self.mass)

    @property
    def stiffnesses(self) -> tuple[Any, Any, Any]:
        """k_xx, k_xz and k_zz [N/m]."""
        springs = ((self.k1, self.alpha1), (self.k2, self.alpha2))
        along, across = sum(k * cos(a) ** 2 for k, a in springs), sum(k * sin(a) ** 2 for k, a in springs)
        return along, sum(k * sin(a) * cos(a) for k, a in springs), across + self.k3

    @property
    def critical(self) -> Any:
        r"""The friction coefficient above which steady sliding flutters, on a belt that goes backwards [-].

        .. math:: \mu_c = \frac{k_{xz}^2 + \tfrac14(k_{xx} - k_{zz})^2 + \tfrac12 (k_{xx} + k_{zz})\,c^2/m}{k_{xz}\,k_3}
        """
        along, askew, across = self.stiffnesses
        return (askew**2 + 0.25 * (along - across) ** 2 + 0.5 * (along + across) * self.damping**2 / self.mass) / (askew * self.k3)

    def _check(self, problems: Problems) -> None:
        check_law(self.friction, problems)
        if not problems.mistakes:
            super()._check(problems)

    def bodies(self) -> Mapping[str, Any]:
        """The pad."""
        return {"pad": Body(self.mass)}

    def places(self, t: Any, q: Any) -> dict[str, Any]:
        """The pad."""
        return {"pad": (q["x"], q["z"])}

    def outlines(self, t: Any, q: Any) -> list[Any]:
        """The springs, as long as pictures have room for them, and the belt."""
        reach = 1.5 * float(max(np.max(abs(np.asarray(q[name]))) for name in ("x", "z"))) or 1.0
        pad, belt = (q["x"], q["z"]), -0.8 * reach
        walls = [(reach * cos(angle), reach * sin(angle)) for angle in (self.alpha1, self.alpha2)]
        return [*((pad, wall) for wall in walls), (pad, (q["x"], belt)), ((-reach, belt), (reach, belt))]

    def forces(self, t: Numeric, q: Any, u: Any) -> dict[str, Any]:
        """Those of the springs, with that of the contact over the preload, and of the damping."""
        along, askew, across = self.stiffnesses
        return {
            "x": -along * q["x"] - askew * q["z"] - self.damping * u["x"],
            "z": -askew * q["x"] - across * q["z"] - self.damping * u["z"],
        }

    def contacts(self) -> Mapping[str, Any]:
        """The contact with the belt."""
        return {"pad": Contact("x", self.friction, on=self.speed, load=lambda t, q: self.preload - self.k3 * q["z"])}
