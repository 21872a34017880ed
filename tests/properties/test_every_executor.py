"""Long calls on threads, on processes, on Dask: the same results, bit for bit."""

import dataclasses
import functools
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
#: By name: the call, which takes where it is computed.
CALLS = {
    "sweep": lambda **where: ss.sweep(RIG, amplitude=AMPLITUDES, omega=[90.0, 200.0, np.nan], **LAW, tile=64, **where),
    "map": lambda **where: ss.map(
        RIG, refine=True, coarse=9, amplitude=np.linspace(2e-4, 8e-4, 33), omega=np.linspace(120, 240, 33), **LAW, **where
    ),
    "chaos_map": lambda **where: ss.dynamics.chaos_map(RIG, amplitude=AMPLITUDES, settle=40, periods=20, **LAW, **where),
}
MORE = {
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
    "optimise": lambda **where: ss.optimise(ROBOT, over={"drive.amplitude": (3e-4, 8e-4)}, **where).model,
    "propagate": lambda **where: ss.optimisation.propagate(ROBOT, {"friction.mu_plus": ("normal", 0.15, 0.005)}, samples=64, **where),
    "bootstrap": lambda **where: bootstrap(_fitted(), 4, seed=5, **where),
}


@functools.cache
def _fitted():
    """A fit of a steady curve."""
    free = {"friction.mu_plus": (0.1, 0.3), "friction.mu_minus": (0.1, 0.3)}
    return ss.identify(ss.virtual_rig(ROBOT, noise=1e-3, seed=3), ROBOT, free=free)


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
    with processes() as spawned, ThreadPoolExecutor(2) as threads:
        yield {"processes": spawned, "an executor of threads": threads}


def _agree(call, pools):
    mine = bits(call())
    for where, given in {"threads": {"workers": 2}, **{pool: {"executor": each, "workers": 2} for pool, each in pools.items()}}.items():
        assert bits(call(**given)) == mine, where


@pytest.mark.parametrize("name", CALLS)
def test_processes_and_threads_give_the_bits_of_one_thread(name, pools):
    _agree(CALLS[name], pools)


@pytest.mark.slow
@pytest.mark.parametrize("name", MORE)
def test_so_do_they_in_all_other_long_calls(name, pools):
    _agree(MORE[name], pools)


@pytest.mark.slow
@pytest.mark.parametrize("name", CALLS | MORE)
def test_and_so_do_clusters(name):
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, cluster.get_client() as client:
        _agree((CALLS | MORE)[name], {"Dask": client.get_executor()})
