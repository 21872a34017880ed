"""Robots from the numbers on the page: its drives, tracks and laws, and the parameters of each."""

from __future__ import annotations

import dataclasses
import functools
import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from stickslip.basics.arguments import described_arguments
from stickslip.basics.field_types import FieldType, field_types
from stickslip.basics.fields import described_by
from stickslip.basics.maths import cos, exp, maximum, sin
from stickslip.basics.quantities import AMPLITUDE, OMEGA, PHASE, TILT_DEG, quantity
from stickslip.models.drives import DRIVES as _KINDS, Harmonic, MultiHarmonic, Pieces, PiezoBeam, Recorded, Reversed, VerticalVibration
from stickslip.models.friction import LAWS, Tabulated
from stickslip.models.friction.coefficients import F0, F_MINUS, F_PLUS, MU0, MU_MINUS, MU_PLUS, V_S
from stickslip.models.friction.law_adapter import adapted
from stickslip.models.presets import piezo_beam_rig
from stickslip.models.robot import Robot
from stickslip.models.tracks import Incline, Level, VaryingFriction

Values = Mapping[str, Any]
Description = Mapping[str, Any]
#: Cosine and sine coefficients of a recorded drive, relative to its amplitude.
Shape = tuple[tuple[float, ...], tuple[float, ...]]
#: The default shape, without a record: a sawtooth with five harmonics.
SAW: Shape = ((0.0,) * 5, tuple(1.0 / i**2 for i in range(1, 6)))


@dataclass(frozen=True)
class Choice:
    """A choice on the page.

    Parameters
    ----------
    label : str
        Name on the page.
    parameters : mapping
        Its own parameters, besides the common ones, by their names on the page, with their descriptions.
    make : callable
        Makes the record from the values.
    """

    label: str
    parameters: Mapping[str, Description]
    make: Callable[..., Any]


def _own_names(kind: str, cls: Any, taken: Mapping[str, Description], but: tuple[str, ...] = ()) -> dict[str, str]:
    """Field -> parameter for the numbers of a record; the name has the prefix of its kind if the page uses it for another number."""
    types = field_types(cls)
    fields = [f for f in dataclasses.fields(cls) if types[f.name] == FieldType("number", False, True) and f.name not in but]
    return {f.name: f.name if taken.get(f.name, f.metadata) == f.metadata else f"{kind}_{f.name}" for f in fields}


def _described(cls: Any, names: Mapping[str, str]) -> dict[str, Description]:
    return {parameter: described_by(cls, field) for field, parameter in names.items()}


# ---- drives ----
def _recorded(p: Values) -> Any:
    cosines, sines = (tuple(p["amplitude"] * c for c in side) for side in p.get("shape", SAW))
    return Recorded(period=2 * math.pi / p["omega"], cosines=cosines, sines=sines)


def _pieces(p: Values) -> Any:
    """Three pieces; the last one makes the motion periodic."""
    d = (p["piece_d1"], p["piece_d2"], p["piece_d3"])
    return Pieces(durations=d, accelerations=(p["piece_a1"], p["piece_a2"], -(p["piece_a1"] * d[0] + p["piece_a2"] * d[1]) / d[2]))


def _beam(p: Values) -> Any:
    beam = PiezoBeam().replace(length=p["length"], thickness=p["thickness"], tip_mass=p["inner_mass"])
    return beam.drive(p["voltage"], p["frequency"])


def _in_words(cls: type) -> str:
    return re.sub("(?<=[a-z])(?=[A-Z])", "-", cls.__name__).lower()


def _is_its_numbers(cls: Any) -> bool:
    return all(kind.holds == "number" for name, kind in field_types(cls).items() if name != "notes")


#: Drives without parts, defined by their numbers alone, with their names on the page.
_PLAIN = {name: _in_words(cls) for name, cls in _KINDS.items() if _is_its_numbers(cls)}
_SINE = {"amplitude": AMPLITUDE, "omega": OMEGA}
_BEAM = {name: described_arguments(piezo_beam_rig)[name] for name in ("voltage", "frequency", "length", "thickness")}
_SECOND = {
    "second_amplitude": AMPLITUDE | {"label": "amplitude of the second harmonic", "symbol": "A_{2}", "example": 1e-4, "range": (0.0, 5e-4)},
    "second_phase": PHASE | {"label": "phase of the second harmonic", "symbol": r"\varphi_{2}", "example": -0.5 * math.pi},
}
_LIFT = {
    "lift": described_by(VerticalVibration, "amplitude"),
    "lift_phase": {**described_by(VerticalVibration, "phase"), "example": 0.5 * math.pi},
}


def _piece(words: str, example: float, low: float, high: float, unit: str, letter: str, number: int) -> Description:
    label = f"{words} the {('first', 'second', 'third')[number - 1]} piece"
    return quantity(label, unit, f"{letter}_{{{number}}}", example=example, range=(low, high), shown="ms" if unit == "s" else "")


