"""Machines that name a principal body: results are that body's, as a robot's are, and are those of the same machine without the name."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import stickslip as ss
from every import DRY, STICTION, Capsule
from rows import each_row
from stickslip.results.datasets import trajectory_columns
from stickslip.show.reports import run_page
from stickslip.show.reports.facts import facts


@dataclass(frozen=True, eq=False)
class Named(Capsule):
    """The capsule, whose motion is the machine's."""

    principal = "capsule"


@dataclass(frozen=True, eq=False)
class Hammered(Capsule):
    """The hammer, which has no contact."""

    principal = "hammer"


NAMED, PLAIN = Named(300.0, DRY), Capsule(300.0, DRY)
LENGTH = {"periods": 6}


@pytest.fixture(scope="module")
def runs():
    return ss.solve(NAMED, **LENGTH), ss.solve(PLAIN, **LENGTH)


@pytest.fixture(scope="module")
def batches():
    stiffness = np.array([280.0, 300.0])
    return tuple(ss.solve(cls(stiffness, DRY), keep="summary", **LENGTH) for cls in (Named, Capsule))


def test_columns_of_a_run_are_those_of_the_principal_body_and_its_contact(runs):
    named, plain = runs
    assert named.x.shape == named.v.shape == named.mode.shape == named.t.shape and named.z is None
    for name, column in trajectory_columns(named).items():
        of_all = getattr(plain, name)
        assert np.array_equal(column, of_all if of_all.ndim == 1 else of_all[:, 0]), name
    for name in ("strobe_x", "strobe_v"):
        assert np.array_equal(getattr(named, name), getattr(plain, name)[:, 0])
    assert np.array_equal(named.bodies["hammer"].x, plain.x[:, 1]) and np.array_equal(named.bodies["capsule"].v, named.v)
    assert np.array_equal(named.contacts["capsule"].friction_force, named.friction_force)
    assert [event.t for event in named.events] == [event.t for event in plain.events]


@each_row("shape", [(), (3,), (2, 2)])
def test_at_answers_in_the_shape_of_its_times(runs, shape):
    named, plain = runs
    t = np.linspace(0.1, 0.3, int(np.prod(shape))).reshape(shape)
    here, there = named.at(t), plain.at(t)
    assert all(np.shape(column) == shape for column in here.values() if column is not None)
    assert np.array_equal(here["v"], there["v"][..., 0]) and np.array_equal(here["load"], there["load"][..., 0])


def test_the_mean_velocity_is_that_of_the_principal_body(runs):
    """A transient is left, in which the bodies have means of their own; that of the plain machine is of the centre of mass."""
    named, plain = runs
    assert ss.mean_velocity(named) == ss.mean_velocity(named, body="capsule") == pytest.approx(ss.mean_velocity(plain, body=0), rel=1e-12)
    assert abs(ss.mean_velocity(named) - ss.mean_velocity(plain)) > 1e-9
    assert ss.mean_velocity(named, body="hammer") == ss.mean_velocity(plain, body=1)


def test_motion_and_energy_are_those_of_the_same_machine(runs):
    (named, plain), (m, other) = runs, map(ss.motion, runs)
    assert (m.type, m.pattern, m.margin) == tuple(getattr(other.contacts["capsule"], name) for name in ("type", "pattern", "margin"))
    assert m.period == other.period and set(m.contacts) == {"capsule"}
    here, there = ss.energy(named), ss.energy(plain)
    assert np.array_equal(here.friction, there.friction) and np.array_equal(
        here.damping_of["hammer-capsule"], there.damping_of["hammer-capsule"]
    )
    assert here.worst < 1e-10  # exact runs: rounding of some hundred steps in a period


def test_a_batch_has_the_columns_of_the_principal_body(batches):
    """The numbers of its lanes are those of the same machine with all axes; a stop keeps its own."""
    named, plain = batches
    assert named.motion_type.shape == named.velocity_max.shape == (2,) and named.hits.shape == (2, 1)
    assert "body_velocity" not in named.columns
    for name in named.columns:
        of_all = getattr(plain, name)
        if name in ("mean_velocity", "displacement", "settling_error"):
            continue
        assert np.array_equal(getattr(named, name), of_all if name in ("hits", "impulse_max", "stop_force_max") or of_all.ndim == 1 else of_all[:, 0], equal_nan=of_all.dtype.kind == "f"), name  # fmt: skip  # noqa: E501
    assert np.allclose(named.mean_velocity, plain.body_velocity[:, 0], rtol=1e-12)
    assert np.isclose(named.mean_velocity[1], ss.mean_velocity(ss.solve(NAMED, **LENGTH)), rtol=1e-9)


def test_the_judge_says_the_same(batches):
    judged = ss.solve(Named(np.array([280.0, 300.0]), DRY), keep="summary", method="dop853", rtol=1e-11, **LENGTH)
    assert judged.columns.keys() == batches[0].columns.keys()
    assert np.allclose(judged.mean_velocity, batches[0].mean_velocity, rtol=1e-6)  # an elastic stop costs the judge's steps some digits
    assert judged.motion_type.tolist() == batches[0].motion_type.tolist()
    run = ss.solve(NAMED, method="dop853", **LENGTH)
    assert run.v.shape == run.t.shape and run.pieces.layout.principal == "capsule"


