"""Whether strobe points repeat: maps whose periods are known, and the robots beside their flips."""

from itertools import product

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.dynamics.attractors.period_numbers import periods_of
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, strobe_orbit
from stickslip.engine.texts import recurrence as compiled
from stickslip.results import recurrence

RIG = dict(tilt_deg=1.7, mu0=0.04)
#: Where period two begins and ends along the amplitude at mu0 = 0.04, by continuation of the orbit of period two [m].
DOUBLED = (5.525802e-4, 8.441508e-4)
TOLERANCE = 3e-5


def points_of(step, start, count):
    """x and the state of a map, one row for each period; x is the sum of the first coordinate."""
    rows, state = [], np.atleast_1d(np.asarray(start, float))
    for _ in range(count):
        rows.append(state)
        state = np.atleast_1d(step(state))
    states = np.array(rows)
    return np.column_stack([np.cumsum(1 + states[:, 0]), states])


def outcome(points, functions=recurrence, tolerance=TOLERANCE):
    last = len(points) - 1
    scales = recurrence.scales_of(np.ones(points.shape[1] - 1))
    args = (points, last, min(last, recurrence.KEPT - 1), recurrence.LONGEST, scales, tolerance, tolerance)
    return functions.outcome(*args)


def flip(mu):
    """x -> -(1 + mu) x + x^3: the fixed point 0 has the multiplier -(1 + mu); for mu > 0 the period is two, at +-sqrt(mu)."""
    return lambda x: -(1 + mu) * x + x**3


@each_row(("mu", "count", "start"), product([-0.3, -0.03, -3e-3, -3e-4, 3e-4, 3e-3, 0.03, 0.3], [50, 200, 3000], [1e-4, 0.02, 0.3]))
def test_beside_a_flip_the_period_is_right_or_none(mu, count, start):
    """On the side of the fixed point 1, on the other 2, however slowly the map settles, and never a multiple."""
    found, _ = outcome(points_of(flip(mu), start, count))
    assert found in (0, 1 if mu < 0 else 2)
    slowest = abs(1 + mu if mu < 0 else 1 - 2 * mu)  # |multiplier| per period of what the map settles on
    if start * slowest**count < 1e-9 and (mu < 0 or start > 1e-3):
        assert found == (1 if mu < 0 else 2)


