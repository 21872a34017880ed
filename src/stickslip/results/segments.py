"""From the raw segments of one motion period to the word for the motion: types, patterns, margins, for many cases at once.

A segment is a duration in drive periods with a code: +2 and -2 slipping forwards and backwards, 0 stuck at v = 0
(set-valued laws), +1 and -1 elastic with v > 0 and v < 0 (dynamic laws, which never rest). What the words mean stands in
docs/quickstart.md and at `stickslip.analysis.Motion`; these are the rules:

- consecutive elastic segments count as stuck if together they last at least `dwell`, else each goes with the sign of its v;
- equal neighbours are merged, also across the end of the period;
- the pattern starts at a "+" that follows something else (at a "-" if there is no "+"); if several starts are possible,
  the one whose text sorts first ("+" < "-" < "0") is taken, so that the pattern does not depend on where the period was cut.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stickslip.basics.coded_words import CodedWords
from stickslip.basics.contracts import Array, ArrayLike

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


def _intervals(count: Array, seg_time: Array, seg_code: Array, dwell: float) -> tuple[Intervals, list[str], Array, Array]:
    """The intervals; the different patterns among them, and which one each case has; how near an elastic run came to `dwell`."""
    K = max(int(count.max(initial=0)), 1)
    time, code, valid = _packed(count, np.asarray(seg_time, float)[:, :K], np.asarray(seg_code, np.int8)[:, :K])
    label, nearest = _labels(time, code, valid, dwell)
    return *_rotated(*_merged(time, label, valid)), nearest


# From here on each case is a column: NumPy works along rows as long as the batch, not along many short ones.


def _packed(count: Array, time: Array, code: Array) -> tuple[Array, Array, Array]:
    """Segments longer than rounding, moved to the front, (K, cases)."""
    time, code = np.ascontiguousarray(time.T), np.ascontiguousarray(code.T)
    valid = (np.arange(len(time))[:, None] < count) & (time > _SHORTEST)
    if (valid[1:] & ~valid[:-1]).any():
        order = np.argsort(~valid, axis=0, kind="stable")
        time, code, valid = (np.take_along_axis(a, order, axis=0) for a in (time, code, valid))
    return np.where(valid, time, 0.0), code, valid


def _before(a: Array, count: Array) -> Array:
    """Each entry's predecessor in its case, the last valid one before the first."""
    rolled = np.roll(a, 1, axis=0)
    rolled[0] = a[np.maximum(count, 1) - 1, np.arange(a.shape[1])]
    return rolled


def _added_up(rows: Array, kind: type) -> Array:
    """Sums of the rows up to each one: row by row, because NumPy's own goes down each short column by itself."""
    total: Array = rows.astype(kind)
    for k in range(1, len(total)):
        total[k] += total[k - 1]
    return total


def _runs(starts: Array) -> Array:
    """Number (from 1) of the run that each entry belongs to; what precedes the first start belongs to the last run."""
    number = _added_up(starts, np.int64)
    return np.where(number == 0, np.maximum(number[-1], 1), number)


def _sums(number: Array, weights: Array) -> Array:
    """Sum of the weights of each run: (K + 1, cases), where run 0 is unused."""
    height, cases = len(number) + 1, number.shape[1]
    flat = (number * cases + np.arange(cases)).ravel()
    return np.bincount(flat, weights.ravel(), height * cases).reshape(height, cases)


def _labels(time: Array, code: Array, valid: Array, dwell: float) -> tuple[Array, Array]:
    """+1, 0, -1 for each segment, with short elastic runs classified by the sign of v; and how near one of them came to `dwell`."""
    elastic = valid & (abs(code) == 1)
    if not elastic.any():
        return np.sign(code), np.full(time.shape[1], np.inf)
    number = _runs(elastic & ~_before(elastic, valid.sum(axis=0)))
    lasting = np.take_along_axis(_sums(number, np.where(elastic, time, 0.0)), number, axis=0)
    nearest = np.where(elastic, abs(lasting - dwell), np.inf).min(axis=0)
    return np.where(elastic & (lasting >= dwell), 0, np.sign(code)), nearest


def _merged(time: Array, label: Array, valid: Array) -> tuple[Array, Array, Array]:
    """Start, length and sign of each interval, in the order in which they begin."""
    begins = valid & (label != _before(label, valid.sum(axis=0)))
    begins[0] |= valid[0] & ~begins.any(axis=0)  # one interval fills the whole period
    number, K = _runs(begins), len(time)
    length = _sums(number, time)[1:]
    start, sign = np.zeros_like(time), np.full(time.shape, _NONE, np.int8)
    rows, cols = np.nonzero(begins)
    position = number[rows, cols] - 1
    start[position, cols] = (_added_up(time, np.float64) - time)[rows, cols]
    sign[position, cols] = label[rows, cols]
    return start, np.where(np.arange(K)[:, None] < begins.sum(axis=0), length, 0.0), sign


