"""Whatever is given, to the package, to the command line or in a study file: one of our sentences, never a traceback."""

from __future__ import annotations

import contextlib
import io
import os
import random

import pytest

import stickslip as ss
from hostile import Outcome, damaged, limits, warm
from stickslip.models.tables import PARTS
from stickslip.show.cli import COMMANDS, main, study_files
from stickslip.show.cli.arguments import parser
from stickslip.show.cli.commands import identify

#: A time limit may strike in a finalizer, which cannot pass it on.
pytestmark = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")

# ---- study files ----
HEAD = (
    "[arguments]\n\"drive.amplitude\" = 4e-4\n[solve]\nperiods = 30\nsettle = 3\nrtol = 1e-6\nmethod = 'auto'\nstart = {x = 0.0, v = 0.1}\n"
)
IDENTIFY = """\
[identify]
make = 'piezo_rig'
records = ['a.csv']
noise = 1e-4
starts = 3
columns = ['t', 'v']
[identify.free]
mu0 = [0.05, 0.5]
v_s = [2e-4, 2e-2, 'log']
[identify.tied]
f0 = 'mu0'
[identify.units]
v = 'mm/s'
[identify.roles]
v = 'velocity'
"""


def example(kind):
    return kind.example() if hasattr(kind, "example") else kind()


def studies():
    """A study file for every law, drive and track without numbers, mechanisms, a preset's, and one that identifies."""
    rig = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb")
    kinds = [(part, kind) for part, named in PARTS.items() for kind in named.values() if part != "track" or not kind.__dataclass_fields__]
    body = {"mass": 1.0, "stiffness": 100.0, "friction": ss.Coulomb(0.1, 0.2)}
    mechanisms = [ss.PulledMass(**body, speed=0.1), ss.BlockOnBelt(**body, speed=0.1)]
    texts = [rig.replace({part: example(kind)}).to_toml() + HEAD for part, kind in kinds]
    texts += [mechanism.to_toml() + "[solve]\nduration = 1.0\n" for mechanism in mechanisms]
    return [*texts, "make = 'piezo_rig'\n[arguments]\ntilt_deg = 1.7\namplitude = 5e-4\n[solve]\nperiods = 30\n", IDENTIFY]


def read_study(path):
    """What the commands do with a study file before they solve."""
    if "[identify" in path.read_text(encoding="utf-8", errors="replace"):
        identify._table(path)
    study_files.study_named(str(path))


def read_many(count, seed, folder):
    rng, found, texts = random.Random(seed), Outcome(), studies()
    words = sorted({line.partition("=")[0].strip() for text in texts for line in text.split("\n") if "=" in line})
    path = folder / "study.toml"
    for _ in range(count):
        text = damaged(rng.choice(texts), rng, words)
        path.write_bytes(text.encode("utf-8", "surrogatepass"))
        found.of(lambda: read_study(path), "study file", repr(text)[:300])
    return found


def test_a_damaged_study_file_is_told_in_words(tmp_path):
    found = read_many(600, 1, tmp_path)
    assert not found.wrong, found.told()


@pytest.mark.slow
def test_sixty_thousand_damaged_study_files_are_told_in_words(tmp_path):
    found = read_many(60_000, 2, tmp_path)
    print(f"\n{found.tried} study files: {dict(found)}")
    assert found.tried == 60_000 and not found.wrong, found.told()


