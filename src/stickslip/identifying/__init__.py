"""Models and measured records: compare them, fit their parameters, say how sure that is, rank laws, design the next experiment."""

from stickslip.identifying.fit import Fit
from stickslip.identifying.fitting import identify
from stickslip.identifying.rigs import virtual_rig

__all__ = ["Fit", "identify", "virtual_rig"]
