"""The strokes of a motion between its reversals, where a force without inner states jumps.

A load cell that is late shows such a jump one, two or more samples after the reversal. Which sample shows it first tells the delay to no
better than the time between two samples: the samples about a jump are left open, and a force is followed within its strokes alone.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array

_OPEN = 1.0  # samples on either side of a reversal that are open, besides those between which it is
_ROUNDING = 1e-6  # of a sample
_EVENLY = 0.35  # part of the samples about a rest that is passed whose speeds are above half of those at its ends
_STAYS = 10  # samples from one direction to the other, more than which are a rest
_BEFORE = 2.0  # intervals by which a line within a stroke reaches beyond its two values
_GAP = 3.0  # times the usual time between values, over which nothing curved is taken between them


def runs(sides: Array) -> list[tuple[int, int]]:
    """First and last samples of each change of direction, from directions -1, 0 (open) and 1.

    Examples
    --------
    >>> runs(np.array([1, 1, 0, -1, -1, 1]))
    [(1, 3), (4, 5)]
    """
    sure = np.flatnonzero(sides)
    return [(int(sure[k]), int(sure[k + 1])) for k in np.flatnonzero(np.diff(np.sign(sides)[sure]))]


def turning(sides: Array) -> Any:
    """Which samples are those of a change of direction: array (n,) of bool."""
    which = np.zeros(len(sides), bool)
    for first, last in runs(sides):
        which[first : last + 1] = True
    return which


def later(t: Array, h: Array, delay: float, smooth: bool = False) -> Any:
    """Values a little later; between them, and before the first and after the last one, they change evenly, or as a smooth force does.

    Examples
    --------
    >>> later(np.arange(4.0), np.array([0.0, 1.0, 2.0, 2.0]), 0.5).tolist()
    [-0.5, 0.5, 1.5, 2.0]
    """
    left, part = _between(t, t - delay)
    line = on_a_line(h, left, left + 1, part)
    curved = _curved(t, left, part) if smooth else np.zeros(len(t), bool)
    return np.where(_beside(curved, h), _spline(t, h)(t - delay), line) if curved.any() else line


def on_a_line(h: Array, left: Array, right: Array, part: Array) -> Any:
    """Values a part of the way from those on the left to those on the right, of many columns too.

    Examples
    --------
    >>> on_a_line(np.array([[0.0, 1.0], [2.0, 1.0]]), np.array([0]), np.array([1]), np.array([0.25])).tolist()
    [[0.5, 1.0]]
    """
    return h[left] + (h[right] - h[left]) * _beside(part, h)


def _beside(each: Array, h: Array) -> Any:
    """A value for each row, as a column where there are many columns."""
    return each if h.ndim == 1 else each[:, None]


def later_slope(t: Array, h: Array, delay: float) -> Any:
    """The change of smooth values with time."""
    left, part = _between(t, t - delay)
    even = (h[left + 1] - h[left]) / (t[left + 1] - t[left])
    curved = _curved(t, left, part)
    return np.where(curved, _spline(t, h)(t - delay, 1), even) if curved.any() else even


def _between(t: Array, at: Array) -> tuple[Any, Any]:
    """The value before each instant, and how far that is on the way to the next one."""
    left = np.clip(np.searchsorted(t, at, side="right") - 1, 0, len(t) - 2)
    return left, (at - t[left]) / (t[left + 1] - t[left])


def _curved(t: Array, left: Any, part: Any) -> Any:
    """Where values follow a curve: not beyond the ends, and not over gaps."""
    return (part >= 0) & (part <= 1) & (t[left + 1] - t[left] < _GAP * np.median(np.diff(t))) & (len(t) > 3)


def _spline(t: Array, h: Array) -> Any:
    from scipy.interpolate import CubicSpline

    return CubicSpline(t, h)


def _passes(speeds: Array | None, first: int, last: int) -> bool:
    """Whether a motion whose noise leaves its direction open passes rest evenly: half of its speeds are above half of the largest then."""
    if speeds is None:
        return False
    between = speeds[first : last + 1]
    return bool(np.mean(between > 0.5 * max(between[0], between[-1])) > _EVENLY)


class Strokes:
    """Values over strokes, some of them later than the motion.

    Parameters
    ----------
    t : array (n,)
        Instants of the values [s].
    sides : array (n,)
        Directions of the motion there: -1, 1, or 0 where it is open.
    lag : float
        By how much later than the reversals values are open [s].
    step : float
        Time between samples [s].
    speeds : array (n,), optional
        How fast the motion is there [m/s].

    Examples
    --------
    A force that jumps between the third and the fourth of seven values, whose least value there is -1, shown half a sample later:

    >>> made = Strokes(np.arange(7.0), np.array([1, 1, 1, -1, -1, -1, -1]), 0.5, 1.0)
    >>> made.delayed(np.array([0.0, 1.0, -9.0, -9.0, -2.0, -3.0, -4.0]), 0.5).tolist()
    [-0.5, 0.5, -9.0, -9.0, -9.0, -2.5, -3.5]
    """

    def __init__(self, t: Array, sides: Array, lag: float, step: float, speeds: Array | None = None):
        self.t, count, around = t, len(t), (_OPEN + _ROUNDING) * step
        self.runs = runs(sides)
        self.of = np.full(count, -1)
        self.open = np.full(count, -1)  # the value that says what is open, where that is
        self.passing = np.zeros(count, bool)  # open values of a motion that passes rest and does not stay there
        for number, (first, last) in enumerate(self.runs):
            self.of[first : last + 1] = number
            begin, end = np.searchsorted(t, t[first] + lag - around), np.searchsorted(t, t[last] + lag + around, side="right")
            self.open[begin:end] = first
            self.passing[begin:end] = last - first <= _STAYS or _passes(speeds, first, last)
        self._kept: tuple[float, Any] | None = None
        self.steps = np.diff(t)
        usual, alone = self.steps < _GAP * step, self.of < 0
        self.within = np.zeros(count, bool)  # values whose neighbours are of the same stroke, and near
        self.within[1:-1] = alone[:-2] & alone[1:-1] & alone[2:] & usual[:-1] & usual[1:]
        self.middle = np.array([0.5 * (t[first] + t[last]) for first, last in self.runs])
        self.before = np.array([max(first - 2, 0) for first, _ in self.runs], int)
        self.after = np.array([min(last + 1, count - 2) for _, last in self.runs], int)

    def delayed(self, h: Array, delay: float) -> Any:
        """Values of the strokes so much later, and what is open between them."""
        left, part, here, next_ = self._places(delay)
        bend, off = self._bend(h), part * (part - 1) * self.steps[left] ** 2
        curved = _beside(off * here, h) * bend[left] + _beside(off * next_, h) * bend[left + 1]
        return np.where(_beside(self.open >= 0, h), h[self.open], on_a_line(h, left, left + 1, part) + curved)

    def slope(self, h: Array, delay: float) -> Any:
        """The change of these with time."""
        left, part, here, next_ = self._places(delay)
        held = (self.open >= 0) | (part <= -_BEFORE) | (part >= 1 + _BEFORE)
        bend, steps = self._bend(h), self.steps[left]
        curved = (2 * part - 1) * steps * (here * bend[left] + next_ * bend[left + 1])
        return np.where(held, 0.0, (h[left + 1] - h[left]) / steps + curved)

    def _bend(self, h: Array) -> Any:
        """Half the second derivative of a parabola through each value and its neighbours."""
        bend, along = np.zeros_like(h), np.diff(h, axis=0) / _beside(self.steps, h)
        bend[1:-1] = np.diff(along, axis=0) / _beside(self.t[2:] - self.t[:-2], h)
        return bend

    def _places(self, delay: float) -> tuple[Any, Any, Any, Any]:
        """Of each instant the value before it, how far it is on the way to the next one, and how much their bends count.

        The curve is within the same stroke: a cubic through four values, or a parabola through three at its end. The last ones are kept.
        """
        kept = self._kept
        if kept is None or kept[0] != delay:
            self._kept = kept = delay, self._placed(delay)
        return kept[1]

    def _placed(self, delay: float) -> tuple[Any, Any, Any, Any]:
        t, at = self.t, self.t - delay
        left = np.clip(np.searchsorted(t, at, side="right") - 1, 0, len(t) - 2)
        run = np.maximum(self.of[left], self.of[left + 1])
        if len(self.runs):
            left = np.where(run < 0, left, np.where(at < self.middle[run], self.before[run], self.after[run]))
        part = (at - t[left]) / (t[left + 1] - t[left])
        part = np.where(run < 0, part, np.clip(part, -_BEFORE, 1 + _BEFORE))
        first, last = np.maximum(left - 1, 0), np.minimum(left + 2, len(t) - 1)
        here, next_ = self.within[left] & (part >= 0), self.within[left + 1] & (part <= 1)
        share = np.where(here & next_, (t[last] - t[left] - part * self.steps[left]) / (t[last] - t[first]), here)
        return left, part, share, np.where(here | next_, 1.0 - share, 0.0)
