"""Attractors along a parameter: each is an orbit, shares are those of basins, and they end and begin where others say."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss

RIG = {"tilt_deg": 1.7, "f0": 0.5}
STARTS = {"v": np.linspace(-0.1, 0.1, 9), "z": [-1e-6, 1e-6]}


@pytest.fixture(scope="module")
def tracked():
    values = [7.4e-4, 7.8e-4, 8.0e-4, 8.2e-4]
    return ss.attractors(ss.presets.piezo_rig, parameter="amplitude", values=values, starts=STARTS, settle=80, **RIG)


def test_one_motion_ends_where_another_is_left(tracked):
    """As going up and down says, where each value begins with the end of the one before."""
    there = tracked.period.values >= 0
    assert there.tolist() == [[True, True, True, False], [False, True, True, True]]
    going = ss.bifurcation(ss.presets.piezo_rig, parameter="amplitude", values=tracked.amplitude.values, settle=80, points=8, **RIG)
    up, down = (going.mean_velocity.sel(direction=way).values for way in ("up", "down"))
    slow, fast = tracked.mean_velocity.values
    assert np.allclose(slow[:3], up[:3], rtol=0, atol=1e-7) and np.allclose(fast[1:], down[1:], rtol=0, atol=1e-7)
    assert abs(up[3] - fast[3]) < 1e-7 and abs(down[0] - slow[0]) < 1e-7, "a jump at each end"
    assert tracked.unsolved.values.tolist() == [0] * 4
    assert np.allclose(tracked.share.sum("attractor"), 1.0)
    assert np.all(np.isnan(tracked.mean_velocity.values) == ~there)


def test_shares_are_those_of_basins(tracked):
    alone = ss.basins(ss.presets.piezo_rig(amplitude=8.0e-4, **RIG), settle=80, **STARTS)
    here = tracked.sel(amplitude=8.0e-4)
    assert sorted(here.share.values.tolist()) == sorted(alone.fractions)
    for a in alone.attractors:
        k = int(np.argmin(abs(here.mean_velocity.values - a.mean_velocity)))
        assert here.mean_velocity.values[k] == pytest.approx(a.mean_velocity, rel=1e-6)
        assert (float(here.share_low[k]), float(here.share_high[k])) == pytest.approx(a.interval)


def test_each_is_a_stable_orbit(tracked):
    """Newton's method from its strobe state stays there and gives the same mean velocity."""
    for k, amplitude in ((0, 8.0e-4), (1, 8.0e-4), (1, 8.2e-4)):
        one = tracked.isel(attractor=k).sel(amplitude=amplitude)
        orbit = ss.periodic_orbit(ss.presets.piezo_rig(amplitude=amplitude, **RIG), guess=[float(one.v), float(one.z)])
        assert orbit.stable
        assert float(one.mean_velocity) == pytest.approx(orbit.mean_velocity, abs=1e-5 * 0.0036)


def test_stopped_values_have_no_attractors(every_report):
    rig = dict(
        make=ss.presets.piezo_rig, parameter="amplitude", values=[5e-4, 6e-4, 7e-4], starts={"v": [0.0, 0.01]}, settle=20, tilt_deg=1.7
    )
    found = ss.attractors(**rig, law="coulomb", progress=lambda now: now.done < 2)
    assert found.unsolved.values.tolist() == [0, 0, -1]
    assert found.period.values.tolist() == [[1, 1, -1]]
    assert ss.plot.attractors(found).get_legend_handles_labels()[1] == ["0: period 1"]
    assert "share of the starts" in ss.plot.attractors(found, quantity="share").get_ylabel()


def test_what_to_type():
    rig = dict(make=ss.presets.piezo_rig, parameter="amplitude", tilt_deg=1.7)
    with pytest.raises(ss.InputError, match=r"values = .*; allowed are two or more rising"):
        ss.attractors(values=[1e-4], **rig)
    with pytest.raises(ss.InputError, match="phase is not part of the strobe state"):
        ss.attractors(values=[5e-4, 6e-4], starts={"phase": [0.0, 0.5]}, **rig)
    with pytest.raises(ss.InputError, match="'w' is not a coordinate of the start"):
        ss.attractors(values=[5e-4, 6e-4], starts={"w": 1.0}, **rig)
    with pytest.raises(ss.InputError, match=r"allowed is the Dataset of ss\.attractors"):
        ss.plot.attractors(3)
    with pytest.raises(ss.InputError, match="allowed is mean_velocity or v or share"):
        ss.plot.attractors(ss.attractors(values=[5e-4, 6e-4], starts={"v": 0.0}, settle=5, law="coulomb", **rig), quantity="speed")


def test_the_command(capsys, tmp_path):
    from stickslip.show.cli import main

    out = tmp_path / "tracked.csv"
    words = ["basins", "piezo_rig", "tilt_deg=1.7", "law=coulomb", "amplitude=5e-4..6e-4:3", "v=0,0.01", "settle=20", "--out", str(out)]
    assert main(words) == 0
    printed = capsys.readouterr().out
    assert "piezo_rig: amplitude 3 values, 2 starts at each" in printed and "0.0005 to 0.0006" in printed
    assert len(out.read_text().splitlines()) == 4
