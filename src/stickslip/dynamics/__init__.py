"""Dynamics of non-smooth motion: periodic orbits, their stability, branches of them, exponents, and what attracts which start."""

from stickslip.basics.errors import did_you_mean
from stickslip.basics.lazy_names import lazy_names

_RENAMED = {"FlowOrbit": "PeriodicOrbit", "LimitCycle": "PeriodicOrbit"}


def _refused(name: str) -> object:
    """An `AttributeError` that says what a name that there was is called now."""
    hint = f"type ss.dynamics.{_RENAMED[name]}" if name in _RENAMED else did_you_mean(name, __all__)
    raise AttributeError(f"{__name__} has no {name!r}; {hint}")


__getattr__, __dir__, __all__ = lazy_names(__name__, __file__, _refused)
