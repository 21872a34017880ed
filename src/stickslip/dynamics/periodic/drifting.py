"""Detects motions that accelerate for ever, so that none is periodic; asked where Newton's method fails."""

from __future__ import annotations

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, strobe_map

_DRIFTS = 200  # drive periods after which a motion that speeds up for ever does so evenly
_DRIFTS_AWAY = (
    "its velocity grows by the same amount in every drive period, as a constant force exceeds the friction and nothing opposes it; "
    "type a smaller constant force, a stiffness, or a damping that is not 0"
)
_GROWS, _EVENLY = 1e-3, 1e-3  # of the scale in a period, and of that growth


def drift_sentence(model: Model, state: Array, memory: Array) -> str:
    """In words, where velocities grow by the same amount in every drive period for ever: nothing then repeats."""
    at = coordinates(model)
    end = strobe_map(model, np.append(state * at.scales[: at.smooth], memory)[None], _DRIFTS, 1e-7).state
    once = strobe_map(model, end, 1, 1e-7).state
    twice = strobe_map(model, once, 1, 1e-7).state
    speeds = at.order.velocities
    change, again = ((b - a)[0, speeds] / at.scales[speeds] for a, b in ((end, once), (once, twice)))
    grows = np.max(abs(change)) > _GROWS and np.max(abs(again - change)) < _EVENLY * np.max(abs(change))
    return _DRIFTS_AWAY if grows else ""
