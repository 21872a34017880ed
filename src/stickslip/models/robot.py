"""The vibration-driven robot and its equations of motion."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.arguments import ROBOT, described_as, explains_arguments
from stickslip.basics.batch import check_shape, shape_of
from stickslip.basics.contracts import Drive, Law, Numeric, Track
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.fields import Frozen, describe, leaves
from stickslip.basics.maths import is_symbol
from stickslip.basics.quantities import BODY_MASS, GRAVITY, INNER_MASS, remarks_on_gravity
from stickslip.models.drives.drive_adapter import LEVEL, MISTAKEN, NEEDS, drive_of, lacking, needs_of
from stickslip.models.drives.force import FORCE_NEEDS
from stickslip.models.drives.together import Together, common_cycles
from stickslip.models.forces import check_law
from stickslip.models.friction.law_adapter import law_of
from stickslip.models.tables import from_toml, record_html, to_toml
from stickslip.models.tracks import Level
from stickslip.models.tracks.profiles import place_grip_of
from stickslip.models.tracks.tracks import folded_tilt, grip_of, law_was_replaced, without_its_law


class _PartKinds:
    """Kinds of a robot's parts in a study file; read when asked for, because a drive by force is made of parts that know robots."""

    def __get__(self, robot: Any, cls: type) -> dict[str, dict[str, Any]]:
        from stickslip.models.drives import DRIVES
        from stickslip.models.machines.forced import Forced

        return {"drive": {**DRIVES, "forced": Forced}}


