r"""Rails: the normal force on a contact that holds a body on both sides, from the motion.

.. math:: N = |\lambda|, \qquad \lambda = n \cdot \sum_b (m_b a_b - F_b) = \lambda_0 - C R,

where n is the normal of the rail, the sum is over the bodies that it bears, with their weights among the forces F, and R is the
friction force of the rail itself, which changes accelerations. While it slips, R = b N with the law's friction b for a load of one, so that
:math:`N = |\lambda_0| / (1 + b\,C \operatorname{sign} \lambda_0)`; at rest R is what holds it. This is the only load as long as
:math:`|b\,C| < 1`. Beyond, a rod that slides on its foot has none or several (Painlevé's paradox), and a run ends.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.contracts import Numeric
from stickslip.basics.maths import where
from stickslip.models.friction.law_adapter import TINY
from stickslip.models.kept_heights import given_back, lever_of, normal_force
from stickslip.models.linear_equations import product, solved, total
from stickslip.models.mechanics import Numbers
from stickslip.models.placed_links import shares


def borne(mechanics: Any, i: int) -> tuple[str, ...]:
    """The bodies that a rail bears: its own, those that rest on it, and those that nothing else holds."""
    contacts = [contact.contact for contact in mechanics.touching if contact.is_held]
    own = mechanics.touching[i].contact
    names = [own.body]
    for name in names:  # grows while it is walked
        names += [c.body for c in contacts if c.on == name and c.body not in names]
    if not mechanics.touching[i].rubs_on_body:
        names += loose(mechanics)
    return tuple(names)


def loose(mechanics: Any) -> list[str]:
    """Bodies that no rail holds."""
    held = {contact.contact.body for contact in mechanics.touching if contact.is_held}
    return [name for name in mechanics.placed if name not in held]


def reaction(mechanics: Any, i: int, t: Numeric, q: Numbers, u: Numbers, R: Numbers, z: Numbers | None = None) -> Any:
    """The force of a rail along its normal, or of a contact that keeps its height, under given friction forces [N]."""
    if mechanics.touching[i].keeps_height:
        contact, free = mechanics.touching[i], mechanics.loose_accelerations(t, q, u, R, z)
        return product(contact.steepness(q), normal_force(mechanics, contact, lever_of(mechanics, contact, q), t, q, u, free))
    normal, slopes, moved = mechanics.touching[i].normal_at(q), mechanics.slopes(t, q), mechanics.moved(t, q, u)
    a, terms, pulled = mechanics.accelerations(t, q, u, R, z), [], shares(mechanics.placed_links, t, moved)
    for name in borne(mechanics, i):
        forces = mechanics.forces_on(name, t, moved[name], pulled)
        for part, along in enumerate(normal[: len(moved[name])]):
            gained = total([moved[name][part].second, *(product(slope[name][part], of) for slope, of in zip(slopes, a, strict=True))])
            force = total([product(mechanics.placed[name].mass, gained), product(-1.0, forces[part])])
            terms.append(product(along, force))
    return total(terms)


def weighed(mechanics: Any, i: int, t: Numeric, q: Numbers, u: Numbers, z: Numbers | None = None) -> tuple[tuple[Any, ...], Any]:
    """The force of a rail along its normal by the accelerations of the coordinates: their coefficients, and the rest."""
    normal, slopes, moved = mechanics.touching[i].normal_at(q), mechanics.slopes(t, q), mechanics.moved(t, q, u)
    pulled, by, rest = shares(mechanics.placed_links, t, moved), [list[Any]() for _ in slopes], list[Any]()
    for name in borne(mechanics, i):
        forces, mass = mechanics.forces_on(name, t, moved[name], pulled), mechanics.placed[name].mass
        for part, along in enumerate(normal[: len(moved[name])]):
            for own, slope in zip(by, slopes, strict=True):
                own.append(product(along, product(mass, slope[name][part])))
            rest.append(product(along, total([product(mass, moved[name][part].second), product(-1.0, forces[part])])))
    return tuple(map(total, by)), total(rest)


def load_under(mechanics: Any, i: int, t: Numeric, q: Numbers, u: Numbers, R: Numbers, z: Numbers | None = None) -> Any:
    """The normal force under given friction forces: a rail presses on either side, ground on one [N]."""
    force = reaction(mechanics, i, t, q, u, R, z)
    return force if mechanics.touching[i].pushes else abs(force)


def yielding(mechanics: Any, i: int, t: Numeric, q: Numbers) -> Any:
    """How much of the force of a rail its friction of one newton takes."""
    if mechanics.touching[i].keeps_height:
        contact, taken = mechanics.touching[i], mechanics.loosely_pushed(t, q, mechanics.rows(t, q)[i])
        return product(contact.steepness(q), given_back(lever_of(mechanics, contact, q), taken))
    normal, slopes = mechanics.touching[i].normal_at(q), mechanics.slopes(t, q)
    a, terms = mechanics.pushed(t, q, mechanics.rows(t, q)[i]), []
    for name in borne(mechanics, i):
        for part, along in enumerate(normal[: len(slopes[0][name])]):
            gained = total(product(slope[name][part], of) for slope, of in zip(slopes, a, strict=True))
            terms.append(product(along, product(mechanics.placed[name].mass, gained)))
    return total(terms)


def decides(mechanics: Any, i: int, t: Numeric, q: Numbers, per_load: Any) -> Any:
    """Positive as long as one load, and no other, follows from the motion, under a friction force of `per_load` for each newton of it.

    A rail may press on either side, N = s lambda0 / (1 + s b C) with s = 1 or -1: where |b C| >= 1 both sides give a load, or none does.
    What pushes and cannot pull has one side alone.
    """
    back = per_load * yielding(mechanics, i, t, q)
    return 1.0 + back if mechanics.touching[i].pushes else 1.0 - back * back


def pressed_while_sliding(mechanics: Any, i: int, t: Numeric, q: Numbers, u: Numbers, z: Numbers | None) -> Any:
    """The normal force on a rail while its body slips, or is about to, to the side of its slip [N]."""
    slip = mechanics.slips(t, u, q)[i]
    if isinstance(slip, float):
        slip = float(slip) or TINY
    elif isinstance(slip, np.ndarray):
        slip = np.where(slip == 0.0, TINY, slip)
    free = reaction(mechanics, i, t, q, u, (0.0,) * len(mechanics.contacts), z)
    side = 1.0 if mechanics.touching[i].pushes else where(free > 0.0, 1.0, -1.0)
    left = 1.0 + mechanics.laws[i].sliding(slip, 1.0) * yielding(mechanics, i, t, q) * side
    return solved(((left,),), (side * free,))[0]
