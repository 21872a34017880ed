"""A pendulum on a cart, as `places` say it; what pushes it and how the cart rubs is each test's own."""

from __future__ import annotations

from dataclasses import dataclass

import stickslip as ss
from stickslip.maths import cos, sin


@dataclass(frozen=True, eq=False)
class CartAndBob(ss.Machine):
    """Where both are."""

    cart: float
    bob: float
    length: float
    coordinates = ("x", "angle")

    def bodies(self):
        return {"cart": ss.Body(self.cart), "bob": ss.Body(self.bob)}

    def places(self, t, q):
        return {"cart": (q["x"], 0.0), "bob": (q["x"] + self.length * sin(q["angle"]), -self.length * cos(q["angle"]))}
