"""Switching flows on the compiled engine: against SciPy's integrator, closed forms, and themselves; and every door that takes them."""

from __future__ import annotations

import math

import numpy as np
import pytest

import stickslip as ss
from every import DEN_HARTOG, den_hartog
from pairs import each_once
from rows import each_row
from stickslip.maths import cos, exp, pi, sin, sqrt, where, within
from stickslip.solvers import flow_engine as flows

R, X = 0.7, 1.88569985041425  # Den Hartog 1930: frequency over the natural one, and the amplitude at friction 0.3


@pytest.fixture(scope="module")
def ball():
    hit = ss.Switch(lambda t, y, n: y[0], 0, lambda t, y, n: (0.0, -n.r * y[1]))
    return ss.SwitchingFlow({0: lambda t, y, n: (y[1], -n.g)}, {0: (hit,)}, numbers={"r": 0.8, "g": 9.81}, states=("height", "v"))


def two_modes(c):
    """Fields with sines and a kink, resets, a mode after a switch that plain Python chooses, and guards that know time."""
    a, b, d, e, f, g, h, k = c
    fields = {
        "a": lambda t, y: (y[1], -a * y[0] - b * y[1] + d * cos(1.3 * t)),
        "b": lambda t, y: (y[1] + e * sin(y[0]), -f * y[0] * abs(y[0]) - b * y[1]),
    }
    kick = ss.Switch(lambda t, y: k - y[1] + 0.3 * sin(t), lambda t, y: "b" if y[0] > 0.1 else "a", lambda t, y: (y[0] - 0.2, 0.5 * y[1]))
    hit = ss.Switch(lambda t, y: y[0] + g, "b", lambda t, y: (y[0], -h * y[1]))
    back = ss.Switch(lambda t, y: 1.5 - y[0] * y[0] - 0.4 * y[1] * y[1], "a", lambda t, y: (0.6 * y[0], 0.5 * y[1]))
    return ss.SwitchingFlow(fields, {"a": (hit, kick), "b": (back,)})


@pytest.mark.parametrize("count", [8, pytest.param(150, marks=pytest.mark.slow)])
def test_random_flows_go_as_the_judge_says(count):
    """Same switches in the same order; states and derivatives to the judge's tolerance, 1e-12 in each of some hundred steps, grown."""
    rng, switches = np.random.default_rng(14), 0
    for _ in range(count):
        flow, start = two_modes(rng.uniform(0.3, 1.5, 8)), rng.uniform(-1, 1, 2)
        ours, judge = (ss.dynamics.passage(flow, start, "a", 8.0, method=method) for method in ("exact", "dop853"))
        assert [tuple(e[1:]) for e in ours.events] == [tuple(e[1:]) for e in judge.events]
        grown = max(1.0, float(abs(judge.monodromy).max()))
        np.testing.assert_allclose([e[0] for e in ours.events], [e[0] for e in judge.events], atol=1e-10 * grown)
        for name, size in (("state", grown), ("monodromy", grown**2), ("lowest", grown), ("highest", grown)):
            np.testing.assert_allclose(getattr(ours, name), getattr(judge, name), atol=1e-9 * size)
        assert ours.rank_deficient == judge.rank_deficient and (ours.method, judge.method) == ("exact", "dop853")
        switches += len(ours.events)
    assert switches > 3 * count


def test_numbers_in_a_flows_lines_cost_no_new_kernel(monkeypatch):
    """Data never become literals: flows that differ in their numbers alone share a kernel, if no two of these are equal in one of them."""
    ss.dynamics.passage(two_modes(np.linspace(0.37, 1.13, 8)), [0.3, 0.2], "a", 1.0)
    loaded = len(flows.lanes.cache._loaded)
    ss.dynamics.passage(two_modes(np.linspace(0.31, 1.27, 8)), [0.3, 0.2], "a", 1.0)
    assert len(flows.lanes.cache._loaded) == loaded


# closed forms -------------------------------------------------------------------------------------------------------


