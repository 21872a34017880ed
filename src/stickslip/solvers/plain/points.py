r"""Several points of bodies in the plane that push on the ground at once, for the judge: equations, guards and decisions, in floats.

A mode says which points touch, and which of those rest. What touches keeps its height and what rests its slip, by second derivatives
(index reduction); normal forces, friction forces and accelerations are the unknowns of one set of linear equations

.. math:: M a - \sum n_i \lambda_i + \sum g_i R_i = h, \qquad n_i a = -\dot n_i u, \qquad g_i a = -\dot g_i u
    \;\text{ or }\; R_i = \mu_i \lambda_i .

A hit is the same set with velocities and impulses. Every combination is tried, and the first that agrees with its own forces is taken.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike, Model
from stickslip.models.machine_adapter import machine_of
from stickslip.solvers.plain.deciding import ROUNDING
from stickslip.solvers.plain.guards import Guard, kinks_of
from stickslip.solvers.plain.plain_equations import SHORT, ContactModes, Equations, Pressed, Rates

_BESIDE = 1e-12  # of the number that falls to zero where forces are infinite: a run ends before
_STILL = 1e-10  # of the velocity scale: a slip, or a rate of a gap, that is none
_SLACK = 1e-11  # of forces, or rates, of a combination: what rounding may make of one that agrees
FLIES = 2  # of a combination: the point does not touch; else 1 and -1 are its side, 0 is rest

Sides = tuple[int, ...]


def equations_of(model: Model) -> Equations:
    """The judge's equations of a machine."""
    return PointEquations(model) if len(machine_of(model).mechanics.flying) > 1 else Equations(model)


@dataclass(frozen=True)
class Answer:
    """A combination, what it makes of accelerations (or of velocities), and its normal and friction forces (or impulses)."""

    sides: Sides
    after: Array
    across: Array
    along: Array


