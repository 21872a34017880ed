"""Optional parts of a robot, a mechanism or a user-defined machine, with one default for each."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from stickslip.basics.contracts import Drive, Model, OneContact, Track
from stickslip.basics.errors import InputError
from stickslip.models.drives.drive_adapter import drive_of, unlikely
from stickslip.models.drives.within import drives_within
from stickslip.models.friction.law_adapter import SWITCHES, LawAdapter
from stickslip.models.mechanics import Mechanics, OneBody, declares_parts, lists_parts, parts_of
from stickslip.models.state_layout import of_principal


@dataclass(frozen=True, eq=False)
class MachineAdapter:
    """A machine with defaults for its optional parts.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = machine_of(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4))
    >>> robot.impulses, robot.breaks, robot.far_end_velocity, robot.drive is None
    ((), (), 0.0, False)
    """

    model: Any

    @cached_property
    def mechanics(self) -> Mechanics:
        """Its equations of motion, as functions of plain numbers."""
        return fresh_mechanics(self.model)

    @cached_property
    def declaring(self) -> Any:
        """The object that declares the equations: the model, or the machine of several bodies into which its drive turns it."""
        return parts_of(self.model)

    @cached_property
    def is_single(self) -> bool:
        """Whether it is one body with one contact, whose results have no axes for bodies and contacts."""
        return not declares_parts(self.model)

    @property
    def names_parts(self) -> bool:
        """Whether its states and columns carry the names of its bodies and contacts, such as "v.head"."""
        return not self.is_single

    @property
    def one_body(self) -> OneContact | None:
        """The model where it is one body on one contact, with a law and a load of its own; None where it lists bodies and contacts."""
        return self.model if self.is_single else None

    @property
    def principal(self) -> str | None:
        """The body whose motion counts as the machine's; None if there is none, and for one body on one contact."""
        return None if self.is_single else getattr(self.declaring, "principal", None)

    @property
    def own(self) -> dict[str, int]:
        """Numbers of its principal body and of that body's contact by dimension, or of its only ones; empty if it has neither."""
        if self.principal is not None:
            return of_principal(self.principal, self.mechanics.bodies, self.mechanics.slips_of)
        return {"body": 0, "contact": 0} if self.is_single else {}

    @property
    def part_names(self) -> dict[str, tuple[str, ...]]:
        """Names of its bodies, contacts and stops, for the dimensions that columns have; empty for one body on one contact.

        For a machine with a principal body, columns have no dimension for bodies and contacts.

        Examples
        --------
        >>> import stickslip as ss
        >>> machine_of(ss.Chain.example()).part_names
        {'body': ('module 1', 'module 2'), 'contact': ('module 1', 'module 2')}
        """
        m = self.mechanics
        parts = {"body": m.bodies, "contact": m.contacts, "stop": tuple(name for name, _ in m.named_stops)}
        own = self.own
        return {dim: names for dim, names in parts.items() if names and dim not in own}

    @property
    def has_bodies(self) -> bool:
        """Whether it has bodies; a flow has states of its own instead."""
        return True

    @property
    def own_states(self) -> None:
        """Names that it gives its states itself: none, they follow from its bodies and contacts."""

    @property
    def start_names(self) -> tuple[str, ...]:
        """Names of what may be given of a start: positions, velocities and inner states."""
        return ("x", "v", "z")

    @property
    def numbers_by_case(self) -> bool:
        """Whether the numbers of a batch come from whole runs, one case at a time: no, the cases go in lanes."""
        return False

    def column_names(self, start: Mapping[str, Any]) -> tuple[str, ...]:
        """The columns that it names itself: none, they are those of bodies and contacts."""
        return ()

    def named_start(self, start: Any) -> dict[str, Any]:
        """Initial values by name; `InputError` for what is no dict."""
        if start is None or isinstance(start, dict):
            return dict(start or {})
        raise InputError("start", [f"start = {start!r}; allowed is a dict; type for example start=dict(v=0.01)"])

    @property
    def sections(self) -> None:
        """Those by which a section may be cut: they follow too."""

    @property
    def switch_names(self) -> tuple[str, ...]:
        """The switches of its contacts that rest exactly."""
        contacts = zip(self.mechanics.contacts, self.laws, strict=True)
        return tuple(f"{kind} of {name}" for name, law in contacts if not law.dynamic for kind in SWITCHES)

    @property
    def event_names(self) -> tuple[str, ...]:
        """Names of what its own events happen to: its contacts and stops."""
        return (*self.mechanics.contacts, *(stop.name for stop in self.mechanics.stops))

    @property
    def angles(self) -> tuple[str, ...]:
        """Names of its coordinates that are angles while others may be lengths."""
        return self.mechanics.angles

    @property
    def has_displacement(self) -> bool:
        """Whether it makes a way, and so has a mean velocity."""
        return True

    @property
    def unit_of_time(self) -> str:
        """The unit of time, in words."""
        return "second"

    @property
    def has_tolerance(self) -> bool:
        """Whether its runs are solved to a tolerance; else they are exact to rounding."""
        return self.has_inner_states

    @property
    def memories(self) -> int:
        """How many whole numbers its laws remember."""
        return sum(law.modes for law in self.laws)

    @property
    def turning_velocity(self) -> Any:
        """Velocity at which one body on a spring turns back, that of the spring's far end [m/s]; None of anything else."""
        return self.far_end_velocity if self.is_single else None

    @property
    def has_units(self) -> bool:
        """Whether the units of its states are known."""
        return True

    @cached_property
    def laws(self) -> tuple[LawAdapter, ...]:
        """The law of each contact."""
        return self.mechanics.laws

    @property
    def not_followed(self) -> str:
        """Why small changes are not followed along its runs; "" where they are.

        A contact that creeps turns over within velocities in which changes go on faster than time has digits.
        """
        if not all(law.compiles for law in self.laws):
            return "a law is written for plain numbers only"
        creep = any(law.creep_velocity((0.0,) * law.states, 1.0) is not None for law in self.laws)
        return "its friction reverses within creep velocities" if creep else ""

    @property
    def law_names(self) -> str:
        """The names of its laws, each once: "Coulomb + LuGre"."""
        return " + ".join(dict.fromkeys(law.name for law in self.laws))

    @property
    def kind_name(self) -> str:
        """The name of its kind: "LuGre × Harmonic", "Coulomb × Chain × 2"."""
        if self.names_parts:
            laws = [law.name for law in self.laws]
            numbered = [str(len(laws))] if laws else []
            owner = self.model if lists_parts(self.model) else self.model.drive
            return " × ".join([*dict.fromkeys(laws), type(owner).__name__, *numbered])
        parts = [self.law_names, type(self.model).__name__ if self.drive is None else self.drive_name]
        if self.track is not None and type(self.track).__name__ != "Level":
            parts.append(type(self.track).__name__)
        return " × ".join(parts)

    @property
    def named_in_errors(self) -> str:
        """What an error in its functions is said of: its law, or, of several parts, the machine."""
        return type(self.model).__name__ if self.names_parts else self.laws[0].name

    @cached_property
    def has_inner_states(self) -> bool:
        """Whether one of its laws has inner states, so that it is solved to a tolerance and not exactly."""
        return any(law.dynamic for law in self.laws)

    @property
    def drive(self) -> Drive | None:
        """The drive of its inner mass, or of the common centre of mass of several; None if it has none."""
        return getattr(self.model, "whole_drive", getattr(self.model, "drive", None)) if self.is_single else None

    @property
    def inner_masses(self) -> tuple[tuple[Any, Any], ...]:
        """Each inner mass [kg] with its drive; empty without a drive."""
        if self.drive is None:
            return ()
        own = getattr(self.model, "inner_masses", None)
        return ((self.model.inner_mass, self.drive),) if own is None else own

    @property
    def whole_inner_mass(self) -> Any:
        """Sum of its inner masses [kg]."""
        masses = [mass for mass, _ in self.inner_masses]
        return sum(masses[1:], masses[0])

    @property
    def drive_name(self) -> str:
        """The class names of the drives of its inner masses, such as "Harmonic + Harmonic"."""
        return " + ".join(type(drive).__name__ for _, drive in self.inner_masses)

    @property
    def track(self) -> Track | None:
        """Its track; None if it has none."""
        return getattr(self.model, "track", None) if self.is_single else None

    @property
    def wavelength(self) -> Any:
        """Wavelength of its track [m]; None if the track is not periodic, or uniform."""
        return getattr(self.track, "wavelength", None)

    @property
    def breaks(self) -> tuple[float, ...]:
        """Instants in (0, period) at which its equations are not smooth, of all its parts [s]."""
        return tuple(sorted({float(s) for s in self.unsorted_breaks}))

    @property
    def unsorted_breaks(self) -> tuple[Any, ...]:
        """The same instants unsorted, as numbers or symbols."""
        parts = (self.model, self.drive, self.track) if self.is_single else (self.mechanics,)
        return tuple(s for part in parts for s in getattr(part, "breaks", None) or ())

    @property
    def impulses(self) -> tuple[tuple[Any, Any], ...]:
        """Jumps of its velocity: (instant in [0, period) [s], jump [m/s])."""
        return tuple(getattr(self.model, "impulses", None) or ())

    @property
    def jumps(self) -> tuple[tuple[Any, Any], ...]:
        """The same for any machine: a jump is a float for one body, and an array with a number for each of several bodies."""
        if self.is_single:
            return tuple((instant, float(jump)) for instant, jump in self.impulses)
        import numpy as np

        mechanics = self.mechanics
        moves_with = [mechanics.coordinate_of(name) for name in mechanics.bodies]
        return tuple((instant, np.array(jumps, float)[moves_with]) for instant, jumps in mechanics.jumps)

    @property
    def mirror_image(self) -> Callable[[], Any] | None:
        """The function that makes its mirror image, if it has one."""
        return getattr(self.model, "mirrored", None)

    @property
    def time_scale(self) -> Any:
        """A typical time [s]: its period, or the one that it declares; None if unknown."""
        said = self.model if self.is_single else self.mechanics
        return getattr(said, "time_scale", None) if self.model.period is None else self.model.period

    @property
    def velocity_scale(self) -> Any:
        """A typical velocity, against which errors are measured [m/s]."""
        return self.model.velocity_scale if self.is_single else self.mechanics.velocity_scale  # type: ignore[attr-defined]

    @property
    def free_velocity(self) -> Any:
        """The velocity that its drive would give the body without friction [m/s]."""
        own = getattr(self.declaring, "free_velocity", None)
        return self.velocity_scale if own is None else own

    @property
    def notes(self) -> list[str]:
        """Remarks on its numbers: its own, or those of its law; and on drives that no actuator can produce."""
        unlikely_ones = [note for drive in drives_within(self.model) for note in unlikely(drive_of(drive))]
        return list(dict.fromkeys([*unlikely_ones, *self._own_notes]))

    @property
    def _own_notes(self) -> list[str]:
        own = getattr(self.model, "notes", None)
        if own is not None:
            return list(own)
        return self._of_laws(lambda law, load: law.notes(load))

    @property
    def cautions(self) -> list[str]:
        """What its laws say where their energy is examined."""
        return self._of_laws(lambda law, load: law.cautions(load))

    def _of_laws(self, said: Callable[[Any, Any], list[str]]) -> list[str]:
        """The remarks of the law of each contact."""
        mechanics = self.mechanics
        contacts = zip(mechanics.contacts, mechanics.laws, mechanics.loads(0.0, mechanics.start), strict=True)
        return [note if self.is_single else f"{name}: {note}" for name, law, load in contacts for note in said(law, load)]

    @property
    def input(self) -> tuple[Any, dict[str, Any]] | None:
        """The meaning of a recorded torque, current or force: the machine without it, and the force per unit of it, by kind.

        By default it is a force in addition to the machine's own; None if the machine has a driven inner mass.

        Examples
        --------
        >>> import stickslip as ss
        >>> bare, per = machine_of(ss.Joint.example().replace(gear_ratio=50.0)).input
        >>> bare.control is None, per
        (True, {'torque': 50.0})
        """
        own = getattr(self.model, "input", None)
        return own if own is not None else (self.model, {"applied force": 1.0}) if self.drive is None else None

    @property
    def commands(self) -> dict[str, tuple[Any, str, str]]:
        """What may command it in a record, by role: the machine that takes numbers for it, and the names of that number and of its start.

        Examples
        --------
        >>> import stickslip as ss
        >>> {role: names for role, (_, *names) in machine_of(ss.Joint.example()).commands.items()}
        {'command': ['control.target', 'angle']}
        """
        return dict(getattr(self.model, "commands", {}))

    @property
    def is_pulled(self) -> bool:
        """Whether a spring with a steadily moving far end pulls it."""
        return hasattr(self.model, "far_end_velocity")

    @property
    def far_end_velocity(self) -> Any:
        """Velocity of the far end of the spring that pulls it [m/s]; 0 if there is none."""
        return self.model.far_end_velocity if self.is_pulled else 0.0


