"""Numbers that are not known exactly: their distributions, evenly spread samples of them, and what they do to a result."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.arguments import Model, explains_arguments
from stickslip.dynamics.mapping import spread_over
from stickslip.dynamics.named import numbers_meant
from stickslip.errors import InputError, Problems, did_you_mean
from stickslip.fields import leaves, replace_leaf
from stickslip.optimising.results import check_quantity, results_of
from stickslip.sealing import sealed

__all__ = ["Propagated", "Uncertain", "checked_uncertain", "propagate", "sample_of", "sampled"]

Array = Any
_TYPED = '{"friction.mu_plus": ("uniform", 0.13, 0.17)} or {"friction.mu_plus": ("normal", 0.15, 0.01)}'


@dataclass(frozen=True)
class Uncertain:
    """Numbers with one distribution, taken together: "uniform" from a to b, or "normal" with mean a and standard deviation b."""

    name: str
    leaves: tuple[str, ...]
    kind: str
    a: float
    b: float

    def at(self, u: Array) -> Array:
        """The numbers below which a part u of the distribution lies."""
        from scipy.stats import norm

        return self.a + (self.b - self.a) * u if self.kind == "uniform" else self.a + self.b * norm.ppf(u)


def checked_uncertain(model: Any, argument: str, given: Any, problems: Problems) -> list[Uncertain]:
    """The distributions that were typed; what is wrong with them is noted."""
    if not isinstance(given, dict) or not given:
        problems.add(f"{argument} = {given!r}; allowed is a dict of distributions; type {argument}={_TYPED}")
        return []
    known, found = [name for name, _ in leaves(model)], []
    for name, said in given.items():
        meant = numbers_meant(str(name), known)
        if not meant:
            problems.add(f"{argument}: {name!r} is no number of {type(model).__name__}; {did_you_mean(str(name), known)}")
        elif (each := _distribution(str(name), meant, said)) is None:
            allowed = '("uniform", least, largest) or ("normal", mean, standard deviation)'
            problems.add(f"{argument}[{name!r}] = {said!r}; allowed is {allowed}; type for example {_TYPED}")
        else:
            found.append(each)
    return found


def _distribution(name: str, meant: tuple[str, ...], said: Any) -> Uncertain | None:
    try:
        kind, a, b = said
        a, b = float(a), float(b)
    except (TypeError, ValueError):
        return None
    good = np.isfinite([a, b]).all() and ((kind == "uniform" and a < b) or (kind == "normal" and b > 0.0))
    return Uncertain(name, meant, kind, a, b) if good else None


def sample_of(uncertain: list[Uncertain], count: int, seed: int) -> dict[str, Array]:
    """A scrambled Sobol sample of the numbers, by name: arrays (count,), a power of two.

    Examples
    --------
    >>> found = sample_of([Uncertain("tilt", ("track.tilt",), "uniform", 0.0, 1.0)], 4, seed=1)
    >>> sorted((4 * found["track.tilt"]).astype(int).tolist())  # one in each quarter
    [0, 1, 2, 3]
    """
    from scipy.stats import qmc

    u = qmc.Sobol(len(uncertain), seed=np.random.default_rng(seed)).random_base2(round(np.log2(count)))
    return {name: each.at(np.clip(u[:, i], 1e-12, 1.0 - 1e-12)) for i, each in enumerate(uncertain) for name in each.leaves}


def sampled(machines: Any, count: int, sample: dict[str, Array]) -> tuple[Any, int]:
    """Each of some machines with each of the sample's numbers, the sample's inside: a batch, and its size."""
    size = len(next(iter(sample.values())))
    numbers = {name: np.repeat(np.broadcast_to(np.asarray(value, float), (count,)), size) for name, value in leaves(machines)}
    return replace_leaf(machines, numbers | {name: np.tile(values, count) for name, values in sample.items()}), count * size


@sealed
@dataclass(frozen=True, eq=False)
class Propagated:
    """What uncertain numbers make of a result.

    Parameters
    ----------
    of : str
        The result.
    values : array (samples,)
        Its values; NaN where a case has none.
    inputs : dict of arrays (samples,)
        The numbers that they belong to.
    nominal : float
        Its value for the machine as it is.

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
        """The value below which a part q of the sample lies."""
        return float(np.nanquantile(self.values, q))

    def __repr__(self) -> str:
        low, middle, high = (self.quantile(q) for q in (0.05, 0.5, 0.95))
        lost = f"; {self.failed} cases have none" if self.failed else ""
        return (
            f"<Propagated: {self.of} = {self.nominal:.6g}; over {len(self.values)} cases mean {self.mean:.6g}, std {self.std:.3g}, "
            f"median {middle:.6g}, nine in ten from {low:.6g} to {high:.6g}{lost}>"
        )


@explains_arguments
def propagate(
    model: Model, uncertain: dict[str, Any], of: str = "mean_velocity", samples: int = 1024, seed: int = 0, workers: int = 1
) -> Propagated:
    """What uncertain numbers make of a result of the steady motion from rest.

    Parameters
    ----------
    model : Robot or machine
        One machine with a period.
    uncertain : dict
        By the names of numbers ("uniform", least, largest) or ("normal", mean, standard deviation); independent of one another. Without
        an index a name stands for the numbers of all parts, which are then the same.
    of : str
        "mean_velocity", or another column of a sweep.
    samples : int
        Of a scrambled Sobol sequence; rounded to a power of two.
    seed : int
        Of its scrambling.
    workers : int
        Threads.

    Returns
    -------
    Propagated
        `values`, `inputs`, `mean`, `std`, `quantile`.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    >>> found = ss.propagate(robot, uncertain={"friction.mu_plus": ("normal", 0.15, 0.005)}, of="mean_velocity", samples=256)
    >>> round(found.std / 0.005, 2)  # the slope by the coefficient of friction, about
    0.09
    """
    check_quantity("propagate", "of", of, model)
    problems = Problems("propagate")
    spread = checked_uncertain(model, "uncertain", uncertain, problems)
    problems.whole("samples", samples, 2, example=1024, most=2**20)
    problems.whole("seed", seed, 0, example=0)
    problems.whole("workers", workers, 1, example=2)
    if any(np.ndim(value) for _, value in leaves(model)):
        problems.add("the robot is a batch (some of its numbers are arrays); allowed is one robot")
    if model.period is None:
        problems.add(f"{type(model).__name__} has no period; allowed are machines with a drive, such as a Robot")
    problems.check()
    sample = sample_of(spread, samples, int(seed))
    try:
        model.replace(sample)  # the record says what its numbers may be
    except InputError as error:
        raise InputError("propagate", [f"in the sample, {problem}" for problem in error.problems]) from None
    machines, cases = sampled(model, 1, sample)
    values = results_of(machines, cases, int(workers))[of]
    nominal = float(results_of(spread_over(model, 1), 1)[of][0])
    return Propagated(of, values, {each.name: sample[each.leaves[0]] for each in spread}, nominal)
