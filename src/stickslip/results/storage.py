"""Runs on disk: netCDF4 files that come back as they were, and MATLAB files.

A file holds the sampled columns at its root, for MATLAB and every other reader of netCDF4, and the dense output in the group
``pieces``, from which `stickslip.load` makes the run again. There is no pickle in it.
"""

from __future__ import annotations

import dataclasses
import io
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics import hdf5
from stickslip.basics.contracts import OneContact
from stickslip.basics.errors import InputError, as_path, is_one_of
from stickslip.basics.jsontext import as_plain
from stickslip.basics.unpacking import Allowance
from stickslip.basics.whole_files import for_hdf5, unwritable, whole_file
from stickslip.basics.workbooks import write_workbook
from stickslip.models.friction import LAWS, Coulomb
from stickslip.models.friction.law_adapter import adapted
from stickslip.models.machines import MECHANISMS
from stickslip.models.mechanics import lists_parts
from stickslip.models.model_adapter import adapter_of
from stickslip.models.robot import Robot
from stickslip.models.tables import document_of
from stickslip.results import flow_files
from stickslip.results.datasets import attributes, trajectory_dataset, write_csv
from stickslip.results.dense_output import KINDS, kind_of_pieces, pieces_from_arrays
from stickslip.results.events import Event
from stickslip.results.named_events import KIND

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory

#: Version of the file format; a reader refuses a newer one, and format 1, which no release has written.
FORMAT = 2
#: The first version of the format that a file can have.
EARLIEST = 2


# ---- netCDF4 ----
def save(run: Any, path: str | Path) -> Path:
    """Write a run to a file; an existing file is replaced. The ending of its name says what it holds.

    A law or a machine of your own is kept by its name and numbers; `stickslip.load` asks for its class again. The functions of a flow are
    Python code, which no file holds: it asks for the flow. A drive or a track of your own cannot be kept.

    Parameters
    ----------
    run : Trajectory
    path : str or Path
        ``.nc`` (also .nc4, .h5, .hdf5 or no ending) for netCDF4, which `stickslip.load` reads back; ``.csv``, ``.xlsx`` or ``.mat`` for
        the columns alone, which it does not.

    Returns
    -------
    Path
        Where it was written.

    Raises
    ------
    InputError
        Of any other ending, and of a place that cannot be written to.
    """
    path = _path_for(path, "run")
    if path.suffix.lower() in _OF_COLUMNS:
        return save_columns(run, path)
    attrs = {**attributes(run), **_model_attributes(run), "stickslip_format": FORMAT, "stickslip_content": "trajectory"}
    attrs |= {} if run.known_period is None else {"known_period": run.known_period}
    import xarray as xr

    data, kept = trajectory_dataset(run).assign_attrs(attrs), run.pieces.arrays()
    texts = {name: array for name, array in kept.items() if isinstance(array, str)}
    arrays = {name: (tuple(f"{name}_{axis}" for axis in range(array.ndim)), array) for name, array in kept.items() if name not in texts}
    packed = {"compression": "gzip", "compression_opts": 1, "shuffle": True, "_FillValue": None}
    pieces = xr.Dataset(arrays, attrs={"kind": kind_of_pieces(run.pieces), **texts})
    encoding = {str(name): packed for name, variable in data.variables.items() if variable.dtype.kind in "biuf"}
    return save_datasets(path, {"": (data, encoding), "pieces": (pieces, {name: {"_FillValue": None} for name in arrays})})


def save_table(result: Any, path: str | Path, content: str, called: str) -> Path:
    """Write the columns of a result that is no `Trajectory`; the ending says how. Returns its path.

    `content` says in the file what it is, and `called` is the usual name of such a result.
    """
    path = _path_for(path, called)
    if path.suffix.lower() in _OF_COLUMNS:
        return save_columns(result, path)
    attributes = {"stickslip_format": FORMAT, "stickslip_content": content}
    return save_datasets(path, {"": (result.to_xarray().assign_attrs(attributes), {})})


