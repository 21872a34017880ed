"""`optimise`: the best numbers and drives of a machine, within limits."""

from __future__ import annotations

from functools import reduce
from typing import Any

import numpy as np

from stickslip.arguments import Model, explains_arguments
from stickslip.callbacks import told_of_progress
from stickslip.dynamics.mapping import coordinates, spread_over
from stickslip.dynamics.sensitivity import directions_of
from stickslip.errors import InputError, Problems, StickslipError, is_whole
from stickslip.machine import machine_of
from stickslip.optimising.candidates import Candidates, Stopped
from stickslip.optimising.gradients import Gradient, gradient
from stickslip.optimising.limits import KEPT, Limit, checked_limits, scales_within
from stickslip.optimising.optimum import Optimum
from stickslip.optimising.peaks import LIMITS, drives_within, peaks_of
from stickslip.optimising.results import check_quantity, results_of
from stickslip.optimising.searching import search
from stickslip.optimising.small_friction import small_friction_limit
from stickslip.optimising.starts import closed_starts
from stickslip.optimising.uncertain import checked_uncertain, sample_of
from stickslip.optimising.unknowns import Unknowns, Varied, checked_over

__all__ = ["optimise"]

Array = Any
_EACH, _LEAST, _MOST = 10, 32, 96  # candidates of a generation: for each unknown, at least, at most
_GENERATIONS, _MORE = 60, 25  # of the search over everything, and more for each unknown
_ACTIVE = 1e-6  # how near a limit or a bound is active, as a part of it
_SAMPLE = 64  # cases of every candidate, where numbers are uncertain
_SAME = 1e-6  # of the mean velocity: attractors nearer to each other are one


@explains_arguments
def optimise(
    model: Model,
    over: dict[str, Any],
    maximise: str | None = None,
    minimise: str | None = None,
    subject_to: dict[str, Any] | None = None,
    robust: dict[str, Any] | None = None,
    quantile: float | None = None,
    starts: str | None = "closed",
    seed: int = 0,
    workers: int = 1,
    progress: Any = None,
) -> Optimum:
    """The best numbers and drives of a machine, within limits.

    A population is searched in the lanes of the solver, one candidate in each (differential evolution); from its best SciPy's SLSQP goes
    on with exact derivatives through every switch; then both again in ever smaller boxes, because optima of stick-slip often lie where
    the sequence of modes changes and no derivative is zero. Every candidate is run from rest until its motion repeats.

    Parameters
    ----------
    model : Robot or machine
        Where what is not searched comes from. With a period.
    over : dict
        What varies: (low, high) for a number by its name as in ``robot.replace``, such as "drive.amplitude" or "track.tilt", of several
        parts "modules[1].drive.amplitude", "phases[1]"; without an index those of all parts together. A `waveform` for a drive: "drive",
        "modules[0].drive".
    maximise, minimise : str
        Exactly one of them: "mean_velocity", "cost_of_transport", "drive_power", or another column of a sweep.
    subject_to : dict, optional
        Limits as (least, largest), None for no limit: of "stroke" [m], "relative_velocity" [m/s] and "relative_acceleration" [m/s^2] of
        the drives, and of columns of a sweep, such as "drive_power" [W]. A waveform needs the acceleration, and stroke or velocity.
    robust : dict, optional
        What is uncertain, as for `propagate`: {"friction.mu_plus": ("uniform", 0.13, 0.17)}. Every candidate is run with 64 points of a
        Sobol sample, the same for all, and what counts is the worst of them.
    quantile : float, optional
        With `robust`: the part of the sample that may be worse than what counts, such as 0.05.
    starts : "closed" or None
        "closed" tries drives that are known in closed form with the first generation; None nothing but random ones.
    seed : int
        The same seed gives the same result.
    workers : int
        Threads. The result does not depend on it.
    progress : callable or bool, optional
        True for a line on the terminal, or what is called with (candidates tried, at most); it ends the search by returning False. So does
        Ctrl-C, and the best so far is returned.

    Returns
    -------
    Optimum
        ``best.model``, ``best["mean_velocity"]``, ``best.of_limit``, ``best.active``, ``best.sensitivities``.

    Raises
    ------
    InputError
        For unknown names, contradictory bounds, what would be set twice, and where no candidate keeps the limits.

    References
    ----------
    R. Storn and K. Price, Differential evolution; *Journal of Global Optimization* 11 (1997) 341-359.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.Robot(0.0626, 0.0095, ss.TwoPhase(stroke=0.01, u1=0.1, u2=0.1), ss.Coulomb(0.15, 0.25))
    >>> best = ss.optimise(robot, over={"drive.u1": (0.01, 0.8), "drive.u2": (0.01, 0.8)}, maximise="mean_velocity")
    >>> round(best.model.drive.u1, 9), round(best.model.drive.u2, 9), best.active
    (0.8, 0.8, ('drive.u1', 'drive.u2'))
    """
    problems = Problems("optimise")
    quantity = _quantity(model, maximise, minimise, problems)
    varied, limits = checked_over(model, over, problems), checked_limits(model, subject_to, problems)
    scales = scales_within(limits, problems) if any(each.form is not None for each in varied) else None
    sample = _sample(model, robust, quantile, varied, int(seed) if is_whole(seed) else 0, problems)
    if starts not in ("closed", None):
        problems.add(f'starts = {starts!r}; allowed is "closed" or None; type starts=None')
    if model.period is None:
        problems.add(f"{type(model).__name__} has no period; allowed are machines with a drive, such as a Robot")
    problems.whole("seed", seed, 0, example=0)
    problems.whole("workers", workers, 1, example=2)
    problems.check()
    space = Unknowns(model, varied, scales)
    _check_middle(space)
    population = int(np.clip(_EACH * space.count, _LEAST, _MOST))
    generations = _GENERATIONS + _MORE * space.count
    report, most = told_of_progress(progress, "optimise"), 2 * population * generations

    def tell(tried: int) -> None:
        if report is not None and report(min(tried, most), most) is False:
            raise Stopped

    worth = Candidates(space, quantity, -1.0 if maximise else 1.0, limits, int(workers), tell, sample, quantile)
    notes = []
    try:
        search(worth, closed_starts(space) if starts else np.empty((0, space.count)), int(seed), generations, population)
    except (KeyboardInterrupt, Stopped):
        notes.append("the search was stopped: the best so far")
    if worth.best is None:
        raise InputError("optimise", [_none_kept(worth)])
    return _told(worth, bool(maximise), notes)


