"""Modes of each contact of a run over a span of time (sticking, sliding forwards or backwards), and the closed stops."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.analysis.flow_contacts import flow_contact_modes
from stickslip.analysis.motion import DWELL, SLIP_RATIO
from stickslip.analysis.run_segments import WatchedContact, elastic_segments, pieces_within, watched_contacts
from stickslip.basics.contracts import Array
from stickslip.basics.maths import bisected
from stickslip.models.machine_adapter import machine_of

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


Stretch = tuple[float, float, int]  # start and end [s]; +1 forwards, 0 stuck, -1 backwards
PRESSED, FLIGHT = 2, 3  # what stands for the sign while a stop is pressed, and while a contact flies
_GRID, _HALVINGS = 4096, 50
_ROUNDING = 1e-12  # of a span: what is shorter is not a stretch


def contact_modes(run: Trajectory, start: float, end: float) -> dict[str, list[Stretch]]:
    """Each contact's stretches of sticking, sliding and flying over a span of a run, in order, without gaps.

    Under a set-valued law they are the run's own. Under a law with inner states a contact sticks by the rule of `stickslip.motion`: while
    the elastic part of the friction is below a part of its steady sliding value, for at least a part of the drive's period, or of the
    machine's own time where it has no period. In a flow it never sticks under such a law, and the sign is that of its slip.

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.Chain.example(), periods=20)
    >>> found = contact_modes(run, run.t[-1] - run.period_time, run.t[-1])
    >>> {name: [sign for _, _, sign in stretches] for name, stretches in found.items()}
    {'module 1': [-1, 1, -1], 'module 2': [1, 0, -1, 0, 1]}
    """
    if not run.pieces.layout.bodies:
        return {name: _joined(*of, start, end) for name, of in flow_contact_modes(run, start, end).items()}
    aloft = run._columns.aloft
    return {name: _stretches(watched, start, end, aloft[:, i]) for i, (name, watched) in enumerate(watched_contacts(run).items())}


def _stretches(watched: WatchedContact, start: float, end: float, aloft: Array) -> list[Stretch]:
    """The stretches of one contact."""
    run = watched.run
    if not watched.law.has_slip_ratio:
        edges, index = pieces_within(run.pieces, start, end)
        return _joined(edges, np.where(aloft[index], FLIGHT, watched.modes[index].astype(int)), start, end)
    dwell = DWELL * float(machine_of(run.model).time_scale or end - start)
    first, last = float(run.pieces.t[0]), float(run.pieces.t[-1])
    edges, code = elastic_segments(watched, max(start - dwell, first), min(end + dwell, last), SLIP_RATIO)
    return _joined(edges, _signs(edges, code, dwell), start, end)


def _signs(edges: Array, code: Array, dwell: float) -> Array:
    """+1, 0, -1 of segments: elastic ones that last together, or that the run's ends cut off, are stuck; others go with their velocity."""
    signs, elastic = np.sign(code), abs(code) == 1
    bounds = np.flatnonzero(np.diff(elastic.astype(int), prepend=2, append=2))
    for a, b in itertools.pairwise(bounds):
        if elastic[a] and (edges[b] - edges[a] >= dwell or a == 0 or b == len(code)):
            signs[a:b] = 0
    return signs


def _joined(edges: Array, signs: Array, start: float, end: float) -> list[Stretch]:
    """Neighbours of one sign as one stretch, within the span."""
    stretches: list[Stretch] = []
    for a, b, sign in zip(np.maximum(edges[:-1], start), np.minimum(edges[1:], end), signs, strict=True):
        if b - a <= _ROUNDING * (end - start):
            continue
        if stretches and stretches[-1][2] == sign:
            stretches[-1] = (stretches[-1][0], float(b), int(sign))
        else:
            stretches.append((float(a), float(b), int(sign)))
    return stretches


def pressed_stops(run: Trajectory, start: float, end: float) -> dict[str, list[tuple[float, float]]]:
    """From when to when each elastic stop of a machine is pressed within a span [s], by the names of the bodies that meet."""
    mechanics: Any = machine_of(run.model).mechanics
    pressed: dict[str, list[tuple[float, float]]] = {}
    for name, stop in mechanics.named_stops:
        if stop.part.restitution is None:
            pressed[name] = _pressed(run.with_axes, mechanics, stop.ends, stop.part, start, end)
    return pressed


def _pressed(run: Any, mechanics: Any, ends: Any, stop: Any, start: float, end: float) -> list[tuple[float, float]]:
    """Where the gap of one stop is closed."""

    def is_closed(t: Array) -> Array:
        index = run._index(t)
        x = run._states_at(t, index)[0]
        return np.broadcast_to(stop.gap_left(mechanics.distance(ends, x.T), run._columns.within(t, index)), t.shape) < 0.0

    nodes = np.append(run.pieces.t, 0.5 * (run.pieces.t[1:] + run.pieces.t[:-1]))  # a touch may be shorter than the grid
    t = np.union1d(np.linspace(start, end, _GRID), nodes[(nodes > start) & (nodes < end)])
    closed = is_closed(t)
    turns = np.flatnonzero(closed[1:] != closed[:-1])
    before = closed[turns]
    _, high = bisected(lambda middle: is_closed(middle) == before, t[turns], t[turns + 1], _HALVINGS if len(turns) else 0)
    edges = np.concatenate([[start] if closed[0] else [], high, [end] if closed[-1] else []])
    return [(float(a), float(b)) for a, b in edges.reshape(-1, 2)]


def hits(run: Any, start: float, end: float) -> dict[str, list[tuple[float, float]]]:
    """Hits within a span on each stop that throws bodies back, by the bodies that meet: times [s] and rates of the gap [m/s]."""
    hits: dict[str, list[tuple[float, float]]] = {stop.name: [] for stop in machine_of(run.model).mechanics.stops}
    for event in run.events:
        if event.kind == "hit" and start <= event.t <= end:
            hits[event.part].append((event.t, float(event.velocity)))
    return hits


def landings(run: Trajectory, start: float, end: float) -> dict[str, list[float]]:
    """When each contact lands within a span [s], of those that fly."""
    landings: dict[str, list[float]] = {}
    if not run.pieces.layout.bodies:
        return landings
    for _, event in run._columns.flights:
        if event.kind == "landing" and start <= event.t <= end:
            landings.setdefault(event.part, []).append(event.t)
    return landings


def stop_rows(run: Trajectory, start: float, end: float) -> dict[str, tuple[list[Stretch], list[float]]]:
    """For each stop, by a name that no contact has, when it is pressed (sign 2) and when it is hit [s]."""
    if not run.pieces.layout.bodies:  # a flow declares no stops
        return {}
    pressed, struck = pressed_stops(run, start, end), hits(run, start, end)
    return {
        f"{name} (stop)" if name in run.contacts else name: (
            [(a, b, PRESSED) for a, b in pressed.get(name, [])],
            [t for t, _ in struck.get(name, [])],
        )
        for name in dict.fromkeys([*pressed, *struck])
    }
