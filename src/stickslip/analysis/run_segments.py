"""The raw segments of the last motion period of one trajectory, as `stickslip.results.segments` wants them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.maths import bisected
from stickslip.models.contact_forces import held_by_controllers, places_of
from stickslip.models.forces import columns, slip_ratio
from stickslip.models.friction.law_adapter import TINY, LawAdapter
from stickslip.models.machine_adapter import machine_of
from stickslip.models.state_layout import of_one_contact

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


_NODES = 9  # samples of the slip ratio on each piece; a crossing is then bisected


@sealed
@dataclass(frozen=True, eq=False)
class Segments:
    """The segments of one case: durations in drive periods, codes, and the margin of the forces."""

    time: Array
    code: Array
    margin_force: float

    def rows(self) -> tuple[Array, Array, Array]:
        """seg_count, seg_time and seg_code of a batch of one."""
        return np.array([len(self.time)]), self.time[None, :], self.code[None, :]


class WatchedContact:
    """One contact of a run, by its number, as its segments are taken from it."""

    def __init__(self, run: Trajectory, number: int = 0):
        self.run, self.number, self.modes = run.with_axes, number, run.pieces.mode[:, number]
        self.mechanics = machine_of(run.model).mechanics
        places = places_of(self.mechanics)
        self.place = None if places is None else places[number]

    @property
    def law(self) -> LawAdapter:
        """The law of the contact."""
        return self.mechanics.laws[self.number]

    @property
    def slip(self) -> Array:
        """Slip velocity at the instants of the run's columns [m/s]."""
        return np.asarray(self.run.slip[:, self.number])

    def slip_ratio(self, t: Array, index: Array) -> Array:
        """Elastic part of the friction over its steady sliding value: 0 in elastic deflection, 1 in steady sliding."""
        run, i = self.run, self.number
        states = x, v, z = run._states_at(t, index)
        if self.law.flies:
            column = run._columns.forces_at(t, index, *states)
            slip, load = column["slip"][:, i], column["load"][:, i]
        else:
            q, u = (self.mechanics.coordinates_of(tuple(of.T)) for of in (x, v))
            slip, load = self.mechanics.slips(t, u, q)[i], self._load(t, x, v, z)
        memory = run.pieces.memory[index][:, list(run.pieces.layout.contacts[i].memory)]
        speed, inner = machine_of(run.model).velocity_scale, z[:, i, : self.law.states].T
        return np.asarray(slip_ratio(self.law, speed, self.modes[index], slip, load, inner, tuple(memory.T)))

    def offered(self, t: Array) -> Array:
        """Friction force that would hold the contact while the others do what they do [N]."""
        run, index = self.run, self.run._index(t)
        x, v, z = run._states_at(t, index)
        if self.place is not None:  # what acts on its coordinate decides alone
            m, none = self.mechanics, (0.0,) * len(run.contacts)
            q, u = (m.coordinates_of(tuple(of.T)) for of in (x, v))
            free = m.accelerations(t, q, u, none, held_by_controllers(m, z))[self.place]
            return np.broadcast_to(m.masses[self.place] * (free + m.offset_rates(t)[self.number]), t.shape)
        mode = np.array(run.pieces.mode[index])
        mode[:, self.number] = 0
        rates, memory = np.zeros_like(z), tuple(run.pieces.memory[index].T)
        held = columns(run.model, mode, t, x, v, np.moveaxis(z, -1, 0), np.moveaxis(rates, -1, 0), memory)
        return np.asarray(held["friction_force"][:, self.number])

    def limits(self, t: Array) -> tuple[Array, Array]:
        """Static friction limits backwards and forwards [N]."""
        states = x, v, z = self.run._states_at(t, self.run._index(t))
        if not any(self.mechanics.of_motion):
            low, high = self.law.breakaway(self._load(t, *states))
        else:  # of a body about to go backwards, and forwards
            near = [np.where(abs(v) > TINY, v, side * TINY) for side in (-1.0, 1.0)]
            low, high = (self.law.breakaway(self._load(t, x, moving, z))[k] for k, moving in enumerate(near))
        return np.broadcast_to(low, t.shape), np.broadcast_to(high, t.shape)

    def _load(self, t: Array, x: Array, v: Array, z: Array) -> Any:
        m = self.mechanics
        q, u = (m.coordinates_of(tuple(of.T)) for of in (x, v))
        return m.load(self.number, t, q, u, held_by_controllers(m, z))


def watched_contacts(run: Trajectory) -> dict[str, WatchedContact]:
    """The contacts of a run by name."""
    return {name: WatchedContact(run, i) for i, name in enumerate(run.contacts)}


def raw_segments(watched: WatchedContact, period: int, slip_ratio: float) -> Segments:
    """Segments of a contact over the last `period` drive periods of its run."""
    run = watched.run
    end = float(run.pieces.t[-1])
    start = max(end - period * run.period_time, float(run.pieces.t[0]))
    edges, code, index = segments_within(watched, start, end, slip_ratio)
    margin = np.inf if index is None or watched.law.dynamic else _force_margin(watched, edges, index)
    return Segments(np.diff(edges) / run.period_time, code, margin)


