"""Pictures of what a robot's motion becomes along a parameter: branches, diagrams, basins, exponents, spectra."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from stickslip.arguments import Ax, Basin, Exponents, Grid, Ways, explains_arguments
from stickslip.errors import InputError, is_whole
from stickslip.flow import is_flow
from stickslip.machine_adapter import machine_of
from stickslip.plot.spacing import logarithmic
from stickslip.plot.style import COLOURS, INK, axes, labelled, legend_above, named, publication, scaled

__all__ = ["basins", "bifurcation", "continuation", "convergence", "spectrum"]

_MARKERS = {
    "flip": ("s", "flip"), "fold": ("D", "fold"), "neimark-sacker": ("o", "Neimark-Sacker"), "grazing": ("v", "grazing"),
    "type-border": ("|", "border of types"),
}  # fmt: skip
_CLOUD = "#8A94A0"


@explains_arguments
def continuation(
    branch: Ways,
    observable: str | None = None,
    ax: Ax = None,
    diagram: Grid | None = None,
    labels: Sequence[str] | None = None,
    special: bool = True,
) -> Any:
    """Branches of periodic orbits: stable parts as full lines, unstable ones dashed, special points marked.

    A branch of period p shows the strobe points of all its p drive periods where `observable` is a coordinate of the state.

    Parameters
    ----------
    branch : Branch or list of Branch
        From `stickslip.continuation`.
    observable : str, optional
        A column of ``branch.points``: "v", "z", "mean_velocity", "margin", "largest_multiplier"; of limit cycles also "duration" and "x".
        If not given, the velocity on the strobe, of limit cycles their duration.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.
    diagram : xarray.Dataset, optional
        From `stickslip.bifurcation`: its points are drawn below the branches.
    labels : list of str, optional
        Names of the branches; their periods if not given, of limit cycles the turns of the spring in one.
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
    branches = list(branch) if isinstance(branch, (list, tuple)) else [branch]
    if not branches or not all(hasattr(b, "points") and hasattr(b, "special") for b in branches):
        raise InputError("plot", [f"branch = {branch!r}; allowed is a Branch or a list of them, from ss.continuation"])
    if labels is not None and len(labels) != len(branches):
        raise InputError("plot", [f"labels has {len(labels)} texts for {len(branches)} branches; give one for each"])
    parameter, across = branches[0].parameter, branches[0].points[branches[0].parameter]
    cycles = branches[0].orbits[0].model.period is None
    observable = observable or ("duration" if cycles else "v" if "v" in branches[0].points else "mean_velocity")
    shown = [_values(b, observable) for b in branches]
    told = branches[0].points[observable].attrs
    unit = told.get("units", {"v": "m/s", "z": "m", "x": "m"}.get(observable, "1"))
    up, mark = scaled(np.concatenate([s.ravel() for s in shown]), unit)
    right, side = scaled(across.values, across.attrs["units"])
    with publication():
        ax = axes(ax, height=2.6)
        if diagram is not None:
            _cloud(ax, diagram, parameter, observable, right, up)
        for i, (b, values) in enumerate(zip(branches, shown, strict=True)):
            name = labels[i] if labels is not None else _called(b.period, cycles)
            _line(ax, b, observable, values * up, right, up, COLOURS[i % 7], name)
        if observable == "largest_multiplier":
            ax.axhline(1.0, color=INK, linewidth=0.5, zorder=1)
        if special:
            _marks(ax, branches, observable, right, up)
        ax.set_xlabel(labelled(across, side))
        ax.set_ylabel(named((_OF_CYCLES if cycles else _WORDS).get(observable, told.get("long_name", observable)), unit, mark))
        handles, texts = ax.get_legend_handles_labels()
        order = sorted(range(len(texts)), key=lambda k: texts[k] == "brute force")  # branches first
        legend_above(
            ax, [handles[k] for k in order], [texts[k] for k in order], ncols=min(len(order), 4) if len(order) < 5 else 3,
            columnspacing=1.0, handletextpad=0.5, handlelength=1.6,
        )  # fmt: skip
        return ax


