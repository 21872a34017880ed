"""Models and measured records: compare them, fit their parameters, say how sure that is, rank laws, design the next experiment."""

from stickslip.identifying.comparing import Comparison, compare
from stickslip.identifying.designing import Design, design
from stickslip.identifying.fit import Fit
from stickslip.identifying.fitting import identify
from stickslip.identifying.ranking import Ranking, prediction_errors, rank
from stickslip.identifying.rigs import virtual_rig

__all__ = ["Comparison", "Design", "Fit", "Ranking", "compare", "design", "identify", "prediction_errors", "rank", "virtual_rig"]
