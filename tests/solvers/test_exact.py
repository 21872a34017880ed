"""Exact stick-slip: the paper's Coulomb numbers, the twin, and the physics that any solver must keep."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import stickslip as ss
from rows import each_row
from stickslip.maths import where
from stickslip.results.segments import type_of
from stickslip.solvers import set_valued as exact
from stickslip.solvers.closed_arcs import dimensionless_arcs, handles
from twins import StickSlip


def rig(tilt_deg, amplitude, **changes):
    return ss.presets.piezo_rig(tilt_deg=tilt_deg, amplitude=amplitude, law="coulomb", **changes)


def raw_of(robot, periods=200, settle=100, **more):
    raw = exact.solve_batch(robot, periods, settle, **more)
    types = type_of(raw["seg_count"], raw["seg_time"], raw["seg_code"], raw["period"], raw["margin_force"], raw["displacement"])
    return {
        **raw,
        **{name: np.asarray(values) for name, values in types.items()},
        "V": raw["displacement"] / (raw["window"] * dimensionless_arcs(robot).period),
    }


# the paper's numbers ----------------------------------------------------------------------------------------------

PAPER = [  # section 3 of TRUTH: robot, type, V, half a unit of the last digit printed
    ("P1", rig(1.7, 0.5525e-3), "I", 0.002014682, 5e-10),
    ("P2", rig(2.7, 0.6032e-3), "III", 0.003827101, 5e-10),
    ("P3", rig(4.7, 0.4564e-3), "II", 0.004000482, 5e-10),
    ("P4", rig(5.7, 1.487e-3), "IV", 0.028688951, 5e-10),
    ("P6 3e-4", rig(1.7, 3e-4), "II", 0.0000788583268, 5e-14),
    ("P6 4e-4", rig(1.7, 4e-4), "I", 0.000900404578483, 5e-16),  # the twin's 40 digits; TRUTH prints ...579, half a unit and 2 % off
    ("P6 5e-4", rig(1.7, 5e-4), "I", 0.001686424, 5e-10),
    ("P6 6e-4", rig(1.7, 6e-4), "III", 0.002358779, 5e-10),
    ("P6 8e-4", rig(1.7, 8e-4), "IV", 0.004308808, 5e-10),
    ("P7 30", rig(1.7, 6e-4, omega=30 * math.pi), "rest", 0.0, 0.0),
    ("P7 46", rig(1.7, 6e-4, omega=46 * math.pi), "II", 9.32985561e-5, 5e-14),
    ("P7 52", rig(1.7, 6e-4, omega=52 * math.pi), "I", 8.833235983e-4, 5e-14),
    ("P7 65", rig(1.7, 6e-4, omega=65 * math.pi), "III", 2.311296e-3, 5e-10),
    ("P7 80", rig(1.7, 6e-4, omega=80 * math.pi), "IV", 4.209963e-3, 5e-10),
]


@each_row(("robot", "type_", "velocity", "half"), [row[1:] for row in PAPER], ids=[row[0] for row in PAPER])
def test_the_papers_coulomb_column(robot, type_, velocity, half):
    raw = raw_of(robot)
    assert raw["V"][0] == pytest.approx(velocity, abs=half * 1.001, rel=0)
    assert (raw["motion_type"][0], raw["period"][0], raw["status"][0]) == (type_, 1, 0)


@each_row(("robot", "type_"), [row[1:3] for row in PAPER], ids=[row[0] for row in PAPER])
def test_a_long_run_settles_on_the_closed_form(robot, type_):
    from stickslip.analysis.closed_form import mean_without_rest, periodic

    arcs = dimensionless_arcs(robot)
    alphas = float(arcs.resist_plus[0] / arcs.drive[0]), float(arcs.resist_minus[0] / arcs.drive[0])
    unit = float(arcs.drive[0] / arcs.omega[0])
    p = periodic(*alphas)
    expected = mean_without_rest(*alphas) if type_ == "IV" else p.mean
    # ten roundings of times near 2 pi in units of A mu omega, or 1e-12 of V
    assert raw_of(robot)["V"][0] == pytest.approx(float(expected) * unit, rel=1e-12, abs=2e-15 * unit)
    assert str(p.type) == type_


@each_row("tilt_deg, amplitude", [(1.7, 0.5525e-3), (2.7, 0.6032e-3), (4.7, 0.4564e-3), (5.7, 1.487e-3)])
def test_an_incline_folded_into_coulomb_friction_is_the_true_incline(tilt_deg, amplitude):
    folded, true = (raw_of(rig(tilt_deg, amplitude, incline=kind)) for kind in ("folded", "gravity"))
    assert true["V"] == pytest.approx(folded["V"], rel=1e-12)
    assert true["seg_time"] == pytest.approx(folded["seg_time"], abs=1e-12)


# the twin ---------------------------------------------------------------------------------------------------------


def random_rows(count, seed):
    """Dimensionless cases of every kind: weak friction, nearly resting, sliding down by themselves, static friction, any start."""
    rng = np.random.default_rng(seed)
    rows = np.zeros((count, 6))
    for i, row in enumerate(rows):
        r = rng.uniform(0, [1.3, 0.3][i % 2], 2)
        if i % 5 == 0:
            r[0] = 1 - 10 ** rng.uniform(-8, -1)
        shift = rng.uniform(-1.5, 1.5) if i % 3 == 0 else 0.0
        s = r * rng.uniform(1, 1.6, 2) if i % 4 == 0 else r
        start = (0.0, 2 * rng.normal(), 30 * rng.normal(), 1e-6 * rng.normal())[i % 7 % 4]
        row[:] = r[0] - shift, r[1] + shift, s[0] - shift, s[1] + shift, shift, start
    return rows


def test_the_kernel_is_its_slow_twin():
    rows, periods = random_rows(42, seed=3), 4
    raw = exact.solve_rows(rows, periods, 0, skip=False)
    for i, row in enumerate(rows):
        strobes = StickSlip(*row[:4], w=row[5]).run(periods).strobes
        x, w = (float(value) for value in strobes[-1])
        # positions and speeds are sums of terms of this size, each rounded a few times a period
        scale = 1 + abs(row[5]) + max(abs(float(s[1])) for s in strobes) + max(abs(row[:2])) * 2 * math.pi
        assert raw["v_end"][i] == pytest.approx(w, abs=1e-14 * scale), row
        assert raw["x_end"][i] == pytest.approx(x, abs=1e-14 * scale * 2 * math.pi * periods), row


def test_the_shortest_slips_keep_their_digits():
    """Just below the border of rest a slip moves by 4.5 (1 - alpha^2)^2: relative, not absolute digits count."""
    for gap in (1e-3, 1e-6, 1e-9, 1e-12):
        row = np.array([[1 - gap, 2.0, 1 - gap, 2.0, 0.0, 0.0]])
        moved = exact.solve_rows(row, 1, 0)["displacement"][0]
        true = StickSlip(*row[0, :4]).run(1).strobes[-1][0]
        assert moved == pytest.approx(float(true), rel=1e-12)  # arcsin and root of 1 - alpha, each rounded once, to the fourth power


def test_static_friction_known_value():  # T11
    raw = exact.solve_rows(np.array([[0.5, 1.2, 0.8, 1.4, 0.0, 0.0]]), 20, 10)
    assert raw["displacement"][0] / (10 * 2 * math.pi) == pytest.approx(0.170822286993, abs=1e-12)


# traps ------------------------------------------------------------------------------------------------------------


@each_row("offset", [-3e-16, 0.0, 3e-16, -1e-13, 1e-13])
def test_a_body_that_grazes_zero_neither_chatters_nor_jumps(offset):
    """w comes down to 0 (or to a little above or below) just where it would start again, sin(tau) = r."""
    r = 0.3
    start = r * (2 * math.pi + math.asin(r)) + math.sqrt(1 - r * r) - 1 + offset  # w(2 pi + asin r) = offset
    raw = exact.solve_rows(np.array([[r, 0.5, r, 0.5, 0.0, start]]), 2, 0)
    twin = StickSlip(r, 0.5, r, 0.5, w=start).run(2)
    # where it rests for a moment sqrt(2e-13)/sqrt(cos) long, nothing moves: the motion is continuous in the offset
    assert raw["x_end"][0] == pytest.approx(float(twin.strobes[-1][0]), abs=1e-13)
    assert raw["seg_count"][0] <= 6


def test_frictionless_motion_touches_zero_in_every_period():
    raw = exact.solve_rows(np.zeros((1, 6)), 1000, 0, skip=False)  # w = 1 - cos(tau)
    assert raw["displacement"][0] == pytest.approx(2000 * math.pi, rel=1e-14)
    assert (raw["v_max"][0], raw["v_min"][0]) == pytest.approx((2, 0), abs=1e-15)


def test_on_the_very_border_of_rest_it_rests():
    rows = np.array([[1.0, 1.0, 1.0, 1.0, 0.0, 0.0], [1.0, 1.0, 1.0, 1.0, 0.0, 0.5]])
    raw = exact.solve_rows(rows, 10, 5)
    assert raw["displacement"].tolist() == [0, 0]
    assert raw["seg_code"][:, 0].tolist() == [0, 0]
    assert raw["margin_force"].tolist() == [0, 0]  # on a border


def test_a_hundred_thousand_periods_lose_nothing():
    rows = np.array([[0.4, 0.5, 0.4, 0.5, 0.0, 0.0], [0.7, 0.9, 0.7, 0.9, 0.0, 0.0], [0.4, 0.8, 0.4, 0.8, 0.0, 0.0]])
    raw = exact.solve_rows(rows, 100_000, 99_000, skip=False)
    mean = raw["displacement"] / (raw["window"] * 2 * math.pi)
    assert mean == pytest.approx([0.122475359974498, 0.0615227380297986, 0.269172787549942], abs=2e-15)


@settings(max_examples=60, deadline=None)
@given(st.floats(0, 1.2), st.floats(0, 1.2), st.floats(1, 1.5), st.floats(1, 1.5), st.floats(-3, 3))
def test_there_are_never_more_than_seven_arcs_in_a_period(plus, minus, up, down, start):
    row = np.array([plus, minus, up * plus, down * minus, 0.0, start])
    (number, _, mode), _ = exact._recorded(row, 12)
    assert np.bincount(number).max() <= 7
    assert set(mode) <= {-1, 0, 1}


@settings(max_examples=60, deadline=None)
@given(st.floats(0, 1.2), st.floats(0, 1.2), st.floats(-3, 3), st.floats(-3, 3))
def test_dry_friction_never_drives_two_motions_apart(plus, minus, first, second):
    """Friction that does not fall with speed is monotone: (w1 - w2)^2 cannot grow."""
    rows = np.array([[plus, minus, plus, minus, 0.0, w] for w in (first, second)])
    gap = abs(first - second)
    for periods in (1, 2, 3, 6):
        ends = exact.solve_rows(rows, periods, 0)["v_end"]
        assert abs(ends[0] - ends[1]) <= gap + 1e-13
        gap = abs(ends[0] - ends[1])


def test_skipping_repeated_periods_and_threads_change_nothing():
    rows = random_rows(60, seed=8)
    one, two, skipped = (exact.solve_rows(rows, 300, 37, workers=w, skip=s) for w, s in ((1, False), (2, False), (1, True)))
    for name, values in one.items():
        assert np.array_equal(values, two[name], equal_nan=True), name
    scale = 1 + abs(one["x_end"])  # a motion may dither in its last bit for ever, and be frozen at one of the two
    assert np.max(abs(one["displacement"] - skipped["displacement"]) / scale) < 1e-14 * 300
    assert (one["period"] == skipped["period"]).all()


def test_auto_stops_at_the_repeated_point():
    rows = random_rows(60, seed=9)
    rows = rows[rows[:, 4] == 0]
    auto, full = exact.solve_rows(rows, 100_000, "auto"), exact.solve_rows(rows, 20_000, 19_999)
    assert (auto["status"] == 1).all() and (auto["period"] == 1).all()
    assert np.median(auto["periods_run"]) < 20
    # the estimate that stops it is 1e-14; the weakest friction here contracts by a few per cent a period
    assert auto["displacement"] / auto["window"] == pytest.approx(full["displacement"], abs=1e-11)


# physics ----------------------------------------------------------------------------------------------------------


def powers(robot, periods=60):
    """Work per period of drive, gravity and friction, the change of kinetic energy, and the mean friction force, from the arcs."""
    arcs, _ = exact.solve_one(robot, periods)
    T, mass, law, load = robot.period, robot.total_mass, robot.friction, robot.load(0.0, 0.0)
    last = np.flatnonzero(arcs.t[:-1] >= (periods - 1) * T * (1 - 1e-12))
    node, weight = np.polynomial.legendre.leggauss(40)
    work, x_end, force, along = (
        0.0,
        np.append(arcs.x0, arcs.evaluate(arcs.t[-1:], np.array([len(arcs.mode) - 1]))[0][:, 0]),
        0.0,
        robot.track.along(robot.gravity),
    )
    lost = 0.0
    for i in last:
        half = 0.5 * (arcs.t[i + 1] - arcs.t[i])
        t = arcs.t[i] + half * (node + 1)
        v = arcs.evaluate(t, np.full(t.shape, i))[1][:, 0]
        drive = mass * arcs.drive_acceleration * np.sin(arcs.omega * (t - (periods - 1) * T))
        R = law.sliding(float(arcs.mode[i, 0]), load) if arcs.mode[i, 0] else drive + mass * along
        work += half * weight @ (drive * v)
        force += half * weight @ (R + 0 * t) / T
        lost += (law.sliding(float(arcs.mode[i, 0]), load) if arcs.mode[i, 0] else 0.0) * (x_end[i + 1] - x_end[i])
    moved = x_end[-1] - x_end[last[0]]
    v_end = arcs.evaluate(arcs.t[-1:], np.array([len(arcs.mode) - 1]))[1][0, 0]
    return work, mass * along * moved, lost, 0.5 * mass * (v_end**2 - arcs.v0[last[0]] ** 2), force


@pytest.mark.parametrize("incline", ["folded", "gravity"])
@pytest.mark.parametrize("tilt_deg, amplitude", [(1.7, 0.5525e-3), (2.7, 0.6032e-3), (4.7, 0.4564e-3), (5.7, 1.487e-3)])
def test_energy_and_momentum_balance(tilt_deg, amplitude, incline):
    robot = rig(tilt_deg, amplitude, incline=incline)
    drive, gravity, friction, kinetic, mean_force = powers(robot)
    assert abs(drive + gravity - friction - kinetic) <= 1e-12 * drive
    # in the periodic state friction bears the weight's share along the track, to rounding of the largest force
    assert mean_force == pytest.approx(robot.total_mass * robot.track.along(robot.gravity), abs=1e-12 * robot.load(0, 0))


def test_arcs_join_and_stop_where_the_velocity_is_zero():
    arcs, counts = exact.solve_one(rig(2.7, 0.6032e-3), periods=40)
    index = np.arange(len(arcs.mode))
    x, v = (of[:, 0] for of in arcs.evaluate(arcs.t[1:], index)[:2])
    unit = arcs.drive_acceleration / arcs.omega
    # t near 40 T is rounded to 40 T * 1e-16, which moves v by that much times the deceleration, below 2 a
    bound = 4 * 40 * 2 * math.pi * 1.2e-16 * unit
    assert np.max(abs(v[:-1] - arcs.v0[1:])) < bound
    assert np.max(abs(x[:-1] - arcs.x0[1:])) < bound / arcs.omega * 2 * math.pi
    assert counts["arcs"] == len(arcs.mode) and (np.diff(arcs.t) > 0).all()
    assert np.isin(np.arange(41) * (2 * math.pi / arcs.omega), arcs.t).all()


def test_one_case_and_a_batch_tell_the_same():
    robot = rig(1.7, [4e-4, 5.5e-4, 7e-4])
    raw = raw_of(robot, periods=50, settle=0)
    for i, amplitude in enumerate(robot.drive.amplitude):
        arcs, _ = exact.solve_one(rig(1.7, float(amplitude)), 50)
        x, v = (of[:, 0] for of in arcs.evaluate(arcs.t[-1:], np.array([len(arcs.mode) - 1]))[:2])
        assert (raw["x_end"][i], raw["v_end"][i]) == pytest.approx((x[0], v[0]), abs=1e-15)


@settings(max_examples=8, deadline=None)
@given(st.floats(0.1, 10), st.floats(0.1, 10))
def test_a_change_of_units_changes_only_units(mass, time):
    robot = rig(2.7, 6.032e-4)
    omega, g = robot.drive.omega / time, robot.gravity / time**2
    other = robot.replace({"body_mass": robot.body_mass * mass, "inner_mass": robot.inner_mass * mass, "drive.omega": omega, "gravity": g})
    assert raw_of(other)["V"] * time == pytest.approx(raw_of(robot)["V"], rel=1e-12)


# no drive, steep tracks, odd laws ---------------------------------------------------------------------------------


def test_without_a_drive_a_body_rests_stops_or_slides_down():
    robot = rig(1.7, [0.0, 0.0, 0.0, 5.525e-4])
    raw = raw_of(robot, start=dict(v=[0.0, 0.3, -0.3, 0.0]))
    slow = robot.gravity * robot.friction.mu_plus, robot.gravity * robot.friction.mu_minus
    assert raw["x_end"][:3] == pytest.approx([0, 0.045 / slow[0], -0.045 / slow[1]], rel=1e-14)
    assert raw["motion_type"].tolist() == ["rest", "rest", "rest", "I"]
    assert raw["V"][3] == pytest.approx(0.002014682, abs=5e-10)
    auto = exact.solve_batch(robot, 200, "auto", start=dict(v=[0.0, 0.3, -0.3, 0.0]))
    assert auto["periods_run"][0] == 1 and auto["status"].tolist() == [1, 1, 1, 1]


def test_beyond_the_friction_angle_it_slides_down_by_itself():
    steep = math.radians(20.0)
    down = 9.81 * (math.sin(steep) - 0.18 * math.cos(steep))
    for amplitude in (0.0, 1e-9):
        robot = rig(20.0, amplitude, incline="gravity")
        arcs, _ = exact.solve_one(robot, 30)
        x, v = (of[:, 0] for of in arcs.evaluate(arcs.t[-1:], np.array([len(arcs.mode) - 1]))[:2])
        t = 30 * robot.period
        assert (x[0], v[0]) == pytest.approx((0.5 * down * t * t, down * t), rel=1e-5 if amplitude else 1e-13)
        raw = exact.solve_batch(robot, 30, 0)
        assert (raw["x_end"][0], raw["period"][0]) == (pytest.approx(x[0], rel=1e-13), 0)


@dataclass(frozen=True)
class Rubber:
    """A user's own law: Coulomb in other words, or with a friction that depends on the speed."""

    grip: float
    slope: float = 0.0

    def sliding(self, v, load):
        return where(v > 0, self.grip, -1.3 * self.grip) * load + self.slope * v

    def breakaway(self, load):
        return -1.3 * self.grip * load, self.grip * load


