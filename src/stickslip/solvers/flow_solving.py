"""`solve` of a switching flow: one run with its dense output, or numbers of every case of a batch."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.batch import Labels, cases_of, labels_of, spread_over_cases
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems, SolveError, did_you_mean, is_one_of, is_whole
from stickslip.basics.fields import number
from stickslip.basics.interruption import accept_part, is_outermost, is_stopped, look, partial_result
from stickslip.basics.progress import reporting
from stickslip.basics.status import Status, interrupted_at
from stickslip.engine.texts import recurrence
from stickslip.models.switching_flow import knows_mode, unknown_mode
from stickslip.results.flow_run import FlowRun, extremes, polynomials
from stickslip.results.summary import Summary
from stickslip.solvers.flow_engine import FlowEquations, follow_flow, traced_flow
from stickslip.solvers.plain.composed_flows import mode_of_state
from stickslip.solvers.request import check_duration, check_keep, check_rtol, versions
from stickslip.solvers.stopped import FAILURES

if TYPE_CHECKING:
    from stickslip.basics.progress import Reported
    from stickslip.models.switching_flow import SwitchingFlow


_LONGEST = 32  # periods after which a motion may repeat
_SAME = 1e-8  # of its size: strobe points this close are one
#: Arguments that are of machines alone, with the values that say nothing.
_OF_MACHINES = {
    "slip_ratio": 0.75, "dwell": 0.03, "observe": None, "continue_along": None, "out": None, "resume": False, "shard": None, "tile": None,
    "client": None, "retries": 3,
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Asked:
    """Arguments of `solve` in their final form."""

    flow: Any
    labels: Labels
    states: Array  # (cases, n)
    mode: Any
    spans: Array  # (cases,) how long each is followed
    settled: Array  # (cases,) what of it the numbers leave out
    periods: int | None
    settle: int
    samples: int
    keep: str
    equations: FlowEquations


def solve(
    flow: Any,
    periods: Any,
    settle: Any,
    start: Any,
    keep: Any,
    samples: Any,
    method: Any,
    progress: Reported | bool | None,
    duration: Any,
    options: dict[str, Any],
    rtol: Any,
    workers: Any,
    of_machines: dict[str, Any],
) -> Any:
    """A `FlowRun` of one case, or the `Summary` of a batch."""
    problems = Problems("solve")
    check_others(rtol, workers, of_machines, problems)
    asked = asked_of(flow, periods, settle, start, keep, samples, method, duration, options, problems)
    if asked.keep == "trajectory":
        return _run(asked, start)
    return _summary(asked, reporting(progress, "solve"))


def check_others(rtol: Any, workers: Any, of_machines: dict[str, Any], problems: Problems) -> None:
    """Checks arguments that do not affect a flow: its steps are exact to rounding, and it has no friction."""
    check_rtol(rtol, problems)
    problems.whole("workers", workers, 1, example=2)
    for name in [name for name, value in of_machines.items() if value is not _OF_MACHINES[name] and value != _OF_MACHINES[name]]:
        why = ", whose sweeps are kept in memory" if name in ("out", "resume", "shard") else ""
        problems.add(f"{name} is not known of a flow{why}; leave it out")


def asked_of(
    flow: SwitchingFlow, periods: Any, settle: Any, start: Any, keep: Any, samples: Any, method: Any,
    duration: Any, options: Any, problems: Problems | None = None,
) -> Asked:  # fmt: skip
    """Check the arguments of `solve`; everything wrong with them is reported at once, after the problems that there are."""
    problems = Problems("solve") if problems is None else problems
    labels, mode = labels_of(flow), options.get("mode", next(iter(flow.fields)))
    for name in options:
        if name != "mode":
            problems.add(
                f"{name!r} is not an argument of solve for a flow; {did_you_mean(name, ('mode', 'start', 'duration', 'periods', 'settle'))}"
            )
    if not knows_mode(flow.start_modes, mode):
        problems.add(f"mode: {unknown_mode(mode, flow.start_modes)}")
    if not is_one_of(method, ("auto", "exact")):
        judge = 'for the second opinion of SciPy\'s integrator type ss.passage(flow, state, mode, duration, method="dop853")'
        problems.add(f'method = {method!r}; allowed for a flow are "auto" and "exact"; {judge}')
    check_keep(keep, labels, problems)
    problems.whole("samples", samples, 4, example=200)
    states = starts_of(flow, start, labels, problems)
    spans, settled, periods, left = _spans(flow, labels, periods, settle, duration, problems)
    problems.check()
    mode_of_state(cases_of(flow)[0] if labels.shape else flow, states[0], mode=mode)  # which says what no contact can do
    equations = traced_flow(flow, states.shape[1])
    if equations.why:
        raise InputError("solve", [untraced(equations.why)])
    check_start(flow, states, mode, one=not labels.shape)
    keep = keep or ("summary" if labels.shape else "trajectory")
    return Asked(flow, labels, states, mode, spans, settled, periods, left, int(samples), keep, equations)


def check_start(flow: SwitchingFlow, states: Array, mode: Any, one: bool = False) -> None:
    """`InputError` for a start beyond a guard of its mode whose switch would change the state at t = 0; `one` of a flow of single numbers.

    Examples
    --------
    >>> import stickslip as ss
    >>> hit = ss.Switch(lambda t, y: y[0], to="air", reset=lambda t, y: (0.0, -0.8 * y[1]))
    >>> ball = ss.SwitchingFlow({"air": lambda t, y: (y[1], -9.81)}, {"air": (hit,)})
    >>> check_start(ball, np.array([[1.0, 0.0]]), "air")
    """
    for case, y in zip([flow] if one else cases_of(flow), states, strict=True):
        plain, y = case.plain, y[: len(y) - len(case.inner)]
        base = case.labels[mode][0] if knows_mode(case.labels, mode) else mode
        beyond = _beyond(plain, base, y)
        if beyond is None:
            continue
        k, value = beyond
        switch = plain.switches[base][k]
        after = y if switch.reset is None else _called(switch.reset, y)
        if after is None or not np.any(after != y):
            continue
        within = [each for each in plain.fields if _beyond(plain, each, y) is None]
        typed = f"type mode={within[0]!r}, in which it is within the guards" if within else "give another start"
        start = f"the run begins in mode {mode!r} at {y.tolist()}, beyond the guard of switches[{mode!r}][{k}], which is {value:.6g} there"
        mistake = f"{start}: at t = 0 its reset would make {after.tolist()} of the start"
        allowed = "allowed is a start at which the guards of its mode are positive"
        raise InputError("solve", [f"{mistake}; {allowed}; {typed}, or start={after.tolist()} for the state after the reset"])


def _beyond(flow: SwitchingFlow, mode: Any, y: Array) -> tuple[int, float] | None:
    """The first switch of a mode whose guard is below zero at a start, and its guard."""
    values = [(k, _called(switch.guard, y)) for k, switch in enumerate(flow.switches.get(mode, ()))]
    return next(((k, float(g[0])) for k, g in values if g is not None and g[0] < 0.0), None)


def _called(f: Any, y: Array) -> Array | None:
    """What a function gives at a start, as an array; None where that is not known."""
    try:
        return np.atleast_1d(np.array(f(0.0, y.copy()), float))
    except Exception:  # said where the run comes to it
        return None


def _spans(flow: Any, labels: Labels, periods: Any, settle: Any, duration: Any, problems: Problems) -> tuple[Array, Array, int | None, int]:
    """How long each case is followed, how much of that is left out of its numbers, and both in periods of the forcing."""
    cases = labels.cases
    T = None if flow.period is None else spread_over_cases(flow.period, labels)
    if duration is not None:
        duration = float(duration) if check_duration(duration, periods, problems) else 1.0
        if settle not in (None, 0, "auto"):
            problems.add(f"settle = {settle!r} counts periods, and duration= is given; leave settle out, or give periods=")
        return np.full(cases, duration), np.zeros(cases), None, 0
    if T is None:
        problems.add("the flow has no period, so periods does not say how long to run; type duration=60.0")
        return np.ones(cases), np.zeros(cases), None, 0
    periods = 200 if periods is None else periods
    problems.whole("periods", periods, 1, example=200)
    if not is_whole(periods) or periods < 1:
        return np.ones(cases), np.zeros(cases), None, 0
    left = periods // 2 if settle is None or is_one_of(settle, ("auto",)) else settle
    if not is_whole(left) or not 0 <= left < periods:
        problems.add(f"settle = {settle!r}; allowed is a whole number from 0 below periods = {periods!r}, or None")
        left = 0
    return periods * T, left * T, int(periods), int(left)


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
    if flow.states is None:
        problems.add(
            f"start = {start!r}, but the states of the flow have no names; type start=[0.5, 0.0], or give the flow states=('x', 'v')"
        )
        return np.zeros((labels.cases, 1)), {}
    table, inner = np.zeros((labels.cases, len(flow.states))), {}
    for name, value in start.items():
        if name not in (*flow.states, *flow.inner):
            problems.add(f"start has no {name!r}; {did_you_mean(str(name), (*flow.states, *flow.inner))}")
            continue
        try:
            column = spread_over_cases(number(value), labels)
        except (TypeError, ValueError) as error:
            problems.add(f"start {name} = {value!r}; allowed is a finite number, or one for each case ({error})")
            continue
        if name in flow.inner:
            inner[name] = np.broadcast_to(column, (labels.cases,)) + 0.0
        else:
            table[:, flow.states.index(name)] = column
    if not np.isfinite(table).all():
        problems.add(f"start = {start!r} has numbers that are not finite")
    return table, inner


def _run(asked: Asked, start: Any) -> FlowRun:
    flow, y = asked.flow, asked.states[0]
    done = follow_flow(flow, y, asked.mode, float(asked.spans[0]), growth=False, partial=is_outermost(), traced=asked.equations)
    status = Status.FINISHED.sentence
    if is_stopped() and done.time < float(asked.spans[0]):
        status = interrupted_at(done.time)
        accept_part()
    given = dict(zip(flow.names(len(y)), map(float, y), strict=True))
    return FlowRun(
        flow, done.nodes, done.modes, done.coefficients, done.passed, done.events, "exact", done.state, done.mode, asked.periods,
        asked.settle, status, asked.samples, given, {"versions": versions()}, {"steps": done.steps},
    )  # fmt: skip


def untraced(why: str) -> str:
    """Why the engine cannot follow a flow, and what to type."""
    judge = "type ss.passage(flow, state, mode, duration), which SciPy's integrator follows on plain Python"
    return (
        f"the engine cannot call the flow's functions with symbols: {why}; write them in plain arithmetic with stickslip.maths, or {judge}"
    )


def _summary(asked: Asked, progress: Any) -> Summary:
    rows: list[dict[str, Any]] = []
    failures: dict[tuple[int, ...], str] = {}
    with partial_result() as ending:
        for k, flow in enumerate(cases_of(asked.flow)):
            look()
            why: list[str] = []
            rows.append(flow_columns(flow, asked.states[k], asked.mode, float(asked.spans[k]), float(asked.settled[k]), why))
            if why and len(failures) < FAILURES:
                failures[tuple(map(int, np.unravel_index(k, asked.labels.shape)))] = why[0]
            progress(k + 1, len(asked.states))
    ending.needs(rows)
    lacking = dict.fromkeys(rows[0], np.nan) | {n: -1 for n in ("end_mode", "switches") if n in rows[0]}
    rows += [lacking | {"status": Status.NOT_COMPUTED} for _ in range(len(asked.states) - len(rows))]
    columns = {name: np.array([row[name] for row in rows]).reshape(asked.labels.shape) for name in rows[0]}
    settings = {"periods": asked.periods, "settle": asked.settle, "method": "exact"}
    return Summary(asked.flow, asked.labels, columns, {"settings": settings}, failures)


def flow_columns(flow: Any, y: Array, mode: Any, span: float, settled: float, why: list[str] | None = None) -> dict[str, Any]:
    """The numbers of one case: mean, smallest and largest value of each state after settling, the switches there, and where it ends.

    The message of a case that could not be followed is added to `why`.
    """
    names = flow.names(len(y))
    try:
        begin = 0.0
        if settled > 0.0:
            before = follow_flow(flow, y, mode, settled, growth=False)
            y, mode, begin = before.state, before.mode, settled
        done = follow_flow(flow, y, mode, span - settled, begin, growth=False)
    except SolveError as error:
        if why is not None:
            why.append(str(error))
        unsolved = {f"{what}_{name}": np.nan for what in ("mean", "min", "max", "end") for name in names}
        counts = {"end_mode": -1, "switches": -1} | ({"period": 0} if flow.period is not None else {})
        return unsolved | counts | {"status": Status.FAILED if error.status is None else error.status}
    nodes, c, end = done.nodes, done.coefficients, done.state
    low, high = extremes(c, np.vstack([done.passed, end]))
    powers = np.arange(1, c.shape[-1] + 1)
    mean = (np.diff(nodes)[:, None] * (c / powers).sum(axis=-1)).sum(axis=0) / (nodes[-1] - nodes[0])
    columns = {f"mean_{name}": mean[i] for i, name in enumerate(names)}
    columns |= {f"min_{name}": low[i] for i, name in enumerate(names)} | {f"max_{name}": high[i] for i, name in enumerate(names)}
    columns |= {f"end_{name}": end[i] for i, name in enumerate(names)}
    columns |= {"end_mode": list(flow.modes).index(done.mode), "switches": len(done.events)}
    if flow.period is not None:
        columns["period"] = _period(nodes, c, end, float(flow.period))
    return columns | {"status": 0}


def _period(nodes: Array, c: Array, end: Array, T: float) -> int:
    """After how many periods of the forcing the motion repeats; 0 if that is not seen."""
    t = nodes[0] + np.arange(int((nodes[-1] - nodes[0]) / T + 1e-9) + 1) * T
    if len(t) < 3:
        return 0
    t = np.minimum(t, nodes[-1])
    index = np.clip(np.searchsorted(nodes, t, side="right") - 1, 0, len(c) - 1)
    y = polynomials(c[index], (t - nodes[index]) / (nodes[index + 1] - nodes[index]))
    y[-1] = end
    points = np.column_stack([np.zeros(len(y)), y])
    scales = np.full(c.shape[1], max(float(abs(y).max()), 1e-300))
    last = len(points) - 1
    return int(recurrence().period_number(points, last, last, _LONGEST, scales, _SAME, _SAME)[0])
