"""A contact that is moved as one likes: what its friction costs."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any

from stickslip.testing.probe import Probe

__all__ = ["burst", "moved", "shaken"]

#: A stretch of a motion: how long it takes [s], and the velocity at a time since its beginning [m/s].
Piece = tuple[float, Callable[[float], float]]


def shaken(probe: Probe, stroke: float, speed: float, cycles: int = 2) -> dict[str, float]:
    """Move a fresh contact to and fro over a stroke with velocity ``speed sin(omega t)``; what it cost, as `moved` tells it."""
    half = math.pi * stroke / (2.0 * abs(speed))
    to, fro = ((half, _sine(way, half)) for way in (speed, -speed))
    return moved(probe, [to, fro] * cycles, last=2)


def burst(probe: Probe, stroke: float, slow: float, fast: float) -> dict[str, float]:
    """Push a fresh contact slowly over a stroke, and then suddenly fast."""
    return moved(probe, [(stroke / abs(v), _steady(v)) for v in (slow, fast)], last=1)


def _steady(speed: float) -> Callable[[float], float]:
    return lambda t: speed


def _sine(speed: float, half: float) -> Callable[[float], float]:
    return lambda t: speed * math.sin(math.pi * t / half)


def moved(probe: Probe, pieces: list[Piece], last: int) -> dict[str, float]:
    """Move a fresh contact piece by piece, and account for the work done on it.

    Returns
    -------
    dict
        ``least``: the least work done on it so far [J], below zero where it gave back more than it had got; ``turned``: all work,
        taken positive [J]; ``loss`` and ``loss_turned``: the work of the last pieces alone; ``force``: at the end [N].
    """
    state = _Contact(probe, probe.load * sum(length for length, _ in pieces) * max(abs(v(0.5 * length)) for length, v in pieces))
    marks = [(0.0, 0.0)]
    for length, velocity in pieces:
        state.follow(length, velocity)
        marks.append((state.done, state.turned))
    loss, turned = (marks[-1][i] - marks[-1 - last][i] for i in (0, 1))
    length, velocity = pieces[-1]
    end = float(probe.force(velocity(0.5 * length), state.z, state.mode))
    return {"least": state.least, "turned": state.turned, "loss": loss, "loss_turned": turned, "force": end}


#: Evaluations after which a stretch between two switches is given to an integrator for stiff equations.
CALLS = 20_000


class _TooStiff(Exception):
    """The integrator takes too many steps."""


class _Contact:
    """Where a contact is: its states and memories, and the work done on it so far."""

    def __init__(self, probe: Probe, work: float):
        self.probe, self.work = probe, max(work, 1e-300)
        self.z, self.mode = probe.start
        self.done = self.turned = self.least = 0.0

    def follow(self, length: float, velocity: Callable[[float], float]) -> None:
        """Go through one piece of a motion, from switch to switch."""
        t = 0.0
        while t < length:
            try:
                run = self._integrated(t, length, velocity, "LSODA")
            except _TooStiff:
                run = self._integrated(t, length, velocity, "Radau")
            before = [g for g, _, _ in self.probe.switches(velocity(0.5 * (t + run.t[-1])), self.z, self.mode)]
            t, y = float(run.t[-1]), [float(value) for value in run.y[:, -1]]
            self.z, self.done, self.turned = tuple(y[:-2]), y[-2], y[-1]
            self.least = min(self.least, float(run.y[-2].min()))
            v = velocity(t)
            stopped = t >= length and abs(v) < 1e-9 * abs(velocity(0.5 * length))
            self._switch(0.0 if stopped else v, before, t < length)

    def _integrated(self, t: float, end: float, velocity: Callable[[float], float], method: str) -> Any:
        """States and work up to the next switch. LSODA may miss that it is too stiff, where rates are next to nothing."""
        from scipy.integrate import solve_ivp

        atol = [*(1e-10 * size for size in self.probe.scale), 1e-10 * self.work, 1e-10 * self.work]
        return solve_ivp(
            self._slope(velocity, budget=CALLS if method == "LSODA" else None), (t, end), [*self.z, self.done, self.turned],
            method=method, rtol=1e-8, atol=atol, max_step=end / 50, events=self._guard(velocity) if self.probe.modes else None,
        )  # fmt: skip

    def _slope(self, velocity: Callable[[float], float], budget: int | None) -> Any:
        calls = itertools.count()

        def slope(t: float, y: Any) -> list[float]:
            if next(calls) == budget:
                raise _TooStiff
            v, z = velocity(t), tuple(map(float, y[: self.probe.states]))
            power = self.probe.force(v, z, self.mode) * v
            return [*self.probe.rate(v, z, self.mode), power, abs(power)]

        return slope

    def _guard(self, velocity: Callable[[float], float]) -> Any:
        def guard(t: float, y: Any) -> float:
            z = tuple(map(float, y[: self.probe.states]))
            return min(float(g) for g, _, _ in self.probe.switches(velocity(t), z, self.mode))

        guard.terminal, guard.direction = True, -1  # type: ignore[attr-defined]
        return guard

    def _switch(self, v: float, before: list[float], fell: bool) -> None:
        """States and memories after the guards that have fallen to zero here, one after another."""
        now = [float(g) for g, _, _ in self.probe.switches(v, self.z, self.mode)]
        for k, value in enumerate(before):
            if value > 0 and (now[k] <= 1e-9 * value or (fell and now[k] == min(now))):
                _, self.mode, self.z = self.probe.switches(v, self.z, self.mode)[k]
