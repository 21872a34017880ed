"""Laws added up: dry friction and oil, a bristle and a film."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.fields import everywhere
from stickslip.basics.maths import minimum
from stickslip.models.friction.law import Law
from stickslip.models.friction.law_adapter import LawAdapter, adapted, is_law


@dataclass(frozen=True, eq=False)
class Sum(Law):
    """Two laws that act simultaneously on one contact; written `a + b` or ``Sum(a, b)``.

    Set-valued laws add to a set-valued law. A law with inner states can be added to a law without static friction, such as `Viscous`. Two
    laws with inner states, or one of them and a law that sticks, cannot be added.

    Parameters
    ----------
    first, second : law
        Any two laws, or sums of them; your own too.

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.Coulomb(mu_plus=0.15, mu_minus=0.21) + ss.Viscous(viscous_plus=2.0, viscous_minus=4.0)
    >>> f"{law.sliding(v=0.1, load=10.0):.3f} {law.sliding(v=-0.1, load=10.0):.3f}"
    '1.700 -2.500'
    >>> law.replace({"second.viscous_plus": 3.0}).sliding(v=0.1, load=10.0)
    1.8
    """

    first: Any
    second: Any

    def __new__(cls, *args: Any, **kwargs: Any) -> Any:
        """A sum of the kind that the two laws make."""
        if cls is Sum and (args or kwargs):
            parts = [*args, *kwargs.values()]
            cls = _kind(parts) if len(parts) == 2 else cls
        return super().__new__(cls, *args, **kwargs)

    def _check(self, problems: Problems) -> None:
        _kind([self.first, self.second])

    @classmethod
    def example(cls) -> Any:
        """Dry friction and oil."""
        from stickslip.models.friction.stribeck import Stribeck
        from stickslip.models.friction.viscous import Viscous

        return Stribeck.example() + Viscous.example()

    @property
    def title(self) -> str:
        """The names of the parts: "Dahl + Viscous"."""
        return f"{adapted(self.first).name} + {adapted(self.second).name}"

    @property
    def approximation(self) -> str:
        """The defects of the parts; empty if there are none."""
        return "; ".join(filter(None, (getattr(part, "approximation", "") for part in (self.first, self.second))))

    @property
    def velocity_scale(self) -> Any:
        """The smaller of the parts' velocity scales; absent where they have none."""
        methods = [part.velocity_scale for part in (self.first, self.second) if hasattr(part, "velocity_scale")]
        if not methods:
            raise AttributeError("velocity_scale")
        return methods[0] if len(methods) == 1 else lambda: minimum(methods[0](), methods[1]())

    def notes(self, load: Numeric) -> list[str]:
        """The notes of both parts."""
        return [note for part in (self.first, self.second) for note in adapted(part).notes(load)]

    def cautions(self, load: Numeric) -> list[str]:
        """The cautions of both parts."""
        return [caution for part in (self.first, self.second) for caution in adapted(part).cautions(load)]


class SlidingSum(Sum):
    """A set-valued sum."""

    def sliding(self, v: Numeric, load: Numeric) -> Any:
        """Friction force R while sliding with velocity v [N]."""
        return _moving(self.first, v, load) + _moving(self.second, v, load)

    def breakaway(self, load: Numeric) -> tuple[Any, Any]:
        """Static friction limits (backward, forward) [N]."""
        held = [part.breakaway(load) for part in map(adapted, (self.first, self.second)) if not part.dynamic]
        return sum(low for low, _ in held), sum(high for _, high in held)


#: What a sum says as its law with inner states says it, where that says it at all.
_OF_THE_STATES = ("states", "modes", "rate", "switches", "scale", "slip_length", "creep_velocity", "start", "scalar_only", "random")


class DynamicSum(Sum):
    """The sum of a dynamic law and one without static friction."""

    def _parts(self) -> tuple[Any, Any]:
        one, two = adapted(self.first), adapted(self.second)
        return (self.first, self.second) if _remembers(one) or not two.dynamic else (self.second, self.first)

    def __getattr__(self, name: str) -> Any:
        if name in _OF_THE_STATES:
            return getattr(self._parts()[0], name)
        raise AttributeError(f"{type(self).__name__} has no {name!r}")

    def force(self, v: Numeric, z: Numeric, zdot: Numeric, load: Numeric) -> Any:
        """Friction force R [N]."""
        dynamic, other = self._parts()
        return dynamic.force(v, z, zdot, load) + _moving(other, v, load)


class ModalSum(DynamicSum):
    """The same where the dynamic law has discrete memory."""

    def force(self, v: Numeric, z: Numeric, zdot: Numeric, load: Numeric, mode: tuple[Numeric, ...]) -> Any:  # type: ignore[override]
        """Friction force R [N]."""
        dynamic, other = self._parts()
        return dynamic.force(v, z, zdot, load, mode) + _moving(other, v, load)


def _moving(law: LawAdapter, v: Numeric, load: Numeric) -> Any:
    """Force of a law without memory at velocity v [N]."""
    return adapted(law).force(v, (), (), load)


def _remembers(law: LawAdapter) -> bool:
    return law.states > 0 or law.modes > 0


def _sticks(law: LawAdapter) -> bool:
    return not law.dynamic and not all(everywhere(force == 0) for force in law.breakaway(1.0))


def _kind(parts: list[Any]) -> type:
    """Which sum two laws make; `InputError` where they make none."""
    problems, names = Problems("Sum"), [type(part).__name__ for part in parts]
    for part, name in zip(parts, names, strict=True):
        if isinstance(part, type) or not is_law(part):
            problems.add(f"{part!r} is not a friction law; allowed are two laws; type for example ss.Dahl(...) + ss.Viscous(...)")
        elif adapted(part).needs_applied:
            problems.add(f"{name} balances the other forces at rest, so nothing can be added to it; use ss.Coulomb, solved exactly")
    problems.check()
    known = [adapted(part) for part in parts]
    memory, sticks = [_remembers(law) for law in known], [_sticks(law) for law in known]
    if all(memory):
        raise InputError("Sum", [f"{names[0]} and {names[1]} both have inner states; allowed is one such law; write one law with both"])
    if any(memory) and any(sticks):
        raise InputError(
            "Sum",
            [f"{names[0]} and {names[1]}: one has inner states and the other sticks; allowed beside a law with inner states is one "
             "without static friction, such as ss.Viscous"],
        )  # fmt: skip
    if any(law.modes for law in known):
        return ModalSum
    return DynamicSum if any(law.dynamic for law in known) and not any(sticks) else SlidingSum
