"""Solvers: `solve` picks the method and says what it did. Set-valued laws are solved exactly, dynamic laws by Rosenbrock steps."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, overload

from stickslip.arguments import Model, explains_arguments
from stickslip.engine.refused import refused
from stickslip.errors import InputError
from stickslip.machine import machine_of
from stickslip.solvers.request import Request, request
from stickslip.summary import Summary
from stickslip.trajectory import Trajectory

__all__ = ["METHODS", "solve"]

#: Names for `method=`; "auto" takes the exact solver for set-valued laws, else Rodas4 or Rodas5P by tolerance.
METHODS = ("auto", "exact", "rodas4", "rodas5p", "rk4", "radau", "lsoda", "bdf", "dop853")


@overload
def solve(model: Any, periods: int | None = ..., *, keep: Literal["trajectory"], **arguments: Any) -> Trajectory: ...
@overload
def solve(model: Any, periods: int | None = ..., *, keep: Literal["summary"], **arguments: Any) -> Summary: ...
@overload
def solve(
    model: Any, periods: int | None = ..., settle: int | str | None = ..., rtol: float = ..., **arguments: Any
) -> Trajectory | Summary: ...
@explains_arguments
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
    **options: Any,
) -> Trajectory | Summary:
    r"""Simulate a robot or a mechanism, or every one of a batch, from its start.

    Parameters
    ----------
    model : Robot or PulledMass, BlockOnBelt, ForcedOscillator
        What to solve. If any of its numbers is an array it is a batch, and the result has that shape.
    periods : int, optional
        Drive periods to simulate, 200 if neither this nor `duration` is given.
    settle : int or "auto", optional
        Drive periods that the mean velocity leaves out; ``None`` is the first half. "auto" (batches) stops a case as soon
        as its strobe point repeats, at most after `periods`.
    rtol : float
        Relative tolerance for dynamic laws, 1e-3 to 1e-12. Exact arcs do not need it.
    start : dict
        Start values of ``x`` [m], ``v`` [m/s], inner states ``z`` [m] and, of a law that remembers, its whole numbers ``memory``; what is
        left out is zero. Arrays broadcast with the batch. Where a law has several of ``z`` or of ``memory`` their shape is (batch, count):
        the last axis holds them, and one number stands for all of them.
    workers : int
        Threads for a batch. The result does not depend on it.
    keep : {"trajectory", "summary"}, optional
        What to return: everything that happened (one case), or the numbers. By default a trajectory for one case.
    samples : int
        Instants per period in the columns of a trajectory; a model that has no period gets ten times as many in all.
    method : str
        One of `METHODS`.
    slip_ratio, dwell : float
        When a dynamic law counts as stuck, see `stickslip.motion`; used for the motion types of a batch.
    progress : callable or bool, optional
        True for a line on the terminal, or what is called with (cases begun, cases in all).
    duration : float, optional
        How long to simulate [s], instead of `periods`. A model that has no period needs it. A batch of periodic models cannot take it.
    observe : dict of Observable, optional
        Columns of your own for a batch, by name: see `observable`.
    **options
        Options of the method: ``steps`` per period for "rk4".

    Returns
    -------
    Trajectory or Summary

    Raises
    ------
    InputError
        Everything that is wrong with the arguments, at once.
    SolveError
        A single trajectory that could not be finished. In a batch this is a status of the case.

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb"), periods=20)
    >>> f"{ss.mean_velocity(run):.6f} m/s"
    '0.002015 m/s'
    """
    todo = request(
        model, periods, settle, rtol, start, workers, keep, samples, method, slip_ratio, dwell, progress, options, duration, observe
    )
    return _solver(todo)(todo)


def _solver(todo: Request) -> Callable[[Request], Any]:
    """The function that does what was asked."""
    name, machine = todo.method, machine_of(todo.model)
    laws = machine.law_names
    if not all(law.compiles for law in machine.laws) and name in ("rk4", "rodas4", "rodas5p"):
        raise InputError("solve", [f'method = {name!r} is compiled, and {laws} is written for plain numbers only; type method="auto"'])
    if name == "rk4" and not machine.is_single:
        kind = type(todo.model).__name__
        raise InputError("solve", [f'method = "rk4" takes one body on one contact, and {kind} lists several; type method="auto"'])
    why = refused(todo.model)
    if todo.observe and (why or name not in ("auto", "exact", "rosenbrock", "rodas4", "rodas5p")):
        what = why or f'method = {name!r} is none of them; type method="auto"'
        raise InputError("solve", [f"observe is for the compiled methods: {what}"])
    if name == "auto":
        name = "dop853" if why else "rosenbrock" if machine.has_inner_states else "exact"
    elif why and name in ("exact", "rk4", "rodas4", "rodas5p"):
        raise InputError("solve", [f"method = {name!r} does not solve this {type(todo.model).__name__}: {why}"])
    if name == "exact":
        from stickslip.solvers import exact

        if machine.has_inner_states:
            raise InputError("solve", [f'method = "exact" is for set-valued laws; {laws} has inner states; type method="auto"'])
        return exact.solve
    if name in ("rosenbrock", "rodas4", "rodas5p"):
        from stickslip.solvers import rosenbrock

        if not machine.has_inner_states:
            raise InputError("solve", [f'method = {todo.method!r} is for laws with inner states; {laws} is set-valued; type method="auto"'])
        return rosenbrock.solve
    if name == "rk4":
        from stickslip.solvers import rk4

        return rk4.solve
    from stickslip.solvers import plain

    return plain.solve
