"""Rounding of the rates of a Taylor step: sums of the sizes of their terms.

A rate is a difference of forces, which are large beside it near equilibrium, and what rounding makes of it is a part of them, not of the
rate. Two decisions of a step depend on it (``kernels/arcs.py``): whether a slip that begins at zero falls below it, and whether a
polynomial's slope is that of its equation. Both ask for these sizes only where they would shorten the step.
"""

from __future__ import annotations

from collections.abc import Sequence

from stickslip.engine.kernel_text import function
from stickslip.engine.rosenbrock_step import Step
from stickslip.engine.steptext import bound, held
from stickslip.engine.symbols import STATE, Sym, slope_of
from stickslip.engine.system import System, TracedContact
from stickslip.engine.write import Writer


class Sizes:
    """Writes the size of an expression: the sum of the absolute values of all terms that it is made of.

    Of what solves linear equations that would be beyond all measure, as pivots are made of pivots: there relative roundings of factors
    add up.
    """

    def __init__(self, eq: System, case_nodes: list[Sym]):
        self.w, self.start, self.solves = Writer(), bound(eq), bool(eq.graph.linear)
        self.w.case_nodes = case_nodes
        self._written: dict[int, str] = {}

    def of(self, node: Sym) -> str:
        """The name that holds the size of an expression."""
        if node.number not in self._written:
            self._written[node.number] = self.w.line(self.w.fresh(), self._text(node))
        return self._written[node.number]

    def _text(self, node: Sym) -> str:
        if node.level != STATE or node.op in ("variable", "flag"):
            return f"abs({self._value(node)})"
        if node.op in ("add", "subtract"):
            return " + ".join(map(self.of, node.args))
        if node.op == "multiply" and self.solves:
            a, b = node.args
            return f"abs({self._value(a)}) * {self.of(b)} + abs({self._value(b)}) * {self.of(a)}"
        if node.op == "multiply":
            return " * ".join(map(self.of, node.args))
        if node.op == "select":
            asked, yes, no = node.args
            return f"{self.of(yes)} if {self._value(asked)} > 0.0 else {self.of(no)}"
        return f"abs({self._value(node)}) + abs({self._value(slope_of(node))}) * {self.of(node.args[0])}"

    def weights(self, contact: TracedContact) -> dict[int, str]:
        """The factors of the coordinates' rates in that of a slip, where a contact has other coefficients than 1 and -1."""
        zero = contact.slip.graph.constant(0.0)
        return {j: f"abs({self._value(zero + g)}) * " for j, g in enumerate(contact.row) if contact.direction[j]}

    def _value(self, node: Sym) -> str:
        return self.w.value(node, self.start)


def hold_sizes(eq: System, case_nodes: list[Sym]) -> None:
    """Add to the numbers that a lane holds of its case those that sizes need."""
    sizes = Sizes(eq, case_nodes)
    for f in eq.active:
        sizes.of(f)
    for contact in eq.contacts:
        sizes.weights(contact)


def sizes_text(eq: System, step: Step, lanes: int, slips: Sequence[Sequence[TracedContact]]) -> str:
    """Text of the function that puts the sizes of the rates of all states into W, and behind them those of the watched guards' rates.

    `slips` has for each of these guards the contacts whose slip it is. Of one that is no slip the size is 0: its rate is taken as it is.
    """
    sizes = Sizes(eq, list(step.case_nodes))
    of_states = [sizes.of(f) for f in eq.active] + ["0.0"] * eq.passive
    of_guards = []
    for contacts in slips:
        moves = {j for contact in contacts for j, g in enumerate(contact.direction) if g}
        weights = {j: weight for contact in contacts for j, weight in sizes.weights(contact).items()}
        of_guards.append(" + ".join(weights.get(j, "") + of_states[j] for j in sorted(moves)) or "0.0")
    if len(sizes.w.case_nodes) > len(step.case_nodes):
        raise AssertionError("the sizes of a step's rates need a number that the step does not hold")
    lines = [*sizes.w.lines, *(f"W[{i}] = {text}" for i, text in enumerate([*of_states, *of_guards]))]
    return function("sizes", "lane, S, W", [*held(step, lanes, lines), *lines])
