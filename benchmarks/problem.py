"""The problem every solver here gets: the paper's robot with LuGre friction at many drive amplitudes.

    v' = A mu omega^2 sin(omega t) - R / (M + m)          R = sigma0 z + sigma1 z' + sigma2 v
    z' = v - sigma0 |v| z / (W g(v))                      g = mu_s + (f_s - mu_s) exp(-(v / v_s)^2),  s = sign v

from v = z = 0; asked for is the mean velocity over periods 20 to 30. The incline is folded into the coefficients.
Written here a second time, apart from stickslip, so that the judge and the judged share no code.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

BODY, INNER, GRAVITY = 62.59e-3, 9.48e-3, 9.81
MASS = BODY + INNER
MU = INNER / MASS
WEIGHT = MASS * GRAVITY
SIGMA0, SIGMA1, SIGMA2, V_S = 4e5, 100.0, 0.04, 2e-3
OMEGA, TILT, F0 = 65.4 * math.pi, math.radians(1.7), 0.21
PERIOD = 2 * math.pi / OMEGA
AMPLITUDES = np.linspace(4e-4, 8e-4, 512)

# Units in which every state is about 1 while sliding: solvers with one absolute tolerance for all states need them.
SPEED, STRAIN, PATH = 1e-2, 1e-7, 1e-4


@dataclass(frozen=True)
class Problem:
    """Many cases that differ in the drive amplitude [m] only."""

    mu0: float
    amplitude: np.ndarray
    periods: int = 30
    settle: int = 20

    @property
    def sides(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """(mu, f) forward and backward, Eq. 4.1."""
        cos, sin = math.cos(TILT), math.sin(TILT)
        return (self.mu0 * cos - sin, F0 * cos - sin), (self.mu0 * cos + sin, F0 * cos + sin)

    @property
    def push(self) -> np.ndarray:
        """A mu omega^2 of each case [m/s^2]."""
        return self.amplitude * (MU * OMEGA**2)

    @property
    def rows(self) -> np.ndarray:
        """One row of numbers per case, as kernels.flow takes them."""
        (mu_p, f_p), (mu_m, f_m) = self.sides
        fixed = [OMEGA, 1 / MASS, mu_p, f_p - mu_p, mu_m, f_m - mu_m, SIGMA0 / WEIGHT, SIGMA0, SIGMA1, SIGMA2, 1 / V_S**2]
        return np.column_stack([self.push, np.tile(fixed, (len(self.amplitude), 1))])

    @property
    def times(self) -> np.ndarray:
        """Start, end of settling, end [s]."""
        return np.array([0.0, self.settle, self.periods]) * PERIOD

    def mean_velocity(self, path_settled, path_end):
        """Displacement over the counted periods divided by their time [m/s]."""
        return (path_end - path_settled) / ((self.periods - self.settle) * PERIOD)

    def some(self, count: int) -> Problem:
        """At most `count` of the cases, evenly spread, first and last included (of one: the middle)."""
        n = len(self.amplitude)
        if count >= n:
            return self
        pick = [n // 2] if count == 1 else np.linspace(0, n - 1, count).round().astype(int)
        return replace(self, amplitude=self.amplitude[pick])


def sweep(mu0: float) -> Problem:
    """The 512 cases of the table."""
    return Problem(mu0, AMPLITUDES)


def alone(mu0: float) -> Problem:
    """One case, A = 0.6 mm."""
    return Problem(mu0, np.array([6e-4]))
