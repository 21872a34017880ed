"""Lyapunov exponents of a robot's motion: all of them from its tangent, the largest from two neighbours."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.arguments import Executes, Model, explains_arguments
from stickslip.basics.batch import some_of
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.executors import HERE, Workers
from stickslip.basics.fields import checked_number
from stickslip.basics.interruption import interruptible, look, partial_result
from stickslip.basics.quantities import between
from stickslip.dynamics.derivatives.growth import growth_in_stretches
from stickslip.dynamics.derivatives.tangents import not_followed
from stickslip.dynamics.exponents.between_returns import ALIGN, CHUNK, LEAST, between_returns
from stickslip.dynamics.exponents.general_exponents import Lyapunov, error_of_mean
from stickslip.dynamics.exponents.growing_frames import grown, stretches_of
from stickslip.dynamics.exponents.lost_directions import summary, with_lost
from stickslip.dynamics.periodic.given_states import states_of
from stickslip.dynamics.periodic.kinds_of_orbits import resting
from stickslip.dynamics.stroboscopic.chosen_sections import on_section
from stickslip.dynamics.stroboscopic.chunked_runs import Report, Tell, over_chunks
from stickslip.dynamics.stroboscopic.refusals import needs_model
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, flight, refuse_chance, strobe_map, strobe_states
from stickslip.models.model_adapter import adapter_of
from stickslip.solvers.plain.composed_flows import mode_of_strobe_state
from stickslip.studies.progress import Watch

if TYPE_CHECKING:
    from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates
    from stickslip.results.trajectory import Trajectory


_APART = 1e-7  # distance of two neighbours, in scales


@explains_arguments
@interruptible
def lyapunov(
    model: Model,
    periods: int = 2000,
    *,
    settle: int = 200,
    start: Any = None,
    rtol: float = 1e-7,
    section: Any = None,
    turns: int = 1,
    progress: Report | None = None,
) -> Lyapunov:
    """All Lyapunov exponents of the attractor of a robot, per drive period (natural logarithm); without a period per second.

    Small perturbations are propagated along the motion by the tangent equations, through every switch and stop. Under a set-valued law
    a body that comes to rest loses the memory of its velocity, and a controller that of its state at a sample: the exponent is -inf, and
    `note` says so. The 0 of the cyclic position is left out. Directions that contract below rounding error within a period, as those of
    stiff bristles do, share the remaining rate of volume contraction equally. Without a period the motion is followed from return to return
    to its section, which take the place of drive periods; if it oscillates one exponent is 0, that along the motion.

    Parameters
    ----------
    model : Robot, machine or SwitchingFlow
        One of them.
    periods : int
        Drive periods to average over.
    settle : int
        Drive periods to discard before.
    start : dict, optional
        Initial state, as for `solve`; rest if not given.
    rtol : float
        Tolerance of the run.
    section : str or tuple, optional
        Of a model without a period: where its motions are looked at, by the name of a state, ``section="v"``, with the value that it
        passes, ``section=("v", 0.0)``, and the direction, 1 where it rises and -1 where it falls. If not given, it is chosen from a run.
    turns : int
        Of a model without a period: after how many returns to the section it is looked at again.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with a `Progress` of drive periods; return False to stop: the averages
        until then are returned, as after Ctrl-C, and `note` says so.

    Returns
    -------
    Lyapunov
        `largest`, `spectrum`, `error`, `errors`, `record`.

    Examples
    --------
    >>> import stickslip as ss
    >>> l = ss.lyapunov(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb"), periods=50)
    >>> round(l.largest, 6)  # type IV: the logarithm of its multiplier
    -2.418858
    """
    check_exponents(model, periods, settle)
    state = states_of(start, model)
    at = on_section(model, section=section, turns=turns, states=state, what="lyapunov")
    begun = at.section.starts(state)[0] if start is None and at.section is not None else start
    return exponents_along(model, periods, settle, begun, rtol, progress, at)[0]


def exponents_along(
    model: Model, periods: int, settle: int, start: Any, rtol: float, progress: Report | None, at: Coordinates
) -> tuple[Lyapunov, bool]:
    """The exponents of `lyapunov`, and whether they are averages over fewer periods, as it was interrupted."""
    if at.section is not None:
        return between_returns(model, periods, settle, start, rtol, progress, at)
    if at.in_lanes:
        return _over_periods(model, periods, settle, start, rtol, progress)
    return _of_stretches(model, periods, settle, start), False


def _over_periods(model: Model, periods: int, settle: int, start: Any, rtol: float, progress: Report | None) -> tuple[Lyapunov, bool]:
    """The same of a machine with a period."""
    state = state_after(model, start, settle, rtol)
    run = flight(model, state[0], ALIGN, rtol)  # its growth is left out: the frame turns into place
    state, Q, logs, parts = strobe_states(run)[-1:], _growth(run, np.eye(coordinates(model).smooth))[1], [], 0
    watch = Watch(periods, progress)
    with partial_result() as ending:
        while parts < periods:
            look()
            count = min(CHUNK, periods - parts)
            run = flight(model, state[0], count, rtol)
            state = strobe_states(run)[-1:]
            grown, Q = _growth(run, Q)
            logs.append(grown)
            parts += count
            watch.finished(0, np.zeros(count, int))
    ending.needs(parts >= LEAST)
    exponents = summary(np.concatenate(logs))
    notes = ending.note(f"averages over {parts} of {periods} drive periods"), exponents.note
    return replace(exponents, note="; ".join(filter(None, notes))), ending.interrupted


def _of_stretches(flow: Any, periods: int, settle: int, start: Any) -> Lyapunov:
    """The same of a flow with a period, from the derivative that its tangent gives of each."""
    state, T = state_after(flow, start, settle, 1e-12)[0], float(flow.period)
    mode = mode_of_strobe_state(flow, state)
    return summary(np.concatenate(list(stretches_of(flow, state[:-1], mode, count=periods, settle=ALIGN, every=T, rtol=1e-12))))


def state_after(model: Model, start: Any, settle: int, rtol: float, at: Coordinates | None = None) -> Array:
    """The strobe state, or that on a section, after some periods: array (1, coordinate)."""
    state = states_of(start, model)
    return strobe_map(model, state, settle, rtol, at).state if settle else state


def check_exponents(model: Model, periods: Any, settle: Any) -> None:
    """Refuse what has no exponents here, and lengths that are none."""
    needs_model("lyapunov", model, flows=True, sections=True)
    refuse_chance(adapter_of(model))
    if why := not_followed(model):
        hint = "type ss.dynamics.largest_exponents(machine) for the largest exponent, from neighbours"
        raise InputError("lyapunov", [f"perturbations are not propagated here, as {why}; {hint}"])
    problems = Problems("lyapunov")
    problems.whole("periods", periods, LEAST, example=2000)
    problems.whole("settle", settle, 0, example=200)
    problems.check()


def _growth(run: Trajectory, Q: Array) -> tuple[Array, Array]:
    """The logarithms of the growth in every drive period of a run, and the frame at its end.

    As many of the last directions as contacts rest at one instant end there. What is lost below rounding has what the volume leaves over.
    """
    growth = growth_in_stretches(coordinates(run.model), run.model, strobe_states(run)[: run.periods], run.rtol)
    rests, logs = _most_at_rest(run), np.empty((run.periods, len(Q)))
    for k, M in enumerate(growth.matrices):
        Q, own = grown(M, Q)
        logs[k] = with_lost(own, growth.volumes[k], rests[k])
    return logs, Q


def _most_at_rest(run: Trajectory) -> Array:
    """How many directions are forgotten at one instant in each period of a run."""
    begins = np.asarray(run.pieces.t)[:-1] - run.pieces.t[0]
    number = np.minimum((begins / run.period_time + 1e-9).astype(int), run.periods - 1)
    most = np.zeros(run.periods, int)
    np.maximum.at(most, number, resting(run))
    return most


@explains_arguments
@interruptible
def largest_exponents(
    model: Model,
    periods: int = 400,
    *,
    settle: int = 200,
    start: Any = None,
    rtol: float = 1e-10,
    apart: float = _APART,
    workers: int = 1,
    executor: Executes = None,
    progress: Report | None = None,
) -> tuple[Array, Array]:
    """The largest exponent of every case of a batch, from two neighbouring motions whose distance is rescaled after every drive period.

    This is an independent check on `lyapunov`, and the method for maps: all cases run in one batch.

    Parameters
    ----------
    model : Robot
        One robot or a batch.
    periods, settle : int
        Drive periods to average over, and to discard before.
    start : array (cases, coordinate), optional
        Initial strobe states; rest if not given.
    rtol : float
        Tolerance; well below `apart`.
    apart : float
        Distance of the neighbours, in the scales of the coordinates.
    workers : int
        Threads. The results do not depend on it.
    executor : executor or callable, optional
        Compute there, as for `sweep`; `workers` is then the number of its workers.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with a `Progress`; return False to stop. Cases not computed are then NaN.

    Returns
    -------
    exponents, errors : array (cases,)

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    >>> largest_exponents(robot, periods=20, settle=50)[0].round(4).tolist()
    [-2.4189]
    """
    needs_model("largest_exponents", model, batch=True, flows=True)
    problems = Problems("largest_exponents")
    checked_number("apart", apart, problems, between(1e-14, 0.1), "a distance from 1e-14 to 0.1, in the scales of the state", "apart=1e-7")
    problems.whole("periods", periods, 1, example=400)
    problems.whole("settle", settle, 0, example=200)
    crew = Workers(workers, executor)
    crew.note(problems)
    problems.check()
    state = states_of(start, model)
    whole = np.full((2, len(state)), np.nan)
    with partial_result():
        for part, values in _parts_apart(model, state, Neighbours(periods, settle, rtol, apart), crew, progress):
            whole[:, part] = values
    return whole[0], whole[1]


@dataclass(frozen=True)
class Neighbours:
    """How far two neighbours are apart, in scales, and over which drive periods, after which transient, they are followed."""

    periods: int
    settle: int
    rtol: float
    apart: float


def exponents_from(
    model: Model, state: Array, periods: int, *, rtol: float, apart: float, at: Coordinates | None = None
) -> tuple[Array, Array]:
    """The same from strobe states (cases, coordinates), one for each case of a batch; nothing is checked."""
    whole = np.full((2, len(state)), np.nan)
    for part, values in _parts_apart(model, state, Neighbours(periods, 0, rtol, apart), HERE, None, at):
        whole[:, part] = values
    return whole[0], whole[1]


def _parts_apart(
    model: Model, state: Array, how: Neighbours, workers: Workers, progress: Report | None, at: Coordinates | None = None
) -> Iterator[tuple[slice, tuple[Array, Array]]]:
    """Exponents and errors of a batch, part by part."""
    known = coordinates(model) if at is None else at

    def starts(part: slice) -> tuple[Model, Array, Coordinates]:
        return some_of(model, part), state[part], known.of(part)

    return over_chunks(len(state), starts, partial(_apart_after, how), workers, progress)


def _apart_after(how: Neighbours, starts: tuple[Model, Array, Coordinates], tell: Tell) -> tuple[Array, Array]:
    """Exponents and errors of some cases, after transients."""
    model, state, at = starts
    begun = strobe_map(model, state, how.settle, max(how.rtol, 1e-8), at).state if how.settle else state
    tell(how.settle / (how.settle + 3.0 * (ALIGN + how.periods)))
    return _apart_by(model, begun, at, how, tell)


def _apart_by(model: Model, state: Array, at: Coordinates, how: Neighbours, tell: Any) -> tuple[Array, Array]:
    """The mean growth of the distance of two neighbours per drive period, and its error, for some cases."""
    cases, periods, apart = len(state), how.periods, how.apart
    twice = np.tile(np.arange(cases), 2)
    both, of_both = some_of(model, twice), at.of(twice)
    d = at.smooth
    scales, free = at.scales[:d], np.isin(np.arange(d), at.free)
    root = np.sqrt(max(len(at.free), 1))
    even = np.where(free, 1 / root, 0.0)
    away, other = np.tile(np.where(free, apart * scales / root, 0.0), (cases, 1)), state[:, d:]
    logs = np.empty((ALIGN + periods, cases))
    for k in range(ALIGN + periods):
        if k % 16 == 15:
            tell(k / (ALIGN + periods))
        ends = strobe_map(both, np.vstack([state, np.hstack([state[:, :d] + away, other])]), 1, how.rtol, of_both).state
        state, other, gap = ends[:cases], ends[cases:, d:], np.where(free, (ends[cases:, :d] - ends[:cases, :d]) / scales, 0.0)
        size = np.linalg.norm(gap, axis=1)
        with np.errstate(divide="ignore"):
            logs[k] = np.log(size / apart)
        away = np.where(size[:, None] > 0, gap / np.where(size > 0, size, 1.0)[:, None], even) * apart * scales
    logs = logs[ALIGN:]
    return logs.mean(axis=0), error_of_mean(np.where(np.isfinite(logs), logs, 0.0))
