"""A model's equations in plain floats, on one side of the contact's velocity; the state is x, v, z."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from stickslip.forces import rest_velocity
from stickslip.friction.adapter import TINY, Switches, law_of
from stickslip.machine import machine_of
from stickslip.mechanics import normal_load
from stickslip.position import knows_position

__all__ = ["LOAD", "SLIP", "Equations"]

SLIP, LOAD = 0, 1  # the first two guards; the others are the law's own
_HELD = 1e-14  # of the velocity scale: what rounding makes of a velocity that a law without a state holds
_ASIDE = 1e-13  # of a period: how far from a break the drive is asked, so that it answers from the right side of it

Memory = tuple[int, ...]


class Equations:
    """What a solver asks of a model, within one interval between known instants."""

    def __init__(self, model: Any):
        self.model, self.law = model, (law := law_of(model))
        self.dynamic, self.inner = law.dynamic, law.states
        self.cyclic = not knows_position(model)
        self.rest = float(rest_velocity(model))
        self.scale_of_time = time_scale(model)
        self.no_reversal = _HELD * float(model.velocity_scale) if law.holds_velocity else 0.0
        self.first, self.last, self.first_load = -math.inf, math.inf, 0.0

    def between(self, first: float, last: float) -> None:
        """Ask the drive between two of its breaks only."""
        aside = _ASIDE * self.scale_of_time + 2 * math.ulp(last)
        self.first, self.last = first + aside, last - aside

    def _time(self, t: Any) -> Any:
        return min(max(t, self.first), self.last) if isinstance(t, float) else t.clip(self.first, self.last)

    def load(self, t: Any, x: Any) -> Any:
        """Normal force [N]."""
        return normal_load(self.model, self._time(t), x)

    def _pressing(self, t: float, x: float) -> float:
        """Normal force, positive also a moment after the contact is lost: a step looks beyond its end."""
        return max(normal_load(self.model, t, x), 1e-12 * self.first_load, TINY)

    def slip(self, y: Any, side: int) -> float:
        """Velocity at the contact, held on its side [m/s]."""
        u = self.model.contact_velocity(float(y[1]))
        return u if side * u > TINY else side * TINY

    @staticmethod
    def state(y: Any) -> tuple[float, ...]:
        """The inner states."""
        return tuple(map(float, y[2:]))

    def right(self, side: int, memory: Memory) -> Callable[[float, Any], list[float]]:
        """The right side of y' on this side of the contact's velocity."""
        model, law = self.model, self.law

        def dynamic(t: float, y: Any) -> list[float]:
            t, x, v = self._time(t), float(y[0]), float(y[1])
            slip, z, load = self.slip(y, side), self.state(y), self._pressing(t, x)
            force, rate = law.response(slip, z, load, memory, model.total_mass * model.acceleration(t, x, v, 0.0))
            return [v, model.acceleration(t, x, v, force), *rate]

        def set_valued(t: float, y: Any) -> list[float]:
            t, x, v = self._time(t), float(y[0]), float(y[1])
            return [v, model.acceleration(t, x, v, law.sliding(self.slip(y, side), self._pressing(t, x)))]

        plain = dynamic if self.dynamic else set_valued

        def finite(t: float, y: Any) -> list[float]:
            try:
                return plain(t, y)
            except ArithmeticError:  # a trial step far too long: the integrator takes a shorter one
                return [math.nan] * len(y)

        return finite

    def guards(self, t: float, y: Any, side: int, memory: Memory) -> list[float]:
        """Positive while nothing happens: the velocity at the contact, the load, and the law's switches."""
        found = [side * self.model.contact_velocity(float(y[1])) + self.no_reversal, float(self.load(t, float(y[0])))]
        return found + [float(guard) for guard, _, _ in self.switches(t, y, self.slip(y, side), memory)]

    def switches(self, t: float, y: Any, slip: float, memory: Memory) -> Switches:
        """The law's switches: (guard, new memory, new inner states or None)."""
        return self.law.switches(slip, self.state(y), self._pressing(self._time(t), float(y[0])), memory) if self.law.switching else []

    def passed_zero(self, t: float, y: Any, side: int, memory: Memory) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        """Inner states and memory after the switches that wait for the velocity at the contact to pass zero."""
        return self.law.passed_zero(self.state(y), self._pressing(self._time(t), float(y[0])), memory, side)

    def excess(self, t: Any, x: Any) -> tuple[Any, Any]:
        """How far the offered force is above the forward limit, and below the backward one [N]; negative while they hold."""
        t = self._time(t)
        offered = self.model.total_mass * self.model.acceleration(t, x, self.rest, 0.0)
        backward, forward = self.law.breakaway(normal_load(self.model, t, x))
        return offered - forward, backward - offered

    def side(self, t: float, y: Any, before: int, memory: Memory) -> int:
        """The mode that a state begins: a moving contact keeps its side, one at rest asks the forces."""
        u = self.model.contact_velocity(float(y[1]))
        if u != 0.0:
            return 1 if u > 0 else -1
        if not self.dynamic:
            up, down = self.excess(t, float(y[0]))
            return 1 if up > 0 else -1 if down > 0 else 0
        if not before:  # a start at rest: what moves it a moment later
            return 1 if self.right(1, memory)(t + 1e-9 * self.scale_of_time, y)[1] >= 0 else -1
        return -before if self.right(before, memory)(t, y)[1] * before <= 0 else before


def time_scale(model: Any) -> float:
    """A time in which something happens [s]: the period, or what the mechanism says."""
    return float(machine_of(model).time_scale or 1.0)
