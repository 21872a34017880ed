"""Certain digits of an answer: several methods (judges) solve the same robot, and the digits on which they agree are counted."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any, ClassVar

from stickslip.analysis.energy import energy
from stickslip.analysis.flow_check import check_flow_run
from stickslip.analysis.steady import closed_mean_velocity, mean_velocity, period_number
from stickslip.analysis.verdict import RK4, certain_digits, finding, naive, transient_words
from stickslip.basics.arguments import Model, described_as, explains_arguments
from stickslip.basics.batch import shape_of
from stickslip.basics.errors import InputError, Problems, SolveError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import interruptible, look, partial_result
from stickslip.basics.notebook_display import Drawn
from stickslip.basics.progress import reporting
from stickslip.models.machine_adapter import machine_of
from stickslip.models.model_adapter import adapter_of, is_model
from stickslip.solvers import rk4, solve
from stickslip.solvers.closed_arcs import handles

#: Steps per period of the fixed-step judges.
RK4_STEPS = (2000, 10_000, 50_000)
#: Method, drive periods and tolerance of SciPy's judge, with inner states and without; few periods, because it runs plain Python.
#: LSODA takes half of Radau's time for the presets' bristles, and no more for bristles a hundred times as stiff.
SCIPY = {True: ("lsoda", 6, 1e-11), False: ("dop853", 12, 1e-11)}
#: Tolerances of the ladder, relative to the one that is assessed.
LADDER = (1.0, 0.1, 1e-2, 1e-4)
_TIGHTEST = 1e-12
_REFERENCE = "the reference"


@dataclass(frozen=True)
class Judge:
    """One run of one method.

    Parameters
    ----------
    name : str
        Name of the method.
    setting : str
        Its tolerance or step.
    periods : int
        Drive periods.
    mean_velocity : float
        Over the second half of them [m/s]; NaN if it failed.
    difference : float
        From the reference with the same number of periods [m/s].
    seconds : float
        Computing time on this machine.
    counts : bool
        Whether it limits the number of certain digits.
    remark : str
        Why it failed or was skipped, or what it is compared with.
    """

    name: str
    setting: str
    periods: int
    mean_velocity: float
    difference: float
    seconds: float
    counts: bool = True
    remark: str = ""


@described_as("what ss.check returns; type ss.check(robot)")
@sealed
@dataclass(frozen=True)
class Check(Drawn):
    """Results of `check`; `print` shows them as a table.

    Parameters
    ----------
    mean_velocity : float
        The answer that is assessed [m/s].
    best : float
        The most accurate value found [m/s].
    uncertainty : float
        Largest difference among the judges that count [m/s]; NaN if there is only one.
    digits : int
        Number of certain digits of `mean_velocity`; if `period` is None or `transient` says something, for a run of this length only.
    period : int or None
        Period number of the motion.
    energy : float
        Largest residual of the energy balance of a drive period after settling, relative as in `stickslip.energy`.
    judges : tuple of Judge
    notes : tuple of str
        Remarks on the robot's numbers.
    verdict : str
        Summary in one sentence.
    transient : str
        Of what transient `mean_velocity` is the mean; empty if the motion is steady.
    """

    mean_velocity: float
    best: float
    uncertainty: float
    digits: int
    period: int | None
    energy: float
    judges: tuple[Judge, ...]
    notes: tuple[str, ...]
    verdict: str
    transient: str = ""

    _drawn_by, _inches = "check", (4.4, 2.6)
    compared: ClassVar[str] = "mean velocity (m/s)"

    @property
    def size(self) -> float:
        """That of what is compared [m/s]."""
        return abs(self.mean_velocity) or 1.0

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain numbers and text."""
        return {**asdict(self), "judges": [asdict(judge) for judge in self.judges], "notes": list(self.notes)}

    def rows(self) -> list[tuple[str, ...]]:
        """The judges as rows of text, heading first."""
        head = ("judge", "setting", "periods", "mean velocity [m/s]", "difference [m/s]", "time [s]", "")
        return [head, *(_row(judge) for judge in self.judges)]

    def __str__(self) -> str:
        rows = self.rows()
        widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
        lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
        warned = (
            [f"{self.transient[0].upper()}{self.transient[1:]}; its digits are for a run of this length only.", ""]
            if self.transient
            else []
        )
        return "\n".join([*warned, *lines, "", self._balance(), self.verdict, *self._remarks()])

    def _balance(self) -> str:
        of = f"the largest energy exchanged in {'a period' if self.judges[0].periods else 'the run'}"
        return f"energy balance: worst residual {self.energy:.1e} of {of}"

    def _facts(self) -> dict[str, Any]:
        return {"energy balance": self._balance().partition(": ")[2]}

    def _remarks(self) -> list[str]:
        fixed = any(judge.name == RK4 and judge.periods for judge in self.judges)
        return [*([f"The {RK4} rows show what fixed steps give; they do not count."] if fixed else []), *(f"note: {n}" for n in self.notes)]

    def _title(self) -> str:
        return self.verdict

    def _tables(self) -> list[list[tuple[str, ...]]]:
        return [self.rows()]


