"""Which coordinates of a machine are angles modulo a turn in its equations: states that differ by whole turns are then one."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.models.machine_adapter import MachineAdapter

_DRAWS = 6  # states that are compared with those a turn further
_FAR = 4.0 * np.pi  # how large their coordinates are
_SAME = 1e-9  # relative: accelerations and loads that are closer are equal
_LONG = (0.0, 0.7, 3.0, 10.0, 1e2, 1e3)  # distances at which a link between coordinates is asked


def turning(machine: MachineAdapter) -> tuple[int, ...]:
    """The numbers of the coordinates that are angles and that a whole turn leaves alone in all equations.

    What a class calls an angle need not be one of them: a torsion spring, a stop or a controller tells one turn from the next.
    """
    m = machine.mechanics
    if not m.joined or not m.angles or m.controllers.counts or m.stops:
        return ()
    return tuple(j for j, name in enumerate(m.bodies) if name in m.angles and not _held_in_place(m, name) and _comes_again(machine, j))


def _held_in_place(m: Any, name: str) -> bool:
    """Whether a link that ends at a coordinate pulls otherwise at another distance."""
    pulls = [pull for ends, pull in m.pulls if name in ends]
    return any(np.any(pull(0.0, side * far, 0.3) != pull(0.0, 0.0, 0.3)) for pull in pulls for far in _LONG for side in (1.0, -1.0))


def _comes_again(machine: MachineAdapter, j: int) -> bool:
    """Whether accelerations, loads, slips and heights are the same a turn further."""
    m, draw, T = machine.mechanics, np.random.default_rng(0), float(np.max(np.asarray(machine.time_scale or 1.0)))
    for _ in range(_DRAWS):
        q, u = draw.uniform(-_FAR, _FAR, len(m.bodies)).tolist(), draw.uniform(-1.0, 1.0, len(m.bodies)).tolist()
        t, R = draw.uniform(0.0, T), tuple(draw.uniform(-1.0, 1.0, len(m.contacts)).tolist())
        here, further = (_numbers(m, t, tuple(at), tuple(u), R) for at in (q, [x + 2.0 * np.pi * (i == j) for i, x in enumerate(q)]))
        if any(np.any(np.abs(a - b) > _SAME * (1.0 + np.abs(a))) for a, b in zip(here, further, strict=True)):
            return False
    return True


def _numbers(m: Any, t: float, q: tuple[float, ...], u: tuple[float, ...], R: tuple[float, ...]) -> list[Any]:
    """What the equations make of a state."""
    heights = [number for pair in m.heights(t, q, u).values() for number in pair]
    given = (*m.accelerations(t, q, u, R), *m.loads(t, q, u), *m.slips(t, u, q), *heights)
    return [np.asarray(number, float) for number in given]
