"""Python code that reproduces the page."""

from __future__ import annotations

from stickslip.basics.spelling import spelled
from stickslip.show.explorer.requests import State


def python(state: State) -> str:
    """The script for a state: its robot, the run, the figures of merit, the figure."""
    lines = ["import stickslip as ss", "", f"robot = {spelled(state.robot())}", "run = ss.solve(robot, periods=200, rtol=1e-4)"]
    lines += ['print(f"mean velocity {ss.mean_velocity(run):.6g} m/s")', "print(ss.motion(run))"]
    runs = ["run"]
    for law in state.also:
        lines += ["", f"{law} = ss.solve(robot.replace(friction={spelled(state.robot(law).friction, 1)}), periods=200, rtol=1e-4)"]
        runs.append(law)
    lines += ["", f"ss.plot.velocity([{', '.join(runs)}])", "ss.plot.phase(run)"]
    return "\n".join(lines) + "\n"
