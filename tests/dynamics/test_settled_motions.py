"""Whether starts have settled, and on what, against closed forms and against a plain integrator of our own."""

import numpy as np
import pytest

import stickslip as ss
from stickslip.dynamics.attractors.basins import wilson
from stickslip.dynamics.attractors.motion_features import features_of, motion_numbers
from stickslip.dynamics.attractors.settled_motions import Settling, settled_motions
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, spread_over
from stickslip.maths import cos, sin

LOGISTIC = lambda y, n: (n.r * y[0] * (1 - y[0]),)  # noqa: E731
HENON = ss.SwitchingFlow.of_map(lambda y, n: (1 - 1.4 * y[0] ** 2 + y[1], 0.3 * y[0]), {"a": 1.4}, ("x", "y"))
PLANE = np.array([(a, b) for a in np.linspace(-2.2, 2.2, 9) for b in np.linspace(-2.2, 2.2, 9)])


def forced(acceleration, omega=1.0):
    """An oscillator x'' = f(t, x, v) under a force of period 2 pi / omega."""
    field = {0: lambda t, y: (y[1], acceleration(t, y[0], y[1]))}
    return ss.SwitchingFlow(field, period=2 * np.pi / omega, states=("x", "v"))


def duffing(force, damping=0.15):
    return lambda t, x, v: x - x**3 - damping * v + force * cos(t)


def settled(model, states, settle=50, limit=None, groups=None):
    at = coordinates(model)
    states = np.column_stack([states, np.zeros((len(states), len(at.names) - np.shape(states)[1]))])
    batch = spread_over(model, len(states))
    return settled_motions(batch, states, at, Settling(settle, limit or 8 * settle, 1e-7), groups=groups)


def integrated(acceleration, states, periods, steps=100):
    """Strobe points (periods, cases, 2) by the classical Runge-Kutta method, all cases side by side: a plain twin."""
    y, h, points = states.T.copy(), 2 * np.pi / steps, []

    def rate(t, y):
        return np.array([y[1], acceleration(t, y[0], y[1])])

    for n in range(periods * steps):
        t = n * h
        k1 = rate(t, y)
        k2 = rate(t + h / 2, y + h / 2 * k1)
        k3 = rate(t + h / 2, y + h / 2 * k2)
        k4 = rate(t + h, y + h * k3)
        y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        if (n + 1) % steps == 0:
            points.append(y.T)
    return np.array(points)


@pytest.mark.parametrize("settle", [2, 20, 60])
def test_duffings_two_attractors_are_two_however_early_one_looks_first(settle):
    """Transient chaos was taken for attractors without a period: eight of them after 60 periods."""
    found = ss.basins(forced(duffing(0.2)), x=np.linspace(-2.2, 2.2, 9), v=np.linspace(-2.2, 2.2, 9), settle=settle, limit=480)
    assert [(a.kind, a.period) for a in found.attractors] == [("periodic", 1)] * 2 and not found.others and not found.notes
    ends = integrated(lambda t, x, v: x - x**3 - 0.15 * v + 0.2 * np.cos(t), PLANE, 400)
    left = np.mean(ends[-1, :, 0] < 0)
    shares = {a.state[0] < 0: a for a in found.attractors}
    for share, side in ((left, True), (1 - left, False)):
        low, high = wilson(round(share * len(PLANE)), len(PLANE))
        assert low <= shares[side].share <= high
        assert np.min(np.max(abs(ends[-1] - shares[side].state[:2]), axis=1)) < 1e-4  # the step of the twin


def test_a_start_that_still_moves_at_the_limit_is_not_settled_and_counted_as_that():
    """Far from its orbit and nearly without damping, a hardening oscillator closes in for ten thousand periods."""
    found = ss.basins(
        forced(lambda t, x, v: -x - x**3 - 5e-4 * v + 0.3 * cos(t)), x=[-2.0, -1.0, 1.0, 2.0], v=[0.0, 1.0], settle=10, limit=10
    )
    assert found.attractors == [] and list(found.others) == ["not settled"]
    share, (low, high) = found.others["not settled"]
    assert share == 1.0 and (low, high) == wilson(8, 8)
    assert "still moves after 610 drive periods" in found.notes[0] and "limit=" in found.notes[-1]
    assert "not settled: share 1.000" in repr(found) and "not settled" in found._repr_html_()