def _row(judge: Judge) -> tuple[str, ...]:
    value = f"{judge.mean_velocity:.12e}" if math.isfinite(judge.mean_velocity) else "-"
    difference = f"{judge.difference:+.1e}" if math.isfinite(judge.difference) else "-"
    return judge.name, judge.setting, str(judge.periods or "-"), value, difference, f"{judge.seconds:.2f}", judge.remark


@explains_arguments
@interruptible
def check(
    robot: Model,
    periods: int = 200,
    rtol: float = 1e-6,
    start: dict[str, Any] | None = None,
    rk4_steps: tuple[int, ...] = RK4_STEPS,
    scipy: bool = True,
    progress: Callable[[str, int, int], None] | bool | None = None,
    duration: float | None = None,
) -> Check:
    """Solve one robot by several methods and report how many digits of its mean velocity are certain; of a flow those of its states.

    The answer is the mean velocity over the second half of `periods`, or over the whole run if the model has no period. It is compared with
    tighter tolerances of the same solver, with one of SciPy's integrators and the same law in plain Python over a few periods, for Coulomb
    friction with the closed formula of the periodic motion, and with classical Runge-Kutta with fixed steps. The last is not counted: it
    shows what a hand-written script would give.

    Parameters
    ----------
    robot : Robot, mechanism, machine or SwitchingFlow
        A single one, not a batch. Of a flow the states at the end are compared, after at most 12 periods of its forcing.
    periods : int
        Drive periods.
    rtol : float
        The tolerance that is assessed.
    start : dict
        As for `solve`.
    rk4_steps : tuple of int
        Steps per period of the Runge-Kutta runs, which are possible for robots without impulses or memory and are skipped for others.
    scipy : bool
        Whether to run SciPy's integrator, which takes most of the time.
    progress : callable or bool, optional
        True for a line on the terminal, or a function that is called with (name of the method, methods done, number of methods).
    duration : float, optional
        Duration of the run of a model without a period [s]; the answer is then the mean velocity over the whole run.

    Returns
    -------
    Check or FlowCheck

    Examples
    --------
    >>> import stickslip as ss
    >>> sure = ss.check(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb-static"), periods=100, rk4_steps=(2000,))
    >>> f"{sure.mean_velocity:.6f} m/s", sure.digits >= 8
    ('0.002032 m/s', True)
    """
    _check_arguments(robot, rk4_steps, duration)
    if not adapter_of(robot).has_bodies:
        of_flow: Any = check_flow_run(robot, periods, duration, start)  # type: ignore[arg-type]
        return of_flow
    court = _Court(robot, periods, start, duration)
    dynamic = machine_of(robot).has_inner_states
    tell = _stage_reporter(progress, 1 + scipy + len(rk4_steps))
    tell("our own methods")
    run, judges = court.ladder(rtol) if dynamic else court.exact()
    best = judges[-1].mean_velocity if dynamic else judges[0].mean_velocity
    own = len(judges)
    with partial_result() as ending:
        if scipy:
            tell(f"scipy {SCIPY[dynamic][0]}")
            judges.append(court.scipy(*SCIPY[dynamic], tight=max(1e-4 * rtol, _TIGHTEST)))
        for n in rk4_steps:
            tell(f"Runge-Kutta, {n} steps")
            judges.append(court.judge(RK4, f"{n} per period", best, counts=False, method="rk4", steps=n))
    if ending.interrupted:
        asked = [*([f"scipy {SCIPY[dynamic][0]}"] if scipy else []), *[RK4] * len(rk4_steps)]
        settings = [*([""] if scipy else []), *(f"{n} per period" for n in rk4_steps)]
        done = len(judges) - own
        judges += [_skipped(*pair, ending.words) for pair in list(zip(asked, settings, strict=True))[done:]]
    else:
        tell("done")
    period, balance = period_number(run), energy(run).worst
    answer = judges[0].mean_velocity
    counted = [judge for judge in judges if judge.counts and math.isfinite(judge.difference)]
    alone = all(judge.remark == _REFERENCE for judge in counted) and answer != 0
    uncertainty = math.nan if alone else max([*(abs(judge.difference) for judge in counted), 2e-16 * abs(answer)])
    digits = certain_digits(answer, uncertainty)
    of = transient_words(run.steadiness, uncertainty)
    verdict = finding(answer, uncertainty, digits, period, counted, robot, of) + naive(answer, judges, robot)
    early = [ending.note("some methods were not asked, so fewer digits may be certain than are given")] if ending.interrupted else []
    return Check(
        answer, best, uncertainty, digits, period, balance, tuple(judges), (*early, *run.notes, *machine_of(robot).cautions), verdict, of
    )


