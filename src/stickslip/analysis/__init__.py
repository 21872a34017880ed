"""Numbers from runs: steady velocity, period, motion type, energy. Nothing here draws or writes."""

import importlib
from typing import Any

from stickslip.basics.lazy_names import lazy_names
from stickslip.basics.presenting import provide

__getattr__, __dir__, __all__ = lazy_names(__name__, __file__)

#: The modules of the numbers that runs have as attributes.
_NUMBERS = {"mean_velocity": "steady", "motion": "motion"}


def _number(name: str) -> Any:
    return getattr(importlib.import_module(f"{__name__}.{_NUMBERS[name]}"), name)


provide("number", _number)
