"""Functions for laws and drives; they accept floats, arrays and symbols.

On a float they call `math`, on an array NumPy, and on an object with a hook (``x.__ss_exp__()``) that hook: this is how the engine traces
an equation with its own symbols.

All three give the same values everywhere, without exceptions or warnings, because `where` evaluates both of its branches: a function is NaN
where it is undefined, and beyond an argument of 690 exp, sinh and cosh keep the value that they have there (2e299 to 5e299), which remains
finite when multiplied by a factor of ordinary size.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.lazy_names import listing
from stickslip.basics.of_own import OfOwn, without_others

__all__ = [
    "asinh", "atan", "cos", "cosh", "exp", "hypot", "is_symbol",
    "log", "maximum", "minimum", "pi", "sin", "sinh", "sqrt", "tanh", "where", "within",
    "wrapped",
]  # fmt: skip
__dir__ = listing(__all__)

pi = math.pi

LARGEST = 690.0  # where exp, sinh and cosh stop growing: a float holds up to exp(709.78)
_FAR = 2e299
_GROWING = ("exp", "sinh", "cosh")
_IN_NUMPY = {"asinh": "arcsinh", "atan": "arctan"}


def function_value(name: str, x: Any) -> Any:
    """The value of the function of this name for a number, an array, or an object with its own ``__ss_name__``."""
    hook = getattr(x, f"__ss_{name}__", None)
    if hook is not None:
        return hook()
    if isinstance(x, (float, int)):
        try:
            y = getattr(math, name)(x)
        except (ValueError, OverflowError):
            y = math.inf
        return y if abs(y) < _FAR or x != x else _beyond(name, x)
    if type(x) is OfOwn:
        return function_value(name, x.value)
    import numpy as np

    if name in _GROWING:
        x = np.minimum(x, LARGEST) if name == "exp" else np.clip(x, -LARGEST, LARGEST)
    with np.errstate(all="ignore"):
        return getattr(np, _IN_NUMPY.get(name, name))(x)


def _beyond(name: str, x: float) -> float:
    """The value of a function where `math` raises or overflows: that of NumPy, with the argument limited."""
    import numpy as np

    return float(function_value(name, np.float64(x).reshape(1))[0])


def exp(x: Numeric) -> Any:
    """e to the power x; constant at 5e299 for x above 690.

    Examples
    --------
    >>> exp(0.0), exp(1e6) == exp(690.0)
    (1.0, True)
    """
    return function_value("exp", x)


def log(x: Any) -> Any:
    """Natural logarithm; NaN for a negative number."""
    return function_value("log", x)


def sqrt(x: Numeric) -> Any:
    """Square root; NaN for a negative number."""
    return function_value("sqrt", x)


def sin(x: Numeric) -> Any:
    """Sine of an angle [rad]."""
    return function_value("sin", x)


def cos(x: Numeric) -> Any:
    """Cosine of an angle [rad]."""
    return function_value("cos", x)


def atan(x: Numeric) -> Any:
    """The angle between -pi/2 and pi/2 whose tangent is x [rad]."""
    return function_value("atan", x)


def sinh(x: Numeric) -> Any:
    """Hyperbolic sine; constant at 2e299, with the sign of x, for abs(x) above 690."""
    return function_value("sinh", x)


def cosh(x: Numeric) -> Any:
    """Hyperbolic cosine; constant at 2e299 for abs(x) above 690."""
    return function_value("cosh", x)


def tanh(x: Numeric) -> Any:
    """Hyperbolic tangent."""
    return function_value("tanh", x)


def asinh(x: Numeric) -> Any:
    """Inverse hyperbolic sine, log(x + sqrt(x^2 + 1)); used in rate-and-state friction instead of a logarithm."""
    return function_value("asinh", x)


def hypot(a: Any, b: Any) -> Any:
    """sqrt(a^2 + b^2); it has a corner where both are zero.

    Examples
    --------
    >>> hypot(3.0, 4.0)
    5.0
    """
    if hasattr(a, "__ss_sqrt__") or hasattr(b, "__ss_sqrt__"):
        return sqrt(a * a + b * b)
    if isinstance(a, (float, int)) and isinstance(b, (float, int)):
        return math.hypot(a, b)
    import numpy as np

    with np.errstate(all="ignore"):
        return np.hypot(a, b)


def is_symbol(value: Numeric) -> bool:
    """Whether a value is a symbol, as in equations that are being traced.

    Examples
    --------
    >>> is_symbol(1.0)
    False
    """
    return hasattr(value, "__ss_sin__")


def where(condition: Any, yes: Any, no: Any) -> Any:
    """`yes` where the condition holds, else `no`; to be used in laws instead of ``if``.

    Examples
    --------
    >>> where(2.0 > 1.0, 10.0, 20.0)
    10.0
    """
    yes, no, hook = without_others(yes), without_others(no), getattr(condition, "__ss_where__", None)
    if hook is not None:
        return hook(yes, no)
    if isinstance(condition, int):  # ~True is -2 in Python; in any &, | and ~ of bools the last bit holds the truth value
        return yes if condition & 1 else no
    import numpy as np

    return np.where(condition, yes, no)


def maximum(a: Numeric, b: Numeric) -> Any:
    """The larger of two values."""
    return where(a > b, a, b)


def minimum(a: Numeric, b: Numeric) -> Any:
    """The smaller of two values."""
    return where(a < b, a, b)


def within(t: Numeric, period: Numeric) -> Any:
    """Time since the period began [s], by which a piecewise drive selects its piece.

    The engine's own time restarts with each period and is returned unchanged; for shifted times see `wrapped`. An instant that
    is a whole number of periods up to rounding is the beginning of a period, never its end.

    Examples
    --------
    >>> within(0.75, 0.5), within(3 * 0.1, 0.1)
    (0.25, 0.0)
    """
    hook = getattr(t, "__ss_within__", None)
    if hook is not None:
        return hook(period)
    if is_symbol(period):
        return t
    whole = t / period * (1 + 1e-15)  # the quotient of k periods may lie two roundings below k
    if isinstance(whole, float):
        return max(t - period * math.floor(whole), 0.0)
    import numpy as np

    return np.maximum(t - period * np.floor(whole), 0.0)


def wrapped(t: Numeric, period: Numeric) -> Any:
    """A time less than two periods outside [0, period), reduced to that interval [s], as needed after shifts.

    Examples
    --------
    >>> [wrapped(t, 1.0) for t in (-1.25, -0.25, 0.5, 1.25, 2.25)]
    [0.75, 0.75, 0.5, 0.25, 0.25]
    """
    before = where(t < -period, t + 2.0 * period, t + period)
    after = where(t < 2.0 * period, t - period, t - 2.0 * period)
    return where(t < 0.0, before, where(t < period, t, after))


def bisected(lies_beyond: Callable[[Any], Any], low: Numeric, high: Numeric, halvings: int) -> tuple[Any, Any]:
    """The interval from `low` to `high` after bisection by `lies_beyond`.

    Examples
    --------
    >>> low, high = bisected(lambda x: x * x < 2.0, 1.0, 2.0, 40)
    >>> round(low, 9), round(high, 9)
    (1.414213562, 1.414213562)
    """
    import numpy as np

    ends: tuple[Any, Any] = low, high
    for _ in range(halvings):
        before, middle = ends, 0.5 * (ends[0] + ends[1])
        beyond = lies_beyond(middle)
        ends = where(beyond, middle, before[0]), where(beyond, before[1], middle)
        if all(map(np.array_equal, ends, before)):  # no number is left between them
            break
    return ends
