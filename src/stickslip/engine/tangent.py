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

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

from stickslip.basics.errors import InputError, did_you_mean
from stickslip.engine.graphs import Along, Substituted
from stickslip.engine.observed import MEAN
from stickslip.engine.settled_changes import changes_of_landing, settled_changes
from stickslip.engine.symbols import Sym, is_zero
from stickslip.engine.system import System, TracedSwitch
from stickslip.engine.taylor import watched
from stickslip.engine.values import needed_by

#: The number of a case that is the part of the period at which a run ends.
PART = "part of the period"
_NONE: Mapping[str, Sym] = MappingProxyType({})
_NO_JUMP = 1e-9  # of a state's scale in a period: what rounding makes of a rate that does not jump
#: Of a period, by Taylor and by Rosenbrock steps: a guard further from zero than it goes in this time did not fire by itself.
_SAME_INSTANT, _SAME_INSTANT_WITHIN_TOLERANCE = 1e-9, 1e-7


def part_in(name: str) -> str:
    """The name of a direction's part in a number of the case."""
    return f"d {name}"


def tangent(system: System, wrt: Iterable[str] | None = None, integrals: Mapping[str, Sym] = _NONE) -> System:
    """The system with the change of its state along one direction: in its start, and in the numbers named in `wrt` (all, if None).

    Events and states of the system itself stay as they are, to rounding: the changes are passive. A Taylor step is cut where it is too
    long for them (`fitting_change` in ``kernels/arcs.py``).

    Returns
    -------
    System
        Its states are those of the system, then the change of each, that of the way where this is no state, that of each of the
        `integrals` over time of expressions of its graph, and that of the instant of the last event [s]; then the integrals themselves.

    Raises
    ------
    InputError
        For a name that is no number of the system.
    """
    names = _known(system, system.names if wrt is None else tuple(wrt))
    graph, zero = system.graph, system.graph.constant(0.0)
    rows, rates = _rows(system)
    sums = [graph.variable(name) for name in integrals]
    rows, rates = [*rows, *sums], [*rates, *integrals.values()]
    changes = [graph.variable(f"d {y.name}") for y in rows]
    parts = {name: graph.case(part_in(name)) for name in names}
    pace = Along(graph, parts).of(system.period) / system.period
    along = Along(graph, parts | {y.name: S for y, S in zip(rows, changes, strict=True)} | {"t": pace * system.t})
    late = graph.variable("d event")
    slopes = [along.of(f) + pace * f for f in rates]
    instants = [*system.instants, *(instant for instant, _ in system.impulses)]
    given = [along.of(instant) - pace * instant for instant in instants]
    extended = _with_passive(system, [*changes, late, *sums], [*slopes, zero, *integrals.values()])
    switches = {k: _saltation(system, k, rows, rates, changes, late, along) for k in _switching(system)}
    flow = Along(graph, {y.name: f for y, f in zip(rows, rates, strict=True)} | {system.t.name: graph.constant(1.0)})
    held = {system.states + i: along.of(new) + (flow.of(new) - rates[i]) * late for i, new in system.sampled.items()}
    return replace(
        extended,
        names=(*system.names, *map(part_in, names)),
        sampling=(*system.sampling, *(along.of(between) - pace * between for between in system.sampling)),
        sampled=system.sampled | held,
        switches=extended.switches | switches,
        carried=tuple(rates),
        delays=tuple(given),
        kicks=tuple(tuple(map(along.of, jumps)) for _, jumps in system.impulses),
        settled=settled_changes(system, changes, along),
        forgetting=_forgetting(system, along),
    )


def tangent_until(system: System) -> System:
    """The tangent of a run that ends within the period, at a part of it that is a number of the case: `PART`.

    What happens at the instant 0 comes once, before such a run begins, and not at its end.
    """
    graph, T = system.graph, system.period
    part, one = graph.case(PART), graph.constant(1.0)

    def once(instant: Sym) -> Sym:
        return graph.select(one - part, graph.select(instant - _NO_JUMP * T, instant, -T), instant)

    impulses = tuple((once(instant), jumps) for instant, jumps in system.impulses)
    names, instants = (*system.names, PART), tuple(map(once, system.instants))
    return tangent(replace(system, names=names, period=part * T, instants=instants, impulses=impulses))


def tangent_of_means(system: System) -> System:
    """The tangent, with the integrals of `means_of` the system."""
    return tangent(system, integrals=means_of(system))


def means_of(system: System) -> dict[str, Sym]:
    """Quantities averaged over a motion period, by name: friction powers "P.", user-defined "u."; of one body the drive's power "D".

    A user's observable with a condition that is no guard of the system jumps where no step ends, and is none of them.
    """
    signals = [signal for signal in system.signals if signal.kind & MEAN and _ends_steps(system, signal.node)]
    means = {name: signal.node for signal in signals for name in signal.names if name[0] in "Pu"}
    if system.single and system.inertia is not None:
        constant = system.graph.multiply(system.mass, system.free) - system.inertia  # where it is a constant force, such as gravity's
        (power,) = (node for name, node in means.items() if name[0] == "P")
        means["D"] = power - constant * (system.y[0] + system.offset)
    return means


