"""Tracks: what gravity does along and across the track, and the paper's way of folding an incline into friction."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

from stickslip.fields import Record
from stickslip.maths import cos, sin

__all__ = ["TRACKS", "Incline", "Level", "fold"]


@dataclass(frozen=True, eq=False)
class Level(Record):
    """A horizontal track (or one whose incline was folded into the friction coefficients).

    Examples
    --------
    >>> Level().across(9.81), Level().along(9.81)
    (9.81, 0.0)
    """

    def across(self, gravity: Any) -> Any:
        """Gravity that presses the body on the track [m/s^2]."""
        return gravity

    def along(self, gravity: Any) -> Any:
        """Gravity that pulls the body forwards [m/s^2]."""
        return 0.0


@dataclass(frozen=True, eq=False)
class Incline(Record):
    """An inclined track with gravity acting along it; plus is downhill.

    Parameters
    ----------
    tilt : float
        Angle of the track [rad], positive where forwards is downhill, -pi/2 < tilt < pi/2.

    Examples
    --------
    >>> round(Incline(tilt=0.03).along(9.81), 4)
    0.2943
    """

    tilt: float = field(metadata={"example": "0.03"})

    _rules: ClassVar[dict[str, Any]] = {"tilt": (lambda x: abs(x) < math.pi / 2, "an angle between -pi/2 and pi/2 [rad]")}

    def across(self, gravity: Any) -> Any:
        """Gravity that presses the body on the track [m/s^2]."""
        return gravity * cos(self.tilt)

    def along(self, gravity: Any) -> Any:
        """Gravity that pulls the body forwards [m/s^2]."""
        return gravity * sin(self.tilt)


TRACKS = {"level": Level, "incline": Incline}


def fold(coefficient: Any, tilt: Any) -> tuple[Any, Any]:
    """Friction coefficients (plus, minus) of a level track that stand for an isotropic one on an incline: Eqs 3.8 and 4.1.

    Exact for Coulomb friction. For laws with an inner state it is a different model (the paper's own), because
    there gravity acts on the bristle too.

    Examples
    --------
    >>> plus, minus = fold(0.18, math.radians(1.7))
    >>> round(plus, 6), round(minus, 6)
    (0.150255, 0.209587)
    """
    return coefficient * cos(tilt) - sin(tilt), coefficient * cos(tilt) + sin(tilt)
