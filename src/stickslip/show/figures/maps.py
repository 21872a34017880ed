"""Figures of maps: motion types with the exact borders over them, and mean velocity with its optimum."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stickslip.analysis.closed_form import coulomb_type
from stickslip.analysis.coulomb_borders import coulomb_borders, plane_of
from stickslip.basics.arguments import Ax, Grid
from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import InputError
from stickslip.results.steadiness import STEADINESS, UNSETTLED
from stickslip.show.figures.spacing import cells, edges, logarithmic, places
from stickslip.show.figures.style import INK, axes, drawing, legend_above, prefix, symbols
from stickslip.studies.result_columns import column_of, is_of_cases

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


#: Fill colours of the motion types: greys without sliding, then alternately light and dark, so that neighbours differ in grey too.
TYPE_COLOURS: dict[str, str] = {
    "rest": "#F1F1F1", "presliding": "#C6CBD1", "II": "#BCDFF4", "I": "#2F7FB8", "III": "#F0B03C", "IV": "#D2691E", "other": "#B279A2",
    "unsolved": "#FFFFFF",
}  # fmt: skip
#: Types whose names are written in white.
DARK = ("I", "IV", "other")
_PREFIXED = ("m", "V", "N", "s", "m/s", "N/m")  # units that take an SI prefix
_SMALLEST = 0.045  # fraction of a side: half-width of a region that has room for its name
_FINE = 240  # grid points along each side for the analysis of regions
_SPECK = (4, 0.001)  # cells, fraction of the map: smaller regions have no border drawn around them
_ROUNDED = (0.8, 0.008)  # cells, fraction of a side: the larger of the two is the radius over which corners of cells are rounded
_OWN = 0.99  # fraction of the cells that must have the types of Coulomb friction if its borders are drawn; the rest may lie on a border
_HATCH = "//////"  # over cells whose mean velocity has not settled
_NO_MOTION = 1e-7  # of the largest velocity: if no mean velocity is larger, it is the tolerance that is drawn
_BOX: dict[str, Any] = {"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "none", "alpha": 0.85}
_ROW = 11.5  # height of a row of a legend [points]


@drawing
def motion_map(grid: Grid, x: str | None = None, y: str | None = None, borders: bool | str = True, ax: Ax = None) -> Any:
    """The motion type over a plane, each region with its name, and the exact borders of Coulomb friction drawn over it.

    Parameters
    ----------
    grid : Dataset
        From `sweep` or `map`, with two axes of numbers.
    x, y : str, optional
        Horizontal and vertical axis; by default the first and the second.
    borders : bool or "twin"
        Whether to draw the exact borders of Coulomb friction (`coulomb_borders`) over a map whose motion types they separate. For
        another law, "twin" draws the borders of the same robot with Coulomb friction.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> grid = ss.sweep(ss.presets.piezo_rig, amplitude=[3e-4, 4e-4, 5e-4, 6e-4], tilt_deg=[1.7, 2.7, 3.7], law="coulomb")
    >>> ss.plot.motion_map(grid).get_xlabel()
    'amplitude of the inner mass $A$ (µm)'
    """
    first, second = plane_of(grid, x, y)
    across, up = scaled_axis(grid, first), scaled_axis(grid, second)
    types = np.asarray(column_of("plot", grid, "motion_type").transpose(second, first).values)
    present = [name for name in TYPE_COLOURS if (types == name).any()]
    codes = np.zeros(types.shape, int)
    for i, name in enumerate(present):
        codes[types == name] = i
    ax = axes(ax, 2.9)
    cells(ax, across.values, up.values, codes, [TYPE_COLOURS[name] for name in present])
    places = _places(codes, across, up)
    legend = [name for i, name in enumerate(present) if not name_region(ax, *places, i, name)]
    named = "Coulomb twin" if borders == "twin" else "Coulomb, exact"
    drawn = (borders == "twin" or (borders and _parts_them(grid))) and _draw_borders(ax, grid, first, second, across, up)
    _legend(ax, legend, named if drawn else None, _hatch_unsettled(ax, grid, first, second, across, up))
    return _framed(ax, grid, across, up)


@drawing
def velocity_map(
    grid: Grid,
    x: str | None = None,
    y: str | None = None,
    borders: bool = True,
    optimum: bool = True,
    ax: Ax = None,
    quantity: str = "mean_velocity",
) -> Any:
    """The mean velocity, or another number, over a plane, with the borders of the motion types and the fastest point marked.

    For a machine of several parts, select one first: ``velocity_map(grid.sel(body="module 1"), quantity="body_velocity")``.

    Parameters
    ----------
    grid : Dataset
        From `sweep` or `map`, with two axes of numbers.
    x, y : str, optional
        Horizontal and vertical axis; by default the first and the second.
    borders : bool
        Whether to draw lines between the computed motion types.
    optimum : bool
        Whether to mark the point of largest speed.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.
    quantity : str, optional
        Any column of numbers, such as "velocity_max" or "stick_fraction".

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> grid = ss.sweep(ss.presets.piezo_rig, amplitude=[3e-4, 4e-4, 5e-4, 6e-4], tilt_deg=[1.7, 2.7, 3.7], law="coulomb")
    >>> ss.plot.velocity_map(grid, x="tilt_deg").get_ylabel()
    'amplitude of the inner mass $A$ (µm)'
    """
    first, second = plane_of(grid, x, y)
    across, up = scaled_axis(grid, first), scaled_axis(grid, second)
    column = _numbers(grid, quantity)
    V = np.asarray(column.transpose(second, first).values, float)
    unitless = column.attrs.get("units") == "1" or {first, second} == {"alpha_plus", "alpha_minus"}  # then A mu omega is 1
    nothing = _no_motion(grid, V, quantity)
    V = np.where(np.isfinite(V), 0.0, V) if nothing else V
    prefixed = not unitless and column.attrs.get("units", "m/s") in _PREFIXED
    factor, letter = prefix(V[np.isfinite(V)]) if prefixed else (1.0, "")
    unit = "" if unitless else f"{letter}{column.attrs.get('units', 'm/s')}"
    V = V * factor
    top, bottom = np.nanmax(V, initial=0.0), np.nanmin(V, initial=0.0)
    both = bottom < -1e-3 * max(top, -bottom)
    limits: dict[str, Any] = (
        {"vmin": -max(top, -bottom), "vmax": max(top, -bottom), "cmap": "PuOr_r"} if both else {"vmin": 0.0, "cmap": "cividis"}
    )
    limits |= {"vmin": -1.0, "vmax": 1.0, "cmap": "PuOr_r"} if nothing else {}
    ax = axes(ax, 2.9)
    shown = ax.pcolormesh(edges(across.values), edges(up.values), V, rasterized=True, **limits)
    bar = ax.figure.colorbar(shown, ax=ax, fraction=0.05, pad=0.03)
    named = "mean velocity $V$" if quantity == "mean_velocity" else quantity.replace("_", " ")
    bar.set_label("mean velocity $V/(A\\mu\\omega)$" if unitless and "$" in named else f"{named} ({unit or '1'})")
    bar.outline.set_linewidth(0.5)
    lines = borders and _type_lines(ax, grid, first, second, across, up)
    late = not nothing and _hatch_unsettled(ax, grid, first, second, across, up)
    _legend(ax, [], "border of motion types" if lines else None, late)
    if not np.isfinite(V).any():
        bar.remove()
        ax.text(0.5, 0.5, "no case has a number", transform=ax.transAxes, ha="center", va="center", fontsize=7, zorder=9)
    elif nothing:
        bar.remove()
        ax.text(0.5, 0.5, nothing, transform=ax.transAxes, ha="center", va="center", fontsize=7, bbox=_BOX, zorder=9)
    elif optimum:
        _mark_best(ax, _settled(grid, V, first, second), across, up, unit)
    return _framed(ax, grid, across, up)


def _no_motion(grid: xr.Dataset, V: Array, quantity: str) -> str:
    """A sentence for a map of mean velocities that are all rounding or tolerance beside the velocities; empty where they are not."""
    if quantity != "mean_velocity" or not {"velocity_max", "velocity_min"} <= set(grid.data_vars) or not np.isfinite(V).any():
        return ""
    speed = max(float(np.nanmax(abs(grid[name].values), initial=0.0)) for name in ("velocity_max", "velocity_min"))
    most = float(np.nanmax(abs(V)))
    return "no net motion: $|V| < 10^{-7}$ of the velocities" if most < _NO_MOTION * speed else ""


def _settled(grid: xr.Dataset, V: Array, first: str, second: str) -> Any:
    """The values without those that have not settled, unless none has."""
    if "steadiness" not in grid:
        return V
    known = np.where(np.asarray(grid["steadiness"].transpose(second, first).values) == UNSETTLED, np.nan, V)
    return known if np.isfinite(known).any() else V


def _numbers(grid: xr.Dataset, quantity: str) -> Any:
    """A numeric column of a dataset."""
    column = column_of("plot", grid, quantity)
    if column.dtype.kind != "f":
        has = ", ".join(str(n) for n in grid.data_vars if grid[n].dtype.kind == "f")
        raise InputError("plot", [f"quantity = {quantity!r} holds {column.dtype}; allowed is a column of numbers: {has}"])
    return column


# ---- parts ----
class _Axis(NamedTuple):
    """An axis for drawing: values scaled by an SI prefix, the factor, and the label."""

    values: Any
    factor: float
    label: str


def scaled_axis(grid: xr.Dataset, name: str) -> _Axis:
    """An axis of a dataset, scaled for drawing."""
    values, unit = np.asarray(grid[name].values, float), grid[name].attrs.get("units", "1")
    factor, letter = prefix(values) if unit in _PREFIXED else (1.0, "")
    return _Axis(values * factor, factor, plain_label(grid, name, letter))


def plain_label(grid: xr.Dataset, name: str, letter: str = "") -> str:
    """Name and unit of an axis, without a prefix if none is given."""
    unit = grid[name].attrs.get("units", "1")
    shown = "" if unit in ("1", "") else " (°)" if unit == "degrees" else f" ({letter}{unit})"
    return symbols(grid[name].attrs.get("long_name", name)) + shown


def _framed(ax: Axes, grid: xr.Dataset, across: _Axis, up: _Axis) -> Any:
    """Set limits, labels, frame and title of a map."""
    for axis, limit in ((across, ax.set_xlim), (up, ax.set_ylim)):
        if np.ptp(axis.values) > 0:
            limit(axis.values.min(), axis.values.max())
    logarithmic(ax, "x", np.sort(across.values))
    logarithmic(ax, "y", np.sort(up.values))
    ax.set(xlabel=across.label, ylabel=up.label)
    ax.spines[["top", "right"]].set_visible(True)
    legend = ax.get_legend()
    rows = 0 if legend is None else -(-len(legend.get_texts()) // 4)
    ax.set_title(_mapped(grid), loc="left", fontsize=6.5, pad=4.0 + _ROW * rows)
    return ax


def _mapped(grid: xr.Dataset) -> str:
    """The law and the fixed numbers of a map, as far as its dataset contains them."""
    law = json.loads(grid.attrs.get("provenance", "{}")).get("kinds", {}).get("law", "")
    fixed = json.loads(grid.attrs.get("fixed", "{}"))
    facts = [f"{n} = {v:.6g}" for n, v in fixed.items() if n not in grid.coords and isinstance(v, (int, float)) and not isinstance(v, bool)]
    facts += [_stays(grid[n], str(n)) for n in grid.coords if grid[n].ndim == 0 and grid[n].dtype.kind in "iuf"]
    lines, width = [""], 70
    for part in [law, *facts] if law else facts:
        lines = [*lines[:-1], f"{lines[-1]}, {part}" if lines[-1] else part] if len(lines[-1]) + len(part) < width else [*lines, part]
    return "\n".join(lines)


def _stays(number: Any, name: str) -> str:
    """A fixed number of a map, by its symbol if it has one, with its unit."""
    unit, symbol = number.attrs.get("units", "1"), symbols(number.attrs.get("long_name", name)).rpartition(" ")[2]
    factor, letter = prefix(float(number)) if unit in _PREFIXED else (1.0, "")
    shown = "" if unit in ("1", "") else "°" if unit == "degrees" else f" {letter}{unit}"
    return f"{symbol if symbol.startswith('$') else name} = {float(number) * factor:.6g}{shown}"


def _places(codes: Any, across: _Axis, up: _Axis) -> tuple[Any, Any, Any]:
    """The map on a fine grid that is uniform in the frame: coordinates on both axes, and the code of the nearest cell at each point."""
    (x, columns), (y, rows) = (places(axis.values, _FINE) for axis in (across, up))
    return x, y, codes[np.ix_(rows, columns)]


def name_region(ax: Axes, x: Array, y: Array, codes: Any, code: int, name: str) -> bool:
    """Write a type's name into the widest part of its largest region; False if there is no room."""
    from scipy.ndimage import distance_transform_edt

    depth = distance_transform_edt(np.pad(codes == code, 1))[1:-1, 1:-1] / _FINE
    i, j = np.unravel_index(np.argmax(depth), depth.shape)
    if depth[i, j] < _SMALLEST * (1 + 0.25 * max(len(name) - 3, 0)):
        return False
    ax.text(x[j], y[i], name, ha="center", va="center", fontsize=8, color="white" if name in DARK else INK, zorder=6)
    return True


