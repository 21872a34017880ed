"""Types of functions in the texts of kernels, as they stand in decorators: ``void(int64, f1)``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache


@dataclass(frozen=True)
class Number:
    """The type of a number, or `void`."""

    name: str

    def __call__(self, *takes: Number | InMemory) -> Signature:
        """Functions that return such a number and take these."""
        return Signature(self, takes)


@dataclass(frozen=True)
class InMemory:
    """Arrays: numbers that stand in a row in memory, those of the last axis side by side."""

    number: Number
    axes: int


@dataclass(frozen=True)
class Several:
    """Several numbers together, which a function returns."""

    numbers: tuple[Number, ...]

    def __call__(self, *takes: Number | InMemory) -> Signature:
        """Functions that return such numbers and take these."""
        return Signature(self, takes)


@dataclass(frozen=True)
class Signature:
    """What a function returns and takes.

    Examples
    --------
    >>> signature("float64(f1, int64)").takes
    (InMemory(number=Number(name='float64'), axes=1), Number(name='int64'))
    """

    returns: Number | Several
    takes: tuple[Number | InMemory, ...]


VOID, INT64, FLOAT64, BOOLEAN, INT8 = map(Number, ("void", "int64", "float64", "boolean", "int8"))


def _tuple(numbers: Sequence[Number]) -> Several:
    return Several(tuple(numbers))


def _uniform(number: Number, count: int) -> Several:
    return Several((number,) * count)


#: Types, by the names that they have in a text.
TYPES = {number.name: number for number in (VOID, INT64, FLOAT64, BOOLEAN, INT8)}
TYPES |= {"Tuple": _tuple, "UniTuple": _uniform}  # type: ignore[dict-item]
TYPES |= {f"{letter}{axes}": InMemory(number, axes) for letter, number in (("f", FLOAT64), ("i", INT64), ("b", INT8)) for axes in (1, 2, 3)}  # type: ignore[misc]


@lru_cache(1024)
def signature(text: str) -> Signature:
    """The signature that a text says."""
    declared: Signature = eval(text, {"__builtins__": {}}, dict(TYPES))
    return declared


@lru_cache(64)
def array_type(text: str) -> InMemory:
    """The type of an array, such as ``f2``."""
    declared: InMemory = eval(text, {"__builtins__": {}}, dict(TYPES))
    return declared
