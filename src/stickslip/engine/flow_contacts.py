"""Contacts of a switching flow in the engine: friction forces as unknowns of the traced field, decided as those of machines are.

The field is called with a symbol for each friction force. Its derivatives by these symbols, and those of the slips by the states, are the
contact problem w' = beta - G R, which `coupled.Box` solves for machines too. What each contact does is a mode of its own, and the number
of the flow's mode counts all combinations.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from operator import is_ as _is
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from stickslip.basics.status import Status
from stickslip.engine.contact_equations import switches_of_law
from stickslip.engine.coupled import SLIP, Box
from stickslip.engine.graphs import Substituted
from stickslip.engine.symbols import STATE, Sym, TraceError, is_zero
from stickslip.engine.system import TracedSwitch
from stickslip.models.flow_contacts import NOT_LINEAR

if TYPE_CHECKING:
    from stickslip.engine.flow_system import TracedFlow


_NEAR = 1e-15  # of the size of what a slip is made of: what rounding makes of one that begins at zero


class FlowContacts:
    """The contacts of one traced flow; of a flow without any, nothing."""

    def __init__(self, flow: TracedFlow, states: Sequence[Sym]):
        self.flow, self.graph, self.y = flow, flow.graph, states
        contacts, numbers = flow.flow.contacts, (SimpleNamespace(**flow.numbers),) if flow.numbers else ()
        self.names = tuple(contacts)
        self.laws = [contact.law(*numbers) for contact in contacts.values()]
        self.resting = [i for i, law in enumerate(self.laws) if not law.dynamic]
        self.sides = {i: self.graph.mode(f"mode{len(flow.clerks) + 1 + k}") for k, i in enumerate(self.resting)}
        self.unknown = [self.graph.variable(f"R_{name}") for name in self.names]
        self.slips = [flow.numbers_of(flow.called(contact.slip), 1)[0] for contact in contacts.values()]
        self.loads = [flow.numbers_of(flow.called(c.load) if callable(c.load) else c.load, 1)[0] for c in contacts.values()]
        self.boxes: list[Box] = []
        self.forces: dict[int, Sym] = {}
        self.of_inner: list[Sym] = []
        self.memories = self._memories(len(flow.clerks) + (1 + len(self.resting) if self.resting else 0))
        self.at_rest: dict[int, tuple[dict[int, Sym], dict[int, Sym]]] = {}  # by guard: new memories and states where a slip passes zero
        self.of_memories: list[tuple[Sym, dict[int, Sym], dict[int, Sym]]] = []  # other guards of laws that remember, with the same

    @property
    def zero(self) -> Sym:
        """The number 0."""
        return self.graph.constant(0.0)

    @property
    def one(self) -> Sym:
        """The number 1."""
        return self.graph.constant(1.0)

    @property
    def given(self) -> tuple[SimpleNamespace, ...]:
        """The friction forces as the field takes them; nothing without contacts."""
        return (SimpleNamespace(**dict(zip(self.names, self.unknown, strict=True))),) if self.names else ()

    # ---- equations ----
    def applied(self, rates: list[Sym]) -> list[Sym]:
        """The rates of all states from those of the field, with the forces that the modes say."""
        inner, more = self._inner(rates)
        self.of_inner = [*inner.values(), *more, *self.of_inner]
        rates = self._with(rates, inner)
        self.boxes = self._boxes(rates) if self.resting else []
        self.forces = inner | dict.fromkeys(self.resting, self.zero)  # of those that slip as one the first has it all
        self.forces |= {i: R for box in self.boxes for i, R in box.forces(box.modes).items()}
        rates = self._with(rates, self.forces)
        return [*rates, *more]

    def _with(self, rates: Sequence[Sym], forces: dict[int, Sym]) -> list[Sym]:
        """Expressions with friction forces put in."""
        put = Substituted(self.graph, {self.unknown[i].name: R for i, R in forces.items()})
        return [put.of(rate) for rate in rates]

    # ---- laws with a rate and a force ----
    def _memories(self, number: int) -> dict[int, tuple[Sym, int]]:
        """What laws remember, by number of the state that keeps it: the mode that steps hold, and which contact's it is.

        It is a state too, which nothing moves but the law's switches, so that a state says all of where a motion goes on.
        """
        memories: dict[int, tuple[Sym, int]] = {}
        at = len(self.y) - sum(law.states + law.modes for law in self.laws)
        for i, law in enumerate(self.laws):
            for state in range(at + law.states, at + law.states + law.modes):
                memories[state] = self.graph.mode(f"mode{number + len(memories)}"), i
            at += law.states + law.modes
        return memories

    def _inner(self, rates: Sequence[Sym]) -> tuple[dict[int, Sym], list[Sym]]:
        """Forces of the laws with a rate and a force, and the rates of their states."""
        forces: dict[int, Sym] = {}
        more: list[Sym] = []
        first = len(self.y) - sum(law.states + law.modes for law in self.laws)
        for i, law in enumerate(self.laws):
            if not law.dynamic:
                continue
            z, last = tuple(self.y[first : first + law.states]), first + law.states
            held = tuple(self.memories[last + k][0] for k in range(law.modes))
            applied = self._applied(i, rates) if law.needs_applied else 0.0

            def response(law: Any = law, i: int = i, z: Any = z, held: Any = held, applied: Any = applied) -> Any:
                return law.response(self.slips[i], z, self.loads[i], held, applied)

            force, own = self._of_law(response)
            forces[i] = self.flow.number(force)
            more += [*map(self.flow.number, own), *(self.zero for _ in held)]
            if law.switching:
                self._add_switches(i, z, held, first)
            first = last + law.modes
        return forces, more

    def _applied(self, i: int, rates: Sequence[Sym]) -> Sym:
        """The force that would keep the slip of a contact as it is; an error where others rub on it too."""
        graph, own, name = self.graph, self.y[: len(rates)], self.names[i]
        slopes = [graph.derivative(self.slips[i], state) for state in own]
        rate = _total([graph.derivative(self.slips[i], self.flow.t), *_products(slopes, rates)])
        if others := [k for k, R in enumerate(self.unknown) if k != i and not is_zero(graph.derivative(rate, R))]:
            mistake = f"the law of contact {name!r} asks for the force that would hold it, on which {self.names[others[0]]!r} rubs too"
            raise TraceError(f"{mistake}; give both a law that rests exactly, such as Coulomb")
        share = -graph.derivative(rate, self.unknown[i])
        if graph.varies(share) & {R.name for R in self.unknown}:
            raise TraceError(f"the field {NOT_LINEAR.format(name)}")
        return Substituted(graph, {self.unknown[i].name: self.zero}).of(rate) / share

    def _add_switches(self, i: int, z: tuple[Sym, ...], held: tuple[Sym, ...], first: int) -> None:
        """The switches of a law that remembers."""
        slip, law, last = self.slips[i], self.laws[i], first + len(z)
        self.graph.sign(slip)
        guard = next(k for k, known in enumerate(self.graph.guards) if known is slip)
        switches = self._of_law(lambda: switches_of_law(law, slip, z, self.loads[i], held, self.flow.number))
        self.of_inner.append(abs(slip))
        for passed, modes, new in switches:
            memories = {last + k: mode for k, mode in enumerate(modes)}
            states = {} if new is None else {first + k: state for k, state in enumerate(new)}
            self.of_inner += [*memories.values(), *states.values(), *([] if passed is None else [passed])]
            if passed is None:
                self.at_rest[guard] = (memories, states)
            else:
                self.of_memories.append((passed, memories, states))

    def remembering(self, memories: dict[int, Sym], states: dict[int, Sym]) -> TracedSwitch:
        """What a law's switch makes of the modes and of the states."""
        flow, kept = self.flow, {state: mode for state, (mode, _) in self.memories.items()}
        modes = tuple((kept | memories).values())
        new = states | memories
        return TracedSwitch((*flow.held[: len(flow.held) - len(modes)], *modes), tuple(new.get(j) for j in range(len(self.y))))

    @property
    def of_laws(self) -> list[Sym]:
        """Expressions that laws give."""
        pairs = (pair for box in self.boxes for pair in (*box.slide.values(), *box.limits.values()))
        return [*self.of_inner, *(node for pair in pairs for node in pair)]

    def _of_law(self, call: Any) -> Any:
        """What a law gives; the numbers that stand in it are those of the case."""
        self.graph.of_user = True
        value = call()
        self.graph.of_user = False
        return value

    def _boxes(self, rates: Sequence[Sym]) -> list[Box]:
        """The contact problems: contacts whose forces act on one another's slip together."""
        graph, own = self.graph, self.y[: len(rates)]
        self._check_guards()
        self.share = {k: [self._share(k, rate) for rate in rates] for k in self.resting}  # of each force in the rate of each state
        self.alike = self._alike()
        free = self._with(rates, dict.fromkeys(self.resting, self.zero))
        slopes = {i: [graph.derivative(self.slips[i], state) for state in own] for i in self.resting}
        beta = {i: _total([graph.derivative(self.slips[i], self.flow.t), *_products(slopes[i], free)]) for i in self.resting}
        self.G = {(i, k): -_total([self.zero, *_products(slopes[i], self.share[k])]) for i in self.resting for k in self.resting}
        self.slopes = slopes
        slide = {i: _sums([self._sliding(k) for k in alike]) for i, alike in self.alike.items()}
        limits = {i: _sums([self._limits(k) for k in alike]) for i, alike in self.alike.items()}
        return [
            Box(
                graph, {i: self.sides[i] for i in group}, {i: slide[i] for i in group}, {i: limits[i] for i in group},
                {(i, k): self.G[i, k] for i in group for k in group}, {i: beta[i] for i in group}, self._apart(group),
            )
            for group in self._groups()
        ]  # fmt: skip

    def _alike(self) -> dict[int, list[int]]:
        """Contacts that always slip as one, by the first of them, whose force stands for the sum."""
        alike: dict[int, list[int]] = {}
        for i in self.resting:
            same = (k for k in alike if self.slips[i] is self.slips[k] and all(map(_is, self.share[i], self.share[k])))
            alike.setdefault(next(same, i), []).append(i)
        return alike

    def _apart(self, group: list[int]) -> frozenset[tuple[int, int]]:
        """Pairs of contacts of one coordinate, whose slips differ by what no force changes."""
        G = self.G
        return frozenset((i, k) for i, k in combinations(group, 2) if G[i, i] is G[i, k] is G[k, i] is G[k, k])

    def _share(self, k: int, rate: Sym) -> Sym:
        """How much of a friction force a rate takes; an error where that depends on friction forces."""
        share, name = self.graph.derivative(rate, self.unknown[k]), self.names[k]
        if self.graph.varies(share) & {R.name for R in self.unknown}:
            raise TraceError(f"the field {NOT_LINEAR.format(name)}")
        return share

    def _check_guards(self) -> None:
        """An error where the field asks for the friction of a contact that may rest."""
        for guard in self.graph.guards:
            for k in self.resting:
                if self.unknown[k].name in self.graph.varies(guard):
                    raise TraceError(f"the field {NOT_LINEAR.format(self.names[k])}")

    def _sliding(self, i: int) -> tuple[Sym, Sym]:
        """Friction force of a contact that slides forwards, and backwards."""
        slip, forces = self._seen(i), []
        for side in (1.0, -1.0):
            self.graph.assumed[slip.number] = side
            forces.append(self.flow.number(self._of_law(lambda: self.laws[i].sliding(slip, self.loads[i]))))
        self.graph.assumed.clear()
        return forces[0], forces[1]

    def _seen(self, i: int) -> Sym:
        """The slip as its law has it: at rest zero, and not what rounding makes of it."""
        return self.slips[i] if self._is_state(i) else self.graph.by_side(self.sides[i], self.slips[i], self.slips[i], self.zero)

    def _is_state(self, i: int) -> bool:
        return any(self.slips[i] is state for state in self.y)

    def _limits(self, i: int) -> tuple[Sym, Sym]:
        """Friction forces (backward, forward) that a contact can bear at rest."""
        low, high = self._of_law(lambda: self.laws[i].breakaway(self.loads[i]))
        return self.flow.number(low), self.flow.number(high)

    def _groups(self) -> list[list[int]]:
        groups: list[list[int]] = []
        for i in self.alike:
            joined = [group for group in groups if any(not (is_zero(self.G[i, k]) and is_zero(self.G[k, i])) for k in group)]
            groups = [*(group for group in groups if group not in joined), sorted([i, *(k for group in joined for k in group)])]
        return sorted(groups)

    # ---- modes ----
    def _size(self, i: int) -> Sym:
        """The size of what a slip is made of."""
        sizes = self.flow.sizes
        return self.graph.call("sqrt", _total([self.zero, *(g * g * (s * s) for g, s in zip(self.slopes[i], sizes, strict=False)), _LEAST]))

    def first(self) -> dict[int, Sym]:
        """What each contact does from the state alone: it rests where its slip is zero and friction can hold it."""
        sides: dict[int, Sym] = {}
        for box in self.boxes:
            sides |= self._all(box.decided({i: self._side(i) for i in box.group}))
        return {i: sides[i] for i in self.resting if sides}

    def _all(self, sides: dict[int, Sym]) -> dict[int, Sym]:
        """The same of all that slip as one."""
        return {k: side for i, side in sides.items() for k in self.alike[i]}

    def _side(self, i: int) -> Sym:
        """The side of a slip, zero up to rounding."""
        tolerance = self.zero if self._is_state(i) else SLIP * self._size(i)
        return self.graph.by_side(self.slips[i], *self._beyond(i, tolerance), self.zero)

    def _beyond(self, i: int, tolerance: Sym) -> tuple[Sym, Sym]:
        graph, slip = self.graph, self.slips[i]
        forwards = self.one if tolerance is self.zero else graph.select(slip - tolerance, self.one, self.zero)
        backwards = -self.one if tolerance is self.zero else graph.select(-slip - tolerance, -self.one, self.zero)
        return forwards, backwards

    def number(self, base: Sym, sides: dict[int, Sym]) -> Sym:
        """The number of the flow's mode, from that of the field's and what the contacts do; the first is 1."""
        many = len(self.resting)
        total = 1.0 + (base - 1.0) * self.graph.constant(float(3**many))
        for digit, i in enumerate(self.resting):
            total = total + (sides[i] + 1.0) * self.graph.constant(float(3 ** (many - 1 - digit)))
        return total

    def events(self) -> list[tuple[Sym, dict[int, Sym], dict[int, Sym]]]:
        """Guards of the contacts, with the sides and the states after them."""
        events = []
        graph, one = self.graph, self.one
        for box in self.boxes:
            forces = {i: self.forces[i] for i in box.group}
            for i in box.group:
                mode, (low, high), slip = self.sides[i], box.limits[i], self.slips[i]
                near = self.zero if self._is_state(i) else _NEAR * self._size(i)
                exactly = self._stopped(i)
                arrived = self.sides | self._all(box.decided({**box.modes, i: self.zero}))
                events += [
                    (graph.by_side(mode, slip + near, near - slip, one), arrived, exactly),
                    (graph.by_side(mode, one, one, high - forces[i]), self.sides | self._all({i: one}), exactly),
                    (graph.by_side(mode, one, one, forces[i] - low), self.sides | self._all({i: -one}), exactly),
                ]
        return events

    def _stopped(self, i: int) -> dict[int, Sym]:
        """States in which the slip is zero to the last digit: its friction takes what rounding left of it."""
        if self._is_state(i):
            return {next(j for j, state in enumerate(self.y) if state is self.slips[i]): self.zero}
        return {j: self.y[j] + share / self.G[i, i] * self.slips[i] for j, share in enumerate(self.share[i]) if not is_zero(share)}

    def ends(self) -> list[tuple[Sym, TracedSwitch]]:
        """A run ends where a load falls to zero, and where friction no longer brakes its contact."""
        none = (None,) * len(self.y)
        falls = [(load, Status.LOST) for load in self.loads] + [(self.G[i, i], Status.UNBRAKED) for i in self.resting]
        return [(value, TracedSwitch(self.flow.held, none, status)) for value, status in falls if value.level >= STATE]


_LEAST = 1e-300


def _products(a: Sequence[Sym], b: Sequence[Sym]) -> list[Sym]:
    return [x * y for x, y in zip(a, b, strict=True) if not (is_zero(x) or is_zero(y))]


def _sums(pairs: Sequence[tuple[Sym, Sym]]) -> tuple[Sym, Sym]:
    return _total([a for a, _ in pairs]), _total([b for _, b in pairs])


def _total(terms: Sequence[Any]) -> Any:
    total = terms[0]
    for term in terms[1:]:
        total = total + term
    return total
