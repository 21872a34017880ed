"""Jenkins elements (a spring in series with a slider) whose states are discrete memory, against the same elements clipped step by step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import stickslip as ss
from slipping_elements import Jenkins, oscillator
from stickslip.engine.law_steps import law_steps
from stickslip.inverse.identification.law_forces import Stepped, _step_by_step
from stickslip.maths import where
from stickslip.models.friction.law_adapter import adapted


def clipped(limits, force, omega, periods, steps=4000):
    """x and v of an oscillator of mass, stiffness 1 and damping 0.02 on these elements, by midpoint steps (cases,)."""
    bounds, h = np.array(limits)[:, None], 2 * np.pi / omega / steps
    x, v, z = np.zeros_like(omega), np.zeros_like(omega), np.zeros((len(limits), len(omega)))
    for i in range(steps * periods):
        a = force * np.sin(omega * i * h) - x - 0.02 * v - z.sum(axis=0)
        middle, rate = x + 0.5 * h * v, v + 0.5 * h * a
        half = np.clip(z + 0.5 * h * v, -bounds, bounds)
        a = force * np.sin(omega * (i + 0.5) * h) - middle - 0.02 * rate - half.sum(axis=0)
        x, v, z = x + h * rate, v + h * a, np.clip(z + h * rate, -bounds, bounds)
    return x, v


@pytest.mark.parametrize("limits", [(0.1,), pytest.param((0.05, 0.2), marks=pytest.mark.slow), (0.05, 0.1, 0.2, 0.4)], ids=len)
def test_elements_with_memory_move_as_clipped_ones(limits):
    force, omega = np.array([0.3, 0.9, 0.3, 0.06]), np.array([0.7, 0.4, 1.3, 1.7])
    x, v = clipped(limits, force, omega, periods=8)
    many = ss.solve(oscillator(limits, force, omega), periods=8, settle=7)
    assert many.status.tolist() == [0] * 4
    for i in range(4):
        run = ss.solve(oscillator(limits, float(force[i]), float(omega[i])), periods=8)
        # midpoint steps err by some (omega h)^2 of the motion, and by h v at each yield; omega h = 2 pi/4000
        assert abs(run.x[-1] - x[i]) < 1e-4 and abs(run.v[-1] - v[i]) < 1e-4
        last = np.linspace(7.0, 8.0, 2001) * run.period_time
        assert many.velocity_max[i] == pytest.approx(run.at(last)["v"].max(), rel=2e-5)


@pytest.mark.slow
def test_eight_elements_of_which_some_yield_together():
    limits, force, omega = (0.03, 0.05, 0.05, 0.1, 0.1, 0.1, 0.2, 0.4), np.array([0.3, 1.1]), np.array([0.7, 0.5])
    x, v = clipped(limits, force, omega, periods=40)
    for i in range(2):
        run = ss.solve(oscillator(limits, float(force[i]), float(omega[i])), periods=40)
        assert abs(run.x[-1] - x[i]) < 1e-4 and abs(run.v[-1] - v[i]) < 1e-4


def test_the_judge_moves_them_alike():
    limits = (0.05, 0.1, 0.2, 0.4)
    x, v = clipped(limits, np.array([0.3]), np.array([0.7]), periods=8)
    run = ss.solve(oscillator(limits, 0.3, 0.7), periods=8, method="lsoda", rtol=1e-7)
    assert abs(run.x[-1] - x[0]) < 1e-5 and abs(run.v[-1] - v[0]) < 1e-5


@pytest.mark.parametrize("limits", [(0.1,), (0.05, 0.1, 0.2, 0.4)], ids=len)
def test_a_prescribed_motion_gives_the_force_of_clipped_elements(limits):
    t = np.linspace(0.0, 40.0, 801)
    steps, x = np.diff(t, prepend=0.0), 0.3 * np.sin(t) + 0.2 * np.sin(2.7 * t)
    moved, z, forces = np.diff(x, prepend=x[0]), np.zeros(len(limits)), []
    for d in moved:  # at constant velocity between samples clipping is exact
        z = np.clip(z + d, np.negative(limits), limits)
        forces.append(z.sum())
    v = np.divide(moved, steps, out=np.zeros_like(t), where=steps > 0)
    law, ones, nothing = adapted(Jenkins(limits)), np.ones((801, 1)), np.zeros((801, 1))
    compiled = law_steps(law)(law, steps, v, v, ones, nothing, np.zeros((len(limits), 1)))
    plain, _ = _step_by_step(law, Stepped(t, v, v), ones, nothing, np.zeros((len(limits), 1)), steps)
    np.testing.assert_allclose(compiled[:, 0], forces, rtol=0, atol=1e-12)
    np.testing.assert_allclose(plain[:, 0], forces, rtol=0, atol=1e-9)  # slopes of rates are differences there


@dataclass(frozen=True)
class Caught(Jenkins):
    """One whose spring does not move beyond its limit, whichever way the contact goes: an error that is easily made."""

    beyond: float = 1.0

    def rate(self, v, z, load, mode):
        return v * (1 - mode[0] * mode[0]) * where(abs(z) >= self.beyond * self.limits[0] * load, 0.0, 1.0)


def test_check_law_restarts_a_memory_where_a_motion_reverses_at_a_limit():
    assert ss.testing.check_law(Jenkins((0.05, 0.1)))["restart at a reversal"].value < 1e-8
    with pytest.raises(ss.InputError, match="change of the force, of the load, by a change of 1e-9 of the states"):
        ss.testing.check_law(Caught((0.1,), beyond=1.0 + 5e-10))
    with pytest.raises(ss.InputError, match=r"switches its memories endlessly.*right after a switch"):
        ss.testing.check_law(Caught((0.1,)))