def _called(period: int, cycle: bool) -> str:
    """What a branch is called."""
    if cycle:
        return "limit cycle" if period == 1 else f"limit cycle of {period} turns"
    return f"period {period}"


_WORDS = {
    "v": "velocity on the strobe $v$", "z": "bristle on the strobe $z$", "mean_velocity": "mean velocity $V$",
    "largest_multiplier": "largest multiplier $|\\lambda|$", "margin": "margin of the motion type", "x": "position on the strobe $x$",
}  # fmt: skip
_OF_CYCLES = _WORDS | {
    "v": "velocity at the turning point $v$", "x": "turning point of the spring $x$", "z": "bristle at the turning point $z$",
    "duration": "duration of the cycle",
}  # fmt: skip
_ROUNDING = 1e-9  # of the velocity scale: a smaller mean velocity is rounding, and drawn as none


def _values(branch: Any, observable: str) -> Any:
    """The observable along a branch: (points, 1), or (points, period) for a coordinate of the state."""
    numbers = [str(n) for n, column in branch.points.data_vars.items() if column.ndim == 1 and column.dtype.kind in "biuf"]
    if observable not in numbers:
        raise InputError("plot", [f"observable = {observable!r}; allowed is one of {', '.join(numbers)}"])
    first = branch.orbits[0]
    if observable not in first.names or branch.period == 1 or first.model.period is None:
        values = branch.points[observable].values.astype(float)
        if observable == "mean_velocity":
            values[abs(values) < _ROUNDING * np.array([np.max(o.model.velocity_scale) for o in branch.orbits])] = 0.0
        return values[:, None]
    return np.array([_strobed(orbit, observable) for orbit in branch.orbits])


def _strobed(orbit: Any, observable: str) -> Any:
    """A coordinate at the start of every drive period of an orbit; without a drive, at the start of the cycle."""
    run, column = orbit.run, orbit.names.index(observable)
    if run.model.period is None:
        return orbit.state[column : column + 1]
    if is_flow(run.model):
        return run.strobe[: orbit.period, column]
    if observable in ("x", "v"):
        return (run.strobe_x if observable == "x" else run.strobe_v)[: orbit.period]
    family = observable.rstrip("0123456789")
    found = np.asarray(run.strobe_memory if family == "memory" else run.strobe_z)[: orbit.period]
    return found if found.ndim == 1 else found[:, int(observable[len(family) :] or 0)]


def _line(ax: Any, branch: Any, observable: str, values: Any, right: float, up: float, colour: str, name: str) -> None:
    x, values, stable = _with_changes(branch, observable, values / up)
    x, values = x * right, values * up
    for column in values.T:
        for state, dash, width in ((True, "-", 1.4), (False, (0, (3, 1.5)), 0.9)):
            keep = stable == state
            keep = keep | np.roll(keep, 1) & (np.arange(len(keep)) > 0)  # parts touch where stability changes
            ax.plot(np.where(keep, x, np.nan), np.where(keep, column, np.nan), color=colour, linestyle=dash, linewidth=width, zorder=4)
    ax.plot([], [], color=colour, label=name)


def _with_changes(branch: Any, observable: str, values: Any) -> tuple[Any, Any, Any]:
    """Parameter, observable and stability along a branch, with the special points at which stability changes among them."""
    x, stable = branch.values, np.array([o.stable for o in branch.orbits])
    places, extra = [], []
    for i in np.flatnonzero(stable[1:] != stable[:-1]):
        low, high = sorted(x[i : i + 2])
        here = [s for s in branch.special if s.kind in ("flip", "fold") and low <= s.value <= high]
        places += [i + 1] * len(here[:1])
        extra += here[:1]
    if not extra:
        return x, values, stable
    inserted = np.array([np.ravel(_at(s.orbit, observable))[: values.shape[1]] for s in extra])
    x = np.insert(x, places, [s.value for s in extra])
    return x, np.insert(values, places, inserted, axis=0), np.insert(stable, places, stable[places])


