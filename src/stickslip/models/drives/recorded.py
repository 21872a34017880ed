"""A drive as it was measured: a record of position, velocity or acceleration, turned into a sum of harmonics."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

from stickslip.basics.contracts import ArrayLike
from stickslip.basics.errors import InputError
from stickslip.basics.quantities import PERIOD, quantity
from stickslip.models.drives.drive import OfPeriod, Remarked
from stickslip.models.drives.fourier import FourierDrive, OfCoefficients
from stickslip.models.drives.samples import checked_samples, fourier_fit


@dataclass(frozen=True, eq=False)
class Recorded(OfPeriod, Remarked, OfCoefficients, FourierDrive):
    r"""A periodic record as a sum of harmonics; `from_samples` makes it from the record.

    .. math:: \xi(t) = \sum_k a_k\cos k\omega t+b_k\sin k\omega t

    Parameters
    ----------
    period : float
        Period T [s].
    cosines, sines : tuple of float
        Coefficients a_k and b_k of the relative position [m], from k = 1.
    notes : tuple of str, optional
        Remarks on where the numbers come from; `Robot.notes` repeats them. A copy with other numbers has none.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(400) * 1e-4
    >>> drive = Recorded.from_samples(t, velocity=0.1 * np.cos(100 * np.pi * t) + 0.02 * np.sin(200 * np.pi * t), period=0.02)
    >>> drive.order, round(drive.stroke, 9)
    (2, 0.00063662)
    """

    period: float = field(metadata=PERIOD)
    cosines: tuple[float, ...] = field(metadata=quantity("coefficients of the cosines", "m", "a", example=(0.0, 1e-4)))
    sines: tuple[float, ...] = field(metadata=quantity("coefficients of the sines", "m", "b", example=(5e-4, 0.0)))
    notes: tuple[str, ...] | None = None

    _typed: ClassVar[str] = "type for example ss.drives.Recorded.from_samples(t, velocity=v, period=0.03)"

    @classmethod
    def from_samples(
        cls,
        t: ArrayLike | None,
        position: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        acceleration: ArrayLike | None = None,
        period: ArrayLike | None = None,
        tolerance: float = 1e-3,
        order: int | None = None,
    ) -> Recorded:
        r"""A drive from samples of one or several periods of its relative position, velocity or acceleration.

        The samples are fitted by least squares at the instants at which they were taken; these need not be evenly spaced, but
        may not have gaps. Of an acceleration record the velocity is the one with mean zero.

        Parameters
        ----------
        t : array (n,)
            Instants [s], ascending, over at least one period. The first sample need not be at t = 0.
        position, velocity, acceleration : array (n,)
            The record, exactly one of them [m, m/s, m/s^2].
        period : float
            Period of the record [s].
        tolerance : float
            Harmonics are kept until the remainder is below this fraction of the r.m.s. of the record.
        order : int, optional
            How many harmonics to keep, instead of `tolerance`.

        Returns
        -------
        Recorded
            Its `order` is the number of harmonics kept; its `notes` give the remainder.

        Raises
        ------
        InputError
            Records with gaps, of less than a period, that do not repeat, or of a velocity or acceleration that has a mean.
        """
        given = {"position": position, "velocity": velocity, "acceleration": acceleration}
        record = checked_samples(t, given, period, tolerance, order, cls.__name__, cls._typed)
        a, b, _, remark = fourier_fit(record, tolerance, order)
        return cls(record.period, *_position(a, b, 2 * math.pi / record.period, record.derivatives), notes=(remark,))

    @classmethod
    def example(cls) -> Recorded:
        """A saw of five harmonics that moves the paper's robot."""
        k = range(1, 6)
        return cls(period=0.03, cosines=(0.0,) * 5, sines=tuple(4e-4 / i**2 for i in k))


def _position(a: Any, b: Any, omega: float, derivatives: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Coefficients of the position from those of its first or second derivative."""
    for _ in range(derivatives):
        a, b = ([-y / (k * omega) for k, y in enumerate(b, 1)], [x / (k * omega) for k, x in enumerate(a, 1)])
    if not a:
        raise InputError("Recorded", ["no harmonic is left"])
    return tuple(float(x) for x in a), tuple(float(x) for x in b)
