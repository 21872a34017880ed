"""Slow, obvious twins of the fast code, kept for ever: each is written for reading, in another way than what it judges."""

from __future__ import annotations

from dataclasses import dataclass, field

import mpmath as mp


@dataclass
class StickSlip:
    """w' = sin(tau) - r with dry friction, in 40 digits and in absolute time: the mode machine as one would tell it.

    `arcs` holds (tau, x, w, mode) of every arc, `strobes` (x, w) after each drive period.
    """

    r_plus: float
    r_minus: float
    s_plus: float
    s_minus: float
    w: float = 0.0
    arcs: list = field(default_factory=list)
    strobes: list = field(default_factory=list)

    def run(self, periods):
        with mp.workdps(40):
            tau, x, w, end = mp.mpf(0), mp.mpf(0), mp.mpf(self.w), 2 * mp.pi * periods
            while tau < end:
                mode = self._mode(tau, w)
                self.arcs.append((tau, x, w, mode))
                stop = self._break_away(tau) if mode == 0 else self._standstill(tau, w, mode, end)
                for k in range(len(self.strobes) + 1, periods + 1):
                    if 2 * mp.pi * k > stop:
                        break
                    self.strobes.append((x + self._moved(tau, w, mode, 2 * mp.pi * k), self._speed(tau, w, mode, 2 * mp.pi * k)))
                tau, x, w = stop, x + self._moved(tau, w, mode, min(stop, end)), mp.mpf(0)
        return self

    def _mode(self, tau, w):
        if w != 0:
            return 1 if w > 0 else -1
        soon = mp.sin(tau + mp.mpf(10) ** -30)  # at the very instant of break-away it is about to go
        return 1 if soon > self.s_plus else -1 if soon < -self.s_minus else 0

    def _r(self, mode):
        return mp.mpf(self.r_plus) if mode > 0 else -mp.mpf(self.r_minus)

    def _speed(self, tau, w, mode, t):
        return w + mp.cos(tau) - mp.cos(t) - self._r(mode) * (t - tau) if mode else mp.mpf(0)

    def _moved(self, tau, w, mode, t):
        d = t - tau
        return (w + mp.cos(tau)) * d - mp.sin(t) + mp.sin(tau) - self._r(mode) * d**2 / 2 if mode else mp.mpf(0)

    @staticmethod
    def _next(level, tau, rising):
        """The next time after tau at which sin goes through the level, upwards or downwards."""
        angle = mp.asin(level) if rising else mp.pi - mp.asin(level)
        ahead = angle + 2 * mp.pi * mp.ceil((tau - angle) / (2 * mp.pi))
        return ahead if ahead > tau else ahead + 2 * mp.pi

    def _break_away(self, tau):
        forward = self._next(mp.mpf(self.s_plus), tau, True) if abs(self.s_plus) < 1 else mp.inf
        backward = self._next(-mp.mpf(self.s_minus), tau, False) if abs(self.s_minus) < 1 else mp.inf
        return min(forward, backward)

    def _standstill(self, tau, w, mode, end):
        """The first zero of the speed: it is sought between turning points of the speed, by halving."""
        low, r = tau, self._r(mode)
        while low < end:
            turns = [self._next(r, low, rising) for rising in (True, False)] if abs(r) < 1 else [low + mp.pi]
            high = min(turns)
            if mode * self._speed(tau, w, mode, high) <= 0:
                for _ in range(130):
                    middle = (low + high) / 2
                    low, high = (middle, high) if mode * self._speed(tau, w, mode, middle) > 0 else (low, middle)
                return high
            low = high
        return mp.inf
