"""Figures of runs, records, benches, maps and continuations, drawn from results that were computed before.

A figure is a function under `@drawing` in any module of this folder: that makes it a name of `stickslip.plot`, and of the results that
are drawn by it. `__init__.pyi` lists the figures for editors.
"""

import importlib
import pkgutil

from stickslip.show.figures.style import FIGURES, publication

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")
globals().update(FIGURES)  # some modules have the name of their figure
__all__ = sorted([*FIGURES, publication.__name__])


def __dir__() -> list[str]:
    """List the figures only, not the modules that draw them."""
    return list(__all__)
