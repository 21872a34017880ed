"""Forces at contacts of which some follow from the motion, at given instants: what touches keeps its height, what rests its slip."""

from __future__ import annotations

import itertools
from typing import Any, NamedTuple

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.models.friction.law_adapter import TINY
from stickslip.models.rails import weighed


class FeetForces(NamedTuple):
    """Friction and normal forces (time, contact) [N], and accelerations of the coordinates (time, coordinate)."""

    friction: Array
    loads: Array
    accelerations: Array


def forces_of_feet(mechanics: Any, mode: Array, aloft: Array, t: Array, q: Any, u: Any, held: Any) -> FeetForces:
    """The forces that modes (time, contact) and flights of points ask for.

    Points of one body that rest together share the friction that they bear in proportion to their loads: only its sum follows. A rail
    presses on the side on which its own friction lets it.
    """
    asked = _Asked(mechanics, mode, t, q, u, held)
    friction, pressed = np.zeros(mode.shape), np.zeros(mode.shape)
    patterns = np.hstack([mode, aloft.astype(int)])
    rails = [i for i in asked.pressed if not mechanics.laws[i].flies]
    for pattern in np.unique(patterns, axis=0):
        at, (sides, flies) = np.flatnonzero(np.all(patterns == pattern, axis=1)), np.split(pattern, 2)
        left = np.ones(len(at), bool)
        for signs in itertools.product((1.0, -1.0), repeat=len(rails)):
            loads, forces = asked.solved(at, sides, flies, dict(zip(rails, signs, strict=True)))
            good = left & np.all(loads[:, rails] * signs >= 0.0, axis=1)
            pressed[at[good]], friction[at[good]] = loads[good], forces[good]
            left &= ~good
    moved = asked.free + np.einsum("ti,tic->tc", pressed, asked.up) - np.einsum("ti,tic->tc", friction, asked.along)
    loads = np.where(asked.is_pressed, asked.steep * pressed, asked.given)
    loads[:, rails] = abs(loads[:, rails])
    _share(mechanics, mode, aloft, loads, friction)
    return FeetForces(friction, loads, moved)


class _Asked:
    """The linear equations of all contacts at some instants."""

    def __init__(self, mechanics: Any, mode: Array, t: Array, q: Any, u: Any, held: Any):
        count, many = range(len(mechanics.contacts)), (len(t),)

        def columns(rows: Any) -> Array:
            return np.stack([np.broadcast_to(np.asarray(row, float), many) for row in rows], axis=-1)

        touching, none = mechanics.touching, (0.0,) * len(mechanics.bodies)
        self.pressed = [i for i in count if touching[i].is_held]
        self.is_pressed = np.isin(np.array(count), self.pressed)
        self.free = columns(mechanics.loose_accelerations(t, q, u, (0.0,) * len(mechanics.contacts), held))
        rows, kept = mechanics.rows(0.0, q), [touching[i].keeps_height for i in count]
        borne = {i: weighed(mechanics, i, t, q, u, held) for i in self.pressed if not kept[i]}
        self.n, self.up = (np.stack([columns(of(i)) for i in count], axis=1) for of in (
            lambda i: touching[i].heights_at(q) if kept[i] else borne[i][0] if i in borne else none,
            lambda i: mechanics.struck(i, q).moved_across if kept[i] else none,
        ))  # fmt: skip
        self.along = np.stack([columns(mechanics.loosely_pushed(0.0, q, row)) for row in rows], axis=1)
        self.g = np.stack([columns(row) for row in rows], axis=1)
        self.borne = np.array([float(i in borne) for i in count])
        self.steep = columns([touching[i].steepness(q) if kept[i] else 1.0 for i in count])
        self.gap = columns([mechanics.rising(i, t, q, u, held) if kept[i] else borne[i][1] if i in borne else 0.0 for i in count])
        self.gap += np.einsum("tic,tc->ti", self.n, self.free) * self.borne
        drift = columns(mechanics.slip_biases(t, q, u)) + columns(mechanics.offset_rates(t))
        self.slip = np.einsum("tic,tc->ti", self.g, self.free) + drift
        slips, side = columns(mechanics.slips(t, u, q)), np.where(mode < 0, -1.0, 1.0)
        slips = side * np.maximum(side * slips, TINY)
        self.given = columns([0.0 if touching[i].is_held else mechanics.load(i, t, q, u, held) for i in count])
        self.kinetic = columns([
            law.sliding(slips[:, i], 1.0 if i in self.pressed else self.given[:, i]) for i, law in enumerate(mechanics.laws)
        ])  # fmt: skip

    def solved(self, at: Array, sides: Array, flies: Array, signs: dict[int, float]) -> tuple[Array, Array]:
        """Forces across and along (time, contact) of a pattern, with rails that press on some sides."""
        on, rests = (np.flatnonzero(of & (flies == 0)) for of in (self.is_pressed, sides == 0))
        loads, friction = np.zeros((len(at), len(sides))), np.zeros((len(at), len(sides)))
        slips = np.flatnonzero(~self.is_pressed & (sides != 0))
        friction[:, slips] = self.kinetic[np.ix_(at, slips)]
        if not len(on) and not len(rests):
            return loads, friction
        sign = np.array([signs.get(int(i), 1.0) for i in on])
        slides = np.where(sides[on] != 0, (self.steep * self.kinetic)[np.ix_(at, on)] * sign, 0.0)  # (time, touching)
        n, up, g, along = (of[at] for of in (self.n, self.up, self.g, self.along))
        A, B, C, G = (np.einsum("tic,tjc->tij", a, b) for a, b in ((n, up), (n, along), (g, up), (g, along)))
        A = A - np.diag(self.borne)
        parts = [
            np.concatenate([a[:, which][:, :, on] - b[:, which][:, :, on] * slides[:, None, :], -b[:, which][:, :, rests]], axis=2)
            for which, a, b in ((on, A, B), (rests, C, G))
        ]
        taken = [np.einsum("tij,tj->ti", b[:, which][:, :, slips], friction[:, slips]) for which, b in ((on, B), (rests, G))]
        right = -np.concatenate([self.gap[np.ix_(at, on)] - taken[0], self.slip[np.ix_(at, rests)] - taken[1]], axis=1)
        unknown = np.einsum("tij,tj->ti", np.linalg.pinv(np.concatenate(parts, axis=1), rcond=1e-10), right)
        loads[:, on] = unknown[:, : len(on)]
        friction[:, on] = slides * loads[:, on]
        friction[:, rests] = unknown[:, len(on) :]
        return loads, friction


def _share(mechanics: Any, mode: Array, aloft: Array, loads: Array, friction: Array) -> None:
    """Share what points of one body on flat ground bear together."""
    contacts = zip(mechanics.joints.values(), mechanics.laws, strict=True)
    bodies = [contact.body if contact.on is None and law.flies else None for contact, law in contacts]
    rests = (mode == 0) & ~aloft
    for body in {body for body in bodies if body is not None}:
        own = np.array([i for i, each in enumerate(bodies) if each == body], int)
        both = np.flatnonzero(np.all(rests[:, own], axis=1)) if len(own) > 1 else np.zeros(0, int)
        parts = loads[np.ix_(both, own)]
        friction[np.ix_(both, own)] = friction[np.ix_(both, own)].sum(axis=1, keepdims=True) * parts / parts.sum(axis=1, keepdims=True)
