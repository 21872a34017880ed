"""Rows of many bodies: clusters that step by themselves, events that cost their neighbours, and texts that do not grow."""

from pathlib import Path
from runpy import run_path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import stickslip as ss
from blocks import STRIBECK, Row, row
from pairs import each_once
from plain_rows import PlainRow
from stickslip.engine import local_events
from stickslip.engine.force_tables import traced
from stickslip.maths import cos, exp, sin
from stickslip.models.machine_adapter import machine_of
from stickslip.results.dense_output import pieces_from_arrays
from stickslip.solvers import local_steps
from stickslip.solvers.local_steps import WRITTEN_OUT
from stickslip.solvers.methods import method_for


def by_tables(machine, end):
    """A run whose contacts are rows of a table, however few there are."""
    mechanics = machine_of(machine).mechanics
    start = np.array(mechanics.start, float)
    of = local_events.row_of(mechanics)
    return local_events.run(of, start, 0.0 * start, end, float(mechanics.velocity_scale), 10**6, lambda t: True)


def assert_same_events(run, events, within):
    """The events of a run are those of a table: time, body, new mode."""
    names = list(run.bodies)
    assert [(names.index(e.part), e.after) for e in run.events] == [(int(body), int(mode)) for _, body, mode in events]
    assert_allclose([e.t for e in run.events], events[:, 0], rtol=0, atol=within)


LAWS = [
    ss.Coulomb(0.5, 0.4),
    STRIBECK,
    ss.CoulombViscous(0.4, 0.5, viscous=0.1),
    ss.Stribeck(0.3, 0.3, f_plus=0.5, f_minus=0.4, v_s=0.1, exponent=1.0),
]
SPRINGS = [ss.Spring, lambda k: ss.Spring(k, damping=0.2, length=0.05), lambda k: ss.Spring(k, cubic=50.0)]
PUSHES = [0.0, lambda t, x, v: 0.4 * sin(1.3 * t) - 0.2 * x, lambda t, x, v: 0.3 * cos(2.0 * x) / (1.0 + x * x) - 0.05 * v]


@pytest.mark.parametrize("law, spring, push", each_once(LAWS, SPRINGS, PUSHES))
def test_few_blocks_have_the_events_of_equations_that_are_written_out(law, spring, push):
    machine = row(4, friction=law, spring=spring, push=push)
    run, tables = ss.solve(machine, duration=15.0), by_tables(machine, 15.0)
    assert len(run.events) > 10
    assert_same_events(run, tables.events, 1e-10)


def test_a_hundred_blocks_have_the_events_of_a_plain_integrator():
    machine, end = row(100), 0.6
    plain = PlainRow([1.0 + 0.1 * (i % 3) for i in range(100)], 16.0, 1.0, 0.01, kinetic=0.5, static=1.0, v_s=0.25)
    events, y = plain.events(np.array(machine.offsets), np.zeros(100), end)
    run = ss.solve(machine, duration=end)
    assert run.method == "exact" and len(events) >= 50
    assert_same_events(run, events, 1e-8)
    assert_allclose(run.at(end)["x"], y[:100], rtol=0, atol=1e-8)


@pytest.mark.slow
def test_a_hundred_blocks_agree_with_the_judge_over_fifty_events():
    machine = row(100)
    run, judge = ss.solve(machine, duration=0.35), ss.solve(machine, duration=0.35, method="dop853", rtol=1e-10)
    assert len(run.events) >= 50
    assert [(e.part, e.before, e.after) for e in run.events] == [(e.part, e.before, e.after) for e in judge.events]
    assert_allclose([e.t for e in run.events], [e.t for e in judge.events], rtol=0, atol=1e-8)
    assert_allclose(run.at(0.35)["x"], judge.at(0.35)["x"], rtol=0, atol=1e-9)


def test_a_thousand_blocks_keep_their_energy():
    run = ss.solve(row(1000), duration=0.05)
    assert len(run.events) > 100
    assert ss.energy(run).worst < 1e-10


def test_the_text_does_not_grow_with_the_number_of_blocks():
    few, many = (local_events.row_of(machine_of(row(count)).mechanics) for count in (20, 200))
    assert few.source == many.source


def test_the_number_of_contacts_says_whether_equations_are_written_out():
    titles = [method_for("auto", row(count)).title for count in (WRITTEN_OUT, WRITTEN_OUT + 1)]
    assert titles == ["Taylor steps", "local Taylor steps"]


def test_the_mirror_image_of_a_row_moves_as_its_mirror_image():
    machine = row(40, seed=3)
    mirrored = Row(tuple(-x for x in machine.offsets), speed=-machine.speed)
    run, other = (ss.solve(each, duration=3.0) for each in (machine, mirrored))
    assert [(e.t, e.part, e.after) for e in run.events] == [(e.t, e.part, -e.after) for e in other.events]
    assert np.array_equal(run.x, -other.x)


