"""A rig that moves a contact and measures the force: its drive train has play, so that the contact does not follow at once."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from stickslip.basics.errors import Problems
from stickslip.basics.fields import Frozen
from stickslip.models.forces import check_law
from stickslip.models.friction.behind_play import BACKLASH, BehindPlay
from stickslip.models.friction.law_adapter import LawAdapter, adapted


@dataclass(frozen=True, eq=False)
class ForceRig(Frozen):
    r"""A contact that an actuator moves through a play, for fits of a force over the position of the actuator.

    The contact has no mass. On a flank of the play it moves with the actuator, whose force is that of friction, and it never pulls: where
    friction falls to zero the flank is left, and the force stays zero until the actuator has moved by b. With a position that was measured
    behind the play, at the contact, the law alone is the model.

    It is not a machine that can be solved; a `Joint` has a gear with play, and inertia. For the torque and the angle of a motor that
    moves slowly, before its gear, read N m for N and rad for m; the `inertia` of the sensor is that of the motor.

    Parameters
    ----------
    friction : law
        Any law. One without inner states moves as a rigid contact; one with a stiffness has also the elasticity of the drive train.
    backlash : float
        Play b from end to end [m].

    References
    ----------
    M. Nordin and P.-O. Gutman, Controlling mechanical systems with backlash - a survey, Automatica 38 (2002) 1633-1649.

    Examples
    --------
    Strokes of 2 mm through a play of .2 mm under a friction force of 8 N:

    >>> import numpy as np, stickslip as ss
    >>> t = np.linspace(0.0, 4.0, 4000)
    >>> x, way, F = 1e-3 * np.sin(2 * np.pi * t), 0.0, np.zeros(4000)
    >>> for k in range(1, 4000):
    ...     way = min(max(way + x[k] - x[k - 1], -1e-4), 1e-4)
    ...     F[k] = 8.0 * np.sign(way) * (abs(way) == 1e-4)
    >>> rec = ss.Record.of(t, {"x [m]": x, "F [N]": F + np.random.default_rng(0).normal(0, 0.05, 4000)}, roles={"F": "force"})
    >>> rig = ss.machines.ForceRig(ss.Coulomb(0.1, 0.1), backlash=1e-4)
    >>> free = {"friction.mu_plus": (0.01, 1.0), "friction.mu_minus": (0.01, 1.0), "backlash": (0.0, 1e-3)}
    >>> fit = ss.identify(rec, rig, free=free, load=20.0, sensor={}, starts=8)
    >>> low, high = fit.interval("backlash")
    >>> low < 2e-4 < high, high - low < 1e-5, abs(fit.values["friction.mu_plus"] - 0.4) < 1e-3
    (True, True, True)
    """

    friction: Any
    backlash: float = field(metadata=BACKLASH)

    def _check(self, problems: Problems) -> None:
        check_law(self.friction, problems)
        if problems.mistakes:
            return
        if self.law.needs_applied:
            name = self.law.name
            problems.add(f"friction = {name}, which balances the forces at rest; allowed is any other law; type friction=ss.Stribeck(...)")

    @property
    def law(self) -> LawAdapter:
        """The law of the contact."""
        return adapted(self.friction)

    @property
    def behind_play(self) -> LawAdapter:
        """The law with inner states of the contact as the actuator meets it."""
        return adapted(BehindPlay(self.friction, self.backlash))

    @classmethod
    def example(cls) -> ForceRig:
        """Dry friction behind a tenth of a millimetre."""
        from stickslip.models.friction.coulomb import Coulomb

        return cls(Coulomb.example(), 1e-4)
