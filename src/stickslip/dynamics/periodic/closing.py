"""How motions are closed: of each kind of model the states that are to come back, and their derivatives, for one Newton's method.

Forced motions of machines come back to the strobe, cycles of machines to a section after a time that is an unknown too, and motions of
flows to where their passage began.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import SolveError
from stickslip.dynamics.derivatives.tangents import Directions, changes_along, not_followed
from stickslip.dynamics.flows.flow_stretches import Passage, passage
from stickslip.dynamics.periodic.cycle_sections import Section
from stickslip.dynamics.periodic.newton import Residuals, Root, Share, Slopes, newton_within
from stickslip.dynamics.stroboscopic.strobe_maps import Coordinates, strobe_map
from stickslip.models.machine_adapter import machine_of
from stickslip.models.switching_flow import SwitchingFlow
from stickslip.solvers.plain.composed_flows import composed
from stickslip.solvers.plain.user_functions import value_and_slopes

_LONGEST = 0.1  # of the size of the state: so long may a step of a forced flow be in any case
_KNOWN = 16  # passages that are kept


class Closing(Protocol):
    """A motion that is to come back. Unknowns are in their scales; whole numbers that laws remember, or a mode, are held meanwhile."""

    @property
    def has_slopes(self) -> bool:
        """Whether derivatives are followed along the motion; else they are differences."""

    @property
    def reach(self) -> float:
        """Longest step."""

    @property
    def in_turn(self) -> bool:
        """Whether states are followed one after the other, and not side by side."""

    def share(self, memory: Array) -> Share | None:
        """The part of a step that may be taken, where that depends on the place."""

    def residuals(self, memory: Array) -> Residuals:
        """How far states miss themselves."""

    def slopes(self, memory: Array) -> Slopes:
        """The same of one state, with its derivatives."""

    def after(self, u: Array, memory: Array) -> Array:
        """The whole numbers after the motion."""


def closed(motion: Closing, guess: Array, memory: Array, **options: Any) -> Root:
    """The motion that comes back to which Newton's method goes from a guess; options as for `newton`.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.dynamics.stroboscopic.strobe_maps import coordinates
    >>> robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    >>> at = coordinates(robot)
    >>> root = closed(StrobeReturns(robot, at, 1, 1e-12), np.array([0.0]), np.array([]))
    >>> root.good, bool(root.residual < 1e-12)
    (True, True)
    """
    slopes = motion.slopes if motion.has_slopes else None
    return newton_within(
        motion.residuals, motion.after, guess, memory, slopes, motion.share, reach=motion.reach, in_turn=motion.in_turn, **options
    )


@dataclass(frozen=True)
class StrobeReturns:
    """A machine with a period, after some of its drive periods: the smooth coordinates of its strobe state."""

    model: Model
    at: Coordinates
    period: int
    rtol: float
    reach: float = np.inf
    in_turn: bool = False

    @property
    def has_slopes(self) -> bool:
        """Where small changes are followed."""
        return not not_followed(self.model)

    def share(self, memory: Array) -> None:
        """Any step may be taken."""

    def residuals(self, memory: Array) -> Residuals:
        """States after the periods, less those before."""
        return lambda u: self._missed(self._ends(u, memory)[:, : self.at.smooth], u)

    def slopes(self, memory: Array) -> Slopes:
        """With small changes in all directions, that go along."""
        at, scales = self.at, self.at.scales[: self.at.smooth]

        def at_point(u: Array) -> tuple[Array, Array]:
            begun = np.tile(np.append(u * scales, memory), (at.smooth, 1))
            changes = changes_along(self.model, begun, np.diag(scales), self.period, Directions(rtol=self.rtol))
            return self._missed(changes.state[0][: at.smooth], u), (changes.change / scales).T - np.eye(at.smooth)

        return at_point

    def after(self, u: Array, memory: Array) -> Array:
        """What laws remember then."""
        return self._ends(u, memory)[0, self.at.smooth :]

    def _ends(self, u: Array, memory: Array) -> Array:
        held = np.broadcast_to(memory, (*u.shape[:-1], len(memory)))
        return strobe_map(self.model, np.concatenate([u * self.at.scales[: self.at.smooth], held], axis=-1), self.period, self.rtol).state

    def _missed(self, end: Array, u: Array) -> Array:
        scales = self.at.scales[: self.at.smooth]
        return end / scales - u if not self.at.comes_again else np.asarray(self.at.difference(end, u * scales) / scales)


@dataclass(frozen=True)
class SectionReturns:
    """A machine without a period, on a section: the other coordinates, and how long it takes in the time `unit`."""

    model: Model
    at: Coordinates
    section: Section
    rtol: float
    unit: float
    reach: float = 0.5
    in_turn: bool = False

    @property
    def has_slopes(self) -> bool:
        """Under laws with inner states: differences would smooth what turns sharply."""
        return machine_of(self.model).has_inner_states and not not_followed(self.model)

    def share(self, memory: Array) -> None:
        """Any step may be taken."""

    def residuals(self, memory: Array) -> Residuals:
        """States after their durations, less those before."""
        return lambda U: self.section.misses(self.model, self.at, U, memory, self.rtol, self.unit)

    def slopes(self, memory: Array) -> Slopes:
        """By small changes along the motion, and the rates at its end."""
        return lambda u: self.section.slopes(self.model, self.at, u, memory, self.rtol, self.unit)

    def after(self, u: Array, memory: Array) -> Array:
        """What laws remember then."""
        return self.section.ends(self.model, self.at, u[None, :], memory, self.rtol, self.unit)[0, self.at.smooth :]


@dataclass(frozen=True)
class PassageReturns:
    """A flow after a passage of a duration, which without a period is one more unknown, and then no step goes along the motion.

    Unknowns are measured in the size of the guess; what is held is the place of the mode.
    """

    flow: SwitchingFlow
    size: float
    duration: float
    how: dict[str, Any]
    has_slopes: bool = True
    reach: float = np.inf
    in_turn: bool = True
    _known: dict[bytes, Passage] = field(default_factory=dict)
    failures: list[SolveError] = field(default_factory=list)  # what could not be followed

    @property
    def is_free(self) -> bool:
        """Whether its duration is unknown."""
        return self.flow.period is None

    def unknowns(self, y: Array) -> Array:
        """Those of a state whose passage takes as long as was guessed."""
        return np.append(y / self.size, 1.0) if self.is_free else y / self.size

    def state(self, u: Array) -> Array:
        """The state."""
        return (u[:-1] if self.is_free else u) * self.size

    def time(self, u: Array) -> float:
        """The duration."""
        return float(u[-1] * self.duration) if self.is_free else self.duration

    def passage(self, u: Array, memory: Array) -> Passage:
        """The passage from there."""
        key = np.append(u, memory).tobytes()
        if key not in self._known:
            if len(self._known) >= _KNOWN:
                self._known.pop(next(iter(self._known)))
            self._known[key] = passage(self.flow, self.state(u), self.mode(memory), self.time(u), **self.how)
        return self._known[key]

    def miss(self, u: Array, memory: Array) -> Array:
        """How far a passage ends from its start, but for the drift of cyclic coordinates."""
        return self.flow.drifts.difference(self.passage(u, memory).state, self.state(u))

    def extent(self, done: Passage) -> float:
        """How far the state that moves most moves."""
        return extent_of(self.flow, done)

    def mode(self, memory: Array) -> Any:
        """The mode that is held."""
        return list(self.flow.modes)[int(memory[0])]

    def residuals(self, memory: Array) -> Residuals:
        """How far passages miss; no numbers where a flow cannot be followed."""
        return lambda U: np.array([self._missed(u, memory) for u in U])

    def slopes(self, memory: Array) -> Slopes:
        """By the derivative of the passage."""

        def at_point(u: Array) -> tuple[Array, Array]:
            F, n = self._missed(u, memory), len(self.state(u))
            if not np.isfinite(F).all():
                return F, np.full((len(F), len(u)), np.nan)
            done, shifts = self.passage(u, memory), self.flow.drifts.free
            A = done.monodromy - np.eye(n)
            A[shifts] = 0.0
            if not self.is_free:
                return F, A
            along, ahead = self._rate(memory[0], 0.0, self.state(u)), self._rate(self._place(done), self.time(u), done.state)
            ahead *= self.duration / self.size
            along /= max(float(np.linalg.norm(along)), 1e-300)
            return F, np.block([[A, ahead[:, None]], [along[None, :], np.zeros((1, 1))]])

        return at_point

    def after(self, u: Array, memory: Array) -> Array:
        """The mode then."""
        return np.array([self._place(self.passage(u, memory))])

    def share(self, memory: Array) -> Share:
        """No step is longer than the motion is large; a forced motion that hardly moves may be further from its orbit."""

        def of_step(u: Array, step: Array) -> float:
            n, extent = len(self.state(u)), self.extent(self.passage(u, memory)) / self.size
            if not self.is_free:
                return min(1.0, max(extent, _LONGEST) / max(float(abs(step).max()), 1e-300))
            return min(1.0, extent / max(float(abs(step[:n]).max()), 1e-300), 0.5 * float(u[-1]) / max(abs(float(step[n])), 1e-300))

        return of_step

    def _missed(self, u: Array, memory: Array) -> Array:
        try:
            missed = self.miss(u, memory) / self.size
        except SolveError as error:
            self.failures.append(error)
            missed = np.full(len(self.state(u)), np.nan)
        return np.append(missed, 0.0) if self.is_free else missed

    def _place(self, done: Passage) -> float:
        return float(list(self.flow.modes).index(done.mode))

    def _rate(self, number: float, t: float, y: Array) -> Array:
        field_there = composed(self.flow).fields[self.mode(np.array([number]))]
        rate: Array = np.array(value_and_slopes(field_there, t, y)[0], float)
        rate[self.flow.drifts.free] = 0.0
        return rate


def extent_of(flow: SwitchingFlow, done: Passage) -> float:
    """How far the state that moves most moves in a passage, of those on which something depends."""
    return float(np.delete(done.highest - done.lowest, flow.drifts.free).max(initial=0.0))
