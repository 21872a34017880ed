"""The atlas of a capsule over frequency and force, against brute force at random points.

Run: python verification/atlas_of_a_capsule.py FOLDER. It draws FOLDER/atlas_capsule.png.
"""

import sys
from collections import Counter
from pathlib import Path

import numpy as np

import stickslip as ss

OVER = {"omega": list(np.linspace(1.05, 1.13, 13)), "force_ratio": list(np.linspace(0.6, 1.2, 9))}
POINTS, STARTS = 100, 16


def by_brute_force(omega, ratio, random):
    """The periods that runs from random starts end with at many points, for 3000 drive periods."""
    model = ss.presets.capsule(omega=np.repeat(omega, STARTS), force_ratio=np.repeat(ratio, STARTS))
    starts = {name: {body: random.uniform(-4, 4, POINTS * STARTS) for body in ("body", "inner")} for name in ("v", "x")}
    runs = ss.solve(model, periods=3000, settle="auto", start=starts, keep="summary")
    return [frozenset(map(int, row)) for row in np.reshape(runs.period, (POINTS, STARTS))]


def main(folder):
    found = ss.atlas(ss.presets.capsule, over=OVER, branches=40, progress=True)
    print(found)
    print(*found.borders, *found.rows(), sep="\n")
    found.plot().figure.savefig(folder / "atlas_capsule.png", dpi=200)
    random = np.random.default_rng(20261123)
    omega, ratio = random.uniform(1.05, 1.13, POINTS), random.uniform(0.6, 1.2, POINTS)
    told = Counter()
    for w, a, periods in zip(omega, ratio, by_brute_force(omega, ratio, random), strict=True):
        words = found.at(omega=w, force_ratio=a)
        there = {int(word.rpartition("period ")[2]) if "period " in word else 0 if "no period" in word else 1 for word in words}
        told["the same" if there == periods else "runs found fewer" if periods < there else "runs found others"] += 1
    print(dict(told))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
