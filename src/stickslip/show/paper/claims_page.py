"""The claims page: each claim of the paper with a computed verdict, its evidence and its certainty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import cycle
from typing import Any

from stickslip.show.paper.amplitudes import Amplitudes
from stickslip.show.paper.beam import Beam
from stickslip.show.paper.coexistence import Coexistence
from stickslip.show.paper.omitted import Omitted
from stickslip.show.paper.parameter_map import ParameterMap
from stickslip.show.paper.section5_motions import FigureMotion
from stickslip.show.paper.sentences import filled, texts
from stickslip.show.paper.solved_runs import Runs, Tell
from stickslip.show.paper.table import TableRow
from stickslip.show.paper.type_two import TypeTwo

__all__ = ["CONFIRMED", "IN_PART", "NOT_CONFIRMED", "UNDECIDED", "VERDICTS", "ClaimData", "ClaimPart", "PaperClaim", "judged", "together"]

CONFIRMED, IN_PART = "confirmed", "confirmed in part"
NOT_CONFIRMED, UNDECIDED = "not confirmed", "cannot be decided from the text"
VERDICTS = (CONFIRMED, IN_PART, NOT_CONFIRMED, UNDECIDED)
#: The reading of a claim that depends on none.
AS_PRINTED = "as printed"


@dataclass(frozen=True)
class ClaimPart:
    """A claim about one case or one reading, if the whole claim has several."""

    label: str
    verdict: str
    evidence: str


@dataclass(frozen=True, eq=False)
class PaperClaim:
    """One claim of the paper.

    Parameters
    ----------
    key : str
        Short name.
    section : str
        Section of the paper.
    claim : str
        The claim in a sentence.
    quote : str
        The paper's own words.
    verdict : str
        One of `VERDICTS`.
    evidence : tuple of str
        Sentences with the numbers of this run.
    reading : str
        The reading of the text on which the verdict rests.
    certainty : str
        "high", "moderate" or "low", with the reason.
    numbers : dict
        The same numbers as data, SI units.
    parts : tuple of ClaimPart
        Verdicts for the cases or readings, if there are several.
    """

    key: str
    section: str
    claim: str
    quote: str
    verdict: str
    evidence: tuple[str, ...]
    certainty: str
    reading: str = AS_PRINTED
    numbers: dict[str, Any] = field(default_factory=dict)
    parts: tuple[ClaimPart, ...] = ()


@dataclass(frozen=True, eq=False)
class ClaimData:
    """The data on which the claims are judged."""

    fast: bool
    runs: Runs
    table: tuple[TableRow, ...]
    amplitudes: Amplitudes
    motions: dict[int, FigureMotion]
    around: ParameterMap
    static_map: dict[str, Any]
    coexistence: Coexistence
    beam: Beam
    type_two: TypeTwo
    omitted: Omitted
    tell: Tell


def judged(key: str, holds: Any, numbers: dict[str, Any], parts: Sequence[tuple[Any, dict[str, Any]]] = (), **values: Any) -> PaperClaim:
    """The claim of a key: its texts in ``sentences.toml``, filled with its numbers and other values.

    `holds` is None if the claim cannot be decided, and `IN_PART` if a part of it holds. Each part is a pair of `holds` and its own
    values; the templates of parts are used in turn, a single one for all of them.
    """
    words, values = dict(texts("claims")[key]), {**numbers, **values}
    judged_parts = tuple(_part(template, *part, values) for template, part in zip(cycle(words.pop("parts", ((),))), parts))
    return PaperClaim(
        key=key, verdict=_verdict(holds), numbers=numbers, parts=judged_parts, **filled(words, {**values, "parts": judged_parts})
    )


def _part(template: Sequence[str], holds: Any, own: dict[str, Any], values: dict[str, Any]) -> ClaimPart:
    label, evidence = filled(template, {**values, **own})
    return ClaimPart(label, _verdict(holds), evidence)


def _verdict(holds: Any) -> str:
    return UNDECIDED if holds is None else IN_PART if holds is IN_PART else CONFIRMED if holds else NOT_CONFIRMED


def together(*parts: Any) -> Any:
    """Whether a claim of several parts holds: all of it, none of it, or a part; parts that cannot be decided do not count.

    Examples
    --------
    >>> together(True, None), together(True, False), together(False, None), together(None)
    (True, 'confirmed in part', False, None)
    """
    decided = {part if part is IN_PART else bool(part) for part in parts if part is not None}
    return None if not decided else decided.pop() if len(decided) == 1 else IN_PART
