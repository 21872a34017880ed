"""Maps and flows with known answers: exponents, Den Hartog's oscillator, a block on a belt, impacts, a bouncing ball."""

from __future__ import annotations

import math

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.forward_ad import variables
from stickslip.dynamics.stroboscopic.strobe_maps import flow_map
from stickslip.maths import cos, exp, sin, sqrt, tanh, where

# exponents of maps and smooth flows --------------------------------------------------------------------------------


def henon(x):
    return 1 - 1.4 * x[0] * x[0] + x[1], 0.3 * x[0]


def test_henon_has_its_published_exponents():
    """0.4192 and -1.6232 (Sprott 2003, table A.2.1); 20 000 iterations leave an error of about 0.003."""
    found = ss.dynamics.lyapunov_of_map(henon, [0.1, 0.1], iterations=20_000)
    assert found.error < 0.01
    assert abs(found.largest - 0.41922) < 3 * found.error
    assert found.spectrum.sum() == pytest.approx(math.log(0.3), abs=1e-12), "the area shrinks by 0.3 everywhere"
    assert found.chaotic and 1.2 < found.dimension < 1.3 and found.method == "compiled"
    flow = ss.lyapunov(ss.SwitchingFlow.of_map(lambda y, n: henon(y), {"k": 1.0}, ("x", "y")), periods=400, settle=0)
    assert flow.spectrum.sum() == pytest.approx(math.log(0.3), abs=1e-12), "its clock jumped twice in some periods, with a sum of -3"


def tent(x):
    return (1.9 * x[0],) if x[0] < 0.5 else (1.9 * (1.0 - x[0]),)


def standard(x):
    return x[0] + 0.9 * sin(x[1]), x[1] + x[0] + 0.9 * sin(x[1])


def test_compiled_maps_are_those_of_plain_python_to_rounding():
    """Orbits while rounding has not grown, choices by `if` too; exponents of what no symbol can pass by plain Python, which says so."""
    for f, x, grows in ((henon, [0.1, 0.1], 1.6), (tent, [0.3], 1.9), (standard, [0.3, 0.5], 2.0)):
        flow, plain = ss.SwitchingFlow.of_map(f, states=("x", "y")[: len(x)]), np.array(x)
        for k in range(1, 13):
            plain = np.array(f(plain))
            state = flow_map(flow, [[*x, 0.0]], float(k)).state[0]
            np.testing.assert_allclose(state[:-1], plain, rtol=0.0, atol=4e-16 * grows**k)
    assert ss.dynamics.lyapunov_of_map(tent, [0.3], iterations=50).largest == pytest.approx(math.log(1.9), abs=1e-14)
    found = ss.dynamics.lyapunov_of_map(lambda x: (tent(x)[0] if isinstance(x[0], float) else 1.9 * x[0],), [0.3], iterations=50)
    assert found.largest == pytest.approx(math.log(1.9), abs=1e-14) and found.method.startswith("plain Python: ")
    short = dict(iterations=15, settle=0)  # rounding grows by 1.5 in each
    own = ss.dynamics.lyapunov_of_map(henon, [0.1, 0.1], **short)
    given = ss.dynamics.lyapunov_of_map(henon, [0.1, 0.1], jacobian=lambda x: [[-2.8 * x[0], 1.0], [0.3, 0.0]], **short)
    np.testing.assert_allclose(own.spectrum, given.spectrum, rtol=1e-12)
    assert own.method == "compiled" and "is given" in given.method
    lost = ss.dynamics.lyapunov_of_map(lambda x: (0.5 * x[0] + x[1], 0.0), [1.0, 0.0], iterations=20)
    assert lost.spectrum.tolist() == [pytest.approx(math.log(0.5), abs=1e-2), -math.inf]


def test_logistic_map_at_four_has_ln_2():
    found = ss.dynamics.lyapunov_of_map(lambda x: (4 * x[0] * (1 - x[0]),), [0.3], iterations=20_000)
    assert abs(found.largest - math.log(2)) < 3 * found.error + 1e-6 and found.error < 0.01


def test_a_rotation_has_exponent_zero():
    turn = lambda x: (0.6 * x[0] - 0.8 * x[1], 0.8 * x[0] + 0.6 * x[1])  # noqa: E731
    found = ss.dynamics.lyapunov_of_map(turn, [1.0, 0.0], iterations=200)
    np.testing.assert_allclose(found.spectrum, 0.0, atol=1e-14)
    assert not found.chaotic


