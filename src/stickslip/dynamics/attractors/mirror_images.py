"""Which attractors of a symmetric machine are mirror images of one another.

Where forwards and backwards are alike, half a drive period later or at the same time, y -> -y turns every motion into a motion: attractors
come in pairs, or are their own image. The image of an attractor is looked for as a motion: the mirrored states have to go on as mirrored
states for three drive periods, and then the starts on the image settle, and are compared with the attractors that are known.

Bristles and positions change their sign, other inner states may keep it, and both are tried. The mode of a flow stays. Laws with discrete
memory are not looked at: what a memory is in the mirror nobody has said; nor are machines without a period,
whose section has no mirror image.
"""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import StickslipError
from stickslip.dynamics.attractors.motion_features import Features, features_of
from stickslip.dynamics.attractors.period_numbers import return_tolerance
from stickslip.dynamics.attractors.settled_motions import LIMIT, Settling, settled_motions
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, flight, spread_over, state_at, strobe_orbit
from stickslip.models.machine_adapter import machine_of

_LATER = (0.5, 0.0)  # of a drive period: by how much later the image of a motion is
_PERIODS = 3  # over which an image has to be a motion
_MOMENTS = ((0.13, 0.7), (0.57, -1.3), (0.81, 0.4))  # parts of the period, and velocities in their scale, at which the equations are asked
_SAME = 1e-9  # of accelerations


def mirror_images(model: Model, at: Coordinates, motions: Features, states: Array, members: list[int], rtol: float) -> list[int | None]:
    """For each of some attractors the place of the one among them that is its mirror image: its own, or another; None where none is.

    Parameters
    ----------
    model : Robot, machine or SwitchingFlow
        One of them.
    motions : Features
        Of all starts.
    states : array (attractors, coordinates)
        A strobe state on each attractor.
    members : list of int
        A start on each attractor, by its row in `motions`.
    """
    places: list[int | None] = [None] * len(members)
    if not members or model.period is None or not _may_be_symmetric(model, at):
        return places
    images, known = np.full_like(states, np.nan), np.zeros(len(states), bool)
    for i, state in enumerate(states):
        with suppress(StickslipError):
            image = _image(model, at, state, rtol)
            if image is not None:
                images[i], known[i] = image, True
    if not known.any():
        return places
    settled = settled_motions(spread_over(model, int(known.sum())), images[known], at, Settling(1, LIMIT, rtol))
    mirrored = features_of(model.period, settled, at)
    for row, i in enumerate(np.flatnonzero(known).tolist()):
        if settled.attracted[row]:
            places[i] = next((j for j, member in enumerate(members) if mirrored.same(row, motions, member)), None)
    return places


def image_in_words(own: int, image: int | None) -> str:
    """What a mirror image is, in words; empty where none is known.

    Examples
    --------
    >>> image_in_words(1, 0), image_in_words(0, 0), image_in_words(0, None)
    ('the mirror image of attractor 0', 'its own mirror image', '')
    """
    return "" if image is None else "its own mirror image" if image == own else f"the mirror image of attractor {image}"


def _may_be_symmetric(model: Any, at: Coordinates) -> bool:
    """Whether accelerations do not speak against it, at the same time or half a period later; laws are asked by motions."""
    if at.mechanics is None:  # a flow may be anything
        return True
    if at.memories:
        return False
    m, T = machine_of(model).mechanics, float(model.period)  # of this one, where `at` is that of a batch
    for later in _LATER:
        pairs = []
        for part, v in _MOMENTS:
            u = tuple(v * at.speed / (1 + k) for k in range(m.coordinates))
            q = tuple(0.3 * T * each for each in u)
            R = (0.0,) * len(m.contacts)
            here = m.accelerations(part * T, q, u, R)
            there = m.accelerations((part + later) * T, tuple(-x for x in q), tuple(-x for x in u), R)
            pairs += [(float(a), float(b)) for a, b in zip(here, there, strict=True)]
        largest = max(max(abs(a), abs(b)) for a, b in pairs)
        if all(abs(a + b) <= _SAME * largest for a, b in pairs):
            return True
    return False


def _image(model: Model, at: Coordinates, state: Array, rtol: float) -> Array | None:
    """A strobe state on the mirror image of the motion from a state; None where there is none."""
    run, T = flight(model, state, _PERIODS + 1, min(rtol, 1e-9)), float(model.period)
    for later in _LATER:
        times = [(k + later) * T for k in range(_PERIODS + 1)]
        path = np.array([np.append(state_at(run, t), state[at.smooth :]) for t in times])
        for sign in (-1.0, 1.0) if at.inner_states else (-1.0,):
            turned = -path
            turned[:, at.order.inner] = sign * path[:, at.order.inner]
            turned[:, at.smooth :] = path[:, at.smooth :]
            goes_on = strobe_orbit(model, turned[0], _PERIODS, min(rtol, 1e-9))[0][:, 0]
            if np.all(at.distance(goes_on, turned[1:]) <= return_tolerance(rtol)):
                return turned[0] + 0.0
    return None
