"""Periodic orbits and exponents of switching flows, and any model with a set-valued law as such a flow."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from stickslip.analysis.state_order import needs_one_body
from stickslip.basics.arguments import Single, explains_arguments
from stickslip.basics.contracts import Array, ArrayLike
from stickslip.basics.errors import InputError, Problems, SolveError, is_whole
from stickslip.basics.interruption import interruptible
from stickslip.dynamics.flows.flow_stretches import Passage, needs_flow, passage, started, touches
from stickslip.dynamics.periodic.closed_orbits import PeriodicOrbit
from stickslip.dynamics.periodic.closing import PassageReturns, closed, extent_of
from stickslip.dynamics.periodic.newton import Root
from stickslip.models.friction.law_adapter import law_of
from stickslip.models.normal_loads import normal_load
from stickslip.models.switching_flow import Switch, SwitchingFlow
from stickslip.solvers.flow_engine import FlowStart
from stickslip.solvers.plain.composed_flows import mode_of_state

_STILL = 1e-9  # of the size of the state: what moves by less stands still
_APART = 1e6  # so many times its miss must an orbit be large to be told from an equilibrium
_SAME = 1e-6  # of its size: how well an orbit comes back that has been around
_CLOSE = 1e-8  # of the size of the state: nearer than that rounding may keep a state from coming back
_ITERATIONS = 30  # of Newton's method
_PARTS = (2, 3, 5, 7, 11, 13)
_ALIKE, _CANDIDATES = 2.0, 12  # times the nearest: what is taken for the same state again; so many switches are tried


@explains_arguments
@interruptible
def flow_orbit(
    flow: SwitchingFlow,
    state: ArrayLike,
    mode: Any,
    *,
    periods: int = 1,
    duration: float | None = None,
    settle: int = 0,
    most: int = 30,
    rtol: float = 1e-12,
    method: str = "auto",
) -> PeriodicOrbit:
    """A periodic orbit of a switching flow, by Newton's method with derivatives from saltation matrices.

    Parameters
    ----------
    flow : SwitchingFlow
    state, mode
        A guess.
    periods : int
        Number of forcing periods after which it repeats.
    duration : float
        For an autonomous flow, a guess of the orbit's period. The orbit that is found is traversed once.
    settle : int
        Periods to run before Newton's method begins.
    most : int
        Largest number of iterations.
    rtol : float
        Tolerance of SciPy's integrator, and of the orbit.
    method : {"auto", "exact", "dop853"}
        As for `passage`: the compiled engine, or SciPy's integrator as a second opinion.

    Returns
    -------
    PeriodicOrbit
        `state`, `mode`, `duration`, `multipliers` and `passage` of the orbit.

    Raises
    ------
    SolveError
        If Newton's method finds no orbit from this guess, converges to an equilibrium of an autonomous flow, or finds a forced motion that
        repeats after fewer than `periods` periods.

    Examples
    --------
    Den Hartog's oscillator with dry friction 0.3 at 0.7 times its natural frequency never stops:

    >>> from stickslip.maths import cos
    >>> slide = lambda side: lambda t, y: (y[1], -y[0] + cos(0.7 * t) - side * 0.3)
    >>> turn = {1: (Switch(lambda t, y: y[1], -1),), -1: (Switch(lambda t, y: -y[1], 1),)}
    >>> o = flow_orbit(SwitchingFlow({1: slide(1), -1: slide(-1)}, turn, 2 * np.pi / 0.7), [1.0, 0.5], 1, settle=20)
    >>> round(float(o.passage.highest[0]), 3), o.stable  # X = 1.8857
    (1.886, True)
    """
    _check_asked(flow, periods, duration, settle, most)
    begun = FlowStart(state, mode)  # type: ignore[arg-type]
    y = started(flow, begun, 1.0 if duration is None else duration, rtol, what="flow_orbit", method=method)
    T = periods * float(flow.period or duration or 0.0)
    how: dict[str, Any] = {"rtol": rtol, "method": method}
    mode = mode_of_state(flow, y, mode=mode)
    if flow.period is None:
        y, mode, T = _returned(flow, y, mode, T, settle, how)
    for _ in range(settle if flow.period else 0):
        done = passage(flow, y, mode, T, **how)
        y, mode = done.state, done.mode
    return _once(flow, _closed(flow, flow.drifts.wrapped(y), mode, T, most, how), periods, most, how)


def _check_asked(flow: Any, periods: Any, duration: Any, settle: Any, most: Any) -> None:
    """An error where it is no flow, or numbers say no length of time."""
    needs_flow("flow_orbit", flow, f"{flow!r} is not a flow; allowed is a SwitchingFlow")
    problems = Problems("flow_orbit")
    problems.whole("periods", periods, 1, example=1, what=" of periods of the forcing")
    problems.whole("settle", settle, 0, example=20)
    problems.whole("most", most, 1, example=30)
    free = flow.period is None
    if free and duration is None:
        problems.add("the flow has no period; give duration=, a guess of the orbit's period")
    if free and is_whole(periods) and periods > 1:
        problems.add(f"periods = {periods!r}, but the flow has no period; leave periods out, and give duration=")
    if not free and duration is not None:
        problems.add(f"duration = {duration!r}, but the flow has a period; leave duration out, and give periods=")
    problems.check()


def _closed(flow: SwitchingFlow, y: Array, mode: Any, T: float, most: int, how: dict[str, Any]) -> PeriodicOrbit:
    """The orbit to which Newton's method goes from a guess."""
    free, size = flow.period is None, float(1 + abs(y).max())
    motion, held = PassageReturns(flow, size, T, how), np.array([float(list(flow.modes).index(mode))])
    motion.passage(motion.unknowns(y), held)  # which raises what cannot be followed
    root = closed(motion, motion.unknowns(y), held, tolerance=3 * how["rtol"], most=most, floor=_CLOSE)
    if len(motion.failures) and not np.isfinite(root.residual):
        raise motion.failures[-1]
    done, y, T, mode = motion.passage(root.at, root.memory), motion.state(root.at), motion.time(root.at), motion.mode(root.memory)
    miss, extent = float(abs(motion.miss(root.at, root.memory)).max()), motion.extent(done)
    still = extent <= max(_STILL * float(1 + abs(y).max()), 3 * miss)
    if free and (still if miss <= _STILL * size else extent < _APART * miss and root.good):
        raise SolveError(_nothing_moves(y, mode, T, motion.duration))
    if not np.isfinite(done.monodromy).all():
        raise SolveError(touches(done))
    if not root.good:
        raise SolveError(_not_found(root))
    notes = ("it is an equilibrium: nothing moves, and it repeats after any time",) if still else ()
    return _orbit(flow, y, mode, T, miss, how, notes, done)


