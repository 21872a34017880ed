"""The page of families: each block's number against a second method."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stickslip as ss
from house import ROOT

G, MU, PLUS, MINUS = 9.81, 0.1315, 0.15, 0.25


@pytest.fixture(scope="module")
def page():
    """What the blocks of the page define."""
    text, names = (ROOT / "docs" / "families.md").read_text(encoding="utf-8"), {"__name__": "families"}
    for block in text.split("```python\n")[1:]:
        exec(block.split("```")[0], names)
    return names


def mean(page, name, periods):
    return float(ss.mean_velocity(ss.solve(page[name], periods=periods)))


def test_harmonic_excitation_is_the_closed_formula(page):
    delta = math.pi * 0.5 / 0.9
    assert mean(page, "harmonic", 60) == pytest.approx(-math.cos(delta) * math.sqrt(1 - (0.4 * delta / math.sin(delta)) ** 2), abs=1e-12)


def test_two_phases_are_the_formula(page):
    t1, t2, jump = 0.01 / 0.05, 0.01 / 0.4, MU * 0.45
    V = (jump * t2 - PLUS * G * t2**2 / 2 * (1 + PLUS / MINUS)) / (t1 + t2)
    assert mean(page, "two_phase", 40) == pytest.approx(V, abs=1e-11)


def test_three_phases_are_the_formula(page):
    u1, w1, w2, w3 = 0.3, 10.0, 60.0, 12.0
    u3 = u1 * math.sqrt((1 / w1 + 1 / w2) / (1 / w2 + 1 / w3))
    a2, a3, T = MU * w2 - PLUS * G, MU * w3 + PLUS * G, u1 / w1 + (u1 + u3) / w2 + u3 / w3
    v2 = a2 * (u1 + u3) / w2
    assert mean(page, "three_phase", 40) == pytest.approx(v2**2 * (1 / a2 + 1 / a3) / (2 * T), abs=1e-11)


def test_two_inner_masses_are_the_run_from_event_to_event(page):
    """w' = sin t + sin 2t - r, friction 0.3; rest while the push is below it."""
    push, alpha, period = (lambda t: math.sin(t) + math.sin(2 * t)), 0.3, 2 * math.pi
    t, w, x, at = 0.0, 0.0, 0.0, []
    for k in range(1, 21):
        while t < k * period:
            side = math.copysign(1.0, w) if w else math.copysign(1.0, push(t)) if abs(push(t)) > alpha else 0.0
            if side == 0.0:
                t = min(t + 1e-4, k * period)  # break-away to 1e-4
                continue
            stop = lambda t, y: y[0]  # noqa: E731
            stop.terminal, stop.direction = True, -side
            start = w or side * 1e-12
            run = solve_ivp(
                lambda t, y, s=side: [push(t) - s * alpha, y[0]], (t, k * period), [start, x], "DOP853", events=stop, rtol=1e-10, atol=1e-13
            )
            t, x = float(run.t[-1]), float(run.y[1, -1])
            w = 0.0 if run.t_events[0].size else float(run.y[0, -1])
        at.append(x)
    assert mean(page, "two_masses", 100) == pytest.approx((at[-1] - at[9]) / (10 * period), abs=1e-5)
    assert mean(page, "two_masses", 100) == pytest.approx(-0.293377298877835, abs=1e-9)


def test_two_modules_are_the_time_stepping(page):
    P, m, A, omega, k, c = 0.07207, 0.00948, 6e-4, 65.4 * math.pi, 1200.0, 0.4
    n, period = 4000, 2 * math.pi / omega
    h = period / n
    x, v = np.zeros(2), np.zeros(2)
    phase, marks = np.array([0.0, math.pi]), []
    for step in range(30 * n):
        if step % n == 0:
            marks.append(x[0])
        link = k * (x[0] - x[1]) + c * (v[0] - v[1])
        free = v + h * (m * A * omega**2 * np.sin(omega * (step + 0.5) * h + phase) + np.array([-link, link])) / P
        ahead, back = h * 0.15 * G, h * 0.21 * G
        v = np.where(free > ahead, free - ahead, np.where(free < -back, free + back, 0.0))
        x = x + h * v
    assert mean(page, "two_modules", 200) == pytest.approx((marks[-1] - marks[-11]) / (10 * period), rel=4e-3)
    assert mean(page, "two_modules", 200) == pytest.approx(0.011119895989126, rel=1e-9)


def test_a_worm_advances_by_three_amplitudes(page):
    assert mean(page, "worm", 20) == pytest.approx(3 * 2e-3 * 2.0, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "periods", "force"),
    [
        ("viscous", 200, lambda v: (2.0 if v > 0 else 6.0) * v),
        ("quadratic", 400, lambda v: (100.0 if v > 0 else 300.0) * v * abs(v)),
    ],
)
def test_viscous_and_quadratic_friction_are_the_plain_integration(page, name, periods, force):
    total, m, A, omega = 0.07207, 0.00948, 6e-4, 65.4 * math.pi
    period, last = 2 * math.pi / omega, 60 if name == "viscous" else 120
    push = m * A * omega**2
    run = solve_ivp(
        lambda t, y: [y[1], (push * math.sin(omega * t) - force(y[1])) / total],
        (0.0, last * period), [0.0, 0.0], "DOP853", rtol=1e-9, atol=1e-13, max_step=period / 40,
        t_eval=[(last - 10) * period, last * period],
    )  # fmt: skip
    assert mean(page, name, periods) == pytest.approx((run.y[0, -1] - run.y[0, 0]) / (10 * period), rel=1e-5)