def test_linear_flow_has_the_real_parts_of_its_eigenvalues():
    """Compiled, and by SciPy, which follows a function that no symbol can pass."""
    A = np.array([[-0.5, 2.0, 0.0], [-2.0, -0.5, 0.3], [0.0, 0.0, 0.1]])
    found = ss.dynamics.lyapunov_of_flow(
        lambda x: [sum(a * v for a, v in zip(row, x, strict=True)) for row in A], [1e-6, 0, 1e-6], duration=300.0
    )
    np.testing.assert_allclose(found.spectrum, [0.1, -0.5, -0.5], atol=0.01)  # rotation within a plane averages out as 1/time
    plain = ss.dynamics.lyapunov_of_flow(lambda x: A @ x, [1e-6, 0, 1e-6], jacobian=lambda x: A, duration=30.0, settle=5.0)
    same = ss.dynamics.lyapunov_of_flow(lambda x: list(A @ x), [1e-6, 0, 1e-6], duration=30.0, settle=5.0)
    np.testing.assert_allclose(plain.spectrum, same.spectrum, atol=1e-7)
    assert found.method == same.method == "compiled" and plain.method == "SciPy's DOP853 on plain Python: its Jacobian matrix is given"


@pytest.mark.slow
def test_lorenz_has_its_published_exponents():
    """0.9056, 0, -14.5723 (Sprott 2003, table A.5.1); the trace is -41/3."""
    lorenz = lambda x: (10 * (x[1] - x[0]), x[0] * (28 - x[2]) - x[1], x[0] * x[1] - 8 / 3 * x[2])  # noqa: E731
    found = ss.dynamics.lyapunov_of_flow(lorenz, [1.0, 1.0, 1.0], duration=600.0)
    assert abs(found.largest - 0.9056) < 4 * found.error and found.error < 0.02
    assert abs(found.spectrum[1]) < 0.01
    assert found.spectrum.sum() == pytest.approx(-41 / 3, abs=1e-6)


def test_slopes_of_every_function_a_law_may_call():
    """Against central differences; 1e-9 is the error of those, step 1e-5 and rounding 1e-11."""
    f = lambda x, y: exp(x * y) + sin(x) / sqrt(y) - tanh(x) ** 3 + cos(y) * abs(x - y) + where(x > y, x * x, 1 / y)  # noqa: E731
    for x, y in ((0.3, 0.7), (1.3, 0.4)):
        found = f(*variables(np.array(x), np.array(y)))
        h = 1e-5
        assert float(found.value) == pytest.approx(f(x, y), rel=1e-15)
        assert float(found.slope(0)) == pytest.approx((f(x + h, y) - f(x - h, y)) / (2 * h), abs=1e-9)
        assert float(found.slope(1)) == pytest.approx((f(x, y + h) - f(x, y - h)) / (2 * h), abs=1e-9)


# Den Hartog's oscillator -------------------------------------------------------------------------------------------

R, P = 0.7, 1.0  # frequency over the natural one, and force amplitude; mass and spring are 1


def den_hartog(F):
    """x'' + x + F sgn x' = cos(R t), with rest."""
    offered = lambda t, y: -y[0] + P * cos(R * t)  # noqa: E731
    slide = lambda side: lambda t, y: (y[1], offered(t, y) - side * F)  # noqa: E731
    after = lambda t, y: 1 if offered(t, y) > F else -1 if offered(t, y) < -F else 0  # noqa: E731
    stop = lambda t, y: (y[0], 0.0)  # noqa: E731
    switches = {
        1: (ss.Switch(lambda t, y: y[1], after, stop),),
        -1: (ss.Switch(lambda t, y: -y[1], after, stop),),
        0: (ss.Switch(lambda t, y: F - offered(t, y), 1), ss.Switch(lambda t, y: F + offered(t, y), -1)),
    }
    return ss.SwitchingFlow({1: slide(1), -1: slide(-1), 0: lambda t, y: (0.0 * y[0], 0.0)}, switches, 2 * math.pi / R)


