"""A switching flow as a System: its Python functions are called with symbols, and the mode selects the field.

A flow has no contacts. Its mode is a number that a step holds, of which each rate is a choice; a guard is watched in its own mode
alone. Plain Python may ask: where a field, a guard, a reset or the mode after a switch says ``if``, it is called once for each
answer, and the answers become choices. A field's condition is held for a step and found at its zero, as that of a friction law is;
what a switch asks it asks at its instant. Numbers that stand in a flow's lines are numbers of the case, so that flows that differ in
nothing else share a kernel.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from stickslip.basics.status import Status
from stickslip.engine.flow_contacts import FlowContacts
from stickslip.engine.graphs import Substituted
from stickslip.engine.symbolic import SPAN
from stickslip.engine.symbols import Condition, Graph, Sym, TraceError
from stickslip.engine.system import System, TracedSwitch
from stickslip.engine.trace import instants_of
from stickslip.engine.values import needed_by

if TYPE_CHECKING:
    from stickslip.models.switching_flow import SwitchingFlow


#: Columns of a row beside a flow's own numbers: the time at the start, the most switches, and what each state is measured against.
BEGIN, MOST, SIZE = "#begin", "#most", "#size"
_MANY, _AT_ONCE = 100.0, 1e-7  # so many switches within this part of a run accumulate: at that rate it would have 1e9
_PATHS = 200  # answers to all that a function asks
_PLAIN = frozenset((0.0, 0.5, 1.0, 2.0))
_SMALL, _LEAST = 1e-3, 1e-9  # of the largest state, and of the start: what a state that passes zero is measured against


@dataclass(frozen=True)
class FlowSystem:
    """A traced flow.

    Parameters
    ----------
    system : System
    constants : dict
        The numbers that stand in the flow's lines, by the names of their columns.
    modes : tuple
        The flow's modes; the first has number 1.
    """

    system: System
    constants: Mapping[str, float]
    modes: tuple[Any, ...]


class _Asking(Graph):
    """A graph that answers plain Python's questions as a script says, and takes the numbers that it meets for numbers of the case."""

    def __init__(self) -> None:
        super().__init__()
        self.begins_anew = False
        self.constants: dict[str, float] = {}
        self.of_user = False  # whether the numbers that come stand in a user's lines
        self._script: list[bool] = []
        self._asked: dict[int, Condition] = {}
        self._answers: dict[int, bool] = {}

    def constant(self, value: Any) -> Sym:
        """A number: of the case, unless it is one that shapes equations, such as 0 and 1."""
        node = super().constant(value)
        if abs(node.value) in _PLAIN or not self.of_user:
            return node
        name = f"#{node.value!r}"
        self.constants[name] = node.value
        return self.case(name)

    def decided(self, condition: Condition) -> bool:
        """The answer on this path."""
        asked = condition.difference
        if asked.op == "constant":
            return asked.value > 0.0 or (condition.weak and asked.value == 0.0)
        if asked.number not in self._answers:
            self._asked[asked.number] = condition
            self._answers[asked.number] = self._script[len(self._answers)] if len(self._answers) < len(self._script) else True
        return self._answers[asked.number]

    def explored(self, f: Callable[[], Any]) -> Any:
        """Values of a function on every path through it: a tree of `_Choice` with these values as leaves."""
        return self._path(f, [], [_PATHS])

    def _path(self, f: Callable[[], Any], script: list[bool], left: list[int]) -> Any:
        left[0] -= 1
        if left[0] < 0:
            raise TraceError(f"a function asks more than {_PATHS} questions of `if`")
        self._script, self._asked, self._answers = script, {}, {}
        value = f()
        answers, asked = list(self._answers.values()), list(self._asked.values())
        for k in range(len(answers) - 1, len(script) - 1, -1):
            value = _Choice(asked[k], value, self._path(f, [*answers[:k], False], left))
        return value


@dataclass(frozen=True)
class _Choice:
    condition: Condition
    yes: Any
    no: Any


