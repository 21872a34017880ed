"""Taylor series against Rosenbrock steps: the map of one period of ten thousand random rigs with LuGre friction, at three tolerances.

Every rig settles for 20 periods, then makes one by each method; Rodas5P at 3e-12 is the truth. The bound is 10 times the tolerance, in
units of A mu omega for the velocity, of what that moves the body in a period, and of the typical deflection. Exit code 1 if one is
beyond it.

    python verification/series_of_robots.py [--cases 10000] [--seed 5]
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
from test_series import Mapped, drawn


def main() -> int:
    """Draw, map, compare, say what was found."""
    ask = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ask.add_argument("--cases", type=int, default=10_000)
    ask.add_argument("--seed", type=int, default=5)
    asked = ask.parse_args()
    mapped = Mapped(drawn(asked.cases, asked.seed))
    truth, bad = mapped.by(tableaux.RODAS5P, 3e-12), 0
    for rtol in (1e-4, 1e-6, 1e-9):
        found = mapped.by(*series.method(rtol))
        error = mapped.apart(found, truth) / rtol
        beyond = np.flatnonzero(~(error <= 10.0))
        bad += len(beyond)
        name, steps, refused = series.method(rtol)[0].name, found.accepted.mean(), found.rejected.mean()
        print(f"rtol {rtol:.0e} ({name}): {steps:.1f} steps, {refused:.2f} refused; {len(beyond)} of {asked.cases} beyond 10 rtol")
        print(f"  median {np.median(error):.3f} rtol, 99 % within {np.quantile(error, 0.99):.2f}, largest {np.max(error):.2f}")
        for k in beyond[:10]:
            print(f"  case {k}: {error[k]:.1f} rtol")
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
