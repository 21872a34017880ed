"""Vibration-driven robots and stick-slip friction: the public names, loaded when they are first used."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0.dev0"

if TYPE_CHECKING:
    from stickslip import designs as designs
    from stickslip import paper as paper
    from stickslip import plot as plot
    from stickslip import presets as presets
    from stickslip.analysis.coulomb_borders import coulomb_borders as coulomb_borders
    from stickslip.analysis.energy import energy as energy
    from stickslip.analysis.motion import Motion as Motion
    from stickslip.analysis.motion import motion as motion
    from stickslip.analysis.steady import mean_velocity as mean_velocity
    from stickslip.analysis.steady import periodic_mean_velocity as periodic_mean_velocity
    from stickslip.checking import check as check
    from stickslip.drives import Harmonic as Harmonic
    from stickslip.drives import PiezoBeam as PiezoBeam
    from stickslip.drives import cantilever_eigenvalues as cantilever_eigenvalues
    from stickslip.engine.latex import latex as latex
    from stickslip.errors import InputError as InputError
    from stickslip.errors import SolveError as SolveError
    from stickslip.errors import StickslipError as StickslipError
    from stickslip.friction import Coulomb as Coulomb
    from stickslip.friction import LuGre as LuGre
    from stickslip.io import load as load
    from stickslip.nondimensional import DimensionlessRobot as DimensionlessRobot
    from stickslip.nondimensional import dimensionless as dimensionless
    from stickslip.robot import Robot as Robot
    from stickslip.solvers import solve as solve
    from stickslip.sweeps import Progress as Progress
    from stickslip.sweeps import export as export
    from stickslip.sweeps import map as map
    from stickslip.sweeps import merge as merge
    from stickslip.sweeps import open_study as open_study
    from stickslip.sweeps import sweep as sweep
    from stickslip.tracks import Incline as Incline
    from stickslip.tracks import Level as Level
    from stickslip.trajectory import Trajectory as Trajectory

_HOMES = {
    "Coulomb": "friction",
    "DimensionlessRobot": "nondimensional",
    "Harmonic": "drives",
    "Incline": "tracks",
    "InputError": "errors",
    "Level": "tracks",
    "LuGre": "friction",
    "Motion": "analysis.motion",
    "PiezoBeam": "drives",
    "Progress": "sweeps",
    "Robot": "robot",
    "SolveError": "errors",
    "StickslipError": "errors",
    "Trajectory": "trajectory",
    "cantilever_eigenvalues": "drives",
    "check": "checking",
    "coulomb_borders": "analysis.coulomb_borders",
    "dimensionless": "nondimensional",
    "energy": "analysis.energy",
    "export": "sweeps",
    "latex": "engine.latex",
    "load": "io",
    "map": "sweeps",
    "mean_velocity": "analysis.steady",
    "merge": "sweeps",
    "motion": "analysis.motion",
    "open_study": "sweeps",
    "periodic_mean_velocity": "analysis.steady",
    "solve": "solvers",
    "sweep": "sweeps",
}
_MODULES = ("designs", "friction", "maths", "paper", "plot", "presets", "tracks", "variables")

__all__ = [*sorted(_HOMES), "__version__", "designs", "paper", "plot", "presets"]


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
