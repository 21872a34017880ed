"""`propagate`: what uncertain numbers make of a result, and which of them matter."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Executes, Model, described_as, explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import Problems
from stickslip.basics.executors import HERE, Workers
from stickslip.basics.fields import leaves
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import Ending, interruptible, look, partial_result, taking_some_cases
from stickslip.basics.notebook_display import Drawn, rounded, sure
from stickslip.basics.progress import progress_callback
from stickslip.basics.status import Status
from stickslip.dynamics.stroboscopic.strobe_maps import spread_over
from stickslip.inverse.optimisation.results import check_quantity, results_of, unit_of_result
from stickslip.inverse.optimisation.uncertainty_samples import check_sample, checked_spread, sampled
from stickslip.studies.designs import sobol_cube

if TYPE_CHECKING:
    from stickslip.inverse.identification.fit import Fit

_LEAST = 16  # cases of an interrupted sample from which its distribution is still told
_TAILS = (0.05, 0.95)  # of its own distribution: where a number is put alone
_LEVEL, _RESAMPLED = 0.95, 400  # of the intervals of indices


@described_as("Sobol indices; type ss.optimisation.propagate(robot, uncertain=..., indices=True).indices")
@sealed
@dataclass(frozen=True, eq=False)
class Indices(Drawn):
    """Sobol indices: the fraction of the variance of a result that is due to each number.

    Parameters
    ----------
    first : dict of float
        Fraction due to each number alone.
    total : dict of float
        Fraction that would remain if all other numbers were known: larger than `first` if numbers interact.
    first_interval, total_interval : dict of (float, float)
        95 % intervals of the sample, by the bootstrap.

    Examples
    --------
    >>> Indices({"mass": 0.8}, {"mass": 0.9}, {"mass": (0.71, 0.9)}, {"mass": (0.82, 0.97)})
    <Indices, with 95 % intervals: mass 0.80 (0.71 to 0.90), total 0.90 (0.82 to 0.97)>
    """

    first: dict[str, float]
    total: dict[str, float]
    first_interval: dict[str, tuple[float, float]]
    total_interval: dict[str, tuple[float, float]]

    _drawn_by = "indices"

    def _tables(self) -> list[list[tuple[str, ...]]]:
        spans = (_spans(self, name) for name in self.first)
        rows = ((n, f"{self.first[n]:z.2f}", a, f"{self.total[n]:z.2f}", b) for n, (a, b) in zip(self.first, spans, strict=True))
        return [[("number", "first index", "95 % interval", "total index", "95 % interval"), *rows]]

    def __repr__(self) -> str:
        ends = {name: _spans(self, name) for name in self.first}
        listed = (f"{n} {self.first[n]:z.2f} ({a}), total {self.total[n]:z.2f} ({b})" for n, (a, b) in ends.items())
        return f"<Indices, with 95 % intervals: {'; '.join(listed)}>"


def _spans(indices: Indices, name: str) -> tuple[str, ...]:
    """The intervals of both indices of a number, as text."""
    return tuple(f"{low:z.2f} to {high:z.2f}" for low, high in (indices.first_interval[name], indices.total_interval[name]))


@described_as("what ss.optimisation.propagate returns; type ss.optimisation.propagate(robot, uncertain=...)")
@sealed
@dataclass(frozen=True, eq=False)
class Propagated(Drawn):
    """The distribution of a result under uncertain numbers; `stickslip.plot.tornado` draws their influence.

    Parameters
    ----------
    of : str
        The result.
    values : array (samples,)
        Its values; NaN where a case has none.
    inputs : dict of arrays (samples,)
        The corresponding numbers.
    nominal : float
        Its value for the nominal machine.
    swings : dict of (float, float)
        Its values with one number at the 5 % and 95 % quantiles of its distribution and the others at their nominal values.
    indices : Indices or None
        Sobol indices, if they were asked for.
    notes : tuple of str
        Remarks.
    unit : str
        Unit of the values; empty for a bare number.

    Examples
    --------
    >>> found = Propagated("mean_velocity", np.array([1.0, 2.0, 3.0]), {}, 2.0)
    >>> found.mean, found.quantile(0.5), found.failed
    (2.0, 2.0, 0)
    """

    of: str
    values: Array
    inputs: dict[str, Array]
    nominal: float
    swings: dict[str, tuple[float, float]] | None = None
    indices: Indices | None = None
    notes: tuple[str, ...] = ()
    unit: str = ""

    @property
    def mean(self) -> float:
        """Mean over the sample."""
        return float(np.nanmean(self.values))

    @property
    def std(self) -> float:
        """Standard deviation over the sample."""
        return float(np.nanstd(self.values))

    @property
    def failed(self) -> int:
        """Cases without a value."""
        return int(np.isnan(self.values).sum())

    def quantile(self, q: float) -> float:
        """The q-quantile of the sample."""
        return float(np.nanquantile(self.values, q))

    _drawn_by = "tornado"

    def _facts(self) -> dict[str, Any]:
        low, high = (self.quantile(q) for q in (0.05, 0.95))
        cases = f"{len(self.values)}" + (f", {self.failed} of them have none" if self.failed else "")
        error = self.std / max(len(self.values) - self.failed, 1) ** 0.5
        facts = {
            "nominal": f"{self.nominal:.6g}",
            "mean": f"{rounded(self.mean, error)} {sure(error)}",
            "standard deviation": f"{self.std:.3g}",
            "nine in ten": f"{low:.4g} to {high:.4g}",
        }
        return {"of": self.of, **{name: f"{text} {self.unit}".rstrip() for name, text in facts.items()}, "cases": cases}

    def _tables(self) -> list[list[tuple[str, ...]]]:
        return self.indices._tables() if self.indices is not None else []

    def __repr__(self) -> str:
        low, middle, high = (self.quantile(q) for q in (0.05, 0.5, 0.95))
        lost = f"; {self.failed} cases have none" if self.failed else ""
        more = "".join(f"; {note}" for note in self.notes)
        return (
            f"<Propagated: {self.of} = {self.nominal:.6g} {self.unit}".rstrip()
            + f"; over {len(self.values)} cases mean {self.mean:.6g}, std {self.std:.3g}, median {middle:.6g}, "
            f"nine in ten from {low:.6g} to {high:.6g} {self.unit}".rstrip()
            + f"{lost}{more}>"
        )


@explains_arguments
@interruptible
def propagate(
    model: Model,
    uncertain: dict[str, Any] | Fit,
    of: str = "mean_velocity",
    samples: int = 1024,
    seed: int = 0,
    workers: int = 1,
    executor: Executes = None,
    indices: bool = False,
    progress: Callable[[int, int], Any] | bool | None = None,
) -> Propagated:
    """Propagate uncertain numbers to a result of the steady motion from rest, and rank their influence.

    Parameters
    ----------
    model : Robot or machine
        One machine with a period.
    uncertain : dict or Fit
        By the names of numbers ("uniform", least, largest), ("normal", mean, standard deviation), or (mean, "1%") for a normal distribution
        whose standard deviation is that fraction of the mean; independent of one another. Without an index a name stands for the numbers of
        all parts, which are then equal. A `Fit` stands for its fitted parameters: they are normally distributed on the scale of its search,
        with its covariance, and truncated at its bounds; the numbers of `model` that depend on them are set.
    of : str
        "mean_velocity", or another column of a sweep.
    samples : int
        Number of points of a scrambled Sobol sequence; rounded to a power of two.
    seed : int
        Seed of its scrambling.
    workers : int
        Threads.
    executor : executor or callable, optional
        Compute there, as for `sweep`; `workers` is then the number of its workers.
    indices : bool
        Whether to compute Sobol indices of the numbers, which must be independent; n numbers need n + 2 times as many cases (Saltelli
        2010).
    progress : callable or bool, optional
        True for a progress line, or a function that is called with (cases done, in all).

    Returns
    -------
    Propagated
        `values`, `inputs`, `mean`, `std`, `quantile`, `swings`, `indices`.

    Raises
    ------
    InputError
        For unknown names, for distributions that reach values which are not allowed, for parameters that a fit's data do not determine, and
        for Sobol indices of a fit of several parameters, which are not independent.

    References
    ----------
    A. Saltelli et al., Variance based sensitivity analysis of model output; *Computer Physics Communications*
    181 (2010) 259-270, doi:10.1016/j.cpc.2009.09.018.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    >>> found = ss.optimisation.propagate(robot, uncertain={"friction.mu_plus": ("normal", 0.15, 0.005)}, of="mean_velocity", samples=256)
    >>> round(found.std / 0.005, 2)  # about the slope with respect to the friction coefficient
    0.09
    """
    check_quantity("propagate", "of", of, model)
    problems = Problems("propagate")
    spread = checked_spread(model, "uncertain", uncertain, problems)
    problems.whole("samples", samples, 2, example=1024, most=2**20)
    problems.whole("seed", seed, 0, example=0)
    crew = Workers(workers, executor)
    crew.note(problems)
    if any(np.ndim(value) for _, value in leaves(model)):
        problems.add("the robot is a batch (some of its numbers are arrays); allowed is one robot")
    if model.period is None:
        problems.add(f"{type(model).__name__} has no period; allowed are machines with a drive, such as a Robot")
    if indices and spread is not None and not spread.independent:
        problems.add(
            "indices of numbers that depend on one another are not defined; type indices=False, or give each a distribution of its own"
        )
    problems.check()
    watch = progress_callback(progress, "propagate")
    u = _designed(len(spread.names), samples, int(seed), indices)
    nominal = float(results_of(spread_over(model, 1), 1)[of][0])
    values: Array = np.empty(0)
    there: Array = np.empty(0, bool)
    with partial_result() as ending, taking_some_cases():
        values, there = _run(model, spread.numbers(u.reshape(len(u), -1)), of, crew, watch)
        if not there.all():
            look()
    if ending.interrupted:
        return _part(model, of, spread, u, values, there, nominal, ending)
    values = values.reshape(u.shape[1:])
    sobol, notes = _indices(spread.names, values, int(seed)) if indices else (None, [])
    kept = values[:2] if indices else values  # the other rows of a design for indices are mixtures of the first two
    inputs = spread.inputs(u[:, : len(kept)].reshape(len(u), -1))
    return Propagated(of, kept.ravel(), inputs, nominal, _swings(model, spread, of), sobol, tuple(notes), unit_of_result(of, model))


def _part(model: Model, of: str, spread: Any, u: Array, values: Array, there: Array, nominal: float, ending: Ending) -> Propagated:
    """What an interrupted run of a sample gives: the first points, up to one that is not computed, since the rest would be a selection."""
    kept = min(int(np.argmin([*there, False])), min(u.shape[1], 2) * u.shape[2])
    ending.needs(kept >= _LEAST)
    inputs = {name: column[:kept] for name, column in spread.inputs(u.reshape(len(u), -1)).items()}
    note = ending.note(f"the first {kept} of {u[0].size} cases, without swings and indices")
    return Propagated(of, values[:kept], inputs, nominal, None, None, (note,), unit_of_result(of, model))


def _designed(count: int, samples: int, seed: int, indices: bool) -> Array:
    """Points of the unit cube: array (numbers, 1, samples); for indices (numbers, 2 + numbers, samples), two samples and mixtures."""
    if not indices:
        return sobol_cube(samples, count, seed).T[:, None]
    A, B = np.split(sobol_cube(samples, 2 * count, seed).T, 2)
    mixed = np.repeat(A[:, None], count, axis=1)
    mixed[np.arange(count), np.arange(count)] = B
    return np.concatenate([A[:, None], B[:, None], mixed], axis=1)


def _run(
    model: Model, sample: dict[str, Array], of: str, workers: Workers = HERE, watch: Callable[[int, int], Any] | None = None
) -> tuple[Array, Array]:
    """A result for each case of a sample, and whether it was computed."""
    check_sample("propagate", model, sample)
    machines, cases = sampled(model, 1, sample)
    results = results_of(machines, cases, workers, watch=watch)
    return results[of], results["status"] != Status.NOT_COMPUTED


def _swings(model: Model, spread: Any, of: str) -> dict[str, tuple[float, float]]:
    """The result where each number in turn is at the ends of its band."""
    ends = {name: _run(model, spread.alone(name, np.array(_TAILS)), of)[0] for name in spread.names}
    return {name: (float(low), float(high)) for name, (low, high) in ends.items()}


def _indices(names: tuple[str, ...], values: Array, seed: int) -> tuple[Indices | None, list[str]]:
    """Sobol indices of a design with mixtures; none with the reason where the values have no variance, or not all cases have one."""
    if np.isnan(values).any():
        return None, [f"no indices: {int(np.isnan(values).sum())} cases have no value"]
    if not np.ptp(values[:2]) > 0.0:
        return None, ["no indices: all values are the same"]
    rng, n = np.random.default_rng(seed), values.shape[1]
    estimates = _estimated(values)
    again = np.array([_estimated(values[:, rng.integers(n, size=n)]) for _ in range(_RESAMPLED)])
    low, high = np.quantile(again, [0.5 - 0.5 * _LEVEL, 0.5 + 0.5 * _LEVEL], axis=0)
    first, total = (dict(zip(names, map(float, part), strict=True)) for part in estimates)
    ends = (zip(map(float, a), map(float, b), strict=True) for a, b in zip(low, high, strict=True))
    bands = [dict(zip(names, part, strict=True)) for part in ends]
    return Indices(first, total, *bands), []


def _estimated(values: Array) -> Array:
    """First and total indices, by the estimators of Saltelli 2010 and Jansen 1999: array (2, numbers)."""
    A, B, mixed = (part - values[:2].mean() for part in (values[0], values[1], values[2:]))
    variance = 0.5 * np.mean(A * A + B * B)
    return np.array([np.mean(B * (mixed - A), axis=1), 0.5 * np.mean((A - mixed) ** 2, axis=1)]) / variance
