"""The machines of the presets as plain matrices, written a second time apart from stickslip: what its rivals in `machines.py` are given.

    M q'' = f(t, q, q') - sum of g_i R_i(w_i) + sum of h_s P_s,     w_i = g_i q' + b_i(t),     h_s q + d_s >= 0

with diagonal M, friction -mu_minus N <= R <= mu_plus N at rest, and stops whose forces P never pull. The load N of a contact is a function
of time, or the force of a stop. Functions of time and force are compiled by Numba; plain SciPy calls them as they are.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numba import njit

Array = Any
G = 9.81
NONE = np.zeros((0, 0))


@dataclass(frozen=True, eq=False)
class Plain:
    """One machine with all its numbers."""

    mass: Array  # of each coordinate
    rows: Array  # g: (contact, coordinate)
    mu: Array  # (contact, 2): forwards, backwards
    force: Callable  # (t, q, u, numbers) -> f
    offset: Callable  # (t, numbers) -> b
    load: Callable  # (t, numbers) -> N, of the contacts that no stop presses
    numbers: Array
    period: float
    periods: int
    speed: float  # a typical velocity of slip
    weights: Array  # of the coordinates in the position that is asked for
    static: float = 1.0  # friction at rest over friction in motion
    stops: Array = field(default_factory=lambda: NONE)  # h: (stop, coordinate); gaps are 0 at q = 0, restitution is 0
    pressed_by: Array = field(default_factory=lambda: np.zeros(0, dtype=np.int64))  # (contact,): number of the stop, -1: load(t)
    breaks: tuple[float, ...] = ()  # instants of a period at which something jumps, over the period
    start: Array = None  # q' at t = 0

    @property
    def rates(self) -> Array:
        """q' at the start."""
        return np.zeros(len(self.mass)) if self.start is None else np.asarray(self.start, dtype=float)

    @property
    def pressing(self) -> Array:
        """For each contact the stop that presses it, -1 for none."""
        return self.pressed_by if len(self.pressed_by) else -np.ones(len(self.rows), dtype=np.int64)


@njit
def _still(t, n):
    """The ground does not move."""
    return np.zeros(2)


@njit
def _weights(t, n):
    """Constant loads: the last two numbers."""
    return n[-2:]


@njit
def _pair_force(t, q, u, n):
    """Two modules on a spring: push, omega, phase, k, c."""
    pull = n[3] * (q[1] - q[0]) + n[4] * (u[1] - u[0])
    return np.array([n[0] * math.sin(n[1] * t) + pull, n[0] * math.sin(n[1] * t + n[2]) - pull])


def two_modules(amplitude: float) -> Plain:
    """In antiphase."""
    M, m, omega = 0.06259, 0.00948, 65.4 * math.pi
    P = M + m
    numbers = np.array([m * amplitude * omega**2, omega, math.pi, 1200.0, 0.4, P * G, P * G])
    mu = np.array([[0.15, 0.21]] * 2)
    T, scale = 2 * math.pi / omega, m / P * amplitude * omega
    return Plain(np.array([P, P]), np.eye(2), mu, _pair_force, _still, _weights, numbers, T, 20, scale, np.array([0.5, 0.5]))


@njit
def _no_force(t, q, u, n):
    return np.zeros(1)


@njit
def _gait(t, n):
    """Velocities of three equal masses about their centre: a omega, omega, lag."""
    first, last = n[0] * math.cos(n[1] * t), n[0] * math.cos(n[1] * t - n[2])
    return np.array([(2 * first + last) / 3, (last - first) / 3, -(first + 2 * last) / 3])


@njit
def _three_weights(t, n):
    return n[3:]


def worm(amplitude: float) -> Plain:
    """One coordinate, that of the centre, and three feet."""
    omega = 4 * math.pi
    numbers = np.array([amplitude * omega, omega, 2 * math.pi / 3, 0.05 * G, 0.05 * G, 0.05 * G])
    mu, speed = np.array([[0.1, 0.3]] * 3), amplitude * omega
    return Plain(np.array([0.15]), np.ones((3, 1)), mu, _no_force, _gait, _three_weights, numbers, 0.5, 20, speed, np.ones(1))


@njit
def _pulsed(t, q, u, n):
    """Body and inner mass: pulse, period, duty, k."""
    push = n[0] if t / n[1] % 1.0 < n[2] else 0.0
    pull = n[3] * (q[1] - q[0])
    return np.array([pull - push, push - pull])


