"""Machines beside one: its numbers moved a little to either side, as far as they may be."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError
from stickslip.basics.fields import leaves

_PLAIN = 0.01  # what the size of a number that is zero is taken for


def sizes_of(model: Model, moved: dict[str, tuple[str, ...]]) -> Array:
    """Small steps for numbers that are varied together."""
    own = dict(leaves(model))
    return np.array([max(abs(float(own[name])) for name in names) or _PLAIN for names in moved.values()])


def moves_of(moved: dict[str, tuple[str, ...]], sizes: Array, shares: Any) -> dict[str, Array]:
    """How far each number is moved in each case: by every share of its size, one set of numbers after the other.

    Parameters
    ----------
    moved : dict
        Names of the numbers that are moved together.
    sizes : array (sets,)
    shares : array (shares,) or (sets, shares)

    Examples
    --------
    >>> {name: move.tolist() for name, move in moves_of({"a": ("a",), "b": ("b",)}, np.array([2.0, 3.0]), [-0.5, 0.5]).items()}
    {'a': [-1.0, 1.0, 0.0, 0.0], 'b': [0.0, 0.0, -1.5, 1.5]}
    """
    by = sizes[:, None] * np.asarray(shares)
    moves: dict[str, Array] = {}
    for i, names in enumerate(moved.values()):
        for name in names:
            moves.setdefault(name, np.zeros(by.shape))[i] = by[i]
    return {name: values.ravel() for name, values in moves.items()}


def sides_of(model: Model, moved: dict[str, tuple[str, ...]], share: float) -> Array:
    """To which side each set of numbers may be moved by a share of its size: 1 or -1 where the record refuses the other one, else 0.

    Examples
    --------
    >>> import stickslip as ss
    >>> sides_of(ss.presets.capsubot(), {"drive.damping": ("drive.damping",), "gravity": ("gravity",)}, 1e-6).tolist()
    [1, 0]
    """
    own, pairs = dict(leaves(model)), zip(moved.values(), share * sizes_of(model, moved), strict=True)
    each = [{name: own[name] + move for name in names} for names, size in pairs for move in (-size, size)]
    allowed = np.array([is_allowed(model, numbers) for numbers in each], int).reshape(-1, 2)
    return allowed[:, 1] - allowed[:, 0]


def is_allowed(model: Any, numbers: dict[str, Any]) -> bool:
    """Whether a record takes these numbers."""
    try:
        model.replace(numbers)
    except InputError:
        return False
    return True


def words_of(results: dict[str, Array]) -> list[list[str]]:
    """The sequences of modes of all contacts, for each direction and share."""
    columns = [values for name, values in results.items() if name.partition(".")[0] in ("pattern", "period")]
    shape = columns[0].shape
    return [["/".join(str(values[i, j]) for values in columns) for j in range(shape[1])] for i in range(shape[0])]
