"""Coexisting attractors and their basins over a set of starts, with the shares of the starts and their uncertainty."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.arguments import Model, explains_arguments
from stickslip.batch import some_of
from stickslip.contracts import Array
from stickslip.dynamics.attractors.bifurcation_diagrams import UNDONE, state_attrs
from stickslip.dynamics.attractors.motion_features import numbered_motions
from stickslip.dynamics.stroboscopic.chunked_runs import Report, shared
from stickslip.dynamics.stroboscopic.phase_shift import shifted
from stickslip.dynamics.stroboscopic.refusals import needs_model
from stickslip.dynamics.stroboscopic.strobe_maps import at_rest, coordinates, spread_over, strobe_map, strobe_orbit
from stickslip.errors import InputError, Problems, SolveError, did_you_mean
from stickslip.faces import Drawn
from stickslip.fields import floats
from stickslip.flow import is_flow
from stickslip.interruption import interruptible, partial_result
from stickslip.sealing import sealed
from stickslip.solvers.request import LARGEST_START
from stickslip.status import Status

_POINTS = 64
_EARLY = 24  # drive periods after which it is asked whether a state stands still to the last bit


@sealed
class Attractor:
    """A motion that attracts starts.

    Parameters
    ----------
    period : int
        Drive periods until it repeats; 0 where it does not within 32.
    mean_velocity : float
        V [m/s]; nan of a flow, which makes no way.
    state : array
        A strobe state on it.
    share : float
        Part of the starts that it attracts.
    interval : (float, float)
        Of that share, at 95 % confidence (Wilson), as if the starts were drawn by chance.
    orbit : PeriodicOrbit or None
        The orbit by Newton's method, with its multipliers, where it is periodic.
    """

    period: int
    mean_velocity: float
    state: Array
    share: float
    interval: tuple[float, float]
    orbit: Any

    @property
    def _bounds(self) -> str:
        """The interval of its share, as text."""
        return f"{self.interval[0]:.3f} to {self.interval[1]:.3f}"

    def __repr__(self) -> str:
        kind = f"period {self.period}" if self.period else "no period up to 32"
        way = f"V = {self.mean_velocity:.7g} m/s, " if np.isfinite(self.mean_velocity) else ""
        return f"<Attractor: {kind}, {way}share {self.share:.3f} ({self._bounds})>"


@sealed
class Basins(Drawn):
    """Basins of attraction: which initial state leads to which attractor.

    Parameters
    ----------
    model : Robot
        What moves.
    map : xarray.Dataset
        Over the starts: `attractor` (number in `attractors`, -1: none), mean_velocity [m/s], period.
    attractors : list of Attractor
        The largest share first.

    Examples
    --------
    >>> import stickslip as ss
    >>> found = ss.basins(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4), v=[-0.01, 0.0, 0.01], settle=60)
    >>> found.map.attractor.values.tolist(), found.attractors[0].period
    ([0, 0, 0], 1)
    """

    model: Any
    map: Any
    attractors: list[Attractor]

    @cached_property
    def fractions(self) -> list[float]:
        """The shares, the largest first."""
        return [a.share for a in self.attractors]

    _drawn_by = "basins"

    def _tables(self) -> list[list[tuple[str, ...]]]:
        head = ("attractor", "period [drive periods]", "mean velocity [m/s]", "share of the starts", "95 %")
        told = [(str(a.period or "none"), f"{a.mean_velocity:.7g}", f"{a.share:.3f}", a._bounds) for a in self.attractors]
        return [[head, *((str(k), *row) for k, row in enumerate(told))]]

    def __repr__(self) -> str:
        return "<Basins: " + "; ".join(map(repr, self.attractors)) + f"; {self.map.attractor.size} starts>"


@explains_arguments
@interruptible
def basins(
    model: Model,
    *,
    settle: int = 300,
    rtol: float = 1e-7,
    workers: int = 1,
    progress: Report | None = None,
    **starts: Any,
) -> Basins:
    """Basins of attraction: the motion that a robot reaches from each point of a grid of initial states.

    Parameters
    ----------
    model : Robot
        One robot.
    settle : int
        Drive periods to discard.
    rtol : float
        Tolerance for dynamic laws.
    workers : int
        Threads. The results do not depend on it.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with a `Progress`; return False to stop. Starts that were not computed then
        belong to no attractor and are not counted in the shares.
    **starts
        ``v=`` [m/s], ``z=`` [m] (``z0``, ... if there are several; ``x`` with a spring; ``memory`` of a law that has one) and ``phase=``
        (drive phase at the start, in drive periods, 0 to 1; it also shifts a vertical vibration and friction that varies in time): single
        values or arrays. If none is given: v, and z where it is one number, over twice their scales. For a machine of several bodies the
        names are those of ``ss.periodic_orbit(machine).names``: ``**{"v.head": [...], "v.tail": [...]}``; if none is given, the velocities
        of all bodies. States of rest that differ only in where the bodies stopped count as one attractor.

    Returns
    -------
    Basins
        `map` (labelled Dataset), `attractors` (with shares and their confidence intervals), `fractions`.

    Examples
    --------
    >>> import stickslip as ss
    >>> b = ss.basins(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4), v=[-0.01, 0.0, 0.01], settle=60)
    >>> len(b.attractors), b.fractions
    (1, [1.0])
    """
    needs_model("basins", model, flows=True)
    at = coordinates(model)
    axes = start_axes("basins", at, starts, settle, workers, model)
    table = grid_of(axes)
    states = on_grid(table, model)
    batch = shifted("basins", model, table["phase"]) if "phase" in table else spread_over(model, len(states))
    points, ways, good = _unsettled(states)
    with partial_result() as ending:
        _settle(points, ways, good, batch, states, settle, rtol, workers, progress)
    found = _gathered(model, axes, points, ways, good, at, rtol, "phase" in table)
    if ending.interrupted:
        found.map.attrs["note"] = ending.note(f"{int((good != UNDONE).sum())} of {len(good)} starts are computed")
    return found


def grid_of(axes: dict[str, Array]) -> dict[str, Array]:
    """All combinations of the values on some axes, as columns."""
    grid = np.meshgrid(*axes.values(), indexing="ij")
    return {name: column.ravel() for name, column in zip(axes, grid, strict=True)}


def on_grid(table: dict[str, Array], model: Any) -> Array:
    """The starts of a grid for one robot: array (starts, coordinates); what the grid does not name is as at rest."""
    at = coordinates(model)
    return from_rest(table, at.names, at_rest(model, at)[0])


def from_rest(table: dict[str, Array], names: tuple[str, ...], rest: Array) -> Array:
    """The same from the coordinates' names and their values at rest."""
    count = len(next(iter(table.values())))
    return np.column_stack([table.get(name, np.full(count, value)) for name, value in zip(names, rest, strict=True)])