def _parts_them(grid: xr.Dataset) -> bool:
    """Whether the motion types of the map are those of Coulomb friction, except for cells on a border."""
    if not {"alpha_plus", "alpha_minus"} <= set(grid.variables):
        return False
    plus, minus, types = (
        np.asarray(grid[n].broadcast_like(grid["mean_velocity"]).values) for n in ("alpha_plus", "alpha_minus", "motion_type")
    )
    known = np.isfinite(plus) & np.isfinite(minus) & (types != "unsolved")
    return bool(np.mean(coulomb_type(plus[known], minus[known]) == types[known]) > _OWN) if known.any() else False


def _draw_borders(ax: Axes, grid: xr.Dataset, first: str, second: str, across: _Axis, up: _Axis) -> bool:
    try:
        curves = coulomb_borders(grid, first, second)
    except InputError:
        return False
    for curve in curves:
        outlined(ax, curve.x * across.factor, curve.y * up.factor)
    return bool(curves)


def outlined(ax: Axes, x: ArrayLike, y: ArrayLike) -> None:
    """Draw a black line with a white outline, visible on every colour."""
    ax.plot(x, y, color="white", linewidth=1.8, zorder=4, solid_capstyle="butt")
    ax.plot(x, y, color="black", linewidth=0.7, zorder=5, solid_capstyle="butt")


