"""Drives: how the inner mass is shaken. One drive, one file; `DRIVES` lists them by name."""

from stickslip.drives.cantilever import cantilever_eigenvalues
from stickslip.drives.harmonic import Harmonic
from stickslip.drives.piezo_beam import PiezoBeam

__all__ = ["DRIVES", "Harmonic", "PiezoBeam", "cantilever_eigenvalues"]

DRIVES = {"harmonic": Harmonic}
"""The harmonic drive of the paper. A `PiezoBeam` makes one from volts and hertz."""
