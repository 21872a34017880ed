"""A number of one body that also knows the same of the others: ``v`` is the body's own velocity, ``v["tail"]`` that of another one."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from typing import Any

from stickslip.basics.errors import InputError, did_you_mean


class OfOwn:
    """A number, array or symbol of one body, which gives those of all bodies by their names.

    In arithmetic and in functions it is the number itself.

    Parameters
    ----------
    value : float, array or symbol
        That of the body itself.
    others : mapping
        Those of all bodies by name.

    Examples
    --------
    >>> v = OfOwn(0.5, {"head": 0.5, "tail": -1.0})
    >>> 2.0 * v + v["tail"], abs(v - 1.0), v > 0.0
    (0.0, 0.5, True)
    """

    __slots__ = ("others", "value")
    __hash__ = None  # type: ignore[assignment]  # equality is that of the number

    def __init__(self, value: Any, others: Mapping[str, Any]):
        self.value, self.others = value, others

    def __getitem__(self, name: Any) -> Any:
        if not isinstance(name, str):
            return self.value[name]
        if name not in self.others:
            raise InputError("load", [f"there is no body {name!r}; {did_you_mean(name, self.others)}"])
        return self.others[name]

    def __getattr__(self, name: str) -> Any:
        if name in OfOwn.__slots__:
            raise AttributeError(name)
        return getattr(self.value, name)

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        return getattr(ufunc, method)(*map(without_others, inputs), **options)

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        import numpy as np

        return np.asarray(self.value, dtype)

    def __abs__(self) -> Any:
        return abs(self.value)

    def __neg__(self) -> Any:
        return -self.value

    def __pos__(self) -> Any:
        return self.value

    def __bool__(self) -> bool:
        return bool(self.value)

    def __float__(self) -> float:
        return float(self.value)

    def __repr__(self) -> str:
        return repr(self.value)


def without_others(value: Any) -> Any:
    """The number alone; anything else as it is."""
    return value.value if type(value) is OfOwn else value


def _both(name: str, swapped: bool) -> Callable[[OfOwn, Any], Any]:
    own = getattr(operator, name)
    if swapped:
        return lambda self, other: own(without_others(other), self.value)
    return lambda self, other: own(self.value, without_others(other))


for _name in ("add", "sub", "mul", "truediv", "pow", "floordiv", "mod"):
    setattr(OfOwn, f"__{_name}__", _both(_name, False))
    setattr(OfOwn, f"__r{_name}__", _both(_name, True))
for _name in ("lt", "le", "gt", "ge", "eq", "ne"):
    setattr(OfOwn, f"__{_name}__", _both(_name, False))
