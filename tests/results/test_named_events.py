"""Events of the user: against SciPy's on smooth motions, against the judge on stick-slip ones, touches, files, batches, simulations."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stickslip as ss
from rows import each_row

ROBOT = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb-static")
OF_ROBOT = {
    "mark": lambda s: s.x - 2e-5,
    "fast": (lambda s: s.v - 5e-3, "rises"),
    "slow": (lambda s: s.v - 5e-3, "falls"),
    "force": lambda s: s.contacts["contact"].friction_force - 0.01,
}
FALL = ss.SwitchingFlow(lambda t, y: (y[1], -10.0), states=("h", "v"))
BALL = ss.SwitchingFlow(
    {0: lambda t, y, n: (y[1], -9.81)},
    {0: (ss.Switch(lambda t, y, n: y[0], 0, lambda t, y, n: (0.0, -n.r * y[1])),)},
    numbers={"r": 0.8},
    states=("h", "v"),
)


def times_of(run, name):
    return np.array([event.t for event in run.named_events if event.part == name])


def test_smooth_motions_have_the_events_of_scipy():
    def rates(t, y):
        return (y[1], -4.0 * y[0] - 0.1 * y[1])

    own = {"level": lambda t, y: y[0] - 0.1, "energy": lambda t, y: y[1] ** 2 + 4.0 * y[0] ** 2 - 1.0}
    watched = own | {"rises": (lambda t, y: y[0], "rises")}
    run = ss.solve(ss.SwitchingFlow(rates, states=("x", "v")), start=[1.0, 0.0], duration=20.0, events=watched)

    def rising(t, y):
        return y[0]

    rising.direction = 1
    by_scipy = solve_ivp(rates, (0, 20), [1.0, 0.0], "DOP853", rtol=1e-13, atol=1e-15, events=[*own.values(), rising], max_step=0.05)
    for name, t in zip(watched, by_scipy.t_events, strict=True):
        assert len(t) and np.allclose(times_of(run, name), t, rtol=0.0, atol=1e-12)


def test_stick_slip_motions_have_the_events_of_the_judge():
    run, judge = (ss.solve(ROBOT, periods=6, events=OF_ROBOT, method=method) for method in ("auto", "dop853"))
    for name in OF_ROBOT:
        assert len(times_of(run, name)) and np.allclose(times_of(run, name), times_of(judge, name), rtol=0.0, atol=1e-11)
    mark = times_of(run, "mark")[0]
    assert abs(float(run.at(mark)["x"]) - 2e-5) < 1e-19
    assert [(e.before, e.after) for e in run.named_events if e.part == "fast"] == [(-1, 1)] * len(times_of(run, "fast"))
    assert set(run.named_events) < set(run.events) and [e.t for e in run.events] == sorted(e.t for e in run.events)


def test_coming_to_rest_is_the_instant_of_sticking():
    slow = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb-static")
    run = ss.solve(slow, periods=4, events={"at rest": lambda s: s.v})
    sticks = [event.t for event in run.events if event.kind == "stick"]
    assert sticks and all(min(abs(times_of(run, "at rest") - t)) < 1e-15 for t in sticks)


@each_row(
    "gap, signs",
    [(0.0, [(-1, -1)]), (1e-14, [(-1, -1)]), (-1e-14, [(-1, -1)]), (1e-9, []), (-1e-9, [(-1, 1), (1, -1)]), (-1e-6, [(-1, 1), (1, -1)])],
)
def test_a_tangency_is_a_touch_or_two_roots(gap, signs):
    """A throw whose top is at 5: what it passes by more than the run resolves it passes twice, sqrt(-gap/5) before and after."""
    run = ss.solve(FALL, start={"h": 0.0, "v": 10.0}, duration=1.7, events={"top": lambda t, y: y[0] - 5.0 - gap})
    assert [(event.before, event.after) for event in run.named_events] == signs
    apart = np.sqrt(max(-gap, 0.0) / 5.0) if len(signs) == 2 else 0.0
    expected = [1.0 - apart, 1.0 + apart][: len(signs)] if len(signs) == 2 else [1.0] * len(signs)
    slack = 1e-6 if len(signs) < 2 else 1e-14 / apart
    assert np.allclose(times_of(run, "top"), expected, rtol=0.0, atol=slack)


def test_a_double_root_is_a_touch():
    squared = ss.solve(FALL, start={"h": 0.0, "v": 10.0}, duration=1.7, events={"square": lambda t, y: (y[0] - 3.2) ** 2})
    assert [(event.before, event.after) for event in squared.named_events] == [(1, 1), (1, 1)]
    assert np.allclose(times_of(squared, "square"), [0.4, 1.6], rtol=0.0, atol=1e-6)


def test_a_terminal_event_ends_the_run_there():
    whole = ss.solve(ROBOT, periods=6, events={"mark": OF_ROBOT["mark"]})
    ended = ss.solve(ROBOT, periods=6, events={"mark": (OF_ROBOT["mark"], "ends"), "fast": OF_ROBOT["fast"]})
    assert ended.t[-1] == times_of(whole, "mark")[0] and abs(ended.x[-1] - 2e-5) < 1e-19
    assert ended.status == "ended by the event 'mark'" and max(event.t for event in ended.events) == ended.t[-1]
    thrown = ss.solve(BALL, start={"h": 1.0}, duration=2.0, events={"low": (lambda t, y, n: y[0] - 0.5, "ends")})
    assert abs(thrown.state[0] - 0.5) < 1e-14 and thrown.events == []


def test_plain_python_is_asked_instant_by_instant():
    def asked(s):
        return float(s.x) - 2e-5 if s.t > 0.0 else -1.0

    a, b = (ss.solve(ROBOT, periods=1, events={"mark": f}) for f in (asked, OF_ROBOT["mark"]))
    assert times_of(a, "mark").tolist() == times_of(b, "mark").tolist() and len(a.named_events) == 1


def test_a_file_keeps_them(tmp_path):
    run = ss.solve(ROBOT, periods=3, events=OF_ROBOT)
    again = ss.load(run.save(tmp_path / "run.nc"))
    assert again.named_events == run.named_events and again.events == run.events
    fall = ss.solve(FALL, start={"h": 5.0}, duration=1.5, events={"ground": lambda t, y: y[0]})
    assert "ground" in fall.to_xarray().attrs["named_events"]


def test_batches_and_sweeps_of_flows_have_columns():
    many = ss.solve(
        ROBOT.__class__(**{**vars(ROBOT), "gravity": np.array([9.81, 9.0])}), periods=6, events={"passes the mark": OF_ROBOT["mark"]}
    )
    alone = [ss.solve(case, periods=6, events={"m": OF_ROBOT["mark"]}) for case in ss.basics.batch.cases_of(many.model)]
    assert many.first_passes_the_mark.tolist() == [times_of(run, "m")[0] for run in alone]
    assert many.number_passes_the_mark.tolist() == [len(run.named_events) for run in alone]
    swept = ss.sweep(BALL, r=[0.7, 0.9], start={"h": 1.0}, duration=2.0, events={"half": lambda t, y, n: y[0] - 0.5})
    assert swept.number_half.values.tolist() == [1, 5]
    assert np.allclose(swept.first_half, np.sqrt(1.0 / 9.81), rtol=1e-14)


def test_each_case_of_a_batch_with_events_is_solved_once(monkeypatch):
    """Its numbers are those of a batch without events."""
    from stickslip.engine import lanes

    runs, run = [], lanes.run
    monkeypatch.setattr(lanes, "run", lambda *given, **more: runs.append(len(given[1])) or run(*given, **more))
    rig = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=np.array([4e-4, 6e-4, 8e-4]))
    law = ss.Coulomb(0.2, 0.2, f_plus=0.3, f_minus=0.3)
    belts = ss.BlockOnBelt(1.0, 2.0, np.array([0.1, 0.12, 0.15]), law, load=1.0)
    for model, how in ((rig, dict(periods=12, settle=4, method="rodas5p")), (belts, dict(duration=30.0))):
        plain = ss.solve(model, **how)
        runs.clear()
        many = ss.solve(model, events={"fast": lambda s: s.v - 0.01}, **how)
        assert runs == [1, 1, 1] and (many.number_fast > 0).any()
        assert all(np.array_equal(plain.columns[name], many.columns[name]) for name in ("mean_velocity", "velocity_max"))


def test_sweeps_of_machines_have_those_of_their_runs(tmp_path):
    """In memory and in a folder, which another function of the same name does not go on with."""
    belt, axes = ss.BlockOnBelt(1.0, 2.0, 0.1, ss.Coulomb(0.2, 0.2, f_plus=0.3, f_minus=0.3), load=1.0), {"speed": [0.1, 0.15, np.nan]}
    watched = {"the mark": lambda s: s.x - 0.12, "turns": (lambda s: s.v, "falls")}
    grid = ss.sweep(belt, **axes, duration=30.0, events=watched)
    alone = [ss.solve(belt.replace(speed=speed), duration=30.0, events=watched) for speed in (0.1, 0.15)]
    assert grid.first_the_mark.values[:2].tolist() == [times_of(run, "the mark")[0] for run in alone]
    assert grid.number_turns.values[:2].tolist() == [len(times_of(run, "turns")) for run in alone]
    assert np.isnan(grid.first_turns.values[2]) and grid.first_turns.units == "s" and np.isnan(grid.number_turns.values[2])
    plain = ss.sweep(belt, **axes, duration=30.0)
    assert np.array_equal(grid.mean_velocity, plain.mean_velocity, equal_nan=True) and "first_turns" not in plain
    study = ss.sweep(belt, **axes, duration=30.0, events=watched, out=tmp_path / "study")
    assert study.number_turns.equals(grid.number_turns)
    with pytest.raises(ss.InputError, match="event the mark was"):
        other = watched | {"the mark": lambda s: s.x - 0.13}
        ss.sweep(belt, **axes, duration=30.0, events=other, out=tmp_path / "study", resume=True)


def test_steps_of_a_simulation_report_them():
    run, sim, steps = ss.solve(ROBOT, periods=2, events=OF_ROBOT), ss.simulation(ROBOT, events=OF_ROBOT), []
    for k in range(37):
        sim.step(until=2.0 * ROBOT.period * (k + 1) / 37)
        steps += [event for event in sim.events if event.kind == "crossing"]
    assert [(e.part, e.before, e.after) for e in steps] == [(e.part, e.before, e.after) for e in run.named_events]
    assert np.allclose([e.t for e in steps], [e.t for e in run.named_events], rtol=0.0, atol=1e-15)


def test_a_recorded_simulation_of_a_flow_is_its_run():
    watched = {"half": lambda t, y, n: y[0] - 0.5}
    run, sim = ss.solve(BALL, start={"h": 1.0}, duration=2.0, events=watched), ss.simulation(BALL, {"h": 1.0}, record=True, events=watched)
    crossings = []
    for _ in range(40):
        sim.step(0.05)
        crossings += [event.t for event in sim.events if isinstance(event, ss.results.events.Event)]
    (recorded,) = sim.trajectories()
    t = np.linspace(0.0, 1.99, 60)
    assert np.allclose(recorded.at(t)["h"], run.at(t)["h"], rtol=0.0, atol=1e-14) and len(recorded.events) == len(run.events) == 3
    assert np.allclose(crossings, times_of(run, "half"), rtol=0.0, atol=1e-14)
    assert abs(float(sim.columns["h"]) - sim.state["h"]) < 1e-15


@each_row(
    "events, said",
    [
        (3, "allowed is a dict"),
        ({"mark": (lambda s: s.x, "rises", "falls")}, r'alone or with "rises" or "falls"'),
        ({"mark": (lambda s: s.x, "up")}, r'alone or with "rises" or "falls"'),
        ({"mark": 3}, r"events\['mark'\] = 3; allowed is a function"),
        ({"contact": lambda s: s.x}, "a name that no contact and no stop has"),
        ({"mark": lambda s: s.nothing}, r"raised AttributeError: s has no 'nothing'"),
        ({"mark": lambda s: s.z}, "the law has no inner state"),
        ({"mark": lambda s: (s.x, s.v)}, "allowed is one number"),
        ({"mark": lambda s: s.x / 0.0 * 0.0}, "not finite"),
    ],
    ids=["no dict", "both", "no word", "no function", "a contact", "no column", "no bristle", "two numbers", "nan"],
)
def test_what_is_no_event_is_refused(events, said):
    with pytest.raises(ss.InputError, match=said), np.errstate(all="ignore"):
        ss.solve(ROBOT, periods=1, events=events)


def test_what_cannot_end_is_refused():
    ending = {"mark": (lambda s: s.x, "ends")}
    with pytest.raises(ss.InputError, match="terminal"):
        ss.simulation(ROBOT, events=ending)
    with pytest.raises(ss.InputError, match=r'an event is terminal, .* leave "ends" out'):
        ss.sweep(ss.presets.piezo_rig, amplitude=[1e-4], tilt_deg=1.7, law="coulomb", events=ending)
