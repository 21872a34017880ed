"""A servo of which the command and the angle were logged, and no torque: the angle is simulated under the command."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.basics.spelling import spelled
from stickslip.inverse.logs.machines import Kind, Task, quantity_in, rounded_bounds, scaled
from stickslip.models.friction import Coulomb
from stickslip.models.machines import PID, Joint, Motor, ServoLoad

if TYPE_CHECKING:
    from stickslip.records.record import Record

_APART = 0.1  # of its standard deviation, by which the mean of command less angle may be off zero
_TORQUES = ("base", "viscous", "stribeck")
_LOADS = ("motor", "external", "motor_stribeck", "external_stribeck")
_FADING = ("stribeck", "v_s", "exponent")
#: What each of BAM's models has of `ServoLoad`.
_OF: dict[str, tuple[str, ...]] = {
    "m1": ("base", "viscous"), "m2": ("base", "viscous", *_FADING), "m3": ("base", "viscous", "motor"),
    "m4": ("base", "viscous", *_FADING, "motor", "motor_stribeck"), "m5": ("base", "viscous", *_FADING, *_LOADS),
    "m6": ("base", "viscous", *_FADING, *_LOADS, "motor_quad", "external_quad"),
}  # fmt: skip
_TIED = {"m3": {"load.external": "load.motor"}, "m4": {"load.external": "load.motor", "load.external_stribeck": "load.motor_stribeck"}}


class CommandedServo(Kind):
    """A servo whose commanded and measured angle were logged."""

    name = "servo"
    words = "a servo by its command: the angle that its motor, friction and load make of it"
    laws = ("m1", "m2", "m3")
    richer: ClassVar[tuple[str, ...]] = ("m4", "m5", "m6")
    over_motion = False
    advises = False
    takes: ClassVar[dict[str, str]] = {
        "kp": "gain of the controller [V/rad]",
        "kd": "its gain on the velocity [V s/rad]",
        "supply": "the largest voltage [V]",
        "motor_constant": "torque at the joint for each ampere [N m/A]",
        "resistance": "of the motor [Ohm]",
        "inertia": "moment of inertia of arm and load about the axis [kg m^2]",
        "gravity_torque": "their m g l; 0 about an upright axis [N m]",
    }
    needs: ClassVar[dict[str, str]] = {"kp": "38", "motor_constant": "2.1", "resistance": "3", "inertia": "0.023", "gravity_torque": "1.5"}
    why_needed: ClassVar[str] = "without a torque or a current the angle tells friction only where controller, motor and load are known"
    by_file: ClassVar[frozenset[str]] = frozenset({"inertia", "gravity_torque"})

    def suits(self, rec: Record) -> str:
        """What of a record speaks for it; empty where something is missing."""
        angles = all(quantity_in(rec, role) == "angle" for role in ("command", "position"))
        pushed = {"force", "current"} & {c.role for c in rec.channels.values()}
        return "a commanded angle beside the measured one" if angles and not pushed else ""

    def assumed(self, records: Sequence[Record], given: dict[str, Any]) -> dict[str, tuple[str, str]]:
        """Numbers that nobody gave: name -> (value in words, why)."""
        return {"kd": ("0", "the controller has a gain on the angle alone"), "supply": ("no limit", "the voltage is not limited")}

    def doubt(self, records: Sequence[Record], given: dict[str, Any]) -> str:
        """Command and angle that are counted from different zeros differ in the mean."""
        off = np.concatenate([_wanted(rec) for rec in records])
        mean, spread = float(np.nanmean(off)), float(np.nanstd(off))
        if abs(mean) < _APART * spread:
            return ""
        typed = 'sensor={"delay": None, "zero": None, "begin": None, "goal": None}'
        return f"the command is {mean:.3g} rad beyond the angle in the mean: if both are counted from other zeros, type {typed}"

    def task(self, records: Sequence[Record], law: str, given: dict[str, Any], asymmetric: bool) -> Task:
        """How a law is fitted."""
        if asymmetric:
            raise InputError("fit", ["a servo by its command has one friction for both directions; leave asymmetric out"])
        torque, speed = self._sizes(records, given)
        inertia = scaled(given["inertia"])
        largest = max(inertia) if isinstance(inertia, list) else inertia
        bounds: dict[str, tuple[Any, ...]] = {name: (0.0, 0.5 * torque / (speed if name == "viscous" else 1.0)) for name in _TORQUES}
        bounds |= {"v_s": (0.02 * speed, speed), "exponent": (0.5, 4.0)} | dict.fromkeys(_LOADS, (0.0, 0.6))
        free = {"motor_inertia": rounded_bounds((1e-3 * largest, 5 * largest))}
        free |= {f"load.{name}": rounded_bounds(bounds.get(name, (0.0, 0.5))) for name in _OF[law]}
        begin = {name.removeprefix("load."): float(f"{low + 0.1 * (high - low):.2g}") for name, (low, high) in free.items()}
        rotor, tied = begin.pop("motor_inertia"), _TIED.get(law, {})
        begin |= {own.removeprefix("load."): begin[of.removeprefix("load.")] for own, of in tied.items()}
        supply = {"supply": float(given["supply"])} if "supply" in given else {}
        motor = Motor(k_t=float(given["motor_constant"]), resistance=float(given["resistance"]), **supply)
        control = PID(kp=float(given["kp"]), ki=0.0, kd=float(given.get("kd", 0.0)), target=0.0)
        arm = {name: scaled(given[name]) for name in ("inertia", "gravity_torque")}
        lists = {name: value for name, value in arm.items() if isinstance(value, list)}
        single: dict[str, Any] = {name: value[0] if isinstance(value, list) else value for name, value in arm.items()}
        joint: Joint = Joint(
            **single, friction=Coulomb(1.0, 1.0), motor_inertia=rotor, motor=motor, control=control, load=ServoLoad(**begin)
        )
        return Task(joint, spelled(joint, 1), free, lists | ({"tied": tied} if tied else {}))

    def _sizes(self, records: Sequence[Record], given: dict[str, Any]) -> tuple[float, float]:
        """The largest torque that the motor is asked for [N m], and the largest speed [rad/s]."""
        volts, speed = 0.0, 0.0
        for rec in records:
            angle = rec["position"]
            volts = max(volts, float(given["kp"]) * float(np.nanmax(abs(_wanted(rec)))))
            slow = np.convolve(np.nan_to_num(angle.si), np.ones(9) / 9, "valid")
            speed = max(speed, float(np.nanmax(abs(np.gradient(slow, angle.time[4:-4])))))
        volts = min(volts, float(given.get("supply", math.inf)))
        if not volts > 0 or not speed > 0:
            raise InputError("fit", ["the angle is the command, or does not move; give the log of a servo that follows its command"])
        return volts * float(given["motor_constant"]) / float(given["resistance"]), speed


def _wanted(rec: Record) -> Any:
    """By how much the command is beyond each angle [rad]."""
    goal, angle = rec["command"], rec["position"]
    return np.interp(angle.time, goal.time, goal.si) - angle.si
