"""Work and precision of stickslip and of what installs from PyPI: one command, one table.

python benchmarks/work_precision.py                         # everything: 6 to 9 minutes
python benchmarks/work_precision.py --quick                 # 64 cases, small budgets: 4 minutes
python benchmarks/work_precision.py --only heyoka           # ours and the rows whose name contains it
python benchmarks/work_precision.py --json out.json --plot out.png
python benchmarks/work_precision.py --arith                 # the core's multiply-add peak, nothing else
"""

from __future__ import annotations

import pin  # isort: skip  # before NumPy

import argparse
import sys
from dataclasses import replace

import chart
import table
from measure import Curve, again, curve
from ours import OURS, OURS_LONG, OURS_WHOLE
from problem import Problem, alone, sweep
from rivals import ALL, Rival

FRICTIONS = (0.18, 0.03)
MANY = "512 amplitudes 0.4 to 0.8 mm, CPU us per drive period and case at a worst relative error of the mean velocity (x: times ours)"
ONE = "one case alone, A = 0.6 mm, same units"


def arguments(given: list[str] | None = None) -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mu0", type=float, action="append", choices=FRICTIONS, help="only this friction (default: both)")
    parser.add_argument("--only", action="append", metavar="TEXT", help="only ours and rivals whose name contains TEXT")
    parser.add_argument("--rounds", type=int, default=5, help="in which what is fast is measured again; the median counts (default 5)")
    parser.add_argument("--budget", type=float, default=30, help="CPU seconds for a row on one problem (default 30)")
    parser.add_argument("--quick", action="store_true", help="64 cases, 3 rounds, budget 5 s")
    parser.add_argument("--json", metavar="FILE", help="write everything measured")
    parser.add_argument("--plot", metavar="FILE", help="draw the work-precision diagram")
    parser.add_argument("--arith", action="store_true", help="measure the core's double FMA peak instead")
    found = parser.parse_args(given)
    if found.quick:
        found.rounds, found.budget = 3, 5.0
    return found


def chosen(only: list[str] | None) -> tuple[Rival, ...]:
    """Ours first, then everybody asked for."""
    return (OURS, OURS_WHOLE, *(r for r in ALL if not only or any(text.lower() in r.name.lower() for text in only)))


def measured(rivals: tuple[Rival, ...], problems: list[Problem], rounds: int, budget: float) -> list[list[Curve]]:
    """One row of curves for each rival."""
    rows = []
    for rival in rivals:
        progress(f"{rival.name}: first round")
        rows.append([curve(rival, problem, budget) for problem in problems])
    for k in range(1, rounds):
        progress(f"round {k + 1} of {rounds}, of what is fast")
        rows = [[again(c, r, p) for c, p in zip(row, problems, strict=True)] for row, r in zip(rows, rivals, strict=True)]
    progress("")
    return rows


def progress(what: str) -> None:
    """One line that is written over, on a terminal only."""
    if sys.stderr.isatty():
        print(f"\r{what:78s}\r", end="", file=sys.stderr, flush=True)


def main() -> None:
    """Measure, print, and write what was asked for."""
    asked = arguments()
    if asked.arith:
        import arith

        arith.report()
        return
    frictions = asked.mu0 or FRICTIONS
    rivals = chosen(asked.only)
    many = [sweep(mu0).some(64) if asked.quick else sweep(mu0) for mu0 in frictions]
    print(f"# {pin.WHERE}; " + ", ".join(f"{k} {v}" for k, v in table.versions().items()))
    rows = measured(rivals, many, asked.rounds, asked.budget)
    print(table.text(MANY, rows), "\n", flush=True)
    singles = tuple(replace(r, cases=1, cases_stiff=0) for r in (OURS, OURS_LONG, *rivals[1:]) if r.alone)
    single_rows = measured(singles, [alone(mu0) for mu0 in frictions], asked.rounds, asked.budget)
    print(table.text(ONE, single_rows))
    if asked.json:
        table.write_json(asked.json, {"many": rows, "alone": single_rows}, pinned=pin.WHERE)
    if asked.plot:
        chart.draw(asked.plot, rows)


if __name__ == "__main__":
    main()
