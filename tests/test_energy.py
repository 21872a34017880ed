"""Energy per period."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from runs import coulomb_run, lugre_run, unit_robot
from stickslip.analysis.steady import velocity_range

ALPHAS = [(0.5, 1.2), (0.7, 0.9), (0.4, 0.8), (0.4, 0.5)]


@pytest.mark.parametrize("alphas", ALPHAS)
def test_exact_runs_balance_to_rounding(alphas):
    """Rounding of omega t at 200 periods is 1e-13 of the phase: 1e-12 leaves a factor for cancellation."""
    assert ss.energy(coulomb_run(unit_robot(*alphas), 200)).worst < 1e-12


@pytest.mark.parametrize("alphas", ALPHAS)
def test_friction_takes_its_force_times_the_way(alphas):
    """W_f = mu+ N s+ + mu- N s-, with the ways forwards and backwards taken from the positions at the events."""
    run = coulomb_run(unit_robot(*alphas), 10)
    x = run.at(np.unique(np.concatenate([run.strobe_times, run.pieces.t])))["x"]
    steps, (plus, minus), load = np.diff(x), alphas, run.model.load(0, 0)
    taken = load * (plus * steps[steps > 0].sum() - minus * steps[steps < 0].sum())
    assert ss.energy(run).friction.sum() == pytest.approx(taken, rel=1e-13)


def test_with_true_gravity_its_work_enters():
    robot = ss.presets.piezo_rig(tilt_deg=2.7, amplitude=6.032e-4, law="coulomb", incline="gravity")
    run = coulomb_run(robot, 40)
    e = ss.energy(run)
    fall = robot.total_mass * 9.81 * np.sin(np.radians(2.7)) * np.diff(run.strobe_x)
    assert e.gravity == pytest.approx(fall, rel=1e-12) and e.worst < 1e-12


def test_in_periodic_motion_the_actuator_pays_for_friction():
    """Level track: over a period no energy is stored, so the actuator's work is what friction takes."""
    e = ss.energy(coulomb_run(unit_robot(0.7, 0.9), 20))
    assert e.actuator[-1] == pytest.approx(e.friction[-1], rel=1e-12)
    assert abs(e.kinetic[-1]) < 1e-12


def test_a_robot_at_rest_spends_nothing():
    e = ss.energy(coulomb_run(unit_robot(1.1, 1.2), 3))
    assert e.drive.tolist() == e.friction.tolist() == e.residual.tolist() == [0, 0, 0]


def test_a_dynamic_run_balances_to_its_tolerance():
    """Radau at rtol 1e-6; its cubic dense output is a little worse than its nodes."""
    run = lugre_run(ss.presets.piezo_rig(tilt_deg=2.7, amplitude=6.032e-4), 3, rtol=1e-6)
    e = ss.energy(run)
    assert e.worst < 1e-6 and (e.friction > 0).all()


@pytest.mark.parametrize(
    "law", [ss.Coulomb(0.18, 0.18), ss.LuGre(0.18, 0.18, 0.21, 0.21, 4e5, 100.0, 0.04, 2e-3)], ids=["coulomb", "lugre"]
)
def test_the_numbers_of_a_body_that_slides_by_itself_fit_together(law):
    """Its mean velocity lies within its velocities, its balance is judged by the work of gravity, and a note says why it is not steady."""
    robot = ss.presets.piezo_rig(tilt_deg=3, amplitude=7e-4, incline="gravity").replace(friction=law)
    assert robot.notes == [note for note in robot.notes if "slides by itself" not in note]
    run = ss.solve(robot.replace({"track.tilt": 1.0}), periods=30)
    low, high = velocity_range(run)
    e = ss.energy(run)
    missing = e.drive + e.gravity - e.friction - e.kinetic
    assert low < ss.mean_velocity(run) < high and (abs(e.gravity) > abs(e.drive)).all()
    assert e.worst == abs(missing / e.gravity)[run.settle :].max() and e.worst < 1e-4
    assert any("slides by itself" in note and "1.557 of the load" in note for note in run.notes)
    assert any("slides by itself" in note for note in robot.replace({"track.tilt": -1.0}).notes)
    assert any("slides by itself" in note for note in robot.replace({"track.tilt": np.array([0.0, 1.0])}).notes)
