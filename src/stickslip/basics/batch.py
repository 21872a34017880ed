"""Batches, that is models whose numbers are arrays: shape, labels and table of rows."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from stickslip.basics.contracts import Model
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.fields import describe, is_array, leaves, replace_leaf, same


@dataclass(frozen=True)
class Labels:
    """Shape of a batch, with the names and coordinates of its dimensions if it has any."""

    shape: tuple[int, ...]
    dims: tuple[str, ...] | None = None
    coords: dict[str, Any] | None = None

    @property
    def cases(self) -> int:
        """Number of cases; 1 for a single model."""
        return math.prod(self.shape)


def shape_of(model: Any) -> tuple[int, ...]:
    """Shape of the batch; () for a single case."""
    return labels_of(model).shape


def check_shape(model: Model, problems: Problems) -> None:
    """Add the problems with the shapes of a model's arrays, if its fields have none."""
    if not problems.mistakes:
        try:
            shape_of(model)
        except InputError as error:
            problems.include(error)


def labels_of(model: Model) -> Labels:
    """Shape and labels of the batch; `InputError` if the arrays do not fit together."""
    return labels_together(dict(leaves(model)), type(model).__name__)


def labels_together(numbers: dict[str, Any], what: str) -> Labels:
    """Shape and labels of the batch that these numbers form together; `InputError` named after `what` if they do not fit.

    Examples
    --------
    >>> import numpy as np
    >>> labels_together({"mu": 0.2, "tilt": np.zeros((3, 1)), "amplitude": np.zeros(2)}, "robot").shape
    (3, 2)
    """
    arrays = {name: value for name, value in numbers.items() if type(value) is not float and is_array(value)}
    if not arrays:
        return Labels(())
    labelled = {n: a for n, a in arrays.items() if hasattr(a, "dims")}
    if labelled:
        return _labels_by_name(arrays, labelled, what)
    import numpy as np

    try:
        return Labels(np.broadcast_shapes(*(np.shape(a) for a in arrays.values())))
    except ValueError:
        shapes = "; ".join(f"{n} has shape {np.shape(a)}" for n, a in arrays.items())
        raise InputError(
            what,
            [f"the shapes of the arrays do not broadcast: {shapes}; give arrays of one shape, or use xarray.DataArray with names"],
        ) from None


def _labels_by_name(arrays: dict[str, Any], labelled: dict[str, Any], what: str) -> Labels:
    import xarray as xr

    problems = Problems(what)
    for name, array in arrays.items():
        if name not in labelled:
            problems.add(f"{name} is {describe(array)} without names beside labelled arrays; give it as an xarray.DataArray with dims")
    problems.check()
    try:
        whole = xr.broadcast(*xr.align(*labelled.values(), join="exact"))[0]
    except ValueError as error:
        raise InputError(what, [f"the labelled arrays do not fit together: {error}"]) from None
    coords = {str(k): (v.dims, v.values) for k, v in whole.coords.items()}
    return Labels(whole.shape, tuple(str(d) for d in whole.dims), coords)


def rows_of(model: Model, names: tuple[str, ...], cases: slice = slice(None)) -> Any:
    """The named numbers as a table (cases, names), with a row for each selected case in C order of the batch."""
    import numpy as np

    values = dict(leaves(model))
    labels = labels_together(values, type(model).__name__)
    table = np.empty((len(range(labels.cases)[cases]), len(names)))
    for column, name in enumerate(names):
        table[:, column] = _on_batch(values[name], labels).flat[cases]
    return table


def numbers_by_name(model: Model, cases: slice = slice(None)) -> dict[str, Any]:
    """Every number of a model by its name: a flat array over the selected cases if it is an array, else a single float.

    Examples
    --------
    >>> import stickslip as ss
    >>> robots = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=[5e-4, 6e-4])
    >>> found = numbers_by_name(robots)
    >>> found["drive.amplitude"].tolist(), found["inner_mass"]
    ([0.0005, 0.0006], 0.00948)
    """
    values = dict(leaves(model))
    return of_cases(values, labels_together(values, type(model).__name__), cases)


def of_cases(numbers: dict[str, Any], labels: Labels, cases: slice = slice(None)) -> dict[str, Any]:
    """The same of numbers as they stand in a model, with the labels of the batch that they form."""
    if not labels.shape:
        return numbers
    return {name: _on_batch(value, labels).flat[cases] if is_array(value) else value for name, value in numbers.items()}


def some_of(model: Model, at: Any) -> Any:
    """Some cases of a batch, selected by their numbers in C order, as a flat batch; a single case is returned unchanged.

    Examples
    --------
    >>> import stickslip as ss
    >>> some_of(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=[5e-4, 6e-4, 7e-4]), [2, 0, 0]).drive.amplitude.tolist()
    [0.0007, 0.0005, 0.0005]
    """
    import numpy as np

    if not labels_of(model).shape:
        return model
    names = tuple(name for name, _ in leaves(model))
    table = rows_of(model, names)[at]
    return replace_leaf(model, {name: np.ascontiguousarray(table[:, i]) for i, name in enumerate(names)})


def with_row(model: Model, names: tuple[str, ...], row: Any) -> Any:
    """One case: the model with a row of plain floats for its named numbers."""
    return replace_leaf(model, dict(zip(names, map(float, row), strict=True)))


