"""What several laws share: a coefficient for each direction, and the Stribeck curve."""

from __future__ import annotations

from typing import Any

from stickslip.errors import Problems
from stickslip.fields import _all, describe
from stickslip.maths import exp, where

__all__ = ["by_side", "check_static", "static", "stribeck"]


def by_side(v: Any, plus: Any, minus: Any) -> Any:
    """The forward value where v > 0, else the backward one."""
    return where(v > 0, plus, minus)


def static(f: Any, mu: Any) -> Any:
    """The break-away coefficient; ``None`` means that it is the kinetic one."""
    return mu if f is None else f


def stribeck(v: Any, mu: Any, f: Any, v_s: Any) -> Any:
    """Steady friction coefficient: from f at rest to mu at speed (the bracket of Eq. 2.6)."""
    return mu + (f - mu) * exp(-((v / v_s) ** 2))


def check_static(law: Any, problems: Problems) -> None:
    """Static friction below kinetic friction has no meaning in these laws."""
    for side in ("plus", "minus"):
        f, mu = getattr(law, f"f_{side}"), getattr(law, f"mu_{side}")
        try:
            good = f is None or _all(f >= mu)
        except (TypeError, ValueError):  # a number that was already reported, or shapes that the robot reports
            continue
        if not good:
            problems.add(
                f"f_{side} = {describe(f)} is below mu_{side} = {describe(mu)}; allowed is f_{side} >= mu_{side} "
                f"(static friction is not below kinetic friction); type f_{side}=None for equal ones"
            )