def test_chaos_has_a_positive_exponent_and_its_starts_are_on_one_attractor():
    """At f = 0.3 the larger part of the starts ends in chaos, the others in a large motion of period one; the twin counts the same."""
    found = ss.basins(forced(duffing(0.3)), x=np.linspace(-2.2, 2.2, 9), v=np.linspace(-2.2, 2.2, 9), settle=60)
    by_kind = {a.kind: a for a in found.attractors}
    assert set(by_kind) == {"chaotic", "periodic"} and len(found.attractors) == 2
    assert by_kind["chaotic"].exponent > 3 * by_kind["chaotic"].error > 0 and "exponent" in repr(found)
    points = integrated(lambda t, x, v: x - x**3 - 0.15 * v + 0.3 * np.cos(t), PLANE, 300)
    repeats = np.max(abs(points[-1] - points[-2]), axis=1) < 1e-6
    low, high = wilson(int(np.count_nonzero(~repeats)), len(PLANE))
    assert low <= by_kind["chaotic"].share <= high


def test_a_chaotic_transient_has_a_positive_exponent_and_is_no_attractor():
    """The logistic map in its window of period three (from 1 + sqrt(8) on) has a chaotic saddle, which starts leave at some time."""
    window = ss.SwitchingFlow.of_map(LOGISTIC, {"r": 3.835}, ("x",))
    found = ss.basins(window, x=np.linspace(0.05, 0.95, 37), settle=5, limit=20)
    assert {a.kind for a in found.attractors} == {"periodic"} and found.attractors[0].period == 3


@pytest.mark.parametrize("damping", [0.01, 0.001, 0.0001])
def test_a_weakly_damped_oscillator_has_one_attractor_by_its_orbit(damping):
    """A multiplier of exp(-pi d) closes in by a thousandth of a digit in a period; the derivative of the map says where it goes.

    x'' + d x' + 2 x = 0.3 cos t: x + i x' of the closed form, 0.3/(1 + i d).
    """
    found = settled(forced(lambda t, x, v: -2 * x - damping * v + 0.3 * cos(t)), PLANE[:6])
    assert (found.kind == "periodic").all() and (found.period == 1).all()
    answer = 0.3 / (1 + 1j * damping)
    assert np.max(abs(found.points[:, -1, :2] - [answer.real, -answer.imag])) < 1e-6


def test_without_damping_nothing_attracts():
    found = settled(forced(lambda t, x, v: -2 * x + 0.3 * cos(t)), PLANE[:6])
    assert (found.kind == "not settled").all() and all("preserved" in why for why in found.why)
    pendulum = settled(forced(lambda t, x, v: -sin(x) + 0.3 * cos(t)), PLANE[::20])
    assert not (pendulum.kind == "chaotic").any() and not (pendulum.kind == "quasi-periodic").any()


def test_a_torus_is_one_quasi_periodic_attractor():
    """Van der Pol's oscillator under a weak force: all starts go to one torus, whose means agree and whose exponent is zero."""
    found = ss.basins(forced(lambda t, x, v: (1 - x**2) * v - x + 0.2 * cos(1.7 * t), 1.7), x=[-1.0, 0.5, 2.0], v=[0.0, 1.0], settle=60)
    assert [(a.kind, a.share) for a in found.attractors] == [("quasi-periodic", 1.0)]
    assert abs(found.attractors[0].exponent) < 3 * found.attractors[0].error


def test_starts_run_away_in_finite_time_or_ever_faster():
    escape = forced(lambda t, x, v: -x + x**2 - 0.1 * v + 0.06 * cos(0.85 * t), 0.85)
    found = settled(escape, np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 3.0]]))
    assert found.kind.tolist() == ["periodic", "runs away", "runs away"]
    assert settled(forced(lambda t, x, v: 1.0 + cos(t)), PLANE[:2]).kind.tolist() == ["runs away"] * 2


