"""The space of a sweep: its dimensions, and the value of every argument at each of its points."""

from __future__ import annotations

import reprlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stickslip.basics.arguments import parameters_of
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError, Problems, did_you_mean, other_options, other_words
from stickslip.basics.fields import leaves, masked_in
from stickslip.basics.number_names import numbers_meant
from stickslip.models.model_adapter import adapter_of, is_model
from stickslip.models.naming import in_its_unit
from stickslip.studies.designs import SweepDesign

#: Initial values that may also be axes, of what a maker makes.
START = ("start.x", "start.v", "start.z")


def is_start(name: str) -> bool:
    """Whether an axis is an initial value, of a machine or of a state of a flow."""
    return name.startswith("start.")


@dataclass(frozen=True, eq=False)
class Column:
    """An argument with many values, over some dimensions of the space."""

    dims: tuple[str, ...]
    values: Array


@dataclass(frozen=True, eq=False)
class Space:
    """Every point of a sweep, numbered in C order of its dimensions.

    Parameters
    ----------
    sizes : dict
        Length of each dimension.
    columns : dict of Column
        Arguments that vary.
    fixed : dict
        Arguments that do not vary.
    coords : dict of Column
        Labels of the dimensions, and the varying arguments themselves.
    attributes : dict
        Settings of a random design.
    """

    sizes: dict[str, int]
    columns: dict[str, Column]
    fixed: dict[str, Any]
    coords: dict[str, Column]
    attributes: dict[str, Any] = field(default_factory=dict)

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of the dimensions."""
        return tuple(self.sizes)

    @property
    def shape(self) -> tuple[int, ...]:
        """Lengths of the dimensions."""
        return tuple(self.sizes.values())

    @property
    def cases(self) -> int:
        """Number of points."""
        return int(np.prod(self.shape, dtype=np.int64))

    def at(self, points: Array) -> dict[str, Array]:
        """The varying arguments at some points, given by their indices: an array for each."""
        index = dict(zip(self.sizes, np.unravel_index(points, self.shape), strict=True)) if self.sizes else {}
        return {name: column.values[tuple(index[d] for d in column.dims)] for name, column in self.columns.items()}


def space_of(make: Model | Callable[..., Any], designs: Sequence[Any], axes: dict[str, Any], options: Sequence[str] = ()) -> Space:
    """The space of these designs and axes; all errors are reported together.

    `options` are the names of other arguments, for the suggestion if a name is unknown.
    """
    problems = Problems("sweep")
    _check_designs(designs, axes, problems)
    given = [*axes, *(name for design in designs for name in design.columns)]
    check_names(make, given, options, problems)
    space = Space({}, {}, {}, {})
    for design in designs:
        _add_design(space, design)
    for name, value in axes.items():
        _add_axis(space, name, in_its_unit(name, value, make, problems), problems)
    problems.check()
    _count(space, make)
    return space


def _count(space: Space, make: Model | Callable[..., Any]) -> None:
    """Convert arguments declared as ``int`` to integers: as counts, like words, each value gives machines of another kind."""
    counts = {p.name for p in parameters_of(make) if p.annotation in (int, "int")} if callable(make) else set()
    for name in counts & set(space.columns):
        column = space.columns[name]
        if column.values.dtype.kind == "f" and np.all(column.values == np.round(column.values)):
            counted = Column(column.dims, column.values.astype(int))
            space.columns[name] = counted
            if name in space.coords:
                space.coords[name] = counted


def _check_designs(designs: Sequence[Any], axes: dict[str, Any], problems: Problems) -> None:
    taken: set[str] = set(axes)
    for design in designs:
        if not isinstance(design, SweepDesign):
            raise InputError("sweep", [_no_design(design)])
        for name in [n for n in design.columns if n in taken]:
            problems.add(f"{name} is given twice")
        taken |= set(design.columns)


def _no_design(given: Any) -> str:
    if isinstance(given, Mapping) and given:
        return f"axes are keyword arguments; type ** before the dictionary: sweep(..., **{{{next(iter(given))!r}: ...}})"
    return f"{reprlib.repr(given)} is not a design; type axes by name, such as amplitude=[4e-4, 5e-4], or ss.designs.zipped(...)"


def _add_design(space: Space, design: SweepDesign) -> None:
    dim, n = design.dim, len(design)
    space.sizes[dim] = n
    labels = np.arange(n) if design.labels is None else np.asarray(design.labels)
    if dim not in design.columns:
        space.coords[dim] = Column((dim,), labels)
    for name, values in design.columns.items():
        space.columns[name] = space.coords[name] = Column((dim,), _as_array(values))
    space.attributes.update(design.attributes)


def _add_axis(space: Space, name: str, value: Any, problems: Problems) -> None:
    if hasattr(value, "dims") and value.ndim:
        _add_labelled(space, name, value, problems)
    elif isinstance(value, (Sequence, np.ndarray, range)) and not isinstance(value, (str, bytes)) and getattr(value, "ndim", 1) >= 1:
        array = _flat(value)
        if masked_in(value):
            problems.add(f"{name} has {masked_in(value)} masked values; leave them out, type {name}=array.compressed()")
        elif array is None or array.size == 0:
            problems.add(f"{name} has {_shape(value)}; allowed is a single value, a list of one or more, or a labelled xarray.DataArray")
        else:
            space.sizes[name] = len(array)
            space.columns[name] = space.coords[name] = Column((name,), array)
    else:
        space.fixed[name] = value


def _shape(value: Any) -> str:
    try:
        return f"shape {np.shape(value)}"
    except ValueError:
        return "lists of several lengths in a list"


def _add_labelled(space: Space, name: str, value: Any, problems: Problems) -> None:
    """Add an `xarray.DataArray`, which has its own dimensions and may share them."""
    for dim, size in value.sizes.items():
        if space.sizes.setdefault(str(dim), int(size)) != size:
            problems.add(f"{name} has {size} values along {dim}, where another argument has {space.sizes[str(dim)]}; give as many")
    for label, coord in value.coords.items():
        column = Column(tuple(map(str, coord.dims)), np.asarray(coord.values))
        known = space.coords.setdefault(str(label), column)
        if coord.dims and not np.array_equal(known.values, column.values):
            problems.add(f"{name} has other labels along {label} than another argument; give the same, or rename the dimension")
    column = Column(tuple(map(str, value.dims)), _as_array(value.values))
    space.columns[name] = column
    if name not in space.sizes:
        space.coords[name] = column


def _flat(value: Any) -> Array | None:
    """A list as a flat array: floats, or objects for words; None if it is not flat."""
    try:
        array = np.asarray(value)
    except ValueError:
        return None
    return _as_array(array, value) if array.ndim == 1 else None


def _as_array(array: Array, given: Any = None) -> Array:
    array = np.asarray(array)
    if array.dtype.kind in "iuf":
        return array.astype(float)
    if given is None or array.dtype.kind == "U":
        return array
    words = np.empty(len(array), object)
    words[:] = [v.item() if isinstance(v, np.generic) else v for v in given]
    return words


def starts_known(make: Any) -> tuple[str, ...]:
    """Names of the initial values that may be axes."""
    return tuple(f"start.{name}" for name in adapter_of(make).start_names) if is_model(make) else START


def names_columns(make: Any) -> bool:
    """Whether a maker is a model whose columns are named after its own states."""
    return is_model(make) and bool(adapter_of(make).column_names({}))


def check_names(make: Any, given: Sequence[str], options: Sequence[str], problems: Problems) -> None:
    """Note names that a maker does not take, and required ones that are missing."""
    known = _known(make, given, problems)
    if known is None:
        return
    for name in given:
        starts = starts_known(make)
        if name not in known and name not in starts and (callable(make) or not numbers_meant(name, known)):
            hint = other_words(name, None, known) or other_options(name, options) or did_you_mean(name, [*known, *options, *starts])
            problems.add(f"{name!r} is not known; {hint}")


def _known(make: Any, given: Sequence[str], problems: Problems) -> list[str] | None:
    """Names that a maker takes; None if it takes any."""
    if not callable(make):
        if not hasattr(make, "replace"):
            problems.add(f"make = {make!r}; allowed is a Robot or a function that makes one; type for example ss.presets.piezo_rig")
            return None
        return [name for name, _ in leaves(make)] + [part for part in ("drive", "friction", "track") if not names_columns(make)]
    parameters = parameters_of(make)
    for p in parameters:
        if p.default is p.empty and p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY) and p.name not in given:
            problems.add(f"{p.name} is missing; {getattr(make, '__name__', 'the maker')} has no default for it")
    return None if any(p.kind is p.VAR_KEYWORD for p in parameters) else [p.name for p in parameters]
