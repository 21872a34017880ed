"""The 0-1 test and rotation numbers against maps whose motion is known, and the verdict on tori."""

from __future__ import annotations

import math

import numpy as np
import pytest

import stickslip as ss
from rows import each_row


def iterates(f, x, count, skip=500):
    found = []
    for k in range(count + skip):
        x = f(x)
        if k >= skip:
            found.append(x)
    return np.array(found)


def logistic(r):
    return iterates(lambda x: r * x * (1 - x), 0.3, 1000)


def henon(a):
    return iterates(lambda p: (1 - a * p[0] ** 2 + p[1], 0.3 * p[0]), (0.1, 0.1), 1000)[:, 0]


@each_row("r", [2.8, 3.2, 3.5, 3.55, 3.83])
def test_periods_of_the_logistic_map_are_regular(r):
    """Rest, periods 2, 4 and 8, and the window of period 3."""
    assert ss.dynamics.zero_one_test(logistic(r)).kind == "regular"


@each_row("series", [logistic(3.9), logistic(3.97), henon(1.4), henon(1.2)], ids=["3.9", "3.97", "Henon 1.4", "Henon 1.2"])
def test_chaos_is_told_where_the_exponent_is_positive(series):
    found = ss.dynamics.zero_one_test(series)
    assert found.kind == "chaotic" and found.K > 0.99 and found.quartiles[0] > 0.98


@each_row("a", [1.0, 1.25])
def test_periods_of_henon_are_regular(a):
    """Period 4, and the window of period 7."""
    assert ss.dynamics.zero_one_test(henon(a)).kind == "regular"


def test_two_frequencies_are_regular_whatever_the_mean():
    n = np.arange(1000)
    series = 5 + np.cos(2 * np.pi * n * math.sqrt(2)) + 0.3 * np.cos(2 * np.pi * n * math.sqrt(3))
    assert abs(ss.dynamics.zero_one_test(series).K) < 0.1


def test_chaos_of_the_rig_is_seen_without_its_equations():
    """A = 0.4 mm, mu0 = .05: exponent .453 a period; at 0.6 mm the motion has period one."""
    for amplitude, kind in ((4e-4, "chaotic"), (6e-4, "regular")):
        run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=amplitude, mu0=0.05), periods=600, settle=100)
        assert ss.dynamics.zero_one_test(run.strobe_v[-500:]).kind == kind


def moebius(angle):
    """A circle map with the closed rotation number angle/pi: a turned matrix acting on the directions of lines."""
    A = np.array([[1.2, -0.9], [0.7, 0.4]])
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    return A @ turn @ np.linalg.inv(A), angle / math.pi


@each_row("angle", [0.4, 1.0, 2.2])
def test_a_circle_map_has_its_closed_rotation_number(angle):
    A, rho = moebius(angle)
    lift = [0.1]
    for _ in range(1000):
        v = A @ np.array([math.cos(math.pi * lift[-1]), math.sin(math.pi * lift[-1])])
        y = math.atan2(v[1], v[0]) / math.pi
        lift.append(y + math.ceil(lift[-1] - y))
    found = ss.dynamics.rotation_number(lift)
    assert abs(found.value - rho) <= found.error < 1e-7


def test_points_on_an_ellipse_turn_as_their_angle_does():
    golden = (math.sqrt(5) - 1) / 2
    t = 2 * np.pi * golden * np.arange(1000)
    found = ss.dynamics.rotation_number(np.column_stack([3 + 2 * np.cos(t), -1e-3 * np.cos(t) + 4e-3 * np.sin(t)]))
    assert abs(found.value - golden) <= found.error < 1e-9


def test_a_limit_cycle_on_a_strobe_of_its_own_is_a_torus_with_the_ratio_of_the_two_periods():
    """Van der Pol's cycle at mu = 1 takes 6.6632868593231 s; with a strobe each second it turns clockwise by one in so many points."""
    flow = ss.SwitchingFlow({0: lambda t, y: (y[1], (1 - y[0] ** 2) * y[1] - y[0])}, {}, 1.0, states=("x", "v"))
    told = ss.verdict(flow, periods=600, settle=100, start={"x": 0.5, "v": 0.6})
    assert told.kind == "quasi-periodic" and "a torus of two frequencies" in told.why
    assert abs(1 - told.rotation.value - 1 / 6.6632868593231301) < 3 * told.rotation.error < 1e-6
    assert "rotation number" in told._repr_html_()


@pytest.mark.slow
def test_a_map_beyond_its_neimark_sacker_point_is_a_torus():
    delayed = ss.SwitchingFlow.of_map(lambda y: (2.1 * y[0] * (1 - y[1]), y[0]), states=("x", "y"))
    told = ss.verdict(delayed, periods=2000, settle=500, start={"x": 0.5, "y": 0.6})
    alone = ss.dynamics.rotation_number(iterates(lambda p: (2.1 * p[0] * (1 - p[1]), p[0]), (0.5, 0.6), 5000))
    assert told.kind == "quasi-periodic" and told.rotation.value == pytest.approx(alone.value, abs=1e-11)


def test_what_has_no_closed_curve_has_no_rotation_number():
    with pytest.raises(ss.InputError, match="not on one closed curve"):
        ss.dynamics.rotation_number(iterates(lambda p: (1 - 1.4 * p[0] ** 2 + p[1], 0.3 * p[0]), (0.1, 0.1), 1000))
    three = np.arange(2000)[:, None] * np.array([math.sqrt(2), math.sqrt(3)]) * 2 * np.pi
    with pytest.raises(ss.InputError, match="not on one closed curve"):
        ss.dynamics.rotation_number(
            np.column_stack([np.cos(three[:, 0]) * (2 + np.cos(three[:, 1])), np.sin(three[:, 0]) * (2 + np.cos(three[:, 1]))])
        )
    with pytest.raises(ss.InputError, match="not on one closed curve"):
        ss.dynamics.rotation_number(np.tile([[0.0, 1.0], [1.0, 0.0]], (100, 1)))


def test_what_to_type():
    with pytest.raises(ss.InputError, match="200 or more finite numbers in a row") as wrong:
        ss.dynamics.zero_one_test([1.0, 2.0], frequencies=3)
    assert len(wrong.value.problems) == 2
    with pytest.raises(ss.InputError, match="100 or more finite angles"):
        ss.dynamics.rotation_number(np.zeros((200, 3)))
    assert ss.dynamics.zero_one_test(np.full(300, 0.7)).kind == "regular"