def _at(orbit: Any, observable: str) -> Any:
    """The observable of one orbit: a number, or one for each of its drive periods."""
    return _strobed(orbit, observable) if observable in orbit.names else [_of_orbit(orbit, observable)]


def _cloud(ax: Any, diagram: Any, parameter: str, observable: str, right: float, up: float) -> None:
    if observable not in diagram:
        raise InputError("plot", [f"the diagram has no {observable!r}; it has {', '.join(map(str, diagram.data_vars))}"])
    y = diagram[observable]
    x = diagram[parameter].broadcast_like(y).values.ravel() * right
    ax.plot(x, y.values.ravel() * up, ".", markersize=1.5, color=_CLOUD, markeredgewidth=0, zorder=1, rasterized=True)
    ax.plot([], [], ".", markersize=4, color=_CLOUD, label="brute force")


def _marks(ax: Any, branches: list[Any], observable: str, right: float, up: float) -> None:
    used: set[str] = set()
    for b in branches:
        for s in b.special:
            if s.kind == "type-border" and machine_of(s.orbit.model).has_inner_states:
                continue  # words with thresholds: no points of the dynamics
            marker, name = _MARKERS[s.kind]
            values = _at(s.orbit, observable)
            face = COLOURS[6] if marker == "|" else "white"
            style = {"markersize": 7 if marker == "|" else 3.2, "color": face, "markeredgecolor": INK, "markeredgewidth": 0.9, "zorder": 6}
            ax.plot(np.full(len(values), s.value * right), np.asarray(values) * up, marker, label=None if name in used else name, **style)
            used.add(name)


def _of_orbit(orbit: Any, observable: str) -> float:
    return float(abs(orbit.multipliers).max()) if observable == "largest_multiplier" else float(getattr(orbit, observable))


@explains_arguments
def bifurcation(diagram: Grid, observable: str = "v", ax: Ax = None) -> Any:
    """A bifurcation diagram by brute force; upwards and downwards in two colours, so that hysteresis shows.

    Parameters
    ----------
    diagram : xarray.Dataset
        From `stickslip.bifurcation`.
    observable : str
        "v", "z", "displacement", or "mean_velocity", "v_max", "v_min".
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> diagram = ss.bifurcation(ss.presets.piezo_rig, parameter="amplitude", values=[4e-4, 6e-4], settle=20, points=4, follow=False,
    ...                       tilt_deg=1.7, law="coulomb")
    >>> ss.plot.bifurcation(diagram, "mean_velocity").get_xlabel()
    'amplitude of the inner mass $A$ (µm)'
    """
    if "parameter" not in getattr(diagram, "attrs", {}) or observable not in diagram:
        columns = f": {', '.join(map(str, diagram))}" if "parameter" in getattr(diagram, "attrs", {}) else ""
        allowed = f"allowed is the Dataset of ss.bifurcation and a column of it{columns}"
        raise InputError("plot", [f"{type(diagram).__name__} without {observable!r}; {allowed}"])
    across, y = diagram[diagram.attrs["parameter"]], diagram[observable]
    unit = y.attrs.get("units", "1")
    (right, side), (up, mark) = scaled(across.values, across.attrs.get("units", "1")), scaled(y.values, unit)
    with publication():
        ax = axes(ax, height=2.6)
        for i, direction in enumerate(diagram.direction.values):
            part = y.sel(direction=direction)
            x = across.broadcast_like(part).values.ravel() * right
            size = 1.6 if i == 0 else 0.8
            ax.plot(x, part.values.ravel() * up, ".", markersize=size, markeredgewidth=0, color=COLOURS[i], rasterized=True, zorder=2 + i)
            ax.plot([], [], ".", markersize=5, color=COLOURS[i], label=str(direction))
        logarithmic(ax, "x", np.sort(across.values) * right)
        ax.set_xlabel(named(across.attrs.get("long_name", across.name), across.attrs.get("units", "1"), side))
        ax.set_ylabel(named(_WORDS.get(observable, y.attrs.get("long_name", observable)), unit, mark))
        legend_above(ax, ncols=2, handletextpad=0.2)
        return ax


