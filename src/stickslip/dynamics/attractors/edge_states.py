"""Edge states: the motion on the border between the basins of two attractors, by repeated bisection, refined where it is periodic."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Model, explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems, SolveError
from stickslip.basics.fields import checked_number
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import interruptible, look, partial_result
from stickslip.basics.notebook_display import Drawn
from stickslip.basics.progress import Reported, reporting
from stickslip.basics.quantities import between
from stickslip.dynamics.attractors.basin_sides import SideJudge, judge_between, named_motion, narrowed
from stickslip.dynamics.attractors.basins import Attractor
from stickslip.dynamics.attractors.period_numbers import LONGEST
from stickslip.dynamics.periodic.given_states import states_of
from stickslip.dynamics.periodic.periodic_orbits import derivative_of, orbit_near
from stickslip.dynamics.stroboscopic.chosen_sections import on_section
from stickslip.dynamics.stroboscopic.refusals import needs_model
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates, strobe_map, strobe_orbit

if TYPE_CHECKING:
    pass


_WIDE = 1e-5  # in scales: how far the pair that straddles the border may come apart
_JUMP = 1e-2  # a narrow pair that is further apart after one period met a jump of the map
_BACK = 1e-3  # an edge track that comes back so nearly, in scales, is looked at for a periodic orbit
_ASIDE = np.geomspace(1e-8, 1e-4, 5)  # in scales: how far beside the orbit the starts are that must lead to the two motions
_KINDS = {
    "saddle": "a periodic orbit with one unstable multiplier",
    "repeller": "a periodic orbit whose only multiplier is unstable",
    "not periodic": "an edge track without a period up to 32",
    "jump": "a jump of the strobe map, which belongs to no motion",
}


@sealed
class EdgeState(Drawn):
    """The state on the border between the basins of two attractors, and what motion it is.

    Parameters
    ----------
    model : Robot, machine or SwitchingFlow
        What moves.
    kind : str
        "saddle": a periodic orbit with one unstable multiplier; "repeller": the same where it is the only one; "not periodic": an edge
        track without a period up to 32; "jump": the strobe map jumps at the border, so that no motion stays on it.
    state : array (coordinate,)
        The strobe state, in the order of `names`.
    accuracy : float
        By how much it may be wrong, in the scales of its coordinates: of a periodic orbit from the residual of Newton's method and what the
        map makes of it, otherwise the distance of the pair between which the border is.
    orbit : PeriodicOrbit or None
        The motion, where it is periodic.
    miss : float
        How far from the orbit the edge track still was, in scales, which Newton's method did not see; NaN without an orbit.
    sides : tuple of str
        The motions to which starts on its two sides lead.
    attractors : array (2, coordinate)
        A strobe state on each of the two motions to which the starts that were given lead.
    track : array (n, coordinate)
        The strobe states of the edge track, from the first bisection on.
    notes : tuple of str
        What limits the result.
    at : Coordinates
        Of its states, with the section of a model without a period.

    Examples
    --------
    >>> import stickslip as ss
    >>> cubic = ss.SwitchingFlow.of_map(lambda y, n: (n.r * y[0] - y[0] ** 3 + n.h,), {"r": 1.5, "h": 0.05}, ("x",))
    >>> edge = ss.dynamics.edge_state(cubic, {"x": -1.0}, {"x": 1.0})
    >>> edge.kind, round(float(edge.state[0]), 6), [round(float(m), 6) for m in edge.multipliers]  # a root of h + (r - 1) x = x^3
    ('repeller', -0.102131, [1.468708])
    """

    model: Any
    kind: str
    state: Array
    accuracy: float
    orbit: Any
    miss: float
    sides: tuple[str, str]
    attractors: Array
    track: Array
    notes: tuple[str, ...] = ()
    at: Any = None

    _drawn_by = "edge_state"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the numbers of the state."""
        return coordinates(self.model).names

    @property
    def strobe_state(self) -> Array:
        """The state with all that is held beside it."""
        return self.state

    @cached_property
    def strobe_points(self) -> Array:
        """The strobe points of the motion: array (n, coordinate); those of the edge track where it has no period, one of a jump."""
        if self.kind == "not periodic":
            return self.track
        return np.vstack([self.state[None, :], strobe_orbit(self.model, self.state, max(self.period, 1), 1e-12, self.at)[0][:-1, 0]])

    @property
    def multipliers(self) -> Array:
        """Floquet multipliers of the orbit, the largest first; none where it is not periodic."""
        return np.empty(0) if self.orbit is None else self.orbit.multipliers

    @property
    def period(self) -> int:
        """Drive periods until it repeats; 0 where it does not."""
        return 0 if self.orbit is None else self.orbit.period

    def _facts(self) -> dict[str, Any]:
        state = ", ".join(f"{name} = {value:.9g}" for name, value in zip(self.names, self.state, strict=True))
        facts = {"edge state": f"{self.kind}: {_KINDS[self.kind]}", "strobe state": f"{state} (± {self.accuracy:.1e} of the scales)"}
        if self.orbit is not None:
            facts |= {"repeats after": f"{self.period} drive period{'s' * (self.period != 1)}"}
            facts |= {"multipliers": ", ".join(f"{m:.6g}" for m in self.multipliers)}
        return {**facts, "on one side": self.sides[0], "on the other side": self.sides[1]}

    def __repr__(self) -> str:
        return "<EdgeState: " + "; ".join(f"{name}: {value}" for name, value in self._facts().items()) + ">"


