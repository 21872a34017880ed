"""Friction that varies along the track: patches, waves, measured profiles; and orbits modulo the wavelength."""

from __future__ import annotations

import math

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates

LEVEL = ss.Level()
DRY = ss.Coulomb(mu_plus=0.15, mu_minus=0.2)


def rig(track, friction=DRY, amplitude=6e-4):
    return ss.Robot(0.06, 0.0095, ss.Harmonic(amplitude, omega=205.0), friction, track=track)


TRACKS = {
    "patches": ss.tracks.FrictionPatches(LEVEL, edges=(5e-4, 1.5e-3), factors=(1.0, 0.5, 1.3)),
    "an edge where it starts": ss.tracks.FrictionPatches(LEVEL, edges=(0.0,), factors=(1.0, 0.6)),
    "tiles": ss.tracks.FrictionPatches(LEVEL, edges=(0.0, 1e-3), factors=(1.0, 0.6), wavelength=1.7e-3),
    "three tiles": ss.tracks.FrictionPatches(ss.Incline(-0.01), edges=(-2e-4, 3e-4, 7e-4), factors=(1.0, 0.6, 1.4), wavelength=1.7e-3),
    "wave": ss.tracks.FrictionWave(LEVEL, wavelength=2e-3, cosines=(0.1,), sines=(0.2,)),
    "profile": ss.tracks.FrictionProfile(LEVEL, place=(0.0, 1e-3, 3e-3), factors=(1.0, 1.4, 0.8)),
}
every_track = pytest.mark.parametrize("track", TRACKS.values(), ids=TRACKS)


@every_track
def test_the_exact_solver_goes_as_the_judge_does(track):
    runs = [ss.solve(rig(track), periods=20, method=method, rtol=1e-11) for method in ("exact", "dop853")]
    t = np.linspace(0.0, float(runs[0].pieces.t[-1]), 200)
    x = [run.at(t)["x"] for run in runs]
    assert x[0] == pytest.approx(x[1], abs=1e-9 * np.ptp(x[1]))  # a hundred steps in a period, each to 1e-11
    assert ss.energy(runs[0]).worst < 1e-10
    assert np.ptp(x[0]) > 3e-4  # it has been over more than one edge


def test_two_tracks_of_one_factor_are_one_track():
    patched, plain = (
        ss.solve(rig(track), periods=20) for track in (ss.tracks.FrictionPatches(LEVEL, edges=(1e-3,), factors=(1.0, 1.0)), LEVEL)
    )
    assert ss.mean_velocity(patched) == pytest.approx(ss.mean_velocity(plain), rel=1e-11)


def test_a_body_that_coasts_over_ice_comes_to_rest_where_its_energy_is_spent():
    """Energy: v0^2/2 = mu g (l1 + 0.2 (l2 - l1) + rest), at each edge nothing jumps."""
    track = ss.tracks.FrictionPatches(LEVEL, edges=(0.01, 0.03), factors=(1.0, 0.2, 1.5))
    robot = rig(track, ss.Coulomb(0.2, 0.2), amplitude=0.0)
    way = 0.01 + 0.02 + 0.02
    v0 = math.sqrt(2 * 0.2 * 9.81 * (0.01 + 0.2 * 0.02 + 1.5 * 0.02))
    run = ss.solve(robot, periods=40, start={"v": v0})
    assert float(run.x[-1]) == pytest.approx(way, rel=1e-12)


def test_lanes_under_a_law_with_inner_states_go_as_single_runs_do():
    robot = rig(TRACKS["tiles"], ss.LuGre(0.15, 0.2, sigma0=2e4, sigma1=20.0, sigma2=0.0, f_plus=0.18, f_minus=0.24, v_s=2e-3))
    many = ss.solve(robot.replace({"drive.amplitude": np.array([5e-4, 6e-4])}), periods=3, settle=0, rtol=1e-9)
    one = ss.solve(robot, periods=3, settle=0, rtol=1e-9, method="lsoda")
    assert ss.mean_velocity(many)[1] == pytest.approx(ss.mean_velocity(one), rel=1e-5)


@each_row("track", TRACKS.values(), ids=TRACKS)
def test_the_mirror_image_of_a_track_is_that_of_its_friction(track):
    turned = track.mirrored()
    assert turned.mirrored() == track
    x = np.linspace(-4e-3, 4e-3, 97) + 1.234e-5  # on no edge
    assert turned.grip_at(-x) == pytest.approx(track.grip_at(x), rel=1e-14)


def test_patches_repeat_after_a_wavelength():
    track = TRACKS["three tiles"]
    x = np.linspace(-2e-4, 1.5e-3, 200, endpoint=False) + 1e-6
    expected = np.where(x < 3e-4, 1.0, np.where(x < 7e-4, 0.6, 1.4))
    for k in (-3, 0, 5):
        assert track.grip_at(x + k * 1.7e-3) == pytest.approx(expected, rel=1e-15)


