"""A periodic record of a torque or an angle, its mean included, as a sum of harmonics."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

from stickslip.basics.contracts import Array, Numeric
from stickslip.basics.quantities import PERIOD, quantity
from stickslip.models.drives.drive import OfPeriod
from stickslip.models.drives.fourier import FourierDrive, OfCoefficients
from stickslip.models.drives.samples import checked_samples, fourier_fit


@dataclass(frozen=True, eq=False)
class PeriodicRecord(OfPeriod, OfCoefficients, FourierDrive):
    r"""One period of a record as a sum of harmonics about its mean; `from_samples` makes it.

    .. math:: x(t) = \bar x + \sum_k a_k\cos k\omega t+b_k\sin k\omega t

    Parameters
    ----------
    period : float
        Period T [s].
    mean : float
        Mean value [rad or N m].
    cosines, sines : tuple of float
        Coefficients a_k and b_k, from k = 1.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0.0, 2.0, 201)
    >>> record = PeriodicRecord.from_samples(t, 0.3 + 0.1 * np.sin(np.pi * t))
    >>> record.order, record.period, round(record.mean, 12), round(record.at(0.5), 12)
    (1, 2.0, 0.3, 0.4)
    """

    period: float = field(metadata=PERIOD | {"example": 2.0})
    mean: float = field(metadata=quantity("mean of the record", "1", "y_{0}", example=0.0))
    cosines: tuple[float, ...] = field(metadata=quantity("coefficients of the cosines", "1", "a", example=(0.0, 0.01)))
    sines: tuple[float, ...] = field(metadata=quantity("coefficients of the sines", "1", "b", example=(0.1, 0.0)))

    _typed: ClassVar[str] = "type for example ss.PeriodicRecord.from_samples(t, values)"

    def position(self, t: Numeric) -> Any:
        """Value at a time, its mean included [rad or N m]."""
        return self.mean + super().position(t)

    at = position

    @classmethod
    def from_samples(cls, t: Array, values: Array, tolerance: float = 1e-3, order: int | None = None) -> PeriodicRecord:
        """One period of samples: the last instant is the first of the next period.

        Parameters
        ----------
        t : array (n,)
            Ascending instants [s].
        values : array (n,)
            The record there [rad or N m]; its last value is its first again.
        tolerance : float
            Harmonics are kept until the remainder is below this fraction of the r.m.s. of the record about its mean.
        order : int, optional
            How many harmonics to keep, instead of `tolerance`.

        Raises
        ------
        InputError
            Records with gaps, that do not close, or of what is not a number.
        """
        period = float(t[-1]) - float(t[0]) if len(t) > 1 else None
        record = checked_samples(
            t, {"record": values}, period, tolerance, order, "record", "type (times, values), two arrays over one period"
        )
        cosines, sines, mean, _ = fourier_fit(record, tolerance, order)
        return cls(record.period, mean, tuple(map(float, cosines)), tuple(map(float, sines)))

    @classmethod
    def example(cls) -> PeriodicRecord:
        """A slow swing about a mean."""
        return cls(period=2.0, mean=0.1, cosines=(0.0,), sines=(0.3,))
