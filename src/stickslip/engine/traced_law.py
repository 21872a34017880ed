"""A friction law alone, called with symbols: its force, inner states, memories and break-away as expressions of one graph."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from stickslip.basics.contracts import Law
from stickslip.basics.errors import InputError
from stickslip.basics.fields import is_array, leaves, replace_leaf
from stickslip.engine.symbolic import numbers_of
from stickslip.engine.symbols import Graph, Sym, is_zero
from stickslip.engine.values import needed_by
from stickslip.models.friction.law_adapter import adapted


class TracedLaw:
    """The equations of a law in the variables v, load, applied, z0, z1, … and the modes mode0, mode1, ….

    Conditions are those of one instant, so that nothing is held.

    Parameters
    ----------
    law : law
        Any law; one that cannot be traced is refused.

    Examples
    --------
    >>> import stickslip as ss
    >>> law = TracedLaw(ss.Dahl.example())
    >>> list(law.numbers), law.force, law.exact
    (['mu_plus', 'mu_minus', 'sigma0'], multiply(sigma0, z0), True)
    """

    def __init__(self, law: Law):
        self.graph = graph = Graph()
        graph.at_once = True
        plain = adapted(law)
        if not plain.compiles:
            why = f"{plain.name} is solved in plain Python alone (it says scalar_only), so that its equations cannot be written down"
            raise InputError("law", [f"{why}; allowed is a law that compiles; type for example ss.friction.GMS.example()"])
        self.names, self._given = numbers_of(law), dict(leaves(law))
        self.law = own = adapted(replace_leaf(law, {name: graph.case(name) for name in self.names}))
        self.v, self.load, self.applied = (graph.variable(name) for name in ("v", "load", "applied"))
        self.z = tuple(graph.variable(f"z{i}") for i in range(own.states))
        self.mode = tuple(graph.mode(f"mode{i}") for i in range(own.modes))

    @cached_property
    def numbers(self) -> dict[str, float]:
        """The law's numbers by name; those of a batch are refused."""
        many = [name for name, value in self._given.items() if is_array(value)]
        if many:
            raise InputError("law", [f"{', '.join(many)} of {self.law.name} are arrays; allowed is one law, no batch; take one case of it"])
        return {name: float(self._given[name]) for name in self.names}

    def _lift(self, value: Any) -> Sym:
        return value if isinstance(value, Sym) else self.graph.constant(value)

    @cached_property
    def rates(self) -> tuple[Sym, ...]:
        """Rates of the inner states."""
        return tuple(map(self._lift, self.law.rate(self.v, self.z, self.load, self.mode)))

    @cached_property
    def force(self) -> Sym:
        """Friction force; of a set-valued law while it slides."""
        return self._lift(self.law.force(self.v, self.z, self.rates, self.load, self.mode, self.applied))

    @cached_property
    def response(self) -> Sym:
        """The same, of a law that creeps next to rest too."""
        return self._lift(self.law.resolved(0.0, self.v, self.z, self.rates, self.load, self.mode, self.applied))

    @cached_property
    def breakaway(self) -> tuple[Sym, Sym]:
        """Static friction limits of a set-valued law, backward and forward."""
        backward, forward = self.law.breakaway(self.load)
        return self._lift(backward), self._lift(forward)

    @cached_property
    def slopes(self) -> tuple[tuple[Sym, ...], ...]:
        """Derivatives of the rates by the inner states."""
        return tuple(tuple(self.graph.derivative(rate, z) for z in self.z) for rate in self.rates)

    @cached_property
    def switches(self) -> list[tuple[Sym, tuple[Sym, ...], tuple[Sym, ...]]]:
        """Guards, with the modes and the inner states after each."""
        switches = self.law.switches(self.v, self.z, self.load, self.mode)
        return [(self._lift(g), tuple(map(self._lift, m)), self.z if z is None else tuple(map(self._lift, z))) for g, m, z in switches]

    @cached_property
    def start(self) -> tuple[Sym, ...]:
        """Inner states of a contact that nobody has moved."""
        return tuple(map(self._lift, self.law.start(self.load)))

    @property
    def alone(self) -> bool:
        """Whether no inner state asks for another."""
        return all(is_zero(slope) for i, row in enumerate(self.slopes) for j, slope in enumerate(row) if i != j)

    @property
    def exact(self) -> bool:
        """Whether the rates are linear in the inner states for every velocity, load and memory."""
        conditions = [node.args[0] for node in needed_by(self.rates) if node.op == "select"]
        names = {z.name for z in self.z}
        return not any(names & self.graph.varies(node) for node in (*conditions, *(slope for row in self.slopes for slope in row)))
