"""Following a limit cycle in a parameter: how long it takes is one more unknown, in the place of the velocity."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.dynamics.continuation.following.pseudo_arclength import Path, Point
from stickslip.dynamics.periodic.closed_orbits import PeriodicOrbit
from stickslip.dynamics.periodic.cycle_sections import TURN, Section
from stickslip.dynamics.periodic.newton import Root
from stickslip.dynamics.stroboscopic.strobe_maps import state_at
from stickslip.models.machine_adapter import machine_of
from stickslip.models.model_adapter import adapter_of

_WELL = 1e-11  # residual of the cycles that are used
_NEAR, _ERRORS = 10, 4.0  # cycles from which it is continued, and standard errors
_CLOSED = 1e-12  # of the parameter: how well cycles close, and so how well they tell where they end
_BIRTH = 1e-3  # of the range: how near to where cycles are born their sizes are read
_WIDER = (1.0, 10.0, 100.0)  # among cycles that are nearer than rounding leaves their rests to be told
_TURN = 1e-6  # of the velocity scale: the spring turns where its rate is that small
_SHORT = 0.01  # part of the cycle below which a rest is about to vanish


@dataclass(frozen=True, eq=False)
class CyclePath(Path):
    """Constants of a branch of limit cycles. A point is (x, inner states, duration, parameter).

    Parameters
    ----------
    unit : float
        The time in which durations are measured [s].
    section : Section
        Where the cycles are cut.
    """

    unit: float = 1.0
    section: Section = TURN

    def inner(self, orbit: Any) -> Array:
        """The unknowns of a cycle besides the parameters."""
        return self.section.unknowns(self.at, orbit.section_state, orbit.duration, self.unit)

    def remembered(self, orbit: Any) -> Array:
        """The law's memory on the section."""
        return np.asarray(orbit.section_state[self.at.smooth :])

    def later(self, orbit: Any) -> Array:
        """The same unknowns half a cycle later, where that is a turn of the spring too: else no numbers."""
        if not self.section.turns:
            return np.full(self.at.smooth, np.nan)
        x, v, *inner = state_at(orbit.run, 0.5 * orbit.duration)
        far = machine_of(orbit.model).far_end_velocity
        turned = np.array([x - 0.5 * far * orbit.duration, far, *inner])
        return np.where(abs(v - far) < _TURN * self.at.speed, self.section.unknowns(self.at, turned, orbit.duration, self.unit), np.nan)

    def ends(self, U: Array, memory: Array) -> Array:
        """The states after the durations."""
        return self.section.ends(self.robots(U), self.at, U[:, : self.at.smooth], memory, self.rtol, self.unit)

    def missed(self, ends: Array, U: Array) -> Array:
        """How far each state is from itself after its duration, in its scales."""
        begun = self.section.states(self.robots(U), self.at, U[:, : self.at.smooth], np.empty(0))
        return np.asarray((ends[:, : self.at.smooth] - begun) / self.scales)

    def returned(self, J: Array) -> Array:
        """The derivative of the map of the section onto itself: the coordinate that passes its value there says how long it takes."""
        k = self.section.index
        through = J - J[..., :, -1:] * J[..., k : k + 1, :] / J[..., k : k + 1, -1:]
        return np.delete(through, k, axis=-2)[..., :-1] + np.eye(self.at.smooth - 1)

    @cached_property
    def _followed(self) -> bool:
        """Batches of derivatives are differences, as how long it takes is unknown too."""
        return False

    def numbers(self, guess: Array) -> dict[str, float] | None:
        """Derivatives of the machine's numbers by the parameter, where small changes are followed around a cycle.

        Under laws that rest exactly slopes jump where a rest begins, and differences show both sides.
        """
        return self.family.slopes(float(self.value(guess))) if self.has_tolerance and super()._followed else None

    def slopes(self, u: Array, memory: Array, by_value: dict[str, float]) -> tuple[Array, Array]:
        """The residual of one state, and its derivatives by the state, the duration and the parameter.

        Small changes are followed along the cycle: a difference would smooth a corner of a law over its step, and where a slip just
        touches zero a branch turns within less.
        """
        by_scaled = {name: slope * float(self.span) for name, slope in by_value.items()}
        return self.section.slopes(self.robot(u), self.at, u[: self.at.smooth], memory, self.rtol, self.unit, by_scaled)

    def swing(self, cycle: PeriodicOrbit) -> float:
        """How far the spring moves from its turn at the start in half a cycle [m]: negative where the cycle is followed inside out."""
        if not self.section.turns:
            return 1.0  # it does not turn inside out
        later = 0.5 * cycle.duration
        drift = float(machine_of(cycle.model).far_end_velocity) * later
        return float(cycle.state[0] - cycle.run.at(later)["x"] + drift)

    def longer_run(self, u: Array, memory: Array) -> tuple[Any, float, float]:
        """A run of two cycles from a place, how long one takes, twice."""
        from stickslip.solvers import solve

        cycle = self.orbit(Root(u, 0.0, 0, np.empty((0, 0)), True, "", memory))
        options: dict[str, Any] = {"rtol": self.rtol} if adapter_of(cycle.model).has_tolerance else {}
        run = solve(
            cycle.model, duration=2 * cycle.duration, keep="trajectory", **self.at.begun(cycle.model, cycle.strobe_state), **options
        )
        return run, cycle.duration, cycle.duration

    def orbit(self, root: Root) -> Any:
        """The cycle at a point."""
        model, u = self.robot(root.at), root.at[: self.at.smooth]
        state = self.section.states(model, self.at, u[None, :], root.memory)[0]
        duration = float(u[-1] * self.unit)
        return PeriodicOrbit(model, self.period, state, root.residual, self.rtol, duration=duration, section=self.section).noted()


