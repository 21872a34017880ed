"""Hand-written flows that switch: starts beyond a guard, chains of switches, chattering, true extremes, and what a user may get wrong."""

from __future__ import annotations

import math

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.errors import StickslipError
from stickslip.maths import atan, cos, sqrt


def ball(restitution=0.8):
    return ss.SwitchingFlow(
        {0: lambda t, y: (y[1], -9.81)}, {0: (ss.Switch(lambda t, y: y[0], 0, lambda t, y: (0.0, -restitution * y[1])),)}
    )


def swinging(guard, reset=None):
    """x'' = -x until a guard ends it."""
    return ss.SwitchingFlow({0: lambda t, y: (y[1], -y[0]), 1: lambda t, y: (0.0, 0.0)}, {0: (ss.Switch(guard, 1, reset),)})


# where a mode begins beyond a guard ---------------------------------------------------------------------------------


def held(limit=1.5):
    """A block on a spring that is held until the spring pulls by more than the limit; friction 1 when it slides."""
    slide = lambda side: lambda t, y: (y[1], -4.0 * y[0] - side)  # noqa: E731
    loose = (ss.Switch(lambda t, y: limit + 4.0 * y[0], "forth"), ss.Switch(lambda t, y: limit - 4.0 * y[0], "back"))
    stop = lambda t, y: (y[0], 0.0)  # noqa: E731
    ends = {"forth": (ss.Switch(lambda t, y: y[1], "rest", stop),), "back": (ss.Switch(lambda t, y: -y[1], "rest", stop),)}
    return ss.SwitchingFlow({"rest": lambda t, y: (0.0 * y[0], 0.0), "forth": slide(1), "back": slide(-1)}, {"rest": loose, **ends})


def test_a_start_beyond_a_guard_switches_at_once():
    """It slides as from a start in the mode that the guard leads to: x'' = -4 x + 1 from (0.5, 0)."""
    done = ss.dynamics.passage(held(), [0.5, 0.0], "rest", 0.5)
    assert done.events == [(0.0, "rest", "back")] and done.mode == "back"
    assert done.state[0] == pytest.approx(0.25 + 0.25 * math.cos(1.0), abs=1e-12)
    again = ss.dynamics.passage(held(), [0.5, 0.0], "back", 0.5)
    np.testing.assert_allclose(done.monodromy, again.monodromy, atol=1e-12)  # every start nearby switches at once too


def test_a_start_within_its_guards_stays():
    done = ss.dynamics.passage(held(), [0.3, 0.0], "rest", 0.5)
    assert done.events == [] and done.mode == "rest" and done.time == 0.5


def test_a_guard_of_zero_at_the_start_is_asked_where_it_goes():
    up, down = (ss.dynamics.passage(ball(), [0.0, v], 0, 0.1).events for v in (1.0, -1.0))
    assert up == [] and down == [(0.0, 0, 0)]


def test_a_reset_beyond_another_guard_is_one_switch_of_both():
    """a: y' = -1 to 0, then y - 1 in b, which leaves at once for c: y' = 1/2. The derivative is that of y(2) = -1 + (2 - y0)/2."""
    flow = ss.SwitchingFlow(
        {"a": lambda t, y: (-1.0,), "b": lambda t, y: (1.0,), "c": lambda t, y: (0.5,)},
        {"a": (ss.Switch(lambda t, y: y[0], "b", lambda t, y: (y[0] - 1.0,)),), "b": (ss.Switch(lambda t, y: y[0] + 0.5, "c"),)},
    )
    ends = [ss.dynamics.passage(flow, [y], "a", 2.0) for y in (1.0, 1.0 + 1e-6)]
    assert [(before, after) for _, before, after in ends[0].events] == [("a", "b"), ("b", "c")]
    assert ends[0].events[0][0] == ends[0].events[1][0]
    assert float(ends[0].monodromy[0, 0]) == pytest.approx(-0.5, abs=1e-12)
    assert (ends[1].state - ends[0].state)[0] == pytest.approx(-0.5e-6, abs=1e-12)


