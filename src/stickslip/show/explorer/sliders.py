"""The sliders: every number of the page once, with symbol, units, range and bounds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from stickslip.basics.quantities import shown_factor, symbol_text
from stickslip.basics.typed_numbers import others
from stickslip.show.explorer.models import DESCRIBED

_BEYOND = 1e3  # the typed value may exceed the ends of the slider by this factor


@dataclass(frozen=True)
class Parameter:
    """One number of the page, in SI units except where shown.

    Parameters
    ----------
    name : str
        Its name in messages, in the address and on the page.
    symbol, label : str
        Its symbol and meaning.
    default, low, high : float
        Initial value, and the two ends of the slider.
    unit : str
        The displayed unit.
    factor : float
        The displayed number is the value times this factor.
    least, most : float
        Bounds of a typed value.
    units : dict
        Units that may follow a typed number, with their conversion factors.

    Examples
    --------
    >>> A = PARAMETERS["amplitude"]
    >>> A.shown(A.default)
    '0.556 mm'
    """

    name: str
    symbol: str
    label: str
    default: float
    low: float
    high: float
    unit: str = ""
    factor: float = 1.0
    least: float = 0.0
    most: float = 1e9
    units: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def described(cls, name: str, description: Mapping[str, Any], value: float, reach: tuple[float, float]) -> Parameter:
        """The parameter for a described number, at a value, with the range of its slider."""
        low, high = min(reach[0], value), max(reach[1], value)
        least, most = min(low / _BEYOND, low * _BEYOND), max(high / _BEYOND, high * _BEYOND)
        rule = description.get("rule")
        least, most = (beyond if rule is None or rule(beyond) else end for beyond, end in ((least, low), (most, high)))
        unit = str(description.get("unit", "1"))
        label = str(description.get("label") or name.rpartition(".")[2].replace("_", " "))
        return cls(
            name,
            symbol_text(str(description.get("symbol", ""))),
            label,
            value,
            low,
            high,
            *shown_factor(description),
            least,
            most,
            others(unit),
        )

    def shown(self, value: float) -> str:
        """A value as text, in the displayed unit."""
        return f"{value * self.factor:.6g} {self.unit}".rstrip()

    def allowed(self) -> str:
        """The allowed range, as text."""
        return f"{self.shown(self.least)} to {self.shown(self.most)}"


def _of_page(name: str, description: Mapping[str, Any]) -> Parameter:
    value = float(description.get("example", 1.0))
    p = Parameter.described(name, description, value, description.get("range") or (0.1 * value, 2.5 * value))
    if p.unit != "rad/s":
        return p
    return replace(p, label="drive frequency", symbol="f", unit="Hz", factor=0.5 / math.pi)  # as a person counts it, and the texts say it


PARAMETERS: dict[str, Parameter] = {name: _of_page(name, description) for name, description in DESCRIBED.items()}
"""Every parameter by name, in the order of the page."""
