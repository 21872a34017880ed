"""Figures of optima: the effect of each number around the best machine, its drive and the original one, and Pareto fronts."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.arguments import Ax, Grid
from stickslip.basics.errors import InputError
from stickslip.basics.number_names import numbers_meant
from stickslip.basics.quantities import pretty_unit
from stickslip.basics.variables import unit_of
from stickslip.inverse.optimisation.optimum import Optimum
from stickslip.inverse.optimisation.peaks import LIMITS
from stickslip.models.drives.within import drives_within
from stickslip.models.naming import axis_of
from stickslip.show.figures.style import COLOURS, DASHES, INK, SHADE, axes, axis_label, drawing, legend_above, prefix, scaled

_MOST = 7  # largest number of lines: those with the largest effect
_STAR: Any = {"marker": "*", "markersize": 9, "markeredgecolor": "black", "markeredgewidth": 0.7, "clip_on": False}
_SHADED: Any = {"color": SHADE, "linewidth": 0, "zorder": 0}
_TIMES = 2000  # points over a period
_MOTION = {"relative_acceleration": "acceleration", "relative_velocity": "velocity"}


@drawing
def optimum(optimum: Optimum, of: str | None = None, ax: Ax = None) -> Any:
    """The effect of the varied numbers around the best machine, or its drive together with that of the given machine.

    For each number a line shows the result from its lower to its upper bound with the others fixed; the line is thin where a limit is
    exceeded, and a star marks the best machine. For a single number the horizontal axis is that number, and the region beyond a limit is
    shaded. For a drive the relative acceleration over a period is shown, or the relative velocity if the acceleration is infinite; the
    region beyond its limit is shaded.

    Parameters
    ----------
    optimum : Optimum
        From `stickslip.optimise`.
    of : {"numbers", "drive"}, optional
        What to draw; by default the drive if a waveform was optimised.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Raises
    ------
    InputError
        If no number was varied, or the machine has no drive.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    >>> best = ss.optimise(robot, over={"drive.amplitude": (2e-4, 8e-4)}, maximise="mean_velocity")
    >>> ss.plot.optimum(best).get_xlabel(), ss.plot.optimum(best, of="drive").get_ylabel()
    ('amplitude of the inner mass $A$ (µm)', 'relative acceleration (m/s²)')
    """
    waves = any(not isinstance(what, tuple) for what in optimum.search.over.values())
    of = ("drive" if waves else "numbers") if of is None else of
    if of not in ("numbers", "drive"):
        raise InputError("plot", [f'of = {of!r}; allowed is "numbers" or "drive"'])
    if of == "numbers" and not optimum.cuts:
        raise InputError("plot", ['of = "numbers": only waveforms varied; type of="drive"'])
    drives = list(drives_within(optimum.model)) if of == "drive" else []
    if of == "drive" and not drives:
        raise InputError("plot", [f'of = "drive": {type(optimum.model).__name__} has no drive; type of="numbers"'])
    return _drives(optimum, drives, ax) if of == "drive" else _cuts(optimum, ax)


def _cuts(optimum: Any, ax: Any) -> Any:
    """A line for each number."""
    spans = {name: np.ptp(cut[2][np.isfinite(cut[2])]) for name, cut in optimum.cuts.items()}
    names = [name for name in optimum.cuts if name in sorted(spans, key=lambda name: -spans[name])[:_MOST]]
    alone = names[0] if len(optimum.cuts) == 1 else None
    ax = axes(ax, 2.2 if alone else 2.2 + 0.16 * len(names))
    best = optimum[optimum.of] if optimum.robust is None else optimum.robust
    unit = unit_of(optimum.of.partition(".")[0], optimum.model)
    factor, letter = scaled([best, *(v for name in names for v in optimum.cuts[name][2] if np.isfinite(v))], unit)
    right, across = _across(optimum, alone) if alone else (1.0, "fraction of the range from the lower to the upper bound")
    for i, name in enumerate(names):
        way, number, values, kept = optimum.cuts[name]
        x, line = right * (number if alone else way), {"color": COLOURS[i % 7], "linestyle": DASHES[i % 7]}
        beyond = _beyond(kept == 0.0)
        ax.plot(x, np.where(kept, factor * values, np.nan), linewidth=1.6, label=None if alone else _text(optimum, name), zorder=3, **line)
        ax.plot(x, np.where(beyond, factor * values, np.nan), linewidth=0.6, zorder=2, **line)
        ax.plot(np.interp(_best(optimum, name), number, x), best * factor, color=COLOURS[i % 7], zorder=8, **_STAR)
        if alone and beyond.any():
            ax.fill_between(x, 0.0, 1.0, where=beyond, transform=ax.get_xaxis_transform(), label="beyond a limit", **_SHADED)
    if not alone and not all(np.all(optimum.cuts[name][3]) for name in names):
        ax.plot([], [], color=INK, linewidth=0.6, label="thin: beyond a limit")
    ax.set_xlim(x[0], x[-1])
    ax.set_xlabel(across)
    of = optimum.of.replace("_", " ")
    ax.set_ylabel(axis_label(of if optimum.robust is None else f"{of}\nover the sample", pretty_unit(unit), letter))
    if ax.get_legend_handles_labels()[1]:
        legend_above(ax, ncols=1)
    return ax


def _across(optimum: Any, name: str) -> tuple[float, str]:
    """Scale factor and axis label for one number."""
    label, unit = axis_of(name, optimum.model) or (name, "1")
    factor, letter = scaled(optimum.cuts[name][1], unit)
    return factor, axis_label(label, pretty_unit(unit), letter)


def _text(optimum: Any, name: str) -> str:
    """A number with its best value and its bounds."""
    unit = (axis_of(name, optimum.model) or ("", "1"))[1]
    low, high = optimum.search.over[name]
    factor, letter = scaled([high, low], unit)
    shown = "" if unit == "1" else f" {letter}{pretty_unit(unit)}"
    return f"{name} = {factor * _best(optimum, name):.4g}{shown}  ({factor * low:.4g} to {factor * high:.4g})"


def _best(optimum: Any, name: str) -> float:
    """A number of the best machine; the first one if several vary together."""
    return float(optimum.varied[numbers_meant(name, optimum.varied)[0]])


def _beyond(beyond: Any) -> Any:
    """Points beyond a limit and their neighbours, so that the lines meet."""
    return beyond | np.append(beyond[1:], False) | np.append(False, beyond[:-1])


def _drives(optimum: Any, drives: list[Any], ax: Any) -> Any:
    """The drives of both machines over a period; identical ones are drawn once."""
    limited = [name for name in _MOTION if name in optimum.search.subject_to]
    name = next(name for name in (*limited, *_MOTION) if np.isfinite(optimum.values[name]) and np.isfinite(optimum.given[name]))
    curves: dict[int, Any] = {}
    for i, (drive, before) in enumerate(zip(drives, drives_within(optimum.given_model), strict=True)):
        pair = np.array([_curve(drive, name), _curve(before, name)])
        if not any(np.array_equal(pair, other) for other in curves.values()):
            curves[i] = pair
    ax = axes(ax, 2.1 + 0.16 * (len(curves) - 1))
    factor, letter = prefix(*curves.values()) if name == "relative_velocity" else (1.0, "")
    x = np.arange(_TIMES) / _TIMES
    for i, (new, old) in curves.items():
        number = f", drive {i}" if len(curves) > 1 else ""
        ax.plot(x, factor * old, color=COLOURS[i % 7], linestyle=DASHES[1], linewidth=0.8, label=f"as given{number}", zorder=3)
        ax.plot(x, factor * new, color=COLOURS[i % 7], label=f"best{number}", zorder=4)
    high = optimum.search.subject_to.get(name, (None, None))[1]
    if high is not None:
        reach = 1.15 * max(factor * high, *(np.max(abs(factor * pair)) for pair in curves.values()))
        for side in (1.0, -1.0):
            label = "beyond the limit" if side > 0 else None
            ax.axhspan(side * factor * high, side * reach, label=label, **_SHADED)
        ax.set_ylim(-reach, reach)
    ax.axhline(0.0, color=INK, linewidth=0.5, zorder=1)
    ax.set_xlim(0.0, 1.0)
    ax.set(xlabel="fraction of the drive period", ylabel=axis_label(name.replace("_", " "), pretty_unit(LIMITS[name]), letter))
    legend_above(ax, ncols=3 if len(curves) == 1 else 2, columnspacing=1.0)
    return ax


def _curve(drive: Any, name: str) -> Any:
    """Relative acceleration or velocity of a drive over its period."""
    times = np.arange(_TIMES) / _TIMES * float(drive.period)  # the end of the period coincides with the beginning of the next
    return np.broadcast_to(getattr(drive, _MOTION[name])(times), times.shape)


@drawing
def front(grid: Grid, ax: Ax = None) -> Any:
    """The Pareto front of two quantities: the largest value of one for each level of the other, which should be small.

    Parameters
    ----------
    grid : xarray.Dataset
        From `stickslip.optimisation.pareto`.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    >>> over = {"drive.amplitude": (3e-4, 8e-4)}
    >>> front = ss.optimisation.pareto(robot, over=over, maximise="mean_velocity", minimise="drive_power", points=3)
    >>> ax = ss.plot.front(front)
    >>> ax.get_xlabel(), ax.get_ylabel()
    ('drive power (mW)', 'mean velocity (mm/s)')
    """
    names = [getattr(grid, "attrs", {}).get(word) for word in ("minimise", "maximise")]
    if None in names or not set(names) <= set(getattr(grid, "data_vars", {})):
        raise InputError("plot", [f"{type(grid).__name__} without a front; allowed is the Dataset of ss.optimisation.pareto"])
    (right, side), (up, mark) = (scaled(grid[name].values, grid[name].attrs.get("units", "1")) for name in names)
    labels = [f"{str(name).replace('_', ' ')}" for name in names]
    units = [pretty_unit(grid[name].attrs.get("units", "1")) for name in names]
    ax = axes(ax, 2.2)
    ax.plot(right * grid[names[0]].values, up * grid[names[1]].values, ".-", color=COLOURS[0], markersize=5, clip_on=False)
    ax.set(xlabel=axis_label(labels[0], units[0], side), ylabel=axis_label(labels[1], units[1], mark))
    return ax
