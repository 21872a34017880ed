"""A slow twin of Taylor steps: series of NumPy numbers through the law as it is written, with short steps; for robots from rest.

Nothing is traced: a comparison takes the side of its first coefficient that is not zero, and is remembered, so that the step ends where
it would turn out otherwise. What is narrower than a fortieth of a period it does not see.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from stickslip.models.normal_loads import normal_load

ORDER, LONGEST, ROUNDING = 20, 1 / 40, 1e-17


class Series:
    """A polynomial in the time since the start of a step."""

    __array_ufunc__ = None

    def __init__(self, c, asked):
        self.c, self.asked = np.asarray(c, float), asked

    def _other(self, other):
        return other.c if isinstance(other, Series) else np.eye(1, len(self.c))[0] * other

    def _new(self, c):
        return Series(c, self.asked)

    def __add__(self, other):
        return self._new(self.c + self._other(other))

    def __mul__(self, other):
        return self._new(np.convolve(self.c, self._other(other))[: len(self.c)]) if isinstance(other, Series) else self._new(self.c * other)

    def __neg__(self):
        return self._new(-self.c)

    def __sub__(self, other):
        return self + -1.0 * other if isinstance(other, Series) else self + -other

    def __rsub__(self, other):
        return -self + other

    __radd__, __rmul__ = __add__, __mul__

    def __truediv__(self, other):
        return self * (1.0 / other)

    def __rtruediv__(self, number):
        c = np.zeros(len(self.c))
        c[0] = number / self.c[0]
        for m in range(1, len(c)):
            c[m] = -(self.c[1 : m + 1] @ c[m - 1 :: -1][:m]) / self.c[0]
        return self._new(c)

    def __pow__(self, power):
        result = self._new(np.eye(1, len(self.c))[0])
        for _ in range(int(power)):
            result = result * self
        return result

    def side(self):
        leading = self.c[np.flatnonzero(self.c)]
        return 1.0 if not len(leading) or leading[0] > 0 else -1.0

    def __gt__(self, other):
        difference = self - other
        self.asked.append(difference.side() * difference)
        return difference.side() > 0

    def __lt__(self, other):
        return not self > other

    __ge__, __le__ = __gt__, __lt__

    def __abs__(self):
        return self if self > 0.0 else -self

    def __ss_exp__(self):
        c = np.zeros(len(self.c))
        c[0] = math.exp(self.c[0])
        for m in range(1, len(c)):
            c[m] = (np.arange(1, m + 1) * self.c[1 : m + 1]) @ c[m - 1 :: -1][:m] / m
        return self._new(c)

    def __ss_log__(self):
        c = np.zeros(len(self.c))
        c[0] = math.log(self.c[0])
        for m in range(1, len(c)):
            c[m] = (self.c[m] - (np.arange(1, m) * c[1:m]) @ self.c[m - 1 : 0 : -1] / m) / self.c[0]
        return self._new(c)

    def __ss_tanh__(self):
        e = (-2.0 * self).__ss_exp__()
        return (1.0 - e) * (1.0 / (1.0 + e))

    def _turning(self):
        s, c = np.zeros(len(self.c)), np.zeros(len(self.c))
        s[0], c[0] = math.sin(self.c[0]), math.cos(self.c[0])
        for m in range(1, len(c)):
            slope = np.arange(1, m + 1) * self.c[1 : m + 1]
            s[m], c[m] = slope @ c[m - 1 :: -1][:m] / m, -(slope @ s[m - 1 :: -1][:m]) / m
        return s, c

    def __ss_sin__(self):
        return self._new(self._turning()[0])

    def __ss_cos__(self):
        return self._new(self._turning()[1])

    def __ss_within__(self, period):
        return self


def _first_zero(c, end):
    """Where a polynomial that begins positive first is below zero, before `end`; infinite if nowhere."""
    looks = np.linspace(0.0, end, 65)[1:]
    values = np.polynomial.polynomial.polyval(looks, c)
    below = np.flatnonzero(values < -1e-15 * np.abs(c) @ end ** np.arange(len(c)))
    if not len(below):
        return math.inf
    high = looks[below[0]]
    low = high - looks[0]
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.polynomial.polynomial.polyval(middle, c) > 0 else (low, middle)
    return high


@np.errstate(all="ignore")  # laws compute branches that they then do not take
def run(robot, periods):
    """x after so many periods, from rest at t = 0."""
    T, scale, x, v, mode = float(robot.period), float(robot.velocity_scale), 0.0, 0.0, None
    jumps = {}
    for instant, jump in getattr(robot, "impulses", ()) or ():
        jumps[float(instant) % T] = jumps.get(float(instant) % T, 0.0) + float(jump)
    for k in range(periods):
        instants = [0.0, *sorted(s for s in jumps if s > 0.0), T]
        for begin, end in itertools.pairwise(instants):
            if begin in jumps and (begin > 0 or k > 0):
                v, mode = v + jumps[begin], None
            t = begin
            while t < end:
                mode = _rest(robot, t, v) if mode is None else mode
                t, dx, v, mode = _step(robot, t, v, mode, end, 1e-17 * scale, T)
                x += dx
    return x


def _limits(robot, t):
    backward, forward = robot.friction.breakaway(normal_load(robot, t, 0.0))
    return robot.acceleration(t, 0.0, 0.0, forward), -robot.acceleration(t, 0.0, 0.0, backward)


def _rest(robot, t, v):
    """The mode in which a body goes on: by its velocity, or by what pushes it at rest, now or a moment later."""
    if v != 0.0:
        return math.copysign(1, v)
    asked = []
    push, pull = (_series(limit, asked) for limit in _limits(robot, Series([t, 1.0, 0.0], asked)))
    return 1 if push.side() > 0 and push.c.any() else -1 if pull.side() > 0 and pull.c.any() else 0


def _series(value, asked, length=ORDER + 1):
    return value if isinstance(value, Series) else Series(np.eye(1, length)[0] * value, asked)


def _step(robot, t, v, mode, end, tolerated, T):
    asked, time = [], np.zeros(ORDER + 1)
    time[:2] = t, 1.0
    c = [v]
    if mode:
        for m in range(ORDER):
            asked.clear()
            speed = Series([*c, mode * 1e-200] if m == 0 else c, asked)
            now = Series(time[: len(speed.c)], asked)
            R = robot.friction.sliding(speed, normal_load(robot, now, 0.0))
            c.append(_series(robot.acceleration(now, 0.0, speed, R), asked, len(speed.c)).c[m] / (m + 1))
        c = np.array(c)
        ends = [(mode * c, None), *((np.pad(a.c, (0, ORDER + 1 - len(a.c))), mode) for a in asked if a.c[1:].any())]
    else:
        c = np.zeros(ORDER + 1)
        push, pull = (_series(limit, asked).c for limit in _limits(robot, Series(time, asked)))
        ends = [(-push, 1), (-pull, -1), *((a.c, mode) for a in asked if a.c[1:].any())]
    h = min(end - t, LONGEST * T)
    for k in (ORDER - 1, ORDER):
        for series, allowed in ((c, tolerated), *((s, 1e-17 * np.abs(s[:4]) @ h ** np.arange(4)) for s, _ in ends[1:])):
            h = min(h, (allowed / abs(series[k])) ** (1 / k)) if series[k] else h
    found = [(_first_zero(series, h), then) for series, then in ends]
    stop, then = min(found, key=lambda one: one[0])
    last = stop == math.inf
    h = h if last else stop
    at = np.polynomial.polynomial.polyval
    v_end = 0.0 if not last and then is None else float(at(h, c))
    moved = float(at(h, np.concatenate([[0.0], c / np.arange(1, ORDER + 2)])))
    t_end = end if last and h >= end - t else t + h
    return t_end, moved, v_end, mode if last else (_rest(robot, t_end, 0.0) if then is None else then)
