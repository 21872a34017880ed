"""What a servo is watched by: angle and target, error, torques; traces beside the picture of a machine that turns about an axis."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stickslip.basics.contracts import Array
from stickslip.basics.variables import unit_of
from stickslip.models.contact_forces import held_by_controllers
from stickslip.models.machine_adapter import machine_of

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory

Trace = dict[str, Any]


def turns(run: Trajectory) -> bool:
    """Whether the machine turns about an axis, so that its displacements are angles."""
    return unit_of("x", run.model) == "rad"


def targets_at(run: Trajectory, t: Array) -> dict[str, Array]:
    """The wanted position of each body that a controller leads, at times [s]; [rad] for a machine that turns.

    Examples
    --------
    >>> import numpy as np
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.servo(), duration=0.5)
    >>> {name: float(x[0]) for name, x in targets_at(run, np.array([0.1])).items()}
    {'joint': 0.5}
    """
    parts = machine_of(run.model).mechanics.controllers.parts.values()
    return {name: x + 0.0 * t for part in parts if callable(getattr(part, "target_at", None)) for name, x in part.target_at(t).items()}


def traces(run: Trajectory, t: Array) -> list[Trace]:
    """Traces with name, unit and curves, pairs of a name and its values at times [s]; none for a machine that does not turn.

    Examples
    --------
    >>> import numpy as np
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.servo(), duration=0.5)
    >>> [(trace["name"], trace["unit"], [name for name, _ in trace["curves"]]) for trace in traces(run, np.array([0.1, 0.2]))]
    [('angle', 'rad', ['joint', 'target']), ('error', 'rad', ['joint']), ('torque', 'N m', ['applied', 'friction'])]
    """
    if not turns(run):
        return []
    at, wanted = run.with_axes.at(t), targets_at(run, t)
    angles = dict(zip(run.bodies, at["x"].T, strict=True))
    target = [("target" if len(wanted) == 1 else f"target of {name}", x) for name, x in wanted.items()]
    rows = [("angle", "rad", [*angles.items(), *target])]
    if wanted:
        rows.append(("error", "rad", [(name, x - angles[name]) for name, x in wanted.items()]))
    rows.append(("torque", "N m", [("applied", _applied(run, t, at)), *_friction(run, at)]))
    return [{"name": name, "unit": unit, "curves": curves} for name, unit, curves in rows]


def _friction(run: Trajectory, at: dict[str, Any]) -> list[tuple[str, Array]]:
    """The torque of each contact."""
    several = len(run.contacts) > 1
    return [(f"friction of {name}" if several else "friction", R) for name, R in zip(run.contacts, at["friction_force"].T, strict=True)]


def _applied(run: Trajectory, t: Array, at: dict[str, Any]) -> Array:
    """The torque of all motors, on the side of the bodies that they turn [N m]."""
    mechanics: Any = machine_of(run.model).mechanics
    x, v = (dict(zip(run.bodies, at[of].T, strict=True)) for of in ("x", "v"))
    _, placed, index = run._placed(t)
    held = held_by_controllers(mechanics, run._states_at(placed, index)[2])
    given = [*mechanics.model.forces(t, x, v).items(), *mechanics.controllers.forces(t, x, v, held)]
    torques = [torque for _, of in given for torque in (of.values() if isinstance(of, dict) else (of,))]  # by names, or one
    return sum(torques, 0.0 * t)
