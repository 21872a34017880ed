"""What is lost and gained at single instants of a run: where stops throw bodies back, and where contacts land."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.models.powers import label_of_stop

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


def lost_at_hits(run: Trajectory, mechanics: Any) -> list[tuple[float, float, float, str]]:
    """Instants at which stops throw bodies back, the energy that is lost there and what stops that move give [J], and the stops' names."""
    if not mechanics.stops or len(run.pieces.mode) < 2:
        return []
    nodes, later = run.pieces.t[1:-1], np.arange(1, len(run.pieces.mode))
    before, after = (run._states_at(nodes, index)[1] for index in (later - 1, later))
    thrown = np.any(before != after, axis=1) & ~np.isin(nodes, [t for t, jump in run._impulses if np.any(jump)])
    thrown[[node - 1 for node, _ in run._flights]] = False
    lost = mechanics.kinetic(before) - mechanics.kinetic(after)
    struck, given = dict[int, list[str]](), dict[int, float]()
    for node, event in run._hits:
        struck.setdefault(node, []).append(label_of_stop(mechanics, event.part))
        stop = next(stop for stop in mechanics.stops if stop.name == event.part)
        if stop.part.at is not None:
            jump = mechanics.distance(stop.ends, after[node - 1]) - mechanics.distance(stop.ends, before[node - 1])
            inverse = sum(h * h / float(mass) for h, mass in zip(stop.direction, mechanics.masses, strict=True))
            wall = float(stop.part.motion.velocity(float(run._within(nodes[node - 1], node))))
            given[node] = given.get(node, 0.0) + float(jump) / inverse * wall
    other = [label_of_stop(mechanics, mechanics.stops[0].name)]  # a rate of the gap too small for an event
    which = [(int(i), int(later[i])) for i in np.flatnonzero(thrown)]
    gains = [given.get(node, 0.0) for _, node in which]
    return [
        (float(nodes[i]), float(lost[i]) + gain, gain, " and ".join(struck.get(node, other)))
        for (i, node), gain in zip(which, gains, strict=True)
    ]


def at_landings(run: Any, mechanics: Any) -> list[tuple[float, float, float, float, str]]:
    """Instants at which contacts land, what friction and the hit across take there and what the ground gives [J], and contacts' names.

    An impulse works with the mean of the velocities before and after it.
    """
    landings = []
    for node, event in run._flights:
        i, t = list(run.contacts).index(event.part), run.pieces.t[[node]]
        (x, before, _), (_, after, _) = (run._states_at(t, np.array([piece])) for piece in (node - 1, node))
        q = mechanics.coordinates_of(tuple(x[0]))
        slips = [np.array(mechanics.slips(t[0], mechanics.coordinates_of(tuple(v[0])), q), float)[i] for v in (before, after)]
        mean = 0.5 * (slips[0] + slips[1])
        if mechanics.joined:
            across, along = _impulses(mechanics, i, q, after[0] - before[0])
            rates = [float(mechanics.heights(float(t[0]), q, tuple(v[0]))[event.part][1]) for v in (before, after)]
            given = -along * float(np.asarray(mechanics.offsets(t[0])[i], float))
            landings.append((float(t[0]), along * mean, -across * 0.5 * (rates[0] + rates[1]), given, event.part))
            continue
        gained = float(mechanics.kinetic(after)[0] - mechanics.kinetic(before)[0])
        j = mechanics.coordinate_of(mechanics.joints[event.part].body)
        taken = -float(mechanics.masses[j]) * (slips[1] - slips[0]) * mean
        landings.append((float(t[0]), float(taken), 0.0, gained + float(taken), event.part))
    return landings


def _impulses(mechanics: Any, i: int, q: Any, change: Any) -> tuple[float, float]:
    """The impulses across and along [N s] that make a change of the coordinates' rates at the point of a contact."""
    struck = mechanics.struck(i, q)
    made = np.array([struck.moved_across, [-of for of in struck.moved_along]], float).T
    across, along = np.linalg.lstsq(made, np.asarray(change, float), rcond=None)[0]
    return float(across), float(along)
