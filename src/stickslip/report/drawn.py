"""Pictures as SVG text for a page."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any

__all__ = ["svg"]


def svg(draw: Callable[[Any], Any], width: float = 4.2, height: float = 2.6) -> str:
    """One picture as SVG text; letters become paths, so that it looks the same everywhere.

    Parameters
    ----------
    draw : callable
        Called with matplotlib axes.
    width, height : float
        Size [inch].

    Examples
    --------
    >>> svg(lambda ax: ax.plot([0, 1]))[:5]
    '<?xml'
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    from stickslip.plot import publication

    with publication():
        mpl.rcParams.update({"svg.fonttype": "path", "svg.hashsalt": "report"})
        figure = Figure(figsize=(width, height))
        draw(figure.subplots())
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None}, dpi=200)
    return text.getvalue()
