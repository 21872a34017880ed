"""Intervals, and what residuals say about a fit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.identifying.search import polished
from stickslip.identifying.words import undetermined, unit_of_kind

if TYPE_CHECKING:
    from stickslip.identifying.fit import Fit, Quality

__all__ = ["by_covariance", "by_profile", "effective", "quality", "remarks"]


def _inner_error(fit: Fit, k: int) -> float:
    """Standard error on the scale of the search."""
    return float(fit.information.errors(fit.scale)[k])


def _quantile(fit: Fit, level: float) -> float:
    from scipy.stats import norm, t

    half = 0.5 + 0.5 * level
    given = all(getattr(target, "given_sigma", False) for target in fit.problem.targets)
    return float(norm.ppf(half) if given or fit.dof == 0 else t.ppf(half, fit.dof))


def by_covariance(fit: Fit, name: str, level: float) -> tuple[float, float]:
    """From the curvature at the best place, symmetric on the scale of the search."""
    k = fit.names.index(name)
    free = fit.problem.parameters.free[k]
    if fit.information.undetermined[k]:
        return free.low, free.high
    half = _quantile(fit, level) * _inner_error(fit, k)
    low, high = np.clip([fit.place[k] - half, fit.place[k] + half], 0.0, 1.0)
    return float(free.outer(low)), float(free.outer(high))


def by_profile(fit: Fit, name: str, level: float) -> tuple[float, float]:
    """Where the least sum of squares of the other parameters has risen by as much as the level allows."""
    k = fit.names.index(name)
    free = fit.problem.parameters.free[k]
    rise = (_quantile(fit, level) * fit.scale) ** 2
    ends = [_profile_end(fit, k, sign, rise) for sign in (-1.0, 1.0)]
    return float(free.outer(ends[0])), float(free.outer(ends[1]))


def _profile_end(fit: Fit, k: int, sign: float, rise: float) -> float:
    bound = 0.0 if sign < 0 else 1.0
    room = abs(bound - fit.place[k])
    if room <= 1e-12:
        return bound
    step = min(np.sqrt(rise) / fit.scale * _inner_error(fit, k) if np.isfinite(_inner_error(fit, k)) else room, room)
    near, far, start = 0.0, None, fit.place
    for _ in range(12):
        risen, start_there = _risen(fit, k, fit.place[k] + sign * step, start)
        if risen < rise:
            near, start = step, start_there
            if step >= room:
                return bound
            if abs(risen / rise - 1) < 0.02:
                break
            step = min(step * np.clip(np.sqrt(rise / max(risen, 1e-12)), 1.05, 3.0), room) if far is None else 0.5 * (near + far)
        else:
            far = step
            if abs(risen / rise - 1) < 0.02:
                near = step
                break
            guess = step * np.sqrt(rise / risen)
            step = guess if near < guess < far and near == 0.0 else 0.5 * (near + far)
        if far is not None and far - near < 1e-3 * far:
            break
    return float(np.clip(fit.place[k] + sign * near, 0.0, 1.0))


def _risen(fit: Fit, k: int, held: float, start: Any) -> tuple[float, Any]:
    """By how much the sum of squares rises when a parameter is held, the others free."""
    name = fit.names[k]
    free = fit.problem.parameters.free[k]
    problem = fit.problem.only({name: float(free.outer(np.clip(held, 0.0, 1.0)))})
    found = polished(problem, np.delete(start, k), rough=True)
    return found.cost - fit.cost, np.insert(found.place, k, held)


def neighbours(rest: Any) -> float:
    """Correlation of neighbouring residuals."""
    if len(rest) < 4 or not np.std(rest) > 0:
        return 0.0
    r = rest - rest.mean()
    return float((r[1:] @ r[:-1]) / (r @ r))


def effective(rest: Any) -> float:
    """How many independent values residuals are worth (Geyer's initial positive sequence)."""
    n = len(rest)
    if n < 8 or not np.std(rest) > 0:
        return float(n)
    r = rest - rest.mean()
    lines = np.fft.rfft(r, 2 * n)
    rho = np.fft.irfft(lines * np.conj(lines))[:n].real
    rho = rho / rho[0]
    pairs = rho[: n // 2 * 2].reshape(-1, 2).sum(axis=1)
    last = int(np.argmax(pairs <= 0)) if (pairs <= 0).any() else len(pairs)
    time = max(2 * float(pairs[:last].sum()) - 1, 1.0)
    return float(n / time)


def quality(fit: Fit) -> tuple[Quality, ...]:
    """How well each record is met."""
    from stickslip.identifying.fit import Quality

    found = []
    for target, curve, rest in zip(fit.problem.targets, fit.predicted, fit._split(fit.residuals * fit.problem.sigma), strict=True):
        y = curve - rest
        square, spread = target.mean_square(rest), target.mean_square(y - np.average(y, weights=target.weight * np.ones(len(y))))
        r2 = 1 - square / spread if len(y) > 1 and spread > 0 else float("nan")
        noise = float(getattr(target, "sigma", float("nan")))
        known = target.kind in ("velocity", "position") or getattr(target, "given_sigma", False)
        order = np.argsort(np.mod(target.phase, target.period), kind="stable") if target.kind == "velocity" else np.arange(len(rest))
        shape = max(neighbours(rest), neighbours(rest[order]), key=abs)
        found.append(Quality(target.label, target.kind, len(rest), float(np.sqrt(square)), noise if known else float("nan"), r2, shape))
    return tuple(found)


def remarks(fit: Fit) -> list[str]:
    """Sentences on parameters at their bounds, on parameters that nothing is known of, and on residuals that are no noise."""
    found = undetermined(fit)
    for k, free in enumerate(fit.problem.parameters.free):
        if fit.information.undetermined[k]:
            continue
        if min(fit.place[k], 1 - fit.place[k]) < 1e-4:
            found.append(f"{free.name} ends at its bound {fit.values[free.name]:.5g}: widen the bound, or these data cannot tell it")
        elif not _inner_error(fit, k) < 0.3:
            found.append(f"{free.name} is hardly told by these data: its standard error is a third of the distance of its bounds or more")
    for q, rest in zip(fit.quality, fit._split(fit.residuals), strict=True):
        if q.suspicious:
            unit = unit_of_kind(q.kind)
            why = f"residuals of {q.rms:.3g} {unit}" + (f" where the noise is {q.noise:.3g} {unit}" if np.isfinite(q.noise) else "")
            narrow = np.sqrt(q.count / effective(rest))
            found.append(
                f"{q.label}: {why}, neighbours correlated {q.correlation:.2f}: the law or the drive is not that of the record; "
                f"intervals are too narrow, by a factor of about {max(narrow, 1.0):.2g}"
            )
    if fit.agree <= 1 and fit.starts > 1 and len(fit.names) > 1 and not fit.cost < fit.problem.quiet:
        found.append("only one polished start ended here; type starts= with a larger number to look for a better place")
    return found