def test_a_ball_bounces_when_it_should(ball):
    """Bounces at t0 (1 + 2 r + 2 r^2 + ...), t0 = sqrt(2 h / g); between them v is linear in time."""
    run = ss.solve(ball, start={"height": 1.0}, duration=3.0)
    t0 = math.sqrt(2 / 9.81)
    expected = t0 * (1 + 2 * np.concatenate([[0.0], np.cumsum(0.8 ** np.arange(1, len(run.events)))]))
    np.testing.assert_allclose([event.t for event in run.events], expected, rtol=1e-14)
    assert run.method == "exact" and run.highest[0] == 1.0 and run.lowest[0] == pytest.approx(0.0, abs=1e-15)
    t = expected[0] + 0.3
    assert run.at(t)["v"] == pytest.approx(0.8 * 9.81 * t0 - 9.81 * 0.3, rel=1e-14)
    np.testing.assert_allclose(run["v"][np.searchsorted(run.t, run.events[1].t) + np.array([0, 1])] @ [0.8, 1.0], 0.0, atol=1e-13)


def test_cases_that_never_stop_switching_have_a_status_and_the_others_go_on(ball):
    """With r = 0.5 it rests after t0 (1 + 2 r/(1 - r)) = 3 t0 = 1.35; with r = 1 never."""
    many = ss.solve(ball.replace(r=[0.5, 1.0]), start={"height": 1.0}, duration=2.0)
    assert many.status.tolist() == [9, 0] and any("accumulate" in said for said in many.status_counts) and np.isnan(many.mean_v[0])
    assert many.max_v[1] == pytest.approx(math.sqrt(2 * 9.81), rel=1e-13)


def test_den_hartogs_amplitude_over_friction():
    """X = sqrt(V^2 - F^2 U^2) as long as it never stops, in a sweep of the friction (O1)."""
    V, U, F = 1 / (1 - R**2), math.tan(math.pi / (2 * R)) / R, np.array([0.2, 0.3, 0.4])
    grid = ss.sweep(DEN_HARTOG, F=F, periods=160, start={"x": 1.0, "v": 0.5})
    np.testing.assert_allclose(grid.max_x, np.sqrt(V**2 - F**2 * U**2), rtol=1e-9)
    np.testing.assert_allclose(-grid.min_x, grid.max_x, rtol=1e-9)
    assert grid.period.values.tolist() == [1, 1, 1] and np.all(grid.status == 0) and float(grid.max_x[1]) == pytest.approx(X, rel=1e-9)


def test_continuation_finds_where_rest_appears():
    """The border of motion types in F is V / sqrt(1/R^4 + U^2), known in closed form."""
    V, U = 1 / (1 - R**2), math.tan(math.pi / (2 * R)) / R
    border = V / math.sqrt(1 / R**4 + U**2)
    branch = ss.continuation(DEN_HARTOG, parameter="F", start=border - 0.1, stop=border + 0.1, guess={"x": 0.9, "v": 0.8})
    found = [s for s in branch.special if s.kind in ("type-border", "grazing")]
    assert found and abs(found[0].value - border) < max(10 * found[0].accuracy, 1e-9) and found[0].accuracy < 1e-6
    assert {"x", "v", "pattern", "largest_multiplier"} <= set(branch.points)
    assert float(branch.points.largest_multiplier.max()) < 1.0


def impacts(omega=2.0):
    wall = ss.Switch(lambda t, y, n: y[0] + n.gap, 0, lambda t, y, n: (-n.gap, -n.r * y[1]))
    swing = {0: lambda t, y, n: (y[1], -y[0] - 0.2 * y[1] + cos(n.omega * t))}
    return ss.SwitchingFlow(swing, {0: (wall,)}, lambda n: 2 * pi / n.omega, {"omega": omega, "r": 0.8, "gap": 0.1}, ("x", "v"))


