"""How a command is declared: its help, its arguments and an example with its output, beside the function that does it."""

from __future__ import annotations

import importlib
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from stickslip.basics.errors import StickslipError
from stickslip.show.cli import commands

T = TypeVar("T")
_FOLDER = Path(commands.__path__[0])
#: Endings of files that hold a figure, and of those that hold a table.
FIGURES, TABLES = (".png", ".svg", ".pdf"), (".nc", ".mat", ".csv", ".xlsx", ".parquet")


class Argument(NamedTuple):
    """One argument: its names, the endings of the file that it names, and what argparse's `add_argument` takes."""

    names: tuple[str, ...]
    ends: Sequence[str]
    how: Mapping[str, Any]


def argument(*names: str, ends: Sequence[str] = (), **how: Any) -> Argument:
    """An argument, with the properties of argparse's `add_argument`.

    Examples
    --------
    >>> argument("--figure", metavar="FILE", ends=FIGURES, help="draw it (.png, .svg or .pdf)").names
    ('--figure',)
    """
    return Argument(names, ends, how)


#: What every command takes; a command that names no other group has it by itself.
JSON = (argument("--json", action="store_true", help="print all results as JSON on stdout"),)
#: What a command takes that may read a study file.
CODE = (
    argument("--allow-code", action="allow", nargs=0, help="run the Python code that a study file names"),
    *JSON,
)
#: What a command takes that works on one robot.
ROBOT = (
    argument("robot", metavar="ROBOT", help="name of a preset, path of a TOML study file, or module:function of your own"),
    argument("settings", metavar="NAME=VALUE", nargs="*", default=[], help="numbers of the robot, and arguments of the solver (optional)"),
    *CODE,
)
#: Where motions without a drive are looked at.
SECTION = (
    argument(
        "--section", metavar="STATE[,VALUE[,DIRECTION]]",
        help="of a machine or flow without a period: where its motions are looked at, such as v, v,0.1 or v,0.1,-1 (falls)",
    ),
    argument("--turns", metavar="N", type=int, help="look after so many returns to it (default 1)"),
)  # fmt: skip
#: How a measured record is named.
RECORDS = (
    argument("--unit", action="append", metavar="NAME=UNIT", default=[], help="unit of a channel, such as LDV=m/s (may be repeated)"),
    argument("--role", action="append", metavar="NAME=ROLE", default=[], help="role of a channel, such as LDV=velocity"),
    argument("--scale", action="append", metavar="NAME=VALUE", default=[], help='sensitivity of a sensor, such as "LDV=25 mm/s/V"'),
    argument("--columns", metavar="A,B,...", help='headings of all columns, such as "t [ms],v [mm/s]"'),
    argument("--separator", metavar="MARK", help='separator of the columns of a text file, such as ";" or tab'),
    argument("--decimal", metavar="MARK", choices=[".", ","], help='decimal mark of a text file, "." or ","'),
    argument("--rate", metavar="HZ", type=float, help="samples per second, for a file without times"),
    argument("--settle", metavar="N", default="auto", help="drive periods at the start to leave out (default: found in the record)"),
    argument("--between", metavar="A..B", help="use the part from A to B seconds"),
)
#: What is known of a sensor, for commands that fit.
SENSOR = argument(
    "--sensor",
    action="append",
    metavar="NAME=VALUE",
    default=[],
    help="sensor effects: offset=0 fixes it, gain=normal:1:0.02 is a prior, drift=fit leaves it free; ideal: none",
)
#: Where a long command computes, besides the threads of workers=.
EXECUTOR = (
    argument(
        "--executor", metavar="WHERE", help="processes:N, or module:function that makes an executor (of a cluster), instead of threads"
    ),
)
#: Where a study is written, and how.
STUDIES = (
    argument("--out", metavar="PATH", help="a study folder, filled tile by tile, or a .nc, .mat, .csv, .xlsx or .parquet file"),
    argument("--resume", action="store_true", help="continue the study in --out"),
    argument("--shard", metavar="I/N", help="compute only part I of N of the study (then: stickslip merge)"),
    argument("--dask", metavar="ADDRESS", help="compute on the Dask cluster of this scheduler, such as tcp://host:8786"),
    *EXECUTOR,
    argument("--tile", metavar="CASES", type=int, help="cases that are computed and written together"),
    argument("--along", metavar="NAME", help="start each case where its neighbour along this axis ended, up and down"),
)


class Command(NamedTuple):
    """A command as it was declared, with the function that does it."""

    act: Callable[[Any], Any]
    about: str
    arguments: tuple[Argument, ...]
    more: str
    example: str
    open_ended: bool


_DECLARED: dict[str, Command] = {}


def command(
    about: str, arguments: Sequence[Argument] = (), more: str = "", example: str = "", open_ended: bool = False
) -> Callable[[T], T]:
    """Declare the command of this module; the decorated function takes the parsed arguments and returns an `Outcome` or an exit code.

    Parameters
    ----------
    about : str
        What it does, at the head of its help.
    arguments : sequence of Argument
        `ROBOT` for a command on one robot, `CODE` for one that may read a study file. `JSON`, which these contain, is added to others.
    more : str
        What its help says after the arguments.
    example : str
        Lines that begin with ``$`` are typed, the others are output, where ``…`` stands for anything. The tests run it.
    open_ended : bool
        Whether it passes words that it does not know to another command.
    """
    given = (*(() if JSON[0] in arguments else JSON), *arguments)

    def declared(act: T) -> T:
        _DECLARED[act.__module__] = Command(act, about, given, more, example, open_ended)  # type: ignore[arg-type]
        return act

    return declared


def names() -> list[str]:
    """The commands, in the order of the help.

    Examples
    --------
    >>> names()[:3]
    ['run', 'check', 'sweep']
    """
    there = sorted(file.stem.replace("_", "-") for file in _FOLDER.glob("[a-z]*.py"))
    return sorted(there, key=lambda name: commands.FIRST.index(name) if name in commands.FIRST else len(there))


def summary_line(name: str) -> str:
    """The line of a command in the list, from the first line of its file, which is not run for it.

    Examples
    --------
    >>> summary_line("run")
    'simulate one robot and report its motion'
    """
    with (_FOLDER / f"{name.replace('-', '_')}.py").open(encoding="utf-8") as file:
        return file.readline().partition("``: ")[2].partition('"""')[0].removesuffix(".")


def declaration(name: str) -> Command:
    """A command, whose module is imported only now."""
    module = importlib.import_module(_module(name))
    if module.__name__ not in _DECLARED:
        raise StickslipError(f"{module.__file__} declares no command; put @command(about=...) before its function")
    return _DECLARED[module.__name__]


def _module(name: str) -> str:
    return f"{commands.__name__}.{name.replace('-', '_')}"


def commands_in(example: str) -> list[tuple[str, str]]:
    r"""The typed lines of an example with their output.

    Examples
    --------
    >>> commands_in("$ stickslip doctor\nall is in order\n")
    [('stickslip doctor', 'all is in order\n')]
    """
    parts = re.split(r"^\$ (.*)\n", example, flags=re.MULTILINE)
    return list(zip(parts[1::2], parts[2::2], strict=True))
