"""Reading and writing runs: `load` gives back what `Trajectory.save` wrote."""

from stickslip.io.netcdf import load
from stickslip.storage import save, to_mat

__all__ = ["load", "save", "to_mat"]
