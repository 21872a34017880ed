"""A mass on a track with prescribed motion: piezo stick-slip stages and vibratory conveyors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from operator import attrgetter
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import Problems
from stickslip.basics.fields import everywhere
from stickslip.basics.maths import cos, maximum, sin
from stickslip.basics.quantities import GRAVITY, MASS, TILT, Rule, holding, positive, quantity, remarks_on_gravity
from stickslip.models.drives.drive_adapter import NEEDS, drive_of, lacking
from stickslip.models.forces import check_law
from stickslip.models.friction.law_adapter import adapted
from stickslip.models.machines.checks import periods_differ
from stickslip.models.machines.machine import Machine
from stickslip.models.machines.parts import Body, Contact

_LOOKS = 64  # instants of a period at which the load is looked at


@dataclass(frozen=True, eq=False)
class MovingTrack(Machine):
    r"""A mass on a track with a prescribed motion along and across it: the slider of a piezo stage, a part on a vibratory conveyor.

    .. math:: m\ddot x = m g\sin\theta + F - R(\dot x - \dot\xi), \qquad N = P + m\ddot\eta

    :math:`\xi` is the motion along the track, :math:`\eta` the one across it, P the load at rest. Positions and velocities of a run are
    those of the mass in space; its contact sees the velocity over the track.

    Parameters
    ----------
    mass : float
        Mass m [kg].
    along : any drive
        Motion of the track, positive forwards [m].
    across : any drive, optional
        Its motion across itself, positive away from the ground [m], with the same period and a continuous velocity.
    tilt : float
        Angle of the track [rad], positive where forwards is downhill, as of `Incline`.
    friction : Coulomb or LuGre or any law
        Friction law of the mass on the track.
    load : float, optional
        Normal force on a track that does not move across [N]; its weight where it is left out, m g cos(tilt).
    force : float
        External force F, positive forwards [N].
    restitution : float or None
        Coefficient of restitution of a landing after a hop, 0 <= restitution < 1 [-]. With None, and under a law with inner states, a run
        ends when the load falls to zero.
    gravity : float
        Acceleration of gravity [m/s^2].

    Examples
    --------
    A sawtooth of 5 micrometres carries the slider and slips back under it.

    >>> import stickslip as ss
    >>> saw = ss.drives.Sawtooth(stroke=5e-6, rise=0.95e-3, fall=0.05e-3)
    >>> stage = MovingTrack(mass=0.02, along=saw, friction=ss.Coulomb(mu_plus=0.1, mu_minus=0.1), load=20.0)
    >>> round(ss.mean_velocity(ss.solve(stage, periods=20)) * saw.period, 15)
    5.013157895e-06
    """

    mass: float = field(metadata=MASS)
    along: Any = field(metadata=holding({"the inner mass": "the motion along the track"}))
    across: Any = field(default=None, metadata=holding({"the inner mass": "the motion across the track"}))
    tilt: float = field(default=0.0, metadata=TILT | {"range": (-0.3, 0.3)})
    friction: Any = None
    load: float | None = field(default=None, metadata=quantity("normal force", "N", "P", example=20.0, rule=positive))
    force: float = field(default=0.0, metadata=quantity("external force", "N", "F_{0}", example=0.5))
    restitution: float | None = field(
        default=0.0,
        metadata=quantity(
            "restitution", "1", "e", example=0.3, rule=Rule(lambda e: (e >= 0) & (e < 1), "from 0 to below 1"), range=(0.0, 0.95)
        ),
    )
    gravity: float = field(default=9.81, metadata=GRAVITY)

    kind: ClassVar[str] = "moving_track"  # its name in a study file
    principal: ClassVar[str | None] = "mass"
    period = property(attrgetter("along.period"), doc="Period of the motion of the track [s].")

    def _check(self, problems: Problems) -> None:
        for name in ("along", "across"):
            drive = getattr(self, name)
            if drive is None and name == "across":
                continue
            if lacking(drive):
                example = (
                    "ss.drives.Sawtooth(stroke=5e-6, rise=0.95e-3, fall=0.05e-3)" if name == "along" else "ss.Harmonic(1e-4, omega=300.0)"
                )
                problems.add(f"{name} = {drive!r}; allowed is a drive, an object with {', '.join(NEEDS)}; type {name}={example}")
        check_law(self.friction, problems)
        if problems.mistakes:
            return
        if self.across is not None:
            self._check_across(problems)
        if not problems.mistakes:
            super()._check(problems)

    def _check_across(self, problems: Problems) -> None:
        first, other = self.along.period, self.across.period
        if not everywhere(abs(first - other) <= 1e-12 * other):
            problems.add(periods_differ("along", first, "across", other))
        if len(drive_of(self.across).jumps):
            problems.add(
                "across jumps in velocity, which needs an infinite load; allowed is a motion without jumps such as ss.Harmonic, or "
                "ss.drives.Pieces, whose acceleration jumps"
            )

    @property
    def breaks(self) -> Any:
        """Instants in (0, period) at which the track's motion across is not smooth [s]."""
        return () if self.across is None else drive_of(self.across).breaks

    @property
    def velocity_scale(self) -> Any:
        """The larger velocity scale of the track's motions [m/s]."""
        along = drive_of(self.along).velocity_scale
        return along if self.across is None else maximum(along, drive_of(self.across).velocity_scale)

    @property
    def still_load(self) -> Any:
        """Normal force where the track does not move across [N]."""
        return self.mass * self.gravity * cos(self.tilt) if self.load is None else self.load

    def normal_force(self, t: Numeric) -> Any:
        """Normal force while the mass stays on the track [N]; negative where only adhesion would hold it."""
        return self.still_load if self.across is None else self.still_load + self.mass * self.across.acceleration(t)

    @property
    def notes(self) -> list[str]:
        """Remarks on these numbers that are not errors, such as a load that falls to zero under a law that cannot fly."""
        law, least = adapted(self.friction), self._least_load
        remarks = [*law.notes(self.still_load), *remarks_on_gravity(self.gravity)]
        if law.dynamic and least <= 0:
            remarks.append(
                f"the track throws the mass up: its load falls to {least:.4g} N, where a run ends, because a bristle has no impulse; under "
                "a set-valued law such as ss.Coulomb it flies and lands"
            )
        return remarks

    @property
    def _least_load(self) -> float:
        """The smallest normal force at some instants of a period, of all cases [N]."""
        import numpy as np

        looks = 1 if self.across is None else _LOOKS
        return float(np.min([np.min(np.asarray(self.normal_force(self.period * (k / looks)))) for k in range(looks)]))

    def mirrored(self) -> MovingTrack:
        """The track with forwards and backwards exchanged."""
        from stickslip.models.mirroring import image_of_fields

        return image_of_fields(self, ("tilt", "force"))

    def bodies(self) -> Mapping[str, Any]:
        """The mass."""
        down = self.mass * self.gravity * sin(self.tilt)
        return {"mass": Body(self.mass, force=down + self.force, gravity=down)}

    def contacts(self) -> Mapping[str, Any]:
        """Its contact with the track."""
        flies = None if self.across is None else self.restitution  # a load that does not vary never falls to zero
        return {"mass": Contact("mass", self.friction, on=self.along, load=lambda t, x: self.normal_force(t), restitution=flies)}