def _hatch_unsettled(ax: Axes, grid: xr.Dataset, first: str, second: str, across: _Axis, up: _Axis) -> bool:
    """Hatch the cells whose mean velocity has not settled; False if there are none."""
    if "steadiness" not in grid:
        return False
    late = np.asarray(grid["steadiness"].transpose(second, first).values) == UNSETTLED
    if not late.any():
        return False
    import matplotlib as mpl

    x, y, shown = _places(late.astype(float), across, up)
    with mpl.rc_context({"hatch.linewidth": 0.5}):
        ax.contourf(x, y, shown, levels=[0.5, 1.5], colors="none", hatches=[_HATCH], zorder=3)
    return True


def _legend(ax: Axes, names: list[str], line: str | None, unsettled: bool = False) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [Patch(facecolor=TYPE_COLOURS[n], edgecolor=INK, linewidth=0.4, label=n) for n in names]
    handles += [Line2D([], [], color="black", linewidth=0.8, label=line)] if line else []
    handles += [Patch(facecolor="none", edgecolor=INK, linewidth=0.4, hatch=_HATCH, label=STEADINESS[UNSETTLED])] if unsettled else []
    if handles:
        legend_above(ax, handles=handles, ncols=4, handlelength=1.4, columnspacing=1.0)


def _type_lines(ax: Axes, grid: xr.Dataset, first: str, second: str, across: _Axis, up: _Axis) -> bool:
    """Draw lines between regions of different type, with rounded cell corners and without specks; False if there are none."""
    import contourpy

    if not is_of_cases(grid, "motion_type"):
        return False
    types = np.asarray(grid["motion_type"].transpose(second, first).values)
    names, codes = np.unique(types, return_inverse=True)
    if len(names) < 2 or min(types.shape) < 2:
        return False
    x, y, codes = _places(codes.reshape(types.shape), across, up)
    shares, drawn = _rounded(codes, len(names), types.shape), False
    for k in range(len(names) - 1):  # the borders of the last type are those of the others
        ahead = shares[k] - np.delete(shares, k, axis=0).max(axis=0)
        for line in contourpy.contour_generator(x, y, ahead).lines(0.0):
            outlined(ax, *np.asarray(line).T)
            drawn = True
    return drawn


