"""Is any number silently wrong? 100 000 random robots and mechanisms of 120 kinds, 1000 of them against a second method.

Run: python verification/random_robots.py [--cases N] [--judged N] [--kinds N] [--only WORD] [--out FILE] [--workers N]

Every kind is a batch: all its cases over 30 periods, which must end with a status, and over 90, where a mean that was said to be steady
must still be the same; laws with inner states at rtol 1e-6 and 1e-10, to see how far the tolerance holds. Some cases of each kind then
run for six periods from rest, by our solver and by SciPy on the same law in plain Python, and the displacements are compared. Where they
differ, SciPy is asked once more, by another method: if it differs from itself by a third as much, the case is too sensitive
to tell and counts as open. What is left, and is not accompanied by a status, is a silent disagreement: it is printed with the numbers of
the model (`drawn_models.case_of` makes it again), and the exit code is 1.

Results are appended to FILE, a line of JSON for each kind; kinds that stand there are not run again. Small: --cases 600 --kinds 12.
"""

from __future__ import annotations

import argparse
import json
import signal
import sys
import time
import traceback
from collections import Counter
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

import stickslip as ss
from stickslip.basics.batch import rows_of
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.models.friction.law_adapter import law_of
from stickslip.models.machine_adapter import machine_of

sys.path.insert(0, str(Path(__file__).resolve().parent))
from drawn_models import Kind, kinds, model_of

PERIODS, SETTLE, JUDGED_PERIODS = 30, 20, 6
TURN = 2 * np.pi  # [s], about one period of the mechanisms that have none
LOST = 6  # status: the contact was lost
#: Largest difference of displacements, in what the body would move in 1/omega if it were free, or relative where it moves further. Steps of
#: a dynamic law are held to 1e-10 each; a table has corners, which SciPy steps over: between its tolerances 1e-11 and 1e-12 it differs from
#: itself by 1e-8.
EXACT, STEPS, CORNERS = 1e-9, 1e-6, 1e-7
#: How far a mean that is said to be steady may move on, relative to it or to a twentieth of the velocity of a free body: ten times what is
#: promised of exact runs; of steps at rtol 1e-6 what these are good for.
DRIFT = {False: 1e-5, True: 1e-3}
ROUNDING = 1e-12  # of the drive's velocity: a body that is as good as at rest has a mean and extremes of 1e-17 m/s
PATIENCE = 30.0  # seconds of processor time for one case of the judge
SLOW_CASES, SLOW_JUDGED = 8, 4  # cases of a kind that cannot be compiled, which takes minutes


class TooLong(Exception):
    """The judge takes longer than its patience."""


@dataclass(frozen=True)
class Task:
    """One kind to look at."""

    kind: Kind
    cases: int
    judged: int
    seed: int


def examined(task: Task) -> dict[str, Any]:
    """What came of one kind; an error that no status tells is the kind's own failure."""
    try:
        return _looked_at(task)
    except Exception:
        nothing = {"cases": task.cases, "statuses": {"error": task.cases}, "judged": {}, "lines": [], "worst": np.nan, "seconds": 0}
        return {"kind": str(task.kind), "number": task.kind.number, "broken": task.cases, "error": traceback.format_exc(), **nothing}


def _looked_at(task: Task) -> dict[str, Any]:
    began = time.process_time()
    found: dict[str, Any] = {"kind": str(task.kind), "number": task.kind.number}
    plain = "bristle" in task.kind.law
    model = model_of(task.kind, min(task.cases, SLOW_CASES) if plain else task.cases, task.seed)
    found |= _all_of(model, plain)
    tolerance = STEPS if law_of(model).dynamic else CORNERS if "tabulated" in task.kind.law else EXACT
    found |= _against_the_judge(model, min(task.judged, SLOW_JUDGED if plain else found["cases"]), tolerance, plain)
    return {**found, "seconds": round(time.process_time() - began, 1)}


def _span(model: Any, periods: int) -> dict[str, Any]:
    return {"periods": periods} if model.period is not None else {"duration": periods * TURN}


def _unit(model: Any) -> Any:
    """What the body would move in 1/omega if it were free [m]."""
    return machine_of(model).free_velocity * ((1.0 if model.period is None else model.period) / TURN)


# all of them -------------------------------------------------------------------------------------------------------


