"""Which of the contacts at zero slip velocity rest, and which way the others go: the contact problem of one instant, in plain floats.

Wanted are forces R with w' = beta - G R, where w' > 0 only at R = hi, w' < 0 only at R = lo, and R lies between where w' = 0.
A stop that is closed is such a contact, with limits -infinity and 0. Contacts that have nothing to do with one another are decided
apart. A block of one contact is a clip; one of contacts on one common coordinate a weighted median; anything else is enumerated.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import SolveError

ROUNDING = 64 * float(np.finfo(float).eps)
MOST = 6  # unknowns of a block that is enumerated
_SAME = 1e-12  # of the size of G: rows that are one another's multiples

Limits = Sequence[float]


@dataclass(frozen=True)
class Answer:
    """Forces R [N], the mode of each contact (0: it rests), and the rates w' [m/s^2]."""

    R: list[float]
    sides: list[int]
    rates: list[float]


@dataclass
class AtZero:
    """Contacts at zero slip velocity, at one instant.

    Parameters
    ----------
    G : array (k, k)
        How much each contact's force takes of each rate w' [1/kg].
    beta : array (k,)
        Rates w' without any of these forces [m/s^2].
    lo, hi : sequences of float
        Static friction limits [N]; infinite where there is none.
    slide : pair of sequences, optional
        Forces of sliding backwards and forwards [N], where they are not the limits.
    forced : dict, optional
        Contacts that slide whatever comes of it, and which way.
    rested : sequence of bool, optional
        Contacts that rested before: they are preferred where several answers are consistent.
    rank : sequence of int, optional
        Order of contacts on one coordinate whose beta are equal now, a moment later.
    small : float, optional
        Error of beta, where it is more than rounding [m/s^2].
    """

    G: Any
    beta: Any
    lo: Any
    hi: Any
    slide: Any = None
    forced: Mapping[int, int] = field(default_factory=dict)
    rested: Any = None
    rank: Any = None
    small: float = 0.0

    def __post_init__(self) -> None:
        self.G, self.beta, self.lo, self.hi = (np.asarray(of, float) for of in (self.G, self.beta, self.lo, self.hi))
        self.slide = (self.lo, self.hi) if self.slide is None else self.slide
        self.rested = [False] * len(self) if self.rested is None else self.rested
        self.rank = [0] * len(self) if self.rank is None else self.rank

    def __len__(self) -> int:
        return len(self.beta)

    def force(self, i: int, side: int) -> float:
        """Friction force of a contact that slides."""
        return float(self.slide[1][i] if side > 0 else self.slide[0][i])

    def choices(self, i: int) -> tuple[int, ...]:
        """Modes that a contact may have."""
        if i in self.forced:
            return (self.forced[i],)
        return (0, *(side for side in (1, -1) if math.isfinite(self.force(i, side))))

    def noise(self, R: Any) -> Any:
        """The size of rounding errors in the rates w'."""
        sizes = [abs(v) for pair in (self.lo, self.hi) for v in pair if math.isfinite(v)]
        return self.small + ROUNDING * (abs(self.beta) + abs(self.G) @ abs(R) + np.diag(self.G) * max(sizes, default=0.0))

    def preference(self, sides: Sequence[int]) -> tuple[int, int, tuple[int, ...]]:
        """Rested before, then the larger set, then the lower index."""
        resting = [i for i, side in enumerate(sides) if side == 0]
        return -sum(bool(self.rested[i]) for i in resting), -len(resting), tuple(resting)


def blocks(G: Any) -> list[list[int]]:
    """Contacts that push one another, as lists of their numbers.

    Examples
    --------
    >>> blocks([[1.0, 0.0, 0.5], [0.0, 1.0, 0.0], [0.5, 0.0, 1.0]])
    [[0, 2], [1]]
    """
    left, blocks = list(range(len(G))), []
    while left:
        block = [left[0]]
        for i in block:  # grows while it is walked
            block += [j for j in left if G[i][j] != 0 and j not in block]
        blocks.append(sorted(block))
        left = [i for i in left if i not in block]
    return blocks


