"""A row of blocks on springs by SciPy alone: forces as NumPy arrays, one mode for each block, and a restart at each event."""

import numpy as np
from scipy.integrate import solve_ivp


class PlainRow:
    """Blocks of some masses, pulled by springs over a plane that moves, with springs between neighbours.

    Friction is `kinetic` + (`static` - `kinetic`) exp(-(w / v_s)^2) against the slip w, and `static` at most at rest.
    """

    def __init__(self, masses, between, puller, speed, kinetic, static, v_s):
        self.m, self.between, self.puller, self.speed = np.asarray(masses), between, puller, speed
        self.kinetic, self.static, self.v_s = kinetic, static, v_s

    def springs(self, x):
        """Forces of all springs."""
        pull = np.diff(x) * self.between
        force = -self.puller * x
        force[:-1] += pull
        force[1:] -= pull
        return force

    def friction(self, w, mode):
        """Friction against slip of a given side."""
        return mode * (self.kinetic + (self.static - self.kinetic) * np.exp(-((w / self.v_s) ** 2)))

    def rates(self, t, y, mode):
        """Velocities and accelerations; what rests moves with the plane."""
        x, v = np.split(y, 2)
        v = np.where(mode == 0, -self.speed, v)
        a = np.where(mode == 0, 0.0, (self.springs(x) - self.friction(v + self.speed, mode)) / self.m)
        return np.concatenate([v, a])

    def margins(self, y, mode):
        """How far each block is from a change of its mode."""
        x, v = np.split(y, 2)
        return np.where(mode == 0, self.static - abs(self.springs(x)), mode * (v + self.speed))

    def events(self, x, v, end, rtol=1e-11):
        """Times, blocks and new modes until the end, and the last state. A block that begins to slip does so for `_YOUNG` at least."""
        t, y, events = 0.0, np.concatenate([x, v]), []
        mode, born = np.sign(v + self.speed).astype(int), np.full(len(self.m), -np.inf)
        while t < end:

            def first(s, z, mode=mode, born=born):
                return np.where(s < born + _YOUNG, np.inf, self.margins(z, mode)).min()

            first.terminal, first.direction = True, -1
            done = solve_ivp(lambda s, z, mode=mode: self.rates(s, z, mode), (t, end), y, "DOP853", events=first, rtol=rtol, atol=1e-13)
            t, y = float(done.t[-1]), done.y[:, -1]
            if done.status != 1:
                break
            i = int(np.argmin(np.where(t < born + _YOUNG, np.inf, self.margins(y, mode))))
            needed = self.springs(y[: len(self.m)])[i]
            new = 0 if mode[i] and abs(needed) <= self.static else int(np.sign(needed))
            y[len(self.m) + i] = -self.speed
            mode, born = mode.copy(), born.copy()
            mode[i], born[i] = new, t if new else -np.inf
            events.append((t, i, new))
        return np.array(events), y


_YOUNG = 1e-4  # [s]
