"""Are the gradients right? Random machines of every sort, each derivative of V by each of their numbers against differences.

Run: python verification/random_gradients.py [--kinds N] [--draws N] [--points N] [--seed N] [--file FILE]

A kind is a law, drive and track of drawn_models.py, a sort of machine of machine_draws with a law (chains, worms, rows with stops,
capsules, stages, conveyors, joints, robots of several masses), or a preset; it is compiled once, and draws of it have other numbers, until
there are enough points. A point is a machine and one of its numbers. The reference is the mean velocity of periodic motions beside it,
each found by Newton's method to 1e-12 of the scales, and of these, Richardson's extrapolation of central differences with steps of 2e-4 and
1e-4 of the number; that of 4e-5 and 2e-5 tells how well it is known. Errors are measured by how much V changes when the number changes by
its own size, or by V, or by a hundredth of the velocity of the free body, whichever is largest. Points whose two estimates differ by a
third of the tolerance are beside a border (or beyond what differences can tell) and do not count; nor do those that a note calls one-sided.
Each kind is a line of the file, and kinds that are there are not run again. The exit code is 1 if a point misses the tolerance, or a
gradient ends in an error that is none of stickslip's own.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import machine_draws.drawing as draws_of
import numpy as np
from drawn_models import kinds, model_of
from machine_draws.kinds import SORTS, kinds as machine_kinds

import stickslip as ss
from stickslip.basics.batch import some_of
from stickslip.basics.errors import StickslipError
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.dynamics.derivatives.sensitivity import directions_of
from stickslip.dynamics.periodic.steady_motions import Closing
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates
from stickslip.inverse.optimisation.gradients import steady_motion
from stickslip.inverse.optimisation.results import moved_by
from stickslip.models.machine_adapter import machine_of

EXACT, LANES = 1e-7, 1e-5
STEPS = np.array([2e-4, 1e-4, 4e-5, 2e-5])  # of the number
SHARES = np.concatenate([STEPS, -STEPS])
FLOOR = 1e-2  # of the velocity of the free body: below it V counts as this
PRESETS = {
    "capsule": ss.presets.capsule(), "capsubot": ss.presets.capsubot(), "worm": ss.presets.worm(),
    "stage": ss.presets.stick_slip_stage(), "conveyor": ss.presets.conveyor(), "two modules": ss.presets.two_modules(),
}  # fmt: skip
ROBOTS = {
    f"{each} #{each.number}": each
    for each in kinds(200)
    if each.mechanism in ("", "forced_oscillator") and each.law != "bristle"  # a law for plain numbers only, which lanes do not run
}
MACHINES = {f"{each} #{each.number}": each for each in machine_kinds(250, 1)}
FOREIGN = "not told: "  # what errors begin with that are none of stickslip's own


def machines(name: str, draws: int, seed: int) -> Iterator[Any]:
    """The draws of a kind, by its name in the file."""
    if name in PRESETS:
        yield from (jittered(PRESETS[name], np.random.default_rng([seed, i])) for i in range(draws))
    elif name in ROBOTS:
        batch = model_of(ROBOTS[name], draws, seed)
        yield from (one_of(batch, i) for i in range(draws))
    else:
        kind = MACHINES[name]
        cases = draws_of.drawn(SORTS[kind.machine][0], kind, draws, seed)
        yield from (cases.one(i) for i in range(draws))


def names(count: int) -> list[str]:
    """The presets, and then robots of one inner mass and other machines in turn."""
    mixed = [name for pair in zip(ROBOTS, MACHINES, strict=False) for name in pair]
    return [*PRESETS, *mixed][:count]


def one_of(batch: Any, i: int) -> Any:
    """One case of a batch, with plain numbers."""
    return replace_leaf(batch, {name: float(np.ravel(value)[0]) for name, value in leaves(some_of(batch, [i]))})


def jittered(base: Any, rng: np.random.Generator) -> Any:
    """The same machine with numbers that differ by up to a tenth, of those whose change leaves the period what it is."""
    moved = {name: float(value) * float(rng.uniform(0.9, 1.1)) for name, value in leaves(base) if name in directions_of("draw", base, None)}
    return replace_leaf(base, moved)


def examined(machine: Any) -> tuple[list[tuple[str, float]], dict[str, int]]:
    """Names and errors, in parts of the tolerance, of the points that count; and how many of the others there are of each sort."""
    try:
        moved = directions_of("gradient", machine, None)
        moved = {name: of for name, of in moved.items() if dict(leaves(machine))[name] != 0.0}
        slopes = ss.optimisation.gradient(machine, wrt=list(moved))
    except StickslipError as error:
        return [], {str(error).partition("; ")[0].partition(" (residual")[0][:60]: 1}
    sided = {note.partition(":")[0] for note in slopes.notes if "one-sided" in note}
    found, tolerance = [], LANES if machine_of(machine).has_inner_states else EXACT
    counts = {"one-sided": len(sided), "beside a border": 0}
    unit = FLOOR * float(machine_of(machine).free_velocity)
    for (name, slope), (coarse, fine, V) in zip(slopes.items(), references(machine, moved), strict=True):
        size = abs(float(dict(leaves(machine))[name]))
        scale = max(abs(V), abs(fine) * size, unit)
        if name in sided or not np.isfinite(slope):
            counts["one-sided"] += name not in sided
        elif not abs(coarse - fine) * size <= tolerance * scale / 3:
            counts["beside a border"] += 1
        else:
            found.append((name, abs(slope - coarse) * size / scale / tolerance))
    return found, counts


def references(machine: Any, moved: dict[str, tuple[str, ...]]) -> Iterator[tuple[float, float, float]]:
    """Of each number the derivative of V by longer and by shorter steps, and V."""
    own, at = dict(leaves(machine)), coordinates(machine)
    motion, orbit, _ = steady_motion(machine, moved, at)
    k, m = len(moved), len(SHARES)
    sizes = np.array([abs(float(own[name])) for name in moved])
    moves: dict[str, Any] = {}
    for i, parts in enumerate(moved.values()):
        for name in parts:
            moves.setdefault(name, np.zeros((k, m)))[i] = sizes[i] * SHARES
    near = moved_by(machine, {name: values.ravel() for name, values in moves.items()})
    starts = np.repeat(motion.nearer, k * m, axis=0)
    changes = np.nan_to_num(motion.changes[0])
    starts[:, : at.smooth] += (SHARES[:, None] * (sizes[:, None] * changes)[:, None]).reshape(k * m, -1)
    followed = Closing(near, at, {}, 0, 1e-11, k * m)
    closed = followed.at_state(followed.near(starts, orbit.period).nearer, orbit.period)
    V = np.where(closed.missed <= 1e-9, closed.mean_velocity, np.nan).reshape(k, 2, len(STEPS))
    slopes = (V[:, 0] - V[:, 1]) / (2 * STEPS * sizes[:, None])
    for each in slopes:
        yield (4 * each[1] - each[0]) / 3, (4 * each[3] - each[2]) / 3, float(motion.mean_velocity[0])


def line(name: str, draws: int, seed: int, most: int = 100) -> dict[str, Any]:
    """What a kind gives: its machines, one after the other, until there are so many points."""
    began, worst, points, missed = time.process_time(), 0.0, 0, []
    counts: dict[str, int] = {}
    try:
        for i, machine in enumerate(machines(name, draws, seed)):
            found, others = examined(machine)
            points += len(found)
            worst = max([worst, *(error for _, error in found)])
            missed += [(i, number, error) for number, error in found if error > 1.0]
            for what, count in others.items():
                counts[what] = counts.get(what, 0) + count
            if points >= most:
                break
    except StickslipError as error:
        counts[str(error)[:60]] = 1
    except Exception as error:  # told, or the other kinds would not be run
        counts[f"{FOREIGN}{type(error).__name__}: {error}"[:100]] = 1
    return {"kind": name, "points": points, "worst": worst, "missed": missed, "others": counts, "seconds": time.process_time() - began}


def main() -> int:
    """Run all kinds that the file does not have, and sum up."""
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, default in (("kinds", 150), ("draws", 40), ("points", 100), ("seed", 1)):
        words.add_argument(f"--{name}", type=int, default=default)
    words.add_argument("--file", type=Path, default=Path("random_gradients.jsonl"))
    given = words.parse_args()
    rows = [json.loads(text) for text in given.file.read_text().splitlines()] if given.file.exists() else []
    done = {row["kind"] for row in rows}
    for name in names(given.kinds):
        if name not in done:
            rows.append(line(name, given.draws, given.seed, given.points))
            print(json.dumps(rows[-1]), flush=True)
            with given.file.open("a") as file:
                print(json.dumps(rows[-1]), file=file)
    points, missed = sum(row["points"] for row in rows), sum(len(row["missed"]) for row in rows)
    foreign = sum(what.startswith(FOREIGN) for row in rows for what in row["others"])
    print(f"{points} points of {len(rows)} kinds; worst {max(row['worst'] for row in rows):.2g} of the tolerance; {missed} beyond it")
    return int(missed + foreign > 0)


if __name__ == "__main__":
    sys.exit(main())
