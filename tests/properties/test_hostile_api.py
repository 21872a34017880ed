"""Every public function, class and method with wrong types, shapes, sizes and values: one of our sentences, or Python's own TypeError."""

from __future__ import annotations

import dataclasses
import inspect
import os
import random

import numpy as np
import pytest

import stickslip as ss
from every import all_machines
from hostile import Outcome, limits, strange, warm
from stickslip import maths, tracks
from stickslip.basics.notebook_display import Face

#: A time limit may strike in a finalizer, which cannot pass it on.
pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")

RIG = {"tilt_deg": 1.7, "amplitude": 6e-4, "law": "coulomb"}


def flow_parts():
    flow = ss.SwitchingFlow({0: lambda t, y: (y[1], -y[0])}, {}, None)
    return flow, {"state": [1.0, 0.0], "mode": 0, "duration": 1.0}


def examples():
    """What is called, by name: a function and arguments with which it works; heavy ones with as little work as may be."""
    from stickslip.drives import DRIVES
    from stickslip.friction import LAWS

    robot = ss.presets.piezo_rig(**RIG)
    many = ss.presets.piezo_rig(**{**RIG, "amplitude": [4e-4, 6e-4]})
    run, batch = ss.solve(robot, periods=6), ss.solve(many, periods=6)
    rec = ss.virtual_rig(robot, noise=1e-4, seed=1, periods=6, settle=10, samples=40)
    grid = ss.sweep(ss.presets.piezo_rig, amplitude=[4e-4, 6e-4], tilt_deg=[1.5, 1.7], law="coulomb", periods=6)
    fit = ss.identify(rec, ss.presets.piezo_rig, free={"mu0": (0.1, 0.3)}, starts=2, seed=0, **RIG)
    along = {"parameter": "amplitude", "tilt_deg": 1.7, "law": "coulomb"}
    branch = ss.continuation(ss.presets.piezo_rig, start=5e-4, stop=6e-4, points=4, **along)
    diagram = ss.bifurcation(ss.presets.piezo_rig, values=[5e-4, 6e-4], settle=10, points=4, **along)
    flow, at = flow_parts()
    bench = ss.bench(ss.Coulomb(0.15, 0.2), experiments=["steady"])
    exponents = ss.lyapunov(robot, periods=20, settle=5)
    lines = ss.dynamics.spectrum(run, harmonics=4)
    beam = ss.drives.PiezoBeam()
    found = {
        "solve": (ss.solve, {"model": robot, "periods": 3, "settle": 1, "rtol": 1e-6, "start": {"v": 0.1}, "workers": 1, "keep": None,
                             "samples": 40, "method": "auto", "slip_ratio": 0.75, "dwell": 0.03, "progress": None, "duration": None}),
        "simulation": (ss.simulation, {"machine": robot, "start": {"v": 0.1}, "rtol": 1e-6, "method": "auto", "mode": None,
                                       "record": False}),
        "step": (ss.simulation(robot).step, {"dt": 1e-3, "inputs": {"force": 0.01}, "until": None, "stop_at_events": False}),
        "solve many": (ss.solve, {"model": many, "periods": 3, "start": {"v": [0.1, 0.2]}, "workers": 2, "method": "exact"}),
        "sweep": (ss.sweep, {"make": ss.presets.piezo_rig, **RIG, "amplitude": [4e-4, 6e-4], "periods": 3, "settle": "auto", "workers": 1,
                             "start": None, "rtol": 1e-6, "method": "auto", "progress": None}),
        "map": (ss.map, {"make": ss.presets.piezo_rig, **RIG, "amplitude": [4e-4, 6e-4], "tilt_deg": [1.0, 2.0], "periods": 3,
             "coarse": 3,
                         "refine": False}),
        "check": (ss.check, {"robot": robot, "periods": 3, "rtol": 1e-6, "start": None, "rk4_steps": (100,), "scipy": False}),
        "mean_velocity": (ss.mean_velocity, {"run": run}), "mean_velocity many": (ss.mean_velocity, {"run": batch}),
        "motion": (ss.motion, {"run": run, "slip_ratio": 0.75, "dwell": 0.03}), "energy": (ss.energy, {"run": run}),
        "periodic_mean_velocity": (ss.analysis.periodic_mean_velocity, {"model": robot, "periods": 50, "rtol": 1e-6}),
        "strobe": (ss.dynamics.strobe, {"run": run, "phase": 0.1, "settle": 1}),
        "widget": (ss.widget, {"model": robot, "numbers": ["drive.amplitude"], "periods": 3, "duration": None, "start": None}),
        "poincare": (ss.dynamics.poincare, {"run": run, "on": "v", "value": 0.0, "direction": 1, "settle": 1}),
        "spectrum": (ss.dynamics.spectrum, {"run": run, "column": "v", "harmonics": 4, "periods": 1}),
        "mirrored": (ss.dynamics.mirrored, {"robot": robot}), "dimensionless": (ss.analysis.dimensionless, {"robot": robot}),
        "latex": (ss.latex,
             {"law": robot.friction}),
        "export_law": (ss.export_law, {"law": ss.Coulomb(0.15, 0.2), "language": "mujoco", "name": None, "load": 1.0,
             "speeds": (1e-3, 0.1), "armature": 0.0}),
        "export": (ss.studies.export, {"study": grid, "path": "x.csv"}), "load": (ss.load, {"path": "x.nc", "laws": ()}),
        "read": (ss.read, {"path": "x.csv", "units": None, "columns": None, "roles": None, "rate": None, "scale": None, "separator": None,
             "decimal": None}),
        "open_study": (ss.open_study, {"folder": "x"}), "merge": (ss.studies.merge, {"folders": ["x"], "out": "y", "partial": False}),
        "bench": (ss.bench, {"law": ss.Coulomb(0.15, 0.2), "load": 1.0, "mass": 1.0, "stiffness": None, "speed": None,
             "experiments": ["steady"]}),
        "bifurcation": (ss.bifurcation, {"make": ss.presets.piezo_rig, "values": [5e-4, 6e-4], "settle": 5, "points": 4, "follow": True,
                                         "start": None, "rtol": 1e-6, "workers": 1, **along}),
        "continuation": (ss.continuation, {"make": ss.presets.piezo_rig, "start": 5e-4, "stop": 6e-4, "points": 3, "period": 1,
             "guess": None,
                                           "step": 0.02, "rtol": 1e-12, **along}),
        "atlas": (ss.atlas, {"make": ss.presets.piezo_rig, "over": {"amplitude": [5e-4, 6e-4], "mu0": [0.17, 0.18]}, "starts": 2,
             "settle": 5, "rtol": 1e-6, "branches": 0, "workers": 1, "resume": False, "tilt_deg": 1.7, "law": "coulomb"}),
        "atlas_time": (ss.dynamics.atlas_time, {"make": ss.presets.piezo_rig, "over": {"amplitude": [5e-4, 6e-4], "mu0": [0.17, 0.18]},
        "starts": 2,
             "settle": 5, "rtol": 1e-6, "branches": 0, "workers": 1, "tilt_deg": 1.7, "law": "coulomb"}),
        "attractors": (ss.attractors, {"make": ss.presets.piezo_rig, "values": [5e-4, 6e-4], "starts": None, "settle": 5, **along}),
        "basins": (ss.basins, {"model": robot, "settle": 5, "rtol": 1e-6, "workers": 1, "v": [0.0, 0.1]}),
        "edge_state": (ss.dynamics.edge_state, {"model": robot, "first": {"v": 0.0}, "second": {"v": 0.1}, "periods": 3, "settle": 5,
        "rtol": 1e-6}),
        "chaos_map": (ss.dynamics.chaos_map, {"make": ss.presets.piezo_rig, **RIG, "amplitude": [4e-4, 6e-4], "tilt_deg": [1.0, 2.0],
        "settle": 5,
             "periods": 5}),
        "periodic_orbit": (ss.periodic_orbit, {"model": robot, "period": 1, "guess": None, "rtol": 1e-12, "tolerance": 1e-12}),
        "largest_exponents": (ss.dynamics.largest_exponents, {"model": many, "periods": 5, "settle": 5, "start": None, "rtol": 1e-9,
             "apart": 1e-7}),
        "lyapunov": (ss.lyapunov, {"model": robot, "periods": 5, "settle": 5, "start": None, "rtol": 1e-7}),
        "verdict": (ss.verdict, {"model": robot, "periods": 20, "settle": 5, "start": None, "rtol": 1e-8}),
        "zero_one_test": (ss.dynamics.zero_one_test, {"series": np.sin(np.arange(300.0)), "frequencies": 12}),
        "rotation_number": (ss.dynamics.rotation_number, {"points": 0.3 * np.arange(200.0)}),
        "lyapunov_of_map": (ss.dynamics.lyapunov_of_map, {"f": lambda x: (3.9 * x[0] * (1 - x[0]),), "x0": [0.3], "iterations": 50,
        "settle": 5,
             "jacobian": None}),
        "lyapunov_of_flow": (ss.dynamics.lyapunov_of_flow, {"f": lambda y: (y[1], -y[0]), "x0": [1.0, 0.0], "duration": 1.0, "settle": 0.5,
             "every": 0.5}),
        "special_curve": (ss.dynamics.special_curve, {"branch": branch, "special": None, "parameter": "tilt_deg", "stop": 2.0, "step": 0.02,
             "points": 3}),
        "flow_orbit": (ss.dynamics.flow_orbit, {"flow": flow, "periods": 1, "settle": 0, "most": 3, **at}),
        "passage": (ss.dynamics.passage, {"flow": flow,
             **at}),
        "switching_flow": (ss.dynamics.switching_flow, {"model": robot}),
        "coulomb_borders": (ss.dynamics.coulomb_borders, {"grid": grid, "x": None, "y": None}),
        "virtual_rig": (ss.virtual_rig, {"robot": robot, "noise": 1e-4, "seed": 1, "periods": 2, "settle": 1, "samples": 20.0,
             "phase": 0.0,
                                         "channels": ("velocity",), "bandwidth": None, "harmonics": (0.0, 0.0), "resolution": 0.0,
                                              "offset": 0.0}),
        "identify": (ss.identify, {"records": rec, "make": ss.presets.piezo_rig, "free": {"mu0": (0.1, 0.3)}, "starts": 1, "seed": 0,
             "noise": None,
                                   "tied": None, "using": "auto", "frequency": None, "settle": "auto", **RIG}),
        "compare": (ss.compare, {"record": rec, "robot": robot, "laws": ("coulomb",), "using": "auto", "frequency": None, "noise": None}),
        "prediction_errors": (ss.identification.prediction_errors, {"fit": fit, "records": rec, "load": None, "frequency": None}),
        "rank": (ss.identification.rank, {"fits": [fit, fit], "held_out": None}),
        "design": (ss.identification.design, {"make": ss.presets.piezo_rig, "free": {"mu0": 0.18}, "experiments": {"amplitude": [5e-4,
        6e-4]},
             "noise": 1e-4,
                               "samples": 20, "together": 1, "rivals": None, "using": "velocity", "tilt_deg": 1.7, "law": "coulomb"}),
        "certify": (ss.dynamics.certify, {"orbit": ss.periodic_orbit(robot), "digits": 20}),
        "sensitivity": (ss.dynamics.sensitivity, {"of": run, "wrt": ["drive.amplitude"]}),
        "gradient": (ss.optimisation.gradient, {"model": robot, "of": "mean_velocity", "wrt": ["drive.amplitude"], "rtol": 1e-9}),
        "derivative": (ss.optimisation.derivative, {"of": "mean_velocity", "by": "friction.mu_plus", "unit": "m/s"}),
        "optimise": (ss.optimise, {"model": robot, "over": {"drive.amplitude": (5e-4, 6e-4)}, "maximise": "mean_velocity", "minimise": None,
             "subject_to": {"stroke": (None, 0.01)}, "robust": None, "quantile": None, "starts": "closed", "seed": 0}),
        "pareto": (ss.optimisation.pareto, {"model": robot, "over": {"drive.amplitude": (5e-4, 6e-4)}, "maximise": "mean_velocity",
             "minimise": "drive_power", "subject_to": None, "points": 2, "starts": "closed", "seed": 0}),
        "waveform": (ss.optimisation.waveform, {"pieces": 4, "fourier": None, "spline": None}),
        "propagate": (ss.optimisation.propagate, {"model": robot, "uncertain": {"friction.mu_plus": ("uniform", 0.14, 0.16)},
        "of": "mean_velocity",
             "samples": 8, "seed": 0, "indices": False}),
        "quantity": (ss.quantities.quantity, {"label": "width", "unit": "m", "symbol": "b", "example": 0.02, "range": (0.0, 0.1),
        "shown": "mm"}),
        "observable": (ss.observable, {"function": lambda s: s.v**2, "reduce": "mean", "unit": "m^2/s^2"}),
        "Bodies": (ss.machines.Bodies, {"mass": 0.05, "count": 3, "friction": ss.Coulomb(0.1, 0.3)}),
        "Gait": (ss.machines.Gait, {"drive": ss.Harmonic(2e-3, frequency=2.0), "lag": 2.0, "length": 0.02}),
        "Forced": (ss.machines.Forced, {"force": ss.HarmonicForce(1.5, 104.7), "stiffness": 250.0, "damping": 0.5,
                               "stops": (ss.Stop(0.01, restitution=0.5),), "reaction": True}),
        "HarmonicForce": (ss.HarmonicForce, {"amplitude": 1.5, "omega": 104.7, "phase": 0.1}),
        "Pulses": (ss.drives.Pulses, {"amplitude": 1.25, "period": 0.06, "duty": 0.35}),
        "RecordedForce": (ss.drives.RecordedForce, {"period": 0.06, "mean": 0.1, "cosines": (0.0, 0.75), "sines": (1.5, 0.0)}),
        "ForceSum": (ss.drives.ForceSum, {"parts": (ss.HarmonicForce(1.5, 104.7), ss.HarmonicForce(0.7, 209.4))}),
        "MovingTrack": (ss.MovingTrack, {"mass": 0.02, "along": ss.Harmonic(1e-4, omega=300.0), "across": None, "tilt": 0.1,
             "friction": ss.Coulomb(0.1, 0.1), "load": 2.0, "force": 0.1, "restitution": 0.3}),
        "step_per_cycle": (ss.analysis.step_per_cycle, {"run": run}), "throw_index": (ss.analysis.throw_index, {"machine": robot}),
        "hops": (ss.analysis.hops, {"run": ss.solve(ss.presets.conveyor(throw_index=1.5), periods=2), "contact": None}),
        "stick_slip_stage": (ss.presets.stick_slip_stage, {"stroke": 5e-6, "load": 20.0, "mu": 0.1, "force": 0.1, "law": "lugre"}),
        "conveyor": (ss.presets.conveyor, {"throw_index": 1.5, "angle_deg": 30.0, "tilt_deg": 1.0, "restitution": 0.2, "law": "coulomb"}),
        "cantilever_eigenvalues": (ss.drives.cantilever_eigenvalues, {"tip_mass_ratio": 0.5, "n": 3}),
        "check_law": (ss.testing.check_law, {"law": ss.Coulomb(0.15, 0.2), "load": 1.0, "raise_": True}),
        "piezo_rig": (ss.presets.piezo_rig, {**RIG, "omega": 200.0, "mu0": 0.18, "f0": 0.2, "incline": "folded", "body_mass": 0.06}),
        "piezo_beam_rig": (ss.presets.piezo_beam_rig, {"voltage": 20.0, "frequency": 32.7, "tilt_deg": 1.7, "beam": None,
             "law": "coulomb"}),
        "coulomb_robot": (ss.presets.PRESETS["coulomb_robot"], {"alpha_plus": 0.5, "alpha_minus": 0.9}),
        "sobol": (ss.designs.sobol, {"count": 4, "seed": 0, "dim": "case", "amplitude": (0.0, 1.0)}),
        "latin_hypercube": (ss.designs.latin_hypercube, {"count": 4, "seed": 0, "dim": "case", "amplitude": (0.0, 1.0)}),
        "table": (ss.designs.table, {"rows": [{"amplitude": 1e-4}], "dim": "case"}),
        "zipped": (ss.designs.zipped, {"amplitude": [1e-4, 2e-4], "tilt_deg": [1.0, 2.0]}),
        "Robot": (ss.Robot, {"body_mass": 0.06, "inner_mass": 0.01, "drive": robot.drive, "friction": robot.friction, "gravity": 9.81,
             "track": ss.Level()}),
        "DimensionlessRobot": (ss.analysis.DimensionlessRobot, {"mu": 0.2, "friction": ss.Coulomb(0.5, 0.9), "drive": ss.Harmonic(1.0,
             omega=1.0)}),
        "Incline": (ss.Incline, {"tilt": 0.03}), "VaryingFriction": (ss.tracks.VaryingFriction, {"track": ss.Level(), "depth": 0.1,
             "harmonic": 1, "phase": 0.0}),
        "FrictionPatches": (ss.tracks.FrictionPatches, {"track": ss.Level(), "edges": (0.0, 1e-3), "factors": (1.0, 0.5),
        "wavelength": 3e-3}),
        "FrictionWave": (ss.tracks.FrictionWave, {"track": ss.Level(), "wavelength": 1e-3, "cosines": (0.1,), "sines": (0.2,)}),
        "FrictionProfile": (ss.tracks.FrictionProfile, {"track": ss.Level(), "place": (0.0, 1e-3), "factors": (1.0, 0.5)}),
        "PiezoBeam": (ss.drives.PiezoBeam, {"length": 0.1, "thickness": 1e-3, "tip_mass": 0.01, "damping": 0.01}),
        "Chain": (ss.Chain, {"modules": (robot, robot), "link": ss.Spring(100.0), "phases": (0.0, 1.0)}),
        "Joint": (ss.Joint, {"inertia": 0.01, "friction": robot.friction, "torque": 0.1, "gravity_torque": 0.1, "gear_ratio": 10.0,
             "backlash": 0.01, "control": ss.machines.PID(kp=1.0, ki=1.0, kd=0.1, target=0.5), "gear_damping": 0.1, "angle": 0.0}),
        "Motor": (ss.machines.Motor, {"k_t": 0.02, "resistance": 1.0, "supply": 12.0}),
        "ServoLoad": (ss.machines.ServoLoad, {"base": 0.1, "viscous": 0.05, "stribeck": 0.02, "motor": 0.2, "external": 0.2,
             "motor_stribeck": 0.01, "external_stribeck": 0.01, "motor_quad": 0.01, "external_quad": 0.01, "v_s": 1.0, "exponent": 1.0}),
        "PID": (ss.machines.PID, {"kp": 1.0, "ki": 1.0, "kd": 0.1, "target": 0.5, "sample": 0.01, "feedforward": 0.1, "feedback": "joint"}),
        "servo": (ss.presets.servo, {"kp": 1.0, "ki": 1.0, "kd": 0.1, "target": 0.5, "sample": 0.01, "static": 1.5, "backlash": 0.0}),
        "Spring": (ss.Spring, {"stiffness": 100.0, "damping": 1.0, "length": 0.1, "cubic": 1e6, "clearance": 1e-3}),
        "Stop": (ss.Stop, {"gap": 0.1, "restitution": None, "stiffness": 1e4, "damping": 0.0, "side": 1}),
        "Point": (ss.Point, {"body": "head", "at": (0.0, 0.1)}), "Angle": (ss.machines.Angle, {"body": "head"}),
        "Body": (ss.Body, {"mass": 1.0, "position": 0.0}), "Contact": (ss.Contact, {"body": "head", "friction": robot.friction}),
        "SwitchingFlow": (ss.SwitchingFlow, {"fields": {0: lambda t, y: y}, "switches": {}, "period": 1.0, "states": ("x",),
             "scales": (1.0,), "numbers": None}),
        "solve of a flow": (ss.solve, {"model": flow, "start": [1.0, 0.0], "duration": 1.0, "keep": None, "samples": 10, "mode": 0,
             "method": "auto"}),
        "FlowContact": (ss.machines.FlowContact, {"slip": lambda t, y: y[0], "friction": ss.Coulomb(0.2, 0.2), "load": 9.81}),
        "Switch": (ss.Switch, {"guard": lambda t, y: y[0], "to": 0, "reset": None}),
        "fold": (tracks.fold, {"mu": 0.2, "tilt": 0.03}),
        # methods
        "run.at": (run.at, {"t": 0.01}), "run.save": (run.save, {"path": "y.nc"}), "run.to_mat": (run.to_mat, {"path": "y.mat"}),
        "robot.replace": (robot.replace, {"body_mass": 0.07}), "robot.replace dotted": (robot.replace,
             {"changes": {"drive.amplitude": 1e-4}}),
        "Robot.from_toml": (ss.Robot.from_toml, {"text": robot.to_toml()}), "law + law": (lambda other: robot.friction + other,
             {"other": ss.Viscous(0.1, 0.1)}),
        "rec.between": (rec.between, {"start": 0.0, "end": 0.1}), "rec.motion": (rec.motion, {"frequency": None, "threshold": None}),
        "rec.mean_velocity": (rec.mean_velocity, {"frequency": None}), "rec.period": (rec.period, {"frequency": None}),
        "rec.modes": (rec.modes, {"channel": None, "count": 1}), "rec.spectrum": (rec.spectrum, {"channel": "velocity"}),
        "rec.derived": (rec.derived, {"heading": "a [m/s]", "values": rec["velocity"].values, "like": "velocity", "role": None}),
        "rec.drive_frequency": (rec.drive_frequency, {"about": None}), "rec.save": (rec.save, {"path": "z.csv"}),
             "rec[]": (rec.__getitem__, {"key": "velocity"}),
        "rec.stick_intervals": (rec.stick_intervals, {"frequency": None, "threshold": None}),
        "Record.of": (ss.Record.of, {"t": np.arange(20) * 0.01, "columns": {"v [m/s]": np.arange(20.0)}}),
        "fit.bands": (fit.bands, {"record": 0, "level": 0.9, "samples": None, "draws": 10, "seed": 0}),
        "fit.sample": (fit.sample, {"draws": 10, "walkers": None, "burn": 1, "seed": 0, "progress": None}),
        "fit.next_experiment": (fit.next_experiment, {"experiments": {"amplitude": [8e-4]}, "noise": 1e-3, "samples": 60, "using": None,
             "sensor": None}),
        "plot.autocorrelation": (ss.plot.autocorrelation, {"fit": fit, "record": 0, "ax": None}),
        "fit.interval": (fit.interval, {"name": "mu0", "level": 0.9, "method": "covariance"}), "fit.model": (fit.model, {"record": 0}),
        "fit.report": (fit.report, {"path": None}), "branch.at": (branch.at, {"value": 5.5e-4}), "bench[]": (bench.__getitem__,
             {"key": "steady"}),
        "beam.drive": (beam.drive, {"voltage": 20.0, "frequency": 32.7}), "beam.response": (beam.response, {"voltage": 20.0,
             "frequency": 32.7}),
        "beam.eigenvalues": (beam.eigenvalues, {"n": 2}), "beam.frequencies": (beam.frequencies, {"n": 2}), "beam.notes": (beam.notes,
             {"voltage": 20.0, "frequency": 32.7}),
        "beam.transient": (beam.transient, {"t": np.linspace(0, 0.01, 5), "voltage": 20.0, "frequency": 32.7}),
             "beam.replace": (beam.replace, {"length": 0.1}),
        # pictures
        "plot.velocity": (ss.plot.velocity, {"run": run, "periods": 2, "ax": None, "labels": None, "duration": None}),
        "plot.phase": (ss.plot.phase, {"run": run, "periods": 2, "ax": None, "labels": None}),
        "plot.pattern": (ss.plot.pattern, {"motion": ss.motion(run), "ax": None}),
        "plot.contacts": (ss.plot.contacts, {"run": run, "periods": 2, "ax": None, "duration": None}),
        "plot.states": (ss.plot.states, {"run": ss.solve(flow, start=[1.0, 0.0], duration=1.0), "duration": None, "ax": None}),
        "plot.forces": (ss.plot.forces, {"run": run, "periods": 2, "ax": None, "duration": None}),
        "plot.bench": (ss.plot.bench, {"found": bench, "figure": None}), "plot.bifurcation": (ss.plot.bifurcation, {"diagram": diagram,
             "observable": "v", "ax": None}),
        "plot.continuation": (ss.plot.continuation, {"branch": branch, "observable": None, "ax": None, "diagram": None, "labels": None}),
        "plot.convergence": (ss.plot.convergence, {"exponents": exponents, "ax": None, "count": 1}), "plot.spectrum": (ss.plot.spectrum,
             {"lines": lines, "ax": None}),
        "plot.fitted": (ss.plot.fitted, {"fit": fit, "record": 0, "ax": None}), "plot.residuals": (ss.plot.residuals, {"fit": fit,
             "record": 0, "ax": None}),
        "fit": (ss.fit, {"file": {"t_s": np.arange(60) * 0.01, "x_mm": np.sin(0.3 * np.arange(60)), "F_N": np.cos(0.3 * np.arange(60))},
             "law": "coulomb", "starts": 1, "machine": "rig", "numbers": {"load": 2.0}, "sensor": {}, "units": {}, "roles": {}}),
        "plot.friction_curve": (ss.plot.friction_curve, {"fit": fit, "record": 0, "ax": None}),
        "plot.over_time": (ss.plot.over_time, {"fit": fit, "record": 0, "ax": None}),
        "plot.residuals_over_velocity": (ss.plot.residuals_over_velocity, {"fit": fit, "record": 0, "ax": None}),
        "plot.line_cut": (ss.plot.line_cut, {"grid": grid, "along": "amplitude", "at": None, "lines": None, "ax": None}),
        "plot.motion_map": (ss.plot.motion_map, {"grid": grid, "x": None, "y": None, "borders": True, "ax": None}),
        "plot.velocity_map": (ss.plot.velocity_map, {"grid": grid, "x": None, "y": None, "borders": True, "optimum": True, "ax": None}),
        "plot.batch": (ss.plot.batch, {"many": batch, "ax": None}),
        "plot.record": (ss.plot.record, {"record": rec, "channel": None, "ax": None}),
        "plot.record_spectrum": (ss.plot.record_spectrum, {"record": rec, "channel": "velocity", "ax": None}),
        "plot.check": (ss.plot.check, {"found": None, "ax": None}), "plot.design": (ss.plot.design, {"found": None, "ax": None}),
        "plot.energy": (ss.plot.energy, {"found": None, "ax": None}), "plot.indices": (ss.plot.indices, {"found": None, "ax": None}),
        "plot.ranking": (ss.plot.ranking, {"found": None, "ax": None}),
        "plot.sensitivity": (ss.plot.sensitivity, {"found": None, "ax": None}),
        "plot.tornado": (ss.plot.tornado, {"found": None, "ax": None}), "plot.front": (ss.plot.front, {"found": None, "ax": None}),
        "plot.optimum": (ss.plot.optimum, {"found": None, "of": None, "ax": None}),
        "plot.atlas": (ss.plot.atlas, {"found": None, "ax": None, "points": True}),
        "plot.basins": (ss.plot.basins, {"found": None, "ax": None, "edges": ()}),
        "plot.edge_state": (ss.plot.edge_state, {"edge": None, "ax": None}), "plot.attractors": (ss.plot.attractors, {"found": None,
             "quantity": "mean_velocity"}),
        "plot.special_curve": (ss.plot.special_curve, {"curves": None, "ax": None}),
        "plot.chaos_map": (ss.plot.chaos_map, {"found": None, "quantity": "motion", "curves": ()}),
             "plot.comparison": (ss.plot.comparison, {"found": None}),
    }  # fmt: skip
    body = {"mass": 1.0, "stiffness": 100.0, "friction": ss.Coulomb(0.1, 0.2), "load": 1.0, "damping": 0.1}
    found |= {name: (kind, {**body, "speed": 0.1}) for name, kind in (("PulledMass", ss.PulledMass), ("BlockOnBelt", ss.BlockOnBelt))}
    found["ForcedOscillator"] = ss.ForcedOscillator, {**body, "force": 1.0, "omega": 8.0, "bias": 0.0}
    found["Lubricated"] = ss.machines.Lubricated, {"mu": 1.0}
    found["ForceRig"] = ss.machines.ForceRig, {"friction": ss.Coulomb(0.1, 0.2), "backlash": 1e-4}
    for kinds in (LAWS, DRIVES):
        for name, kind in kinds.items():
            one = kind.example() if hasattr(kind, "example") else None
            if one is not None:
                taken = [p for p in inspect.signature(kind).parameters if hasattr(one, p)]
                found[name] = kind, {p: getattr(one, p) for p in taken if getattr(one, p) is not None}
    known = {"run": run, "robot": robot, "model": robot, "machine": robot, "record": rec, "grid": grid, "fit": fit, "branch": branch}
    return found | of_others(found, known)


