"""A system whose run ends where it has come back to a section so many times: a sum of its states, with weights, rises through a value.

The weights, the value and the number of returns are numbers of the case, so one kernel serves all sections, a lane for each start. A run
that begins on the section, or beyond it, has to fall below it first: what it begins with is no return. The section changes nothing else
of the system.

Another section is a switch of a contact that rests exactly: it sticks, or slips; or a switch of a flow, from some of its modes to others.
The states there are those after the switch.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

from stickslip.basics.status import Status
from stickslip.engine.symbols import Sym
from stickslip.engine.system import System, TracedSwitch

_AT_ONCE = 1e-12  # of the longest time of a run: a switch before is one with which it begins

#: The numbers of a case that are the value on the section, and after how many returns its run ends.
VALUE, RETURNS = "section value", "section returns"


def weight_of(number: int) -> str:
    """The name of the number of a case that is the weight of a state on the section."""
    return f"section weight {number}"


def until_section(system: System) -> System:
    """The system with a section at which a run ends, with the status `Status.RETURNED`.

    A mode says whether the run has been below the section since its start or its last return, and another counts returns.

    Examples
    --------
    >>> from stickslip.engine.trace import trace
    >>> from stickslip.models.friction import Coulomb
    >>> from stickslip.models.machines.block_on_belt import BlockOnBelt
    >>> belt = trace(BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=Coulomb(1.0, 1.0)))
    >>> cut = until_section(belt)
    >>> len(cut.guards) - len(belt.guards), cut.names[-2:]
    (3, ('section value', 'section returns'))
    """
    graph = system.graph
    one, zero = graph.constant(1.0), graph.constant(0.0)
    weights = [graph.case(weight_of(i)) for i in range(system.states)]
    beyond = -graph.case(VALUE)
    for weight, y in zip(weights, system.y, strict=True):
        beyond = beyond + weight * y
    below, count = (graph.mode(f"mode{len(system.modes) + k}") for k in range(2))
    same, first = (None,) * system.states, len(system.guards)
    extended = {k: replace(switch, modes=(*switch.modes, below, count)) for k, switch in system.switches.items()}
    return replace(
        system,
        names=(*system.names, *(weight.name for weight in weights), VALUE, RETURNS),
        guards=(
            *system.guards,
            graph.select(below, one, beyond),
            graph.select(below, -beyond, one),
            graph.case(RETURNS) - graph.constant(0.5) - count,
        ),
        modes=(*system.modes, below, count),
        first_modes=(*system.first_modes, zero, zero),
        switches=extended
        | {
            first: TracedSwitch((*system.modes, one, count), same),
            first + 1: TracedSwitch((*system.modes, zero, count + one), same),
            first + 2: TracedSwitch((*system.modes, below, count), same, Status.RETURNED),
        },
    )


def switch_of(number: int, kind: str) -> str:
    """The name of the number of a case that is 1 where a contact's switch is the section: "stick" or "slip"."""
    return f"section {kind} of contact {number}"


