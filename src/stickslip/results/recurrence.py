"""Whether the strobe points of a motion repeat, and their limit: one test for single runs and, compiled, for batches.

Strobe points are rows of x and the state, one for each drive period, in an array that is written round and round: point n stands
in row n modulo its length. Scales are the size of each state and then, of each, the length after which it comes again, as an angle does
after a turn; 0 where it does not.

Near a flip points 2p apart agree long before points p apart do, and beside a fold every point agrees with the next one while all of
them still drift. So a distance alone decides nothing: what counts is the distance that is left, by the ratio at which the motion
closes in.

The functions are plain loops on numbers; `engine` compiles this text as it stands (see ``engine/texts.py``).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

LONGEST = 16  # largest period number that is looked for
KEPT = 3 * LONGEST  # strobe points that this takes
STEADY = 1e-6  # of the mean velocity: what may be missing from one that counts as steady
#: A ratio above this is taken for none: noise, or a drift without an end in sight.
STILL = 0.999
#: So many periods in a row say enough; after fewer, the last change must be far below the tolerance: slow decay may hide behind fast.
_LONG = 16
_HIDDEN, _HIDDEN_TWINS = 0.1, 1e-3
_JITTER = 0.1  # of the tolerance: changes without a direction may be as large
_DIRECTED = 0.8  # a correlation of successive changes beyond this is a direction
_APART = 4.0  # times what is left of an approach: points of a period of its own are further apart
_ROUNDING = 1e-14  # in scales: a swing as small as this is one of the last digits, which may alternate for ever


def scales_of(sizes: Any, lengths: Any = 0.0) -> Any:
    """The scales of states with these sizes and the lengths after which they come again, 0 or infinite where they do not.

    Examples
    --------
    >>> scales_of([0.1, 2.0], [0.0, np.inf]).tolist()
    [0.1, 2.0, 0.0, 0.0]
    """
    sizes, lengths = np.broadcast_arrays(np.asarray(sizes, float), np.asarray(lengths, float))
    return np.concatenate([sizes, np.where(np.isfinite(lengths), lengths, 0.0)])


def difference(a: float, b: float, size: float, length: float) -> float:
    """One state less another, in its scale; of one that comes again after a length, modulo that."""
    way = a - b
    if length > 0.0:
        way -= length * math.floor(way / length + 0.5)
    return way / size


def apart(points: Any, last: int, p: int, k: int, scale: Any) -> float:
    """Distance, in scales, of the p points up to `last` from those k times p periods before; infinite where one is not a number."""
    rows, states, worst = len(points), len(scale) // 2, 0.0
    new, old = last % rows, (last - k * p) % rows
    for j in range(p):
        a, b = new - j if j <= new else new - j + rows, old - j if j <= old else old - j + rows
        for i in range(states):
            distance = abs(difference(points[a, 1 + i], points[b, 1 + i], scale[i], scale[states + i]))
            if not distance < float("inf"):
                return float("inf")
            worst = max(worst, distance)
    return worst


def stretch(points: Any, last: int, count: int, p: int, scale: Any, tolerance: float) -> int:
    """For how many times p periods back the points stay within a tolerance of the last p; at most half of the `count` points before."""
    m = 0
    while 2 * (m + 1) * p + p - 1 <= count and apart(points, last, p, m + 1, scale) <= tolerance:
        m += 1
    return m


def closing(points: Any, last: int, p: int, m: int, scale: Any) -> tuple[float, float]:
    """How far m times p periods have moved the motion, and the ratio of that to what the m times p periods before did."""
    late, early = 0.0, 0.0
    for k in range(1, m + 1):
        late = max(late, apart(points, last, p, k, scale))
        early = max(early, apart(points, last - m * p, p, k, scale))
    if late == 0.0:
        return 0.0, 0.0
    return late, late / early if early > 0.0 else float("inf")


def dying(points: Any, last: int, p: int, m: int, scale: Any) -> bool:
    """Whether a motion that seems to repeat after p drive periods swings ever closer around one that repeats after a part of p.

    Then the distance of points that far apart shrinks with all else, and its limit is zero; of a motion of period p it is not. Spirals
    close in unevenly, but there points a part of p apart are not much further from each other than those p apart.
    """
    late, ratio = closing(points, last, p, m, scale)
    ratio = min(ratio, STILL)
    for q in range(1, p // 2 + 1):
        if p % q == 0:
            swing, before = apart(points, last, q, 1, scale), apart(points, last - m * p, q, 1, scale)
            if swing <= _APART * late or swing - (before - swing) * ratio / (1.0 - ratio) < 0.5 * swing:
                return True
    return False


def heading(points: Any, last: int, p: int, m: int, scale: Any) -> float:
    """Correlation of one change over p periods with the next: +1 where a motion drifts, -1 where it swings, -1/2 of independent errors."""
    rows, states, both, new_squares, old_squares = len(points), len(scale) // 2, 0.0, 0.0, 0.0
    for j in range((2 * m - 1) * p):
        for i in range(states):
            middle, size, length = points[(last - j - p) % rows, 1 + i], scale[i], scale[states + i]
            new = difference(points[(last - j) % rows, 1 + i], middle, size, length)
            old = difference(middle, points[(last - j - 2 * p) % rows, 1 + i], size, length)
            both += new * old
            new_squares += new * new
            old_squares += old * old
    product = (new_squares * old_squares) ** 0.5
    return both / product if product > 0.0 else 0.0


def exact(points: Any, last: int, count: int, longest: int, scale: Any, tolerance: float) -> int:
    """After how many drive periods the last point comes again for ever, 0 if it is new: from the same numbers the same motion.

    What goes round among numbers that are far nearer to each other than the tolerance has the period with which these come nearly again.
    """
    whole, most = 1, min(longest, (count + 1) // 2)
    while whole <= most and (apart(points, last, 1, whole, scale) > 0.0 or apart(points, last, whole, 1, scale) > 0.0):
        whole += 1
    if whole > most:
        return 0
    for p in range(1, whole):
        if whole % p == 0:
            worst = 0.0
            for j in range(whole):
                worst = max(worst, apart(points, last - j, 1, p, scale))
            if worst <= max(_ROUNDING, _JITTER * tolerance):
                return p
    return whole


def period_number(points: Any, last: int, count: int, longest: int, scale: Any, tolerance: float, left: float) -> tuple[int, int]:
    """Smallest p such that the motion repeats after p drive periods, and m: it closed in for 2m times p; (0, 0) if it does not.

    The points must agree within `tolerance`, and what is left of a geometric approach must be at most `left`. `count` points before
    the last one are known.
    """
    p = exact(points, last, count, longest, scale, tolerance)
    if p > 0:
        return p, stretch(points, last, count, p, scale, 0.0)
    for p in range(1, longest + 1):
        if 2 * p - 1 > count:
            break
        if apart(points, last, 1, p, scale) > tolerance:
            continue
        if 3 * p - 1 > count:  # seen once only: exactly, or not at all
            if apart(points, last, p, 1, scale) <= _HIDDEN_TWINS * tolerance:
                return p, 0
            continue
        m = stretch(points, last, count, p, scale, tolerance)
        if m == 0:
            continue
        late, ratio = closing(points, last, p, m, scale)
        turn = heading(points, last, p, m, scale)
        if late <= _ROUNDING and turn <= _DIRECTED:
            return p, m
        if late <= _JITTER * tolerance and abs(turn) <= _DIRECTED and not dying(points, last, p, m, scale):
            return p, m
        if m * p < _LONG and apart(points, last, p, 1, scale) > (_HIDDEN if p == 1 else _HIDDEN_TWINS) * tolerance:
            continue
        ratio = min(ratio, STILL)
        if late * ratio / (1.0 - ratio) <= left and not dying(points, last, p, m, scale):
            return p, m
    return 0, 0


def approach(points: Any, last: int, count: int, longest: int, scale: Any) -> int:
    """Smallest p such that points p apart come steadily nearer to each other, or part, all p of them; 0 for a motion that does neither.

    Of fewer than six points nothing is said but that it has not settled: 1.
    """
    for p in range(1, longest + 1):
        looks = (count + 1) // p - 1
        if looks < 5:
            return 1 if p == 1 else 0
        falling, rising = True, True
        for j in range(p):  # each on its own: of a chaotic motion one distance, or the largest of p, falls or grows by chance
            new = apart(points, last - j, 1, p, scale)
            for k in range(1, looks // 2 + 2):
                old = apart(points, last - j - k * p, 1, p, scale)
                falling = falling and new <= old * (1.0 + 1e-6)
                rising = rising and new >= old * (1.0 - 1e-6)
                new = old
        if falling or rising:
            return p
    return 0


def limit(points: Any, last: int, p: int, m: int, scale: Any, repeats: bool) -> float:
    """Displacement in a drive period that the motion approaches, by the last m times p periods and those before.

    Infinite where it does not close in, and does not repeat either.
    """
    rows, m = len(points), m - m % 2 if m > 1 else m  # an even number: what alternates goes to its limit from one side
    if m == 0:
        return (points[last % rows, 0] - points[(last - p) % rows, 0]) / p
    lag = m * p
    late = points[last % rows, 0] - points[(last - lag) % rows, 0]
    early = points[(last - lag) % rows, 0] - points[(last - 2 * lag) % rows, 0]
    ratio = closing(points, last, p, m, scale)[1]
    if ratio <= STILL:
        late -= (early - late) * ratio / (1.0 - ratio)
    elif not repeats:
        return float("inf")
    return late / lag


def steady(mean: Any, approached: Any, scale: Any, tolerance: Any) -> Any:
    """Whether a mean is the one that a motion approaches, within a tolerance of it; `scale` is what a body without friction would do."""
    return abs(mean - approached) <= tolerance * (abs(approached) + 1e-6 * scale)


def outcome(points: Any, last: int, count: int, longest: int, scale: Any, tolerance: float, left: float) -> tuple[int, float]:
    """Period number (0: none) and the displacement in a drive period that the motion approaches.

    The displacement is infinite where the motion changes on without an end in sight, and not a number where it does not repeat.
    """
    p, m = period_number(points, last, count, longest, scale, tolerance, left)
    if p > 0:
        return p, limit(points, last, p, m, scale, True)
    p = approach(points, last, count, longest, scale)
    if p == 0:
        return 0, float("nan")
    m = (count + 1 - p) // (2 * p)
    return 0, limit(points, last, p, m, scale, False) if m > 0 else float("inf")
