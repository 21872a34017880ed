"""A piezo beam through its first three resonances: tip amplitude and speed of the robot. Run: python examples/piezo_resonance.py"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import stickslip as ss
from stickslip.show.figures.style import COLOURS, publication

VOLTAGE, TILT = 60.0, 1.7
LAWS = (("coulomb", "Coulomb, exact", "-"), ("lugre", "LuGre", "--"))
BEAM = ss.drives.PiezoBeam()


def rig(frequency: np.ndarray, law: str = "coulomb") -> ss.Robot:
    """The robot at these frequencies, all at once."""
    return ss.presets.piezo_beam_rig(voltage=VOLTAGE, frequency=frequency, tilt_deg=TILT, beam=BEAM, law=law)


def amplitudes(ax: plt.Axes, resonances: np.ndarray) -> None:
    """Amplitude of the tip against frequency, and what it takes to slide."""
    f = np.unique(np.concatenate([np.geomspace(8, 2000, 1500), *(r * np.linspace(0.9, 1.1, 201) for r in resonances)]))
    robot = rig(f)
    needed = robot.friction.mu_plus * robot.gravity / (robot.mass_ratio * robot.drive.omega**2)
    ax.loglog(f, robot.drive.amplitude * 1e6, color=COLOURS[0], label=f"tip of the beam at {VOLTAGE:g} V")
    ax.loglog(f, needed * 1e6, color="0.45", linewidth=0.9, linestyle="--", label="least amplitude at which the body slides (Coulomb)")
    ax.fill_between(f, needed * 1e6, robot.drive.amplitude * 1e6, where=robot.drive.amplitude > needed, color=COLOURS[0], alpha=0.18)
    ax.set(xlabel="frequency (Hz)", ylabel="amplitude $A$ (µm)", xlim=(8, 2000), ylim=(3e-3, 1e4))
    ax.legend(loc="upper right")


def velocities(ax: plt.Axes, resonance: float, number: int) -> None:
    """Mean velocity near one resonance under two laws."""
    f = resonance * np.linspace(0.85, 1.15, 601)
    for (law, label, style), colour in zip(LAWS, COLOURS, strict=False):
        many = ss.solve(rig(f, law), settle="auto", periods=600)
        ax.plot(f, many.mean_velocity * 1e3, style, color=colour, label=label)
    ax.axvline(resonance, color="0.6", linewidth=0.6, linestyle=":", zorder=0)
    ax.set(xlabel="frequency (Hz)", title=f"resonance {number}: {resonance:.1f} Hz", xlim=(f[0], f[-1]))
    ax.set_ylim(bottom=0)
    ax.locator_params(nbins=5)


def main() -> None:
    """Draw everything into docs/images/piezo_resonance.png."""
    resonances = BEAM.frequencies(3)
    with publication():
        fig = plt.figure(figsize=(9.0, 5.2), layout="constrained")
        axes = fig.subplot_mosaic([["all"] * 3, ["1", "2", "3"]])
        amplitudes(axes["all"], resonances)
        for number, resonance in enumerate(resonances, start=1):
            velocities(axes[str(number)], float(resonance), number)
        axes["1"].set_ylabel("mean velocity $V$ (mm/s)")
        axes["1"].legend(loc="upper left")
        path = Path(__file__).resolve().parents[1] / "docs" / "images" / "piezo_resonance.png"
        fig.savefig(path, dpi=160)
        print(path)


if __name__ == "__main__":
    main()
