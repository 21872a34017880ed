"""The published coefficients do what their papers say: order, dense order, L-stability, measured with a slow step in 50 digits."""

from __future__ import annotations

import functools

import mpmath as mp
import pytest

from slow_step import rosenbrock_step
from stickslip.engine.tableaux import TABLEAUX

every_tableau = pytest.mark.parametrize("tableau", TABLEAUX.values(), ids=lambda t: t.name)


def pendulum(t, y):
    """A non-autonomous, nonlinear system of two equations."""
    return [y[1] * mp.cos(t) - y[0] ** 2, -mp.sin(y[0]) - y[1] / 3 + mp.exp(-t) * y[0]]


def jacobian(t, y):
    return [[-2 * y[0], mp.cos(t)], [-mp.cos(y[0]) + mp.exp(-t), -mp.mpf(1) / 3]]


def by_time(t, y):
    return [-y[1] * mp.sin(t), -mp.exp(-t) * y[0]]


def reference(t, y, h):
    """Taylor series by mpmath, far more exact than a step."""
    solution = mp.odefun(pendulum, t, y, tol=mp.mpf(10) ** -40)
    return [solution(t + h), solution(t + h / 2)]


@functools.cache
def references():
    """Start, and by step the solution after it and after its half."""
    mp.mp.dps = 50
    t, y, steps = mp.mpf("0.3"), [mp.mpf("0.7"), mp.mpf("-0.4")], [mp.mpf(1) / 2**k for k in range(4, 7)]
    return t, y, [(h, reference(t, y, h)) for h in steps]


def errors(tableau, of):
    """Errors of one step (0) or of its middle (1), for halved steps."""
    t, y, steps = references()
    found = ((rosenbrock_step(pendulum, jacobian, by_time, t, y, h, tableau, mp)[of], exact[of]) for h, exact in steps)
    return [max(abs(a - b) for a, b in zip(new, exact, strict=True)) for new, exact in found]


@every_tableau
def test_local_error_falls_with_order_plus_one(tableau):
    *_, before, last = errors(tableau, 0)
    observed = float(mp.log(before / last, 2))
    assert observed == pytest.approx(tableau.order + 1, abs=0.25)  # next term of the expansion at h = 1/64


@every_tableau
def test_dense_output_has_its_order(tableau):
    *_, before, last = errors(tableau, 1)
    observed = float(mp.log(before / last, 2))
    assert observed == pytest.approx(tableau.dense_order + 1, abs=0.3)


@every_tableau
def test_stiff_decay_is_damped_at_once(tableau):
    """R(infinity) = 0: on y' = -1e12 y a step of 1 leaves nothing."""
    mp.mp.dps = 50
    rate = mp.mpf(10) ** 12
    new, _, _ = rosenbrock_step(
        lambda t, y: [-rate * y[0]], lambda t, y: [[-rate]], lambda t, y: [0], mp.mpf(0), [mp.mpf(1)], mp.mpf(1), tableau, mp
    )
    assert abs(new[0]) < 1e-9


@every_tableau
def test_last_stages_share_their_arguments(tableau):
    """What the emitted step relies on: the last stage's argument is the one before plus its increment."""
    assert tableau.a[-1][:-1] == tableau.a[-2]
    assert tableau.a[-1][-1] == 1.0
    assert tableau.c[-1] == 1.0
