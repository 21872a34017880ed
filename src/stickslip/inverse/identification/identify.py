"""`identify`: several records, one model, the parameters that they tell."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from stickslip.basics.arguments import Executes, Maker, Numbers, explains_arguments
from stickslip.basics.contracts import Model
from stickslip.basics.distributions import ALLOWED, distribution_of
from stickslip.basics.errors import InputError, Problems, is_one_of
from stickslip.basics.executors import Workers
from stickslip.basics.fields import checked_number
from stickslip.basics.interruption import interruptible
from stickslip.basics.phrases import counted, listed
from stickslip.basics.progress import reporting
from stickslip.basics.quantities import between
from stickslip.inverse.identification.commanded_logs import CommandedProblem, command_log, takes_commands
from stickslip.inverse.identification.constant_speeds import is_of_constant_speeds, motion_at_constant_speeds
from stickslip.inverse.identification.covariance import noise_scale, spread_of
from stickslip.inverse.identification.delays import with_jumps
from stickslip.inverse.identification.drive_harmonics import with_harmonics
from stickslip.inverse.identification.fit import Fit
from stickslip.inverse.identification.fit_settings import FitSettings
from stickslip.inverse.identification.force_problem import DrivenProblem
from stickslip.inverse.identification.least_squares import MeasuredProblem
from stickslip.inverse.identification.logs_of_machines import bench_of, takes_records
from stickslip.inverse.identification.mean_velocity_problem import MeansProblem
from stickslip.inverse.identification.misfit import misfit_of
from stickslip.inverse.identification.motions import motion_of
from stickslip.inverse.identification.nesting import nested_seeds
from stickslip.inverse.identification.parameters import Parameters, parameters
from stickslip.inverse.identification.plausibility import contradictions
from stickslip.inverse.identification.refinement import canonical, finished, held_back, spared_note, spared_numbers, undetermined
from stickslip.inverse.identification.rounding import beside_white, rounding_columns
from stickslip.inverse.identification.search import SearchEnd, searched, starting_points
from stickslip.inverse.identification.sensors import sensors_of, with_starts
from stickslip.inverse.identification.steady_curves import moves_alike_anywhere
from stickslip.inverse.identification.steady_problem import SteadyProblem
from stickslip.inverse.identification.targets import target
from stickslip.inverse.identification.weighting import loss_of, outlier_notes, robust_scale, weighted
from stickslip.models.force_rig import ForceRig
from stickslip.models.friction.law_adapter import LawAdapter, adapted
from stickslip.models.machine_adapter import is_machine, machine_of
from stickslip.records import Record

USES = ("auto", "velocity", "position", "mean", "force")
_SAMPLES = 2500  # samples of force against motion that the multistart looks at
_MOSTLY = 0.7  # of the squares of the noise
_SLOW = 40  # drive periods to a tenth: motions that settle more slowly are remarked on
_GOLDEN = 0.618033988749895  # of a turn: numbers at multiples of it are all different


@explains_arguments
@interruptible
def identify(
    records: Record | Sequence[Record] | Numbers,
    make: Maker,
    *,
    free: dict[str, Any],
    tied: dict[str, Any] | None = None,
    using: str = "auto",
    noise: float | None = None,
    frequency: float | None = None,
    load: float | None = None,
    settle: int | str = "auto",
    transient: bool = False,
    sensor: dict[str, Any] | None = None,
    harmonics: Any = None,
    weights: Any = None,
    loss: str = "squares",
    body: str | None = None,
    starts: int = 64,
    seed: int = 0,
    rtol: float = 1e-8,
    workers: int = 1,
    executor: Executes = None,
    progress: Callable[[int, int], None] | bool | None = None,
    **arguments: Any,
) -> Fit:
    """Fit the parameters of a robot, or of a friction law, to one or several records at once.

    Curves are compared at the sampling times of the record; the phase of the drive in each record is fitted too. If a velocity has more
    than 20 000 samples, those at neighbouring phases of the motion are averaged, separately in five parts of the record. The search
    starts from many points of a Sobol sequence, which are evaluated in batches. It continues by trust-region steps from the best of
    them, and from the best fits of the simpler laws contained in the fitted one. Ctrl-C ends it with the best fit so far, and a note.

    The sensor is part of the model: its reading is ``gain * h(t - delay) + offset + drift * t`` of the modelled quantity h, so that an
    offset or a gain of 1.02 widens the intervals instead of shifting the numbers. With a free offset a record contains no information on
    the mean velocity; a speed that was measured otherwise is given in addition, as ``[record, ("normal", 2.1e-3, 2e-5)]``.

    Parameters
    ----------
    records : Record, number, or a list of them
        A number is a mean velocity [m/s]; together with records it is given with its uncertainty: ``("normal", mean, sd)`` or ``(value,
        "1%")``.
    make : callable or Robot or law
        A maker with its arguments, such as ``ss.presets.piezo_rig``; a robot, whose fields are then named with dots; or the class of a
        law (or a law), which is then fitted as force against motion.
    free : dict
        Bounds of the free parameters: ``(low, high)``, or ``(low, high, "log")`` for a search in the logarithm; or a prior: ``("normal",
        mean, sd)``, ``("uniform", low, high)``, ``(value, "1%")``. ``"amplitude[0]"`` is that of the first record alone,
        ``"amplitude[:]"`` one for each record.
    tied : dict, optional
        Arguments that follow from others: another's name, or a function of the dict of all of them.
    using : {"auto", "velocity", "position", "mean", "force"}
        The quantity that is compared. "auto" takes force for a law, else velocity, else position.
    noise : float, optional
        Standard deviation of one value [SI]; if not given, it is estimated from the residuals.
    frequency : float, optional
        Drive frequency of the records [Hz]; otherwise it is refined from each record, and fitted along.
    load : float, optional
        Normal force for force against motion [N]; otherwise the record's channel "load".
    settle : int or "auto"
        Drive periods at the start of each record that are not compared with steady motion; "auto" leaves out those that differ from the
        later ones by more than the noise, and a note says so.
    transient : bool
        Fit the transient too: each record is simulated from its first sample on, with a fitted velocity at the preceding strobe time and
        undeflected bristles. For forces over a motion that does not repeat, and for logs of machines, the bristle deflection at the first
        sample is fitted, of forces also without `transient` where `sensor` is None (``fit.sensor["start[0]"]``, from -1, as after slow
        sliding backwards, to 1; 0 is undeflected).
    sensor : dict, optional
        Effects of the sensors. None fits an offset and a drift for each record, one gain (1 with a standard deviation of 2 %) and, of
        forces, one delay, where a record has values enough; ``{}`` is an ideal sensor. Otherwise a dict of effects: ``dict(offset=0.0,
        gain=("normal", 1.0, 0.02), drift=None)`` fixes the first, gives a prior for the second, and leaves the third free. Names: offset
        and drift [unit of the record, and that per second], gain, delay [s], and of forces preload [N] (besides the normal force) and
        inertia [kg] of the parts between contact and sensor; of angles under a command delay, zero [rad] (from the hanging position), begin
        (the first angle beside the measured one), and goal where the command is counted from another zero than the angle, by so much.
        ``"offset[0]"`` is that of the first record, ``"offset[:]"`` one for each.
    harmonics : float or dict, optional
        How well the harmonics of the drive are known that it has besides those of the model: the standard deviation of sine and cosine of
        the second and the third in parts of its amplitude, or a dict of it by order (``{2: 0.03, 4: 0.01}``); 0 for a drive that is exactly
        that of the model. None is 0.02, of records of a velocity or a position, each experiment with its own (``fit.drive``); mean
        velocities are of the drive of the record of the same experiment.
    weights : array, or list of them, optional
        A weight for each sample (of one record, or of each): a factor on its squared residual. 0 leaves it out.
    loss : {"squares", "huber", "bisquare"}
        Loss function: the squares of the residuals, or one that grows less for large residuals, so that outliers do not dominate the fit
        ("huber": linearly beyond 1.3 standard deviations of the bulk; "bisquare": constant beyond 4.7). Intervals take the loss function
        into account.
    body : str, optional
        Whose motion the records are, of a machine of several bodies (a `Chain`) that names no principal one.
    starts : int
        Number of starting points of the search. For logs of a command and an angle it begins at the numbers of the machine too, and with
        ``starts=1`` there alone.
    seed : int
        Seed of the multistart.
    rtol : float
        Relative tolerance of the solver.
    workers : int
        Threads among which the points of the search are divided. The results do not depend on it.
    executor : executor or callable, optional
        Compute them there, as for `sweep`; `workers` is then the number of its workers.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with (done, in all).
    **arguments
        Arguments of `make` that are known: one value, or a list with one for each record.

    Returns
    -------
    Fit

    Examples
    --------
    >>> import stickslip as ss
    >>> rec = [ss.virtual_rig(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=A, law="coulomb"), noise=1e-3, seed=1) for A in (5e-4, 8e-4)]
    >>> fit = ss.identify(rec, ss.presets.piezo_rig, free={"mu0": (0.05, 0.5)}, tilt_deg=1.7, amplitude=[5e-4, 8e-4], law="coulomb")
    >>> low, high = fit.interval("mu0", level=0.95)
    >>> low < 0.18 < high, high - low < 0.01
    (True, True)
    """
    records, weigh = as_list(records), loss_of(loss)
    how = FitSettings(using, noise, frequency, load, settle, transient, sensor, harmonics, body, starts, seed, rtol)
    crew = Workers(workers, executor)
    _check(records, how, crew)
    records = weighted(records, weights)
    problem = problem_of(records, make, free, tied, arguments, how)
    notes = _notes(records, problem)
    rough = problem.rough()
    guesses = [np.array([*point, *(n.value for n in rough.numbers)]) for point in rough.model.guesses()]
    notes += _at_the_guess(problem, guesses)
    with crew.kept() as kept:
        seeds = partial(nested_seeds, rough, starts, seed, kept) if not guesses else lambda: guesses
        best, agree = searched(rough, 0 if guesses and starts == 1 else starts, seed, reporting(progress, "identify"), seeds, kept)
    problem, best = finished(problem, best)
    spared = [] if best.stopped else spared_numbers(problem, best)
    problem, best = held_back(weigh, problem, best if best.stopped else canonical(problem, best, spared))
    notes += (
        outlier_notes(problem)
        + spared_note(spared)
        + ([] if best.stopped else _slow_notes(problem, best.point) + _rounded_notes(problem, best))
    )
    solved = problem.solves + rough.solves
    return _fit(problem, best, _Effort(starts, agree, seed, solved), notes, tuple(records), weigh)


def _at_the_guess(problem: MeasuredProblem, guesses: list[Any]) -> list[str]:
    """What these records would not determine if the user's guess were right: known before the search."""
    notes = []
    for guess in guesses:
        point = problem.whole(guess)
        there = SearchEnd(point, problem.residuals(point), problem.jacobian(point), 0)
        names = [problem.parameters.names[k] for k in undetermined(problem, there) if k < len(problem.parameters.free)]
        notes += [f"by the derivatives at the guess these records do not determine {listed(names)} singly"] if names else []
    return notes


