"""Figures as SVG text for a page."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any


def laid_out(figure: Any) -> None:
    """Lay a figure out once and for all: matplotlib would do so twice for each file that it writes."""
    engine = figure.get_layout_engine()
    if engine is not None:
        engine.execute(figure)
        figure.set_layout_engine("none")


def svg(draw: Callable[[Any], Any], width: float = 4.2, height: float = 2.6, salt: str = "report", layout: Any = None) -> str:
    """A figure as SVG text; letters become paths, so that it looks the same everywhere.

    Parameters
    ----------
    draw : callable
        Called with matplotlib axes.
    width, height : float
        Size [inch].
    salt : str
        Seed of the identifiers inside, which must differ between the figures of a page.
    layout : str, optional
        The layout engine of matplotlib; by default that of our style.

    Examples
    --------
    >>> svg(lambda ax: ax.plot([0, 1]))[:4]
    '<svg'
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    from stickslip.show.figures import publication

    with publication():
        mpl.rcParams.update({"svg.fonttype": "path", "svg.hashsalt": salt})
        figure = Figure(figsize=(width, height), layout=layout)
        draw(figure.subplots())
        laid_out(figure)
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None, "Type": None, "Format": None}, dpi=200)
    return text.getvalue()[text.getvalue().index("<svg") :]
