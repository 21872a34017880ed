"""The classical Runge-Kutta method with a fixed step, compiled: the method of a hand-written script.

It reads the same traced equations as every other method, but holds nothing fixed: the side of v (and every other condition
in the law) is decided anew in each stage, from the state of that stage, as a script with ``sign(v)`` does.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from stickslip.basics.contracts import Model
from stickslip.basics.errors import InputError
from stickslip.engine import cache
from stickslip.engine.kernel_text import KernelSource, function
from stickslip.engine.lanes import plain_name
from stickslip.engine.lawtext import prelude
from stickslip.engine.symbols import Sym
from stickslip.engine.trace import System, label, trace
from stickslip.engine.write import Writer

#: What the compiled function is: row, state (x, v, z...), periods, steps per period, steps per node (0: no nodes), then what it fills:
#: strobe states, nodes (x, v, z..., dv, dz...), largest and smallest v. It returns the periods done, fewer where the state is no number.
_KIND = "int64(f1, f1, int64, int64, int64, f2, f2, f1)"


@dataclass(frozen=True)
class TracedSlopes:
    """Data of a model for a Runge-Kutta stage; y[0] = v, then the inner states."""

    names: tuple[str, ...]
    t: Sym
    y: tuple[Sym, ...]
    f: tuple[Sym, ...]
    guards: tuple[Sym, ...]
    held: Sym | None  # dv/dt at v = 0 exactly, for a set-valued law
    clocks: tuple[Sym, ...]
    period: Sym


@dataclass(frozen=True)
class FixedStepKernel:
    """The compiled loop, and the numbers of the model that make its row."""

    advance: Any
    names: tuple[str, ...]
    states: int


def traced_slopes(model: Model) -> TracedSlopes:
    """The right side of a model's equations, for a law of either kind; what a plain Runge-Kutta script does not do is refused."""
    eq = trace(model)
    if why := lacks(eq):
        raise InputError("solve", [f'{why}; type method="auto"'])
    return (
        TracedSlopes(eq.names, eq.t, eq.y, eq.f, eq.guards[: eq.signs], None, eq.clocks, eq.period) if eq.dynamic else _usual_practice(eq)
    )


def lacks(eq: System) -> str:
    """Features of the equations that a plain Runge-Kutta script does not handle; "" if there are none."""
    if not eq.single:
        return "it takes one body on one contact, and this machine lists several"
    lacking = [what for what, there in (("impulses", eq.impulses), ("a law that remembers", eq.dynamic and eq.modes)) if there]
    if not eq.cyclic:
        lacking.append("a mechanism with springs")
    if eq.offset.level or eq.offset.value != 0:
        lacking.append("a contact that moves")
    return f"it knows robots without impulses or memory; here is {' and '.join(lacking)}" if lacking else ""


def _usual_practice(eq: System) -> TracedSlopes:
    """Sliding friction by the sign of v, and at v = 0 what holds the body, up to break-away."""
    assert eq.contact is not None
    graph, c = eq.graph, eq.contact
    held = graph.select(c.push, c.push, graph.select(c.pull, -c.pull, graph.constant(0.0)))
    slides = graph.select(eq.y[0], c.forwards, c.backwards)
    return TracedSlopes(eq.names, eq.t, eq.y, (slides,), eq.guards[: eq.signs], held, eq.clocks, eq.period)


def fixed_step_kernel(model: Model) -> FixedStepKernel:
    """The compiled loop of a model's kind."""
    s, name = traced_slopes(model), label(model)
    source = KernelSource(_Loop(s).text(), {"advance": _KIND})
    return FixedStepKernel(cache.load(source, f"rk4_{plain_name(name)}", f"{name} (RK4, fixed steps)")["advance"], s.names, len(s.y))


