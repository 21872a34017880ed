"""The figures of the pages on two robots and on worms. Run: python examples/two_robots.py"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import stickslip as ss
from stickslip.show.figures.style import COLOURS, DASHES, INK, publication

IMAGES = Path(__file__).parents[1] / "docs" / "images"
MILLI = 1e3


def by_phase(ax: plt.Axes) -> None:
    """Mean velocity over the phase for three springs."""
    grid = ss.sweep(ss.presets.two_modules, phase=np.linspace(0.0, 2 * np.pi, 121), stiffness=[300.0, 1200.0, 3000.0])
    for k, colour, dashes in zip(grid.stiffness.values, COLOURS, DASHES, strict=False):
        ax.plot(np.degrees(grid.phase), grid.mean_velocity.sel(stiffness=k) * MILLI, color=colour, linestyle=dashes, label=f"{k:g} N/m")
    ax.set_xticks([0, 90, 180, 270, 360])
    ax.set_xlabel("phase of the second robot (degrees)")
    ax.set_ylabel("mean velocity $V$ (mm/s)")
    ax.legend(loc="upper right", frameon=False, title="stiffness")
    ax.set_title("three springs")


def over_the_plane(ax: plt.Axes) -> None:
    """Mean velocity over phase and stiffness."""
    grid = ss.sweep(ss.presets.two_modules, phase=np.linspace(0.0, 2 * np.pi, 73), stiffness=np.geomspace(100.0, 1e4, 81))
    drawn = ax.pcolormesh(
        np.degrees(grid.phase), grid.stiffness, grid.mean_velocity.T * MILLI, cmap="viridis", shading="gouraud", rasterized=True
    )
    ax.figure.colorbar(drawn, ax=ax, label="mean velocity $V$ (mm/s)")
    ax.axhline(0.07207 * (65.4 * np.pi) ** 2 / 2, color="white", linewidth=0.8, linestyle=(0, (4, 2)))
    ax.set_yscale("log")
    ax.set_xticks([0, 90, 180, 270, 360])
    ax.set_xlabel("phase of the second robot (degrees)")
    ax.set_ylabel("stiffness $k$ (N/m)")
    ax.set_title("all springs")


def steps(ax: plt.Axes) -> None:
    """Positions of three masses over two periods of the wave."""
    worm = ss.presets.worm()
    run = ss.solve(worm, periods=12)
    t = np.linspace(10.0, 12.0, 800) * worm.period
    x = run.at(t)["x"]
    for i, (colour, dashes) in enumerate(zip(COLOURS[:3], DASHES, strict=False)):
        own = (x[:, i] - x[0, i]) * MILLI
        ax.plot(t - t[0], own, color=colour, linestyle=dashes, label=f"mass {i + 1}")
    ax.set_xlabel("time $t$ (s)")
    ax.set_ylabel("distance travelled (mm)")
    ax.legend(loc="upper left", frameon=False)
    ax.set_title("one of three always holds")


def by_frequency(ax: plt.Axes) -> None:
    """Mean velocity over the frequency of the wave, in amplitudes a period."""
    grid = ss.sweep(ss.presets.worm, frequency=np.linspace(0.25, 12.0, 95), mu_minus=[0.2, 0.3, 0.5])
    for mu, colour, dashes in zip(grid.mu_minus.values, COLOURS, DASHES, strict=False):
        ax.plot(
            grid.frequency,
            grid.mean_velocity.sel(mu_minus=mu) / (2e-3 * grid.frequency),
            color=colour,
            linestyle=dashes,
            label=rf"$\mu_-$ = {mu:g}",
        )
        holds = np.sqrt((mu - 0.2) * 9.81 / (1.5 * 2e-3)) / (2 * np.pi)
        if holds > 0:
            ax.plot(holds, 3.0, "o", color="white", markeredgecolor=colour, markersize=4)
    ax.axhline(3.0, color=INK, linewidth=0.5)
    ax.set_ylim(1.5, None)
    ax.set_xlabel("frequency of the wave (Hz)")
    ax.set_ylabel("amplitudes in a period $V/af$")
    ax.legend(loc="center right", frameon=False, bbox_to_anchor=(1.0, 0.36))
    ax.set_title("until inertia tears it loose")


if __name__ == "__main__":
    for name, (left, right) in {"two_robots": (by_phase, over_the_plane), "worm": (steps, by_frequency)}.items():
        with publication():
            figure, axes = plt.subplots(1, 2, figsize=(6.4, 2.5), layout="constrained")
            left(axes[0])
            right(axes[1])
            figure.savefig(IMAGES / f"{name}.png", dpi=200)
