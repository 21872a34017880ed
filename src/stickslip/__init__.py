"""Vibration-driven robots and stick-slip friction: the public names, loaded when they are first used."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0.dev0"

if TYPE_CHECKING:
    from stickslip import paper as paper
    from stickslip import plot as plot
    from stickslip import presets as presets
    from stickslip import testing as testing
    from stickslip.analysis.energy import energy as energy
    from stickslip.analysis.motion import Motion as Motion
    from stickslip.analysis.motion import motion as motion
    from stickslip.analysis.steady import mean_velocity as mean_velocity
    from stickslip.analysis.steady import periodic_mean_velocity as periodic_mean_velocity
    from stickslip.benching import Bench as Bench
    from stickslip.benching import Benches as Benches
    from stickslip.benching import bench as bench
    from stickslip.checking import check as check
    from stickslip.drives import DRIVES as DRIVES
    from stickslip.drives import BangBang as BangBang
    from stickslip.drives import Harmonic as Harmonic
    from stickslip.drives import MultiHarmonic as MultiHarmonic
    from stickslip.drives import PiezoBeam as PiezoBeam
    from stickslip.drives import Recorded as Recorded
    from stickslip.drives import Reversed as Reversed
    from stickslip.drives import ThreePhase as ThreePhase
    from stickslip.drives import Trapezoid as Trapezoid
    from stickslip.drives import TwoPhase as TwoPhase
    from stickslip.drives import VerticalVibration as VerticalVibration
    from stickslip.drives import cantilever_eigenvalues as cantilever_eigenvalues
    from stickslip.engine.latex import latex as latex
    from stickslip.errors import InputError as InputError
    from stickslip.errors import SolveError as SolveError
    from stickslip.errors import StickslipError as StickslipError
    from stickslip.friction import GMS as GMS
    from stickslip.friction import LAWS as LAWS
    from stickslip.friction import Bristle as Bristle
    from stickslip.friction import Coulomb as Coulomb
    from stickslip.friction import CoulombViscous as CoulombViscous
    from stickslip.friction import Dahl as Dahl
    from stickslip.friction import DeadBand as DeadBand
    from stickslip.friction import ElastoPlastic as ElastoPlastic
    from stickslip.friction import Karnopp as Karnopp
    from stickslip.friction import LuGre as LuGre
    from stickslip.friction import ResetIntegrator as ResetIntegrator
    from stickslip.friction import Stribeck as Stribeck
    from stickslip.friction import Sum as Sum
    from stickslip.friction import Tabulated as Tabulated
    from stickslip.friction import TanhCoulomb as TanhCoulomb
    from stickslip.friction import Viscous as Viscous
    from stickslip.io import load as load
    from stickslip.mechanisms import BlockOnBelt as BlockOnBelt
    from stickslip.mechanisms import ForcedOscillator as ForcedOscillator
    from stickslip.mechanisms import PulledMass as PulledMass
    from stickslip.nondimensional import DimensionlessRobot as DimensionlessRobot
    from stickslip.nondimensional import dimensionless as dimensionless
    from stickslip.robot import Robot as Robot
    from stickslip.robot import mirrored as mirrored
    from stickslip.solvers import solve as solve
    from stickslip.sweeping import sweep as sweep
    from stickslip.tracks import Incline as Incline
    from stickslip.tracks import Level as Level
    from stickslip.tracks import VaryingFriction as VaryingFriction
    from stickslip.trajectory import Trajectory as Trajectory

_HOMES = {
    "BangBang": "drives",
    "Bench": "benching",
    "Benches": "benching",
    "BlockOnBelt": "mechanisms",
    "Bristle": "friction",
    "Coulomb": "friction",
    "CoulombViscous": "friction",
    "DRIVES": "drives",
    "Dahl": "friction",
    "DeadBand": "friction",
    "DimensionlessRobot": "nondimensional",
    "ElastoPlastic": "friction",
    "ForcedOscillator": "mechanisms",
    "GMS": "friction",
    "Harmonic": "drives",
    "Incline": "tracks",
    "InputError": "errors",
    "Karnopp": "friction",
    "LAWS": "friction",
    "Level": "tracks",
    "LuGre": "friction",
    "Motion": "analysis.motion",
    "MultiHarmonic": "drives",
    "PiezoBeam": "drives",
    "PulledMass": "mechanisms",
    "Recorded": "drives",
    "ResetIntegrator": "friction",
    "Reversed": "drives",
    "Robot": "robot",
    "SolveError": "errors",
    "StickslipError": "errors",
    "Stribeck": "friction",
    "Sum": "friction",
    "Tabulated": "friction",
    "TanhCoulomb": "friction",
    "ThreePhase": "drives",
    "Trajectory": "trajectory",
    "Trapezoid": "drives",
    "TwoPhase": "drives",
    "VaryingFriction": "tracks",
    "VerticalVibration": "drives",
    "Viscous": "friction",
    "bench": "benching",
    "cantilever_eigenvalues": "drives",
    "check": "checking",
    "dimensionless": "nondimensional",
    "energy": "analysis.energy",
    "latex": "engine.latex",
    "load": "io",
    "mean_velocity": "analysis.steady",
    "mirrored": "robot",
    "motion": "analysis.motion",
    "periodic_mean_velocity": "analysis.steady",
    "solve": "solvers",
    "sweep": "sweeping",
}
_MODULES = ("drives", "friction", "maths", "mechanisms", "paper", "plot", "presets", "testing", "tracks", "variables")

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
