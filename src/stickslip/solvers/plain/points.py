r"""Several contacts of bodies in the plane of which some follow from the motion, for the judge: equations, guards, decisions, in floats.

A mode says which points touch, and what rests. What touches keeps its height and what rests its slip, by second derivatives
(index reduction); normal forces, friction forces and accelerations are the unknowns of one set of linear equations

.. math:: M a - \sum n_i \lambda_i + \sum g_i R_i = h, \qquad n_i a = -\dot n_i u, \qquad g_i a = -\dot g_i u
    \;\text{ or }\; R_i = \mu_i \lambda_i .

Of a rail that bears bodies the row is that of their needs along its normal; of a contact whose load is given, that load. Rails press to
either side: both are tried. A hit is the same set with velocities and impulses. Every combination is tried, and the first that agrees with
its own forces is taken.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, ArrayLike, Model
from stickslip.models.friction.law_adapter import TINY
from stickslip.models.machine_adapter import machine_of
from stickslip.solvers.plain.deciding import ROUNDING
from stickslip.solvers.plain.guards import Guard, kinks_of
from stickslip.solvers.plain.plain_equations import SHORT, ContactModes, Equations, Pressed, Rates

_BESIDE = 1e-12  # of the number that falls to zero where forces are infinite: a run ends before
_STILL = 1e-10  # of the velocity scale: a slip, or a rate of a gap, that is none
_AT_ONCE = 1e-10  # of a period: points that are down within it after a hit have part in it
_SAME = 1e-16  # of the distance of a period: what rounding makes of the gaps of points that land together
_SLACK = 1e-11  # of forces, or rates, of a combination: what rounding may make of one that agrees
FLIES = 2  # of a combination: the point does not touch, or has no part in a hit; else 1 and -1 are its side, 0 is rest

Sides = tuple[int, ...]


def equations_of(model: Model) -> Equations:
    """The judge's equations of a machine."""
    return PointEquations(model) if machine_of(model).mechanics.together else Equations(model)


@dataclass(frozen=True)
class Answer:
    """A combination, what it makes of accelerations (or velocities), its normal and friction forces (or impulses), and sides of rails."""

    sides: Sides
    after: Array
    across: Array
    along: Array
    signs: Mapping[int, int]


