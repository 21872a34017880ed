r"""The Coulomb robot on paper: rest, the borders of its motion types, and its exact periodic motion.

Dimensionless: :math:`w' = \sin\tau - r` with :math:`r = \alpha_+` for w > 0 and :math:`-\alpha_-` for w < 0, at rest
while :math:`-\alpha_- \le \sin\tau \le \alpha_+`; :math:`\alpha_\pm = \mu_\pm g/(A\mu\omega^2)` and
:math:`v = A\mu\omega\,w` (Eq. 5.1 for Coulomb friction, Eq. 2.4). The mirror image of a motion has the two alphas exchanged
and w turned.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stickslip.analysis.phases import three_phase as three_phase, two_phase as two_phase
from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.maths import bisected

_PERIODS = 100_000  # at most; only with static friction, or next to frictionless, are more than ten needed
_CHUNK = 1 << 16  # cases at a time, so that a large map needs little memory


def _checked(*alphas: Array) -> list[Array]:
    """The alphas as arrays of one shape."""
    arrays = list(np.broadcast_arrays(*(np.asarray(a, float) for a in alphas)))
    if not all(np.all(a >= 0) for a in arrays):
        raise InputError("alpha", ["negative or not a number; allowed is zero or more: a body that slides down by itself has no period"])
    return arrays


def stays_at_rest(alpha_plus: Array, alpha_minus: Array) -> Array:
    """Whether the body stays at rest for ever: both alphas at least 1.

    Examples
    --------
    >>> stays_at_rest(1.0, [0.99, 1.0]).tolist()
    [False, True]
    """
    return (np.asarray(alpha_plus) >= 1) & (np.asarray(alpha_minus) >= 1)


# ---- type IV: never at rest ----
def _reversals(plus: Array, minus: Array) -> tuple[Array, Array, Array, Array]:
    """-cos(delta) and sin(tau) in the middle of the forward slide, at its start and at its end, of the motion that never rests."""
    total = np.where(plus + minus > 0, plus + minus, 1.0)
    share = np.where(plus + minus > 0, minus / total, 0.5)  # delta/pi
    lean = np.sin(0.5 * np.pi * (minus - plus) / total)
    middle = np.where(share < 0.5, plus / np.sinc(share), minus / np.sinc(1 - share))  # kappa/sin(delta), also where it is 0/0
    with np.errstate(invalid="ignore"):
        swing = np.sqrt((1 - middle) * (1 + middle)) * np.sin(np.pi * np.minimum(share, 1 - share))
    return lean, middle, swing - middle * lean, -swing - middle * lean


def mean_without_rest(alpha_plus: Array, alpha_minus: Array) -> Array:
    r"""Mean velocity of type IV, in w.

    .. math:: \bar w = -\cos\delta\,\sqrt{1-(\kappa/\sin\delta)^2}, \ \delta = \pi\alpha_-/(\alpha_++\alpha_-), \ \kappa = \alpha_+\delta

    It slides forwards for :math:`\alpha_-/(\alpha_++\alpha_-)` of the period. NaN where no such motion exists; beyond the
    border of type IV (`border_iii_iv`) it is not the motion of the robot.

    Examples
    --------
    >>> round(float(mean_without_rest(0.4, 0.5)), 15)
    0.122475359974498
    """
    lean, middle, _, _ = _reversals(*_checked(alpha_plus, alpha_minus))
    with np.errstate(invalid="ignore"):
        return lean * np.sqrt((1 - middle) * (1 + middle))


def border_iii_iv(ratio: Array) -> Array:
    r"""The smaller alpha on the border of types III and IV, for k = larger/smaller.

    .. math:: \alpha_+ = \frac{\sin\delta}{\sqrt{\delta^2+(1-\delta\cot\delta)^2}}, \qquad \delta = \frac{\pi k}{1+k}

    Below it the body never rests.

    Parameters
    ----------
    ratio : array
        k, the larger alpha over the smaller one, from 1.

    Examples
    --------
    >>> border_iii_iv([1.0, 2.0]).round(15).tolist()
    [0.537029272146315, 0.284485276155916]
    """
    k = np.asarray(ratio, float)
    sine, delta = np.sin(np.pi / (1 + k)), np.pi * k / (1 + k)
    return sine / np.sqrt(delta**2 + (1 + delta * np.cos(np.pi / (1 + k)) / sine) ** 2)


# ---- types with rest: the forward slide begins at asin(alpha_plus) ----
def first_slide(plus: Array, minus: Array) -> Array:
    """Velocity at which a slide from break-away meets the phase of break-away on the other side; not above 0: it has come to rest (I)."""
    return np.sqrt((1 - plus) * (1 + plus)) + np.sqrt((1 - minus) * (1 + minus)) - plus * (np.pi + np.arcsin(minus) - np.arcsin(plus))


def long_slide(plus: Array, minus: Array) -> Array:
    """Velocity of the same slide when the other side can hold again; at least 0: it passes over all of it (II)."""
    return np.sqrt((1 - plus) * (1 + plus)) - np.sqrt((1 - minus) * (1 + minus)) - plus * (2 * np.pi - np.arcsin(minus) - np.arcsin(plus))


def _root(f: Callable[[Array], Array], low: Array, high: Array) -> Array:
    """Where a falling f is zero, by halving to the last bit."""
    low, high = bisected(lambda a: f(a) > 0, np.array(low, float), np.array(high, float), 80)
    return 0.5 * (low + high)


def border_i_iii(ratio: Array) -> Array:
    r"""The smaller alpha a on the border of types I and III, for k = larger/smaller.

    .. math:: \sqrt{1-a^2}+\sqrt{1-k^2a^2} = a\,(\pi+\arcsin ka-\arcsin a)

    Above it the body rests twice in each period. NaN where no border exists (k so large that ka would exceed 1, type II).

    Examples
    --------
    >>> round(float(border_i_iii(2.0)), 15)
    0.406899269748192
    """
    k = np.asarray(ratio, float)
    a = _root(lambda a: first_slide(a, np.minimum(k * a, 1.0)), np.zeros_like(k), 1 / k)
    return np.where(first_slide(1 / k, np.ones_like(k)) <= 0, a, np.nan)


def border_ii_i() -> float:
    """The larger alpha on the border of types II and I (II and III where the smaller one is below `border_ii_iii(1)`): 1.

    Examples
    --------
    >>> border_ii_i()
    1.0
    """
    return 1.0


def border_ii_iii(larger: ArrayLike) -> Array:
    r"""The smaller alpha on the border of types II and III, for a larger one up to 1.

    .. math:: \sqrt{1-\alpha_+^2}-\sqrt{1-\alpha_-^2} = \alpha_+\,(2\pi-\arcsin\alpha_--\arcsin\alpha_+)

    Below it one long slide passes over the whole interval in which the body could break away backwards.

    Examples
    --------
    >>> round(float(border_ii_iii(0.9)), 15), round(float(border_ii_iii(1.0)), 7)
    (0.110433505278347, 0.2172336)
    """
    minus = np.asarray(larger, float)
    return _root(lambda a: long_slide(a, minus), np.zeros_like(minus), minus)


def coulomb_type(alpha_plus: Array, alpha_minus: Array) -> Array:
    """Motion type by the borders alone: "rest", "I", "II", "III" or "IV"; break-away is at the sliding friction.

    Examples
    --------
    >>> coulomb_type([0.5, 0.7, 0.4, 0.4, 1.0], [1.2, 0.9, 0.8, 0.5, 2.0]).tolist()
    ['II', 'I', 'III', 'IV', 'rest']
    """
    plus, minus = _checked(alpha_plus, alpha_minus)
    small, large = np.minimum(plus, minus), np.maximum(plus, minus)
    cut = np.minimum(small, 1.0), np.minimum(large, 1.0)
    never = _never_rests(small, large, small, large)
    kinds = [stays_at_rest(small, large), never, large >= 1, long_slide(*cut) >= 0, first_slide(*cut) <= 0]
    return np.select(kinds, ["rest", "IV", "II", "II", "I"], "III")


def _never_rests(plus: Array, minus: Array, hold_plus: Array, hold_minus: Array) -> Array:
    """Whether the motion without rest exists: it must turn where the static friction cannot hold."""
    _, middle, start, end = _reversals(plus, minus)
    with np.errstate(invalid="ignore"):
        return (middle <= 1) & (start >= hold_plus) & (end <= -hold_minus)


# ---- the periodic motion ----
@sealed
@dataclass(frozen=True, eq=False)
class Periodic:
    """The periodic motion of many Coulomb robots; every field has their common shape.

    Parameters
    ----------
    mean : array
        Mean velocity over the period, in w = v/(A mu omega); NaN where the motion did not repeat.
    forward, stick, backward : array
        Fractions of the period; NaN where the motion did not repeat.
    type : array of str
        "rest", "I", "II", "III", "IV" or "other".
    """

    mean: Array
    forward: Array
    stick: Array
    backward: Array
    type: Array


def periodic(alpha_plus: Array, alpha_minus: Array, static: tuple[Array, Array] | None = None, workers: int = 1) -> Periodic:
    """The exact periodic motion: by formula where the body never rests, else by its arcs (a rest forgets what was before it).

    Parameters
    ----------
    alpha_plus, alpha_minus : array
        Sliding friction over drive force, forwards and backwards, in any order of size; they broadcast.
    static : tuple of two arrays, optional
        The same for break-away, if it is higher. Then two motions can live side by side; this is the one that starts from rest,
        and next to frictionless it may need more periods than are run: NaN. Where it is no higher the formula holds.
    workers : int
        Threads.

    Examples
    --------
    >>> p = periodic([0.5, 0.7], [1.2, 0.9])
    >>> p.mean.round(13).tolist(), p.type.tolist(), p.forward.round(10).tolist()
    ([0.2014522033337, 0.0615227380298], ['II', 'I'], [0.5241295584, 0.3890396524])
    >>> round(float(periodic(0.5, 1.2, static=(0.8, 1.4)).mean), 12)
    0.170822286993
    """
    parts = (alpha_plus, alpha_minus, *(static if static is not None else (alpha_plus, alpha_minus)))
    plus, minus, hold_plus, hold_minus = _checked(*parts)
    share = np.where(plus + minus > 0, minus / np.where(plus + minus > 0, plus + minus, 1.0), 0.5)
    never = _never_rests(plus, minus, hold_plus, hold_minus) & (hold_plus == plus) & (hold_minus == minus)
    result = {
        "mean": np.where(never, mean_without_rest(plus, minus), 0.0),
        "forward": np.where(never, share, 0.0),
        "stick": np.where(never, 0.0, 1.0),
        "backward": np.where(never, 1 - share, 0.0),
        "type": np.where(never, "IV", "rest").astype("<U10"),
    }
    halting = ~never & ~stays_at_rest(hold_plus, hold_minus)
    if halting.any():
        zero = np.zeros(plus.shape)
        rows = np.stack([a[halting] for a in (plus, minus, hold_plus, hold_minus, zero, zero)], axis=1)
        for name, values in _by_arcs(rows, workers).items():
            result[name][halting] = values
    return Periodic(**result)


def _by_arcs(rows: Array, workers: int) -> dict[str, Array]:
    """Periodic motions from the mode machine, started at rest."""
    from stickslip.results.segments import type_of
    from stickslip.solvers.set_valued import solve_rows

    parts = []
    for i in range(0, len(rows), _CHUNK):
        raw = solve_rows(np.ascontiguousarray(rows[i : i + _CHUNK]), _PERIODS, "auto", workers)
        types = type_of(raw["seg_count"], raw["seg_time"], raw["seg_code"], raw["period"], raw["margin_force"], raw["displacement"])
        numbers = (
            raw["displacement"] / (2 * np.pi * raw["window"]),
            *(types[f"{name}_fraction"] for name in ("forward", "stick", "backward")),
        )
        repeats = raw["period"] > 0
        parts.append((*(np.where(repeats, n, np.nan) for n in numbers), np.where(repeats, types["motion_type"], "other")))
    return {name: np.concatenate(column) for name, column in zip(Periodic.__dataclass_fields__, zip(*parts, strict=True), strict=True)}
