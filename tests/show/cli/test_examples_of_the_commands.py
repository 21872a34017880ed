"""What ``--help`` shows as an example is what the command prints."""

import json
import re
import shlex
import socket
import subprocess
import sys

import pytest

from rows import each_row
from stickslip.show.cli import COMMANDS, main
from stickslip.show.cli.declaring import commands_in, declaration

SLOW = ("paper", "warmup")  # they take a minute
#: Seconds; other tests read their JSON.
LONG = (*SLOW, "bench", "optimise", "atlas", "basins", "lyapunov", "compare", "identify", "map", "report", "check")
ENDLESS = "explore"  # serves until it is told to stop
EXAMPLES = [command for command in COMMANDS if command != ENDLESS]
_NUMBER = re.compile(r"[+-]?\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def same_word(told, found):
    """Words are equal; numbers agree to a thousandth, or both are rounding: a residual, a difference of two methods."""
    if told == "…" or told == found:
        return True
    numbers = [_NUMBER.findall(word) for word in (told, found)]
    if _NUMBER.sub("#", told) != _NUMBER.sub("#", found) or len(numbers[0]) != len(numbers[1]):
        return False
    pairs = [tuple(map(float, pair)) for pair in zip(*numbers, strict=True)]
    return all(abs(a - b) <= 1e-3 * max(abs(a), abs(b)) or max(abs(a), abs(b)) < 1e-6 for a, b in pairs)


def same_line(told, found):
    words = told.split(), found.split()
    if words[0] and words[0][-1] == "…":  # the rest of the line, whatever it is
        words = words[0][:-1], words[1][: len(words[0]) - 1]
    return len(words[0]) == len(words[1]) and all(map(same_word, *words))


def same(told, found):
    """Lines in order; a line of one … stands for any number of lines."""
    if not told:
        return not found
    if told[0].strip() == "…":
        return any(same(told[1:], found[i:]) for i in range(len(found) + 1))
    return bool(found) and same_line(told[0], found[0]) and same(told[1:], found[1:])


def test_the_comparison_sees_a_wrong_number_and_a_missing_line():
    assert same(["v  1.000 m/s", "…", "end"], ["v 1.0002 m/s", "a", "b", "end"])
    assert not same(["v  1.000 m/s"], ["v 1.01 m/s"]) and not same(["a", "b"], ["a"]) and not same(["a"], ["a", "b"])
    assert not same(["residual 1e-9"], ["residual 1e-3"]) and same(["x …"], ["x 3 4"])


@pytest.mark.parametrize("command", [pytest.param(c, marks=pytest.mark.slow) if c in SLOW else c for c in EXAMPLES])
def test_the_example_of_a_command_prints_what_is_shown(command, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for typed, told in commands_in(declaration(command).example):
        words = shlex.split(typed)
        assert words[0] == "stickslip" and main(words[1:]) == 0
        out = capsys.readouterr().out
        assert same(told.splitlines(), out.splitlines()), f"$ {typed}\n{out}"


@each_row("command", [command for command in EXAMPLES if command not in LONG])
def test_the_example_with_json_is_strict_json(command, capsys, tmp_path, monkeypatch):
    """Nothing but JSON on stdout, and no NaN in it."""
    strict_json_of(command, capsys, tmp_path, monkeypatch)


@pytest.mark.slow
@each_row("command", LONG)
def test_the_example_that_takes_long_is_strict_json_too(command, capsys, tmp_path, monkeypatch):
    strict_json_of(command, capsys, tmp_path, monkeypatch)


def strict_json_of(command, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for typed, _ in commands_in(declaration(command).example):
        words = shlex.split(typed)[1:]
        assert main([*words, *(["--json"] if words[0] == command else [])]) == 0
        out = capsys.readouterr().out
        if words[0] == command:
            told = json.loads(out, parse_constant=lambda word: pytest.fail(f"{word} is not JSON"))
            assert isinstance(told, dict) and told


def test_the_example_that_serves_prints_its_address():
    """As it is shown, but on a port that is free."""
    ((typed, told),) = commands_in(declaration(ENDLESS).example)
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = str(free.getsockname()[1])
    words = shlex.split(typed.replace("8765", port))
    process = subprocess.Popen([sys.executable, "-m", *words], stdout=subprocess.PIPE, text=True)
    try:
        known, hidden, _ = told.replace("8765", port).partition("…")  # the token is another one each time
        assert hidden and process.stdout.readline().startswith(known)
    finally:
        process.terminate()
        process.communicate(timeout=30)


@each_row("command", COMMANDS)
def test_help_shows_an_example_of_the_command(command, capsys):
    with pytest.raises(SystemExit):
        main([command, "--help"])
    shown = capsys.readouterr().out
    assert f"stickslip {command}" in shown.partition("options:")[2]
