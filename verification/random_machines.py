"""Is any number of a machine silently wrong? 10 000 random machines of 250 kinds, 300 of them against a second method.

Run: python verification/random_machines.py [--cases N] [--judged N] [--kinds N] [--only WORD] [--results FILE] [--resume] [--workers N]

A kind is a sort of machine (`machine_draws/kinds.py`: chains, worms, rows with stops, capsules, stages, conveyors, joints, robots with
several masses) with a law, a number of bodies and all else that its equations depend on; its cases differ in all numbers. They run as one
batch, whose statuses are counted as a sweep stores them, and some of them once more as single runs, which must end as the batch
did, in the same place. Judged ones run by SciPy on the same machine in plain Python too (`judging.py`). Statuses other than "finished"
and "contact lost" in more than 1 % of the cases, numbers that cannot be, and every silent disagreement make the exit code 1.

A case is drawn from the seed, the number of its kind and its own number alone: `--numbers K --case I` runs that one by itself.
Results are appended to FILE, a line of JSON for each kind; with --resume kinds that stand there are not run again.
"""

from __future__ import annotations

import argparse
import json
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
from stickslip.basics.errors import StickslipError

sys.path.insert(0, str(Path(__file__).resolve().parent))
from judging import judged, span, unit_of_way
from machine_draws.drawing import Cases, Kind, drawn
from machine_draws.kinds import SORTS, kinds

from stickslip.basics.status import Status
from stickslip.solvers.methods import method_for

PERIODS = 10
SLOW_CASES = 4  # of a kind that no compiled method takes
GOOD = (Status.FINISHED.sentence, Status.LOST.sentence)
SAME = 1e-9  # of the way in which the velocity scale lasts: a single run beside its case in the batch


@dataclass(frozen=True)
class Task:
    """One kind to look at."""

    kind: Kind
    cases: int
    judged: int
    seed: int


def examined(task: Task) -> dict[str, Any]:
    """What came of one kind; an error that no status tells is the kind's own failure."""
    began = time.process_time()
    found: dict[str, Any] = {"kind": str(task.kind), "number": task.kind.number, "cases": task.cases, "ends": {}, "judged": {}, "lines": []}
    try:
        found |= _looked_at(task)
    except Exception:
        found |= {"ends": {"error": task.cases}, "error": traceback.format_exc()}
    return {**found, "seconds": round(time.process_time() - began, 1)}


def _cases(task: Task) -> Cases:
    """The cases of a kind; few of one that no compiled method takes."""
    make = SORTS[task.kind.machine][0]
    first = drawn(make, task.kind, 1, task.seed)
    slow = type(method_for("auto", first.one(0))).__name__ == "Judge"
    return drawn(make, task.kind, min(task.cases, SLOW_CASES) if slow else task.cases, task.seed)


def _looked_at(task: Task) -> dict[str, Any]:
    cases = _cases(task)
    batch = cases.all()
    how = span(batch, PERIODS)
    many = ss.solve(batch, **how)
    count = int(np.size(many.status))
    wrong = int(np.sum((np.asarray(many.status) <= Status.REPEATS) & ~np.isfinite(many.displacement)))
    bad = [f"case {i}: {Status(int(s)).sentence}" for i, s in enumerate(many.status) if Status(int(s)).sentence not in GOOD]
    verdicts, lines, worst = Counter[str](), [], 0.0
    for i in range(min(task.judged, count)):
        single = _beside(cases.one(i), many, i, how)
        verdict, error, note = judged(cases.one(i))
        verdicts[verdict] += 1
        worst = max(worst, error) if verdict == "agrees" else worst
        if single:
            verdicts["single run DIFFERS"] += 1
        if single or verdict != "agrees":
            lines.append(f"case {i}: {verdict}; {note} {single}")
    found = {"cases": count, "ends": many.status_counts, "broken": wrong, "bad": bad}
    return {**found, "judged": dict(verdicts), "lines": lines, "worst": worst}


def _beside(machine: Any, many: Any, i: int, how: dict[str, Any]) -> str:
    """How a single run differs from its case in the batch; "" where it does not."""
    end = Status(int(many.status[i])).sentence
    try:
        run = ss.solve(machine, **how, keep="summary")
    except StickslipError as error:  # a load that is lost from the start is refused where one machine is given
        lost = end == Status.LOST.sentence and "at the start" in str(error)
        return "" if lost or end in str(error) else f"alone: {error}"
    apart = abs(float(run.displacement) - float(np.asarray(many.displacement).reshape(-1)[i]))
    same = Status(int(run.status)).sentence == end and not apart > SAME * unit_of_way(machine)
    return "" if same else f"alone: {Status(int(run.status)).sentence}, {apart:.2g} m apart; in the batch: {end}"


