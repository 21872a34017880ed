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

from stickslip.dynamics.flows import breakaway_slopes, rates
from stickslip.dynamics.mapping import columns_of, coordinates
from stickslip.dynamics.memories import remembered
from stickslip.dynamics.order import needs_one_body, order_of
from stickslip.machine import machine_of

__all__ = ["monodromy", "multipliers_of", "orders_differ", "product", "resting", "saltation", "transfers"]

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
    machine = machine_of(model)
    t, mode = np.asarray(pieces.t), pieces.mode
    grid = (t[:-1, None] + (np.arange(parts) / parts) * np.diff(t)[:, None]).ravel()
    h, index = np.repeat(np.diff(t) / parts, parts), np.repeat(np.arange(len(mode)), parts)
    matrices, areas = _steps(run, grid, h, index)
    if not machine.has_inner_states:
        for contact, row in enumerate(_rows_of_contacts(model)):
            stuck = mode[index, contact] == 0
            matrices[stuck, row, :], areas[stuck] = 0.0, -np.inf
    changed = np.any(np.diff(mode, axis=0) != 0, axis=1)
    if any(law.modes for law in machine.laws):
        changed |= np.any(np.diff(pieces.memory, axis=0) != 0, axis=1)
    for i in np.flatnonzero(changed):
        last, S = (int(i) + 1) * parts - 1, saltation(run, int(i) + 1)
        matrices[last] = S @ matrices[last]
        with np.errstate(divide="ignore"):
            areas[last] += np.log(abs(np.linalg.det(S)))
    return matrices, areas


def is_followed(model: Any) -> bool:
    """Whether disturbances can be followed through every switch: what a switch of a law's memory does is known for one contact."""
    machine = machine_of(model)
    return machine.is_single or not any(law.modes for law in machine.laws)


def needs_followed(what: str, model: Any) -> None:
    """`InputError` where they cannot."""
    if not is_followed(model):
        needs_one_body(what, model, "what a switch of a law's memory does to disturbances is known for one contact",
                       "type ss.largest_exponents(machine) for the largest exponent, from neighbours")  # fmt: skip


def resting(run: Any) -> Array:
    """How many contacts rest exactly on each piece of a run: so many directions are forgotten at once."""
    if machine_of(run.model).has_inner_states:
        return np.zeros(len(run.pieces.mode), int)
    return np.sum(np.asarray(run.pieces.mode) == 0, axis=1)


def _rows_of_contacts(model: Any) -> list[int]:
    """For each contact under a law that rests exactly the number of the velocity that it stops."""
    first = order_of(model).velocities.start
    return [first + next(k for k, g in enumerate(row) if g) for row in machine_of(model).mechanics.directions]


def _states(run: Any, t: Array, index: Array) -> Array:
    """The coordinates (d, n) at instants on given pieces."""
    x, v, z = run.pieces.evaluate(t, index)
    return np.vstack(columns_of(run.model, x, v, z))


def _steps(run: Any, t: Array, h: Array, index: Array) -> tuple[Array, Array]:
    """Radau IIA over every step at once: transfer matrices, and integrals of the trace."""
    mode, stages = run.pieces.mode[index], len(NODES)
    memory = run.pieces.memory[index] if any(law.modes for law in machine_of(run.model).laws) else ()
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


def multipliers_of(M: Array, forgets: int, autonomous: bool = False) -> Array:
    """The eigenvalues of a monodromy matrix, the largest first; real where all are.

    Parameters
    ----------
    forgets : int
        How many directions are wiped out at one instant on the way: so many of the smallest eigenvalues are 0, and not what rounding makes
        of them. The rank is as much lower; contacts that rest one after the other count once.
    autonomous : bool
        Whether the flow does not depend on time: the eigenvalue 1 along the orbit is left out.
    """
    found: Array = np.linalg.eigvals(M)
    if autonomous:
        found = np.delete(found, int(np.argmin(abs(found - 1.0))))
    found = found[np.argsort(-abs(found), kind="stable")]
    if forgets and len(found):
        found[-int(forgets) :] = 0.0
    return found.real if np.all(found.imag == 0) else found


