"""`design`: before fitting, what can an experiment tell, and which one tells most."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from stickslip.errors import InputError, SolveError
from stickslip.identifying.parameters import Parameters, parameters
from stickslip.identifying.steady_curves import steady_curve
from stickslip.identifying.uncertainty import covariance_of

__all__ = ["Design", "Experiment", "design"]

#: A parameter is told if its expected standard error is below this part of its value.
TOLD = 0.25
#: A parameter is faint if a change by a tenth moves the values by less than this part of the noise of one sample.
FAINT = 0.1
_STEP = 1e-4


@dataclass(frozen=True)
class Experiment:
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
    """

    settings: tuple[dict[str, Any], ...]
    errors: dict[str, float]
    separation: float
    visible: dict[str, float]


@dataclass(frozen=True, eq=False, repr=False)
class Design:
    """What experiments can tell about some parameters.

    Parameters
    ----------
    values : dict
        Where the parameters are supposed to be.
    experiments : tuple of Experiment
        The most telling first (the smallest volume of the confidence region; with rivals, the largest separation).
    notes : tuple of str
        Which parameters none of them can tell, and which are confounded.
    """

    values: dict[str, float]
    experiments: tuple[Experiment, ...]
    notes: tuple[str, ...]

    @property
    def best(self) -> Experiment:
        """The most telling."""
        return self.experiments[0]

    @property
    def told(self) -> tuple[str, ...]:
        """Parameters that the best experiment tells to within a quarter of their value."""
        return tuple(n for n, e in self.best.errors.items() if e < TOLD * abs(self.values[n]))

    @property
    def faint(self) -> tuple[str, ...]:
        """Parameters that hide in the noise: a change by a tenth moves a sample by less than a tenth of it, and shows in averages only."""
        return tuple(n for n, part in self.best.visible.items() if part < FAINT)

    @property
    def untold(self) -> tuple[str, ...]:
        """Parameters that it does not."""
        return tuple(n for n in self.values if n not in self.told)

    def __str__(self) -> str:
        lines = []
        for e in self.experiments[:8]:
            where = " + ".join(
                ", ".join(f"{k} = {v:.5g}" if isinstance(v, float) else f"{k} = {v}" for k, v in s.items()) for s in e.settings
            )
            errors = ", ".join(f"{n} ± {100 * v / abs(self.values[n]) if self.values[n] else np.inf:.2g} %" for n, v in e.errors.items())
            apart = "" if np.isnan(e.separation) else f"; rivals {e.separation:.3g} standard deviations apart"
            lines.append(f"{where}: {errors}{apart}")
        return "\n".join([*lines, *self.notes])

    __repr__ = __str__


def design(
    make: Any,
    *,
    free: dict[str, float],
    experiments: dict[str, Any] | list[dict[str, Any]],
    noise: float,
    samples: int = 2000,
    together: int = 1,
    rivals: list[Any] | None = None,
    using: str = "velocity",
    rtol: float = 1e-9,
    **arguments: Any,
) -> Design:
    """Which experiment would tell the parameters best, or separate rival laws best; and what none of them can tell.

    Parameters
    ----------
    make : callable or Robot
        As for `identify`.
    free : dict
        Where the parameters are supposed to be (their values, not bounds).
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
    rtol : float
        Of the solver.
    **arguments
        Arguments of `make` that are the same in all experiments.

    Returns
    -------
    Design

    Examples
    --------
    >>> import stickslip as ss
    >>> plan = ss.design(ss.presets.piezo_rig, free={"mu0": 0.18, "sigma0": 4e5}, experiments={"amplitude": [4e-4, 8e-4]},
    ...                  noise=1e-3, samples=200, tilt_deg=1.7)
    >>> plan.told, plan.untold
    (('mu0',), ('sigma0',))
    """
    settings = _settings(experiments)
    bounds = {name: (0.5 * value, 1.5 * value) if value > 0 else (value - 1.0, value + 1.0) for name, value in free.items()}
    of = parameters(
        make,
        bounds,
        None,
        {**arguments, **{k: [s.get(k, arguments.get(k)) for s in settings] for k in dict.fromkeys(k for s in settings for k in s)}},
        len(settings),
        "design",
    )
    if not noise > 0 or not 1 <= together <= len(settings):
        raise InputError(
            "design", [f"noise = {noise!r}, together = {together!r}; allowed are a positive noise and 1 to {len(settings)} experiments"]
        )
    slopes, curves = {}, {}
    for i in range(len(settings)):
        made = _sensitivity(of, free, i, using, samples, rtol)
        if made is not None:
            curves[i], slopes[i] = made
    if not slopes:
        raise InputError("design", ["none of the experiments could be solved; check the settings"])
    apart = {i: _apart(rivals, of, free, i, curves[i], using, samples, rtol) for i in slopes} if rivals else {}
    found = [_expected(chosen, slopes, apart, settings, free, noise) for chosen in combinations(slopes, min(together, len(slopes)))]
    key = (lambda e: -e[0].separation) if rivals else (lambda e: e[1])
    found.sort(key=key)
    best = found[0]
    return Design(dict(free), tuple(e for e, _, _ in found), tuple(_notes(best, free, using)))


