"""Runs of flows come back from files, with the flow that was solved and no other."""

import pytest

import stickslip as ss
from every import every_machine
from house import ROOT
from rows import each_row

SWING = every_machine["a flow without a period"][0]


def other(t, y, n):
    return (y[1], -n.mu * y[0] * n.gap * n.r)


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    run = ss.solve(SWING, duration=8.0, start={"x": 0.5}, events={"top": lambda t, y, n: y[1]})
    return run, run.save(tmp_path_factory.mktemp("flow") / "run.nc")


def test_all_of_a_run_comes_back(saved):
    run, path = saved
    again = ss.load(path, machines=[every_machine["a Filippov flow"][0], SWING.replace(mu=3.0)])
    assert again.model.numbers == run.model.numbers and again.provenance == run.provenance and again.start == run.start
    assert again.named_events == run.named_events and len(run.named_events) > 1
    assert again.at(2.345) == run.at(2.345) and again.end_mode == run.end_mode and repr(again) == repr(run)
    rubbing = every_machine["a flow with contacts"][0]  # a file of the time when runs of flows had a form of their own
    before = ss.load(ROOT / "tests" / "golden" / "flow-of-before-format-2.nc", machines=[rubbing.replace(speed=0.3)])
    fresh = ss.solve(rubbing, duration=4.0, samples=4, events={"top": lambda t, y, n: y[0] - 0.2})
    assert (before.method, before.start, before.counts, before.known_period) == (fresh.method, fresh.start, fresh.counts, None)
    assert (
        [e[1:] for e in before.events] == [e[1:] for e in fresh.events] and before.named_events[0].part == "top" and not before.interrupted
    )
    assert list(before.at(2.345).values())[2:] == pytest.approx(list(fresh.at(2.345).values())[2:], rel=1e-12)


@each_row(
    ("given", "said"),
    [
        ((), r"with the states x, v, and a file does not hold its functions, which are Python; type ss.load\(path, machines=\[flow\]\)"),
        ((every_machine["a Filippov flow"][0],), "none of those given has these states, numbers and modes"),
        ((ss.SwitchingFlow(other, numbers=SWING.numbers, states=("x", "v")),), "the flow given has the rates .* give the flow that was"),
    ],
)
def test_another_flow_is_refused(saved, given, said):
    with pytest.raises(ss.InputError, match=said):
        ss.load(saved[1], machines=given)
