"""What a held lane follows, a machine or a flow, as `Simulation` takes it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from stickslip.basics.contracts import Array


@dataclass(frozen=True)
class Standing:
    """Where a case stands at an instant [s]: states with velocities in full, sides of contacts, memories, and which contacts fly."""

    t: float
    states: Array
    sides: Array
    memory: Array
    aloft: Array


class HeldCase(Protocol):
    """A machine or a flow with the numbers that it has now.

    Attributes
    ----------
    model : Any
        It, with these numbers.
    period : float or None
        After which its time begins anew [s]; None where it goes on.
    method : str
    is_pushed : bool
        Whether a force stands on each body.
    asked : dict
        The arguments of `simulation`: start, rtol, method, mode.
    """

    model: Any
    period: float | None
    method: str
    is_pushed: bool
    asked: dict[str, Any]

    @property
    def names(self) -> Mapping[str, str]:
        """Its inputs, each with the number that it is."""

    @property
    def unit(self) -> float | None:
        """A typical time [s], where one is known."""

    def numbers(self) -> dict[str, float]:
        """The inputs as they are now."""

    @property
    def machine(self) -> Any:
        """What was given, with these numbers."""

    @property
    def kernel_name(self) -> str:
        """The name of its kernel's file, which has a checksum of its content."""

    def ready_for(self, numbers: Mapping[str, float]) -> Any:
        """The case in which these numbers can change to these values; what has not been compiled yet is."""

    def is_as(self, other: Any) -> bool:
        """Whether another case of this simulation has the same numbers."""

    def is_quick(self, number: str) -> bool:
        """Whether a number may change without a look at the rest of the machine."""

    def knows(self, memory: Any) -> bool:
        """Whether what is remembered, as of a file, may stand there."""

    def column(self, number: str) -> int | None:
        """Where such a number stands in a row; None where it does not yet."""

    def lane(self, span: float, side: Any = None) -> Any:
        """A lane at the start, or where another lane stands; `span` is the length of a run that has no period [s]."""

    def row(self, span: float) -> Array:
        """The numbers in the kernel's order."""

    def changed(self, numbers: Mapping[str, float]) -> Any:
        """The same case with other numbers."""

    def rebase(self, side: Any, before: Any, t: float) -> None:
        """Count the states from what these numbers say, which were counted from what others said before."""

    def judge_anew(self, side: Any) -> None:
        """Have the kernel decide which contacts stick, where it does not do so at every jump of an input."""

    def standing(self, side: Any, t: float) -> Standing:
        """Where a lane stands."""

    def state(self, side: Any, t: float) -> dict[str, Any]:
        """The same by the names of columns."""

    def start(self, side: Any, t: float) -> dict[str, Any]:
        """The same as `solve` takes a start."""

    def parts(self, side: Any, t: float) -> dict[str, dict[str, Any]]:
        """The same by the names of the parts."""

    def events(self, before: Standing, rows: Array, after: Standing) -> list[Any]:
        """What happened in some steps of dense output, and at either end of them."""

    def lost(self, side: Any, t: float) -> list[Any]:
        """What happened where a run ended because a load fell to zero."""

    def whole(self, before: Standing, rows: Array, side: Any) -> Array:
        """Some steps that are kept: with what has begun and not ended."""

    def run(self, rows: Array, more: dict[str, Any]) -> Any:
        """Some steps of dense output as the result that `solve` gives."""

    def budget(self, duration: float) -> float:
        """Steps that may be taken in so much time [s]."""

    def sentence(self, status: int, side: Any, t: float) -> str:
        """Why a step could not be made."""


def times_of(rows: Array, period: float | None) -> Array:
    """Begin of the first step and end of each of some rows of dense output [s]."""
    T = 0.0 if period is None else period
    return np.concatenate([[rows[0, 0] * T + rows[0, 1]], rows[:, 0] * T + rows[:, 2]])