_KEPT = 8  # machines whose adapters, and with them their equations, are cached: a run and an analysis ask those of one repeatedly
_kept: OrderedDict[int, MachineAdapter] = OrderedDict()


def machine_of(model: Model) -> MachineAdapter:
    """The adapter of a machine; cached for frozen dataclasses, which do not change."""
    kept = _kept.get(id(model))
    if kept is not None and kept.model is model:
        return kept
    made, declared = MachineAdapter(model), getattr(type(model), "__dataclass_params__", None)
    if declared is not None and declared.frozen:
        _kept[id(model)] = made
        while len(_kept) > _KEPT:
            with suppress(KeyError):
                _kept.popitem(last=False)
    return made


def fresh_mechanics(model: Any) -> Mechanics:
    """The equations of a machine, made now: its bodies and contacts are asked again."""
    if not declares_parts(model):
        return OneBody(model)
    from stickslip.models.equations_of_motion import equations_of, mechanics_of

    parts = parts_of(model)
    if getattr(type(parts), "mechanics", mechanics_of) is not mechanics_of:
        raise InputError(type(parts).__name__, [_OWN_MECHANICS])
    return equations_of(parts)


def forget_mechanics() -> None:
    """Forget the adapters that are cached, because a function that made their equations gives others now."""
    _kept.clear()


_OWN_MECHANICS = (
    "it overrides mechanics, which solvers and analyses do not read; allowed are the methods bodies, contacts, links, stops, forces and "
    'controllers; type for example def forces(self, t, x, v): return {"cart": -self.k * x["cart"]} for forces, and '
    'ss.Contact("cart", law, load=lambda t, x, v, forces: ...) for loads; a system with other equations (masses that depend on x, a load '
    "that follows from friction) is an ss.SwitchingFlow with contacts={...} of ss.machines.FlowContact"
)


def is_machine(value: Any) -> bool:
    """Whether an object has the methods that solvers need."""
    return not isinstance(value, type) and (declares_parts(value) or (hasattr(value, "friction") and hasattr(value, "acceleration")))
