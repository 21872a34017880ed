"""Units as people and files write them: their SI values and the kind of quantity. Nothing is guessed."""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass

from stickslip.basics.unit_words import WORDS

_PREFIX = {"": 1.0, "G": 1e9, "M": 1e6, "k": 1e3, "d": 1e-1, "c": 1e-2, "m": 1e-3, "u": 1e-6, "µ": 1e-6, "μ": 1e-6, "n": 1e-9, "p": 1e-12}
#: Symbol -> (factor to SI, powers of m, kg, s, A, rad).
_BASE: dict[str, tuple[float, tuple[int, ...]]] = {
    "m": (1.0, (1, 0, 0, 0, 0)),
    "s": (1.0, (0, 0, 1, 0, 0)),
    "g": (1e-3, (0, 1, 0, 0, 0)),
    "N": (1.0, (1, 1, -2, 0, 0)),
    "Pa": (1.0, (-1, 1, -2, 0, 0)),
    "bar": (1e5, (-1, 1, -2, 0, 0)),
    "V": (1.0, (2, 1, -3, -1, 0)),
    "A": (1.0, (0, 0, 0, 1, 0)),
    "Ohm": (1.0, (2, 1, -3, -2, 0)),
    "W": (1.0, (2, 1, -3, 0, 0)),
    "J": (1.0, (2, 1, -2, 0, 0)),
    "Hz": (1.0, (0, 0, -1, 0, 0)),
    "rad": (1.0, (0, 0, 0, 0, 1)),
}
#: The SI unit of what units measure here.
SI = {
    "time": "s", "velocity": "m/s", "position": "m", "acceleration": "m/s²", "force": "N", "pressure": "Pa", "voltage": "V",
    "frequency": "Hz", "ratio": "1", "mass": "kg", "torque": "N m", "angle": "rad", "angular velocity": "rad/s",
    "angular acceleration": "rad/s²", "current": "A",
}  # fmt: skip


@dataclass(frozen=True)
class Unit:
    """A unit that is understood.

    Parameters
    ----------
    text : str
        As it was written.
    factor : float
        What one of it is in SI units.
    powers : tuple of int
        Powers of m, kg, s, A and rad.
    """

    text: str
    factor: float
    powers: tuple[int, ...]

    @property
    def quantity(self) -> str | None:
        """The quantity that it measures: "time", "velocity", "position", ...; None if it has no name here."""
        return _QUANTITIES.get(self.powers)


@functools.lru_cache(maxsize=4096)
def unit_named(text: str | None) -> Unit | None:
    """The unit that a text names; None if it names none that is known here.

    Examples
    --------
    >>> unit_named("mm/s").factor, unit_named("m/s²").quantity, unit_named("furlong")
    (0.001, 'acceleration', None)
    >>> unit_named("mNm").quantity, unit_named("RPM").quantity, unit_named("microns").factor, round(unit_named("kip").factor, 3)
    ('torque', 'angular velocity', 1e-06, 4448.222)
    """
    if text is None:
        return None
    plain = text.strip().replace("²", "^2").replace("³", "^3").replace("⁻¹", "^-1").replace("**", "^").replace("·", "*")
    plain = plain[1:-1] if plain.startswith("(") and plain.endswith(")") else plain
    if not plain:
        return None
    plain = re.sub(r"(?<=[A-Za-z])(?:[-.]| per )(?=[A-Za-z])", lambda mark: "/" if "per" in mark[0] else "*", plain)  # N-m, mm per s
    whole = WORDS.get(re.sub(r"[* ]+", "*", plain.lower()))  # ft lb: force times length, whatever lb is alone
    if whole is not None and re.search(r"[* /]", plain):
        return Unit(text.strip(), *whole)
    factor, powers = 1.0, [0] * 5
    for sign, part in _factors(plain):
        single = _single(part)
        if single is None:
            return None
        factor *= single[0] ** sign
        powers = [p + sign * q for p, q in zip(powers, single[1], strict=True)]
    return Unit(text.strip(), factor, tuple(powers))


def _factors(text: str) -> list[tuple[int, str]]:
    """The factors of a product, with +1 above and -1 below the stroke."""
    text = re.sub(r"\b([GMkdcmuµμn]?N)((?:[cmkuµμ])?m)\b", r"\1*\2", text)  # Nm, which is not nm
    if boxed := re.search(r"([/*]?) *\(([^()]+)\)", text):  # V/(m/s): what is below the inner stroke is above the outer one
        sign, rest = -1 if boxed[1] == "/" else 1, (text[: boxed.start()] + text[boxed.end() :]).strip()
        return [*(_factors(rest) if rest else []), *((sign * inner, part) for inner, part in _factors(boxed[2]))]
    parts = re.split(r"([/*]| +(?=\w))", text)
    factors, sign = [(1, parts[0].strip())], 1
    for mark, part in zip(parts[1::2], parts[2::2], strict=True):
        sign = -1 if mark == "/" else sign if mark == "*" or not mark.strip() else 1
        factors.append((sign, part.strip()))
    return factors


