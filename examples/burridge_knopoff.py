"""A Burridge-Knopoff row of 1000 blocks: slips in space and time, and the sizes of its events. Draws docs/images/burridge-knopoff.png.

Run: python examples/burridge_knopoff.py [--seconds 2400]   (half a minute to a minute, 2 GB)
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import stickslip as ss

IMAGE = Path(__file__).parents[1] / "docs" / "images" / "burridge-knopoff.png"


@dataclass(frozen=True, eq=False)
class Weakening:
    """The friction of Carlson and Langer: it weakens with the velocity, begins with a drop, and bears any force against the drive."""

    alpha: float
    drop: float

    def sliding(self, v, load):
        """Friction force [N]."""
        return (1 - self.drop) * load * v / abs(v) / (1 + 2 * self.alpha * abs(v) / (1 - self.drop))

    def breakaway(self, load):
        """Its limits at rest [N]."""
        return -1e3 * load, load


@dataclass(frozen=True, eq=False)
class Fault(ss.Machine):
    """Blocks of unit mass, each pulled by a spring of unit stiffness and joined to its neighbours, on a plane that moves away."""

    count: int
    stiffness: float
    speed: float
    friction: Any
    seed: int = 1

    velocity_scale = 1.0

    def bodies(self):
        """The blocks, out of line at random."""
        x = np.random.default_rng(self.seed).uniform(-0.1, 0.1, self.count)
        return {f"b{i}": ss.Body(1.0, position=float(x[i])) for i in range(self.count)}

    def contacts(self):
        """Each block rubs on the plane."""
        return {f"b{i}": ss.Contact(f"b{i}", self.friction, on=-self.speed, load=1.0) for i in range(self.count)}

    def links(self):
        """Springs to what pulls, and between neighbours."""
        pulled = {(f"b{i}", None): ss.Spring(1.0) for i in range(self.count)}
        return pulled | {(f"b{i}", f"b{i + 1}"): ss.Spring(self.stiffness) for i in range(self.count - 1)}


def slips(run: Any) -> np.ndarray:
    """Every slip that has ended: block, beginning and end, in order of the beginnings."""
    number = {name: i for i, name in enumerate(run.contacts)}
    begun: dict[str, float] = {}
    found = []
    for event in run.events:
        if event.kind == "slip":
            begun[event.part] = event.t
        elif event.kind == "stick" and event.part in begun:
            found.append((number[event.part], begun.pop(event.part), event.t))
    return np.array(sorted(found, key=lambda slip: slip[1]))


def quakes(slips: np.ndarray, blocks: int) -> np.ndarray:
    """The event of each slip: slips of neighbours that overlap in time are of one event."""
    owner = np.arange(len(slips))

    def root(k: int) -> int:
        while owner[k] != k:
            owner[k] = owner[owner[k]]
            k = int(owner[k])
        return k

    last: list[list[int]] = [[] for _ in range(blocks)]  # latest slips of each block
    for k, (block, begin, _) in enumerate(slips):
        i = int(block)
        for j in (i - 1, i + 1):
            if 0 <= j < blocks and last[j] and slips[last[j][-1], 2] >= begin:
                owner[root(k)] = root(last[j][-1])
        last[i] = [k]
    return np.array([root(k) for k in range(len(slips))])


def moments(run: Any, slips: np.ndarray, of: np.ndarray, speed: float) -> np.ndarray:
    """The sum of the ways of all blocks of each event, over the plane."""
    way = np.empty(len(slips))
    for first in range(0, len(slips), 1000):
        part = slips[first : first + 1000]
        at = np.arange(len(part)), part[:, 0].astype(int)
        x = [run.pieces.evaluate(t, run._index(t))[0][at] for t in (part[:, 1], part[:, 2])]
        way[first : first + 1000] = x[1] - x[0] + speed * (part[:, 2] - part[:, 1])
    total = np.bincount(of, way, len(slips))
    return total[np.unique(of)]


def fitted(moments: np.ndarray, least: float, most: float) -> tuple[float, float]:
    """The exponent b of a density exp(-b mu) of mu = ln M between two sizes (maximum likelihood), and its standard error."""
    mu = np.log(moments[(moments >= least) & (moments <= most)])
    low, width, mean = np.log(least), np.log(most / least), mu.mean()
    b = np.linspace(-3.0, 6.0, 90_001)
    b[b == 0.0] = 1e-9
    likelihood = np.log(abs(b / (1 - np.exp(-b * width)))) - b * (mean - low)
    best = b[np.argmax(likelihood)]
    curvature = np.gradient(np.gradient(likelihood, b), b)[np.argmax(likelihood)]
    return float(best), float((-curvature * len(mu)) ** -0.5)


#: Between events of one or two blocks and those that run along the row: where the exponent is fitted.
LEAST, MOST = 3e-3, 0.3


def draw(every: np.ndarray, M: np.ndarray, window: tuple[float, float], blocks: int) -> None:
    """Slips in space and time, and the distribution of sizes."""
    import matplotlib.pyplot as plt

    from stickslip.show.figures.style import COLOURS, INK, publication

    begin, end = window
    b, error = fitted(M, LEAST, MOST)
    with publication():
        figure, (where, sizes) = plt.subplots(1, 2, figsize=(8.4, 3.2), layout="constrained")
        of_window = every[(every[:, 2] > begin) & (every[:, 1] < end)]
        where.vlines(of_window[:, 0], of_window[:, 1], of_window[:, 2], color=COLOURS[0], linewidth=0.8)
        where.set(xlabel="block", ylabel="time $t$ (s)", xlim=(0, blocks), ylim=window, title="who slips, and when")
        edges = np.geomspace(2e-4, 2e3, 36)
        counts, _ = np.histogram(M, edges)
        middle, width = np.sqrt(edges[1:] * edges[:-1]), np.diff(np.log(edges))
        density, some = counts / width / len(M), counts > 0
        sizes.loglog(middle[some], density[some], "o", color=COLOURS[0], markersize=3, label="events")
        line = np.array([LEAST, MOST])
        share = np.mean((M >= LEAST) & (M <= MOST))
        height = share * b / (LEAST**-b - MOST**-b)
        sizes.loglog(line, height * line**-b, color=INK, label=f"$b = {b:.2f} \\pm {error:.2f}$")
        sizes.loglog(line, 4 * height * LEAST ** (1 - b) * line**-1.0, color=COLOURS[1], linestyle="--", label="$b = 1$ (shifted)")
        sizes.set(xlabel="size $M$ (m)", ylabel="events per unit of $\\ln M$, of all", title="how large")
        sizes.legend(loc="upper right")
        figure.savefig(IMAGE, dpi=200)


def main() -> None:
    """Solve, print and draw."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=2400.0)
    parser.add_argument("--stiffness", type=float, default=36.0)
    parser.add_argument("--alpha", type=float, default=2.5)
    given = parser.parse_args()
    speed, blocks = 0.01, 1000
    fault = Fault(blocks, given.stiffness, speed, Weakening(given.alpha, drop=0.01))
    began = time.perf_counter()
    run = ss.solve(fault, duration=given.seconds, start={"v": dict.fromkeys((f"b{i}" for i in range(blocks)), -speed)})
    took = time.perf_counter() - began
    print(f"{len(run.events)} changes of mode in {took:.1f} s, {run.counts}")
    every = slips(run)
    of = quakes(every, blocks)
    begins = every[np.unique(of), 1]
    M = moments(run, every, of, speed)[begins > 0.25 * given.seconds]
    print(f"{len(M)} events after a quarter of the run")
    for least, most in ((1e-3, 0.1), (LEAST, MOST), (1e-2, 1.0)):
        b, error = fitted(M, least, most)
        print(f"  between {least:g} and {most:g} m: {np.sum((least <= M) & (most >= M))} events, b = {b:.2f} +- {error:.2f}")
    draw(every, M, (0.5 * given.seconds, 0.5 * given.seconds + 300.0), blocks)


if __name__ == "__main__":
    main()
