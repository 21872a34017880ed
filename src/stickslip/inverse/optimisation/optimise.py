"""`optimise`: the best numbers and drives of a machine, within limits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Executes, Model, explains_arguments
from stickslip.basics.batch import shape_of
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems, is_whole
from stickslip.basics.executors import Workers
from stickslip.basics.interruption import interruptible, look, partial_result
from stickslip.basics.progress import reporting
from stickslip.inverse.optimisation.best_candidate import optimum_of
from stickslip.inverse.optimisation.candidates import Candidates
from stickslip.inverse.optimisation.closed_form_starts import closed_starts
from stickslip.inverse.optimisation.constraints import KEPT, checked_limits, scales_within
from stickslip.inverse.optimisation.optimum import Optimum, Search
from stickslip.inverse.optimisation.results import check_quantity
from stickslip.inverse.optimisation.searching import search as searched
from stickslip.inverse.optimisation.uncertainty_samples import check_sample, checked_spread, sample_of
from stickslip.inverse.optimisation.unknowns import Unknowns, Varied, checked_over

if TYPE_CHECKING:
    from stickslip.basics.progress import Reported
    from stickslip.inverse.identification.fit import Fit

_EACH, _LEAST, _MOST = 10, 32, 96  # candidates of a generation: for each unknown, at least, at most
_GENERATIONS, _MORE = 60, 25  # of the search over everything, and more for each unknown
_SAMPLE = 64  # cases of every candidate, where numbers are uncertain


@explains_arguments
@interruptible
def optimise(
    model: Model,
    over: dict[str, Any],
    maximise: str | None = None,
    minimise: str | None = None,
    subject_to: dict[str, Any] | None = None,
    robust: dict[str, Any] | Fit | None = None,
    quantile: float | None = None,
    starts: str | None = "closed",
    seed: int = 0,
    workers: int = 1,
    executor: Executes = None,
    progress: Reported | bool | None = None,
) -> Optimum:
    """The best numbers and drives of a machine, within limits.

    Differential evolution runs one candidate in each lane of the solver; SciPy's SLSQP continues from the best one with exact derivatives
    through every switch; both are repeated in ever smaller boxes, because optima of stick-slip motions often lie where the mode sequence
    changes and no derivative is zero. Every candidate is run from rest until its motion repeats.

    Parameters
    ----------
    model : Robot or machine
        The machine, with all numbers that are not varied. It must have a period.
    over : dict
        The ranges (low, high), such as (2e-4, 8e-4) or ("0.2 mm", "0.8 mm"), of numbers by their names as in ``robot.replace``:
        "drive.amplitude", "track.tilt", or for several parts "modules[1].drive.amplitude", "phases[1]"; without an index the numbers of all
        parts vary together. For a drive ("drive", "modules[0].drive") a `waveform`.
    maximise, minimise : str
        One of them: "mean_velocity" (maximised if neither is given), "cost_of_transport", "drive_power", or another column of a sweep.
    subject_to : dict, optional
        Limits as (least, largest), None for no limit: of "stroke" [m], "relative_velocity" [m/s] and "relative_acceleration" [m/s^2] of the
        drives, and of columns of a sweep, such as "drive_power" [W]. A waveform needs a limit of acceleration and one of stroke or
        velocity.
    robust : dict or Fit, optional
        Uncertain numbers, as for `propagate`: {"friction.mu_plus": ("uniform", 0.13, 0.17)}, or a Fit. Every candidate is run at the same
        64 points of a Sobol sample, and its worst result counts.
    quantile : float, optional
        With `robust`, the fraction of the sample that may be worse than the result that counts, such as 0.05.
    starts : "closed" or None
        "closed" includes drives known in closed form in the first generation; None starts from random ones only.
    seed : int
        The same seed gives the same result.
    workers : int
        Threads. The result does not depend on it.
    executor : executor or callable, optional
        Compute there, as for `sweep`; `workers` is then the number of its workers.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with (candidates tried, largest number); return False to stop. The best so
        far is returned, also after Ctrl-C.

    Returns
    -------
    Optimum
        ``best.model``, ``best["mean_velocity"]``, ``best.of_limit``, ``best.active``, ``best.sensitivities``.

    Raises
    ------
    InputError
        For unknown names, contradictory bounds, bounds or a sample outside the allowed range, numbers that are set twice, and if no
        candidate satisfies the limits.

    References
    ----------
    R. Storn and K. Price, Differential evolution; *Journal of Global Optimization* 11 (1997) 341-359.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.Robot(0.0626, 0.0095, ss.drives.TwoPhase(stroke=0.01, u1=0.1, u2=0.1), ss.Coulomb(0.15, 0.25))
    >>> best = ss.optimise(robot, over={"drive.u1": (0.01, 0.8), "drive.u2": (0.01, 0.8)}, maximise="mean_velocity")
    >>> round(best.model.drive.u1, 9), round(best.model.drive.u2, 9), best.active
    (0.8, 0.8, ('drive.u1', 'drive.u2'))
    """
    problems = Problems("optimise")
    maximise = "mean_velocity" if maximise is None and minimise is None else maximise
    if shape_of(model):
        raise InputError("optimise", ["the machine is a batch (some of its numbers are arrays); allowed is one; type single values"])
    quantity = _quantity(model, maximise, minimise, problems)
    varied, limits = checked_over(model, over, problems), checked_limits(model, subject_to, problems)
    scales = scales_within(limits, subject_to, problems) if any(each.form is not None for each in varied) else None
    sample = _sample(model, robust, quantile, varied, int(seed) if is_whole(seed) else 0, problems)
    if starts not in ("closed", None):
        problems.add(f'starts = {starts!r}; allowed is "closed" or None; type starts=None')
    if model.period is None:
        problems.add(f"{type(model).__name__} has no period; allowed are machines with a drive, such as a Robot")
    problems.whole("seed", seed, 0, example=0)
    crew = Workers(workers, executor)
    crew.note(problems)
    problems.check()
    space = Unknowns(model, varied, scales)
    _check_middle(space)
    population = int(np.clip(_EACH * space.count, _LEAST, _MOST))
    generations = _GENERATIONS + _MORE * space.count
    report, most = reporting(progress, "optimise"), 2 * population * generations

    def tell(tried: int) -> None:
        report(min(tried, most - 1), most)
        look()

    with crew.kept() as kept, partial_result() as ending:
        worth = Candidates(space, quantity, -1.0 if maximise else 1.0, limits, kept, tell, sample, quantile)
        searched(worth, closed_starts(space) if starts else np.empty((0, space.count)), int(seed), generations, population)
    ending.needs(worth.best is not None)
    if worth.best is None:
        raise _none_kept(worth)
    notes = [ending.note("the search did not end, and this is the best so far")] if ending.interrupted else []
    if not notes:
        report(worth.tried, worth.tried)
    over = {each.name: each.form or (each.low, each.high) for each in varied}
    asked = (over, {limit.name: limit.ends for limit in limits}, _as_given(robust), quantile, starts, int(seed))
    return optimum_of(worth, notes, Search(maximise is not None, *asked, np.array(worth.history)))


def _quantity(model: Model, maximise: Any, minimise: Any, problems: Problems) -> str:
    given = [name for name in (maximise, minimise) if name is not None]
    if len(given) != 1:
        problems.add('both maximise and minimise are given; allowed is one of them; type maximise="mean_velocity"')
        return "mean_velocity"
    try:
        check_quantity("optimise", "maximise" if maximise is not None else "minimise", given[0], model)
    except InputError as error:
        problems.include(error)
    return str(given[0])


def _sample(model: Model, robust: Any, quantile: Any, varied: list[Varied], seed: int, problems: Problems) -> dict[str, Array] | None:
    """The sample of what is uncertain."""
    if quantile is not None and not (isinstance(quantile, float) and 0.0 < quantile < 1.0 and robust is not None):
        problems.add(f"quantile = {quantile!r}; allowed is between 0 and 1, with robust=; type quantile=0.05")
    if robust is None:
        return None
    spread = checked_spread(model, "robust", robust, problems)
    if spread is None:
        return None
    for one in spread.names:
        for other in varied:
            both = [a for a in spread.alone(one, np.array([0.5])) for b in other.leaves if a == b or a.startswith(b + ".")]
            problems.mistakes += [
                f"{one!r} is uncertain and {other.name!r} varies: {a} would be set twice; leave one out" for a in both[:1]
            ]
    sample = sample_of(spread, _SAMPLE, seed)
    try:
        check_sample("optimise", model, sample)
    except InputError as error:
        problems.include(error)
    return sample


def _as_given(robust: Any) -> dict[str, Any]:
    """Distributions as they were typed; of a fit, what it found."""
    return (
        dict(robust or {})
        if robust is None or isinstance(robust, dict)
        else {name: ("fitted", *robust.interval(name)) for name in robust.names}
    )


def _check_middle(space: Unknowns) -> None:
    """Numbers in the middle of their bounds have to make a machine: the record says what they may be."""
    forms = [part for each, part in zip(space.varied, space.slices, strict=True) if each.form is not None]
    u = np.full(space.count, 0.5)
    for part in forms:
        u[part] = np.resize([0.1, 0.9], part.stop - part.start)
    try:
        space.machine(u)
    except InputError as error:
        sentences = [f"no machine can be made with numbers in the middle of the bounds: {problem}" for problem in error.problems]
        raise InputError("optimise", sentences) from None


def _none_kept(worth: Candidates) -> InputError:
    """Why there is no best."""
    limits = {limit.name: limit for limit in worth.limits}
    nearest = [f"{limits[name].in_words()} (nearest: {value:.6g})" for name, (beyond, value) in worth.nearest.items() if beyond > KEPT]
    said, kept = f"none of {worth.tried} candidates", " and ".join(limit.in_words() for limit in worth.limits)
    why = f"{'keeps the limits of ' + kept + ' and ' if kept else ''}has a {worth.quantity}; widen the bounds in over"
    if nearest:
        why = f"keeps {' and '.join(nearest)}; widen these limits in subject_to, or the bounds in over"
    return InputError("optimise", [f"{said} {why}"])
