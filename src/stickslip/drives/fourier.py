"""Drives that are a sum of harmonics: position, velocity and acceleration from the same coefficients."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from stickslip.drives.drive import Drive
from stickslip.maths import cos, sin, sqrt

__all__ = ["FourierDrive", "extremes", "harmonics", "series"]

Coefficients = Any  # a tuple of numbers, or an array with the harmonics along its first axis


def harmonics(angle: Any, order: int) -> Iterator[tuple[Any, Any]]:
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


def series(angle: Any, cosines: Coefficients, sines: Coefficients) -> Any:
    """The sum of cosines[k-1] cos(k angle) + sines[k-1] sin(k angle)."""
    return sum(a * c + b * s for a, b, (c, s) in zip(cosines, sines, harmonics(angle, len(sines)), strict=True))


def _derivative(cosines: Coefficients, sines: Coefficients) -> tuple[list[Any], list[Any]]:
    """Coefficients of the derivative by the angle."""
    return [k * b for k, b in enumerate(sines, 1)], [-k * a for k, a in enumerate(cosines, 1)]


class FourierDrive(Drive):
    """Base of the drives that are a sum of harmonics of `omega`."""

    if TYPE_CHECKING:
        omega: Any

        @property
        def coefficients(self) -> tuple[Coefficients, Coefficients]:
            """Coefficients of the relative position: those of cos(k omega t) and of sin(k omega t) [m]."""

    @property
    def order(self) -> int:
        """The highest harmonic."""
        return len(self.coefficients[1])

    def position(self, t: Any) -> Any:
        """Relative position [m]; its mean is zero."""
        return series(self.omega * t, *self.coefficients)

    def velocity(self, t: Any) -> Any:
        """Relative velocity [m/s]."""
        return self.omega * series(self.omega * t, *_derivative(*self.coefficients))

    def acceleration(self, t: Any) -> Any:
        """Relative acceleration [m/s^2]."""
        return self.omega**2 * series(self.omega * t, *_derivative(*_derivative(*self.coefficients)))

    @property
    def velocity_scale(self) -> Any:
        """Root of 2 times the r.m.s. of the relative velocity: A omega if there is one harmonic [m/s]."""
        return self.omega * sqrt(sum(k**2 * (a**2 + b**2) for k, (a, b) in enumerate(zip(*self.coefficients, strict=True), 1)))

    @property
    def stroke(self) -> Any:
        """From end to end [m]."""
        low, high = extremes(*self.coefficients)
        return high - low

    @property
    def specific_energy(self) -> Any:
        """Largest kinetic energy of the relative motion for each kilogram of the inner mass [J/kg]."""
        low, high = extremes(*_derivative(*self.coefficients))
        return 0.5 * self.omega**2 * abs(maximum_of(-low, high)) ** 2


def maximum_of(a: Any, b: Any) -> Any:
    """The larger of two numbers or arrays."""
    import numpy as np

    larger = np.maximum(a, b)
    return larger if np.ndim(larger) else float(larger)


def extremes(cosines: Coefficients, sines: Coefficients) -> tuple[Any, Any]:
    """Smallest and largest value of a series: from a grid, then Newton's method on the slope.

    Examples
    --------
    >>> extremes([3.0], [4.0])
    (-5.0, 5.0)
    """
    import numpy as np

    a, b = (np.moveaxis(np.array(np.broadcast_arrays(*c), float), 0, -1) for c in (cosines, sines))
    a, b = (np.moveaxis(c, -1, 0)[..., None] for c in np.broadcast_arrays(a, b))
    grid = np.linspace(0.0, 2 * np.pi, 32 * len(a) + 1)
    values = series(grid, a, b)
    found = []
    for sign in (-1, 1):
        angle = grid[np.argmax(sign * values, axis=-1)][..., None]
        found.append(_refined(angle, grid[1], a, b, sign))
    return found[0], found[1]


def _refined(angle: Any, step: float, a: Any, b: Any, sign: int) -> Any:
    """The extreme value next to a point of the grid."""
    import numpy as np

    first, best = _derivative(a, b), sign * series(angle, a, b)
    second = _derivative(*first)
    for _ in range(5):
        bend = series(angle, *second)
        with np.errstate(divide="ignore", invalid="ignore"):
            move = np.where(sign * bend < 0, -series(angle, *first) / bend, 0.0)
        angle = angle + np.clip(move, -step, step)
        best = np.maximum(best, sign * series(angle, a, b))
    value = sign * best[..., 0]
    return value if value.ndim else float(value)
