"""Contacts of a switching flow: where it slips, how it rubs and what presses it; and the friction forces in plain numbers.

A field with contacts takes their friction forces, x' = f(t, y, R). Everything else follows: in a mode each contact under a law that rests
exactly slides to one side or rests. A resting contact has the force that keeps its slip velocity at zero, which follows from the rates of
the slips, w' = beta - G R: G and beta come from the lines of the field and of the slips.

This module computes them with numbers that carry slopes, for columns and for the judge; the engine derives them from traced equations.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems, SolveError
from stickslip.basics.fields import checked_number
from stickslip.basics.forward_ad import NestedDual, without_slopes
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.maths import where
from stickslip.models.friction.law_adapter import SWITCHES, TINY, LawAdapter, adapted, is_law

SIGNS = {-1: "-", 0: "0", 1: "+"}  #: of a mode's name: it slides backwards, rests, slides forwards
NOT_LINEAR = (  #: to be formatted with the name of a contact
    "is not linear in the friction force R.{0}, so that no force which holds the contact follows; allowed are rates such as (F - R.{0})/m, "
    "with factors and conditions that do not depend on friction"
)
_SAME = 1e-12  # of a share of a force
_LOAD = "a number, or a function of (t, y) that returns it"


@dataclass(frozen=True, eq=False)
class FlowContact:
    """A contact of a `SwitchingFlow` that rubs.

    Parameters
    ----------
    slip : callable
        Slip velocity as a function of (t, y), or of (t, y, n) in a flow with numbers; positive forwards.
    friction : law or callable
        Any friction law that compiles, or a function of the flow's numbers n that returns it, such as
        ``lambda n: ss.Coulomb(mu_plus=n.mu, mu_minus=n.mu)``.
    load : float or callable
        Normal force: a number, or a function of the same arguments as `slip`. A run ends where it falls to zero.

    Examples
    --------
    >>> import stickslip as ss
    >>> contact = FlowContact(slip=lambda t, y: y[1] - 0.1, friction=ss.Coulomb(mu_plus=0.2, mu_minus=0.2), load=9.81)
    >>> round(contact.slip(0.0, [0.0, 0.3]), 12)
    0.2
    """

    slip: Callable[..., Any]
    friction: Any
    load: Any

    def __post_init__(self) -> None:
        problems = Problems("FlowContact")
        if not callable(self.slip):
            problems.add(f"slip = {self.slip!r}; allowed is a function of (t, y) that returns the slip velocity; type lambda t, y: y[1]")
        if isinstance(self.friction, type) or not (is_law(self.friction) or callable(self.friction)):
            allowed = "allowed is a friction law, or a function of the flow's numbers that returns one"
            problems.add(f"friction = {self.friction!r}; {allowed}; type friction=ss.Coulomb(mu_plus=0.2, mu_minus=0.2)")
        if not callable(self.load):
            checked_number("load", self.load, problems, None, _LOAD, "load=9.81")
        problems.check()

    def law(self, *n: Any) -> LawAdapter:
        """The law, to be asked in one way; of a flow with numbers from these."""
        law = adapted(self.friction if is_law(self.friction) else self.friction(*n))
        if not law.compiles:
            mistake = f"friction = {law.name} is random or solved in plain Python alone; allowed are laws that compile, such as GMS"
            raise InputError("FlowContact", [f"{mistake}; for this one write a Machine of bodies and contacts instead of a flow"])
        return law

    def normal(self, t: Any, y: Any, *n: Any) -> Any:
        """Normal force."""
        return self.load(t, y, *n) if callable(self.load) else self.load

    def with_numbers(self, n: Any) -> FlowContact:
        """The same contact with the flow's numbers substituted."""
        load = (lambda t, y: self.load(t, y, n)) if callable(self.load) else self.load
        return FlowContact(lambda t, y: self.slip(t, y, n), self.friction if is_law(self.friction) else self.friction(n), load)


