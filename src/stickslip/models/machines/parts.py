"""The parts of a machine: bodies, contacts, links and stops. Their numbers may be floats, arrays, or symbols while equations are traced."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import Frozen
from stickslip.basics.maths import maximum, minimum, pi, where
from stickslip.basics.quantities import DAMPING, LENGTH, MASS, STIFFNESS, Rule, at_least, between, holding, positive, quantity
from stickslip.models.drives.drive_adapter import lacking
from stickslip.models.drives.shifted import Shifted, within_one
from stickslip.models.instant_forces import arguments_of_load
from stickslip.models.links_in_time import lacks_motion, motion_of, takes_arguments


@dataclass(frozen=True, eq=False)
class Body(Frozen):
    """One body of a machine, which moves along the track (or about the axis: then read rad, kg m^2 and N m).

    Parameters
    ----------
    mass : float
        Total mass that moves with it [kg].
    force : float or callable, optional
        Applied force, all but links and friction [N]: a number, or a function of time [s], its position [m] and its velocity [m/s].
    position : float, optional
        Initial position [m], unless a run specifies another one.
    jumps : tuple of (instant, jump), optional
        Known jumps of its velocity: instants in [0, period) [s] and what is added to the velocity there [m/s].
    breaks : tuple of float, optional
        Instants in (0, period) at which the force is not smooth [s]; conditions on time that are written with
        `stickslip.maths.where` are found without being named.
    gravity : float or callable, optional
        The part of the applied force that is due to gravity, in the form of `force` [N]; `stickslip.energy` counts its work apart from that
        of the drive. Of machines with `places`, where weights are known, it is not used.
    inertia : float, optional
        Moment of inertia about its place [kg m^2], of machines whose `places` give an angle too. There `force` may give a tuple: along x,
        along z, and a torque.

    Examples
    --------
    >>> head = Body(mass=0.072, force=lambda t, x, v: -0.3 * v)
    >>> head.applied(t=0.0, x=0.0, v=0.1), Body(mass=1.0, force=2.0).applied(0.0, 0.0, 0.0)
    (-0.03, 2.0)
    """

    mass: float = field(metadata=MASS)
    force: Any = 0.0
    position: float = field(default=0.0, metadata=quantity("position at the start", "m", "x_{0}", example=0.0))
    jumps: Any = ()
    breaks: Any = ()
    gravity: Any = 0.0
    inertia: float = field(default=0.0, metadata=quantity("moment of inertia", "kg m^2", "J", example=0.0, rule=at_least(0.0)))

    def applied(self, t: Numeric, x: Numeric, v: Numeric) -> Any:
        """Applied force, with gravity [N]."""
        return _value_of(self.force, t, x, v)

    def weight_at(self, t: Numeric, x: Numeric, v: Numeric) -> Any:
        """The part of it that is due to gravity [N]."""
        return _value_of(self.gravity, t, x, v)


def _value_of(force: Numeric, t: Numeric, x: Numeric, v: Numeric) -> Any:
    """A number, or what a function says."""
    return force(t, x, v) if callable(force) else force


@dataclass(frozen=True, eq=False)
class Contact(Frozen):
    """A contact of a body with the track, with another body, or with a surface whose motion is prescribed.

    Parameters
    ----------
    body : str or mapping
        Name of the body; or coefficients by name of a body, whose slip is the sum of coefficients times velocities, as at a point of a
        body that is known by its modes, a lever or a gear. Each body then feels the friction force times its coefficient.
    friction : law
        Any friction law; it receives the slip velocity, that of the body minus that of the opposing surface.
    on : optional
        The opposing surface: the track if not given; the name of another body; the speed of a belt [m/s]; a motion, which has
        `position(t)`, `velocity(t)` and `acceleration(t)` as every drive has; or with `hold` the height of the ground as a function of x,
        ``on=lambda x: 0.1 * x``, an incline or a curve.
    load : float or callable, optional
        Normal force [N], never negative: a number, or a function of time [s]; of time and position of the body [m]; of these and of its
        velocity [m/s]; or of these and the forces of the instant [N]: ``lambda t, x, v, forces: 1.0 + 0.1 * abs(forces["motor"])``. With
        three or four arguments x and v are numbers of the body itself and give those of others by name, ``x["tail"]``. In `forces` stand
        what is applied to each body by the body's name, named forces, controllers, ``"gravity"``, and the tensions of links and elastic
        stops (`stickslip.models.instant_forces.InstantForces`); friction of the same instant does not. At rest the limit forwards is that
        of the load of a body about to move forwards, and so backwards. Of a contact with coefficients
        x and v are sums with the positions and velocities, and there a load has to be given. Without `load`, the weight of the body where
        gravity is the machine's `gravity`, or 9.81 m/s^2.
    restitution : float, optional
        Coefficient of restitution, from 0 to below 1: the body takes off when the load falls to zero, and lands again. This must be its
        only contact, and not with another body. If not given, and under a law with inner states, a run ends when the load falls to zero.

    at : tuple of float, optional
        The point of the body in its own axes, from its place [m], where `places` gives an angle.
    hold : optional
        "both": a rail that holds the body on both sides, so that it slips along the way that its one coordinate leaves it, or along x.
        "push": ground, at z = 0 if `on` says no other, that pushes the point and does not pull it; where the load falls to zero a run
        ends, or with `restitution` the point takes off and lands again. The load follows from the motion in both cases. For machines
        with `places`.

    Examples
    --------
    >>> import stickslip as ss
    >>> foot = Contact("head", ss.Coulomb(mu_plus=0.15, mu_minus=0.21), load=0.7)
    >>> foot.normal(t=0.0, x=0.0)
    0.7
    >>> bow = Contact({"mode 1": 0.59, "mode 2": 0.95}, ss.Coulomb(mu_plus=0.3, mu_minus=0.3), on=0.1, load=1.0)
    >>> bow.coefficients
    {'mode 1': 0.59, 'mode 2': 0.95}
    """

    body: Any
    friction: Any
    on: Any = None
    load: Any = None
    restitution: Any = None
    at: Any = None
    hold: Any = None

    @property
    def coefficients(self) -> dict[str, Any]:
        """What its slip takes of each body's velocity, without what it rubs on that is no body."""
        if not isinstance(self.body, Mapping):
            return {self.body: 1.0, **({self.on: -1.0} if isinstance(self.on, str) else {})}
        return {name: g for name, g in self.body.items() if not (isinstance(g, (int, float)) and g == 0)}

    def normal(self, t: Numeric, x: Numeric) -> Any:
        """Normal force [N], of a load that is a number or a function of time and position."""
        if not callable(self.load):
            return self.load
        return self.load(t) if self._load_takes == 1 else self.load(t, x)

    @cached_property
    def _load_takes(self) -> int | None:
        """How many arguments the load takes."""
        return arguments_of_load(self.load)


