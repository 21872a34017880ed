"""A box that hops on one foot, and a block on two: their presets, files and starts."""

from __future__ import annotations

import re

import numpy as np
import pytest

import stickslip as ss
from stickslip.basics.errors import InputError
from stickslip.show.reports.moving import moments


def test_a_hopping_robot_travels_and_its_motion_repeats():
    """What drifts is no part of what has to repeat: one landing in each period, and what friction and hits take is what the rotor gives."""
    robot = ss.presets.hopping_robot()
    run = ss.solve(robot, periods=40)
    assert run.steadiness.word == "steady" and run.steadiness.period == 1 and ss.hops(run).landings == 1
    assert ss.solve(robot, periods=20, method="dop853").mean_velocity == pytest.approx(run.mean_velocity, rel=1e-9)
    picture = moments(run)["plane"]
    assert max(picture["bodies"][0]["z"]) == pytest.approx(1e3 * ss.hops(run).height, rel=1e-4) and [z for _, z in picture["ground"]] == [
        0,
        0,
    ]
    energy = ss.energy(run)
    assert energy.drive[-1] == pytest.approx(energy.friction[-1] + energy.damping[-1], rel=1e-12)


def test_boxes_in_files_and_what_is_said_of_bad_ones():
    for box in (ss.presets.hopping_robot(restitution=0.3), ss.presets.rocking_block()):
        assert ss.machines.ShakenBox.from_toml(box.to_toml()) == box
    block = ss.presets.rocking_block(width=0.2, height=1.0)
    for lean, corner in ((0.1, 0.1), (-0.1, -0.1)):
        x, z, angle = block.tilted(lean)["x"].values()
        a, d = corner, -0.5
        foot = x + a * np.cos(angle) - d * np.sin(angle), z + 0.5 + a * np.sin(angle) + d * np.cos(angle)
        assert angle == -lean and np.allclose(foot, (corner, 0.0), rtol=0, atol=1e-15)
    with pytest.raises(InputError, match=re.escape("type width=0.1, height=0.2")):
        block.replace({"width": None})
    with pytest.raises(ValueError, match="does not turn"):
        ss.presets.hopping_robot().tilted(0.1)
