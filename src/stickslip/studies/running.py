"""`sweep`: the tiles of a plan, one after the other, in threads or on a cluster, in memory or in a folder."""

from __future__ import annotations

import json
import secrets
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.basics.arguments import Executes, Maker, explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.executors import Workers
from stickslip.basics.interruption import interruptible, look, partial_result, taking_some_cases
from stickslip.basics.pool import handed_out
from stickslip.basics.status import Status
from stickslip.solvers.methods import takes_closed_arcs
from stickslip.studies.designs import SweepDesign
from stickslip.studies.execution import Execution
from stickslip.studies.labelling import dataset, provenance_of
from stickslip.studies.model_identity import ModelIdentities
from stickslip.studies.planning import Plan, planned
from stickslip.studies.progress import Progress, Watch
from stickslip.studies.result_columns import all_failed, base_of, empty, vacant
from stickslip.studies.solving import solved_models

if TYPE_CHECKING:
    import xarray as xr

Done = tuple[int, dict[str, Array], dict[str, int], str]  # index, columns, notes and identity of the models of a tile


@explains_arguments
@interruptible
def sweep(
    make: Maker,
    *designs: SweepDesign,
    periods: int = 200,
    duration: float | None = None,
    settle: int | str | None = "auto",
    rtol: float = 1e-6,
    workers: int = 1,
    start: dict[str, Any] | None = None,
    method: str = "auto",
    slip_ratio: float = 0.75,
    dwell: float = 0.03,
    continue_along: str | None = None,
    out: str | Path | None = None,
    resume: bool = False,
    shard: tuple[int, int] | str | None = None,
    tile: int | None = None,
    client: Any = None,
    executor: Executes = None,
    retries: int = 3,
    progress: Callable[[Progress], Any] | bool | None = None,
    observe: dict[str, Any] | None = None,
    events: dict[str, Any] | None = None,
    **axes: Any,
) -> xr.Dataset:
    """Solve a robot on a grid of its numbers, or on any other design.

    Every keyword that holds several values becomes a dimension of that name, in the order in which they are written; single values stay
    single and are kept as coordinates. A case that cannot be solved, such as one with a NaN, is marked by its status, and the sweep
    continues.

    Parameters
    ----------
    make : callable, Robot or SwitchingFlow
        A function that makes a robot from the keyword arguments, such as a preset; or a robot, whose fields then have dotted names:
        ``sweep(robot, **{"drive.amplitude": [4e-4, 5e-4]})``; or a flow, whose columns are the mean, smallest, largest and last value of
        each state.
    *designs : stickslip.studies.designs.SweepDesign
        Columns that share a dimension: see `stickslip.designs` (zipped, table, sobol, latin_hypercube). They are crossed with the axes.
    periods, duration, settle, rtol, method, slip_ratio, dwell
        As for `solve`; `duration` instead of `periods` is for mechanisms that have no period. `settle` is "auto" here: a case ends when
        its strobe point repeats, at most after `periods`, and its mean velocity is that of the periodic motion. For robots with Coulomb
        friction and a harmonic drive the periodic motion is computed from a closed formula instead. Of a model without a period it
        is a time [s] below `duration`: the motion after it is looked at as by `motion`, and the columns are those of its cycle, with
        period (turns), duration, amplitude, fractions, extremes and motion type. Each case takes a run of its own for that.
    observe : dict of Observable, optional
        User-defined columns by name: see `observable`.
    workers : int
        Threads. The results do not depend on it.
    start : dict
        Initial values of x, v and z: numbers, or labelled arrays over the axes. ``**{"start.v": [...]}`` makes them an axis.
    continue_along : str, optional
        An axis along which each case starts from where its neighbour ended, up and then down again: the dataset gets a dimension
        ``way`` ("up", "down"), and the two differ where there is hysteresis.
    out : path, optional
        A study folder: the results are written there tile by tile, and memory does not grow with the number of cases.
    resume : bool
        Continue the study in `out`. The results are bit-identical to those of an uninterrupted run; a different study is refused.
    shard : (i, n) or "i/n", optional
        Compute only part i (from 1) of n, for the jobs of a batch queue; `merge` puts them together. Needs `out`.
    tile : int, optional
        Cases that are computed and written together.
    client : dask.distributed.Client, optional
        Compute there instead of locally: each tile is a task.
    executor : str, executor or callable, optional
        Compute there instead of in threads: ``"processes:8"``, eight processes of this computer, of which one that is killed is begun
        again; or anything that has the ``submit`` of `concurrent.futures.Executor`, or a function that makes one, which is asked again if
        the pool breaks. `workers` is then the number of its workers. The results do not depend on it.
    retries : int
        How often a tile is retried after it failed or its worker was lost.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with a `Progress`; return False to stop. The results obtained so far are
        returned, as after Ctrl-C; the remaining cases have the status "not computed", and a note says how many they are.
    events : dict, optional
        Events of your own by name, as for `solve`: columns with the first instant and the number of each, ``first_passes_the_mark`` [s]
        and ``number_passes_the_mark``, in all the periods (or the duration) from the start. Each case is run once more for them.
    **axes
        Arguments of `make`. A list, an array or an `xarray.DataArray` is an axis, also of words, such as ``law=["coulomb", "lugre"]``.

    Returns
    -------
    xarray.Dataset
        mean_velocity, motion_type, pattern, period, margin, fractions, extremes, drive_power, cost_of_transport and status, with units
        and names. With `out` the data are read from the folder on access.

    Raises
    ------
    InputError
        All errors of the arguments, reported together before the computation. Also an error that occurs in every case, which means that
        the law or the maker is wrong; with `out` the folder is then complete, and `open_study` reads it.

    Examples
    --------
    >>> import stickslip as ss
    >>> grid = ss.sweep(ss.presets.piezo_rig, amplitude=[3e-4, 6e-4], tilt_deg=[1.7, 2.7], law="coulomb")
    >>> dict(grid.sizes), grid.motion_type.sel(tilt_deg=1.7).values.tolist()
    ({'amplitude': 2, 'tilt_deg': 2}, ['II', 'III'])
    """
    how = Execution(workers, out, resume, shard, tile, client, retries, progress, executor)
    options: dict[str, Any] = {
        "periods": periods,
        "duration": duration,
        "settle": settle,
        "rtol": rtol,
        "method": method,
        "slip_ratio": slip_ratio,
        "dwell": dwell,
        "observe": observe,
    }
    options |= {} if events is None else {"events": events}
    return carried_out(planned(make, designs, axes, start, continue_along, tile, **options), how)


