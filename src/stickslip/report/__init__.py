"""Reports: numbers and figures on self-contained pages."""

from stickslip.report.html import page, svg_address, write
from stickslip.report.of_atlas import atlas_page
from stickslip.report.of_optimum import optimum_page
from stickslip.report.of_run import run_page
from stickslip.report.of_study import study_page

__all__ = ["atlas_page", "optimum_page", "page", "run_page", "study_page", "svg_address", "write"]
