"""Does the step control hold far from the paper's point? 10 000 robots, two decades wide in every number, against tight runs.

Run: python verification/random_robots.py [count]. It prints failures and the distribution of the error of the mean velocity over
periods 20 to 30 from rest, relative to max(|V|, 0.05 A mu omega), for several tolerances.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import stickslip as ss

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from problems import random_robots

QUANTILES = (0.5, 0.9, 0.99, 0.999, 1.0)


def main(count: int) -> None:
    """Print one row for each tolerance, over all robots and over those whose motion repeats."""
    robots = random_robots(count)
    unit = 0.05 * np.asarray(robots.velocity_scale * robots.mass_ratio)
    tight = ss.solve(robots, periods=30, settle=20, rtol=1e-10)
    types, counts = np.unique(tight.motion_type, return_counts=True)
    print(f"{count} robots:", ", ".join(f"{t} {n}" for t, n in zip(types, counts, strict=True)), f"; {np.sum(tight.period > 0)} repeat")
    print("rtol      robots    unsolved  " + "  ".join(f"{q:>7.1%}" for q in QUANTILES))
    for rtol in (1e-3, 1e-4, 1e-6, 1e-8):
        found = ss.solve(robots, periods=30, settle=20, rtol=rtol)
        error = abs(found.mean_velocity - tight.mean_velocity) / np.maximum(abs(tight.mean_velocity), unit)
        for name, chosen in (("all", np.isfinite(error)), ("repeat", np.isfinite(error) & (tight.period > 0))):
            row = "  ".join(f"{np.quantile(error[chosen], q):7.1e}" for q in QUANTILES)
            print(f"{rtol:<8.0e}  {name:<8}  {np.sum(found.status > 1):>8}  {row}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000)
