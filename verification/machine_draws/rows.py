"""Rows of bodies with stops between them, of which some have no contact, some lie on another, and one is pushed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from drawn_models import Draw

import stickslip as ss
from machine_draws.drawing import asks, friction, has_states, sized
from stickslip.maths import pi, sin


@dataclass(frozen=True, eq=False)
class Row(ss.Machine):
    """Bodies on springs to the ground or to their neighbours; pairs of them meet at stops."""

    masses: tuple[float, ...]
    springs: tuple[Any, ...]  # from each body to the one before it, of the first to the ground
    walls: tuple[Any, ...]  # stops
    pairs: tuple[int, ...]  # of which of the pairs (1, 2), (3, 4), (5, 6) each of them is
    friction: Any
    push: float
    bias: float
    omega: float
    bare: tuple[int, ...]  # bodies that have no contact
    riders: tuple[int, ...]  # bodies that lie on the one before them
    belt: float

    @property
    def period(self) -> Any:
        """That of the push."""
        return 2 * pi / self.omega

    @property
    def names(self) -> list[str]:
        return [f"body {i + 1}" for i in range(len(self.masses))]

    def bodies(self) -> Any:
        """The first of them is pushed."""
        found = {name: ss.Body(mass) for name, mass in zip(self.names, self.masses, strict=True)}
        pushed = ss.Body(self.masses[0], force=lambda t, x, v: self.push * sin(self.omega * t) + self.bias)
        return {**found, self.names[0]: pushed}

    def contacts(self) -> Any:
        """On the track, on a belt, or on the body before."""
        found = {}
        for i, name in enumerate(self.names):
            if i in self.bare:
                continue
            on = self.names[i - 1] if i in self.riders else self.belt if i == len(self.masses) - 1 else None
            found[name] = ss.Contact(name, self.friction, on=on, load=9.81 * self.masses[i])
        return found

    def links(self) -> Any:
        """Springs along the row."""
        return {(name, before): spring for name, before, spring in zip(self.names, [None, *self.names], self.springs, strict=False)}

    def stops(self) -> Any:
        """At every second pair."""
        ends = zip(self.names[::2], self.names[1::2], strict=False)
        found = {each: tuple(wall for wall, own in zip(self.walls, self.pairs, strict=True) if own == n) for n, each in enumerate(ends)}
        return {each: walls for each, walls in found.items() if walls}


def row(law: str, d: Draw) -> Any:
    """Two to six bodies."""
    count, mass = int(d.choice.integers(2, 7)), 0.1 * d.wide(0.3, 3)
    omega, velocity = 60.0 * d.wide(0.3, 3), 0.1 * d.wide(0.3, 3)
    masses = tuple(mass * d.uniform(0.5, 2.0) for _ in range(count))
    rubs = friction(law, sized(d, mass, velocity, omega, 9.81 * mass))
    size, stiffness = velocity / omega, mass * omega**2
    walls = [_walls(d, size, stiffness) for _ in range(count // 2)]
    pairs = tuple(n for n, own in enumerate(walls) for _ in own)
    springs = tuple(ss.Spring(stiffness * d.wide(0.03, 3), damping=mass * omega * d.wide(1e-2, 0.5)) for _ in range(count))
    thrown = {2 * n + 1 for n, own in enumerate(walls) if any(wall.restitution is not None for wall in own)} - (
        set(range(count)) if has_states(law) else set()
    )  # the second of each pair that hits: it has no contact, or rebounds that come to an end would end the run
    riders = tuple(i for i in range(1, count) if not thrown and not asks(law) and d.choice.random() < 0.25)[:2]
    bare = tuple(i for i in range(count) if i in thrown or (not riders and i and d.choice.random() < 0.2))
    belt = velocity * d.uniform(-0.3, 0.3) if d.choice.random() < 0.3 else 0.0 * velocity
    return Row(
        masses=masses, springs=springs, walls=sum(walls, ()), pairs=pairs, friction=rubs,
        push=mass * velocity * omega * d.uniform(1.0, 3.0),
        bias=mass * velocity * omega * d.sometimes(d.uniform(-1.0, 1.0)), omega=omega, bare=bare, riders=riders, belt=belt,
    )  # fmt: skip


def _walls(d: Draw, size: Any, stiffness: Any) -> Any:
    """Stops of one pair: none, one, or one at each end of the way."""
    which = int(d.choice.integers(4))
    sides = ((), (1,), (-1,), (1, -1))[which]
    return tuple(_stop(d, size, stiffness, side) for side in sides)


def _stop(d: Draw, size: Any, stiffness: Any, side: int) -> Any:
    gap = size * d.wide(0.03, 1.0)
    if d.choice.random() < 0.65:
        return ss.Stop(gap=gap, restitution=d.uniform(0.0, 0.95), side=side)
    return ss.Stop(gap=gap, stiffness=stiffness * d.wide(10, 1000), damping=np.sqrt(stiffness) * d.sometimes(d.wide(1e-3, 0.1)), side=side)
