"""Robots for points of the space: made in one call if the maker takes arrays, without the points that give no robot."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from stickslip.basics.batch import made_model, numbers_by_name, point_by_point
from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError
from stickslip.basics.fields import is_array, leaves, replace_leaf
from stickslip.studies.space import Space, is_start


class Group:
    """Cases of one kind, made in one call: the indices of their points, the robots, and their initial values."""

    def __init__(self, at: Array, robot: Model, start: dict[str, Any]):
        self.at, self.robot, self.start = at, robot, start


#: The groups of some points, and the reason for each place without a robot.
Made = tuple[list[Group], dict[int, str]]


def groups_of_points(make: Model | Callable[..., Any], space: Space, points: Array, start: dict[str, Any] | None) -> Made:
    """The robots for some points, one group for each kind; and the reason for each place without a robot.

    A place is an index into `points`. A non-finite number, or a combination that the maker refuses, affects its own case only.
    """
    columns = space.at(points)
    finite = np.logical_and.reduce([np.ones(len(points), bool), *(np.isfinite(v) for v in columns.values() if v.dtype.kind == "f")])
    refused = {int(i): "not a finite number" for i in np.flatnonzero(~finite)}
    groups: list[Group] = []
    for at, words in _by_words(columns, np.flatnonzero(finite)):
        numbers = {n: v for n, v in columns.items() if n not in words}
        for part, robot in _made(make, {**space.fixed, **words}, numbers, at, refused):
            groups.append(Group(part, robot, starts_at(start or {}, part) | _own_start(columns, space.fixed, part)))
    return groups, refused


def _by_words(columns: dict[str, Array], places: Array) -> Iterator[tuple[Array, dict[str, Any]]]:
    """The places that share all their words, with these words."""
    words = {name: values for name, values in columns.items() if values.dtype.kind != "f"}
    if not words:
        yield places, {}
        return
    by_choice: dict[tuple[Any, ...], list[int]] = {}
    for i, choice in zip(places.tolist(), zip(*(v[places].tolist() for v in words.values()), strict=True), strict=True):
        by_choice.setdefault(choice, []).append(i)
    for choice, at in by_choice.items():
        yield np.array(at), dict(zip(words, choice, strict=True))


def _made(
    make: Model | Callable[..., Any], fixed: dict[str, Any], numbers: dict[str, Array], at: Array, refused: dict[int, str]
) -> Iterator[tuple[Array, Any]]:
    """Robots for these places. If the maker refuses them together, they are split in halves until the invalid ones are isolated."""
    if not len(at):
        return
    fixed = {n: v for n, v in fixed.items() if not is_start(n)}
    try:
        yield at, batch_of("sweep", make, fixed, {n: v[at] for n, v in numbers.items() if not is_start(n)})
        return
    except InputError as error:
        if len(at) == 1 or not numbers:
            refused.update(dict.fromkeys(at.tolist(), error.problems[0]))
            return
    for half in np.array_split(at, 2):
        yield from _made(make, fixed, numbers, half, refused)


def batch_of(what: str, make: Any, fixed: dict[str, Any], numbers: dict[str, Array]) -> Any:
    """The robots as one batch; a maker that cannot take arrays is called point by point."""
    if not callable(make):
        return make.replace({**fixed, **numbers})
    try:
        return made_model(what, make(**fixed, **numbers))
    except InputError:
        raise
    except (TypeError, ValueError):
        if not numbers:
            raise
        return point_by_point(what, make, fixed, numbers)


def split_by_tile(made: Made, counts: list[int]) -> list[Made]:
    """What was made for several tiles together, with so many points each, as what would have been made for each of them."""
    ends = np.cumsum([0, *counts])
    parts: list[Made] = [([], {}) for _ in counts]
    for point, why in made[1].items():
        k = int(np.searchsorted(ends, point, side="right")) - 1
        parts[k][1][point - int(ends[k])] = why
    for group in made[0]:
        order = np.argsort(group.at, kind="stable")
        cuts = np.searchsorted(group.at[order], ends)
        numbers = {name: value for name, value in numbers_by_name(group.robot).items() if is_array(value)}
        for k in np.flatnonzero(np.diff(cuts)).tolist():
            within = order[cuts[k] : cuts[k + 1]]
            robot = replace_leaf(group.robot, {name: value[within] for name, value in numbers.items()})
            parts[k][0].append(Group(group.at[within] - ends[k], robot, starts_at(group.start, within)))
    return parts


def starts_at(start: dict[str, Any], places: Array) -> dict[str, Any]:
    """Initial values at some places; for each name one value for all, or an array."""
    return {name: value if np.ndim(value) == 0 else value[places] for name, value in start.items()}


def start_of_points(space: Space, start: dict[str, Any], points: Array) -> dict[str, Any]:
    """Initial values at some points: those given for all points, and those that are axes."""
    return starts_at(start, points) | _own_start(space.at(points), space.fixed, np.arange(len(points)))


def _own_start(columns: dict[str, Array], fixed: dict[str, Any], places: Array) -> dict[str, Any]:
    """Initial values that are axes."""
    varying = {n.partition(".")[2]: values[places] for n, values in columns.items() if is_start(n)}
    return varying | {n.partition(".")[2]: value for n, value in fixed.items() if is_start(n)}


def shared_numbers(make: Model | Callable[..., Any], space: Space) -> dict[str, float]:
    """The numbers that the robots of all cases share, by their dotted names: those that are constant along every axis.

    They are compared at the first case and at the middle and the end of each axis through it.
    """
    points = {0}
    for i, size in enumerate(space.shape):
        stride = int(np.prod(space.shape[i + 1 :], dtype=np.int64))
        points |= {stride * (size // 2), stride * (size - 1)}
    groups, _ = groups_of_points(make, space, np.array(sorted(points)), None)
    tables = [dict(leaves(group.robot)) for group in groups]
    first = {name: np.ravel(value)[:1] for table in tables[:1] for name, value in table.items()}
    return {n: float(v[0]) for n, v in first.items() if all(n in table and np.all(np.asarray(table[n]) == v) for table in tables)}


def refusals(make: Model | Callable[..., Any], space: Space) -> list[str]:
    """Errors for axis values that the maker refuses whatever the others are: input errors, reported before the work."""
    errors: list[str] = []
    for name, column in space.columns.items():
        if column.dims != (name,) or not callable(getattr(make, "replace", make)) or is_start(name):
            continue
        values = column.values[np.isfinite(column.values)] if column.values.dtype.kind == "f" else column.values
        sentences = [_said(make, space, name, values, end) for end in (0, -1)]
        if all(sentences):
            errors += sentences[0]
    return list(dict.fromkeys(errors))


def _said(make: Model | Callable[..., Any], space: Space, name: str, values: Array, end: int) -> list[str]:
    """The errors of an axis with all others at their first or last finite value."""
    others = {n: _end(c.values, end) for n, c in space.columns.items() if n != name and not is_start(n)}
    fixed = {**{n: v for n, v in space.fixed.items() if not is_start(n)}, **others}
    try:
        if values.dtype.kind != "f":
            for word in values.tolist():
                batch_of("sweep", make, {**fixed, name: word}, {})
        elif len(values):
            batch_of("sweep", make, fixed, {name: values})
    except InputError as error:
        return list(error.problems)
    except (TypeError, ValueError):
        return []
    return []


def _end(values: Array, end: int) -> Any:
    flat = values.ravel()
    if not flat.size:
        return None
    if flat.dtype.kind == "f":
        finite = flat[np.isfinite(flat)]
        flat = finite if len(finite) else flat
    return flat[end].item() if isinstance(flat[end], np.generic) else flat[end]
