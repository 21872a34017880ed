"""The common setup of the experiments on one law: its typical quantities, and solving a mechanism with it."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from stickslip.benching.contact import Contact, steady
from stickslip.benching.findings import Experiment
from stickslip.benching.probe import Probe
from stickslip.errors import SolveError
from stickslip.solvers import solve

#: Quasi-static motions have this share of the typical velocity; several times it is sliding.
SLOW, FAST = 0.01, 3.0
#: Length on which laws without any are moved [m].
LENGTH = 1e-6
_BOUNDLESS = 1e12  # an applied force that no contact holds [N]
HELD = "Rest is a mode of its own here, not a small velocity: "


@dataclass(frozen=True, eq=False)
class Setup:
    """A law on the bench.

    Parameters
    ----------
    law : law
    load : float
        Normal force [N].
    mass : float
        Mass that is pulled and pushed [kg].
    stiffness, speed : float or None
        Spring [N/m] and speed of its end [m/s] of the stick-slip experiment.
    plain : bool
        Whether mechanisms are solved in plain Python, and therefore moved less far.
    """

    law: Any
    load: float
    mass: float
    stiffness: float | None = None
    speed: float | None = None
    plain: bool = False

    @cached_property
    def probe(self) -> Probe:
        """The law called in one way."""
        return Probe(self.law, self.load)

    @property
    def random(self) -> bool:
        """Whether the law cannot be compiled and is moved less far."""
        return not self.probe.law.compiles

    @property
    def set_valued(self) -> bool:
        """Whether rest is exact."""
        return not self.probe.law.dynamic

    @property
    def remembers(self) -> bool:
        """Whether the law has inner states."""
        return self.probe.law.states > 0

    @property
    def typical_speed(self) -> float:
        """Velocity over which friction changes [m/s]; of a law that has none, that of the mass ringing on the contact."""
        if self.contact_stiffness > 0 and self.probe.law.velocity_scale() is None:
            return self.pace * self.length
        return self.probe.velocity_scale

    @property
    def crawl(self) -> float:
        """Velocity of quasi-static motions [m/s]; outside the band of a law that asks in it for the other forces."""
        return (10.0 if self.probe.law.needs_applied else SLOW) * self.typical_speed

    @cached_property
    def length(self) -> float:
        """Typical pre-sliding deflection, or what the law says is the slip in which its states change [m]."""
        own = self.probe.law.slip_length(self.load)
        if own is not None:
            return float(own)
        return math.fsum(self.probe.scale) / self.probe.law.states if self.remembers else LENGTH

    @cached_property
    def holds(self) -> tuple[float, float]:
        """Static friction limits of the contact: (backward, forward) forces [N]."""
        if self.set_valued:
            low, high = self.probe.law.breakaway(self.load)
            return float(low), float(high)
        if self.remembers:
            return self.steady_force(-SLOW * self.typical_speed), self.steady_force(SLOW * self.typical_speed)
        low, high = (float(self.probe.force(0.0, (), (), side * _BOUNDLESS)) + 0.0 for side in (-1.0, 1.0))
        return low, high

    @cached_property
    def force(self) -> float:
        """A typical friction force: what it holds forwards, or where it holds nothing what sliding takes [N]."""
        held = self.holds[1]
        return held if held > 0 else abs(float(self.probe.force(FAST * self.typical_speed, (), ()))) or 0.1 * self.load

    @cached_property
    def fall(self) -> float:
        """From what it holds forwards to the least that slides, up to thirty times the typical velocity [N]."""
        held = self.holds[1]
        slides = (self.steady_force(v * self.typical_speed) for v in (1.5, FAST, 10.0, 30.0))
        return max(held - min(slides), 0.0) if held > 0 else 0.0

    @cached_property
    def contact_stiffness(self) -> float:
        """Stiffness at rest [N/m], 0 without inner states."""
        if not self.remembers:
            return 0.0
        probe, small = self.probe, 1e-3 * min(self.probe.scale)
        still, fresh = probe.start
        bent = tuple(small * rate / 1e-12 for rate in probe.response(1e-12, still, fresh)[1])
        return (float(probe.force(0.0, bent, fresh)) - float(probe.force(0.0, still, fresh))) / small

    @cached_property
    def pace(self) -> float:
        """The bench's own frequency [rad/s]: the mass on the contact, or how fast the typical force speeds it up."""
        if self.contact_stiffness > 0:
            return math.sqrt(self.contact_stiffness / self.mass)
        return self.force / (self.mass * self.typical_speed)

    def contact(self, path: float, rtol: float = 1e-10) -> Contact:
        """A fresh contact that is to be moved over a path [m]."""
        return Contact(self.probe, self.probe_force * path, 1e-6 if self.random else rtol)

    @property
    def probe_force(self) -> float:
        """A force against which errors of work are measured [N]; known before anything was moved."""
        return 0.1 * self.load

    def steady_force(self, v: float) -> float:
        """Friction force at a constant velocity, when it no longer changes [N]; the mean over a way for a random law."""
        if not self.remembers:
            return float(self.probe.force(v, (), ()))
        stretch, before = 8.0 * self.length, math.inf
        moved = self.contact(stretch)
        for _ in range(14):
            done = moved.done
            moved.follow(stretch / abs(v), steady(v))
            mean = (moved.done - done) / stretch * math.copysign(1.0, v)
            now = mean if self.random else moved.force(v)
            if abs(now - before) < 1e-9 * abs(now) or (self.random and before < math.inf):
                return now
            stretch, before = 2.0 * stretch, now
        return now

    @property
    def short(self) -> bool:
        """Whether runs of mechanisms have to be short."""
        return self.plain or self.random

    def solved(self, mechanism: Any, rtol: float, **arguments: Any) -> Any:
        """A run of a mechanism, compiled; a set-valued law goes to the plain solver, as sure of its switches, which compiles nothing."""
        if self.set_valued:
            return solve(mechanism, rtol=1e-11, method="dop853", **arguments)
        return solve(mechanism, rtol=1e-6 if self.short else rtol, method="dop853" if self.short else "auto", **arguments)


def shorter(experiment: Callable[[Setup], Experiment]) -> Callable[[Setup], Experiment]:
    """The experiment, once more with a short run in plain Python where the compiled solver gives up."""

    @functools.wraps(experiment)
    def tried(bench: Setup) -> Experiment:
        try:
            return experiment(bench)
        except SolveError:
            if bench.short:
                raise
            found = experiment(replace(bench, plain=True))
            return replace(found, remark="; ".join(filter(None, (found.remark, _SHORT))))

    return tried


_SHORT = "the compiled solver gave up, so this is a short run in plain Python"
