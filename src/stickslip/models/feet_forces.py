"""Forces at several points of bodies that push on the ground, at given instants: what touches keeps its height, what rests its slip."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.models.friction.law_adapter import TINY


class FeetForces(NamedTuple):
    """Friction and normal forces (time, contact) [N], and accelerations of the coordinates (time, coordinate)."""

    friction: Array
    loads: Array
    accelerations: Array


def forces_of_feet(mechanics: Any, mode: Array, aloft: Array, t: Array, q: Any, u: Any, held: Any) -> FeetForces:
    """The forces that modes (time, contact) and flights of points ask for.

    Points of one body that rest together share the friction that they bear in proportion to their loads: only its sum follows.
    """
    count, many = range(len(mechanics.contacts)), (len(t),)

    def columns(rows: Any) -> Array:
        return np.stack([np.broadcast_to(np.asarray(row, float), many) for row in rows], axis=-1)

    none = (0.0,) * len(mechanics.contacts)
    free = columns(mechanics.loose_accelerations(t, q, u, none, held))
    struck = [mechanics.struck(i, q) for i in count]
    up, along = (np.stack([columns(of[k]) for of in struck], axis=1) for k in (0, 1))  # what unit forces do (time, contact, coordinate)
    n = np.stack([columns(mechanics.touching[i].heights_at(q)) for i in count], axis=1)
    g = np.stack([columns(row) for row in mechanics.rows(0.0, q)], axis=1)
    steep = columns([of.steepness for of in struck])
    gap = columns([mechanics.rising(i, t, q, u, held) for i in count])
    drift = columns(mechanics.slip_biases(t, q, u))
    slip = np.einsum("tic,tc->ti", g, free) + drift
    slips = columns(mechanics.slips(t, u, q))
    per_load = steep * columns([
        law.sliding(np.where(mode[:, i] < 0, -1.0, 1.0) * np.maximum(np.where(mode[:, i] < 0, -1.0, 1.0) * slips[:, i], TINY), 1.0)
        for i, law in enumerate(mechanics.laws)
    ])  # fmt: skip
    friction, pressed = np.zeros(mode.shape), np.zeros(mode.shape)
    patterns = np.hstack([mode, aloft.astype(int)])
    for pattern in np.unique(patterns, axis=0):
        at = np.flatnonzero(np.all(patterns == pattern, axis=1))
        sides, flies = np.split(pattern, 2)
        on = np.flatnonzero(flies == 0)
        if not len(on):
            continue
        rests = np.array([i for i in on if sides[i] == 0], int)
        slides = np.where(sides[on] != 0, per_load[np.ix_(at, on)], 0.0)  # (time, touching)
        A, B, G = (np.einsum("tic,tjc->tij", a[at], b[at]) for a, b in ((n, up), (n, along), (g, along)))
        top = np.concatenate([A[:, on][:, :, on] - B[:, on][:, :, on] * slides[:, None, :], -B[:, on][:, :, rests]], axis=2)
        low = np.concatenate(
            [np.swapaxes(B, 1, 2)[:, rests][:, :, on] - G[:, rests][:, :, on] * slides[:, None, :], -G[:, rests][:, :, rests]], axis=2
        )
        matrix = np.concatenate([top, low], axis=1)
        right = -np.concatenate([gap[np.ix_(at, on)], slip[np.ix_(at, rests)]], axis=1)
        unknown = np.einsum("tij,tj->ti", np.linalg.pinv(matrix, rcond=1e-10), right)
        loads = unknown[:, : len(on)]
        pressed[np.ix_(at, on)] = loads
        friction[np.ix_(at, on)] = slides * loads
        friction[np.ix_(at, rests)] = unknown[:, len(on) :]
    moved = free + np.einsum("ti,tic->tc", pressed, up) - np.einsum("ti,tic->tc", friction, along)
    _share(mechanics, mode, aloft, steep * pressed, friction)
    return FeetForces(friction, steep * pressed, moved)


def _share(mechanics: Any, mode: Array, aloft: Array, loads: Array, friction: Array) -> None:
    """Share what points of one body on flat ground bear together."""
    bodies = [contact.body if contact.on is None else None for contact in mechanics.joints.values()]
    rests = (mode == 0) & ~aloft
    for body in {body for body in bodies if body is not None}:
        own = np.array([i for i, each in enumerate(bodies) if each == body], int)
        both = np.flatnonzero(np.all(rests[:, own], axis=1)) if len(own) > 1 else np.zeros(0, int)
        parts = loads[np.ix_(both, own)]
        friction[np.ix_(both, own)] = friction[np.ix_(both, own)].sum(axis=1, keepdims=True) * parts / parts.sum(axis=1, keepdims=True)
