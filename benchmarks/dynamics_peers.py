"""Other packages for dynamics on the same jobs: Lyapunov spectra of Lorenz' flow and of Henon's map, basins of Duffing's oscillator.

Called by ``dynamics.py``. A package that is not installed is named and passed over:
``pip install pynamicalsys jitcode lyapynov setuptools``.
"""

from __future__ import annotations

import contextlib
import io
import math
import os
import tempfile
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from time import process_time
from typing import Any, NamedTuple

import numpy as np

import stickslip as ss
from stickslip.maths import cos

Array = Any
START, SETTLE, TIME = [1.0, 1.0, 1.0], 100.0, 1000.0
ITERATIONS = 100_000
DAMPING, PUSH, OMEGA, PERIODS = 0.25, 0.1, 1.2, 60
SIDE = np.linspace(-2.0, 2.0, 50)


class Peer(NamedTuple):
    """A package's run of a job: what must be installed (nothing for us), and a function that prepares it and returns the run."""

    name: str
    needs: str
    prepare: Callable[[], Callable[[], Array]]


def our_lorenz() -> Callable[[], Array]:
    """Steps exact to rounding."""
    flow = ss.SwitchingFlow({0: lambda t, y: (10 * (y[1] - y[0]), y[0] * (28 - y[2]) - y[1], y[0] * y[1] - 8 / 3 * y[2])})
    return lambda: ss.dynamics.lyapunov_of_flow(flow, START, duration=TIME, settle=SETTLE).spectrum


def their_lorenz(integrator: str, **settings: float) -> Callable[[], Callable[[], Array]]:
    """Of pynamicalsys, with one of its integrators."""

    def prepare() -> Callable[[], Array]:
        from pynamicalsys import ContinuousDynamicalSystem

        system = ContinuousDynamicalSystem(model="lorenz system")
        system.integrator(integrator, **settings)
        return lambda: system.lyapunov(START, SETTLE + TIME, parameters=[10.0, 28.0, 8 / 3], transient_time=SETTLE)

    return prepare


def jitcode_lorenz() -> Callable[[], Array]:
    """A right side in C under SciPy's DOP853."""
    from jitcode import jitcode_lyap, y

    system = jitcode_lyap([10 * (y(1) - y(0)), y(0) * (28 - y(2)) - y(1), y(0) * y(1) - 8 / 3 * y(2)], n_lyap=3)
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder), quiet():
        system.compile_C()
    system.set_integrator("dop853", rtol=1e-10, atol=1e-10)
    times = np.arange(0.5, SETTLE + TIME + 0.25, 0.5)

    def run() -> Array:
        system.set_initial_value(np.array(START), 0.0)
        return np.mean([system.integrate(t)[1] for t in times][round(SETTLE / 0.5) :], axis=0)

    return run


