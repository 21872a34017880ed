"""What a trajectory says about a run, on runs made by hand."""

from __future__ import annotations

import re

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from runs import coulomb_run, unit_robot
from stickslip.basics.batch import Labels
from stickslip.results.datasets import COLUMNS
from stickslip.results.dense_output import HarmonicArcs, PolynomialPieces, pieces_from_arrays
from stickslip.results.summary import Summary
from stickslip.results.trajectory import Trajectory
from stickslip.variables import VARIABLES


@pytest.fixture(scope="module")
def run():
    """T8: type I, four events in each period."""
    return coulomb_run(unit_robot(0.7, 0.9), 20)


def test_columns_hold_every_sample_and_every_event_once(run):
    events = np.array([e.t for e in run.events])
    assert run.t.size == 20 * 400 + 1 + events.size
    assert np.isin(events, run.t).all()
    assert (np.diff(run.t) > 0).all()
    assert all(getattr(run, n).shape == run.t.shape for n in ("x", "v", "mode", "acceleration", "friction_force", "xi", "actuator_power"))
    assert run.z is None


def test_events_name_what_happens(run):
    kinds = [e.kind for e in run.events if e.t > 10 * run.period_time]
    assert set(kinds) == {"stick", "slip"}
    cycle = [(0, 1), (1, 0), (0, -1), (-1, 0)]
    assert [(e.before, e.after) for e in run.events[-4:]] in [cycle[k:] + cycle[:k] for k in range(4)]
    never_rests = coulomb_run(unit_robot(0.4, 0.5), 20)
    assert {e.kind for e in never_rests.events[4:]} == {"reversal"}


def test_an_instant_at_which_v_jumps_stands_there_twice():
    robot = unit_robot(0.7, 0.9)
    T = robot.period
    c = np.array([[[1.0, 0.0]], [[-1.0, 0.0]]])
    jump = Trajectory(robot, PolynomialPieces(np.array([0, T / 3, T]), np.array([1, -1]), np.array([0, T / 3]), c), 1, 0, 1e-6, "by hand")
    assert (jump.t == T / 3).sum() == 2
    assert jump.v[jump.t == T / 3].tolist() == [1.0, -1.0]


def test_arcs_are_exact_far_from_the_origin_of_time():
    """Against 50-digit arithmetic at the very floats given. The terms are below 4 in size, so a few roundings are below 1e-14."""
    mpmath = pytest.importorskip("mpmath")
    mpmath.mp.dps = 50
    omega, start = 205.46, 987.654321
    arcs = HarmonicArcs(np.array([start, start + 0.02]), np.array([1]), np.array([0.0]), np.array([0.0]), omega, omega, 0.3 * omega, 0.0)
    t = start + np.array([1e-7, 1e-4, 0.005, 0.02])
    v = arcs.evaluate(t, np.zeros(4, int))[1][:, 0]
    w, s = mpmath.mpf(omega), mpmath.mpf(start)
    exact = [mpmath.cos(w * s) - mpmath.cos(w * mpmath.mpf(u)) - mpmath.mpf(0.3 * omega) * (mpmath.mpf(u) - s) for u in t.tolist()]
    assert max(abs(float(e - mpmath.mpf(float(u)))) for e, u in zip(exact, v, strict=True)) < 4e-15


def test_position_is_the_integral_of_velocity(run):
    nodes, weights = np.polynomial.legendre.leggauss(12)
    for a, b in [(0.3, 1.1), (40.0, 40.5)]:
        edges = np.unique(np.clip(np.concatenate([[a, b], run.pieces.t]), a, b))
        t = 0.5 * (edges[:-1] + edges[1:])[:, None] + 0.5 * np.diff(edges)[:, None] * nodes
        moved = (run.at(t)["v"] @ weights * 0.5 * np.diff(edges)).sum()
        assert abs(moved - (run.at(b)["x"] - run.at(a)["x"])) < 1e-14  # sums of terms below 1: some roundings at |x| < 8


def test_newtons_law_holds_in_the_columns(run):
    """Eq. 2.3 with the columns; Eq. 2.1: the actuator's force moves the body, its reaction the inner mass."""
    robot = run.model
    rest = robot.total_mass * run.acceleration - run.drive_force + run.friction_force
    assert abs(rest).max() < 1e-14
    assert abs(robot.body_mass * run.acceleration - run.actuator_force + run.friction_force).max() < 1e-14
    assert np.allclose(run.actuator_power, -run.actuator_force * run.xi_rate, rtol=0, atol=0)


