"""A system whose run ends where it has come back to a section so many times: a sum of its states, with weights, rises through a value.

The weights, the value and the number of returns are numbers of the case, so one kernel serves all sections, a lane for each start. A run
that begins on the section, or beyond it, has to fall below it first: what it begins with is no return. The section changes nothing else
of the system.
"""

from __future__ import annotations

from dataclasses import replace

from stickslip.basics.status import Status
from stickslip.engine.system import System, TracedSwitch

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
