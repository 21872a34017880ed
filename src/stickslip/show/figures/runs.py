"""Figures of one or several runs: velocity against time, phase portrait, forces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.analysis.contact_modes import contact_modes
from stickslip.analysis.steady import LONGEST_PERIOD, period_number
from stickslip.basics.arguments import Ax
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, NoBodies
from stickslip.basics.variables import unit_of
from stickslip.models.angular_coordinates import unit_of_part
from stickslip.models.friction.law_adapter import law_of
from stickslip.models.machine_adapter import machine_of
from stickslip.models.model_adapter import adapter_of
from stickslip.models.normal_loads import normal_load
from stickslip.models.state_layout import of_one_contact
from stickslip.results.datasets import names_of_parts
from stickslip.results.trajectory import Trajectory
from stickslip.show.figures.flow_runs import flow_phase
from stickslip.show.figures.style import COLOURS, DASHES, INK, SHADE, axes, drawing, in_their_units, legend_above, prefix, shared_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_POINTS = 1200  # per curve
_WIDE = 30  # letters in a row of the legend
_MANY = 6000  # points of an autonomous run, which is shown whole


def _runs(run: Any, several: bool = False) -> list[Any]:
    runs = list(run) if isinstance(run, (list, tuple)) else [run]
    if not runs or any(not isinstance(r, Trajectory) for r in runs):
        raise InputError("plot", [f"run = {run!r}; allowed is a Trajectory or a list of them; type ss.plot.velocity(ss.solve(robot))"])
    if not all(r.pieces.layout.bodies for r in runs):
        raise NoBodies("plot", ["a flow has no bodies, and so no velocity of one; type ss.plot.states(run), or ss.plot.phase(run)"])
    if len({r.model.period is None for r in runs}) > 1:
        raise InputError("plot", ["some runs have a drive period and some have none; draw them apart, each with ax= of its own"])
    return [r.with_axes if several and _parts(r, "body") else of_one_contact("plot", r, "one curve is drawn for each run") for r in runs]


def only_run(run: Trajectory, bodies: bool = True) -> Any:
    """The single run of any machine; `InputError` for several runs, and with `bodies` for a run that has none."""
    if not bodies and isinstance(run, Trajectory) and not run.pieces.layout.bodies:
        return run
    runs = _runs(run, several=True)
    return runs[0] if len(runs) == 1 else _runs(None)


def _parts(run: Trajectory, dim: str) -> list[str]:
    """Names of the bodies or contacts of a machine with several; empty for a robot or a bench."""
    return [] if run.pieces.layout.single else names_of_parts(run.with_axes)[dim]


def _by_part(runs: list[Any], names: list[str], dim: str) -> list[tuple[str, int, Any]]:
    """The curves as (name, number of the run, index of its columns): one for each run, or for each part of a run's machine."""
    curves: list[tuple[str, int, Any]] = []
    for i, (run, name) in enumerate(zip(runs, names, strict=True)):
        parts = _parts(run, dim)
        curves += [(part if len(runs) == 1 else f"{name}, {part}", i, (..., k)) for k, part in enumerate(parts)]
        curves += [] if parts else [(name, i, ...)]
    return curves


def _sampled(runs: list[Any], names: list[str], spans: list[tuple[float, float]], column: str, dim: str) -> list[tuple[str, int, Any, Any]]:
    """Curves as (name, number of the run, t, values)."""
    columns = [samples_over(run, *span, column) for run, span in zip(runs, spans, strict=True)]
    return [(name, i, columns[i][0], columns[i][1][own]) for name, i, own in _by_part(runs, names, dim)]


def _units(runs: list[Any], column: str, dim: str) -> list[str]:
    """The unit of each curve, in the order of `_by_part`."""
    return [unit_of_part(column, run.model, part) for run in runs for part in _parts(run, dim) or [""]]


def _with_units(names: list[str], *shown: list[str]) -> list[str]:
    """Names of curves, with the units of each where these are not the same for all."""
    mixed = any(len(set(units)) > 1 for units in shown)
    return [f"{name} ({', '.join(units)})" if mixed else name for name, *units in zip(names, *shown, strict=True)]


def _labels(runs: list[Any], labels: Sequence[str] | None) -> list[str]:
    if labels is not None and len(labels) != len(runs):
        raise InputError("plot", [f"labels has {len(labels)} texts for {len(runs)} runs; give one for each run"])
    return list(labels) if labels is not None else [machine_of(r.model).law_names for r in runs]