def test_the_logistic_map_by_its_number():
    """Fixed point, period two, chaos, escape; at the flip r = 3 the approach is algebraic, and nothing is claimed."""
    many = ss.SwitchingFlow.of_map(LOGISTIC, {"r": [2.8, 3.2, 3.9, 4.5, 3.0]}, ("x",))
    found = settled(many, np.full((5, 1), 0.3), settle=100, groups=np.arange(5))
    assert found.kind.tolist() == ["periodic", "periodic", "chaotic", "runs away", "not settled"]
    assert found.period.tolist() == [1, 2, 0, 0, 0]


def test_a_chaos_map_of_a_map_has_the_exponents_of_its_multipliers():
    """A fixed point has the multiplier 2 - r, the motion of period 2 the multiplier 4 + 2 r - r^2; at r = 3.9 ln|f'| is averaged here."""
    made = lambda r: ss.SwitchingFlow.of_map(LOGISTIC, {"r": r}, ("x",))  # noqa: E731
    found = ss.dynamics.chaos_map(made, r=[2.8, 3.2, 3.9], start={"x": 0.3}, settle=200, periods=400)
    assert found.period.values.tolist() == [1, 2, 0] and found.motion.values.tolist() == ["periodic", "periodic", "chaotic"]
    x, logs = 0.3, []
    for _ in range(100_000):
        x = 3.9 * x * (1 - x)
        logs.append(np.log(abs(3.9 * (1 - 2 * x))))
    wanted = [np.log(0.8), 0.5 * np.log(0.16), np.mean(logs)]
    assert found.exponent.values[:2] == pytest.approx(wanted[:2], abs=1e-9)
    assert found.exponent.values[2] == pytest.approx(wanted[2], abs=4 * found.error.values[2])


def test_bifurcation_and_chaos_map_say_what_a_motion_is():
    logistic = ss.SwitchingFlow.of_map(LOGISTIC, {"r": 3.2}, ("x",))
    diagram = ss.bifurcation(logistic, parameter="r", values=[2.8, 3.9], start={"x": 0.3}, follow=False, settle=50)
    assert diagram.motion.values.tolist() == [["periodic", "chaotic"]] and diagram.exponent[0, 1] > 3 * diagram.error[0, 1]
    along = ss.attractors(HENON, parameter="a", values=[1.4, 1.41], starts={"x": [0.0, 0.1]}, settle=50)
    assert along.motion.values.tolist() == [["chaotic", "chaotic"]] and (along.unsettled == 0).all()
    robot = ss.dynamics.chaos_map(ss.presets.piezo_rig, mu0=[0.04, 0.05], amplitude=4e-4, tilt_deg=1.7, settle=100, periods=60)
    assert robot.motion.values.tolist() == ["periodic", "chaotic"]


def test_two_starts_on_one_chaotic_attractor_are_one_and_mirror_twins_are_two():
    """A cubic map whose two chaotic bands are mirror images of one another."""
    cubic = ss.SwitchingFlow.of_map(lambda y, n: (n.r * y[0] - y[0] ** 3,), {"r": 2.5}, ("x",))
    found = settled(cubic, np.array([[0.3], [0.7], [-0.3], [-0.5]]))
    assert (found.kind == "chaotic").all()
    number = motion_numbers(features_of(float(cubic.period), found, coordinates(cubic)), found.attracted)
    assert number.tolist() == [0, 0, 1, 1]


@pytest.mark.parametrize("follow", [True, False])
def test_a_start_that_stays_on_an_unstable_motion_by_its_symmetry_is_on_no_attractor(follow):
    """x' = r x - x^3 keeps x = 0, which repels from r = 1 on."""
    cubic = ss.SwitchingFlow.of_map(lambda y, n: (n.r * y[0] - y[0] ** 3,), {"r": 1.5}, ("x",))
    found = ss.basins(cubic, x=[-0.5, 0.0, 0.5], settle=60)
    assert len(found.attractors) == 2 and found.map.motion.values.tolist() == ["periodic", "not settled", "periodic"]
    assert "1 of 3 starts: the start lies on an unstable motion of period 1: a nudge" in found.notes[0] and "limit=" not in found.notes[-1]
    diagram = ss.bifurcation(cubic, parameter="r", values=[0.8, 1.2], settle=60, follow=follow)
    assert (diagram.motion.sel(r=0.8) == "periodic").all() and (diagram.motion.sel(r=1.2) == "not settled").all()
    told = ss.verdict(cubic, periods=20, settle=60)
    assert told.kind == "not settled" and "unstable motion" in told.why


