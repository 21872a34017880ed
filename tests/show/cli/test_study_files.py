"""Study files: what they may say, that errors name their lines and come at once, and that code in them needs permission."""

import json
import re
import sys

import pytest

import stickslip as ss
from rows import each_row
from stickslip.show.cli import main

RIG = "[robot]\nbody_mass = 0.06\ninner_mass = 0.01\n[robot.drive]\nkind = 'harmonic'\namplitude = 5e-4\nfrequency = 33.0\n"
COULOMB = "[robot.friction]\nkind = 'coulomb'\nmu_plus = 0.12\nmu_minus = 0.2\n"
CODE = """\
import stickslip as ss
open("ran", "w").close()
def walker(amplitude):
    return ss.presets.piezo_rig(1.7, amplitude, law="coulomb")
"""


@pytest.fixture
def call(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)

    def run(*words, **files):
        for name, text in files.items():
            (tmp_path / f"{name}.{'py' if name == 'mine' else 'toml'}").write_text(text, encoding="utf-8")
        code = main(list(words))
        out, err = capsys.readouterr()
        return code, out, err

    return run


def test_arguments_in_the_file_are_those_of_the_command_line(call):
    text = f'{RIG}{COULOMB}[arguments]\n"drive.amplitude" = 4e-4\n[solve]\nperiods = 30\n'
    from_file = json.loads(call("run", "a.toml", "--json", a=text)[1])
    typed = json.loads(call("run", "b.toml", "drive.amplitude=4e-4", "periods=30", "--json", b=RIG + COULOMB)[1])
    assert from_file["mean_velocity"] == typed["mean_velocity"] and from_file["parameters"]["drive.amplitude"] == 4e-4
    over = json.loads(call("run", "a.toml", "drive.amplitude=6e-4", "--json", a=text)[1])
    assert over["parameters"]["drive.amplitude"] == 6e-4 and over["periods"] == 30


def test_a_file_may_name_a_preset_and_several_values_are_for_a_sweep(call):
    text = 'make = "piezo_rig"\n[arguments]\ntilt_deg = 1.7\nlaw = "coulomb"\namplitude = "4e-4..6e-4:3"\n'
    found = json.loads(call("sweep", "a.toml", "--json", a=text)[1])
    assert found["axes"]["amplitude"] == [4e-4, 5e-4, 6e-4]
    code, _, err = call("run", "a.toml")
    assert code == 2 and "is several values" in err
    assert call("run", "a.toml", "amplitude=5e-4", "periods=20")[0] == 0


def test_everything_wrong_with_a_file_is_told_at_once_with_its_lines(call):
    text = "[robot]\nbody_mas = 1\ninner_mass = -1\n[robot.drive]\nkind = 'harmonic'\nomega = 200.0\n[robot.friction]\nkind = 'lugree'\n"
    code, _, err = call("run", "a.toml", a=text + "[solve]\nperiod = 10\nrtol = 5\n[slove]\nx = 1\n")
    assert code == 2 and "study file 'a.toml': 8 problems" in err
    for sentence in (
        "line 1: robot.body_mass is missing",
        "line 2: robot.body_mas is not known; did you mean 'body_mass'?",
        "line 3: robot.inner_mass = -1",
        "line 4: robot.drive.amplitude is missing",
        "line 8: robot.friction.kind = 'lugree'; did you mean 'lugre'?",
        "line 10: solve.period is not known; did you mean 'periods'?",
        "line 11: solve.rtol = 5; allowed is",
        "line 12: slove is not known; did you mean 'solve'?",
    ):
        assert sentence in err
    lines = [int(line.partition("line ")[2].partition(":")[0]) for line in err.splitlines() if "line " in line]
    assert lines == sorted(lines)


def test_text_that_is_no_toml_says_where(call):
    assert "(at line 2, column" in call("run", "a.toml", a="[robot]\nbody_mass = = 1\n")[2]


def test_code_in_a_file_runs_only_where_it_is_allowed(call, tmp_path):
    files = {"mine": CODE, "a": 'make = "mine.py:walker"\n[arguments]\namplitude = 5.525e-4\n[solve]\nperiods = 20\n'}
    code, _, err = call("run", "a.toml", **files)
    assert code == 2 and "line 1: make = 'mine.py:walker' names Python code" in err and "type --allow-code" in err
    assert not (tmp_path / "ran").exists()
    code, out, _ = call("run", "a.toml", "--allow-code", "--json")
    assert code == 0 and (tmp_path / "ran").exists() and json.loads(out)["mean_velocity"] == pytest.approx(0.00201468, rel=1e-5)
    assert call("run", "a.toml")[0] == 2  # what one command allows, the next one does not


