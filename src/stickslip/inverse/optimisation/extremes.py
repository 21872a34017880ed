"""Derivatives of the largest and the smallest value that something takes in a steady motion: exact, by the tangent up to that instant.

At an extremum between events the instant does not matter (the envelope theorem): de = e_y S + e_p. At a corner, where rates jump, the
instant moves by the tau of that switch, and on the side on which e is the larger de = e_y S + e_p + e' tau.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.optimize import brentq

from stickslip.analysis.state_order import coordinates_in
from stickslip.basics.batch import numbers_by_name
from stickslip.basics.contracts import Array, Model, Numeric
from stickslip.dynamics.derivatives.tangents import Directions, Follower
from stickslip.dynamics.periodic.closed_orbits import PeriodicOrbit
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates
from stickslip.engine.graphs import Along
from stickslip.engine.observed import LEAST, MOST
from stickslip.engine.observing import WAY
from stickslip.engine.symbols import Sym
from stickslip.engine.system import System
from stickslip.engine.tangent import PART, part_in, tangent_until
from stickslip.engine.trace import trace
from stickslip.engine.values import needed_by, values_of
from stickslip.inverse.optimisation.exact_derivatives import OWN
from stickslip.models.machine_adapter import machine_of
from stickslip.models.observables import Observable

_INNER = np.array([1e-6, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1 - 1e-6])  # of a piece: where it is looked at
_BESIDE = 1e-10  # of the period: how near to a switch the tangent is looked at on either side of it
_JUMP = 1e-4  # of the largest rate around: a rate that changes by more from one piece to the next jumps
_STILL = 1e-12  # of the value, in a period: what changes by less is constant
_LETTERS = {
    "velocity_max": ("v", MOST),
    "velocity_min": ("v", LEAST),
    "slip_max": ("w", MOST),
    "slip_min": ("w", LEAST),
    "stop_force_max": ("F", MOST),
}


@dataclass(frozen=True, eq=False)
class MotionExtreme:
    """The largest (sign 1) or smallest (sign -1) value of a traced expression over a motion."""

    system: System
    node: Sym
    sign: float

    @cached_property
    def rate(self) -> Sym:
        """Its derivative along the motion."""
        s = self.system
        return Along(s.graph, {y.name: f for y, f in zip(s.y, s.f, strict=True)} | {s.t.name: s.graph.constant(1.0)}).of(self.node)

    def change(self, names: tuple[str, ...]) -> Sym:
        """Its derivative along a direction, at the same part of the period."""
        s, graph = self.system, self.system.graph
        leaves = {name: graph.case(part_in(name)) for name in names} | {y.name: graph.variable(f"d {y.name}") for y in s.y}
        return Along(graph, leaves | {s.t.name: graph.variable("d t")}).of(self.node)


def extreme_of(of: Any, model: Model) -> MotionExtreme | None:
    """An extreme by the name of its column, or a user's observable; None where it is none, or not known from states and modes alone."""
    machine, observe = machine_of(model), tuple[tuple[str, Observable], ...]()
    if isinstance(of, Observable):
        observe, name, kind = ((OWN, of),), f"u.{OWN}", {"max": MOST, "min": LEAST}.get(of.reduce, 0)
    else:
        column, _, number = of.partition(".")
        letter, kind = _LETTERS.get(column, ("", 0))
        if not kind:
            return None
        mechanics, dim = machine.mechanics, {"v": "body", "w": "contact", "F": "stop"}[letter]
        names = {"body": mechanics.bodies, "contact": mechanics.contacts, "stop": [stop for stop, _ in mechanics.named_stops]}[dim]
        name = f"{letter}.{names[int(number) if number else machine.own[dim]]}"
    if not kind or machine.mechanics.controllers.names:
        return None
    system = trace(model, observe, noted=True)
    node = next((signal.node for signal in system.signals if name in signal.names), None)
    if node is None:  # a stop that throws back has no force
        return None
    extreme = MotionExtreme(system, node, 1.0 if kind == MOST else -1.0)
    known = {system.modes[k].name for contact in system.contacts for k in contact.modes}
    modes = {each.name for each in needed_by([node, extreme.rate]) if each.op == "flag" and each.name.startswith("mode")}
    return extreme if modes <= known else None


