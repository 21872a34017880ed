"""Drives: how the inner mass is shaken. One drive, one file; `DRIVES` lists them by name."""

from stickslip.drives.harmonic import Harmonic

__all__ = ["DRIVES", "Harmonic"]

DRIVES = {"harmonic": Harmonic}
