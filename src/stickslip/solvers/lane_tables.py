"""The cases of a batch as the engine's lanes take them, and what their ends are: the one place that knows the order of the columns."""

from __future__ import annotations

from copy import copy
from typing import Any

import numpy as np

from stickslip.basics.batch import cases_of, numbers_by_name
from stickslip.basics.contracts import Array, Model
from stickslip.basics.fields import are_single, replace_leaf
from stickslip.engine import lanes, trace
from stickslip.models.machine_adapter import MachineAdapter, machine_of


class CaseTable:
    """Rows of numbers, starts (way, the states, the memories), and what to add to the lanes' states to get velocities.

    Parameters
    ----------
    model : Robot or machine
        One case, or a batch.
    kernel : lanes.Kernel
    start : array (cases, 2 coordinates + inner states + memories)
        Positions, velocities, inner states and memories, each in the order of coordinates and contacts.
    span : array
        Length of a period [s], one for all or one for each case.
    which : slice, optional
        The cases of the model that `start` and `span` are of: a large batch is made into tables part by part.
    more : dict of arrays (cases,), optional
        Numbers of the kernel that are none of the model, such as parts of a direction (`part_in` of `stickslip.engine.tangent`).
    machine : MachineAdapter, optional
        The model's adapter, or that of its flattened batch, where it is at hand.
    own : dict, optional
        The model's numbers in these cases (`numbers_by_name`), where they are at hand.
    """

    def __init__(
        self,
        model: Model,
        kernel: lanes.Kernel,
        start: Array,
        span: Any,
        which: slice = slice(None),
        more: dict[str, Array] | None = None,
        machine: MachineAdapter | None = None,
        own: dict[str, Any] | None = None,
    ):
        cases, machine = len(start), machine or machine_of(model)
        own = numbers_by_name(model, which) if own is None else own
        flat = machine if machine.model is not model or are_single(own.values()) else machine_of(replace_leaf(model, own))
        self.model, self.which = model, which
        self.span = span if np.shape(span) == (cases,) else np.broadcast_to(span, (cases,))
        known = {trace.SPAN: self.span, **(more or {}), **own}
        self.rows = np.empty((cases, len(kernel.names)))
        for column, name in enumerate(kernel.names):
            self.rows[:, column] = known.get(name, 0.0)
        self.count = count = len(kernel.owners)
        self._flat, self._own = flat, own
        offsets = flat.mechanics.offsets(0.0)
        self.offsets = np.empty((cases, count))
        for coordinate, contact in enumerate(kernel.owners):
            self.offsets[:, coordinate] = 0.0 if contact is None else -offsets[contact]
        self.cyclic = bool(kernel.layout.ways)
        steps = self.cyclic and not machine.has_inner_states
        self.carried = self.offsets[:, 0] if steps else 0.0 * self.offsets[:, 0]  # Taylor steps integrate the way over the contact
        self.inner = sum(machine.mechanics.inner)
        self.start = self.placed(start)

    def model_of(self, case: int) -> Any:
        """The model of one case, its numbers plain floats."""
        first = self.which.start or 0
        return cases_of(self.model, slice(first + case, first + case + 1))[0]

    def restarted(self, start: Array) -> CaseTable:
        """The table of the same cases from other starts."""
        other = copy(self)
        other.start = self.placed(start)
        return other

    def placed(self, start: Array, which: Any = slice(None)) -> Array:
        """Other starts of the same cases, or of some of them, as lanes take them: the way, the states, the memories."""
        count, memories = self.count, 2 * self.count + self.inner
        q, u, z, memory = start[:, :count], start[:, count : 2 * count], start[:, 2 * count : memories], start[:, memories:]
        if self._flat.mechanics.flying:
            z = np.column_stack(self._mechanics_of(which).completed(tuple(q.T), tuple(u.T), list(z.T)))
        places = q[:, 1:] - q[:, :1] if self.cyclic else q
        return np.ascontiguousarray(np.concatenate([q[:, :1], u - self.offsets[which], z, places, memory], axis=1))

    def _mechanics_of(self, which: Any) -> Any:
        """The machine with the numbers of some cases."""
        if are_single(self._own.values()) or (isinstance(which, slice) and which == slice(None)):
            return self._flat.mechanics
        return machine_of(replace_leaf(self.model, {name: np.asarray(own)[which] for name, own in self._own.items()})).mechanics

    def ends(self, results: lanes.Results) -> tuple[Array, Array, Array]:
        """Of every case at its end positions (what they are more than the first, where only that is a state), velocities, inner states."""
        end, n = results.end, self.count
        last = end.shape[1] - (n - 1 if self.cyclic else n)
        return end[:, last:], end[:, 1 : 1 + n] + self.offsets, end[:, 1 + n : last]
