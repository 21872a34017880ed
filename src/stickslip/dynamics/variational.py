r"""How a small change of the state grows along an orbit: the variational equation, with a saltation matrix at every switch.

Along the pieces of a trajectory :math:`\dot\Phi = J(t)\,\Phi` is a linear equation whose J comes from the law's own lines. It is
solved on every step of the dense output by the Radau IIA method of order 5, which damps stiff bristles as they are damped in
truth; all steps are solved at once. Where the mode switches, a change of the state also changes the instant of the switch:

.. math:: S = I + \frac{(f_+ - f_-)\,\nabla g^T}{\partial_t g + \nabla g \cdot f_-}

A body that comes to rest loses every memory of its velocity: that row of S is exactly zero. An impulse at a known instant has S = I.

References
----------
E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed., Springer 1996, table IV.5.6 (Radau IIA).
M. di Bernardo, C. Budd, A. Champneys, P. Kowalczyk, Piecewise-smooth Dynamical Systems, Springer 2008, section 2.5.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.dynamics.flows import offer_slopes, rates
from stickslip.dynamics.memories import remembered
from stickslip.friction.adapter import law_of
from stickslip.layout import of_one_contact
from stickslip.position import knows_position

__all__ = ["monodromy", "multipliers_of", "product", "saltation", "transfers"]

Array = Any
_S6 = 6**0.5
_INSIDE = 1.0 - 1e-6  # where the last stage looks: at the very end of a piece that ends on a kink of the law it would see the other side
#: Radau IIA with three stages: nodes and coefficients.
NODES = np.array([(4 - _S6) / 10, (4 + _S6) / 10, 1.0])
STAGES = np.array(
    [
        [(88 - 7 * _S6) / 360, (296 - 169 * _S6) / 1800, (-2 + 3 * _S6) / 225],
        [(296 + 169 * _S6) / 1800, (88 + 7 * _S6) / 360, (-2 - 3 * _S6) / 225],
        [(16 - _S6) / 36, (16 + _S6) / 36, 1 / 9],
    ]
)


def monodromy(run: Any, tolerance: float = 1e-9) -> Array:
    """The derivative of the state at the end of a run by the state at its start.

    Steps are halved until the matrix changes by less than `tolerance` of its size.

    Examples
    --------
    >>> import stickslip as ss
    >>> run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb"), periods=30)
    >>> last = ss.solve(run.model, periods=1, start={"v": run.strobe_v[-1]})
    >>> round(float(monodromy(last)[0, 0]), 6)  # type IV forgets all but this part in one period
    0.089023
    """
    run = of_one_contact("monodromy", run, "the switches of one contact are followed")
    before = product(transfers(run, 1)[0])
    for parts in (2, 4, 8, 16):
        after = product(transfers(run, parts)[0])
        if abs(after - before).max() <= tolerance * max(abs(after).max(), 1e-3):
            return after
        before = after
    return before


def transfers(run: Any, parts: int = 1) -> tuple[Array, Array]:
    """The transfer matrix of every part of every piece, each with the switch that follows it, and what it does to areas.

    Returns
    -------
    matrices : array (pieces * parts, d, d)
    areas : array (pieces * parts,)
        Logarithms of their determinants, by Liouville's formula: a stiff bristle's e^-1000 is far below rounding in the matrix.
    """
    pieces, model = run.pieces, run.model
    t, mode = np.asarray(pieces.t), run._modes
    grid = (t[:-1, None] + (np.arange(parts) / parts) * np.diff(t)[:, None]).ravel()
    h, index = np.repeat(np.diff(t) / parts, parts), np.repeat(np.arange(len(mode)), parts)
    matrices, areas = _steps(run, grid, h, index)
    if not law_of(model).dynamic:
        stuck = mode[index] == 0
        matrices[stuck, _place_of_v(model), :], areas[stuck] = 0.0, -np.inf
    changed = np.diff(mode) != 0
    if law_of(model).modes:
        changed |= np.any(np.diff(pieces.memory, axis=0) != 0, axis=1)
    for i in np.flatnonzero(changed):
        last, S = (int(i) + 1) * parts - 1, saltation(run, int(i) + 1)
        matrices[last] = S @ matrices[last]
        with np.errstate(divide="ignore"):
            areas[last] += np.log(abs(np.linalg.det(S)))
    return matrices, areas


def _place_of_v(model: Any) -> int:
    return int(knows_position(model))


def _states(run: Any, t: Array, index: Array) -> Array:
    """The coordinates (d, n) at instants on given pieces."""
    x, v, z = run._states_at(t, index)
    return np.vstack([*([x] if knows_position(run.model) else []), v, *z.T])


def _steps(run: Any, t: Array, h: Array, index: Array) -> tuple[Array, Array]:
    """Radau IIA over every step at once: transfer matrices, and integrals of the trace."""
    mode, stages = run._modes[index], len(NODES)
    memory = run.pieces.memory[index] if law_of(run.model).modes else ()
    times = [t + min(c, _INSIDE) * h for c in NODES]
    J = [rates(run.model, mode, s, _states(run, s, index), memory)[1] for s in times]
    n, d = len(t), J[0].shape[1]
    if not any(j.any() for j in J):
        return np.broadcast_to(np.eye(d), (n, d, d)).copy(), np.zeros(n)
    whole = np.broadcast_to(np.eye(stages * d), (n, stages * d, stages * d)).copy()
    for a in range(stages):
        for b in range(stages):
            whole[:, a * d : (a + 1) * d, b * d : (b + 1) * d] -= (STAGES[a, b] * h)[:, None, None] * J[b]
    ones = np.broadcast_to(np.tile(np.eye(d), (stages, 1)), (n, stages * d, d))
    traces = sum(STAGES[-1, b] * np.trace(J[b], axis1=1, axis2=2) for b in range(stages))
    return np.linalg.solve(whole, ones)[:, -d:], h * traces


def product(matrices: Array) -> Array:
    """The product ... M2 M1 M0, by halves."""
    while len(matrices) > 1:
        odd = matrices[len(matrices) - len(matrices) % 2 :]
        matrices = np.concatenate([matrices[1::2] @ matrices[: len(matrices) - len(matrices) % 2 : 2], odd])
    return matrices[0]


def multipliers_of(M: Array, forgets: bool, autonomous: bool = False) -> Array:
    """The eigenvalues of a monodromy matrix, the largest first; real where all are.

    Parameters
    ----------
    forgets : bool
        Whether a direction is wiped out on the way: the smallest eigenvalue is then 0, and not what rounding makes of it.
    autonomous : bool
        Whether the flow does not depend on time: the eigenvalue 1 along the orbit is left out.
    """
    found: Array = np.linalg.eigvals(M)
    if autonomous:
        found = np.delete(found, int(np.argmin(abs(found - 1.0))))
    found = found[np.argsort(-abs(found), kind="stable")]
    if forgets and len(found):
        found[-1] = 0.0
    return found.real if np.all(found.imag == 0) else found


def saltation(run: Any, node: int) -> Array:
    """What the switch between two pieces does to a small change of the state.

    Parameters
    ----------
    node : int
        Number of the piece that begins with the switch.
    """
    model, pieces = run.model, run.pieces
    t, before, after = float(pieces.t[node]), int(run._modes[node - 1]), int(run._modes[node])
    at, v = np.array([t]), _place_of_v(model)
    old, new = (_states(run, at, np.array([i])) for i in (node - 1, node))
    if law_of(model).modes:
        return remembered(model, t, old[:, 0], new[:, 0], (before, after), pieces.memory[node - 1 : node + 1])
    S = np.eye(len(old))
    if abs(new[v, 0] - old[v, 0]) > 1e-9 * float(np.max(model.velocity_scale)):
        return S  # an impulse of the drive, at an instant that is known
    f_old = rates(model, np.array([before]), at, old)[0][:, 0]
    f_new = rates(model, np.array([after]), at, old)[0][:, 0]
    jump = f_new - f_old
    if law_of(model).dynamic:
        if np.any(abs(jump) > 1e-9 * abs(f_old).max()) and f_old[v] != 0.0:
            S[:, v] += jump / f_old[v]
    elif after == 0:
        S[v, :] = 0.0
    elif before == 0:
        by_t, by_x = offer_slopes(model, t, 0.0 if v == 0 else float(old[0, 0]), after)
        if v and by_t + by_x * f_old[0] != 0.0:
            S[:, 0] += jump * by_x / (by_t + by_x * f_old[0])
    elif f_old[v] != 0.0:
        S[:, v] += jump / f_old[v]
    return S
