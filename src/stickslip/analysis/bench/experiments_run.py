"""The bench: standard experiments of the friction literature on one law, or on several side by side."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable
from typing import Any, overload

from stickslip.analysis.bench.drift import drift
from stickslip.analysis.bench.findings import Bench, Benches, Experiment
from stickslip.analysis.bench.path import dissipation, hysteresis
from stickslip.analysis.bench.pulled import breakaway, stick_slip
from stickslip.analysis.bench.setup import Setup
from stickslip.analysis.bench.velocity import lag, steady_friction
from stickslip.basics.arguments import explains_arguments
from stickslip.basics.contracts import Law
from stickslip.basics.errors import Problems, did_you_mean
from stickslip.basics.fields import is_array, leaves
from stickslip.basics.interruption import interruptible, look, partial_result
from stickslip.basics.progress import reporting
from stickslip.engine.law_checks import finite
from stickslip.models.forces import check_law
from stickslip.models.friction import LAWS
from stickslip.models.friction.law_adapter import adapted

#: The experiments by name, in the order of the figure.
EXPERIMENTS: dict[str, Callable[[Setup], Experiment]] = {
    "steady": steady_friction,
    "lag": lag,
    "hysteresis": hysteresis,
    "dissipation": dissipation,
    "breakaway": breakaway,
    "stick_slip": stick_slip,
    "drift": drift,
}


@overload
def bench(law: list[Any] | tuple[Any, ...], *arguments: Any, **more: Any) -> Benches: ...
@overload
def bench(law: Law, *arguments: Any, **more: Any) -> Bench: ...
@explains_arguments
@interruptible
def bench(
    law: Any,
    load: float = 1.0,
    mass: float = 1.0,
    stiffness: float | None = None,
    speed: float | None = None,
    experiments: Iterable[str] | None = None,
    progress: Callable[[str, int, int], None] | bool | None = None,
) -> Any:
    r"""Test a friction law by itself: the standard experiments of the friction literature, with numbers and curves.

    Friction against velocity, steady and while it rises and falls (frictional lag); pre-sliding hysteresis with reversal points; loss per
    cycle; break-away force against force rate; stick-slip of a mass pulled by a spring; drift below break-away. Velocities, displacements
    and forces are chosen as typical of the law, and are listed in ``conditions`` of each experiment.

    In the first four the motion of the contact is prescribed and the law is evaluated as written; the last three are mechanisms solved by
    `stickslip.solve`, whose kernels are compiled once for each law that has inner states.

    Parameters
    ----------
    law : law, its class or its name, or a list of them
        For a class or a name its example is taken.
    load : float
        Normal force [N].
    mass : float
        Mass that is pulled by the spring or driven by the force [kg].
    stiffness, speed : float, optional
        Spring stiffness [N/m] and speed of its end [m/s] in the stick-slip experiment; if not given, 2 N/m (for a law that is solved
        in plain Python, one twentieth of the contact stiffness), and 0.05 force / sqrt(stiffness mass).
    experiments : list of str, optional
        Which of `EXPERIMENTS`; all of them if not given.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with (current experiment, experiments done, number of experiments).

    Returns
    -------
    Bench or Benches
        A `Bench` for one law, `Benches` for a list.

    References
    ----------
    C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, A new model for control of systems with friction,
    IEEE Trans. Automatic Control 40 (1995) 419-425;
    P. Dupont, V. Hayward, B. Armstrong, F. Altpeter, Single state elastoplastic friction models,
    IEEE Trans. Automatic Control 47 (2002) 787-792.

    Examples
    --------
    >>> import stickslip as ss
    >>> found = ss.bench(ss.Coulomb(mu_plus=0.15, mu_minus=0.21, f_plus=0.18, f_minus=0.24))
    >>> found.numbers["stick_slip"], found.numbers["drift"]
    (True, 0.0)
    >>> found["hysteresis"].numbers[1].text()
    '1.08e-06 J'
    """
    many = isinstance(law, (list, tuple))
    laws = _laws(law if many else [law])
    names = _names(experiments)
    _check(load, mass, stiffness, speed)
    results: list[Bench] = []
    report = reporting(progress, "bench")
    whole = len(laws) * len(names)
    measured: list[list[Experiment]] = []
    with partial_result() as ending:
        for one in laws:
            setup = Setup(one, float(load), float(mass), stiffness, speed)
            measured.append([])
            for name in names:
                report(f"{type(one).__name__}: {name}", (len(measured) - 1) * len(names) + len(measured[-1]), whole)
                look()
                with finite(one):
                    measured[-1].append(EXPERIMENTS[name](setup))
        report("measured", whole, whole)
    ending.needs(any(measured))
    for one, done in zip(laws, filter(None, measured), strict=False):
        early = [ending.note(f"{len(done)} of {len(names)} experiments are measured")] if len(done) < len(names) else []
        law = adapted(one)
        remarks = (*early, *law.notes(float(load)), *law.cautions(float(load)))
        results.append(Bench(one, float(load), float(mass), tuple(done), remarks))
    return Benches(tuple(results)) if many else results[0]


def _laws(given: Iterable[Any]) -> list[Any]:
    """Laws from laws, classes and names; all errors are reported together."""
    problems, laws = Problems("bench"), []
    for law in given:
        if isinstance(law, str) and law.lower() not in LAWS:
            problems.add(f"{law!r} is not a law; {did_you_mean(law.lower(), LAWS)}")
            continue
        law = LAWS[law.lower()] if isinstance(law, str) else law
        law = law.example() if isinstance(law, type) and hasattr(law, "example") else law
        check_law(law, problems, "ss.bench(ss.Coulomb(mu_plus=0.15, mu_minus=0.21))")
        if dataclasses.is_dataclass(law) and not isinstance(law, type):
            many = [name for name, value in leaves(law) if is_array(value)]
            if many:
                problems.add(f"{', '.join(many)} of {type(law).__name__} are arrays; allowed is one law, no batch; take one case of it")
        laws.append(law)
    if not laws:
        problems.add(f"no law is given; type for example ss.bench('lugre'); known: {', '.join(LAWS)}")
    problems.check()
    return laws


def _names(given: Iterable[str] | None) -> list[str]:
    """The selected experiments, in the order of `EXPERIMENTS`."""
    if given is None:
        return list(EXPERIMENTS)
    asked, problems = [given] if isinstance(given, str) else list(given), Problems("bench")
    for name in asked:
        if name not in EXPERIMENTS:
            problems.add(f"{name!r} is not an experiment; {did_you_mean(str(name), EXPERIMENTS)}")
    if not asked:
        problems.add(f"experiments is empty; known: {', '.join(EXPERIMENTS)}")
    problems.check()
    return [name for name in EXPERIMENTS if name in asked]


def _check(load: Any, mass: Any, stiffness: Any, speed: Any) -> None:
    problems = Problems("bench")
    units = {"load": (load, "N"), "mass": (mass, "kg"), "stiffness": (stiffness, "N/m"), "speed": (speed, "m/s")}
    for name, (value, unit) in units.items():
        if value is None and name in ("stiffness", "speed"):
            continue
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 < value < float("inf"):
            problems.add(f"{name} = {value!r}; allowed is a positive number [{unit}]; type for example {name}=1.0")
    problems.check()