def _path_for(path: str | Path, called: str) -> Path:
    """The path of a file for a result that is usually called so; `InputError` for an ending that is none of ours."""
    path = as_path(path, "save", f"{called}.nc")
    if path.suffix.lower() not in (*NETCDF, *_OF_COLUMNS):
        typed = f"type for example {called}.save('{called}.nc')"
        raise InputError("save", [f"{str(path)!r} ends in {path.suffix!r}; allowed are {_ENDINGS}; {typed}"])
    return path


def save_datasets(path: Path, groups: dict[str, tuple[Any, dict[str, Any]]], doing: str = "save") -> Path:
    """Write datasets with their encodings to the groups of one netCDF4 file ("" is its root); returns its path."""
    import h5netcdf
    from xarray.backends import H5NetCDFStore

    with whole_file(path, unwritable(doing)) as file, for_hdf5(file) as target, h5netcdf.File(target, "w") as whole:
        for name, (data, encoding) in groups.items():
            data.dump_to_store(H5NetCDFStore(whole.create_group(name) if name else whole), encoding=encoding)
    return path


def _model_attributes(run: Trajectory) -> dict[str, str]:
    """The model as TOML; a law that TOML cannot name as its name, kind and numbers beside a stand-in; what tells a flow from others."""
    if not adapter_of(run.model).has_bodies:
        return {"flow": flow_files.description_of(run.model, run.names)}
    model: OneContact = run.model
    if type(model) is not Robot and type(model) not in MECHANISMS.values() and not lists_parts(model):
        allowed = f"a Robot, a mechanism or a machine of bodies and contacts; type {_COLUMNS_ONLY} for its columns"
        raise InputError("save", [f"the model is a {type(model).__name__}; a file can keep {allowed}"])
    if lists_parts(model):  # the name of its class where that is a user's own
        own = {} if type(model) in MECHANISMS.values() else {"machine": type(model).__name__}
        return {"robot": _toml(model), **own}
    law = model.friction
    if type(law) in LAWS.values():
        return {"robot": _toml(model)}
    numbers = {f.name: as_plain(getattr(law, f.name)) for f in dataclasses.fields(law)}
    stored = json.dumps({"name": type(law).__name__, "dynamic": adapted(law).dynamic, "fields": numbers})
    return {"robot": _toml(model, friction=Coulomb(mu_plus=0.0, mu_minus=0.0)), "law": stored}


def _toml(model: Any, **changes: Any) -> str:
    """The model as TOML, changed where it has to be."""
    try:
        return str((dataclasses.replace(model, **changes) if changes else model).to_toml())
    except InputError as error:
        raise InputError("save", [*error.problems, f"Type {_COLUMNS_ONLY} for the columns alone"]) from None


_COLUMNS_ONLY = 'run.to_xarray().to_netcdf(path, engine="h5netcdf")'


def read(path: str | Path, laws: Sequence[type] = (), machines: Sequence[Any] = ()) -> dict[str, Any]:
    """The arguments of the run in a file that `save` wrote."""
    path = as_path(path, "load")
    give = "give the path of a file that run.save(path) wrote"
    try:
        size = path.stat().st_size if path.is_file() else None
    except (OSError, ValueError):
        size = None
    if size is None:
        raise InputError("load", [f"there is no file {str(path)!r}; {give}"])
    try:
        with hdf5.checked_file(path, "load", allowance := Allowance("load", size)) as file:
            attrs = {k: _one(v) for k, v in hdf5.plain_attributes(file, allowance, size).items()}
            _check_format(attrs, path, "pieces" in file)
            kept = hdf5.plain_attributes(file["pieces"], allowance, size)
            marks = json.loads(attrs.get("named_events", "[]"))
            named = tuple(Event(float(t), KIND, int(before), int(after), str(name)) for t, name, before, after in marks)
            attrs = flow_files.as_now(attrs, kept)
            pieces = _pieces(file, kept)
            model = _model(attrs, laws, machines, pieces)
        settings = {k: attrs[k] for k in ("method", "status", "rtol")} | {k: int(attrs[k]) for k in ("settle", "samples")}
        whole = {k: int(attrs[k]) if k in attrs else None for k in ("periods", "known_period")}
        words = {k: json.loads(attrs[k]) for k in ("start", "provenance", "counts")}
        return {"model": model, "pieces": pieces, **settings, **whole, **words, "named_events": named}
    except InputError:
        raise
    except OSError as error:
        raise InputError("load", [f"{str(path)!r} is not a netCDF4 file ({error}); {give}"]) from None
    except Exception as error:  # a damaged file meets the library, or what we make of it, at any place
        raise InputError("load", [f"{str(path)!r} is damaged ({type(error).__name__}: {str(error)[:120]}); save the run again"]) from None


