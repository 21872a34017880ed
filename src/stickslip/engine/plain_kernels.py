"""A kernel of one case as texts that are not compiled here: what its C is made of (`c_machine.py`)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from stickslip.engine import driver
from stickslip.engine.kernel_text import FUNCTIONS
from stickslip.engine.lanes import AnySteps, law_text, layout, places, step_of, watched
from stickslip.engine.observed import lists_of
from stickslip.engine.rosenbrock_step import Step
from stickslip.engine.steptext import places_of
from stickslip.engine.system import System


@dataclass(frozen=True)
class PlainKernel:
    """A kernel of one case that is not compiled: the texts of its functions, its step, and what its driver's table says.

    Parameters
    ----------
    eq : System
    step : Step
    text : str
        Python text of its functions.
    places : tuple of dict
        Where a lane has what the lines of its step read, their rows, and what they write (`steptext.places_of`).
    layout : dict of int
        Numbers and places by the names that they have in the driver's table.
    table : array of int
    """

    eq: System
    step: Step
    text: str
    places: tuple[dict[str, int], dict[str, int], dict[str, int]]
    layout: dict[str, int]
    table: Any


def plain_kernel(eq: System, method: AnySteps) -> PlainKernel:
    """The kernel of a traced model for one case that keeps its dense output, of which nothing is noted; nothing is compiled."""
    eq = replace(eq, signals=(), ratios=())
    step = step_of(eq, method, record=True)
    functions, text = law_text(eq, step, 1)
    named, scale_at = layout(eq, step, 1)
    own = {*functions, "step", *(("land",) if named["SERIES"] else ())}
    where = {name: int(name in own) for name in FUNCTIONS}
    table = driver.table_of(where, named, scale_at, lists_of(eq, watched(eq, step)))
    return PlainKernel(eq, step, text, places_of(step, places(eq, step, 1, 1, 1)), named, table)
