"""Names of a law and of its numbers that are valid in other languages."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from stickslip.basics.errors import InputError

#: Keywords of C and MATLAB, and functions of the MATLAB file, which cannot be used as names.
_WORDS = """
auto break case char const continue default do double else enum extern float for goto if inline int long register restrict return short
signed sizeof static struct switch typedef union unsigned void volatile while
catch classdef end elseif function global otherwise parfor persistent spmd try
start force rate step sliding breakaway advance slopes guards switched turned choose
"""
TAKEN = frozenset(_WORDS.split())


def prefix_of(law: Any, name: str | None) -> str:
    """The prefix of the functions of a law."""
    if name is None:
        return type(law).__name__.lower() if _plain(type(law).__name__.lower()) else "law"
    if not isinstance(name, str) or not _plain(name):
        raise InputError("export_law", [f"name = {name!r}; allowed is a name that C and MATLAB take; type for example name='my_joint'"])
    return name


def names_of_numbers(names: Iterable[str]) -> dict[str, str]:
    """Dotted names of numbers -> unique names of fields.

    Examples
    --------
    >>> names_of_numbers(["mu_plus", "weights.0", "double", "μ"])
    {'mu_plus': 'mu_plus', 'weights.0': 'weights_0', 'double': 'double_', 'μ': 'number_3'}
    """
    fields: dict[str, str] = {}
    for k, name in enumerate(names):
        field = re.sub(r"\W", "_", name)
        field = f"{field}_" if field in TAKEN else field
        field = field if _plain(field) else f"number_{k}"
        while field in fields.values():
            field += "_"
        fields[name] = field
    return fields


def _plain(name: str) -> bool:
    return re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,39}", name) is not None and name not in TAKEN
