"""Figures of measured records: with the predictions of laws, with fits, and with residuals."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Ax
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, is_whole
from stickslip.basics.units import SI, quantity_of
from stickslip.inverse.identification.comparing import Comparison
from stickslip.inverse.identification.fit import Fit
from stickslip.records.record import Record
from stickslip.show.figures.style import COLOURS, DASHES, INK, axes, drawing, legend_above, prefix, scaled

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_DOTS = 3000  # largest number of samples drawn
_BINS = 40  # bins of the drive's phase in which residuals are averaged


def _dots(x: Array, y: Array) -> tuple[Any, Any]:
    """At most as many samples as a figure can show, evenly spaced."""
    step = max(len(x) // _DOTS, 1)
    return x[::step], y[::step]


def _measured(ax: Axes, x: Array, y: Array, factor: float, label: str) -> None:
    ax.plot(*_dots(x, y * factor), ".", color=INK, markersize=1.6, alpha=0.35, linewidth=0, label=label, rasterized=True)


def _words(kind: str, unit: str) -> str:
    units = {"velocity": "m/s", "position": "m", "force": "N", "torque": "N m", "current": "A", "applied force": "N", "angle": "rad"}
    return f"{'friction force' if kind == 'force' else kind} ({unit}{units[kind]})"


@drawing
def record(record: Record, channel: str | None = None, ax: Ax = None) -> Any:
    """A channel of a record over its axis; of a long one the lowest and the highest value in each of 1500 stretches.

    Parameters
    ----------
    record : Record
    channel : str, optional
        Its name or its role; the velocity of the body if not given, else the position, else the first.
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    >>> ss.plot.record(ss.virtual_rig(robot, noise=1e-4, seed=1)).get_ylabel()
    'velocity (mm/s)'
    """
    if not isinstance(record, Record):
        raise InputError("plot", [f"record = {record!r}; allowed is a Record; type ss.plot.record(ss.read(path))"])
    if not record.channels:
        raise InputError("plot", ["the record has no channels; there is nothing to draw"])
    shown = record[channel or next((role for role in ("velocity", "position") if role in record), next(iter(record)))]
    ax = axes(ax)
    values = abs(shown.values) if np.iscomplexobj(shown.values) else np.asarray(shown.values, float)
    unit = SI.get(quantity_of(shown.unit) or "")
    factor, letter = scaled(shown.si[np.isfinite(values)], unit or "")
    t, y = _outline(np.asarray(shown.t, float), shown.si * factor if unit else values)
    ax.plot(t, y, color=COLOURS[0], linewidth=0.6, rasterized=True)
    label = f"{letter}{unit}" if unit else shown.unit
    ax.set(xlabel=_named(shown.axis_name or "axis", shown.axis_unit), ylabel=_named(shown.name, label))
    return ax


def _named(name: str, unit: str | None) -> str:
    return name if unit is None else f"{name} ({unit})"


def _outline(t: Array, y: Array) -> tuple[Any, Any]:
    """A curve of at most 3000 points that looks like the whole: the lowest and the highest value of each stretch."""
    if len(y) <= _DOTS:
        return t, y
    edges = np.linspace(0, len(y), _DOTS // 2 + 1).astype(int)[:-1]
    both = np.column_stack([np.fmin.reduceat(y, edges), np.fmax.reduceat(y, edges)])
    return np.repeat(t[edges], 2), both.ravel()


@drawing
def comparison(comparison: Comparison, ax: Ax = None) -> Any:
    """A record and several laws over one drive period, as in Figs 7 to 10 of the paper.

    Parameters
    ----------
    comparison : Comparison
        From `stickslip.compare`.
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=4.7, amplitude=4.58e-4, law="coulomb-static")
    >>> comparison = ss.compare(ss.virtual_rig(robot, noise=1e-4, seed=1), robot, laws=["coulomb"])
    >>> ss.plot.comparison(comparison).get_xlabel()
    'drive periods'
    """
    ax = axes(ax)
    phase, y = comparison.samples
    middle = {"velocity": 0.0}.get(comparison.kind, float(np.mean(y)))
    factor, unit = prefix(y - middle)
    _measured(ax, phase, y - middle, factor, "record")
    for k, row in enumerate(comparison.laws):
        value = row.value - (0.0 if comparison.kind == "velocity" else row.value.mean())
        ax.plot(np.mod(row.phase, 1.0)[: len(row.phase)], value * factor, color=COLOURS[k % 6], linestyle=DASHES[k % 6], label=row.label)
    ax.set(xlabel="drive periods", ylabel=_words(comparison.kind, unit), xlim=(0, 1))
    legend_above(ax, ncols=len(comparison.laws) + 1, columnspacing=1.2)
    return ax


@drawing
def fitted(fit: Fit, record: int = 0, ax: Ax = None) -> Any:
    """One record and the fitted model: over the drive's phase, or force against position.

    Parameters
    ----------
    fit : Fit
        From `stickslip.identify`.
    record : int
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    >>> record = ss.virtual_rig(robot, noise=1e-4, seed=1)
    >>> fit = ss.identify(record, ss.presets.piezo_rig, free={"mu0": (0.1, 0.3)}, tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    >>> ss.plot.fitted(fit).get_xlabel()
    'drive periods'
    """
    ax = axes(ax)
    target, curve = fitted_target(fit, record), fit.predicted[record]
    if target.kind == "mean":
        return _means(fit, ax)
    x, label = _abscissa(fit, record)
    y = curve - residual_values(fit, record)
    middle = float(np.mean(y)) if target.kind == "position" else 0.0
    factor, unit = prefix(y - middle)
    _measured(ax, x, y - middle, factor, "record")
    order = np.argsort(x, kind="stable") if not fit.problem.batched else np.arange(len(x))
    ax.plot(x[order], (curve[order] - middle) * factor, color=COLOURS[0], linewidth=0.9, label=fit.law)
    ax.set(xlabel=label, ylabel=_words(target.kind, unit))
    legend_above(ax, ncols=2)
    return ax


def fitted_target(fit: Fit, record: int) -> Any:
    """The fitted data of one record; `InputError` if there is no record of this number."""
    targets = fit.problem.targets
    if not is_whole(record) or not 0 <= record < len(targets):
        raise InputError("plot", [f"record = {record!r}; allowed is a whole number from 0 to {len(targets) - 1}; type record=0"])
    return targets[record]


def residual_values(fit: Fit, record: int) -> Any:
    """The model less the measured values of one record [SI]."""
    return fit.problem.parts(fit.residuals * fit.problem.sigma)[record]


def _abscissa(fit: Fit, record: int) -> tuple[Any, str]:
    target = fitted_target(fit, record)
    if target.kind == "force":
        moved = np.cumsum(target.v * np.diff(target.t, prepend=target.t[0]))[target.compared]
        factor, unit = prefix(moved - moved.mean())
        return (moved - moved.mean()) * factor, f"position ({unit}m)"
    if fit.problem.batched:
        return target.moved()[0], "time (s)"
    return np.mod(fit.problem.model._phase(fit.point, record), 1.0), "drive periods"


def _means(fit: Fit, ax: Axes) -> Any:
    """Mean velocities: fitted against measured."""
    y, model = fit.problem.y, np.concatenate(fit.predicted)
    factor, unit = prefix(y, model)
    ends = np.array([0.0, 1.08 * max(y.max(), model.max())]) * factor
    ax.plot(ends, ends, color=INK, linewidth=0.6)
    ax.plot(y * factor, model * factor, "o", color=COLOURS[0], markersize=4)
    ax.set(xlabel=f"measured mean velocity ({unit}m/s)", ylabel=f"fitted ({unit}m/s)")
    return ax


def _phase_mean(phase: Any, rest: Any) -> tuple[Any, Any, Any]:
    """Centres of the phase bins, means of the residuals in them, and their standard errors."""
    index = np.minimum((phase * _BINS).astype(int), _BINS - 1)
    count = np.maximum(np.bincount(index, minlength=_BINS), 1)
    mean = np.bincount(index, rest, _BINS) / count
    spread = np.sqrt(np.bincount(index, (rest - mean[index]) ** 2, _BINS) / count)
    return (np.arange(_BINS) + 0.5) / _BINS, mean, spread / np.sqrt(count)


@drawing
def autocorrelation(fit: Fit, record: int = 0, ax: Ax = None) -> Any:
    """Autocorrelation of the residuals of one record; the band is that of white noise.

    Parameters
    ----------
    fit : Fit
    record : int
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    >>> record = ss.virtual_rig(robot, noise=1e-4, seed=1)
    >>> fit = ss.identify(record, ss.presets.piezo_rig, free={"mu0": (0.1, 0.3)}, tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    >>> ss.plot.autocorrelation(fit).get_xlabel()
    'lag (samples)'
    """
    ax = axes(ax)
    target, rest = fitted_target(fit, record), residual_values(fit, record)
    if target.kind == "mean":
        raise InputError("plot", ["a mean velocity has one residual, and no correlation; type record= with the number of a curve"])
    r, n = rest - rest.mean(), len(rest)
    lags = np.arange(1, max(min(n // 4, 200), 2))
    rho = np.array([r[k:] @ r[:-k] for k in lags]) / max(float(r @ r), 1e-300)
    ax.axhspan(-2 / np.sqrt(n), 2 / np.sqrt(n), color=INK, alpha=0.12, linewidth=0)
    ax.axhline(0.0, color=INK, linewidth=0.6)
    ax.vlines(lags, 0.0, rho, color=COLOURS[1], linewidth=0.8)
    ax.set(xlabel="lag (samples)", ylabel="correlation of residuals", xlim=(0, lags[-1] + 1))
    return ax


@drawing
def residuals(fit: Fit, record: int = 0, ax: Ax = None) -> Any:
    """Residuals of one record: noise if the law is right, structured if it is not.

    The line is the mean at each phase of the drive, with two standard errors on either side; it is zero if the law is right. Of a mean
    velocity those of all mean velocities are drawn, each with its standard deviation where that was given.

    Parameters
    ----------
    fit : Fit
    record : int
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    >>> record = ss.virtual_rig(robot, noise=1e-4, seed=1)
    >>> fit = ss.identify(record, ss.presets.piezo_rig, free={"mu0": (0.1, 0.3)}, tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    >>> ss.plot.residuals(fit).get_ylabel()
    'residual velocity (µm/s)'
    """
    ax = axes(ax)
    target, rest = fitted_target(fit, record), residual_values(fit, record)
    if target.kind == "mean":
        return _residuals_of_means(fit, ax)
    factor, unit = prefix(rest)
    x, label = _abscissa(fit, record)
    ax.axhline(0.0, color=INK, linewidth=0.6)
    ax.plot(*_dots(x, rest * factor), ".", color=COLOURS[1], markersize=1.8, alpha=0.5, linewidth=0, rasterized=True)
    if target.kind in ("velocity", "position") and len(rest) > 4 * _BINS:
        at, mean, error = _phase_mean(x, rest)
        ax.fill_between(at, (mean - 2 * error) * factor, (mean + 2 * error) * factor, color=INK, alpha=0.2, linewidth=0)
        ax.plot(at, mean * factor, color=INK, linewidth=0.9)
    ax.set(xlabel=label, ylabel=f"residual {_words(target.kind, unit)}")
    return ax


def _residuals_of_means(fit: Fit, ax: Axes) -> Any:
    """Residuals of all mean velocities over what was measured."""
    means = [i for i, t in enumerate(fit.problem.targets) if t.kind == "mean"]
    rest, measured = np.array([residual_values(fit, i)[0] for i in means]), np.array([fit.problem.targets[i].y[0] for i in means])
    spread = np.array([t.sigma if t.given_sigma else 0.0 for t in (fit.problem.targets[i] for i in means)])
    (factor, unit), (own, own_unit) = prefix(rest), prefix(measured)
    ax.axhline(0.0, color=INK, linewidth=0.6)
    ax.errorbar(measured * own, rest * factor, spread * factor, fmt="o", color=COLOURS[1], markersize=3, elinewidth=0.8)
    ax.set(xlabel=f"measured mean {_words('velocity', own_unit)}", ylabel=f"residual {_words('velocity', unit)}")
    return ax


@drawing
def record_spectrum(record: Record, channel: str = "velocity", ax: Ax = None) -> Any:
    """Amplitude spectrum of a channel.

    Parameters
    ----------
    record : Record
    channel : str
    ax : matplotlib Axes, optional

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    >>> ss.plot.record_spectrum(ss.virtual_rig(robot, noise=1e-4, seed=1)).get_xlabel()
    'frequency (Hz)'
    """
    ax = axes(ax)
    measured, (lines, amplitude) = record[channel], record.spectrum(channel)
    ax.semilogy(lines[1:], np.maximum(amplitude[1:], 1e-300), color=COLOURS[0], linewidth=0.8)
    ax.set(xlabel="frequency (Hz)", ylabel=f"amplitude ({SI.get(quantity_of(measured.unit) or '', 'SI')})")
    ax.set_title(measured.name, loc="left", fontsize=7)
    return ax
