"""The base of dense outputs: what all kinds of pieces have, and how they are checked."""

from __future__ import annotations

from dataclasses import fields
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.models.state_layout import StateLayout


class DensePieces:
    """Base of the dense outputs. Piece i spans ``t[i]`` to ``t[i+1]`` and is smooth there.

    `mode` (pieces, contacts) is +1 sliding forwards, 0 stuck, -1 sliding backwards; under a dynamic law it is the sign of v, never 0.
    `memory` (pieces, memories) are the whole-number memories of the laws, `layout` describes the states. ``evaluate(t, index)`` gives
    x (time, body), v (time, body) and z (time, contact, state), NaN where a law has fewer, at times that lie on the given pieces;
    ``until(end)`` the same pieces up to a time. The fields are the arrays that are stored, and the layout, which is stored as text.
    """

    t: Any
    memory: Any
    evaluate: Any

    #: Fields that have no row for each piece.
    apart: ClassVar[tuple[str, ...]] = ("t",)

    @property
    def nodes(self) -> Array:
        """Times between which every state is smooth: the ends of the pieces."""
        return np.asarray(self.t)

    def jumps(self, nodes: Array, least: float) -> Array:
        """Whether a velocity jumps at nodes, given by their numbers, by more than `least` [m/s]."""
        around, at = np.concatenate([nodes - 1, nodes]), np.tile(self.t[nodes], 2)
        before, after = np.split(self.evaluate(at, around)[1], 2)
        return np.asarray(np.any(abs(after - before) > least, axis=1))

    def arrays(self) -> dict[str, Any]:
        """The arrays from which these pieces can be rebuilt, by name, and the layout as text; empty arrays are left out."""
        values = {f.name: getattr(self, f.name) for f in fields(self)}  # type: ignore[arg-type]
        arrays = {name: np.asarray(value) for name, value in values.items() if name != "layout"}
        return {name: array for name, array in arrays.items() if array.size} | {"layout": values["layout"].to_text()}

    @classmethod
    def from_arrays(cls, arrays: dict[str, Any]) -> Any:
        """The pieces that `arrays` came from."""
        given = {f.name: arrays[f.name] for f in fields(cls) if f.name in arrays}  # type: ignore[arg-type]
        if "layout" in given:
            given["layout"] = StateLayout.from_text(given["layout"])
        return cls(**{name: float(value) if isinstance(value, np.ndarray) and not value.ndim else value for name, value in given.items()})


@lru_cache
def flaws_of(layout: StateLayout, *counts: int) -> list[str]:
    """Inconsistencies of the arrays; computed once for each kind of machine."""
    return layout.flaws(*counts)


def count_until(t: Array, end: float) -> int:
    """Number of pieces that begin before a time, at least 1."""
    return max(int(np.searchsorted(t[:-1], end, side="left")), 1)