_PIECES = {
    **{f"piece_d{i}": _piece("duration of", d, 0.002, 0.06, "s", "d", i) for i, d in ((1, 0.022), (2, 0.022), (3, 0.015))},
    "piece_a1": _piece("acceleration on", 18.65, -60.0, 60.0, "m/s^2", "a", 1),
    "piece_a2": _piece("acceleration on", -60.0, -120.0, 120.0, "m/s^2", "a", 2),
}


def _plain_drives() -> Iterator[tuple[str, dict[str, str]]]:
    """Name of each drive that is defined by its numbers, and field -> parameter."""
    taken: dict[str, Description] = dict(_BEAM)
    for name in _PLAIN:
        names = _own_names(name, _KINDS[name], taken)
        taken |= _described(_KINDS[name], names)
        yield name, names


#: Class -> name on the page and field -> parameter, for drives that are defined by their numbers.
PLAIN_DRIVES: dict[type, tuple[str, dict[str, str]]] = {_KINDS[name]: (name, names) for name, names in _plain_drives()}


def _plain_part(cls: type) -> Choice:
    name, names = PLAIN_DRIVES[cls]
    return Choice(_PLAIN[name], _described(cls, names), lambda p: cls(**{field: p[parameter] for field, parameter in names.items()}))


_SAID = {name: _plain_part(cls) for cls, (name, _) in PLAIN_DRIVES.items()}
_TWO = _SAID["twophase"]
DRIVES: dict[str, Choice] = {
    "harmonic": _SAID.pop("harmonic"),
    "piezobeam": Choice("piezo beam, harmonic", _BEAM, _beam),
    "multiharmonic": Choice(
        "two harmonics",
        _SINE | _SECOND,
        lambda p: MultiHarmonic(omega=p["omega"], amplitudes=(p["amplitude"], p["second_amplitude"]), phases=(0.0, p["second_phase"])),
    ),
    **_SAID,
    "pieces": Choice("three pieces", _PIECES, _pieces),
    "recorded": Choice("recorded (a saw, or your record)", _SINE, _recorded),
    "verticalvibration": Choice(
        "harmonic, with vertical vibration",
        _SINE | _LIFT,
        lambda p: VerticalVibration(Harmonic(amplitude=p["amplitude"], omega=p["omega"]), amplitude=p["lift"], phase=p["lift_phase"]),
    ),
    "reversed": Choice("two-phase, reversed", _TWO.parameters, lambda p: Reversed(_TWO.make(p))),
}

# ---- tracks ----
_TILTED = {"tilt_deg": TILT_DEG}
TRACKS: dict[str, Choice] = {
    "folded": Choice("incline, folded in (Eq. 4.1)", _TILTED, lambda p: Level(folded=_tilt(p))),
    "gravity": Choice("incline, with gravity", _TILTED, lambda p: Incline(tilt=_tilt(p))),
    "level": Choice("level", {}, lambda p: Level()),
    "varying": Choice(
        "incline, friction varies in time",
        _TILTED
        | {"depth": described_by(VaryingFriction, "depth"), "grip_phase": {**described_by(VaryingFriction, "phase"), "example": 0.0}},
        lambda p: VaryingFriction(Incline(tilt=_tilt(p)), depth=p["depth"], phase=p["grip_phase"]),
    ),
}


def _tilt(p: Values) -> Any:
    return p["tilt_deg"] * (math.pi / 180)


# ---- friction ----
def _isotropic(p: Values) -> dict[str, Any]:
    return {"mu_plus": p["mu0"], "mu_minus": p["mu0"], "f_plus": p["f0"], "f_minus": p["f0"]}


def _anisotropic(p: Values) -> dict[str, Any]:
    return {name: p[name] for name in ("mu_plus", "mu_minus", "f_plus", "f_minus")}


_COEFFICIENTS = {"mu_plus": MU_PLUS, "mu_minus": MU_MINUS, "f_plus": F_PLUS, "f_minus": F_MINUS}
CONTACTS: dict[str, Choice] = {
    "isotropic": Choice("the same in both directions", {"mu0": MU0, "f0": F0}, _isotropic),
    "anisotropic": Choice("different in the two directions", _COEFFICIENTS, _anisotropic),
}
#: Speeds at which the tabulated law samples the Stribeck curve, in Stribeck velocities.
_TABLE = (0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0)
_EVERYWHERE = {name: described_by(Robot, name) for name in ("body_mass", "inner_mass", "gravity")}


def _of_all_but_laws() -> dict[str, Description]:
    """The parameters of everything but friction laws, in the order of the page."""
    parts = [*DRIVES.values(), *TRACKS.values(), Choice("", _EVERYWHERE, Robot), *CONTACTS.values()]
    return {name: described for part in parts for name, described in part.parameters.items()}


