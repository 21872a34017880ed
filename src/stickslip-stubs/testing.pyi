from stickslip.analysis.law_claims import *
