"""User-defined functions of (t, y): values and derivatives, or a message about the mistake and its correction."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, StickslipError
from stickslip.basics.forward_ad import Truth, slopes_of, variables

_PLAIN = (
    "its derivatives come from its own lines, so write it in plain arithmetic and with stickslip.maths "
    "(sin, cos, exp, log, sqrt, tanh, where, ...) instead of NumPy or math"
)


def value_and_slopes(f: Callable[..., Any], t: float, y: Array, name: str = "f", count: int | None = None) -> tuple[Array, Array, Array]:
    """Values of f(t, y), their derivatives by t, and by y; not a number where its arithmetic fails.

    Parameters
    ----------
    f : callable
    t, y : float, array
        Where.
    name : str
        What it is called in messages.
    count : int, optional
        How many values it must give.

    Examples
    --------
    >>> from stickslip.maths import sin
    >>> value, by_t, by_y = value_and_slopes(lambda t, y: (y[1], -sin(y[0])), 0.0, [0.0, 2.0])
    >>> value.tolist(), by_y.tolist()
    ([2.0, -0.0], [[0.0, 1.0], [-1.0, 0.0]])
    """
    at, *coordinates = variables(t, *y)
    rows = _rows(checked_call(f, name, at, coordinates), name, count)
    if rows is None:
        return np.full(count or 1, np.nan), np.full(count or 1, np.nan), np.full((count or 1, len(y)), np.nan)
    slopes = np.array([slopes_of(row, 1 + len(y)) for row in rows], float)
    return np.array([_float(row, name) for row in rows]), slopes[:, 0], slopes[:, 1:]


def of_state(f: Callable[..., Any], x: Array) -> tuple[Array, Array]:
    """Values of f(x), as many as there are coordinates, and their derivatives."""
    values, _, by_x = value_and_slopes(lambda t, y: f(y), 0.0, x, "f", len(x))
    return values, by_x


def coordinates_of_map(f: Callable[..., Any], x: Array) -> Array:
    """Values of f(x) on plain numbers, as many as there are coordinates; not a number where its arithmetic fails."""
    rows = _rows(checked_call(f, "f", np.array(x, float)), "f", len(x))
    return np.full(len(x), np.nan) if rows is None else np.array([_float(row, "f") for row in rows])


def scalar_of(f: Callable[..., Any], t: float, y: Array, name: str = "f") -> float:
    """The one number f(t, y); not a number where its arithmetic fails."""
    rows = _rows(checked_call(f, name, float(t), np.array(y, float)), name, 1)
    return float("nan") if rows is None else _float(rows[0], name)


_UNDEFINED = object()
_NO_NUMBERS = (str, bytes, bool, np.bool_, Truth, dict, list, tuple, np.ndarray, complex)


def checked_call(f: Callable[..., Any], name: str, *given: Any) -> Any:
    """The value of a function; its exceptions become errors of ours. Undefined arithmetic is reported to `_rows`."""
    try:
        with np.errstate(all="ignore"):
            return f(*given)
    except StickslipError:
        raise
    except ArithmeticError:
        return _UNDEFINED
    except Exception as error:
        if isinstance(error, ValueError) and "domain error" in str(error):  # math.sqrt(-1.0)
            return _UNDEFINED
        mistake = f"{name} raised {type(error).__name__}: {error}" + (f" (y has {len(given[-1])})" if isinstance(error, IndexError) else "")
        why = f"{mistake}; {_PLAIN}" if isinstance(error, (TypeError, ValueError, AttributeError)) else mistake
        raise InputError("SwitchingFlow" if "[" in name else name, [why]) from error


def _rows(result: Any, name: str, count: int | None) -> list[Any] | None:
    """The numbers of an answer, one by one."""
    if result is _UNDEFINED:
        return None
    rows = [_unwrapped(row) for row in (result if isinstance(result, (tuple, list, np.ndarray)) and np.ndim(result) else [result])]
    wrong = [row for row in rows if row is None or isinstance(row, _NO_NUMBERS)]
    if wrong or (count is not None and len(rows) != count):
        allowed = "one number" if count == 1 else "a tuple of numbers" if count is None else f"a tuple of {count} numbers"
        what = f"{len(rows)} numbers" if not wrong else "a condition" if isinstance(wrong[0], (bool, np.bool_, Truth)) else f"{result!r}"
        raise InputError("SwitchingFlow" if "[" in name else name, [f"{name} gave {what}; allowed is {allowed}{_hint(result, count)}"])
    return rows


def _hint(result: Any, count: int | None) -> str:
    if result is None:
        return "; is its return missing?"
    return ", which falls through zero at the switch" if count == 1 else ", one for each coordinate"


def _unwrapped(row: Any) -> Any:
    """A number out of an array that holds nothing else."""
    return row.ravel()[0] if isinstance(row, np.ndarray) and row.size == 1 else row


def _float(row: Any, name: str) -> float:
    try:
        return float(getattr(row, "value", row))
    except (TypeError, ValueError) as error:
        raise InputError("SwitchingFlow" if "[" in name else name, [f"{name} gave {row!r}, which is not a number; {_PLAIN}"]) from error
