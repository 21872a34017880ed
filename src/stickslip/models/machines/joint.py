"""A joint of a robot: an inertia about an axis with friction, gravity, a gear with backlash, and a controller."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import describe, everywhere, is_record
from stickslip.basics.maths import maximum, pi, sin, sqrt, where, wrapped
from stickslip.basics.quantities import at_least, holding, positive, quantity
from stickslip.models.drives import FORCES
from stickslip.models.forces import check_law
from stickslip.models.friction.law_adapter import adapted
from stickslip.models.machines.machine import Machine
from stickslip.models.machines.motors import Motor, limited
from stickslip.models.machines.parts import Body, Contact, Stop
from stickslip.models.machines.periodic_inputs import TakesInput, breaks_of, common_count, in_period, most_times
from stickslip.models.machines.periodic_record import PeriodicRecord
from stickslip.models.machines.pid import PID, Loop
from stickslip.models.machines.servo_load import LoadFunction, ServoLoad

STIFFNESS = 1e4  # of a gear that does not say its own: a small strain-wave gear [N m/rad]
_APPLIED = holding({"force on the inner mass": "torque", "the force": "the torque"}, {"N": "N m"})
_VOLTAGE = holding({"force on the inner mass": "voltage", "the force": "the voltage"}, {"N": "V"})
_CURRENT = holding({"force on the inner mass": "current", "the force": "the current"}, {"N": "A"})
_COMMANDS = {"N m": "{}", "N m/rad": "{}/rad", "N m/(rad s)": "{}/(rad s)", "N m s/rad": "{} s/rad"}
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
    load : float or callable, optional
        N_0, the factor of the friction coefficients; or a function of time, angle, velocity and forces, ``lambda t, x, v, forces:
        0.02 + 0.1 * abs(forces["motor"])``, where ``forces["motor"]`` is the motor's torque and ``forces["gravity"]`` that of gravity, both
        at the joint [N m] (`stickslip.Contact`), such as a `stickslip.machines.ServoLoad`.
    load_gain : float, optional
        How much the load grows with the torque of gravity, lambda [1/(N m)].
    motor_inertia : float, optional
        J_m, at the motor [kg m^2]. By default zero if the gear is rigid; if it is elastic the joint's inertia referred to the motor, J/n^2.
    gear_stiffness : float, optional
        k, at the joint [N m/rad]. By default the gear is rigid if it has no backlash, otherwise 1e4 N m/rad, as a small strain-wave gear
        has.
    gear_damping : float, optional
        [N m s/rad].
    motor : Motor, optional
        The motor, which makes a torque of a voltage or a current (`stickslip.machines.Motor`). A controller's gains are then those of the
        voltage [V] or the current [A].
    voltage, current : float, force or record, optional
        In place of a torque the command of a motor with or without a resistance [V], [A], in the forms of `torque`; it adds to that of the
        controller. By default zero: the terminals of a motor with a resistance are joined, and it brakes.
    delay : float, optional
        Time from a command to what it does [s]; by default none. With a controller, which then has a `sample` time, a whole number of
        those.
    limit : float, optional
        The largest command, either way: of torque and controller together [N m], or in the motor's unit [V], [A].
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
    load: float | Any = field(
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
    motor: Any = None
    voltage: float | Any | None = field(default=None, metadata=quantity("voltage", "V", "U", example=6.0) | _VOLTAGE)
    current: float | Any | None = field(default=None, metadata=quantity("current", "A", "i", example=0.5) | _CURRENT)
    delay: float | None = field(default=None, metadata=quantity("delay of the command", "s", r"\tau_{d}", example=5e-3, rule=at_least(0.0)))
    limit: float | None = field(default=None, metadata=quantity("largest command", "N m", r"u_{\mathrm{max}}", example=0.3, rule=positive))
    angle: float = field(default=0.0, metadata=quantity("angle at the start", "rad", r"\varphi_{0}", example=0.0))
    cycles: tuple[int, ...] | None = field(default=None, repr=False, metadata={"found": True})
    queued: Any = field(default=0, repr=False, metadata={"found": True})  # samples in the delay of a controller

    kind: ClassVar[str] = "joint"
    principal: ClassVar[str | None] = "joint"
    _input: ClassVar[tuple[str, tuple[str, ...], str]] = ("torque", ("at",), _TORQUE)
    _more_inputs: ClassVar[tuple[tuple[str, tuple[str, ...], str], ...]] = (
        ("voltage", ("at",), _TORQUE.replace("torque", "voltage")), ("current", ("at",), _TORQUE.replace("torque", "current")),
    )  # fmt: skip
    rotary: ClassVar[bool] = True  # angles and torques, not ways and forces
    holds: ClassVar[dict[str, Any]] = {"pid": PID, "record": PeriodicRecord, "motor": Motor, "servo_load": ServoLoad, **FORCES}

    def _complete(self) -> None:
        """Fill in what follows from the rest: the gear of a joint with backlash, and the common period."""
        if self.gear_stiffness is None and not everywhere(self.backlash == 0.0):
            object.__setattr__(self, "gear_stiffness", STIFFNESS)
        if self.gear_stiffness is not None and self.motor_inertia is None:
            object.__setattr__(self, "motor_inertia", self.inertia / self.gear_ratio**2)
        if self.delay is not None and everywhere(self.delay == 0.0):
            object.__setattr__(self, "delay", None)
        object.__setattr__(self, "cycles", self._common())
        object.__setattr__(self, "queued", 0)
        if self.delay is not None and self.control is not None:
            object.__setattr__(self, "queued", most_times(self.delay, self.control.sample))

    def _check(self, problems: Problems) -> None:
        check_law(self.friction, problems)
        if self.control is not None and not isinstance(self.control, PID):
            problems.add(f"control = {self.control!r}; allowed is a PID; type control=ss.machines.PID(kp=2.0, ki=1.0, kd=0.1, target=0.5)")
        if self.gear_stiffness is None and not everywhere(self.gear_damping == 0.0) and everywhere(self.backlash == 0.0):
            problems.add("gear_damping is that of an elastic gear; type gear_stiffness=1e4 [N m/rad] too, or leave it out")
        self._check_command(problems)
        if not problems.mistakes:
            self._complete()
            super()._check(problems)

    def __post_init__(self) -> None:
        if callable(self.load) and not is_record(self.load):
            object.__setattr__(self, "load", LoadFunction(self.load))
        super().__post_init__()

    def _take(self, field: dataclasses.Field[Any], problems: Problems) -> None:
        """The load may be a function."""
        if field.name != "load" or not callable(self.load):
            super()._take(field, problems)

    def _check_command(self, problems: Problems) -> None:
        """Note a motor that is none, commands that contradict it or one another, and a delay that is not known."""
        if callable(self.load) and self.load_gain is not None:
            problems.add(f"load_gain = {self.load_gain!r} and load is a function; allowed is one of the two; leave load_gain out")
        if self.motor is not None and not isinstance(self.motor, Motor):
            problems.add(f"motor = {self.motor!r}; allowed is a Motor; type motor=ss.machines.Motor(k_t=1.5, resistance=5.0, supply=12.0)")
            return
        own = None if self.motor is None else self.motor.command
        for name in [name for name in ("torque", "voltage", "current") if getattr(self, name) is not None]:
            if name == "torque" and own is not None:
                problems.add(f"torque is given, and a motor that is commanded by a {own}; type {own}=..., or leave the motor out")
            elif name not in ("torque", own):
                which = "a motor" if own is None else "a motor with a resistance" if name == "voltage" else "a motor without a resistance"
                typed = "k_t=1.5, resistance=5.0" if name == "voltage" else "k_t=1.5"
                problems.add(f"{name} is the command of {which}; type motor=ss.machines.Motor({typed})")
        if isinstance(self.control, PID) and self.delay is not None and not everywhere(self.delay == 0.0):
            sample = self.control.sample
            if sample is None:
                problems.add(
                    f"delay = {describe(self.delay)} s of a controller that acts continuously; allowed is one that samples; "
                    "type sample=1e-3 [s] in its ss.machines.PID, of which the delay is a whole number"
                )
            elif not everywhere(abs(self.delay / sample - most_times(self.delay, sample)) <= 1e-9):
                problems.add(
                    f"delay = {describe(self.delay)} s is not a whole number of samples of {describe(sample)} s, one for all cases; "
                    f"type delay={describe(most_times(self.delay, sample) * sample)}, or another sample="
                )

    # ---- words ----
    @property
    def measured_inside(self) -> Mapping[str, Any]:
        """Units of the controller and of the limit, where a motor is commanded by a voltage or a current."""
        if not isinstance(self.motor, Motor):
            return {}
        units = {unit: there.format(self.motor.unit) for unit, there in _COMMANDS.items()}
        return dict.fromkeys(("control", "limit"), holding({"torque": self.motor.command}, units))

    @property
    def friction_name(self) -> str:
        """What its friction is called: the law, or the model of a servo where the load is the friction."""
        law = adapted(self.friction).name
        if not isinstance(self.load, ServoLoad):
            return law
        return f"servo model {self.load.model.upper()}" if law == "Coulomb" else f"{law}, loaded by servo model {self.load.model.upper()}"

    # ---- time ----
    @property
    def _inputs(self) -> list[Any]:
        """Torque and target, where they are functions of time with a period."""
        inputs = [self._command, self.control.target if self.control is not None else None]
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
        gain = gain if self.motor is None else gain * self.motor.gain
        held = maximum(gain + abs(self.gravity_torque), 1e-6 * self.inertia)
        return 2 * pi * sqrt(self.whole_inertia / held)

    @property
    def breaks(self) -> tuple[Any, ...]:
        """Instants in (0, period) at which torque or target are not smooth [s]."""
        own = [(each, breaks_of(each, count)) for each, count in zip(self._inputs, self.cycles or (), strict=True)]
        late = self._command if self.delay is not None else None
        return tuple(s for each, breaks in own for s in (self._later(breaks, self.delay) if each is late else breaks))

    def _later(self, breaks: Any, delay: Any) -> tuple[Any, ...]:
        """Instants of the command, and the beginning of its period, by the delay later [s]."""
        return tuple(wrapped(s + delay, self.period) for s in (0.0, *breaks)) if self.period is not None else ()

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

    @property
    def _command(self) -> Any:
        """What commands the motor beside a controller: a torque, a voltage or a current; None if nothing does."""
        return next((each for each in (self.torque, self.voltage, self.current) if each is not None), None)

    def _commanded(self, t: Numeric) -> Any:
        """The command at an instant [N m], [V] or [A]."""
        command: Any = self._command
        if not is_record(command):
            return 0.0 if command is None else command
        if self.delay is not None:
            t = t - self.delay if self.period is None else wrapped(t - self.delay, self.period)
        return command.at(in_period(t, command, self._count(command)))

    def _motor_torque(self, t: Numeric, v: Numeric, command: Any) -> Any:
        """Torque of the motor at the body that it drives [N m], under a controller's command beside the other one."""
        whole = command if self._command is None else self._commanded(t) + command
        whole = limited(whole, self.limit)
        return self.gear_ratio * (whole if self.motor is None else self.motor.torque(whole, self.gear_ratio * v))

    @property
    def _is_direct(self) -> bool:
        """Whether the motor's torque is the sum of the commands."""
        return self.motor is None and self.limit is None

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
        load: Any = self.load if gain is None else lambda t, x: self.load + gain * abs(self.gravity_torque * sin(x))
        return {"joint": Contact("joint", self.friction, load=load)}

    def stops(self) -> Mapping[tuple[str, str | None], Any]:
        """The two flanks of the teeth."""
        if not self.is_elastic:
            return {}
        flank: dict[str, Any] = {"gap": 0.5 * self.backlash, "stiffness": self.gear_stiffness, "damping": self.gear_damping}
        return {("motor", "joint"): (Stop(**flank), Stop(**flank, side=-1))}

    def forces(self, t: Numeric, x: Mapping[str, Any], v: Mapping[str, Any]) -> Mapping[str, Any]:
        """The applied torque, referred to the joint [N m]."""
        if not self._is_direct:  # a controller makes it of both commands
            return {} if self.control is not None else {self._driven: {"motor": self._motor_torque(t, v[self._driven], 0.0)}}
        return {} if self._command is None else {self._driven: {"motor": self.gear_ratio * self._commanded(t)}}

    @property
    def input(self) -> tuple[Any, dict[str, Any]]:
        """The joint under no torque, and the torque at the joint for each unit of a record: of the motor's torque, and of its current."""
        per = {} if self.motor_constant is None else {"current": self.gear_ratio * self.motor_constant}
        none = {"torque": None, "voltage": None, "current": None, "control": None, "limit": None, "delay": None}
        if self.motor is not None and self.motor.unit == "V":  # a measured torque has the back-EMF in it
            return self.replace(none | {"motor": None, "torque": 0.0}), {"torque": self.gear_ratio}
        if self.motor is not None:
            per = {"current": self.gear_ratio * self.motor.k_t}
            return self.replace(none | {"motor": None, "torque": 0.0}), {**per, "torque": self.gear_ratio}
        return self.replace(none | {"torque": 0.0}), {**per, "torque": self.gear_ratio}

    @property
    def commands(self) -> dict[str, tuple[Any, str, str]]:
        """The joint under a recorded command: the target of its controller, or the motor's voltage or current."""
        if self.control is not None:
            return {"command": (self.replace({"control": self.control.replace(target=0.0)}), "control.target", "angle")}
        own = None if self.motor is None else self.motor.command
        return {} if own is None else {own: (self.replace({own: 0.0}), own, "angle")}

    def controllers(self) -> Mapping[str, Any]:
        """The PID controller."""
        if self.control is None:
            return {}
        load: Any = 1.0 if callable(self.load) else self.load
        low, high = adapted(self.friction).limits(load) or (-load, load)
        torque, small = maximum(high, -low) / self.gear_ratio, 1e-3 * (self.control.kp + self.control.ki + self.control.kd)
        torque = where(torque > 0.0, torque, maximum(small, 1e-12))  # friction that vanishes at rest says nothing of its size
        torque = torque if self.motor is None else torque / self.motor.gain
        gain = maximum(self.control.kp, 1e-6 * torque)
        measured = self.control.feedback if self.is_elastic else "joint"
        count, motor = self._count(self.control.target), None if self._is_direct else self._motor_torque
        loop = Loop(self.control, measured, self._driven, self.gear_ratio, count, torque, torque / gain, self.queued, motor)
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
