"""Limit cycles of autonomous mechanisms: a block on a belt, a mass on a pulled spring. The period is an unknown.

The section is a turning point of the spring: the body moves as fast as its far end (a belt's spring: not at all), and slows down.
That is in the middle of a slide, where the motion is smooth. A cycle is a state on it and a duration after which the state comes
back, measured from the spring's far end.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.dynamics.derivatives.tangents import jacobian_of
from stickslip.dynamics.periodic.closed_orbits import ClosedMotion, largest_first, multipliers_of
from stickslip.dynamics.periodic.newton import newton_within
from stickslip.dynamics.stroboscopic.sections import halved
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates, flow_map
from stickslip.dynamics.stroboscopic.strobe_states import needs_one_body
from stickslip.errors import InputError, SolveError
from stickslip.friction.law_adapter import law_of
from stickslip.layout import of_one_contact
from stickslip.machine_adapter import machine_of
from stickslip.sealing import sealed

__all__ = ["LimitCycle", "clock", "ends_of", "limit_cycle", "misses_of", "states_on", "unknowns"]

Array = Any
_RUNS = 1e-10  # of the run around a cycle
_SETTLING = 60  # periods of the free oscillation that a guess is run for
_STEADY = 1e-6  # of the velocity scale: what changes its velocity by less slides steadily
_SAMPLES = 1200  # looks at a run of that length, times ten


@sealed
@dataclass(frozen=True, eq=False)
class LimitCycle(ClosedMotion):
    """A limit cycle: its turning points, period and multipliers.

    Parameters
    ----------
    model : mechanism
        What moves.
    period : int
        Turns of the spring until the motion repeats.
    state : array
        The state at a turning point of the spring, in the order of `names`; x is measured from the spring's far end.
    duration : float
        How long the cycle takes [s].
    residual : float
        How far the state is from itself after it, in the scales of its coordinates.
    rtol : float
        Tolerance of the runs that it was computed with.

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

    @property
    def period_time(self) -> float:
        """How long the cycle takes [s]."""
        return self.duration

    @cached_property
    def run(self) -> Any:
        """One period of the orbit, with its dense output."""
        from stickslip.solvers import solve

        options: dict[str, Any] = {"rtol": max(self.rtol, _RUNS)} if law_of(self.model).dynamic else {}
        return solve(self.model, duration=self.duration, start=self.start, keep="trajectory", **options)

    @cached_property
    def monodromy(self) -> Array:
        """The derivative of the state after the cycle by the state before it."""
        return jacobian_of(self.model, self.state, 1, self.rtol, span=self.duration)

    @cached_property
    def multipliers(self) -> Array:
        """Floquet multipliers, the largest first; the 1 along the cycle is left out."""
        return multipliers_of(self.monodromy, "0" in self.pattern, autonomous=True)

    @cached_property
    def differences(self) -> Array:
        """The multipliers once more, from differences of the flow: the second opinion."""
        at, step = coordinates(self.model), 1e-6
        d, size = at.smooth, step * at.scales
        shifts = np.vstack([np.eye(d, len(size)), -np.eye(d, len(size))]) * size
        ends = flow_map(self.model, self.state + shifts, self.duration, self.rtol).state[:, :d]
        found = np.linalg.eigvals(((ends[:d] - ends[d:]) / (2 * size[:d, None])).T)
        found = np.delete(found, int(np.argmin(abs(found - 1.0))))
        return largest_first(found)

    @cached_property
    def mean_velocity(self) -> float:
        """Mean velocity [m/s]: 0 on a belt, the speed of the pull."""
        x = self.run.at(np.array([0.0, self.duration]))["x"]
        return float((x[1] - x[0]) / self.duration)

    @cached_property
    def pattern(self) -> str:
        """Signs of the contact's velocity in order, rest as 0, beginning with rest if there is any."""
        mode = self.run._modes
        signs = [{1: "+", 0: "0", -1: "-"}[int(m)] for m in mode[np.append(True, np.diff(mode) != 0)]]
        signs = signs[:-1] if len(signs) > 1 and signs[0] == signs[-1] else signs
        first = signs.index("0") if "0" in signs else 0
        return "".join(signs[first:] + signs[:first])

    @property
    def type(self) -> str:
        """Kind of cycle: "stick-slip", "slip" or "reversing".

        Stick-slip: the contact rests, or, under a dynamic law, its velocity passes zero. Slip: it slides on one side. Reversing: on
        both, without rest.
        """
        if "0" in self.pattern:
            return "stick-slip"
        if len(self.pattern) == 1:
            return "slip"
        return "stick-slip" if law_of(self.model).dynamic else "reversing"

    def _facts(self) -> dict[str, Any]:
        stability = f"{self.stability}; {self._multipliers_told}"
        return {"type": self.type, "duration": f"{self.duration:.9g} s", "stability": stability}

    def __repr__(self) -> str:
        stability = f"{self.stability} ({self._multipliers_told})"
        return f"<LimitCycle: {self.duration:.10g} s, type {self.type}, {stability}, residual {self.residual:.1e}>"


