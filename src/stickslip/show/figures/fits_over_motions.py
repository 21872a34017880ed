"""Figures of fits over a measured motion: friction against velocity, the fit over the data, and what is left of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.analysis.bench.setup import Setup
from stickslip.basics.arguments import Ax
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.variables import in_units_of
from stickslip.inverse.identification.fit import Fit
from stickslip.inverse.identification.fit_text import OVER_MOTION, unit_of_values
from stickslip.models.machine_adapter import is_machine, machine_of
from stickslip.show.figures.records import fitted_target, residual_values
from stickslip.show.figures.style import COLOURS, INK, axes, drawing, legend_above, prefix

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_DOTS = 6000  # largest number of samples drawn
_SHOWN = 6  # reversals that a curve over time shows
_CURVE = 121  # velocities of the law's curve
_APART = 3.0  # times the usual step beyond which a line is broken


def _motion(fit: Fit, record: int) -> Any:
    """The record's motion; `InputError` where forces were not fitted over one."""
    target = fitted_target(fit, record)
    if target.kind not in OVER_MOTION:
        raise InputError("plot", ["the fit is not one of forces over a motion; type fit.plot() for its curve over the drive's period"])
    return target


def _law_and_load(fit: Fit, record: int) -> tuple[Any, float, float]:
    """The law of the contact, its mean load, and its force for each unit of what was measured."""
    model, target = fit.model(record), fit.problem.targets[record]
    if not is_machine(model):
        return getattr(model, "friction", model), float(np.mean(target.load)), 1.0
    bare, per = machine_of(model).input or (model, {})
    mechanics, (t, x, _) = machine_of(bare).mechanics, target.moved(fit.predicted[record])
    return mechanics.laws[0], float(np.mean(mechanics.loads(t, (x,))[0])), float(per.get(target.kind, 1.0))