def check_contacts(problems: Problems, contacts: Any, fields: Mapping[Any, Any]) -> dict[str, FlowContact]:
    """The contacts of a flow; problems for what is none."""
    if contacts is None:
        return {}
    if not isinstance(contacts, Mapping) or not all(isinstance(each, FlowContact) for each in contacts.values()):
        typed = (
            'contacts={"belt": ss.machines.FlowContact(slip=lambda t, y: y[1], friction=ss.Coulomb(mu_plus=0.2, mu_minus=0.2), load=9.81)}'
        )
        problems.add(f"contacts = {contacts!r}; allowed is a dict of FlowContact by name; type {typed}")
        return {}
    for name in contacts:
        if not (isinstance(name, str) and name.isidentifier()):
            problems.add(f"contacts has {name!r}; allowed are names that can be typed after R.")
    if len(contacts) > _MOST:
        problems.add(f"contacts has {len(contacts)} of them; allowed are {_MOST}, of which every combination of rest and slip is a mode")
    return dict(contacts)


_MOST = 4


def inner_names(contacts: Mapping[str, FlowContact], *n: Any) -> tuple[str, ...]:
    """Names of the states that the laws of the contacts add to those of the field."""
    names: list[str] = []
    for name, contact in contacts.items():
        law = contact.law(*n)
        for letter, count in (("z", law.states), ("memory", law.modes)):
            names += [f"{letter}_{name}"] if count == 1 else [f"{letter}_{name}_{k}" for k in range(count)]
    return tuple(names)


def memories_of(contacts: Mapping[str, FlowContact], *n: Any) -> Array:
    """Which of these states are whole numbers that a law remembers: nothing moves them but its switches."""
    laws = [contact.law(*n) for contact in contacts.values()]
    return np.array([remembered for law in laws for remembered in [False] * law.states + [True] * law.modes], bool)


def inner_scales(contacts: Mapping[str, FlowContact], y: Sequence[float], *n: Any) -> tuple[float, ...]:
    """A typical size of each inner state: what the law says, else 1."""
    sizes: list[float] = []
    for contact in contacts.values():
        law = contact.law(*n)
        own = law.scale(contact.normal(0.0, list(y), *n)) if law.states else ()
        sizes += [1.0] * law.states if own is None else [float(size) or 1.0 for size in own]
        sizes += [1.0] * law.modes
    return tuple(sizes)


def resting_contacts(contacts: Mapping[str, FlowContact], *n: Any) -> tuple[str, ...]:
    """The names of the contacts that can rest, so that modes say what each of them does."""
    return tuple(name for name, contact in contacts.items() if not contact.law(*n).dynamic)


def modes_passed(flow: Any, name: str) -> tuple[list[bool], list[bool]]:
    """Of each mode of a flow whether a switch of this name may come from it, and whether it may lead to it.

    Examples
    --------
    >>> import stickslip as ss
    >>> hit = ss.Switch(lambda t, y: y[0], "up", lambda t, y: (0.0, -y[1]))
    >>> fall = lambda t, y: (y[1], -9.81)
    >>> modes_passed(ss.SwitchingFlow({"down": fall, "up": fall}, {"down": (hit,)}), "down to up")
    ([True, False], [False, True])
    """
    kind, _, contact = name.partition(" of ")
    rests = resting_contacts(flow.contacts, *flow.given_once)
    if kind in SWITCHES and contact in rests:
        still = [sides[rests.index(contact)] == 0 for _, sides in flow.labels.values()]
        moves = [not each for each in still]
        return (moves, still) if kind == "stick" else (still, moves)
    pairs = [(a, b) for a in flow.modes for b in flow.modes if f"{a} to {b}" == name]
    return [any(a == mode for a, _ in pairs) for mode in flow.modes], [any(b == mode for _, b in pairs) for mode in flow.modes]


