"""``stickslip paper``: the whole paper again, in one folder."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

from stickslip.basics.errors import InputError, as_path
from stickslip.show.cli import show
from stickslip.show.cli.outputs import Outcome


def act(asked: Any) -> Outcome:
    """Do the command."""
    folder = as_path(asked.out, "paper")
    _check(folder)

    from stickslip.show import paper

    print(f"this takes about {'a minute' if asked.fast else 'two minutes'} the first time", file=sys.stderr, flush=True)
    result = paper.reproduce(folder, fast=asked.fast, progress=show.stages())
    return Outcome(result.to_dict, result)


def _check(folder: Path) -> None:
    """Report an unusable folder before the work starts."""
    above = show.existing(folder)
    if not above.is_dir() or not os.access(above, os.W_OK):
        raise InputError("--out", [f"{str(folder)!r} cannot be made or written; give another, such as --out ~/stickslip-paper"])
