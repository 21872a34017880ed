"""The piezo beam: from volts and hertz to the motion of its tip, steady and from rest, and to a robot."""

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import quad, solve_ivp

import stickslip as ss
from rows import each_row
from stickslip.models.drives.oscillator import modal_response, sine_from_rest

BEAM = ss.drives.PiezoBeam()
F1 = float(BEAM.frequencies(1)[0])
RIG = {"voltage": 20.0, "frequency": 32.7, "tilt_deg": 1.7}


def rig(**changes):
    return ss.presets.piezo_beam_rig(**{**RIG, **changes})


# the beam ---------------------------------------------------------------------------------------------------------


def test_the_moment_is_the_stress_of_both_patches_times_its_lever():
    stress = BEAM.patch_modulus * BEAM.d31 / BEAM.patch_thickness  # of a patch that may not stretch, for one volt
    half, top = BEAM.thickness / 2, BEAM.thickness / 2 + BEAM.patch_thickness
    moment = 2 * quad(lambda y: stress * y * BEAM.width, half, top)[0]
    assert BEAM.moment_per_volt == pytest.approx(moment, rel=1e-12)


def test_the_lowest_frequency_is_nearly_that_of_a_spring_with_a_mass():
    # Rayleigh's quotient with the static shape: 33/140 of the beam move with the tip, and the true frequency is a little lower.
    stiffness = 3 * BEAM.bending_stiffness / BEAM.length**3
    estimate = np.sqrt(stiffness / (BEAM.tip_mass + 33 / 140 * BEAM.mass)) / (2 * np.pi)
    assert 0 < estimate / F1 - 1 < 1e-3


def test_eigenvalues_are_those_of_the_tip_mass_ratio():
    assert np.array_equal(BEAM.eigenvalues(3), ss.drives.cantilever_eigenvalues(BEAM.tip_mass_ratio, 3))
    assert len(BEAM.eigenvalues()) == BEAM.modes
    assert ss.drives.PiezoBeam(tip_mass=0.0).eigenvalues(2) == pytest.approx([1.875104069, 4.694091133], abs=1e-9)


def test_a_slow_voltage_bends_the_beam_as_statics_say():
    tip = BEAM.response(50.0, 1e-3 * F1)
    still = BEAM.moment_per_volt * 50.0 * BEAM.patch_length * (BEAM.length - BEAM.patch_length / 2) / BEAM.bending_stiffness
    assert tip.amplitude == pytest.approx(still, rel=2e-5)  # eight modes: 1e-5
    assert tip.phase == pytest.approx(0.0, abs=1e-4)  # 2 zeta f/f1


def test_the_response_is_the_closed_form_where_damping_does_not_matter():
    from stickslip.models.drives.patch_moment import tip_in_closed_form

    beam = BEAM.replace(damping=1e-6, modes=60)
    f = np.array([0.5, 1.5, 5.0, 20.0]) * F1
    b = np.sqrt(2 * np.pi * f / beam.angular_unit)
    closed = tip_in_closed_form(b, beam.tip_mass_ratio, beam.patch_length / beam.length)
    scale = beam.moment_per_volt * beam.length**2 / beam.bending_stiffness
    tip = beam.response(1.0, f)
    assert tip.amplitude * np.cos(tip.phase) == pytest.approx(closed * scale, rel=1e-4)


def test_the_phase_falls_through_a_right_angle_at_the_first_resonance():
    phases = BEAM.response(1.0, F1 * np.array([0.8, 1.0, 1.2])).phase
    assert phases == pytest.approx([-0.0886, -np.pi / 2, -np.pi + 0.1087], abs=5e-3)  # one mode: -atan(2 zeta r/(1 - r^2))


def test_the_amplitude_is_proportional_to_the_voltage_and_a_negative_d31_turns_the_phase():
    one, ten, turned = BEAM.response(1.0, 30.0), BEAM.response(10.0, 30.0), BEAM.replace(d31=-BEAM.d31).response(1.0, 30.0)
    assert ten == pytest.approx((10 * one.amplitude, one.phase), rel=1e-12)
    assert turned.amplitude == one.amplitude and abs(turned.phase - one.phase) == pytest.approx(np.pi)


