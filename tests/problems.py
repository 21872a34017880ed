"""Problems with known answers. Every number is derived twice, by two methods (see docs/truth.md for how)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import stickslip as ss
from stickslip.maths import cos, sin, where, within

#: LuGre runs of the paper's rig from rest, mean velocity over periods 100 to 200 [m/s]: name -> (preset arguments, V).
#: P5 never slides. P10 is the true incline with isotropic LuGre.
LUGRE = {
    "P1": (dict(tilt_deg=1.7, amplitude=0.5525e-3), 0.001741322),
    "P2": (dict(tilt_deg=2.7, amplitude=0.6032e-3), 0.003681683),
    "P3": (dict(tilt_deg=4.7, amplitude=0.4564e-3), 0.003695830),
    "P4": (dict(tilt_deg=5.7, amplitude=1.487e-3), 0.028110215),
    "P6 3e-4": (dict(tilt_deg=1.7, amplitude=3e-4), 0.0000195318880),
    "P6 4e-4": (dict(tilt_deg=1.7, amplitude=4e-4), 0.000683535),
    "P6 5e-4": (dict(tilt_deg=1.7, amplitude=5e-4), 0.001500794),
    "P6 6e-4": (dict(tilt_deg=1.7, amplitude=6e-4), 0.002344920),
    "P6 8e-4": (dict(tilt_deg=1.7, amplitude=8e-4), 0.004280813),
    "P7 30": (dict(tilt_deg=1.7, amplitude=6e-4, omega=30 * math.pi), 1.02210871e-7),
    "P7 46": (dict(tilt_deg=1.7, amplitude=6e-4, omega=46 * math.pi), 1.11589088e-5),
    "P7 52": (dict(tilt_deg=1.7, amplitude=6e-4, omega=52 * math.pi), 5.526111e-4),
    "P7 65": (dict(tilt_deg=1.7, amplitude=6e-4, omega=65 * math.pi), 2.268605e-3),
    "P7 80": (dict(tilt_deg=1.7, amplitude=6e-4, omega=80 * math.pi), 4.156988e-3),
    "P8 .03": (dict(tilt_deg=1.7, amplitude=6e-4, mu0=0.03), 0.012385126),
    "P8 .04": (dict(tilt_deg=1.7, amplitude=6e-4, mu0=0.04), 0.011746793),
    "P8 .05": (dict(tilt_deg=1.7, amplitude=6e-4, mu0=0.05), 0.011252310),
    "P8 .10": (dict(tilt_deg=1.7, amplitude=6e-4, mu0=0.10), 0.006013796),
    "P8 .21": (dict(tilt_deg=1.7, amplitude=6e-4, mu0=0.21), 0.001597403),
    "P10 1.7": (dict(tilt_deg=1.7, amplitude=0.553e-3, incline="gravity"), 0.001871385),
    "P10 2.7": (dict(tilt_deg=2.7, amplitude=0.6032e-3, incline="gravity"), 0.003888559),
    "P10 4.7": (dict(tilt_deg=4.7, amplitude=0.4564e-3, incline="gravity"), 0.003852650),
    "P10 5.7": (dict(tilt_deg=5.7, amplitude=1.487e-3, incline="gravity"), 0.028674381),
}


def lugre(name: str) -> ss.Robot:
    """The robot of a row of `LUGRE`."""
    return ss.presets.piezo_rig(**LUGRE[name][0])


def velocity_unit(robot: ss.Robot) -> float:
    """A mu omega, the velocity of the body if there were no friction [m/s]."""
    return float(robot.velocity_scale * robot.mass_ratio)


def paper_batch(count: int = 512, mu0: float = 0.18) -> ss.Robot:
    """The paper's rig at many amplitudes."""
    import numpy as np

    return ss.presets.piezo_rig(tilt_deg=1.7, amplitude=np.linspace(4e-4, 8e-4, count), mu0=mu0)


def random_robots(count: int, seed: int = 1) -> ss.Robot:
    """Robots two decades wide around the paper's in every number: masses, A, omega, mu, f, sigma, v_s."""
    import numpy as np

    rng = np.random.default_rng(seed)

    def wide(middle: float) -> np.ndarray:
        return middle * 10 ** rng.uniform(-1, 1, count)

    total = wide(72.07e-3)
    inner = total * np.minimum(0.131539 * 10 ** rng.uniform(-1, 1, count), 0.9)
    mu, skew, rise = wide(0.18), 1 + wide(0.4), 1 + wide(0.17)
    law = ss.LuGre(mu, mu * skew, mu * rise, mu * skew * rise, sigma0=wide(4e5), sigma1=wide(100.0), sigma2=wide(0.04), v_s=wide(2e-3))
    return ss.Robot(total - inner, inner, ss.Harmonic(amplitude=wide(5e-4), omega=wide(205.46)), law)


