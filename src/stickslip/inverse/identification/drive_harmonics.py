"""Harmonics of drives: a drive that is given as a sine has others too, of which a fit knows what an actuator usually adds.

They stand among the numbers of a fit as an uncertain gain of a sensor does. Without them a velocity with one per cent of second harmonic is
met by a wrong friction, whose interval is narrow.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from stickslip.basics.distributions import Distribution
from stickslip.basics.errors import InputError, is_number, is_whole
from stickslip.inverse.identification.sensors import SensorNumber
from stickslip.models.drives.rippled import with_ripple
from stickslip.models.drives.within import drives_within

#: Standard deviation of sine and cosine of each order, in parts of the drive's amplitude, where nothing is typed.
USUAL = {2: 0.02, 3: 0.02}
ORDERS = range(2, 10)
_PARTS = ("sin", "cos")
_ENOUGH = 60  # values of a record that bear them


@dataclass(frozen=True)
class DriveNumber(SensorNumber):
    """Sine or cosine of a harmonic of the drive, in parts of its amplitude: ``sin2`` of all records, ``sin2[0]`` of the first."""

    @property
    def neutral(self) -> float:
        """A pure sine has none."""
        return 0.0

    @property
    def in_the_model(self) -> bool:
        """It changes the motion itself."""
        return True

    @property
    def searched(self) -> bool:
        """A search is for a drive as it is given; harmonics are small."""
        return False

    @property
    def family(self) -> str:
        """All harmonics are known or unknown together."""
        return "harmonics"

    @property
    def of(self) -> str:
        """Whose number it is, in words."""
        return "the drive"

    @property
    def bounds(self) -> tuple[float, float]:
        """Where the search looks: everywhere."""
        return -1.0, 1.0

    def unit(self, of_record: str) -> str:
        """None: it is a part of the amplitude."""
        return ""


def with_harmonics(numbers: tuple[SensorNumber, ...], given: Any, targets: Any, parameters: Any, models: Any) -> tuple[SensorNumber, ...]:
    """The numbers of the sensors, and those of the drive of each group of records of one experiment.

    Parameters
    ----------
    given : None, number or dict
        None for what is usual; a standard deviation for the second and the third harmonic, 0 for none; or order -> standard deviation.
    models : sequence
        A model of each record.
    """
    spread = _spread(given)
    harmonics: list[SensorNumber] = []
    groups = _groups(parameters, targets)
    for records in groups:
        enough = any(targets[i].kind in ("velocity", "position") and targets[i].count >= _ENOUGH for i in records)
        if not enough or not spread or not any(True for _ in drives_within(models[records[0]])):
            continue
        label = "" if len(groups) == 1 else f"[{records[0]}]"
        for order, sd in spread.items():
            harmonics += [_number(part, order, label, records, sd) for part in _PARTS]
    return (*numbers, *harmonics)


def harmonics_of(model: Any, given: Any, count: int, what: str = "identify") -> tuple[DriveNumber, ...]:
    """The numbers of the drive of one experiment by itself, of which `count` values are measured; empty where they bear none.

    Parameters
    ----------
    given : None, number or dict
        As for `with_harmonics`.
    """
    spread = _spread(given, what)
    driven = count >= _ENOUGH and any(True for _ in drives_within(model))
    return tuple(_number(part, order, "", (0,), sd) for order, sd in spread.items() for part in _PARTS) if driven else ()


def _number(part: str, order: int, label: str, records: tuple[int, ...], sd: float) -> DriveNumber:
    return DriveNumber(f"{part}{order}{label}", records, 0.0, Distribution("normal", 0.0, sd))


def _spread(given: Any, what: str = "identify") -> dict[int, float]:
    """Standard deviations by order; `InputError` for what says none."""
    if given is None:
        return USUAL
    whole = {int(k) if str(k).isdigit() else k: sd for k, sd in given.items()} if isinstance(given, dict) else None  # "2" of a study file
    typed = dict.fromkeys(USUAL, given) if whole is None else whole
    wrong = [k for k in typed if not is_whole(k) or k not in ORDERS]
    if wrong or not all(is_number(sd) and 0 <= float(sd) <= 1 for sd in typed.values()):
        allowed = "a standard deviation from 0 (a pure sine) to 1 in parts of the amplitude, or a dict of them by order (2 to 9)"
        raise InputError(what, [f"harmonics = {given!r}; allowed is {allowed}; type for example harmonics=0.01 or harmonics={{2: 0.03}}"])
    return {int(k): float(sd) for k, sd in typed.items() if float(sd) > 0}


def _groups(parameters: Any, targets: Any) -> list[tuple[int, ...]]:
    """Records of one and the same experiment: no argument, and no free number, is of one of them alone."""
    own = {f.record for f in parameters.free if f.record is not None}
    groups: list[list[int]] = []
    for i in range(len(targets)):
        alike = (
            group for group in groups if i not in own and group[0] not in own and _same(parameters.fixed[i], parameters.fixed[group[0]])
        )
        group = next(alike, None)
        if group is None:
            groups.append([i])
        else:
            group.append(i)
    return [tuple(group) for group in groups]


def _same(one: dict[str, Any], other: dict[str, Any]) -> bool:
    """Whether arguments are the same; those that cannot be compared are, if they are one object."""
    return all(other[name] is value or repr(other[name]) == repr(value) for name, value in one.items())


def rippled(model: Any, reading: dict[str, Any]) -> Any:
    """A model with the harmonics of its drive."""
    parts = ripple_of(reading)
    if not parts:
        return model
    orders = range(2, max(order for _, order in parts) + 1)
    sines, cosines = (tuple(parts.get((part, k), 0.0) for k in orders) for part in _PARTS)
    return with_ripple(model, sines, cosines)


def ripple_of(reading: dict[str, Any]) -> dict[tuple[str, int], float]:
    """The harmonics among the numbers of one case: (part, order) -> part of the amplitude; empty where all are zero."""
    ripple = {(name[:3], int(name[3:])): float(value) for name, value in reading.items() if name[:3] in _PARTS and name[3:].isdigit()}
    return ripple if any(ripple.values()) else {}
