"""The figure of the page on joints: a servo that hunts, and one that does not. Run: python examples/joint.py"""

from pathlib import Path

import matplotlib.pyplot as plt

import stickslip as ss
from stickslip.show.figures.style import COLOURS, INK, publication

TIME = 16.0


def torque(run: ss.results.Trajectory) -> object:
    """What the motor gives, seen at the joint [N m]."""
    pid = run.model.control
    motor = pid.kp * (pid.target - run.x) + run.controllers["control"]["integral"] - pid.kd * run.v
    return run.model.gear_ratio * motor


def main() -> None:
    """Draw three panels into docs/images/joint.png."""
    with publication():
        fig, (angle, error, given) = plt.subplots(1, 3, figsize=(10.0, 2.9), layout="constrained")
        for static, name, colour in ((2.0, "static 2 × kinetic", COLOURS[0]), (1.0, "static = kinetic", COLOURS[1])):
            run = ss.solve(ss.presets.servo(static=static), duration=TIME)
            angle.plot(run.t, run.x, color=colour, label=name)
            error.plot(run.t, 1e3 * (0.5 - run.x), color=colour)
            given.plot(run.t, 1e3 * torque(run), color=colour)
        for level in (-100.0, 100.0):
            given.axhline(level, color=INK, linewidth=0.6, linestyle=(0, (2, 2)))
        given.text(0.3, 102.0, "break-away", fontsize=6.5, va="bottom")
        angle.axhline(0.5, color=INK, linewidth=0.6, linestyle=(0, (2, 2)))
        angle.legend(loc="lower right")
        error.set_ylim(-60.0, 60.0)
        given.set_ylim(-130.0, 130.0)
        for ax, label in ((angle, "angle $q$ (rad)"), (error, "error (mrad)"), (given, "torque of the motor at the joint (mN m)")):
            ax.set_xlabel("time $t$ (s)")
            ax.set_ylabel(label)
            ax.set_xlim(0.0, TIME)
        fig.savefig(Path(__file__).resolve().parents[1] / "docs" / "images" / "joint.png", dpi=160)


if __name__ == "__main__":
    main()
