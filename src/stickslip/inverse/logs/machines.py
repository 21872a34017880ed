"""The kinds of machines that a file may be of: what each needs of a record, and how it is fitted by `ss.identify`."""

from __future__ import annotations

import inspect
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.basics.spelling import spelled
from stickslip.basics.units import quantity_of
from stickslip.inverse.logs.sizes import Sizes, sizes_of
from stickslip.models.friction import Coulomb, CoulombViscous, Dahl, LuGre, Stribeck
from stickslip.models.machines import Joint
from stickslip.models.presets import piezo_rig

if TYPE_CHECKING:
    from stickslip.records.record import Record

_LEAST, _MOST = 1e-3, 3.0  # of the size of a force, between which a coefficient is sought


@dataclass(frozen=True)
class Task:
    """One call of `ss.identify`, as it is made and as it is written.

    Parameters
    ----------
    make : callable or machine
    made_by : str
        The expression that makes `make`.
    free : dict
        Bounds of the free parameters.
    options : dict
        Everything else.
    """

    make: Any
    made_by: str
    free: dict[str, tuple[Any, ...]]
    options: dict[str, Any] = field(default_factory=dict)
    values: Callable[[list[Any]], list[Any]] = list  # what of the records is fitted
    values_by: str = "{}"  # the expression that makes it of the records
    in_amperes: bool = False  # whether torques are over a motor constant that nobody gave

    def __call__(self, records: list[Any], **more: Any) -> Any:
        """The fit."""
        from stickslip.inverse.identification import identify

        fit = identify(self.values(records), self.make, free=self.free, **self.options, **more)
        return replace(fit, in_amperes=self.in_amperes)

    def written(self, records: str) -> str:
        """The call as Python; the numbers are those of the call to the last digit."""
        free = "".join(f"        {name!r}: {bounds!r},\n" for name, bounds in self.free.items())
        options = "".join(f"    {name}={value!r},\n" for name, value in self.options.items())
        return f"fit = ss.identify(\n    {self.values_by.format(records)},\n    {self.made_by},\n    free={{\n{free}    }},\n{options})"


class Kind(ABC):
    """Base of the kinds of machines."""

    name: ClassVar[str]
    words: ClassVar[str]
    laws: ClassVar[tuple[str, ...]]
    richer: ClassVar[tuple[str, ...]] = ()  # laws that are tried where none of the others is supported
    over_motion: ClassVar[bool] = True  # whether forces are fitted over a motion
    timed: bool = True  # whether it needs to be known when values were taken; others are rows of a table
    advises: bool = True  # whether `Fit.next_experiment` knows records of this kind
    takes: ClassVar[dict[str, str]] = {}  # numbers that may be typed, with what they are
    needs: ClassVar[dict[str, str]] = {}  # those of them without which nothing can be fitted, with an example
    why_needed: ClassVar[str] = "the motion of a shaken robot determines friction only where its drive is known"  # in a sentence
    by_file: ClassVar[frozenset[str]] = frozenset()  # those that may differ from file to file

    @abstractmethod
    def suits(self, rec: Record) -> str:
        """What of a record speaks for this kind; empty where something is missing."""

    def missing(self, records: Sequence[Record], given: dict[str, Any]) -> list[str]:
        """Numbers without which nothing can be fitted, and that neither the records have nor the user gave."""
        return [name for name in self.needs if name not in given]

    def lacks(self, records: Sequence[Record], given: dict[str, Any]) -> str:
        """What has to be typed, in a sentence; empty where nothing is missing."""
        if not (missing := self.missing(records, given)):
            return ""
        typed = ", ".join(f'"{name}": {self.needs[name]}' for name in missing)
        what = f"{' and '.join(missing)} {'is' if len(missing) == 1 else 'are'} missing"
        return f"{what}: {self.why_needed}; type for example numbers={{{typed}}}"

    def assumed(self, records: Sequence[Record], given: dict[str, Any]) -> dict[str, tuple[str, str]]:
        """Numbers that nobody gave: name -> (value in words, why)."""
        return {}

    def doubt(self, records: Sequence[Record], given: dict[str, Any]) -> str:
        """What may be wrong where no law with one coefficient for both directions is supported, with what to type; mostly nothing."""
        return ""

    @abstractmethod
    def task(self, records: Sequence[Record], law: str, given: dict[str, Any], asymmetric: bool) -> Task:
        """How a law is fitted."""


def over_time(rec: Record) -> bool:
    """Whether it is known when the values of a record were taken."""
    return any(c.axis_name != "sample" and c.over_time for c in rec.channels.values())


def quantity_in(rec: Record, role: str) -> str | None:
    """What the channel in a role measures; None where there is none."""
    return quantity_of(rec[role].unit) if role in rec else None


