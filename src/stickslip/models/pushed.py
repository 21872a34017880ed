"""A machine with one more force on each of its bodies, each of them a number: the inputs of a simulation that goes step by step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from stickslip.basics.contracts import Model, Numeric
from stickslip.basics.fields import Frozen
from stickslip.models.machine_adapter import fresh_mechanics, machine_of
from stickslip.models.mechanics import lists_parts, parts_of


@dataclass(frozen=True, eq=False)
class Pushed(Frozen):
    """A machine, and a force on each of its bodies.

    Parameters
    ----------
    machine : Robot or machine
    applied : tuple of float
        The forces, in the order of the bodies [N]; of a machine that turns torques [N m].

    Examples
    --------
    >>> import stickslip as ss
    >>> belt = ss.BlockOnBelt(mass=2.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0))
    >>> belt.acceleration(0.0, 0.0, 0.0, 3.0), Pushed(belt, (1.0,)).acceleration(0.0, 0.0, 0.0, 3.0)
    (-1.5, -1.0)
    """

    machine: Any
    applied: tuple[float, ...]

    def __getattr__(self, name: str) -> Any:
        """All else is the machine's, or of what lists its parts; that has no drive that would list them once more, without the forces."""
        if name.startswith("_") or name in ("machine", "applied", "mechanics"):
            raise AttributeError(name)
        parts = parts_of(self.machine)
        if name == "drive" and lists_parts(parts):
            raise AttributeError(name)
        return getattr(parts, name)

    @property
    def period(self) -> Any:
        """That of the machine [s]."""
        return self.machine.period

    def acceleration(self, t: Numeric, x: Numeric, v: Numeric, R: Numeric) -> Any:
        """Acceleration of one body under the friction force R [m/s^2]: a force forwards is as much less friction."""
        return self.machine.acceleration(t, x, v, R - self.applied[0])

    def forces(self, t: Numeric, x: Mapping[str, Any], v: Mapping[str, Any]) -> Mapping[str, Any]:
        """Those of a machine that lists its bodies, and the applied ones."""
        own = dict(parts_of(self.machine).forces(t, x, v))
        return {name: _more(own[name], force) if name in own else force for name, force in zip(x, self.applied, strict=True)}

    def mirrored(self) -> Pushed:
        """Its mirror image."""
        from stickslip.models.mirroring import image_of_fields

        return image_of_fields(self, ("applied",))


def _more(own: Any, force: Any) -> Any:
    """A force of a machine, or its parts by name, and one more."""
    return {**own, "applied": own.get("applied", 0.0) + force} if isinstance(own, Mapping) else own + force


def pushed(machine: Model) -> Pushed:
    """The machine with a force of zero on each of its bodies.

    Examples
    --------
    >>> import stickslip as ss
    >>> pushed(ss.Chain.example()).applied, pushed(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4)).applied
    ((0.0, 0.0), (0.0,))
    """
    return Pushed(machine, (0.0,) * len(fresh_mechanics(machine).bodies))  # which refuses equations that its parts do not say


def force_names(machine: Model) -> dict[str, str]:
    """What the applied forces of a machine are called, with the names of the numbers that they are in `pushed` of it.

    Each is called after its body; where one body is the machine's only or principal one it has a short name too. What turns has torques.

    Examples
    --------
    >>> import stickslip as ss
    >>> force_names(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4)), list(force_names(ss.Chain.example()))
    ({'force': 'applied.0'}, ['force on module 1', 'force on module 2'])
    >>> force_names(ss.Joint.example())
    {'torque on joint': 'applied.0'}
    """
    adapter = machine_of(machine)
    if not adapter.names_parts:
        return {"force": "applied.0"}
    bodies, turns = adapter.mechanics.bodies, bool(getattr(machine, "rotary", False))
    names = {f"{'torque' if turns else 'force'} on {body}": f"applied.{i}" for i, body in enumerate(bodies)}
    short = bodies[0] if len(bodies) == 1 else adapter.principal
    return names if short is None or turns else {"force": f"applied.{bodies.index(short)}", **names}