def as_list(records: Any) -> list[Any]:
    """One record, or several."""
    return [records] if distribution_of(records) or not isinstance(records, (list, tuple)) else list(records)


def problem_of(
    records: list[Any],
    make: Model | Callable[..., Any],
    free: dict[str, Any],
    tied: dict[str, Any] | None,
    arguments: dict[str, Any],
    how: FitSettings,
) -> MeasuredProblem:
    """The least-squares problem of these records."""
    of = parameters(make, free, tied, arguments, len(records))
    first = of.first_models(starting_points(of, how.starts, how.seed))
    machines = is_machine(first[0])
    _refuse_chance(first[0], machines)
    if machines and (how.using == "force" or (how.using == "auto" and takes_records(first[0], records))):
        model: Any = _moved(records, of, how.noise, first)
    elif machines and how.using in ("auto", "position", "angle") and takes_commands(first[0], records):
        model = _commanded(records, of, how, first)
    elif how.using == "force" or (how.using == "auto" and not machines):
        _check_forces(records)
        model = _driven(records, of, how.load, how.noise, first, how.transient or how.sensor is None)
    else:
        own = _body(first[0], how.body)
        targets = tuple(
            target(rec, how.using, how.noise, how.frequency, f"record {i}", how.settle, how.transient) for i, rec in enumerate(records)
        )
        targets = tuple(dataclasses.replace(t, body=own) for t in targets)
        if how.transient:
            alike = [t.kind == "mean" or moves_alike_anywhere(model) for t, model in zip(targets, first, strict=True)]
            targets = tuple(dataclasses.replace(t, placed=not same) for t, same in zip(targets, alike, strict=True))
        only_means = all(t.kind == "mean" for t in targets)
        model = MeansProblem(of, targets, how.rtol) if only_means else SteadyProblem(of, targets, how.rtol)
    numbers, held = sensors_of(how.sensor, model.targets)
    starts_open = [i for i, t in enumerate(model.targets) if model.remembers and t.any_start]
    numbers = with_harmonics(with_starts(numbers, held, starts_open), how.harmonics, model.targets, of, first)
    return MeasuredProblem(model, numbers, held, given=how.sensor, harmonics=how.harmonics)


