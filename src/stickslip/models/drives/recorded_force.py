"""A force as it was measured: a record turned into a sum of harmonics."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import pi
from stickslip.basics.quantities import PERIOD, quantity
from stickslip.models.drives.drive import Remarked
from stickslip.models.drives.force import Force
from stickslip.models.drives.fourier import OfCoefficients, series
from stickslip.models.drives.samples import checked_samples, fourier_fit


@dataclass(frozen=True, eq=False)
class RecordedForce(Remarked, OfCoefficients, Force):
    r"""A periodic record of the force on the inner mass of a `Forced` drive as a sum of harmonics, which `from_samples` makes.

    .. math:: F(t) = F_0 + \sum_k a_k\cos k\omega t+b_k\sin k\omega t

    Parameters
    ----------
    period : float
        Period T [s].
    mean : float
        F_0 [N].
    cosines, sines : tuple of float
        Coefficients a_k and b_k [N], from k = 1.
    notes : tuple of str, optional
        Remarks on where the numbers come from. A copy with other numbers has none.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(600) * 1e-4
    >>> force = RecordedForce.from_samples(t, force=0.2 + np.sin(2 * pi * t / 0.06), period=0.06)
    >>> round(force.mean, 9), round(force.sines[0], 9), force.notes[0][:53]
    (0.2, 1.0, 'the drive is a force record of 600 samples as 1 harmo')
    """

    period: float = field(metadata=PERIOD | {"label": "period of the force", "example": 0.06})
    mean: float = field(metadata=quantity("mean of the force", "N", "F_{0}", example=0.0))
    cosines: tuple[float, ...] = field(metadata=quantity("coefficients of the cosines", "N", "a", example=(0.0, 0.2)))
    sines: tuple[float, ...] = field(metadata=quantity("coefficients of the sines", "N", "b", example=(1.0, 0.0)))
    notes: tuple[str, ...] | None = None

    _typed: ClassVar[str] = "type for example ss.drives.RecordedForce.from_samples(t, force=F, period=0.06)"

    def at(self, t: Numeric) -> Any:
        """The force [N]."""
        return self.mean + series((2 * pi / self.period) * t, self.cosines, self.sines)

    def mirrored(self) -> RecordedForce:
        """The reversed force."""
        cosines, sines = (tuple(-c for c in side) for side in (self.cosines, self.sines))
        return RecordedForce(self.period, -self.mean, cosines, sines, self.notes)

    @classmethod
    def from_samples(cls, t: Numeric, force: Numeric, period: Numeric, tolerance: float = 1e-3, order: int | None = None) -> RecordedForce:
        """A force from samples of one or several of its periods, fitted by least squares at the instants at which they were taken.

        Parameters
        ----------
        t : array (n,)
            Instants [s], ascending, over at least one period, without gaps; they need not be evenly spaced.
        force : array (n,)
            The record [N].
        period : float
            Period of the record [s].
        tolerance : float
            Harmonics are kept until the remainder is below this fraction of the r.m.s. of the record about its mean.
        order : int, optional
            How many harmonics to keep, instead of `tolerance`.

        Returns
        -------
        RecordedForce
            Its `notes` give the remainder of the record.

        Raises
        ------
        InputError
            Records with gaps, of less than a period, or that do not repeat.
        """
        record = checked_samples(t, {"force": force}, period, tolerance, order, cls.__name__, cls._typed)
        a, b, mean, remark = fourier_fit(record, tolerance, order)
        return cls(record.period, mean, tuple(map(float, a)), tuple(map(float, b)), notes=(remark,))

    @classmethod
    def example(cls) -> RecordedForce:
        """A force of two harmonics."""
        return cls(period=0.06, mean=0.0, cosines=(0.0, 0.75), sines=(1.5, 0.0))