def mode_labels(fields: Mapping[Any, Any], resting: Sequence[str]) -> dict[Any, tuple[Any, tuple[int, ...]]]:
    """The modes of a flow: each field's mode with what each contact does, +1, 0 or -1.

    Examples
    --------
    >>> list(mode_labels({0: None}, ["belt"])), mode_labels({"air": None, "held": None}, ["a", "b"])["held: a+ b0"]
    (['belt-', 'belt0', 'belt+'], ('held', (1, 0)))
    """
    if not resting:
        return {mode: (mode, ()) for mode in fields}
    labels: dict[Any, tuple[Any, tuple[int, ...]]] = {}
    for mode in fields:
        for sides in itertools.product((-1, 0, 1), repeat=len(resting)):
            does = " ".join(f"{name}{SIGNS[side]}" for name, side in zip(resting, sides, strict=True))
            labels[does if len(fields) == 1 else f"{mode}: {does}"] = (mode, sides)
    return labels


@sealed
@dataclass(frozen=True, eq=False)
class ContactColumns:
    """What a contact does at the instants of a run.

    Parameters
    ----------
    slip, load, friction_force : array (time,)
        Slip velocity, normal force, and friction force, which is positive against forward slip.
    mode : array (time,)
        +1 where it slides forwards, 0 at rest, -1 backwards; under a law with inner states the sign of its slip.
    """

    slip: Array
    load: Array
    friction_force: Array
    mode: Array


def contact_columns(flow: Any, t: Array, y: Array, modes: Array) -> dict[str, ContactColumns]:
    """What each contact does at instants (time,) with states (time, state), in modes by their places among the flow's.

    Examples
    --------
    >>> import numpy as np
    >>> import stickslip as ss
    >>> belt = FlowContact(slip=lambda t, y: y[1] - 0.1, friction=ss.Coulomb(mu_plus=0.2, mu_minus=0.2), load=9.81)
    >>> flow = ss.SwitchingFlow(lambda t, y, R: (y[1], -4.0 * y[0] - R.belt), contacts={"belt": belt})
    >>> belt = contact_columns(flow, np.zeros(2), np.array([[0.0, 0.0], [0.2, 0.1]]), np.array([0, 1]))["belt"]
    >>> belt.friction_force.round(3).tolist(), belt.mode.tolist()
    ([-1.962, -0.8], [-1, 0])
    """
    forces, labels = ContactForces(flow.plain), list(flow.labels.values())
    columns = {name: [np.full(len(t), np.nan) for _ in range(4)] for name in flow.contacts}
    for number in np.unique(modes):
        at, (base, sides) = modes == number, labels[number]
        states = list(y[at].T)
        slips, loads, R = forces.slips(t[at], states), forces.loads(t[at], states), forces.forces(base, sides, t[at], states)
        known = dict(zip(forces.resting, sides, strict=True))
        for name, own in columns.items():
            side = known[name] if name in known else np.sign(slips[name])
            for column, values in zip(own, (slips[name], loads[name], R[name], side), strict=True):
                column[at] = values
    return {name: ContactColumns(slip, load, R, side.astype(int)) for name, (slip, load, R, side) in columns.items()}


