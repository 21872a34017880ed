"""The functions a law or a drive may call: at home on floats, arrays and symbols.

On a float they call `math`, on an array NumPy, and on anything with a hook (``x.__ss_exp__()``) that hook:
this is how the engine's symbols write down an equation without this module knowing of them.
"""

from __future__ import annotations

import math
from typing import Any

__all__ = ["cos", "exp", "log", "maximum", "minimum", "pi", "sin", "sqrt", "tanh", "where"]

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
