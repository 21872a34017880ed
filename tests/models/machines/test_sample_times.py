"""Several controllers with sample times of their own, against the recursion of their samples in plain Python."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from stickslip.maths import pi, sin


class Loop:
    """Holds what a function makes of the positions and velocities until its next sample."""

    def __init__(self, sample, value, forces=lambda held: {}):
        self.states, self.sample, self.scales = ("held",), sample, (1.0,)
        self.value, self.force = value, forces

    def start(self, t, x, v):
        return (self.value(t, x, v),)

    def rates(self, t, x, v, z):
        return (0.0,)

    def sampled(self, t, x, v, z):
        return (self.value(t, x, v),)

    def forces(self, t, x, v, z):
        return self.force(z[0])


@dataclass(frozen=True, eq=False)
class Axes(ss.Machine):
    """Two carts: a spring by samples every `slow`, a damper every `fast`, and the other one's own loop."""

    fast: float = 0.05
    slow: float = 0.2
    other: float = 0.1
    friction: Any = None
    period = property(lambda self: 2.0 if self.friction is not None else None)

    def bodies(self):
        return {"x": ss.Body(1.0, position=0.1), "y": ss.Body(2.0, position=-0.2)}

    def contacts(self):
        return {} if self.friction is None else {"x": ss.Contact("x", self.friction, load=1.0)}

    def controllers(self):
        pushed = 0.0 if self.friction is None else 2.0
        return {
            "place": Loop(self.slow, lambda t, x, v: -3.0 * x["x"] + pushed * sin(pi * t), lambda held: {"x": held}),
            "speed": Loop(self.fast, lambda t, x, v: -1.0 * v["x"], lambda held: {"x": held}),
            "own": Loop(self.other, lambda t, x, v: -2.0 * x["y"] - v["y"], lambda held: {"y": held}),
        }


def recursion(machine, ticks):
    """Positions at the ticks of the fastest: between them the forces are constant."""
    h, (x, y), (v, w), held, places = machine.fast, (0.1, -0.2), (0.0, 0.0), {}, []
    for n in range(ticks + 1):
        for name, time, value in (("p", machine.slow, -3.0 * x), ("s", machine.fast, -v), ("o", machine.other, -2.0 * y - w)):
            if n % round(time / h) == 0:
                held[name] = value
        places.append((x, y))
        a, b = held["p"] + held["s"], held["o"] / 2.0
        x, v, y, w = x + h * v + 0.5 * h * h * a, v + h * a, y + h * w + 0.5 * h * h * b, w + h * b
    return np.array(places)


def test_each_controller_samples_in_its_own_time():
    machine = Axes()
    run = ss.solve(machine, duration=4.0)
    ticks = np.arange(81) * machine.fast
    assert run.method == "exact" and np.max(abs(run.at(ticks)["x"] - recursion(machine, 80))) < 1e-13
    assert set(run.controllers["place"]["ticks"]) == {0.0, 1.0, 2.0, 3.0}


def test_a_batch_of_sample_times_and_the_judge_agree():
    times = np.array([0.1, 0.2, 0.4])
    many = ss.solve(Axes(slow=times, friction=ss.Coulomb(0.1, 0.1)), periods=6, keep="summary")
    judged = [ss.solve(Axes(slow=s, friction=ss.Coulomb(0.1, 0.1)), periods=6, method="dop853", rtol=1e-9) for s in times.tolist()]
    assert many.mean_velocity == pytest.approx([ss.mean_velocity(run) for run in judged], abs=1e-9)


def test_times_that_are_no_multiples_are_refused():
    with pytest.raises(ss.InputError, match=r"samples every 0\.075 s, and the fastest every 0\.05 s; allowed is a whole number of times"):
        Axes(slow=0.075)
    with pytest.raises(ss.InputError, match=r"period of 2\.0 s is not a whole number of them"):
        Axes(slow=0.3, other=0.15, fast=0.15, friction=ss.Coulomb(0.1, 0.1))
