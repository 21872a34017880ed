"""Steady motion: its mean velocity, and after how many drive periods it repeats."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, overload

import numpy as np

from stickslip.basics.arguments import Model, explains_arguments
from stickslip.basics.errors import InputError, is_whole
from stickslip.basics.interruption import interruptible
from stickslip.models.machine_adapter import machine_of
from stickslip.models.model_adapter import adapter_of
from stickslip.models.state_layout import of_one_contact
from stickslip.records import measures
from stickslip.records.record import Record
from stickslip.results import recurrence, steadiness
from stickslip.results.flow_drift import NO_BODIES
from stickslip.results.summary import Summary
from stickslip.results.trajectory import Trajectory
from stickslip.results.verbs import OfOneRun

if TYPE_CHECKING:
    from numpy.typing import NDArray


_FIRST = 60  # times a machine's own time: its first run, where it has no period
_CLOSE, _FINEST = 1e-9, 1e-10  # of its swing: how near a cycle comes back that has settled; tolerance of such runs under dynamic laws
_OF_TYPES = (0.75, 0.03)  # thresholds of motion types, on which no mean depends
#: Largest period number that is looked for.
LONGEST_PERIOD = recurrence.LONGEST


@overload
def mean_velocity(run: Trajectory | Record | OfOneRun, body: int | str | None = None, frequency: float | None = None) -> float: ...
@overload
def mean_velocity(run: Summary, body: None = None, frequency: None = None) -> NDArray[np.float64]: ...
@explains_arguments
def mean_velocity(run: Any, body: int | str | None = None, frequency: float | None = None) -> Any:
    r"""Mean steady velocity of a run, as the paper defines it; it is also its attribute ``run.mean_velocity``.

    .. math:: V = \frac{x(t_2) - x(t_1)}{t_2 - t_1}

    The window is the part after settling, or the whole run if the model has no period. If the motion repeats, it is a whole number of
    motion periods, not just of drive periods. For a machine of several bodies the velocity is that of their centre of mass, or of one of
    them; for a flow the mean rate of its first cyclic coordinate.

    Parameters
    ----------
    run : Trajectory, Summary, periodic orbit or Record
    body : int or str, optional
        Number (from 0) or name of one of several bodies (trajectories only).
    frequency : float, optional
        Of the drive of a Record [Hz]; else it comes from the record.

    Returns
    -------
    float or array
        V [m/s], of the shape of the batch.

    Raises
    ------
    InputError
        If the run ended within its first drive period, for example because contact was lost; in a batch the value is NaN.

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb-static"), periods=20)
    >>> round(ss.mean_velocity(run), 9)
    0.002032039
    >>> round(float(run.x[-1] / run.t[-1]), 9)  # of the whole run, with the start from rest
    0.002033485
    """
    if body is not None:
        return _of_body(run, body)
    if isinstance(run, Summary):
        return run.mean_velocity[()]
    if isinstance(run, Record):
        return measures.mean_velocity(run, frequency).value
    of_a_record("mean_velocity", run, frequency=frequency)
    if isinstance(run, OfOneRun):
        return run.mean_velocity
    if isinstance(run, Trajectory) and not run.pieces.layout.bodies:
        return run.mean_velocity
    is_run("mean_velocity", run)
    if run.model.period is not None and len(run.strobe_times) < 2:
        raise InputError("mean_velocity", [_too_short(run)])
    return run.steadiness.mean_velocity


def _of_body(run: Any, body: int | str) -> float:
    """Mean velocity of one body over the window of the mean."""
    if not isinstance(run, Trajectory):
        given = type(run).__name__
        raise InputError(
            "mean_velocity", [f"body = {body!r} of a {given}; allowed is a Trajectory; a {given} keeps one velocity; leave body out"]
        )
    names = list(run.body_columns)
    if body not in names and not (is_whole(body) and 0 <= int(body) < len(names)):
        raise InputError("mean_velocity", [f"body = {body!r}; allowed are {', '.join(map(repr, names))} or 0 to {len(names) - 1}"])
    of = run.body_columns[body if isinstance(body, str) else names[int(body)]]
    if run.model.period is None:
        inside = (run.t >= run.window[0]) & (run.t <= run.window[1])
        t, x = run.t[inside], of.x[inside]
    elif len(run.strobe_times) < 2:
        raise InputError("mean_velocity", [_too_short(run)])
    else:
        count = steadiness.window_count(len(run.strobe_times) - 1, int(run.settle), run.steadiness.period)
        t, x = run.strobe_times[-1 - count :], of.strobe_x[-1 - count :]
    return float((x[-1] - x[0]) / (t[-1] - t[0]))


def of_a_record(what: str, given: Any, **options: float | None) -> None:
    """Refuse options of measured records where something else was given."""
    for name, value in options.items():
        if value is not None:
            mistake = f"{name} = {value!r} is for a Record, and {type(given).__name__} given"
            raise InputError(what, [f"{mistake}, whose drive is known; type ss.{what}(run)"])


def is_run(what: str, run: Trajectory, bodies: bool = True) -> None:
    """Say what to type where something else than a run was given; with `bodies`, also of a run that has none."""
    if bodies and isinstance(run, Trajectory) and not run.pieces.layout.bodies:
        raise InputError(what, [NO_BODIES])
    if not hasattr(run, "settle"):
        raise InputError(what, [f"{type(run).__name__} given; allowed is a Trajectory; type for example ss.{what}(ss.solve(robot))"])
    if getattr(run, "interrupted", False):
        mistake = f"the run was {run.status}, and what is asked of it is that of the whole run"
        raise InputError(what, [f"{mistake}; type run.shortened() for the part that there is, or ss.solve again"])
    if bodies or run.pieces.layout.bodies:
        steadiness.of_its_machine(what, run)


def _too_short(run: Any) -> str:
    """Why a run has no mean velocity."""
    end = float(run.pieces.t[-1])
    reason = f"the run ended at t = {end:.6g} s ({run.status}), before its first drive period of {run.period_time:.6g} s was over"
    return f"{reason}, so it has no mean velocity; type run.x and run.v for the motion until then, or give more load or a smaller drive"


def velocity_range(run: Trajectory) -> tuple[float, float]:
    """Smallest and largest velocity of the steady motion: over its last motion period, or over the window of the mean where none is known.

    Parameters
    ----------
    run : Trajectory

    Returns
    -------
    tuple of float
        Lowest and highest velocity at the instants of the columns [m/s]. `mean_velocity` lies between them.

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb-static"), periods=40)
    >>> low, high = velocity_range(run)
    >>> low < ss.mean_velocity(run) < high
    True
    """
    run = needs_run("velocity_range", run, "it is the range of one velocity")
    if run.model.period is None:
        return _extremes(run, run.window[0])
    count = period_number(run) or _settled_count(run)
    return _extremes(run, run.pieces.t[-1] - count * run.period_time * (1 + 1e-12))


def _extremes(run: Trajectory, since: float) -> tuple[float, float]:
    v = run.v[run.t >= since]
    return float(v.min()), float(v.max())


def needs_run(what: str, run: Trajectory, why: str) -> Any:
    """A run of one body on one contact; what to type where something else was given, and `why` one of several cannot be taken."""
    is_run(what, run)
    return of_one_contact(what, run, why)


def _settled_count(run: Trajectory) -> int:
    """Drive periods in the window after settling."""
    return max(len(run.strobe_times) - 1 - int(run.settle), min(1, len(run.strobe_times) - 1))


def period_number(run: Any) -> int | None:
    """After how many drive periods the motion repeats: 1 to 16, or None if it does not (or not yet).

    The strobe points, taken once per drive period, must repeat within `strobe_tolerance`; and they must have stopped drifting:
    what is left of a geometric transient, judged by the last 47 points, must be below the tolerance too. Points that swing ever closer
    around a motion of half the period do not count as its double. `results.recurrence` has the rules; sweeps and maps use the same.

    Parameters
    ----------
    run : Trajectory or Summary

    Returns
    -------
    int or None
        For a batch an array, with 0 where none was found.
    """
    if isinstance(run, Summary):
        return run.period if run.period.ndim else (int(run.period) or None)
    return run.steadiness.period or None


@explains_arguments
@interruptible
def periodic_mean_velocity(model: Model, periods: int = 2000, rtol: float = 1e-12) -> float | NDArray[np.float64]:
    """Mean velocity of the periodic motion itself, free of transients.

    Where the motion is made of closed arcs (Coulomb friction and a harmonic drive) it comes from the closed formulas, to rounding. Any
    other robot is run until its strobe point is estimated to be within 3 rtol of the periodic one, in units of A mu omega
    (`free_velocity`). At the default the means of 240 random robots (LuGre, Dahl, Stribeck, viscous) are within 2e-12 A mu omega of those
    of long runs. A case that has not come so close after `periods`, because of rounding or slow convergence, is tried again with 100 and
    with 10,000 times that tolerance, and is NaN only after that. A machine without a period is run until it repeats, or is steady.

    Parameters
    ----------
    model : Robot
        One robot, or a batch.
    periods : int
        Longest run for robots without a closed formula; of a machine without a period in its own times (`time_scale`).
    rtol : float
        Tolerance of that run, and of the strobe point's return.

    Returns
    -------
    float or array
        V [m/s]; NaN where the motion did not repeat within `periods`.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb-static")
    >>> round(float(periodic_mean_velocity(robot)), 9)
    0.002032039
    """
    if not adapter_of(model).has_bodies:
        return _mean_of_flows(model, periods)
    if model.period is None:
        return _mean_of_cycles(model, periods, rtol)
    closed = closed_mean_velocity(model)
    if closed is not None:
        return closed
    from stickslip.basics.batch import shape_of, some_of
    from stickslip.solvers import solve

    shape = shape_of(model)
    means = np.full(int(np.prod(shape)), np.nan)
    for looser in (1.0, 1e2, 1e4):
        left = np.flatnonzero(np.isnan(means))
        if len(left):
            many: Any = solve(some_of(model, left), periods=periods, settle="auto", rtol=min(looser * rtol, 1e-3), keep="summary")
            means[left] = np.where(many.period > 0, many.mean_velocity, np.nan)
    return means.reshape(shape)[()]


def _mean_of_flows(flow: Any, periods: int) -> Any:
    """The same of flows with a cyclic coordinate: of runs in which strobe points repeat, or which end in a cycle."""
    from stickslip.analysis.flow_motion import flow_motion
    from stickslip.basics.batch import cases_of, shape_of
    from stickslip.solvers import solve

    if not flow.cyclic:
        why = "none of the states of the flow is a displacement; allowed is a flow of which one is"
        how = "type ss.SwitchingFlow(..., cyclic=('x',)), or ss.solve(flow, keep='summary', ...) for the means of its states"
        raise InputError("periodic_mean_velocity", [f"{why}; {how}"])

    def mean(case: Any) -> float:
        count = min(_FIRST, periods)
        while True:
            span: dict[str, Any] = {"periods": count} if case.period is not None else {"duration": float(count)}
            motion = flow_motion(solve(case, keep="trajectory", **span))
            if motion.settled or count >= periods:
                return motion.mean_velocity if motion.settled else np.nan
            count = min(2 * count, periods)

    return np.array([mean(case) for case in cases_of(flow)]).reshape(shape_of(flow))[()]


def _mean_of_cycles(model: Model, periods: int, rtol: float) -> Any:
    """The same of machines without a period: of the cycle, or the steady motion, that a run from rest ends in."""
    from stickslip.basics.batch import cases_of, shape_of

    return np.array([_mean_of_cycle(case, periods, rtol) for case in cases_of(model)]).reshape(shape_of(model))[()]


def _mean_of_cycle(model: Any, periods: int, rtol: float) -> float:
    """The same of one: of the shortest run that has come back closely, else of the longest that has settled; NaN where none has."""
    from stickslip.analysis.oscillation import oscillation
    from stickslip.solvers import solve

    machine = machine_of(model)
    if machine.time_scale is None:
        mistake = f"{type(model).__name__} has neither a period nor a time_scale, so it is not known how long to run it"
        raise InputError("periodic_mean_velocity", [f"{mistake}; give the class a time_scale, such as time_scale = 1.0"])
    options: dict[str, Any] = {"rtol": max(rtol, _FINEST)} if machine.has_inner_states else {}
    mean, length = np.nan, min(_FIRST, periods)
    while length <= periods:
        run = solve(model, duration=length * float(machine.time_scale), keep="trajectory", **options)
        m = oscillation(run, *_OF_TYPES)
        mean = m.mean_velocity if m.settled else mean
        if m.settled and m.change <= max(_CLOSE, 10.0 * rtol):
            break
        length = min(2 * length, periods) if length < periods else periods + 1
    return mean


def closed_mean_velocity(model: Model) -> Any:
    """V = A mu omega times the closed mean of w [m/s]; None where a case has no closed formula (it may slide down by itself).

    Parameters
    ----------
    model : Robot
        One robot, or a batch.

    Returns
    -------
    float, array or None
        NaN where the motion did not repeat.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.presets import coulomb_robot
    >>> round(float(closed_mean_velocity(coulomb_robot(0.4, 0.5))), 15)
    0.122475359974498
    >>> closed_mean_velocity(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4)) is None  # LuGre
    True
    """
    from stickslip.analysis.closed_form import periodic
    from stickslip.basics.batch import shape_of
    from stickslip.solvers.closed_arcs import dimensionless_arcs, handles

    if handles(model) is not None:
        return None
    arcs = dimensionless_arcs(model)
    driven = arcs.drive > 0
    resist, hold = (arcs.resist_plus, arcs.resist_minus), (arcs.hold_plus, arcs.hold_minus)
    if np.any(np.minimum(*hold) < 0) or np.any(driven & (np.minimum(*resist) < 0)):
        return None
    plus, minus, *static = (np.where(driven, r, 2.0) / np.where(driven, arcs.drive, 1.0) for r in (*resist, *hold))  # 2: no drive, at rest
    mean = periodic(plus, minus, static=(static[0], static[1])).mean
    return np.where(driven, mean * arcs.drive / arcs.omega, 0.0).reshape(shape_of(model))[()]
