"""``stickslip paper``: the whole paper again, in one folder."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from stickslip.cli import show
from stickslip.cli.arguments import parser
from stickslip.errors import InputError, as_path

__all__ = ["act"]


def act(command: str, words: list[str]) -> int:
    """Do the command."""
    made = parser(command, "Reproduce the paper: its table, figures 6 to 30, claims and errata, as one offline HTML report.", robot=False)
    made.add_argument("--out", metavar="FOLDER", default="stickslip-paper", help="where to write it (default: ./stickslip-paper)")
    made.add_argument("--fast", action="store_true", help="a subset that takes about a minute")
    asked = made.parse_args(words)
    folder = as_path(asked.out, "paper")
    _check(folder)

    from stickslip import paper

    print(f"this takes about {'a minute' if asked.fast else 'two minutes'} the first time", file=sys.stderr, flush=True)
    result = paper.reproduce(folder, fast=asked.fast, progress=show.stages())
    if asked.json:
        show.print_json(result.to_dict())
    else:
        print(result)
    return 0


def _check(folder: Path) -> None:
    """Say before the work, not after it, that the folder cannot be made."""
    above = folder
    while not above.exists() and above != above.parent:
        above = above.parent
    if not above.is_dir() or not os.access(above, os.W_OK):
        raise InputError("--out", [f"{str(folder)!r} cannot be made or written; give another, such as --out ~/stickslip-paper"])
