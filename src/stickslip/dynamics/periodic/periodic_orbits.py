"""Periodic orbits, stable or not, by Newton's method on the strobe map."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property, singledispatch
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from stickslip.analysis.motion import Motion, Motions, motion
from stickslip.basics.arguments import Model, explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import Problems, SolveError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import interruptible
from stickslip.dynamics.derivatives.tangents import Directions, changes_along, jacobian_of, not_followed, orders_differ
from stickslip.dynamics.flows.flow_cycles import cycle_at, cycle_of_flow, cycle_shown
from stickslip.dynamics.flows.flow_orbits import FlowOrbit, flow_orbit, orbit_at
from stickslip.dynamics.periodic.closed_orbits import NEUTRAL, ClosedMotion, multipliers_of, resting
from stickslip.dynamics.periodic.cycle_sections import TURN, Section
from stickslip.dynamics.periodic.drifting import drift_sentence
from stickslip.dynamics.periodic.given_states import states_of
from stickslip.dynamics.periodic.limit_cycles import LimitCycle, limit_cycle
from stickslip.dynamics.periodic.newton import STEP, Root, newton_within
from stickslip.dynamics.stroboscopic.chosen_sections import check_section
from stickslip.dynamics.stroboscopic.differences import at_limits, beyond_limits, difference_jacobian
from stickslip.dynamics.stroboscopic.refusals import needs_model
from stickslip.dynamics.stroboscopic.strobe_maps import (
    Coordinates,
    FlowCoordinates,
    coordinates,
    flight,
    position_of,
    state_at_rest,
    strobe_map,
    strobe_orbit,
    with_rests,
)  # fmt: skip
from stickslip.models.angular_coordinates import unit_of_part
from stickslip.models.machine_adapter import is_machine, machine_of
from stickslip.models.rounding import without_rounding
from stickslip.models.switching_flow import SwitchingFlow
from stickslip.solvers.plain.composed_flows import mode_of_strobe_state

if TYPE_CHECKING:
    from stickslip.dynamics.periodic.limit_cycles import LimitCycle
    from stickslip.models.machines import BlockOnBelt, Chain, ForcedOscillator, PulledMass
    from stickslip.models.robot import Robot

RTOL = 1e-12
RUNS = 1e-10  # of the runs along an orbit: its multipliers have nine digits then (the state itself is found at rtol)
_SETTLING = 100  # drive periods that a guess is run for
_CANDIDATES = (8, 120)  # strobe states of that run that are tried as guesses: for period one, and for others
_SAME = 1e-7  # strobe states closer than this are one


@sealed
class PeriodicOrbit(ClosedMotion):
    """A periodic motion: its strobe state, its multipliers and its properties. The velocity is periodic, the position drifts.

    On a track that repeats the position is periodic modulo its wavelength: the motion advances by a whole number of wavelengths.

    Parameters
    ----------
    model : Robot
        What moves.
    period : int
        Drive periods until the motion repeats.
    state : array
        The state on the strobe t = 0 mod T, in the order of `names`; integer memories of the law come last.
    residual : float
        Distance between the state and its image after one motion period, in the scales of its coordinates.
    rtol : float
        Tolerance of the runs that it was computed with.

    Examples
    --------
    >>> import stickslip as ss
    >>> orbit = ss.periodic_orbit(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb"))
    >>> orbit.type, orbit.stable, orbit.names, [float(round(m, 6)) for m in orbit.multipliers]
    ('IV', True, ('v',), [0.089023])
    """

    model: Any
    period: int
    state: Array
    residual: float
    rtol: float = RTOL
    notes: tuple[str, ...] = ()

    @cached_property
    def run(self) -> Any:
        """One motion period, with its dense output."""
        return replace(flight(self.model, self.state, self.period, max(self.rtol, RUNS)), known_period=self.period)

    @cached_property
    def multipliers(self) -> Array:
        """Floquet multipliers, the largest first; the 1 of the cyclic position is left out. Real where all of them are."""
        return multipliers_of(self.monodromy, 0 if not_followed(self.model) else int(resting(self.run).max()))

    @cached_property
    def monodromy(self) -> Array:
        """The derivative of the state after the motion with respect to that before it; `evidence` says how it was found."""
        if not_followed(self.model):
            return self._jacobian(STEP)
        return jacobian_of(self.model, self.state, self.period, self.rtol)

    def _jacobian(self, step: float) -> Array:
        return difference_jacobian(self.model, self.state, self.period, self.rtol, step)

    @cached_property
    def evidence(self) -> str:
        """How the multipliers were found, and what limits them."""
        if why := not_followed(self.model):
            sizes = coordinates(self.model).scales[: len(self.monodromy)]
            moved = abs(self.monodromy - self._jacobian(4 * STEP)) / sizes[:, None] * sizes
            return f"central differences of the strobe map, as {why}; with steps four times as long the matrix changes by {moved.max():.1e}"
        if not np.isfinite(self.monodromy).all():
            return "a switch is touched without being crossed: the map has no derivative there"
        if names := self.run._thrown_together:
            return f"{' and '.join(names)} land at one instant and are thrown up: motions beside do so one by one, and the map jumps"
        source = "tangent of the system along the orbit, through every switch"
        if self._is_neutral:
            source += "; a contact that rests all the time may rest anywhere nearby, which adds a multiplier of 1"
        if limits := at_limits(self.model, self.state):
            stand = "stands" if len(limits) == 1 else "stand"
            source += f"; one-sided: {', '.join(limits)} {stand} at a limit of the law, and the derivative is that from within it"
        if orders_differ(self.model, self.state, self.period, self.rtol):
            return f"{source}; one-sided: contacts switch at one instant, and their order under perturbations matters"
        return source

    @cached_property
    def differences(self) -> Array:
        """The multipliers from finite differences of the strobe map, as an independent check; NaN at a state next to a stop."""
        return multipliers_of(self._jacobian(STEP), 0)

    @cached_property
    def mean_velocity(self) -> float:
        """Mean velocity V [m/s]: the net displacement in a motion period over its duration; for several bodies of their centre of mass."""
        run, way = self.run, position_of(self.run)
        return float((way[-1] - way[0]) / (run.strobe_times[-1] - run.strobe_times[0]))

    @cached_property
    def motion(self) -> Motion | Motions:
        """The result of `ss.motion`."""
        own: Any = motion(self.run)
        return own

    @property
    def type(self) -> str:
        """Type of the motion: "I" to "IV", "rest", "presliding" or "other"."""
        return self.motion.type

    @property
    def pattern(self) -> str:
        """Signs of the motion period in order, such as "+0-0"."""
        return self.motion.pattern

    def _begins(self, pattern: str) -> tuple[int, str]:
        return "+-0".index(pattern[0]), pattern

    @property
    def _is_neutral(self) -> bool:
        """Whether disturbances that do not die out only move what rests all the time to another place at rest."""
        free = sum(pattern == "0" for pattern in self.patterns.values())
        return self.stability == "neutral" and bool(np.sum(abs(self.multipliers) >= 1.0 - NEUTRAL) <= free)

    @property
    def margin(self) -> float:
        """Distance to the next border of motion types; 0 is on it."""
        return self.motion.margin

    @property
    def memory(self) -> float:
        """Drive periods in which a small disturbance decays to 1/e (negative: it grows); 0 if sticking removes it immediately."""
        largest = float(abs(self.multipliers).max())
        return 0.0 if largest == 0.0 else float("inf") if largest == 1.0 else -self.period / float(np.log(largest))

    def _facts(self) -> dict[str, Any]:
        patterns = self.patterns if len(self.patterns) > 1 else {"motion type": self.type, "pattern": self.pattern}
        return {
            "mean velocity": f"{without_rounding(self.mean_velocity, self.model):.9g} {unit_of_part('v', self.model, '')}",
            **{name: text.replace("-", "−") for name, text in patterns.items()},
            "repeats after": f"{self.period} drive period{'s' * (self.period != 1)}",
            "stability": f"{self.stability}; {self._multipliers_text}",
        }

    def __repr__(self) -> str:
        state = ", ".join(f"{name} = {value:.9g}" for name, value in zip(self.names, self.state, strict=True))
        single = self.run.pieces.layout.single
        kind = f"type {self.type}" if single else ", ".join(f"{name} {pattern}" for name, pattern in self.patterns.items())
        way = f"{without_rounding(self.mean_velocity, self.model):.9g} {unit_of_part('v', self.model, '')}"
        return (
            f"<PeriodicOrbit: period {self.period}, {kind}, V = {way}, "
            f"{self.stability} ({self._multipliers_text}), strobe state {state}, residual {self.residual:.1e}>"
        )


@overload
def periodic_orbit(model: SwitchingFlow, *arguments: Any, **more: Any) -> FlowOrbit: ...
@overload
def periodic_orbit(model: BlockOnBelt | PulledMass, *arguments: Any, **more: Any) -> LimitCycle: ...
@overload
def periodic_orbit(model: Robot | ForcedOscillator | Chain, *arguments: Any, **more: Any) -> PeriodicOrbit: ...
@overload
def periodic_orbit(model: Model, *arguments: Any, **more: Any) -> PeriodicOrbit | LimitCycle: ...
@explains_arguments
@interruptible
def periodic_orbit(
    model: Model,
    period: int | None = None,
    guess: Any = None,
    *,
    section: Any = None,
    turns: int | None = None,
    rtol: float = RTOL,
    tolerance: float = 1e-12,
) -> PeriodicOrbit | LimitCycle | FlowOrbit:
    """A periodic motion of a robot or mechanism, stable or unstable, by Newton's method on the strobe map.

    Without a drive (a block on a belt, a joint that hunts) it is a limit cycle, and its period is found too.

    Parameters
    ----------
    model : Robot, mechanism, machine or SwitchingFlow
        One of them.
    period : int, optional
        Drive periods after which the motion repeats, 1 if not given; without a drive, oscillations, as many as the run shows if not given
        (a cycle that repeats after fewer is given once, and its `notes` say so).
    guess : dict, array, Trajectory or PeriodicOrbit, optional
        Initial guess: a start as for `solve`, a strobe state, a run (its last strobe state) or a neighbouring orbit. If not given, the
        robot is run from rest, and the strobe states that return most closely are tried, and their means (which lead to the unstable motion
        between the points of a period-doubled one).
    section : str or tuple, optional
        Of models without a period, where the cycle begins and its turns are counted: the name of a state, alone or with the value that it
        passes and the direction (1 rises, -1 falls), such as ``("v", 0.0, -1)``; or a switch of a contact, such as ``"stick of block"``,
        or of a flow, from one mode to another, such as ``"free to hunted"``. If not given, what the run shows.
    turns : int, optional
        Of models without a period, how many returns to the section count as one; without `period` the cycle repeats after so many.
    rtol : float
        Tolerance of the strobe map for dynamic laws.
    tolerance : float
        The residual to be reached, in the scales of the coordinates (velocity: A mu omega).

    Returns
    -------
    PeriodicOrbit, LimitCycle without a drive, or FlowOrbit of a flow
        `multipliers`, `stable`, `mean_velocity`, `type`, `state`, `events`, `residual`; with a drive also `margin`, without `duration`.

    Raises
    ------
    SolveError
        If Newton's method does not converge; the message gives the reason and what to try.

    Examples
    --------
    >>> import stickslip as ss
    >>> orbit = ss.periodic_orbit(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, mu0=0.04), period=1)
    >>> orbit.stable, round(float(orbit.multipliers[0]), 4)  # the motion exists, but period two attracts
    (False, -2.625)

    The cycle of a block on a belt from where it slides back through x = 0.5 m:

    >>> law = ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)
    >>> belt = ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=law)
    >>> cycle = ss.periodic_orbit(belt, section=("x", 0.5, -1))
    >>> round(float(cycle.state[0]), 12), round(cycle.duration, 10), cycle.period
    (0.5, 7.6112592541, 1)
    """
    autonomous = is_machine(model) and model.period is None
    needs_model("periodic_orbit", model, driven=not autonomous, flows=True, sections=True)
    problems = Problems("periodic_orbit")
    if period is not None:
        problems.whole("period", period, 1, example=1, what=" of drive periods")
    problems.check()
    check_section("periodic_orbit", model, section, turns)
    if turns is not None:
        period = int(turns) * (1 if period is None else int(period))
    if autonomous:
        return limit_cycle(model, period, guess, section=section, rtol=rtol, tolerance=tolerance)
    if model.period is None:
        return cycle_shown(model, period, guess, section)
    return _forced(coordinates(model), model, 1 if period is None else int(period), guess, rtol, tolerance)


@singledispatch
def _forced(at: Coordinates, model: Model, period: int, guess: Any, rtol: float, tolerance: float) -> PeriodicOrbit | FlowOrbit:
    """A periodic motion of a model with a period."""
    tried, beyond = list[Root](), tuple[str, ...]()
    for state in _from_rest(model, int(period), at) if guess is None else [states_of(guess, model)[0]]:
        root = _solve(model, int(period), state, rtol, tolerance)
        tried.append(root)
        state = np.append(root.at * at.scales[: at.smooth], root.memory)
        beyond = beyond_limits(model, state) if root.good else ()
        if root.good and not beyond and not _shorter(model, state, int(period), rtol):
            state = with_rests(model, state, int(period), rtol)
            return PeriodicOrbit(model, int(period), state, root.residual, rtol)
    if beyond:
        why = f"Newton's method went to a state whose {', '.join(beyond)} is beyond the limit at which a memory of the law switches"
        raise SolveError(f"no motion of period {period} was found: {why}, to which no run leads; give guess=ss.solve(robot, periods=200)")
    raise SolveError(_failure(model, int(period), tried, guess))


def orbit_near(model: Model, period: int, state: Array, at: Coordinates) -> PeriodicOrbit | LimitCycle | FlowOrbit:
    """The orbit near a strobe point, or near a point on the section of a model without a period."""
    if at.section is None:
        return periodic_orbit(model, period, guess=state)
    took = float(strobe_map(model, state[None, :], period, 1e-10, at).duration[0])
    return _cycle_near(at, model, period, state, took)


@singledispatch
def _cycle_near(at: Coordinates, model: Model, period: int, state: Array, took: float) -> LimitCycle | FlowOrbit:
    """The cycle near a state on the section that comes back after some time."""
    if at.section.is_switch:
        nearby = LimitCycle(model, period, state, took, np.nan, RTOL, on_section=state)
        return limit_cycle(model, period, nearby, section=at.section.name)
    turns = machine_of(model).turning_velocity is not None and at.section.name == "v"
    section = TURN if turns else Section(at.section.index, float(at.section.value))
    return limit_cycle(model, period, LimitCycle(model, period, state, took, np.nan, RTOL, section=section))


@_cycle_near.register(FlowCoordinates)
def _(at: FlowCoordinates, flow: Any, period: int, state: Array, took: float) -> FlowOrbit:
    return cycle_of_flow(flow, state, took, at)


@singledispatch
def orbit_through(at: Coordinates, model: Model, period: int, state: Array, residual: float, rtol: float) -> PeriodicOrbit | FlowOrbit:
    """The orbit of a model with a period through a state that is known to come back."""
    return PeriodicOrbit(model, period, with_rests(model, state, period, rtol), residual, rtol)


@orbit_through.register(FlowCoordinates)
def _(at: FlowCoordinates, flow: Any, period: int, state: Array, residual: float, rtol: float) -> FlowOrbit:
    return orbit_at(flow, state, period, residual)


@singledispatch
def cycle_through(at: Coordinates, cycle: LimitCycle) -> LimitCycle | FlowOrbit:
    """The cycle of a model without a period that is known to come back; `cycle` says its model, turns, state, duration and section."""
    return cycle


@cycle_through.register(FlowCoordinates)
def _(at: FlowCoordinates, cycle: LimitCycle) -> FlowOrbit:
    return cycle_at(cycle.model, cycle.state, cycle.duration, cycle.residual, cycle.section, cycle.period)


def derivative_of(orbit: Any, at: Coordinates) -> Array:
    """The derivative of the strobe map, or of the return map, along an orbit."""
    if at.section is None:
        return np.asarray(orbit.monodromy, float)
    return difference_jacobian(orbit.model, orbit.strobe_state, orbit.period, orbit.rtol, at=at)


@_forced.register(FlowCoordinates)
def _(at: FlowCoordinates, flow: Any, period: int, guess: Any, rtol: float, tolerance: float) -> FlowOrbit:
    """Without a guess from where it settles."""
    state = states_of(guess, flow)[0]
    return flow_orbit(flow, state[:-1], mode_of_strobe_state(flow, state), periods=period, settle=0 if guess is not None else _SETTLING)


def _failure(model: Model, period: int, tried: list[Root], guess: Any) -> str:
    repeated = sum(f.good for f in tried)
    if repeated:
        return (
            f"no motion of period {period} was found: Newton's method went from all {repeated} guesses to one that repeats earlier; "
            f"type a smaller period, or a guess on the motion of period {period} (such as guess=run of a robot that has settled on it)"
        )
    best = min(tried, key=lambda f: f.residual)
    if np.isfinite(best.residual) and (reason := drift_sentence(model, best.at, best.memory)):
        return f"no motion of period {period} was found: {reason}"
    hint = "give a guess nearer to it (guess=orbit of a robot nearby), or follow it there with ss.continuation"
    if guess is None:
        hint += "; if the robot still settles, give guess=ss.solve(robot, periods=2000)"
    how = f"{best.why} (residual {best.residual:.1e} after {best.iterations} iterations)"
    return f"Newton's method found no motion of period {period}: {how}; {hint}"


def _solve(model: Model, period: int, state: Array, rtol: float, tolerance: float) -> Root:
    at = coordinates(model)
    d, scales = at.smooth, at.scales[: at.smooth]

    def ends(u: Array, memory: Array) -> Array:
        held = np.broadcast_to(memory, (*u.shape[:-1], len(memory)))
        return strobe_map(model, np.concatenate([u * scales, held], axis=-1), period, rtol).state

    def missed(end: Array, u: Array) -> Array:
        return end / scales - u if not at.comes_again else at.difference(end, u * scales) / scales

    def problem(memory: Array) -> Any:
        return lambda u: missed(ends(u, memory)[:, :d], u)

    def slopes(memory: Array) -> Any:
        def at_point(u: Array) -> tuple[Array, Array]:
            changes = changes_along(model, np.tile(np.append(u * scales, memory), (d, 1)), np.diag(scales), period, Directions(rtol=rtol))
            return missed(changes.state[0][:d], u), (changes.change / scales).T - np.eye(d)

        return at_point

    def after(u: Array, memory: Array) -> Array:
        return ends(u, memory)[0, d:]

    state, exact = np.asarray(state, float), None if not_followed(model) else slopes
    return newton_within(problem, after, state[:d] / scales, np.round(state[d:]), exact, tolerance=tolerance)


def _shorter(model: Model, state: Array, period: int, rtol: float) -> bool:
    """Whether a motion repeats before its period is over."""
    if period == 1:
        return False
    points = strobe_orbit(model, state, period, rtol)[0][:, 0]
    at = coordinates(model)
    return any(period % k == 0 and at.distance(points[k - 1], state) < _SAME for k in range(1, period))


def _from_rest(model: Model, period: int, at: Coordinates) -> list[Array]:
    """Strobe states of a run from rest that nearly come back after the period, and the means of neighbours, best first."""
    settled = strobe_map(model, state_at_rest(model), _SETTLING, 1e-6).state
    points = strobe_orbit(model, settled, _CANDIDATES[period > 1] + period, 1e-8)[0][:, 0]
    means = 0.5 * (points[1:] + points[:-1])
    means[:, at.smooth :] = points[1:, at.smooth :]
    tried = np.vstack([points, means])
    ends = strobe_map(model, tried, period, 1e-8).state
    miss = at.distance(ends, tried)
    if period > 1:  # a point of a shorter motion comes back too: take those that move first
        sooner = np.min([at.distance(strobe_map(model, tried, k, 1e-8).state, tried) for k in range(1, period) if period % k == 0], axis=0)
        miss = np.where(sooner < 1e-5, np.inf, miss)
    order = np.argsort(miss, kind="stable")
    return [tried[i] for i in order[: 6 if period == 1 else 12]]
