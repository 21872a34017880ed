"""Reduction of a column of a run for a figure: no oscillation is lost between two points."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


_PER_SWING = 12  # points per oscillation of the mass on its contact: the crest is then met to (pi/12)^2 / 2, about 3 %
_MOST = 400_000  # points that are evaluated


def envelope(run: Trajectory, column: str, begin: float, end: float, points: int, pace: float) -> tuple[Any, Any]:
    """Times [s] and values of a column; oscillations too fast for the number of points appear as a band.

    If `points` instants are too few for oscillations of the angular frequency `pace`, each interval gives its lowest and its highest
    value, in the order in which they occur.

    Parameters
    ----------
    run : Trajectory
    column : str
        Name of the column, such as ``"x"``.
    begin, end : float
        Time span [s].
    points : int
        Number of intervals that the figure can resolve.
    pace : float
        The highest angular frequency to be resolved [rad/s].

    Returns
    -------
    t, values : array
        Of equal length, `points` + 1 or twice `points`.

    Examples
    --------
    >>> import stickslip as ss
    >>> mass = ss.ForcedOscillator(mass=1.0, stiffness=1e4, damping=0.0, force=0.0, omega=1.0, friction=ss.Viscous(0.0, 0.0))
    >>> run = ss.solve(mass, periods=1, start={"x": 1e-3}, method="dop853")
    >>> t, x = envelope(run, "x", 0.0, 6.0, 50, pace=100.0)
    >>> bool(max(x) > 0.97e-3), bool(min(x) < -0.97e-3)
    (True, True)
    """
    across = math.ceil(_PER_SWING * pace * (end - begin) / (2.0 * math.pi) / points)
    if across <= 1:
        t = np.linspace(begin, end, points + 1)
        return t, run.at(t)[column]
    across = max(min(across, _MOST // points), 2)
    t = begin + (end - begin) * (np.arange(points * across) / (points * across - 1))
    values = run.at(t)[column].reshape(points, across)
    both = np.sort(np.stack([values.argmin(axis=1), values.argmax(axis=1)], axis=1), axis=1)
    return t.reshape(points, across)[np.arange(points)[:, None], both].ravel(), np.take_along_axis(values, both, axis=1).ravel()
