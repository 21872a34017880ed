"""Derivatives of a machine's results by its numbers: exact for the mean velocity, differences for other results."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from stickslip.basics.arguments import Model, explains_arguments
from stickslip.basics.batch import labels_of, spread_over_cases
from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError, SolveError, did_you_mean
from stickslip.basics.interruption import interruptible
from stickslip.dynamics.derivatives.sensitivity import derivative_notes, direction_parts, directions_of
from stickslip.dynamics.derivatives.tangents import has_corners_of, not_followed
from stickslip.dynamics.periodic.closed_orbits import RTOL, PeriodicOrbit
from stickslip.dynamics.periodic.periodic_orbits import periodic_orbit
from stickslip.dynamics.periodic.steady_motions import ClosedMotions, Closing, motions_from_rest
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates, spread_over, state_at_rest, strobe_map
from stickslip.inverse.optimisation.exact_derivatives import OWN, STATE, Exact, exactly
from stickslip.inverse.optimisation.extremes import Looked, extreme_of
from stickslip.inverse.optimisation.perturbed_machines import moves_of, sides_of, sizes_of, words_of
from stickslip.inverse.optimisation.results import PERIODS, check_quantity, moved_by, results_of
from stickslip.models.machine_adapter import machine_of
from stickslip.models.observables import Observable

_BESIDE = 1e-6  # of a number: how far to either side of it the sequence of modes has to stay what it is
_STEPS = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5)  # of a number: the longer of two steps of the differences
AGREE = 1e-4  # of the free velocity: two motions whose mean velocities are nearer are one
_JUMP = 1e-3  # of the free velocity, one such step beside a number: what changes by more does so at once
_KINK, _NOISE = 0.01, 1e-10  # slopes to both sides that differ by more, of themselves and of the free velocity, are two slopes
_RTOL_BESIDE = 1e-11  # of runs under dynamic laws whose differences are taken: with 1e-10 slopes near rest missed 1e-5
RTOL_OF_SLOPES = 1e-9  # of runs under dynamic laws: derivatives are known to some thousand times that
MULTIPLIER = "multiplier"  # the name of the largest of a motion


class Gradient(dict[str, float]):
    """Derivatives by name, with the value of the differentiated quantity and remarks.

    Parameters
    ----------
    slopes : dict of float
        The derivatives.
    of : str
        The differentiated quantity.
    value : float
        Its value.
    notes : sequence of str
        Which derivatives hold on one side only, and where they were found by differences.

    Examples
    --------
    >>> found = Gradient({"drive.amplitude": 8.9}, "mean_velocity", 4.3e-3)
    >>> found["drive.amplitude"], found.value, found.notes
    (8.9, 0.0043, ())
    """

    def __init__(self, slopes: dict[str, float], of: str, value: float, notes: Sequence[str] = ()):
        super().__init__(slopes)
        self.of, self.value, self.notes = of, value, tuple(notes)

    def __repr__(self) -> str:
        listed = ", ".join(f"{name}: {value:.9g}" for name, value in self.items())
        return f"<Gradient of {self.of} = {self.value:.9g} by {listed}{''.join(f'; {note}' for note in self.notes)}>"


@explains_arguments
@interruptible
def gradient(
    model: Model, of: str | Observable = "mean_velocity", wrt: str | Sequence[str] | None = None, rtol: float = RTOL_OF_SLOPES
) -> Gradient:
    """Derivatives of a result of the steady motion with respect to numbers of the machine.

    The motion is the one that the machine reaches from rest. Derivatives are exact, from the tangent equations through every switch (see
    `sensitivity`); a note names those that are extrapolated differences.

    Parameters
    ----------
    model : Robot or machine
        With a period, and with a deterministic law.
    of : str or Observable
        "mean_velocity", "drive_power", "cost_of_transport", "friction_power", an extreme ("velocity_max", "velocity_min", "slip_max",
        "slip_min", "stop_force_max"), the state on the strobe ("state.v"), or the mean, the integral or an extreme of an observable of your
        own. For a machine of several parts, append the number: "velocity_max.0". For any other column of a sweep, for "multiplier" (the
        largest one) and under laws that creep (`RateState`), derivatives are differences.
    wrt : str or sequence of str, optional
        Names as in ``robot.replace``: "drive.amplitude", "friction.mu_plus", "track.tilt"; of a machine of several parts
        "modules[1].drive.amplitude", "phases[1]", "link.stiffness"; without an index the numbers of all parts vary together. If not given,
        every number separately.
    rtol : float
        Tolerance of the runs under laws with inner states, 1e-6 to 1e-12. With 1e-9 derivatives of V are good to 1e-5 of how much V
        changes; to 3e-5 for the steepest friction that was tested, a `TanhCoulomb` whose width is a thousandth of V.

    Returns
    -------
    Gradient
        A dict by the names as they were given, with `value` and `notes`. If the sequence of modes changes next to a value, the
        derivative is one-sided, and a note names the side.

    Raises
    ------
    InputError
        For unknown names, and for machines without a period.
    SolveError
        Where the motion does not repeat.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    >>> slopes = ss.optimisation.gradient(robot, "mean_velocity", wrt=["drive.amplitude", "friction.mu_plus"])
    >>> round(slopes["drive.amplitude"], 6), round(slopes["friction.mu_plus"], 6)
    (8.895394, -0.089796)
    """
    if isinstance(rtol, bool) or not isinstance(rtol, int | float) or not 1e-12 <= rtol <= 1e-6:
        raise InputError("gradient", [f"rtol = {rtol!r}; allowed is 1e-12 to 1e-6; type rtol={RTOL_OF_SLOPES:g}"])
    check_of("gradient", of, model)
    moved = directions_of("gradient", model, wrt)
    if model.period is None:
        raise InputError("gradient", [f"{type(model).__name__} has no period; allowed are machines with a drive, such as a Robot"])
    if not_followed(model):
        return _by_differences(_orbit_of_runs(model), of, moved)
    at, seeds = coordinates(model), direction_parts(moved)
    exact = exactly(of, model, at, seeds, len(moved))
    motion, orbit, stepped = steady_motion(model, moved, at, exact, rtol)
    one_sided = _one_sided(motion, orbit, moved, at, stepped)
    value, slopes = (each[0] for each in exact.of(motion)) if exact else _extremes(of, orbit, at, seeds, motion)
    if exact is None and np.isnan(slopes).any():
        return _by_differences(orbit, of, moved, one_sided)
    result = Gradient(dict(zip(moved, map(float, slopes), strict=True)), named(of), float(value), [*derivative_notes(motion), *one_sided])
    unknown = {name: moved[name] for name, slope in result.items() if np.isnan(slope)}
    return _with_differences(result, orbit, of, unknown) if unknown and np.isfinite(motion.monodromy).all() else result


def _extremes(of: Any, orbit: PeriodicOrbit, at: Coordinates, seeds: dict[str, Array], motion: ClosedMotions) -> tuple[Any, Any]:
    """The derivatives of an extreme; NaN where it is none, or they are not known."""
    extreme = None if of == MULTIPLIER else extreme_of(of, orbit.model)
    if extreme is None or not np.isfinite(motion.changes).all():
        return np.nan, np.full(motion.changes.shape[1], np.nan)
    return Looked(extreme, orbit, at, seeds, motion.changes[0]).derivatives()


def steady_motion(
    model: Model, moved: dict[str, tuple[str, ...]], at: Coordinates, exact: Exact | None = None, rtol: float = RTOL_OF_SLOPES
) -> tuple[ClosedMotions, PeriodicOrbit, bool]:
    """The periodic motion that a machine settles on from rest, with its derivatives along what is moved; whether it is made of steps."""
    steady = motions_from_rest(model, at, periods=PERIODS)
    period, V, state = _repeating(int(steady.period[0])), float(steady.mean_velocity[0]), steady.state[0]
    means, observe = (0, ()) if exact is None else (exact.means, exact.observe)
    along = Closing(model, at, direction_parts(moved), len(moved), rtol, means=means, observe=observe)
    motion = along.near(state[None], period)
    if not along.is_good(motion)[0] or at.memories:
        orbit = periodic_orbit(model, period, guess=state)
        motion = along.at_state(orbit.state[None], period)
    _check_same(model, V, float(motion.mean_velocity[0]))
    return motion, PeriodicOrbit(model, period, motion.nearer[0], float(motion.missed[0]), rtol), steady.stepped


def check_of(what: str, of: Any, model: Model) -> None:
    """`InputError` of `what` for what is not a number of a steady motion."""
    if isinstance(of, Observable) or of == MULTIPLIER:
        return
    if of == "friction_power" and "contact" in machine_of(model).own:
        return  # it is followed along the motion, though sweeps over a robot have no such column
    if not isinstance(of, str) or not of.startswith(STATE):
        check_quantity(what, "of", of, model)
        return
    at = coordinates(model)
    known = [STATE + name for name in at.names[: at.smooth]]
    if of not in known:
        raise InputError(what, [f"of = {of!r} is not a state on the strobe; {did_you_mean(of, known)}"])


def named(of: Any) -> str:
    """The name of a quantity."""
    return f"the {of.meaning}" if isinstance(of, Observable) else str(of)


def _with_differences(followed: Gradient, orbit: PeriodicOrbit, of: Any, unknown: dict[str, tuple[str, ...]]) -> Gradient:
    """Derivatives of which some are not followed along the motion, and are differences where the quantity is a column of sweeps."""
    reason = f"{', '.join(unknown)}: what the number does to an instant at which a law forgets is not followed"
    try:
        more = _by_differences(orbit, of, unknown)
    except InputError:
        return Gradient(followed, followed.of, followed.value, [*followed.notes, f"{reason}: there is no derivative"])
    return Gradient({**followed, **more}, followed.of, followed.value, [*followed.notes, f"{reason}: by differences", *more.notes[1:]])


def _orbit_of_runs(model: Any) -> PeriodicOrbit:
    """The same under laws that are written for plain numbers only, by runs alone."""
    results = results_of(spread_over(model, 1), 1)
    period = _repeating(int(results.get("period", [0])[0]))
    orbit = periodic_orbit(model, period, guess=strobe_map(model, state_at_rest(model), int(results["periods_run"][0]), RTOL).state[0])
    _check_same(model, float(results["mean_velocity"][0]), orbit.mean_velocity)
    return orbit


def _repeating(period: int) -> int:
    """The period of a motion, if it has one."""
    if period > 0:
        return period
    raise SolveError(
        f"gradient: the motion does not repeat within {PERIODS} drive periods, so that nothing has a derivative; type "
        "ss.dynamics.sensitivity(run) for that of a run from its start, or take other numbers"
    )


def _check_same(model: Model, settled: float, V: float) -> None:
    """Whether the periodic motion is the one on which the machine has settled, by its mean velocity."""
    if not abs(V - settled) <= AGREE * float(machine_of(model).free_velocity or 1.0):
        raise SolveError(f"gradient: from rest V is {settled:.9g} m/s, and the periodic motion found there has {V:.9g} m/s")


def _neighbours(
    orbit: PeriodicOrbit, moved: dict[str, tuple[str, ...]], shares: Array, observe: dict[str, Any] | None = None
) -> tuple[dict[str, Array], Array]:
    """Columns of shape (directions, shares): each direction moved by each share of its size, from the strobe state of the motion."""
    sizes, (k, m) = sizes_of(orbit.model, moved), shares.shape
    start = coordinates(orbit.model).start(orbit.state)
    results = results_of(moved_by(orbit.model, moves_of(moved, sizes, shares)), k * m, start=start, rtol=_RTOL_BESIDE, observe=observe)
    return {name: values.reshape(k, m) for name, values in results.items()}, sizes


def _multipliers(orbit: PeriodicOrbit, moved: dict[str, tuple[str, ...]], shares: Array, _: Any) -> tuple[dict[str, Array], Array]:
    """The largest multiplier of the motions beside one, by their monodromy matrices, which are exact."""
    sizes, (k, m) = sizes_of(orbit.model, moved), shares.shape
    near, at = moved_by(orbit.model, moves_of(moved, sizes, shares)), coordinates(orbit.model)
    along = Closing(near, at, {}, 0, RTOL, k * m)
    closed = along.near(np.tile(orbit.state, (k * m, 1)), orbit.period)
    good = along.is_good(closed) & np.isfinite(closed.monodromy).all(axis=(1, 2))
    values = np.full(k * m, np.nan)
    values[good] = np.max(abs(np.linalg.eigvals(closed.monodromy[good])), axis=1, initial=0.0)
    return {MULTIPLIER: values.reshape(k, m), "period": np.full((k, m), orbit.period)}, sizes


def _by_differences(orbit: PeriodicOrbit, of: Any, moved: dict[str, tuple[str, ...]], remarks: Sequence[str] = ()) -> Gradient:
    """Central differences of two steps, extrapolated (Richardson): of ever shorter pairs of steps the two that agree best."""
    shares = np.array([0.0, *(side * step / part for step in _STEPS for part in (1, 2) for side in (1.0, -1.0))])
    observe = {OWN: of} if isinstance(of, Observable) else None
    sides = sides_of(orbit.model, moved, _BESIDE)[:, None]  # beyond the end of a range stands the number itself
    results, sizes = (_multipliers if of == MULTIPLIER else _neighbours)(orbit, moved, np.where(sides * shares < 0.0, 0.0, shares), observe)
    own = results.get(OWN if observe else of)
    if own is None:
        raise InputError("gradient", [f"of = {of!r} is not known of this {type(orbit.model).__name__}; type of='mean_velocity'"])
    value, columns, words = float(own[0, 0]), own[:, 1:].reshape(len(moved), -1, 4), words_of(results)
    steps = np.array(_STEPS) * sizes[:, None]
    long, short = (columns[..., 2 * k] - columns[..., 2 * k + 1] for k in (0, 1))
    slopes = np.where(sides == 0, (4.0 * short - 0.5 * long) / 3.0, 4.0 * short - long) / steps
    for i, row in enumerate(words):
        for j in range(len(_STEPS)):
            if any(word != row[0] for word in row[1 + 4 * j : 5 + 4 * j]):
                slopes[i, j] = np.nan  # across a change of modes
    apart = abs(np.diff(slopes, axis=1))
    best = [slopes[i, 1 + int(np.nanargmin(row))] if np.isfinite(row).any() else np.nan for i, row in enumerate(apart)]
    missing = [
        f"{name}: no derivative of {named(of)}, as the sequence of modes changes next to it"
        for name, x in zip(moved, best, strict=True)
        if x != x
    ]
    notes = [f"derivatives of {named(of)} are differences of the steady motion", *missing, *remarks]
    return Gradient(dict(zip(moved, map(float, best), strict=True)), named(of), value, notes)


def _one_sided(motion: ClosedMotions, orbit: PeriodicOrbit, moved: dict[str, tuple[str, ...]], at: Coordinates, stepped: bool) -> list[str]:
    """A sentence for every number next to which the sequence of modes, or the slope of the mean velocity, changes.

    One motion period to either side of each number, from where the derivatives say that the motion is there, is all that this takes.
    """
    model, k, sizes = orbit.model, len(moved), sizes_of(orbit.model, moved)
    if not has_corners_of(model) or not np.isfinite(motion.changes).all():
        return []
    try:
        words, V = _around(motion, orbit, moved, at, stepped, np.zeros(k))
    except InputError:  # a number at the end of its range
        words, V = _around(motion, orbit, moved, at, stepped, sides_of(model, moved, _BESIDE))
    free = float(machine_of(model).free_velocity)
    noise, sentences = _NOISE * free, []
    for name, (below, here, above), (less, own, more), size in zip(moved, words, V, sizes, strict=True):
        left, right = own - less, more - own
        kink = abs(right - left) > _KINK * max(abs(left), abs(right)) + noise
        if below == here == above and not kink:
            continue
        all_three = f" (below {below}, here {here}, above {above})" if not below == here == above else ""
        sentences.append(
            f"{name}: one-sided, as the sequence of modes changes within {_BESIDE:g} of it{all_three}; "
            f"{_slope_in_words(-left, -_BESIDE * size, free)} below, {_slope_in_words(right, _BESIDE * size, free)} above"
        )
    return sentences


def _slope_in_words(change: float, step: float, free: float) -> str:
    """By how much the mean velocity differs one step beside a number: at once, or in proportion to the step."""
    return f"V jumps by {change:+.3g}" if abs(change) > _JUMP * free else f"V changes by {change / step:.6g} per unit"


def _around(
    motion: ClosedMotions, orbit: PeriodicOrbit, moved: dict[str, tuple[str, ...]], at: Coordinates, stepped: bool, sides: Array
) -> tuple[Array, Array]:
    """Modes and mean velocities below, at and above each number; or, of one that may be moved to one side only, at and twice beside it."""
    k, sizes, shares = len(moved), sizes_of(orbit.model, moved), _BESIDE * (np.array([-1.0, 0.0, 1.0]) + sides[:, None])
    near = moved_by(orbit.model, moves_of(moved, sizes, shares))
    starts = np.repeat(np.repeat(motion.nearer, k, axis=0), 3, axis=0)
    starts[:, : motion.changes.shape[2]] += (shares[:, :, None] * (sizes[:, None] * motion.changes[0])[:, None]).reshape(3 * k, -1)
    ends = strobe_map(near, starts, orbit.period, orbit.rtol, at, stepped)
    V = (ends.displacement / (orbit.period * spread_over_cases(near.period, labels_of(near)))).reshape(k, 3)
    return np.array(["/".join(each) for each in zip(*ends.patterns, strict=True)]).reshape(k, 3), V
