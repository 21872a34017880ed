"""Dynamics: an orbit with multipliers against settling, a diagram against SciPy's, a user's machine against a robot, other packages.

    python benchmarks/dynamics.py [--rounds 3]

CPU seconds of one process on one pinned core, without compilation; compare ratios, and only within one run.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from time import process_time
from typing import Any

import numpy as np

import stickslip as ss
from dynamics_peers import peers
from stickslip.dynamics.stroboscopic.strobe_maps import strobe_map
from stickslip.maths import pi, sin

RIG = dict(tilt_deg=1.7, amplitude=6e-4)
SCIPY_POINTS, SETTLE, POINTS = 4, 100, 32


def clocked(work: Callable[[], Any], rounds: int) -> tuple[float, Any]:
    """Median CPU seconds, and what came out last."""
    times, found = [], work()
    for _ in range(rounds):
        begin = process_time()
        found = work()
        times.append(process_time() - begin)
    return median(times), found


def by_newton(robot: Any) -> tuple[Any, Any]:
    """The orbit and its multipliers."""
    orbit = ss.periodic_orbit(robot)
    return orbit.state, orbit.multipliers


def by_settling(robot: Any, tolerance: float = 1e-11) -> tuple[Any, Any]:
    """Run until the strobe point stands still to the same digits, then difference the map one start at a time."""
    state = np.zeros((1, 2))
    for _ in range(100_000):
        state, before = strobe_map(robot, state, 1, 1e-12).state, state
        if np.max(abs(state - before) / [1.6e-2, 4e-7]) < tolerance:
            break
    ends = [strobe_map(robot, state + shift, 1, 1e-12).state[0] for shift in ([1e-8, 0], [-1e-8, 0], [0, 4e-13], [0, -4e-13])]
    J = np.column_stack([(ends[0] - ends[1]) / 2e-8, (ends[2] - ends[3]) / 8e-13])
    return state[0], np.linalg.eigvals(J)


def diagram(values: Any) -> Any:
    """Our diagram of strobe points, all values in one batch."""
    return ss.bifurcation(
        ss.presets.piezo_rig, parameter="mu0", values=values, settle=SETTLE, points=POINTS, follow=False, rtol=1e-6, **RIG
    )


def scipy_diagram(values: Any) -> Any:
    """The same by SciPy's LSODA on the same equations, one value after the other."""
    kept = []
    for mu0 in values:
        robot = ss.presets.piezo_rig(mu0=float(mu0), **RIG)
        run = ss.solve(robot, periods=SETTLE + POINTS, method="lsoda", rtol=1e-6, keep="trajectory", samples=4)
        kept.append(run.strobe_v[-POINTS:])
    return np.array(kept)


@dataclass(frozen=True, eq=False)
class Slider(ss.Machine):
    """The robot as a machine of a user's own: a body that a shaken inner mass pushes over a track."""

    body: float
    inner: float
    amplitude: float
    omega: float
    friction: Any

    @property
    def period(self) -> Any:
        """One turn of the inner mass."""
        return 2 * pi / self.omega

    def bodies(self) -> dict[str, ss.Body]:
        """Both masses in one, pushed by the inner one."""
        size = self.inner * self.amplitude * self.omega**2
        return {"body": ss.Body(self.body + self.inner, force=lambda t, x, v: size * sin(self.omega * t))}

    def contacts(self) -> dict[str, ss.Contact]:
        """The track."""
        return {"track": ss.Contact("body", self.friction)}


OVER = {"amplitude": [3e-4, 4e-4, 5e-4, 6e-4, 7e-4, 8e-4], "mu0": [0.14, 0.16, 0.18, 0.2]}


def a_robot(amplitude: float, mu0: float) -> ss.Robot:
    """The rig under Coulomb's law."""
    return ss.presets.piezo_rig(amplitude=amplitude, mu0=mu0, tilt_deg=1.7, law="coulomb")


def a_slider(amplitude: float, mu0: float) -> Slider:
    """The same as a machine of a user's own."""
    robot: Any = a_robot(amplitude, mu0)
    return Slider(robot.body_mass, robot.inner_mass, amplitude, robot.drive.omega, robot.friction)


def atlases(rounds: int) -> None:
    """Print what an atlas of a user's machine costs, against that of the robot which it is."""
    for branches, what in ((0, "grid"), (6, "grid, branches and borders")):
        robot, _ = clocked(lambda b=branches: ss.atlas(a_robot, over=OVER, branches=b), rounds)
        own, _ = clocked(lambda b=branches: ss.atlas(a_slider, over=OVER, branches=b), rounds)
        print(f"atlas, 6 x 4 points, {what}: robot {robot:.2f} s, machine of a user's own {own:.2f} s, ratio {own / robot:.1f}")


def main() -> None:
    """Print the tables."""
    made = argparse.ArgumentParser(description=__doc__)
    made.add_argument("--rounds", type=int, default=3)
    rounds = made.parse_args().rounds
    print("orbit with multipliers, residual 1e-11      Newton [s]   settling [s]   ratio")
    for mu0 in (0.18, 0.06, 0.0475, 0.0469):
        robot = ss.presets.piezo_rig(mu0=mu0, **RIG)
        fast, (state, multipliers) = clocked(lambda robot=robot: by_newton(robot), rounds)
        slow, (other, _) = clocked(lambda robot=robot: by_settling(robot), 1)
        apart = float(np.max(abs(state - other) / [1.6e-2, 4e-7]))
        print(f"  mu0 = {mu0:<7} |multiplier| {abs(multipliers[0]):.3f}   {fast:18.3f} {slow:14.3f} {slow / fast:8.1f}   apart {apart:.0e}")
    values = np.linspace(0.034, 0.05, 1000)
    ours, _ = clocked(lambda: diagram(values), rounds)
    few = values[:: len(values) // SCIPY_POINTS][:SCIPY_POINTS]
    theirs, _ = clocked(lambda: scipy_diagram(few), 1)
    theirs *= len(values) / len(few)
    print(f"diagram, 1000 values x {SETTLE + POINTS} periods: ours {ours:.1f} s, scipy LSODA {theirs:.0f} s ({len(few)} values measured), "
          f"ratio {theirs / ours:.0f}")  # fmt: skip
    atlases(1)
    peers(rounds)


if __name__ == "__main__":
    main()