def start_axes(what: str, at: Any, starts: dict[str, Any], settle: Any, workers: Any, model: Any = None) -> dict[str, Array]:
    """The axes of a grid of starts, checked."""
    flow = is_flow(model)
    problems, known = Problems(what), at.names[: at.smooth] if flow else (*at.names, "phase")
    problems.whole("workers", workers, 1, example=2)
    problems.whole("settle", settle, 1, example=300)
    axes = {}
    for name, value in (starts or _usual(at)).items():
        if name not in known:
            problems.add(f"{name!r} is not a coordinate of the start; {did_you_mean(name, known)}")
            continue
        axis = np.atleast_1d(floats(value))
        if axis.ndim != 1 or axis.size == 0 or not np.all(abs(axis) <= LARGEST_START):
            problems.add(f"{name} = {value!r}; allowed is a finite number or a list of them; type {name}=np.linspace(-0.05, 0.05, 41)")
        axes[name] = axis
    problems.check()
    return axes


def _usual(at: Any) -> dict[str, Array]:
    """Over twice the scales; inner states and memories only where there is one inner state, so that the grid stays a grid.

    Of several bodies over their velocities alone.
    """
    if at.mechanics is not None:
        names = at.names[at.order.velocities]
        return {n: np.linspace(-2, 2, 41) * at.speed for n in names}
    inner = at.smooth - at.order.velocities.stop
    return {n: np.linspace(-2, 2, 41) * s for n, s in zip(at.names[: at.smooth - (inner if inner > 1 else 0)], at.scales, strict=False)}


def settled_points(
    batch: Any, states: Array, settle: int, rtol: float, workers: int, progress: Report | None
) -> tuple[Array, Array, Array]:
    """Strobe points (cases, points, d), ways (cases, points), and which cases could be solved: 1, not: 0, were not computed: -1."""
    found = _unsettled(states)
    _settle(*found, batch, states, settle, rtol, workers, progress)
    return found


def _unsettled(states: Array) -> tuple[Array, Array, Array]:
    """The columns of `settled_points` for starts that are not computed yet."""
    cases, d = states.shape
    return np.full((cases, _POINTS, d), np.nan), np.full((cases, _POINTS), np.nan), np.full(cases, UNDONE)


