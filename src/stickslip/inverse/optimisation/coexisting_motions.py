"""Other motions of a machine than the one from rest: from other starts, and continued from another machine."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Model
from stickslip.basics.errors import StickslipError
from stickslip.basics.fields import leaves
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, spread_over, state_at_rest, strobe_map
from stickslip.inverse.optimisation.results import results_of
from stickslip.models.machine_adapter import machine_of

_STEPS, _PERIODS = 24, 40  # of the way from one machine to the other, and drive periods at each
_SAME = 1e-6  # of the mean velocity: attractors nearer to each other are one


def from_other_starts(model: Model, V: float) -> list[str]:
    """A sentence where a push forwards or backwards leads to another mean velocity."""
    speed, at = float(machine_of(model).free_velocity), coordinates(model)
    kick = np.zeros(len(at.names))
    kick[at.order.velocities] = speed
    start = at.start(state_at_rest(model, at) + np.array([[1.0], [-1.0]]) * kick)
    velocities = results_of(spread_over(model, 2), 2, start=start)["mean_velocity"]
    other = [float(v) for v in velocities if abs(v - V) > _SAME * max(abs(V), speed)]
    return [f"another motion coexists, with V = {v:.6g} m/s from another start" for v in other[:1]]


def continued(given: Any, best: Any, numbers: dict[str, float]) -> float | None:
    """Mean velocity of the motion that is reached from that of one machine as its numbers become those of another, slowly.

    Parameters
    ----------
    given, best : Robot or machine
        From where the way goes, and where it ends.
    numbers : dict
        The numbers in which they differ, as `best` has them.

    Returns
    -------
    float or None
        None where no way leads there, as from one kind of drive to another.

    Examples
    --------
    >>> import stickslip as ss
    >>> given, best = (ss.presets.piezo_rig(tilt_deg=1.7, amplitude=A, law="coulomb") for A in (5e-4, 8e-4))
    >>> round(continued(given, best, {"drive.amplitude": 8e-4}), 9)
    0.004308808
    """
    own = dict(leaves(given))
    if not set(numbers) <= set(own) or _kind(given) != _kind(best):
        return None
    try:
        state = state_at_rest(given)
        for part in np.linspace(0.0, 1.0, _STEPS + 1):
            now = given.replace({name: (1.0 - part) * own[name] + part * value for name, value in numbers.items()})
            state = strobe_map(now, state, _PERIODS).state
        start = coordinates(best).start(state)
        return float(results_of(spread_over(best, 1), 1, start=start)["mean_velocity"][0])
    except StickslipError:  # some machine on the way is none, or has no strobe map
        return None


def _kind(model: Model) -> list[tuple[str, Any]]:
    """The kind of a machine, apart from its numbers."""
    numbers = dict(leaves(model))
    return [(name, None if name in numbers else str(value)) for name, value in leaves(model, kinds=True)]
