"""The best drive and the best machine, and how they depend on their numbers."""

from stickslip.optimising.derivative_columns import derivative
from stickslip.optimising.gradients import Gradient, gradient
from stickslip.optimising.optimise import optimise
from stickslip.optimising.optimum import Optimum, Search
from stickslip.optimising.pareto import pareto
from stickslip.optimising.propagation import Indices, Propagated, propagate
from stickslip.optimising.waveforms import Waveform, waveform

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