def _settle(
    points: Array, ways: Array, good: Array, batch: Any, states: Array, settle: int, rtol: float, workers: int, progress: Report | None
) -> None:
    """Fill in the columns of `settled_points`, part by part."""

    def ended(part: slice, tell: Callable[[float], None]) -> tuple[Array, Array, Array]:
        model = some_of(batch, part)
        early = min(settle, _EARLY)
        begun = strobe_map(model, states[part], early, rtol)
        kept, made = _still(model, begun.state, rtol)
        good = begun.status <= Status.REPEATS
        tell(0.2)
        late = np.flatnonzero(np.isnan(made[:, 0]))
        if len(late):
            kept[late], made[late], solved = _later(some_of(model, late), begun.state[late], settle - early, rtol)
            good[late] &= solved
        return kept, made, good

    for part, found in shared(len(states), ended, workers, progress):
        points[part], ways[part], good[part] = found


def _still(model: Any, states: Array, rtol: float) -> tuple[Array, Array]:
    """Strobe points and ways of those states that the strobe map does not change by a single bit: all later points are the same.

    NaN of all others.
    """
    end = strobe_map(model, states, 1, rtol)
    still = np.all(end.state == states, axis=1)
    points, ways = np.where(still[:, None], states, np.nan), np.where(still, end.displacement, np.nan)
    return np.repeat(points[:, None], _POINTS, axis=1), np.repeat(ways[:, None], _POINTS, axis=1)


def _later(model: Any, states: Array, periods: int, rtol: float) -> tuple[Array, Array, Array]:
    """Strobe points and ways after some more drive periods, and what could be solved."""
    good = np.full(len(states), True)
    if periods:
        end = strobe_map(model, states, periods, rtol)
        states, good = end.state, end.status <= Status.REPEATS
    kept, made = strobe_orbit(model, states, _POINTS, rtol)
    return np.moveaxis(kept, 0, 1), made.T, good


def _gathered(model: Any, axes: dict[str, Array], points: Array, ways: Array, good: Array, at: Any, rtol: float, by_phase: bool) -> Basins:
    import xarray as xr

    period, V, number = numbered_motions(float(model.period), points, ways, good, at, rtol, by_phase)
    dims, shape, flow = tuple(axes), tuple(len(axis) for axis in axes.values()), is_flow(model)
    members = [np.flatnonzero(number == k) for k in range(number.max() + 1)]
    order = sorted(range(len(members)), key=lambda k: -len(members[k]))
    rank = np.full(len(members) + 1, -1)
    rank[order] = np.arange(len(order))
    found = [_attractor(model, members[k], int((good != UNDONE).sum()), points, period, V, by_phase) for k in order]
    columns = {
        "attractor": (dims, rank[number].reshape(shape), {"long_name": "number of the attractor (-1: none)"}),
        **({} if flow else {"mean_velocity": (dims, V.reshape(shape), {"units": "m/s", "long_name": "mean velocity"})}),
        "period": (dims, period.reshape(shape), {"units": "1", "long_name": "motion period (0: none, -1: not computed)"}),
    }
    phase = {"long_name": "phase of the drive at the start", "units": "1"}
    coords = {n: (n, a, phase if n == "phase" else state_attrs(n, "at the start", flow)) for n, a in axes.items()}
    return Basins(model, xr.Dataset(columns, coords), found)


def _attractor(model: Any, members: Array, cases: int, points: Array, period: Array, V: Array, by_phase: bool) -> Attractor:
    from stickslip.dynamics.periodic.periodic_orbits import periodic_orbit

    first, count = members[0], int(period[members[0]])
    orbit = None
    with suppress(SolveError, InputError):
        orbit = periodic_orbit(model, count, guess=points[first, -1]) if count and not by_phase else None
    share = len(members) / cases
    way = np.nan if is_flow(model) else float(np.mean(V[members]))
    return Attractor(count, way, points[first, -1], share, wilson(len(members), cases), orbit)


def wilson(hits: int, cases: int, z: float = 1.959963984540054) -> tuple[float, float]:
    """Confidence interval of a share (Wilson 1927).

    Examples
    --------
    >>> [round(x, 4) for x in wilson(5, 10)]
    [0.2366, 0.7634]
    """
    p, w = hits / cases, z * z / cases
    middle, half = (p + w / 2) / (1 + w), z * np.sqrt(p * (1 - p) / cases + w / (4 * cases)) / (1 + w)
    return float(max(middle - half, 0.0)), float(min(middle + half, 1.0))
