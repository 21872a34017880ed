"""Two systems that others printed numbers of: a toy that pecks down a pole, and an oscillator that hits a wall every other period."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

import stickslip as ss
from stickslip.maths import cos, where

Array = Any
Force = Callable[[Any, Any], Any]

# The woodpecker toy of Glocker. Its coordinates are the height y, the angle of the sleeve and that of the bird; its three contacts the
# beak (1) and the lower and the upper edge of the sleeve (2 and 3). Nothing depends on y. States: both angles, then the three rates.

SLEEVE, BIRD, SLEEVE_INERTIA, BIRD_INERTIA = 0.0003, 0.0045, 5e-9, 7e-7  # kg, kg m^2
L_SLEEVE, L_BIRD, L_BEAK, H_SLEEVE, H_BEAK = 0.010, 0.015, 0.0201, 0.0058, 0.02  # m
R_SLEEVE, R_POLE = 0.0031, 0.0025  # m
SPRING, GRAVITY, FRICTION, RESTITUTION = 0.0056, 9.81, 0.3, 0.5  # N m, m/s^2; friction of all contacts, restitution of the beak
MASS = np.array([
    [BIRD + SLEEVE, BIRD * L_SLEEVE, BIRD * L_BIRD],
    [BIRD * L_SLEEVE, SLEEVE_INERTIA + BIRD * L_SLEEVE**2, BIRD * L_SLEEVE * L_BIRD],
    [BIRD * L_BIRD, BIRD * L_SLEEVE * L_BIRD, BIRD_INERTIA + BIRD * L_BIRD**2],
])  # fmt: skip
INVERSE = np.linalg.inv(MASS)
WEIGHT = -GRAVITY * np.array([BIRD + SLEEVE, BIRD * L_SLEEVE, BIRD * L_BIRD])
STIFFNESS = SPRING * np.array([[0.0, 0.0], [-1.0, 1.0], [1.0, -1.0]])  # forces for both angles
NORMAL = {1: np.array([0.0, 0.0, -H_BEAK]), 2: np.array([0.0, H_SLEEVE, 0.0]), 3: np.array([0.0, -H_SLEEVE, 0.0])}
ALONG = {1: np.array([1.0, L_SLEEVE, L_BIRD - L_BEAK]), 2: np.array([1.0, R_SLEEVE, 0.0]), 3: np.array([1.0, R_SLEEVE, 0.0])}
BEAK, EDGE = (L_SLEEVE + L_BIRD - L_BEAK - R_POLE) / H_BEAK, (R_SLEEVE - R_POLE) / H_SLEEVE  # angles at which they touch the pole
SLIDES = {"up": 1, "down": -1, "stick": 0}


def affine(constant: float, slope: Array, y: Any) -> Any:
    """A number that depends on both angles."""
    return float(constant) + float(slope[0]) * y[0] + float(slope[1]) * y[1]


def product(weights: Array, values: Any) -> Any:
    """Sum of weights times values, which may be symbols."""
    return sum(float(w) * v for w, v in zip(weights, values, strict=True))


def constrained(contact: int, side: int) -> tuple[Array, Array, Array]:
    """Forces of an edge that stays on the pole, as constant and slope, and their directions: it holds (side 0) or slides up or down."""
    held = np.column_stack([NORMAL[contact], ALONG[contact]] if side == 0 else [NORMAL[contact]])
    pulls = held if side == 0 else (NORMAL[contact] - side * FRICTION * ALONG[contact])[:, None]
    solved = -np.linalg.inv(held.T @ INVERSE @ pulls) @ held.T @ INVERSE
    return solved @ WEIGHT, solved @ STIFFNESS, pulls


def rates(contact: int, side: int) -> Force:
    """Rates of the state; contact 0 is free fall."""
    constant, slope = WEIGHT, STIFFNESS
    if contact:
        force, change, pulls = constrained(contact, side)
        constant, slope = constant + pulls @ force, slope + pulls @ change
    a, b = INVERSE @ constant, INVERSE @ slope
    still = [contact > 0 and side == 0, contact > 0, False]  # what the constraint keeps is zero, not a rounding error
    return lambda t, y: (y[3], y[4], *(0.0 * y[0] if still[i] else affine(a[i], b[i], y) for i in range(3)))


def force_of(contact: int, side: int, k: int) -> Force:
    """Normal force (k = 0) or friction (k = 1) of an edge on the pole."""
    constant, slope, _ = constrained(contact, side)
    return lambda t, y: affine(constant[k], slope[k], y)


def impulses(contact: int, restitution: float, y: Any) -> tuple[Any, Any]:
    """Normal and tangential impulse of a hit by Newton's and Coulomb's laws: it sticks if it can, and slides otherwise."""
    w = np.column_stack([NORMAL[contact], ALONG[contact]])
    d, u = w.T @ INVERSE @ w, y[2:5]
    closing, sliding = (1 + restitution) * product(NORMAL[contact], u), product(ALONG[contact], u)
    stuck = [product(row, (-closing, -sliding)) for row in np.linalg.inv(d)]
    slid = {side: -closing / float(d[0, 0] - side * FRICTION * d[0, 1]) for side in (1, -1)}
    goes_up = sliding + float(d[1, 0] - FRICTION * d[1, 1]) * slid[1] > 0.0
    normal, side = where(goes_up, slid[1], slid[-1]), where(goes_up, 1.0, -1.0)
    sticks = abs(stuck[1]) <= FRICTION * stuck[0]
    return where(sticks, stuck[0], normal), where(sticks, stuck[1], -side * FRICTION * normal)


def hit(contact: int, restitution: float) -> Force:
    """The state after a hit."""
    columns = np.column_stack([INVERSE @ NORMAL[contact], INVERSE @ ALONG[contact]])

    def reset(t: Any, y: Any) -> tuple[Any, ...]:
        pushed = impulses(contact, restitution, y)
        return (y[0], y[1], *(y[2 + i] + product(columns[i], pushed) for i in range(3)))

    return reset


def landed(contact: int) -> Force:
    """The mode after an edge has hit."""

    def mode(t: Any, y: Any) -> str:
        normal, along = impulses(contact, 0.0, y)
        holds = abs(along) < FRICTION * normal * (1 - 1e-9)
        return f"{contact} {'stick' if holds else 'up' if along < 0 else 'down'}"

    return mode


def stopped(contact: int) -> Force:
    """The mode after an edge has stopped sliding."""
    normal, along = force_of(contact, 0, 0), force_of(contact, 0, 1)

    def mode(t: Any, y: Any) -> str:
        pull, most = along(t, y), FRICTION * normal(t, y)
        return f"{contact} {'stick' if abs(pull) <= most else 'up' if pull < 0 else 'down'}"

    return mode


def exits(contact: int, word: str) -> tuple[ss.Switch, ...]:
    """What ends a mode in which an edge is on the pole: it lifts off, stops or breaks loose."""
    side = SLIDES[word]
    lifts = ss.Switch(force_of(contact, side, 0), "free")
    if side:
        return (lifts, ss.Switch(lambda t, y: side * y[2], stopped(contact), lambda t, y: (y[0], y[1], 0.0, y[3], y[4])))
    normal, along = force_of(contact, 0, 0), force_of(contact, 0, 1)
    down = ss.Switch(lambda t, y: FRICTION * normal(t, y) - along(t, y), f"{contact} down")
    up = ss.Switch(lambda t, y: FRICTION * normal(t, y) + along(t, y), f"{contact} up")
    return (lifts, down, up)


def woodpecker() -> ss.SwitchingFlow:
    """The toy: free, or with the lower or the upper edge of the sleeve on the pole, where it holds or slides."""
    held = {f"{contact} {word}": (contact, word) for contact in (2, 3) for word in SLIDES}
    fields = {"free": rates(0, 0)} | {name: rates(contact, SLIDES[word]) for name, (contact, word) in held.items()}
    falls = (
        ss.Switch(lambda t, y: BEAK - y[1], "free", hit(1, RESTITUTION)),
        ss.Switch(lambda t, y: EDGE + y[0], landed(2), hit(2, 0.0)),
        ss.Switch(lambda t, y: EDGE - y[0], landed(3), hit(3, 0.0)),
    )
    switches = {"free": falls} | {name: exits(*at) for name, at in held.items()}
    return ss.SwitchingFlow(fields, switches, states=("sleeve", "bird", "v", "w_sleeve", "w_bird"), scales=(0.1, 0.1, 0.1, 10.0, 10.0))


LEINE = (-0.000107, 0.00312, -0.3505, 31.81, 14.44)  # a state of the motion as it is printed: between two contacts
PECK = 0.146  # s; the script runs so long


def crossing(orbit: ss.dynamics.PeriodicOrbit, state: int, value: float, mode: str, falls: bool = False) -> tuple[float, Array]:
    """Time and state where one coordinate of an orbit rises, or falls, through a value within a mode."""
    from scipy.optimize import brentq

    at = lambda t: ss.dynamics.passage(orbit.model, orbit.state, orbit.mode, t)  # noqa: E731
    times = np.linspace(1e-9, orbit.duration, 200)
    seen = [at(t) for t in times]
    past = np.array([(p.state[state] - value) * (-1 if falls else 1) for p in seen])
    k = next(k for k in range(199) if past[k] < 0 <= past[k + 1] and seen[k].mode == seen[k + 1].mode == mode)
    when = brentq(lambda t: at(t).state[state] - value, times[k], times[k + 1], xtol=1e-14)
    return when, at(when).state


def fallen(orbit: ss.dynamics.PeriodicOrbit) -> float:
    """Height lost in a period: the integral of the velocity, which is a sixth state here."""
    height = lambda f: lambda t, y: (*f(t, y[:5]), y[2])  # noqa: E731
    kept = lambda f: lambda t, y: (*f(t, y[:5]), y[5])  # noqa: E731
    without = lambda f: (lambda t, y: f(t, y[:5])) if callable(f) else f  # noqa: E731
    fields = {name: height(f) for name, f in orbit.model.fields.items()}
    switches = {
        name: tuple(ss.Switch(without(s.guard), without(s.to), s.reset and kept(s.reset)) for s in ends)
        for name, ends in orbit.model.switches.items()
    }
    return float(-ss.dynamics.passage(ss.SwitchingFlow(fields, switches), [*orbit.state, 0.0], orbit.mode, orbit.duration).state[5])


# An oscillator that hits a wall at x = 0 once in two periods of its forcing, of Ghosh and Simpson.

DAMPING, REBOUND = 0.04, 0.9


def every_other(w: float) -> ss.SwitchingFlow:
    """The oscillator, whose forcing F cos(w t) begins half a period late: hits are far from where the state is looked at."""
    swing = lambda t, y, n: (y[1], -n.F * cos(n.w * t) - 1.0 - y[0] - DAMPING * y[1])  # noqa: E731
    wall = ss.Switch(lambda t, y, n: -y[0], 0, lambda t, y, n: (0.0, -REBOUND * y[1]))
    return ss.SwitchingFlow({0: swing}, {0: (wall,)}, lambda n: 2 * math.pi / n.w, {"F": 0.36, "w": w}, ("x", "v"))


def bent(kind: str, w: float) -> tuple[ss.dynamics.Branch, ss.Special]:
    """The branch of stable motions with one hit in two periods towards smaller forcing, and its flip or fold."""
    begin, stop = (0.36, 0.346) if kind == "flip" else (0.36306, 0.3626)
    guess = [-1.7325, 0.1989] if kind == "flip" else [-1.8115, 0.1224]
    start = ss.dynamics.flow_orbit(every_other(w).replace(F=begin), guess, 0, periods=2, settle=60)
    branch = ss.continuation(every_other(w), parameter="F", start=begin, stop=stop, guess=start, period=2)
    return branch, next(s for s in branch.special if s.kind == kind)