def test_the_limit_is_checked():
    with pytest.raises(ss.InputError, match="allowed is a whole number of drive periods from settle = 50 on"):
        ss.basins(HENON, x=[0.0, 0.1], settle=50, limit=20)


@pytest.mark.parametrize("r", [1 + np.sqrt(6), 3.5440, 3.5699, 3.569945672])
def test_where_periods_double_a_motion_is_not_quasi_periodic(r):
    """At a doubling nothing settles within a limit, and where doublings accumulate (Feigenbaum 1978) the attractor is no curve."""
    found = settled(ss.SwitchingFlow.of_map(LOGISTIC, {"r": float(r)}, ("x",)), np.array([[0.3]]), 200)
    assert found.kind[0] == "not settled" and "closed curve" in found.why[0]


@pytest.mark.parametrize(("a", "kind"), [(1.9, "periodic"), (2.1, "quasi-periodic"), (2.2, "periodic")])
def test_the_delayed_logistic_map_has_a_closed_curve_and_a_locked_motion(a, kind):
    """x' = a x (1 - y), y' = x: from a = 2 on a closed curve, which locks at a sevenfold period (Aronson, Chory, Hall and McGehee 1982)."""
    delayed = ss.SwitchingFlow.of_map(lambda y, n: (n.a * y[0] * (1 - y[1]), y[0]), {"a": a}, ("x", "y"))
    found = settled(delayed, np.array([[0.4, 0.4], [0.3, 0.5]]), 200)
    assert (found.kind == kind).all() and found.period.tolist() == [{1.9: 1, 2.1: 0, 2.2: 7}[a]] * 2


def test_a_forced_damped_pendulum_has_the_attractors_of_a_plain_integrator():
    """x'' + 0.2 x' + sin x = 1.2 cos t on the cylinder: angles that differ by whole turns are one state."""
    found = settled(forced(lambda t, x, v: -sin(x) - 0.2 * v + 0.6 * cos(t)), PLANE[::4])
    plain = integrated(lambda t, x, v: -np.sin(x) - 0.2 * v + 0.6 * np.cos(t), PLANE[::4], 400)
    for i in range(len(plain[0])):
        back = plain[-1, i] - plain[-2:-12:-1, i]
        repeats = np.flatnonzero((abs(np.sin(back[:, 0] / 2)) < 1e-6) & (abs(back[:, 1]) < 1e-6) & (abs(back[:, 0]) < 1))
        assert found.kind[i] == ("periodic" if len(repeats) else "chaotic")
        if len(repeats):
            assert found.period[i] == repeats[0] + 1
            apart = found.points[i, :, :2] - plain[-1, i]
            assert np.min(np.max(abs(apart), axis=1)) < 1e-4  # the step of the twin


def test_basins_that_were_interrupted_say_so_in_their_notes():
    starts = dict(x=np.linspace(-2.2, 2.2, 40), v=np.linspace(-2.2, 2.2, 40))
    found = ss.basins(forced(duffing(0.2)), **starts, settle=60, progress=lambda p: not p.done)
    assert found.notes and found.notes[0] == found.map.attrs["note"] and found.notes[0].startswith("stopped by progress: ")


def test_the_figure_of_a_bifurcation_has_the_share_of_what_has_not_settled():
    logistic = ss.SwitchingFlow.of_map(LOGISTIC, {"r": 2.8}, ("x",))
    diagram = ss.bifurcation(logistic, parameter="r", values=[2.8, 2.9, 3.2, 3.5699], start=[0.3], settle=100, follow=False)
    labels = [text.get_text() for text in ss.plot.bifurcation(diagram).get_legend().get_texts()]
    assert diagram.motion.values.ravel().tolist()[-1] == "not settled" and "not settled, 25 %" in labels