def _numbers_of_laws() -> dict[str, dict[str, str]]:
    """For each law, its numbers that are not friction coefficients: field -> parameter of the page."""
    taken, names = _of_all_but_laws(), {}
    for name, cls in LAWS.items():
        names[name] = _own_names(name, cls, taken, tuple(_COEFFICIENTS))
        taken |= _described(cls, names[name])
    return names


FIELDS = _numbers_of_laws()


def _law(name: str) -> Choice:
    cls: Any = LAWS[name]
    numbers = FIELDS[name]
    own = {f.name for f in dataclasses.fields(cls)}

    def make(p: Values, contact: dict[str, Any]) -> Any:
        given = {key: value for key, value in contact.items() if key in own}
        return cls(**given, **{field: p[parameter] for field, parameter in numbers.items()})

    return Choice(_label(cls), _described(cls, numbers), make)


def _label(cls: type) -> str:
    return {"CoulombViscous": "Coulomb + viscous", "ElastoPlastic": "Elasto-plastic", "ResetIntegrator": "Reset integrator",
            "TanhCoulomb": "tanh Coulomb", "DeadBand": "Dead band",
            "RateState": "Rate and state"}.get(cls.__name__, cls.__name__)  # fmt: skip


def _tabulated(p: Values, contact: dict[str, Any]) -> Any:
    """The Stribeck curve with these numbers, sampled at some speeds."""

    def column(side: str) -> tuple[Any, ...]:
        mu, f = contact[f"mu_{side}"], contact[f"f_{side}"]
        return tuple(mu + (f - mu) * exp(-(u * u)) for u in _TABLE)

    speed = tuple(u * p["v_s"] for u in _TABLE)
    return Tabulated(speed=speed, mu_plus=column("plus"), mu_minus=column("minus"))


FRICTION: dict[str, Choice] = {
    name: Choice("Tabulated (a Stribeck curve)", {"v_s": V_S}, _tabulated) if name == "tabulated" else _law(name)
    for name, law in LAWS.items()
    if adapted(law.example()).compiles
}
"""The laws of the page: all but those that cannot be compiled (the bristle model), whose runs take minutes and cannot be dragged."""
DESCRIBED: dict[str, Description] = _of_all_but_laws() | {
    name: description for law in FRICTION.values() for name, description in law.parameters.items()
}
"""Every parameter of the page with its description, in order."""


def _contact(kind: str, track: str, p: Values) -> dict[str, Any]:
    """Coefficients on the track: static at least as large as kinetic, with the incline folded in if selected (Eq. 4.1)."""
    c = CONTACTS[kind].make(p)
    tilt = _tilt(p) if track == "folded" else 0.0
    along, across = sin(tilt), cos(tilt)
    for side, sign in (("plus", -1.0), ("minus", 1.0)):
        static = maximum(c[f"f_{side}"], c[f"mu_{side}"])
        c |= {f"mu_{side}": c[f"mu_{side}"] * across + sign * along, f"f_{side}": static * across + sign * along}
    return c


def robot(drive: str, track: str, contact: str, law: str, values: Values) -> Robot:
    """The robot for these choices; values may be arrays that broadcast.

    Examples
    --------
    >>> from stickslip.show.explorer.sliders import PARAMETERS
    >>> import stickslip as ss
    >>> made = robot("harmonic", "folded", "isotropic", "lugre", {name: p.default for name, p in PARAMETERS.items()})
    >>> made == ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4)
    True
    """
    return Robot(
        body_mass=values["body_mass"],
        inner_mass=values["inner_mass"],
        gravity=values["gravity"],
        drive=_drive(drive, values),
        friction=FRICTION[law].make(values, _contact(contact, track, values)),
        track=TRACKS[track].make(values),
    )


def _drive(name: str, values: Values) -> Any:
    """The drive; a single one is cached, as every law of a page has the same and that of a beam takes milliseconds."""
    needs = [*DRIVES[name].parameters, *("inner_mass", "shape")]
    given = {key: values[key] for key in needs if key in values}
    try:
        return _remembered(name, tuple(given.items()))
    except TypeError:  # arrays
        return DRIVES[name].make(given)


@functools.lru_cache(maxsize=256)
def _remembered(name: str, given: tuple[tuple[str, Any], ...]) -> Any:
    return DRIVES[name].make(dict(given))


def active(drive: str, track: str, contact: str, laws: tuple[str, ...]) -> list[str]:
    """The parameters that matter for these choices, in the order of the page."""
    used = {*_EVERYWHERE, *DRIVES[drive].parameters, *TRACKS[track].parameters, *CONTACTS[contact].parameters}
    for law in laws:
        used |= set(FRICTION[law].parameters)
    return [name for name in DESCRIBED if name in used]
