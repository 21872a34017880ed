"""Friction laws as source text of other languages."""

from stickslip.exporting.exporting import LANGUAGES, ExportedLaw, export_law

__all__ = ["LANGUAGES", "ExportedLaw", "export_law"]
