"""The same motion, so much of a period earlier."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import where, wrapped
from stickslip.basics.quantities import between, quantity
from stickslip.models.drives.drive_adapter import drive_of
from stickslip.models.drives.harmonic import Harmonic
from stickslip.models.drives.wrapper import Around


@dataclass(frozen=True, eq=False)
class Shifted(Around):
    r"""A drive that is a part of its period ahead: what starts at another phase is a start at t = 0 of this one.

    Parameters
    ----------
    drive : any drive
        What is shifted.
    phase : float
        How far it is ahead, in drive periods, from -1 to 1.

    Examples
    --------
    >>> ahead = Shifted(Harmonic(amplitude=1e-3, omega=200.0), phase=0.25)
    >>> round(ahead.position(0.0), 9), round(ahead.period, 9)
    (0.001, 0.031415927)
    """

    drive: Any
    phase: float = field(
        metadata=quantity(
            "phase of the start", "1", r"\varphi", example=0.25, rule=between(-1.0, 1.0), allowed="from -1 to 1 [drive periods]"
        )
    )

    def _time(self, t: Numeric) -> Any:
        return t + self.phase * self.drive.period

    def _begun(self, instant: Any) -> Any:
        """When an instant of the drive comes, in [0, period)."""
        period = self.drive.period
        return wrapped(instant - self.phase * period, period)

    @property
    def breaks(self) -> Any:
        """Instants in (0, period) at which its acceleration is not smooth [s]; also where the drive's own period begins."""
        own = drive_of(self.drive).breaks
        return tuple(self._begun(s) for s in (0.0, *own)) if own else ()

    @property
    def jumps(self) -> Any:
        """Jumps of the relative velocity: (instant [s], jump [m/s])."""
        return tuple((self._begun(instant), jump) for instant, jump in drive_of(self.drive).jumps)

    @property
    def vertical_acceleration(self) -> Any:
        """That of the drive, as much ahead; None if it has none."""
        lift = drive_of(self.drive).vertical_acceleration
        return None if lift is None else lambda t: lift(self._time(t))

    def _of(self, what: str, t: Numeric) -> Any:
        return super()._of(what, self._time(t))

    @classmethod
    def example(cls) -> Shifted:
        """A sine that is a quarter of a period ahead."""
        return cls(Harmonic.example(), phase=0.25)


def begun_at(drive: Any, phase: Any, cycles: tuple[int, ...] | None = None) -> Any:
    """A drive that is ahead by a part of its period, or the drives of several inner masses by that part of their common period.

    Examples
    --------
    >>> slow, fast = Harmonic(amplitude=1e-3, omega=200.0), Harmonic(amplitude=1e-3, omega=400.0)
    >>> [ahead.phase for ahead in begun_at((slow, fast), 0.75, cycles=(1, 2))]
    [0.75, 0.5]
    """
    if not isinstance(drive, tuple):
        return Shifted(drive, phase)
    return tuple(Shifted(each, within_one(phase * count, count)) for each, count in zip(drive, cycles or (1,) * len(drive), strict=True))


def within_one(ahead: Any, most: int) -> Any:
    """A number of periods, at most so many, less whole ones until it is from -1 to 1."""
    for _ in range(most - 1):
        ahead = where(ahead > 1.0, ahead - 1.0, where(ahead < -1.0, ahead + 1.0, ahead))
    return ahead
