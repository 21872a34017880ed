"""The tangent of a system: how far a small change of its start, of its numbers, or of both has moved its state.

Beside every state y there is S, its change along one direction: S' = J S + f_p, by the derivatives of the traced equations. Where a guard g
falls to zero at a time that depends on the direction too,

    S+ = R_x S + R_p - (f+ - R_x f- - R_t) tau,    tau = -(g_x S + g_p) / (g_x f- + g_t),

with the reset R of the switch and tau, by how much later it happens (Hiskens and Pai 2000; di Bernardo, Budd, Champneys and Kowalczyk 2008,
section 2.5). Guards that follow from an event in the same instant (a foot that gives way because another has landed) have its tau.

Where a number changes the period, time is measured in periods: t changes by t dT/T, S' gains f dT/T, and a strobe stays a strobe. So the
end of a run is its end whatever its direction, and S needs no term for it.

A direction is data: its part in a number `name` is the number ``d name`` of the case, and its part in the start is the start of S. So one
kernel serves all directions, a lane for each, and is hardly longer than the system's own.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from stickslip.engine.graphs import Along, Substituted
from stickslip.engine.symbols import Sym
from stickslip.engine.system import Switch, System
from stickslip.engine.taylor import watched
from stickslip.errors import InputError, did_you_mean

__all__ = ["part_in", "tangent", "with_observables"]

_SAME_INSTANT = 1e-9  # of a period: a guard further from zero than it goes in this time did not fire by itself


def part_in(name: str) -> str:
    """The name of a direction's part in a number of the case."""
    return f"d {name}"


def tangent(system: System, wrt: Iterable[str] | None = None) -> System:
    """The system with the change of its state along one direction: in its start, and in the numbers named in `wrt` (all, if None).

    Steps, events and states of the system itself stay as they are, to the last bit: the changes are passive.

    Returns
    -------
    System
        Its states are those of the system, then the change of each, that of the way where this is no state, and that of the instant of the
        last event [s].

    Raises
    ------
    InputError
        For a name that is no number of the system.
    """
    names = _known(system, system.names if wrt is None else tuple(wrt))
    graph, zero = system.graph, system.graph.constant(0.0)
    rows, rates = _rows(system)
    changes = [graph.variable(f"d {y.name}") for y in rows]
    parts = {name: graph.case(part_in(name)) for name in names}
    pace = Along(graph, parts).of(system.period) / system.period
    along = Along(graph, parts | {y.name: S for y, S in zip(rows, changes, strict=True)} | {"t": pace * system.t})
    late = graph.variable("d event")
    slopes = [along.of(f) + pace * f for f in rates]
    instants = [*system.instants, *(instant for instant, _ in system.impulses)]
    given = [along.of(instant) - pace * instant for instant in instants]
    found = _with_passive(system, [*changes, late], [*slopes, zero])
    switches = {k: _saltation(system, k, rows, rates, changes, late, along) for k in _switching(system)}
    return replace(
        found,
        names=(*system.names, *map(part_in, names)),
        switches=system.switches | switches,
        carried=tuple(rates),
        delays=tuple(given),
        kicks=tuple(tuple(map(along.of, jumps)) for _, jumps in system.impulses),
        settled=_settled(system, changes, along),
    )


def with_observables(system: System, observed: dict[str, Sym]) -> System:
    """The system with the integral of some expressions of its own graph over time, from 0 at the start, as passive states."""
    graph = system.graph
    return _with_passive(system, [graph.variable(name) for name in observed], list(observed.values()))


def _with_passive(system: System, states: list[Sym], rates: list[Sym]) -> System:
    """States that ride along: no step, no event and no other state depends on them."""
    none = (None,) * len(states)
    switches = {k: replace(switch, states=(*switch.states, *none)) for k, switch in system.switches.items()}
    return replace(
        system,
        y=(*system.y, *states),
        f=(*system.f, *rates),
        scales=(*system.scales, *none),
        switches=switches,
        passive=system.passive + len(states),
    )


