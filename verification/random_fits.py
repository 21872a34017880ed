"""Random synthetic records by sensors that are off, fitted: whether intervals hold the truth, and whether what cannot be told is said.

Run: python verification/random_fits.py [count] [first seed] [file]. The file (random_fits.jsonl) has one line of JSON for each seed and is
read again: what stands there is not done twice. A seed's class is its remainder by the number of classes. 2000 fits take some 20 minutes
of one core: the matrices are small, so that libraries of linear algebra that share them among threads would only wait.
"""

from __future__ import annotations

import dataclasses
import json
import os
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

import numpy as np

import stickslip as ss
from stickslip.basics.errors import StickslipError
from stickslip.inverse.identification.law_forces import driven_force
from stickslip.inverse.identification.motions import PrescribedMotion

Random = np.random.Generator
STARTS = 16


# records with errors ----------------------------------------------------------------------------------------------


def colour(random: Random) -> float:
    """Correlation of neighbouring samples of noise: white as often as not."""
    return float(random.choice([0.0, 0.0, 0.5, 0.8]))


def noise(random: Random, level: float, count: int, rho: float) -> Any:
    """White noise, or noise that remembers some samples (first-order autoregressive), of the same standard deviation."""
    white = random.normal(size=count)
    found = np.empty(count)
    found[0] = white[0]
    for k in range(1, count):
        found[k] = rho * found[k - 1] + np.sqrt(1 - rho**2) * white[k]
    return level * found


