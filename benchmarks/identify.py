"""A fit of friction to a measured loop beside lmfit and emcee on the same least-squares problem, whose model is written here once more.

Run: python benchmarks/identify.py [--steps 3000]. A minute or two; needs lmfit and emcee (pip install lmfit emcee).
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import stickslip as ss

LOAD, NOISE, V_S, COUNT = 10.0, 0.01, 5e-4, 600
TRUTH = {"mu_plus": 0.30, "mu_minus": 0.36, "f_plus": 0.40, "f_minus": 0.50, "sigma0": 6e4, "sigma2": 120.0}
OFFSET, WALKERS = 0.2, 32
MU = {name: (0.05, 1.0) for name in ("mu_plus", "mu_minus", "f_plus", "f_minus")}
FREE = {**MU, "sigma0": (1e4, 3e5), "sigma2": (0.0, 600.0)}


def strokes() -> tuple[Any, Any]:
    """Times and positions of three strokes with a faster motion on top."""
    t = np.linspace(0.0, 2.6, COUNT)
    return t, 2e-4 * np.sin(2 * np.pi * t) + 4e-5 * np.sin(2 * np.pi * 5 * t)


def lugre(t: Any, x: Any, numbers: Any) -> Any:
    """Forces of LuGre's law without bristle damping [N], array (samples, cases), exact for velocities that are constant between samples."""
    mu_plus, mu_minus, f_plus, f_minus, sigma0, sigma2, offset = numbers
    steps, ways = np.diff(t), np.diff(x)
    z, found = np.zeros_like(sigma0), np.empty((len(t), *np.shape(sigma0)))
    found[0] = offset
    for k, (h, way) in enumerate(zip(steps, ways, strict=True), 1):
        v = way / h
        mu, f = (mu_plus, f_plus) if v > 0 else (mu_minus, f_minus)
        end = np.sign(v) * LOAD * (mu + (f - mu) * np.exp(-((v / V_S) ** 2))) / sigma0
        z = end + (z - end) * np.exp(-abs(way / end))
        found[k] = sigma0 * z + sigma2 * v + offset
    return found


def record() -> tuple[Any, Any, Any]:
    """Times, positions and forces with noise."""
    t, x = strokes()
    clean = lugre(t, x, [np.array(v) for v in (*TRUTH.values(), OFFSET)])
    return t, x, clean + np.random.default_rng(4).normal(scale=NOISE, size=COUNT)


def ours(t: Any, x: Any, F: Any) -> tuple[Any, Any]:
    """Values and covariance, the sensor's offset last."""
    rec = ss.Record.of(t, {"x [m]": x, "F [N]": F})
    fit = ss.identify(rec, ss.LuGre, free=FREE, load=LOAD, noise=NOISE, sensor={"offset": None}, sigma1=0.0, v_s=V_S)
    n, slopes = len(FREE), np.append(fit.slopes, 1.0)
    return np.append(list(fit.values.values()), fit.sensor["offset"][0]), fit.spread[: n + 1, : n + 1] * np.outer(slopes, slopes)


def by_lmfit(t: Any, x: Any, F: Any) -> tuple[Any, Any]:
    """The same by lmfit, from a start of its own."""
    import lmfit

    start = lmfit.Parameters()
    for name, (low, high) in FREE.items():
        start.add(name, value=low + 0.3 * (high - low), min=low, max=high)
    start.add("offset", value=0.0)

    def rest(p: Any) -> Any:
        return (lugre(t, x, [np.array(v) for v in p.valuesdict().values()]) - F) / NOISE

    found = lmfit.minimize(rest, start, scale_covar=False, ftol=1e-13, xtol=1e-13)
    return np.array(list(found.params.valuesdict().values())), found.covar


def by_emcee(t: Any, x: Any, F: Any, near: Any, spread: Any, steps: int) -> tuple[Any, Any, Any]:
    """Means and standard deviations of the posterior, and how many independent samples they are from."""
    import emcee

    bounds = np.array([*FREE.values(), (-np.inf, np.inf)])

    def log_posterior(places: Any) -> Any:
        inside = ((places > bounds[:, 0]) & (places < bounds[:, 1])).all(axis=1)
        rest = (lugre(t, x, np.where(inside[:, None], places, near).T) - F[:, None]) / NOISE
        return np.where(inside, -0.5 * np.sum(rest**2, axis=0), -np.inf)

    rng = np.random.default_rng(1)
    sampler = emcee.EnsembleSampler(WALKERS, len(near), log_posterior, vectorize=True)
    sampler.random_state = np.random.RandomState(1).get_state()
    sampler.run_mcmc(rng.multivariate_normal(near, spread, WALKERS), steps)
    chain = sampler.get_chain(discard=steps // 5)
    independent = chain.shape[0] * WALKERS / sampler.get_autocorr_time(discard=steps // 5, tol=0)
    flat = chain.reshape(-1, len(near))
    return flat.mean(axis=0), flat.std(axis=0), independent


def timed(function: Callable[..., Any], *arguments: Any) -> tuple[Any, float]:
    """A result and the CPU time that it took [s]."""
    start = time.process_time()
    return function(*arguments), time.process_time() - start


def main() -> None:
    """All three, and how far they are apart."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=3000, help="steps of each walker of emcee")
    data, names = record(), [*FREE, "offset"]
    ours(*data)  # whatever is compiled or imported
    (value, spread), seconds = timed(ours, *data)
    error = np.sqrt(np.diag(spread))
    print(f"stickslip: {seconds:.2g} s")
    try:
        (theirs, covariance), seconds = timed(by_lmfit, *data)
        apart = abs(theirs - value) / error
        scaled = abs(covariance - spread) / np.outer(error, error)
        print(f"lmfit: {seconds:.2g} s; values differ by {apart.max():.1e} standard errors at most, the covariance by {scaled.max():.1e}")
    except ImportError:
        print("lmfit is not installed: pip install lmfit")
    try:
        (mean, sd, independent), seconds = timed(by_emcee, *data, value, spread, parser.parse_args().steps)
        print(f"emcee: {seconds:.2g} s, {independent.min():.0f} independent samples")
        of_mean, of_sd = (mean - value) / sd * independent**0.5, (sd / error - 1) * (2 * independent) ** 0.5
        print(f"{'':10}{'value':>12}{'error':>12}{'mean':>12}{'sd':>12}  apart, in Monte Carlo errors of mean and sd")
        for name, *row in zip(names, value, error, mean, sd, of_mean, of_sd, strict=True):
            print("{:10}{:12.5g}{:12.3g}{:12.5g}{:12.3g}  {:+.1f}, {:+.1f}".format(name, *row))
    except ImportError:
        print("emcee is not installed: pip install emcee")


if __name__ == "__main__":
    main()