def of_others(found, known):
    """The public functions and machines that are not named above and need no more than `known`, and the figures of what they return."""
    called = names_in(found)
    more = {}
    for name in set(PUBLIC) - NO_DOORS - called:
        one = next((machine for machine, *_ in all_machines.values() if type(machine) is PUBLIC[name]), None)
        if one is not None:
            more[name] = type(one), {field.name: getattr(one, field.name) for field in dataclasses.fields(one)}
        elif needs(PUBLIC[name]) <= set(known):
            more[name] = PUBLIC[name], {p: known[p] for p in needs(PUBLIC[name])}
    for name in {name for name in ss.plot.__all__ if name in more and f"plot.{name}" not in found}:
        call, good = more[name]
        (first,) = needs(getattr(ss.plot, name))
        more[f"plot.{name}"] = getattr(ss.plot, name), {first: call(**good), "ax": None}
    return more


def needs(call):
    """The parameters of a function that have no default."""
    parameters = inspect.signature(call).parameters.values()
    return {p.name for p in parameters if p.default is p.empty and p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)}


def names_in(found):
    return {getattr(call, "__name__", "") for call, _ in found.values()}


def is_no_door(thing):
    """Whether it is a module, an error, or a result with a picture or a text, which only our functions make."""
    return inspect.ismodule(thing) or (inspect.isclass(thing) and issubclass(thing, (Face, Exception)))


