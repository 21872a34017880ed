"""Axes with geometrically spaced values are logarithmic."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import ArrayLike
from stickslip.basics.maths import exp

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def geometric(values: Any) -> bool:
    """Whether numbers grow by a constant factor rather than by a constant step."""
    if len(values) < 3 or not (values > 0).all():
        return False
    ratios = np.diff(np.log(values))
    return bool(np.ptp(ratios) < 1e-6 * abs(ratios).max() and np.ptp(np.diff(values)) > 1e-3 * abs(np.diff(values)).max())


def edges(values: Any) -> Any:
    """The edges of cells around numbers, halfway between neighbours (in their logarithms if they grow by a constant factor)."""
    if geometric(values):
        return exp(edges(np.log(values)))  # finite even at the limits of a float
    if len(values) == 1:
        return np.array([values[0] - 0.5, values[0] + 0.5])
    middle = 0.5 * (values[1:] + values[:-1])
    return np.concatenate([[2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]])


def cells(ax: Axes, x: ArrayLike, y: ArrayLike, codes: Any, colours: Sequence[str]) -> None:
    """Fill the cells around grid points with the colours of their codes."""
    from matplotlib.colors import BoundaryNorm, ListedColormap

    norm = BoundaryNorm(np.arange(len(colours) + 1) - 0.5, len(colours))
    ax.pcolormesh(edges(x), edges(y), codes, cmap=ListedColormap(colours), norm=norm, rasterized=True)


def logarithmic(ax: Axes, letter: str, values: ArrayLike) -> None:
    """Make an axis logarithmic, with plain numbers, if its values grow by a constant factor."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    if not geometric(values):
        return
    getattr(ax, f"set_{letter}scale")("log")
    axis = getattr(ax, f"{letter}axis")
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 3.0, 5.0)))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))


def places(values: ArrayLike, count: int) -> tuple[Any, Any]:
    """`count` points over the range of the values, uniform on their axis, and the index of the nearest value at each."""
    values = np.asarray(values, float)
    on_axis = np.log(values) if geometric(np.sort(values)) else values
    fine = np.linspace(on_axis.min(), on_axis.max(), count)
    nearest = abs(fine[:, None] - on_axis).argmin(axis=1)
    return (np.exp(fine) if on_axis is not values else fine), nearest
