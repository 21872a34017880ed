"""Dynamic laws: Rosenbrock steps in lanes, one engine for one case and for a million."""

from __future__ import annotations

from stickslip.basics.contracts import Model
from stickslip.engine import tableaux
from stickslip.models.machine_adapter import machine_of

#: From these tolerances on the fourth-order method is cheaper: for one contact (benchmarks/work_precision.py), and for several, which
#: spend more of their steps near reversals, where the order counts (notes/decisions/2026-11-23-cost-of-a-chain.md).
LOOSE, LOOSE_OF_SEVERAL = 1e-4, 2e-4
#: The steps are held to a part of the tolerance asked for, so that energy closes to it and no case is an outlier.
SAFETY = 0.5


def tableau(model: Model, rtol: float) -> tableaux.Tableau:
    """The method that is cheaper for a model at a tolerance."""
    loose = LOOSE if len(machine_of(model).laws) == 1 else LOOSE_OF_SEVERAL
    return tableaux.RODAS4 if rtol >= loose else tableaux.RODAS5P
