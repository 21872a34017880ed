"""The command line: what it prints, what it returns, and that it never shows a traceback."""

from __future__ import annotations

import csv
import json
import math
import os
import subprocess
import sys
from itertools import permutations, product

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.show.cli import COMMANDS, main
from stickslip.show.cli.arguments import value, values

ROBOT = ["piezo_rig", "tilt_deg=1.7", "amplitude=5.525e-4", "law=coulomb"]


def call(capsys, *words):
    """Exit code, stdout and stderr of one command in this process."""
    code = main(list(words))
    out, err = capsys.readouterr()
    return code, out, err


def strict(text):
    def refuse(constant):
        raise AssertionError(f"{constant} is not JSON")

    return json.loads(text, parse_constant=refuse)


# help -------------------------------------------------------------------------------------------------------------


def test_help_names_every_command(capsys):
    for words in (["--help"], ["help"], ["-h"]):
        code, out, err = call(capsys, *words)
        assert code == 0 and err == "" and all(f"\n  {name}" in out for name in COMMANDS)
    code, out, _ = call(capsys)
    assert code == 2 and "usage: stickslip COMMAND" in out


@each_row("command", COMMANDS)
def test_every_command_explains_itself_and_takes_json(command, capsys):
    with pytest.raises(SystemExit) as done:
        main([command, "--help"])
    assert done.value.code == 0 and "--json" in capsys.readouterr().out


def test_help_of_a_command_in_both_orders(capsys):
    told = []
    for words in (["run", "--help"], ["help", "run"]):
        with pytest.raises(SystemExit):
            main(words)
        told.append(capsys.readouterr().out)
    assert told[0] == told[1] and "usage: stickslip run" in told[0]
    code, _, err = call(capsys, "help", "rn")
    assert code == 2 and "did you mean 'run'?" in err


def test_version(capsys):
    assert call(capsys, "--version") == (0, f"stickslip {ss.__version__}\n", "")


# run --------------------------------------------------------------------------------------------------------------


def test_run_tells_the_motion_with_units(capsys):
    code, out, _ = call(capsys, "run", *ROBOT, "periods=60")
    assert code == 0
    assert "margin             0.0" in out and "no motion period" not in out
    for words in ("0.002014682 m/s", "I  (pattern +0-0)", "1 drive period", "forward 53.7 %", "J", "finished, 60 periods", "stickslip 0."):
        assert words in out
    assert "\x1b" not in out


def test_run_as_json_is_strict_and_complete(capsys):
    code, out, _ = call(capsys, "run", *ROBOT, "--json", "periods=60")
    record = strict(out)
    assert code == 0 and record["mean_velocity"] == pytest.approx(0.002014682, rel=1e-6)
    assert record["motion"]["type"] == "I" and record["motion"]["slip_ratio"] is None and record["periods"] == 60
    assert record["parameters"]["drive.amplitude"] == 5.525e-4 and record["provenance"]["versions"]["stickslip"] == ss.__version__


def test_run_shows_notes_and_twin_of_a_dynamic_law(capsys):
    code, out, _ = call(capsys, "run", *ROBOT[:3])
    assert (
        code == 0
        and "0.00174132" in out
        and "not passive" not in out
        and "with Coulomb friction I" in out
        and "Taylor12 at rtol 1e-06" in out
    )


def test_run_takes_solver_arguments_and_multiples_of_pi(capsys):
    words = ["periods=10", "settle=2", "samples=50", "start.v=0.01", "omega=65.4pi", "method=rk4", "steps=500"]
    record = strict(call(capsys, "run", *ROBOT, *words, "--json")[1])
    assert record["settle"] == 2 and record["counts"]["steps"] == 5000 and record["parameters"]["drive.omega"] == pytest.approx(205.4601595)


def test_run_says_what_was_not_found_and_counts_one_as_one(capsys):
    out = call(capsys, "run", *ROBOT[:3], "periods=1", "method=rk4", "steps=700")[1]
    assert "the run is too short to say whether the motion has settled; type more periods" in out and "(not settled)" in out
    assert "finished, 1 period (0 to settle)" in out and "rk4 with 700 steps per period" in out and "rtol" not in out
    record = strict(call(capsys, "run", *ROBOT[:3], "periods=1", "method=rk4", "steps=700", "--json")[1])
    assert record["rtol"] is None and "too short" in record["notes"][-1] and record["steadiness"]["word"] == "not settled"


def test_run_writes_figure_and_data(tmp_path, capsys):
    for figure, data in (("run.png", "run.nc"), ("run.svg", "run.mat"), ("run.pdf", "run.csv")):
        code, out, _ = call(
            capsys, "run", *ROBOT, "periods=4", "samples=40", "--figure", str(tmp_path / figure), "--data", str(tmp_path / data)
        )
        assert code == 0 and str(tmp_path / data) in out
        assert (tmp_path / figure).stat().st_size > 1000 and (tmp_path / data).stat().st_size > 1000
    assert ss.load(tmp_path / "run.nc").periods == 4
    assert (tmp_path / "run.csv").read_text(encoding="utf-8").startswith("t [s],x [m],v [m/s],")


