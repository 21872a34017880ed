"""What a robot, a mechanism or a machine of a user's own may leave out, with its one default."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from stickslip.contracts import Drive, Machine, Track
from stickslip.friction.adapter import law_of

__all__ = ["MachineAdapter", "is_machine", "machine_of"]


@dataclass(frozen=True, eq=False)
class MachineAdapter:
    """A machine, asked for what not every machine has.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = machine_of(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4))
    >>> robot.impulses, robot.breaks, robot.far_end_velocity, robot.drive is None
    ((), (), 0.0, False)
    """

    model: Any

    @property
    def drive(self) -> Drive | None:
        """What shakes its inner mass; None where it has none."""
        return getattr(self.model, "drive", None)

    @property
    def track(self) -> Track | None:
        """What it moves on; None where gravity plays no part."""
        return getattr(self.model, "track", None)

    @property
    def breaks(self) -> tuple[float, ...]:
        """Instants in (0, period) at which its equations are not smooth, of all its parts [s]."""
        parts = (self.model, self.drive, self.track)
        return tuple(sorted({float(s) for part in parts for s in getattr(part, "breaks", None) or ()}))

    @property
    def impulses(self) -> tuple[tuple[Any, Any], ...]:
        """Jumps of its velocity: (instant in [0, period) [s], jump [m/s])."""
        return tuple(getattr(self.model, "impulses", None) or ())

    @property
    def time_scale(self) -> Any:
        """A time in which something happens [s]: its period, or what it says; None where nobody knows."""
        return getattr(self.model, "time_scale", None) if self.model.period is None else self.model.period

    @property
    def free_velocity(self) -> Any:
        """What its drive would do to the body without friction [m/s]."""
        return getattr(self.model, "free_velocity", self.model.velocity_scale)

    @property
    def notes(self) -> list[str]:
        """Remarks on its numbers: its own, or those of its law."""
        own = getattr(self.model, "notes", None)
        load = self.model.load
        return list(law_of(self.model).notes(load(0.0, 0.0) if callable(load) else load) if own is None else own)

    @property
    def is_pulled(self) -> bool:
        """Whether something that moves steadily pulls it along by a spring."""
        return hasattr(self.model, "far_end_velocity")

    @property
    def far_end_velocity(self) -> Any:
        """Velocity of what pulls it [m/s]; 0 where nothing does."""
        return self.model.far_end_velocity if self.is_pulled else 0.0


def machine_of(model: Machine) -> MachineAdapter:
    """A machine, to be asked for what not every machine has."""
    return MachineAdapter(model)


def is_machine(value: Any) -> bool:
    """Whether something has the methods that solvers ask."""
    return hasattr(value, "friction") and hasattr(value, "acceleration")
