"""`fit`: from a file to the numbers of a friction law in one call."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from stickslip.basics.arguments import explains_arguments
from stickslip.basics.errors import InputError, StickslipError, did_you_mean
from stickslip.basics.progress import progress_callback
from stickslip.inverse.identification.ranking import UNDECIDED, Ranking, rank
from stickslip.inverse.identification.uncertainty import calibrations, faults
from stickslip.inverse.logs.log_fit import LogFit
from stickslip.inverse.logs.machines import Kind, Task
from stickslip.inverse.logs.plan import Plan, plan_of
from stickslip.inverse.logs.proposals import Proposal, of_numbers
from stickslip.records import Record, read

_MOST = 6000  # samples on which laws are compared


@explains_arguments
def fit(
    file: Any,
    *,
    machine: str | None = None,
    law: str | None = None,
    numbers: dict[str, Any] | None = None,
    asymmetric: bool = False,
    units: dict[str, str] | None = None,
    roles: dict[str, str] | None = None,
    sensor: dict[str, Any] | None = None,
    starts: int = 16,
    progress: Callable[[str, int, int], Any] | bool | None = None,
    **reading: Any,
) -> LogFit:
    """Fit friction laws to a file: roles, units, machine and law are proposed, and what was decided is in the result.

    The machine follows from what was measured: a force over a motion is a friction rig, a torque or a current over an angle a joint, a
    commanded angle beside the measured one a servo, a velocity alone a shaken robot. Tables without times are known too: forces over
    speeds are a bench, and mean speeds over amplitude and frequency a shaken robot. Laws are compared by `ss.identification.rank`, and
    one coefficient is that of both directions unless `asymmetric`.

    Parameters
    ----------
    file : str, Path, Record, data frame, or a list of them
        One file, or several of the same machine.
    machine : {"rig", "slider", "joint", "servo", "robot", "bench", "speeds"}, optional
        The kind of machine, where the file leaves it open.
    law : str, optional
        One law instead of a comparison: "coulomb", "coulomb-viscous", "stribeck", "dahl" or "lugre"; of a robot "coulomb",
        "coulomb-static" or "lugre"; of a servo by its command "m1" to "m6", the models of BAM (`stickslip.machines.ServoLoad`).
    numbers : dict, optional
        What is known of the machine, in SI units or with a unit: ``{"load": 20.0}``, ``{"amplitude": "0.5 mm", "tilt_deg": 1.7}``,
        ``{"motor_constant": 0.05}``; of shaken robots a list has one for each file: ``{"amplitude": [5e-4, 8e-4], "tilt_deg": 1.7}``.
    asymmetric : bool
        A coefficient for each direction.
    units, roles : dict, optional
        As for `read`.
    sensor : dict, optional
        As for `identify`.
    starts : int
        Starting points of each search.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with (what is fitted, starts done, in all), such as
        ("joint with lugre: starts", 3, 17).
    **reading
        What else `read` takes, such as ``columns``, ``rate``, ``separator`` and ``decimal``.

    Returns
    -------
    LogFit

    Raises
    ------
    InputError
        Units are missing, the file suits no machine, or a number is needed; with the line to type.

    Examples
    --------
    >>> import numpy as np, stickslip as ss
    >>> t = np.arange(0, 4, 0.005)
    >>> F = 2.0 * np.sign(np.cos(3 * t)) + np.random.default_rng(0).normal(0, 0.05, len(t))
    >>> log = {"time_s": t, "pos_mm": 5.0 * np.sin(3 * t), "F_N": F}
    >>> result = ss.fit(log, law="coulomb", starts=2)
    >>> result.machine, round(result.values["mu"], 1), result.supported
    ('rig', 2.0, True)
    >>> print(result.python)
    import stickslip as ss
    ...
    """
    files, units, roles, given = list(file) if isinstance(file, (list, tuple)) else [file], units or {}, roles or {}, dict(numbers or {})
    records = [each if isinstance(each, Record) else read(each, units=units, roles=roles, **reading) for each in files]
    plan = plan_of(records, units, roles, machine, given)
    readings = [written(each, units, roles | plan.joint.roles, reading) for each in files]
    return fit_plan(plan, readings, law, asymmetric, sensor, starts, progress)


def fit_plan(
    plan: Plan, readings: Sequence[str], law: str | None = None, asymmetric: bool = False, sensor: dict[str, Any] | None = None,
    starts: int = 16, progress: Any = None,
) -> LogFit:  # fmt: skip
    """The fit of a plan; `readings` says for each record how it is read, as Python, and the rest is as for `fit`."""
    kind, why, records, given = plan.checked(), plan.why, plan.records, plan.given
    step = _step(records) if law is None and kind.over_motion else 1
    search = _Search([every(rec, step) for rec in records], given, asymmetric, sensor, starts, progress)
    fits, tasks, ranking, best = _laws(kind, search, law)
    questions: list[str] = []
    for other in plan.rivals:
        another = search.tried(other, best)[1]
        apart = _apart(fits[best], another)
        if faults(fits[best]) and not faults(another):
            why, kind = f"what is left of a {kind.name} is not noise, that of a {other.name} is", other
            fits, tasks, ranking, best = _laws(other, search, law)
        elif apart < UNDECIDED:
            how = f"fits better, by ΔAICc {-apart:.3g}" if apart < -UNDECIDED else f"fits as well: ΔAICc {apart:.2g}"
            questions.append(f'machine="{other.name}" ({other.words}) {how}; the {kind.name} has fewer numbers')
    if step > 1:
        tasks[best], fits[best] = replace(search, records=[*records]).tried(kind, best)
    proposals = [*plan.channels, *of_numbers(given, kind.assumed(records, given))]
    able = [name for name in plan.able if name != kind.name]
    what = kind.words.partition(":")[0]
    proposals.append(Proposal("machine", f"{kind.name}: {what}", why, f"--machine {' or '.join(able) or 'NAME'}"))
    part = f", compared on one sample of {step}" if step > 1 else ""
    proposals.append(Proposal("law", best, "typed" if law else f"of {', '.join(fits)}{part}", "--law NAME"))
    sides = "a coefficient for each direction" if asymmetric else "one coefficient for both directions"
    proposals.append(Proposal("symmetry", sides, "typed" if asymmetric else "unless asked", "" if asymmetric else "--asymmetric"))
    chosen = fits[best]
    doubt = kind.doubt(records, given) if faults(chosen) and not asymmetric else ""
    questions += [doubt] if doubt else []
    notes = tuple(
        dict.fromkeys(f"{'' if len(records) == 1 else f'record {i}: '}{note}" for i, rec in enumerate(records) for note in rec.notes)
    )
    measure = tuple(_next(chosen, kind))
    return LogFit(
        kind.name, best, tuple(proposals), fits, tasks, ranking, tuple(readings), tuple(questions), measure, notes,
    )  # fmt: skip


def _step(records: Sequence[Record]) -> int:
    """Every how many-th sample laws are compared on: on some thousands, which is enough to tell them apart."""
    return max(-(-max(len(c) for rec in records for c in rec.channels.values() if c.role is not None) // _MOST), 1)


def every(rec: Record, step: int) -> Record:
    """Every so many-th sample of a record.

    Examples
    --------
    >>> rec = read({"t [s]": [0.0, 0.1, 0.2, 0.3], "v [m/s]": [1.0, 2.0, 3.0, 4.0]})
    >>> every(rec, 2)["v"].values.tolist()
    [1.0, 3.0]
    """
    if step == 1:
        return rec
    thinned = {name: replace(c, values=c.values[::step], t=c.t[::step]) for name, c in rec.channels.items()}
    return rec.replace(channels=thinned)


@dataclass(frozen=True)
class _Search:
    """What all fits of some records have in common."""

    records: list[Record]
    given: dict[str, Any]
    asymmetric: bool
    sensor: dict[str, Any] | None
    starts: int
    progress: Any

    def tried(self, kind: Kind, law: str) -> tuple[Task, Any]:
        """A law on a kind of machine: how it is fitted, and the fit."""
        made = kind.task(self.records, law, self.given, self.asymmetric)
        mass = {name: None for name in made.options.get("sensor", {}) if name == "inertia"}  # a number of the machine
        sensor = {} if self.sensor is None else {"sensor": mass | self.sensor}
        task = replace(made, options=made.options | sensor | {"starts": self.starts})
        call = progress_callback(self.progress, "fit")
        return task, task(self.records, progress=call and partial(call, f"{kind.name} with {law}: starts"))


def _apart(one: Any, other: Any) -> float:
    """By how much the AICc of another fit is above that of one."""
    rows = {row.label: row.aicc for row in rank({"one": one, "other": other}).rows}
    return float(rows["other"] - rows["one"])


def _laws(kind: Kind, search: _Search, law: str | None) -> tuple[dict[str, Any], dict[str, Task], Ranking | None, str]:
    """Fits of the laws, how each was made, their ranking, and the one to report."""
    known = (*kind.laws, *kind.richer)
    if law is not None and law not in known:
        raise InputError("fit", [f"law = {law!r}; {did_you_mean(law, known)}"])
    each = {name: search.tried(kind, name) for name in ((law,) if law else kind.laws)}
    ranking = None if law else rank({name: fit for name, (_, fit) in each.items()})
    if ranking is not None and not ranking.supported and kind.richer:
        each |= {name: search.tried(kind, name) for name in kind.richer}
        ranking = rank({name: fit for name, (_, fit) in each.items()})
    tasks, fits = {name: task for name, (task, _) in each.items()}, {name: fit for name, (_, fit) in each.items()}
    if ranking is None:
        return fits, tasks, None, str(law)
    alike = ranking.supported or tuple(row.label for row in ranking.rows if row.aicc < UNDECIDED)
    return fits, tasks, ranking, min(alike, key=lambda label: fits[label].fitted)


def _next(chosen: Any, kind: Kind) -> list[str]:
    """What to measure next for the numbers that the record does not determine, or only poorly."""
    own = calibrations(chosen)
    poor = [name for name, error in chosen.errors.items() if name in chosen.undetermined or error > 0.2 * abs(chosen.values[name])]
    if not poor or not kind.advises:
        return own
    _, x, v = chosen.problem.targets[0].moved(chosen.predicted[0])
    stroke, speed = float(max(x) - min(x)), float(max(abs(v)))
    if not stroke > 0 or not speed > 0:
        return own
    hertz = speed / (math.pi * stroke)
    choices = [{"stroke": float(f"{stroke * s:.2g}"), "frequency": float(f"{hertz * f:.2g}")} for s in (1.0, 3.0) for f in (0.1, 1.0, 5.0)]
    try:
        plan = chosen.next_experiment(choices, samples=600)
    except StickslipError:
        return own
    return [*own, f"for {', '.join(poor)}: {plan.notes[0]}"]


def written(file: Any, units: dict[str, str], roles: dict[str, str], reading: dict[str, Any]) -> str:
    """How a file is read, as Python; a record that was given is a name."""
    if isinstance(file, Record):
        return "ss.read(path)" if "path" not in file.source else f"ss.read({str(file.source['path'])!r})"
    named = {"units": units, "roles": roles} | reading
    options = "".join(f", {name}={value!r}" for name, value in named.items() if value)
    return f"ss.read({str(file)!r}{options})" if isinstance(file, str) or hasattr(file, "__fspath__") else f"ss.read(table{options})"