def _body(model: Model, body: str | None) -> int | None:
    """The number of the body whose motion was measured; None for a machine whose motion is that of one body."""
    names = machine_of(model).part_names.get("body", ())
    if body is None and len(names) < 2:
        return None if not names else 0
    if body not in names:
        had = f"body = {body!r}" if body is not None else f"the {type(model).__name__} has {len(names)} bodies and no principal one"
        allowed = f"allowed are {', '.join(map(repr, names))}; type body={names[0]!r}" if names else "this machine has one; leave it out"
        raise InputError("identify", [f"{had}; {allowed}"])
    return list(names).index(body)


def _check_forces(records: list[Any]) -> None:
    """`InputError` for numbers, and for records of a motion without a force, of which a law alone says nothing."""
    for i, rec in enumerate(records):
        if not isinstance(rec, Record):
            why = "and a law alone is fitted to a force over a motion; for a mean velocity give the robot (a preset, a study file) instead"
            raise InputError("identify", [f"records[{i}] = {rec!r} is a number, {why}; or type ss.read(path)"])
        moves = "force" not in rec and ("velocity" in rec or "position" in rec)
        if moves and all(c.unit is not None for c in rec.channels.values()):
            why = "and a law alone is fitted to a force over a motion; for a motion alone give the robot (a preset, a study file) instead"
            raise InputError("identify", [f'record {i} has no force, {why}, and type free={{"friction.mu_plus": (0.05, 0.5)}}'])


