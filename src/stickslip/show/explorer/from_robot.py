"""A robot as a state of the page, if the page can represent it: used by `stickslip explore STUDY`."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any
from urllib.parse import urlencode

from stickslip.basics.contracts import Model
from stickslip.basics.errors import Problems, StickslipError
from stickslip.basics.fields import leaves
from stickslip.models.drives import Harmonic, MultiHarmonic, Pieces, Recorded, Reversed, TwoPhase, VerticalVibration
from stickslip.models.friction import LAWS
from stickslip.models.friction.law_adapter import adapted
from stickslip.models.tracks import Incline, Level, VaryingFriction
from stickslip.show.explorer.models import FIELDS, FRICTION, PLAIN_DRIVES, Shape
from stickslip.show.explorer.requests import DEFAULT, MOST_HARMONICS, State
from stickslip.show.explorer.sliders import PARAMETERS

Values = dict[str, Any]
_STEEPEST = 8.0  # degrees: differences of coefficients that correspond to at most this tilt are read as a folded incline
_SAME = 1e-9  # relative difference below which two numbers count as equal


def state_of(robot: Any) -> State:
    """The state of the page that shows a robot.

    Parameters
    ----------
    robot : Robot
        One robot.

    Raises
    ------
    InputError
        If the page has no control for some part; all such parts are reported together.

    Examples
    --------
    >>> import stickslip as ss
    >>> found = state_of(ss.presets.piezo_rig(tilt_deg=2.7, amplitude=6e-4))
    >>> found.track, found.law, round(found.values["tilt_deg"], 9), round(found.values["mu0"], 9)
    ('folded', 'lugre', 2.7, 0.18)
    """
    problems = Problems("explore")
    if not hasattr(robot, "body_mass"):
        problems.add(f"{type(robot).__name__} is not a robot on a track; allowed is a Robot; type stickslip explore piezo_rig ...")
        problems.check()
    drive, driven, shape = _drive(robot.drive, problems)
    law = next((name for name in FRICTION if LAWS[name] is type(robot.friction)), None)
    if law is None or law == "tabulated":
        kind = adapted(robot.friction).name
        problems.add(f"the page has no control for the friction law {kind}; it has {', '.join(n for n in FRICTION if n != 'tabulated')}")
    problems.check()
    assert law is not None
    masses = {name: float(getattr(robot, name)) for name in ("body_mass", "inner_mass", "gravity")}
    numbers = {parameter: float(getattr(robot.friction, field)) for field, parameter in FIELDS[law].items()}
    differs: list[str] = []
    for track, contact, values in _places(robot):
        whole = {**DEFAULT.values, **masses, **driven, **numbers, **values}
        candidate = State(drive, track, contact, law, (), whole, shape)
        differs = _differences(robot, candidate)
        if not differs:
            _check_bounds(candidate, problems)
            problems.check()
            return candidate
    for sentence in differs or ["its track"]:
        problems.add(f"the page has no control for this: {sentence}")
    problems.check()
    raise AssertionError("a robot that the page does not show has a reason")


def _drive(drive: Any, problems: Problems) -> tuple[str, Values, Shape]:
    """Name, numbers and shape of a drive."""
    if type(drive) in PLAIN_DRIVES:
        name, fields = PLAIN_DRIVES[type(drive)]
        return name, {parameter: float(getattr(drive, field)) for field, parameter in fields.items()}, DEFAULT.shape
    if isinstance(drive, Reversed) and isinstance(drive.drive, TwoPhase):
        return "reversed", _drive(drive.drive, problems)[1], DEFAULT.shape
    if isinstance(drive, VerticalVibration) and isinstance(drive.drive, Harmonic):
        lifted = {"lift": float(drive.amplitude), "lift_phase": float(drive.phase)}
        return "verticalvibration", _drive(drive.drive, problems)[1] | lifted, DEFAULT.shape
    if isinstance(drive, MultiHarmonic) and len(drive.amplitudes) == 2:
        (first, second), phase = drive.amplitudes, drive.phases[1]
        values = {"omega": drive.omega, "amplitude": first, "second_amplitude": second, "second_phase": phase}
        return "multiharmonic", {name: float(v) for name, v in values.items()}, DEFAULT.shape
    if isinstance(drive, Pieces) and len(drive.durations) == 3:
        values = {f"piece_d{k + 1}": d for k, d in enumerate(drive.durations)}
        values |= {f"piece_a{k + 1}": a for k, a in enumerate(drive.accelerations[:2])}
        return "pieces", {name: float(v) for name, v in values.items()}, DEFAULT.shape
    if isinstance(drive, Recorded) and len(drive.sines) <= MOST_HARMONICS:
        sides = tuple(tuple(map(float, side)) for side in (drive.cosines, drive.sines))
        size = max(abs(c) for side in sides for c in side) or 1.0
        shape = (tuple(c / size for c in sides[0]), tuple(c / size for c in sides[1]))
        return "recorded", {"amplitude": size, "omega": 2 * math.pi / float(drive.period)}, shape
    problems.add(f"the page has no control for this drive: {drive!r}")
    return DEFAULT.drive, {}, DEFAULT.shape


def _places(robot: Any) -> Iterator[tuple[str, str, Values]]:
    """Candidates for track and coefficients: name of the track, name of the contact, values. The most likely one comes first."""
    track, law = robot.track, robot.friction
    c = {name: float(getattr(law, name)) for name in ("mu_plus", "mu_minus", "f_plus", "f_minus") if getattr(law, name, None) is not None}
    if not c:  # no friction coefficients: viscous friction
        contacts: list[tuple[str, Values]] = [("isotropic", {})]
    else:
        c = {"f_plus": c["mu_plus"], "f_minus": c["mu_minus"]} | c
        contacts = [("isotropic", {"mu0": c["mu_plus"], "f0": c["f_plus"]}), ("anisotropic", c)]
    if isinstance(track, Level):
        yield from (("level", name, values) for name, values in contacts[:1])
        if c and float(track.folded) and (tilt := 0.5 * (c["mu_minus"] - c["mu_plus"])) and abs(tilt) <= math.sin(math.radians(_STEEPEST)):
            across = math.sqrt(1.0 - tilt * tilt)
            folded = {"mu0": 0.5 * (c["mu_plus"] + c["mu_minus"]) / across, "f0": 0.5 * (c["f_plus"] + c["f_minus"]) / across}
            yield "folded", "isotropic", {"tilt_deg": math.degrees(math.asin(tilt)), **folded}
        yield from (("level", name, values) for name, values in contacts[1:])
    elif isinstance(track, Incline):
        yield from (("gravity", name, values | {"tilt_deg": math.degrees(float(track.tilt))}) for name, values in contacts)
    elif isinstance(track, VaryingFriction) and isinstance(track.track, (Incline, Level)):
        tilt = math.degrees(float(getattr(track.track, "tilt", 0.0)))
        varying = {"tilt_deg": tilt, "depth": float(track.depth), "grip_phase": float(track.phase)}
        yield from (("varying", name, values | varying) for name, values in contacts)


def _differences(robot: Model, state: State) -> list[str]:
    """The differences between the page's robot and this one."""
    try:
        shown = dict(leaves(state.robot(), kinds=True))
    except StickslipError as error:
        return [str(error)]
    given = leaves(robot, kinds=True)
    return [
        f"{name} = {value.__name__ if isinstance(value, type) else repr(value)}"
        for name, value in given
        if (isinstance(value, (int, float, str)) and not _same(value, shown.get(name)))
        or (isinstance(value, type) and value is not shown.get(name))  # a subclass may have changed the equations
    ]


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, str) or isinstance(b, str) or b is None:
        return bool(a == b)
    return math.isclose(a, b, rel_tol=_SAME, abs_tol=1e-15)


def _check_bounds(state: State, problems: Problems) -> None:
    """Note numbers outside the bounds of the page."""
    for name in state.active:
        p, value = PARAMETERS[name], state.values[name]
        if not p.least <= value <= p.most:
            problems.add(f"{name} = {p.shown(value)}; the page takes {p.allowed()}")


def hash_of(state: State) -> str:
    """The part of the page's address behind # that shows a state.

    Examples
    --------
    >>> hash_of(DEFAULT)[:62]
    '#drive=harmonic&track=folded&contact=isotropic&law=lugre&also='
    """
    query: Mapping[str, str] = {
        "drive": state.drive, "track": state.track, "contact": state.contact, "law": state.law, "also": ",".join(state.also),
        **{name: f"{state.values[name]:.15g}" for name in state.active},
        **({"shape": ",".join(f"{c:.17g}" for side in state.shape for c in side)} if state.drive == "recorded" else {}),
    }  # fmt: skip
    return "#" + urlencode(query)
