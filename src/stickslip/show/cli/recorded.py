"""Common arguments of the commands on measured records."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError

if TYPE_CHECKING:
    from argparse import Namespace


_TYPED = Path(__file__).parent / "templates" / "typed_in_python.toml"


def in_command_words(text: str, of: str = "records") -> str:
    """A sentence with its advice for Python replaced by that for the command line.

    Examples
    --------
    >>> in_command_words('type units={"LDV": "m/s"} with the right one'), in_command_words("settle=0 takes them as steady")
    ('type --unit LDV=m/s with the right one', '--settle 0 takes them as steady')
    >>> in_command_words('type columns=["t [s]", "v [mm/s]"]'), in_command_words('type for example free={"mu0": (0.05, 0.5)}')
    ('type --columns "t [s],v [mm/s]"', 'type for example --free mu0=0.05..0.5')
    >>> in_command_words('type for example over={"drive.amplitude": (2e-4, 8e-4)}; widen the bounds in over', "searches")
    'type for example --over drive.amplitude=2e-4..8e-4; widen the bounds in --over'
    >>> in_command_words('type sensor={"offset": None, "gain": ("normal", 1.0, 0.001), "delay": 0.0}')
    'type --sensor offset=fit --sensor gain=normal:1.0:0.001 --sensor delay=0.0'
    """
    text = re.sub(r'(unit|role|scale)s?=\{((?:"[^"]*": "[^"]*", )+"[^"]*": "[^"]*")\}', _each_pair, text)
    text = re.sub(
        r'numbers=\{((?:"[^"]*": [^,}]+(?:, )?)+)\}',
        lambda typed: re.sub(r'"(\w+)": ([^,]+)(, )?', r"--set \1=\2 ", typed[1]).strip(),
        text,
    )
    text = re.sub(r'\bsensor=\{("\w+": [^{}]*)\}', lambda typed: " ".join(_of_a_sensor(typed[1])), text)
    for pattern, words in tomllib.loads(_TYPED.read_text(encoding="utf-8"))[of]:
        text = re.sub(pattern, words, text)
    return text


def _each_pair(typed: re.Match[str]) -> str:
    """Several pairs of a dict as as many options."""
    return " ".join(f'--{typed[1]} "{name}={value}"' for name, value in re.findall(r'"([^"]*)": "([^"]*)"', typed[2]))


def _of_a_sensor(typed: str) -> list[str]:
    """What is typed of each effect of a sensor, as an option."""
    effects = re.findall(r'"(\w+)": (None|\([^()]*\)|[^,()]+)', typed)
    values = ("fit" if value == "None" else re.sub(r'[()" ]', "", value).replace(",", ":") for _, value in effects)
    return [f"--sensor {name}={value}" for (name, _), value in zip(effects, values, strict=True)]


@contextmanager
def in_words_of_the_shell(of: str = "records") -> Iterator[None]:
    """Within this context, errors give advice for the command line."""
    try:
        yield
    except InputError as error:
        raise InputError(error.what, [in_command_words(sentence, of) for sentence in error.problems]) from None


def pairs(words: list[str], what: str) -> dict[str, str]:
    """NAME=TEXT words as a dict."""
    texts = {}
    for word in words:
        name, equals, text = word.rpartition("=")
        if not equals or not name or not text:
            raise InputError(what, [f"{word!r} is not NAME=VALUE; type for example {what} LDV=m/s"])
        texts[name] = text
    return texts


def opened_record(path: str, asked: Namespace) -> Any:
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


def settle(asked: Namespace) -> int | str:
    """The number of transient periods to leave out."""
    if asked.settle == "auto":
        return "auto"
    if not asked.settle.isdigit():
        raise InputError("--settle", [f"{asked.settle!r} is not a number of drive periods; type for example --settle 10"])
    return int(asked.settle)
