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
    from stickslip import testing as testing
    from stickslip.analysis.coulomb_borders import coulomb_borders as coulomb_borders
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
    from stickslip.dynamics.attractors import Basins as Basins
    from stickslip.dynamics.attractors import basins as basins
    from stickslip.dynamics.branches import Branch as Branch
    from stickslip.dynamics.branches import continuation as continuation
    from stickslip.dynamics.curves import Curve as Curve
    from stickslip.dynamics.curves import special_curve as special_curve
    from stickslip.dynamics.diagrams import bifurcation as bifurcation
    from stickslip.dynamics.exponents import Verdict as Verdict
    from stickslip.dynamics.exponents import largest_exponents as largest_exponents
    from stickslip.dynamics.exponents import lyapunov as lyapunov
    from stickslip.dynamics.exponents import verdict as verdict
    from stickslip.dynamics.flow_orbits import FlowOrbit as FlowOrbit
    from stickslip.dynamics.flow_orbits import flow_orbit as flow_orbit
    from stickslip.dynamics.flow_orbits import switching_flow as switching_flow
    from stickslip.dynamics.generic import Lyapunov as Lyapunov
    from stickslip.dynamics.generic import lyapunov_of_flow as lyapunov_of_flow
    from stickslip.dynamics.generic import lyapunov_of_map as lyapunov_of_map
    from stickslip.dynamics.maps import chaos_map as chaos_map
    from stickslip.dynamics.orbits import PeriodicOrbit as PeriodicOrbit
    from stickslip.dynamics.orbits import periodic_orbit as periodic_orbit
    from stickslip.dynamics.sections import poincare as poincare
    from stickslip.dynamics.sections import spectrum as spectrum
    from stickslip.dynamics.sections import strobe as strobe
    from stickslip.dynamics.switched import Switch as Switch
    from stickslip.dynamics.switched import SwitchingFlow as SwitchingFlow
    from stickslip.dynamics.switched import passage as passage
    from stickslip.dynamics.tracked import attractors as attractors
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
    from stickslip.identifying import Fit as Fit
    from stickslip.identifying import compare as compare
    from stickslip.identifying import design as design
    from stickslip.identifying import identify as identify
    from stickslip.identifying import prediction_errors as prediction_errors
    from stickslip.identifying import rank as rank
    from stickslip.identifying import virtual_rig as virtual_rig
    from stickslip.io import load as load
    from stickslip.machines import Body as Body
    from stickslip.machines import Chain as Chain
    from stickslip.machines import Contact as Contact
    from stickslip.machines import Machine as Machine
    from stickslip.machines import Rigid as Rigid
    from stickslip.machines import Spring as Spring
    from stickslip.machines import Stop as Stop
    from stickslip.mechanisms import BlockOnBelt as BlockOnBelt
    from stickslip.mechanisms import ForcedOscillator as ForcedOscillator
    from stickslip.mechanisms import PulledMass as PulledMass
    from stickslip.nondimensional import DimensionlessRobot as DimensionlessRobot
    from stickslip.nondimensional import dimensionless as dimensionless
    from stickslip.records import Record as Record
    from stickslip.records import read as read
    from stickslip.robot import Robot as Robot
    from stickslip.robot import mirrored as mirrored
    from stickslip.solvers import solve as solve
    from stickslip.sweeps import Progress as Progress
    from stickslip.sweeps import export as export
    from stickslip.sweeps import map as map
    from stickslip.sweeps import merge as merge
    from stickslip.sweeps import open_study as open_study
    from stickslip.sweeps import sweep as sweep
    from stickslip.tracks import Incline as Incline
    from stickslip.tracks import Level as Level
    from stickslip.tracks import VaryingFriction as VaryingFriction
    from stickslip.trajectory import Trajectory as Trajectory

