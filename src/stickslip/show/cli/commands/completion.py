"""``stickslip completion``: shell completion for bash, zsh or fish."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError, did_you_mean
from stickslip.show.cli.arguments import parser
from stickslip.show.cli.declaring import argument, command, summary_line
from stickslip.show.cli.outputs import Outcome

if TYPE_CHECKING:
    from argparse import Namespace


SHELLS = ("bash", "zsh", "fish")


@command(
    about="Print a script that makes the Tab key complete commands, options, presets and names.",
    arguments=(argument("shell", metavar="SHELL", help="bash, zsh or fish"),),
    example="""\
$ stickslip completion bash
# stickslip: completion for bash. Type: source <(stickslip completion bash)
_stickslip() {
    local word=${COMP_WORDS[COMP_CWORD]} words
    case ${COMP_WORDS[1]} in
…
complete -F _stickslip stickslip
""",
)
def act(asked: Namespace) -> Outcome:
    """Do the command."""
    if asked.shell not in SHELLS:
        raise InputError("completion", [f"{asked.shell!r} is not a known shell; {did_you_mean(asked.shell, SHELLS)}"])
    text = script(asked.shell)
    return Outcome({"shell": asked.shell, "script": text}, text.removesuffix("\n"))


def vocabulary() -> dict[str, list[str]]:
    """For each command, the words that may follow it.

    Examples
    --------
    >>> words = vocabulary()["run"]
    >>> "--figure" in words, "piezo_rig" in words, "tilt_deg=" in words, "periods=" in words
    (True, True, True, True)
    """
    from stickslip.show.cli import COMMANDS

    return {command: _words(command, parser(command)) for command in COMMANDS}


def _words(command: str, made: Any) -> list[str]:
    options = [option for option in made._option_string_actions if option.startswith("--")]
    named = [action.dest for action in made._actions if not action.option_strings]
    if "robot" in named:
        return [*options, *_robots()]
    if "names" in named:
        from stickslip.show.cli.lists import things

        return [*options, *things(command)]
    return [*options, *(SHELLS if "shell" in named else ())]


def _robots() -> list[str]:
    """Presets, their arguments, and those of the solver."""
    import inspect

    from stickslip.show.cli.lists import things
    from stickslip.show.cli.study_files import SOLVER

    presets = things("presets")
    names = [name for make in presets.values() for name in inspect.signature(make).parameters]
    return [*presets, *(f"{name}=" for name in dict.fromkeys([*names, *SOLVER]))]


def script(shell: str) -> str:
    """The script for one shell.

    Examples
    --------
    >>> print(script("bash").splitlines()[-1])
    complete -F _stickslip stickslip
    """
    from stickslip.show.cli import COMMANDS

    words, form = vocabulary(), (Path(__file__).parents[1] / "templates" / f"completion.{shell}").read_text(encoding="utf-8")
    if shell == "fish":
        commands = "\n".join(
            f"complete -c stickslip -n __fish_use_subcommand -a {name} -d {_quoted(summary_line(name))}" for name in COMMANDS
        )
        return form.format(commands=commands, cases="\n".join(_fish(name, known) for name, known in words.items()))
    line = {"bash": '        {0}) words="{1}" ;;', "zsh": "            {0}) names=({1}) ;;"}[shell]
    cases = "\n".join(line.format(name, " ".join(known)) for name, known in words.items())
    return form.format(cases=cases, commands=" ".join(COMMANDS))


def _fish(name: str, known: list[str]) -> str:
    """The lines for one command."""
    here = f'complete -c stickslip -n "__fish_seen_subcommand_from {name}"'
    options = "\n".join(f"{here} -l {word[2:]}" for word in known if word.startswith("--"))
    plain = " ".join(word for word in known if not word.startswith("--"))
    return options + (f'\n{here} -a "{plain}"' if plain else "")


def _quoted(text: str) -> str:
    return "'" + text.replace("'", "\\'") + "'"
