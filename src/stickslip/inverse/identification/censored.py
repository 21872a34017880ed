r"""Clipped samples: the sensor's range ends there, and of what is measured only that it lies beyond is known (Tobin 1958).

A model h that lies :math:`u = (h - y)/\sigma` beyond the end y has the likelihood :math:`\Phi(u)`, and so the residual
:math:`\sqrt{-2\ln\Phi(u)}`, whose square stands beside the squares of other residuals: near zero where the model is beyond the end, and
near :math:`-u` where it is far inside.
"""

from __future__ import annotations

from math import comb
from typing import Any

import numpy as np

from stickslip.records.overview import clipped_sides

_NOISY, _ORDERS = 1e-6, (3, 5, 7, 9)  # noise in parts of the range below which there is none, and orders of differences that tell it
_FAR = 30.0  # standard deviations beyond an end where nothing is left of a residual


def sides_of(y: Any) -> Any:
    """On which end of the range samples sit: 1, -1 or 0, array (n,); a plain 0 where none does.

    A record without noise is no sensor's: what is level there is the motion, or Coulomb's force.

    Examples
    --------
    >>> wave = np.clip(np.sin(np.arange(1000) / 10), -0.9, 0.9)
    >>> noisy = np.clip(wave + 1e-3 * np.random.default_rng(0).normal(size=1000), -0.9, 0.9)
    >>> bool(np.any(sides_of(wave))), bool(np.any(sides_of(noisy)))
    (False, True)
    """
    sides = clipped_sides(y)
    return sides if sides.any() and _noisy(np.where(sides == 0, y, np.nan)) else 0


def _noisy(y: Any) -> bool:
    """Whether differences of a high order, of which a smooth curve has none, are more than nothing."""
    sizes = []
    for order in _ORDERS:
        bends = np.diff(y, order)
        bends = abs(bends[np.isfinite(bends)])
        sizes.append(float(np.median(bends)) / np.sqrt(comb(2 * order, order)) if len(bends) > 8 else 0.0)
    return min(sizes) > _NOISY * float(np.nanmax(y) - np.nanmin(y))


def tail(u: Any) -> Any:
    """Residuals of clipped samples whose model is u standard deviations beyond the end of the range.

    Examples
    --------
    >>> tail(np.array([-20.0, 0.0, 20.0])).round(3).tolist()
    [20.195, 1.177, 0.0]
    """
    from scipy.special import log_ndtr

    return np.sqrt(-2.0 * log_ndtr(np.asarray(u, float)))


def tail_slope(u: Any) -> Any:
    """By how much such a residual falls for each standard deviation farther beyond.

    Examples
    --------
    >>> u = np.array([-8.0, -1.0, 0.0, 2.0])
    >>> bool(np.allclose(tail_slope(u), -(tail(u + 1e-6) - tail(u - 1e-6)) / 2e-6, rtol=1e-6))
    True
    """
    from scipy.special import log_ndtr

    near = np.minimum(np.asarray(u, float), _FAR)
    log = log_ndtr(near)
    return np.where(u < _FAR, np.exp(-0.5 * near**2 - log) / np.sqrt(2 * np.pi) / np.sqrt(-2.0 * log), 0.0)
