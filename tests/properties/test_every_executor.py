"""Long calls in threads, in processes, on loky and on Dask: the same results, bit for bit."""

import contextlib
import dataclasses
import functools
import importlib.util
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import xarray as xr

import stickslip as ss
from spawned import processes
from stickslip.inverse.identification.bootstrapping import bootstrap

RIG = ss.presets.piezo_rig
LAW = {"tilt_deg": 1.7, "law": "coulomb"}
ROBOT, AMPLITUDES = RIG(amplitude=6e-4, **LAW), np.linspace(2e-4, 8e-4, 140)  # a chunk has 128 cases
FALL = ss.SwitchingFlow(lambda t, y, n: (y[1], -n.g), numbers={"g": 10.0})
OVER = {"drive.amplitude": (3e-4, 8e-4)}
FREE = {"friction.mu_plus": (0.1, 0.3), "friction.mu_minus": (0.1, 0.3)}
#: Of each kind one, whose tests are quick.
QUICK = {
    "sweep": lambda **where: ss.sweep(RIG, amplitude=AMPLITUDES, omega=[90.0, 200.0, np.nan], **LAW, tile=64, **where),
    "map": lambda **where: ss.map(
        RIG, refine=True, coarse=9, amplitude=np.linspace(2e-4, 8e-4, 33), omega=np.linspace(120, 240, 33), **LAW, **where
    ),
    "chaos_map": lambda **where: ss.dynamics.chaos_map(RIG, amplitude=AMPLITUDES, settle=40, periods=20, **LAW, **where),
    "identify": lambda **where: fit_of(
        [1.61e-3, 4.31e-3], RIG, free={"mu0": (0.05, 0.5)}, tilt_deg=1.7, amplitude=[5e-4, 8e-4], law="coulomb", starts=6, **where
    ),
}
#: By name: the call, which takes where it is computed.
CALLS = QUICK | {
    "sweep of a flow": lambda **where: ss.sweep(FALL, g=[5.0, 10.0], start=[1.0, 0.0], duration=1.0, tile=1, **where),
    "sweep along": lambda **where: ss.sweep(
        RIG, amplitude=AMPLITUDES[::20], omega=[90.0, 200.0], **LAW, continue_along="amplitude", tile=1, **where
    ),
    "sweep, observed": lambda **where: ss.sweep(
        RIG, amplitude=AMPLITUDES, **LAW, tile=64, observe={"fastest": ss.observable(lambda s: s.v, "max")}, **where
    ),
    "bifurcation": lambda **where: ss.bifurcation(
        RIG, parameter="amplitude", values=AMPLITUDES, follow=False, settle=40, points=32, **LAW, **where
    ),
    "basins": lambda **where: ss.basins(ROBOT, v=np.linspace(-0.1, 0.1, 140), settle=40, **where).map,
    "attractors": lambda **where: ss.attractors(
        RIG, parameter="amplitude", values=[3e-4, 6e-4], starts={"v": np.linspace(-0.1, 0.1, 140)}, settle=40, **LAW, **where
    ),
    "largest_exponents": lambda **where: ss.dynamics.largest_exponents(RIG(amplitude=AMPLITUDES, **LAW), 20, settle=20, **where),
    "atlas": lambda **where: (
        ss.atlas(RIG, over={"amplitude": [3.3e-4, 3.6e-4, 3.9e-4], "mu0": [0.17, 0.18]}, branches=0, **LAW, **where).map
    ),
    "optimise": lambda **where: ss.optimise(ROBOT, over=OVER, **where).model,
    "pareto": lambda **where: ss.optimisation.pareto(ROBOT, over=OVER, maximise="mean_velocity", minimise="drive_power", points=3, **where),
    "propagate": lambda **where: ss.optimisation.propagate(ROBOT, {"friction.mu_plus": ("normal", 0.15, 0.005)}, samples=64, **where),
    "bootstrap": lambda **where: bootstrap(_fitted(), 4, seed=5, **where),
    "identify, curves": lambda **where: fit_of(_curve(), ROBOT, free=FREE, starts=16, **where),
    "identify, forces": lambda **where: fit_of(
        _forces(),
        ss.Stribeck,
        free={"mu_plus": (0.1, 1.0), "f_plus": (0.1, 1.0), "v_s": (1e-5, 1e-2, "log")},
        load=10.0,
        sensor={},
        **where,
    ),
}


def fit_of(*args, **named):
    """What a fit of few starts comes to."""
    fit = ss.identify(*args, **named)
    return [fit.values, fit.point, fit.jacobian, fit.residuals, fit.agree, fit.notes, fit.provenance]


@functools.cache
def _curve():
    return ss.virtual_rig(ROBOT, noise=1e-3, seed=3)


@functools.cache
def _forces():
    """Friction over a slow sine, with noise."""
    t = np.linspace(0, 3, 600)
    x = 2e-4 * np.sin(2 * np.pi * t)
    F = (3.0 + 2.0 * np.exp(-((np.gradient(x, t) / 3e-4) ** 2))) * np.sign(np.gradient(x, t))
    noise = np.random.default_rng(0).normal(scale=0.1, size=len(t))
    return ss.Record.of(t, {"x [m]": x, "F [N]": F + noise}, roles={"F": "force"})


@functools.cache
def _fitted():
    """A fit of a steady curve."""
    return ss.identify(_curve(), ROBOT, free=FREE)


def bits(result):
    """A result as bytes by name."""
    if isinstance(result, xr.Dataset):
        columns = {str(name): (str(values.dtype), values.values.tobytes()) for name, values in result.variables.items()}
        return columns | {"attrs": str(result.attrs)}
    if dataclasses.is_dataclass(result):
        return {each.name: bits(getattr(result, each.name)) for each in dataclasses.fields(result)}
    if isinstance(result, (tuple, list)):
        return [bits(each) for each in result]
    return result.tobytes() if isinstance(result, np.ndarray) else repr(result)


@pytest.fixture(scope="module")
def pools():
    """Executors of this computer by name, made when they are asked for."""
    with contextlib.ExitStack() as kept:

        @functools.cache
        def of(name):
            if name == "Dask":
                import distributed

                cluster = kept.enter_context(distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None))
                return kept.enter_context(cluster.get_client()).get_executor()
            if name == "loky":
                import loky

                return kept.enter_context(loky.ProcessPoolExecutor(2))
            return kept.enter_context(processes() if name == "processes" else ThreadPoolExecutor(2))

        yield of


HERE, CLUSTERS = ("processes", "an executor of threads"), {"Dask": "distributed", "loky": "loky"}


@pytest.mark.parametrize(
    ("name", "wide"),
    [pytest.param(name, wide, marks=[pytest.mark.slow] * (wide or name not in QUICK)) for wide in (False, True) for name in CALLS],
)
def test_every_executor_gives_the_bits_of_one_thread(name, wide, pools):
    mine, where = bits(CALLS[name]()), CLUSTERS if wide else HERE
    there = [each for each in where if not wide or importlib.util.find_spec(CLUSTERS[each])]
    if not there:
        pytest.skip("neither distributed nor loky is installed")
    ways = {each: {"executor": pools(each), "workers": 2} for each in there} | ({} if wide else {"threads": {"workers": 2}})
    for each, given in ways.items():
        assert bits(CALLS[name](**given)) == mine, each
