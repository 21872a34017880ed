"""Dense output: the pieces of a trajectory as arrays that can be evaluated at any time and stored in a file."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.frozen_arrays import sealed
from stickslip.models.state_layout import StateLayout
from stickslip.results.flow_pieces import FlowPieces
from stickslip.results.local_pieces import LocalPieces
from stickslip.results.pieces import DensePieces, count_until, flaws_of

_ONE = StateLayout.of_one()
STUCK = 0  # the mode of a body at rest; else it is the sign of its velocity


def _columns(array: Array) -> Array:
    """An array with a row for each piece; with one contact or one way the second axis may be missing."""
    array = np.asarray(array)
    return array[:, None] if array.ndim == 1 else array


@sealed
@dataclass(frozen=True, eq=False)
class PolynomialPieces(DensePieces):
    r"""A polynomial for each state on each step, as an integrator returns them.

    With :math:`\theta = (t - t_i)/h_i`, every state of the bodies and contacts is :math:`\sum_k c_k \theta^k`. A way is the integral of
    the velocity of its reference body.

    Parameters
    ----------
    t : array (n + 1,)
        Ends of the steps [s].
    mode : array (n, contacts) of int8
        Sign of each contact's velocity on each step; 0 stuck (set-valued laws). With one contact the axis may be left out.
    x0 : array (n, ways)
        Each way at the start of each step [m]. With one way the axis may be left out.
    coefficients : array (n, states, degree + 1)
        The coefficients c, lowest power first.
    memory : array (n, memories) of int
        Whole-number memories of the laws on each step.
    layout : StateLayout, optional
        Description of the states; by default one body's velocity and the inner states of its contact.

    Examples
    --------
    >>> fall = PolynomialPieces(t=np.array([0.0, 2.0]), mode=np.array([1]), x0=np.zeros(1), coefficients=np.array([[[0.0, 20.0]]]))
    >>> x, v, z = fall.evaluate(np.array([1.0]), np.array([0]))
    >>> x.tolist(), v.tolist(), z.shape
    ([[5.0]], [[10.0]], (1, 1, 0))
    """

    t: Array
    mode: Array
    x0: Array
    coefficients: Array
    memory: Array = None  # type: ignore[assignment]
    layout: StateLayout = None  # type: ignore[assignment]

    def __post_init__(self) -> None:
        count, states = len(self.t) - 1, np.shape(self.coefficients)[1]
        given: dict[str, Any] = {
            "mode": _columns(self.mode),
            "x0": _columns(self.x0),
            "memory": np.empty((count, 0), np.int32) if self.memory is None else self.memory,
        }
        given["layout"] = self.layout or StateLayout.of_one(states - 1, given["memory"].shape[1])
        for name, value in given.items():
            object.__setattr__(self, name, value)
        if flaws := flaws_of(self.layout, states, self.x0.shape[1], self.memory.shape[1], self.mode.shape[1]):
            raise InputError("PolynomialPieces", flaws)

    @classmethod
    def from_arrays(cls, arrays: dict[str, Any]) -> PolynomialPieces:
        """The pieces that `arrays` came from."""
        count = len(arrays["t"]) - 1
        pieces: PolynomialPieces = super().from_arrays({"mode": np.empty((count, 0), np.int8), "x0": np.empty((count, 0)), **arrays})
        return pieces

    def evaluate(self, t: Array, index: Array) -> tuple[Array, Array, Array]:
        """x, v (time, body) and z (time, contact, state), NaN where a law has fewer, at times on the given pieces."""
        theta, h = self._within(t, index)
        c, at = _few(self.coefficients, index)
        y = _horner(np.moveaxis(c, 0, 1), at, theta)
        powers, along = np.arange(1, c.shape[2] + 1), h * theta
        ways = [self.x0[index, k] + along * _horner(c[:, state] / powers, at, theta) for k, state in enumerate(self.layout.ways)]
        x = [_position(body, ways, y) for body in self.layout.bodies]
        v = [y[body.velocity] for body in self.layout.bodies]
        return _rows(x, len(theta)), _rows(v, len(theta)), self._of_contacts(y)

    def inner_rates(self, t: Array, index: Array) -> Array:
        """Rates of the inner states (time, contact, state), as slopes of the polynomials."""
        theta, h = self._within(t, index)
        c, at = _few(self.coefficients, index)
        slopes = c[..., 1:] * np.arange(1, c.shape[2])
        return self._of_contacts(_horner(np.moveaxis(slopes, 0, 1), at, theta) / h)

    def _within(self, t: Array, index: Array) -> tuple[Array, Array]:
        """The relative position of each time in its piece, from 0 to 1, and the length of the piece."""
        start = self.t[index]
        h = self.t[index + 1] - start
        return (t - start) / h, h

    def _of_contacts(self, y: Array) -> Array:
        """The inner states (time, contact, state) among all states (state, time), NaN where a law has fewer than another.

        Those of controllers follow those of the contacts.
        """
        parts = self.layout.with_inner
        if not self.layout.most_inner:
            return np.empty((y.shape[1], len(parts), 0))
        z = np.full((len(parts), self.layout.most_inner, y.shape[1]), np.nan)
        for i, contact in enumerate(parts):
            z[i, : len(contact.inner)] = y[list(contact.inner)]
        return np.moveaxis(z, 2, 0)

    def until(self, end: float) -> PolynomialPieces:
        """The same pieces up to a time, the last one cut there."""
        n = count_until(self.t, end)
        c = self.coefficients[:n].copy()
        c[-1] *= ((end - self.t[n - 1]) / (self.t[n] - self.t[n - 1])) ** np.arange(c.shape[2])
        return replace(self, t=np.append(self.t[:n], end), mode=self.mode[:n], x0=self.x0[:n], coefficients=c, memory=self.memory[:n])


def _position(body: Any, ways: list[Array], y: Array) -> Array:
    """Position of a body from its way and its state."""
    if body.way is None:
        return y[body.position]
    along = ways[body.way] if body.factor == 1.0 else body.factor * ways[body.way]
    return along if body.position is None else along + y[body.position]


def _rows(rows: list[Array], count: int) -> Array:
    """Rows as the columns of one array; each column stays contiguous."""
    return np.array(rows).reshape(len(rows), count).T


def inner_rates(pieces: Any, t: Array, index: Array) -> Array:
    """Rates of the inner states (time, contact, state), as slopes of the dense output.

    With stiff bristles, a law's own rate amplifies the rounding errors of z; the slope does not.
    """
    inner = pieces.layout.most_inner
    return pieces.inner_rates(t, index) if inner else np.empty((len(t), len(pieces.layout.with_inner), 0))


def _few(c: Array, index: Array) -> tuple[Array, Array]:
    """The coefficients of the pieces that are asked for, and each time's place among them: few times need few pieces of a long run."""
    return (c.take(index, axis=0), np.arange(len(index))) if len(index) < len(c) else (c, index)