def _not_found(root: Root) -> str:
    """Why Newton's method found no orbit."""
    where = f"(residual {root.residual:.1e})"
    if root.residual > _CLOSE:
        return f"Newton's method found no periodic orbit in {root.iterations} iterations {where}; try settle=, or another guess"
    why = f"{root.why} {where}"
    return f"Newton's method found no periodic orbit: {why}; try another value of the parameter, or another guess"


def _orbit(
    flow: SwitchingFlow, y: Array, mode: Any, T: float, residual: float, how: dict[str, Any], notes: tuple[str, ...], done: Passage
) -> PeriodicOrbit:
    """The orbit whose passage has been found."""
    period = 1 if flow.period is None else max(round(T / float(flow.period)), 1)
    state = np.append(y, list(flow.modes).index(mode))
    return PeriodicOrbit(flow, period, state, residual, notes=notes, duration=T, _passage=done, **how)


def closed_once(flow: SwitchingFlow, y: Array, mode: Any, T: float) -> PeriodicOrbit:
    """The cycle of a flow without a period to which Newton's method goes from a state and a duration, traversed once."""
    how: dict[str, Any] = {"rtol": 1e-12, "method": "auto"}
    return _once(flow, _closed(flow, flow.drifts.wrapped(y), mode, T, _ITERATIONS, how), 1, _ITERATIONS, how)


def _nothing_moves(y: Array, mode: Any, T: float, guessed: float) -> str:
    hint = "try a guess of state and duration nearer to the orbit, such as a state of a long passage that has settled on it, or settle="
    if guessed > 1e3 * T:
        return f"Newton's method went to a duration of zero, after which every state repeats; {hint}"
    return (
        f"Newton's method went to an equilibrium, y = {[float(f'{v:.6g}') for v in y]} in mode {mode!r}, which repeats after any "
        f"time and is not an orbit; {hint}"
    )


