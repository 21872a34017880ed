"""Figures of the bench: all experiments on one law, or several laws side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.analysis.bench import Bench, Benches
from stickslip.basics.arguments import Page
from stickslip.basics.contracts import ArrayLike
from stickslip.basics.errors import InputError
from stickslip.show.figures.style import COLOURS, DASHES, INK, drawing, prefix

if TYPE_CHECKING:
    from matplotlib.axes import Axes


#: Quantities listed in the last panel, if available.
_QUANTITIES = (
    "slow_forward", "slow_backward", "fall", "lag", "stiffness", "gap", "loss_share", "loss_exponent", "breakaway_slow", "breakaway_fast",
    "stick_slip", "stick_slip_period", "peak_velocity", "drift",
)  # fmt: skip
#: Experiments of the overview; drift is given as a number, because it spans many decades.
_COLUMNS = ("steady", "lag", "hysteresis", "dissipation", "breakaway", "stick_slip")


@drawing
def bench(bench: Bench | Benches, figure: Page = None) -> Any:
    """The figure of a bench: a panel for each experiment and one for the numbers; for several laws, a row of panels for each law.

    Parameters
    ----------
    bench : Bench or Benches
        From `stickslip.bench`.
    figure : matplotlib Figure or SubFigure, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Figure

    Examples
    --------
    >>> import stickslip as ss
    >>> bench = ss.bench(ss.Coulomb(mu_plus=0.15, mu_minus=0.21, f_plus=0.18, f_minus=0.24))
    >>> len(ss.plot.bench(bench).axes)
    8
    """
    if isinstance(bench, Bench):
        return _one(bench, figure)
    if isinstance(bench, Benches):
        return _many(bench, figure)
    raise InputError("plot", [f"{bench!r} is not a bench; allowed is what ss.bench returns; type ss.plot.bench(ss.bench(ss.LuGre))"])


def _figure(width: float, height: float) -> Any:
    import matplotlib.pyplot as plt

    return plt.figure(figsize=(width, height), layout="constrained")


def _one(bench: Bench, figure: Any) -> Any:
    rows, columns = (2, 4) if len(bench.experiments) > 3 else (1, len(bench.experiments) + 1)
    figure = figure or _figure(2.45 * columns, 2.25 * rows)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for ax, experiment in zip(panels, bench.experiments, strict=False):
        _draw(ax, experiment)
    for ax in panels[len(bench.experiments) + 1 :]:
        ax.set_axis_off()
    _numbers(panels[len(bench.experiments)], bench)
    figure.suptitle(f"{bench.name}   (load {bench.load:g} N, mass {bench.mass:g} kg)", fontsize=9)
    return figure


def _draw(ax: Any, experiment: Any, small: bool = False) -> None:
    """Draw one experiment; linear axes have units with SI prefixes."""
    across, x_prefix = (1.0, "") if "x" in experiment.logarithmic else prefix(*(c.x for c in experiment.curves))
    up, y_prefix = (1.0, "") if "y" in experiment.logarithmic else prefix(*(_finite(c.y) for c in experiment.curves))
    for i, curve in enumerate(experiment.curves):
        x, y = across * np.asarray(curve.x, float), up * np.asarray(curve.y, float)
        style: dict[str, Any] = {"color": COLOURS[i % 7], "linestyle": DASHES[i % 7], "label": curve.name}
        if "y" in experiment.logarithmic:
            y = np.where(y > 0, y, np.nan)
        if len(x) <= 10 and experiment.logarithmic and (i == 0 or experiment.key == "steady"):
            style |= {"marker": "o", "markersize": 2.4}
        if curve.name == "at rest":
            style |= {"linestyle": "none", "markersize": 3.2, "markerfacecolor": "white", "clip_on": False}
        ax.plot(x, y, linewidth=0.9, zorder=3 - (i if experiment.key == "stick_slip" else -i), **style)
    _scales(ax, experiment)
    if small:
        return
    ax.set_title(experiment.title)
    ax.set_xlabel(f"{experiment.x[0]} ({x_prefix}{experiment.x[1]})")
    ax.set_ylabel(f"{experiment.y[0]} ({y_prefix}{experiment.y[1]})")
    if len(experiment.curves) > 1:
        if experiment.key == "stick_slip":  # room above the peaks
            ax.set_ylim(top=ax.get_ylim()[0] + 1.25 * (ax.get_ylim()[1] - ax.get_ylim()[0]))
        corner = {"stick_slip": "upper right", "steady": "lower left"}.get(experiment.key, "best")
        ax.legend(loc=corner, fontsize=6, handlelength=1.9, borderaxespad=0.2, ncols=2 if experiment.key == "stick_slip" else 1)


def _finite(y: ArrayLike) -> Any:
    y = np.asarray(y, float)
    return y[np.isfinite(y)]


def _scales(ax: Axes, experiment: Any) -> None:
    """Logarithmic axes where requested, and a y axis on which a constant looks constant."""
    if "x" in experiment.logarithmic:
        from matplotlib.ticker import NullFormatter

        ax.set_xscale("log")
        ax.xaxis.set_minor_formatter(NullFormatter())
    if "y" in experiment.logarithmic:
        ax.set_yscale("log")
    if experiment.key in ("steady", "breakaway"):
        ax.set_ylim(0.0, 1.25 * float(ax.dataLim.y1) if ax.dataLim.y1 > 0 else 1.0)
    if experiment.key in ("hysteresis", "stick_slip", "drift"):
        ax.axhline(0.0, color=INK, linewidth=0.4, zorder=1)
    if experiment.key in ("lag", "drift"):
        _no_noise(ax)


def _no_noise(ax: Axes) -> None:
    """Draw a variation below rounding as a flat line."""
    low, high = float(ax.dataLim.y0), float(ax.dataLim.y1)
    size = max(abs(low), abs(high))
    if high - low < 1e-6 * size or size == 0:
        ax.set_ylim(*((low - 0.5 * size, high + 0.5 * size) if size else (-1.0, 1.0)))


def _numbers(ax: Axes, bench: Bench) -> None:
    """Names and values in two columns of text."""
    ax.set_axis_off()
    quantities = [q for q in bench.quantities if q.key in _QUANTITIES]
    for i, quantity in enumerate(quantities):
        y = 0.98 - i * 0.97 / len(_QUANTITIES)
        ax.text(-0.02, y, quantity.label, transform=ax.transAxes, fontsize=6.3, va="center")
        ax.text(1.04, y, _short(quantity), transform=ax.transAxes, fontsize=6.3, va="center", ha="right")


def _short(quantity: Any) -> str:
    """A value with an SI prefix."""
    value = quantity.value
    if isinstance(value, bool) or not np.isfinite(value) or not quantity.unit:
        return quantity.text(3)
    factor, letter = prefix(value)
    return f"{factor * value:.3g} {letter}{quantity.unit}".replace("-", "\N{MINUS SIGN}") if abs(value) > 1e-14 else f"0 {quantity.unit}"


def _many(benches: Benches, figure: Any) -> Any:
    """A row of small panels for each law."""
    shown = [key for key in _COLUMNS if any(e.key == key for e in benches.benches[0].experiments)]
    figure = figure or _figure(1.75 * (len(shown) + 0.9), 0.5 + 1.0 * len(benches))
    panels = figure.subplots(len(benches), len(shown) + 1, squeeze=False, width_ratios=[0.75, *([1.0] * len(shown))])
    for row, one in zip(panels, benches, strict=True):
        _name(row[0], one)
        for ax, key in zip(row[1:], shown, strict=True):
            _draw(ax, one[key], small=True)
            _sparse(ax, one[key])
    for ax, key in zip(panels[0][1:], shown, strict=True):
        ax.set_title(_heading(benches.benches[0][key]), fontsize=7)
    return figure


def _name(ax: Axes, bench: Bench) -> None:
    """The law's name, and its drift."""
    ax.set_axis_off()
    drift = next((q for q in bench.quantities if q.key == "drift"), None)
    ax.text(0.0, 0.62, bench.name, transform=ax.transAxes, fontsize=8, fontweight="bold")
    if drift is not None:
        ax.text(0.0, 0.3, f"drift {_short(drift)}", transform=ax.transAxes, fontsize=6.5)
        ax.text(0.0, 0.1, "per period", transform=ax.transAxes, fontsize=6.5)


