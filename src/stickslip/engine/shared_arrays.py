"""The arrays that Python and the driver of lane kernels share, in one piece of memory."""

from __future__ import annotations

import math
from ctypes import addressof, c_char
from functools import lru_cache
from typing import Any

#: Arrays that Python and the functions of the driver share, and their types: their addresses and shapes stand in this order in the numbers
#: at W (`Shared.at`).
SHARED = {
    "JOB": "i1",  # see kernels/columns.py
    "LIMITS": "f1",
    "N": "i2",  # of each lane: whole numbers
    "K": "f2",  # numbers
    "RING": "f3",  # the last strobe points
    "XS": "f3",  # where everything is at the first of the window, and at the start of the last motion period
    "HELD": "f2",  # what its step holds
    "FOUND": "f3",  # what is found of signals
    "ROOM": "f2",  # where a step is looked at
    "PARAM": "f2",  # of each case: its numbers
    "START": "f2",
    "OUT": "f2",  # its results
    "COUNT": "i2",
    "CHANGED": "i2",  # of its last steps, if they used up its budget: with how many some mode changed, and that of each contact
    "NOTED": "f3",
    "SEGT": "f2",
    "SEGC": "b2",
    "PIECES": "f2",  # of a single case its dense output
    "STORE": "f2",  # of a pool: what its lanes hold from step to step
    "POOL": "i2",
    "GOAL": "f1",  # of a held lane: where it goes next (kernels/advancing.py)
}
_TYPES = {"i": "int64", "f": "float64", "b": "int8"}


class Shared:
    """Arrays of zeros, one after the other in one piece of memory.

    To make each by itself, and to ask it where it is, took an eighth of a short solve.

    Parameters
    ----------
    shapes : dict
        The shape of each array by its name in `SHARED`; one that is not named has no elements.

    Attributes
    ----------
    at : array of int
        The address and the shape of each, four numbers for each.
    memory : array
        That piece of memory, without arrays that have memory of their own.

    Examples
    --------
    >>> shared = Shared({"JOB": (3,), "SEGC": (2, 5), "K": (2, 4)})
    >>> shared["SEGC"].shape, shared["SEGC"].dtype.name, shared["JOB"].tolist()
    ((2, 5), 'int8', [0, 0, 0])
    """

    def __init__(self, shapes: dict[str, tuple[int, ...]]):
        import numpy as np

        size, self._places, there, at = _arranged(tuple(shapes.items()))
        self.memory = np.zeros(size)
        self.at = at + there * address_of(self.memory)
        self._made = dict[str, Any]()

    def __contains__(self, name: str) -> bool:
        """Whether an array has elements."""
        return name in self._places

    def __getitem__(self, name: str) -> Any:
        """An array."""
        import numpy as np

        if name not in self._made:
            shape, kind, begin = self._places[name]
            self._made[name] = np.ndarray(shape, kind, self.memory, begin)
        return self._made[name]

    def __setitem__(self, name: str, array: Any) -> None:
        """An array with memory of its own in place of one that was not named."""
        row = 4 * _ROWS[name]
        self.at[row : row + 1 + array.ndim] = (address_of(array), *array.shape)
        self._made[name] = array


_ROWS = {name: row for row, name in enumerate(SHARED)}


@lru_cache(256)
def _arranged(shapes: tuple[tuple[str, tuple[int, ...]], ...]) -> tuple[int, dict[str, tuple[tuple[int, ...], Any, int]], Any, Any]:
    """The size of arrays in floats; shape, type and first byte of each; where `Shared.at` has addresses, and what else it has."""
    import numpy as np

    places, size = dict[str, tuple[tuple[int, ...], Any, int]](), 0
    at, there = np.zeros((len(SHARED), 4), dtype=np.int64), np.zeros((len(SHARED), 4), dtype=np.int64)
    for name, shape in shapes:
        kind = np.dtype(_TYPES[SHARED[name][0]])
        places[name] = shape, kind, 8 * size
        at[_ROWS[name], : 1 + len(shape)], there[_ROWS[name], 0] = (8 * size, *shape), 1
        size += -(-math.prod(shape) * kind.itemsize // 8)
    return size, places, there.ravel(), at.ravel()


def address_of(array: Any) -> int:
    """Where the first number of an array stands."""
    try:
        return addressof(c_char.from_buffer(array))
    except (TypeError, ValueError):  # it must not be written to, or has no numbers
        return int(array.__array_interface__["data"][0])
