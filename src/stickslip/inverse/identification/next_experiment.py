"""After a fit: the next experiment that would determine the parameters that the records so far do not."""

from __future__ import annotations

import dataclasses
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems, SolveError, did_you_mean
from stickslip.basics.fields import leaves
from stickslip.basics.information import Information
from stickslip.basics.phrases import listed
from stickslip.inverse.identification.designing import (
    USES,
    Design,
    PlannedExperiment,
    curve_and_slopes,
    in_words,
    record_of,
    settings_of,
    units_of_settings,
)
from stickslip.inverse.identification.drive_harmonics import harmonics_of
from stickslip.inverse.identification.fit_text import OVER_MOTION, unit_of_values
from stickslip.inverse.identification.force_problem import DrivenProblem
from stickslip.inverse.identification.least_squares import MeasuredProblem
from stickslip.inverse.identification.logs_of_machines import APPLIED, bench_of
from stickslip.inverse.identification.motions import motion_of
from stickslip.inverse.identification.sensor_readings import known_rows, of_records
from stickslip.inverse.identification.sensors import sensors_of
from stickslip.records import Record

if TYPE_CHECKING:
    from stickslip.inverse.identification.fit import Fit

_MOTION = ("stroke", "frequency", "load")  # of a prescribed sine
_HOW = ("using", "sensor", "noise")
SAME = "same"  # the sensor of the first record, its zero not set anew
_PERIODS = 3  # of a prescribed sine


def next_experiment(
    fit: Fit, experiments: Any, *, noise: float | None = None, samples: int = 2000, using: str | None = None, sensor: Any = None
) -> Design:
    """The next experiment that, fitted together with the present records, best determines the parameters that these do not determine.

    The harmonics of its drive are its own, known as well as those of the fit (its ``harmonics=``).

    Parameters
    ----------
    experiments : dict of name -> values, or list of dicts
        Settings of an experiment: arguments of the model (amplitude, frequency, tilt, a known mass), the measurement (``using``,
        ``sensor``, ``noise``), and for forces, torques and currents over a motion ``stroke`` (from end to end), ``frequency`` [Hz] and
        ``load``. Everything else is as in the first record. A dict stands for all combinations.
    noise : float, optional
        Standard deviation of one value; by default that of the present records.
    samples : int
    using, sensor
        As for `design`; ``sensor="same"`` is that of the first record, neither zeroed nor recalibrated. Settings of an experiment take
        precedence.

    Returns
    -------
    Design
        The most informative experiments first, with the expected standard errors of a fit to all records.

    Examples
    --------
    The motion of a body that never rests contains no information on static friction.

    >>> import stickslip as ss
    >>> rig, how = ss.presets.piezo_rig, {"tilt_deg": 1.7, "amplitude": 3e-3, "law": "coulomb-static"}
    >>> rec = ss.virtual_rig(rig(**how, f0=0.25), noise=1e-4, seed=1)
    >>> fit = ss.identify(rec, rig, free={"mu0": (0.1, 0.3), "f0": (0.2, 0.35)}, starts=4, **how)
    >>> fit.undetermined
    ('f0',)
    >>> plan = fit.next_experiment({"amplitude": [2.5e-3, 6e-4]})
    >>> plan.best.settings[0], bool(plan.best.errors["f0"] < 0.01)
    ({'amplitude': 0.0006}, True)
    """
    problems = Problems("next_experiment")
    settings = settings_of(experiments, problems)
    kind = fit.problem.targets[0].kind
    if kind == "angle":
        why = "experiments with a command are not foreseen yet; allowed is a fit of forces, torques, currents or steady motion"
        raise InputError("next_experiment", [f"{why}; add a log with another load, or a faster command"])
    usual = {
        "using": (using or (kind if kind in USES else "velocity")),
        "sensor": sensor,
        "noise": float(fit.scale * np.median(fit.problem.sigma)) if noise is None else noise,
    }
    known = _known(fit)
    for name in dict.fromkeys(name for s in settings for name in s):
        if name not in known:
            problems.add(f"experiments: {name!r} is not known; {did_you_mean(str(name), known)}")
        elif name in fit.values:
            problems.add(f"experiments: {name} is what is sought; allowed are what an experiment sets, such as {known[0]}")
    problems.whole("samples", samples, 40, example=2000)
    problems.check()
    rows, units, designs, dropped = _rows_of(fit), _units(fit, settings), [], []
    for chosen in settings:
        try:
            designs.append(_expected(fit, rows, chosen, {**usual, **{k: v for k, v in chosen.items() if k in _HOW}}, samples))
        except (InputError, SolveError) as error:
            dropped.append(f"{in_words(chosen, units)} is left out: {error}")
    if not designs:
        raise InputError("next_experiment", ["none of the experiments can be computed", *dropped])
    designs.sort(key=lambda pair: pair[1])
    best = replace(designs[0][0], units=units)
    return Design(dict(fit.values), tuple(replace(e, units=units) for e, _ in designs), (_verdict(fit, best), *dropped))


