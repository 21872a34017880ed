"""Whether the equations of a switching flow allow what is said of its cyclic coordinates: asked of its functions, and of their trace."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.engine.flow_as_written import points_of, single_plain, values_of_functions
from stickslip.engine.values import needed_by

if TYPE_CHECKING:
    from stickslip.engine.flow_system import TracedFlow
    from stickslip.models.switching_flow import SwitchingFlow


_SHIFTS = (0.37, -5.3, 211.0)  # of a state's scale, and whole lengths: where the functions are asked again
_TURNS = (1.0, -2.0, 7.0)
_SAME = 1e-9  # of what a function gives anywhere
_EXACT = 1e-12  # of a shift: how far a reset carries it along


def check_cyclic(flow: SwitchingFlow, n: int, traced: TracedFlow | None = None) -> None:
    """`InputError` where a function of a flow of n states depends on a coordinate that is called cyclic.

    Examples
    --------
    >>> import stickslip as ss
    >>> pendulum = ss.SwitchingFlow(lambda t, y: (y[1], -ss.maths.sin(y[0])), states=("a", "w"), cyclic={"a": 2 * np.pi})
    >>> check_cyclic(pendulum, 2)
    """
    cyclic = flow.drifts
    for index, length in zip(cyclic.places, cyclic.lengths, strict=True):
        depends = _shifted(flow, n, index, length)
        if depends is None and not np.isfinite(length) and traced is not None:
            depends = _traced(traced, index)
        if depends is not None:
            raise InputError("SwitchingFlow", [_said(cyclic.names[cyclic.places.index(index)], length, depends)])


def _said(name: str, length: float, function: str) -> str:
    if np.isfinite(length):
        mistake = f"cyclic: {function} does not repeat when {name!r} grows by {length:.9g}"
        return f"{mistake}; allowed is the length after which all functions of the flow repeat; type another, or leave {name!r} out"
    mistake = f"cyclic: {function} depends on {name!r}"
    allowed = "allowed are coordinates on which nothing depends, and those after a length of which all repeats"
    how = f"type cyclic={{{name!r}: 2 * np.pi}} for an angle, take distances such as x2 - x1 as states, or leave {name!r} out"
    return f"{mistake}; {allowed}; {how}"


def _traced(traced: TracedFlow, index: int) -> str | None:
    """The function of a flow in whose trace a state stands; None if there is none. What a reset makes of the state itself may have it."""
    state = traced.y[index]
    for name, values in traced.expressions.items():
        others = [value for k, value in enumerate(values) if not (name.endswith(".reset") and k == index)]
        if any(node is state for node in needed_by(others)):
            return name
    return None


def _shifted(flow: SwitchingFlow, n: int, index: int, length: float) -> str | None:
    """The function that gives something else at states with a shifted coordinate; None if there is none."""
    plain, points = single_plain(flow), points_of(flow, n)
    free = not np.isfinite(length)
    scale = float((flow.scales or (1.0,) * n)[index])
    asked = [values_of_functions(plain, t, y) for t, y in points]
    for shift in np.array(_SHIFTS) * scale if free else np.array(_TURNS) * length:
        for (t, y), here in zip(points, asked, strict=True):
            moved = [value + shift if i == index else value for i, value in enumerate(y)]
            there = values_of_functions(plain, t, moved)
            for name in here:
                sizes = np.max([np.abs(_floats(each[name])) for each in asked if _alike(each[name], here[name])], axis=0, initial=0.0)
                if not _same(name, here[name], there[name], index, shift, length, _SAME * sizes):
                    return name
    return None


def _alike(a: Any, b: Any) -> bool:
    return isinstance(a, tuple) and isinstance(b, tuple) and len(a) == len(b)


def _floats(values: Any) -> Any:
    """What a function gave as numbers; modes are none."""
    return np.array([value if isinstance(value, float) else 0.0 for value in values])


def _same(name: str, here: Any, there: Any, index: int, shift: float, length: float, near: Any) -> bool:
    """Whether a function gives the same at a shifted state; of a reset the state itself is carried along, or brought back by lengths."""
    if not _alike(here, there):
        return bool(here == there)
    if name.endswith(".to"):
        return bool(here == there)
    a, b = _floats(here), _floats(there)
    near = np.where(np.isfinite(length), near + _SAME * abs(a), 0.0) + 0.0 * a
    if name.endswith(".reset"):
        b[index] -= shift
        near[index] += _EXACT * (abs(a[index]) + abs(shift))
        if np.isfinite(length):
            b[index] += length * np.round((a[index] - b[index]) / length)
    return bool(np.all(abs(a - b) <= near))