class ContactForces:
    """The friction forces of a flow of single numbers, by plain arithmetic.

    Parameters
    ----------
    flow : SwitchingFlow
        With its numbers substituted (`SwitchingFlow.plain`).

    Examples
    --------
    A block on a belt, held against a spring:

    >>> import stickslip as ss
    >>> belt = FlowContact(slip=lambda t, y: y[1] - 0.1, friction=ss.Coulomb(mu_plus=0.2, mu_minus=0.2), load=9.81)
    >>> flow = ss.SwitchingFlow(lambda t, y, R: (y[1], -4.0 * y[0] - R.belt), contacts={"belt": belt})
    >>> ContactForces(flow).forces(0, (0,), 0.0, [0.2, 0.1])
    {'belt': -0.8}
    """

    def __init__(self, flow: Any):
        self.fields, self.contacts = flow.fields, flow.contacts
        self.laws = {name: contact.law() for name, contact in self.contacts.items()}
        self.resting = tuple(name for name, law in self.laws.items() if not law.dynamic)
        self.inner = sum(law.states + law.modes for law in self.laws.values())

    # ---- what the user's functions give ----
    def own(self, y: Sequence[Any]) -> Sequence[Any]:
        """The states of the field, without those of the laws."""
        return y[: len(y) - self.inner]

    def slips(self, t: Any, y: Sequence[Any]) -> dict[str, Any]:
        """Slip velocity of each contact."""
        return {name: _one(contact.slip(t, self.own(y))) for name, contact in self.contacts.items()}

    def loads(self, t: Any, y: Sequence[Any]) -> dict[str, Any]:
        """Normal force on each contact."""
        return {name: _one(contact.normal(t, self.own(y))) for name, contact in self.contacts.items()}

    def _field(self, mode: Any, t: Any, y: Sequence[Any], R: Mapping[str, Any]) -> list[Any]:
        return [_one(rate) for rate in self.fields[mode](t, self.own(y), SimpleNamespace(**R))]

    def _inner(self, mode: Any, t: Any, y: Sequence[Any]) -> tuple[dict[str, Any], list[Any]]:
        """Forces of the laws with a rate and a force, and the rates of their states; memories have none."""
        forces, rates = {}, []
        slips, loads, at = self.slips(t, y), self.loads(t, y), len(y) - self.inner
        for name, law in self.laws.items():
            if law.dynamic:
                z, held = tuple(y[at : at + law.states]), tuple(y[at + law.states : at + law.states + law.modes])
                applied = self._applied(mode, name, t, y) if law.needs_applied else 0.0
                forces[name], own = law.response(slips[name], z, loads[name], held, applied)
                rates += [*own, *(0.0 * each for each in held)]
                at += law.states + law.modes
        return forces, rates

    def _applied(self, mode: Any, name: str, t: Any, y: Sequence[Any]) -> Any:
        """The force that would keep the slip of a contact as it is, where nothing else rubs on it."""
        R = {k: NestedDual(0.0, [0.0, 1.0 if k == name else 0.0]) for k in self.contacts}
        slip = self._slips_along(mode, (name,), t, y, R, 1)[name]
        return slip.slope(0) / (0.0 - slip.slope(1))

    # ---- forces ----
    def problem(
        self, mode: Any, t: Any, y: Sequence[Any], force: float = 0.0
    ) -> tuple[dict[tuple[str, str], Any], dict[str, Any]]:  # fmt: skip
        """How the friction forces take part in the rates of the slips, w' = beta - G R: G and beta, of the contacts that can rest.

        Both are taken where all forces are `force`, which is the same for every force where the field is linear in them.
        """
        names, inner = self.resting, self._inner(mode, t, y)[0]
        R = {name: NestedDual(force, [0.0, *(1.0 if k == name else 0.0 for k in names)]) for name in names}
        slips = self._slips_along(mode, names, t, y, {**inner, **R}, len(names))
        G = {(i, k): 0.0 - slips[i].slope(1 + number) for i in names for number, k in enumerate(names)}
        return G, {name: slips[name].slope(0) for name in names}

    def _slips_along(
        self, mode: Any, names: Sequence[str], t: Any, y: Sequence[Any], R: Mapping[str, Any], count: int
    ) -> dict[str, Any]:  # fmt: skip
        """Slips along the motion under forces with slopes from 1 to `count`: their own rates, and those by each of these slopes."""
        rates = [NestedDual.lifted(rate) for rate in self._field(mode, t, y, R)]
        along = [NestedDual(value, [rate.value, *(rate.slope(1 + k) for k in range(count))]) for value, rate in zip(y, rates, strict=False)]
        return {name: NestedDual.lifted(_one(self.contacts[name].slip(NestedDual(t, [1.0]), along))) for name in names}

    def sliding(self, name: str, side: int, slip: Any, load: Any) -> Any:
        """Friction force of a contact that slides to a side."""
        value = without_slopes(slip)  # what rounding puts on the other side is on this one, and keeps its slope
        return self.laws[name].sliding(slip + where(side * value > 0.0, 0.0 * value, side * TINY - value), load)

    def forces(self, mode: Any, sides: Sequence[int], t: Any, y: Sequence[Any]) -> dict[str, Any]:
        """The friction force of each contact, positive against forward slip, in a mode of the field with these sides."""
        inner, _ = self._inner(mode, t, y)
        slips, loads = self.slips(t, y), self.loads(t, y)
        R = {name: self.sliding(name, side, slips[name], loads[name]) for name, side in zip(self.resting, sides, strict=True) if side}
        rest = [name for name in self.resting if name not in R]
        if rest:
            G, beta = self.problem(mode, t, y)
            first = {i: next(k for k in rest if is_same(G, i, k)) for i in rest}  # of those that slip as one
            held = _held(list(dict.fromkeys(first.values())), G, {i: _less(beta[i], [(G[i, k], R[k]) for k in R]) for i in rest})
            for i, one in first.items():
                R[i] = self._shared(held[one], i, [k for k in rest if first[k] == one], loads)
        R |= inner
        return {name: R[name] for name in self.contacts}

    def _shared(self, total: Any, name: str, alike: Sequence[str], loads: Mapping[str, Any]) -> Any:
        """The part of a contact in the force that holds several: in proportion to what each can bear, as that of machines."""
        if len(alike) == 1:
            return total
        limits = {k: self.laws[k].breakaway(loads[k]) for k in alike}
        lows, highs = (sum(limits[k][side] for k in alike) for side in (0, 1))
        low, high = limits[name]
        return total * where(total > 0.0, high / where(highs > 0.0, highs, 1.0), low / where(lows < 0.0, lows, -1.0))

    def rates(self, mode: Any, sides: Sequence[int], t: Any, y: Sequence[Any]) -> list[Any]:
        """Rates of all states, those of the laws last."""
        return [*self._field(mode, t, y, self.forces(mode, sides, t, y)), *self._inner(mode, t, y)[1]]

    def stopped(self, mode: Any, name: str, t: Any, y: Sequence[Any]) -> list[Any]:
        """The state with the slip of a contact at zero, by an impulse of its friction."""
        G, _ = self.problem(mode, t, y)
        R = {k: NestedDual(0.0, [1.0 if k == name else 0.0]) for k in self.resting}
        rates = [NestedDual.lifted(rate) for rate in self._field(mode, t, y, {**self._inner(mode, t, y)[0], **R})]
        share = self.slips(t, y)[name] / G[name, name]
        own = [value + rate.slope(0) * share for value, rate in zip(self.own(y), rates, strict=True)]
        return [*own, *y[len(own) :]]

    def load_lost(self, name: str) -> Callable[..., Any]:
        """What the judge does where a load falls to zero: it raises `SolveError`."""

        def lost(t: Any, y: Any) -> Any:
            raise SolveError(f"the load of contact {name!r} falls to zero at t = {float(t):.9g}")

        return lost


