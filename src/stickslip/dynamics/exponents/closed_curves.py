"""Whether strobe points wind round one closed curve, as those of a torus of two frequencies do: the witness of a quasi-periodic motion."""

from __future__ import annotations

import numpy as np

from stickslip.basics.contracts import Array

_LINES = 4  # of the spectrum of each number of the state, from the strongest on, that may be the winding
_LONGEST = 32  # periods of motions that repeat: a winding is not a multiple of one part of them
_SMOOTH = 0.02  # of the variance: half the mean square of what neighbours on the curve differ by
_EXACT = 1e-9  # of the distance between two lines of a spectrum: how well the place of a maximum is known


def winding_number(points: Array) -> float | None:
    """The turns per step with which points (n, d) wind round one closed curve; None if none is seen, or if it may be a rational number.

    Put in the order of k rho modulo 1, points of a torus with the rotation number rho follow its smooth closed curve, folded as it may be.
    The lines of the spectrum are tried for rho. A multiple of 1/q, q up to 32, is refused: the points of a motion that repeats, or of one
    that settles on it slowly, have such lines, and so has the attractor where period doublings accumulate.

    Examples
    --------
    >>> k = np.arange(600)
    >>> turns = 2 * np.pi * 0.2763932 * k
    >>> round(winding_number(np.column_stack([np.cos(turns) + 0.5 * np.cos(2 * turns), np.sin(turns)])), 6)
    0.276393
    >>> winding_number(np.column_stack([np.cos(np.pi * k) + 0.99**k, np.sin(np.pi * k / 2)])) is None  # it settles on period four
    True
    """
    n, spread = len(points), np.std(points, axis=0)
    moving = points[:, spread > 1e-12 * np.max(abs(points), initial=1e-300)]
    if not moving.shape[1]:
        return None
    x = (moving - moving.mean(axis=0)) / np.std(moving, axis=0)
    orders = np.arange(1, _LONGEST + 1)
    for column in x.T:
        for turns in _lines(column):
            multiples = orders * turns
            drifts = np.min(abs(multiples - np.round(multiples))) * n > 1.0
            along = x[np.argsort(np.arange(n) * turns % 1.0)]
            steps = along - np.roll(along, 1, axis=0)
            if drifts and np.all(np.mean(steps**2, axis=0) <= 2.0 * _SMOOTH):
                return float(turns)
    return None


def smooth_weights(count: int) -> Array:
    """Weights exp(-1/(t(1 - t))) along so many points, t from 0 to 1; their sum is 1.

    Examples
    --------
    >>> smooth_weights(3).round(3).tolist()
    [0.173, 0.655, 0.173]
    """
    t = np.arange(1, count + 1) / (count + 1)
    weights = np.exp(-1.0 / (t * (1.0 - t)))
    return np.asarray(weights / np.sum(weights))


def _lines(x: Array) -> list[float]:
    """The strongest lines in the spectrum of a series, in turns per step, from 0 to 1/2."""
    n, weights = len(x), smooth_weights(len(x))
    strength = abs(np.fft.rfft(weights * x))
    inner = strength[1:-1]
    peaks = np.flatnonzero((inner >= strength[:-2]) & (inner >= strength[2:])) + 1
    strongest = peaks[np.argsort(-strength[peaks])][:_LINES]
    return [_refined(weights * x, (k - 1.0) / n, (k + 1.0) / n) for k in strongest.tolist()]


def _refined(x: Array, low: float, high: float) -> float:
    """The frequency of the maximum of a line between two others."""
    from scipy.optimize import minimize_scalar

    k = np.arange(len(x))

    def weakness(turns: float) -> float:
        return -float(abs(np.exp(-2j * np.pi * turns * k) @ x))

    exact = {"xatol": _EXACT * (high - low)}
    return float(minimize_scalar(weakness, bounds=(low, high), method="bounded", options=exact).x)
