"""The runs on which tables and figures are based, each solved once."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.results.steadiness import STEADY
from stickslip.show.paper.cases import CASES, EXPERIMENTS, rig

__all__ = ["Runs", "Tell", "batch", "scaled_velocity", "solve_all", "steady_velocity"]

#: Called with (current task, amount done, total amount).
Tell = Callable[[str, int, int], None]


@dataclass(frozen=True, eq=False)
class Runs:
    """All runs whose curves are shown.

    Parameters
    ----------
    coulomb, lugre : dict
        Name of the experiment -> run with exact Coulomb friction (break-away at f0), and with LuGre friction; folded incline.
    gravity : dict
        Name of the experiment -> mean velocity with LuGre on a true incline [m/s].
    figures : dict
        Figure number -> run with LuGre friction.
    twins : dict
        Figure number -> run of the same robot with exact Coulomb friction that breaks away at LuGre's own f0.
    """

    coulomb: dict[str, Any]
    lugre: dict[str, Any]
    gravity: dict[str, float]
    figures: dict[int, Any]
    twins: dict[int, Any]


def solve_all(tell: Tell) -> Runs:
    """Solve every case of the paper: 200 periods from rest, the mean over the second hundred."""
    from stickslip.solvers import solve

    total, runs = 2 * len(EXPERIMENTS) + 2 * len(CASES), Runs({}, {}, _true_incline(), {}, {})
    laws = {"coulomb": "coulomb-static", "lugre": "lugre", "figures": "lugre", "twins": "coulomb-static"}
    jobs: list[tuple[str, Any, Any]] = [(name, e.name, rig(e, law=laws[name])) for e in EXPERIMENTS for name in ("coulomb", "lugre")]
    jobs += [(name, c.figure, rig(c, law=laws[name])) for c in CASES for name in ("figures", "twins")]
    for i, (where, key, robot) in enumerate(jobs):
        tell("solving the paper's cases", i, total)
        getattr(runs, where)[key] = solve(robot, rtol=1e-8)
    tell("solving the paper's cases", total, total)
    return runs


def _true_incline() -> dict[str, float]:
    tilt, A = [e.tilt_deg for e in EXPERIMENTS], [e.amplitude for e in EXPERIMENTS]
    many = batch(rig(EXPERIMENTS[0], tilt_deg=tilt, amplitude=A, incline="gravity"), periods=200, rtol=1e-8)
    return {e.name: float(v) for e, v in zip(EXPERIMENTS, many.mean_velocity, strict=True)}


def batch(robot: Any, **arguments: Any) -> Any:
    """The summary of a batch, solved on all cores (the result does not depend on their number)."""
    from stickslip.solvers import solve

    return solve(robot, **{"keep": "summary", "workers": min(os.cpu_count() or 1, 8), **arguments})


def steady_velocity(many: Any) -> Any:
    """Mean velocities of a batch; NaN where a motion has not settled, or does not repeat."""
    return np.where(many.columns["steadiness"] == STEADY, many.mean_velocity, np.nan)


def scaled_velocity(robot: Any) -> Any:
    """V/(A mu omega) of a batch."""
    return np.asarray(batch(robot, periods=200).mean_velocity) / np.asarray(robot.mass_ratio * robot.velocity_scale)