def _rotated(start: Array, length: Array, sign: Array) -> tuple[Intervals, list[str], Array]:
    """The intervals turned so that each case begins where its pattern begins; the patterns, and which one each case has."""
    distinct, which = _distinct(sign)
    canonical = [_canonical([int(s) for s in case if s != _NONE]) for case in distinct.T]
    count, shift = (distinct != _NONE).sum(axis=0), np.array([f[1] for f in canonical], int)
    turned = np.flatnonzero(shift[which])
    places = np.arange(len(sign))[:, None]
    order = np.where(places < count, (places + shift) % np.maximum(count, 1), places)[:, which[turned]]
    for a in (start, length, sign):
        a[:, turned] = a[order, turned]
    patterns = [f[0] for f in canonical]
    return Intervals(start.T, length.T, sign.T, np.array(patterns)[which]), patterns, which


def _distinct(sign: Array) -> tuple[Array, Array]:
    """The different columns of signs, and which one each case has; 32 signs are packed into an integer, two bits each."""
    packed = [np.zeros(sign.shape[1], np.uint64) for _ in range(0, len(sign), 32)]
    for k in range(len(sign)):
        packed[k // 32] |= (sign[k] + 1).astype(np.uint64) % np.uint64(7) << np.uint64(2 * (k % 32))
    keys = packed[0] if len(packed) == 1 else np.stack(packed, axis=1)
    _, first, which = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return sign[:, first], which.ravel()


def _canonical(signs: list[int]) -> tuple[str, int]:
    """The pattern of a cycle of signs, and how far it was turned."""
    text = "".join(_SIGNS[s] for s in signs)
    first = "+" if "+" in text else "-" if "-" in text else "0"
    turns = [(text[i:] + text[:i], i) for i in range(len(text)) if text[i] == first]
    return min(turns) if turns else ("", 0)


def _added(lengths: Array) -> Array:
    """Sum of each row, one after the other: NumPy's own sum depends in its last bit on how wide the batch's longest row made the table."""
    total = np.zeros(len(lengths))
    for column in lengths.T:
        total += column
    return total


def type_of(
    seg_count: ArrayLike,
    seg_time: ArrayLike,
    seg_code: ArrayLike,
    period: ArrayLike,
    margin_force: ArrayLike,
    net: ArrayLike,
    dwell: float = 0.03,
    moving: ArrayLike = True,
    net_floor: ArrayLike = 0.0,
) -> dict[str, Any]:
    """The motion type of many cases.

    Parameters
    ----------
    seg_count, seg_time, seg_code, dwell
        As in `intervals_of`.
    period : array (cases,) of int
        Period number of each case; 0 where none was found (the type is then judged on the one drive period given).
    margin_force : array (cases,)
        Smallest relative distance of the net applied force from break-away; inf if it has no meaning.
    net : array (cases,)
        Net motion over the period, in any unit: only its sign counts.
    moving : array (cases,) of bool
        Whether anything moves at all: tells presliding from rest under a dynamic law.
    net_floor : float
        A net motion up to this size has no direction.

    Returns
    -------
    dict
        motion_type, pattern (as `CodedWords`), direction (+1, 0, -1), margin, stick_fraction, forward_fraction, backward_fraction. The
        margin is `margin_force` or the length of the shortest interval, if that is less; of an elastic run it is how far it lasts from
        `dwell`.

    Examples
    --------
    >>> types = type_of([4], [[0.39, 0.17, 0.22, 0.22]], [[2, 0, -2, 0]], [1], [np.inf], [1.0])
    >>> str(types["motion_type"][0]), str(types["pattern"][0]), float(types["margin"][0])
    ('I', '+0-0', 0.17)
    """
    count, net = np.asarray(seg_count), np.asarray(net, float)
    codes = np.asarray(seg_code, np.int8)[:, : max(int(count.max(initial=0)), 1)]
    merged, patterns, which, nearest = _intervals(count, np.asarray(seg_time), codes, dwell)
    size = np.where(np.arange(codes.shape[1])[:, None] < count, abs(codes.T), 0)
    sliding, elastic = (size == 2).any(axis=0), (size == 1).any(axis=0)
    still, words = (count > 0) & ~sliding, tuple(dict.fromkeys(("other", "presliding", *_TYPES.values())))
    motion_type = np.array([words.index(_TYPES.get(p, "other")) for p in patterns], np.int8)[which]
    motion_type[(np.asarray(period) > 1) | (count < 1)] = words.index("other")
    motion_type[still] = np.where(elastic & np.asarray(moving), words.index("presliding"), words.index("rest"))[still]
    pattern = np.where(still, len(patterns), which).astype(np.min_scalar_type(len(patterns)))
    direction = np.where(still | ~(abs(net) > np.asarray(net_floor)), 0, np.sign(net)).astype(int)
    whole = _added(merged.length)
    fractions = {n: _added(np.where(merged.sign == s, merged.length, 0.0)) for n, s in (("stick", 0), ("forward", 1), ("backward", -1))}
    with np.errstate(invalid="ignore"):
        shares = {f"{n}_fraction": value / np.where(whole > 0, whole, np.nan) for n, value in fractions.items()}
    judged = (merged.sign != _NONE) & ((merged.sign != 0) | ~elastic[:, None])  # elastic rests are judged against dwell
    shortest = np.where(judged, merged.length, np.inf).T.min(axis=0, initial=np.inf)
    margin = np.where(whole > 0, np.minimum(np.minimum(shortest, nearest), margin_force), np.nan)
    coded = {"motion_type": CodedWords(motion_type, words), "pattern": CodedWords(pattern, (*patterns, "0"))}
    return {**coded, "direction": direction, "margin": margin, **shares}
