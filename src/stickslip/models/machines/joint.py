"""A joint of a robot: an inertia about an axis with friction, gravity, a gear with backlash, and a controller."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import everywhere, is_record
from stickslip.basics.maths import maximum, pi, sin, sqrt, where
from stickslip.basics.quantities import at_least, holding, positive, quantity
from stickslip.models.drives import FORCES
from stickslip.models.forces import check_law
from stickslip.models.friction.law_adapter import adapted
from stickslip.models.machines.machine import Machine
from stickslip.models.machines.parts import Body, Contact, Stop
from stickslip.models.machines.periodic_inputs import TakesInput, breaks_of, common_count, in_period, most_times
from stickslip.models.machines.periodic_record import PeriodicRecord
from stickslip.models.machines.pid import PID, Loop

STIFFNESS = 1e4  # of a gear that does not say its own: a small strain-wave gear [N m/rad]
_APPLIED = holding({"force on the inner mass": "torque", "the force": "the torque"}, {"N": "N m"})
_TORQUE = "a torque [N m], a force function of time with at(t) and period, or a record (times, torques) of one period"


@dataclass(frozen=True, eq=False)
class Joint(TakesInput, Machine):
    r"""A joint of a robot: an inertia about an axis under a torque, or under a controller, with friction.

    .. math:: J\ddot q = n\,\tau - G\sin q - R(\dot q, N), \qquad N = N_0 + \lambda\,|G\sin q|

    q [rad] is measured from the hanging position: gravity pulls back to q = 0 if `gravity_torque` is positive. The motor's torque
    :math:`\tau` is the sum of the applied torque and the controller's. With a motor inertia :math:`J_m` and a rigid gear J is :math:`J +
    n^2 J_m`. With an elastic gear motor and joint are two bodies,

    .. math:: n^2 J_m\ddot\vartheta = n\,\tau - T(\vartheta - q), \qquad J\ddot q = T(\vartheta - q) - G\sin q - R,

    where :math:`\vartheta` is the angle of the motor over the gear ratio, and T is zero in the backlash and
    :math:`k(|\vartheta - q| - b/2)`, with damping that never pulls, outside of it.

    Parameters
    ----------
    inertia : float
        Moment of inertia J on the side of the joint [kg m^2].
    friction : Coulomb or LuGre or any law
        Friction law of the joint. At the load 1, which is the default, its coefficients are torques [N m].
    torque : float, force or record, optional
        Applied torque at the motor [N m]: a number; an object with `at(t)` and a period, such as a force; or one period of a record, a pair
        of arrays (times, torques), which is kept as a sum of harmonics. It adds to that of the controller; none by default.
    gravity_torque : float, optional
        G = m g l [N m].
    gear_ratio : float, optional
        n, turns of the motor for each of the joint.
    backlash : float, optional
        Play b of the gear from end to end, at the joint [rad].
    control : PID, optional
        The controller.
    load : float, optional
        N_0, the factor of the friction coefficients.
    load_gain : float, optional
        How much the load grows with the torque of gravity, lambda [1/(N m)].
    motor_inertia : float, optional
        J_m, at the motor [kg m^2]. By default zero if the gear is rigid; if it is elastic the joint's inertia referred to the motor, J/n^2.
    gear_stiffness : float, optional
        k, at the joint [N m/rad]. By default the gear is rigid if it has no backlash, otherwise 1e4 N m/rad, as a small strain-wave gear
        has.
    gear_damping : float, optional
        [N m s/rad].
    motor_constant : float, optional
        K, torque of the motor for each ampere [N m/A]: the factor of a record of its current.
    angle : float, optional
        Initial angle [rad], unless a run specifies another one.
    cycles : tuple of int, optional
        Numbers of periods of torque and target in one period of the joint, in which samples repeat too; found by the joint itself. Zeros:
        there is no common period, and a run needs a duration.

    References
    ----------
    B. Armstrong-Hélouvry, P. Dupont and C. Canudas de Wit, A survey of models, analysis tools and compensation methods for the control of
    machines with friction, Automatica 30 (1994) 1083-1138.
    M. Nordin and P.-O. Gutman, Controlling mechanical systems with backlash - a survey, Automatica 38 (2002) 1633-1649.
    A. C. Bittencourt and S. Gunnarsson, Static friction in a robot joint, J. Dyn. Syst. Meas. Control 134 (2012) 051013: the load.

    Examples
    --------
    A PD controller leaves an error up to the static friction over its gain.

    >>> import stickslip as ss
    >>> law = ss.Coulomb(0.02, 0.02, f_plus=0.03, f_minus=0.03)
    >>> joint = ss.Joint(inertia=0.01, friction=law, control=ss.machines.PID(kp=2.0, ki=0.0, kd=0.1, target=0.5))
    >>> run = ss.solve(joint, duration=5.0)
    >>> bool(0.0 < abs(0.5 - run.bodies["joint"].x[-1]) <= 0.03 / 2.0), float(run.bodies["joint"].v[-1])
    (True, 0.0)
    """

    inertia: float = field(metadata=quantity("moment of inertia of the joint", "kg m^2", "J", example=0.01, rule=positive))
    friction: Any
    torque: float | Any | None = field(default=None, metadata=quantity("torque", "N m", r"\tau", example=0.5) | _APPLIED)
    gravity_torque: float = field(default=0.0, metadata=quantity("torque of gravity", "N m", "G", example=0.2))
    gear_ratio: float = field(
        default=1.0,
        metadata=quantity(
            "gear ratio", "1", "n", example=50.0, rule=positive, allowed="a positive ratio, turns of the motor for each of the joint"
        ),
    )
    backlash: float = field(default=0.0, metadata=quantity("backlash", "rad", "b", example=0.01, rule=at_least(0.0)))
    control: Any = None
    load: float = field(
        default=1.0, metadata=quantity("load of the joint", "1", "N", example=1.0, rule=positive, allowed="a positive load")
    )
    load_gain: float | None = field(
        default=None, metadata=quantity("load for each torque", "1/(N m)", r"\kappa", example=0.1, rule=at_least(0.0))
    )
    motor_inertia: float | None = field(
        default=None, metadata=quantity("moment of inertia of the motor", "kg m^2", "J_{m}", example=1e-4, rule=positive)
    )
    gear_stiffness: float | None = field(
        default=None, metadata=quantity("stiffness of the gear", "N m/rad", "k", example=200.0, rule=positive)
    )
    gear_damping: float = field(default=0.0, metadata=quantity("damping of the gear", "N m s/rad", "c", example=0.1, rule=at_least(0.0)))
    motor_constant: float | None = field(
        default=None, metadata=quantity("motor constant", "N m/A", "K", example=0.05, rule=positive, allowed="a positive torque per ampere")
    )
    angle: float = field(default=0.0, metadata=quantity("angle at the start", "rad", r"\varphi_{0}", example=0.0))
    cycles: tuple[int, ...] | None = field(default=None, repr=False, metadata={"found": True})

    kind: ClassVar[str] = "joint"
    principal: ClassVar[str | None] = "joint"
    _input: ClassVar[tuple[str, tuple[str, ...], str]] = ("torque", ("at",), _TORQUE)
    rotary: ClassVar[bool] = True  # angles and torques, not ways and forces
    holds: ClassVar[dict[str, Any]] = {"pid": PID, "record": PeriodicRecord, **FORCES}

    def _complete(self) -> None:
        """Fill in what follows from the rest: the gear of a joint with backlash, and the common period."""
        if self.gear_stiffness is None and not everywhere(self.backlash == 0.0):
            object.__setattr__(self, "gear_stiffness", STIFFNESS)
        if self.gear_stiffness is not None and self.motor_inertia is None:
            object.__setattr__(self, "motor_inertia", self.inertia / self.gear_ratio**2)
        object.__setattr__(self, "cycles", self._common())

    def _check(self, problems: Problems) -> None:
        check_law(self.friction, problems)
        if self.control is not None and not isinstance(self.control, PID):
            problems.add(f"control = {self.control!r}; allowed is a PID; type control=ss.machines.PID(kp=2.0, ki=1.0, kd=0.1, target=0.5)")
        if self.gear_stiffness is None and not everywhere(self.gear_damping == 0.0) and everywhere(self.backlash == 0.0):
            problems.add("gear_damping is that of an elastic gear; type gear_stiffness=1e4 [N m/rad] too, or leave it out")
        if not problems.mistakes:
            self._complete()
            super()._check(problems)

    # ---- time ----
    @property
    def _inputs(self) -> list[Any]:
        """Torque and target, where they are functions of time with a period."""
        inputs = [self.torque, self.control.target if self.control is not None else None]
        return [each for each in inputs if is_record(each) and getattr(each, "period", None) is not None]

    def _common(self) -> tuple[int, ...]:
        """Periods of each input in one of the joint."""
        periods, sample = [each.period for each in self._inputs], None if self.control is None else self.control.sample
        if not periods:
            return ()
        count = common_count(periods[0], [*periods[1:], *([] if sample is None else [sample])])
        return tuple(most_times(count * periods[0], each) for each in periods)

    @property
    def period(self) -> Any:
        """Common period of torque, target and samples [s]; None if there is none, or none within 64 periods."""
        return self.cycles[0] * self._inputs[0].period if self.cycles and any(self.cycles) else None

    @property
    def time_scale(self) -> Any:
        """A characteristic time [s]: the period, or that of oscillations about the target or the hanging position."""
        if self.period is not None:
            return self.period
        gain = 0.0 if self.control is None else self.gear_ratio * self.control.kp
        held = maximum(gain + abs(self.gravity_torque), 1e-6 * self.inertia)
        return 2 * pi * sqrt(self.whole_inertia / held)

    @property
    def breaks(self) -> tuple[Any, ...]:
        """Instants in (0, period) at which torque or target are not smooth [s]."""
        return tuple(s for each, count in zip(self._inputs, self.cycles or (), strict=True) for s in breaks_of(each, count))

    def _count(self, value: Numeric) -> int:
        """Periods of an input in one of the joint."""
        return next((count for each, count in zip(self._inputs, self.cycles or (), strict=True) if each is value), 1)

    # ---- parts ----
    @property
    def whole_inertia(self) -> Any:
        """Total inertia that turns with the joint, referred to the joint [kg m^2]."""
        return self.inertia + self._of_motor

    @property
    def _of_motor(self) -> Any:
        """The motor's contribution to the inertia [kg m^2]."""
        return 0.0 if self.motor_inertia is None else self.gear_ratio**2 * self.motor_inertia

    @property
    def is_elastic(self) -> bool:
        """Whether motor and joint are two bodies."""
        return self.gear_stiffness is not None

    @property
    def _driven(self) -> str:
        return "motor" if self.is_elastic else "joint"

    def bodies(self) -> Mapping[str, Any]:
        """The joint, and the motor where the gear is elastic; its angle is that over the gear ratio."""

        def pull(t: Numeric, x: Numeric, v: Numeric) -> Any:
            return -self.gravity_torque * sin(x)

        gravity: dict[str, Any] = {"force": pull, "gravity": pull}
        if not self.is_elastic:
            return {"joint": Body(self.whole_inertia, position=self.angle, **gravity)}
        motor = Body(self._of_motor, position=self.angle)
        return {"joint": Body(self.inertia, position=self.angle, **gravity), "motor": motor}

    def contacts(self) -> Mapping[str, Any]:
        """The bearing."""
        gain: Any = self.load_gain
        load = self.load if gain is None else lambda t, x: self.load + gain * abs(self.gravity_torque * sin(x))
        return {"joint": Contact("joint", self.friction, load=load)}

    def stops(self) -> Mapping[tuple[str, str | None], Any]:
        """The two flanks of the teeth."""
        if not self.is_elastic:
            return {}
        flank: dict[str, Any] = {"gap": 0.5 * self.backlash, "stiffness": self.gear_stiffness, "damping": self.gear_damping}
        return {("motor", "joint"): (Stop(**flank), Stop(**flank, side=-1))}

    def forces(self, t: Numeric, x: Mapping[str, Any], v: Mapping[str, Any]) -> Mapping[str, Any]:
        """The applied torque, referred to the joint [N m]."""
        if self.torque is None:
            return {}
        torque: Any = self.torque
        applied = torque.at(in_period(t, torque, self._count(torque))) if is_record(torque) else torque
        return {self._driven: {"motor": self.gear_ratio * applied}}

    @property
    def input(self) -> tuple[Any, dict[str, Any]]:
        """The joint under no torque, and the torque at the joint for each unit of a record: of the motor's torque, and of its current."""
        per = {} if self.motor_constant is None else {"current": self.gear_ratio * self.motor_constant}
        return self.replace(torque=0.0, control=None), {**per, "torque": self.gear_ratio}

    def controllers(self) -> Mapping[str, Any]:
        """The PID controller."""
        if self.control is None:
            return {}
        low, high = adapted(self.friction).limits(self.load) or (-self.load, self.load)
        torque, small = maximum(high, -low) / self.gear_ratio, 1e-3 * (self.control.kp + self.control.ki + self.control.kd)
        torque = where(torque > 0.0, torque, maximum(small, 1e-12))  # friction that vanishes at rest says nothing of its size
        gain = maximum(self.control.kp, 1e-6 * torque)
        measured = self.control.feedback if self.is_elastic else "joint"
        loop = Loop(self.control, measured, self._driven, self.gear_ratio, self._count(self.control.target), torque, torque / gain)
        return {"control": loop}

    @property
    def notes(self) -> list[str]:
        """Inputs and samples that have no common period."""
        if not self.cycles or any(self.cycles):
            return []
        return [
            "torque, target and samples have no common period of at most 64 of their own, so the joint has no period; give runs a duration"
        ]

    @classmethod
    def example(cls) -> Joint:
        """A joint that hunts: integral action and more static than kinetic friction."""
        from stickslip.models.friction import Coulomb

        friction = Coulomb(mu_plus=0.02, mu_minus=0.02, f_plus=0.03, f_minus=0.03)
        return cls(inertia=0.01, friction=friction, control=PID(kp=2.0, ki=4.0, kd=0.1, target=0.5))
