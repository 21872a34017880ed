"""Intervals, and what residuals say about a fit."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.information import Information
from stickslip.basics.notebook_display import sure
from stickslip.basics.phrases import listed
from stickslip.inverse.identification.covariance import TOGETHER, effective, spread_of
from stickslip.inverse.identification.fit_text import OVER_MOTION, undetermined
from stickslip.inverse.identification.search import polished_to_end

if TYPE_CHECKING:
    from stickslip.inverse.identification.fit import Fit
    from stickslip.inverse.identification.quality import Quality

_LEAST, _MOST = 0.5, 2.0  # rise of the sum of squares over that of a parabola
_LEVEL = 0.95  # of the intervals that are looked at for a parabola
_USUAL = 2.0  # standard errors of white noise where that is done
_WIDER = 1.1  # by which an interval reaches farther if its end is looked at too
_BEYOND = 1.5  # ends of an interval at which the sum of squares must still be up
_FOLLOWS = 3  # points there, each with the other numbers nearer to their best
_AT_BOUND = 1e-4  # on the scale of the search
_MATTERS = 1.0  # square of the noise: by less a search that ended before a minimum changes no verdict, and no number by its error
_OUTSIDE = 3.0  # standard errors beyond a bound, from which on that is no noise
_WANTED = 0.05  # of the distance of its bounds: error of a parameter with the sensor that is recommended
_PROFILED = 24  # points that are tried for one end of a profile
_FARTHER = 0.03  # first step of the way to a bound on which an interval is looked for beside an open parameter
_HALF = 0.5  # of a standard error
_NEAR_BOUND = 0.1  # standard errors to a bound, nearer than which nothing is seen of a parabola


def calibrated(fit: Fit, name: str) -> Fit:
    """The same fit if the sensors, and all else of which something is known beforehand, were known to be as they are fitted."""
    free = [f.name for f in fit.problem.parameters.free if f.prior and f.name != name]
    return known_to_be(fit, [n.name for n in fit.problem.numbers], free)


def known_to_be(fit: Fit, numbers: list[str], free: Sequence[str] = ()) -> Fit:
    """The same fit if these numbers of the sensors and these parameters were known to be as they are fitted."""
    of, first = fit.problem.parameters.free, fit.problem.first
    problem = fit.problem.holding(numbers, fit.point).only({name: fit.values[name] for name in free})
    free_numbers = [f.name not in free for f in of] + [True] * (first - len(of)) + [n.name not in numbers for n in fit.problem.numbers]
    known = [f.name not in free for f in of if f.prior] + [n.name not in numbers for n in fit.problem.numbers if n.prior]
    kept, rows = np.array(free_numbers, bool), np.array([True] * fit.count + known, bool)
    jacobian = fit.jacobian[rows][:, kept]
    return dataclasses.replace(
        fit, values={n: v for n, v in fit.values.items() if n not in free}, problem=problem, point=fit.point[kept], jacobian=jacobian,
        spread=spread_of(problem, jacobian, fit.residuals, fit.scale, fit.changes, fit.misfit), penalty=problem.penalty(fit.point[kept]),
    )  # fmt: skip


def costs(fit: Fit) -> dict[str, dict[str, float]]:
    """Standard error of each parameter if one effect of the sensors were known: effect -> name -> error; under "" if all were.

    The harmonics of the drive count as one of them.
    """
    effects = dict.fromkeys(n.family for n in fit.problem.numbers)
    one = {what: known_to_be(fit, [n.name for n in fit.problem.numbers if n.family == what]).errors for what in effects}
    return one | ({"": known_to_be(fit, [n.name for n in fit.problem.numbers]).errors} if effects else {})


def calibrations(fit: Fit) -> list[str]:
    """Which effects of the sensors to calibrate, each where it makes more than half of the standard error of a parameter."""
    sentences = []
    for what in dict.fromkeys(n.family for n in fit.problem.numbers if n.of == "the sensor"):
        known = fit.costs[what]
        names = [name for name, error in fit.errors.items() if name not in fit.undetermined and known[name] < _HALF * error]
        if names:
            gained = listed([f"{name} is {sure(known[name])} instead of {sure(fit.errors[name])}" for name in names])
            sentences.append(f"calibrate the {what} of the sensor: with it known {gained}; then {_typed_when_calibrated(fit, what)}")
    return sentences


def _typed_when_calibrated(fit: Fit, what: str) -> str:
    """What to type of the sensors once one effect of them is known."""
    known = {"gain": '("normal", 1.0, 0.001)'}.get(what, "0.0")
    numbers = dict.fromkeys(n.family for n in (*fit.problem.numbers, *fit.problem.held) if n.of == "the sensor")
    return f"type sensor={{{', '.join(f'{quoted!r}: {known if quoted == what else None}' for quoted in numbers)}}}".replace("'", '"')


def through_the_sensor(fit: Fit, one: str, other: str) -> str:
    """The effect of the sensors by which two parameters are correlated: they are not where it is known; empty where there is none."""
    pair = [fit.names.index(one), fit.names.index(other)]
    for what in dict.fromkeys(n.family for n in fit.problem.numbers if n.of == "the sensor"):
        known = known_to_be(fit, [n.name for n in fit.problem.numbers if n.family == what])
        if not abs(known.correlations[pair[0], pair[1]]) > TOGETHER and all(known.errors[n] < _HALF * fit.errors[n] for n in (one, other)):
            return what
    return ""


def in_parts(value: float, whole: tuple[float, float], noise: tuple[float, float]) -> tuple[float, float]:
    """The rest of an interval after one part is subtracted in squares, on either side of a value."""
    lengths = [np.sqrt(max((w - value) ** 2 - (n - value) ** 2, 0.0)) for w, n in zip(whole, noise, strict=True)]
    return float(value - lengths[0]), float(value + lengths[1])


def _inner_error(fit: Fit, k: int) -> float:
    """Standard error on the scale of the search."""
    return float(np.sqrt(fit.spread[k, k]))


def _quantile(fit: Fit, level: float) -> float:
    from scipy.stats import norm, t

    half = 0.5 + 0.5 * level
    given = all(target.given_sigma for target in fit.problem.targets)
    return float(norm.ppf(half) if given or fit.dof == 0 else t.ppf(half, fit.dof))


def by_covariance(fit: Fit, name: str, level: float) -> tuple[float, float]:
    """From the curvature at the best point, symmetric on the scale of the search."""
    k = fit.names.index(name)
    free = fit.problem.parameters.free[k]
    if fit.information.undetermined[k]:
        return free.low, free.high
    return about(fit, k, _quantile(fit, level) * _inner_error(fit, k))


def by_input(fit: Fit, name: str, level: float) -> tuple[float, float]:
    """What the noise of the input (position, load) makes of an interval alone."""
    k = fit.names.index(name)
    return about(fit, k, _quantile(fit, level) * float(fit.input_spread[k]))


def about(fit: Fit, k: int, half: float) -> tuple[float, float]:
    """The interval so far on either side of a point, within the bounds."""
    free = fit.problem.parameters.free[k]
    low, high = np.clip([fit.point[k] - half, fit.point[k] + half], 0.0, 1.0)
    return float(free.outer(low)), float(free.outer(high))


def by_profile(fit: Fit, name: str, level: float) -> tuple[float, float]:
    """Where the least sum of squares of the other parameters has risen by as much as the level allows."""
    k = fit.names.index(name)
    free = fit.problem.parameters.free[k]
    ends = []
    for sign in (-1.0, 1.0):
        end = _profile_end(fit, k, sign, rise := _rise(fit, k, level))
        for risen, start in fit.beside_open:
            end = _farther(fit, k, end, 0.5 + 0.5 * sign, risen + rise, start)
        ends.append(end)
    return float(free.outer(ends[0])), float(free.outer(ends[1]))


def by_either(fit: Fit, name: str, level: float) -> tuple[float, float]:
    """From the outer ends of both: under noise of the motion the sum of squares is rough, and a profile ends at the first rise."""
    ends = [by(fit, name, level) for by in (by_covariance, by_profile)]
    return min(low for low, _ in ends), max(high for _, high in ends)


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
    step = min(np.sqrt(rise) / fit.scale * _inner_error(fit, k) if np.isfinite(_inner_error(fit, k)) else room, room)
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
    return float((_quantile(fit, level) * fit.scale) ** 2 * looser) if looser > 1.0 else _allowed(fit, k, level)


def _followed(fit: Fit, k: int, held: float, start: Any) -> Any:
    """A point at which the others have followed a parameter along the valley of the sum of squares, as its covariance has it."""
    along = fit.information.of_the_determined()[:, k]
    moved = start + (along / along[k] if along[k] > 0 else 0.0 * along) * (held - start[k])
    low, high = fit.problem.bounds()
    return np.where(np.arange(len(start)) == k, held, np.clip(moved, low, high))


def faults(fit: Fit) -> list[str]:
    """Why a fit is not that of a law which holds: an interrupted search, numbers at bounds, residuals that are not noise."""
    reasons = ["the search was interrupted"] if fit.stopped else []
    reasons += [*(_before_a_minimum(fit) if fit.misfit and fit.misfit.promised > _MATTERS else []), *_coarse(fit)]
    outside = [name for name in _at_bounds(fit) if name not in at_zero(fit) and _is_outside(fit, fit.names.index(name), _inner(fit, name))]
    reasons += [f"{name} ends at its bound {_bound_met(fit, name):.5g}" for name in outside]
    reasons += _against_what_is_known(fit)
    reasons += [*_sensors_at_bounds(fit), *_misfit_of_means(fit)]
    return reasons + [f"{q.label}: {q.excess}" for q in fit.quality if q.suspicious]


_AT_SENSOR = "type a wider range for it in sensor={...}, or the law or the motion is not that of the record"


_BY_PRIOR = "intervals are as many times as wide, or more"
_WIDENED = "the law or the drive is not that of the record, or the noise is larger than given; the intervals are wider by that factor"


_FASTER = "the intervals allow for it, as far as it is small; sample faster, or turn more slowly"
_ELSEWHERE = "the intervals allow for the step that is promised; type a larger starts=, begin nearer to the numbers, or narrow their bounds"


def _before_a_minimum(fit: Fit) -> list[str]:
    """A sentence on a search that ended before a minimum."""
    if fit.stopped or fit.misfit is None or not fit.misfit.promised:
        return []
    off = float(np.sqrt(fit.misfit.promised))
    return [f"the search ended before a minimum: by the derivatives there the numbers are {off:.2g} standard errors off"]


def _coarse(fit: Fit) -> list[str]:
    """A sentence on samples that are too far apart for what a law does near rest."""
    if fit.misfit is None or not fit.misfit.coarse:
        return []
    off = f"shorter steps move numbers by {fit.misfit.coarse:.2g} standard errors"
    return [f"between samples about the reversals the law is not resolved: {off}"]


def _misfit_of_means(fit: Fit) -> list[str]:
    """A sentence on mean velocities whose misfit is beyond the noise that was given for them."""
    if fit.scale <= 1.0 or not all(t.given_sigma for t in fit.problem.targets):
        return []
    return [f"the mean velocities are {fit.scale:.2g} times as far from the model as their noise allows"]


def _sensors_at_bounds(fit: Fit) -> list[str]:
    """Sentences on numbers of sensors that would lie beyond a bound."""
    sentences = []
    for k, number in enumerate(fit.problem.numbers, fit.problem.first):
        low, high = number.bounds
        inner = (fit.point[k] - low) / (high - low) if np.isfinite(high - low) else 0.5
        if min(inner, 1 - inner) < _AT_BOUND and _is_outside(fit, k, inner):
            sentences.append(f"{number.name} of {number.of} ends at its bound {fit.point[k]:.5g}")
    return sentences


def _is_outside(fit: Fit, k: int, inner: float) -> bool:
    """Whether the best value of a number that ends at a bound lies beyond it by more than noise allows; a misfit may come of the bound."""
    step = float(fit.information.inverse[k] @ fit.problem.residuals(fit.point))
    noise = spread_of(fit.problem, fit.jacobian, fit.residuals, fit.scale, fit.changes)[k, k]
    return bool((step if inner < 0.5 else -step) > _OUTSIDE * np.sqrt(noise))


def _against_what_is_known(fit: Fit) -> list[str]:
    """Sentences on numbers that are far off what was known of them."""
    off = fit.problem.against_what_is_known(fit.point).items()
    owner = {number.name: f" of {number.of}" for number in fit.problem.numbers}
    return [f"{name}{owner.get(name, '')} is {size:.2g} standard deviations off its prior" for name, size in off]


def _at_bounds(fit: Fit) -> list[str]:
    """Parameters that end at a bound, or at what the law demands of them beside the others (static friction not below kinetic)."""
    names = [name for k, name in enumerate(fit.names) if not fit.information.undetermined[k]]
    return [name for name in names if min(_inner(fit, name), 1 - _inner(fit, name)) < _AT_BOUND]


def _bound_met(fit: Fit, name: str) -> float:
    """The bound at which a parameter ends, or what the law demands there beside the others."""
    k = fit.names.index(name)
    free = fit.problem.parameters.free[k]
    return float(free.low if fit.point[k] < _AT_BOUND else free.high if fit.point[k] > 1 - _AT_BOUND else fit.values[name])


def _inner(fit: Fit, name: str) -> float:
    """Where a parameter is between the least, 0, and the greatest value, 1, that it may have beside the others."""
    return float(fit.problem.parameters.limits.inner(fit.point)[fit.names.index(name)])


def at_zero(fit: Fit) -> list[str]:
    """Parameters that end at zero, below which the model has none: the part that they belong to is not there, which is no fault."""
    return [name for name in _at_bounds(fit) if fit.problem.parameters.free[fit.names.index(name)].low == 0.0 and _no_less(fit, name)]


def _no_less(fit: Fit, name: str) -> bool:
    """Whether the model refuses a parameter below zero."""
    free = fit.problem.parameters.free[fit.names.index(name)]
    try:
        fit.problem.parameters.model({**fit.values, name: -1e-3 * free.high}, 0)
    except InputError:
        return True
    return False


def _at_bound(fit: Fit, k: int) -> str:
    """The consequence of a parameter that ends at a bound."""
    if fit.names[k] in at_zero(fit):
        return "it is not negative, and these data show nothing that would need it"
    if min(fit.point[k], 1 - fit.point[k]) < _AT_BOUND:
        return "widen the bound, or these data do not determine it"
    return "its law allows no less (or no more) beside the other numbers, and these data show nothing that would need it"


def remarks(fit: Fit) -> list[str]:
    """Sentences on parameters at their bounds, on parameters that nothing is known of, and on residuals that are not noise."""
    sentences = (
        [f"{said}: {_ELSEWHERE}" for said in _before_a_minimum(fit)] + [f"{said}: {_FASTER}" for said in _coarse(fit)] + undetermined(fit)
    )
    sentences += lost_remarks(fit)
    curved = [name for name in fit.open if name not in fit.flat]
    sentences += [f"{name} is not determined: any value between its bounds fits as well; fix it, or {fit.remedy}" for name in curved]
    sentences += [
        f"{said}: that is wrong, or the law or the drive is not that of the record; {_BY_PRIOR}" for said in _against_what_is_known(fit)
    ]
    sentences += [f"{said}: {_WIDENED}" for said in _misfit_of_means(fit)]
    sentences += [f"{said}: {_AT_SENSOR}" for said in _sensors_at_bounds(fit)]
    at_bounds = _at_bounds(fit)
    for k, free in enumerate(fit.problem.parameters.free):
        if free.name in fit.undetermined:
            continue
        if free.name in at_bounds:
            sentences.append(f"{free.name} ends at its bound {_bound_met(fit, free.name):.5g}: {_at_bound(fit, k)}")
        elif free.name in fit.flat:
            sentences.append(f"{free.name} changes nothing measured near its fitted value, and does farther away")
        elif not _inner_error(fit, k) < 0.3:
            sentences.append(
                f"{free.name} is hardly determined by these data: its standard error is a third of the distance of its bounds or more"
            )
    if bent := [name for name in fit.bent if name not in fit.open]:
        sentences.append(
            f"the sum of squares bends away from a parabola within the interval of {listed(bent)}: "
            f"its interval is by profile; covariance and bootstrap are not reliable"
        )
    for q, rest in zip(fit.quality, fit.problem.parts(fit.residuals), strict=True):
        if q.suspicious:
            sentences.append(f"{q.label}: {q.excess}: {_why(fit, q, rest)}")
    if fit.agree <= 1 and fit.starts > 1 and len(fit.names) > 1:
        sentences.append("only one refined start ended here; type starts= with a larger number to look for a better place")
    return sentences


def lost_remarks(fit: Fit) -> list[str]:
    """Sentences on parameters that the noise of the input leaves undetermined, with the sensor that would determine them."""
    sentences, noisy = [], [t for t in fit.problem.targets if t.has_noise]
    for name in fit.lost:
        part = float(fit.input_spread[fit.names.index(name)])
        helped = "; ".join(dict.fromkeys(t.better(_WANTED / part) for t in noisy))
        sentences.append(f"{name} is not determined by this record: the noise of the motion moves it from bound to bound; {helped}")
    return sentences


def bent_parameters(fit: Fit) -> tuple[str, ...]:
    """Parameters along whose interval the sum of squares is not a parabola, so covariance and bootstrap intervals are unreliable.

    It is none about the best point (`bent_nearby`), or it stays low beyond the interval where a parameter that may have any value has
    another one.
    """
    return tuple(name for k, name in enumerate(fit.names) if name in fit.bent_nearby or _is_wider_beside_open(fit, k))


def _is_wider_beside_open(fit: Fit, k: int) -> bool:
    """Whether half as far again as the interval reaches the sum of squares is still low, beside other values of an open parameter."""
    half = _BEYOND * _quantile(fit, _LEVEL) * _inner_error(fit, k)
    if not fit.beside_open or not 0 < half < np.inf:
        return False
    ends, rise = np.clip([fit.point[k] - half, fit.point[k] + half], 0.0, 1.0), _rise(fit, k, _LEVEL)
    others = [(risen + rise, start, float(end)) for risen, start in fit.beside_open for end in ends if end != fit.point[k]]
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


def open_parameters(fit: Fit) -> tuple[str, ...]:
    """Parameters whose interval reaches from bound to bound, although the curvature at the optimum gives a standard error.

    At either bound the sum of squares rises by less than the level allows once the others follow.
    """
    bent = [(name, fit.names.index(name)) for name in fit.bent]
    starts, rises = ((0.0, fit.point), *fit.beside_open), {k: _rise(fit, k, _LEVEL) for _, k in bent}
    is_low = lambda k, end: any(_risen(fit, k, end, start)[0] < risen + rises[k] for risen, start in starts)  # noqa: E731
    return tuple(name for name, k in bent if is_low(k, 0.0) and is_low(k, 1.0))


def beside_open(fit: Fit) -> tuple[tuple[float, Any], ...]:
    """Where a parameter fits as well from bound to bound: by how much the sum of squares has risen at either, and the point there.

    The interval of another one reaches as far as it would beside any value of the open one. Near the best point it may seem sure only
    because of the value there: of a static friction nothing is known if it may fall off at velocities below all that were measured.
    """
    points = []
    for k in map(fit.names.index, fit.bent_nearby):
        ends = [_risen(fit, k, end, fit.point) for end in (0.0, 1.0)]
        points += [(max(risen, 0.0), point) for risen, point in ends] if all(risen < _rise(fit, k, _LEVEL) for risen, _ in ends) else []
    return tuple(points)


def _allowed(fit: Fit, k: int, level: float) -> float:
    """By how much the sum of squares may rise within an interval; by more where noise is coloured."""
    white, coloured = fit.information.covariance(fit.scale)[k, k], fit.spread[k, k]
    wider = coloured / white if np.isfinite(white) else _colour(fit)
    return float((_quantile(fit, level) * fit.scale) ** 2 * wider)


def _sides(fit: Fit, along: Any, away: float) -> list[tuple[float, Any]]:
    """So many standard errors, or as far as a bound is, and the direction, to either side; none where a bound is too near."""
    low, high = fit.problem.bounds()
    ways = []
    for side in (along, -along):
        with np.errstate(divide="ignore", invalid="ignore"):
            room = np.where(side > 0, (high - fit.point) / side, np.where(side < 0, (low - fit.point) / side, np.inf))
        ways.append((min(float(np.min(room)), away), side))
    return [(part, side) for part, side in ways if part > _NEAR_BOUND]


def _why(fit: Fit, q: Quality, rest: Array) -> str:
    """The interpretation of residuals that are not noise."""
    narrow = max(np.sqrt(q.count / effective(rest)), 1.0)
    if q.coloured and not q.structure:
        what = "motion" if q.kind in OVER_MOTION else "drive"
        return f"they follow time and not the {what}, as coloured noise does; intervals count that, by a factor of about {narrow:.2g}"
    wider = max(widening(fit).values(), default=1.0)
    allows = "allow for it" if fit.misfit is not None and not fit.misfit.is_none else "count their correlation"
    counted = f"are up to {wider:.2g} times as wide for it" if wider > _WIDER else allows
    return f"the law or the drive is not that of the record, so it is not supported; the intervals {counted}"


def widening(fit: Fit) -> dict[str, float]:
    """How many times as wide intervals are because something besides noise is left: name -> factor."""
    if fit.misfit is None or fit.misfit.is_none:
        return {}
    bare = np.diag(spread_of(fit.problem, fit.jacobian, fit.residuals, fit.scale, fit.changes))
    factors = {name: float(np.sqrt(fit.spread[k, k] / bare[k])) for k, name in enumerate(fit.names) if 0 < bare[k] < np.inf}
    return {name: factor for name, factor in factors.items() if np.isfinite(factor)}