def test_what_is_far_from_an_event_is_not_computed_anew():
    """Two rows without a link between them take the steps of each alone."""
    steps = [by_tables(row(30, seed=seed), 5.0).steps for seed in (1, 2)]

    class Both(Row):
        def links(self):
            return {ends: link for ends, link in super().links().items() if ends != ("b29", "b30")}

    both = Both(row(30, seed=1).offsets + row(30, seed=2).offsets)
    assert by_tables(both, 5.0).steps == sum(steps)


def test_pieces_of_a_row_are_stored_and_cut():
    run = ss.solve(row(20), duration=2.0)
    again, cut = pieces_from_arrays("local", run.pieces.arrays()), run.pieces.until(0.7)
    t = np.linspace(0.0, 0.7, 50)
    for pieces in (again, cut):
        assert all(
            np.array_equal(a, b) for a, b in zip(pieces.evaluate(t, run._index(t)), run.pieces.evaluate(t, run._index(t)), strict=True)
        )
    assert np.array_equal(again.mode, run.pieces.mode) and cut.t[-1] == 0.7 and len(cut.mode) < len(again.mode)


def test_a_batch_of_rows_has_the_numbers_of_single_runs():
    speeds = np.array([0.01, 0.02])
    batch = ss.solve(row(20, speed=speeds), duration=2.0)
    for k, speed in enumerate(speeds):
        assert batch.mean_velocity[k] == ss.mean_velocity(ss.solve(row(20, speed=float(speed)), duration=2.0))


@pytest.mark.slow
def test_rows_of_sixteen_contacts_go_in_lanes():
    speeds = np.array([0.01, 0.02, 0.05])
    batch = ss.solve(row(WRITTEN_OUT, speed=speeds), duration=5.0)
    one = ss.solve(row(WRITTEN_OUT, speed=0.02), duration=5.0)
    assert_allclose(batch.mean_velocity[1], ss.mean_velocity(one), rtol=1e-12)


def test_conditions_on_the_state_are_no_tables():
    from stickslip.maths import where

    machine = row(20, push=lambda t, x, v: where(x > 0.05, -x, 0.0))
    assert method_for("auto", machine).title != "local Taylor steps"


def test_a_pulse_that_no_coefficient_foresees_is_no_table():
    machine = row(20, push=lambda t, x, v: exp(-100.0 * (t - 5.0) ** 2))
    assert method_for("auto", machine).title != "local Taylor steps"


def test_forces_that_differ_in_numbers_alone_have_one_text():
    forces = [traced(("d", "r"), link.force) for link in (ss.Spring(3.0, length=0.1, cubic=4.0), ss.Spring(5.0, length=-2.0, cubic=0.5))]
    assert forces[0].key == forces[1].key and forces[0].numbers != forces[1].numbers


def test_a_run_that_would_fill_the_memory_says_where_it_stopped(monkeypatch):
    monkeypatch.setattr(local_steps, "KEPT", 1000)
    with pytest.raises(ss.SolveError, match=r"stopped at t = .* most often of late: step budget used up"):
        ss.solve(row(20), duration=200.0)


def test_a_run_that_is_interrupted_keeps_what_is_done():
    run = ss.solve(row(20, speed=0.5), duration=2000.0, progress=lambda done, of: False)
    assert run.interrupted and 0.0 < run.pieces.t[-1] < 2000.0


def test_small_events_of_a_fault_are_distributed_as_carlson_and_langer_have_seen():
    """The exponent is near 1, and large events are more frequent than it says."""
    example = run_path(str(Path(__file__).parents[2] / "examples" / "burridge_knopoff.py"))
    fault = example["Fault"](300, 36.0, 0.01, example["Weakening"](2.5, 0.01))
    run = ss.solve(fault, duration=700.0, start={"v": dict.fromkeys((f"b{i}" for i in range(300)), -0.01)})
    slips = example["slips"](run)
    of = example["quakes"](slips, 300)
    M = example["moments"](run, slips, of, 0.01)[slips[np.unique(of), 1] > 200.0]
    b, error = example["fitted"](M, example["LEAST"], example["MOST"])
    assert abs(b - 1.0) < 0.2 + 3 * error
    small, large = np.sum((M >= 0.01) & (M < 0.1)), np.sum(M >= 10.0)
    assert large > 10 * small * 1000.0**-b


def test_a_fit_finds_the_exponent_that_was_drawn():
    example = run_path(str(Path(__file__).parents[2] / "examples" / "burridge_knopoff.py"))
    b, u = 0.8, np.random.default_rng(1).uniform(size=20_000)
    M = (1.0 - u * (1.0 - 100.0**-b)) ** (-1.0 / b)  # between 1 and 100
    found, error = example["fitted"](M, 1.0, 100.0)
    assert abs(found - b) < 4 * error < 0.1