def _refuse_chance(model: Any, machine: bool) -> None:
    """`InputError` for a law of chance: its forces are others with another seed, so residuals say nothing of its numbers."""
    laws = machine_of(model).laws if machine else [_contact(model)]
    random = next((law.name for law in laws if law.random), None)
    if random is not None:
        why = "its bonds form again at random places, so that a record cannot be compared with one run of it"
        raise InputError("identify", [f"{random} cannot be fitted: {why}; fit a law without chance, such as ss.friction.GMS or ss.LuGre"])


def _check(records: list[Any], how: FitSettings, workers: Workers) -> None:
    problems, using, noise = Problems("identify"), how.using, how.noise
    if not records:
        problems.add("no record given; type for example ss.identify([ss.read(path)], ...)")
    curves = any(isinstance(rec, Record) for rec in records)
    for i, rec in enumerate(records):
        if isinstance(rec, Record) or distribution_of(rec):
            continue
        if not isinstance(rec, (int, float, np.number)) or isinstance(rec, bool):
            problems.add(
                f"records[{i}] = {rec!r}; allowed is a Record (ss.read(path)), a mean velocity [m/s], or one with its error: {ALLOWED}"
            )
        elif not abs(float(rec)) <= 1e9:
            problems.add(f"records[{i}] = {rec!r}; allowed is a mean velocity up to 1e9 m/s in size")
        elif curves and noise is None:
            problems.add(
                f"records[{i}] = {rec!r} stands beside records and does not say how sure it is; "
                f'type ("normal", {rec!r}, standard deviation) or ({rec!r}, "1%")'
            )
    if not is_one_of(using, USES):
        problems.add(f"using = {using!r}; allowed is one of {', '.join(USES)}")
    if noise is not None:
        checked_number("noise", noise, problems, between(1e-30, 1e30), "a positive standard deviation, or None", "noise=1e-4")
    problems.whole("starts", how.starts, 1, example=64)
    problems.whole("seed", how.seed, 0, example=1)
    workers.note(problems)
    problems.check()