def until_switch(system: System) -> System:
    """The system whose run ends where contacts have come to rest, or broken away, so many times, with the status `Status.RETURNED`.

    Which contact's switches count are numbers of the case. What a run begins with is no return: a mode says whether the contact has come
    to rest since the start, or, where it is looked at as it sticks, rests there. So starts beside the section return as those on it do.

    Examples
    --------
    >>> from stickslip.engine.trace import trace
    >>> from stickslip.models.friction import Coulomb
    >>> from stickslip.models.machines.block_on_belt import BlockOnBelt
    >>> belt = trace(BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=Coulomb(1.0, 1.0)))
    >>> until_switch(belt).names[-3:]
    ('section stick of contact 0', 'section slip of contact 0', 'section returns')
    """
    graph, n = system.graph, len(system.modes)
    one, zero = graph.constant(1.0), graph.constant(0.0)
    resting = {i: contact.modes[0] for i, contact in enumerate(system.contacts) if contact.branches is not None}
    counted = {i: (graph.case(switch_of(i, "stick")), graph.case(switch_of(i, "slip"))) for i in resting}
    rested, count = (graph.mode(f"mode{n + k}") for k in range(2))

    def at_rest(mode: Sym) -> Sym:
        return graph.select(mode * mode - graph.constant(0.25), zero, one)

    def extended(switch: TracedSwitch) -> TracedSwitch:
        known, total = rested, count
        for i, index in resting.items():
            before, after = at_rest(system.modes[index]), at_rest(switch.modes[index])
            sticks, slips = (one - before) * after, before * (one - after)
            stick, slip = counted[i]
            total = total + (stick * sticks + slip * slips) * rested
            known = graph.select((stick + slip) * sticks - graph.constant(0.5), one, known)
        return replace(switch, modes=(*switch.modes, known, total))

    begins = zero
    for i, index in resting.items():
        begins = begins + counted[i][0] * at_rest(system.first_modes[index])
    last = TracedSwitch((*system.modes, rested, count), (None,) * system.states, Status.RETURNED)
    return replace(
        system,
        names=(*system.names, *(weight.name for pair in counted.values() for weight in pair), RETURNS),
        guards=(*system.guards, graph.case(RETURNS) - graph.constant(0.5) - count),
        modes=(*system.modes, rested, count),
        first_modes=(*system.first_modes, begins, zero),
        switches={k: extended(switch) for k, switch in system.switches.items()} | {len(system.guards): last},
    )


def passes_of(number: int, which: str) -> str:
    """The name of the number of a case that is 1 where switches "from" a flow's mode count, or "to" it."""
    return f"section {which} mode {number}"


@cache
def until_mode_change(count: int) -> Callable[[System], System]:
    """What makes of a flow with so many modes one that ends where it has switched so many times from some of its modes to some others.

    Which modes are numbers of the case. A switch with which a run begins is no return.

    Examples
    --------
    >>> from stickslip.engine.flow_system import flow_system
    >>> from stickslip.models.switching_flow import Switch, SwitchingFlow
    >>> ball = SwitchingFlow({0: lambda t, y: (y[1], -9.81)}, {0: (Switch(lambda t, y: y[0], 0, lambda t, y: (0.0, -y[1])),)})
    >>> until_mode_change(1)(flow_system(ball, 2).system).names[-3:]
    ('section from mode 0', 'section to mode 0', 'section returns')
    """

    def made(system: System) -> System:
        graph, n = system.graph, len(system.modes)
        one, zero, half = graph.constant(1.0), graph.constant(0.0), graph.constant(0.5)
        weights = {which: [graph.case(passes_of(k, which)) for k in range(count)] for which in ("from", "to")}
        returns = graph.mode(f"mode{n}")
        later = graph.select(system.t - graph.constant(_AT_ONCE) * system.period, one, zero)

        def counts(which: str, number: Sym) -> Sym:
            value = weights[which][0]
            for k in range(1, count):
                value = graph.select(number - graph.constant(k + 0.5), weights[which][k], value)
            return value

        def extended(switch: TracedSwitch) -> TracedSwitch:
            if switch.modes[1] is system.modes[1]:  # it only remembers something
                return replace(switch, modes=(*switch.modes, returns))
            passed = counts("from", system.modes[0]) * counts("to", switch.modes[0])
            return replace(switch, modes=(*switch.modes, returns + later * passed))

        last = TracedSwitch((*system.modes, returns), (None,) * system.states, Status.RETURNED)
        return replace(
            system,
            names=(*system.names, *(weight.name for each in weights.values() for weight in each), RETURNS),
            guards=(*system.guards, graph.case(RETURNS) - half - returns),
            modes=(*system.modes, returns),
            first_modes=(*system.first_modes, zero),
            switches={k: extended(switch) for k, switch in system.switches.items()} | {len(system.guards): last},
        )

    return made
