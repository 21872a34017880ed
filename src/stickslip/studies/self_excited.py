"""Columns of sweeps over models without a period that are left time to settle: how long a cycle takes, how far it swings, what sticks."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from stickslip.analysis.flow_motion import FlowMotion, flow_motion
from stickslip.analysis.oscillation import Oscillation, oscillation
from stickslip.basics.batch import cases_of, shape_of
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, Problems, StickslipError
from stickslip.basics.interruption import look
from stickslip.basics.status import Status
from stickslip.basics.typed_numbers import in_seconds
from stickslip.solvers.named_events import event_columns, events_of_model, lacking_columns
from stickslip.studies.models_of_points import starts_at

#: Columns that only cycles of models without a period have.
OF_CYCLES = ("duration", "body_amplitude")
_STILL = 1e-9  # of the range of the velocity: a mean velocity below it is rounding


def settled_after(what: str, model: Any, settle: Any, duration: Any) -> float | None:
    """The time that runs of a model without a period are left to settle [s], checked; None where its motions are not asked for."""
    if model is None or model.period is not None or settle is None or (isinstance(settle, str) and settle == "auto"):
        return None
    problems = Problems(what)
    given, length = in_seconds(settle, problems), in_seconds(duration, problems)
    problems.check()
    numbers = all(isinstance(each, (int, float, np.integer, np.floating)) and not isinstance(each, bool) for each in (given, length))
    if not numbers or not 0.0 <= given < length:
        allowed = f"of a model without a period it is a time [s] from 0 below duration = {duration!r}"
        raise InputError(what, [f"settle = {settle!r}; {allowed}; type for example duration=200, settle=100"])
    return float(given)


def motion_columns(
    robot: Model, start: dict[str, Any], options: dict[str, Any], settle: float, status: Array, events: Any = None
) -> dict[str, Array]:
    """What the cases of a batch of machines do after they have settled: columns by name, NaN where a case was not solved.

    With a user's events also their first instants and numbers, over the whole run.
    """
    watched = events_of_model("sweep", robot, events)
    located = [lacking_columns(watched) for _ in range(np.size(status))]
    cases = cases_of(robot) if shape_of(robot) else [robot]
    motions = [
        _motion(case, starts_at(start, np.array(k)), options, settle, watched, located[k]) if good else None
        for k, (case, good) in enumerate(zip(cases, np.ravel(status) <= Status.REPEATS, strict=True))
    ]
    first = next((motion for motion in motions if motion is not None), None)
    of_events = {name: np.array([row[name] for row in located]) for name in lacking_columns(watched)}
    if first is None:
        return of_events
    bodies, contacts = list(first.amplitudes), list(first.contacts)
    of_bodies = {"body_amplitude": lambda m, b: m.amplitudes[b], **{f"velocity_{e}": _extreme(k) for k, e in enumerate(("min", "max"))}}
    of_contacts = {name: _of_contact(name) for name in ("stick_fraction", "forward_fraction", "backward_fraction", "pattern")}
    of_contacts |= {"motion_type": _word, "margin": lambda m, c: np.nan}
    columns: dict[str, Array] = {
        "period": np.array([0 if m is None or m.period is None else m.period for m in motions], "i2"),
        "duration": np.array([np.nan if m is None else m.duration for m in motions]),
        "mean_velocity": np.array([np.nan if m is None else m.mean_velocity for m in motions]),
    }
    for names, own in ((bodies, of_bodies), (contacts, of_contacts)):
        for name, value in own.items():
            lacking: Any = {"pattern": "", "motion_type": "unsolved"}.get(name, np.nan)
            if names:
                columns[name] = np.array([[lacking if m is None else value(m, each) for each in names] for m in motions])
    columns["direction"] = _directions(columns)
    return columns | of_events


def _directions(columns: dict[str, Array]) -> Array:
    """Of each contact +1 or -1 where it slips one way only, else as the machine moves on."""
    if "forward_fraction" not in columns:
        return np.zeros((len(columns["period"]), 0), "i1")
    V, swing = columns["mean_velocity"], np.max(columns["velocity_max"] - columns["velocity_min"], axis=1)
    net = np.where(abs(V) > _STILL * swing, np.sign(np.nan_to_num(V)), 0.0)[:, None]
    ahead, back = columns["forward_fraction"] > 0, columns["backward_fraction"] > 0
    return np.where(ahead == back, net, np.where(ahead, 1.0, -1.0)).astype("i1")


def _motion(
    case: Any, start: dict[str, Any], options: dict[str, Any], settle: float, watched: dict[str, Any], located: dict[str, Any]
) -> Oscillation | None:
    """The motion of one case after it has settled; what is known of events is written into `located`."""
    from stickslip.solvers import solve

    look()
    how = {name: options[name] for name in ("duration", "rtol", "method")}
    try:
        run = solve(case, start=start or None, keep="trajectory", **how)
        located.update(event_columns(run, watched))
        return oscillation(run, options["slip_ratio"], options["dwell"], settle)
    except StickslipError:
        return None


def _extreme(which: int) -> Any:
    return lambda m, body: m.velocity_ranges[body][which]


def _of_contact(name: str) -> Any:
    return lambda m, contact: getattr(m.contacts[contact], name)


def _word(m: Oscillation, contact: str) -> str:
    """What a contact does: that of the motion where it is not a cycle."""
    if m.type in ("steady", "not settled"):
        return m.type
    return "stick-slip" if m.contacts[contact].stick_fraction > 0 else "slip"


def flow_motion_columns(run: Any, settle: float) -> dict[str, Any]:
    """The same of a run of a flow, with the fraction of the time in each mode."""
    m: FlowMotion = flow_motion(run, settle)
    columns: dict[str, Any] = {"motion_type": m.type, "period": m.period or 0, "duration": m.duration}
    columns |= {f"amplitude_{name}": size for name, size in m.amplitudes.items()}
    return columns | {f"fraction_{mode}": m.modes.get(mode, 0.0) for mode in run.model.modes}


def names_of_cycles(columns: Iterable[str], modes: Iterable[Any]) -> tuple[str, ...]:
    """Their names, for a flow with these columns and modes."""
    known = tuple(columns)
    states = [name for name in (each.partition("_")[2] for each in known if each.startswith("end_")) if f"max_{name}" in known]
    return ("period", "motion_type", "duration", *(f"amplitude_{name}" for name in states), *(f"fraction_{mode}" for mode in modes))
