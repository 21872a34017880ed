"""Base class of the built-in laws: a record that can be added to another law and has an example."""

from __future__ import annotations

import inspect
from typing import Any

from stickslip.basics.constructors import arguments_of
from stickslip.basics.errors import InputError
from stickslip.basics.fields import Frozen, example_in, is_array
from stickslip.basics.number_names import pairs_in


class Symmetric(type):
    """Kind of the classes of laws: one coefficient stands for both directions.

    A number that a law has for each direction, such as ``mu_plus`` and ``mu_minus``, may be given once, as ``mu``. A law whose numbers
    are given for the forward direction alone has the same backwards.
    """

    @property
    def __signature__(cls) -> inspect.Signature:
        return inspect.Signature(list(arguments_of(cls).values()))

    def __call__(cls, *args: Any, **kwargs: Any) -> Any:
        """The law, with the numbers of one direction taken for both where only these are given."""
        return super().__call__(*args, **(_for_both(cls, args, kwargs) if args or kwargs else {}))


def _for_both(cls: type, args: tuple[Any, ...], kwargs: dict[str, Any]) -> dict[str, Any]:
    """The arguments by name, with those of the other direction."""
    names = list(arguments_of(cls))
    pairs = pairs_in(names)
    if not pairs:
        return kwargs
    full, placed = dict(kwargs), dict(zip(names, args, strict=False))
    for stem, (forwards, backwards) in pairs.items():
        if stem not in full:
            continue
        if twice := [name for name in (forwards, backwards) if name in full or name in placed]:
            raise InputError(cls.__name__, [f"{stem} = {full[stem]!r} is for both directions, and {twice[0]} is given too; leave one out"])
        full[forwards] = full[backwards] = full.pop(stem)
    given = {**placed, **kwargs}
    if not any(backwards in given for _, backwards in pairs.values()):
        full |= {backwards: given[forwards] for forwards, backwards in pairs.values() if forwards in given}
    return full


class Law(Frozen, metaclass=Symmetric):
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
