"""A periodic orbit: a motion of any model that returns to its state, and the growth of disturbances along it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.contracts import Array
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.notebook_display import Drawn
from stickslip.dynamics.periodic.kinds_of_orbits import NEUTRAL, OfBodies, OfModes, kind_of_orbit
from stickslip.dynamics.periodic.newton import STEP
from stickslip.dynamics.stroboscopic.differences import difference_jacobian
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, coordinates
from stickslip.models.model_adapter import adapter_of
from stickslip.results.verbs import OfOneRun

if TYPE_CHECKING:
    from stickslip.dynamics.flows.flow_stretches import Passage

RTOL = 1e-12
RUNS = 1e-10  # of the runs along an orbit: its multipliers have nine digits then (the state itself is found at rtol)


@sealed
class PeriodicOrbit(Drawn, OfOneRun):
    """A periodic motion of a robot, machine or flow: its state, its multipliers and its properties.

    With a period of the equations it begins on the strobe. Without one it is a limit cycle: it begins on a section, and how long it takes
    is part of the result. Velocities are periodic, positions may drift. On a track that repeats the position is periodic modulo its
    wavelength: the motion advances by a whole number of wavelengths.

    Parameters
    ----------
    model : Robot, machine or SwitchingFlow
        What moves.
    period : int
        Drive periods until the motion repeats; without a period turns, which are returns to the section.
    strobe_state : array
        The state with which it begins. Whole numbers that laws remember come last; of a flow the place of its mode among its modes.
    residual : float
        Distance between the state and its image after the motion, in the scales of its coordinates.
    rtol : float
        Tolerance of the runs that it was computed with.
    notes : tuple of str
        Remarks, such as that the orbit of a forced flow is an equilibrium.
    duration : float
        How long it takes [s]; with a period of the equations so many of those if not given.
    section : Section, optional
        Without a period: where it is cut.
    on_section : array, optional
        The state there, where the cycle is shown from a switch (``section="stick of block"``).
    method : str
        Of a flow: by what it is followed, as for `passage`.

    Examples
    --------
    >>> import stickslip as ss
    >>> orbit = ss.periodic_orbit(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb"))
    >>> orbit.type, orbit.stable, orbit.names, [float(round(m, 6)) for m in orbit.multipliers]
    ('IV', True, ('v',), [0.089023])

    A block on a belt has no period. Riding the belt forgets everything:

    >>> law = ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)
    >>> cycle = ss.periodic_orbit(ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=law))
    >>> round(cycle.duration, 10), cycle.type, cycle.multipliers.tolist()
    (7.6112592541, 'stick-slip', [0.0])
    """

    model: Any
    period: int
    strobe_state: Array
    residual: float
    rtol: float = RTOL
    notes: tuple[str, ...] = ()
    duration: Any = None
    section: Any = None
    on_section: Any = None
    method: str = "auto"
    _passage: Any = None  # of a flow, where it was found

    def __post_init__(self) -> None:
        if self.duration is None:
            object.__setattr__(self, "duration", self.period * float(self.model.period))

    _drawn_by = "phase"

    def _drawn(self) -> Any:
        return self.run

    # ---- where it is ----
    @cached_property
    def at(self) -> Coordinates:
        """The coordinates of its states."""
        return coordinates(self.model, len(self.strobe_state))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the numbers of the state."""
        return self.at.start_names

    @property
    def state(self) -> Array:
        """The state with which it begins, in the order of `names`: of a flow without its mode, which is `mode`."""
        return self.strobe_state[: len(self.names)]

    @property
    def mode(self) -> Any:
        """The mode of a flow in which it begins; None of a machine, whose modes follow from the state."""
        return self._kind.mode(self)

    @property
    def section_state(self) -> Array:
        """The state by which it was computed and is followed, also where the cycle is shown from a switch."""
        return self.strobe_state if self.on_section is None else np.asarray(self.on_section)

    @property
    def start(self) -> dict[str, Any]:
        """The state as `solve` takes a start."""
        return self.at.start(self.strobe_state)

    @property
    def period_time(self) -> float:
        """The same as `duration` [s]."""
        return float(self.duration)

    @cached_property
    def run(self) -> Any:
        """The motion once around, with its dense output."""
        from stickslip.solvers import solve

        how: dict[str, Any] = {"duration": self.duration} if self.is_cycle else {"periods": self.period, "settle": 0}
        how |= {"rtol": max(self.rtol, RUNS)} if adapter_of(self.model).has_tolerance else {}
        run = solve(self.model, keep="trajectory", **self.at.begun(self.model, self.strobe_state), **how)
        return replace(run, known_period=self.period)

    def noted(self) -> PeriodicOrbit:
        """The same with remarks on it, where it is known that it comes back, such as that a flow touches a guard."""
        remarks = self._kind.remarks(self)
        return replace(self, notes=(*self.notes, *remarks)) if remarks else self

    @property
    def is_cycle(self) -> bool:
        """Whether the equations have no period, so that its duration is its own."""
        return self.model.period is None

    # ---- growth of disturbances ----
    @property
    def _kind(self) -> OfBodies | OfModes:
        return kind_of_orbit(self.at)

    @property
    def _length(self) -> dict[str, Any]:
        """Over how many periods, or how long, small changes are followed."""
        return {"span": self.duration} if self.is_cycle else {"periods": self.period}

    @cached_property
    def passage(self) -> Passage:
        """Of a flow the passage once around the orbit, with its derivative, its switches and its extremes."""
        return self._kind.passage(self) if self._passage is None else self._passage

    @cached_property
    def monodromy(self) -> Array:
        """The derivative of the state after the motion with respect to that before it; `evidence` says how it was found."""
        return np.asarray(self._kind.derivative(self))

    @cached_property
    def multipliers(self) -> Array:
        """Floquet multipliers, the largest first; the 1 of cyclic positions, and of a cycle that along it, are left out.

        Real where all of them are.
        """
        return multipliers_of(self.at.drifts.without(self.monodromy), self._kind.lost(self), self.is_cycle)

    def _jacobian(self, step: float) -> Array:
        return difference_jacobian(self.model, self.strobe_state, rtol=self.rtol, step=step, at=self.at, **self._length)

    @cached_property
    def evidence(self) -> str:
        """How the multipliers were found, and what limits them."""
        return str(self._kind.evidence(self))

    @cached_property
    def differences(self) -> Array:
        """The multipliers from finite differences of the map, as an independent check; NaN at a state next to a stop."""
        return multipliers_of(self._jacobian(STEP), 0, self.is_cycle)

    @property
    def stable(self) -> bool:
        """Whether small disturbances die out: all multipliers within the unit circle."""
        return self.stability == "stable"

    @property
    def stability(self) -> str:
        """The stability in words, from the multipliers."""
        return stability_of(self.multipliers)

    @property
    def memory(self) -> float:
        """Drive periods, or turns, in which a small disturbance decays to 1/e (negative: it grows); 0 if sticking removes it at once."""
        largest = float(abs(self.multipliers).max(initial=0.0))
        return 0.0 if largest == 0.0 else float("inf") if largest == 1.0 else -self.period / float(np.log(largest))

    @property
    def _multipliers_text(self) -> str:
        return "multipliers " + ", ".join(f"{m:.6g}" for m in self.multipliers)

    # ---- how it moves ----
    @property
    def events(self) -> list[Any]:
        """Every change of mode within the motion (dynamic laws: reversals of the contact's velocity)."""
        return list(self._kind.events(self))

    @cached_property
    def patterns(self) -> dict[str, str]:
        """Signs of the slip within the motion period by contact, such as "+0-0"; a cycle's begin with rest if there is any."""
        return dict(self._kind.patterns(self))

    @property
    def pattern(self) -> Any:
        """Signs of the motion period in order, such as "+0-0", of several contacts of the first; of a flow its modes in order."""
        return self._kind.pattern(self)

    @property
    def type(self) -> str:
        """Type of the motion: "I" to "IV", "rest", "presliding" or "other".

        Of a cycle "stick-slip", "slip", "reversing" or "oscillation", see `stickslip.analysis.oscillation.kind_of_cycle`; of a flow
        "periodic" or "steady".
        """
        return str(self._kind.type(self))

    @property
    def words(self) -> Mapping[str, Any]:
        """What it is in words, by the name of a column: one word, or one for each contact by its name."""
        return self._kind.words(self)

    @property
    def label(self) -> str:
        """A name that is the same all along a region of parameters: the type, the patterns of several contacts, or the modes of a flow."""
        return str(self._kind.label(self))

    @property
    def signature(self) -> str:
        """What it does, in words that change where it becomes another motion: patterns, or switches, and what it touches how often."""
        return str(self._kind.signature(self))

    def grazes(self, before: str, after: str) -> bool:
        """Whether something that a motion only touches makes the difference of two signatures."""
        return bool(self._kind.grazes(before, after))

    @property
    def numbers(self) -> tuple[str, ...]:
        """Names of the single numbers that a motion of its kind has, such as "mean_velocity" and "margin", or "amplitude" of a cycle."""
        return tuple(self._kind.numbers(self))

    @property
    def margin(self) -> float:
        """Distance to the next border of motion types; 0 is on it."""
        return float(self.motion.margin)

    @property
    def amplitude(self) -> float:
        """Of a cycle half of the way from the lowest to the highest position, of the only body or the largest, less the mean motion [m]."""
        return float(self.motion.amplitude)

    def _facts(self) -> dict[str, Any]:
        return {**self._kind.facts(self), "stability": f"{self.stability}; {self._multipliers_text}"}

    def __repr__(self) -> str:
        stability = f"{self.stability} ({self._multipliers_text})"
        begun = ", ".join(f"{name} = {value:.9g}" for name, value in zip(self.names, self.state, strict=True))
        return f"<PeriodicOrbit: {self._kind.summary(self)}, {stability}, {self._kind.begins(self)}{begun}, residual {self.residual:.1e}>"


