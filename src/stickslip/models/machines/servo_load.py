"""Friction of a servo that grows with the torques on its gear: the models M1 to M6 of Duclusaud et al. (2024) as the load of a joint."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.fields import Frozen
from stickslip.basics.maths import exp, where
from stickslip.basics.quantities import at_least, positive, quantity
from stickslip.models.instant_forces import LOADS, arguments_of_load

#: Names of its numbers in the files of BAM.
_OF_BAM = {
    "base": "friction_base", "viscous": "friction_viscous", "stribeck": "friction_stribeck", "motor": "load_friction_motor",
    "external": "load_friction_external", "motor_stribeck": "load_friction_motor_stribeck",
    "external_stribeck": "load_friction_external_stribeck", "motor_quad": "load_friction_motor_quad",
    "external_quad": "load_friction_external_quad", "v_s": "dtheta_stribeck", "exponent": "alpha",
}  # fmt: skip
_FRICTION, _STRIBECK, _GEAR = ("base", "viscous"), ("stribeck", "v_s", "exponent"), ("motor", "external")
_GEAR_STRIBECK, _QUADRATIC = ("motor_stribeck", "external_stribeck"), ("motor_quad", "external_quad")
#: The models of BAM in order: the numbers that each has, and whether both torques share theirs.
_MODELS = {
    "m1": (_FRICTION, False), "m2": (_FRICTION + _STRIBECK, False), "m3": (_FRICTION + _GEAR, True),
    "m4": (_FRICTION + _STRIBECK + _GEAR + _GEAR_STRIBECK, True), "m5": (_FRICTION + _STRIBECK + _GEAR + _GEAR_STRIBECK, False),
    "m6": (_FRICTION + _STRIBECK + _GEAR + _GEAR_STRIBECK + _QUADRATIC, False),
}  # fmt: skip
_SHARED = {"motor": "load_friction_base", "motor_stribeck": "load_friction_stribeck"}  # what M3 and M4 have for both torques


@dataclass(frozen=True, eq=False)
class LoadFunction(Frozen):
    """A load that a function gives, in a record.

    Parameters
    ----------
    function : callable
        Of time, or of time and angle, and so on with velocity and forces.

    Examples
    --------
    >>> LoadFunction(lambda t, x: 1.0 + x)(0.0, 0.5, 0.0, {})
    1.5
    """

    function: Callable[..., Any]

    def _check(self, problems: Problems) -> None:
        if arguments_of_load(self.function) is None:
            problems.add(f"load = {self.function!r}: {LOADS}; type load=lambda t, x, v, forces: 0.02 + 0.1 * abs(forces['motor'])")

    def __call__(self, t: Numeric, x: Numeric, v: Numeric, forces: Mapping[Any, Any]) -> Any:
        """Its value, of as many of these as it takes."""
        return self.function(*(t, x, v, forces)[: self._takes])

    @cached_property
    def _takes(self) -> int | None:
        """How many arguments the function takes."""
        return arguments_of_load(self.function)


def _torque(label: str, symbol: str, unit: str = "N m") -> dict[str, Any]:
    return quantity(label, unit, symbol, example=0.05, rule=at_least(0.0))


@dataclass(frozen=True, eq=False)
class ServoLoad(Frozen):
    r"""Friction of a servo that depends on its motor's torque and on what the arm bears, the models M1 to M6.

    .. math:: N = F + c|\dot q| + s F_s + |\lambda_e\tau_e - \lambda_m\tau_m| + s\,|\lambda_{es}\tau_e - \lambda_{ms}\tau_m| + s\,Q,
              \qquad s = e^{-|\dot q/v_s|^\alpha}

    with the motor's torque :math:`\tau_m` and gravity's :math:`\tau_e`, both at the joint. While these are opposite, Q is
    :math:`\kappa_e\tau_e^2` if the motor's is the larger one, so that it drives the arm, and :math:`\kappa_m\tau_m^2` if it is the
    smaller one and the arm drives it back.

    It is the `load` of a joint whose friction is ``ss.Coulomb(1.0, 1.0)``: the friction is N against the motion, and at rest up to N with
    s = 1. M1 has `base` and `viscous` alone, M2 `stribeck` too. M3 is M1 with equal `motor` and `external`, M4 is M2 with those and with
    equal `motor_stribeck` and `external_stribeck`; M5 has all but the quadratic ones.

    Parameters
    ----------
    base : float
        F, friction without load [N m].
    viscous : float, optional
        c [N m s/rad].
    stribeck : float, optional
        F_s, what static friction has more without load [N m].
    motor, external : float, optional
        Friction for each N m of the motor's torque, and of gravity's.
    motor_stribeck, external_stribeck : float, optional
        What these are more at rest.
    motor_quad, external_quad : float, optional
        Quadratic terms, of back-driving and of driving [1/(N m)].
    v_s : float, optional
        Stribeck velocity [rad/s].
    exponent : float, optional
        The exponent alpha.

    References
    ----------
    M. Duclusaud, G. Passault, V. Padois and O. Ly, Extended friction models for the physics simulation of servo actuators,
    arXiv:2410.08650 (2024).

    Examples
    --------
    >>> import stickslip as ss
    >>> gear = ServoLoad(base=0.02, viscous=0.01, motor=0.2, external=0.2)
    >>> joint = ss.Joint(inertia=0.01, friction=ss.Coulomb(1.0, 1.0), load=gear, torque=0.3, gravity_torque=0.2)
    >>> joint.mechanics.loads(0.0, (0.0,))
    (0.08,)
    """

    base: float = field(metadata=_torque("friction without load", "F"))
    viscous: float = field(default=0.0, metadata=_torque("viscous friction", "c", "N m s/rad"))
    stribeck: float = field(default=0.0, metadata=_torque("Stribeck friction without load", "F_{s}"))
    motor: float = field(default=0.0, metadata=_torque("friction for the motor's torque", r"\lambda_{m}", "1"))
    external: float = field(default=0.0, metadata=_torque("friction for the external torque", r"\lambda_{e}", "1"))
    motor_stribeck: float = field(default=0.0, metadata=_torque("Stribeck friction for the motor's torque", r"\lambda_{ms}", "1"))
    external_stribeck: float = field(default=0.0, metadata=_torque("Stribeck friction for the external torque", r"\lambda_{es}", "1"))
    motor_quad: float = field(default=0.0, metadata=_torque("quadratic friction when back-driven", r"\kappa_{m}", "1/(N m)"))
    external_quad: float = field(default=0.0, metadata=_torque("quadratic friction when driven", r"\kappa_{e}", "1/(N m)"))
    v_s: float = field(default=1.0, metadata=quantity("Stribeck velocity", "rad/s", "v_{s}", example=1.0, rule=positive))
    exponent: float = field(default=1.0, metadata=quantity("exponent of the Stribeck curve", "1", r"\alpha", example=1.5, rule=positive))

    def __call__(self, t: Numeric, x: Numeric, v: Numeric, forces: Mapping[Any, Any]) -> Any:
        """The friction torque that a joint can bear, from its velocity and the torques on it [N m]."""
        motor, external, speed = forces["motor"], forces["gravity"], abs(v)
        s = exp(-((speed / self.v_s) ** self.exponent))
        steady = self.base + self.viscous * speed + abs(self.external * external - self.motor * motor)
        driven = where(abs(external) < abs(motor), self.external_quad * external**2, self.motor_quad * motor**2)
        quadratic = where(motor * external < 0.0, driven, 0.0)
        return steady + s * (self.stribeck + abs(self.external_stribeck * external - self.motor_stribeck * motor) + quadratic)

    @classmethod
    def from_bam(cls, parameters: Mapping[str, Any]) -> ServoLoad:
        """The load of a parameter set of BAM, the JSON files of Rhoban's library of that name, M1 to M6.

        Parameters
        ----------
        parameters : dict
            What such a file says, as ``json.loads(path.read_text())`` gives it. The motor's `kt` and `R`, `armature` and `q_offset` are the
            joint's: ``motor=ss.machines.Motor(k_t=p["kt"], resistance=p["R"])``.

        References
        ----------
        https://github.com/Rhoban/bam, folder bam/params.

        Examples
        --------
        >>> ServoLoad.from_bam({"model": "m1", "friction_base": 0.05, "friction_viscous": 0.1}).base
        0.05
        """
        lacking = [name for name in ("friction_base", "friction_viscous") if name not in parameters]
        if lacking:
            given = ", ".join(map(repr, parameters)) or "nothing"
            raise InputError(
                "ServoLoad.from_bam", [f"the parameters have no {' and no '.join(lacking)}, but {given}; allowed is a set of BAM"]
            )
        numbers = {own: float(parameters[name]) for own, name in _OF_BAM.items() if name in parameters}
        for own, name in _SHARED.items():
            if name in parameters:
                numbers |= {own: float(parameters[name]), own.replace("motor", "external"): float(parameters[name])}
        return cls(**numbers)

    def to_bam(self) -> dict[str, Any]:
        """The same as a parameter set of BAM, of the first of M1 to M6 that holds it; the motor's numbers are not in it.

        Examples
        --------
        >>> ServoLoad(base=0.05, viscous=0.1).to_bam()
        {'friction_base': 0.05, 'friction_viscous': 0.1, 'model': 'm1'}
        >>> ServoLoad(base=0.05, viscous=0.1, motor=0.2, external=0.2).to_bam()["load_friction_base"]
        0.2
        """
        names, shared = _MODELS[self.model]
        numbers = {own: float(getattr(self, own)) for own in names if not (shared and own.startswith("external"))}
        return {(_OF_BAM | (_SHARED if shared else {}))[own]: value for own, value in numbers.items()} | {"model": self.model}

    @property
    def model(self) -> str:
        """The first of BAM's models, "m1" to "m6", that holds its numbers.

        Examples
        --------
        >>> ServoLoad(base=0.05, motor=0.2, external=0.2).model, ServoLoad(base=0.05, motor=0.2).model
        ('m3', 'm5')
        """
        acting = {own for own in _OF_BAM if own not in ("v_s", "exponent") and getattr(self, own)}
        alike = self.motor == self.external and self.motor_stribeck == self.external_stribeck
        return next(name for name, (names, shared) in _MODELS.items() if acting <= {*names} and (alike or not shared))

    @classmethod
    def example(cls) -> ServoLoad:
        """M6 of a servo of a few N m."""
        return cls(base=0.01, viscous=0.05, stribeck=0.12, motor=0.2, external=0.02, motor_stribeck=0.2, external_stribeck=0.09, v_s=1.75)
