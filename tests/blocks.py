"""A row of blocks on springs, of which tests make long ones."""

from dataclasses import dataclass
from typing import Any

import numpy as np

import stickslip as ss

STRIBECK = ss.Stribeck(0.5, 0.5, f_plus=1.0, f_minus=1.0, v_s=0.25)


@dataclass(frozen=True, eq=False)
class Row(ss.Machine):
    """Blocks on springs, which are pulled over a plane (Burridge and Knopoff 1967)."""

    offsets: tuple[float, ...]
    friction: Any = STRIBECK
    stiffness: float = 16.0
    spring: Any = ss.Spring
    puller: float = 1.0
    speed: float = 0.01
    push: Any = 0.0

    velocity_scale = 1.0

    def bodies(self):
        return {f"b{i}": ss.Body(1.0 + 0.1 * (i % 3), position=x, force=self.push) for i, x in enumerate(self.offsets)}

    def contacts(self):
        return {f"b{i}": ss.Contact(f"b{i}", self.friction, on=-self.speed, load=1.0) for i in range(len(self.offsets))}

    def links(self):
        n = len(self.offsets)
        pulled = {(f"b{i}", None): ss.Spring(self.puller) for i in range(n)}
        return pulled | {(f"b{i}", f"b{i + 1}"): self.spring(self.stiffness) for i in range(n - 1)}


def row(count, seed=1, **numbers):
    return Row(tuple(np.random.default_rng(seed).uniform(-0.1, 0.1, count).tolist()), **numbers)
