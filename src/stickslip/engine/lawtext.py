"""Functions of a law's kernel besides its step: constants of a case; flags, modes and guards at an instant; the applied force."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from stickslip.engine.driver import gauss
from stickslip.engine.kernel_text import LOOKS, function, kernel_text
from stickslip.engine.symbols import Sym
from stickslip.engine.system import System
from stickslip.engine.values import needed_by
from stickslip.engine.write import Writer


def prelude(eq: System, nodes: list[Any]) -> str:
    """Once per case: everything that depends on its numbers alone."""
    w = Writer(prefix="p")
    bind = {name: f"row[{i}]" for i, name in enumerate(eq.names)}
    ends = [w.value(node, bind) for node in nodes]
    return function("prelude", "row, c", [*w.lines, *(f"c[{i}] = {end}" for i, end in enumerate(ends))])


def looks(eq: System) -> str:
    """The held values of a lane for its time and state: flags of clocks, modes, values of guards; and the effect of passing rest."""
    bind = {name: f"row[{i}]" for i, name in enumerate(eq.names)} | {"t": "t"} | {s.name: f"y[{i}]" for i, s in enumerate(eq.y)}
    bind |= {f"clk{k}": f"clock[{k}]" for k in range(len(eq.clocks))} | {s.name: f"mode[{i}]" for i, s in enumerate(eq.modes)}
    sides = {f"b{k}": f"b{k}" for k in range(eq.signs)}
    writers = [Writer(prefix=letter) for letter in "pqrsuwm"]
    for k, clock in enumerate(eq.clocks):
        writers[0].line(f"out[{k}]", f"-1.0 if {writers[0].value(clock, bind)} < 0.0 else 1.0")
    for k in _flags_in(eq.first_modes):
        writers[1].line(f"b{k}", f"-1.0 if {writers[1].value(eq.guards[k], bind | sides)} < 0.0 else 1.0")
    news = [f"mode[{i}] = {writers[1].value(new, bind | sides)}" for i, new in enumerate(eq.first_modes)]
    for k, guard in enumerate(eq.guards):
        writers[2].line(f"out[{k}]", f"1.0 * {writers[2].value(guard, bind | sides)}")
        if k < eq.signs:
            writers[2].line(f"b{k}", f"-1.0 if out[{k}] < 0.0 else 1.0")
    passed = []
    if eq.dynamic and 0 in eq.switches:
        w, switch = writers[3], eq.switches[0]
        w.line("b0", "-1.0 if y[0] < 0.0 else 1.0")
        active = switch.states[: eq.states - eq.passive]
        given = {i: new for i, new in enumerate(active) if new is not None} | eq.forgetting
        for k in _flags_in([*switch.modes, *given.values()]):
            if k:
                w.line(f"b{k}", f"-1.0 if {w.value(eq.guards[k], bind | sides)} < 0.0 else 1.0")
        passed = [f"mode[{i}] = {w.value(new, bind | sides)}" for i, new in enumerate(switch.modes)]
        passed += [f"y[{i}] = {w.value(new, bind | sides)}" for i, new in given.items()]
    held = {f"b{k}": f"mode[{len(eq.modes) + k}]" for k in range(eq.signs)}
    for i, rate in enumerate(eq.carried):
        writers[4].line(f"out[{i}]", f"1.0 * {writers[4].value(rate, bind | held)}")
    resting = [f"y[{i}] = {writers[5].value(new, bind)}" for i, new in eq.settled.items()]
    for k in _flags_in(eq.sampled.values()):
        writers[6].line(f"b{k}", f"-1.0 if {writers[6].value(eq.guards[k], bind | sides)} < 0.0 else 1.0")
    sampled = [f"out[{i}] = 1.0 * {writers[6].value(new, bind | sides)}" for i, new in eq.sampled.items()]
    bodies = zip(LOOKS, (w.lines for w in writers), ([], news, [], passed, [], resting, sampled), strict=True)
    takes, parts, calls = "row, t, y, clock, mode, out", [], []
    for what, (name, before, after) in enumerate(bodies):
        if before or after:
            parts.append(function(name.lower(), takes, [*before, *after], "void(f1, float64, f1, f1, f1, f1)"))
            calls += [f"if what == {what}:", f"    {name.lower()}({takes})"]
    return "\n".join([*parts, function("look", f"what, {takes}", calls)])


def _flags_in(roots: Iterable[Sym]) -> list[int]:
    """The guards whose flags some expressions need, those that others need first."""
    return sorted(int(node.name[1:]) for node in needed_by(roots) if node.op == "flag" and re.fullmatch(r"b\d+", node.name))


def rule_of_work(degree: int) -> tuple[list[float], list[float]]:
    """Nodes and weights of Gauss's rule for the work in a step of a degree."""
    return gauss(4 if degree < 8 else degree // 3 + 2)


def work(eq: System, degree: int) -> str:
    """The work of friction in a step: it takes the force that all but friction offer, by time."""
    nodes, weights = rule_of_work(degree)
    tables = [f"NODES, WEIGHTS = {nodes!r}, {weights!r}"]
    bind = {name: f"row[{i}]" for i, name in enumerate(eq.names)} | {"t": "t"}
    bind |= {f"clk{k}": f"S[F_CLK + {k} * L + lane]" for k in range(len(eq.clocks))}
    w = Writer(prefix="p")
    value = "math.nan" if eq.offered is None else w.value(eq.offered, bind)
    force = function("force", "lane, S, row, t", [*w.lines, f"return 1.0 * {value}"], "float64(int64, f1, f1, float64)")
    return "\n".join([*tables, force, kernel_text("work")])
