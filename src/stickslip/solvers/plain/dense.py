"""scipy's interpolants as polynomials of the same degree in theta, and the parts of a run joined."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.layout import StateLayout
from stickslip.pieces import PolynomialPieces
from stickslip.solvers.plain.equations import Memory

__all__ = ["Part", "joined", "part_of", "resting"]


@dataclass
class Part:
    """One piece of dense output: where it begins, and the polynomials of v, z and (if the equations know it) x."""

    t: float
    x: float
    coefficients: Any  # (states, degree + 1)
    mode: int
    memory: Memory

    def end_at_rest(self, v: float) -> None:
        """The zero of the contact's velocity was found to rounding only: take that rounding off."""
        self.coefficients[0, -1] += v - self.coefficients[0].sum()


def resting(t: float, end: float, y: Any, v: float, cyclic: bool) -> Part:
    """A body stuck on its contact, which moves with velocity v."""
    states = np.array([[v, 0.0]] if cyclic else [[v, 0.0], [float(y[0]), v * (end - t)]])
    return Part(t, float(y[0]), states, 0, ())


def part_of(dense: Any, start: float, end: float, before: Any, after: Any, mode: int, memory: Memory, cyclic: bool) -> Part:
    """A step, or the beginning of one up to `end`, as polynomials; its ends are the integrator's own states."""
    degree = _degree(dense)
    theta = 0.5 - 0.5 * np.cos(np.pi * np.arange(degree + 1) / degree)
    values = np.linalg.solve(theta[:, None] ** np.arange(degree + 1), dense(start + (end - start) * theta).T).T
    values[:, 0] = before
    values[:, -1] += after - values.sum(axis=1)
    return Part(start, float(before[0]), values[1:] if cyclic else np.concatenate([values[1:], values[:1]]), mode, memory)


def _degree(piece: Any) -> int:
    """Degree of an interpolant of scipy's: Radau's is cubic, DOP853's of degree 7, the multistep methods say their order."""
    order = getattr(piece, "order", None)
    if order is None:
        order = (
            len(piece.p) - 1
            if hasattr(piece, "p") and np.ndim(piece.p)
            else {"RadauDenseOutput": 3, "Dop853DenseOutput": 7}.get(type(piece).__name__, 7)
        )
    return max(int(order), 1)


def joined(parts: list[Part], end: float, cyclic: bool) -> PolynomialPieces:
    """All parts as one dense output."""
    width = max(part.coefficients.shape[1] for part in parts)
    states, memories = max(len(part.coefficients) for part in parts), max(len(part.memory) for part in parts)
    times = np.append([part.t for part in parts], max(parts[-1].t, end))
    good = np.diff(times) > 0
    c = np.stack([np.pad(p.coefficients, ((0, states - len(p.coefficients)), (0, width - p.coefficients.shape[1]))) for p in parts])
    memory = np.array([part.memory or (0,) * memories for part in parts], np.int32).reshape(len(parts), memories)
    x0 = np.array([[p.x] if cyclic else [] for p in parts])
    return PolynomialPieces(
        t=np.append(times[:-1][good], times[-1]), mode=np.array([[p.mode] for p in parts], np.int8)[good],
        x0=x0[good], coefficients=c[good], memory=memory[good], layout=StateLayout.of_one(states - 1 - (not cyclic), memories, not cyclic),
    )  # fmt: skip
