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
            matrices[stuck, row, :], matrices[stuck, :, row], areas[stuck] = 0.0, 0.0, -np.inf
    changed = np.any(np.diff(mode, axis=0) != 0, axis=1)
    if any(law.modes for law in machine.laws):
        changed |= np.any(np.diff(pieces.memory, axis=0) != 0, axis=1)
    nodes = np.flatnonzero(changed) + 1
    for node, S in zip(nodes, saltations(run, nodes), strict=True):
        last = int(node) * parts - 1
        matrices[last] = S @ matrices[last]
        with np.errstate(divide="ignore"):
            areas[last] += np.log(abs(np.linalg.det(S)))
    return matrices, areas


def is_followed(model: Any) -> bool:
    """Whether disturbances can be followed through every switch."""
    return not _unknown(model)


def _unknown(model: Any) -> str:
    """Of which switches it is not known what they do to disturbances; "" if of none."""
    machine = machine_of(model)
    mechanics, rows = machine.mechanics, machine.mechanics.directions
    if machine.is_single:
        return ""
    if any(law.modes for law in machine.laws):
        return "what a switch of a law's memory does to disturbances is known for one contact"
    if mechanics.stops:
        return "what stops that throw bodies back do to disturbances is not known"
    shared = any(sum(map(abs, column)) > 1.0 for column in zip(*rows, strict=True)) or any(sum(map(abs, row)) != 1.0 for row in rows)
    if shared and not machine.has_inner_states:
        return "its contacts act on one another at once, and what their switches do to disturbances is not known"
    return ""


def needs_followed(what: str, model: Any) -> None:
    """`InputError` where they cannot."""
    if why := _unknown(model):
        needs_one_body(what, model, why, "type ss.largest_exponents(machine) for the largest exponent, from neighbours")


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
    return saltations(run, np.array([node]))[0]


def saltations(run: Any, nodes: Array, backwards: bool = False) -> Array:
    """What the switches at the beginnings of some pieces do to a small change of the state: array (nodes, d, d).

    Contacts that switch at one instant do it one after the other, in their order or `backwards`, with the field between them.
    """
    model, pieces = run.model, run.pieces
    t = np.asarray(pieces.t)[nodes]
    old, new = (_states(run, t, index) for index in (nodes - 1, nodes))
    found = np.broadcast_to(np.eye(len(old)), (len(nodes), len(old), len(old))).copy()
    machine = machine_of(model)
    if any(law.modes for law in machine.laws):
        needs_followed("monodromy", model)
        for i, node in enumerate(nodes):
            sides = (int(pieces.mode[node - 1, 0]), int(pieces.mode[node, 0]))
            found[i] = remembered(model, float(t[i]), old[:, i], new[:, i], sides, pieces.memory[node - 1 : node + 1])
        return found
    v, switches = order_of(model).velocities, []
    thrown = np.any(abs(new[v] - old[v]) > 1e-9 * float(np.max(machine.velocity_scale)), axis=0)
    for k in map(int, np.flatnonzero(~thrown)):  # an impulse of the drive comes at an instant that is known
        switches += [(k, *switch) for switch in _in_turn(pieces.mode[nodes[k] - 1], pieces.mode[nodes[k]], backwards)]
    if switches:
        at = np.array([k for k, *_ in switches])
        before, after = (np.array([switch[i] for switch in switches]) for i in (2, 3))
        f_old, f_new = (rates(model, side, t[at], old[:, at])[0].T for side in (before, after))
        drift = np.array([np.broadcast_to(rate, len(at)) for rate in machine.mechanics.offset_rates(t[at])], float).T
        for i, (k, contact, one, other) in enumerate(switches):
            S = _switched(model, float(t[k]), old[:, k], (one, other), contact, (f_old[i], f_new[i]), float(drift[i, contact]))
            found[k] = S @ found[k]
    return found


def _in_turn(before: Array, after: Array, backwards: bool) -> list[tuple[int, Array, Array]]:
    """The contacts that switch at one instant, each with the modes of all before and after it."""
    found, mode = [], np.array(before)
    changed = np.flatnonzero(before != after)
    for contact in map(int, changed[::-1] if backwards else changed):
        then = mode.copy()
        then[contact] = after[contact]
        found.append((contact, mode, then))
        mode = then
    return found


def _switched(model: Any, t: float, y: Array, modes: tuple[Array, Array], contact: int, f: tuple[Array, Array], drift: float) -> Array:
    """What the switch of one contact does, from the rates before and after it; `drift` is the rate of what is added to its slip."""
    machine, S = machine_of(model), np.eye(len(y))
    (before, after), (f_old, f_new), exact = modes, f, not machine.has_inner_states
    if exact and after[contact] == 0:
        S[_rows_of_contacts(model)[contact], :] = 0.0  # it rests on what it rubs on, however it came there
        return S
    jump = f_new - f_old
    if not np.any(abs(jump) > 1e-9 * abs(f_old).max()) and (before[contact] == 0 or not exact):
        return S
    if exact and before[contact] == 0:
        by_t, *by_y = breakaway_slopes(model, t, y, before, contact, int(after[contact]))
        slope, falls = np.array(by_y), by_t + float(np.dot(by_y, f_old))
    else:
        slope = np.zeros(len(y))
        slope[order_of(model).velocities] = machine.mechanics.directions[contact]
        falls = float(slope @ f_old) + drift
    return S + np.outer(jump, slope) / falls if falls != 0.0 else S


def orders_differ(run: Any, tolerance: float = 1e-6) -> bool:
    """Whether contacts that switch at one instant do so differently in the other order: disturbances then grow by one of two matrices."""
    mode = np.asarray(run.pieces.mode)
    nodes = np.flatnonzero(np.sum(np.diff(mode, axis=0) != 0, axis=1) > 1) + 1
    if not len(nodes) or not is_followed(run.model):
        return False
    sizes = coordinates(run.model).scales
    one, other = (saltations(run, nodes, backwards) for backwards in (False, True))
    scaled = sizes[None, None, :] / sizes[None, :, None]
    return bool(np.max(abs(one - other) * scaled) > tolerance * np.max(abs(one) * scaled))
