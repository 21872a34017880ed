"""Free, fixed and tied parameters of several records, and the numbers that a search moves."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from stickslip.basics.arguments import parameters_of
from stickslip.basics.batch import made_model, stacked
from stickslip.basics.contracts import Array, Model
from stickslip.basics.distributions import ALLOWED, Distribution, distribution_of
from stickslip.basics.errors import InputError, Problems, did_you_mean
from stickslip.basics.fields import leaves
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.number_names import SIDES, numbers_meant, pairs_in
from stickslip.inverse.identification.friction_effects import plainer
from stickslip.inverse.identification.limits import Limits, limits_of
from stickslip.inverse.scales import Scale
from stickslip.models.friction.law import Symmetric
from stickslip.models.naming import in_its_unit


@dataclass(frozen=True)
class Free:
    """A number to be found.

    Parameters
    ----------
    name : str
        As in ``free``; ``amplitude[0]`` belongs to the first record alone.
    low, high : float
        Bounds.
    log : bool
        Whether the search moves its logarithm.
    prior : Distribution, optional
        What is known of it beforehand.
    """

    name: str
    low: float
    high: float
    log: bool = False
    prior: Distribution | None = None

    @property
    def scale(self) -> Scale:
        """The scale of the search."""
        return Scale(self.low, self.high, self.log)

    def inner(self, value: Any) -> Any:
        """The value on the scale of the search, 0 to 1 between the bounds."""
        return self.scale.inner(value)

    def outer(self, part: Array) -> Any:
        """The value at a part of the way, 0 to 1."""
        return self.scale.outer(np.asarray(part))

    def slope(self, part: float) -> float:
        """d value / d part."""
        return self.scale.slope(np.asarray(part))

    @property
    def argument(self) -> str:
        """The argument that it sets."""
        return self.name.partition("[")[0]

    @property
    def record(self) -> int | None:
        """The record it belongs to; None for all."""
        match = re.fullmatch(r".*\[(\d+)\]", self.name)
        return int(match[1]) if match else None


@sealed
@dataclass(frozen=True, eq=False)
class Parameters:
    """How the numbers of a search become models, one for each record.

    Parameters
    ----------
    make : callable or Robot
        A maker, such as a preset or a law's class; or a robot, whose fields are then named with dots.
    free : tuple of Free
    fixed : tuple of dict
        For each record the arguments that do not change.
    tied : dict
        Argument -> another argument's name, or a function of the dict of all free values.
    left_out : tuple of str
        Effects of the law that the models are made without (see `nesting`).
    known_limits : Limits, optional
        What the laws demand of the values besides the bounds, where that is known already.
    """

    make: Any
    free: tuple[Free, ...]
    fixed: tuple[dict[str, Any], ...]
    tied: dict[str, Any]
    left_out: tuple[str, ...] = ()
    known_limits: Limits | None = None

    @cached_property
    def limits(self) -> Limits:
        """Limits that the laws set on the values besides the bounds."""
        return self.known_limits or limits_of(self)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the free parameters."""
        return tuple(f.name for f in self.free)

    def values(self, point: Array) -> dict[str, Any]:
        """Free values at a point between the bounds; arrays if `point` has a second axis (parameters, cases)."""
        return {f.name: f.outer(p)[()] for f, p in zip(self.free, point, strict=True)}

    def point(self, values: dict[str, float]) -> Any:
        """The point of these values."""
        return np.array([float(f.inner(values[f.name])) for f in self.free])

    def arguments(self, values: dict[str, Any], record: int) -> dict[str, Any]:
        """All arguments of the model of one record."""
        arguments = dict(self.fixed[record])
        for f in self.free:
            if f.record in (None, record):
                arguments[f.argument] = values[f.name]
        for name, rule in self.tied.items():
            arguments[name] = rule({**arguments, **values}) if callable(rule) else arguments[rule]
        return arguments

    def model(self, values: dict[str, Any], record: int) -> Any:
        """The model of one record; raises `InputError` where the values make none."""
        arguments = self.arguments(values, record)
        made = made_model("identify", self.make(**arguments) if callable(self.make) else self.make.replace(arguments))
        return plainer(made, self.left_out) if self.left_out else made

    def leaving_out(self, effects: Iterable[str]) -> Parameters:
        """The same, of a law without some effects."""
        return replace(self, left_out=tuple(effects), known_limits=self.limits)

    def first_models(self, points: Array) -> list[Any]:
        """The models of all records at the first of these points that makes them; `InputError` with the maker's words if none does."""
        said = ""
        for point in points:
            values = self.values(point)
            try:
                return [self.model(values, record) for record in range(len(self.fixed))]
            except InputError as error:
                said = said or f"{error} (at {', '.join(f'{name} = {value:.4g}' for name, value in values.items())})"
        none = f"none of {len(points)} points between the bounds makes a model"
        raise InputError("identify", [f"{none}: {said}; mend that, or widen or correct the bounds"])

    def models(self, point: Array) -> list[Any] | None:
        """The models of all records at a point; None where there is none for one of them."""
        values = self.values(point)
        try:
            return [self.model(values, record) for record in range(len(self.fixed))]
        except InputError:
            return None

    def batches(self, points: Array) -> tuple[Any, list[Any]]:
        """For many points: which of them make models, and for each record a batch of those that do.

        A maker need not take arrays: models are made one by one, and their numbers are put together; those of a machine at once.
        """
        at_once = [self.at_once(points, record) for record in range(len(self.fixed))]
        if all(batch is not None for batch in at_once):
            return np.ones(len(points), bool), at_once
        made = [self.models(point) for point in points]
        good = [models for models in made if models is not None]
        stacks = [stacked("identify", list(each)) for each in zip(*good, strict=True)]
        return np.array([models is not None for models in made], bool), stacks

    def at_once(self, points: Array, record: int) -> Any:
        """The models of one record at many points as a batch that is made at once; None of a function, and where one point makes none."""
        if callable(self.make) or self.left_out or any(map(callable, self.tied.values())):
            return None
        try:
            return self.make.replace(self.arguments(self.values(np.asarray(points, float).T), record))
        except InputError:
            return None

    def only(self, fixed: dict[str, float]) -> Parameters:
        """The same with some of the free parameters held."""
        kept = tuple(f for f in self.free if f.name not in fixed)
        held = [dict(each) for each in self.fixed]
        for f in self.free:
            if f.name in fixed:
                for record, each in enumerate(held):
                    if f.record in (None, record):
                        each[f.argument] = fixed[f.name]
        return replace(self, free=kept, fixed=tuple(held), known_limits=self.limits.only(fixed))


