"""`identify`: several records, one model, the parameters that they tell."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from stickslip.arguments import Maker, Measured, Numbers, explains_arguments
from stickslip.callbacks import told_of_progress
from stickslip.errors import InputError, Problems, is_one_of
from stickslip.fields import checked_number
from stickslip.identifying.driven import DrivenProblem, motion_of
from stickslip.identifying.fit import Fit
from stickslip.identifying.parameters import Parameters, parameters
from stickslip.identifying.problems import SteadyProblem
from stickslip.identifying.search import multistart, polished, searched
from stickslip.identifying.targets import target
from stickslip.identifying.words import counted
from stickslip.information import Information
from stickslip.quantities import between
from stickslip.records import Record

__all__ = ["identify"]

USES = ("auto", "velocity", "position", "mean", "force")
_SAMPLES = 2500  # samples of force against motion that the multistart looks at


@explains_arguments
def identify(
    records: Measured | Sequence[Measured] | Numbers,
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
    starts: int = 64,
    seed: int = 0,
    rtol: float = 1e-8,
    progress: Callable[[int, int], None] | bool | None = None,
    **arguments: Any,
) -> Fit:
    """Fit the parameters of a robot, or of a friction law, to one or several records at once.

    Curves are compared at the record's own instants; the drive's phase in each record is fitted along. Of more than 20 000 samples of a
    velocity those at neighbouring phases of the motion are averaged, in five parts of the record apart. The search begins at many
    places of a Sobol sequence, judged in batches, and goes on from the best by trust-region steps.

    Parameters
    ----------
    records : Record, number, or a list of them
        A number is a mean velocity [m/s].
    make : callable or Robot or law
        A maker with its arguments, such as ``ss.presets.piezo_rig``; a robot, whose fields are then named with dots; or the class of a
        law (or a law), which is then fitted as force against motion.
    free : dict
        Bounds of the free parameters: ``(low, high)``, or ``(low, high, "log")`` for a search in the logarithm. ``"amplitude[0]"`` is
        that of the first record alone, ``"amplitude[:]"`` one for each record.
    tied : dict, optional
        Arguments that follow from others: another's name, or a function of the dict of all of them.
    using : {"auto", "velocity", "position", "mean", "force"}
        What is compared. "auto" takes force for a law, else velocity, else position.
    noise : float, optional
        Standard deviation of one value [SI]. Without it, its size is taken from the residuals.
    frequency : float, optional
        Drive frequency of the records [Hz]; otherwise it is refined from each record, and fitted along.
    load : float, optional
        Normal force for force against motion [N]; otherwise the record's channel "load".
    settle : int or "auto"
        Drive periods at the start of each record that are not compared with steady motion; "auto" leaves out those that differ from the
        later ones by more than the noise, and a note says so.
    transient : bool
        Fit the start too: each record is simulated from its first sample on, its velocity at the strobe time before that fitted along, its
        bristles unbent there.
    starts : int
        Places of the multistart.
    seed : int
        Of the multistart.
    rtol : float
        Of the solver.
    progress : callable or bool, optional
        True for a line on the terminal, or what is called with (done, in all).
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
    records = as_list(records)
    _check(records, using, noise, starts, seed)
    problem = problem_of(records, make, free, tied, using, noise, frequency, load, rtol, arguments, settle, transient, starts, seed)
    notes = _notes(records, problem)
    rough = problem.rough()
    best, agree = searched(rough, starts, seed, told_of_progress(progress, "identify"))
    best = polished(problem, best.place)
    problem.solves += rough.solves
    return _fit(problem, best, starts, agree, notes, noise is not None, seed, tuple(records))


def as_list(records: Any) -> list[Any]:
    """One record, or several."""
    return list(records) if isinstance(records, (list, tuple)) else [records]


def problem_of(
    records: list[Any], make: Any, free: dict[str, Any], tied: dict[str, Any] | None, using: str, noise: float | None,
    frequency: float | None, load: float | None, rtol: float, arguments: dict[str, Any],
    settle: int | str = "auto", transient: bool = False, starts: int = 64, seed: int = 0,
) -> SteadyProblem | DrivenProblem:  # fmt: skip
    """The least-squares problem of these records."""
    of = parameters(make, free, tied, arguments, len(records))
    first = of.first_models(multistart(len(of.free), starts, seed))
    if using == "force" or (using == "auto" and not hasattr(first[0], "friction")):
        return _driven(records, of, load, noise)
    targets = tuple(target(rec, using, noise, frequency, f"record {i}", settle, transient) for i, rec in enumerate(records))
    return SteadyProblem(of, targets, rtol)


