"""What an identification found: values, how sure they are, and what the residuals say."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from stickslip.arguments import Ax, explains_arguments
from stickslip.errors import InputError, Problems, did_you_mean, is_whole
from stickslip.faces import Face, Text, drawn_on, rounded, sure
from stickslip.identifying.fit_text import OVER_MOTION
from stickslip.identifying.spread import information_of
from stickslip.sealing import sealed

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from stickslip.identifying.designing import Design
    from stickslip.identifying.formulas import Combination
    from stickslip.information import Information

__all__ = ["Fit", "Quality"]

#: Parameters that are correlated more than this are named.
CORRELATED = 0.95
PARTS = ("total", "statistical", "systematic")
#: Ways to an interval, and the options of each.
METHODS: dict[str, tuple[str, ...]] = {"auto": (), "covariance": (), "profile": (), "bootstrap": ("repeats", "seed", "workers")}


@dataclass(frozen=True)
class Quality:
    """How well one record is met.

    Parameters
    ----------
    label, kind : str
    count : int
    rms : float
        Of the residuals, in the unit of the record [SI].
    noise : float
        What the record's own noise is, where that is known [SI]; NaN otherwise.
    r2 : float
        Part of the variance that is explained; NaN for a single number.
    correlation : float
        Of neighbouring residuals: 0 for white noise; near 1 what is left has a shape, so the law or the drive is not right.
    coloured : bool
        Whether residuals are those of noise at equal phases of the drive, so that a correlation is not due to law or drive.
    unit : str
        SI unit of the values.
    """

    label: str
    kind: str
    count: int
    rms: float
    noise: float
    r2: float
    correlation: float
    coloured: bool = False
    unit: str = ""

    @property
    def excess(self) -> str:
        """What is left, in words."""
        beside = f" where the noise is {self.noise:.3g} {self.unit}" if np.isfinite(self.noise) else ""
        return f"residuals of {self.rms:.3g} {self.unit}{beside}, neighbours correlated {self.correlation:.2f}"

    @property
    def suspicious(self) -> bool:
        """Whether more is left than noise."""
        white = 3.5 / np.sqrt(max(self.count, 1))
        too_large = (
            np.isfinite(self.noise)
            and self.rms > 1.15 * self.noise
            and self.rms**2 > self.noise**2 * (1 + 5 * np.sqrt(2 / max(self.count, 1)))
        )
        return bool(self.count > 20 and (abs(self.correlation) > max(white, 0.1) or too_large))


@sealed
@dataclass(frozen=True, eq=False, repr=False)
class Fit(Face):
    """The result of `identify`.

    Parameters
    ----------
    values : dict
        The free parameters.
    spread : array
        Covariance of all numbers that were fitted, on the scale of the search; infinite variance for those that the data do not determine.
    problem : Sensed
    place, jacobian, residuals : arrays
        End of the search, on its own scale; the Jacobian has an additional row for each number with a prior.
    scale : float
        Factor on the noise: 1 if the noise was given, else estimated from the residuals.
    starts, agree, steps : int
        Starting points of the search, number of refined ones that ended here, steps of the last refinement.
    notes : tuple of str
    law : str
    provenance : dict
    records : tuple
        What was fitted: records, and mean velocities.
    penalty : float
        Sum of squares of the priors.
    stopped : bool
        Whether the search was interrupted.
    doubts : tuple of str
        What cannot be of one machine: other frequencies of record and drive, motions of other sizes, numbers in a mistaken unit.

    Examples
    --------
    >>> import stickslip as ss
    >>> truth = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb", mu0=0.2)
    >>> rec = ss.virtual_rig(truth, noise=1e-4, seed=3)
    >>> fit = ss.identify(rec, ss.presets.piezo_rig, free={"mu0": (0.05, 0.5)}, tilt_deg=1.7, amplitude=6e-4, law="coulomb")
    >>> round(fit.values["mu0"], 3), fit.interval("mu0")[0] < 0.2 < fit.interval("mu0")[1]
    (0.2, True)
    """

    values: dict[str, float]
    spread: NDArray[np.float64]
    problem: Any
    place: NDArray[np.float64]
    jacobian: NDArray[np.float64]
    residuals: NDArray[np.float64]
    scale: float
    starts: int
    agree: int
    steps: int
    notes: tuple[str, ...]
    law: str
    provenance: dict[str, Any] = field(default_factory=dict)
    records: tuple[Any, ...] = ()
    penalty: float = 0.0
    stopped: bool = False
    doubts: tuple[str, ...] = ()

    # ---- how sure ----
    @property
    def names(self) -> tuple[str, ...]:
        """Names of the free parameters."""
        return tuple(self.values)

    @property
    def count(self) -> int:
        """Number of measured values."""
        return len(self.residuals)

    @property
    def fitted(self) -> int:
        """Number of fitted quantities, including phases and sensor effects."""
        known = len(self.jacobian) - self.count
        return max(len(self.names) + self.problem.nuisances - known, 0)

    @property
    def dof(self) -> int:
        """Degrees of freedom."""
        return max(self.count - self.fitted, 0)

    @property
    def cost(self) -> float:
        """Sum of squared residuals in standard deviations, including those of prior knowledge."""
        return float(self.residuals @ self.residuals) + self.penalty

    @cached_property
    def information(self) -> Information:
        """Information of the data on the parameters (on the scale of the search), including phases and sensor effects."""
        return information_of(self.problem, self.jacobian)

    @cached_property
    def covariance(self) -> NDArray[np.float64]:
        """Covariance of the free parameters in the order of `values`."""
        n = len(self.names)
        with np.errstate(invalid="ignore"):
            return np.asarray(self.spread[:n, :n] * np.outer(self.slopes, self.slopes))

    @property
    def errors(self) -> dict[str, float]:
        """Standard errors of the free parameters; infinite for those that the data do not determine (see `undetermined`)."""
        return dict(zip(self.names, np.sqrt(np.diag(self.covariance)).tolist(), strict=True))

    @property
    def sensor(self) -> dict[str, tuple[float, float]]:
        """Effects of the sensors: name -> (value, standard error); zero for fixed effects, infinite for undetermined ones.

        The delay of a record of steady motion is never determined: the drive's phase in the record is not known.
        """
        first = self.problem.first
        found = {n.name: (float(self.place[k]), float(np.sqrt(self.spread[k, k]))) for k, n in enumerate(self.problem.numbers, first)}
        found |= {n.name: (n.value, 0.0) for n in self.problem.held}
        asked = self.problem.given is None or "delay" in self.problem.given
        steady = any(t.kind in ("velocity", "position") for t in self.problem.targets)
        return found | ({"delay": (0.0, float("inf"))} if asked and steady and "delay" not in found else {})

    @property
    def combinations(self) -> list[tuple[str, float, float]]:
        """Combinations of undetermined parameters that the data do determine: (formula, value, standard error)."""
        return [(found.formula, found.value, found.error) for found in self.determined]

    @cached_property
    def determined(self) -> tuple[Combination, ...]:
        """The same, each with whether it also holds far from the fitted values."""
        from stickslip.identifying.formulas import combinations

        return tuple(combinations(self))

    @property
    def undetermined(self) -> tuple[str, ...]:
        """Parameters that the data do not determine: any value between their bounds fits as well, possibly with changes of others."""
        lost = {name for name, error in self.errors.items() if not np.isfinite(error)} - (set(self.flat) & set(self.bent))
        return tuple(name for name in self.names if name in lost or name in self.open)

    @property
    def flat(self) -> tuple[str, ...]:
        """Parameters that change nothing measured near their fitted value; a profile shows how far away they do (see `open`)."""
        alone = {members[0] for members, _ in self.information.groups if len(members) == 1}
        return tuple(name for k, name in enumerate(self.names) if k in alone)

    @cached_property
    def open(self) -> tuple[str, ...]:
        """Parameters whose interval reaches from bound to bound, although the curvature at the optimum gives a standard error."""
        from stickslip.identifying.uncertainty import open_parameters

        return tuple(open_parameters(self))

    @property
    def slopes(self) -> NDArray[np.float64]:
        """Derivative of each free parameter with respect to its search coordinate: array (parameters,)."""
        return np.array([f.slope(p) for f, p in zip(self.problem.parameters.free, self.place, strict=False)])

    @property
    def correlations(self) -> NDArray[np.float64]:
        """Correlations of the free parameters, in the order of `values`; NaN for parameters that the data do not determine."""
        size = np.sqrt(np.diag(self.covariance))
        known = np.isfinite(size)
        product = np.where(np.outer(known, known), np.outer(np.where(known, size, 0.0), np.where(known, size, 0.0)), np.nan)
        found = np.where(np.outer(known, known), self.covariance, np.nan) / np.where(product == 0, 1.0, product)
        found[~known, ~known] = 1.0
        return found

    @explains_arguments
    def interval(self, name: str, level: float = 0.95, method: str = "auto", part: str = "total", **options: Any) -> tuple[float, float]:
        """A confidence interval of a parameter.

        Parameters
        ----------
        name : str
        level : float
        method : {"auto", "covariance", "profile", "bootstrap"}
            From the curvature at the optimum (immediate); by refitting the other parameters on either side, which accounts for a
            likelihood that is not parabolic; or by repeated fits of resampled data (``repeats=200, seed=0, workers=1``; the same numbers
            for any workers). "auto" uses the covariance if the sum of squares is parabolic within two standard errors and to the ends of
            the interval, otherwise the profile; also for a parameter that has no effect near its value but may have one farther away.
        part : {"total", "statistical", "systematic"}
            The statistical part is due to noise alone, with sensor effects and priors fixed at their fitted values; the systematic part
            is what these add. The squares of the lengths on either side add up to that of the total.

        Returns
        -------
        tuple of float
            It ends at a bound if the data do not limit it before: at both bounds for a parameter that they do not determine.
        """
        problems = Problems("interval")
        if name not in self.values:
            problems.add(f"{name!r} is not a free parameter; {did_you_mean(name, self.values)}")
        if not 0 < level < 1:
            problems.add(f"level = {level!r}; allowed is a number between 0 and 1; type for example level=0.95")
        if method not in METHODS:
            problems.add(f"method = {method!r}; {did_you_mean(method, METHODS)}")
        if part not in PARTS:
            problems.add(f"part = {part!r}; {did_you_mean(part, PARTS)}")
        for option in options:
            if option not in METHODS.get(method, options):
                typed = f'; type method="bootstrap", {option}={options[option]!r}' if option in METHODS["bootstrap"] else ""
                problems.add(f"{option!r} is not an option of {method}, which has {', '.join(METHODS[method]) or 'none'}{typed}")
        problems.check()
        from stickslip.identifying.bootstrapping import by_bootstrap
        from stickslip.identifying.uncertainty import by_covariance, by_profile, calibrated, in_parts

        method = ("profile" if name in self.bent else "covariance") if method == "auto" else method
        by: Any = {"covariance": by_covariance, "profile": by_profile, "bootstrap": by_bootstrap}[method]
        whole = (float("nan"),) * 2 if part == "statistical" else by(self, name, level, **options)
        noise = (float("nan"),) * 2 if part == "total" else by(calibrated(self, name), name, level, **options)
        return {"total": whole, "statistical": noise, "systematic": in_parts(self.values[name], whole, noise)}[part]

    @explains_arguments
    def sample(
        self, draws: int = 1000, *, walkers: int | None = None, burn: int | None = None, seed: int = 0, progress: Any = None
    ) -> xr.Dataset:
        """Samples of the posterior of all numbers that were fitted, by emcee (``pip install "stickslip[bayes]"``).

        Priors are uniform between the bounds (in the logarithm with ``"log"``) or as given: ``("normal", mean, sd)``. Unknown noise has
        Jeffreys' prior and is integrated out; of correlated residuals only the independent number counts. The fit is the mode of this
        posterior unless a prior is ("uniform", low, high), of which the fit uses mean and standard deviation.

        Parameters
        ----------
        draws : int
            Draws of each walker after the first `burn`.
        walkers : int, optional
            By default 2 for each number and 2 more, at least 16.
        burn : int, optional
            By default half of the draws, at least 100.
        seed : int
        progress : callable or bool, optional

        Returns
        -------
        xarray.Dataset
            A variable (draw, walker) for each parameter, phase, and number of a sensor (``"sensor offset"``); attributes give the
            acceptance rate, the longest autocorrelation time, the number of independent draws, and a note if these are too few.

        References
        ----------
        D. Foreman-Mackey, D. W. Hogg, D. Lang and J. Goodman, emcee: the MCMC hammer, Publ. Astron. Soc. Pacific 125 (2013) 306-312.
        """
        from stickslip.identifying.sampling import posterior

        return posterior(self, draws, walkers, burn, seed, progress)

    @explains_arguments
    def bands(self, record: int = 0, level: float = 0.95, samples: xr.Dataset | None = None, draws: int = 200, seed: int = 0) -> xr.Dataset:
        """Bands of the model for a record: of its curve, and of new measurements with the noise of the record.

        Parameters
        ----------
        record : int
        level : float
            Fraction of the curves, or of the measurements, inside the band.
        samples : xarray.Dataset, optional
            From `sample`; if not given, numbers are drawn from the covariance.
        draws : int
            Number of curves that are computed.
        seed : int

        Returns
        -------
        xarray.Dataset
            ``measured``, ``fitted``, ``low``, ``high``, ``predicted_low``, ``predicted_high`` over the values of the record.
        """
        from stickslip.identifying.sampling import bands

        return bands(self, record, level, samples, draws, seed)

    @explains_arguments
    def next_experiment(
        self, experiments: Any, *, noise: float | None = None, samples: int = 2000, using: str | None = None, sensor: Any = None
    ) -> Design:
        """The next experiment that, fitted together with the present records, best determines the parameters that these do not determine.

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
        from stickslip.identifying.next_experiment import next_experiment

        return next_experiment(self, experiments, noise, samples, using, sensor)

    # ---- what was fitted ----
    @explains_arguments
    def model(self, record: int = 0) -> Any:
        """The fitted model of one record: a robot, or a law where force was fitted against motion."""
        count = len(self.problem.parameters.fixed)
        if not is_whole(record) or not 0 <= record < count:
            raise InputError("fit", [f"record = {record!r}; allowed is a whole number from 0 to {count - 1}; type record=0"])
        return self.problem.parameters.model(self.values, record)

    @cached_property
    def predicted(self) -> tuple[Any, ...]:
        """Values of the fitted model at the samples of each record [SI]."""
        return self._split(self.problem.predicted(self.place))

    def _split(self, whole: Any) -> tuple[Any, ...]:
        edges = np.cumsum([0, *(t.count for t in self.problem.targets)])
        return tuple(whole[a:b] for a, b in pairwise(edges))

    @cached_property
    def quality(self) -> tuple[Quality, ...]:
        """Goodness of fit of each record."""
        from stickslip.identifying.uncertainty import quality

        return quality(self)

    @cached_property
    def bent(self) -> tuple[str, ...]:
        """Parameters along whose interval the sum of squares is not a parabola, so covariance and bootstrap intervals are unreliable."""
        from stickslip.identifying.uncertainty import bent_parameters

        return tuple(bent_parameters(self))

    @property
    def correlated(self) -> list[str]:
        """Sentences on pairs of parameters that these data can hardly distinguish."""
        found, table = [], self.correlations
        for i in range(len(self.names)):
            for j in range(i):
                if abs(table[i, j]) > CORRELATED:
                    found.append(f"{self.names[j]} and {self.names[i]} correlated {table[i, j]:.2f}: fix one or {self.remedy}")
        return found

    @property
    def remedy(self) -> str:
        """A remedy for parameters that these data cannot distinguish."""
        count = len(self.problem.targets)
        if self.problem.targets[0].kind in OVER_MOTION:
            return "add a record with another stroke or speed"
        return "add a second amplitude" if count == 1 else "add a record with another amplitude or frequency (see ss.design)"

    @cached_property
    def costs(self) -> dict[str, dict[str, float]]:
        """Standard error of each parameter if one effect of the sensors were known: effect -> name -> error; under "" if all were."""
        from stickslip.identifying.uncertainty import costs

        return costs(self)

    @property
    def warnings(self) -> list[str]:
        """Warnings about the fitted values."""
        from stickslip.identifying.uncertainty import remarks

        return [*self.doubts, *remarks(self), *self.correlated, *self.notes]

    def distribution(self, machine: Any, problems: Problems) -> Any:
        """The distribution of a machine's numbers under the fit, for `propagate` and `optimise`."""
        from stickslip.identifying.distribution import distribution_of

        return distribution_of(self, machine, problems)

    # ---- show ----
    @overload
    def report(self, path: None = None) -> str: ...
    @overload
    def report(self, path: str | Path) -> Path: ...
    @explains_arguments
    def report(self, path: str | Path | None = None) -> str | Path:
        """The fit as text; with a path, as an HTML file with data, fit, residuals, uncertainties and provenance (returns its path)."""
        if path is None:
            from stickslip.identifying.fit_text import report_text

            return Text(report_text(self))
        from stickslip.identifying.fit_pages import write_report

        return write_report(path, [self])

    @explains_arguments
    def plot(self, record: int = 0, ax: Ax = None) -> Axes:
        """Record and fit over one drive period; returns the axes."""
        from stickslip.identifying.fit_pages import plot_fit

        return plot_fit(self, record, ax)

    def _title(self) -> str:
        return f"Fit of {self.law}"

    def _facts(self) -> dict[str, str]:
        from stickslip.identifying.fit_text import known_line, sensor_lines

        told = [line.partition(": ") for line in (known_line(self), *sensor_lines(self)) if line]
        return {name: line for name, _, line in told}

    def _tables(self) -> list[list[tuple[str, ...]]]:
        from stickslip.identifying.fit_text import error_text, parameter_rows, unit_of_parameter

        head = ("parameter", "value", "standard error", "95 % interval", "unit")
        rows = [
            (
                name,
                rounded(value, error),
                error_text(self, name),
                f"{rounded(low, error)} to {rounded(high, error)}",
                unit_of_parameter(self, name),
            )
            for name, value, error, low, high in parameter_rows(self)
        ]
        return [[head, *rows], [("record", "what is left"), *((q.label, q.excess) for q in self.quality)]]

    def _remarks(self) -> list[str]:
        return self.warnings

    def _figures(self) -> list[Any]:
        return drawn_on(self._draw_both, (8.0, 2.2))

    def _draw_both(self, figure: Any) -> None:
        from stickslip.identifying.fit_pages import plot_fit, plot_residuals

        left, right = figure.subplots(1, 2)
        plot_fit(self, 0, left)
        plot_residuals(self, 0, right)

    def __repr__(self) -> str:
        parts = ", ".join(f"{n} = {v:.5g} {sure(self.errors[n], '.1g')}" for n, v in self.values.items())
        return f"<Fit of {self.law}: {parts}>"