@described_as(f"a Robot; {ROBOT}")
@dataclass(frozen=True, eq=False)
class Robot(Frozen):
    r"""A rigid body on a track with a mass that vibrates inside it: Eqs 2.1 to 2.3 of the paper.

    .. math:: \ddot x = -\mu\,\ddot\xi(t) + g\sin\theta - \frac{R}{M+m}, \qquad \mu = \frac{m}{M+m}

    Several inner masses are a tuple of masses and a tuple of drives, and then :math:`m=\sum m_j`, :math:`m\,\xi=\sum m_j\xi_j`.

    Any number of the robot or of its parts may be an array; arrays broadcast and the result has their shape.

    Parameters
    ----------
    body_mass : float
        Mass M of the body [kg].
    inner_mass : float or tuple of float
        Mass m of the vibrating inner mass [kg]; a tuple has one for each of several inner masses (an array means cases).
    drive : Harmonic or any drive, or a tuple of them
        Motion of the inner mass relative to the body; a tuple has a drive for each inner mass, with a common period. With a `Forced` drive
        the inner mass moves freely, and the robot has two bodies, "body" and "inner": results are those of the body, and
        ``run.bodies["inner"].x`` is where the inner mass is.
    friction : Coulomb or LuGre or any law
        Friction law of the body on the track.
    gravity : float
        Acceleration of gravity [m/s^2].
    track : Level, Incline, VaryingFriction, FrictionPatches or any track
        What gravity does along and across the track, and whether friction varies in time or along it.
    cycles : tuple of int, optional
        For several inner masses, the number of periods of each drive in the common period: found from the periods, never given.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.Robot(body_mass=0.0626, inner_mass=0.0095, drive=ss.Harmonic(amplitude=6e-4, omega=205.0),
    ...                  friction=ss.Coulomb(mu_plus=0.15, mu_minus=0.21))
    >>> round(robot.mass_ratio, 4)
    0.1318
    """

    body_mass: float = field(metadata=BODY_MASS)
    inner_mass: float | tuple[float, ...] = field(metadata=INNER_MASS)
    drive: Any
    friction: Any
    gravity: float = field(default=9.81, metadata=GRAVITY)
    track: Any = dataclasses.field(default_factory=Level)
    cycles: tuple[int, ...] | None = dataclasses.field(default=None, repr=False, metadata={"found": "from the periods of the drives"})

    part_kinds = _PartKinds()

    def _check(self, problems: Problems) -> None:
        several = isinstance(self.drive, tuple)
        drives = {f"drive[{i}]": part for i, part in enumerate(self.drive)} if several else {"drive": self.drive}
        for name, part in {**drives, "track": self.track}.items():
            kind = name.partition("[")[0]
            needs = (NEEDS if several else needs_of(part)) if kind == "drive" else ("across", "along")
            if lacking(part, needs):
                typed = f"drive=ss.machines.Forced({type(part).__name__}(...))" if not lacking(part, FORCE_NEEDS) else _PARTS[kind]
                listed = "this is a list, and several inner masses are given as a tuple; " if isinstance(part, list) else ""
                problems.add(f"{name} = {part!r}; {listed}allowed is an object with {', '.join(needs)}; type for example {typed}")
            elif not dataclasses.is_dataclass(part):
                problems.add(f"{name} = {part!r} is not a dataclass; {_NO_DATACLASS}")
        if several or isinstance(self.inner_mass, tuple):
            _check_masses(self.drive, self.inner_mass, problems)
        cycles = common_cycles([drive.period for drive in self.drive], problems) if several and not problems.mistakes else None
        object.__setattr__(self, "cycles", cycles)
        check_law(self.friction, problems)
        check_shape(self, problems)

    def replace(self, changes: dict[str, Any] | None = None, /, **fields: Any) -> Any:
        """A copy with some fields changed; a dotted name reaches into a part: ``replace({"drive.amplitude": 1e-4})``.

        If a preset folded the incline into the friction law, another law does not contain it, and `notes` says so; ``replace(friction=law,
        track=ss.Incline(tilt=0.03))`` keeps it. With the folded law, a track with an incline would count it twice and is refused.
        """
        given = {**(changes or {}), **fields}
        if "track" in given and "friction" not in given:
            _refuse_two_inclines(self, given["track"])
        made = super().replace(changes, **fields)
        if "friction" in given and "track" not in given and _any(folded_tilt(self.track) != 0):
            return dataclasses.replace(made, track=without_its_law(made.track))
        return made

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the batch; () for a single robot."""
        return shape_of(self)

    @property
    def total_mass(self) -> float:
        """M + m [kg]."""
        return self.body_mass + self.whole_inner_mass

    @property
    def inner_masses(self) -> tuple[tuple[Any, Any], ...]:
        """Each inner mass [kg] with its drive."""
        masses: Any = self.inner_mass
        return tuple(zip(masses, self.drive, strict=True)) if isinstance(self.drive, tuple) else ((masses, self.drive),)

    @property
    def whole_inner_mass(self) -> Any:
        """m, all inner masses together [kg]."""
        return self.whole_drive.mass if isinstance(self.drive, tuple) else self.inner_mass

    @property
    def whole_drive(self) -> Any:
        """Motion of the common centre of mass of the inner masses relative to the body; with one mass, the drive itself."""
        masses: Any = self.inner_mass
        return Together(self.drive, masses, self.cycles or ()) if isinstance(self.drive, tuple) else self.drive

    @property
    def mass_ratio(self) -> float:
        """mu = m / (M + m), not a friction coefficient [-]."""
        return self.whole_inner_mass / self.total_mass

    @property
    def period(self) -> float:
        """Period of the drive, or the smallest common one of several [s]."""
        return self.whole_drive.period

    @property
    def velocity_scale(self) -> float:
        """Velocity scale of the drive, against which errors are measured: A omega for a harmonic one [m/s]."""
        return drive_of(self.whole_drive).velocity_scale

    @property
    def free_velocity(self) -> float:
        """Velocity amplitude of the body without friction, A mu omega: the scale for comparing strobe points [m/s]."""
        return self.velocity_scale * self.mass_ratio

    @property
    def breaks(self) -> Any:
        """Instants in (0, period) at which the drive is not smooth [s]."""
        return drive_of(self.whole_drive).breaks

    @property
    def impulses(self) -> tuple[tuple[Any, Any], ...]:
        """Jumps of the body's velocity: (instant in [0, period) [s], jump [m/s])."""
        return tuple((instant, -self.mass_ratio * jump) for instant, jump in drive_of(self.whole_drive).jumps)

    def contact_velocity(self, v: Numeric) -> Any:
        """Velocity at the contact [m/s]."""
        return v

    def load(self, t: Numeric, x: Numeric) -> Any:
        """Normal force N on the track [N], as the law sees it.

        The weight (M + m) g, on an incline times cos(tilt); plus what a vertical vibration adds; times the factor of a track whose
        friction varies in time, or along it.
        """
        weight = self.total_mass * self.track.across(self.gravity)
        lift, grip, local = drive_of(self.whole_drive).vertical_acceleration, grip_of(self.track), place_grip_of(self.track)
        force = weight if lift is None else weight + self.whole_inner_mass * lift(t)
        force = force if grip is None else force * grip(t, self.period)
        return force if local is None else force * local(x)

    def acceleration(self, t: Numeric, x: Numeric, v: Numeric, R: Numeric) -> Any:
        """Acceleration of the body [m/s^2] (Eq. 2.3)."""
        return -self.mass_ratio * self.whole_drive.acceleration(t) + self.track.along(self.gravity) - R / self.total_mass

    def actuator_force(self, t: Numeric, acceleration: Numeric) -> Any:
        """Force F of the actuator on the body [N] (second line of Eq. 2.1, with gravity along the track)."""
        return -self.whole_inner_mass * (acceleration + self.whole_drive.acceleration(t) - self.track.along(self.gravity))

    def actuator_power(self, t: Numeric, acceleration: Numeric) -> Any:
        """Power of the actuators between the body and each inner mass [W]."""
        free = acceleration - self.track.along(self.gravity)
        return sum(m * (free + drive.acceleration(t)) * drive.velocity(t) for m, drive in self.inner_masses)

    @property
    def notes(self) -> list[str]:
        """Remarks on these numbers that are not errors, such as a beam bent too far."""
        remarks = [*drive_of(self.whole_drive).notes, *law_of(self).notes(self.load(0.0, 0.0))]
        return (
            remarks + _beyond_friction(self.friction) + _unfolded(self) + _slides(self) + _lifted(self) + remarks_on_gravity(self.gravity)
        )

    def to_toml(self) -> str:
        """The robot as TOML text, every digit kept; `from_toml` reads it back."""
        return to_toml(self)

    @classmethod
    @explains_arguments
    def from_toml(cls, text: str) -> Robot:
        """A robot from the TOML text of a study file or of `to_toml`."""
        return from_toml(cls, text)

    def _repr_html_(self) -> str:
        return record_html(self, self.notes)


