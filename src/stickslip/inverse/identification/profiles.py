"""Profiles of the sum of squares: intervals by them, and the parameters along which it is no parabola, or that may have any value."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.information import Information
from stickslip.inverse.identification.covariance import effective
from stickslip.inverse.identification.search import polished_to_end

if TYPE_CHECKING:
    from stickslip.inverse.identification.fit import Fit

_LEAST, _MOST = 0.5, 2.0  # rise of the sum of squares over that of a parabola
_LEVEL = 0.95  # of the intervals that are looked at for a parabola
_USUAL = 2.0  # standard errors of white noise where that is done
_WIDER = 1.1  # by which an interval reaches farther if its end is looked at too
_BEYOND = 1.5  # ends of an interval at which the sum of squares must still be up
_FOLLOWS = 3  # points there, each with the other numbers nearer to their best
_PROFILED = 24  # points that are tried for one end of a profile
_FARTHER = 0.03  # first step of the way to a bound on which an interval is looked for beside an open parameter
_NEAR_BOUND = 0.1  # standard errors to a bound, nearer than which nothing is seen of a parabola


def inner_error(fit: Fit, k: int) -> float:
    """Standard error on the scale of the search."""
    return float(np.sqrt(fit.spread[k, k]))


def quantile(fit: Fit, level: float) -> float:
    """Half the length of an interval in standard errors: of a normal deviate where the noise was given, else of Student's t."""
    from scipy.stats import norm, t

    half = 0.5 + 0.5 * level
    given = all(target.given_sigma for target in fit.problem.targets)
    return float(norm.ppf(half) if given or fit.dof == 0 else t.ppf(half, fit.dof))


def by_profile(fit: Fit, name: str, level: float) -> tuple[float, float]:
    """Where the least sum of squares of the other parameters has risen by as much as the level allows."""
    k = fit.names.index(name)
    free, rise, ends = fit.problem.parameters.free[k], _rise(fit, k, level), list[float]()
    for sign in (-1.0, 1.0):
        end = _profile_end(fit, k, sign, rise)
        for risen, start in _starts_beside_open(fit):
            end = _farther(fit, k, end, 0.5 + 0.5 * sign, risen + rise, start)
        ends.append(end)
    return float(free.outer(ends[0])), float(free.outer(ends[1]))


def _farther(fit: Fit, k: int, near: float, far: float, rise: float, start: Any) -> float:
    """An end of a profile, or how far beyond it on the way to a bound the sum of squares has not risen as much, from a start."""
    if near == far or _risen(fit, k, far, start)[0] < rise:
        return far
    length = abs(far - fit.point[k])
    step = _FARTHER * length
    while abs(far - near) > _FARTHER * length:
        beyond = near + np.sign(far - near) * min(step, 0.5 * abs(far - near))
        risen, there = _risen(fit, k, beyond, start)
        if risen >= rise:
            return near
        near, start, step = beyond, there, 2 * step
    return near


def _profile_end(fit: Fit, k: int, sign: float, rise: float) -> float:
    bound = 0.0 if sign < 0 else 1.0
    room = abs(bound - fit.point[k])
    if room <= 1e-12:
        return bound
    step = min(np.sqrt(rise) / fit.scale * inner_error(fit, k) if np.isfinite(inner_error(fit, k)) else room, room)
    near, far, start, least = 0.0, None, fit.point, 1.05
    for _ in range(_PROFILED):
        risen, start_there = _risen(fit, k, fit.point[k] + sign * step, start)
        if risen < rise:
            near, start = step, start_there
            if step >= room:
                return bound
            if abs(risen / rise - 1) < 0.02:
                break
            step = min(step * np.clip(np.sqrt(rise / max(risen, 1e-12)), least, 3.0), room) if far is None else 0.5 * (near + far)
            least = min(2 * least, 3.0)  # what is flat has no end where a parabola would
        else:
            far = step
            if abs(risen / rise - 1) < 0.02:
                near = step
                break
            guess = step * np.sqrt(rise / risen)
            step = guess if near < guess < far and near == 0.0 else 0.5 * (near + far)
        if far is not None and far - near < 1e-3 * far:
            break
    return float(np.clip(fit.point[k] + sign * near, 0.0, 1.0))


