"""The motion behind noisy sensors: a smoothing spline of stated bandwidth, and what other noise would have made of it.

A law is driven by the velocity of a record. Differences of a noisy position are not that velocity: over a step h they have the noise
of the position times the square root of two over h. The spline here is that of least squares with a penalty on its third differences,
whose weight makes it a low-pass filter of sixth order. Its bandwidth is the one that minimises Mallows' estimate of the error of the
motion. A position, a velocity and an acceleration that were measured beside one another are met together, each by its noise.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import comb
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed
from stickslip.records.overview import noise

_DEGREE = 5
_PROBES = 6  # random vectors that estimate the degrees of freedom
_GRID = 1.5  # from one bandwidth that is tried to the next
_NONE = 1e-4  # noise of a difference of neighbours, in root mean squares of the differences, below which a motion is taken as it is
_ORDERS = (5, 7, 9)  # of differences that tell noise from a motion that is coarsely sampled
_COARSE = 0.25  # distinct values for each sample below which a channel is one of counts
EDGES = 16  # changes of a count, fewer than which do not show a motion
_DITHER = 0.5  # of a count: noise of a channel of counts that is supposed at first
_BURIED = 0.38  # of a count: noise, rounding included, from which on rounding is a part of it and edges show nothing
_PASSES = 3  # times that a motion is smoothed, each with the noise that the one before has left
_WHITE, _ALIKE = 2.0, 4.0  # squares of noise: Mallows' price of a direction, and where roundings of neighbours are alike (beats)
_SHORT = 2  # samples of a stretch of one count, of which its edges say nearly all
_EDGE = 0.05  # of a count, by which the edges of an encoder may be off
_MOST = 200_000  # values of all channels together
_FEW, _FINER = 128, 3  # knots at first, and by how many times more if they are too few
_INNER, _NOISY = 1.2, 1.2  # phase of a knot below which knots are enough, and squares that are left then, in those of noise
_ENDS, _AT_MOST = 1.5, 0.1  # of a record that are left out at either end: over the bandwidth, and in parts of its length
_LEAST_PHASE = 0.03  # of a knot: no bandwidth is lower
REDRAWS = 24  # times that the motion is measured again


@sealed
@dataclass(frozen=True, eq=False)
class MotionChannel:
    """One channel of a motion.

    Parameters
    ----------
    order : int
        0 for a position, 1 for a velocity, 2 for an acceleration.
    t, y : array (n,)
    sigma : float
        Standard deviation of its noise, besides that of rounding.
    count : float
        Step to which it is rounded; 0 for none that matters.
    least : float
        The noise is not less than that.
    """

    order: int
    t: Any
    y: Any
    sigma: float
    count: float = 0.0
    least: float = 0.0

    def rows(self) -> tuple[Any, Any, Any]:
        """Instants, values and standard deviations to be met: of counts the edges, which are crossed between two samples."""
        if self.count == 0.0:
            return self.t, self.y, np.full(len(self.y), self.sigma)
        return _edges(self.t, self.y, self.count, self.sigma)

    def again(self, motion: Any, rng: Any) -> MotionChannel:
        """The channel as it might have measured a motion (values at its instants)."""
        noisy = motion + rng.normal(0.0, 1.0, len(motion)) * self.sigma
        if self.count == 0.0:
            return replace(self, y=noisy)
        counts = (noisy - rng.uniform(0.0, self.count)) / self.count
        shift, first = noisy[0] / self.count - counts[0], int(np.floor(counts.min())) - 1
        edges = rng.normal(0.0, _EDGE, int(np.ptp(counts)) + 5)
        off = np.interp(counts - first, np.arange(len(edges)) + 0.5, edges)
        return replace(self, y=self.count * (np.round(counts + off) + shift))


@sealed
@dataclass(frozen=True, eq=False)
class Smooth:
    """A smoothed motion.

    Parameters
    ----------
    channels : tuple of MotionChannel
    spline : Any
        Position over time.
    weight : float
        Of the penalty.
    bandwidth : float
        Frequency at which half of a motion is left [Hz].
    """

    channels: tuple[MotionChannel, ...]
    knots: _Knots
    coefficients: Any
    weight: float
    bandwidth: float

    def at(self, t: Any, order: int = 0) -> Any:
        """Position, velocity or acceleration at some instants."""
        return self.knots.values(t, self.coefficients, order)

    @property
    def end(self) -> float:
        """Length of either end, where a motion that is bent there is smoothed towards one that is not [s]."""
        span = self.knots.step * self.knots.count
        return min(_ENDS / max(self.bandwidth, 1e-300), _AT_MOST * span)

    def inside(self, t: Any) -> Any:
        """Which instants are not within an end, whose errors show in no repetition: array of bool."""
        last = self.knots.start + self.knots.step * self.knots.count
        return (t >= self.knots.start + self.end) & (t <= last - self.end)

    def again(self, k: int) -> Smooth:
        """The motion as other noise of the sensors, the k-th, would have shown it."""
        rng = np.random.default_rng([7, k])
        channels = tuple(c.again(self.at(c.t, c.order), rng) for c in self.channels)
        rows = _Rows(self.knots, tuple(c.rows() for c in channels), tuple(c.order for c in channels))
        return replace(self, channels=channels, coefficients=rows.solved(self.weight)[:, 0])

    @cached_property
    def noise(self) -> dict[int, float]:
        """Noise of each channel, rounding included: order -> standard deviation."""
        return {c.order: max(c.sigma, c.count / np.sqrt(12)) for c in self.channels}


class _Knots:
    """A spline with evenly spaced knots over a span of time."""

    def __init__(self, start: float, step: float, count: int):
        self.start, self.step, self.count = start, step, count
        self.t = start + step * np.arange(-_DEGREE, count + _DEGREE + 1)

    @property
    def size(self) -> int:
        return self.count + _DEGREE

    def matrix(self, t: Any, order: int) -> Any:
        """Values, or derivatives, of all basis splines: sparse (instants, splines)."""
        from scipy.interpolate import BSpline
        from scipy.sparse import diags

        t = np.clip(t, self.start, self.start + self.step * self.count)
        knots = self.t[order : len(self.t) - order] if order else self.t
        matrix = BSpline.design_matrix(t, knots, _DEGREE - order, extrapolate=True)
        for k in range(order):
            size = self.size - order + k
            matrix = matrix @ diags([-1.0 / self.step, 1.0 / self.step], [0, 1], shape=(size, size + 1))
        return matrix.tocsr()

    def values(self, t: ArrayLike, coefficients: Any, order: int) -> Any:
        return self.matrix(t, order) @ coefficients


class _Rows:
    """The least-squares problem of a spline that meets channels."""

    def __init__(self, knots: _Knots, rows: Any, orders: Any):
        from scipy.sparse import diags, vstack

        self.knots = knots
        matrices = [knots.matrix(t, order) for (t, _, _), order in zip(rows, orders, strict=True)]
        self.w = np.concatenate([1.0 / s for _, _, s in rows])
        self.y = np.concatenate([y for _, y, _ in rows]) * self.w
        matrix = vstack(matrices, format="csr")
        self.matrix = diags(self.w) @ matrix
        self.gram = _banded((self.matrix.T @ self.matrix).tocsr(), knots.size)
        bends = diags([-1.0, 3.0, -3.0, 1.0], [0, 1, 2, 3], shape=(knots.size - 3, knots.size))
        self.bends = _banded((bends.T @ bends).tocsr(), knots.size)
        self.floor = 1e-13 * float(self.gram[-1].max())

    def solved(self, weight: float, more: Any = None) -> Any:
        """Coefficients for the values, and for more of them (in standard deviations): columns."""
        from scipy.linalg import solveh_banded

        whole = self.y[:, None] if more is None else np.column_stack([self.y, more])
        system = self.gram + weight * self.bends
        system[-1] += self.floor
        return solveh_banded(system, self.matrix.T @ whole, check_finite=False)


def _banded(matrix: Any, size: int) -> Any:
    """The upper half of a symmetric matrix as `solveh_banded` wants it."""
    bands = np.zeros((_DEGREE + 1, size))
    for k in range(_DEGREE + 1):
        bands[_DEGREE - k, k:] = matrix.diagonal(k)
    return bands


def smoothed(channels: tuple[MotionChannel, ...]) -> Smooth | None:
    """The motion behind these channels; None where their noise is nothing beside it, or they are too few or too many."""
    total = sum(len(c.t) for c in channels)
    if not channels or total > _MOST or min(len(c.t) for c in channels) < 16 or all(_clean(c) for c in channels):
        return None
    channels = tuple(c if c.sigma > 0 or c.count > 0 else replace(c, sigma=1e-9 * float(np.ptp(c.y)) or 1.0) for c in channels)
    if all(c.order for c in channels):  # a velocity alone leaves open where the motion begins
        first = channels[0]
        channels = (*channels, MotionChannel(0, first.t[:1], np.zeros(1), float(np.std(first.y) * np.ptp(first.t))))
    step = min(float(np.median(np.diff(c.t))) for c in channels if len(c.t) > 1)
    start, end = min(float(c.t[0]) for c in channels), max(float(c.t[-1]) for c in channels)
    finest = max(int(np.ceil((end - start) / step)), 8)
    for _ in range(_PASSES):  # again with the noise that is left
        motion, free = _best(channels, start, end - start, finest)
        channels = tuple(_with_its_noise(c, motion, free) for c in channels)
    return replace(motion, channels=channels)


def _clean(c: MotionChannel) -> bool:
    """Whether differences of neighbours are those of the motion itself."""
    size = float(np.sqrt(np.mean(np.diff(c.y) ** 2)))
    return c.count == 0.0 and min(c.sigma, noise_of_differences(c.y)) <= _NONE * size


def noise_of_differences(y: ArrayLike) -> float:
    """The least noise that differences of several orders allow: of a smooth motion that of its last digits; infinite of too few values."""
    return min(_bends(y, order) for order in _ORDERS)


def _bends(y: ArrayLike, order: int) -> float:
    """Standard deviation of noise from differences of an order, which a smooth motion has the less the higher it is."""
    bends = np.diff(y, order)
    return float(np.median(abs(bends))) / 0.6744897501960817 / np.sqrt(comb(2 * order, order)) if len(bends) > 8 else np.inf


def _with_its_noise(c: MotionChannel, motion: Smooth, free: float) -> MotionChannel:
    """A channel with the noise that the smoothed motion leaves of it, of counts besides their rounding."""
    if len(c.t) < 16:
        return c
    rest = c.y - motion.at(c.t, c.order)
    if c.count:
        whole = float(np.mean(rest**2)) / max(free, 0.1)
        if whole > (_BURIED * c.count) ** 2:
            return replace(c, sigma=float(np.sqrt(whole)), count=0.0, least=float(np.sqrt(whole)))
        return replace(c, sigma=float(np.sqrt(max(whole - c.count**2 / 12, 0.0))))
    usual = float(np.median(abs(rest))) / 0.6744897501960817 / np.sqrt(max(free, 0.1))
    return replace(c, sigma=max(usual, 0.5 * c.sigma, c.least))


def _best(channels: tuple[MotionChannel, ...], start: float, span: float, finest: int) -> tuple[Smooth, float]:
    """The motion with the least estimated error, and the part of the values that it leaves free; with as few knots as that takes."""
    parts, orders = tuple(c.rows() for c in channels), tuple(c.order for c in channels)
    best: tuple[float, Smooth, float] | None = None
    count = min(_FEW, finest)
    while True:
        rows = _Rows(_Knots(start, span / count, count), parts, orders)
        cost, weight, phase, coefficients, free = _chosen(rows, _ALIKE if any(c.count for c in channels) else _WHITE)
        if best is None or cost < best[0]:
            bandwidth = phase * count / (2 * np.pi * span)
            best = cost, Smooth(channels, rows.knots, coefficients, weight, bandwidth), free
            if phase < np.pi:  # less smooth by a step: what is smoothed away shows in no repetition, what is left of the noise does
                own = rows.solved(weight / _GRID**6)[:, 0]
                best = cost, Smooth(channels, rows.knots, own, weight / _GRID**6, _GRID * bandwidth), free
        if count == finest or (phase < _INNER and cost < _NOISY * len(rows.y)):
            return best[1], best[2]
        count = min(_FINER * count, finest)


def _chosen(rows: _Rows, price: float) -> tuple[float, float, float, Any, float]:
    """Where the estimated error is least: that, weight of the penalty, its phase, coefficients, and the part of the values left free.

    `price` is what each direction that the motion follows has to take from the squares of what is left.
    """
    n, knots = len(rows.y), rows.knots
    probes = np.random.default_rng(3).choice([-1.0, 1.0], (n, _PROBES))
    density = float(np.sum(rows.gram[-1]) + 2 * np.sum(rows.gram[:-1])) / knots.size  # of information, for each knot
    best: tuple[float, float, float, Any, float] | None = None
    phase, rises = np.pi, 0
    while phase > _LEAST_PHASE and rises < 5:
        weight = density / (2 * np.sin(0.5 * phase)) ** 6
        try:
            solutions = rows.solved(weight, probes)
        except np.linalg.LinAlgError:  # no bandwidth as low as that
            break
        met = rows.matrix @ solutions
        bent = float(np.mean(np.sum(probes * met[:, 1:], axis=0)))
        cost = float(np.sum((rows.y - met[:, 0]) ** 2)) + price * bent
        if best is None or cost < best[0]:
            best, rises = (cost, weight, phase, solutions[:, 0], 1 - bent / n), 0
        else:
            rises += 1
        phase /= _GRID
    if best is None:
        raise InputError("identify", ["the motion cannot be smoothed: its sensors differ in noise by too much; leave one of them out"])
    return best


def counted(y: Array) -> float:
    """The step of a channel that is one of counts, of which enough are crossed; 0 of any other."""
    return float(np.min(np.diff(np.unique(y)))) if _is_coarse(y) and np.count_nonzero(np.diff(y)) >= EDGES else 0.0


def edges_too_few(y: Array) -> int | None:
    """How often a channel of counts changes, if that is too seldom to show a motion; None of any other."""
    y = y[np.isfinite(y)]
    changes = int(np.count_nonzero(np.diff(y)))
    return changes if _is_coarse(y) and changes < EDGES else None


def _is_coarse(y: Array) -> bool:
    """Whether a channel has few values beside its samples, and not one alone."""
    return 1 < len(np.unique(y)) < _COARSE * len(y)


def _edges(t: Array, y: Array, count: float, sigma: float) -> tuple[Any, Any, Any]:
    """Where edges of counts are crossed, and beside that each stretch of one count, whose values weigh together as one reading.

    A stretch of few samples has the rounding of its edges, which say all of it where about one count is crossed in a sample: it counts by
    what it knows more than they do. Counted twice, rounding would look like a motion.
    """
    change = np.flatnonzero(np.diff(y) != 0)
    bounds = np.concatenate([[0], change + 1, [len(y)]])
    lengths = np.diff(bounds)
    nearest = np.minimum(lengths[:-1], lengths[1:])
    size = abs(y[change + 1] - y[change])
    crossed = np.sqrt(size**2 / (12.0 * np.where(size > 1.5 * count, 1, nearest) ** 2) + (_EDGE * count) ** 2 + sigma**2)
    reading, crossing = 1.0 / (count**2 / 12 + sigma**2), 0.5 / crossed**2
    own = np.where(lengths > _SHORT, reading, reading - np.append(crossing, 0.0) - np.insert(crossing, 0, 0.0))  # information
    own, kept = np.repeat(own / lengths, lengths), np.repeat(own > _NONE * reading, lengths)
    return (
        np.concatenate([0.5 * (t[change] + t[change + 1]), t[kept]]),
        np.concatenate([0.5 * (y[change] + y[change + 1]), y[kept]]),
        np.concatenate([crossed, 1.0 / np.sqrt(own[kept])]),
    )


def channel(order: int, t: Array, y: Array) -> MotionChannel | None:
    """A channel with its noise, without samples that are missing; None of too few."""
    good = np.isfinite(t) & np.isfinite(y)
    good[good] &= np.concatenate([[True], np.diff(t[good]) > 0])
    t, y = np.asarray(t, float)[good], np.asarray(y, float)[good]
    if len(t) < 16 or not np.ptp(y) > 0:
        return None
    count, level = counted(y), noise(y)
    level = level if np.isfinite(level) else 0.0
    if count and level <= _BURIED * count:
        return MotionChannel(order, t, y, _DITHER * count, count)
    return MotionChannel(order, t, y, level, least=0.8 * level if count else 0.0)