#: Public names that are not doors: beside these, results of a few numbers that only our functions make, and tables.
MODULES = (ss.friction, ss.drives, ss.tracks, ss.machines, ss.dynamics, ss.analysis, ss.identification, ss.optimisation, ss.studies)
#: Every public name: of the package, and of the modules in which the rarer ones are.
PUBLIC = {name: getattr(place, name) for place in (*MODULES, ss) for name in place.__all__}
NO_DOORS = {name for name, thing in PUBLIC.items() if is_no_door(thing)} | {
    "AtlasTime", "Certificate", "DRIVES", "Enclosure", "FORCES", "Gradient", "Hops", "Indices", "LAWS", "Level", "MECHANISMS", "Machine",
    "Observable", "Progress", "Record", "Rigid", "Rotation", "Search", "Sum", "TRACKS", "Waveform", "ZeroOne", "optimize",
}  # fmt: skip


@pytest.fixture(scope="module")
def doors(tmp_path_factory):
    os.chdir(tmp_path_factory.mktemp("doors"))
    warm()
    return examples()


def test_every_public_name_is_tried(doors):
    called = names_in(doors)
    figures = {f"plot.{name}" for name in ss.plot.__all__ if name != "publication" and name not in called}
    missing = (set(PUBLIC) - NO_DOORS - called) | figures
    assert not missing, f"give {', '.join(sorted(missing))} arguments in tests/properties/test_hostile_api.py; results go to NO_DOORS there"


