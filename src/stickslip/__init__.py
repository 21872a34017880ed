"""Vibration-driven robots and stick-slip friction: the public names, loaded when they are first used."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0.dev0"

if TYPE_CHECKING:
    from stickslip import paper, plot, presets
    from stickslip.analysis.energy import energy
    from stickslip.analysis.motion import Motion, motion
    from stickslip.analysis.steady import mean_velocity, periodic_mean_velocity
    from stickslip.check import check
    from stickslip.dimensionless import DimensionlessRobot, dimensionless
    from stickslip.drives import Harmonic
    from stickslip.errors import InputError, SolveError, StickslipError
    from stickslip.friction import Coulomb, LuGre
    from stickslip.io import load
    from stickslip.robot import Robot
    from stickslip.solvers import solve
    from stickslip.sweep import sweep
    from stickslip.tracks import Incline, Level
    from stickslip.trajectory import Trajectory

_HOMES = {
    "Coulomb": "friction",
    "DimensionlessRobot": "dimensionless",
    "Harmonic": "drives",
    "Incline": "tracks",
    "InputError": "errors",
    "Level": "tracks",
    "LuGre": "friction",
    "Motion": "analysis.motion",
    "Robot": "robot",
    "SolveError": "errors",
    "StickslipError": "errors",
    "Trajectory": "trajectory",
    "check": "check",
    "dimensionless": "dimensionless",
    "energy": "analysis.energy",
    "load": "io",
    "mean_velocity": "analysis.steady",
    "motion": "analysis.motion",
    "periodic_mean_velocity": "analysis.steady",
    "solve": "solvers",
    "sweep": "sweep",
}
_MODULES = ("friction", "maths", "paper", "plot", "presets", "tracks", "variables")

__all__ = [*sorted(_HOMES), "__version__", "paper", "plot", "presets"]


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        value = getattr(importlib.import_module(f"stickslip.{_HOMES[name]}"), name)
    elif name in _MODULES:
        value = importlib.import_module(f"stickslip.{name}")
    else:
        from stickslip.errors import did_you_mean

        raise AttributeError(f"stickslip has no {name!r}; {did_you_mean(name, __all__)}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return [*__all__, *_MODULES]
