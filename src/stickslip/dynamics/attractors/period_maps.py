"""Maps over one or two parameters: after how many drive periods a motion repeats, and its largest exponent, for every point of a grid."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Executes, Maker, explains_arguments
from stickslip.basics.batch import some_of
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import Problems
from stickslip.basics.executors import Workers
from stickslip.basics.fields import floats
from stickslip.basics.interruption import interruptible, partial_result
from stickslip.dynamics.attractors.kinds_of_motion import NOT_COMPUTED, OF_MOTIONS, UNDONE, worded
from stickslip.dynamics.attractors.motion_features import features_of
from stickslip.dynamics.attractors.settled_motions import Settling, checked_limit, settled_motions
from stickslip.dynamics.continuation.one_parameter import Family, family
from stickslip.dynamics.derivatives.growth import derivatives_after
from stickslip.dynamics.derivatives.tangents import not_followed
from stickslip.dynamics.exponents.motion_exponents import exponents_from
from stickslip.dynamics.periodic.given_states import states_of
from stickslip.dynamics.stroboscopic.chosen_sections import on_section
from stickslip.dynamics.stroboscopic.chunked_runs import Report, over_chunks
from stickslip.dynamics.stroboscopic.refusals import needs_model
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, spread_over, strobe_map

if TYPE_CHECKING:
    import xarray as xr

    from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates

_COLUMNS = {
    "period": {"long_name": "drive periods until it repeats (0: none, -1: not computed)", "units": "1"},
    "mean_velocity": {"long_name": "mean velocity", "units": "m/s"},
    **OF_MOTIONS,
}


@explains_arguments
@interruptible
def chaos_map(
    make: Maker,
    *,
    settle: int = 300,
    limit: int | None = None,
    periods: int = 200,
    start: Any = None,
    rtol: float = 1e-8,
    section: Any = None,
    turns: int = 1,
    workers: int = 1,
    executor: Executes = None,
    progress: Report | None = None,
    **arguments: Any,
) -> xr.Dataset:
    """A map over one or two parameters of period number, largest Lyapunov exponent and mean velocity.

    If the strobe point returns, the exponent follows from the multipliers of the motion; otherwise it is measured with two neighbouring
    motions, as in `largest_exponents`.

    Parameters
    ----------
    make : callable or Robot
        A function that makes a robot from keyword arguments, or a robot whose numbers have dotted names.
    settle, periods : int
        Drive periods to discard at least, and to average the exponent of what has no period over (600 where fewer do not tell it from
        zero).
    limit : int, optional
        Drive periods up to which a motion is run on that has not settled, eight times `settle` if not given; see `basins` for what is then
        said of it.
    start : dict, array or orbit, optional
        Initial state of every case; rest if not given.
    rtol : float
        Tolerance for dynamic laws.
    section : str or tuple, optional
        Of a model without a period: where its motions are looked at, by the name of a state, ``section="v"``, with the value that it
        passes, ``section=("v", 0.0)``, and the direction, 1 where it rises and -1 where it falls. If not given, it is chosen from a run.
    turns : int
        Of a model without a period: after how many returns to the section it is looked at again.
    workers : int
        Threads. The results do not depend on it.
    executor : executor or callable, optional
        Compute there, as for `sweep`; `workers` is then the number of its workers.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with a `Progress`; return False to stop. What is not computed then has the
        period -1.
    **arguments
        Arguments of `make`; one or two of them are lists or arrays.

    Returns
    -------
    xarray.Dataset
        Over the parameters: motion ("periodic", "quasi-periodic", "chaotic", "not settled", "runs away", "not solved", "not computed"),
        period (0: none), exponent and its error per drive period, mean_velocity [m/s], run (drive periods until the motion was recognised,
        or given up).

    Examples
    --------
    >>> import stickslip as ss
    >>> m = ss.dynamics.chaos_map(ss.presets.piezo_rig, mu0=[0.04, 0.05], amplitude=[4e-4, 6e-4], tilt_deg=1.7, settle=200, periods=40)
    >>> m.period.values.tolist(), (m.exponent > 0.1).values.tolist()  # chaos at mu0 = .05, A = 0.4 mm
    ([[1, 2], [0, 1]], [[False, False], [True, False]])
    """
    import xarray as xr

    crew = Workers(workers, executor)
    axes, most = _axes(arguments, settle, limit, periods, crew)
    robots = family("chaos_map", make, tuple(axes), {name: value for name, value in arguments.items() if name not in axes})
    first = robots.robot(*(axis[0] for axis in axes.values()))
    needs_model("chaos_map", first, flows=True, sections=True)
    if first.period is None:
        known = on_section(first, section=section, turns=turns, states=states_of(start, first), what="chaos_map").section
        section = known.name if section is None else section
    grid = [column.ravel() for column in np.meshgrid(*axes.values(), indexing="ij")]
    size = grid[0].size
    whole = [
        np.full(size, UNDONE),
        np.full(size, np.nan),
        np.full(size, NOT_COMPUTED, dtype="<U16"),
        *np.full((2, size), np.nan),
        np.zeros(size, int),
    ]

    def values_of(part: slice) -> list[Array]:
        return [column[part] for column in grid]

    work = partial(_looked_at, robots, start, (section, turns), Settling(settle, most, rtol, exponents=periods))
    with partial_result() as ending:
        for part, results in over_chunks(size, values_of, work, crew, progress):
            for column, values in zip(whole, results, strict=True):
                column[part] = values
    shape = tuple(len(axis) for axis in axes.values())
    columns = {
        name: (tuple(axes), column.reshape(shape), worded(about, first.period is None))
        for (name, about), column in zip(_COLUMNS.items(), whole, strict=True)
    }
    attrs: dict[str, Any] = {"settle": settle, "limit": most, "periods": periods, "rtol": rtol}
    if ending.interrupted:
        attrs["note"] = ending.note(f"{int((whole[0] != UNDONE).sum())} of {whole[0].size} points are computed")
    return xr.Dataset(columns, {name: (name, axis, robots.describe(name)) for name, axis in axes.items()}, attrs)


def _is_many(value: Any) -> bool:
    """Whether an argument is a list or an array."""
    return isinstance(value, (list, tuple, range)) or getattr(value, "ndim", 0) > 0


def _axes(arguments: dict[str, Any], settle: Any, limit: Any, periods: Any, workers: Workers) -> tuple[dict[str, Array], int]:
    problems = Problems("chaos_map")
    axes = {name: floats(value) for name, value in arguments.items() if _is_many(value)}
    if len(axes) not in (1, 2):
        problems.add(f"{len(axes)} arguments have several values; allowed are one or two, such as mu0=[...], amplitude=[...]")
    for name, axis in axes.items():
        if axis.ndim != 1 or not len(axis) or not np.isfinite(axis).all():
            problems.add(f"{name} = {arguments[name]!r}; allowed are finite numbers, at least one")
    problems.whole("settle", settle, 1, example=300)
    most = checked_limit(problems, settle, limit)
    problems.whole("periods", periods, 20, example=200)
    workers.note(problems)
    problems.check()
    return axes, most


def _looked_at(robots: Family, start: Any, section: tuple[Any, int], how: Settling, values: list[Array], tell: Any) -> tuple[Array, ...]:
    """Period, mean velocity, motion, exponent, its error and drive periods of a part of the grid."""
    cases, rtol = len(values[0]), how.rtol
    model = spread_over(robots.robots(*values), cases)
    first = states_of(start, model)
    at = coordinates(robots.robot(*(column[0] for column in values)))
    at = on_section(model, at, section=section[0], turns=section[1], states=first, what="chaos_map")
    first = at.section.starts(first) if start is None and at.section is not None else first
    settled = settled_motions(model, first, at, how, groups=np.arange(cases))
    tell(0.7)
    V = features_of(model.period, settled, at).mean_velocity
    state, exponent, error = settled.points[:, -1], settled.exponent.copy(), settled.error.copy()
    followed = at.section is None and not not_followed(model)
    for p in np.unique(settled.period[settled.period > 0]):
        members = np.flatnonzero(settled.period == p)
        some = some_of(model, members)
        if followed:
            exponent[members], error[members] = _by_multipliers(some, state[members], int(p), at, rtol)
        else:
            apart = max(1e-7, 100 * rtol)
            exponent[members], error[members] = exponents_from(
                some, state[members], how.exponents, rtol=rtol, apart=apart, at=at.of(members)
            )
    return settled.period, V, settled.kind, exponent, error, settled.run


def _by_multipliers(model: Model, state: Array, period: int, at: Coordinates, rtol: float) -> tuple[Array, Array]:
    """The largest exponent per drive period of motions that repeat; its error: how far it is from that of the next turn."""
    after = strobe_map(model, state, period, rtol).state
    with np.errstate(divide="ignore", invalid="ignore"):
        first, second = (np.log(_largest(derivatives_after(at, model, s, period, rtol))) / period for s in (state, after))
        return first, np.nan_to_num(abs(first - second), posinf=np.inf)


def _largest(matrices: Array) -> Array:
    """The absolute value of the largest eigenvalue of each; NaN where a matrix has no numbers."""
    known = np.isfinite(matrices).all(axis=(1, 2))
    largest = np.full(len(matrices), np.nan)
    largest[known] = abs(np.linalg.eigvals(matrices[known])).max(axis=1)
    return largest
