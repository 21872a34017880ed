"""The figure of the page on capsules: impacts, direction by mass ratio, the jump at grazing. Run: python examples/capsules.py"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import stickslip as ss
from stickslip.show.figures.style import COLOURS, INK, publication

IMAGE = Path(__file__).parent.parent / "docs" / "images" / "capsule.png"


def capsule(amplitude: float, omega: float, gap: float) -> ss.Robot:
    """A capsule without dimensions whose stop throws the inner mass back, with the reaction of the force."""
    force = ss.HarmonicForce(amplitude, omega, phase=np.pi / 2)
    drive = ss.machines.Forced(force, stiffness=1.0, damping=0.1, stops=(ss.Stop(gap=gap, restitution=0.6),))
    return ss.Robot(body_mass=4.0, inner_mass=1.0, drive=drive, friction=ss.Coulomb(0.2, 0.2), gravity=1.0)


def impacts(ax: plt.Axes) -> None:
    """Velocities of both bodies over two periods."""
    robot = capsule(1.6, 0.95, 0.5)
    run = ss.solve(robot, periods=400)
    start = float(run.strobe_times[-3])
    shown = run.t >= start
    for name, colour in (("inner", COLOURS[1]), ("body", COLOURS[0])):
        ax.plot(run.t[shown] - start, run.bodies[name].v[shown], color=colour, label=name)
    for event in run.events:
        if event.kind == "hit" and event.t >= start:
            ax.axvline(event.t - start, color=INK, linewidth=0.5, linestyle=":")
    ax.set_xlabel(r"time $\tau$")
    ax.set_ylabel("velocity")
    ax.legend(loc="upper left", bbox_to_anchor=(0.12, 1.0))
    ax.set_title("two impacts in a period")


def direction(ax: plt.Axes) -> None:
    """Mean velocity against the mass ratio."""
    ratios = np.linspace(1.5, 9.0, 120)
    for omega, colour in ((0.85, COLOURS[2]), (0.95, COLOURS[0]), (1.05, COLOURS[1])):
        grid = ss.sweep(ss.presets.capsule, mass_ratio=ratios, omega=omega, periods=600)
        ax.plot(ratios, grid.mean_velocity, color=colour, label=rf"$\omega$ = {omega:g}")
    ax.axhline(0.0, color=INK, linewidth=0.5)
    ax.set_xlabel(r"mass ratio $\gamma$")
    ax.set_ylabel("mean velocity")
    ax.legend(loc="upper right")
    ax.set_title("direction by mass ratio")


def jump(ax: plt.Axes) -> None:
    """Mean velocity against the gap, from the swing in a capsule at rest and from the motion with impacts."""
    grazing = 1 / np.hypot(1 - 0.6**2, 0.1 * 0.6)
    gaps = np.linspace(1.55, 1.72, 69)
    orbit = ss.periodic_orbit(capsule(1.0, 0.6, 3.0))
    swing = {"x.inner": float(orbit.state[2]), "v.inner": float(orbit.state[1])}
    still, moving = [], []
    end: dict[str, dict[str, float]] = {}
    for gap in gaps:
        robot = capsule(1.0, 0.6, gap)
        still.append(ss.mean_velocity(ss.solve(robot, periods=300, start=started(swing))))
        run = ss.solve(robot, periods=300, start=end or None)
        x = float(run.strobe_x[-1])
        end = {
            "x": {"inner": float(run.bodies["inner"].strobe_x[-1]) - x},
            "v": {name: float(body.strobe_v[-1]) for name, body in run.bodies.items()},
        }
        moving.append(ss.mean_velocity(run))
    ax.plot(gaps, moving, color=COLOURS[1], label="followed with impacts")
    ax.plot(gaps, still, color=COLOURS[0], label="from the swing at rest")
    ax.axvline(grazing, color=INK, linewidth=0.5, linestyle=":")
    ax.set_xlabel(r"gap $\delta$")
    ax.set_ylabel("mean velocity")
    ax.legend(loc="center", bbox_to_anchor=(0.45, 0.5))
    ax.set_title("the jump at grazing")


def started(named: dict[str, float]) -> dict[str, dict[str, float]]:
    """A start by body from dotted names."""
    return {what: {name.partition(".")[2]: value for name, value in named.items() if name[0] == what} for what in ("x", "v")}


def main() -> None:
    """Draw the three."""
    with publication():
        _, axes = plt.subplots(1, 3, figsize=(10.0, 3.0), layout="constrained")
        for draw, ax in zip((impacts, direction, jump), axes, strict=True):
            draw(ax)
        plt.savefig(IMAGE, dpi=150)


if __name__ == "__main__":
    main()
