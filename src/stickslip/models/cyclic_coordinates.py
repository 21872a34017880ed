"""Cyclic coordinates of a switching flow: what drifts while the motion repeats, such as a displacement or an angle modulo a turn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import Problems, did_you_mean
from stickslip.basics.fields import floats

_TYPE = 'type cyclic=("x",), or cyclic={"angle": 2 * np.pi} where the equations repeat after a turn'


@dataclass(frozen=True)
class CyclicCoordinates:
    """Which states of a flow are cyclic, by their places, and after which length the equations repeat.

    Parameters
    ----------
    names : tuple of str
    places : tuple of int
    lengths : tuple of float
        Infinite where the equations do not depend on the coordinate at all.

    Examples
    --------
    >>> c = CyclicCoordinates(("angle",), (0,), (1.0,))
    >>> c.wrapped([[0.75, 5.0]]).tolist(), c.difference([0.9, 5.0], [0.1, 5.0]).round(12).tolist()
    ([[-0.25, 5.0]], [-0.2, 0.0])
    """

    names: tuple[str, ...] = ()
    places: tuple[int, ...] = ()
    lengths: tuple[float, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.names)

    @property
    def free(self) -> Array:
        """The places of those on which no equation depends: a shift of them is no other motion."""
        return np.array([index for index, length in zip(self.places, self.lengths, strict=True) if not np.isfinite(length)], int)

    def wrapped(self, states: Any) -> Array:
        """States (..., state) with the cyclic coordinates brought back: to zero, or to within half a length of it."""
        states = np.array(states, float)
        for index, length in zip(self.places, self.lengths, strict=True):
            states[..., index] = states[..., index] - length * np.round(states[..., index] / length) if np.isfinite(length) else 0.0
        return states

    def difference(self, a: Any, b: Any) -> Array:
        """One state less another, apart from the drift of cyclic coordinates."""
        return self.wrapped(np.asarray(a, float) - np.asarray(b, float))

    def without(self, M: Array) -> Array:
        """Derivatives of states by states (..., state, state) without the shifts that are no other motion."""
        kept = np.delete(np.arange(M.shape[-1]), self.free)
        return M[..., kept[:, None], kept]

    def embedded(self, points: Array, scales: Array) -> tuple[Array, Array]:
        """States (..., state) and their scales in numbers that do not jump where an angle begins anew: a point on a circle.

        Examples
        --------
        >>> points, scales = CyclicCoordinates(("angle",), (0,), (1.0,)).embedded(np.array([[0.5, 5.0], [-0.5, 5.0]]), np.ones(2))
        >>> np.allclose(points[0], points[1]), len(scales)
        (True, 3)
        """
        points = self.wrapped(points)
        for index, length in zip(self.places, self.lengths, strict=True):
            if np.isfinite(length):
                radius, angle = length / (2.0 * np.pi), points[..., index] * (2.0 * np.pi / length)
                points[..., index] = radius * np.cos(angle)
                points, scales = np.concatenate([points, radius * np.sin(angle)[..., None]], axis=-1), np.append(scales, scales[index])
        return points, scales


def checked_cyclic(problems: Problems, given: Any, states: Sequence[str] | None, numbers: Mapping[str, Any]) -> dict[str, Any]:
    """What a user said of cyclic coordinates: name -> None, a length, or a function of the numbers; problems for what is neither."""
    if given is None or given == {}:
        return {}
    named = {given: None} if isinstance(given, str) else given
    named = dict.fromkeys(named) if isinstance(named, (tuple, list)) and all(isinstance(name, str) for name in named) else named
    if not isinstance(named, Mapping):
        problems.add(f"cyclic = {given!r}; allowed are names of states, or a dict of the lengths after which the equations repeat; {_TYPE}")
        return {}
    if states is None:
        problems.add(f"cyclic = {given!r}, but the states of the flow have no names; type states=('x', 'v')")
        return {}
    for name, length in named.items():
        if name not in states:
            problems.add(f"cyclic has {name!r}, which is not a state; {did_you_mean(str(name), states)}")
        elif length is not None and not problems.mistakes:
            _check_length(problems, name, length, numbers)
    return dict(named)


def _check_length(problems: Problems, name: str, given: Any, numbers: Mapping[str, Any]) -> None:
    try:
        length = floats(given(SimpleNamespace(**numbers)) if callable(given) else given)
    except Exception as error:
        allowed = "allowed is a function of the numbers; type for example lambda n: n.wavelength"
        problems.add(f"cyclic[{name!r}] raised {type(error).__name__}: {error}; {allowed}")
        return
    if not length.size or not np.all(np.isfinite(length) & (length > 0)) or (length.ndim and np.ptp(length) > 0.0):
        allowed = "a positive length, the same for all cases, a function of the numbers that returns it, or None"
        problems.add(f"cyclic[{name!r}] = {given!r}; allowed is {allowed}; {_TYPE}")


def lengths_of(cyclic: Mapping[str, Any], states: Sequence[str] | None, numbers: Mapping[str, Any]) -> CyclicCoordinates:
    """The cyclic coordinates of a flow with these numbers."""
    given = SimpleNamespace(**numbers)
    known = [length(given) if callable(length) else length for length in cyclic.values()]
    lengths = tuple(np.inf if length is None else float(np.ravel(floats(length))[0]) for length in known)
    return CyclicCoordinates(tuple(cyclic), tuple(list(states or ()).index(name) for name in cyclic), lengths)
