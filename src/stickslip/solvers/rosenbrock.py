"""Dynamic laws: Rosenbrock steps in lanes, one engine for one case and for a million."""

from __future__ import annotations

from stickslip.engine import tableaux
from stickslip.solvers import stepping
from stickslip.solvers.request import Request
from stickslip.summary import Summary
from stickslip.trajectory import Trajectory

__all__ = ["method", "solve"]

#: At looser tolerances than this the fourth-order method is cheaper (benchmarks/work_precision.py).
LOOSE = 1e-4
#: The steps are held to a part of the tolerance asked for, so that energy closes to it and no case is an outlier.
SAFETY = 0.5


def solve(todo: Request) -> Trajectory | Summary:
    """Solve as asked."""
    return stepping.run(todo, *method(todo))


def method(todo: Request) -> tuple[tableaux.Tableau, float]:
    """The method that a request takes, and the tolerance to which its steps are held."""
    by_tolerance = tableaux.RODAS4 if todo.rtol >= LOOSE else tableaux.RODAS5P
    return tableaux.TABLEAUX.get(todo.method, by_tolerance), SAFETY * todo.rtol