def parameters(
    make: Model | Callable[..., Any],
    free: dict[str, Any],
    tied: dict[str, Any] | None,
    arguments: dict[str, Any],
    count: int,
    what: str = "identify",
) -> Parameters:
    """Check what the user gave; everything wrong with it is reported at once."""
    problems = Problems(what)
    known = _known(make)
    spread = _free(make, free, count, problems)
    for name in [*dict.fromkeys(f.argument for f in spread), *arguments, *(tied or {})]:
        if known is not None and not numbers_meant(name, known):
            problems.add(f"{name!r} is not known; {did_you_mean(name, known)}")
    fixed = _fixed(arguments, count, problems)
    for name in _needed(make, {*free, *arguments, *(tied or {})}):
        own = {f.record for f in spread if f.argument == name}
        if name not in {*arguments, *(tied or {}), *free} and None not in own and len(own) < count:
            problems.add(f"{name} is missing; type its value, {name}=..., or make it free")
    _check_once(spread, tied or {}, arguments, count, problems)
    for name, rule in (tied or {}).items():
        if not callable(rule) and known is not None and not numbers_meant(rule, known):
            problems.add(f"{name} is tied to {rule!r}, which is not known; {did_you_mean(str(rule), known)}")
    if not spread:
        example = "0.18" if what == "design" else "(0.05, 0.5)"
        coefficient = next((name for name in known or () if name.rpartition(".")[2] == "mu_plus"), "mu0")
        problems.add(f'free names no parameter; type for example free={{"{coefficient}": {example}}}')
    problems.check()
    return Parameters(make, tuple(spread), fixed, dict(tied or {}))


def _known(make: Model | Callable[..., Any]) -> list[str] | None:
    """Names of the arguments; None if any is allowed."""
    if not callable(make):
        return [name for name, _ in leaves(make)] + ["drive", "friction", "track"]
    known = parameters_of(make)
    return None if any(p.kind is p.VAR_KEYWORD for p in known) else [p.name for p in known]


def _needed(make: Model | Callable[..., Any], given: set[str]) -> list[str]:
    """Arguments that have no default, and do not follow from what is given: of a law, a number of one direction from that of the other."""
    if not callable(make):
        return []
    known = parameters_of(make)
    needed = [p.name for p in known if p.default is p.empty and p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL)]
    if not isinstance(make, Symmetric):
        return needed
    both = {side for stem, pair in pairs_in(p.name for p in known).items() if stem in given for side in pair}
    back = set() if any(name.endswith(SIDES[1]) for name in given) else {name for name in needed if name.endswith(SIDES[1])}
    return [name for name in needed if name not in both | back]


def _free(make: Model | Callable[..., Any], free: dict[str, Any], count: int, problems: Problems) -> list[Free]:
    parameters = []
    for name, typed in free.items():
        bounds = in_its_unit(name.partition("[")[0], typed, make, problems, f"free: {name}")
        parts = tuple(bounds) if isinstance(bounds, (tuple, list)) else ()
        known = distribution_of(bounds)
        parts = known.bounds if known else parts
        log = len(parts) == 3 and parts[2] == "log"
        if len(parts) not in (2, 3) or (len(parts) == 3 and not log) or not _ordered(parts[:2], log):
            allowed = f'(low, high) with low < high, (low, high, "log") with 0 < low, or an uncertain number: {ALLOWED}'
            problems.add(f'free: {name} = {bounds!r}; allowed is {allowed}; type for example "{name}": (0.05, 0.5)')
            continue
        low, high = float(parts[0]), float(parts[1])
        each = [name.replace("[:]", f"[{i}]") for i in range(count)] if name.endswith("[:]") else [name]
        parameters += [Free(one, low, high, log, known) for one in each]
    for f in parameters:
        if f.record is not None and f.record >= count:
            problems.add(f"free: {f.name} names record {f.record}; there are {count}, counted from 0")
    return parameters


