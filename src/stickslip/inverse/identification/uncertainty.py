"""Intervals, and what residuals say about a fit."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.notebook_display import sure
from stickslip.basics.phrases import listed
from stickslip.inverse.identification.covariance import TOGETHER, effective, spread_of
from stickslip.inverse.identification.fit_text import OVER_MOTION, undetermined
from stickslip.inverse.identification.profiles import by_profile, inner_error, quantile

if TYPE_CHECKING:
    from stickslip.inverse.identification.fit import Fit
    from stickslip.inverse.identification.quality import Quality

_MENTIONED = 1.1  # by how many times an interval is wider before that is said
_AT_BOUND = 1e-4  # on the scale of the search
_MATTERS = 1.0  # square of the noise: by less a search that ended before a minimum changes no verdict, and no number by its error
_OUTSIDE = 3.0  # standard errors beyond a bound, from which on that is no noise
_WANTED = 0.05  # of the distance of its bounds: error of a parameter with the sensor that is recommended
_HALF = 0.5  # of a standard error


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


def by_covariance(fit: Fit, name: str, level: float) -> tuple[float, float]:
    """From the curvature at the best point, symmetric on the scale of the search."""
    k = fit.names.index(name)
    free = fit.problem.parameters.free[k]
    if fit.information.undetermined[k]:
        return free.low, free.high
    return about(fit, k, quantile(fit, level) * inner_error(fit, k))


def by_input(fit: Fit, name: str, level: float) -> tuple[float, float]:
    """What the noise of the input (position, load) makes of an interval alone."""
    k = fit.names.index(name)
    return about(fit, k, quantile(fit, level) * float(fit.input_spread[k]))


def about(fit: Fit, k: int, half: float) -> tuple[float, float]:
    """The interval so far on either side of a point, within the bounds."""
    free = fit.problem.parameters.free[k]
    low, high = np.clip([fit.point[k] - half, fit.point[k] + half], 0.0, 1.0)
    return float(free.outer(low)), float(free.outer(high))


def by_either(fit: Fit, name: str, level: float) -> tuple[float, float]:
    """From the outer ends of both: under noise of the motion the sum of squares is rough, and a profile ends at the first rise."""
    ends = [by(fit, name, level) for by in (by_covariance, by_profile)]
    return min(low for low, _ in ends), max(high for _, high in ends)


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
        elif not inner_error(fit, k) < 0.3:
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


def _why(fit: Fit, q: Quality, rest: Array) -> str:
    """The interpretation of residuals that are not noise."""
    narrow = max(np.sqrt(q.count / effective(rest)), 1.0)
    if q.coloured and not q.structure:
        what = "motion" if q.kind in OVER_MOTION else "drive"
        return f"they follow time and not the {what}, as coloured noise does; intervals count that, by a factor of about {narrow:.2g}"
    wider = max(widening(fit).values(), default=1.0)
    allows = "allow for it" if fit.misfit is not None and not fit.misfit.is_none else "count their correlation"
    counted = f"are up to {wider:.2g} times as wide for it" if wider > _MENTIONED else allows
    return f"the law or the drive is not that of the record, so it is not supported; the intervals {counted}"


def widening(fit: Fit) -> dict[str, float]:
    """How many times as wide intervals are because something besides noise is left: name -> factor."""
    if fit.misfit is None or fit.misfit.is_none:
        return {}
    bare = np.diag(spread_of(fit.problem, fit.jacobian, fit.residuals, fit.scale, fit.changes))
    factors = {name: float(np.sqrt(fit.spread[k, k] / bare[k])) for k, name in enumerate(fit.names) if 0 < bare[k] < np.inf}
    return {name: factor for name, factor in factors.items() if np.isfinite(factor)}
