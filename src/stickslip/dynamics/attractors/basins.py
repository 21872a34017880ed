"""Coexisting attractors and their basins over a set of starts, with the shares of the starts and their uncertainty."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Executes, Model, described_as, explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems, SolveError, did_you_mean
from stickslip.basics.executors import Workers
from stickslip.basics.fields import floats
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import interruptible
from stickslip.basics.notebook_display import Drawn
from stickslip.dynamics.attractors.bifurcation_diagrams import state_attrs, velocity_attrs
from stickslip.dynamics.attractors.kinds_of_motion import NOT_COMPUTED, PERIODIC, STEADY, UNSETTLED, of_motions
from stickslip.dynamics.attractors.mirror_images import image_in_words, mirror_images
from stickslip.dynamics.attractors.motion_features import Features, features_of, motion_numbers
from stickslip.dynamics.attractors.settled_motions import Settled, Settling, checked_limit, settled_motions
from stickslip.dynamics.stroboscopic.chosen_sections import on_section
from stickslip.dynamics.stroboscopic.chunked_runs import Report
from stickslip.dynamics.stroboscopic.phase_shift import shifted_robots
from stickslip.dynamics.stroboscopic.refusals import needs_model
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, spread_over, state_at_rest
from stickslip.models.angular_coordinates import unit_of_part
from stickslip.models.model_adapter import adapter_of
from stickslip.models.rounding import without_rounding
from stickslip.solvers.initial_states import LARGEST_START

if TYPE_CHECKING:
    from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates


@sealed
class Attractor:
    """A motion that attracts starts.

    Parameters
    ----------
    kind : str
        "periodic", "quasi-periodic" or "chaotic"; of a machine without a period also "steady": its state does not change.
    period : int
        Drive periods until it repeats, or returns to the section; 0 where it does not.
    mean_velocity : float
        V [m/s]; of a flow the mean rate of its first cyclic coordinate, nan of one without.
    state : array
        A strobe state on it.
    share : float
        Part of the starts that it attracts.
    interval : (float, float)
        Of that share, at 95 % confidence (Wilson), as if the starts were drawn by chance.
    orbit : PeriodicOrbit or None
        The orbit by Newton's method, with its multipliers, where it is periodic.
    exponent, error : float
        Largest Lyapunov exponent per drive period and its standard error of a motion without a period, the mean over its starts; NaN of
        one that has a period: its multipliers say more.
    image : str
        Of a machine in which forwards and backwards are alike: "the mirror image of attractor 0", by its number among the attractors, or
        "its own mirror image"; empty where no mirror image is known.
    unit : str
        Of the mean velocity; empty of a flow, whose states have none.
    """

    kind: str
    period: int
    mean_velocity: float
    state: Array
    share: float
    interval: tuple[float, float]
    orbit: Any
    exponent: float = np.nan
    error: float = np.nan
    image: str = ""
    unit: str = "m/s"

    @property
    def word(self) -> str:
        """What motion it is: "period 2", or "chaotic (exponent 0.42 ± 0.01 per drive period)"."""
        if self.kind == PERIODIC:
            return f"period {self.period}"
        if self.kind == STEADY:
            return STEADY
        return f"{self.kind} (exponent {self.exponent:.2g} ± {self.error:.1g} per drive period)"

    @property
    def _bounds(self) -> str:
        """The interval of its share, as text."""
        return f"{self.interval[0]:.3f} to {self.interval[1]:.3f}"

    def __repr__(self) -> str:
        way = f"V = {self.mean_velocity:.7g} {self.unit}, ".replace(" ,", ",") if np.isfinite(self.mean_velocity) else ""
        image = f", {self.image}" if self.image else ""
        return f"<Attractor: {self.word}, {way}share {self.share:.3f} ({self._bounds}){image}>"


@described_as("basins; type for example ss.basins(robot, v=[0.0, 0.1])")
@sealed
class Basins(Drawn):
    """Basins of attraction: which initial state leads to which attractor.

    Parameters
    ----------
    model : Robot
        What moves.
    map : xarray.Dataset
        Over the starts: `attractor` (number in `attractors`, -1: none), mean_velocity [m/s], period, motion (what a start has settled on,
        in words, or "not settled", "runs away", "not solved", "not computed"), exponent and its error per drive period of what has no
        period, run (drive periods until a start was recognised, or given up).
    attractors : list of Attractor
        The largest share first.
    notes : tuple of str
        Whether it was interrupted, and why starts have not settled.

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
    notes: tuple[str, ...] = ()

    @cached_property
    def fractions(self) -> list[float]:
        """The shares, the largest first."""
        return [a.share for a in self.attractors]

    @cached_property
    def others(self) -> dict[str, tuple[float, tuple[float, float]]]:
        """Starts that are on no attractor, by what they do ("not settled", "runs away", "not solved"): share and its 95 % interval."""
        motion = self.map.motion.values.ravel()
        computed = motion != NOT_COMPUTED
        cases, words = int(np.count_nonzero(computed)), motion[computed & (self.map.attractor.values.ravel() < 0)]
        counts = {str(word): int(np.count_nonzero(words == word)) for word in dict.fromkeys(words.tolist())}
        return {word: (n / cases, wilson(n, cases)) for word, n in counts.items()}

    _drawn_by = "basins"

    def _tables(self) -> list[list[tuple[str, ...]]]:
        head = ("attractor", "motion", "mean velocity [m/s]", "share of the starts", "95 %")
        rows = [
            (str(k), ", ".join(filter(None, (a.word, a.image))), f"{a.mean_velocity:.7g}", f"{a.share:.3f}", a._bounds)
            for k, a in enumerate(self.attractors)
        ]
        rows += [("none", word, "", f"{share:.3f}", f"{low:.3f} to {high:.3f}") for word, (share, (low, high)) in self.others.items()]
        return [[head, *rows]]

    def _remarks(self) -> list[str]:
        return list(self.notes)

    def __repr__(self) -> str:
        none = [f"{word}: share {share:.3f} ({low:.3f} to {high:.3f})" for word, (share, (low, high)) in self.others.items()]
        return "<Basins: " + "; ".join([*map(repr, self.attractors), *none, f"{self.map.attractor.size} starts", *self.notes]) + ">"