class Points:
    """All that the points of a machine ask of one state."""

    def __init__(self, e: PointEquations, t: float, y: ArrayLike, mode: ContactModes):
        self.e, (q, self.u) = e, e.state(y)
        t = e.time(t)
        shape, own, k = e.own.shape(t, q, self.u), e.own, e.k
        self.M = np.array(shape.M, float)
        state = own.state(t, q, self.u, e.controlled(y))
        free = e.forces(mode.kinks[0], t, q, self.u, [0.0] * k, e.controlled(y), [1.0] * k)[: e.n]
        self.h = self.M @ np.array(free, float)
        up = [slip.point[1] if i in e.kept else None for i, slip in enumerate(shape.slips)]
        self.n = np.array([[0.0] * e.n if of is None else of.slopes for of in up], float)
        self.n_bias = np.array([0.0 if of is None else of.second for of in up], float)
        self.needs = {i: own.needed(i, state) for i in e.borne}
        self.loads = [0.0 if i in e.kept or i in e.borne else float(own.load(i, t, q, self.u, e.controlled(y))) for i in range(k)]
        self.g = np.array([slip.row for slip in shape.slips], float)
        self.g_bias = np.array([float(slip.bias) + rate for slip, rate in zip(shape.slips, e.offset_rates(t), strict=False)])
        self.w = np.array(own.slips(t, q, self.u))
        self.belt = self.w - self.g @ np.array(self.u)  # what the ground does to slips
        self.steep = np.array([own.steepness(i, shape) if i in e.kept else 1.0 for i in range(k)])
        self.mu = {s: self.steep * [self._per_load(i, t, q, s) for i in range(k)] for s in (1, -1)}
        self.bounds = self.steep * np.array([[float(v) for v in law.breakaway(1.0)] for law in e.laws]).T
        self.fixed = {i: tuple(map(float, e.laws[i].breakaway(self.loads[i]))) for i in e.given}

    def _per_load(self, i: int, t: float, q: Any, side: int) -> float:
        """Friction for each newton across; of a contact whose load is given, friction itself."""
        if i not in self.e.given:
            return self.e.own.per_load(i, t, q, self.u, side)
        w = float(self.w[i])
        return float(self.e.laws[i].sliding(w if side * w > TINY else side * TINY, self.loads[i]))

    def solved(self, sides: Sides, right: Array, up: Array, along: Array, hit: bool = False) -> Answer:
        """Accelerations, or velocities, with which heights gain `up` and resting slips `along`, and the forces or impulses for it.

        The first whose rails press to the sides that their friction takes.
        """
        answers = [self._solved(sides, right, up, along, hit, signs) for signs in self.e.signs]
        agree = (of for of in answers if all(sign * of.across[i] >= 0.0 for i, sign in of.signs.items()))
        return next(agree, answers[0])

    def _solved(self, sides: Sides, right: Array, up: Array, along: Array, hit: bool, signs: Mapping[int, int]) -> Answer:
        e, n, k = self.e, self.e.n, self.e.k
        E, b = self._matrix(sides, self._slides(sides, signs)), np.zeros(n + 2 * k)
        b[:n] = right
        b[n : n + k] = [0.0 if side == FLIES else value for side, value in zip(sides, up, strict=True)]
        b[n + k :] = [0.0 if i not in self.held(sides) else value for i, value in enumerate(along)]
        for i in e.borne:
            b[n + i] = 0.0 if hit else float(self.needs[i][0])
        for i in e.given:
            b[n + i] = 0.0 if sides[i] == FLIES else self.loads[i]
            if sides[i] in (1, -1):
                b[n + k + i] = self.mu[sides[i]][i]
        try:
            x = np.linalg.solve(E, b)
        except np.linalg.LinAlgError:
            raise ArithmeticError("no forces follow from this combination") from None
        return Answer(sides, x[:n], x[n : n + e.k], x[n + e.k :], signs)

    def _slides(self, sides: Sides, signs: Mapping[int, int]) -> Array:
        given = self.e.given
        slips = [0.0 if side in (0, FLIES) or i in given else self.mu[side][i] for i, side in enumerate(sides)]
        return np.array([signs.get(i, 1) * slip for i, slip in enumerate(slips)])

    def held(self, sides: Sides) -> list[int]:
        """The resting points, of those that rest as one the first."""
        return [i for i, side in enumerate(sides) if side == 0 and next(k for k in self.e.alike[i] if sides[k] == 0) == i]

    def _matrix(self, sides: Sides, slides: Array) -> Array:
        n, k = self.e.n, self.e.k
        E = np.zeros((n + 2 * k, n + 2 * k))
        # rails that bear, and given loads, press nothing
        E[:n, :n], E[:n, n : n + k], E[:n, n + k :] = self.M, -self.n.T, self.g.T
        held = self.held(sides)
        for i, side in enumerate(sides):
            E[n + i, :n], E[n + i, n + i] = (self.n[i], 0.0) if side != FLIES and i in self.e.kept else (0.0, 1.0)
            if i in self.e.borne:
                E[n + i, :n] = -np.array(self.needs[i][1], float)
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
        every = [self._slides(sides, signs) for signs in self.e.signs]
        if not np.any(every[0]):
            return 1.0
        without = np.linalg.det(self._matrix(sides, 0.0 * every[0]))
        return min(float(np.linalg.det(self._matrix(sides, slides)) / without) for slides in every) - _BESIDE

    def margins(self, answer: Answer, i: int) -> tuple[float, float, float]:
        """How much more what rests with a point could bear, forwards and backwards, and the size of these forces."""
        if i in self.e.given:
            (low, high), force = self.fixed[i], float(answer.along[i])
            return high - force, force - low, max(abs(low), abs(high), abs(force))
        both = [k for k in self.e.alike[i] if answer.sides[k] == 0]
        loads = answer.across[both] * [answer.signs.get(k, 1) for k in both]
        low, high = (float(of @ loads) for of in self.bounds[:, both])
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
            if not good or (side != FLIES and answer.signs.get(i, 1) * answer.across[i] < -slack):
                return False
        return True

    def thrown(self, touches: Sequence[bool], before: Array, e: Array, may_lift: bool) -> Answer:
        """The hit of all points that touch, with restitutions e; or one after which none lifts."""
        u, gained = np.array(self.u), -e * before
        belt, speed = -self.belt, self.e.scale_of_velocity
        for sides in self.e.hits:
            lifts = [side == FLIES for side in sides]
            if any(lift != (not touch) and not (lift and may_lift) for lift, touch in zip(lifts, touches, strict=True)):
                continue
            try:
                answer = self.solved(sides, self.M @ u, gained + (self.n @ u - before), belt, hit=True)
            except ArithmeticError:  # what each bears does not follow, as of two legs that are parallel
                continue
            rise, slips = self.n @ answer.after - (self.n @ u - before), self.g @ answer.after + self.belt
            small = _SLACK * speed
            good = [
                not touches[i] or rise[i] >= gained[i] - small if side == FLIES
                else (not may_lift or answer.signs.get(i, 1) * answer.across[i] * self.steep[i] >= -small * np.max(self.M))
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
        touching, every = self.own.mechanics.touching, range(self.k)
        self.kept = [i for i in every if touching[i].keeps_height]
        self.borne = [i for i in every if touching[i].is_held and i not in self.kept]
        self.given = [i for i in every if not touching[i].is_held]
        rails = [i for i in (*self.kept, *self.borne) if i not in self.flying]
        self.touches = [i in rails for i in every]  # whatever flies
        self.signs = [dict(zip(rails, signs, strict=True)) for signs in itertools.product((1, -1), repeat=len(rails))]
        on_flat = {i: self.own.given[i].body for i in self.flying if self.own.given[i].on is None}
        self.alike = [[k for k in every if k == i or (i in on_flat and on_flat.get(k) == on_flat[i])] for i in every]
        ways = itertools.product(*((0, 1, -1, FLIES) if i in self.flying or i in self.given else (0, 1, -1) for i in every))
        ordered = sorted(filter(self._together, ways), key=lambda sides: sum(map(abs, sides)))
        self.combinations = [sides for sides in ordered if all(sides[i] != FLIES for i in self.given)]
        self.hits = [sides for sides in ordered if all(sides[i] == FLIES for i in self.given)]

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
        answer = self._answer(t, y, mode)[1]
        across = [answer.signs.get(i, 1) * float(v) for i, v in enumerate(answer.across)]
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
        inner = [v for i in self.flying for v in ((self.z(y, i)[1], float(up[i])) if i in mode.aloft else (0.0, 0.0))]
        return Rates(list(points.u), answer.after.tolist(), inner, answer.along.tolist(), push.tolist())

    def settled(self, t: float, q: list[float], u: list[float], mode: ContactModes) -> list[float]:
        """Velocities with which resting points do not slip, and touching ones do not leave."""
        if len(mode.aloft) == self.k:
            return u
        points = Points(self, t, [*q, *u, *([0.0] * (self.size - 2 * self.n))], mode)
        sides = tuple(FLIES if side == FLIES else 0 if side == 0 else 1 for side in self.pattern(mode))
        rows = [points.n[i] for i in self.kept if sides[i] != FLIES] + [points.g[i] for i in points.held(sides)]
        off = [points.n[i] @ u for i in self.kept if sides[i] != FLIES] + [points.w[i] for i in points.held(sides)]
        if not rows:
            return u
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
            if i in self.flying:
                listed.append(Guard("take-off", i, 0, float(answer.across[i]), 0.0))
            elif i in self.given and callable(self.own.given[i].load):
                listed.append(Guard("load", i, 0, points.loads[i], 0.0))
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
        gaps, still = {i: self.z(y, i) for i in self.flying}, _STILL * self.scale_of_velocity
        touches = [*self.touches]
        for i, (gap, rate) in gaps.items():
            late = gap - _SAME * self.scale_of_velocity * self.scale_of_time > _AT_ONCE * self.scale_of_time * -rate
            touches[i] = not flies[i] or i in landing or (rate < 0.0 and not late)
        before = np.array([gaps[i][1] if flies[i] else 0.0 for i in range(self.k)])
        e, points = np.array([float(law.restitution or 0.0) for law in self.laws]), Points(self, t, y, mode)
        answer = points.thrown(touches, before, e, True)
        rise = points.n @ (answer.after - np.array(points.u)) + before
        after = np.array(y, float)
        after[self.n : 2 * self.n] = answer.after
        if self._is_over(t, after, mode, touches, rise, e):
            answer = points.thrown(touches, before, 0.0 * e, False)
            rise = points.n @ (answer.after - np.array(points.u)) + before
            rise = np.where(touches, 0.0, rise)
        after[self.n : 2 * self.n] = answer.after
        for i in self.flying:
            first = self.inner[i][0]
            if touches[i]:
                after[first], after[first + 1] = 0.0, rise[i] if rise[i] > still else 0.0
            else:
                after[first + 1] = rise[i]
        return after, [i in self.flying and (not touches[i] or rise[i] > still) for i in range(self.k)]

    def _is_over(self, t: float, y: Any, mode: ContactModes, touches: Sequence[bool], rise: Array, e: Array) -> bool:
        """Whether all that a hit has thrown up would be down again within a moment."""
        points, together = Points(self, t, y, mode), all(touches[i] for i in self.flying)
        for i in self.flying:
            if touches[i] and rise[i] > 0.0:
                sides = tuple(1 if self.touches[k] else 0 if k in self.flying and k != i and together else FLIES for k in range(self.k))
                falling = -float(points.rates(points.accelerated(sides))[0][i])
                if not 2.0 * rise[i] < SHORT * self.scale_of_time * (1.0 - float(e[i])) * falling:
                    return False
        return True
