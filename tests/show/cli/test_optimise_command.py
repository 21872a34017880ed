"""`stickslip optimise`: words and study files ask the same, what is found is kept, and what is wrong is told in words of the shell."""

import json
from pathlib import Path

import pytest

import stickslip as ss
from rows import each_row
from stickslip.inverse.optimisation.candidates import Candidates
from stickslip.show.cli import main

RIG = ["piezo_rig", "tilt_deg=3", "amplitude=7e-4", "law=coulomb"]
OVER = ["--over", "drive.amplitude=1e-4..7e-4", "--limit", "relative_acceleration=..20"]
FILE = """
make = "piezo_rig"
[arguments]
tilt_deg = 3
amplitude = 7e-4
law = "coulomb"
[optimise.over]
"drive.amplitude" = [1e-4, 7e-4]
[optimise.subject_to]
relative_acceleration = "..20"
"""


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_words_and_a_study_file_ask_the_same_and_the_best_machine_asks_it_again(capsys):
    Path("asked.toml").write_text(FILE, encoding="utf-8")
    assert main(["optimise", *RIG, *OVER, "--out", "best.toml", "--search", "search.json", "--json"]) == 0
    typed = json.loads(capsys.readouterr().out)
    assert main(["optimise", "asked.toml", "--json"]) == 0
    filed = json.loads(capsys.readouterr().out)
    assert typed["best"] == filed["best"]
    assert typed["optimise"] == filed["optimise"]
    assert main(["optimise", "best.toml", "--json"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert again["optimise"] == typed["optimise"]
    assert again["given"]["mean_velocity"] == pytest.approx(typed["best"]["mean_velocity"], rel=1e-12)
    assert again["best"]["mean_velocity"] == pytest.approx(typed["best"]["mean_velocity"], rel=1e-8)
    # A omega^2 = 20 is the limit, and the speed of a sine grows with it: Python says the same
    rig = ss.presets.piezo_rig(tilt_deg=3.0, amplitude=7e-4, law="coulomb")
    at_limit = rig.replace({"drive.amplitude": 20.0 / rig.drive.omega**2})
    assert typed["best"]["mean_velocity"] == pytest.approx(ss.periodic_orbit(at_limit).mean_velocity, rel=1e-6)


def test_the_record_of_a_search_tells_how_it_went(capsys):
    assert main(["optimise", *RIG, *OVER, "--search", "search.json"]) == 0
    record = json.loads(Path("search.json").read_text(encoding="utf-8"))
    tried, best = record["history"]["tried"], record["history"]["best"]
    assert tried == sorted(tried)
    assert tried[-1] <= record["tried"]
    assert best == sorted(best)
    assert best[-1] == pytest.approx(record["best"]["mean_velocity"], rel=1e-6)  # candidates are run to 1e-6
    assert record["active"] == ["relative_acceleration"]
    assert "optimise piezo_rig" in record["command"]
    assert ss.Robot.from_toml(record["study_file"]).drive.amplitude == record["parameters"]["drive.amplitude"]


def test_ctrl_c_keeps_the_best_so_far(capsys, monkeypatch):
    run, calls = Candidates.values, []

    def interrupted(self, U):
        calls.append(len(U))
        if len(calls) == 3:
            raise KeyboardInterrupt
        return run(self, U)

    monkeypatch.setattr(Candidates, "values", interrupted)
    assert main(["optimise", *RIG, *OVER, "--out", "best.toml"]) == 130
    out = capsys.readouterr().out
    assert "interrupted: the search did not end, and this is the best so far" in out
    assert f"candidates             {sum(calls[:2])}" in out
    assert ss.Robot.from_toml(Path("best.toml").read_text(encoding="utf-8")).drive.amplitude < 7e-4


def test_ctrl_c_before_anything_was_tried_says_so(capsys, monkeypatch):
    def interrupted(self, U):
        raise KeyboardInterrupt

    monkeypatch.setattr(Candidates, "values", interrupted)
    assert main(["optimise", *RIG, *OVER]) == 130
    assert "optimise was interrupted" in capsys.readouterr().err


@pytest.mark.slow
def test_the_report_says_what_was_searched(capsys):
    words = [*OVER, "--over", "drive.omega=100..240", "--limit", "drive_power=..0.001", "--report", "best.html"]
    assert main(["optimise", *RIG, *words]) == 0
    capsys.readouterr()
    page = Path("best.html").read_text(encoding="utf-8")
    for told in ("What was searched", "0.0001 to 0.0007", "100 to 240", "reached", "for 1 % more", "of the limit for small friction",
                 "Gain and cost", "it is not proved", "How it moves", "--report best.html"):  # fmt: skip
        assert told in page, told


@each_row(
    ("words", "told"),
    [
        ([], "type for example --over drive.amplitude=2e-4..8e-4"),
        (["--over", "amplitude=1e-4..7e-4", "--limit", "strok=..1"], "did you mean 'drive.amplitude'?"),
        (["--over", "amplitude=1e-4..7e-4", "--limit", "strok=..1"], "did you mean 'stroke'?"),
        (["--over", "drive.amplitude=7e-4..1e-4"], "type 0.0001..0.0007"),
        (["--over", "drive.amplitude=1e-4"], "type for example --over"),
        (["--over", "drive=pieces:4"], "--limit relative_acceleration=..60"),
        (["--over", "drive=pieces:1"], "--over drive=pieces:1"),
        ([*OVER, "--uncertain", "friction.mu_plus=0.1"], "--uncertain friction.mu_plus=0.15+-0.01"),
        ([*OVER, "--quantile", "0.1"], "--uncertain"),
        ([*OVER, "--maximise", "mean_velocity", "--minimise", "drive_power"], "allowed is one of them"),
        ([*OVER, "--limit", "stroke=..1e-9"], "widen these limits in --limit"),
        ([*OVER, "--out", "best.json"], ".toml"),
        ([*OVER, "periods=3"], "'periods' is not known"),
    ],
)
def test_bad_words_say_what_to_type(words, told, capsys):
    assert main(["optimise", *RIG, *words]) == 2
    assert told in capsys.readouterr().err


def test_a_bad_table_is_told_at_once(capsys):
    Path("bad.toml").write_text(FILE + '[optimise.robust]\n"friction.mu_plus" = "wide"\n[optimise.ove]\n', encoding="utf-8")
    assert main(["optimise", "bad.toml"]) == 2
    err = capsys.readouterr().err
    assert "friction.mu_plus=wide" in err
    assert "did you mean 'over'?" in err
