"""A machine's equations in plain floats, in one mode; the state is q, u and the inner states z of each contact in turn.

A mode says on which side of zero slip each contact is (0: a set-valued one rests), which stops are closed, and what conditions and
memories hold. A stop that is closed is a contact that rests, with the limits -infinity and 0; both are rows of one list here.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike, Model, Numeric
from stickslip.basics.errors import SolveError
from stickslip.models.friction.law_adapter import TINY, Switches
from stickslip.models.machine_adapter import machine_of
from stickslip.solvers.plain.deciding import ROUNDING, blocks
from stickslip.solvers.plain.kinks import Sides, Watching
from stickslip.solvers.plain.own_route import OwnRoute
from stickslip.solvers.plain.resting import RestingGroup, group_of

_NO_LIMIT = 1e3  # of the first load: what rests under less friction than that
SHORT = 1e-8  # of a period: rebounds that end within it are one event
_HELD = 1e-14  # of the velocity scale: what rounding makes of a velocity that a law without a state holds
_UNPRESSED = 1e-12  # of the force that gives a mass the velocity scale in a period: a load that follows from forces may touch zero
_BESIDE = 1e-12  # of the number that falls to zero where loads that follow from the motion are infinite: a run ends before
_ASIDE = 1e-13  # of a period: how far from a break the drive is asked, so that it answers from the right side of it

Memory = tuple[int, ...]
Floats = list[float]


@dataclass(frozen=True)
class ContactModes:
    """The values held constant while an integrator steps."""

    sides: tuple[int, ...]  # of each contact, then of each stop: 0 closed, 1 open
    memory: tuple[Memory, ...]  # of each contact's law
    kinks: tuple[Sides, Sides] = ((), ())  # of forces, of loads
    aloft: frozenset[int] = frozenset()  # contacts in flight; their sides are those of their slips

    def moved(self, sides: dict[int, int]) -> ContactModes:
        """With other sides."""
        return replace(self, sides=tuple(sides.get(i, side) for i, side in enumerate(self.sides)))


@dataclass
class Rates:
    """The effect of a mode on a state: rates of all states, and the forces of all rows."""

    u: Floats
    accelerations: Floats
    inner: Floats
    R: Floats
    push: Floats  # rate of each slip, less what resting rows do to it


@dataclass(frozen=True)
class Pressed:
    """Normal forces of all contacts, if they go forwards or are about to, and backwards [N]; and those of rests that bear what they can."""

    forwards: Floats
    backwards: Floats
    at_limits: tuple[Floats, Floats] | None = None

    def on(self, sides: Sequence[int]) -> Floats:
        """Those of the sides on which contacts are; of one that rests the one forwards."""
        return [b if side < 0 else a for a, b, side in zip(self.forwards, self.backwards, sides, strict=False)]


class Equations:
    """The equations of a machine within one interval between known instants."""

    def __init__(self, model: Model):
        machine = machine_of(model)
        self.model, self.mechanics = model, (mechanics := machine.mechanics)
        self.own: Any = OwnRoute(mechanics) if mechanics.joined else mechanics
        self.laws, self.stops, self.principal = mechanics.laws, mechanics.stops, machine.principal
        self.masses = [float(m) for m in mechanics.masses]
        self.n = len(self.masses)
        self.rows = self.rows_at(0.0, [float(x) for x in mechanics.start], [0.0] * self.n)
        self.biases: Floats = [0.0] * len(self.rows)  # rates of the slips that rows which vary with the place have of themselves
        self.alone = [
            None if varies or sum(map(bool, row)) != 1 else next((c for c, g in enumerate(row) if g), 0)
            for row, varies in zip(self.rows, [*mechanics.varying, *(False for _ in self.stops)], strict=True)
        ]
        self.weighed: tuple[float, ...] = ()
        self._weigh([[g / m for g, m in zip(row, self.masses, strict=True)] for row in self.rows])
        self.dynamic = [*(law.dynamic for law in self.laws), *(False for _ in self.stops)]
        self._count()
        self.cyclic = not mechanics.knows_place
        self.unpressed = [
            _UNPRESSED * self.masses[c or 0] * float(machine.velocity_scale) / float(machine.time_scale or 1.0) if of else 0.0
            for c, of in zip(self.alone, mechanics.of_motion or [False] * len(self.laws), strict=False)
        ]
        self.is_scaled = machine.time_scale is not None
        self.scale_of_time, self.scale_of_velocity = float(machine.time_scale or 1.0), float(machine.velocity_scale)
        self.least = [law.least_creep(self.scale_of_velocity, mechanics.difference(i)) for i, law in enumerate(self.laws)]
        self.no_reversal = [_HELD * self.scale_of_velocity if law.holds_velocity else 0.0 for law in self.laws]
        self.first, self.last, self.first_loads = -math.inf, math.inf, [0.0] * len(self.laws)
        self.of_motion, self.switching = any(mechanics.of_motion), any(law.switching for law in self.laws)
        self.grounded = [0.0] * self.k  # no contact is in flight
        self.forces, self.pressing = Watching(self._moved), Watching(self._pressed if self.of_motion else mechanics.loads)
        self.last_state: tuple[Any, ...] = ()
        self.last_loads: tuple[Floats, Floats] = ([], [])
        self.last_limits: tuple[Floats, Floats] | None = None  # of contacts that rest and bear what they can
        self.largest: tuple[dict[int, float], dict[int, float]] = ({}, {})  # difference that each condition has seen

    def _weigh(self, weights: list[Floats]) -> None:
        """What a unit force in each row does to the coordinates' velocities, and to all rows."""
        self.weights, joined = weights, self.mechanics.joined
        self.G = [[_dot(row, weight) for weight in self.weights] for row in self.rows]
        self.effective = [
            _effective(row, None if joined else c, self.masses, self.G[i][i])
            for i, (row, c) in enumerate(zip(self.rows, self.alone, strict=True))
        ]
        self.groups = lru_cache(maxsize=256)(self._groups)

    def look(self, t: float, q: Floats, u: Floats) -> None:
        """Weigh anew where the matrix of inertia, or a row, is that of a place."""
        if self.mechanics.joined and self.weighed != (at := (t, *q, *u)):
            self.weighed = at
            self.rows, self.biases = self.rows_at(t, q, u), [*self.own.biases(t, q, u), *(0.0 for _ in self.stops)]
            self._weigh(self.own.felt(t, q, u))

    def rows_at(self, t: float, q: Sequence[float], u: Sequence[float]) -> list[tuple[float, ...]]:
        """What slips and gaps take of the coordinates' velocities."""
        own = self.own.rows(t, q, u) if self.mechanics.joined else self.mechanics.rows(t, q)
        return [tuple(map(float, row)) for row in (*own, *(stop.direction for stop in self.stops))]

    def _count(self) -> None:
        self.n, self.k = len(self.masses), len(self.laws)
        self.applied = [i for i, law in enumerate(self.laws) if law.needs_applied]
        if any(self.G[i][j] != 0 for i in self.applied for j in range(self.k) if j != i):
            names = ", ".join(self.laws[i].name for i in self.applied)
            raise SolveError(f"{names} asks for the force that holds its contact, and another contact of the same body decides on it too")
        ends = list(itertools.accumulate(self.mechanics.inner, initial=2 * self.n))
        self.inner = list(itertools.pairwise(ends))
        self.flying = [i for i, law in enumerate(self.laws) if law.flies]
        self.size = ends[-1]
        self.held = slice(self.size - self.mechanics.controllers.count, self.size)

    # ---- time and state ----
    def between(self, first: float, last: float) -> None:
        """Ask the drive between two of its breaks only."""
        aside = _ASIDE * self.scale_of_time + 2 * math.ulp(last)
        self.first, self.last = first + aside, last - aside

    def time(self, t: float) -> float:
        """An instant on this side of the breaks."""
        return min(max(float(t), self.first), self.last)

    def state(self, y: Any) -> tuple[Floats, Floats]:
        """Coordinates and their velocities."""
        values = y if type(y) is list else y.tolist() if isinstance(y, np.ndarray) else list(map(float, y))
        return values[: self.n], values[self.n : 2 * self.n]

    def z(self, y: Any, i: int) -> tuple[float, ...]:
        """Inner states of a contact."""
        first, last = self.inner[i]
        return tuple(map(float, y[first:last]))

    def controlled(self, y: Any) -> Floats:
        """States of the controllers."""
        return list(map(float, y[self.held]))

    def sampled(self, t: float, y: Numeric) -> Any:
        """The state after a sample of the controllers."""
        y, (q, u) = np.array(y, float), self.state(y)
        y[self.held] = list(map(float, self.mechanics.control_sampled(self.time(t), q, u, self.controlled(y))))
        return y

    def sizes(self, t: float, y: Any) -> Any:
        """A typical size of each state, against which errors are measured."""
        T, speed = self.scale_of_time, self.scale_of_velocity or 1.0
        inner: Floats = []
        speeds = [speed] * self.n
        for i, (law, load) in enumerate(zip(self.laws, self.loads(t, y), strict=True)):
            creep, c = law.creep_velocity(self.z(y, i), load), self.alone[i]
            if creep is not None and c is not None:
                speeds[c] = min(speeds[c], float(creep) + self.least[i])
            typical = law.scale(load)
            inner += [speed * T] * law.states if typical is None else [float(v) if v > 0 else speed * T for v in typical]
        inner += map(float, self.mechanics.controllers.scales)
        return np.array([*[speed * T] * self.n, *speeds, *inner])

    # ---- kinematics ----
    def slips(self, t: float, q: Sequence[float], u: Sequence[float]) -> Floats:
        """Slip velocity of each contact, then opening velocity of each stop [m/s]."""
        t = self.time(t)
        return [*self._own_slips(t, q, u), *(float(stop.rate(t, u)) for stop in self.stops)]

    def _own_slips(self, t: float, q: Any, u: Any) -> Floats:
        """Slip velocities of the contacts."""
        return self.own.slips(t, q, u) if self.mechanics.joined else [*map(float, self.mechanics.slips(t, u))]

    def offset_rates(self, t: float) -> Floats:
        """Their rates while no coordinate's velocity changes, and as rows are [m/s^2]."""
        return [*map(float, self.mechanics.offset_rates(t)), *(float(stop.offset_rate(t)) for stop in self.stops)]

    def noise_of_slips(self, t: float, q: Sequence[float], u: Sequence[float], w: Sequence[float]) -> Floats:
        """The size of rounding errors in slips that are differences."""
        rows = self.rows_at(t, q, u) if self.mechanics.joined else self.rows
        terms = [[abs(g * v) for g, v in zip(row, u, strict=True) if g] for row in rows]
        rest = [abs(value - _dot(row, u)) for value, row in zip(w, rows, strict=True)]
        noise = [0.0 if b <= ROUNDING * sum(each) else b + self.scale_of_velocity for each, b in zip(terms, rest, strict=True)]
        return [0.0 if len(each) == 1 and not b else ROUNDING * (sum(each) + b) for each, b in zip(terms, noise, strict=True)]

    def gaps(self, t: float, q: Sequence[float]) -> Floats:
        """The distances left until stops close [m]."""
        t = self.time(t)
        return [float(stop.gap(t, q)) for stop in self.stops]

    def noise_of_gaps(self, q: Sequence[float]) -> float:
        """The size of rounding errors in a gap."""
        return ROUNDING * (max(map(abs, q)) + 0.01 * self.scale_of_velocity * self.scale_of_time) if self.stops else 0.0

    # ---- forces ----
    def loads(self, t: float, y: ArrayLike, mode: ContactModes | None = None) -> Floats:
        """Normal forces [N], of a contact that slides that of its side."""
        forwards, backwards = self._by_side(t, y, mode.kinks[1] if mode else ())
        if not self.of_motion:
            return forwards
        sides = mode.sides if mode else [1 if w >= 0.0 else -1 for w in self.slips(t, *self.state(y))]
        return [a if side >= 0 else b for a, b, side in zip(forwards, backwards, sides, strict=False)]

    def least_loads(self, t: float, y: ArrayLike, mode: ContactModes) -> Floats:
        """Normal forces [N], of a contact at rest the lesser one of its two sides."""
        forwards, backwards = self._by_side(t, y, mode.kinks[1])
        if not self.of_motion:
            return forwards
        return [min(a, b) if side == 0 else a if side > 0 else b for a, b, side in zip(forwards, backwards, mode.sides, strict=False)]

    def is_pressed_without_friction(self, i: int, t: float, y: ArrayLike) -> bool:
        """Whether a contact whose load follows from the motion would be one without its friction."""
        mechanics: Any = self.mechanics
        if not mechanics.joined or not mechanics.touching[i].is_held:
            return False
        return not mechanics.touching[i].pushes or float(self.own.rising(i, self.time(t), *self.state(y), self.controlled(y))) <= 0.0

    def presses(self, t: float, y: ArrayLike, i: int, load: float) -> float:
        """What is positive while a contact that may fly is pressed: its load, or how fast its point would go down without it."""
        return -float(self.own.rising(i, self.time(t), *self.state(y), self.controlled(y))) if self.mechanics.joined else load

    def borders(self, t: float, y: ArrayLike, mode: ContactModes) -> dict[int, float]:
        """By contact whose load follows from its motion what is positive as long as one load does, of one at rest the lesser of two."""
        if not self.mechanics.joined:
            return {}
        q, u = self.state(y)
        borders: dict[int, float] = {}
        for i, side in enumerate(mode.sides[: self.k]):
            both = [] if i in mode.aloft else [self.own.border(i, self.time(t), q, u, s) for s in ((1, -1) if side == 0 else (side,))]
            borders |= {i: min(both) - _BESIDE} if (both := [border for border in both if border is not None]) else {}
        return borders

    def _by_side(self, t: float, y: ArrayLike, kinks: Sides) -> tuple[Floats, Floats]:
        """Loads of contacts that slide forwards, or are about to, and backwards; the same twice where no load depends on the motion."""
        t, (q, u) = self.time(t), self.state(y)
        of = (q, u, self.controlled(y)) if self.of_motion else (q,)
        state = (kinks, t, *map(tuple, of))
        if state != self.last_state:  # the guards of one instant ask several times
            both = self.pressing(kinks, t, *of)
            self.last_state, self.last_loads = state, (both[: self.k], both[self.k : 2 * self.k]) if self.of_motion else (both, both)
            self.last_limits = (both[2 * self.k : 3 * self.k], both[3 * self.k :]) if len(both) > 2 * self.k else None
        return self.last_loads

    def _pressed(self, t: float, q: Any, u: Any, z: Any) -> list[Any]:
        """Loads of all contacts with their slips held forwards, then backwards."""
        if self.mechanics.joined:
            rests = [not law.dynamic for law in self.laws]
            asked = [(side, still) for still in (False, True) for side in (1, -1)]
            return [
                self.own.load(i, t, q, u, z, side if rests[i] else None, still and rests[i]) for side, still in asked for i in range(self.k)
            ]
        loads = []
        for side in (1, -1):
            for i, w in enumerate(self.mechanics.slips(t, [float(v) for v in u])):
                c, moving = self.alone[i], [*u]
                if c is not None and not self.dynamic[i] and side * float(w) <= TINY:
                    moving[c] = u[c] + (side * TINY - float(w)) / self.rows[i][c]
                loads.append(self.own.load(i, t, q, moving, z))
        return loads

    def _moved(self, t: float, q: Any, u: Any, R: Any, z: Any, flies: Any) -> list[Any]:
        """Accelerations of the coordinates, and rates of what controllers hold; `flies` is 1 of a contact in flight."""
        m = self.mechanics
        aloft = (frozenset(i for i, of in enumerate(flies) if float(of)),) if m.joined else ()
        return [*self.own.accelerations(t, q, u, R, z, *aloft), *(m.control_rates(t, q, u, z) if m.controllers.count else ())]

    def flags(self, mode: ContactModes) -> Floats:
        """Of each contact 1 in flight."""
        return [float(i in mode.aloft) for i in range(self.k)] if mode.aloft else self.grounded

    def pressed(self, t: float, y: ArrayLike, mode: ContactModes) -> Pressed:
        """Normal forces on contacts that go forwards, and backwards; positive also a moment after a contact is lost, for steps look on."""
        forwards, backwards = self._by_side(t, y, mode.kinks[1])
        limits = self.last_limits and (self._at_limit(self.last_limits[0]), self._at_limit(self.last_limits[1]))
        return Pressed(self.kept_positive(forwards), self.kept_positive(backwards), limits)

    def _at_limit(self, loads: Floats) -> Floats:
        """Loads at the limits of rest; one that grows with friction beyond all bounds before such a limit has none, but is a number."""
        return [load if load > 0.0 else max(_NO_LIMIT * first, TINY) for load, first in zip(loads, self.first_loads, strict=True)]

    def kept_positive(self, loads: Floats) -> Floats:
        """Loads that are not less than next to nothing."""
        return [max(load, 1e-12 * first, TINY) for load, first in zip(loads, self.first_loads, strict=True)]

    def limits(self, loads: Pressed) -> list[tuple[float, float]]:
        """Static friction limits in each row [N]; a contact under a dynamic law never rests."""
        sides = list(zip(self.laws, *(loads.at_limits or (loads.forwards, loads.backwards)), strict=True))
        own = [(0.0, 0.0) if law.dynamic else (float(law.breakaway(b)[0]), float(law.breakaway(a)[1])) for law, a, b in sides]
        return [*own, *((-math.inf, 0.0) for _ in self.stops)]

    def sliding(self, i: int, side: int, w: float, load: float) -> float:
        """Friction of a set-valued contact that slides, or is about to [N]; an open stop has none."""
        return 0.0 if i >= self.k else float(self.laws[i].sliding(held(w, side), load))

    def motion(self, t: float, y: Any, mode: ContactModes) -> Rates:
        """Rates and forces of a state."""
        t = self.time(t)
        q, u = self.state(y)
        self.look(t, q, u)
        u = self.settled(t, q, u, mode)
        w, loads = self._own_slips(t, q, u), self.pressed(t, [*q, *u, *y[2 * self.n :]], mode)
        R, inner = self._friction(t, q, u, y, w, loads.on(mode.sides), mode)
        rates_of_all = self.forces(mode.kinks[0], t, q, u, R, self.controlled(y), self.flags(mode))
        a, inner = rates_of_all[: self.n], [*inner, *rates_of_all[self.n :]]
        R, rates = [*R, *(0.0 for _ in self.stops)], self.offset_rates(t)
        push = [_dot(row, a) + rate + own for row, rate, own in zip(self.rows, rates, self.biases, strict=True)]
        for group in self.groups(mode.sides):
            held_by = group.hold([push[i] for i in group.rows], lambda: self.limits(loads))
            for i, force in zip(group.rows, held_by, strict=True):
                R[i] = force
                a = [value - weight * force for value, weight in zip(a, self.weights[i], strict=True)]
        for i, side in enumerate(mode.sides):
            c = self.alone[i]
            if side == 0 and c is not None:
                a[c] = (0.0 - rates[i]) / self.rows[i][c]
        return Rates(u, a, inner, R, push)

    def _friction(
        self, t: float, q: Floats, u: Floats, y: ArrayLike, w: Floats, loads: Floats, mode: ContactModes
    ) -> tuple[Floats, Floats]:
        """Friction forces, 0 of what rests, and the rates of all inner states."""
        R, inner = [0.0] * self.k, list[float]()
        without = self.forces(mode.kinks[0], t, q, u, R, self.controlled(y), self.grounded)[: self.n] if self.applied else []
        applied = self._applied(t, without)
        for i, law in enumerate(self.laws):
            side = mode.sides[i]
            if not law.dynamic:
                R[i] = self.sliding(i, side, w[i], loads[i]) if side and i not in mode.aloft else 0.0
                inner += self._flight(t, q, y, mode, i) if law.flies else ()
            else:
                force, rate = law.response(held(w[i], side), self.z(y, i), loads[i], mode.memory[i], applied.get(i, 0.0), self.least[i])
                R[i] = float(force)
                inner += map(float, rate)
        for i in self.applied:  # bodies that a closed stop moves as one bear together what is applied to all of them
            as_one = self._as_one(self.alone[i] or 0, mode)
            if len(as_one) > 1:
                others = math.fsum(R[k] for k in range(self.k) if k != i and self.alone[k] in as_one)
                left = sum(self.masses[c] * (without[c] + float(self.mechanics.offset_rates(t)[i])) for c in as_one) - others
                R[i] = float(self.laws[i].response(held(w[i], mode.sides[i]), self.z(y, i), loads[i], mode.memory[i], left)[0])
        return R, inner

    def _as_one(self, first: int, mode: ContactModes) -> set[int]:
        """The coordinates that closed stops move with one."""
        together = {first}
        closed = [row for row, side in zip(self.rows[self.k :], mode.sides[self.k :], strict=True) if side == 0]
        for row in [row for row in closed for _ in closed]:
            ends = {c for c, h in enumerate(row) if h}
            together |= ends if together & ends else set()
        return together

    def _flight(self, t: float, q: Floats, y: ArrayLike, mode: ContactModes, i: int) -> tuple[float, float]:
        """Rates of a contact's gap and of that rate."""
        if i not in mode.aloft:
            return 0.0, 0.0
        if self.mechanics.joined:
            return self.z(y, i)[1], self.own.rising(i, t, q, self.state(y)[1], self.controlled(y))
        load = self._by_side(t, y, mode.kinks[1])[0][i]
        return self.z(y, i)[1], -load / self.masses[self.alone[i] or 0]

    def _applied(self, t: float, without: Floats) -> dict[int, float]:
        """The force that would keep the slip constant, for laws that need it, from the accelerations without friction [N]."""
        rates = self.mechanics.offset_rates(t) if self.applied else ()
        return {i: self.effective[i] * (_dot(self.rows[i], without) + float(rates[i])) for i in self.applied}

    def guards_of_points(self, t: float, y: ArrayLike, mode: ContactModes) -> list[Any] | None:
        """All guards of a mode where the contacts are several points that push on the ground; else None."""
        return None

    def right(self, mode: ContactModes) -> Callable[[float, Any], Floats]:
        """The right side of y' in a mode."""

        def finite(t: float, y: Array) -> Floats:
            try:
                motion = self.motion(t, y, mode)
            except ArithmeticError:  # a trial step far too long: the integrator takes a shorter one
                return [math.nan] * len(y)
            return [*motion.u, *motion.accelerations, *motion.inner]

        return finite

    def slip_rates(self, t: float, y: ArrayLike, mode: ContactModes) -> Floats:
        """Rates of all slips in a mode [m/s^2]."""
        a, rates = self.motion(t, y, mode).accelerations, self.offset_rates(self.time(t))
        return [_dot(row, a) + rate + own for row, rate, own in zip(self.rows, rates, self.biases, strict=True)]

    # ---- rest ----
    def _groups(self, sides: tuple[int, ...]) -> list[RestingGroup]:
        """Resting rows that push one another."""
        resting = [i for i, side in enumerate(sides) if side == 0]
        G = [[self.G[i][j] for j in resting] for i in resting]
        return [group_of([resting[n] for n in block], self.G, self.effective) for block in blocks(G)]

    def settled(self, t: float, q: Floats, u: Floats, mode: ContactModes) -> Floats:
        """Velocities with which resting rows do not slip at all."""
        if 0 not in mode.sides:
            return u
        u, w = list(u), self.slips(t, q, [0.0] * self.n)
        for group in self.groups(mode.sides):
            if all(self.alone[i] is not None for i in group.rows):
                i = group.rows[0]
                c = self.alone[i] or 0
                u[c] = (0.0 - w[i]) / self.rows[i][c]
            else:
                for i, impulse in zip(group.rows, group.project([w[i] + _dot(self.rows[i], u) for i in group.rows]), strict=True):
                    u = [value - weight * impulse for value, weight in zip(u, self.weights[i], strict=True)]
        return u

    def at_rest(self, t: float, y: ArrayLike, mode: ContactModes) -> Any:
        """The state with resting rows settled."""
        y = np.array(y, float)
        self.look(t, *self.state(y))
        y[self.n : 2 * self.n] = self.settled(self.time(t), *self.state(y), mode)
        return y

    # ---- memories and conditions ----
    def switches(self, y: ArrayLike, i: int, mode: ContactModes, w: float, load: float) -> Switches:
        """The switches of a law, at its slip and load: (guard, new memory, new inner states or None)."""
        return self.laws[i].switches(held(w, mode.sides[i]), self.z(y, i), load, mode.memory[i])

    def passed_zero(self, t: float, y: ArrayLike, i: int, mode: ContactModes) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        """Inner states and memory after the switches that wait for the slip velocity to pass zero."""
        load = self.pressed(self.time(t), y, mode).on(mode.sides)[i]
        return self.laws[i].passed_zero(self.z(y, i), load, mode.memory[i], mode.sides[i] or 1)

    def differences(self, t: float, y: Any, kinks: tuple[Sides | None, Sides | None]) -> tuple[Floats, Floats]:
        """The differences that the conditions of forces and loads compare."""
        t, (q, u) = self.time(t), self.state(y)
        asked = (q, u, self.controlled(y)) if self.of_motion else (q,)
        of_forces = self.forces.differences(kinks[0], t, q, u, [0.0] * self.k, self.controlled(y), self.grounded)
        return of_forces, self.pressing.differences(kinks[1], t, *asked)

    def output(self, t: float, y: Array, mode: ContactModes) -> Floats:
        """The states of the dense output: velocities of the coordinates, inner states, and positions where they are known."""
        q, u = self.state(y)
        self.look(t, q, u)
        return [*self.settled(self.time(t), q, u, mode), *map(float, y[2 * self.n :]), *(() if self.cyclic else q)]


def held(w: float, side: int) -> float:
    """A slip velocity, held on its side [m/s]."""
    return w if side * w > TINY else side * TINY


def _effective(row: Sequence[float], c: int | None, masses: Floats, own: float) -> float:
    """Force that changes a slip at unit rate [kg]."""
    return masses[c] / row[c] ** 2 if c is not None else 1.0 / own if own else math.inf


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    total = 0.0
    for x, y in zip(a, b, strict=True):
        if x:
            total += x * y
    return total
