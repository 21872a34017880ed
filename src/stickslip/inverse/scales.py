"""A number between two bounds as one from 0 to 1, on a linear or a logarithmic scale: what the searches of fits and of designs move."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Scale:
    """The scale between two bounds.

    Parameters
    ----------
    low, high : float
    log : bool
        Whether it is logarithmic; both bounds are positive then.
    """

    low: float
    high: float
    log: bool = False

    def inner(self, value: Any) -> Any:
        """The place of a value: 0 at the lower bound, 1 at the upper one."""
        if self.log:
            return np.log(np.asarray(value) / self.low) / np.log(self.high / self.low)
        return (np.asarray(value) - self.low) / (self.high - self.low)

    def outer(self, part: Any) -> Any:
        """The value at a part of the way, 0 to 1."""
        if self.log:
            return self.low * (self.high / self.low) ** part
        return self.low + (self.high - self.low) * part

    def slope(self, part: Any) -> float:
        """d value / d part."""
        return float(self.outer(part) * np.log(self.high / self.low)) if self.log else self.high - self.low