# the table ---------------------------------------------------------------------------------------------------------


def _row(found: dict[str, Any]) -> str:
    ends = "; ".join(f"{n} {sentence}" for sentence, n in found["ends"].items())
    told = "; ".join(f"{n} {verdict}" for verdict, n in found["judged"].items())
    broken = f"  {found['broken']} BROKEN" if found.get("broken") else ""
    lines = "".join(f"\n       {line}" for line in [*found.get("bad", ()), *found["lines"]])
    name = f"{found['number']:3d}  {found['kind'][:30]:30}"
    return f"{name}  {found.get('worst', np.nan):7.0e}  {told}  |  {ends}{broken} ({found['seconds']} s){lines}"


def _summed(rows: list[dict[str, Any]]) -> bool:
    """Print the sums; whether nothing disagrees in silence."""
    told: Counter[str] = sum((Counter(row["judged"]) for row in rows), Counter())
    by_sort: dict[str, Counter[str]] = {}
    for row in rows:
        by_sort.setdefault(row["kind"].partition(" ")[0], Counter()).update(row["ends"])
    for sort, ends in by_sort.items():
        print(f"{sort:10} {ends.total():6d}:", "; ".join(f"{n} {sentence}" for sentence, n in ends.most_common()))
    whole: Counter[str] = sum(by_sort.values(), Counter())
    others = whole.total() - sum(whole[sentence] for sentence in GOOD)
    print(f"\n{whole.total()} cases of {len(rows)} kinds:", "; ".join(f"{n} {s}" for s, n in whole.most_common()))
    print(f"{others} ({100 * others / max(whole.total(), 1):.2f} %) neither finished nor lost a contact; {sum(map(_broken, rows))} broken")
    print(f"{sum(told.values())} verdicts:", "; ".join(f"{n} {verdict}" for verdict, n in told.most_common()))
    for row in rows:
        print(row.get("error", ""), end="")
    silent = told["SILENT"] + told["single run DIFFERS"]
    return not silent and not sum(map(_broken, rows)) and others <= 0.01 * whole.total()


def _broken(row: dict[str, Any]) -> int:
    return int(row.get("broken", row["cases"] if "error" in row else 0))


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, value, text in (
        ("cases", 10_000, "machines in all"), ("judged", 300, "of them against a second method"), ("kinds", 250, "kinds"),
        ("seed", 1, "of the random numbers"), ("workers", 2, "processes"),
    ):  # fmt: skip
        parser.add_argument(f"--{name}", type=int, default=value, help=f"{text} ({value})")
    parser.add_argument("--only", default="", help="kinds whose name contains this")
    parser.add_argument("--numbers", type=int, nargs="*", default=[], help="kinds of these numbers")
    parser.add_argument("--case", type=int, help="one case of the kind, run and judged by itself")
    parser.add_argument("--results", type=Path, default=Path("random_machines.jsonl"), help="a file of lines of JSON")
    parser.add_argument("--resume", action="store_true", help="go on with what stands in the file")
    return parser.parse_args()


def _tasks(given: argparse.Namespace, done: set[int]) -> list[Task]:
    """Kinds that are still to do."""
    every = kinds(given.kinds, given.seed)
    chosen = [k for k in every if given.only in str(k) and (not given.numbers or k.number in given.numbers) and k.number not in done]
    share = [(i + 1) * given.judged // len(every) - i * given.judged // len(every) for i in range(len(every))]
    return [Task(kind, -(-given.cases // len(every)), share[kind.number], given.seed) for kind in chosen]


def _alone(given: argparse.Namespace) -> int:
    """One case by itself."""
    (task,) = _tasks(given, set())
    machine = drawn(SORTS[task.kind.machine][0], task.kind, 1, given.seed, given.case).one(0)
    print(task.kind, machine, judged(machine), sep="\n")
    return 0


def main() -> int:
    """Run all kinds, print what ended how, and every silent disagreement."""
    given = _arguments()
    if given.case is not None:
        return _alone(given)
    kept = given.results.read_text().splitlines() if given.resume and given.results.exists() else []
    rows = [json.loads(line) for line in kept]
    given.results.write_text("".join(f"{line}\n" for line in kept))
    tasks = _tasks(given, {row["number"] for row in rows})
    print("  #  kind                            worst  judged  |  all")
    with ProcessPoolExecutor(given.workers, mp_context=get_context("spawn")) as pool:
        for future in as_completed([pool.submit(examined, task) for task in tasks]):
            rows.append(future.result())
            print(_row(rows[-1]), flush=True)
            with given.results.open("a") as file:
                file.write(json.dumps(rows[-1]) + "\n")
    return 0 if _summed(rows) else 1


if __name__ == "__main__":
    raise SystemExit(main())
