"""The same motion the other way round."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.models.drives.drive_adapter import drive_of
from stickslip.models.drives.two_phase import TwoPhase
from stickslip.models.drives.wrapper import Around


@dataclass(frozen=True, eq=False)
class Reversed(Around):
    r"""A drive whose relative motion is reversed: :math:`-\xi(t)`. Fast and slow phases change their direction.

    Motion across the track stays as it is.

    Parameters
    ----------
    drive : any drive
        The drive to reverse.

    Examples
    --------
    >>> Reversed(TwoPhase(stroke=0.01, u1=0.05, u2=0.4)).velocity(0.0)
    -0.05
    """

    drive: Any

    @property
    def jumps(self) -> Any:
        """Jumps of the relative velocity: (instant [s], jump [m/s])."""
        return tuple((instant, -jump) for instant, jump in drive_of(self.drive).jumps)

    def _of(self, what: str, t: Numeric) -> Any:
        return -super()._of(what, t)

    @classmethod
    def example(cls) -> Reversed:
        """The two-phase drive that pushes the other way."""
        return cls(TwoPhase.example())
