"""Rows that rest together: the forces that hold them, and how much is left until they do not."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from stickslip.solvers.plain.deciding import is_common, most_slack, shared_forces

_SINGULAR = 1e12

Bounds = list[tuple[float, float]]


class RestingGroup(Protocol):
    """Resting rows that push one another; their forces are known from beta, the rates that they would have without them."""

    rows: list[int]

    def hold(self, beta: Sequence[float], limits: Callable[[], Bounds]) -> Sequence[float]:
        """Forces that keep the rows at rest [N]."""
        return self.project(beta)

    def project(self, w: Sequence[float]) -> Sequence[float]:
        """Impulses that take off what rounding left of the slips [N s]."""

    def broken(self, row: int, side: int) -> dict[int, int]:
        """Rows that leave with the one whose margin is gone, and which way."""
        return {row: side}

    def margins(self, R: Sequence[float], limits: Bounds) -> list[tuple[int | None, int, float, float]]:
        """The margins: (row that breaks away, or None; side; margin; its rounding error)."""
        margins: list[tuple[int | None, int, float, float]] = []
        for i, force in zip(self.rows, R, strict=True):
            low, high = limits[i]
            noise = max((abs(v) for v in (low, high, force) if math.isfinite(v)), default=0.0)
            margins += [(i, side, left, noise) for side, left in ((1, high - force), (-1, force - low)) if math.isfinite(left)]
        return margins


@dataclass(frozen=True)
class _Single(RestingGroup):
    rows: list[int]
    mass: float

    def project(self, w: Sequence[float]) -> Sequence[float]:
        return [self.mass * w[0]]


@dataclass(frozen=True)
class _Common(RestingGroup):
    """Rows on one coordinate: only the sum of their forces is known, which is shared by a convention."""

    rows: list[int]
    mass: float
    sign: list[float]

    def hold(self, beta: Sequence[float], limits: Callable[[], Bounds]) -> Sequence[float]:
        return [s * share for s, share in zip(self.sign, shared_forces(self.mass * beta[0], *self._turned(limits())), strict=True)]

    def project(self, w: Sequence[float]) -> Sequence[float]:
        return [self.mass * w[0], *(0.0 for _ in w[1:])]

    def broken(self, row: int, side: int) -> dict[int, int]:
        return {i: int(s) * side for i, s in zip(self.rows, self.sign, strict=True)}

    def _turned(self, limits: Bounds) -> tuple[list[float], list[float]]:
        turned = [limits[i] if s > 0 else (-limits[i][1], -limits[i][0]) for i, s in zip(self.rows, self.sign, strict=True)]
        return [low for low, _ in turned], [high for _, high in turned]

    def margins(self, R: Sequence[float], limits: Bounds) -> list[tuple[int | None, int, float, float]]:
        low, high = (sum(bounds) for bounds in self._turned(limits))
        total = sum(s * force for s, force in zip(self.sign, R, strict=True))
        noise = max((abs(v) for v in (low, high, total) if math.isfinite(v)), default=0.0)
        return [(self.rows[0], side, left, noise) for side, left in ((1, high - total), (-1, total - low)) if math.isfinite(left)]


@dataclass(frozen=True)
class _Box(RestingGroup):
    rows: list[int]
    inverse: Any

    def project(self, w: Sequence[float]) -> Sequence[float]:
        return (self.inverse @ np.asarray(w)).tolist()


@dataclass(frozen=True)
class _Dependent(_Box):
    """Rows of which some follow from others: their forces are not unique, and the smallest will do, for all give the same motion."""

    G: Any

    def margins(self, R: Sequence[float], limits: Bounds) -> list[tuple[int | None, int, float, float]]:
        low, high = (np.array([limits[i][n] for i in self.rows]) for n in (0, 1))
        solution, margin = most_slack(self.G, self.G @ np.asarray(R), low, high)
        return [(None, 0, -1.0 if solution is None else margin, 1.0)]


def group_of(rows: list[int], G: Any, effective: list[float]) -> RestingGroup:
    """The group of rows that rest together, by the size and rank of their part of G."""
    part = np.array([[G[i][j] for j in rows] for i in rows])
    if len(rows) == 1:
        return _Single(rows, effective[rows[0]])
    if is_common(part) and len({effective[i] for i in rows}) == 1:
        return _Common(rows, effective[rows[0]], np.sign(part[0]).tolist())
    if np.linalg.cond(part) < _SINGULAR:
        return _Box(rows, np.linalg.inv(part))
    return _Dependent(rows, np.linalg.pinv(part, rcond=1 / _SINGULAR, hermitian=True), part)