@each_row(("start", "mode"), [((1.0, 1.0), 1), ((1.0, 0.9), 2), ((0.9, 1.0), 1), ((-1.0, -2.0), 1)])
def test_the_guard_that_falls_first_counts_and_of_several_the_first_in_order(start, mode):
    fields = {0: lambda t, y: (-1.0, -1.0), 1: lambda t, y: (0.0, 0.0), 2: lambda t, y: (0.0, 0.0)}
    flow = ss.SwitchingFlow(fields, {0: (ss.Switch(lambda t, y: y[0], 1), ss.Switch(lambda t, y: y[1], 2))})
    assert ss.dynamics.passage(flow, start, 0, 3.0).mode == mode


@each_row("depth", [-1e-6, -1e-12, 1e-12, 1e-6])
def test_a_guard_that_dips_below_zero_within_a_step_is_seen_and_one_that_does_not_is_not(depth):
    """x = cos t comes down to -1 at pi. The dip below -1 - depth begins sqrt(-2 depth) before; an error e of x moves that by e over it."""
    events = ss.dynamics.passage(swinging(lambda t, y: y[0] + 1.0 + depth), [1.0, 0.0], 0, 6.0).events
    assert len(events) == (depth < 0)
    if events:
        early = math.sqrt(-2 * depth)
        assert events[0][0] == pytest.approx(math.pi - early, abs=1e-12 / early)  # 1e-12: the integrator's tolerance


def test_a_fast_guard_is_resolved_within_a_step():
    at = ss.dynamics.passage(swinging(lambda t, y: cos(40.0 * t) + 0.9), [1.0, 0.0], 0, 6.0).events[0][0]
    assert at == pytest.approx(math.acos(-0.9) / 40.0, abs=1e-13)


def test_a_guard_that_is_only_touched_has_no_derivative():
    """The start stands on the guard and does not move: whether it leaves is decided by the smallest disturbance."""
    flow = ss.SwitchingFlow({0: lambda t, y: (y[1], -1.0), 1: lambda t, y: (0.0, 0.0)}, {0: (ss.Switch(lambda t, y: y[0], 1),)})
    done = ss.dynamics.passage(flow, [0.0, 0.0], 0, 1.0)
    assert done.mode == 1 and np.isnan(done.monodromy).any()


# switches without end -----------------------------------------------------------------------------------------------


def test_chattering_is_an_error():
    push = lambda side: lambda t, y: (y[1], -y[0] - 0.9 * side)  # noqa: E731
    turn = {0: (ss.Switch(lambda t, y: y[1], 1),), 1: (ss.Switch(lambda t, y: -y[1], 0),)}
    with pytest.raises(ss.SolveError, match=r"accumulate at t = 3\.17.*chatters.*mode that slides along the guard"):
        ss.dynamics.passage(ss.SwitchingFlow({0: push(1.0), 1: push(-1.0)}, turn), [2.5, 0.1], 0, 20.0)


@each_row(("start", "begun"), [((1.0, 0.0), 4.0637), ((0.0, 0.0), 0.0), ((-0.1, 0.0), 0.0)])
def test_a_ball_that_comes_to_rest_in_infinitely_many_jumps_is_an_error(start, begun):
    """Zeno: it rests sqrt(2 h/g) (1 + 2 r/(1 - r)) after it fell from h."""
    if begun:
        assert math.sqrt(2 / 9.81) * 9 == pytest.approx(begun, abs=1e-4)
    with pytest.raises(ss.SolveError, match=r"accumulate at t = .*\(Zeno\)") as error:
        ss.dynamics.passage(ball(), start, 0, 10.0)
    told = float(str(error.value).split("t = ")[1].split()[0])
    assert told == pytest.approx(begun, abs=1e-4)


def test_a_reset_that_lands_beyond_the_same_guard_for_ever_is_an_error():
    flow = ss.SwitchingFlow({0: lambda t, y: (-1.0,)}, {0: (ss.Switch(lambda t, y: y[0], 0, lambda t, y: (-0.1 - y[0],)),)})
    with pytest.raises(ss.SolveError, match="accumulate at t = 1 "):
        ss.dynamics.passage(flow, [1.0], 0, 10.0)


