"""Outputs of the dynamics commands: a figure, a file (netCDF, MATLAB, CSV or Parquet, as for sweeps), and text or JSON."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.basics.errors import InputError
from stickslip.show.cli import show

if TYPE_CHECKING:
    from argparse import Namespace


#: File extensions.
FILES = (".nc", ".mat", ".csv", ".xlsx", ".parquet")


@dataclass(frozen=True)
class Outcome:
    """Results of a command: JSON record and text, or functions that make them; files with functions that draw them; data for `out`."""

    record: Any
    text: Any
    draws: tuple[tuple[Path | None, Callable[[], Any]], ...] = ()
    out: Path | str | None = None
    data: Any = None  # a dataset for `out`, unless that was written already
    in_print: bool = False  # draw figures with the settings of `plot.publication`
    code: int = 0


def deliver(asked: Namespace, outcome: Outcome | int) -> int:
    """Write, print and draw the results, in this order, so that an error in a figure loses no numbers."""
    if isinstance(outcome, int):
        return outcome
    if outcome.out is not None and outcome.data is not None:
        from stickslip.studies import export

        export(outcome.data, outcome.out)
    if not asked.json:
        print(_made(outcome.text))
    for path, draw in outcome.draws:
        if path is not None:
            _draw(path, draw, outcome.in_print)
    written = [str(path) for path in (*(path for path, _ in outcome.draws), outcome.out) if path is not None]
    if asked.json:
        show.print_json(_made(outcome.record) | ({"written": written} if outcome.draws else {}))
    for name in () if asked.json else written:
        print(f"written to {name}")
    return outcome.code


def _draw(path: Path, draw: Callable[[], Any], in_print: bool) -> None:
    import matplotlib

    from stickslip.show.figures import publication
    from stickslip.show.reports import write

    matplotlib.use("Agg")
    with publication() if in_print else nullcontext():
        made = draw()
        write(path, made) if isinstance(made, str) else show.draw_to(path, made.figure)


def _made(what: Any) -> Any:
    return what() if callable(what) else what


def is_run(path: Path, command: str) -> bool:
    """Whether a netCDF file holds a run, rather than the results of a sweep."""
    import h5py

    if not path.exists():
        raise InputError(command, [f"there is no {str(path)!r}; give a .nc file of ours or a study folder"])
    try:
        with h5py.File(path) as file:
            return "mean_velocity" not in file
    except OSError as error:
        raise InputError(command, [f"{str(path)!r} cannot be read: {error}; give a .nc file of ours or a study folder"]) from None


def study_written(grid: Any, written: str) -> Outcome:
    """What was written: the study, its sizes and the place."""
    sizes = {str(d): int(grid.sizes[d]) for d in grid["mean_velocity"].dims}
    shape = " x ".join(f"{name} {n}" for name, n in sizes.items()) or "one case"
    record = {"written": written, "sizes": sizes, "attributes": dict(grid.attrs)}
    return Outcome(record, f"{grid.attrs['maker']}: {shape}; written to {written}")