def test_run_takes_a_study_file(tmp_path, capsys):
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=4e-4, law="coulomb")
    study = tmp_path / "study.toml"
    study.write_text(robot.to_toml() + "\n[solve]\nperiods = 24\nstart = { v = 0.01 }\n", encoding="utf-8")
    record = strict(call(capsys, "run", str(study), "drive.amplitude=5.525e-4", "--json")[1])
    assert record["periods"] == 24 and record["mean_velocity"] == pytest.approx(0.002014682, rel=1e-6)
    assert strict(call(capsys, "run", str(study), "periods=30", "--json")[1])["periods"] == 30


# the others -------------------------------------------------------------------------------------------------------


def test_check_prints_its_verdict(capsys):
    code, out, _ = call(capsys, "check", *ROBOT, "periods=40")
    assert code == 0 and "digits of the mean velocity" in out and "closed formula" in out
    assert strict(call(capsys, "check", *ROBOT, "periods=40", "--no-scipy", "--json")[1])["digits"] >= 9


def test_check_takes_what_it_can_of_a_mechanisms_file(tmp_path, capsys):
    """Arguments of other commands in [solve] are for them; what has no period is judged over its duration."""
    file = tmp_path / "bench.toml"
    law = ss.Coulomb(0.3, 0.5)
    pushed = ss.ForcedOscillator(mass=1.0, stiffness=0.0, damping=0.0, force=1.0, omega=0.7, friction=law)
    file.write_text(pushed.to_toml() + "\n[solve]\nperiods = 20\nsamples = 100\n")
    code, out, _ = call(capsys, "check", str(file), "--no-scipy")
    assert code == 0 and "skipped: it is for Coulomb friction and a harmonic drive" in out
    file.write_text(ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=law).to_toml() + "\n[solve]\nduration = 60.0\n")
    code, out, _ = call(capsys, "check", str(file), "--no-scipy")
    assert code == 0 and ("hold for a run of this length only" in out or "no digit is certain" in out)


def test_sweep_prints_a_table_and_writes_it(tmp_path, capsys):
    words = ["sweep", "piezo_rig", "law=coulomb,coulomb-static", "tilt_deg=1.7", "amplitude=4e-4..6e-4:3"]
    code, out, _ = call(capsys, *words, "--out", str(tmp_path / "grid.nc"))
    rows = out.splitlines()
    assert code == 0 and len(rows) == 1 + 6 + 1 and "amplitude [m]" in rows[0] and "mean velocity [m/s]" in rows[0]
    assert "0.0009004046" in rows[1] and "6 cases: " in rows[-1]
    assert (tmp_path / "grid.nc").exists()
    record = strict(call(capsys, *words, "--json", "--out", str(tmp_path / "grid.csv"))[1])
    assert record["axes"]["amplitude"] == [4e-4, 5e-4, 6e-4] and len(record["columns"]["mean_velocity"]) == 2


AXES = {"tilt_deg": (1.7, 2.5), "amplitude": (4e-4, 5e-4, 8e-4), "law": ("coulomb", "coulomb-static")}


@pytest.fixture(scope="module")
def single():
    """Mean velocities of single solves, by their numbers."""
    points = [dict(zip(AXES, point, strict=True)) for point in product(*AXES.values())]
    return {tuple(p.values()): float(ss.mean_velocity(ss.solve(ss.presets.piezo_rig(**p), periods=200))) for p in points}


@pytest.mark.parametrize("order", [order for n in (2, 3) for order in [*permutations(AXES, n)][::2]], ids="-".join)
def test_every_row_of_a_sweep_is_its_own_case(order, single, capsys, tmp_path):
    fixed = {name: values[0] for name, values in AXES.items() if name not in order}
    words = [f"{name}={','.join(map(str, AXES[name]))}" for name in order] + [f"{k}={v}" for k, v in fixed.items()]
    wanted = {
        point: single[tuple({**fixed, **dict(zip(order, point, strict=True))}[n] for n in AXES)] for point in product(*map(AXES.get, order))
    }
    rows = call(capsys, "sweep", "piezo_rig", *words)[1].splitlines()
    assert [head.split()[0] for head in rows[0].split("  ") if head.strip()][: len(order)] == list(order)
    for (point, velocity), row in zip(wanted.items(), rows[1:-1], strict=True):
        cells = row.split()
        assert cells[: len(order)] == [str(p) for p in point] and float(cells[len(order)]) == pytest.approx(velocity, rel=1e-6)
    record = strict(call(capsys, "sweep", "piezo_rig", *words, "--json", "--out", str(tmp_path / "grid.csv"))[1])
    assert list(record["axes"]) == list(order) and all(record["axes"][n] == list(AXES[n]) for n in order)
    velocities = np.array(record["columns"]["mean_velocity"])
    assert velocities.shape == tuple(len(AXES[n]) for n in order)
    assert velocities.ravel() == pytest.approx(list(wanted.values()), rel=1e-6)
    with (tmp_path / "grid.csv").open(encoding="utf-8", newline="") as file:
        lines = list(csv.DictReader(file))
    assert {line["status"] for line in lines} == {"settled"}
    assert [float(line["mean_velocity [m/s]"]) for line in lines] == velocities.ravel().tolist()


