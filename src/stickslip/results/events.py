"""Events of a run: instants of discontinuous change."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike

if TYPE_CHECKING:
    from stickslip.models.mechanics import Mechanics


@dataclass(frozen=True)
class Event:
    """An instant of discontinuous change, usually of the mode of a contact.

    Parameters
    ----------
    t : float
        Time [s].
    kind : {"stick", "slip", "reversal", "impulse", "switch", "hit", "take-off", "landing", "contact lost", "crossing"}
        In this order: the contact came to rest; it broke away; its velocity changed sign without rest; a jump of the drive's velocity
        changed its slip; a memory of its law changed; a stop was hit; its load fell to zero and it took off; it landed; its load fell to
        zero for good; a function of the user passed zero (``events=`` of `solve`).
    before, after : int
        The modes: +1 forwards, 0 stuck, -1 backwards; in flight the sign of the slip. For a hit both are 0. For a crossing the signs of
        the function, which are one where it touches zero, and 0 after it where it stays there.
    part : str
        Name of the contact, "contact" if there is only one, as under a `Robot`; for a hit the bodies that meet, "mass-capsule";
        for a crossing its name.
    velocity : float, optional
        For a hit or a landing, the rate of the gap before it, negative [m/s].
    """

    t: float
    kind: str
    before: int
    after: int
    part: str = "contact"
    velocity: float | None = field(default=None, repr=False)


def events_of(pieces: Any, impulses: Any = (), lost: Any = (), aloft: Any = None) -> list[Event]:
    """Every event in order of time; at one instant, one event for each contact that changed, in the order of the contacts.

    Parameters
    ----------
    pieces : DensePieces
    impulses : sequence of (float, float or array)
        Times [s] and jumps of the velocity [m/s]: one number for all bodies, or one for each. A contact has an impulse if its slip jumps.
    lost : sequence of str
        Names of the contacts that were lost at the end.
    aloft : array (pieces, contacts) of bool, optional
        Whether contacts fly; take-offs and landings come from `flights_of`, not from here.
    """
    contacts, mode = pieces.layout.contacts, np.asarray(pieces.mode)
    aloft = np.zeros(mode.shape, bool) if aloft is None else aloft
    events = [event for i in range(len(contacts)) for event in _events_of_one(pieces, i, mode[:, i], impulses, aloft[:, i])]
    events.sort(key=lambda event: event.t)  # keeps the order of the contacts at one instant
    end = [(c.name, int(mode[-1, i])) for i, c in enumerate(contacts) if c.name in lost]
    return [*events, *(Event(float(pieces.t[-1]), "contact lost", last, last, name) for name, last in end)]


def _events_of_one(pieces: Any, contact: int, mode: Array, impulses: Any, aloft: Array) -> list[Event]:
    """The events of one contact, given its number, its modes and the pieces on which it flies."""
    of = pieces.layout.contacts[contact]
    thrown = set(nodes_at(pieces, [t for t, jump in impulses if np.ndim(jump) == 0 or np.dot(of.direction, jump) != 0.0]).tolist())
    changed = (np.diff(mode) != 0) & ~aloft[1:] & ~aloft[:-1]
    if of.memory:
        changed |= np.any(np.diff(pieces.memory[:, list(of.memory)], axis=0) != 0, axis=1)
    where = sorted({*(np.flatnonzero(changed) + 1).tolist(), *thrown})
    modes = [(i, int(mode[i - 1]), int(mode[i])) for i in where]
    return [Event(float(pieces.t[i]), kind_of(before, after, i in thrown), before, after, of.name) for i, before, after in modes]


def kind_of(before: int, after: int, thrown: bool = False) -> str:
    """What happened to a contact whose mode has changed."""
    if thrown:
        return "impulse"
    return "switch" if before == after else "stick" if after == 0 else "slip" if before == 0 else "reversal"


def hits_of(pieces: Any, mechanics: Mechanics, speed: float, time: float) -> list[tuple[int, Event]]:
    """Hits on stops with restitution, each with the number of its node, where the gap is closed and its rate jumps.

    `speed` [m/s] and `time` [s] are typical values of the machine.
    """
    inner = np.arange(1, len(pieces.t) - 1)
    t = pieces.t[inner]
    (x, before, _), (_, after, _) = (pieces.evaluate(t, index) for index in (inner - 1, inner))
    q, u, new = (mechanics.coordinates_of(tuple(of.T)) for of in (x, before, after))
    hits = []
    for stop in mechanics.stops:
        gap, rate, left = (np.broadcast_to(of, t.shape) for of in (stop.gap(t, q), stop.rate(t, u), stop.rate(t, new)))
        hit = (rate < 0.0) & (left - rate > 1e-9 * speed) & (abs(gap) <= 1e-6 * speed * time)
        hits += [(int(inner[i]), Event(float(t[i]), "hit", 0, 0, stop.name, float(rate[i]))) for i in np.flatnonzero(hit)]
    return hits


def aloft_of(pieces: Any, laws: Any) -> Array:
    """Whether each contact flies on each piece (pieces, contacts): otherwise its gap is exactly zero there; one law for each contact."""
    aloft = np.zeros(np.shape(pieces.mode), bool)
    for i, (contact, law) in enumerate(zip(pieces.layout.contacts, laws, strict=False)):
        if law.flies:
            aloft[:, i] = np.any(pieces.coefficients[:, list(contact.inner)] != 0.0, axis=(1, 2))
    return aloft


_CLOSED = 1e-12  # of what a gap is on a piece: one that is closed where the piece begins, an instant after its event


def flights_of(pieces: Any, aloft: Array) -> list[tuple[int, Event]]:
    """Take-offs and landings, each with the number of its node; a landing followed by an immediate rebound counts too."""
    flights = []
    for i in np.flatnonzero(aloft.any(axis=0)):
        contact, up, mode = pieces.layout.contacts[i], aloft[:, i], pieces.mode[:, i]
        rate = pieces.coefficients[:, contact.inner[1]]
        before, after = rate[:-1].sum(axis=1), rate[1:, 0]
        gap = abs(pieces.coefficients[1:, contact.inner[0]])
        closed = gap[:, 0] <= _CLOSED * gap.sum(axis=1)  # else a hit elsewhere has thrown up what flies
        thrown = (before < 0.0) & (after >= 0.0) & up[:-1] & closed
        kinds = np.select([~up[:-1] & up[1:], thrown | (up[:-1] & ~up[1:])], ["take-off", "landing"], "")
        for n in np.flatnonzero(kinds != ""):
            speed = float(before[n]) if kinds[n] == "landing" else None
            event = Event(float(pieces.t[n + 1]), str(kinds[n]), int(mode[n]), int(mode[n + 1]), contact.name, speed)
            flights.append((int(n) + 1, event))
    return flights


def nodes_at(pieces: Any, times: ArrayLike) -> Array:
    """Numbers of the inner nodes that lie at given times, within rounding."""
    inner, times = pieces.t[1:-1], np.asarray(times, float)
    if not len(times) or not len(inner):
        return np.empty(0, int)
    right = np.searchsorted(inner, times)
    both = np.clip(np.stack([right - 1, right]), 0, len(inner) - 1)
    near = np.where(abs(inner[both[0]] - times) <= abs(inner[both[1]] - times), *both)
    return np.unique(near[abs(inner[near] - times) <= 1e-12 * float(pieces.t[-1] - pieces.t[0])]) + 1