def tried(doors, count, seed, seconds=2.0):
    import matplotlib.pyplot as plt

    rng, found = random.Random(seed), Outcome()
    names = sorted(name for name, (_, good) in doors.items() if good)  # those that take something
    for k in range(count):
        name = names[k % len(names)]
        call, good = doors[name]
        given = dict(good)
        for _ in range(rng.choice([1, 1, 1, 2, 3])):
            which = rng.choice([*good])
            given[which] = strange(rng)
        if rng.random() < 0.05:
            given.pop(rng.choice([*given]))
        if rng.random() < 0.03:
            given["nonsense"] = strange(rng)
        found.of(lambda call=call, given=given: call(**given), name, {n: v for n, v in given.items() if v is not good.get(n)}, seconds)
        plt.close("all")
    return found


def test_a_strange_argument_is_told_in_words(doors):
    with limits():
        found = tried(doors, 200, 1)
    assert not found.wrong, found.told()


@pytest.mark.slow
def test_strange_arguments_of_every_public_function_are_told_in_words(doors):
    with limits():
        found = tried(doors, 20_000, 2)
    print(f"\n{found.tried} calls of {len(doors)} functions: {dict(found)}")
    assert found.tried == 20_000 and not found.wrong, found.told()


def test_the_functions_of_laws_take_any_number():
    for name in set(maths.__all__) - {"pi", "where", "within", "wrapped", "maximum", "minimum", "hypot"}:
        for value in (0, 1, -1, 10**300, 1e308, -1e308, float("nan"), np.float64("inf"), np.array([]), np.array([1e308, -1e308])):
            getattr(maths, name)(value)
