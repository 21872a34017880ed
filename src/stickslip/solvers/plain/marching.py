"""One run from its start to its end: stretch by stretch, event by event."""

from __future__ import annotations

import itertools
import math
from collections import deque
from dataclasses import dataclass, replace
from typing import Any, NoReturn

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import SolveError
from stickslip.basics.interruption import Interrupted, look
from stickslip.basics.status import Status
from stickslip.models.machine_adapter import machine_of
from stickslip.results.dense_output import PolynomialPieces
from stickslip.solvers.plain import hits
from stickslip.solvers.plain.choosing import after_event, begun, conditioned
from stickslip.solvers.plain.dense import DensePart, joined_output
from stickslip.solvers.plain.flights import landed, taken_off, turned_aloft
from stickslip.solvers.plain.guards import Guard
from stickslip.solvers.plain.plain_equations import ContactModes, Equations
from stickslip.solvers.plain.points import PointEquations, equations_of
from stickslip.solvers.plain.stretch import integrate
from stickslip.solvers.settings import Request
from stickslip.solvers.stopped import PRESSES_BACK, STIFF, Changes, location, remedy, stopping_message

_EVENTS = 2_000  # events in one period, and as many more for each contact and stop, that are taken for chatter
_MANY, _AT_ONCE = 200, 1e-9  # so many events within this part of a period are taken for it too
_STEPS, _LEAST = 20_000, 15_000  # steps that a case may have taken: for each period, or time scale, that has passed, and beyond these
_UNSCALED = 300_000  # in all, where nothing says how long something takes
_MET = 1e-6  # of the time between samples: instants that fall together
_BEFORE = 1e-9  # of the velocity scale: a slip that a contact at rest gets from asking beside a break, and not from a jump

Jumps = tuple[float, ...]


@dataclass(frozen=True)
class Hit:
    """A stop was hit, with a velocity of approach, or closed for good (0)."""

    t: float
    part: str
    velocity: float


def march(todo: Request, model: Model, case: int) -> tuple[PolynomialPieces, dict[str, Any], int]:
    """The dense output of one case, what it cost, and how it ended: finished, a contact lost, or (of one run) interrupted."""
    run = marched(todo, model, case)
    return run.pieces(), run.counts, Status.NOT_COMPUTED if run.interrupted else run.ended


def marched(todo: Request, model: Model, case: int) -> Run:
    """The run of one case."""
    equations = equations_of(model)
    run = Run(todo, equations, todo.start[case])
    end = float(todo.span[case]) * todo.periods
    end = end if todo.duration is None else min(end, todo.duration)
    known = _known(model, end)
    for i, (first, last) in enumerate(itertools.pairwise(known)):
        if len(known) > 2:
            equations.between(first[0], last[0])
        if i:
            run.throw(first[1], first[2])
        try:
            run.go(last[0])
        except Interrupted:
            if not (todo.partial and todo.keep == "trajectory" and run.parts):
                raise
            run.interrupted = True
        if run.ended or run.interrupted:
            break
    return run


def _known(model: Model, end: float) -> list[tuple[float, Jumps, bool]]:
    """The instants that are known beforehand, with the jumps at each, and whether controllers take a sample there."""
    instants, between = _without_samples(model, end), machine_of(model).mechanics.controllers.sample
    if between is None:
        return [(t, jumps, False) for t, jumps in instants]
    dt, still = float(between), (0.0,) * len(instants[0][1])
    marked = [(t, jumps, abs(t / dt - round(t / dt)) <= _MET) for t, jumps in instants]
    times = np.array([t for t, _ in instants])
    more = [k * dt for k in range(math.ceil(end / dt * (1 - 1e-12))) if np.min(abs(times - k * dt)) > _MET * dt]
    return sorted([*marked, *((t, still, True) for t in more)], key=lambda known: known[0])


def _without_samples(model: Model, end: float) -> list[tuple[float, Jumps]]:
    """Start, breaks, impulses, borders of their periods, end."""
    machine = machine_of(model)
    nothing = (0.0,) * len(machine.mechanics.masses)
    jumps: dict[float, Jumps] = {}
    for s, jump in machine.mechanics.jumps:
        jumps[float(s)] = tuple(a + float(b) for a, b in zip(jumps.get(float(s), nothing), jump, strict=True))
    breaks = machine.breaks
    if not breaks and not jumps:
        return [(0.0, nothing), (end, nothing)]
    T = float(model.period)
    inside = sorted(s for s in {0.0, *breaks, *jumps} if s < T)
    known = [(k * T + s, jumps.get(s, nothing)) for k in range(math.ceil(end / T)) for s in inside]
    return [*((t, jump) for t, jump in known if t < end - 1e-12 * T), (end, nothing)]


