"""The figure at the top of the README: one run under two laws, and five hundred amplitudes. Run: python examples/hero.py"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import stickslip as ss
from stickslip.show.figures.style import publication

TYPES = {"rest": "#999999", "II": "#56B4E9", "I": "#009E73", "III": "#E69F00", "IV": "#CC79A7"}


def curves(ax: plt.Axes) -> None:
    """Velocity of the rig at 1.7 degrees under LuGre and Coulomb friction."""
    runs = [ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law=law)) for law in ("coulomb-static", "lugre")]
    ss.plot.velocity(runs, periods=2, ax=ax, labels=["Coulomb", "LuGre"])


def speeds(ax: plt.Axes) -> None:
    """Mean velocity of 512 robots against amplitude; the Coulomb robot's motion type as colour."""
    amplitude = np.linspace(1e-4, 8e-4, 512)
    for law, style in (("coulomb-static", "-"), ("lugre", "--")):
        many = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=amplitude, law=law), settle="auto", periods=400)
        if law == "lugre":
            ax.plot(amplitude * 1e3, many.mean_velocity * 1e3, style, color="black", linewidth=0.9, label="LuGre")
            continue
        for name, colour in TYPES.items():
            there = np.where(many.motion_type == name, many.mean_velocity, np.nan)
            ax.plot(amplitude * 1e3, there * 1e3, color=colour, linewidth=3, label=name)
    ax.set_xlabel("amplitude $A$ (mm)")
    ax.set_ylabel("mean velocity $V$ (mm/s)")
    ax.set_xlim(0.1, 0.8)
    ax.legend(title="Coulomb, motion type", loc="upper left")


def main() -> None:
    """Draw both panels into docs/images/hero.png."""
    with publication():
        fig, (left, right) = plt.subplots(1, 2, figsize=(9.0, 3.4), layout="constrained")
        curves(left)
        speeds(right)
        path = Path(__file__).resolve().parents[1] / "docs" / "images" / "hero.png"
        fig.savefig(path, dpi=160)
        print(path)


if __name__ == "__main__":
    main()
