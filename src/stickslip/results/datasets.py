"""Runs and batches as labelled datasets, with the units and names of `stickslip.variables`."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TextIO

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.fields import field_description, is_array, leaves
from stickslip.basics.jsontext import as_plain
from stickslip.basics.quantities import axis_in
from stickslip.basics.status import STATUS
from stickslip.basics.variables import VARIABLES, unit_of
from stickslip.models.angular_coordinates import unit_of_part
from stickslip.models.machine_adapter import machine_of
from stickslip.results.steadiness import STEADINESS

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory


COLUMNS = tuple(name for name, variable in VARIABLES.items() if variable.dims[:1] == ("time",))


def trajectory_columns(run: Trajectory) -> dict[str, Any]:
    """Every column of a run by name; columns that it does not have are left out, such as z under a set-valued law."""
    return dict(run._columns.table)


def names_of_parts(run: Any) -> dict[str, list[str]]:
    """The names of the bodies and contacts of a run by dimension; empty if its columns are those of one body and contact.

    Examples
    --------
    >>> import stickslip as ss
    >>> names_of_parts(ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), periods=2))
    {}
    """
    return dict(run._columns.dims)


def dims_of(dims: tuple[str, ...], column: Array, names: dict[str, list[str]]) -> tuple[str, ...]:
    """Which of its dimensions a column has, given the names of the bodies and contacts."""
    return tuple(dim for dim in dims if dim in names or dim not in ("body", "contact"))[: column.ndim]


def flat_columns(run: Any) -> dict[str, tuple[Any, str]]:
    """Every column of a run as columns of numbers (time,) with their units, by name.

    With several bodies and contacts a column's name contains that of the part, as in "x.head". Inner states are numbered; those that a
    law does not have are left out.
    """
    return dict(run._columns.flat)


def columns_with_units(columns: dict[str, Any], names: dict[str, list[str]], model: Any) -> dict[str, tuple[Any, str]]:
    """Columns by name as columns of numbers with their units; the `model` says whether coordinates are lengths or angles."""
    return {
        n: (one, unit_of_part(name, model, n.removeprefix(f"{name}.")))
        for name, column in columns.items()
        for n, one in _parts(name, column, names)
    }


@dataclass(frozen=True)
class FileColumns:
    """The columns of a run, as files hold them.

    Parameters
    ----------
    columns : dict
        Arrays by name, (time, ...).
    units : dict
        Units of these, "1" for none.
    names : dict
        Names of bodies and contacts by dimension.
    head : list of (str, str, str)
        Heading, unit and meaning of each one-dimensional part.
    flat : list of array (time,)
        These parts: numbers, or words.
    about : dict
        Status, method, model and provenance.
    """

    columns: dict[str, Any]
    units: dict[str, str]
    names: dict[str, list[str]]
    head: list[tuple[str, str, str]]
    flat: list[Any]
    about: dict[str, Any]


def columns_for_file(run: Any) -> FileColumns:
    """The columns of a run for a file."""
    columns = run._columns
    units = {name: columns.unit(name) or "1" for name in columns.table}
    return FileColumns(columns.table, units, columns.dims, columns.head, [values for values, _ in columns.flat.values()], attributes(run))


def unit_of_parts(name: str, model: Any, names: dict[str, list[str]]) -> str:
    """The unit of a column of bodies or contacts; where its parts have different ones, that of each in their order."""
    dims = VARIABLES[name].dims
    parts = next((names[dim] for dim in ("body", "contact") if dim in dims and dim in names), [""])
    units = [unit_of_part(name, model, part) for part in parts] if len(dims) > 1 else [unit_of(name, model)]
    return units[0] if len(set(units)) == 1 else ", ".join(units)


def headed(columns: dict[str, tuple[Any, str]]) -> list[str]:
    """The names of columns with their units: "v [m/s]"."""
    return [f"{name} [{unit}]" for name, (_, unit) in columns.items()]


def explained_columns(columns: dict[str, tuple[Any, str]]) -> list[tuple[str, str, str]]:
    """Heading, unit and meaning of columns.

    Examples
    --------
    >>> explained_columns({"v.head": ([0.0], "m/s"), "z0": ([0.0], "m")})[0]
    ('v.head [m/s]', 'm/s', 'velocity of the body: head')
    """
    units = [unit for _, unit in columns.values()]
    return list(zip(headed(columns), units, map(_meaning, columns), strict=True))


def _meaning(name: str) -> str:
    """The meaning of a column, which may belong to a part or to a numbered inner state."""
    base, _, part = name.partition(".")
    variable = VARIABLES.get(base) or VARIABLES.get(base.rstrip("0123456789"))
    return "" if variable is None else f"{variable.long_name}: {part}" if part else variable.long_name


def write_csv(head: Sequence[str], columns: Sequence[Any], file: TextIO) -> None:
    """Write columns (time,) as CSV to an open file: their headings first, then the numbers to full precision, or words."""
    rows = csv.writer(file, lineterminator="\n")
    rows.writerow(head)
    if all(np.asarray(values).dtype.kind in "biuf" for values in columns):
        np.savetxt(file, np.column_stack(columns), delimiter=",", fmt="%.17g")
    else:
        rows.writerows(zip(*(np.asarray(values).tolist() for values in columns), strict=True))


def _parts(name: str, column: Array, names: dict[str, list[str]]) -> Iterator[tuple[str, Any]]:
    """One-dimensional parts of a column, with their names."""
    dims = dims_of(VARIABLES[name].dims, column, names)[1:]
    for index in np.ndindex(column.shape[1:]):
        values = column[(slice(None), *index)]
        if "contact" in dims and "inner_state" in dims and np.isnan(values).all():
            continue
        yield name + "".join(f".{names[dim][i]}" if dim in names else f"_{i}" for dim, i in zip(dims, index, strict=True)), values


def attributes(run: Trajectory) -> dict[str, Any]:
    """Metadata of a run besides its columns."""
    attrs = {name: getattr(run, name) for name in ("status", "method", "rtol", "periods", "settle", "samples")}
    for name in ("start", "provenance", "counts"):
        attrs[name] = json.dumps(as_plain(getattr(run, name)))
    if run.named_events:
        attrs["named_events"] = json.dumps([[e.t, e.part, e.before, e.after] for e in run.named_events])
    attrs = {name: value for name, value in attrs.items() if value is not None}
    return attrs | {name: value for name, value in run._columns.about().items() if name not in attrs}


#: Meanings of the codes in columns.
CODES = {"status": STATUS, "steadiness": STEADINESS}


def column_description(name: str, model: Any = None) -> dict[str, str]:
    """Units, long name and symbol of a column, and the meanings of its codes; empty for an unknown column."""
    if name not in VARIABLES:
        return {}
    attributes = {"units": unit_of(name, model) or "1", "long_name": VARIABLES[name].long_name, "symbol": VARIABLES[name].symbol}
    codes = {"flag_meanings": "; ".join(f"{code}: {meaning}" for code, meaning in CODES[name].items())} if name in CODES else {}
    return attributes | codes


def trajectory_dataset(run: Any) -> Any:
    """The columns of a run as an `xarray.Dataset` over ``time``; for a machine of several bodies also over ``body`` and ``contact``.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.results.dense_output import HarmonicArcs
    >>> from stickslip.results.trajectory import Trajectory
    >>> robot = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=1e-4, law="coulomb")
    >>> arcs = HarmonicArcs(np.array([0.0, robot.period]), np.array([0]), np.zeros(1), np.zeros(1), 0.555, robot.drive.omega, 1.77, 1.77)
    >>> data = Trajectory(robot, arcs, periods=1, settle=0, rtol=1e-6, method="by hand").to_xarray()
    >>> data.v.attrs["units"], data.sizes["time"]
    ('m/s', 401)
    """
    import xarray as xr

    columns, names = run._columns, names_of_parts(run)
    time, *others = columns.table.items()
    data = {name: (dims_of(columns.dims_of(name), column, names), column, columns.description(name)) for name, column in others}
    coords = {"time": ("time", time[1], columns.description(time[0])), **{dim: (dim, of) for dim, of in names.items()}}
    return xr.Dataset(data, coords=coords, attrs=attributes(run))


def summary_dataset(many: Any) -> Any:
    """The columns of a batch as an `xarray.Dataset`, with the numbers that vary as coordinates."""
    import xarray as xr

    labels = many.labels
    dims = labels.dims or tuple("case" if len(labels.shape) == 1 else f"case_{i}" for i in range(len(labels.shape)))
    coords = {k: v if isinstance(v, tuple) else ((k,), v) for k, v in (labels.coords or {}).items()}
    if labels.dims is None and many.model is not None:
        coords |= {name: (*_placed(value, dims), _axis(many.model, name)) for name, value in leaves(many.model) if is_array(value)}
    parts = {} if many.model is None else machine_of(many.model).part_names
    coords |= {dim: ((dim,), list(names)) for dim, names in parts.items()}
    data = {
        name: (_dims_of_case(name, dims, parts), np.asarray(column), column_description(name, many.model))
        for name, column in many.columns.items()
    }  # fmt: skip
    return xr.Dataset(data, coords=coords, attrs={"provenance": json.dumps(as_plain(many.provenance))})


def columns_of_batch(many: Any) -> FileColumns:
    """The columns of a batch for a file, with the numbers that vary."""
    data = many.to_xarray()
    frame = data.to_dataframe().reset_index()
    frame = frame[[name for name in frame if name not in data.data_vars] + list(data.data_vars)]
    units = {name: str(data[name].attrs.get("units", "1")) if name in data else "1" for name in frame}
    meanings = {name: str(data[name].attrs.get("long_name", "")) if name in data else "" for name in frame}
    shown = {name: "" if unit == "1" else unit for name, unit in units.items()}
    head = [(f"{name} [{unit}]" if unit else name, unit, meanings[name]) for name, unit in shown.items()]
    columns = {name: _plain(frame[name].to_numpy()) for name in frame}
    return FileColumns(columns, units, {}, head, list(columns.values()), dict(data.attrs))


def _plain(values: Array) -> Any:
    """A column of a frame as numbers or words, not as objects."""
    return values.astype(str) if values.dtype == object else values


def _axis(model: Any, name: str) -> dict[str, str]:
    """Units and long name of a number of a model."""
    described = axis_in(field_description(model, name))
    return {} if described is None else {"units": described[1], "long_name": described[0]}


def _dims_of_case(name: str, dims: tuple[str, ...], parts: dict[str, Any]) -> tuple[str, ...]:
    """The dimensions of a column of a batch."""
    return (*dims, *(dim for dim in VARIABLES[name].dims if dim in parts)) if name in VARIABLES else dims


def _placed(value: Any, dims: tuple[str, ...]) -> tuple[tuple[str, ...], Any]:
    """An array of the model with its dimensions in the batch (lengths of 1 are dropped)."""
    array = np.asarray(value)
    own = dims[len(dims) - array.ndim :]
    return tuple(d for d, n in zip(own, array.shape, strict=True) if n > 1), array.squeeze()