def test_sweep_says_which_cases_found_no_period(capsys):
    out = call(capsys, "sweep", *ROBOT[:2], "amplitude=4e-4,5e-4", "periods=1")[1]
    assert "  none  " in out and "2 cases have not settled: " in out.splitlines()[-1]
    chaos = call(capsys, "sweep", *ROBOT[:2], "amplitude=4e-4", "mu0=0.05", "periods=320")[1]
    assert "1 case: no motion period was found within 320 periods: " in chaos.splitlines()[-1]
    assert call(capsys, "sweep", *ROBOT)[1].splitlines()[-1] == "piezo_rig: 1 case: 1 settled"


@each_row(("command", "word"), [("presets", "piezo_rig"), ("laws", "lugre"), ("drives", "harmonic")])
def test_lists(command, word, capsys):
    assert f"  {word} " in call(capsys, command)[1] or f"{word}:" in call(capsys, command)[1]
    assert f"{word}:" in call(capsys, command, word)[1]
    entry = strict(call(capsys, command, "--json")[1])[command][word]
    assert all(argument["meaning"] for argument in entry["arguments"].values())


def test_lists_are_clean_text_with_units(capsys):
    for command in ("presets", "laws", "drives"):
        out = call(capsys, command)[1]
        assert not any(mark in out for mark in (":math:", "`", "\\", "default None"))
    assert "σ₁      N s/m  needed   Bristle (micro-)damping." in call(capsys, "laws", "lugre")[1]
    assert (
        "ξ(t) = A sin(ω t + φ)" in call(capsys, "drives")[1]
        and "bristle stiffness. LuGre numbers" in call(capsys, "presets", "piezo_rig")[1]
    )


@pytest.mark.slow
def test_warmup_compiles_for_one_case_and_for_many(tmp_path):
    assert process("warmup", STICKSLIP_CACHE_DIR=str(tmp_path)).returncode == 0
    for kind, method in product(("single", "lanes"), ("taylor12", "taylor8")):
        assert len(list(tmp_path.glob(f"{kind}_lugre_harmonic_{method}_*.py"))) == 1
        assert list((tmp_path / "__pycache__").glob(f"{kind}_lugre_harmonic_{method}_*.nbi"))


def test_doctor_finds_the_cache_folder(capsys, monkeypatch, tmp_path):
    code, out, _ = call(capsys, "doctor")
    assert code == 0 and os.environ["STICKSLIP_CACHE_DIR"] in out
    (tmp_path / "file").touch()
    monkeypatch.setenv("STICKSLIP_CACHE_DIR", str(tmp_path / "file" / "folder"))
    record = strict(call(capsys, "doctor", "--json")[1])
    assert record["cache"]["writable"] is False and "STICKSLIP_CACHE_DIR" in record["problems"][0]


def test_paper_hands_over_what_was_asked(capsys, monkeypatch, tmp_path):
    class Result:
        def to_dict(self):
            return {"speed": float("nan")}

        def __str__(self):
            return "the paper"

    def reproduce(out, fast, progress):
        for i in range(6, 31):
            progress(f"drawing Figure {i}", i, 30)
        progress("writing: the report", 0, 1)
        asked.append((out, fast))
        return Result()

    asked = []
    monkeypatch.setattr("stickslip.paper.reproduce", reproduce)
    assert call(capsys, "paper", "--out", str(tmp_path / "a" / "b"), "--fast", "--json") == (
        0,
        '{\n "speed": null\n}\n',
        "this takes about a minute the first time\ndrawing Figure 6 …\nwriting …\n",
    )
    code, out, err = call(capsys, "paper")
    assert (code, out) == (0, "the paper\n") and err.startswith("this takes about two minutes the first time\n")
    assert [(str(out), fast) for out, fast in asked] == [(str(tmp_path / "a" / "b"), True), ("stickslip-paper", False)]
    (tmp_path / "file").touch()
    code, _, err = call(capsys, "paper", "--out", str(tmp_path / "file" / "folder"))
    assert code == 2 and "cannot be made or written" in err


# grammar ----------------------------------------------------------------------------------------------------------


