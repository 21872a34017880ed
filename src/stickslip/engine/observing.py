"""User-defined observables, traced with symbols: the state of a machine that they may use, and the resulting signal."""

from __future__ import annotations

from functools import cached_property
from types import SimpleNamespace
from typing import Any

from stickslip.basics.errors import InputError
from stickslip.engine.assembly import Assembly
from stickslip.engine.coupled import sliding_both_ways
from stickslip.engine.flight import touching
from stickslip.engine.symbols import Graph, Sym, TraceError
from stickslip.engine.system import System
from stickslip.models.declaration import NOT_REPEATABLE

#: Name of the way of the reference body, which no step of a machine has whose positions count as differences only.
WAY = "way"


_OF_BODIES = ("x", "v", "acceleration")


class _State:
    """The state of a machine, in symbols."""

    def __init__(self, parts: Assembly, eq: System):
        m = self._m = parts.m
        self._parts, self._eq = parts, eq
        self.t, self.model = m.t, m.model
        self._every: dict[str, tuple[Any, ...]] = {}  # of each column what all bodies or contacts have

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(f"s has no {name!r}; it has t, model, {', '.join(_KNOWN)}")

    def _given(self, name: str, values: Any) -> Any:
        """Of one body on one contact a number, and of a machine with a principal body that body's; a tuple of several."""
        every = self._every[name] = tuple(value if isinstance(value, tuple) else self._m.lift(value) for value in values)
        own = self._m.machine.own.get("body" if name in _OF_BODIES else "contact")
        return every if own is None else every[own]

    @cached_property
    def x(self) -> Any:
        """Positions of the bodies."""
        m = self._m
        way = m.graph.variable(WAY)
        return self._given("x", m.equations.positions(m.t, tuple(way + position for position in m.places) if m.cyclic else m.places))

    @cached_property
    def v(self) -> Any:
        """Velocities of the bodies."""
        return self._given("v", self._m.equations.velocities(self._m.t, self._m.v))

    @cached_property
    def acceleration(self) -> Any:
        """Accelerations of the bodies."""
        return self._given("acceleration", self._m.equations.accelerations_of_bodies(self._m.t, self._eq.f[: self._eq.coordinates]))

    @cached_property
    def slip(self) -> Any:
        """Slip velocities of the contacts."""
        return self._given("slip", self._m.slips)

    @cached_property
    def load(self) -> Any:
        """Normal forces on the contacts."""
        return self._given("load", [touching(self._parts, i, self._load(i)) for i in range(len(self._m.loads))])

    def _load(self, i: int) -> Any:
        """The load of a contact, of one under a law that rests exactly that of the side to which it slides."""
        if self._m.laws[i].dynamic:
            return self._m.loads[i]
        forwards, backwards = self._m.load(i, 1.0), self._m.load(i, -1.0)
        return self._m.graph.by_side(self._parts.modes[i], forwards, backwards, forwards)

    @cached_property
    def friction_force(self) -> Any:
        """Friction forces of the contacts."""
        return self._given("friction_force", [_friction(self._parts, i) for i in range(len(self._m.laws))])

    @cached_property
    def z(self) -> Any:
        """Inner states of the laws: a number where a law has one, a tuple where it has several."""
        inner = [tuple(self._eq.y[k] for k in contact.inner) for contact in self._eq.contacts]
        return self._given("z", [each[0] if len(each) == 1 else each for each in inner])

    @cached_property
    def bodies(self) -> dict[str, Any]:
        """x, v and acceleration of each body by its name."""
        return self._by_name(self._m.equations.bodies, ("x", "v", "acceleration"))

    @cached_property
    def contacts(self) -> dict[str, Any]:
        """slip, load and z of each contact by its name, and its friction force."""
        return self._by_name(self._m.equations.contacts, ("slip", "load", "z"), friction_force=True)

    def _by_name(self, names: Any, columns: tuple[str, ...], friction_force: bool = False) -> dict[str, Any]:
        for column in columns:
            getattr(self, column)
        parts = {}
        for i, name in enumerate(names):
            own = {column: self._every[column][i] for column in columns}
            parts[name] = _Contact(self._parts, i, **own) if friction_force else SimpleNamespace(**own)
        return parts


_KNOWN = tuple(name for name in vars(_State) if not name.startswith("_"))


class _Contact(SimpleNamespace):
    """One contact; its friction force is made when it is asked for, because not every contact at rest has one of its own."""

    def __init__(self, parts: Assembly, number: int, **columns: Any):
        super().__init__(**columns)
        self._of = parts, number

    @property
    def friction_force(self) -> Any:
        """Friction force."""
        return _friction(*self._of)


def _friction(parts: Assembly, i: int) -> Sym:
    """Friction force of a contact, also at rest."""
    m = parts.m
    if i in parts.forces:
        return m.lift(parts.forces[i])
    if len(m.feet(i)) > 1:
        raise TraceError("several contacts hold one body, and at rest only their sum is known; observe slip, load or v")
    forwards, backwards = sliding_both_ways(parts, i)
    j = next(k for k, g in enumerate(m.directions[i]) if g)
    held = m.graph.derivative(m.slips[i] - m.y[j], m.t)
    free, braked = (
        m.accelerations({**parts.known_forces, i: force})[j] for force in (0.0, 1.0)
    )  # a closed stop makes the mass that a contact holds larger
    holding = (free + held) / (free - braked) if m.pressed else m.lift(m.equations.masses[j]) * (free + held)
    return touching(parts, i, m.graph.by_side(parts.modes[i], forwards, backwards, holding))


def observed_node(name: str, function: Any, parts: Assembly, eq: System) -> Sym:
    """The expression of an observable; `InputError` with the reason where it cannot be traced."""
    graph = parts.m.graph
    hint = "it is called once, with symbols: write it with + - * / ** and stickslip.maths, without if, and return one number"
    try:
        node, again = (_number(graph, function(_State(parts, eq))) for _ in range(2))
    except (TraceError, AttributeError, TypeError, ValueError, KeyError, IndexError) as error:
        mistake = f"no part is called {error}, or has this number" if isinstance(error, KeyError | IndexError) else str(error)
        raise InputError("observe", [f"{name}: {mistake}; {hint}"]) from error
    if again is not node:
        raise InputError("observe", [f"{name} is another expression each time it is called with the same state; {NOT_REPEATABLE}"])
    if graph.derivative(node, graph.variable(WAY)) is not graph.constant(0.0):
        raise InputError(
            "observe", [f"{name} depends on how far the machine went, which its steps count apart; observe v, or differences of positions"]
        )
    return node


def _number(graph: Graph, value: Any) -> Sym:
    return value if isinstance(value, Sym) else graph.constant(float(value))
