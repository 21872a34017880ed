"""Steady motions with their derivatives: from where runs settle, closed by the tangent, one kernel call for all directions.

A run from rest ends near a periodic motion. The tangent along one motion period tells how far its end is from its start, the monodromy
matrix M, and what each direction in the numbers does to the end. One linear solve with 1 - M gives the next state (Newton's method) and
the change of the state with which the motion stays periodic.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.basics.batch import labels_of, some_of, spread_over_cases
from stickslip.basics.contracts import Array, Model
from stickslip.basics.frozen_arrays import sealed
from stickslip.dynamics.derivatives.tangents import Directions, Follower
from stickslip.dynamics.stroboscopic.strobe_maps import (
    Coordinates,
    as_it_ends,
    check_equations,
    has_arcs,
    refuse_chance,
    run_lanes,
    state_at_rest,
)  # fmt: skip
from stickslip.engine.tangent import tangent, tangent_of_means
from stickslip.models.machine_adapter import machine_of

NEUTRAL = 1e-9  # how near to 1 a multiplier leaves a direction in which a motion can be shifted freely
_CLOSED, _CLOSED_WITHIN_TOLERANCE = 1e-12, 1e-6  # of the scales: a motion that misses itself by less is closed
_FLOOR = 1e-9  # by less than this it is, if it gets no better
_LOOSE = 100.0  # the first step of Newton's method is taken with this times the tolerance
_MOST = 12  # steps of Newton's method from a run that has settled


@sealed
class SteadyMotions:
    """The motions in which runs from rest have ended: strobe state, number of drive periods (0: it does not repeat), mean velocity.

    `stepped` says that the runs were made of steps, not of closed arcs.
    """

    state: Array  # (cases, coordinates)
    period: Array
    mean_velocity: Array  # [m/s]
    status: Array
    stepped: bool = True


def motions_from_rest(model: Model, at: Coordinates, cases: int = 1, periods: int = 400, rtol: float = 1e-6) -> SteadyMotions:
    """The motions in which machines end that start from rest, each run until it repeats.

    Parameters
    ----------
    model : Robot or machine
        One, or a batch, under laws that the engine knows.
    at : Coordinates
        Of its strobe state.
    cases : int
        How many of them there are.
    periods : int
        Drive periods after which a run that has not repeated is given up.
    rtol : float
        Tolerance for dynamic laws.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    >>> from stickslip.dynamics.stroboscopic.strobe_maps import coordinates
    >>> found = motions_from_rest(robot, coordinates(robot))
    >>> found.period.tolist(), found.mean_velocity.round(9).tolist()
    ([1], [0.004308808])
    """
    refuse_chance(machine_of(model))
    T = spread_over_cases(model.period, labels_of(model))
    if has_arcs(model):
        from stickslip.solvers.set_valued import solve_batch

        raw = solve_batch(model, periods, "auto")
        return SteadyMotions(raw["v_end"][:, None], raw["period"], raw["displacement"] / (raw["window"] * T), raw["status"], False)
    start = np.broadcast_to(state_at_rest(model, at), (cases, len(at.names)))
    check_equations(model)
    results, table, end = run_lanes(model, start, periods, rtol, auto=True, at=at)
    with np.errstate(invalid="ignore", divide="ignore"):
        return SteadyMotions(end, results.period, results.displacement / (results.window * T) + table.carried, results.status)


@sealed
class ClosedMotions:
    """Motions that begin in some states, and their derivatives along directions in the numbers while they stay periodic.

    Parameters
    ----------
    state : array (motions, coordinates)
        Where they begin.
    missed : array (motions,)
        How far they are from themselves after the motion period, in the scales of the coordinates.
    nearer : array (motions, coordinates)
        Where Newton's method begins them next: where the motions begin that are closed.
    mean_velocity : array (motions,)
        Of these [m/s].
    slopes : array (motions, directions)
        Derivatives of the mean velocity.
    changes : array (motions, directions, states)
        Derivatives of the state, without memories.
    monodromy : array (motions, states, states)
        In the scales of the coordinates.
    free : array (motions,)
        How many multipliers are 1, so that the motion can be shifted freely, and the smallest change is given.
    means, mean_slopes : array (motions, means), (motions, directions, means)
        Means over the motion period that were asked for, and their derivatives.
    time, time_slopes : array (motions,), (motions, directions)
        The motion period [s], and its derivatives.
    """

    state: Array
    missed: Array
    nearer: Array
    mean_velocity: Array
    slopes: Array
    changes: Array
    monodromy: Array
    free: Array
    means: Array
    mean_slopes: Array
    time: Array
    time_slopes: Array


class Closing:
    """Motions of one machine, or of each of a batch, followed over their period along all directions at once.

    Parameters
    ----------
    model : Robot or machine
        One, or a batch of as many as there are motions; its equations come back after the period.
    at : Coordinates
        Of its strobe state.
    directions : dict of arrays (directions,)
        Parts of the directions in the numbers, by name.
    count : int
        How many directions there are.
    rtol : float
        Tolerance for dynamic laws.
    motions : int
        How many motions there are.
    means : int
        How many means are made, as many as `means_named` has names for these `observe`; or none.
    observe : tuple of (name, Observable)
        A user's own.
    """

    def __init__(
        self, model: Model, at: Coordinates, directions: dict[str, Array], count: int, rtol: float, motions: int = 1, means: int = 0,
        observe: Any = (),
    ):  # fmt: skip
        self.at, self.count, self.motions = at, count, motions
        self.d = d = self.at.smooth
        self.scales = self.at.scales[:d]
        numbers = {name: np.tile(np.concatenate([np.zeros(d), parts]), motions) for name, parts in directions.items()}
        each = model if motions == 1 else some_of(model, np.repeat(np.arange(motions), d + count))
        self.starts = np.tile(np.vstack([np.diag(self.scales), np.zeros((count, d))]), (motions, 1))
        made = tangent_of_means if means else tangent
        self.follower = Follower(each, motions * (d + count), Directions(numbers, rtol, made=made, observe=observe, integrals=means), at)

    def at_state(self, state: Array, period: int, directions: bool = True, loose: float = 1.0) -> ClosedMotions:
        """The motions that begin in some states (motions, coordinates), over so many drive periods.

        Without the directions, and to a tolerance so many times as loose, it is said only where they begin, and what is nearer.
        """
        d, k, n = self.d, self.count if directions else 0, self.motions
        which = slice(None) if directions else (np.arange(n)[:, None] * (d + self.count) + np.arange(d)).ravel()
        changes = self.follower.after(np.repeat(state, d + k, axis=0), self.starts[which], period, which, loose)
        change = (changes.change / self.scales).reshape(n, d + k, d)
        M, forced = change[:, :d].transpose(0, 2, 1), change[:, d:].transpose(0, 2, 1)
        end = changes.state.reshape(n, d + k, d)[:, 0]
        missed = self.at.difference(end, state[:, :d]) / self.scales
        solved, free = _solved(np.eye(d) - M, np.concatenate([forced, missed[:, :, None]], axis=2))
        start, step = solved[:, :, :k], np.nan_to_num(solved[:, :, k])
        way = changes.way_change.reshape(n, d + k)
        T, dT = (each[which].reshape(n, d + k) * period for each in self.follower.period)
        V = (changes.way.reshape(n, d + k)[:, 0] + np.einsum("nd,nd->n", way[:, :d], step)) / T[:, 0]  # of the motion that is closed
        sums = changes.integrals.reshape(n, d + k, changes.integrals.shape[1])[:, 0]
        d_sums = changes.integral_changes.reshape(n, d + k, sums.shape[1])
        means = (sums + np.einsum("ndm,nd->nm", d_sums[:, :d], step)) / T[:, :1]
        d_sums = np.einsum("ndm,ndk->nkm", d_sums[:, :d], start) + d_sums[:, d:]
        way = np.einsum("nd,ndk->nk", way[:, :d], start) + way[:, d:]
        nearer = np.hstack([end + np.einsum("nij,nj->ni", M, step) * self.scales, state[:, d:]])
        if self.at.named and self.follower.is_exact:
            nearer = np.array([as_it_ends(self.at, new, last) for new, last in zip(nearer, end, strict=True)])
        return ClosedMotions(
            state, _sizes(missed), nearer, V, (way - V[:, None] * dT[:, d:]) / T[:, d:],
            start.transpose(0, 2, 1) * self.scales, M, free,
            means, (d_sums - means[:, None] * dT[:, d:, None]) / T[:, d:, None], T[:, 0], dT[:, d:],
        )  # fmt: skip

    def near(self, state: Array, period: int) -> ClosedMotions:
        """The motions that are closed, by Newton's method from states near them; one that is not found misses itself."""
        exact = self.follower.is_exact
        best = self.at_state(state, period) if exact else self.at_state(self.at_state(state, period, False, _LOOSE).nearer, period)
        for _ in range(_MOST):
            if np.all((best.missed <= self.close) | ~np.isfinite(best.monodromy).all(axis=(1, 2))):
                break
            again = self.at_state(best.nearer, period)
            better = again.missed < best.missed
            if not better.any():
                break
            best = again if better.all() else _chosen(better, again, best)
            if np.all(best.missed[better] <= _FLOOR):
                break
        return best

    @property
    def close(self) -> float:
        """How far from itself a motion may be, in the scales, that is to be closed: what is said of it is of second order in that."""
        return _CLOSED if self.follower.is_exact else _CLOSED_WITHIN_TOLERANCE

    def is_good(self, closed: ClosedMotions) -> Array:
        """Of which motions the derivatives are to be trusted."""
        return closed.missed <= max(self.close, _FLOOR)


def _solved(A: Array, b: Array) -> tuple[Array, Array]:
    """Solutions of A x = b for each motion, the smallest where A has no inverse, and in how many directions it has none."""
    x, good = np.full(b.shape, np.nan), np.isfinite(A).all(axis=(1, 2))
    free = np.zeros(len(A), int)
    if A.shape[1]:
        free[good] = np.sum(abs(np.linalg.eigvals(A[good])) < NEUTRAL, axis=1)
    easy = good & (free == 0)
    x[easy] = np.linalg.solve(A[easy], b[easy])
    for i in np.flatnonzero(good & (free > 0)):
        x[i] = np.linalg.lstsq(A[i], b[i], rcond=NEUTRAL)[0]
    return x, free


def _sizes(missed: Array) -> Array:
    return np.max(abs(missed), axis=1, initial=0.0)


def _chosen(first: Array, one: ClosedMotions, other: ClosedMotions) -> ClosedMotions:
    """Of each motion what was found first, or else."""
    pairs = {name: (getattr(one, name), getattr(other, name)) for name in ClosedMotions.__dataclass_fields__}
    return replace(one, **{n: np.where(first.reshape(-1, *[1] * (a.ndim - 1)), a, b) for n, (a, b) in pairs.items()})