def is_common(G: Array) -> bool:
    """Whether all contacts act on one common coordinate."""
    G = np.asarray(G, float)
    size = np.sqrt(np.outer(np.diag(G), np.diag(G)))
    return bool(np.all(abs(abs(G) - size) <= _SAME * size))


def decide(whole: AtZero) -> Answer:
    """Forces and modes of contacts at zero slip velocity.

    Examples
    --------
    A body of 2 kg on two feet; the second is pulled back, so that the first holds:

    >>> decide(AtZero([[0.5, 0.5], [0.5, 0.5]], [1.0, 3.0], lo=[-4.0, -4.0], hi=[2.0, 2.0]))
    Answer(R=[0.0, 2.0], sides=[0, 1], rates=[0.0, 2.0])
    """
    count = len(whole)
    R, sides = [0.0] * count, [0] * count
    for block in blocks(whole.G):
        decision = _decide(_part(whole, block))
        for i, force, side in zip(block, *decision, strict=True):
            R[i], sides[i] = float(force), int(side)
    rates = whole.beta - whole.G @ np.array(R) if count else whole.beta
    return Answer(R, sides, [0.0 if side == 0 else float(rate) for side, rate in zip(sides, rates, strict=True)])


def _part(whole: AtZero, block: list[int]) -> AtZero:
    forced = {n: whole.forced[i] for n, i in enumerate(block) if i in whole.forced}
    slide = tuple([values[i] for i in block] for values in whole.slide)
    return AtZero(
        whole.G[np.ix_(block, block)], whole.beta[block], whole.lo[block], whole.hi[block], (slide[0], slide[1]), forced,
        [whole.rested[i] for i in block], [whole.rank[i] for i in block], whole.small,
    )  # fmt: skip


def _decide(block: AtZero) -> tuple[Sequence[float], Sequence[int]]:
    if len(block) == 1:
        return _single(block)
    return _common(block) if is_common(block.G) else _box(block)


def _single(block: AtZero) -> tuple[list[float], list[int]]:
    """One contact: what would hold it, clipped to its limits; of one that nothing holds an error of beta is no force."""
    R, lo, hi = float(block.beta[0] / block.G[0, 0]), float(block.lo[0]), float(block.hi[0])
    if lo == hi and abs(R - lo) * block.G[0, 0] <= block.small:
        R = lo
    side = block.forced.get(0, 1 if hi < R else -1 if lo > R else 0)
    return [block.force(0, side) if side else R], [side]


# ---- one common coordinate -------------------------------------------------------------------------------------------


def _common(block: AtZero) -> tuple[list[float], list[int]]:
    """A weighted median: contact i goes forwards while its beta is above x = sum R/M, and M x = sum R has one solution."""
    sign = np.sign(block.G[0])
    sizes = np.sqrt(np.diag(block.G) / block.G[0, 0])
    level = sign * block.beta / sizes
    free = [i for i in range(len(block)) if i not in block.forced]
    consistent = [
        sides for sides in _medians(block, level, sign, free)
        if _is_consistent_median(block, level, sign, sizes, sides)
    ]  # fmt: skip
    if not consistent:
        raise SolveError("no combination of resting and sliding contacts on one coordinate is consistent: static friction is below kinetic")
    sides = min(consistent, key=block.preference)
    R = [block.force(i, side) if side else 0.0 for i, side in enumerate(sides)]
    group = [i for i, side in enumerate(sides) if side == 0]
    if group:
        total = _needed(block, level, sign, sizes, sides)
        for i, share in zip(group, shared_forces(total, *_turned(block, sign, sizes, group)), strict=True):
            R[i] = float(sign[i] * share / sizes[i])
    return R, list(sides)


def _medians(block: AtZero, level: Any, sign: Any, free: list[int]) -> Iterable[list[int]]:
    """Every order-respecting choice: a group of equal contacts rests, or the border lies between two groups."""
    keys = sorted({_key(level, block.rank, i, free, block.small) for i in free})
    borders = [*[(key, key) for key in keys], *itertools.pairwise([(-1, -1), *keys, (len(level), 0)])]
    for low, high in borders:
        sides = [0] * len(level)
        for i in range(len(level)):
            if i in block.forced:
                sides[i] = block.forced[i]
                continue
            key = _key(level, block.rank, i, free, block.small)
            above = 0 if key == low == high else 1 if key >= high else -1
            sides[i] = above * int(sign[i])
        yield sides


