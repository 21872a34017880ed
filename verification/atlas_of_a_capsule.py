"""The atlas of a capsule over frequency and force, against brute force at random points.

Run: python verification/atlas_of_a_capsule.py FOLDER (ten minutes). It draws FOLDER/atlas_capsule.png.
"""

import sys
from collections import Counter
from pathlib import Path
from time import process_time

import numpy as np

import stickslip as ss
from stickslip.dynamics.stroboscopic.strobe_maps import strobe_map, strobe_orbit

OVER = {"omega": list(np.linspace(1.05, 1.13, 13)), "force_ratio": list(np.linspace(0.6, 1.2, 9))}
POINTS, STARTS = 300, 16


def by_brute_force(omega, ratio, random):
    """Period and mean velocity of the motions that runs from random starts end with at many points, after 1000 drive periods.

    The period is the smallest shift by which 64 strobe points agree to 1e-5. (`ss.solve` stops a run as soon as it repeats, and now
    and then names a multiple of the period there, by which points agree earlier.)
    """
    model = ss.presets.capsule(omega=np.repeat(omega, STARTS), force_ratio=np.repeat(ratio, STARTS))
    settled = strobe_map(model, random.uniform(-4, 4, (POINTS * STARTS, 3)), 1000, 1e-7).state
    strobe, ways = strobe_orbit(model, settled, 64, 1e-7)
    assert np.isfinite(strobe).all()
    motions = []
    for row, way, T in zip(np.moveaxis(strobe, 0, 1), ways.T, model.period, strict=True):
        p = next((p for p in range(1, 33) if np.all(abs(row[p:] - row[:-p]) < 1e-5)), 0)
        motions.append((p, round(float(way[-(p or 64) :].mean() / T), 5) if p else 0.0))
    return [sorted({motions[k * STARTS + i] for i in range(STARTS)}) for k in range(POINTS)]


def periods_of(words):
    """The periods of motions, by their names."""
    none = ("chaotic", "quasi-periodic")
    return sorted(int(word.rpartition("period ")[2]) if "period " in word else int(word not in none) for word in words)


def random_places():
    """Random places of the plane, each with the motions that runs end with there."""
    random = np.random.default_rng(20261123)
    omega, ratio = random.uniform(1.05, 1.13, POINTS), random.uniform(0.6, 1.2, POINTS)
    return [
        ({"omega": float(w), "force_ratio": float(a)}, runs)
        for w, a, runs in zip(omega, ratio, by_brute_force(omega, ratio, random), strict=True)
    ]


def compared(found, places):
    """How many random places have the motions that the atlas tells, of those that it is sure of and of those in doubt."""
    told = Counter()
    for here, runs in places:
        there, reached = Counter(periods_of(found.at(**here))), Counter(p for p, _ in runs)
        same = "the same" if there == reached else "runs found fewer" if reached <= there else "runs found others"
        told[same, "in doubt" if found.doubt(**here) else "sure"] += 1
        if same == "runs found others" and not found.doubt(**here):
            print("wrong:", here, dict(there), runs)
    return dict(told)


def main(folder):
    places = random_places()
    for branches, refine in ((0, 0), (0, 1), (0, 2), (40, 0), (40, 2)):
        began = process_time()
        found = ss.atlas(ss.presets.capsule, over=OVER, branches=branches, refine=refine, out=folder / "kept", resume=True)
        print(
            f"{branches} branches, cells halved {refine} times: {process_time() - began:.0f} s more,", compared(found, places), flush=True
        )
    print(found)
    print(*found.borders, *found.rows(), sep="\n")
    found.plot().figure.savefig(folder / "atlas_capsule.png", dpi=200)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
