"""Special points of a branch in two parameters: curves of flips, folds and borders of motion types, and where borders meet."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.arguments import explains_arguments
from stickslip.dynamics.continuation.branches import Branch
from stickslip.dynamics.continuation.one_parameter import Family
from stickslip.dynamics.continuation.point_accuracy import Meeting, Special
from stickslip.dynamics.continuation.pseudo_arclength import tangent_of
from stickslip.dynamics.periodic.arc_sequences import Margin, Sequence, dip, gap, margins, misses, sequence_of, slope_of_gap
from stickslip.dynamics.periodic.limit_cycles import LimitCycle
from stickslip.dynamics.periodic.newton import Found, newton
from stickslip.dynamics.periodic.periodic_orbits import PeriodicOrbit, periodic_orbit
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, strobe_map
from stickslip.dynamics.stroboscopic.strobe_states import needs_one_body
from stickslip.errors import InputError, SolveError
from stickslip.faces import Drawn
from stickslip.flow import is_flow
from stickslip.machine_adapter import machine_of
from stickslip.sealing import sealed

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["Curve", "Meeting", "special_curve"]

Array = Any
_FLOOR = 1e-14  # of residuals: their own rounding
_SLOPE = 1e-5  # half the distance of the differences that give multipliers along a curve, in scales


@sealed
@dataclass(frozen=True, eq=False)
class Curve(Drawn):
    """A curve of special points in two parameters; `plot` draws it.

    Parameters
    ----------
    kind : str
        What its points are: "flip", "fold" or "type-border".
    parameters : (str, str)
        Their names.
    values : array (points, 2)
        The parameters along the curve.
    accuracy : array (points, 2)
        By how much the parameters may be wrong, across the curve: from the residuals, and from differences of twice the step.
    orbits : tuple of PeriodicOrbit
        The motions.
    special : list of Meeting
        Points where it meets another border.
    ended : str
        Why it ends where it ends.

    Examples
    --------
    >>> import stickslip as ss
    >>> rig = dict(tilt_deg=1.7, mu0=0.18, law="coulomb")
    >>> branch = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=3.6e-4, stop=3.8e-4, step=0.2, **rig)
    >>> curve = ss.special_curve(branch, branch.special[0], "mu0", stop=0.19, step=0.2)  # alpha_minus = 1: A grows as mu_minus
    >>> curve.parameters, round(float(curve.values[-1, 0] / curve.values[0, 0]), 4)
    (('amplitude', 'mu0'), 1.0...)
    """

    kind: str
    parameters: tuple[str, str]
    family: Family
    values: Array
    accuracy: Array
    orbits: tuple[PeriodicOrbit, ...]
    special: list[Meeting]
    ended: str

    _drawn_by, _inches = "special_curve", (4.0, 2.6)

    @property
    def points(self) -> xr.Dataset:
        """The curve as an `xarray.Dataset` over ``point``."""
        import xarray as xr

        columns: dict[str, Any] = {name: ("point", self.values[:, i], self.family.describe(name)) for i, name in enumerate(self.parameters)}
        columns |= {f"{name}_accuracy": ("point", self.accuracy[:, i]) for i, name in enumerate(self.parameters)}
        columns |= {name: ("point", [o.state[i] for o in self.orbits]) for i, name in enumerate(self.orbits[0].names)}
        return xr.Dataset(columns, attrs={"kind": self.kind, "ended": self.ended})

    def _facts(self) -> dict[str, Any]:
        across, up = self.parameters
        ends = [f"{across} = {x:.6g}, {up} = {y:.6g}" for x, y in self.values[[0, -1]].tolist()]
        return {"kind": self.kind, "from": ends[0], "to": ends[1], "points": len(self.values), "ended": self.ended}

    def __repr__(self) -> str:
        told = "".join(f"; {m.kind} at {m.told}" for m in self.special)
        return f"<Curve: {self.kind} in ({', '.join(self.parameters)}), {len(self.values)} points{told}; {self.ended}>"


@dataclass(frozen=True, eq=False)
class _Problem:
    """Unknowns u = (inner unknowns, two scaled parameters); `residuals` has one equation less."""

    family: Family
    origin: Array
    span: Array
    residuals: Callable[[Array], Array]
    orbit: Callable[[Array], PeriodicOrbit]
    watched: Callable[[Array], dict[Any, float]]
    tolerance: float
    meeting: Callable[[Array, Any], Found] | None
    again: Callable[[Array], Array] | None = None  # the residuals by a worse method

    def values(self, u: Array) -> Array:
        """The two parameters."""
        return self.origin + self.span * u[..., -2:]

    def accuracy(self, found: Found) -> Array:
        """By how much the two parameters of a point may be wrong."""
        unsure = np.full(len(found.at), max(found.residual, _FLOOR))
        if self.again is not None:
            unsure[:-1] += abs(self.again(found.at[None, :])[0] - self.residuals(found.at[None, :])[0])
        moved = abs(np.linalg.pinv(found.jacobian)) @ unsure
        return self.span * moved[-2:] + 2 * np.spacing(abs(self.values(found.at)))


@explains_arguments
def special_curve(branch: Branch, special: Special, parameter: str, stop: float, *, step: float = 0.02, points: int = 200) -> Curve:
    """The curve of a special point of a branch in two parameters.

    Parameters
    ----------
    branch : Branch
        The branch; its parameter is the first of the curve.
    special : Special
        A flip or fold of it (any law), or a border of motion types (set-valued laws, where a border is an equation).
    parameter : str
        The second parameter: a keyword of the branch's maker that was fixed.
    stop : float
        Its last value. The curve may turn back; it also ends when the first parameter has moved by five times the range of the branch.
    step : float
        First step, in the scaled plane.
    points : int
        Most points.

    Returns
    -------
    Curve
        `points`, and `special`: where it meets another border, such as the triple point of types I, II and III.

    Examples
    --------
    >>> import stickslip as ss
    >>> b = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=5e-4, stop=6e-4, tilt_deg=1.7, mu0=0.18, law="coulomb")
    >>> curve = ss.special_curve(b, b.special[0], "mu0", stop=0.2)
    >>> curve.kind, bool(curve.values[-1, 0] > curve.values[0, 0])  # more friction, more amplitude
    ('type-border', True)
    """
    fixed = dict(branch.family.fixed)
    if parameter not in fixed:
        fixed |= _default(branch.family.make, parameter)
    begin = float(fixed.pop(parameter))
    if stop == begin:
        raise InputError("special_curve", [f"stop = {stop!r} is where the curve begins; give another last value of {parameter}"])
    both = Family(branch.family.make, (branch.parameter, parameter), fixed, "special_curve")
    if isinstance(special.orbit, LimitCycle):
        raise InputError(
            "special_curve", ["it is a branch of limit cycles; allowed are those of driven motions; take ss.continuation at each value"]
        )
    if is_flow(special.orbit.model):
        raise InputError("special_curve", ["it is a branch of a flow; allowed are those of machines; take ss.continuation at each value"])
    laws = machine_of(special.orbit.model).laws
    origin, span = np.array([special.value, begin]), np.array([np.ptp(branch.values) or 1.0, abs(stop - begin)])
    if special.kind == "type-border":
        hint = "type ss.continuation at each value; flips and folds are followed for any machine"
        needs_one_body("special_curve", special.orbit.model, "a border of motion types is followed by the arcs of one contact", hint)
    if special.kind in ("flip", "fold"):
        problem, u = _multiplier_problem(both, special, origin, span)
    elif special.kind == "type-border" and not any(law.dynamic for law in laws):
        problem, u = _border_problem(both, branch, special, origin, span)
    else:
        names = " and ".join(dict.fromkeys(law.name for law in laws))
        raise InputError(
            "special_curve",
            [f"it is a {special.kind} under {names}; allowed are flips and folds of any law, "
             "and type borders of set-valued laws, where they are sharp; for others take ss.continuation at each value"],
        )  # fmt: skip
    return _followed(problem, u, special.kind, float(np.sign(stop - begin)), step, points)


def _default(make: Any, parameter: str) -> dict[str, float]:
    """The value of a parameter that was not given: the maker's own."""
    import inspect

    if not callable(make):
        from stickslip.fields import leaves

        known = dict(leaves(make))
    else:
        known = {p.name: p.default for p in inspect.signature(make).parameters.values() if isinstance(p.default, (int, float))}
    if parameter not in known:
        raise InputError("special_curve", [f"parameter = {parameter!r} is not a number of the branch's maker; known: {', '.join(known)}"])
    return {parameter: float(known[parameter])}