class Points:
    """All that the points of a machine ask of one state."""

    def __init__(self, e: PointEquations, t: float, y: ArrayLike, mode: ContactModes):
        self.e, (q, self.u) = e, e.state(y)
        t = e.time(t)
        shape, own, k = e.own.shape(t, q, self.u), e.own, e.k
        self.M = np.array(shape.M, float)
        free = e.forces(mode.kinks[0], t, q, self.u, [0.0] * k, e.controlled(y), [1.0] * k)[: e.n]
        self.h = self.M @ np.array(free, float)
        up = [slip.point[1] for slip in shape.slips]
        self.n, self.n_bias = np.array([of.slopes for of in up], float), np.array([of.second for of in up], float)
        self.g = np.array([slip.row for slip in shape.slips], float)
        self.g_bias = np.array([float(slip.bias) + rate for slip, rate in zip(shape.slips, e.offset_rates(t), strict=False)])
        self.w = np.array(own.slips(t, q, self.u))
        self.belt = self.w - self.g @ np.array(self.u)  # what the ground does to slips
        self.steep = np.array([own.steepness(i, shape) for i in range(k)])
        self.mu = {s: self.steep * [own.per_load(i, t, q, self.u, s) for i in range(k)] for s in (1, -1)}
        self.bounds = self.steep * np.array([[float(v) for v in law.breakaway(1.0)] for law in e.laws]).T

    def solved(self, sides: Sides, right: Array, up: Array, along: Array) -> Answer:
        """Accelerations, or velocities, with which heights gain `up` and resting slips `along`, and the forces or impulses for it."""
        e, n, k = self.e, self.e.n, self.e.k
        E, b = self._matrix(sides, self._slides(sides)), np.zeros(n + 2 * k)
        b[:n] = right
        b[n : n + k] = [0.0 if side == FLIES else value for side, value in zip(sides, up, strict=True)]
        b[n + k :] = [0.0 if i not in self.held(sides) else value for i, value in enumerate(along)]
        try:
            x = np.linalg.solve(E, b)
        except np.linalg.LinAlgError:
            raise ArithmeticError("no forces follow from this combination") from None
        return Answer(sides, x[:n], x[n : n + e.k], x[n + e.k :])

    def _slides(self, sides: Sides) -> Array:
        return np.array([0.0 if side in (0, FLIES) else self.mu[side][i] for i, side in enumerate(sides)])

    def held(self, sides: Sides) -> list[int]:
        """The resting points, of those that rest as one the first."""
        return [i for i, side in enumerate(sides) if side == 0 and next(k for k in self.e.alike[i] if sides[k] == 0) == i]

    def _matrix(self, sides: Sides, slides: Array) -> Array:
        n, k = self.e.n, self.e.k
        E = np.zeros((n + 2 * k, n + 2 * k))
        E[:n, :n], E[:n, n : n + k], E[:n, n + k :] = self.M, -self.n.T, self.g.T
        held = self.held(sides)
        for i, side in enumerate(sides):
            E[n + i, :n], E[n + i, n + i] = (0.0, 1.0) if side == FLIES else (self.n[i], 0.0)
            E[n + k + i, n + k + i] = 1.0
            if i in held:
                E[n + k + i, :n], E[n + k + i, n + k + i] = self.g[i], 0.0
            elif side in (1, -1):
                E[n + k + i, n + i] = -slides[i]
        return E

    def accelerated(self, sides: Sides) -> Answer:
        """The forces of a combination."""
        return self.solved(sides, self.h, -self.n_bias, -self.g_bias)

    def border(self, sides: Sides) -> float:
        """Positive as long as one set of forces follows."""
        slides = self._slides(sides)
        if not np.any(slides):
            return 1.0
        return float(np.linalg.det(self._matrix(sides, slides)) / np.linalg.det(self._matrix(sides, 0.0 * slides))) - _BESIDE

    def margins(self, answer: Answer, i: int) -> tuple[float, float, float]:
        """How much more what rests with a point could bear, forwards and backwards, and the size of these forces."""
        both = [k for k in self.e.alike[i] if answer.sides[k] == 0]
        low, high = (float(of @ answer.across[both]) for of in self.bounds[:, both])
        force = float(answer.along[both].sum())
        return high - force, force - low, max(abs(low), abs(high), abs(force))

    def rates(self, answer: Answer) -> tuple[Array, Array]:
        """How heights and slips go under some accelerations."""
        return self.n @ answer.after + self.n_bias, self.g @ answer.after + self.g_bias

    def decided(self, flies: Sequence[bool], now: Sequence[int], forced: Mapping[int, int]) -> Answer | None:
        """The combination that agrees; `now` is the side of what slips, 0 of what does not, and `forced` ones break away."""
        size = float(np.max(abs(self.h))) + 1e-300
        for sides in self.e.combinations:
            if any(side != FLIES for side, aloft in zip(sides, flies, strict=True) if aloft):
                continue
            try:
                answer = self.accelerated(sides)
            except ArithmeticError:
                continue
            if self._agrees(answer, flies, now, forced, _SLACK * size):
                return answer
        return None

    def _agrees(self, answer: Answer, flies: Sequence[bool], now: Sequence[int], forced: Mapping[int, int], slack: float) -> bool:
        (up, along), lightest = self.rates(answer), slack / np.min(np.diag(self.M))
        for i, side in enumerate(answer.sides):
            if side == FLIES:
                good = flies[i] or up[i] > 0.0
            elif i in forced or now[i]:
                good = side == forced.get(i, now[i])
            elif side == 0:
                good = min(self.margins(answer, i)[:2]) >= -slack
            else:
                good = side * along[i] >= -lightest
            if not good or (side != FLIES and answer.across[i] < -slack):
                return False
        return True

    def thrown(self, touches: Sequence[bool], before: Array, e: Array, may_lift: bool) -> Answer:
        """The hit of all points that touch, with restitutions e; or one after which none lifts."""
        u, gained = np.array(self.u), -e * before
        belt, speed = -self.belt, self.e.scale_of_velocity
        for sides in self.e.combinations:
            lifts = [side == FLIES for side in sides]
            if any(lift != (not touch) and not (lift and may_lift) for lift, touch in zip(lifts, touches, strict=True)):
                continue
            answer = self.solved(sides, self.M @ u, gained + (self.n @ u - before), belt)
            rise, slips = self.n @ answer.after - (self.n @ u - before), self.g @ answer.after + self.belt
            small = _SLACK * speed
            good = [
                not touches[i] or rise[i] >= gained[i] - small if side == FLIES
                else (not may_lift or answer.across[i] * self.steep[i] >= -small * np.max(self.M))
                and (min(self.margins(answer, i)[:2]) >= -small * np.max(self.M) if side == 0 else side * slips[i] >= -small)
                for i, side in enumerate(sides)
            ]  # fmt: skip
            if all(good):
                return answer
        raise ArithmeticError


