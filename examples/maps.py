"""The figure of the page on maps: motion types of two robots, and the speed of one. Run: python examples/maps.py"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import stickslip as ss
from stickslip.show.figures.style import publication


def main() -> None:
    """Draw three panels into docs/images/maps.png."""
    alpha = np.linspace(1.6 / 400, 1.6, 400)
    exact = ss.map(ss.presets.coulomb_robot, alpha_plus=alpha, alpha_minus=alpha)
    axes = {"amplitude": np.linspace(0.1e-3, 0.8e-3, 257), "omega": np.linspace(60, 300, 257)}
    rig = ss.map(ss.presets.piezo_rig, **axes, tilt_deg=1.7, law="lugre", workers=2)
    with publication():
        fig, (left, middle, right) = plt.subplots(1, 3, figsize=(10.0, 3.4), layout="constrained", width_ratios=(1, 1, 1.22))
        ss.plot.motion_map(exact, ax=left)
        ss.plot.motion_map(rig, borders="twin", ax=middle)
        ss.plot.velocity_map(rig, ax=right)
        fig.savefig(Path(__file__).resolve().parents[1] / "docs" / "images" / "maps.png", dpi=160)


if __name__ == "__main__":
    main()