# ---- flips and folds: the strobe map and its multipliers ----
def _multiplier_problem(both: Family, special: Special, origin: Array, span: Array) -> tuple[_Problem, Array]:
    orbit = special.orbit
    at, period, rtol, sign = coordinates(orbit.model), orbit.period, orbit.rtol, 1.0 if special.kind == "flip" else -1.0
    d, scales, memory = at.smooth, at.scales[: at.smooth], orbit.state[at.smooth :]

    def residuals(U: Array, step: float = _SLOPE) -> Array:
        shifts = np.vstack([np.zeros(d), np.eye(d), -np.eye(d)]) * step
        y, values = U[:, :d], origin + span * U[:, d:]
        tried = (y[:, None, :] + shifts).reshape(-1, d)
        model = both.robots(*np.repeat(values, 2 * d + 1, axis=0).T)
        states = np.hstack([tried * scales, np.broadcast_to(memory, (len(tried), len(memory)))])
        after = strobe_map(model, states, period, rtol).state
        same = np.all(after[:, d:] == memory, axis=1)  # a curve ends where what the law remembers on the strobe changes
        ends = np.where(same[:, None], after[:, :d] / scales, np.nan).reshape(len(U), 2 * d + 1, d)
        J = np.swapaxes(ends[:, 1 : d + 1] - ends[:, d + 1 :], 1, 2) / (2 * step)
        return np.column_stack([ends[:, 0] - y, np.linalg.det(J + sign * np.eye(d))])

    def made(u: Array) -> PeriodicOrbit:
        return PeriodicOrbit(both.robot(*(origin + span * u[d:])), period, np.append(u[:d] * scales, memory), 0.0, rtol)

    again = lambda U: residuals(U, 2 * _SLOPE)  # noqa: E731
    problem = _Problem(both, origin, span, residuals, made, lambda u: {}, 3e-8, None, again)
    return problem, np.append(orbit.state[:d] / scales, [0.0, 0.0])


