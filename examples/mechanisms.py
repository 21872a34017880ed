"""The figure of the page on mechanisms: three benches beside what is known of them. Run: python examples/mechanisms.py"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import stickslip as ss
from stickslip.show.figures.style import COLOURS, INK, publication

STATIC = ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)
FALLING = ss.Stribeck(1.0, 1.0, f_plus=1.5, f_minus=1.5, v_s=0.1)


def pulled(ax: plt.Axes) -> None:
    """The force of the spring on a mass that sticks and slips, and the two friction levels."""
    run = ss.solve(ss.PulledMass(mass=1.0, stiffness=2.0, speed=0.1, friction=STATIC), duration=40.0)
    for level, name, where in ((1.5, "break-away", 8.9), (1.0, "sliding", 0.3)):
        ax.axhline(level, color=INK, linewidth=0.6, linestyle=(0, (2, 2)))
        ax.text(where, level, name, fontsize=6.5, va="bottom")
    ax.plot(run.t, 2.0 * (0.1 * run.t - run.x), color=COLOURS[0])
    ax.set_xlabel("time $t$ (s)")
    ax.set_ylabel("force of the spring (N)")
    ax.set_ylim(0.0, 1.7)
    ax.set_title("PulledMass")


def belt(ax: plt.Axes) -> None:
    """Two starts of a block on a belt whose friction falls with speed: both end on the same cycle."""
    bench = ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=FALLING)
    for start, colour in (({"x": 0.62, "v": 0.0}, COLOURS[4]), ({"x": 0.0, "v": 0.55}, COLOURS[1])):
        run = ss.solve(bench, duration=60.0, start=start)
        ax.plot(run.x, run.v, color=colour, linewidth=0.7)
        ax.plot(run.x[0], run.v[0], "o", color=colour, markersize=3)
    last = run.t > 48.0
    ax.plot(run.x[last], run.v[last], color=COLOURS[0], linewidth=1.6)
    ax.text(0.27, 0.115, "rides along", fontsize=6.5)
    ax.set_xlabel("position $x$ (m)")
    ax.set_ylabel("velocity $v$ (m/s)")
    ax.set_title("BlockOnBelt")


def oscillator(ax: plt.Axes) -> None:
    """Amplitude against frequency: simulated points on Den Hartog's curves."""
    fine = np.linspace(0.4, 1.8, 600)
    for ratio, colour in ((0.1, COLOURS[0]), (0.3, COLOURS[1]), (0.5, COLOURS[2])):
        ax.plot(fine, den_hartog(fine, ratio), color=colour, label=f"$\\mu N/F$ = {ratio}")
        for beta in (0.55, 0.7, 0.8, 1.25, 1.4, 1.6):
            bench = ss.ForcedOscillator(mass=1.0, stiffness=1.0, force=1.0, omega=beta, friction=ss.Coulomb(ratio, ratio))
            run = ss.solve(bench, periods=150)
            ax.plot(beta, run.x[run.t > 149 * run.period_time].max(), "o", color=colour, markersize=3.5, markeredgecolor="white")
    ax.set_xlabel("frequency $\\omega\\sqrt{m/k}$")
    ax.set_ylabel("amplitude $X k/F$")
    ax.set_ylim(0.0, 4.0)
    ax.legend(loc="upper right")
    ax.set_title("ForcedOscillator")


def den_hartog(beta: np.ndarray, ratio: float) -> np.ndarray:
    """Den Hartog 1930: amplitude of the motion without stops; NaN where the body stops."""
    damping = np.sin(np.pi / beta) / (beta * (1.0 + np.cos(np.pi / beta)))
    gain = 1.0 / (1.0 - beta**2)
    with np.errstate(invalid="ignore"):
        amplitude = np.sqrt(gain**2 - (ratio * damping) ** 2)
    steepest = np.array([_steepest(b) for b in beta])
    return np.where(amplitude >= ratio * steepest / beta**2, amplitude, np.nan)


def _steepest(beta: float) -> float:
    """Den Hartog's S: the largest of (beta sin(u/beta) + U beta^2 (cos u/beta - cos u)) / sin u over the half cycle."""
    u = np.linspace(1e-3, np.pi - 1e-3, 400)
    damping = np.sin(np.pi / beta) / (beta * (1.0 + np.cos(np.pi / beta)))
    return float(np.max((beta * np.sin(u / beta) + damping * beta**2 * (np.cos(u) - np.cos(u / beta))) / np.sin(u)))


def main() -> None:
    """Draw three panels into docs/images/mechanisms.png."""
    with publication():
        fig, (left, middle, right) = plt.subplots(1, 3, figsize=(10.0, 3.1), layout="constrained")
        pulled(left)
        belt(middle)
        oscillator(right)
        fig.savefig(Path(__file__).resolve().parents[1] / "docs" / "images" / "mechanisms.png", dpi=160)


if __name__ == "__main__":
    main()