def _moves(rec: Record, *quantities: str) -> str:
    return next((role for role in ("position", "velocity") if quantity_in(rec, role) in quantities), "")


def _sides(free: dict[str, tuple[Any, ...]], asymmetric: bool) -> dict[str, tuple[Any, ...]]:
    """Coefficients of both directions apart, where that is asked for."""
    if not asymmetric:
        return free
    apart: dict[str, tuple[Any, ...]] = {}
    for name, bounds in free.items():
        both = name.rpartition(".")[2] in ("mu", "f")
        apart |= {f"{name}_plus": bounds, f"{name}_minus": bounds} if both else {name: bounds}
    return apart


def _fading(of: Sizes, load: float) -> dict[str, tuple[Any, ...]]:
    """Bounds of static friction, and of the velocity over which it fades."""
    return {"f": (_LEAST * of.force / load, 2 * _MOST * of.force / load), "v_s": (1e-3 * of.speed, of.speed, "log")}


#: Laws over a measured motion: the class, and the bounds of its numbers from the sizes of force F, speed v and stroke s.
_OVER_MOTION: dict[str, tuple[Any, Callable[[Sizes, float], dict[str, tuple[Any, ...]]]]] = {
    "coulomb": (Coulomb, lambda of, load: {}),
    "coulomb-viscous": (CoulombViscous, lambda of, load: {"viscous": (0.0, _MOST * of.force / of.speed)}),
    "stribeck": (Stribeck, lambda of, load: _fading(of, load)),
    "stribeck-viscous": (Stribeck, lambda of, load: _fading(of, load) | {"viscous": (0.0, _MOST * of.force / of.speed)}),
    "dahl": (Dahl, lambda of, load: {"sigma0": (of.force / of.stroke, 1e5 * of.force / of.stroke, "log")}),
    "lugre": (
        LuGre,
        lambda of, load: _fading(of, load) | {"sigma0": (of.force / of.stroke, 1e5 * of.force / of.stroke, "log")},
    ),
}


def rounded_bounds(bounds: tuple[Any, ...]) -> tuple[Any, ...]:
    """Bounds to two digits, as a person would type them."""
    return tuple(float(f"{each:.1e}") if isinstance(each, float) else each for each in bounds)


class Rig(Kind):
    """A rig that moves a contact and measures its friction force; with a mass of its own where force and motion are those of a body."""

    name = "rig"
    words = "a friction rig: its friction force over its motion"
    laws = ("coulomb", "coulomb-viscous", "stribeck", "stribeck-viscous")
    richer: ClassVar[tuple[str, ...]] = ("dahl", "lugre")
    takes: ClassVar[dict[str, str]] = {"load": "normal force [N]"}
    free_mass: ClassVar[bool] = False

    def suits(self, rec: Record) -> str:
        """What of a record speaks for it; empty where something is missing."""
        motion = _moves(rec, "position", "velocity")
        return f"a force beside a {motion}" if quantity_in(rec, "force") == "force" and motion else ""

    def assumed(self, records: Sequence[Record], given: dict[str, Any]) -> dict[str, tuple[str, str]]:
        """Numbers that nobody gave: name -> (value in words, why)."""
        if all("load" in rec for rec in records):
            return {}
        return {"load": ("1", "no normal force in the file: coefficients are friction forces [N]")}

    def task(self, records: Sequence[Record], law: str, given: dict[str, Any], asymmetric: bool) -> Task:
        """How a law is fitted."""
        cls, more = _OVER_MOTION[law]
        of = sizes_of(records, "force")
        measured = "load" not in given and all("load" in rec for rec in records)
        load = float(np.nanmedian(np.concatenate([rec["load"].si for rec in records]))) if measured else float(given.get("load", 1.0))
        if not load > 0:
            mend = 'type numbers={"load": 20}, or mend its sign'
            raise InputError("fit", [f"the normal force is {load:.3g} N; allowed is a positive one; {mend}"])
        free = {"mu": (_LEAST * of.force / load, _MOST * of.force / load)} | more(of, load)
        bounds = _sides({name: rounded_bounds(each) for name, each in free.items()}, asymmetric)
        # numbers without effect, which are not sought
        rest = {"sigma1": 0.0, "sigma2": 0.0, "exponent": 2.0 if cls is Stribeck else 1.0}
        own = {f: value for f, value in rest.items() if f in inspect.signature(cls).parameters}
        options: dict[str, Any] = ({} if measured else {"load": load}) | own
        if self.free_mass:
            options["sensor"] = {"offset": None, "drift": None, "gain": ("normal", 1.0, 0.02), "inertia": None}
        return Task(cls, f"ss.{cls.__name__}", bounds, options)


