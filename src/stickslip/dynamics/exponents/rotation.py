"""Rotation numbers of motions on a circle or on the closed curve that a torus leaves on the strobe."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np

from stickslip.basics.arguments import Numbers, explains_arguments
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.fields import floats
from stickslip.basics.frozen_arrays import sealed
from stickslip.dynamics.exponents.closed_curves import smooth_weights, winding_number
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates, strobe_orbit

_LEAST = 100
_TURNS, _COORDINATES = 2000, 4  # strobe points of a motion, and among how many numbers of its state two are looked for
_ROUGH = 0.25  # of the radius: neighbours on a closed curve differ by less, as seen from inside


@sealed
class Rotation:
    """A rotation number.

    Parameters
    ----------
    value : float
        Mean advance in turns per step: per drive period of strobe points, per iteration of a map. Of points in a plane between 0 and 1, as
        seen counter-clockwise: whole turns in between cannot be seen.
    error : float
        By how much it may be wrong: what two halves of the points differ by.
    points : int
        From how many points.

    Examples
    --------
    >>> Rotation(0.25, 1e-9, 1000)
    <Rotation: 0.2500000000 ± 1e-09 turns per step, from 1000 points>
    """

    value: float
    error: float
    points: int

    @property
    def rounded(self) -> str:
        """The value to the digits that are known, with its error."""
        places = int(np.clip(1 - np.floor(np.log10(self.error)), 1, 15)) if self.error > 0 else 15
        return f"{self.value:.{places}f} ± {self.error:.0e}"

    def __repr__(self) -> str:
        return f"<Rotation: {self.rounded} turns per step, from {self.points} points>"


@explains_arguments
def rotation_number(points: Numbers) -> Rotation:
    """The rotation number of a motion on a circle or on a closed curve, by a weighted mean that converges fast.

    The advances are weighted by exp(-1/(t(1 - t))), t from 0 to 1 along the points. On a smooth torus with an irrational rotation the error
    falls faster than any power of the number of points (Das, Saiki, Sander and Yorke 2017), where that of the plain mean falls as 1/n.

    Parameters
    ----------
    points : array (n,) or (n, 2)
        At least 100: the angle in turns that goes on growing (the lift of a circle map), or points in a plane on a closed curve around
        their centre, such as two numbers of the strobe state.

    Returns
    -------
    Rotation
        `value` in turns per step, `error`.

    Raises
    ------
    InputError
        Where the points in a plane are not on one closed curve around their centre: a periodic motion, a chaotic one, a torus of three
        frequencies, or a curve that is folded as seen in these two numbers.

    References
    ----------
    Das, Saiki, Sander, Yorke, *Quantitative quasiperiodicity*, Nonlinearity 30 (2017) 4111.

    Examples
    --------
    >>> import stickslip as ss
    >>> angles = [0.1]
    >>> for _ in range(1000):
    ...     angles.append(angles[-1] + 0.3 + 0.05 * np.sin(2 * np.pi * angles[-1]))
    >>> ss.dynamics.rotation_number(angles).rounded
    '0.29713871144207 ± 3e-13'
    """
    x = _checked(points)
    if x.ndim == 1:
        return _mean_advance(np.diff(x), float(np.max(abs(x))))
    rotation = rotation_on_curve(x)
    if rotation is None:
        why = "the points are not on one closed curve around their centre"
        allowed = "allowed are points on a torus of two frequencies, seen in a plane where the curve is not folded"
        raise InputError("rotation_number", [f"{why}; {allowed}; type ss.verdict(model) to see what motion it is"])
    return rotation


def rotation_on_curve(points: Array) -> Rotation | None:
    """The rotation number of points (n, 2) on a closed curve around their centre; None where they are not on one."""
    centred = points - 0.5 * (points.max(axis=0) + points.min(axis=0))
    sizes = np.ptp(centred, axis=0)
    if not np.all(sizes > 0):
        return None
    z = (centred / sizes) @ np.array([1.0, 1.0j])
    order = np.argsort(np.angle(z))
    radius, angle = abs(z)[order], np.angle(z)[order]
    gaps = np.diff(np.append(angle, angle[0] + 2 * np.pi))
    rough = abs(np.diff(np.append(radius, radius[0])))
    if radius.min() < 1e-3 * radius.max() or gaps.max() > 1.0 or np.any(rough > _ROUGH * radius):
        return None
    turns = np.diff(np.angle(z)) / (2 * np.pi) % 1.0
    return _mean_advance(_unwrapped(turns))


def rotation_of_strobe(model: Model, state: Array, rtol: float, at: Coordinates | None = None) -> tuple[Rotation | None, str, bool]:
    """The rotation number of strobe points in the first two numbers of the state that show one closed curve, and a sentence on it.

    Last whether they wind round one at all, folded as it may be.
    """
    at = coordinates(model) if at is None else at
    points = strobe_orbit(model, state[None, :], _TURNS, rtol, at)[0][:, 0]
    for i, j in combinations(at.free[:_COORDINATES].tolist(), 2):
        rotation = rotation_on_curve(points[:, [i, j]])
        if rotation is not None:
            sentence = f"its strobe points lie on one closed curve in {at.names[i]} and {at.names[j]}: a torus of two frequencies"
            return rotation, f"{sentence}, rotation number {rotation.rounded} turns per drive period, up to whole turns and its sense", True
    turns = winding_number(points[:, at.free] / at.scales[at.free])
    if turns is not None:
        return None, f"its strobe points wind round one closed curve, which is folded, {turns:.7g} turns per drive period", True
    return None, "its strobe points wind round no closed curve: it has more than two frequencies, or has not settled", False


def _unwrapped(turns: Array) -> Array:
    """Advances of a circle map that lie within one turn of each other: cut where none of them is."""
    ordered = np.sort(turns)
    gaps = np.diff(np.append(ordered, ordered[0] + 1.0))
    k = int(np.argmax(gaps))
    first = ordered[(k + 1) % len(ordered)]
    unwrapped = first + (turns - first) % 1.0
    return unwrapped - np.floor(np.mean(unwrapped))


def _mean_advance(turns: Array, size: float = 1.0) -> Rotation:
    """The weighted mean of advances between angles of a size [turns], whose last digit is not known."""
    half = len(turns) // 2
    value, early, late = (_weighted(part) for part in (turns, turns[:half], turns[half:]))
    return Rotation(value, max(abs(value - early), abs(value - late), 4 * np.finfo(float).eps * max(size, 1.0)), len(turns) + 1)


def _weighted(turns: Array) -> float:
    return float(np.sum(smooth_weights(len(turns)) * turns))


def _checked(points: Any) -> Array:
    problems = Problems("rotation_number")
    x = floats(points)
    if x.ndim not in (1, 2) or (x.ndim == 2 and x.shape[1] != 2) or len(x) < _LEAST or not np.isfinite(x).all():
        allowed = f"allowed are {_LEAST} or more finite angles in a row, or as many points (n, 2) in a plane"
        problems.add(f"points has shape {x.shape}; {allowed}")
    problems.check()
    return x