def _key(level: Any, rank: Sequence[int], i: int, free: list[int], small: float) -> tuple[int, int]:
    """Number of a contact's level among those that differ by more than rounding, then its rank."""
    size = small + ROUNDING * max((abs(float(level[j])) for j in free), default=0.0)
    values = sorted(float(level[j]) for j in free)
    number = 0
    for before, value in itertools.pairwise(values):
        if value > level[i]:
            break
        number += value - before > size
    return number, rank[i]


def _turned(block: AtZero, sign: Any, sizes: Any, group: list[int]) -> tuple[list[float], list[float]]:
    """Limits of contacts as forces on the coordinate in the direction of the first contact."""
    low = [float(sizes[i] * (block.lo[i] if sign[i] > 0 else -block.hi[i])) for i in group]
    high = [float(sizes[i] * (block.hi[i] if sign[i] > 0 else -block.lo[i])) for i in group]
    return low, high


def _sliding(block: AtZero, sign: Any, sizes: Any, sides: Sequence[int]) -> float:
    return sum(float(sign[i] * sizes[i]) * block.force(i, side) for i, side in enumerate(sides) if side)


def _needed(block: AtZero, level: Any, sign: Any, sizes: Any, sides: Sequence[int]) -> float:
    """The total force that the resting contacts must bear."""
    first = next(i for i, side in enumerate(sides) if side == 0)
    return float(level[first] / block.G[0, 0]) - _sliding(block, sign, sizes, sides)


def _is_consistent_median(block: AtZero, level: Any, sign: Any, sizes: Any, sides: Sequence[int]) -> bool:
    if not all(side == 0 or math.isfinite(block.force(i, side)) for i, side in enumerate(sides)):
        return False
    group = [i for i, side in enumerate(sides) if side == 0]
    push = _sliding(block, sign, sizes, sides)
    noise = block.small / block.G[0, 0] + ROUNDING * (abs(push) + max(abs(level)) / block.G[0, 0])
    if group:
        low, high = _turned(block, sign, sizes, group)
        return sum(low) - noise <= _needed(block, level, sign, sizes, sides) <= sum(high) + noise
    x, noise = push * block.G[0, 0], noise * block.G[0, 0]
    return all(side * int(sign[i]) * (level[i] - x) >= -noise for i, side in enumerate(sides) if i not in block.forced)


def shared_forces(total: float, low: Limits, high: Limits) -> list[float]:
    """A sum of forces shared in proportion to the limits: a convention, for only the sum decides the motion.

    Examples
    --------
    >>> shared_forces(3.0, [-1.0, -1.0], [2.0, 4.0]), shared_forces(-7.0, [-math.inf, -1.0], [0.0, 1.0])
    ([1.0, 2.0], [-6.0, -1.0])
    """
    bounds = high if total >= 0 else low
    size = sum(bounds)
    if math.isfinite(size):
        return [total * (bound / size) if size else 0.0 for bound in bounds]
    finite = sum(bound for bound in bounds if math.isfinite(bound))
    count = sum(not math.isfinite(bound) for bound in bounds)
    within = [bound if math.isfinite(bound) else 0.0 for bound in bounds]
    if abs(total) <= abs(finite):
        return shared_forces(total, [min(v, 0.0) for v in within], [max(v, 0.0) for v in within])
    return [bound if math.isfinite(bound) else (total - finite) / count for bound in bounds]


# ---- anything else ---------------------------------------------------------------------------------------------------


