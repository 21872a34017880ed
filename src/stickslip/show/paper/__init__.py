"""The founding paper, end to end: every figure, printed number and claim recomputed, with a report."""

from stickslip.basics.lazy_names import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
