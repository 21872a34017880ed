"""The arguments of `solve` for a switching flow, checked once."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.batch import Labels, cases_of, labels_of, spread_over_cases
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems, did_you_mean, is_one_of, is_whole
from stickslip.basics.fields import number
from stickslip.basics.interruption import is_outermost, takes_some_cases
from stickslip.basics.progress import reporting
from stickslip.models.switching_flow import knows_mode, unknown_mode
from stickslip.solvers.flow_engine import steps_of_flow, traced_flow
from stickslip.solvers.flow_starts import starting_modes
from stickslip.solvers.settings import Request, Settings, check_duration, check_keep, check_rtol, periods_begun

if TYPE_CHECKING:
    from stickslip.models.switching_flow import SwitchingFlow


_OF_MACHINES = ("slip_ratio", "dwell", "observe")


def flow_request(flow: SwitchingFlow, settings: Settings) -> Request:
    """Check the arguments of `solve` for a flow; everything wrong with them is reported at once."""
    problems, given = Problems("solve"), settings
    check_rtol(given.rtol, problems)
    problems.whole("workers", given.workers, 1, example=2)
    for name in (name for name in given.differing() if name in _OF_MACHINES):
        problems.add(f"{name} is not known of a flow; leave it out")
    labels, mode = labels_of(flow), given.options.get("mode")
    _check_names(flow, labels, mode, given, problems)
    states = starts_of(flow, given.start, labels, problems)
    lengths = _lengths(flow, labels, given, problems)
    problems.check()
    modes = starting_modes(flow, states, mode, one=not labels.shape)
    equations = traced_flow(flow, states.shape[1])
    if equations.why:
        raise InputError("solve", [untraced(equations.why)])
    keep = given.keep or ("summary" if labels.shape else "trajectory")
    return Request(
        model=flow,
        labels=labels,
        auto=False,
        rtol=steps_of_flow(flow)[1],
        start=states,
        given_start=dict(zip(flow.names(states.shape[1]), map(float, states[0]), strict=True)) if not labels.shape else {},
        workers=int(given.workers),
        keep=keep,
        samples=int(given.samples),
        method=given.method,
        slip_ratio=given.slip_ratio,
        dwell=given.dwell,
        progress=reporting(given.progress, "solve"),
        options=given.options,
        numbers=dict(flow.numbers),
        partial=is_outermost() if keep == "trajectory" else takes_some_cases(),
        modes=modes,
        equations=equations,
        **lengths,
    )


def _check_names(flow: SwitchingFlow, labels: Labels, mode: Any, given: Settings, problems: Problems) -> None:
    """Note options and modes that a flow does not know, and methods that do not follow it."""
    for name in given.options:
        if name != "mode":
            problems.add(
                f"{name!r} is not an argument of solve for a flow; {did_you_mean(name, ('mode', 'start', 'duration', 'periods', 'settle'))}"
            )
    if mode is not None and not knows_mode(flow.start_modes, mode):
        problems.add(f"mode: {unknown_mode(mode, flow.start_modes)}")
    if not is_one_of(given.method, ("auto", "exact")):
        judge = 'for the second opinion of SciPy\'s integrator type ss.dynamics.passage(flow, state, mode, duration, method="dop853")'
        problems.add(f'method = {given.method!r}; allowed for a flow are "auto" and "exact"; {judge}')
    check_keep(given.keep, labels, problems)
    problems.whole("samples", given.samples, 4, example=200)


def _lengths(flow: SwitchingFlow, labels: Labels, given: Settings, problems: Problems) -> dict[str, Any]:
    """How long each case is followed, in periods of the forcing or in time, and how much of that is left out of its numbers."""
    periods, settle, duration = given.periods, given.settle, given.duration
    T = None if flow.period is None else spread_over_cases(flow.period, labels)
    if duration is not None:
        duration = float(duration) if check_duration(duration, periods, problems) else 1.0
        if settle not in (None, 0, "auto"):
            problems.add(f"settle = {settle!r} counts periods, and duration= is given; leave settle out, or give periods=")
        begun = 1 if T is None else periods_begun(duration, float(np.min(T)))
        return {"periods": begun, "settle": 0, "duration": duration, "span": np.full(labels.cases, duration) if T is None else T}
    if T is None:
        problems.add("the flow has no period, so periods does not say how long to run; type duration=60.0")
        return {}
    periods = 200 if periods is None else periods
    problems.whole("periods", periods, 1, example=200)
    if not is_whole(periods) or periods < 1:
        return {}
    left = periods // 2 if settle is None or is_one_of(settle, ("auto",)) else settle
    if not is_whole(left) or not 0 <= left < periods:
        problems.add(f"settle = {settle!r}; allowed is a whole number from 0 below periods = {periods!r}, or None")
        return {}
    return {"periods": int(periods), "settle": int(left), "duration": None, "span": T}


def starts_of(flow: Any, start: Any, labels: Labels, problems: Problems) -> Array:
    """The states in which the cases begin (cases, n), from a dict by name or from numbers along the last axis."""
    named = isinstance(start, Mapping) or (start is None and flow.states is not None)
    own, inner = _named_starts(flow, start or {}, labels, problems) if named else _listed_starts(flow, start, labels, problems)
    if not flow.inner or problems.mistakes:
        return np.column_stack([own, *inner.values()]) if inner else own
    begun = np.array([case.inner_start(y) for case, y in zip(cases_of(flow) if labels.shape else [flow], own, strict=True)])
    return np.column_stack([own, *(inner.get(name, begun[:, k]) for k, name in enumerate(flow.inner))])


def _listed_starts(flow: Any, start: Any, labels: Labels, problems: Problems) -> tuple[Array, dict[str, Array]]:
    """States of the field from numbers along the last axis, and those of laws by name where they stand behind them."""
    inner = len(flow.inner)
    try:
        array = np.asarray(number(start), float)
        n = len(flow.states) if flow.states is not None else array.shape[-1]
        if array.ndim and array.shape[-1] in (n, n + inner) and n and np.all(np.isfinite(array)):
            n = n if array.shape[-1] == n else n + inner
            table = np.broadcast_to(array, (*labels.shape, n)).reshape(-1, n) + 0.0
            if flow.states is None or n == len(flow.states):
                return table, {}
            return table[:, : n - inner], dict(zip(flow.inner, table[:, n - inner :].T, strict=True))
    except (TypeError, ValueError, IndexError):
        pass
    allowed = (
        "a list of finite numbers, one for each coordinate"
        if flow.states is None
        else f"finite numbers for {', '.join(flow.states)}, or a dict of them"
    )
    problems.add(f"start = {start!r}; allowed is {allowed}; type for example start=[0.5, 0.0]")
    return np.zeros((labels.cases, 1)), {}


def _named_starts(flow: Any, start: Any, labels: Labels, problems: Problems) -> tuple[Array, dict[str, Array]]:
    states = flow.states or flow.names(len(start))[: len(start) - len(set(flow.inner) & set(start))]
    if flow.states is None and not set(states) <= set(start):
        problems.add(
            f"start = {start!r}, but the states of the flow have no names; type start=[0.5, 0.0], or give the flow states=('x', 'v')"
        )
        return np.zeros((labels.cases, 1)), {}
    table, inner = np.zeros((labels.cases, len(states))), {}
    for name, value in start.items():
        if name not in (*states, *flow.inner):
            problems.add(f"start has no {name!r}; {did_you_mean(str(name), (*states, *flow.inner))}")
            continue
        try:
            column = spread_over_cases(number(value), labels)
        except (TypeError, ValueError) as error:
            problems.add(f"start {name} = {value!r}; allowed is a finite number, or one for each case ({error})")
            continue
        if name in flow.inner:
            inner[name] = np.broadcast_to(column, (labels.cases,)) + 0.0
        else:
            table[:, states.index(name)] = column
    if not np.isfinite(table).all():
        problems.add(f"start = {start!r} has numbers that are not finite")
    return table, inner


def untraced(why: str) -> str:
    """Why the engine cannot follow a flow, and what to type."""
    judge = "type ss.dynamics.passage(flow, state, mode, duration), which SciPy's integrator follows on plain Python"
    return (
        f"the engine cannot call the flow's functions with symbols: {why}; write them in plain arithmetic with stickslip.maths, or {judge}"
    )
