"""The paper's dimensionless form of the LuGre robot, Eqs 5.1 and 5.2, and its inverse."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from operator import attrgetter
from typing import Any, ClassVar

from stickslip.basics.arguments import explains_arguments
from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.fields import Frozen, everywhere
from stickslip.basics.maths import cos, exp, sin
from stickslip.basics.quantities import Rule, at_least, positive, quantity
from stickslip.models.drives import Harmonic
from stickslip.models.friction import LuGre
from stickslip.models.friction.sides import by_side, static
from stickslip.models.robot import Robot
from stickslip.models.tracks import Level

_SAME = 1e-9  # relative


@dataclass(frozen=True, eq=False)
class DimensionlessLuGre(Frozen):
    r"""The bristle of Eq. 5.1, in units of the amplitude and of the drive's phase.

    .. math:: \dot z = v - \frac{d\,|v|\,z}{1 + (k_1 - 1) e^{-(v/v_s)^2}} \;(v > 0), \qquad
              \dot z = v - \frac{d\,|v|\,z}{k_3 (1 + (k_2 - 1) e^{-(v/v_s)^2})} \;(v < 0)

    Parameters
    ----------
    a, b, c : float
        Stiffness sigma0/(omega^2 (M+m)), damping sigma1/(omega (M+m)) and viscous friction sigma2/(omega (M+m)) [-].
    d : float
        A sigma0/(mu_plus (M+m) g) [-].
    k1, k2, k3 : float
        Ratios f_plus/mu_plus, f_minus/mu_minus and mu_minus/mu_plus [-].
    v_s : float
        Stribeck velocity over A omega [-].

    Examples
    --------
    >>> law = DimensionlessLuGre(a=1.0, b=0.1, c=0.0, d=10.0, k1=1.2, k2=1.1, k3=1.4, v_s=0.02)
    >>> law.rate(v=0.0, z=0.05, load=1.0)
    0.0
    """

    a: float = field(metadata=quantity("bristle stiffness", "1", "a", example=50.0, rule=positive))
    b: float = field(metadata=quantity("bristle damping", "1", "b", example=5.0, rule=at_least(0.0)))
    c: float = field(metadata=quantity("viscous friction", "1", "c", example=1e-3, rule=at_least(0.0)))
    d: float = field(metadata=quantity("drive force over sliding friction", "1", "d", example=100.0, rule=positive))
    k1: float = field(metadata=quantity("static over kinetic friction forwards", "1", "k_{1}", example=1.2, rule=at_least(1.0)))
    k2: float = field(metadata=quantity("static over kinetic friction backwards", "1", "k_{2}", example=1.2, rule=at_least(1.0)))
    k3: float = field(metadata=quantity("friction backwards over forwards", "1", "k_{3}", example=1.4, rule=positive))
    v_s: float = field(metadata=quantity("Stribeck velocity", "1", "v_{s}", example=0.02, rule=positive))

    def coefficient(self, v: Numeric) -> Any:
        """Steady friction over mu_plus N (the denominators of Eq. 5.1)."""
        fade = exp(-((v / self.v_s) ** 2))
        return by_side(v, 1 + (self.k1 - 1) * fade, self.k3 * (1 + (self.k2 - 1) * fade))

    def rate(self, v: Numeric, z: Numeric | tuple[Numeric, ...], load: Numeric) -> Any:
        """dz/dt of Eq. 5.1; the load is 1."""
        return v - self.d * abs(v) * z / (load * self.coefficient(v))

    def force(self, v: Numeric, z: Any, zdot: Any, load: Numeric) -> Any:
        """The friction term that Eq. 5.1 subtracts from mu sin t."""
        return self.a * z + self.b * zdot + self.c * v

    def scale(self, load: Numeric) -> Any:
        """A typical deflection."""
        return 0.5 * (1 + self.k3) * load / self.d

    def velocity_scale(self) -> Any:
        """The velocity over which friction changes."""
        return self.v_s


@dataclass(frozen=True, eq=False)
class UnitDrive(Frozen):
    """xi/A = sin t, the drive of Eq. 5.1."""

    amplitude: ClassVar[float] = 1.0
    omega: ClassVar[float] = 1.0
    period: ClassVar[float] = 2 * math.pi

    def position(self, t: Numeric) -> Any:
        """Relative position over A."""
        return sin(t)

    def velocity(self, t: Numeric) -> Any:
        """Relative velocity over A omega."""
        return cos(t)

    def acceleration(self, t: Numeric) -> Any:
        """Relative acceleration over A omega^2."""
        return -sin(t)


@dataclass(frozen=True, eq=False)
class DimensionlessRobot(Frozen):
    r"""The robot of Eq. 5.1: :math:`\dot v = \mu \sin t - R(v, z)` with t, x, v, z in units of 1/omega, A, A omega, A.

    Parameters
    ----------
    mu : float
        Mass ratio m/(M+m) [-].
    friction : DimensionlessLuGre
        The bristle.

    Examples
    --------
    >>> import stickslip as ss
    >>> form = ss.analysis.dimensionless(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4))
    >>> round(form.friction.k3, 6)
    1.394880
    """

    mu: float = field(
        metadata=quantity("mass ratio", "1", r"\mu", example=0.13, rule=Rule(lambda x: (x > 0) * (x < 1) > 0, "between 0 and 1"))
    )
    friction: Any
    drive: Any = field(default_factory=UnitDrive)
    period: ClassVar[float] = 2 * math.pi
    velocity_scale: ClassVar[float] = 1.0
    total_mass: ClassVar[float] = 1.0
    notes: ClassVar[tuple[str, ...]] = ()
    inner_mass = free_velocity = property(attrgetter("mu"), doc="The mass ratio: also the inner mass and its free velocity.")

    def contact_velocity(self, v: Numeric) -> Any:
        """Velocity at the contact."""
        return v

    def load(self, t: Numeric, x: Numeric) -> Any:
        """1, as the unit of load, mu_plus (M+m) g, is contained in d."""
        return 1.0

    def acceleration(self, t: Numeric, x: Numeric, v: Numeric, R: Numeric) -> Any:
        """Second line of Eq. 5.1."""
        return -self.mu * self.drive.acceleration(t) - R

    def actuator_force(self, t: Numeric, acceleration: Numeric) -> Any:
        """Second line of Eq. 2.1 in these units."""
        return -self.mu * (acceleration + self.drive.acceleration(t))

    def robot(self, amplitude: Any, omega: Any, total_mass: Any, gravity: Any = 9.81) -> Robot:
        """The inverse: the robot in SI units with this dimensionless form, given its scales."""
        law = self.friction
        mu_plus = amplitude * law.a * omega**2 / (law.d * gravity)
        mu_minus = law.k3 * mu_plus
        friction = LuGre(
            mu_plus=mu_plus,
            mu_minus=mu_minus,
            f_plus=law.k1 * mu_plus,
            f_minus=law.k2 * mu_minus,
            sigma0=law.a * omega**2 * total_mass,
            sigma1=law.b * omega * total_mass,
            sigma2=law.c * omega * total_mass,
            v_s=law.v_s * amplitude * omega,
        )
        inner = self.mu * total_mass
        return Robot(total_mass - inner, inner, Harmonic(amplitude=amplitude, omega=omega), friction, gravity)


@explains_arguments
def dimensionless(robot: Robot) -> DimensionlessRobot:
    """The dimensionless form of a LuGre robot with a harmonic drive on a level (or folded) track: Eq. 5.1.

    Parameters
    ----------
    robot : Robot

    Returns
    -------
    DimensionlessRobot
        Solve it like a robot: velocities come out in units of A omega, times in units of 1/omega.

    Raises
    ------
    InputError
        If the law is not LuGre, the drive not harmonic, or gravity acts along the track: Eq. 5.1 has no such terms.

    Examples
    --------
    >>> import stickslip as ss
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)
    >>> back = ss.analysis.dimensionless(robot).robot(6e-4, robot.drive.omega, robot.total_mass)
    >>> bool(abs(back.friction.v_s - 2e-3) < 1e-15)
    True
    """
    problems = Problems("dimensionless")
    for name, part, kind in (("friction", robot.friction, LuGre), ("drive", robot.drive, Harmonic), ("track", robot.track, Level)):
        if not isinstance(part, kind):
            problems.add(f"{name} is a {type(part).__name__}; Eq. 5.1 is written for {kind.__name__}")
    problems.check()
    if not everywhere(robot.drive.amplitude != 0):
        raise InputError("dimensionless", ["amplitude = 0 leaves nothing to measure lengths with; give a positive amplitude"])
    law, A, omega, mass = robot.friction, robot.drive.amplitude, robot.drive.omega, robot.total_mass
    k1, k2, k3 = static(law.f_plus, law.mu_plus) / law.mu_plus, static(law.f_minus, law.mu_minus) / law.mu_minus, law.mu_minus / law.mu_plus
    friction = DimensionlessLuGre(
        a=law.sigma0 / (omega**2 * mass),
        b=law.sigma1 / (omega * mass),
        c=law.sigma2 / (omega * mass),
        d=A * law.sigma0 / (law.mu_plus * mass * robot.gravity),
        k1=k1,
        k2=k2,
        k3=k3,
        v_s=law.v_s / (A * omega),
    )
    scaled = DimensionlessRobot(mu=robot.mass_ratio, friction=friction)
    if not _same_motion(robot, scaled):
        names = ", ".join(sorted({type(part).__name__ for part in (robot, law, robot.drive, robot.track)}))
        raise InputError("dimensionless", [f"the equations of {names} are not those of Eq. 5.1; allowed are LuGre's and Eq. 2.3"])
    return scaled


def _same_motion(robot: Any, scaled: DimensionlessRobot) -> bool:
    """Whether both give the same accelerations and bristle rates at a few states (a subclass may have changed either)."""
    A, omega, law, own = robot.drive.amplitude, robot.drive.omega, robot.friction, scaled.friction
    for turn, speed, share in ((0.4, 0.3, 0.2), (2.1, -0.7, 0.9), (3.3, 40.0, -0.6), (5.2, -25.0, -0.3)):
        t, v = turn / omega, speed * law.v_s
        load = robot.load(t, 0.0)
        z = share * robot.total_mass * robot.gravity * law.mu_plus / law.sigma0
        rate, w, q = law.rate(v, z, load), v / (A * omega), z / A
        own_rate = own.rate(w, q, 1.0)
        one = robot.acceleration(t, 0.0, v, law.force(v, z, rate, load)) / (A * omega**2)
        other = scaled.acceleration(turn, 0.0, w, own.force(w, q, own_rate, 1.0))
        for a, b, size in ((rate / (A * omega), own_rate, abs(w)), (one, other, scaled.mu + abs(other))):
            if not everywhere(abs(a - b) <= _SAME * (size + abs(a))):
                return False
    return True


def ratios(mu0: Any, f0: Any, tilt: Any) -> tuple[Any, Any, Any]:
    """k1, k2 and k3 of a folded incline from isotropic coefficients: Eq. 5.2 with the right k3.

    The paper prints k3 = (f0 + tan)/(mu0 - tan); from k3 = mu_minus/mu_plus follows (mu0 + tan)/(mu0 - tan).

    Examples
    --------
    >>> k1, k2, k3 = ratios(0.18, 0.21, math.radians(1.7))
    >>> round(k3, 6)
    1.394880
    """
    slope = sin(tilt) / cos(tilt)
    return (f0 - slope) / (mu0 - slope), (f0 + slope) / (mu0 + slope), (mu0 + slope) / (mu0 - slope)
