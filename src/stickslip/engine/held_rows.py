"""A row of many bodies that is held between calls, as a `HeldLane` holds one case of a kernel: each cluster keeps its own steps there.

A pause touches nothing: bodies are asked where they are within their steps, so that what follows is the same wherever one has paused.
Only where a force changes, everything begins anew.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.engine import local_events as kernel
from stickslip.engine.held_lane import ALL, ENDED, SLICE, THERE, UNDER_WAY, Image, TwoCopies

#: What a row of its dense output is about: a piece of a body, a change of mode, the mode of a body where it begins, or where it ends.
PIECE, CHANGE, STANCE, END = range(4)
#: Columns: what, body, time, and then the coefficients of a position, or a mode.
WHAT, BODY, TIME, REST = range(4)
WIDTH = REST + kernel.ORDER + 2


class RowSide:
    """One of the copies of what a row holds, by name, as `Side` has them.

    Attributes
    ----------
    arrays : RowArrays
    row : array (bodies + 1,)
        A constant force on each body [N], and how long its run may be at most [s].
    """

    way, periods = 0.0, 0
    memory, modes = np.zeros(0), np.zeros(0)  # laws that rest exactly have none

    def __init__(self, arrays: kernel.RowArrays, room: tuple[Array, Array], of: Array):
        self.arrays, self._room, self._of = arrays, room, of
        self._new: Array | None = None  # another row, which takes effect when it goes on
        self.before: Array | None = None  # modes of the bodies with other numbers
        self._noted = np.empty((0, WIDTH))

    # ---- what it is ----
    @property
    def time(self) -> float:
        """Where it is [s]."""
        return float(self.arrays.job[kernel.NOW])

    @property
    def status(self) -> int:
        """How it ended before its goal."""
        return int(self.arrays.counts[kernel.STATUS])

    @property
    def sides(self) -> Array:
        """The mode of each contact."""
        return self.arrays.K[self._of, kernel.MODE].astype(float)

    @property
    def places(self) -> tuple[Array, Array]:
        """Position and velocity of each body."""
        S, X = self.arrays.S, self.arrays.X
        d, rests = self.time - S[:, kernel.T0], self.arrays.K[:, kernel.MODE] == 0
        x, v = X[:, -1].copy(), np.zeros(len(X))
        for k in range(X.shape[1] - 2, -1, -1):
            v = v * d + x
            x = x * d + X[:, k]
        base = S[:, kernel.BASE]
        return np.where(rests, S[:, kernel.XS] + base * d, x), np.where(rests, base, v)

    @property
    def states(self) -> Array:
        """Velocities, then positions."""
        x, v = self.places
        return np.concatenate([v, x])

    @property
    def row(self) -> Array:
        """The constant forces, and how long it may run."""
        return np.append(self.arrays.S[:, kernel.PUSH], self.arrays.job[kernel.STOP])

    @property
    def modes_of_bodies(self) -> Array:
        """The mode of each body; 2 of one without a contact."""
        return self.arrays.K[:, kernel.MODE].copy()

    # ---- on ----
    def renumber(self, row: Array, what: float = ALL) -> None:
        """Another row, which takes effect when it goes on."""
        self._new = np.array(row, float)

    def stand(self, period: int, time: float) -> None:
        """Count time from elsewhere: that of a row goes on."""

    def aim(self, period: int, time: float, budget: float, each_step: bool = False) -> None:
        """Where it goes, and whether it returns after each event."""
        self._goal, self._each = time, each_step

    def advance(self, calls: int = SLICE) -> int:
        """Some steps: THERE, UNDER_WAY or ENDED."""
        if self._new is not None:
            self._begin_anew(self._new)
        return self._advanced(self._goal, self._each, calls) if calls else UNDER_WAY

    def _advanced(self, goal: float, each: bool, calls: int) -> int:
        job, counts = self.arrays.job, self.arrays.counts
        job[kernel.PAUSE], job[kernel.EACH_EVENT], counts[kernel.LEFT] = goal, float(each), calls
        self.arrays.act(kernel.ADVANCE, *self._room)
        return ENDED if counts[kernel.STATUS] else THERE if counts[kernel.PAUSED] else UNDER_WAY

    def _begin_anew(self, row: Array) -> None:
        """Decide anew what each contact does under other forces; what has changed by that is noted."""
        before = self.modes_of_bodies if self.before is None else self.before
        self._new = self.before = None
        self.arrays.act(kernel.FINISH, *self._room)
        self.arrays.S[:, kernel.PUSH], self.arrays.job[kernel.STOP] = row[:-1], row[-1]
        self.arrays.act(kernel.BEGIN, *self._room)
        self._advanced(self.time, False, SLICE)  # what breaks away at once
        bodies = np.flatnonzero(self.arrays.K[:, kernel.MODE] != before)
        self._noted = rows_of(CHANGE, bodies, self.time, self.arrays.K[bodies, kernel.MODE])
        self.arrays.counts[kernel.EVENTS_WRITTEN] = 0

    # ---- what it has done ----
    def taken(self) -> Array:
        """The dense output since it was asked last, whose room is free again: pieces that have ended, and changes of mode."""
        counts, (pieces, events) = self.arrays.counts, self._room
        ended, changes = pieces[: counts[kernel.PIECES_WRITTEN]], events[: counts[kernel.EVENTS_WRITTEN]]
        rows = np.zeros((len(ended), WIDTH))
        rows[:, WHAT], rows[:, BODY:] = PIECE, ended
        rows = np.concatenate([self._noted, rows, rows_of(CHANGE, changes[:, 1], changes[:, 0], changes[:, 2])])
        counts[[kernel.PIECES_WRITTEN, kernel.EVENTS_WRITTEN]] = 0
        self._noted = self._noted[:0]
        return rows

    def open_pieces(self) -> Array:
        """The pieces that have begun and not ended."""
        S, X, bodies = self.arrays.S, self.arrays.X, np.arange(len(self.arrays.S))
        rows = np.zeros((len(bodies), WIDTH))
        rows[:, WHAT], rows[:, BODY], rows[:, TIME], rows[:, REST:] = PIECE, bodies, S[:, kernel.T0], X
        rests = self.arrays.K[:, kernel.MODE] == 0
        rows[rests, REST:] = 0.0
        rows[rests, REST], rows[rests, REST + 1] = S[rests, kernel.XS], S[rests, kernel.BASE]
        return rows

    def switched(self, rows: Array, sides: Array, modes: Array) -> bool:
        """Whether something may have happened in these steps."""
        return bool(np.any(rows[:, WHAT] == CHANGE))

    # ---- copies ----
    def copy_from(self, other: RowSide | Image) -> None:
        """Hold the same as another copy."""
        image = other if isinstance(other, Image) else other.image
        self.arrays.values[:], self.arrays.whole[:] = image.lane, image.shared
        self._new, self._noted = None, self._noted[:0]

    @property
    def image(self) -> Image:
        """What it holds, copied."""
        return Image(self.arrays.values.copy(), self.arrays.whole.copy())

    def numbers(self) -> list[float]:
        """All that it holds, as numbers of a file."""
        return [*self.arrays.values.tolist(), *self.arrays.whole.tolist()]

    def take(self, numbers: Array, row: Array) -> None:
        """Hold what `numbers` gave; `ValueError` for whole numbers that it cannot have given."""
        arrays = self.arrays
        values, whole = np.split(numbers, [len(arrays.values)])
        if not (np.isfinite(whole).all() and np.array_equal(whole, np.round(whole))) or np.isnan(values).any():
            raise ValueError("its whole numbers are none")
        known, own, counts = arrays.K.copy(), arrays.link.copy(), arrays.counts
        arrays.values[:], arrays.whole[:] = values, whole
        K, link, bodies = arrays.K, arrays.link, len(known)
        numbered = K[:, [kernel.LEADER, kernel.WHAT]]
        good = (
            np.array_equal(K[:, kernel.AHEAD : kernel.LEADER], known[:, kernel.AHEAD : kernel.LEADER])
            and np.array_equal(link[:, :-1], own[:, :-1])
            and np.array_equal(K[:, kernel.MODE] == 2, known[:, kernel.AHEAD] < 0)
            and bool(np.all((K[:, kernel.MODE] >= -1) & (K[:, kernel.MODE] <= 2)))
            and bool(np.all((numbered >= -1) & (numbered < bodies)))
            and bool(np.all(counts >= 0)) and not counts[[kernel.PIECES_WRITTEN, kernel.EVENTS_WRITTEN]].any()
        )  # fmt: skip
        if not good:
            raise ValueError("its whole numbers are not those of its bodies")

    def begin_from(self, way: float, states: Array, memory: Array, row: Array, t: float) -> None:
        """Begin at a time with the velocities and positions that `states` has."""
        v, x = np.split(states, 2)
        S, job = self.arrays.S, self.arrays.job
        S[:, kernel.XS], S[:, kernel.VS], S[:, kernel.PUSH], job[kernel.NOW] = x, v, row[:-1], t
        job[kernel.STOP] = row[-1]
        self.arrays.act(kernel.BEGIN, *self._room)
        self.arrays.counts[[kernel.PIECES_WRITTEN, kernel.EVENTS_WRITTEN]] = 0


def rows_of(what: int, bodies: Any, t: Any, values: Any) -> Array:
    """Rows of dense output that hold one number each."""
    rows = np.zeros((len(bodies), WIDTH))
    rows[:, WHAT], rows[:, BODY], rows[:, TIME], rows[:, REST] = what, bodies, t, values
    return rows


class RowLane(TwoCopies):
    """A row of many bodies that goes on from where it stands.

    Parameters
    ----------
    row : local_events.Row
    x, v : array (bodies,)
        Where it begins.
    begin, span : float
        When, and how long a run may be at most: it is renewed before [s].
    speed : float
        A typical velocity [m/s].
    of : array (contacts,) of int
        The body of each contact.
    before : array (bodies,) of int, optional
        Modes with other numbers, from which it goes on.

    Attributes
    ----------
    first : RowSide
        Where it begins.
    """

    def __init__(
        self, row: kernel.Row, x: Array, v: Array, begin: float, span: float, speed: float, of: Array, before: Array | None = None
    ):  # fmt: skip
        both = [kernel.RowArrays(row, x, v, begin, span, speed) for _ in range(2)]
        room = both[0].room()
        self.first, self._other = (RowSide(arrays, room, of) for arrays in both)
        self.first.arrays.act(kernel.BEGIN, *room)
        self.first.before = before

    def ahead(self, side: RowSide, budget: float) -> Array | None:
        """Dense output of the motion that follows, for a moment."""
        modes, t = side.modes_of_bodies, side.time
        ends = rows_of(END, np.zeros(1), t + 1e-9 * max(t, 1.0), 0.0)
        return np.concatenate([rows_of(STANCE, np.arange(len(modes)), t, modes), side.open_pieces(), ends])
