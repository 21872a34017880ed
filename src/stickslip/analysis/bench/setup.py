"""The common setup of the experiments on one law: its typical quantities, and solving a mechanism with it."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from stickslip.analysis.bench.contact import MovedContact, constant_velocity
from stickslip.analysis.bench.findings import Experiment
from stickslip.analysis.bench.probe import Probe
from stickslip.basics.errors import SolveError
from stickslip.solvers import solve

#: Velocities of quasi-static motion and of sliding, in units of the typical velocity.
SLOW, FAST = 0.01, 3.0
#: Displacement used for laws without a characteristic length [m].
LENGTH = 1e-6
_BOUNDLESS = 1e12  # an applied force beyond any static friction limit [N]
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
        Mass that is pulled by the spring or driven by the force [kg].
    stiffness, speed : float or None
        Spring stiffness [N/m] and speed of its end [m/s] in the stick-slip experiment.
    plain : bool
        Whether mechanisms are solved in plain Python, and therefore over shorter runs.
    """

    law: Any
    load: float
    mass: float
    stiffness: float | None = None
    speed: float | None = None
    plain: bool = False

    @cached_property
    def probe(self) -> Probe:
        """The law with a uniform interface."""
        return Probe(self.law, self.load)

    @property
    def random(self) -> bool:
        """Whether the law cannot be compiled, and is therefore tested over shorter motions."""
        return not self.probe.law.compiles

    @property
    def set_valued(self) -> bool:
        """Whether the law is set-valued, so that rest is exact."""
        return not self.probe.law.dynamic

    @property
    def remembers(self) -> bool:
        """Whether the law has inner states."""
        return self.probe.law.states > 0

    @property
    def typical_speed(self) -> float:
        """Velocity over which friction changes [m/s]; for a law without one, that of free oscillations on the contact."""
        if self.contact_stiffness > 0 and self.probe.law.velocity_scale() is None:
            return self.pace * self.length
        return self.probe.velocity_scale

    @property
    def crawl(self) -> float:
        """Velocity of quasi-static motion [m/s]; outside the band in which a law needs the applied force."""
        return (10.0 if self.probe.law.needs_applied else SLOW) * self.typical_speed

    @cached_property
    def length(self) -> float:
        """Typical pre-sliding deflection, or the slip over which the law's states change as the law declares it [m]."""
        own = self.probe.law.slip_length(self.load)
        if own is not None:
            return float(own)
        return math.fsum(self.probe.scale) / self.probe.law.states if self.remembers else LENGTH

    @cached_property
    def holds(self) -> tuple[float, float]:
        """Static friction limits (backward, forward) [N]; for a law with inner states, slow steady friction."""
        if self.set_valued:
            low, high = self.probe.law.breakaway(self.load)
            return float(low), float(high)
        if self.remembers:
            return self.steady_force(-SLOW * self.typical_speed), self.steady_force(SLOW * self.typical_speed)
        low, high = (float(self.probe.force(0.0, (), (), side * _BOUNDLESS)) + 0.0 for side in (-1.0, 1.0))
        return low, high

    @cached_property
    def force(self) -> float:
        """A typical friction force: the forward static friction limit or, if that is zero, the sliding friction [N]."""
        held = self.holds[1]
        return held if held > 0 else abs(float(self.probe.force(FAST * self.typical_speed, (), ()))) or 0.1 * self.load

    @cached_property
    def fall(self) -> float:
        """Drop from the forward static friction limit to the least sliding friction, up to thirty times the typical velocity [N]."""
        held = self.holds[1]
        slides = (self.steady_force(v * self.typical_speed) for v in (1.5, FAST, 10.0, 30.0))
        return max(held - min(slides), 0.0) if held > 0 else 0.0

    @cached_property
    def contact_stiffness(self) -> float:
        """Stiffness at rest [N/m]; 0 without inner states."""
        if not self.remembers:
            return 0.0
        probe, small = self.probe, 1e-3 * min(self.probe.scale)
        still, fresh = probe.start
        bent = tuple(small * rate / 1e-12 for rate in probe.response(1e-12, still, fresh)[1])
        return (float(probe.force(0.0, bent, fresh)) - float(probe.force(0.0, still, fresh))) / small

    @cached_property
    def pace(self) -> float:
        """Characteristic frequency of the bench [rad/s]: of the mass on the contact, or force / (mass typical velocity)."""
        if self.contact_stiffness > 0:
            return math.sqrt(self.contact_stiffness / self.mass)
        return self.force / (self.mass * self.typical_speed)

    def contact(self, path: float, rtol: float = 1e-10) -> MovedContact:
        """A fresh contact that will be moved over a path of this length [m]."""
        return MovedContact(self.probe, self.probe_force * path, 1e-6 if self.random else rtol)

    @property
    def probe_force(self) -> float:
        """A force that scales the errors of work [N]; known before any motion is computed."""
        return 0.1 * self.load

    def steady_force(self, v: float) -> float:
        """Steady friction force at a constant velocity [N]; for a random law, the mean over a displacement."""
        if not self.remembers:
            return float(self.probe.force(v, (), ()))
        stretch, before = 8.0 * self.length, math.inf
        moved = self.contact(stretch)
        for _ in range(14):
            done = moved.done
            moved.follow(stretch / abs(v), constant_velocity(v))
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
        """A run of a mechanism. Set-valued laws use the plain solver, which locates events as reliably and needs no compilation."""
        if self.set_valued:
            return solve(mechanism, rtol=1e-11, method="dop853", **arguments)
        return solve(mechanism, rtol=1e-6 if self.short else rtol, method="dop853" if self.short else "auto", **arguments)


def shorter(experiment: Callable[[Setup], Experiment]) -> Callable[[Setup], Experiment]:
    """Wrap an experiment: if the compiled solver fails, it is repeated with a short run in plain Python."""

    @functools.wraps(experiment)
    def tried(bench: Setup) -> Experiment:
        try:
            return experiment(bench)
        except SolveError:
            if bench.short:
                raise
            repeated = experiment(replace(bench, plain=True))
            return replace(repeated, remark="; ".join(filter(None, (repeated.remark, _SHORT))))

    return tried


_SHORT = "the compiled solver gave up, so this is a short run in plain Python"
