"""From the raw segments of one motion period to the word for the motion: types, patterns, margins, for many cases at once.

A segment is a duration in drive periods with a code: +2 and -2 slipping forwards and backwards, 0 stuck at v = 0
(set-valued laws), +1 and -1 elastic with v > 0 and v < 0 (dynamic laws, which never rest). What the words mean stands in
docs/quickstart.md and at `stickslip.Motion`; these are the rules:

- consecutive elastic segments count as stuck if together they last at least `dwell`, else each goes with the sign of its v;
- equal neighbours are merged, also across the end of the period;
- the pattern starts at a "+" that follows something else (at a "-" if there is no "+"); if several starts are possible,
  the one whose text sorts first ("+" < "-" < "0") is taken, so that the pattern does not depend on where the period was cut.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

__all__ = ["Intervals", "intervals_of", "type_of"]

Array = Any
_NONE = 9  # no interval
_SHORTEST = 1e-13  # a segment below this is rounding
_SIGNS = {1: "+", 0: "0", -1: "-"}
_TYPES = {"0": "rest", "+0-0": "I", "+0": "II", "-0": "II", "+0-": "III", "+-0": "III", "+-": "IV"}


class Intervals(NamedTuple):
    """The merged intervals of many cases, in the order of their patterns; unused places have sign 9 and length 0."""

    start: Array  # (cases, K) phase at which it begins, in drive periods from the start of the motion period
    length: Array  # (cases, K) in drive periods
    sign: Array  # (cases, K) +1, 0, -1
    pattern: Array  # (cases,) text


def intervals_of(seg_count: Array, seg_time: Array, seg_code: Array, dwell: float) -> Intervals:
    """Merge raw segments into intervals of sliding forwards, being stuck and sliding backwards.

    Parameters
    ----------
    seg_count : array (cases,)
        How many segments each case has; -1 if there were too many to keep.
    seg_time : array (cases, K)
        Durations in drive periods.
    seg_code : array (cases, K)
        Codes +2, +1, 0, -1, -2.
    dwell : float
        How long an elastic run must last to count as stuck, in drive periods.

    Examples
    --------
    >>> raw = np.array([3]), np.array([[0.1, 0.5, 0.4]]), np.array([[2, 0, 2]])
    >>> merged = intervals_of(*raw, dwell=0.03)
    >>> str(merged.pattern[0]), merged.start[0, :2].round(12).tolist(), merged.length[0, :2].round(12).tolist()
    ('+0', [0.6, 0.1], [0.5, 0.5])
    """
    return _intervals(np.asarray(seg_count), seg_time, seg_code, dwell)[0]


def _intervals(count: Array, seg_time: Array, seg_code: Array, dwell: float) -> tuple[Intervals, list[str], Array]:
    """The intervals; the different patterns among them, and which one each case has."""
    K = max(int(count.max(initial=0)), 1)
    time, code, valid = _packed(count, np.asarray(seg_time, float)[:, :K], np.asarray(seg_code, np.int8)[:, :K])
    label = _labels(time, code, valid, dwell)
    return _rotated(*_merged(time, label, valid))


def _packed(count: Array, time: Array, code: Array) -> tuple[Array, Array, Array]:
    """Segments longer than rounding, moved to the front of their rows."""
    valid = (np.arange(time.shape[1]) < count[:, None]) & (time > _SHORTEST)
    order = np.argsort(~valid, axis=1, kind="stable")
    time, code, valid = (np.take_along_axis(a, order, axis=1) for a in (time, code, valid))
    return np.where(valid, time, 0.0), code, valid


def _before(a: Array, count: Array) -> Array:
    """Each entry's predecessor in its row, the last valid one before the first."""
    rolled = np.roll(a, 1, axis=1)
    if a.shape[1]:
        rolled[:, 0] = a[np.arange(len(a)), np.maximum(count, 1) - 1]
    return rolled


def _runs(starts: Array) -> Array:
    """Number (from 1) of the run that each entry belongs to; what precedes the first start belongs to the last run."""
    number = np.cumsum(starts, axis=1)
    return np.where(number == 0, np.maximum(starts.sum(axis=1), 1)[:, None], number)


def _sums(number: Array, weights: Array) -> Array:
    """Sum of the weights of each run: (cases, K + 1), where run 0 is unused."""
    rows, width = len(number), number.shape[1] + 1
    flat = (np.arange(rows)[:, None] * width + number).ravel()
    return np.bincount(flat, weights.ravel(), rows * width).reshape(rows, width)


def _labels(time: Array, code: Array, valid: Array, dwell: float) -> Array:
    """+1, 0, -1 for each segment, with short elastic runs told by the sign of v."""
    elastic = valid & (abs(code) == 1)
    number = _runs(elastic & ~_before(elastic, valid.sum(axis=1)))
    lasting = np.take_along_axis(_sums(number, np.where(elastic, time, 0.0)), number, axis=1)
    return np.where(elastic & (lasting >= dwell), 0, np.sign(code))


def _merged(time: Array, label: Array, valid: Array) -> tuple[Array, Array, Array]:
    """Start, length and sign of each interval, in the order in which they begin."""
    begins = valid & (label != _before(label, valid.sum(axis=1)))
    alone = valid.any(axis=1) & ~begins.any(axis=1)  # one interval fills the whole period
    begins[alone, 0] = True
    number, K = _runs(begins), time.shape[1]
    length = _sums(number, time)[:, 1:]
    start, sign = np.zeros_like(time), np.full(time.shape, _NONE, np.int8)
    rows, cols = np.nonzero(begins)
    place = number[rows, cols] - 1
    start[rows, place] = (np.cumsum(time, axis=1) - time)[rows, cols]
    sign[rows, place] = label[rows, cols]
    return start, np.where(np.arange(K) < begins.sum(axis=1)[:, None], length, 0.0), sign


