"""The columns of a sweep: their storage in memory and in files, and the codes of words."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.errors import InputError
from stickslip.basics.status import Status
from stickslip.basics.variables import VARIABLES
from stickslip.results.datasets import CODES, column_description
from stickslip.results.steadiness import UNKNOWN

if TYPE_CHECKING:
    import xarray as xr


#: Prefix of the names of final states, which accompany the columns of cases from which others start.
END = "end."
#: Motion types in the order of their codes in files.
TYPES = ("unsolved", "rest", "presliding", "I", "II", "III", "IV", "other", "stick-slip", "slip", "steady", "not settled", "periodic")
#: Column -> type in memory. In files, floats are unchanged, words become codes, and patterns characters. Quantities of the parts of a
#: machine are stored in a column for each part, by its index: "velocity_max.0".
COLUMNS: dict[str, str] = {name: variable.kept for name, variable in VARIABLES.items() if variable.dims[:1] != ("time",)}

#: Columns of flows that are no floats, with their types.
_WHOLE = {"end_mode": "i8", "switches": "i8"}


def base_of(name: str) -> str:
    """The base column of a column for one body, contact or stop; otherwise the column itself.

    Examples
    --------
    >>> base_of("velocity_max.0"), base_of("mean_velocity")
    ('velocity_max', 'mean_velocity')
    """
    base, dot, number = name.partition(".")
    return base if dot and number.isdigit() and base in COLUMNS else name


def part_columns(name: str, parts: dict[str, Any]) -> tuple[str, ...]:
    """The columns in which a quantity is stored, given the names of the parts by dimension.

    Examples
    --------
    >>> part_columns("velocity_max", {"body": ("head", "tail")}), part_columns("status", {"body": ("head", "tail")})
    (('velocity_max.0', 'velocity_max.1'), ('status',))
    """
    dim = dim_of(name, parts)
    return (name,) if dim is None else tuple(f"{name}.{i}" for i in range(len(parts[dim])))


def dim_of(name: str, parts: dict[str, Any]) -> str | None:
    """The dimension of parts that a column has; None if it has none."""
    return next((dim for dim in VARIABLES[name].dims if dim in parts), None) if name in VARIABLES else None


def flattened(name: str, values: Array, parts: dict[str, Any]) -> dict[str, Array]:
    """A column of a batch (..., parts) as a flat one for each part; unchanged for a machine of one contact."""
    if dim_of(name, parts) is None:
        return {name: np.ravel(values)}
    table = np.asarray(values).reshape(-1, np.shape(values)[-1])
    return {f"{name}.{i}": table[:, i] for i in range(table.shape[1])}


def unflattened(name: str, columns: dict[str, Array], parts: dict[str, Any]) -> Array:
    """The inverse of `flattened`: (cases,), or (cases, parts)."""
    kept = [columns[each] for each in part_columns(name, parts)]
    return kept[0] if dim_of(name, parts) is None else np.stack(kept, axis=-1)


def all_failed(status: Array) -> bool:
    """Whether there are cases and all of them failed: then the law or the maker is wrong, rather than some numbers."""
    return len(status) > 0 and bool((status == Status.FAILED).all())


def column_of(what: str, grid: xr.Dataset, name: str) -> Any:
    """A column of a dataset with one value for each case; `InputError` naming `what` if it is missing or has a value for each part.

    Examples
    --------
    >>> import xarray as xr
    >>> column_of("plot", xr.Dataset({"mean_velocity": ("case", [0.1])}), "mean_velocity").values.tolist()
    [0.1]
    """
    if is_of_cases(grid, name):
        return grid[name]
    if name not in grid.variables:
        has = ", ".join(str(n) for n in grid.data_vars)
        if name == "mean_velocity":
            why = "the dataset has no mean_velocity, as a flow of which no state is cyclic has no displacement"
            raise InputError(what, [f"{why}; type for example quantity={str(next(iter(grid.data_vars)))!r}; it has {has}"])
        raise InputError(what, [f"the dataset has no {name}; it has {has}; give one that has it"])
    (dim,) = set(grid[name].dims) - set(grid["mean_velocity" if "mean_velocity" in grid else "status"].dims)
    parts = grid[dim].values.tolist() if dim in grid.coords else range(grid.sizes[dim])
    named = ", ".join(map(str, parts))
    raise InputError(what, [f"the dataset has {name} of each {dim} ({named}); choose one: type grid.sel({dim}={parts[0]!r})"])


def is_of_cases(grid: xr.Dataset, name: str) -> bool:
    """Whether a dataset has a column with one value for each case, rather than one for each body or contact."""
    return name in grid.variables and set(grid[name].dims) <= set(grid["mean_velocity"].dims if "mean_velocity" in grid else grid.dims)


def attributes_of_column(name: str) -> dict[str, str]:
    """The attributes of a column that is named after a state or a mode.

    Examples
    --------
    >>> attributes_of_column("amplitude_height")["long_name"]
    'half of the range of height in a cycle'
    """
    what, _, state = name.partition("_")
    long = {
        "amplitude": f"half of the range of {state} in a cycle",
        "fraction": f"part of the time in mode {state}",
        "mean": f"mean of {state}", "min": f"smallest {state}", "max": f"largest {state}", "end": f"{state} at the end",
        "switches": "number of switches", "first": f"first instant of {state}", "number": f"how often {state} happens",
    }  # fmt: skip
    return {"long_name": long.get(what, f"{what} {state}"), "units": "1"}


def column_type(name: str) -> str:
    """Type of a column in memory."""
    return COLUMNS.get(base_of(name), _WHOLE.get(name, "f8"))  # user-defined columns are numbers


def empty(count: int, names: Iterable[str]) -> dict[str, Array]:
    """Columns of cases without results yet."""
    return {name: unknown(name, count) for name in names}


def vacant(count: int, names: Iterable[str]) -> dict[str, Array]:
    """Uninitialised columns; patterns are only as long as necessary."""
    return {name: np.empty(count, "U4" if base_of(name) == "pattern" else column_type(name)) for name in names}


def with_missing_cases(columns: dict[str, Array], count: int, names: Iterable[str]) -> dict[str, Array]:
    """All columns, in order and with their types (patterns may be shorter), of cases for which some columns are known."""
    return {name: _typed(columns[name], column_type(name)) if name in columns else unknown(name, count) for name in names}


def _typed(values: Array, kind: str) -> Array:
    return values if kind == "U32" and values.itemsize <= np.dtype(kind).itemsize else values.astype(kind, copy=False)


def unknown(name: str, count: int, shape: tuple[int, ...] = ()) -> Array:
    """A column of cases without results yet, with `shape` for each case."""
    base, kind = base_of(name), column_type(name)
    nothing = {"motion_type": TYPES[0], "status": Status.NOT_COMPUTED, "steadiness": UNKNOWN, "hits": -1, **dict.fromkeys(_WHOLE, -1)}.get(
        base, np.nan if kind == "f8" else None
    )
    return np.zeros(count, kind) if nothing is None else np.full((count, *shape), nothing, kind)


def concatenated(parts: list[dict[str, Array]]) -> dict[str, Array]:
    """Concatenated columns of cases; if a part lacks a column of another one, its cases have no result there.

    Examples
    --------
    >>> concatenated([{"status": np.array([100])}, {"status": np.array([0]), "margin": np.array([0.5])}])["margin"].tolist()
    [nan, 0.5]
    """
    known = {name: values for part in parts for name, values in part.items()}
    whole = {}
    for name, like in known.items():
        whole[name] = np.concatenate([part[name] if name in part else unknown(name, len(part["status"]), like.shape[1:]) for part in parts])
    return whole


def coded(name: str, values: Array) -> Array:
    """A column as written to a file."""
    name = base_of(name)
    if name == "motion_type":
        distinct, inverse = np.unique(values, return_inverse=True)
        return np.array([TYPES.index(name) for name in distinct.tolist()], np.int8)[inverse].reshape(np.shape(values))
    if name == "pattern":
        return np.ascontiguousarray(values.astype("S32")).view("S1").reshape(*values.shape, 32)
    return values.astype(COLUMNS.get(name, values.dtype))


def unwritten(name: str, count: int = 1) -> Array:
    """A column of cases without results yet, as written to a file."""
    return coded(name, unknown(name, count))


def words(name: str, values: Array) -> Array:
    """A column from a file in its form in memory; the inverse of `coded`.

    Examples
    --------
    >>> types = np.array(["III", "rest", "presliding"])
    >>> coded("motion_type", types).tolist(), words("motion_type", coded("motion_type", types)).tolist()
    ([5, 1, 2], ['III', 'rest', 'presliding'])
    >>> words("pattern", coded("pattern", np.array(["+0-0", "+-"]))).tolist()
    ['+0-0', '+-']
    """
    name = base_of(name)
    if name == "motion_type":
        return np.array(TYPES, COLUMNS[name])[values]
    if name == "pattern":
        flat = np.ascontiguousarray(values).view("S32")[..., 0]
        codes, inverse = np.unique(flat.view(np.void), return_inverse=True) if flat.size else (flat, np.zeros(0, int))
        return codes.view("S32").astype("U32")[inverse].reshape(flat.shape)
    return values


def characters(values: Array) -> tuple[Array, str]:
    """Non-numeric values as UTF-8 characters along a last dimension; and their encoding: text, JSON, or JSON of bools."""
    values = np.char.decode(values) if values.dtype.kind == "S" else values
    kept = {"U": "text", "b": "bool"}.get(values.dtype.kind, "json")
    flat = values.ravel().tolist()
    texts = flat if kept == "text" else [json.dumps(v, default=str, ensure_ascii=False) for v in flat]
    raw = np.array([text.encode() for text in texts], "S")
    return raw.view("S1").reshape(*values.shape, raw.dtype.itemsize), kept


def from_characters(texts: Array, kept: str) -> Array:
    """Values from their texts, an array of bytes or words; the inverse of `characters`.

    Examples
    --------
    >>> raw, kept = characters(np.array([None, True, "µ", 2.5], object))
    >>> from_characters(raw.view(f"S{raw.shape[-1]}")[..., 0], kept).tolist()
    [None, True, 'µ', 2.5]
    """
    decoded = [text.decode() if isinstance(text, bytes) else text for text in texts.ravel().tolist()]
    values = np.empty(len(decoded), object)
    for i, text in enumerate(decoded):  # element by element: a value may be a list
        values[i] = text if kept == "text" else json.loads(text)
    if kept == "bool" or all(isinstance(v, str) for v in values):
        values = values.astype(bool if kept == "bool" else str)
    return values.reshape(texts.shape)


def flags(name: str) -> dict[str, Any]:
    """CF attributes of a column of codes: flag_values and flag_meanings, with one word for each."""
    name = base_of(name)
    if name == "motion_type":
        return {"flag_values": np.arange(len(TYPES), dtype=np.int8), "flag_meanings": " ".join(TYPES).replace("not settled", "not_settled")}
    if name in CODES:
        codes = CODES[name]
        return {
            "flag_values": np.array(list(codes), np.int8),
            "flag_meanings": " ".join(text.replace(":", "").replace(" ", "_") for text in codes.values()),
        }
    return {}


def attributes_in_files(name: str) -> dict[str, Any]:
    """Units and names of a column, with a word for each of its codes."""
    codes = flags(name)
    return {about: value for about, value in column_description(base_of(name)).items() if about not in codes} | codes