def test_each_mode_has_its_own_damping():
    f2 = float(BEAM.frequencies(2)[1])
    beam = BEAM.replace(modes=2, damping=(0.02, 0.005))
    both = BEAM.replace(modes=2)
    assert beam.response(1.0, F1).amplitude == pytest.approx(both.response(1.0, F1).amplitude, rel=1e-3)
    assert beam.response(1.0, f2).amplitude == pytest.approx(4 * both.response(1.0, f2).amplitude, rel=0.02)  # 1/zeta, and mode 1


def test_arrays_broadcast_and_labelled_ones_do_so_by_name():
    f = np.array([20.0, 33.0, 50.0])
    many = BEAM.response(10.0, f)
    assert many.amplitude[1] == BEAM.response(10.0, 33.0).amplitude
    lengths = xr.DataArray([0.09, 0.1], dims="length", coords={"length": [0.09, 0.1]})
    grid = BEAM.replace(length=lengths).response(xr.DataArray([10.0, 20.0], dims="voltage"), xr.DataArray(f, dims="frequency"))
    assert dict(grid.amplitude.sizes) == {"voltage": 2, "length": 2, "frequency": 3}
    assert float(grid.phase.sel(length=0.1).isel(voltage=0, frequency=1)) == pytest.approx(BEAM.response(10.0, 33.0).phase, rel=1e-12)
    assert BEAM.replace(length=np.array([0.09, 0.1])).frequencies(3).shape == (2, 3)


# from rest --------------------------------------------------------------------------------------------------------


def integrated(force, t, free, damping):
    def rate(time, y):
        return [y[1], force(time) - 2 * damping * free * y[1] - free**2 * y[0]]

    return solve_ivp(rate, (t[0], t[-1]), [0.0, 0.0], t_eval=t, rtol=1e-11, atol=1e-14, method="DOP853").y[0]


@each_row(("omega", "damping"), [(2.0, 0.0), (2.0, 0.02), (3.0, 0.02), (3.0, 0.7), (20.0, 0.0), (20.0, 0.7)])
def test_a_sine_from_rest_solves_the_equation_of_a_mode(omega, damping):
    t = np.linspace(0.0, 12.0, 97)
    found = sine_from_rest(t, omega, 3.0, damping)
    assert found == pytest.approx(integrated(lambda s: np.sin(omega * s), t, 3.0, damping), abs=1e-9)


def test_a_record_is_exact_between_its_samples():
    t = np.array([0.0, 0.3, 0.31, 1.0, 2.5, 6.0])
    force = np.array([0.0, 1.0, -1.0, 0.5, 0.5, 0.0])
    fine = np.unique(np.concatenate([t, np.linspace(0.0, 6.0, 301)]))
    free, damping = np.array([3.0, 17.0]), np.array([0.02, 0.1])
    coarse = modal_response(t, force, free, damping)
    assert coarse == pytest.approx(modal_response(fine, np.interp(fine, t, force), free, damping)[np.searchsorted(fine, t)], abs=1e-13)
    judge = integrated(lambda s: np.interp(s, t, force), fine, 3.0, 0.02)[np.searchsorted(fine, t)]
    assert coarse[:, 0] == pytest.approx(judge, abs=1e-6)  # the judge steps over the corners


def test_the_transient_becomes_the_steady_response():
    t = np.linspace(0.0, 3.0, 30001)
    u, tip = BEAM.transient(t, 20.0, 32.7), BEAM.response(20.0, 32.7)
    late = t > 2.5  # exp(-zeta omega_1 t) = 3e-5
    assert u[0] == 0.0
    assert u[late] == pytest.approx(tip.amplitude * np.sin(2 * np.pi * 32.7 * t[late] + tip.phase), abs=1e-4 * tip.amplitude)