# machines of several bodies, contacts and stops -------------------------------------------------------------------
# Numbers from two independent solvers: arcs by matrix exponentials with enumerated modes, and Taylor series of order 16.

BODY, INNER, LOW, HIGH = 0.06259, 0.00948, ss.Coulomb(0.15, 0.21), ss.Coulomb(0.2, 0.35)


def module(friction: object = LOW, amplitude: float = 6e-4, body: float = BODY, **more: object) -> ss.Robot:
    """A shaken module of a chain."""
    return ss.Robot(body, INNER, ss.Harmonic(amplitude=amplitude, omega=65.4 * math.pi), friction, **more)


def chain(*phases: float, modules: tuple[ss.Robot, ...] | None = None, link: object = None) -> ss.Chain:
    """Modules in a row, joined by springs of 1200 N/m."""
    own = (module(),) * len(phases) if modules is None else modules
    return ss.Chain(own, link=ss.Spring(stiffness=1200.0, damping=0.4) if link is None else link, phases=phases)


@dataclass(frozen=True)
class Wave:
    """A distance that goes as mean + amplitude f(omega t - phase), f a sine or two cosines."""

    amplitude: float
    omega: float
    phase: float
    shape: str = "sine"  # or "cosines"
    second: float = 0.35  # cos + second cos(2 . + .6)

    def _wave(self, t, derivative):
        angle = self.omega * t - self.phase
        if self.shape == "sine":
            return (sin(angle), cos(angle), -sin(angle))[derivative]
        twice = 2 * angle + 0.6
        shapes = (
            cos(angle) + self.second * cos(twice),
            -sin(angle) - 2 * self.second * sin(twice),
            -cos(angle) - 4 * self.second * cos(twice),
        )
        return shapes[derivative]

    def position(self, t):
        return self.amplitude * self._wave(t, 0)

    def velocity(self, t):
        return self.amplitude * self.omega * self._wave(t, 1)

    def acceleration(self, t):
        return self.amplitude * self.omega**2 * self._wave(t, 2)


@dataclass(frozen=True, eq=False)
class Worm(ss.Machine):
    """Three masses of 50 g whose distances are prescribed as a travelling wave; the middle one is a third of a wave behind the head."""

    mu_plus: float
    mu_minus: float
    frequency: float
    amplitude: float = 2e-3
    lag: float = 2 * math.pi / 3
    shape: str = "sine"

    @property
    def period(self):
        return 1 / self.frequency

    def bodies(self):
        return {name: ss.Body(0.05) for name in ("head", "middle", "tail")}

    def contacts(self):
        return {name: ss.Contact(name, ss.Coulomb(self.mu_plus, self.mu_minus)) for name in ("head", "middle", "tail")}

    def links(self):
        omega = 2 * math.pi * self.frequency
        first, last = (Wave(self.amplitude, omega, phase, self.shape) for phase in (0.0, self.lag))
        return {("head", "middle"): first, ("middle", "tail"): last}


@dataclass(frozen=True, eq=False)
class Capsule(ss.Machine):
    r"""An inner mass driven within a capsule, without dimensions, with a stop between them.

    .. math:: \ddot x_1 = \alpha\cos\omega t + (x_2-x_1) + 2\xi(\dot x_2-\dot x_1) - C, \quad
              \gamma\ddot x_2 = -(x_2-x_1) - 2\xi(\dot x_2-\dot x_1) + C - f(\dot x_2) - [\alpha\cos\omega t]
    """

    alpha: float
    omega: float
    gap: float
    mass: float
    damping: float = 0.05
    stiffness: float | None = None  # of the stop
    restitution: float | None = None
    reaction: float = 1.0  # 0: what drives the inner mass does not push the capsule back

    @property
    def period(self):
        return 2 * math.pi / self.omega

    def bodies(self):
        def force(t, x, v):
            return self.alpha * cos(self.omega * t)

        return {"inner": ss.Body(1.0, force=force), "capsule": ss.Body(self.mass, force=lambda t, x, v: -self.reaction * force(t, x, v))}

    def contacts(self):
        return {"capsule": ss.Contact("capsule", ss.Coulomb(1.0, 1.0), load=1.0)}

    def links(self):
        return {("inner", "capsule"): ss.Spring(1.0, damping=2 * self.damping)}

    def stops(self):
        return {("inner", "capsule"): ss.Stop(self.gap, restitution=self.restitution, stiffness=self.stiffness)}