def _once(flow: SwitchingFlow, orbit: PeriodicOrbit, periods: int, most: int, how: dict[str, Any]) -> PeriodicOrbit:
    """The orbit gone around once: the shortest duration of a free flow, an error where forced motions repeat before `periods` are over."""
    for k in _PARTS if flow.period is None else [k for k in range(periods, 1, -1) if periods % k == 0 and not orbit.notes]:
        part = passage(flow, orbit.state, orbit.mode, orbit.duration / k, **how)
        extent, miss = extent_of(flow, orbit.passage), flow.drifts.difference(part.state, orbit.state)
        if part.mode != orbit.mode or abs(miss).max() > max(_SAME * extent, 10 * orbit.residual):
            continue
        if flow.period is not None:
            mistake = f"the motion found repeats after {periods // k} of {periods} periods"
            raise SolveError(f"{mistake}; type periods={periods // k}, or give another guess")
        return _once(flow, _closed(flow, orbit.state, orbit.mode, orbit.duration / k, most, how), periods, most, how)
    return orbit


def _returned(flow: SwitchingFlow, y: Array, mode: Any, duration: float, settle: int, how: dict[str, Any]) -> tuple[Array, Any, float]:
    """A better guess for a flow that does not depend on time: a state after its last switch, and the time since the same one before."""
    whole = max(settle, 3) * duration
    done = passage(flow, y, mode, whole, **how)
    events, extent = done.events, np.maximum(done.highest - done.lowest, _STILL * float(1 + abs(y).max()))
    same = [k for k in range(len(events) - 2, -1, -1) if events[k][1:] == events[-1][1:]][:_CANDIDATES]
    if not same:
        return (done.state, done.mode, duration) if settle else (y, mode, duration)
    after = lambda k: passage(flow, y, mode, whole, **how, switches=k + 1)  # noqa: E731
    done = after(len(events) - 1)
    misses = [float((abs(flow.drifts.difference(after(k).state, done.state)) / extent).max()) for k in same]
    before = next(k for k, miss in zip(same, misses, strict=True) if miss <= _ALIKE * min(misses) + _SAME)  # a period may have several
    onward = 0.5 * (events[before + 1][0] - events[before][0])  # not on a switch, but half way to the next
    ended = passage(flow, done.state, done.mode, onward, **how) if onward > 0 else done
    return ended.state, ended.mode, events[-1][0] - events[before][0]


@explains_arguments
def switching_flow(model: Single) -> SwitchingFlow:
    """Any model with a set-valued law as a switching flow with modes +1, 0 and -1 and the states x and v.

    With ``method="dop853"`` its passages and orbits come from SciPy's integrator and from Python's own loops: slow, and independent of our
    solvers.

    Parameters
    ----------
    model : Robot or a mechanism
        With a law that has `sliding` and `breakaway`.

    Returns
    -------
    SwitchingFlow

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    >>> done = passage(switching_flow(robot), [0.0, 0.0], 0, robot.period)
    >>> [after for _, _, after in done.events]
    [1, -1]
    """
    needs_one_body("switching_flow", model, "its modes are those of one contact")
    law = law_of(model)
    if law.dynamic:
        raise InputError("switching_flow", [f"{law.name} has inner states; allowed are laws with sliding and breakaway"])
    still = -float(model.contact_velocity(0.0))

    def slide(side: int) -> Callable[[Any, Any], Any]:
        def rate(t: Array, y: Array) -> Any:
            held = side * abs(model.contact_velocity(y[1]))
            return y[1], model.acceleration(t, y[0], y[1], law.sliding(held + side * 1e-300, normal_load(model, t, y[0])))

        return rate

    def room(t: Any, y: Any, side: int) -> Any:
        offered = model.total_mass * model.acceleration(t, y[0], still, 0.0)
        return side * (law.breakaway(normal_load(model, t, y[0]))[1 if side > 0 else 0] - offered)

    def after(t: ArrayLike, y: ArrayLike) -> int:
        return 1 if room(t, y, 1) < 0 else -1 if room(t, y, -1) < 0 else 0

    def rest(t: Array, y: Array) -> Any:
        return (y[0], still)

    fields: dict[Any, Any] = {1: slide(1), -1: slide(-1), 0: lambda t, y: (still, 0.0)}
    switches: dict[Any, tuple[Switch, ...]] = {
        1: (Switch(lambda t, y: model.contact_velocity(y[1]), after, rest),),
        -1: (Switch(lambda t, y: -model.contact_velocity(y[1]), after, rest),),
        0: (Switch(lambda t, y: room(t, y, 1), 1), Switch(lambda t, y: room(t, y, -1), -1)),
    }
    return SwitchingFlow(fields, switches, model.period and float(model.period))
