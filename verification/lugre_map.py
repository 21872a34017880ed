"""How wrong is a map? 512 x 512 cases of the paper's rig with LuGre friction over amplitude and frequency, 1000 of them solved again.

The map is made by `ss.sweep` with its default tolerance. Random cells are solved again a thousand times tighter, and a few of those
once more by SciPy's Radau, which shares no stepping with us. The bound is |dV| <= 1e-4 max(|V|, 0.01 A mu omega) in every cell that has
a period. Says how many have none.

    python verification/lugre_map.py [--size 512] [--cells 1000] [--judged 5]
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import stickslip as ss

BOUND, FLOOR = 1e-4, 0.01


def axes(size: int) -> dict[str, np.ndarray]:
    """The plane: A from 0.1 to 0.8 mm, omega from 60 to 300 rad/s."""
    return {"amplitude": np.linspace(0.1e-3, 0.8e-3, size), "omega": np.linspace(60.0, 300.0, size)}


def cells(grid, count: int, seed: int = 4):
    """Random cells as one design, and what the map says of them."""
    rng = np.random.default_rng(seed)
    i, j = (rng.integers(grid.sizes[d], size=count) for d in ("amplitude", "omega"))
    picked = ss.designs.zipped(amplitude=grid.amplitude.values[i], omega=grid.omega.values[j])
    return picked, grid.mean_velocity.values[i, j], grid.period.values[i, j]


def unit(picked) -> np.ndarray:
    """A mu omega of each cell [m/s]."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=1e-4)
    return float(robot.mass_ratio) * picked.columns["amplitude"] * picked.columns["omega"]


def main() -> int:
    """Make the map, check it, say what was found."""
    ask = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, default in (("size", 512), ("cells", 1000), ("judged", 5), ("workers", 2)):
        ask.add_argument(f"--{name}", type=int, default=default)
    asked = ask.parse_args()
    began, cpu = time.perf_counter(), time.process_time()
    grid = ss.sweep(ss.presets.piezo_rig, **axes(asked.size), tilt_deg=1.7, law="lugre", workers=asked.workers)
    print(f"map: {grid.mean_velocity.size} cases in {time.perf_counter() - began:.1f} s ({time.process_time() - cpu:.1f} s of CPU)")
    print(f"cells without a period: {int((grid.period == 0).sum())}; not solved: {int((grid.status > 1).sum())}")
    picked, V, period = cells(grid, asked.cells)
    tight = ss.sweep(ss.presets.piezo_rig, picked, tilt_deg=1.7, law="lugre", rtol=1e-9, periods=2000, workers=asked.workers)
    both = (period > 0) & (tight.period.values > 0)
    error = abs(V - tight.mean_velocity.values) / np.maximum(abs(tight.mean_velocity.values), FLOOR * unit(picked))
    print(f"{both.sum()} of {asked.cells} cells have a period (the tight runs find none in {int((tight.period == 0).sum())})")
    for share in (50, 90, 99, 100):
        print(f"  {share:3d} % of them are within {np.percentile(error[both], share):.2e} of max(|V|, {FLOOR} A mu omega)")
    bad = both & ~(error <= BOUND)
    for k in np.flatnonzero(bad)[:10]:
        point = ", ".join(f"{n} = {c[k]:.9g}" for n, c in picked.columns.items())
        print(f"  beyond the bound: {point}: V = {V[k]:.9g}, tight {tight.mean_velocity.values[k]:.9g}, period {period[k]}")
    judge(picked, tight, np.flatnonzero(both)[: asked.judged])
    print("ok" if not bad.any() else f"{bad.sum()} cells beyond {BOUND:g}")
    return int(bad.any())


def judge(picked, tight, which) -> None:
    """Some cells by SciPy's Radau."""
    for k in which:
        robot = ss.presets.piezo_rig(tilt_deg=1.7, **{n: float(c[k]) for n, c in picked.columns.items()})
        run = ss.solve(robot, periods=30, settle=20, method="radau", rtol=1e-8)
        print(f"  Radau: V = {ss.mean_velocity(run):.9g}, tight {float(tight.mean_velocity[k]):.9g}")


if __name__ == "__main__":
    raise SystemExit(main())
