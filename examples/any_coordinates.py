"""The figure of the page on machines of any coordinates: a bowed string by its modes. Run: python examples/any_coordinates.py"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

import stickslip as ss
from stickslip.maths import pi, sin
from stickslip.show.figures.style import COLOURS, INK, publication

MODES, FUNDAMENTAL = 10, 200.0  # Hz


@dataclass(frozen=True, eq=False)
class BowedString(ss.Machine):
    """A string by its first modes of 0.5 g each, bowed at a part of its length."""

    bow: float
    press: float
    place: float
    friction: Any
    time_scale = 1 / FUNDAMENTAL
    velocity_scale = 0.1

    def bodies(self):
        return {f"mode {j}": ss.Body(0.5e-3) for j in range(1, MODES + 1)}

    def links(self):
        omega = {j: 2 * pi * FUNDAMENTAL * j for j in range(1, MODES + 1)}
        return {(f"mode {j}", None): ss.Spring(0.5e-3 * w**2, 0.5e-3 * 2 * 0.002 * w) for j, w in omega.items()}

    def contacts(self):
        shape = {f"mode {j}": sin(j * pi * self.place) for j in range(1, MODES + 1)}
        return {"bow": ss.Contact(shape, self.friction, on=self.bow, load=self.press)}


if __name__ == "__main__":
    law = ss.Stribeck(0.2, 0.2, 0.8, 0.8, v_s=0.1, exponent=1.0)
    string = BowedString(bow=0.1, press=1.0, place=0.2, friction=law)
    run = ss.solve(string, duration=0.5)
    T, end = 1 / FUNDAMENTAL, 0.5
    with publication():
        figure, (left, right) = plt.subplots(1, 2, figsize=(6.4, 2.4), layout="constrained")
        at = run.at(np.linspace(end - 3 * T, end, 2000))
        left.plot((at["t"] - end + 3 * T) * 1e3, at["slip"][:, 0] + string.bow, color=COLOURS[0])
        left.axhline(string.bow, color=INK, linewidth=0.8, linestyle=":")
        left.set_xlabel("time (ms)")
        left.set_ylabel("velocity under the bow (m/s)")
        along = np.linspace(0.0, 1.0, 300)
        shapes = np.array([np.sin(j * np.pi * along) for j in range(1, MODES + 1)])
        for k, instant in enumerate(np.linspace(end - T, end, 6, endpoint=False)):
            right.plot(along, 1e3 * run.at(np.array([instant]))["x"][0] @ shapes, color=COLOURS[k % len(COLOURS)], linewidth=0.9)
        right.axvline(string.place, color=INK, linewidth=0.8, linestyle=":")
        right.set_xlabel("place along the string")
        right.set_ylabel("displacement (mm)")
        figure.savefig(Path(__file__).parents[1] / "docs" / "images" / "any_coordinates.png", dpi=200)
