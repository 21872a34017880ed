"""Maps of motions: period numbers and largest exponents over one or two parameters, with curves of special points over them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Ax, Grid
from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import InputError
from stickslip.show.figures.spacing import cells, edges, logarithmic
from stickslip.show.figures.special_kinds import name_of
from stickslip.show.figures.style import COLOURS, INK, UNSETTLED, UNSETTLED_MARK, axes, drawing, legend_above, side_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


#: Colours of a map of motions by period number, chaotic, quasi-periodic, not settled; distinguishable with any colour vision.
MOTIONS = {
    "period 1": "#E3ECF4", "2": "#8CC1E0", "3": "#F2C46D", "4": "#3B87BA", "5 to 7": "#663333", "8 and more": "#12456B",
    "chaotic": "#D55E00", "quasi-periodic": "#6BA368", "steady": "#E6D7AC", "not settled": "#9A9A9A", "runs away or not solved": "#1A1014",
}  # fmt: skip
_LOWEST = -2.0  # lower exponents all have one colour


@drawing
def chaos_map(grid: Grid, ax: Ax = None, quantity: str = "motion", curves: Any = ()) -> Any:
    """A map of motions over two parameters; over one, the largest exponent as a line.

    Parameters
    ----------
    grid : xarray.Dataset
        From `stickslip.dynamics.chaos_map`.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.
    quantity : str
        "motion": period numbers, and what has no period: chaotic, quasi-periodic, steady, or not settled within the limit.
        "exponent": the largest exponent, orange where neighbouring motions diverge, violet where they converge.
    curves : Curve or list of Curve
        From `stickslip.dynamics.special_curve`, in the same two parameters; drawn over the map.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> over = {"amplitude": [4e-4, 6e-4], "tilt_deg": [1.7, 2.7]}
    >>> grid = ss.dynamics.chaos_map(ss.presets.piezo_rig, **over, law="coulomb", settle=50, periods=20)
    >>> ss.plot.chaos_map(grid).get_xlabel()
    'tilt of the track $θ$ (degrees)'
    """
    if not {"period", "motion", "exponent", "error"} <= set(getattr(grid, "data_vars", {})):
        raise InputError("plot", [f"{type(grid).__name__} without periods and exponents; allowed is the Dataset of ss.dynamics.chaos_map"])
    if quantity not in ("motion", "exponent"):
        raise InputError("plot", [f"quantity = {quantity!r}; allowed is motion or exponent"])
    ax = axes(ax, height=3.0)
    if len(grid.period.dims) == 1:
        return _line(grid, ax)
    upward, across = map(str, grid.period.dims)
    (right, side), (up, mark) = (side_of(grid[n]) for n in (across, upward))
    handles = (_motions if quantity == "motion" else _exponents)(grid, ax, grid[across].values * right, grid[upward].values * up)
    handles += _over(curves, ax, (across, right), (upward, up))
    logarithmic(ax, "x", grid[across].values)
    logarithmic(ax, "y", grid[upward].values)
    ax.set(xlabel=side, ylabel=mark)
    if handles:
        ax.legend(
            handles=handles, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=min(len(handles), 5), borderaxespad=0.2,
            columnspacing=1.0, handlelength=1.2,
        )  # fmt: skip
    return ax


def _motions(grid: Any, ax: Axes, x: ArrayLike, y: ArrayLike) -> list[Any]:
    from matplotlib.patches import Patch

    kinds = _kinds(grid)
    cells(ax, x, y, kinds, list(MOTIONS.values()))
    shown = [item for i, item in enumerate(MOTIONS.items()) if (kinds == i).any()]
    return [Patch(facecolor=colour, edgecolor=INK, linewidth=0.3, label=name) for name, colour in shown]


def _kinds(grid: Any) -> Any:
    """The index of the kind of motion in `MOTIONS` at each point; masked where nothing was computed."""
    period, motion, names = grid.period.values, grid.motion.values, list(MOTIONS)
    kinds = np.where(period > 0, np.searchsorted([1, 2, 3, 4, 7], period, side="left"), len(names) - 1)
    for word in ("chaotic", "quasi-periodic", "steady", "not settled"):
        kinds = np.where(motion == word, names.index(word), kinds)
    return np.ma.masked_where(motion == "not computed", kinds)


def _exponents(grid: Any, ax: Axes, x: Array, y: Array) -> list[Any]:
    from matplotlib.colors import TwoSlopeNorm

    values = np.ma.masked_invalid(np.where(np.isneginf(grid.exponent.values), _LOWEST, grid.exponent.values))
    norm = TwoSlopeNorm(0.0, _LOWEST, max(0.5, float(np.max(values.filled(0.0), initial=0.0))))
    mesh = ax.pcolormesh(edges(x), edges(y), values, cmap="PuOr_r", norm=norm, rasterized=True)
    bar = ax.figure.colorbar(mesh, ax=ax, extend="min", pad=0.02, aspect=28)
    bar.set_label(_exponent_label(grid))
    bar.outline.set_linewidth(0.4)
    return []


def _exponent_label(grid: Any) -> str:
    """What exponents are per: a drive period, or a return to the section of a machine without one."""
    return f"largest exponent per {'return' if 'return' in grid.exponent.attrs.get('long_name', '') else 'drive period'}"


def _over(curves: Any, ax: Axes, across: tuple[str, float], upward: tuple[str, float]) -> list[Any]:
    """Draw curves of special points in black with a white outline, visible on every colour; returns a handle for each kind."""
    handles: dict[str, Any] = {}
    for curve in curves if isinstance(curves, Iterable) else (curves,):
        if set(getattr(curve, "parameters", ())) != {across[0], upward[0]}:
            both = f"({across[0]}, {upward[0]})"
            raise InputError("plot", [f"curves: {curve!r} is not a curve in {both}; allowed are those of ss.dynamics.special_curve"])
        x, y = (curve.values[:, curve.parameters.index(name)] * factor for name, factor in (across, upward))
        ax.plot(x, y, color="white", linewidth=2.0, zorder=3)
        (handles[curve.kind],) = ax.plot(x, y, color="black", linewidth=0.9, zorder=4, label=name_of(curve.kind))
    return list(handles.values())


def _line(grid: Any, ax: Axes) -> Any:
    name = str(grid.period.dims[0])
    right, side = side_of(grid[name])
    x, y, error = grid[name].values * right, grid.exponent.values, grid.error.values
    ax.axhline(0.0, color=INK, linewidth=0.5)
    ax.fill_between(x, y - 3 * error, y + 3 * error, color=COLOURS[0], alpha=0.2, linewidth=0)
    ax.plot(x, y, ".-", color=COLOURS[0], linewidth=0.7, markersize=2.5)
    late = grid.motion.values == "not settled"
    if late.any():
        ax.plot(x[late], y[late], UNSETTLED_MARK, color=UNSETTLED, markersize=4, label="not settled")
        legend_above(ax)
    logarithmic(ax, "x", x)
    ax.set(xlabel=side, ylabel=_exponent_label(grid))
    return ax
