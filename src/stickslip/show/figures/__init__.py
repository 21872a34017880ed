"""Figures of runs, records, benches, maps and continuations, drawn from results that were computed before.

A figure is a function under `@drawing` in any module of this folder: that makes it a name of `stickslip.plot`, and of the results that
are drawn by it. `__init__.pyi` lists the figures for editors.
"""

import importlib
import pkgutil
import sys
import types

from stickslip.basics.errors import InputError, did_you_mean
from stickslip.show.figures.style import FIGURES, publication

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")
globals().update(FIGURES)  # some modules have the name of their figure
__all__ = sorted([*FIGURES, publication.__name__])


def __dir__() -> list[str]:
    """List the figures only, not the modules that draw them."""
    return list(__all__)


#: What is typed for names of figures that others use.
_CALLED = {
    **dict.fromkeys(("portrait", "phase_portrait", "phase_plane"), "ss.plot.phase(run)"),
    **dict.fromkeys(("time", "time_series", "motion", "run", "trajectory"), "ss.plot.velocity(run)"),
    **dict.fromkeys(("position", "displacement", "x"), "ss.plot.phase(run), or ax.plot(run.t, run.x)"),
    **dict.fromkeys(("map", "heatmap"), "ss.plot.velocity_map(grid) or ss.plot.motion_map(grid)"),
    **dict.fromkeys(("branch", "branches"), "ss.plot.continuation(branch)"),
    **dict.fromkeys(("orbit", "cycle", "limit_cycle"), "ss.plot.phase(orbit.run)"),
    **dict.fromkeys(("lyapunov", "exponents"), "ss.plot.chaos_map(found) of ss.dynamics.chaos_map"),
    **dict.fromkeys(("animate", "animation"), "ss.widget(robot), or in a terminal stickslip explore or stickslip report"),
    "save": 'ax.figure.savefig("figure.png", dpi=600)',
}


def __getattr__(name: str) -> object:
    if name.startswith("__"):
        raise AttributeError(f"{__name__} has no {name!r}")
    instead = _CALLED.get(name.lower())
    raise AttributeError(f"ss.plot has no {name!r}; " + (f"type {instead}" if instead else did_you_mean(name, __all__)))


class _Figures(types.ModuleType):
    """The module that is no function: `ss.plot(run)` says what to type."""

    def __call__(self, *_: object, **__: object) -> None:
        raise InputError("plot", ["ss.plot has a figure for each kind of result; type run.plot(), or for example ss.plot.phase(run)"])


sys.modules[__name__].__class__ = _Figures