def test_a_sine_given_as_a_function_is_the_sine():
    t = np.linspace(0.0, 0.5, 20001)
    u = BEAM.transient(t, 20.0, 32.7)
    again = BEAM.transient(t, lambda s: 20.0 * np.sin(2 * np.pi * 32.7 * s))
    assert again == pytest.approx(u, abs=1e-5 * abs(u).max())  # straight lines between samples: (omega h)^2/12


def test_a_constant_voltage_rings_down_to_the_static_deflection():
    t = np.linspace(0.0, 4.0, 4001)
    u = BEAM.transient(t, np.full(t.shape, 60.0))
    assert u[-1] == pytest.approx(BEAM.response(60.0, 1e-3).amplitude, rel=1e-5)
    assert 1.8 < u.max() / u[-1] < 2.1  # a step overshoots to nearly twice


# the drive and the robot ------------------------------------------------------------------------------------------


def test_the_drive_is_the_motion_of_the_tip():
    drive, tip = BEAM.drive(20.0, 32.7), BEAM.response(20.0, 32.7)
    assert isinstance(drive, ss.Harmonic) and drive.amplitude == tip.amplitude and drive.frequency == pytest.approx(32.7)


def test_volts_and_hertz_give_the_robot_of_that_amplitude():
    robot = rig(law="coulomb")
    same = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=robot.drive.amplitude, omega=robot.drive.omega, law="coulomb")
    assert robot.inner_mass == BEAM.tip_mass == same.inner_mass
    assert ss.mean_velocity(ss.solve(robot, periods=50)) == ss.mean_velocity(ss.solve(same, periods=50))


def test_a_frequency_sweep_finds_the_resonances():
    f = np.linspace(20.0, 450.0, 431)
    many = ss.solve(rig(frequency=f, law="coulomb", voltage=30.0), settle="auto")
    assert many.mean_velocity.shape == f.shape
    first, second = f < 200, f > 200
    assert abs(f[first][np.argmax(many.mean_velocity[first])] - F1) <= 1.0
    assert abs(f[second][np.argmax(many.mean_velocity[second])] - BEAM.frequencies(2)[1]) <= 2.0
    assert np.all(many.mean_velocity[(f > 60) & (f < 300)] == 0.0)  # between them the tip hardly moves, and the robot rests


def test_sweeps_take_the_numbers_of_the_beam():
    grid = ss.sweep(ss.presets.piezo_beam_rig, voltage=30.0, frequency=[33.0, 39.0], length=[0.09, 0.1], tilt_deg=1.7, law="coulomb")
    assert dict(grid.sizes) == {"frequency": 2, "length": 2} and grid.length.units == "m"
    one = ss.solve(rig(voltage=30.0, frequency=39.0, length=0.09, law="coulomb"), periods=200, settle=100)
    assert float(grid.mean_velocity.sel(frequency=39.0, length=0.09)) == pytest.approx(ss.mean_velocity(one), rel=1e-6)


def test_a_beam_of_your_own_can_be_given_and_changed():
    beam = ss.drives.PiezoBeam(length=0.12, damping=(0.02, 0.01), modes=2)
    assert rig(beam=beam).drive == beam.drive(20.0, 32.7)
    assert rig(beam=beam, length=0.1).drive == beam.replace(length=0.1).drive(20.0, 32.7)


# remarks ----------------------------------------------------------------------------------------------------------


def remarks(**changes):
    return " | ".join(rig(law="coulomb", **changes).notes)


def test_the_hardware_limits_of_the_paper_are_remarks_with_their_number():
    assert remarks() == BEAM.notes()[0] and "1.53 times as stiff" in remarks()
    assert "outside the 10 to 150 V of the paper's hardware: 5 V" in remarks(voltage=5.0)
    assert "hardware: 160 V" in remarks(voltage=160.0, frequency=20.0)
    assert "not below 5000 Hz" in remarks(frequency=5000.0) and "not below" not in remarks(frequency=4999.0)
    highest = BEAM.frequencies()[-1]
    assert f"above that of the highest mode, {highest:.5g} Hz: take more modes: 15000 Hz" in remarks(frequency=15000.0)


