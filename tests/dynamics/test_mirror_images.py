"""Attractors of machines in which forwards and backwards are alike: mirror images are called that."""

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.maths import cos

CUBIC = ss.SwitchingFlow.of_map(lambda y, n: (n.r * y[0] - y[0] ** 3 + n.h,), {"r": 1.5, "h": 0.0}, ("x",))
TWINS = ["the mirror image of attractor 1", "the mirror image of attractor 0"]


def duffing(bias=0.0, stiffness=1.0):
    """x'' = a x - x^3 - 0.5 x' + 0.1 cos t + b: for b = 0 the motions in both wells are images half a period apart."""
    field = {0: lambda t, y, n: (y[1], n.a * y[0] - y[0] ** 3 - 0.5 * y[1] + 0.1 * cos(t) + n.b)}
    return ss.SwitchingFlow(field, {}, 2 * np.pi, {"a": stiffness, "b": bias}, ("x", "v"))


def images(found):
    return [attractor.image for attractor in found.attractors]


@pytest.mark.parametrize(("r", "kind"), [(1.5, "period 1"), (2.5, "chaotic")])
def test_the_images_of_a_map_are_each_others_at_the_same_time(r, kind):
    found = ss.basins(CUBIC.replace(r=r), x=[-0.7, -0.3, 0.4, 0.6], settle=60)
    assert images(found) == TWINS and all(a.word.startswith(kind) for a in found.attractors)
    assert all(words in repr(found) for words in TWINS) and TWINS[0] in found._repr_html_()


def test_the_images_of_a_forced_oscillator_are_half_a_period_apart():
    assert images(ss.basins(duffing(), x=[-1.2, 1.2], v=[0.0, 0.3], settle=40)) == TWINS
    assert images(ss.basins(duffing(stiffness=-1.0), x=[-1.2, 1.2], v=[0.0], settle=60)) == ["its own mirror image"]


@each_row("model", [duffing(bias=1e-3), CUBIC.replace(h=1e-3)], ids=["oscillator", "map"])
def test_what_is_not_quite_symmetric_has_no_images(model):
    """The two motions differ by more than 1e-4 of their size from images of one another."""
    starts = {"x": [-1.2, 1.2]} if len(model.states) > 1 else {"x": [-0.5, 0.5]}
    found = ss.basins(model, settle=60, **starts)
    assert len(found.attractors) == 2 and images(found) == ["", ""]


@each_row(
    ("law", "tilt", "expected"),
    [
        (ss.Coulomb(0.15, 0.15), 0.0, "its own mirror image"),
        (ss.Coulomb(0.15, 0.15), 1.7, ""),
        (ss.Coulomb(0.15, 0.16), 0.0, ""),
        (ss.LuGre(0.15, 0.15, 0.2, 0.2, sigma0=4e5, sigma1=100.0, sigma2=0.04, v_s=2e-3), 0.0, "its own mirror image"),
        (ss.friction.GMS(0.15, 0.15, 0.18, 0.18, sigma0=4e5, v_s=2e-3, attraction=100.0), 0.0, ""),
    ],
    ids=["symmetric", "tilted", "rougher one way", "bristles", "memory"],
)
def test_a_machine_is_symmetric_by_drive_track_and_friction(law, tilt, expected):
    robot = ss.presets.piezo_rig(tilt_deg=tilt, amplitude=6e-4, incline="gravity" if tilt else "folded").replace(friction=law)
    found = ss.basins(robot, v=[-0.01, 0.01], settle=60)
    assert images(found) == [expected] * len(found.attractors)


def test_attractors_along_a_parameter_have_their_images_where_they_are():
    found = ss.attractors(CUBIC, parameter="h", values=[-0.01, 0.0, 0.01], starts={"x": [-0.8, 0.8]}, settle=100)
    assert found.image.values.tolist() == [[-1, 1, -1], [-1, 0, -1]]