def test_datasets_sweeps_and_studies_have_no_axis_of_bodies(runs, tmp_path):
    assert runs[0].to_xarray().v.dims == ("time",) and "body" not in runs[0].to_xarray().dims
    grid = ss.sweep(Named, stiffness=[280.0, 300.0], friction=DRY, **LENGTH, out=tmp_path / "study")
    assert grid.velocity_max.dims == grid.pattern.dims == ("stiffness",) and grid.hits.dims == ("stiffness", "stop")
    again = ss.open_study(tmp_path / "study")
    assert again.pattern.values.tolist() == grid.pattern.values.tolist() and np.array_equal(again.hits, grid.hits)
    assert ss.plot.motion_map(ss.map(NAMED, stiffness=[280.0, 300.0], omega=[99.0, 100.0], **LENGTH)).get_xlabel()


def test_files_keep_the_principal_body(runs, tmp_path):
    again = ss.load(runs[0].save(tmp_path / "run.nc"), machines=[Named])
    assert (
        again.x.shape == again.t.shape and np.array_equal(again.v, runs[0].v) and np.array_equal(again.bodies["hammer"].v, runs[1].v[:, 1])
    )
    head = runs[0].save(tmp_path / "run.csv").read_text(encoding="utf-8").partition("\n")[0]
    assert "v [m/s]" in head and "hammer" not in head


def test_inner_states_are_those_of_the_principal_contact():
    named, plain = (ss.solve(cls(300.0, ss.LuGre.example()), periods=2) for cls in (Named, Capsule))
    assert (
        named.z.shape == named.t.shape
        and np.array_equal(named.z, plain.z[:, 0, 0])
        and np.array_equal(named.strobe_z, plain.strobe_z[:, 0, 0])
    )
    assert named.at([0.01, 0.02])["z"].shape == (2,)


def test_a_principal_body_without_contact_has_the_machines_first():
    run = ss.solve(Hammered(300.0, DRY), **LENGTH)
    assert np.array_equal(run.x, run.bodies["hammer"].x) and np.array_equal(run.mode, run.contacts["capsule"].mode)


def test_orbits_sections_and_mirror_images_are_of_the_principal_body(runs):
    orbit = ss.periodic_orbit(NAMED)
    assert orbit.mean_velocity == pytest.approx(ss.periodic_orbit(PLAIN).mean_velocity, rel=1e-9)  # steady: all bodies have one mean
    assert orbit.pattern == orbit.motion.contacts["capsule"].pattern
    assert ss.dynamics.strobe(runs[0]).v.dims == ("point",) and ss.dynamics.spectrum(runs[0]).amplitude.dims == ("order",)
    assert np.array_equal(ss.dynamics.spectrum(runs[0], body="hammer").amplitude, ss.dynamics.spectrum(runs[1], body="hammer").amplitude)
    assert len(ss.dynamics.poincare(runs[0], on="v.hammer").v) == len(ss.dynamics.poincare(runs[1], on="v.hammer").v)
    image = ss.solve(ss.dynamics.mirrored(NAMED), **LENGTH)
    assert image.v.shape == image.t.shape and ss.mean_velocity(image) == pytest.approx(-ss.mean_velocity(runs[0]), rel=1e-9)


def test_a_basin_and_lyapunov_exponents_go_by_the_states_of_all_bodies():
    assert ss.basins(NAMED, **{"v.capsule": [0.0, 0.05]}, settle=100).attractors
    assert ss.lyapunov(NAMED, periods=50).spectrum is not None


def test_pictures_and_reports_show_every_body(runs):
    assert [line.get_label() for line in ss.plot.velocity(runs[0]).lines][-2:] == ["capsule", "hammer"]
    assert ss.plot.phase(runs[0]).get_ylabel() and ss.plot.forces(runs[0]).get_ylabel() and ss.plot.contacts(runs[0]).collections
    assert "mean velocity of capsule" in dict(facts(runs[0]))
    page = run_page(runs[0], "It hammers")
    assert "hammer" in page and "<h1>It hammers</h1>" in page


def test_a_principal_body_that_there_is_not_is_refused():
    @dataclass(frozen=True, eq=False)
    class Lost(Capsule):
        principal = "capsul"

    with pytest.raises(ss.InputError, match=r"principal = 'capsul'; allowed is None or the name of a body; did you mean 'capsule'"):
        Lost(300.0, STICTION)


def test_an_observable_sees_the_principal_body_as_a_run_does():
    robot = ss.presets.capsubot()
    observe = {
        "mean_v": ss.observable(lambda s: s.v, reduce="mean"),
        "mean_inner": ss.observable(lambda s: s.bodies["inner"].v, reduce="mean"),
        "slip_max_own": ss.observable(lambda s: s.slip, reduce="max"),
    }
    many = ss.solve(robot.replace({"drive.force.amplitude": np.array([1.1, 1.25])}), periods=400, observe=observe)
    assert np.allclose(many.mean_v, many.mean_velocity, rtol=1e-6) and np.allclose(many.mean_inner, many.mean_velocity, rtol=1e-6)
    assert np.allclose(many.slip_max_own, many.velocity_max, rtol=1e-9)
