"""Base class of the built-in drives: everything that follows from the period and the relative motion."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import Any, ClassVar

from stickslip.basics.contracts import ArrayLike, Numeric
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.fields import Frozen, checked_number, describe, everywhere, example_in, is_array, number
from stickslip.basics.maths import pi
from stickslip.basics.quantities import positive


class Drive(Frozen):
    """Base of our drives. A user's own drive needs nothing from here."""

    breaks: ClassVar[Any] = ()  # instants in (0, period) at which the acceleration is not smooth [s]
    jumps: ClassVar[Any] = ()  # (instant in [0, period), jump of the relative velocity [m/s])
    smooth: ClassVar[Any] = False  # whether its equations are one formula for all times, and not for one period only

    @classmethod
    def example(cls) -> Any:
        """The drive with the examples of its fields."""
        return example_in(cls)

    @property
    def specific_energy(self: Any) -> Any:
        """Largest kinetic energy of the relative motion for each kilogram of the inner mass [J/kg]."""
        return 0.5 * self.velocity_scale**2


class OfPeriod:
    """Base of the drives that are given by their period."""

    @property
    def omega(self: Any) -> float:
        """Angular frequency 2 pi / T [rad/s]."""
        return 2 * pi / self.period

    @property
    def frequency(self: Any) -> float:
        """Frequency 1/T [Hz]."""
        return 1 / self.period


class OfFrequency:
    """Base of the drives that are given by their angular frequency (of the first harmonic)."""

    @property
    def period(self: Any) -> float:
        """Period T = 2 pi / omega [s]."""
        return 2 * pi / self.omega

    @property
    def frequency(self: Any) -> float:
        """Frequency omega / (2 pi) [Hz]."""
        return self.omega / (2 * pi)

    def __repr__(self: Any) -> str:
        given = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        shown = [as_typed(v) if name == "omega" else f"{name}={v!r}" for name, v in given.items() if v is not None]
        return f"{type(self).__name__}({', '.join(shown)})"


class Remarked(Frozen):
    """Base of the parts that have remarks on the source of their numbers."""

    notes: Any

    def __post_init__(self) -> None:
        if self.notes is not None:
            object.__setattr__(self, "notes", tuple(self.notes))
        super().__post_init__()

    def replace(self, changes: dict[str, Any] | None = None, /, **fields: Any) -> Any:
        """A copy with some fields changed, without the remarks on the old ones."""
        return super().replace({"notes": None, **(changes or {}), **fields})


class PeriodicDrive(OfPeriod, Drive):
    """A drive that is given by its period."""


def as_typed(omega: Any) -> str:
    """The argument that gave this angular frequency: of frequency and omega the one with fewer digits that gives it exactly.

    Examples
    --------
    >>> as_typed(2 * pi * 32.7), as_typed(205.46), as_typed(0.7)
    ('frequency=32.7', 'omega=205.46', 'omega=0.7')
    """
    if isinstance(omega, float) and math.isfinite(omega):
        hertz = float(f"{omega / (2 * pi):.12g}")
        if 2 * pi * hertz == omega and len(repr(hertz)) < len(repr(omega)):
            return f"frequency={hertz!r}"
    return f"omega={omega!r}"


def angular_frequency(kind: str, omega: Numeric, frequency: Numeric, typed: str) -> Any:
    """The angular frequency [rad/s] of a drive that takes exactly one of omega [rad/s] and frequency [Hz].

    Parameters
    ----------
    kind : str
        The drive, for the error.
    omega, frequency : float or array, or None
        As they were given.
    typed : str
        What to type for example.

    Returns
    -------
    float or array
        Not yet checked where omega was given: the drive's own rules do that.

    Examples
    --------
    >>> round(angular_frequency("Harmonic", None, 10.0, "type for example omega=205.46"), 6)
    62.831853
    """
    if (omega is None) == (frequency is None):
        given = "both" if omega is not None else "neither"
        raise InputError(kind, [f"give exactly one of omega [rad/s] and frequency [Hz]; got {given}; {typed}"])
    if frequency is None:
        return omega
    try:
        return 2 * pi * number(frequency, "Hz")
    except ValueError as error:
        raise InputError(kind, [f"frequency: {error}; allowed is a positive frequency [Hz]; type frequency=32.7"]) from None