@explains_arguments
@interruptible
def edge_state(
    model: Model,
    first: Any,
    second: Any,
    *,
    periods: int = 100,
    settle: int = 200,
    rtol: float = 1e-10,
    section: Any = None,
    turns: int = 1,
    progress: Reported | bool | None = None,
) -> EdgeState:
    """The edge state between two attractors: the motion on the border of their basins, by bisection and edge tracking.

    The line between two starts that lead to different motions is cut until two states very close to one another straddle the border
    (Battelino, Grebogi, Ott, Yorke and Yorke 1988; Skufca, Yorke and Eckhardt 2006). Both are followed, and the line between them is cut
    again whenever they have come apart. They approach a motion that attracts what lies on the border. Where it comes back, Newton's method
    finds the periodic orbit, whose multipliers say what it is; it counts only if starts beside it, along its unstable direction, lead to
    the two motions.

    Parameters
    ----------
    model : Robot, machine or SwitchingFlow
        A map by ``SwitchingFlow.of_map``. A machine without a period is looked at on a section, and its returns count as drive periods.
    first, second : Attractor, dict, array, Trajectory or orbit
        Two attractors of `basins`, or two starts that lead to different motions.
    periods : int
        Drive periods that the border is followed at most.
    settle : int
        Drive periods after which it is first asked to which motion a start leads; what is on neither then is run on, to 15 times as long.
    rtol : float
        Tolerance for dynamic laws.
    section : str or tuple, optional
        Of a model without a period: where its motions are looked at, by the name of a state, ``section="v"``, with the value that it
        passes, ``section=("v", 0.0)``, and the direction, 1 where it rises and -1 where it falls. If not given, it is chosen from a run.
    turns : int
        Of a model without a period: after how many returns to the section it is looked at again.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with (what is done, periods so far, periods at most); return False to stop.

    Returns
    -------
    EdgeState
        `kind`, `state`, `accuracy`, `orbit`, `multipliers`, `sides`, `track`.

    Raises
    ------
    InputError
        Where both starts lead to one motion.
    SolveError
        Where a start could not be solved.

    References
    ----------
    Battelino, Grebogi, Ott, Yorke, Yorke, *Multiple coexisting attractors, basin boundaries and basic sets*, Physica D 32 (1988) 296.
    Skufca, Yorke, Eckhardt, *Edge of chaos in a parallel shear flow*, Physical Review Letters 96 (2006) 174101.

    Examples
    --------
    >>> import stickslip as ss
    >>> duffing = lambda t, y, n: (y[1], y[0] - y[0] ** 3 - n.d * y[1] + n.F * ss.maths.cos(t))
    >>> flow = ss.SwitchingFlow({0: duffing}, {}, 2 * ss.maths.pi, {"d": 0.5, "F": 0.1}, ("x", "v"))
    >>> edge = ss.dynamics.edge_state(flow, {"x": -1.0}, {"x": 1.0})
    >>> edge.kind, edge.period, bool(edge.multipliers[0] > 1 > edge.multipliers[1])
    ('saddle', 1, True)
    """
    needs_model("edge_state", model, flows=True, sections=True)
    problems = Problems("edge_state")
    problems.whole("periods", periods, 1, example=100)
    problems.whole("settle", settle, 1, example=200)
    checked_number("rtol", rtol, problems, between(1e-14, 1e-3), "a tolerance from 1e-14 to 1e-3", "rtol=1e-10")
    problems.check()
    ends = np.vstack([states_of(start.state if isinstance(start, Attractor) else start, model)[:1] for start in (first, second)])
    at = on_section(model, section=section, turns=turns, states=ends, what="edge_state")
    judge = judge_between(model, at, int(settle), rtol, ends)
    report = reporting(progress, "edge_state")
    state = _tracked(judge, narrowed(judge, ends if at.section is None else judge.ends), int(periods), report)
    report(state.kind, int(periods), int(periods))
    return replace(state, at=at)


