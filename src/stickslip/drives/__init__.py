"""Drives: how the inner mass is shaken. One drive, one file; `DRIVES` lists them by name."""

from stickslip.drives.cantilever import cantilever_eigenvalues
from stickslip.drives.harmonic import Harmonic

__all__ = ["DRIVES", "Harmonic", "cantilever_eigenvalues"]

DRIVES = {"harmonic": Harmonic}
"""The harmonic drive of the paper."""
