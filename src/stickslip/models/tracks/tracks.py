"""Tracks: gravity along and across the track, friction that varies in time, and the paper's folded incline."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar

from stickslip.basics.contracts import Numeric, Track
from stickslip.basics.errors import Problems
from stickslip.basics.fields import Frozen, checked_number, everywhere
from stickslip.basics.maths import cos, is_symbol, pi, sin
from stickslip.basics.quantities import PHASE, TILT, Rule, example_of, quantity
from stickslip.models.tracks.profiles import AroundTrack, FrictionPatches, FrictionProfile, FrictionWave, place_grip_of


@dataclass(frozen=True, eq=False, init=False)
class Level(Frozen):
    """A horizontal track (or one whose incline was folded into the friction coefficients).

    Parameters
    ----------
    folded : float, optional
        The tilt that the friction coefficients of the robot already contain (Eq. 4.1) [rad]. It does not act on the robot; it is
        known so that notes can say where it is lost (`Robot.replace`).
    lost : bool
        Whether another friction law took the place of the one that contained it.

    Examples
    --------
    >>> Level().across(9.81), Level().along(9.81)
    (9.81, 0.0)
    """

    #: The tilt [rad] that a preset folded into the friction of its robot; no number of the robot, so that the equations do not know it.
    folded: ClassVar[Any] = 0.0
    #: Whether another law took the place of the one that contained it.
    lost: ClassVar[bool] = False
    #: What a file keeps of it beside its fields.
    kept_in_files: ClassVar[tuple[str, ...]] = ("folded", "lost")

    def __init__(self, folded: Any = 0.0, lost: bool = False):
        tilt = folded if is_symbol(folded) else _checked_tilt(folded)
        if is_symbol(tilt) or not everywhere(tilt == 0):
            object.__setattr__(self, "folded", tilt)
            if lost:
                object.__setattr__(self, "lost", True)

    def mirrored(self) -> Level:
        """The track with downhill and uphill exchanged."""
        return Level(folded=0.0 - self.folded, lost=self.lost)

    def across(self, gravity: Numeric) -> Any:
        """Component of gravity normal to the track [m/s^2]."""
        return gravity

    def along(self, gravity: Numeric) -> Any:
        """Component of gravity along the track, forwards [m/s^2]."""
        return 0.0


def _checked_tilt(folded: Any) -> Any:
    problems, typed = Problems("Level"), f"folded={example_of(TILT)}"
    tilt = checked_number("folded", folded, problems, TILT["rule"], TILT["allowed"], typed, TILT["unit"])
    problems.check()
    return tilt


@dataclass(frozen=True, eq=False)
class Incline(Frozen):
    """An inclined track with gravity acting along it; plus is downhill.

    A run uphill is a negative tilt: ``robot.replace({"track.tilt": -0.03})``.

    Parameters
    ----------
    tilt : float
        Angle of the track [rad], positive where forwards is downhill, -pi/2 < tilt < pi/2.

    Examples
    --------
    >>> round(Incline(tilt=0.03).along(9.81), 4)
    0.2943
    """

    tilt: float = field(metadata=TILT)

    def across(self, gravity: Numeric) -> Any:
        """Component of gravity normal to the track [m/s^2]."""
        return gravity * cos(self.tilt)

    def along(self, gravity: Numeric) -> Any:
        """Component of gravity along the track, forwards [m/s^2]."""
        return gravity * sin(self.tilt)


class VaryingInTime(AroundTrack):
    """Base of the tracks whose friction varies in time: friction that varies along the track is that of the track inside."""

    @property
    def grip_at(self) -> Any:
        """Factor on the friction by place, of the track inside; None where there is none."""
        return place_grip_of(self.track)

    @property
    def wavelength(self) -> Any:
        """Distance after which the track inside repeats [m]; None where it does not."""
        return getattr(self.track, "wavelength", None)


@dataclass(frozen=True, eq=False)
class VaryingFriction(VaryingInTime):
    r"""A track whose friction coefficients vary in time with the drive: by the factor :math:`1 + d\,\sin(n\omega t+\varphi)`.

    Gravity stays as it is on the track inside. The factor multiplies the load that the law receives, and thus all coefficients of a law
    proportional to the load (Coulomb, Stribeck, and the sliding friction of LuGre and related laws). Terms independent of the load, such as
    viscous friction and the stiffness of bristles, do not vary.

    Parameters
    ----------
    track : Level or Incline
        The track that defines gravity.
    depth : float
        d, relative amplitude of the variation about the mean, 0 <= depth < 1 [-].
    harmonic : int
        n, number of variations in one period of the drive.
    phase : float
        Phase relative to the start of the drive's period [rad].

    Examples
    --------
    >>> track = VaryingFriction(Level(), depth=0.5)
    >>> round(track.grip(0.25, period=1.0), 12), track.across(9.81)
    (1.5, 9.81)
    """

    track: Any
    depth: float = field(
        metadata=quantity(
            "depth of the variation of friction",
            "1",
            "d",
            example=0.3,
            rule=Rule(lambda d: (d >= 0) & (d < 1), "from 0 to below 1"),
            range=(0.0, 0.9),
        )
    )
    harmonic: int = 1
    phase: float = field(default=0.0, metadata=PHASE | {"label": "phase of the variation of friction"})

    def _check(self, problems: Problems) -> None:
        super()._check(problems)
        problems.whole("harmonic", self.harmonic, 1, example=1)

    def grip(self, t: Numeric, period: Numeric) -> Any:
        """Factor on the friction at a time, for a drive of this period [-]."""
        own = 1 + self.depth * sin(self.harmonic * (2 * pi / period) * t + self.phase)
        inner = grip_of(self.track)
        return own if inner is None else own * inner(t, period)


def grip_of(track: Any) -> Callable[[Any, Any], Any] | None:
    """The factor on the friction of a track, as a function of time and of the drive's period; None where friction does not vary."""
    return getattr(track, "grip", None)


def _innermost(track: Track) -> Any:
    """A track, or the one inside it."""
    inside = getattr(track, "track", None)
    return track if inside is None else _innermost(inside)


def folded_tilt(track: Track) -> Any:
    """The tilt that is folded into the friction on a track, or on the track inside it [rad]; 0 if there is none."""
    return getattr(_innermost(track), "folded", 0.0)


def law_was_replaced(track: Track) -> bool:
    """Whether a law took the place of one that contained the incline of a track, or of the track inside it."""
    return getattr(_innermost(track), "lost", False)


def without_its_law(track: Any) -> Any:
    """The same track, where another law takes the place of the one that contained its incline."""
    inside = getattr(track, "track", None)
    return Level(folded=track.folded, lost=True) if inside is None else track.replace(track=without_its_law(inside))


TRACKS = {cls.__name__.lower(): cls for cls in (Level, Incline, VaryingFriction, FrictionPatches, FrictionWave, FrictionProfile)}


def fold(coefficient: Any, tilt: Any) -> tuple[Any, Any]:
    """Friction coefficients (plus, minus) of a level track that stand for an isotropic one on an incline: Eqs 3.8 and 4.1.

    Exact for Coulomb friction. For laws with an inner state it is a different model (the paper's own), because
    there gravity acts on the bristle too.

    Examples
    --------
    >>> plus, minus = fold(0.18, 1.7 * pi / 180)
    >>> round(plus, 6), round(minus, 6)
    (0.150255, 0.209587)
    """
    return coefficient * cos(tilt) - sin(tilt), coefficient * cos(tilt) + sin(tilt)