@dataclass(frozen=True, eq=False)
class Spring(Frozen):
    """A spring with a parallel damper, between two bodies or a body and the ground.

    Parameters
    ----------
    stiffness : float
        [N/m]; 0 is a damper alone.
    damping : float, optional
        [N s/m].
    length : float, optional
        Distance at which it is relaxed, from the second body to the first [m].
    cubic : float, optional
        Coefficient of the third power of its extension [N/m^3]: positive hardens, negative softens. Zero if left out.
    clearance : float, optional
        Play [m]: the spring acts where the distance differs from `length` by more than half of it. Zero if left out.

    Examples
    --------
    >>> Spring(stiffness=1200.0, damping=0.4).force(distance=1e-3, rate=0.5)
    1.4
    >>> round(Spring(stiffness=1200.0, cubic=1e8).force(distance=2e-3, rate=0.0), 9)
    3.2
    >>> play = Spring(stiffness=1000.0, clearance=2e-3)
    >>> [round(play.force(distance=d, rate=0.0), 9) for d in (0.5e-3, 3e-3, -3e-3)]
    [0.0, 2.0, -2.0]
    """

    stiffness: float = field(metadata=STIFFNESS)
    damping: float = field(default=0.0, metadata=DAMPING)
    length: float = field(default=0.0, metadata=LENGTH)
    cubic: float | None = field(default=None, metadata=quantity("cubic stiffness", "N/m^3", "k_{3}", example=1e8))
    clearance: float | None = field(default=None, metadata=quantity("play of the spring", "m", "p", example=1e-3, rule=at_least(0.0)))

    def force(self, distance: Numeric, rate: Numeric) -> Any:
        """Tension [N]: how strongly it pulls the two together, from their distance [m] and its rate [m/s]. The damper has no play."""
        extension = self._extension(distance)
        force = self.stiffness * extension + self.damping * rate
        return force if self.cubic is None else force + self.cubic * (extension * extension * extension)

    def _extension(self, distance: Numeric) -> Any:
        """How much longer it is than relaxed, beyond its play [m]."""
        longer = distance - self.length
        if self.clearance is None:
            return longer
        play = 0.5 * self.clearance
        return maximum(longer - play, 0.0) + minimum(longer + play, 0.0)