def test_impacts_double_their_period_where_a_multiplier_passes_minus_one():
    """The flip of the branch, the motion of two periods beyond it in a sweep, and the branch that leaves there."""
    branch = ss.continuation(impacts(), parameter="omega", start=2.3, stop=2.48)
    (flip,) = (s for s in branch.special if s.kind == "flip")
    assert np.min(abs(flip.orbit.multipliers + 1.0)) < 1e-7 and flip.accuracy < 1e-6
    beside = [flip.value - 0.01, flip.value + 0.01]
    near = dict(zip(("x", "v"), map(float, flip.orbit.state), strict=True))  # from rest it is another motion, of six periods
    assert ss.sweep(impacts(), omega=beside, periods=400, start=near).period.values.tolist() == [1, 2]
    doubled = branch.doubled(stop=2.48)
    assert doubled.period == 2 and doubled.orbits[-1].stable and len(doubled.orbits[-1].events) == 2
    assert ss.plot.continuation(branch, observable="x").get_ylabel() and ss.plot.continuation(doubled, observable="v")
    curve = ss.dynamics.special_curve(branch, flip, "r", 0.7)
    (omega, r), orbit = curve.values[-1], curve.orbits[-1]
    assert r <= 0.7 and np.min(abs(orbit.multipliers + 1.0)) < 1e-9, "the multipliers of saltation say the same as differences"
    assert np.min(abs(ss.periodic_orbit(impacts(omega).replace(r=r), guess=orbit).multipliers + 1.0)) < 1e-8


def test_a_branch_passes_the_gap_at_which_a_wall_is_grazed():
    """The free swing reaches 1/sqrt((1 - w^2)^2 + (c w)^2). Beyond it the motion with one hit goes on, steep at first."""
    swing = 1.0 / math.sqrt((1 - 4.0) ** 2 + (0.2 * 2.0) ** 2)
    branch = ss.continuation(impacts(2.0), parameter="gap", start=0.4, stop=0.25)
    grazing = next(s for s in branch.special if s.kind == "grazing")
    assert abs(grazing.value - swing) <= grazing.accuracy < 1e-9 and branch.values[-1] == 0.25
    assert [len(branch.orbits[k].events) for k in (0, -1)] == [0, 1]
    for gap, orbit in ((swing + 1e-6, branch.orbits[0]), (0.25, branch.orbits[-1])):
        run = ss.solve(impacts(2.0).replace(gap=gap), periods=400, settle=399, start=orbit.state)
        assert (len(run.events) > 0) == (gap < swing) and (not orbit.stable or abs(run.lowest[0] - orbit.run.lowest[0]) < 1e-5)


def test_exponents_are_those_of_the_multipliers():
    orbit = ss.periodic_orbit(DEN_HARTOG, guess={"x": 1.0, "v": 0.5, "mode": 1})
    found = ss.lyapunov(DEN_HARTOG, periods=40, settle=0, start=orbit)
    assert found.spectrum.sum() == pytest.approx(float(np.log(abs(orbit.multipliers)).sum()), abs=1e-8)
    told = ss.verdict(DEN_HARTOG, periods=60, settle=60, start={"x": 1.0, "v": 0.5})
    assert (told.kind, told.period) == ("periodic", 1)
    neighbours = ss.dynamics.largest_exponents(DEN_HARTOG, periods=60, settle=0, start=[*orbit.strobe_state])
    assert abs(neighbours[0][0] - np.log(abs(orbit.multipliers[0]))) < 4 * neighbours[1][0]
    assert orbit.run["x"].max() == pytest.approx(X, abs=1e-4)  # columns have 400 instants in a period


def test_two_wells_have_two_basins():
    """x'' = x - x^3 - 0.3 x' + 0.05 cos t: motions around -1 and 1, with ends on their own side of the hill."""
    wells = ss.SwitchingFlow({0: lambda t, y: (y[1], y[0] - y[0] ** 3 - 0.3 * y[1] + 0.05 * cos(t))}, period=2 * math.pi, states=("x", "v"))
    found = ss.basins(wells, x=[-1.2, -0.8, 0.8, 1.2], v=[0.0], settle=60)
    assert len(found.attractors) == 2 and found.fractions == [0.5, 0.5]
    near = {round(float(a.state[0])) for a in found.attractors}
    assert near == {-1, 1} and all(a.orbit.stable for a in found.attractors) and "mean_velocity" not in found.map
    left = found.map.attractor.values[:2, 0]
    assert len(set(left)) == 1 and set(left) != set(found.map.attractor.values[2:, 0])