def carried_out(plan: Plan, how: Execution) -> Any:
    """Run a plan, in memory or in a folder, and return its dataset."""
    out, crew = how.out, how.checked_crew()
    watch = Watch(plan.cases, how.progress)
    if out is None:
        return _in_memory(plan, how, crew, watch)
    from stickslip.studies.folder import StudyFolder
    from stickslip.studies.opening import open_study
    from stickslip.studies.tiles import MISSING, read_tile

    study = StudyFolder.begin(Path(out), plan, resume=how.resume, shard=how.shard, keep=not crew.elsewhere and plan.along is None)
    watch.resumed(sum(len(range(*plan.bounds(k))) for k in study.done))
    todo = study.todo
    with partial_result() as ending:
        for k, columns, notes, models in tiles_of(plan, todo, crew, watch, study.identities):
            if crew.elsewhere and models != study.manifest["models"][k] and study.identities is not None:
                _check_models(k, study.identities.of_tiles([k])[0], models)
            study.write(k, columns, notes, models)
            watch.finished(k, columns["status"])
    study.finish()
    grid = open_study(out)
    notes = json.loads(grid.attrs.pop("notes", "{}"))
    missing = notes.pop(MISSING, 0)  # of a shard that is complete, the others are at work on it
    if study.unmade:
        notes[study.unmade] = plan.cases
    if ending.interrupted:
        notes[ending.note(MISSING)] = missing
    if notes:
        grid.attrs["notes"] = json.dumps(notes, ensure_ascii=False)
    if ending.interrupted:
        return grid
    if study.ours and all(all_failed(read_tile(study.folder, study.manifest, k, ["status"])["status"]) for k in study.ours):
        kept = f"the folder {str(out)!r} is complete and says so of every case; correct this, and give another folder"
        raise InputError("sweep", [*json.loads(grid.attrs.get("notes", "{}")), kept])
    return grid


