"""A judge for stiff machines: SciPy's Radau steps on the traced equations, with their Jacobian, as plain Python on numbers.

The judge of `judging.py` asks the machine's plain Python at every stage, which takes milliseconds; stiff laws of five bodies keep it for
minutes. This one shares with the engine what the equations are, and nothing of how they are integrated: steps and events are its own.
That the equations are those of the plain Python is asked apart (`trace_differs`), at instants of the run.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import scipy.integrate
import scipy.optimize

from stickslip.basics.batch import numbers_by_name
from stickslip.engine.symbols import Sym
from stickslip.engine.system import System
from stickslip.engine.trace import trace
from stickslip.engine.values import needed_by
from stickslip.models.machine_adapter import machine_of

__all__ = ["TracedRun", "trace_differs"]

LOOKS = 8  # parts of a step at whose ends guards are looked at
EVENTS = 20_000  # in a period
ROUNDING = 1e-12  # of the largest value that a guard has had
BESIDE = 1e-13  # of a period: how far from a known instant conditions on time are asked


def _reciprocal(x: float) -> float:
    return 1.0 / x if x else math.inf


def _log(x: float) -> float:
    return math.log(x) if x > 0 else -math.inf


def _exp(x: float) -> float:
    return math.exp(x) if x < 700.0 else math.inf


KNOWN = {name: getattr(math, name) for name in ("sin", "cos", "atan", "sinh", "cosh", "tanh", "asinh")}
KNOWN |= {"exp": _exp, "log": _log, "sqrt": lambda x: math.sqrt(x) if x >= 0 else math.nan, "reciprocal": _reciprocal}
KNOWN |= {"bell": lambda x: 1.0 / math.cosh(x) ** 2 if abs(x) < 300.0 else 0.0}
SIGNS = {"add": "+", "subtract": "-", "multiply": "*"}


def _function(eq: System, roots: Sequence[Sym], numbers: dict[str, float]) -> Callable[..., list[float]]:
    """A Python function (t, y, b, clk, mode) of these expressions."""
    places = {s.name: f"y[{i}]" for i, s in enumerate(eq.y)} | {"t": "t"}
    lines = ["def told(t, y, b, clk, mode):"]
    for node in needed_by(roots):
        a = [f"n{arg.number}" for arg in node.args]
        match node.op:
            case "constant":
                text = repr(node.value)
            case "case":
                text = repr(numbers[node.name])
            case "variable":
                text = places[node.name]
            case "flag":
                name = next(name for name in ("clk", "mode", "b") if node.name.startswith(name))
                text = f"{name}[{node.name[len(name) :]}]"
            case "select":
                text = f"{a[1]} if {a[0]} > 0 else {a[2]}"
            case "add" | "subtract" | "multiply":
                text = f"{a[0]} {SIGNS[node.op]} {a[1]}"
            case _:
                text = f"{node.op}({a[0]})"
        lines.append(f"    n{node.number} = {text}")
    lines.append(f"    return [{', '.join(f'n{root.number}' for root in roots)}]")
    space: dict[str, Any] = {**KNOWN, "inf": math.inf, "nan": math.nan}
    exec("\n".join(lines), space)  # text of our own graph
    return space["told"]


def _settled(count: int, values: Callable[[list[float]], list[float]]) -> list[float]:
    """Signs of so many values, which may depend on one another's."""
    found = [1.0] * count
    for _ in range(count):
        before, found = found, [-1.0 if value < 0 else 1.0 for value in values(found)[:count]]
        if found == before:
            break
    return found


