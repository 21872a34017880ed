"""Expressions as lines of a language that has the functions of mathematics: C, MATLAB."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from stickslip.engine.lines import Lines
from stickslip.engine.symbols import Sym


@dataclass(frozen=True)
class Language:
    """How a language writes what differs between languages.

    Parameters
    ----------
    assigned, choice : str
        With {name} and {value}; with {held}, {yes} and {no}.
    functions : dict
        Name of a function of `stickslip.maths` -> its name there, with the limits that it has in `stickslip.maths`.
    """

    assigned: str
    choice: str
    functions: Mapping[str, str]


class Portable(Lines):
    """Lines of one language."""

    def __init__(self, language: Language, indent: str = "    "):
        super().__init__(prefix="")
        self.language, self.indent = language, indent

    def line(self, name: str, expression: str) -> str:
        """Write an assignment to a new name; returns the name."""
        self.lines.append(self.indent + self.language.assigned.format(name=name, value=expression))
        return name

    def _write(self, node: Sym, bind: dict[str, str]) -> str:
        below = next((k for k in (1, 0) if node.op == "multiply" and node.args[k].op == "reciprocal"), None)
        if below is None:
            return super()._write(node, bind)
        a, b = (self.value(x, bind) for x in (node.args[1 - below], node.args[below].args[0]))
        return self.line(self.fresh(), f"{a} / {b}")  # a quotient is rounded once

    def _choice(self, held: str, yes: str, no: str) -> str:
        return self.language.choice.format(held=held, yes=yes, no=no)

    def _function(self, node: Sym, bind: dict[str, str]) -> str:
        x = self.value(node.args[0], bind)
        return self.line(self.fresh(), f"{self.language.functions[node.op]}({x})")


def body(language: Language, roots: Iterable[Sym], bind: dict[str, str]) -> tuple[list[str], list[str]]:
    """The lines that compute some expressions, and the names or numbers that then hold them.

    Examples
    --------
    >>> from stickslip.engine.symbols import Graph
    >>> graph = Graph()
    >>> plain = Language("{name} = {value};", "choose({held}, {yes}, {no})", {"exp": "exp"})
    >>> body(plain, [graph.case("mu") * graph.variable("load")], {"mu": "p.mu", "load": "load"})
    (['    q1 = p.mu * load;'], ['q1'])
    """
    writer = Portable(language)
    ends = [writer.value(root, bind) for root in roots]
    return writer.lines, ends