@dataclass(frozen=True, eq=False)
class Link(Frozen):
    """A link that sees time: its force is a function of it, or it prescribes a distance that is.

    Parameters
    ----------
    force : callable, optional
        Tension [N], how strongly it pulls the two together, as a function of time [s], their distance [m] and its rate [m/s]. Give this,
        or `distance`.
    distance : callable, optional
        The distance from the second body to the first as a function of time [m], which they keep exactly; at t = 0 it is that of the
        bodies' `position`. Its rates are derivatives, so write it with functions from `stickslip.maths`.
    breaks : tuple of float, optional
        Instants in (0, period) at which it is not smooth [s]; conditions on time in a force that are written with `stickslip.maths.where`
        are found without being named.

    Examples
    --------
    >>> from stickslip.maths import cos, sin
    >>> mesh = Link(force=lambda t, distance, rate: 1e4 * (1.0 + 0.2 * cos(300.0 * t)) * distance + 3.0 * rate)
    >>> mesh.force(0.0, 1e-3, 0.0)
    12.0
    >>> leg = Link(distance=lambda t: 0.02 + 0.002 * sin(3.0 * t))
    >>> leg.position(0.0), leg.velocity(0.0)
    (0.0, 0.006)
    """

    force: Any = None
    distance: Any = None
    breaks: Any = None

    def _check(self, problems: Problems) -> None:
        for what, takes in (("force", ("t", "distance", "rate")), ("distance", ("t",))):
            given, other = (getattr(self, name) for name in ((what, "distance") if what == "force" else (what, "force")))
            if given is None and other is None:
                problems.add(
                    f"{what} = None and so is the other; allowed is force or distance; type force=lambda t, distance, rate: 1e3 * distance"
                )
                return
            if given is not None and (other is not None or not takes_arguments(given, takes)):
                allowed = f"a function of {', '.join(takes)}" if other is None else "one of force and distance"
                problems.add(f"{what} = {given!r}; allowed is {allowed}; type {what}=lambda {', '.join(takes)}: ...")
                return

    def position(self, t: Numeric) -> Any:
        """Change of a prescribed distance since the start [m]."""
        return self.distance(t) - self.distance(0.0)

    def velocity(self, t: Numeric) -> Any:
        """Rate of a prescribed distance [m/s]."""
        return motion_of(self.distance).velocity(t)

    def acceleration(self, t: Numeric) -> Any:
        """Rate of that [m/s^2]."""
        return motion_of(self.distance).acceleration(t)


@dataclass(frozen=True, eq=False)
class Rigid(Frozen):
    """A rigid link: the two bodies move as one, each with its own contact.

    Examples
    --------
    >>> Rigid().velocity(t=0.3)
    0.0
    """

    def position(self, t: Numeric) -> Any:
        """Change of the distance since the start [m], and its rates."""
        return 0.0

    velocity = acceleration = position


@dataclass(frozen=True, eq=False)
class Gait(Frozen):
    r"""Links that prescribe the distances of a row of bodies: a wave that runs along it.

    .. math:: x_j - x_{j+1} = l + \xi(\omega t - (j-1)\,\lambda), \qquad j = 1, 2, \dots

    The distances follow their drive exactly; only the centre of mass moves freely.

    Parameters
    ----------
    drive : any drive
        Variation of the first distance.
    lag : float
        Phase lag of each distance behind the preceding one [rad]; if negative, the wave runs from tail to head.
    length : float, optional
        Distance about which it varies [m].

    Examples
    --------
    >>> import stickslip as ss
    >>> wave = Gait(ss.Harmonic(amplitude=2e-3, frequency=2.0), lag=2.0944, length=0.02)
    >>> round(wave.of_pair(0).position(0.125), 12), round(wave.of_pair(1).position(0.125 + 1 / 6), 6)
    (0.002, 0.002)
    """

    drive: Any = field(metadata=holding({"the inner mass": "the distance"}))
    lag: float = field(
        metadata=quantity(
            "lag of the wave", "rad", r"\delta", example=2.0944, rule=Rule(lambda x: abs(x) <= 2 * math.pi, "from -2 pi to 2 pi")
        )
    )
    length: float = field(default=0.0, metadata=LENGTH)

    def _check(self, problems: Problems) -> None:
        if lacking(self.drive):
            problems.add(f"drive = {self.drive!r}; allowed is a drive; type drive=ss.Harmonic(amplitude=2e-3, frequency=2.0)")

    def of_pair(self, j: int) -> Any:
        """The motion of one distance, counted from 0 at the head."""
        if j == 0:
            return self.drive
        return Shifted(self.drive, within_one(-j * self.lag / (2 * pi), j))


