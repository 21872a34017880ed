"""The sliders: every number of the page once, with symbol, units, range and bounds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from stickslip.explorer.models import DESCRIBED
from stickslip.quantities import shown_factor, symbol_text
from stickslip.typed_numbers import others

_BEYOND = 1e3  # times the ends of its slider is what may be typed


@dataclass(frozen=True)
class Parameter:
    """One number of the page; everything is in SI units but what is shown.

    Parameters
    ----------
    name : str
        Its name in messages, in the address and in the page.
    symbol, label : str
        Its letter and what it is.
    default, low, high : float
        Where the slider stands at first, and its two ends.
    unit : str
        The unit that is shown.
    factor : float
        The shown number is the value times this.
    least, most : float
        What is allowed, however it is typed.
    units : dict
        Units that may be typed behind a number, and what one of each is.

    Examples
    --------
    >>> A = PARAMETERS["amplitude"]
    >>> A.shown(A.default)
    '0.5525 mm'
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
    def described(cls, name: str, told: Mapping[str, Any], value: float, reach: tuple[float, float]) -> Parameter:
        """The parameter of a number that is described, at a value, with the reach of its slider."""
        low, high = min(reach[0], value), max(reach[1], value)
        least, most = min(low / _BEYOND, low * _BEYOND), max(high / _BEYOND, high * _BEYOND)
        rule = told.get("rule")
        least, most = (beyond if rule is None or rule(beyond) else end for beyond, end in ((least, low), (most, high)))
        unit = str(told.get("unit", "1"))
        label = str(told.get("label") or name.rpartition(".")[2].replace("_", " "))
        return cls(name, symbol_text(str(told.get("symbol", ""))), label, value, low, high, *shown_factor(told), least, most, others(unit))

    def shown(self, value: float) -> str:
        """A value as a person reads it."""
        return f"{value * self.factor:.6g} {self.unit}".rstrip()

    def allowed(self) -> str:
        """The allowed values."""
        return f"{self.shown(self.least)} to {self.shown(self.most)}"


def _of_page(name: str, told: Mapping[str, Any]) -> Parameter:
    value = float(told.get("example", 1.0))
    return Parameter.described(name, told, value, told.get("range") or (0.1 * value, 2.5 * value))


PARAMETERS: dict[str, Parameter] = {name: _of_page(name, told) for name, told in DESCRIBED.items()}
"""Every parameter by name, in the order of the page."""
