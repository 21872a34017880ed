"""scipy's integrators on the same law object, in plain Python floats: the independent judge. Slow, and nothing in it is ours.

Every piece is integrated on one side of v = 0 and ends where v comes back to 0, so no step crosses the kink of a dynamic law
or the jump of a set-valued one. A set-valued law has a third mode, stuck, which ends where the offered force reaches break-away.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from stickslip.batch import rows_of
from stickslip.errors import SolveError
from stickslip.fields import leaves, replace_leaf
from stickslip.forces import is_dynamic
from stickslip.pieces import PolynomialPieces
from stickslip.solvers import strobes
from stickslip.solvers.gather import Raw, gather, trajectory
from stickslip.solvers.request import Request
from stickslip.summary import STATUS, Summary
from stickslip.trajectory import Trajectory

__all__ = ["NAMES", "solve"]

NAMES = {"radau": "Radau", "lsoda": "LSODA", "bdf": "BDF", "dop853": "DOP853"}
_LEAST = 1e-300  # a velocity that has a side and nothing else
_GRID = 400  # looks per period at the offered force of a stuck body
_EVENTS = 2000  # changes of mode in one period that are taken for chatter
_NOT_A_NUMBER = 4


def solve(todo: Request) -> Trajectory | Summary:
    """Solve as asked, case by case."""
    if todo.keep == "summary":
        return gather(todo, todo.method, _parts(todo))
    pieces, counts = _march(todo, _case(todo, 0), todo.start[0])
    return trajectory(todo, todo.method, pieces, counts)


def _case(todo: Request, i: int) -> Any:
    """One case of the batch, its numbers plain floats."""
    names = tuple(name for name, _ in leaves(todo.model))
    return replace_leaf(todo.model, dict(zip(names, map(float, rows_of(todo.model, names)[i]), strict=True)))


class _Equations:
    """A model's plain equations, the side of v held; the state is x, v, z."""

    def __init__(self, model: Any, states: int):
        self.model, self.law, self.dynamic, self.inner = model, model.friction, is_dynamic(model.friction), states - 2

    def right(self, side: int) -> Callable[[float, Any], list[float]]:
        """The right side where v has this side."""
        model, law, many = self.model, self.law, self.inner > 1

        def dynamic(t: float, y: Any) -> list[float]:
            x, v, *z = y.tolist()
            slip, load = _held(model.contact_velocity(v), side), model.load(t, x)
            inner = z if many else z[0]
            rate = law.rate(slip, inner, load)
            acceleration = model.acceleration(t, x, v, law.force(slip, inner, rate, load))
            return [v, acceleration, *(rate if many else (rate,))]

        def set_valued(t: float, y: Any) -> list[float]:
            x, v = y.tolist()
            return [v, model.acceleration(t, x, v, law.sliding(_held(model.contact_velocity(v), side), model.load(t, x)))]

        return dynamic if self.dynamic else set_valued

    def excess(self, t: float, x: float) -> tuple[float, float]:
        """How far the offered force is above the forward limit, and below the backward one [N]; negative while it holds."""
        load = self.model.load(t, x)
        offered = self.model.total_mass * self.model.acceleration(t, x, 0.0, 0.0)
        backward, forward = self.law.breakaway(load)
        return offered - forward, backward - offered

    def mode(self, t: float, y: Any, before: int) -> int:
        """The mode that a state begins: a moving body keeps its side, a resting one asks the forces."""
        if y[1] != 0.0:
            return 1 if y[1] > 0 else -1
        if not self.dynamic:
            up, down = self.excess(t, y[0])
            return 1 if up > 0 else -1 if down > 0 else 0
        if not before:  # a start at rest: what moves it a moment later
            return 1 if self.right(1)(t + 1e-9 * float(self.model.period), y)[1] >= 0 else -1
        return -before if self.right(before)(t, y)[1] * before <= 0 else before


def _held(v: float, side: int) -> float:
    return v if side * v > _LEAST else side * _LEAST