class _Loop:
    """Writes the loop over periods and steps."""

    def __init__(self, s: TracedSlopes):
        self.s, self.w, self.n = s, Writer(), len(s.y)

    def _stage(self, q: int, t: str, y: list[str]) -> list[str]:
        """Slopes k<q>_<i> at one stage; every flag is read off the stage's own state."""
        w = self.w
        bind = {symbol.name: name for symbol, name in zip(self.s.y, y, strict=True)} | {"t": t}
        for k, clock in enumerate(self.s.clocks):
            bind[f"clk{k}"] = w.line(f"_clk{q}_{k}", f"1.0 if {w.value(clock, bind)} > 0.0 else -1.0")
        for k, guard in enumerate(self.s.guards):
            bind[f"b{k}"] = w.line(f"_b{q}_{k}", f"1.0 if {w.value(guard, bind)} > 0.0 else -1.0")
        f = [w.line(f"_k{q}_{i}", f"1.0 * {w.value(fi, bind)}") for i, fi in enumerate(self.s.f)]
        if self.s.held is not None:
            w.line(f[0], f"{w.value(self.s.held, bind)} if {y[0]} == 0.0 else {f[0]}")
        return f

    def _lines(self) -> tuple[list[str], list[str]]:
        """The lines of one step: before the nodes are kept, and after."""
        w, n = self.w, range(self.n)
        y = [f"_y{i}" for i in n]
        w.line("_t", "s * h")
        stages = [self._stage(1, "_t", y)]
        first = len(w.lines)
        w.line("_th", "_t + 0.5 * h")
        w.line("_te", "_t + h")
        speeds = [y[0]]
        for q, (part, t) in enumerate((("0.5 * h", "_th"), ("0.5 * h", "_th"), ("h", "_te")), start=2):
            at = [w.line(f"_y{q}_{i}", f"_y{i} + {part} * {stages[-1][i]}") for i in n]
            speeds.append(at[0])
            stages.append(self._stage(q, t, at))
        w.line("_x", f"_x + h / 6.0 * ({speeds[0]} + 2.0 * ({speeds[1]} + {speeds[2]}) + {speeds[3]})")
        for i in n:
            k = [stage[i] for stage in stages]
            w.line(f"_y{i}", f"_y{i} + h / 6.0 * ({k[0]} + 2.0 * ({k[1]} + {k[2]}) + {k[3]})")
        return w.lines[:first], w.lines[first:]

    def text(self) -> str:
        """The text of `prelude` and `advance`."""
        before, after = self._lines()
        nodes = self.w.case_nodes
        n, many = range(self.n), len(nodes)
        keep = ["_x", *(f"_y{i}" for i in n), *(f"_k1_{i}" for i in n)]
        lines = [f"c = np.empty({many + 1})", "prelude(row, c)", *(f"_c{i} = c[{i}]" for i in range(many))]
        lines += [f"h = c[{many}] / steps", "kept = 0", "_x = state[0]", *(f"_y{i} = state[{i + 1}]" for i in n)]
        lines += [
            "low, high = _y0, _y0",
            "for p in range(periods):",
            "    strobe[p, 0] = _x",
            *(f"    strobe[p, {i + 1}] = _y{i}" for i in n),
        ]
        lines += ["    for s in range(steps):", *(f"        {line}" for line in before)]
        lines += ["        if every > 0 and s % every == 0:", *(f"            nodes[kept, {j}] = {name}" for j, name in enumerate(keep))]
        lines += ["            kept += 1", *(f"        {line}" for line in after)]
        lines += ["        low = min(low, _y0)", "        high = max(high, _y0)"]
        lines += ["    if not (" + " and ".join(f"_y{i} - _y{i} == 0.0" for i in n) + "):", "        return p"]
        lines += ["state[0] = _x", *(f"state[{i + 1}] = _y{i}" for i in n), "extremes[0], extremes[1] = low, high", "return periods"]
        takes = "row, state, periods, steps, every, strobe, nodes, extremes"
        return "\n".join([prelude(self.s, [*nodes, self.s.period]), function("advance", takes, lines, _KIND)])