def _risen(fit: Fit, k: int, held: float, start: Any) -> tuple[float, Any]:
    """By how much the sum of squares rises when a parameter is held, the others free: from a point, or from where they would follow to."""
    name = fit.names[k]
    free, looser = fit.problem.parameters.free[k], _looser(fit, k)
    problem = fit.problem.trusting(fit.problem.trust * np.sqrt(looser)).only({name: float(free.outer(np.clip(held, 0.0, 1.0)))})
    tried = [np.delete(point, k) for point in (start, _followed(fit, k, held, start))]
    sums = [float(rest @ rest) for rest in map(problem.residuals, tried)]
    end = polished_to_end(problem, tried[int(np.argmin(sums))], rough=True)
    return end.cost - fit.cost - (looser - 1) * fit.penalty, np.insert(end.point, k, held)


def _looser(fit: Fit, k: int) -> float:
    """How many times the squares of the data may rise beside those of what is known beforehand, which has no colour and no misfit.

    1 where both rise alike: nothing is known beforehand, or the noise of records was given.
    """
    if len(fit.jacobian) == fit.count or any(t.given_sigma for t in fit.problem.targets):
        return 1.0
    inverse = fit.information.inverse[k]
    data, known = (fit.scale**2 * float(np.sum(part**2)) for part in (inverse[: fit.count], inverse[fit.count :]))
    wider = (fit.spread[k, k] - known) / data if data > 0 and np.isfinite(fit.spread[k, k]) else _colour(fit)
    return max(float(wider), 1.0)


def _colour(fit: Fit) -> float:
    """How many values are worth one independent one, in the record where they are most."""
    return max(len(rest) / effective(rest) for rest in fit.problem.parts(fit.residuals))


def _rise(fit: Fit, k: int, level: float) -> float:
    """By how much the sum of squares may rise within an interval, where what is known beforehand counts by `_looser`."""
    looser = _looser(fit, k)
    return float((quantile(fit, level) * fit.scale) ** 2 * looser) if looser > 1.0 else _allowed(fit, k, level)


def _allowed(fit: Fit, k: int, level: float) -> float:
    """By how much the sum of squares may rise within an interval; by more where noise is coloured."""
    white, coloured = fit.information.covariance(fit.scale)[k, k], fit.spread[k, k]
    wider = coloured / white if np.isfinite(white) else _colour(fit)
    return float((quantile(fit, level) * fit.scale) ** 2 * wider)


def _followed(fit: Fit, k: int, held: float, start: Any) -> Any:
    """A point at which the others have followed a parameter along the valley of the sum of squares, as its covariance has it."""
    along = fit.information.of_the_determined()[:, k]
    moved = start + (along / along[k] if along[k] > 0 else 0.0 * along) * (held - start[k])
    low, high = fit.problem.bounds()
    return np.where(np.arange(len(start)) == k, held, np.clip(moved, low, high))


def bent_parameters(fit: Fit) -> tuple[str, ...]:
    """Parameters along whose interval the sum of squares is not a parabola, so covariance and bootstrap intervals are unreliable.

    It is none about the best point (`bent_nearby`), or it stays low beyond the interval where a parameter that may have any value has
    another one.
    """
    return tuple(name for k, name in enumerate(fit.names) if name in fit.bent_nearby or _is_wider_beside_open(fit, k))


def _is_wider_beside_open(fit: Fit, k: int) -> bool:
    """Whether half as far again as the interval reaches the sum of squares is still low, beside other values of an open parameter."""
    half = _BEYOND * quantile(fit, _LEVEL) * inner_error(fit, k)
    if not fit.beside_open or not 0 < half < np.inf:
        return False
    ends, rise = np.clip([fit.point[k] - half, fit.point[k] + half], 0.0, 1.0), _rise(fit, k, _LEVEL)
    others = [(risen + rise, start, float(end)) for risen, start in _starts_beside_open(fit) for end in ends if end != fit.point[k]]
    return any(_risen(fit, k, end, start)[0] < least for least, start, end in others)


def bent_nearby(fit: Fit) -> tuple[str, ...]:
    """Parameters along whose interval the sum of squares is not a parabola about the best point.

    Two standard errors of white noise away, where the others have followed, the sum of squares should have risen by four; and where noise
    is coloured, so that the interval is wider, at its end by as much as the interval allows.
    """
    covariance = fit.information.covariance(fit.scale)
    errors = np.sqrt(np.diag(covariance))
    known = [] if fit.stopped else [k for k in range(len(fit.names)) if np.isfinite(errors[k]) and errors[k] > 0]
    bent = [fit.names[k] for k in known if not _parabolic_within(fit, k, np.nan_to_num(covariance[:, k]) / errors[k])]
    return tuple(name for name in fit.names if name in bent or (name in fit.flat and not fit.stopped))


