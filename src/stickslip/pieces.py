"""Dense output: the pieces of which a trajectory is made, as arrays that can be evaluated anywhere and kept in a file."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any, Protocol

import numpy as np

from stickslip.sealing import sealed

__all__ = [
    "Event", "HarmonicArcs", "Pieces", "PolynomialPieces", "events_of", "inner_rates", "nodes_at",
    "pieces_from_arrays",
]  # fmt: skip

STUCK = 0  # the mode of a body at rest; else it is the sign of its velocity

Array = Any  # numpy.ndarray


@dataclass(frozen=True)
class Event:
    """An instant at which something changed at once: mostly the mode of the body.

    Parameters
    ----------
    t : float
        When [s].
    kind : {"stick", "slip", "reversal", "impulse", "switch", "contact lost"}
        It came to rest, it broke away, or its velocity changed sign without rest; a jump of the drive's velocity threw it;
        a memory of its law changed; its load fell to zero.
    before, after : int
        The modes: +1 forwards, 0 stuck, -1 backwards.
    """

    t: float
    kind: str
    before: int
    after: int


def events_of(pieces: Any, impulses: Any = (), lost: bool = False) -> list[Event]:
    """Every event, in order; `impulses` are the times of the impulses, `lost` says that the contact was lost at the end."""
    mode = np.asarray(pieces.mode).astype(int)
    thrown = set(nodes_at(pieces, impulses).tolist())
    changed = np.diff(mode) != 0
    memory = getattr(pieces, "memory", None)
    if memory is not None and memory.shape[1]:
        changed |= np.any(np.diff(memory, axis=0) != 0, axis=1)
    where = sorted({*(np.flatnonzero(changed) + 1).tolist(), *thrown})
    found = [Event(float(pieces.t[i]), _kind(mode[i - 1], mode[i], i in thrown), int(mode[i - 1]), int(mode[i])) for i in where]
    return [*found, Event(float(pieces.t[-1]), "contact lost", int(mode[-1]), int(mode[-1]))] if lost else found


def _kind(before: int, after: int, thrown: bool) -> str:
    if thrown:
        return "impulse"
    return "switch" if before == after else "stick" if after == 0 else "slip" if before == 0 else "reversal"


def nodes_at(pieces: Any, times: Any) -> Array:
    """Numbers of the inner nodes that lie at given times, to rounding."""
    inner, times = pieces.t[1:-1], np.asarray(times, float)
    if not len(times) or not len(inner):
        return np.empty(0, int)
    right = np.searchsorted(inner, times)
    both = np.clip(np.stack([right - 1, right]), 0, len(inner) - 1)
    near = np.where(abs(inner[both[0]] - times) <= abs(inner[both[1]] - times), *both)
    return np.unique(near[abs(inner[near] - times) <= 1e-12 * float(pieces.t[-1] - pieces.t[0])]) + 1


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

    def until(self, end: float) -> Any:
        """The same pieces up to a time."""


class _Arrays:
    """Pieces whose fields are the arrays that are kept."""

    def arrays(self) -> dict[str, Array]:
        """All that is needed to make these pieces again, by name; what is empty is left out."""
        found = {f.name: np.asarray(getattr(self, f.name)) for f in fields(self)}  # type: ignore[arg-type]
        return {name: array + 0.0 if array.dtype == bool else array for name, array in found.items() if array.size}

    @classmethod
    def from_arrays(cls, arrays: dict[str, Array]) -> Any:
        """The pieces that `arrays` came from."""
        kept = [f.name for f in fields(cls) if f.name in arrays]  # type: ignore[arg-type]
        return cls(**{name: arrays[name] if np.ndim(arrays[name]) else float(arrays[name]) for name in kept})


@sealed
@dataclass(frozen=True, eq=False)
class PolynomialPieces(_Arrays):
    r"""Polynomials on each step, what an integrator gives.

    With :math:`\theta = (t - t_i)/h_i`, the states :math:`y = (v, z_1, \dots)` are :math:`\sum_k c_k \theta^k`,
    and the position is the integral of the velocity; where the equations know the position, it is the last state.

    Parameters
    ----------
    t : array (n + 1,)
        Ends of the steps [s].
    mode : array (n,) of int8
        Sign of the contact's velocity on each step; 0 stuck (set-valued laws).
    x0 : array (n,)
        Position at the start of each step [m].
    coefficients : array (n, states, degree + 1)
        The numbers c, lowest power first.
    memory : array (n, modes) of int
        Whole-number memories of the law on each step.
    holds_x : bool
        Whether the last state is the position, instead of the integral of the velocity from `x0`.

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
    memory: Array = None
    holds_x: bool = False

    def __post_init__(self) -> None:
        if self.memory is None:
            object.__setattr__(self, "memory", np.empty((len(self.mode), 0), np.int32))
        object.__setattr__(self, "holds_x", bool(self.holds_x))

    def evaluate(self, t: Array, index: Array) -> tuple[Array, Array, Array]:
        """Position, velocity and inner states at times on the given pieces."""
        start = self.t[index]
        h = self.t[index + 1] - start
        theta = (t - start) / h
        c = self.coefficients[index]
        y = _horner(np.moveaxis(c, 1, 0), theta)
        if self.holds_x:
            return y[-1], y[0], y[1:-1].T
        return self.x0[index] + h * theta * _horner(c[:, 0] / np.arange(1, c.shape[2] + 1), theta), y[0], y[1:].T

    def until(self, end: float) -> PolynomialPieces:
        """The same pieces up to a time, the last one cut there."""
        n = _count_until(self.t, end)
        c = self.coefficients[:n].copy()
        c[-1] *= ((end - self.t[n - 1]) / (self.t[n] - self.t[n - 1])) ** np.arange(c.shape[2])
        return replace(self, t=np.append(self.t[:n], end), mode=self.mode[:n], x0=self.x0[:n], coefficients=c, memory=self.memory[:n])


def _count_until(t: Array, end: float) -> int:
    """How many pieces begin before a time."""
    return max(int(np.searchsorted(t[:-1], end, side="left")), 1)


def inner_rates(pieces: Any, t: Array, index: Array) -> Array:
    """Rates of the inner states (len(t), states), as slopes of the dense output; none for closed arcs.

    Where the bristle is stiff, a law's own rate magnifies the last digits of z; the slope does not.
    """
    if not isinstance(pieces, PolynomialPieces):
        return np.empty((len(t), 0))
    start = pieces.t[index]
    h = pieces.t[index + 1] - start
    c = pieces.coefficients[index, 1 : -1 if pieces.holds_x else None]
    slopes = np.moveaxis(c[..., 1:] * np.arange(1, c.shape[2]), 1, 0)
    return (_horner(slopes, (t - start) / h) / h).T


def _horner(c: Array, theta: Array) -> Array:
    """Sum of c[..., k] theta^k."""
    value = c[..., -1].copy()
    for k in range(c.shape[-1] - 2, -1, -1):
        value = value * theta + c[..., k]
    return value


@sealed
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

    def until(self, end: float) -> HarmonicArcs:
        """The same arcs up to a time, the last one cut there."""
        n = _count_until(self.t, end)
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
