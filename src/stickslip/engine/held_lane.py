"""A lane that is held between calls: one case that goes on from where it stands, with other numbers if they are given.

All that it knows is in two arrays, of which there are two copies: a call works on a draft and leaves the other copy as it was. So
whatever ends a call early, Ctrl-C too, leaves what was there before.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.engine import driver
from stickslip.engine.kernels import columns
from stickslip.engine.lanes import Job, Kernel, arrays_of
from stickslip.engine.shared_arrays import address_of

#: Steps of dense output for which there is room, and steps between two looks at the keyboard (about 2 milliseconds).
ROOM, SLICE = 256, 8192
#: What `Side.advance` returns: it has come to its goal, it is under way, it has ended before its goal.
THERE, UNDER_WAY, ENDED = 0, 1, 2
_ENDLESS = 1 << 62  # periods
_JUMP = 1e-9  # of the largest state: a state that changes by more at the end of a step jumps
_GOAL_PERIOD, _GOAL_TIME, _RENEWED, _EACH_STEP, _BEGUN_ANEW, _GOALS = range(6)  # columns of GOAL (kernels/advancing.py)
#: What of the numbers of a case is new: how long it may run, or any.
SPAN_ALONE, ALL = 1.0, 2.0


@dataclass(frozen=True)
class Image:
    """All that a lane holds at an instant, in two arrays."""

    lane: Array
    shared: Array


class Side:
    """One of the copies of what a lane holds, by name.

    Attributes
    ----------
    states : array (states,)
        As the kernel counts them (see `stickslip.engine.system.System`).
    memory : array (modes,)
        What laws remember, or the mode of a flow.
    modes : array
        All that steps hold and switches change.
    row : array (numbers,)
        The numbers of the case.
    whole : array of int
        Its whole numbers (see `kernels/columns.py`).
    """

    def __init__(self, kernel: Kernel, row: Array, start: Array, rtol: float, pieces: Any):
        job = Job(_ENDLESS, _ENDLESS, False, rtol, 0.75, 1.0, whole=True)
        self.S, shared = arrays_of(kernel, row[None, :], start[None, :], job, 1, goal=_GOALS)
        shared["PIECES"] = self.pieces = np.empty((ROOM, shared["PIECES"].shape[1])) if pieces is None else pieces
        self.shared, self.kernel = shared, kernel
        advance, at = driver.load("advance_to"), address_of(shared.at)
        S, table = self.S, kernel.table
        self._going_on = lru_cache(3)(lambda calls: advance.on(S, calls, at, table))
        self.whole, self.row, self.goal, self._job = shared["N"][0], shared["PARAM"][0], shared["GOAL"], shared["JOB"]
        self._limits = shared["LIMITS"]
        first = {name: int(kernel.table[driver.column(name)]) for name in ("F_T", "F_X", "F_Y", "F_MODE", "F_B")}
        self.states = self.S[first["F_Y"] : first["F_Y"] + kernel.states]
        self.memory = self.S[first["F_MODE"] : first["F_MODE"] + kernel.modes]
        count = int(kernel.table[driver.column("MODES")])
        self.modes = self.S[first["F_MODE"] : first["F_MODE"] + count] if count else self.S[:0]
        guards = kernel.guards or (None,) * kernel.contacts
        sides = [first["F_MODE"] + i if guard is None else first["F_B"] + guard for i, guard in enumerate(guards)]
        self._time, self._way, self._sides = first["F_T"], first["F_X"], np.array(sides, dtype=np.int64)

    @property
    def periods(self) -> int:
        """Periods that it has done."""
        return int(self.whole[columns.DONE])

    @property
    def time(self) -> float:
        """Time since the last of them [s]."""
        return float(self.S[self._time])

    @property
    def way(self) -> float:
        """The way of the first coordinate, as the kernel integrates it [m]."""
        return float(self.S[self._way])

    def count_way_from(self, way: float) -> None:
        """Another number for the way where it stands [m]."""
        self.S[self._way] = way

    @property
    def sides(self) -> Array:
        """The mode of each contact: of set-valued laws as it is held, of others the sign of its slip."""
        return self.S[self._sides]  # type: ignore[no-any-return]

    @property
    def aloft(self) -> Array:
        """Whether each contact flies."""
        return np.array([mode >= 0 and self.modes[mode] == 1.0 for mode in self.kernel.flights], dtype=bool)

    @property
    def status(self) -> int:
        """How it ended before its goal."""
        return int(self.whole[columns.STATUS])

    def renumber(self, row: Array, what: float = ALL) -> None:
        """Other numbers of the case, which take effect when it goes on."""
        self.row[:] = row
        self.goal[_RENEWED] = max(self.goal[_RENEWED], what)

    def stand(self, period: int, time: float) -> None:
        """Count time from elsewhere."""
        self.whole[columns.DONE], self.S[self._time] = period, time

    def aim(self, period: int, time: float, budget: float, each_step: bool = False) -> None:
        """Where it goes: a drive period and a time in it; in how many steps at most; and whether it returns after each of them."""
        goal = self.goal
        goal[_GOAL_PERIOD], goal[_GOAL_TIME], goal[_EACH_STEP], goal[_BEGUN_ANEW] = period, time, each_step, 1.0
        self._limits[columns.BUDGET_OF_STEPS], self._job[columns.WRITTEN] = budget, 0

    def advance(self, calls: int = SLICE) -> int:
        """Some steps: THERE, UNDER_WAY or ENDED. It waits where there is no more room for dense output (`taken` makes some)."""
        return int(self._going_on(calls)())

    @property
    def written(self) -> int:
        """Steps of dense output that have been written."""
        return int(self._job[columns.WRITTEN])

    def taken(self) -> Array:
        """The dense output since it was asked last, a row for each step, whose room is free again."""
        rows = self.pieces[: self.written].copy()
        self._job[columns.WRITTEN] = 0
        return rows

    def switched(self, rows: Array, sides: Array, modes: Array) -> bool:
        """Whether these steps ended with other sides or modes than it had, or with a jump: only then has something happened."""
        if not np.array_equal(self.sides, sides) or not np.array_equal(self.modes, modes):
            return True
        if not len(rows):
            return False
        k = self.kernel
        end = rows[-1, 4 + k.contacts + k.modes :].reshape(k.states, k.degree + 1).sum(axis=1)
        return bool(np.any(abs(end - self.states) > _JUMP * np.max(abs(end), initial=1e-300)))

    def numbers(self) -> list[float]:
        """All that it holds, as numbers of a file."""
        return [float(each) for each in self.S]

    def take(self, numbers: Array, row: Array) -> None:
        """Hold what `numbers` gave."""
        self.S[:], self.row[:] = numbers, row

    def begin_from(self, way: float, states: Array, memory: Array, row: Array, t: float) -> None:
        """Begin in these states, whose time is said by `stand`."""
        self.count_way_from(way)
        self.states[:], self.memory[:] = states, memory
        self.renumber(row, ALL)

    def copy_from(self, other: Side | Image) -> None:
        """Hold the same as another copy."""
        lane, shared = (other.lane, other.shared) if isinstance(other, Image) else (other.S, other.shared.memory)
        self.S[:] = lane
        self.shared.memory[:] = shared

    @property
    def image(self) -> Image:
        """What it holds, copied."""
        return Image(self.S.copy(), self.shared.memory.copy())


class TwoCopies:
    """What is held twice: one copy is where it stands, the other one a draft of where it goes.

    Attributes
    ----------
    first : Side or RowSide
        Where it begins.
    """

    first: Any
    _other: Any

    def empty(self, side: Any) -> Any:
        """The other copy."""
        return self._other if side is self.first else self.first

    def draft_of(self, side: Any, now: Any = None) -> Any:
        """The copy that is not `now` (that is not `side` itself, if it is not given), holding the same as `side`, a copy or an `Image`."""
        draft = self.empty(side if now is None else now)
        draft.copy_from(side)
        return draft


class HeldLane(TwoCopies):
    """One case of a kernel that keeps its dense output.

    Parameters
    ----------
    kernel : Kernel
        Of one recorded case.
    row : array (numbers,)
        The numbers of the case, in the kernel's order.
    start : array (1 + states + memories,)
        The way, the states, and the memories with which it begins.
    rtol : float
        As in `Job`.

    Attributes
    ----------
    first : Side
        Where it begins.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.engine.lanes import kernel_of
    >>> from stickslip.solvers.lane_tables import CaseTable
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb")
    >>> kernel = kernel_of(robot, None, record=True)
    >>> table = CaseTable(robot, kernel, np.zeros((1, 2)), robot.period)
    >>> lane = HeldLane(kernel, table.rows[0], table.start[0], 1e-9)
    >>> draft = lane.draft_of(lane.first)
    >>> draft.aim(3, 0.001, budget=1e4)
    >>> draft.advance() == THERE, lane.first.periods, draft.periods, draft.time
    (True, 0, 3, 0.001)
    """

    def __init__(self, kernel: Kernel, row: Array, start: Array, rtol: float):
        self.kernel = kernel
        self.first = Side(kernel, row, start, rtol, None)
        self._other = Side(kernel, row, start, rtol, self.first.pieces)
        self.first.aim(0, 0.0, 1.0)
        self.first.advance(1)  # takes the case, and is there

    def ahead(self, side: Side, budget: float) -> Array | None:
        """The first step of dense output of the motion that follows, which is not made; None if none does."""
        draft = self.draft_of(side)
        draft.aim(side.periods + 1, math.inf, budget, each_step=True)
        for _ in range(ROOM):
            code = draft.advance(1)
            rows = draft.taken()
            if code == ENDED:
                break
            if len(rows) and rows[0, 2] > rows[0, 1]:
                return rows
        return None
