"""Curves of special points in the plane of two parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Ax
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.dynamics.continuation.two_parameters import Curve
from stickslip.show.figures.spacing import logarithmic
from stickslip.show.figures.special_kinds import marker_of, name_once
from stickslip.show.figures.style import COLOURS, INK, axes, drawing, labelled, legend_above, scaled

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_STAYS = 1e-6  # relative change of a parameter that counts as constant


@drawing
def special_curve(curves: Any, ax: Ax = None) -> Any:
    """Curves of special points in two parameters, with the points where they meet another border.

    Parameters
    ----------
    curves : Curve or list of Curve
        From `stickslip.dynamics.special_curve`, all in the same two parameters.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> rig = dict(tilt_deg=1.7, mu0=0.18, law="coulomb")
    >>> branch = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=3.6e-4, stop=3.8e-4, step=0.2, **rig)
    >>> ax = ss.plot.special_curve(ss.dynamics.special_curve(branch, branch.special[0], "mu0", stop=0.19, step=0.2))
    >>> ax.get_xlabel()
    'amplitude of the inner mass $A$ (µm)'
    """
    several = list(curves) if isinstance(curves, (list, tuple)) else [curves]
    if not several or any(not isinstance(curve, Curve) or curve.parameters != several[0].parameters for curve in several):
        raise InputError(
            "plot", [f"{curves!r}: allowed are curves in the same two parameters; type for example ss.dynamics.special_curve(...)"]
        )
    points = [curve.points for curve in several]
    across, up = several[0].parameters
    sides = {name: scaled([v for each in points for v in each[name].values], points[0][name].attrs["units"]) for name in (across, up)}
    ax = axes(ax, 2.4)
    kinds = list(dict.fromkeys(curve.kind for curve in several))
    labelled_kinds: set[str] = set()  # each kind has one colour and one line in the legend
    for curve, each in zip(several, points, strict=True):
        x, y = (each[name].values * sides[name][0] for name in (across, up))
        ax.plot(x, y, color=COLOURS[kinds.index(curve.kind) % len(COLOURS)], linewidth=1.1, label=name_once(curve.kind, labelled_kinds))
        for met in curve.special:
            at = [value * sides[name][0] for name, value in zip((across, up), met.values, strict=True)]
            ax.plot(*at, marker=marker_of(met.kind), linestyle="", color=INK, markersize=4, label=name_once(met.kind, labelled_kinds))
    for name, side in ((across, "x"), (up, "y")):
        getattr(ax, f"set_{side}label")(labelled(points[0][name], sides[name][1]))
        logarithmic(ax, side, points[0][name].values)
        _widened(ax, side, np.concatenate([each[name].values for each in points]) * sides[name][0])
    legend_above(ax)
    return ax


def _widened(ax: Axes, side: str, values: Array) -> None:
    """Widen the axis of a parameter that is constant along the curve, so that rounding errors do not fill the figure."""
    middle = float(np.median(values))
    if np.ptp(values) <= _STAYS * abs(middle):
        getattr(ax, f"set_{side}lim")(*sorted((0.9 * middle, 1.1 * middle)))
