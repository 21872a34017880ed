"""``stickslip merge`` and ``stickslip export``: what becomes of study folders."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from stickslip.basics.errors import as_path
from stickslip.show.cli import show
from stickslip.show.cli.outputs import FILES, Outcome, is_run
from stickslip.show.cli.run import DATA, written_to


def act(asked: Any) -> Outcome:
    """Do the command."""
    return {"merge": _merge, "export": _export}[asked.command](asked)


def _merge(asked: Any) -> Outcome:
    from stickslip.studies import merge

    return _told(merge(asked.folders, asked.out, asked.partial), asked.out)


def _export(asked: Any) -> Outcome:
    source = as_path(asked.results, "study")
    if source.is_file() and is_run(source, asked.command):
        return _export_run(source, show.writable("FILE", asked.file, DATA))
    target = show.writable("FILE", asked.file, FILES)

    from stickslip.studies import export, open_study

    grid = open_study(source)
    export(grid, str(target))
    return _told(grid, str(target))


def _export_run(source: Path, target: Path | None) -> Outcome:
    from stickslip.results.loading import load

    run = load(source)
    written, count = str(written_to(run, target)), len(run.t)
    text = f"the run in {source}: {show.counted(count, 'instant')}; written to {written}"
    return Outcome({"written": written, "instants": count}, text)


def _told(grid: Any, written: str) -> Outcome:
    sizes = {str(d): int(grid.sizes[d]) for d in grid["mean_velocity"].dims}
    shape = " x ".join(f"{name} {n}" for name, n in sizes.items()) or "one case"
    record = {"written": written, "sizes": sizes, "attributes": dict(grid.attrs)}
    return Outcome(record, f"{grid.attrs['maker']}: {shape}; written to {written}")
