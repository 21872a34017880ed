"""From a rough fit to the best place: with the noise as the residuals have it, fewer outliers, and numbers of sensors that count."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from stickslip.basics.phrases import listed
from stickslip.inverse.identification.coarse_steps import with_short_steps
from stickslip.inverse.identification.covariance import (
    correlations_by_input,
    information_of,
    neighbours,
    noise_scale,
    noise_sizes,
    still_promised,
    with_noise_of,
)
from stickslip.inverse.identification.delays import delayed_best
from stickslip.inverse.identification.least_squares import MeasuredProblem
from stickslip.inverse.identification.search import SearchEnd, polished
from stickslip.inverse.identification.weighting import robust_weights

_SHAPED = 0.9  # correlation of neighbouring residuals of a force above which they are not noise, of any colour
_MAKES_UP = 2.0  # how many times what is left by a fit with the sensor may be left by one without it, of a force with a shape left
_NOTHING = 0.1  # of the square of one residual that is noise: by as much the sum of squares may rise where a number is undetermined
_AGAIN = 4  # times that steps go on where they ended before a minimum
_ROUNDS = 4  # times that the noise is found anew
_WEIGHINGS, _STEADY = 12, 0.01  # times that weights of a robust loss are found anew, and by how much they may still differ


def finished(problem: MeasuredProblem, rough: SearchEnd) -> tuple[MeasuredProblem, SearchEnd]:
    """The problem with its noise as the residuals have it, and the best place."""
    point = problem.whole(rough.point)
    if rough.stopped:
        return problem, SearchEnd(point, problem.residuals(point), problem.jacobian(point), rough.steps, True)
    problem, point = delayed_best(problem, point)
    best = polished(problem, point)
    for _ in range(_ROUNDS):
        with_noise = with_noise_of(problem, best)
        if best.stopped or with_noise is problem:
            break
        problem, best = with_noise, polished(with_noise, best.point)
    return with_short_steps(problem, _gone_on(problem, best))


def _gone_on(problem: MeasuredProblem, best: SearchEnd) -> SearchEnd:
    """Steps from where a search ended before a minimum, as long as they lead on."""
    for _ in range(_AGAIN):
        if best.stopped or not still_promised(problem, best):
            break
        again = polished(problem, best.point)
        if again.cost > best.cost - _NOTHING * noise_scale(problem, best) ** 2:
            break
        best = again
    return best


def held_back(weigh: Any, problem: MeasuredProblem, best: SearchEnd) -> tuple[MeasuredProblem, SearchEnd]:
    """The best place where outliers count less, by weights that are found anew until they stay."""
    plain, before = problem, np.ones(len(problem.y))
    for _ in range(_WEIGHINGS):
        rows = robust_weights(weigh, plain.parts(plain.residuals(best.point)[: len(before)]))
        if best.stopped or abs(rows - before).max() < _STEADY:
            break
        weighed, before = plain.weighing(rows), rows
        sizes = noise_sizes(weighed, dataclasses.replace(best, residuals=weighed.residuals(best.point)))
        problem = weighed.trusting(weighed.trust, sizes)
        best = polished(problem, best.point)
    return problem, best


def canonical(problem: MeasuredProblem, best: SearchEnd, spared: list[str]) -> SearchEnd:
    """The same fit where numbers of sensors that are spared, or not determined, are those of ideal sensors; their errors stay in it.

    One that the fit needs, within the bounds of the others, stays as it is.
    """
    held, needed = spared, set[str]()
    fitted, little = _holding(problem, best, held), _NOTHING * noise_scale(problem, best) ** 2
    while names := [n for n in _lost(problem, held, fitted) if n not in held and n not in needed]:
        more = _holding(problem, best, [*held, names[0]])
        if more.cost > fitted.cost + little:
            needed.add(names[0])
        else:
            held, fitted = [*held, names[0]], more
    if not held:
        return best
    kept = _kept(problem, held)
    point = np.array([*best.point[: problem.first], *(n.neutral for n in problem.numbers)])
    point[kept] = fitted.point
    return SearchEnd(point, problem.residuals(point), problem.jacobian(point), best.steps)


def _holding(problem: MeasuredProblem, best: SearchEnd, names: Any) -> SearchEnd:
    """The fit where some numbers of sensors are those of ideal ones."""
    return polished(problem.holding(names), best.point[_kept(problem, names)]) if names else best


def _kept(problem: MeasuredProblem, held: Any) -> Any:
    """Which numbers of a place are left if some of the sensors are held."""
    return np.array([True] * problem.first + [n.name not in held for n in problem.numbers])


def _lost(problem: MeasuredProblem, held: Any, end: SearchEnd) -> list[str]:
    """Numbers of sensors that the data do not determine if some are held, in the order of the problem."""
    reduced = problem.holding(held) if held else problem
    return [reduced.numbers[k - reduced.first].name for k in undetermined(reduced, end) if k >= reduced.first]


def spared_numbers(problem: MeasuredProblem, best: SearchEnd) -> list[str]:
    """Of the numbers that would make up for what a law lacks, those without which the fit leaves no more than twice as much."""
    names = _chasing(problem, best)
    families = list(dict.fromkeys(n.what for n in problem.numbers if n.name in names))
    while families:
        tried: list[tuple[float, list[str]]] = []
        for out in (None, *families):
            way = [e for e in families if e != out]
            spared = [n.name for n in problem.numbers if n.what in way and n.name in names]
            tried.append((_holding(problem, best, spared).cost, way))
            if tried[-1][0] <= _MAKES_UP * best.cost:
                return spared
        families = min(tried[1:])[1]
    return []


def _chasing(problem: MeasuredProblem, best: SearchEnd) -> list[str]:
    """Numbers of load cells that nobody asked for and that would make up for what the law lacks.

    What is left then has a shape, or a number is far off what is known of it.
    """
    if problem.given is not None:
        return []
    off = problem.against_what_is_known(best.point)
    odd = {i for n in problem.numbers if n.name in off for i in n.records} | set(_shaped(problem, best))
    cells = [n for n in problem.numbers if n.what != "start"]  # how bristles begin is of the contact
    return [n.name for n in cells if any(problem.targets[i].kind == "force" for i in odd & set(n.records))]


def _shaped(problem: MeasuredProblem, best: SearchEnd) -> list[int]:
    """The records of which more than noise of the motion is left with a shape."""
    left = [neighbours(rest) for rest in problem.parts(best.residuals[: len(problem.y)])]
    if max(left) <= _SHAPED:
        return []
    by_input = correlations_by_input(problem, best.jacobian, problem.input_changes(best.point), best.residuals)
    return [i for i, each in enumerate(left) if each > max(_SHAPED, by_input[i])]


def spared_note(names: list[str]) -> list[str]:
    """The consequence of leaving out some numbers of sensors."""
    if not names:
        return []
    left = f"the residual force is structured, so {listed(names)} of the sensor cannot be distinguished from defects of the law"
    return [f"{left}: the values are those of an ideal sensor, and the intervals allow for a real one"]


def undetermined(problem: MeasuredProblem, end: SearchEnd) -> list[int]:
    """Which numbers of a place the data do not determine."""
    return [int(k) for k in np.flatnonzero(information_of(problem, end.jacobian).undetermined)]
