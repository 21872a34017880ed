"""Units as files write them: what they are in SI, and what kind of quantity they measure. Nothing is guessed."""

from __future__ import annotations

import re
from dataclasses import dataclass

__all__ = ["SI", "Unit", "heading", "quantity_of", "unit_of"]

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
    "W": (1.0, (2, 1, -3, 0, 0)),
    "J": (1.0, (2, 1, -2, 0, 0)),
    "Hz": (1.0, (0, 0, -1, 0, 0)),
    "rad": (1.0, (0, 0, 0, 0, 1)),
}
#: Words that take no prefix.
_WORDS: dict[str, tuple[float, tuple[int, ...]]] = {
    "1": (1.0, (0,) * 5),
    "-": (1.0, (0,) * 5),
    "%": (1e-2, (0,) * 5),
    "sec": (1.0, (0, 0, 1, 0, 0)),
    "seconds": (1.0, (0, 0, 1, 0, 0)),
    "min": (60.0, (0, 0, 1, 0, 0)),
    "h": (3600.0, (0, 0, 1, 0, 0)),
    "deg": (0.017453292519943295, (0, 0, 0, 0, 1)),
    "°": (0.017453292519943295, (0, 0, 0, 0, 1)),
    "in": (0.0254, (1, 0, 0, 0, 0)),
    "ft": (0.3048, (1, 0, 0, 0, 0)),
    "lbf": (4.4482216152605, (1, 1, -2, 0, 0)),
    "g0": (9.80665, (1, 0, -2, 0, 0)),
}
_QUANTITIES: dict[tuple[int, ...], str] = {
    (0, 0, 1, 0, 0): "time",
    (1, 0, -1, 0, 0): "velocity",
    (1, 0, 0, 0, 0): "position",
    (1, 0, -2, 0, 0): "acceleration",
    (1, 1, -2, 0, 0): "force",
    (-1, 1, -2, 0, 0): "pressure",
    (2, 1, -3, -1, 0): "voltage",
    (0, 0, -1, 0, 0): "frequency",
    (0, 0, 0, 0, 0): "ratio",
    (0, 1, 0, 0, 0): "mass",
}
#: The SI unit of what units measure here.
SI = {
    "time": "s", "velocity": "m/s", "position": "m", "acceleration": "m/s²", "force": "N", "pressure": "Pa", "voltage": "V",
    "frequency": "Hz", "ratio": "1", "mass": "kg",
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
        """What it measures: "time", "velocity", "position", ...; None if that has no name here."""
        return _QUANTITIES.get(self.powers)


def unit_of(text: str | None) -> Unit | None:
    """The unit that a text names; None if it names none that is known here.

    Examples
    --------
    >>> unit_of("mm/s").factor, unit_of("m/s²").quantity, unit_of("furlong")
    (0.001, 'acceleration', None)
    """
    if text is None:
        return None
    plain = text.strip().replace("²", "^2").replace("³", "^3").replace("⁻¹", "^-1").replace("**", "^").replace("·", "*")
    plain = plain[1:-1] if plain.startswith("(") and plain.endswith(")") else plain
    if not plain:
        return None
    factor, powers = 1.0, [0] * 5
    for sign, part in _factors(plain):
        found = _single(part)
        if found is None:
            return None
        factor *= found[0] ** sign
        powers = [p + sign * q for p, q in zip(powers, found[1], strict=True)]
    return Unit(text.strip(), factor, tuple(powers))


def _factors(text: str) -> list[tuple[int, str]]:
    """The factors of a product, with +1 above and -1 below the stroke."""
    parts = re.split(r"([/*]| +(?=\w))", text)
    found, sign = [(1, parts[0].strip())], 1
    for mark, part in zip(parts[1::2], parts[2::2], strict=True):
        sign = -1 if mark == "/" else sign if mark == "*" or not mark.strip() else 1
        found.append((sign, part.strip(" ()")))
    return found


def _single(text: str) -> tuple[float, tuple[int, ...]] | None:
    """One unit with its prefix and power."""
    found = re.fullmatch(r"(\D+?|1|g0)(?:\^?(-?\d))?", text)
    if not found:
        return None
    power = int(found[2] or 1)
    symbol = _WORDS.get(found[1]) or _prefixed(found[1])
    return None if symbol is None else (symbol[0] ** power, tuple(power * p for p in symbol[1]))


def _prefixed(symbol: str) -> tuple[float, tuple[int, ...]] | None:
    for length in (0, 1):
        head, tail = symbol[:length], symbol[length:]
        if head in _PREFIX and tail in _BASE:
            return _PREFIX[head] * _BASE[tail][0], _BASE[tail][1]
    return None


def quantity_of(text: str | None) -> str | None:
    """What a unit's text measures; None if that is not known."""
    unit = unit_of(text)
    return None if unit is None else unit.quantity


def heading(text: str) -> tuple[str, str | None]:
    """A column's heading as name and unit; the unit is None if the heading names none.

    Examples
    --------
    >>> heading("Normal [uN]"), heading("v (mm/s)"), heading("t / ms"), heading("LDV")
    (('Normal', 'uN'), ('v', 'mm/s'), ('t', 'ms'), ('LDV', None))
    """
    text = text.strip().strip('"').strip()
    boxed = re.fullmatch(r"(.*?)\s*\[([^\]\[]*)\]\s*", text)
    if boxed:
        return boxed[1].strip(), boxed[2].strip() or None
    for pattern in (r"(.+?)\s*\(([^()]*)\)", r"(.+?)\s+in\s+(\S+)", r"(.+?)\s*/\s*\((.*)\)", r"(.+?)\s+/\s+(\S+)", r"(\w+)\s*,\s*(\S+)"):
        found = re.fullmatch(pattern, text)
        if found and unit_of(found[2]) is not None:
            return found[1].strip(), found[2].strip()
    return text, None