class Weak(Rubber):
    """Its break-away falls below its sliding friction at small loads."""

    def breakaway(self, load):
        return -1.3 * self.grip * load**2, self.grip * load**2


class Pushing(Rubber):
    """Its sliding friction drives the motion."""

    def sliding(self, v, load):
        return -super().sliding(v, load)


def with_law(law):
    return rig(0.0, 5.5e-4).replace(friction=law)


def test_a_users_own_law_is_asked_and_not_assumed():
    own = raw_of(with_law(Rubber(grip=np.array([0.15, 0.17]))))
    ours = raw_of(with_law(ss.Coulomb(mu_plus=np.array([0.15, 0.17]), mu_minus=1.3 * np.array([0.15, 0.17]))))
    assert own["V"] == pytest.approx(ours["V"], rel=1e-12)
    assert handles(with_law(Rubber(grip=0.15))) is None


@each_row(
    ("robot", "said"),
    [
        (with_law(Rubber(grip=0.15, slope=0.01)), "depends on the speed"),
        (with_law(Weak(grip=0.15)), "breaks away below"),
        (with_law(Pushing(grip=0.15)), "feeds the motion"),
        (ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4), "dynamic law"),
    ],
)
def test_what_has_no_closed_arcs_is_refused_with_a_reason(robot, said):
    assert said in handles(robot)


def test_a_law_that_returns_no_number_spoils_its_own_case_only():
    raw = exact.solve_batch(with_law(Rubber(grip=np.array([0.15, np.nan]))), 20, 10)
    assert raw["status"].tolist() == [0, 5]
    assert np.isfinite(raw["displacement"][0]) and np.isnan(raw["displacement"][1])
    with pytest.raises(ss.SolveError, match="not all finite"):
        exact.solve_one(with_law(Rubber(grip=float("nan"))), 2)


def test_progress_is_told():
    told = []
    exact.solve_rows(random_rows(50, seed=1), 10_000, 0, progress=lambda done, cases: told.append((done, cases)))
    assert told[-1] == (50, 50) and len(told) > 2
