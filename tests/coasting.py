"""A slow, obvious twin: a Coulomb robot with any drive, arc by arc, from the drive's own position and velocity.

While the body slides, v + mu xi' falls by a constant rate, so each arc is known from xi and xi' and only its end is searched.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq


@dataclass
class Coasting:
    """A body on a level track: mass ratio, decelerations of sliding forwards and backwards, and its drive."""

    drive: object
    mass_ratio: float
    plus: float
    minus: float
    x: float = 0.0
    v: float = 0.0

    def mean_velocity(self, periods=6):
        """Mean velocity over the last of some periods, from rest at 0+."""
        jumps = {float(t): jump for t, jump in self.drive.jumps}
        nodes = sorted({0.0, float(self.drive.period), *map(float, self.drive.breaks), *jumps})
        for _ in range(periods):
            start = self.x
            for t, end in pairwise(nodes):
                jump = jumps.get(end if end < nodes[-1] else 0.0, 0.0)
                self._stretch(t, end, self.drive.velocity(end if end < nodes[-1] else 0.0) - jump)
                self.v -= self.mass_ratio * jump
        return (self.x - start) / self.drive.period

    def _stretch(self, t, end, last):
        """From one node to the next, where the drive is smooth; `last` is xi' just before the end."""
        turns = 0
        while t < end and turns < 50:
            turns += 1
            side = np.sign(self.v) or self._leaves(0.5 * (t + min(end, t + 1e-9 * (end - t))))
            t = self._slide(side, t, end, last) if side else self._rest(t, end)
        assert turns < 50, "a body that turns this often in one stretch is not understood"

    def _leaves(self, t):
        push = -self.mass_ratio * self.drive.acceleration(t)
        return 1 if push > self.plus * (1 + 1e-12) else -1 if push < -self.minus * (1 + 1e-12) else 0

    def _rest(self, t, end):
        instants = np.linspace(t, end, 2000)[1:-1]
        ahead = next((i for i in instants if self._leaves(i)), None)
        if ahead is None:
            return end
        limit = self.plus if self._leaves(ahead) > 0 else -self.minus
        return brentq(lambda s: -self.mass_ratio * self.drive.acceleration(s) - limit, t, ahead, xtol=1e-15)

    def _slide(self, side, t, end, last):
        drive, mu, rate = self.drive, self.mass_ratio, side * (self.plus if side > 0 else self.minus)
        began, v0, x0 = drive.velocity(t), self.v, self.x

        def speed(s):
            return v0 - mu * ((last if s >= end else drive.velocity(s)) - began) - rate * (s - t)

        instants = np.linspace(t, end, 2000)[1:]
        first = next((i for i in instants if side * speed(i) < 0), None)
        stop = end if first is None else brentq(speed, max(t, first - (end - t) / 1998), first, xtol=1e-16, rtol=1e-15)
        ends = drive.position(stop if stop < drive.period else 0.0)
        self.x = x0 + (v0 + mu * began) * (stop - t) - mu * (ends - drive.position(t)) - 0.5 * rate * (stop - t) ** 2
        self.v = speed(end) if first is None else 0.0
        return stop
