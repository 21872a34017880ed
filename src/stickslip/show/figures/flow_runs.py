"""Figures of runs of switching flows: states over time, and one against another."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.arguments import Ax
from stickslip.basics.errors import InputError, did_you_mean
from stickslip.results.trajectory import Trajectory
from stickslip.show.figures.style import COLOURS, DASHES, INK, axes, drawing, legend_above

_POINTS = 1200


@drawing
def states(run: Any, *names: str, duration: float | None = None, ax: Ax = None) -> Any:
    """The states of a run of a switching flow over time; thin lines mark its switches.

    Parameters
    ----------
    run : Trajectory
        Of a `SwitchingFlow`.
    *names : str
        Names of the states; all if not given.
    duration : float, optional
        How much of the end of the run to show; all if not given.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> hit = ss.Switch(lambda t, y: y[0], 0, lambda t, y: (0.0, -0.8 * y[1]))
    >>> ball = ss.SwitchingFlow({0: lambda t, y: (y[1], -9.81)}, {0: (hit,)}, states=("height", "v"))
    >>> ax = ss.plot.states(ss.solve(ball, start={"height": 1.0}, duration=2.0))
    >>> [line.get_label() for line in ax.lines[:2]]
    ['height', 'v']
    """
    _check(run, names)
    names = names or run.names
    t, y = _sampled(run, duration)
    ax = axes(ax)
    for i, name in enumerate(names):
        ax.plot(t, y[:, run.names.index(name)], color=COLOURS[i % 7], linestyle=DASHES[i % 7], label=name)
    for event in run.events:
        if t[0] <= event.t:
            ax.axvline(event.t, color=INK, linewidth=0.3, zorder=1)
    for event in run.named_events:
        if t[0] <= event.t:
            ax.axvline(event.t, color=COLOURS[0], linewidth=0.6, linestyle=":", zorder=1)
    ax.set(xlabel="time", ylabel=names[0] if len(names) == 1 else "states")
    if len(names) > 1:
        legend_above(ax, ncols=len(names))
    return ax


def flow_phase(run: Any, x: str | None = None, y: str | None = None, ax: Any = None, duration: float | None = None) -> Any:
    """One state of a run against another, with the strobe points of a forced flow marked."""
    if len(run.names) < 2:
        raise InputError("plot", [f"the flow has one state, {run.names[0]}; allowed are two or more; type ss.plot.states(run)"])
    named = (x or run.names[0], y or run.names[1])
    _check(run, named)
    columns = [run.names.index(name) for name in named]
    t, columns_at = _sampled(run, duration)
    ax = axes(ax, height=2.5)
    ax.plot(*columns_at[:, columns].T, color=COLOURS[0])
    if run.model.period is not None:
        points = run.strobe[run.strobe_times >= t[0]][:, columns]
        ax.plot(*points.T, "o", markersize=4, color="white", markeredgecolor=COLOURS[0], markeredgewidth=1.1, zorder=9)
    ax.set(xlabel=named[0], ylabel=named[1])
    ax.margins(0.06)
    return ax


def _check(run: Trajectory, names: Any) -> None:
    if not isinstance(run, Trajectory) or run.pieces.layout.bodies:
        raise InputError(
            "plot",
            [f"run = {run!r}; allowed is a run of a SwitchingFlow; type ss.plot.states(ss.solve(flow, start=[1.0, 0.0], duration=5.0))"],
        )
    for name in names:
        if name not in run.names:
            raise InputError("plot", [f"{name!r} is not a state of the flow; {did_you_mean(str(name), run.names)}"])


def _sampled(run: Any, duration: float | None) -> tuple[Any, Any]:
    """The states over the last `duration` of a run, or all of it, with a pair of points at each switch."""
    first, end = float(run.nodes[0]), float(run.nodes[-1])
    begin = first if duration is None else max(end - duration, first)
    events = np.array([event.t for event in run.events if begin < event.t < end])
    just = 1e-12 * (end - begin)
    t = np.clip(np.sort(np.concatenate([np.linspace(begin, end, _POINTS), events - just, events])), begin, end)
    columns_at = run.at(t)
    return t, np.column_stack([columns_at[name] for name in run.names])