@njit
def _weight(t, n):
    return n[-1:]


@njit
def _level(t, n):
    return np.zeros(1)


def capsubot(pulse: float) -> Plain:
    """A coil that pushes a magnet on a spring for 0.35 of the period."""
    M, m = 0.193, 0.074
    numbers, row = np.array([pulse, 0.06, 0.35, 256.23, (M + m) * G]), np.array([[1.0, 0.0]])
    weights, mu = np.array([1.0, 0.0]), np.array([[0.29, 0.29]])
    return Plain(np.array([M, m]), row, mu, _pulsed, _level, _weight, numbers, 0.06, 20, 0.1, weights, breaks=(0.35,))


@njit
def _struck(t, q, u, n):
    """Capsule and inner mass with an elastic stop: force, omega, 2 xi, gap, stiffness of the stop."""
    pull = q[1] - q[0] + n[2] * (u[1] - u[0]) + n[4] * max(q[1] - q[0] - n[3], 0.0)
    return np.array([pull, n[0] * math.cos(n[1] * t) - pull])


def capsule(force_ratio: float) -> Plain:
    """Without dimensions."""
    numbers = np.array([force_ratio, 0.95, 0.1, 0.02, 15.0, 1.0])
    row, weights, T = np.array([[1.0, 0.0]]), np.array([1.0, 0.0]), 2 * math.pi / 0.95
    return Plain(np.array([5.0, 1.0]), row, np.ones((1, 2)), _struck, _level, _weight, numbers, T, 20, 0.5, weights)


@njit
def _tip(t, n):
    """A sawtooth: stroke, rise, fall."""
    s = t % (n[1] + n[2])
    return np.array([-n[0] / n[1] if s < n[1] else n[0] / n[2]])


def stick_slip_stage(stroke: float) -> Plain:
    """A slider on a tip that goes up in 0.95 ms and back in 0.05 ms."""
    numbers, row, mu = np.array([stroke, 0.95e-3, 0.05e-3, 20.0]), np.ones((1, 1)), np.array([[0.1, 0.1]])
    return Plain(np.array([0.02]), row, mu, _no_force, _tip, _weight, numbers, 1e-3, 20, 5e-3, np.ones(1), breaks=(0.95,))


@njit
def _thrown(t, q, u, n):
    """Position along and height over the track: A cos, A sin, omega, mass."""
    return np.array([0.0, -n[3] * (9.81 - n[1] * n[2] ** 2 * math.sin(n[2] * t))])


@njit
def _trough(t, n):
    return np.array([-n[0] * n[2] * math.cos(n[2] * t)])


def conveyor(throw_index: float) -> Plain:
    """A part that hops, at 30 degrees and 50 Hz."""
    angle, omega = math.radians(30.0), 100 * math.pi
    A = throw_index * G / (omega**2 * math.sin(angle))
    numbers = np.array([A * math.cos(angle), A * math.sin(angle), omega, 0.01, 0.0])
    row, stop, weights = np.array([[1.0, 0.0]]), np.array([[0.0, 1.0]]), np.array([1.0, 0.0])
    mu, masses, lifted = np.array([[0.4, 0.4]]), np.array([0.01, 0.01]), np.array([0.0, 0.0])
    shape = {"stops": stop, "pressed_by": np.array([0]), "start": lifted}
    return Plain(masses, row, mu, _thrown, _trough, _weight, numbers, 0.02, 20, A * omega, weights, **shape)


@njit
def _controlled(t, q, u, n):
    """Angle, and the integral of the error as a coordinate whose rate is the error: target, kp, ki, kd."""
    return np.array([n[1] * (n[0] - q[0]) + n[2] * q[1] - n[3] * u[0], -u[0]])


def servo(target: float) -> Plain:
    """A geared motor under a PID controller that hunts about its target; a period stands for a second."""
    numbers, row, start = np.array([target, 1.0, 2.0, 0.04, 1.0]), np.array([[1.0, 0.0]]), np.array([0.0, target])
    mu, weights = np.array([[0.05, 0.05]]), np.array([1.0, 0.0])
    return Plain(np.array([3e-3, 1.0]), row, mu, _controlled, _level, _weight, numbers, 1.0, 20, 0.5, weights, static=2.0, start=start)
