"""The command ``stickslip``: which commands there are, and what becomes of an error. Nothing heavy is imported for the help.

Exit codes: 0 done, 1 something could not be computed, 2 the input was wrong. Results go to stdout, everything else to stderr.
There are no colours and no bars where nobody looks at a terminal.
"""

from __future__ import annotations

import contextvars
import importlib
import os
import sys
from collections.abc import Callable, Sequence

from stickslip.errors import InputError, StickslipError, did_you_mean

__all__ = ["COMMANDS", "act_of", "main"]

#: Command -> (module, what it does).
COMMANDS = {
    "run": ("run", "simulate one robot and report its motion"),
    "check": ("check", "solve one robot with several methods and count the certain digits"),
    "sweep": ("sweep", "simulate a robot over a grid of its numbers"),
    "bench": ("bench", "friction laws on the test bench: how each behaves by itself"),
    "export-law": ("exported", "a friction law as C, MATLAB, TOML or attributes of a MuJoCo joint"),
    "map": ("plane", "simulate a robot over a plane and draw the map"),
    "resume": ("resuming", "continue a study that was interrupted"),
    "merge": ("studies", "merge the shards of a sweep"),
    "export": ("studies", "write the results of a sweep as one .nc, .mat, .csv, .xlsx or .parquet file"),
    "bifurcation": ("bifurcation", "bifurcations along one parameter: diagram, branches, folds and flips"),
    "atlas": ("atlas", "motions over two numbers, and the borders between them"),
    "basins": ("basins", "basins of attraction: which initial state leads to which motion"),
    "lyapunov": ("lyapunov", "Lyapunov exponents: periodic, quasi-periodic or chaotic?"),
    "report": ("report", "one robot, one run or one study as a self-contained HTML page"),
    "init": ("init", "write a commented study file to start from"),
    "read": ("read", "read a measured record: channels, rate, gaps, noise, motion"),
    "compare": ("compare", "compare a measured record with friction laws"),
    "optimise": ("optimise", "find the best numbers and drives of a robot, within limits"),
    "identify": ("identify", "parameters of a robot or a law from measured records"),
    "paper": ("paper", "reproduce the paper: tables, figures, claims and errata in one folder"),
    "explore": ("explore", "open a page with a slider for each number of a robot"),
    "presets": ("lists", "published robots, with the arguments they take"),
    "laws": ("lists", "friction laws"),
    "drives": ("lists", "drives of the inner mass"),
    "mechanisms": ("lists", "test benches: a mass with a spring and one contact"),
    "doctor": ("doctor", "versions, the cache folder, and any problems"),
    "warmup": ("doctor", "compile the usual kernels now instead of at their first use"),
    "completion": ("completion", "shell completion for bash, zsh or fish"),
}

_HELP = """\
stickslip: vibration-driven robots and stick-slip friction

usage: stickslip COMMAND [ROBOT] [NAME=VALUE ...] [options]

commands
{commands}

ROBOT is the name of a preset (see `stickslip presets`), a TOML study file (`stickslip init` writes one), or module:function
of your own. NAME=VALUE sets a number of it, or an argument of the solver: periods, duration, settle, rtol, method, samples,
steps, start.v, start.z. Numbers are SI units; angles named _deg are in degrees; 65.4pi is a number too. `stickslip sweep`
also takes a..b:n (n values from a to b) and a,b,c.

examples
  stickslip run piezo_rig tilt_deg=1.7 amplitude=5.525e-4
  stickslip run piezo_rig tilt_deg=1.7 amplitude=5.525e-4 law=coulomb periods=200 --figure run.png --data run.nc
  stickslip check piezo_rig tilt_deg=1.7 amplitude=5.525e-4
  stickslip sweep piezo_rig tilt_deg=1.7 amplitude=4e-4..8e-4:9 --out grid.nc
  stickslip report piezo_rig tilt_deg=1.7 amplitude=5.525e-4 --out report.html
  stickslip bench lugre dahl mu_plus=0.16 mu_minus=0.16 --figure laws.png
  stickslip paper

`stickslip COMMAND --help` explains one command, with an example and its output; every command accepts --json.
Exit codes: 0 done, 1 something could not be computed, 2 the input was wrong.
"""


def main(argv: Sequence[str] | None = None) -> int:
    """Do what the command line says and return the exit code.

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
    try:
        return contextvars.copy_context().run(_dispatch, words)  # what one command allows, the next one does not
    except InputError as error:
        return _say(str(error), 2)
    except StickslipError as error:
        return _say(str(error), 1)
    except KeyboardInterrupt:
        return _say("interrupted", 1)
    except BrokenPipeError:  # the reader of our stdout has gone: nobody is left to tell
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except Exception as error:
        if os.environ.get("STICKSLIP_TRACEBACK"):
            raise
        from stickslip.cli.user_errors import in_your_code

        if yours := in_your_code(error):
            return _say(yours, 2)
        return _say(f"{type(error).__name__}: {error}\nThis is an error of stickslip itself; set STICKSLIP_TRACEBACK=1 to see where", 1)


def _say(sentence: str, code: int) -> int:
    print(f"stickslip: {sentence}", file=sys.stderr)
    return code


def _dispatch(words: list[str]) -> int:
    if len(words) == 2 and words[0] == "help":
        words = [words[1], "--help"]
    if not words or words[0] in ("-h", "--help", "help"):
        width = max(map(len, COMMANDS))
        print(_HELP.format(commands="\n".join(f"  {name:<{width}}  {about}" for name, (_, about) in COMMANDS.items())), end="")
        return 0 if words else 2
    if words[0] in ("-V", "--version"):
        from stickslip import __version__

        print(f"stickslip {__version__}")
        return 0
    name, rest = words[0], words[1:]
    if name not in COMMANDS:
        raise InputError("command", [f"{name!r} is not known; type stickslip --help for the list; {did_you_mean(name, COMMANDS)}"])
    return act_of(name)(name, rest)


def act_of(name: str) -> Callable[[str, list[str]], int]:
    """The function that does a command; its module is imported now."""
    act: Callable[[str, list[str]], int] = importlib.import_module(f"stickslip.cli.{COMMANDS[name][0]}").act
    return act