_COEFFICIENTS = ("mu_plus", "mu_minus", "f_plus", "f_minus")
_STICKIEST = 5.0  # friction coefficients: rubber has up to about 4
_NO_DATACLASS = "write @dataclass(frozen=True) above the class, so that its numbers are known"
_PARTS = {
    "drive": "drive=ss.Harmonic(amplitude=5e-4, omega=205.46)",
    "track": 'track=ss.Level() or track=ss.Incline(tilt="3 deg")',
}


def _check_masses(drive: Drive, mass: Any, problems: Problems) -> None:
    """Note inner masses that are not as many as their drives; the error of a list was reported already."""
    counts = [len(part) if isinstance(part, tuple) else None for part in (mass, drive)]
    if isinstance(mass, list) or isinstance(drive, list) or (counts[0] == counts[1] and counts[0]):
        return
    masses, drives = ("one" if count is None else f"a tuple of {count}" for count in counts)
    allowed = f"allowed is one of each, or as many masses as drives; type inner_mass={(0.005,) * (counts[1] or counts[0] or 2)}"
    problems.add(f"inner_mass is {masses} and drive is {drives}; {allowed}")


def _refuse_two_inclines(robot: Robot, track: Track) -> None:
    """An error if a track with an incline is given to a robot whose friction law contains one."""
    tilt = folded_tilt(robot.track)
    if not _any(tilt != 0) or law_was_replaced(robot.track):
        return
    if lacking(track, ("across", "along")) or not _any(track.along(robot.gravity) != 0):
        return
    allowed = "allowed is to replace friction and track together, or a track without an incline"
    typed = 'make the robot with incline="gravity" and then type replace(track=...), or type replace(friction=..., track=...)'
    folded = f"the tilt of {_steepest(tilt)} degrees is folded into the friction law (Eq. 4.1), and another track would add to it"
    raise InputError("Robot", [f"{folded}; {allowed}; {typed}"])