# ---- borders of motion types: arcs whose switch times are unknown ----
def _border_problem(both: Family, branch: Branch, special: Special, origin: Array, span: Array) -> tuple[_Problem, Array]:
    sequence, times, key = _vanishing(branch, special)
    k, period = len(times), special.orbit.period

    def parts(u: Array) -> tuple[Any, Array]:
        return both.robot(*(origin + span * u[k:])), u[:k]

    facing = 0.0

    def turn(u: Array) -> float:
        """Whether the force falls or grows where the border's condition holds: the border ends where that turns."""
        model, t = parts(u)
        return slope_of_gap(model, _instant(sequence, t, key) * float(model.period), key[2])

    def one(u: Array, turning: bool) -> Array:
        model, t = parts(u)
        if turning:  # a dip of the force within rest has reached its beginning
            T = float(model.period)
            last = [float(gap(model, _instant(sequence, t, key) * T, key[2])), turn(u) * T]
        else:
            last = [_dip(model, sequence, t, key) if key[0] == "rest" else margins(model, sequence, t)[key]]
        return np.append(misses(model, sequence, t), last)

    def made(u: Array) -> PeriodicOrbit:
        return periodic_orbit(parts(u)[0], period)

    def watched(u: Array) -> dict[Any, float]:
        found = {name: value for name, value in margins(parts(u)[0], sequence, u[:k]).items() if name != key and np.isfinite(value)}
        return found | {_TURN: facing * turn(u)}

    def meeting(u: Array, other: Any) -> Found:
        found = newton(lambda U: np.array([one(v, True) for v in U]), u, 1e-14, most=20, reach=0.1)
        if not found.good:
            raise SolveError(f"the point where two borders meet was not found: {found.why}")
        return found

    u = np.append(times, [0.0, 0.0])
    facing = float(np.sign(turn(u)))
    return _Problem(both, origin, span, lambda U: np.array([one(v, False) for v in U]), made, watched, 1e-13, meeting), u


_TURN = ("turn", 0, 0)


def _instant(sequence: Sequence, times: Array, key: Margin) -> float:
    """When the border's condition is asked, in drive periods: where rest begins, or where a slide ends."""
    if key[0] == "rest" and len(times):
        return float(times[key[1]])
    return float(sequence.ends(times)[key[1]])


def _dip(model: Any, sequence: Sequence, times: Array, key: Margin) -> float:
    """The dip of the force's room in and shortly before rest, so that the border can be followed up to where it ends."""
    T, i = float(model.period), key[1]
    begin = float(times[i]) if len(times) else 0.0
    return dip(model, (begin - 0.1) * T, float(sequence.ends(times)[i]) * T, key[2])


