"""`design`: which parameters an experiment can determine, and which experiment is the most informative, before it is done."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from itertools import combinations, product
from typing import Any

import numpy as np

from stickslip.basics.arguments import Maker, described_as, explains_arguments
from stickslip.basics.contracts import Model
from stickslip.basics.errors import InputError, Problems, SolveError, is_number, is_whole
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.information import Information
from stickslip.basics.notebook_display import Drawn
from stickslip.inverse.identification.covariance import correlated
from stickslip.inverse.identification.drive_harmonics import DriveNumber, harmonics_of, rippled
from stickslip.inverse.identification.fit_text import NOT_DETERMINED
from stickslip.inverse.identification.parameters import Parameters, parameters
from stickslip.inverse.identification.sensor_readings import known_rows, of_records
from stickslip.inverse.identification.sensors import sensors_of
from stickslip.inverse.identification.steady_curves import steady_curve
from stickslip.inverse.identification.targets import Target
from stickslip.models.naming import unit_in

#: A parameter is told if its expected standard error is below this part of its value.
TOLD = 0.25
#: A parameter is faint if a change by a tenth moves the values by less than this part of the noise of one sample.
FAINT = 0.1
USES = ("velocity", "position")
_STEP = 1e-4


_TOLD = 8  # experiments that are told


@dataclass(frozen=True)
class PlannedExperiment:
    """One experiment, or several together, and what is expected of it.

    Parameters
    ----------
    settings : tuple of dict
        Arguments of each experiment.
    errors : dict
        Expected standard error of each parameter.
    visible : dict
        By how much a change of each parameter by a tenth moves the values, rms over all samples, as a part of the noise of one.
    separation : float
        Rms difference between the rival laws over the noise, times the root of the number of samples; NaN without rivals.
    units : dict
        Units of the settings and of the parameters; those without a unit are left out.
    """

    settings: tuple[dict[str, Any], ...]
    errors: dict[str, float]
    separation: float
    visible: dict[str, float]
    units: Mapping[str, str] = field(default_factory=dict)

    @property
    def words(self) -> str:
        """The settings, those done together joined."""
        return " + ".join(in_words(chosen, self.units) for chosen in self.settings)


@described_as("what ss.identification.design returns; type ss.identification.design(...)")
@sealed
@dataclass(frozen=True, eq=False, repr=False)
class Design(Drawn):
    """How well experiments determine some parameters.

    Parameters
    ----------
    values : dict
        Where the parameters are supposed to be.
    experiments : tuple of Experiment
        The most informative first (the smallest volume of the confidence region; with rivals, the largest separation).
    notes : tuple of str
        Which parameters none of them can determine, which are confounded, and which experiments were left out and why.
    """

    values: dict[str, float]
    experiments: tuple[PlannedExperiment, ...]
    notes: tuple[str, ...]

    _drawn_by, _inches = "design", (4.4, 2.6)

    @property
    def best(self) -> PlannedExperiment:
        """The most informative experiment."""
        return self.experiments[0]

    @property
    def determined(self) -> tuple[str, ...]:
        """Parameters that the best experiment determines to within a quarter of their value."""
        return tuple(n for n, e in self.best.errors.items() if e < TOLD * abs(self.values[n]))

    @property
    def faint(self) -> tuple[str, ...]:
        """Parameters that hide in the noise: a change by a tenth moves a sample by less than a tenth of it, and shows in averages only."""
        return tuple(n for n, part in self.best.visible.items() if part < FAINT)

    @property
    def undetermined(self) -> tuple[str, ...]:
        """Parameters that the best experiment does not determine so well."""
        return tuple(n for n in self.values if n not in self.determined)

    def __str__(self) -> str:
        lines = []
        for e in self.experiments[:_TOLD]:
            errors = ", ".join(f"{n} {self._sure(n, v)}" for n, v in e.errors.items())
            apart = "" if np.isnan(e.separation) else f"; rivals {e.separation:.3g} standard deviations apart"
            lines.append(f"{e.words}: {errors}{apart}")
        return "\n".join([*lines, *self.notes])

    def _sure(self, name: str, error: float) -> str:
        value = abs(self.values[name])
        return f"± {100 * error / value:.2g} %" if value and np.isfinite(error) else NOT_DETERMINED if value else "± more than all"

    def _title(self) -> str:
        return "Experiments, the best first"

    def _tables(self) -> list[list[tuple[str, ...]]]:
        head = ("experiment", *(f"error of {name} = {with_unit(v, self.best.units.get(name, ''))}" for name, v in self.values.items()))
        rows = (tuple(self._sure(name, e.errors[name]) for name in self.values) for e in self.experiments[:_TOLD])
        return [[head, *((e.words, *row) for e, row in zip(self.experiments, rows, strict=False))]]

    __repr__ = __str__


@explains_arguments
def design(
    make: Maker,
    *,
    free: dict[str, float],
    experiments: dict[str, Any] | list[dict[str, Any]],
    noise: float,
    samples: int = 2000,
    together: int = 1,
    rivals: list[Any] | None = None,
    using: str = "velocity",
    sensor: dict[str, Any] | None = None,
    harmonics: Any = None,
    rtol: float = 1e-9,
    **arguments: Any,
) -> Design:
    """The experiments that best determine the parameters or discriminate between rival laws, and the parameters that none can determine.

    Parameters
    ----------
    make : callable or Robot
        As for `identify`.
    free : dict
        Expected values of the parameters (not bounds).
    experiments : dict of argument -> values, or list of dicts
        Settings to choose from; a dict stands for all combinations.
    noise : float
        Standard deviation of one sample [m/s or m].
    samples : int
        Samples of each experiment, over whole periods.
    together : int
        How many experiments are done and fitted jointly.
    rivals : list of robots' makers or laws, optional
        Other makers that take the same arguments, already fitted: the design that separates them best from `make` is sought.
    using : {"velocity", "position"}
    sensor : dict, optional
        Sensor effects, as for `identify`, which will be fitted too; ``{}`` is an ideal sensor.
    harmonics : float or dict, optional
        How well the harmonics of the drive will be known, as for `identify`: each experiment has its own; 0 is an exact drive.
    rtol : float
        Relative tolerance of the solver.
    **arguments
        Arguments of `make` that are the same in all experiments.

    Returns
    -------
    Design

    Examples
    --------
    >>> import stickslip as ss
    >>> plan = ss.identification.design(ss.presets.piezo_rig, free={"mu0": 0.18, "sigma0": 4e5}, experiments={"amplitude": [4e-4, 8e-4]},
    ...                  noise=1e-3, samples=200, tilt_deg=1.7)
    >>> plan.determined, plan.undetermined
    (('mu0',), ('sigma0',))
    """
    of, settings = _checked(make, free, experiments, noise, samples, together, using, arguments)
    rivals = [] if rivals is None else list(rivals)
    units = units_of_settings(make, free, settings)
    slopes: dict[int, ExperimentSlopes] = {}
    curves, apart, targets, dropped = {}, {}, {}, []
    for i, chosen in enumerate(settings):
        try:
            ripple = harmonics_of(of.model(free, i), harmonics, samples, "design")
            curves[i], slopes[i], period = curve_and_slopes(of, free, i, using, samples, rtol, ripple)
            targets[i] = record_of(curves[i], using, noise, period)
            if rivals:
                apart[i] = _apart(rivals, of, free, i, curves[i], using, samples, rtol)
        except (InputError, SolveError) as error:
            slopes.pop(i, None)
            dropped.append(f"{in_words(chosen, units)} is left out: {error}")
    if len(slopes) < together:
        raise InputError(
            "design", [f"{len(slopes)} of {len(settings)} experiments can be solved, and together = {together} are wanted", *dropped]
        )
    expected = [
        _expected(chosen, slopes, apart, settings, free, noise, _sensor_columns(chosen, targets, sensor))
        for chosen in combinations(slopes, together)
    ]
    key = (lambda e: -e[0].separation) if rivals else (lambda e: e[1])
    expected.sort(key=key)
    best = expected[0]
    return Design(dict(free), tuple(replace(e, units=units) for e, _, _ in expected), (*_notes(best, free, using), *dropped))


def _checked(
    make: Model | Callable[..., Any],
    free: dict[str, Any],
    experiments: Any,
    noise: float,
    samples: int,
    together: int,
    using: str,
    arguments: dict[str, Any],
) -> tuple[Parameters, list[dict[str, Any]]]:
    """Parameters and settings of all experiments; everything wrong with what the user gave is reported at once."""
    problems = Problems("design")
    settings = settings_of(experiments, problems)
    for name, value in free.items():
        if not is_number(value):
            problems.add(f'free: {name} = {value!r}; allowed is its expected value; type for example "{name}": 0.18')
    middle = {name: value if is_number(value) else 1.0 for name, value in free.items()}
    bounds = {name: (0.5 * v, 1.5 * v) if v > 0 else (v - 1.0, v + 1.0) for name, v in middle.items()}
    varied = {k: [s.get(k, arguments.get(k)) for s in settings] for k in dict.fromkeys(k for s in settings for k in s)}
    of = None
    try:
        of = parameters(make, bounds, None, {**arguments, **varied}, max(len(settings), 1), "design")
    except InputError as error:
        problems.include(error)
    if not (is_number(noise) and 1e-30 < noise < 1e30):
        problems.add(f"noise = {noise!r}; allowed is a positive standard deviation of one sample; type for example noise=1e-3")
    problems.whole("samples", samples, 8, example=2000)
    problems.whole("together", together, 1, example=2)
    if settings and is_whole(together) and together > len(settings):
        problems.add(f"together = {together} and there are {len(settings)} experiments; give more of them, or a smaller together")
    if using not in USES:
        problems.add(f"using = {using!r}; allowed is one of {', '.join(USES)}")
    problems.check()
    return of, settings  # type: ignore[return-value]  # without it there was a problem


def settings_of(experiments: Any, problems: Problems) -> list[dict[str, Any]]:
    """The settings of each experiment."""
    example = 'type for example experiments={"amplitude": [4e-4, 8e-4]}'
    if isinstance(experiments, dict):
        values = {name: list(v) if isinstance(v, (list, tuple, np.ndarray)) else [] for name, v in experiments.items()}
        wrong = [name for name, v in values.items() if not v]
        for name in wrong:
            problems.add(f"experiments: {name} = {experiments[name]!r}; allowed is a list of values; {example}")
        settings = [] if wrong else [dict(zip(values, each, strict=True)) for each in product(*values.values()) if values]
    else:
        settings = [dict(e) for e in experiments if isinstance(e, dict)] if isinstance(experiments, (list, tuple)) else []
        wrong = [e for e in experiments if not isinstance(e, dict)] if isinstance(experiments, (list, tuple)) else [experiments]
        for e in wrong:
            problems.add(f"experiments: {e!r} is not a dict of settings; {example}")
    if not settings and not wrong:
        problems.add(f"experiments is empty; allowed is one or more; {example}")
    return settings


def in_words(settings: dict[str, Any], units: Mapping[str, str]) -> str:
    """The settings of one experiment in words.

    Examples
    --------
    >>> in_words({"amplitude": 4e-4, "law": "coulomb"}, {"amplitude": "m"})
    'amplitude = 0.0004 m, law = coulomb'
    """
    return ", ".join(f"{name} = {with_unit(value, units.get(name, ''))}" for name, value in settings.items()) or "as given"


def with_unit(value: Any, unit: str) -> str:
    """A value with its unit."""
    return f"{value:.5g} {unit}".rstrip() if is_number(value) else str(value)


def units_of_settings(make: Model | Callable[..., Any], free: Iterable[str], settings: list[dict[str, Any]]) -> dict[str, str]:
    """Units of the parameters and of what experiments set, as their maker describes them."""
    units = {name: unit_in(name, make) for name in dict.fromkeys([*free, *(name for chosen in settings for name in chosen)])}
    return {name: unit for name, unit in units.items() if unit}


@dataclass(frozen=True, eq=False)
class ExperimentSlopes:
    """Derivatives of the values of one experiment.

    Parameters
    ----------
    main : array (values, parameters)
    own : array (values, numbers)
        By what is fitted of this experiment alone: its phase, the offset of a position, the harmonics of its drive.
    ripple : tuple of DriveNumber
        The harmonics, which are the last of these.
    """

    main: Any
    own: Any
    ripple: tuple[DriveNumber, ...] = ()


def _curve_of(model: Model, using: str, samples: int, rtol: float) -> Any:
    curve = steady_curve(model, None, rtol)
    phase = np.arange(samples) / samples * curve.period
    return curve.v(phase) if using == "velocity" else curve.x(phase)


def curve_and_slopes(
    of: Parameters, free: dict[str, float], i: int, using: str, samples: int, rtol: float, ripple: tuple[DriveNumber, ...] = ()
) -> tuple[Any, ExperimentSlopes, float]:
    """The curve of an experiment, its derivatives by the parameters and by what is its own, and its period."""
    model = of.model(free, i)
    here = _curve_of(model, using, samples, rtol)

    def slope(moved: Callable[[float], Model], h: float) -> Any:
        ahead, behind = (_curve_of(moved(side * h), using, samples, rtol) for side in (1, -1))
        return (ahead - behind) / (2 * h)

    columns = [
        slope(lambda d, name=name, value=value: of.model({**free, name: value + d}, i), _STEP * (abs(value) or 1.0))  # type: ignore[misc]
        for name, value in free.items()
    ]
    own = [np.gradient(here) * samples] + ([np.ones(samples)] if using == "position" else [])
    own += [slope(lambda d, name=n.name: rippled(model, {name: d}), _STEP) for n in ripple]  # type: ignore[misc]
    return here, ExperimentSlopes(np.stack(columns, axis=1), np.stack(own, axis=1), ripple), float(model.drive.period)


def record_of(here: Any, using: str, noise: float, period: float) -> Target:
    """A record of the curve, as a fit would have it: one motion period in equal steps."""
    phase = np.arange(len(here)) / len(here)
    return Target(using, phase, here, noise, 1.0 / period, False, "experiment", np.ones(len(here)))


def _sensor_columns(chosen: Any, by_experiment: dict[int, Target], sensor: dict[str, Any] | None) -> tuple[Any, Any]:
    """Derivatives of all values by the numbers of the sensors, and the rows of what is known of these."""
    targets = [by_experiment[i] for i in chosen]
    numbers, _ = sensors_of(sensor, targets, "design")
    parts: list[Any] = [(t, t.y, {}) for t in targets]
    columns = [of_records(number, parts) for number in numbers]
    count = sum(t.count for t in targets)
    return np.array(columns).reshape(-1, count).T, known_rows(numbers, len(numbers))


def _apart(rivals: list[Any], of: Parameters, free: dict[str, float], i: int, here: Any, using: str, samples: int, rtol: float) -> float:
    """The smallest rms distance of a rival's curve from ours, at the best phase."""
    squares = []
    for rival in rivals:
        arguments = of.arguments(free, i)
        model = rival(**arguments) if callable(rival) else of.model(free, i).replace(friction=rival)
        other = _curve_of(model, using, samples, rtol)
        if using == "position":
            here, other = here - here.mean(), other - other.mean()
        overlap = np.fft.irfft(np.fft.rfft(here) * np.conj(np.fft.rfft(other)), samples)
        squares.append(max(float(here @ here + other @ other - 2 * overlap.max()), 0.0))
    return min(squares)


