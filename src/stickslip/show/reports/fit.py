"""A fit or a comparison as a picture, and as one offline HTML page."""

from __future__ import annotations

import platform
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stickslip.inverse.identification.fit import Fit
    from stickslip.records.record import Record


_SHOWN = 8  # records with pictures of their own


def write_report(path: str | Path, fits: list[Any], comparison: Any = None, ranking: Any = None) -> Path:
    """Write one HTML file with data, fits, residuals, uncertainties, ranking and provenance, the records' included; returns its path.

    Parameters
    ----------
    path : str or Path
    fits : list of Fit
    comparison : Comparison, optional
    ranking : Ranking, optional
    """
    from stickslip import __version__
    from stickslip.show import reports as report

    made = report.page(
        "identification.html",
        title="Friction from measured records" if fits else "Record and friction laws",
        synthetic=any("synthetic" in note for fit in fits for note in fit.notes)
        or bool(comparison and any("synthetic" in n for n in comparison.notes)),
        fits=[_facts(fit) for fit in fits],
        comparison=None
        if comparison is None
        else {
            "rows": comparison.to_table(),
            "unit": {"velocity": "m/s"}.get(comparison.kind, "m"),
            "notes": comparison.notes,
            "picture": _drawn(comparison.plot, "comparison"),
            "text": str(comparison),
        },
        ranking=None
        if ranking is None
        else {"rows": ranking.rows, "verdict": ranking.reason, "effective": ranking.effective, "count": ranking.count},
        sources=_sources(fits, comparison),
        provenance={"stickslip": __version__, "Python": platform.python_version(), "system": platform.platform()},
    )
    return report.write(path, made)


def _facts(fit: Fit) -> dict[str, Any]:
    from stickslip.inverse.identification.fit_text import cost_lines, input_lines, known_line, parameter_rows, sensor_lines
    from stickslip.show import figures as plot

    free, lost = {f.name: f for f in fit.problem.parameters.free}, fit.undetermined
    none = {"low": "–", "high": "–"}
    rows = [row | (none if row["name"] in lost else {}) | {"bound": free[row["name"]]} for row in parameter_rows(fit)]
    pictures = []
    for i in range(min(len(fit.problem.targets), _SHOWN)):
        if fit.problem.targets[i].kind == "mean" and i > 0:
            continue
        drawn = (_drawn(partial(plot.fitted, fit, i), f"fitted {i}"), _drawn(partial(plot.residuals, fit, i), f"residuals {i}"))
        pictures.append((*drawn, fit.quality[i], fit.quality[i].unit))
    table, symmetry = fit.correlations.tolist(), [f"symmetry: {each}" for each in fit.symmetry]
    return {
        "law": fit.law, "rows": rows, "quality": fit.quality, "warnings": fit.warnings, "pictures": pictures, "names": fit.names,
        "given": known_line(fit), "sensor": [*sensor_lines(fit), *cost_lines(fit), *input_lines(fit), *symmetry],
        "correlations": table, "count": fit.count, "starts": fit.starts, "agree": fit.agree, "provenance": fit.provenance,
    }  # fmt: skip


def _sources(fits: list[Any], comparison: Any) -> list[dict[str, Any]]:
    """Every record behind these results once, by its number."""
    measured = [(i, rec) for fit in fits for i, rec in enumerate(fit.records)]
    measured += [] if comparison is None else [(0, comparison.source)]
    once = {id(rec): (i, rec) for i, rec in measured if hasattr(rec, "channels")}
    return [_source(i, rec) for i, rec in once.values()]


def _source(number: int, rec: Record) -> dict[str, Any]:
    source = {k: v for k, v in rec.source.items() if k in ("path", "format", "bytes", "sha256", "dialect")}
    if "between" in rec.source:
        source["part"] = "{:g} to {:g} s".format(*rec.source["between"])
    return {"number": number, "summary": str(rec.summary), "source": source}


def _drawn(draw: Callable[[Any], Any], salt: str) -> str:
    """The drawing of `draw` on the axes, as SVG."""
    from stickslip.show.figures.style import WIDTH
    from stickslip.show.reports.drawn import svg

    return svg(draw, 1.3 * WIDTH, 2.5, salt, layout="constrained")