def differenced(flow, orbit, h=1e-5):
    """The monodromy matrix by central differences of the flow."""
    go = lambda y: ss.dynamics.passage(flow, y, orbit.mode, orbit.duration).state  # noqa: E731
    return np.array([(go(orbit.state + h * e) - go(orbit.state - h * e)) / (2 * h) for e in np.eye(len(orbit.state))]).T


@pytest.fixture(scope="module")
def non_stop():
    return ss.dynamics.flow_orbit(den_hartog(0.3), [1.0, 0.5], 1, settle=10)


def test_den_hartogs_amplitude(non_stop):
    """O1, Den Hartog 1930: X = sqrt(V^2 - F^2 U^2)."""
    V, U = 1 / (1 - R**2), math.tan(math.pi / (2 * R)) / R
    X = math.sqrt(V**2 - 0.3**2 * U**2)
    assert pytest.approx(1.88569985041425, rel=1e-12) == X
    turn = ss.dynamics.passage(den_hartog(0.3), non_stop.state, non_stop.mode, non_stop.duration, switches=1)
    assert abs(turn.state[0]) == pytest.approx(X, abs=1e-10)


def test_den_hartogs_multipliers_have_the_product_of_their_saltation(non_stop):
    """Between reversals the flow keeps areas; a reversal shrinks them by (q - F)/(q + F), where q = X R^2 is what turns the mass."""
    X = 1.88569985041425
    expected = ((X * R**2 - 0.3) / (X * R**2 + 0.3)) ** 2
    assert float(np.prod(non_stop.multipliers).real) == pytest.approx(expected, abs=1e-10)
    # differences with step 1e-5 are good to 1e-8
    np.testing.assert_allclose(non_stop.passage.monodromy, differenced(den_hartog(0.3), non_stop), atol=1e-6)


def test_rest_appears_where_den_hartog_says():
    """An adding-sliding border: the turning force X R^2 falls to F, at F = V / sqrt(1/R^4 + U^2)."""
    V, U = 1 / (1 - R**2), math.tan(math.pi / (2 * R)) / R
    border = V / math.sqrt(1 / R**4 + U**2)
    before, after = (ss.dynamics.flow_orbit(den_hartog(border + side * 1e-4), [0.9, 0.8], 1, settle=8) for side in (-1, 1))
    assert 0 not in before.pattern and 0 in after.pattern
    assert abs(after.multipliers).min() == 0.0, "rest forgets a direction"


# a block on a belt -------------------------------------------------------------------------------------------------


def belt(v_belt, kinetic):
    """Unit mass on a spring of 2 on a belt, static friction 1.5; `kinetic` gives the friction at a slip speed."""
    slip = lambda t, y: (y[1], -2 * y[0] + kinetic(v_belt - y[1]))  # noqa: E731
    ride = lambda t, y: (v_belt + 0.0 * y[0], 0.0)  # noqa: E731
    caught = ss.Switch(lambda t, y: v_belt - y[1], 0, lambda t, y: (y[0], v_belt))
    return ss.SwitchingFlow({0: ride, 1: slip}, {0: (ss.Switch(lambda t, y: 1.5 - 2 * y[0], 1),), 1: (caught,)})


def test_belt_cycle_has_its_closed_period():
    """O3: t_slip = (2/w)(pi - atan(D w / v)), t_stick = 2 D / v, D = (Fs - Fk)/k."""
    v, w, D = 0.1, math.sqrt(2), 0.25
    expected = 2 / w * (math.pi - math.atan(D * w / v)) + 2 * D / v
    assert pytest.approx(7.6112592541013, abs=1e-12) == expected
    orbit = ss.dynamics.flow_orbit(belt(v, lambda s: 1.0 + 0.0 * s), [0.6, v], 0, duration=7.5)
    assert orbit.duration == pytest.approx(expected, abs=1e-10)
    assert np.all(orbit.multipliers == 0.0), "riding the belt forgets everything but the place on it"