def span(run: Trajectory, periods: float | None = None, duration: float | None = None) -> tuple[float, float]:
    """The last `periods` whole drive periods of a run, or its last `duration` [s]; all of it without a drive."""
    first, end = float(run.pieces.t[0]), float(run.pieces.t[-1])
    if duration is not None:
        if not duration > 0:
            raise InputError("plot", [f"duration = {duration!r}; allowed is a positive time [s]; type duration=10.0"])
        return _span(max(end - duration, first), end, f"duration = {duration!r}")
    if run.model.period is None:
        if periods is not None:
            why = f"periods = {periods!r}, but {type(run.model).__name__} has no drive period"
            raise InputError("plot", [f"{why}; type duration=10.0 [s] for the end of the run, or leave it out for all of it"])
        return first, end
    periods = 3 if periods is None else periods
    if not periods > 0:
        raise InputError("plot", [f"periods = {periods!r}; allowed is a positive number of drive periods; type periods=3"])
    end = float(run.strobe_times[-1]) or end  # a run that ended in its first period is shown to its end
    return _span(max(end - periods * run.period_time, first), end, f"periods = {periods!r}")


def _span(start: float, end: float, asked: str) -> tuple[float, float]:
    if not end - start > 1e-9 * abs(end):
        raise InputError("plot", [f"{asked} is too short a time to draw; type periods=3"])
    return start, end


def samples_over(run: Trajectory, start: float, end: float, column: str) -> tuple[Any, Any]:
    """A column over a span, with a pair of points at each event, so that corners and jumps are sharp."""
    driven = run.model.period is not None
    events = np.array([e.t for e in run.events if start < e.t < end])
    grid = np.linspace(start, end, _POINTS if driven else _MANY)
    just = 1e-9 * (run.period_time if driven else end - start)
    t = np.sort(np.concatenate([grid, events - just, events]))
    return t, run.at(np.clip(t, start, end))[column]


def sticking_intervals(run: Trajectory, start: float, end: float) -> list[tuple[float, float]]:
    """Intervals in which the only contact sticks: exact for a set-valued law, by the rule of `motion` for one with inner states."""
    (stretches,) = contact_modes(run, start, end).values()
    always = all(sign == 0 for _, _, sign in stretches)
    return [] if always and law_of(run.model).dynamic else [(a, b) for a, b, sign in stretches if sign == 0]


def _finish(ax: Axes, drawn: Sequence[Any], more: Sequence[Any] = ()) -> Any:
    """Add a legend above the axes: the names of several curves, and additional handles."""
    curves = [line for line in ax.get_legend_handles_labels()[0] if line not in more] if len(drawn) > 1 else []
    if curves or more:
        handles = [*curves, *more]
        legend_above(ax, handles=handles, ncols=min(len(handles), _columns(handles)), columnspacing=1.4)
    return ax


def _columns(handles: Sequence[Any]) -> int:
    """The number of legend columns that fit into the figure."""
    longest = sorted((len(str(handle.get_label())) for handle in handles), reverse=True)[:4]
    return 4 if sum(longest) <= _WIDE else 3


def _shade(ax: Axes, rests: list[tuple[float, float]], start: float, factor: float, name: str = "") -> list[Any]:
    """Shade the intervals in which the contact sticks; returns a handle for the legend."""
    from matplotlib.patches import Patch

    for a, b in rests:
        ax.axvspan((a - start) * factor, (b - start) * factor, color=SHADE, linewidth=0, zorder=0)
    return [Patch(facecolor=SHADE, edgecolor=INK, linewidth=0.3, label=f"{name} sticks".lstrip())] if rests else []


_REST: dict[str, Any] = {
    "color": INK,
    "linewidth": 0.7,
    "linestyle": (0, (4, 2)),
    "zorder": 1.5,
    "label": "here the contact rests",
}


def _at_rest(run: Trajectory, t: Array) -> Array | None:
    """The velocity of the body at which its only contact rests, where that is not zero: that of a belt, or of a shaken track."""
    if not run.pieces.layout.single or not run.contacts:
        return None
    columns = run.with_axes.at(t)
    v = columns["v"][:, 0]
    velocity: Array = v - columns["slip"][:, 0]
    return velocity if np.max(np.abs(velocity)) > 1e-9 * np.max(np.abs(v)) else None


def clock(run: Trajectory, length: float) -> tuple[float, str]:
    """The factor and the prefix with which a time of so many seconds is shown; of a flow, which has no units, 1 and none."""
    return prefix(length) if adapter_of(run.model).has_units else (1.0, "")


