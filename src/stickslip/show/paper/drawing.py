"""Drawing of the paper's figures: panels side by side in a file, and individually in the report."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.basics.whole_files import unwritable, write_whole
from stickslip.show.figures.style import SHADE, WIDTH, publication
from stickslip.show.paper.sentences import filled, texts
from stickslip.show.reports.drawn import laid_out, svg

__all__ = ["COULOMB", "LUGRE", "MEASURED", "Picture", "render", "sampled_motion", "shade_rest"]

Panel = Callable[[Any], None]

#: Colours and dashes of the laws: dotted and dashed as in the paper.
COULOMB: dict[str, Any] = {"color": "#D55E00", "linestyle": (0, (1, 1.1)), "linewidth": 1.5}
LUGRE: dict[str, Any] = {"color": "#0072B2", "linestyle": (0, (5, 1.6)), "linewidth": 1.2}
MEASURED: dict[str, Any] = {"color": "#000000", "linestyle": "-", "linewidth": 0.9}


@dataclass(frozen=True, eq=False)
class Picture:
    """A finished figure.

    Parameters
    ----------
    key : str
        Name of its files.
    title, caption : str
    alts : tuple of str
        A text alternative for each panel.
    section : str
        Section of the paper, or "evidence".
    files : tuple of Path
        PNG and SVG.
    panels : tuple of str
        Each panel as SVG text.
    """

    key: str
    title: str
    caption: str
    alts: tuple[str, ...]
    section: str
    files: tuple[Path, ...]
    panels: tuple[str, ...]


def render(
    folder: Path, key: str, panels: Sequence[Panel], height: float = 2.2, columns: int = 2, text: str = "",
    each: Sequence[dict[str, Any]] = (), **values: Any,
) -> Picture:  # fmt: skip
    """Draw panels side by side into PNG and SVG files, and singly for the report; the texts are those of `key`, or of `text` if given.

    Its text alternatives are a list with one for each panel, or one that is filled with the values of `each` panel.
    """
    from matplotlib.figure import Figure

    with publication():
        import matplotlib as mpl

        mpl.rcParams.update({"svg.fonttype": "path", "svg.hashsalt": key})
        rows = -(-len(panels) // columns)
        whole = Figure(figsize=(WIDTH * min(columns, len(panels)), height * rows))
        for position, draw in enumerate(panels, start=1):
            draw(whole.add_subplot(rows, min(columns, len(panels)), position))
        laid_out(whole)  # for both files
        files = tuple(folder / f"{key}.{kind}" for kind in ("png", "svg"))
        for file in files:
            drawn = io.BytesIO()
            whole.savefig(drawn, format=file.suffix[1:], metadata={"Date": None} if file.suffix == ".svg" else {})
            write_whole(file, drawn.getvalue(), unwritable("reproduce"))
        alone = tuple(svg(draw, WIDTH, height, f"{key}-{i}") for i, draw in enumerate(panels))
        words = dict(texts("pictures")[text or key])
        alt = words.pop("alt")
        alts = alt if isinstance(alt, list) else [alt] * len(panels)
        own = each or [{}] * len(panels)
        alternatives = tuple(filled(one, values | mine) for one, mine in zip(alts, own, strict=True))
        return Picture(key=key, files=files, panels=alone, alts=alternatives, **filled(words, values))


def sampled_motion(run: Any, periods: int, points: int = 900) -> dict[str, Any]:
    """The motion over the last drive periods of a run, sampled evenly and at each event; `phase` counts drive periods."""
    start, end = (float(run.strobe_times[i]) for i in (-1 - periods, -1))
    events = [e.t for e in run.events if start < e.t < end]
    samples = run.at(np.unique(np.concatenate([np.linspace(start, end, points), events])))
    drift = (samples["x"][-1] - samples["x"][0]) / (end - start)
    swing = samples["x"] - drift * (samples["t"] - start)
    strobe = run.at(run.strobe_times[-1 - periods : -1])
    middle = 0.5 * (swing.max() + swing.min())
    return {
        "phase": (samples["t"] - start) / run.period_time,
        "v": samples["v"],
        "s": swing - middle,
        "strobe_v": strobe["v"],
        "strobe_s": strobe["x"] - drift * (strobe["t"] - start) - middle,
        "rest": _rests(run, periods),
    }


def _rests(run: Any, periods: int) -> list[tuple[float, float]]:
    """Intervals of rest of the body, in drive periods from the start of the curve: exact, or by the rule for LuGre labels."""
    from stickslip.analysis.motion import motion

    judged = motion(run)
    if judged.type in ("rest", "presliding"):
        return []
    count, rests = judged.period or 1, []
    for first in range(periods % count - count, periods, count):
        rests += [(first + a, first + a + b) for a, b, sign in judged.intervals if sign == 0]
        rests += [(first - count + a, first - count + a + b) for a, b, sign in judged.intervals if sign == 0 and a + b > count]
    return [(max(a, 0.0), min(b, float(periods))) for a, b in rests if b > 0 and a < periods]


def shade_rest(ax: Any, rests: list[tuple[float, float]], factor: float = 1.0) -> None:
    """Shade the intervals of rest."""
    for a, b in rests:
        ax.axvspan(a * factor, b * factor, color=SHADE, linewidth=0, zorder=0)
