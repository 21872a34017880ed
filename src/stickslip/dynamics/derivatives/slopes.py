"""Values of a machine's plain functions of its numbers, and their derivatives along directions in these numbers."""

from __future__ import annotations

from collections.abc import Callable
from threading import Lock
from typing import Any

import numpy as np

from stickslip.basics.batch import labels_of, numbers_by_name
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import Problems
from stickslip.basics.fields import replace_leaf
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates
from stickslip.engine.graphs import Along
from stickslip.engine.kinds import kind_of
from stickslip.engine.remembered import Remembered
from stickslip.engine.symbolic import numbers_of
from stickslip.engine.symbols import Graph, Sym
from stickslip.engine.tangent import part_in
from stickslip.engine.values import values_of
from stickslip.models.machine_adapter import machine_of
from stickslip.solvers.initial_states import start_states

_functions: Remembered[_Functions] = Remembered()


class _Functions:
    """A kind of machine with symbols for its numbers: what its plain functions give, and their changes along directions, made once."""

    def __init__(self, model: Model, along: tuple[str, ...]):
        self.graph, self.names, self.lock = Graph(), numbers_of(model), Lock()
        self.machine = machine_of(replace_leaf(model, {name: self.graph.case(name) for name in self.names}))
        self.machine.mechanics.alike(machine_of(model).mechanics)
        self.along = Along(self.graph, {name: self.graph.case(part_in(name)) for name in along})
        self._made: Remembered[tuple[list[Sym], list[Sym]]] = Remembered()

    def of(self, what: Callable[..., Any], *args: Any) -> tuple[list[Sym], list[Sym]]:
        """The value of a function of the machine, and its derivatives."""
        with self.lock:
            return self._made((what, args), lambda: self._nodes(what, args))

    def _nodes(self, what: Callable[..., Any], args: Any) -> tuple[list[Sym], list[Sym]]:
        values = [value if isinstance(value, Sym) else self.graph.constant(value) for value in what(self.machine, *args)]
        return values, [self.along.of(value) for value in values]


class Slopes:
    """Values of a machine's plain functions, and their changes along directions in its numbers; functions of a module, with arguments."""

    def __init__(self, model: Model, along: dict[str, Array], cases: int):
        names, own, self.cases = tuple(along), numbers_by_name(model), cases
        self.functions = _functions((kind_of(model), names), lambda: _Functions(model, names))
        self.known = {name: own[name] for name in self.functions.names} | {part_in(name): part for name, part in along.items()}

    def values(self, what: Callable[..., Any], *args: Any) -> list[Array]:
        """The values of a function of the machine, one for each case."""
        return self._each(self.functions.of(what, *args)[0])

    def of(self, what: Callable[..., Any], *args: Any) -> list[Array]:
        """The changes of that."""
        return self._each(self.functions.of(what, *args)[1])

    def _each(self, nodes: list[Sym]) -> list[Array]:
        computed = values_of(self.functions.graph, self.known, nodes)
        return [np.broadcast_to(np.asarray(computed[node.number], float), (self.cases,)) for node in nodes]


def number_slopes(model: Model, along: dict[str, Array], what: Callable[[Any], Any], cases: int = 1) -> list[Array]:
    """Changes of what a function of a module gives of the machine, along directions in its numbers."""
    return Slopes(model, along, cases).of(what)


def start_changes(model: Model, start: dict[str, Any], along: dict[str, Array], cases: int) -> Array:
    """Changes of the state in which a run begins, where the model says it and not who asked for the run: array (cases, states)."""
    at, slopes, m = coordinates(model), Slopes(model, along, cases), machine_of(model).mechanics
    placed, bent = _given(start.get("x"), m.bodies), _given(start.get("z"), m.contacts)
    held = {m.coordinate_of(body) for body in placed}
    owners = [name for name, law in zip(m.contacts, m.laws, strict=True) for _ in range(law.states)]
    q = [0.0 * d if j in held else d for j, d in enumerate(slopes.of(_start))]
    first = start_states(model, labels_of(model), start or None, Problems("start"))[0].tolist()
    there = tuple(x if j in held else None for j, x in enumerate(first[: len(q)])), tuple(first[len(q) : 2 * len(q)])
    z = [0.0 * d if name in bent else d for name, d in zip(owners, slopes.of(_inner_starts, *there), strict=True)]
    on, given = slopes.of(_control_starts, *there), _given(start.get("control"), m.controllers.names)
    owners = [name for name, count in zip(m.controllers.names, m.controllers.counts, strict=True) for _ in range(count)]
    z += [0.0 * d if name in given else d for name, d in zip(owners, on, strict=True)]
    return np.column_stack(at.order.joined(q, [np.zeros(cases)] * len(q), z))


def _given(values: Any, names: tuple[str, ...]) -> tuple[str, ...]:
    """The parts whose numbers a start says."""
    return () if values is None else tuple(values) if isinstance(values, dict) else names


def _start(machine: Any) -> Any:
    """Positions in which a machine begins."""
    return machine.mechanics.start


def _placed(machine: Any, q: tuple[float | None, ...]) -> tuple[Any, ...]:
    """The positions that a start says, and the machine's own where it says none."""
    return tuple(own if given is None else given for given, own in zip(q, machine.mechanics.start, strict=True))


def _inner_starts(machine: Any, q: tuple[float | None, ...], u: tuple[float, ...]) -> list[Any]:
    """Inner states of contacts that nobody has moved, under the loads where a run begins."""
    mechanics = machine.mechanics
    loads = mechanics.loads(0.0, _placed(machine, q), u)
    return [z for law, load in zip(mechanics.laws, loads, strict=True) for z in law.start(load)]


def _control_starts(machine: Any, q: tuple[float | None, ...], u: tuple[float, ...]) -> list[Any]:
    """States of controllers that are switched on where a run begins."""
    return list(machine.mechanics.control_start(0.0, _placed(machine, q), u))


def period_of(machine: Any) -> list[Any]:
    """Its period, as what `Slopes` are asked for."""
    return [machine.mechanics.period]