def _march(todo: Request, model: Any, start: Any) -> tuple[PolynomialPieces, dict[str, Any]]:
    """The dense output of one case, and what it cost."""
    equations, T = _Equations(model, len(start)), float(model.period)
    t, y, end, mode = 0.0, np.array(start, float), todo.periods * T, 0
    parts, counts, changes = [], {"steps": 0, "evaluations": 0, "restarts": 0}, 0
    mode = equations.mode(t, y, 0)
    while t < end * (1 - 1e-14):
        t_old = t
        if mode == 0:
            t, mode = _break_away(equations, t, y, end, T)
            parts.append(_rest(t_old, t, y))
        else:
            solved = _integrate(todo, equations, t, y, end, mode)
            counts["steps"] += len(solved.t) - 1
            counts["evaluations"] += int(solved.nfev)
            parts.append(_pieces(solved, mode))
            t, y = float(solved.t[-1]), solved.y[:, -1].copy()
            if solved.status == 1:
                y[1] = 0.0
                mode = equations.mode(t, y, mode)
        counts["restarts"] += 1
        changes = changes + 1 if int(t / T) == int(t_old / T) else 0
        if changes > _EVENTS:
            raise SolveError(
                f"the mode changed {changes} times in the period at t = {t:.6g} s; try another rtol (now {todo.rtol:g}) or method"
            )
    return _joined(parts, t, end), counts


def _integrate(todo: Request, equations: _Equations, t: float, y: Any, end: float, mode: int) -> Any:
    """One piece on one side of v = 0, by scipy."""
    from scipy.integrate import solve_ivp

    model = equations.model
    speed = float(model.velocity_scale) or 1.0
    scale = getattr(model.friction, "scale", None)
    inner = float(np.max(scale(model.load(t, y[0])))) if scale is not None else speed * float(model.period)
    atol = 0.01 * todo.rtol * np.array([speed * float(model.period), speed, *[inner] * equations.inner])

    def rest(time: float, state: Any) -> float:
        return mode * _LEAST if time == t else state[1]

    rest.terminal, rest.direction = True, -mode  # type: ignore[attr-defined]
    with np.errstate(all="ignore"):
        solved = solve_ivp(
            equations.right(mode), (t, end), y, NAMES[todo.method], rtol=max(todo.rtol, 3e-14), atol=atol, events=rest, dense_output=True,
            max_step=0.1 * float(model.period),
        )  # fmt: skip
    if solved.status < 0 or not np.all(np.isfinite(solved.y[:, -1])):
        why = solved.message if np.all(np.isfinite(solved.y[:, -1])) else STATUS[_NOT_A_NUMBER]
        raise SolveError(
            f"scipy's {NAMES[todo.method]} stopped at t = {solved.t[-1]:.6g} s of {end:.6g} s: {why}; try another rtol or method"
        )
    return solved


def _break_away(equations: _Equations, t: float, y: Any, end: float, T: float) -> tuple[float, int]:
    """When a stuck body breaks away, and which way; the end of the run if it does not."""
    from scipy.optimize import brentq

    count = max(int(np.ceil((end - t) / T * _GRID)), 1)
    for i in range(count):
        a, b = t + (end - t) * i / count, t + (end - t) * (i + 1) / count
        late = equations.excess(b, y[0])
        for k, mode in ((0, 1), (1, -1)):
            if late[k] > 0:
                early = equations.excess(a, y[0])[k]
                return (a if early >= 0 else float(brentq(lambda s, k=k: equations.excess(s, y[0])[k], a, b, xtol=1e-18, rtol=1e-15))), mode
    return end, 0


# ---- dense output ----
_Part = tuple[Any, Any, Any, int]  # starts of the pieces, x there, coefficients, mode


def _rest(t_old: float, t: float, y: Any) -> _Part:
    return np.array([t_old]), np.array([y[0]]), np.zeros((1, len(y) - 1, 1)), 0