def _check_arguments(robot: Model, rk4_steps: Any, duration: Any) -> None:
    """Refuse arguments that no method accepts; all problems are reported at once."""
    problems, name = Problems("check"), type(robot).__name__
    if not is_model(robot):
        problems.add(f"{robot!r} is not a robot; type for example ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4)")
    elif shape_of(robot):
        problems.add(f"the robot is a batch of shape {shape_of(robot)}; allowed is one robot; take one case of it")
    elif robot.period is None and duration is None:
        problems.add(f"{name} has no period, so periods does not say how long to run; type duration=60.0 [s]")
    elif robot.period is not None and duration is not None:
        problems.add(f"duration = {duration!r}, and {name} has a period; type periods=200")
    if not isinstance(rk4_steps, (tuple, list)) or not all(map(rk4.allows, rk4_steps)):
        example = f"({rk4_steps},)" if rk4.allows(rk4_steps) else "(2000, 10000)"
        problems.add(f"rk4_steps = {rk4_steps!r}; allowed is a tuple, each {rk4.ALLOWED}; type for example rk4_steps={example}")
    problems.check()


def _stage_reporter(progress: Callable[[str, int, int], None] | bool | None, whole: int) -> Callable[[str], None]:
    """A function that passes the name of the next method and the number of methods done to the progress callback."""
    done, report = iter(range(whole + 1)), reporting(progress, "check")

    def tell(who: str) -> None:
        report(who, next(done), whole)
        look()

    return tell


def _skipped(name: str, setting: str, why: str) -> Judge:
    """The entry of a method that does not apply."""
    return Judge(name, setting, 0, math.nan, math.nan, 0.0, False, f"skipped: {why}")


