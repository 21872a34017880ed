"""Files that earlier versions wrote are read for ever: each file in tests/golden was written by the version that introduced its format."""

import json

import pytest

import stickslip as ss
from house import ROOT

GOLDEN = ROOT / "tests" / "golden"
NUMBERS = json.loads((GOLDEN / "numbers.json").read_text())


@pytest.mark.parametrize("name", sorted(name for name in NUMBERS if name.startswith("run-")))
def test_a_run_of_an_earlier_version_is_loaded_with_its_numbers(name):
    run, said = ss.load(GOLDEN / name), NUMBERS[name]
    assert run.x[-1] == pytest.approx(said["x"], rel=1e-12) and run.v[-1] == pytest.approx(said["v"], rel=1e-12)
    assert len(run.events) == said["events"] and run.model.drive.amplitude == 5e-4


def test_every_format_of_runs_from_2_on_has_a_golden_file():
    from stickslip.results.storage import FORMAT

    kept = {int(name.rpartition("-")[2].removesuffix(".nc")) for name in NUMBERS if name.startswith("run-")}
    assert kept == set(range(2, FORMAT + 1)), "run tests/golden/write.py with the version that introduces a format"


def test_a_record_of_an_earlier_version_is_read_with_its_numbers():
    record = ss.read(GOLDEN / "record.csv")
    assert {name: record[name].values[-1] for name in record} == pytest.approx(NUMBERS["record.csv"], rel=1e-12)


def test_a_robot_of_an_earlier_version_is_read():
    assert ss.Robot.from_toml((GOLDEN / "robot.toml").read_text()) == ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4)