def time_axis(ax: Axes, run: Trajectory, span: tuple[float, float], factor: float, unit: str) -> None:
    """Set up a time axis that starts at the first drive period shown."""
    s = " s" if adapter_of(run.model).has_units else ""
    since = (
        f"$t - {round(span[0] / run.period_time)}\\,T$" if run.model.period is not None else f"$t - {span[0]:.6g}${s}" if span[0] else "$t$"
    )
    ax.set_xlim(0.0, (span[1] - span[0]) * factor)
    ax.set_xlabel(f"time {since} ({unit}s)" if s else f"time {since}")


@drawing
def velocity(
    run: Trajectory | Sequence[Trajectory],
    periods: float | None = None,
    ax: Ax = None,
    labels: Sequence[str] | None = None,
    duration: float | None = None,
) -> Any:
    """Velocity of the body over the last drive periods; intervals of sticking are shaded.

    For a machine of several bodies there is one curve for each body and no shading.

    Parameters
    ----------
    run : Trajectory or list of Trajectory
        For several runs, the sticking intervals of the first are shaded.
    periods : float, optional
        How many drive periods to show; 3 if not given.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.
    labels : list of str, optional
        Names of the runs; their laws' names if not given.
    duration : float, optional
        How much of the end of the runs to show [s], instead of `periods`. Without a drive, all of a run is shown if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), periods=20)
    >>> ss.plot.velocity(run, periods=2).get_ylabel()
    'velocity $v$ (mm/s)'
    """
    runs = _runs(run, several=True)
    names, spans = _labels(runs, labels), [span(r, periods, duration) for r in runs]
    curves = _sampled(runs, names, spans, "v", "body")
    time, seconds = prefix(*(b - a for a, b in spans))
    factors, units = in_their_units([v for *_, v in curves], _units(runs, "v", "body"))
    ax = axes(ax)
    rested = [] if _parts(runs[0], "body") else sticking_intervals(runs[0], *spans[0])
    shaded = _shade(ax, rested, spans[0][0], time, names[0] if len(runs) > 1 else "")
    ax.axhline(0.0, color=INK, linewidth=0.5, zorder=1)
    for event in runs[0].named_events:
        if spans[0][0] <= event.t <= spans[0][1]:
            ax.axvline((event.t - spans[0][0]) * time, color=INK, linewidth=0.6, linestyle=":", zorder=1)
    for i, ((_, number, t, v), name) in enumerate(zip(curves, _with_units([name for name, *_ in curves], units), strict=True)):
        since = t - spans[number][0]
        ax.plot(since * time, v * factors[i], color=COLOURS[i % 7], linestyle=DASHES[i % 7], label=name, zorder=2 + i)
    moments = np.linspace(*spans[0], 400)
    if (rest := _at_rest(runs[0], moments)) is not None:
        shaded += ax.plot((moments - spans[0][0]) * time, rest * factors[0], **_REST)
    time_axis(ax, runs[0], spans[0], time, seconds)
    ax.set_ylabel(shared_unit("velocity $v$", units))
    return _finish(ax, curves, shaded)


