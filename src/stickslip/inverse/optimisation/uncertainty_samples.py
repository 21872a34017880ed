"""Numbers that are not known exactly: how they are spread, and evenly spread samples of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.distributions import ALLOWED, Distribution, distribution_of
from stickslip.basics.errors import InputError, Problems, did_you_mean
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.basics.number_names import numbers_meant, unequal_sides
from stickslip.inverse.optimisation.perturbed_machines import is_allowed
from stickslip.models.naming import in_its_unit
from stickslip.studies.designs import sobol_cube

_TYPED = '{"friction.mu_plus": ("uniform", 0.13, 0.17)} or {"friction.mu_plus": ("normal", 0.15, 0.01)}'


@dataclass(frozen=True)
class Uncertain:
    """Numbers of a machine with one distribution, taken together."""

    name: str
    leaves: tuple[str, ...]
    distribution: Distribution


@dataclass(frozen=True)
class Independent:
    """Numbers each of which is spread by itself; a fit, whose numbers are spread together, says the same of them.

    Examples
    --------
    >>> spread = Independent((Uncertain("tilt", ("track.tilt",), Distribution("uniform", 0.0, 0.1)),))
    >>> spread.numbers(np.array([[0.25, 0.5]]))["track.tilt"].tolist()
    [0.025, 0.05]
    """

    each: tuple[Uncertain, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The numbers as they were typed, or as a fit has them."""
        return tuple(one.name for one in self.each)

    @property
    def independent(self) -> bool:
        """Whether each is spread by itself."""
        return True

    def inputs(self, u: Array) -> dict[str, Array]:
        """The numbers by these names, for u evenly spread between 0 and 1: array (names, cases)."""
        return {one.name: one.distribution.at(part) for one, part in zip(self.each, u, strict=True)}

    def numbers(self, u: Array) -> dict[str, Array]:
        """The same by the names of the machine's numbers."""
        return {name: one.distribution.at(part) for one, part in zip(self.each, u, strict=True) for name in one.leaves}

    def alone(self, name: str, u: Array) -> dict[str, Array]:
        """Numbers of the machine where one of them is at some parts u of its own distribution, and the others as they are."""
        return {leaf: one.distribution.at(u) for one in self.each if one.name == name for leaf in one.leaves}


def checked_spread(model: Model, argument: str, given: Any, problems: Problems) -> Any:
    """How numbers are spread, from the distributions that were typed or from a fit; what is wrong with them is noted."""
    if not isinstance(given, dict):
        if not hasattr(given, "distribution"):
            problems.add(f"{argument} = {given!r}; allowed is a dict of distributions, or a Fit; type {argument}={_TYPED}")
            return None
        return given.distribution(model, problems)
    if not given:
        problems.add(f"{argument} = {given!r}; allowed is a dict of distributions, or a Fit; type {argument}={_TYPED}")
        return None
    known, uncertain = [name for name, _ in leaves(model)], []
    for name, said in given.items():
        meant = numbers_meant(str(name), known)
        if not meant:
            problems.add(f"{argument}: {name!r} is not a number of {type(model).__name__}; {did_you_mean(str(name), known)}")
        elif why := unequal_sides(str(name), meant, dict(leaves(model))):
            problems.add(f"{argument}: {why}")
        elif (each := distribution_of(in_its_unit(meant[0], said, model, problems, f"{argument}[{name!r}]"))) is None:
            problems.add(f"{argument}[{name!r}] = {said!r}; allowed is {ALLOWED}; type for example {_TYPED}")
        else:
            uncertain.append(Uncertain(str(name), meant, each))
    return Independent(tuple(uncertain)) if uncertain else None


def sample_of(spread: Any, count: int, seed: int) -> dict[str, Array]:
    """A scrambled Sobol sample of a machine's numbers, by name: arrays (count,), a power of two.

    Examples
    --------
    >>> found = sample_of(Independent((Uncertain("tilt", ("track.tilt",), Distribution("uniform", 0.0, 1.0)),)), 4, seed=1)
    >>> sorted((4 * found["track.tilt"]).astype(int).tolist())  # one in each quarter
    [0, 1, 2, 3]
    """
    return spread.numbers(sobol_cube(count, len(spread.names), seed).T)


def check_sample(what: str, model: Any, sample: dict[str, Array]) -> None:
    """`InputError` where a number of the sample makes no machine: the record says what its numbers may be."""
    try:
        model.replace(sample)
    except InputError as error:
        raise InputError(what, [f"in the sample, {problem}" for problem in error.problems]) from None


def allowed_with(machines: Any, count: int, sample: dict[str, Array]) -> Array:
    """Which machines of a batch may have every number of a sample, as their record says: array (count,).

    Examples
    --------
    >>> import stickslip as ss
    >>> law = ss.Stribeck(mu_plus=np.array([0.1, 0.2]), mu_minus=0.1, f_plus=0.3, f_minus=0.3, v_s=1e-3)
    >>> allowed_with(ss.Robot(0.9, 0.1, ss.Harmonic.example(), law), 2, {"friction.f_plus": np.array([0.15, 0.25])}).tolist()
    [True, False]
    """

    def allowed(which: Array) -> bool:
        numbers = {name: np.broadcast_to(np.asarray(own, float), (count,))[which][:, None] for name, own in leaves(machines)}
        return is_allowed(replace_leaf(machines, numbers), sample)

    if allowed(np.arange(count)):
        return np.ones(count, bool)
    return np.array([allowed(np.array([k])) for k in range(count)])


def sampled(machines: Any, count: int, sample: dict[str, Array]) -> tuple[Any, int]:
    """Each of some machines with each of the sample's numbers, the sample's inside: a batch, and its size."""
    size = len(next(iter(sample.values())))
    numbers = {name: np.repeat(np.broadcast_to(np.asarray(value, float), (count,)), size) for name, value in leaves(machines)}
    return replace_leaf(machines, numbers | {name: np.tile(values, count) for name, values in sample.items()}), count * size