def test_diagrams_go_up_and_down():
    found = ss.bifurcation(DEN_HARTOG, parameter="F", values=[0.2, 0.3], settle=160, points=4, start={"x": 1.0, "v": 0.5})
    assert found.period.values.tolist() == [[1, 1], [1, 1]] and "mean_velocity" not in found
    np.testing.assert_allclose(found.x.values[0], found.x.values[1], atol=1e-7)  # no hysteresis


# what plain Python may say ------------------------------------------------------------------------------------------


def asked(field):
    return ss.SwitchingFlow({0: field})


@pytest.mark.parametrize(
    ("plain", "same"),
    [
        (lambda t, y: (-1.0 if y[0] > 0.5 else -0.5,), lambda t, y: (where(y[0] > 0.5, -1.0, -0.5),)),
        (lambda t, y: (-max(y[0], 0.4, 0.6 * y[0]),), lambda t, y: (-where(y[0] > 0.4, y[0], 0.4),)),
        (lambda t, y: (-1.0 if y[0] > 0.2 and not y[0] > 0.6 else -0.5,), lambda t, y: (where((y[0] > 0.2) & (y[0] < 0.6), -1.0, -0.5),)),
    ],
)
def test_plain_questions_are_the_choices_that_where_makes(plain, same):
    """`if`, `max`, `and` and `not` on numbers that are not known yet: a corner in the field is found at its place, not smeared."""
    ends = [ss.dynamics.passage(asked(field), [1.0], 0, 1.5) for field in (plain, same)]
    assert ends[0].method == ends[1].method == "exact" and ends[0].state[0] == ends[1].state[0]
    assert ss.dynamics.passage(asked(plain), [1.0], 0, 1.5, method="dop853").state[0] == pytest.approx(ends[0].state[0], abs=1e-9)


def test_a_jump_of_the_field_within_a_mode_moves_disturbances():
    """y' = -1 above 1/2 and -1/2 below it: y(1) = 1/2 - (1 - (y0 - 1/2))/2, so its derivative by y0 is 1/2, and not 1."""
    done = ss.dynamics.passage(asked(lambda t, y: (where(y[0] > 0.5, -1.0, -0.5),)), [1.0], 0, 1.0)
    assert done.state[0] == pytest.approx(0.25, abs=1e-15) and done.monodromy[0, 0] == pytest.approx(0.5, abs=1e-13)


@each_row("begin", [0.0, 0.25, 3.0])
def test_a_condition_on_time_alone_changes_at_its_instant(begin):
    """y' = 1 before t = 1 and -1 after it, by `where` and by `if`."""
    expected = 2 * max(1.0 - begin, 0.0) - 2.5
    for field in (lambda t, y: (where(t < 1.0, 1.0, -1.0),), lambda t, y: (1.0 if t < 1.0 else -1.0,)):
        done = ss.dynamics.passage(asked(field), [0.0], 0, 2.5, begin=begin)
        assert (done.method, done.events) == ("exact", []) and done.state[0] == pytest.approx(expected, abs=1e-14)


def test_time_within_a_period_is_not_guessed():
    """A flow's time goes on; what begins anew with each period would be right for the first two only."""
    with pytest.raises(ss.InputError, match=r"time goes on here.*within"):
        ss.solve(asked(lambda t, y: (where(within(t, 1.0) < 0.5, 1.0, -1.0),)), start=[0.0], duration=2.75)


def test_a_mode_may_be_chosen_by_where():
    fields = {1: lambda t, y: (-1.0,), -1: lambda t, y: (0.5,), 3: lambda t, y: (2.0,)}
    flow = ss.SwitchingFlow(fields, {1: (ss.Switch(lambda t, y: y[0], lambda t, y: where(t > 0.5, 3, -1)),)})
    late, early = (ss.dynamics.passage(flow, [y], 1, 2.0) for y in (1.0, 0.25))
    assert (late.mode, early.mode, late.method) == (3, -1, "exact") and late.state[0] == pytest.approx(2.0, abs=1e-14)