def _tracked(judge: SideJudge, pair: Array, periods: int, report: Reported) -> EdgeState:
    """Follow the border from a pair that straddles it, until it comes back, jumps, or the periods are over."""
    track, tried = [pair.mean(axis=0)], dict.fromkeys(range(1, LONGEST + 1), np.inf)
    with partial_result() as ending:
        state = _on_the_border(judge, pair, track, tried, periods, report)
    if not ending.interrupted:
        return state
    ending.needs(len(track) > 1)
    note = ending.note(f"the border was followed for {len(track) - 1} of {periods} periods")
    return _of_track(judge, "not periodic", track, float("nan"), note)


def _on_the_border(judge: SideJudge, pair: Array, track: list[Array], tried: dict[int, float], periods: int, report: Reported) -> EdgeState:
    """The edge state to which a track leads, which grows period by period."""
    for done in range(periods):
        report("periods along the border", done, periods)
        look()
        pair, ahead = _ahead(judge, pair)
        after = float(judge.at.distance(*ahead))
        if not after <= _JUMP:
            return _jump(judge, track, float(judge.at.distance(*pair)), after)
        pair = narrowed(judge, ahead) if after > _WIDE else ahead
        track.append(pair.mean(axis=0))
        period, back = _nearest_return(judge.at, track)
        if back < min(_BACK, 0.5 * tried[period]):
            tried[period] = back
            orbit = _as_orbit(judge, track, period)
            if orbit is not None:
                return orbit
    return _without_period(judge, track, pair)


def _ahead(judge: SideJudge, pair: Array) -> tuple[Array, Array]:
    """A pair and where it is one period later; it is brought nearer first where it comes far apart."""
    ahead = strobe_map(judge.model, pair, 1, judge.rtol, judge.at).state
    if judge.at.distance(*ahead) <= _JUMP:
        return pair, ahead
    pair = narrowed(judge, pair)
    return pair, strobe_map(judge.model, pair, 1, judge.rtol, judge.at).state


def _nearest_return(at: Coordinates, track: list[Array]) -> tuple[int, float]:
    """After how many periods the end of a track came back most nearly, and how nearly; of several the shortest within a factor of four."""
    misses = [float(at.distance(track[-1], track[-1 - p])) for p in range(1, min(LONGEST, len(track) - 1) + 1)]
    if not misses:
        return 1, np.inf
    best = min(misses)
    return next((p, miss) for p, miss in enumerate(misses, 1) if miss <= 4 * best)