@each_row(
    ("text", "told"),
    [
        ("200", 200),
        ("-3", -3),
        ("5e-4", 5e-4),
        (".18", 0.18),
        ("lugre", "lugre"),
        ("none", None),
        ("pi", 3.141592653589793),
        ("2*pi", 6.283185307179586),
    ],
)
def test_values_are_read(text, told):
    assert value(text) == told and type(value(text)) is type(told)


@each_row(
    ("text", "told"), [("1,2,3", [1, 2, 3]), ("0..1:3", [0.0, 0.5, 1.0]), ("4e-4..8e-4:2", [4e-4, 8e-4]), ("a,b", ["a", "b"]), ("5", 5)]
)
def test_several_values_are_read(text, told):
    assert values(text) == told


# errors -----------------------------------------------------------------------------------------------------------


@each_row(
    ("words", "told"),
    [
        (["rn"], "did you mean 'run'?"),
        (["run"], "run: ROBOT is missing"),
        (["run", "piezo_rg"], "did you mean 'piezo_rig'?"),
        (["run", "nowhere.toml"], "'nowhere.toml' cannot be read: No such file"),
        (["run", "."], "cannot be read"),
        (["run", *ROBOT, "--jsn"], "did you mean '--json'?"),
        (["run", *ROBOT, "peridos=10"], "did you mean 'periods'?"),
        (["run", *ROBOT, "frequency=40"], 'type omega="40 Hz"'),
        (["sweep", *ROBOT, "--out", "grid.ods"], "'grid.ods' ends in '.ods'; allowed are .nc, .mat, .csv, .xlsx, .parquet"),
        (["report", "not-there.nc"], "there is no 'not-there.nc'; give a .nc file"),
        (["run", *ROBOT, "amplitude"], "'amplitude' is not NAME=VALUE"),
        (["run", *ROBOT, "tilt_deg=2"], "tilt_deg is given twice"),
        (["run", *ROBOT[:2], "amplitude=1e-4..2e-4:3"], "that is for `stickslip sweep`"),
        (["run", "piezo_rig", "amplitude=4e-4"], "tilt_deg is missing"),
        (["run", *ROBOT[:2], "amplitude=-1"], "amplitude = -1"),
        (["run", *ROBOT[:2], "amplitude=nan"], "amplitude = nan"),
        (["run", *ROBOT[:2], "amplitude=much"], "'much' is not a number"),
        (["run", *ROBOT[:3], "law=colomb"], "did you mean 'coulomb'?"),
        (["run", *ROBOT, "periods=0"], "periods = 0; allowed is a whole number from 1"),
        (["run", *ROBOT, "method=rk5"], "did you mean 'rk4'?"),
        (["run", *ROBOT, "--figure", "run.jpg"], "allowed are .png, .svg, .pdf"),
        (["run", *ROBOT, "--data", "nowhere/at/all/run.nc"], "does not exist; make it first"),
        (["sweep", *ROBOT[:2], "amplitude=1e-4..b:3"], "is not a range"),
        (["sweep", *ROBOT[:2], "amplitude=1e-4..2e-4"], "add their number, such as 1e-4..2e-4:9"),
        (["sweep", *ROBOT[:2], "amplitude=1e-4,-1e-4"], "amplitude[1] = -0.0001"),
        (["check", *ROBOT, "samples=3"], "'samples' is not known"),
        (["presets", "piezo"], "did you mean 'piezo_rig'?"),
        (["laws", "lugree", "colomb"], "did you mean 'coulomb'?"),
        (["mechanisms", "pulled"], "did you mean 'pulled_mass'?"),
        (["completion", "bsh"], "did you mean 'bash'?"),
        (["paper", "--fats"], "did you mean '--fast'?"),
        (["run", "PIEZO_RIG"], "did you mean 'piezo_rig'?"),
        (["read"], "read: FILE is missing; type for example stickslip read run.csv"),
        (["merge", "a"], "--out is missing; type for example stickslip merge part1 part2 --out whole"),
        (["merge", "a", "--out"], "--out needs a value: --out FOLDER"),
        (["read", "a", "b"], "'b' is an unexpected argument; options are --help"),
        (["identify", *ROBOT, "--mean", "1", "--level", "high"], "--level 'high'; allowed is a number"),
        (["identify", *ROBOT, "--mean", "1", "--free", "mu0=0.1..0.2", "--level", "95"], "--level: 95; allowed is above 0 and below 1"),
        (["map", *ROBOT[:2], "amplitude=1e-4..8e-4:9999", "omega=60..300:9999", "--x", "omeg"], "did you mean 'omega'?"),
        (
            ["map", *ROBOT[:2], "law=coulomb", "amplitude=1e-4..8e-4:9999"],
            "amplitude has several values; allowed are exactly two; type stickslip sweep with the same words",
        ),
        (["sweep", *ROBOT, "--sobol", "4"], "type for example amplitude=1e-4..8e-4"),
        (["sweep", *ROBOT, "--resume"], "type for example --out study"),
        (["sweep", *ROBOT, "--tile", "0", "--out", "study"], "allowed is a whole number of cases from 1"),
        (["sweep", *ROBOT, "--table", "no.csv"], "'no.csv' cannot be read: No such file or directory; give"),
        (["export", "a", "b"], "'b' has no ending; allowed are .nc"),
    ],
)
def test_bad_input_is_told_in_a_sentence(words, told, capsys):
    code, out, err = call(capsys, *words)
    assert code == 2 and out == "" and err.startswith("stickslip: ")
    assert told in err and "Traceback" not in err


