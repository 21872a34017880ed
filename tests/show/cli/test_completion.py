"""What the Tab key completes."""

import os
import pty
import shutil
import subprocess
import time

import pytest

from rows import each_row
from stickslip.show.cli import COMMANDS
from stickslip.show.cli.commands.completion import SHELLS, script, vocabulary


def test_every_command_has_its_own_options():
    words = vocabulary()
    assert set(words) == set(COMMANDS)
    assert all("--json" in known for known in words.values())
    assert "--refine" in words["map"] and "--refine" not in words["run"] and "lugre" in words["laws"]


@each_row("shell", SHELLS)
def test_the_shell_accepts_its_script(shell, tmp_path):
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    (tmp_path / "script").write_text(script(shell), encoding="utf-8")
    done = subprocess.run([shell, "-n", tmp_path / "script"], capture_output=True, text=True, timeout=30, check=False)
    assert done.returncode == 0 and done.stderr == ""


#: What is typed before Tab, and what stands there afterwards.
TYPED = [
    ("bif", "bifurcation"),
    ("run --fi", "run --figure"),
    ("run piezo_rig ampl", "run piezo_rig amplitude="),
    ("laws lu", "laws lugre"),
    ("report not", "report notes.toml"),
    ("completion fi", "completion fish"),
]


@pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not installed")
@each_row(("typed", "found"), TYPED)
def test_bash_completes(typed, found, tmp_path):
    (tmp_path / "script").write_text(script("bash"), encoding="utf-8")
    (tmp_path / "notes.toml").touch()
    words = len(typed.split())
    code = f"source ./script; compopt() {{ :; }}; COMP_WORDS=(stickslip {typed}); COMP_CWORD={words}"
    done = subprocess.run(
        ["bash", "-c", f'{code}; _stickslip; printf "%s\\n" "${{COMPREPLY[@]}}"'], cwd=tmp_path, capture_output=True, text=True, timeout=30
    )
    assert done.stdout.split() == found.split()[-1:]


@pytest.mark.skipif(shutil.which("fish") is None, reason="fish is not installed")
def test_fish_completes(tmp_path):
    """Fish itself says what it would offer."""
    (tmp_path / "script").write_text(script("fish"), encoding="utf-8")
    (tmp_path / "notes.toml").touch()
    asked = "; ".join(f'echo "= {typed}"; complete -C "stickslip {typed}"' for typed, _ in TYPED)
    done = subprocess.run(
        ["fish", "--no-config", "-c", f"source script; {asked}"], cwd=tmp_path, capture_output=True, text=True, timeout=60, check=True
    )
    told = [part.splitlines() for part in done.stdout.split("= ")[1:]]
    offered = {lines[0]: [line.split("\t")[0] for line in lines[1:]] for lines in told}
    assert offered == {typed: found.split()[-1:] for typed, found in TYPED}


@pytest.mark.skipif(shutil.which("zsh") is None, reason="zsh is not installed")
def test_zsh_completes(tmp_path):
    """A zsh that believes that somebody types, on a terminal of its own; a key writes down what Tab made of the line."""
    (tmp_path / "notes.toml").touch()
    (tmp_path / "script").write_text(script("zsh"), encoding="utf-8")
    key = 'told() { zle complete-word; print -r -- "$BUFFER" >> told; BUFFER=""; }'
    lines = ["autoload -Uz compinit && compinit -D -u", "source ./script", key, "zle -N told", "bindkey '^T' told", "touch ready"]
    (tmp_path / ".zshrc").write_text("\n".join(lines) + "\n", encoding="utf-8")
    environment = {**os.environ, "ZDOTDIR": str(tmp_path), "TERM": "xterm", "HOME": str(tmp_path)}
    near, far = pty.openpty()
    shell = subprocess.Popen(["zsh", "-i"], stdin=far, stdout=far, stderr=far, cwd=tmp_path, env=environment, start_new_session=True)
    try:
        waited(lambda: (tmp_path / "ready").exists())
        for number, (typed, _) in enumerate(TYPED, start=1):
            os.write(near, f"stickslip {typed}\x14".encode())
            waited(lambda number=number: len(read(tmp_path / "told")) >= number)
        assert read(tmp_path / "told") == [f"stickslip {found}" for _, found in TYPED]
    finally:
        shell.kill()
        shell.wait(timeout=30)
        os.close(near)
        os.close(far)


def read(path):
    """Whole lines, without the blank that a shell puts behind a word that is complete."""
    return [line.rstrip() for line in path.read_text(encoding="utf-8").splitlines()] if path.exists() else []


def waited(holds, seconds=60):
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end, "the shell did not answer"
        time.sleep(0.05)
