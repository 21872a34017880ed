"""The fit of a log as the page shows it: everything of `LogFit`, as words, tables and pictures."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.inverse.identification.fit_text import (
    cost_lines,
    input_lines,
    known_line,
    parameter_rows,
    sensor_lines,
    stated,
)
from stickslip.inverse.logs.log_fit import label_of, over_motor_constant
from stickslip.show.reports.log_figures import MOST_DRAWN, figures_of

if TYPE_CHECKING:
    from stickslip.inverse.identification.fit import Fit
    from stickslip.inverse.logs import LogFit

_WIDTH, _HEIGHT = 4.3, 2.9  # of a picture [inch]: letters of seven points are readable on a phone


def result_of(made: LogFit) -> dict[str, Any]:
    """The response with a fit.

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> t = np.arange(0, 4, 0.005)
    >>> F = 2.0 * np.sign(np.cos(3 * t)) + np.random.default_rng(0).normal(0, 0.05, len(t))
    >>> shown = result_of(ss.fit({"time_s": t, "pos_mm": 5.0 * np.sin(3 * t), "F_N": F}, law="coulomb", starts=2))
    >>> shown["verdict"], [row["name"] for row in shown["rows"]], [picture["heading"] for picture in shown["pictures"]][1]
    ('coulomb is supported: what is left is noise', ['mu'], 'Friction against velocity')
    """
    fit = made.fit
    shown = {
        "machine": made.machine, "law": made.law, "class": fit.law, "supported": made.supported, "verdict": made.verdict,
        "rows": _rows(fit), "given": known_line(fit), "effects": [*sensor_lines(fit), *cost_lines(fit), *input_lines(fit)],
        "ranking": _ranking(made), "symmetry": [*map(str, made.symmetry)], "undetermined": list(fit.undetermined),
        "next": list(made.next), "questions": list(made.questions), "warnings": list(fit.warnings), "quality": _quality(fit),
    }  # fmt: skip
    words = _in_amperes(shown) if made.in_amperes else shown
    return {"kind": "fit", **words, "python": made.python, "pictures": _pictures(fit), "report": _report(made)}


def _rows(fit: Fit) -> list[dict[str, Any]]:
    """The parameters, each as it is stated, and with what it is."""
    lost, rows = fit.undetermined, parameter_rows(fit)
    return [row | {"stated": stated(fit, row), "label": label_of(fit, row["name"]), "lost": row["name"] in lost} for row in rows]


def _ranking(made: LogFit) -> list[dict[str, Any]]:
    """The laws that were compared, the best first, each with why it is not supported, if it is not."""
    if made.ranking is None:
        return []
    return [{"law": row.label, "aicc": f"{row.aicc:.1f}", "faults": list(row.faults)} for row in made.ranking.rows]


def _quality(fit: Fit) -> list[str]:
    if all(q.kind == "mean" for q in fit.quality):
        return [f"{len(fit.quality)} mean velocities: the largest residual is {max(q.rms for q in fit.quality):.3g} m/s"]
    return [f"{q.label}, {q.kind}: what is left has an rms of {q.rms:.3g} {q.unit}, of {fit.count} values" for q in fit.quality]


def _in_amperes(shown: Any) -> Any:
    """Everything with currents where torques over a motor constant of 1 stand."""
    if isinstance(shown, str):
        return over_motor_constant(shown)
    if isinstance(shown, list):
        return [_in_amperes(each) for each in shown]
    return {name: _in_amperes(each) for name, each in shown.items()} if isinstance(shown, dict) else shown


def _pictures(fit: Fit) -> list[dict[str, str]]:
    """Curve, friction against velocity and residuals of each record, of many the first ones, as SVG."""
    from stickslip.show import figures
    from stickslip.show.reports.drawn import svg

    drawn, files = [], _drawn_records(fit)
    for name, heading in figures_of(fit).values():
        draw: Callable[..., Any] = getattr(figures, name)
        for record, file in files.items():
            picture = svg(partial(_on, draw, fit, record), _WIDTH, _HEIGHT, f"{name}{record}", layout="constrained")
            drawn.append({"heading": f"{heading}: {file}" if len(files) > 1 else heading, "svg": picture})
    return drawn


def _drawn_records(fit: Fit) -> dict[int, str]:
    """The records that have pictures of their own, with the names of their files; mean velocities are all in one."""
    if all(t.kind == "mean" for t in fit.problem.targets):
        return {0: ""}
    return {i: str(record.source["path"]) for i, record in enumerate(fit.records[:MOST_DRAWN])}


def _on(draw: Callable[..., Any], fit: Fit, record: int, ax: Any) -> None:
    draw(fit, record, ax=ax)


def _report(made: LogFit) -> str:
    """The report as one HTML page."""
    with tempfile.TemporaryDirectory() as folder:
        return Path(made.report(Path(folder) / "report.html")).read_text(encoding="utf-8")