def test_all_that_is_wrong_is_told_at_once(capsys):
    err = call(capsys, "run", "piezo_rig", "amplitud=1", "periodss=2", "x")[2]
    assert "5 problems" in err  # two missing, two unknown, one without a value


@each_row(
    ("words", "told", "not_told"),
    [
        (["run", "piezo_rig", "amplitude=abc"], ["2 problems", "tilt_deg is missing", "'abc' is not a number"], "amplitude is missing"),
        (["run", "piezo_rig", "tilt_deg", "amplitude=", "mu0=-1", "periods=0"], ["4 problems", "mu0 = -1", "periods = 0"], "missing"),
        (["run", "piezo_rig", "amplitude=1e-4", "mu0=0.001", "f0=0.0001"], ["2 problems", "below mu0"], "friction angle"),
        (["sweep", "piezo_rig", "amplitude=4e-4..8e-4", "law=lugre,colomb", "rtol=2"], ["4 problems", "'coulomb'", ":9", "rtol = 2"], "x"),
    ],
)
def test_names_values_and_solver_arguments_are_judged_together(words, told, not_told, capsys):
    code, _, err = call(capsys, *words)
    assert code == 2 and all(sentence in err for sentence in told) and (not_told not in err or not_told == "x")


def test_a_failed_run_is_exit_code_one(capsys):
    code, out, err = call(capsys, "run", *ROBOT[:3], "method=rk4", "steps=4", "sigma1=1e6", "periods=5")
    assert code == 1 and out == "" and "not a number" in err and "Traceback" not in err


@each_row(
    ("text", "told"),
    [
        ("[robot", "not readable as TOML"),
        ("x = 1", "has no [robot] table"),
        ("[robot]\nbody_mas = 1", "did you mean 'body_mass'"),
        (None, "it is not text"),
        ("good\n[solve]\nperiod = 3", "did you mean 'periods'?"),
    ],
)
def test_unreadable_study_files_say_why(text, told, tmp_path, capsys):
    study = tmp_path / "study.toml"
    if text is None:
        study.write_bytes(b"\xff\xfe\x00\x80")
    else:
        study.write_text(text.replace("good", ss.presets.piezo_rig(tilt_deg=1.7, amplitude=4e-4).to_toml()), encoding="utf-8")
    code, _, err = call(capsys, "run", str(study))
    assert code == 2 and told in err and str(study) in err


# another process --------------------------------------------------------------------------------------------------


def process(*words, **environment):
    return subprocess.run(
        [sys.executable, "-m", "stickslip", *words],
        capture_output=True,
        text=True,
        timeout=120,
        env={**os.environ, **environment},
        check=False,
    )


def test_python_m_stickslip_is_the_command():
    done = process("run", *ROBOT, "periods=20", "--json")
    assert done.returncode == 0 and strict(done.stdout)["status"] == "finished" and done.stderr == ""
    assert process("run", "nothing").returncode == 2


def test_a_closed_pipe_is_no_error():
    done = subprocess.run(
        f"'{sys.executable}' -m stickslip --help | head -1", shell=True, capture_output=True, text=True, timeout=60, check=False
    )
    assert done.stdout.startswith("stickslip:") and done.stderr == ""


def test_compiling_is_announced_on_stderr_only(tmp_path):
    done = process("run", *ROBOT, "periods=20", "method=rk4", "--json", STICKSLIP_CACHE_DIR=str(tmp_path / "new"))
    assert done.returncode == 0 and strict(done.stdout)["method"] == "rk4" and "compiling Coulomb" in done.stderr


@pytest.mark.parametrize(
    ("method", "law"), [("rk4", "coulomb"), ("auto", "coulomb"), pytest.param("auto", "lugre", marks=pytest.mark.slow)]
)
def test_a_cache_that_cannot_be_written_compiles_in_memory(tmp_path, method, law):
    (tmp_path / "file").touch()
    cache = str(tmp_path / "file" / "cache")
    done = process("run", *ROBOT[:-1], f"law={law}", "periods=20", f"method={method}", "--json", STICKSLIP_CACHE_DIR=cache)
    assert done.returncode == 0 and "cannot be written (Not a directory); compiling" in done.stderr, done.stderr
    assert strict(done.stdout)["method"] == ("rk4" if method == "rk4" else {"coulomb": "exact", "lugre": "Taylor12"}[law])