class TracedRun:
    """A run of a machine under laws with inner states, from where a run of the engine begins."""

    def __init__(self, machine: Any, begins: Any, rtol: float):
        self.machine, self.rtol, self.eq = machine, rtol, (eq := trace(machine))
        if not eq.dynamic:
            raise ValueError("only laws with inner states")
        self.mechanics = machine_of(machine).mechanics
        self.numbers = {name: float(np.ravel(value)[0]) for name, value in numbers_by_name(machine, slice(None)).items()}
        self.end = float(begins.t[-1]) if machine.period is None else math.inf
        self.numbers["span"] = self.end
        self.f, self.jacobian = self._told(eq.f), self._told([j for row in eq.jacobian for j in row])
        self.guards, self.velocity = self._told(eq.guards), self._told([eq.y[0] + eq.offset])
        self.clocks = self._told(eq.clocks)
        self.switched = {k: self._switch(k) for k in eq.switches}
        self.period = float(begins.t[-1]) if machine.period is None else float(machine.period)
        self.slips = {c.guard: c.state for c in eq.contacts if c.guard is not None and c.state is not None}
        self.parts: list[tuple[float, float, Any]] = []
        self.status, self.time, self.largest = "finished", 0.0, np.zeros(len(eq.guards))
        self._begin(begins)

    def _told(self, roots: Sequence[Sym]) -> Callable[..., list[float]]:
        return _function(self.eq, list(roots), self.numbers)

    def _switch(self, k: int) -> tuple[Callable[..., list[float]], list[int]]:
        switch = self.eq.switches[k]
        places = [i for i, new in enumerate(switch.states) if new is not None]
        return self._told([*switch.modes, *(switch.states[i] for i in places)]), places  # type: ignore[list-item]

    def _begin(self, begins: Any) -> None:
        eq = self.eq
        self.y = np.append(state_of(begins, eq, self.mechanics, 0.0), coordinates(begins, self.mechanics, 0.0, "x")[0])
        self.mode = [0.0] * len(eq.modes)
        memory = begins.pieces.memory[0] if np.size(begins.pieces.memory) else []
        for k, value in zip((k for c in eq.contacts for k in c.modes), memory, strict=False):
            self.mode[k] = float(value)
        self.b, self.clk = [1.0] * eq.signs, [1.0] * len(eq.clocks)

    # ---- known instants ----
    def run(self, periods: int) -> TracedRun:
        """So many periods, or one span."""
        instants = {float(s) for s in self._told(self.eq.instants)(0.0, self.y, self.b, self.clk, self.mode)}
        jumps = self._told([each for instant, jump in self.eq.impulses for each in (instant, *jump)])(
            0.0, self.y, self.b, self.clk, self.mode
        )
        n = self.eq.coordinates
        self.kicks = [(jumps[i], jumps[i + 1 : i + 1 + n]) for i in range(0, len(jumps), n + 1)]
        sample = [float(v) for v in self._told(self.eq.sampling)(0.0, self.y, self.b, self.clk, self.mode)]
        if sample:
            instants |= {k * sample[0] for k in range(1, math.ceil(self.period / sample[0] - 1e-6))}
        T = self.period
        known = sorted({0.0, T, *(s for s in {*instants, *(s for s, _ in self.kicks)} if 1e-12 * T < s < T * (1 - 1e-12))})
        known = [s for s, before in zip(known, [-T, *known], strict=False) if s - before > 1e-12 * T]
        self.sample = sample[0] if sample else None
        for turn in range(periods):
            self.turn, self.count = turn * T, 0
            for first, last in itertools.pairwise(known):
                self._pass(first, turn > 0 or first > 0)
                self._go(first, last)
                if self.status != "finished":
                    return self
        return self

    def _pass(self, t: float, kicked: bool) -> None:
        """What happens at a known instant, and what holds after it."""
        eq, before = self.eq, self.y[0]
        self.clk = self.sides_of_clocks(t + BESIDE * self.period)
        thrown = False
        for instant, jump in self.kicks if kicked else []:
            if min(abs(t - instant), abs(self.period - abs(t - instant))) <= 1e-12 * self.period:
                self.y[: eq.coordinates] += jump
                thrown = True
        if thrown and len(eq.contacts) == 1 and eq.switches.get(0) and before * self.y[0] < 0:
            self._take(0, t)
        if self.sample and kicked and abs(t / self.sample - round(t / self.sample)) <= 1e-6:
            new = self._told(list(eq.sampled.values()))(t + BESIDE * self.period, self.y, self.b, self.clk, self.mode)
            for i, value in zip(eq.sampled, new, strict=True):
                self.y[i] = value
        self.b = self.sides_of_guards(t, self.y, self.clk, self.mode)
        self.fresh = {k for k, value in enumerate(self._values(t, self.y)) if value == 0.0}

    def sides_of_clocks(self, t: float) -> list[float]:
        """Conditions on time; one may stand in another."""
        return _settled(len(self.eq.clocks), lambda found: self.clocks(t, [], self.b, found, self.mode))

    def sides_of_guards(self, t: float, y: Any, clk: list[float], mode: list[float]) -> list[float]:
        """The flags where a state begins; one may decide what another's guard is."""
        return _settled(self.eq.signs, lambda found: self.guards(t, list(y), found, clk, mode))

    # ---- between them ----
    def _right(self, t: float, y: Any) -> list[float]:
        y = y.tolist()
        try:
            return [*self.f(t, y, self.b, self.clk, self.mode), *self.velocity(t, y, self.b, self.clk, self.mode)]
        except ArithmeticError:
            return [math.nan] * len(y)

    def _slopes(self, t: float, y: Any) -> Any:
        n = self.eq.states
        found = np.zeros((n + 1, n + 1))
        found[:n, :n] = np.reshape(self.jacobian(t, y.tolist(), self.b, self.clk, self.mode), (n, n))
        found[n, 0] = 1.0
        return found

    def _values(self, t: float, y: Any) -> Any:
        return np.array(self.guards(t, list(y), self.b, self.clk, self.mode))

    def _held(self, t: float, y: Any) -> Any:
        """All guards on the sides that their flags hold."""
        return self._values(t, y) * np.array([*self.b, *[1.0] * (len(self.largest) - len(self.b))])

    def _solver(self, t: float, end: float, y: Any) -> Any:
        scale = float(machine_of(self.machine).velocity_scale)
        creep = [c.creep_velocity for c in self.eq.contacts]
        sizes = [scale * 1e-2] * self.eq.coordinates + [0.0] * (len(y) - self.eq.coordinates)
        for i in range(self.eq.coordinates, len(y)):
            node = self.eq.scales[i] if i < len(self.eq.scales) else None
            sizes[i] = scale * self.period if node is None else abs(self._told([node])(t, y.tolist(), self.b, self.clk, self.mode)[0])
        if any(c is not None for c in creep):
            sizes[: self.eq.coordinates] = [1e-9 * scale] * self.eq.coordinates
        return scipy.integrate.Radau(
            self._right, t, y, end, rtol=self.rtol, atol=self.rtol * np.array(sizes) + 1e-300, jac=self._slopes,
            max_step=0.05 * self.period, first_step=min(end - t, 1e-4 * self.period),
        )  # fmt: skip

    def _go(self, t: float, last: float) -> None:
        while t < last and self.status == "finished":
            if self._late(t):
                continue
            solver, event = self._solver(t, last, self.y), None
            while solver.status == "running" and event is None:
                before = solver.y.copy()
                solver.step()
                if solver.status == "failed":
                    self.status = f"failed at {self.turn + t:.9g} s"
                    return
                event = self._event(solver)
                if event is None:
                    self.parts.append((self.turn + solver.t_old, self.turn + solver.t, solver.dense_output()))
                    self.fresh = set()
            t = self._landed(solver, before, event) if event is not None else last
            self.y = self.y if event is not None else solver.y.copy()
        self.time = self.turn + t

    def _late(self, t: float) -> bool:
        """Take an event that is due at once: a guard that lies beyond its zero, because another's event moved it."""
        values = self._held(t, self.y)
        due = [k for k, value in enumerate(values) if value < -1e-9 * max(self.largest[k], 1e-300) and k not in self.fresh]
        if due:
            self._take(due[0], t)
        return bool(due)

    def _event(self, solver: Any) -> tuple[float, int] | None:
        """The first guard that falls below zero in a step."""
        dense, start, h = solver.dense_output(), solver.t_old, solver.t - solver.t_old
        times = start + h * np.arange(LOOKS + 1) / LOOKS
        values = np.array([self._held(t, dense(t)) for t in times])
        self.largest = np.maximum(self.largest, np.max(abs(values), axis=0))
        found: tuple[float, int] | None = None
        for k in np.flatnonzero(np.any(values[1:] < -ROUNDING * self.largest, axis=0)):
            j = int(np.argmax(values[1:, k] < -ROUNDING * self.largest[k]))
            at = times[j]
            if values[j, k] > 0:
                at = scipy.optimize.brentq(lambda t, k=k: self._held(t, dense(t))[k], times[j], times[j + 1], xtol=1e-300, rtol=1e-15)
            elif k in self.fresh and values[j, k] > -1e-6 * self.largest[k] and j == 0 and values[-1, k] < values[0, k]:
                at = start
            found = (float(at), int(k)) if found is None or at < found[0] else found
        return found

    def _landed(self, solver: Any, before: Any, event: tuple[float, int]) -> float:
        """Step up to the event, and do what it says."""
        t, k = event
        if t - solver.t_old > 1e-14 * self.period:
            again = self._solver(solver.t_old, t, before)
            while again.status == "running":
                again.step()
                if again.status != "failed":
                    self.parts.append((self.turn + again.t_old, self.turn + again.t, again.dense_output()))
            self.y = again.y.copy()
        else:
            self.y = before
        self._take(k, t)
        return t

    def _take(self, k: int, t: float) -> None:
        self.count += 1
        if self.count > EVENTS:
            self.status = "too many events"
        if (status := self.eq.switches[k].status if k in self.eq.switches else 0) != 0:
            self.status = f"status {status}"
            return
        if k in self.slips and abs(self.y[self.slips[k]]) < 1e-6 * max(self.largest[k], 1e-300):
            self.y[self.slips[k]] = 0.0
        if k in self.switched:
            told, places = self.switched[k]
            new = told(t, self.y.tolist(), self.b, self.clk, self.mode)
            self.mode = new[: len(self.mode)]
            for i, value in zip(places, new[len(self.mode) :], strict=True):
                self.y[i] = value
        if k < len(self.b):
            self.b[k] = -self.b[k]
        self.fresh = {k}

    # ---- what came of it ----
    @property
    def t(self) -> Any:
        """Begin and end [s]."""
        return np.array([0.0, self.time])

    @property
    def parted(self) -> TracedRun:
        """It has axes for all bodies."""
        return self

    def at(self, t: Any) -> dict[str, Any]:
        """Positions of the bodies (time, body)."""
        starts = np.array([part[0] for part in self.parts])
        rows = []
        for now in np.ravel(t):
            first, last, dense = self.parts[max(int(np.searchsorted(starts, now, side="right")) - 1, 0)]
            y = dense(min(max(now, first), last) - first + dense.t_old)
            q = y[list(self.eq.positions)]
            q = [y[-1], *(y[-1] + q)] if self.eq.cyclic else q
            rows.append(self.mechanics.positions(now, tuple(map(float, q))))
        return {"x": np.array(rows, float)}


