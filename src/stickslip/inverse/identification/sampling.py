"""The posterior distribution of the numbers of a fit: samples, and bands of the model's predictions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems, is_whole
from stickslip.basics.interruption import interruptible, look, partial_result
from stickslip.basics.optional import library
from stickslip.basics.progress import reporting
from stickslip.inverse.identification.covariance import determined_spread, effective, root_of
from stickslip.inverse.identification.fit_text import unit_of_parameter, unit_of_values
from stickslip.inverse.identification.uncertainty import widening

if TYPE_CHECKING:
    import xarray as xr

    from stickslip.basics.progress import Reported
    from stickslip.inverse.identification.fit import Fit

_NEEDED = 'samples of the posterior are drawn by emcee, which is not installed; type pip install "stickslip[bayes]"'
_LEAST = 50  # autocorrelation times that a chain should have (the advice of emcee)
_FEWEST = 10  # draws of an interrupted chain
_OPEN = 0.05  # parts of the bounds over which walkers begin along what the data do not determine
_SPREAD = 0.5  # standard errors within which walkers begin


@interruptible
def sample(
    fit: Fit,
    draws: int = 1000,
    *,
    walkers: int | None = None,
    burn: int | None = None,
    seed: int = 0,
    progress: Reported | bool | None = None,
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
    import xarray as xr

    emcee = library("sample", "emcee", _NEEDED)
    low, high = (np.array(side) for side in fit.problem.bounds())
    size = len(fit.point)
    count = max(2 * size + 2, 16) if walkers is None else walkers
    ahead = max(draws // 2, 100) if burn is None else burn
    _check(draws, count, ahead, size)
    target = _Posterior(fit, low, high)
    rng = np.random.default_rng(seed)
    sampler = emcee.EnsembleSampler(count, size, target, vectorize=True)
    sampler.log_prob_fn = target  # not in emcee's wrapper, which prints an interruption with all places of the walkers
    sampler._random.seed(int(rng.integers(2**31)))  # the stretch moves draw from it: one seed, one chain
    report, steps = reporting(progress, "sample"), sampler.sample(_walkers(fit, count, low, high, rng), iterations=ahead + draws)
    done = 0
    with partial_result() as ending:
        for done, _ in enumerate(steps, 1):
            report(done, ahead + draws)
            look()
    ending.needs(done - ahead >= _FEWEST)
    draws = done - ahead
    chain = sampler.get_chain(discard=ahead)  # (draws, walkers, numbers)
    with np.errstate(invalid="ignore", divide="ignore"):  # of a walker that never moved
        times = emcee.autocorr.integrated_time(chain, quiet=True, tol=0)
    named = enumerate(_named(fit).items())
    data = {name: (("draw", "walker"), outer(chain[..., k]), attrs) for k, (name, (outer, attrs)) in named}
    longest = float(np.max(times))
    if np.isfinite(longest):
        few = f"{draws} draws are {draws / longest:.0f} autocorrelation times; type draws={int(_LEAST * longest)} or more"
    else:
        few = f"a walker has not moved in {draws} draws, so that no autocorrelation time is known; type draws={10 * draws} or more"
    attrs = {
        "law": fit.law, "sampler": f"emcee {emcee.__version__}", "seed": seed, "burn": ahead,
        "acceptance": float(np.mean(sampler.acceptance_fraction)), "autocorrelation_time": longest,
        "independent_draws": int(draws * count / longest) if np.isfinite(longest) else 0,
        "note": "; ".join(filter(None, (ending.note(f"{draws} draws"), "" if draws >= _LEAST * longest else few))),
    }  # fmt: skip
    return xr.Dataset(data, coords={"draw": np.arange(draws), "walker": np.arange(count)}, attrs=attrs)


def _check(draws: int, walkers: int, burn: int, size: int) -> None:
    problems = Problems("sample")
    problems.whole("draws", draws, 10, example=1000)
    problems.whole("burn", burn, 0, example=500)
    problems.whole("walkers", walkers, 2 * size, example=max(2 * size + 2, 16))
    problems.check()


def _walkers(fit: Fit, count: int, low: Any, high: Any, rng: Any) -> Any:
    """Where walkers begin: about the best point as the covariance has it, over all of what the data do not determine."""
    determined = determined_spread(fit.problem, fit.jacobian, fit.residuals, fit.scale, fit.changes, fit.misfit)
    points = fit.point + _SPREAD * rng.normal(size=(count, len(fit.point))) @ root_of(determined).T
    for members, directions in fit.information.groups:
        for direction in directions:
            along = np.zeros(len(fit.point))
            along[members] = direction / max(float(abs(direction).max()), 1e-300)
            points += _OPEN * rng.uniform(-1, 1, (count, 1)) * along
    room = np.where(np.isfinite(high - low), high - low, 1.0)
    return np.clip(points, low + 1e-6 * room, high - 1e-6 * room) + 1e-9 * room * rng.uniform(-1, 1, points.shape)


def _remaining_information(fit: Fit) -> float:
    """The part of the information that noise of the input leaves, of the parameter that it costs most."""
    whole, part = np.diag(fit.spread)[: len(fit.names)], fit.input_spread**2
    known = np.isfinite(whole) & (whole > 0)
    return float(np.min(1 - part[known] / whole[known], initial=1.0))


class _Posterior:
    """Logarithm of the posterior at many points."""

    def __init__(self, fit: Fit, low: Any, high: Any):
        self.fit, self.low, self.high = fit, low, high
        rest = fit.problem.parts(fit.residuals)
        self.worth = np.concatenate([np.full(len(r), effective(r) / len(r)) for r in rest])
        self.worth *= _remaining_information(fit) / max(widening(fit).values(), default=1.0) ** 2
        self.given = all(t.given_sigma for t in fit.problem.targets)
        self.independent = float(self.worth.sum())

    def __call__(self, points: Array) -> Any:
        points = np.atleast_2d(points)
        logs = np.full(len(points), -np.inf)
        inside = ((points >= self.low) & (points <= self.high)).all(axis=1)
        if inside.any():
            logs[inside] = self._inside(points[inside])
        return logs

    def _inside(self, points: Array) -> Any:
        rests = self.fit.problem.standardised(self.fit.problem.ends(points))
        cost = np.sum(self.worth[:, None] * rests**2, axis=0)
        log_likelihood = -0.5 * cost if self.given else -0.5 * self.independent * np.log(cost)
        known = np.array([self._known(point) for point in points])
        return np.where(np.isfinite(log_likelihood), log_likelihood + known, -np.inf)

    def _known(self, point: Array) -> float:
        """The prior distribution; one that is flat between bounds adds nothing."""
        log_prior = 0.0
        for row in self.fit.problem._known:
            if not np.isfinite(row.prior.low):
                log_prior -= 0.5 * ((row.value(point) - row.prior.mean) / row.prior.sd) ** 2
        return log_prior


def _named(fit: Fit) -> dict[str, tuple[Any, dict[str, str]]]:
    """Names of the numbers of a point, their conversion to values, and their units."""
    named: dict[str, tuple[Any, dict[str, str]]] = {}
    for free in fit.problem.parameters.free:
        named[free.name] = free.outer, {"units": unit_of_parameter(fit, free.name)}
    for record, what in getattr(fit.problem.model, "_timing", ()):
        named[f"{what}[{record}]"] = np.asarray, {"units": "1", "long_name": f"{what} of the drive in record {record}"}
    for number in fit.problem.numbers:
        unit = number.unit(unit_of_values(fit.problem.targets[number.records[0]]))
        named[f"{number.of.removeprefix('the ')} {number.name}"] = np.asarray, {"units": unit}
    return named


def bands(fit: Fit, record: int = 0, level: float = 0.95, samples: xr.Dataset | None = None, draws: int = 200, seed: int = 0) -> xr.Dataset:
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
    import xarray as xr

    problems = Problems("bands")
    count = len(fit.problem.targets)
    if not is_whole(record) or not 0 <= record < count:
        problems.add(f"record = {record!r}; allowed is a whole number from 0 to {count - 1}; type record=0")
    problems.whole("draws", draws, 10, example=200)
    if not 0 < level < 1:
        problems.add(f"level = {level!r}; allowed is a number between 0 and 1; type level=0.95")
    problems.check()
    rng = np.random.default_rng(seed)
    points = _drawn(fit, draws, rng) if samples is None else _of_samples(fit, samples, draws, rng)
    curves = fit.problem.parts(fit.problem.batch(points))[record]
    curves = curves[:, np.isfinite(curves).all(axis=0)]
    sigma = fit.scale * fit.problem.parts(fit.problem.sigma)[record][:, None]
    ends = (0.5 - 0.5 * level, 0.5 + 0.5 * level)
    low, high = np.quantile(curves, ends, axis=1)
    new_low, new_high = np.quantile(curves + sigma * rng.normal(size=curves.shape), ends, axis=1)
    y = fit.problem.parts(fit.problem.y)[record]
    unit = {"units": unit_of_values(fit.problem.targets[record])}
    data = {"measured": y, "fitted": fit.predicted[record], "low": low, "high": high, "predicted_low": new_low, "predicted_high": new_high}
    time = fit.problem.targets[record].time if fit.problem.targets[record].kind != "mean" else np.zeros(len(y))
    coords = {"time": ("value", time, {"units": "s", "long_name": "time from the middle of the record"})}
    return xr.Dataset(
        {name: ("value", values, unit) for name, values in data.items()}, coords=coords, attrs={"level": level, "draws": curves.shape[1]}
    )


def _drawn(fit: Fit, draws: int, rng: Any) -> Any:
    """Places as the covariance spreads them; along what the data do not determine nothing measured changes."""
    root = root_of(determined_spread(fit.problem, fit.jacobian, fit.residuals, fit.scale, fit.changes, fit.misfit))
    return np.clip(fit.point + rng.normal(size=(draws, len(fit.point))) @ root.T, *fit.problem.bounds())


def _of_samples(fit: Fit, samples: xr.Dataset, draws: int, rng: Any) -> Any:
    import xarray as xr

    names = list(_named(fit))
    if not isinstance(samples, xr.Dataset):
        raise InputError("bands", [f"samples = {samples!r}; allowed is what fit.sample() returns; type samples=fit.sample()"])
    if missing := [name for name in names if name not in samples]:
        raise InputError("bands", [f"samples have no {', '.join(missing)}; type samples=fit.sample() of this fit"])
    flat = np.stack([np.asarray(samples[name]).ravel() for name in names], axis=1)
    chosen = flat[rng.integers(0, len(flat), draws)]
    free = fit.problem.parameters.free
    for k, f in enumerate(free):
        chosen[:, k] = f.inner(chosen[:, k])
    return chosen
