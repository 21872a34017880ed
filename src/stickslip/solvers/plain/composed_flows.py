"""A flow with contacts as one without: a field for each direction of slip and one for rest, written down by plain arithmetic.

This is what a user would write by hand. The judge follows it, and derivatives of fields and guards come from it. The forces are those of
`models.flow_contacts`, the modes after an event those of `deciding`: no line is shared with the engine.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.models.flow_contacts import NOT_LINEAR, ContactForces, is_same
from stickslip.models.switching_flow import Switch, SwitchingFlow, knows_mode
from stickslip.solvers.plain.deciding import ROUNDING, AtZero, decide

if TYPE_CHECKING:
    from stickslip.basics.contracts import Array


def composed(flow: SwitchingFlow) -> SwitchingFlow:
    """A flow of single numbers as one of functions of (t, y) alone, with the same modes and no contacts.

    Examples
    --------
    >>> import stickslip as ss
    >>> belt = ss.machines.FlowContact(slip=lambda t, y: y[1] - 0.1, friction=ss.Coulomb(mu_plus=0.2, mu_minus=0.2), load=9.81)
    >>> flow = ss.SwitchingFlow(lambda t, y, R: (y[1], -4.0 * y[0] - R.belt), contacts={"belt": belt})
    >>> plain = composed(flow)
    >>> plain.fields["belt-"](0.0, [0.0, 0.0]), plain.switches["belt-"][0].to(0.0, [0.2, 0.1])
    ([0.0, 1.962], 'belt0')
    """
    plain = flow.plain
    return _Composition(plain).flow if flow.contacts else plain


def check_judged(flow: SwitchingFlow) -> None:
    """`InputError` for a flow that the judge cannot follow: its modes do not say what laws remember."""
    names = [name for name, contact in flow.contacts.items() if contact.law(*flow.given_once).modes]
    if names:
        mistake = f"the law of contact {names[0]!r} remembers whole numbers, which SciPy's integrator does not follow in a flow"
        other = 'compare it with ss.solve(machine, method="radau") of a Machine of bodies and contacts'
        raise InputError("SwitchingFlow", [f"{mistake}; allowed are other laws, such as LuGre; {other}"])


def mode_of_state(flow: SwitchingFlow, y: Array, t: float = 0.0, mode: Any = None) -> Any:
    """The mode of a flow of single numbers at a state: in a mode of its fields, the first if not given, contacts do what the state says.

    Raises
    ------
    InputError
        Where friction does not brake its contact.

    Examples
    --------
    >>> import stickslip as ss
    >>> belt = ss.machines.FlowContact(slip=lambda t, y: y[1] - 0.1, friction=ss.Coulomb(mu_plus=0.2, mu_minus=0.2), load=9.81)
    >>> flow = ss.SwitchingFlow(lambda t, y, R: (y[1], -4.0 * y[0] - R.belt), contacts={"belt": belt})
    >>> [mode_of_state(flow, [x, v]) for x, v in ((0.0, 0.0), (0.2, 0.1), (0.9, 0.1))]
    ['belt-', 'belt0', 'belt-']
    """
    base = next(iter(flow.fields)) if mode is None else mode
    if not flow.contacts or knows_mode(flow.labels, base):
        return base
    return _Composition(flow.plain).begun(base, t, y)


def mode_of_strobe_state(flow: SwitchingFlow, state: Array) -> Any:
    """The mode of a strobe state, whose last number is the mode's place; below zero the state decides, as for `flow_engine.ends`."""
    code = round(float(state[-1]))
    return flow.modes[code] if code >= 0 else mode_of_state(flow, state[:-1], mode=list(flow.fields)[-1 - code])