def shown(random: Random, t: Any, y: Any, level: float, gain: float, rho: float) -> tuple[Any, Any]:
    """Times and values as a sensor shows them: its gain, a zero, a drift, noise; and now and then a part of the record is missing."""
    size = float(np.std(y))
    t, zero, drift = t - t.mean(), float(random.normal(0, 0.05 * size)), float(random.normal(0, 0.05 * size)) / np.ptp(t)
    value = gain * y + zero + drift * t + noise(random, level, len(t), rho)
    kept = np.ones(len(t), bool)
    if random.integers(4) == 0:
        begin = int(random.integers(len(t) // 4, len(t) // 2))
        kept[begin : begin + len(t) // 10] = False
    return t[kept] - t[0], value[kept]


def velocity_record(random: Random, robot: Any, gain: float) -> ss.Record:
    """A record of a robot's velocity with noise of a few per cent."""
    clean = ss.virtual_rig(robot, seed=0, periods=20, phase=float(random.uniform()))["velocity"]
    level = float(np.std(clean.values)) * 10 ** float(random.uniform(-2.5, -1.2))
    t, v = shown(random, clean.t, clean.values, level, gain, colour(random))
    return ss.Record.of(t, {"velocity [m/s]": v}, synthetic=True)


def strokes(random: Random) -> tuple[Any, Any]:
    """Times and positions of a few strokes with a faster motion on top."""
    t = np.linspace(0, 3, 1200)
    a, b = float(random.uniform(1e-4, 4e-4)), float(random.uniform(0.0, 0.3))
    return t, a * (np.sin(2 * np.pi * t) + b * np.sin(2 * np.pi * 3 * t))


def force_record(random: Random, law: Any, gain: float, rho: float | None = None) -> ss.Record:
    """A record of force and position under a load of 10 N."""
    t, x = strokes(random)
    v = np.concatenate([[0.0], np.diff(x) / np.diff(t)])
    force = driven_force(law, PrescribedMotion(t, v, np.full(len(t), 10.0), np.zeros(len(t)), 0, False, ""))[:, 0]
    start, size = float(x[0]), float(np.std(force))
    at, F = shown(random, t, force, size * 10 ** float(random.uniform(-2.5, -1.2)), gain, colour(random) if rho is None else rho)
    return ss.Record.of(at, {"position [m]": np.interp(at, t - t[0], x) - start, "force [N]": F}, synthetic=True)


# classes ----------------------------------------------------------------------------------------------------------


def covered(fit: ss.identification.Fit, truth: dict[str, float]) -> dict[str, Any]:
    """Which 95 % intervals hold the truth, and by how many standard errors the values are off."""
    found = {}
    for name, value in truth.items():
        low, high = fit.interval(name)
        error = fit.errors[name]
        found[name] = [bool(low <= value <= high), float((fit.values[name] - value) / error) if np.isfinite(error) else 0.0]
    return {"held": found, "undetermined": list(fit.undetermined)}


def rig(random: Random, law: str) -> tuple[dict[str, Any], dict[str, float], dict[str, Any]]:
    """Arguments that are known, the truth, and bounds."""
    mu = float(random.uniform(0.12, 0.19))
    truth, free = {"mu0": mu}, {"mu0": (0.05, 0.21)}
    if law != "coulomb" and random.integers(2):
        truth["f0"], free = mu * float(random.uniform(1.1, 1.5)), {"mu0": (0.05, 0.5), "f0": (0.05, 0.8)}
    known = {"tilt_deg": float(random.uniform(1.5, 4.0)), "law": law}
    return known, truth, free


def fitted_rig(random: Random, law: str, count: int) -> dict[str, Any]:
    known, truth, free = rig(random, law)
    gain, amplitudes = float(random.normal(1.0, 0.02)), [float(a) for a in random.uniform(5e-4, 9e-4, count)]
    records = [velocity_record(random, ss.presets.piezo_rig(amplitude=a, **known, **truth), gain) for a in amplitudes]
    return covered(ss.identify(records, ss.presets.piezo_rig, amplitude=amplitudes, free=free, starts=STARTS, **known), truth)


def set_valued(random: Random) -> dict[str, Any]:
    return fitted_rig(random, str(random.choice(["coulomb", "coulomb-static"])), 1)


def dynamic(random: Random) -> dict[str, Any]:
    return fitted_rig(random, "lugre", 1)


def several(random: Random) -> dict[str, Any]:
    return fitted_rig(random, str(random.choice(["coulomb", "coulomb-static", "lugre"])), int(random.integers(2, 4)))


def force_loops(random: Random) -> dict[str, Any]:
    """Forces over strokes; the sensor's zero is known to 1 % of the load, as otherwise it is confounded with the law's asymmetry."""
    mu = {"mu_plus": float(random.uniform(0.15, 0.4)), "mu_minus": float(random.uniform(0.15, 0.4))}
    free: dict[str, Any] = {name: (0.02, 1.0) for name in mu}
    stiff, kind = {"sigma0": float(10 ** random.uniform(4.7, 5.5))}, random.integers(3)
    make: Any = [ss.Coulomb, ss.CoulombViscous, ss.LuGre][kind]
    more = [{}, {"viscous": float(random.uniform(50.0, 500.0))}, stiff][kind]
    fixed = [{}, {}, dict(f_plus=None, f_minus=None, sigma1=0.0, sigma2=0.0, v_s=1e-3)][kind]
    free |= [{}, {"viscous": (0.0, 2000.0)}, {"sigma0": (1e4, 1e6, "log")}][kind]
    truth = {**mu, **more}
    record = force_record(random, make(**truth, **fixed), float(random.normal(1.0, 0.02)))
    fit = ss.identify(record, make, free=free, load=10.0, starts=STARTS, **fixed)
    return covered(fit, truth)


def confounded(random: Random) -> dict[str, Any]:
    """Two numbers of which one combination acts: they are named, with a combination that the truth has too."""
    kind = random.integers(3)
    if kind == 0:
        robot = ss.presets.piezo_rig(tilt_deg=2.0, amplitude=float(random.uniform(5e-4, 8e-4)), law="coulomb")
        truth = {"body_mass": robot.body_mass, "inner_mass": robot.inner_mass}
        fit = ss.identify(
            velocity_record(random, robot, 1.0), robot, free={"body_mass": (0.02, 0.2), "inner_mass": (0.002, 0.05)}, starts=STARTS
        )
    elif kind == 1:
        truth = {"factor": float(random.uniform(0.6, 1.8)), "mu": float(random.uniform(0.15, 0.35))}
        fit = ss.identify(
            force_record(random, product(**truth), 1.0), product, free={"factor": (0.5, 2.0), "mu": (0.1, 0.4)}, load=10.0, starts=STARTS
        )
    else:
        truth = {"dry": float(random.uniform(0.05, 0.2)), "seal": float(random.uniform(0.05, 0.2))}
        fit = ss.identify(
            force_record(random, both(**truth), 1.0), both, free={"dry": (0.0, 0.5), "seal": (0.0, 0.5)}, load=10.0, starts=STARTS
        )
    right = [abs(eval(text, {}, truth) - value) < 4 * error for text, value, error in fit.combinations]
    return {"named": set(fit.undetermined) == set(truth) and len(right) == 1 and all(right), "formulas": [c[0] for c in fit.combinations]}


def product(factor: float, mu: float) -> Any:
    return ss.Coulomb(factor * mu, 1.3 * factor * mu)


def both(dry: float, seal: float) -> Any:
    return ss.Coulomb(dry + seal, 1.3 * (dry + seal))


def outside(random: Random) -> dict[str, Any]:
    """Records by a law outside the fitted ones; whether what is left stands above the noise is told by a fit of that law itself."""
    rho = colour(random)
    if random.integers(2):
        law: Any = ss.Stribeck(0.2, 0.25, 0.2 * float(random.uniform(1.2, 2.0)), 0.4, v_s=float(random.uniform(2e-4, 1e-3)))
    else:
        law = ss.LuGre(0.2, 0.25, None, None, sigma0=float(10 ** random.uniform(4.3, 5)), sigma1=0.0, sigma2=0.0, v_s=1e-3)
    record, free = force_record(random, law, 1.0, rho), {"mu_plus": (0.02, 1.0), "mu_minus": (0.02, 1.0)}
    known = {f.name: getattr(law, f.name) for f in dataclasses.fields(law) if f.name not in free}
    fits = {
        "Coulomb": ss.identify(record, ss.Coulomb, free=free, starts=STARTS, load=10.0),
        "viscous": ss.identify(record, ss.CoulombViscous, free={**free, "viscous": (0.0, 2000.0)}, starts=STARTS, load=10.0),
    }
    itself = ss.identify(record, type(law), free=free, starts=STARTS, load=10.0, **known)
    above = min(fit.quality[0].rms for fit in fits.values()) / itself.quality[0].rms
    right = ss.identification.rank({**fits, "itself": itself}).supported == ("itself",)
    return {"above": float(above), "none": not ss.identification.rank(fits).supported, "white": rho == 0.0, "right": right}


CLASSES: dict[str, Callable[[Random], dict[str, Any]]] = {
    "velocity, set-valued": set_valued, "velocity, dynamic": dynamic, "several records": several, "force loops": force_loops,
    "confounded": confounded, "outside": outside,
}  # fmt: skip


# the table --------------------------------------------------------------------------------------------------------


def done(path: Path) -> dict[int, dict[str, Any]]:
    """What a file of results holds."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    return {line["seed"]: line for line in map(json.loads, lines)}


def one(seed: int) -> dict[str, Any]:
    """The result of one seed."""
    name = list(CLASSES)[seed % len(CLASSES)]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = CLASSES[name](np.random.default_rng(seed))
    except StickslipError as error:
        found = {"error": f"{type(error).__name__}: {str(error)[:200]}"}
    return {"seed": seed, "class": name, **found}


def table(results: dict[int, dict[str, Any]]) -> str:
    """One line for each class."""
    lines = []
    for name in CLASSES:
        rows = [r for r in results.values() if r["class"] == name]
        good = [r for r in rows if "error" not in r]
        said = f"{name}: {len(rows)} fits"
        if len(good) < len(rows):
            said += f", {len(rows) - len(good)} refused"
        held = [h for r in good for h, _ in r.get("held", {}).values()]
        if held:
            sure = [h for r in good for n, (h, _) in r["held"].items() if n not in r["undetermined"]]
            said += (
                f"; {100 * np.mean(held):.1f} % of {len(held)} intervals hold the truth, {100 * np.mean(sure):.1f} % of {len(sure)} finite"
            )
        if good and "named" in good[0]:
            said += f"; {sum(r['named'] for r in good)} named with a right combination"
        if good and "none" in good[0]:
            above = [r["none"] for r in good if r["above"] > 1.05]
            right = [r["right"] for r in good if r["white"] and r["above"] > 1.05]
            said += f"; of {len(above)} with a residual 5 % above the noise {sum(above)} fit no law"
            said += f"; the law itself is supported alone in {sum(right)} of {len(right)} with white noise"
        lines.append(said)
    return "\n".join(lines)


def main() -> None:
    """Do what is not done, and say how it came out."""
    words = sys.argv[1:]
    count, first = int(words[0]) if words else 2000, int(words[1]) if len(words) > 1 else 0
    path = Path(words[2] if len(words) > 2 else "random_fits.jsonl")
    results = done(path)
    for seed in range(first, first + count):
        if seed not in results:
            results[seed] = one(seed)
            with path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(results[seed]) + "\n")
    print(table({seed: results[seed] for seed in range(first, first + count)}))


if __name__ == "__main__":
    main()
