"""The moving picture of the README: the rig in slow motion, with its velocity and the friction. Run: python examples/moving_picture.py"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.patches import Rectangle

import stickslip as ss

PERIODS, FRAMES, FPS = 3, 72, 18
BODY, INNER, STICK = "#0072b2", "#d55e00", "#e8e8e8"
FILE = Path(__file__).resolve().parents[1] / "docs" / "images" / "robot.gif"


def draw(file=FILE):
    """Write the picture."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb")
    run = ss.solve(robot, periods=60)
    begin = run.t[-1] - PERIODS * robot.period
    t = begin + np.linspace(0.0, PERIODS * robot.period, FRAMES, endpoint=False)
    now = run.at(t)
    x, v, xi = 1e3 * (now["x"] - now["x"][0]), 1e3 * now["v"], 1e3 * robot.drive.position(t)
    ms = 1e3 * (t - begin)

    figure, (scene, curve) = plt.subplots(2, figsize=(6.4, 3.2), height_ratios=(1, 1.25), layout="constrained")
    scene.set(
        xlim=(-1.2, 1.4), ylim=(-0.1, 0.75), yticks=[], xlabel="position [mm]", title="Slow motion: a mass shaken inside a body on a track"
    )
    scene.axhline(0.0, color="0.3", lw=2)
    scene.axvline(0.0, color="0.6", lw=0.8, ls=":")
    box = scene.add_patch(Rectangle((0, 0.03), 1.5, 0.6, fc="none", ec=BODY, lw=2.5))
    mass = scene.add_patch(Rectangle((0, 0.18), 0.3, 0.3, fc=INNER))
    mark = scene.plot([0, 0], [0.03, 0.63], color=BODY, lw=1)[0]

    rest = v == 0.0
    curve.fill_between(ms, -12, 12, where=rest, color=STICK, label="sticks", lw=0)
    curve.axhline(0.0, color="0.6", lw=0.8)
    curve.plot(ms, v, color=BODY, lw=1, alpha=0.35)
    past = curve.plot([], [], color=BODY, lw=2)[0]
    dot = curve.plot([], [], "o", color=BODY, ms=6)[0]
    curve.set(xlim=(ms[0], ms[-1]), ylim=(1.15 * v.min(), 1.15 * v.max()), xlabel="time [ms]", ylabel="velocity [mm/s]")
    curve.legend(loc="upper right", frameon=False)

    def show(k):
        box.set_x(x[k] - 0.75)
        mass.set_x(x[k] + xi[k] - 0.15)
        mark.set_xdata([x[k], x[k]])
        box.set_facecolor(STICK if rest[k] else "none")
        past.set_data(ms[: k + 1], v[: k + 1])
        dot.set_data([ms[k]], [v[k]])

    FuncAnimation(figure, show, frames=FRAMES, interval=1000 / FPS).save(file, PillowWriter(fps=FPS), dpi=110)
    plt.close(figure)


if __name__ == "__main__":
    draw()