def _check_once(free: list[Free], tied: dict[str, Any], arguments: dict[str, Any], count: int, problems: Problems) -> None:
    """Every number has one source; an argument may be given where only some of the records have their own free one."""
    names = [f.name for f in free]
    for name in dict.fromkeys(f.argument for f in free):
        own = [f"{name}[{f.record}]" for f in free if f.argument == name and f.record is not None]
        if name in names and own:
            problems.add(f"free names {name}, for all records, and {', '.join(dict.fromkeys(own))}; leave one of them out")
        problems.mistakes += [f"free names {one} twice, once as {name}[:]; leave one of them out" for one in own if own.count(one) > 1][:1]
        if name in arguments and (name in names or len(set(own)) == count):
            problems.add(f"{name} is free and given, as {name} = {arguments[name]!r}; leave one of them out")
        if name in tied:
            problems.add(f"{name} is free and tied; leave it out of free or out of tied")
    problems.mistakes += [
        f"{name} is tied and given, as {name} = {arguments[name]!r}; leave one of them out" for name in tied if name in arguments
    ]


def _ordered(bounds: tuple[Any, ...], log: bool) -> bool:
    try:
        low, high = float(bounds[0]), float(bounds[1])
    except (TypeError, ValueError):
        return False
    return bool(np.isfinite(low) and np.isfinite(high) and low < high and (low > 0 or not log))


def _fixed(arguments: dict[str, Any], count: int, problems: Problems) -> tuple[dict[str, Any], ...]:
    fixed: list[dict[str, Any]] = [{} for _ in range(count)]
    for name, value in arguments.items():
        many = isinstance(value, (list, tuple)) or (isinstance(value, np.ndarray) and value.ndim == 1)
        if many and len(value) != count:
            problems.add(f"{name} has {len(value)} values and there are {count} records; give one value, or one for each record")
            continue
        for record in range(count):
            fixed[record][name] = value[record] if many else value
    return tuple(fixed)


class OverParameters:
    """Base of the problems whose points are those of their free parameters alone, solved side by side."""

    resolution: ClassVar[float] = 1e-6  # singular values of the derivatives, which are of second order, below this are zero
    remembers: bool = False  # whether the contact has inner states
    batched: ClassVar[bool] = True
    kinked: bool = False  # whether parameters move kinks past samples, so that derivatives are worth a closer look
    nuisances: Any = 0
    timing: Any = 0

    if TYPE_CHECKING:
        parameters: Parameters
        targets: tuple[Any, ...]

    def finer(self) -> Any:
        """The same with shorter steps where these are long."""
        return self

    @property
    def has_noise(self) -> bool:
        """Whether the input carries noise; a drive is known."""
        return False

    @property
    def y(self) -> Any:
        """All measured values."""
        return np.concatenate([t.y for t in self.targets])

    @property
    def sigma(self) -> Any:
        """Standard deviation of each value."""
        return np.concatenate([t.sigma / np.sqrt(t.weight * np.ones(t.count)) for t in self.targets])

    def _like(self, **changes: Any) -> Self:
        return replace(self, **changes)  # type: ignore[type-var]

    def afresh(self) -> Self:
        """The same fit with a memory and a count of its own, which begin with what is remembered here."""
        return self._like(solves=0)

    def with_values(self, y: Any) -> Self:
        """The same fit for other measured values."""
        parts = np.split(y, np.cumsum([t.count for t in self.targets])[:-1])
        return self._like(targets=tuple(replace(t, y=part) for t, part in zip(self.targets, parts, strict=True)))

    def only(self, fixed: dict[str, float]) -> Self:
        """The same fit with some parameters held."""
        return self._like(parameters=self.parameters.only(fixed))

    def leaving_out(self, effects: Iterable[str]) -> Self:
        """The same fit of a law without some effects."""
        return self._like(parameters=self.parameters.leaving_out(effects))

    def guesses(self) -> list[Any]:
        """Places that the user proposes; none."""
        return []

    def aligned(self, point: Array) -> Any:
        """Nothing is aligned: there is no phase besides the parameters."""
        return np.asarray(point, float)

    def settling(self, point: Array) -> dict[str, float]:
        """How slowly steady motions of records settle; nothing of what is not steady."""
        return {}

    def bounds(self) -> tuple[Any, Any]:
        """Bounds of a point."""
        n = len(self.parameters.free)
        return np.zeros(n), np.ones(n)
