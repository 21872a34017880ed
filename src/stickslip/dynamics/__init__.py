"""Dynamics of non-smooth motion: periodic orbits, their stability, branches of them, exponents, and what attracts which start."""

from stickslip.basics.lazy_names import lazy_names

_RENAMED = dict.fromkeys(("floworbit", "limitcycle"), "ss.dynamics.PeriodicOrbit")
__getattr__, __dir__, __all__ = lazy_names(__name__, __file__, renamed=_RENAMED)
