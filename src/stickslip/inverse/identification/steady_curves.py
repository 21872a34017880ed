"""The steady motion of one robot as a curve over the drive's phase, found from a start that is nearly right."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model, Numeric
from stickslip.basics.errors import SolveError
from stickslip.basics.frozen_arrays import sealed
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, strobe_states
from stickslip.models.machine_adapter import machine_of
from stickslip.solvers import solve

_FIRST, _MOST = 6, 400  # drive periods of the first run, and of all runs together
_LEFT = 1e-5  # of the tolerance: what may still be left where strobe points fall to their limit; derivatives are differences of curves
_FALLS = 0.5  # times the last step from period to period that the next one is, where they do
_ALONG = 0.3  # of a step from period to period: more of it beside the last one, and the limit is not on the line of both
_WATCHED, _DISTURBED = 24, 1e-4  # drive periods after a disturbance, and its size beside the velocity
_LOOKED = 8  # states at which equations are looked at
_LONGEST = 4  # motion periods up to here are followed


@sealed
@dataclass(frozen=True, eq=False)
class TransientCurve:
    """A motion from a given velocity at a strobe time on; its phases count drive periods from there.

    Parameters
    ----------
    run : Trajectory
    body : int, optional
        Whose motion it is, of a machine whose columns have an axis for bodies.
    """

    run: Any
    body: int | None = field(default=None, kw_only=True)

    def _times(self, phase: Numeric) -> Any:
        return np.asarray(phase) * self.run.period_time

    def _state(self, phase: Numeric, which: int) -> Any:
        """x, v or z, those of the machine's principal body."""
        t = np.clip(self._times(phase), self.run.pieces.t[0], self.run.pieces.t[-1])
        return self._of_the_body(self.run._columns.own("xvz"[which], self.run._states_at(t, self.run._index(t))[which]))

    def _of_the_body(self, column: Any) -> Any:
        return column if self.body is None or np.ndim(column) < 2 else column[..., self.body]

    def v(self, phase: Numeric) -> Any:
        """Velocity at phases counted in drive periods [m/s]."""
        return self._state(phase, 1)

    def x(self, phase: Numeric) -> Any:
        """Position [m]."""
        return self._state(phase, 0)


@sealed
@dataclass(frozen=True, eq=False)
class SteadyCurve(TransientCurve):
    """The last motion period of a run.

    Parameters
    ----------
    run : Trajectory
    period : int
        Drive periods until the motion repeats.
    settled : bool
        Whether the strobe point repeats.
    end : dict
        The last strobe point, from which a neighbouring robot is started.
    """

    period: int
    settled: bool
    end: dict[str, Any]

    def _times(self, phase: Any) -> Any:
        return self.run.strobe_times[-1 - self.period] + np.mod(phase, self.period) * self.run.period_time

    def x(self, phase: Numeric) -> Any:
        """Position at phases counted in drive periods, going on from period to period [m]."""
        whole = np.floor(np.asarray(phase) / self.period)
        return super().x(phase) - self._of_the_body(self.run.strobe_x)[-1 - self.period] + whole * self.step

    @property
    def step(self) -> float:
        """Displacement in one motion period [m]."""
        x = self._of_the_body(self.run.strobe_x)
        return float(x[-1] - x[-1 - self.period])

    @property
    def mean_velocity(self) -> float:
        """Mean velocity [m/s]."""
        return self.step / (self.period * self.run.period_time)


def steady_curve(robot: Any, start: dict[str, Any] | None = None, rtol: float = 1e-8, body: int | None = None) -> SteadyCurve:
    """The steady motion of a robot, or of a body of a machine; starts near it make it cheap.

    Where the strobe points approach their limit geometrically, the limit is extrapolated and the run begins there again. Each coordinate
    is looked at against its size, times a speed: a body that rests at strobe times has no velocity there, whatever the others do.
    """
    spent, periods = 0, _FIRST
    scale = float(machine_of(robot).free_velocity or robot.velocity_scale or 1.0)
    tolerance = min(30 * rtol, 1e-5) * scale
    at = coordinates(robot)
    while True:
        try:
            run = solve(robot, periods=periods, samples=4, rtol=rtol, keep="trajectory", start=start)
        except SolveError:
            if start is None:
                raise
            start = None
            continue
        spent += periods
        states = strobe_states(run)
        points = states / at.scales * scale
        period = next((p for p in range(1, _LONGEST + 1) if len(points) > 2 * p and _apart(points, p) <= tolerance), None)
        if spent >= _MOST or (period is not None and not _still_nearing(points, period, _LEFT * tolerance)):
            return SteadyCurve(run, period or _usual(points, tolerance), period is not None, at.start(states[-1]), body=body)
        start, periods = at.start(_nearer(at.smooth, states, points, tolerance)), periods if period else min(2 * periods, 100)


