"""scipy's interpolants as polynomials of the same degree in theta, and the parts of a run joined."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.basics.contracts import ArrayLike
from stickslip.models.state_layout import BodyStates, ContactStates, ControllerStates, StateLayout
from stickslip.results.dense_output import PolynomialPieces
from stickslip.solvers.plain.plain_equations import ContactModes, Equations


@dataclass
class DensePart:
    """One piece of dense output: where it begins, and the polynomials of `Equations.output`."""

    t: float
    x: float  # the first coordinate at its beginning [m]
    coefficients: Any  # (states, degree + 1)
    mode: tuple[int, ...]  # of each contact
    memory: tuple[int, ...]

    def end_at(self, values: ArrayLike) -> None:
        """An event was found to rounding only: take that rounding off."""
        self.coefficients[:, -1] += np.asarray(values) - self.coefficients.sum(axis=1)


def part_of(e: Equations, dense: Any, degree: int, start: float, end: float, before: Any, after: Any, mode: ContactModes) -> DensePart:
    """A step, or the beginning of one up to `end`, as polynomials of a degree; its ends are the integrator's own states."""
    theta = 0.5 - 0.5 * np.cos(np.pi * np.arange(degree + 1) / degree)
    times = start + (end - start) * theta
    states = [before, *(dense(t) for t in times[1:-1]), after]
    values = np.array([e.output(float(t), y, mode) for t, y in zip(times, states, strict=True)])
    coefficients = np.linalg.solve(theta[:, None] ** np.arange(degree + 1), values).T
    coefficients[:, 0] = values[0]
    coefficients[:, -1] += values[-1] - coefficients.sum(axis=1)
    return DensePart(start, float(before[0]), coefficients, mode.sides[: e.k], tuple(m for own in mode.memory for m in own))


def joined_output(parts: list[DensePart], end: float, equations: Equations) -> PolynomialPieces:
    """All parts as one dense output."""
    width = max(part.coefficients.shape[1] for part in parts)
    times = np.append([part.t for part in parts], max(parts[-1].t, end))
    good = np.diff(times) > 0
    c = np.stack([np.pad(p.coefficients, ((0, 0), (0, width - p.coefficients.shape[1]))) for p in parts])
    mode = np.array([part.mode for part in parts], np.int8).reshape(len(parts), -1)
    memory = np.array([part.memory for part in parts], np.int32).reshape(len(parts), -1)
    x0 = np.array([[part.x] if equations.cyclic else [] for part in parts])
    times = np.append(times[:-1][good], times[-1])
    return PolynomialPieces(t=times, mode=mode[good], x0=x0[good], coefficients=c[good], memory=memory[good], layout=_layout(equations))


def _layout(e: Equations) -> StateLayout:
    """The layout of the states of `Equations.output`."""
    mechanics = e.mechanics  # bodies at prescribed distances have the states of their common coordinate
    ends = list(itertools.pairwise(itertools.accumulate(mechanics.inner, initial=e.n)))
    inner, own, parts = ends[: e.k], ends[e.k :], mechanics.controllers
    memory = itertools.pairwise(itertools.accumulate((law.modes for law in e.laws), initial=0))
    first = e.size - e.n
    places = [(name, mechanics.coordinate_of(name)) for name in mechanics.bodies]
    return StateLayout(
        tuple(BodyStates(name, velocity=c, way=0 if e.cyclic else None, position=None if e.cyclic else first + c) for name, c in places),
        tuple(
            ContactStates(name, row, tuple(range(*own)), tuple(range(*held)))
            for name, row, own, held in zip(mechanics.contacts, mechanics.slips_of, inner, memory, strict=True)
        ),
        ways=(0,) if e.cyclic else (),
        single=mechanics.single,
        principal=e.principal,
        controllers=tuple(
            ControllerStates(name, states, tuple(range(*of))) for name, states, of in zip(parts.names, parts.states, own, strict=True)
        ),
    )
