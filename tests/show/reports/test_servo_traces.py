"""Angle, target, error and torque of a joint, as its page draws them."""

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.show.reports.servo_traces import traces

J, n = 2e-3, 50.0
LAW = ss.Coulomb(mu_plus=0.05, mu_minus=0.05, f_plus=0.1, f_minus=0.1)
GAINS = {"kp": 0.02, "ki": 0.04, "kd": 8e-4}


def joint(**control):
    return ss.Joint(inertia=J, friction=LAW, gear_ratio=n, control=ss.machines.PID(**GAINS, **control))


@each_row("control", [{"target": 0.5}, {"target": ss.Harmonic(amplitude=0.3, frequency=0.5)}, {"target": 0.5, "sample": 1e-3}])
def test_the_torques_of_the_page_accelerate_the_joint(control):
    """J dv = (applied - friction) dt along the run, and the error is target minus angle."""
    run = ss.solve(joint(**control), duration=3.0, rtol=1e-9)
    t = np.linspace(0.0, 3.0, 60_001)
    angle, error, torque = ({name: np.asarray(y) for name, y in trace["curves"]} for trace in traces(run, t))
    assert error["joint"] == pytest.approx(angle["target"] - angle["joint"], abs=1e-12)
    net = torque["applied"] - torque["friction"]
    gained = np.concatenate([[0.0], np.cumsum(0.5 * (net[1:] + net[:-1]) * np.diff(t))])  # jumps of the torque, 0.5 N m at most,
    v = run.with_axes.at(t)["v"][:, 0]
    assert np.abs(J * (v - v[0]) - gained).max() < 200 * 0.5 * np.diff(t)[0] * 0.1  # fewer than 200, are each misplaced by half a step
    assert np.abs(J * v).max() > 1e-3  # it moved
