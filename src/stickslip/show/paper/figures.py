"""Figures 6 to 30 as the paper draws them: time history, and phase portrait with the drift removed."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from stickslip.show.figures.style import INK, SHADE, legend_above
from stickslip.show.paper.amplitudes import ROUNDING
from stickslip.show.paper.borders import FOUR
from stickslip.show.paper.cases import CASES, EXPERIMENTS, FAST_FIGURES, Case, PrintedExperiment
from stickslip.show.paper.drawing import COULOMB, LUGRE, MEASURED, Picture, render, sampled_motion, shade_rest
from stickslip.show.paper.section5_motions import FigureMotion
from stickslip.show.paper.solved_runs import Runs, Tell
from stickslip.show.paper.table import TableRow
from stickslip.show.paper.words import millimetres, power

__all__ = ["draw"]

PERIODS = 3


def draw(
    runs: Runs, table: tuple[TableRow, ...], judged: dict[int, FigureMotion], folder: Path, fast: bool, tell: Tell
) -> tuple[Picture, ...]:
    """Draw every figure of sections 4 and 5 (the fast subset: some of them)."""
    rows = {r.experiment.figure: r for r in table}
    jobs: dict[int, Any] = {6: partial(_four_types, runs, table)}
    jobs |= {e.figure: partial(_experiment, runs, rows[e.figure]) for e in EXPERIMENTS}
    jobs |= {c.figure: partial(_case, runs, c, judged[c.figure]) for c in CASES}
    wanted = [n for n in sorted(jobs) if not fast or n in FAST_FIGURES]
    pictures = []
    for i, number in enumerate(wanted):
        tell(f"drawing Figure {number}", i, len(wanted))
        pictures.append(jobs[number](folder))
    tell("drawing figures", len(wanted), len(wanted))
    return tuple(pictures)


# ---- Figure 6 ----
def _four_types(runs: Runs, table: tuple[TableRow, ...], folder: Path) -> Picture:
    order = sorted(table, key=lambda r: FOUR.index(r.type))
    return render(
        folder,
        "figure-06",
        [partial(_exact_panel, runs.coulomb[r.experiment.name], r) for r in order],
        height=1.9,
        each=[{"r": r} for r in order],
    )


def _exact_panel(run: Any, row: TableRow, ax: Any) -> None:
    motion_curve = sampled_motion(run, PERIODS)
    shade_rest(ax, motion_curve["rest"])
    ax.axhline(0.0, color=INK, linewidth=0.5, zorder=1)
    ax.plot(motion_curve["phase"], 1e3 * motion_curve["v"], color=COULOMB["color"], linewidth=1.2)
    ax.set_title(f"type {row.type}: tilt {row.experiment.tilt_deg}°, $A$ = {millimetres(row.experiment.amplitude)}", loc="left")
    _time_axis(ax, "velocity $v$ (mm/s)")


def _time_axis(ax: Any, label: str, periods: int = PERIODS) -> None:
    ax.set(xlim=(0, periods), xticks=range(periods + 1), xlabel="time $t/T$ (drive periods)", ylabel=label)


# ---- Figures 7 to 10 ----
def _experiment(runs: Runs, row: TableRow, folder: Path) -> Picture:
    e, panels = row.experiment, [partial(_velocities, runs, row.experiment), partial(_levels, row)]
    rests = [b for _, b, sign in row.intervals if sign == 0]  # the shortest ones are invisible
    return render(folder, f"figure-{e.figure:02}", panels, height=2.5, text="experiment", e=e, row=row, rests=rests)


def _velocities(runs: Runs, e: PrintedExperiment, ax: Any) -> None:
    exact, bristles = sampled_motion(runs.coulomb[e.name], PERIODS), sampled_motion(runs.lugre[e.name], PERIODS)
    shade_rest(ax, exact["rest"])
    ax.axhline(0.0, color=INK, linewidth=0.5, zorder=1)
    ax.plot(bristles["phase"], 1e3 * bristles["v"], **LUGRE, label="LuGre", zorder=3)
    ax.plot(exact["phase"], 1e3 * exact["v"], **COULOMB, label="Coulomb", zorder=4)
    ax.plot([0.0, 0.09], [1e3 * e.measured] * 2, **{**MEASURED, "linewidth": 2.2}, label="measured mean, printed", zorder=5)
    _time_axis(ax, "velocity $v$ (mm/s)")
    handles, labels = ax.get_legend_handles_labels()
    order = [labels.index(n) for n in ("Coulomb", "LuGre", "measured mean, printed")]
    legend_above(
        ax, [handles[i] for i in order], [labels[i] for i in order], ncols=3, columnspacing=0.8, handlelength=1.7, handletextpad=0.5
    )


def _levels(row: TableRow, ax: Any) -> None:
    """Mean velocities, a row for each: squares are printed values with half a digit on either side, circles are computed here."""
    from matplotlib.lines import Line2D

    e = row.experiment
    rows = (
        ("LuGre", e.lugre, row.lugre, LUGRE["color"]),
        ("Coulomb", e.coulomb, row.coulomb, COULOMB["color"]),
        ("measured", e.measured, None, MEASURED["color"]),
    )
    for height, (_, printed, computed, colour) in enumerate(rows):
        ax.axhline(height, color=SHADE, linewidth=0.6, zorder=0)
        ax.errorbar(
            1e3 * printed, height, xerr=1e3 * ROUNDING, fmt="s", color=colour, markerfacecolor="white", markersize=5, capsize=2.5,
            linewidth=1,
        )  # fmt: skip
        ax.text(1e3 * printed, height + 0.22, f"{1e3 * printed:.1f}", color=colour, ha="center", va="bottom", fontsize=7)
        if computed is not None:
            ax.plot(1e3 * computed, height, "o", color=colour, markersize=4.5, zorder=5)
            ax.text(1e3 * computed, height - 0.22, f"{1e3 * computed:.3f}", color=colour, ha="center", va="top", fontsize=7)
    ax.set_yticks(range(len(rows)), [name for name, *_ in rows])
    ax.tick_params(axis="y", length=0)
    ax.set(xlabel="mean velocity (mm/s)", ylim=(-0.65, len(rows) - 0.35))
    ax.margins(x=0.14)
    ax.spines["left"].set_visible(False)
    marks = [
        Line2D([], [], marker="s", color=INK, markerfacecolor="white", markersize=5, linewidth=1, label="printed, ± half a digit"),
        Line2D([], [], marker="o", color=INK, markersize=4.5, linewidth=0, label="computed here"),
    ]
    legend_above(ax, handles=marks, ncols=2, columnspacing=0.9, handlelength=1.7, handletextpad=0.5)


# ---- Figures 11 to 30 ----
def _scale(run: Any) -> tuple[float, float]:
    return float(run.model.drive.amplitude), float(run.model.velocity_scale)


def _presliding(run: Any) -> bool:
    from stickslip.analysis.motion import motion

    return motion(run).type in ("rest", "presliding")


def _case(runs: Runs, case: Case, judged: FigureMotion, folder: Path) -> Picture:
    from stickslip.analysis.motion import motion
    from stickslip.analysis.steady import mean_velocity

    run, twin = runs.figures[case.figure], motion(runs.twins[case.figure]).type
    label = motion(run)
    periods = 4 if (label.period or 1) > 1 else PERIODS
    motion_curve = sampled_motion(run, periods)
    presliding, scale = _presliding(run), _scale(run)[1]
    return render(
        folder,
        f"figure-{case.figure:02}",
        [partial(_history, run, motion_curve, periods), partial(_portrait, run, motion_curve)],
        text="case",
        case=case,
        judged=judged,
        word=label.type,
        velocity=mean_velocity(run),
        twin=twin,
        presliding=presliding,
        periods=periods,
        v=motion_curve["v"],
        scale=scale,
        points=len(set(np.round(motion_curve["strobe_v"] / scale, 6))),
    )


def _history(run: Any, motion_curve: dict[str, Any], periods: int, ax: Any) -> None:
    shade_rest(ax, motion_curve["rest"])
    ax.axhline(0.0, color=INK, linewidth=0.5, zorder=1)
    ax.plot(motion_curve["phase"], motion_curve["v"] / _scale(run)[1], color=LUGRE["color"], linewidth=1.1)
    _time_axis(ax, "velocity $v/(A\\omega)$", periods)
    _powers(ax.yaxis)


def _powers(axis: Any) -> None:
    """Format small numbers with a common power of ten at the end of the axis, in plain text: formulas are slow to typeset."""
    from matplotlib.ticker import ScalarFormatter

    class Powers(ScalarFormatter):
        def get_offset(self) -> str:
            exponent = super().get_offset().replace("−", "-").partition("e")[2]  # of 1e-3
            return f"×{power(int(exponent))}" if exponent else ""

    made = Powers()
    made.set_powerlimits((-3, 3))
    axis.set_major_formatter(made)


def _portrait(run: Any, motion_curve: dict[str, Any], ax: Any) -> None:
    A, scale = _scale(run)
    ax.axhline(0.0, color=INK, linewidth=0.5, zorder=1)
    ax.plot(motion_curve["s"] / A, motion_curve["v"] / scale, color=LUGRE["color"], linewidth=1.1)
    dots: dict[str, Any] = {"color": "#D55E00", "markersize": 3.5, "markeredgecolor": "white", "markeredgewidth": 0.5}
    ax.plot(motion_curve["strobe_s"] / A, motion_curve["strobe_v"] / scale, "o", zorder=5, **dots)
    ax.set(xlabel="displacement without drift $(x - Vt)/A$", ylabel="velocity $v/(A\\omega)$")
    ax.locator_params(axis="x", nbins=5)
    _powers(ax.xaxis)
    _powers(ax.yaxis)
