"""Which records of a motion are taken for a drive, each at the border of what is allowed, and how many harmonics are kept of them."""

from __future__ import annotations

import numpy as np
import pytest

import stickslip as ss
from rows import each_row

PERIOD = 0.02
OMEGA = 2 * np.pi / PERIOD


def taken(t, velocity, **more):
    return ss.drives.Recorded.from_samples(t, velocity=velocity, period=PERIOD, **more)


def even(count, per_period=100):
    """Instants, so many in a period."""
    return np.arange(count) * (PERIOD / per_period)


def ramp(step_back, count=100):
    """Up by equal steps of 1 and down again, mean zero; the way back to the first value is `step_back` steps long. The end is left out."""
    up = np.arange(count // 2, dtype=float)
    down = np.linspace(up[-1] - 1, step_back, count - len(up))
    values = np.concatenate([up, down])
    assert np.max(abs(np.diff(values))) <= 1.0
    return values - values.mean()


def test_a_step_that_closes_the_period_may_be_three_times_the_largest_other():
    t = even(100, 100)
    assert taken(t, ramp(2.9)).order >= 1
    assert 0.1 * ramp(3.1).std() < 2.9  # less than a tenth of the r.m.s. would be no jump
    with pytest.raises(ss.InputError, match="does not repeat"):
        taken(t, ramp(3.1))


def test_the_sample_a_period_after_the_first_is_no_sample_of_this_period():
    """The last one before it is 3.5 steps from the first, and it lies on the way, 2.5 steps from it: rejected all the same."""
    values = ramp(3.5)
    with pytest.raises(ss.InputError, match="does not repeat"):
        taken(even(101, 100), np.append(values, values[0] + 2.5))


def test_the_way_back_is_that_to_the_first_sample():
    """The second sample lies one step up: seen from there, 3.5 steps would be 2.5."""
    assert abs(ramp(3.5)[1] - ramp(3.5)[-1]) == pytest.approx(2.5)
    with pytest.raises(ss.InputError, match="does not repeat"):
        taken(even(100, 100), ramp(3.5))


@each_row(("more", "compared"), [(2, False), (3, True), (5, True)])
def test_three_samples_of_a_second_period_are_compared_with_the_first(more, compared):
    """They are 0.3 off, 0.42 of the r.m.s. of a cosine; two are not enough to say so."""
    t = even(100 + more)
    velocity = np.cos(OMEGA * t) + np.where(t > 0.9999 * PERIOD, 0.3, 0.0) - 0.003 * more
    if compared:
        with pytest.raises(ss.InputError, match=r"differs from itself by 4[0-9.]+ per cent"):
            taken(t, velocity)
    else:
        assert taken(t, velocity).order >= 1


@each_row("count", [200, 201, 202])
def test_a_second_period_that_is_higher_is_seen_with_and_without_its_end(count):
    """With the sample at its end it is that one alone that lies two periods after the first."""
    t = even(count)
    velocity = np.cos(OMEGA * t) * np.where((t < 0.9999 * PERIOD) | (t > 1.9999 * PERIOD), 1.0, 1.6)
    with pytest.raises(ss.InputError, match="differs from itself"):
        taken(t, velocity)


@each_row(("missing", "good"), [(1, True), (2, False)])
def test_a_record_of_one_period_may_lack_less_than_half_a_step(missing, good):
    """Instants that begin anywhere: `missing` of a hundred samples, the first not being at zero; half a step is added for the last."""
    t = 0.3 + even(101 - missing)
    values = np.cos(OMEGA * t)
    if good:
        assert taken(t, values).order == 1
    else:
        with pytest.raises(ss.InputError, match=r"lasts 0.0198 s and its period is 0.02 s"):
            taken(t, values)


@each_row(("part", "good"), [(0.49, True), (0.51, False)])
def test_a_period_may_be_half_a_step_longer_than_the_record(part, good):
    step = PERIOD / (100 + part)
    t = np.arange(100) * step
    if good:
        assert taken(t, np.cos(OMEGA * t)).order == 1
    else:
        with pytest.raises(ss.InputError, match="allowed is at least one period"):
            taken(t, np.cos(OMEGA * t))


@each_row(("per_period", "most"), [(3, 1), (5, 2), (9, 4), (10, 4), (11, 5)])
def test_samples_in_a_period_bear_half_as_many_harmonics(per_period, most):
    t = even(6 * per_period, per_period)
    assert taken(t, np.cos(OMEGA * t)).order == 1
    assert taken(t, np.cos(OMEGA * t), order=most).order == most
    with pytest.raises(ss.InputError, match=f"order up to {most}"):
        taken(t, np.cos(OMEGA * t), order=most + 1)


@each_row("per_period", [20, 50])
def test_the_mean_is_that_of_a_period_whatever_part_of_the_next_was_recorded(per_period):
    """Over one and a half periods the sum of 1 + cos is not zero; with harmonics up to the fifth, none of them is taken for a mean."""
    t = even(3 * per_period // 2, per_period)
    velocity = sum(np.cos(k * OMEGA * t + 0.4 * k) / k for k in range(1, 6))
    assert abs(velocity.mean()) > 0.02 * velocity.std()
    assert taken(t, velocity).order == 5


@each_row(("tolerance", "order"), [(0.21, 1), (0.19, 2), (0.011, 2), (0.009, 3)])
def test_harmonics_are_kept_until_what_is_left_out_is_below_the_tolerance(tolerance, order):
    """1, 0.2 and 0.01 of the r.m.s. (to the second order)."""
    t = even(400)
    parts = [A * np.cos(k * OMEGA * t) for k, A in ((1, 1.0), (2, 0.2041), (3, 0.0102))]
    assert [float((p.std() / sum(parts).std()).round(3)) for p in parts] == [0.98, 0.2, 0.01]
    assert taken(t, sum(parts), tolerance=tolerance).order == order


def test_a_record_that_is_followed_well_is_not_said_to_have_noise():
    t = even(400)
    velocity = np.cos(OMEGA * t) + 0.2 * np.cos(2 * OMEGA * t)
    for order in (2, 5):
        assert "noise" not in taken(t, velocity, order=order).notes[0]
    assert "noise or corners that 1 harmonics do not follow" in taken(t, velocity, order=1).notes[0]
    assert "noise" not in taken(t, velocity, tolerance=0.3).notes[0]