@each_row("guess", [4.0, 4.7, 6.0])
def test_a_cycle_that_makes_the_same_switches_twice_is_found_whole(guess):
    """A turn of a circle, at speed 2 where y (2 x + 0.9) > 0 and 1 elsewhere; each is half of it, in two pieces: pi/2 + pi."""
    inward = lambda y: 1 - y[0] ** 2 - y[1] ** 2  # noqa: E731
    turn = lambda speed: lambda t, y: (y[0] * inward(y) - speed * y[1], y[1] * inward(y) + speed * y[0])  # noqa: E731
    side = lambda sign: lambda t, y: sign * y[1] * (2 * y[0] + 0.9)  # noqa: E731
    switches = {2: (ss.Switch(side(1), 1),), 1: (ss.Switch(side(-1), 2),)}
    orbit = ss.dynamics.flow_orbit(ss.SwitchingFlow({2: turn(2.0), 1: turn(1.0)}, switches), [0.9, 0.1], 2, duration=guess)
    assert orbit.duration == pytest.approx(1.5 * math.pi, abs=1e-11) and len(orbit.events) == 4


def test_weakening_friction_on_a_belt_has_one_stick_slip_cycle():
    """From inside and from outside: one cycle, whatever the start."""
    flow = belt(0.1, lambda s: 1.0 + 0.5 * exp(-s / 0.2))
    found = [ss.dynamics.flow_orbit(flow, [x, v], mode, duration=4.0) for x, v, mode in ((0.5, 0.1, 0), (0.7, 0.1, 0))]
    assert found[0].duration == pytest.approx(found[1].duration, abs=1e-9)
    cycle = ss.dynamics.passage(flow, [0.52, 0.05], 1, 200.0)  # slipping, beside the unstable equilibrium
    slips = [t for t, before, _ in cycle.events if before == 0]
    assert slips[-1] - slips[-2] == pytest.approx(found[0].duration, abs=1e-9)


# impacts -----------------------------------------------------------------------------------------------------------


def impact(restitution, wall=0.0, w=2.8):
    swing = lambda t, y: (y[1], -y[0] + cos(w * t))  # noqa: E731
    hit = ss.Switch(lambda t, y: y[0] - wall, 0, lambda t, y: (wall + 0.0 * y[0], -restitution * y[1]))
    return ss.SwitchingFlow({0: swing}, {0: (hit,)}, 2 * math.pi / w)


def test_impact_orbit_shrinks_areas_by_the_square_of_its_restitution():
    flow = impact(0.8)
    orbit = ss.dynamics.flow_orbit(flow, [0.2, 0.3], 0, periods=1, settle=60)
    assert len(orbit.passage.events) == 1
    assert float(np.prod(orbit.multipliers).real) == pytest.approx(0.64, abs=1e-10)
    np.testing.assert_allclose(orbit.passage.monodromy, differenced(flow, orbit), atol=1e-6)


def test_grazing_begins_where_the_free_swing_reaches_the_wall():
    """Without impact x = cos(w t)/(1 - w^2) reaches down to -1/(w^2 - 1), at t = 0."""
    w, reach = 2.8, 1 / (2.8**2 - 1)
    t = math.pi / 2 / w
    start = [0.0, -w / (1 - w**2)]
    hits = [
        len(ss.dynamics.passage(impact(0.8, wall), start, 0, 2 * math.pi / w, begin=t).events) for wall in (-reach - 1e-6, -reach + 1e-6)
    ]
    assert hits[0] == 0 and hits[1] > 0


def test_exponents_of_a_switching_flow_are_those_of_its_multipliers(non_stop):
    found = ss.dynamics.lyapunov_of_flow(den_hartog(0.3), non_stop.state, duration=60 * non_stop.duration, settle=0.0, mode=non_stop.mode)
    assert found.spectrum.sum() * non_stop.duration == pytest.approx(float(np.log(abs(non_stop.multipliers)).sum()), abs=1e-8)


# errors ------------------------------------------------------------------------------------------------------------


def test_bad_starts_are_said():
    with pytest.raises(ss.InputError, match="x0"):
        ss.dynamics.lyapunov_of_map(henon, ["a", 1])
    with pytest.raises(ss.InputError, match="duration"):
        ss.dynamics.flow_orbit(belt(0.1, lambda s: 1.0), [0.6, 0.1], 0)


@each_row("settle", [0.0, 5.0])
def test_a_flow_that_leaves_all_bounds_has_no_exponents(settle):
    """x' = x^2 from 1 is 1/(1 - t)."""
    with pytest.raises(ss.InputError, match=r"diverges at t = 1 from x0 = \[1.0\].* [Gg]ive a start"):
        ss.dynamics.lyapunov_of_flow(lambda x: (x[0] ** 2,), [1.0], duration=5.0, settle=settle)