@dataclass(frozen=True)
class Place:
    """When something is the largest [s], on which piece of the run, and by how much of a period within that piece if it is at its end."""

    t: float
    piece: int
    inward: float = 0.0  # 0 between switches, where the rate is zero


class Looked:
    """An extreme on the dense output of a motion, and its derivatives.

    Parameters
    ----------
    extreme : Extreme
    orbit : PeriodicOrbit
    at : Coordinates
        Of its strobe state.
    seeds : dict of arrays (count,)
        Parts of the directions in the numbers.
    changes : array (count, states)
        Derivatives of the strobe state.
    """

    def __init__(self, extreme: MotionExtreme, orbit: PeriodicOrbit, at: Coordinates, seeds: dict[str, Array], changes: Array):
        self.extreme, self.orbit, self.at, self.seeds, self.changes = extreme, orbit, at, seeds, changes
        self.model, self.run, self.count = orbit.model, orbit.run, len(changes)
        self.T, self.ends = float(orbit.model.period), np.asarray(orbit.run.pieces.t, float)
        self.numbers = numbers_by_name(orbit.model)

    def derivatives(self) -> tuple[float, Array]:
        """The value, and its derivative along each direction; NaN where how a corner moves is not known."""
        location = self._location()
        e, rate, change, _ = self._valued(location.t + location.inward * self.T, location.piece)
        if not location.inward:
            return float(e[0]), change
        late = self._late(location, e, rate, change) if self._within(location.t) else np.zeros(self.count)
        return float(e[0] - rate[0] * location.inward * self.T), change + rate * late

    def _valued(self, t: float, piece: int) -> tuple[Array, Array, Array, Array]:
        """The expression, its rate, its change along each direction, and the change of the last event's instant, at an instant."""
        y, S, late, t = self._until(t, piece)
        T, dT = self._whole.period
        extreme = self.extreme
        ends = [extreme.node, extreme.rate, extreme.change(tuple(self.seeds))]
        known = self._known(t, np.tile(y, (self.count, 1)), np.full(self.count, piece)) | self._parts | {"d t": dT / T * t}
        known |= {f"d {s.name}": S[:, i] for i, s in enumerate(extreme.system.y)}
        computed = values_of(extreme.system.graph, known, ends)
        e, rate, change = (np.broadcast_to(computed[node.number], (self.count,)) for node in ends)
        return e, rate, change, late

    @property
    def _parts(self) -> dict[str, Array]:
        """The directions' parts in the numbers."""
        return {part_in(name): part for name, part in self.seeds.items()}

    def _late(self, location: Place, e: Array, rate: Array, change: Array) -> Array:
        """By how much later a corner comes along each direction, at the same part of the period."""
        system, graph = self.extreme.system, self.extreme.system.graph
        instants = [*system.instants, *(instant for instant, _ in system.impulses)]
        along = Along(graph, {name: graph.case(part_in(name)) for name in self.seeds})
        computed = values_of(graph, dict(self.numbers) | self._parts, [*instants, *map(along.of, instants)])
        T, dT = self._whole.period
        for instant in instants:
            t = computed[instant.number]
            if np.all(abs((location.t - t + 0.5 * self.T) % self.T - 0.5 * self.T) <= 2 * _BESIDE * self.T):
                return computed[along.of(instant).number] - dT / T * t
        other = self._valued(location.t - location.inward * self.T, location.piece + (1 if location.inward < 0 else -1))
        if not instants:
            return other[3] if location.inward < 0 else self._valued(location.t + location.inward * self.T, location.piece)[3]
        if abs(e[0] - other[0][0]) > 4 * _BESIDE * self.T * (abs(rate[0]) + abs(other[1][0])):
            return np.full(self.count, np.nan)  # it jumps there itself
        return -(change - other[2]) / (rate - other[1])

    def _within(self, t: float) -> bool:
        """Whether an instant is none of the strobe, which no direction moves."""
        return abs(t / self.T - round(t / self.T)) > 2 * _BESIDE

    @cached_property
    def _whole(self) -> Follower:
        """The same of whole periods."""
        return self._follower(np.ones(self.count))

    def _follower(self, parts: Array) -> Follower:
        """The tangent up to a part of the period."""
        return Follower(self.model, self.count, Directions(self.seeds, self.orbit.rtol, made=tangent_until, more={PART: parts}), self.at)

    def _until(self, t: float, piece: int) -> tuple[Array, Array, Array, float]:
        """The states of lanes, their changes and that of the last switch at an instant; and the instant in its drive period."""
        periods = int(0.5 * (self.ends[piece] + self.ends[piece + 1]) / self.T)
        states, starts = np.tile(self.orbit.state, (self.count, 1)), self.changes
        if periods:
            after = self._whole.after(states, starts, periods)
            states, starts = np.hstack([after.state, states[:, after.state.shape[1] :]]), after.change
        t = t - periods * self.T
        follower = self._follower(np.full(self.count, t / self.T))
        end, n = follower.lanes(states, starts, 1)[1].end, follower.carried.n
        return end[0, 1 : 1 + n], end[:, 1 + n : 1 + 2 * n], end[:, 1 + 2 * n + int(follower.table.cyclic)], t

    def _columns(self, t: Array) -> Array:
        """States as lanes have them, at some times."""
        run = self.run.with_axes
        states = coordinates_in(self.model, *run._states_at(t, run._index(t)))
        q, u, inner = self.at.order.split(list(np.column_stack(states)[:, : self.at.smooth].T), np.zeros(len(t)))
        return self._whole.table.placed(np.column_stack([*q, *u, *inner]), np.zeros(len(t), int))[:, 1:]

    def _known(self, t: Numeric, y: Array, piece: Array) -> dict[str, Any]:
        """The numbers by which expressions are valued."""
        system, pieces = self.extreme.system, self.run.pieces
        mode = np.asarray(pieces.mode).reshape(len(self.ends) - 1, -1)
        known = dict(self.numbers) | {system.t.name: t, WAY: 0.0} | {s.name: y[:, i] for i, s in enumerate(system.y)}
        for i, contact in enumerate(system.contacts):
            if contact.branches is not None:
                known[system.modes[contact.modes[0]].name] = mode[piece, i].astype(float)
        if system.dynamic and system.modes:
            known |= {m.name: np.asarray(pieces.memory)[piece, k].astype(float) for k, m in enumerate(system.modes)}
        return known

    def _values(self, t: Array, piece: Array) -> tuple[Array, Array]:
        """The quantity and its rate at times on some pieces."""
        begun = np.floor(0.5 * (self.ends[piece] + self.ends[piece + 1]) / self.T) * self.T
        ends = [self.extreme.node, self.extreme.rate]
        computed = values_of(self.extreme.system.graph, self._known(t - begun, self._columns(t), piece), ends)
        e, rate = (self.extreme.sign * np.broadcast_to(computed[node.number], t.shape) for node in ends)
        return e, rate

    def _location(self) -> Place:
        """Where it is the largest."""
        h, k = np.diff(self.ends), len(_INNER)
        t, piece = (self.ends[:-1, None] + h[:, None] * _INNER).ravel(), np.repeat(np.arange(len(h)), k)
        e, rate = self._values(t, piece)
        j = int(np.argmax(e))
        if abs(rate[j]) * self.T <= _STILL * np.max(abs(e)):
            return Place(float(t[j]), int(piece[j]))
        other = j + 1 if rate[j] > 0 else j - 1
        end = Place(float(self.ends[piece[j] + int(rate[j] > 0)]), int(piece[j]), -_BESIDE if rate[j] > 0 else _BESIDE)
        if not 0 <= other < len(t) or rate[j] * rate[other] > 0:  # the strobe, or a jump
            return end
        if piece[other] != piece[j] and abs(rate[j] - rate[other]) > _JUMP * np.max(
            abs(rate[max(min(j, other) - k, 0) : max(j, other) + k])
        ):
            return end
        a, b = sorted((float(t[j]), float(t[other])))
        return Place(float(brentq(self._rate, a, b, xtol=1e-14 * self.T, rtol=1e-14)), int(piece[j]))

    def _rate(self, t: float) -> float:
        piece = min(int(np.searchsorted(self.ends, t, side="right")) - 1, len(self.ends) - 2)
        return float(self._values(np.array([t]), np.array([piece]))[1][0])
