"""Which coordinates of a machine come again in its equations: states that differ by whole turns, or by whole waves of a track, are one."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np

from stickslip.basics.maths import pi
from stickslip.models.machine_adapter import MachineAdapter

TURN = 2.0 * pi
_FAR = 4.0 * np.pi  # how large their coordinates are
_FARTHER = (1.0, 1.0, 1.0, 1.0, 10.0, 100.0)  # times as far, as something may begin there
_SAME = 1e-9  # relative: accelerations and loads that are closer are equal
_LONG = (0.0, 0.7, 3.0, 10.0, 1e2, 1e3)  # distances at which a link between coordinates is asked
_PARTS_OF_A_WAVE = (0.07, 0.23, 0.41, 0.59, 0.83)  # of a wavelength and a period: where the equations are held against the next wave


def lengths_of(machine: MachineAdapter, among: Collection[int] | None = None) -> tuple[float, ...]:
    """After which length each coordinate comes again: a turn of an angle, a wave of a track; infinite where it does not.

    With `among` these coordinates alone are asked.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.models.machine_adapter import machine_of
    >>> flat = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)
    >>> lengths_of(machine_of(flat)), lengths_of(machine_of(ss.Chain.example()))
    ((inf,), (inf, inf))
    """
    every = range(machine.mechanics.coordinates)
    turns, wave = turning(machine, every if among is None else among), wave_of(machine)
    return tuple(TURN if j in turns else wave or np.inf for j in every)


def turning(machine: MachineAdapter, among: Collection[int]) -> tuple[int, ...]:
    """The numbers of the coordinates, of some, that a whole turn leaves alone in all equations, and on a line a part of a turn does not.

    What a class calls an angle need not be one of them: a torsion spring, a stop that it meets, or a controller that holds it or counts its
    turns tells one turn from the next.
    """
    m = machine.mechanics
    if m.coordinates != len(m.bodies):
        return ()
    mays = (j for j in among if (m.bodies[j] in m.angles or not m.joined) and not _held_in_place(m, m.bodies[j]))
    return tuple(j for j in mays if (m.joined or not _comes_again(machine, j, 0.37 * TURN)) and _comes_again(machine, j, TURN))


def _held_in_place(m: Any, name: str) -> bool:
    """Whether a link that ends at a coordinate pulls otherwise at another distance."""
    given = m.pulls if m.joined else [(ends, pull) for (ends, _), pull in zip(m.elastic, getattr(m, "pulls", ()), strict=True)]
    pulls = [pull for ends, pull in given if name in ends]
    return any(np.any(pull(0.0, side * far, 0.3) != pull(0.0, 0.0, 0.3)) for pull in pulls for far in _LONG for side in (1.0, -1.0))


def _comes_again(machine: MachineAdapter, j: int, length: float) -> bool:
    """Whether accelerations, loads, slips, heights, gaps and what controllers do are the same by a length further."""
    m, draw, T = machine.mechanics, np.random.default_rng(0), _time_of(machine)
    for farther in _FARTHER:
        q, u = (farther * draw.uniform(-_FAR, _FAR, len(m.bodies))).tolist(), draw.uniform(-1.0, 1.0, len(m.bodies)).tolist()
        t, R = draw.uniform(0.0, T), tuple(draw.uniform(-1.0, 1.0, len(m.contacts)).tolist())
        z = tuple(draw.uniform(-1.0, 1.0, m.controllers.count).tolist())
        here, further = (_numbers(m, t, tuple(at), tuple(u), R, z) for at in (q, [x + length * (i == j) for i, x in enumerate(q)]))
        if any(np.any(np.abs(a - b) > _SAME * (1.0 + np.abs(a))) for a, b in zip(here, further, strict=True)):
            return False
    return True


def _time_of(machine: MachineAdapter) -> float:
    """A typical time, of several cases the longest [s]."""
    return 1.0 if machine.time_scale is None else float(np.max(np.asarray(machine.time_scale, float)))


def _numbers(m: Any, t: float, q: tuple[float, ...], u: tuple[float, ...], R: tuple[float, ...], z: tuple[float, ...]) -> list[Any]:
    """What the equations make of a state, z those of the controllers."""
    heights = [number for pair in m.heights(t, q, u).values() for number in pair]
    gaps = [stop.gap(t, q) for stop in m.stops]
    given = (*m.accelerations(t, q, u, R, z), *m.loads(t, q, u, z), *m.slips(t, u, q), *heights, *gaps)
    held = (*m.control_rates(t, q, u, z), *m.control_sampled(t, q, u, z)) if z else ()
    return [np.asarray(number, float) for number in (*given, *held)]


def wave_of(machine: MachineAdapter) -> float | None:
    """The distance after which a track repeats [m], if the equations say so too; None where they do not, or of a batch of several."""
    length = machine.wavelength
    if length is None or np.size(length) != 1:
        return None
    length, m, T = float(np.ravel(length)[0]), machine.mechanics, _time_of(machine)
    for part in _PARTS_OF_A_WAVE:
        here, there = (
            (*m.loads(part * T, (q,)), *m.accelerations(part * T, (q,), (0.0,), (0.0,))) for q in (part * length, (1 + part) * length)
        )
        if any(np.any(abs(a - b) > _SAME * (abs(a) + abs(b))) for a, b in zip(here, there, strict=True)):
            return None
    return length