def test_a_mechanism_runs_for_a_duration(call):
    law = "[mechanism.friction]\nkind = 'coulomb'\nmu_plus = 1.0\nmu_minus = 1.0\nf_plus = 1.5\nf_minus = 1.5\n"
    text = f"[mechanism]\nkind = 'pulled_mass'\nmass = 1.0\nstiffness = 2.0\nspeed = 0.1\n{law}"
    code, out, _ = call("run", "a.toml", "duration=40", a=text)
    assert code == 0 and "slip 5, stick 4" in out and "m/s" in out and "finished, 40 s" in out
    assert "type duration=60.0 [s]" in call("run", "a.toml")[2]
    assert "did you mean 'pulled_mass'?" in call("run", "b.toml", b="[mechanism]\nkind = 'pulled_mas'\n")[2]


@pytest.mark.parametrize("law", ["coulomb", "gms", "tabulated"])
def test_init_writes_a_file_that_runs_and_explains_every_number(law, call, tmp_path):
    assert call("init", "study.toml", "--law", law)[0] == 0
    text = (tmp_path / "study.toml").read_text(encoding="utf-8")
    robot = ss.Robot.from_toml(text)
    assert type(robot.friction) is ss.friction.LAWS[law] and robot.friction == ss.friction.LAWS[law].example()
    numbers = [line for line in text.splitlines() if " = " in line and not line.startswith("#")]
    assert all("#" in line for line in numbers)
    code, _, err = call("init", "study.toml")
    assert code == 2 and "--force" in err and call("init", "study.toml", "--force")[0] == 0


def test_init_with_every_drive_can_be_read_back(call):
    for name, kind in ss.drives.DRIVES.items():
        code, out, _ = call("init", "--drive", name)
        assert code == 0 and type(ss.Robot.from_toml(out).drive) is kind
    assert "did you mean 'harmonic'?" in call("init", "--drive", "harmonc")[2]


def test_the_bench_takes_the_law_of_a_file_with_its_numbers(call):
    code, out, _ = call("bench", "study.toml", "--only", "drift", "--json", study=RIG + COULOMB)
    told = json.loads(out)
    assert code == 0 and told["law"] == "Coulomb" and told["parameters"]["mu_minus"] == 0.2
    code, _, err = call("bench", "study.toml", "mu_pls=1", study=RIG + COULOMB)
    assert code == 2 and "is not a number of Coulomb; did you mean 'mu_plus'?" in err


MISTAKES = {  # the user's code, the function that is asked for, and what is said of it
    "half": ("def make(:\n    pass\n", "make", "line 1: SyntaxError: "),
    "lacking": (
        "import math\nimport no_such_library\n",
        "make",
        "line 2, in <module>: ModuleNotFoundError: No module named 'no_such_library'",
    ),
    "dividing": ("x = 1 / 0\n\n\ndef make():\n    return x\n", "make", "line 1, in <module>: ZeroDivisionError: division by zero"),
    "looking": (
        "def make(mu=0.3):\n    return helper(mu)\n\n\ndef helper(mu):\n    return {}['tilt']\n",
        "make",
        "line 6, in helper: KeyError: 'tilt'",
    ),
    "misspelling": (
        "import stickslip as ss\n\n\ndef make():\n    return ss.presets.piezo_rigg(1.7)\n",
        "make",
        "line 5, in make: AttributeError: stickslip.presets has no 'piezo_rigg'; did you mean 'piezo_rig'?",
    ),
    "asking": ("import json\n\n\ndef make():\n    return json.loads('{')\n", "make", "line 5, in make: JSONDecodeError: "),
}


@each_row("kind", MISTAKES)
def test_a_mistake_in_the_users_own_code_is_told_with_its_file_and_line(kind, call, tmp_path):
    text, function, said = MISTAKES[kind]
    file = tmp_path / f"own_code_{kind}.py"
    file.write_text(text)
    (tmp_path / "study.toml").write_text(f'make = "{file.name}:{function}"\n')
    for words in (("run", f"{file}:{function}"), ("run", str(tmp_path / "study.toml"), "--allow-code")):
        code, _, err = call(*words)
        assert code == 2 and f"your code: {file}, {said}" in err and "stickslip itself" not in err


def test_a_mistake_in_the_users_own_law_is_told_with_its_line(call, tmp_path):
    file = tmp_path / "own_code_law.py"
    file.write_text(
        "from dataclasses import dataclass\nimport stickslip as ss\n\n\n@dataclass(frozen=True)\nclass Mine:\n    mu: float\n\n"
        "    def sliding(self, v, load):\n        return {}[load]\n\n    def breakaway(self, load):\n        return -load, load\n\n\n"
        "def make():\n    return ss.presets.coulomb_robot(0.3, 0.4).replace(friction=Mine(0.3))\n"
    )
    code, _, err = call("run", f"{file}:make")
    assert code == 2 and f"your code: {file}, line 10, in sliding: " in err


