"""Many solves: grids and designs, in memory, in a study folder or on several machines; refinement where the motion changes."""

from stickslip.basics.lazy_names import listing
from stickslip.studies.merging import merge
from stickslip.studies.opening import open_study
from stickslip.studies.progress import Progress
from stickslip.studies.refined_maps import map
from stickslip.studies.running import sweep
from stickslip.studies.writing import export

__all__ = ["Progress", "export", "map", "merge", "open_study", "sweep"]
__dir__ = listing(__all__)
