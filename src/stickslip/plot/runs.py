"""Pictures of one run or of several: velocity against time, phase portrait, forces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from stickslip.analysis.motion import motion
from stickslip.analysis.steady import LONGEST_PERIOD, period_number
from stickslip.errors import InputError
from stickslip.forces import is_dynamic, normal_load
from stickslip.plot.style import COLOURS, DASHES, INK, SHADE, axes, prefix, publication
from stickslip.summary import Summary

__all__ = ["forces", "limits", "phase", "rests", "sampled", "span", "velocity"]

_POINTS = 1200  # per curve


def _runs(run: Any) -> list[Any]:
    runs = list(run) if isinstance(run, (list, tuple)) else [run]
    if not runs or any(isinstance(r, Summary) or not hasattr(r, "pieces") for r in runs):
        raise InputError("plot", [f"run = {run!r}; allowed is a Trajectory or a list of them; type ss.plot.velocity(ss.solve(robot))"])
    return runs


def _labels(runs: list[Any], labels: Sequence[str] | None) -> list[str]:
    if labels is not None and len(labels) != len(runs):
        raise InputError("plot", [f"labels has {len(labels)} texts for {len(runs)} runs; give one for each run"])
    return list(labels) if labels is not None else [type(r.model.friction).__name__ for r in runs]


def span(run: Any, periods: float) -> tuple[float, float]:
    """The last `periods` whole drive periods of a run."""
    if not periods > 0:
        raise InputError("plot", [f"periods = {periods!r}; allowed is a positive number of drive periods; type periods=3"])
    end = float(run.strobe_times[-1])
    return max(end - periods * run.period_time, float(run.pieces.t[0])), end


def sampled(run: Any, start: float, end: float, column: str) -> tuple[Any, Any]:
    """A column over a span, with a pair of points at each event, so that corners and jumps are sharp."""
    events = np.array([e.t for e in run.events if start < e.t < end])
    grid = np.linspace(start, end, _POINTS)
    just = 1e-9 * run.period_time
    t = np.sort(np.concatenate([grid, events - just, events]))
    return t, run.at(np.clip(t, start, end))[column]


def rests(run: Any, start: float, end: float) -> list[tuple[float, float]]:
    """Where the body rests: exactly under a set-valued law, by the rule of `motion` under a dynamic one."""
    if not is_dynamic(run.model.friction):
        t, mode = run.pieces.t, np.asarray(run.pieces.mode)
        found = [(t[i], t[i + 1]) for i in np.flatnonzero(mode == 0)]
    else:
        told = motion(run)
        if told.type in ("rest", "presliding"):
            return []
        T, count = run.period_time, told.period or 1
        begin = float(run.strobe_times[-1]) - count * T
        turns = np.arange(-np.ceil((end - start) / (count * T)) - 1, 1) * count * T
        found = [(begin + k + a * T, begin + k + (a + b) * T) for k in turns for a, b, sign in told.intervals if sign == 0]
    return [(max(a, start), min(b, end)) for a, b in found if b > start and a < end]


def _finish(ax: Any, runs: list[Any]) -> Any:
    if len(runs) > 1:
        ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=len(runs), borderaxespad=0.2, columnspacing=1.4)
    return ax


def _shade(ax: Any, rests: list[tuple[float, float]], start: float, factor: float) -> None:
    for a, b in rests:
        ax.axvspan((a - start) * factor, (b - start) * factor, color=SHADE, linewidth=0, zorder=0)


def velocity(run: Any, periods: float = 3, ax: Any = None, labels: Sequence[str] | None = None) -> Any:
    """Velocity of the body over the last drive periods; where the body sticks the background is shaded.

    Parameters
    ----------
    run : Trajectory or list of Trajectory
        Of several runs the first one's rest is shaded.
    periods : float
        How many drive periods to show.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.
    labels : list of str, optional
        Names of the runs; their laws' names if not given.

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
    runs = _runs(run)
    names, spans = _labels(runs, labels), [span(r, periods) for r in runs]
    curves = [sampled(r, *span, "v") for r, span in zip(runs, spans, strict=True)]
    time, seconds = prefix(*(b - a for a, b in spans))
    factor, unit = prefix(*(v for _, v in curves))
    with publication():
        ax = axes(ax)
        _shade(ax, rests(runs[0], *spans[0]), spans[0][0], time)
        ax.axhline(0.0, color=INK, linewidth=0.5, zorder=1)
        for i, ((t, v), (start, _), name) in enumerate(zip(curves, spans, names, strict=True)):
            ax.plot((t - start) * time, v * factor, color=COLOURS[i % 7], linestyle=DASHES[i % 7], label=name, zorder=2 + i)
        ax.set_xlim(0.0, (spans[0][1] - spans[0][0]) * time)
        ax.set_xlabel(f"time $t - {round(spans[0][0] / runs[0].period_time)}\\,T$ ({seconds}s)")
        ax.set_ylabel(f"velocity $v$ ({unit}m/s)")
        return _finish(ax, runs)


