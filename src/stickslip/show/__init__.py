"""Figures, reports, the paper, exported laws, the explorer and the command line."""

import importlib
from typing import Any

from stickslip.basics.presenting import provide


def _figure(name: str) -> Any:
    return getattr(importlib.import_module("stickslip.show.figures"), name)


def _report(name: str) -> Any:
    return importlib.import_module(f"stickslip.show.reports.{name}").write_report


provide("figure", _figure)
provide("report", _report)
