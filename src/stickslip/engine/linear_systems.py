r"""Linear equations A x = b within a motion: their solution is known by what it solves, so that its Taylor series needs no quotients.

.. math:: A_0 x_m = b_m - \sum_{j=1}^{m} A_j x_{m-j}

With the inverse of A where a step begins, each order costs one product of series for each entry of A that varies; an elimination
written out would cost several for each, and a series for every quotient. Values, derivatives and all else are those of the elimination.
Matrices of inertia, and what friction forces are while contacts rest and slide as their modes say, come this way (`solution`, `extended`).

What a body that turns does to others is a rate, cos(q) q'' - sin(q) q'^2 = (cos(q) q')'. Where it stands in an equation in whole, the
series of cos(q) q', from which that of sin(q) follows too, gives it without further products (`Equation`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from stickslip.engine.symbols import STATE, Graph, Sym, is_zero
from stickslip.models.linear_equations import eliminated

Rows = tuple[tuple[Sym, ...], ...]
#: Coefficients by what they stand in front of: the numbers of the nodes whose product it is; () is 1.
Monomials = dict[tuple[int, ...], float]
_MOST = 256  # products of the terms of two sums; what has more is left as it is
_ROUNDING = 1e-15  # of coefficients: what is left of those that are equal


@dataclass(frozen=True, eq=False)
class LinearSystem:
    """The equations whose solution some expressions are."""

    rows: Rows
    right: tuple[Sym, ...]
    unknowns: tuple[Sym, ...]  # the solution
    factors: tuple[Sym, ...]  # what stood before each of them; it belongs to the columns

    @cached_property
    def inverse(self) -> Rows:
        """The inverse of the matrix."""
        n, graph = len(self.right), self.unknowns[0].graph
        unit = [[1.0 if i == k else 0.0 for i in range(n)] for k in range(n)]
        columns = [eliminated(self.rows, each) for each in unit]
        return tuple(tuple(_symbol(graph, columns[k][i]) for k in range(n)) for i in range(n))

    @property
    def parts(self) -> tuple[Sym, ...]:
        """The entries of the matrix, and the right-hand side."""
        return (*(entry for row in self.rows for entry in row), *self.right)


@dataclass(frozen=True, eq=False)
class Turning:
    """A coordinate q, an angle, whose rate w is a state."""

    angle: Sym
    rate: Sym


@dataclass(frozen=True, eq=False)
class Equation:
    """One of the equations as series take it: entries times unknowns, and rates, are the right-hand side."""

    entries: tuple[Sym, ...]
    rates: tuple[tuple[Sym, Sym, Turning], ...]  # a coefficient, sin(q) or cos(q), and q: the rate of their product with q'
    right: Sym

    @property
    def parts(self) -> tuple[Sym, ...]:
        """What its series is made of."""
        return (*self.entries, *(each for _, turned, turning in self.rates for each in (turned, turning.rate)), self.right)


def equations_of(system: LinearSystem, turning: dict[int, Turning]) -> tuple[Equation, ...]:
    """The equations of a system, in which some unknowns, by their places, are the rates of the rates of angles.

    Examples
    --------
    >>> graph = Graph()
    >>> q, w, a, b = map(graph.variable, "qwab")
    >>> sine, cosine, zero, one = graph.call("sin", q), graph.call("cos", q), graph.constant(0.0), graph.constant(1.0)
    >>> system = LinearSystem(((one, cosine), (zero, one)), (sine * w * w, zero), (a, b), (one, one))
    >>> first, _ = equations_of(system, {1: Turning(q, w)})  # a + cos(q) q'' = sin(q) q'^2 is a + (cos(q) q')' = 0
    >>> first.entries[1] is zero, first.right is zero, first.rates[0][1] is cosine
    (True, True, True)
    """
    return tuple(_equation(row, b, system, turning) for row, b in zip(system.rows, system.right, strict=True))


def _equation(row: tuple[Sym, ...], right: Sym, system: LinearSystem, turning: dict[int, Turning]) -> Equation:
    graph, entries, rates, terms = right.graph, list(row), list[tuple[Sym, Sym, Turning]](), monomials(right)
    for k, each in turning.items():
        turned = _turned(graph, row[k], each, system.factors[k])
        if turned is None or not turned:
            continue
        wanted = {}  # of the right-hand side: what their rates have beside the accelerations
        for (key, number), c in turned.items():
            node = graph.nodes[number]
            other, sign = ("sin", 1.0) if node.op == "cos" else ("cos", -1.0)
            partner = graph.call(other, each.angle).number
            wanted[tuple(sorted((*key, partner, each.rate.number, each.rate.number)))] = sign * c
        if all(abs(terms.get(key, 0.0) - c) <= _ROUNDING * abs(c) for key, c in wanted.items()):
            terms = {key: c for key, c in terms.items() if key not in wanted}
            rates += [(_product(graph, key) * c, graph.nodes[number], each) for (key, number), c in turned.items()]
            entries[k] = graph.constant(0.0)
    return Equation(tuple(entries), tuple(rates), built(graph, terms)) if rates else Equation(row, (), right)


def _turned(graph: Graph, entry: Sym, turning: Turning, factor: Sym) -> dict[tuple[tuple[int, ...], int], float] | None:
    """Coefficients by what does not vary in a product, and the sine or cosine of an angle in it; None of what is made of anything else."""
    if factor is not graph.constant(1.0):
        return None
    turned = {}
    for key, c in monomials(entry).items():
        varying = [number for number in key if graph.varies(graph.nodes[number])]
        if len(varying) != 1 or (node := graph.nodes[varying[0]]).op not in ("sin", "cos") or node.args[0] is not turning.angle:
            return None
        turned[tuple(number for number in key if number != node.number), node.number] = c
    return turned


def parts_of(node: Sym) -> tuple[Sym, ...]:
    """What the series of an expression is made of: its arguments, or the linear equations that it solves."""
    system = node.graph.linear.get(node.number)
    return node.args if system is None else system.parts


def solution(matrix: Sequence[Sequence[Any]], right: Sequence[Any]) -> tuple[Any, ...]:
    """The solution of linear equations with symbols among their numbers, as `models.linear_equations.solved` asks for it."""
    graph = next(each.graph for each in (*(entry for row in matrix for entry in row), *right) if isinstance(each, Sym))
    n = len(right)
    nodes = [shorter(_symbol(graph, each)) for each in (*(entry for row in matrix for entry in row), *right)]
    rows, b = tuple(tuple(nodes[i * n : (i + 1) * n]) for i in range(n)), tuple(nodes[n * n :])
    unknowns = tuple(_symbol(graph, each) for each in eliminated(rows, b))
    graph.solved[tuple(x.number for x in unknowns)] = rows, b
    _note(graph, rows, b, unknowns)
    return unknowns


def extended(
    graph: Graph, accelerations: Sequence[Sym], forces: dict[int, Sym], conditions: dict[int, tuple[Sequence[Any], Sym, Sym]]
) -> None:
    """Take the friction forces among the unknowns of accelerations that depend on them.

    For each force, by number, there is one more equation: coefficients of the accelerations, that of the force itself, the right-hand side.
    """
    rows, right = graph.solved.get(tuple(a.number for a in accelerations), ((), ()))
    taken = [_without(graph, b, forces) for b in right]
    if not taken or any(each is None for each in taken):
        return
    zero = graph.constant(0.0)
    all_rows = [(*row, *(-by[k] for k in forces)) for row, (_, by) in zip(rows, taken, strict=True)]  # type: ignore[misc]
    all_right = [rest for rest, _ in taken]  # type: ignore[misc]
    for i, (row, own, b) in conditions.items():
        all_rows.append((*(_symbol(graph, g) for g in row), *(own if k == i else zero for k in forces)))
        all_right.append(b)
    _note(graph, tuple(all_rows), tuple(all_right), (*accelerations, *forces.values()))


def _note(graph: Graph, rows: Rows, right: tuple[Sym, ...], solved: tuple[Sym, ...]) -> None:
    """Let the graph know what expressions solve: by themselves those that do not depend on one another, where something in them varies."""
    for block in _blocks(rows):
        part = tuple(tuple(rows[i][k] for k in block) for i in block)
        if not any(graph.varies(entry) for row in part for entry in row):
            continue
        factors, unknowns = zip(*(stripped(solved[i]) for i in block), strict=True)  # factors before them belong to the columns
        scaled = tuple(tuple(entry * factor for entry, factor in zip(row, factors, strict=True)) for row in part)
        system, numbers = LinearSystem(scaled, tuple(right[i] for i in block), unknowns, factors), {x.number for x in unknowns}
        usual = all(x.args and graph.varies(x) for x in unknowns) and len(numbers) == len(unknowns)
        if usual and not any(_contains(each, numbers) for each in system.parts):
            graph.linear |= dict.fromkeys(numbers, system)


def _blocks(rows: Rows) -> list[list[int]]:
    """The unknowns that depend on one another, in their order."""
    block = list(range(len(rows)))
    for i, row in enumerate(rows):
        for k, entry in enumerate(row):
            if not is_zero(entry):
                block = [min(block[i], block[k]) if own in (block[i], block[k]) else own for own in block]
    return [[i for i, own in enumerate(block) if own == first] for first in dict.fromkeys(block)]


def stripped(node: Sym) -> tuple[Sym, Sym]:
    """The factor of an expression that does not depend on the state, and the rest."""
    factor = node.graph.constant(1.0)
    while node.op == "multiply" and node.args[0].level < STATE:
        factor, node = factor * node.args[0], node.args[1]
    return factor, node


def _without(graph: Graph, node: Sym, forces: dict[int, Sym]) -> tuple[Sym, dict[int, Sym]] | None:
    """An expression without forces in which it is linear, and its coefficient of each; None where it is not linear, or they are hidden."""
    names, zero, one = {force.number: i for i, force in forces.items()}, graph.constant(0.0), graph.constant(1.0)
    if node.number in names:
        return zero, {i: one if i == names[node.number] else zero for i in forces}
    if not _contains(node, set(names)):
        return node, dict.fromkeys(forces, zero)
    if node.op in ("add", "subtract"):
        apart = [_without(graph, a, forces) for a in node.args]
        if apart[0] is None or apart[1] is None:
            return None
        (rest, by), (other, more) = apart[0], apart[1]
        joined = graph.add if node.op == "add" else graph.subtract
        return joined(rest, other), {i: joined(by[i], more[i]) for i in forces}
    factor = next((a for a in node.args if not _contains(a, set(names))), None)
    if node.op != "multiply" or factor is None:
        return None
    of = _without(graph, node.args[1] if factor is node.args[0] else node.args[0], forces)
    return None if of is None else (factor * of[0], {i: factor * by for i, by in of[1].items()})


def _contains(node: Sym, numbers: set[int]) -> bool:
    """Whether an expression is made of some others."""
    waiting, visited = [node], set[int]()
    while waiting:
        now = waiting.pop()
        if now.number in numbers:
            return True
        if now.number not in visited:
            visited.add(now.number)
            waiting += parts_of(now)
    return False


def shorter(node: Sym) -> Sym:
    """An expression multiplied out, with sin^2 + cos^2 = 1, where that leaves fewer products of what varies; else as it is."""
    if not node.graph.varies(node):
        return node
    out = built(node.graph, _rounded_off(node.graph, monomials(node)))
    return out if _products([out]) < _products([node]) else node


def _products(nodes: list[Sym]) -> int:
    """Number of products of two expressions that vary."""
    waiting, visited, count = list(nodes), set[int](), 0
    while waiting:
        node = waiting.pop()
        if node.number not in visited:
            visited.add(node.number)
            waiting += node.args
            count += node.op == "multiply" and all(node.graph.varies(a) for a in node.args)
    return count


def monomials(node: Sym) -> Monomials:
    """An expression as a sum of products; what is neither a sum nor a product is a factor by itself.

    Examples
    --------
    >>> graph = Graph()
    >>> x, m = graph.variable("x"), graph.case("m")
    >>> monomials((m + x) * (m - x)) == {(m.number, m.number): 1.0, (x.number, x.number): -1.0}
    True
    """
    known: dict[int, Monomials] = {}
    waiting = [node]
    while waiting:
        now = waiting[-1]
        args = now.args if now.op in ("add", "subtract", "multiply") else ()
        missing = [a for a in args if a.number not in known]
        waiting += missing
        if not missing:
            known[waiting.pop().number] = _expanded(now, [known[a.number] for a in args])
    return known[node.number]


def least_of(node: Sym) -> Sym | None:
    """What an expression is at least, whatever angles are; None where more varies in it than their sines and cosines.

    Examples
    --------
    >>> graph = Graph()
    >>> angle = graph.variable("angle")
    >>> least_of(2.0 - 0.5 * graph.call("sin", angle)).value, least_of(2.0 - angle)
    (1.5, None)
    """
    graph = node.graph
    if node.op == "select" and not graph.varies(node.args[0]):
        either = [least_of(each) for each in node.args[1:]]
        return None if either[0] is None or either[1] is None else graph.select(node.args[0], either[0], either[1])
    total = graph.constant(0.0)
    for key, c in monomials(node).items():
        factors = [graph.nodes[number] for number in key]
        varying = [each for each in factors if graph.varies(each)]
        if any(each.op not in ("sin", "cos") for each in varying):
            return None
        of = _product(graph, [each.number for each in factors if not graph.varies(each)]) * c
        total = total - graph.select(of, of, -of) if varying else total + of
    return total


def _expanded(node: Sym, args: list[Monomials]) -> Monomials:
    if node.op == "constant":
        return {(): node.value} if node.value else {}
    if not args or (node.op == "multiply" and len(args[0]) * len(args[1]) > _MOST):
        return {(node.number,): 1.0}
    whole, size = dict(args[0]) if node.op != "multiply" else {}, dict[tuple[int, ...], float]()
    if node.op == "multiply":
        more = [(tuple(sorted(a + b)), c * d) for a, c in args[0].items() for b, d in args[1].items()]
    else:
        more = [(key, c if node.op == "add" else -c) for key, c in args[1].items()]
    for key, c in more:
        size[key] = max(size.get(key, 0.0), abs(whole.get(key, 0.0)), abs(c))
        whole[key] = whole.get(key, 0.0) + c
    return {key: c for key, c in whole.items() if abs(c) > _ROUNDING * size.get(key, 0.0)}


def _rounded_off(graph: Graph, terms: Monomials) -> Monomials:
    """Sums in which sin^2 + cos^2 of one argument with one coefficient are that coefficient."""
    terms = dict(terms)
    for key in list(terms):
        for number in dict.fromkeys(key):
            sine = graph.nodes[number]
            if sine.op != "sin" or key.count(number) < 2 or key not in terms:
                continue
            rest = list(key)
            rest.remove(number)
            rest.remove(number)
            cosine = graph.call("cos", sine.args[0]).number
            other, left = tuple(sorted((*rest, cosine, cosine))), tuple(rest)
            if other in terms and abs(terms[other] - terms[key]) <= _ROUNDING * abs(terms[key]):
                terms[left] = terms.get(left, 0.0) + terms.pop(other)
                del terms[key]
    return {key: c for key, c in terms.items() if c}


def built(graph: Graph, terms: Monomials) -> Sym:
    """The sum of products as an expression; what varies is multiplied apart from the numbers of the case, which come together."""
    zero, sums = graph.constant(0.0), dict[tuple[int, ...], Sym]()
    for key in sorted(terms):
        fixed, varying = ([number for number in key if (graph.nodes[number].level < STATE) == of] for of in (True, False))
        coefficient = _product(graph, fixed) * terms[key]
        sums[tuple(varying)] = sums.get(tuple(varying), zero) + coefficient
    total = zero
    for key, coefficient in sums.items():
        total = total + coefficient * _product(graph, key)
    return total


def _product(graph: Graph, key: Sequence[int]) -> Sym:
    product = graph.constant(1.0)
    for number in key:
        product = product * graph.nodes[number]
    return product


def _symbol(graph: Graph, value: Any) -> Sym:
    return value if isinstance(value, Sym) else graph.constant(float(value))
