r"""Contacts that keep a point of a body at its height, which coordinates could change: their normal force, and what it does.

.. math:: M \ddot q = h - g R + n \lambda, \qquad n \ddot q + \dot n \dot q = 0 \;\Rightarrow\;
    \lambda = -\frac{n M^{-1}(h - g R) + \dot n \dot q}{n M^{-1} n} = \lambda_0 - C R,
    \qquad C = -\frac{n M^{-1} g}{n M^{-1} n},

with the row g of the slip and that of the height, n. It is the same equation as that of a rail (`stickslip.models.rails`).
"""

from __future__ import annotations

from typing import Any, NamedTuple

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


class Struck(NamedTuple):
    """What impulses at a point do: across, upwards, and along, as friction does with the other sign.

    The changes of the coordinates' rates that a unit impulse makes, and what it does to the rate of the height and to the slip.
    """

    moved_across: tuple[Any, ...]
    moved_along: tuple[Any, ...]
    across: Any  # n W n
    between: Any  # n W g
    along: Any  # g W g


def struck_at(mechanics: Any, i: int, q: Numbers) -> Struck:
    """The same for the point of a contact that keeps its height, at given coordinates."""
    lever, row = lever_of(mechanics, mechanics.touching[i], q), mechanics.rows(0.0, q)[i]
    moved = mechanics.loosely_pushed(0.0, q, row)
    return Struck(lever.moved, moved, lever.own, total(map(product, lever.row, moved)), total(map(product, row, moved)))


def rising_freely(mechanics: Any, i: int, t: Numeric, q: Numbers, u: Numbers, z: Numbers | None) -> Any:
    """Second derivative of the height of a contact's point where the contact does nothing [m/s^2]."""
    contact, none = mechanics.touching[i], (0.0,) * len(mechanics.contacts)
    free = mechanics.loose_accelerations(t, q, u, none, z)
    return total([*map(product, contact.heights_at(q), free), contact.point(mechanics.moved(t, q, u))[1].second])
