"""Periodic orbits, stable or not, by Newton's method on the strobe map."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.basics.arguments import Model, explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.errors import Problems, SolveError
from stickslip.basics.interruption import interruptible
from stickslip.dynamics.flows.flow_cycles import cycle_of_flow, cycle_shown
from stickslip.dynamics.flows.flow_orbits import flow_orbit
from stickslip.dynamics.periodic.closed_orbits import RTOL, PeriodicOrbit
from stickslip.dynamics.periodic.closing import StrobeReturns, closed
from stickslip.dynamics.periodic.cycle_sections import TURN, Section
from stickslip.dynamics.periodic.drifting import drift_sentence
from stickslip.dynamics.periodic.given_states import states_of
from stickslip.dynamics.periodic.limit_cycles import limit_cycle
from stickslip.dynamics.periodic.newton import Root
from stickslip.dynamics.stroboscopic.chosen_sections import check_section
from stickslip.dynamics.stroboscopic.differences import beyond_limits, difference_jacobian
from stickslip.dynamics.stroboscopic.refusals import needs_model
from stickslip.dynamics.stroboscopic.strobe_maps import (
    Coordinates,
    coordinates,
    state_at_rest,
    strobe_map,
    strobe_orbit,
    with_rests,
)  # fmt: skip
from stickslip.models.machine_adapter import machine_of
from stickslip.solvers.plain.composed_flows import mode_of_strobe_state

_SETTLING = 100  # drive periods that a guess is run for
_CANDIDATES = (8, 120)  # strobe states of that run that are tried as guesses: for period one, and for others
_SAME = 1e-7  # strobe states closer than this are one


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
) -> PeriodicOrbit:
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
    PeriodicOrbit
        `multipliers`, `stable`, `mean_velocity`, `type`, `state`, `duration`, `events`, `residual`; with a drive also `margin`, without
        `amplitude`.

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
    needs_model("periodic_orbit", model, flows=True, sections=True)
    problems = Problems("periodic_orbit")
    if period is not None:
        problems.whole("period", period, 1, example=1, what=" of drive periods")
    problems.check()
    check_section("periodic_orbit", model, section, turns)
    if turns is not None:
        period = int(turns) * (1 if period is None else int(period))
    at = coordinates(model)
    if model.period is not None:
        find = _forced if at.in_lanes else _forced_flow
        return find(model, 1 if period is None else int(period), guess, rtol, tolerance)
    if at.in_lanes:
        return limit_cycle(model, period, guess, section=section, rtol=rtol, tolerance=tolerance)
    return cycle_shown(model, period, guess, section)


def _forced(model: Model, period: int, guess: Any, rtol: float, tolerance: float) -> PeriodicOrbit:
    """A periodic motion of a machine with a period."""
    tried, beyond, at = list[Root](), tuple[str, ...](), coordinates(model)
    for state in _from_rest(model, period, at) if guess is None else [states_of(guess, model)[0]]:
        root = _solve(model, period, state, rtol, tolerance)
        tried.append(root)
        state = np.append(root.at * at.scales[: at.smooth], root.memory)
        beyond = beyond_limits(model, state) if root.good else ()
        if root.good and not beyond and not _shorter(model, state, period, rtol):
            return orbit_through(at, model, period, state, root.residual, rtol)
    if beyond:
        why = f"Newton's method went to a state whose {', '.join(beyond)} is beyond the limit at which a memory of the law switches"
        raise SolveError(f"no motion of period {period} was found: {why}, to which no run leads; give guess=ss.solve(robot, periods=200)")
    raise SolveError(_failure(model, period, tried, guess))


def _forced_flow(flow: Any, period: int, guess: Any, rtol: float, tolerance: float) -> PeriodicOrbit:
    """The same of a flow, exact to rounding; without a guess from where it settles."""
    state = states_of(guess, flow)[0]
    return flow_orbit(flow, state[:-1], mode_of_strobe_state(flow, state), periods=period, settle=0 if guess is not None else _SETTLING)


def orbit_near(model: Model, period: int, state: Array, at: Coordinates) -> PeriodicOrbit:
    """The orbit near a strobe point, or near a point on the section of a model without a period."""
    if at.section is None:
        return periodic_orbit(model, period, guess=state)
    took = float(strobe_map(model, state[None, :], period, 1e-10, at).duration[0])
    if not at.in_lanes:
        return cycle_of_flow(model, state, took, at)
    cycle = PeriodicOrbit(model, period, state, np.nan, duration=took, section=TURN)
    if at.section.is_switch:
        return limit_cycle(model, period, replace(cycle, on_section=state), section=at.section.name)
    turns = machine_of(model).turning_velocity is not None and at.section.name == "v"
    return limit_cycle(model, period, cycle if turns else replace(cycle, section=Section(at.section.index, float(at.section.value))))


def orbit_through(at: Coordinates, model: Model, period: int, state: Array, residual: float, rtol: float) -> PeriodicOrbit:
    """The orbit of a model with a period through a state that is known to come back."""
    return PeriodicOrbit(model, period, with_rests(model, state, period, rtol), residual, rtol).noted()


def derivative_of(orbit: Any, at: Coordinates) -> Array:
    """The derivative of the strobe map, or of the return map, along an orbit."""
    if at.section is None:
        return np.asarray(orbit.monodromy, float)
    return difference_jacobian(orbit.model, orbit.strobe_state, orbit.period, orbit.rtol, at=at)


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
    d, state = at.smooth, np.asarray(state, float)
    return closed(StrobeReturns(model, at, period, rtol), state[:d] / at.scales[:d], np.round(state[d:]), tolerance=tolerance)


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
