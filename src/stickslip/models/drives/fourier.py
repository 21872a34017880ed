"""Drives that are a sum of harmonics: position, velocity and acceleration from the same coefficients."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import Frozen
from stickslip.basics.maths import cos, maximum, sin, sqrt
from stickslip.models.drives.drive import Drive

_POINTS = 32  # of the grid for each harmonic; more only take longer
_NEWTON = 5  # steps from half a step of the grid at most, where three reach rounding

Coefficients = Any  # a tuple of numbers, or an array with the harmonics along its first axis


def harmonics(angle: Numeric, order: int) -> Iterator[tuple[Any, Any]]:
    """cos(k angle) and sin(k angle) for k = 1, 2, … order: one cosine and one sine, the rest by turning.

    Examples
    --------
    >>> [round(s, 12) for _, s in harmonics(0.5235987755982988, 3)]  # 30, 60 and 90 degrees
    [0.5, 0.866025403784, 1.0]
    """
    c, s = cos(angle), sin(angle)
    ck, sk = c, s
    for k in range(order):
        if k:
            ck, sk = ck * c - sk * s, sk * c + ck * s
        yield ck, sk


def series(angle: Numeric, cosines: Coefficients, sines: Coefficients) -> Any:
    """The sum of cosines[k-1] cos(k angle) + sines[k-1] sin(k angle)."""
    return sum(a * c + b * s for a, b, (c, s) in zip(cosines, sines, harmonics(angle, len(sines)), strict=True))


class OfCoefficients(Frozen):
    """Base of the records that hold the cosines and sines of a periodic function themselves, and say in `_typed` what to type for one."""

    def _check(self: Any, problems: Problems) -> None:
        cosines, sines = self.cosines, self.sines
        if isinstance(cosines, tuple) and isinstance(sines, tuple) and (len(cosines) != len(sines) or not cosines):
            problems.add(f"{len(cosines)} cosines and {len(sines)} sines; allowed is the same number of each, at least one; {self._typed}")

    @property
    def coefficients(self: Any) -> tuple[Coefficients, Coefficients]:
        """Coefficients of cos(k omega t) and of sin(k omega t)."""
        return self.cosines, self.sines


def _derivative(cosines: Coefficients, sines: Coefficients) -> tuple[list[Any], list[Any]]:
    """Coefficients of the derivative by the angle."""
    return [k * b for k, b in enumerate(sines, 1)], [-k * a for k, a in enumerate(cosines, 1)]


class FourierDrive(Drive):
    """Base of the drives that are a sum of harmonics of `omega`."""

    smooth: ClassVar[bool] = True

    @property
    def order(self: Any) -> int:
        """The highest harmonic."""
        return len(self.coefficients[1])

    def position(self: Any, t: Numeric) -> Any:
        """Relative position [m]; its mean is zero."""
        return series(self.omega * t, *self.coefficients)

    def velocity(self: Any, t: Numeric) -> Any:
        """Relative velocity [m/s]."""
        return self.omega * series(self.omega * t, *_derivative(*self.coefficients))

    def acceleration(self: Any, t: Numeric) -> Any:
        """Relative acceleration [m/s^2]."""
        return self.omega**2 * series(self.omega * t, *_derivative(*_derivative(*self.coefficients)))

    @property
    def velocity_scale(self: Any) -> float:
        """Root of 2 times the r.m.s. of the relative velocity: A omega if there is one harmonic [m/s]."""
        return self.omega * sqrt(sum(k**2 * (a**2 + b**2) for k, (a, b) in enumerate(zip(*self.coefficients, strict=True), 1)))

    @property
    def stroke(self: Any) -> float:
        """From end to end [m]."""
        low, high = series_range(*self.coefficients)
        return high - low

    @property
    def specific_energy(self: Any) -> Any:
        """Largest kinetic energy of the relative motion for each kilogram of the inner mass [J/kg]."""
        low, high = series_range(*_derivative(*self.coefficients))
        return 0.5 * self.omega**2 * maximum(-low, high) ** 2


def series_range(cosines: Coefficients, sines: Coefficients) -> tuple[Any, Any]:
    """Smallest and largest value of a series: by Newton's method on the slope, from every point of a grid that may be next to it.

    Examples
    --------
    >>> series_range([3.0], [4.0])
    (-5.0, 5.0)
    """
    import numpy as np

    cases = np.broadcast_arrays(*cosines, *sines)
    a, b = np.array(cases, float).reshape(2, len(sines), -1)
    high, low = _highest(a, b), 0.0 - _highest(-a, -b)
    shape = cases[0].shape
    return (low.reshape(shape), high.reshape(shape)) if shape else (float(low[0]), float(high[0]))


def _highest(a: Any, b: Any) -> Any:
    """Largest values of series whose coefficients are the columns of two arrays.

    No grid point within half a step h of it lies lower than it by more than h^2/8 times a bound of the second derivative. So the highest
    point alone will not do where two maxima are nearly as high.
    """
    import numpy as np

    grid = np.linspace(0.0, 2 * np.pi, _POINTS * len(a), endpoint=False)
    values = series(grid, a[..., None], b[..., None])
    bend, step, highest = np.hypot(*_derivative(*_derivative(a, b))).sum(axis=0), grid[1], values.max(axis=1)
    case, point = np.nonzero(values >= (highest - bend * step**2 / 8)[:, None])
    np.maximum.at(highest, case, _climbed(grid[point], step, a[:, case], b[:, case]))
    return highest


def _climbed(angle: Numeric, step: float, a: Any, b: Numeric) -> Any:
    """The largest values that Newton's method meets from these angles."""
    import numpy as np

    slope = _derivative(a, b)
    highest, curvature = series(angle, a, b), _derivative(*slope)
    for _ in range(_NEWTON):
        bend = series(angle, *curvature)
        with np.errstate(divide="ignore", invalid="ignore"):
            move = np.where(bend < 0, -series(angle, *slope) / bend, 0.0)
        angle = angle + np.clip(move, -step, step)
        highest = np.maximum(highest, series(angle, a, b))
    return highest