def _quantity(model: Any, maximise: Any, minimise: Any, problems: Problems) -> str:
    given = [name for name in (maximise, minimise) if name is not None]
    if len(given) != 1:
        problems.add(f'{len(given)} of maximise and minimise are given; allowed is exactly one; type maximise="mean_velocity"')
        return "mean_velocity"
    try:
        check_quantity("optimise", "maximise" if maximise is not None else "minimise", given[0], model)
    except InputError as error:
        problems.include(error)
    return str(given[0])


def _sample(model: Any, robust: Any, quantile: Any, varied: list[Varied], seed: int, problems: Problems) -> dict[str, Array] | None:
    """The sample of what is uncertain."""
    if quantile is not None and not (isinstance(quantile, float) and 0.0 < quantile < 1.0 and robust is not None):
        problems.add(f"quantile = {quantile!r}; allowed is between 0 and 1, with robust=; type quantile=0.05")
    if robust is None:
        return None
    uncertain = checked_uncertain(model, "robust", robust, problems)
    for one in uncertain:
        for other in varied:
            both = [a for a in one.leaves for b in other.leaves if a == b or a.startswith(b + ".")]
            problems.found += [
                f"{one.name!r} is uncertain and {other.name!r} varies: {a} would be set twice; leave one out" for a in both[:1]
            ]
    return sample_of(uncertain, _SAMPLE, seed) if uncertain else None


def _check_middle(space: Unknowns) -> None:
    """Numbers in the middle of their bounds have to make a machine: the record says what they may be."""
    forms = [place for each, place in zip(space.varied, space.slices, strict=True) if each.form is not None]
    u = np.full(space.count, 0.5)
    for place in forms:
        u[place] = np.resize([0.1, 0.9], place.stop - place.start)
    try:
        space.machine(u)
    except InputError as error:
        told = [f"numbers in the middle of the bounds make no machine: {problem}" for problem in error.problems]
        raise InputError("optimise", told) from None


