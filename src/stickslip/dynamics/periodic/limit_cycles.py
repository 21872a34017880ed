"""Limit cycles of autonomous machines: a block on a belt, a mass on a pulled spring, a joint that hunts. The period is an unknown."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property, singledispatch
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.analysis.oscillation import Oscillation, kind_of_cycle, oscillation_of_cycle
from stickslip.analysis.section_choice import Asked, asked_for, cut_of, passages, switches_in
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, SolveError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import interruptible
from stickslip.dynamics.derivatives.tangents import jacobian_of, not_followed
from stickslip.dynamics.periodic.closed_orbits import ClosedMotion, multipliers_of, resting
from stickslip.dynamics.periodic.cycle_sections import TURN, Section, section_of, states_of_returns
from stickslip.dynamics.periodic.newton import newton_within
from stickslip.dynamics.stroboscopic.chosen_sections import turns_shown
from stickslip.dynamics.stroboscopic.differences import difference_jacobian
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, largest_size
from stickslip.models.machine_adapter import machine_of
from stickslip.results.steadiness import way_of_machine

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


_RUNS = 1e-10  # of the run around a cycle
_SETTLING = 60  # periods of the free oscillation that a guess is run for
_LONGER, _REPEATS = (1, 4, 16), 1e-3  # times that, of machines with slow states; a distance in scales
_STEADY = 1e-6  # of the velocity scale: what changes its velocity by less slides steadily
_EARLIER = 1e-7  # in scales: a state that comes so near to itself before its turns are over is on a shorter cycle
_MOST = 33  # returns in which it is looked for how many turns a cycle has
_SAMPLES = 1200  # looks at a run of that length, times ten


@sealed
class LimitCycle(ClosedMotion):
    """A limit cycle: its turning points, period and multipliers.

    Parameters
    ----------
    model : mechanism or machine
        What moves.
    period : int
        Turns of the spring, or returns to the section, until the motion repeats.
    state : array
        The state on the section, in the order of `names`: at a turning point of the spring, from whose far end x is measured; of machines
        of several bodies, or with a controller, where the position that moves most is in the middle of its range.
    duration : float
        How long the cycle takes [s].
    residual : float
        How far the state is from itself after it, in the scales of its coordinates.
    rtol : float
        Tolerance of the runs that it was computed with.
    section : Section
        Where it is cut.
    on_section : array, optional
        The state there, where the cycle is shown from a contact's switch (``section="stick of block"``).

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)
    >>> cycle = ss.periodic_orbit(ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=law))
    >>> round(cycle.duration, 10), cycle.type, cycle.multipliers.tolist()  # riding the belt forgets everything
    (7.6112592541, 'stick-slip', [0.0])
    """

    model: Any
    period: int
    state: Array
    duration: float
    residual: float
    rtol: float
    notes: tuple[str, ...] = ()
    section: Section = TURN
    on_section: Any = None

    @property
    def section_state(self) -> Array:
        """The state on the section by which the cycle was computed, also where it is shown from a contact's switch."""
        return self.state if self.on_section is None else np.asarray(self.on_section)

    @property
    def period_time(self) -> float:
        """How long the cycle takes [s]."""
        return self.duration

    @cached_property
    def run(self) -> Any:
        """One period of the orbit, with its dense output."""
        from stickslip.solvers import solve

        options: dict[str, Any] = {"rtol": max(self.rtol, _RUNS)} if machine_of(self.model).has_inner_states else {}
        return solve(self.model, duration=self.duration, start=self.start, keep="trajectory", **options)

    @cached_property
    def monodromy(self) -> Array:
        """The derivative of the state after the cycle by the state before it."""
        return jacobian_of(self.model, self.state, 1, self.rtol, span=self.duration)

    @cached_property
    def multipliers(self) -> Array:
        """Floquet multipliers, the largest first; the 1 along the cycle is left out."""
        return multipliers_of(self.monodromy, int(resting(self.run).max()), autonomous=True)

    @cached_property
    def differences(self) -> Array:
        """The multipliers once more, from differences of the flow: the second opinion."""
        return multipliers_of(difference_jacobian(self.model, self.state, rtol=self.rtol, span=self.duration), 0, autonomous=True)

    @cached_property
    def mean_velocity(self) -> float:
        """Mean velocity [m/s]: 0 on a belt, the speed of the pull; of several bodies that of their centre of mass."""
        x = self.run.with_axes.at(np.array([0.0, self.duration]))["x"]
        first, last = way_of_machine(self.model, x)
        return float((last - first) / self.duration)

    @cached_property
    def motion(self) -> Oscillation:
        """What `ss.motion` returns of a run that ends on the cycle."""
        return oscillation_of_cycle(self.run, self.period, self.residual)

    @property
    def amplitude(self) -> float:
        """Half of the way from the lowest to the highest position, of the only body or the largest, less the mean motion [m]."""
        return self.motion.amplitude

    def _begins(self, pattern: str) -> int:
        return "0+-".index(pattern[0])

    @property
    def pattern(self) -> str:
        """The same of the first contact."""
        return next(iter(self.patterns.values()))

    @property
    def type(self) -> str:
        """Kind of cycle: "stick-slip", "slip", "reversing" or "oscillation", see `stickslip.analysis.oscillation.kind_of_cycle`."""
        return kind_of_cycle(list(self.patterns.values()), machine_of(self.model).has_inner_states)

    def _facts(self) -> dict[str, Any]:
        stability = f"{self.stability}; {self._multipliers_text}"
        return {"type": self.type, "duration": f"{self.duration:.9g} s", "stability": stability}

    def __repr__(self) -> str:
        stability = f"{self.stability} ({self._multipliers_text})"
        return f"<LimitCycle: {self.duration:.10g} s, type {self.type}, {stability}, residual {self.residual:.1e}>"