def test_a_passage_that_is_to_end_after_some_switches_says_when_it_did():
    done = ss.dynamics.passage(ball(), [1.0, 0.0], 0, 10.0, switches=2)
    assert done.time == done.events[-1][0] == pytest.approx(math.sqrt(2 / 9.81) * 2.6, abs=1e-12)
    assert ss.dynamics.passage(ball(), [1.0, 0.0], 0, 0.1, begin=2.0).time == 2.1


# extremes -----------------------------------------------------------------------------------------------------------


def test_extremes_are_those_of_the_motion_and_not_of_the_steps():
    """0.3 cos t + 0.4 sin t: its amplitude is 0.5. Tolerance 1e-12 a step, some dozen steps."""
    flow = ss.SwitchingFlow({0: lambda t, y: (y[1], -y[0])})
    done = ss.dynamics.passage(flow, [0.3, 0.4], 0, 20.0)
    np.testing.assert_allclose([done.lowest, done.highest], [[-0.5, -0.5], [0.5, 0.5]], atol=1e-11)


def test_extremes_end_where_an_arc_ends():
    """x = cos t is caught at 0 and set to 2: what the integrator saw beyond the guard does not count."""
    done = ss.dynamics.passage(swinging(lambda t, y: y[0], lambda t, y: (2.0, 0.0)), [1.0, 0.0], 0, 6.0)
    np.testing.assert_allclose([done.lowest, done.highest], [[0.0, -1.0], [2.0, 0.0]], atol=1e-12)


def test_den_hartogs_amplitude_is_the_highest_point_of_his_orbit():
    slide = lambda side: lambda t, y: (y[1], -y[0] + cos(0.7 * t) - side * 0.3)  # noqa: E731
    turn = {1: (ss.Switch(lambda t, y: y[1], -1),), -1: (ss.Switch(lambda t, y: -y[1], 1),)}
    flow = ss.SwitchingFlow({1: slide(1), -1: slide(-1)}, turn, 2 * math.pi / 0.7)
    orbit = ss.dynamics.flow_orbit(flow, [1.0, 0.5], 1, settle=8)
    assert orbit.passage.highest[0] == pytest.approx(1.88569985041425, abs=1e-10)
    assert orbit.passage.lowest[0] == pytest.approx(-1.88569985041425, abs=1e-10)


# orbits and equilibria ----------------------------------------------------------------------------------------------


def van_der_pol():
    return ss.SwitchingFlow({0: lambda t, y: (y[1], (1 - y[0] * y[0]) * y[1] - y[0])})


@pytest.mark.parametrize(
    "field",
    [
        lambda t, y: (y[1], -y[0] - 0.1 * y[1]),
        lambda t, y: (y[1], -y[0] - 1e-5 * y[1] + 0.01 * y[0] * y[0]),
        lambda t, y: (-y[0], -2.0 * y[1]),
        lambda t, y: (0.0 * y[0], 0.0),
        lambda t, y: (y[1], (1 - y[0] * y[0]) * y[1] - y[0]),
    ],
    ids=["focus", "weak focus", "node", "nothing", "unstable focus"],
)
def test_an_equilibrium_is_never_returned_as_an_orbit(field):
    with pytest.raises(ss.SolveError, match=r"equilibrium|went to a duration of zero"):
        ss.dynamics.flow_orbit(ss.SwitchingFlow({0: field}), [0.05, 0.02], 0, duration=6.28)


def test_rest_between_guards_is_no_orbit():
    with pytest.raises(ss.SolveError, match=r"equilibrium.*mode 'rest'"):
        ss.dynamics.flow_orbit(held(), [0.1, 0.0], "rest", duration=2.0)


@each_row("turns", [1, 2, 3])
def test_an_orbit_is_gone_around_once(turns):
    """Van der Pol's oscillator at mu = 1: period 6.6632868593231 (its first digits: Urabe 1960)."""
    orbit = ss.dynamics.flow_orbit(van_der_pol(), [2.0, 0.0], 0, duration=6.66 * turns)
    assert orbit.duration == pytest.approx(6.663286859323, abs=1e-10) and orbit.notes == ()


