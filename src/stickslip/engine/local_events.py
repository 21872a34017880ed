"""A row of many bodies as arrays for its kernel, and what the kernel makes of them: pieces of each body, and events."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.frozen_arrays import sealed
from stickslip.engine import cache
from stickslip.engine.force_tables import ForceForm, Tables, traced
from stickslip.engine.kernel_text import KernelSource, kernel_text
from stickslip.engine.symbols import TraceError

ORDER = 16
#: Different texts of forces that a row may have: beyond, its parts are no tables.
MOST_TEXTS = 24
#: Functions that may be next to nothing over a step, with all their coefficients, and rise within it.
_HIDING = {"exp", "tanh", "bell", "sinh", "cosh"}
_ROOM, _EVENTS = 40_000, 20_000  # pieces and events that a call may write
_STEPS = 2_000  # steps of a call: so often is the keyboard looked at
# columns of what the kernel works on: of bodies, in whole numbers and in numbers, of the job, and of the counts (kernels/local_bodies.py)
(MODE, AHEAD, AT_AHEAD, BACK, AT_BACK, APPLIED, AT_APPLIED, FIRST, COUNT, LEADER, MARK, WHAT) = range(12)
(T0, XS, VS, MASS, BASE, LOW, HIGH, END, SUM, SIZE, PUSH) = range(11)
(NOW, STOP, SPEED, CURVED, PAUSE, EACH_EVENT) = range(6)
(STATUS, PIECES_WRITTEN, EVENTS_WRITTEN, STEPS, SWITCHED, MARKS, LEFT, REJECTED, PAUSED) = range(9)
_BODY, _WHOLE, LINK_COLUMNS, _JOB, _COUNTS = 11, 15, 5, 6, 9
BEGIN, ADVANCE, FINISH = range(3)  # what a call does
_KIND = "void(int64, f2, i2, f2, i2, i1, f1, f2, f2, f2, f2, f1, f1, f1, i1, i1, f2, f2, i1)"


@sealed
@dataclass(frozen=True, eq=False)
class Row:
    """Bodies on contacts of their own, joined by links: arrays with an entry for each, and the texts of their forces.

    Make one with `row_of`.
    """

    masses: Array
    base: Array  # velocity of what each body rubs on; 0 where it has no contact
    limits: Array  # (bodies, 2): friction forces at rest, backward and forward
    laws: Array  # (bodies, 4): texts forwards and backwards, each with its row of numbers; -1 without a contact
    applied: Array  # (bodies, 2)
    ends: Array  # (links, 2): bodies; -1 is the ground
    links: Array  # (links, 2)
    numbers: Array
    tables: tuple[Tables, Tables, Tables]  # texts of links, contacts and bodies

    @property
    def is_curved(self) -> bool:
        """Whether a force is not linear, so that the ends of steps are checked."""
        return not all(force.is_linear for table in self.tables for force in table.forces)

    @cached_property
    def source(self) -> KernelSource:
        """The text of its kernel, which does not depend on how many parts there are."""
        texts = map(kernel_text, ("polynomials", "local_bodies", "local_clusters", "local_events"))
        constants = [f"ORDER, STRIDE = {ORDER}, 1", f"BEGIN, ADVANCE, FINISH = {BEGIN}, {ADVANCE}, {FINISH}"]
        text = "\n".join([*constants, *texts, *(table.text(ORDER + 1) for table in self.tables)])
        return KernelSource(text, {"act": _KIND})

    @property
    def kernel(self) -> Any:
        """Its kernel, compiled."""
        return cache.load(self.source, "row", "a row of many bodies")

    @cached_property
    def adjacency(self) -> tuple[Array, Array, Array]:
        """The links of each body, one body after the other; where they begin, and how many there are."""
        links = np.repeat(np.arange(len(self.ends)), 2)
        bodies = self.ends.ravel()
        order = np.argsort(bodies, kind="stable")
        order = order[bodies[order] >= 0]
        counts = np.bincount(bodies[order], minlength=len(self.masses))
        return links[order].astype(np.int64), np.concatenate([[0], np.cumsum(counts)[:-1]]), counts


def row_of(mechanics: Any) -> Row:
    """The arrays of a machine whose `separate` is known; `TraceError` if a force has no text that others could share."""
    contacts, bodies = mechanics.separate, list(mechanics.parts.values())
    tables = Tables("link", ("d", "r")), Tables("contact", ("s",)), Tables("applied", ("t", "x", "v"))
    numbers: list[float] = []
    known: dict[tuple[Any, ...], tuple[int, int]] = {}
    kept: list[Any] = []  # alive as long as their identities are keys

    def placed(table: Tables, owner: Any, key: tuple[Any, ...], force: Callable[[], ForceForm]) -> tuple[int, int]:
        """Text and row of numbers of a force; parts that are one object share theirs."""
        key = (table.name, id(owner), *key)
        if key not in known:
            made = force()
            if table is not tables[1] and made.operations & _HIDING:
                raise TraceError(
                    f"{', '.join(sorted(made.operations & _HIDING))} in a force of a body or a link, which may rise out of nothing"
                )
            kept.append(owner)
            known[key] = table.kind(made), len(numbers)
            numbers.extend(made.numbers)
            if sum(len(each.forces) for each in tables) > MOST_TEXTS:
                raise TraceError("its parts have too many different forces")
        return known[key]

    loads = mechanics.loads(0.0, mechanics.start)
    load_of = dict(zip((c.body for c in mechanics.joints.values()), loads, strict=True))
    laws, limits, base = np.full((len(bodies), 4), -1), np.zeros((len(bodies), 2)), np.zeros(len(bodies))
    applied = np.full((len(bodies), 2), -1)
    for i, (name, body, contact) in enumerate(zip(mechanics.bodies, bodies, contacts, strict=True)):
        if contact is not None:
            part, law = contact
            load = float(load_of[name])
            sides = [
                placed(
                    tables[1],
                    law.law,
                    (load, side),
                    lambda law=law, load=load, side=side: traced(("s",), lambda s: law.sliding(s, load), side),
                )
                for side in (1.0, -1.0)
            ]
            laws[i] = [*sides[0], *sides[1]]
            limits[i] = [float(limit) for limit in law.breakaway(load)]
            base[i] = 0.0 if part.on is None else float(part.on)
        if callable(body.force) or body.force != 0.0:
            applied[i] = placed(tables[2], body, (), lambda body=body: traced(("t", "x", "v"), body.applied))
    index = {name: i for i, name in enumerate(mechanics.bodies)}
    ends = np.array([[index[a], -1 if b is None else index[b]] for (a, b), _ in mechanics.elastic], np.int64).reshape(-1, 2)
    links = [placed(tables[0], link, (), lambda link=link: traced(("d", "r"), link.force)) for _, link in mechanics.elastic]
    return Row(
        np.array([float(body.mass) for body in bodies]), base, limits, laws, applied, ends, np.array(links, np.int64).reshape(-1, 2),
        np.array(numbers or [0.0]), tables,
    )  # fmt: skip


@sealed
@dataclass(frozen=True, eq=False)
class RowOutcome:
    """What became of a row."""

    status: int  # 1: it came to its end; 0: it was stopped
    t: float
    first_modes: Array
    pieces: list[Array]  # each (pieces, 2 + coefficients): body, beginning, coefficients of its position
    events: Array  # (events, 3): time, body, new mode
    steps: int
    rejected: int


class RowArrays:
    """What the kernel works on: all that goes on from one step to the next, in one array of numbers and one of whole numbers, and the rest.

    Parameters
    ----------
    row : Row
    x, v : array (bodies,)
        Positions [m] and velocities [m/s] at `begin`.
    begin, end : float
        Where it begins, and where its run ends [s].
    speed : float
        A typical velocity [m/s].

    Attributes
    ----------
    values, whole : array
        All that changes.
    S, X, job, K, link, counts : array
        Parts of these by name (see `kernels/local_bodies.py`).
    """

    def __init__(self, row: Row, x: Array, v: Array, begin: float, end: float, speed: float):
        self._act = row.kernel["act"]
        bodies, links, width = len(row.masses), len(row.ends), ORDER + 1
        half = 1 << max(bodies - 1, 1).bit_length()
        self.values, (self.S, self.X, tree, self.job) = _parts_of([(bodies, _BODY), (bodies, width + 1), (2 * half,), (_JOB,)], float)
        self.whole, (self.K, self.link, self.counts) = _parts_of([(bodies, _WHOLE), (max(links, 1), LINK_COLUMNS), (_COUNTS,)], np.int64)
        S, K, link = self.S, self.K, self.link
        S[:, XS], S[:, VS], S[:, MASS], S[:, BASE], S[:, LOW], S[:, HIGH] = x, v, row.masses, row.base, *row.limits.T
        K[:, [AHEAD, AT_AHEAD, BACK, AT_BACK]], K[:, [APPLIED, AT_APPLIED]] = row.laws, row.applied
        adjacent, K[:, FIRST], K[:, COUNT] = row.adjacency
        link[:links, :2], link[:links, 2:4] = row.ends, row.links
        tree[:], self.job[:] = np.inf, [begin, end, speed, float(row.is_curved), np.inf, 0.0]
        work = [np.zeros((max(count, 1), table.rows * width)) for count, table in zip((links, bodies, bodies), row.tables, strict=True)]
        self._arrays = (
            S, K, self.X, link, np.append(adjacent, 0), row.numbers.copy(), *work, np.zeros((3, width + 1)), np.zeros(width + 4),
            tree, self.job, np.zeros(3 * bodies + 3, np.int64), np.zeros(links + 1, np.int64),
        )  # fmt: skip

    def act(self, what: int, pieces: Array, events: Array) -> None:
        """Have the kernel do something, and write pieces and events."""
        self._act(what, *self._arrays, pieces, events, self.counts)

    def room(self) -> tuple[Array, Array]:
        """Arrays into which pieces and events can be written."""
        return np.empty((_ROOM + 5 * len(self.S), ORDER + 4)), np.empty((_EVENTS + 2 * len(self.S), 3))


def _parts_of(shapes: list[tuple[int, ...]], kind: Any) -> tuple[Array, list[Array]]:
    """One array of zeros, and parts of it in these shapes."""
    sizes = [int(np.prod(shape)) for shape in shapes]
    whole = np.zeros(sum(sizes), kind)
    return whole, [part.reshape(shape) for part, shape in zip(np.split(whole, np.cumsum(sizes)[:-1]), shapes, strict=True)]


def run(row: Row, x: Array, v: Array, end: float, speed: float, most: int, go_on: Callable[[float], bool]) -> RowOutcome:
    """Run a row from positions and velocities at t = 0 to an end.

    Parameters
    ----------
    most : int
        Pieces that may be kept; beyond, the status is 2.
    go_on : callable
        Called with the time now and then; False stops the run.
    """
    arrays = RowArrays(row, x, v, 0.0, end, speed)
    (room, noted), numbers = arrays.room(), arrays.counts
    arrays.act(BEGIN, room, noted)
    first, pieces, events, kept = arrays.K[:, MODE].astype(np.int8), [], [], 0
    running = True
    while running:
        numbers[[PIECES_WRITTEN, EVENTS_WRITTEN]], numbers[LEFT] = 0, _STEPS
        arrays.act(ADVANCE, room, noted)
        running = numbers[STATUS] == 0 and go_on(float(arrays.job[NOW]))
        if not running and numbers[STATUS] == 0:
            arrays.act(FINISH, room, noted)
        pieces.append(room[: numbers[PIECES_WRITTEN]].copy())
        events.append(noted[: numbers[EVENTS_WRITTEN]].copy())
        kept += len(pieces[-1])
        if kept > most and running:
            numbers[STATUS], running = 2, False
    return RowOutcome(
        int(numbers[STATUS]),
        float(arrays.job[NOW]),
        first,
        pieces,
        np.concatenate(events),
        int(numbers[STEPS]),
        int(numbers[REJECTED]),
    )