@drawing
def phase(
    run: Trajectory | Sequence[Trajectory],
    periods: float | None = None,
    ax: Ax = None,
    labels: Sequence[str] | None = None,
    duration: float | None = None,
    x: str | None = None,
    y: str | None = None,
) -> Any:
    """Phase portrait: velocity against the displacement without its drift, with the strobe points marked.

    The mean motion over the periods shown is subtracted, as in the paper ("subtracting the rigid displacements"), so that a periodic
    motion gives a closed curve with one strobe point for each of its drive periods. Without a drive there are no strobe points, and the
    displacement is measured from the pulled end of the spring, if there is one, so that a limit cycle is a closed curve. For a machine of
    several bodies there is one curve for each body.

    Parameters
    ----------
    run : Trajectory or list of Trajectory
    periods : float, optional
        How many drive periods to show; if not given, one motion period, or up to 16 drive periods if the motion does not repeat.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.
    labels : list of str, optional
        Names of the runs; their laws' names if not given.
    duration : float, optional
        How much of the end of the runs to show [s], for an autonomous mechanism; all if not given.
    x, y : str, optional
        For a run of a `SwitchingFlow`, the states to draw against each other; the first two if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), periods=20)
    >>> ss.plot.phase(run).get_xlabel()
    'displacement without drift $x - Vt$ (µm)'
    """
    if isinstance(run, Trajectory) and not run.pieces.layout.bodies:
        return flow_phase(run, x, y, ax, duration)
    runs = _runs(run, several=True)
    names = _labels(runs, labels)
    if duration is not None and runs[0].model.period is not None:
        raise InputError("plot", [f"duration = {duration!r}; a driven motion is shown for whole drive periods; type periods=3"])
    spans = [span(r, _shown(r) if periods is None else periods, duration) for r in runs]
    parts = _by_part(runs, names, "body")
    names, orbits = [name for name, _, _ in parts], [_orbit(runs[i], spans[i], own) for _, i, own in parts]
    across, metres = in_their_units([s for s, *_ in orbits], _units(runs, "x", "body"))
    up, units = in_their_units([v for _, v, *_ in orbits], _units(runs, "v", "body"))
    ax = axes(ax, height=2.5)
    ax.axhline(0.0, color=INK, linewidth=0.5, zorder=1)
    more = [_strobe_word()] if runs[0].model.period is not None else []
    for i, ((s, v, strobe_s, strobe_v), name) in enumerate(zip(orbits, _with_units(names, metres, units), strict=True)):
        ax.plot(s * across[i], v * up[i], color=COLOURS[i % 7], linestyle=DASHES[i % 7], label=name, zorder=2 + i)
        marker: dict[str, Any] = {"markersize": 4, "color": "white", "markeredgecolor": COLOURS[i % 7], "markeredgewidth": 1.1}
        ax.plot(strobe_s * across[i], strobe_v * up[i], "o", zorder=9, **marker)
    rest = _at_rest(runs[0], np.linspace(*spans[0], 50))
    if rest is not None and np.ptp(rest) < 1e-9 * np.max(np.abs(rest)):
        ax.axhline(rest[0] * up[0], **_REST)
        words: dict[str, Any] = {"ha": "right", "va": "bottom", "fontsize": 7, "color": INK}
        ax.text(1.0, rest[0] * up[0], _REST["label"], transform=ax.get_yaxis_transform(), **words)
    ax.set_xlabel(shared_unit(_displacement(runs[0].model), metres))
    ax.set_ylabel(shared_unit("velocity $v$", units))
    ax.margins(0.06)
    return _finish(ax, orbits, more)


def _displacement(model: Model) -> str:
    if model.period is not None:
        return "displacement without drift $x - Vt$"
    return "displacement from the pulled end $x - ut$" if machine_of(model).is_pulled else "displacement $x$"


def _strobe_word() -> Any:
    """The legend handle of the strobe points."""
    from matplotlib.lines import Line2D

    style: Any = {"linestyle": "", "marker": "o", "markersize": 4, "color": "white", "markeredgecolor": INK, "markeredgewidth": 1.1}
    return Line2D([], [], label="start of a drive period", **style)


def _shown(run: Trajectory) -> int | None:
    """One motion period, or up to 16 drive periods if none was found; None without a drive."""
    if run.model.period is None:
        return None
    return period_number(run) or max(min(LONGEST_PERIOD, len(run.strobe_times) - 1 - int(run.settle)), 1)


def _orbit(run: Trajectory, span: tuple[float, float], own: Any) -> tuple[Any, Any, Any, Any]:
    """Displacement without drift and velocity over a span, and both at the strobe times (empty without a drive)."""
    start, end = span
    if run.model.period is None:
        t, v = samples_over(run, start, end, "v")
        none = np.empty(0)
        return samples_over(run, start, end, "x")[1][own] - machine_of(run.model).far_end_velocity * t, v[own], none, none
    count = max(round((end - start) / run.period_time), 1)
    events = np.array([e.t for e in run.events if start < e.t < end])
    t = np.unique(np.concatenate([np.linspace(start, end, 400 * count + 1), events]))
    columns, ends = run.at(t), run.at(np.array([start, end]))
    drift = (ends["x"][1] - ends["x"][0])[own] / (end - start)
    strobe = run.at(np.clip(run.strobe_times[-count - 1 :], start, end))
    s = columns["x"][own] - drift * (t - start)
    middle = 0.5 * (s.max() + s.min())
    return s - middle, columns["v"][own], strobe["x"][own] - drift * (strobe["t"] - start) - middle, strobe["v"][own]


