"""Numbers beyond sense: exponents and gravities at which powers overflow or nothing moves are refused; rare ones are remarked on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from rows import each_row

RIG = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb")
LAWS = {
    "stribeck": lambda exponent: ss.Stribeck(0.15, 0.21, 0.18, 0.24, v_s=2e-3, exponent=exponent),
    "dahl": lambda exponent: ss.Dahl(0.15, 0.21, sigma0=4e5, exponent=exponent),
}


@dataclass(frozen=True, eq=False)
class Sledge(ss.Machine):
    """A shaken body on the ground of some planet."""

    gravity: Any
    load: Any = None
    period = 0.1

    def bodies(self):
        return {"sledge": ss.Body(1.0, force=lambda t, x, v: 5.0 * ss.maths.sin(20.0 * np.pi * t))}

    def contacts(self):
        return {"sledge": ss.Contact("sledge", ss.Coulomb(0.2, 0.3), load=self.load)}


@pytest.mark.parametrize("law", LAWS)
@each_row("exponent", [-1.0, 0.0, 1e-3, 20.5, 1e3, 1e6, 1e300, np.array([1.0, 1e4])])
def test_an_exponent_beyond_sense_is_refused(law, exponent):
    with pytest.raises(ss.InputError, match=r"exponent.* = .*; allowed is a number from 0\.01 to 20, mostly 1"):
        LAWS[law](exponent)


@pytest.mark.parametrize("exponent", [0.01, 0.5, 1.0, 2.0, 20.0])
def test_every_allowed_exponent_of_a_stribeck_curve_can_be_solved(exponent):
    run = ss.solve(RIG.replace(friction=LAWS["stribeck"](exponent)), periods=20)
    assert np.isfinite(run.v).all() and ss.energy(run).worst < 1e-10


@each_row("gravity", [-9.81, 0.0, 1e-12, 1e7, 1e100, 1e300])
@pytest.mark.parametrize("made", [lambda g: RIG.replace(gravity=g), lambda g: ss.presets.conveyor(throw_index=2.5).replace(gravity=g)])
def test_a_gravity_beyond_sense_is_refused(made, gravity):
    with pytest.raises(ss.InputError, match=r"gravity = .*; allowed is a positive acceleration from 1e-6 to 1e6 m/s\^2.*gravity=9\.81"):
        made(gravity)


@each_row("gravity", [-9.81, 1e-12, 1e7, 1e300])
def test_a_gravity_of_a_machine_of_ones_own_is_refused_where_loads_follow_from_it(gravity):
    with pytest.raises(ss.InputError, match=r"gravity = .*; allowed is zero, or an acceleration from 1e-6 to 1e6 m/s\^2.*gravity=9\.81"):
        Sledge(gravity).mechanics  # noqa: B018
    assert Sledge(gravity, load=3.0).mechanics.coordinates == 1


@each_row(("gravity", "times"), [(9810.0, "1e+03"), (981.0, "1e+02"), (1e-5, "1e-06")])
def test_a_rare_gravity_is_remarked_on(gravity, times):
    (note,) = [note for note in RIG.replace(gravity=gravity).notes if "gravity" in note]
    assert note == f"gravity = {gravity:g} m/s^2 is {times} times that of the Earth; if that is not meant, type gravity=9.81"
    assert note in ss.solve(RIG.replace(gravity=gravity), periods=3).notes
    assert any("times that of the Earth" in note for note in ss.presets.conveyor(throw_index=2.5).replace(gravity=gravity).notes)


def test_the_gravities_of_planets_and_of_unit_robots_are_not_remarked_on():
    for gravity in (0.27, 1.0, 1.62, 3.71, 9.81, 24.8):
        assert not any("gravity =" in note for note in RIG.replace(gravity=gravity).notes)