def test_a_map_says_its_law_and_whether_the_fastest_point_is_on_its_edge(capsys):
    out = call(capsys, "map", "coulomb_robot", "alpha_plus=0.1..0.5:3", "alpha_minus=0.2..1.6:8")[1]
    assert out.startswith("coulomb_robot: 24 cases with the law Coulomb\n")
    assert "\nthat is on the edge of alpha_plus: a wider range may have a faster one" in out
    inside = call(
        capsys, "map", "piezo_rig", "law=coulomb", "tilt_deg=1.7", "mu0=0.17..0.2:2", "f0=0.21..0.3:2", "amplitude=6e-4", "--json"
    )
    assert strict(inside[1])["found"]["law"] == "Coulomb"


RIG = """[robot]
body_mass = 0.06259
inner_mass = 0.00948
[robot.drive]
kind = "harmonic"
amplitude = 7e-4
frequency = 25
[robot.friction]
kind = "lugre"
mu_plus = 0.18
mu_minus = 0.18
f_plus = 0.21
f_minus = 0.21
sigma0 = 4e5
sigma1 = 100.0
sigma2 = 0.04
v_s = 2e-3
[robot.track]
kind = "incline"
tilt = 0.03
"""
BELT = """[mechanism]
kind = "block_on_belt"
mass = 1.0
stiffness = 100.0
speed = 0.1
load = 10.0
[mechanism.friction]
kind = "coulomb"
mu_plus = 0.2
mu_minus = 0.2
f_plus = 0.4
f_minus = 0.4
[solve]
duration = 3.0
"""


@pytest.fixture
def files(tmp_path, monkeypatch):
    """A folder with the study files of a robot on an incline and of a block that nothing drives."""
    monkeypatch.chdir(tmp_path)
    for name, text in (("mine.toml", RIG), ("belt.toml", BELT)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def test_a_number_in_another_unit_or_under_another_name_is_told_what_to_type(files, capsys):
    """Hertz and degrees are converted, and what is told to be typed is taken."""
    code, _, err = call(capsys, "run", "mine.toml", "drive.frequency=30", "tilt_deg=1.7")
    assert code == 2 and 'type drive.omega="30 Hz"' in err and "type track.tilt=0.0296706 for 1.7 degrees" in err
    assert call(capsys, "run", "mine.toml", "drive.omega=30 Hz", "track.tilt=0.0296706", "periods=5")[0] == 0
    assert 'drive.omega="20 Hz"' in call(capsys, "sweep", "mine.toml", "drive.frequency=20..30:3")[2]
    bad = RIG.replace("mu_plus", "mu0").replace("tilt = 0.03", "tilt_deg = 1.7").replace("sigma0 = 4e5\n", "").replace("v_s = 2e-3\n", "")
    (files / "bad.toml").write_text(bad, encoding="utf-8")
    err = call(capsys, "run", "bad.toml")[2]
    for words in (
        "type mu_plus = 0.18 and mu_minus = 0.18", "type tilt = 0.0296706 for 1.7 degrees", "type for example sigma0 = 400000",
        "type for example v_s = 0.002", "type for example mu_plus = 0.15",
    ):  # fmt: skip
        assert words in err
    assert "f_plus = 0.21 is below" not in err, "what is missing is not judged"


def test_init_sets_one_number_and_keeps_the_others_and_shows_how_an_incline_is_written(files, capsys):
    assert call(capsys, "init", "q.toml", "--set", "amplitude=5e-4")[0] == 0
    text = (files / "q.toml").read_text(encoding="utf-8")
    wanted = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4)
    assert ss.Robot.from_toml(text) == wanted and "1.7 degrees that the friction above contains already" in text
    assert ss.Robot.from_toml(text).track.folded == wanted.track.folded and "--set incline=gravity" in text
    assert call(capsys, "init", "l.toml", "--law", "dahl")[0] == 0
    assert ss.Robot.from_toml((files / "l.toml").read_text(encoding="utf-8")).track == ss.Incline(tilt=math.radians(1.7)), "it is kept"
    assert call(capsys, "init", "level.toml", "--set", "amplitude=5e-4", "--set", "tilt_deg=0")[0] == 0
    text, wanted = (files / "level.toml").read_text(encoding="utf-8"), ss.presets.piezo_rig(tilt_deg=0.0, amplitude=5e-4)
    inclined = text.replace('kind = "level"', "").replace('# kind = "incline"', 'kind = "incline"').replace("# tilt =", "tilt =")
    assert ss.Robot.from_toml(inclined) == wanted.replace(track=ss.Incline(tilt=0.035))
    assert call(capsys, "init", "b.toml", "--preset", "piezo_beam_rig")[0] == 0


