"""The engine: tracing says what to write, the emitted step is the plain law, one lane and sixteen give the same bits."""

from __future__ import annotations

import ast
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from problems import paper_batch
from rows import each_row
from stickslip.engine import lanes, tableaux, trace
from stickslip.maths import exp, sqrt, where


@dataclass(frozen=True)
class PlainLuGre:
    """LuGre as the README tells a user to write a law."""

    mu_plus: float
    mu_minus: float
    f_plus: float
    f_minus: float
    sigma0: float = 4e5
    sigma1: float = 100.0
    sigma2: float = 0.04
    v_s: float = 2e-3

    def rate(self, v, z, load):
        mu, f = where(v > 0, self.mu_plus, self.mu_minus), where(v > 0, self.f_plus, self.f_minus)
        return v - self.sigma0 * abs(v) * z / (load * (mu + (f - mu) * exp(-((v / self.v_s) ** 2))))

    def force(self, v, z, zdot, load):
        return self.sigma0 * z + self.sigma1 * zdot + self.sigma2 * v

    def velocity_scale(self):
        return self.v_s


@dataclass(frozen=True)
class TwoBristles(PlainLuGre):
    """Two bristles side by side: two inner states."""

    states = 2

    def rate(self, v, z, load):
        one = super().rate
        return [one(v, 2 * zi, load) / 2 for zi in z]

    def force(self, v, z, zdot, load):
        return self.sigma0 * (z[0] + z[1]) + self.sigma1 * (zdot[0] + zdot[1]) + self.sigma2 * v


@dataclass(frozen=True)
class ElastoPlastic(PlainLuGre):
    """Dupont's elasto-plastic bristle: five conditions."""

    z_ba: float = 1e-7

    def rate(self, v, z, load):
        mu, f = where(v > 0, self.mu_plus, self.mu_minus), where(v > 0, self.f_plus, self.f_minus)
        steady = load * (mu + (f - mu) * exp(-((v / self.v_s) ** 2))) / self.sigma0
        s = (abs(z) - self.z_ba) / (steady - self.z_ba)
        blend = where(abs(z) > steady, 1.0, s * s * (3 - 2 * s))
        alpha = where(v * z > 0, where(abs(z) > self.z_ba, blend, 0.0), 0.0)
        return v * (1 - alpha * abs(z) / steady)


def rig(law, amplitude=6e-4):
    like = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=amplitude)
    f = like.friction
    return like.replace(friction=law(f.mu_plus, f.mu_minus, f.f_plus, f.f_minus), track=ss.Level())


# ---- what a law may do ----
def test_a_users_law_gives_the_built_in_laws_bits():
    """Written apart, traced to the same equation; only the scale of z differs, hence the tolerance of the method."""
    built_in = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4), rtol=1e-9, periods=40)
    own = ss.solve(rig(PlainLuGre), rtol=1e-9, periods=40)
    assert ss.mean_velocity(own) == pytest.approx(ss.mean_velocity(built_in), rel=1e-8)


def test_two_equal_bristles_are_one():
    """2 z_i obeys the law of one bristle, so the force is the same."""
    one, two = (ss.solve(rig(law), rtol=1e-9, periods=40) for law in (PlainLuGre, TwoBristles))
    assert two.z.shape[1] == 2
    assert ss.mean_velocity(two) == pytest.approx(ss.mean_velocity(one), rel=1e-8)


def test_a_law_with_five_conditions_agrees_with_an_independent_solver():
    from scipy.integrate import solve_ivp

    robot = rig(ElastoPlastic)
    law, load, T = robot.friction, robot.load(0, 0), robot.period

    def slope(t, y):
        v, z = float(y[0]), float(y[1])
        rate = law.rate(v, z, load)
        return [robot.acceleration(t, 0.0, v, law.force(v, z, rate, load)), rate]

    times = np.linspace(0, 4.3 * T, 50)
    other = solve_ivp(slope, (0, 4.3 * T), [0.0, 0.0], method="Radau", rtol=1e-9, atol=[1e-12, 1e-18], max_step=T / 50, t_eval=times)
    run = ss.solve(robot, periods=5, rtol=1e-9)
    assert np.abs(run.at(times)["v"] - other.y[0]).max() < 1e-6 * robot.velocity_scale  # Radau steps over the kinks


class Refused:
    """Laws that cannot be traced, and what the message must say."""

    @dataclass(frozen=True)
    class If(PlainLuGre):
        def rate(self, v, z, load):
            return v if v > 0 else -v

    @dataclass(frozen=True)
    class MathExp(PlainLuGre):
        def rate(self, v, z, load):
            return v - math.exp(v) * z

    @dataclass(frozen=True)
    class NumpyExp(PlainLuGre):
        def rate(self, v, z, load):
            return v - np.exp(v) * z

    @dataclass(frozen=True)
    class Equality(PlainLuGre):
        def rate(self, v, z, load):
            return where(v == 0, z, v)

    @dataclass(frozen=True)
    class Hidden(PlainLuGre):
        def __post_init__(self):
            object.__setattr__(self, "precomputed", 1.0)

        def rate(self, v, z, load):
            return v - self.precomputed * z

    @dataclass(frozen=True)
    class Infinite(PlainLuGre):
        def rate(self, v, z, load):
            return v - float("inf")


