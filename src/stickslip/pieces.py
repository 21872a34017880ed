"""Dense output: the pieces of which a trajectory is made, as arrays that can be evaluated anywhere and kept in a file."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Protocol

import numpy as np

__all__ = ["BACKWARD", "FORWARD", "STUCK", "Event", "HarmonicArcs", "Pieces", "PolynomialPieces", "events_of", "pieces_from_arrays"]

FORWARD, STUCK, BACKWARD = 1, 0, -1

Array = Any  # numpy.ndarray


@dataclass(frozen=True)
class Event:
    """An instant at which the body changed its mode.

    Parameters
    ----------
    t : float
        When [s].
    kind : {"stick", "slip", "reversal"}
        It came to rest, it broke away, or its velocity changed sign without rest.
    before, after : int
        The modes: +1 forwards, 0 stuck, -1 backwards.
    """

    t: float
    kind: str
    before: int
    after: int


def _kind(before: int, after: int) -> str:
    return "stick" if after == 0 else "slip" if before == 0 else "reversal"


def events_of(pieces: Any) -> list[Event]:
    """Every change of mode, in order."""
    mode = np.asarray(pieces.mode)
    where = np.flatnonzero(np.diff(mode)) + 1
    return [Event(float(pieces.t[i]), _kind(mode[i - 1], mode[i]), int(mode[i - 1]), int(mode[i])) for i in where]


class Pieces(Protocol):
    """What a dense output offers. Piece i spans ``t[i]`` to ``t[i+1]`` and is smooth there.

    `mode` is +1 sliding forwards, 0 stuck, -1 sliding backwards; under a dynamic law it is the sign of v, never 0.
    """

    t: Array
    mode: Array

    def evaluate(self, t: Array, index: Array) -> tuple[Array, Array, Array]:
        """Position, velocity and inner states (len(t), states) at times that lie on the given pieces."""

    def arrays(self) -> dict[str, Array]:
        """All that is needed to make these pieces again."""


class _Arrays:
    """Pieces whose fields are the arrays that are kept."""

    def arrays(self) -> dict[str, Array]:
        """All that is needed to make these pieces again, by name."""
        return {f.name: np.asarray(getattr(self, f.name)) for f in fields(self)}  # type: ignore[arg-type]

    @classmethod
    def from_arrays(cls, arrays: dict[str, Array]) -> Any:
        """The pieces that `arrays` came from."""
        return cls(**{f.name: arrays[f.name] if np.ndim(arrays[f.name]) else float(arrays[f.name]) for f in fields(cls)})  # type: ignore[arg-type]


@dataclass(frozen=True, eq=False)
class PolynomialPieces(_Arrays):
    r"""Polynomials on each step, what an integrator gives for a dynamic law.

    With :math:`\theta = (t - t_i)/h_i`, the states :math:`y = (v, z_1, \dots)` are :math:`\sum_k c_k \theta^k`,
    and the position is the integral of the velocity.

    Parameters
    ----------
    t : array (n + 1,)
        Ends of the steps [s].
    mode : array (n,) of int8
        Sign of v on each step.
    x0 : array (n,)
        Position at the start of each step [m].
    coefficients : array (n, states + 1, degree + 1)
        The numbers c, lowest power first.

    Examples
    --------
    >>> fall = PolynomialPieces(t=np.array([0.0, 2.0]), mode=np.array([1]), x0=np.zeros(1), coefficients=np.array([[[0.0, 20.0]]]))
    >>> x, v, z = fall.evaluate(np.array([1.0]), np.array([0]))
    >>> float(x[0]), float(v[0]), z.shape
    (5.0, 10.0, (1, 0))
    """

    t: Array
    mode: Array
    x0: Array
    coefficients: Array

    def evaluate(self, t: Array, index: Array) -> tuple[Array, Array, Array]:
        """Position, velocity and inner states at times on the given pieces."""
        start = self.t[index]
        h = self.t[index + 1] - start
        theta = (t - start) / h
        c = self.coefficients[index]
        powers = np.arange(1, c.shape[2] + 1)
        return self.x0[index] + h * theta * _horner(c[:, 0] / powers, theta), *_split(_horner(np.moveaxis(c, 1, 0), theta))


def inner_rates(pieces: Any, t: Array, index: Array) -> Array:
    """Rates of the inner states (len(t), states), as slopes of the dense output; none for closed arcs.

    Where the bristle is stiff, a law's own rate magnifies the last digits of z; the slope does not.
    """
    if not isinstance(pieces, PolynomialPieces):
        return np.empty((len(t), 0))
    start = pieces.t[index]
    h = pieces.t[index + 1] - start
    c = pieces.coefficients[index, 1:]
    slopes = np.moveaxis(c[..., 1:] * np.arange(1, c.shape[2]), 1, 0)
    return (_horner(slopes, (t - start) / h) / h).T


def _horner(c: Array, theta: Array) -> Array:
    """Sum of c[..., k] theta^k."""
    value = c[..., -1].copy()
    for k in range(c.shape[-1] - 2, -1, -1):
        value = value * theta + c[..., k]
    return value


def _split(y: Array) -> tuple[Array, Array]:
    return y[0], y[1:].T


@dataclass(frozen=True, eq=False)
class HarmonicArcs(_Arrays):
    r"""Closed arcs of a body with Coulomb friction under a harmonic drive: exact, no interpolation.

    While it slides, :math:`\dot v = a\sin\omega t - r` with r = `resist_plus` forwards and -`resist_minus` backwards; while stuck v = 0.

    Parameters
    ----------
    t : array (n + 1,)
        Ends of the arcs [s].
    mode : array (n,) of int8
        +1 sliding forwards, 0 stuck, -1 sliding backwards.
    x0, v0 : array (n,)
        Position [m] and velocity [m/s] at the start of each arc.
    drive_acceleration : float
        a, the amplitude of the acceleration that the drive gives to a free body [m/s^2].
    omega : float
        Angular frequency of the drive [rad/s].
    resist_plus, resist_minus : float
        What friction (less gravity along the track) takes from it forwards, and backwards [m/s^2].

    Examples
    --------
    >>> free = HarmonicArcs(np.array([0.0, 3.0]), np.array([1]), np.zeros(1), np.zeros(1), 1.0, 1.0, 0.0, 0.0)
    >>> x, v, z = free.evaluate(np.array([1.0]), np.array([0]))
    >>> bool(abs(v[0] - (1 - np.cos(1.0))) < 1e-15), bool(abs(x[0] - (1 - np.sin(1.0))) < 1e-15)
    (True, True)
    """

    t: Array
    mode: Array
    x0: Array
    v0: Array
    drive_acceleration: float
    omega: float
    resist_plus: float
    resist_minus: float

    def evaluate(self, t: Array, index: Array) -> tuple[Array, Array, Array]:
        """Position, velocity and no inner states at times on the given arcs.

        Differences of sines are written as products, and the phase is reduced at the start of each arc,
        so the error is that of a few roundings however long the run is.
        """
        d = t - self.t[index]
        side, v0 = self.mode[index], self.v0[index]
        phase, half = self._phase[index], 0.5 * self.omega * d
        amplitude = self.drive_acceleration / self.omega
        r = np.where(side > 0, self.resist_plus, -self.resist_minus)
        v = v0 + 2 * amplitude * np.sin(phase + half) * np.sin(half) - r * d
        swing = d * np.cos(phase) - (2 / self.omega) * np.cos(phase + half) * np.sin(half)
        x = v0 * d + amplitude * swing - 0.5 * r * d * d
        stuck = side == STUCK
        return self.x0[index] + np.where(stuck, 0.0, x), np.where(stuck, 0.0, v), np.empty((len(d), 0))

    @property
    def _phase(self) -> Array:
        """Drive phase at the start of each arc, in (-pi, pi], with the rounding of omega t added back."""
        start = self.t[:-1]
        product = self.omega * start
        lost = _product_error(np.full_like(start, self.omega), start, product)
        s, c = np.sin(product), np.cos(product)
        return np.arctan2(s + lost * c, c - lost * s)


def _product_error(a: Array, b: Array, product: Array) -> Array:
    """What the rounded product a b lacks (Dekker 1971)."""
    ah, al = _halves(a)
    bh, bl = _halves(b)
    return ((ah * bh - product) + ah * bl + al * bh) + al * bl


def _halves(a: Array) -> tuple[Array, Array]:
    big = 134217729.0 * a
    high = big - (big - a)
    return high, a - high


KINDS: dict[str, Any] = {"polynomial": PolynomialPieces, "harmonic": HarmonicArcs}


def kind_of(pieces: Any) -> str:
    """The name under which a file keeps these pieces."""
    return next(name for name, cls in KINDS.items() if type(pieces) is cls)


def pieces_from_arrays(kind: str, arrays: dict[str, Array]) -> Any:
    """Pieces of a kind from their arrays."""
    return KINDS[kind].from_arrays(arrays)