def _all_of(model: Any, plain: bool) -> dict[str, Any]:
    """Every case of a kind: how the runs ended, and what a looser tolerance does to those that repeat."""
    settle = {} if model.period is None or plain else {"settle": SETTLE}
    span = {**_span(model, 3 if plain else PERIODS), **settle}
    run = ss.solve(model, **span)
    found: dict[str, Any] = {"cases": int(np.size(run.status)), "statuses": run.status_counts, "broken": _broken(run, model)}
    found["drifts"] = [] if model.period is None or plain else _drifts(run, model)
    if law_of(model).dynamic and not plain:
        tight = ss.solve(model, rtol=1e-10, **span)
        good = (run.status <= 1) & (tight.status <= 1)
        repeats = good if model.period is None else good & (run.steadiness == 0) & (tight.steadiness == 0)
        error = abs(run.displacement - tight.displacement)[repeats] / (PERIODS - SETTLE) / np.broadcast_to(_unit(model), run.shape)[repeats]
        found["loose"] = [float(q) for q in np.quantile(error, [0.5, 0.99, 1.0])] if len(error) else None
    return found


def _drifts(run: Any, model: Any) -> list[float]:
    """How far means that are said to be steady are from those of a run three times as long, where that is more than a little."""
    later = ss.solve(model, periods=3 * PERIODS, settle=3 * PERIODS - (PERIODS - SETTLE))
    steady = (run.steadiness == 0) & (later.steadiness == 0)
    allowed = DRIFT[law_of(model).dynamic] * np.maximum(abs(later.mean_velocity), 0.05 * machine_of(model).free_velocity)
    part = np.abs(run.mean_velocity - later.mean_velocity) / allowed
    return [float(p) for p in part[steady & (part > 1.0)]]


def _broken(run: Any, model: Any) -> int:
    """Cases that say that they have finished, and whose numbers cannot be."""
    good = run.status <= 1
    slack = 1e-9 * (abs(run.velocity_max) + abs(run.velocity_min)) + ROUNDING * model.velocity_scale
    inside = (run.mean_velocity >= run.velocity_min - slack) & (run.mean_velocity <= run.velocity_max + slack)
    within = inside | (run.period == 0) if model.period is not None else True
    return int(np.sum(good & ~(np.isfinite(run.mean_velocity) & np.isfinite(run.velocity_max) & within)))


# some of them ------------------------------------------------------------------------------------------------------


def _against_the_judge(model: Any, count: int, tolerance: float, plain: bool) -> dict[str, Any]:
    """The first cases of a kind by a second method."""
    numbers = tuple(name for name, _ in leaves(model))
    rows = rows_of(model, numbers)[:count]
    some = replace_leaf(model, {name: rows[:, k] for k, name in enumerate(numbers)})
    ours = ss.solve(some, settle=None if model.period is None else 0, rtol=1e-10, **_span(model, 2 if plain else JUDGED_PERIODS))
    unit, worst, lines = np.broadcast_to(_unit(some), some.shape), 0.0, []
    told: Counter[str] = Counter()
    for i in range(count):
        case = replace_leaf(model, dict(zip(numbers, rows[i].tolist(), strict=True)))
        answer = (int(ours.status[i]), float(ours.displacement[i]) / float(unit[i]))
        verdict, error, note = _judged(case, float(unit[i]), answer, tolerance, plain)
        told[verdict] += 1
        worst = max(worst, error) if verdict == "agrees" else worst
        if verdict not in ("agrees", "contact lost in both"):
            lines.append({"case": i, "verdict": verdict, "error": error, "note": note, "numbers": dict(leaves(case))})
    return {"judged": dict(told), "worst": worst, "lines": lines}


def _judged(case: Any, unit: float, ours: tuple[int, float], tolerance: float, plain: bool) -> tuple[str, float, str]:
    """A verdict, the error, and how it came about."""
    status, moved = ours
    tolerance *= max(1.0, abs(moved))
    periods = 2 if plain else JUDGED_PERIODS
    first, second = (("lsoda", 1e-9), ("radau", 1e-9)) if plain else (("dop853", 1e-11), ("radau", 1e-11))
    try:
        theirs = _asked(case, unit, periods, *first)
        if (status == LOST) == (theirs[0] == LOST) and status <= 1 and abs(moved - theirs[1]) <= tolerance:
            return "agrees", abs(moved - theirs[1]), ""
        if status == theirs[0] == LOST:
            return "contact lost in both", 0.0, ""
        if status > 1 and status != LOST:
            return "unsolved", np.nan, f"status {status}; judge: status {theirs[0]}"
        again = _asked(case, unit, periods, *second)
    except TooLong:
        return "no judge", np.nan, f"SciPy takes longer than {PATIENCE:g} s"
    if theirs[0] not in (0, LOST) or again[0] not in (0, LOST):
        return "no judge", np.nan, f"status {theirs[0]} and {again[0]}"
    note = f"ours {status} {moved!r}; {first} {theirs}; {second} {again}"
    if {theirs[0], again[0]} == {status} and abs(moved - again[1]) <= tolerance:
        return "agrees", abs(moved - again[1]), note
    if theirs[0] != again[0] or (theirs[0] == status and abs(theirs[1] - again[1]) > abs(moved - again[1]) / 3):
        return "open", abs(moved - again[1]), note
    return "SILENT", abs(moved - again[1]), note