def limit_cycle(model: Any, period: int = 1, guess: Any = None, *, rtol: float = 1e-12, tolerance: float = 1e-12) -> LimitCycle:
    """A limit cycle of a mechanism without a drive, stable or unstable, by Newton's method for its state and its duration.

    Parameters
    ----------
    model : mechanism
        One without a period, such as `BlockOnBelt` or `PulledMass`.
    period : int
        Turns of the spring after which the motion repeats.
    guess : dict, Trajectory or LimitCycle, optional
        A start that leads to it, a run that ends on it, or a cycle nearby; if not given, a run from rest.
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
    needs_one_body("periodic_orbit", model, "a limit cycle is found where one spring turns",
                   "type ss.solve(machine, duration=...) for a motion, or give the machine a period")  # fmt: skip
    state, duration = _guessed(model, period, guess, rtol)
    at, unit = coordinates(model), clock(model)

    def problem(memory: Array) -> Any:
        return lambda U: misses_of(model, at, U, memory, rtol, unit)

    def after(u: Array, memory: Array) -> Array:
        return ends_of(model, at, u[None, :], memory, rtol, unit)[0, at.smooth :]

    found = newton_within(problem, after, unknowns(at, state, duration, unit), state[at.smooth :], tolerance=tolerance, reach=0.5)
    if not found.good:
        raise SolveError(
            f"Newton's method found no cycle of {period} turns: {found.why} (residual {found.residual:.1e} after {found.iterations} "
            "iterations); give guess=ss.solve(mechanism, duration=...) of a run that has settled, or a cycle nearby"
        )
    state = states_on(model, at, found.at[None, :], found.memory)[0]
    cycle = LimitCycle(model, period, state, float(found.at[-1] * unit), found.residual, rtol)
    if np.ptp(cycle.run.v) <= _STEADY * float(at.scales[1]):
        raise SolveError(
            "Newton's method went to steady sliding, which repeats after any time; give a guess nearer to the cycle, such as a start "
            "that rides along with the spring pulled far (guess=dict(x=..., v=...))"
        )
    return cycle


def clock(model: Any) -> float:
    """The time in which durations are measured [s]."""
    return float(np.max(model.time_scale))


# ---- unknowns: the state without the velocity, and the duration ----
def unknowns(at: Coordinates, state: Array, duration: float, unit: float) -> Array:
    """A cycle as Newton's method looks for it: x and the inner states in their scales, and the duration."""
    return np.append(np.delete((state / at.scales)[: at.smooth], 1), duration / unit)


