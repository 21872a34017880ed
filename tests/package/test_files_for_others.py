"""Data frames, Excel and MATLAB files of runs and studies hold what the columns hold, with units; a study goes on by its folder alone."""

import json

import numpy as np
import openpyxl
import pytest
from scipy.io import loadmat

import stickslip as ss
from stickslip.cli import main

DIGITS = 1e-15  # openpyxl writes 16 digits: the last may be off by a half
ROBOT = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")


def read_xlsx(path):
    book = openpyxl.load_workbook(path)
    head, *rows = book["data"].iter_rows(values_only=True)
    return list(head), rows, dict(book["about"].iter_rows(values_only=True))


@pytest.fixture(scope="module")
def run():
    return ss.solve(ROBOT, periods=2, settle=0, samples=50)


def test_a_data_frame_has_the_columns_with_their_units(run):
    frame = run.to_dataframe()
    assert all(np.array_equal(frame[name], getattr(run, name)) for name in ("t", "x", "v", "friction_force"))
    assert frame.attrs["units"]["actuator_power"] == "W" and "z" not in frame


def test_columns_of_parts_stand_apart_in_tables():
    chain = ss.solve(ss.presets.two_modules(), periods=2, settle=0, samples=20)
    frame = chain.to_dataframe()
    for i, name in enumerate(chain.bodies):
        assert np.array_equal(frame[f"x.{name}"], chain.x[:, i])


@pytest.mark.parametrize("write", [lambda run, path: run.to_excel(path), lambda run, path: run.save(path), ss.export])
def test_a_workbook_of_a_run_has_units_in_its_head_and_says_what_ran(run, write, tmp_path):
    head, rows, about = read_xlsx(write(run, tmp_path / "run.xlsx"))
    assert head[:3] == ["t [s]", "x [m]", "v [m/s]"]
    assert np.allclose([row[2] for row in rows], run.v, rtol=DIGITS, atol=0)
    assert about["status"] == run.status and "amplitude" in about["robot"]


def test_export_takes_runs_and_batches(run, tmp_path):
    assert ss.export(run, tmp_path / "run.csv").read_text().startswith("t [s],x [m]")
    assert np.array_equal(loadmat(ss.export(run, tmp_path / "run.mat"))["v"].ravel(), run.v)
    assert np.array_equal(ss.load(ss.export(run, tmp_path / "run.nc")).v, run.v)
    batch = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=[5e-4, 6e-4], law="coulomb"), periods=2)
    head, rows, _ = read_xlsx(ss.export(batch, tmp_path / "batch.xlsx"))
    assert np.allclose([row[head.index("mean_velocity [m/s]")] for row in rows], batch.mean_velocity, rtol=DIGITS, atol=0)
    assert batch.to_dataframe().mean_velocity.tolist() == batch.mean_velocity.tolist()


def test_a_workbook_of_a_study_has_words_and_empty_cells_where_there_is_no_number(tmp_path):
    grid = ss.sweep(ss.presets.coulomb_robot, alpha_plus=[0.5, float("nan")], alpha_minus=0.9)
    head, rows, about = read_xlsx(ss.export(grid, tmp_path / "grid.xlsx"))
    assert rows[0][head.index("motion_type")] == grid.motion_type.values[0]
    assert rows[1][head.index("mean_velocity")] is None
    assert about["maker"] == "coulomb_robot"


def test_a_sheet_that_is_too_long_says_what_to_type(run, tmp_path, monkeypatch):
    monkeypatch.setattr("stickslip.workbooks._ROWS", 50)
    with pytest.raises(ss.InputError, match=r"a sheet of Excel holds 49 rows .* type a .csv"):
        run.to_excel(tmp_path / "run.xlsx")
    assert not list(tmp_path.iterdir())


def test_without_openpyxl_excel_says_what_to_install(run, tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "openpyxl", None)
    with pytest.raises(ss.InputError, match=r'pip install "stickslip\[io\]"'):
        run.to_excel(tmp_path / "run.xlsx")


SWEEP = ["sweep", "coulomb_robot", "alpha_plus=0.4,0.5,0.6", "alpha_minus=0.9", "--tile", "1", "--out", "study"]


def test_resume_finishes_what_a_folder_says_from_any_folder(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main([*SWEEP, "--shard", "1/3"]) == 0
    assert int((ss.open_study("study").status == 101).sum()) == 2
    monkeypatch.chdir("/")
    assert main(["resume", str(tmp_path / "study"), "--json"]) == 0
    assert '"written"' in capsys.readouterr().out
    whole = ss.sweep(ss.presets.coulomb_robot, alpha_plus=[0.4, 0.5, 0.6], alpha_minus=0.9)
    assert np.array_equal(ss.open_study(tmp_path / "study").mean_velocity, whole.mean_velocity)


def test_resume_runs_no_code_that_a_folder_names(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rig.py").write_text("import stickslip as ss\nopen('ran', 'w')\ndef rig(a):\n    return ss.presets.coulomb_robot(a, 0.9)\n")
    begun = {"command": "sweep", "words": ["rig.py:rig", "a=0.4,0.5", "--allow-code"], "folder": str(tmp_path)}
    (tmp_path / "study").mkdir()
    (tmp_path / "study" / "command.json").write_text(json.dumps(begun), encoding="utf-8")
    assert main(["resume", "study"]) == 2
    assert "type --allow-code" in capsys.readouterr().err and not (tmp_path / "ran").exists()
    (tmp_path / "study" / "command.json").write_text('{"command": "doctor", "words": [], "folder": "."}', encoding="utf-8")
    assert main(["resume", "study"]) == 2
    assert "is damaged" in capsys.readouterr().err


def test_a_sweep_that_is_refused_leaves_no_folder(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main([*SWEEP[:2], "alpha_plus=0.4,0.5", "alpha_minus=-3", *SWEEP[4:]]) == 2
    assert not list(tmp_path.iterdir())
