"""The arguments of `solve`, checked once."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from stickslip.basics.batch import Labels, labels_together, spread_over_cases
from stickslip.basics.contracts import Model
from stickslip.basics.errors import InputError, Problems, did_you_mean, is_one_of, is_whole
from stickslip.basics.fields import leaves, number
from stickslip.basics.interruption import is_outermost, takes_some_cases
from stickslip.basics.progress import reporting
from stickslip.basics.typed_numbers import in_seconds
from stickslip.basics.variables import VARIABLES
from stickslip.engine.kinds import check_functions
from stickslip.models.model_adapter import adapter_of, is_model
from stickslip.models.observables import checked_observables
from stickslip.solvers.initial_states import flattened, start_states
from stickslip.solvers.methods import METHODS
from stickslip.solvers.settings import Request, Settings, check_duration, check_keep, check_rtol, periods_begun, versions

_AT_ONCE = 4096  # cases of a batch whose numbers as columns are kept for the table of its lanes


def request(model: Model, settings: Settings) -> Request:
    """Check the arguments of `solve`; everything wrong with them is reported at once."""
    given, problems = settings, Problems("solve")
    if not is_model(model):
        raise InputError(
            "solve",
            [
                f"{model!r} is not a model; allowed is a Robot, a mechanism, or a machine of several bodies; "
                "type for example ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4)"
            ],
        )
    if not adapter_of(model).has_bodies:
        from stickslip.solvers.flow_requests import flow_request

        return flow_request(model, settings)  # type: ignore[arg-type]
    numbers = _numbers_of(model, problems)
    check_functions(model)
    labels, duration = labels_together(numbers, type(model).__name__), in_seconds(given.duration, problems)
    periods = _periods(model, labels, given.periods, given.settle, duration, problems)
    problems.whole("periods", periods, 1, example=200)
    problems.whole("workers", given.workers, 1, example=2)
    problems.whole("samples", given.samples, 4, example=200)
    settle, auto = given.settle, is_one_of(given.settle, ("auto",))
    if settle is not None and not auto and (not is_whole(settle) or settle < 0 or (is_whole(periods) and settle >= periods)):
        allowed = f'a whole number from 0 below periods = {periods!r}, None or "auto"'
        problems.add(f"settle = {settle!r}; allowed is {allowed}; type for example settle=100")
    _check_thresholds(given, problems)
    _check_names(labels, given, problems)
    states = start_states(model, labels, given.start, problems, machine := flattened(model, labels, numbers))
    problems.check()
    keep = given.keep or ("summary" if labels.shape else "trajectory")
    observed = checked_observables("solve", given.observe, VARIABLES)
    if observed and keep == "trajectory":
        raise InputError("solve", ["observe makes columns of a batch, and this is one run; type run.at(t) for its columns at any time"])
    periods = int(periods)
    _check_size(keep, periods, int(given.samples))
    return Request(
        model=model,
        labels=labels,
        periods=periods,
        settle=periods // 2 if settle is None or auto else int(settle),
        auto=auto,
        rtol=float(given.rtol),
        start=states,
        given_start=dict(given.start or {}),
        workers=int(given.workers),
        keep=keep,
        samples=int(given.samples),
        method=given.method,
        slip_ratio=float(given.slip_ratio),
        dwell=float(given.dwell),
        progress=reporting(given.progress, "solve"),
        options=given.options,
        duration=None if duration is None else float(duration),
        span=spread_over_cases(float(duration) if model.period is None else model.period, labels),
        observe=observed,
        numbers=numbers,
        flat=machine if labels.shape and labels.cases <= _AT_ONCE else None,
        partial=is_outermost() if keep == "trajectory" else takes_some_cases(),
    )


def _numbers_of(model: Model, problems: Problems) -> dict[str, Any]:
    """The numbers of a model by name; `InputError` where one is none."""
    numbers = dict(leaves(model))
    for name, value in numbers.items():
        if type(value) is float:  # the usual case, without further checks
            continue
        try:
            number(value)
        except ValueError as error:
            problems.add(f"{name}: {error}; allowed is a number or an array of numbers")
    problems.check()
    return numbers


def _check_thresholds(given: Settings, problems: Problems) -> None:
    check_rtol(given.rtol, problems)
    for name, value, below in (("slip_ratio", given.slip_ratio, 1.0), ("dwell", given.dwell, 0.5)):
        if not isinstance(value, (int, float)) or not 0.0 < value < below:
            problems.add(f"{name} = {value!r}; allowed is between 0 and {below:g}; type for example {name}={0.75 if below == 1 else 0.03}")


def _periods(model: Model, labels: Labels, periods: Any, settle: Any, duration: Any, problems: Problems) -> Any:
    """Periods to run: as given, or as many as the duration begins; 1 for a model that has no period."""
    name, aperiodic = type(model).__name__, model.period is None
    if duration is None:
        if aperiodic:
            problems.add(f"{name} has no period, so periods does not say how long to run; type duration=60.0 [s]")
            return 1
        return 200 if periods is None else periods
    if not check_duration(duration, periods, problems, " [s]"):
        return 1
    if aperiodic:
        if settle not in (None, 0):
            problems.add(f"settle = {settle!r} counts periods, and {name} has none; leave settle out")
        return 1
    if labels.shape:
        problems.add(f"duration is for one {name} and this is a batch of shape {labels.shape}; type periods=200, or solve one case")
        return 1
    return periods_begun(duration, float(model.period))


#: Bytes that a trajectory takes for each sample of its columns, and for each period of dense output (measured, generous).
SAMPLE, PERIOD, MOST = 130, 25_000, 8e9


def _check_size(keep: str, periods: int, samples: int) -> None:
    """A trajectory that would fill the memory is refused before it is computed."""
    size = periods * (samples * SAMPLE + PERIOD)
    if keep == "trajectory" and size > MOST:
        most = int(MOST / (samples * SAMPLE + PERIOD))
        raise InputError(
            "solve",
            [f"a trajectory of {periods} periods with {samples} samples each would take about {size / 1e9:.0f} GB; allowed are about "
             f'{most} periods; type keep="summary", which keeps no curve, or fewer periods'],
        )  # fmt: skip


def _check_names(labels: Labels, given: Settings, problems: Problems) -> None:
    check_keep(given.keep, labels, problems)
    if not is_one_of(given.method, METHODS):
        problems.add(f"method = {given.method!r} is not known; {did_you_mean(str(given.method), METHODS)}")
    known = ("steps",) if is_one_of(given.method, ("rk4",)) else ()
    for name in given.options:
        if name not in known:
            arguments = [each.name for each in fields(Settings) if each.name != "options"]
            problems.add(f"{name!r} is not an argument of solve; {did_you_mean(name, [*arguments, *known])}")


def provenance(todo: Request, method: str, tolerance: float | None) -> dict[str, Any]:
    """Versions, settings and (for one case) parameters: what it takes to make this result again."""
    settings = {"method": method, "rtol": tolerance, "periods": todo.periods, "settle": "auto" if todo.auto else todo.settle}
    settings |= {"slip_ratio": todo.slip_ratio, "dwell": todo.dwell}
    settings |= {} if todo.duration is None else {"duration": todo.duration}
    kinds = {"law": adapter_of(todo.model).law_names, "model": type(todo.model).__name__}
    parameters = {} if todo.labels.shape else {name: float(value) for name, value in todo.numbers.items()}
    return {"versions": versions(), "settings": settings, "kinds": kinds, "parameters": parameters}
