"""Frozen records with frozen arrays: writing into an array cannot change a result."""

from __future__ import annotations

import dataclasses
import functools
from typing import Any, TypeVar, dataclass_transform

import numpy as np

Record = TypeVar("Record")


_PLAIN = frozenset({bool, float, int, str, type(None)})  # nothing in them can change


def seal(value: Any) -> Any:
    """The same value with arrays that cannot be written to; also those in a list, a tuple or a dict. The giver's own array stays as it is.

    Examples
    --------
    >>> own = np.zeros(2)
    >>> seal({"a": [own]})["a"][0].flags.writeable, own.flags.writeable
    (False, True)
    """
    if type(value) in _PLAIN:
        return value
    if isinstance(value, np.ndarray):
        if value.flags.writeable:
            value = value.view()
            value.setflags(write=False)
        return value
    if type(value) is dict:
        return {name: part if type(part) in _PLAIN else seal(part) for name, part in value.items()}
    return type(value)(map(seal, value)) if type(value) in (list, tuple) else value


@dataclass_transform(frozen_default=True, eq_default=False)
def sealed(cls: type[Record]) -> type[Record]:
    """A frozen dataclass whose fields are sealed when it is made, and its cached properties when they are computed.

    A class becomes one whose records are equal to themselves alone; what is a dataclass already stays as it is.

    Examples
    --------
    >>> @sealed
    ... class Curve:
    ...     x: Any
    >>> Curve(np.zeros(3)).x[0] = 1.0
    Traceback (most recent call last):
    ...
    ValueError: assignment destination is read-only
    """
    if "__dataclass_fields__" not in vars(cls):
        cls = dataclasses.dataclass(frozen=True, eq=False)(cls)
    made: Any = cls.__init__
    names = [field.name for field in dataclasses.fields(cls)]  # type: ignore[arg-type]

    @functools.wraps(made)
    def __init__(self: Any, *args: Any, **kwargs: Any) -> None:
        made(self, *args, **kwargs)
        for name in names:
            given = getattr(self, name)
            if type(given) not in _PLAIN and (kept := seal(given)) is not given:
                object.__setattr__(self, name, kept)

    cls.__init__ = __init__  # type: ignore[method-assign]
    for base in cls.__mro__:
        for part in vars(base).values():
            if isinstance(part, functools.cached_property):
                _seal_what_it_computes(part)
    return cls


def _seal_what_it_computes(part: functools.cached_property[Any]) -> None:
    compute = part.func
    if not hasattr(compute, "sealed"):

        @functools.wraps(compute)
        def func(self: Any) -> Any:
            return seal(compute(self))

        func.sealed = True  # type: ignore[attr-defined]
        part.func = func
