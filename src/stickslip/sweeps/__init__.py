"""Many solves: grids and designs, in memory, in a study folder, on several machines, refined where the motion changes."""

from stickslip.sweeps.opening import open_study
from stickslip.sweeps.progress import Progress
from stickslip.sweeps.running import sweep

__all__ = ["Progress", "open_study", "sweep"]
