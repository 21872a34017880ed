"""Sensor effects: offset, drift, gain and delay; for forces also preload and the inertia of moving parts.

Beside them stands the start of a contact whose law has inner states: nobody knows how far these are bent where a record begins.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.basics.distributions import ALLOWED, Distribution, distribution_of
from stickslip.basics.errors import Problems, did_you_mean, is_number


@dataclass(frozen=True)
class Effect:
    """One thing that a sensor does.

    Parameters
    ----------
    kinds : tuple of str
        Kinds of records in which it is fitted.
    neutral : float
        The value of an ideal sensor.
    prior : Distribution, optional
        What is supposed where nothing is typed; None for nothing.
    default : bool
        Whether it is fitted where nothing is said.
    per : str
        Its unit, after that of the record; empty where it has its own.
    unit : str
        Its own unit.
    timed : bool
        Whether it needs to be known when the values were taken.
    """

    kinds: tuple[str, ...]
    neutral: float
    prior: Distribution | None
    default: bool
    per: str | None
    unit: str = ""
    timed: bool = False


#: The effects by name. A constant offset of a position is where it is counted from, which is always fitted; the delay of a steady motion is
#: part of the drive's phase, which is too.
_APPLIED = ("applied force", "torque", "current")  # to a machine whose motion was measured
EFFECTS = {
    "offset": Effect(("velocity", "force", *_APPLIED), 0.0, None, True, ""),
    "drift": Effect(("velocity", "position", "force", *_APPLIED), 0.0, None, True, "/s", timed=True),
    "gain": Effect(("velocity", "position", "force", *_APPLIED), 1.0, Distribution("normal", 1.0, 0.02), True, None),
    "delay": Effect(("force", "angle", *_APPLIED), 0.0, None, True, None, "s", timed=True),
    "preload": Effect(("force",), 0.0, None, False, None, "N"),
    "inertia": Effect(("force",), 0.0, None, False, None, "kg", timed=True),
    "start": Effect(("force", *_APPLIED), 0.0, Distribution("uniform", -1.5, 1.5), False, None),  # a slow slide bends by 1
    # where the zero of an encoder is, from the hanging position
    "zero": Effect(("angle",), 0.0, Distribution("normal", 0.0, 0.1), True, None, "rad"),
    "begin": Effect(("angle",), 0.0, None, True, ""),  # the angle at the first sample, beside the measured one
    "goal": Effect(("angle",), 0.0, None, False, ""),  # where the command is counted from, beside the angle
}
_OF_THE_MODEL = ("preload", "start", "zero", "begin", "goal")
_LATE = ("zero", "begin")  # small corrections, which the search leaves to the steps from its best place
_PRESSED = 0.999  # of the least load, that a preload may take away
_ENOUGH = 60  # values of a record that bear all numbers of its sensor


@dataclass(frozen=True)
class SensorNumber:
    """A number of a sensor that is fitted, or held.

    Parameters
    ----------
    name : str
        ``offset`` of all records, ``offset[0]`` of the first.
    records : tuple of int
    value : float
        Where it is held, or where the search begins.
    prior : Distribution, optional
    least, most : float
        What it cannot be below or above, whatever is known of it.
    """

    name: str
    records: tuple[int, ...]
    value: float
    prior: Distribution | None = None
    least: float = -np.inf
    most: float = np.inf

    @property
    def what(self) -> str:
        """The effect."""
        return self.name.partition("[")[0]

    @property
    def neutral(self) -> float:
        """The value of an ideal sensor."""
        return EFFECTS[self.what].neutral

    @property
    def in_the_model(self) -> bool:
        """Whether it changes what the model gives, and not what the sensor makes of that."""
        return self.what in _OF_THE_MODEL

    @property
    def searched(self) -> bool:
        """Whether the search moves it, and not only the steps from its best place."""
        return self.what not in _LATE

    @property
    def family(self) -> str:
        """The effect, or the name of several that are known or unknown together."""
        return self.what

    @property
    def of(self) -> str:
        """Whose number it is, in words."""
        return "the sensor"

    @property
    def bounds(self) -> tuple[float, float]:
        """Where the search looks."""
        low, high = (-np.inf, np.inf) if self.prior is None else (self.prior.low, self.prior.high)
        return max(low, self.least, 1e-3 if EFFECTS[self.what].neutral == 1.0 else -np.inf), min(high, self.most)

    def unit(self, of_record: str) -> str:
        """Its unit, where that of the record is known."""
        effect = EFFECTS[self.what]
        return effect.unit if effect.per is None else f"{of_record}{effect.per}"


def sensors_of(given: Any, targets: Any, what: str = "identify") -> tuple[tuple[SensorNumber, ...], tuple[SensorNumber, ...]]:
    """Numbers of the sensors that are fitted, and those that are held, as the user says; everything wrong with it at once.

    Parameters
    ----------
    given : None or dict
        None for what the data can bear of what is usual; else effect -> a value that holds it, an uncertain number, or None for the usual.
    targets : sequence
        What is fitted: each with `kind`, `count` and `step`.
    """
    problems, fitted, held = Problems(what), list[SensorNumber](), list[SensorNumber]()
    taken: set[tuple[str, int]] = set()
    for name, said in _usual(targets).items() if given is None else _typed(given, len(targets), problems):
        records = _records(name, targets, problems)
        made = _number(name, records, said, targets, problems) if records else None
        twice = {(made.what, i) for i in made.records} & taken if made else set()
        problems.mistakes += [f"sensor: {what} of record {i} is named twice; leave one of them out" for what, i in sorted(twice)]
        if made:
            taken |= {(made.what, i) for i in made.records}
            (held if is_number(said) else fitted).append(made)
    problems.check()
    return tuple(fitted), tuple(held)


def with_starts(numbers: tuple[SensorNumber, ...], held: tuple[SensorNumber, ...], records: Any) -> tuple[SensorNumber, ...]:
    """The numbers of the sensors, and the start of each of these records of which nothing is typed."""
    typed = {i for n in (*numbers, *held) if n.what == "start" for i in n.records}
    about = EFFECTS["start"]
    return (*numbers, *(SensorNumber(f"start[{i}]", (i,), about.neutral, about.prior) for i in records if i not in typed))


def _usual(targets: Any) -> dict[str, None]:
    """The effects that are fitted where nothing is said: one gain and one delay of a sensor, an offset and a drift of each record."""
    able = [i for i, t in enumerate(targets) if t.count >= _ENOUGH]
    curves, kinds = sum(t.kind != "mean" for t in targets), {targets[i].kind for i in able}
    names = {}
    for effect, about in EFFECTS.items():
        there = [i for i in able if targets[i].kind in about.kinds and not (about.timed and targets[i].timeless)]
        shared = about.per is None and len(kinds) == 1
        if there and about.default:
            names.update(dict.fromkeys([effect] if curves == 1 or (shared and len(there) == curves) else [f"{effect}[{i}]" for i in there]))
    return names


def _typed(given: Any, count: int, problems: Problems) -> list[tuple[str, Any]]:
    """The user's names, with ``[:]`` expanded to one name for each record."""
    if not isinstance(given, dict):
        typed = 'sensor={} for an ideal sensor, or for example sensor=dict(offset=0.0, gain=("normal", 1.0, 0.02))'
        problems.add(f"sensor = {given!r}; allowed is None, or a dict of {', '.join(EFFECTS)}; type {typed}")
        return []
    each = {name: [f"{str(name)[:-3]}[{i}]" for i in range(count)] if str(name).endswith("[:]") else [str(name)] for name in given}
    return [(one, given[name]) for name, ones in each.items() for one in ones]