def _driven(
    records: list[Any], of: Parameters, load: float | None, noise: float | None, first: list[Any], any_start: bool
) -> DrivenProblem:
    motions = []
    for i, (rec, law) in enumerate(zip(records, first, strict=True)):
        if is_of_constant_speeds(rec):
            table = motion_at_constant_speeds(rec, load, _contact(law), f"record {i}")
            motions.append(dataclasses.replace(table, given_sigma=noise is not None))
            continue
        plays = isinstance(law, ForceRig)  # nobody knows where in its play it stands
        made = motion_of(rec, load, f"record {i}", any_start or plays, not plays)
        made = dataclasses.replace(made, given_sigma=noise is not None, rigid=not (plays or _contact(law).dynamic))
        motions.append(made.through_play() if plays else made)
    return _over_motions(of, tuple(motions), noise, [_contact(law) for law in first])


def _contact(model: Any) -> LawAdapter:
    """The law of a contact whose motion is that of a record, or of an actuator before a play."""
    return model.law if isinstance(model, ForceRig) else adapted(model)


def _moved(records: list[Any], of: Parameters, noise: float | None, first: list[Any]) -> DrivenProblem:
    benches = (bench_of(model, rec, f"record {i}") for i, (model, rec) in enumerate(zip(first, records, strict=True)))
    known = tuple(dataclasses.replace(bench, given_sigma=noise is not None) for bench in benches)
    return _over_motions(of, known, noise, [law for model in first for law in machine_of(model).laws])


def _commanded(records: list[Any], of: Parameters, how: FitSettings, first: list[Any]) -> CommandedProblem:
    """The problem of logs of a command and the angle that followed."""
    logs = tuple(command_log(model, rec, how.noise, f"record {i}") for i, (model, rec) in enumerate(zip(first, records, strict=True)))
    return CommandedProblem(of, logs, how.rtol)


