"""Branches of periodic motions along a parameter, with their special points, over the cloud of a bifurcation diagram."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Ax, Grid
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.dynamics.continuation.branches import Branch
from stickslip.dynamics.stroboscopic.strobe_maps import strobe_states
from stickslip.models.machine_adapter import machine_of
from stickslip.models.rounding import without_rounding
from stickslip.show.figures.special_kinds import marker_of, name_once
from stickslip.show.figures.style import (
    COLOURS,
    INK,
    UNSETTLED,
    UNSETTLED_MARK,
    axes,
    axis_label,
    dot_size,
    drawing,
    labelled,
    legend_above,
    scaled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_STABLE: dict[str, Any] = {"linestyle": "-", "linewidth": 1.4}
_UNSTABLE: dict[str, Any] = {"linestyle": (0, (3, 1.5)), "linewidth": 0.9}
_CLOUD = "#B4BCC6"


@drawing
def continuation(
    branch: Branch | Sequence[Branch],
    observable: str | None = None,
    ax: Ax = None,
    diagram: Grid | None = None,
    labels: Sequence[str] | None = None,
    special: bool = True,
) -> Any:
    """Branches of periodic orbits: stable parts as solid lines, unstable ones dashed, special points marked.

    Small dots are the orbits that were computed. The curve between them is interpolated without overshoot (by PCHIP, over the length
    of the branch); a kink that is no special point is drawn rounded.

    A branch of period p shows the strobe points of all its p drive periods where `observable` is a coordinate of the state.

    Parameters
    ----------
    branch : Branch or list of Branch
        From `stickslip.continuation`.
    observable : str, optional
        A column of ``branch.points``: "v", "z", "mean_velocity", "margin", "largest_multiplier"; for several bodies "v.body" and so on;
        for limit cycles also "amplitude", "duration" and "x". The default is the velocity on the strobe; for a flow its first state; for
        limit cycles their amplitude, by which a branch does not cross itself at its fold; for several bodies the mean velocity or, with a
        diagram, the velocity of the first body on the strobe.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.
    diagram : xarray.Dataset, optional
        From `stickslip.bifurcation`: its points are drawn as pale dots below the branches.
    labels : list of str, optional
        Names of the branches. The default is their periods; for limit cycles, the number of turns of the spring.
    special : bool
        Whether to mark special points. Borders of motion types are marked under set-valued laws only, where they need no threshold.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> branch = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=7e-4, stop=8e-4, tilt_deg=1.7, law="coulomb")
    >>> ss.plot.continuation(branch, "mean_velocity").get_ylabel()
    'mean velocity $V$ (mm/s)'
    """
    branches: list[Branch] = [branch] if isinstance(branch, Branch) else list(branch) if isinstance(branch, (list, tuple)) else []
    if not branches or not all(isinstance(b, Branch) for b in branches):
        raise InputError("plot", [f"branch = {branch!r}; allowed is a Branch or a list of them, from ss.continuation"])
    if labels is not None and len(labels) != len(branches):
        raise InputError("plot", [f"labels has {len(labels)} texts for {len(branches)} branches; give one for each"])
    parameter, across = branches[0].parameter, branches[0].points[branches[0].parameter]
    cycles = branches[0].orbits[0].model.period is None
    observable = observable or _usual(branches[0], diagram, cycles)
    shown = [_values(b, observable) for b in branches]
    attributes = branches[0].points[observable].attrs
    unit = attributes.get("units", {"v": "m/s", "z": "m", "x": "m"}.get(observable, "1"))
    up, mark = scaled(np.concatenate([s.ravel() for s in shown]), unit)
    right, side = scaled(across.values, across.attrs["units"])
    ax = axes(ax, height=2.6)
    if diagram is not None:
        _cloud(ax, diagram, parameter, observable, right, up)
    for i, (b, values) in enumerate(zip(branches, shown, strict=True)):
        name = labels[i] if labels is not None else _called(b.period, cycles)
        _line(ax, b, observable, values * up, right, up, COLOURS[i % 7], name)
    if not all(o.stable for b in branches for o in b.orbits):
        ax.plot([], [], color=INK, label="unstable", **_UNSTABLE)
    if observable == "largest_multiplier":
        ax.axhline(1.0, color=INK, linewidth=0.5, zorder=1)
    if special:
        _marks(ax, branches, observable, right, up)
    ax.set_xlabel(labelled(across, side))
    ax.set_ylabel(axis_label((_OF_CYCLES if cycles else OBSERVABLES).get(observable, attributes.get("long_name", observable)), unit, mark))
    handles, texts = ax.get_legend_handles_labels()
    order = sorted(range(len(texts)), key=lambda k: texts[k] in ("brute force", "not settled"))  # branches first
    legend_above(
        ax, [handles[k] for k in order], [texts[k] for k in order], ncols=min(len(order), 4) if len(order) < 5 else 3,
        columnspacing=1.0, handletextpad=0.5, handlelength=1.6,
    )  # fmt: skip
    return ax


def _usual(branch: Any, diagram: Any, cycles: bool) -> str:
    """The default observable; with a diagram, one that branch and diagram have in common."""
    first = branch.orbits[0]
    parts = [n for n in first.names if n.startswith("v.")] if diagram is not None else []
    known = ["amplitude", "duration"] if cycles else [*(first.names if "pattern" in first.words else ("v", *parts)), "mean_velocity"]
    shared = [name for name in known if name in branch.points and (diagram is None or name in diagram)]
    return shared[0] if shared else next((name for name in known if name in branch.points), "mean_velocity")


def _called(period: int, cycle: bool) -> str:
    """The default name of a branch."""
    if cycle:
        return "limit cycle" if period == 1 else f"limit cycle of {period} turns"
    return f"period {period}"


OBSERVABLES = {
    "v": "velocity on the strobe $v$", "z": "bristle on the strobe $z$", "mean_velocity": "mean velocity $V$",
    "largest_multiplier": "largest multiplier $|\\lambda|$", "margin": "margin of the motion type", "x": "position on the strobe $x$",
}  # fmt: skip
_OF_CYCLES = OBSERVABLES | {
    "v": "velocity at the turning point $v$", "x": "turning point of the spring $x$", "z": "bristle at the turning point $z$",
    "amplitude": "amplitude of the cycle", "duration": "duration of the cycle",
}  # fmt: skip
_LOOSE = 1e-6  # of the range of a branch: a border of types that is known no better is a jump
_BETWEEN = 12  # points of a drawn curve from one orbit of a branch to the next


def _values(branch: Any, observable: str) -> Any:
    """The observable along a branch, of shape (points, 1), or (points, period) for a coordinate of the state."""
    numbers = [str(n) for n, column in branch.points.data_vars.items() if column.ndim == 1 and column.dtype.kind in "biuf"]
    if observable not in numbers:
        raise InputError("plot", [f"observable = {observable!r}; allowed is one of {', '.join(numbers)}"])
    first = branch.orbits[0]
    if observable not in first.names or branch.period == 1 or first.model.period is None:
        values = branch.points[observable].values.astype(float)
        if observable == "mean_velocity":
            values = np.array([without_rounding(value, o.model) for value, o in zip(values, branch.orbits, strict=True)])
        return values[:, None]
    return np.array([_strobed(orbit, observable) for orbit in branch.orbits])


def _strobed(orbit: Any, observable: str) -> Any:
    """A coordinate at the start of every drive period of an orbit; without a drive, at the start of the cycle."""
    run, column = orbit.run, orbit.names.index(observable)
    if run.model.period is None:
        return orbit.state[column : column + 1]
    if not run.pieces.layout.bodies:
        return run.strobe[: orbit.period, column]
    return strobe_states(run)[: orbit.period, column]


def _line(ax: Axes, branch: Any, observable: str, values: Array, right: float, up: float, colour: str, name: str) -> None:
    x, values, stable, jumps = _with_changes(branch, observable, values / up)
    x, values = x * right, values * up
    for column in values.T:
        for state, style in ((True, _STABLE), (False, _UNSTABLE)):
            keep = stable == state
            keep = keep | np.roll(keep, 1) & (np.arange(len(keep)) > 0) & ~jumps  # the parts meet where the stability changes
            for part in _runs_of(keep, jumps):
                ax.plot(*_curve(x[part], column[part]), color=colour, zorder=4, **style)
                ax.plot(x[part], column[part], "o", color=colour, markersize=2.6, markeredgewidth=0, zorder=4)
    ax.plot([], [], color=colour, label=name)


def _runs_of(keep: Array, jumps: Array) -> list[slice]:
    """The stretches of a mask that are True, cut before each place that a branch reaches by a jump."""
    ends = np.flatnonzero(np.diff(np.concatenate([[False], keep, [False]]).astype(int)))
    cut = [[a, *(a + 1 + np.flatnonzero(jumps[a + 1 : b])), b] for a, b in zip(ends[::2], ends[1::2], strict=True)]
    return [slice(a, b) for places in cut for a, b in pairwise(places)]


def _jumps(branch: Any) -> Array:
    """Of each orbit, whether the branch jumps to it: a border of types lies before it that is known no better than the step there.

    Under static friction above the kinetic one motions end where a body that turned now sticks, and the branch goes on with another one.
    """
    x, span = branch.values, float(np.ptp(branch.values)) or 1.0
    loose = [s.value for s in branch.special if s.kind == "type-border" and s.accuracy > _LOOSE * span]
    patterns = [str(orbit.words.get("patterns", orbit.pattern)) for orbit in branch.orbits] if loose else [""] * len(x)
    between = [any(min(a, b) - _LOOSE * span <= value <= max(a, b) + _LOOSE * span for value in loose) for a, b in pairwise(x)]
    return np.array([False, *(near and a != b for near, (a, b) in zip(between, pairwise(patterns), strict=True))])


def _curve(x: Array, y: Array) -> tuple[Array, Array]:
    """A dense curve through some points of a branch, in their order; jumps to NaN and whole numbers, as of a memory, stay as they are."""
    if len(x) < 3 or not np.isfinite(x).all() or not np.isfinite(y).all() or np.array_equal(y, np.round(y)):
        return x, y
    from scipy.interpolate import PchipInterpolator

    steps = np.hypot(np.diff(x) / (np.ptp(x) or 1.0), np.diff(y) / (np.ptp(y) or 1.0))
    keep = np.concatenate([[True], steps > 0])  # two orbits at one place
    if keep.sum() < 3:
        return x, y
    along = np.concatenate([[0.0], np.cumsum(steps)])[keep]
    dense = np.interp(np.linspace(0, len(along) - 1, _BETWEEN * (len(along) - 1) + 1), np.arange(len(along)), along)
    return PchipInterpolator(along, x[keep])(dense), PchipInterpolator(along, y[keep])(dense)


def _with_changes(branch: Any, observable: str, values: Array) -> tuple[Any, Any, Any, Any]:
    """Parameter, observable, stability and jumps along a branch, including the special points at which the stability changes."""
    x, stable, jumps = branch.values, np.array([o.stable for o in branch.orbits]), _jumps(branch)
    places, extra = [], []
    for i in np.flatnonzero(stable[1:] != stable[:-1]):
        low, high = sorted(x[i : i + 2])
        here = [s for s in branch.special if s.changes_stability and low <= s.value <= high]
        places += [i + 1] * len(here[:1])
        extra += here[:1]
    if not extra:
        return x, values, stable, jumps
    inserted = np.array([np.ravel(_at(s.orbit, observable))[: values.shape[1]] for s in extra])
    x = np.insert(x, places, [s.value for s in extra])
    return x, np.insert(values, places, inserted, axis=0), np.insert(stable, places, stable[places]), np.insert(jumps, places, False)


def _at(orbit: Any, observable: str) -> Any:
    """The observable of one orbit: a single value, or one for each of its drive periods."""
    return _strobed(orbit, observable) if observable in orbit.names else [_of_orbit(orbit, observable)]


def _cloud(ax: Any, diagram: Any, parameter: str, observable: str, right: float, up: float) -> None:
    if observable not in diagram:
        raise InputError("plot", [f"the diagram has no {observable!r}; it has {', '.join(map(str, diagram.data_vars))}"])
    y = diagram[observable]
    x = diagram[parameter].broadcast_like(y).values.ravel() * right
    size = dot_size(diagram.sizes[parameter])
    dots = {"color": _CLOUD, "markersize": size, "markeredgewidth": 0}  # wider than the branches over them
    late = (diagram.motion == "not settled").broadcast_like(y).transpose(*y.dims).values.ravel()
    ax.plot(x[~late], y.values.ravel()[~late] * up, "o", zorder=1, rasterized=True, **dots)
    ax.plot([], [], "o", label="brute force", **dots | {"markersize": 4})
    if late.any():
        style: dict[str, Any] = {"linestyle": "", "marker": UNSETTLED_MARK, "color": UNSETTLED, "markeredgewidth": 0.5}
        ax.plot(x[late], y.values.ravel()[late] * up, zorder=1, markersize=max(size, 2.0), rasterized=True, **style)
        ax.plot([], [], label="not settled", markersize=4, **style)


def _marks(ax: Any, branches: list[Any], observable: str, right: float, up: float) -> None:
    labelled_kinds: set[str] = set()
    for b in branches:
        for s in b.special:
            if s.kind == "type-border" and machine_of(s.orbit.model).has_inner_states:
                continue  # types that depend on thresholds are not properties of the dynamics
            marker = marker_of(s.kind)
            values = _at(s.orbit, observable)
            face = COLOURS[6] if marker == "|" else "white"
            style = {"markersize": 7 if marker == "|" else 3.2, "color": face, "markeredgecolor": INK, "markeredgewidth": 0.9, "zorder": 6}
            x = np.full(len(values), s.value * right)
            ax.plot(x, np.asarray(values) * up, marker=marker, linestyle="", label=name_once(s.kind, labelled_kinds), **style)


def _of_orbit(orbit: Any, observable: str) -> float:
    return float(abs(orbit.multipliers).max()) if observable == "largest_multiplier" else float(getattr(orbit, observable))
