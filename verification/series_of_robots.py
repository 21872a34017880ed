"""Taylor series against Rosenbrock steps: the map of a period of ten thousand random rigs with LuGre friction, and their mean velocities.

With `--law elasto-plastic` the same of that law, without the means.

Every rig settles for 20 periods, then makes one by each method; Rodas5P at 3e-12 is the truth. The bound is 10 times the tolerance, in
units of A mu omega for the velocity, of what that moves the body in a period, and of the typical deflection. Exit code 1 if one is
beyond it.

The mean velocity V is that of the map's fixed point, which Newton's method finds for each method: the error of a map moves its fixed
point by up to ||(I - DP)^-1|| as much. Where this norm is at most 100, V must be within 10 times the tolerance of max(V, .1 A mu omega);
the other rigs are counted, and so are those in which Newton's method finds none.

    python verification/series_of_robots.py [--cases 10000] [--seed 5] [--law elasto-plastic]
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

from stickslip.engine import tableaux
from stickslip.solvers import series

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "engine"))
from test_series import Mapped, drawn, elastic


def main() -> int:
    """Draw, map, compare, say what was found."""
    ask = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ask.add_argument("--cases", type=int, default=10_000)
    ask.add_argument("--seed", type=int, default=5)
    ask.add_argument("--law", choices=("LuGre", "elasto-plastic"), default="LuGre")
    asked = ask.parse_args()
    if asked.law == "elasto-plastic":
        return int(maps(Mapped(elastic(asked.cases, asked.seed)), asked.cases) > 0)
    mapped = Mapped(drawn(asked.cases, asked.seed))
    bad = maps(mapped, asked.cases) + means(mapped, asked.cases)
    return int(bad > 0)


def maps(mapped: Mapped, cases: int) -> int:
    """The map of one period; how many are beyond the bound."""
    truth, bad = mapped.by(tableaux.RODAS5P, 3e-12), 0
    for rtol in (1e-4, 1e-6, 1e-9):
        found = mapped.by(*series.method(rtol))
        error = mapped.apart(found, truth) / rtol
        beyond = np.flatnonzero(~(error <= 10.0))
        bad += len(beyond)
        name, steps, refused = series.method(rtol)[0].name, found.accepted.mean(), found.rejected.mean()
        print(f"rtol {rtol:.0e} ({name}): {steps:.1f} steps, {refused:.2f} refused; {len(beyond)} of {cases} beyond 10 rtol")
        print(f"  median {np.median(error):.3f} rtol, 99 % within {np.quantile(error, 0.99):.2f}, largest {np.max(error):.2f}")
        for k in beyond[:10]:
            print(f"  case {k}: {error[k]:.1f} rtol")
    return bad


def means(mapped: Mapped, cases: int) -> int:
    """Mean velocities; how many are beyond the bound where the motion is well conditioned, one more if too many are not."""
    span, unit, scale = mapped.units[:, 0] / mapped.units[:, 1], mapped.units[:, 1], mapped.units[:, 1:]
    at = mapped.start[:, 1:3].copy()

    def period(start: np.ndarray, *how: object) -> np.ndarray:
        """The map, and the displacement: x, v, z after a period."""
        mapped.start = np.column_stack([np.zeros(cases), start])
        return mapped.by(*how).end[:, :3]

    def slopes(start: np.ndarray) -> np.ndarray:
        """Its derivative in units of A mu omega and of the typical deflection, by central differences."""
        step, found = 1e-5, np.empty((cases, 2, 2))
        for j in range(2):
            move = np.zeros((cases, 2))
            move[:, j] = step * scale[:, j]
            ahead, behind = (period(start + sign * move, tableaux.RODAS5P, 3e-12) for sign in (1, -1))
            found[:, :, j] = (ahead - behind)[:, 1:] / (2 * step * scale)
        return found

    def closed(start: np.ndarray, back: np.ndarray, rounds: int, *how: object) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The fixed point by chords, its mean velocity, and what is left."""
        for _ in range(rounds):
            off = (period(start, *how)[:, 1:] - start) / scale
            start = start + scale * np.einsum("nij,nj->ni", back, off)
        end = period(start, *how)
        return start, end[:, 0] / span, np.max(abs(end[:, 1:] - start) / scale, axis=1)

    for _ in range(4):
        back = np.linalg.inv(np.eye(2) - slopes(at))
        at, truth, left = closed(at, back, 2, tableaux.RODAS5P, 3e-12)
    norm, bad = np.linalg.norm(back, 2, axis=(1, 2)), 0
    good = (norm <= 100.0) & (left * norm <= 1e-9)
    stiff, lost = np.sum(norm > 100.0), np.sum((norm <= 100.0) & ~good)
    print(f"means: {stiff} of {cases} with a norm above 100, {lost} more without a fixed point found")
    for rtol in (1e-4, 1e-6, 1e-9):
        _, found, rest = closed(at, back, 3, *series.method(rtol))
        error = abs(found - truth) / np.maximum(abs(truth), 0.1 * unit) / rtol
        beyond = np.flatnonzero(good & ~(error <= 10.0))
        bad += len(beyond)
        print(f"rtol {rtol:.0e}: {len(beyond)} of {np.sum(good)} beyond 10 rtol; median {np.median(error[good]):.3f} rtol, ", end="")
        print(f"99 % within {np.quantile(error[good], 0.99):.2f}, largest {np.max(error[good]):.2f}")
        for k in beyond[:10]:
            print(f"  case {k}: {error[k]:.1f} rtol, norm {norm[k]:.1f}, left {rest[k]:.1e}")
    return bad + int(np.sum(~good) > 0.02 * cases)


if __name__ == "__main__":
    sys.exit(main())