def _as_orbit(judge: SideJudge, track: list[Array], period: int) -> EdgeState | None:
    """The periodic orbit that a track approaches, if there is one whose sides lead to different motions.

    One with more unstable directions than one does not attract what lies on the border: the track only passes it.
    """
    try:
        orbit = orbit_near(judge.model, period, track[-1], judge.at)
    except (SolveError, InputError):
        return None
    state, at = orbit.strobe_state, judge.at
    miss = float(at.distance(track[-1], state))
    if miss > 10 * _BACK or not np.isfinite(orbit.monodromy).all() or np.count_nonzero(abs(orbit.multipliers) > 1.0) != 1:
        return None
    ways = _sides_of(judge, orbit)
    sides = sorted(set(np.ravel(ways).tolist()))
    if len(sides) < 2 or sides[0] != 0:
        return None
    kind = "saddle" if len(orbit.multipliers) > 1 else "repeller"
    sentences, notes = _names_of_sides(judge, sides[:2]), _remarks(ways)
    return EdgeState(judge.model, kind, state, _accuracy(at, orbit), orbit, miss, sentences, judge.ends, np.array(track), notes)


def _sides_of(judge: SideJudge, orbit: Any) -> Array:
    """The motions to which starts beside an orbit lead, along its most unstable direction: array (2 sides, distances)."""
    values, vectors = np.linalg.eig(orbit.monodromy)
    d, scales = judge.at.smooth, judge.at.scales[: judge.at.smooth]
    along = np.real(vectors[:, int(np.argmax(abs(values)))])
    along = along / np.max(abs(along) / scales)
    starts = np.tile(orbit.strobe_state, (2 * len(_ASIDE), 1))
    starts[:, :d] += np.concatenate([_ASIDE, -_ASIDE])[:, None] * along
    return judge.sides(starts).reshape(2, -1)


def _remarks(ways: Array) -> tuple[str, ...]:
    """Remarks on the border, from the attractors on its two sides."""
    notes = []
    if 1 not in ways:
        notes.append("between the two starts lies the basin of another motion: it is on the border of the first's")
    if any({0, 1} <= set(side.tolist()) for side in ways):
        notes.append("starts on one and the same side of it lead to either motion, by their distance: the border is fractal here, and "
                     "other motions are on it too")  # fmt: skip
    return tuple(notes)


def _names_of_sides(judge: SideJudge, sides: list[int]) -> tuple[str, str]:
    names = [f"the {order} motion, {named_motion(judge.model, judge.motions, k)}" for k, order in enumerate(("first", "second"))]
    names.append("another motion, or none within the time")
    return names[sides[0]], names[sides[1]]


def _accuracy(at: Coordinates, orbit: Any) -> float:
    """By how much the state of an orbit may be wrong, in scales: its residual, by what the map makes of an error, three times."""
    scales = at.scales[at.free]
    M = derivative_of(orbit, at) / scales[:, None] * scales
    inverse = np.linalg.pinv(np.eye(len(M)) - M)
    rounding = np.finfo(float).eps * max(1.0, float(np.max(abs(orbit.strobe_state[at.free]) / scales)))
    return float(np.max(abs(inverse).sum(axis=1)) * 3 * max(float(orbit.residual), orbit.rtol * 1e-2, rounding))


def _jump(judge: SideJudge, track: list[Array], apart: float, after: float) -> EdgeState:
    stretch = f"two states {apart:.1e} of the scales apart are {after:.1e} apart after one drive period"
    note = f"{stretch}: the strobe map jumps at the border, or stretches as much; the border is not made of motions that stay on it"
    return _of_track(judge, "jump", track, apart, note)


def _without_period(judge: SideJudge, track: list[Array], pair: Array) -> EdgeState:
    pair = narrowed(judge, pair)
    track = [*track[:-1], pair.mean(axis=0)]
    period, back = _nearest_return(judge.at, track)
    nearest = f"nearest: {back:.1e} of the scales after {period}"
    note = f"the edge track does not repeat within {LONGEST} periods ({nearest}); its points stay on the border"
    return _of_track(judge, "not periodic", track, float(judge.at.distance(*pair)), note)


def _of_track(judge: SideJudge, kind: str, track: list[Array], apart: float, note: str) -> EdgeState:
    """The edge state of a track that is not a periodic orbit."""
    return EdgeState(
        judge.model, kind, track[-1], apart, None, np.nan, _names_of_sides(judge, [0, 1]), judge.ends, np.array(track), (note,)
    )
