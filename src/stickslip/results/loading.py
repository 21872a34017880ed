"""Runs from netCDF4 files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from stickslip.basics.arguments import explains_arguments
from stickslip.results.storage import read
from stickslip.results.trajectory import Trajectory


@explains_arguments
def load(path: str | Path, laws: Sequence[type] = (), machines: Sequence[Any] = ()) -> Trajectory:
    """Read a run saved by `Trajectory.save`.

    Parameters
    ----------
    path : str or Path
    laws : sequence of classes
        User-defined friction laws of the run. Without them the run still has its motion (t, x, v, z, mode, strobe points); an error
        explains how to obtain its forces.
    machines : sequence of classes and flows
        User-defined machines; a run of such a machine cannot be read without its class. A run of a flow needs the flow itself, with any
        numbers: those of the run are in the file, and its rates are compared with those of the run.

    Returns
    -------
    Trajectory

    Examples
    --------
    >>> import tempfile, numpy as np, stickslip as ss
    >>> from stickslip.results.dense_output import HarmonicArcs
    >>> robot = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=1e-4, law="coulomb")
    >>> arcs = HarmonicArcs(np.array([0.0, robot.period]), np.array([0]), np.zeros(1), np.zeros(1), 0.555, robot.drive.omega, 1.77, 1.77)
    >>> run = Trajectory(robot, arcs, periods=1, settle=0, rtol=1e-6, method="by hand")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     same = ss.load(run.save(folder + "/run.nc"))
    >>> same.model == robot, bool((same.v == run.v).all())
    (True, True)
    """
    return Trajectory(**read(path, laws, machines))
