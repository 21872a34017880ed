"""Is a law sound? `check_law` runs the claims that the built-in laws are tested for, on a law of your own too."""

from stickslip.testing.law_claims import check_law
from stickslip.testing.reports import Claim, LawReport

__all__ = ["Claim", "LawReport", "check_law"]