class TracedFlow:
    """One flow of n states, called with symbols."""

    def __init__(self, flow: SwitchingFlow, n: int):
        self.flow, self.n, self.graph = flow, n, _Asking()
        graph = self.graph
        self.modes, self.own = tuple(flow.fields), n - len(flow.inner)
        self.t, self.y = graph.variable("t"), tuple(graph.variable(f"y{i}") for i in range(n))
        self.time = self.t + graph.case(BEGIN)
        self.numbers = {name: graph.case(name) for name in flow.numbers}
        self.clerks = tuple(graph.mode(f"mode{k}") for k in range(4))
        self.number_of_mode, self.count, self.burst, self.since = self.clerks
        self.contacts = FlowContacts(self, self.y)
        sides = tuple(self.contacts.sides.values())
        self.mode = graph.mode(f"mode{len(self.clerks)}") if sides else self.number_of_mode  # of the field
        memories = tuple(mode for mode, _ in self.contacts.memories.values())
        self.held = (*self.clerks, self.mode, *sides, *memories) if sides else (*self.clerks, *memories)
        given = self.contacts.given
        self.fields = [self.numbers_of(self.called(flow.fields[mode], *given), self.own) for mode in self.modes]
        exits = [(k, switch) for k, mode in enumerate(self.modes) for switch in flow.switches.get(mode, ())]
        self.guards = [(k, self.numbers_of(self.called(switch.guard), 1)[0]) for k, switch in exits]
        if self.contacts.names:
            self.rates  # noqa: B018  # before nothing is held
        graph.at_once = True  # from here on nothing is held
        self.first = self.contacts.first()
        self.switches = [self._switch(switch) for _, switch in exits]
        self.exits = exits

    @cached_property
    def rates(self) -> list[Sym]:
        """The rates of all states in any mode."""
        rates = [self.within(0, len(self.modes), lambda k, i=i: self.fields[k][i]) for i in range(self.own)]  # type: ignore[misc]
        return self.contacts.applied(rates)

    @cached_property
    def scales(self) -> tuple[Sym, ...]:
        """What each state is measured against."""
        return tuple(self.graph.case(f"{SIZE}{i}") for i in range(self.n))

    @cached_property
    def sizes(self) -> tuple[Sym, ...]:
        """Sizes of the states where a step begins."""
        return _sizes(self.graph, self.y, self.scales)

    @property
    def expressions(self) -> dict[str, tuple[Sym, ...]]:
        """The value of every function of the flow, by the function's name."""
        expressions = {f"fields[{mode!r}]": tuple(rates) for mode, rates in zip(self.modes, self.fields, strict=True)}
        for name, slip, load in zip(self.contacts.names, self.contacts.slips, self.contacts.loads, strict=True):
            expressions |= {f"contacts[{name!r}].slip": (slip,), f"contacts[{name!r}].load": (load,)}
        for mode in self.modes:
            own = [k for k, (at, _) in enumerate(self.exits) if self.modes[at] == mode]
            for number, k in enumerate(own):
                name, switch = f"switches[{mode!r}][{number}]", self.switches[k]
                after = tuple(y if new is None else new for y, new in zip(self.y, switch.states, strict=True))[: self.own]
                to = self._to(self.exits[k][1])
                expressions |= {f"{name}.guard": (self.guards[k][1],), f"{name}.reset": after, f"{name}.to": (to,)}
        return expressions

    # ---- what a user's functions give ----
    def called(self, f: Callable[..., Any], *more: Any) -> Any:
        """What a function of the flow gives."""
        extra = (*more, SimpleNamespace(**self.numbers)) if self.numbers else more
        self.graph.of_user = True
        value = self.graph.explored(lambda: f(self.time, list(self.y[: self.own]), *extra))
        self.graph.of_user = False
        return value

    def numbers_of(self, value: Any, count: int) -> list[Sym]:
        """So many expressions, choices as selects."""
        if isinstance(value, _Choice):
            yes, no = self.numbers_of(value.yes, count), self.numbers_of(value.no, count)
            return [value.condition.__ss_where__(a, b) for a, b in zip(yes, no, strict=True)]
        rows = list(value) if hasattr(value, "__iter__") else [value]
        if len(rows) != count:
            raise TraceError(f"{len(rows)} numbers where {count} are wanted")
        return [self.number(row) for row in rows]

    def number(self, row: Any) -> Sym:
        """A number that a function of the flow or a law gave."""
        if isinstance(row, Sym):
            return row
        self.graph.of_user = True
        node = self.graph.constant(_plain(row))
        self.graph.of_user = False
        return node

    def _number_of(self, mode: Any) -> Sym:
        """The number of the mode that a function tells."""
        if isinstance(mode, _Choice):
            return mode.condition.__ss_where__(self._number_of(mode.yes), self._number_of(mode.no))
        if isinstance(mode, Sym) and mode.op == "select":
            held, yes, no = mode.args
            return self.graph.select(held, self._number_of(yes), self._number_of(no))
        if isinstance(mode, Sym):
            mode = self.graph.constants.get(mode.name, mode.value if mode.op == "constant" else None)
        if mode not in self.modes:
            raise TraceError(f"{mode!r} is not a mode of the flow")
        return self.graph.constant(1.0 + self.modes.index(mode))

    # ---- what a mode chooses ----
    def within(self, low: int, high: int, of: Callable[[int], Sym], mode: Sym | None = None) -> Sym:
        """The choice among the modes of the field, or those of another number, from low to below high, by bisection."""
        if high - low == 1:
            return of(low)
        middle = (low + high) // 2
        beyond = (self.mode if mode is None else mode) - self.graph.constant(middle + 0.5)
        return self.graph.select(beyond, self.within(middle, high, of, mode), self.within(low, middle, of, mode))

    def only_in(self, places: set[int], guard: Sym, other: Sym) -> Sym:
        """A guard in some modes, and what does not vary in the others."""
        return self.within(0, len(self.modes), lambda k: guard if k in places else other)

    # ---- switches ----
    def _to(self, switch: Any) -> Sym:
        """The number of the field's mode after a switch."""
        return self._number_of(self.called(switch.to) if callable(switch.to) else switch.to)

    def _switch(self, switch: Any) -> TracedSwitch:
        to = self._to(switch)
        own = tuple(self.numbers_of(self.called(switch.reset), self.own)) if switch.reset is not None else self.y[: self.own]
        states = (*own, *self.y[self.own :])
        after = Substituted(self.graph, {self.mode.name: to} | {y.name: new for y, new in zip(self.y, states, strict=True)})
        sides = {i: after.of(side) for i, side in self.first.items()}
        return self._switched(to, sides, {j: new for j, (new, y) in enumerate(zip(states, self.y, strict=True)) if new is not y})

    def _switched(self, to: Sym, sides: Mapping[int, Sym], states: Mapping[int, Sym]) -> TracedSwitch:
        """A switch to a mode of the field in which the contacts do this, with new states by number."""
        graph, one = self.graph, self.graph.constant(1.0)
        late = self.t - self.since - graph.constant(_AT_ONCE) * graph.case(SPAN)
        early = self.since - self.t  # a period has begun
        near = graph.select(late, graph.constant(0.0), graph.select(early, graph.constant(0.0), one))
        modes = (self.count + one, near * (self.burst + one), graph.select(near, self.since, self.t))
        return TracedSwitch((*self._mode(to, sides, *modes),), tuple(states.get(j) for j in range(self.n)))

    def _mode(self, to: Sym, sides: Mapping[int, Sym], *clerks: Sym) -> tuple[Sym, ...]:
        """All modes, from that of the field, what the contacts do, and the counts of switches."""
        memories = tuple(mode for mode, _ in self.contacts.memories.values())
        own = (self.contacts.number(to, dict(sides)), *clerks, to, *sides.values()) if sides else (to, *clerks)
        return (*own, *memories)

    def _first_modes(self) -> tuple[Sym, ...]:
        """The modes with which a run begins: of a number below zero, a mode of the field, the contacts' are decided by the state."""
        given, graph, zero = self.number_of_mode, self.graph, self.graph.constant(0.0)
        memories = tuple(self.y[state] for state in self.contacts.memories)
        if not self.first:
            return (graph.select(-given, -given, given) if self.contacts.names else given, zero, zero, zero, *memories)
        known = list(self.flow.labels.values())

        def decoded(of: Callable[[int], float]) -> Sym:
            return self.within(0, len(known), lambda k: graph.constant(of(k)), given)

        to = graph.select(-given, -given, decoded(lambda k: 1.0 + self.modes.index(known[k][0])))
        decided = Substituted(graph, {self.mode.name: to})
        sides = {
            i: graph.select(-given, decided.of(side), decoded(lambda k, index=index: float(known[k][1][index])))  # type: ignore[misc]
            for index, (i, side) in enumerate(self.first.items())
        }
        return (*self._mode(to, sides, zero, zero, zero)[: len(self.held) - len(memories)], *memories)

    def ends(self) -> list[tuple[Sym, TracedSwitch]]:
        """Conditions that end a run: the largest number of switches, and switches that accumulate."""
        same, none, half = self.held, (None,) * self.n, self.graph.constant(0.5)
        return [
            (self.graph.case(MOST) - half - self.count, TracedSwitch(same, none, Status.SWITCHES)),
            (self.graph.constant(_MANY - 0.5) - self.burst, TracedSwitch(same, none, Status.CHATTERS)),
            *self.contacts.ends(),
        ]

    # ---- together ----
    def flow_system(self) -> FlowSystem:
        """The flow as a System."""
        graph, f = self.graph, tuple(self.rates)
        one, zero = graph.constant(1.0), graph.constant(0.0)
        guards = [self.only_in({k}, guard, one) for k, guard in self.guards]
        held = [self.only_in(self._readers(i), guard, one) for i, guard in enumerate(graph.guards)]
        ends = self.ends()
        rubbing = self.contacts.events()
        of_contacts = [self._switched(self.mode, sides, states) for _, sides, states in rubbing]
        remembering = self.contacts.of_memories
        guards += [guard for guard, *_ in (*rubbing, *remembering)]
        of_laws = [self.contacts.remembering(*new) for _, *new in remembering]
        switches = dict(enumerate([*(switch for _, switch in ends), *self.switches, *of_contacts, *of_laws], start=len(held)))
        switches |= {k: self.contacts.remembering(*new) for k, new in self.contacts.at_rest.items()}
        scales = self.scales
        instants = [instant for clock in graph.clocks for instant in instants_of(graph, clock, self.t)]
        names = (*self.numbers, *graph.constants, BEGIN, MOST, *(scale.name for scale in scales), SPAN)
        eq = System(
            graph=graph, names=names, t=self.t, y=self.y, f=f, bodies=(), slips_of=(), single=False, offsets=(), contacts=(), free=zero,
            inertia=None, guards=(*held, *(guard for guard, _ in ends), *guards), signs=len(held), switches=switches,
            modes=self.held, first_modes=self._first_modes(), clocks=tuple(graph.clocks), instants=tuple(instants), impulses=(),
            period=graph.case(SPAN), velocity_scale=one, free_velocity=scales[0], scales=scales, cyclic=False, mass=one, shares=(),
            offered=None, labels=2, sizes=self.sizes, tolerant=bool(self.flow.inner),
        )  # fmt: skip
        return FlowSystem(eq, dict(graph.constants), self.flow.modes)

    def _readers(self, flag: int) -> set[int]:
        """The modes in which something reads a flag."""
        name, readers = f"b{flag}", set()
        contacts = self.contacts
        if any(node.op == "flag" and node.name == name for node in needed_by([*contacts.slips, *contacts.loads, *contacts.of_laws])):
            return set(range(len(self.modes)))
        for k, field in enumerate(self.fields):
            own = [guard for mode, guard in self.guards if mode == k]
            if any(node.op == "flag" and node.name == name for node in needed_by([*field, *own])):
                readers.add(k)
        return readers


