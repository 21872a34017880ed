"""Numbers of many machines at once: the columns of a sweep, a lane for each machine."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from stickslip.basics.batch import some_of
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, did_you_mean
from stickslip.basics.executors import HERE, Workers
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.basics.interruption import Interrupted, takes_some_cases
from stickslip.basics.pool import handed_out
from stickslip.basics.quantities import pretty_unit
from stickslip.basics.status import Status
from stickslip.basics.variables import VARIABLES, in_units_of
from stickslip.dynamics.stroboscopic.chunked_runs import chunks_of
from stickslip.inverse.optimisation.peaks import LIMITS
from stickslip.models.machine_adapter import machine_of
from stickslip.studies.models_of_points import Group, starts_at
from stickslip.studies.planning import SOLVER
from stickslip.studies.result_columns import COLUMNS, concatenated, dim_of, part_columns
from stickslip.studies.self_excited import OF_CYCLES
from stickslip.studies.solving import ALPHAS, columns_not_of, columns_of_group

#: Drive periods that a motion is given to settle.
PERIODS = 400
_LEAST = 16  # cases that are sent to a worker together


def results_of(
    model: Model,
    cases: int,
    workers: Workers = HERE,
    start: dict[str, Any] | None = None,
    rtol: float = 1e-6,
    watch: Callable[[int, int], None] | None = None,
    observe: dict[str, Any] | None = None,
) -> dict[str, Array]:
    """The columns of a sweep for every case of a batch; a case that fails has a status and NaN elsewhere.

    Examples
    --------
    >>> import stickslip as ss
    >>> found = results_of(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=[5.56e-4, 8e-4], law="coulomb-static"), 2)
    >>> found["mean_velocity"].round(9).tolist()
    [0.002032039, 0.004308808]
    """
    options = SOLVER | {"periods": PERIODS, "rtol": rtol, "observe": observe}
    whole = Group(np.arange(cases), model, start or {})
    if workers.elsewhere:
        columns = _computed_elsewhere(whole, options, workers, watch)
    else:
        columns = columns_of_group(whole, options, workers.threads, watch, Counter())
    columns.setdefault("mean_velocity", np.full(cases, np.nan))
    return columns


def _computed_elsewhere(
    whole: Group, options: dict[str, Any], workers: Workers, watch: Callable[[int, int], None] | None
) -> dict[str, Array]:
    """The columns of a group whose cases are divided among the workers of an executor."""
    cases = len(whole.at)
    parts = chunks_of(cases, max(_LEAST, -(-cases // (2 * workers.count))))
    columns = [{"status": np.full(part.stop - part.start, Status.NOT_COMPUTED, COLUMNS["status"])} for part in parts]

    def piece(part: slice) -> Group:
        return Group(whole.at[part], some_of(whole.robot, part), starts_at(whole.start, whole.at[part]))

    pieces = ((k, piece(part)) for k, part in enumerate(parts))
    done = 0
    try:
        for (k, group), result in handed_out(partial(_columns_of_piece, options), pieces, workers):
            columns[k], done = result, done + len(group.at)
            if watch is not None:
                watch(done, cases)
    except Interrupted:
        if not takes_some_cases():
            raise
    return concatenated(columns)


def _columns_of_piece(options: dict[str, Any], piece: tuple[int, Group]) -> dict[str, Array]:
    return columns_of_group(piece[1], options, 1, None, Counter())


def quantities(model: Model) -> list[str]:
    """Names of the columns of a sweep over a machine that are numbers.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = quantities(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4))
    >>> [name in robot for name in ("cost_of_transport", "friction_power", "impulse_max")]
    [True, False, False]
    """
    without = {*ALPHAS, *columns_not_of(machine_of(model)), *(() if model.period is None else OF_CYCLES)}
    return [name for name, kind in COLUMNS.items() if kind == "f8" and name not in without]


def unit_of_result(name: str, model: Model) -> str:
    """The unit of a result of a machine or of a peak of its drives, as it stands behind the value; empty for a bare number.

    Examples
    --------
    >>> import stickslip as ss
    >>> chain, joint = ss.Chain.example(), ss.Joint.example()
    >>> unit_of_result("velocity_max.0", chain), unit_of_result("mean_velocity", joint), unit_of_result("relative_acceleration", chain)
    ('m/s', 'rad/s', 'm/s²')
    """
    column = name.partition(".")[0]
    unit = LIMITS.get(column) or (in_units_of(model, VARIABLES[column].unit) if column in VARIABLES else "")
    return "" if unit == "1" else pretty_unit(unit)


def check_quantity(what: str, argument: str, name: Any, model: Model) -> None:
    """`InputError` of `what` for a name that is not a number of a result."""
    known = quantities(model)
    if not isinstance(name, str) or name.partition(".")[0] not in known:
        near = did_you_mean(str(name), known)
        raise InputError(what, [f"{argument} = {name!r}; allowed is a number of a run, such as 'mean_velocity'; {near}"])
    column, parts = name.partition(".")[0], machine_of(model).part_names
    each, dim = part_columns(column, parts), dim_of(column, parts)
    if name not in each:
        of = f" (that of {', '.join(parts[dim])})" if dim else ""
        raise InputError(what, [f"{argument} = {name!r}; allowed is one of {', '.join(each)}{of}"])


def moved_by(model: Model, moves: dict[str, Array]) -> Any:
    """A batch of a machine with some of its numbers moved: an array of moves for each."""
    count = len(next(iter(moves.values())))
    return replace_leaf(model, {name: np.full(count, float(own)) + moves.get(name, 0.0) for name, own in leaves(model)})
