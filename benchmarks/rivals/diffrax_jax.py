"""diffrax under jit and vmap in double precision, on the CPU, through JAX: Tsit5, and Kvaerno3 for the stiff problem.

`vmap` steps all cases together until the last one has finished; more lanes still pay, since each operation has a cost of its own.
"""

from __future__ import annotations

from functools import cache, partial
from time import process_time

import numpy as np

from problem import PATH, SPEED, STRAIN, Problem
from rivals.base import Outcome, Rival

LANES = 64


def _slope(t, u, p):
    """kernels.flow for JAX, in scaled states."""
    import jax.numpy as jnp

    v, z = u[0] * SPEED, u[1] * STRAIN
    mu, extra = jnp.where(v > 0, p[3], p[5]), jnp.where(v > 0, p[4], p[6])
    zdot = v - p[7] * jnp.abs(v) * z / (mu + extra * jnp.exp(-v * v * p[11]))
    vdot = p[0] * jnp.sin(p[1] * t) - p[2] * (p[8] * z + p[9] * zdot + p[10] * v)
    return jnp.stack([vdot / SPEED, zdot / STRAIN, v / PATH])


@cache
def _compiled(method: str):
    """Function of (rows, times, rtol) -> scaled path at the times, one per row."""
    import diffrax as dx
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_platforms", "cpu")
    jax.config.update("jax_enable_x64", True)

    def one(row, times, rtol):
        control = dx.PIDController(rtol=rtol, atol=rtol * jnp.array([1e-2, 1e-2, 1.0]), pcoeff=0.3, icoeff=0.4)
        done = dx.diffeqsolve(
            dx.ODETerm(_slope),
            getattr(dx, method)(),
            times[0],
            times[-1],
            1e-6,
            jnp.zeros(3),
            args=row,
            stepsize_controller=control,
            saveat=dx.SaveAt(ts=times),
            max_steps=None,
            adjoint=dx.ForwardMode(),
        )
        return done.ys[:, 2]

    return jax.jit(jax.vmap(one, in_axes=(0, None, None)))


def _run(method: str, problem: Problem, rtol: float) -> Outcome:
    solve = _compiled(method)
    rows, times = problem.rows, problem.times
    np.asarray(solve(rows[:LANES], times / 1000, rtol))
    start = process_time()
    paths = np.concatenate([np.asarray(solve(rows[k : k + LANES], times, rtol)) for k in range(0, len(rows), LANES)]) * PATH
    seconds = process_time() - start
    return problem.mean_velocity(paths[:, 1], paths[:, 2]), seconds


def _rival(method: str, **more) -> Rival:
    return Rival(name=f"diffrax {method}, jit, vmap", pip="diffrax", module="diffrax", run=partial(_run, method), **more)


RIVALS = (
    _rival("Tsit5", cases=64, settings=(1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8), skip_stiff="not run: explicit, 320 000 when tried"),
    _rival("Kvaerno3", cases=64, cases_stiff=16, settings=(1e-3, 1e-4, 1e-5, 1e-7), settings_stiff=(1e-3, 1e-4, 1e-5)),
)