def _pieces(solved: Any, mode: int) -> _Part:
    """scipy's own interpolants as polynomials of the same degree in theta."""
    interpolants = solved.sol.interpolants
    parts = []
    for a, b, piece in zip(solved.t[:-1], solved.t[1:], interpolants, strict=True):
        degree = _degree(piece)
        theta = 0.5 - 0.5 * np.cos(np.pi * np.arange(degree + 1) / degree)
        parts.append(np.linalg.solve(theta[:, None] ** np.arange(degree + 1), piece(a + (b - a) * theta)[1:].T).T)
    if solved.status == 1:
        parts[-1] = _ending_at_rest(parts[-1])
    return solved.t[:-1], solved.y[0, :-1], _padded(parts), mode


def _degree(piece: Any) -> int:
    """Degree of an interpolant of scipy's: Radau's is cubic, DOP853's of degree 7, the multistep methods say their order."""
    order = getattr(piece, "order", None)
    if order is None:
        order = (
            len(piece.p) - 1
            if hasattr(piece, "p") and np.ndim(piece.p)
            else {"RadauDenseOutput": 3, "Dop853DenseOutput": 7}.get(type(piece).__name__, 7)
        )
    return max(int(order), 1)


def _ending_at_rest(c: Any) -> Any:
    """The root of v was found to rounding only: take that rounding off."""
    c = c.copy()
    c[0, -1] -= c[0].sum()
    return c


def _padded(parts: list[Any]) -> Any:
    width = max(c.shape[1] for c in parts)
    return np.stack([np.pad(c, ((0, 0), (0, width - c.shape[1]))) for c in parts])


def _joined(parts: list[_Part], t: float, end: float) -> PolynomialPieces:
    width = max(part[2].shape[2] for part in parts)
    times = np.append(np.concatenate([part[0] for part in parts]), max(t, end))
    good = np.diff(times) > 0
    x0 = np.concatenate([part[1] for part in parts])
    modes = np.concatenate([np.full(len(part[0]), part[3], np.int8) for part in parts])
    c = np.concatenate([np.pad(part[2], ((0, 0), (0, 0), (0, width - part[2].shape[2]))) for part in parts])
    return PolynomialPieces(np.append(times[:-1][good], times[-1]), modes[good], x0[good], c[good])


# ---- batches ----
def _parts(todo: Request) -> Iterator[tuple[tuple[int, int], Raw]]:
    """Raw results case by case; a case that fails has a status."""
    for i in range(todo.cases):
        model = _case(todo, i)
        try:
            yield (i, i + 1), strobes.raw([_summary(todo, model, _march(todo, model, todo.start[i])[0])])
        except SolveError:
            yield (i, i + 1), strobes.raw([{**strobes.NOTHING, "status": 3}])
        if todo.progress is not None:
            todo.progress(i + 1, todo.cases)


def _summary(todo: Request, model: Any, pieces: PolynomialPieces) -> dict[str, Any]:
    T = float(model.period)
    times = np.minimum(np.arange(todo.periods + 1) * T, pieces.t[-1])
    x, v, z = pieces.evaluate(times, _index(pieces, times))
    strobe = np.column_stack([x, v, z])
    period = strobes.period_of(model, strobe, 30 * todo.rtol)
    settle = todo.periods - period if todo.auto and period else todo.settle
    displacement, window = strobes.window_of(strobe, settle, period)
    count = 5000 * (period or 1)
    t = pieces.t[-1] - (period or 1) * T * (1 - (np.arange(count) + 0.5) / count)
    index = _index(pieces, t)
    _, v, z = pieces.evaluate(t, index)
    codes = strobes.codes_of(model, v, z, np.asarray(pieces.mode)[index].astype(int), todo.slip_ratio)
    number, seg_time, seg_code = strobes.segments_of(np.full(count, (period or 1) * T / count), codes)
    return {
        "displacement": displacement, "window": window, "period": period, "periods_run": todo.periods, "status": 0,
        "v_min": v.min(), "v_max": v.max(),
        "seg_count": number, "seg_time": seg_time, "seg_code": seg_code, "margin_force": strobes.margin_force(model),
    }  # fmt: skip


def _index(pieces: PolynomialPieces, t: Any) -> Any:
    return np.clip(np.searchsorted(pieces.t, t, side="right") - 1, 0, len(pieces.mode) - 1)