def test_export_takes_a_run_as_well_as_a_study(files, capsys):
    assert call(capsys, "run", *ROBOT, "periods=5", "--data", "run.nc")[0] == 0
    code, out, _ = call(capsys, "export", "run.nc", "run.csv")
    assert code == 0 and "the run in run.nc" in out and (files / "run.csv").read_text().startswith("t [s],x [m]")
    assert call(capsys, "export", "run.nc", "run.mat")[0] == 0
    code, _, err = call(capsys, "export", "run.nc", "run.parquet")
    assert code == 2 and "allowed are .nc, .mat, .csv" in err
    with pytest.raises(ss.InputError, match=r"is a run; type ss.load"):
        ss.open_study("run.nc")


def test_what_counts_drive_periods_counts_returns_of_something_that_nothing_drives(files, capsys):
    """T = 2 (F - f) / (k u) + (2 pi - 2 atan((F - f) omega / (k u))) / omega."""
    code, out, _ = call(capsys, "basins", "belt.toml", "v=-0.1..0.1:3", "settle=30")
    assert code == 0 and "period 1" in out and "100" not in out.splitlines()[0]
    code, out, _ = call(capsys, "lyapunov", "belt.toml", "settle=30", "periods=20", "--json")
    record = json.loads(out)
    assert code == 0 and record["kind"] == "periodic" and record["unit"] == "second" and abs(record["spectrum"][0]) < 1e-6
    code, out, _ = call(capsys, "bifurcation", "belt.toml", "speed=0.1..0.2:3", "settle=30", "--follow", "--json")
    speeds, record = np.array([0.1, 0.15, 0.2]), json.loads(out)
    times = 0.04 / speeds + (2 * np.pi - 2 * np.arctan(0.2 / speeds)) / 10
    np.testing.assert_allclose(record["columns"]["duration"][0], times, rtol=1e-9)
    assert record["branches"][0]["period"] == 1
    code, out, _ = call(capsys, "atlas", "belt.toml", "speed=0.1,0.2", "damping=0.0,0.1", "settle=30", "--starts", "1", "--branches", "0",
                        "--out", "plane")  # fmt: skip
    assert code == 0 and "stick-slip" in out and (files / "plane" / "manifest.json").exists()
    code, out, _ = call(capsys, "sweep", "belt.toml", "speed=0.1,0.2")
    assert code == 0 and "more periods" not in out


def test_a_map_of_a_chain_draws_the_motion_types_of_the_contact_that_is_chosen(capsys, tmp_path):
    words = ["map", "two_modules", "phase=0..3:2", "stiffness=300..1200:2", "--figure", str(tmp_path / "types.png")]
    assert main(words) == 2
    found = capsys.readouterr()
    assert "two_modules: 4 cases" in found.out and "type --contact 'module 1', --contact 'module 2', or --velocity FILE" in found.err
    assert main([*words, "--contact", "module 2"]) == 0 and (tmp_path / "types.png").exists()
    out = capsys.readouterr().out
    assert "% of the plane" in out and out.endswith(f"written to {tmp_path / 'types.png'}\n")
    assert main([*words, "--contact", "module2"]) == 2 and "did you mean 'module 2'" in capsys.readouterr().err
    alone = ["map", "piezo_rig", "law=coulomb", "amplitude=1e-4..6e-4:2", "tilt_deg=0..1:2", "--contact", "body"]
    assert main(alone) == 2 and "this robot has one contact; leave it out" in capsys.readouterr().err


def test_a_diagram_of_a_capsule_settles_as_long_as_asked_and_is_drawn(capsys, tmp_path):
    """`settle` comes before the strobe points and is no part of a run's periods; the figure shows the velocity of the body."""
    figure = tmp_path / "doubling.png"
    words = ["capsule", "omega=1.17..1.18:2", "settle=900", "--batch", "--figure", str(figure)]
    assert main(["bifurcation", *words]) == 0 and figure.stat().st_size > 5000
    assert "period 2 from 1.17; " in capsys.readouterr().out
    assert main(["bifurcation", *words, "--observable", "w"]) == 2, "there is no such column"
    found = capsys.readouterr()
    assert "period 2 from 1.17; " in found.out and "'w'" in found.err and "v.inner" in found.err, "what was computed is told all the same"
    assert main(["bifurcation", "capsule", "omega=1.17..1.18:2", "settle=-3"]) == 2
    assert "settle = -3; allowed is a whole number from 1" in capsys.readouterr().err


def test_a_word_that_is_no_law_is_told_the_laws_once(capsys):
    err = call(capsys, "run", "piezo_rig", "tilt_deg=1.7", "amplitude=5e-4", "law=dry")[2]
    assert err.count("coulomb-static") == 1
    assert "did you mean 'lugre'?" in call(capsys, "run", "piezo_rig", "tilt_deg=1.7", "amplitude=5e-4", "law=lugree")[2]