def states_on(model: Any, at: Coordinates, U: Array, memory: Array) -> Array:
    """States on the section, one row for each row of unknowns."""
    v = np.broadcast_to(np.asarray(_far_end(model), float), len(U))[:, None]
    inner = U[:, 1:-1] * at.scales[2 : at.smooth]
    return np.hstack([U[:, :1] * at.scales[0], v, inner, np.broadcast_to(memory, (len(U), len(memory)))])


def ends_of(model: Any, at: Coordinates, U: Array, memory: Array, rtol: float, unit: float) -> Array:
    """The states after the durations, seen from the spring's far end; no numbers where a duration is none."""
    T = U[:, -1] * unit
    good = np.isfinite(T) & (T > 0)
    ends = flow_map(model, states_on(model, at, U, memory), np.where(good, T, 1.0), rtol).state.copy()
    ends[:, 0] -= np.asarray(_far_end(model), float) * T
    return np.where(good[:, None], ends, np.nan)


def misses_of(model: Any, at: Coordinates, U: Array, memory: Array, rtol: float, unit: float) -> Array:
    """How far states are from themselves after their durations, in scales."""
    return ((ends_of(model, at, U, memory, rtol, unit) - states_on(model, at, U, memory)) / at.scales)[:, : at.smooth]


def _far_end(model: Any) -> Any:
    """Velocity of the spring's far end [m/s]."""
    return machine_of(model).far_end_velocity


# ---- guesses ----
def _guessed(model: Any, period: int, guess: Any, rtol: float) -> tuple[Array, float]:
    """A state on the section, and how long it takes to come back."""
    from stickslip.solvers import solve

    if isinstance(guess, LimitCycle):
        return guess.state, guess.duration
    if machine_of(model).time_scale is None:
        raise InputError(type(model).__name__, ["it has neither a period nor a time_scale, so the time to search for a cycle is not known"])
    run = guess
    if not hasattr(run, "pieces"):
        if guess is not None and not isinstance(guess, dict):
            raise InputError(
                "periodic_orbit", [f"guess = {guess!r}; allowed is a start, a run or a cycle; type guess=dict(x=0.5), or leave it out"]
            )
        options: dict[str, Any] = {"rtol": 1e-8} if law_of(model).dynamic else {}
        run = solve(model, duration=_SETTLING * clock(model), start=guess, samples=_SAMPLES, **options)
    run = of_one_contact("periodic_orbit", run, "a cycle is a state of one body")
    t = _turns(run)
    steady = len(t) < 2 or float(np.ptp(run.at(np.linspace(t[-2], t[-1], 64))["v"])) <= _STEADY * float(np.max(model.velocity_scale))
    if steady or len(t) < period + 2:
        end = "it rests, or slides on steadily" if steady else f"only {len(t)} oscillations of the spring were found"
        raise SolveError(
            f"no cycle was found in {float(run.pieces.t[-1]):.6g} s: {end}; give another start (guess=dict(x=..., v=...)), or a longer run "
            "(guess=ss.solve(mechanism, duration=...))"
        )
    last = run.at(t[-1:])
    z = np.asarray([] if last["z"] is None else last["z"], float).reshape(-1)
    piece = min(int(np.searchsorted(run.pieces.t, t[-1], side="right")) - 1, len(run.pieces.mode) - 1)
    memory = np.asarray(run.pieces.memory[piece], float)
    c = float(_far_end(model))
    return np.concatenate([[float(last["x"][0]) - c * t[-1], c], z, memory]), float(t[-1] - t[-1 - period])


def _turns(run: Any) -> Array:
    """The instants at which the spring is longest or shortest: the velocity falls to that of its far end."""
    c, t = float(_far_end(run.model)), np.unique(run.t)
    above = run.at(t)["v"] - c
    size = 1e-9 * max(float(abs(above).max()), 1e-300)
    where = np.flatnonzero((above[:-1] > 0) & (above[1:] <= 0) & (np.maximum(abs(above[:-1]), abs(above[1:])) > size))
    return halved(run, "v", c, t[where], t[where + 1], -np.ones(len(where)))
