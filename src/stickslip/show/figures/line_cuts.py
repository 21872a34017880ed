"""Cuts through a map: the mean velocity along one axis, and the motion types below it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Ax, Grid
from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import InputError
from stickslip.basics.fields import masked_in
from stickslip.results.steadiness import STEADINESS, UNSETTLED
from stickslip.show.figures.maps import DARK, TYPE_COLOURS, plain_label, scaled_axis
from stickslip.show.figures.spacing import logarithmic
from stickslip.show.figures.style import COLOURS, DASHES, INK, UNSETTLED as UNSETTLED_COLOUR, UNSETTLED_MARK, axes, drawing, prefix
from stickslip.studies.result_columns import is_of_cases

if TYPE_CHECKING:
    import xarray as xr


@drawing
def line_cut(grid: Grid, along: str, at: dict[str, Any] | None = None, lines: Sequence[float] | None = None, ax: Ax = None) -> Any:
    """The mean velocity along one axis, for some values of the other; below it the motion types, a strip for each line.

    Parameters
    ----------
    grid : Dataset
        From `sweep` or `map`. A dimension ``way`` (see ``continue_along``) is drawn as a solid and a dashed line.
    along : str
        The horizontal axis.
    at : dict, optional
        Fixed values of other axes (the nearest grid values are used).
    lines : sequence of float, optional
        Values of the remaining axis; by default up to three.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> grid = ss.sweep(ss.presets.piezo_rig, amplitude=[3e-4, 4e-4, 5e-4, 6e-4], tilt_deg=[1.7, 2.7, 3.7], law="coulomb")
    >>> len(ss.plot.line_cut(grid, "amplitude", lines=[1.7, 3.7]).get_legend().get_texts())
    2
    """
    part = _chosen(grid, along, at)
    rest = [str(d) for d in part["mean_velocity"].dims if d not in (along, "way")]
    values = _values(part, rest, lines)
    axis = scaled_axis(part, along)
    curves = [part.sel({rest[0]: v}, method="nearest") if rest else part for v in values]
    unitless = part["mean_velocity"].attrs.get("units") == "1"
    factor, unit = (1.0, "") if unitless else prefix(*(c["mean_velocity"].fillna(0.0).values for c in curves))
    ax = axes(ax, 2.2)
    ax.axhline(0.0, color=INK, linewidth=0.5, zorder=1)
    late = False
    for i, curve in enumerate(curves):
        label = f"{float(curve[rest[0]]):.4g}" if rest else None
        for j, way in enumerate([curve.isel(way=k) for k in range(2)] if "way" in curve.dims else [curve]):
            dash = {"linestyle": DASHES[i % 7]} if "way" not in curve.dims else {"linestyle": ("-", (0, (3, 2)))[j]}
            name = " ".join(w for w in (label, str(way["way"].item()) if "way" in curve.dims else None) if w)
            V = way["mean_velocity"].values * factor
            ax.plot(axis.values, V, color=COLOURS[i % 7], label=name or None, zorder=3 + i, **dash)
            late |= _mark_unsettled(ax, way, axis.values, V)
    _strips(ax, curves, axis.values)
    ax.set_xlim(axis.values.min(), axis.values.max())
    logarithmic(ax, "x", np.sort(axis.values))
    ax.set(xlabel=axis.label, ylabel="mean velocity $V$" if unitless else f"mean velocity $V$ ({unit}m/s)")
    if len(curves) > 1 or "way" in part.dims or late:
        title = plain_label(part, rest[0]) if rest else None
        ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=5, title=title, title_fontsize=7, columnspacing=1.2, handlelength=2)
    return ax


def _mark_unsettled(ax: Any, curve: Any, x: ArrayLike, V: Array) -> bool:
    """Mark the points whose mean velocity has not settled; False if there are none. They have one entry in the legend."""
    if "steadiness" not in curve:
        return False
    late = np.asarray(curve["steadiness"].values) == UNSETTLED
    first = STEADINESS[UNSETTLED] not in ax.get_legend_handles_labels()[1]
    style = {"linestyle": "", "marker": UNSETTLED_MARK, "markersize": 4, "color": UNSETTLED_COLOUR, "zorder": 12}
    if late.any():
        ax.plot(np.asarray(x)[late], V[late], label=STEADINESS[UNSETTLED] if first else None, **style)
    return bool(late.any())


def _chosen(grid: xr.Dataset, along: str, at: dict[str, Any] | None) -> Any:
    dims = [str(d) for d in grid["mean_velocity"].dims]
    if along not in dims:
        raise InputError("line_cut", [f"along = {along!r} is not an axis of the dataset; it has {', '.join(dims)}"])
    unknown = [name for name in at or {} if name not in dims]
    if unknown:
        raise InputError("line_cut", [f"at has {', '.join(unknown)}; allowed are {', '.join(d for d in dims if d != along)}"])
    for name, value in (at or {}).items():
        grid = grid.sel({name: value}, method=None if isinstance(value, str) else "nearest")
    left = [d for d in grid["mean_velocity"].dims if d not in (along, "way")]
    if len(left) > 1:
        raise InputError("line_cut", [f"the axes {', '.join(map(str, left))} are left; allowed is one; choose the others with at={{...}}"])
    return grid


def _values(part: Any, rest: list[str], lines: Sequence[float] | None) -> list[Any]:
    if not rest:
        return [None]
    if lines is not None:
        if masked_in(lines):
            raise InputError("line_cut", ["lines has masked values; leave them out, type lines=array.compressed()"])
        return list(lines)
    known = part[rest[0]].values
    return [known[i] for i in np.unique(np.linspace(0, len(known) - 1, min(3, len(known))).round().astype(int))]


def _strips(ax: Any, curves: list[Any], x: ArrayLike) -> None:
    """Draw the motion types along the axis: a strip below the curves for each curve, with the curve's line style at its left end."""
    height = 0.06
    if not all(is_of_cases(curve, "motion_type") for curve in curves):  # with several contacts, each has its own type
        return
    for i, curve in enumerate(curves):
        top = height * (len(curves) - i) - 0.01
        types = np.asarray((curve.isel(way=0) if "way" in curve.dims else curve)["motion_type"].values)
        _strip(ax, types, x, top - height + 0.015, top)
        if len(curves) > 1:
            style = {"color": COLOURS[i % 7], "linestyle": DASHES[i % 7] if "way" not in curve.dims else "-", "linewidth": 1.1}
            ax.plot([-0.05, -0.01], [top - 0.5 * height] * 2, transform=ax.transAxes, clip_on=False, **style)
    low, high = ax.get_ylim()
    share = height * len(curves) + 0.01
    ax.set_ylim(low - share / (1 - share) * (high - low), high)
    if len(curves) > 1:
        ax.tick_params(axis="y", pad=2)
        ax.set_yticks([t for t in ax.get_yticks() if low <= t <= high])


def _strip(ax: Any, types: Any, x: ArrayLike, bottom: float, top: float) -> None:
    order = np.argsort(x)
    x, types = np.asarray(x)[order], types[order]
    edges = np.concatenate([x[:1], 0.5 * (x[1:] + x[:-1]), x[-1:]])
    starts = np.flatnonzero(np.concatenate([[True], types[1:] != types[:-1]]))
    span = edges[-1] - edges[0]
    for begin, end in zip(starts, [*starts[1:], len(types)], strict=True):
        name = str(types[begin])
        ax.axvspan(edges[begin], edges[end], bottom, top, facecolor=TYPE_COLOURS.get(name, "white"), edgecolor="none", zorder=2)
        if edges[end] - edges[begin] > 0.02 * span * max(len(name), 2):
            words = {"fontsize": 5.5, "color": "white" if name in DARK else INK, "transform": ax.get_xaxis_transform()}
            ax.text(0.5 * (edges[begin] + edges[end]), 0.5 * (bottom + top), name, ha="center", va="center_baseline", **words)
