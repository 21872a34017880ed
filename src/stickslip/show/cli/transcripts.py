"""Examples of every command with their output, in files that a test runs; ``--help`` ends with them."""

from __future__ import annotations

import re
from pathlib import Path

FOLDER = Path(__file__).parent / "examples"


def transcript(command: str) -> str:
    """The example of a command: lines that begin with ``$`` are typed, the others are output; ``…`` stands for anything.

    Examples
    --------
    >>> print(transcript("run").splitlines()[0])
    $ stickslip run piezo_rig tilt_deg=1.7 amplitude=5.56e-4
    """
    path = FOLDER / f"{command}.txt"
    return path.read_text(encoding="utf-8") if path.exists() else ""


def commands_in(text: str) -> list[tuple[str, str]]:
    r"""The typed commands of a transcript with their output.

    Examples
    --------
    >>> commands_in("$ stickslip doctor\nall is in order\n")
    [('stickslip doctor', 'all is in order\n')]
    """
    parts = re.split(r"^\$ (.*)\n", text, flags=re.MULTILINE)
    return list(zip(parts[1::2], parts[2::2], strict=True))