def _rotated(start: Array, length: Array, sign: Array) -> tuple[Intervals, list[str], Array]:
    """The intervals turned so that each row begins where its pattern begins; the patterns, and which one each row has."""
    distinct, which = _distinct_rows(sign)
    found = [_canonical([int(s) for s in row if s != _NONE]) for row in distinct]
    count, K = (distinct != _NONE).sum(axis=1)[which][:, None], sign.shape[1]
    places = np.arange(K)[None, :]
    shift = np.array([f[1] for f in found], int)[which][:, None]
    order = np.where(places < count, (places + shift) % np.maximum(count, 1), places)
    start, length, sign = (np.take_along_axis(a, order, axis=1) for a in (start, length, sign))
    patterns = [f[0] for f in found]
    return Intervals(start, length, sign, np.array(patterns)[which]), patterns, which


def _distinct_rows(sign: Array) -> tuple[Array, Array]:
    """The different rows of signs, and which one each row is; 32 signs are packed into an integer, two bits each."""
    packed = [np.zeros(len(sign), np.uint64) for _ in range(0, sign.shape[1], 32)]
    for k in range(sign.shape[1]):
        packed[k // 32] |= (sign[:, k] + 1).astype(np.uint64) % np.uint64(7) << np.uint64(2 * (k % 32))
    keys = packed[0] if len(packed) == 1 else np.stack(packed, axis=1)
    _, first, which = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return sign[first], which.ravel()


def _canonical(signs: list[int]) -> tuple[str, int]:
    """The pattern of a cycle of signs, and how far it was turned."""
    text = "".join(_SIGNS[s] for s in signs)
    first = "+" if "+" in text else "-" if "-" in text else "0"
    turns = [(text[i:] + text[:i], i) for i in range(len(text)) if text[i] == first]
    return min(turns) if turns else ("", 0)


def _added(lengths: Array) -> Array:
    """Sum of each row, one after the other: NumPy's own sum depends in its last bit on how wide the batch's longest row made the table."""
    return np.cumsum(lengths, axis=1)[:, -1]


def type_of(
    seg_count: Array,
    seg_time: Array,
    seg_code: Array,
    period: Array,
    margin_force: Array,
    net: Array,
    dwell: float = 0.03,
    moving: Array = True,
    net_floor: float | Array = 0.0,
) -> dict[str, Array]:
    """The motion type of many cases.

    Parameters
    ----------
    seg_count, seg_time, seg_code, dwell
        As in `intervals_of`.
    period : array (cases,) of int
        Period number of each case; 0 where none was found (the type is then judged on the one drive period given).
    margin_force : array (cases,)
        How close the offered force came to break-away, relative; inf if it has no meaning.
    net : array (cases,)
        Net motion over the period, in any unit: only its sign counts.
    moving : array (cases,) of bool
        Whether anything moves at all: tells presliding from rest under a dynamic law.
    net_floor : float
        A net motion up to this size has no direction.

    Returns
    -------
    dict
        motion_type, pattern (text), direction (+1, 0, -1), margin, stick_fraction, forward_fraction, backward_fraction.

    Examples
    --------
    >>> told = type_of([4], [[0.39, 0.17, 0.22, 0.22]], [[2, 0, -2, 0]], [1], [np.inf], [1.0])
    >>> str(told["motion_type"][0]), str(told["pattern"][0]), float(told["margin"][0])
    ('I', '+0-0', 0.17)
    """
    count, net = np.asarray(seg_count), np.asarray(net, float)
    codes = np.asarray(seg_code, np.int8)[:, : max(int(count.max(initial=0)), 1)]
    merged, patterns, which = _intervals(count, seg_time, codes, dwell)
    given = np.arange(codes.shape[1]) < count[:, None]
    sliding = (given & (abs(codes) == 2)).any(axis=1)
    elastic = (given & (abs(codes) == 1)).any(axis=1)
    motion_type = np.array([_TYPES.get(p, "other") for p in patterns], "<U10")[which]
    motion_type[(np.asarray(period) > 1) | (count < 1)] = "other"
    still = (count > 0) & ~sliding
    motion_type[still] = np.where(elastic & np.asarray(moving), "presliding", "rest")[still]
    pattern = np.where(still, "0", merged.pattern)
    direction = np.where(still | ~(abs(net) > net_floor), 0, np.sign(net)).astype(int)
    whole = _added(merged.length)
    fractions = {n: _added(np.where(merged.sign == s, merged.length, 0.0)) for n, s in (("stick", 0), ("forward", 1), ("backward", -1))}
    with np.errstate(invalid="ignore"):
        told = {f"{n}_fraction": value / np.where(whole > 0, whole, np.nan) for n, value in fractions.items()}
    shortest = np.where(merged.sign == _NONE, np.inf, merged.length).min(axis=1, initial=np.inf)
    margin = np.where(whole > 0, np.minimum(shortest, margin_force), np.nan)
    return {"motion_type": motion_type, "pattern": pattern, "direction": direction, "margin": margin, **told}
