"""The functions a law or a drive may call: at home on floats, arrays and symbols.

On a float they call `math`, on an array NumPy, and on anything with a hook (``x.__ss_exp__()``) that hook:
this is how the engine's symbols write down an equation without this module knowing of them.
"""

from __future__ import annotations

import math
from typing import Any

__all__ = ["cos", "exp", "log", "maximum", "minimum", "pi", "sin", "sqrt", "tanh", "where", "within"]

pi = math.pi


def _apply(name: str, x: Any) -> Any:
    hook = getattr(x, f"__ss_{name}__", None)
    if hook is not None:
        return hook()
    if isinstance(x, (float, int)):
        return getattr(math, name)(x)
    import numpy as np

    return getattr(np, name)(x)


def exp(x: Any) -> Any:
    """e to the power x."""
    return _apply("exp", x)


def log(x: Any) -> Any:
    """Natural logarithm."""
    return _apply("log", x)


def sqrt(x: Any) -> Any:
    """Square root."""
    return _apply("sqrt", x)


def sin(x: Any) -> Any:
    """Sine of an angle [rad]."""
    return _apply("sin", x)


def cos(x: Any) -> Any:
    """Cosine of an angle [rad]."""
    return _apply("cos", x)


def tanh(x: Any) -> Any:
    """Hyperbolic tangent."""
    return _apply("tanh", x)


def where(condition: Any, yes: Any, no: Any) -> Any:
    """`yes` where the condition holds, else `no`: what a law writes instead of ``if``.

    Examples
    --------
    >>> where(2.0 > 1.0, 10.0, 20.0)
    10.0
    """
    hook = getattr(condition, "__ss_where__", None)
    if hook is not None:
        return hook(yes, no)
    if isinstance(condition, bool):
        return yes if condition else no
    import numpy as np

    return np.where(condition, yes, no)


def maximum(a: Any, b: Any) -> Any:
    """The larger of two."""
    return where(a > b, a, b)


def minimum(a: Any, b: Any) -> Any:
    """The smaller of two."""
    return where(a < b, a, b)


def within(t: Any, period: Any) -> Any:
    """Time since the period began [s]: what a drive in pieces asks for before it chooses a piece.

    On the engine's symbols it is t itself, because the engine's time starts anew with each period. An instant that is a whole
    number of periods up to rounding is the beginning of a period, never its end.

    Examples
    --------
    >>> within(0.75, 0.5), within(3 * 0.1, 0.1)
    (0.25, 0.0)
    """
    if hasattr(t, "__ss_sin__") or hasattr(period, "__ss_sin__"):
        return t
    whole = t / period * (1 + 1e-15)  # the quotient of k periods may lie two roundings below k
    if isinstance(whole, float):
        return max(t - period * math.floor(whole), 0.0)
    import numpy as np

    return np.maximum(t - period * np.floor(whole), 0.0)
