"""The figure of the page on robots in the plane: a bristle-bot and a hopping robot. Run: python examples/planar.py"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import stickslip as ss
from stickslip.maths import cos, pi, sin
from stickslip.show.figures.style import COLOURS, INK, publication

GRAVITY = 9.81


@dataclass(frozen=True)
class Lubricated:
    """Friction that is proportional to the load and to the velocity."""

    mu: float

    def sliding(self, v, load):
        """The friction force [N]."""
        return self.mu * v * load

    def breakaway(self, load):
        """Nothing is held at rest [N]."""
        return 0.0 * load, 0.0 * load


@dataclass(frozen=True, eq=False)
class BristleBot(ss.Machine):
    """A body on tilted bristles without mass, which is shaken up and down."""

    mass: float
    length: float
    tilt: float
    stiffness: float
    damping: float
    force: float
    omega: float
    friction: Any
    coordinates = ("x", "bend")

    @property
    def period(self):
        """That of the force [s]."""
        return 2 * pi / self.omega

    def bodies(self):
        return {"body": ss.Body(self.mass, force=lambda t, x, v: (0.0, self.force * sin(self.omega * t))), "tip": ss.Body(1e-9)}

    def places(self, t, q):
        angle = self.tilt + q["bend"]
        return {"body": (q["x"], self.length * cos(angle)), "tip": (q["x"] - self.length * sin(angle), 0.0)}

    def links(self):
        return {("bend", None): ss.Spring(self.stiffness, self.damping)}

    def contacts(self):
        return {"tip": ss.Contact("tip", self.friction, hold="both")}

    @property
    def at_rest(self):
        """The angle of its bristles at rest."""
        return self.tilt + brentq(lambda q: self.mass * GRAVITY * self.length * np.sin(self.tilt + q) - self.stiffness * q, 0.0, 1.0)

    @property
    def expanded(self):
        """Its mean velocity to second order in the force [m/s], from the linear equations of the angle."""
        N, L, w, mu = self.mass * GRAVITY, self.length, self.omega, self.friction.mu
        s, c, K = np.sin(self.at_rest), np.cos(self.at_rest), self.stiffness - self.mass * GRAVITY * self.length * np.cos(self.at_rest)
        slip = L * c * w**2 * self.mass / (1j * w * self.mass + mu * N)
        angle = self.force * L * s / (K + 1j * w * self.damping - self.mass * (L * s * w) ** 2 - mu * N * L * c * slip)
        lost = 2 * N * s * ((w * self.mass) ** 2 + (mu * N) ** 2)
        return abs(angle) ** 2 * w**2 * self.mass * c / lost * (w**2 * self.mass * (self.damping + mu * N * (L * c) ** 2) - K * mu * N)

    @property
    def reversal(self):
        """The frequency at which that is zero [rad/s]."""
        N, arm = self.mass * GRAVITY, self.length * np.cos(self.at_rest)
        pressed = self.friction.mu * N
        return np.sqrt((self.stiffness - N * arm) * pressed / (self.mass * (self.damping + pressed * arm**2)))


@dataclass(frozen=True, eq=False)
class HoppingRobot(ss.Machine):
    """A box with an unbalanced rotor, whose force is `ratio` of its weight."""

    mass: float
    ratio: float
    omega: float
    friction: Any
    restitution: float
    coordinates = ("x", "z")

    @property
    def period(self):
        """That of the rotor [s]."""
        return 2 * pi / self.omega

    def bodies(self):
        size, w = self.ratio * self.mass * GRAVITY, self.omega
        return {"box": ss.Body(self.mass, force=lambda t, x, v: (size * cos(w * t), size * sin(w * t)))}

    def places(self, t, q):
        return {"box": (q["x"], q["z"])}

    def contacts(self):
        return {"foot": ss.Contact("box", self.friction, hold="push", restitution=self.restitution)}


BOT = BristleBot(0.02, 0.01, 0.4, 0.015, 2e-5, 0.005, 100.0, Lubricated(1.0))


if __name__ == "__main__":
    with publication():
        figure, (left, right) = plt.subplots(1, 2, figsize=(6.4, 2.4), layout="constrained")
        smooth, dots = (np.linspace(20.0, 120.0, count) for count in (300, 15))
        left.plot(smooth, [1e6 * BOT.replace({"omega": w}).expanded for w in smooth], color=INK, linewidth=0.9)
        orbits = [ss.periodic_orbit(BOT.replace({"omega": w})) for w in dots]
        left.plot(dots, [1e6 * orbit.mean_velocity for orbit in orbits], "o", color=COLOURS[0], markersize=3.5)
        left.axhline(0.0, color=INK, linewidth=0.6)
        left.axvline(BOT.reversal, color=INK, linewidth=0.8, linestyle=":")
        left.set_xlabel("frequency $\\omega$ (rad/s)")
        left.set_ylabel("mean velocity $V$ (µm/s)")
        for k, restitution in enumerate((0.0, 0.3)):
            robot = HoppingRobot(0.2, 1.8, 60.0, ss.Coulomb(0.2, 0.2), restitution)
            run = ss.solve(robot, periods=60)
            at = run.at(np.linspace(57 * robot.period, 60 * robot.period, 1500))
            right.plot((at["t"] / robot.period) - 57, 1e3 * at["x"][:, 1], color=COLOURS[k], label=f"e = {restitution:g}")
        right.set_xlabel("turns of the rotor")
        right.set_ylabel("height (mm)")
        right.set_ylim(top=6.0)
        right.legend(loc="upper center", ncols=2)
        figure.savefig(Path(__file__).parents[1] / "docs" / "images" / "planar.png", dpi=200)