def is_same(G: Mapping[tuple[str, str], Any], i: str, k: str) -> bool:
    """Whether two contacts act on one coordinate alike, so that only the sum of their forces matters."""
    values = [np.asarray(without_slopes(G[pair]), float) for pair in ((i, i), (i, k), (k, i), (k, k))]
    return i == k or all(bool(np.all(abs(value - values[0]) <= _SAME * abs(values[0]))) for value in values)


def _one(value: Any) -> Any:
    """One number of what a function returned."""
    return value[0] if isinstance(value, (tuple, list)) and len(value) == 1 else value


def _less(total: Any, pairs: Sequence[tuple[Any, Any]]) -> Any:
    for a, b in pairs:
        total = total - a * b
    return total


def _held(names: Sequence[str], G: Mapping[tuple[str, str], Any], beta: Mapping[str, Any]) -> dict[str, Any]:
    """The forces that keep all rates at zero, G R = beta: by elimination, for numbers of any kind."""
    if len(names) == 1:
        return {names[0]: beta[names[0]] / G[names[0], names[0]]}
    first, *others = names
    factors = {i: G[i, first] / G[first, first] for i in others}
    smaller = {(i, k): G[i, k] - factors[i] * G[first, k] for i in others for k in others}
    R = _held(others, smaller, {i: beta[i] - factors[i] * beta[first] for i in others})
    return {first: _less(beta[first], [(G[first, k], R[k]) for k in others]) / G[first, first], **R}
