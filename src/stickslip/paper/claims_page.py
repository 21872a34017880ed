"""The claims page: each claim of the paper with a verdict that was computed, its evidence, and how sure it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import cycle
from typing import Any

from stickslip.paper.amplitudes import Amplitudes
from stickslip.paper.beam import Beam
from stickslip.paper.coexistence import Coexistence
from stickslip.paper.parameter_map import Around
from stickslip.paper.section5_motions import Motion
from stickslip.paper.sentences import filled, texts
from stickslip.paper.solved_runs import Runs, Tell
from stickslip.paper.table import Row

__all__ = ["CONFIRMED", "NOT_CONFIRMED", "UNDECIDED", "VERDICTS", "Claim", "Part", "Study", "judged"]

CONFIRMED, NOT_CONFIRMED, UNDECIDED = "confirmed", "not confirmed", "cannot be decided from the text"
VERDICTS = (CONFIRMED, NOT_CONFIRMED, UNDECIDED)


@dataclass(frozen=True)
class Part:
    """A claim about one case or one reading, when the whole claim has several."""

    label: str
    verdict: str
    evidence: str


@dataclass(frozen=True, eq=False)
class Claim:
    """One claim of the paper.

    Parameters
    ----------
    key : str
        Short name.
    section : str
        Where the paper makes it.
    claim : str
        What is claimed, in a sentence.
    quote : str
        The paper's own words.
    verdict : str
        One of `VERDICTS`.
    evidence : tuple of str
        Sentences with the numbers of this run.
    certainty : str
        "high", "moderate" or "low", and why.
    numbers : dict
        The same numbers for machines, SI units.
    parts : tuple of Part
        Verdicts case by case or reading by reading, where there are several.
    """

    key: str
    section: str
    claim: str
    quote: str
    verdict: str
    evidence: tuple[str, ...]
    certainty: str
    numbers: dict[str, Any] = field(default_factory=dict)
    parts: tuple[Part, ...] = ()


@dataclass(frozen=True, eq=False)
class Study:
    """The results on which the claims are judged."""

    fast: bool
    runs: Runs
    table: tuple[Row, ...]
    amplitudes: Amplitudes
    motions: dict[int, Motion]
    around: Around
    static_map: dict[str, Any]
    coexistence: Coexistence
    beam: Beam
    tell: Tell


def judged(key: str, holds: Any, numbers: dict[str, Any], parts: Sequence[tuple[Any, dict[str, Any]]] = (), **values: Any) -> Claim:
    """The claim of a key in the words of ``sentences.toml``, in which its numbers and other values stand.

    Whether it holds is None where nobody can say. A part is whether it holds, and values of its own; where the text has one
    template of a part, it serves them all.
    """
    told, values = dict(texts("claims")[key]), {**numbers, **values}
    found = tuple(_part(template, *part, values) for template, part in zip(cycle(told.pop("parts", ((),))), parts))
    return Claim(key=key, verdict=_verdict(holds), numbers=numbers, parts=found, **filled(told, {**values, "parts": found}))


def _part(template: Sequence[str], holds: Any, own: dict[str, Any], values: dict[str, Any]) -> Part:
    label, evidence = filled(template, {**values, **own})
    return Part(label, _verdict(holds), evidence)


def _verdict(holds: Any) -> str:
    return UNDECIDED if holds is None else CONFIRMED if holds else NOT_CONFIRMED