def _asked(case: Any, unit: float, periods: int, method: str, rtol: float) -> tuple[int, float]:
    """Status and displacement by SciPy on the law in plain Python, in units of free motion."""
    signal.signal(signal.SIGPROF, _stop)
    signal.setitimer(signal.ITIMER_PROF, PATIENCE)
    try:
        settle = None if case.period is None else 0
        run = ss.solve(case, method=method, rtol=rtol, settle=settle, keep="summary", **_span(case, periods))
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
    return int(run.status), float(run.displacement) / unit


def _stop(*_: Any) -> None:
    raise TooLong


# the table ---------------------------------------------------------------------------------------------------------


def _row(found: dict[str, Any]) -> str:
    ends = "; ".join(f"{n} {sentence}" for sentence, n in found["statuses"].items())
    judged = "; ".join(f"{n} {verdict}" for verdict, n in found["judged"].items())
    loose = "  ".join(f"{q:.0e}" for q in found.get("loose") or ())
    broken = "".join(f"  {n} {word}" for n, word in ((found["broken"], "BROKEN"), (len(found.get("drifts", ())), "DRIFT")) if n)
    name = f"{found['number']:3d}  {found['kind'][:62]:62}"
    return f"{name}  {found['worst']:7.0e}  {judged}  |  {ends}{broken}  |  {loose}  ({found['seconds']} s)"


def _summed(rows: list[dict[str, Any]]) -> bool:
    """Print the sums; whether nothing disagrees in silence."""
    judged: Counter[str] = sum((Counter(row["judged"]) for row in rows), Counter())
    ends: Counter[str] = sum((Counter(row["statuses"]) for row in rows), Counter())
    print(f"\n{sum(row['cases'] for row in rows)} cases of {len(rows)} kinds:", "; ".join(f"{n} {s}" for s, n in ends.most_common()))
    print(f"{sum(judged.values())} against a second method:", "; ".join(f"{n} {verdict}" for verdict, n in judged.most_common()))
    broken = sum(row["broken"] for row in rows)
    drifts = [part for row in rows for part in row.get("drifts", ())]
    print(f"{broken} say that they have finished, and their numbers cannot be")
    print(f"{len(drifts)} say that they are steady, and move on; the worst by {max(drifts, default=0.0):.2g} of what is allowed")
    for row in rows:
        print(row.get("error", ""), end="")
        for line in row["lines"]:
            if line["verdict"] == "SILENT":
                print(f"\n{row['kind']}, case {line['case']}, error {line['error']:.1e} ({line['note']})\n{line['numbers']}")
    return not judged["SILENT"] and not broken and not drifts


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, value, text in (
        ("cases", 100_000, "models in all"), ("judged", 1000, "of them against a second method"), ("kinds", 120, "kinds"),
        ("seed", 1, "of the random numbers"), ("workers", 2, "processes"),
    ):  # fmt: skip
        parser.add_argument(f"--{name}", type=int, default=value, help=f"{text} ({value})")
    parser.add_argument("--only", default="", help="kinds whose name contains this")
    parser.add_argument("--numbers", type=int, nargs="*", default=[], help="kinds of these numbers")
    parser.add_argument("--out", type=Path, help="a file of lines of JSON, to go on with")
    return parser.parse_args()


def _tasks(given: argparse.Namespace, done: set[int]) -> list[Task]:
    """Kinds that are still to do; each gets so many cases that those which cannot be compiled are made up for."""
    every = kinds(given.kinds, seed=given.seed)
    slow = sum("bristle" in kind.law for kind in every)
    cases = max(-(-(given.cases - SLOW_CASES * slow) // max(len(every) - slow, 1)), 2)
    chosen = [k for k in every if given.only in str(k) and (not given.numbers or k.number in given.numbers) and k.number not in done]
    return [Task(kind, cases, -(-given.judged // len(every)), given.seed) for kind in chosen]


def main() -> int:
    given = _arguments()
    rows = [json.loads(line) for line in given.out.read_text().splitlines()] if given.out and given.out.exists() else []
    tasks = _tasks(given, {row["number"] for row in rows})
    print(
        "  #  kind                                                              worst  judged  |  all  |  1e-6 against 1e-10: 50, 99, 100 %"
    )
    with ProcessPoolExecutor(given.workers, mp_context=get_context("spawn")) as pool:
        for future in as_completed([pool.submit(examined, task) for task in tasks]):
            rows.append(future.result())
            print(_row(rows[-1]), flush=True)
            if given.out:
                with given.out.open("a") as file:
                    file.write(json.dumps(rows[-1]) + "\n")
    return 0 if _summed(rows) else 1


if __name__ == "__main__":
    raise SystemExit(main())
