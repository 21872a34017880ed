"""Numbers that are not known exactly: how they are spread, and evenly spread samples of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from stickslip.errors import Problems, did_you_mean
from stickslip.fields import leaves, replace_leaf
from stickslip.named import numbers_meant

__all__ = ["Independent", "Spread", "Uncertain", "checked_spread", "sample_of", "sampled", "sobol"]

Array = Any
_TYPED = '{"friction.mu_plus": ("uniform", 0.13, 0.17)} or {"friction.mu_plus": ("normal", 0.15, 0.01)}'
_EDGE = 1e-12  # how near a sample comes to the ends of a distribution that has none


class Spread(Protocol):
    """How some numbers of a machine are spread together."""

    @property
    def names(self) -> tuple[str, ...]:
        """The numbers as they were typed, or as a fit has them."""

    @property
    def independent(self) -> bool:
        """Whether each is spread by itself."""

    def inputs(self, u: Array) -> dict[str, Array]:
        """The numbers by these names, for u evenly spread between 0 and 1: array (names, cases)."""

    def numbers(self, u: Array) -> dict[str, Array]:
        """The same by the names of the machine's numbers."""

    def alone(self, name: str, u: Array) -> dict[str, Array]:
        """Numbers of the machine where one of them is at some parts u of its own distribution, and the others as they are."""


@dataclass(frozen=True)
class Uncertain:
    """Numbers with one distribution, taken together: "uniform" from a to b, or "normal" with mean a and standard deviation b."""

    name: str
    leaves: tuple[str, ...]
    kind: str
    a: float
    b: float

    def at(self, u: Array) -> Array:
        """The numbers below which a part u of the distribution lies."""
        from scipy.special import ndtri

        u = np.clip(u, _EDGE, 1.0 - _EDGE)
        return self.a + (self.b - self.a) * u if self.kind == "uniform" else self.a + self.b * ndtri(u)


@dataclass(frozen=True)
class Independent:
    """Numbers each of which is spread by itself.

    Examples
    --------
    >>> spread = Independent((Uncertain("tilt", ("track.tilt",), "uniform", 0.0, 0.1),))
    >>> spread.numbers(np.array([[0.25, 0.5]]))["track.tilt"].tolist()
    [0.025, 0.05]
    """

    each: tuple[Uncertain, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """As they were typed."""
        return tuple(one.name for one in self.each)

    @property
    def independent(self) -> bool:
        """Always."""
        return True

    def inputs(self, u: Array) -> dict[str, Array]:
        """The numbers by the names that were typed."""
        return {one.name: one.at(part) for one, part in zip(self.each, u, strict=True)}

    def numbers(self, u: Array) -> dict[str, Array]:
        """The numbers of the machine."""
        return {name: one.at(part) for one, part in zip(self.each, u, strict=True) for name in one.leaves}

    def alone(self, name: str, u: Array) -> dict[str, Array]:
        """One of them at some parts of its distribution."""
        return {leaf: one.at(u) for one in self.each if one.name == name for leaf in one.leaves}


def checked_spread(model: Any, argument: str, given: Any, problems: Problems) -> Spread | None:
    """How numbers are spread, from the distributions that were typed or from a fit; what is wrong with them is noted."""
    if not isinstance(given, dict):
        spread: Spread | None = given.distribution(model, problems)
        return spread
    if not given:
        problems.add(f"{argument} = {given!r}; allowed is a dict of distributions, or a Fit; type {argument}={_TYPED}")
        return None
    known, found = [name for name, _ in leaves(model)], []
    for name, said in given.items():
        meant = numbers_meant(str(name), known)
        if not meant:
            problems.add(f"{argument}: {name!r} is no number of {type(model).__name__}; {did_you_mean(str(name), known)}")
        elif (each := _distribution(str(name), meant, said)) is None:
            allowed = '("uniform", least, largest), ("normal", mean, standard deviation), or (mean, "1%")'
            problems.add(f"{argument}[{name!r}] = {said!r}; allowed is {allowed}; type for example {_TYPED}")
        else:
            found.append(each)
    return Independent(tuple(found)) if found else None


def _distribution(name: str, meant: tuple[str, ...], said: Any) -> Uncertain | None:
    """What was typed; (mean, "1%") is a normal distribution whose standard deviation is that part of its mean."""
    try:
        if len(said) == 2 and isinstance(said[1], str) and said[1].endswith("%"):
            said = ("normal", said[0], abs(float(said[0])) * float(said[1][:-1]) / 100.0)
        kind, a, b = said
        a, b = float(a), float(b)
    except (TypeError, ValueError):
        return None
    good = np.isfinite([a, b]).all() and ((kind == "uniform" and a < b) or (kind == "normal" and b > 0.0))
    return Uncertain(name, meant, kind, a, b) if good else None


def sobol(dimensions: int, count: int, seed: int) -> Array:
    """A scrambled Sobol sample of the unit cube: array (dimensions, a power of two)."""
    from scipy.stats import qmc

    return qmc.Sobol(dimensions, seed=np.random.default_rng(seed)).random_base2(round(np.log2(count))).T


def sample_of(spread: Spread, count: int, seed: int) -> dict[str, Array]:
    """A scrambled Sobol sample of a machine's numbers, by name: arrays (count,), a power of two.

    Examples
    --------
    >>> found = sample_of(Independent((Uncertain("tilt", ("track.tilt",), "uniform", 0.0, 1.0),)), 4, seed=1)
    >>> sorted((4 * found["track.tilt"]).astype(int).tolist())  # one in each quarter
    [0, 1, 2, 3]
    """
    return spread.numbers(sobol(len(spread.names), count, seed))


def sampled(machines: Any, count: int, sample: dict[str, Array]) -> tuple[Any, int]:
    """Each of some machines with each of the sample's numbers, the sample's inside: a batch, and its size."""
    size = len(next(iter(sample.values())))
    numbers = {name: np.repeat(np.broadcast_to(np.asarray(value, float), (count,)), size) for name, value in leaves(machines)}
    return replace_leaf(machines, numbers | {name: np.tile(values, count) for name, values in sample.items()}), count * size
