"""Averages of very many samples of a motion that repeats, so that a fit has fewer values and loses next to nothing."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array

#: Values of one record; of more samples, those at neighbouring phases are averaged.
MOST = 20_000
_PARTS = 5  # of the record, averaged apart, so that a frequency which is a little off still shows
_BINS = MOST // _PARTS
_BENT = 5.0  # standard errors by which a bin with a kink or a jump scatters more than the others


def averaged(phase: Any, y: Array, repeats: int) -> tuple[Any, Any, Any, float, float]:
    """Means over neighbouring phases of the motion in each part of a record; samples at a kink or a jump stay as they are.

    Parameters
    ----------
    phase : array (n,)
        In drive periods, rising.
    y : array (n,)
    repeats : int
        Drive periods after which the motion repeats, 1 to 4.

    Returns
    -------
    tuple of array, array, array, float, float
        Phases, values, samples in each value; mean square of what was lost, over all samples; standard deviation of the averaged samples
        about the averages.

    Examples
    --------
    >>> rng, phase = np.random.default_rng(0), np.arange(100_000) / 97.3
    >>> y = np.sin(np.pi * phase) + 0.1 * rng.normal(size=100_000)
    >>> at, mean, weight, within, scatter = averaged(phase, y, 2)
    >>> len(at) <= MOST + 500, int(weight.sum()), round(scatter, 2)
    (True, 100000, 0.1)
    >>> bool(abs((mean - np.sin(np.pi * at)) * np.sqrt(weight)).max() < 0.5)
    True
    """
    period = 3 if repeats == 3 else 4  # a second or fourth period that the noise hides is not averaged away
    edges = np.linspace(0, len(y), _PARTS + 1).astype(int)
    parts = [_part(phase[a:b], y[a:b], period) for a, b in pairwise(edges)]
    at, mean, weight, rest = (np.concatenate(each) for each in zip(*parts, strict=True))
    free = len(rest) - int((weight > 1).sum())
    lost = float(rest @ rest)
    return at, mean, weight, lost / len(y), float(np.sqrt(lost / free)) if free > 0 else 0.0


def _part(phase: Any, y: Array, period: int) -> tuple[Any, Any, Any, Any]:
    """Phases, values and weights of one part, in the order of phases; and what averaged samples differ from the averages."""
    bin_of = np.mod(phase, period) * (_BINS / period)
    near = np.round(bin_of)  # samples at whole parts of a period lie in the middle of bins
    number, index, count = np.unique(near.astype(int) % _BINS, return_inverse=True, return_counts=True)
    at = (number + np.bincount(index, bin_of - near) / count) * (period / _BINS)
    mean = np.bincount(index, y) / count
    rest = y - np.interp(bin_of * (period / _BINS), at, mean, period=period)
    several = count > 1
    square = np.bincount(index, rest**2) / np.maximum(count - 1, 1)
    usual = max(float(np.median(square[several])), (1e-9 * float(np.ptp(y))) ** 2) if several.any() else 0.0
    kept = several & (square <= usual * (1 + _BENT * np.sqrt(2 / np.maximum(count - 1, 1))))
    alone = ~kept[index]
    middle = period * np.round(0.5 * (phase[0] + phase[-1]) / period - 0.5)
    at = np.concatenate([middle + at[kept], phase[alone]])
    order = np.argsort(at, kind="stable")
    values, weight = np.concatenate([mean[kept], y[alone]]), np.concatenate([count[kept], np.ones(int(alone.sum()))])
    return at[order], values[order], weight[order], rest[~alone]
