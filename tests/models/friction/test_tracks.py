"""Tracks: gravity along and across, friction that varies in time, and the mirror image of a robot."""

import dataclasses
import math

import numpy as np
import pytest

import stickslip as ss
from pairs import each_once
from registries import examples
from rows import each_row
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.engine.symbols import Graph, Sym
from stickslip.tracks import TRACKS
from stickslip.tracks.tracks import fold

EVERY = {
    "level": ss.Level(),
    "incline": ss.Incline(tilt=0.05),
    "uphill": ss.Incline(tilt=-0.05),
    "varying": ss.tracks.VaryingFriction(ss.Level(), depth=0.3, harmonic=2, phase=0.4),
    "varying incline": ss.tracks.VaryingFriction(ss.Incline(tilt=0.05), depth=0.3),
    "patches": ss.tracks.FrictionPatches(ss.Incline(tilt=0.05), edges=(-1e-3, 2e-3), factors=(1.0, 0.5, 1.5)),
    "tiles": ss.tracks.FrictionPatches(
        ss.tracks.VaryingFriction(ss.Level(), depth=0.3), edges=(0.0, 1e-3, 2e-3), factors=(1.0, 0.5, 1.5), wavelength=3e-3
    ),
    "wave": ss.tracks.FrictionWave(ss.Level(), wavelength=2e-3, cosines=(0.1, 0.0), sines=(0.2, -0.1)),
    "profile": ss.tracks.FrictionProfile(ss.Level(), place=(0.0, 1e-3, 3e-3), factors=(1.0, 1.4, 0.8)),
    "varying profile": ss.tracks.VaryingFriction(
        ss.tracks.FrictionProfile(ss.Level(), place=(0.0, 1e-3, 3e-3), factors=(1.0, 1.4, 0.8)), depth=0.2
    ),
    "varying twice": ss.tracks.VaryingFriction(ss.tracks.VaryingFriction(ss.Incline(tilt=0.05), depth=0.3), depth=0.2, harmonic=3),
}
every_track = each_row("track", EVERY.values(), ids=EVERY)
every_track_and_drive = each_row(("track", "drive"), each_once(EVERY, examples(ss.drives.DRIVES)))


def rig(track, law="coulomb"):
    return dataclasses.replace(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4, law=law), track=track)


def test_every_kind_of_track_is_tested():
    assert {type(track) for track in EVERY.values()} == set(TRACKS.values())


@every_track
def test_weight_is_split_along_and_across(track):
    assert math.hypot(track.along(9.81), track.across(9.81)) == pytest.approx(9.81, rel=1e-15)


@every_track
def test_a_study_file_keeps_every_track(track):
    robot = rig(track)
    assert ss.Robot.from_toml(robot.to_toml()) == robot


@every_track_and_drive
def test_the_load_can_be_written_down_and_repeats(track, drive):
    robot = rig(EVERY[track]).replace(drive=examples(ss.drives.DRIVES)[drive])
    graph = Graph()
    written = replace_leaf(robot, {name: graph.case(name) for name, _ in leaves(robot)})
    assert isinstance(written.load(graph.variable("t"), graph.constant(0.0)), Sym)
    t = np.linspace(0, 1, 9)[:-1] * robot.period
    loads = np.broadcast_to(robot.load(t, 0.0), 8)
    assert np.broadcast_to(robot.load(t + 3 * robot.period, 0.0), 8) == pytest.approx(loads, rel=1e-11)
    assert np.min(loads) > 0


def test_friction_varies_by_its_depth_about_the_coefficients():
    track = ss.tracks.VaryingFriction(ss.Incline(tilt=0.1), depth=0.4, harmonic=3, phase=0.7)
    robot = rig(track)
    t = np.arange(600) / 600 * robot.period
    factor = robot.load(t, 0.0) / (robot.total_mass * robot.gravity * math.cos(0.1))
    assert factor == pytest.approx(1 + 0.4 * np.sin(3 * robot.drive.omega * t + 0.7), rel=1e-12)
    assert np.mean(factor) == pytest.approx(1.0, abs=1e-14)


def test_the_factor_on_the_load_is_one_on_the_coefficients_of_coulomb_friction():
    varied, robot = rig(ss.tracks.VaryingFriction(ss.Level(), depth=0.4)), rig(ss.Level())
    t = 0.2 * robot.period
    grip = varied.track.grip(t, varied.period)
    law = robot.friction.replace(mu_plus=grip * robot.friction.mu_plus, mu_minus=grip * robot.friction.mu_minus)
    for v in (0.1, -0.1):
        assert varied.friction.sliding(v, varied.load(t, 0.0)) == pytest.approx(law.sliding(v, robot.load(t, 0.0)), rel=1e-14)
    assert varied.friction.breakaway(varied.load(t, 0.0)) == pytest.approx(law.breakaway(robot.load(t, 0.0)), rel=1e-14)


def test_gravity_along_the_track_does_not_vary_with_friction():
    plain, varied = rig(ss.Incline(tilt=0.1)), rig(ss.tracks.VaryingFriction(ss.Incline(tilt=0.1), depth=0.4))
    assert varied.acceleration(0.003, 0.0, 0.0, 0.1) == plain.acceleration(0.003, 0.0, 0.0, 0.1)