def stability_of(multipliers: Array) -> str:
    """Stability from multipliers: "stable", "neutral", "unstable" or "of unknown stability".

    Neutral are those with a multiplier on the unit circle, to rounding, and none beyond it; unknown are those that the map does not have.

    Examples
    --------
    >>> [stability_of(np.array(m)) for m in ([0.5], [1.0, 0.5], [-2.0, 0.5], [np.nan])]
    ['stable', 'neutral', 'unstable', 'of unknown stability']
    """
    sizes = abs(np.asarray(multipliers))
    if not np.isfinite(sizes).all():
        return "of unknown stability"
    return "stable" if np.all(sizes < 1.0 - NEUTRAL) else "unstable" if np.any(sizes > 1.0 + NEUTRAL) else "neutral"


def multipliers_of(M: Array, rank_loss: int, autonomous: bool = False) -> Array:
    """The eigenvalues of a monodromy matrix, the largest first; real where all are.

    Parameters
    ----------
    rank_loss : int
        How many directions are wiped out at one instant on the way: so many of the smallest eigenvalues are 0, and not what rounding makes
        of them. The rank is as much lower; contacts that rest one after the other count once.
    autonomous : bool
        Whether the flow does not depend on time: the eigenvalue 1 along the orbit is left out.
    """
    if not np.isfinite(M).all():
        return np.full(len(M) - autonomous, np.nan)
    multipliers: Array = np.linalg.eigvals(M)
    if autonomous:
        multipliers = np.delete(multipliers, int(np.argmin(abs(multipliers - 1.0))))
    multipliers = multipliers[np.argsort(-abs(multipliers), kind="stable")]
    if rank_loss and len(multipliers):
        multipliers[-int(rank_loss) :] = 0.0
    return multipliers.real if np.all(multipliers.imag == 0) else multipliers
