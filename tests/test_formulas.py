"""Single terms of the formulas, each against what the equation in the docstring says of it alone."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

import stickslip as ss

LOAD = 0.7
#: Laws whose force has a viscous term of its own, and arguments of the rest of it: inner states, their rates, memories.
WITH_OIL = {
    "lugre": ((1e-7, 2e-4), ()), "elastoplastic": ((1e-7, 2e-4), ()), "gms": (((1e-7,) * 4, (0.0,) * 4), ((0, 1, 0, 1),)),
}  # fmt: skip


# laws -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", WITH_OIL)
@pytest.mark.parametrize("v", [0.3, -0.3])
def test_the_viscous_term_opposes_motion_in_every_law_that_has_one(name, v):
    """R at v less R at rest, with inner states and their rates held: sigma2 v."""
    law, ((z, zdot), mode) = ss.LAWS[name].example(), WITH_OIL[name]
    assert law.force(v, z, zdot, LOAD, *mode) - law.force(0.0, z, zdot, LOAD, *mode) == pytest.approx(law.sigma2 * v, rel=1e-9)


@pytest.mark.parametrize("name", ["dahl", "lugre", "elastoplastic"])
def test_the_typical_deflection_is_that_of_sliding_fast_on_average_of_both_ways(name):
    """Where the rate vanishes at a speed far above the Stribeck velocity: mu N / sigma0."""
    law = ss.LAWS[name].example()
    ends = [brentq(lambda z, v=v: law.rate(v, z, LOAD), 0.0, 2 * v * law.scale(LOAD) / abs(v), xtol=1e-20) for v in (1.0, -1.0)]
    assert law.scale(LOAD) == pytest.approx(0.5 * (ends[0] - ends[1]), rel=1e-6)


def test_the_typical_deflections_of_elements_are_where_each_slips_on_average_of_both_ways():
    law = ss.GMS.example()
    limits = [
        0.5 * (law.mu_plus + law.mu_minus) * LOAD * share / (part * law.sigma0)
        for part, share in zip(law.stiffness, law.weights, strict=True)
    ]
    assert law.scale(LOAD) == pytest.approx(limits, rel=1e-12)
    for k, z in enumerate(limits):
        here = tuple(z if i == k else 0.0 for i in range(4))
        forward, backward = (law.switches(v, h, LOAD, (0,) * 4)[1 + k][0] for v, h in ((10.0, here), (-10.0, tuple(-x for x in here))))
        assert forward + backward == pytest.approx(0.0, abs=1e-12 * LOAD)


def test_the_typical_deflection_of_the_reset_integrator_is_its_bound_on_average_of_both_ways():
    law = ss.ResetIntegrator.example()
    (_, _, forward), (_, _, backward) = law.switches(0.1, 0.0, LOAD, (0,))[1:]
    assert law.scale(LOAD) == pytest.approx(0.5 * (forward - backward), rel=1e-12)


def test_the_typical_deflection_of_bristles_is_the_mean_force_over_the_stiffness():
    law = ss.Bristle.example()
    assert law.scale(LOAD) == pytest.approx([0.5 * (law.mu_plus + law.mu_minus) * LOAD / law.sigma0] * law.bristles, rel=1e-12)


def test_bristles_draw_by_splitmix64():
    """The published generator's first numbers from seed 0, as its reference implementation gives them."""
    from stickslip.friction.bristle import _mix

    golden = 0x9E3779B97F4A7C15
    assert [_mix(golden * k & (1 << 64) - 1) for k in (1, 2, 3)] == [0xE220A8397B1DCDAF, 0x6E789E6AA1B965F4, 0x06C45D188009454F]


# drives -----------------------------------------------------------------------------------------------------------


def test_a_vertical_vibration_inside_another_adds_to_the_load():
    """m times the second difference of both heights; it would be twice one of them if the inner one were taken for the outer."""
    inner = ss.VerticalVibration(ss.Harmonic(amplitude=5e-4, omega=200.0), amplitude=1e-4, phase=0.3)
    outer = ss.VerticalVibration(inner, amplitude=4e-5, phase=1.1, harmonic=2)
    robot = ss.Robot(body_mass=0.06, inner_mass=0.01, drive=outer, friction=ss.Coulomb(0.2, 0.2))
    t, h = np.linspace(0.0, outer.period, 17), 1e-6
    rise = sum((d.vertical_position(t + h) - 2 * d.vertical_position(t) + d.vertical_position(t - h)) / h**2 for d in (inner, outer))
    assert robot.load(t, 0.0) == pytest.approx(0.07 * 9.81 + 0.01 * rise, abs=1e-5)  # differences: 1e-19 m / h^2 = 1e-7, h^2 omega^4 less
    assert np.ptp(rise) > 4.0 and math.isclose(robot.load(0.0, 0.0), 0.07 * 9.81 + 0.01 * outer.vertical_acceleration(0.0))


# found by mutants that no other test noticed ------------------------------------------------------------------------


@pytest.mark.parametrize(
    "law", [ss.Stribeck(0.1, 0.2, f_plus=None, f_minus=None, v_s=1e-3), ss.Stribeck(0.1, 0.2, f_plus=0.3, f_minus=0.4, v_s=1e-3)]
)
def test_rest_bears_the_static_friction_of_each_side(law):
    forward, backward = (0.1, 0.2) if law.f_plus is None else (0.3, 0.4)
    assert law.breakaway(LOAD) == pytest.approx((-backward * LOAD, forward * LOAD), rel=1e-15)


def test_bristles_that_slide_have_the_friction_of_their_side():
    law = ss.LuGre(0.1, 0.2, f_plus=0.3, f_minus=0.4, sigma0=1e5, sigma1=1.0, sigma2=0.0, v_s=1e-3)
    assert [law.coefficient(v) for v in (1.0, -1.0, 1e-12, -1e-12)] == pytest.approx([0.1, 0.2, 0.3, 0.4], rel=1e-9)


@pytest.mark.parametrize(("u1", "u2"), [(0.02, 0.05), (0.05, 0.02)])
def test_the_scale_of_two_phases_is_the_faster_one(u1, u2):
    assert ss.TwoPhase.example().replace({"u1": u1, "u2": u2}).velocity_scale == 0.05


@pytest.mark.parametrize("phase", [0.0, math.pi])
def test_the_energy_of_a_drive_that_is_faster_one_way_is_that_of_the_faster(phase):
    drive = ss.MultiHarmonic(amplitudes=(1e-4, 5e-5), omega=200.0, phases=(0.0, phase))
    speeds = drive.velocity(np.linspace(0.0, drive.period, 20_001))
    assert abs(speeds.max() + speeds.min()) > 0.1 * speeds.max()
    assert drive.specific_energy == pytest.approx(0.5 * max(speeds.max(), -speeds.min()) ** 2, rel=1e-6)


def test_the_drive_force_is_what_the_inner_mass_does_to_the_body():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb")
    run = ss.solve(robot, periods=1, settle=0, method="dop853")
    assert run.drive_force == pytest.approx(-robot.inner_mass * robot.drive.acceleration(run.t), rel=1e-12)
