"""Several inner masses in one robot: their common centre of mass is what the body feels of them."""

from __future__ import annotations

import math

import numpy as np
import pytest

import stickslip as ss
from rows import each_row

OMEGA, M, g = 200.0, 0.05, 9.81
FRICTION = ss.Coulomb(mu_plus=0.15, mu_minus=0.2)


def dimensionless(alpha, phi, law=None, a1=1.0, a2=1.0):
    """w' = a1 sin tau + a2 sin(2 tau + phi) - r(w) as two inner masses: omega 1, all masses together 1, gravity 1."""
    m1, m2 = 0.1, 0.3
    drives = ss.Harmonic(a1 / m1, omega=1.0), ss.Harmonic(a2 / (4 * m2), omega=2.0, phase=phi)
    return ss.Robot(0.6, (m1, m2), drives, law or ss.Coulomb(alpha, alpha), gravity=1.0)


def as_one(robot):
    """The same robot with one inner mass that has two harmonics."""
    (m1, m2), (first, second) = robot.inner_mass, robot.drive
    m = m1 + m2
    drive = ss.MultiHarmonic(first.omega, (m1 / m * first.amplitude, m2 / m * second.amplitude), (0.0, second.phase))
    return robot.replace(inner_mass=m, drive=drive)


# 6e-14 is rounding of a run of 60 periods; the numbers are given to 12 digits
@each_row("alpha, known", [(0.3, -0.293377298877835), (0.05, -0.493831497249273)])
def test_two_masses_have_the_mean_velocity_that_is_known(alpha, known):
    robot = dimensionless(alpha, 0.0)
    run = ss.solve(robot, periods=400 if alpha < 0.1 else 60)
    assert ss.mean_velocity(run) == pytest.approx(known, rel=1e-12)
    if alpha == 0.3:
        few = [ss.solve(robot, periods=12, **how) for how in ({}, {"method": "dop853", "rtol": 1e-12})]
        assert ss.mean_velocity(few[0]) == pytest.approx(ss.mean_velocity(few[1]), rel=1e-10)


def test_two_masses_slip_and_stick_when_independent_codes_say():
    run = ss.solve(dimensionless(0.3, 0.0), periods=60)
    last = [(event.t / run.period_time - 59, event.after) for event in run.events if event.t > 59 * run.period_time]
    assert [t for t, _ in last] == pytest.approx([0.1733571103, 0.6654870957, 0.6947070919], abs=1e-10)
    assert [after for _, after in last] == [1, 0, -1]


@pytest.mark.slow  # a kernel of its own
@pytest.mark.parametrize(("a1", "a2", "phi", "ratio"), [(1.0, 1.0, 0.0, 1.0), (1.0, 1.0, 0.7, 2.0), (1.0, 0.5, -2.0, 1.5)])
def test_of_little_friction_the_velocity_is_a_quantile_of_the_vibration(a1, a2, phi, ratio):
    """Averaging: friction balances where -V is the quantile of -a1 cos t - a2/2 cos(2t + phi) at mu+/(mu+ + mu-), of any drive.

    Three sizes of friction extrapolated to none, with a remainder of the third order: 8 alpha^3 = 8e-6 times what is about one.
    """
    alphas = np.array([0.04, 0.02, 0.01])
    found = [ss.periodic_orbit(dimensionless(0.3, phi, ss.Coulomb(a, a * ratio), a1, a2)).mean_velocity for a in alphas]
    t = 2 * math.pi * (np.arange(100_000) + 0.5) / 100_000
    limit = -np.quantile(-a1 * np.cos(t) - 0.5 * a2 * np.cos(2 * t + phi), 1 / (1 + ratio))
    assert np.polyval(np.polyfit(alphas, found, 2), 0.0) == pytest.approx(limit, abs=1e-4)


