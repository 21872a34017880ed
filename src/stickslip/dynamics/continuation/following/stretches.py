"""The stretch of a branch between two of its points: a point so far along it, also where the branch turns sharply in between.

The points of a stretch lie in planes across one direction. Where the branch hardly turns, that is the one at its first point.
Where it turns back within less than a step, as where a slip just touches zero and a multiplier rises by a root, no plane across one of
the two directions meets all of it; planes across their sum do, as the branch turns from one to the other.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.dynamics.continuation.following.pseudo_arclength import Path, Point

_TURNS = 0.5  # cosine of two directions below which a branch turns sharply between its points


@dataclass(frozen=True, eq=False)
class Stretch:
    """A branch from one of its points to the next.

    Parameters
    ----------
    path : Path
    a, b : Point
    """

    path: Path
    a: Point
    b: Point

    @property
    def turns(self) -> bool:
        """Whether the branch turns sharply."""
        return bool(self.a.tangent @ self.b.tangent < _TURNS)

    @cached_property
    def along(self) -> Array:
        """The direction across which the planes are."""
        if not self.turns:
            return self.a.tangent
        both = self.a.tangent + self.b.tangent
        return np.asarray(both / np.linalg.norm(both))

    @cached_property
    def length(self) -> float:
        """How far the second point is, along that direction."""
        return float((self.b.u - self.a.u) @ self.along)

    @cached_property
    def _before(self) -> float:
        """How far from the first point the two straight lines through the points come nearest to one another; along the direction."""
        lines = np.column_stack([self.a.tangent, self.b.tangent])
        before, behind = np.linalg.lstsq(lines, self.b.u - self.a.u, rcond=None)[0]
        return float(before * (self.a.tangent @ self.along)) if before > 0.0 and behind > 0.0 else np.nan

    def guess(self, s: float) -> Array:
        """About where the branch is."""
        if not self.turns:
            return self.a.u + s * self.a.tangent
        if not 0.0 < self._before < self.length:
            return self.a.u + s / self.length * (self.b.u - self.a.u)
        if s < self._before:
            return self.a.u + s / float(self.a.tangent @ self.along) * self.a.tangent
        return self.b.u - (self.length - s) / float(self.b.tangent @ self.along) * self.b.tangent

    def at(self, s: float, path: Path | None = None) -> Point | None:
        """The point that lies so far along it, if it is found; of the same branch with other tolerances, if its path is given."""
        if path is not None:
            return self._corrected(s, path)
        if s not in self._asked:  # several searches halve the same stretch
            self._asked[s] = self._corrected(s, self.path)
        return self._asked[s]

    @cached_property
    def _asked(self) -> dict[float, Point | None]:
        """Its points so far, by how far along they lie."""
        return {}

    def _corrected(self, s: float, path: Path) -> Point | None:
        root = path.corrected(self.guess(s), self.along, path.remembered(self.a.orbit))
        return path.point(root, self.along) if root.good else None