def _one(value: Any) -> Any:
    return value.item() if hasattr(value, "item") and value.size == 1 else value


def _arrays(file: Any) -> dict[str, Any]:
    """The arrays of the dense output, without the dimensions of netCDF beside them."""
    members = hdf5.members(file["pieces"], "load")
    return {k: np.asarray(hdf5.dataset_values(v)) for k, v in members if v is not None and "CLASS" not in v.attrs}


def _pieces(file: Any, attrs: dict[str, Any]) -> Any:
    """The dense output: its arrays and its layout."""
    arrays, kind = _arrays(file), _one(attrs["kind"])
    count = len(arrays["t"]) - 1
    rows = (array for name, array in arrays.items() if name not in KINDS[kind].apart and array.ndim)
    if count < 1 or not np.all(np.diff(arrays["t"]) >= 0) or any(array.shape[:1] != (count,) for array in rows):
        raise ValueError("its pieces do not follow one another")
    try:
        return pieces_from_arrays(kind, arrays | ({"layout": _one(attrs["layout"])} if "layout" in attrs else {}))
    except InputError as error:
        raise ValueError("; ".join(error.problems)) from None


def _check_format(attrs: Any, path: Path, dense: bool) -> None:
    version, content = int(attrs.get("stickslip_format", 0)), attrs.get("stickslip_content")
    if version == 0:
        why = "was not written by stickslip (it has no attribute stickslip_format); xarray.open_dataset may read it"
    elif version < EARLIEST:
        allowed = f"allowed are {EARLIEST} to {FORMAT}; type run.save(path) of the run itself again"
        why = f"has format {version}, which no release has written; {allowed}"
    elif version > FORMAT:
        why = f"has format {version}, this stickslip reads up to {FORMAT}; type pip install --upgrade stickslip"
    elif content == flow_files.BEFORE and not dense:
        why = "holds the columns of a run of a flow alone, as stickslip wrote them earlier; open it with xarray.open_dataset"
    elif content not in ("trajectory", flow_files.BEFORE):
        why = f"holds a {content}, not a trajectory; open it with xarray.open_dataset"
    else:
        return
    raise InputError("load", [f"{str(path)!r} {why}"])


def _model(attrs: dict[str, Any], laws: Sequence[type], machines: Sequence[Any], pieces: Any) -> Any:
    if "flow" in attrs:
        return flow_files.flow_of(json.loads(attrs["flow"]), machines, pieces, attrs["method"])
    if "machine" in attrs:
        return _own_machine(str(attrs["machine"]), machines).from_toml(attrs["robot"])
    robot = from_text(attrs["robot"])
    if "law" not in attrs:
        return robot
    kept = json.loads(attrs["law"])
    cls: Callable[..., Any] | None = next((law for law in laws if law.__name__ == kept["name"]), None)
    if cls is None:
        unknown = _UnknownDynamic if kept["dynamic"] else _UnknownSetValued
        return dataclasses.replace(robot, friction=unknown(kept["name"], kept["fields"]))
    fields = {k: tuple(v) if isinstance(v, list) else v for k, v in kept["fields"].items()}
    return dataclasses.replace(robot, friction=cls(**fields))


