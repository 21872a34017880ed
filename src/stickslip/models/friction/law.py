"""Base class of the built-in laws: a record that can be added to another law and has an example."""

from __future__ import annotations

from typing import Any

from stickslip.basics.fields import Frozen, example_in, is_array


class Law(Frozen):
    """Base of the built-in laws. A law of your own needs nothing from here."""

    @classmethod
    def example(cls) -> Any:
        """The law with the numbers of an ordinary dry contact, for a load of about 1 N."""
        return example_in(cls)

    def __add__(self, other: Any) -> Any:
        from stickslip.models.friction.sum import Sum

        return Sum(self, other)

    def __radd__(self, other: Any) -> Any:
        from stickslip.models.friction.sum import Sum

        return Sum(other, self)


def field_numbers(values: Any) -> tuple[Any, ...]:
    """A field of several numbers; () where there is none, or something else among them, which has been reported."""
    good = isinstance(values, tuple) and all(isinstance(value, float) or is_array(value) for value in values)
    return values if good else ()
