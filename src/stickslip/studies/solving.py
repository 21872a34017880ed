"""From a tile to its columns: solve its groups, mark unsolvable cases, continue."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.analysis.motion import coulomb_twin
from stickslip.basics.batch import cases_of, numbers_by_name, shape_of, some_of
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.basics.pool import handed_out
from stickslip.basics.status import Status
from stickslip.basics.variables import VARIABLES
from stickslip.engine.closed_arc_conditions import steady_force
from stickslip.models.friction.law_adapter import law_of
from stickslip.models.machine_adapter import MachineAdapter, machine_of
from stickslip.models.model_adapter import adapter_of
from stickslip.models.observables import by_time_of_computation
from stickslip.results.part_notes import notes_of_cases
from stickslip.solvers import coulomb_steady_motions as orbits, events_of_cases, part_results as parts, solved as solved_as_asked
from stickslip.solvers.closed_arcs import dimensionless_arcs, handles
from stickslip.solvers.methods import takes_closed_arcs
from stickslip.solvers.named_events import lacking_columns
from stickslip.solvers.request import request
from stickslip.solvers.settings import Settings
from stickslip.studies.model_identity import ModelIdentities
from stickslip.studies.models_of_points import Group, groups_of_points, starts_at
from stickslip.studies.planning import Plan, one_start, settings_of
from stickslip.studies.result_columns import COLUMNS, END, concatenated, empty, flattened, unknown, with_missing_cases
from stickslip.studies.self_excited import OF_CYCLES, flow_motion_columns, motion_columns, settled_after

ALPHAS = ("alpha_plus", "alpha_minus")
#: Columns that exist only for machines of one body on one contact.
OF_ONE = ("drive_power", "cost_of_transport", *ALPHAS)
_OTHER_PARTS = "its bodies, contacts or stops are not those of the first machine: only what is of the whole machine is kept"
Tell = Callable[[int], None]  # called with the number of cases begun
Solver = Callable[[Any, dict[str, Any], dict[str, Any], int, Any], tuple[Any, dict[str, Array]]]


_OURS = (MemoryError, OSError)  # errors that do not concern a single case


def solved(plan: Plan, k: int, workers: int = 1, tell: Tell | None = None) -> tuple[dict[str, Array], dict[str, int]]:
    """The columns of tile k in the order of its results; and error messages with the number of cases that they concern."""
    return solved_models(plan, k, workers, tell, None)[:2]


def solved_models(
    plan: Plan, k: int, workers: int, tell: Tell | None, identities: ModelIdentities | None
) -> tuple[dict[str, Array], dict[str, int], str]:
    """The same, with the identity of the models that were solved, or "" without `identities`."""
    if plan.along is not None:
        from stickslip.studies.following import columns_along

        return *columns_along(plan, k, workers, tell), identities.of_tiles([k])[0] if identities else ""
    points = plan.points(k)
    made = identities.made(k) if identities else groups_of_points(plan.make, plan.space, points, starts_at(plan.start, points))
    if identities is None or identities.every > 1:
        models = identities.of_tiles([k])[0] if identities else ""
    else:
        models = identities.of_groups(made[0], [len(points)])[0]
    return *_solved_groups(plan, points, made, workers, tell), models


def solved_points(
    plan: Plan, points: Array, start: dict[str, Any], workers: int = 1, tell: Tell | None = None
) -> tuple[dict[str, Array], Counter[str]]:
    """The columns at some points of the space."""
    return _solved_groups(plan, points, groups_of_points(plan.make, plan.space, points, start), workers, tell)


def _solved_groups(
    plan: Plan, points: Array, made: tuple[list[Group], dict[int, str]], workers: int, tell: Tell | None
) -> tuple[dict[str, Array], Counter[str]]:
    """The columns of the models that were made for some points."""
    groups, refused = made
    notes, before = Counter(refused.values()), 0

    def columns_of_one(group: Group) -> dict[str, Array]:
        def begun(count: int, whole: int) -> None:
            if tell is not None:
                tell(before + count)

        columns = columns_of_group(group, plan.options, workers, begun, notes)
        if adapter_of(group.robot).part_names == plan.parts:
            return columns
        notes[_OTHER_PARTS] += len(group.at)
        whole = {name for name in COLUMNS if not VARIABLES[name].dims} | set(plan.observed)
        return {name: values for name, values in columns.items() if name in whole}

    if len(groups) == 1 and not refused:  # all points, in their order
        return with_missing_cases(columns_of_one(groups[0]), len(points), plan.columns), notes
    result = empty(len(points), plan.columns)
    result["status"][list(refused)] = Status.BAD_INPUT
    for group in groups:
        for name, values in columns_of_one(group).items():
            result[name][group.at] = values
        before += len(group.at)
    return result, notes


def kept_columns(plan: Plan) -> tuple[str, ...]:
    """The columns that apply to the robots of a plan."""
    if plan.own:
        return plan.columns
    machine = None if plan.sample is None else machine_of(plan.sample)
    cycles = settled_after("sweep", plan.sample, plan.options["settle"], plan.options["duration"]) is not None
    without = {*plan.space.columns, *plan.space.dims, *(() if cycles else OF_CYCLES), *columns_not_of(machine)}
    without |= set() if plan.sample is not None and _alphas(plan.sample, without) else set(ALPHAS)
    return (*(name for name in COLUMNS if name not in without), *plan.observed)


def columns_not_of(machine: MachineAdapter | None) -> set[str]:
    """Columns that do not apply to a machine; None counts as a robot."""
    if machine is None or not machine.names_parts:
        return {*parts.OF_SEVERAL, "friction_power"}
    dims = {*machine.part_names, *machine.own}
    lacking = {name for name in COLUMNS if VARIABLES[name].dims and VARIABLES[name].dims[0] not in dims}  # such as those of stops
    return {*OF_ONE, *parts.left_out(machine), *lacking}


def columns_of_group(
    group: Group, options: dict[str, Any], workers: int, tell: Any, notes: Counter[str], solver: Solver | None = None
) -> dict[str, Array]:
    """The columns of a group; if it fails as a whole, it is split in halves until the failing cases are isolated."""
    try:
        columns = columns_of(group.robot, group.start, options, workers, tell, solver, notes)
        return {
            name: values if len(values) == len(group.at) else np.repeat(values, len(group.at), axis=0) for name, values in columns.items()
        }
    except _OURS:
        raise
    except Exception as error:
        sentence = _sentence(error)
        if len(group.at) == 1 or _fails_at_both_ends(group, options, sentence, solver):
            notes[sentence] += len(group.at)
            return {"status": np.full(len(group.at), Status.FAILED, COLUMNS["status"])}
    return concatenated(
        [
            columns_of_group(part, options, workers, tell, notes, solver)
            for part in _parts(group, *np.array_split(np.arange(len(group.at)), 2))
        ]
    )


def _sentence(error: Exception) -> str:
    return error.problems[0] if isinstance(error, InputError) else f"{type(error).__name__}: {error}"


def _fails_at_both_ends(group: Group, options: dict[str, Any], sentence: str, solver: Solver | None) -> bool:
    """Whether the first and the last case fail by themselves with the same message: then the law is wrong, rather than some numbers."""
    for part in _parts(group, np.array([0]), np.array([-1])):
        try:
            columns_of(part.robot, part.start, options, 1, None, solver)
            return False
        except _OURS:
            raise
        except Exception as error:
            if _sentence(error) != sentence:
                return False
    return True


def _parts(group: Group, *places: Array) -> list[Group]:
    """Groups of some cases of a group."""
    return [Group(group.at[at], some_of(group.robot, at), starts_at(group.start, at)) for at in places]


def columns_of(
    robot: Model,
    start: dict[str, Any],
    options: dict[str, Any],
    workers: int,
    tell: Any,
    solver: Solver | None = None,
    notes: Counter[str] | None = None,
) -> dict[str, Array]:
    """The columns of a batch, or of one robot; and the final states of its cases, if the solver returns them.

    Notes on the cases are counted in `notes`.
    """
    count = max([1, *shape_of(robot), *(len(v) for v in start.values() if np.ndim(v))])
    settle, events = settled_after("sweep", robot, options["settle"], options["duration"]), options.get("events")
    options = options if settle is None else {**options, "settle": "auto", "events": None}
    if adapter_of(robot).numbers_by_case:
        return _case_by_case(robot, start, {**options, "events": events}, settle, workers, count)
    if not shape_of(robot) and any(np.ndim(v) for v in start.values()):  # one robot from several initial states
        robot = replace_leaf(robot, {name: np.full(count, value) for name, value in leaves(robot)})
    many, more = (solver or _summary)(robot, start, options, workers, tell)
    if notes is not None:
        notes.update(notes_of_cases(many.model, many.columns))
    names = machine_of(robot).part_names
    without = columns_not_of(machine_of(robot))
    columns_kept = {name: many.columns[name] for name in COLUMNS if name in many.columns and name not in without}
    observed, derived = by_time_of_computation(options.get("observe"))
    columns_kept |= {name: many.columns[name] for name in observed}
    if derived:
        columns_kept |= next(iter(derived.values())).values(robot, count, derived, options["periods"])
    if events and settle is None:
        names_of_events = lacking_columns(events)
        known = many.columns if all(name in many.columns for name in names_of_events) else _of_events(robot, start, options)
        columns_kept |= {name: known[name] for name in names_of_events}
    columns_kept |= _power(robot, many.columns, more) | _alphas(robot, without)
    if settle is not None:
        of_motions = motion_columns(robot, start, options, settle, columns_kept["status"], events)
        columns_kept |= {name: values if names else np.reshape(values, len(values)) for name, values in of_motions.items()}
    ends = {name: values for name, values in more.items() if name.startswith(END)}
    return {each: of for name, values in columns_kept.items() for each, of in flattened(name, values, names).items()} | ends


def _case_by_case(
    robot: Model, start: dict[str, Any], options: dict[str, Any], settle: float | None, workers: int, count: int
) -> dict[str, Array]:
    """The columns of cases whose numbers come from whole runs, which threads share; with `settle` those of their motions after it too."""
    cases, rows = cases_of(robot) if shape_of(robot) else [robot] * count, list[dict[str, Any]]([{}] * count)
    settings = replace(settings_of(options, keep="summary"), events=options["events"])

    def columns(k: int) -> dict[str, Any]:
        motions: dict[str, Any] = {}
        watch = None if settle is None else lambda _, run: motions.update(flow_motion_columns(run, settle) if run is not None else {})
        try:
            one: Any = solved_as_asked(cases[k], replace(settings, start=one_start(start, k)), watch, settle or 0.0)
        except InputError:
            return {"status": Status.BAD_INPUT}
        return {**one.columns, **motions}

    for k, row in handed_out(columns, range(count), workers):
        rows[k] = row
    names = dict.fromkeys(name for row in rows for name in row)
    return {name: np.array([row.get(name, unknown(name, 1)[0]) for row in rows]) for name in names}


def _of_events(robot: Model, start: dict[str, Any], options: dict[str, Any]) -> dict[str, Any]:
    """The columns of events of cases whose numbers come from closed arcs, from a run of each."""
    length = {name: value for name, value in options.items() if name in ("periods", "duration", "rtol", "method")}
    length |= {} if length["duration"] is None else {"periods": None}
    return events_of_cases(robot, Settings(**length, events=options["events"], start=start or None, keep="summary"))


def _summary(robot: Model, start: dict[str, Any], options: dict[str, Any], workers: int, tell: Any) -> tuple[Any, dict[str, Array]]:
    """A summary; for Coulomb robots with a harmonic drive also the distances travelled forwards and backwards."""
    settings = settings_of(options, start=start or None, workers=workers, keep="summary", progress=tell)
    if settings.duration is not None or settings.observe or not takes_closed_arcs(settings.method, robot):
        return solved_as_asked(robot, replace(settings, events=options.get("events"))), {}
    todo = request(robot, settings)
    return orbits.solve(todo) if orbits.applies(todo) else orbits.solve_waiting(todo)


def _power(robot: Any, columns: dict[str, Array], more: dict[str, Array]) -> dict[str, Array]:
    """Mean power of the actuator: dissipation by friction minus the power of gravity; known if these distances or the losses are."""
    if machine_of(robot).track is None or not ("forward_way" in more or "friction_power" in columns):
        return {}
    steady = steady_force(robot, numbers_by_name(robot))  # gravity along the track
    if steady is None:
        return {}
    with np.errstate(invalid="ignore", divide="ignore"):
        lost = _along_the_ways(robot, columns, more) if "forward_way" in more else columns["friction_power"]
        fall = np.reshape(steady, np.shape(steady) and np.shape(lost)) * columns["mean_velocity"]
        power = np.where(columns["period"] > 0, lost - fall, np.nan)
        cost = power / (robot.total_mass * robot.gravity * abs(columns["mean_velocity"]))
    return {"drive_power": power, "cost_of_transport": np.where(columns["direction"] != 0, cost, np.nan)}


def _along_the_ways(robot: Any, columns: dict[str, Array], more: dict[str, Array]) -> Array:
    """Mean power dissipated by Coulomb friction [W]: constant forces over the distances forwards and backwards."""
    shape = np.shape(columns["mean_velocity"])
    load, law = robot.load(0.0, 0.0), law_of(robot)
    ahead, back = (np.reshape(more[name], shape) for name in ("forward_way", "backward_way"))
    return (law.sliding(1.0, load) * ahead - law.sliding(-1.0, load) * back) / (robot.period * np.maximum(columns["period"], 1))


def _alphas(robot: Model, without: set[str]) -> dict[str, Array]:
    """alpha_plus and alpha_minus of the robot, or of its twin with Coulomb friction at the kinetic coefficients, if it has one."""
    twin = None if without.issuperset(ALPHAS) else coulomb_twin(robot)
    if twin is None or handles(twin) is not None:
        return {}
    arcs = dimensionless_arcs(twin)
    with np.errstate(invalid="ignore", divide="ignore"):
        plus, minus = arcs.resist_plus / arcs.drive, arcs.resist_minus / arcs.drive
    return {"alpha_plus": plus, "alpha_minus": minus}