def coordinates(run: Any, mechanics: Any, t: float, name: str) -> Any:
    """Positions, velocities or accelerations of the coordinates at an instant of a run."""
    return np.array(mechanics.coordinates_of(tuple(np.asarray(run.parted.at(t)[name], float).reshape(len(mechanics.bodies)))), float)


def state_of(run: Any, eq: System, mechanics: Any, t: float) -> Any:
    """The states of the equations at an instant of a run."""
    q, u = coordinates(run, mechanics, t, "x"), coordinates(run, mechanics, t, "v")
    counts = [law.states for law in mechanics.laws]
    z = np.asarray(run.parted.at(t)["z"], float).reshape(len(counts), -1) if sum(counts) else np.zeros((len(counts), 0))
    held = [float(value) for value in mechanics.control_start(t, tuple(q), tuple(u))]  # as a run begins
    inner = np.concatenate([*(row[:count] for row, count in zip(z, counts, strict=True)), held])
    rows = _function(eq, list(eq.offsets), {n: float(np.ravel(a)[0]) for n, a in numbers_by_name(run.model, slice(None)).items()})
    offsets = rows(t, [], [], [], [])
    return np.concatenate([u - offsets, inner, q[1:] - q[0] if eq.cyclic else q])


def trace_differs(run: Any, judge: TracedRun, looks: int = 40) -> float:
    """How much accelerations by the traced equations differ from those of plain Python, in the middle of the instants of a run (median).

    While bodies are pressed against one another a mode says so that the columns of a run do not hold: these instants are left out.
    nan where no instant can be asked; so of machines with controllers, whose states are not in a run's columns.
    """
    eq, m = judge.eq, judge.mechanics
    found: list[float] = []
    if m.controllers.count:
        return math.nan
    for t in np.linspace(0.0, float(run.t[-1]), looks + 2)[1:-1]:
        if _pressed(run, m, t):
            continue
        own, y = t % judge.period, state_of(run, eq, m, t)
        clk = judge.sides_of_clocks(own)
        mode = [0.0] * len(eq.modes)
        at = int(np.searchsorted(run.pieces.t, t, side="right")) - 1
        for k, value in zip((k for c in eq.contacts for k in c.modes), np.ravel(run.pieces.memory[at : at + 1]), strict=False):
            mode[k] = float(value)
        b = judge.sides_of_guards(own, y, clk, mode)
        told = np.array(judge.f(own, y.tolist(), b, clk, mode))[: eq.coordinates]
        plain = coordinates(run, m, t, "acceleration")
        found.append(
            float(np.max(abs(told - plain)) / max(np.max(abs(plain)), 1e-3 * float(machine_of(run.model).velocity_scale) / judge.period))
        )
    return float(np.median(found)) if found else math.nan


def _pressed(run: Any, mechanics: Any, t: float) -> bool:
    """Is a stop closed, with no velocity across it?"""
    q, u = tuple(coordinates(run, mechanics, t, "x")), tuple(coordinates(run, mechanics, t, "v"))
    machine = machine_of(run.model)
    least = 1e-9 * float(machine.velocity_scale)
    way = least * float(machine.time_scale or 1.0)
    return any(abs(stop.gap(t, q)) <= way and abs(stop.rate(t, u)) <= least for stop in mechanics.stops)
