r"""Contacts that keep a point of a body at its height, which coordinates could change: their normal force, and what it does.

.. math:: M \ddot q = h - g R + n \lambda, \qquad n \ddot q + \dot n \dot q = 0 \;\Rightarrow\;
    \lambda = -\frac{n M^{-1}(h - g R) + \dot n \dot q}{n M^{-1} n} = \lambda_0 - C R,
    \qquad C = -\frac{n M^{-1} g}{n M^{-1} n},

with the row g of the slip and that of the height, n. It is the same equation as that of a rail (`stickslip.models.rails`).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stickslip.basics.contracts import Numeric
from stickslip.models.linear_equations import product, total
from stickslip.models.mechanics import Numbers


class Lever(NamedTuple):
    """How a height feels forces: its row n, the accelerations that a unit force upwards makes, and that of the height itself."""

    row: tuple[Any, ...]
    moved: tuple[Any, ...]
    own: Any


def lever_of(mechanics: Any, contact: Any, q: Numbers) -> Lever:
    """The lever of a contact's height at given coordinates."""
    row = contact.heights_at(q)
    moved = mechanics.loosely_pushed(0.0, q, row)
    return Lever(row, moved, total(map(product, row, moved)))


def normal_force(mechanics: Any, contact: Any, lever: Lever, t: Numeric, q: Numbers, u: Numbers, free: Numbers) -> Any:
    """The force that keeps the height, from the accelerations of the coordinates without it [N]."""
    bias = contact.point(mechanics.moved(t, q, u))[1].second
    return product(-1.0, total([*map(product, lever.row, free), bias]) / lever.own)


def given_back(lever: Lever, free: Numbers) -> Any:
    """The force that takes accelerations of the coordinates from the height, where rates stay as they are [N]."""
    return product(-1.0, total(map(product, lever.row, free)) / lever.own)


def with_force(lever: Lever, free: Numbers, force: Any) -> tuple[Any, ...]:
    """Accelerations of the coordinates with a force upwards, from those without it."""
    return tuple(total([a, product(force, moved)]) for a, moved in zip(free, lever.moved, strict=True))


_SAME = 1e-9  # of the velocity scale, and of that in a time scale: a height that is none


def least_height(mechanics: Any) -> tuple[float, float]:
    """A height and a rate of it that are none."""
    speed = float(np.max(getattr(mechanics, "velocity_scale", 1.0)))
    time = 1.0 if (scale := getattr(mechanics, "time_scale", None)) is None else float(np.max(scale))
    return _SAME * speed * time, _SAME * speed


def above(mechanics: Any, height: tuple[Any, Any]) -> tuple[Any, Any]:
    """The gap of a point that may fly, and its rate: exactly zero where it touches."""
    (gap, rate), (low, slow) = (np.asarray(of, float) for of in height), least_height(mechanics)
    gap = np.where(abs(gap) <= low, 0.0, gap)
    return gap, np.where((gap == 0.0) & (abs(rate) <= slow), 0.0, rate)


class Struck(NamedTuple):
    """What impulses at a point do: across, upwards, and along, as friction does with the other sign.

    The changes of the coordinates' rates that a unit impulse makes, and what it does to the rate of the height and to the slip.
    """

    moved_across: tuple[Any, ...]
    moved_along: tuple[Any, ...]
    across: Any  # n W n
    between: Any  # n W g
    along: Any  # g W g
    steepness: Any  # impulse that presses for one that changes the height: 1 on flat ground


def struck_at(mechanics: Any, i: int, q: Numbers) -> Struck:
    """The same for the point of a contact that keeps its height, at given coordinates."""
    contact, row = mechanics.touching[i], mechanics.rows(0.0, q)[i]
    lever, moved = lever_of(mechanics, contact, q), mechanics.loosely_pushed(0.0, q, row)
    between, along = (total(map(product, of, moved)) for of in (lever.row, row))
    return Struck(lever.moved, moved, lever.own, between, along, contact.steepness(q))


def rising_freely(mechanics: Any, i: int, t: Numeric, q: Numbers, u: Numbers, z: Numbers | None) -> Any:
    """Second derivative of the height of a contact's point where the contact does nothing [m/s^2]."""
    contact, none = mechanics.touching[i], (0.0,) * len(mechanics.contacts)
    free = mechanics.loose_accelerations(t, q, u, none, z)
    return total([*map(product, contact.heights_at(q), free), contact.point(mechanics.moved(t, q, u))[1].second])