def _box(block: AtZero) -> tuple[list[float], list[int]]:
    """Every combination of modes, the preferred ones first; of a larger block the one in which nothing else changes."""
    choices = [block.choices(i) for i in range(len(block))]
    if len(block) > MOST:
        choices = [own[:1] for own in choices]
    for sides in sorted(itertools.product(*choices), key=block.preference):
        R = _forces(block, sides)
        if R is not None and _goes(block, sides, R):
            return R.tolist(), list(sides)
    if len(block) > MOST:
        raise SolveError(f"{len(block)} contacts that push one another come to rest or leave it at one instant; allowed are {MOST}")
    raise SolveError("no combination of resting and sliding contacts is consistent")


def _forces(block: AtZero, sides: Sequence[int]) -> Any:
    """Forces of a combination; None where its resting contacts cannot be held."""
    R = np.array([block.force(i, side) if side else 0.0 for i, side in enumerate(sides)])
    resting = [i for i, side in enumerate(sides) if side == 0]
    if resting:
        beta = block.beta - block.G @ R
        noise = block.noise(R)[resting]
        held = holding_forces(block.G[np.ix_(resting, resting)], beta[resting], block.lo[resting], block.hi[resting], noise)
        if held is None:
            return None
        R[resting] = held
    return R


def holding_forces(G: Array, beta: Array, lo: Sequence[float], hi: Sequence[float], noise: Any) -> Any:
    """Forces within their limits that hold all contacts of a set; None where there are none."""
    if np.linalg.cond(G) < 1 / _SAME:
        R = np.linalg.solve(G, beta)
        slack = noise / np.diag(G) * np.linalg.cond(G)
        return R if np.all(hi + slack >= R) and np.all(lo - slack <= R) else None
    R, margin = most_slack(G, beta, lo, hi)
    return R if R is not None and margin >= -ROUNDING * 16 and np.all(abs(G @ R - beta) <= 16 * noise) else None


def most_slack(G: Array, beta: Array, lo: Any, hi: Any) -> tuple[Any, float]:
    """Of the forces that hold a dependent set those farthest from their limits, and how far, in parts of the limits' distance."""
    G, beta = np.asarray(G, float), np.asarray(beta, float)
    values, vectors = np.linalg.eigh(G)
    loose = vectors[:, values <= _SAME * values[-1]]
    tight = vectors[:, values > _SAME * values[-1]]
    R = tight @ ((tight.T @ beta) / values[values > _SAME * values[-1]])
    rows, left = [], []  # in parts of the limits' distance, left - rows @ s is what is left of one limit
    for i, (low, high) in enumerate(zip(lo, hi, strict=True)):
        width = high - low if math.isfinite(high - low) and high > low else 1.0
        for side, bound in ((1, high), (-1, -low)):
            if math.isfinite(bound):
                rows.append(side * loose[i] / width)
                left.append((bound - side * R[i]) / width)
    if not rows:
        return R, 1.0
    s, margin = _highest(np.array(rows), np.array(left))
    return R + loose @ s, margin


def _highest(rows: Any, left: Any) -> tuple[Any, float]:
    """The s at which the least of left - rows s is largest, and that: it lies on a corner of the planes, so all corners are tried."""
    n, least = rows.shape[1], float(np.min(left))
    planes = np.hstack([rows, np.ones((len(rows), 1))])
    corners = np.array(list(itertools.combinations(range(len(rows)), n + 1)), int).reshape(-1, n + 1)
    corners = corners[abs(np.linalg.det(planes[corners])) > _SAME]
    at = np.linalg.solve(planes[corners], left[corners][..., None])[..., 0]
    below = np.min(left - at[:, :n] @ rows.T, axis=1, initial=math.inf)
    at = at[below >= at[:, n] - ROUNDING * (1 + abs(left).max())]
    best = int(np.argmax(at[:, n])) if len(at) else -1
    return (at[best, :n], float(at[best, n])) if len(at) else (np.zeros(n), least)


def _goes(block: AtZero, sides: Sequence[int], R: ArrayLike) -> bool:
    """Whether every sliding contact goes the way that its friction says; resting ones stay."""
    rates, noise = block.beta - block.G @ R, block.noise(R)
    return all(
        side == 0 or i in block.forced or side * rate >= -slack
        for i, (side, rate, slack) in enumerate(zip(sides, rates, noise, strict=True))
    )
