"""A system seen in a mirror, and a system whose time begins elsewhere in the period: each a new system in a graph of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, is_dataclass, replace
from typing import Any

from stickslip.engine.graphs import Copied
from stickslip.engine.symbols import Graph, Sym
from stickslip.engine.system import Branches, System, TracedSwitch
from stickslip.engine.trace import instants_of


def mirrored(system: System) -> System:
    """The machine seen in a mirror: velocities, positions, inner states and forces change their signs, and forwards is backwards.

    A run of it from the mirrored start is the mirrored run. Whole numbers that laws remember stay what they are.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.engine.trace import trace
    >>> robot = trace(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb"))
    >>> mirrored(robot).f[0] is robot.f[0], mirrored(robot).names == robot.names
    (False, True)
    """
    graph, sided = Graph(), {k for contact in system.contacts if contact.branches is not None for k in contact.modes}
    slips = {contact.guard for contact in system.contacts if contact.branches is None} | ({0} if system.single else set())
    turned = {y.name: -graph.variable(y.name) for y in system.y} | {system.modes[k].name: -graph.mode(system.modes[k].name) for k in sided}
    turned |= {f"b{k}": -graph.mode(f"b{k}") for k in slips if k is not None}
    copied = Copied(graph, turned)
    image: System = _mapped(system, copied.of)
    guards = tuple(-guard if k in slips else guard for k, guard in enumerate(image.guards))
    graph.guards, graph.clocks = list(guards[: system.signs]), list(image.clocks)

    def modes(new: tuple[Sym, ...]) -> tuple[Sym, ...]:
        return tuple(-mode if k in sided else mode for k, mode in enumerate(new))

    def back(values: Any) -> Any:
        return tuple(None if value is None else -value for value in values)

    return replace(
        image,
        graph=graph, y=tuple(graph.variable(y.name) for y in system.y), modes=tuple(graph.mode(mode.name) for mode in system.modes),
        f=back(image.f), offsets=back(image.offsets), guards=guards, first_modes=modes(image.first_modes),
        contacts=tuple(replace(c, slip=-c.slip, branches=_other_way(c.branches)) for c in image.contacts),
        free=-image.free, inertia=None if image.inertia is None else -image.inertia,
        offered=None if image.offered is None else -image.offered,
        switches={k: TracedSwitch(modes(switch.modes), back(switch.states), switch.status) for k, switch in image.switches.items()},
        impulses=tuple((instant, back(jumps)) for instant, jumps in image.impulses),
    )  # fmt: skip


def _other_way(branches: Branches | None) -> Branches | None:
    """Forwards and backwards in each other's place."""
    return branches and Branches(-branches.backwards, -branches.forwards, branches.pull, branches.push)


def shifted(system: System, phase: float) -> System:
    """The system whose time begins at a part of the period: what it does at t the other one does at t + phase T.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.engine.trace import trace
    >>> robot = trace(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb"))
    >>> len(robot.clocks), len(shifted(robot, 0.25).clocks)  # one more: where the period of the robot ends
    (0, 1)
    """
    graph = Graph()
    numbers, t = Copied(graph, {}), graph.variable(system.t.name)
    period = numbers.of(system.period)
    begin = (phase % 1.0) * period
    later = graph.select(graph.sign(period - begin - t), t + begin, t + begin - period)
    delayed: System = _mapped(system, Copied(graph, {system.t.name: later} | _renamed(system, graph)).of)
    graph.guards, graph.clocks = list(delayed.guards[: system.signs]), [*graph.clocks, *delayed.clocks]

    def wrapped(instant: Sym) -> Sym:
        early = instant - begin
        return graph.select(-early, early + period, early)

    return replace(
        delayed,
        graph=graph, t=t, clocks=tuple(graph.clocks), period=period,
        instants=tuple(instant for clock in graph.clocks for instant in instants_of(graph, clock, t)),
        impulses=tuple((wrapped(instant), jumps) for instant, jumps in delayed.impulses),
    )  # fmt: skip


def _renamed(system: System, graph: Graph) -> dict[str, Sym]:
    """The clocks' flags by their new numbers: the first clock is where the period of the other system ends."""
    return {f"clk{k}": graph.mode(f"clk{k + 1}") for k in range(len(system.clocks))}


def _mapped(value: Any, of: Callable[[Sym], Sym]) -> Any:
    """The same record of other expressions."""
    if isinstance(value, Sym):
        return of(value)
    if isinstance(value, tuple):
        return tuple(_mapped(each, of) for each in value)
    if isinstance(value, dict):
        return {key: _mapped(each, of) for key, each in value.items()}
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{f.name: _mapped(getattr(value, f.name), of) for f in fields(value)})  # type: ignore[type-var]
    return value