@pytest.mark.parametrize(("size", "pace"), each_once([1e-12, 1.0, 1e12], [1e-9, 1.0, 1e9]))
def test_units_change_nothing(size, pace):
    """An impact oscillator in other units of length and time: states and instants to some roundings of a hundred steps."""
    swing = lambda t, y: (y[1] / pace, (-y[0] + 0.1 * size * cos(2 * t / pace)) / pace)  # noqa: E731
    hit = ss.Switch(lambda t, y: y[0] + 0.5 * size, 0, lambda t, y: (-0.5 * size, -0.8 * y[1]))
    done = ss.dynamics.passage(ss.SwitchingFlow({0: swing}, {0: (hit,)}), [size, 0.0], 0, 10 * pace)
    np.testing.assert_allclose(done.state / size, [0.0250937518, -0.7590137155], atol=1e-9)
    assert done.events[-1][0] / pace == pytest.approx(6.300787377277333, rel=1e-13)


def test_at_equality_a_switch_decides_as_python_does():
    """A reset to exactly zero, and `>=` against `>`: they differ there and nowhere else."""
    fields = {"fall": lambda t, y: (y[1], -1.0), "up": lambda t, y: (1.0, 0.0), "down": lambda t, y: (-1.0, 0.0)}

    def after(decide):
        leave = ss.Switch(lambda t, y: y[0], "middle", lambda t, y: (0.0, 0.0))
        middle = ss.Switch(lambda t, y: -1.0 + 0.0 * y[0], decide)
        flow = ss.SwitchingFlow({**fields, "middle": lambda t, y: (0.0, 0.0)}, {"fall": (leave,), "middle": (middle,)})
        return [ss.dynamics.passage(flow, [0.5, 0.0], "fall", 2.0, method=method).mode for method in ("exact", "dop853")]

    assert after(lambda t, y: "up" if y[1] >= 0 else "down") == ["up", "up"]
    assert after(lambda t, y: "up" if y[1] > 0 else "down") == ["down", "down"]


def test_what_cannot_be_traced_is_followed_by_scipy_and_says_so():
    flow = asked(lambda t, y: (-1.0 if y[0] == y[0] else 1.0,))
    done = ss.dynamics.passage(flow, [0.2], 0, 0.5)
    assert done.method == "dop853" and "==" in done.why and done.state[0] == pytest.approx(-0.3, abs=1e-12)
    with pytest.raises(ss.InputError, match=r"cannot follow the flow: .*; type method=\"auto\""):
        ss.dynamics.passage(flow, [0.2], 0, 0.5, method="exact")
    with pytest.raises(ss.InputError, match=r"with symbols: .*type ss.dynamics.passage"):
        ss.solve(flow, start=[0.2], duration=0.5)


def test_a_root_that_ends_and_a_pole_are_said():
    with pytest.raises(ss.SolveError, match="beyond t = 1"):
        ss.solve(asked(lambda t, y: (y[0] * y[0],)), start=[1.0], duration=2.0)
    with pytest.raises(ss.SolveError, match=r"beyond t = 0\.33"):
        ss.solve(asked(lambda t, y: (1 / (y[0] * y[0]) + 0.0 * sqrt(y[0] * y[0]),)), start=[-1.0], duration=2.0)


# doors --------------------------------------------------------------------------------------------------------------


def test_a_case_of_a_batch_is_the_case_alone(ball):
    many = ss.solve(ball.replace(r=np.array([0.6, 0.9]), g=9.0), start={"height": [1.0, 2.0]}, duration=0.9)
    alone = ss.solve(ball.replace(r=0.9, g=9.0), start=[2.0, 0.0], duration=0.9)
    assert many.end_height[1] == alone.state[0] and many.max_v[1] == alone.highest[1] and many.switches[1] == len(alone.events)
    t = np.linspace(0, 0.9, 20001)
    assert many.mean_height[1] == pytest.approx(float(np.mean(alone.at(0.5 * (t[1:] + t[:-1]))["height"])), abs=1e-7)  # midpoint rule


