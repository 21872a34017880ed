"""Every law on every drive and every track, in plain Python: finite, balanced, and the same when mirrored."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

import stickslip as ss
from stickslip.robot import mirrored

SOFT = {"sigma0": 2e4, "sigma1": 20.0}  # bristles that are soft enough for plain Python

DRIVES = {
    **{name: kind.example() for name, kind in ss.DRIVES.items()},
    "twophase": ss.TwoPhase(stroke=1e-3, u1=0.05, u2=0.2),
    "threephase": ss.ThreePhase(u1=0.1, w1=10.0, w2=60.0, w3=12.0),
}
TRACKS = {
    "level": ss.Level(),
    "downhill": ss.Incline(tilt=0.03),
    "uphill": ss.Incline(tilt=-0.03),
    "varying": ss.VaryingFriction(ss.Level(), depth=0.3),
}


def softened(law):
    return law.replace(**{name: value for name, value in SOFT.items() if hasattr(law, name)})


LAWS = {name: softened(kind.example()) for name, kind in ss.LAWS.items()} | {
    "bristle": ss.LAWS["bristle"].example().replace(sigma0=2e3),
    "sum": ss.Sum.example(),
    "lugre + viscous": softened(ss.LuGre.example()) + ss.Viscous.example(),
}
#: Stretches whose force jumps inside them (Karnopp's band, dead band) or bends (tables) are integrated across, to about the tolerance.
ROUGH = {"karnopp": 1e-2, "deadband": 1e-3, "tabulated": 1e-3}


def cases():
    """Each law with each drive and with each track at once, everything else slow."""
    for law, drive, track in itertools.product(LAWS, DRIVES, TRACKS):
        quick = (track == "level" and drive in ("harmonic", "twophase")) or (drive == "harmonic" and law in ("coulomb", "lugre", "gms"))
        quick = quick or (track == "level" and law in ("coulomb", "stribeck", "lugre"))
        yield pytest.param(law, drive, track, id=f"{law}-{drive}-{track}", marks=[] if quick else [pytest.mark.slow])


@pytest.mark.parametrize(("law", "drive", "track"), list(cases()))
def test_every_robot_runs_balances_and_has_its_mirror_image(law, drive, track):
    """Steps are held to rtol = 1e-5: the energy closes to some hundred times that, and a mirror image takes the same steps."""
    robot = ss.Robot(body_mass=0.0626, inner_mass=0.0095, drive=DRIVES[drive], friction=LAWS[law], track=TRACKS[track])
    run = ss.solve(robot, periods=3, method="dop853", rtol=1e-5, samples=50)
    for name in ("x", "v", "acceleration", "friction_force", "actuator_power"):
        assert np.all(np.isfinite(getattr(run, name))), name
    assert run.status == "finished" and run.t[-1] == pytest.approx(3 * robot.period, rel=1e-15)
    work = ss.energy(run)
    missing = work.drive + work.gravity - work.friction - work.kinetic
    assert abs(missing).max() <= ROUGH.get(law, 1e-3) * np.max([abs(work.drive), abs(work.friction), abs(work.gravity), abs(work.kinetic)])
    image = ss.solve(mirrored(robot), periods=3, method="dop853", rtol=1e-5, samples=50)
    scale = abs(run.x).max()
    assert run.strobe_x == pytest.approx(-image.strobe_x, abs=(1e-2 if law in ROUGH else 1e-4) * scale + 1e-15)
    assert math.isfinite(scale)