@drawing
def forces(run: Trajectory, periods: float | None = None, ax: Ax = None, duration: float | None = None) -> Any:
    """Drive force and friction force over the last drive periods, with the static friction limits if the law has them.

    Without a drive, only the friction force is drawn; for a machine of several contacts, that of each.

    Parameters
    ----------
    run : Trajectory
    periods : float, optional
        How many drive periods to show; 2 if not given.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.
    duration : float, optional
        How much of the end of the run to show [s], instead of `periods`. Without a drive, all of it is shown if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), periods=20)
    >>> ss.plot.forces(run).lines[-1].get_label()
    'friction force $R$'
    """
    run = only_run(run, bodies=False)
    if not run.contacts:
        instead = "ss.plot.velocity(run), or ss.plot.contacts(run) for stops" if run.pieces.layout.bodies else "ss.plot.states(run)"
        raise InputError("plot", [f"it has no contact, and so no friction force; type {instead}"])
    if not run.pieces.layout.single or not run.pieces.layout.bodies:
        return _forces_of_contacts(run, periods, ax, duration)
    start, end = span(run, 2 if periods is None and run.model.period is not None else periods, duration)
    shown = {"friction force $R$": "friction_force"}
    if machine_of(run.model).drive is not None:
        shown = {"drive force $-m\\ddot\\xi$": "drive_force", **shown}
    curves = {name: samples_over(run, start, end, column) for name, column in shown.items()}
    time, seconds = prefix(end - start)
    factor, unit = prefix(*(f for _, f in curves.values()))
    ax = axes(ax)
    shaded = _shade(ax, sticking_intervals(run, start, end), start, time)
    t, _ = next(iter(curves.values()))
    dashed: dict[str, Any] = {"color": INK, "linewidth": 0.6, "linestyle": (0, (2, 2)), "zorder": 1}
    for i, limit in enumerate(limits(run, t)):
        ax.plot((t - start) * time, limit * factor, label=None if i else "break-away", **dashed)
    for i, (name, (t, F)) in enumerate(curves.items()):
        ax.plot((t - start) * time, F * factor, color=COLOURS[len(curves) - 1 - i], linestyle="-", label=name, zorder=2 + i)
    time_axis(ax, run, (start, end), time, seconds)
    ax.set_ylabel(f"force ({unit}N)")
    handles = [*ax.get_legend_handles_labels()[0], *shaded]
    legend_above(ax, handles=handles, ncols=2, columnspacing=1.2)
    return ax


def _forces_of_contacts(run: Trajectory, periods: float | None, ax: Any, duration: float | None) -> Any:
    """Friction force of each contact."""
    start, end = span(run, 2 if periods is None and run.model.period is not None else periods, duration)
    has_units = adapter_of(run.model).has_units
    curves = _forces_over(run, start, end)
    time, seconds = clock(run, end - start)
    newtons = (
        _units([run], "load", "contact") if run.pieces.layout.bodies else [unit_of("load", run.model) if has_units else ""] * len(curves)
    )
    factors, units = in_their_units([R for *_, R in curves], newtons)
    ax = axes(ax)
    ax.axhline(0.0, color=INK, linewidth=0.5, zorder=1)
    for i, ((_, _, t, R), name) in enumerate(zip(curves, _with_units([name for name, *_ in curves], units), strict=True)):
        ax.plot((t - start) * time, R * factors[i], color=COLOURS[i % 7], linestyle=DASHES[i % 7], label=name, zorder=2 + i)
    time_axis(ax, run, (start, end), time, seconds)
    ax.set_ylabel(shared_unit(f"friction {'torque' if set(newtons) == {'N m'} else 'force'} $R$", units))
    return _finish(ax, curves)


def _forces_over(run: Trajectory, start: float, end: float) -> list[tuple[str, int, Any, Any]]:
    """The friction force of each contact over a span, as `_sampled` gives curves."""
    if run.pieces.layout.bodies:
        return _sampled([run], [""], [(start, end)], "friction_force", "contact")
    return [(name, 0, *samples_over(run, start, end, f"friction_force_{name}")) for name in run.contacts]


def limits(run: Trajectory, t: Array) -> tuple[Any, ...]:
    """Break-away forces at given times: a set-valued law's own; for a dynamic law with static coefficients, the load times these."""
    law, load = law_of(run.model), normal_load(run.model, t, 0.0) + 0.0 * t
    limits = law.limits(load) if not law.dynamic or hasattr(law.law, "f_plus") else None
    return () if limits is None else tuple(limit + 0.0 * t for limit in limits)