def flow_system(flow: SwitchingFlow, n: int) -> FlowSystem:
    """The equations of a flow of n states.

    Raises
    ------
    TraceError
        Where a function of the flow does with a symbol what only a number can do; or what it raises itself.

    Examples
    --------
    >>> from stickslip.models.switching_flow import SwitchingFlow
    >>> ball = SwitchingFlow({"air": lambda t, y: (y[1], -9.81)})
    >>> found = flow_system(ball, 2)
    >>> found.system.f, found.constants
    ((y1, #-9.81), {'#-9.81': -9.81})
    """
    return TracedFlow(flow, n).flow_system()


def _sizes(graph: _Asking, y: Sequence[Sym], scales: Sequence[Sym]) -> tuple[Sym, ...]:
    """Scales of the states at the start of a step: their own values, the others' where they pass zero, the start if all do."""
    whole = graph.constant(0.0)
    for state in y:
        whole = whole + state * state
    part, least = graph.constant(_SMALL**2), graph.constant(_LEAST**2)
    return tuple(graph.call("sqrt", state * state + part * whole + least * (scale * scale)) for state, scale in zip(y, scales, strict=True))


def _plain(row: Any) -> float:
    """A plain number of whatever type."""
    if isinstance(row, (int, float)) and not isinstance(row, bool):
        return float(row)
    if getattr(row, "size", 0) == 1 and getattr(getattr(row, "dtype", None), "kind", "") in "fiu":
        return float(row.ravel()[0])
    raise TraceError(f"{row!r} is not a number")