@each_row(
    ("law", "words"),
    [
        (Refused.If, "where"), (Refused.MathExp, "stickslip.maths"), (Refused.NumpyExp, "stickslip.maths"), (Refused.Equality, "where"),
        (Refused.Hidden, "precomputed"), (Refused.Infinite, "finite"),
    ],
)  # fmt: skip
def test_a_law_that_cannot_be_traced_is_told_what_to_write(law, words):
    with pytest.raises(ss.InputError, match=words):
        ss.solve(rig(law), periods=2)


# ---- the equations ----
def test_the_jacobian_is_the_derivative_of_the_equations():
    """Symbolic derivative against central differences of the plain law, at random states."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)
    eq = trace.trace(robot)
    rng = np.random.default_rng(3)
    for _ in range(20):
        v, z, t = rng.normal() * 0.01, rng.normal() * 1e-7, rng.uniform(0, 0.03)
        values = {"t": t, "v": v, "z0": z, "b0": math.copysign(1.0, v)} | dict(zip(eq.names, rows(robot, eq), strict=True))
        for j, (name, step) in enumerate((("v", 1e-8), ("z0", 1e-13))):
            up, down = ([evaluate(f, values | {name: values[name] + s}) for f in eq.f] for s in (step, -step))
            for i in range(2):
                slope = (up[i] - down[i]) / (2 * step)
                assert evaluate(eq.jacobian[i][j], values) == pytest.approx(slope, rel=1e-5, abs=1e-6 * abs(slope) + 1e-3)


def rows(robot, eq):
    from stickslip.basics.batch import rows_of

    return rows_of(robot, eq.names)[0].tolist()


def evaluate(node, values):
    """A node's value, read off the graph: the slow twin of the emitted code."""
    a = [evaluate(x, values) for x in node.args]
    match node.op:
        case "constant":
            return node.value
        case "case" | "variable" | "flag":
            return values[node.name]
        case "add":
            return a[0] + a[1]
        case "subtract":
            return a[0] - a[1]
        case "multiply":
            return a[0] * a[1]
        case "reciprocal":
            return 1 / a[0]
        case "select":
            return a[1] if a[0] > 0 else a[2]
    return getattr(math, node.op)(a[0])


def test_traced_equations_are_the_plain_law():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)
    eq, law, load = trace.trace(robot), robot.friction, robot.load(0, 0)
    rng = np.random.default_rng(4)
    for _ in range(50):
        v, z, t = rng.normal() * 0.01, rng.normal() * 1e-7, rng.uniform(0, 0.03)
        values = {"t": t, "v": v, "z0": z, "b0": math.copysign(1.0, v)} | dict(zip(eq.names, rows(robot, eq), strict=True))
        rate = law.rate(v, z, load)
        plain = [robot.acceleration(t, 0.0, v, law.force(v, z, rate, load)), rate]
        for i in range(2):
            assert evaluate(eq.f[i], values) == pytest.approx(plain[i], rel=1e-12, abs=1e-13)


# ---- lanes ----
@pytest.mark.parametrize("name", tableaux.TABLEAUX)
def test_one_lane_and_sixteen_give_the_same_bits(name):
    robots = paper_batch(23)
    many = ss.solve(robots, periods=8, settle=3, method=name, rtol=1e-6)
    for i, A in enumerate(robots.drive.amplitude):
        one = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=float(A)), periods=8, settle=3, method=name, rtol=1e-6, keep="summary")
        for column in ("mean_velocity", "velocity_max", "velocity_min", "stick_fraction", "margin", "displacement"):
            assert getattr(one, column) == getattr(many, column)[i], column


def pair(first, second, stiffness=1200.0):
    """Two modules driven by these amplitudes, the second .4 pi ahead."""
    modules = tuple(ss.presets.piezo_rig(tilt_deg=0.0, amplitude=amplitude) for amplitude in (first, second))
    return ss.Chain(modules, ss.Spring(stiffness, 0.0004 * stiffness), phases=(0.0, 0.4 * math.pi))


def test_one_lane_and_sixteen_give_the_same_bits_where_two_modules_reverse_in_turn():
    """Lanes jump over an event together, if none of them has one; of those that do not, none is changed."""
    amplitude = np.linspace(3e-4, 8e-4, 23)
    many = ss.solve(pair(amplitude, amplitude), periods=8, settle=3, rtol=1e-4)
    for i in range(0, 23, 4):
        one = ss.solve(pair(amplitude[i], amplitude[i]), periods=8, settle=3, rtol=1e-4, keep="summary")
        assert (one.mean_velocity, one.displacement) == (many.mean_velocity[i], many.displacement[i])