def _single(text: str) -> tuple[float, tuple[int, ...]] | None:
    """One unit with its prefix and power."""
    match = re.fullmatch(r"(g0|\D+?|1)(?:\^?(-?[1-9]))?", text)
    if not match:
        return None
    power = int(match[2] or 1)
    symbol = WORDS.get(match[1]) or _prefixed(match[1]) or _long(match[1].lower())
    return None if symbol is None else (symbol[0] ** power, tuple(power * p for p in symbol[1]))


def _prefixed(symbol: str) -> tuple[float, tuple[int, ...]] | None:
    for length in (0, 1):
        head, tail = symbol[:length], symbol[length:]
        if head in _PREFIX and tail in _BASE:
            return _PREFIX[head] * _BASE[tail][0], _BASE[tail][1]
    return None


def _long(word: str) -> tuple[float, tuple[int, ...]] | None:
    """A word of three letters or more in any case, also of several: RPM, Newtons."""
    if len(word) < 3:
        return None
    return WORDS.get(word) or (WORDS.get(word.removesuffix("s")) if len(word) > 4 else None)


#: What a unit with these powers measures.
_QUANTITIES = {unit.powers: name for name, text in SI.items() if (unit := unit_named(text))}


def quantity_of(text: str | None) -> str | None:
    """The quantity that a unit's text measures; None if unknown."""
    unit = unit_named(text)
    return None if unit is None else unit.quantity


def unit_of_heading(text: str) -> tuple[str, str | None]:
    """A column's heading as name and unit; the unit is None if the heading names none.

    Examples
    --------
    >>> unit_of_heading("Normal [uN]"), unit_of_heading("v (mm/s)"), unit_of_heading("t / ms"), unit_of_heading("LDV")
    (('Normal', 'uN'), ('v', 'mm/s'), ('t', 'ms'), ('LDV', None))
    >>> unit_of_heading("pos_deg"), unit_of_heading("v_mm_s"), unit_of_heading("v_min")
    (('pos_deg', 'deg'), ('v_mm_s', 'mm/s'), ('v_min', None))
    """
    text = text.strip().strip('"').strip()
    boxed = re.fullmatch(r"(.*?)\s*\[([^\]\[]*)\]\s*", text)
    if boxed:
        return boxed[1].strip(), boxed[2].strip() or None
    for pattern in (r"(.+?)\s*\(([^()]*)\)", r"(.+?)\s+in\s+(\S+)", r"(.+?)\s*/\s*\((.*)\)", r"(.+?)\s+/\s+(\S+)", r"(\w+)\s*,\s*(\S+)"):
        match = re.fullmatch(pattern, text)
        if match and unit_named(match[2]) is not None:
            return match[1].strip(), match[2].strip()
    return text, parted_name(text)[1]


#: Units with which a name may end after a stroke below, as robots' logs have them. Words that are ends of other names too (min, in, g, pm)
#: are none; a unit of one letter is one after names of its quantity alone.
_ENDS = {
    *(
        "ns",
        "us",
        "ms",
        "sec",
        "nm",
        "um",
        "mm",
        "cm",
        "deg",
        "rad",
        "rpm",
        "mA",
        "mV",
        "kV",
        "mN",
        "kN",
        "Nm",
        "mNm",
        "Ncm",
        "Nmm",
        "Hz",
        "kHz",
    ),
    *("kPa", "MPa", "mbar", "bar", "mps", "kph", "rps"),
    *(f"{length}/{time}" for length in ("m", "cm", "mm", "um", "rad", "deg", "rev") for time in ("s", "s2", "s^2", "ms")),
}
_LETTERS = {
    "s": r"t|time|zeit|timestamp|seconds|elapsed.*|.*[_ ]time", "m": r"x|y|z|s|pos.*|disp.*|weg|stroke|gap|.*[_ ](x|pos|position)",
    "N": r"f|force|kraft|load|.*[_ ](f|force|load)|f[_ ]?[a-z0-9]*|friction|normal", "A": r"i|cur|curr|current|strom|.*[_ ](i|current)",
    "V": r"u|v|volt.*|voltage|spannung|.*[_ ](u|voltage)",
}  # fmt: skip


def parted_name(name: str) -> tuple[str, str | None]:
    """A name such as pos_deg, F_N or v_mm_s as what stands before its unit, and the unit; None if it ends with none without doubt.

    Examples
    --------
    >>> parted_name("cmd_deg"), parted_name("v_mm_s"), parted_name("v_min")
    (('cmd', 'deg'), ('v', 'mm/s'), ('v_min', None))
    """
    words = name.split("_")
    for count in (3, 2, 1):
        head, tail = "_".join(words[:-count]), "_".join(words[-count:])
        unit = tail.replace("_per_", "/").replace("_", "/")
        if head and unit in _ENDS and unit_named(unit) is not None:
            return head, unit
        if head and unit in _LETTERS and re.fullmatch(_LETTERS[unit], head, re.I):
            return head, unit
    return name, None
