"""Pictures of runs, of maps, and of what becomes of motions along a parameter. They take what was computed before; nothing here solves."""

from stickslip.plot.cuts import line_cut
from stickslip.plot.dynamics import basins, bifurcation, chaos_map, continuation, convergence, spectrum
from stickslip.plot.maps import motion_map, velocity_map
from stickslip.plot.runs import forces, phase, velocity
from stickslip.plot.style import publication

__all__ = [
    "basins", "bifurcation", "chaos_map", "continuation", "convergence", "forces", "line_cut", "motion_map", "phase", "publication",
    "spectrum", "velocity", "velocity_map",
]  # fmt: skip
