"""The figures of a study: maps and cuts through them, or curves along its axis, with an interactive chart where available."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stickslip.show.reports.charts import Figure
from stickslip.show.reports.drawn import svg
from stickslip.studies.result_columns import is_of_cases

if TYPE_CHECKING:
    import xarray as xr


def plain(value: Any) -> str:
    """A coordinate as text."""
    numeric = isinstance(value, float) or (getattr(value, "dtype", None) is not None and value.dtype.kind in "iuf")
    return f"{value:.6g}" if numeric else str(value)


def _numeric(grid: xr.Dataset) -> list[str]:
    return [str(d) for d in grid["mean_velocity"].dims if d in grid.coords and grid[d].dtype.kind in "if" and grid.sizes[d] > 1]


def figures(grid: xr.Dataset) -> list[Figure]:
    """Two maps of a plane and cuts through it, or curves along one axis, repeated for up to four combinations of other axes."""
    from stickslip.show import figures as plot
    from stickslip.show.reports.study_charts import along, chosen, cuts, together, types_of

    axes, drawn = _numeric(grid), []
    parts = _parts(grid, axes)
    if len(axes) == 1 and len(parts) > 1:
        named = [(label.strip(" ()"), part) for label, part in parts]
        drawn.append(
            Figure("Mean velocity, all curves in one figure.", svg(lambda ax: _lines(named, axes[0], ax)), together(named, axes[0]))
        )
    for label, part in parts:
        if len(axes) == 2:
            drawn += _type_maps(part, label)
            drawn.append(Figure(f"Mean velocity{label}.", svg(_drawer(plot.velocity_map, part), 4.6, 3.6)))
            for across, other in (axes, axes[::-1]):
                lines = part[other].values[chosen(part.sizes[other])]
                picture = svg(_drawer(plot.line_cut, part, along=across, lines=lines), 5.2, 3.2)
                drawn.append(Figure(f"Cuts through the mean velocity along {across}{label}.", picture, cuts(part, across, other, label)))
        elif len(axes) == 1:
            caption = f"Mean velocity{label}" + (", coloured by motion type." if types_of(part).any() else ".")
            drawn.append(Figure(caption, svg(_drawer(_curve, part)), along(part, axes[0], label)))
    return drawn


def _type_maps(part: Any, label: str) -> list[Figure]:
    """A map of the motion types of a plane; with several contacts one for each, up to four."""
    from stickslip.show import figures as plot

    if is_of_cases(part, "motion_type"):
        caption = f"Motion types{label}; black: the exact borders with Coulomb friction, where they are known."
        return [Figure(caption, svg(_drawer(plot.motion_map, part), 4.2, 3.6))]
    maps = [(str(name), part.sel(contact=name)) for name in part["contact"].values[:4]]
    return [Figure(f"Motion types of {name}{label}.", svg(_drawer(plot.motion_map, one), 4.2, 3.6)) for name, one in maps]


def _parts(grid: xr.Dataset, axes: list[str]) -> list[tuple[str, Any]]:
    """The dataset for each combination of the other axes, up to four, with a label."""
    from itertools import islice, product

    others = [str(d) for d in grid["mean_velocity"].dims if d not in axes]
    choices = islice(product(*(range(grid.sizes[d]) for d in others)), 4)
    parts = []
    for choice in choices:
        where = dict(zip(others, choice, strict=True))
        label = ", ".join(f"{d} = {plain(grid[d].values[i])}" for d, i in where.items() if grid.sizes[d] > 1 and d in grid.coords)
        parts.append((f" ({label})" if label else "", grid.isel(where)))
    return parts


def _drawer(draw: Any, grid: xr.Dataset, **more: Any) -> Any:
    return lambda ax: draw(grid, ax=ax, **more)


def _lines(named: list[tuple[str, Any]], axis: str, ax: Any) -> None:
    """Mean velocities along one axis, a line for each part."""
    from stickslip.show.figures.maps import scaled_axis
    from stickslip.show.figures.style import DASHES
    from stickslip.show.reports.study_charts import speeds

    across, (factor, unit) = scaled_axis(named[0][1], axis), speeds(named[0][1])
    for i, (name, part) in enumerate(named):
        ax.plot(across.values, factor * part["mean_velocity"].values, linestyle=DASHES[i % 7], label=name)
    ax.set(xlabel=across.label, ylabel=f"mean velocity $V$ ({unit})" if unit else "mean velocity $V$")
    ax.legend()


def _curve(grid: xr.Dataset, ax: Any) -> None:
    """Mean velocity along one axis, a point for each case."""
    from stickslip.show.figures.maps import TYPE_COLOURS, scaled_axis
    from stickslip.show.reports.study_charts import speeds, types_of

    (axis,) = _numeric(grid)
    across = scaled_axis(grid, axis)
    factor, unit = speeds(grid)
    x, v, kinds = across.values, factor * grid["mean_velocity"].values, types_of(grid)
    ax.plot(x, v, color="#333333", linewidth=0.7, zorder=1)
    for kind in filter(None, dict.fromkeys(kinds)):
        there = kinds == kind
        colour = TYPE_COLOURS.get(str(kind), "#888888")
        ax.scatter(x[there], v[there], s=14, color=colour, edgecolor="#333333", linewidth=0.4, label=str(kind), zorder=2)
    ax.set(xlabel=across.label, ylabel=f"mean velocity $V$ ({unit})" if unit else "mean velocity $V$")
    if kinds.any():
        ax.legend(title="motion type")
