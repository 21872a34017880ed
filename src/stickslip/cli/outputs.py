"""How the dynamics commands end: a figure, a file (netCDF, MATLAB, CSV or Parquet, as sweeps have them), and text or JSON."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stickslip.cli import show
from stickslip.errors import InputError

__all__ = ["FILES", "Outcome", "Targets", "add_targets", "finish", "is_run", "targets"]

#: Endings of the files.
FILES = (".nc", ".mat", ".csv", ".xlsx", ".parquet")


@dataclass(frozen=True)
class Outcome:
    """What a command found: as JSON, as text, as a labelled dataset, and what draws it."""

    record: dict[str, Any]
    text: str
    data: Any
    draw: Callable[[], Any]  # makes the axes


@dataclass(frozen=True)
class Targets:
    """Files that were asked for, checked before anything is computed."""

    figure: Path | None
    out: Path | None


def add_targets(made: Any, drawn: str, written: str) -> None:
    """The options --figure and --out of a command."""
    made.add_argument("--figure", metavar="FILE", help=f"draw {drawn} (.png, .svg or .pdf)")
    made.add_argument("--out", metavar="FILE", help=f"write {written} (.nc, .mat, .csv, .xlsx or .parquet)")


def targets(asked: Any) -> Targets:
    """Where the figure and the file go; `InputError` where they cannot."""
    return Targets(show.writable("--figure", asked.figure, (".png", ".svg", ".pdf")), show.writable("--out", asked.out, FILES))


def finish(asked: Any, files: Targets, found: Outcome) -> int:
    """Write, print and draw what was found; in this order, so that a picture that cannot be drawn loses no numbers."""
    if files.out is not None:
        from stickslip.sweeps import export

        export(found.data, files.out)
    if not asked.json:
        print(found.text)
    if files.figure is not None:
        show.draw_to(files.figure, found.draw().figure)
    written = [str(path) for path in (files.figure, files.out) if path is not None]
    if asked.json:
        show.print_json({**found.record, "written": written})
    for path in () if asked.json else written:
        print(f"written to {path}")
    return 0


def is_run(path: Path, command: str) -> bool:
    """Whether a netCDF file is a run, and not the results of a sweep."""
    import h5py

    if not path.exists():
        raise InputError(command, [f"there is no {str(path)!r}; give a .nc file of ours or a study folder"])
    try:
        with h5py.File(path) as file:
            return "mean_velocity" not in file
    except OSError as error:
        raise InputError(command, [f"{str(path)!r} cannot be read: {error}; give a .nc file of ours or a study folder"]) from None