@dataclass(frozen=True, eq=False)
class Stop(Frozen):
    """A stop between two bodies, or a body and the ground: an instantaneous impact, or a stiff spring.

    Parameters
    ----------
    gap : float, optional
        Distance from the second body to the first at which they touch [m]. Give this, or `at`.
    restitution : float, optional
        Coefficient of restitution of an impact, from 0 to 1. Give this, or a stiffness.
    stiffness, damping : float, optional
        Of an elastic stop [N/m], [N s/m]; it pushes and never pulls.
    side : {1, -1}, optional
        1 where the distance must stay below `gap`, or below `at`; -1 where it must stay above -`gap`, or above `at`.
    at : callable or motion, optional
        Of a stop that moves the distance at which they touch [m]: a continuous function of time [s], of functions from `stickslip.maths`,
        whose rate is its derivative, or a motion with position, velocity and acceleration, as every drive is. A hit is relative to it.
    breaks : tuple of float, optional
        Instants in [0, period) at which that motion is not smooth [s], where its velocity may jump.

    Examples
    --------
    >>> wall = Stop(gap=0.01, stiffness=1e4)
    >>> wall.gap_left(distance=0.008), wall.force(distance=0.012, rate=0.0)
    (0.002, 20.0)
    >>> from stickslip.maths import sin
    >>> shaken = Stop(at=lambda t: 0.01 + 0.001 * sin(200.0 * t), restitution=0.5)
    >>> shaken.gap_left(distance=0.008, t=0.0), round(shaken.closes_at(rate=0.5, t=0.0), 9)
    (0.002, 0.3)
    """

    gap: float | None = field(default=None, metadata=quantity("gap of the stop", "m", r"\delta", example=0.01))
    restitution: float | None = field(default=None, metadata=quantity("restitution", "1", "e", example=0.5, rule=between(0.0, 1.0)))
    stiffness: float | None = field(default=None, metadata=quantity("stiffness of the stop", "N/m", "k", example=1e4, rule=positive))
    damping: float = field(default=0.0, metadata=DAMPING | {"label": "damping of the stop"})
    side: int = 1
    at: Any = None
    breaks: Any = None

    def _check(self, problems: Problems) -> None:
        if (self.gap is None) == (self.at is None):
            mistake = f"gap = {self.gap!r} and at = {self.at!r}; allowed is one of the two"
            problems.add(f"{mistake}; type gap=0.01 [m], or at=lambda t: 0.01 + 0.001 * sin(200.0 * t) for a stop that moves")
        elif self.at is not None and not callable(self.at) and (missing := lacks_motion(self.at)):
            problems.add(f"at = {self.at!r} {missing}; allowed is a function of time, or a motion; type at=lambda t: 0.01 + 0.001 * sin(t)")
        if (self.restitution is None) == (self.stiffness is None):
            mistake = f"restitution = {self.restitution!r} and stiffness = {self.stiffness!r}; allowed is one of the two"
            problems.add(f"{mistake}; type restitution=0.5 for hits that are over at once, or stiffness=1e4 [N/m] for an elastic stop")
        if self.side not in (1, -1):
            problems.add(f"side = {self.side!r}; allowed is 1 or -1; type side=-1 for a stop on the other side")

    @property
    def motion(self) -> Any:
        """What it does in time, with position, velocity and acceleration; None of one that does not move."""
        return None if self.at is None else motion_of(self.at)

    @property
    def instants(self) -> tuple[Any, ...]:
        """Instants at which its motion is not smooth [s]."""
        if self.at is None:
            return ()
        motion = self.motion
        return (
            *(self.breaks or ()),
            *(getattr(motion, "breaks", None) or ()),
            *(instant for instant, _ in getattr(motion, "jumps", None) or ()),
        )

    def pull(self, t: Numeric, distance: Numeric, rate: Numeric) -> Any:
        """The same as `force`, by time first, as of a link that sees time [N]."""
        return self.force(distance, rate, t)

    def reach(self, t: Numeric = 0.0) -> Any:
        """How far it is to the stop from distance zero, at an instant [m]."""
        return self.gap if self.at is None else self.side * self.motion.position(t)

    def gap_left(self, distance: Numeric, t: Numeric = 0.0) -> Any:
        """The remaining gap [m]; negative while an elastic stop is pressed."""
        return self.reach(t) - self.side * distance

    def closes_at(self, rate: Numeric, t: Numeric = 0.0) -> Any:
        """How fast the gap closes where the distance has a rate [m/s]."""
        return self.side * (rate if self.at is None else rate - self.motion.velocity(t))

    def force(self, distance: Numeric, rate: Numeric, t: Numeric = 0.0) -> Any:
        """Force of an elastic stop that keeps the two together as a tension does [N]; 0 while they do not touch."""
        depth = self.side * distance - self.reach(t)
        return where(depth > 0, self.side * maximum(self.stiffness * depth + self.damping * self.closes_at(rate, t), 0.0), 0.0)


#: The links by their names in a study file.
LINKS: dict[str, Any] = {"spring": Spring, "rigid": Rigid, "gait": Gait}