def _units(fit: Fit, settings: list[dict[str, Any]]) -> dict[str, str]:
    """Units of parameters and settings; a prescribed motion has its own."""
    stroke = "m" if fit.problem.targets[0].kind in ("force", "applied force") else "rad"
    motion = dict(zip(_MOTION, (stroke, "Hz", "N"), strict=True)) if _over_motion(fit) else {}
    return units_of_settings(fit.problem.parameters.make, fit.values, settings) | motion


def _over_motion(fit: Fit) -> bool:
    return fit.problem.targets[0].kind in OVER_MOTION


def _known(fit: Fit) -> list[str]:
    """Settings of an experiment: arguments of the maker, its measurement, and for a prescribed motion stroke, frequency and load."""
    from stickslip.basics.arguments import parameters_of

    make = fit.problem.parameters.make
    own = [p.name for p in parameters_of(make)] if callable(make) else [name for name, _ in leaves(make)]
    return [*(_MOTION if _over_motion(fit) else ()), *own, *_HOW]


def _rows_of(fit: Fit) -> Any:
    """Derivatives of the records so far, in standard deviations as the fit found them, numbers of their own behind the parameters.

    Those of a number that is flat from bound to bound are none, whatever they are where the search ended.
    """
    determined = np.ones(fit.jacobian.shape[1])
    determined[: len(fit.names)] = [name not in fit.open for name in fit.names]
    return fit.jacobian * determined / fit.scale


def _expected(
    fit: Fit, rows: Any, chosen: dict[str, Any], how: dict[str, Any], samples: int
) -> tuple[PlannedExperiment, tuple[float, float]]:
    """The expected result of the records so far with one more experiment, and its rank."""
    own = _moved(fit, chosen, how, samples) if _over_motion(fit) else _driven(fit, chosen, how, samples)
    n, m = len(fit.values), rows.shape[1]
    same = _same(fit) if how["sensor"] == SAME else []
    places = [*range(n), *range(m, m + own.shape[1] - n - len(same)), *(k for k, _ in same)]
    both = np.zeros((len(rows) + len(own), m + own.shape[1] - n - len(same)))
    both[: len(rows), :m], both[len(rows) :, places] = rows, own
    covariance = Information(both, fit.problem.resolution).covariance()[:n, :n]
    size = np.sqrt(np.diag(covariance))
    open_ones = int(np.isinf(size).sum())
    known = np.isfinite(size)
    volume = float(np.linalg.slogdet(covariance[np.ix_(known, known)])[1]) if known.any() else 0.0
    errors = dict(zip(fit.names, (size * abs(fit.slopes)).tolist(), strict=True))
    moved = np.sqrt(np.mean(own[:, :n] ** 2, axis=0)) * 0.1 * np.abs(list(fit.values.values())) / np.abs(fit.slopes)
    return PlannedExperiment((chosen,), errors, float("nan"), dict(zip(fit.names, moved.tolist(), strict=True))), (open_ones, volume)


def _same(fit: Fit) -> list[tuple[int, Any]]:
    """Numbers of the sensor of the first record, and where they stand among those of the fit."""
    own = ((k, n) for k, n in enumerate(fit.problem.numbers, fit.problem.first) if 0 in n.records and n.of == "the sensor")
    return [(k, replace(n, records=(0,), prior=None)) for k, n in own]


def _numbers(fit: Fit, given: Any, target: Any) -> tuple[Any, Any]:
    """Numbers of the sensor of one more record, and those that are held."""
    if given == SAME:
        return [n for _, n in _same(fit)], tuple(replace(n, records=(0,)) for n in fit.problem.held if 0 in n.records)
    return sensors_of(given, [target], "next_experiment")


