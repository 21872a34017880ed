"""Tests of friction laws: `check_law` checks a law, also a user-defined one, against the claims for the built-in laws."""

from stickslip.testing.law_claims import check_law
from stickslip.testing.reports import Claim, LawReport

__all__ = ["Claim", "LawReport", "check_law"]