@drawing
def friction_curve(fit: Fit, record: int = 0, ax: Ax = None) -> Any:
    """Friction against velocity: the measured cloud and the fitted law.

    A dot is the friction that a sample shows. Of a force it is the sample less zero, drift, gain and inertia of the sensor, as they were
    fitted; of a torque or a current the law at its velocity, and what is left of the sample by the inertia and gravity of the fit.

    Parameters
    ----------
    fit : Fit
        Of forces, torques or currents over a measured motion.
    record : int
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> t = np.arange(0, 4, 0.005)
    >>> F = 2.0 * np.sign(np.cos(3 * t)) + np.random.default_rng(0).normal(0, 0.05, len(t))
    >>> rec = ss.Record.of(t, {"x [m]": 5e-3 * np.sin(3 * t), "F [N]": F}, roles={"F": "force"})
    >>> fit = ss.identify(rec, ss.Coulomb, free={"mu": (0.1, 5.0)}, load=1.0, starts=2)
    >>> ss.plot.friction_curve(fit).get_xlabel()
    'velocity (mm/s)'
    """
    target = _motion(fit, record)
    if target.kind == "angle":
        raise InputError("plot", ["no torque was measured, from which friction would follow; type ss.plot.over_time(fit) for the angle"])
    law, load, per = _law_and_load(fit, record)
    _, _, v = target.moved(fit.predicted[record])
    grid = _velocities(v)
    steady = np.array([Setup(law, load, 1.0).steady_force(float(each)) for each in grid])
    shown = _forces(fit, record) if target.kind == "force" else np.interp(v, grid, steady) - residual_values(fit, record) * per
    shown[v == 0] = np.nan  # at rest friction is what is applied
    (f, letter), (g, speed) = prefix(steady), prefix(v)
    unit = {"current": "A"}.get(target.kind, unit_of_values(target)) if per == 1.0 else in_units_of(fit.model(record), "N")
    ax = axes(ax)
    step = max(len(v) // _DOTS, 1)
    ax.plot(v[::step] * g, shown[::step] * f, ".", color=INK, markersize=2.0, alpha=0.25, linewidth=0, label="measured", rasterized=True)
    for side in (grid < 0, grid > 0):
        ax.plot(grid[side] * g, steady[side] * f, color=COLOURS[0], linewidth=1.3, label=fit.law if side[-1] else None)
    ax.axhline(0.0, color=INK, linewidth=0.4)
    what = "friction torque" if unit == "N m" else "friction force" if unit == "N" else "friction, as current"
    ax.set(xlabel=f"velocity ({speed}{in_units_of(fit.model(record), 'm/s')})", ylabel=f"{what} ({letter}{unit})")
    legend_above(ax, ncols=2, markerscale=3)
    return ax


def _forces(fit: Fit, record: int) -> Any:
    """Measured forces of a record without the effects of the sensor."""
    target = fit.problem.targets[record]
    own = {name.partition("[")[0]: value for name, (value, _) in fit.sensor.items() if "[" not in name or name.endswith(f"[{record}]")}
    measured = fit.predicted[record] - residual_values(fit, record) - own.get("offset", 0.0) - own.get("drift", 0.0) * target.time
    mass = own.get("inertia", 0.0)
    return (measured - (mass * target.acceleration if mass else 0.0)) / own.get("gain", 1.0)


def _velocities(v: Array) -> Any:
    """Velocities of the law's curve, denser near zero, on both sides of it."""
    end = float(np.max(abs(v))) or 1.0
    side = end * np.geomspace(1e-4, 1.0, _CURVE // 2)
    return np.concatenate([-side[::-1], side])


@drawing
def over_time(fit: Fit, record: int = 0, ax: Ax = None) -> Any:
    """What was measured over time, and the fit: some strokes from the middle of the record, with nothing drawn over gaps.

    Parameters
    ----------
    fit : Fit
        Of forces, torques or currents over a measured motion.
    record : int
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> t = np.arange(0, 4, 0.005)
    >>> F = 2.0 * np.sign(np.cos(3 * t)) + np.random.default_rng(0).normal(0, 0.05, len(t))
    >>> rec = ss.Record.of(t, {"x [m]": 5e-3 * np.sin(3 * t), "F [N]": F}, roles={"F": "force"})
    >>> fit = ss.identify(rec, ss.Coulomb, free={"mu": (0.1, 5.0)}, load=1.0, starts=2)
    >>> ss.plot.over_time(fit).get_xlabel()
    'time (s)'
    """
    target = _motion(fit, record)
    t, _, v = target.moved(fit.predicted[record])
    curve, part = fit.predicted[record], slice(None) if target.kind == "angle" else _some_strokes(t, v)
    y = curve - residual_values(fit, record)
    factor, letter = prefix(y)
    ax = axes(ax)
    ax.plot(t[part], y[part] * factor, ".", color=INK, markersize=2.2, alpha=0.45, linewidth=0, label="measured", rasterized=True)
    _line(ax, t[part], curve[part] * factor, fit.law)
    what = {"force": "friction force"}.get(target.kind, target.kind)
    ax.set(xlabel="time (s)", ylabel=f"{what} ({letter}{unit_of_values(target)})")
    legend_above(ax, ncols=2, markerscale=3)
    return ax


def _line(ax: Axes, t: Any, y: Any, label: str) -> None:
    """A line that is broken where time is left out."""
    steps = np.diff(t)
    breaks = np.flatnonzero(steps > _APART * np.median(steps)) + 1 if len(steps) else np.array([], int)
    ax.plot(np.insert(t, breaks, np.nan), np.insert(y, breaks, np.nan), color=COLOURS[0], linewidth=1.1, label=label)


def _some_strokes(t: Any, v: Any) -> Any:
    """The middle of a record, from one reversal to another some strokes later; all of it where it has few."""
    moving = np.flatnonzero(v != 0)
    turns = moving[1:][np.diff(np.sign(v[moving])) != 0]
    if len(turns) <= _SHOWN:
        return slice(None)
    first = (len(turns) - _SHOWN) // 2
    return slice(int(turns[first]), int(turns[first + _SHOWN]))


@drawing
def residuals_over_velocity(fit: Fit, record: int = 0, ax: Ax = None) -> Any:
    """What is left of a record over velocity, with means of bins and two standard errors: zero if the law is right.

    Parameters
    ----------
    fit : Fit
        Of forces, torques or currents over a measured motion.
    record : int
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> t = np.arange(0, 4, 0.005)
    >>> F = 2.0 * np.sign(np.cos(3 * t)) + np.random.default_rng(0).normal(0, 0.05, len(t))
    >>> rec = ss.Record.of(t, {"x [m]": 5e-3 * np.sin(3 * t), "F [N]": F}, roles={"F": "force"})
    >>> fit = ss.identify(rec, ss.Coulomb, free={"mu": (0.1, 5.0)}, load=1.0, starts=2)
    >>> ss.plot.residuals_over_velocity(fit).get_ylabel()
    'residual (mN)'
    """
    target = _motion(fit, record)
    _, _, v = target.moved(fit.predicted[record])
    rest = -residual_values(fit, record)
    (f, letter), (g, speed) = prefix(rest), prefix(v)
    ax = axes(ax)
    step = max(len(v) // _DOTS, 1)
    ax.plot(v[::step] * g, rest[::step] * f, ".", color=COLOURS[1], markersize=2.0, alpha=0.3, linewidth=0, rasterized=True)
    ends = np.unique(np.quantile(v, np.linspace(0, 1, 31)))
    index = np.clip(np.searchsorted(ends, v, side="right") - 1, 0, len(ends) - 2)
    count = np.maximum(np.bincount(index, minlength=len(ends) - 1), 1)
    mean, at = (np.bincount(index, values, len(ends) - 1) / count for values in (rest, v))
    error = np.sqrt(np.bincount(index, (rest - mean[index]) ** 2, len(ends) - 1) / count) / np.sqrt(count)
    ax.errorbar(at * g, mean * f, 2 * error * f, color=INK, linewidth=0.9, elinewidth=0.9, marker="o", markersize=2)
    ax.axhline(0.0, color=INK, linewidth=0.6)
    ax.set(xlabel=f"velocity ({speed}{in_units_of(fit.model(record), 'm/s')})", ylabel=f"residual ({letter}{unit_of_values(target)})")
    return ax
