"""Basins of blocks on belts without a drive, 200 x 200 starts each, beside runs of some of the starts by SciPy.

Run: python benchmarks/belts.py [--starts 200] [--workers 2] [--judged 60]

Of Stribeck's law, an exponential one and LuGre's: seconds by the clock and of all processors, compiled; the share of starts that come to
stick-slip; and of starts drawn at random what SciPy's integrators say, with how many of them the map says otherwise.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import stickslip as ss
from stickslip.maths import exp, where

K, DAMPING, SPEED, MU, F, V_S, SIGMA0, SIGMA1 = 2.0, 0.3, 0.55, 1.0, 1.5, 0.2, 1e3, 10.0


@dataclass(frozen=True)
class Exponential:
    """Friction that weakens exponentially with the speed of the slip."""

    kinetic: float = MU
    static: float = F
    speed: float = V_S

    def sliding(self, v: Any, load: Any) -> Any:
        """Friction force in a slide [N]."""
        return where(v > 0, 1.0, -1.0) * load * (self.kinetic + (self.static - self.kinetic) * exp(-abs(v) / self.speed))

    def breakaway(self, load: Any) -> Any:
        """Its limits at rest [N]."""
        return -self.static * load, self.static * load


SAME = {"mu_plus": MU, "mu_minus": MU, "f_plus": F, "f_minus": F, "v_s": V_S}
LAWS = {"Stribeck": ss.Stribeck(**SAME), "exponential": Exponential(), "LuGre": ss.LuGre(**SAME, sigma0=SIGMA0, sigma1=SIGMA1, sigma2=0.0)}


def curve(name: str, w: Any) -> Any:
    """Friction force in steady sliding [N]."""
    return MU + (F - MU) * np.exp(-abs(w) / V_S if name == "exponential" else -((w / V_S) ** 2))


def swings_on(name: str, x: float, v: float) -> bool:
    """Whether a start comes to stick-slip, by SciPy: rest is exact under the first two laws, and the third has bristles."""
    bristles = name == "LuGre"

    def slide(t: float, y: Any) -> Any:
        w = y[1] - SPEED
        if not bristles:
            return y[1], curve(name, w) - K * y[0] - DAMPING * y[1]
        rate = w - abs(w) * y[2] * SIGMA0 / curve(name, w)
        return y[1], -K * y[0] - DAMPING * y[1] - SIGMA0 * y[2] - SIGMA1 * rate, rate

    sticks = lambda t, y: y[1] - SPEED  # noqa: E731
    sticks.terminal, sticks.direction = True, 1.0  # type: ignore[attr-defined]
    how = {"method": "Radau", "rtol": 1e-7, "atol": 1e-10} if bristles else {"events": sticks, "rtol": 1e-9, "atol": 1e-11}
    y = np.array([x, v, 0.0][: 2 + bristles])
    for _ in range(400):
        run = solve_ivp(slide, (0.0, 30.0), y, **how)
        y, late = run.y[:, -1], run.y[1][run.t > 15.0]
        if not bristles and len(run.t_events[0]):
            return True
        if np.ptp(late) < 0.05 or (bristles and late.max() > 0.99 * SPEED):
            return bool(np.ptp(late) >= 0.05)
    raise ArithmeticError("neither within 400 times 30 s")


def main() -> None:
    """Print a row for each law."""
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("--starts", type=int, default=200, help="along each side of the map")
    asked.add_argument("--workers", type=int, default=2)
    asked.add_argument("--judged", type=int, default=60, help="starts that SciPy follows")
    given = asked.parse_args()
    x, v = np.linspace(-0.5, 1.5, given.starts), np.linspace(-0.6, 0.5, given.starts)
    for name, law in LAWS.items():
        belt = ss.BlockOnBelt(mass=1.0, stiffness=K, speed=SPEED, friction=law, damping=DAMPING)
        ss.basins(belt, x=x[:2], v=v[:2], settle=40)  # compiled
        clock, spent = time.perf_counter(), time.process_time()
        found = ss.basins(belt, x=x, v=v, settle=40, workers=given.workers)
        clock, spent = time.perf_counter() - clock, time.process_time() - spent
        ours = found.map.attractor.values == [a.kind for a in found.attractors].index("periodic")
        drawn = np.random.default_rng(11).choice(ours.size, min(given.judged, ours.size), replace=False)
        judged = np.array([swings_on(name, x[i], v[k]) for i, k in zip(*np.unravel_index(drawn, ours.shape), strict=True)])
        wrong = int(np.sum(judged != ours.ravel()[drawn]))
        shares = f"stick-slip {ours.mean():.5f}, SciPy {judged.mean():.3f} of {len(judged)}, {wrong} otherwise"
        print(f"{name:12} {clock:6.1f} s by the clock, {spent:6.1f} s of processors; {shares}", flush=True)


if __name__ == "__main__":
    main()