def _own_machine(name: str, machines: Sequence[type]) -> Any:
    """The user's class of this name."""
    own = next((cls for cls in machines if cls.__name__ == name), None)
    if own is None:
        given = ", ".join(cls.__name__ for cls in machines) or "none"
        why = f"it holds a run of the machine {name}, which is not part of stickslip; the classes given are {given}"
        raise InputError("load", [f"{why}; type ss.load(path, machines=[{name}]) with its class"])
    return own


def from_text(text: str) -> Any:
    """The robot or the mechanism whose TOML this is."""
    table = document_of(text, "load").get("mechanism")
    kind = table.get("kind") if isinstance(table, dict) else None
    return (MECHANISMS[str(kind)] if is_one_of(kind, MECHANISMS) else Robot).from_toml(text)


def _unknown_law(self: Any, *arguments: Any, **more: Any) -> Any:
    what = f"this run used the law {self.name}({self.numbers}), which is not part of stickslip"
    hint = f"type ss.load(path, laws=[{self.name}]) with its class; a command takes the function that makes the robot, as file.py:function"
    raise InputError("friction", [f"{what}; {hint}"])


@dataclasses.dataclass(frozen=True)
class _UnknownDynamic:
    """Stands for a user's dynamic law whose class was not given to `load`."""

    name: str
    numbers: dict[str, Any]
    rate = force = _unknown_law


@dataclasses.dataclass(frozen=True)
class _UnknownSetValued:
    """Stands for a user's set-valued law whose class was not given to `load`."""

    name: str
    numbers: dict[str, Any]
    sliding = breakaway = _unknown_law


# ---- columns ----
def save_columns(run: Trajectory, path: Path) -> Path:
    """Write the columns of a run to a file whose ending is one of theirs."""
    return _OF_COLUMNS[path.suffix.lower()](run, path)


def to_mat(run: Any, path: str | Path) -> Path:
    """Write the columns of a run to a MATLAB file (version 5), one variable each, with units and status; returns its path."""
    from scipy.io import savemat

    path, table = as_path(path, "to_mat", "run.mat"), run._table()
    with whole_file(path, unwritable("to_mat")) as file:
        savemat(file, {**table.columns, "units": table.units, "run": table.about, **table.names}, oned_as="column")
    return path


def to_csv(run: Any, path: str | Path) -> Path:
    """Write the columns of a run to a CSV file, units in its first line; returns its path."""
    path, table = as_path(path, "to_csv", "run.csv"), run._table()
    with whole_file(path, unwritable("to_csv")) as file:
        text = io.TextIOWrapper(file, encoding="utf-8", newline="")
        write_csv([heading for heading, _, _ in table.head], table.flat, text)
        text.detach()  # flushed, and not closed
    return path


def to_excel(run: Any, path: str | Path) -> Path:
    """Write the columns of a run to an Excel workbook, units in its first line, with their meanings; returns its path."""
    path, table = as_path(path, "to_excel", "run.xlsx"), run._table()
    rows = zip(*(np.asarray(values).tolist() for values in table.flat), strict=True)
    with whole_file(path, unwritable("to_excel")) as file:
        write_workbook(file, table.head, rows, len(table.flat[0]), table.about, "to_excel")
    return path


#: Endings of a file that `load` reads back, and of those that hold the columns alone.
NETCDF = (".nc", ".nc4", ".h5", ".hdf5", "")
_OF_COLUMNS: dict[str, Callable[[Any, Path], Path]] = {".csv": to_csv, ".xlsx": to_excel, ".mat": to_mat}
_ENDINGS = f"{', '.join((*filter(None, NETCDF), *list(_OF_COLUMNS)[:-1]))} and {list(_OF_COLUMNS)[-1]}"
