"""The result of an identification: values, their uncertainty, and an analysis of the residuals."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from stickslip.basics.arguments import Ax, described_as, explains_arguments
from stickslip.basics.errors import InputError, Problems, did_you_mean, is_whole, no_attribute
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import interruptible
from stickslip.basics.notebook_display import Face, Text, drawn_on, sure
from stickslip.basics.presenting import presenter
from stickslip.inverse.identification import formulas, next_experiment, posterior as distribution, profiles, sampling, uncertainty
from stickslip.inverse.identification.bootstrapping import by_bootstrap
from stickslip.inverse.identification.covariance import correlated, correlations_of, from_the_input, information_of, lost_to_the_input
from stickslip.inverse.identification.fit_text import OVER_MOTION
from stickslip.inverse.identification.quality import quality
from stickslip.inverse.identification.symmetry import symmetry

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from stickslip.basics.information import Information

PARTS = ("total", "statistical", "systematic", "input")
#: Ways to an interval, and the options of each.
METHODS: dict[str, tuple[str, ...]] = {"auto": (), "covariance": (), "profile": (), "bootstrap": ("repeats", "seed", "workers", "executor")}


@described_as("a Fit; type for example ss.identify(record, ss.presets.piezo_rig, free=...)")
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
    problem : MeasuredProblem
    point, jacobian, residuals : arrays
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
    contradictions : tuple of str
        What cannot be of one machine: other frequencies of record and drive, motions of other sizes, numbers in a mistaken unit.
    changes : array or None
        By how much other noise of the input (position, load) would change what is met, in standard deviations: (values, repetitions).
    misfit : Misfit or None
        What is left besides noise, and what that makes of the errors.
    in_amperes : bool
        Whether torques are over a motor constant that nobody gave (`stickslip.fit` of a current), so that they stand in amperes.

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
    point: NDArray[np.float64]
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
    contradictions: tuple[str, ...] = ()
    changes: NDArray[np.float64] | None = None
    misfit: Any = None
    in_amperes: bool = False

    if not TYPE_CHECKING:  # a type checker would take every name for one of ours

        def __getattr__(self, name: str) -> Any:
            return no_attribute(self, name, {"place": "point", "doubts": "contradictions"})

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
        return max(int(np.sum(self.problem.unclipped(self.residuals))) - self.fitted, 0)

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
        numbers = self._numbers("the sensor")
        asked = self.problem.given is None or "delay" in self.problem.given
        steady = any(t.kind in ("velocity", "position") for t in self.problem.targets)
        return numbers | ({"delay": (0.0, float("inf"))} if asked and steady and "delay" not in numbers else {})

    @property
    def drive(self) -> dict[str, tuple[float, float]]:
        """Harmonics of the drive besides those of the model, in parts of its amplitude: name -> (value, standard error).

        ``sin2`` is the sine of the second, ``cos3[1]`` the cosine of the third in the experiment of the second record.
        """
        return self._numbers("the drive")

    def _numbers(self, of: str) -> dict[str, tuple[float, float]]:
        """Numbers of the sensors, or of the drive: name -> (value, standard error)."""
        own = ((k, n) for k, n in enumerate(self.problem.numbers, self.problem.first) if n.of == of)
        fitted = {n.name: (float(self.point[k]), float(np.sqrt(self.spread[k, k]))) for k, n in own}
        return fitted | {n.name: (n.value, 0.0) for n in self.problem.held if n.of == of}

    @cached_property
    def input_spread(self) -> NDArray[np.float64]:
        """Standard error of each parameter from noise of the motion, on the scale of the search: array (parameters,)."""
        n = len(self.names)
        covariance = from_the_input(self.problem, self.jacobian, self.changes)
        return np.sqrt(np.diag(covariance)[:n]) if np.ndim(covariance) else np.zeros(n)

    @property
    def input_errors(self) -> dict[str, float]:
        """Part of each standard error that comes from noise of the input: of the motion, or the load, over which a force was measured."""
        return dict(zip(self.names, (self.input_spread * self.slopes).tolist(), strict=True))

    @property
    def lost(self) -> tuple[str, ...]:
        """Parameters that noise of the input leaves undetermined."""
        return tuple(self.names[k] for k in lost_to_the_input(self.problem, self.jacobian, self.changes))

    @property
    def combinations(self) -> list[tuple[str, float, float]]:
        """Combinations of undetermined parameters that the data do determine: (formula, value, standard error)."""
        return [(combination.formula, combination.value, combination.error) for combination in self.determined]

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

    @property
    def slopes(self) -> NDArray[np.float64]:
        """Derivative of each free parameter with respect to its search coordinate: array (parameters,)."""
        return np.array([f.slope(p) for f, p in zip(self.problem.parameters.free, self.point, strict=False)])

    @property
    def correlations(self) -> NDArray[np.float64]:
        """Correlations of the free parameters, in the order of `values`; NaN for parameters that the data do not determine."""
        return np.asarray(correlations_of(self.covariance))

    @explains_arguments
    @interruptible
    def interval(self, name: str, level: float = 0.95, method: str = "auto", part: str = "total", **options: Any) -> tuple[float, float]:
        """A confidence interval of a parameter.

        Parameters
        ----------
        name : str
        level : float
        method : {"auto", "covariance", "profile", "bootstrap"}
            From the curvature at the optimum (immediate); by refitting the other parameters on either side, which accounts for a
            likelihood that is not parabolic; or by repeated fits of resampled data (``repeats=200, seed=0, workers=1, executor=None``; the
            same numbers for any workers or executor, see `sweep`). "auto" uses the covariance if the sum of squares is parabolic within
            two standard errors and to the ends of the interval, otherwise the profile (under noise of the motion, or beside a misfit, of
            which a profile sees less, the outer ends of both); also for a parameter that has no effect near its value but may have one
            farther away.
        part : {"total", "statistical", "systematic", "input"}
            The statistical part is due to noise alone, with sensor effects and priors fixed at their fitted values; the systematic part
            is what these add. The squares of the lengths on either side add up to that of the total. "input" is the part of either that
            comes from noise of the motion, or of the load, over which a force was measured.

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
        if part == "input":
            return uncertainty.by_input(self, name, level)
        if name in self.lost:
            free = self.problem.parameters.free[self.names.index(name)]
            return (free.low, free.high) if part == "total" else (float("nan"),) * 2
        wider = self.changes is not None or (self.misfit is not None and not self.misfit.is_none)  # by what no profile has in it
        rough = "either" if wider and np.isfinite(self.errors[name]) else "profile"
        method = (rough if name in self.bent else "covariance") if method == "auto" else method
        ways = {"covariance": uncertainty.by_covariance, "profile": profiles.by_profile, "either": uncertainty.by_either}
        by: Any = by_bootstrap if method == "bootstrap" else ways[method]
        whole = (float("nan"),) * 2 if part == "statistical" else by(self, name, level, **options)
        noise = (float("nan"),) * 2 if part == "total" else by(uncertainty.calibrated(self, name), name, level, **options)
        return {"total": whole, "statistical": noise, "systematic": uncertainty.in_parts(self.values[name], whole, noise)}[part]

    @cached_property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """95 % intervals of all parameters, as reports show them."""
        return {name: self.interval(name) for name in self.names}

    determined = cached_property(formulas.combinations)
    open = cached_property(profiles.open_parameters)
    bent = cached_property(profiles.bent_parameters)
    bent_nearby = cached_property(profiles.bent_nearby)
    beside_open = cached_property(profiles.beside_open)
    costs = cached_property(uncertainty.costs)
    symmetry = cached_property(symmetry)
    quality = cached_property(quality)
    sample = explains_arguments(sampling.sample)
    bands = explains_arguments(sampling.bands)
    next_experiment = explains_arguments(next_experiment.next_experiment)
    distribution = distribution.distribution_of

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
        return tuple(self.problem.parts(self.problem.predicted(self.point)))

    @property
    def correlated(self) -> list[str]:
        """Sentences on pairs of parameters that these data can hardly distinguish."""
        sentences = []
        for one, other, rho in correlated(list(self.names), self.covariance):
            what = uncertainty.through_the_sensor(self, one, other)
            remedy = f"through the {what} of the sensor: calibrate it" if what else f"fix one or {self.remedy}"
            sentences.append(f"{one} and {other} correlated {rho:.2f}{' ' if what else ': '}{remedy}")
        return sentences

    @property
    def remedy(self) -> str:
        """A remedy for parameters that these data cannot distinguish."""
        count = len(self.problem.targets)
        if self.problem.targets[0].kind in OVER_MOTION:
            return "add a record with another stroke or speed"
        return "add a second amplitude" if count == 1 else "add a record with another amplitude or frequency (see ss.identification.design)"

    @property
    def warnings(self) -> list[str]:
        """Warnings about the fitted values."""
        return [*self.contradictions, *uncertainty.remarks(self), *self.correlated, *self.notes]

    # ---- show ----
    @overload
    def report(self, path: None = None) -> str: ...
    @overload
    def report(self, path: str | Path) -> Path: ...
    @explains_arguments
    def report(self, path: str | Path | None = None) -> str | Path:
        """The fit as text; with a path, as an HTML file with data, fit, residuals, uncertainties and provenance (returns its path)."""
        if path is None:
            from stickslip.inverse.identification.fit_text import report_text

            return Text(report_text(self))
        return presenter("report", "fit")(path, [self])

    @explains_arguments
    def plot(self, record: int = 0, ax: Ax = None) -> Axes:
        """Record and fit over one drive period; returns the axes."""
        return presenter("figure", "fitted")(self, record, ax)

    def _title(self) -> str:
        return f"Fit of {self.law}"

    def _facts(self) -> dict[str, str]:
        from stickslip.inverse.identification.fit_text import known_line, sensor_lines

        lines = [line.partition(": ") for line in (known_line(self), *sensor_lines(self)) if line]
        return {name: line for name, _, line in lines}

    def _tables(self) -> list[list[tuple[str, ...]]]:
        from stickslip.inverse.identification.fit_text import parameter_rows

        head = ("parameter", "value", "standard error", "95 % interval", "unit")
        each = parameter_rows(self)
        rows = [(row["name"], row["value"], row["error"], f"{row['low']} to {row['high']}", row["unit"]) for row in each]
        return [[head, *rows], [("record", "what is left"), *((q.label, q.excess) for q in self.quality)]]

    def _remarks(self) -> list[str]:
        return self.warnings

    def _figures(self) -> list[Any]:
        return drawn_on(self._draw_both, (8.0, 2.2))

    def _draw_both(self, figure: Any) -> None:
        left, right = figure.subplots(1, 2)
        presenter("figure", "fitted")(self, 0, left)
        presenter("figure", "residuals")(self, 0, right)

    def __repr__(self) -> str:
        parts = ", ".join(f"{n} = {v:.5g} {sure(self.errors[n], '.1g')}" for n, v in self.values.items())
        return f"<Fit of {self.law}: {parts}>"