def _none_kept(worth: Candidates) -> str:
    """Why there is no best."""
    if not worth.tried:
        return "the search was stopped before a candidate was run"
    limits = {limit.name: limit for limit in worth.limits}
    nearest = [f"{limits[name].told()} (nearest: {value:.6g})" for name, (beyond, value) in worth.nearest.items() if beyond > KEPT]
    if nearest:
        return f"none of {worth.tried} candidates keeps {' and '.join(nearest)}; widen these limits in subject_to, or the bounds in over"
    kept = " and ".join(limit.told() for limit in worth.limits)
    return f"none of {worth.tried} candidates {'keeps ' + kept + ' and ' if kept else ''}has a {worth.quantity}; widen the bounds in over"


def _told(worth: Candidates, largest: bool, notes: list[str]) -> Optimum:
    """The result, everything computed anew from the machine alone."""
    model, space = worth.space.machine(worth.best), worth.space
    values = _values(model)
    V = float(values.get("mean_velocity", np.nan))
    forwards = V >= 0.0
    limit, what = small_friction_limit(model, worth.limits, forwards)
    notes = [*notes, *_others(model, V), *([f"the motion is {values['motion_type']}: it makes no way"] if V == 0.0 else [])]
    if values.get("steadiness", 0) != 0:
        notes.append("the motion had not settled: V is that of its last periods")
    active = (*_active_limits(worth.limits, values), *_active_bounds(space, worth.best))
    slopes = _sensitivities(model, worth, notes)
    share = None if limit is None else abs(V) / limit
    robust = None if worth.sample is None else worth.sign * worth.least
    return Optimum(model, worth.quantity, values, share, what, active, slopes, worth.tried, tuple(notes), robust)


def _values(model: Any) -> dict[str, Any]:
    """Numbers of the motion from rest, and the peaks of the drives."""
    columns = results_of(spread_over(model, 1), 1, rtol=1e-9)
    found = {name: values[0].item() for name, values in columns.items() if not name.startswith("end.")}
    drives = list(drives_within(model))
    return found | {name: float(reduce(max, [peaks_of(drive, name) for drive in drives])) for name in (LIMITS if drives else ())}


def _others(model: Any, V: float) -> list[str]:
    """A sentence where other starts lead to another mean velocity."""
    machine = machine_of(model)
    if not machine.is_single:
        return []
    speed, at = float(machine.free_velocity), coordinates(model)
    kick = [0.0 if name != "v" else 1.0 for name in at.names]
    start = at.start(np.outer([speed, -speed], kick)) if "v" in at.names else {}
    found = results_of(spread_over(model, 2), 2, start=start)["mean_velocity"]
    other = [float(v) for v in found if abs(v - V) > _SAME * max(abs(V), speed)]
    return [f"another motion coexists, with V = {v:.6g} m/s from another start" for v in other[:1]]


def _active_limits(limits: list[Limit], values: dict[str, Any]) -> list[str]:
    return [limit.name for limit in limits if limit.name in values and np.min(limit.margins(values[limit.name])) <= _ACTIVE]


def _active_bounds(space: Unknowns, u: Array) -> list[str]:
    numbers = [(each, float(u[place.start])) for each, place in zip(space.varied, space.slices, strict=True) if each.form is None]
    return [each.name for each, value in numbers if min(value, 1.0 - value) <= _ACTIVE]


def _sensitivities(model: Any, worth: Candidates, notes: list[str]) -> Gradient:
    """Derivatives by all numbers but those of waveforms."""
    forms = [each.leaves[0] + "." for each in worth.space.varied if each.form is not None]
    try:
        names = [name for name in directions_of("optimise", model, None) if not name.startswith(tuple(forms))] if forms else None
        return gradient(model, worth.quantity, names)
    except StickslipError as error:
        notes.append(f"no derivatives: {error}")
        return Gradient({}, worth.quantity, float("nan"), (str(error),))