CAPSULE_1 = Capsule(alpha=1.6, omega=0.95, gap=0.02, mass=5.0, stiffness=15.0, reaction=0.0)
CAPSULE_3 = Capsule(alpha=1.6, omega=0.95, gap=0.5, mass=4.0, restitution=0.6)
GRAZING = 1.0 / math.hypot(1 - 0.36, 2 * 0.05 * 0.6)  # amplitude of the inner mass of a capsule that rests
CAPSULE_7 = Capsule(1.0, 0.6, GRAZING - 1e-4, 4.0, restitution=0.6)


@dataclass(frozen=True, eq=False)
class Forced(ss.Machine):
    """A body with an inner mass on a spring, pushed apart by 1.5 sin + .75 cos 2, or by a pulse over .35 of the period."""

    damping: float
    pulse: float = 0.0
    waves: float = 1.0

    period = 0.06

    def bodies(self):
        return {"body": ss.Body(0.193, breaks=(0.35 * self.period,)), "inner": ss.Body(0.074)}

    def contacts(self):
        return {"body": ss.Contact("body", ss.Coulomb(0.29, 0.29), load=(0.193 + 0.074) * 9.81)}

    def links(self):
        return {("inner", "body"): ss.Spring(256.23, damping=self.damping)}

    def forces(self, t, x, v):
        omega = 2 * math.pi / self.period
        push = self.waves * (1.5 * sin(omega * t) + 0.75 * cos(2 * omega * t))
        push = push + where(within(t, self.period) < 0.35 * self.period, self.pulse, 0.0)
        return {"body": -push, "inner": push}


@dataclass(frozen=True, eq=False)
class ThreeBlocks(ss.Machine):
    """Unit masses in a row: springs of 1 between neighbours and to the wall, dampers of 1 to the ground, 10 cos(pi t) on the third."""

    period = 2.0

    def bodies(self):
        return {f"block {i}": ss.Body(1.0, force=self.push if i == 3 else 0.0) for i in (1, 2, 3)}

    def push(self, t, x, v):
        return 10 * cos(math.pi * t)

    def contacts(self):
        return {name: ss.Contact(name, ss.Coulomb(0.3, 0.3), load=1.0) for name in ("block 1", "block 2", "block 3")}

    def links(self):
        ground = {(f"block {i}", None): (ss.Spring(1.0, damping=1.0) if i == 1 else ss.Spring(0.0, damping=1.0)) for i in (1, 2, 3)}
        return {**ground, ("block 2", "block 1"): ss.Spring(1.0), ("block 3", "block 2"): ss.Spring(1.0)}


@dataclass(frozen=True, eq=False)
class Clutches(ss.Machine):
    r"""Four inertias in a row with three clutches, whose normal forces vary in time. Read rad, kg m^2 and N m.

    While all clutches hold, all inertias turn with the acceleration :math:`a = \sum T_i/\sum J_i`, and clutch k bears what the inertias
    before it leave over: :math:`C_k = \sum_{i\le k} (T_i - J_i a)`. While clutch 2 slips with the torque C of sliding and the others
    hold, it is the same for the two halves: the first has :math:`a = (T_1+T_2-C)/(J_1+J_2)` and the second
    :math:`a = (T_3+T_4+C)/(J_3+J_4)`. A clutch holds while :math:`|C_k| \le \mu N_k(t)`.
    """

    mu: float = 0.5
    drive: float = 2.0
    drag: float = 1.5
    omega: float = 2.0

    inertias = (1.0, 0.5, 0.8, 1.2)

    @property
    def period(self):
        return 2 * math.pi / self.omega

    def torques(self, t):
        """Applied torques."""
        return self.drive * sin(self.omega * t), 0.2, 0.0, -self.drag * sin(self.omega * t) - 0.1

    def load(self, k, t):
        """Normal force of a clutch."""
        return (3.0, 2.4, 3.2)[k] * (1.0 + 0.4 * cos(self.omega * t + (0.3, 1.9, 4.0)[k]))

    def bodies(self):
        return {f"disc {i}": ss.Body(J, force=lambda t, x, v, i=i: self.torques(t)[i]) for i, J in enumerate(self.inertias)}

    def contacts(self):
        law = ss.Coulomb(self.mu, self.mu)
        return {f"clutch {k}": ss.Contact(f"disc {k}", law, on=f"disc {k + 1}", load=lambda t, x, k=k: self.load(k, t)) for k in range(3)}


