"""What more contacts cost: chains of modules against one, exact and under LuGre friction, in one run on one core.

Run: python benchmarks/chains.py

Times are processor seconds of the process, the median of several interleaved runs; only their ratios mean anything. One module goes by the
same Taylor steps as a chain: its drive has a second harmonic a billionth as large, so that no closed arcs fit. Compile times are those of a
fresh cache folder, in a process of their own.
"""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

import stickslip as ss
from stickslip.engine import lanes, tableaux
from stickslip.maths import pi

CASES, PERIODS, REPEATS = 512, 60, 7
OMEGA = 65.4 * pi
COULOMB = ss.Coulomb(mu_plus=0.15, mu_minus=0.21)


def module(friction: object, drive: object) -> ss.Robot:
    """One module."""
    return ss.Robot(body_mass=0.06259, inner_mass=0.00948, drive=drive, friction=friction)


def chain(friction: object, count: int, phases: float) -> object:
    """A chain of modules whose phases are so far apart; one module for a count of one."""
    amplitude = np.linspace(5e-4, 7e-4, CASES)
    drive: object = ss.Harmonic(amplitude=amplitude, omega=OMEGA)
    if count == 1 and friction is COULOMB:
        drive = ss.MultiHarmonic(amplitudes=(amplitude, 1e-9 * amplitude), phases=(0.0, 0.0), omega=OMEGA)
    one = module(friction, drive)
    return (
        one if count == 1 else ss.Chain((one,) * count, ss.Spring(stiffness=1200.0, damping=0.4), tuple(phases * i for i in range(count)))
    )


def cost(model: object, rtol: float) -> float:
    """Processor seconds of a batch."""
    began = time.process_time()
    ss.solve(model, periods=PERIODS, keep="summary", rtol=rtol)
    return time.process_time() - began


def compared(label: str, models: dict[str, object], rtol: float, share: dict[str, int]) -> None:
    """Print the cost of each model over that of the first one, for each contact."""
    times: dict[str, list[float]] = {name: [] for name in models}
    for model in models.values():
        ss.solve(model, periods=2, keep="summary", rtol=rtol)
    for _ in range(REPEATS):
        for name, model in models.items():
            times[name].append(cost(model, rtol))
    first = statistics.median(times[next(iter(models))])
    for name in list(models)[1:]:
        ratio = statistics.median(times[name]) / first
        print(f"{label}, {name}: {ratio:.2f} times one module, {ratio / share[name]:.2f} for each contact")


def compile_times() -> None:
    """Print how long kernels take to compile, in a process and cache folder of their own."""
    for what in ("one Coulomb", "two Coulomb", "five Coulomb", "one LuGre", "two LuGre", "five LuGre", "sixteen Coulomb", "sixteen LuGre"):
        with tempfile.TemporaryDirectory() as folder:
            asked = [sys.executable, __file__, "--compile", what]
            found = subprocess.run(asked, env={**os.environ, "STICKSLIP_CACHE_DIR": folder}, capture_output=True, text=True)
        print(f"compile, {what}: {found.stdout.strip()} s")


def compiled(what: str) -> None:
    """Print the processor seconds of the kernels of one sort, without what all sorts share."""
    count, law = what.split()
    friction = COULOMB if law == "Coulomb" else ss.LuGre.example()
    tableau = None if law == "Coulomb" else tableaux.RODAS4
    record = count == "sixteen"
    spare = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=5e-4, law="coulomb").replace(friction=ss.Stribeck.example())
    lanes.kernel_of(spare, None, record)
    lanes.kernel_of(spare.replace(friction=ss.Dahl.example()), tableaux.RODAS4, record)
    model = chain(friction, {"one": 1, "two": 2, "five": 5, "sixteen": 16}[count], 0.4)
    began = time.process_time()
    lanes.kernel_of(model, tableau, record)
    print(f"{time.process_time() - began:.2f}")


def memory() -> None:
    """Print the most memory that the process has had after a summary of a million cases of five bodies."""
    amplitudes = np.linspace(4e-4, 8e-4, 1_000_000)
    one = module(COULOMB, ss.Harmonic(amplitude=6e-4, omega=OMEGA))
    head = one.replace({"drive.amplitude": amplitudes})
    ss.solve(ss.Chain((head, *(one,) * 4), ss.Spring(1200.0, 0.4), tuple(0.4 * i for i in range(5))), periods=4, keep="summary", workers=2)
    print(f"memory, 10^6 cases of five bodies: {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6:.2f} GB")


if __name__ == "__main__":
    if "--compile" in sys.argv:
        compiled(sys.argv[-1])
    else:
        exact = {f"{n} modules": chain(COULOMB, n, 0.5 * pi) for n in (1, 2, 5)}
        compared("exact", exact, 1e-6, {"2 modules": 2, "5 modules": 5})
        lugre = {f"{n} modules": chain(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4).friction, n, 0.0) for n in (1, 2, 5)}
        compared("LuGre in phase", lugre, 1e-4, {"2 modules": 2, "5 modules": 5})
        apart = {f"{n} modules": chain(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4).friction, n, 0.4 * pi) for n in (1, 2, 5)}
        compared("LuGre apart", apart, 1e-4, {"2 modules": 2, "5 modules": 5})
        compile_times()
        memory()
