"""The mechanisms, and the drives that jump, by compiled arcs against the closed forms of their literature: to machine precision."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.analysis.oscillators import belt_period, den_hartog_amplitude
from stickslip.analysis.phases import three_phase, two_phase

STATIC = ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)
belt = ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=STATIC)
pull = ss.PulledMass(mass=1.0, stiffness=2.0, speed=0.1, friction=STATIC)


def oscillator(friction, **numbers):
    given = {"mass": 1.0, "stiffness": 1.0, "damping": 0.0, "force": 1.0, "omega": 0.7, **numbers}
    return ss.ForcedOscillator(friction=ss.Coulomb(friction, friction, friction, friction), **given)


def exact(model, **arguments):
    run = ss.solve(model, **arguments)
    assert run.method == "exact" and run.counts["rejected"] == 0
    return run


def turning_points(run):
    return np.array([float(run.at(e.t)["x"]) for e in run.events])


@pytest.mark.parametrize(("ratio", "friction"), [(0.7, 0.3), (0.9, 0.6), (1.7, 0.3)])
def test_the_forced_oscillator_has_den_hartogs_amplitude(ratio, friction):
    """O1, Den Hartog 1930. Friction alone brings a transient down, by a factor in each period: after 400 it is below rounding."""
    run = exact(oscillator(friction, omega=ratio), periods=400, samples=4)
    assert abs(turning_points(run)[-2:]) == pytest.approx(den_hartog_amplitude(ratio, friction), rel=1e-13)
    assert {e.kind for e in run.events[-20:]} == {"reversal"} and len([e for e in run.events if e.t > 390 * run.period_time]) == 20


def test_free_decay_loses_two_friction_lengths_in_each_half_swing():
    """O2: F/k = 1 from x = 10.3; a turning point is hit at the square root of what its time lacks, so only rounding of x remains."""
    run = exact(oscillator(1.0, force=0.0, omega=1.0), periods=5, start={"x": 10.3})
    assert turning_points(run) == pytest.approx([-8.3, 6.3, -4.3, 2.3, -0.3], abs=1e-14)
    assert [e.t for e in run.events] == pytest.approx(np.pi * np.arange(1, 6), abs=1e-14)
    assert run.events[-1].kind == "stick" and run.v[-1] == 0.0


@each_row("numbers", [{}, {"mass": 0.3, "stiffness": 40.0, "speed": 0.02}, {"speed": -0.1}])
def test_the_block_on_the_belt_sticks_and_slips_as_long_as_it_should(numbers):
    """O3 for the first: 7.6112592541013 s."""
    bench = belt.replace(**numbers)
    stick, slip = belt_period(bench.mass, bench.stiffness, abs(bench.speed), 1.0, 1.5)
    run = exact(bench, duration=5 * float(stick + slip))
    slips, sticks = ([e.t for e in run.events if e.kind == kind] for kind in ("slip", "stick"))
    assert np.diff(slips) == pytest.approx(stick + slip, rel=1e-13)
    assert [next(t for t in sticks if t > begin) - begin for begin in slips[:3]] == pytest.approx([float(slip)] * 3, rel=1e-12)
    if not numbers:
        assert np.diff(slips) == pytest.approx(7.6112592541013, rel=1e-13)


def test_a_pulled_mass_is_a_block_on_a_belt_seen_from_the_pulled_end():
    """With y = x - u t the belt runs at -u, and a mass at rest rides along."""
    pulled, seen = exact(pull, duration=25.0), exact(belt.replace(speed=-0.1), duration=25.0, start={"v": -0.1})
    t = np.linspace(0.0, 25.0, 301)
    assert pulled.at(t)["x"] - 0.1 * t == pytest.approx(seen.at(t)["x"], abs=1e-13)
    assert [e.t for e in pulled.events] == pytest.approx([e.t for e in seen.events], abs=1e-12) and len(seen.events) > 4


@each_row(("bench", "duration"), [(oscillator(0.3, damping=0.1, bias=0.1, force=2.5), None), (belt, 40.0), (pull, 40.0)])
def test_energy_balances(bench, duration):
    run = exact(bench, **({"periods": 8} if duration is None else {"duration": duration}), start={"x": 0.25, "v": 0.1})
    balance = ss.energy(run)
    assert np.all(balance.friction > 0) and abs(balance.residual).max() < 1e-12


def rig(drive, mu=(0.15, 0.25), ratio=0.1315):
    return ss.Robot(body_mass=1 - ratio, inner_mass=ratio, drive=drive, friction=ss.Coulomb(*mu, *mu))


@each_row(
    ("u1", "u2", "velocity"),
    [(0.1, 0.1, 0.000470057764186), (0.05, 0.4, 0.003305), (0.4, 0.05, None)],
    ids=["rests twice", "slides on", "back"],
)
def test_two_phase_drives_move_as_on_paper(u1, u2, velocity):
    """D1, both phases end at rest; D2, the fast phase ends sliding; and an impulse finds the body where the formula has it."""
    drive = ss.drives.TwoPhase(stroke=0.01, u1=u1, u2=u2)
    run = exact(rig(drive), periods=8)
    assert ss.mean_velocity(run) == pytest.approx(float(two_phase(drive, 0.1315, 0.15, 0.25)), rel=1e-12)
    if velocity is not None:
        assert ss.mean_velocity(run) == pytest.approx(velocity, rel=1e-11)
    jumps = [e.t / drive.period for e in run.events if e.kind == "impulse"]
    assert jumps == pytest.approx(sorted([k + u2 / (u1 + u2) for k in range(8)] + list(range(1, 8))), abs=1e-14)


@each_row("numbers", [(10.0, 60.0, 12.0), (17.0, 90.0, 18.0), (12.0, 1e3, 18.0)])
def test_three_phase_drives_move_as_on_paper(numbers):
    """D3 for the first: 0.015990705704 m/s."""
    drive = ss.drives.ThreePhase(u1=0.3, w1=numbers[0], w2=numbers[1], w3=numbers[2])
    found = ss.mean_velocity(exact(rig(drive), periods=8))
    assert found == pytest.approx(float(three_phase(drive, 0.1315, 0.15, 0.25)), rel=1e-12)
    if numbers[1] == 60.0:
        assert found == pytest.approx(0.015990705704, abs=5e-13)


@pytest.mark.parametrize("damping", [0.0, 1e-6])
def test_a_mass_that_friction_holds_to_rounding_goes_on(damping):
    """Its position is 1e-30 m for a while, which a tolerance relative to it cannot resolve; at rest until k u t reaches static friction."""
    law = ss.friction.Karnopp(mu_plus=4.4e-4, mu_minus=4.4e-4, f_plus=6.9e-4, f_minus=6.9e-4, width=5.9e-4)
    bench = ss.PulledMass(mass=1.72, stiffness=0.788, speed=0.0402, friction=law, load=3.4, damping=damping)
    at = law.f_plus * bench.load / (bench.stiffness * bench.speed)
    assert abs(ss.solve(bench, duration=0.99 * at).x[-1]) < 1e-15
    run, judge = ss.solve(bench, duration=10.0, rtol=1e-9), ss.solve(bench, duration=10.0, method="radau", rtol=1e-10)
    assert run.x[-1] == pytest.approx(judge.x[-1], rel=1e-5)