def _apart(points: Array, p: int) -> float:
    """How far the last p strobe points are from those p periods before."""
    return float(abs(points[-p:] - points[-2 * p : -p]).max())


def _usual(points: Array, tolerance: float) -> int:
    """After how many periods points that have not settled nearly repeat: the fewest by which they are twice as near as by fewer."""
    apart = [_apart(points, p) for p in range(1, _LONGEST + 1) if len(points) > 2 * p]
    best = 0
    for p in range(1, len(apart)):
        best = p if apart[p] < _FALLS * apart[best] - tolerance else best
    return best + 1


def _still_nearing(points: Array, p: int, tolerance: float) -> bool:
    """Whether strobe points that repeat after p periods still get nearer to their limit, by a part of what is left each time."""
    return bool(tolerance < _apart(points, p) < _FALLS * _apart(points[:-1], p))


def _nearer(smooth: int, states: Array, points: Array, tolerance: float) -> Array:
    """A state nearer to the limit of the strobe points, in its first `smooth` coordinates."""
    p = _usual(points, tolerance)
    if len(points) < 2 * p + 1:
        return states[-1]
    last, before = points[-1] - points[-1 - p], points[-1 - p] - points[-1 - 2 * p]
    ratio = float(last @ before) / float(before @ before) if before.any() else 0.0
    if not 0.05 < ratio < 0.98 or float(abs(last - ratio * before).max()) > _ALONG * float(abs(last).max()):
        return states[-1]
    ahead = ratio / (1 - ratio)
    return states[-1] + np.where(np.arange(states.shape[1]) < smooth, (states[-1] - states[-1 - p]) * ahead, 0.0)


def periods_to_settle(curve: SteadyCurve, rtol: float = 1e-8) -> float:
    """Drive periods in which a tenth is left of a small disturbance of a steady motion; 0 where it is gone at once."""
    model, p = curve.run.model, curve.period
    speed = float(machine_of(model).free_velocity or model.velocity_scale or 1.0)
    many = max(_WATCHED // p, 2) * p
    begun = solve(model, periods=many, samples=4, rtol=rtol, keep="trajectory", start=curve.end)
    moved = solve(model, periods=many, samples=4, rtol=rtol, keep="trajectory", start=_disturbed(curve.end, _DISTURBED * speed))
    scales = coordinates(model).scales
    off = np.sqrt(np.sum((strobe_states(moved) / scales * speed - strobe_states(begun) / scales * speed) ** 2, axis=1))
    early, late = off[many // 2 // p * p], off[many]
    steps = many - many // 2 // p * p
    if not late > _DISTURBED * speed * 1e-3 or not late < early:
        return np.inf if late > max(early, _DISTURBED * speed * 1e-3) else 0.0
    return float(steps * np.log(10.0) / np.log(early / late))


def _disturbed(start: dict[str, Any], size: float) -> dict[str, Any]:
    """A start whose velocities are a little larger."""
    v = start["v"]
    return start | {"v": {name: each + size for name, each in v.items()} if isinstance(v, dict) else v + size}


def transient_curve(robot: Model, start: dict[str, float], periods: int, rtol: float = 1e-8, body: int | None = None) -> TransientCurve:
    """The motion of a robot from a velocity, and a position, at a strobe time on, its bristles unbent."""
    return TransientCurve(solve(robot, periods=periods, settle=0, samples=4, rtol=rtol, keep="trajectory", start=start), body=body)


def moves_alike_anywhere(model: Model) -> bool:
    """Whether a machine moves the same wherever it stands, judged from its equations at a few states and positions; a pendulum does not."""
    m = machine_of(model).mechanics
    if m.controllers.counts or machine_of(model).wavelength is not None:
        return False
    held, rng = (0.0,) * len(m.contacts), np.random.default_rng(0)
    for t, q, u, away in rng.uniform(-1.0, 1.0, (_LOOKED, 4)):
        at, moving = abs(float(t)) * model.period, (u,) * m.coordinates
        places = (tuple(x + q for x in m.start), tuple(x + q + away for x in m.start))
        here, there = ([*m.accelerations(at, positions, moving, held), *m.loads(at, positions, moving)] for positions in places)
        if not np.allclose(here, there, rtol=1e-12, atol=0.0):
            return False
    return True
