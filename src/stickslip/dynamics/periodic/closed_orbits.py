"""Common parts of periodic orbits and limit cycles: a motion that returns to its state, and the growth of disturbances."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.notebook_display import Drawn
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates
from stickslip.models.machine_adapter import machine_of
from stickslip.results.verbs import OfOneRun

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


NEUTRAL = 1e-8  # how far from 1 a multiplier of 1 may be computed


class Repeating(Drawn, OfOneRun):
    """A periodic motion, with its stability from its multipliers."""

    multipliers: Any  # array: a field of orbits of flows, a property of those of machines
    strobe_state: Any

    _drawn_by = "phase"

    @property
    @abstractmethod
    def run(self) -> Any:
        """One period of the orbit, with its dense output."""

    def _drawn(self) -> Any:
        return self.run

    @property
    @abstractmethod
    def words(self) -> Mapping[str, Any]:
        """What it is in words, by the name of a column: one word, or one for each contact by its name."""

    @property
    def section_state(self) -> Array:
        """The state by which it is followed."""
        return np.asarray(self.strobe_state)

    @property
    def stable(self) -> bool:
        """Whether small disturbances die out: all multipliers within the unit circle."""
        return self.stability == "stable"

    @property
    def stability(self) -> str:
        """The stability in words, from the multipliers."""
        return stability_of(self.multipliers)

    @property
    def _multipliers_text(self) -> str:
        return "multipliers " + ", ".join(f"{m:.6g}" for m in self.multipliers)


class ClosedMotion(Repeating):
    """A motion of a model that returns to its initial state."""

    model: Any
    state: Array

    @property
    @abstractmethod
    def multipliers(self) -> Array:
        """Floquet multipliers, the largest first."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the numbers of the state."""
        return coordinates(self.model).names

    @cached_property
    def patterns(self) -> dict[str, str]:
        """Signs of the slip within the motion period by contact, such as "+0-0"; a cycle's begin with rest if there is any."""
        modes = np.asarray(self.run.pieces.mode)
        return {name: min(_turned(modes[:, i]), key=self._begins) for i, name in enumerate(self.run.contacts)}

    @abstractmethod
    def _begins(self, pattern: str) -> Any:
        """The smallest value along the part of the pattern that begins as it should."""

    @property
    @abstractmethod
    def type(self) -> str:
        """The type of the motion."""

    @property
    def words(self) -> Mapping[str, Any]:
        """The type; where the model names its contacts the pattern of each."""
        return {"patterns": self.patterns} if machine_of(self.model).names_parts else {"motion_type": self.type}

    @property
    def strobe_state(self) -> Array:
        """The state with all that is held beside it."""
        return self.state

    @property
    def start(self) -> dict[str, Any]:
        """The state as `solve` takes a start."""
        return coordinates(self.model).start(self.state)

    @property
    def events(self) -> list[Any]:
        """Every change of mode within the motion (dynamic laws: reversals of the contact's velocity)."""
        return self.run.events

    @property
    @abstractmethod
    def monodromy(self) -> Array:
        """The derivative of the state after the motion with respect to the state before it."""


def _turned(mode: Array) -> list[str]:
    """The signs of a closed motion in order, beginning with each of them."""
    signs = [{1: "+", 0: "0", -1: "-"}[int(m)] for m in mode]
    kept = [sign for k, sign in enumerate(signs) if sign != signs[k - 1]] or signs[:1]
    return ["".join(kept[k:] + kept[:k]) for k in range(len(kept))]


def stability_of(multipliers: Array) -> str:
    """Stability from multipliers: "stable", "neutral", "unstable" or "of unknown stability".

    Neutral are those with a multiplier on the unit circle, to rounding, and none beyond it; unknown are those that the map does not have.

    Examples
    --------
    >>> [stability_of(np.array(m)) for m in ([0.5], [1.0, 0.5], [-2.0, 0.5], [np.nan])]
    ['stable', 'neutral', 'unstable', 'of unknown stability']
    """
    sizes = abs(np.asarray(multipliers))
    if not np.isfinite(sizes).all():
        return "of unknown stability"
    return "stable" if np.all(sizes < 1.0 - NEUTRAL) else "unstable" if np.any(sizes > 1.0 + NEUTRAL) else "neutral"


def multipliers_of(M: Array, rank_loss: int, autonomous: bool = False) -> Array:
    """The eigenvalues of a monodromy matrix, the largest first; real where all are.

    Parameters
    ----------
    rank_loss : int
        How many directions are wiped out at one instant on the way: so many of the smallest eigenvalues are 0, and not what rounding makes
        of them. The rank is as much lower; contacts that rest one after the other count once.
    autonomous : bool
        Whether the flow does not depend on time: the eigenvalue 1 along the orbit is left out.
    """
    if not np.isfinite(M).all():
        return np.full(len(M) - autonomous, np.nan)
    multipliers: Array = np.linalg.eigvals(M)
    if autonomous:
        multipliers = np.delete(multipliers, int(np.argmin(abs(multipliers - 1.0))))
    multipliers = multipliers[np.argsort(-abs(multipliers), kind="stable")]
    if rank_loss and len(multipliers):
        multipliers[-int(rank_loss) :] = 0.0
    return multipliers.real if np.all(multipliers.imag == 0) else multipliers


def resting(run: Trajectory) -> Array:
    """How many directions are forgotten on each piece of a run: as many as independent slips of its contacts rest."""
    mode, machine = np.asarray(run.pieces.mode), machine_of(run.model)
    if machine.has_inner_states:
        return np.zeros(len(mode), int)
    rows, (patterns, number) = np.array(machine.mechanics.directions), np.unique(mode == 0, axis=0, return_inverse=True)
    ranks = np.array([np.linalg.matrix_rank(rows[pattern]) if pattern.any() else 0 for pattern in patterns])
    return ranks[np.ravel(number)]