def lyapynov_lorenz() -> Callable[[], Array]:
    """Plain Python with NumPy, RK4 with 0.01."""
    from lyapynov import LCE, ContinuousDS

    rates = lambda y, t: np.array([10 * (y[1] - y[0]), y[0] * (28 - y[2]) - y[1], y[0] * y[1] - 8 / 3 * y[2]])  # noqa: E731
    slopes = lambda y, t: np.array([[-10.0, 10.0, 0.0], [28 - y[2], -1.0, -y[0]], [y[1], y[0], -8 / 3]])  # noqa: E731
    steps = [round(length / 0.01) for length in (SETTLE, TIME)]
    return lambda: LCE(ContinuousDS(np.array(START), 0.0, rates, slopes, 0.01), 3, *steps, False)


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Without the words of a compiler."""
    kept = os.dup(1)
    with open(os.devnull, "w") as nowhere, contextlib.redirect_stdout(io.StringIO()):
        os.dup2(nowhere.fileno(), 1)
        try:
            yield
        finally:
            os.dup2(kept, 1)
            os.close(kept)


def our_henon() -> Callable[[], Array]:
    """A plain function, compiled with its derivatives."""
    henon = lambda x: (1 - 1.4 * x[0] * x[0] + x[1], 0.3 * x[0])  # noqa: E731
    return lambda: ss.dynamics.lyapunov_of_map(henon, [0.1, 0.1], iterations=ITERATIONS).spectrum


def their_henon() -> Callable[[], Array]:
    """Of pynamicalsys, compiled."""
    from pynamicalsys import DiscreteDynamicalSystem

    system = DiscreteDynamicalSystem(model="henon map")
    return lambda: system.lyapunov([0.1, 0.1], ITERATIONS + 1000, parameters=[1.4, 0.3], transient_time=1000)


def lyapynov_henon() -> Callable[[], Array]:
    """Plain Python with NumPy."""
    from lyapynov import LCE, DiscreteDS

    henon = lambda x, t: np.array([1 - 1.4 * x[0] * x[0] + x[1], 0.3 * x[0]])  # noqa: E731
    slopes = lambda x, t: np.array([[-2.8 * x[0], 1.0], [0.3, 0.0]])  # noqa: E731
    return lambda: LCE(DiscreteDS(np.array([0.1, 0.1]), 0, henon, slopes), 2, 1000, ITERATIONS, False)


def our_basins() -> Callable[[], Array]:
    """Which of the motions each start reaches."""
    field = lambda t, y: (y[1], y[0] - y[0] ** 3 - DAMPING * y[1] + PUSH * cos(OMEGA * t))  # noqa: E731
    flow = ss.SwitchingFlow({0: field}, {}, 2 * math.pi / OMEGA, states=("x", "v"))
    return lambda: ss.basins(flow, x=SIDE, v=SIDE, settle=PERIODS).map.attractor.values.reshape(-1)


def their_basins() -> Callable[[], Array]:
    """Of pynamicalsys: RK4 with a hundredth of a period, and clusters of strobe points."""
    from pynamicalsys import ContinuousDynamicalSystem

    system, period = ContinuousDynamicalSystem(model="duffing"), 2 * math.pi / OMEGA
    system.integrator("rk4", time_step=period / 100)
    starts = np.stack(np.meshgrid(SIDE, SIDE, indexing="ij"), axis=-1).reshape(-1, 2)
    how = {"parameters": [DAMPING, 1.0, 1.0, PUSH, OMEGA], "transient_time": PERIODS * period, "map_type": "SM", "sampling_time": period}
    return lambda: system.basin_of_attraction(starts, 4, eps=0.05, **how)


def wells(found: Array) -> str:
    """In how many of 50 starts the side of the motion is not that by SciPy's DOP853 at 1e-10, and how many motions were found."""
    from scipy.integrate import solve_ivp

    chosen = np.random.default_rng(1).choice(found.size, 50, replace=False)
    starts = np.stack(np.meshgrid(SIDE, SIDE, indexing="ij"), axis=-1).reshape(-1, 2)[chosen]
    rates = lambda t, y: (y[1], y[0] - y[0] ** 3 - DAMPING * y[1] + PUSH * math.cos(OMEGA * t))  # noqa: E731
    span = (0.0, PERIODS * 2 * math.pi / OMEGA)
    right = np.array([solve_ivp(rates, span, start, method="DOP853", rtol=1e-10, atol=1e-10).y[0, -1] > 0 for start in starts])
    sides = {label: right[found[chosen] == label].mean() > 0.5 for label in np.unique(found[chosen])}
    wrong = sum(sides[label] != side for label, side in zip(found[chosen], right, strict=True))
    return f"{len(np.unique(found))} motions, {wrong} of 50 starts elsewhere than by DOP853"


JOBS = {
    f"spectrum of Lorenz' flow over {TIME:g} units": (
        (
            Peer("stickslip", "", our_lorenz),
            Peer("pynamicalsys, rk4 0.01", "pynamicalsys", their_lorenz("rk4", time_step=0.01)),
            Peer("pynamicalsys, rk45 1e-10", "pynamicalsys", their_lorenz("rk45", rtol=1e-10, atol=1e-10)),
            Peer("jitcode, dop853 1e-10", "jitcode", jitcode_lorenz),
            Peer("lyapynov, RK4 0.01", "lyapynov", lyapynov_lorenz),
        ),
        lambda s: f"largest {s[0]:.5f} (0.9056), sum off by {abs(sum(s) + 41 / 3):.0e}",
    ),
    f"spectrum of Henon's map over {ITERATIONS} iterations": (
        (
            Peer("stickslip", "", our_henon),
            Peer("pynamicalsys", "pynamicalsys", their_henon),
            Peer("lyapynov", "lyapynov", lyapynov_henon),
        ),
        lambda s: f"largest {s[0]:.5f} (0.41922), sum off by {abs(sum(s) - math.log(0.3)):.0e}",
    ),
    f"basins of Duffing's oscillator, {len(SIDE)} x {len(SIDE)} starts": (
        (Peer("stickslip", "", our_basins), Peer("pynamicalsys, rk4", "pynamicalsys", their_basins)),
        wells,
    ),
}


def peers(rounds: int) -> None:
    """Print a table of each job: CPU seconds without compilation, the ratio to ours, and how right the result is."""
    for job, (runs, told) in JOBS.items():
        print(f"{job}            CPU [s]   ratio")
        ours = None
        for peer in runs:
            if peer.needs and find_spec(peer.needs) is None:
                print(f"  {peer.name}: not installed")
                continue
            run = peer.prepare()
            run()
            took, found = min((timed(run) for _ in range(rounds)), key=lambda pair: pair[0])
            ours = ours or took
            print(f"  {peer.name:<26} {took:10.2f} {took / ours:8.2f}   {told(np.asarray(found))}", flush=True)


def timed(run: Callable[[], Array]) -> tuple[float, Array]:
    """CPU seconds of this process, and the result."""
    begin = process_time()
    found = run()
    return process_time() - begin, found


if __name__ == "__main__":
    peers(1)
