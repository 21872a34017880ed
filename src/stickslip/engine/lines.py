"""From expressions to lines of a language: each is written once, in the order in which they need one another."""

from __future__ import annotations

from abc import ABC, abstractmethod

from stickslip.engine.symbols import FUNCTIONS, Sym


def literal(value: float) -> str:
    """A float as text that reads back exactly, in Python and in every language that writes numbers as C does."""
    return f"({value!r})" if value < 0 else repr(float(value))


class Lines(ABC):
    """Collects lines; every expression is written once for given values of what it depends on. A language says how it is written."""

    def __init__(self, prefix: str = "_") -> None:
        self.lines: list[str] = []
        self._known: dict[tuple[int, tuple[str, ...]], str] = {}
        self._depends: dict[int, tuple[str, ...]] = {}
        self._count = 0
        self._prefix = prefix
        self.indent = ""

    def line(self, name: str, expression: str) -> str:
        """Write ``name = expression``; returns the name."""
        self.lines.append(f"{self.indent}{name} = {expression}")
        return name

    def fresh(self) -> str:
        """A new local name."""
        self._count += 1
        return f"{self._prefix}q{self._count}"

    def depends(self, node: Sym) -> tuple[str, ...]:
        """Names of the variables and flags that a node depends on."""
        if node.number not in self._depends:
            if node.op in ("variable", "flag"):
                names: tuple[str, ...] = (node.name,)
            else:
                names = tuple(sorted({d for a in node.args for d in self.depends(a)}))
            self._depends[node.number] = names
        return self._depends[node.number]

    def value(self, node: Sym, bind: dict[str, str]) -> str:
        """The name (or literal) that holds a node's value, written now if it was not before."""
        if node.op == "constant":
            return literal(node.value)
        if node.op in ("variable", "flag"):
            return bind[node.name]
        key = (node.number, tuple(bind[d] for d in self.depends(node)))
        if key not in self._known:
            self._known[key] = self._write(node, bind)
        return self._known[key]

    def _write(self, node: Sym, bind: dict[str, str]) -> str:
        if node.op == "case":
            return bind[node.name]
        if node.op in FUNCTIONS or node.op == "bell":
            return self._function(node, bind)
        if node.op in ("add", "subtract"):
            return self._sum(node, bind)
        a = [self.value(x, bind) for x in node.args]
        text = {
            "multiply": lambda: f"-{a[1]}" if a[0] == "(-1.0)" else f"{a[0]} * {a[1]}",
            "reciprocal": lambda: f"1.0 / {a[0]}",
            "select": lambda: self._choice(*a),
        }[node.op]()
        return self.line(self.fresh(), text)

    def _choice(self, held: str, yes: str, no: str) -> str:
        """The line that selects `yes` where `held` is positive, else `no`."""
        return f"{yes} if {held} > 0.0 else {no}"

    def _sum(self, node: Sym, bind: dict[str, str]) -> str:
        """The name of a sum or a difference."""
        a, b = (self.value(x, bind) for x in node.args)
        return self.line(self.fresh(), f"{a} {'+' if node.op == 'add' else '-'} {b}")

    @abstractmethod
    def _function(self, node: Sym, bind: dict[str, str]) -> str:
        """The name of a function's value."""
