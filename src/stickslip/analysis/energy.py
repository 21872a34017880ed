"""Where the energy of a run went, period by period."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip import forces
from stickslip.analysis.steady import needs_run
from stickslip.pieces import HarmonicArcs

__all__ = ["Energy", "energy"]

Array = Any
#: Gauss-Legendre nodes on a piece. An arc may last a whole drive period: there 24 nodes integrate products of sines to rounding
#: (error below (2 pi)^48 / 48! = 2e-23); a step of an integrator is far shorter than a period.
NODES_ARC, NODES_STEP = 24, 10


@dataclass(frozen=True, eq=False)
class Energy:
    r"""Energy balance of the body in each drive period, :math:`W_d + W_g - W_f = \Delta E` with :math:`E = (M+m)\dot x^2/2`.

    Parameters
    ----------
    drive : array (periods,)
        W_d, work of the inertial drive force -m d²xi/dt² [J].
    gravity : array (periods,)
        W_g, work of gravity along the track [J].
    friction : array (periods,)
        W_f, work that friction takes [J].
    kinetic : array (periods,)
        Change of the kinetic energy [J].
    actuator : array (periods,)
        Work of the actuator, which also moves the inner mass against the body [J].
    residual : array (periods,)
        (W_d + W_g - W_f - Delta E) / W_d [-]; 0 where nothing was done.
    settle : int
        How many periods belong to settling.
    """

    drive: Array
    gravity: Array
    friction: Array
    kinetic: Array
    actuator: Array
    residual: Array
    settle: int

    def __repr__(self) -> str:
        n = len(self.drive)
        last = f"last: drive {self.drive[-1]:.4g} J, gravity {self.gravity[-1]:.4g} J, friction {self.friction[-1]:.4g} J" if n else ""
        return f"<Energy of {n} periods; {last}; worst residual {self.worst:.1e}>"

    @property
    def worst(self) -> float:
        """Largest size of the residual after settling."""
        return float(abs(self.residual[self.settle :]).max(initial=0.0))


def energy(run: Any) -> Energy:
    """Energy balance of a run, period by period.

    The integrals are taken over the forces themselves, as the law and the drive give them at the dense output, and not from the
    equation of motion; so the residual measures how well the run obeys it.

    Parameters
    ----------
    run : Trajectory

    Returns
    -------
    Energy

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.trajectory import Trajectory
    >>> robot = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=1e-4, law="coulomb")
    >>> at_rest = HarmonicArcs(np.array([0.0, robot.period]), np.array([0]), np.zeros(1), np.zeros(1), 0.555, robot.drive.omega, 1.77, 1.77)
    >>> ss.energy(Trajectory(robot, at_rest, periods=1, settle=0, rtol=1e-6, method="by hand")).friction.tolist()
    [0.0]
    """
    needs_run("energy", run)
    edges, index, owner = _cut(run)
    nodes, weights = np.polynomial.legendre.leggauss(NODES_ARC if isinstance(run.pieces, HarmonicArcs) else NODES_STEP)
    half = 0.5 * np.diff(edges)
    t = (edges[:-1] + half)[:, None] + half[:, None] * nodes
    powers = _powers(run, t.ravel(), np.repeat(index, len(nodes)))
    count = len(run.strobe_times) - 1
    works = {n: np.bincount(owner, (p.reshape(t.shape) @ weights) * half, count) for n, p in powers.items()}
    kinetic = np.diff(0.5 * run.model.total_mass * run.strobe_v**2)
    missing = works["drive"] + works["gravity"] - works["friction"] - kinetic
    with np.errstate(divide="ignore", invalid="ignore"):
        largest = np.maximum(abs(works["gravity"]), np.maximum(abs(works["friction"]), abs(kinetic)))
        residual = np.where(missing == 0, 0.0, missing / np.where(works["drive"] != 0, works["drive"], largest))
    return Energy(**works, kinetic=kinetic, residual=residual, settle=min(int(run.settle), count))


def _cut(run: Any) -> tuple[Array, Array, Array]:
    """The pieces cut at the starts of the drive periods: their ends, their numbers, and the period that each belongs to."""
    edges = np.unique(np.concatenate([run.pieces.t, run.strobe_times]))
    middle = 0.5 * (edges[1:] + edges[:-1])
    owner = np.searchsorted(run.strobe_times, middle, side="right") - 1
    return edges, run._index(middle), np.minimum(owner, len(run.strobe_times) - 2)


def _powers(run: Any, t: Array, index: Array) -> dict[str, Array]:
    """Power of each force [W]."""
    x, v, z = run.pieces.evaluate(t, index)
    column = run._forces_at(t, index, x, v, z)
    gravity = forces.offered_force(run.model, t, x) - column["drive_force"]
    works = {"drive": column["drive_force"] * v, "gravity": gravity * v, "friction": column["friction_force"] * v}
    return works | {"actuator": column["actuator_power"]}
