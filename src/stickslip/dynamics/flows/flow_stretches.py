r"""A stretch of a switching flow: where it ends, its switches, and how small changes of its start grow on the way.

The compiled engine follows it by Taylor steps and carries the tangent of the flow along (`stickslip.engine.tangent`). A flow whose
functions cannot be called with symbols is followed by SciPy's integrator on plain Python, which is the judge of the engine too.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from stickslip.basics.arguments import explains_arguments
from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import InputError, Problems, is_number, is_one_of
from stickslip.basics.fields import floats
from stickslip.basics.frozen_arrays import sealed
from stickslip.models.switching_flow import SwitchingFlow, is_flow, knows_mode, unknown_mode
from stickslip.results.flow_pieces import extremes
from stickslip.solvers.flow_engine import FlowStart, check_flow, follow_flow, unknown
from stickslip.solvers.plain.composed_flows import check_judged, composed, mode_of_state
from stickslip.solvers.plain.judged_flows import passage_by_scipy

METHODS = ("auto", "exact", "dop853")
_TIGHTEST, _LOOSEST = 1e-13, 1e-2  # of rtol


@sealed
class Passage:
    """A stretch of a switching flow: where and when it ends, its switches, its derivative by the start, and its extremes.

    Parameters
    ----------
    state : array
        Where it ends.
    mode
        Initial mode.
    time : float
        When: after the duration, or at its last switch where `switches` ended it.
    events : list of tuple
        Its switches: instant, mode before, mode after.
    monodromy : array
        The derivative of the end by the start; nan where the flow touches a guard without crossing it, where there is none.
    rank_deficient : bool
        Whether a switch wiped out a direction.
    lowest, highest : array
        Of each coordinate, also between the integrator's steps.
    method : str
        "exact" by the compiled engine, "dop853" by SciPy's integrator.
    why : str
        Why the engine could not follow it, where that was so.
    """

    state: Array
    mode: Any
    time: float
    events: Sequence[tuple[float, Any, Any]]
    monodromy: Array
    rank_deficient: bool
    lowest: Array
    highest: Array
    method: str = "exact"
    why: str = ""


@explains_arguments
def passage(
    flow: SwitchingFlow, state: ArrayLike, mode: Any, duration: float, begin: float = 0.0, rtol: float = 1e-12, switches: int | None = None,
    method: str = "auto",
) -> Passage:  # fmt: skip
    """Integrate a switching flow together with its tangent equations.

    Parameters
    ----------
    flow : SwitchingFlow
    state : array
        Initial state. Beyond a guard the flow switches immediately.
    mode
        Initial mode.
    duration : float
        Longest duration.
    begin : float
        Initial time.
    rtol : float
        Tolerance of SciPy's integrator; the engine's steps are exact to rounding, or hold 1e-9 under laws with inner states.
    switches : int, optional
        Number of switches after which it ends.
    method : {"auto", "exact", "dop853"}
        "exact" is the compiled engine, "dop853" SciPy's integrator on plain Python, some thousand times slower: the second opinion.
        "auto" takes the engine wherever it can call the flow's functions with symbols; `Passage.method` says which it was.

    Returns
    -------
    Passage
        State, mode and time at the end, the switches on the way, the monodromy matrix and the extremes.

    Raises
    ------
    InputError
        For a mode that is not known, or a field, guard or reset that does not give numbers.
    SolveError
        If switches accumulate: the flow chatters, or comes to rest in infinitely many jumps of decreasing length (Zeno); and after 10
        000 switches, if `switches` does not say how many.

    Examples
    --------
    >>> half = passage(SwitchingFlow({0: lambda t, y: (-y[0],)}), [1.0], 0, np.log(2.0))
    >>> round(float(half.state[0]), 12), round(float(half.monodromy[0, 0]), 12), round(half.time, 12)
    (0.5, 0.5, 0.69314718056)
    """
    y = started(flow, FlowStart(state, mode, begin), duration, rtol, switches, method=method)  # type: ignore[arg-type]
    why = unknown(flow, len(y)) if method != "dop853" else ""
    if method == "exact" and why:
        raise InputError("passage", [f'method = "exact" cannot follow the flow: {why}; type method="auto"'])
    if method == "dop853" or why:
        check_judged(flow)
        plain, mode = composed(flow), mode_of_state(flow, y, float(begin), mode)
        end, last, t, events, M, rank_deficient, low, high = passage_by_scipy(plain, y, mode, float(duration), float(begin), rtol, switches)
        return Passage(end, last, t, events, M, rank_deficient, low, high, "dop853", why)
    done = follow_flow(flow, FlowStart(y, mode, float(begin)), float(duration), switches)
    low, high = extremes(done.coefficients, np.vstack([y, done.passed, done.state]))
    return Passage(done.state, done.mode, done.time, done.events, done.growth, done.rank_deficient, low, high)


def touches(done: Passage) -> str:
    """That a passage touches a guard, and has no derivative."""
    at = ", ".join(f"{t:.9g}" for t, _, _ in done.events[-3:])
    return (
        f"the flow touches a guard without crossing it (its last switches are at t = {at}): perturbations grow there without bound, so "
        "there is no derivative; try another guess, or another value of the parameter"
    )


def needs_flow(what: str, value: Any, mistake: str) -> None:
    """Say what is wrong where something else than a flow was given."""
    if not is_flow(value):
        raise InputError(what, [f"{mistake}; type ss.SwitchingFlow({{0: lambda t, y: (y[1], -y[0])}})"])


def started(
    flow: Any, start: FlowStart, duration: Any, rtol: Any, switches: Any = None, what: str = "passage", method: Any = "auto"
) -> Array:
    """The state at the start; an error that says everything that is wrong with what was given."""
    problems, (state, mode, begin) = Problems(what), start
    needs_flow(what, flow, f"{flow!r} is not a flow; allowed is a SwitchingFlow")
    y = np.atleast_1d(np.array(floats(state)))
    if y.ndim != 1 or not len(y) or not np.isfinite(y).all():
        problems.add(f"state = {state!r}; allowed is a list of finite numbers, one for each coordinate; type for example [0.5, 0.0]")
    if not knows_mode(flow.start_modes, mode):
        problems.add(f"mode: {unknown_mode(mode, flow.start_modes)}")
    if not (is_number(duration) and duration > 0):
        problems.add(f"duration = {duration!r}; allowed is a positive finite number")
    if not is_number(begin):
        problems.add(f"begin = {begin!r}; allowed is a finite number")
    if not (is_number(rtol) and _TIGHTEST <= rtol <= _LOOSEST):
        problems.add(f"rtol = {rtol!r}; allowed is a number from {_TIGHTEST:g} to {_LOOSEST:g}; type rtol=1e-12")
    if switches is not None:
        problems.whole("switches", switches, 1, example=100)
    if not is_one_of(method, METHODS):
        problems.add(f"method = {method!r}; allowed are {', '.join(map(repr, METHODS))}")
    if len(y) and flow.states is not None and len(names := flow.names(len(flow.states) + len(flow.inner))) != len(y):
        problems.add(f"state = {state!r} has {len(y)} numbers; allowed are {len(names)}: {', '.join(names)}")
    if any(np.ndim(value) for value in flow.numbers.values()):
        problems.add("numbers of the flow are arrays; allowed is one number each; type flow.replace(name=0.5)")
    problems.check()
    check_flow(flow, len(y))
    return y