@explains_arguments
@interruptible
def basins(
    model: Model,
    *,
    settle: int = 300,
    limit: int | None = None,
    rtol: float = 1e-7,
    section: Any = None,
    turns: int = 1,
    workers: int = 1,
    executor: Executes = None,
    progress: Report | None = None,
    **starts: Any,
) -> Basins:
    """Basins of attraction: the motion that a robot reaches from each point of a grid of initial states.

    A start that does not repeat after `settle` drive periods is run on, up to `limit`. What still moves then is looked at over 600 drive
    periods more: it is periodic if it closes in on a stable orbit as the derivative of the strobe map says; quasi-periodic if weighted
    means of the strobe points of both halves agree; chaotic if its largest Lyapunov exponent is positive by more than three of its
    standard errors and no other start left such a motion late. Everything else is no attractor: it has not settled, or runs away.

    Parameters
    ----------
    model : Robot
        One robot.
    settle : int
        Drive periods to discard at least.
    limit : int, optional
        Drive periods up to which a start is run on that has not settled; eight times `settle` if not given.
    rtol : float
        Tolerance for dynamic laws.
    section : str or tuple, optional
        Of a model without a period: where its motions are looked at, by the name of a state, ``section="v"``, with the value that it
        passes, ``section=("v", 0.0)``, and the direction, 1 where it rises and -1 where it falls. If not given, it is chosen from a run.
    turns : int
        Of a model without a period: after how many returns to the section it is looked at again.
    workers : int
        Threads. The results do not depend on it.
    executor : executor or callable, optional
        Compute there, as for `sweep`; `workers` is then the number of its workers.
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
        `map` (labelled Dataset), `attractors` (with shares and their confidence intervals, and which is the mirror image of which where
        forwards and backwards are alike, but not with `phase=` and under laws with discrete memory), `fractions`, `others` (shares of
        starts that are on no attractor), `notes`.

    Examples
    --------
    >>> import stickslip as ss
    >>> b = ss.basins(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4), v=[-0.01, 0.0, 0.01], settle=60)
    >>> len(b.attractors), b.fractions
    (1, [1.0])
    """
    needs_model("basins", model, flows=True, sections=True)
    at, crew = coordinates(model), Workers(workers, executor)
    axes, limit = start_axes("basins", at, starts, settle, limit, crew, model)
    table = grid_of(axes)
    states = on_grid(table, model)
    at = on_section(model, at, section=section, turns=turns, states=states, what="basins")
    batch = shifted_robots("basins", model, table["phase"]) if "phase" in table else spread_over(model, len(states))
    settled = settled_motions(batch, states, at, Settling(settle, limit, rtol), workers=crew, progress=progress, partly=True)
    result = _gathered(model, axes, settled, at, "phase" in table, rtol)
    result = replace(result, notes=(*result.notes, *_changed(at, model, states)))
    if settled.ending.interrupted:
        done = np.count_nonzero(settled.kind != NOT_COMPUTED)
        note = settled.ending.note(f"{done} of {len(states)} starts are computed")
        result.map.attrs["note"] = note
        return replace(result, notes=(note, *result.notes))
    return result


def _changed(at: Coordinates, model: Model, states: Array) -> list[str]:
    """A note where starts of a flow are beyond the guards of all its modes: `solve` refuses them, and a map shows them by what follows."""
    count = int(at.changed_at_once(model, states).sum())
    if not count:
        return []
    lie = "start lies" if count == 1 else "starts lie"
    return [
        f"{count} of {len(states)} {lie} beyond the guards of every mode, and a reset makes another state of each at t = 0, which is run on"
    ]


def grid_of(axes: dict[str, Array]) -> dict[str, Array]:
    """All combinations of the values on some axes, as columns."""
    grid = np.meshgrid(*axes.values(), indexing="ij")
    return {name: column.ravel() for name, column in zip(axes, grid, strict=True)}