def test_a_doubling_of_an_amplitude_of_a_thousandth_is_found():
    points = points_of(flip(1e-6), np.sqrt(1e-6), 200)
    assert outcome(points)[0] == 2


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8])
def test_spirals_onto_a_doubled_motion_have_its_period_and_no_multiple(tolerance):
    """Complex multipliers of any size and angle: the points of both halves spiral in, unevenly."""
    rng, found = np.random.default_rng(0), []
    for size, angle in zip(rng.uniform(0.05, 0.9, 100), rng.uniform(0, np.pi, 100), strict=True):
        turn = size**0.5 * np.exp(0.5j * angle) * rng.uniform(0.1, 1.0) * (size * np.exp(1j * angle)) ** (np.arange(400) // 2)
        side = np.where(np.arange(400) % 2 == 0, 1.0, -1.0)
        points = np.column_stack([np.arange(400.0), side + turn.real, 0.3 * side + turn.imag])
        periods = (outcome(points[: last + 1], tolerance=tolerance)[0] for last in range(8, 400))
        found.append(next((p for p in periods if p), 0))
    assert set(found) <= {0, 2} and found.count(2) > 90


@each_row("q", [3, 4, 5])
def test_slow_spirals_beside_a_resonance_have_no_period_of_it(q):
    """Multipliers r exp(+-2 pi i (1/q + small)): points q apart agree long before the spiral has closed in on its fixed point."""
    angle, r = 2 * np.pi * (1 / q + 1e-4), 0.9995
    turn = r * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    for count in (100, 3000, 12000, 40000):
        assert outcome(points_of(lambda y: turn @ y, [0.3, 0.0], count))[0] in (0, 1)
    assert outcome(points_of(lambda y: turn @ y, [0.3, 0.0], 40000))[0] == 1


def test_rotations_and_chaos_do_not_repeat():
    angle = np.pi * (np.sqrt(5) - 1)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    for points in (points_of(lambda y: turn @ y, [0.3, 0.0], 400), points_of(lambda x: 4 * x * (1 - x), 0.3, 400)):
        period, approached = outcome(points)
        assert period == 0 and np.isnan(approached)


@each_row("ratio", [0.99, 0.97, 0.9, -0.98, -0.9])
def test_what_a_motion_approaches_is_extrapolated(ratio):
    """x grows by 1 + c in a period, c falling by a ratio: it approaches 1, known from points at which c is still up to 0.1."""
    points = points_of(lambda x: ratio * x, 0.1, 60)
    last = abs(0.1 * ratio**59)
    assert abs(outcome(points)[1] - 1) <= 1e-3 * last + 1e-9


def test_a_drift_without_an_end_approaches_nothing():
    period, approached = outcome(points_of(lambda x: x + 1e-6, 0.0, 400))
    assert period == 0 and approached == float("inf")


def test_the_compiled_text_says_what_the_plain_one_says():
    random = np.random.default_rng(0)
    for _ in range(200):
        n, d, ratio = int(random.integers(2, 100)), int(random.integers(1, 4)), random.uniform(-1.02, 1.02)
        y = random.normal(size=(1, d)) * ratio ** np.arange(n)[:, None] + random.choice([0, 1e-9, 1e-6]) * random.normal(size=(n, d))
        points = np.column_stack([np.cumsum(1 + y[:, 0]), y])
        assert outcome(points) == pytest.approx(outcome(points, compiled()), rel=1e-12, nan_ok=True)


# ---- robots ----
@pytest.fixture(scope="module")
def beside_flips():
    """Amplitudes on both sides of the borders of period two, and what 200 periods say, as a batch and by a batch that stops by itself."""
    amplitudes = np.concatenate([np.linspace(5.52e-4, 5.6e-4, 33), np.linspace(8.40e-4, 8.48e-4, 17)])
    robots = ss.presets.piezo_rig(amplitude=amplitudes, **RIG)
    return amplitudes, ss.solve(robots, keep="summary"), ss.solve(robots, settle="auto", keep="summary")


def test_period_numbers_beside_flips_are_right_or_none(beside_flips):
    amplitudes, *batches = beside_flips
    true = np.where(amplitudes < DOUBLED[0], 4, np.where(amplitudes < DOUBLED[1], 2, 1))
    for many in batches:
        assert ((many.period == 0) | (many.period == true)).all()
        assert (many.period > 0).any()


def test_a_single_run_and_its_batch_say_one_period_beside_a_flip(beside_flips):
    amplitudes, many, _ = beside_flips
    for i in (10, 24, 32, 49):
        run = ss.solve(ss.presets.piezo_rig(amplitude=float(amplitudes[i]), **RIG))
        assert (ss.motion(run).period or 0) == many.period[i]


def test_period_one_beside_its_flip_along_the_friction():
    """A = 0.6 mm, mu0 = 0.047: a multiplier near -1, and points two apart agree before points one apart do."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, mu0=0.047)
    for periods in (100, 150, 200, 300):
        assert ss.solve(robot, periods=periods, keep="summary").period in (0, 1)
    assert ss.solve(robot, periods=500, keep="summary").period == 1
    state = [ss.solve(robot, periods=150).strobe_v[-1], float(ss.solve(robot, periods=150).strobe_z[-1])]
    assert periods_of(strobe_orbit(robot, state, 96)[0][:, 0], coordinates(robot).scales) in (0, 1)


@each_row("count", [20, 40, 47, 100])
def test_chaos_approaches_nothing(count):
    """Of the logistic map and of random numbers: of the largest of p distances 24 % fell or grew by chance five times in a row."""
    rng, found = np.random.default_rng(3), []
    for k in range(400):
        x = rng.uniform(0.05, 0.95, count + 1)
        for i in range(count if k % 2 else 0):
            x[i + 1] = 4.0 * x[i] * (1.0 - x[i])
        points, scales = np.column_stack([np.arange(count + 1.0), x]), recurrence.scales_of([1.0])
        found.append(recurrence.approach(points, count, count, recurrence.LONGEST, scales))
    assert np.count_nonzero(found) <= 4


@each_row(("p", "rate"), product([1, 2, 3, 5], [0.97, -0.9, 1.02]))
def test_a_motion_that_closes_in_on_a_cycle_approaches_it(p, rate):
    n = np.arange(48)
    x = np.cos(2.0 * np.pi * n / p + 0.3) + 0.1 * rate ** (n // p)
    found = recurrence.approach(np.column_stack([n * 1.0, x]), 47, 47, recurrence.LONGEST, recurrence.scales_of([1.0]))
    assert found == p
