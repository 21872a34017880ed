"""The published rows and the closed ones as periodic orbits: mean velocity, multipliers against differences, and analytic products."""

from __future__ import annotations

import math

import numpy as np
import pytest

import stickslip as ss
from problems import LUGRE, lugre, velocity_unit
from rows import each_row

UNIT = 1e-3 * 0.1 * 100.0  # A mu omega of `dimensionless` [m/s]
#: Mean velocity of the Coulomb runs [m/s], to the digits printed, and their type: P1 to P4, P6, P7.
COULOMB = {
    "P1": (dict(tilt_deg=1.7, amplitude=0.5525e-3), "I", 0.002014682),
    "P2": (dict(tilt_deg=2.7, amplitude=0.6032e-3), "III", 0.003827101),
    "P3": (dict(tilt_deg=4.7, amplitude=0.4564e-3), "II", 0.004000482),
    "P4": (dict(tilt_deg=5.7, amplitude=1.487e-3), "IV", 0.028688951),
    "P6 3e-4": (dict(tilt_deg=1.7, amplitude=3e-4), "II", 0.0000788583268),
    "P6 4e-4": (dict(tilt_deg=1.7, amplitude=4e-4), "I", 0.000900404579),
    "P6 5e-4": (dict(tilt_deg=1.7, amplitude=5e-4), "I", 0.001686424),
    "P6 6e-4": (dict(tilt_deg=1.7, amplitude=6e-4), "III", 0.002358779),
    "P6 8e-4": (dict(tilt_deg=1.7, amplitude=8e-4), "IV", 0.004308808),
    "P7 30": (dict(tilt_deg=1.7, amplitude=6e-4, omega=30 * math.pi), "rest", 0.0),
    "P7 46": (dict(tilt_deg=1.7, amplitude=6e-4, omega=46 * math.pi), "II", 9.32985561e-5),
    "P7 52": (dict(tilt_deg=1.7, amplitude=6e-4, omega=52 * math.pi), "I", 8.833235983e-4),
    "P7 65": (dict(tilt_deg=1.7, amplitude=6e-4, omega=65 * math.pi), "III", 2.311296e-3),
    "P7 80": (dict(tilt_deg=1.7, amplitude=6e-4, omega=80 * math.pi), "IV", 4.209963e-3),
}
FAST = ["P1", "P4", "P6 5e-4", "P7 30", "P8 .04", "P8 .05", "P10 1.7"]


def rows(names, fast):
    """Every row; those that are not fast only where slow tests are asked for."""
    return [pytest.param(name, marks=() if name in fast else pytest.mark.slow) for name in names]


def dimensionless(plus, minus, held_plus=None, held_minus=None):
    """A robot with these kinetic (and static) numbers alpha: A = 1 mm, omega = 100 rad/s, mass ratio 0.1."""
    c = UNIT * 100.0 / 10.0
    held = {} if held_plus is None else dict(f_plus=held_plus * c, f_minus=held_minus * c)
    return ss.Robot(0.09, 0.01, ss.Harmonic(amplitude=1e-3, omega=100.0), ss.Coulomb(plus * c, minus * c, **held), gravity=10.0)


@each_row("name", COULOMB)
def test_coulomb_rows_as_orbits(name):
    given, kind, mean = COULOMB[name]
    robot = ss.presets.piezo_rig(law="coulomb", **given)
    orbit = ss.periodic_orbit(robot)
    digits = 1e-9 if mean > 1e-3 else 1e-12  # the last one printed
    assert orbit.type == kind and orbit.mean_velocity == pytest.approx(mean, abs=digits)
    assert orbit.mean_velocity == pytest.approx(ss.mean_velocity(ss.solve(robot, periods=200)), abs=1e-10 * velocity_unit(robot))
    np.testing.assert_allclose(orbit.multipliers, orbit.differences.real, atol=1e-6)
    assert (kind == "IV") == bool(orbit.multipliers[0] != 0.0), "only what never rests remembers its velocity"


