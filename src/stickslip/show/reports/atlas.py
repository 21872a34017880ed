"""Page on an atlas: regions, borders, special points with their accuracy, branches, and parts not reached."""

from __future__ import annotations

from typing import Any

from stickslip.show.figures.atlas import atlas as drawn
from stickslip.show.reports.charts import Figure, Table, tables_of
from stickslip.show.reports.drawn import svg
from stickslip.show.reports.html import page

_ROWS = 400  # largest number of rows in a table
_CAPTION = "Regions by the motions that attract there; lines are borders that were followed in both numbers."


def atlas_page(atlas: Any, title: str, command: str = "") -> str:
    """The page on an atlas.

    Parameters
    ----------
    found : Atlas
    title : str
        Title of the page.
    command : str
        The command that makes the page, if it was made by one.

    Returns
    -------
    str

    Examples
    --------
    >>> import stickslip as ss
    >>> over = {"amplitude": [3.3e-4, 3.6e-4, 3.9e-4], "mu0": [0.17, 0.18]}
    >>> found = ss.atlas(ss.presets.piezo_rig, over=over, tilt_deg=1.7, law="coulomb")
    >>> "type-border" in atlas_page(found, "Where it walks")
    True
    """
    return page(
        "atlas.html",
        title=title,
        axes=_axes(atlas),
        tables=tables_of((_regions(atlas), _special(atlas), _borders(atlas), _branches(atlas)), _ROWS),
        notes=list(atlas.notes),
        figures=[Figure(_CAPTION, svg(lambda ax: drawn(atlas, ax), 5.2, 4.2))],
        command=command,
        provenance=_provenance(),
        sources=[],
    )


def _axes(atlas: Any) -> list[tuple[str, str]]:
    """Both axes with their ranges, and the fixed numbers."""
    rows = []
    for name in atlas.parameters:
        axis = atlas.map[name]
        unit = "" if axis.attrs["units"] in ("", "1") else f" {axis.attrs['units']}"
        rows.append((name, f"{axis.size} values, {float(axis[0]):.6g} to {float(axis[-1]):.6g}{unit}"))
    rows.append(("starts", f"{atlas.plane.count} at each point"))
    return [*rows, *((name, str(value)) for name, value in atlas.plane.family.fixed.items())]


def _regions(atlas: Any) -> Table:
    rows = [(label, f"{100 * share:.1f} %") for label, share in atlas.regions.items()]
    return "Regions, by the motions that coexist in them.", ("region", "share of the grid"), rows


def _special(atlas: Any) -> Table:
    head = ("special point", *atlas.parameters, "accuracy", "what changes")
    return "Special points, to the digits that are certain.", head, atlas.rows()


def _borders(atlas: Any) -> Table:
    rows = []
    for border in atlas.borders:
        ends = [", ".join(f"{v:.6g}" for v in border.values[k]) for k in (0, -1)]
        worst = max(max(pair) for pair in border.accuracy)
        rows.append((border.kind, border.change, ends[0], ends[1], f"{worst:.1g}", "; ".join(dict.fromkeys(border.ended))))
    return "Borders that were followed in both numbers.", ("kind", "what changes", "from", "to", "accuracy", "ends"), rows


def _branches(atlas: Any) -> Table:
    other = {atlas.parameters[0]: atlas.parameters[1], atlas.parameters[1]: atlas.parameters[0]}
    rows = [
        (b.parameter, f"{b.values[0]:.6g} to {b.values[-1]:.6g}", f"{other[b.parameter]} = {b.other:.6g}", str(b.period), b.ended)
        for b in atlas.branches
    ]
    return "Branches that were followed.", ("along", "range", "at", "period", "ended"), rows


def _provenance() -> list[tuple[str, str]]:
    import numpy as np

    import stickslip

    return [("stickslip", stickslip.__version__), ("numpy", np.__version__)]
