"""Forces through a play: a set-valued law moved by an actuator, whose force is zero between the flanks.

The instant at which a flank is reached lies between two samples, or within the noise of the position; there the force may be anything
between none and that of friction, so that a play is known to no more than the way between samples.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.models.friction.law_adapter import LawAdapter


def force_through_play(
    law: LawAdapter, steps: Array, v: Array, at: Array, load: Any, play: Any, start: Any, side: float, cases: int,
    blur: float = 0.0, samples: float = 0.0, smear: float = 0.0,
) -> Any:  # fmt: skip
    """The least (side -1) or the greatest (1) force at an actuator that moves a rigid contact through a play: array (samples, cases) [N].

    Parameters
    ----------
    steps : array (n,)
        Time since the sample before [s].
    v, at : array (n,)
        Mean velocity over that time, and velocity at the samples [m/s]; where the latter is zero the contact is held.
    load : array (n, cases) or (n, 1)
    play : array (cases,) or float
        From flank to flank [m].
    start : array (cases,) or float
        Where in the play it stands before the first sample, from -1 (behind) to 1.
    blur : float
        How far positions may be off [m].
    samples : float
        By how many samples the instants may be off; values between samples that are read later are means of neighbours.
    smear : float
        Way over which the force rises at a flank, in a search, which needs a slope [m]; 0 for a step between two samples.
    """
    half = 0.5 * np.broadcast_to(np.asarray(play, float), (cases,))
    way, beyond = _beyond(np.sign(v), abs(v) * steps, half, start * half)
    way = way[:, None]
    if smear > 0.0:
        reached = np.clip(beyond / smear + 0.5, 0.0, 1.0)
        least = most = reached
    else:
        room = np.maximum(abs(v) * steps, 1e-300)[:, None]
        off = blur + samples * room
        least, most = (np.clip((beyond + lead) / room, 0.0, 1.0) for lead in (-off, off + room))
    slides = at[:, None]
    sign = np.sign(slides)
    sliding = np.broadcast_to(law.sliding(np.where(slides != 0, slides, 1.0), load), beyond.shape)
    backward, forward = law.breakaway(load)
    held = np.where(side > 0, forward, backward) * most  # of either flank: near a reversal its direction is open
    pushed = sliding * np.where(side * sliding > 0, most, least)
    return np.where((sign == 0) | (sign != np.where(way == 0, sign, way)), held, pushed)


def _beyond(sign: Any, moved: Any, half: Any, offset: Any) -> tuple[Any, Any]:
    """The direction in which the actuator moves or moved last, and how far it is beyond the flank there: arrays (n,), (n, cases) [m].

    A flank that it stands on is passed by nothing or more, one not yet reached by less.
    """
    n = len(sign)
    last = np.maximum.accumulate(np.where(sign != 0, np.arange(n), -1))
    way = np.where(last < 0, 0.0, sign[np.maximum(last, 0)])
    turns = np.concatenate([[0], np.flatnonzero(np.diff(way)) + 1, [n]])
    beyond = np.empty((n, len(half)))
    for first, end in pairwise(turns):
        s, gone = way[first], np.cumsum(moved[first:end])
        beyond[first:end] = gone[:, None] - (half - s * offset)
        offset = s * np.minimum(half, s * offset + gone[-1]) if s else offset
    return way, beyond
