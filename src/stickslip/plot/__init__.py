"""Pictures of runs, and of what becomes of them along a parameter. They take what was computed before; nothing here solves."""

from stickslip.plot.dynamics import basins, bifurcation, continuation, convergence, motion_map, spectrum
from stickslip.plot.runs import forces, phase, velocity
from stickslip.plot.style import publication

__all__ = ["basins", "bifurcation", "continuation", "convergence", "forces", "motion_map", "phase", "publication", "spectrum", "velocity"]