@explains_arguments
def basins(found: Basin, ax: Ax = None) -> Any:
    """Which initial state leads to which attractor, over the first two axes of the grid of initial states with several values.

    Parameters
    ----------
    found : Basins
        From `stickslip.basins`.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)
    >>> found = ss.basins(robot, v=[-0.01, 0.0, 0.01], z=[0.0, 1e-7], settle=60)
    >>> ss.plot.basins(found).get_xlabel()
    'velocity at the start (mm/s)'
    """
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    if not hasattr(found, "attractors"):
        raise InputError("plot", [f"found = {found!r}; allowed is what ss.basins gives"])
    names = [str(d) for d in found.map.attractor.dims if found.map.sizes[d] > 1]
    if len(names) < 2:
        raise InputError("plot", ["a map needs two axes with several values; type for example ss.basins(robot, v=[...], z=[...])"])
    across, upward = names[:2]
    flat = found.map.attractor.isel({d: 0 for d in found.map.attractor.dims if d not in (across, upward)}).transpose(upward, across)
    (right, side), (up, mark) = (scaled(found.map[n].values, found.map[n].attrs.get("units", "1")) for n in (across, upward))
    with publication():
        ax = axes(ax, height=2.8)
        paints: list[Any] = ["#FFFFFF", *[_pale(COLOURS[k % 7]) for k in range(max(len(found.attractors), 1))]]
        norm = BoundaryNorm(np.arange(-1.5, len(paints) - 0.5), len(paints))
        extent = [*_edges(found.map[across].values * right), *_edges(found.map[upward].values * up)]
        ax.imshow(
            flat.values, origin="lower", extent=extent, aspect="auto", cmap=ListedColormap(paints), norm=norm, interpolation="nearest"
        )
        for k, a in enumerate(found.attractors):
            if a.orbit is not None and set(names[:2]) <= set(a.orbit.names):
                place = [a.orbit.names.index(across), a.orbit.names.index(upward)]
                ax.plot(
                    a.orbit.state[place[0]] * right,
                    a.orbit.state[place[1]] * up,
                    "o",
                    markersize=5,
                    color=COLOURS[k % 7],
                    markeredgecolor="white",
                )
        ax.set_xlabel(labelled(found.map[across], side))
        ax.set_ylabel(labelled(found.map[upward], mark))
        told = [f"$V$ = {a.mean_velocity * 1e3:.3g} mm/s, {100 * a.share:.0f} %" for a in found.attractors]
        handles: list[Any] = [Patch(color=paints[k + 1], label=text) for k, text in enumerate(told)]
        if ax.lines:
            handles.append(Line2D([], [], marker="o", linestyle="", color=INK, markersize=4, label="strobe point of the motion"))
        legend_above(ax, handles=handles, ncols=2, columnspacing=1.2)
        return ax


def _pale(colour: str) -> tuple[float, ...]:
    """A colour halfway to white."""
    return tuple(0.45 * int(colour[i : i + 2], 16) / 255 + 0.55 for i in (1, 3, 5))


def _edges(values: Any) -> tuple[float, float]:
    """The outer edges of cells around evenly spaced values."""
    half = 0.5 * (values[-1] - values[0]) / max(len(values) - 1, 1)
    return float(values[0] - half), float(values[-1] + half)