def test_the_start_and_the_numbers_are_axes(ball):
    grid = ss.map(ball, **{"start.height": [0.5, 1.0], "r": [0.7, 0.8, math.nan]}, duration=0.8)
    assert grid.max_height.dims == ("start.height", "r") and float(grid.g) == 9.81
    np.testing.assert_array_equal(grid.max_height.values[:, :2], [[0.5, 0.5], [1.0, 1.0]])
    assert grid.status.values[:, 2].tolist() == [5, 5]
    assert ss.sweep(ball, r=[0.7, 0.8], start={"height": 1.0}, duration=0.8, workers=2).equals(
        ss.sweep(ball, r=[0.7, 0.8], start={"height": 1.0}, duration=0.8)
    )


def test_a_period_may_follow_from_the_numbers():
    swing = ss.SwitchingFlow(
        {0: lambda t, y, n: (y[1], -y[0] - 0.5 * y[1] + cos(n.w * t))}, period=lambda n: 2 * pi / n.w, numbers={"w": 2.0}, states=("x", "v")
    )
    grid = ss.sweep(swing, w=[2.0, 3.0], periods=120)
    expected = [1 / math.hypot(1 - w * w, 0.5 * w) for w in (2.0, 3.0)]  # the forced linear oscillator
    np.testing.assert_allclose(grid.max_x, expected, rtol=1e-9)
    assert swing.replace(w=4.0).period == pytest.approx(math.pi / 2)


def test_columns_files_and_pictures_have_the_states_names(ball, tmp_path):
    import matplotlib.pyplot as plt
    import openpyxl
    import xarray as xr
    from scipy.io import loadmat

    run = ss.solve(ball, start={"height": 1.0}, duration=1.0)
    data = run.to_xarray()
    assert list(data) == ["height", "v", "mode"] and data.attrs["r"] == 0.8
    assert run.save(tmp_path / "ball.csv").read_text(encoding="utf-8").startswith("time,height,v,mode")
    with xr.open_dataset(run.save(tmp_path / "ball.nc")) as again:
        np.testing.assert_array_equal(again.height, data.height)
    table = loadmat(run.save(tmp_path / "ball.mat"))
    np.testing.assert_array_equal(table["height"].ravel(), data.height)
    book = openpyxl.load_workbook(run.save(tmp_path / "ball.xlsx"))
    assert [[cell.value for cell in row] for row in book["data"]["A1:D2"]] == [["time", "height", "v", "mode"], [0, 1, 0, 0]]
    assert book["columns"]["C3"].value == "state of the flow"
    ax = ss.plot.states(run, "v")
    assert ax.get_ylabel() == "v" and len(ax.lines) == 1 + len(run.events)
    ax = ss.plot.phase(run, x="v", y="height")
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("v", "height")
    plt.close("all")
    with pytest.raises(ss.InputError, match="'hight' is not a state of the flow; did you mean 'height'"):
        run["hight"]
    with pytest.raises(ss.InputError, match=r"allowed are .nc, .nc4, .h5, .hdf5, .csv, .xlsx and .mat"):
        run.save(tmp_path / "ball.zip")