class Slider(Rig):
    """A body under a measured force, whose mass takes part of it."""

    name = "slider"
    words = "a body under a measured force, with a mass that is fitted too"
    free_mass = True


class JointLog(Kind):
    """A joint or servo whose torque or current was logged beside its angle."""

    name = "joint"
    words = "a joint or servo: what it takes to move inertia and gravity against friction"
    laws = ("coulomb", "coulomb-viscous", "stribeck", "stribeck-viscous")
    takes: ClassVar[dict[str, str]] = {
        "motor_constant": "torque for each ampere [N m/A]",
        "gear_ratio": "turns of the motor for each of the joint",
        "inertia": "moment of inertia, where it is known [kg m^2]",
        "gravity_torque": "torque of gravity, where it is known; 0 about an upright axis [N m]",
    }

    def suits(self, rec: Record) -> str:
        """What of a record speaks for it; empty where something is missing."""
        motion, applied = _moves(rec, "angle", "angular velocity"), self._applied(rec)
        return f"a {applied} beside an angle" if motion and applied else ""

    def _applied(self, rec: Record) -> str:
        return "torque" if quantity_in(rec, "force") == "torque" else "current" if quantity_in(rec, "current") == "current" else ""

    def assumed(self, records: Sequence[Record], given: dict[str, Any]) -> dict[str, tuple[str, str]]:
        """Numbers that nobody gave: name -> (value in words, why)."""
        assumed = {"gear_ratio": ("1", "torque and angle on one side of the gear")}
        if self._applied(records[0]) == "current":
            assumed["motor_constant"] = ("1", "not in the file: numbers are in amperes, a torque each over the motor constant")
        turns = all("position" in rec for rec in records)
        why = "the angle is counted from where the arm hangs" if turns else "the angle was not measured"
        assumed["gravity_torque"] = ("fitted" if turns else "0", why)
        return assumed | {"inertia": ("fitted", "it is not known")}

    def task(self, records: Sequence[Record], law: str, given: dict[str, Any], asymmetric: bool) -> Task:
        """How a law is fitted."""
        applied = self._applied(records[0])
        of = sizes_of(records, "force" if applied == "torque" else "current")
        per = float(given.get("gear_ratio", 1.0)) * (float(given.get("motor_constant", 1.0)) if applied == "current" else 1.0)
        of = Sizes(of.force * per, of.speed, of.stroke, of.acceleration)
        cls, more = _OVER_MOTION[law]
        turns = all("position" in rec for rec in records)
        free: dict[str, tuple[Any, ...]] = {"inertia": (1e-4 * of.force / of.acceleration, _MOST * of.force / of.acceleration)}
        free |= {"gravity_torque": (-_MOST * of.force, _MOST * of.force)} if turns else {}
        free |= {f"friction.{name}": bounds for name, bounds in ({"mu": (0.0, _MOST * of.force)} | more(of, 1.0)).items()}
        free = {name: rounded_bounds(bounds) for name, bounds in free.items() if name not in given}
        example = {name: _middle(bounds) for name, bounds in free.items()}
        friction = {name.removeprefix("friction."): value for name, value in example.items() if name.startswith("friction.")}
        law_made = cls(**friction, **({"exponent": 2.0} if cls is Stribeck else {}))
        own: dict[str, Any] = {name: float(given[name]) for name in self.takes if name in given}
        in_amperes = applied == "current" and "motor_constant" not in given
        own |= {"motor_constant": 1.0} if in_amperes else {}
        joint: Joint = Joint(**({"inertia": example.get("inertia", 1.0)} | own), friction=law_made, torque=0.0)
        options = {"sensor": {"offset": None}} if applied == "torque" else {"sensor": {"offset": None, "drift": 0.0}}
        return Task(joint, spelled(joint, 1), _sides(free, asymmetric), options, in_amperes=in_amperes)


def _middle(bounds: tuple[Any, ...]) -> float:
    """A number between two bounds, nearer the lower one, so that static friction is not below kinetic friction."""
    low, high = bounds[:2]
    return float(f"{math.sqrt(low * high) if len(bounds) == 3 else low + 0.4 * (high - low):.2g}")


