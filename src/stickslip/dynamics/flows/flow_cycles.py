"""Cycles of flows that nothing forces: found from a run, on the section that it shows, and brought back to that section."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.analysis.section_choice import asked_for
from stickslip.basics.contracts import Array
from stickslip.basics.errors import SolveError
from stickslip.dynamics.flows.flow_orbits import FlowOrbit, closed_once, multipliers_of_passage, touches
from stickslip.dynamics.flows.flow_stretches import passage
from stickslip.dynamics.periodic.cycle_sections import Section
from stickslip.dynamics.periodic.given_states import states_of
from stickslip.dynamics.stroboscopic.chosen_sections import LONGEST_CYCLE, on_section, shown_by_a_run, turns_shown
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates, strobe_map, strobe_points
from stickslip.solvers.plain.composed_flows import mode_of_strobe_state

_SETTLING, _LOOKED = 60, 33  # returns before the cycle is looked for, and as many as are looked at


def cycle_of_flow(flow: Any, state: Array, took: float, at: Coordinates) -> FlowOrbit:
    """The cycle near a state that comes back after some time, on its section.

    Raises
    ------
    SolveError
        Where Newton's method finds none.
    """
    orbit = closed_once(flow, state[:-1], mode_of_strobe_state(flow, state), took)
    return on_its_section(orbit, at)


def on_its_section(orbit: FlowOrbit, at: Coordinates) -> FlowOrbit:
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
    return replace(cycle_at(flow, begun, orbit.duration, residual, section, turns), notes=orbit.notes)


def cycle_at(flow: Any, strobe_state: Array, duration: float, residual: float, section: Section, turns: int) -> FlowOrbit:
    """The cycle through a state that is known to come back."""
    y, mode = strobe_state[:-1], mode_of_strobe_state(flow, strobe_state)
    done = passage(flow, y, mode, duration)
    touched = () if np.isfinite(done.monodromy).all() else (touches(done),)
    return FlowOrbit(y, mode, duration, multipliers_of_passage(flow, done), residual, done, touched, flow, turns, section)


def cycle_shown(flow: Any, period: int | None, guess: Any, section: Any = None) -> FlowOrbit:
    """The cycle to which a guess leads, or that a run shows.

    Parameters
    ----------
    period : int, optional
        Turns after which it repeats; as many as the run shows if not given.
    guess : dict, array, FlowRun or FlowOrbit, optional
        Of an orbit the duration is taken too. If not given, the first start that oscillates.
    section : str or tuple, optional
        As for `periodic_orbit`.
    """
    at, asked = coordinates(flow), asked_for("periodic_orbit", section, flow)
    if isinstance(guess, FlowOrbit):
        looked = on_section(flow, at, section=section, states=guess.strobe_state[None, :], what="periodic_orbit")
        return cycle_of_flow(flow, guess.strobe_state, guess.duration, looked)
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