def saltation(run: Any, node: int) -> Array:
    """What the switch between two pieces does to a small change of the state.

    Parameters
    ----------
    node : int
        Number of the piece that begins with the switch.
    """
    model, pieces = run.model, run.pieces
    t, sides = float(pieces.t[node]), pieces.mode[node - 1 : node + 1]
    old, new = (_states(run, np.array([t]), np.array([i]))[:, 0] for i in (node - 1, node))
    machine = machine_of(model)
    if any(law.modes for law in machine.laws):
        needs_followed("monodromy", model)
        return remembered(model, t, old, new, (int(sides[0, 0]), int(sides[1, 0])), pieces.memory[node - 1 : node + 1])
    v = order_of(model).velocities
    if np.any(abs(new[v] - old[v]) > 1e-9 * float(np.max(machine.velocity_scale))):
        return np.eye(len(old))  # an impulse of the drive, at an instant that is known
    changed = [int(i) for i in np.flatnonzero(sides[0] != sides[1])]
    return _composed(model, t, old, sides, changed)


def orders_differ(run: Any, tolerance: float = 1e-6) -> bool:
    """Whether contacts that switch at one instant do so differently in the other order: disturbances then grow by one of two matrices."""
    if any(law.modes for law in machine_of(run.model).laws):
        return False
    mode = np.asarray(run.pieces.mode)
    for node in np.flatnonzero(np.sum(np.diff(mode, axis=0) != 0, axis=1) > 1) + 1:
        t, old = float(run.pieces.t[node]), _states(run, run.pieces.t[node : node + 1], np.array([node - 1]))[:, 0]
        changed, sides = [int(i) for i in np.flatnonzero(mode[node - 1] != mode[node])], mode[node - 1 : node + 1]
        one, other = (_composed(run.model, t, old, sides, order) for order in (changed, changed[::-1]))
        sizes = coordinates(run.model).scales[: len(old)]
        if np.max(abs(one - other) / sizes[:, None] * sizes) > tolerance * np.max(abs(one) / sizes[:, None] * sizes):
            return True
    return False


def _composed(model: Any, t: float, y: Array, sides: Array, changed: list[int]) -> Array:
    """What the switches of some contacts at one instant do, one after the other, with the field between them."""
    S, mode = np.eye(len(y)), np.array(sides[0])
    for contact in changed:
        after = mode.copy()
        after[contact] = sides[1, contact]
        S = _switched(model, t, y, mode, after, contact) @ S
        mode = after
    return S


def _switched(model: Any, t: float, y: Array, before: Array, after: Array, contact: int) -> Array:
    """What the switch of one contact does."""
    machine, S, at = machine_of(model), np.eye(len(y)), np.array([t])
    j = _rows_of_contacts(model)[contact]
    if not machine.has_inner_states and after[contact] == 0:
        S[j, :] = 0.0  # it rests on what it rubs on, however it came there
        return S
    f_old, f_new = (rates(model, side[None, :], at, y[:, None])[0][:, 0] for side in (before, after))
    jump = f_new - f_old
    if machine.has_inner_states and not np.any(abs(jump) > 1e-9 * abs(f_old).max()):
        return S
    if not machine.has_inner_states and before[contact] == 0:
        if machine.is_single and order_of(model).cyclic:
            return S  # time alone decides when it breaks away
        by_t, *by_y = breakaway_slopes(model, t, y, before, contact, int(after[contact]))
        slope, falls = np.array(by_y), by_t + float(np.dot(by_y, f_old))
    else:
        mechanics, slope = machine.mechanics, np.zeros(len(y))
        slope[order_of(model).velocities] = mechanics.directions[contact]
        falls = float(slope @ f_old) + float(np.ravel(mechanics.offset_rates(at)[contact])[0])
    if falls != 0.0:
        S += np.outer(jump, slope) / falls
    return S
