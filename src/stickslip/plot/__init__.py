"""Pictures of runs. They take runs that were solved before; nothing here solves."""

from stickslip.plot.runs import forces, phase, velocity
from stickslip.plot.style import publication

__all__ = ["forces", "phase", "publication", "velocity"]
