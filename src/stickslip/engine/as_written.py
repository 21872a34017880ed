"""Whether traced equations are those of plain Python: a machine's functions are called with symbols twice, and with floats.

What asks for the type of its arguments, catches the error of a symbol, or keeps a value for the next call gives symbols something else
than numbers.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from stickslip.basics.batch import cases_of
from stickslip.basics.contracts import Model
from stickslip.basics.errors import InputError
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.engine.kinds import known_kind
from stickslip.engine.remembered import Remembered
from stickslip.engine.symbolic import numbers_of
from stickslip.engine.symbols import Graph, Sym
from stickslip.engine.values import needed_by, values_of
from stickslip.models.declaration import NOT_REPEATABLE, Arguments, answers, calls, instants
from stickslip.models.machine_adapter import fresh_mechanics
from stickslip.models.mechanics import Mechanics

Expressions = tuple[Sym, ...] | str  #: of a function, or the name of the error that it raises
_POINTS = 6
_SAME, _ASIDE, _HUGE = 1e-9, 1e-12, 1e250  # of a value; of the arguments, to see what rounding does; where functions end
_LEFT = 1e-14  # of the largest number of a function: what rounding leaves of a number whose parts cancel
_MOVED = np.array([[0.0], [_ASIDE]])  # parts by which arguments are moved: not at all, and a little
_checked: Remembered[bool] = Remembered()


def check_as_written(model: Model) -> None:
    """`InputError` where the traced functions of a machine differ from trace to trace, or from what plain Python gives."""
    _checked(known_kind(model), lambda: _check(model))


class _Traced:
    """All functions of a machine, called with symbols once."""

    def __init__(self, model: Model, m: Mechanics):
        self.graph = graph = Graph()
        graph.at_once, graph.begins_anew = True, model.period is not None
        own = fresh_mechanics(replace_leaf(model, {name: graph.case(name) for name in numbers_of(model)}))
        own.alike(m)
        variable, mode = graph.variable, graph.mode
        n, laws = range(m.coordinates), list(enumerate(m.laws))
        at = Arguments(
            variable("t"), tuple(variable(f"x{j}") for j in n), tuple(variable(f"v{j}") for j in n),
            tuple(variable(f"R{i}") for i, _ in laws), tuple(variable(f"w{i}") for i, _ in laws),
            tuple(variable(f"N{i}") for i, _ in laws),
            tuple(tuple(variable(f"z{i}_{k}") for k in range(law.states)) for i, law in laws),
            tuple(tuple(mode(f"mode{i}_{k}") for k in range(law.modes)) for i, law in laws),
            tuple(variable(f"c{k}") for k in range(m.controllers.count)),
        )  # fmt: skip
        self.names = at
        self.expressions = {
            name: given if isinstance(given, str) else self._lifted(given) for name, given in answers(calls(own, at)).items()
        }

    def _lifted(self, values: Sequence[Any]) -> tuple[Sym, ...] | str:
        try:
            return tuple(v if isinstance(v, Sym) else self.graph.constant(0.0 if v is None else v) for v in values)
        except Exception as error:  # what is no number is said where the equations are traced
            return type(error).__name__


def _check(model: Model) -> bool:
    what = type(model).__name__
    case = cases_of(model, slice(1))[0]
    m = fresh_mechanics(case)
    one, other = _Traced(model, m), _Traced(model, m)
    check_traces(what, one.expressions, other.expressions)
    points = instants(case, m, _POINTS)
    plain = [answers(calls(m, at)) for at in points]
    described = [f"t = {at.t:.6g}, velocities {', '.join(f'{v:.6g}' for v in at.u)}" for at in points]
    for name, values in _values(one, case, points).items():
        for k, instant in enumerate(described):
            given = plain[k].get(name, "")
            if not isinstance(given, str) and len(given) == len(values):
                compare(what, name, instant, given, [(value[k], moved[k]) for value, moved in values])
    return True


def check_traces(what: str, one: Mapping[str, Expressions], other: Mapping[str, Expressions]) -> None:
    """`InputError` where two traces of the same functions, by name, are not the same expressions."""
    for name, roots in one.items():
        if _shape_of(roots) != _shape_of(other[name]):
            raise InputError(what, [f"{name} is another expression each time it is called with the same symbols; {NOT_REPEATABLE}"])


def values_by_name(
    graph: Graph, known: dict[str, Any], roots: Mapping[str, tuple[Sym, ...]], shape: tuple[int, ...]
) -> dict[str, list[list[Any]]]:
    """Values of expressions by name, from what is known of their symbols: a list of each, nested as an array of this shape."""
    values = values_of(graph, known, [node for nodes in roots.values() for node in nodes])
    return {name: [np.broadcast_to(values[node.number], shape).tolist() for node in nodes] for name, nodes in roots.items()}


def _shape_of(roots: Expressions) -> Any:
    """Expressions as a list of operations, the same for the same expressions of another graph."""
    if isinstance(roots, str):
        return roots
    nodes = needed_by(roots)
    order = {node.number: k for k, node in enumerate(nodes)}
    listed = [(node.op, tuple(order[a.number] for a in node.args), node.name, node.value.hex()) for node in nodes]
    return listed, [order[node.number] for node in roots]


def _values(traced: _Traced, case: Any, points: Sequence[Arguments]) -> dict[str, list[list[list[float]]]]:
    """Values of the expressions at some arguments, and where all of these are moved a little: two lists of each."""
    roots = {name: computed for name, computed in traced.expressions.items() if not isinstance(computed, str)}
    draw = np.random.default_rng(0)
    known: dict[str, Any] = {name: value * (1 + _MOVED * draw.uniform(-1, 1)) for name, value in leaves(case)}
    for symbol, *numbers in zip(_flat(traced.names), *map(_flat, points), strict=True):
        values = np.array(numbers, float)
        known[symbol.name] = values if symbol.op == "flag" else values * (1 + _MOVED * draw.uniform(-1, 1, len(points)))
    return values_by_name(traced.graph, known, roots, (2, len(points)))


def _flat(at: Arguments) -> list[Any]:
    """All arguments, one after the other."""
    return [at.t, *at.q, *at.u, *at.forces, *at.slips, *at.loads, *(z for own in (*at.inner, *at.memories) for z in own), *at.controlled]


def compare(what: str, name: str, at: str, given: Sequence[Any], values: Sequence[tuple[float, float]]) -> None:
    """`InputError` where plain Python and the traced expressions differ at some arguments by more than rounding does."""
    largest = max((abs(v) for v in given if isinstance(v, (int, float)) and abs(v) < _HUGE), default=0.0)
    for number, (value, moved) in zip(given, values, strict=True):
        if number is None or not isinstance(number, (int, float)):
            continue
        size = max(abs(number), abs(value))
        if not abs(number) < _HUGE or abs(number - value) <= _SAME * size + 3 * abs(value - moved) + _LEFT * largest:
            continue
        mistake = f"{name} gives {number:.9g} where it is called with numbers ({at})"
        traced = f"its equations, written down by calling it with symbols once, give {value:.9g}"
        raise InputError(what, [f"{mistake}; {traced}; {_ALIKE}"])


_ALIKE = (
    "allowed are functions that do the same with both: no isinstance(), no float() or str() of an argument, no try and except around "
    "them, nothing stored for the next call; write where(condition, yes, no), maximum, minimum and the functions of stickslip.maths"
)
