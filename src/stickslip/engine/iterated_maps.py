"""A user's map, compiled: its iterates, and how a frame of small changes grows along an orbit.

The map is traced as the jump of a flow that jumps once in each period (`SwitchingFlow.of_map`), by the same means as every flow:
numbers that stand in its lines are numbers of the case, and what it asks by ``if`` becomes a choice.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.interruption import look
from stickslip.engine import cache
from stickslip.engine.flow_system import TracedFlow
from stickslip.engine.kernel_text import KernelSource, function, kernel_text
from stickslip.engine.values import needed_by
from stickslip.engine.write import Writer

if TYPE_CHECKING:
    from stickslip.models.switching_flow import SwitchingFlow

_AT_ONCE = 200_000  # iterations between two looks whether to end: some milliseconds


class MapSteps:
    """The compiled map of a flow of n states that was made of one.

    Parameters
    ----------
    flow : SwitchingFlow
        By `of_map`; what it does is the first of its switches.
    n : int
        How many states it has.

    Attributes
    ----------
    names : tuple of str
        The numbers of a row: those of the flow, then those that stand in its lines.
    constants : dict
        The latter.

    Examples
    --------
    >>> from stickslip.models.switching_flow import SwitchingFlow
    >>> steps = MapSteps(SwitchingFlow.of_map(lambda y, n: (n.r * y[0] * (1 - y[0]),), {"r": 4.0}), 1)
    >>> steps.names, steps.after(np.array([[4.0]]), np.array([[0.2]]), 2).round(12).tolist()
    (('r',), [[0.9216]])
    """

    def __init__(self, flow: SwitchingFlow, n: int):
        traced, self.states = TracedFlow(flow, n), n
        ends = [y if new is None else new for y, new in zip(traced.y, traced.switches[0].states, strict=True)]
        read = {node.name for node in needed_by(ends) if node.op == "case"}
        self.constants: Mapping[str, float] = {name: value for name, value in traced.graph.constants.items() if name in read}
        self.names = (*traced.numbers, *self.constants)
        slopes = [traced.graph.derivative(end, y) for end in ends for y in traced.y]
        bind = {name: f"row[{i}]" for i, name in enumerate(self.names)} | {y.name: f"y[{i}]" for i, y in enumerate(traced.y)}
        places = [f"out[{i}]" for i in range(n)], [f"out[{i}, {j}]" for i in range(n) for j in range(n)]
        text = "\n".join([
            f"STATES = {n}",
            _function("mapped", "row, y, out", "void(f1, f1, f1)", bind, places[0], ends),
            _function("sloped", "row, y, out", "void(f1, f1, f2)", bind, places[1], slopes),
            kernel_text("frames"),
            kernel_text("iterating_maps"),
        ])  # fmt: skip
        entries = {"iterate": "void(f2, f2, int64)", "grow": "void(f1, f1, f2, f2)"}
        code = cache.load(KernelSource(text, entries), "map", f"a map of {n} coordinate{'s' if n > 1 else ''}")
        self._iterate, self._grow = code["iterate"], code["grow"]

    def row(self, numbers: Mapping[str, Any], cases: int) -> Array:
        """The rows of some cases, of numbers that are single or have one for each."""
        rows, known = np.empty((cases, len(self.names))), {**self.constants, **numbers}
        for column, name in enumerate(self.names):
            rows[:, column] = known[name]
        return rows

    def after(self, rows: Array, states: Array, count: int) -> Array:
        """The states (cases, n) after so many iterations."""
        y, most = np.array(states, float, order="C"), max(_AT_ONCE // max(len(states), 1), 1)
        while count > 0:
            look()
            self._iterate(rows, y, min(count, most))
            count -= most
        return y

    def growth(self, row: Array, y: Array, Q: Array, count: int) -> Array:
        """Sizes (count, n) by which the directions of a frame grow in each of so many iterations; `y` and `Q` are brought to the end."""
        sizes = np.empty((count, self.states))
        self._grow(row, y, Q, sizes)
        return sizes


def _function(name: str, takes: str, kind: str, bind: dict[str, str], places: Sequence[str], ends: Sequence[Any]) -> str:
    """One function, which fills an array."""
    w = Writer(prefix="p")
    w.count_uses(ends)
    lines = [f"{target} = 1.0 * {w.value(end, bind)}" for target, end in zip(places, ends, strict=True)]
    return function(name, takes, [*w.lines, *lines], kind)
