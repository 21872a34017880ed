"""The figure of the page on machines: modules that push in turn, and how far apart to drive them. Run: python examples/chain.py"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import stickslip as ss
from stickslip.show.figures.style import COLOURS, INK, publication

MODULE = ss.Robot(
    body_mass=0.06259,
    inner_mass=0.00948,
    drive=ss.Harmonic(amplitude=6e-4, omega=65.4 * np.pi),
    friction=ss.Coulomb(mu_plus=0.15, mu_minus=0.21),
)
LINK = ss.Spring(stiffness=1200.0, damping=0.4)


def in_turn(ax: plt.Axes) -> None:
    """Velocities of two modules in antiphase."""
    run = ss.solve(ss.Chain((MODULE, MODULE), LINK, phases=(0.0, np.pi)), periods=200)
    last = run.t > 198 * run.period_time
    for name, colour, style in (("module 1", COLOURS[0], "-"), ("module 2", COLOURS[1], (0, (4, 1.5)))):
        ax.plot((run.t[last] - 198 * run.period_time) * 1e3, run.bodies[name].v[last] * 1e3, color=colour, linestyle=style, label=name)
    ax.axhline(0.0, color=INK, linewidth=0.6)
    ax.set_xlabel("time (ms)")
    ax.set_ylabel("velocity $v$ (mm/s)")
    ax.set_title("two modules in antiphase")
    ax.legend(loc="lower center", ncols=2, fontsize=6.5, frameon=False, bbox_to_anchor=(0.5, -0.02))
    ax.set_ylim(-45, None)


def by_phase(ax: plt.Axes) -> None:
    """Mean velocity over the phase between neighbours, for two and three modules."""
    phase = np.linspace(0.0, 2 * np.pi, 181)
    for count, colour, style in ((2, COLOURS[0], "-"), (3, COLOURS[1], (0, (4, 1.5)))):
        behind = tuple((i * phase + np.pi) % (2 * np.pi) - np.pi for i in range(count))
        many = ss.solve(ss.Chain((MODULE,) * count, LINK, phases=behind), periods=400)
        ax.plot(np.degrees(phase), many.mean_velocity * 1e3, color=colour, linestyle=style, label=f"{count} modules")
    ax.axhline(0.0, color=INK, linewidth=0.6)
    ax.set_xticks([0, 90, 180, 270, 360])
    ax.set_xlabel("phase between neighbours (degrees)")
    ax.set_ylabel("mean velocity $V$ (mm/s)")
    ax.set_title("how far apart should they be driven?")
    ax.legend(loc="upper right", fontsize=6.5, frameon=False)


if __name__ == "__main__":
    with publication():
        figure, axes = plt.subplots(1, 2, figsize=(6.4, 2.4), layout="constrained")
        in_turn(axes[0])
        by_phase(axes[1])
        figure.savefig(Path(__file__).parents[1] / "docs" / "images" / "chain.png", dpi=200)
