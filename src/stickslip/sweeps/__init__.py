"""Many solves: grids and designs, in memory, in a study folder or on several machines; refinement where the motion changes."""

from stickslip.sweeps.merging import merge
from stickslip.sweeps.opening import open_study
from stickslip.sweeps.progress import Progress
from stickslip.sweeps.refined_maps import map
from stickslip.sweeps.running import sweep
from stickslip.sweeps.writing import export

__all__ = ["Progress", "export", "map", "merge", "open_study", "sweep"]
