"""Reports: numbers and pictures put on one page that needs nothing else."""

from stickslip.report.html import page, svg_address, write

__all__ = ["page", "svg_address", "write"]
