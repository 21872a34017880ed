"""Loads that follow from the velocities and forces of the same instant: the judge, closed forms, and what is refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.maths import cos, exp, pi, sin, where

DRY, STICTION = ss.Coulomb(0.5, 0.6), ss.Coulomb(0.9, 0.8, f_plus=1.2, f_minus=1.0)


@dataclass(frozen=True, eq=False)
class Wheel(ss.Machine):
    """A wheel under a motor's torque and an eccentric weight."""

    friction: Any
    load: Callable[..., Any]
    torque: float = 0.25
    omega: float = 6.0
    weight: float = 0.2
    phase: float = 0.0

    @property
    def period(self):
        return 2 * pi / self.omega

    def bodies(self):
        pull = lambda t, x, v: -self.weight * sin(x)  # noqa: E731
        return {"wheel": ss.Body(0.01, force=pull, gravity=pull)}

    def forces(self, t, x, v):
        return {"wheel": {"motor": self.torque * sin(self.omega * t + self.phase)}}

    def contacts(self):
        return {"axle": ss.Contact("wheel", self.friction, load=self.load)}


@dataclass(frozen=True, eq=False)
class WithPad(Wheel):
    """A spring joins a pad to the wheel, which rubs under what that spring bears."""

    on: str | None = None

    def bodies(self):
        return {**super().bodies(), "pad": ss.Body(0.02)}

    def links(self):
        return {("wheel", "pad"): ss.Spring(1.0, damping=0.01)}

    def contacts(self):
        load = lambda t, x, v, forces: 0.1 + 0.2 * forces["wheel-pad"] ** 2 + 0.01 * x["wheel"] ** 2  # noqa: E731
        return {**super().contacts(), "pad": ss.Contact("pad", DRY, on=self.on, load=load)}


@dataclass(frozen=True, eq=False)
class TwoFeet(Wheel):
    """Two contacts hold the wheel."""

    def contacts(self):
        return {**super().contacts(), "brake": ss.Contact("wheel", STICTION, load=lambda t, x, v: 0.02 + 0.001 * v**2)}


def of_speed(t, x, v, forces):
    """A gear whose friction grows with the torque that it transmits, more so at low speed."""
    return 0.02 + 0.3 * abs(forces["motor"] - forces["gravity"]) * (1.0 + 0.5 * exp(-abs(v) / 0.5))


def back_driven(t, x, v, forces):
    """A gear that rubs more when it is driven back."""
    return where(forces["motor"] * v > 0.0, 0.1, 0.3) * abs(forces["motor"]) + 0.02


def of_torque_alone(t, x, v, forces):
    """Friction in proportion to the torque: none where the torque is zero."""
    return 0.3 * abs(forces["motor"]) + 0.1 * forces["motor"]


ROWS = {
    "speed and torque": (Wheel(STICTION, of_speed), 3),
    "driven and back-driven": (Wheel(DRY, back_driven, torque=0.4), 3),
    "the torque alone": (Wheel(DRY, of_torque_alone, phase=0.5), 3),
    "two contacts of a body": (TwoFeet(DRY, of_speed, torque=0.4), 3),
    "a spring's tension": (WithPad(DRY, of_speed, torque=0.5), 1),
    "body on body": (WithPad(DRY, of_speed, torque=0.5, on="wheel"), 1),
}


@pytest.mark.parametrize(
    ("name", "periods"),
    [(name, periods) for name, (_, periods) in ROWS.items()] + [pytest.param("speed and torque", 12, marks=pytest.mark.slow)],
)
def test_the_exact_solver_and_the_judge_agree(name, periods):
    """All events, with the slow tests more than twenty, and the states after them, to 1e-10 of their size."""
    machine, _ = ROWS[name]
    run, judged = (ss.solve(machine, periods=periods, **how) for how in ({"method": "exact"}, {"method": "dop853", "rtol": 1e-12}))
    times, theirs = (np.array([event.t for event in each.events]) for each in (run, judged))
    assert run.status == "finished" and len(times) >= (20 if periods > 3 else 4)
    assert [e.kind for e in run.events] == [e.kind for e in judged.events]
    np.testing.assert_allclose(times, theirs, rtol=0, atol=1e-10 * run.t[-1])
    np.testing.assert_allclose(run.v[-1], judged.v[-1], rtol=0, atol=1e-10 * np.max(abs(run.v)))
    assert abs(ss.energy(run).residual).max() < 1e-11