def _known(system: System, wrt: tuple[str, ...]) -> tuple[str, ...]:
    """The names, where the system has such numbers."""
    wrong = [name for name in wrt if name not in system.names]
    if wrong:
        allowed = f"allowed are the numbers of the equations: {', '.join(system.names)}"
        raise InputError("tangent", [f"{name!r} is none of them{did_you_mean(name, system.names)}; {allowed}" for name in wrong])
    return wrt


def _rows(system: System) -> tuple[list[Sym], list[Sym]]:
    """What changes: the states, and the way where it is none of them; with their rates."""
    count = system.states - system.passive
    rows, rates = list(system.y[:count]), list(system.f[:count])
    if system.cyclic:
        rows.append(system.graph.variable("way"))
        rates.append(system.y[0] + system.offset)
    return rows, rates


def _switching(system: System) -> list[int]:
    """The guards at which something changes and the run goes on."""
    seen = range(len(system.guards)) if system.dynamic else watched(system)
    return [k for k in seen if k not in system.switches or not system.switches[k].status]


def _saltation(system: System, k: int, rows: list[Sym], rates: list[Sym], changes: list[Sym], late: Sym, along: Along) -> Switch:
    """The switch of a guard with what it does to the changes."""
    graph, guard = system.graph, system.guards[k]
    old = system.switches.get(k, Switch(system.modes, (None,) * system.states))
    resets = [y if new is None else new for y, new in zip(system.y, old.states, strict=True)]
    changed = {mode.name: new for mode, new in zip(system.modes, old.modes, strict=True) if new is not mode}
    if k < system.signs:
        changed[f"b{k}"] = -graph.mode(f"b{k}")
    after = Substituted(graph, changed | {y.name: new for y, new in zip(system.y, resets, strict=True) if new is not y})
    flow = Along(graph, {y.name: f for y, f in zip(rows, rates, strict=True)} | {system.t.name: graph.constant(1.0)})
    tau = _later(system, guard, flow.of(guard), along.of(guard), late)
    same = Substituted(graph, {guard.name: graph.constant(0.0)} if guard.op == "variable" else {})
    new_rows = [*resets[: system.states - system.passive], *rows[system.states - system.passive :]]
    new: list[Sym | None] = []
    for row, rate, S in zip(new_rows, rates, changes, strict=True):
        then, before = after.of(rate), flow.of(row)
        jump = graph.constant(0.0) if same.of(then) is same.of(before) else then - before  # such as of what knows abs(v), where v is 0
        moved = along.of(row) - jump * tau
        new.append(None if moved is S else moved)
    return Switch(old.modes, (*old.states, *new, tau), old.status)


def _later(system: System, guard: Sym, falls: Sym, moved: Sym, late: Sym) -> Sym:
    """By how much later a guard fires: by itself, or as what follows from the last event, in the same instant."""
    if falls.op == "constant" and falls.value == 0.0:  # nothing but a jump makes it fire
        return late
    follows = _size(guard) - _SAME_INSTANT * (system.period * _size(falls))
    return system.graph.select(follows, late, -(moved / falls))


def _settled(system: System, changes: list[Sym], along: Along) -> dict[int, Sym]:
    """The changes of velocities at a start: a contact that rests there has none of its slip."""
    graph, exact = system.graph, [contact for contact in system.contacts if contact.branches is not None]
    now: dict[int, Sym] = {}
    first = system.states
    for _ in exact if any(sum(map(abs, contact.direction)) > 1.0 for contact in exact) else exact[:1]:  # bodies on bodies pass it on
        for contact in exact:
            (number,), j = contact.modes, contact.direction.index(1.0)
            slips = Substituted(graph, {changes[i - first].name: new for i, new in now.items()}).of(along.of(contact.slip))
            old = now.get(first + j, changes[j])
            now[first + j] = graph.by_side(system.modes[number], old, old, old - slips)
    return now


def _size(node: Sym) -> Sym:
    """The absolute value, of an expression that no step holds."""
    return node.graph.select(node, node, -node)