class Run:
    """A run on its way: its state, its mode, and the parts of its dense output."""

    def __init__(self, todo: Request, equations: Equations, start: Any):
        self.todo, self.equations, self.t = todo, equations, 0.0
        self.y = np.array(start[: equations.size], float)
        self.parts: list[DensePart] = []
        self.hits: list[Hit] = []
        self.counts, self.interrupted = {"steps": 0, "evaluations": 0, "restarts": 0}, False
        self.ended = Status.FINISHED  # how its equations ended, where they do before its time is over
        self.recent = deque[tuple[float, tuple[int, ...]]]()
        equations.first_loads = equations.loads(0.0, self.y)
        loads = enumerate(zip(equations.first_loads, equations.laws, equations.unpressed, strict=True))
        unpressed = [i for i, (load, law, least) in loads if not law.flies and load <= 0.0 and load + least <= 0.0]
        if any(not equations.is_pressed_without_friction(i, 0.0, self.y) for i in unpressed):
            raise SolveError("the load is not positive at the start, so there is no contact; give a start or a drive with a positive load")
        self.points = equations if isinstance(equations, PointEquations) else None
        if self.points is None:
            self.y, self.mode = begun(equations, 0.0, self.y, self._memories(start[equations.size :]))
        else:
            self._begin_points(self.points)
        if any(border <= 0.0 for border in equations.borders(0.0, self.y, self.mode).values()):
            message = f"the run ended at its start, t = 0 s: {Status.PAINLEVE.sentence}; {PRESSES_BACK}"
            raise SolveError(message, Status.PAINLEVE)

    def _begin_points(self, points: PointEquations) -> None:
        first = conditioned(points, 0.0, self.y, ContactModes((1,) * points.k, ((),) * points.k, aloft=frozenset(range(points.k))))
        mode = points.begun(0.0, self.y, first)
        if mode is None:
            raise SolveError(f"the run ended at its start, t = 0 s: {Status.PAINLEVE.sentence}; {PRESSES_BACK}", Status.PAINLEVE)
        self.y, self.mode = points.at_rest(0.0, self.y, mode), mode

    def _memories(self, values: Array) -> tuple[tuple[int, ...], ...]:
        whole = iter([int(m) for m in values])
        return tuple(tuple(itertools.islice(whole, law.modes)) for law in self.equations.laws)

    def _slips(self) -> list[float]:
        return self.equations.slips(self.t, *self.equations.state(self.y))

    # ---- instants that are known ----
    def throw(self, jump: Jumps, sample: bool = False) -> None:
        """An impulse, a sample, or an instant at which something that is prescribed changes: slips may jump, positions stay."""
        e, before = self.equations, self.mode
        self.y[e.n : 2 * e.n] += jump
        if self.points is not None:
            self.mode = conditioned(self.points, self.t, self.y, self.mode)
            self._after_points(self.points, {})
            return
        if sample:
            self.y = e.sampled(self.t, self.y)
        w = self._slips()
        sides = {i: 1 if w[i] > 0 else -1 for i, side in enumerate(before.sides[: e.k]) if self._jumped(i, side, w[i], any(jump))}
        for i in sides:
            if e.dynamic[i]:
                self._pass_zero(i)
        limit = _BEFORE * e.scale_of_velocity
        sides |= {i: 1 for i, side in enumerate(before.sides) if i >= e.k and side == 0 and abs(w[i]) > limit}  # it moves otherwise now
        still = [i for i, side in enumerate(before.sides[: e.k]) if side and w[i] == 0.0]
        self.mode = conditioned(e, self.t, self.y, self.mode.moved(sides))
        self._choose(still)
        self._bounce([])

    def _jumped(self, i: int, side: int, w: float, thrown: bool) -> bool:
        """Whether a slip has left its side."""
        if side:
            return side * w < 0.0
        return w != 0.0 if thrown and self.equations.n == 1 else abs(w) > _BEFORE * self.equations.scale_of_velocity

    # ---- between them ----
    def go(self, end: float) -> None:
        """Run up to a time, or until a contact is lost."""
        while self.t < end and not self.ended:
            self._move(end)
            self.counts["restarts"] += 1
            self._count()
        if not self.ended:
            self.t = end

    def _count(self) -> None:
        """Stop a run that chatters, or that has used up its steps."""
        e, recent = self.equations, self.recent
        recent.append((self.t, self.mode.sides[: e.k]))
        while recent[0][0] < self.t - e.scale_of_time:
            recent.popleft()
        at_once = len(recent) > _MANY and recent[-_MANY - 1][0] > self.t - _AT_ONCE * e.scale_of_time
        if at_once or len(recent) > _EVENTS * (1 + e.k + len(e.stops)):
            self._stop(Status.CHATTERS)

    def _left(self, t: float) -> float:
        """How many steps more a run may take up to a time: what hardly goes on ends early, what goes on is never short of them."""
        e = self.equations
        return (_LEAST + _STEPS * t / e.scale_of_time if e.is_scaled else _UNSCALED) - self.counts["steps"]

    def _stop(self, status: Status) -> NoReturn:
        """End a run before its time."""
        raise SolveError(self.message(status), status)

    def message(self, status: Status) -> str:
        """Where and why the run ended before its time."""
        e, sides = self.equations, np.array([sides for _, sides in self.recent], int).reshape(len(self.recent), -1)
        where = location(e.mechanics, self.t, e.state(self.y)[1], Changes.of(sides), e.state(self.y)[0])
        state = ", ".join(f"{value:.9g}" for value in self.y.tolist())
        slow = status == Status.BUDGET and self.todo.method == "dop853"
        return stopping_message(status, where, state, STIFF if slow else remedy(status, self.todo.rtol, False))

    def pieces(self) -> PolynomialPieces:
        """The dense output up to now."""
        if self.ended and not self.parts:
            after = remedy(self.ended, self.todo.rtol, False)
            raise SolveError(f"the run ended at its start, t = 0 s: {self.ended.sentence}; {after}", self.ended)
        return joined_output(self.parts, self.t, self.equations)

    def _move(self, end: float) -> None:
        e = self.equations
        look()
        stretch = integrate(self.todo, e, self.t, self.y, end, self.mode, self._left)
        if self.todo.keep == "trajectory":
            self.todo.progress(int(stretch.t / float(self.todo.span[0])), self.todo.periods)
        self.parts += stretch.parts
        self.counts["steps"] += stretch.steps
        self.counts["evaluations"] += stretch.evaluations
        self.t, self.y = stretch.t, e.at_rest(stretch.t, stretch.y, self.mode)
        if self._left(self.t) <= 0 and self.t < end:
            self._stop(Status.BUDGET)
        if stretch.fired:
            self._take(stretch.fired, bool(stretch.parts))

    # ---- events ----
    def _take(self, fired: list[Guard], moved: bool) -> None:
        """Do what the events of one instant say."""
        parts = {sort: [guard for guard in fired if guard.sort == sort] for sort in {guard.sort for guard in fired}}
        if "load" in parts or "border" in parts:
            self.ended = Status.PAINLEVE if "border" in parts else Status.LOST
            return
        if self.points is not None:
            for guard in parts.pop("kink", []):
                self._flip(guard.part, guard.which)
            if parts:
                self._after_points(self.points, parts)
            if moved and "slip" in parts and "landing" not in parts:
                self.parts[-1].end_at(self.points.output(self.t, self.y, self.mode))
            return
        if self.equations.flying:
            self._fly(parts)
        e, touched = self.equations, [guard.part for guard in parts.get("slip", [])]
        if touched:
            self.y = e.at_rest(self.t, self.y, self.mode.moved(dict.fromkeys(touched, 0)))
            if moved:
                self.parts[-1].end_at(e.output(self.t, self.y, self.mode))
        for guard in parts.get("switch", []):
            self._switch(guard.part, guard.which)
        for i in touched:
            if e.dynamic[i]:
                self._pass_zero(i)
        for guard in parts.get("kink", []):
            self._flip(guard.part, guard.which)
        if "gap" in parts:
            self._bounce([guard.part for guard in parts["gap"]], touched)
        elif "slip" in parts or "limit" in parts or 0 in self.mode.sides:
            self._choose(touched, self._broken(parts.get("limit", [])))

    def _after_points(self, points: PointEquations, parts: dict[str, list[Guard]]) -> None:
        """What follows the events of several points that push on the ground at once."""
        self.y, mode = points.after(self.t, self.y, self.mode, parts)
        if mode is None:
            self.ended = Status.PAINLEVE
        else:
            self.mode = mode

    def _fly(self, parts: dict[str, list[Guard]]) -> None:
        """Slips that pass zero in flight, contacts that leave, and those that land; what else has come to zero slip is left in `parts`."""
        e, slips = self.equations, parts.pop("slip", [])
        for guard in slips:
            if guard.part in self.mode.aloft:
                self.y = e.at_rest(self.t, self.y, self.mode.moved({guard.part: 0}))
                self.mode = self.mode.moved({guard.part: -self.mode.sides[guard.part]})
        parts |= {"slip": own} if (own := [guard for guard in slips if guard.part not in self.mode.aloft]) else {}
        if left := [guard.part for guard in parts.pop("take-off", [])]:
            self.mode = taken_off(e, self.t, self.y, self.mode, left)
        for guard in parts.pop("landing", []):
            self._land(guard.part)

    def _land(self, i: int) -> None:
        """A contact comes down: it slides on, rests, or is thrown up again."""
        self.y, self.mode, stopped = landed(self.equations, self.t, np.array(self.y, float), self.mode, i)
        if stopped and i in self.mode.aloft:
            self.mode = turned_aloft(self.equations, self.t, self.y, self.mode, [i])
        elif stopped:
            self._choose([i])

    def _broken(self, limits: list[Guard]) -> dict[int, int]:
        """Rows that break away the way that their guard says: those that do so alone among the rows that rest with them."""
        broken: dict[int, int] = {}
        for group in self.equations.groups(self.mode.sides):
            own = [guard for guard in limits if guard.part in group.rows and guard.which]
            if len(own) == 1:
                broken |= group.broken(own[0].part, own[0].which)
        return broken

    def _choose(self, touched: list[int], forced: dict[int, int] | None = None) -> None:
        self.y, self.mode = after_event(self.equations, self.t, self.y, self.mode, touched, forced)

    def _switch(self, i: int, k: int) -> None:
        """One switch of a law's memory."""
        e = self.equations
        load = e.pressed(e.time(self.t), self.y, self.mode).on(self.mode.sides)[i]
        _, memory, z = e.switches(self.y, i, self.mode, self._slips()[i], load)[k]
        self._remember(i, memory, z)

    def _pass_zero(self, i: int) -> None:
        """A slip velocity is zero, or has jumped across it."""
        z, memory = self.equations.passed_zero(self.t, self.y, i, self.mode)
        self._remember(i, memory, z)

    def _remember(self, i: int, memory: Any, z: Any) -> None:
        if z is not None:
            first, last = self.equations.inner[i]
            self.y[first:last] = z
        own = [*self.mode.memory]
        own[i] = tuple(map(int, memory))
        self.mode = replace(self.mode, memory=tuple(own))

    def _flip(self, what: int, n: int) -> None:
        """A condition of forces or loads changes."""
        kinks = [*self.mode.kinks]
        kinks[what] = tuple(side != (m == n) for m, side in enumerate(kinks[what]))
        self.mode = replace(self.mode, kinks=(kinks[0], kinks[1]))

    # ---- stops ----
    def _bounce(self, fired: list[int], touched: list[int] | None = None) -> None:
        """Hits: velocities jump, contacts whose slips do are free, and a stop that is pressed and hardly rebounds is closed."""
        e, before = self.equations, self._slips()
        rows = hits.touching_stops(e, self.t, self.y, fired) if e.stops else []
        self.y, met = hits.rebound(e, self.t, self.y, rows)
        if not met and not fired:
            return
        self.hits += [Hit(self.t, e.stops[i - e.k].name, velocity) for i, velocity in met.items()]
        after = self._slips()
        freed = {
            i: 1 if after[i] > 0 else -1 for i, side in enumerate(self.mode.sides[: e.k])
            if abs(after[i] - before[i]) > 1e-14 * e.scale_of_velocity and after[i] != 0.0
        }  # fmt: skip
        for i in freed:
            if e.dynamic[i] and freed[i] != self.mode.sides[i]:
                self._pass_zero(i)
        opened = dict.fromkeys(rows, 1)
        self.mode = conditioned(e, self.t, self.y, self.mode.moved(freed | opened))
        self._choose([i for i in touched or [] if i not in freed])
        self._close(rows)

    def _close(self, rows: list[int]) -> None:
        closed = hits.closing_stops(self.equations, self.t, self.y, self.mode, rows)
        if closed:
            self.hits += [Hit(when, self.equations.stops[i - self.equations.k].name, 0.0) for i, when in closed.items()]
            self._choose(list(closed))
