"""Every law on every drive and every track, in plain Python: finite, balanced, and the same when mirrored."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

import stickslip as ss
from kinds import DRIVES, LAWS, TRACKS, robot
from pairs import each_once
from stickslip.models.mirroring import mirrored

#: Stretches whose force jumps inside them (Karnopp's band, dead band) or bends (tables) are integrated across, to about the tolerance.
ROUGH = {"karnopp": 1e-2, "deadband": 1e-3, "tabulated": 1e-3}


QUICK = each_once(LAWS, DRIVES, TRACKS)


def cases():
    """Each law once, with another drive and track; all that goes with all is slow."""
    for law, drive, track in itertools.product(LAWS, DRIVES, TRACKS):
        marks = [] if (law, drive, track) in QUICK else [pytest.mark.slow]
        yield pytest.param(law, drive, track, id=f"{law}-{drive}-{track}", marks=marks)


@pytest.mark.parametrize(("law", "drive", "track"), list(cases()))
def test_every_robot_runs_balances_and_has_its_mirror_image(law, drive, track):
    """Steps are held to rtol = 1e-5: the energy closes to some hundred times that, and a mirror image takes the same steps."""
    model, periods = robot(law, drive, track), 1 if law == "bristle" else 3
    run = ss.solve(model, periods=periods, method="dop853", rtol=1e-5, samples=50)
    for name in ("x", "v", "acceleration", "friction_force", "actuator_power"):
        assert np.all(np.isfinite(getattr(run, name))), name
    assert run.status == "finished" and run.t[-1] == pytest.approx(periods * model.period, rel=1e-15)
    work = ss.energy(run)
    missing = work.drive + work.gravity - work.friction - work.kinetic
    assert abs(missing).max() <= ROUGH.get(law, 1e-3) * np.max([abs(work.drive), abs(work.friction), abs(work.gravity), abs(work.kinetic)])
    image = ss.solve(mirrored(model), periods=periods, method="dop853", rtol=1e-5, samples=50)
    scale = abs(run.x).max()
    assert run.strobe_x == pytest.approx(-image.strobe_x, abs=(1e-2 if law in ROUGH else 1e-4) * scale + 1e-15)
    assert math.isfinite(scale)