def _ends_steps(system: System, node: Sym) -> bool:
    """Whether all conditions of an expression are those of the system."""
    flags = [each.name for each in needed_by([node]) if each.op == "flag"]
    known = {*(f"b{k}" for k in range(system.signs)), *(f"clk{k}" for k in range(len(system.clocks))), *(m.name for m in system.modes)}
    return known.issuperset(flags)


def with_observables(system: System, observed: dict[str, Sym]) -> System:
    """The system with the integral of some expressions of its own graph over time, from 0 at the start, as passive states."""
    graph = system.graph
    return _with_passive(system, [graph.variable(name) for name in observed], list(observed.values()))


def tangent_and_volume(system: System) -> System:
    """The tangent, by the start alone, with the logarithm of how a volume of starts has grown, by Liouville's formula.

    It knows what no change itself can show: a stiff bristle forgets by e^-1000 in a period. At a switch the volume grows by the determinant
    of D = R_x + u g_x^T / (g_x f- + g_t), u = f+ - R_x f- - R_t.
    """
    graph, (rows, rates), count = system.graph, _rows(system), system.states - system.passive
    extended, volume = tangent(system, ()), graph.variable("volume")
    trace = graph.constant(0.0)
    for y, f in zip(system.y[:count], system.f[:count], strict=True):
        trace = trace + graph.derivative(f, y)
    extended = _with_passive(extended, [volume], [trace])
    switches = dict(extended.switches)
    for k in _switching(system):
        grown = volume + _grown(system, k, _crossing(system, k, rows, rates), count)
        switches[k] = replace(switches[k], states=(*switches[k].states[:-1], grown))
    held = {extended.states - 1: volume + _logarithm(_size(_resampled(system)))} if system.sampled else {}
    return replace(extended, switches=switches, sampled=extended.sampled | held)


def _resampled(system: System) -> Sym:
    """The determinant of what a sample makes of the states of controllers, by what they were."""
    return _determinant([[system.graph.derivative(new, system.y[j]) for j in system.sampled] for new in system.sampled.values()])


def _grown(system: System, k: int, at: _Crossing, count: int) -> Sym:
    """The logarithm of the determinant at a switch; no number where it follows from another one and makes rates jump."""
    graph, guard, one = system.graph, system.guards[k], system.graph.constant(1.0)
    unknown = graph.constant(0.0)
    for i, jump in enumerate(at.jumps[:count]):
        unknown = graph.select(system.period * _size(jump) - _NO_JUMP * _scale(system, i), _logarithm(-one), unknown)
    if all(row is y for row, y in zip(at.rows[:count], system.y, strict=False)) and all(is_zero(jump) for jump in at.jumps[:count]):
        return graph.constant(0.0)
    if is_zero(at.falls):
        return unknown
    slopes = [graph.derivative(guard, y) for y in system.y[:count]]
    reset = [i for i in range(count) if at.rows[i] is not system.y[i]]
    kept = [i for i in range(count) if i not in reset]
    # the border [R_x, u; -g_x^T / fall, 1] without its unit rows and their columns
    R = {(i, j): graph.derivative(at.rows[i], system.y[j]) for i in reset for j in range(count)}
    border = [[R[i, j] for j in reset] + [_less(at.jumps[i], [R[i, j] * at.jumps[j] for j in kept])] for i in reset]
    corner = _less(one, [-(slopes[j] * at.jumps[j] / at.falls) for j in kept])
    grown = _determinant([*border, [*(-(slopes[j] / at.falls) for j in reset), corner]])
    return graph.select(_follows(system, guard, at.falls), unknown, _logarithm(_size(grown)))


def has_corners(system: System) -> bool:
    """Whether rates or states jump where a guard falls to zero, so that a derivative may be another one on its other side."""
    rows, rates = _rows(system)
    for k in _switching(system):
        at = _crossing(system, k, rows, rates)
        if any(new is not old for new, old in zip(at.rows, rows, strict=True)) or not all(map(is_zero, at.jumps)):
            return True
    return False


def _logarithm(node: Sym) -> Sym:
    """Also of a constant that has none, as what is computed then has to show."""
    return node.graph._node("log", (node,))


def _scale(system: System, i: int) -> Sym:
    """The scale of a state or, if unknown, the state itself."""
    scale = system.velocity_scale if i < system.coordinates else system.scales[i]
    return _size(system.y[i]) if scale is None else scale


def _less(whole: Sym, parts: list[Sym]) -> Sym:
    for part in parts:
        whole = whole - part
    return whole


