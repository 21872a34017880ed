"""Tests of friction laws: `check_law` checks a law, also a user-defined one, against the claims for the built-in laws."""

from stickslip.analysis.law_claims.law_claims import check_law
from stickslip.analysis.law_claims.reports import Claim, LawReport
from stickslip.basics.lazy_names import listing

__all__ = ["Claim", "LawReport", "check_law"]
__dir__ = listing(__all__)
