"""Sensitivities of a motion to the numbers of a machine: exact derivatives of mean velocity and state, through every switch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from stickslip.basics.arguments import described_as, explains_arguments
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, did_you_mean
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.notebook_display import Drawn
from stickslip.basics.number_names import numbers_meant, unequal_sides
from stickslip.dynamics.derivatives.slopes import number_slopes, period_of, start_changes
from stickslip.dynamics.derivatives.tangents import Changes, Directions, changes_along, not_followed
from stickslip.dynamics.periodic.closed_orbits import PeriodicOrbit
from stickslip.dynamics.periodic.given_states import states_of
from stickslip.dynamics.periodic.periodic_orbits import periodic_orbit
from stickslip.dynamics.periodic.steady_motions import ClosedMotions, Closing
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates
from stickslip.engine.trace import SPAN, numbers_of
from stickslip.models.angular_coordinates import unit_of_part
from stickslip.models.drives.within import drives_within
from stickslip.models.machine_adapter import is_machine
from stickslip.results.trajectory import Trajectory
from stickslip.solvers.time_dependence import check_period

_ALONE = "if it alone changes, the equations do not repeat after the period"
_WHOLE = 1e-9  # by how much of themselves the numbers of periods of its drives may change
_TOLERANCE = 1e-10  # of runs under laws with inner states: derivatives lose digits that the run itself keeps
_ASIDE = 1e-3  # how far a number is moved to see whether the equations still come back after the period


@described_as("what ss.dynamics.sensitivity returns; type ss.dynamics.sensitivity(robot)")
@sealed
class Sensitivity(Drawn):
    """Derivatives of a motion with respect to numbers of its machine.

    Parameters
    ----------
    names : tuple of str
        The numbers, or patterns of names that vary together.
    values : array (numbers,)
        The numbers themselves; NaN where several of different size vary together.
    velocity : float
        Mean velocity V [m/s], for several bodies that of their centre of mass.
    mean_velocity : array (numbers,)
        dV/dp.
    state : array
        Derivative of the final state, for a periodic motion of the strobe state. It is taken at a fixed fraction of the period.
    states : tuple of str
        Names of these states.
    unit : str
        Of the velocity.
    notes : tuple of str
        Remarks.

    Examples
    --------
    >>> import stickslip as ss
    >>> found = ss.dynamics.sensitivity(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb"), wrt=["drive.amplitude"])
    >>> round(found["drive.amplitude"], 6)  # dV/dA: V is 4.3 mm/s at A = .8 mm
    8.895394
    """

    names: tuple[str, ...]
    values: Array
    velocity: float
    mean_velocity: Array
    state: Array
    states: tuple[str, ...]
    notes: tuple[str, ...] = ()
    unit: str = "m/s"

    _drawn_by, _inches = "sensitivity", (4.4, 2.8)

    def __getitem__(self, name: str) -> float:
        """dV/dp by the name of p."""
        if name not in self.names:
            raise InputError("sensitivity", [f"{name!r} was not asked for; {did_you_mean(name, self.names)}"])
        return float(self.mean_velocity[self.names.index(name)])

    @property
    def relative(self) -> Array:
        """Percentage change of V for a change of a number by one per cent: (p/V) dV/dp."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.values / self.velocity * self.mean_velocity

    def _title(self) -> str:
        return f"Sensitivity of the mean velocity, {self.velocity:.9g} {self.unit}"

    def _tables(self) -> list[list[tuple[str, ...]]]:
        head = ("number p", "value", "dV/dp [SI]", "% of V for 1 % of p")
        rows = zip(self.names, self.values, self.mean_velocity, self.relative, strict=True)
        return [[head, *((name, f"{p:.6g}", f"{slope:.7g}", f"{relative:.4g}") for name, p, slope, relative in rows)]]

    def __repr__(self) -> str:
        listed = ", ".join(f"{name}: {value:.9g}" for name, value in zip(self.names, self.mean_velocity, strict=True))
        return f"<Sensitivity of V = {self.velocity:.9g} {self.unit}: dV/dp by {listed}{''.join(f'; {note}' for note in self.notes)}>"


@explains_arguments
def sensitivity(of: Any, wrt: str | Sequence[str] | None = None) -> Sensitivity:
    """Derivatives of the mean velocity and of the state with respect to numbers of a machine.

    They are exact: the variational equations are integrated along the motion through every switch, impulse and stop, and for a periodic
    motion closed with its monodromy matrix. No finite differences are used.

    Parameters
    ----------
    of : Robot or machine, PeriodicOrbit, or Trajectory
        For a machine, the derivatives are those of its periodic motion (`periodic_orbit`). For a run, they are those of the mean
        velocity after `settle` and of the final state, from the same initial state. Under laws with inner states they are held to a
        tolerance of 1e-10, or that of the run if it is smaller.
    wrt : str or sequence of str, optional
        Names of numbers as in ``robot.replace``, such as "drive.amplitude" or "modules[1].drive.amplitude"; without an index the numbers of
        all parts vary together, by the same amount: "modules.friction.mu_plus". ``*`` matches anything. If not given: every number
        separately, if its change leaves the common period unchanged.

    Returns
    -------
    Sensitivity
        `mean_velocity`, `state`, `relative`, and ``found[name]``.

    Raises
    ------
    InputError
        For an unknown name, a number whose change would leave the machine without a common period (vary those of all parts together), or a
        law that the engine cannot compile.

    Examples
    --------
    >>> import stickslip as ss
    >>> module = ss.Robot(0.06259, 0.00948, ss.Harmonic(amplitude=6e-4, omega=65.4 * np.pi), ss.Coulomb(0.15, 0.21))
    >>> pair = ss.Chain((module, module), link=ss.Spring(1200.0, 0.4), phases=(0.0, 2.0))
    >>> found = ss.dynamics.sensitivity(pair, wrt=["phases.1", "modules.*.friction.mu_plus"])
    >>> found.mean_velocity.round(8).tolist()
    [0.00841115, -0.20550469]
    """
    model = of if is_machine(of) else getattr(of, "model", None)
    if model is None:
        raise InputError(
            "sensitivity", [f"{of!r} is neither a machine nor a periodic orbit nor a run; type ss.dynamics.sensitivity(robot)"]
        )
    if why := not_followed(model):
        raise InputError("sensitivity", [f"perturbations are not propagated along the motion of this {type(model).__name__}, as {why}; "
                                         "take differences of two runs"])  # fmt: skip
    if model.period is None and not isinstance(of, Trajectory):
        why = f"{type(model).__name__} has no period, and how long its cycle takes changes with its numbers; allowed is a run of it"
        raise InputError("sensitivity", [f"{why}; type ss.dynamics.sensitivity(ss.solve(machine, duration=10.0)) for its mean velocity and "
                                         "its end, or ss.continuation(machine, parameter=...) for how its cycle changes"])  # fmt: skip
    moved = directions_of("sensitivity", model, wrt)
    if isinstance(of, Trajectory):
        return _of_run(of, moved)
    return _of_orbit(of if isinstance(of, PeriodicOrbit) else periodic_orbit(model), moved)


def directions_of(what: str, model: Model, wrt: Any) -> dict[str, tuple[str, ...]]:
    """The numbers of one machine that are moved together, by what was typed; `InputError` of `what` for what cannot be moved."""
    if any(np.ndim(value) for _, value in leaves(model)):
        raise InputError(what, ["the robot is a batch (some of its numbers are arrays); allowed is one robot"])
    known = [name for name in numbers_of(model) if name != SPAN]
    if wrt is None:
        return {name: (name,) for name in known if not _breaks(model, (name,))}
    asked = [wrt] if isinstance(wrt, str) else list(wrt)
    directions = {str(pattern): numbers_meant(pattern, known) for pattern in asked}
    own = dict(leaves(model))
    if unequal := [why for pattern, names in directions.items() if (why := unequal_sides(pattern, names, own))]:
        raise InputError(what, unequal)
    if directions and all(directions.values()) and not _any_breaks(model, list(directions.values())):
        return directions
    problems = [flaw for pattern, names in directions.items() if (flaw := _flaw(model, pattern, names, known))]
    if problems or not asked:
        raise InputError(what, problems or [f"wrt is empty; allowed are names of numbers: {', '.join(known)}"])
    return directions


def _flaw(model: Model, pattern: Any, names: tuple[str, ...], known: list[str]) -> str:
    if not names:
        return f"{pattern!r} is not a number of {type(model).__name__}; {did_you_mean(str(pattern), known)}"
    places = names[0].split(".")
    last = ".".join(places[-2:] if places[-1].isdigit() else places[-1:])
    return f"{pattern}: {_ALONE}; vary those of all parts together, such as '*.{last}'" if _breaks(model, names) else ""


def _any_breaks(model: Model, moved: list[tuple[str, ...]]) -> bool:
    """Whether one of these sets of numbers may leave the machine without a common period: asked of a batch that has a case for each."""
    own = dict(leaves(model))
    aside = {name: np.full(len(moved), own[name]) for names in moved for name in names}
    for i, names in enumerate(moved):
        for name in names:
            aside[name][i] += _ASIDE * (abs(own[name]) or 1.0)
    return not _has_period(replace_leaf(model, aside), model)


def _breaks(model: Model, names: tuple[str, ...]) -> bool:
    """Whether the machine has no common period any more, once these numbers are moved."""
    own = dict(leaves(model))
    for side in (1.0, -1.0):
        try:
            aside = replace_leaf(model, {name: own[name] + side * _ASIDE * (abs(own[name]) or 1.0) for name in names})
        except InputError:  # at the end of its range
            continue
        return not _has_period(aside, model)
    return False


def _has_period(aside: Any, model: Model) -> bool:
    """Whether the equations of a machine come back after its period as they did before its numbers were moved."""
    try:
        check_period(aside)
    except InputError:
        return False
    return all(np.all(abs(now / was - 1.0) < _WHOLE) for now, was in zip(_cycles(aside), _cycles(model), strict=True))


def _cycles(model: Model) -> list[Any]:
    """How many periods of each drive there are in that of the machine: accelerations that jump or are zero do not show it."""
    return [] if model.period is None else [model.period / drive.period for drive in drives_within(model)]


def direction_parts(moved: dict[str, tuple[str, ...]]) -> dict[str, Array]:
    """Parts of the directions in the numbers."""
    names = dict.fromkeys(name for names in moved.values() for name in names)
    return {name: np.array([float(name in names) for names in moved.values()]) for name in names}


def _values(model: Model, moved: dict[str, tuple[str, ...]]) -> Array:
    own = dict(leaves(model))
    sizes = [{float(own[name]) for name in names} for names in moved.values()]
    return np.array([next(iter(size)) if len(size) == 1 else np.nan for size in sizes])


def _period_slopes(model: Model, numbers: dict[str, Array], count: int) -> Array:
    """Change of the period along each direction [s]."""
    if model.period is None:
        return np.zeros(count)
    return number_slopes(model, numbers, period_of, count)[0]


def _of_orbit(orbit: PeriodicOrbit, moved: dict[str, tuple[str, ...]]) -> Sensitivity:
    V, slopes, state, notes = along_direction(orbit, direction_parts(moved), len(moved))
    unit = unit_of_part("v", orbit.model, "")
    states = coordinates(orbit.model).names[: state.shape[1]]
    return Sensitivity(tuple(moved), _values(orbit.model, moved), V, slopes, state, states, notes, unit)


def along_direction(orbit: PeriodicOrbit, directions: dict[str, Array], count: int) -> tuple[float, Array, Array, tuple[str, ...]]:
    """Mean velocity of a periodic motion, its derivative and that of the strobe state along directions in the numbers, and notes.

    The motion stays periodic: what a number changes and what the start does about it cancel.

    Parameters
    ----------
    orbit : PeriodicOrbit
    directions : dict of arrays (count,)
        Parts of the directions in the numbers, by name.
    count : int
        How many directions there are.
    """
    closed = Closing(orbit.model, coordinates(orbit.model), directions, count, orbit.rtol).at_state(orbit.state[None], orbit.period)
    return float(closed.mean_velocity[0]), closed.slopes[0], closed.changes[0], derivative_notes(closed)


def derivative_notes(closed: ClosedMotions) -> tuple[str, ...]:
    """Notes on the derivatives of a motion."""
    if not np.isfinite(closed.monodromy).all():
        return ("a switch is touched without being crossed: there are no derivatives",)
    note = "the motion can be shifted freely (a multiplier is 1), and the smallest change of the state is given"
    return (note,) if closed.free[0] else ()


def _of_run(run: Trajectory, moved: dict[str, tuple[str, ...]]) -> Sensitivity:
    """From the same start."""
    model, at, k = run.model, coordinates(run.model), len(moved)
    d, numbers = at.smooth, direction_parts(moved)
    end = float(run.pieces.t[-1])
    span = None if model.period is not None else end
    if span is None and abs(end - run.periods * float(model.period)) > 1e-9 * end:
        raise InputError("sensitivity", [f"the run ends at {end:.6g} s, within a drive period; allowed are whole periods; type periods="])
    starts = start_changes(model, run.start, numbers, k)
    states = np.tile(states_of(run.start or None, model)[0], (k, 1))

    def after(periods: int) -> Changes:
        return changes_along(model, states, starts, periods, Directions(numbers, min(run.rtol, _TOLERANCE), span))

    last, settle = after(run.periods), 0 if span else run.settle
    way, d_way = last.way, last.way_change
    if settle:
        first = after(settle)
        way, d_way = way - first.way, d_way - first.way_change
    T = span or float(model.period) * (run.periods - settle)
    names = " and ".join(run._columns.thrown_together)
    notes = (f"{names} land at one instant and are thrown up, and runs beside jump: no derivative leads through that hit",) if names else ()
    dT = _period_slopes(model, numbers, k) * (run.periods - settle)
    V = float(way[0]) / T
    return Sensitivity(
        tuple(moved), _values(model, moved), V, (d_way - V * dT) / T, last.change, at.names[:d], notes, unit=unit_of_part("v", model, "")
    )
