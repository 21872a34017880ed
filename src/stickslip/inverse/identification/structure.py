"""What is left of a record where a wrong law or drive must show: at multiples of the drive, over its cycle, from half to half.

Each test gives a probability under noise, whose size is that of what is left away from where the structure would stand. The smallest
probability is held against the level divided by the number of tests (Bonferroni), so that a record by the right law is blamed once in
five hundred.
"""

from __future__ import annotations

from typing import Any

import numpy as np

_LEVEL = 2e-3  # of all tests of a record together
_LINES = 8  # multiples of the drive
_BINS = 24  # of a cycle
_ENOUGH = 60  # values


def structure(target: Any, rest: Any, rows: Any = 1.0) -> str:
    """The structure in the residuals of a record, in words; empty where there is none, or the record has no drive."""
    if target.kind != "velocity" or len(rest) < _ENOUGH or target.within > 0 or np.ndim(rows):
        return ""
    rest = rest * np.sqrt(target.weight * np.ones(len(rest)))
    found = [*_lines(target.phase, rest), *_cycle(target, rest), *_halves(target.phase, rest)]
    if not found:
        return ""
    chance, said = min(found)
    return said if chance * len(found) < _LEVEL else ""


def _lines(phase: Any, rest: Any) -> list[tuple[float, str]]:
    """Amplitudes at multiples of the drive, beside those at frequencies around them (colour of the noise)."""
    periods = float(phase[-1] - phase[0])
    if periods < 6:
        return []
    from scipy.stats import f as ratio

    most = min(_LINES, int(0.4 * len(rest) / periods))
    away = np.concatenate([-np.arange(2, 8), np.arange(2, 8)]) / periods
    found = []
    for n in range(1, most + 1):
        here, around = _power(phase, rest, n), np.array([_power(phase, rest, n + d) for d in away if n + d > 0])
        usual = float(np.mean(around))
        size = here / max(usual, 1e-300)
        chance = float(ratio.sf(size, 2, 2 * len(around)))
        found.append((chance, f"{_ordinal(n)} harmonic of the drive left at {np.sqrt(2 * size):.2g} standard errors"))
    return found


def _power(phase: Any, rest: Any, n: float) -> float:
    return float(abs(np.sum(rest * np.exp(-2j * np.pi * n * phase))) ** 2)


def _ordinal(n: int) -> str:
    return {1: "first", 2: "second", 3: "third"}.get(n, f"{n}th")


def _cycle(target: Any, rest: Any) -> list[tuple[float, str]]:
    """The mean residual over the cycle of the motion, in bins, beside the scatter within them."""
    from scipy.stats import f as ratio

    period = float(target.period)
    index = np.minimum((np.mod(target.phase, period) / period * _BINS).astype(int), _BINS - 1)
    count = np.bincount(index, minlength=_BINS)
    if target.phase[-1] < 2 * period or count.min() < 4:
        return []
    mean = np.bincount(index, rest, _BINS) / count
    within = float(np.sum((rest - mean[index]) ** 2) / (len(rest) - _BINS))
    size = float(np.sum(count * mean**2) / _BINS) / max(within, 1e-300)
    loosened = size / _colour(rest - mean[index])
    return [
        (float(ratio.sf(loosened, _BINS, len(rest) - _BINS)), f"mean over the cycle of the drive {np.sqrt(size):.2g} times that of noise")
    ]


def _halves(phase: Any, rest: Any) -> list[tuple[float, str]]:
    """Sine and cosine of the drive in the first half less those in the second: a phase that slips, a motion that changes."""
    from scipy.stats import chi2

    half = len(rest) // 2
    parts = [np.sum(rest[part] * np.exp(-2j * np.pi * phase[part])) for part in (slice(0, half), slice(half, 2 * half))]
    level = float(np.var(rest)) * _colour(rest)
    size = float(abs(parts[0] - parts[1]) ** 2) / max(half * level, 1e-300)
    chance = float(chi2.sf(2 * size / 2, 2))
    return [(chance, f"first and second half of the record differ at the drive frequency by {np.sqrt(size):.2g} standard errors")]


def _colour(rest: Any) -> float:
    """By how much colour of the noise makes sums scatter more than those of white noise, 1 or more."""
    from stickslip.inverse.identification.covariance import effective

    return float(max(len(rest) / effective(rest), 1.0))