def test_code_that_is_no_function_or_makes_no_robot_says_so(call, tmp_path):
    file = tmp_path / "own_code_other.py"
    file.write_text("make = 3\n\n\ndef maker():\n    return None\n")
    assert "own_code_other has no function 'make'; did you mean 'maker'?" in call("run", f"{file}:make")[2]
    assert "it returns None; allowed is a Robot, a mechanism, a machine or a flow" in call("run", f"{file}:maker")[2]


def test_a_mistake_of_ours_is_still_ours(call, monkeypatch):
    monkeypatch.setattr("stickslip.analysis.checking.shape_of", int)  # a robot is not a number
    code, _, err = call("check", "piezo_rig", "tilt_deg=1.7", "amplitude=5e-4")
    assert code == 1 and "TypeError" in err and "This is an error of stickslip itself, in " in err and ".py, line " in err


@each_row("kind", ss.friction.LAWS)
def test_what_a_study_file_is_told_to_type_for_a_law_makes_one(kind):
    """Each suggestion is a number of an ordinary contact, and all of them together are a law."""
    text = f"{RIG}[robot.friction]\nkind = '{kind}'\n"
    try:
        ss.Robot.from_toml(text)
    except ss.InputError as error:
        told = [re.search(r"is missing; type for example (.*)", problem)[1] for problem in error.problems]
        law = ss.Robot.from_toml(text + "\n".join(told)).friction
        asked = {line.partition(" = ")[0] for line in told}
        usual = {name: value for name, value in vars(type(law).example()).items() if name in asked and isinstance(value, float)}
        assert {name: getattr(law, name) for name in usual} == usual


OWN = """\
from dataclasses import dataclass
import stickslip as ss
from stickslip.maths import where

@dataclass(frozen=True)
class Mine:
    mu: float

    def sliding(self, v, load):
        return where(v > 0, self.mu, -self.mu) * load

    def breakaway(self, load):
        return -self.mu * load, self.mu * load

hard = Mine(0.6)

def rig(amplitude, mu=0.2):
    return ss.presets.piezo_rig(1.7, amplitude, incline="gravity").replace(friction=Mine(mu))
"""


@pytest.fixture
def forgotten(monkeypatch):
    """Another test's file has the same name."""
    monkeypatch.setattr(sys, "path", [*sys.path])
    sys.modules.pop("mine", None)
    yield
    sys.modules.pop("mine", None)


def test_the_bench_gives_a_file_the_numbers_that_its_robot_takes(call, forgotten):
    own = 'make = "mine.py:rig"\n[arguments]\namplitude = "4e-4..8e-4:5"\n'
    rest = ("--only", "steady", "--json")
    code, out, _ = call("bench", "a.toml", "--allow-code", "amplitude=6e-4", "mu=0.3", *rest, a=own, mine=OWN)
    assert code == 0 and json.loads(out)["parameters"] == {"mu": 0.3}
    preset = 'make = "piezo_rig"\n[arguments]\ntilt_deg = 1.7\namplitude = "4e-4..8e-4:5"\n'
    code, out, _ = call("bench", "b.toml", "amplitude=6e-4", *rest, b=preset)
    assert code == 0 and json.loads(out)["law"] == "LuGre"
    code, _, err = call("bench", "a.toml", "amplitude=6e-4")
    assert code == 2 and "--allow-code" in err


@pytest.mark.parametrize(
    ("words", "mu"), [(["mine.py:Mine", "mu=0.5"], 0.5), (["mine.py:hard"], 0.6), (["mine.py:rig", "amplitude=6e-4"], 0.2)]
)
def test_the_bench_takes_a_law_of_ones_own(call, forgotten, words, mu):
    code, out, _ = call("bench", *words, "--only", "steady", "--json", mine=OWN)
    assert code == 0 and json.loads(out)["law"] == "Mine" and json.loads(out)["parameters"] == {"mu": mu}


def test_the_bench_says_what_a_law_of_ones_own_lacks(call, forgotten):
    assert "mu is missing; Mine has no default for it; type for example mu=1.0" in call("bench", "mine.py:Mine", mine=OWN)[2]
    assert "did you mean 'coulomb'?; a law of your own is file.py:Name" in call("bench", "coulom")[2]


def test_two_files_of_one_name_are_two_modules_and_a_librarys_name_is_refused(call, tmp_path, forgotten):
    for folder, mu in (("one", 0.3), ("two", 0.4)):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "mine.py").write_text(OWN.replace("0.6", str(mu)))
        code, out, _ = call("bench", f"{folder}/mine.py:hard", "--only", "steady", "--json")
        assert code == 0 and json.loads(out)["parameters"] == {"mu": mu}
    (tmp_path / "json.py").write_text(OWN)
    code, _, err = call("run", "json.py:rig", "amplitude=6e-4")
    assert code == 2 and "has the name of a module that is loaded already (json)" in err
    assert str(tmp_path) not in sys.path  # a process that begins with this path would import the file
