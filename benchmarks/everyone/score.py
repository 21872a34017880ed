"""Scores any simulator of dry friction on problems whose answers are known: python score.py ADAPTER.py [--rows T,P6] [--out FILE.json].

An adapter is a Python file with a function `mean_velocity(row)`, which gets a row of rows.json as a dictionary and returns a
number [m/s], or None if the simulator has no such problem. It may call another program. This script needs Python 3.11 and
nothing else; README.md says what is in a row.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import math
import statistics
import sys
import time
from pathlib import Path

ROWS = Path(__file__).with_name("rows.json")


def main(words: list[str] | None = None) -> int:
    """Score an adapter and print the table; 1 if a row is wrong."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("adapter", type=Path)
    parser.add_argument("--rows", default="", help="beginnings of ids, separated by commas")
    parser.add_argument("--out", type=Path, help="write the scores as JSON")
    given = parser.parse_args(words)
    wanted = tuple(given.rows.split(","))
    rows = [row for row in json.loads(ROWS.read_text(encoding="utf-8"))["rows"] if row["id"].startswith(wanted)]
    mean_velocity = loaded(given.adapter)
    scores = []
    for row in rows:
        scores.append(score(row, mean_velocity))
        print(line(scores[-1]), flush=True)
    print(summary(scores))
    if given.out:
        given.out.write_text(json.dumps(scores, indent=1) + "\n", encoding="utf-8")
    return int(any(one["verdict"] == "wrong" for one in scores))


def loaded(path: Path):
    """The function of an adapter."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    return module.mean_velocity


def score(row: dict, mean_velocity) -> dict:
    """What a simulator says of a row: its error in units of the row's velocity, digits, verdict, seconds."""
    began, problem = time.process_time(), ""
    try:
        value = mean_velocity(row)
    except Exception as error:  # a simulator may fail in its own way; the table says how
        value, problem = math.nan, f"{type(error).__name__}: {error}"
    found = {"id": row["id"], "value": value, "seconds": time.process_time() - began, "problem": problem}
    if value is None:
        return {**found, "error": None, "digits": None, "verdict": "not posed"}
    error = error_of(value, row)
    return {**found, "error": error, "digits": digits(error), "verdict": verdict(error, row["tolerance"])}


def error_of(value: float, row: dict) -> float:
    """The relative error; where nothing should move, the part of the velocity without friction."""
    known = row["mean_velocity"]
    return abs(value - known) / (abs(known) or row["velocity_unit"])


def digits(error: float) -> float:
    """Digits that are right, at most 15."""
    return 0.0 if not error < 1 else min(15.0, -math.log10(max(error, 1e-15)))


def verdict(error: float, tolerance: float) -> str:
    """`exact` within the row's own tolerance, `good` within 1e-3, `rough` within 5 per cent, else `wrong`."""
    for word, bound in (("exact", tolerance), ("good", max(1e-3, tolerance)), ("rough", 0.05)):
        if error <= bound:
            return word
    return "wrong"


def line(one: dict) -> str:
    """A row of the table."""
    if one["value"] is None:
        return f"{one['id']:22}  {one['verdict']}"
    told = f"{one['id']:22}  {one['verdict']:6} {one['digits']:5.1f} digits  {one['value']:+.12e} m/s"
    return f"{told}  {one['seconds']:8.2f} s  {one['problem']}".rstrip()


def summary(scores: list[dict]) -> str:
    """The last lines."""
    posed = [one for one in scores if one["value"] is not None]
    counts = {word: sum(one["verdict"] == word for one in scores) for word in ("exact", "good", "rough", "wrong", "not posed")}
    middle = statistics.median([one["digits"] for one in posed]) if posed else 0.0
    told = ", ".join(f"{number} {word}" for word, number in counts.items())
    return f"{len(scores)} rows: {told}; median {middle:.1f} digits; {sum(one['seconds'] for one in scores):.0f} s of CPU"


if __name__ == "__main__":
    sys.exit(main())