def _check(records: list[Any], using: str, noise: float | None, starts: int, seed: int) -> None:
    problems = Problems("identify")
    if not records:
        problems.add("no record given; type for example ss.identify([ss.read(path)], ...)")
    for i, rec in enumerate(records):
        if not isinstance(rec, (Record, int, float, np.number)) or isinstance(rec, bool):
            problems.add(f"records[{i}] = {rec!r}; allowed is a Record (ss.read(path)) or a mean velocity [m/s]")
        elif not isinstance(rec, Record) and not abs(float(rec)) <= 1e9:
            problems.add(f"records[{i}] = {rec!r}; allowed is a mean velocity up to 1e9 m/s in size")
    if not is_one_of(using, USES):
        problems.add(f"using = {using!r}; allowed is one of {', '.join(USES)}")
    if noise is not None:
        checked_number("noise", noise, problems, between(1e-30, 1e30), "a positive standard deviation, or None", "noise=1e-4")
    problems.whole("starts", starts, 1, example=64)
    problems.whole("seed", seed, 0, example=1)
    problems.check()


def _driven(records: list[Any], of: Parameters, load: float | None, noise: float | None) -> DrivenProblem:
    motions = tuple(motion_of(rec, load, f"record {i}") for i, rec in enumerate(records))
    spread = float(np.std(np.concatenate([m.y for m in motions])))
    thin = max(sum(len(m.t) for m in motions) // _SAMPLES, 1)
    return DrivenProblem(of, motions, noise or 0.01 * spread or 1.0, thin)


def _notes(records: list[Any], problem: Any) -> list[str]:
    notes = [f"record {i} is synthetic" for i, rec in enumerate(records) if getattr(rec, "synthetic", False)]
    notes += [f"{t.label}: {t.said}, transient=True fits them too" for t in problem.targets if getattr(t, "said", None)]
    notes += [f"{t.label}: {t.cut}" for t in problem.targets if getattr(t, "cut", None)]
    if isinstance(problem, DrivenProblem):
        notes += [f"{m.label}: the sign of the force was turned, so that friction takes energy" for m in problem.targets if m.flipped]
    return notes


def _fit(problem: Any, best: Any, starts: int, agree: int, notes: list[str], given: bool, seed: int, records: tuple[Any, ...]) -> Fit:
    free = problem.parameters.free
    n, count = len(free), len(best.residuals)
    if best.cost >= 0.99 * count * 1e8:
        raise InputError("identify", ["the model could not be solved at any place that was tried; check the arguments that are fixed"])
    dof = count - n - problem.nuisances
    scale = 1.0 if given or dof < 1 else float(np.sqrt(best.cost / dof))
    values = {f.name: float(f.outer(p)) for f, p in zip(free, best.place, strict=False)}
    slope = np.array([f.slope(p) for f, p in zip(free, best.place, strict=False)])
    with np.errstate(invalid="ignore"):
        covariance = Information(best.jacobian, problem.resolution).covariance(scale)[:n, :n] * np.outer(slope, slope)
    errors = {name: float(np.sqrt(covariance[k, k])) for k, name in enumerate(values)}
    if dof < 1 and not given:
        notes = [*notes, f"{counted(count, 'value')} and {counted(n, 'free parameter')}: nothing is left to tell the noise; type noise=..."]
    from stickslip import __version__

    law = _law_name(problem.parameters.model(values, 0))
    provenance = {
        "stickslip": __version__,
        "seed": seed,
        "starts": starts,
        "solves": problem.solves,
        "arguments": [_plain(f) for f in problem.parameters.fixed],
    }
    return Fit(
        values,
        errors,
        covariance,
        problem,
        best.place,
        best.jacobian,
        best.residuals,
        scale,
        starts,
        agree,
        best.steps,
        tuple(notes),
        law,
        provenance,
        records,
    )


def _law_name(model: Any) -> str:
    return type(getattr(model, "friction", model)).__name__


def _plain(arguments: dict[str, Any]) -> dict[str, Any]:
    return {name: value if isinstance(value, (int, float, str)) else str(value) for name, value in arguments.items()}