def _expected(
    chosen: Any, slopes: Any, apart: Any, settings: Any, free: dict[str, float], noise: float, sensors: tuple[Any, Any]
) -> tuple[PlannedExperiment, float, Any]:
    """Expected errors of a joint fit to the chosen experiments, and the logarithm of the volume of the confidence region."""
    n = len(free)
    rows, known = [], [np.zeros((0, 0))]
    for k, i in enumerate(chosen):
        own = slopes[i].own
        blocks = [slopes[i].main] + [own if j == k else np.zeros_like(slopes[c].own) for j, c in enumerate(chosen)]
        rows.append(np.concatenate(blocks, axis=1))
        known.append(known_rows(slopes[i].ripple, own.shape[1]))
    whole = np.concatenate([np.concatenate(rows), sensors[0]], axis=1)
    known = _side_by_side([np.zeros((0, n)), *known, sensors[1]])
    covariance = Information(whole / noise, prior=known).covariance()[:n, :n]
    size = np.array([abs(v) or 1.0 for v in free.values()])
    relative = covariance / np.outer(size, size)
    volume = float(np.linalg.slogdet(relative)[1]) if np.isfinite(relative).all() else float("inf")
    separation = float(np.sqrt(sum(apart[i] for i in chosen)) / noise) if apart else float("nan")
    errors = {name: float(np.sqrt(covariance[k, k])) for k, name in enumerate(free)}
    moved = np.sqrt(np.mean(np.concatenate([slopes[i].main for i in chosen]) ** 2, axis=0)) * 0.1 * size / noise
    visible = {name: float(moved[k]) for k, name in enumerate(free)}
    return PlannedExperiment(tuple(settings[i] for i in chosen), errors, separation, visible), volume, covariance