def segments_within(watched: WatchedContact, start: float, end: float, slip_ratio: float) -> tuple[Array, Array, Array | None]:
    """Ends and codes of a contact's segments within a span, and their pieces of the run where each is one."""
    if watched.law.has_slip_ratio:
        return *elastic_segments(watched, start, end, slip_ratio), None
    edges, index = pieces_within(watched.run.pieces, start, end)
    return edges, 2 * watched.modes[index].astype(int), index


def shares(run: Trajectory) -> dict[str, float]:
    """Parts of a whole run's time in which the contact slides forwards and backwards, and in which it sticks."""
    run = of_one_contact("shares", run, "they are the parts of one contact's time")
    lengths, modes = np.diff(run.pieces.t), run.pieces.mode[:, 0]
    return {name: float(lengths[modes == mode].sum() / lengths.sum()) for name, mode in (("forward", 1), ("backward", -1), ("stick", 0))}


def pieces_within(pieces: Any, start: float, end: float) -> tuple[Array, Array]:
    """Ends of the pieces within a span, and the number of each."""
    first, last = int(np.searchsorted(pieces.t, start, side="right")) - 1, int(np.searchsorted(pieces.t, end, side="left"))
    index = np.arange(max(first, 0), max(last, 1))
    edges = np.concatenate([[start], pieces.t[index[1:]], [end]])
    return edges, index


# ---- dynamic laws: where does the bristle yield? ----
def elastic_segments(watched: WatchedContact, start: float, end: float, slip_ratio: float) -> tuple[Array, Array]:
    """Ends and codes of the segments within a span: +2, -2 slipping, +1, -1 elastic."""
    edges, index = pieces_within(watched.run.pieces, start, end)
    left, span = edges[:-1], np.diff(edges)
    t = left[:, None] + span[:, None] * np.linspace(0.0, 1.0, _NODES)
    above = (watched.slip_ratio(t.ravel(), np.repeat(index, _NODES)) >= slip_ratio).reshape(t.shape)
    row, col = np.nonzero(above[:, 1:] != above[:, :-1])
    crossings = _bisected(watched, t[row, col], t[row, col + 1], index[row], above[row, col], slip_ratio)
    begins, yielding = np.concatenate([left, crossings]), np.concatenate([above[:, 0], above[row, col + 1]])
    side = watched.modes[np.concatenate([index, index[row]])].astype(int)
    order = np.argsort(begins, kind="stable")
    times, codes = begins[order], (side * (1 + yielding))[order]
    new = np.flatnonzero(np.diff(codes, prepend=99))
    return np.append(times[new], end), codes[new]


def _bisected(watched: WatchedContact, low: Array, high: Array, index: Array, above_low: Array, slip_ratio: float) -> Array:
    """Where the slip ratio crosses its threshold, to the last bit of t."""
    if len(low) == 0:
        return low
    low, high = bisected(lambda t: (watched.slip_ratio(t, index) >= slip_ratio) == above_low, low, high, 52)
    return 0.5 * (low + high)


# ---- set-valued laws: distance of the net applied force from break-away ----
def _force_margin(watched: WatchedContact, edges: Array, index: Array) -> float:
    """Smallest relative distance to break-away, at reversals without rest and at extremes of the net applied force during rest."""
    mode = watched.modes[index]
    reversals = edges[1:-1][(mode[1:] * mode[:-1]) == -1]
    cyclic = mode[0] * mode[-1] == -1
    times = [np.append(reversals, edges[-1]) if cyclic else reversals]
    starts = np.flatnonzero((mode == 0) & (np.roll(mode, 1) != 0) | (mode == 0) & (np.arange(len(mode)) == 0))
    for first in starts:
        last = first
        while last + 1 < len(mode) and mode[last + 1] == 0:
            last += 1
        times.append(_extremes(watched, edges[first], edges[last + 1]))
    t = np.concatenate(times)
    if not len(t):
        return float("inf")
    offered = watched.offered(t)
    with np.errstate(divide="ignore", invalid="ignore"):
        distances = [abs(offered / limit - 1) for limit in watched.limits(t)]
    return float(np.nanmin(np.minimum(*distances), initial=np.inf))


def _extremes(watched: WatchedContact, start: float, end: float) -> Array:
    """Times inside a rest at which the net applied force has an extreme (parabolas, sharpened twice)."""
    t = np.linspace(start, end, 257)
    F = watched.offered(t)
    rise = np.sign(np.diff(F))
    middle, step = t[1:-1][rise[1:] * rise[:-1] < 0], t[1] - t[0]
    for _ in range(3):
        sides = np.stack([middle - step, middle, middle + step])
        a, b, c = watched.offered(sides.ravel()).reshape(sides.shape)
        bend = a - 2 * b + c
        middle = middle + np.where(bend != 0, 0.5 * (a - c) / np.where(bend != 0, bend, 1.0), 0.0) * step
        step = step * 0.1
    return middle
