"""What a machine in coordinates of its own says of itself: places, a matrix of inertia or a kinetic energy, and Lagrange's equations."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from stickslip.basics.time_rates import TimeJet, time_jet
from stickslip.models.linear_equations import product, total
from stickslip.models.mechanics import Numbers

Parts = tuple[Any, ...]


def places_of_machine(model: Any, t: Any, q: Mapping[str, Any]) -> Any:
    """Where the bodies of a machine are; None where it does not say."""
    return _said(model, "places", t, q)


def inertia_of_machine(model: Any, q: Mapping[str, Any]) -> Any:
    """The matrix of inertia that a machine says; None where it does not."""
    return _said(model, "inertia", q)


def kinetic_of_machine(model: Any, q: Mapping[str, Any], u: Mapping[str, Any]) -> Any:
    """The kinetic energy that a machine says; None where it does not."""
    return _said(model, "kinetic", q, u)


def outlines_of_machine(model: Any, t: Any, q: Mapping[str, Any]) -> Any:
    """Lines that pictures of a machine draw, each through some points (x, z); None where it does not say."""
    return _said(model, "outlines", t, q)


def _said(model: Any, name: str, *arguments: Any) -> Any:
    """What a method of a machine gives; a field of that name is none."""
    method = getattr(model, name, None)
    return method(*arguments) if callable(method) else None


class Energies:
    """The matrix of inertia of a machine that says it, or its kinetic energy, and what Lagrange's equations make of it."""

    def __init__(self, model: Any, names: tuple[str, ...]):
        self.model, self.names = model, names
        self._direct = inertia_of_machine(model, dict.fromkeys(names, 0.0)) is not None

    def _of(self, q: Numbers, u: Numbers) -> TimeJet:
        """Kinetic energy."""
        named = (dict(zip(self.names, of, strict=True)) for of in (q, u))
        return time_jet(kinetic_of_machine(self.model, *named))

    def _entries(self, q: Numbers) -> list[list[TimeJet]]:
        given = inertia_of_machine(self.model, dict(zip(self.names, q, strict=True)))
        return [[time_jet(entry) for entry in row] for row in given]

    def matrix(self, q: Numbers) -> tuple[Parts, ...]:
        """The matrix; of a kinetic energy its second derivatives by the rates."""
        if self._direct:
            return tuple(tuple(entry.value for entry in row) for row in self._entries(q))
        n = len(q)

        def second(*along: int) -> Any:
            return self._of(q, [TimeJet(0.0, 1.0 if k in along else 0.0) for k in range(n)]).second

        own = [second(j) for j in range(n)]
        both = {(i, j): 0.5 * (second(i, j) - own[i] - own[j]) for i in range(n) for j in range(i + 1, n)}
        return tuple(tuple(own[i] if i == j else both[min(i, j), max(i, j)] for j in range(n)) for i in range(n))

    def gyroscopic(self, q: Numbers, u: Numbers) -> Parts:
        """d/dt(dT/du) - dT/dq while the rates stay as they are."""
        n = len(q)
        half = []
        for j in range(n):
            if self._direct:
                slope = self._entries([TimeJet(x, 1.0 if k == j else 0.0) for k, x in enumerate(q)])
                half.append(product(0.5, total(product(slope[i][k].rate, product(u[i], u[k])) for i in range(n) for k in range(n))))
            else:
                half.append(self._of([TimeJet(x, 1.0 if k == j else 0.0) for k, x in enumerate(q)], u).rate)
        return tuple(total([a, product(-1.0, b)]) for a, b in zip(self.rate(q, u), half, strict=True))

    def rate(self, q: Numbers, u: Numbers) -> Parts:
        """dM/dt u."""
        n, path = len(q), [TimeJet(x, v) for x, v in zip(q, u, strict=True)]
        if self._direct:
            M = self._entries(path)
            return tuple(total(product(M[j][k].rate, u[k]) for k in range(n)) for j in range(n))
        base, own = self._of(path, u).second, self.matrix(q)
        seconds = (self._of(path, [TimeJet(v, 1.0 if k == j else 0.0) for k, v in enumerate(u)]).second for j in range(n))
        return tuple(0.5 * (second - base - own[j][j]) for j, second in enumerate(seconds))
