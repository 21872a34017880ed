"""``stickslip completion``: a script that makes the Tab key complete commands, options, presets and names, made from the parsers."""

from __future__ import annotations

from typing import Any

from stickslip.cli import show
from stickslip.cli.arguments import parser, parser_of
from stickslip.errors import InputError, did_you_mean

__all__ = ["act", "script", "vocabulary"]

SHELLS = ("bash", "zsh", "fish")

_BASH = """\
# stickslip: completion for bash. Type: source <(stickslip completion bash)
_stickslip() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} words
    case ${{COMP_WORDS[1]}} in
{cases}
        *) words="{commands}" ;;
    esac
    (( COMP_CWORD == 1 )) && words="{commands}"
    COMPREPLY=($(compgen -W "$words" -- "$word"))
    (( ${{#COMPREPLY[@]}} )) || COMPREPLY=($(compgen -f -- "$word"))
    [[ ${{#COMPREPLY[@]}} -eq 1 && ${{COMPREPLY[0]}} == *= ]] && compopt -o nospace
}}
complete -F _stickslip stickslip
"""
_ZSH = """\
#compdef stickslip
# stickslip: completion for zsh. Type: source <(stickslip completion zsh)
_stickslip() {{
    local -a names
    if (( CURRENT == 2 )); then
        names=({commands})
    else
        case $words[2] in
{cases}
        esac
    fi
    compadd -S '' -- ${{(M)names:#*=}}
    compadd -- ${{names:#*=}}
    _files
}}
compdef _stickslip stickslip
"""
_FISH = """\
# stickslip: completion for fish. Type: stickslip completion fish | source
complete -c stickslip -n __fish_use_subcommand -f
{commands}
{cases}
"""


def act(command: str, words: list[str]) -> int:
    """Do the command."""
    made = parser(command, "Print a script that makes the Tab key complete commands, options, presets and names.", robot=False)
    made.add_argument("shell", metavar="SHELL", help="bash, zsh or fish")
    asked = made.parse_args(words)
    if asked.shell not in SHELLS:
        raise InputError("completion", [f"{asked.shell!r} is not a known shell; {did_you_mean(asked.shell, SHELLS)}"])
    text = script(asked.shell)
    if asked.json:
        show.print_json({"shell": asked.shell, "script": text})
    else:
        print(text, end="")
    return 0


def vocabulary() -> dict[str, list[str]]:
    """For each command the words that may follow it.

    Examples
    --------
    >>> words = vocabulary()["run"]
    >>> "--figure" in words, "piezo_rig" in words, "tilt_deg=" in words, "periods=" in words
    (True, True, True, True)
    """
    from stickslip.cli import COMMANDS, act_of

    return {command: _words(command, parser_of(act_of(command), command)) for command in COMMANDS}


def _words(command: str, made: Any) -> list[str]:
    options = [option for option in made._option_string_actions if option.startswith("--")]
    named = [action.dest for action in made._actions if not action.option_strings]
    if "robot" in named:
        return [*options, *_robots()]
    if "names" in named:
        from stickslip.cli.lists import things

        return [*options, *things(command)]
    return [*options, *(SHELLS if "shell" in named else ())]


def _robots() -> list[str]:
    """Presets, their arguments, and those of the solver."""
    import inspect

    from stickslip.cli.lists import things
    from stickslip.cli.study_files import SOLVER

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
    from stickslip.cli import COMMANDS

    words = vocabulary()
    if shell == "bash":
        cases = "\n".join(f'        {name}) words="{" ".join(known)}" ;;' for name, known in words.items())
        return _BASH.format(cases=cases, commands=" ".join(COMMANDS))
    if shell == "zsh":
        cases = "\n".join(f"            {name}) names=({' '.join(known)}) ;;" for name, known in words.items())
        return _ZSH.format(cases=cases, commands=" ".join(COMMANDS))
    commands = "\n".join(
        f"complete -c stickslip -n __fish_use_subcommand -a {name} -d {_quoted(about)}" for name, (_, about) in COMMANDS.items()
    )
    return _FISH.format(commands=commands, cases="\n".join(_fish(name, known) for name, known in words.items()))


def _fish(name: str, known: list[str]) -> str:
    """The lines of one command."""
    here = f'complete -c stickslip -n "__fish_seen_subcommand_from {name}"'
    options = "\n".join(f"{here} -l {word[2:]}" for word in known if word.startswith("--"))
    plain = " ".join(word for word in known if not word.startswith("--"))
    return options + (f'\n{here} -a "{plain}"' if plain else "")


def _quoted(text: str) -> str:
    return "'" + text.replace("'", "\\'") + "'"
