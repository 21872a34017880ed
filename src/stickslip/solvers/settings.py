"""The arguments of `solve`: as they are given, and in their final form."""

from __future__ import annotations

import platform
import sys
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.basics.batch import Labels, of_cases
from stickslip.basics.contracts import Array
from stickslip.basics.errors import Problems, is_one_of
from stickslip.models.machine_adapter import MachineAdapter, machine_of
from stickslip.models.observables import Observable

LONGEST = 1e12


@dataclass(frozen=True, eq=False)
class Settings:
    """The arguments of `solve` besides the model, as they are given; its docstring says what they are. `options` are those of the method.

    Examples
    --------
    >>> Settings(periods=20).rtol, list(Settings(periods=20, slip_ratio=0.5).differing())
    (1e-06, ['periods', 'slip_ratio'])
    """

    periods: Any = None
    settle: Any = None
    rtol: Any = 1e-6
    start: Any = None
    workers: Any = 1
    keep: Any = None
    samples: Any = 400
    method: Any = "auto"
    slip_ratio: Any = 0.75
    dwell: Any = 0.03
    progress: Any = None
    duration: Any = None
    observe: Any = None
    events: Any = None
    options: dict[str, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, arguments: dict[str, Any]) -> Settings:
        """Those of a dict of arguments; what is none of them is an option of the method."""
        known = {each.name for each in fields(cls)} - {"options"}
        options = {name: value for name, value in arguments.items() if name not in known}
        return cls(**{name: value for name, value in arguments.items() if name in known}, options=options)

    def differing(self) -> dict[str, Any]:
        """Those that are not the default."""
        given = {each.name: (getattr(self, each.name), each.default) for each in fields(self) if each.name != "options"}
        return {
            name: value for name, (value, usual) in given.items() if not (value is usual or (type(value) is type(usual) and value == usual))
        }


@dataclass(frozen=True, eq=False)
class Request:
    """Arguments of `solve` in their final form."""

    model: Any
    labels: Labels
    periods: int
    settle: int
    auto: bool
    rtol: float
    start: Any  # (cases, 2 coordinates + inner states + memories): positions, velocities, inner states, memories of the laws
    given_start: dict[str, Any]
    workers: int
    keep: str
    samples: int
    method: str
    slip_ratio: float
    dwell: float
    progress: Callable[[int, int], Any]  # cases begun, cases
    options: dict[str, Any]
    duration: float | None  # [s], where it was given
    span: Any  # (cases,): time of one period [s]: the model's, or the duration if it has none
    observe: tuple[tuple[str, Observable], ...] = ()
    numbers: dict[str, Any] = field(default_factory=dict)  # of the model
    partial: bool = False  # whether an interruption ends it with what is done
    flat: MachineAdapter | None = None  # of a batch of machines: its numbers are columns of the cases
    modes: Any = ()  # in which the cases of a flow begin
    equations: Any = None  # of a flow, traced
    left_out: float = 0.0  # time for which the cases of a flow without a period settle before their numbers
    watched: Any = None  # of a batch with a user's events: what takes note of each case's dense output (`named_events.Watched`)

    @property
    def cases(self) -> int:
        """Number of cases."""
        return self.labels.cases

    def numbers_of(self, cases: slice = slice(None)) -> dict[str, Any]:
        """The model's numbers in some cases, as `stickslip.basics.batch.numbers_by_name` gives them."""
        return of_cases(self.numbers, self.labels, cases)

    @property
    def lengths(self) -> Array:
        """How long each case is followed: array (cases,)."""
        return np.full(self.cases, self.duration) if self.duration is not None else self.periods * self.span

    @cached_property
    def machine(self) -> MachineAdapter:
        """The model, to be asked for what not every machine has."""
        return machine_of(self.model)


def check_rtol(rtol: Any, problems: Problems) -> None:
    """Add a sentence if a relative tolerance is none that the methods can hold."""
    if not isinstance(rtol, (int, float)) or not 1e-12 <= rtol <= 1e-3:
        problems.add(f"rtol = {rtol!r}; allowed is 1e-12 to 1e-3; type for example rtol=1e-6")


def check_duration(duration: Any, periods: Any, problems: Problems, unit: str = "") -> bool:
    """Note a duration that is no time, or given beside periods; whether it is a time."""
    if periods is not None:
        problems.add(f"periods = {periods!r} and duration = {duration!r} are both given; allowed is one of them; leave periods out")
    good = not isinstance(duration, bool) and isinstance(duration, (int, float)) and 0.0 < duration <= LONGEST
    if not good:
        problems.add(f"duration = {duration!r}; allowed is a positive time{unit}, up to {LONGEST:.0e}; type for example duration=10.0")
    return good


def periods_begun(duration: float, period: float) -> int:
    """As many periods as a duration begins."""
    return max(int(np.ceil(duration / period * (1 - 1e-12))), 1)


def check_keep(keep: Any, labels: Labels, problems: Problems) -> None:
    """Checks `keep`: the result of a solve, which for a batch is a summary."""
    if keep is not None and not is_one_of(keep, ("trajectory", "summary")):
        problems.add(f'keep = {keep!r}; allowed is "trajectory" or "summary"')
    if is_one_of(keep, ("trajectory",)) and labels.shape:
        problems.add(
            f'keep = "trajectory" is for one case and this is a batch of shape {labels.shape}; type keep="summary", or solve one case'
        )


def versions() -> dict[str, str]:
    """Versions of what computes: of the compiler where it is at work."""
    import stickslip

    versions = {"stickslip": stickslip.__version__, "python": platform.python_version(), "numpy": np.__version__}
    return versions | ({"llvmlite": sys.modules["llvmlite"].__version__} if "llvmlite" in sys.modules else {})
