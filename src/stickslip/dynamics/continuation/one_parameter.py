"""One parameter of a robot as a variable: a maker with its other arguments fixed, for single values and for batches."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stickslip.basics.batch import made_model
from stickslip.basics.contracts import Model, Numeric
from stickslip.basics.errors import InputError, Problems, did_you_mean
from stickslip.basics.fields import leaves
from stickslip.basics.number_names import numbers_meant
from stickslip.engine.kinds import kind_of
from stickslip.engine.remembered import Remembered
from stickslip.engine.symbolic import numbers_of
from stickslip.models.naming import axis_of
from stickslip.studies.models_of_points import batch_of
from stickslip.studies.space import check_names  # a family is a sweep whose values are not known before

_STEP = 6e-6  # of a value: central differences of what a maker computes are good to some 1e-10 then


@dataclass(frozen=True, eq=False)
class Family:
    """Robots that differ in some parameters.

    Parameters
    ----------
    make : callable or Robot
        A function that makes a robot from keyword arguments, or a robot whose numbers have dotted names.
    parameters : tuple of str
        The keywords that vary.
    fixed : dict
        The other keywords.
    what : str
        Who asks, for messages.
    """

    make: Any
    parameters: tuple[str, ...]
    fixed: dict[str, Any]
    what: str
    _robots: Remembered[Any] = field(default_factory=lambda: Remembered(most=32), init=False, repr=False, compare=False)

    def robot(self, *values: float) -> Any:
        """The robot at one point; equations with other unknowns beside its numbers ask for the same one again and again."""
        at = tuple(map(float, values))
        return self._robots(at, lambda: self._made(at))

    def _made(self, values: tuple[float, ...]) -> Any:
        arguments = {**self.fixed, **dict(zip(self.parameters, values, strict=True))}
        return made_model(self.what, self.make(**arguments) if callable(self.make) else self.make.replace(arguments))

    def robots(self, *values: Numeric) -> Any:
        """Robots at many points, as one batch: arrays of one length."""
        columns = dict(zip(self.parameters, (np.asarray(v, float) for v in values), strict=True))
        return batch_of(self.what, self.make, self.fixed, columns)

    def refusal(self, error: InputError, *values: float) -> str:
        """Why there is no robot at a point, said of that robot alone: the batch that was refused has others beside it."""
        try:
            self.robot(*values)
        except InputError as alone:
            return alone.problems[0]
        return error.problems[0]

    def slopes(self, value: float) -> dict[str, float] | None:
        """Derivatives of the robot's numbers by the one parameter; None where the kind of robot changes with it."""
        step, here = _STEP * (abs(value) or 1.0), self.robot(value)
        sides = [(v, robot) for v in (value - step, value + step, value) if (robot := self.made(v)) is not None][:2]
        (low, one), (high, other) = sides
        if not kind_of(one) == kind_of(other) == kind_of(here):
            return None
        kept, ahead = dict(leaves(one)), dict(leaves(other))
        return {name: (ahead[name] - kept[name]) / (high - low) for name in numbers_of(one) if name in kept and ahead[name] != kept[name]}

    def made(self, *values: float) -> Any:
        """The robot at a point, or None where that is refused."""
        try:
            return self.robot(*values)
        except InputError:
            return None

    def describe(self, parameter: str) -> dict[str, str]:
        """Name and unit of a parameter, as a plot shows them."""
        known = axis_of(parameter, self.make)
        return {"long_name": known[0], "units": known[1]} if known else {"long_name": parameter, "units": "1"}


def family(what: str, make: Model | Callable[..., Any], parameters: tuple[str, ...], fixed: dict[str, Any]) -> Family:
    """A family, its names checked."""
    problems = Problems(what)
    check_names(make, [*fixed, *parameters], (), problems)
    for name in parameters:
        if name in fixed:
            problems.add(f"{name} is the parameter that varies and is given a value too; leave {name}={fixed[name]!r} out")
    problems.check()
    if not callable(make):
        names = [name for name, _ in leaves(make)]
        for name in parameters:
            if not numbers_meant(name, names):
                raise InputError(what, [f"{name!r} is not a number of the robot; {did_you_mean(name, names)}"])
    return Family(make, parameters, fixed, what)
