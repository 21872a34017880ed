"""`compare`: a record beside what several laws give, the drive's phase aligned."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.analysis.motion import coulomb_twin, motion
from stickslip.analysis.steady import mean_velocity
from stickslip.basics.arguments import Law, Model, described_as, explains_arguments
from stickslip.basics.errors import InputError, Problems, did_you_mean
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import interruptible, look, partial_result
from stickslip.basics.lazy_names import typed_name
from stickslip.basics.notebook_display import Drawn, Text
from stickslip.basics.presenting import presenter
from stickslip.basics.progress import Reported, reporting
from stickslip.inverse.identification.fitted_laws import SOUGHT, with_fitted_law
from stickslip.inverse.identification.steady_curves import SteadyCurve, steady_curve
from stickslip.inverse.identification.steady_problem import best_phase, modelled_values
from stickslip.inverse.identification.targets import Target, target
from stickslip.models.friction import LAWS
from stickslip.models.friction.law_adapter import law_of
from stickslip.records import Record
from stickslip.records.motion_type import motion as measured_motion
from stickslip.records.settling import settled

_PHASES = 400


@sealed
@dataclass(frozen=True, eq=False)
class ComparisonRow:
    """One law, or the record itself, over one motion period.

    Parameters
    ----------
    label : str
    mean_velocity : float
        [m/s]
    type, pattern : str
        Motion type and signs of the velocity.
    rms : float
        Root mean square of law less record over all samples [m/s or m]; NaN for the record.
    r2 : float
        Part of the record's variance that the law explains.
    events : tuple of (phase, kind)
        When the body sticks, slips or reverses, in drive periods after the drive's zero crossing (model's phase).
    phase, value : arrays
        The curve: drive phase and velocity (or position) [m/s or m].
    model : Robot or None
    """

    label: str
    mean_velocity: float
    type: str
    pattern: str
    rms: float
    r2: float
    events: tuple[tuple[float, str], ...]
    phase: Any
    value: Any
    model: Any = None


@described_as("a comparison; type for example ss.compare(record, robot)")
@sealed
@dataclass(frozen=True, eq=False, repr=False)
class Comparison(Drawn):
    """A record and several laws, as rows: `record` first, then the laws in the order in which they were given.

    Parameters
    ----------
    record : Row
        What was measured: the mean cycle, on the phase of the law that fits best.
    laws : tuple of Row
    noise : float
        Of the record [m/s or m].
    kind : {"velocity", "position"}
    samples : tuple of arrays
        Phase and value of every sample.
    notes : tuple of str
    source : Record
        What was compared, whole.
    """

    record: ComparisonRow
    laws: tuple[ComparisonRow, ...]
    noise: float
    kind: str
    samples: tuple[Any, Any]
    notes: tuple[str, ...]
    source: Any = None

    def __getitem__(self, label: str) -> ComparisonRow:
        """The row of this label."""
        rows = {row.label: row for row in (self.record, *self.laws)}
        if label not in rows:
            raise InputError("comparison", [f"has no {label!r}; {did_you_mean(label, rows)}"])
        return rows[label]

    @property
    def best(self) -> ComparisonRow:
        """The law with the smallest rms over the cycle."""
        return min(self.laws, key=lambda row: row.rms)

    def to_table(self) -> list[dict[str, Any]]:
        """One dict of numbers and words for each row."""
        names = ("label", "mean_velocity", "type", "pattern", "rms", "r2", "events")
        return [{name: getattr(row, name) for name in names} for row in (self.record, *self.laws)]

    _drawn_by = "comparison"

    @property
    def _unit(self) -> str:
        return "m/s" if self.kind == "velocity" else "m"

    def _title(self) -> str:
        return f"Over the cycle {self.best.label} is closest"

    def _tables(self) -> list[list[tuple[str, ...]]]:
        head = ("", "mean velocity [m/s]", "type", f"rms [{self._unit}]", "R²")
        return [[head, *map(_cells, (self.record, *self.laws))]]

    def report(self, path: Any = None) -> Any:
        """The comparison as text; with a path as one HTML file."""
        if path is None:
            return Text(str(self))
        return presenter("report", "fit")(path, [], comparison=self)

    def __str__(self) -> str:
        head, *rows = self._tables()[0]
        widths = (max(len(row[0]) for row in rows), 19, 10, 11)
        lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, (*widths, 0), strict=True)).rstrip() for row in (head, *rows)]
        lines.append(f"noise of the record {self.noise:.3g} {self._unit}; over the cycle {self.best.label} is closest")
        return "\n".join([*lines, *(f"note: {note}" for note in self.notes)])

    __repr__ = __str__


def _cells(row: ComparisonRow) -> tuple[str, ...]:
    """A row of the table of a notebook."""
    rest = ("", "") if np.isnan(row.rms) else (f"{row.rms:.4g}", f"{row.r2:.5f}")
    return (row.label, f"{row.mean_velocity:.7g}", row.type, *rest)


@explains_arguments
@interruptible
def compare(
    record: Record,
    robot: Model,
    laws: Sequence[str | Law] | dict[str, Any] | None = None,
    *,
    using: str = "auto",
    frequency: float | None = None,
    noise: float | None = None,
    settle: int | str = "auto",
    rtol: float = 1e-8,
    progress: Reported | bool | None = None,
) -> Comparison:
    """Compare a record with several friction laws for one robot: curves aligned in phase, mean velocities, rms, events and motion types.

    Each law's curve is shifted in the drive's phase until it fits the record best; nothing else of it is fitted, except for laws that are
    named and whose numbers the robot does not have: those are fitted to the record, by an ideal sensor, and a note says so.

    Parameters
    ----------
    record : Record
    robot : Robot
        The robot that was measured.
    laws : list, or dict of label -> law, optional
        Laws; or names: that of the robot's own law, or "coulomb" for Coulomb friction at the robot's kinetic coefficients (Eq. 2.4). A
        complete robot may be given instead of a law. None is these two: the laws whose numbers the robot has. Of "coulomb",
        "coulombviscous", "stribeck", "dahl" and "lugre" the numbers are fitted to the record where the robot does not have them.
    using : {"auto", "velocity", "position"}
    frequency : float, optional
        Drive frequency [Hz]; otherwise it is refined from the record.
    noise : float, optional
        Standard deviation of one sample [SI].
    settle : int or "auto"
        Drive periods at the start of the record that are left out; "auto" finds those that differ from the later ones, and a note says so.
    rtol : float
        Relative tolerance of the solver.
    progress : callable or bool, optional
        True for a progress line, or a function that is called with (law, laws done, in all).

    Returns
    -------
    Comparison

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=4.7, amplitude=4.58e-4)
    >>> found = ss.compare(ss.virtual_rig(robot, noise=1e-5, seed=1), robot, laws=["coulomb", "lugre"])
    >>> found.best.label, found["Coulomb"].type, found["LuGre"].r2 > 0.9999
    ('LuGre', 'II', True)
    """
    how = {"using": using, "frequency": frequency, "noise": noise, "settle": settle, "rtol": rtol}
    robots, fitted = _robots(record, robot, laws, how)
    whole = record
    record, _, said = settled(record, settle, frequency)
    measured_target = target(record, using, noise, frequency, "record", 0)
    curves, report = {}, reporting(progress, "compare")
    with partial_result() as ending:
        for done, (label, model) in enumerate(robots.items()):
            report(label, done, len(robots))
            look()
            curves[label] = steady_curve(model, None, rtol)
        report("all laws", len(robots), len(robots))
    ending.needs(curves)
    shifts = {label: best_phase(measured_target, curve) for label, curve in curves.items()}
    rows = tuple(_row(label, robots[label], curve, measured_target, shifts[label]) for label, curve in curves.items())
    best = min(rows, key=lambda row: row.rms).label
    measured = _measured(record, measured_target, shifts[best])
    early = [ending.note(f"{len(curves)} of {len(robots)} laws are compared")] if ending.interrupted else []
    notes = [*early, *fitted, *_notes(record, robot, measured_target, curves), *_words(measured, rows)]
    return Comparison(
        measured, rows, measured_target.sigma, measured_target.kind,
        (np.mod(measured_target.phase + shifts[best], 1.0), measured_target.y), (*filter(None, (said, measured_target.cut)), *notes), whole,
    )  # fmt: skip


def _robots(record: Record, robot: Model, laws: Any, how: dict[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """The robots with each law by their labels, and a sentence for each law that was fitted; `how` says what is compared."""
    problems, notes = Problems("compare"), list[str]()
    robots: dict[str, Any] = {}
    if not isinstance(record, Record):
        problems.add(f"record = {record!r}; allowed is a Record; type for example ss.read(path)")
    if not (hasattr(robot, "friction") and hasattr(robot, "replace")):
        raise InputError(
            "compare",
            [*problems.mistakes, f"robot = {robot!r}; allowed is a Robot; type ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4)"],
        )
    laws = _with_numbers(robot) if laws is None else laws
    pairs = list(laws.items()) if isinstance(laws, dict) else [(None, law) for law in ([laws] if isinstance(laws, str) else laws)]
    models = [(label, _with_law(robot, law, problems)) for label, law in pairs]
    if not pairs:
        problems.add('laws is empty; type for example laws=["coulomb", "lugre"]')
    problems.check()
    for label, model in models:
        if isinstance(model, type):
            model, said = with_fitted_law(model, robot, record, **how)
            notes.append(said)
        name = label or law_of(model).name
        robots[name if name not in robots else f"{name} ({len(robots) + 1})"] = model
    return robots, notes


def _with_numbers(robot: Any) -> list[Any]:
    """The laws whose numbers a robot has: Coulomb friction at its kinetic coefficients, where it has any, and its own."""
    twin = coulomb_twin(robot)
    return [robot] if twin is None or twin == robot else [twin, robot]


def _with_law(robot: Any, law: Any, problems: Problems) -> Any:
    """The robot with a law; the class of a law whose numbers are to be fitted."""
    own = type(robot.friction).__name__.lower()
    if hasattr(law, "friction"):
        return law
    if not isinstance(law, str):
        return robot.replace(friction=law)
    if law.lower() == own:
        return robot
    twin = coulomb_twin(robot) if law.lower() == "coulomb" else None
    if twin is not None:
        return twin
    cls = LAWS.get(law.lower())
    if cls is None:
        problems.add(f"laws names {law!r}; {did_you_mean(law, LAWS)}")
    elif cls not in SOUGHT:
        problems.add(
            f"laws names {law!r}, whose numbers the robot (with {own}) does not have; "
            f"give the law itself, with its numbers: laws=[{typed_name(cls.__name__)}(...)] in Python"
        )
    return cls


def _row(label: str, model: Model, curve: SteadyCurve, target_of: Target, shift: float) -> ComparisonRow:
    rest = modelled_values(target_of, curve, target_of.phase + shift) - target_of.y
    spread, square = target_of.mean_square(target_of.y - np.average(target_of.y, weights=target_of.weight)), target_of.mean_square(rest)
    phase = np.arange(_PHASES * curve.period) / _PHASES
    value = curve.v(phase) if target_of.kind == "velocity" else curve.x(phase)
    m = motion(curve.run)
    return ComparisonRow(
        label, curve.mean_velocity, m.type, m.pattern, float(np.sqrt(square)), 1 - square / spread, _events(curve), phase, value, model
    )


def _events(curve: SteadyCurve) -> tuple[tuple[float, str], ...]:
    """Changes of mode in the last motion period, by phase."""
    T, start = curve.run.period_time, float(curve.run.strobe_times[-1 - curve.period])
    changes = [((e.t - start) / T, e.kind) for e in curve.run.events if e.t >= start]
    return tuple((float(phase), kind) for phase, kind in changes)


def _measured(record: Record, target_of: Target, shift: float) -> ComparisonRow:
    """The record's own row: its mean cycle, over one motion period, on the phase of the best law."""
    bins = int(np.clip(target_of.count / 12, 24, _PHASES)) * target_of.period
    turn = np.mod((target_of.phase + shift) / target_of.period, 1.0)
    index = np.minimum((turn * bins).astype(int), bins - 1)
    count = np.bincount(index, target_of.weight * np.ones(target_of.count), bins)
    mean = np.bincount(index, target_of.weight * target_of.y, bins) / np.where(count > 0, count, np.nan)
    m, V = measured_motion(record, target_of.frequency), mean_velocity(record, frequency=target_of.frequency)
    first = -float(shift)
    events = tuple((float(np.mod(start - first, target_of.period)), "stick") for start, _, sign in m.intervals if sign == 0)
    phase = (np.arange(bins) + 0.5) / bins * target_of.period
    return ComparisonRow("record", V, m.type, m.pattern, float("nan"), float("nan"), events, phase, mean)


def _notes(record: Record, robot: Model, target_of: Target, curves: dict[str, SteadyCurve]) -> list[str]:
    notes = ["the record is synthetic"] if record.synthetic else []
    given = 1 / float(robot.period)
    if abs(target_of.frequency / given - 1) > 1e-3:
        notes.append(f"the record's drive frequency is {target_of.frequency:.6g} Hz and the robot's {given:.6g} Hz; compared by phase")
    notes += [f"{label}: the motion does not repeat within the run" for label, curve in curves.items() if not curve.settled]
    return notes


def _words(measured: ComparisonRow, rows: tuple[ComparisonRow, ...]) -> list[str]:
    """Why a record and a law that fits it may have two words for one motion."""
    other = [f"{row.label} {row.type}" for row in rows if law_of(row.model).dynamic and row.type != measured.type]
    if not other:
        return []
    rule = "a record counts as at rest below a speed, a law with inner states below a part of its sliding force"
    return [f"the record's type is {measured.type}, {', '.join(other)}: {rule}, so one motion may get two types; judge by rms and R²"]
