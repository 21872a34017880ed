"""The runs that tables and figures read, each solved once."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from stickslip.paper.cases import CASES, EXPERIMENTS, rig

__all__ = ["Runs", "Tell", "batch", "solve_all"]

#: Called with (what is being done, how much of it is done, of how much).
Tell = Callable[[str, int, int], None]


@dataclass(frozen=True, eq=False)
class Runs:
    """All runs whose curves are shown.

    Parameters
    ----------
    coulomb, lugre, gravity : dict
        By the name of the experiment: exact Coulomb, folded LuGre, and LuGre on a true incline.
    figures : dict
        By the number of the figure: LuGre.
    twins : dict
        By the number of the figure: the same robot with exact Coulomb friction.
    """

    coulomb: dict[str, Any]
    lugre: dict[str, Any]
    gravity: dict[str, Any]
    figures: dict[int, Any]
    twins: dict[int, Any]


def solve_all(tell: Tell) -> Runs:
    """Solve every case of the paper: 200 periods from rest, the mean over the second hundred."""
    from stickslip.solvers import solve

    total, runs = 3 * len(EXPERIMENTS) + 2 * len(CASES), Runs({}, {}, {}, {}, {})
    jobs = [(where, e.name, rig(e, **kw)) for e in EXPERIMENTS for where, kw in _LAWS]
    jobs += [(where, c.figure, rig(c, law=law)) for c in CASES for where, law in (("figures", "lugre"), ("twins", "coulomb"))]
    for i, (where, key, robot) in enumerate(jobs):
        tell("solving the paper's cases", i, total)
        getattr(runs, where)[key] = solve(robot, rtol=1e-8)
    tell("solving the paper's cases", total, total)
    return runs


_LAWS: tuple[tuple[str, dict[str, str]], ...] = (
    ("coulomb", {"law": "coulomb"}),
    ("lugre", {}),
    ("gravity", {"incline": "gravity"}),
)


def batch(robot: Any, **arguments: Any) -> Any:
    """A batch of which only the numbers are kept, on all cores (the result does not depend on their number)."""
    from stickslip.solvers import solve

    return solve(robot, **{"keep": "summary", "workers": min(os.cpu_count() or 1, 8), **arguments})