@each_row(
    ("make", "says"),
    [
        (lambda: ss.tracks.VaryingFriction(ss.Level(), depth=1.0), "depth = 1.0; allowed is from 0 to below 1"),
        (lambda: ss.tracks.VaryingFriction(ss.Level(), depth=-0.1, harmonic=1.5), "2 problems"),
        (lambda: ss.tracks.VaryingFriction(0.03, depth=0.1), "allowed is a track"),
        (lambda: ss.Incline(tilt=2.0), "between -pi/2 and pi/2"),
    ],
)  # fmt: skip
def test_what_is_no_track_is_said(make, says):
    with pytest.raises(ss.InputError, match=says):
        make()


def test_a_run_uphill_is_a_negative_tilt():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=1.2e-3, law="coulomb", incline="gravity")
    up = robot.replace({"track.tilt": -robot.track.tilt})
    down_speed, up_speed = (ss.mean_velocity(ss.solve(r, periods=40)) for r in (robot, up))
    assert down_speed > 0 and up_speed == pytest.approx(-down_speed, rel=1e-9)  # isotropic friction, symmetric drive: the mirror image


# mirror images ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", ["coulomb", "lugre"])
@every_track_and_drive
def test_a_mirrored_robot_obeys_mirrored_equations(track, drive, law):
    robot = rig(EVERY[track], law).replace(drive=examples(ss.drives.DRIVES)[drive])
    image, t, v = ss.dynamics.mirrored(robot), 0.3 * robot.drive.period, 0.02
    load = robot.load(t, 0.0)
    assert image.load(t, 0.0) == load

    def force(r, side):
        return r.friction.sliding(side * v, load) if law == "coulomb" else r.friction.force(side * v, side * 1e-7, side * 1e-3, load)

    assert image.acceleration(t, 0.0, -v, force(image, -1)) == pytest.approx(-robot.acceleration(t, 0.0, v, force(robot, 1)), rel=1e-13)
    assert image.impulses == tuple((s, -jump) for s, jump in robot.impulses)
    assert ss.dynamics.mirrored(image) == robot


def test_mirroring_exchanges_forwards_and_backwards_also_where_none_is_given():
    robot = rig(ss.Level(), "lugre").replace(friction=ss.LuGre(0.1, 0.2, None, 0.3, 4e5, 100.0, 0.04, 2e-3))
    law = ss.dynamics.mirrored(robot).friction
    assert (law.mu_plus, law.mu_minus, law.f_plus, law.f_minus) == (0.2, 0.1, 0.3, None)


def test_an_incline_is_folded_as_it_always_was():
    assert fold(0.18, math.radians(1.7)) == pytest.approx((0.150255, 0.209587), abs=1e-6)


def test_a_tilt_that_was_folded_into_a_replaced_law_is_not_lost_without_a_word():
    """The numbers stay what they are: the track is level, as it always was."""
    rigs = {incline: ss.presets.piezo_rig(tilt_deg=3, amplitude=7e-4, incline=incline) for incline in ("folded", "gravity")}
    isotropic = ss.LuGre(0.18, 0.18, 0.21, 0.21, 4e5, 100.0, 0.04, 2e-3)

    def said(robot):
        return [note for note in robot.notes if "folded" in note]

    replaced = rigs["folded"].replace(friction=isotropic)
    assert "the tilt of 3 degrees" in said(replaced)[0] and replaced.track.folded == rigs["folded"].track.folded
    varying = rigs["folded"].replace(track=ss.tracks.VaryingFriction(rigs["folded"].track, depth=0.3))
    others = [  # also of what was written and read, mirrored, or is on a varying track, and of a law that differs both ways
        ss.dynamics.mirrored(ss.Robot.from_toml(rigs["folded"].to_toml())).replace(friction=ss.Coulomb(0.13, 0.23)),
        ss.Robot.from_toml(rigs["folded"].replace(friction=ss.Coulomb(0.13, 0.23)).to_toml()),
        ss.Chain((varying, varying), ss.Spring(1200.0)).replace({"modules.0.friction": isotropic}).modules[0],
        ss.Chain((varying, varying), ss.Spring(1200.0)).replace({"modules.0.friction": ss.Coulomb(0.13, 0.23)}).modules[0],
    ]
    assert all(said(other) for other in others)
    with pytest.raises(ss.InputError, match="would add to it"):
        rigs["folded"].replace(track=ss.tracks.VaryingFriction(ss.Incline(0.05), depth=0.3))
    assert replaced.replace(track=ss.Incline(0.05)) == rigs["folded"].replace(friction=isotropic, track=ss.Incline(0.05))
    robot = dataclasses.replace(rigs["folded"], friction=isotropic)
    assert said(robot) and "the tilt of 3 degrees" in said(robot)[0] and 'incline="gravity"' in said(robot)[0]
    assert robot.track == ss.Level() and said(ss.solve(robot, periods=3).model) == said(robot)
    assert said(robot.replace({"drive.amplitude": np.array([5e-4, 6e-4])}))
    silent = [
        rigs["folded"], rigs["gravity"].replace(friction=isotropic), rigs["folded"].replace({"friction.sigma0": 3e5}),
        rigs["folded"].replace(friction=isotropic, track=ss.Level()), robot.replace(track=ss.Level()),
        replaced.replace(track=ss.Incline(0.05)),
        ss.presets.piezo_rig(tilt_deg=0, amplitude=7e-4).replace(friction=isotropic),
    ]  # fmt: skip
    assert [said(other) for other in silent] == [[]] * len(silent)
    assert rigs["folded"] == ss.Robot.from_toml(rigs["folded"].to_toml())
