"""Coverage of intervals over many fits of records with a known truth, and how wide the intervals are beside the errors."""

from __future__ import annotations

import json
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import stickslip as ss
from stickslip.inverse.identification.uncertainty import faults

__all__ = ["run", "truth_and_intervals"]


_ALIKE = 1e-9  # part of the largest power of an axis below which it is rounding
_NORMAL = 1.96  # standard errors at the ends of a 95 % interval


def truth_and_intervals(fit: ss.identification.Fit, truth: dict[str, float]) -> dict[str, Any]:
    """For each number: whether its interval holds the truth, and its error in standard errors; error and standard error over it.

    Where an interval is by profile its length on the side of the truth stands for 1.96 standard errors. The numbers of a fit share errors
    (a gain of the sensor is in all of them): the errors along the principal axes of their correlations, in standard errors, are
    independent, so that a share of these is as sure as their number says.
    """
    found = {}
    for name, value in truth.items():
        low, high = fit.interval(name)
        error = fit.errors[name]
        known = name not in fit.undetermined
        if known and name in fit.bent:  # what is stated is the interval, which has two lengths
            error = abs((high if value > fit.values[name] else low) - fit.values[name]) / _NORMAL
        off = (fit.values[name] - value) / error if known and error > 0 else 0.0
        found[name] = [bool(low <= value <= high), off, abs(fit.values[name] - value) / abs(value), error / abs(value) if known else None]
    return {"numbers": found, "axes": _along_axes(fit, truth), "faults": faults(fit)}


def _along_axes(fit: ss.identification.Fit, truth: dict[str, float]) -> list[float]:
    """Errors of the determined numbers along the principal axes of their correlations, in standard errors."""
    names = [name for name in truth if name not in fit.undetermined and 0 < fit.errors[name] < np.inf]
    which = [fit.names.index(name) for name in names]
    covariance = fit.covariance[np.ix_(which, which)]
    sizes = np.sqrt(np.diag(covariance))
    if not names or not np.isfinite(covariance).all():
        return []
    powers, axes = np.linalg.eigh(covariance / np.outer(sizes, sizes))
    off = np.array([fit.values[name] - truth[name] for name in names]) / sizes
    kept = powers > _ALIKE * powers.max()
    return [float(each) for each in (axes.T @ off)[kept] / np.sqrt(powers[kept])]


def run(classes: dict[str, Callable[[np.random.Generator], dict[str, Any]]], words: list[str], file: Path) -> None:
    """Do what is not done, and say how it came out: the number of fits, the first seed and the file are the words of the command."""
    count, first = int(words[0]) if words else 1000, int(words[1]) if len(words) > 1 else 0
    path = Path(words[2]) if len(words) > 2 else file
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    done = {line["seed"]: line for line in map(json.loads, lines)}
    names = list(classes)
    for seed in range(first, first + count):
        if seed in done:
            continue
        name, begun = names[seed % len(names)], time.process_time()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                found = classes[name](np.random.default_rng(seed))
        except Exception as error:  # one that is not ours is a defect; it is counted by its name
            found = {"error": f"{type(error).__name__}: {str(error)[:200]}"}
        done[seed] = {"seed": seed, "class": name, "seconds": round(time.process_time() - begun, 2), **found}
        with path.open("a", encoding="utf-8") as out:
            out.write(json.dumps(done[seed]) + "\n")
    rows = [done[seed] for seed in range(first, first + count)]
    for name in names:
        print(name, *_lines([row for row in rows if row["class"] == name]), sep="\n  ")
    print("all classes", *_lines(rows), sep="\n  ")


def _lines(rows: list[dict[str, Any]]) -> list[str]:
    good = [r for r in rows if "numbers" in r]
    refused = [f"seed {row['seed']}: {row['error']}" for row in rows if "error" in row]
    supported = [r for r in good if not r["faults"]]
    said = [f"{len(rows)} fits, {len(supported)} without a fault", *refused]
    for label, some in (("all", good), ("without a fault", supported)):
        numbers = [n for r in some for n in r["numbers"].values()]
        known = [n for n in numbers if n[3] is not None]
        if not known:
            continue
        held, far = sum(n[0] for n in known), sum(abs(n[1]) > 3 for n in known)
        (low, high), most = _binomial(held, len(known)), _binomial(far, len(known))[1]
        said.append(
            f"{label}: {100 * held / len(known):.1f} % of {len(known)} intervals hold ({100 * low:.1f} to {100 * high:.1f}), "
            f"{far} beyond three standard errors (below {100 * most:.1f} %), {len(numbers) - len(known)} not determined"
        )
        axes = np.array([each for r in some for each in r.get("axes", [])])
        if len(axes):
            within, far = int(np.sum(abs(axes) < _NORMAL)), int(np.sum(abs(axes) > 3))
            low, high = _binomial(within, len(axes))
            said.append(
                f"  of {len(axes)} independent errors {100 * within / len(axes):.1f} % are within 1.96 standard errors "
                f"({100 * low:.1f} to {100 * high:.1f}), {far} beyond three; their mean square is {np.mean(axes**2):.2f}"
            )
        errors, widths = np.array([n[2] for n in known]), np.array([n[3] for n in known])
        said.append(
            f"  median standard error {np.median(widths):.2g} of the number, median error times 1.48 {1.48 * np.median(errors):.2g}"
        )
    return said


def _binomial(held: int, count: int) -> tuple[float, float]:
    from scipy.stats import beta

    low = float(beta.ppf(0.025, held, count - held + 1)) if held else 0.0
    return low, float(beta.ppf(0.975, held + 1, count - held)) if held < count else 1.0
