"""The figures of robots in the plane: a bristle-bot and a hopping robot, and all presets in motion. Run: python examples/planar.py"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import stickslip as ss
from stickslip.show.figures.style import COLOURS, INK, publication

IMAGES = Path(__file__).parents[1] / "docs" / "images"

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
    figure.savefig(IMAGES / "planar.png", dpi=200)

#: Presets in the plane: when they are looked at, in periods or [s], and at how many instants.
SHOWN = {
    "bristle_bot": (40.0, 41.0), "cart_pole": (40.0, 41.0), "block_on_wedge": (0.0, 6.0), "sliding_rod": (40.0, 41.0),
    "two_link_arm": (9.0, 10.0), "mode_coupling": (60.0, 61.5), "gear_joint": (9.0, 10.0),
}  # fmt: skip
INSTANTS = 13


def drawn(machine, at):
    """What pictures of a machine draw at some instants, each line with the x and z of its points, and bodies; of a joint its arm."""
    if isinstance(machine, ss.Joint):
        angle = at["x"]
        return [((0.0 * angle, 0.0 * angle), (np.sin(angle), -np.cos(angle)))], []
    q = dict(zip(machine.coordinates, at["x"].T, strict=True))
    return machine.outlines(0.0, q), [[place[:2]] for place in machine.places(0.0, q).values()]


with publication():
    figure, axes = plt.subplots(2, 4, figsize=(6.4, 3.4), layout="constrained")
    for ax, (name, (first, last)) in zip(axes.flat, SHOWN.items(), strict=False):
        machine = getattr(ss.presets, name)()
        unit = machine.period or 1.0
        run = ss.solve(machine, duration=last * unit)
        at = run.at(np.linspace(first * unit, last * unit * (1 - 1e-9), INSTANTS))
        lines, bodies = drawn(machine, at)
        for n, line in enumerate([*lines, *bodies]):
            x, z = (np.array([np.broadcast_to(point[part], INSTANTS) for point in line]) for part in (0, 1))
            for k in range(INSTANTS):
                part = k / (INSTANTS - 1)
                ax.plot(
                    x[:, k],
                    z[:, k],
                    color=COLOURS[0],
                    alpha=0.15 + 0.85 * part,
                    linewidth=0.5 + 0.7 * part,
                    marker="o" if n >= len(lines) else "",
                    markersize=3,
                )
        ax.set_aspect("equal", adjustable="datalim")
        ax.set_axis_off()
        ax.set_title(name, fontsize="small")
    axes.flat[-1].set_axis_off()
    figure.savefig(IMAGES / "planar_presets.png", dpi=200)