#: Units of what the constructors of motions in phases take.
_UNITS = {**dict.fromkeys(("u1", "u2", "u3"), "m/s"), **dict.fromkeys(("a1", "a2", "w1", "w2", "w3"), "m/s^2"), "stroke": "m",
          **dict.fromkeys(("t1", "t2", "period", "ramp"), "s"), "frequency": "Hz"}  # fmt: skip


def given_numbers(problems: Problems, typed: str, **values: ArrayLike) -> dict[str, Any]:
    """Those of a constructor's numbers that were given, each positive and finite; what is wrong with the others is noted."""
    taken: dict[str, Any] = {}
    for name, value in values.items():
        if value is not None:
            own = Problems(problems.what)
            x = checked_number(name, value, own, positive, "a positive number", typed, _UNITS.get(name))
            problems.mistakes += own.mistakes
            taken |= {} if own.mistakes else {name: x}
    _check_fit(problems, taken)
    return taken


def _check_fit(problems: Problems, taken: dict[str, Any]) -> None:
    """Note arrays that do not fit together."""
    try:
        sum(0.0 * x for x in taken.values())
    except ValueError:
        shapes = "; ".join(f"{name} has shape {x.shape}" for name, x in taken.items() if is_array(x))
        problems.add(f"the arrays do not fit together: {shapes}; give arrays of one shape, or label them all")
        problems.check()


def taken(record: Any, **fields: Any) -> None:
    """The fields of a record whose constructor takes something else besides; then they are checked."""
    for name, value in fields.items():
        object.__setattr__(record, name, value)
    record.__post_init__()


def completed(drive: Any, example: str, needed: tuple[str, ...], ways: dict[str, Callable[[Any], Any]], **given: Any) -> None:
    """The numbers of a drive, the last of them from whatever was given for it.

    `ways` says how it follows from each, once the drive has its other numbers, by the name of what is given; its first name is its own.
    """
    problems = Problems(type(drive).__name__)
    known = given_numbers(problems, example, **given)
    for name in needed:
        if given[name] is None:
            problems.add(f"{name} is missing; type for example {example}")
    problems.check()
    for field in dataclasses.fields(drive):
        object.__setattr__(drive, field.name, known.get(field.name))
    last = _resolved(problems, known, ways, example)
    problems.check()
    taken(drive, **last)


def _resolved(problems: Problems, known: dict[str, Any], ways: dict[str, Callable[[Any], Any]], example: str) -> dict[str, Any]:
    """One number by its name; nothing given for it, or things that contradict each other, are noted."""
    resolved, wanted = {name: way(known[name]) for name, way in ways.items() if name in known}, next(iter(ways))
    if not resolved:
        *most, last = ways
        problems.add(f"{wanted} is missing; allowed is {', '.join(most)} or {last}; type for example {example}")
        return {}
    (name, value), *others = resolved.items()
    for other, different in others:
        if not agree(different, value):
            problems.add(
                f"{name} = {six_digits(known[name])} and {other} = {six_digits(known[other])} do not agree: {other} asks for {wanted} = "
                f"{six_digits(different)}, not {six_digits(value)} {_UNITS[wanted]}; allowed is a motion that closes; give one of them; "
                f"type for example {example}"
            )
    return {wanted: value}


def six_digits(value: Numeric) -> str:
    """A number as a message shows it: six digits."""
    return describe(value) if is_array(value) else f"{value:.6g}"


def agree(a: Any, b: Numeric) -> bool:
    """Whether two numbers given for one thing are the same, to nine digits."""
    return bool(everywhere(abs(a - b) <= 1e-9 * abs(b)))
