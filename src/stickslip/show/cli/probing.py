"""Check a robot's numbers and the solver's arguments before any work, so that all errors are reported together."""

from __future__ import annotations

from collections.abc import Callable
from itertools import islice, product
from typing import Any

from stickslip.basics.errors import InputError
from stickslip.models.naming import axis_of, example_for

_MOST = 64  # largest number of combinations of words that are tried


def probe(
    build: Callable[[dict[str, Any]], Any], arguments: dict[str, Any], absent: list[str], options: dict[str, Any], timed: bool = True
) -> list[str]:
    """Errors from the robot's maker and from the solver for these arguments; each of them once.

    Parameters
    ----------
    build : callable
        Makes a robot from a dict of arguments.
    arguments : dict
        The arguments that were given; a list is an axis of a sweep.
    absent : list of str
        Required arguments that are missing or invalid.
    options : dict
        Arguments of the solver.
    timed : bool
        Whether the command takes a duration; other commands treat models without a period themselves.
    """
    filled = {name: example_for(name) for name in absent}
    robot, mistakes = None, []
    for choice in islice(_choices(arguments), _MOST):
        made, problems = _tried(build, {**filled, **choice})
        robot = made if robot is None else robot
        mistakes += [p for p in problems if not p.startswith(tuple(f"{name} " for name in absent))]
    if robot is None:
        robot = _tried(build, {**filled, **{name: example_for(name) for name in arguments if axis_of(name)}})[0]
    return list(dict.fromkeys(mistakes + of_solver(robot, options, timed)))


def probe_axes(
    build: Callable[[dict[str, Any]], Any], arguments: dict[str, Any], absent: list[str], options: dict[str, Any], timed: bool = True
) -> list[str]:
    """As `probe`, for a sweep: a value is an error if it is refused both with the first and with the last values of the other axes.

    A combination that is invalid only for some values of the others is not an error: it is marked in the results.
    """
    axes = {name: value for name, value in arguments.items() if isinstance(value, list) and value}
    rest = {**{name: example_for(name) for name in absent}, **{n: v for n, v in arguments.items() if n not in axes}}
    robot: Any = None
    mistakes: list[str] = []
    for name, values in axes.items() or {"": [None]}.items():
        said: list[list[str]] = []
        for end in (0, -1):
            others = {n: v[end] for n, v in axes.items() if n != name}
            made, problems = _tried_all(build, {**rest, **others}, name, values)
            robot = made if robot is None else robot
            said.append([p for p in problems if not p.startswith(tuple(f"{n} " for n in absent))])
        mistakes += said[0] if all(said) else []
    return list(dict.fromkeys(mistakes + of_solver(robot, options, timed)))


def _tried_all(build: Callable[[dict[str, Any]], Any], arguments: dict[str, Any], name: str, values: list[Any]) -> tuple[Any, list[str]]:
    """Try all values of one axis: numbers in one call, words one by one."""
    if not name:
        return _tried(build, arguments)
    if all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in values):
        import numpy as np

        numbers = np.array(values, float)
        finite = numbers[np.isfinite(numbers)]
        together = _tried(build, {**arguments, name: finite}) if len(finite) else (None, [])
        if not together[1] or not all(isinstance(v, int) for v in values):
            return together  # otherwise it may be a count, which makes machines of several kinds
    robot: Any = None
    mistakes: list[str] = []
    for value in values:
        made, problems = _tried(build, {**arguments, name: value})
        robot, mistakes = made if robot is None else robot, mistakes + problems
    return robot, mistakes


def _choices(arguments: dict[str, Any]) -> Any:
    """The arguments for each combination of words; lists of numbers become labelled arrays, as in a sweep."""
    words = {k: v for k, v in arguments.items() if isinstance(v, list) and not all(isinstance(x, (int, float)) for x in v)}
    rest = {k: v for k, v in arguments.items() if k not in words}
    lists = {k: v for k, v in rest.items() if isinstance(v, list)}
    if lists:
        import xarray as xr

        rest |= {k: xr.DataArray([float(x) for x in v], dims=(k,)) for k, v in lists.items()}
    return ({**rest, **dict(zip(words, choice, strict=True))} for choice in product(*words.values()))


def _tried(build: Callable[[dict[str, Any]], Any], arguments: dict[str, Any]) -> tuple[Any, list[str]]:
    try:
        return build(arguments), []
    except InputError as error:
        return None, list(error.problems)
    except (TypeError, ValueError):  # a maker that does not take arrays: the sweep calls it point by point
        return None, []


def of_solver(robot: Any, options: dict[str, Any], timed: bool = True) -> list[str]:
    """Errors of the solver's arguments for a robot of this kind."""
    from stickslip.solvers.request import request
    from stickslip.solvers.settings import Settings

    if robot is None:
        return []
    usual: dict[str, Any] = {"keep": "summary"}
    if not timed and robot.period is None:
        usual |= {"duration": 1.0}
        options = {name: value for name, value in options.items() if name not in ("periods", "settle")}
    if not timed and "periods" not in options:  # then `settle` comes before the periods, and the function checks it
        options = {name: value for name, value in options.items() if name != "settle"}
    try:
        request(robot, Settings.of({**usual, **options}))
    except InputError as error:
        return list(error.problems)
    return []
