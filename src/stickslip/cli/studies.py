"""``stickslip merge`` and ``stickslip export``: what becomes of study folders."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from stickslip.cli import show
from stickslip.cli.arguments import parser
from stickslip.cli.outputs import FILES, is_run
from stickslip.cli.run import DATA, written_to
from stickslip.errors import as_path

__all__ = ["act"]


def act(command: str, words: list[str]) -> int:
    """Do the command."""
    return {"merge": _merge, "export": _export}[command](command, words)


def _merge(command: str, words: list[str]) -> int:
    made = parser(command, "Merge the shards of one study, as if it had been one run.", robot=False)
    made.add_argument("folders", metavar="FOLDER", nargs="+", help="study folders of the shards")
    made.add_argument("--out", metavar="FOLDER", required=True, help="the study folder to make")
    made.add_argument("--partial", action="store_true", help="tiles may be missing")
    asked = made.parse_args(words)

    from stickslip.sweeps import merge

    return _tell(merge(asked.folders, asked.out, asked.partial), asked.out, asked.json)


def _export(command: str, words: list[str]) -> int:
    made = parser(command, "Write the results of a study, or every column of a run, to one file.", robot=False)
    made.add_argument("results", metavar="RESULTS", help="a study folder, the .nc file of a sweep, or the .nc file of a run")
    made.add_argument("file", metavar="FILE", help="a .nc, .mat, .csv, .xlsx or (of a study) .parquet file")
    asked = made.parse_args(words)
    source = as_path(asked.results, "study")
    if source.is_file() and is_run(source, command):
        return _export_run(source, show.writable("FILE", asked.file, DATA), asked.json)
    target = show.writable("FILE", asked.file, FILES)

    from stickslip.sweeps import export, open_study

    grid = open_study(source)
    export(grid, str(target))
    return _tell(grid, str(target), asked.json)


def _export_run(source: Path, target: Path | None, as_json: bool) -> int:
    from stickslip.io import load

    run = load(source)
    written = str(written_to(run, target))
    if as_json:
        show.print_json({"written": written, "instants": len(run.t)})
    else:
        print(f"the run in {source}: {show.counted(len(run.t), 'instant')}; written to {written}")
    return 0


def _tell(grid: Any, written: str, as_json: bool) -> int:
    sizes = {str(d): int(grid.sizes[d]) for d in grid["mean_velocity"].dims}
    if as_json:
        show.print_json({"written": written, "sizes": sizes, "attributes": dict(grid.attrs)})
    else:
        shape = " x ".join(f"{name} {n}" for name, n in sizes.items()) or "one case"
        print(f"{grid.attrs['maker']}: {shape}; written to {written}")
    return 0