def _side_by_side(blocks: list[Any]) -> Any:
    """A matrix with blocks along its diagonal, and zeros elsewhere."""
    from scipy.linalg import block_diag

    return block_diag(*blocks)


def _notes(best: tuple[PlannedExperiment, float, Any], free: dict[str, float], using: str) -> list[str]:
    experiment, _, covariance = best
    untold = [n for n, v in free.items() if not experiment.errors[n] < TOLD * (abs(v) or 1.0)]
    notes = [
        f"{using} cannot determine {n} here: its expected standard error is {_part(experiment.errors[n], free[n])} of its value; fix it"
        for n in untold
    ]
    notes += [
        f"{using} hardly determines {n}: a change by 10 % moves it by {part:.2g} of the noise of a sample, as a small error of "
        "the drive does; fix it"
        for n, part in experiment.visible.items()
        if part < FAINT and n not in untold
    ]
    if not np.isfinite(covariance).all():
        return notes
    pairs = correlated(list(free), covariance)
    advice = "fix one or do another experiment with it (together=2)"
    return notes + [f"{one} and {other} would be correlated {rho:.2f}: {advice}" for one, other, rho in pairs]


def _part(error: float, value: float) -> str:
    return f"{100 * error / abs(value):.3g} %" if value and np.isfinite(error) else "more than all"
