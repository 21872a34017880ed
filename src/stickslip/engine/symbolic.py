"""A machine whose numbers, time and states are symbols: its declaration is called as it stands, and what comes out is an expression."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from stickslip.basics.contracts import Model
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.engine.symbols import STATE, Graph, Sym
from stickslip.models.machine_adapter import machine_of
from stickslip.models.mechanics import SOME

#: Name of the column that holds the length of the run, for a model without a period.
SPAN = "span"


def numbers_of(model: Model) -> tuple[str, ...]:
    """Names of the numbers that make a case's row.

    An exponent that is 1 or 2 for all cases belongs to the kind: its power is written out.
    """
    return tuple(name for name, value in leaves(model) if not is_written_out(name, value))


def is_written_out(name: str, value: Any) -> bool:
    """Whether a number is an exponent that is 1 or 2 for all cases."""
    return name.endswith("exponent") and name.rpartition(".")[2] == "exponent" and isinstance(value, float) and value in (1.0, 2.0)


AS_IT_IS = object()  # stops are closed as their modes say


class Symbolic:
    """A model with symbols for its numbers, time, velocities and positions."""

    def __init__(self, model: Model, cyclic: bool):
        self.graph = graph = Graph()
        graph.begins_anew = model.period is not None
        self.cyclic = cyclic
        self.pressed: list[Any] = []  # stops that may stay closed
        names = numbers_of(model)
        self.model: Any = replace_leaf(model, {name: graph.case(name) for name in names})
        self.machine = machine_of(self.model)
        self.equations = self.machine.mechanics
        self.single = self.equations.single
        self.equations.alike(machine_of(model).mechanics)
        self.names = names if model.period is not None else (*names, SPAN)
        self.laws, self.directions = self.equations.laws, self.equations.directions
        self.t, n = graph.variable("t"), self.equations.coordinates
        self.y = tuple(graph.variable(f"v{j}" if n > 1 else "v") for j in range(n))
        self.held = tuple(graph.variable(f"c{k}") for k in range(self.equations.controllers.count))  # states of the controllers
        self.places = self._places()
        if self.single:
            graph.sign(self.y[0])  # of one body, flag 0 is always the side of v
        rates = tuple(map(self.lift, self.equations.offsets(self.t)))
        zero = graph.constant(0.0)
        self.owner = _owners(self.directions, rates, n)  # of each coordinate, the contact whose slip its state is
        self.offsets = tuple(zero if i is None else -rates[i] for i in self.owner)
        self.v = tuple(y + offset for y, offset in zip(self.y, self.offsets, strict=True))
        self.slips = tuple(self.y[self.owner.index(i)] if i in self.owner else self._slip(i) for i in range(len(self.laws)))
        for slip, law in zip(self.slips, self.laws, strict=True):
            if law.dynamic:
                graph.sign(slip)  # of each contact, before any other condition
        self.of_motion = self.equations.of_motion or (False,) * len(self.laws)
        self.by_side = {i: self._load_by_side(i) for i, of in enumerate(self.of_motion) if of and not self.laws[i].dynamic}
        if any(self.of_motion):
            self.loads = tuple(self.by_side[i][0] if i in self.by_side else self._load(i) for i in range(len(self.laws)))
        else:
            self.loads = tuple(map(self.lift, self.equations.loads(self.t, self.places)))
        self.first_loads = tuple(map(self.lift, self.equations.loads(zero, (zero,) * n)))  # typical loads, where they vary

    @cached_property
    def rows(self) -> tuple[tuple[Any, ...], ...]:
        """What the slip of each contact takes of the coordinates' velocities: numbers where they are literal, else expressions."""
        given = self.equations.rows(self.t, self.places)
        return tuple(
            tuple(self.lift(coefficient) if g == SOME else g for g, coefficient in zip(row, own, strict=True))
            for row, own in zip(self.directions, given, strict=True)
        )

    @property
    def reach(self) -> tuple[tuple[float, ...], ...]:
        """For each contact the coordinates that its friction accelerates, as numbers that are not zero."""
        return tuple((SOME,) * len(row) for row in self.directions) if self.equations.joined else self.directions

    def weighted(self, i: int) -> tuple[Any, ...]:
        """The row of a contact where it has other coefficients than 1, -1 and 0; else nothing."""
        return () if set(self.directions[i]) <= {1.0, -1.0, 0.0} else self.rows[i]

    def _load(self, i: int) -> Sym:
        """Load of a contact, by the motion and the forces of the instant."""
        return self.lift(self.equations.load(i, self.t, self.places, self.v, self.held))

    def _load_by_side(self, i: int) -> tuple[Sym, Sym]:
        """The same of a contact that may rest, which slides forwards, or is about to, and backwards."""
        loads = []
        for side in (1.0, -1.0):
            self.graph.assumed[self.slips[i].number] = side
            loads.append(self._load(i))
        self.graph.assumed.clear()
        return loads[0], loads[1]

    def load(self, i: int, side: float) -> Sym:
        """Load of a contact that slides to a side, or is about to."""
        return self.loads[i] if i not in self.by_side else self.by_side[i][0 if side > 0 else 1]

    def _slip(self, i: int) -> Sym:
        return self.lift(self.equations.slips(self.t, self.v, self.places)[i])

    def _places(self) -> tuple[Sym, ...]:
        """Positions of the coordinates; where only their differences matter, from the first one."""
        graph, n = self.graph, len(self.y)
        zero = graph.constant(0.0)
        names = ["x"] if n == 1 else [f"{'l' if self.cyclic else 'x'}{j}" for j in range(n)]
        return tuple(zero if j == 0 and self.cyclic else graph.variable(name) for j, name in enumerate(names))

    def lift(self, value: Any) -> Sym:
        """A number or symbol as a symbol."""
        return value if isinstance(value, Sym) else self.graph.constant(value)

    def accelerations(self, R: dict[int, Any], at: dict[int, Sym] | None = None, closed: Any = AS_IT_IS) -> tuple[Sym, ...]:
        """Accelerations of the coordinates under the friction forces R by contact, with other states `at` those of the coordinates.

        Stops are closed as their modes say, but those whose ends all rub are open; or none is closed (`closed` = None), or that one.
        """
        v = tuple((at or {}).get(j, y) + offset for j, (y, offset) in enumerate(zip(self.y, self.offsets, strict=True)))
        forces = [R.get(i, 0.0) for i in range(len(self.laws))]
        accelerations = tuple(map(self.lift, self.equations.accelerations(self.t, self.places, v, forces, self.held)))
        if not self.equations.joined:
            accelerations = tuple(map(_spread, accelerations))
        if closed is not AS_IT_IS:
            return accelerations if closed is None else closed.closing(self, accelerations)
        for p in [p for p in self.pressed if not p.rubs]:
            accelerations = tuple(
                self.graph.select(p.closed, shut, a) for shut, a in zip(p.closing(self, accelerations), accelerations, strict=True)
            )
        return accelerations

    def free_of(self, i: int) -> tuple[Sym, ...]:
        """Accelerations of the coordinates while a contact that may fly does."""
        none = [0.0] * len(self.laws)
        return tuple(map(self.lift, self.equations.loose_accelerations(self.t, self.places, self.v, none, self.held)))

    def rising(self, i: int) -> Sym:
        """Second derivative of the height of a contact's point while it flies."""
        return self.lift(self.equations.rising(i, self.t, self.places, self.v, self.held))

    def struck(self, i: int) -> Any:
        """What impulses at a contact's point do (`models.kept_heights.Struck`)."""
        return self.equations.struck(i, self.places)

    def moved_by(self, i: int) -> tuple[Any, ...]:
        """What a unit of a contact's friction takes of the accelerations of the coordinates, where nothing keeps its height."""
        return self.equations.loosely_pushed(0.0, self.places, self.equations.rows(0.0, self.places)[i])

    @property
    def held_scales(self) -> tuple[Sym, ...]:
        """Typical sizes of the controllers' states."""
        return tuple(map(self.lift, self.equations.controllers.scales))

    def held_rates(self) -> tuple[Sym, ...]:
        """Rates of the controllers' states between samples."""
        return tuple(map(self.lift, self.equations.control_rates(self.t, self.places, self.v, self.held)))

    def held_after_sample(self) -> tuple[Sym, ...]:
        """The controllers' states after a sample; its conditions are those of the instant."""
        graph, before = self.graph, self.graph.at_once
        graph.at_once = True
        sampled = tuple(map(self.lift, self.equations.control_sampled(self.t, self.places, self.v, self.held)))
        graph.at_once = before
        return sampled

    def feet(self, i: int) -> list[int]:
        """The contacts of the coordinate that a contact brakes, where it brakes one alone."""
        return [k for k, row in enumerate(self.directions) if row == self.directions[i]]

    def period(self, given: Any) -> Sym:
        """Period of the equations, or how long the run is."""
        return self.graph.case(SPAN) if given.period is None else self.lift(self.model.period)


def _owners(directions: Any, offsets: tuple[Sym, ...], coordinates: int) -> tuple[int | None, ...]:
    """For each coordinate the first contact whose slip is its velocity plus a number of the case, which neither varies nor jumps."""
    owners = []
    for j in range(coordinates):
        alone = [i for i, row in enumerate(directions) if row[j] == 1.0 and sum(map(abs, row)) == 1.0 and offsets[i].level < STATE]
        owners.append(alone[0] if alone else None)
    return tuple(owners)


def _spread(node: Sym, factor: Sym | None = None) -> Sym:
    """A sum with the case's factors multiplied into its terms, where they are computed once per case."""
    graph = node.graph
    if node.op in ("add", "subtract"):
        a, b = (_spread(x, factor) for x in node.args)
        return a + b if node.op == "add" else a - b
    if node.op == "multiply" and node.args[0].level < STATE and node.args[1].op in ("add", "subtract"):
        return _spread(node.args[1], node.args[0] if factor is None else graph.multiply(factor, node.args[0]))
    return node if factor is None else graph.multiply(factor, node)
