"""Effects of friction laws that may be left out, so that a law becomes a simpler one inside it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from stickslip.basics.contracts import Model
from stickslip.basics.fields import leaves, replace_leaf

#: Effects of laws that may be left out: the numbers that make them, and what these are without it (a number, or another number of the
#: law, below which laws do not take it). What they mean is in docs/notation.md; a law in which they mean something else gets a seed that is
#: no better than others.
EFFECTS: dict[str, dict[str, float | str]] = {
    "static friction": {"f_plus": "mu_plus", "f_minus": "mu_minus"},
    "viscous friction": {"viscous": 0.0, "viscous_plus": 0.0, "viscous_minus": 0.0, "sigma2": 0.0},
    "quadratic friction": {"quadratic": 0.0, "quadratic_plus": 0.0, "quadratic_minus": 0.0},
    "bristle damping": {"sigma1": 0.0},
    "elastic part": {"z_ba": 0.0, "z_ba_minus": 0.0},
    "shape": {"exponent": 1.0},
}


def plainer(model: Model, effects: Iterable[str]) -> Any:
    """The same model without some effects of its law.

    Examples
    --------
    >>> import stickslip as ss
    >>> plainer(ss.CoulombViscous(0.15, 0.21, 0.18, 0.24, viscous=0.4), ["static friction", "viscous friction"])
    CoulombViscous(mu_plus=0.15, mu_minus=0.21, f_plus=0.15, f_minus=0.21, viscous=0.0, quadratic=0.0)
    """
    return replace_leaf(model, numbers_without(dict(leaves(model)), effects))


def numbers_without(numbers: dict[str, Any], effects: Iterable[str]) -> dict[str, Any]:
    """The numbers of a model without some effects."""
    plain = {}
    for name in numbers:
        stem, dot, own = name.rpartition(".")
        for other in (EFFECTS[effect][own] for effect in effects if own in EFFECTS[effect]):
            if not isinstance(other, str):
                plain[name] = other
            elif f"{stem}{dot}{other}" in numbers:
                plain[name] = numbers[f"{stem}{dot}{other}"]
    return plain


def floors(numbers: dict[str, Any]) -> list[float]:
    """How far numbers of a model are above the others that they are without their effect, and below which they have no meaning."""
    bound = [name for name in numbers if any(isinstance(own.get(name.rpartition(".")[2]), str) for own in EFFECTS.values())]
    plain = numbers_without(numbers, list(EFFECTS))
    return [float(numbers[name] - plain[name]) for name in bound if name in plain]
