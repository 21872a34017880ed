"""Pictures of runs and records. They take what was computed before; nothing here solves."""

from stickslip.plot.records import comparison, fitted, residuals, spectrum
from stickslip.plot.runs import forces, phase, velocity
from stickslip.plot.style import publication

__all__ = ["comparison", "fitted", "forces", "phase", "publication", "residuals", "spectrum", "velocity"]
