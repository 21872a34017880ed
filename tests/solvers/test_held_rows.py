"""A row of many blocks that goes on step by step: forces on blocks, recording, copies and files, and what a damaged file may not do."""

import dataclasses
import json

import numpy as np
import pytest

import stickslip as ss
from blocks import Row, row
from stickslip.solvers.simulation import Simulation

BLOCKS, FORCE = row(40), "force on b3"


class Pushed(Row):
    """The same with a constant force on one block."""

    def bodies(self):
        return {name: dataclasses.replace(body, force=0.3) if name == "b3" else body for name, body in super().bodies().items()}


def begun(**how):
    sim = ss.simulation(BLOCKS, **how)
    sim.step(3.3)
    return sim


def events_of(events, begin=0.0):
    return [(round(event.t - begin, 9), event.part, event.before, event.after) for event in events]


def test_a_force_on_a_block_moves_the_row_as_one_that_its_body_declares():
    sim = begun(record=True)
    run = ss.solve(Pushed(BLOCKS.offsets), start=sim.start, duration=8.0)
    begin, events = sim.t, []
    for _ in range(8):
        state = sim.step(1.0, inputs={FORCE: 0.3})
        events += sim.events
        at = run.at(sim.t - begin)
        assert max(abs(state["x"] - at["x"]).max(), abs(state["v"] - at["v"]).max()) < 1e-14
    changed = [event for event in events if event.t > begin]  # at the jump itself the run begins
    assert len(changed) > 5 and events_of(changed, begin) == events_of(run.events)
    first, second = sim.trajectories()
    assert events_of(second.events, begin) == events_of(run.events) and first.t[-1] == second.t[0] == begin
    assert abs(second.at(begin + 0.7)["x"] - run.at(0.7)["x"]).max() < 1e-14 and ss.energy(second).worst < 1e-10
    assert np.allclose(sim.columns["friction_force"], second.at(sim.t)["friction_force"], rtol=0.0, atol=1e-12)


def test_what_follows_a_snapshot_or_a_file_of_a_row_is_the_same_to_the_last_bit(tmp_path):
    sim = begun()
    sim.step(0.4, inputs={FORCE: 0.3, "speed": 0.02})
    before, path = sim.snapshot(), sim.save(tmp_path / "row.json")
    first, events = str(sim.step(1.7)), sim.events
    sim.restore(before)
    assert str(sim.step(1.7)) == first and sim.events == events
    loaded = Simulation.load(path, machine=BLOCKS)
    assert str(loaded.step(1.7)) == first and loaded.events == events and loaded.inputs == sim.inputs
    table = json.loads(path.read_text())
    (tmp_path / "other.json").write_text(json.dumps(table | {"kernel": "another", "lane": []}))
    other = Simulation.load(tmp_path / "other.json", machine=BLOCKS).step(1.7)
    assert abs(other["x"] - loaded.state["x"]).max() < 1e-13


def test_a_file_cannot_say_where_the_kernel_finds_its_way(tmp_path):
    sim = begun()
    table = json.loads(sim.save(tmp_path / "row.json").read_text())
    first = len(sim.now.side.arrays.values)  # of the whole numbers, those of the first body
    for place, value in ((0, 7), (1, 1000), (5, 0), (9, 40), (11, -2), (9, 0.5)):
        lane = list(table["lane"])
        lane[first + place] = value
        (tmp_path / "bad.json").write_text(json.dumps(table | {"lane": lane}))
        with pytest.raises(ss.InputError, match="is damaged"):
            Simulation.load(tmp_path / "bad.json", machine=BLOCKS)


def test_a_step_of_a_row_stops_at_each_of_its_events():
    run, sim, met = ss.solve(BLOCKS, duration=5.0), ss.simulation(BLOCKS), []
    while sim.t < 5.0:
        sim.step(until=5.0, stop_at_events=True)
        assert not sim.events or sim.events[-1].t == sim.t
        met += sim.events
    assert len(met) > 20 and events_of(met) == events_of(run.events)


def test_named_events_of_a_row_are_those_of_its_run():
    passes = {"passes": lambda s: s.x[0] - s.x[1]}
    run, sim = ss.solve(BLOCKS, duration=4.0, events=passes), ss.simulation(BLOCKS, events=passes)
    named = []
    for _ in range(4):
        sim.step(1.0)
        named += [event for event in sim.events if event.part == "passes"]
    assert events_of(named) == events_of(event for event in run.events if event.part == "passes") != []


def test_a_row_that_rests_is_carried_by_its_ground():
    still = dataclasses.replace(BLOCKS, offsets=(0.0,) * 40)
    sim = ss.simulation(still, {"v": dict.fromkeys((f"b{i}" for i in range(40)), -0.01)})
    for _ in range(3):
        sim.step(30.0)
    assert sim.status == "finished" and not sim.events and np.allclose(sim.state["x"], -0.9, rtol=1e-14, atol=0.0)