def phase(run: Any, periods: float | None = None, ax: Any = None, labels: Sequence[str] | None = None) -> Any:
    """Phase portrait: velocity against the displacement without its drift, with the strobe points marked.

    The mean motion over the periods shown is taken out, as the paper does ("subtracting the rigid displacements"), so that a
    periodic motion gives a closed curve with one strobe point for each of its drive periods.

    Parameters
    ----------
    run : Trajectory or list of Trajectory
    periods : float, optional
        How many drive periods to show; if not given, one motion period, or up to 16 drive periods if the motion does not repeat.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.
    labels : list of str, optional
        Names of the runs; their laws' names if not given.

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
    runs = _runs(run)
    names = _labels(runs, labels)
    orbits = [_orbit(r, span(r, periods if periods is not None else _shown(r))) for r in runs]
    across, metres = prefix(*(s for s, _, _, _ in orbits))
    up, unit = prefix(*(v for _, v, _, _ in orbits))
    with publication():
        ax = axes(ax, height=2.5)
        ax.axhline(0.0, color=INK, linewidth=0.5, zorder=1)
        for i, ((s, v, strobe_s, strobe_v), name) in enumerate(zip(orbits, names, strict=True)):
            ax.plot(s * across, v * up, color=COLOURS[i % 7], linestyle=DASHES[i % 7], label=name, zorder=2 + i)
            marker = {"markersize": 4, "color": "white", "markeredgecolor": COLOURS[i % 7], "markeredgewidth": 1.1}
            ax.plot(strobe_s * across, strobe_v * up, "o", zorder=9, **marker)
        ax.set_xlabel(f"displacement without drift $x - Vt$ ({metres}m)")
        ax.set_ylabel(f"velocity $v$ ({unit}m/s)")
        ax.margins(0.06)
        return _finish(ax, runs)


def _shown(run: Any) -> int:
    """One motion period, or what there is of 16 drive periods if none was found."""
    return period_number(run) or max(min(LONGEST_PERIOD, len(run.strobe_times) - 1 - int(run.settle)), 1)


def _orbit(run: Any, span: tuple[float, float]) -> tuple[Any, Any, Any, Any]:
    """Displacement without drift and velocity over a span, and both at the strobe times."""
    start, end = span
    count = max(round((end - start) / run.period_time), 1)
    events = np.array([e.t for e in run.events if start < e.t < end])
    t = np.unique(np.concatenate([np.linspace(start, end, 400 * count + 1), events]))
    found, ends = run.at(t), run.at(np.array([start, end]))
    drift, strobe = (ends["x"][1] - ends["x"][0]) / (end - start), run.at(np.clip(run.strobe_times[-count - 1 :], start, end))
    s = found["x"] - drift * (t - start)
    middle = 0.5 * (s.max() + s.min())
    return s - middle, found["v"], strobe["x"] - drift * (strobe["t"] - start) - middle, strobe["v"]


def forces(run: Any, periods: float = 2, ax: Any = None) -> Any:
    """Drive force and friction force over the last drive periods, with the break-away forces or the limits of sliding.

    Parameters
    ----------
    run : Trajectory
    periods : float
        How many drive periods to show.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

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
    (run,) = _runs(run) if len(_runs(run)) == 1 else _runs(None)
    start, end = span(run, periods)
    shown = {"drive force $-m\\ddot\\xi$": "drive_force", "friction force $R$": "friction_force"}
    curves = {name: sampled(run, start, end, column) for name, column in shown.items()}
    time, seconds = prefix(end - start)
    factor, unit = prefix(*(f for _, f in curves.values()))
    with publication():
        ax = axes(ax)
        _shade(ax, rests(run, start, end), start, time)
        t, _ = next(iter(curves.values()))
        dashed = {"color": INK, "linewidth": 0.6, "linestyle": (0, (2, 2)), "zorder": 1}
        for i, limit in enumerate(limits(run, t)):
            ax.plot((t - start) * time, limit * factor, label=None if i else "break-away", **dashed)
        for i, (name, (t, F)) in enumerate(curves.items()):
            ax.plot((t - start) * time, F * factor, color=COLOURS[1 - i], linestyle="-", label=name, zorder=2 + i)
        ax.set_xlim(0.0, (end - start) * time)
        ax.set_xlabel(f"time $t - {round(start / run.period_time)}\\,T$ ({seconds}s)")
        ax.set_ylabel(f"force ({unit}N)")
        ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, borderaxespad=0.2, columnspacing=1.2)
        return ax


def limits(run: Any, t: Any) -> tuple[Any, ...]:
    """Break-away forces at instants: of a set-valued law its own, of a dynamic law the load times its static coefficients."""
    law, load = run.model.friction, normal_load(run.model, t, 0.0) + 0.0 * t
    if not is_dynamic(law):
        return tuple(limit + 0.0 * t for limit in law.breakaway(load))
    if not hasattr(law, "f_plus"):
        return ()
    plus, minus = (law.f_plus if law.f_plus is not None else law.mu_plus), (law.f_minus if law.f_minus is not None else law.mu_minus)
    return -minus * load, plus * load
