"""Borders of the motion type along a number, to the last bit, from closed formulas instead of a scan."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.analysis.closed_form import coulomb_type
from stickslip.basics.phrases import listed
from stickslip.models.friction.law_adapter import law_of
from stickslip.show.paper.solved_runs import batch

__all__ = ["FOUR", "WordInterval", "all_four", "exact_types", "in_words", "kinds", "longest", "stretches"]

FOUR = ("I", "II", "III", "IV")

#: Points at which the formulas are evaluated before bisection.
POINTS = 2001
Words = Callable[[Any], Any]


@dataclass(frozen=True)
class WordInterval:
    """A word (such as a motion type) and the interval in which it holds."""

    word: Any
    low: float
    high: float


def exact_types(robot: Any) -> Any:
    """Motion types of a rig with Coulomb friction: by the closed borders (`coulomb_type`) as Eq. 2.4 has it, by exact arcs with f0.

    Examples
    --------
    >>> import stickslip as ss
    >>> exact_types(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=[3e-4, 8e-4], law="coulomb")).tolist()
    ['II', 'IV']
    """
    if robot.friction.f_plus is not None:
        return batch(robot, settle="auto", periods=400).motion_type
    law, load, push = law_of(robot), robot.load(0.0, 0.0), robot.inner_mass * robot.drive.amplitude * robot.drive.omega**2
    return coulomb_type(law.sliding(1.0, load) / push, -law.sliding(-1.0, load) / push)


def stretches(words: Words, low: float, high: float, points: int = POINTS, within: float = 0.0) -> tuple[WordInterval, ...]:
    """The words along a number and the interval of each; one that holds for less than the distance of two points may be missed.

    Ends are found to the last bit, or to the relative distance `within`.

    Examples
    --------
    >>> import numpy as np
    >>> [(s.word, round(s.high, 9)) for s in stretches(lambda x: np.where(x**2 < 2, "below", "above"), 0.0, 2.0)]
    [('below', 1.414213562), ('above', 2.0)]
    """
    at = np.linspace(low, high, points)
    sampled = words(at)
    changes = [
        change
        for i in np.flatnonzero(sampled[1:] != sampled[:-1])
        for change in _between(words, at[i], at[i + 1], sampled[i : i + 2], within)
    ]
    ends = [low, *(value for value, _ in changes), high]
    names = [word.item() for word in (sampled[0], *(word for _, word in changes))]
    return tuple(WordInterval(word, float(a), float(b)) for word, a, b in zip(names, ends[:-1], ends[1:], strict=True))


def _between(words: Words, low: float, high: float, both: Any, within: float) -> Iterator[tuple[float, Any]]:
    """Each change between two points, by bisection, and the word after it."""
    word, last = both
    while word != last:
        inner, outer = low, high
        while inner < (middle := 0.5 * (inner + outer)) < outer and outer - inner > within * abs(outer):
            same = words(np.array([middle]))[0] == word
            inner, outer = (middle, outer) if same else (inner, middle)
        word, low = words(np.array([outer]))[0], outer
        yield outer, word


def longest(intervals: tuple[WordInterval, ...], word: Any = True) -> tuple[float, float] | None:
    """The longest interval in which a word holds; None if it never does."""
    held = [(s.low, s.high) for s in intervals if s.word == word]
    return max(held, key=lambda s: s[1] - s[0]) if held else None


def kinds(words: Any) -> int:
    """The number of the four types among the words."""
    return len(set(words) & set(FOUR))


def all_four(values: Any, rows: Any) -> Any:
    """The values whose rows contain all four types."""
    return values[[kinds(row) == 4 for row in rows.tolist()]]


def in_words(intervals: tuple[WordInterval, ...], say: Callable[[float], str]) -> str:
    """The words in order, with the value at which each ends."""
    return listed([*(f"{s.word} to {say(s.high)}" for s in intervals[:-1]), f"{intervals[-1].word} beyond"])
