"""Reports of runs and studies: one page that needs nothing else and says what was computed."""

import json
import re

import numpy as np
import pytest

import stickslip as ss
from stickslip.cli import main
from stickslip.report import run_page, study_page
from stickslip.report.html import outside_addresses
from stickslip.report.of_run import moments


@pytest.fixture(scope="module")
def run():
    return ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb"), periods=20)


def test_the_page_of_a_run_says_its_motion_and_every_number_with_its_unit(run):
    text = run_page(run, "A <robot>")
    assert "A &lt;robot&gt;" in text and "2.01468 mm/s" in text and "I (pattern +0-0" in text
    assert "205.4601595 rad/s" in text and "0.0005525 m" in text and "prefers" not in text.partition("<script>")[2]
    assert outside_addresses(text) == [] and text.count("data:image/svg+xml") == 3


def test_the_moving_picture_is_the_last_motion_period(run):
    found = moments(run)
    assert found["t"][-1] == pytest.approx(1e3 * run.period_time, rel=1e-5)
    assert found["x"][-1] - found["x"][0] == pytest.approx(1e3 * ss.mean_velocity(run) * run.period_time, rel=1e-4)
    assert max(found["v"]) == pytest.approx(1e3 * run.v.max(), rel=1e-3)  # 480 instants see the crest to (pi/480)^2 of it
    assert json.loads(re.search(r'id="moments">(.*?)</script>', run_page(run, "x"))[1]) == found


def test_the_page_of_a_study_counts_and_ranks(tmp_path):
    grid = ss.sweep(ss.presets.coulomb_robot, alpha_plus=np.linspace(0.2, 1.2, 6), alpha_minus=[0.5, 0.9])
    text = study_page(grid, "Twelve")
    kinds = grid.motion_type.values
    for kind in np.unique(kinds):
        assert re.search(rf'<th scope="row">{kind}</th><td class="n">{(kinds == kind).sum()}</td>', text)
    fastest = float(abs(grid.mean_velocity).max())
    assert f"{fastest:.6g}" in text and outside_addresses(text) == []


def test_the_command_takes_a_preset_a_saved_run_a_folder_and_a_file(run, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    run.save("run.nc")
    ss.sweep(ss.presets.coulomb_robot, alpha_plus=[0.4, 0.5, 0.6], alpha_minus=0.9, out="study")
    ss.export("study", "study.nc")
    for words in (["piezo_rig", "tilt_deg=1.7", "amplitude=5e-4", "law=coulomb", "periods=20"], ["run.nc"], ["study"], ["study.nc"]):
        assert main(["report", *words, "--out", "page.html", "--json"]) == 0
        told = json.loads(capsys.readouterr().out)
        assert told["bytes"] == (tmp_path / "page.html").stat().st_size > 10_000
    assert main(["report", "run.nc", "periods=3"]) == 2 and "is finished" in capsys.readouterr().err
    assert main(["report", "nothing.nc"]) == 2 and "cannot be read" in capsys.readouterr().err
