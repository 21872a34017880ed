"""Files that earlier versions wrote are read for ever: each file in tests/golden was written by the version that introduced its format."""

import importlib
import json
import shutil

import numpy as np
import pytest

import stickslip as ss
from house import ROOT
from rows import each_row
from stickslip.dynamics.atlas import atlas_study
from stickslip.studies import manifest, model_identity

GOLDEN = ROOT / "tests" / "golden"
NUMBERS = json.loads((GOLDEN / "numbers.json").read_text())


@each_row("name", sorted(name for name in NUMBERS if name.startswith("run-")))
def test_a_run_of_an_earlier_version_is_loaded_with_its_numbers(name):
    run, said = ss.load(GOLDEN / name), NUMBERS[name]
    assert run.x[-1] == pytest.approx(said["x"], rel=1e-12) and run.v[-1] == pytest.approx(said["v"], rel=1e-12)
    assert len(run.events) == said["events"] and run.model.drive.amplitude == 5e-4


def test_every_format_of_runs_has_a_golden_file():
    from stickslip.results.storage import EARLIEST, FORMAT

    kept = {int(name.rpartition("-")[2].removesuffix(".nc")) for name in NUMBERS if name.startswith("run-")}
    assert kept == set(range(EARLIEST, FORMAT + 1)), "run tests/golden/write.py with the version that introduces a format"


def test_a_record_of_an_earlier_version_is_read_with_its_numbers():
    record = ss.read(GOLDEN / "record.csv")
    assert {name: record[name].values[-1] for name in record} == pytest.approx(NUMBERS["record.csv"], rel=1e-12)


def test_a_robot_of_an_earlier_version_is_read():
    assert ss.Robot.from_toml((GOLDEN / "robot.toml").read_text()) == ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4)


@each_row("name", sorted(name for name in NUMBERS if name.startswith(("study-", "grid-"))))
def test_a_study_of_an_earlier_version_is_opened_from_its_folder_and_from_its_file(name):
    grid = ss.open_study(GOLDEN / name)
    np.testing.assert_allclose(grid.mean_velocity, NUMBERS[name]["mean_velocity"], rtol=1e-12)
    assert grid.amplitude.values.tolist() == [3e-4, 6e-4] and grid.tilt_deg.values.tolist() == [1.0, 1.7]


def test_the_formats_of_studies_and_atlases_have_golden_folders():
    assert f"study-format-{manifest.FORMAT}" in NUMBERS and f"atlas-format-{atlas_study._FORMAT}" in NUMBERS, "run tests/golden/write.py"


@pytest.mark.parametrize("name", sorted(name for name in NUMBERS if name.startswith("atlas-")))
def test_the_folder_of_an_atlas_is_resumed_to_its_regions_or_says_that_it_is_of_an_earlier_version(name, tmp_path, monkeypatch):
    """Versions of libraries, and the hash of the equations as this package's own records hold them, are those of the day it was written."""
    plane = json.loads((GOLDEN / name / "plane.json").read_text())
    folder = shutil.copytree(GOLDEN / name, tmp_path / "atlas", ignore=shutil.ignore_patterns("plane.json"))
    told = json.loads((folder / "manifest.json").read_text())
    theirs = {part: value for part, value in told["identity"].items() if not part.startswith("version of ")}
    now = {name: importlib.import_module(name).__version__ for name in manifest._LIBRARIES}  # the format is tested, and not the libraries
    own = {f"version of {name}": ".".join(version.split(".")[:2]) for name, version in now.items()}
    told["identity"] = theirs | own | {"version of stickslip": ss.__version__}
    (folder / "manifest.json").write_text(json.dumps(told))
    if told["stickslip_format"] == atlas_study._FORMAT:
        monkeypatch.setattr(model_identity, "equation_hash", lambda *_: NUMBERS[name]["equations"])
        assert ss.atlas(ss.presets.piezo_rig, out=folder, resume=True, **plane).regions == NUMBERS[name]["regions"]
    else:
        with pytest.raises(ss.InputError, match="earlier stickslip"):
            ss.atlas(ss.presets.piezo_rig, out=folder, resume=True, **plane)


@each_row("name", ["run.csv", "run.mat", "run.xlsx"])
def test_an_exported_run_of_an_earlier_version_is_read_with_its_numbers(name):
    record = ss.read(GOLDEN / name)
    for column in ("x", "v"):
        np.testing.assert_allclose(record[column].si, NUMBERS[name][column], rtol=1e-12, atol=1e-18)
    assert any("computed, not measured" in note for note in record.notes)
