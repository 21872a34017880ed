"""To which of two motions starts lead, and where a line between two starts crosses from one basin into another."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.contracts import Array
from stickslip.dynamics.attractors.basins import settled_points
from stickslip.dynamics.attractors.motion_features import Features, features_of
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, spread_over
from stickslip.errors import InputError, SolveError
from stickslip.flow import is_flow
from stickslip.sealing import sealed
from stickslip.variables import unit_of

OTHER = 2
NARROW = 1e-10  # in scales: how near to one another two states on either side of a border are brought
_PARTS = 16  # into so many a segment is cut at once: its inner points are one batch
_ROUNDS = 4  # how often a start that is on neither motion yet is run on, each time twice as long


@sealed
class Judge:
    """To which of two motions starts lead: 0 or 1; 2: to another, or to none that was recognised."""

    model: Any
    at: Coordinates
    settle: int
    rtol: float
    motions: Features
    ends: Array  # strobe states on them

    def sides(self, states: Array) -> Array:
        """The number of the motion to which each state leads; what is on neither yet is run on."""
        found, here, states = np.full(len(states), OTHER), np.arange(len(states)), np.array(states)
        for k in range(_ROUNDS):
            motions, good, ends = _settled(self.model, self.at, states[here], self.settle * 2**k, self.rtol)
            found[here] = [self._side(motions, i) if good[i] else OTHER for i in range(len(here))]
            states[here] = ends
            here = here[(found[here] == OTHER) & good]
            if not len(here):
                break
        return found

    def _side(self, motions: Features, i: int) -> int:
        return next((k for k in (0, 1) if motions.same(i, int(self.motions.period[k]), self.motions.means[k])), OTHER)


def _settled(model: Any, at: Coordinates, states: Array, settle: int, rtol: float) -> tuple[Features, Array, Array]:
    """Features of the motions after some periods, which starts could be solved, and the last strobe states."""
    points, ways, good = settled_points(spread_over(model, len(states)), states, settle, rtol, 1, None)
    return features_of(float(model.period), points, ways, at, rtol), good > 0, points[:, -1]


def judge_between(model: Any, at: Coordinates, settle: int, rtol: float, ends: Array) -> Judge:
    """The judge who knows the motions to which two starts lead; an error where they are one, or none."""
    motions, good, last = _settled(model, at, ends, settle * (2**_ROUNDS - 1), rtol)
    if not good.all():
        which = " and ".join(name for name, fine in zip(("first", "second"), good, strict=True) if not fine)
        raise SolveError(f"edge_state: the run from the {which} start could not be solved; give a start nearer to the attractor")
    if motions.same(0, int(motions.period[1]), motions.means[1]):
        told = f"both starts lead to one motion, {named_motion(model, motions, 0)}; allowed are two that lead to different ones"
        raise InputError("edge_state", [f"{told}; type ss.basins(model).attractors to see which motions there are"])
    return Judge(model, at, settle, rtol, motions, last)


def named_motion(model: Any, motions: Features, i: int) -> str:
    """A motion by its period and its mean velocity."""
    period, V = int(motions.period[i]), motions.mean_velocity[i]
    way = "" if is_flow(model) else f", V = {V:.7g} {unit_of('v', model)}"
    return (f"period {period}" if period else "no period up to 32") + way


def narrowed(judge: Judge, ends: Array) -> Array:
    """Two states very near to one another of which only the first leads to the first motion: array (2, coordinates)."""
    scales = judge.at.scales
    pair = np.array(ends)
    while True:
        apart = float(np.max(abs(pair[1] - pair[0]) / scales))
        parts = np.linspace(0.0, 1.0, _PARTS + 1)[1:-1, None]
        inner = pair[0] + parts * (pair[1] - pair[0])
        if apart <= NARROW or np.all((inner == pair[0]) | (inner == pair[1])):
            return pair
        sides = np.concatenate([[0], judge.sides(inner), [1]])
        states = np.vstack([pair[:1], inner, pair[1:]])
        meets = np.flatnonzero((sides[:-1] == 0) & (sides[1:] == 1))
        leaves = np.flatnonzero((sides[:-1] == 0) & (sides[1:] != 0))
        k = int(meets[0] if len(meets) else leaves[0])
        pair = states[[k, k + 1]]
