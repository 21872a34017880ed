"""What a fixed step makes of Figure 22 (mu0 = 0.03): the rows of the table in docs/why-not-rk4.md.

Run: python verification/rk4_at_mu0_03.py. The steps are those of `stickslip paper`; mean velocity and period are those of
`ss.solve(robot, method="rk4", steps=N, keep="summary")`, over the second half of the run, from rest.
"""

from __future__ import annotations

from typing import Any

import stickslip as ss
from stickslip.show.paper.claims_irregular import LONG_STEPS, STEPS


def row(name: str, periods: int, found: Any) -> str:
    """One line of the table."""
    velocity = f"{float(found.mean_velocity):+.6f}".replace("-", "−") if int(found.status) <= 1 else "diverged"
    return f"| {name} | {periods} | {velocity} | {int(found.period) or 'none'} |"


def main() -> None:
    """Print the table in Markdown."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, mu0=0.03)
    print("| RK4 steps per period | periods run | mean velocity [m/s] | period |\n|---|---|---|---|")
    for steps, periods in [*((n, 200) for n in STEPS), *LONG_STEPS]:
        found = ss.solve(robot, method="rk4", steps=steps, periods=periods, keep="summary")
        print(row(f"{steps:,}".replace(",", " "), periods, found))
    print(row("**converged**", 200, ss.solve(robot, rtol=1e-10, periods=200, keep="summary")))


if __name__ == "__main__":
    main()