# ---- the command line ----
WORDS = [
    "piezo_rig", "coulomb_robot", "piezo_beam_rig", "tilt_deg=1.7", "amplitude=5e-4", "law=coulomb", "alpha_plus=0.5", "alpha_minus=0.9",
    "amplitude=4e-4..6e-4:3", "amplitude=4e-4,5e-4", "periods=3", "settle=1", "rtol=1e-5", "method=exact", "start.v=0.1", "start.z=1",
    "lugre",
    "dahl", "a.toml", "b.toml", "a.csv", "nothing.csv", "grid.nc", ".", "..", "/", "", "-", "--", "=", "a=", "=a", "a=b=c", "é", "\0",
    "x" * 3000,
    "amplitude=1e-4..1:1000000000", "amplitude=1..2:0", "amplitude=nan", "amplitude=inf", "amplitude=", "amplitude=65.4pi",
    "amplitude=-1",
    "periods=1e9", "periods=-1", "periods=a", "rtol=0", "samples=99999999999", "workers=0", "workers=99999", "tilt_deg=89.9", "os:system",
    "a.py:f",
    "json", "run", "help", "1", "-1", "1e400", "t [s]", "v=velocity", "v=mm/s", "mu0=0.05..0.5", "mu0=a..b", "0.1,0.2", "zsh", "bash",
    "fish",
    "harmonic", "level", "figure.png", "figure.xyz", "/proc/nothing/x.png", "report.html", "out.csv", "%", "$HOME", "*", "~nobody",
]  # fmt: skip
#: Commands that would serve a page, compile for minutes or reproduce the paper are asked for their help and with words that they refuse.
LONG = ("explore", "paper", "warmup")


def options():
    """Every option of every command, from its own parser."""
    return {name: [o for action in parser(name)._actions for o in action.option_strings] for name in COMMANDS}


def command(rng, known):
    """A command with valid, misspelt, doubled and missing words."""
    name = rng.choice([*COMMANDS, *COMMANDS, "rnu", "", "help", "--version"])
    words = [name]
    if name in LONG:
        return [*words, rng.choice(["--help", "--nonsense", "--json --nonsense", "a b c --x"])]
    for _ in range(rng.choice([0, 1, 2, 3, 5, 9])):
        kind = rng.randrange(5)
        if kind == 0 and known.get(name):
            option = rng.choice(known[name])
            words += (
                [option] if rng.random() < 0.5 else [f"{option}={rng.choice(WORDS)}"] if rng.random() < 0.3 else [option, rng.choice(WORDS)]
            )
        elif kind == 1:
            words += ["piezo_rig", "tilt_deg=1.7", "amplitude=5e-4", "law=coulomb", "periods=3"]
        elif kind == 2:
            words.append(damaged(rng.choice(WORDS) or "a", rng).replace("\ud83d", ""))
        else:
            words.append(rng.choice(WORDS))
    return words


def typed_many(count, seed, folder):
    rng, found, known = random.Random(seed), Outcome(), options()
    for name, text in zip("ab", (studies()[0], IDENTIFY), strict=True):
        (folder / f"{name}.toml").write_text(text)
    (folder / "a.csv").write_text("t [s],v [m/s]\n" + "\n".join(f"{0.001 * k},{k % 7}" for k in range(200)))
    warm()
    os.environ["STICKSLIP_TRACEBACK"] = "1"
    try:
        for _ in range(count):
            words = command(rng, known)
            found.of(lambda words=words: answered(words), words[0], words)
    finally:
        del os.environ["STICKSLIP_TRACEBACK"]
    return found


def answered(words):
    """A command gives an exit code, and a sentence where it is not 0."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), contextlib.suppress(SystemExit):
        code = main(words)
        assert code in (0, 1, 2), code
        assert code == 0 or err.getvalue().strip() or out.getvalue().strip(), "no word"
        assert "Traceback" not in err.getvalue() and "error of stickslip itself" not in err.getvalue()


def test_whatever_is_typed_is_answered_in_words(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with limits():
        found = typed_many(60, 1, tmp_path)
    assert not found.wrong, found.told()


@pytest.mark.slow
def test_ten_thousand_command_lines_are_answered_in_words(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with limits():
        found = typed_many(10_000, 2, tmp_path)
    print(f"\n{found.tried} command lines: {dict(found)}")
    assert found.tried == 10_000 and not found.wrong, found.told()