@pytest.mark.parametrize("phi", [0.0, 0.7, -2.0])
def test_two_masses_are_one_mass_with_two_harmonics(phi):
    robot = dimensionless(0.3, phi)
    runs = [ss.solve(each, periods=60) for each in (robot, as_one(robot))]
    assert ss.mean_velocity(runs[0]) == pytest.approx(ss.mean_velocity(runs[1]), rel=1e-12)
    assert [event.kind for event in runs[0].events] == [event.kind for event in runs[1].events]
    t = np.linspace(0.0, runs[0].pieces.t[-1], 50)
    for name in ("x", "v", "friction_force", "xi", "xi_rate", "drive_force"):
        a, b = (run.at(t)[name] for run in runs)
        assert a == pytest.approx(b, abs=1e-12 * max(1.0, np.max(abs(b)))), name


def test_lanes_of_two_masses_under_a_law_with_inner_states_are_one_mass_with_two_harmonics():
    law = ss.LuGre(mu_plus=0.3, mu_minus=0.3, sigma0=30.0, sigma1=1.0, sigma2=0.01, f_plus=0.4, f_minus=0.4, v_s=0.1)
    robot = dimensionless(0.3, np.array([0.0, 0.7]), law)
    found = [ss.mean_velocity(ss.solve(each, periods=40, settle=20, rtol=1e-9)) for each in (robot, as_one(robot))]
    assert found[0] == pytest.approx(found[1], rel=1e-7)


def test_the_common_period_is_the_smallest():
    def of(*omegas):
        drives = tuple(ss.Harmonic(1e-4, omega=w) for w in omegas)
        return ss.Robot(M, (0.01,) * len(omegas), drives, FRICTION)

    assert of(200.0, 200.0).cycles == (1, 1)
    assert of(200.0, 300.0).cycles == (2, 3)
    assert of(300.0, 200.0, 500.0).period == pytest.approx(2 * math.pi / 100.0, rel=1e-15)
    assert of(200.0, 300.0).replace({"drive.1.omega": 400.0}).cycles == (1, 2)


def test_a_robot_with_several_masses_is_kept_by_a_study_file():
    robot = dimensionless(0.3, 0.7)
    assert ss.Robot.from_toml(robot.to_toml()) == robot
    assert "cycles" not in robot.to_toml()


PIECES = {
    "in pieces": (ss.drives.TwoPhase(stroke=1e-3, u1=0.05, u2=0.2), ss.drives.BangBang(a1=20.0, a2=60.0, period=0.0125)),
    "jumps at one instant": (
        ss.drives.Sawtooth(stroke=1e-3, rise=0.02, fall=0.005),
        ss.drives.Sawtooth(stroke=5e-4, rise=0.002, fall=0.0105),
    ),
}


@pytest.mark.parametrize("drives", PIECES.values(), ids=PIECES)
def test_drives_in_pieces_repeat_within_the_common_period(drives):
    robot = ss.Robot(M, (0.01, 0.005), drives, FRICTION)
    assert robot.cycles == (1, 2)
    exact, judged = ss.solve(robot, periods=20), ss.solve(robot, periods=20, method="dop853", rtol=1e-11)
    # the judge's tolerance of a step, over some hundred steps in a period
    assert ss.mean_velocity(exact) == pytest.approx(ss.mean_velocity(judged), rel=1e-8)
    assert ss.energy(exact).worst < 1e-11


def test_a_rotor_presses_as_it_turns():
    """An unbalanced rotor moves along and across: xi = A sin, eta = A cos; beside it a mass that moves along only."""
    A = 2e-4
    rotor = ss.drives.VerticalVibration(ss.Harmonic(A, omega=OMEGA), amplitude=A, phase=0.5 * math.pi)
    robot = ss.Robot(M, (0.01, 0.02), (rotor, ss.Harmonic(1e-4, omega=2 * OMEGA, phase=0.3)), ss.Coulomb(0.2, 0.2))
    for t in (0.0, 0.003, 0.011):
        load = 0.08 * g - 0.01 * A * OMEGA**2 * math.cos(OMEGA * t)
        assert robot.load(t, 0.0) == pytest.approx(load, rel=1e-14)
    runs = [ss.solve(robot, periods=10, method=method, rtol=1e-11) for method in ("exact", "dop853")]
    assert ss.mean_velocity(runs[0]) == pytest.approx(ss.mean_velocity(runs[1]), rel=1e-8)
    assert abs(ss.mean_velocity(runs[0])) > 1e-4


