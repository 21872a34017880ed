"""Interactive charts: the curves of a figure as plain numbers, for the page's script. The static figure stays for print."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from stickslip.basics.contracts import ArrayLike

_DIGITS = 6
_DASHES = ((), (7, 3), (2, 3), (8, 3, 2, 3), (5, 5), (1, 4))


Table = tuple[str, Any, list[Any]]


def tables_of(tables: Iterable[Table], most: int | None = None) -> list[dict[str, Any]]:
    """Tables with a caption, a head and rows, in the form that pages take; tables without rows are left out."""
    return [{"caption": caption, "head": head, "rows": rows[:most]} for caption, head, rows in tables if rows]


class Figure(NamedTuple):
    """A figure with its caption and, if available, its interactive chart."""

    caption: str
    picture: str
    chart: dict[str, Any] | None = None


def curve(label: str, y: ArrayLike, points: bool = False, number: int = 0, emphasis: bool = False) -> dict[str, Any]:
    """One curve of a chart.

    Parameters
    ----------
    label : str
    y : array (n,)
        Its values; non-finite ones leave gaps.
    points : bool
        Points without a line.
    number : int
        Number of its colour and dash pattern.
    emphasis : bool
        Whether to draw it in the colour of the text, such as a line that joins points.
    """
    return {"label": label, "y": _plain(y), "points": points, "dash": [] if points else list(_DASHES[number % 6]), "colour": number % 6,
            "plain": emphasis}  # fmt: skip


def chart(title: str, x: ArrayLike, across: tuple[str, str], up: tuple[str, str], curves: Iterable[Any], shade: Any = ()) -> dict[str, Any]:
    """A chart as plain data.

    Parameters
    ----------
    title : str
        Text alternative for readers who cannot see it.
    x : array (n,)
        In ascending order.
    across, up : tuple of str
        Name and unit of the axes.
    curves : iterable of dict
        From `curve`.
    shade : iterable of (from, to)
        Intervals of x with a shaded background.

    Examples
    --------
    >>> made = chart("a line", [0.0, 1.0], ("time", "s"), ("way", "m"), [curve("it", [0.0, float("nan")])])
    >>> made["x"], made["curves"][0]["y"]
    ([0.0, 1.0], [0.0, None])
    """
    return {"title": title, "x": _plain(x), "across": across, "up": up, "curves": list(curves), "shade": [_plain(s) for s in shade]}


def _plain(values: Any) -> list[float | None]:
    import math

    return [float(f"{v:.{_DIGITS}g}") if math.isfinite(v) else None for v in map(float, values)]


@cache
def chart_library() -> dict[str, str]:
    """uPlot, which the explorer ships, as text to embed in a page: its licence, script and style."""
    folder = Path(__file__).parents[1] / "explorer" / "assets"
    names = {"licence": "uPlot.LICENSE.txt", "script": "uPlot.iife.min.js", "style": "uPlot.min.css"}
    return {name: (folder / file).read_text(encoding="utf-8").strip() for name, file in names.items()}
