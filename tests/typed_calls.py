"""What a type checker tells a user: mypy reads this file, nothing runs it. A `type: ignore` that ignores nothing is an error there."""

from typing import Any, assert_type

import numpy as np
import xarray as xr
from numpy.typing import NDArray

import stickslip as ss

robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4)
run = ss.solve(robot, keep="trajectory")
many = ss.solve(robot, keep="summary")
either = ss.solve(robot)

# ---- results have types ----
assert_type(run, ss.results.Trajectory)
assert_type(run.v, NDArray[np.float64])
assert_type(run.friction_force, NDArray[np.float64])
assert_type(ss.mean_velocity(run), float)
assert_type(ss.mean_velocity(many), NDArray[np.float64])
assert_type(ss.mean_velocity(either), float | NDArray[np.float64])
assert_type(ss.sweep(robot, amplitude=[4e-4, 5e-4]), xr.Dataset)
assert_type(ss.map(robot, amplitude=[4e-4, 5e-4], mu0=[0.1, 0.2]), xr.Dataset)
assert_type(ss.bifurcation(robot, parameter="mu0", values=[0.1, 0.2]), xr.Dataset)
assert_type(ss.dynamics.strobe(run), xr.Dataset)
assert_type(ss.periodic_orbit(robot), ss.dynamics.PeriodicOrbit)
assert_type(ss.periodic_orbit(ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0))), ss.dynamics.PeriodicOrbit)
assert_type(ss.continuation(robot, parameter="mu0", start=0.2, stop=0.1), ss.dynamics.Branch)
assert_type(ss.bench(ss.Coulomb(0.1, 0.2)), ss.analysis.Bench)
assert_type(ss.bench([ss.Coulomb(0.1, 0.2)]), ss.analysis.Benches)
assert_type(ss.identify(ss.read("run.csv"), robot, free={"mu0": None}), ss.identification.Fit)
assert_type(run.to_xarray(), xr.Dataset)

# ---- mistakes are told ----
ss.identfy(run)  # type: ignore[attr-defined]
ss.mean_velocity(run) + "a"  # type: ignore[operator]
speed: Any = run.velocity  # type: ignore[attr-defined]
ss.Robot(body_mass=0.06, inner_mass=0.01, drive=robot.drive, friktion=robot.friction)  # type: ignore[call-arg]
orbit: Any = ss.periodic_orbit(robot).multiplier  # type: ignore[attr-defined]