def _rounded(codes: Any, count: int, cells: tuple[int, ...]) -> Any:
    """The fraction of each type in the neighbourhood of each point; small specks are removed."""
    from scipy.ndimage import gaussian_filter, label

    width = [_FINE * max(_ROUNDED[0] / max(n - 1, 1), _ROUNDED[1]) for n in cells]
    shares = np.array([gaussian_filter((codes == k).astype(float), width, mode="nearest") for k in range(count)])
    least = _FINE**2 * max(_SPECK[0] / np.prod([max(n - 1, 1) for n in cells]), _SPECK[1])
    for k in 2 * list(range(count)):  # twice: a former speck may have joined a neighbour
        parts, pieces = label(shares.argmax(axis=0) == k)
        sizes = np.bincount(parts.ravel(), minlength=pieces + 1)
        shares[k][np.isin(parts, 1 + np.flatnonzero(sizes[1:] < least))] = -1.0
    return shares


def _mark_best(ax: Any, V: Any, across: _Axis, up: _Axis, unit: str) -> None:
    """Draw a star at the largest speed, with its value, placed towards the middle of the map."""
    i, j = np.unravel_index(np.nanargmax(abs(V)), V.shape)
    x, y = across.values[j], up.values[i]
    ax.plot(x, y, marker="*", markersize=9, color="white", markeredgecolor="black", markeredgewidth=0.7, zorder=8, clip_on=False)
    right = x > 0.5 * (across.values.min() + across.values.max())
    high = y > 0.5 * (up.values.min() + up.values.max())
    offset = (-6 if right else 6, -7 if high else 7)
    words = {"ha": "right" if right else "left", "va": "top" if high else "bottom", "fontsize": 7}
    text = f"{V[i, j]:.3g} {unit}".strip().replace("-", "−")
    ax.annotate(text, (x, y), xytext=offset, textcoords="offset points", bbox=_BOX, zorder=9, **words)
