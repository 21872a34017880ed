"""Runs made by hand, for tests of what reads runs: slow, obvious, without the package's solvers."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import stickslip as ss
from stickslip.results.dense_output import HarmonicArcs, PolynomialPieces
from stickslip.results.trajectory import Trajectory


def unit_robot(alpha_plus, alpha_minus, static=(None, None)):
    """A robot with A mu omega = 1, omega = 1 and g = 1, so that v = w, t = tau and mu = alpha (TRUTH 2)."""
    friction = ss.Coulomb(alpha_plus, alpha_minus, *static)
    return ss.Robot(body_mass=1.0, inner_mass=1.0, drive=ss.Harmonic(amplitude=2.0, omega=1.0), friction=friction, gravity=1.0)


def coulomb_run(robot, periods, settle=None, samples=400):
    """March from rest, arc by arc, with brentq; cut at nothing but changes of mode."""
    a = float(robot.mass_ratio * robot.drive.amplitude * robot.drive.omega**2)
    omega, load, mass = robot.drive.omega, robot.load(0, 0), robot.total_mass
    along = float(robot.acceleration(0.0, 0.0, 0.0, 0.0))
    plus, minus = robot.friction.sliding(1.0, load) / mass - along, along - robot.friction.sliding(-1.0, load) / mass
    low, high = (limit / mass - along for limit in robot.friction.breakaway(load))
    end = periods * robot.period
    t, x, v, mode = [0.0], [], [], []
    here, now = 0.0, 0.0
    side = _side(a, omega, 0.0, low, high)
    while now < end:
        x.append(here), v.append(0.0), mode.append(side)
        if side == 0:
            then = _breakaway(a, omega, now, low, high, end)
            t.append(then)
            now, side = then, _side(a, omega, then, low, high, tie=True)
            continue
        arc = HarmonicArcs(np.array([now, end + robot.period]), np.array([side]), np.array([here]), np.zeros(1), a, omega, plus, minus)

        def speed(time, arc=arc):
            return float(arc.evaluate(np.array([time]), np.array([0]))[1][0, 0])

        grid = np.linspace(now, now + robot.period * 1.5, 3001)[1:]
        values = side * arc.evaluate(grid, np.zeros(len(grid), int))[1][:, 0]
        first = int(np.argmax(values < 0)) if (values < 0).any() else None
        if first is None or grid[max(first - 1, 0)] >= end:
            then = end
        else:
            then = min(end, brentq(speed, grid[first - 1] if first else now, grid[first], xtol=1e-15, rtol=1e-15))
        here = float(arc.evaluate(np.array([then]), np.array([0]))[0][0, 0])
        t.append(then)
        now, side = then, _side(a, omega, then, low, high)
    arcs = HarmonicArcs(np.array(t), np.array(mode, np.int8), np.array(x), np.array(v), a, omega, plus, minus)
    return Trajectory(robot, arcs, periods, periods // 2 if settle is None else settle, 1e-6, "by hand", samples=samples)


def _side(a, omega, t, low, high, tie=False):
    push = a * math.sin(omega * t)
    if tie:  # breaking away: the limit is reached up to rounding
        return 1 if abs(push - high) < abs(push - low) else -1
    return 1 if push > high else -1 if push < low else 0


def _breakaway(a, omega, now, low, high, end):
    """The next time at which a sin(omega t) leaves [low, high]."""
    candidates = [end]
    k = math.floor(omega * now / (2 * math.pi)) - 1
    for n in range(k, k + 4):
        if high < a:
            candidates.append((2 * math.pi * n + math.asin(high / a)) / omega)
        if low > -a:
            candidates.append((2 * math.pi * n + math.pi - math.asin(low / a)) / omega)
    return min(c for c in candidates if c > now)


def lugre_run(robot, periods, settle=None, rtol=1e-9, samples=400):
    """scipy's Radau from v = z = 0, restarted at each reversal, its dense output kept as cubic pieces on fine steps."""
    law, load = robot.friction, robot.load(0, 0)
    start_side = 1

    def right(t, y, side):
        slip = side * max(side * y[0], 0.0)
        rate = law.rate(slip if slip else side * 1e-300, y[1], load)
        return [robot.acceleration(t, 0.0, y[0], law.force(y[0], y[1], rate, load)), rate]

    nodes, states, rates, modes = [], [], [], []
    y, t, end, side = [0.0, 0.0], 0.0, periods * robot.period, start_side
    scale = [robot.velocity_scale, law.scale(load)]
    while t < end * (1 - 1e-14):

        def crossing(time, state, side=side, begin=t):
            return state[0] + (side * 1e-30 if time == begin else 0.0)

        crossing.terminal, crossing.direction = True, -side
        accuracy = {"rtol": rtol, "atol": [1e-3 * rtol * s for s in scale]}
        solved = solve_ivp(right, (t, end), y, "Radau", args=(side,), events=_without_args(crossing), dense_output=True, **accuracy)
        fine = np.unique(np.concatenate([np.linspace(a, b, 7) for a, b in zip(solved.t[:-1], solved.t[1:], strict=True)]))
        values = solved.sol(fine)
        values[:, 0] = y
        if solved.status == 1:
            values[0, -1] = 0.0
        slopes = np.array([right(s, u, side) for s, u in zip(fine, values.T, strict=True)])
        nodes.append(fine[:-1]), states.append(values), rates.append(slopes), modes.append(np.full(len(fine) - 1, side, np.int8))
        t, y, side = solved.t[-1], list(values[:, -1]), -side
    return _hermite(robot, nodes, states, rates, modes, t, periods, settle, rtol, samples)


def _without_args(event):
    def called(time, state, side):
        return event(time, state)

    called.terminal, called.direction = event.terminal, event.direction
    return called


def _hermite(robot, nodes, states, rates, modes, end, periods, settle, rtol, samples):
    """Cubic Hermite pieces through the nodes."""
    t = np.append(np.concatenate(nodes), end)
    h = np.diff(t)
    y0, y1 = np.concatenate([v[:, :-1].T for v in states]), np.concatenate([v[:, 1:].T for v in states])
    d0, d1 = np.concatenate([r[:-1] for r in rates]) * h[:, None], np.concatenate([r[1:] for r in rates]) * h[:, None]
    c = np.stack([y0, d0, 3 * (y1 - y0) - 2 * d0 - d1, 2 * (y0 - y1) + d0 + d1], axis=2)
    steps = h * (c[:, 0] / np.arange(1, 5)).sum(axis=1)
    x0 = np.concatenate([[0.0], np.cumsum(steps)[:-1]])
    pieces = PolynomialPieces(t, np.concatenate(modes), x0, c)
    return Trajectory(robot, pieces, periods, periods // 2 if settle is None else settle, rtol, "scipy Radau by hand", samples=samples)