def test_what_is_wrong_with_a_flow_and_its_door_is_said_at_once(ball):
    field = {0: lambda t, y: (y[1], -y[0])}
    with pytest.raises(ss.InputError, match=r"(?s)4 problems.*numbers has 'mode'.*numbers\['a'\].*states has 'b'.*scales = \(0, 1\)"):
        ss.SwitchingFlow(field, numbers={"mode": 1.0, "a": "x", "b": 1.0}, states=("b", "v"), scales=(0, 1))
    with pytest.raises(ss.InputError, match="period raised AttributeError"):
        ss.SwitchingFlow(field, period=lambda n: 1 / n.w)
    with pytest.raises(ss.InputError, match="'q' is not a number of the flow; known: r, g"):
        ball.replace(q=1.0)
    with pytest.raises(ss.InputError, match=r"(?s)2 problems.*start has no 'x'.*type duration=60.0"):
        ss.solve(ball, start={"x": 1.0})
    with pytest.raises(ss.InputError, match="numbers of the flow are arrays"):
        ss.dynamics.passage(ball.replace(r=[0.1, 0.2]), [1.0, 0.0], 0, 1.0)
    with pytest.raises(ss.InputError, match=r"has no period, and no run .*: switches accumulate"):
        ss.basins(ball, height=[1.0])
    with pytest.raises(
        ss.InputError, match=r"(?s)5 problems.*rtol = 1;.*workers = 0;.*slip_ratio is not known.*observe is.*type duration=60.0"
    ):
        ss.solve(ball, start=[1.0, 0.0], rtol=1, workers=0, slip_ratio=0.5, observe={})
    with pytest.raises(ss.InputError, match=r"(?s)2 problems.*rtol = 1;.*slip_ratio is not known of a flow"):
        ss.sweep(ball, r=[0.1, 0.2], duration=1.0, rtol=1, slip_ratio=0.5)
    with pytest.raises(ss.InputError, match="continue_along is not known of a flow; leave it out"):
        ss.sweep(ball, r=[0.1, 0.2], duration=1.0, continue_along="r")
    with pytest.raises(ss.InputError, match=r"its states have no names.*states=\('x', 'v'\)"):
        ss.periodic_orbit(ss.SwitchingFlow(field, period=1.0), guess=[1.0, 0.0])


def test_friction_in_a_field_is_as_exact_as_in_a_law():
    """A Stribeck peak in the rates: the engine's Taylor steps against the judge at rtol 1e-13."""
    slip = lambda t, y: (y[1], -2 * y[0] + 1.0 + 0.5 * exp(-((y[1] - 0.1) ** 2) / 0.02))  # noqa: E731
    flow = ss.SwitchingFlow({0: slip})
    ours, judge = (ss.dynamics.passage(flow, [0.52, 0.05], 0, 6.0, rtol=1e-13, method=method) for method in ("exact", "dop853"))
    np.testing.assert_allclose(ours.state, judge.state, atol=1e-10)


def test_equal_flows_of_the_tests_and_of_the_table(ball):
    """The table's flow is that of Den Hartog's tests: same multipliers by another way of writing it."""
    other = ss.dynamics.flow_orbit(den_hartog(0.3), [1.0, 0.5], 1, settle=10)
    own = ss.periodic_orbit(DEN_HARTOG, guess={"x": 1.0, "v": 0.5})
    np.testing.assert_allclose(np.sort_complex(own.multipliers), np.sort_complex(other.multipliers), atol=1e-9)


def test_branches_of_a_flow_are_drawn_over_its_diagram():
    """The cloud has the points of the diagram, in its first state; of two periods both lie on the branch that doubles."""
    values = [2.40, 2.42, 2.44, 2.46]
    branch = ss.continuation(impacts(), parameter="omega", start=2.3, stop=2.48)
    (flip,) = (s for s in branch.special if s.kind == "flip")
    near = dict(zip(("x", "v"), map(float, flip.orbit.state), strict=True))  # from rest it is another motion, of six periods
    diagram = ss.bifurcation(impacts(), parameter="omega", values=values, settle=400, points=8, start=near, follow=False)
    doubled = branch.doubled(stop=2.48)
    ax = ss.plot.continuation([branch, doubled], diagram=diagram)
    (cloud,) = [
        line
        for line in ax.lines
        if line.get_marker() == "o" and line.get_linestyle() == "None" and line.get_zorder() < 4 and len(line.get_xdata())
    ]
    assert ax.get_ylabel().startswith("position on the strobe $x$") and "brute force" in ax.get_legend_handles_labels()[1]
    np.testing.assert_allclose(np.sort(cloud.get_xdata()), np.repeat(values, 8), rtol=1e-14)
    np.testing.assert_allclose(np.sort(cloud.get_ydata()), np.sort(diagram.x.values.ravel()), rtol=1e-14)
    orbit = doubled.at(2.46)
    points = np.sort([orbit.state[0], orbit.run.at(0.5 * orbit.duration)["x"]])
    ends = np.sort(diagram.x.sel(omega=2.46).values.ravel())[[0, -1]]
    assert np.ptp(points) > 0.01 and np.allclose(ends, points, atol=1e-6)