def test_a_forced_motion_that_repeats_sooner_is_not_returned_for_more_periods():
    flow = ss.SwitchingFlow({0: lambda t, y: (y[1], -y[0] - 0.5 * y[1] + cos(2 * t))}, period=math.pi)
    assert ss.dynamics.flow_orbit(flow, [1.0, 0.0], 0).residual < 1e-11
    with pytest.raises(ss.SolveError, match="type periods=1"):
        ss.dynamics.flow_orbit(flow, [1.0, 0.0], 0, periods=2)


# what a user may get wrong ------------------------------------------------------------------------------------------


@each_row(
    ("field", "told"),
    [
        (lambda t, y: None, "gave None.*return missing"),
        (lambda t, y: (y[1],), "gave 1 numbers; allowed is a tuple of 2"),
        (lambda t, y: (y[1], 0.0, 0.0), "gave 3 numbers"),
        (lambda t, y: (y[1], math.nan), "nan.*finite rates"),
        (lambda t, y: (y[1], 1 / 0), "finite rates"),
        (lambda t, y: (y[1], -np.sin(y[0])), "stickslip.maths"),
        (lambda t, y: (y[1], math.cos(t)), "stickslip.maths"),
        (lambda t, y: np.array([y[1], -y[0]], float), "stickslip.maths"),
        (lambda t, y: (y[1], y[0] > 0), "gave a condition"),
        (lambda t, y: ("a", "b"), "gave"),
        (lambda t, y: (y[1], 1j), "gave"),
        (lambda t, y: {}["k"], "raised KeyError"),
        (lambda t, y: (y[2], 0.0), "y has 2"),
        (lambda t, y: (y[0] * y[0], 0.0), "beyond t = 1"),
    ],
)
def test_a_field_that_gives_no_rates_says_so(field, told):
    with pytest.raises(StickslipError, match=rf"(?s){told}"):
        ss.dynamics.passage(ss.SwitchingFlow({0: field}), [1.0, 0.0], 0, 2.0)


@each_row(
    "guard", [lambda t, y: None, lambda t, y: y[0] > 0, lambda t, y: np.sin(y[0]), lambda t, y: math.nan, lambda t, y: y[7], lambda t, y: y]
)
def test_a_guard_that_gives_no_number_says_so(guard):
    with pytest.raises(StickslipError, match=r"switches\[0\]\[0\].guard"):
        ss.dynamics.passage(swinging(guard), [1.0, 0.0], 0, 2.0)


@each_row("reset", [lambda t, y: None, lambda t, y: (0.0,), lambda t, y: (0.0, math.nan), lambda t, y: (0.0, np.exp(y[1]))])
def test_a_reset_that_gives_no_state_says_so(reset):
    with pytest.raises(StickslipError, match=r"switches\[0\]\[0\].reset"):
        ss.dynamics.passage(swinging(lambda t, y: y[0], reset), [1.0, 0.0], 0, 2.0)


def test_arrays_and_branches_of_python_are_understood_in_a_field():
    """A matrix product, `if`, `max` and `==` on numbers with slopes choose as on plain numbers."""
    turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
    done = ss.dynamics.passage(ss.SwitchingFlow({0: lambda t, y: turn @ np.array(y)}), [1.0, 0.0], 0, 2.0)
    assert done.state[0] == pytest.approx(math.cos(2.0), abs=1e-11)
    for field in (lambda t, y: (-1.0 if y[0] > 0.5 else -0.5,), lambda t, y: (-max(y[0], 1.0),), lambda t, y: (-1.0 if t == t else 1.0,)):
        assert ss.dynamics.passage(ss.SwitchingFlow({0: field}), [1.0], 0, 0.25).state[0] == pytest.approx(0.75, abs=1e-12)