def test_a_law_of_ones_own_is_told_how_commands_and_study_files_take_it(files, capsys):
    lines = [
        "from dataclasses import dataclass",
        "import stickslip as ss",
        "",
        "@dataclass(frozen=True)",
        "class Dry:",
        "    mu: float = 0.2",
    ]
    lines += ["    def sliding(self, v, load):", "        return ss.maths.where(v > 0, self.mu * load, -self.mu * load)"]
    lines += ["    def breakaway(self, load):", "        return -self.mu * load, self.mu * load"]
    lines += ["def rig():", "    return ss.presets.piezo_rig(tilt_deg=0.0, amplitude=7e-4).replace(friction=Dry())"]
    (files / "dry_rig.py").write_text("\n".join(lines), encoding="utf-8")
    assert call(capsys, "run", "dry_rig.py:rig", "periods=5", "--data", "dry.nc")[0] == 0
    code, _, err = call(capsys, "report", "dry.nc")
    assert code == 2 and "as file.py:function" in err
    with pytest.raises(ss.InputError, match=r'make = "dry_rig.py:rig" .*--allow-code'):
        sys.modules["dry_rig"].rig().to_toml()
    (files / "dry.toml").write_text('make = "dry_rig.py:rig"', encoding="utf-8")
    assert call(capsys, "run", "dry.toml", "periods=5", "--allow-code")[0] == 0


def test_a_function_that_makes_a_belt_has_its_cycles_followed_to_where_stick_slip_ends(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    law = "ss.Stribeck(1.0, 1.0, 1.5, 1.5, v_s=0.2)"
    line = f"return ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=speed, friction={law}, damping=0.3)"
    (tmp_path / "weakening.py").write_text(f"import stickslip as ss\n\n\ndef belt(speed=0.5):\n    {line}\n")
    words = ["weakening.py:belt", "--allow-code", "speed=0.64..0.68:2", "start.x=0.6", "start.v=0.6", "settle=20", "--follow", "--json"]
    code, out, err = call(capsys, "bifurcation", *words)
    assert code == 0, err
    ends = [special["value"] for branch in strict(out)["branches"] for special in branch["special"] if special["kind"] == "type-border"]
    assert ends == pytest.approx([0.667344684331], abs=1e-9)


def test_where_a_command_computes_is_said_by_executor(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pools.py").write_text(
        "from concurrent.futures import ThreadPoolExecutor\n\n\ndef two():\n    return ThreadPoolExecutor(2)\n\n\nthree = 3\n"
    )
    words = ("coulomb_robot", "alpha_plus=0.4..0.7:4", "alpha_minus=0.9")
    here = call(capsys, "sweep", *words)
    assert call(capsys, "sweep", *words, "--executor", "pools.py:two")[:2] == here[:2] and here[0] == 0
    for wrong, said in {
        "processes": "has no number of processes", "processes:0": "from 1 to 1024", "eight": "'eight' is not known; allowed is processes:N",
        "pools.py:three": "has no function 'three'", "pools.py:tow": "did you mean 'two'?",
    }.items():  # fmt: skip
        code, _, err = call(capsys, "sweep", *words, "--executor", wrong)
        assert code == 2 and said in err and "--executor" in err
    assert "leave it out, or give a range" in call(capsys, "lyapunov", *ROBOT, "--executor", "processes:2")[2]


def test_doublings_that_are_not_followed_are_said_with_what_follows_them():
    from types import SimpleNamespace

    from stickslip.show.cli.commands.bifurcation import _left_out

    def branch(period, *flips):
        return SimpleNamespace(period=period, special=[SimpleNamespace(kind="flip", rounded=f"{value:g}") for value in flips])

    (note,) = _left_out("mu0", [branch(1, 0.0378), branch(2, 0.0382)])
    assert "period 4 and more are not followed; they begin at mu0 = 0.0382" in note and "ss.continuation(...).doubled().doubled()" in note
    assert _left_out("mu0", [branch(1)]) == _left_out("mu0", [branch(1, 0.0378), branch(2)]) == _left_out("mu0", []) == []


def test_the_section_of_a_machine_without_a_period_is_named(capsys, tmp_path):
    file, law = tmp_path / "belt.toml", ss.Coulomb(0.2, 0.2, f_plus=0.3, f_minus=0.3)
    file.write_text(ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=law, load=1.0).to_toml())
    _, out, _ = call(capsys, "lyapunov", str(file), "--section", "x,0.12")
    assert "the point on the section (x falls through 0.12) returns after 1" in out
    assert "period 1" in call(capsys, "basins", str(file), "x=0.0,0.05", "--section", "v,0.05,1", "--turns", "2")[1]
    assert "type for example --section v,0.1,1" in call(capsys, "basins", str(file), "x=0.0,0.05", "--section", "v,a")[2]
    words = ("tilt_deg=1.7", "amplitude=8e-4", "law=coulomb")
    assert "leave section out" in call(capsys, "lyapunov", "piezo_rig", *words, "--section", "v")[2]