def _in_memory(plan: Plan, how: Execution, crew: Workers, watch: Watch) -> Any:
    """The dataset of all columns of a plan; an error common to all cases is raised."""
    if how.tile is None and plan.along is None and plan.tile > 16:
        plan = replace(plan, tile=_tile_in_memory(plan, crew))
    whole, by_tile, left = vacant(plan.cases, plan.columns), dict[int, dict[str, int]](), set(range(plan.tiles))
    with partial_result() as ending, taking_some_cases():
        for k, columns, remarks, _ in tiles_of(plan, range(plan.tiles), crew, watch):
            _put(whole, plan.bounds(k), columns)
            by_tile[k] = remarks
            left.remove(k)
            watch.finished(k, columns["status"])
            if (columns["status"] == Status.NOT_COMPUTED).any():
                look()
    for k in left:
        first, last = plan.bounds(k)
        _put(whole, (first, last), empty(last - first, plan.columns))
    notes = Counter[str]()
    for k in sorted(by_tile):
        notes.update(by_tile[k])
    if ending.interrupted:
        notes[ending.note(Status.NOT_COMPUTED.sentence)] = int((whole["status"] == Status.NOT_COMPUTED).sum())
    if all_failed(whole["status"]):
        raise InputError("sweep", list(notes))
    return dataset(plan, whole, {"provenance": provenance_of(plan)}, notes)


def _tile_in_memory(plan: Plan, crew: Workers) -> int:
    """A tile size for threads that share the work: if cases are fast, small tiles only make the threads wait for each other."""
    workers = crew.count
    if not crew.elsewhere and plan.sample is not None and takes_closed_arcs(plan.options["method"], plan.sample):
        return 32768 if plan.cases >= 8 * 32768 else 16384
    return 16384 if workers == 1 else max(min(plan.tile, -(-plan.cases // (4 * workers))), 64)


def _put(whole: dict[str, Array], bounds: tuple[int, int], columns: dict[str, Array]) -> None:
    first, last = bounds
    for name, values in columns.items():
        if base_of(name) == "pattern" and values.itemsize > whole[name].itemsize:
            whole[name] = whole[name].astype(values.dtype)
        whole[name][first:last] = values


def tiles_of(plan: Plan, todo: Iterable[int], crew: Workers, watch: Watch, identities: ModelIdentities | None = None) -> Iterator[Done]:
    """Index, columns, notes and models of each tile, as they are finished.

    The models are identified if the results are kept in a folder (`identities` is given).
    """
    todo = list(todo)
    if crew.elsewhere:
        apart = partial(_elsewhere, identities.every if identities else None, _Known())
        for (k, _), (columns, notes, models) in handed_out(apart, _alone(plan, todo), crew):
            yield k, columns, notes, models
        return
    several = crew.threads > 1 and len(todo) > 1

    def work(k: int) -> tuple[dict[str, Array], dict[str, int], str]:
        return solved_models(plan, k, 1 if several else crew.threads, partial(watch.at_work, k), identities)

    for k, done in handed_out(work, todo, crew.threads if several else 1):
        yield (k, *done)


def _alone(plan: Plan, tiles: list[int]) -> Iterator[tuple[int, Plan]]:
    """Tiles with their numbers, each as a plan of its own."""
    return ((k, plan.alone(plan.points(k))) for k in tiles)


@dataclass(eq=False)
class _Known:
    """What a worker knows of the equations of the models of one call: of another call's it keeps others, as options may be others there."""

    call: str = field(default_factory=lambda: secrets.token_hex(8))
    kinds: dict[str, tuple[str, bool]] = field(default_factory=dict)


def _elsewhere(every: int | None, known: _Known, tile: tuple[int, Plan]) -> tuple[dict[str, Array], dict[str, int], str]:
    """Compute a tile in a worker; every so-many-th of its models is identified as it is there."""
    plan = tile[1]
    return solved_models(plan, 0, 1, None, None if every is None else ModelIdentities(plan, every, kinds=known.kinds))


def _check_models(k: int, mine: str, theirs: str) -> None:
    """Raise an `InputError` if a worker has other models than this process."""
    if mine != theirs:
        what = f"a worker computed tile {k} with other models than the maker gives here"
        why = "its module, or something that it uses, is another there"
        raise InputError(
            "sweep", [f"{what}: {why}; restart the workers with the module that you use, and type resume=True if out= is given"]
        )
