"""Dense output of a flow that switches: a polynomial for each state on each step, between its switches."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.polynomial.polynomial import polyval

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed
from stickslip.models.state_layout import StateLayout
from stickslip.results.pieces import DensePieces, count_until

_NO_BODIES = StateLayout((), (), ())
_LOOKS = 33  # samples of a polynomial on one step, from which its extremes are refined


class ModeChange(NamedTuple):
    """A switch: its time, and the modes before and after it, by their names."""

    t: float
    before: Any
    after: Any


@sealed
@dataclass(frozen=True, eq=False)
class FlowPieces(DensePieces):
    r"""The states of a flow, :math:`\sum_k c_k \theta^k` with :math:`\theta = (t - t_i)/h_i` on each step. It has no bodies.

    Parameters
    ----------
    t : array (n + 1,)
        Ends of the steps.
    mode : array (n,) of int
        The mode of each step, as its place among the flow's modes.
    coefficients : array (n, states, degree + 1)
        The coefficients c, lowest power first.
    end : array (states,)
        The state at the end, after a switch at that instant.
    end_mode : int
        The mode there, as its place.
    passed : array (m, states), optional
        States between two switches at the same instant.
    switch_times : array (switches,), optional
        The instants of the switches, in order.
    switch_modes : array (switches, 2) of int, optional
        The modes before and after each, as their places.

    Examples
    --------
    >>> fall = FlowPieces(np.array([0.0, 2.0]), np.array([0]), np.array([[[1.0, 2.0]]]), np.array([3.0]), 0)
    >>> fall.states(np.array([0.5]), np.array([0])).tolist(), fall.until(1.0).end.tolist()
    ([[1.5]], [2.0])
    """

    t: Array
    mode: Array
    coefficients: Array
    end: Array
    end_mode: int
    passed: Array = None  # type: ignore[assignment]
    switch_times: Array = None  # type: ignore[assignment]
    switch_modes: Array = None  # type: ignore[assignment]
    layout: StateLayout = _NO_BODIES

    apart: ClassVar[tuple[str, ...]] = ("t", "end", "end_mode", "passed", "switch_times", "switch_modes")

    def __post_init__(self) -> None:
        if self.passed is None:
            object.__setattr__(self, "passed", np.empty((0, len(self.end))))
        if self.switch_times is None:
            object.__setattr__(self, "switch_times", np.empty(0))
        if self.switch_modes is None:
            object.__setattr__(self, "switch_modes", np.empty((0, 2), int))
        if type(self.end_mode) is not int:  # an array (1,) in files
            object.__setattr__(self, "end_mode", int(np.ravel(self.end_mode)[0]))
        if (shape := np.shape(self.switch_modes)) != (len(self.switch_times), 2):
            raise InputError("FlowPieces", [f"switch_modes of shape {shape}; allowed is ({len(self.switch_times)}, 2), as switch_times"])

    @property
    def memory(self) -> Array:
        """A flow's modes are all that it remembers: (n, 0)."""
        return np.empty((len(self.mode), 0), np.int32)

    def states(self, t: Array, index: Array) -> Array:
        """The states (time, state) at times on the given steps."""
        start = self.t[index]
        return polynomials(self.coefficients[index], (t - start) / (self.t[index + 1] - start))

    def until(self, end: float) -> FlowPieces:
        """The same up to a time, the last step cut there."""
        n = count_until(self.t, end)
        c = self.coefficients[:n].copy()
        c[-1] *= ((end - self.t[n - 1]) / (self.t[n] - self.t[n - 1])) ** np.arange(c.shape[2])
        before = self.switch_times < end
        passed = self.switch_modes[before]
        mode = passed[-1, 1] if len(passed) else self.switch_modes[0, 0] if len(before) else self.end_mode
        cut = {"t": np.append(self.t[:n], end), "mode": self.mode[:n], "coefficients": c, "end": c[-1].sum(axis=-1), "end_mode": mode}
        return replace(self, **cut, switch_times=self.switch_times[before], switch_modes=passed)


def polynomials(coefficients: Array, theta: Array) -> Array:
    """Values (pieces, states) of polynomials (pieces, states, powers) at one point of each piece."""
    value: Array = polyval(theta[:, None], np.moveaxis(coefficients, -1, 0), tensor=False)
    return value


def extremes(coefficients: Array, states: Array) -> tuple[Array, Array]:
    """The smallest and the largest value of each state over all pieces, including interior extremes, and over some additional states.

    Examples
    --------
    >>> low, high = extremes(np.array([[[0.0, 1.0, -1.0]]]), np.zeros((1, 1)))  # t - t^2
    >>> float(low[0]), float(high[0])
    (0.0, 0.25)
    """
    powers, looks = np.arange(coefficients.shape[2]), np.linspace(0.0, 1.0, _LOOKS)
    slope = coefficients[..., 1:] * powers[1:]
    curve = slope[..., 1:] * powers[1:-1]
    rates = slope @ looks[None, :] ** powers[:-1, None]
    rises = rates > 0.0
    piece, state, k = np.nonzero(rises[..., :-1] != rises[..., 1:])  # an extremum between two samples
    before, after = rates[piece, state, k], rates[piece, state, k + 1]
    theta = looks[k] + before / (before - after) / (_LOOKS - 1)
    own, slope, curve = (c[piece, state] for c in (coefficients, slope, curve))
    for _ in range(4):
        power = theta[:, None] ** powers
        d, dd = (slope * power[:, :-1]).sum(axis=1), (curve * power[:, :-2]).sum(axis=1)
        theta = np.clip(theta - d / np.where(dd == 0.0, np.inf, dd), looks[k], looks[k + 1])
    turns = (own * theta[:, None] ** powers).sum(axis=1)
    ends = np.concatenate([coefficients[..., 0], coefficients.sum(axis=-1), states])
    low, high = ends.min(axis=0), ends.max(axis=0)
    np.minimum.at(low, state, turns)
    np.maximum.at(high, state, turns)
    return low, high