def _parabolic_within(fit: Fit, k: int, along: Any) -> bool:
    """Whether the sum of squares rises as a parabola two standard errors of white noise away and at the interval's end, and stays up.

    Half as far again it must be above what an interval allows, where a parabola would be 2.25 times as high.
    """
    others = np.arange(len(fit.point)) != k
    rows = fit.jacobian[:, others]
    follow = Information(rows[: fit.count], fit.problem.resolution, rows[fit.count :]).inverse
    end = float(np.sqrt(_allowed(fit, k, _LEVEL))) / fit.scale
    ends = [_USUAL, end] if end > _WIDER * _USUAL else [_USUAL]
    rises = [rise / part**2 for away in ends for part, rise in _rises(fit, along, away, (others, follow))]
    if not rises or not all(_LEAST < rise < _MOST for rise in rises):
        return False
    return all(rise >= end**2 for part, rise in _rises(fit, along, _BEYOND * end, (others, follow)) if part > end)


def _rises(fit: Fit, along: Any, away: float, following: tuple[Any, Any]) -> list[tuple[float, float]]:
    """How far to either side, in standard errors (less where a bound is nearer), and by how many squares of the noise the sum rises there.

    The other numbers follow by steps of Gauss and Newton: along a product that is known (a gain times a friction) or over a shoulder they
    do not go on straight.
    """
    others, follow = following
    (low, high), rises = fit.problem.bounds(), []
    for part, side in _sides(fit, along, away):
        point, costs = fit.point + part * side, []
        for _ in range(_FOLLOWS):
            rest = fit.problem.residuals(point)
            costs.append(float(rest @ rest))
            point[others] = np.clip(point[others] - follow @ rest, low[others], high[others])
        rises.append((part, (min(costs) - fit.cost) / fit.scale**2))
    return rises


def _sides(fit: Fit, along: Any, away: float) -> list[tuple[float, Any]]:
    """So many standard errors, or as far as a bound is, and the direction, to either side; none where a bound is too near."""
    low, high = fit.problem.bounds()
    ways = []
    for side in (along, -along):
        with np.errstate(divide="ignore", invalid="ignore"):
            room = np.where(side > 0, (high - fit.point) / side, np.where(side < 0, (low - fit.point) / side, np.inf))
        ways.append((min(float(np.min(room)), away), side))
    return [(part, side) for part, side in ways if part > _NEAR_BOUND]


def open_parameters(fit: Fit) -> tuple[str, ...]:
    """Parameters whose interval reaches from bound to bound, although the curvature at the optimum gives a standard error.

    At either bound the sum of squares rises by less than the level allows once the others follow.
    """
    starts = _starts_beside_open(fit)
    return tuple(name for name in fit.bent if name in fit.beside_open or (starts and _is_low_at_both(fit, name, starts)))


def _is_low_at_both(fit: Fit, name: str, others: list[tuple[float, Any]]) -> bool:
    """Whether the sum of squares is low at both bounds of a parameter, reached from the best point or from beside an open one."""
    k, starts = fit.names.index(name), [(0.0, fit.point), *others]
    rise = _rise(fit, k, _LEVEL)
    return all(any(_risen(fit, k, end, start)[0] < risen + rise for risen, start in starts) for end in (0.0, 1.0))


def beside_open(fit: Fit) -> dict[str, list[tuple[float, Any]]]:
    """Where a parameter fits as well from bound to bound: by how much the sum of squares has risen at either, and the point there.

    The interval of another one reaches as far as it would beside any value of the open one. Near the best point it may seem sure only
    because of the value there: of a static friction nothing is known if it may fall off at velocities below all that were measured.
    """
    ways = {}
    for name in fit.bent_nearby:
        k = fit.names.index(name)
        ends = [_risen(fit, k, end, fit.point) for end in (0.0, 1.0)]
        if all(risen < _rise(fit, k, _LEVEL) for risen, _ in ends):
            ways[name] = [(max(risen, 0.0), point) for risen, point in ends]
    return ways


def _starts_beside_open(fit: Fit) -> list[tuple[float, Any]]:
    """Those of all open parameters."""
    return [end for ends in fit.beside_open.values() for end in ends]