def on_grid(table: dict[str, Array], model: Model) -> Array:
    """The starts of a grid for one robot: array (starts, coordinates); what the grid does not name is as at rest."""
    at = coordinates(model)
    return at.placed(model, from_rest(table, at.names, state_at_rest(model, at)[0]))


def from_rest(table: dict[str, Array], names: tuple[str, ...], rest: Array) -> Array:
    """The same from the coordinates' names and their values at rest."""
    count = len(next(iter(table.values())))
    return np.column_stack([table.get(name, np.full(count, value)) for name, value in zip(names, rest, strict=True)])


def start_axes(
    what: str, at: Any, starts: dict[str, Any], settle: Any, limit: Any, workers: Workers, model: Any = None
) -> tuple[dict[str, Array], int]:
    """The axes of a grid of starts, checked, and the limit of their runs in drive periods."""
    free = model is not None and model.period is None
    problems, known = Problems(what), at.start_names if free or not at.has_phase else (*at.start_names, "phase")
    workers.note(problems)
    problems.whole("settle", settle, 1, example=300)
    most = checked_limit(problems, settle, limit)
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
    return axes, most


def _usual(at: Coordinates) -> dict[str, Array]:
    """Over twice the scales; inner states and memories only where there is one inner state, so that the grid stays a grid.

    Of several bodies over their velocities alone.
    """
    if at.named:
        names = at.names[at.order.velocities]
        return {n: np.linspace(-2, 2, 41) * at.speed for n in names}
    inner = at.smooth - at.order.velocities.stop
    return {n: np.linspace(-2, 2, 41) * s for n, s in zip(at.names[: at.smooth - (inner if inner > 1 else 0)], at.scales, strict=False)}


def _gathered(model: Model, axes: dict[str, Array], settled: Settled, at: Coordinates, by_phase: bool, rtol: float) -> Basins:
    import xarray as xr

    motions = features_of(model.period, settled, at, by_phase)
    number = motion_numbers(motions, settled.attracted)
    dims, shape, of = tuple(axes), tuple(len(axis) for axis in axes.values()), adapter_of(model)
    members = [np.flatnonzero(number == k) for k in range(number.max() + 1)]
    order = sorted(range(len(members)), key=lambda k: -len(members[k]))
    rank = np.full(len(members) + 1, -1)
    rank[order] = np.arange(len(order))
    cases = int(np.count_nonzero(settled.kind != NOT_COMPUTED))
    columns = {
        "attractor": (dims, rank[number].reshape(shape), {"long_name": "number of the attractor (-1: none)"}),
        **({"mean_velocity": (dims, motions.mean_velocity.reshape(shape), velocity_attrs(model))} if of.has_displacement else {}),
        "period": (dims, settled.period.reshape(shape), {"units": "1", "long_name": "motion period (0: none, -1: not computed)"}),
        **{
            name: (dims, column.reshape(shape), about)
            for (name, about), column in zip(
                of_motions(at.section is not None).items(), (settled.kind, settled.exponent, settled.error, settled.run), strict=True
            )
        },
    }
    phase = {"long_name": "phase of the drive at the start", "units": "1"}
    coords = {n: (n, a, phase if n == "phase" else state_attrs(n, "at the start", model)) for n, a in axes.items()}
    firsts = [int(members[k][0]) for k in order]
    images = [None] * len(order) if by_phase else mirror_images(model, at, motions, settled.points[firsts, -1], firsts, rtol)
    words = [image_in_words(i, image) for i, image in enumerate(images)]
    attractors = [_attractor(model, at, members[k], cases, settled, motions, by_phase, word) for k, word in zip(order, words, strict=True)]
    return Basins(model, xr.Dataset(columns, coords), attractors, _notes(settled))


def _notes(settled: Settled) -> tuple[str, ...]:
    """Why starts have not settled, and what to type."""
    moving = [int(settled.run[i]) for i in np.flatnonzero(settled.kind == UNSETTLED).tolist() if i in settled.long]
    more = (f"type limit={10 * max(moving)} to run them on for longer",) if moving else ()
    return (*settled.reasons(), *more)


def _attractor(
    model: Model, at: Coordinates, members: Array, cases: int, settled: Settled, motions: Features, by_phase: bool, image: str
) -> Attractor:
    from stickslip.dynamics.periodic.periodic_orbits import orbit_near

    first = members[0]
    kind, count, state = str(settled.kind[first]), int(settled.period[first]), at.wrapped(settled.points[first, -1])
    orbit = None
    with suppress(SolveError, InputError):
        orbit = orbit_near(model, count, state, at) if count and not by_phase else None
    share, way = len(members) / cases, float(np.mean(motions.mean_velocity[members])) if adapter_of(model).has_displacement else np.nan
    exponent, error = (float(np.mean(each[members])) for each in (settled.exponent, settled.error))
    unit = unit_of_part("v", model, "") if adapter_of(model).has_units else ""
    way = without_rounding(way, model) if unit and np.isfinite(way) else way
    return Attractor(kind, count, way, state, share, wilson(len(members), cases), orbit, exponent, error, image, unit)


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