class Shaken(Kind):
    """A robot with an inner mass that is shaken, whose velocity (or position) was measured."""

    name = "robot"
    words = "a robot shaken by an inner mass: its steady motion over the drive's period"
    laws = ("coulomb", "coulomb-static", "lugre")
    over_motion = False
    advises = False
    takes: ClassVar[dict[str, str]] = {
        "amplitude": "amplitude of the inner mass [m]", "tilt_deg": "tilt of the track [degrees]", "frequency": "of the drive [Hz]",
        "body_mass": "[kg]", "inner_mass": "[kg]",
    }  # fmt: skip
    needs: ClassVar[dict[str, str]] = {"amplitude": "5e-4", "tilt_deg": "1.7"}
    by_file: ClassVar[frozenset[str]] = frozenset(takes)
    _free: ClassVar[dict[str, tuple[Any, ...]]] = {"mu0": (0.01, 1.0), "f0": (0.01, 1.5), "v_s": (1e-4, 0.1, "log")}
    _of: ClassVar[dict[str, tuple[str, ...]]] = {"coulomb": ("mu0",), "coulomb-static": ("mu0", "f0"), "lugre": ("mu0", "f0", "v_s")}

    def lacks(self, records: Sequence[Record], given: dict[str, Any]) -> str:
        """What has to be typed, in a sentence; empty where nothing is missing."""
        lacking, masses = super().lacks(records, given), [name for name in ("body_mass", "inner_mass") if name not in given]
        if not lacking or not masses:
            return lacking
        return f"{lacking}; {' and '.join(masses)} [kg] {'is that' if len(masses) == 1 else 'are those'} of the paper's robot unless given"

    def suits(self, rec: Record) -> str:
        """What of a record speaks for it; empty where something is missing."""
        motion = _moves(rec, "velocity", "position")
        pushed = {"force", "current"} & {c.role for c in rec.channels.values()}
        return f"a {motion}, and neither a force nor a current" if motion and not pushed else ""

    def assumed(self, records: Sequence[Record], given: dict[str, Any]) -> dict[str, tuple[str, str]]:
        """Numbers that nobody gave: name -> (value in words, why)."""
        lines = [] if "frequency" in given else [f"{self._frequency(rec):.6g} Hz" for rec in records]
        assumed = {"frequency": (", ".join(dict.fromkeys(lines)), "the line of the record")} if lines else {}
        defaults = {name: p.default for name, p in inspect.signature(piezo_rig).parameters.items()}
        return assumed | {name: (f"{defaults[name]:g} kg", "that of the paper's robot; type yours") for name in ("body_mass", "inner_mass")}

    def doubt(self, records: Sequence[Record], given: dict[str, Any]) -> str:
        """On a level track a robot gets ahead by a difference of the directions."""
        level = np.all(np.asarray(given.get("tilt_deg", 0.0)) == 0.0)
        return (
            "asymmetric=True, a coefficient for each direction: on a level track it is their difference that moves a robot" if level else ""
        )

    def _frequency(self, rec: Record) -> float:
        return float(rec.drive_frequency().value)

    def task(self, records: Sequence[Record], law: str, given: dict[str, Any], asymmetric: bool) -> Task:
        """How a law is fitted."""
        hertz = given["frequency"] if "frequency" in given else [self._frequency(rec) for rec in records]
        own: dict[str, Any] = {name: scaled(value) for name, value in given.items() if name != "frequency"}
        own |= {"omega": scaled(hertz, 2 * math.pi), "law": law}
        if asymmetric:
            return self._by_sides(own)
        return Task(piezo_rig, "ss.presets.piezo_rig", {name: self._free[name] for name in self._of[law]}, own)

    def _by_sides(self, own: dict[str, Any]) -> Task:
        """With coefficients of each direction: the tilt of the track is gravity then, and not part of them."""
        if lists := [name for name, value in own.items() if isinstance(value, list)]:
            problem = f"{' and '.join(lists)} differ from file to file, and asymmetric=True takes numbers that all files share"
            raise InputError("fit", [f"{problem}; type each file alone, or leave asymmetric out"])
        own = own | {"incline": "gravity"}
        free = {f"friction.{name}": self._free[f"{name}0"] for name in ("mu", "f") if f"{name}0" in self._of[own["law"]]}
        free |= {"friction.v_s": self._free["v_s"]} if "v_s" in self._of[own["law"]] else {}
        typed = ", ".join(f"{name}={value!r}" for name, value in own.items())
        return Task(piezo_rig(**own), f"ss.presets.piezo_rig({typed})", _sides(free, asymmetric=True))


def scaled(value: Any, by: float = 1.0) -> float | list[float]:
    """A number times a factor, or several, one for each file; several that are one number are that.

    Examples
    --------
    >>> scaled(2, 3.0), scaled([1.0, 2.0], 2.0), scaled([1.0, 1.0])
    (6.0, [2.0, 4.0], 1.0)
    """
    if not isinstance(value, (list, tuple)):
        return by * float(value)
    each = [by * float(v) for v in value]
    return each[0] if len(set(each)) == 1 else each
