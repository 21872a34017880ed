"""Pictures of runs and of maps. They take what was solved before; nothing here solves."""

from stickslip.plot.cuts import line_cut
from stickslip.plot.maps import motion_map, velocity_map
from stickslip.plot.runs import forces, phase, velocity
from stickslip.plot.style import publication

__all__ = ["forces", "line_cut", "motion_map", "phase", "publication", "velocity", "velocity_map"]
