"""Counts and lists as a sentence writes them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any


def counted(number: int, thing: str) -> str:
    """A count with its noun, in the singular or plural.

    Examples
    --------
    >>> counted(1, "period"), counted(2, "period")
    ('1 period', '2 periods')
    """
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def listed(things: Iterable[Any], last: str = "and") -> str:
    """A list in words; "none" if it is empty.

    Examples
    --------
    >>> listed(["I", "II", "IV"])
    'I, II and IV'
    """
    texts = [str(t) for t in things]
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} {last} {texts[-1]}" if texts else "none"
