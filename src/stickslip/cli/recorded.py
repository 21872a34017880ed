"""What the commands on measured records share: how a record is named on the command line."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from stickslip.cli.arguments import Parser
from stickslip.errors import InputError

__all__ = ["add_options", "in_words_of_the_shell", "opened", "pairs", "settle", "typed"]

#: What the functions say is to be typed, and what the command line calls it.
_TYPED = (
    (r'units=\{"([^"]*)": "([^"]*)"\}', r'--unit "\1=\2"'),
    (r'roles=\{"([^"]*)": "([^"]*)"\}(?: \(--role [^)]*\))?', r'--role "\1=\2"'),
    (r"roles=\{\"\.\.\.\": \"(\w+)\"\} when reading", r"--role NAME=\1"),
    (r'columns=\["([^"]*)", \.\.\.\]', r'--columns "\1,..."'),
    (r"\brate=(\S+) \[Hz\]", r"--rate HZ"),
    (r"\bsettle=(\d+)", r"--settle \1"),
    (r"\btransient=True\b", "--transient"),
    (r"\bsensor=\{\}", "--sensor ideal"),
    (r'\bsensor=\{"(\w+)": 0\.0[^}]*\}', r"--sensor \1=0, and --sensor NAME=fit for what else it adds"),
    (r"\bnoise=\.\.\.", "--noise ..."),
    (r'\bfree=\{"([\w.]+)": \(([^,)]+), ([^,)]+)\)\}', r"--free \1=\2..\3"),
    (r'\bscale=\{"([^"]*)": "([^"]*)"\}', r'--scale "\1=\2"'),
    (r'columns=\["([^"]*)", "([^"]*)"\]', r'--columns "\1,\2"'),
    (r'separator="([^"]*)"', r'--separator "\1"'),
    (r'decimal="([^"]*)"', r'--decimal "\1"'),
    (r'ss\.read\(path, ((?:--\w+ "[^"]*"(?:, | or )?)+)\)', r"\1"),
    (r'", --(separator|decimal)', r'" --\1'),
)


def typed(text: str) -> str:
    """A sentence with what is to be typed on the command line, where it says what to type in Python.

    Examples
    --------
    >>> typed('type units={"LDV": "m/s"} with the right one'), typed("settle=0 takes them as steady")
    ('type --unit LDV=m/s with the right one', '--settle 0 takes them as steady')
    >>> typed('type columns=["t [s]", "v [mm/s]"]'), typed('type for example free={"mu0": (0.05, 0.5)}')
    ('type --columns "t [s],v [mm/s]"', 'type for example --free mu0=0.05..0.5')
    """
    for pattern, words in _TYPED:
        text = re.sub(pattern, words, text)
    return re.sub(r'(--(?:unit|role) )"([^\s"]+)"', r"\1\2", text).replace(", --role", " --role")


@contextmanager
def in_words_of_the_shell() -> Iterator[None]:
    """Errors of what is done inside say what to type on the command line."""
    try:
        yield
    except InputError as error:
        raise InputError(error.what, [typed(sentence) for sentence in error.problems]) from None


def add_options(made: Parser) -> None:
    """The options that say what a file does not."""
    made.add_argument(
        "--unit", metavar="NAME=UNIT", action="append", default=[], help="unit of a channel, such as LDV=m/s (may be repeated)"
    )
    made.add_argument("--role", metavar="NAME=ROLE", action="append", default=[], help="role of a channel, such as LDV=velocity")
    made.add_argument("--scale", metavar="NAME=VALUE", action="append", default=[], help='sensitivity of a sensor, such as "LDV=25 mm/s/V"')
    made.add_argument("--columns", metavar="A,B,...", help='headings of all columns, such as "t [ms],v [mm/s]"')
    made.add_argument("--separator", metavar="MARK", help='separator of the columns of a text file, such as ";" or tab')
    made.add_argument("--decimal", metavar="MARK", choices=(".", ","), help='decimal mark of a text file, "." or ","')
    made.add_argument("--rate", metavar="HZ", type=float, help="samples per second, for a file without times")
    made.add_argument(
        "--settle", metavar="N", default="auto", help="drive periods at the start to leave out (default: found in the record)"
    )
    made.add_argument("--between", metavar="A..B", help="use the part from A to B seconds")


def pairs(words: list[str], what: str) -> dict[str, str]:
    """NAME=TEXT words as a dict."""
    found = {}
    for word in words:
        name, equals, text = word.rpartition("=")
        if not equals or not name or not text:
            raise InputError(what, [f"{word!r} is not NAME=VALUE; type for example {what} LDV=m/s"])
        found[name] = text
    return found


def opened(path: str, asked: Any) -> Any:
    """The record at a path, read with the options."""
    from stickslip.records import read

    rec = read(
        path,
        units=pairs(asked.unit, "--unit"),
        roles=pairs(asked.role, "--role"),
        columns=None if asked.columns is None else [part.strip() for part in asked.columns.split(",")],
        rate=asked.rate,
        scale=pairs(asked.scale, "--scale"),
        separator={"tab": "\t", "\\t": "\t", "space": " "}.get(asked.separator or "", asked.separator or None),
        decimal=asked.decimal,
    )
    if not asked.between:
        return rec
    first, dots, last = asked.between.partition("..")
    try:
        return rec.between(float(first), float(last)) if dots else rec.between(float(first), float("inf"))
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError("--between", [f"{asked.between!r} is not part of the record; type for example --between 20..60"]) from None


def settle(asked: Any) -> int | str:
    """The periods to leave out."""
    if asked.settle == "auto":
        return "auto"
    if not asked.settle.isdigit():
        raise InputError("--settle", [f"{asked.settle!r} is not a number of drive periods; type for example --settle 10"])
    return int(asked.settle)