def cases_of(model: Model, cases: slice = slice(None)) -> list[Any]:
    """The selected cases of a batch, each as a model with plain floats; a single case gives a list of one."""
    names = tuple(name for name, _ in leaves(model))
    return [with_row(model, names, row) for row in rows_of(model, names, cases)]


def flat(model: Any) -> Any:
    """A batch flattened to one axis; a single case is returned unchanged."""
    numbers = numbers_by_name(model)
    return replace_leaf(model, numbers) if any(map(is_array, numbers.values())) else model


def spread_over_cases(value: Any, labels: Labels) -> Any:
    """One number of a batch, for every case, flat in the order of the rows; labelled arrays broadcast by name."""
    if type(value) is float and not labels.shape:
        import numpy as np

        return np.array([value])
    return _on_batch(value, labels).ravel()


def _on_batch(value: Any, labels: Labels) -> Any:
    """One number of a batch, broadcast to the batch's shape."""
    import numpy as np

    if hasattr(value, "dims") and labels.dims is not None:
        strange = [str(d) for d in value.dims if d not in labels.dims]
        if strange:
            raise ValueError(f"the batch has no dimension {', '.join(strange)}; it has {', '.join(labels.dims)}")
        present = [d for d in labels.dims if d in value.dims]
        array = np.asarray(value.transpose(*present), float)
        value = array.reshape([value.sizes[d] if d in value.dims else 1 for d in labels.dims])
    return np.broadcast_to(np.asarray(value, float), labels.shape)


def point_by_point(what: str, make: Callable[..., Any], fixed: dict[str, Any], columns: dict[str, Any]) -> Any:
    """The models of a maker that takes single numbers, one for each row of the columns (arrays of equal length), stacked."""
    points = zip(*(values.tolist() for values in columns.values()), strict=True)
    return stacked(what, [made_model(what, make(**fixed, **dict(zip(columns, point, strict=True)))) for point in points])


def made_model(what: str, made: Any) -> Any:
    """The model that a maker returned; `InputError` unless it is a record: a robot, a mechanism, or a law (in fits of force data)."""
    if hasattr(made, "__dataclass_fields__") and not isinstance(made, type):
        return made
    raise InputError(
        what, [f"the maker returns {made!r}; allowed is a Robot, a mechanism or a machine; return ss.presets.piezo_rig(...), for example"]
    )


def stacked(what: str, models: list[Any]) -> Any:
    """Models of one kind as one model whose numbers are arrays; `InputError` if they are of several kinds.

    Examples
    --------
    >>> import stickslip as ss
    >>> drives = [ss.Harmonic(amplitude=a, omega=200.0) for a in (1e-3, 2e-3)]
    >>> stacked("sweep", drives).amplitude.tolist()
    [0.001, 0.002]
    """
    import numpy as np

    numbers = [name for name, _ in leaves(models[0])]
    if (table := _table_of_one_kind(numbers, models)) is not None:
        return replace_leaf(models[0], dict(zip(numbers, np.array(table).T.copy(), strict=True)))
    whole = [dict(leaves(model, kinds=True)) for model in models]
    first, *others = ({n: v for n, v in each.items() if not (n in numbers and v is not None)} for each in whole)
    for other in others:
        _check_kind(what, first, other)
    many = sorted({name for each in whole for name in numbers if is_array(each[name])})
    if many:
        raise InputError(what, [f"{', '.join(many)} of one point are arrays; allowed is one number for each"])
    return replace_leaf(models[0], {name: np.array([float(each[name]) for each in whole]) for name in numbers})


def _table_of_one_kind(numbers: list[str], models: list[Any]) -> list[list[float]] | None:
    """The numbers of models that are alike in everything else, a row for each; None if they may not be, which takes longer to find out."""
    first = leaves(models[0], kinds=True)
    named = set(numbers)
    places = [k for k, (name, _) in enumerate(first) if name in named]
    others = [(k, value) for k, (name, value) in enumerate(first) if name not in named]
    names, table = [name for name, _ in first], []
    for model in models:
        own = leaves(model, kinds=True)
        row = [own[k][1] for k in places] if len(own) == len(first) else []
        if not row or any(type(value) is not float for value in row) or [name for name, _ in own] != names:
            return None
        if any(own[k][1] is not value and not (type(value) in _WORDS and same(own[k][1], value)) for k, value in others):
            return None
        table.append(row)
    return table


_WORDS = (str, bool, int, type(None), tuple)


def _check_kind(what: str, one: dict[str, Any], other: dict[str, Any]) -> None:
    """Refuse two models whose equations differ in more than their numbers; differing notes or functions are ignored."""
    for name in {**one, **other}:
        a, b = one.get(name), other.get(name)
        field, is_class = name.removesuffix("__class__").removesuffix("."), name.endswith("__class__")
        if same(a, b) or field.endswith("notes") or (callable(a) and callable(b) and not is_class):
            continue
        a, b = (a.__name__, b.__name__) if is_class and a and b else (repr(a), repr(b))
        difference = f"{field or 'the model'} is {a} for one and {b} for another"
        raise InputError(what, [f"the maker returns models of several kinds: {difference}; allowed is one kind; give each kind by itself"])