def test_a_tiny_drive_swings_the_bristles():
    """P5: amplitude and multipliers of the linear oscillator on the bristle's spring and dampers."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=1e-6)
    orbit, law = ss.periodic_orbit(robot), robot.friction
    assert orbit.type == "presliding" and orbit.stable and abs(orbit.mean_velocity) < 1e-8 * velocity_unit(robot)
    assert np.ptp(orbit.run.v) / 2 / robot.velocity_scale == pytest.approx(0.001006788, rel=1e-3)
    shrinks = math.exp(-(law.sigma1 + law.sigma2) * robot.period / robot.total_mass)
    assert float(np.prod(orbit.multipliers).real) == pytest.approx(shrinks, rel=0.05)
    np.testing.assert_allclose(orbit.multipliers, orbit.differences, atol=1e-6)


@pytest.mark.parametrize("name", rows(LUGRE, FAST))
def test_lugre_rows_as_orbits(name):
    """Tolerances of the published numbers; and the same orbit at another rtol, to ten digits."""
    robot, period = lugre(name), 2 if name == "P8 .04" else 1
    orbit = ss.periodic_orbit(robot, period=period)
    unit = velocity_unit(robot)
    assert orbit.stable and orbit.residual < 1e-12
    assert orbit.mean_velocity == pytest.approx(LUGRE[name][1], rel=1e-6, abs=5e-8 * unit)
    again = ss.periodic_orbit(robot, period=period, guess=orbit, rtol=1e-11)
    assert again.mean_velocity == pytest.approx(orbit.mean_velocity, abs=3e-9 * unit), "runs at rtol 1e-10 and 1e-11"
    np.testing.assert_allclose(np.sort(np.real(orbit.multipliers)), np.sort(orbit.differences.real), atol=1e-6)


def test_static_friction_above_the_kinetic_one():
    """T11: kinetic (.5, 1.2), static (.8, 1.4)."""
    orbit = ss.periodic_orbit(dimensionless(0.5, 1.2, 0.8, 1.4))
    assert orbit.type == "II" and orbit.mean_velocity / UNIT == pytest.approx(0.170822286993, abs=1e-10)
    assert orbit.multipliers.tolist() == [0.0] and abs(orbit.differences[0]) < 1e-6


@each_row("alphas", [(1.0, 1.0), (1.0, 1.7), (3.0, 2.0)])
def test_rest_is_an_orbit(alphas):
    """T1: rest if and only if both are 1 or more."""
    orbit = ss.periodic_orbit(dimensionless(*alphas))
    assert orbit.type == "rest" and orbit.state.tolist() == [0.0] and orbit.mean_velocity == 0.0


@pytest.mark.slow
def test_viscous_friction_alone_goes_nowhere():
    """T12, and the multiplier of a linear flow: exp(-sigma T / total mass)."""
    robot = ss.Robot(0.09, 0.01, ss.Harmonic(amplitude=1e-3, omega=100.0), ss.Viscous(0.6, 0.6), gravity=10.0)
    orbit = ss.periodic_orbit(robot)
    assert abs(orbit.mean_velocity) < 1e-12 * UNIT
    assert float(orbit.multipliers[0]) == pytest.approx(math.exp(-0.6 * robot.period / 0.1), rel=1e-9)


def test_the_product_of_a_linear_oscillators_multipliers():
    """Without rest the reversals of Coulomb friction shrink areas by (q - F)/(q + F), the damping by exp(-c T / m)."""
    bench = ss.ForcedOscillator(mass=1.0, stiffness=1.0, damping=0.1, force=1.0, omega=0.7, friction=ss.Coulomb(0.2, 0.2))
    orbit = ss.periodic_orbit(bench, guess=dict(x=1.0, v=-1.0))
    assert [event.kind for event in orbit.events] == ["reversal", "reversal"]
    expected = math.exp(-0.1 * bench.period)
    for event in orbit.events:
        x = float(orbit.run.at(event.t)["x"])
        offered = math.sin(0.7 * event.t) - x
        expected *= (offered - 0.2 * event.after) / (offered - 0.2 * event.before)
    assert float(np.prod(orbit.multipliers).real) == pytest.approx(expected, abs=1e-9)
    np.testing.assert_allclose(np.sort_complex(orbit.multipliers), np.sort_complex(orbit.differences), atol=1e-6)
