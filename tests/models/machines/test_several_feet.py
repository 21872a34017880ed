"""Two points of a body on ground that pushes: a rocking block by hand, and falls, slides and tips against a program by hand."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stickslip as ss
from feet_by_hand import TwoFeet
from rows import each_row
from stickslip.basics.errors import InputError, SolveError

G, HALF = 9.81, 0.1


@dataclass(frozen=True, eq=False)
class Block(ss.Machine):
    """A block of 1 kg on the corners of its base."""

    half: float
    tall: float
    friction: Any
    restitution: float
    coordinates = ("x", "z", "angle")
    time_scale, velocity_scale = 0.5, 1.0

    def bodies(self):
        return {"block": ss.Body(1.0, inertia=(self.half**2 + self.tall**2) / 3)}

    def places(self, t, q):
        return {"block": (q["x"], q["z"], q["angle"])}

    def contacts(self):
        ground = {"hold": "push", "restitution": self.restitution}
        places = {"left": (-self.half, -self.tall), "right": (self.half, -self.tall)}
        return {name: ss.Contact("block", self.friction, at=at, **ground) for name, at in places.items()}


def block(mu, e, tall):
    return Block(HALF, tall, ss.Coulomb(mu, mu), e)


def leaning(tilt, tall):
    """A start in which it stands on its right corner."""
    c, s = np.cos(-tilt), np.sin(-tilt)
    return {"x": {"x": HALF - (HALF * c + tall * s), "z": tall * c - HALF * s, "angle": -tilt}, "v": {}}


def test_a_block_rocks_as_housner_says():
    """Each hit leaves 1 - 3/2 sin^2 of the rate, with the corner's angle; between them the block turns about one corner."""
    tall, first, hits = 0.5, 0.1, 6
    run = ss.solve(block(1.0, 0.0, tall), duration=3.0, start=leaning(first, tall))
    corner, pull = np.arctan(HALF / tall), 3 * G / (4 * np.hypot(HALF, tall))
    left, t, lean, rate, times = 1 - 1.5 * np.sin(corner) ** 2, 0.0, first, 0.0, []
    down = lambda t, y: y[0]  # noqa: E731
    down.terminal, down.direction = True, -1
    for _ in range(hits):
        swing = solve_ivp(lambda t, y: [y[1], -pull * np.sin(corner - y[0])], (0.0, 5.0), [lean, rate], "DOP853", events=down,
                          rtol=1e-13, atol=1e-15)  # fmt: skip
        t, lean, rate = t + swing.t[-1], 0.0, -left * swing.y[1, -1]
        times.append(t)
    landings = [event for event in run.events if event.kind == "landing"]
    assert np.allclose([event.t for event in landings], times, rtol=0, atol=1e-11)
    assert [event.part for event in landings] == ["left", "right"] * 3 and run.status == "finished"
    energy = ss.energy(run)
    assert abs(energy.residual).max() < 1e-14 and set(energy.damping_of) == {"left (hits)", "right (hits)"}


def test_rocking_dies_out_and_the_block_stands():
    """Its hits accumulate, and from their limit on it stands on both corners, which bear half of its weight each."""
    tall = 0.5
    run = ss.solve(block(1.0, 0.0, tall), duration=10.0, start=leaning(0.1, tall))
    last = [event.t for event in run.events if event.kind == "landing"][-1]
    assert 8.0 < last < 9.0 and run.status == "finished"
    assert np.allclose(run.load[-1], 0.5 * G, rtol=1e-10) and abs(run.x[-1, 2]) < 1e-12 and np.all(run.contacts["left"].mode[-1:] == 0)


@each_row(
    "mu, e, x, v, end",
    [
        (0.2, 0.0, [0, 0.3, 0], [1.0, 0, 0], 0.6),  # it slides and stops
        (0.5, 0.0, [0, 0.3, 0], [1.0, 0, 0], 0.6),  # it tips over its front corner
        (0.5, 0.0, [0, 0.5, 0], [0.3, 0, 0], 0.35),  # both corners land at once
        (0.2, 0.3, [0, 0.5, 0], [0.3, 0, 0], 0.35),
        (0.5, 0.0, [0, 0.4, -0.3], [-0.5, 0, 1.0], 0.6),  # one after the other
        (0.2, 0.3, [0, 0.6, -1.0], [-2.5, 0, 4.0], 0.4),
        (0.2, 0.7, [0, 0.4, 0.2], [0.5, 0, 0], 0.28),
    ],
)
def test_a_block_falls_slides_and_tips_as_a_program_by_hand_says(mu, e, x, v, end):
    names = ("x", "z", "angle")
    run = ss.solve(block(mu, e, 0.3), duration=end, start={"x": dict(zip(names, x, strict=True)), "v": dict(zip(names, v, strict=True))})
    events, last = TwoFeet([(-HALF, -0.3), (HALF, -0.3)], (HALF**2 + 0.3**2) / 3, mu, e).run(np.r_[x, v].astype(float), end)
    landings = [(event.t, ["left", "right"].index(event.part)) for event in run.events if event.kind == "landing"]
    by_hand = sorted((t, i) for t, what, i in events if what == "landing")
    assert run.method == "exact" and [i for _, i in landings] == [i for _, i in by_hand]
    assert np.allclose([t for t, _ in landings], [t for t, _ in by_hand], rtol=0, atol=1e-12)
    assert np.allclose(np.r_[run.x[-1], run.v[-1]], last, rtol=0, atol=1e-11)
    assert abs(ss.energy(run).residual).max() < 1e-13


