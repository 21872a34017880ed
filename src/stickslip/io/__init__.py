"""Reading and writing runs: `load` gives back what `Trajectory.save` wrote."""

from stickslip.storage import load, save, to_mat

__all__ = ["load", "save", "to_mat"]