_HOMES = {
    "BangBang": "drives",
    "Basins": "dynamics.attractors",
    "Bench": "benching",
    "Benches": "benching",
    "BlockOnBelt": "mechanisms",
    "Body": "machines",
    "Branch": "dynamics.branches",
    "Bristle": "friction",
    "Chain": "machines",
    "Contact": "machines",
    "Coulomb": "friction",
    "CoulombViscous": "friction",
    "Curve": "dynamics.curves",
    "DRIVES": "drives",
    "Dahl": "friction",
    "DeadBand": "friction",
    "DimensionlessRobot": "nondimensional",
    "ElastoPlastic": "friction",
    "Fit": "identifying",
    "FlowOrbit": "dynamics.flow_orbits",
    "ForcedOscillator": "mechanisms",
    "GMS": "friction",
    "Harmonic": "drives",
    "Incline": "tracks",
    "InputError": "errors",
    "Karnopp": "friction",
    "LAWS": "friction",
    "Level": "tracks",
    "LuGre": "friction",
    "Lyapunov": "dynamics.generic",
    "Machine": "machines",
    "Motion": "analysis.motion",
    "MultiHarmonic": "drives",
    "PeriodicOrbit": "dynamics.orbits",
    "PiezoBeam": "drives",
    "Progress": "sweeps",
    "PulledMass": "mechanisms",
    "Record": "records",
    "Recorded": "drives",
    "ResetIntegrator": "friction",
    "Reversed": "drives",
    "Rigid": "machines",
    "Robot": "robot",
    "SolveError": "errors",
    "Spring": "machines",
    "StickslipError": "errors",
    "Stop": "machines",
    "Stribeck": "friction",
    "Sum": "friction",
    "Switch": "dynamics.switched",
    "SwitchingFlow": "dynamics.switched",
    "Tabulated": "friction",
    "TanhCoulomb": "friction",
    "ThreePhase": "drives",
    "Trajectory": "trajectory",
    "Trapezoid": "drives",
    "TwoPhase": "drives",
    "VaryingFriction": "tracks",
    "Verdict": "dynamics.exponents",
    "VerticalVibration": "drives",
    "Viscous": "friction",
    "attractors": "dynamics.tracked",
    "basins": "dynamics.attractors",
    "bench": "benching",
    "bifurcation": "dynamics.diagrams",
    "cantilever_eigenvalues": "drives",
    "chaos_map": "dynamics.maps",
    "check": "checking",
    "compare": "identifying",
    "continuation": "dynamics.branches",
    "coulomb_borders": "analysis.coulomb_borders",
    "design": "identifying",
    "dimensionless": "nondimensional",
    "energy": "analysis.energy",
    "export": "sweeps",
    "flow_orbit": "dynamics.flow_orbits",
    "identify": "identifying",
    "largest_exponents": "dynamics.exponents",
    "latex": "engine.latex",
    "load": "io",
    "lyapunov": "dynamics.exponents",
    "lyapunov_of_flow": "dynamics.generic",
    "lyapunov_of_map": "dynamics.generic",
    "map": "sweeps",
    "mean_velocity": "analysis.steady",
    "merge": "sweeps",
    "mirrored": "robot",
    "motion": "analysis.motion",
    "open_study": "sweeps",
    "passage": "dynamics.switched",
    "periodic_mean_velocity": "analysis.steady",
    "periodic_orbit": "dynamics.orbits",
    "poincare": "dynamics.sections",
    "prediction_errors": "identifying",
    "rank": "identifying",
    "read": "records",
    "solve": "solvers",
    "special_curve": "dynamics.curves",
    "spectrum": "dynamics.sections",
    "strobe": "dynamics.sections",
    "sweep": "sweeps",
    "switching_flow": "dynamics.flow_orbits",
    "verdict": "dynamics.exponents",
    "virtual_rig": "identifying",
}
_MODULES = (
    "designs", "drives", "friction", "machines", "maths", "mechanisms", "paper", "plot", "presets", "testing", "tracks", "variables",
)  # fmt: skip

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
