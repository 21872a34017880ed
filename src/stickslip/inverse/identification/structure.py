"""What is left of a record where a wrong law or drive must show.

Of a shaken robot that is at multiples of the drive, over its cycle, and from half to half of the record; of a force or a torque over a
motion it is over velocities, over places, after reversals, and from half to half.

Each test gives a probability under noise, whose size is that of what is left away from where the structure would stand; its colour,
what noise of the motion makes, and rounding of the values to counts, which stays the same while they rest, are allowed for. Where values
stand is judged by what their own noise does not move: by the motion over which a force was measured, by the model's of an angle. The
smallest probability is held against the level divided by the number of tests (Bonferroni), so that a record by the right law is blamed
once in five hundred.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.inverse.identification.covariance import effective
from stickslip.inverse.identification.fit_text import OVER_MOTION
from stickslip.inverse.identification.rounding import beside_white

_LEVEL = 2e-3  # of all tests of a record together
_LINES = 8  # multiples of the drive
_BINS = 24  # of a cycle
_VELOCITIES, _PLACES = 16, 8  # bins of equal count
_AFTER = (0.01, 0.03, 0.1, 0.3)  # parts of the usual way between reversals, from one of which on a bin begins
_ENOUGH, _LEAST = 60, 4  # values, and values in a bin


@dataclass(frozen=True, eq=False)
class Structure:
    """One place where structure may stand.

    Parameters
    ----------
    said : str
    chance : float
        How often noise alone leaves as much.
    basis : array (values, directions)
        Where it stands, orthonormal columns.
    power : float
        Mean square of what is left along each of these directions, less that of noise.
    """

    said: str
    chance: float
    basis: Any
    power: float


@dataclass(frozen=True, eq=False)
class Left:
    """What a fit leaves of a record, and what of it is noise that is not white, all in standard deviations.

    Parameters
    ----------
    met : array (values,)
        The values of the model, in the unit of the record.
    rest : array (values,)
        What is left.
    which : array (values,) of bool
        The values that count.
    inputs : array (values, repetitions)
        What other noise of the motion would leave.
    rounded : array (values, directions)
        What rounding leaves (`rounding_columns`).
    """

    met: Any
    rest: Any
    which: Any
    inputs: Any
    rounded: Any

    def of(self, which: Any) -> Left:
        """That of some values."""
        return Left(*(each[which] for each in (self.met, self.rest, self.which, self.inputs, self.rounded)))


def structures(target: Any, left: Left) -> list[Structure]:
    """The structure in the residuals of a record, the least likely first; empty where there is none, or no test for it."""
    over_motion = target.kind in OVER_MOTION
    which = left.which & (left.rest != 0) if over_motion else left.which  # a contact that is held bears what was measured
    if int(which.sum()) < _ENOUGH or target.within > 0 or target.kind == "mean":
        return []
    here = left.of(which)
    if over_motion:
        made = _over_motion(*(each[which] for each in target.moved(left.met)))
    else:
        made = _in_phase(target.phase[which], float(target.period))
    tests = [_tested(basis, here, said) for basis, said in made]
    tests += [] if over_motion else _lines(target.phase[which], here.rest)
    clear = sorted((one for one in tests if one.chance * len(tests) < _LEVEL), key=lambda one: one.chance)
    return [Structure(one.said, one.chance, _spread_out(one.basis, which), one.power) for one in clear]


def _spread_out(basis: Any, which: Any) -> Any:
    """A basis of some values as one of all."""
    whole = np.zeros((len(which), basis.shape[1]))
    whole[which] = basis
    return whole


def _tested(basis: Any, left: Left, said: str) -> Structure:
    """What is left along some directions beside what is left elsewhere."""
    from scipy.stats import f as ratio

    n, d = basis.shape
    along = basis.T @ left.rest
    away = left.rest - basis @ along
    power, within = float(along @ along) / d, max(float(away @ away) / (n - d), 1e-300)
    white = beside_white(left.rounded, within)[1] if left.rounded.shape[1] else within
    moved = basis.T @ np.concatenate([left.rounded, left.inputs / np.sqrt(max(left.inputs.shape[1], 1))], axis=1)
    noise = white * max(n / effective(away, left.rounded), 1.0) * np.eye(d) + moved @ moved.T
    usual = float(np.trace(noise)) / d
    free = float(np.trace(noise) ** 2 / np.sum(noise**2))  # as many directions of equal noise would scatter alike (Satterthwaite)
    words = said.format(np.sqrt(power / within))
    return Structure(words, float(ratio.sf(power / usual, free, n - d)), basis, max(power - usual, 0.0))


def _bins(index: Any) -> Any:
    """Directions along which all values of a bin are the same; None where there are fewer than two bins with values enough."""
    numbers, index, count = np.unique(index, return_inverse=True, return_counts=True)
    kept = count >= _LEAST
    if kept.sum() < 2:
        return None
    return (index[:, None] == np.arange(len(numbers))[kept]) / np.sqrt(count[kept])


def _unit(columns: Any) -> Any:
    """Orthonormal directions that span some columns."""
    return np.linalg.qr(np.stack(columns, axis=1))[0]


# ---- steady motion of a drive ----
def _in_phase(phase: Any, period: float) -> Iterator[tuple[Any, str]]:
    """The mean over the cycle of the motion, and a phase that slips or a motion that changes from half to half."""
    index = np.minimum((np.mod(phase, period) / period * _BINS).astype(int), _BINS - 1)
    if phase[-1] >= 2 * period and np.bincount(index, minlength=_BINS).min() >= _LEAST:
        yield _bins(index), "mean over the cycle of the drive {:.2g} times that of noise"
    side = np.where(np.arange(len(phase)) < len(phase) // 2, 1.0, -1.0)
    turn = 2 * np.pi * phase
    said = "first and second half of the record differ at the drive frequency by {:.2g} standard errors"
    yield _unit([side * np.cos(turn), side * np.sin(turn)]), said


def _lines(phase: Any, rest: Array) -> list[Structure]:
    """Amplitudes at multiples of the drive, beside those at frequencies around them (colour of the noise)."""
    from scipy.stats import f as ratio

    periods = float(phase[-1] - phase[0])
    if periods < 6:
        return []
    away = np.concatenate([-np.arange(2, 8), np.arange(2, 8)]) / periods
    lines = []
    for n in range(1, min(_LINES, int(0.4 * len(rest) / periods)) + 1):
        here, around = _power(phase, rest, n), np.array([_power(phase, rest, n + d) for d in away if n + d > 0])
        usual = max(float(np.mean(around)), 1e-300)
        said = f"{_ordinal(n)} harmonic of the drive left at {np.sqrt(2 * here / usual):.2g} standard errors"
        basis = _unit([np.cos(2 * np.pi * n * phase), np.sin(2 * np.pi * n * phase)])
        along = basis.T @ rest
        power = max(float(along @ along) / 2 * (1 - usual / here), 0.0) if here > 0 else 0.0
        lines.append(Structure(said, float(ratio.sf(here / usual, 2, 2 * len(around))), basis, power))
    return lines


def _power(phase: Any, rest: Array, n: float) -> float:
    return float(abs(np.sum(rest * np.exp(-2j * np.pi * n * phase))) ** 2)


def _ordinal(n: int) -> str:
    return {1: "first", 2: "second", 3: "third"}.get(n, f"{n}th")


# ---- forces over a motion ----
def _over_motion(t: Any, x: Any, v: Any) -> Iterator[tuple[Any, str]]:
    """Means over velocities, over places in either direction, after reversals, and halves of the record."""
    forwards = _last_way(v) > 0
    bases = [
        (_bins(_ranked(v, _VELOCITIES)), "mean over velocities {:.2g} times that of noise"),
        (_bins(2 * _ranked(x, _PLACES) + forwards), "mean over places {:.2g} times that of noise"),
    ]
    turns = np.flatnonzero(np.diff(forwards)) + 1
    if len(turns) > 1:
        first = np.maximum.accumulate(np.where(np.isin(np.arange(len(x)), turns), np.arange(len(x)), 0))
        way = abs(x - x[first]) / (float(np.median(abs(np.diff(x[turns])))) or 1.0)
        bases.append((_bins(2 * np.searchsorted(_AFTER, way) + forwards), "mean after reversals {:.2g} times that of noise"))
    for basis, said in bases:
        if basis is not None:
            yield basis, said
    side = np.where(np.arange(len(t)) < len(t) // 2, 1.0, -1.0)
    both = [side, side * np.where(forwards, 1.0, -1.0)]
    yield (
        _unit(both if 0 < forwards.sum() < len(forwards) else both[:1]),
        "first and second half of the record differ by {:.2g} standard errors",
    )


def _last_way(v: Any) -> Any:
    """The sign of a velocity, while it rests the last one that it had: array (n,)."""
    moving = np.maximum.accumulate(np.where(v != 0, np.arange(len(v)), 0))
    return np.sign(v[moving])


def _ranked(values: Any, bins: int) -> Any:
    """In which of some bins of equal count values are."""
    return np.searchsorted(np.quantile(values, np.arange(1, bins) / bins), values)
