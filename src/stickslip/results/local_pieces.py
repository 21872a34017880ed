"""Dense output of a row of many bodies, each of which has pieces of its own."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed
from stickslip.models.state_layout import StateLayout
from stickslip.results.pieces import DensePieces, count_until, flaws_of


@sealed
@dataclass(frozen=True, eq=False)
class LocalPieces(DensePieces):
    r"""A polynomial for the position of each body on each of its own pieces.

    While one block of a thousand slips, the others rest, and their motion needs no new numbers. So every body has pieces of its own, and
    the pieces of the run, between which nothing but modes is kept, are the times from one event to the next.

    With :math:`d = t - t_i` the position of a body is :math:`\sum_k c_k d^k`, from the beginning of its piece to that of its next one.

    Parameters
    ----------
    t : array (n + 1,)
        The start, the events, and the end [s].
    mode : array (n, contacts) of int8
        +1 sliding forwards, 0 stuck, -1 sliding backwards.
    begins : array (pieces,)
        When the pieces of the bodies begin, in order of the bodies and of time [s].
    coefficients : array (pieces, degree + 1)
        The coefficients c, lowest power first.
    first : array (bodies + 1,) of int
        Number of the first piece of each body, and of all pieces.
    layout : StateLayout
        Names of the bodies and contacts.

    Examples
    --------
    >>> from stickslip.models.state_layout import BodyStates, ContactStates
    >>> layout = StateLayout((BodyStates("block", 0, position=1),), (ContactStates("block"),))
    >>> t, c = np.array([0.0, 1.0, 3.0]), np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    >>> block = LocalPieces(t, np.array([[1], [0]]), begins=t[:2], coefficients=c, first=np.array([0, 2]), layout=layout)
    >>> x, v, z = block.evaluate(np.array([0.5, 2.0]), np.array([0, 1]))
    >>> x.tolist(), v.tolist()
    ([[0.25], [1.0]], [[1.0], [0.0]])
    """

    t: Array
    mode: Array
    begins: Array
    coefficients: Array
    first: Array
    layout: StateLayout

    def __post_init__(self) -> None:
        bodies, flaws = len(self.layout.bodies), []
        if len(self.first) != bodies + 1:
            flaws = [f"first has {len(self.first)} numbers for {bodies} bodies; allowed is one for each and that of all pieces"]
        flaws += flaws_of(self.layout, 2 * bodies, 0, 0, np.shape(self.mode)[1])
        if flaws:
            raise InputError("LocalPieces", flaws)

    @property
    def memory(self) -> Array:
        """Set-valued laws have no memory: (n, 0)."""
        return np.empty((len(self.mode), 0), np.int32)

    @property
    def nodes(self) -> Array:
        """The events, and so many ends of steps that nothing between them is longer than the shortest step that no event has cut.

        Where one step follows another the motion is as smooth as within them.
        """
        last = np.zeros(len(self.begins), bool)
        last[self.first[1:][np.diff(self.first) > 0] - 1] = True
        ends = np.append(self.begins[1:], self.t[-1])[~last]
        whole = ends[np.searchsorted(self.t, ends, side="left") == np.searchsorted(self.t, ends, side="right")]
        if not len(whole):
            return np.asarray(self.t)
        lengths = (ends - self.begins[~last])[np.isin(ends, whole)]
        candidates, shortest = np.unique(np.concatenate([self.t, whole[(whole > self.t[0]) & (whole < self.t[-1])]])), lengths.min()
        keep, kept = np.isin(candidates, self.t), candidates[0]
        for k, (now, following) in enumerate(zip(candidates[:-1].tolist(), candidates[1:].tolist(), strict=True)):
            keep[k] |= following - kept > shortest
            kept = now if keep[k] else kept
        return candidates[keep]

    def evaluate(self, t: Array, index: Array) -> tuple[Array, Array, Array]:
        """x, v (time, body) and no inner states (time, contact, 0); positions and velocities are continuous, so that no piece matters."""
        t = np.asarray(t, float)
        x, v = np.empty((2, len(self.first) - 1, len(t)))
        degree = self.coefficients.shape[1] - 1
        for i, (begin, end) in enumerate(zip(self.first[:-1], self.first[1:], strict=True)):
            piece = begin + np.maximum(np.searchsorted(self.begins[begin:end], t, side="right") - 1, 0)
            c, d = self.coefficients[piece], t - self.begins[piece]
            x[i], v[i] = c[:, degree], 0.0
            for k in range(degree - 1, -1, -1):
                v[i] = v[i] * d + x[i]
                x[i] = x[i] * d + c[:, k]
        return x.T, v.T, np.empty((len(t), len(self.layout.contacts), 0))

    def jumps(self, nodes: Array, least: float) -> Array:
        """No velocity jumps."""
        return np.zeros(len(nodes), bool)

    def until(self, end: float) -> LocalPieces:
        """The same pieces up to a time."""
        n = count_until(self.t, end)
        return replace(self, t=np.append(self.t[:n], end), mode=self.mode[:n])
