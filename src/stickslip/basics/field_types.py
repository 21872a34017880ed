"""What the fields of a dataclass hold, from their types: a number, several, numbers by name, or something else."""

from __future__ import annotations

import builtins
import collections.abc
import dataclasses
import functools
import sys
import types
import typing
from collections.abc import Callable, Mapping
from typing import Annotated, Any, NamedTuple

from stickslip.basics.errors import InputError


class FieldType(NamedTuple):
    """What a field holds ("number", "numbers", "named" or "kind"), and whether None, and one number beside several, are allowed."""

    holds: str
    optional: bool
    also_one: bool


def field_types(cls: Any) -> Mapping[str, FieldType]:
    """The types of a dataclass's fields by name; an alias of float is a float.

    Examples
    --------
    >>> from stickslip.friction import LuGre
    >>> field_types(LuGre)["mu_plus"].holds, field_types(LuGre)["f_plus"].optional
    ('number', True)
    """
    known: bool = dataclasses.is_dataclass(cls)  # a name of its own: otherwise a type checker narrows cls
    if not known:
        raise InputError(cls.__name__, [f"it is not a dataclass; write @dataclass(frozen=True, eq=False) above class {cls.__name__}"])
    return _types_of(cls)


@functools.lru_cache(maxsize=256)
def _types_of(cls: Any) -> Mapping[str, FieldType]:
    owners = {name: owner for owner in reversed(cls.__mro__) for name in vars(owner).get("__annotations__", {})}
    return {field.name: _type_of(_evaluated(field.type, owners.get(field.name, cls))) for field in dataclasses.fields(cls)}


def _evaluated(annotation: Any, owner: type) -> Any:
    """The type that an annotation names; what only a type checker knows, and names of a function around the class, are placeholders."""
    if not isinstance(annotation, str):
        return annotation
    names = _Names({**getattr(sys.modules.get(owner.__module__), "__dict__", {}), **vars(owner)})
    try:
        return eval(annotation, {}, names)
    except Exception:  # an annotation may be any text
        return None


class _Anything(type):
    def __getattr__(cls, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return cls

    def __getitem__(cls, item: Any) -> Any:
        return cls


class _Unknown(metaclass=_Anything):
    """A class that is not there when a program runs."""


class _Names(dict[str, Any]):
    """The names of a module; of others those that annotations use, and placeholders."""

    def __missing__(self, name: str) -> Any:
        for library in (builtins, typing, collections.abc):
            if hasattr(library, name):
                return getattr(library, name)
        return _Unknown


def _type_of(hint: Any) -> FieldType:
    parts = _parts(hint)
    made_of = [(typing.get_origin(part) or part, typing.get_args(part)) for part in parts]
    plain = float in parts
    several = any(origin is tuple and inner[:1] == (float,) for origin, inner in made_of)
    mappings = [inner for origin, inner in made_of if isinstance(origin, type) and issubclass(origin, Mapping)]
    other = bool(mappings) or any(origin in (tuple, Callable) for origin, _ in made_of)
    holds = "number" if plain and not other else "numbers" if several else "named" if (str, float) in mappings else "kind"
    return FieldType(holds, type(None) in parts, plain)


def _parts(hint: Any) -> list[Any]:
    """The members of a union, without what annotations add to them."""
    origin = typing.get_origin(hint)
    if origin is Annotated:
        return _parts(typing.get_args(hint)[0])
    if origin in (typing.Union, types.UnionType):
        return [part for each in typing.get_args(hint) for part in _parts(each)]
    return [type(None) if hint is None else hint]
