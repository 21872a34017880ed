"""A PID controller of one coordinate, continuous or sampled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from operator import attrgetter
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems, is_one_of
from stickslip.basics.fields import is_record
from stickslip.basics.maths import where
from stickslip.basics.quantities import at_least, holding, positive, quantity
from stickslip.models.drives import DRIVES
from stickslip.models.machines.periodic_inputs import TakesInput, in_period
from stickslip.models.machines.periodic_record import PeriodicRecord

_ANGLE = holding({"the inner mass": "the target"}, {"m": "rad", "m/s": "rad/s", "m/s^2": "rad/s^2"})
_TARGET = "an angle [rad], a motion such as ss.Harmonic(amplitude=0.3, frequency=0.5), or a record (times, angles) of one period"


@dataclass(frozen=True, eq=False)
class PID(TakesInput):
    r"""A PID controller: the torque of a motor from the error e = target - angle.

    Continuously,

    .. math:: \tau = k_p e + \tau_I + k_d\dot e + f\operatorname{sgn}\dot q_\mathrm{target}, \qquad \dot\tau_I = k_i e

    and with samples, at :math:`t_k = k\,\Delta t`, held until the next one (zero-order hold),

    .. math:: \tau_k = k_p e_k + \tau_{I,k} + k_d\frac{e_k - e_{k-1}}{\Delta t} + f\operatorname{sgn}\dot q_\mathrm{target}(t_k),
              \qquad \tau_{I,k} = \tau_{I,k-1} + k_i\,\Delta t\,e_k

    Before a motor (`stickslip.machines.Motor`) it commands a voltage or a current: gains are then in V or A in place of N m.

    The first sample is at t = 0, where the difference is zero and the integral its first term. At a jump of the target the value
    after it counts.

    Parameters
    ----------
    kp : float
        Proportional gain, at the motor [N m/rad].
    ki : float
        Integral gain [N m/(rad s)]; 0 is none.
    kd : float
        Derivative gain [N m s/rad]; 0 is none.
    target : float, Harmonic or another drive, or tuple of array
        Target angle [rad]: a number; a motion, which has position, velocity and period as every drive has; or one period of a
        record, a pair of arrays (times, angles), which is kept as a sum of harmonics.
    sample : float, optional
        Time between samples [s]; without it the controller acts continuously.
    feedforward : float, optional
        Torque f against friction, in the direction in which the target moves [N m].
    feedback : {"joint", "motor"}, optional
        Which angle is measured: that of the joint, or that of the motor as the joint sees it (its angle over the gear ratio).

    References
    ----------
    K. J. Åström and T. Hägglund, Advanced PID Control, ISA 2006, chapters 3 and 13.

    Examples
    --------
    >>> import stickslip as ss
    >>> control = ss.machines.PID(kp=2.0, ki=1.0, kd=0.1, target=0.5, sample=1e-3)
    >>> joint = ss.Joint(inertia=0.01, friction=ss.Coulomb(0.02, 0.02), control=control)
    >>> joint.mechanics.controllers.states
    (('torque', 'integral', 'error'),)
    """

    kp: float = field(metadata=quantity("proportional gain", "N m/rad", "k_{p}", example=2.0, rule=at_least(0.0)))
    ki: float = field(metadata=quantity("integral gain", "N m/(rad s)", "k_{i}", example=1.0, rule=at_least(0.0)))
    kd: float = field(metadata=quantity("derivative gain", "N m s/rad", "k_{d}", example=0.1, rule=at_least(0.0)))
    target: float | Any = field(metadata=quantity("target", "rad", r"\varphi_{s}", example=0.5) | _ANGLE)
    sample: float | None = field(
        default=None,
        metadata=quantity(
            "time between samples",
            "s",
            "h",
            example=1e-3,
            rule=positive,
            allowed="a positive time between samples [s]",
        ),
    )
    feedforward: float = field(default=0.0, metadata=quantity("feed-forward torque", "N m", r"\tau_{f}", example=0.02))
    feedback: str = "joint"

    kind: ClassVar[str] = "pid"
    _input: ClassVar[tuple[str, tuple[str, ...], str]] = ("target", ("position", "velocity"), _TARGET)
    holds: ClassVar[dict[str, Any]] = {**DRIVES, "record": PeriodicRecord}

    def _check(self, problems: Problems) -> None:
        if not is_one_of(self.feedback, ("joint", "motor")):
            problems.add(f'feedback = {self.feedback!r}; allowed is "joint" or "motor"')

    @classmethod
    def example(cls) -> PID:
        """A controller of a small joint."""
        return cls(kp=2.0, ki=1.0, kd=0.1, target=0.5)


@dataclass(frozen=True, eq=False)
class Loop:
    """A PID controller on a joint: what the machine's equations ask of it.

    Parameters
    ----------
    pid : PID
    measured : str
        Name of the body whose angle it sees.
    driven : str
        Name of the body that its torque acts on.
    gear : number
        Torque on that body for each N m of the controller.
    count : int
        Periods of the target in one of the machine.
    torque, angle : number
        Typical sizes of what it holds [N m], [rad].
    queued : int
        Samples after which a torque acts.
    motor : callable, optional
        Torque on the driven body of a motor, by time, its velocity and the controller's command, where that is not the command itself.
    """

    pid: PID
    measured: str
    driven: str
    gear: Any
    count: int
    torque: Any
    angle: Any
    queued: int = 0
    motor: Any = None

    sample = property(attrgetter("pid.sample"), doc="Time between samples [s]; None where it acts continuously.")

    @property
    def states(self) -> tuple[str, ...]:
        """The part of the integral in the torque; with samples the torque that is held, and the last error."""
        return ("integral",) if self.sample is None else ("torque", "integral", "error", *(f"queued {k + 1}" for k in range(self.queued)))

    @property
    def scales(self) -> tuple[Any, ...]:
        """Their typical sizes."""
        return (self.torque,) if self.sample is None else (self.torque, self.torque, self.angle, *(self.torque,) * self.queued)

    def target_at(self, t: Numeric) -> Mapping[str, Any]:
        """The wanted angle of the body that it sees [rad]."""
        target: Any = self.pid.target
        return {self.measured: target.position(self._time(t)) if is_record(target) else target}

    def start(self, t: Numeric, x: Mapping[str, Any], v: Mapping[str, Any]) -> tuple[Any, ...]:
        """The states when it is switched on; the first sample is taken at once."""
        if self.sample is None:
            return (0.0 * x[self.measured],)
        error = self._error(t, x)
        return self._delayed(self._sampled(t, error, 0.0, error), (0.0 * error,) * self.queued)

    def rates(self, t: Numeric, x: Mapping[str, Any], v: Mapping[str, Any], z: Numeric | tuple[Numeric, ...]) -> tuple[Any, ...]:
        """Rate of the integral; what is held has none."""
        return (self.pid.ki * self._error(t, x),) if self.sample is None else (0.0,) * (3 + self.queued)

    def sampled(self, t: Numeric, x: Mapping[str, Any], v: Mapping[str, Any], z: Sequence[Numeric]) -> tuple[Any, ...]:
        """The states after a sample."""
        return self._delayed(self._sampled(t, self._error(t, x), z[1], z[2]), z[3:])

    def _delayed(self, new: tuple[Any, Any, Any], queued: Sequence[Any]) -> tuple[Any, ...]:
        """What a sample makes of torque, integral and error, and of the torques that wait, the next one first."""
        torque, *rest = (*queued, new[0])
        return (torque, *new[1:], *rest)

    def forces(self, t: Numeric, x: Mapping[str, Any], v: Mapping[str, Any], z: Sequence[Numeric]) -> Mapping[str, Any]:
        """Its torque [N m], on the side of the joint."""
        command = z[0] if self.sample is not None else self._torque(t, x, v, z[0])
        return {self.driven: {"motor": self.gear * command if self.motor is None else self.motor(t, v[self.driven], command)}}

    def _torque(self, t: Numeric, x: Mapping[str, Any], v: Mapping[str, Any], integral: Any) -> Any:
        rate = self._rate(t) - v[self.measured]
        return self.pid.kp * self._error(t, x) + integral + self.pid.kd * rate + self._against_friction(t, v)

    def _sampled(self, t: Numeric, error: Any, integral: Any, last: Any) -> tuple[Any, Any, Any]:
        pid: Any = self.pid
        total = integral + pid.ki * pid.sample * error
        return pid.kp * error + total + pid.kd * ((error - last) / pid.sample) + self._against_friction(t, {}), total, error

    def _error(self, t: Numeric, x: Mapping[str, Any]) -> Any:
        return self.target_at(t)[self.measured] - x[self.measured]

    def _rate(self, t: Numeric) -> Any:
        target: Any = self.pid.target
        return target.velocity(self._time(t)) if is_record(target) else 0.0

    def _time(self, t: Numeric) -> Any:
        return in_period(t, self.pid.target, self.count)

    def _against_friction(self, t: Numeric, v: Mapping[str, Any]) -> Any:
        """The feed-forward; the velocity times zero tells plain numbers that a step must not pass its jumps."""
        if not is_record(self.pid.target):
            return 0.0
        rate, f = self._rate(t) + 0.0 * v.get(self.measured, 0.0), self.pid.feedforward
        return where(rate > 0.0, f, where(rate < 0.0, -f, 0.0 * f))
