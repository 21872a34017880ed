"""What every built-in law is: a record that can be added to another law and has an example."""

from __future__ import annotations

from typing import Any, ClassVar

from stickslip.errors import Problems
from stickslip.fields import Record, describe, number

__all__ = ["Law"]


class Law(Record):
    """Base of the built-in laws. A law of your own needs nothing from here."""

    _example: ClassVar[dict[str, Any]] = {}

    @classmethod
    def example(cls) -> Any:
        """The law with the numbers of an ordinary dry contact, for a load of about 1 N."""
        return cls(**cls._example)

    def __add__(self, other: Any) -> Any:
        from stickslip.friction.sum import Sum

        return Sum(self, other)

    def __radd__(self, other: Any) -> Any:
        from stickslip.friction.sum import Sum

        return Sum(other, self)

    def _several(self, name: str, rule: Any, allowed: str, problems: Problems) -> tuple[Any, ...]:
        """A field of several numbers as a tuple; () where it is none, which is reported."""
        given = getattr(self, name)
        try:
            values = tuple(number(value) for value in given)
        except (TypeError, ValueError):
            problems.add(f"{name} = {given!r}; allowed is several numbers, each {allowed}; type for example {name}=(0.1, 0.2)")
            return ()
        object.__setattr__(self, name, values)
        bad = [f"{name}[{k}] = {describe(x)}" for k, x in enumerate(values) if not _good((abs(x) < float("inf")) & rule(x))]
        if bad:
            problems.add(f"{', '.join(bad)}; each must be {allowed}; type for example {name}=(0.1, 0.2)")
        return () if bad else values


def _good(condition: Any) -> bool:
    return bool(condition.all()) if hasattr(condition, "all") else bool(condition)
