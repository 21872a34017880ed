"""The founding paper, end to end: every figure, printed number and claim recomputed, with a report."""

from __future__ import annotations

from stickslip.basics.lazy_names import listing
from stickslip.show.paper.reproduction import Reproduction, reproduce

__all__ = ["Reproduction", "reproduce"]
__dir__ = listing(__all__)