def test_friction_at_rest_is_what_the_other_forces_leave_over(run):
    stuck = run.mode == 0
    assert (run.v[stuck] == 0).all() and (run.acceleration[stuck] == 0).all()
    assert abs(run.friction_force - run.drive_force)[stuck].max() < 1e-14
    low, high = run.model.friction.breakaway(run.model.load(0, 0))
    assert run.friction_force[stuck].max() <= high + 1e-9 and run.friction_force[stuck].min() >= low - 1e-9


def test_friction_opposes_motion(run):
    moving = run.mode != 0
    assert (run.friction_force * run.mode)[moving].min() > 0


def test_at_has_the_shape_of_its_argument_and_refuses_other_times(run):
    assert np.shape(run.at(1.0)["v"]) == () and run.at([[1.0, 2.0]])["friction_force"].shape == (1, 2)
    assert run.at(run.t)["v"].tolist() == run.v.tolist()
    with pytest.raises(ss.InputError, match="allowed is 0 to"):
        run.at(1e6)


def test_strobe_points_are_the_columns_at_whole_periods(run):
    assert run.strobe_times.size == 21
    assert run.strobe_x.tolist() == run.at(run.strobe_times)["x"].tolist()
    assert run.window == (10 * run.period_time, run.pieces.t[-1])


def test_two_inner_states_stay_two():
    robot = unit_robot(0.7, 0.9)
    pieces = PolynomialPieces(np.array([0.0, robot.period]), np.array([1]), np.zeros(1), np.ones((1, 3, 2)))
    two = Trajectory(robot, pieces, 1, 0, 1e-6, "by hand")
    assert two.z.shape == (401, 2) and two.strobe_z.shape == (2, 2)


@each_row("kind", ["harmonic", "polynomial"])
def test_pieces_come_back_from_their_arrays(kind, run):
    pieces = run.pieces if kind == "harmonic" else PolynomialPieces(np.array([0.0, 1.0]), np.array([1]), np.zeros(1), np.ones((1, 2, 3)))
    again = pieces_from_arrays(kind, pieces.arrays())
    t = np.linspace(0, 1, 7)
    for a, b in zip(pieces.evaluate(t, np.zeros(7, int)), again.evaluate(t, np.zeros(7, int)), strict=True):
        assert a.tolist() == b.tolist()


def test_dataset_carries_units_and_provenance(run):
    data = run.to_xarray()
    assert data.v.attrs["units"] == "m/s" and data.attrs["status"] == "finished" and "mu_plus" in data.attrs["robot"]
    assert data.sizes["time"] == run.t.size


def test_notebooks_and_prompts_get_a_short_text(run):
    assert "finished" in repr(run) and "<table>" in run._repr_html_() and run.notes == []


def test_a_summary_gives_its_columns_by_name_and_as_a_dataset():
    robot = unit_robot(0.7, 0.9).replace({"drive.amplitude": np.array([1.0, 2.0, 3.0])})
    many = Summary(robot, Labels((3,)), {"mean_velocity": np.arange(3.0), "status": np.array([0, 0, 4])})
    assert many.mean_velocity.tolist() == [0, 1, 2] and "1 not a number" in repr(many)
    data = many.to_xarray()
    assert data["drive.amplitude"].values.tolist() == [1, 2, 3] and data.mean_velocity.attrs["units"] == "m/s"
    with pytest.raises(AttributeError, match="mean_velocity"):
        many.mean_velocty  # noqa: B018


def test_the_help_of_a_run_lists_every_column_with_its_unit_and_meaning():
    told = [re.split(r"  +", line.strip(), maxsplit=2) for line in ss.results.Trajectory.__doc__.splitlines()]
    listed = [tuple(row) for row in told if row[0] in COLUMNS]
    assert listed == [(name, VARIABLES[name].unit, VARIABLES[name].long_name) for name in COLUMNS]
    assert all(
        f"[{VARIABLES[name].unit}]" in (getattr(ss.results.Trajectory, name).__doc__ or "")
        for name in ("t", "x", "v", "slip", "load", "xi")
    )