def _horner(c: Array, index: Array, theta: Array) -> Array:
    """Sum of c[..., index, k] theta^k."""
    by_power = np.moveaxis(c, -1, 0)
    if len(index) > c.shape[-2]:  # each piece at many times
        by_power = np.ascontiguousarray(by_power)
    value = by_power[-1].take(index, axis=-1)
    for of_power in by_power[-2::-1]:
        value *= theta
        value += of_power.take(index, axis=-1)
    return value


@sealed
@dataclass(frozen=True, eq=False)
class HarmonicArcs(DensePieces):
    r"""Closed arcs of a body with Coulomb friction under a harmonic drive: exact, no interpolation.

    While it slides, :math:`\dot v = a\sin\omega t - r` with r = `resist_plus` forwards and -`resist_minus` backwards; while stuck v = 0.

    Parameters
    ----------
    t : array (n + 1,)
        Ends of the arcs [s].
    mode : array (n, 1) of int8
        +1 sliding forwards, 0 stuck, -1 sliding backwards. The axis of the only contact may be left out.
    x0, v0 : array (n,)
        Position [m] and velocity [m/s] at the start of each arc.
    drive_acceleration : float
        a, the amplitude of the acceleration that the drive gives to a free body [m/s^2].
    omega : float
        Angular frequency of the drive [rad/s].
    resist_plus, resist_minus : float
        Deceleration by friction (less gravity along the track) when sliding forwards, and backwards [m/s^2].
    layout : StateLayout, optional
        The names of the body and the contact.

    Examples
    --------
    >>> free = HarmonicArcs(np.array([0.0, 3.0]), np.array([1]), np.zeros(1), np.zeros(1), 1.0, 1.0, 0.0, 0.0)
    >>> x, v, z = free.evaluate(np.array([1.0]), np.array([0]))
    >>> x.shape, bool(abs(v[0, 0] - (1 - np.cos(1.0))) < 1e-15), bool(abs(x[0, 0] - (1 - np.sin(1.0))) < 1e-15)
    ((1, 1), True, True)
    """

    t: Array
    mode: Array
    x0: Array
    v0: Array
    drive_acceleration: float
    omega: float
    resist_plus: float
    resist_minus: float
    layout: StateLayout = field(default=_ONE, kw_only=True)

    def __post_init__(self) -> None:
        object.__setattr__(self, "mode", _columns(self.mode))
        flaws = flaws_of(self.layout, 1, 1, 0, self.mode.shape[1])
        if flaws or not self.layout.is_one:
            raise InputError("HarmonicArcs", flaws or [f"a layout of {self.layout.description}; allowed is one body on one contact"])

    @property
    def memory(self) -> Array:
        """Coulomb friction has no memory: (n, 0)."""
        return np.empty((len(self.mode), 0), np.int32)

    def evaluate(self, t: Array, index: Array) -> tuple[Array, Array, Array]:
        """x, v (time, 1) and no inner states (time, 1, 0) at times on the given arcs.

        Differences of sines are written as products, and the phase is reduced at the start of each arc,
        so the error is that of a few rounding errors however long the run is.
        """
        d = t - self.t[index]
        side, v0 = self.mode[index, 0], self.v0[index]
        phase, half = self._phase[index], 0.5 * self.omega * d
        amplitude = self.drive_acceleration / self.omega
        r = np.where(side > 0, self.resist_plus, -self.resist_minus)
        v = v0 + 2 * amplitude * np.sin(phase + half) * np.sin(half) - r * d
        swing = d * np.cos(phase) - (2 / self.omega) * np.cos(phase + half) * np.sin(half)
        x = v0 * d + amplitude * swing - 0.5 * r * d * d
        stuck = side == STUCK
        x, v = self.x0[index] + np.where(stuck, 0.0, x), np.where(stuck, 0.0, v)
        return x[:, None], v[:, None], np.empty((len(d), 1, 0))

    def until(self, end: float) -> HarmonicArcs:
        """The same arcs up to a time, the last one cut there."""
        n = count_until(self.t, end)
        return replace(self, t=np.append(self.t[:n], end), mode=self.mode[:n], x0=self.x0[:n], v0=self.v0[:n])

    @property
    def _phase(self) -> Array:
        """Drive phase at the start of each arc, in (-pi, pi], with the rounding of omega t added back."""
        start = self.t[:-1]
        product = self.omega * start
        lost = _product_error(np.full_like(start, self.omega), start, product)
        s, c = np.sin(product), np.cos(product)
        return np.arctan2(s + lost * c, c - lost * s)


def _product_error(a: Array, b: Array, product: Array) -> Array:
    """The rounding error of the product a b (Dekker 1971)."""
    ah, al = _halves(a)
    bh, bl = _halves(b)
    return ((ah * bh - product) + ah * bl + al * bh) + al * bl


def _halves(a: Array) -> tuple[Array, Array]:
    big = 134217729.0 * a
    high = big - (big - a)
    return high, a - high


KINDS: dict[str, Any] = {"polynomial": PolynomialPieces, "harmonic": HarmonicArcs, "local": LocalPieces, "flow": FlowPieces}


def kind_of_pieces(pieces: DensePieces) -> str:
    """The name of the kind of these pieces in a file."""
    return next(name for name, cls in KINDS.items() if type(pieces) is cls)


def pieces_from_arrays(kind: str, arrays: dict[str, Array]) -> Any:
    """Pieces of a kind from their arrays."""
    return KINDS[kind].from_arrays(arrays)
