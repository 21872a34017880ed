"""The figure of the page on robots in the plane: a bristle-bot and a hopping robot. Run: python examples/planar.py"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import stickslip as ss
from stickslip.show.figures.style import COLOURS, INK, publication

with publication():
    figure, (left, right) = plt.subplots(1, 2, figsize=(6.4, 2.4), layout="constrained")
    smooth, dots = (np.linspace(4.0, 11.0, count) for count in (300, 15))
    left.plot(smooth, 1e6 * ss.presets.bristle_bot(smooth).expanded, color=INK, linewidth=0.9)
    orbits = [ss.periodic_orbit(ss.presets.bristle_bot(frequency)) for frequency in dots]
    left.plot(dots, [1e6 * orbit.mean_velocity for orbit in orbits], "o", color=COLOURS[0], markersize=3.5)
    left.axhline(0.0, color=INK, linewidth=0.6)
    left.axvline(ss.presets.bristle_bot().reversal / (2 * np.pi), color=INK, linewidth=0.8, linestyle=":")
    left.set_xlabel("frequency (Hz)")
    left.set_ylabel("mean velocity (µm/s)")
    for k, restitution in enumerate((0.0, 0.3)):
        robot = ss.presets.hopping_robot(ratio=1.8, restitution=restitution)
        run = ss.solve(robot, periods=60)
        at = run.at(np.linspace(57 * robot.period, 60 * robot.period, 1500))
        right.plot((at["t"] / robot.period) - 57, 1e3 * at["x"][:, 1], color=COLOURS[k], label=f"e = {restitution:g}")
    right.set_xlabel("turns of the rotor")
    right.set_ylabel("height (mm)")
    right.set_ylim(top=2.0 * right.get_ylim()[1] / 1.7)
    right.legend(loc="upper center", ncols=2)
    figure.savefig(Path(__file__).parents[1] / "docs" / "images" / "planar.png", dpi=200)