def test_batches_and_simulations_know_two_feet():
    tall, mu = 0.3, np.array([0.2, 0.5])
    start = {"x": {"z": 0.4, "angle": 0.2}, "v": {"x": 0.5}}
    batch = ss.solve(block(mu, 0.0, tall), duration=0.5, start=start)
    singles = [ss.solve(block(one, 0.0, tall), duration=0.5, start=start) for one in mu]
    assert np.allclose(batch.body_displacement, [run.x[-1] - run.x[0] for run in singles], rtol=0, atol=1e-13)
    simulation = ss.simulation(block(0.2, 0.0, tall), start=start)
    for _ in range(5):
        simulation.step(0.1)
    assert np.allclose(simulation.state["x"], singles[0].x[-1], rtol=0, atol=1e-13)


def test_what_does_not_know_several_feet_says_so():
    rocks, start = block(1.0, 0.0, 0.5), leaning(0.1, 0.5)
    run = ss.solve(rocks, duration=0.3, start=start)
    with pytest.raises(SolveError, match=re.escape('method="exact"')):
        ss.solve(rocks, duration=0.1, start=start, method="dop853")
    with pytest.raises(InputError, match="several points on ground that pushes are not followed yet"):
        ss.dynamics.sensitivity(run, wrt=["half"])
    with pytest.raises(InputError, match="allowed is one such point"):
        ss.latex(rocks)

    on_a_slope = {name: contact.replace(on=lambda x: 0.1 * x) for name, contact in rocks.contacts().items()}
    with pytest.raises(InputError, match="two points of one body on a curve"):
        type("Sloping", (Block,), {"contacts": lambda self: on_a_slope})(HALF, 0.5, ss.Coulomb(0.1, 0.1), 0.0)
    upright = {"coordinates": ("x", "z"), "places": lambda self, t, q: {"block": (q["x"], q["z"])}}
    with pytest.raises(InputError, match="no coordinates decide what each of them bears"):
        type("Upright", (Block,), upright)(HALF, 0.5, ss.Coulomb(0.1, 0.1), 0.0)

    def three(self):
        return {**Block.contacts(self), "middle": ss.Contact("block", self.friction, hold="push", restitution=0.0)}

    with pytest.raises(InputError, match="or one of two points that push"):
        type("Three", (Block,), {"contacts": three})(HALF, 0.5, ss.Coulomb(0.1, 0.1), 0.0)


@pytest.mark.slow
def test_no_random_block_falls_otherwise_than_by_hand():
    """400 of them, each until its rebounds are small; all run to their ends."""
    far = {}
    for seed in range(400):
        rng = np.random.default_rng(seed)
        half, tall = rng.uniform(0.05, 0.5, 2)
        mu, e = rng.uniform(0.02, 1.2), rng.choice([0.0, rng.uniform(0.2, 0.9)])
        angle = rng.choice([0.0, rng.uniform(-1.2, 1.2)])
        low = min(side * half * np.sin(angle) - tall * np.cos(angle) for side in (1, -1))
        x = [0.0, -low + rng.choice([0.0, rng.uniform(0.01, 0.4)]), angle]
        v = [rng.normal(), 0.0, 0.0 if x[1] + low < 1e-9 else rng.normal() * 2]
        start = {what: dict(zip(("x", "z", "angle"), values, strict=True)) for what, values in (("x", x), ("v", v))}
        machine, end = Block(half, tall, ss.Coulomb(mu, mu), e), rng.uniform(0.1, 0.5)
        run = ss.solve(machine, duration=end, start=start)
        small = [event.t for event in run.events if event.kind == "landing" and -event.velocity < 2e-2]
        end = min([end, *(t - 1e-6 for t in small)])
        run = ss.solve(machine, duration=end, start=start)
        _, last = TwoFeet([(-half, -tall), (half, -tall)], (half**2 + tall**2) / 3, mu, e).run(np.r_[x, v].astype(float), end)
        off = np.max(abs(np.r_[run.x[-1], run.v[-1]] - last))
        far |= {seed: off} if run.status != "finished" or off > 1e-8 else {}
    assert not far
