"""Attractors along a parameter: the mean velocity of each, or its share of the initial states."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.arguments import Ax, Grid
from stickslip.basics.errors import InputError
from stickslip.show.figures.style import COLOURS, UNSETTLED, UNSETTLED_MARK, axes, drawing, legend_above, side_of

_BESIDE = ("period", "image", "motion", "exponent", "error", "share", "share_low", "share_high", "mode")


@drawing
def attractors(grid: Grid, quantity: str | None = None, ax: Ax = None) -> Any:
    """Attractors along a parameter, with a line for each; rings mark chaotic and quasi-periodic motions, crosses unsettled starts.

    A cross on the upper edge stands at each value where some starts have not settled: attractors may be missing there. In a figure of
    shares it stands at their share.

    Parameters
    ----------
    grid : xarray.Dataset
        From `stickslip.attractors`.
    quantity : str, optional
        "mean_velocity", "share" (the fraction of the initial states, with its 95 % interval as a band), or a coordinate of the strobe
        state, such as "v". If not given, the mean velocity or, for a flow, which has none, its first state.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> lives = ss.attractors(ss.presets.piezo_rig, parameter="amplitude", values=[5e-4, 6e-4], starts=dict(v=[0.0, 0.01]), settle=30,
    ...                   tilt_deg=1.7, law="coulomb")
    >>> ss.plot.attractors(lives).get_ylabel()
    'mean velocity (mm/s)'
    """
    if not {"share", "unsettled", "motion"} <= set(getattr(grid, "data_vars", {})):
        raise InputError("plot", [f"{type(grid).__name__} without attractors; allowed is the Dataset of ss.attractors"])
    known = [*(name for name in map(str, grid.data_vars) if grid[name].ndim == 2 and name not in _BESIDE), "share"]
    quantity = known[0] if quantity is None and known else quantity
    if quantity not in known:
        raise InputError("plot", [f"quantity = {quantity!r}; allowed is {' or '.join(known)}"])
    across, y = grid[grid.attrs["parameter"]], grid[quantity]
    (right, side), (up, mark) = side_of(across), side_of(y)
    ax = axes(ax)
    for k in range(grid.sizes["attractor"]):
        one, colour = grid.isel(attractor=k), COLOURS[k % 7]
        x, values = across.values * right, one[quantity].values * up
        if quantity == "share":
            ax.fill_between(x, one.share_low.values, one.share_high.values, color=colour, alpha=0.15, linewidth=0)
        ax.plot(x, values, ".-", color=colour, markersize=4, label=_text(one))
        wild = one.period.values == 0
        ax.plot(x[wild], values[wild], "o", color=colour, markersize=5, fillstyle="none", markeredgewidth=0.8)
    late = grid.unsettled.values > 0
    if late.any():
        shares = grid.unsettled.values[late] / grid.attrs["starts"]
        position: dict[str, Any] = {} if quantity == "share" else {"transform": ax.get_xaxis_transform(), "clip_on": False}
        where = shares if quantity == "share" else np.ones(len(shares))
        label = f"starts not settled (up to {100 * shares.max():.2g} %)"
        ax.plot(across.values[late] * right, where, UNSETTLED_MARK, color=UNSETTLED, markersize=4, label=label, **position)
    ax.set(xlabel=side, ylabel=mark)
    legend_above(ax, ncols=3, columnspacing=1.2)
    return ax


def _text(one: Any) -> str:
    """The legend entry of an attractor: its number, its periods and what it is without one."""
    periods = ", ".join(str(p) for p in sorted({int(p) for p in one.period.values if p > 0}))
    kinds = sorted(set(one.motion.values[one.period.values == 0].tolist()))
    return f"{int(one.attractor)}: {', '.join([*([f'period {periods}'] if periods else []), *kinds])}"
