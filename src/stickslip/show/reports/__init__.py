"""Reports: numbers and figures on self-contained pages."""

from stickslip.basics.lazy_names import lazy_names

__getattr__, __dir__, __all__ = lazy_names(__name__, __file__)
