"""`pareto`: the best of one quantity for every level of another."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Executes, Model, explains_arguments
from stickslip.basics.errors import InputError, Problems, StickslipError
from stickslip.basics.executors import Workers
from stickslip.basics.fields import leaves
from stickslip.basics.interruption import interruptible, look, partial_result
from stickslip.basics.progress import reporting
from stickslip.basics.variables import VARIABLES, unit_of
from stickslip.inverse.optimisation.optimise import optimise
from stickslip.inverse.optimisation.optimum import Optimum
from stickslip.inverse.optimisation.results import check_quantity
from stickslip.models.naming import axis_of

if TYPE_CHECKING:
    import xarray as xr

    from stickslip.basics.progress import Reported

_ABOVE = 1e-6  # of the least value: how far above it the first level is, so that of equally cheap machines the best is found


@explains_arguments
@interruptible
def pareto(
    model: Model,
    over: dict[str, Any],
    maximise: str,
    minimise: str,
    subject_to: dict[str, Any] | None = None,
    points: int = 8,
    starts: str | None = "closed",
    seed: int = 0,
    workers: int = 1,
    executor: Executes = None,
    progress: Reported | bool | None = None,
) -> xr.Dataset:
    """The Pareto front of two quantities: the largest value of one under several limits on the other.

    Each point is a separate optimum (`optimise`) under one limit. The limits are evenly spaced from the smallest possible value to the
    value of the machine that maximises the other quantity. Dominated points are left out.

    Parameters
    ----------
    model, over, subject_to, starts, seed, workers, executor
        As for `optimise`.
    maximise, minimise : str
        The two quantities: "mean_velocity", "cost_of_transport", "drive_power", ….
    points : int
        Number of limits, 2 or more.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with (searches done, in all); return False to stop.

    Returns
    -------
    xarray.Dataset
        Along the dimension "point", in ascending order of `minimise`: both quantities, and the numbers of the machines that differ between
        them. `stickslip.plot.front` draws it.

    Raises
    ------
    InputError
        As for `optimise`.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    >>> over = {"drive.amplitude": (3e-4, 8e-4)}
    >>> front = ss.optimisation.pareto(robot, over=over, maximise="mean_velocity", minimise="drive_power", points=3)
    >>> bool((front.mean_velocity.diff("point") > 0).all()), round(float(front["drive.amplitude"][-1]), 9)
    (True, 0.0008)
    """
    problems = Problems("pareto")
    problems.whole("points", points, 2, example=8, most=1000)
    for argument, name in (("maximise", maximise), ("minimise", minimise)):
        try:
            check_quantity("pareto", argument, name, model)
        except InputError as error:
            problems.include(error)
    if maximise == minimise or (isinstance(subject_to, dict) and minimise in subject_to):
        problems.add(f"{minimise!r} is to be small and is maximised or limited too; allowed are two quantities; leave it out of the other")
    problems.check()
    report, whole = reporting(progress, "pareto"), points + 2
    with Workers(workers, executor).kept() as kept:
        asked: dict[str, Any] = dict(over=over, starts=starts, seed=seed, workers=kept.threads, executor=kept.executor)
        least = optimise(model, minimise=minimise, subject_to=subject_to, **asked)
        most = optimise(model, maximise=maximise, subject_to=subject_to, **asked)
        optima, low, high = [most], least[minimise] + _ABOVE * abs(least[minimise]), most[minimise]
        with partial_result() as ending:
            for done, level in enumerate(np.linspace(low, high, points)[:-1] if low < high else ()):
                report(done + 2, whole)
                look()
                try:
                    optima.append(
                        optimise(model, maximise=maximise, subject_to={**(subject_to or {}), minimise: (None, float(level))}, **asked)
                    )
                except StickslipError:  # the search has not met a machine below this level
                    continue
    front = _dataset([each for each in optima if not _beaten(each, optima, maximise, minimise)], maximise, minimise)
    if ending.interrupted:
        return front.assign_attrs(note=ending.note(f"{len(optima)} of at most {points} searches are done"))
    report(whole, whole)
    return front


def _beaten(one: Optimum, others: list[Optimum], maximise: str, minimise: str) -> bool:
    """Whether another one is at least as good in both, and better in one."""
    pairs = [(other[maximise] - one[maximise], one[minimise] - other[minimise]) for other in others if other is not one]
    return any(a >= 0.0 and b >= 0.0 and (a > 0.0 or b > 0.0) for a, b in pairs)


def _dataset(optima: list[Optimum], maximise: str, minimise: str) -> xr.Dataset:
    import xarray as xr

    optima = sorted(optima, key=lambda each: each[minimise])
    numbers = [dict(leaves(each.model)) for each in optima]
    varied = [name for name in numbers[0] if len({each[name] for each in numbers}) > 1]
    columns = {name: [each[name] for each in optima] for name in (minimise, maximise)}
    columns |= {name: [each[name] for each in numbers] for name in varied}
    model = optima[0].model
    labels = {name: (VARIABLES[name].long_name, unit_of(name, model)) for name in (minimise, maximise) if name in VARIABLES}
    labels |= {name: axis for name in varied if (axis := axis_of(name, model))}
    known = {name: {"long_name": label, "units": unit} for name, (label, unit) in labels.items()}
    made = {name: ("point", np.array(values), known.get(name, {})) for name, values in columns.items()}
    return xr.Dataset(made, coords={"point": np.arange(len(optima))}, attrs={"maximise": maximise, "minimise": minimise})