def _determinant(rows: list[list[Sym]]) -> Sym:
    """Of a small matrix, by its first row."""
    first, *others = rows
    if not others:
        return first[0]
    total = first[0].graph.constant(0.0)
    for j, value in enumerate(first):
        if not is_zero(value):
            minor = _determinant([row[:j] + row[j + 1 :] for row in others])
            total = total + value * minor if j % 2 == 0 else total - value * minor
    return total


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
    """The quantities that change: the states, and the distance travelled if it is not one of them; with their rates."""
    count = system.states - system.passive
    rows, rates = list(system.y[:count]), list(system.f[:count])
    if system.cyclic:
        rows.append(system.graph.variable("way"))
        rates.append(system.y[0] + system.offset)
    return rows, rates


def _switching(system: System) -> list[int]:
    """The guards at which something changes and the run goes on."""
    watching = range(len(system.guards)) if system.stiff else watched(system)
    return [k for k in watching if k not in system.switches or not system.switches[k].status]


@dataclass(frozen=True)
class _Crossing:
    """The crossing of a guard: new rows, the jumps of the old rates, and the rate at which the guard falls."""

    rows: list[Sym]  # the states after it, and the way
    jumps: list[Sym]  # f+ - R_x f- - R_t
    falls: Sym


def _crossing(system: System, k: int, rows: list[Sym], rates: list[Sym]) -> _Crossing:
    graph, guard, count = system.graph, system.guards[k], system.states - system.passive
    old = system.switches.get(k, TracedSwitch(system.modes, (None,) * system.states))
    changed = {mode.name: new for mode, new in zip(system.modes, old.modes, strict=True) if new is not mode}
    if k < system.signs:
        changed[f"b{k}"] = -graph.mode(f"b{k}")
    changed |= {y.name: new for y, new in zip(system.y, old.states, strict=True) if new is not None}
    new_rows = [*(y if new is None else new for y, new in zip(system.y[:count], old.states, strict=False)), *rows[count:]]
    flow = Along(graph, {y.name: f for y, f in zip(rows, rates, strict=True)} | {system.t.name: graph.constant(1.0)})
    after, zero = Substituted(graph, changed), graph.constant(0.0)
    there = Substituted(graph, {guard.name: zero} if guard.op == "variable" else {})
    jumps, falls, thrown = [], flow.of(guard), _is_thrown(system, guard)
    for row, rate in zip(new_rows, rates, strict=True):
        then, before = after.of(rate), flow.of(row)
        jump = then - before
        if there.of(then) is there.of(before):  # such as of what knows abs(v), at v = 0; not where a hit has turned v over
            jump = graph.select(_follows(system, guard, falls), jump, zero) if thrown and not is_zero(jump) else zero
        jumps.append(jump)
    return _Crossing(new_rows, jumps, falls)


def _is_thrown(system: System, guard: Sym) -> bool:
    """Whether a switch may take a guard that is a state beyond zero, so that it fires although it has not fallen there."""
    i = next((i for i, y in enumerate(system.y) if y is guard), None)
    return i is not None and any(switch.states[i] is not None for switch in system.switches.values())


def _saltation(system: System, k: int, rows: list[Sym], rates: list[Sym], changes: list[Sym], late: Sym, along: Along) -> TracedSwitch:
    """The switch of a guard with what it does to the changes."""
    old = system.switches.get(k, TracedSwitch(system.modes, (None,) * system.states))
    at = _crossing(system, k, rows, rates)
    tau = _later(system, system.guards[k], at.falls, along.of(system.guards[k]), late)
    moved = [along.of(row) - jump * tau for row, jump in zip(at.rows, at.jumps, strict=True)]
    states = {y.name: row for y, row in zip(system.y, at.rows, strict=False)} | {
        f"d {y.name}": S for y, S in zip(system.y, moved, strict=False)
    }
    landed = changes_of_landing(system, k, states, old.modes, along)
    moved = [landed.get(f"d {y.name}", S) for y, S in zip(rows, moved, strict=False)]
    new = [None if after is S else after for after, S in zip(moved, changes, strict=True)]
    kept = (None,) * (len(rows) - len(_rows(system)[0]))  # integrals go on
    return TracedSwitch(old.modes, (*old.states, *new, tau, *kept), old.status)


def _later(system: System, guard: Sym, falls: Sym, moved: Sym, late: Sym) -> Sym:
    """By how much later a guard fires: by itself, or as what follows from the last event, in the same instant."""
    if is_zero(falls):  # nothing but a jump makes it fire
        return late
    return system.graph.select(_follows(system, guard, falls), late, -(moved / falls))


def _follows(system: System, guard: Sym, falls: Sym) -> Sym:
    """Positive where a guard is too far from zero to have fallen there by itself."""
    near = _SAME_INSTANT_WITHIN_TOLERANCE if system.stiff else _SAME_INSTANT
    return _size(guard) - near * (system.period * _size(falls))


def _forgetting(system: System, along: Along) -> dict[int, Sym]:
    """Changes after the law of one contact loses its memory because an impulse has reversed the velocity."""
    resets = system.switches[0].states if system.dynamic and 0 in system.switches else ()
    return {system.states + i: along.of(new) for i, new in enumerate(resets) if new is not None}


def _size(node: Sym) -> Sym:
    """The absolute value, of an expression that no step holds."""
    return node.graph.select(node, node, -node)
