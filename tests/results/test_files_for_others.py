"""Data frames, Excel and MATLAB files of runs and studies hold what the columns hold, with units; a study goes on by its folder alone."""

import json

import numpy as np
import openpyxl
import pytest
from scipy.io import loadmat

import stickslip as ss
from rows import each_row
from stickslip.show.cli import main

DIGITS = 1e-15  # openpyxl writes 16 digits: the last may be off by a half
ROBOT = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")


def read_xlsx(path):
    book = openpyxl.load_workbook(path)
    head, *rows = book["data"].iter_rows(values_only=True)
    return list(head), rows, {name: value for name, value, *_ in book["about"].iter_rows(values_only=True)}


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


@each_row("write", [lambda run, path: run.to_excel(path), lambda run, path: run.save(path), ss.studies.export])
def test_a_workbook_of_a_run_has_units_in_its_head_and_says_what_ran(run, write, tmp_path):
    head, rows, about = read_xlsx(write(run, tmp_path / "run.xlsx"))
    assert head[:3] == ["t [s]", "x [m]", "v [m/s]"]
    assert np.allclose([row[2] for row in rows], run.v, rtol=DIGITS, atol=0)
    assert about["status"] == run.status and "amplitude" in about["robot"]


def test_export_takes_runs_and_batches(run, tmp_path):
    assert ss.studies.export(run, tmp_path / "run.csv").read_text().startswith("t [s],x [m]")
    assert np.array_equal(loadmat(ss.studies.export(run, tmp_path / "run.mat"))["v"].ravel(), run.v)
    assert np.array_equal(ss.load(ss.studies.export(run, tmp_path / "run.nc")).v, run.v)
    batch = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=[5e-4, 6e-4], law="coulomb"), periods=2)
    head, rows, _ = read_xlsx(ss.studies.export(batch, tmp_path / "batch.xlsx"))
    assert np.allclose([row[head.index("mean_velocity [m/s]")] for row in rows], batch.mean_velocity, rtol=DIGITS, atol=0)
    assert batch.to_dataframe().mean_velocity.tolist() == batch.mean_velocity.tolist()


def test_a_workbook_of_a_study_has_words_and_empty_cells_where_there_is_no_number(tmp_path):
    grid = ss.sweep(ss.presets.coulomb_robot, alpha_plus=[0.5, float("nan")], alpha_minus=0.9)
    head, rows, about = read_xlsx(ss.studies.export(grid, tmp_path / "grid.xlsx"))
    assert rows[0][head.index("motion_type")] == grid.motion_type.values[0]
    assert rows[1][head.index("mean_velocity")] is None
    assert about["maker"] == "coulomb_robot"


def test_a_workbook_explains_its_columns_and_its_numbers(run, tmp_path):
    """A colleague who has only the file finds every unit and meaning in it, and headings that are not cut off."""
    grid = ss.sweep(ss.presets.two_modules, phase=[0.0, 3.0], stiffness=1200.0)
    for path in (ss.studies.export(grid, tmp_path / "grid.xlsx"), run.to_excel(tmp_path / "run.xlsx")):
        book = openpyxl.load_workbook(path)
        assert book.sheetnames == ["data", "columns", "about"] and [sheet.freeze_panes for sheet in book] == ["A2"] * 3
        head = list(book["data"][1])
        assert all(cell.font.b for cell in head) and book["data"].auto_filter.ref == book["data"].dimensions
        widths = [book["data"].column_dimensions[cell.column_letter].width for cell in head]
        assert all(width > len(cell.value) for width, cell in zip(widths, head, strict=True))
        told = {name: (unit, meaning) for name, unit, meaning in book["columns"].iter_rows(min_row=2, values_only=True)}
        assert list(told) == [cell.value for cell in head] and all(unit and meaning for unit, meaning in told.values())
        assert all(f"[{unit}]" in name for name, (unit, _) in told.items() if unit != "1")
    about = {name: rest for name, *rest in openpyxl.load_workbook(tmp_path / "grid.xlsx")["about"].iter_rows(values_only=True)}
    assert about["numbers.link.damping"] == [0.4, "N s/m", "damping c"]
    told = {row[0]: row[2] for row in openpyxl.load_workbook(tmp_path / "grid.xlsx")["columns"].iter_rows(values_only=True)}
    assert told["phase [rad]"] == "phase of the second module φ" and "1: not settled" in told["steadiness"]
    again = ss.read(tmp_path / "run.xlsx")
    assert any("3 sheets; the first one, 'data', is read" in note for note in again.notes)


def test_points_of_a_branch_have_units_and_the_branch_itself_is_refused_with_the_way(tmp_path):
    branch = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=4e-4, stop=6e-4, tilt_deg=1.7, law="coulomb")
    head, *_ = read_xlsx(ss.studies.export(branch.points, tmp_path / "branch.xlsx"))
    assert {"amplitude [m]", "v [m/s]", "mean_velocity [m/s]"} <= set(head)
    with pytest.raises(ss.InputError, match=r"a Branch is given; .* export\(branch.points, 'branch.xlsx'\)"):
        ss.studies.export(branch, tmp_path / "branch.xlsx")


def test_a_sheet_that_is_too_long_says_what_to_type(run, tmp_path, monkeypatch):
    monkeypatch.setattr("stickslip.basics.workbooks._ROWS", 50)
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
