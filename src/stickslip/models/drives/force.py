"""Base class of the forces on an inner mass, and sums of forces."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.fields import Frozen
from stickslip.basics.maths import within
from stickslip.models.drives.common import MOST_REPEATS, own_time, repeated_instants, repeats_of
from stickslip.models.drives.drive_adapter import lacking

#: What a force has to say; `breaks`, the instants in (0, period) at which it is not smooth [s], may be left out.
FORCE_NEEDS = ("period", "at")
_EXAMPLE = "type for example ss.HarmonicForce(amplitude=1.5, omega=104.7)"


def not_forces(given: dict[str, Any]) -> list[str]:
    """A sentence on each of some objects that is not a force, by its name."""
    needs = ", ".join(FORCE_NEEDS)
    return [
        f"{name} = {part!r}; allowed is a force, an object with {needs}; {_EXAMPLE}"
        for name, part in given.items()
        if lacking(part, FORCE_NEEDS)
    ]


class Force(Frozen):
    """Base of our forces, which add up with +. A force of your own is a frozen dataclass with a `period` [s] and `at(t)` [N]."""

    breaks: ClassVar[Any] = ()  # instants in (0, period) at which it is not smooth [s]

    def mirrored(self: Any) -> Any:
        """The force the other way round."""
        return replace(self, amplitude=-self.amplitude)

    def __add__(self, other: Any) -> ForceSum:
        return ForceSum((*_parts(self), *_parts(other)))

    def __radd__(self, other: Any) -> ForceSum:
        return ForceSum((*_parts(other), *_parts(self)))


@dataclass(frozen=True, eq=False, init=False)
class ForceSum(Force):
    r"""Forces that act simultaneously; written ``a + b``.

    Its period is their smallest common period.

    Parameters
    ----------
    parts : tuple of forces
        Two or more.
    repeats : tuple of int, optional
        How often each of them repeats in the common period, up to 64 times; found from their periods.

    Examples
    --------
    >>> import stickslip as ss
    >>> both = ss.HarmonicForce(amplitude=1.5, omega=100.0) + ss.HarmonicForce(amplitude=0.75, omega=150.0)
    >>> both.repeats, round(both.period, 9), round(both.at(0.01), 6)
    ((2, 3), 0.125663706, 2.010328)
    """

    parts: Any
    repeats: tuple[int, ...] | None = None

    part_kinds: ClassVar[dict[str, Any]] = {}  # what may stand in a study file; the registry of forces knows

    def __init__(self, parts: Any, repeats: Any = None):
        object.__setattr__(self, "parts", parts)
        object.__setattr__(self, "repeats", None if repeats is None else tuple(repeats))
        self.__post_init__()
        if repeats is None:
            object.__setattr__(self, "repeats", repeats_of([part.period for part in parts]))

    def _check(self, problems: Problems) -> None:
        if not isinstance(self.parts, tuple) or len(self.parts) < 2:
            problems.add(f"parts = {self.parts!r}; allowed is a tuple of two forces or more; {_EXAMPLE} + ss.drives.Pulses(1.0, 0.06, 0.3)")
            return
        for sentence in not_forces({f"parts[{i}]": part for i, part in enumerate(self.parts)}):
            problems.add(sentence)
        if problems.mistakes:
            return
        periods = [part.period for part in self.parts]
        repeats = repeats_of(periods)
        if repeats is None:
            given = ", ".join(f"{period:.10g}" if isinstance(period, float) else "an array" for period in periods)
            allowed = f"allowed are forces that all begin again together after {MOST_REPEATS} periods of each or fewer"
            problems.add(
                f"the periods {given} s have no common multiple; {allowed}; give them the same omega or period, or a ratio of small numbers"
            )
        elif self.repeats is not None and self.repeats != repeats:
            problems.add(f"repeats = {self.repeats!r}, and the periods have {repeats!r}; leave repeats out")

    def replace(self, changes: dict[str, Any] | None = None, /, **fields: Any) -> Any:
        """A copy with some fields changed; the common period is found again."""
        return super().replace({"repeats": None, **(changes or {}), **fields})

    @property
    def period(self) -> Any:
        """The common period [s]."""
        return self._repeats[0] * self.parts[0].period

    @property
    def _repeats(self) -> tuple[int, ...]:
        assert self.repeats is not None
        return self.repeats

    @property
    def breaks(self) -> tuple[Any, ...]:
        """Instants at which one of them is not smooth, in each of its periods, or at which such a one starts anew [s]."""
        broken = [(part, count) for part, count in zip(self.parts, self._repeats, strict=True) if _broken(part)]
        return tuple(instant for part, count in broken for instant in repeated_instants(part.breaks, part.period, count))

    def at(self, t: Numeric) -> Any:
        """The sum [N]."""
        total: Any = 0.0
        for part, count in zip(self.parts, self._repeats, strict=True):
            total = total + part.at(self._own_time(t, part, count))
        return total

    def _own_time(self, t: Numeric, part: Any, count: int) -> Any:
        """Time as a part takes it: of one that is not smooth that since its own period began [s]."""
        return own_time(within(t, self.period), part.period, count) if count > 1 and _broken(part) else t

    def mirrored(self) -> ForceSum:
        """The reversed sum."""
        return ForceSum(tuple(part.mirrored() for part in self.parts))

    @classmethod
    def example(cls) -> ForceSum:
        """Two harmonics that drive a capsubot."""
        from stickslip.models.drives.harmonic_force import HarmonicForce

        return HarmonicForce.example() + HarmonicForce(amplitude=0.75, omega=2 * HarmonicForce.example().omega, phase=1.5707963267948966)


def _broken(part: Any) -> bool:
    return bool(getattr(part, "breaks", ()))


def _parts(force: Any) -> tuple[Any, ...]:
    """The forces that are added: of a sum its own."""
    if problems := not_forces({"a + b": force}):
        raise InputError("ForceSum", problems)
    own = getattr(force, "parts", None)
    return own if isinstance(own, tuple) else (force,)
