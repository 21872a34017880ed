"""The best drive and the best machine, and how they depend on their numbers."""

from stickslip.basics.lazy_names import listing
from stickslip.inverse.optimisation.derivative_columns import derivative
from stickslip.inverse.optimisation.gradients import Gradient, gradient
from stickslip.inverse.optimisation.optimise import optimise
from stickslip.inverse.optimisation.optimum import Optimum, Search
from stickslip.inverse.optimisation.pareto_fronts import pareto
from stickslip.inverse.optimisation.propagation import Indices, Propagated, propagate
from stickslip.inverse.optimisation.waveforms import Waveform, waveform

__all__ = [
    "Gradient",
    "Indices",
    "Optimum",
    "Propagated",
    "Search",
    "Waveform",
    "derivative",
    "gradient",
    "optimise",
    "pareto",
    "propagate",
    "waveform",
]
__dir__ = listing(__all__)
