"""Figures of reliability: methods against a reference, laws against data, planned experiments."""

from __future__ import annotations

import math
import textwrap
from typing import Any

import numpy as np

from stickslip.analysis.checking import Check, Judge
from stickslip.analysis.flow_check import FlowCheck, FlowJudge
from stickslip.basics.arguments import Ax
from stickslip.basics.errors import InputError
from stickslip.inverse.identification.designing import Design
from stickslip.inverse.identification.ranking import Ranking
from stickslip.show.figures.style import COLOURS, INK, SHADE, axes, drawing, legend_above, name_rows

_SAME = 1e-17  # relative difference at which a difference of 0 is drawn
_APART = 4.0  # difference of AICc below which the data do not distinguish two laws
_DETERMINED = 25.0  # per cent: a parameter with a smaller error counts as determined
_ACROSS = 26  # number of letters of an experiment's name in a line
_SHOWN = 8  # largest number of experiments shown
_LEAST, _MOST = 1e-3, 1e3  # per cent: errors are clipped to this range


@drawing
def check(check: Check | FlowCheck, ax: Ax = None) -> Any:
    """Distance of each method's mean velocity, of a flow of its states at the end, from the reference, on a logarithmic axis.

    Methods that were skipped or failed are left out.

    Parameters
    ----------
    check : Check or FlowCheck
        From `stickslip.check`.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb-static")
    >>> ax = ss.plot.check(ss.check(robot, periods=100, rk4_steps=(2000,)))
    >>> ax.get_xlabel()
    'difference in mean velocity (m/s)'
    """
    every: tuple[Judge | FlowJudge, ...] = check.judges
    judges = [judge for judge in reversed(every) if math.isfinite(judge.difference)]
    if not judges:
        raise InputError("plot", ["no method could be compared with another; print(check) says why"])
    floor = _SAME * check.size
    ax = axes(ax, 0.9 + 0.3 * len(judges))
    if check.uncertainty > 0:
        ax.axvspan(floor / 3, check.uncertainty, color=SHADE, linewidth=0, zorder=0, label="uncertainty")
    for counts, colour, marker, word in ((True, COLOURS[0], "o", "counts"), (False, COLOURS[1], "s", "does not count")):
        places = [i for i, judge in enumerate(judges) if judge.counts == counts]
        x = [max(abs(judges[i].difference), floor) for i in places]
        if places:
            ax.plot(x, places, marker, color=colour, markersize=5, linewidth=0, label=word, zorder=3, clip_on=False)
    for i, judge in enumerate(judges):
        if judge.difference == 0:
            ax.annotate("none", (floor, i), (5, 0), textcoords="offset points", va="center", fontsize=7, color=INK)
    ax.set_xscale("log")
    ax.set_xlim(left=floor / 3)
    name_rows(ax, [f"{judge.name}\n{judge.setting}" for judge in judges], 0.6)
    ax.set_xlabel(f"difference in {check.compared}")
    legend_above(ax, ncols=3, columnspacing=1.2)
    return ax


@drawing
def ranking(ranking: Ranking, ax: Ax = None) -> Any:
    """A bar for each law: the excess of its AICc over the smallest one. Laws in the grey band cannot be distinguished.

    Laws that the data support are filled; those that they do not support are hollow. A cross marks the BIC.

    Parameters
    ----------
    ranking : Ranking
        From `stickslip.identification.rank`.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> rec = ss.virtual_rig(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4), noise=1e-4, seed=1)
    >>> both = {law: ss.identify(rec, ss.presets.piezo_rig, free={"mu0": (0.05, 0.2)}, tilt_deg=1.7, amplitude=6e-4, law=law)
    ...         for law in ("coulomb", "lugre")}
    >>> [label.get_text() for label in ss.plot.ranking(ss.identification.rank(both)).get_yticklabels()]
    ['coulomb', 'lugre']
    """
    laws = list(reversed(ranking.rows))
    finite = [value for row in laws for value in (row.aicc, row.bic) if math.isfinite(value)]
    end = 1.5 * max([2 * _APART, *finite])
    ax = axes(ax, 0.9 + 0.28 * len(laws))
    ax.axvspan(0.0, _APART, color=SHADE, linewidth=0, zorder=0, label="too close to decide")
    for supported, style, word in (
        (True, {"color": COLOURS[0]}, "supported"),
        (False, {"facecolor": "white", "edgecolor": COLOURS[1], "linewidth": 0.9}, "not supported"),
    ):
        places = [i for i, row in enumerate(laws) if (row.label in ranking.supported) == supported]
        if places:
            lengths = [min(laws[i].aicc, end) if laws[i].aicc > 0 else 0.0 for i in places]
            ax.barh(places, lengths, 0.5, label=word, zorder=2, **style)
            ax.plot([0.0] * len(places), places, "|", color=COLOURS[0] if supported else COLOURS[1], markersize=12, zorder=3)
    ax.plot([min(row.bic, end) for row in laws], range(len(laws)), "x", color=INK, markersize=4, linewidth=0, label="ΔBIC", zorder=4)
    ax.set_xscale("symlog", linthresh=_APART)
    ax.set_xticks([0.0, *(10.0**k for k in range(1, math.ceil(math.log10(end))))])
    ax.minorticks_off()
    ax.set_xlim(-0.3, end)
    name_rows(ax, [row.label for row in laws], 0.6)
    ax.set_xlabel("ΔAICc above the best law")
    legend_above(ax, ncols=2, columnspacing=1.0, handlelength=1.2)
    return ax


@drawing
def design(design: Design, ax: Ax = None) -> Any:
    """The expected standard error of each parameter for the best experiments, the best on top.

    Parameters at the right edge are not determined at all. In the grey band a parameter is known to within a quarter of its value.

    Parameters
    ----------
    design : stickslip.inverse.identification.Design
        From `stickslip.identification.design`.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> plan = ss.identification.design(ss.presets.piezo_rig, free={"mu0": 0.18, "sigma0": 4e5}, experiments={"amplitude": [4e-4, 8e-4]},
    ...                  noise=1e-3, samples=200, tilt_deg=1.7)
    >>> ss.plot.design(plan).get_xlabel()
    'expected error (% of the value)'
    """
    shown = list(reversed(design.experiments[:_SHOWN]))
    rows = [textwrap.fill(e.words, _ACROSS) for e in shown]
    ax = axes(ax, 1.0 + 0.26 * len(shown) + 0.13 * sum(row.count("\n") for row in rows))
    ax.axvspan(_LEAST / 10, _DETERMINED, color=SHADE, linewidth=0, zorder=0, label="determined")
    everything: list[float] = []
    for k, (name, value) in enumerate(design.values.items()):
        errors = np.array([e.errors[name] for e in shown]) * (100 / abs(value) if value else math.inf)
        x = np.clip(np.nan_to_num(errors, nan=_MOST, posinf=_MOST), _LEAST, _MOST)
        everything += list(x)
        marker = "osD^vPX"[k % 7]
        ax.plot(x, range(len(shown)), marker, color=COLOURS[k % 7], markersize=4.5, label=name, linewidth=0, zorder=3, clip_on=False)
    ax.set_xscale("log")
    ax.set_xlim(0.5 * min(everything), max(2 * max(everything), 2 * _DETERMINED) if max(everything) < _MOST else _MOST)
    name_rows(ax, rows, 0.6)
    ax.set_xlabel("expected error (% of the value)")
    legend_above(ax, ncols=3, columnspacing=1.0, handlelength=1.2)
    return ax