def _records(name: str, targets: Any, problems: Problems) -> tuple[int, ...]:
    """The records that a name means, all or one, as far as they have the effect."""
    match = re.fullmatch(r"(\w+)(?:\[(\d+)\])?", name)
    if match is None or match[1] not in EFFECTS:
        problems.add(f"sensor: {name!r} is not known; {did_you_mean(name, EFFECTS)}")
        return ()
    if match[2] and int(match[2]) >= len(targets):
        problems.add(f"sensor: {name} names record {match[2]}; there are {len(targets)}, counted from 0")
        return ()
    meant, able = [int(match[2])] if match[2] else range(len(targets)), EFFECTS[match[1]].kinds
    records = tuple(i for i in meant if targets[i].kind in able)
    kinds = sorted({targets[i].kind for i in meant})
    if not records and not (match[1] == "delay" and set(kinds) <= {"velocity", "position"}):  # a steady motion has it in its phase
        problems.add(f"sensor: {name} belongs to records of {' and '.join(able)}; these are of {' and '.join(kinds)}; leave it out")
    return records


def _number(name: str, records: tuple[int, ...], said: Any, targets: Any, problems: Problems) -> SensorNumber | None:
    effect = name.partition("[")[0]
    about = EFFECTS[effect]
    if said is None:
        most = max(targets[i].longest_delay for i in records) if effect == "delay" else np.inf
        return SensorNumber(name, records, about.neutral, about.prior, max(_least(effect, records, targets), -most), most)
    if is_number(said):
        return SensorNumber(name, records, float(said))
    prior = distribution_of(said)
    if prior is None:
        typed = f"{about.neutral:g}" if about.neutral else "0.0"
        problems.add(f"sensor: {name} = {said!r}; allowed is a number that holds it, {ALLOWED}, or None; type for example {name}={typed}")
        return None
    return SensorNumber(name, records, min(max(prior.mean, prior.low), prior.high), prior, _least(effect, records, targets))


def _least(effect: str, records: tuple[int, ...], targets: Any) -> float:
    """Lower bound of an effect: a preload leaves a positive normal force, with room for a derivative."""
    return -_PRESSED * min(float(np.min(targets[i].load)) for i in records) if effect == "preload" else -np.inf
