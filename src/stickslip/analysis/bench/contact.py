"""A contact under prescribed motion: force history and dissipated work."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any

from stickslip.analysis.bench.probe import Probe
from stickslip.basics.contracts import Array
from stickslip.basics.errors import SolveError
from stickslip.models.friction.law_adapter import TINY

#: Velocity [m/s] as a function of the time since the beginning of a segment.
Velocity = Callable[[float], float]
#: Evaluations after which a segment between two switches is passed to a stiff integrator.
CALLS = 20_000


def constant_velocity(speed: float) -> Velocity:
    """A constant velocity."""
    return lambda t: speed


def swing(distance: float, peak: float) -> tuple[float, Velocity]:
    """Duration [s] and velocity of a half-sine stroke over a distance, at rest at both ends."""
    length, speed = 0.5 * math.pi * abs(distance) / peak, math.copysign(peak, distance)
    return length, lambda t: speed * math.sin(math.pi * t / length)


class _TooStiff(Exception):
    """The integrator takes too many steps."""


class MovedContact:
    """The state of a contact: position, inner states, memories, and the work done on it so far.

    Each segment is integrated from switch to switch of the law's memories, with the law as written; within a segment the velocity
    has one sign.

    Parameters
    ----------
    probe : Probe
        The law under its load.
    work : float
        A typical work, the scale of its error tolerance [J].
    rtol : float
        Relative tolerance.
    """

    def __init__(self, probe: Probe, work: float, rtol: float = 1e-8):
        self.probe, self.work, self.rtol = probe, max(work, 1e-300), rtol
        self.z, self.mode = probe.start
        self.x = self.done = self.turned = self.least = 0.0
        self._side = 1.0

    def force(self, v: float, z: tuple[float, ...] | None = None) -> float:
        """Friction force at a velocity, in the direction in which the contact was last moved [N]."""
        return float(self.probe.force(self._held(v), self.z if z is None else z, self.mode))

    def _held(self, v: float) -> float:
        return self._side * max(self._side * v, TINY)

    def follow(self, length: float, velocity: Velocity, samples: int = 0) -> list[tuple[float, float, float, float]]:
        """Traverse one segment; returns approximately the requested number of samples of (time, position, velocity, force)."""
        t, points, idle = 0.0, [], 0
        self._side = math.copysign(1.0, velocity(0.5 * length))
        while t < length:
            run = self._run(t, length, velocity, dense=samples > 0)
            if samples:
                points += self._sampled(run, velocity, max(int(samples * (run.t[-1] - t) / length), 2))
            before = [g for g, _, _ in self.probe.switches(velocity(0.5 * (t + run.t[-1])), self.z, self.mode)]
            idle = idle + 1 if run.t[-1] <= t else 0  # consecutive steps of zero duration
            if idle > 100:
                raise SolveError(f"{self.probe.law.name} switches its memories endlessly at one instant; check its switches")
            before = [max(g, self.probe.load) for g in before] if idle else before  # guards already at zero count as falling
            t, y = float(run.t[-1]), [float(value) for value in run.y[:, -1]]
            self.z, self.x, self.done, self.turned = tuple(y[:-3]), *y[-3:]
            self.least = min(self.least, float(run.y[-2].min()))
            v = velocity(t)
            stopped = t >= length and abs(v) < 1e-9 * abs(velocity(0.5 * length))
            self._switch(0.0 if stopped else v, before, t < length)
        return points

    def _run(self, t: float, end: float, velocity: Velocity, dense: bool, method: str = "LSODA") -> Any:
        """Integrate states, position and work up to the next switch. LSODA may not detect stiffness where the rates are almost zero."""
        from scipy.integrate import solve_ivp

        path = max(abs(velocity(0.5 * end)) * end, 1e-300)
        atol = [*(0.01 * self.rtol * size for size in self.probe.scale), self.rtol * path, *(0.01 * self.rtol * self.work,) * 2]
        try:
            return solve_ivp(
                self._slope(velocity, budget=CALLS if method == "LSODA" else None), (t, end), [*self.z, self.x, self.done, self.turned],
                method=method, rtol=self.rtol, atol=atol, max_step=end / 50, events=self._guard(velocity) if self.probe.law.modes else None,
                dense_output=dense,
            )  # fmt: skip
        except _TooStiff:
            return self._run(t, end, velocity, dense, "Radau")

    def _slope(self, velocity: Velocity, budget: int | None) -> Any:
        calls = itertools.count()

        def slope(t: float, y: Array) -> list[float]:
            if next(calls) == budget:
                raise _TooStiff
            v, z = velocity(t), tuple(map(float, y[: self.probe.law.states]))
            force, rates = self.probe.response(self._held(v), z, self.mode)
            power = float(force) * v
            return [*rates, v, power, abs(power)]

        return slope

    def _guard(self, velocity: Velocity) -> Any:
        def guard(t: float, y: Array) -> float:
            z = tuple(map(float, y[: self.probe.law.states]))
            return min(float(g) for g, _, _ in self.probe.switches(velocity(t), z, self.mode))

        guard.terminal, guard.direction = True, -1  # type: ignore[attr-defined]
        return guard

    def _sampled(self, run: Any, velocity: Velocity, count: int) -> list[tuple[float, float, float, float]]:
        points, first, last = [], float(run.t[0]), float(run.t[-1])
        for k in range(count):
            t = first + (last - first) * k / (count - 1)
            y = [float(value) for value in run.sol(t)]
            points.append((t, y[-3], velocity(t), self.force(velocity(t), tuple(y[:-3]))))
        return points

    def _switch(self, v: float, before: list[float], fell: bool) -> None:
        """Update states and memories by the guards that have fallen to zero here, one after another."""
        now = [float(g) for g, _, _ in self.probe.switches(v, self.z, self.mode)]
        for k, value in enumerate(before):
            if value > 0 and (now[k] <= 1e-9 * value or (fell and now[k] == min(now))):
                _, self.mode, self.z = self.probe.switches(v, self.z, self.mode)[k]
