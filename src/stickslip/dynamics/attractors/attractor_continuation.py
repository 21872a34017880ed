"""Coexisting attractors tracked along a parameter: their number, their fate, and their shares of the starts."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Executes, Maker, Numbers, explains_arguments
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.executors import Workers
from stickslip.basics.interruption import interruptible, look, partial_result
from stickslip.dynamics.attractors.basins import Attractor, grid_of, on_grid, start_axes, wilson
from stickslip.dynamics.attractors.bifurcation_diagrams import checked_values, state_attrs, velocity_attrs
from stickslip.dynamics.attractors.kinds_of_motion import RUNS_AWAY, UNDONE, UNSETTLED, UNSOLVED, of_motions
from stickslip.dynamics.attractors.mirror_images import mirror_images
from stickslip.dynamics.attractors.motion_features import Features, features_of, motion_numbers
from stickslip.dynamics.attractors.settled_motions import Settled, Settling, settled_motions
from stickslip.dynamics.continuation.one_parameter import Family, family
from stickslip.dynamics.stroboscopic.chosen_sections import on_section
from stickslip.dynamics.stroboscopic.chunked_runs import Report
from stickslip.dynamics.stroboscopic.refusals import needs_model
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates, spread_over
from stickslip.models.model_adapter import adapter_of
from stickslip.studies.progress import Watch

if TYPE_CHECKING:
    import xarray as xr

#: Numbers of an attractor beside its period: of the motion, and of the starts that lead to it.
OF_ATTRACTORS = {
    "mean_velocity": {"units": "m/s", "long_name": "mean velocity"},
    "share": {"units": "1", "long_name": "share of the starts"},
    "share_low": {"units": "1", "long_name": "share of the starts, 95 % lower bound"},
    "share_high": {"units": "1", "long_name": "share of the starts, 95 % upper bound"},
}
#: Starts on no attractor: names of columns, kinds, and what they are.
_LOST = {
    "unsettled": (UNSETTLED, "starts that have not settled (-1: not computed)"),
    "runs_away": (RUNS_AWAY, "starts that run away (-1: not computed)"),
    "unsolved": (UNSOLVED, "starts that could not be solved (-1: not computed)"),
}
_STEPS = 8  # smaller steps from value to value where an attractor seems to end


@dataclass(eq=False)
class _Track:
    """One attractor through the values: a strobe state on it, its features, and what it was at each value where it is."""

    state: Array
    at_values: dict[int, Attractor]
    images: dict[int, int] = field(default_factory=dict)  # the track that is its mirror image, at each value; -1: none is known
    means: Any = ()
    between: tuple[float, float] | None = None  # where it vanished
    became: str = ""  # and to what its last state led


@explains_arguments
@interruptible
def attractors(
    make: Maker,
    *,
    parameter: str,
    values: Numbers,
    starts: dict[str, Any] | None = None,
    settle: int = 300,
    limit: int | None = None,
    rtol: float = 1e-7,
    section: Any = None,
    turns: int = 1,
    workers: int = 1,
    executor: Executes = None,
    progress: Report | None = None,
    **fixed: Any,
) -> xr.Dataset:
    """Attractors along a parameter: those reached from a grid of initial states, and continuations of those at the previous value.

    An attractor is continued by the motion that attracts its last strobe state. If this motion also continues another attractor, it is the
    one whose features (means of the strobe points and mean velocity) changed less, and the other ends, as it does if there is no such
    motion. Before an attractor is said to end, all of them are followed through eight smaller steps to the next value, which also narrows
    where it ends. An attractor that continues no other one is new. Shares count the grid only.

    Parameters
    ----------
    make : callable, Robot, machine or SwitchingFlow
        A function that makes a robot from keyword arguments, or a robot whose numbers have dotted names; a flow, or a map by
        ``SwitchingFlow.of_map``, by the names of its numbers.
    parameter : str
        The keyword that varies.
    values : array
        Its values, ascending.
    starts : dict, optional
        The grid of initial states, as for `basins`: v [m/s], z [m], x [m], memory; single values or lists.
    settle : int
        Drive periods to discard at least.
    limit : int, optional
        Drive periods up to which a start is run on that has not settled, eight times `settle` if not given; see `basins` for what is then
        said of it.
    rtol : float
        Tolerance for dynamic laws.
    section : str or tuple, optional
        Of a model without a period: where its motions are looked at, by the name of a state, ``section="v"``, with the value that it
        passes, ``section=("v", 0.0)``, and the direction, 1 where it rises and -1 where it falls. If not given, it is chosen from a run.
    turns : int
        Of a model without a period: after how many returns to the section it is looked at again.
    workers : int
        Threads for the starts of one value. The results do not depend on it.
    executor : executor or callable, optional
        Compute there, as for `sweep`; `workers` is then the number of its workers.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with a `Progress` after each value; return False to stop. Attractors are
        then missing at the values that were not computed.
    **fixed
        The other arguments of `make`.

    Returns
    -------
    xarray.Dataset
        Over attractor (in the order in which they appear) and the parameter: mean_velocity [m/s] (of machines), motion ("periodic",
        "quasi-periodic" or "chaotic"; empty where it is absent), period (drive periods until it repeats; 0: none, -1: absent), exponent
        with its error (largest Lyapunov exponent per drive period of what has no period), image (where forwards and backwards are alike,
        the attractor that is its mirror image, which may be itself; -1: none is known, as under laws with discrete memory), share of the
        starts with its 95 % interval share_low to share_high (Wilson), the strobe state (v, z, ...); over attractor: begins and ends,
        between which values it appears and vanishes, and what its last state leads to then; over the parameter the numbers of starts that
        reach no attractor: unsettled, runs_away and unsolved (-1: not computed).

    Examples
    --------
    >>> import stickslip as ss
    >>> d = ss.attractors(ss.presets.piezo_rig, parameter="mu0", values=[0.17, 0.18], starts=dict(v=[-0.01, 0.01]), settle=60,
    ...                   amplitude=6e-4, tilt_deg=1.7)
    >>> d.period.values.tolist(), d.share.values.tolist()
    ([[1, 1]], [[1.0, 1.0]])

    A saddle-node of a map, at h = 2 ((r - 1)/3)^(3/2) = 0.136:

    >>> cubic = ss.SwitchingFlow.of_map(lambda y, n: (n.r * y[0] - y[0] ** 3 + n.h,), {"r": 1.5, "h": 0.0}, ("x",))
    >>> d = ss.attractors(cubic, parameter="h", values=[0.0, 0.13, 0.14], starts=dict(x=[-0.8, 0.8]), settle=100)
    >>> print(d.ends.values[0])
    vanishes between 0.135 and 0.13625; its last state leads to attractor 1
    """
    robots = family("attractors", make, (parameter,), fixed)
    values = checked_values(Problems("attractors"), values, robots)
    first = robots.robot(values[0])
    needs_model("attractors", first, flows=True, sections=True)
    at = coordinates(robots.robots(values))
    if "phase" in (starts or {}):
        raise InputError("attractors", ["phase is not part of the strobe state that is tracked; take ss.basins(robot, phase=...)"])
    crew = Workers(workers, executor)
    axes, limit = start_axes("attractors", at, starts or {}, settle, limit, crew, first)
    table = grid_of(axes)
    at = on_section(first, at, section=section, turns=turns, states=on_grid(table, first), what="attractors")
    tracks: list[_Track] = []
    lost, watch = np.full((len(values), len(_LOST)), UNDONE), Watch(len(values), progress)
    with crew.kept() as kept, partial_result() as ending:
        along = _Along(robots, values, table, at, settle, limit, rtol, kept, section)
        for k in range(len(values)):
            look()
            lost[k] = _at_value(along, k, tracks)
            watch.finished(k, np.zeros(1, int))
    ending.needs(tracks or (lost != UNDONE).any())
    grid = _dataset(robots, parameter, values, tracks, lost, at, math.prod(map(len, axes.values())))
    if not ending.interrupted:
        return grid
    return grid.assign_attrs(note=ending.note(f"{int((lost[:, 0] != UNDONE).sum())} of {len(values)} values are computed"))


@dataclass(frozen=True, eq=False)
class _Along:
    """Settings that are the same for every value."""

    robots: Family
    values: Array
    table: dict[str, Array]
    at: Coordinates
    settle: int
    limit: int
    rtol: float
    workers: Workers
    section: Any

    def on(self, model: Model) -> Coordinates:
        """The coordinates of the model at one value; without a period it has a section of its own, by the same state."""
        if self.at.section is None:
            return self.at
        asked = self.at.section.name if self.section is None else self.section
        return on_section(model, section=asked, turns=self.at.section.turns, states=on_grid(self.table, model), what="attractors")

    def settled(self, model: Model, states: Array) -> Settled:
        many = spread_over(model, len(states))
        return settled_motions(many, states, self.on(model), Settling(self.settle, self.limit, self.rtol), workers=self.workers)

    def numbered(self, model: Model, settled: Settled) -> tuple[Features, Array]:
        """Features of the motions, and a number for each."""
        motions = features_of(model.period, settled, self.at)
        return motions, motion_numbers(motions, settled.attracted)


def _at_value(along: _Along, k: int, tracks: list[_Track]) -> list[int]:
    """Go on with the tracks at one value, and begin new ones. Returns how many starts have not settled, run away, and were not solved."""
    model = along.robots.robot(float(along.values[k]))
    first, alive = on_grid(along.table, model), [track for track in tracks if k - 1 in track.at_values]
    whole = along.settled(model, np.vstack([*(track.state[None, :] for track in alive), first]))
    motions, number = along.numbered(model, whole)
    if len(_claims(motions, number[: len(alive)], [track.means for track in alive])) < len(alive):  # one ends, or the step was too long
        whole = _in_small_steps(along, k, alive, whole)
        motions, number = along.numbered(model, whole)
    carried, ours = number[: len(alive)], number[len(alive) :]
    lasting = [i for i, track in enumerate(alive) if not track.between]
    claims = _claims(motions, np.where(np.isin(np.arange(len(alive)), lasting), carried, -1), [track.means for track in alive])
    taken = {n: alive[i] for n, i in claims.items()}
    for n in sorted(set(ours[ours >= 0].tolist()) - set(taken), key=lambda n: -np.count_nonzero(ours == n)):
        taken[n] = _Track(first[0], {})
        tracks.append(taken[n])
    for n, track in taken.items():
        _note(track, k, number == n, ours == n, whole, motions)
    _note_images(along, model, k, taken, tracks, whole, motions, number)
    for track, n in zip(alive, carried.tolist(), strict=True):
        if k not in track.at_values:
            track.between = track.between or (float(along.values[k - 1]), float(along.values[k]))
            track.became = f"attractor {tracks.index(taken[n])}" if n in taken else "no attractor"
    return [int(np.count_nonzero(whole.kind[len(alive) :] == kind)) for kind, _ in _LOST.values()]


def _claims(motions: Features, carried: Array, before: list[Array]) -> dict[int, int]:
    """Which track goes on as which motion, by number; of several that come to one that whose features changed least."""
    claims: dict[int, int] = {}
    for i in sorted(range(len(before)), key=lambda i: float(motions.distance(i, before[i]))):
        if carried[i] >= 0:
            claims.setdefault(int(carried[i]), i)
    return claims


def _in_small_steps(along: _Along, k: int, alive: list[_Track], whole: Settled) -> Settled:
    """Continuations of the tracks to a value by smaller steps of the parameter, besides those of the grid; ends are located.

    Where a parameter takes no values between, as a whole number does not, what the one long step gave stays.
    """
    steps = np.linspace(along.values[k - 1], along.values[k], _STEPS + 1)
    states, before = np.array([track.state for track in alive]), [track.means for track in alive]
    for low, high in pairwise(steps.tolist()):
        try:
            model = along.robots.robot(high)
        except InputError:
            return whole
        settled = along.settled(model, states)
        motions, number = along.numbered(model, settled)
        lasting = np.array([not track.between for track in alive])
        kept = set(_claims(motions, np.where(lasting, number, -1), before).values())
        for i in set(np.flatnonzero(lasting).tolist()) - kept:
            alive[i].between = (low, high)
        states = np.where(np.isfinite(settled.points[:, -1]), settled.points[:, -1], states)
        before = [new if i in kept else old for i, (new, old) in enumerate(zip(motions.means, before, strict=True))]
    return whole.beginning_with(settled)


def _note(track: _Track, k: int, members: Array, hit: Array, settled: Settled, motions: Features) -> None:
    first, hits, count = int(np.flatnonzero(members)[0]), int(np.count_nonzero(hit)), len(hit)
    V = float(np.mean(motions.mean_velocity[members]))
    track.state, track.means = settled.points[first, -1], motions.means[first]
    exponent, error = (float(np.mean(each[members])) for each in (settled.exponent, settled.error))
    kind, period = str(motions.kind[first]), int(motions.period[first])
    track.at_values[k] = Attractor(kind, period, V, track.state, hits / count, wilson(hits, count), None, exponent, error)


def _note_images(
    along: _Along, model: Model, k: int, taken: dict[int, _Track], tracks: list[_Track], whole: Settled, motions: Features, number: Array
) -> None:
    """Note which attractors at a value are mirror images of one another."""
    firsts = [int(np.flatnonzero(number == n)[0]) for n in taken]
    images = mirror_images(model, along.at, motions, whole.points[firsts, -1], firsts, along.rtol)
    places = [tracks.index(track) for track in taken.values()]
    for index, image in zip(places, images, strict=True):
        tracks[index].images[k] = UNDONE if image is None else places[image]


def _begins(track: _Track, values: Array) -> str:
    """Between which values an attractor appears."""
    k = min(track.at_values)
    return f"appears between {values[k - 1]:.9g} and {values[k]:.9g}" if k else "is there at the first value"


def _ends(track: _Track, values: Array) -> str:
    """Between which values an attractor vanishes, and what becomes of a motion on it."""
    if track.between is None:
        return "is there at the last value" if max(track.at_values) == len(values) - 1 else "is there at the last value that was computed"
    return f"vanishes between {track.between[0]:.9g} and {track.between[1]:.9g}; its last state leads to {track.became}"


def _dataset(robots: Family, parameter: str, values: Array, tracks: list[_Track], lost: Array, at: Coordinates, starts: int) -> Any:
    import xarray as xr

    shape = (len(tracks), len(values))
    period, numbers = np.full(shape, UNDONE), np.full((*shape, 6 + len(at.names)), np.nan)
    motion, image = np.full(shape, "", dtype="<U16"), np.full(shape, -1)
    for i, track in enumerate(tracks):
        for k, a in track.at_values.items():
            period[i, k], motion[i, k] = a.period, a.kind
            image[i, k] = track.images.get(k, -1)
            numbers[i, k] = [a.mean_velocity, a.share, *a.interval, a.exponent, a.error, *a.state]
    both, model = ("attractor", parameter), robots.robot(values[0])
    about = (
        OF_ATTRACTORS
        | {"mean_velocity": velocity_attrs(model)}
        | {name: of_motions(at.section is not None)[name] for name in ("exponent", "error")}
        | {name: state_attrs(name, "on the strobe" if at.section is None else "on the section", model) for name in at.names}
    )
    columns: dict[str, Any] = {name: (both, numbers[..., i], attrs) for i, (name, attrs) in enumerate(about.items())}
    columns |= {
        "period": (both, period, {"units": "1", "long_name": "motion period (0: none, -1: absent)"}),
        "motion": (both, motion, {"long_name": "motion: periodic, quasi-periodic, chaotic, steady; empty where it is absent"}),
        "image": (both, image, {"units": "1", "long_name": "attractor that is its mirror image, or itself (-1: none is known)"}),
    }
    columns |= {
        name: ((parameter,), lost[:, i], {"units": "1", "long_name": name_of_end})
        for i, (name, (_, name_of_end)) in enumerate(_LOST.items())
    }
    if not adapter_of(model).has_displacement:
        del columns["mean_velocity"]
    for name, name_of_end in (("begins", _begins), ("ends", _ends)):
        texts = np.array([name_of_end(track, values) for track in tracks], dtype=str)
        columns[name] = (("attractor",), texts, {"long_name": f"where the attractor {name}"})
    coords = {parameter: (parameter, values, robots.describe(parameter)), "attractor": np.arange(len(tracks))}
    return xr.Dataset(columns, coords, {"parameter": parameter, "starts": starts})
