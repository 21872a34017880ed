"""The command ``stickslip``: dispatch of its commands, and treatment of errors. Nothing heavy is imported for the help.

Exit codes: 0 done, 1 something could not be computed, 2 the input was wrong, 130 interrupted by Ctrl-C.
Results go to stdout, everything else to stderr.
Colours and progress bars appear in a terminal only.
"""

from __future__ import annotations

import contextvars
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from stickslip.basics.errors import InputError, StickslipError, did_you_mean
from stickslip.show.cli.declaring import declaration, names, summary_line

__all__ = ["COMMANDS", "done", "main"]

INTERRUPTED = 130  # what a shell expects of a program that Ctrl-C ended
_HELP, _VERSION = ("-h", "--help", "help"), ("-V", "--version")
_OF_ITSELF = (*_HELP, *_VERSION)  # what it says of itself: nothing runs that could be interrupted
#: The names of all commands.
COMMANDS = names()
#: Commands under another spelling, and names that other programs have for ours.
_SPELLED = {"optimize": "optimise"}
_CALLED = {
    **dict.fromkeys(("simulate", "solve", "integrate"), "run ROBOT"),
    **dict.fromkeys(("plot", "draw", "figure"), "run ROBOT --figure FILE.png"),
    **dict.fromkeys(("record", "open", "import"), "read FILE"),
    **dict.fromkeys(("gui", "app", "web", "animate"), "explore"),
    **dict.fromkeys(("fmu", "simulink"), "export-fmu ROBOT --out FILE.fmu"),
    **dict.fromkeys(("continuation", "bifurcate"), "bifurcation ROBOT NAME=FROM..TO:COUNT --follow"),
    **dict.fromkeys(("chaos", "verdict"), "lyapunov ROBOT"),
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line and return the exit code.

    Parameters
    ----------
    argv : sequence of str, optional
        The arguments after ``stickslip``; by default those of this process.

    Examples
    --------
    >>> main(["--version"])
    stickslip ...
    0
    """
    words = list(sys.argv[1:] if argv is None else argv)
    if len(words) == 2 and words[0] == "help":
        words = [words[1], "--help"]
    if not words or words[0] in _OF_ITSELF:
        return _done(words)
    from stickslip.basics.interruption import ended_early

    before = len(ended_early)
    code = _done(words)
    return INTERRUPTED if len(ended_early) > before else code


def _done(words: list[str]) -> int:
    """The exit code of a command that is not interrupted."""
    try:
        return contextvars.copy_context().run(_dispatch, words)  # the permissions of one command do not apply to the next
    except InputError as error:
        return _say(_with_its_source(error), 2)
    except StickslipError as error:
        return _say(str(error), 1)
    except KeyboardInterrupt as pressed:
        return _say(str(pressed) or "interrupted", INTERRUPTED)
    except BrokenPipeError:  # the reader of our stdout has closed it
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except Exception as error:
        if os.environ.get("STICKSLIP_TRACEBACK"):
            raise
        from stickslip.show.cli.user_errors import in_our_code, in_your_code

        if yours := in_your_code(error):
            return _say(yours, 2)
        ours = f"This is an error of stickslip itself, in {in_our_code(error)}; set STICKSLIP_TRACEBACK=1 to see how it came there"
        return _say(f"{type(error).__name__}: {error}\n{ours}", 1)


def _with_its_source(error: InputError) -> str:
    """What is wrong, and where in the user's own code if an exception there is the cause."""
    from stickslip.show.cli.user_errors import in_your_code

    yours = in_your_code(error.__cause__) if error.__cause__ is not None else None
    return f"{error}\n{yours}" if yours else str(error)


def _say(sentence: str, code: int) -> int:
    print(f"stickslip: {sentence}", file=sys.stderr)
    return code


def _dispatch(words: list[str]) -> int:
    if not words or words[0] in _HELP:
        width = max(map(len, COMMANDS))
        text = Path(__file__).with_name("templates").joinpath("help.txt").read_text(encoding="utf-8")
        print(text.format(commands="\n".join(f"  {name:<{width}}  {summary_line(name)}" for name in COMMANDS)), end="")
        return 0 if words else 2
    if words[0] in _VERSION:
        from stickslip import __version__

        print(f"stickslip {__version__}")
        return 0
    name, rest = _SPELLED.get(words[0], words[0]), words[1:]
    if name not in COMMANDS:
        hint = f"type stickslip {_CALLED[name]}" if name in _CALLED else did_you_mean(name, COMMANDS)
        raise InputError("command", [f"{name!r} is not known; type stickslip --help for the list; {hint}"])
    return done(name, rest)


def done(name: str, words: list[str]) -> int:
    """Run a command, whose module is imported only now, and show its results."""
    from stickslip.show.cli.arguments import asked
    from stickslip.show.cli.outputs import deliver

    arguments = asked(name, words)
    return deliver(arguments, declaration(name).act(arguments))
