"""Solvers: `solve` chooses the method and names it. Set-valued laws are solved exactly, dynamic laws to a tolerance.

A *set-valued* law (`sliding` and `breakaway`) is a machine of three modes: stuck, forward and backward slip. In each the motion
is analytic. Where the traced accelerations are one sine of the period and a constant for each mode, the arcs are closed
formulas; all else goes by Taylor steps, whose events are zeros of polynomials, exact to rounding; of
rows of many bodies what moves together steps by itself. A *dynamic* law (`rate` and
`force`) is stiff: Taylor series on the slow manifold where its rate is affine in the state, else Rosenbrock steps that end on
guards. A law *with discrete memory* (`modes`, `switches`) is the same with flags that guards switch.

`simulation` is a machine that goes on step by step, in a loop of its user's, with the steps of the same methods: `moments` has the step
from one moment to the next, `held_machines` and `held_flows` what its lane follows. `followed` takes many cases through the instants at
which a recorded command changes.

`methods` has the methods as objects; the first that accepts the equations runs. `plain` is the judge: SciPy on the same
mechanics in Python floats, which shares no line with the engine (`equations` in one mode, `guards` that end it, `choosing` and
`deciding` of the next one, `hits`, `kinks`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Literal, overload

from stickslip.basics.arguments import Model, explains_arguments
from stickslip.basics.interruption import accept_part, interruptible, is_asked_to_end, taking_some_cases
from stickslip.results.summary import Summary
from stickslip.results.trajectory import Trajectory
from stickslip.solvers.methods import METHODS, method_for
from stickslip.solvers.named_events import Watch, event_columns_of_cases, events_of_model, watching, with_events
from stickslip.solvers.request import request
from stickslip.solvers.settings import Settings

__all__ = ["METHODS", "solve", "solved"]


@overload
def solve(model: Model, periods: int | None = ..., *, keep: Literal["trajectory"], **arguments: Any) -> Trajectory: ...
@overload
def solve(model: Model, periods: int | None = ..., *, keep: Literal["summary"], **arguments: Any) -> Summary: ...
@overload
def solve(
    model: Model, periods: int | None = ..., settle: int | str | None = ..., rtol: float = ..., **arguments: Any
) -> Trajectory | Summary: ...
@explains_arguments
@interruptible
def solve(
    model: Model,
    periods: int | None = None,
    settle: int | str | None = None,
    rtol: float = 1e-6,
    start: dict[str, Any] | None = None,
    workers: int = 1,
    keep: str | None = None,
    samples: int = 400,
    method: str = "auto",
    slip_ratio: float = 0.75,
    dwell: float = 0.03,
    progress: Callable[[int, int], None] | bool | None = None,
    duration: float | None = None,
    observe: dict[str, Any] | None = None,
    events: dict[str, Any] | None = None,
    **options: Any,
) -> Trajectory | Summary:
    r"""Simulate a robot or a mechanism, or every case of a batch, from its initial state.

    Parameters
    ----------
    model : Robot or PulledMass, BlockOnBelt, ForcedOscillator, a machine of several bodies, or a SwitchingFlow
        The model. If any of its numbers is an array, the model is a batch, and the result has the shape of the batch.
    periods : int, optional
        Drive periods to simulate, 200 if neither this nor `duration` is given.
    settle : int or "auto", optional
        Drive periods that the mean velocity excludes; ``None`` excludes the first half. "auto" (batches) stops a case as soon
        as its strobe point repeats, at most after `periods`.
    rtol : float
        Relative tolerance for dynamic laws, 1e-3 to 1e-12. Exact arcs do not need it.
    start : dict
        Start values of ``x`` [m], ``v`` [m/s], inner states ``z`` [m] and, for a law with memory, its integers ``memory``; values that are
        not given are zero. Arrays broadcast with the batch. If a law has several of ``z`` or of ``memory``, their shape is (batch, count),
        with the values along the last axis; a single number applies to all of them. For a `SwitchingFlow` its states by name, or a list of
        them.
    workers : int
        Threads for a batch. The result does not depend on it.
    keep : {"trajectory", "summary"}, optional
        The result: the complete trajectory (one case), or its numbers. By default a trajectory for one case.
    samples : int
        Instants per period in the columns of a trajectory; for a model without a period, ten times this number over the whole run.
    method : str
        One of `METHODS`.
    slip_ratio, dwell : float
        Thresholds below which a dynamic law counts as stuck, see `stickslip.motion`; used for the motion types of a batch.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with (cases begun, cases in all), for one run with drive periods; return
        False to stop, which does what Ctrl-C does: a run ends there, with the status "interrupted at t = ...", and the cases of a batch
        that are not finished have the status "not computed".
    duration : float, optional
        How long to simulate [s], instead of `periods`. Required for a model without a period, not allowed for a batch of periodic
        models.
    observe : dict of Observable, optional
        User-defined columns for a batch, by name: see `observable`.
    events : dict, optional
        Events of your own by name: functions of the state whose passages through zero are found to the last digits of the run, such as
        ``{"passes the mark": lambda s: s.x - 1.0}``. The state ``s`` is that of `observable`; of a `SwitchingFlow` the function takes
        (t, y), or (t, y, n), as a guard does. ``(function, "rises")`` or ``(function, "falls")`` takes one direction, and with ``"ends"``
        behind it the run ends there. They are among the events of a run, and in its `named_events`; a batch has the columns
        ``first_passes_the_mark`` [s] and ``number_passes_the_mark``.
    **options
        Options of the method: ``steps`` per period for "rk4"; for a `SwitchingFlow` the initial ``mode``, which follows from its state
        if not given.

    Returns
    -------
    Trajectory or Summary

    Raises
    ------
    InputError
        All errors of the arguments, reported together.
    SolveError
        If a single trajectory could not be completed; in a batch the status of the case says so.

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb-static"), periods=20)
    >>> f"{ss.mean_velocity(run):.6f} m/s"
    '0.002032 m/s'
    """
    settings = Settings(
        periods=periods,
        settle=settle,
        rtol=rtol,
        start=start,
        workers=workers,
        keep=keep,
        samples=samples,
        method=method,
        slip_ratio=slip_ratio,
        dwell=dwell,
        progress=progress,
        duration=duration,
        observe=observe,
        events=events,
        options=options,
    )
    return _solved(model, settings)


@interruptible
def solved(model: Model, settings: Settings, watch: Watch | None = None, left_out: float = 0.0) -> Trajectory | Summary:
    """The same as `solve`, of arguments that travel together.

    The cases of a batch are shown to `watch`, and without a period settle for the time `left_out` before their numbers.
    """
    return _solved(model, settings, watch, left_out)


def events_of_cases(model: Model, settings: Settings) -> dict[str, Any]:
    """For each event of the settings its first instant and its number in every case of a batch, by name."""
    todo = request(model, settings)
    return event_columns_of_cases(todo, events_of_model("solve", model, settings.events), method_for(todo.method, todo.model).run)


def _solved(model: Model, settings: Settings, watch: Watch | None = None, left_out: float = 0.0) -> Trajectory | Summary:
    with taking_some_cases():
        todo = request(model, settings)
        if left_out:
            todo = replace(todo, left_out=left_out)
        events, method = events_of_model("solve", model, settings.events), method_for(todo.method, todo.model, bool(todo.observe))
        todo = watching(todo, events, watch)
        result = with_events(todo, method.run(todo), events, method.run)
        if todo.partial and is_asked_to_end() and result.interrupted:
            accept_part()
        return result
