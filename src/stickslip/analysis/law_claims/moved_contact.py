"""Dissipated work of a contact under prescribed motion."""

from __future__ import annotations

from stickslip.analysis.bench.contact import MovedContact, Velocity, constant_velocity, swing
from stickslip.analysis.bench.probe import Probe

#: A segment of a motion: its duration [s] and its velocity.
Piece = tuple[float, Velocity]


def shaken(probe: Probe, stroke: float, speed: float, cycles: int = 2) -> dict[str, float]:
    """Move a fresh contact to and fro over a stroke with velocity ``speed sin(omega t)``; returns the work as `moved` does."""
    to, fro = (swing(way * stroke, abs(speed)) for way in ((1, -1) if speed > 0 else (-1, 1)))
    return moved(probe, [to, fro] * cycles, last=2)


def burst(probe: Probe, stroke: float, slow: float, fast: float) -> dict[str, float]:
    """Push a fresh contact slowly over a stroke, and then suddenly fast."""
    return moved(probe, [(stroke / abs(v), constant_velocity(v)) for v in (slow, fast)], last=1)


def moved(probe: Probe, pieces: list[Piece], last: int) -> dict[str, float]:
    """Move a fresh contact segment by segment, and account for the work done on it.

    Returns
    -------
    dict
        ``least``: the minimum of the work done on it [J], negative if it returned more than it had received; ``turned``: the integral
        of the absolute power [J]; ``loss`` and ``loss_turned``: the same of the last pieces alone, ``loss`` with its sign [J]; ``force``:
        at the end [N].
    """
    state = MovedContact(probe, probe.load * sum(length for length, _ in pieces) * max(abs(v(0.5 * length)) for length, v in pieces))
    marks = [(0.0, 0.0)]
    for length, velocity in pieces:
        state.follow(length, velocity)
        marks.append((state.done, state.turned))
    loss, turned = (marks[-1][i] - marks[-1 - last][i] for i in (0, 1))
    length, velocity = pieces[-1]
    return {"least": state.least, "turned": state.turned, "loss": loss, "loss_turned": turned, "force": state.force(velocity(0.5 * length))}


def reversed_at_limit(probe: Probe, reach: float, side: float, by: float) -> list[float]:
    """Forces after strokes that reverse where a contact has slid far: each starts anew from the states, changed by a part of them [N]."""
    speed, forces = side * probe.velocity_scale, list[float]()
    contact = MovedContact(probe, probe.load * 20.0 * reach)
    for stroke, way in ((10.0, 1.0), (0.317, -1.0), (0.211, 1.0), (10.0, -1.0), (0.523, 1.0)):  # no two end where a switch is
        anew = MovedContact(probe, contact.work)
        anew.z, anew.mode = tuple(z * (1.0 + by) for z in contact.z), contact.mode
        anew.follow(*swing(way * side * stroke * reach, abs(speed)))
        forces.append(anew.force(way * speed))
        contact = anew
    return forces