def _beyond_friction(law: Law) -> list[str]:
    """A remark on friction coefficients that no two materials have, such as those typed as per cent."""
    coefficients = [(name, value) for name, value in leaves(law) if name.rpartition(".")[2] in _COEFFICIENTS and not is_symbol(value)]
    return [
        f"{MISTAKEN} friction.{name} = {describe(value)} is a coefficient: 15 % is 0.15"
        for name, value in coefficients
        if _any(value > _STICKIEST)
    ][:1]


def _unfolded(robot: Robot) -> list[str]:
    """A remark if another law took the place of one into which a tilt was folded, or numbers that are the same both ways."""
    tilt = folded_tilt(robot.track)
    if not _any(tilt != 0) or not (law_was_replaced(robot.track) or _same_both_ways(robot.friction)):
        return []
    return [
        f"{LEVEL} the tilt of {_steepest(tilt)} degrees was folded into the friction law that this one took the place of; for "
        'an incline make the robot with incline="gravity", or type replace(track=ss.Incline(...)); if this law contains it, '
        "replace(track=ss.Level()) takes this note away"
    ]


def _steepest(tilt: Any) -> str:
    """The largest of some tilts [rad], in degrees."""
    import numpy as np

    return f"{np.max(abs(np.degrees(np.asarray(tilt)))):.4g}"


def _same_both_ways(law: Law) -> bool:
    """Whether the numbers of a law are the same forwards and backwards."""
    numbers = dict(leaves(law))
    for name, backward in numbers.items():
        if "_minus" in name:
            forward = numbers.get(name.replace("_minus", "_plus"), numbers.get(name.replace("_minus", "")))
            if forward is not None and _any(forward != backward):
                return False
    return True


def _slides(robot: Robot) -> list[str]:
    """A remark if gravity alone moves the body."""
    load, pull = robot.load(0.0, 0.0), robot.total_mass * robot.track.along(robot.gravity)
    limits = law_of(robot).limits(load) if _any(pull != 0) else None
    if limits is None or not (_any(pull > limits[1]) or _any(pull < limits[0])):
        return []
    import numpy as np

    most = np.max(abs(np.asarray(pull / load)))
    return [
        f"the body slides by itself, and there may be no steady motion: gravity along the track reaches {most:.4g} of the load "
        f"(tan(tilt)), and static friction holds {np.min(np.asarray(limits[1] / load)):.4g} forwards "
        f"and {np.min(np.asarray(-limits[0] / load)):.4g} backwards"
    ]


def _any(condition: Any) -> bool:
    return bool(condition.any()) if hasattr(condition, "any") else bool(condition)


def _lifted(robot: Robot) -> list[str]:
    """A remark if a vertical vibration takes the body off the track."""
    if drive_of(robot.whole_drive).vertical_acceleration is None:
        return []
    import numpy as np

    least = float(np.min([np.min(robot.load(robot.period * (k / 64), 0.0)) for k in range(64)]))
    remark = f"vertical vibration takes the body off the track: its load falls to {least:.4g} N; a run ends where the contact is lost"
    return [remark] if least <= 0 else []
