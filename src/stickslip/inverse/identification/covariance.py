"""How sure the numbers of a fit are: their covariance from derivatives and residuals, coloured noise included."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.information import Information
from stickslip.inverse.identification.rounding import beside_white, rounding_columns

_ENOUGH = 60  # values of a record that tell its own noise
_TIMES = 100.0  # by which the noise of a record may be found larger or smaller than its target supposes, beside that of the others
_SAME, _ALIKE = 0.05, 0.01  # parts by which the noise of all records, and that of each beside the others, may be off
TOGETHER = 0.95  # correlation of two numbers above which they are named
_LOST = 1 / 3  # of the distance between bounds
_AT_A_MINIMUM = 0.1  # squares of the noise: less is promised at a minimum, where numbers are within a third of their standard errors
_RARE = 1e-3  # chance below which a sum of squares is beyond the noise that was given
_WHITE = 3.5  # standard errors within which the correlation of neighbours is that of white noise
_ONCE = 1e-3  # chance that noise of the motion leaves more than it is said to leave at most
_LEAST = 2.0  # times what it leaves on average, which it may leave in any case


def information_of(problem: Any, jacobian: Any) -> Information:
    """Information of data and priors about the numbers of a point."""
    count = len(problem.y)
    return Information(jacobian[:count], problem.resolution, jacobian[count:])


def noise_scale(problem: Any, minimum: Any) -> float:
    """The noise of the records over what the problem supposes, from all residuals; 1 where it was given, or nothing is left to tell it.

    Mean velocities whose sum of squares is beyond what their given noise allows (once in a thousand) are taken to be as noisy as they are
    far off (Birge's ratio): single numbers have no shape by which a wrong law could be told.
    """
    exact = _counted(problem, minimum.residuals)
    cost = float(np.sum(minimum.residuals[exact] ** 2))
    free = int(exact.sum()) - len(problem.parameters.free) - problem.nuisances
    known = all(t.given_sigma for t in problem.targets)
    if free < 1 or (known and (any(t.kind != "mean" for t in problem.targets) or _by_chance(cost, free) > _RARE)):
        return 1.0
    return float(np.sqrt(cost / free))


def still_promised(problem: Any, end: Any) -> float:
    """By how many squares of the noise the derivatives at the end of a search promise a lower sum of squares; 0 at a minimum."""
    promised = end.promised / max(noise_scale(problem, end) ** 2, 1e-300)
    return float(promised) if promised > _AT_A_MINIMUM else 0.0


def _counted(problem: Any, residuals: Array) -> Any:
    """Which residuals, those of what is known beforehand included, have the noise that they have, and no end of a range."""
    counts = np.ones(len(residuals), bool)
    counts[: len(problem.y)] = problem.unclipped(residuals)
    return counts


def _by_chance(cost: float, free: int) -> float:
    """How often noise alone makes such a sum of squares."""
    from scipy.stats import chi2

    return float(chi2.sf(cost, free))


def noise_sizes(problem: Any, minimum: Any) -> Any:
    r"""The noise of each record over what its target supposes, beside that of the others: array (records,), its weighted mean 1.

    Of a record whose noise nobody gave it is from its own residuals: their sum of squares over their number less that of the fitted
    numbers which the record bears, the sum of the leverages of its values. Where the sizes have settled, the sum of all squares is
    :math:`n \exp(\sum_i \frac{n_i}{n} \ln s_i^2)`, which falls as the likelihood rises.
    """
    count, exact = len(problem.y), problem.unclipped(minimum.residuals)
    counts = np.array([int(part.sum()) for part in problem.parts(exact)])
    sizes = problem.sizes * np.ones(len(counts))
    own = np.array([not t.given_sigma for t in problem.targets]) & (counts >= _ENOUGH)
    if own.sum() < 2:
        return sizes
    borne = np.sum(minimum.jacobian[:count] * information_of(problem, minimum.jacobian).inverse[:, :count].T, axis=1)
    squares, lost = (np.array([part.sum() for part in problem.parts(each * exact)]) for each in (minimum.residuals[:count] ** 2, borne))
    noise = sizes * np.sqrt(np.maximum(squares, np.finfo(float).tiny) / np.maximum(counts - lost, 1.0))
    logs = np.log(noise[own])
    logs = np.clip(logs - np.average(logs, weights=counts[own]), -np.log(_TIMES), np.log(_TIMES))
    sizes[own] = np.exp(logs - np.average(logs, weights=counts[own]))
    return sizes


def with_noise_of(problem: Any, minimum: Any) -> Any:
    """The problem with the noise that the residuals have, of each record and of all; the same one where it has that already."""
    sizes, scale = noise_sizes(problem, minimum), noise_scale(problem, minimum)
    known = problem.has_known_rows and scale > 0  # where a contact rests throughout nothing is left
    trust = scale if known and abs(scale / problem.trust - 1) >= _SAME else problem.trust
    if trust == problem.trust and (abs(sizes / problem.sizes - 1) < _ALIKE).all():
        return problem
    return problem.trusting(trust, sizes)


def spread_of(problem: Any, jacobian: Any, residuals: Array, scale: float, changes: Any = None, misfit: Any = None) -> Any:
    """Covariance of the numbers of a point, infinite variance for those that are undetermined, also by noise of the input."""
    covariance = information_of(problem, jacobian).marked(determined_spread(problem, jacobian, residuals, scale, changes, misfit))
    if changes is not None:
        lost = lost_to_the_input(problem, jacobian, changes)
        covariance[lost] = covariance[:, lost] = np.nan
        covariance[lost, lost] = np.inf
    return covariance


def lost_to_the_input(problem: Any, jacobian: ArrayLike, changes: Any) -> list[int]:
    """Which parameters the noise of the input moves by a third of the distance between their bounds or more."""
    if changes is None:
        return []
    moved = np.diag(from_the_input(problem, jacobian, changes))[: len(problem.parameters.free)]
    return [int(k) for k in np.flatnonzero(moved > _LOST**2)]


def from_the_input(problem: Any, jacobian: ArrayLike, changes: Any) -> Any:
    r"""Covariance of the numbers of a point that the noise of the input (position, load) makes, by its changes of what is met.

    A change :math:`\delta` of the model moves the point by :math:`-P\delta`, with the pseudo-inverse P of the derivatives. The mean square
    over repetitions is taken and not the variance: a shift that all of them have is an error as well.
    """
    if changes is None:
        return 0.0
    moved = information_of(problem, jacobian).inverse[:, : len(changes)] @ changes
    return moved @ moved.T / changes.shape[1]


def correlations_by_input(problem: Any, jacobian: Any, changes: Any, residuals: Array) -> list[float]:
    r"""The correlation of neighbouring residuals of each record that noise of the motion makes at most, where the numbers follow it.

    That noise acts mostly where the motion turns, so that few independent values bear most of it and its sum of squares scatters from
    record to record. By the mean m and the variance s² over repetitions it is taken for m times a chi-square of :math:`\nu = 2 m^2 / s^2`
    degrees over these (Satterthwaite), and once in a thousand records it is larger.
    """
    from scipy.stats import chi2

    rests = problem.parts(residuals[: len(problem.y)])
    if changes is None:
        return [0.0] * len(rests)
    left = changes - jacobian[: len(changes)] @ (information_of(problem, jacobian).inverse[:, : len(changes)] @ changes)
    most = []
    for columns, rest in zip(problem.parts(left), rests, strict=True):
        each = np.array([max(neighbours(column), 0.0) * np.mean(column**2) for column in columns.T])
        mean, free = float(each.mean()), 2 * float(each.mean()) ** 2 / max(float(each.var(ddof=1)), 1e-300)
        times = max(float(chi2.isf(_ONCE, max(free, 1.0))) / max(free, 1.0), _LEAST)
        most.append(times * mean / (float(np.mean(rest**2)) or 1.0))
    return most


def determined_spread(problem: Any, jacobian: Any, residuals: Array, scale: float, changes: Any = None, misfit: Any = None) -> Any:
    r"""Covariance of the numbers of a point with undetermined directions left out.

    With the pseudo-inverse P of the derivatives it is :math:`P\,\Omega\,P^T`. Omega, the covariance of the residuals, is scale² times one
    where they are white. Of rounded values it has what rounding makes of them (`rounding_columns`). Of a record whose neighbouring
    residuals are correlated beyond that, it has their autocorrelation beside the diagonal. Then comes what the noise of the input moves
    (`from_the_input`), and what a misfit (`Misfit`) may have moved.
    """
    info = information_of(problem, jacobian)
    covariance, inverse, begin = info.of_the_determined(scale), info.inverse, 0
    for target, columns in zip(problem.targets, rounding_columns(problem, residuals, scale), strict=True):
        end = begin + target.count
        if target.within == 0.0:  # averaged values have lost their order
            own = inverse[:, begin:end]
            covariance = covariance + _rounded(own, columns, scale) + _coloured(own, residuals[begin:end], scale, columns)
        begin = end
    covariance = covariance + from_the_input(problem, jacobian, changes)
    if misfit is None:
        return covariance
    moved = inverse[:, : len(misfit.columns)] @ misfit.columns
    return misfit.factor**2 * covariance + moved @ moved.T


def correlations_of(covariance: ArrayLike) -> Any:
    """Correlations; NaN where a variance is infinite."""
    size = np.sqrt(np.diag(covariance))
    known = np.isfinite(size)
    product = np.where(np.outer(known, known), np.outer(np.where(known, size, 0.0), np.where(known, size, 0.0)), np.nan)
    correlations = np.where(np.outer(known, known), covariance, np.nan) / np.where(product == 0, 1.0, product)
    correlations[~known, ~known] = 1.0
    return correlations


def correlated(names: list[str], covariance: ArrayLike) -> list[tuple[str, str, float]]:
    """Pairs of numbers that the record hardly distinguishes, and their correlation."""
    table = correlations_of(covariance)
    return [(names[j], names[i], table[i, j]) for i in range(len(names)) for j in range(i) if abs(table[i, j]) > TOGETHER]


def root_of(covariance: Array) -> Any:
    """A square root of a covariance."""
    values, vectors = np.linalg.eigh(covariance)
    return vectors * np.sqrt(np.maximum(values, 0.0))


def _rounded(inverse: Any, columns: Any, scale: float) -> Any:
    """By how much rounding of one record makes the covariance larger than white noise of the same size does."""
    if not columns.shape[1]:
        return 0.0
    white = beside_white(columns, scale**2)[1]
    moved = inverse @ columns
    return moved @ moved.T - (scale**2 - white) * (inverse @ inverse.T)


def _coloured(inverse: Any, rest: Array, scale: float, columns: Any) -> Any:
    """The contribution of correlated residuals of one record to the covariance, beyond that of its rounding."""
    n = len(rest)
    rho = colour(rest, columns)
    if n < 50 or abs(rho[1]) < _WHITE / np.sqrt(n):
        return 0.0
    rho = rho[: max(_memory(rho), 2)]
    kernel = np.zeros(2 * n)
    kernel[1 : len(rho)] = rho[1:]
    kernel[-len(rho) + 1 :] = rho[:0:-1]
    lines = np.fft.rfft(inverse, 2 * n, axis=1)
    power = np.fft.rfft(kernel).real
    power = np.maximum(power, -1.0)  # with the diagonal no frequency has less than no power
    moved = np.fft.irfft(power * lines, 2 * n, axis=1)[:, :n]
    return scale**2 * (inverse @ moved.T)


def neighbours(rest: Array) -> float:
    """Correlation of neighbouring residuals."""
    if len(rest) < 4 or not np.std(rest) > 0:
        return 0.0
    r = rest - rest.mean()
    return float((r[1:] @ r[:-1]) / (r @ r))


def autocorrelation(rest: Array) -> Any:
    """Correlation of residuals over their distance, 1 at zero: array (n,)."""
    sums = _products(rest - rest.mean())
    return sums / sums[0]


def colour(rest: Array, columns: Any) -> Any:
    """The same less what rounding makes of it (`rounding_columns`): array (n,); that of white noise where nothing is left."""
    if len(rest) < 4 or not np.std(rest) > 0:
        return np.eye(1, max(len(rest), 2))[0]
    sums = _products(rest - rest.mean())
    rho = sums / sums[0]
    if columns.shape[1]:
        rho = rho - _products((columns - columns.mean(axis=0)).T).sum(axis=0) / sums[0]
        rho[0] = 1.0
    return rho


def _products(values: Array) -> Any:
    """Sums of products of values that are so far apart, over the last axis."""
    n = values.shape[-1]
    lines = np.fft.rfft(values, 2 * n)
    return np.fft.irfft(lines * np.conj(lines))[..., :n].real


def _memory(rho: Any) -> int:
    """Over how many samples residuals are correlated (Geyer's initial positive sequence)."""
    pairs = rho[: len(rho) // 2 * 2].reshape(-1, 2).sum(axis=1)
    return 2 * (int(np.argmax(pairs <= 0)) if (pairs <= 0).any() else len(pairs))


def effective(rest: Array, columns: Any = None) -> float:
    """How many independent values residuals are worth; with the directions of rounding, those beside what rounding makes of them."""
    n = len(rest)
    if n < 8 or not np.std(rest) > 0:
        return float(n)
    rho = autocorrelation(rest) if columns is None else colour(rest, columns)
    return float(n / max(2 * float(rho[: _memory(rho)].sum()) - 1, 1.0))
