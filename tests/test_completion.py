"""What the Tab key completes."""

import shutil
import subprocess

import pytest

from stickslip.cli import COMMANDS
from stickslip.cli.completion import SHELLS, script, vocabulary


def test_every_command_has_its_own_options():
    words = vocabulary()
    assert set(words) == set(COMMANDS)
    assert all("--json" in known for known in words.values())
    assert "--refine" in words["map"] and "--refine" not in words["run"] and "lugre" in words["laws"]


@pytest.mark.parametrize("shell", SHELLS)
def test_the_shell_accepts_its_script(shell, tmp_path):
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    (tmp_path / "script").write_text(script(shell), encoding="utf-8")
    done = subprocess.run([shell, "-n", tmp_path / "script"], capture_output=True, text=True, timeout=30, check=False)
    assert done.returncode == 0 and done.stderr == ""


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not installed")
@pytest.mark.parametrize(
    ("typed", "found"),
    [
        (["bif"], ["bifurcation"]),
        (["run", "--fi"], ["--figure"]),
        (["run", "piezo_rig", "ampl"], ["amplitude="]),
        (["laws", "lu"], ["lugre"]),
        (["report", "notes"], ["notes.toml"]),
    ],
)
def test_bash_completes(typed, found, tmp_path):
    (tmp_path / "script").write_text(script("bash"), encoding="utf-8")
    (tmp_path / "notes.toml").touch()
    code = f"source ./script; compopt() {{ :; }}; COMP_WORDS=(stickslip {' '.join(typed)}); COMP_CWORD={len(typed)}"
    done = subprocess.run(
        ["bash", "-c", f'{code}; _stickslip; printf "%s\\n" "${{COMPREPLY[@]}}"'], cwd=tmp_path, capture_output=True, text=True, timeout=30
    )
    assert done.stdout.split() == found
