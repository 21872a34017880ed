"""Friction laws as source text of other languages."""

from stickslip.show.export.exporting import LANGUAGES, ExportedLaw, export_law

__all__ = ["LANGUAGES", "ExportedLaw", "export_law"]