# Reference numbers: machine, periods until they hold, mean velocity, tolerance [m/s], events of the last period (phase, modes after it).
COUPLED = {  # machine, periods, V, tolerance [m/s], events of the last period: the phase, and the modes after it
    "M2b": (chain(0.0, math.pi / 2), 150, 0.002938713863365, 3e-14, [
        (0.1103776907, (1, 1)), (0.2661070734, (1, 0)), (0.2683576381, (1, -1)), (0.6133787840, (1, 0)), (0.6496800054, (-1, 0)),
        (0.7169518165, (-1, 1)),
    ]),
    "M2c": (chain(0.0, math.pi), 150, 0.011119895989126, 1e-13, [
        (0.0509880040, (1, 1)), (0.1343213373, (1, -1)), (0.5509880040, (1, 1)), (0.6343213373, (-1, 1)),
    ]),
    "M2g": (chain(0.0, 1.0, modules=(module(ss.Coulomb(0.18, 0.18)),) * 2), 150, 0.0, 1e-14, None),
    "M2j": (chain(0.0, -1.0, modules=(module(), module(HIGH, 5e-4, 0.08))), 150, 0.001331177341432,
            2e-14, None),
    "M2l": (chain(0.0, math.pi / 2, modules=(
        module(ss.Coulomb(0.18, 0.18), track=ss.Incline(tilt=math.radians(1.7))),) * 2), 150, 0.002903686864292, 3e-14, None),
    "M3a": (chain(0.0, math.pi / 2, math.pi), 150, 0.002622117520593, 3e-14, None),
    "M3c": (chain(0.0, -2 * math.pi / 3, -4 * math.pi / 3), 140, 0.0, 1e-14, None),
}  # fmt: skip

MASSES = {  # machine, periods, V, tolerance [m/s], phases of events
    "C1": (CAPSULE_1, 150, 0.165538436583, 1e-11, None),
    "C3": (CAPSULE_3, 120, 0.039424641879106, 2e-12, None),
    "C7": (CAPSULE_7, 150, 0.024995142088, 2e-12, None),
    "K1": (Forced(0.5), 250, 0.020420489041022, 2e-13, [(0.1362966471, (-1,)), (0.6362966471, (1,))]),
    "K3": (Forced(0.0, 1.25, waves=0.0), 400, -0.009192935806, 1e-12, None),
}

WORMS = {  # machine, mean velocity, tolerance [m/s]
    "P3a": (Worm(0.1, 0.3, frequency=2.0), 0.012, 1e-14),
    "P3b": (Worm(0.15, 0.25, frequency=6.0), 0.016577138514499, 2e-13),
    "P3d": (Worm(0.2, 0.2, frequency=6.0), 0.0, 1e-15),
    "P3e": (Worm(0.2, 0.2, frequency=5.0, shape="cosines"), 0.011084435192200, 1e-13),
    "P3e, reversed": (Worm(0.2, 0.2, frequency=5.0, shape="cosines", lag=-2 * math.pi / 3), -0.011084435192200, 1e-13),
}


# two blocks on a belt ------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Weakening:
    """Friction that weakens with the speed of the slip, N / (1 + 3 |w|)."""

    strength: float = 1.0
    rate: float = 3.0

    def sliding(self, v, load):
        return where(v > 0, 1.0, -1.0) * self.strength * load / (1 + self.rate * abs(v))

    def breakaway(self, load):
        return -self.strength * load, self.strength * load


@dataclass(frozen=True, eq=False)
class TwoBlocks(ss.Machine):
    """Two blocks on one belt, joined by a spring (Galvanetto and Bishop 1999)."""

    speed: float
    friction: Any
    time_scale = 2 * math.pi
    velocity_scale = 1.0

    def bodies(self):
        return {"a": ss.Body(1.0), "b": ss.Body(1.0)}

    def contacts(self):
        return {"a": ss.Contact("a", self.friction, on=self.speed, load=1.0), "b": ss.Contact("b", self.friction, on=self.speed, load=1.3)}

    def links(self):
        return {("a", None): ss.Spring(1.0), ("b", None): ss.Spring(1.0), ("a", "b"): ss.Spring(1.2)}
