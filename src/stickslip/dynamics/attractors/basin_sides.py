"""To which of two motions starts lead, and where a line between two starts crosses from one basin into another."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, SolveError
from stickslip.basics.frozen_arrays import sealed
from stickslip.dynamics.attractors.kinds_of_motion import NOT_COMPUTED, PERIODIC, RUNS_AWAY, UNSETTLED, UNSOLVED
from stickslip.dynamics.attractors.motion_features import Features, features_of
from stickslip.dynamics.attractors.settled_motions import Settled, Settling, settled_motions
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, spread_over
from stickslip.models.angular_coordinates import unit_of_part
from stickslip.models.model_adapter import adapter_of
from stickslip.models.rounding import without_rounding

OTHER = 2
NARROW = 1e-10  # in scales: how near to one another two states on either side of a border are brought
_PARTS = 16  # into so many a segment is cut at once: its inner points are one batch
_FATES = {UNSETTLED: "has not settled", RUNS_AWAY: "runs away", UNSOLVED: "could not be solved", NOT_COMPUTED: "was not computed"}
_LONGER = 16  # times the drive periods of settling: how long a start is run on


@sealed
class SideJudge:
    """To which of two motions starts lead: 0 or 1; 2: to another, or to none that was recognised."""

    model: Any
    at: Coordinates
    settle: int
    rtol: float
    motions: Features
    ends: Array  # strobe states on them

    def sides(self, states: Array) -> Array:
        """The number of the motion to which each state leads."""
        motions, settled = _settled(self.model, self.at, np.asarray(states, float), self.settle, self.rtol)
        return np.array([self._side(motions, i) if on else OTHER for i, on in enumerate(settled.attracted)], int)

    def _side(self, motions: Features, i: int) -> int:
        return next((k for k in (0, 1) if motions.same(i, self.motions, k)), OTHER)


def _settled(model: Model, at: Coordinates, states: Array, settle: int, rtol: float) -> tuple[Features, Settled]:
    """Features of the motions on which starts settle."""
    settled = settled_motions(spread_over(model, len(states)), states, at, Settling(settle, _LONGER * settle, rtol))
    return features_of(model.period, settled, at), settled


def judge_between(model: Model, at: Coordinates, settle: int, rtol: float, ends: Array) -> SideJudge:
    """The judge who knows the motions to which two starts lead; an error where they are one, or none."""
    motions, settled = _settled(model, at, ends, settle, rtol)
    for i, name in enumerate(("first", "second")):
        if not settled.attracted[i]:
            why = f" ({settled.why[i]})" if settled.why[i] else ""
            mistake = f"the run from the {name} start {_FATES[str(settled.kind[i])]}{why}"
            raise SolveError(f"edge_state: {mistake}; give a start nearer to the attractor, or a longer settle=, such as {10 * settle}")
    if motions.same(0, motions, 1):
        mistake = f"both starts lead to one motion, {named_motion(model, motions, 0)}; allowed are two that lead to different ones"
        raise InputError("edge_state", [f"{mistake}; type ss.basins(model).attractors to see which motions there are"])
    return SideJudge(model, at, settle, rtol, motions, settled.points[:, -1])


def named_motion(model: Model, motions: Features, i: int) -> str:
    """A motion by its kind, period and mean velocity."""
    kind, period, V = str(motions.kind[i]), int(motions.period[i]), motions.mean_velocity[i]
    of = adapter_of(model)
    V, unit = (without_rounding(V, model), unit_of_part("v", model, "")) if of.has_units else (V, "")
    way = f", V = {V:.7g} {unit}".rstrip() if of.has_displacement else ""
    return (f"period {period}" if kind == PERIODIC else kind) + way


def narrowed(judge: SideJudge, ends: Array) -> Array:
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