def rests_on_one_contact(cycle: Any) -> bool:
    """Whether a cycle is that of a machine with one contact, on which it rests exactly: how long it does says where that ends."""
    laws = adapter_of(cycle.model).laws
    return bool(cycle.is_cycle and len(cycle.patterns) == len(laws) == 1 and not laws[0].dynamic)


def vanishing(path: Path, points: list[Point]) -> tuple[float, float] | None:
    """Where the rest of stick-slip cycles vanishes, if their branch ends because of that, and how sure that is; None if not.

    The slide then touches the speed at which the contact rests: the square of the time at rest is smooth in the parameter. It is
    continued to zero, from the last points, and then from more cycles among them, whose scatter says how sure that is.
    """
    last = points[-1]
    if not isinstance(path, CyclePath) or not rests_on_one_contact(last.orbit):
        return None
    kept = [(p.value, _rest(p.orbit) ** 2) for p in points if p.orbit.residual < _WELL][-3:]
    if len(kept) < 3 or not kept[0][1] > kept[1][1] > kept[2][1] > 0.0 or kept[-1][1] > (_SHORT * last.orbit.duration) ** 2:
        return None
    critical, spread = inverse_parabola_zero(kept), abs(kept[-1][0] - kept[0][0])
    looked = (border_of_rest(path, last, critical, wider * spread) for wider in _WIDER)
    return next((border for border in looked if border), (critical, spread))


def border_of_rest(path: CyclePath, resting: Point, critical: float, spread: float) -> tuple[float, float] | None:
    """Where the rest of cycles vanishes, and how sure that is, from cycles beside the point where it did; None without such cycles."""
    near = _near(path, resting, critical - np.sign(critical - resting.value) * spread * np.linspace(0.1, 1.0, _NEAR))
    border = None if near is None else _fitted(*near)
    return border if border and border[1] < spread and abs(border[0] - critical) < spread else None


