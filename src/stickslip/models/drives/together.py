"""Several inner masses that move together: the motion of their common centre of mass, which is all that the body feels of them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from operator import add
from typing import Any

from stickslip.basics.contracts import Drive, Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.maths import within
from stickslip.models.drives.common import MOST_REPEATS, own_time, repeated_instants, repeats_of, times
from stickslip.models.drives.drive_adapter import drive_of


class Together:
    r"""The common centre of mass of several inner masses, as the drive of one mass: :math:`\xi = \sum m_j\xi_j / \sum m_j`.

    Parameters
    ----------
    drives : sequence of drives
        How each inner mass moves relative to the body.
    masses : sequence of float
        The inner masses [kg].
    cycles : sequence of int
        How many periods of each drive there are in the common one.

    Examples
    --------
    >>> import stickslip as ss
    >>> fast, slow = ss.Harmonic(amplitude=1e-3, omega=400.0), ss.Harmonic(amplitude=1e-3, omega=200.0)
    >>> both = Together((fast, slow), (0.01, 0.03), (2, 1))
    >>> both.period == slow.period, round(both.velocity(0.0), 12)
    (True, 0.25)
    """

    def __init__(self, drives: Sequence[Any], masses: Sequence[Any], cycles: Sequence[int]):
        self.drives, self.masses, self.cycles = tuple(drives), tuple(masses), tuple(cycles)

    @property
    def period(self) -> Any:
        """The smallest common period [s]."""
        return times(self.cycles[0], self.drives[0].period)

    @property
    def mass(self) -> Any:
        """All inner masses together [kg]."""
        return reduce(add, self.masses)

    def _mean(self, values: Sequence[Any]) -> Any:
        """The mean of what each mass has, weighted with the masses."""
        return reduce(add, [m * value for m, value in zip(self.masses, values, strict=True)]) / self.mass

    def _each(self, t: Numeric, what: str) -> list[Any]:
        """The values of all drives at a time."""
        return [getattr(drive, what)(_own_time(drive, t, count)) for drive, count in zip(self.drives, self.cycles, strict=True)]

    def position(self, t: Numeric) -> Any:
        """Relative position of the centre of mass [m]."""
        return self._mean(self._each(t, "position"))

    def velocity(self, t: Numeric) -> Any:
        """Its relative velocity [m/s]."""
        return self._mean(self._each(t, "velocity"))

    def acceleration(self, t: Numeric) -> Any:
        """Its relative acceleration [m/s^2]."""
        return self._mean(self._each(t, "acceleration"))

    @property
    def vertical_acceleration(self) -> Any:
        """Its acceleration across the track [m/s^2], as a function of time; None where no mass moves across."""
        if all(drive_of(drive).vertical_acceleration is None for drive in self.drives):
            return None
        return lambda t: self._mean([_lift(drive, t, count) for drive, count in zip(self.drives, self.cycles, strict=True)])

    @property
    def breaks(self) -> Any:
        """Instants in (0, period) at which the acceleration of one of them is not smooth [s]."""
        instants: list[Any] = []
        for drive, count in zip(self.drives, self.cycles, strict=True):
            own = drive_of(drive).breaks
            if len(own) > 0 or not drive_of(drive).smooth:
                instants += repeated_instants(own, drive.period, count)
        return tuple(instants)

    @property
    def jumps(self) -> Any:
        """Jumps of the relative velocity of the centre of mass: (instant in [0, period) [s], jump [m/s])."""
        return tuple((s, jump * self.masses[j] / self.mass) for s, j, jump in self.jumps_of)

    @property
    def jumps_of(self) -> tuple[tuple[Any, int, Any], ...]:
        """Jumps of each mass' relative velocity: (instant [s], number of the mass, jump [m/s])."""
        return tuple(
            (s if k == 0 else k * drive.period + s, j, jump)
            for j, (drive, count) in enumerate(zip(self.drives, self.cycles, strict=True))
            for k in range(count)
            for s, jump in drive_of(drive).jumps
        )

    @property
    def velocity_scale(self) -> Any:
        """A relative velocity of the size of the largest one [m/s]: that of masses in phase."""
        return self._mean([drive_of(drive).velocity_scale for drive in self.drives])

    @property
    def specific_energy(self) -> Any:
        """Largest kinetic energy of the relative motions for each kilogram of all inner masses [J/kg], if they are fastest together."""
        return self._mean([drive_of(drive).specific_energy for drive in self.drives])

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks of the drives."""
        return tuple(note for drive in self.drives for note in drive_of(drive).notes)


def _own_time(drive: Drive, t: Numeric, count: int) -> Any:
    """The time since the drive's own period began, of a drive that is written for one period."""
    written_for_one = count > 1 and not drive_of(drive).smooth
    return own_time(within(t, times(count, drive.period)), drive.period, count) if written_for_one else t


def _lift(drive: Drive, t: Numeric, count: int) -> Any:
    lift = drive_of(drive).vertical_acceleration
    return 0.0 if lift is None else lift(_own_time(drive, t, count))


def common_cycles(periods: Sequence[Any], problems: Problems) -> tuple[int, ...] | None:
    """How many periods of each drive make the smallest common one; what keeps them from having one is noted.

    Examples
    --------
    >>> common_cycles([0.3, 0.2, 0.1], Problems("robot"))
    (2, 3, 6)
    """
    import numpy as np

    cycles = repeats_of(list(periods))
    if cycles is None:
        given = ", ".join(f"{float(np.ravel(np.asarray(T, float))[0]):.6g} s" for T in periods)
        several = any(np.size(T) > 1 for T in periods)
        ask = ", the same ones for all cases of the batch" if several else ""
        problems.add(
            f"the drives have the periods {given}, and no common period of at most {MOST_REPEATS} of one of them; allowed are periods in a "
            f"ratio of small whole numbers{ask}; type for example omega=400.0 beside omega=200.0"
        )
    return cycles
