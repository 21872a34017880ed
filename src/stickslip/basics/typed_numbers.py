"""Numbers with units as people type them: "0.55 mm", "32.7 Hz", "1.7 deg", and quantities of pint."""

from __future__ import annotations

import math
import re
from typing import Any, Protocol

from stickslip.basics.errors import Problems
from stickslip.basics.units import Unit, unit_named

_TYPED = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)(\s*[^\d\s.,].*?|\s+\S.*?)\s*", re.IGNORECASE)
#: A cycle is 2 pi rad; 1/s may be either, and is neither.
_CYCLES = {("frequency", "angular velocity"): 2 * math.pi, ("angular velocity", "frequency"): 1 / (2 * math.pi)}


class _Quantity(Protocol):
    """A number with its unit as pint represents it."""

    magnitude: Any
    units: Any

    def to_base_units(self) -> _Quantity: ...


def has_unit(text: str) -> bool:
    """Whether text is a number and a unit.

    Examples
    --------
    >>> has_unit("0.55 mm"), has_unit("5e-4"), has_unit("lugre")
    (True, False, False)
    """
    return _TYPED.fullmatch(text.replace("−", "-")) is not None and not re.fullmatch(r"\S*\de[+-]?\d+", text.strip(), re.IGNORECASE)


def in_unit(value: Any, unit: str) -> Any:
    """A number, or several, in a unit: text with a unit and quantities of pint are converted, all else comes back as it is.

    Parameters
    ----------
    value : float, array, str, or a quantity of pint
        ``"0.55 mm"``, or a list of such; text without a number and a unit comes back as it is.
    unit : str
        The unit of the number's description, such as "m", "degrees" or "1".

    Returns
    -------
    float or what was given

    Raises
    ------
    ValueError
        Where the unit is not known, or measures something else.

    Examples
    --------
    >>> in_unit("0.55 mm", "m"), in_unit("1.7 deg", "degrees"), round(in_unit("32.7 Hz", "rad/s"), 4), in_unit("lugre", "1")
    (0.00055, 1.7, 205.4602, 'lugre')
    """
    if isinstance(value, str):
        match = _TYPED.fullmatch(value.replace("−", "-"))
        return value if match is None else _converted(float(match[1]), _unit(match[2].strip(), value, unit), unit)
    if isinstance(value, (list, tuple)) and any(isinstance(each, str) or _is_quantity(each) for each in value):
        return type(value)(in_unit(each, unit) for each in value)
    if _is_quantity(value):
        return _of_pint(value, unit)
    return value


def _is_quantity(value: Any) -> bool:
    return hasattr(value, "to_base_units") and hasattr(value, "magnitude") and hasattr(value, "units")


def in_seconds(duration: Any, problems: Problems) -> Any:
    """A duration that may have been typed with a unit; that of something else is noted.

    Examples
    --------
    >>> in_seconds("2 min", Problems("solve")), in_seconds(40.0, Problems("solve"))
    (120.0, 40.0)
    """
    try:
        return in_unit(duration, "s")
    except ValueError as error:
        problems.add(f"duration: {error}; type for example duration=10.0")
        return 1.0


def _of_pint(value: _Quantity, unit: str) -> Any:
    """By our own names of units, as pint takes 1 Hz for 1 rad/s; by its base units where we do not know one."""
    named = f"{value.units:~}".strip() or "1"
    if unit_named(_plain(named)) is None:
        value = value.to_base_units()
        named = f"{value.units:~}".strip() or "1"
    return _converted(value.magnitude, _unit(_plain(named), f"{value}", unit), unit)


def _plain(named: str) -> str:
    """A unit of pint in the form of ours: "kg * m ** 2 / s ** 2" and "1 / s"."""
    return re.sub(r"\s*(\*\*|[*/])\s*", r"\1", named)


def _unit(text: str, given: str, unit: str) -> Unit:
    """The unit of what was given; g is an acceleration where one is asked for, elsewhere grams."""
    wanted = unit_named(unit)
    named = "g0" if text == "g" and wanted is not None and wanted.quantity == "acceleration" else text
    known = unit_named(named)
    if known is None:
        raise ValueError(f"{given!r} is not a number, and {text!r} no unit that is known")
    return known


def _converted(value: Any, source: Unit, unit: str) -> Any:
    """A value in one unit as a value in the other."""
    wanted = unit_named(unit)
    if wanted is None:
        raise ValueError(f"no number in {source.text} can be taken for one in {unit}")
    factor = 1.0 if source.powers == wanted.powers else _factor_of_cycles(source, wanted, unit)
    factor *= source.factor / wanted.factor
    return _rounded(value * factor) if isinstance(value, (int, float)) else value * factor


def _rounded(value: float) -> float:
    """A product without the last bit that the factor leaves: 0.55 mm is 0.00055 m."""
    short = float(f"{value:.15g}")
    return short if abs(short - value) <= 2 * math.ulp(value) else value


def _factor_of_cycles(source: Unit, wanted: Unit, unit: str) -> float:
    """The factor between frequency and angular frequency; an error for any other pair."""
    pair = (source.quantity or "", wanted.quantity or "")
    if pair in _CYCLES and not re.fullmatch(r"1?/s|s\^?-1", source.text.replace(" ", "")):
        return _CYCLES[pair]
    if pair in _CYCLES:
        raise ValueError(f"{source.text} may be Hz or rad/s; say which")
    raise ValueError(f"{source.text} is a unit of {source.quantity or 'something else'} and no number in it can be one in {unit}")


#: Units that are tried beside those with a prefix.
_OTHERS = ("%", "g", "mg", "kg", "deg", "°", "rad", "mrad", "Hz", "kHz", "rpm", "rad/s", "in", "thou")


def others(unit: str) -> dict[str, float]:
    """Units in which a number in `unit` may be typed, with what one of each is.

    Examples
    --------
    >>> others("m")["mm"], others("degrees")["rad"], others("kg")["g"], others("1")
    (0.001, 57.29577951308232, 0.001, {'%': 0.01})
    """
    wanted = unit_named(unit)
    letters = () if unit in ("1", "degrees", "kg", "rad", "rad/s", "Hz") else ("", "k", "m", "µ", "u", "n")
    examples = {}
    for other in (*(letter + unit for letter in letters), *_OTHERS):
        known = unit_named(other)
        if wanted is None or known is None or (known.powers != wanted.powers and (known.quantity, wanted.quantity) not in _CYCLES):
            continue
        examples[other] = in_unit(f"1 {other}", unit)
    return examples