def birth(path: CyclePath, points: list[Point], beyond: Point) -> tuple[float, float] | None:
    """Where cycles shrink to nothing between the last point and one that is inside out, and how sure that is; None if they do not.

    Cycles are born out of a steady motion with a size whose square is smooth in the parameter (Hopf). It is continued to zero.
    """
    last, sizes = points[-1], [path.swing(p.orbit) for p in (points[-1], beyond)]
    if not sizes[0] > 0.0 > sizes[1]:
        return None
    kept = [(p.value, path.swing(p.orbit) ** 2) for p in points[-3:]]
    if len(kept) < 3 or not kept[0][1] > kept[1][1] > kept[2][1]:
        return last.value, abs(beyond.value - last.value) + _BIRTH * path.span
    critical = inverse_parabola_zero(kept)
    for near in (_BIRTH, _BIRTH / 4):
        squares = [_shrunk(path, last, critical, share) for share in near * path.span * np.array([0.5, 1.0, 2.0, 4.0])]
        if None in squares:
            break
        critical, other = inverse_parabola_zero(squares[:3]), inverse_parabola_zero(squares[1:])  # type: ignore[arg-type]
        kept = [(other, 0.0)]
    unsure = abs(kept[0][0] - critical)
    return float(critical), float(unsure + 8 * np.spacing(abs(critical)))


def _shrunk(path: CyclePath, last: Point, critical: float, away: float) -> tuple[float, float] | None:
    """The value of the parameter so far from where cycles vanish, and the square of their size there."""
    value = critical + away * float(np.sign(last.value - critical))
    guess = last.u.copy()
    guess[0] -= 0.5 * path.swing(last.orbit) / path.at.scales[0] * (1.0 - np.sqrt(away / abs(last.value - critical)))
    there = path.at_value(guess, value, path.remembered(last.orbit))
    size = path.swing(path.orbit(there)) if there.good else 0.0
    return (value, size**2) if size > 0.0 else None


def inverse_parabola_zero(kept: list[tuple[float, float]]) -> float:
    """Where a quantity vanishes whose inverse function is a parabola through three points."""
    (a, p), (b, q), (c, r) = kept
    return a * q * r / ((p - q) * (p - r)) + b * p * r / ((q - p) * (q - r)) + c * p * q / ((r - p) * (r - q))


def _near(path: CyclePath, last: Point, values: Array) -> tuple[Array, Array] | None:
    """Values, and squares of the time at rest of the cycles there; None unless all are found, with more rest the further away."""
    roots = [path.at_value(last.u, float(value), path.remembered(last.orbit)) for value in values]
    if not all(there.good for there in roots):
        return None
    rests = np.array([_rest(path.orbit(there), 1) ** 2 for there in roots])
    return (np.array([float(path.value(there.at)) for there in roots]), rests) if rests[0] > 0.0 and np.all(np.diff(rests) > 0.0) else None


def _fitted(values: Array, rests: Array) -> tuple[float, float]:
    """Where the rest vanishes in a series through all points, and how sure that is: by their scatter, and by what one more power says.

    The series begins with the square of the time at rest; the third power is there too under a law with a corner where the contact rests.
    """
    scaled, middle = np.sqrt(rests / rests.max()), float(values.mean())
    powers = scaled[:, None] ** np.array([0, 2, 3, 4, 5])
    (fitted, error), (more, _) = (_series(powers[:, :count], values - middle) for count in (4, 5))
    unsure = _ERRORS * error + abs(more - fitted) + _CLOSED * abs(middle)
    return middle + fitted, float(unsure)


def _series(powers: Array, values: Array) -> tuple[float, float]:
    """The constant of a series by least squares, and its standard error."""
    coefficients, *_ = np.linalg.lstsq(powers, values, rcond=None)
    scatter = float(np.sum((values - powers @ coefficients) ** 2)) / (len(values) - powers.shape[1])
    return float(coefficients[0]), float(np.sqrt(scatter * np.linalg.inv(powers.T @ powers)[0, 0]))


def _rest(cycle: PeriodicOrbit, turn: int = 0) -> float:
    """How long the contact rests in a cycle [s], the first time around or later: a rest wipes out what is missing of the cycle's state."""
    from stickslip.solvers import solve

    run = cycle.run if turn == 0 else solve(cycle.model, duration=(turn + 1) * cycle.duration, start=cycle.start, keep="trajectory")
    t = np.asarray(run.pieces.t)
    return float(np.diff(t)[(run.pieces.mode[:, 0] == 0) & (t[:-1] >= turn * cycle.duration)].sum())
