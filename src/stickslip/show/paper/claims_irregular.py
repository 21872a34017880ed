"""Claims of section 5.3 about small kinetic friction: quasi-periodic at 0.03, period two at 0.04."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from stickslip.basics.phrases import listed
from stickslip.show.paper.cases import AMPLITUDE_5, CASES, rig
from stickslip.show.paper.claims_page import ClaimData, PaperClaim, judged
from stickslip.show.paper.followed_motions import stable_range
from stickslip.show.paper.solved_runs import batch
from stickslip.show.reports.html import grouped

__all__ = ["period_two", "quasi_periodic", "rk4_ladder"]

#: Steps per period of the fixed-step comparison; the last few only in the full run.
STEPS = (500, 1000, 1500, 2000, 2500, 3000, 5000, 10_000, 20_000, 50_000)
FAST_STEPS = (500, 1000, 2000, 3000, 5000)
#: Further step counts, with the numbers of periods.
LONG_STEPS = ((200_000, 200), (1_000_000, 40))
#: Forward starting velocities at mu0 = 0.03, in units of A omega.
STARTS = (0.05, 0.1, 0.3, 0.5)
TOLERANCES = (1e-6, 1e-8, 1e-10)
FIG22, FIG23 = (next(c for c in CASES if c.figure == n) for n in (22, 23))


def rk4_ladder(study: ClaimData) -> list[dict[str, Any]]:
    """Classical RK4 at mu0 = 0.03 against steps per period: mean velocity and period number if the solution stays finite.

    The rows are those of `ss.solve(robot, method="rk4", steps=N, keep="summary")`; verification/rk4_at_mu0_03.py prints those at 0.6 mm.
    """
    ladder = []
    plan = [(n, 200) for n in (FAST_STEPS if study.fast else STEPS)] + ([] if study.fast else list(LONG_STEPS))
    for i, (steps, periods) in enumerate(plan):
        study.tell(f"Runge-Kutta with {grouped(steps)} steps per period at μ₀ = 0.03", i, len(plan))
        many = batch(rig(FIG22), method="rk4", steps=steps, periods=periods, workers=1)
        velocity, period = (float(many.mean_velocity), int(many.period)) if int(many.status) <= 1 else (None, None)
        ladder.append({"steps": steps, "periods": periods, "velocity": velocity, "period": period})
    return ladder


def _converged(case: Any, method: str = "auto") -> list[tuple[float, float, int]]:
    """Tolerance, mean velocity and period number of a case."""
    many = [(rtol, batch(rig(case), rtol=rtol, method=method, periods=200)) for rtol in TOLERANCES]
    return [(rtol, float(m.mean_velocity), int(m.period)) for rtol, m in many]


def _forward_starts() -> dict[float, int]:
    """Starting velocity over A omega -> drive periods until the strobe velocity stays within 1e-3 A mu omega of its last value."""
    from stickslip.solvers import solve

    robot, settled = rig(FIG22), {}
    scale = float(robot.velocity_scale)
    for share in STARTS:
        run = solve(robot, start={"v": share * scale}, periods=150, rtol=1e-6)
        v = run.at(run.strobe_times)["v"]
        far = np.flatnonzero(abs(v - v[-1]) > 1e-3 * scale * float(robot.mass_ratio))
        settled[share] = int(far[-1]) + 1 if len(far) else 0
    return settled


def _steps(rows: list[dict[str, Any]]) -> str:
    """The steps per period in words."""
    return f"{listed(grouped(r['steps']) for r in rows)} steps" if rows else "none of the step sizes"


def quasi_periodic(study: ClaimData) -> PaperClaim:
    """Quasi-periodic at mu0 = 0.03."""
    wide = stable_range("amplitude", 1.25e-3, 3e-4, 1.25e-3, step=0.1, rtol=1e-6, fixed={"mu0": 0.03})
    ours, judge, ladder = _converged(FIG22), [] if study.fast else _converged(FIG22, "rodas4"), rk4_ladder(study)
    best, finite = ours[-1][1], [r for r in ladder if r["velocity"] is not None]
    wrong = [r for r in finite if abs(r["velocity"] / best - 1) > 0.1]
    numbers = {
        "converged": ours,
        "second_method": judge,
        "rk4": ladder,
        "period_one_from": wide.low.value,
        "period_one_to": wide.high.value,
        "largest_multiplier": wide.multiplier,
        "periods_to_settle": _forward_starts(),
    }
    return judged(
        "quasi_periodic",
        wide.low.kind != "range" and all(p == 0 for _, _, p in ours),
        numbers,
        repeats=sorted({p for _, _, p in [*ours, *judge]}),
        best=best,
        spread=max(abs(v / best - 1) for _, v, _ in [*ours, *judge]),
        motion=study.motions[22],
        low=wide.low,
        law=rig(FIG22).friction,
        wrong=wrong,
        right=[r for r in finite if r not in wrong],
        irregular=[r for r in wrong if r["period"] == 0],
        backwards=[r for r in wrong if r["velocity"] < 0],
        steps=_steps,
    )


def period_two(study: ClaimData) -> PaperClaim:
    """Period two at mu0 = 0.04."""
    ours, stable, near = _converged(FIG23), study.amplitudes.section5.period_two, study.around
    rows, known = study.amplitudes.section5.round_values, [end.accuracy for end in (stable.low, stable.high) if end.accuracy]
    numbers = {
        "converged": ours,
        "interval": dataclasses.asdict(stable),
        "round_values": rows,
        "flips": near.flips,
        "shares": near.shares,
    }
    return judged(
        "period_two",
        all(p == 2 for _, _, p in ours),
        numbers,
        [(r["period"] == 2, {"r": r}) for r in rows],
        repeats=sorted({p for _, _, p in ours}),
        stable=stable,
        near=near,
        motion=study.motions[23],
        accuracy=max(known) if len(known) == 2 else None,
        A=AMPLITUDE_5,
    )
