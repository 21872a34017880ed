"""A drive whose inner mass moves by itself: a force pushes it, a spring holds it, stops end its way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from operator import attrgetter
from typing import Any, ClassVar

from stickslip.basics.contracts import Model, Numeric
from stickslip.basics.errors import OneContactNeeded, Problems
from stickslip.basics.fields import Frozen, everywhere
from stickslip.basics.quantities import DAMPING, STIFFNESS
from stickslip.models.drives import FORCES
from stickslip.models.drives.force import not_forces
from stickslip.models.drives.harmonic_force import HarmonicForce
from stickslip.models.machines.parts import Body, Contact, Spring, Stop

_STOP = "type stops=(ss.Stop(gap=0.01, restitution=0.5),)"


@dataclass(frozen=True, eq=False)
class Forced(Frozen):
    r"""A drive by force: the inner mass of the robot is a body of its own, on a spring and a damper inside the body.

    .. math::

        M\ddot x &= k s_r + c\dot s_r - C - F(t) - R + M g\sin\theta, \qquad s_r = s - x \\
        m\ddot s &= F(t) - k s_r - c\dot s_r + C + m g\sin\theta

    The force acts between the two, so the body feels its reaction; without `reaction` it acts from outside, like that of a magnet next
    to the track. C is the force of the stops. Unless a run specifies otherwise, the spring is relaxed at the start; the gaps of stops
    are measured from there.

    Parameters
    ----------
    force : HarmonicForce, Pulses, RecordedForce or any force
        F, forwards on the inner mass [N]; forces are added with +.
    stiffness : float, optional
        k of the spring between body and inner mass [N/m]; 0 is not a spring.
    damping : float, optional
        c of the parallel damper [N s/m].
    stops : tuple of Stop, optional
        Stops that limit the displacement of the inner mass: at `gap` ahead of its rest position or, with ``side=-1``, behind it.
    reaction : bool, optional
        Whether the body feels the reaction of the force.

    Examples
    --------
    >>> import stickslip as ss
    >>> drive = ss.machines.Forced(ss.HarmonicForce(amplitude=1.5, omega=104.7), stiffness=256.0, damping=0.5)
    >>> robot = ss.Robot(body_mass=0.193, inner_mass=0.074, drive=drive, friction=ss.Coulomb(mu_plus=0.2, mu_minus=0.3))
    >>> run = ss.solve(robot, periods=40)
    >>> run.x.shape == run.t.shape, list(run.bodies)
    (True, ['body', 'inner'])
    """

    force: Any
    stiffness: float = field(default=0.0, metadata=STIFFNESS | {"example": 256.0})
    damping: float = field(default=0.0, metadata=DAMPING)
    stops: Any = ()
    reaction: bool = True

    period = property(attrgetter("force.period"), doc="Period of the force [s].")
    part_kinds: ClassVar[dict[str, dict[str, Any]]] = {"force": FORCES, "stops": {"stop": Stop}}

    def __getattr__(self, name: str) -> Any:
        if name in ("position", "velocity", "acceleration"):
            mistake = f"Forced has no {name}, because the inner mass moves freely, and the robot has two bodies"
            allowed = "allowed are drives that prescribe its motion, such as ss.Harmonic"
            raise OneContactNeeded("Forced", [f"{mistake}; {allowed}; type ss.solve(robot).bodies['inner'] for its motion"])
        raise AttributeError(f"Forced has no {name!r}")

    def _check(self, problems: Problems) -> None:
        for sentence in not_forces({"force": self.force}):
            problems.add(sentence)
        if not isinstance(self.reaction, bool):
            problems.add(f"reaction = {self.reaction!r}; allowed is True or False")
        if isinstance(self.stops, tuple) and not isinstance(self.stops, Frozen) and all(isinstance(stop, Stop) for stop in self.stops):
            _check_stops(self.stops, problems)
        else:
            listed = "this is a list, and several stops are given as a tuple; " if isinstance(self.stops, list) else ""
            problems.add(f"stops = {self.stops!r}; {listed}allowed is a tuple of stops; {_STOP}")

    @property
    def breaks(self) -> Any:
        """Instants in (0, period) at which the force is not smooth [s]."""
        return tuple(getattr(self.force, "breaks", None) or ())

    @property
    def notes(self) -> tuple[str, ...]:
        """Remarks on the force."""
        return tuple(getattr(self.force, "notes", None) or ())

    def machine(self, robot: Model) -> BodyAndMass:
        """The equivalent machine of two bodies."""
        return BodyAndMass(robot)

    def mirrored(self) -> Forced:
        """The reversed drive."""
        stops = tuple(replace(stop, side=-stop.side) for stop in self.stops)
        return replace(self, force=self.force.mirrored(), stops=stops)

    @classmethod
    def example(cls) -> Forced:
        """The force and the spring of a capsubot."""
        return cls(HarmonicForce.example(), stiffness=256.0, damping=0.5)


class BodyAndMass:
    """A robot whose inner mass is driven by a force: two bodies, one of which rubs on the track.

    Parameters
    ----------
    robot : Robot
        With a drive that has a force, a stiffness, a damping, stops and a reaction.

    Examples
    --------
    >>> import stickslip as ss
    >>> parts = BodyAndMass(ss.Robot(0.2, 0.07, Forced.example(), ss.Coulomb(mu_plus=0.2, mu_minus=0.3)))
    >>> list(parts.bodies()), list(parts.contacts()), list(parts.links()), parts.principal
    (['body', 'inner'], ['contact'], [('inner', 'body')], 'body')
    """

    principal = "body"

    def __init__(self, robot: Any):
        self.robot, self.drive = robot, robot.drive
        self.period, self.breaks = self.drive.period, self.drive.breaks

    def bodies(self) -> Mapping[str, Any]:
        """The body, and the inner mass within it."""
        robot, force = self.robot, self.drive.force
        along = robot.track.along(robot.gravity)
        back = -1.0 if self.drive.reaction else 0.0

        def on_body(t: Numeric, x: Numeric, v: Numeric) -> Any:
            return back * force.at(t) + robot.body_mass * along if back else robot.body_mass * along

        def on_inner(t: Numeric, x: Numeric, v: Numeric) -> Any:
            return force.at(t) + robot.inner_mass * along

        return {
            "body": Body(robot.body_mass, force=on_body, gravity=robot.body_mass * along),
            "inner": Body(robot.inner_mass, force=on_inner, gravity=robot.inner_mass * along),
        }

    def contacts(self) -> Mapping[str, Any]:
        """That of the body, which bears both masses."""
        return {"contact": Contact("body", self.robot.friction, load=self.robot.load)}

    def controllers(self) -> dict[str, Any]:
        """None."""
        return {}

    def links(self) -> Mapping[Any, Any]:
        """Spring and damper."""
        return {("inner", "body"): Spring(self.drive.stiffness, self.drive.damping)}

    def stops(self) -> Mapping[Any, Any]:
        """The stops of the drive."""
        return {("inner", "body"): self.drive.stops} if self.drive.stops else {}

    def forces(self, t: Numeric, x: Numeric, v: Numeric) -> Mapping[str, Any]:
        """No others."""
        return {}


def _check_stops(stops: tuple[Stop, ...], problems: Problems) -> None:
    """Note stops that are hit at the start, that leave no way between them, or that are never reached."""
    for i, stop in enumerate(stops):
        if not everywhere(stop.reach() >= 0):
            mistake = f"stops[{i}].gap = {stop.reach()!r}: the inner mass would be beyond the stop where it begins"
            problems.add(f"{mistake}; allowed is zero or more [m]; type side=-1 for a stop behind it")
    for i, one in enumerate(stops):
        for j, other in enumerate(stops[:i]):
            if one.side != other.side and not everywhere(one.reach() + other.reach() > 0):
                problems.add(f"stops[{j}] and stops[{i}] leave no room between them; allowed is a gap of more than zero; type gap=0.01")
            if one.side == other.side and not _both_met(one, other):
                problems.add(
                    f"stops[{j}] and stops[{i}] are on one side, and the one behind a stop with restitution is never met; leave it out"
                )


def _both_met(one: Stop, other: Stop) -> bool:
    """Whether the farther of two stops on one side can be met: the nearer one is elastic."""
    if one.restitution is not None and other.restitution is not None:
        return False
    if one.restitution is None and other.restitution is None:
        return True
    hard, soft = (one, other) if one.restitution is not None else (other, one)
    return bool(everywhere(hard.reach() > soft.reach()))