def test_what_the_actuators_give_is_what_the_inner_masses_and_friction_take():
    """Over a whole motion period kinetic energies come back: the actuators' work is that of friction, less gravity's."""
    run = ss.solve(dimensionless(0.3, 0.7), periods=60)
    balance = ss.energy(run)
    assert balance.worst < 1e-12
    assert balance.actuator[-1] == pytest.approx(balance.friction[-1], rel=1e-10)


def test_the_mirror_image_of_two_masses_moves_the_other_way():
    robot = dimensionless(0.3, 0.7, ss.Coulomb(0.3, 0.4))
    assert ss.dynamics.mirrored(ss.dynamics.mirrored(robot)) == robot
    there, back = (ss.mean_velocity(ss.solve(each, periods=60)) for each in (robot, ss.dynamics.mirrored(robot)))
    assert back == pytest.approx(-there, rel=1e-12)


def test_a_phase_is_a_start_at_another_instant():
    wave, ahead = ss.Harmonic(1e-3, omega=OMEGA), ss.Harmonic(1e-3, omega=OMEGA, phase=0.7)
    t = np.linspace(0.0, 0.1, 30)
    for what in ("position", "velocity", "acceleration"):
        size = abs(getattr(wave, what)(t)).max()
        assert getattr(ahead, what)(t) == pytest.approx(getattr(wave, what)(t + 0.7 / OMEGA), abs=1e-14 * size)


def test_without_a_phase_that_turns_it_a_harmonic_drive_keeps_its_closed_arcs():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb")
    turned = robot.replace({"drive.phase": 0.0})
    assert ss.mean_velocity(ss.solve(turned, periods=40)) == pytest.approx(ss.mean_velocity(ss.solve(robot, periods=40)), rel=1e-14)


def test_a_sweep_of_the_phase_between_two_masses_has_its_best_value():
    """Small friction, equal both ways: w = -(a2/2) cos(phi) for a1 >= a2, so that the best phase is pi."""
    found = ss.sweep(dimensionless(0.05, 0.0), **{"drive.1.phase": np.linspace(0.0, 2 * math.pi, 9)}, periods=400, settle=200)
    assert int(np.argmax(found.mean_velocity.values)) == 4
    assert float(found.mean_velocity[4]) == pytest.approx(0.493831497249273, rel=1e-9)


def test_a_report_draws_every_inner_mass():
    from stickslip.show.reports.moving import moments

    found = moments(ss.solve(dimensionless(0.3, 0.7), periods=20))
    assert [body["name"] for body in found["bodies"]] == ["body", "inner mass 1", "inner mass 2"]
    assert [body["mass"] for body in found["bodies"]] == pytest.approx([0.6, 0.1, 0.3])


@each_row(
    ("changes", "says"),
    [
        (dict(drive=[ss.Harmonic(1e-4, omega=200.0)]), "this is a list, and several inner masses are given as a tuple"),
        (dict(inner_mass=[0.1, 0.2]), "is a list; a tuple means one for each part, an array means cases"),
        (dict(inner_mass=0.1), "inner_mass is one and drive is a tuple of 2"),
        (dict(drive=ss.Harmonic(1e-4, omega=200.0)), "inner_mass is a tuple of 2 and drive is one"),
        (dict(drive=()), "inner_mass is a tuple of 2 and drive is a tuple of 0"),
        (dict(drive=(ss.Harmonic(1e-4, omega=200.0), ss.Harmonic(1e-4, omega=283.0))), "no common period of at most 64"),
        (dict(drive=(ss.Harmonic(1e-4, omega=200.0), ss.Harmonic(1e-4, omega=np.array([200.0, 400.0])))), "the same ones for all cases"),
    ],
)  # fmt: skip
def test_what_are_no_several_inner_masses_is_said(changes, says):
    with pytest.raises(ss.InputError, match=says):
        dimensionless(0.3, 0.0).replace(**changes)
