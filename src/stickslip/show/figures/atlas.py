"""Figure of an atlas: regions by the coexisting attractors, the borders between them, and special points."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Ax
from stickslip.basics.errors import InputError
from stickslip.dynamics.atlas.atlas_result import Atlas
from stickslip.show.figures.maps import TYPE_COLOURS, name_region, outlined, scaled_axis
from stickslip.show.figures.spacing import cells, logarithmic, places
from stickslip.show.figures.special_kinds import marker_of, name_of
from stickslip.show.figures.style import COLOURS, INK, UNSETTLED, UNSETTLED_MARK, axes, drawing, legend_above

if TYPE_CHECKING:
    from matplotlib.axes import Axes


#: Fill colours of regions without a single plain type, distinct from the type colours and from one another.
_FILLS = (
    "#CDB4DB",
    "#8FD3B6",
    "#F4A6A0",
    "#9C89B8",
    "#E9E29C",
    "#5E9C8D",
    "#C97B84",
    "#B5C99A",
    "#7D8CC4",
    "#E0AAFF",
    "#A98467",
    "#D9D9D9",
)
_FINE, _LETTERS = 240, 3  # grid points along each side; length of a name that is written into its region
_COLUMNS = {3: 16, 2: 30}  # number of columns of the legend: the longest entry that each allows
_MISSING, _UNSETTLED = "not computed", "not settled"
_ON_A_LINE = 0.05  # fraction of the axis ranges: marks closer to a line of their kind are left out


@drawing
def atlas(atlas: Atlas, ax: Ax = None, points: bool = True) -> Any:
    """Regions of an atlas with their names, the followed borders as lines, and the special points that lie on no line.

    Parameters
    ----------
    atlas : Atlas
        From `stickslip.atlas`.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.
    points : bool
        Whether to mark special points of stable motions, with a symbol for each kind.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> over = {"amplitude": [3.3e-4, 3.6e-4, 3.9e-4], "mu0": [0.17, 0.18]}
    >>> ss.plot.atlas(ss.atlas(ss.presets.piezo_rig, over=over, tilt_deg=1.7, law="coulomb")).get_xlabel()
    'amplitude of the inner mass $A$ (µm)'
    """
    if not isinstance(atlas, Atlas):
        raise InputError("plot", [f"{atlas!r}; allowed is an Atlas; type for example ss.atlas(ss.presets.piezo_rig, over=...)"])
    across, up = (scaled_axis(atlas.map, name) for name in atlas.parameters)
    ax = axes(ax, 3.1)
    fills = _fills(atlas)
    names = [*fills, _MISSING]
    labels = atlas.map["region"].values.T
    codes = np.array([[names.index(label) if label in fills else len(fills) for label in row] for row in labels])
    inside = _regions(ax, across, up, codes, fills)
    for border in atlas.borders:
        x, y = np.array(border.values).T
        outlined(ax, x * across.factor, y * up.factor)
    marks = _special(ax, atlas, across, up) if points else []
    marks += _unsettled(ax, atlas, across, up)
    _framed(ax, across, up)
    _legend(ax, {name: fill for name, fill in fills.items() if name not in inside}, bool(atlas.borders), marks, bool((labels == "").any()))
    return ax


def _fills(atlas: Any) -> dict[str, str]:
    """A colour for each region: that of the motion type, if the region has a single plain motion."""
    known = {**TYPE_COLOURS, _UNSETTLED: UNSETTLED}
    own = iter(_FILLS * (1 + len(atlas.regions) // len(_FILLS)))
    return {label: known[label] if label in known and label != "other" else next(own) for label in atlas.regions}


def _regions(ax: Axes, across: Any, up: Any, codes: Any, fills: dict[str, str]) -> list[str]:
    """Fill the cells; returns the names that were written into their regions."""
    cells(ax, across.values, up.values, codes, [*fills.values(), "#FFFFFF"])
    (x, columns), (y, rows) = places(across.values, _FINE), places(up.values, _FINE)
    nearest_codes = codes[np.ix_(rows, columns)]
    return [n for i, n in enumerate(fills) if (len(n) <= _LETTERS or n in TYPE_COLOURS) and name_region(ax, x, y, nearest_codes, i, n)]


def _special(ax: Any, atlas: Any, across: Any, up: Any) -> list[Any]:
    """Draw the special points of stable motions, except those on a border line of their kind; returns handles for the legend."""
    lines = {border.kind for border in atlas.borders}
    handles = []
    for i, kind in enumerate(sorted({s.kind for s in atlas.special_points})):
        shown = [s.values for s in atlas.special_points if s.kind == kind and s.stable and (kind not in lines or not _on_a_line(atlas, s))]
        if shown:
            x, y = np.array(shown).T
            style = {"color": COLOURS[i % 7], "markersize": 3.4, "linestyle": "", "zorder": 7}
            handles += ax.plot(x * across.factor, y * up.factor, marker=marker_of(kind), label=name_of(kind), **style)
    return handles


def _unsettled(ax: Any, atlas: Any, across: Any, up: Any) -> list[Any]:
    """Mark points of the grid at which some starts have not settled beside those that have; returns handles for the legend."""
    late = (atlas.map["unsettled"].values > 0) & (atlas.map["count"].values > 0)
    if not late.any():
        return []
    i, j = np.nonzero(late)
    style = {"color": INK, "markersize": 2.6, "markeredgewidth": 0.5, "linestyle": "", "zorder": 6}
    return list(ax.plot(across.values[i], up.values[j], marker=UNSETTLED_MARK, label="some starts not settled", **style))


def _on_a_line(atlas: Any, point: Any) -> bool:
    """Whether a special point lies on a drawn border."""
    spans = np.array([np.ptp(atlas.map[name].values) for name in atlas.parameters])
    return any(border.distance(point.values, spans) < _ON_A_LINE for border in atlas.borders if border.kind == point.kind)


def _framed(ax: Axes, across: Any, up: Any) -> None:
    for axis, limit, letter in ((across, ax.set_xlim, "x"), (up, ax.set_ylim, "y")):
        limit(axis.values.min(), axis.values.max())
        logarithmic(ax, letter, axis.values)
        getattr(ax, f"set_{letter}label")(axis.label)
    ax.spines[["top", "right"]].set_visible(True)


def _legend(ax: Axes, fills: dict[str, str], lines: bool, marks: list[Any], missing: bool) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    fills = fills | ({_MISSING: "#FFFFFF"} if missing else {})
    handles: list[Any] = [Patch(facecolor=fill, edgecolor=INK, linewidth=0.4, label=name) for name, fill in fills.items()]
    handles += [Line2D([], [], color="black", linewidth=0.8, label="border, followed")] if lines else []
    if handles or marks:
        longest = max(len(str(handle.get_label())) for handle in [*handles, *marks])
        columns = next((n for n, letters in _COLUMNS.items() if longest <= letters), 1)
        legend_above(ax, handles=[*handles, *marks], ncols=columns, handlelength=1.2, columnspacing=1.0)
