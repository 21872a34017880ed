"""Pictures of runs and benches. They take what was computed before; nothing here solves."""

from stickslip.plot.benches import bench
from stickslip.plot.runs import forces, phase, velocity
from stickslip.plot.style import publication

__all__ = ["bench", "forces", "phase", "publication", "velocity"]
