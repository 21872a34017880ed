"""The results of a sweep as a labelled dataset, from memory or from the tiles of a folder."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from functools import cache, partial
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError
from stickslip.basics.fields import field_description, leaves
from stickslip.basics.fingerprints import fingerprint
from stickslip.basics.jsontext import as_plain
from stickslip.basics.quantities import axis_in
from stickslip.basics.variables import VARIABLES, unit_of
from stickslip.models.angular_coordinates import angles_of, unit_of_part
from stickslip.models.model_adapter import adapter_of, is_model
from stickslip.models.naming import axis_of
from stickslip.models.observables import Derived
from stickslip.models.presets import DIMENSIONLESS
from stickslip.results.datasets import column_description
from stickslip.solvers.named_events import column_of
from stickslip.solvers.request import versions
from stickslip.studies.models_of_points import shared_numbers
from stickslip.studies.planning import Plan
from stickslip.studies.result_columns import COLUMNS, attributes_of_column, base_of, dim_of, unflattened
from stickslip.studies.solving import kept_columns
from stickslip.studies.space import Column

WAYS = np.array(["up", "down"])


def maker_of(make: Model | Callable[..., Any]) -> str:
    """The name of a maker."""
    return getattr(make, "__name__", None) or type(make).__name__


def provenance_of(plan: Plan) -> dict[str, Any]:
    """Versions, settings and kinds, which are needed to repeat the results."""
    known = versions() | {name: _version(name) for name in ("llvmlite", "scipy", "xarray")}
    settings = {name: value for name, value in plan.options.items() if name not in ("observe", "events")}
    settings |= {"continue_along": plan.along} if plan.along else {}
    settings |= (
        {"observe": {name: each.fingerprint for name, each in plan.options["observe"].items()}} if plan.options.get("observe") else {}
    )
    settings |= (
        {"events": {name: fingerprint(each).digest for name, each in plan.options["events"].items()}} if plan.options.get("events") else {}
    )
    kinds = {} if plan.sample is None else {"model": type(plan.sample).__name__}
    kinds |= {} if plan.sample is None or plan.own else {"law": adapter_of(plan.sample).law_names}
    return {"versions": known, "settings": settings, "kinds": kinds, **plan.space.attributes}


@cache
def _version(library: str) -> str:
    """Version of a library that may not be loaded; cached, because the look-up takes longer than a small sweep."""
    from importlib.metadata import version

    return version(library)


def coordinates_of_grid(plan: Plan) -> dict[str, Column]:
    """Coordinates of the dataset: labels of its dimensions, varying arguments, and single numbers."""
    labels = dict(plan.space.coords)
    if plan.along:
        labels["way"] = Column(("way",), WAYS)
    for name, value in plan.space.fixed.items():
        if isinstance(value, (int, float, np.number)) and not isinstance(value, bool) and name not in (*labels, *COLUMNS):
            labels[name] = Column((), np.asarray(float(value)))
    if is_model(plan.make) and not adapter_of(plan.make).has_units:  # no study file has its numbers
        labels |= {n: Column((), np.asarray(float(v))) for n, v in leaves(plan.make) if n not in labels and np.ndim(v) == 0}
    return labels


def attributes_of(plan: Plan) -> dict[str, Any]:
    """Attributes of the dataset: the maker, the fixed arguments, and properties of its robots.

    `numbers` are those that all robots share; `robot` is the study file of a given robot, if the maker is not a function.
    """
    fixed = {k: v if isinstance(v, (int, float, str, bool)) else str(v) for k, v in plan.space.fixed.items()}
    words = {name: str(value) for name, value in fixed.items() if isinstance(value, (str, bool))}
    described = {
        "maker": maker_of(plan.make),
        "fixed": json.dumps(as_plain(fixed)),
        "numbers": json.dumps(numbers := shared_numbers(plan.make, plan.space)),
        "described": json.dumps(_described(plan, numbers), ensure_ascii=False),
    }
    return {**words, **described, **_units_of(plan), **_robot_of(plan.make)}


def _units_of(plan: Plan) -> dict[str, str]:
    """The units of columns for machines of which something turns, of each part in its order if they differ; empty for others."""
    model, parts = plan.sample, plan.parts
    own = partial(_unit_of, model=model, parts=parts) if angles_of(model) else partial(unit_of, model=model)
    units = {name: unit for name in COLUMNS if (unit := own(name)) != VARIABLES[name].unit}
    return {"units": json.dumps(units)} if units else {}


def _unit_of(name: str, model: Any, parts: Mapping[str, Iterable[str]]) -> str:
    own = next((parts[dim] for dim in VARIABLES[name].dims if dim in parts), ("",))
    units = [unit_of_part(name, model, part) for part in own] or [unit_of(name, model)]
    return units[0] if len(set(units)) == 1 else ", ".join(units)


def _described(plan: Plan, numbers: Iterable[str]) -> dict[str, tuple[str, str]]:
    """Names and units of axes and shared numbers, as far as fields and makers give them."""
    if plan.sample is not None and not adapter_of(plan.sample).has_units:
        return {}
    axes = {name: axis_of(name, plan.make) for name in coordinates_of_grid(plan)}
    if plan.sample is not None:
        axes |= {name: axis_in(field_description(plan.sample, name)) for name in numbers}
    return {name: axis for name, axis in axes.items() if axis}


def _robot_of(make: Any) -> dict[str, str]:
    """A robot or mechanism as the text of a study file; empty for a function, or if a part is a user-defined class."""
    try:
        return {} if callable(make) else {"robot": make.to_toml()}
    except (AttributeError, InputError):
        return {}


def dataset(plan: Plan, columns: dict[str, Array], more: dict[str, Any], notes: dict[str, int]) -> Any:
    """The columns, flat in the order of the results, as an `xarray.Dataset`."""
    kept = {}
    for name in kept_columns(plan):
        values, dim = unflattened(name, columns, plan.parts), dim_of(name, plan.parts)
        kept[name] = ((*plan.dims, *([dim] if dim else [])), values.reshape((*plan.shape, *values.shape[1:])))
    attributes = {**attributes_of(plan), **{k: json.dumps(as_plain(v)) for k, v in more.items()}}
    if notes:
        attributes["notes"] = json.dumps(notes, ensure_ascii=False)
    grid = assembled(kept, coordinates_of_grid(plan) | labels_of_parts(plan.parts), attributes)
    return with_units(grid, user_columns(plan))


def user_columns(plan: Plan) -> dict[str, dict[str, str]]:
    """Units and meanings of user-defined columns."""
    observe = plan.options.get("observe") or {}
    units = {name: _slope_unit(plan, each) if each.unit is None else each.unit for name, each in observe.items()}
    known = {name: {"units": units[name], "long_name": each.meaning} for name, each in observe.items()}
    for name in plan.options.get("events") or {}:
        known[column_of("first", name)] = {"units": "s", "long_name": f"first instant of {name}"}
        known[column_of("number", name)] = {"units": "1", "long_name": f"how often {name} happens"}
    return {name: attributes_of_column(name) for name in plan.own if name not in COLUMNS} | known


def _slope_unit(plan: Plan, slope: Derived) -> str:
    """The unit of a derivative: that of the result over that of the number."""
    if maker_of(plan.make) in DIMENSIONLESS:
        return "1"
    model = plan.make if plan.sample is None else plan.sample
    name = getattr(slope.of, "unit", None) or _unit_of_result(str(slope.of), model)
    by = (axis_of(slope.by, model) or ("", "1"))[1]
    return name if by == "1" else f"{name}/({by})" if "/" in by or " " in by else f"{name}/{by}"


def _unit_of_result(of: str, model: Model) -> str:
    """The unit of a column, or of a state on the strobe."""
    first, _, rest = of.partition(".")
    name = rest.partition(".")[0] if first == "state" else first
    return (unit_of(name, model) if name in VARIABLES else "") or "1"


def with_units(grid: Any, observed: dict[str, dict[str, str]]) -> Any:
    """The dataset with the attributes of user-defined columns."""
    for name, attributes in observed.items():
        grid[name].attrs.update(attributes)
    return grid


def labels_of_parts(parts: dict[str, Any]) -> dict[str, Column]:
    """The names of bodies, contacts and stops as coordinates."""
    return {dim: Column((dim,), np.array(names)) for dim, names in parts.items()}


def assembled(columns: dict[str, tuple[tuple[str, ...], Any]], labels: dict[str, Column], attributes: dict[str, Any]) -> Any:
    """A dataset of columns, given by their dimensions and values, with units and names on all variables."""
    import xarray as xr

    unitless = {"units": "1"} if attributes.get("maker") in DIMENSIONLESS else {}
    units = json.loads(attributes.get("units", "{}"))
    own = {name: {"units": units[base_of(name)]} if base_of(name) in units else {} for name in columns}
    data = {name: (dims, values, column_description(base_of(name)) | own[name] | unitless) for name, (dims, values) in columns.items()}
    known = json.loads(attributes.get("described", "{}"))
    coords = {name: (column.dims, _label(column.values), _attributes(name, known)) for name, column in labels.items()}
    return xr.Dataset(data, coords=coords, attrs=attributes)


def _label(values: Array) -> Array:
    """Words as fixed-length text, which files can hold."""
    if values.dtype.kind == "O" and all(isinstance(v, str) for v in values.ravel().tolist()):
        return values.astype(str)
    return values


def _attributes(name: str, known: dict[str, tuple[str, str]]) -> dict[str, str]:
    axis = known.get(name) or axis_of(name)
    return {"long_name": axis[0], "units": axis[1]} if axis else {}
