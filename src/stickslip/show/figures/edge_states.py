"""Figures of edge states: the track along the border of two basins, the edge state, and the attractors on either side."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Ax
from stickslip.basics.errors import InputError
from stickslip.dynamics.attractors.bifurcation_diagrams import state_attrs
from stickslip.dynamics.attractors.edge_states import EdgeState
from stickslip.show.figures.style import COLOURS, INK, axes, axis_label, drawing, legend_above, scaled

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@drawing
def edge_state(edge: Any, ax: Ax = None) -> Any:
    """An edge state with the track that led to it and the attractors on either side, on the strobe.

    The axes are the first two coordinates; a state with one coordinate is drawn over the drive periods of the track.

    Parameters
    ----------
    edge : EdgeState
        From `stickslip.dynamics.edge_state`.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> cubic = ss.SwitchingFlow.of_map(lambda y, n: (n.r * y[0] - y[0] ** 3 + n.h,), {"r": 1.5, "h": 0.05}, ("x",))
    >>> ss.plot.edge_state(ss.dynamics.edge_state(cubic, {"x": -1.0}, {"x": 1.0})).get_ylabel()
    'x on the strobe'
    """
    if not isinstance(edge, EdgeState):
        raise InputError("plot", [f"{type(edge).__name__} is no edge state; allowed is what ss.dynamics.edge_state gives"])
    attributes = [state_attrs(name, "on the strobe", edge.model) for name in edge.names]
    places = [i for i, name in enumerate(edge.names) if not name.startswith(("mode", "memory"))][:2]
    sizes = [scaled(edge.track[:, i], attributes[i]["units"]) for i in places]
    drawn = _over_two if len(places) > 1 else _over_periods
    ax = axes(ax, height=2.6)
    drawn(ax, edge, places, [factor for factor, _ in sizes])
    for label, i, (_, mark) in zip((ax.set_xlabel, ax.set_ylabel)[-len(places) :], places, sizes, strict=True):
        label(axis_label(attributes[i]["long_name"], attributes[i]["units"], mark))
    legend_above(ax, ncols=2, columnspacing=1.2)
    return ax


def _over_two(ax: Axes, edge: Any, places: list[int], sizes: list[float]) -> None:
    (i, j), (right, up) = places, sizes
    ax.plot(edge.track[:, i] * right, edge.track[:, j] * up, ".", color=INK, markersize=2.5, alpha=0.5, label="track along the border")
    for k, end in enumerate(edge.attractors):
        ax.plot(end[i] * right, end[j] * up, "o", color=COLOURS[k], markersize=5, label=("first", "second")[k] + " attractor")
    points = edge.strobe_points
    ax.plot(points[:, i] * right, points[:, j] * up, "x", color=INK, markersize=6, label=edge.kind)


def _over_periods(ax: Axes, edge: Any, places: list[int], sizes: list[float]) -> None:
    (i,), (up,) = places, sizes
    count = np.arange(len(edge.track))
    ax.plot(count, edge.track[:, i] * up, ".-", color=INK, markersize=2.5, linewidth=0.6, label="track along the border")
    for k, end in enumerate(edge.attractors):
        ax.axhline(end[i] * up, color=COLOURS[k], label=("first", "second")[k] + " attractor")
    ax.plot(count[-1:], edge.state[i] * up, "x", color=INK, markersize=6, label=edge.kind)
    ax.set_xlabel("drive period")
