"""Figures of a robot's dynamics along a parameter: bifurcation diagrams, basins, exponents, spectra."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.arguments import Ax, Grid
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, is_whole
from stickslip.dynamics.attractors.basins import Basins
from stickslip.dynamics.attractors.edge_states import EdgeState
from stickslip.dynamics.exponents.general_exponents import Lyapunov
from stickslip.show.figures.continuation import OBSERVABLES
from stickslip.show.figures.spacing import logarithmic
from stickslip.show.figures.style import (
    COLOURS,
    INK,
    UNSETTLED,
    UNSETTLED_MARK,
    axes,
    axis_label,
    dot_size,
    drawing,
    labelled,
    legend_above,
    scaled,
)

#: Extreme velocities of two motions are alike within this part of the largest.
_ALIKE = 1e-3
#: Colours of starts on no attractor.
_NO_ATTRACTOR = {"not settled": UNSETTLED, "runs away": "#F2F2F2", "not solved": "#D9D9D9"}


@drawing
def bifurcation(diagram: Grid, observable: str | None = None, ax: Ax = None) -> Any:
    """A brute-force bifurcation diagram; upward and downward sweeps side by side in two colours, so that hysteresis shows.

    Both sweeps are drawn over each other: the upward one with open rings, the downward one with dots inside them, so that where both have
    the same motion a ring has its dot, and where they differ either stands alone. Where the downward sweep is on the mirror image of the
    upward one, which a machine that is alike in both directions has beside every motion, its dots are squares of another colour: this is no
    hysteresis. It is seen from the mean velocity and the extreme velocities, which change their signs. Grey crosses are points of
    motions that have not settled; the legend has their share.

    Parameters
    ----------
    diagram : xarray.Dataset
        From `stickslip.bifurcation`.
    observable : str, optional
        "v", "z", "displacement", or "mean_velocity", "v_max", "v_min"; for several bodies "v.body" and so on. If not given, the
        velocity on the strobe (of the first body), or the first state of a flow.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> diagram = ss.bifurcation(ss.presets.piezo_rig, parameter="amplitude", values=[4e-4, 6e-4], settle=20, points=4, follow=False,
    ...                       tilt_deg=1.7, law="coulomb")
    >>> ss.plot.bifurcation(diagram, "mean_velocity").get_xlabel()
    'amplitude of the inner mass $A$ (µm)'
    """
    observable = observable or str(next(iter(getattr(diagram, "data_vars", ())), "v"))
    if "parameter" not in getattr(diagram, "attrs", {}) or observable not in diagram:
        columns = f": {', '.join(map(str, diagram))}" if "parameter" in getattr(diagram, "attrs", {}) else ""
        allowed = f"allowed is the Dataset of ss.bifurcation and a column of it{columns}"
        raise InputError("plot", [f"{type(diagram).__name__} without {observable!r}; {allowed}"])
    across, y = diagram[diagram.attrs["parameter"]], diagram[observable]
    unit = y.attrs.get("units", "1")
    (right, side), (up, mark) = scaled(across.values, across.attrs.get("units", "1")), scaled(y.values, unit)
    ax = axes(ax, height=2.6)
    size, several = dot_size(diagram.sizes[across.name]), diagram.sizes["direction"] > 1
    unsettled, twins = float((diagram.motion == "not settled").mean()), _mirror_twins(diagram)
    for i, direction in enumerate(diagram.direction.values):
        part, late = y.sel(direction=direction), diagram.motion.sel(direction=direction) == "not settled"
        x, values = across.broadcast_like(part).values * right, part.values * up
        still = late.broadcast_like(part).values
        style, twin = _sweep_style(i, size, several), twins.broadcast_like(part).values & (i == 1)
        ax.plot(x[~still & ~twin], values[~still & ~twin], **style, rasterized=True, zorder=2 + i)
        ax.plot([], [], **_sweep_style(i, 4.0, several), label=str(direction))
        if twin.any():
            ax.plot(x[twin], values[twin], **_TWIN | {"markersize": 0.8 * size}, rasterized=True, zorder=2 + i)
            ax.plot([], [], **_TWIN | {"markersize": 3.5}, label="down, mirror image of up")
        ax.plot(x[still], values[still], UNSETTLED_MARK, color=UNSETTLED, markersize=max(size, 2.0), markeredgewidth=0.5, zorder=5)
    if unsettled:
        ax.plot([], [], UNSETTLED_MARK, color=UNSETTLED, markersize=4, label=f"not settled, {100 * unsettled:.2g} %")
    logarithmic(ax, "x", np.sort(across.values) * right)
    ax.set_xlabel(axis_label(across.attrs.get("long_name", across.name), across.attrs.get("units", "1"), side))
    ax.set_ylabel(axis_label(OBSERVABLES.get(observable, y.attrs.get("long_name", observable)), unit, mark))
    legend_above(ax, ncols=2, handletextpad=0.2)
    return ax


_TWIN: dict[str, Any] = {"marker": "s", "linestyle": "", "markeredgewidth": 0, "color": COLOURS[2]}


def _mirror_twins(diagram: Any) -> Any:
    """Whether the downward sweep is on the mirror image of the upward one, which is another motion, at each value of the parameter."""
    needed = {"mean_velocity", "v_max", "v_min"}
    if diagram.sizes["direction"] < 2 or not needed <= set(diagram) or any(diagram[name].ndim > 2 for name in needed):
        return diagram.motion.isel(direction=0) == "no motion"
    up, down = ({name: diagram[name].isel(direction=k) for name in needed} for k in (0, 1))
    size = np.maximum(abs(up["v_max"]), abs(up["v_min"])) * _ALIKE
    mirrored = (
        (abs(up["mean_velocity"] + down["mean_velocity"]) < size)
        & (abs(up["v_max"] + down["v_min"]) < size)
        & (abs(up["v_min"] + down["v_max"]) < size)
    )
    return mirrored & ((abs(up["v_max"] - down["v_max"]) > size) | (abs(up["mean_velocity"] - down["mean_velocity"]) > size))


def _sweep_style(i: int, size: float, several: bool) -> dict[str, Any]:
    """Rings for the first of several sweeps and dots within them for the second; dots for a single one."""
    if several and i == 0:
        return {"marker": "o", "linestyle": "", "markersize": 1.6 * size, "fillstyle": "none", "markeredgewidth": 0.5, "color": COLOURS[i]}
    return {"marker": "o", "linestyle": "", "markersize": 0.7 * size if several else size, "markeredgewidth": 0, "color": COLOURS[i]}


@drawing
def basins(basins: Basins, ax: Ax = None, edges: Any = ()) -> Any:
    """The attractor of each initial state, over the first two axes of the grid that have several values.

    Parameters
    ----------
    basins : Basins
        From `stickslip.basins`.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.
    edges : EdgeState or list of them, optional
        From `stickslip.dynamics.edge_state`; their strobe points are drawn as crosses on the borders.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)
    >>> basins = ss.basins(robot, v=[-0.01, 0.0, 0.01], z=[0.0, 1e-7], settle=60)
    >>> ss.plot.basins(basins).get_xlabel()
    'velocity at the start (mm/s)'
    """
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    if not isinstance(basins, Basins):
        raise InputError("plot", [f"basins = {basins!r}; allowed is what ss.basins gives"])
    names = [str(d) for d in basins.map.attractor.dims if basins.map.sizes[d] > 1]
    if len(names) < 2:
        raise InputError("plot", ["a map needs two axes with several values; type for example ss.basins(robot, v=[...], z=[...])"])
    across, upward = names[:2]
    flat = basins.map.attractor.isel({d: 0 for d in basins.map.attractor.dims if d not in (across, upward)}).transpose(upward, across)
    (right, side), (up, mark) = (scaled(basins.map[n].values, basins.map[n].attrs.get("units", "1")) for n in (across, upward))
    ax = axes(ax, height=2.8)
    others = list(basins.others)
    codes = np.where(flat.values >= 0, flat.values + len(others) + 1, 0)
    words = basins.map.motion.isel({d: 0 for d in basins.map.attractor.dims if d not in (across, upward)}).transpose(upward, across).values
    for k, word in enumerate(others):
        codes = np.where((flat.values < 0) & (words == word), k + 1, codes)
    paints: list[Any] = [
        "#FFFFFF",
        *(_NO_ATTRACTOR[word] for word in others),
        *[_pale(COLOURS[k % 7]) for k in range(max(len(basins.attractors), 1))],
    ]
    norm = BoundaryNorm(np.arange(-0.5, len(paints) + 0.5), len(paints))
    extent = (*_edges(basins.map[across].values * right), *_edges(basins.map[upward].values * up))
    ax.imshow(codes, origin="lower", extent=extent, aspect="auto", cmap=ListedColormap(paints), norm=norm, interpolation="nearest")
    for k, a in enumerate(basins.attractors):
        if a.orbit is not None and set(names[:2]) <= set(a.orbit.names):
            x, y = (a.orbit.state[a.orbit.names.index(name)] * factor for name, factor in ((across, right), (upward, up)))
            ax.plot(x, y, "o", markersize=5, color=COLOURS[k % 7], markeredgecolor="white")
    motions = len(ax.lines)
    for edge in _edges_on(edges, names[:2]):
        points = edge.strobe_points[:, [edge.names.index(across), edge.names.index(upward)]]
        ax.plot(points[:, 0] * right, points[:, 1] * up, "x", markersize=5, color=INK)
    ax.set(xlabel=labelled(basins.map[across], side), ylabel=labelled(basins.map[upward], mark))
    handles: list[Any] = [Patch(color=paints[k + 1 + len(others)], label=_text(a)) for k, a in enumerate(basins.attractors)]
    handles += [
        Patch(facecolor=_NO_ATTRACTOR[word], edgecolor=INK, linewidth=0.3, label=f"{word}, {100 * share:.2g} %")
        for word, (share, _) in basins.others.items()
    ]
    for count, marker, label in ((motions, "o", "strobe point of the motion"), (len(ax.lines) - motions, "x", "edge state")):
        handles += [Line2D([], [], marker=marker, linestyle="", color=INK, markersize=4, label=label)] if count else []
    legend_above(ax, handles=handles, ncols=2, columnspacing=1.2)
    return ax


def _edges_on(edges: Any, names: list[str]) -> list[Any]:
    """Draw edge states that have the coordinates of a map."""
    many = list(edges) if isinstance(edges, (list, tuple)) else [edges]
    if not all(isinstance(edge, EdgeState) and set(names) <= set(edge.names) for edge in many):
        allowed = f"allowed are edge states with {' and '.join(names)}; type edges=[ss.dynamics.edge_state(...)]"
        raise InputError("plot", [f"edges = {edges!r}; {allowed}"])
    return many


def _text(attractor: Any) -> str:
    """The legend entry of an attractor: its mean velocity, or its period if it has no net displacement, and its share."""
    kind = f"period {attractor.period}" if attractor.kind == "periodic" else attractor.kind
    factor, unit = (1e3, "mm/s") if attractor.unit == "m/s" else (1.0, attractor.unit)
    way = f"$V$ = {attractor.mean_velocity * factor:.3g} {unit}".rstrip() if np.isfinite(attractor.mean_velocity) else kind
    named = way if attractor.kind == "periodic" or way == kind else f"{way}, {kind}"
    return f"{named}, {100 * attractor.share:.0f} %"


def _pale(colour: str) -> tuple[float, ...]:
    """A colour halfway to white."""
    return tuple(0.45 * int(colour[i : i + 2], 16) / 255 + 0.55 for i in (1, 3, 5))


def _edges(values: Array) -> tuple[float, float]:
    """The outer edges of cells around evenly spaced values."""
    half = 0.5 * (values[-1] - values[0]) / max(len(values) - 1, 1)
    return float(values[0] - half), float(values[-1] + half)


@drawing
def convergence(exponents: Lyapunov, ax: Ax = None, count: int = 1) -> Any:
    """Convergence of Lyapunov exponents, with a band of three final standard errors.

    Parameters
    ----------
    exponents : Lyapunov
        From `stickslip.lyapunov` and its like.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.
    count : int
        Number of exponents, from the largest.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> exponents = ss.lyapunov(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb"), periods=50)
    >>> ss.plot.convergence(exponents).get_ylabel()
    'exponent per drive period'
    """
    if not isinstance(exponents, Lyapunov):
        raise InputError("plot", [f"{exponents!r}; allowed is what ss.lyapunov gives"])
    if not is_whole(count) or not 1 <= count <= len(exponents.spectrum):
        raise InputError("plot", [f"count = {count!r}; allowed is a whole number from 1 to {len(exponents.spectrum)}; type count=1"])
    ax = axes(ax)
    ax.axhline(0.0, color=INK, linewidth=0.5)
    for i in range(min(count, len(exponents.spectrum))):
        end, error = exponents.spectrum[i], exponents.errors[i]
        if not np.isfinite(end):
            continue
        ax.axhspan(end - 3 * error, end + 3 * error, color=COLOURS[i % 7], alpha=0.15, linewidth=0)
        name = f"{end:.4g} ± {error:.1g} (band: three errors)"
        ax.plot(exponents.record[:, 0], exponents.record[:, 1 + i], color=COLOURS[i % 7], label=name)
    ax.set_xlim(0, exponents.record[-1, 0])
    ax.set(xlabel=f"{exponents.unit}s averaged over", ylabel=f"exponent per {exponents.unit}")
    if ax.get_legend_handles_labels()[0]:
        legend_above(ax, ncols=3)
    else:
        ax.set_yticks([])
        ax.text(0.5, 0.6, "−∞: perturbations vanish at once", transform=ax.transAxes, ha="center")
    return ax


@drawing
def spectrum(lines: Grid, ax: Ax = None) -> Any:
    """The line spectrum of a motion over frequency / drive frequency; harmonics of the drive are marked differently from other lines.

    Parameters
    ----------
    lines : xarray.Dataset
        From `stickslip.dynamics.spectrum`.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), periods=20)
    >>> ss.plot.spectrum(ss.dynamics.spectrum(run)).get_xlabel()
    'frequency / frequency of the drive'
    """
    if "amplitude" not in getattr(lines, "data_vars", {}):
        raise InputError("plot", [f"{type(lines).__name__} without an amplitude; allowed is the Dataset of ss.dynamics.spectrum"])
    for dim in set(lines.amplitude.dims) - {"order"}:
        one = lines[dim].values.tolist()[0]
        raise InputError("plot", [f"the spectrum has the dimension {dim}; allowed is one; type ss.plot.spectrum(lines.sel({dim}={one!r}))"])
    ax, of = axes(ax), lines.attrs.get("of", "drive")
    floor = float(lines.amplitude.max()) * 1e-6
    for whole, colour, name in ((True, COLOURS[0], f"harmonics of the {of}"), (False, COLOURS[1], "between")):
        shown = lines.amplitude > floor if floor else lines.amplitude == 0.0  # for a quantity without motion
        part = lines.where((lines.harmonic == whole) & shown, drop=True)
        if part.order.size:
            ax.vlines(part.order, floor, part.amplitude, color=colour, linewidth=1.0)
            ax.plot(part.order, part.amplitude, "o", markersize=2, color=colour, label=name)
    if floor:
        ax.set_yscale("log")
        ax.set_ylim(floor, None)
    ax.set_xlabel(f"frequency / frequency of the {of}")
    ax.set_ylabel(axis_label(f"amplitude of ${lines.attrs.get('column', 'v')}$", lines.amplitude.attrs.get("units", "1")))
    legend_above(ax, ncols=2)
    return ax