@interruptible
def limit_cycle(
    model: Model, period: int | None = None, guess: Any = None, *, section: Any = None, rtol: float = 1e-12, tolerance: float = 1e-12
) -> LimitCycle:
    """A limit cycle of a mechanism without a drive, stable or unstable, by Newton's method for its state and its duration.

    Parameters
    ----------
    model : mechanism or machine
        One without a period, such as `BlockOnBelt`, `PulledMass`, or a `Joint` with a controller that hunts about a constant target.
    period : int, optional
        Turns of the spring, or returns to the section, after which the motion repeats; as many as the run shows if not given. A cycle that
        repeats after fewer is given with its own number, and a note.
    guess : dict, Trajectory or LimitCycle, optional
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

    def problem(memory: Array) -> Any:
        return lambda U: section.misses(model, at, U, memory, rtol, unit)

    def after(u: Array, memory: Array) -> Array:
        return section.ends(model, at, u[None, :], memory, rtol, unit)[0, at.smooth :]

    def slopes(memory: Array) -> Any:
        return lambda u: section.slopes(model, at, u, memory, rtol, unit)

    exact = slopes if machine_of(model).has_inner_states and not not_followed(model) else None  # differences smooth what turns sharply
    begun = section.unknowns(at, state, duration, unit)
    root = newton_within(problem, after, begun, state[at.smooth :], exact, tolerance=tolerance, reach=0.5)
    if not root.good:
        raise SolveError(
            f"Newton's method found no cycle of {period} turns: {root.why} (residual {root.residual:.1e} after {root.iterations} "
            "iterations); give guess=ss.solve(mechanism, duration=...) of a run that has settled, or a cycle nearby"
        )
    state = section.states(model, at, root.at[None, :], root.memory)[0]
    cycle = LimitCycle(model, period, state, float(root.at[-1] * unit), root.residual, rtol, section=section)
    if np.max(np.ptp(cycle.run.v, axis=0)) <= _STEADY * at.speed:
        raise SolveError(
            "Newton's method went to steady sliding, which repeats after any time; give a guess nearer to the cycle, such as a start "
            "that rides along with the spring pulled far (guess=dict(x=..., v=...))"
        )
    return _once(cycle, rtol, tolerance)


def _once(cycle: LimitCycle, rtol: float, tolerance: float) -> LimitCycle:
    """The cycle, traversed once: one that repeats earlier than was asked is the shorter one, which says so."""
    model, at, unit, section, asked = cycle.model, coordinates(cycle.model), clock(cycle.model), cycle.section, cycle.period
    memory = cycle.state[at.smooth :]
    for turns in (k for k in range(1, asked) if asked % k == 0):
        duration = cycle.duration * turns / asked
        U = section.unknowns(at, cycle.state, duration, unit)[None, :]
        if float(np.max(abs(section.misses(model, at, U, memory, rtol, unit)))) < _EARLIER:
            shorter = limit_cycle(model, turns, replace(cycle, period=turns, duration=duration), rtol=rtol, tolerance=tolerance)
            return replace(shorter, notes=(f"it repeats after {turns} of the {asked} turns that were asked for", *shorter.notes))
    return cycle


@singledispatch
def at_its_switch(cycle: Any, name: str, period: int | None = None) -> Any:
    """A cycle as it begins where a contact sticks, or slips; its period is how often that happens.

    Raises
    ------
    SolveError
        Where it does not happen, and where the cycle does not repeat after the period that is asked for.
    """
    from stickslip.solvers import solve

    usual = replace(cycle, state=cycle.section_state, on_section=None)
    run = solve(cycle.model, duration=2 * cycle.duration, start=usual.start, keep="trajectory")
    t = switches_in(run, name)
    if not len(t):
        raise SolveError(f"the cycle has no {name!r}; its contacts have the patterns {cycle.patterns}; give another section")
    turns = int(np.sum(t <= t[0] + (1.0 - _EARLIER) * cycle.duration))
    notes = cycle.notes
    if period is not None and period % turns:
        raise SolveError(f"the cycle repeats after {turns} times {name!r}, and {period} were asked for; leave the period and turns out")
    if period is not None and period > turns:
        notes = (f"it repeats after {turns} of the {period} turns that were asked for", *notes)
    return replace(usual, state=states_of_returns(run, t[:1])[0], period=turns, on_section=usual.state, notes=notes)


def clock(model: Model) -> float:
    """The time in which durations are measured [s]."""
    return largest_size(machine_of(model).time_scale)


# ---- guesses ----
def _guessed(model: Model, period: int | None, guess: Any, asked: Asked) -> tuple[Array, float, Section, int]:
    """A state on the section, how long it takes to come back, and after how many turns."""
    if isinstance(guess, LimitCycle) and (asked.name is not None or guess.on_section is not None):
        return _cut_elsewhere(guess, period, asked)
    if isinstance(guess, LimitCycle):
        return guess.state, guess.duration, guess.section, guess.period if period is None else period
    if machine_of(model).time_scale is None:
        raise InputError(type(model).__name__, ["it has neither a period nor a time_scale, so the time to search for a cycle is not known"])
    if hasattr(guess, "pieces"):
        return _last_turn(guess, period, asked)
    if isinstance(guess, (list, np.ndarray)) and np.shape(guess) == (len(coordinates(model).names),):
        guess = coordinates(model).start(np.asarray(guess, float))
    if guess is not None and not isinstance(guess, dict):
        mistake = f"guess = {guess!r}; allowed is a start, a run or a cycle; type guess=dict(x=0.5), or leave it out"
        raise InputError("periodic_orbit", [mistake])
    return _last_turn(_settled(model, guess, asked), period, asked)


def _cut_elsewhere(cycle: LimitCycle, period: int | None, asked: Asked) -> tuple[Array, float, Section, int]:
    """A cycle as it begins on another section: twice around it passes that twice as often."""
    from stickslip.solvers import solve

    run = solve(cycle.model, duration=2 * cycle.duration, start=cycle.start, keep="trajectory")
    cut = cut_of(run, asked)
    t = passages(run, cut)
    t = t[t >= 0.5 * cycle.duration]
    if not len(t):
        raise SolveError(f"the cycle that is given does not pass {cut}; give another section, such as section={asked.name!r}")
    turns = max(1, int(np.sum(t <= t[0] + (1.0 - _EARLIER) * cycle.duration)))
    state = states_of_returns(run, t[:1])[0]
    return state, cycle.duration * (period or turns) / turns, section_of(cycle.model, cut), period or turns


def _settled(model: Model, start: Any, asked: Asked) -> Any:
    """A run from a start that is long enough; that of a machine with slow states goes on until it repeats, or has taken long."""
    from stickslip.solvers import solve

    options: dict[str, Any] = {"rtol": 1e-8} if machine_of(model).has_inner_states else {}
    for longer in _LONGER if machine_of(model).turning_velocity is None else (1,):
        run = solve(model, duration=longer * _SETTLING * clock(model), start=start, samples=longer * _SAMPLES, **options)
        t = passages(run, cut_of(run, asked))
        if len(t) > 2 and coordinates(model).distance(*states_of_returns(run, t[-2:])) < _REPEATS:
            break
    return run


def _last_turn(run: Trajectory, period: int | None, asked: Asked) -> tuple[Array, float, Section, int]:
    """The last state of a run on the section, and how long its last turns took."""
    cut = cut_of(run, asked)
    t = passages(run, cut)
    speed = coordinates(run.model).speed
    if period is None:
        period = turns_shown(coordinates(run.model), states_of_returns(run, t[-_MOST:])) if len(t) > 2 else 1
    steady = len(t) < 2 or float(np.max(np.ptp(run.with_axes.at(np.linspace(t[-2], t[-1], 64))["v"], axis=0))) <= _STEADY * speed
    if steady or len(t) < period + 2:
        end = "it rests, or slides on steadily" if steady else f"only {len(t)} oscillations were found"
        raise SolveError(
            f"no cycle was found in {float(run.pieces.t[-1]):.6g} s: {end}; give another start (guess=dict(x=..., v=...)), or a longer run "
            "(guess=ss.solve(mechanism, duration=...))"
        )
    return states_of_returns(run, t[-1:])[0], float(t[-1] - t[-1 - period]), section_of(run.model, cut), period