def _vanishing(branch: Branch, special: Special) -> tuple[Sequence, Array, Margin]:
    """The sequence on the side of the border where all arcs have length, its times at the border, and the margin that vanishes there."""
    best: tuple[float, Sequence, Array, Margin] | None = None
    for side in (-1.0, 1.0):
        for distance in (1e-4, 1e-6):
            value = special.value + side * distance * (float(np.ptp(branch.values)) or 1.0)
            orbit = branch.at(value)
            sequence, times = sequence_of(orbit)
            found = margins(orbit.model, sequence, times)
            name = min(found, key=lambda m: abs(found[m]))
            if (
                best is None
                or len(sequence.modes) < len(best[1].modes)
                or (len(sequence.modes) == len(best[1].modes) and found[name] < best[0])
            ):
                best = (found[name], sequence, times, name)
    assert best is not None
    return best[1], best[2], best[3]


# ---- the curve itself ----
def _followed(problem: _Problem, guess: Array, kind: str, sign: float, step: float, points: int) -> Curve:
    n = len(guess)
    first = _corrected(problem, guess, np.eye(n)[-1])
    if not first.good:
        raise SolveError(f"the special point could not be found again in two parameters: {first.why} (residual {first.residual:.1e})")
    here, tangent = first.at, tangent_of(first.jacobian[:-1], sign * np.eye(n)[-1])
    found, special, ended = [first], [], f"it was followed for {points} points"
    seen = problem.watched(here)
    while len(found) < points:
        try:
            ahead, why = _corrected(problem, here + step * tangent, tangent), ""
        except InputError as error:
            beyond = problem.values(here + 2 * step * tangent)
            ahead, why = None, f"it left the admissible region: {problem.family.refusal(error, *beyond)}"
        if ahead is None or not ahead.good or np.linalg.norm(ahead.at - here) > 2 * step:
            step *= 0.5
            if step < 1e-6:
                ended = why or f"no step was small enough: {ahead.why if ahead else ''}"
                break
            continue
        now = problem.watched(ahead.at)
        lost = [name for name, value in now.items() if value < 0 <= seen.get(name, -1.0)]
        if lost and problem.meeting is not None:
            found.append(problem.meeting(0.5 * (here + ahead.at), lost[0]))
            special.append(_met(problem, found[-1]))
            ended = "it met another border, beyond which its motion does not exist"
            break
        here, tangent, seen = ahead.at, tangent_of(ahead.jacobian[:-1], tangent), now
        found.append(ahead)
        first_name, name = problem.family.parameters
        if sign * here[-1] >= 1.0 or sign * here[-1] < -1e-9:
            ended = f"it came back to where {name} began" if sign * here[-1] < 0 else "it reached the end of the range"
            break
        if abs(here[-2]) > 5.0:
            ended = f"{first_name} has moved by five times the branch's range"
            break
        step = min(0.1, 1.3 * step) if ahead.iterations <= 4 else step
    orbits, missing = _orbits(problem, [f.at for f in found])
    values = np.array([problem.values(f.at) for f in found[: len(orbits)]])
    accuracy = np.array([problem.accuracy(f) for f in found[: len(orbits)]])
    return Curve(kind, problem.family.parameters, problem.family, values, accuracy, orbits, special, ended + missing)  # type: ignore[arg-type]


def _orbits(problem: _Problem, found: list[Array]) -> tuple[tuple[PeriodicOrbit, ...], str]:
    """The motions along a curve, up to the first that Newton's method does not find again: at the edge of what is admissible."""
    orbits: list[PeriodicOrbit] = []
    for u in found:
        try:
            orbits.append(problem.orbit(u))
        except (SolveError, InputError):
            if not orbits:
                raise
            return tuple(orbits), f"; the motions of its last {len(found) - len(orbits)} points were not found again, and are left out"
    return tuple(orbits), ""


def _met(problem: _Problem, found: Found) -> Meeting:
    orbit, accuracy = problem.orbit(found.at), problem.accuracy(found)
    p, q = problem.values(found.at)
    note = "two borders of motion types meet here"
    return Meeting("triple-point", (float(p), float(q)), replace(orbit, notes=(note,)), (float(accuracy[0]), float(accuracy[1])))


def _corrected(problem: _Problem, guess: Array, across: Array) -> Found:
    def residuals(U: Array) -> Array:
        return np.column_stack([problem.residuals(U), (U - guess) @ across])

    return newton(residuals, guess, problem.tolerance, most=15, floor=1e-7, reach=0.2)
