"""What a figure must not suggest: hysteresis where there are mirror twins, polygons, prefixes of angles, a rest at zero on a belt."""

from dataclasses import replace

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import pytest

import stickslip as ss
from rows import each_row

TWIN = "down, mirror image of up"


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


def words(ax):
    return [text.get_text() for text in ax.get_legend().get_texts()] if ax.get_legend() else []


def sweep(**down):
    """A diagram whose upward sweep has one-sided motions; the downward one has the same, but for what is given."""
    law = ss.Coulomb(mu_plus=0.1, mu_minus=0.1)
    oscillator = ss.ForcedOscillator(mass=1.0, stiffness=1.0, damping=0.0, friction=law, load=1.0, force=1.0, omega=1.0)
    diagram = ss.bifurcation(oscillator, parameter="omega", values=[0.5, 0.6], settle=20, points=2)
    up = {"mean_velocity": 0.1, "v_max": 0.5, "v_min": -0.3}
    for k, sweep in enumerate((up, up | down)):
        for name, value in sweep.items():
            diagram[name][k] = value
    return diagram


@each_row(
    ("down", "is_twin"),
    [
        ({"mean_velocity": -0.1, "v_max": 0.3, "v_min": -0.5}, True),
        ({"mean_velocity": 0.2, "v_max": 0.7, "v_min": -0.3}, False),  # hysteresis
        ({"mean_velocity": -0.1, "v_max": 0.5, "v_min": -0.3}, False),
        ({}, False),  # the same motion
    ],
)
def test_a_mirror_twin_is_told_apart_from_hysteresis(down, is_twin):
    assert (TWIN in words(ss.plot.bifurcation(sweep(**down), "mean_velocity"))) == is_twin


def test_a_branch_is_a_curve_through_its_orbits():
    branch = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=6e-4, stop=8e-4, tilt_deg=1.7, law="coulomb")
    ax = ss.plot.continuation(branch, "mean_velocity", special=False)
    curve = max((line for line in ax.lines if line.get_marker() == "None"), key=lambda line: len(line.get_xdata()))
    x, y = curve.get_data()
    assert len(x) > 5 * len(branch.values)
    at = np.argsort(x)
    factor = y[0] / branch.points.mean_velocity.values[0]
    seen = np.interp(branch.values * 1e6, x[at], y[at])
    assert seen == pytest.approx(factor * branch.points.mean_velocity.values, rel=1e-6)
    (border,) = [s for s in branch.special if s.kind == "type-border"]
    jumped = replace(branch, special=(replace(border, accuracy=1e-6),))  # known no better than a step: another motion is beyond
    curves = [line for line in ss.plot.continuation(jumped, "mean_velocity", special=False).lines if line.get_marker() == "None"]
    parts = sorted((line.get_xdata() for line in curves if len(line.get_xdata())), key=lambda x: x.min())
    assert len(parts) == 2 and parts[0].max() < border.value * 1e6 < parts[1].min()
    fine = [ss.mean_velocity(ss.solve(branch.orbits[0].model.replace({"drive.amplitude": a}), 200)) for a in (7.13e-4, 7.77e-4)]
    assert np.interp([713.0, 777.0], x[at], y[at]) == pytest.approx(factor * np.array(fine), rel=1e-3)  # and between them


def test_the_velocity_at_which_a_contact_rests_is_drawn_where_it_is_not_zero():
    law = ss.Coulomb(mu_plus=0.2, mu_minus=0.2, f_plus=0.4, f_minus=0.4)
    belt = ss.solve(ss.BlockOnBelt(mass=1.0, stiffness=1.0, speed=0.2, load=1.0, friction=law), duration=20.0)
    for draw in (ss.plot.velocity, ss.plot.phase):
        ax = draw(belt)
        (rest,) = (line for line in ax.lines if line.get_label() == "here the contact rests")
        assert np.allclose(rest.get_ydata(), 200.0)  # mm/s
        assert "here the contact rests" in [*words(ax), *(text.get_text() for text in ax.texts)]
    robot = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), periods=20)
    assert not any(line.get_label() == "here the contact rests" for line in ss.plot.velocity(robot).lines)


def test_angles_have_no_prefix_and_a_zero_has_one_digit():
    joint = ss.solve(ss.presets.servo(), duration=2.0)
    ax = ss.plot.phase(joint)
    assert (ax.get_xlabel()[-5:], ax.get_ylabel()[-7:]) == ("(rad)", "(rad/s)")
    assert ax.figure.dpi == 300
    law = ss.Coulomb(mu_plus=0.4, mu_minus=0.4)
    oscillator = ss.ForcedOscillator(mass=1.0, stiffness=1.0, damping=0.0, friction=law, load=1.0, force=1.0, omega=0.5)
    assert "V = 0 m/s" in repr(ss.periodic_orbit(oscillator))


def plane(V, fastest, steadiness):
    """A map of two by two cases."""
    grid = ss.sweep(ss.presets.piezo_rig, amplitude=[4e-4, 6e-4], tilt_deg=[1.7, 2.7], law="coulomb")
    for name, values in (("mean_velocity", V), ("velocity_max", fastest), ("steadiness", steadiness)):
        grid[name][:] = values
    grid["velocity_min"][:] = 0.0
    return grid


def test_a_map_of_tolerances_is_drawn_as_zero():
    ax = ss.plot.velocity_map(plane([[1e-12, -2e-12], [0.0, 3e-12]], 0.01, 0))
    assert any("no net motion" in text.get_text() for text in ax.texts)
    assert not np.any(ax.collections[0].get_array())


def test_the_fastest_point_of_a_map_has_settled_and_a_minus_sign():
    ax = ss.plot.velocity_map(plane([[1e-3, -2e-3], [-9e-3, 1e-3]], 0.01, [[0, 0], [1, 0]]), borders=False)
    assert [text.get_text() for text in ax.texts] == ["−2 mm/s"]


def test_a_cut_marks_what_has_not_settled():
    grid = plane([[1e-3, 2e-3], [9e-3, 1e-3]], 0.01, [[0, 0], [1, 0]])
    assert words(ss.plot.line_cut(grid, "amplitude", lines=[1.7, 2.7])).count("not settled") == 1
    grid["steadiness"][:] = 0
    assert "not settled" not in words(ss.plot.line_cut(grid, "amplitude", lines=[1.7, 2.7]))


def test_the_energy_of_a_run_is_drawn_without_asking_for_it_first_and_its_works_add_up():
    run = ss.solve(ss.presets.piezo_rig(tilt_deg=0.0, amplitude=6e-4, law="coulomb"), periods=4)
    assert ss.plot.energy(run).get_xlabel() == "drive period"
    text = repr(ss.energy(run))
    assert "drive" in text and "friction -" in text and "gravity" not in text


def test_a_cloud_under_branches_marks_what_has_not_settled():
    kwargs = {"parameter": "amplitude", "tilt_deg": 1.7, "law": "coulomb"}
    branch = ss.continuation(ss.presets.piezo_rig, start=7e-4, stop=8e-4, **kwargs)
    diagram = ss.bifurcation(ss.presets.piezo_rig, values=[7.2e-4, 7.6e-4], settle=20, follow=False, **kwargs)
    assert "not settled" not in words(ss.plot.continuation(branch, diagram=diagram))
    diagram["motion"][:, 0] = "not settled"
    assert "not settled" in words(ss.plot.continuation(branch, diagram=diagram))


def test_a_map_without_a_number_says_so():
    ax = ss.plot.velocity_map(plane(np.nan, np.nan, 0))
    assert [text.get_text() for text in ax.texts] == ["no case has a number"] and len(ax.figure.axes) == 1
