"""Is any number of a chain silently wrong? 1000 random chains of two to five modules under every law, 200 of them against a second method.

Run: python verification/random_chains.py [--cases N] [--judged N] [--workers N] [--seed N]

Each chain runs from rest for ten periods by our solver; what does not finish is counted by its sentence. Judged ones run by SciPy on the
same machine in plain Python too, and velocities of all bodies are compared over the time in which an error of 1e-12 grows to 1e-6: the
same run is made once more from a start that is off by 1e-12 of the drive's velocity, and where the two are 1e6 times as far apart the
comparison ends. Where the methods differ by more than the tolerance of the less exact one, SciPy is asked once more, by another method:
if it differs from itself by a third as much, the case is open. What is left is a silent disagreement, and the exit code is 1.
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

import stickslip as ss
from stickslip.machine import machine_of
from stickslip.maths import pi

PERIODS, JUDGED = 10, 4
OFF, GROWN = 1e-12, 1e-6  # of the drive's velocity: how far off the second start is, and where the comparison ends
#: Largest difference of velocities in parts of the drive's: of two exact methods, and where steps are held to 1e-9.
EXACT, STEPS = 1e-7, 1e-5
SOFT = {"sigma0": 2e4, "sigma1": 20.0}  # bristles that plain Python can follow
LAWS = tuple(sorted(set(ss.LAWS) - {"bristle", "ratestate"}))  # bonds that form again by chance; creep that plain Python takes hours for


def law(rng: np.random.Generator) -> Any:
    """A law with other coefficients."""
    name = LAWS[rng.integers(len(LAWS))]
    found = ss.LAWS[name].example()
    changed = {k: v for k, v in SOFT.items() if hasattr(found, k)}
    for field in ("mu_plus", "mu_minus"):
        if isinstance(getattr(found, field, None), float):
            factor = rng.uniform(0.6, 1.5)
            for each in (field, field.replace("mu", "f")):
                if isinstance(getattr(found, each, None), float):
                    changed[each] = factor * getattr(found, each)
    return found.replace(**changed)


def chain(seed: int) -> ss.Chain:
    """The chain of a seed."""
    rng = np.random.default_rng([20261122, seed])
    count, omega, common = int(rng.integers(2, 6)), 65.4 * pi, law(rng)
    same_law = machine_of(_module(rng, omega, common)).has_inner_states or rng.random() < 0.5

    def of() -> Any:
        while not same_law:
            own = law(rng)
            if not machine_of(_module(rng, omega, own)).has_inner_states:
                return own
        return common

    modules = tuple(_module(rng, omega, of()) for _ in range(count))
    link = ss.Spring(stiffness=float(10 ** rng.uniform(1.5, 3.7)), damping=float(rng.uniform(0.0, 1.0)))
    return ss.Chain(modules, link, tuple(map(float, rng.uniform(-pi, pi, count))))


def _module(rng: np.random.Generator, omega: float, friction: Any) -> ss.Robot:
    body, inner, amplitude = rng.uniform(0.03, 0.1), rng.uniform(0.005, 0.02), rng.uniform(3e-4, 9e-4)
    return ss.Robot(float(body), float(inner), ss.Harmonic(amplitude=float(amplitude), omega=omega), friction)


def judged(machine: ss.Chain, run: Any) -> str:
    """What a second method says of a run."""
    stiff = machine_of(machine).has_inner_states
    scale, tolerance = float(machine.velocity_scale), STEPS if stiff else EXACT
    options = {"rtol": 1e-9} if stiff else {}
    near = ss.solve(machine, periods=JUDGED, start={"v": OFF * scale * np.ones(len(machine.modules))}, **options)
    t = np.linspace(0.0, JUDGED * machine.period, 200)
    mine = run.at(t)["v"]
    apart = np.max(abs(mine - near.at(t)["v"]), axis=1) / scale
    known = t[: int(np.argmax(apart > GROWN)) or len(t)]

    def by(method: str, rtol: float) -> Any:
        return ss.solve(machine, periods=JUDGED, method=method, rtol=rtol).at(known)["v"]

    other = by("radau", 1e-9) if stiff else by("dop853", 1e-12)
    difference = float(np.max(abs(mine[: len(known)] - other))) / scale
    if difference <= tolerance:
        return "agrees"
    again = by("dop853", 1e-11) if stiff else by("radau", 1e-10)
    return "open" if float(np.max(abs(other - again))) / scale > difference / 3 else f"SILENT by {difference:.2g}"


def case(seed: int, with_judge: bool) -> tuple[int, str, str]:
    """Seed, how the run ended, and what the judge says."""
    machine = chain(seed)
    options = {"rtol": 1e-9} if machine_of(machine).has_inner_states else {}
    try:
        run = ss.solve(machine, periods=PERIODS, **options)
    except ss.SolveError as error:
        return seed, str(error).partition(": ")[2].partition(";")[0], ""
    try:
        return seed, run.status, judged(machine, run) if with_judge else ""
    except ss.SolveError:
        return seed, run.status, "no judge"


def main() -> int:
    """Run all, print what ended how, and every silent disagreement."""
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, default in (("cases", 1000), ("judged", 200), ("workers", 2), ("seed", 0)):
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
    return int(verdicts["SILENT"] > 0 or ends["finished"] < 0.99 * given.cases)


if __name__ == "__main__":
    sys.exit(main())
