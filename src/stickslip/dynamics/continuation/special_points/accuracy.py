"""Special points with their accuracy, and no digit beyond it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

_DIGITS = 15
_OF_STABILITY = ("flip", "fold", "neimark-sacker", "branch-point")


def certain(value: float, accuracy: float) -> str:
    """A number to the last digit that its accuracy leaves.

    Examples
    --------
    >>> certain(0.04681084671234, 3e-11), certain(5.5525802e-4, 2e-8), certain(0.2, 0.0), certain(3.0, 10.0)
    ('0.0468108467', '0.0005553', '0.2', '0')
    """
    if not math.isfinite(accuracy) or not math.isfinite(value):
        return f"{value:.2g}"
    if accuracy <= 0.0:
        return f"{value:.{_DIGITS}g}"
    last = math.ceil(math.log10(accuracy) - 1e-9)
    digits = (math.floor(math.log10(abs(value))) if value else last) - last + 1
    return repr(float(value)) if digits > _DIGITS else f"{value:.{digits}g}" if digits > 0 else "0"


@dataclass(frozen=True, eq=False)
class Special:
    """A special point of a branch. It unpacks into kind, value and orbit.

    Parameters
    ----------
    kind : str
        "fold", "flip", "neimark-sacker", "branch-point", where two branches cross, "grazing", "type-border", "hopf", where a limit
        cycle shrinks to a steady motion, or the name of an event of one's own.
    value : float
        The parameter there. Of a change of pattern or type it is the first number found beyond the border.
    orbit : PeriodicOrbit
        The motion there.
    accuracy : float
        By how much the value may be wrong, in the unit of the parameter: from how far the search was narrowed, the residuals, and the
        same point with tenfold tolerances.
    """

    kind: str
    value: float
    orbit: Any
    accuracy: float = math.inf

    def __iter__(self) -> Iterator[Any]:
        return iter((self.kind, self.value, self.orbit))

    @property
    def changes_stability(self) -> bool:
        """Whether motions gain or lose their stability there."""
        return self.kind in _OF_STABILITY

    @property
    def rounded(self) -> str:
        """The value, to its certain digits."""
        return certain(self.value, self.accuracy)

    def __repr__(self) -> str:
        return f"<Special: {self.kind} at {self.rounded}, accuracy {self.accuracy:.1g}>"


@dataclass(frozen=True, eq=False)
class Meeting:
    """A special point of a curve: its kind (see `Curve`), the two parameters, the orbit, and the accuracy of both.

    It unpacks into the first three.
    """

    kind: str
    values: tuple[float, float]
    orbit: Any
    accuracy: tuple[float, float] = (math.inf, math.inf)

    def __iter__(self) -> Iterator[Any]:
        return iter((self.kind, self.values, self.orbit))

    @property
    def rounded(self) -> str:
        """The two parameters, to their certain digits."""
        return f"({', '.join(map(certain, self.values, self.accuracy))})"

    def __repr__(self) -> str:
        return f"<Meeting: {self.kind} at {self.rounded}>"