def test_a_law_with_inner_states_takes_such_a_load():
    """LuGre under a load of torque and speed: Rosenbrock steps against SciPy."""
    law = ss.LuGre(0.5, 0.5, f_plus=0.6, f_minus=0.6, v_s=0.1, sigma0=50.0, sigma1=0.05, sigma2=0.0)
    machine = Wheel(law, of_speed)
    run, judged = ss.solve(machine, duration=0.2, rtol=1e-9), ss.solve(machine, duration=0.2, method="radau", rtol=1e-7)
    np.testing.assert_allclose(run.v[-1], judged.v[-1], rtol=0, atol=1e-6 * np.max(abs(run.v)))


def test_break_away_is_where_torque_and_the_load_of_that_torque_meet():
    """A sin(w t) = mu (c + k A sin(w t)) from rest: in closed form."""
    run = ss.solve(Wheel(STICTION, lambda t, x, v, forces: 0.05 + 0.3 * abs(forces["motor"])), periods=1)
    needed = 1.2 * 0.05 / (0.25 * (1.0 - 1.2 * 0.3))
    assert run.events[0].t == pytest.approx(np.arcsin(needed) / 6.0, rel=1e-13)


def test_the_mirror_image_moves_the_other_way():
    """Loads see the machine as it is."""
    machine = Wheel(STICTION, back_driven)
    run, image = ss.solve(machine, periods=3), ss.solve(ss.dynamics.mirrored(machine), periods=3)
    np.testing.assert_allclose(image.x, -run.x, rtol=0, atol=1e-12 * np.max(abs(run.x)))


@each_row(
    "load, said",
    [
        (lambda t, x, v, forces: abs(forces["axle"]), "forces['axle'] is friction of the same instant"),
        (lambda t, x, v, forces: abs(forces["moter"]), "'motor'?"),
        (lambda t, x, v, forces: abs(x["whel"]), "'wheel'?"),
        (lambda t, x, v, forces, more: 1.0, "allowed is a function of t, of t and x, of t, x and v, or of t, x, v and forces"),
    ],
    ["friction", "a slip of the pen", "a body that is none", "five arguments"],
)
def test_a_load_of_what_is_not_known_is_refused(load, said):
    with pytest.raises(ss.InputError) as refused:
        Wheel(DRY, load)
    assert said in str(refused.value) and "contacts()['axle']" in str(refused.value)


def test_fewer_arguments_are_those_that_stand_first():
    """Functions of time, of the position, of the velocity and of the forces that say the same are the same load."""
    loads = [
        lambda t: 0.1 + 0.01 * sin(6.0 * t),
        lambda t, x: 0.1 + 0.01 * sin(6.0 * t),
        lambda t, x, v: 0.1 + 0.01 * sin(6.0 * t),
        lambda t, x, v, forces: 0.1 + 0.01 * sin(6.0 * t),
    ]
    ends = [ss.solve(Wheel(DRY, load), periods=1).v[-1] for load in loads]
    assert np.ptp(ends, axis=0).max() < 1e-12


@dataclass(frozen=True, eq=False)
class Hinge(ss.Machine):
    """A pendulum with a motor, whose hinge is pressed by the size of the torque."""

    omega: float
    coordinates = ("angle",)

    @property
    def period(self):
        return 2 * pi / self.omega

    def bodies(self):
        return {"rod": ss.Body(1.0, inertia=0.1)}

    def places(self, t, q):
        return {"rod": (0.5 * sin(q["angle"]), -0.5 * cos(q["angle"]), q["angle"])}

    def forces(self, t, q, u):
        return {"angle": 4.0 * sin(self.omega * t)}

    def contacts(self):
        return {"hinge": ss.Contact("angle", ss.Coulomb(0.3, 0.3), load=lambda t, q: 1.0 + 0.5 * abs(4.0 * sin(self.omega * t)))}


def test_a_load_whose_corner_is_at_the_end_of_a_period_to_rounding_does_not_hold_it_up():
    for omega in (13.28836773086349, 30.71020029932251, 28.897961775112257):  # there the sine has its zero a rounding before it
        assert ss.solve(Hinge(omega), start={"v": {"angle": 0.3}}, periods=4).status == "finished"
