"""Machines in which nothing rubs: the exact solver takes them, and everything that follows a run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import stickslip as ss
from every import Hammer
from stickslip.maths import cos, pi


@dataclass(frozen=True, eq=False)
class Oscillator(ss.Machine):
    """x'' + c x' + x = F cos t, or with a wall that throws the mass back."""

    force: float
    damping: float
    wall: float = 100.0
    period = property(lambda self: 2 * pi)

    def bodies(self):
        return {"mass": ss.Body(1.0, force=lambda t, x, v: self.force * cos(t) - self.damping * v - x)}

    def stops(self):
        return {("mass", None): ss.Stop(gap=self.wall, restitution=0.8)}


@dataclass(frozen=True, eq=False)
class VanDerPol(ss.Machine):
    strength: float
    time_scale = 6.0

    def bodies(self):
        return {"mass": ss.Body(1.0, position=0.5, force=lambda t, x, v: self.strength * (1.0 - x * x) * v - x)}


def test_an_oscillator_has_the_multipliers_and_the_amplitude_of_the_formula():
    """At resonance the amplitude is F/c, and the multipliers are exp(2 pi s), s = -c/2 +- i sqrt(1 - c^2/4)."""
    orbit = ss.periodic_orbit(Oscillator(force=0.3, damping=0.2))
    s = -0.1 + 1j * np.sqrt(0.99)
    assert sorted(orbit.multipliers, key=np.imag) == pytest.approx([np.exp(2 * pi * s), np.exp(2 * pi * s.conjugate())], abs=1e-12)
    run = ss.solve(Oscillator(force=0.3, damping=0.2), periods=60)
    assert run.method == "exact" and np.ptp(run.at(np.linspace(59, 60, 401) * 2 * pi)["x"]) == pytest.approx(3.0, rel=1e-4)


def test_a_hit_shrinks_the_plane_of_states_by_the_square_of_the_restitution():
    """What else shrinks it is the damper: the product of the multipliers is e^(2 hits) exp(-c T), whatever the orbit is."""
    machine = Oscillator(force=0.3, damping=0.2, wall=1.0)
    orbit = ss.periodic_orbit(machine)
    hits = int(ss.solve(machine.replace(damping=np.array([0.2])), periods=200).hits[0, 0])
    assert hits > 0 and np.prod(orbit.multipliers).real == pytest.approx(0.8 ** (2 * hits) * np.exp(-0.2 * 2 * pi * orbit.period), rel=1e-9)


def test_a_cycle_without_a_drive_is_that_of_van_der_pol():
    """Its period is that of the tables."""
    cycle = ss.periodic_orbit(VanDerPol(1.0))
    motion = ss.motion(ss.solve(VanDerPol(1.0), duration=100.0))
    assert (cycle.duration, motion.duration) == (pytest.approx(6.66328685933, abs=1e-9), pytest.approx(6.66328685933, abs=1e-6))


def test_a_batch_agrees_with_the_judge_case_by_case():
    batch = Hammer(np.array([4.0, 5.0, 6.0]))
    lanes = ss.solve(batch, periods=10)
    judged = [ss.solve(Hammer(k), periods=10, method="dop853") for k in batch.stiffness]
    assert lanes.mean_velocity == pytest.approx([ss.mean_velocity(run) for run in judged], abs=1e-7)
    assert lanes.hits[:, 0].tolist() == [sum(e.kind == "hit" and e.t > run.strobe_times[-2] for e in run.events) for run in judged]
