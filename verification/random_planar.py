"""Is a machine in the plane silently wrong? Random ones, each by the exact solver; the first of each form by SciPy's judge too.

Run: python verification/random_planar.py [--cases 400] [--judged 60] [--first 0] [--form WORD] [--results FILE]

Forms are in `machine_draws/planar.py`: boxes, crawlers, walkers, legs and hoppers, on slopes and waves too, rods, wedges, carts and arms,
under all set-valued laws; `--cases` and `--judged` are of each. A judged run either ends as the judge's does, event by event, or says by
its status that it did not finish. Statuses other than "finished" in more than 2 % and every silent disagreement make the exit code 1. With
`--results` it goes on where it ended.
"""

from __future__ import annotations

import argparse
import json
import signal
import sys
import traceback
from collections import Counter
from itertools import zip_longest
from pathlib import Path

import numpy as np

import stickslip as ss

sys.path.insert(0, str(Path(__file__).resolve().parent))
from machine_draws.planar import FORMS, drawn

FAR = 1e-6  # of a motion: what may lie between two right answers after tens of events
LONGEST = 60  # CPU s of one case


def compared(form: str, seed: int, judged: bool) -> str:
    """ "agrees", what the run says, or how far it lies from the judge."""
    machine, start, periods = drawn(form, seed)
    try:
        run = ss.solve(machine, start=start, periods=periods)
    except ss.StickslipError as refused:
        return f"refused: {str(refused)[:160]}"
    if run.status != "finished":
        return f"says {run.status}"
    energy = ss.energy(run)
    gross = sum(abs(of) for of in (energy.drive, energy.gravity, energy.friction, energy.damping))
    off = (abs(energy.residual) * gross).max() / max(gross.max(), 1e-300)  # where all is at rest a part of nothing
    if off > 1e-8:
        return f"DIFFERS: the energy balance by {off:.1e}"
    if not judged:
        return "finished"
    try:
        judge = ss.solve(machine, start=start, periods=periods, method="dop853", rtol=1e-12)
    except ss.StickslipError as refused:
        return f"judge: {str(refused)[:160]}"
    both = (run.events, judge.events)
    off = max(np.max(abs(run.x[-1] - judge.x[-1])), np.max(abs(run.v[-1] - judge.v[-1])))
    if [(e.kind, e.part) for e in both[0]] != [(e.kind, e.part) for e in both[1]]:
        if off < FAR:
            return "agrees, with instants that fall together in another order"
        first = next(
            t for a, b in zip_longest(*both) for t in [(a or b).t] if a is None or b is None or (a.kind, a.part) != (b.kind, b.part)
        )
        return f"DIFFERS: {len(both[0])} and {len(both[1])} events, from {first:.9g} s on, by {off:.1e}; judge {judge.status}"
    late = max((abs(a.t - b.t) for a, b in zip(*both, strict=True)), default=0.0)
    return "agrees" if max(late, off) < FAR else f"DIFFERS: by {late:.1e} s and {off:.1e}, {len(both[0])} events"


def timed(form: str, seed: int, judged: bool) -> str:
    """The same, or that it took too long, or how it failed."""
    signal.setitimer(signal.ITIMER_PROF, LONGEST)
    try:
        return compared(form, seed, judged)
    except TimeoutError:
        return f"takes longer: than {LONGEST} s"
    except Exception as error:
        return f"FAILS: {error!r} {traceback.format_exc()[-300:]}"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def too_long(*_: object) -> None:
    """What an alarm does."""
    raise TimeoutError


def main() -> int:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=400)
    parser.add_argument("--judged", type=int, default=60)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--form", default="")
    parser.add_argument("--results")
    given = parser.parse_args()
    signal.signal(signal.SIGPROF, too_long)
    said: Counter[str] = Counter()
    bad, all_of = 0, 0
    done = {}
    if given.results and Path(given.results).exists():
        lines = map(json.loads, Path(given.results).read_text().splitlines())
        done = {(line["form"], line["seed"]): line["says"] for line in lines}
    for n in range(given.first, given.first + given.cases):
        for form in (form for form in FORMS if given.form in form):
            words = done.get((form, n)) or timed(form, n, n < given.first + given.judged)
            kind = words.split(":")[0]
            said[f"{form}: {kind}"] += 1
            all_of += 1
            bad += kind not in ("agrees", "finished", "agrees, with instants that fall together in another order")
            if kind not in ("agrees", "finished"):
                print(form, n, words, flush=True)
            if given.results and (form, n) not in done:
                with Path(given.results).open("a") as file:
                    file.write(json.dumps({"form": form, "seed": n, "says": words}) + "\n")
    for what, count in sorted(said.items()):
        print(f"{count:6d} {what}")
    return int(any("DIFFERS" in what or "FAILS" in what for what in said) or bad > 0.02 * all_of)


if __name__ == "__main__":
    sys.exit(main())
