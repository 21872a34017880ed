"""The equations of problem.py for Numba: shared by every rival that calls back into Python or takes a C function."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from problem import PATH, SPEED, STRAIN

FAST = {"contract", "nsz", "arcp"}


@njit(inline="always")
def flow(t, v, z, p):
    """(v', z') in SI; p is a row of Problem.rows."""
    mu, extra = (p[3], p[4]) if v > 0 else (p[5], p[6])
    zdot = v - p[7] * abs(v) * z / (mu + extra * math.exp(-v * v * p[11]))
    return p[0] * math.sin(p[1] * t) - p[2] * (p[8] * z + p[9] * zdot + p[10] * v), zdot


@njit(inline="always")
def slopes(v, z, p):
    """The four derivatives of flow by v and z: v'_v, v'_z, z'_v, z'_z."""
    mu, extra = (p[3], p[4]) if v > 0 else (p[5], p[6])
    bump = extra * math.exp(-v * v * p[11])
    g = mu + bump
    per_z = -p[7] * abs(v) / g
    per_v = 1 - p[7] * z / g * (math.copysign(1.0, v) + abs(v) * 2 * v * p[11] * bump / g)
    return -p[2] * (p[9] * per_v + p[10]), -p[2] * (p[8] + p[9] * per_z), per_v, per_z


@njit(error_model="numpy", fastmath=FAST, cache=True)
def scaled_rhs(t, u, out, p):
    """out = u', u = (v / SPEED, z / STRAIN, x / PATH)."""
    v = u[0] * SPEED
    vdot, zdot = flow(t, v, u[1] * STRAIN, p)
    out[0], out[1], out[2] = vdot / SPEED, zdot / STRAIN, v / PATH


@njit(error_model="numpy", fastmath=FAST, cache=True)
def scaled_jacobian(u, out, p):
    """out[i, j] = d u'_i / d u_j."""
    vv, vz, zv, zz = slopes(u[0] * SPEED, u[1] * STRAIN, p)
    out[:] = 0.0
    out[0, 0], out[0, 1] = vv, vz * (STRAIN / SPEED)
    out[1, 0], out[1, 1] = zv * (SPEED / STRAIN), zz
    out[2, 0] = SPEED / PATH


@njit(error_model="numpy", fastmath=FAST, cache=True)
def rhs_tyu(t, u, p):
    """u' as a new array, for scipy."""
    out = np.empty(3)
    scaled_rhs(t, u, out, p)
    return out


@njit(error_model="numpy", fastmath=FAST, cache=True)
def jacobian_tyu(t, u, p):
    """The Jacobian as a new array, for scipy."""
    out = np.empty((3, 3))
    scaled_jacobian(u, out, p)
    return out
