"""Certain digits of a run of a flow: the compiled steps and SciPy's integrator on the same functions in plain Python."""

from __future__ import annotations

import math
import time
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from stickslip.analysis.verdict import certain_digits
from stickslip.basics.arguments import described_as
from stickslip.basics.errors import SolveError
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.interruption import look
from stickslip.basics.notebook_display import Drawn
from stickslip.solvers import solve
from stickslip.solvers.plain.composed_flows import check_judged, composed
from stickslip.solvers.plain.judged_flows import passage_by_scipy

if TYPE_CHECKING:
    from stickslip.models.switching_flow import SwitchingFlow

_TOLERANCES = (1e-9, 1e-12)  # of SciPy's DOP853; the second is the one that counts
_PERIODS = 12  # of the forcing that plain Python is made to follow, as of machines


@dataclass(frozen=True)
class FlowJudge:
    """One run of one method.

    Parameters
    ----------
    name, setting : str
        The method, and its tolerance.
    end : dict of float
        Where it ends, by state; NaN where it failed.
    difference : float
        The largest difference of a state from that of the compiled steps, as a part of the state's largest size; NaN where it failed.
    switches : int
        How often the mode changed.
    seconds : float
        Computing time on this machine.
    remark : str
        Why it failed.
    counts : bool
        Whether it limits the number of certain digits, as the one with the smallest tolerance does.
    """

    name: str
    setting: str
    end: dict[str, float]
    difference: float
    switches: int
    seconds: float
    remark: str = ""
    counts: bool = True


@described_as("what ss.check returns of a flow; type ss.check(flow, duration=10.0)")
@sealed
@dataclass(frozen=True)
class FlowCheck(Drawn):
    """What `check` says of a flow: on how many digits of the states at the end the methods agree.

    Parameters
    ----------
    end : dict of float
        The states at the end, of the compiled steps.
    length : float
        The time after which that is.
    uncertainty : float
        The largest difference of a state at the end between two methods, as a part of the state's largest size in the run.
    digits : int
        Certain digits of a state of that size, and 0 where the methods switch differently often.
    judges : tuple of FlowJudge
    verdict : str
        Summary in a sentence.
    """

    end: dict[str, float]
    length: float
    uncertainty: float
    digits: int
    judges: tuple[FlowJudge, ...]
    verdict: str

    _drawn_by, _inches = "check", (4.4, 2.6)
    size: ClassVar[float] = 1.0  # of what is compared
    compared: ClassVar[str] = "the states, as a part of their size"

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain numbers and text."""
        return {**asdict(self), "judges": [asdict(judge) for judge in self.judges]}

    def rows(self) -> list[tuple[str, ...]]:
        """The judges as rows of text, heading first."""
        head = ("judge", "setting", "switches", *self.end, "difference", "time [s]", "")
        return [head, *(_row(judge) for judge in self.judges)]

    def _title(self) -> str:
        return self.verdict

    def _tables(self) -> list[list[tuple[str, ...]]]:
        return [self.rows()]

    def __str__(self) -> str:
        return self._text()


def _row(judge: FlowJudge) -> tuple[str, ...]:
    ends = (f"{value:.9g}" if math.isfinite(value) else "-" for value in judge.end.values())
    difference = f"{judge.difference:.1e}" if math.isfinite(judge.difference) else "-"
    return judge.name, judge.setting, str(judge.switches), *ends, difference, f"{judge.seconds:.2f}", judge.remark


def check_flow_run(flow: SwitchingFlow, periods: int, duration: float | None, start: Any) -> FlowCheck:
    """The digits of a flow's states after some periods of its forcing, at most 12, or after a time."""
    length: dict[str, Any] = {"duration": duration} if duration is not None else {"periods": min(periods, _PERIODS)}
    check_judged(flow)
    begin = time.perf_counter()
    run: Any = solve(flow, start=start, keep="trajectory", **length)
    took, t0 = time.perf_counter() - begin, float(run.nodes[0])
    names, y, mode = run.names, run.pieces.coefficients[0, :, 0].copy(), list(flow.modes)[int(run.pieces.mode[0])]
    end, span = dict(zip(names, map(float, run.state), strict=True)), float(run.nodes[-1]) - t0
    sizes = np.maximum(abs(run.lowest), abs(run.highest))
    judges = [FlowJudge(*_named(run), end, 0.0, len(run.events), took, "the reference")]
    for rtol in _TOLERANCES:
        look()
        begin = time.perf_counter()
        try:
            there, _, _, events, *_ = passage_by_scipy(composed(flow), y, mode, span, t0, rtol, None)
            difference, why = float(np.max(abs(there - run.state) / np.where(sizes > 0.0, sizes, 1.0))), ""
        except SolveError as error:
            there, events, difference, why = np.full(len(y), np.nan), [], math.nan, str(error).split(";")[0]
        ends = dict(zip(names, map(float, there), strict=True))
        took, counts = time.perf_counter() - begin, rtol == _TOLERANCES[-1]
        judges.append(FlowJudge("scipy DOP853", f"rtol {rtol:.0e}", ends, difference, len(events), took, why, counts))
    last = judges[-1]
    same = last.switches == len(run.events)
    digits = certain_digits(1.0, max(last.difference, 1e-15)) if same and math.isfinite(last.difference) else 0
    return FlowCheck(end, span, last.difference, digits, tuple(judges), _verdict(span, last, digits, same, judges[0].name))


def _named(run: Any) -> tuple[str, str]:
    """What the steps of a run are called, and how exact they are."""
    return ("Taylor steps", "exact to rounding") if run.method == "exact" else (f"{run.method} steps", f"rtol {run.rtol:.0e}")


def _verdict(span: float, judge: FlowJudge, digits: int, same: bool, own: str) -> str:
    if not math.isfinite(judge.difference):
        return f"No other method could confirm the states after {span:.6g}: no digit is certain."
    if not same:
        return f"The methods switch differently often within {span:.6g}: no digit is certain."
    agree = f"{own} and SciPy agree to {judge.difference:.1e} of the states' size"
    return f"{digits} digits of the states after {span:.6g} are certain: {agree}." if digits else f"No digit is certain: {agree}."
