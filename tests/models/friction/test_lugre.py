"""LuGre robots: the paper's runs, the dimensionless form, convergence, energy, far from the paper's point."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from problems import LUGRE, lugre, paper_batch, random_robots, velocity_unit
from rows import each_row
from stickslip.engine.tableaux import TABLEAUX


@pytest.fixture(scope="module")
def tight():
    """Every row at rtol 1e-10, as runs that keep their trajectory."""
    return {name: ss.solve(lugre(name), periods=200, rtol=1e-10) for name in LUGRE}


def test_the_truth_table_holds(tight):
    """1e-6 relative plus 5e-8 A mu omega: half a unit of the last digit that the table prints, and its own error."""
    for name, (_, V) in LUGRE.items():
        assert ss.mean_velocity(tight[name]) == pytest.approx(V, rel=1e-6, abs=5e-8 * velocity_unit(lugre(name))), name


@each_row("name", LUGRE)
def test_default_tolerance_gives_six_digits(name, tight):
    V, exact = ss.mean_velocity(ss.solve(lugre(name))), ss.mean_velocity(tight[name])
    assert abs(V - exact) <= 1e-6 * max(abs(exact), 0.05 * velocity_unit(lugre(name)))


@each_row("name", LUGRE)
def test_rtol_1e8_gives_six_digits_of_v_itself(name, tight):
    V, exact = ss.mean_velocity(ss.solve(lugre(name), rtol=1e-8)), ss.mean_velocity(tight[name])
    assert abs(V - exact) <= 1e-6 * abs(exact) + 1e-13 * velocity_unit(lugre(name))


def test_tiny_drive_oscillates_before_sliding():
    """P5: at A = 1e-6 m the linear oscillator's answer mu/sqrt((a-1)^2+(b+c)^2), to 1e-3."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=1e-6)
    form = ss.analysis.dimensionless(robot)
    expected = form.mu / np.hypot(form.friction.a - 1, form.friction.b + form.friction.c)
    assert expected == pytest.approx(0.001006788, rel=1e-6)
    run = ss.solve(robot)
    last = run.v[-400:]
    assert (last.max() - last.min()) / 2 / robot.velocity_scale == pytest.approx(expected, rel=1e-3)
    assert ss.motion(run).type == "presliding"


def test_period_two_at_small_kinetic_friction():
    batch = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, mu0=np.array([0.03, 0.04, 0.05, 0.10, 0.21]))
    assert ss.solve(batch, keep="summary").period.tolist() == [1, 2, 1, 1, 1]


def test_dimensionless_form_is_the_same_robot():
    """Eq. 5.1 integrated as printed (with the right k3) gives the dimensional runs to 1e-9."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=np.array([3e-4, 4e-4, 5e-4, 6e-4, 8e-4]))
    scale = np.asarray(robot.velocity_scale)
    one, other = ss.solve(robot, rtol=1e-10), ss.solve(ss.analysis.dimensionless(robot), rtol=1e-10)
    assert np.abs(other.mean_velocity * scale - one.mean_velocity).max() <= 1e-9 * scale.max() * robot.mass_ratio


@each_row("name", [n for n in LUGRE if "P10" not in n])
def test_every_folded_row_agrees_in_dimensionless_form(name, tight):
    robot = lugre(name)
    V = ss.mean_velocity(ss.solve(ss.analysis.dimensionless(robot), rtol=1e-10)) * robot.velocity_scale
    assert pytest.approx(ss.mean_velocity(tight[name]), rel=1e-9, abs=1e-10 * velocity_unit(robot)) == V


@pytest.mark.parametrize(("method", "order"), [(name, tableau.order) for name, tableau in TABLEAUX.items()])
def test_worst_error_falls_with_the_declared_order_across_reversals(method, order):
    """Error against number of steps over 64 robots that all reverse: the kink at v = 0 costs no order."""
    robots = paper_batch(64)
    exact = ss.solve(robots, periods=12, settle=6, rtol=1e-12, method="rodas5p").mean_velocity
    errors, steps = [], []
    for rtol in (1e-6, 1e-7, 1e-8):
        one = ss.solve(robots.replace({"drive.amplitude": 6e-4}), periods=12, settle=6, rtol=rtol, method=method, keep="trajectory")
        many = ss.solve(robots, periods=12, settle=6, rtol=rtol, method=method)
        errors.append(np.median(abs(many.mean_velocity / exact - 1)))
        steps.append(one.counts["steps"])
    observed = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert observed == pytest.approx(order, abs=0.5)


@pytest.mark.parametrize("rtol", [1e-4, 1e-6])
@pytest.mark.parametrize("mu0", [0.18, 0.03])
def test_no_outliers(rtol, mu0):
    """The worst of 512 amplitudes stays within 3 rtol."""
    robots = paper_batch(512, mu0)
    exact = ss.solve(robots, periods=30, settle=20, rtol=1e-10).mean_velocity
    assert np.abs(ss.solve(robots, periods=30, settle=20, rtol=rtol).mean_velocity / exact - 1).max() <= 3 * rtol


def test_gravity_on_the_incline_is_another_model_than_the_folded_one():
    """P10: V differs by 2 to 7 per cent."""
    for tilt, amplitude in ((1.7, 0.553e-3), (2.7, 0.6032e-3), (4.7, 0.4564e-3), (5.7, 1.487e-3)):
        folded, gravity = (
            ss.solve(ss.presets.piezo_rig(tilt_deg=tilt, amplitude=amplitude, incline=incline), keep="summary").mean_velocity
            for incline in ("folded", "gravity")
        )
        assert 0.015 < gravity / folded - 1 < 0.075


@pytest.mark.slow
def test_ten_thousand_robots_far_from_the_paper():
    """All are solved; the error of the default tolerance stays small except where motion is chaotic or still settling."""
    robots = random_robots(10_000)
    exact, found = (ss.solve(robots, periods=30, settle=20, rtol=rtol) for rtol in (1e-10, 1e-6))
    assert set(found.status_counts) == {"finished"}
    error = abs(found.mean_velocity - exact.mean_velocity) / np.maximum(
        abs(exact.mean_velocity), 0.05 * robots.velocity_scale * robots.mass_ratio
    )
    assert np.quantile(error, 0.5) < 1e-6
    assert np.quantile(error, 0.99) < 1e-5
    assert error.max() < 1e-3


@each_row("name", ["P1", "P2", "P3", "P4", "P6 4e-4", "P6 8e-4", "P8 .05", "P8 .10", "P8 .21", "P10 1.7"])
def test_energy_closes_to_1e6_by_default(name):
    """Work of the drive and of gravity, less friction's, is the change of kinetic energy; per period, relative to the drive's work."""
    assert ss.energy(ss.solve(lugre(name))).worst <= 1e-6


@each_row("name", ["P8 .03", "P8 .04"])
def test_energy_residual_of_stiff_robots_falls_with_the_tolerance(name):
    """An error per step of rtol over N steps, N growing as rtol^(-1/5): the residual falls nearly like rtol, at least as rtol^(4/5)."""
    worst = [ss.energy(ss.solve(lugre(name), periods=40, rtol=rtol)).worst for rtol in (1e-5, 1e-7)]
    assert worst[1] <= worst[0] * 100**-0.7
