"""Relative motion from given accelerations, piece by piece."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import reduce
from itertools import accumulate
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import describe, everywhere
from stickslip.basics.maths import maximum, minimum, sqrt, where, within
from stickslip.basics.quantities import quantity
from stickslip.models.drives.drive import PeriodicDrive, given_numbers

_EXAMPLE = "type for example Pieces(durations=(0.02, 0.01, 0.01), accelerations=(10.0, -30.0, 10.0))"
_CLOSED = 1e-9  # of all changes of the velocity: what may be left of their sum


@dataclass(frozen=True, eq=False)
class Pieces(PeriodicDrive):
    r"""Piecewise constant acceleration of the inner mass, which approximates any motion of bounded acceleration.

    .. math:: \ddot\xi = a_k \quad\text{for so long as}\quad d_k, \qquad \sum_k a_k d_k = 0

    The relative velocity at t = 0 is the one for which the motion closes; it starts at :math:`\xi = 0`.

    Parameters
    ----------
    durations : tuple of float
        Durations of the pieces, in order from t = 0 [s].
    accelerations : tuple of float
        The relative accelerations [m/s^2]. Weighted with the durations they sum to zero.

    Examples
    --------
    The inner mass waits for half of the time, is thrown back and caught:

    >>> drive = Pieces(durations=(0.05, 0.01, 0.04), accelerations=(10.0, -66.0, 4.0))
    >>> round(drive.period, 12), [round(b, 12) for b in drive.breaks], round(drive.velocity(0.0), 9)
    (0.1, [0.05, 0.06], -0.11)
    >>> abs(drive.position(0.0999999999)) < 1e-9
    True
    """

    durations: tuple[float, ...] = field(metadata=quantity("duration of a piece", "s", "d", example=(0.02, 0.01, 0.01)))
    accelerations: tuple[float, ...] = field(metadata=quantity("acceleration on a piece", "m/s^2", "a", example=(10.0, -30.0, 10.0)))

    def _check(self, problems: Problems) -> None:
        durations, accelerations = self.durations, self.accelerations
        if not isinstance(durations, tuple) or not isinstance(accelerations, tuple):
            return  # told already
        if len(durations) < 2 or len(durations) != len(accelerations):
            counts = f"{len(durations)} durations and {len(accelerations)} accelerations"
            problems.add(f"{counts}; allowed is one of each for two pieces or more; {_EXAMPLE}")
            return
        for i, d in enumerate(durations):
            if not everywhere(d > 0):
                problems.add(f"durations[{i}] = {describe(d)}; allowed is a positive time [s]; {_EXAMPLE}")
        if problems.mistakes:
            return
        change = sum(a * d for a, d in zip(accelerations, durations, strict=True))
        size = sum(abs(a) * d for a, d in zip(accelerations, durations, strict=True))
        if not everywhere(abs(change) <= _CLOSED * size):
            rest = sum(a * d for a, d in zip(accelerations[:-1], durations[:-1], strict=True))
            mistake = (
                f"the velocity changes by {describe(change)} m/s in a period; allowed are durations times accelerations that add up to zero"
            )
            problems.add(f"{mistake}; type accelerations[{len(durations) - 1}] = {describe(-rest / durations[-1])}")

    @property
    def _ends(self) -> tuple[Any, ...]:
        """When each piece ends [s]."""
        return tuple(accumulate(self.durations))

    @property
    def _begins(self) -> list[tuple[Any, Any, Any]]:
        """Instant, position and velocity at which each piece begins."""
        t, x, v, begins = 0.0, 0.0, self._first, []
        for d, a in zip(self.durations, self.accelerations, strict=True):
            begins.append((t, x, v))
            t, x, v = t + d, x + d * (v + 0.5 * a * d), v + a * d
        return begins

    @property
    def _first(self) -> Any:
        """The velocity at t = 0 with which the motion closes [m/s]."""
        x, v = 0.0, 0.0
        for d, a in zip(self.durations, self.accelerations, strict=True):
            x, v = x + d * (v + 0.5 * a * d), v + a * d
        return -x / self.period

    @property
    def period(self) -> float:
        """Sum of the durations [s]."""
        return self._ends[-1]

    @property
    def breaks(self) -> tuple[Any, ...]:
        """Boundaries of the pieces [s]."""
        return self._ends[:-1]

    @property
    def velocity_scale(self) -> float:
        """The largest relative speed, which is where a piece begins [m/s]."""
        return reduce(maximum, (abs(v) for _, _, v in self._begins), 0.0)

    @property
    def stroke(self) -> float:
        """From end to end [m]."""
        lowest: Any = 0.0
        highest: Any = 0.0
        for (_, x, v), d, a in zip(self._begins, self.durations, self.accelerations, strict=True):
            turned = where((a * v < 0.0) & (abs(v) < abs(a) * d), x - 0.5 * v * v / where(a == 0.0, 1.0, a), x)  # there v = 0
            lowest, highest = minimum(lowest, minimum(x, turned)), maximum(highest, maximum(x, turned))
        return highest - lowest

    def _chosen(self, t: Numeric, on: Any) -> Any:
        """The value of `on(piece, time since it began)` for the piece at a time."""
        s, ends = within(t, self.period), self._ends
        last = len(ends) - 1
        value = on(last, s)
        for k in reversed(range(last)):
            value = where(s < ends[k], on(k, s), value)
        return value

    def position(self, t: Numeric) -> Any:
        """Relative position [m]."""
        begins = self._begins

        def on(k: int, s: Numeric) -> Any:
            start, x, v = begins[k]
            r = s - start
            return x + r * (v + 0.5 * self.accelerations[k] * r)

        return self._chosen(t, on)

    def velocity(self, t: Numeric) -> Any:
        """Relative velocity [m/s]."""
        begins = self._begins
        return self._chosen(t, lambda k, s: begins[k][2] + self.accelerations[k] * (s - begins[k][0]))

    def acceleration(self, t: Numeric) -> Any:
        """Relative acceleration [m/s^2]; at a break it is that of the piece that begins."""
        return self._chosen(t, lambda k, s: self.accelerations[k] + 0.0 * s)

    @classmethod
    def verge(cls, acceleration: Any, stroke: Numeric, mass_ratio: Any, mu_plus: Any, mu_minus: Any, gravity: float = 9.81) -> Pieces:
        r"""The fastest known drive of a robot with Coulomb friction, within bounds of relative acceleration and stroke.

        The body waits on the verge of slipping back while the inner mass gathers speed, is thrown forwards by the whole acceleration, and
        comes to rest as the next period begins. It was found by a search over drives in pieces and is not proved to be the best.

        Parameters
        ----------
        acceleration : float
            Largest relative acceleration W [m/s^2]; at least the (mu_plus + mu_minus) g that moves the body forwards without pause.
        stroke : float
            From end to end [m].
        mass_ratio : float
            m / (M + m).
        mu_plus, mu_minus : float
            Coefficients of friction forwards and backwards.
        gravity : float
            [m/s^2].

        Returns
        -------
        Pieces
            With three pieces.

        Examples
        --------
        >>> drive = Pieces.verge(acceleration=60.0, stroke=0.01, mass_ratio=0.1315, mu_plus=0.15, mu_minus=0.25)
        >>> round(drive.period, 11), round(drive.stroke, 12)
        (0.05915466243, 0.01)
        """
        problems = Problems("Pieces.verge")
        given = {"acceleration": acceleration, "stroke": stroke, "mass_ratio": mass_ratio, "mu_plus": mu_plus, "mu_minus": mu_minus}
        given_numbers(problems, "Pieces.verge(60.0, 0.01, 0.13, 0.15, 0.25)", **given, gravity=gravity)
        problems.check()
        W, mu, up, down = acceleration, mass_ratio, mu_plus * gravity, mu_minus * gravity
        if not everywhere(mu * W > maximum(up, down)):
            least = describe(maximum(up, down) / mu)
            allowed = f"allowed is more than {least} m/s^2"
            problems.add(f"acceleration = {describe(W)} moves nothing: mass_ratio times it is below friction; {allowed}")
            problems.check()
        p = down / (up + down)
        w, wait = down / mu, 1 - p
        push, brake = p * (mu * W + up) / (2 * mu * W), p * (mu * W - up) / (2 * mu * W)
        fall, rise = W * push, w * wait
        V = fall * push / 2 + (fall + rise) * brake / 2 + rise * wait / 2
        late = (V - rise) ** 2 / (2 * W) + (2 * V - rise) * wait / 2 + V**2 / (2 * W)
        early = V**2 * (1 / w + 1 / W) / 2
        T = sqrt(stroke / where(rise <= V, late, early))
        return cls((wait * T, push * T, brake * T), (w, -W, W))

    @classmethod
    def example(cls) -> Pieces:
        """The fastest one known for the paper's robot, within 60 m/s^2 and 10 mm."""
        return cls.verge(acceleration=60.0, stroke=0.01, mass_ratio=0.1315, mu_plus=0.15, mu_minus=0.25)