def _of(fit: Fit, chosen: dict[str, Any]) -> Any:
    """The parameters for one more record, which is like the first but for what is chosen."""
    of = fit.problem.parameters
    set_here = {name: value for name, value in chosen.items() if name not in (*_HOW, *_MOTION)}
    own = {f.argument: fit.values[f.name] for f in of.free if f.record == 0}
    return replace(of, fixed=({**of.fixed[0], **own, **set_here},))


def _values(fit: Fit) -> dict[str, float]:
    """Values of the parameters; the middle between its bounds for one that may be anywhere between them."""
    return fit.values | {f.name: float(f.outer(0.5)) for f in fit.problem.parameters.free if f.name in fit.open}


def _driven(fit: Fit, chosen: dict[str, Any], how: dict[str, Any], samples: int) -> Any:
    """Derivatives of a record of steady motion by the parameters, the phase, and the numbers of its sensor."""
    of, using, noise = _of(fit, chosen), how["using"], float(how["noise"])
    ripple = harmonics_of(of.model(_values(fit), 0), fit.problem.harmonics, samples, "next_experiment")
    curve, by, period = curve_and_slopes(of, _values(fit), 0, using, samples, fit.problem.model.rtol, ripple)
    target = record_of(curve, using, noise, period)
    numbers, _ = _numbers(fit, how["sensor"], target)
    parts: list[Any] = [(target, target.y, {})]
    sensors = [of_records(number, parts)[:, None] for number in numbers]
    slopes = np.concatenate([by.main * fit.slopes, by.own, *sensors], axis=1) / noise
    return np.concatenate([slopes, known_rows((*ripple, *numbers), slopes.shape[1])])


def _moved(fit: Fit, chosen: dict[str, Any], how: dict[str, Any], samples: int) -> Any:
    """Derivatives of a force, torque or current over a sine by the parameters and the numbers of its sensor."""
    model, of = fit.problem.model, _of(fit, chosen)
    target = _sine(fit, of, chosen, samples)
    problem = DrivenProblem(of, (target,), float(how["noise"]), 1, model.holds)
    numbers, held = _numbers(fit, how["sensor"], target)
    problem_with_sensors = MeasuredProblem(problem, tuple(numbers), held)
    point = np.concatenate([fit.point[: len(of.free)], [n.value for n in numbers]])
    predicted = problem_with_sensors.predicted(point)
    return problem_with_sensors.with_values(predicted).jacobian(point)


def _sine(fit: Fit, of: Any, chosen: dict[str, Any], samples: int) -> Any:
    """A record of a sine of some stroke and frequency, those of the first record where nothing is chosen."""
    first, made = fit.problem.targets[0], of.model(fit.values, 0)
    t, x = first.t, np.concatenate([[0.0], np.cumsum(0.5 * (first.v[1:] + first.v[:-1]) * np.diff(first.t))])
    stroke = float(chosen.get("stroke", np.ptp(x)))
    frequency = float(chosen.get("frequency", _frequency(t, x)))
    time = np.linspace(0.0, _PERIODS / frequency, samples)
    way = 0.5 * stroke * np.sin(2 * np.pi * frequency * time)
    if first.kind == "force":
        load = chosen.get("load", float(np.mean(first.load)))
        rec = Record.of(time, {"x [m]": way, "F [N]": np.zeros(samples)}, roles={"F": "force"})
        return dataclasses.replace(motion_of(rec, float(load), "experiment"), given_sigma=True)
    columns = {"x [m]" if first.kind == "applied force" else "x [rad]": way, f"y [{unit_of_values(first)}]": np.zeros(samples)}
    rec = Record.of(time, columns, roles={"y": APPLIED[first.kind][0]})
    return dataclasses.replace(bench_of(made, rec, "experiment"), given_sigma=True)


def _frequency(t: Array, x: Array) -> float:
    """How often a motion goes to and fro in a second, by its crossings of the middle."""
    crossings = int(np.sum(np.diff(np.sign(x - np.median(x))) != 0))
    return max(crossings, 1) / (2 * float(t[-1] - t[0]))


def _verdict(fit: Fit, best: PlannedExperiment) -> str:
    left = [name for name in fit.undetermined if not np.isfinite(best.errors[name])]
    determined = [name for name in fit.undetermined if name not in left]
    if not fit.undetermined:
        return f"{best.words} leaves the least uncertain; all parameters are determined already"
    if not determined:
        return f"none of the experiments determines {listed(left)}; change what else an experiment sets, or fix {listed(left[:1])}"
    remainder = f"; {listed(left)} stay open" if left else ""
    return f"{best.words} determines {listed(determined)}{remainder}"