class _Composition:
    """The modes of a flow with contacts, one by one."""

    def __init__(self, flow: SwitchingFlow):
        self.user, self.contacts, self.labels = flow, ContactForces(flow), flow.labels
        self.label = {what: label for label, what in flow.labels.items()}
        self.names = self.contacts.resting

    @property
    def flow(self) -> SwitchingFlow:
        """The flow of all modes."""
        fields = {label: self._field(*what) for label, what in self.labels.items()}
        switches = {label: (*self._of_contacts(*what), *self._of_user(*what)) for label, what in self.labels.items()}
        states = self.user.names(len(self.user.states) + self.contacts.inner) if self.user.states is not None else None
        return SwitchingFlow(fields, switches, self.user.period, {}, states)

    def _field(self, base: Any, sides: Sequence[int]) -> Callable[..., Any]:
        return lambda t, y: self.contacts.rates(base, sides, t, y)

    # ---- switches ----
    def _of_contacts(self, base: Any, sides: Sequence[int]) -> list[Switch]:
        """A slip that falls to zero, forces that leave their limits, and loads that are lost."""
        switches = []
        for name, side in zip(self.names, sides, strict=True):
            ends = (self._arrives,) if side else (self._breaks(1), self._breaks(-1))
            switches += [end(base, tuple(sides), name, side) for end in ends]
        lost = [(name, contact) for name, contact in self.user.contacts.items() if callable(contact.load)]
        return switches + [Switch(self._load(name), self.contacts.load_lost(name)) for name, _ in lost]

    def _load(self, name: str) -> Callable[..., Any]:
        return lambda t, y: self.contacts.loads(t, y)[name]

    def _arrives(self, base: Any, sides: tuple[int, ...], name: str, side: int) -> Switch:
        stopped = lambda t, y: self.contacts.stopped(base, name, t, y)  # noqa: E731

        def to(t: Any, y: Any) -> Any:
            rested = stopped(t, y)
            alike = self._alike(base, name, t, rested)
            known = {k: s for k, s in zip(self.names, sides, strict=True) if s and k not in alike}
            return self.label[base, self.decided(base, t, rested, known, [not s for s in sides])]

        return Switch(lambda t, y: side * self.contacts.slips(t, y)[name], to, stopped)

    def _breaks(self, way: int) -> Callable[..., Switch]:
        def switch(base: Any, sides: tuple[int, ...], name: str, side: int) -> Switch:
            def to(t: Any, y: Any) -> Any:
                alike = self._alike(base, name, t, y)
                return self.label[base, tuple(way if k in alike else s for k, s in zip(self.names, sides, strict=True))]

            def left(t: Any, y: Any) -> Any:
                low, high = self.contacts.laws[name].breakaway(self.contacts.loads(t, y)[name])
                R = self.contacts.forces(base, sides, t, y)[name]
                return high - R if way > 0 else R - low

            return Switch(left, to, lambda t, y: self.contacts.stopped(base, name, t, y))

        return switch

    def _alike(self, base: Any, name: str, t: Any, y: Any) -> set[str]:
        """A contact, and those that slip as one with it: of one coordinate and with the same slip."""
        G, slips = self.contacts.problem(base, t, y)[0], self.contacts.slips(t, y)
        return {k for k in self.names if is_same(G, name, k) and float(slips[k]) == float(slips[name])}

    def _of_user(self, base: Any, sides: Sequence[int]) -> list[Switch]:
        return [self._user_switch(s) for s in self.user.switches.get(base, ())]

    def _user_switch(self, switch: Switch) -> Switch:
        """A switch of the user's, after which the contacts do what the state says."""
        own = self.contacts.own

        def reset(t: Any, y: Any) -> Any:
            new = own(y) if switch.reset is None else switch.reset(t, own(y))
            return [*new, *y[len(own(y)) :]]

        def to(t: Any, y: Any) -> Any:
            return self.begun(switch.to(t, own(y)) if callable(switch.to) else switch.to, t, reset(t, y))

        return Switch(lambda t, y: switch.guard(t, own(y)), to, None if switch.reset is None else reset)

    # ---- decisions ----
    def begun(self, base: Any, t: Any, y: Any) -> Any:
        """The mode at a state."""
        self._check_linear(base, t, list(map(float, y)))
        return self.label[base, self.decided(base, t, list(map(float, y)), {}, [False] * len(self.names))]

    def _check_linear(self, base: Any, t: Any, y: Sequence[float]) -> None:
        """`InputError` where the field is not linear in the forces of contacts that can rest."""
        G, other = (self.contacts.problem(base, t, y, force)[0] for force in (0.0, 1.0))
        for (i, k), share in G.items():
            if abs(float(share) - float(other[i, k])) > _SAME * abs(float(other[i, k])):
                raise InputError("SwitchingFlow", [f"the field {NOT_LINEAR.format(k)}"])

    def decided(self, base: Any, t: Any, y: Sequence[Any], known: Mapping[str, int], rested: Sequence[bool]) -> tuple[int, ...]:
        """What each contact does: slides as known or as its slip says, else rests or begins to slide."""
        if not self.names:
            return ()
        G, beta = self.contacts.problem(base, t, y)
        slips, loads, laws = self.contacts.slips(t, y), self.contacts.loads(t, y), self.contacts.laws
        size = ROUNDING * max(1e-300, *(abs(float(value)) for value in y))
        forced = {}
        _check_braking(self.names, G)
        for number, name in enumerate(self.names):
            if name in known or abs(float(slips[name])) > size:
                forced[number] = known.get(name, 1 if slips[name] > 0 else -1)
        limits = [laws[name].breakaway(loads[name]) for name in self.names]
        slide = tuple([self.contacts.sliding(name, side, slips[name], loads[name]) for name in self.names] for side in (-1, 1))
        matrix = np.array([[float(G[i, k]) for k in self.names] for i in self.names])
        low, high = ([float(pair[k]) for pair in limits] for k in (0, 1))
        kinetic = list(map(float, slide[0])), list(map(float, slide[1]))
        answer = decide(AtZero(matrix, [float(beta[i]) for i in self.names], low, high, kinetic, forced, rested))
        return tuple(answer.sides)


_SAME = 1e-9  # of a share of a force that does not depend on it
_SINGULAR = 1e-12  # of the product of the diagonal: a determinant that is zero


def _check_braking(names: Sequence[str], G: Mapping[tuple[str, str], Any]) -> None:
    """`InputError` where a friction force does not act against the slip of its contact, or slips follow from one another."""
    for name in names:
        if not (value := float(G[name, name])) > 0.0:
            mistake = f"the friction force R.{name} does not brake the slip of its contact: it changes the slip's rate by {-value:.6g} per"
            allowed = f"unit of force; allowed is a field in which it acts against forward slip; type for example (F - R.{name})/m"
            raise InputError("SwitchingFlow", [f"{mistake} {allowed}"])
    for count in range(2, len(names) + 1):
        for some in combinations(names, count):
            if any(is_same(G, i, k) for i, k in combinations(some, 2)):
                continue
            size = float(np.prod([float(G[name, name]) for name in some]))
            if not np.linalg.det([[float(G[i, k]) for k in some] for i in some]) > _SINGULAR * size:
                mistake = (
                    f"contacts {', '.join(some)}: the slip of one follows from those of the others, so that their forces at rest do not"
                )
                one = "give one contact less, or write a Machine of bodies and contacts, which SciPy's integrator follows"
                raise InputError("SwitchingFlow", [f"{mistake}; allowed are slips that can vary on their own; {one}"])
