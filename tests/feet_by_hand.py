"""A rigid body in the plane on two feet, by hand: SciPy from event to event, every combination of contacts tried with numbers."""

import itertools

import numpy as np
from scipy.integrate import solve_ivp

NOTHING = 1e-14  # m, or m/s: what rounding makes


class TwoFeet:
    """A body of 1 kg with feet at (a, -h) in its own axes, Coulomb's friction and Newton's restitution, and forces (x, z, torque)."""

    def __init__(self, feet, inertia, mu, e, force=lambda t, q, u: (0.0, 0.0, 0.0)):
        self.feet, self.W, self.mu, self.e, self.force = feet, np.diag([1.0, 1.0, 1.0 / inertia]), mu, e, force

    def rows(self, q, u):
        """Gap, its row and bias, the slip's row and bias, of each foot."""
        c, s = np.cos(q[2]), np.sin(q[2])
        for a, d in self.feet:
            x, z = a * c - d * s, a * s + d * c
            yield q[1] + z, np.array([0.0, 1.0, x]), -z * u[2] ** 2, np.array([1.0, 0.0, -z]), -x * u[2] ** 2

    def solved(self, sides, rows, gains, free):
        """Impulses, or forces, of a combination (2: no contact), with what they do: rows say n and g, gains what is asked of them."""
        on = [i for i, side in enumerate(sides) if side != 2]
        E, right = np.zeros((2 * len(on), 2 * len(on))), np.zeros(2 * len(on))
        made = np.array([self.W @ rows[i][0] for i in on] + [-self.W @ rows[i][1] for i in on]).T.reshape(3, -1)
        for k, i in enumerate(on):
            E[k], right[k] = rows[i][0] @ made, -gains[i][0] - rows[i][0] @ free
            if sides[i] == 0:
                E[len(on) + k], right[len(on) + k] = rows[i][1] @ made, -gains[i][1] - rows[i][1] @ free
            else:
                E[len(on) + k, [k, len(on) + k]] = -sides[i] * self.mu, 1.0
        forces = np.linalg.lstsq(E, right, rcond=1e-10)[0]
        return on, forces.reshape(2, -1) if len(on) else np.zeros((2, 0)), free + made @ forces

    def decided(self, may, now, rows, gains, free):
        """The combination that agrees: `may` says what each foot may be."""
        for sides in sorted(itertools.product(*may), key=lambda each: sum(map(abs, each))):
            on, (N, R), after = self.solved(sides, rows, gains, free)
            rests = [k for k, i in enumerate(on) if sides[i] == 0]
            good = all(N > -1e-11) and abs(R[rests].sum()) <= self.mu * N[rests].sum() * (1 + 1e-9) + 1e-12
            for i, side in enumerate(sides):
                rise, slip = rows[i][0] @ after + gains[i][0], rows[i][1] @ after + gains[i][1]
                if side == 2:
                    good &= may[i] == (2,) or rise > -1e-11
                elif side == 0:
                    good &= now[i] == 0 and abs(slip) < 1e-9
                else:
                    good &= now[i] == side or (now[i] == 0 and side * slip > -1e-8)
            if good:
                return sides, after
        raise AssertionError(f"no combination agrees: {now}")

    def accelerated(self, t, y, may, now):
        q, u = y[:3], y[3:]
        parts = list(self.rows(q, u))
        free = self.W @ (np.array(self.force(t, q, u)) - [0.0, 9.81, 0.0])
        return self.decided(may, now, [(n, g) for _, n, _, g, _ in parts], [(b, d) for _, _, b, _, d in parts], free)

    def hit(self, y, touching, e):
        q, u = y[:3], y[3:]
        parts = [(n, g) for _, n, _, g, _ in self.rows(q, u)]
        gains = [(e * (n @ u) if n @ u < -1e-9 else 0.0, 0.0) for n, _ in parts]
        may = [(0, 1, -1, 2) if touch else (2,) for touch in touching]
        parts = [part if touch else (np.zeros(3), np.zeros(3)) for part, touch in zip(parts, touching, strict=True)]
        _, after = self.decided(may, [0, 0], parts, gains, u)
        return after

    def run(self, y, end, most=60):
        """Events (instant, what, foot) and the last state."""
        t, events, forced = 0.0, [], {}
        aloft = [gap > 1e-10 for gap, *_ in self.rows(y[:3], y[3:])]
        while t < end and len(events) < most:
            rates = [n @ y[3:] for _, n, *_ in self.rows(y[:3], y[3:])]
            slips = [g @ y[3:] for *_, g, _ in self.rows(y[:3], y[3:])]
            aloft = [a or rate > 1e-9 for a, rate in zip(aloft, rates, strict=True)]
            now = [0 if abs(w) < 1e-10 else int(np.sign(w)) for w in slips]
            now = [forced.get(i, side) for i, side in enumerate(now)]
            may = [(2,) if a else (0, 1, -1, 2) for a in aloft]
            sides, _ = self.accelerated(t, y, may, now)

            def rhs(t, y, sides=sides):
                parts = list(self.rows(y[:3], y[3:]))
                free = self.W @ (np.array(self.force(t, y[:3], y[3:])) - [0.0, 9.81, 0.0])
                return np.r_[y[3:], self.solved(sides, [(n, g) for _, n, _, g, _ in parts], [(b, d) for _, _, b, _, d in parts], free)[2]]

            def forces(t, y, sides=sides):
                parts = list(self.rows(y[:3], y[3:]))
                free = self.W @ (np.array(self.force(t, y[:3], y[3:])) - [0.0, 9.81, 0.0])
                return self.solved(sides, [(n, g) for _, n, _, g, _ in parts], [(b, d) for _, _, b, _, d in parts], free)

            guards, names = [], []
            for i, side in enumerate(sides):
                if side == 2:
                    guards.append(lambda t, y, i=i: list(self.rows(y[:3], y[3:]))[i][0] + NOTHING)  # what rises begins above zero
                    names.append(("landing", i))
                else:
                    guards.append(lambda t, y, i=i: forces(t, y)[1][0][forces(t, y)[0].index(i)])
                    names.append(("take-off", i))
                if side in (1, -1):
                    guards.append(lambda t, y, i=i, side=side: side * (list(self.rows(y[:3], y[3:]))[i][3] @ y[3:]) + NOTHING)
                    names.append(("slip", i))
                if side == 0:

                    def left(t, y, sides=sides, forces=forces):
                        on, (N, R), _ = forces(t, y)
                        own = [k for k, j in enumerate(on) if sides[j] == 0]
                        return self.mu * N[own].sum() - abs(R[own].sum())

                    guards.append(left)
                    names.append(("limit", i))
            for guard in guards:
                guard.terminal, guard.direction = True, -1
            done = solve_ivp(rhs, (t, end), y, "DOP853", rtol=1e-12, atol=1e-14, events=guards, max_step=0.01)
            t, y = done.t[-1], done.y[:, -1].copy()
            aloft, forced = [side == 2 for side in sides], {}
            for (what, i), times in zip(names, done.t_events, strict=True):
                if len(times):
                    if what == "landing":
                        for k, (gap, n, *_) in enumerate(self.rows(y[:3], y[3:])):
                            if k == i or (aloft[k] and abs(gap) < 1e-11 and n @ y[3:] < 0.0):
                                events.append((t, what, k))
                                aloft[k] = False
                        y[3:] = self.hit(y, [not a for a in aloft], self.e)
                        y[1] += 2 * NOTHING
                    elif what == "take-off":
                        events.append((t, what, i))
                        aloft[i] = True
                    elif what == "limit":
                        on, (_, R), _ = forces(t, y)
                        own = [k for k, j in enumerate(on) if sides[j] == 0]
                        forced = {on[k]: int(np.sign(R[own].sum())) for k in own}
                    elif what == "slip":
                        events.append((t, what, i))
        return events, y