def test_the_error_of_two_bodies_is_the_root_mean_square_of_theirs():
    """If one of them stands still, the other may err by a factor of the root of two: it takes as many steps as alone at that tolerance.

    A tolerance of that factor is 9 % of the steps of a method whose estimate is of order 4.
    """

    def steps(machine, rtol):
        return ss.solve(machine, periods=12, rtol=rtol, method="rodas4").counts["steps"]

    alone = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=6e-4)
    both = steps(pair(6e-4, 1e-12, stiffness=0.0), 1e-4)
    assert both == pytest.approx(steps(alone, math.sqrt(2) * 1e-4), rel=0.02)
    assert both < 0.95 * steps(alone, 1e-4)


def test_order_of_cases_and_threads_do_not_matter():
    robots = paper_batch(300)
    backwards = robots.replace({"drive.amplitude": robots.drive.amplitude[::-1]})
    one, turned, threads = ss.solve(robots, periods=5), ss.solve(backwards, periods=5), ss.solve(robots, periods=5, workers=2)
    assert np.array_equal(one.mean_velocity, turned.mean_velocity[::-1])
    assert np.array_equal(one.mean_velocity, threads.mean_velocity)


def test_slices_do_not_matter():
    """A kernel that returns after every few steps gives the same bits as one that does not."""
    robots = paper_batch(40)
    eq = trace.trace(robots)
    from stickslip.basics.batch import rows_of

    kernel, table = lanes.kernel_of(robots, tableaux.RODAS5P, record=False), rows_of(robots, eq.names)
    job = lanes.Job(6, 3, False, 1e-6, 0.75, 1e9)
    whole = lanes.run(kernel, table, np.zeros((40, 3)), job)
    sliced = lanes.run(kernel, table, np.zeros((40, 3)), job, slice_calls=7)
    assert np.array_equal(whole.displacement, sliced.displacement)
    assert np.array_equal(whole.seg_time, sliced.seg_time)


def test_a_trajectory_and_a_summary_tell_the_same():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)
    run, summary = ss.solve(robot, periods=30, settle=20, samples=4000), ss.solve(robot, periods=30, settle=20, keep="summary")
    assert ss.mean_velocity(run) == pytest.approx(float(summary.mean_velocity), rel=1e-12)
    motion = ss.motion(run)
    assert motion.pattern == str(summary.pattern)
    assert motion.period == int(summary.period)
    assert run.v[-8000:].max() == pytest.approx(float(summary.velocity_max), rel=1e-6)  # that of the summary is no sample
    assert motion.stick_fraction == pytest.approx(float(summary.stick_fraction), abs=5e-3)  # its thresholds are interpolated linearly


def test_auto_settling_stops_early_at_the_same_answer():
    robots = paper_batch(64)
    full, auto = ss.solve(robots, periods=200, rtol=1e-7), ss.solve(robots, periods=200, settle="auto", rtol=1e-7)
    assert auto.periods_run.max() < 60
    assert np.abs(auto.mean_velocity / full.mean_velocity - 1).max() < 1e-6
    assert set(auto.status_counts) == {"stopped: the strobe point repeats"}


def test_auto_settling_of_a_motion_that_never_repeats_gives_the_mean_of_the_second_half():
    """A = 0.4 mm and mu0 = 0.05: no period is found, and the status does not claim one."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=np.array([4e-4]), mu0=0.05)
    auto = ss.solve(robot, periods=300, settle="auto")
    assert auto.period.tolist() == [0]
    assert auto.status.tolist() == [0]
    assert auto.mean_velocity[0] == ss.solve(robot, periods=300).mean_velocity[0]


def test_a_case_that_cannot_be_solved_is_a_status():
    """One robot's law gives NaN at speed; the others are solved."""

    @dataclass(frozen=True)
    class Breaks(PlainLuGre):
        limit: float = 1.0

        def force(self, v, z, zdot, load):
            return super().force(v, z, zdot, load) + 1e-30 * sqrt(self.limit - v)

    base = rig(Breaks)
    many = ss.solve(base.replace({"friction.limit": np.array([1.0, 5e-3, 1.0])}), periods=3)
    assert many.status.tolist()[::2] == [0, 0]
    assert many.status[1] in (3, 4)
    assert np.isnan(many.mean_velocity[1])
    with pytest.raises(ss.SolveError, match="stopped after"):
        ss.solve(base.replace({"friction.limit": 5e-3}), periods=3)


# ---- the arrays of lanes ----
def test_lanes_have_room_for_every_column_that_the_driver_names():
    """`run` makes as many columns as the last name says; the driver's text counts them, and the exact arcs keep as many segments."""
    from stickslip.engine.kernel_text import kernel_text
    from stickslip.engine.kernels import columns

    text = ast.parse(Path(columns.__file__).read_text(encoding="utf-8"))
    named = [[name.id for name in node.targets[0].elts] for node in text.body if isinstance(getattr(node, "value", None), ast.Call)]
    ends = [("CASE", "SEGMENTS"), ("TQ", "SINCE"), ("NEXT", "WHOLE"), ("RTOL", "BUDGET_OF_STEPS"), ("TOTAL", "SMALLEST")]
    assert [(names[0], names[-1]) for names in named] == ends
    assert f"SEGS = {columns.SEGS} " in kernel_text("coulomb_harmonic_looks")