def _over_motions(of: Parameters, targets: tuple[Any, ...], noise: float | None, laws: list[LawAdapter]) -> DrivenProblem:
    spread = float(np.std(np.concatenate([m.y for m in targets])))
    thin = max(sum(m.count for m in targets) // _SAMPLES, 1)
    holds = any(not law.dynamic or law.needs_applied for law in laws)
    remembers = any(law.dynamic for law in laws) or any(t.in_play for t in targets)
    return DrivenProblem(of, targets, noise or 0.01 * spread or 1.0, thin, holds, remembers=remembers)


def _notes(records: list[Any], problem: Any) -> list[str]:
    notes = [f"record {i} is synthetic" for i, rec in enumerate(records) if getattr(rec, "synthetic", False)]
    notes += [f"{t.label}: {t.remark}, transient=True fits them too" for t in problem.targets if t.remark]
    notes += [f"record {i}: {note}" for i, rec in enumerate(records) for note in getattr(rec, "notes", ()) if "saturated?" in note]
    notes += [f"{t.label}: {t.cut}" for t in problem.targets if t.cut]
    turned = (t.label for t in problem.targets if getattr(t, "flipped", False))
    return notes + [f"{label}: the sign of the force was reversed, so that friction dissipates energy" for label in turned]


def _slow_notes(problem: MeasuredProblem, point: Any) -> list[str]:
    """Sentences on steady motions that settle so slowly that a record may have begun before."""
    slow = {label: periods for label, periods in problem.model.settling(point[: problem.first]).items() if periods > _SLOW}
    return [
        f"{label}: this motion settles slowly, a tenth of a start is left after "
        + (f"{round(periods)} drive periods" if np.isfinite(periods) else "more than can be told")
        + "; the intervals suppose that the record began later than that"
        for label, periods in slow.items()
    ]


def _rounded_notes(problem: MeasuredProblem, best: SearchEnd) -> list[str]:
    """Sentences on records of which rounding to counts is most of the noise."""
    scale = noise_scale(problem, best)
    each = zip(problem.targets, rounding_columns(problem, best.residuals, scale), strict=True)
    most = [target.label for target, columns in each if columns.shape[1] and beside_white(columns, scale**2)[0] > _MOSTLY * scale**2]
    why = "which stays while it rests; of a single number 95 % intervals hold in 90 to 100 % of such logs"
    return [f"{listed(most)}: rounding to counts is most of the noise, {why}"] if most else []


class _Effort(NamedTuple):
    """How a best fit was looked for: from how many starts, how many of them agree, of which seed, with how many runs."""

    starts: int
    agree: int
    seed: int
    solves: int


def _fit(problem: MeasuredProblem, best: SearchEnd, effort: _Effort, notes: list[str], records: tuple[Any, ...], weigh: Any) -> Fit:
    free = problem.parameters.free
    n, count = len(free), len(problem.y)
    if best.cost >= 0.99 * count * 1e8:
        raise InputError("identify", ["the model could not be solved at any starting point; check the arguments that are fixed"])
    given = all(t.given_sigma for t in problem.targets)
    dof = len(best.residuals) - n - problem.nuisances
    scale = noise_scale(problem, best)
    if np.ndim(problem.rows):
        scale = robust_scale(weigh, best.residuals[:count] / np.sqrt(problem.rows), problem.rows, scale)
    values = {f.name: float(f.outer(p)) for f, p in zip(free, best.point, strict=False)}
    if dof < 1 and not given:
        notes = [
            *notes,
            f"{counted(count, 'value')} and {counted(n, 'free parameter')}: nothing is left to estimate the noise; type noise=...",
        ]
    if best.stopped:
        notes = [*notes, "the search was interrupted: these are the best values so far, and there may be better ones"]
    changes = None if best.stopped else problem.input_changes(best.point)
    misfit = misfit_of(problem, best, changes)
    from stickslip import __version__

    law = _law_of(problem.parameters, values)
    provenance = {
        "stickslip": __version__,
        "seed": effort.seed,
        "starts": effort.starts,
        "solves": effort.solves,
        "arguments": [_plain(f) for f in problem.parameters.fixed],
    }
    return Fit(
        values,
        with_jumps(problem, best, scale, spread_of(problem, best.jacobian, best.residuals, scale, changes, misfit)),
        problem,
        best.point,
        best.jacobian,
        best.residuals[:count],
        scale,
        effort.starts,
        effort.agree,
        best.steps,
        tuple(notes),
        law,
        provenance,
        records,
        penalty=float(best.residuals[count:] @ best.residuals[count:]),
        stopped=best.stopped,
        contradictions=tuple(contradictions(problem, values, best.point)),
        changes=changes,
        misfit=misfit,
    )


def _law_of(of: Parameters, values: dict[str, float]) -> str:
    """What is fitted: the law; of the models of a servo the one that has all free numbers, whatever becomes zero."""
    somewhere = 0.3 + 0.4 * ((np.arange(len(of.free)) * _GOLDEN) % 1.0)
    model = (of.models(somewhere) or [of.model(values, 0)])[0]
    return getattr(model, "friction_name", "") or type(getattr(model, "friction", model)).__name__


def _plain(arguments: dict[str, Any]) -> dict[str, Any]:
    return {name: value if isinstance(value, (int, float, str)) else str(value) for name, value in arguments.items()}