@explains_arguments
def convergence(exponents: Exponents, ax: Ax = None, count: int = 1) -> Any:
    """Convergence of Lyapunov exponents, with a band of three final standard errors.

    Parameters
    ----------
    exponents : Lyapunov
        From `stickslip.lyapunov` and its like.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.
    count : int
        How many exponents, from the largest.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> exponents = ss.lyapunov(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb"), periods=50)
    >>> ss.plot.convergence(exponents).get_ylabel()
    'exponent per drive period'
    """
    if not hasattr(exponents, "record"):
        raise InputError("plot", [f"{exponents!r}; allowed is what ss.lyapunov gives"])
    if not is_whole(count) or not 1 <= count <= len(exponents.spectrum):
        raise InputError("plot", [f"count = {count!r}; allowed is a whole number from 1 to {len(exponents.spectrum)}; type count=1"])
    with publication():
        ax = axes(ax)
        ax.axhline(0.0, color=INK, linewidth=0.5)
        for i in range(min(count, len(exponents.spectrum))):
            end, error = exponents.spectrum[i], exponents.errors[i]
            if not np.isfinite(end):
                continue
            ax.axhspan(end - 3 * error, end + 3 * error, color=COLOURS[i % 7], alpha=0.15, linewidth=0)
            name = f"{end:.4g} ± {error:.1g} (band: three errors)"
            ax.plot(exponents.record[:, 0], exponents.record[:, 1 + i], color=COLOURS[i % 7], label=name)
        ax.set_xlim(0, exponents.record[-1, 0])
        ax.set_xlabel(f"{exponents.unit}s averaged over")
        ax.set_ylabel(f"exponent per {exponents.unit}")
        if ax.get_legend_handles_labels()[0]:
            legend_above(ax, ncols=3)
        else:
            ax.set_yticks([])
            ax.text(0.5, 0.6, "−∞: disturbances are forgotten at once", transform=ax.transAxes, ha="center")
        return ax


@explains_arguments
def spectrum(lines: Grid, ax: Ax = None) -> Any:
    """The lines of a motion over the order of the drive's frequency; harmonics of the drive stand out from lines between them.

    Parameters
    ----------
    lines : xarray.Dataset
        From `stickslip.spectrum`.
    ax : matplotlib Axes, optional
        Where to draw; a new figure if not given.

    Returns
    -------
    matplotlib Axes

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), periods=20)
    >>> ss.plot.spectrum(ss.spectrum(run)).get_xlabel()
    'frequency / frequency of the drive'
    """
    if "amplitude" not in getattr(lines, "data_vars", {}):
        raise InputError("plot", [f"{type(lines).__name__} without an amplitude; allowed is the Dataset of ss.spectrum"])
    for dim in set(lines.amplitude.dims) - {"order"}:
        one = lines[dim].values.tolist()[0]
        raise InputError("plot", [f"the spectrum has the dimension {dim}; allowed is one; type ss.plot.spectrum(lines.sel({dim}={one!r}))"])
    with publication():
        ax = axes(ax)
        floor = float(lines.amplitude.max()) * 1e-6
        for whole, colour, name in ((True, COLOURS[0], "harmonics of the drive"), (False, COLOURS[1], "between")):
            shown = lines.amplitude > floor if floor else lines.amplitude == 0.0  # of what never moves
            part = lines.where((lines.harmonic == whole) & shown, drop=True)
            if part.order.size:
                ax.vlines(part.order, floor, part.amplitude, color=colour, linewidth=1.0)
                ax.plot(part.order, part.amplitude, "o", markersize=2, color=colour, label=name)
        if floor:
            ax.set_yscale("log")
            ax.set_ylim(floor, None)
        ax.set_xlabel("frequency / frequency of the drive")
        ax.set_ylabel(named(f"amplitude of ${lines.attrs.get('column', 'v')}$", lines.amplitude.attrs.get("units", "1")))
        legend_above(ax, ncols=2)
        return ax
