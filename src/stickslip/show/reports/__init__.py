"""Reports: numbers and figures on self-contained pages."""

from stickslip.show.reports.atlas import atlas_page
from stickslip.show.reports.html import page, svg_address, write
from stickslip.show.reports.optimum import optimum_page
from stickslip.show.reports.run import run_page
from stickslip.show.reports.study import study_page

__all__ = ["atlas_page", "optimum_page", "page", "run_page", "study_page", "svg_address", "write"]
