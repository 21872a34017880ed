"""Strobe states from any description of a start: a dict, numbers, the end of a run, or an orbit."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.batch import Labels, cases_of
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.fields import floats, number
from stickslip.dynamics.flows.flow_stretches import Passage
from stickslip.dynamics.periodic.closed_orbits import PeriodicOrbit
from stickslip.dynamics.stroboscopic.strobe_maps import (
    Coordinates,
    coordinates,
    state_at_rest,
    states_of_start,
    strobe_states,
)  # fmt: skip
from stickslip.models.state_layout import of_one_contact
from stickslip.models.switching_flow import knows_mode, unknown_mode
from stickslip.results.trajectory import Trajectory
from stickslip.solvers.flow_requests import starts_of
from stickslip.solvers.flow_starts import starting_modes
from stickslip.solvers.initial_states import LARGEST_START
from stickslip.solvers.plain.composed_flows import mode_of_state, mode_of_strobe_state


def states_of(start: Any, model: Model) -> Array:
    """Strobe states from a start as `solve` takes it, states, a run (its end), or an orbit; rest from None: array (cases, coordinates)."""
    at, rest = coordinates(model), state_at_rest(model)
    if start is None:
        return rest
    if isinstance(start, (list, np.ndarray)) and (table := floats(start)).shape == rest.shape:
        return np.array(_checked(start, table, at))
    if not at.in_lanes:
        return np.tile(_flow_state(start, model, at), (len(rest), 1))
    if isinstance(start, dict) and at.named:
        return _checked(start, states_of_start("start", model, start), at)
    if isinstance(start, dict):
        columns = [_named(start, name, rest[:, i]) for i, name in enumerate(at.names)]
        return _checked(start, np.stack(columns, axis=1), at)
    return np.tile(_one_state(start, at, rest[0]), (len(rest), 1))


def _flow_state(start: Any, flow: Any, at: Coordinates) -> Array:
    """The state of a flow and the place of its mode, from an orbit, a run's end, a dict, or numbers."""
    if isinstance(start, PeriodicOrbit) or (isinstance(start, Trajectory) and not start.pieces.layout.bodies):
        return start.strobe_state
    if isinstance(start, Passage):
        return np.append(start.state, list(flow.modes).index(start.mode))
    mode, problems = None, Problems("start")
    if isinstance(start, dict) and "mode" in start:
        mode, start = start["mode"], {name: value for name, value in start.items() if name != "mode"}
        if not knows_mode(flow.start_modes, mode):
            problems.add(f"mode: {unknown_mode(mode, flow.start_modes)}")
    elif np.shape(start) == (len(at.names),) and start[-1] in range(-len(flow.fields) if flow.contacts else 0, len(flow.modes)):
        mode, start = mode_of_strobe_state(flow, np.asarray(start, float)), start[:-1]
    state = starts_of(flow, start, Labels(()), problems)[0]
    problems.check()
    first = cases_of(flow, slice(1))[0]
    mode = starting_modes(first, state[None, :], one=True)[0] if mode is None else mode
    return np.append(state, list(flow.modes).index(mode_of_state(first, state, mode=mode)))


def _one_state(start: Any, at: Coordinates, rest: Array) -> Array:
    """The strobe state of an orbit, of a run's end, or as it was given."""
    if isinstance(start, PeriodicOrbit):
        return _shared(start, at, rest)
    if isinstance(start, Trajectory):
        return _end_of(start, at)
    state = floats(start).ravel()
    if state.shape != (len(at.names),):
        raise InputError("start", [f"{start!r} is not a state; allowed are the numbers {', '.join(at.names)}, or a dict; type {_dict(at)}"])
    return _checked(start, state, at)


def _shared(orbit: PeriodicOrbit, at: Coordinates, rest: Array) -> Array:
    """The state of an orbit; of an orbit under another law what it has of the state, and the rest as at rest."""
    known = dict(zip(orbit.names, orbit.state, strict=True))
    if not known.keys() & set(at.names):
        mistake = f"the orbit's state is {', '.join(known)}; allowed is an orbit with {' or '.join(at.names)}"
        raise InputError("start", [f"{mistake}; type guess=ss.solve(machine, periods=200)"])
    return np.array([known.get(name, still) for name, still in zip(at.names, rest, strict=True)])


def _end_of(run: Any, at: Coordinates) -> Array:
    """The last strobe state of a run of the same bodies."""
    if not at.named:
        return strobe_states(of_one_contact("periodic_orbit", run, "its strobe states have one velocity"))[-1]
    given, wanted = (tuple(run.body_columns), tuple(run.contacts)), (at.mechanics.bodies, at.mechanics.contacts)
    if given != wanted:
        parts = [f"bodies {', '.join(bodies)} and contacts {', '.join(contacts)}" for bodies, contacts in (given, wanted)]
        raise InputError("start", [f"the run has {parts[0]}; allowed is a run of {parts[1]}; type guess=ss.solve(machine, periods=200)"])
    return strobe_states(run)[-1]


def _checked(start: Any, state: Array, at: Coordinates) -> Array:
    """A state whose numbers are finite and of a size that can be computed with."""
    if not np.all(abs(state) <= LARGEST_START):
        allowed = f"finite {', '.join(at.names)} up to {LARGEST_START:.0e} in size"
        raise InputError("start", [f"{start!r} has numbers that are too large or not finite; allowed are {allowed}; type {_dict(at)}"])
    return state


def _dict(at: Coordinates) -> str:
    """A start that can be typed."""
    return "dict(v=0.0)" if not at.named else f"dict(v={{{at.mechanics.bodies[0]!r}: 0.0}})"


def _named(start: dict[str, Any], name: str, rest: Array) -> Array:
    """One number of a start, for each case; z0, z1, ... are entries of z, memory0, ... of memory. What is not named is as at rest."""
    whole = name.rstrip("0123456789")
    given = name if name in start or name == whole else whole
    if given not in start:
        return rest
    try:
        values = np.ravel(number(start[given]))
        return np.full(len(rest), values[int(name[len(whole) :]) if given != name and len(values) > 1 else 0], float)
    except (ValueError, IndexError):
        raise InputError(
            "start", [f"{given} = {start[given]!r}; allowed is a number, or as many as the law has; type {given}=0.0"]
        ) from None