class PointEquations(Equations):
    """The equations of a machine whose contacts are several such points."""

    def __init__(self, model: Model):
        super().__init__(model)
        given = self.own.given
        flat = all(contact.on is None for contact in given)
        self.alike = [[k for k in range(self.k) if k == i or (flat and given[k].body == given[i].body)] for i in range(self.k)]
        every = itertools.product((0, 1, -1, FLIES), repeat=self.k)
        self.combinations = sorted(filter(self._together, every), key=lambda sides: sum(map(abs, sides)))

    def _together(self, sides: Sides) -> bool:
        """Whether points of one body on flat ground, which have one slip, slip to one side."""
        return all(len({sides[k] for k in self.alike[i] if sides[k] != FLIES}) <= 1 for i in range(self.k))

    def pattern(self, mode: ContactModes) -> Sides:
        """The combination of a mode."""
        return tuple(FLIES if i in mode.aloft else side for i, side in enumerate(mode.sides[: self.k]))

    # ---- what steps ask ----
    def _pressed(self, t: float, q: Any, u: Any, z: Any) -> list[Any]:
        return [1.0] * (2 * self.k)

    def pressed(self, t: float, y: ArrayLike, mode: ContactModes) -> Pressed:
        """Normal forces on all points."""
        across = [float(v) for v in self._answer(t, y, mode)[1].across]
        return Pressed(across, across)

    def borders(self, t: float, y: ArrayLike, mode: ContactModes) -> dict[int, float]:
        """What is positive as long as one set of forces follows, by the number of the first point."""
        return {0: Points(self, t, y, mode).border(self.pattern(mode))}

    def _answer(self, t: float, y: ArrayLike, mode: ContactModes) -> tuple[Points, Answer]:
        points = Points(self, t, y, mode)
        return points, points.accelerated(self.pattern(mode))

    def motion(self, t: float, y: Any, mode: ContactModes) -> Rates:
        """Rates and forces of a state."""
        points, answer = self._answer(t, y, mode)
        up, push = points.rates(answer)
        inner = [v for i in range(self.k) for v in ((self.z(y, i)[1], float(up[i])) if i in mode.aloft else (0.0, 0.0))]
        return Rates(list(points.u), answer.after.tolist(), inner, answer.along.tolist(), push.tolist())

    def settled(self, t: float, q: list[float], u: list[float], mode: ContactModes) -> list[float]:
        """Velocities with which resting points do not slip, and touching ones do not leave."""
        if len(mode.aloft) == self.k:
            return u
        points = Points(self, t, [*q, *u, *([0.0] * (self.size - 2 * self.n))], mode)
        sides = tuple(FLIES if side == FLIES else 0 if side == 0 else 1 for side in self.pattern(mode))
        rows = [points.n[i] for i, side in enumerate(sides) if side != FLIES] + [points.g[i] for i in points.held(sides)]
        off = [points.n[i] @ u for i, side in enumerate(sides) if side != FLIES] + [points.w[i] for i in points.held(sides)]
        taken = np.linalg.lstsq(np.array(rows), np.array(off), rcond=1e-10)[0]
        return (np.array(u) - taken).tolist()

    def guards_of_points(self, t: float, y: ArrayLike, mode: ContactModes) -> list[Any]:
        """All guards of a mode, in an order that the mode alone decides."""
        points, answer = self._answer(t, y, mode)
        small = ROUNDING * 0.01 * self.scale_of_velocity * self.scale_of_time
        listed, noise = [], self.noise_of_slips(t, *self.state(y), points.w.tolist())
        for i, side in enumerate(answer.sides):
            if side == FLIES:
                listed.append(Guard("landing", i, 0, self.z(y, i)[0], small))
                continue
            listed.append(Guard("take-off", i, 0, float(answer.across[i]), 0.0))
            if side:
                listed.append(Guard("slip", i, 0, side * float(points.w[i]), noise[i] or 1e-300))
            elif i in points.held(answer.sides):
                forwards, backwards, size = points.margins(answer, i)
                listed += [Guard("limit", i, s, left, ROUNDING * size) for s, left in ((1, forwards), (-1, backwards))]
        return [*listed, Guard("border", 0, 0, points.border(answer.sides), 0.0), *kinks_of(self, t, y, mode)]

    # ---- events ----
    def begun(self, t: float, y: Any, mode: ContactModes) -> ContactModes | None:
        """The mode at a start; None where no combination agrees."""
        flies = [any(v > 0.0 for v in self.z(y, i)) for i in range(self.k)]
        return self._moded(t, y, mode, flies, Points(self, t, y, mode).w, {})

    def _moded(
        self, t: float, y: Any, mode: ContactModes, flies: Sequence[bool], w: ArrayLike, forced: Mapping[int, int]
    ) -> ContactModes | None:
        still = _STILL * self.scale_of_velocity
        now = [0 if abs(v) <= still else 1 if v > 0 else -1 for v in np.asarray(w).tolist()]
        answer = Points(self, t, y, mode).decided(flies, now, forced)
        if answer is None:
            return None
        aloft = frozenset(i for i, side in enumerate(answer.sides) if side == FLIES)
        return replace(mode.moved({i: (mode.sides[i] or 1) if i in aloft else side for i, side in enumerate(answer.sides)}), aloft=aloft)

    def after(self, t: float, y: Any, mode: ContactModes, fired: Mapping[str, list[Guard]]) -> tuple[Any, ContactModes | None]:
        """State and mode after the events of one instant; no mode where no combination agrees."""
        y, stopped = np.array(y, float), {guard.part for guard in fired.get("slip", [])}
        flies = [i in mode.aloft or any(guard.part == i for guard in fired.get("take-off", [])) for i in range(self.k)]
        rested = {i for i, side in enumerate(mode.sides[: self.k]) if side == 0 and not flies[i]}
        forced = {k: guard.which for guard in fired.get("limit", []) for k in self.alike[guard.part] if k in rested}
        if landing := [guard.part for guard in fired.get("landing", [])]:
            y, flies = self._hit(t, y, mode, flies, landing)
        w = Points(self, t, y, mode).w
        if not landing:
            w = np.array([0.0 if i in stopped or i in rested or any(k in stopped for k in self.alike[i]) else v for i, v in enumerate(w)])
        new = self._moded(t, y, mode, flies, w, forced)
        if new is not None:
            y = self.at_rest(t, y, new)
        return y, new

    def _hit(self, t: float, y: Any, mode: ContactModes, flies: list[bool], landing: list[int]) -> tuple[Any, list[bool]]:
        """Velocities after a hit, with the gaps of points that were in it; and which fly on."""
        gaps, still = [self.z(y, i) for i in range(self.k)], _STILL * self.scale_of_velocity
        touches = [not flies[i] or i in landing or (gaps[i][0] <= still * self.scale_of_time and gaps[i][1] < 0.0) for i in range(self.k)]
        before = np.array([gaps[i][1] if flies[i] else 0.0 for i in range(self.k)])
        e, points = np.array([float(law.restitution) for law in self.laws]), Points(self, t, y, mode)
        answer = points.thrown(touches, before, e, True)
        rise = points.n @ (answer.after - np.array(points.u)) + before
        after = np.array(y, float)
        after[self.n : 2 * self.n] = answer.after
        if self._is_over(t, after, mode, touches, rise, e):
            answer = points.thrown(touches, before, 0.0 * e, False)
            rise = points.n @ (answer.after - np.array(points.u)) + before
            rise = np.where(touches, 0.0, rise)
        after[self.n : 2 * self.n] = answer.after
        for i, (first, _) in enumerate(self.inner):
            if touches[i]:
                after[first], after[first + 1] = 0.0, rise[i] if rise[i] > still else 0.0
            else:
                after[first + 1] = rise[i]
        return after, [not touches[i] or rise[i] > still for i in range(self.k)]

    def _is_over(self, t: float, y: Any, mode: ContactModes, touches: Sequence[bool], rise: Array, e: Array) -> bool:
        """Whether all that a hit has thrown up would be down again within a moment."""
        points = Points(self, t, y, mode)
        for i in range(self.k):
            if touches[i] and rise[i] > 0.0:
                sides = tuple(0 if k != i and touches[k] and all(touches) else FLIES for k in range(self.k))
                falling = -float(points.rates(points.accelerated(sides))[0][i])
                if not 2.0 * rise[i] < SHORT * self.scale_of_time * (1.0 - float(e[i])) * falling:
                    return False
        return True
