"""Robots of the numbers on the page: its drives, tracks and laws, and which parameters each of them takes."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from stickslip.drives import (
    BangBang,
    Harmonic,
    MultiHarmonic,
    Pieces,
    PiezoBeam,
    Recorded,
    Reversed,
    Sawtooth,
    ThreePhase,
    Trapezoid,
    TwoPhase,
    VerticalVibration,
)
from stickslip.fields import is_number_field
from stickslip.friction import LAWS, Tabulated
from stickslip.friction.adapter import adapted
from stickslip.maths import cos, exp, maximum, sin
from stickslip.robot import Robot
from stickslip.tracks import Incline, Level, VaryingFriction

__all__ = ["CONTACTS", "DRIVES", "FRICTION", "SAW", "TRACKS", "Part", "Shape", "active", "fields_of", "robot"]

Values = Mapping[str, Any]
#: Cosines and sines of a recorded drive, in parts of its amplitude.
Shape = tuple[tuple[float, ...], tuple[float, ...]]
#: The shape where there is no record: a saw of five harmonics.
SAW: Shape = ((0.0,) * 5, tuple(1.0 / i**2 for i in range(1, 6)))


@dataclass(frozen=True)
class Part:
    """A choice on the page.

    Parameters
    ----------
    label : str
        What it is called.
    parameters : tuple of str
        The parameters that it takes, beside those that everything takes.
    make : callable
        Makes the record from the values.
    """

    label: str
    parameters: tuple[str, ...]
    make: Callable[..., Any]


# ---- drives ----
def _harmonic(p: Values) -> Any:
    return Harmonic(amplitude=p["amplitude"], omega=p["omega"])


def _two_phase(p: Values) -> Any:
    return TwoPhase(stroke=p["stroke"], u1=p["u1"], u2=p["u2"])


def _recorded(p: Values) -> Any:
    cosines, sines = (tuple(p["amplitude"] * c for c in side) for side in p.get("shape", SAW))
    return Recorded(period=2 * math.pi / p["omega"], cosines=cosines, sines=sines)


def _pieces(p: Values) -> Any:
    """Three pieces, of which the last closes the motion."""
    d = (p["piece_d1"], p["piece_d2"], p["piece_d3"])
    return Pieces(durations=d, accelerations=(p["piece_a1"], p["piece_a2"], -(p["piece_a1"] * d[0] + p["piece_a2"] * d[1]) / d[2]))


def _beam(p: Values) -> Any:
    beam = PiezoBeam().replace(length=p["length"], thickness=p["thickness"], tip_mass=p["inner_mass"])
    return beam.drive(p["voltage"], p["frequency"])


DRIVES: dict[str, Part] = {
    "harmonic": Part("harmonic", ("amplitude", "omega"), _harmonic),
    "piezobeam": Part("piezo beam, harmonic", ("voltage", "frequency", "length", "thickness"), _beam),
    "multiharmonic": Part(
        "two harmonics",
        ("amplitude", "omega", "second_amplitude", "second_phase"),
        lambda p: MultiHarmonic(omega=p["omega"], amplitudes=(p["amplitude"], p["second_amplitude"]), phases=(0.0, p["second_phase"])),
    ),
    "twophase": Part("two-phase", ("stroke", "u1", "u2"), _two_phase),
    "threephase": Part(
        "three-phase",
        ("three_u1", "w1", "w2", "w3"),
        lambda p: ThreePhase(u1=p["three_u1"], w1=p["w1"], w2=p["w2"], w3=p["w3"]),
    ),
    "bangbang": Part("bang-bang", ("a1", "a2", "bang_period"), lambda p: BangBang(a1=p["a1"], a2=p["a2"], period=p["bang_period"])),
    "trapezoid": Part(
        "trapezoid",
        ("ramp_u1", "ramp_u2", "ramp", "ramp_period"),
        lambda p: Trapezoid(u1=p["ramp_u1"], u2=p["ramp_u2"], ramp=p["ramp"], period=p["ramp_period"]),
    ),
    "pieces": Part("three pieces", ("piece_d1", "piece_d2", "piece_d3", "piece_a1", "piece_a2"), _pieces),
    "sawtooth": Part("sawtooth", ("stroke", "rise", "fall"), lambda p: Sawtooth(stroke=p["stroke"], rise=p["rise"], fall=p["fall"])),
    "recorded": Part("recorded (a saw, or your record)", ("amplitude", "omega"), _recorded),
    "verticalvibration": Part(
        "harmonic, with vertical vibration",
        ("amplitude", "omega", "lift", "lift_phase"),
        lambda p: VerticalVibration(_harmonic(p), amplitude=p["lift"], phase=p["lift_phase"]),
    ),
    "reversed": Part("two-phase, reversed", ("stroke", "u1", "u2"), lambda p: Reversed(_two_phase(p))),
}

# ---- tracks ----
TRACKS: dict[str, Part] = {
    "folded": Part("incline, folded in (Eq. 4.1)", ("tilt_deg",), lambda p: Level()),
    "gravity": Part("incline, with gravity", ("tilt_deg",), lambda p: Incline(tilt=_tilt(p))),
    "level": Part("level", (), lambda p: Level()),
    "varying": Part(
        "incline, friction varies in time",
        ("tilt_deg", "depth", "grip_phase"),
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


CONTACTS: dict[str, Part] = {
    "isotropic": Part("the same both ways", ("mu0", "f0"), _isotropic),
    "anisotropic": Part("different both ways", ("mu_plus", "mu_minus", "f_plus", "f_minus"), _anisotropic),
}
_COEFFICIENTS = ("mu_plus", "mu_minus", "f_plus", "f_minus")
_RENAMED = {"dahl": {"exponent": "dahl_exponent"}}
#: Speeds at which the tabulated law reads the Stribeck curve off, in Stribeck velocities.
_TABLE = (0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0)
_EVERYWHERE = ("body_mass", "inner_mass", "gravity")


def fields_of(name: str) -> dict[str, str]:
    """Numbers of a law that are no friction coefficients: field -> parameter of the page."""
    found = [f.name for f in dataclasses.fields(LAWS[name]) if is_number_field(f) and f.name not in _COEFFICIENTS]
    return {f: _RENAMED.get(name, {}).get(f, f) for f in found if f != "z_ba_minus"}


def _law(name: str) -> Part:
    cls: Any = LAWS[name]
    numbers = fields_of(name)
    own = {f.name for f in dataclasses.fields(cls)}

    def make(p: Values, contact: dict[str, Any]) -> Any:
        given = {key: value for key, value in contact.items() if key in own}
        return cls(**given, **{field: p[parameter] for field, parameter in numbers.items()})

    return Part(_label(cls), tuple(numbers.values()), make)


def _label(cls: type) -> str:
    return {"CoulombViscous": "Coulomb + viscous", "ElastoPlastic": "Elasto-plastic", "ResetIntegrator": "Reset integrator",
            "TanhCoulomb": "tanh Coulomb", "DeadBand": "Dead band"}.get(cls.__name__, cls.__name__)  # fmt: skip


def _tabulated(p: Values, contact: dict[str, Any]) -> Any:
    """The Stribeck curve of these numbers, read off at some speeds."""

    def column(side: str) -> tuple[Any, ...]:
        mu, f = contact[f"mu_{side}"], contact[f"f_{side}"]
        return tuple(mu + (f - mu) * exp(-(u * u)) for u in _TABLE)

    speed = tuple(u * p["v_s"] for u in _TABLE)
    return Tabulated(speed=speed, mu_plus=column("plus"), mu_minus=column("minus"))


FRICTION: dict[str, Part] = {
    name: Part("Tabulated (a Stribeck curve)", ("v_s",), _tabulated) if name == "tabulated" else _law(name)
    for name, law in LAWS.items()
    if adapted(law.example()).compiles
}
"""The laws of the page: all but those that cannot be compiled (the bristle model), whose runs take minutes and cannot be dragged."""


def _contact(kind: str, track: str, p: Values) -> dict[str, Any]:
    """Coefficients on the track: static ones at least the kinetic ones, and with the incline folded in where asked (Eq. 4.1)."""
    c = CONTACTS[kind].make(p)
    tilt = _tilt(p) if track == "folded" else 0.0
    along, across = sin(tilt), cos(tilt)
    for side, sign in (("plus", -1.0), ("minus", 1.0)):
        static = maximum(c[f"f_{side}"], c[f"mu_{side}"])
        c |= {f"mu_{side}": c[f"mu_{side}"] * across + sign * along, f"f_{side}": static * across + sign * along}
    return c


def robot(drive: str, track: str, contact: str, law: str, values: Values) -> Robot:
    """The robot of these choices; values may be arrays that broadcast.

    Examples
    --------
    >>> from stickslip.explorer.parameters import PARAMETERS
    >>> import stickslip as ss
    >>> made = robot("harmonic", "folded", "isotropic", "lugre", {name: p.default for name, p in PARAMETERS.items()})
    >>> made == ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4)
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
    """The drive; a single one is remembered, as every law of a page has the same and a beam's takes milliseconds."""
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
    from stickslip.explorer.parameters import PARAMETERS

    used = {*_EVERYWHERE, *DRIVES[drive].parameters, *TRACKS[track].parameters, *CONTACTS[contact].parameters}
    for law in laws:
        used |= set(FRICTION[law].parameters)
    return [name for name in PARAMETERS if name in used]
