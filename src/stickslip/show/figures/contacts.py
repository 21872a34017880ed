"""Modes of every contact as a bar chart: one row for each contact and each stop."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stickslip.analysis.contact_modes import contact_modes, landings, stop_rows
from stickslip.analysis.motion import Motion, Motions
from stickslip.basics.arguments import Ax
from stickslip.basics.errors import NoBodies
from stickslip.results.trajectory import Trajectory
from stickslip.show.figures.runs import clock, only_run, span, time_axis
from stickslip.show.figures.style import COLOURS, INK, SHADE, axes, drawing, legend_above, name_rows

if TYPE_CHECKING:
    from matplotlib.axes import Axes


AIR = "#d6e6f5"  # pale: no contact, no friction
#: Names, colours and hatches of the bars, in the order of the legend: +1, 0, -1, a stop in contact, and flight.
MODES: dict[int, tuple[str, str, str]] = {
    1: ("forwards", COLOURS[0], ""), -1: ("backwards", COLOURS[1], "////"), 0: ("sticks", SHADE, ""),
    2: ("stop pressed", COLOURS[2], "...."), 3: ("in flight", AIR, ""),
}  # fmt: skip
_ROW, _AROUND = 0.27, 0.75  # inches


@drawing
def contacts(run: Trajectory, periods: float | None = None, ax: Ax = None, duration: float | None = None) -> Any:
    """The state of each contact over the last drive periods: sticking, sliding forwards or backwards, or flight; and hits on stops.

    Under a law with inner states, which never rests, a contact sticks by the rule of `stickslip.motion`; of a flow the side of its slip
    is drawn.

    Parameters
    ----------
    run : Trajectory
    periods : float, optional
        How many drive periods to show; 3 if not given.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.
    duration : float, optional
        How much of the end of the run to show [s], instead of `periods`. Without a drive, all of it is shown if not given.

    Returns
    -------
    matplotlib Axes
        A row for each contact by its name, the first at the top, then one for each stop. A triangle is an impact or a landing, a cross the
        loss of a contact.

    Examples
    --------
    >>> import stickslip as ss
    >>> ax = ss.plot.contacts(ss.solve(ss.Chain.example(), periods=20), periods=2)
    >>> [label.get_text() for label in ax.get_yticklabels()]
    ['module 1', 'module 2']
    """
    run = only_run(run, bodies=False)
    if not run.contacts and not run.pieces.layout.bodies:
        raise NoBodies("plot", ["a flow without contacts has no modes of contacts; type ss.plot.states(run), which marks its switches"])
    start, end = span(run, periods, duration)
    modes, stops = contact_modes(run, start, end), stop_rows(run, start, end)
    rows, bars = [*modes, *stops], {**modes, **{name: pressed for name, (pressed, _) in stops.items()}}
    time, seconds = clock(run, end - start)
    ax = axes(ax, _AROUND + _ROW * len(rows))
    shown = _bars(ax, rows, bars, start, time)
    struck = {name: struck for name, (_, struck) in stops.items()}
    marks = _marks(ax, rows, (struck, landings(run, start, end), _lost(run, start, end)), start, time)
    name_rows(ax, rows, 0.5)
    ax.invert_yaxis()
    time_axis(ax, run, (start, end), time, seconds)
    legend_above(ax, handles=[*shown, *marks], ncols=len(shown) + len(marks), columnspacing=1.2, handlelength=1.6)
    return ax


@drawing
def pattern(motion: Motion | Motions, ax: Ax = None) -> Any:
    """The motion period of each contact: its intervals of forward sliding, sticking and backward sliding, in order.

    Parameters
    ----------
    motion : Motion or Motions
        From `stickslip.motion`.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), periods=20)
    >>> ss.plot.pattern(ss.motion(run)).get_xlabel()
    'drive periods'
    """
    motions = motion.contacts if isinstance(motion, Motions) else {"": motion}
    rows = list(motions)
    bars = {name: [(a, a + length, sign) for a, length, sign in one.intervals] for name, one in motions.items()}
    ax = axes(ax, _AROUND + _ROW * len(rows))
    shown = _bars(ax, rows, bars, 0.0, 1.0)
    name_rows(ax, rows, 0.5)
    ax.invert_yaxis()
    ax.set_xlabel("drive periods")
    ax.margins(x=0)
    legend_above(ax, handles=shown, ncols=len(shown), columnspacing=1.2, handlelength=1.6)
    return ax


def _lost(run: Trajectory, start: float, end: float) -> dict[str, list[float]]:
    """Times at which contacts were lost, by name."""
    if not run.pieces.layout.bodies:  # the run of a flow ends there
        return {}
    return {event.part: [event.t] for event in run.events if event.kind == "contact lost" and start <= event.t <= end}


def _bars(ax: Axes, rows: list[str], bars: dict[str, list[Any]], start: float, time: float) -> list[Any]:
    """Draw the bars; returns handles for the legend."""
    from matplotlib.patches import Patch

    kinds = set()
    for row, name in enumerate(rows):
        for kind, (_, colour, hatch) in MODES.items():
            of = [((a - start) * time, (b - a) * time) for a, b, sign in bars.get(name, []) if sign == kind]
            if of:
                kinds.add(kind)
                ax.broken_barh(of, (row - 0.36, 0.72), facecolor=colour, hatch=hatch, edgecolor="white", linewidth=0.0)
    return [
        Patch(facecolor=colour, hatch=hatch * 2, edgecolor="white" if hatch else INK, linewidth=0.0 if hatch else 0.3, label=word)
        for kind, (word, colour, hatch) in MODES.items()
        if kind in kinds
    ]


def _marks(ax: Any, rows: list[str], times: tuple[Any, Any, Any], start: float, time: float) -> list[Any]:
    """Draw hits, landings and lost contacts; returns handles for the legend."""
    handles = []
    for (word, marker), of in zip((("hit", "v"), ("landing", "v"), ("contact lost", "X")), times, strict=True):
        at = [((t - start) * time, rows.index(name)) for name, times in of.items() for t in times]
        if at:
            style = {"linestyle": "", "marker": marker, "color": INK, "markersize": 4.5, "clip_on": False}
            handles += ax.plot(*zip(*at, strict=True), label=word, zorder=3, **style)
    return handles
