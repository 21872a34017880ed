"""A column of a run as a figure can show it: no swing falls between two points."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

_PER_SWING = 12  # points that a swing of the mass on its contact needs: its crest is then met to (pi/12)^2 / 2, 3 % of it
_MOST = 400_000  # points that are looked at


def seen(run: Any, column: str, begin: float, end: float, points: int, pace: float) -> tuple[Any, Any]:
    """Times [s] and values of a column, so that what swings faster than there are points is drawn as a band.

    Where `points` instants are too few for swings of the angular frequency `pace`, the stretch between two of them gives its lowest and
    its highest value, in the order in which they come.

    Parameters
    ----------
    run : Trajectory
    column : str
        What is drawn, such as ``"x"``.
    begin, end : float
        From when to when [s].
    points : int
        Stretches that the figure can tell apart.
    pace : float
        The fastest angular frequency to be seen [rad/s].

    Returns
    -------
    t, values : array
        Of one length, from `points` + 1 to twice `points`.

    Examples
    --------
    >>> import stickslip as ss
    >>> mass = ss.ForcedOscillator(mass=1.0, stiffness=1e4, damping=0.0, force=0.0, omega=1.0, friction=ss.Viscous(0.0, 0.0))
    >>> run = ss.solve(mass, periods=1, start={"x": 1e-3}, method="dop853")
    >>> t, x = seen(run, "x", 0.0, 6.0, 50, pace=100.0)
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