def _sparse(ax: Axes, experiment: Any) -> None:
    """Few ticks, labelled with their units."""
    from matplotlib.ticker import EngFormatter, LogLocator, MaxNLocator, NullFormatter

    ax.tick_params(labelsize=5, length=1.8, pad=1.2)
    across, _ = (1.0, "") if "x" in experiment.logarithmic else prefix(*(c.x for c in experiment.curves))
    up, _ = (1.0, "") if "y" in experiment.logarithmic else prefix(*(_finite(c.y) for c in experiment.curves))
    for axis, factor, unit, log in (
        (ax.xaxis, across, experiment.x[1], "x" in experiment.logarithmic), (ax.yaxis, up, experiment.y[1], "y" in experiment.logarithmic)
    ):  # fmt: skip
        axis.set_major_locator(LogLocator(numticks=3) if log else MaxNLocator(nbins=3))
        axis.set_minor_formatter(NullFormatter())
        axis.set_major_formatter(_in_units(EngFormatter(unit, sep="\N{THIN SPACE}"), factor))


def _in_units(formatter: Any, factor: float) -> Any:
    from matplotlib.ticker import FuncFormatter

    return FuncFormatter(lambda value, position: formatter(value / factor))


def _heading(experiment: Any) -> str:
    across, up = (label.rpartition(" ")[2] for label in (experiment.x[0], experiment.y[0]))
    return f"{experiment.title.partition(',')[0]}\n{up} over {across}"