def test_a_large_deflection_is_a_remark_with_its_number():
    assert "slope" not in remarks(voltage=150.0, frequency=F1)
    told = remarks(voltage=150.0, frequency=F1, damping=0.005)
    assert "slope of the beam is above 0.15 rad" in told and "0.4" in told


def test_a_batch_counts_the_cases_of_a_remark():
    assert "5 to 5 V in 1 of 2 cases" in remarks(voltage=np.array([5.0, 50.0]))


def test_remarks_are_saved_with_the_robot_and_dropped_with_the_numbers():
    robot = rig(voltage=5.0, law="coulomb")
    assert ss.Robot.from_toml(robot.to_toml()) == robot and ss.Robot.from_toml(robot.to_toml()).notes == robot.notes
    assert robot.replace({"drive.amplitude": 1e-4}).notes == [] == robot.replace(drive=ss.Harmonic(1e-4, 200.0)).notes


# bad input --------------------------------------------------------------------------------------------------------


@each_row(
    ("make", "parts"),
    [
        (lambda: ss.drives.PiezoBeam(length=-0.1), ("length = -0.1", "positive length")),
        (lambda: ss.drives.PiezoBeam(patch_length=0.2), ("patch_length = 0.2 is more than length = 0.1", "patch_length=0.03")),
        (lambda: ss.drives.PiezoBeam(d31=0.0), ("d31 = 0.0", "other than zero")),
        (lambda: ss.drives.PiezoBeam(damping=0.0), ("damping = 0.0", "above 0 and below 1")),
        (lambda: ss.drives.PiezoBeam(damping=(0.02, 1.5), modes=2), ("damping = (0.02, 1.5)", "above 0 and below 1")),
        (lambda: ss.drives.PiezoBeam(damping=(0.02, 0.01)), ("2 ratios for modes = 8", "modes=2")),
        (lambda: ss.drives.PiezoBeam(damping=[0.02, 0.01]), ("is a list", "modes as a tuple")),
        (lambda: ss.drives.PiezoBeam(modes=0), ("modes = 0", "whole number from 1")),
        (lambda: BEAM.response(-1.0, 10.0), ("voltage = -1.0", "zero or more")),
        (lambda: BEAM.response(1.0, 0.0), ("frequency = 0.0", "positive frequency")),
        (lambda: BEAM.response([1.0, 2.0], [1.0, 2.0, 3.0]), ("do not fit together", "frequency has shape (3,)")),
        (lambda: BEAM.response(xr.DataArray([1.0], dims="a"), np.ones(1)), ("frequency has no names", "DataArray")),
        (lambda: BEAM.transient([0.0, 0.0], 1.0, 10.0), ("t = ", "ascending times")),
        (lambda: BEAM.transient([0.0, 1.0], [1.0, 2.0, 3.0]), ("shape (3,)", "frequency=32.7")),
        (lambda: BEAM.replace(length=np.array([0.1, 0.2])).transient([0.0, 1.0], 1.0, 10.0), ("one beam",)),
        (lambda: rig(beam="steel"), ("beam = 'steel'", "ss.drives.PiezoBeam(length=0.1)")),
    ],
)
def test_bad_input_says_what_to_type(make, parts):
    with pytest.raises(ss.InputError) as caught:
        make()
    missing = [part for part in parts if part not in str(caught.value)]
    assert not missing, f"{missing} not in: {caught.value}"


def test_all_problems_of_a_rig_are_told_at_once():
    with pytest.raises(ss.InputError) as caught:
        rig(voltage=-1.0, frequency="fast", length=-1.0, law="dry")
    assert [p.split()[0].strip(":") for p in caught.value.problems] == ["length", "voltage", "frequency", "law"]
