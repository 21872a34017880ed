"""Validation of a page's requests: choices by name and numbers by their bounds, with all errors reported together."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.errors import InputError, Problems, did_you_mean, is_whole
from stickslip.show.explorer.models import CONTACTS, DRIVES, FRICTION, SAW, TRACKS, Shape, active, robot
from stickslip.show.explorer.sliders import PARAMETERS

#: The channels of requests. Each holds one request of a page: a newer one replaces an older one.
CHANNELS = ("curves", "map", "strip", "exponent", "faster")
#: Largest number of additional laws in a comparison, and of cells along each axis of a map.
MOST_LAWS, MOST_CELLS = 4, 96
#: Largest number of machine numbers that a page sets.
MOST_NUMBERS = 500
#: Largest number of sliders in a search, and the quantities that it may be forbidden to increase.
MOST_SLIDERS = 8
KEPT = ("drive_power", "cost_of_transport", "stroke", "relative_velocity", "relative_acceleration")
#: Largest number of harmonics of a recorded drive.
MOST_HARMONICS = 32
_CHOICES: dict[str, Mapping[str, Any]] = {"drive": DRIVES, "track": TRACKS, "contact": CONTACTS, "law": FRICTION}


@dataclass(frozen=True)
class State:
    """The complete state of the page.

    Parameters
    ----------
    drive, track, contact, law : str
        The choices.
    also : tuple of str
        Additional laws for comparison.
    values : dict
        Every parameter [SI; tilt_deg in degrees].
    shape : pair of tuples
        Cosine and sine coefficients of the recorded drive, relative to the amplitude.
    """

    drive: str = "harmonic"
    track: str = "folded"
    contact: str = "isotropic"
    law: str = "lugre"
    also: tuple[str, ...] = ("coulomb",)
    values: Mapping[str, Any] = field(default_factory=lambda: {name: p.default for name, p in PARAMETERS.items()})
    shape: Shape = SAW

    @property
    def laws(self) -> tuple[str, ...]:
        """The law and those compared with it."""
        return (self.law, *self.also)

    def robot(self, law: str | None = None, **changes: Any) -> Any:
        """The robot, optionally with another law or other values."""
        return robot(self.drive, self.track, self.contact, law or self.law, {**self.values, "shape": self.shape, **changes})

    @property
    def active(self) -> list[str]:
        """The parameters that matter."""
        return active(self.drive, self.track, self.contact, self.laws)


DEFAULT = State()


@dataclass(frozen=True)
class MapWindow:
    """The window of a map or, with one axis, of a strip.

    Parameters
    ----------
    names : tuple of str
        Parameters on the axes.
    spans : tuple of (float, float)
        Lower and upper ends.
    cells : tuple of int
        Numbers of values.
    """

    names: tuple[str, ...]
    spans: tuple[tuple[float, float], ...]
    cells: tuple[int, ...]


@dataclass(frozen=True)
class Wish:
    """The sliders that a search may move, and the quantities that it must not increase.

    Parameters
    ----------
    sliders : tuple of str
        Numbers of the page.
    kept : tuple of str
        Quantities that must not exceed their present values.
    """

    sliders: tuple[str, ...]
    kept: tuple[str, ...] = ()


@dataclass(frozen=True)
class Message:
    """One request of a page."""

    channel: str
    id: int
    state: State
    fine: bool = False
    plane: MapWindow | None = None
    machine: Mapping[str, float] | None = None  # numbers of the machine that the page shows
    wish: Wish | None = None


#: Whether the response to a request is no longer needed.
IsCancelled = Callable[[], bool]


class Stopped(Exception):
    """The response to a request is no longer needed."""


def message(text: str | bytes) -> Message:
    """A request from the text of a message.

    Examples
    --------
    >>> message('{"channel": "curves", "id": 1, "state": {"law": "coulomb", "values": {"tilt_deg": 2.7}}}').state.values["tilt_deg"]
    2.7
    >>> message('{"channel": "curves", "id": 1, "state": {"law": "coulom"}}')
    Traceback (most recent call last):
    stickslip.basics.errors.InputError: state: law = 'coulom' is not known; did you mean 'coulomb'?
    """
    problems = Problems("message")
    try:
        given = json.loads(text)
    except (ValueError, RecursionError):
        given = None
    if not isinstance(given, dict):
        problems.add("it is not a JSON object; allowed is {channel, id, state, ...}")
        problems.check()
    channel, number = given.get("channel"), given.get("id")
    if channel not in CHANNELS:
        problems.add(f"channel = {_short(channel)}; allowed is one of {', '.join(CHANNELS)}")
    if not is_whole(number) or not 0 <= number < 2**53:
        problems.add(f"id = {_short(number)}; allowed is a whole number")
    problems.check()
    wish = _wish(given) if channel == "faster" else None
    if "machine" in given:
        asked = channel if wish else "curves"
        return Message(asked, number, DEFAULT, given.get("fine") is True, machine=machine_numbers(given["machine"]), wish=wish)
    shown = state(given.get("state", {}))
    plane = _plane(given.get("axes"), shown, 2 if channel == "map" else 1) if channel in ("map", "strip") else None
    return Message(channel, number, shown, given.get("fine") is True, plane, wish=wish)


def _wish(given: dict[str, Any]) -> Wish:
    """The sliders of a search; whether the page has such numbers is checked elsewhere."""
    problems, chosen = Problems("faster"), {}
    for name, most in (("sliders", MOST_SLIDERS), ("keep", len(KEPT))):
        words = given.get(name, [])
        if not isinstance(words, list) or len(words) > most or not all(isinstance(word, str) and len(word) < 200 for word in words):
            problems.add(f"{name} = {_short(words)}; allowed is a list of up to {most} names")
            words = []
        chosen[name] = tuple(dict.fromkeys(words))
    if not chosen["sliders"]:
        problems.add("no slider may move; choose one or more")
    for word in chosen["keep"]:
        if word not in KEPT:
            problems.add(f"keep = {_short(word)}; {did_you_mean(word[:40], KEPT)}")
    problems.check()
    return Wish(chosen["sliders"], chosen["keep"])


def state(given: Any) -> State:
    """A state from its table; missing entries have their initial values."""
    problems = Problems("state")
    if not isinstance(given, dict):
        raise InputError("state", [f"{_short(given)} is not a table"])
    for name in given:
        if name not in ("drive", "track", "contact", "law", "also", "values", "shape"):
            problems.add(f"{_short(name)} is not known")
    choices = {name: _choice(name, given.get(name, getattr(DEFAULT, name)), problems) for name in _CHOICES}
    also = _also(given.get("also", list(DEFAULT.also)), problems)
    values = _values(given.get("values", {}), problems)
    shape = _shape(given["shape"], problems) if "shape" in given else SAW
    problems.check()
    return State(**choices, also=tuple(law for law in also if law != choices["law"]), values=values, shape=shape)


def machine_numbers(given: Any) -> dict[str, float]:
    """Numbers of a machine by their dotted names; whether it has them is checked elsewhere."""
    problems = Problems("state")
    if not isinstance(given, dict) or len(given) > MOST_NUMBERS:
        raise InputError("state", [f"machine = {_short(given)}; allowed is a table of up to {MOST_NUMBERS} numbers"])
    for name, value in given.items():
        if not _is_finite(value):
            problems.add(f"values.{_short(name)} = {_short(value)}; allowed is a number")
    problems.check()
    return {name: float(value) for name, value in given.items()}


def _choice(name: str, value: Any, problems: Problems) -> str:
    if not isinstance(value, str) or value not in _CHOICES[name]:
        hint = did_you_mean(value[:40], _CHOICES[name]) if isinstance(value, str) else f"allowed is one of {', '.join(_CHOICES[name])}"
        problems.add(f"{name} = {_short(value)} is not known; {hint}")
        return next(iter(_CHOICES[name]))
    return value


def _also(given: Any, problems: Problems) -> tuple[str, ...]:
    if not isinstance(given, list) or len(given) > MOST_LAWS:
        problems.add(f"also = {_short(given)}; allowed is a list of up to {MOST_LAWS} laws")
        return ()
    return tuple(dict.fromkeys(_choice("law", law, problems) for law in given))


def _values(given: Any, problems: Problems) -> dict[str, float]:
    values = dict(DEFAULT.values)
    if not isinstance(given, dict):
        problems.add(f"values = {_short(given)}; allowed is a table of numbers")
        return values
    for name, value in given.items():
        if name not in PARAMETERS:
            problems.add(f"values.{_short(name)} is not known; {did_you_mean(str(name)[:40], PARAMETERS)}")
        elif _number(name, value, f"values.{name}", problems):
            values[name] = float(value)
    return values


def _shape(given: Any, problems: Problems) -> Shape:
    """Cosine and sine coefficients of a recorded drive."""
    two = isinstance(given, list) and len(given) == 2 and all(isinstance(side, list) for side in given)
    if not two or len(given[0]) != len(given[1]) or not 1 <= len(given[0]) <= MOST_HARMONICS:
        problems.add(f"shape = {_short(given)}; allowed are two lists, cosines and sines, of as many numbers, 1 to {MOST_HARMONICS}")
        return SAW
    if not all(_is_finite(c) and abs(c) <= 10 for side in given for c in side):
        problems.add(f"shape = {_short(given)}; allowed are numbers from -10 to 10, in parts of the amplitude")
        return SAW
    return tuple(map(float, given[0])), tuple(map(float, given[1]))


def _number(name: str, value: Any, where: str, problems: Problems) -> bool:
    """Whether a value is a number within the bounds of its parameter; if not, a problem is noted."""
    p = PARAMETERS[name]
    number = _is_finite(value)
    if not number or not p.least <= value <= p.most:
        shown = p.shown(value) if number else _short(value)
        problems.add(f"{where} = {shown}; allowed is {p.allowed()}; type for example {p.shown(p.default)}")
        return False
    return True


def _plane(given: Any, shown: State, count: int) -> MapWindow:
    """The axes of a map or a strip: one table for each, with name, from, to, cells."""
    problems = Problems("axes")
    if not isinstance(given, list) or len(given) != count or not all(isinstance(axis, dict) for axis in given):
        raise InputError("axes", [f"{_short(given)}; allowed is a list of {count} tables with name, from, to and cells"])
    names = [axis.get("name") for axis in given]
    for name, axis in zip(names, given, strict=True):
        if name not in shown.active:
            problems.add(f"{_short(name)} has no effect here; {did_you_mean(str(name)[:40], shown.active)}")
        elif all(_number(name, axis.get(end), f"{name} {end}", problems) for end in ("from", "to")) and not axis["from"] < axis["to"]:
            problems.add(f"{name} reaches from {axis['from']:.6g} to {axis['to']:.6g}; allowed is a rising span")
        if not is_whole(axis.get("cells")) or not 2 <= axis["cells"] <= MOST_CELLS * (3 - count):
            problems.add(f"cells = {_short(axis.get('cells'))}; allowed is a whole number from 2 to {MOST_CELLS * (3 - count)}")
    if len(set(map(str, names))) < count:
        problems.add("both axes are the same; choose two parameters")
    problems.check()
    spans = tuple((float(axis["from"]), float(axis["to"])) for axis in given)
    return MapWindow(tuple(names), spans, tuple(axis["cells"] for axis in given))


def _is_finite(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < 1e300 and math.isfinite(value)


def _short(value: Any) -> str:
    """A given value as text, shortened to fit a sentence."""
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
