"""Cycles of flows that nothing forces: found from a run, on the section that it shows, and brought back to that section."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.analysis.section_choice import asked_for
from stickslip.basics.contracts import Array
from stickslip.basics.errors import SolveError
from stickslip.dynamics.flows.flow_orbits import closed_once
from stickslip.dynamics.flows.flow_stretches import passage
from stickslip.dynamics.periodic.closed_orbits import PeriodicOrbit
from stickslip.dynamics.periodic.cycle_sections import Section
from stickslip.dynamics.periodic.given_states import states_of
from stickslip.dynamics.periodic.limit_cycles import at_its_switch
from stickslip.dynamics.stroboscopic.chosen_sections import LONGEST_CYCLE, on_section, shown_by_a_run, turns_shown
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates, strobe_map, strobe_points
from stickslip.solvers.plain.composed_flows import mode_of_strobe_state

_SETTLING, _LOOKED = 60, 33  # returns before the cycle is looked for, and as many as are looked at


def cycle_of_flow(flow: Any, state: Array, took: float, at: Coordinates) -> PeriodicOrbit:
    """The cycle near a state that comes back after some time, on its section.

    Raises
    ------
    SolveError
        Where Newton's method finds none.
    """
    y, mode = state[:-1], mode_of_strobe_state(flow, state)
    if not at.section.is_switch:
        return on_its_section(closed_once(flow, y, mode, took), at)
    first = passage(flow, y, mode, took, switches=1).time
    between = passage(flow, y, mode, 0.5 * min(first, took))  # not at a switch, but half way to the next
    return at_its_switch(closed_once(flow, between.state, between.mode, took), at.section.name)


def on_its_section(orbit: PeriodicOrbit, at: Coordinates) -> PeriodicOrbit:
    """A cycle as it begins where it passes a section, with the number of its turns."""
    flow = orbit.model
    begun = strobe_map(flow, orbit.strobe_state[None, :], 1, 1e-12, replace(at, section=replace(at.section, turns=1))).state[0]
    if not np.isfinite(begun).all():
        return orbit
    y, mode = begun[:-1], mode_of_strobe_state(flow, begun)
    done = passage(flow, y, mode, orbit.duration)
    residual = float(abs(flow.drifts.difference(done.state, y)).max())
    if done.mode != mode or residual > max(1e3 * orbit.residual, 1e-9 * float((done.highest - done.lowest).max())):
        return orbit
    times = np.cumsum(strobe_points(flow, begun[None, :], LONGEST_CYCLE, 1e-12, replace(at, section=replace(at.section, turns=1)))[2][:, 0])
    turns = 1 + int(np.argmin(abs(times - orbit.duration)))
    section = Section(at.section.index, float(at.section.value))
    return replace(orbit, period=turns, strobe_state=begun, residual=residual, section=section, _passage=done)


def cycle_shown(flow: Any, period: int | None, guess: Any, section: Any = None) -> PeriodicOrbit:
    """The cycle to which a guess leads, or that a run shows.

    Parameters
    ----------
    period : int, optional
        Turns after which it repeats; as many as the run shows if not given.
    guess : dict, array, Trajectory or PeriodicOrbit, optional
        Of an orbit the duration is taken too. If not given, the first start that oscillates.
    section : str or tuple, optional
        As for `periodic_orbit`.
    """
    at, asked = coordinates(flow), asked_for("periodic_orbit", section, flow)
    if asked.switch:
        return at_its_switch(cycle_shown(flow, None, guess), str(asked.name), period)
    if isinstance(guess, PeriodicOrbit):
        looked = on_section(flow, at, section=section, states=guess.section_state[None, :], what="periodic_orbit")
        return cycle_of_flow(flow, guess.section_state, guess.duration, looked)
    begun = states_of(guess, flow)
    shown = shown_by_a_run(flow, at, asked, begun, only=guess is not None)
    if not shown.oscillates:
        end = f"{float(shown.run.nodes[-1]):.6g}"
        raise SolveError(f"no cycle was found: in {end} the run comes to rest; give guess=, a start, run or orbit that leads to a cycle")
    at = on_section(flow, at, section=shown.cut.asked)
    state = shown.end if guess is None else begun
    settled = strobe_map(flow, np.atleast_2d(state), _SETTLING if guess is None else 1, 1e-12, at).state
    points, _, times = strobe_points(flow, settled, _LOOKED, 1e-12, at)
    points, times = np.vstack([settled, points[:, 0]]), times[:, 0]
    if not np.isfinite(points).all():
        raise SolveError("no cycle was found: the flow could not be followed from return to return; give guess=, a start on the cycle")
    p = turns_shown(at, points) if period is None else period
    return cycle_of_flow(flow, points[-1], float(times[-p:].sum()), at)
