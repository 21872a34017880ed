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
FILES = (".nc", ".mat", ".csv", ".parquet")


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
    made.add_argument("--out", metavar="FILE", help=f"write {written} (.nc, .mat, .csv or .parquet)")


def targets(asked: Any) -> Targets:
    """Where the figure and the file go; `InputError` where they cannot."""
    return Targets(show.writable("--figure", asked.figure, (".png", ".svg", ".pdf")), show.writable("--out", asked.out, FILES))


def finish(asked: Any, files: Targets, found: Outcome) -> int:
    """Draw, write and print what was found."""
    if files.figure is not None:
        found.draw().figure.savefig(files.figure)
    if files.out is not None:
        _save(found.data, files.out)
    written = [str(path) for path in (files.figure, files.out) if path is not None]
    if asked.json:
        show.print_json({**found.record, "written": written})
    else:
        print("\n".join([found.text, *(f"written to {path}" for path in written)]))
    return 0


def _save(found: Any, path: Path) -> None:
    """Write a labelled dataset; rows of a table have every coordinate, and units stand in the heads of a CSV file."""
    write = {".nc": _netcdf, ".mat": _matlab, ".csv": _csv, ".parquet": _parquet}[path.suffix.lower()]
    write(found, path)


def _netcdf(found: Any, path: Path) -> None:
    found.to_netcdf(path, engine="h5netcdf")


def _matlab(found: Any, path: Path) -> None:
    import numpy as np
    from scipy.io import savemat

    columns = {}
    for name in found.variables:
        values = np.asarray(found[name].values)
        columns[str(name).replace(".", "_")] = values.astype(object) if values.dtype.kind in "OSU" else values
    units = {str(name).replace(".", "_"): str(found[name].attrs.get("units", "1")) for name in found.variables}
    about = {str(name): value for name, value in found.attrs.items() if isinstance(value, (str, int, float))}
    savemat(path, {**columns, "units": units, "about": about}, oned_as="column", appendmat=False, long_field_names=True)


def _csv(found: Any, path: Path) -> None:
    rows = found.to_dataframe().reset_index()
    units = {name: found[name].attrs.get("units", "1") if name in found.variables else "1" for name in rows.columns}
    rows.columns = [name if units[name] in ("", "1") else f"{name} [{units[name]}]" for name in rows.columns]
    rows.to_csv(path, index=False)


def _parquet(found: Any, path: Path) -> None:
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError:
        raise InputError("--out", ['Parquet needs pyarrow; type pip install "stickslip[parquet]", or give a .csv or .nc path']) from None
    pq.write_table(pa.Table.from_pandas(found.to_dataframe().reset_index(), preserve_index=False), path)


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
