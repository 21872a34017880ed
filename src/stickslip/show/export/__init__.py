"""Friction laws as source text of other languages, and machines as units of FMI 3."""

from stickslip.show.export.exporting import LANGUAGES, ExportedLaw, export_law
from stickslip.show.export.fmu.exporting import ExportedFMU, export_fmu

__all__ = ["LANGUAGES", "ExportedFMU", "ExportedLaw", "export_fmu", "export_law"]