def test_modes_that_are_not_known_are_said_with_those_that_are():
    field = {"slip": lambda t, y: (-1.0,)}
    with pytest.raises(ss.InputError, match=r"(?s)2 problems.*'slpi'.*did you mean 'slip'.*switches\[3\]: 3 is not a mode"):
        ss.SwitchingFlow(field, {"slip": (ss.Switch(lambda t, y: y[0], "slpi"),), 3: ()})
    with pytest.raises(ss.InputError, match="mode: 'stick' is not a mode of the flow"):
        ss.dynamics.passage(ss.SwitchingFlow(field), [1.0], "stick", 1.0)
    with pytest.raises(ss.InputError, match=r"\.to gave 'stick' at t = 1"):
        ss.dynamics.passage(ss.SwitchingFlow(field, {"slip": (ss.Switch(lambda t, y: y[0], lambda t, y: "stick"),)}), [1.0], "slip", 2.0)
    with pytest.raises(ss.InputError, match="1 is not a mode of the flow; known: 'slip'"):
        ss.dynamics.lyapunov_of_flow(ss.SwitchingFlow(field), [1.0], mode=1)


def test_everything_wrong_with_a_flow_or_a_passage_is_said_at_once():
    with pytest.raises(ss.InputError, match=r"(?s)fields\[0\] = 3.*switches\[0\].*type \(switch,\).*period = -1"):
        ss.SwitchingFlow({0: 3}, {0: ss.Switch(lambda t, y: y[0], 0)}, -1)
    with pytest.raises(ss.InputError, match=r"(?s)guard = None.*reset = 2"):
        ss.Switch(None, 0, 2)
    with pytest.raises(ss.InputError, match=r"(?s)state = \['a'\].*mode: 5.*duration = inf.*begin = None.*rtol = 0.*switches = 0"):
        ss.dynamics.passage(ball(), ["a"], 5, math.inf, begin=None, rtol=0, switches=0)
    for duration in (0, -1.0, math.nan, "1"):
        with pytest.raises(ss.InputError, match="duration"):
            ss.dynamics.passage(ball(), [1.0, 0.0], 0, duration)
    with pytest.raises(ss.InputError, match="is not a flow"):
        ss.dynamics.passage(lambda t, y: y, [1.0], 0, 1.0)
    with pytest.raises(ss.InputError, match=r"(?s)settle = -1.*leave periods out"):
        ss.dynamics.flow_orbit(van_der_pol(), [1.0, 0.0], 0, duration=6.0, periods=2, settle=-1)


def test_a_field_whose_square_root_ends_says_where():
    with pytest.raises(ss.SolveError, match=r"beyond t = 2"):
        ss.dynamics.passage(ss.SwitchingFlow({0: lambda t, y: (-sqrt(y[0]),)}), [1.0], 0, 3.0)


@each_row("f", [lambda x: None, lambda x: (x[0],), lambda x: (np.sin(x[0]), x[1]), lambda x: (x[5], 0.0)])
def test_maps_and_flows_that_give_no_numbers_say_so(f):
    for act in (ss.dynamics.lyapunov_of_map, ss.dynamics.lyapunov_of_flow):
        with pytest.raises(ss.InputError, match="f "):
            act(f, [0.1, 0.2])


@each_row("given", [dict(duration=math.inf), dict(duration="a"), dict(every=math.nan), dict(settle=math.nan), dict(rtol=0)])
def test_bad_numbers_of_an_exponent_are_said(given):
    with pytest.raises(ss.InputError, match=next(iter(given))):
        ss.dynamics.lyapunov_of_flow(lambda x: (-x[0],), [0.1], **given)


# derivatives by the start ---------------------------------------------------------------------------------------------


def test_directions_whose_steps_differ_make_one_derivative():
    """A stiff field: every direction of the start is followed in steps of its own. Before, that ended in an error of NumPy."""
    field = lambda t, y: (y[1], -y[0] - 2.0 / math.pi * atan(1e3 * (y[1] - 0.2)))  # noqa: E731
    watch = {0: (ss.Switch(lambda t, y: y[1], 1),), 1: (ss.Switch(lambda t, y: -y[1], 0),)}
    flow = ss.SwitchingFlow({0: field, 1: field}, watch, states=("q", "u"))
    exact, judge = (ss.dynamics.passage(flow, [1.0, -0.5], 0, 3.0, **more) for more in ({}, {"method": "dop853", "rtol": 1e-10}))
    assert [after for _, _, after in exact.events] == [after for _, _, after in judge.events] and exact.events
    assert np.allclose(exact.monodromy, judge.monodromy, atol=1e-6)
