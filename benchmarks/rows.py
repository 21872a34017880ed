"""Events per second of rows of many blocks: stickslip, SciPy's solve_ivp with events, and Moreau's time stepping, in one run.

Run: python benchmarks/rows.py [--blocks 100 1000] [--seconds 20]

The rivals are written as someone who knows them would: forces of all blocks as NumPy arrays, one event function that is the least of all
margins. SciPy restarts at each event; it looks for events at the ends of its steps alone, so that blocks which rest for a moment
between two slips escape it unless its steps are short. Moreau's scheme (midpoint, as of Jean) makes a step of fixed length for all
blocks and knows no events; its rate counts the changes of mode that happen in a second of processor time. Errors are those of the
positions at the end, against ours, which the tests check apart.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import stickslip as ss

BETWEEN, PULLER, SPEED, KINETIC, STATIC, V_S = 16.0, 1.0, 0.01, 0.5, 1.0, 0.25
YOUNG = 0.002  # [s]: how long a block that begins to slip is not asked whether it rests; its velocity is within the tolerance at first


@dataclass(frozen=True, eq=False)
class Row(ss.Machine):
    """Blocks on springs, pulled over a plane."""

    offsets: tuple[float, ...]
    friction: Any

    velocity_scale = 1.0

    def bodies(self) -> dict[str, Any]:
        """The blocks."""
        return {f"b{i}": ss.Body(1.0, position=x) for i, x in enumerate(self.offsets)}

    def contacts(self) -> dict[str, Any]:
        """Each rubs on the plane."""
        return {f"b{i}": ss.Contact(f"b{i}", self.friction, on=-SPEED, load=1.0) for i in range(len(self.offsets))}

    def links(self) -> dict[Any, Any]:
        """Springs to what pulls, and between neighbours."""
        n = len(self.offsets)
        pulled: dict[Any, Any] = {(f"b{i}", None): ss.Spring(PULLER) for i in range(n)}
        return pulled | {(f"b{i}", f"b{i + 1}"): ss.Spring(BETWEEN) for i in range(n - 1)}


def springs(x: np.ndarray) -> np.ndarray:
    """Forces of all springs."""
    pull = BETWEEN * np.diff(x)
    force = -PULLER * x
    force[:-1] += pull
    force[1:] -= pull
    return force


def friction(w: np.ndarray) -> np.ndarray:
    """The size of the friction at a slip."""
    return KINETIC + (STATIC - KINETIC) * np.exp(-((w / V_S) ** 2))


def by_scipy(x: np.ndarray, end: float, rtol: float, longest: float, most: float) -> tuple[int, float, float, np.ndarray]:
    """Events, seconds of processor time, and how far it came in at most so many seconds; positions there."""
    n, t, events = len(x), 0.0, 0
    y = np.concatenate([x, np.zeros(n)])
    mode, born = np.ones(n, int), np.full(n, -np.inf)
    began = time.process_time()

    def margins(y: np.ndarray) -> np.ndarray:
        return np.where(mode == 0, STATIC - abs(springs(y[:n])), mode * (y[n:] + SPEED))

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        v = np.where(mode == 0, -SPEED, y[n:])
        return np.concatenate([v, np.where(mode == 0, 0.0, springs(y[:n]) - mode * friction(v + SPEED))])

    def first(t: float, y: np.ndarray) -> float:
        return float(np.where(t < born + YOUNG, np.inf, margins(y)).min())

    first.terminal, first.direction = True, -1  # type: ignore[attr-defined]
    while t < end and time.process_time() - began < most:
        done = solve_ivp(rates, (t, end), y, "DOP853", events=first, rtol=rtol, atol=0.01 * rtol, max_step=longest)
        t, y = float(done.t[-1]), done.y[:, -1]
        if done.status == 1:
            i = int(np.argmin(np.where(t < born + YOUNG, np.inf, margins(y))))
            needed = springs(y[:n])[i]
            new = 0 if mode[i] and abs(needed) <= STATIC else int(np.sign(needed))
            y[n + i], mode[i], born[i] = -SPEED, new, t if new else -np.inf
            events += 1
    return events, time.process_time() - began, t, y[:n]


def by_moreau(x: np.ndarray, end: float, step: float) -> tuple[int, float, np.ndarray]:
    """Changes of mode, seconds of processor time, positions at the end."""
    x, v, changes = x.copy(), np.zeros(len(x)), 0
    slips = np.ones(len(x), bool)
    began = time.process_time()
    for _ in range(round(end / step)):
        x += 0.5 * step * v
        w = v + step * springs(x) + SPEED
        w = np.sign(w) * np.maximum(abs(w) - step * friction(np.where(slips, v + SPEED, 0.0)), 0.0)
        v = w - SPEED
        x += 0.5 * step * v
        now = w != 0.0
        changes += int(np.count_nonzero(now != slips))
        slips = now
    return changes, time.process_time() - began, x


def main() -> None:
    """Print a table for each number of blocks."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--blocks", type=int, nargs="+", default=[100, 1000])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--most", type=float, default=60.0, help="processor seconds for SciPy")
    given = parser.parse_args()
    law = ss.Stribeck(KINETIC, KINETIC, f_plus=STATIC, f_minus=STATIC, v_s=V_S)
    for blocks in given.blocks:
        x = np.random.default_rng(1).uniform(-0.1, 0.1, blocks)
        row = Row(tuple(x.tolist()), law)
        ss.solve(row, duration=1e-3)
        began = time.process_time()
        run = ss.solve(row, duration=given.seconds)
        took, end = time.process_time() - began, run.at(given.seconds)["x"]
        print(f"{blocks} blocks, {given.seconds:g} s: {len(run.events)} events")
        print(f"  stickslip                       {len(run.events) / took:10.0f} events/s   ({took:.2f} s)")
        for rtol, longest in ((1e-6, np.inf), (1e-9, np.inf), (1e-9, 0.01)):
            events, seconds, t, at = by_scipy(x, given.seconds, rtol, longest, given.most)
            wrong = f"positions wrong by {np.max(abs(at - run.at(t)['x'])):.1e} m" + ("" if t == given.seconds else f" at {t:.3g} s")
            rate = f"{events / seconds:10.1f} events/s   ({seconds:.2f} s; {events} events"
            print(f"  SciPy, rtol {rtol:.0e}, steps <= {longest:<4g} {rate}; {wrong})")
        for step in (1e-3, 1e-4):
            changes, seconds, at = by_moreau(x, given.seconds, step)
            wrong = np.max(abs(at - end))
            rate = f"{changes / seconds:10.1f} events/s   ({seconds:.2f} s; {changes} events"
            print(f"  Moreau, steps of {step:.0e} s        {rate}; positions wrong by {wrong:.1e} m)")


if __name__ == "__main__":
    main()
