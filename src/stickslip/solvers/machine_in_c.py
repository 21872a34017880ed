"""A machine as C that steps by itself: its text, and what a user may set and read of it (`stickslip.export_fmu`)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stickslip.basics.contracts import Model
from stickslip.basics.errors import InputError, Problems, did_you_mean
from stickslip.basics.fields import leaves
from stickslip.engine import trace
from stickslip.engine.c_interface import interface
from stickslip.engine.c_quantities import Quantity, quantities_of
from stickslip.engine.law_checks import check_numbers
from stickslip.engine.plain_kernels import plain_kernel
from stickslip.engine.taylor import watched
from stickslip.engine.values import needed_by
from stickslip.models.machine_adapter import machine_of
from stickslip.models.model_adapter import adapter_of, is_model
from stickslip.models.pushed import force_names, pushed
from stickslip.solvers.held_bodies import check_one_machine, request_of_one
from stickslip.solvers.methods import method_for
from stickslip.solvers.moments import AHEAD
from stickslip.solvers.stepping import budget_of

FIXED, TUNABLE, INPUT = range(3)  # what a number may do: change before a run, between steps, or as an input


@dataclass(frozen=True)
class Number:
    """A number of the machine, or a force on one of its bodies.

    Parameters
    ----------
    name : str
    field : str
        Its dotted name in the machine; empty for a force.
    value : float
    role : int
        FIXED, TUNABLE or INPUT.
    """

    name: str
    field: str
    value: float
    role: int


@dataclass(frozen=True)
class MachineInC:
    """A machine as C.

    Parameters
    ----------
    text : str
        Type, constants and functions (`stickslip.engine.c_interface`).
    numbers : tuple of Number
        In the order in which C has them.
    states, outputs : tuple of Quantity
    begin : tuple of float
        The states at the start.
    memories : tuple of float
        What laws remember at the start.
    contacts : tuple of str
    indicators : int
        How many guards there are.
    period, span : float
        Period [s], 0 if there is none; and how long a run is taken to be that has none.
    settings : dict
        Constants that C needs besides, by name.
    tables : dict
        The same for tables of numbers.
    method : str
        "exact", or the name of the steps of a dynamic law.
    """

    text: str
    numbers: tuple[Number, ...]
    states: tuple[Quantity, ...]
    outputs: tuple[Quantity, ...]
    begin: tuple[float, ...]
    memories: tuple[float, ...]
    contacts: tuple[str, ...]
    indicators: int
    period: float
    span: float
    settings: dict[str, Any]
    tables: dict[str, Any]
    method: str


def machine_in_c(
    machine: Model, inputs: Sequence[str] | None, outputs: Sequence[str] | None, start: Any, rtol: float, method: str, who: str
) -> MachineInC:
    """The C of one machine.

    Parameters
    ----------
    machine : Robot or machine
    inputs : sequence of str, optional
        Names of numbers, and of forces as `stickslip.simulation` has them; if not given, the forces.
    outputs : sequence of str, optional
        All if not given.
    start, rtol, method
        As for `simulation`.
    who : str
        The function that reports errors.

    Examples
    --------
    >>> import stickslip as ss
    >>> belt = ss.BlockOnBelt(mass=2.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0))
    >>> made = machine_in_c(belt, ["speed"], None, None, 1e-6, "auto", "export_fmu")
    >>> [number.name for number in made.numbers if number.role == INPUT], made.method
    (['speed'], 'exact')
    """
    _refuse_flows(machine, who)
    check_one_machine(machine, who)
    forces = force_names(machine)
    by_number = {number: name for name, number in reversed(forces.items())}  # the shortest name of each comes first there
    asked = _asked_inputs(machine, inputs, forces, by_number, who)
    try:
        todo = request_of_one(machine, start, rtol, method)
        is_pushed = any(name in forces for name in asked)
        model = pushed(machine) if is_pushed else machine
        _check_compiles(machine, todo.machine.laws, who)
        method_for(todo.method, machine, pauses=True)  # which names the machine where none does
        chosen: Any = method_for(todo.method, model, pauses=True)
        tableau, tolerance = chosen.steps(replace(todo, model=model))
        check_numbers(model)
        eq = trace.trace(model)
        kernel = plain_kernel(eq, tableau)
    except InputError as error:
        raise InputError(who, error.problems) from None
    eq, read = kernel.eq, quantities_of(model, kernel.eq)
    shown = _asked_outputs(outputs, list(read.outputs), who)
    unit = todo.machine.time_scale
    span = AHEAD * float(unit) if unit is not None and 0.0 < float(unit) < math.inf else AHEAD
    numbers = _numbers(model, eq, is_pushed, forces, by_number, asked, span, who)
    stops = list(getattr(machine_of(model).mechanics, "stops", ()))
    return MachineInC(
        text=interface(kernel, read, [read.outputs[name] for name in shown]),
        numbers=numbers,
        states=read.states,
        outputs=tuple(read.outputs[name] for name in shown),
        begin=_begin(eq, todo.start[0], sum(todo.machine.mechanics.inner)),
        memories=tuple(float(each) for each in todo.start[0][2 * eq.coordinates + sum(todo.machine.mechanics.inner) :]),
        contacts=tuple(contact.name for contact in eq.contacts),
        indicators=len(watched(eq)),
        period=0.0 if machine.period is None else float(machine.period),
        span=span,
        settings={
            "APERIODIC": int(machine.period is None), "WAY_STATE": int(eq.cyclic), "FIRST_POSITION": eq.states - eq.coordinates,
            "CARRIED": int(eq.cyclic and not todo.machine.has_inner_states), "STOPS": len(stops), "TOLERANCE": float(tolerance),
            "BUDGET": float(budget_of(model, 1, machine_of(model))),
            "SPAN_AT": eq.names.index(trace.SPAN) if trace.SPAN in eq.names else -1,
        },
        tables=_tables(kernel.layout, eq, stops),
        method="exact" if tableau is None else tableau.name,
    )  # fmt: skip


def _refuse_flows(machine: Any, who: str) -> None:
    """`InputError` for a flow, whose steps are made from rates and switches of its own."""
    if is_model(machine) and not adapter_of(machine).has_bodies:
        why = "the C steps bodies on contacts, and a flow has rates, switches and resets of its own in their place"
        how = "write it as a machine of Body, Contact and Spring (docs/your-own-machine.md), or step it in Python: type ss.simulation(flow)"
        raise InputError(who, [f"{machine!r} is a SwitchingFlow, which cannot be exported: {why}; {how}"])


def _check_compiles(machine: Any, laws: Sequence[Any], who: str) -> None:
    """`InputError` for laws that are plain Python and nothing else: their equations cannot be written down."""
    plain = sorted({law.name for law in laws if not law.compiles})
    if plain:
        what = f"the {type(machine).__name__} has {' and '.join(plain)} friction, which is random or solved in plain Python alone"
        allowed = "allowed are laws that compile"
        raise InputError(who, [f"{what}; {allowed}; type for example machine.replace(friction=ss.GMS.example())"])


def _asked_inputs(machine: Any, inputs: Any, forces: dict[str, str], by_number: dict[str, str], who: str) -> list[str]:
    """The names of the inputs; `InputError` for one that is not known."""
    if inputs is None:
        return list(dict.fromkeys(by_number.values()))
    if isinstance(inputs, str) or not all(isinstance(name, str) for name in inputs):
        raise InputError(who, [f'inputs = {inputs!r}; allowed are names; type for example inputs=["{next(iter(forces))}"]'])
    known, problems = [*forces, *(name for name, _ in leaves(machine))], Problems(who)
    for name in inputs:
        if name not in known:
            problems.add(f"there is no input {name!r}; {did_you_mean(name, known)}; type ss.simulation(machine).inputs for all of them")
    problems.check()
    return list(dict.fromkeys(inputs))


def _asked_outputs(outputs: Any, known: list[str], who: str) -> list[str]:
    if outputs is None:
        return known
    problems = Problems(who)
    if isinstance(outputs, str):
        raise InputError(who, [f'outputs = {outputs!r}; allowed are names in a list; type outputs=["{outputs}"]'])
    for name in outputs:
        if name not in known:
            problems.add(f"there is no output {name!r}; {did_you_mean(str(name), known)}; leave outputs out for all of them")
    problems.check()
    return list(dict.fromkeys(outputs))


def _numbers(
    model: Any, eq: Any, is_pushed: bool, forces: dict[str, str], by_number: dict[str, str], asked: list[str], span: float, who: str
) -> tuple[Number, ...]:
    """The numbers in the order of the equations, each with what it may do."""
    values = {name: float(value) for name, value in leaves(model)} | {trace.SPAN: span}
    rigid = {node.name for node in needed_by([eq.period, *eq.sampling]) if node.op == "case"}
    wanted, numbers = {forces.get(name, name) for name in asked}, list[Number]()
    for number in eq.names:
        own = number.removeprefix("machine.") if is_pushed else number
        is_force = is_pushed and number in by_number
        name = next((each for each in asked if forces.get(each) == number), by_number[number]) if is_force else own
        role = INPUT if own in wanted else FIXED if number in rigid else TUNABLE
        if role == INPUT and number in rigid:
            what = f"input {name!r} sets the period of the machine, or the time between samples"
            raise InputError(
                who, [f"{what}; allowed are numbers that leave it; leave it out: it is a parameter that is fixed at the start"]
            )
        numbers.append(Number(name, "" if is_force or number == trace.SPAN else own, values[number], role))
    gone = [name for name in asked if name not in {number.name for number in numbers}]
    if gone:
        raise InputError(who, [f"input {gone[0]!r} is written out in the equations, as an exponent is; leave it out"])
    return tuple(numbers)


def _begin(eq: Any, start: Any, inner: int) -> tuple[float, ...]:
    """The states at the start, as C has them: positions are differences to the first where no equation needs that."""
    n = eq.coordinates
    q, u, z = start[:n], start[n : 2 * n], start[2 * n : 2 * n + inner]
    states = [*q[:1], *u, *z, *(q[1:] - q[0])] if eq.cyclic else [*u, *z, *q]
    return tuple(float(np.asarray(each)) for each in states)


def _tables(at: dict[str, int], eq: Any, stops: list[Any]) -> dict[str, Any]:
    """Where C has the side of each contact and its flight, whose memories are whose, and what slips and gaps take of velocities."""
    sides = [at["F_B"] + (c.guard or 0) if c.branches is None else at["F_MODE"] + c.modes[0] for c in eq.contacts]
    memory_of = [-1] * eq.memories
    for i, contact in enumerate(eq.contacts):
        for k in contact.modes if contact.branches is None else ():
            if k < eq.memories:
                memory_of[k] = i
    return {
        "SIDE_PLACES": sides,
        "FLIGHT_PLACES": [-1 if c.flight is None else at["F_MODE"] + c.flight.mode for c in eq.contacts],
        "FLIGHT_STATES": [-1 if c.flight is None else c.flight.inner[1] for c in eq.contacts],
        "MEMORY_OF": memory_of,
        "SLIP_ROWS": [tuple(c.direction) for c in eq.contacts],
        "STOP_ROWS": [tuple(stop.direction) for stop in stops],
    }
