"""Vibration-driven robots and stick-slip friction: the public names, loaded when they are first used."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0.dev0"

if TYPE_CHECKING:
    from stickslip import paper as paper
    from stickslip import plot as plot
    from stickslip import presets as presets
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
    from stickslip.identifying import Comparison as Comparison
    from stickslip.identifying import Design as Design
    from stickslip.identifying import Fit as Fit
    from stickslip.identifying import Ranking as Ranking
    from stickslip.identifying import compare as compare
    from stickslip.identifying import design as design
    from stickslip.identifying import identify as identify
    from stickslip.identifying import prediction_errors as prediction_errors
    from stickslip.identifying import rank as rank
    from stickslip.identifying import virtual_rig as virtual_rig
    from stickslip.io import load as load
    from stickslip.nondimensional import DimensionlessRobot as DimensionlessRobot
    from stickslip.nondimensional import dimensionless as dimensionless
    from stickslip.records import Record as Record
    from stickslip.records import read as read
    from stickslip.robot import Robot as Robot
    from stickslip.solvers import solve as solve
    from stickslip.sweeping import sweep as sweep
    from stickslip.tracks import Incline as Incline
    from stickslip.tracks import Level as Level
    from stickslip.trajectory import Trajectory as Trajectory

_HOMES = {
    "rank": "identifying",
    "prediction_errors": "identifying",
    "design": "identifying",
    "compare": "identifying",
    "Ranking": "identifying",
    "Design": "identifying",
    "Comparison": "identifying",
    "Coulomb": "friction",
    "DimensionlessRobot": "nondimensional",
    "Fit": "identifying",
    "Harmonic": "drives",
    "Incline": "tracks",
    "InputError": "errors",
    "Level": "tracks",
    "LuGre": "friction",
    "Motion": "analysis.motion",
    "PiezoBeam": "drives",
    "Record": "records",
    "Robot": "robot",
    "SolveError": "errors",
    "StickslipError": "errors",
    "Trajectory": "trajectory",
    "cantilever_eigenvalues": "drives",
    "check": "checking",
    "dimensionless": "nondimensional",
    "energy": "analysis.energy",
    "identify": "identifying",
    "latex": "engine.latex",
    "load": "io",
    "mean_velocity": "analysis.steady",
    "motion": "analysis.motion",
    "periodic_mean_velocity": "analysis.steady",
    "read": "records",
    "solve": "solvers",
    "sweep": "sweeping",
    "virtual_rig": "identifying",
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
