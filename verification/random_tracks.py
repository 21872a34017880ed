"""Is any number of a moving track silently wrong? 500 random stages and conveyors under every law, 60 of them against a second method.

Run: python verification/random_tracks.py [--cases N] [--judged N] [--workers N] [--seed N]

Each runs from rest for eight periods by our solver; what does not finish is counted by its sentence. Under laws with inner states a run may
end where the load is gone, and nowhere else. Judged ones run by SciPy on the same machine in plain Python too. The rest is as in
random_chains.py: a second start that is off by 1e-12 says how long two runs can be compared, and where SciPy differs from itself by a
third as much the case is open. What is left is a silent disagreement, and the exit code is 1.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

import numpy as np
from random_chains import EXACT, GROWN, OFF, STEPS, law

import stickslip as ss
from stickslip.drives.shifted import Shifted
from stickslip.machine import machine_of
from stickslip.maths import pi
from stickslip.summary import STATUS

PERIODS, JUDGED = 8, 4


def motion(rng: np.random.Generator, stroke: float, period: float, jumps: bool) -> Any:
    """A motion with about this stroke, at another phase."""
    kind = rng.choice([0, 1, 2, 3] if jumps else [0, 1, 2])
    omega = 2 * pi / period
    if kind == 0:
        found: Any = ss.Harmonic(amplitude=stroke / 2, omega=omega)
    elif kind == 1:
        found = ss.MultiHarmonic(amplitudes=(0.4 * stroke, 0.12 * stroke), phases=(0.0, float(rng.uniform(-pi, pi))), omega=omega)
    elif kind == 3:
        rise = period * float(rng.uniform(0.55, 0.95))
        found = ss.Sawtooth(stroke=stroke, rise=rise, fall=period - rise)
    else:
        first = float(rng.uniform(0.2, 0.8))
        size = 8 * stroke / period**2
        found = ss.Pieces(durations=(first * period, (1 - first) * period), accelerations=(size * (1 - first), -size * first))
    return Shifted(found, float(rng.uniform(-1.0, 1.0))) if rng.random() < 0.5 else found


def track(seed: int) -> ss.MovingTrack:
    """The stage or the conveyor of a seed; its load is positive at the start."""
    rng = np.random.default_rng([20261123, seed])
    friction, mass = law(rng), float(10 ** rng.uniform(-2.0, -0.5))
    tilt, force = float(rng.uniform(-0.1, 0.1)), 0.0
    if rng.random() < 0.4:
        load = float(rng.uniform(1.0, 20.0))
        period = float(10 ** rng.uniform(-3.0, -1.5))
        stroke = float(rng.uniform(0.1, 3.0)) * 0.2 * load / mass * period**2
        along = motion(rng, stroke, period, jumps=True)
        return ss.MovingTrack(mass=mass, along=along, tilt=tilt, friction=friction, load=load, force=float(rng.uniform(-0.05, 0.05)) * load)
    needs_load = isinstance(friction, (ss.ElastoPlastic, ss.ResetIntegrator))  # lengths of theirs must stay below that of sliding
    mass = 0.3 if needs_load else mass
    period, index = float(rng.uniform(0.01, 0.05)), float(rng.uniform(0.3, 0.5 if needs_load else 4.0))
    height = 2 * index * 9.81 * (period / (2 * pi)) ** 2
    along = motion(rng, height / float(rng.uniform(0.3, 2.0)), period, jumps=True)
    across = motion(rng, height, period, jumps=False)
    restitution = float(rng.choice([0.0, 0.0, rng.uniform(0.0, 0.9)]))
    return ss.MovingTrack(mass=mass, along=along, across=across, tilt=tilt, friction=friction, force=force, restitution=restitution)


def judged(machine: ss.MovingTrack, run: Any) -> str:
    """What a second method says of a run."""
    stiff = machine_of(machine).has_inner_states
    scale, tolerance = float(machine.velocity_scale), STEPS if stiff else EXACT
    options = {"rtol": 1e-9} if stiff else {}
    near = ss.solve(machine, periods=JUDGED, start={"v": OFF * scale}, **options)
    end = min(JUDGED * machine.period, float(run.t[-1]), float(near.t[-1]))
    t = np.linspace(0.0, end * (1 - 1e-6), 200)
    mine = run.at(t)["x"] / machine.period
    apart = abs(mine - near.at(t)["x"] / machine.period) / scale
    known = t[: int(np.argmax(apart > GROWN)) or len(t)]

    def by(method: str, rtol: float) -> Any:
        other = ss.solve(machine, periods=JUDGED, method=method, rtol=rtol)
        return other.at(known[known <= float(other.t[-1])])["x"] / machine.period

    other = by("radau", 1e-9) if stiff else by("dop853", 1e-12)
    if len(other) < len(known):
        return "SILENT by its end"
    difference = float(np.max(abs(mine[: len(known)] - other))) / scale
    if difference <= tolerance:
        return "agrees"
    again = by("dop853", 1e-11) if stiff else by("radau", 1e-10)
    return "open" if float(np.max(abs(other - again))) / scale > difference / 3 else f"SILENT by {difference:.2g}"


def case(seed: int, with_judge: bool) -> tuple[int, str, str]:
    """Seed, how the run ended, and what the judge says."""
    machine = track(seed)
    stiff = machine_of(machine).has_inner_states
    try:
        run = ss.solve(machine, periods=PERIODS, **({"rtol": 1e-9} if stiff else {}))
    except ss.SolveError as error:
        return seed, str(error).partition(": ")[2].partition(";")[0], ""
    if run.lost_contact and not stiff:
        return seed, run.status, "SILENT by a contact that is lost and could fly"
    try:
        return seed, run.status, judged(machine, run) if with_judge else ""
    except ss.SolveError:
        return seed, run.status, "no judge"


def main() -> int:
    """Run all, print what ended how, and every silent disagreement."""
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, default in (("cases", 500), ("judged", 60), ("workers", 2), ("seed", 0)):
        words.add_argument(f"--{name}", type=int, default=default)
    given, began = words.parse_args(), time.time()
    ends, verdicts = Counter[str](), Counter[str]()
    with ProcessPoolExecutor(given.workers, mp_context=get_context("spawn")) as pool:
        seeds = range(given.seed, given.seed + given.cases)
        for seed, end, verdict in pool.map(case, seeds, [i < given.judged for i in range(given.cases)]):
            ends[end] += 1
            if verdict:
                verdicts[verdict.partition(" by")[0]] += 1
            if "SILENT" in verdict or end != "finished":
                print(f"seed {seed}: {end} {verdict}", flush=True)
    print(f"{dict(ends)}; {dict(verdicts)}; {time.time() - began:.0f} s")
    well = ends["finished"] + ends[STATUS[6]]
    return int(verdicts["SILENT"] > 0 or well < 0.99 * given.cases)


if __name__ == "__main__":
    sys.exit(main())
