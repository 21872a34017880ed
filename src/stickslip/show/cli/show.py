"""Output of results in a terminal, and as JSON."""

from __future__ import annotations

import io
import json
import math
import os
import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from stickslip.basics.errors import InputError, as_path
from stickslip.basics.jsontext import strict
from stickslip.basics.phrases import counted


def quantity_text(value: float, unit: str = "", digits: int = 7) -> str:
    """A number with its unit; a dash if it is not finite.

    Examples
    --------
    >>> quantity_text(0.002032038697782, "m/s"), quantity_text(float("nan"), "m/s")
    ('0.002032039 m/s', '-')
    """
    if value is None or not math.isfinite(value):
        return "-"
    return f"{value:.{digits}g} {unit}".rstrip()


def no_period(periods: int) -> str:
    """The text for a motion that was not found to repeat."""
    within = counted(periods, "period")
    return f"no motion period was found within {within}: the mean velocity still depends on how long the run is; try more periods"


def facts(rows: Iterable[tuple[str, str]]) -> str:
    """Names and values in two columns."""
    rows = list(rows)
    width = max(len(name) for name, _ in rows)
    return "\n".join(f"  {name:<{width}}  {text}" for name, text in rows)


def run_text(record: dict[str, Any], rows: Iterable[tuple[str, str]], method: str) -> str:
    """The text on a run: its name, facts, remarks, files, and provenance."""
    more = [(word, text) for word, name in (("note", "notes"), ("written", "written")) for text in record[name]]
    made = f"stickslip {record['provenance']['versions']['stickslip']}, {method}"
    return f"{record['robot']}\n{facts([*rows, *more, ('made by', made)])}"


def existing(path: Path) -> Path:
    """A path, or its nearest existing parent."""
    while not path.exists() and path != path.parent:
        path = path.parent
    return path


def is_watched() -> bool:
    """Whether stderr is a terminal."""
    return sys.stderr.isatty() and os.environ.get("TERM") != "dumb"


def aligned_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Rows of text in aligned columns."""
    widths = [max([len(head[i]), *(len(row[i]) for row in rows)]) for i in range(len(head))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in [head, *rows])


def print_json(record: Any) -> None:
    """Strict JSON: NaN and infinite numbers become null."""
    print(json.dumps(strict(record), indent=1, allow_nan=False, ensure_ascii=False))


def stages(quiet: bool = False) -> Callable[[str, int, int], None]:
    """A function that reports progress on stderr: on one line in a terminal, else with a line for each kind of task.

    Parameters
    ----------
    quiet : bool
        Print nothing if stderr is not a terminal, and clear the line after the last stage.
    """
    last, reported = "", set()
    over = is_watched()

    def tell(what: str, done: int, whole: int) -> None:
        nonlocal last
        if quiet and not over:
            return
        if over:
            line = f"{what} {done}/{whole}" if whole > 1 else what
            line = "" if quiet and done >= whole else line
            print(f"\r{line:<{max(len(last), 1)}}", end="", file=sys.stderr, flush=True)
            last = line
        elif (kind := what.partition(" ")[0]) not in reported:  # drawing, judging, …
            print(f"{what.partition(':')[0]} …", file=sys.stderr, flush=True)
            reported.add(kind)

    return tell


def writable(option: str, path: str | None, suffixes: Sequence[str]) -> Path | None:
    """The path if a file of a known kind can be written there; checked before the work."""
    if path is None:
        return None
    target = as_path(path, "output")
    if target.suffix.lower() not in suffixes:
        ending = f"ends in {target.suffix!r}" if target.suffix else "has no ending"
        raise InputError(option, [f"{path!r} {ending}; allowed are {', '.join(suffixes)}; type for example result{suffixes[0]}"])
    folder = target.parent
    if not folder.is_dir():
        raise InputError(option, [f"{path!r}: the folder {str(folder)!r} does not exist; make it first, or give another path"])
    if target.is_dir() or not os.access(target if target.exists() else folder, os.W_OK):
        raise InputError(option, [f"{path!r} cannot be written; give a path in a folder that you may write to"])
    return target


def draw_to(path: Path, figure: Any) -> Path:
    """Save a figure; an existing file is replaced in a single step at the end."""
    from stickslip.basics.whole_files import unwritable, write_whole

    drawn = io.BytesIO()
    figure.savefig(drawn, format=path.suffix.lower().lstrip("."))
    return write_whole(path, drawn.getvalue(), unwritable("figure"))
