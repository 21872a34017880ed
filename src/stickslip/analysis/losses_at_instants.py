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
    thrown = np.any(before != after, axis=1) & ~np.isin(nodes, [t for t, jump in run._columns.impulses if np.any(jump)])
    thrown[[node - 1 for node, _ in run._columns.flights]] = False
    lost = mechanics.kinetic(before) - mechanics.kinetic(after)
    struck, given = dict[int, list[str]](), dict[int, float]()
    for node, event in run._columns.hits:
        struck.setdefault(node, []).append(label_of_stop(mechanics, event.part))
        stop = next(stop for stop in mechanics.stops if stop.name == event.part)
        if stop.part.at is not None:
            jump = mechanics.distance(stop.ends, after[node - 1]) - mechanics.distance(stop.ends, before[node - 1])
            inverse = sum(h * h / float(mass) for h, mass in zip(stop.direction, mechanics.masses, strict=True))
            wall = float(stop.part.motion.velocity(float(run._columns.within(nodes[node - 1], node))))
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
    landings: list[tuple[float, float, float, float, str]] = []
    done = set[int]()
    for node, event in run._columns.flights:
        i, t = list(run.contacts).index(event.part), run.pieces.t[[node]]
        (x, before, _), (_, after, _) = (run._states_at(t, np.array([piece])) for piece in (node - 1, node))
        q = mechanics.coordinates_of(tuple(x[0]))
        slips = np.array([mechanics.slips(t[0], mechanics.coordinates_of(tuple(v[0])), q) for v in (before, after)], float)
        if mechanics.joined:
            if event.kind == "landing" and node not in done:
                done.add(node)
                landings += _in_plane(mechanics, float(t[0]), q, before[0], after[0], slips)
            continue
        mean = 0.5 * (slips[0, i] + slips[1, i])
        gained = float(mechanics.kinetic(after)[0] - mechanics.kinetic(before)[0])
        j = mechanics.coordinate_of(mechanics.joints[event.part].body)
        taken = -float(mechanics.masses[j]) * (slips[1, i] - slips[0, i]) * mean
        landings.append((float(t[0]), float(taken), 0.0, gained + float(taken), event.part))
    return landings


def _in_plane(mechanics: Any, t: float, q: Any, before: Any, after: Any, slips: Any) -> list[tuple[float, float, float, float, str]]:
    """The same of a hit of a point of a body, at all points and rails: their impulses make the change of the coordinates' rates."""
    pressed = [i for i, contact in enumerate(mechanics.touching) if contact.is_held]
    made = {(i, "across"): mechanics.struck(i, q).moved_across for i in pressed if mechanics.touching[i].keeps_height}
    made |= {(i, "along"): [-each for each in mechanics.loosely_pushed(0.0, q, mechanics.rows(0.0, q)[i])] for i in pressed}
    columns = np.array([[float(np.ravel(each)[0]) for each in of] for of in made.values()]).T
    impulses = dict(zip(made, np.linalg.lstsq(columns, np.asarray(after - before, float), rcond=1e-10)[0], strict=True))
    heights = [mechanics.heights(t, q, tuple(v)) for v in (before, after)]
    losses = []
    for i in pressed:
        name, across, along = mechanics.contacts[i], impulses.get((i, "across"), 0.0), impulses[i, "along"]
        up = 0.5 * sum(float(height[name][1]) for height in heights) if name in heights[0] else 0.0
        given = -along * float(np.asarray(mechanics.offsets(t)[i], float))
        losses.append((t, float(along * slips[:, i].mean()), float(-across * up), given, name))
    return losses
