"""Limit cycles of autonomous machines: a block on a belt, a mass on a pulled spring, a joint that hunts. The period is an unknown."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.analysis.section_choice import Asked, asked_for, cut_of, passages
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, SolveError
from stickslip.basics.interruption import interruptible
from stickslip.dynamics.periodic.closed_orbits import PeriodicOrbit
from stickslip.dynamics.periodic.closing import SectionReturns, closed
from stickslip.dynamics.periodic.cycle_sections import Section, section_of
from stickslip.dynamics.stroboscopic.chosen_sections import turns_shown
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, largest_size
from stickslip.models.machine_adapter import machine_of
from stickslip.results.trajectory import Trajectory

_SETTLING = 60  # periods of the free oscillation that a guess is run for
_LONGER, _REPEATS = (1, 4, 16), 1e-3  # times that, of machines with slow states; a distance in scales
_STEADY = 1e-6  # of the velocity scale: what changes its velocity by less slides steadily
_EARLIER = 1e-7  # in scales: a state that comes so near to itself before its turns are over is on a shorter cycle
_MOST = 33  # returns in which it is looked for how many turns a cycle has
_SAMPLES = 1200  # looks at a run of that length, times ten


@interruptible
def limit_cycle(
    model: Model, period: int | None = None, guess: Any = None, *, section: Any = None, rtol: float = 1e-12, tolerance: float = 1e-12
) -> PeriodicOrbit:
    """A limit cycle of a mechanism without a drive, stable or unstable, by Newton's method for its state and its duration.

    Parameters
    ----------
    model : mechanism or machine
        One without a period, such as `BlockOnBelt`, `PulledMass`, or a `Joint` with a controller that hunts about a constant target.
    period : int, optional
        Turns of the spring, or returns to the section, after which the motion repeats; as many as the run shows if not given. A cycle that
        repeats after fewer is given with its own number, and a note.
    guess : dict, Trajectory or PeriodicOrbit, optional
        A start that leads to it, a run that ends on it, or a cycle nearby; if not given, a run from rest.
    section : str or tuple, optional
        Where it is cut, as for `periodic_orbit`; as the run shows it if not given, and of a cycle nearby as that is cut.
    rtol, tolerance : float
        Of the runs, and of the residual in scales.

    Raises
    ------
    SolveError
        Where the motion comes to steady sliding, or Newton's method does not converge.

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)
    >>> cycle = limit_cycle(ss.PulledMass(mass=1.0, stiffness=2.0, speed=0.1, friction=law))
    >>> round(cycle.mean_velocity, 12), round(cycle.duration, 10)  # the same cycle, seen from the ground
    (0.1, 7.6112592541)
    """
    asked = asked_for("periodic_orbit", section, model)
    if asked.switch:
        usual = limit_cycle(model, None, guess, rtol=rtol, tolerance=tolerance)
        return at_its_switch(usual, str(asked.name), period)
    state, duration, section, period = _guessed(model, period, guess, asked)
    at, unit = coordinates(model), clock(model)
    begun = section.unknowns(at, state, duration, unit)
    root = closed(SectionReturns(model, at, section, rtol, unit), begun, state[at.smooth :], tolerance=tolerance)
    if not root.good:
        raise SolveError(
            f"Newton's method found no cycle of {period} turns: {root.why} (residual {root.residual:.1e} after {root.iterations} "
            "iterations); give guess=ss.solve(mechanism, duration=...) of a run that has settled, or a cycle nearby"
        )
    state = section.states(model, at, root.at[None, :], root.memory)[0]
    cycle = PeriodicOrbit(model, period, state, root.residual, rtol, duration=float(root.at[-1] * unit), section=section)
    if np.max(np.ptp(cycle.run.v, axis=0)) <= _STEADY * at.speed:
        raise SolveError(
            "Newton's method went to steady sliding, which repeats after any time; give a guess nearer to the cycle, such as a start "
            "that rides along with the spring pulled far (guess=dict(x=..., v=...))"
        )
    return _once(cycle, rtol, tolerance)


def _once(cycle: PeriodicOrbit, rtol: float, tolerance: float) -> PeriodicOrbit:
    """The cycle, traversed once: one that repeats earlier than was asked is the shorter one, which says so."""
    model, at, unit, section, asked = cycle.model, coordinates(cycle.model), clock(cycle.model), cycle.section, cycle.period
    memory = cycle.strobe_state[at.smooth :]
    for turns in (k for k in range(1, asked) if asked % k == 0):
        duration = cycle.duration * turns / asked
        U = section.unknowns(at, cycle.strobe_state, duration, unit)[None, :]
        if float(np.max(abs(section.misses(model, at, U, memory, rtol, unit)))) < _EARLIER:
            shorter = limit_cycle(model, turns, replace(cycle, period=turns, duration=duration), rtol=rtol, tolerance=tolerance)
            return replace(shorter, notes=(f"it repeats after {turns} of the {asked} turns that were asked for", *shorter.notes))
    return cycle


def at_its_switch(cycle: PeriodicOrbit, name: str, period: int | None = None) -> PeriodicOrbit:
    """A cycle as it begins behind a switch, where a contact sticks, say; its period is how often that happens.

    Raises
    ------
    SolveError
        Where it does not happen, and where the cycle does not repeat after the period that is asked for.
    """
    from stickslip.solvers import solve

    usual = cycle.section_state
    run = solve(cycle.model, duration=2 * cycle.duration, keep="trajectory", **cycle.at.begun(cycle.model, usual))
    t = run._switch_times(name)
    if not len(t):
        goes = f"contacts have the patterns {cycle.patterns}" if cycle.patterns else f"modes are {', '.join(map(str, cycle.pattern))}"
        raise SolveError(f"the cycle has no {name!r}; its {goes}; give another section")
    turns = int(np.sum(t <= t[0] + (1.0 - _EARLIER) * cycle.duration))
    notes = cycle.notes
    if period is not None and period % turns:
        raise SolveError(f"the cycle repeats after {turns} times {name!r}, and {period} were asked for; leave the period and turns out")
    if period is not None and period > turns:
        notes = (f"it repeats after {turns} of the {period} turns that were asked for", *notes)
    begun = cycle.at.states_in(run, t[:1])[0]
    return replace(cycle, strobe_state=begun, period=turns, on_section=usual, notes=notes, _passage=None)


def clock(model: Model) -> float:
    """The time in which durations are measured [s]."""
    return largest_size(machine_of(model).time_scale)


# ---- guesses ----
def _guessed(model: Model, period: int | None, guess: Any, asked: Asked) -> tuple[Array, float, Section, int]:
    """A state on the section, how long it takes to come back, and after how many turns."""
    if isinstance(guess, PeriodicOrbit) and guess.is_cycle:
        if asked.name is not None or guess.on_section is not None or guess.section is None:
            return _cut_elsewhere(guess, period, asked)
        return guess.strobe_state, guess.duration, guess.section, guess.period if period is None else period
    if machine_of(model).time_scale is None:
        raise InputError(type(model).__name__, ["it has neither a period nor a time_scale, so the time to search for a cycle is not known"])
    if isinstance(guess, Trajectory):
        return _last_turn(guess, period, asked)
    if isinstance(guess, (list, np.ndarray)) and np.shape(guess) == (len(coordinates(model).names),):
        guess = coordinates(model).start(np.asarray(guess, float))
    if guess is not None and not isinstance(guess, dict):
        mistake = f"guess = {guess!r}; allowed is a start, a run or a cycle; type guess=dict(x=0.5), or leave it out"
        raise InputError("periodic_orbit", [mistake])
    return _last_turn(_settled(model, guess, asked), period, asked)


def _cut_elsewhere(cycle: PeriodicOrbit, period: int | None, asked: Asked) -> tuple[Array, float, Section, int]:
    """A cycle as it begins on another section: twice around it passes that twice as often."""
    from stickslip.solvers import solve

    run = solve(cycle.model, duration=2 * cycle.duration, keep="trajectory", **cycle.at.begun(cycle.model, cycle.strobe_state))
    cut = cut_of(run, asked)
    t = passages(run, cut)
    t = t[t >= 0.5 * cycle.duration]
    if not len(t):
        raise SolveError(f"the cycle that is given does not pass {cut}; give another section, such as section={asked.name!r}")
    turns = max(1, int(np.sum(t <= t[0] + (1.0 - _EARLIER) * cycle.duration)))
    state = cycle.at.states_in(run, t[:1])[0]
    return state, cycle.duration * (period or turns) / turns, section_of(cycle.model, cut), period or turns


def _settled(model: Model, start: Any, asked: Asked) -> Any:
    """A run from a start that is long enough; that of a machine with slow states goes on until it repeats, or has taken long."""
    from stickslip.solvers import solve

    options: dict[str, Any] = {"rtol": 1e-8} if machine_of(model).has_inner_states else {}
    at = coordinates(model)
    for longer in _LONGER if machine_of(model).turning_velocity is None else (1,):
        run = solve(model, duration=longer * _SETTLING * clock(model), start=start, samples=longer * _SAMPLES, **options)
        t = passages(run, cut_of(run, asked))
        if len(t) > 2 and at.distance(*at.states_in(run, t[-2:])) < _REPEATS:
            break
    return run


def _last_turn(run: Trajectory, period: int | None, asked: Asked) -> tuple[Array, float, Section, int]:
    """The last state of a run on the section, and how long its last turns took."""
    cut = cut_of(run, asked)
    t = passages(run, cut)
    at = coordinates(run.model)
    if period is None:
        period = turns_shown(at, at.states_in(run, t[-_MOST:])) if len(t) > 2 else 1
    steady = len(t) < 2 or float(np.max(np.ptp(run.with_axes.at(np.linspace(t[-2], t[-1], 64))["v"], axis=0))) <= _STEADY * at.speed
    if steady or len(t) < period + 2:
        end = "it rests, or slides on steadily" if steady else f"only {len(t)} oscillations were found"
        raise SolveError(
            f"no cycle was found in {float(run.pieces.t[-1]):.6g} s: {end}; give another start (guess=dict(x=..., v=...)), or a longer run "
            "(guess=ss.solve(mechanism, duration=...))"
        )
    return at.states_in(run, t[-1:])[0], float(t[-1] - t[-1 - period]), section_of(run.model, cut), period