class _Court:
    """Runs the judges one by one."""

    def __init__(self, robot: Model, periods: int, start: dict[str, Any] | None, duration: float | None = None):
        self.robot, self.periods, self.start, self.duration = robot, periods if duration is None else 0, start, duration

    def solved(self, periods: int, **options: Any) -> Any:
        """A run over this many drive periods, or over the whole duration if the model has no period."""
        length = {"periods": periods} if self.duration is None else {"duration": self.duration}
        return solve(self.robot, **{**length, **options}, start=self.start)

    def judge(
        self, name: str, setting: str, reference: float | None,
        counts: bool = True, periods: int | None = None, remark: str = "", **options: Any,
    ) -> Judge:  # fmt: skip
        """One run; a failure is reported, not raised."""
        begin = time.perf_counter()
        periods = periods or self.periods
        try:
            value = mean_velocity(self.solved(periods, **options))
        except SolveError as error:
            return Judge(name, setting, periods, math.nan, math.nan, time.perf_counter() - begin, False, str(error).split(";")[0])
        except InputError as error:  # the first run accepted these arguments, so the method is the cause
            return _skipped(name, setting, error.problems[0].rsplit("; type", 1)[0])
        difference = math.nan if reference is None else value - reference
        return Judge(name, setting, periods, value, difference, time.perf_counter() - begin, counts, remark)

    def answer(self, **options: Any) -> tuple[Any, float]:
        """The run that is assessed, and its computing time [s] without compilation."""
        self.solved(1, **options, **({} if self.duration is None else {"duration": 1e-3 * self.duration}))
        begin = time.perf_counter()
        return self.solved(self.periods, **options), time.perf_counter() - begin

    def ladder(self, rtol: float) -> tuple[Any, list[Judge]]:
        """The assessed run, and runs at tighter tolerances; the tightest is the reference for the others."""
        run, seconds = self.answer(rtol=rtol)
        tighter = sorted({max(rtol * part, _TIGHTEST) for part in LADDER} - {rtol}, reverse=True)
        judges = [Judge(run.method, f"rtol {rtol:.0e}", self.periods, mean_velocity(run), math.nan, seconds)]
        judges += [self.judge(run.method, f"rtol {tolerance:.0e}", None, rtol=tolerance) for tolerance in tighter]
        best = judges[-1].mean_velocity
        last = {"remark": _REFERENCE}
        return run, [Judge(**{**asdict(j), "difference": j.mean_velocity - best, **(last if j is judges[-1] else {})}) for j in judges]

    def exact(self) -> tuple[Any, list[Judge]]:
        """The exact run and the closed formula."""
        run, seconds = self.answer()
        first = Judge("exact arcs", "no tolerance", self.periods, mean_velocity(run), 0.0, seconds, remark=_REFERENCE)
        return run, [first, self.formula()]

    def formula(self) -> Judge:
        """The closed formula of the periodic motion, compared with a run until the strobe point repeats; skipped if it does not apply."""
        name, setting, begin = "closed formula", "periodic motion", time.perf_counter()
        if handles(self.robot) is not None:
            return _skipped(name, setting, "it is for Coulomb friction and a harmonic drive")
        if self.start:  # two motions may coexist
            return _skipped(name, setting, "it is for motions that begin at rest")
        closed = closed_mean_velocity(self.robot)
        if closed is None:
            return _skipped(name, setting, "a body that slides down by itself has no period")
        value = float(closed)
        if math.isnan(value):
            return _skipped(name, setting, "the motion from rest takes too long to settle")
        long: Any = solve(self.robot, periods=5000, settle="auto", keep="summary", start=self.start)
        repeats, ran = bool(long.period), int(long.periods_run)
        remark = f"against a run until the strobe point {'repeats' if repeats else f'repeats, which it did not in {ran} periods'}"
        difference = value - float(long.mean_velocity) if repeats else math.nan
        return Judge(name, setting, ran, value, difference, time.perf_counter() - begin, repeats, remark)

    def scipy(self, method: str, periods: int, rtol: float, tight: float) -> Judge:
        """SciPy's integrator over fewer periods, compared with our own run of the same length at a tight tolerance."""
        periods = min(periods, self.periods)
        own = self.judge("", "", None, periods=periods, rtol=tight)
        remark = f"against the reference over the same {periods} periods" if 0 < periods < self.periods else ""
        name, setting = f"scipy {method}", f"rtol {rtol:.0e}"
        return self.judge(name, setting, own.mean_velocity, periods=periods, remark=remark, method=method, rtol=rtol)