def test_a_measured_wave_is_the_one_that_it_was_made_of():
    x = np.linspace(0.0, 0.05, 400)
    made = ss.tracks.FrictionWave(LEVEL, wavelength=0.01, cosines=(0.1, -0.05), sines=(0.2, 0.03))
    found = ss.tracks.FrictionWave.fitted(LEVEL, x, 0.17 * made.grip_at(x), wavelength=0.01, harmonics=2)
    assert found.cosines == pytest.approx(made.cosines, abs=1e-13)
    assert found.sines == pytest.approx(made.sines, abs=1e-13)


def test_an_orbit_on_a_track_that_repeats_comes_back_modulo_its_wavelength():
    """A wave as long as the robot's own step: it locks to the track, and goes one wavelength in each period."""
    step = float(ss.mean_velocity(ss.solve(rig(LEVEL), periods=60))) * rig(LEVEL).period
    robot = rig(ss.tracks.FrictionWave(LEVEL, wavelength=step, cosines=(0.0,), sines=(0.1,)))
    orbit = ss.periodic_orbit(robot)
    assert orbit.names == ("x", "v")
    assert orbit.mean_velocity * robot.period == pytest.approx(step, rel=1e-11)
    assert orbit.multipliers == pytest.approx(orbit.differences, abs=1e-6)
    assert orbit.stable
    settled = ss.solve(robot, periods=200)  # a run from rest goes to it, and returns modulo the wavelength
    assert settled.steadiness.word == "steady" and settled.steadiness.mean_velocity == pytest.approx(orbit.mean_velocity, rel=1e-6)
    apart = (settled.strobe_x[-1] - orbit.state[0]) / step
    assert apart == pytest.approx(round(apart), abs=1e-7)


@each_row(
    ("make", "says"),
    [
        (lambda: ss.tracks.FrictionPatches(LEVEL, edges=(2e-3, 1e-3), factors=(1.0, 2.0, 1.0)), "in ascending order"),
        (lambda: ss.tracks.FrictionPatches(LEVEL, edges=(1e-3,), factors=(1.0,)), "factors has 1 numbers for 1 edges; allowed are 2"),
        (lambda: ss.tracks.FrictionPatches(LEVEL, edges=(0.0, 1e-3), factors=(1.0, -2.0), wavelength=2e-3), r"factors\[1\] = -2.0"),
        (lambda: ss.tracks.FrictionPatches(LEVEL, edges=(0.0, 1e-3), factors=(1.0, 2.0), wavelength=1e-3), "within one wavelength"),
        (lambda: ss.tracks.FrictionPatches(3.0, edges=(0.0,), factors=(1.0, 2.0)), "allowed is a track"),
        (lambda: ss.tracks.FrictionWave(LEVEL, wavelength=1e-3, cosines=(0.0,), sines=(1.2,)), "the factor falls to -0.2"),
        (lambda: ss.tracks.FrictionWave(LEVEL, wavelength=1e-3, cosines=(), sines=(0.2,)), "0 cosines and 1 sines"),
        (lambda: ss.tracks.FrictionProfile(LEVEL, place=(0.0,), factors=(1.0,)), "1 places and 1 factors"),
        (lambda: ss.tracks.FrictionProfile(LEVEL, place=(0.0, 0.0), factors=(1.0, 1.0)), "in ascending order"),
        (lambda: ss.tracks.FrictionWave.fitted(LEVEL, [0.0, 1.0], [1.0, 1.0], wavelength=1.0), "2 places and 2 factors"),
    ],
)
def test_what_is_no_track_with_a_profile_is_said(make, says):
    with pytest.raises(ss.InputError, match=says):
        make()


def test_a_diagram_and_basins_count_places_on_a_track_that_repeats_modulo_its_wavelength():
    robot = rig(TRACKS["tiles"])
    found = ss.bifurcation(robot, parameter="drive.amplitude", values=[5e-4, 6e-4], settle=20, points=2, follow=False)
    assert found.sizes["drive.amplitude"] == 2
    at = coordinates(robot)
    assert at.wavelength == 1.7e-3
    assert at.distance([5 * 1.7e-3 + 1e-6, 0.1], [1e-6, 0.1]) == pytest.approx(0.0, abs=1e-9)
    assert coordinates(rig(TRACKS["patches"])).wavelength is None
    other = ss.tracks.FrictionWave(
        TRACKS["tiles"], wavelength=1e-3, cosines=(0.1,), sines=(0.0,)
    )  # says 1 mm, and the tiles inside say 1.7 mm
    assert coordinates(rig(other)).wavelength is None
