"""The figure of a batch: its mean velocity over one number or two."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stickslip.basics.arguments import Ax
from stickslip.basics.errors import InputError
from stickslip.results.summary import Summary
from stickslip.show.figures.line_cuts import line_cut
from stickslip.show.figures.maps import velocity_map
from stickslip.show.figures.style import drawing

if TYPE_CHECKING:
    import xarray as xr


@drawing
def batch(many: Summary, ax: Ax = None) -> Any:
    """The mean velocity of a batch: over the number that varies with the motion types below it, or as a map over two.

    Parameters
    ----------
    many : Summary
        From `solve` of a batch with one axis or two.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> many = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=[3e-4, 4e-4, 5e-4], law="coulomb"), periods=20)
    >>> ss.plot.batch(many).get_xlabel()
    'amplitude of the inner mass $A$ (µm)'
    """
    if not isinstance(many, Summary):
        mistake = f"many = {many!r}; allowed is what ss.solve returns of a batch; type ss.plot.batch(ss.solve(robots))"
        raise InputError("plot", [mistake])
    if "mean_velocity" not in many.columns:
        has = ", ".join(many.columns)
        raise InputError("plot", [f"the batch has no mean velocity; it has {has}; type many.to_xarray()[name].plot() for one of these"])
    if not 1 <= len(many.shape) <= 2:
        drawn = "a batch with one axis or two is drawn"
        raise InputError("plot", [f"the batch has the shape {many.shape}; {drawn}; type many.to_xarray() and select what to draw"])
    grid = _over_numbers(many.to_xarray())
    names = [str(dim) for dim in grid["mean_velocity"].dims]
    return line_cut(grid, names[0], ax=ax) if len(names) == 1 else velocity_map(grid, ax=ax)


def _over_numbers(grid: xr.Dataset) -> Any:
    """The batch over the numbers that vary along its axes, where along each of them one does; else over the numbers of its cases."""
    for dim in grid["mean_velocity"].dims:
        along = [name for name, number in grid.coords.items() if number.dims == (dim,) and number.dtype.kind in "fiu"]
        if len(along) == 1 and along[0] != dim and len(set(grid[along[0]].values.tolist())) == grid.sizes[dim]:
            grid = grid.swap_dims({dim: along[0]}).sortby(along[0])
    return grid