def _settings(experiments: Any) -> list[dict[str, Any]]:
    if isinstance(experiments, dict):
        names = list(experiments)
        grids = np.meshgrid(*(np.arange(len(experiments[n])) for n in names), indexing="ij")
        return [
            {n: experiments[n][int(k)] for n, k in zip(names, index, strict=True)}
            for index in zip(*(g.ravel() for g in grids), strict=True)
        ]
    return [dict(e) for e in experiments]


def _curve_of(model: Any, using: str, samples: int, rtol: float) -> Any:
    curve = steady_curve(model, None, rtol)
    phase = np.arange(samples) / samples * curve.period
    return curve.v(phase) if using == "velocity" else curve.x(phase)


def _sensitivity(of: Parameters, free: dict[str, float], i: int, using: str, samples: int, rtol: float) -> Any:
    """The curve of an experiment, and its derivatives by the parameters and by the phase (and, for a position, its offset)."""
    try:
        here = _curve_of(of.model(free, i), using, samples, rtol)
        columns = []
        for name, value in free.items():
            h = _STEP * (abs(value) or 1.0)
            sides = [_curve_of(of.model({**free, name: value + s * h}, i), using, samples, rtol) for s in (1, -1)]
            columns.append((sides[0] - sides[1]) / (2 * h))
    except (InputError, SolveError):
        return None
    nuisances = [np.gradient(here) * samples] + ([np.ones(samples)] if using == "position" else [])
    return here, (np.stack(columns, axis=1), np.stack(nuisances, axis=1))


def _apart(rivals: list[Any], of: Parameters, free: dict[str, float], i: int, here: Any, using: str, samples: int, rtol: float) -> float:
    """The smallest rms distance of a rival's curve from ours, at the best phase."""
    found = []
    for rival in rivals:
        arguments = of.arguments(free, i)
        model = rival(**arguments) if callable(rival) else of.model(free, i).replace(friction=rival)
        other = _curve_of(model, using, samples, rtol)
        if using == "position":
            here, other = here - here.mean(), other - other.mean()
        overlap = np.fft.irfft(np.fft.rfft(here) * np.conj(np.fft.rfft(other)), samples)
        found.append(max(float(here @ here + other @ other - 2 * overlap.max()), 0.0))
    return min(found)


def _expected(chosen: Any, slopes: Any, apart: Any, settings: Any, free: dict[str, float], noise: float) -> tuple[Experiment, float, Any]:
    """Expected errors of a joint fit to the chosen experiments, and the logarithm of the volume of the confidence region."""
    n = len(free)
    rows = []
    for k, i in enumerate(chosen):
        main, own = slopes[i]
        blocks = [main] + [own if j == k else np.zeros_like(slopes[c][1]) for j, c in enumerate(chosen)]
        rows.append(np.concatenate(blocks, axis=1))
    covariance = covariance_of(np.concatenate(rows) / noise, 1.0, n)
    size = np.array([abs(v) or 1.0 for v in free.values()])
    relative = covariance / np.outer(size, size)
    volume = float(np.linalg.slogdet(relative)[1]) if np.isfinite(relative).all() else float("inf")
    separation = float(np.sqrt(sum(apart[i] for i in chosen)) / noise) if apart else float("nan")
    errors = {name: float(np.sqrt(covariance[k, k])) for k, name in enumerate(free)}
    moved = np.sqrt(np.mean(np.concatenate([slopes[i][0] for i in chosen]) ** 2, axis=0)) * 0.1 * size / noise
    visible = {name: float(moved[k]) for k, name in enumerate(free)}
    return Experiment(tuple(settings[i] for i in chosen), errors, separation, visible), volume, covariance


def _notes(best: tuple[Experiment, float, Any], free: dict[str, float], using: str) -> list[str]:
    experiment, _, covariance = best
    untold = [n for n, v in free.items() if not experiment.errors[n] < TOLD * (abs(v) or 1.0)]
    notes = [
        f"{using} cannot tell {n} here: its expected standard error is {_part(experiment.errors[n], free[n])} of its value; fix it"
        for n in untold
    ]
    notes += [
        f"{using} hardly tells {n}: a change by 10 % moves it by {part:.2g} of the noise of a sample, as a small error of the drive does; "
        "fix it"
        for n, part in experiment.visible.items()
        if part < FAINT and n not in untold
    ]
    if not np.isfinite(covariance).all():
        return notes
    names, size = list(free), np.sqrt(np.diag(covariance))
    for i in range(len(names)):
        for j in range(i):
            rho = covariance[i, j] / (size[i] * size[j]) if size[i] * size[j] > 0 else 0.0
            if abs(rho) > 0.95:
                notes.append(
                    f"{names[j]} and {names[i]} would be correlated {rho:.2f}: fix one or do another experiment with it (together=2)"
                )
    return notes


def _part(error: float, value: float) -> str:
    return f"{100 * error / abs(value):.3g} %" if value and np.isfinite(error) else "more than all"
