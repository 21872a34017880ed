"""Drives: position, velocity and acceleration are one periodic motion with the breaks and jumps it says it has; and robots with them."""

import dataclasses
import math

import numpy as np
import pytest

import stickslip as ss
from coasting import Coasting
from pairs import each_once
from registries import examples
from rows import each_row
from stickslip.analysis.closed_form import three_phase, two_phase
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.engine.symbols import Graph
from stickslip.engine.values import values_of
from stickslip.maths import within

G = 9.81
MU, PLUS, MINUS = 0.1315, 0.15, 0.25
DRIVES = {
    **examples(ss.drives.DRIVES),
    "bangbang, stronger first": ss.drives.BangBang(a1=60.0, a2=7.0, frequency=11.0),
    "threephase, a jerk": ss.drives.ThreePhase(stroke=0.005, w1=18.0, w2=1e7, w3=18.0),
    "trapezoid, fast first": ss.drives.Trapezoid(u1=0.4, u2=0.1, ramp=0.004, stroke=0.01),
    "multiharmonic, four": ss.MultiHarmonic(frequency=30.0, amplitudes=(4e-4, 0.0, -1e-4, 5e-5), phases=(0.3, 0.0, 1.0, -2.0)),
    "vertical on three phases": ss.drives.VerticalVibration(ss.drives.ThreePhase.example(), amplitude=2e-5, phase=0.4, harmonic=2),
    "reversed vertical": ss.drives.Reversed(ss.drives.VerticalVibration.example()),
}
every_drive = each_row("drive", DRIVES.values(), ids=DRIVES)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)


def borders(drive):
    """Start, breaks, jumps and end of a period."""
    return sorted({0.0, *map(float, drive.breaks), *(float(t) for t, _ in drive.jumps), float(drive.period)})


def stretches(drive):
    """The smooth pieces of a period, a hair inside their ends."""
    ends = np.array(borders(drive))
    hair = 1e-9 * np.diff(ends)
    return list(zip(ends[:-1] + hair, ends[1:] - hair, strict=True))


def integral(f, a, b, parts=4):
    """Gauss's rule on parts of a smooth stretch: exact to rounding for polynomials and for a few periods of a sine."""
    cuts = np.linspace(a, b, parts + 1)
    half, middle = np.diff(cuts)[:, None] / 2, (cuts[:-1, None] + cuts[1:, None]) / 2
    return float(np.sum(half * WEIGHTS * f(middle + half * NODES)))


# one motion -------------------------------------------------------------------------------------------------------


@every_drive
def test_velocity_is_the_rate_of_position_and_acceleration_that_of_velocity(drive):
    speed = float(drive.velocity_scale)
    for a, b in stretches(drive):
        for s in np.linspace(a, b, 6)[1:]:
            assert integral(drive.velocity, a, s) == pytest.approx(drive.position(s) - drive.position(a), abs=1e-13 * speed * drive.period)
            # an acceleration of w2 in a phase of t2 - t1 is as exact as its instants are: rounding of t over its length
            exact = 1e-13 + 4e-16 * drive.period / (b - a)
            assert integral(drive.acceleration, a, s) == pytest.approx(drive.velocity(s) - drive.velocity(a), abs=10 * exact * speed)


@every_drive
def test_the_velocity_jumps_where_it_says_and_nowhere_else(drive):
    said = {float(t): float(jump) for t, jump in drive.jumps}
    pieces = stretches(drive)
    for (_, end), (start, _) in zip(pieces, pieces[1:] + pieces[:1], strict=True):
        at = next((t for t in said if min(abs(start - t), abs(start - t - drive.period)) < 1e-6 * drive.period), None)
        jump = drive.velocity(start) - drive.velocity(end)
        assert jump == pytest.approx(0.0 if at is None else said[at], abs=1e-7 * drive.velocity_scale)  # two hairs of 1e-9 each
        assert drive.position(start) == pytest.approx(drive.position(end), abs=1e-7 * drive.stroke)


@every_drive
def test_it_repeats_and_goes_nowhere(drive):
    t = np.concatenate([np.linspace(a, b, 7) for a, b in stretches(drive)])
    whole = sum(integral(drive.velocity, a, b) for a, b in stretches(drive))
    assert whole == pytest.approx(0.0, abs=1e-8 * drive.velocity_scale * drive.period)  # the hairs left out: 2e-9
    for periods in (1, 3, 1000):
        later = t + periods * drive.period
        assert drive.position(later) == pytest.approx(drive.position(t), abs=1e-9 * drive.stroke)
    for motion in (drive.position, drive.velocity, drive.acceleration):
        inside = np.concatenate([a + (b - a) * np.array([0.2, 0.7]) for a, b in stretches(drive) if b - a > 1e-3 * drive.period])
        scale = np.max(abs(motion(inside))) or 1.0
        assert motion(inside + 7 * drive.period) == pytest.approx(motion(inside), abs=1e-9 * scale)


@every_drive
def test_stroke_energy_and_velocity_scale_are_those_of_dense_samples(drive):
    t = np.concatenate([np.linspace(a, b, 20_001) for a, b in stretches(drive)])
    x, v = drive.position(t), drive.velocity(t)
    coarse = 1e-7  # a maximum between samples, (pi/20000)^2/2, of up to five harmonics
    assert drive.stroke == pytest.approx(np.ptp(x), rel=10 * coarse)
    assert drive.specific_energy == pytest.approx(0.5 * np.max(v**2), rel=10 * coarse)
    assert drive.velocity_scale == pytest.approx(np.max(abs(v)), rel=0.5)  # typical
    assert drive.omega * drive.period == pytest.approx(2 * math.pi)


@each_row("name", ["harmonic", "twophase", "threephase", "bangbang", "trapezoid", "reversed", "threephase, a jerk"])
def test_the_velocity_scale_is_the_largest_velocity_where_a_formula_has_it(name):
    drive = DRIVES[name]
    t = np.concatenate([np.linspace(a, b, 2001) for a, b in stretches(drive)])
    assert drive.velocity_scale == pytest.approx(np.max(abs(drive.velocity(t))), rel=1e-6)


@every_drive
def test_it_is_smooth_between_its_breaks(drive):
    for a, b in stretches(drive):
        t = a + (b - a) * (1 - np.cos(np.linspace(0.02, np.pi - 0.02, 61))) / 2
        fit = np.polynomial.Chebyshev.fit(t, drive.acceleration(t), 40, domain=[a, b])
        between = np.linspace(a + 0.01 * (b - a), b - 0.01 * (b - a), 333)
        scale = np.max(abs(drive.acceleration(between))) or 1.0
        smooth = fit(between) == pytest.approx(drive.acceleration(between), abs=1e-9 * scale)
        assert smooth, f"between {a:.6g} s and {b:.6g} s its acceleration has a corner or a jump: name the instant in breaks, or in jumps"


@every_drive
def test_it_is_not_smooth_at_its_breaks(drive):
    ends = borders(drive)
    for t in map(float, drive.breaks):
        around = 0.4 * min(abs(t - e) for e in ends if e != t)
        at = np.linspace(t - around, t + around, 61)
        values = drive.acceleration(at)
        misfit = values - np.polynomial.Chebyshev.fit(at, values, 20)(at)
        assert np.max(abs(misfit)) > 1e-6 * np.ptp(values)


@every_drive
def test_arrays_and_numbers_give_the_same(drive):
    t = np.concatenate([np.linspace(a, b, 5) for a, b in stretches(drive)])
    for motion in (drive.position, drive.velocity, drive.acceleration):
        each = np.array([float(motion(float(s))) for s in t])
        assert motion(t) == pytest.approx(each, abs=1e-14 * np.max(abs(each)))  # sines of arrays may be another library's


# written down -----------------------------------------------------------------------------------------------------


def value(node, known):
    """What an expression of symbols comes to."""
    return values_of(node.graph, {"t": 0.0, **known})[node.number]


@every_drive
def test_symbols_write_down_the_same_motion(drive):
    graph, numbers = Graph(), dict(leaves(drive))
    written = replace_leaf(drive, {name: graph.case(name) for name in numbers})
    t = graph.variable("t")
    nodes = {name: getattr(written, name)(t) for name in ("position", "velocity", "acceleration")}
    for s in np.concatenate([np.linspace(a, b, 4) for a, b in stretches(drive)]):
        for name, node in nodes.items():
            expected = getattr(drive, name)(float(s))
            scale = {"position": drive.stroke, "velocity": drive.velocity_scale}.get(name) or abs(expected) or 1.0
            got = node if isinstance(node, float) else value(node, {**numbers, "t": float(s)})
            assert got == pytest.approx(expected, abs=1e-11 * scale + 1e-12 * drive.velocity_scale * drive.omega)
    for name in ("period", "velocity_scale"):
        assert value(getattr(written, name), numbers) == pytest.approx(getattr(drive, name), rel=1e-14)
    for written_break, there in zip(written.breaks, drive.breaks, strict=True):
        assert value(written_break, numbers) == pytest.approx(there, rel=1e-14)
    for (instant, jump), (t0, j0) in zip(written.jumps, drive.jumps, strict=True):
        given = [x if isinstance(x, float) else value(x, numbers) for x in (instant, jump)]
        assert given == pytest.approx([t0, j0], rel=1e-14)


def test_time_within_a_period_is_the_symbol_itself_and_a_whole_period_is_its_start():
    t = Graph().variable("t")
    assert within(t, 0.3) is t
    for period in (0.1, 1 / 3, 0.0305810398, math.pi):
        k = np.arange(5000)
        assert np.max(within(k * period, period)) <= 5000 * 4e-16 * period  # never the end of a period
        assert all(within(int(i) * period, period) == within(k * period, period)[i] for i in (3, 49, 4999))
    assert within(0.75, 0.5) == 0.25


# several of them --------------------------------------------------------------------------------------------------


@each_row(
    "make",
    [
        lambda x: ss.drives.TwoPhase(stroke=0.01 * x, u1=0.1, u2=0.3),
        lambda x: ss.drives.ThreePhase(stroke=0.005, w1=10.0 * x, w2=60.0, w3=12.0),
        lambda x: ss.drives.BangBang(a1=20.0, a2=10.0 * x, stroke=0.001),
        lambda x: ss.drives.Trapezoid(u1=0.1 * x, u2=0.2, ramp=0.005, stroke=0.01),
        lambda x: ss.MultiHarmonic(omega=200.0, amplitudes=(1e-4 * x, 5e-5), phases=(0.0, 1.0)),
        lambda x: ss.drives.VerticalVibration(ss.Harmonic(amplitude=1e-4 * x, omega=200.0), amplitude=1e-5),
    ],
)  # fmt: skip
def test_a_number_may_be_an_array(make):
    many, x = make(np.array([1.0, 1.5, 2.0])), [1.0, 1.5, 2.0]
    for name in ("period", "stroke", "velocity_scale", "specific_energy"):
        assert np.broadcast_to(getattr(many, name), 3) == pytest.approx([getattr(make(i), name) for i in x], rel=1e-12)
    assert many.velocity(0.0123) == pytest.approx([make(i).velocity(0.0123) for i in x], rel=1e-10)


@every_drive
def test_a_study_file_keeps_every_drive(drive):
    robot = rig(drive)
    assert ss.Robot.from_toml(robot.to_toml()) == robot


def test_a_study_file_says_where_a_drive_inside_a_drive_is_wrong():
    text = rig(DRIVES["vertical on three phases"]).to_toml()
    with pytest.raises(ss.InputError, match=r"robot\.drive\.drive\.kind = 'threefase'; did you mean 'threephase'"):
        ss.Robot.from_toml(text.replace("threephase", "threefase"))
    with pytest.raises(ss.InputError, match=r"robot\.drive\.drive\.w4 is not known"):
        ss.Robot.from_toml(text.replace("w3 =", "w4 ="))


def test_one_harmonic_of_several_is_the_harmonic_drive():
    one, t = ss.MultiHarmonic(omega=205.0, amplitudes=(5e-4,)), np.linspace(0, 1, 99)
    plain = ss.Harmonic(amplitude=5e-4, omega=205.0)
    assert one.acceleration(t) == pytest.approx(plain.acceleration(t), abs=1e-13 * 205**2 * 5e-4)
    assert (one.velocity_scale, one.stroke) == pytest.approx((plain.velocity_scale, plain.stroke), rel=1e-14)


def test_bang_bang_is_a_three_phase_drive_that_began_half_a_phase_earlier():
    bang = ss.drives.BangBang(a1=20.0, a2=40.0, period=0.03)
    three = ss.drives.ThreePhase(u1=bang.velocity_scale, w1=20.0, w2=40.0, w3=20.0)
    t = np.linspace(0, 0.03, 100)[:-1]
    assert three.velocity(t) == pytest.approx(bang.velocity(t + bang.t1 / 2), abs=1e-14)
    assert (three.period, three.stroke) == pytest.approx((bang.period, bang.stroke), rel=1e-13)


def test_a_trapezoid_with_short_ramps_is_nearly_a_two_phase_drive():
    two = ss.drives.TwoPhase(stroke=0.01, u1=0.05, u2=0.4)
    smooth = ss.drives.Trapezoid(u1=0.05, u2=0.4, ramp=1e-7, stroke=0.01)
    assert smooth.period == pytest.approx(two.period, abs=2e-7)
    assert smooth.velocity(0.1) == two.velocity(0.1) and smooth.velocity(0.21) == two.velocity(0.21)


def test_a_smooth_trapezoid_has_a_continuous_acceleration_of_the_height_it_says():
    drive = ss.drives.Trapezoid.example()
    t = np.linspace(0, drive.period, 200_001)
    a = drive.acceleration(t)
    assert np.max(abs(np.diff(a))) < 1e-3 * np.max(abs(a)) * 3
    assert np.max(abs(a)) == pytest.approx(1.875 * 0.45 / 0.01, rel=1e-6)


# what settles a drive ---------------------------------------------------------------------------------------------


@each_row(
    "given",
    [{"stroke": 0.01, "u1": 0.05, "t2": 0.025}, {"u1": 0.05, "t1": 0.2, "u2": 0.4}, {"t1": 0.2, "stroke": 0.01, "t2": 0.025},
     {"u2": 0.4, "t2": 0.025, "t1": 0.2}, {"stroke": 0.01, "u1": 0.05, "u2": 0.4, "t1": 0.2, "t2": 0.025}],
)  # fmt: skip
def test_any_three_numbers_settle_a_two_phase_drive(given):
    drive = ss.drives.TwoPhase(**given)
    assert (drive.stroke, drive.u1, drive.u2) == pytest.approx((0.01, 0.05, 0.4), rel=1e-14)


def test_a_three_phase_drive_may_be_given_by_its_stroke_or_its_return():
    drive = ss.drives.ThreePhase.example()
    assert ss.drives.ThreePhase(stroke=drive.stroke, w1=10.0, w2=60.0, w3=12.0).u1 == pytest.approx(0.3, rel=1e-14)
    assert ss.drives.ThreePhase(u3=drive.u3, w1=10.0, w2=60.0, w3=12.0).u1 == pytest.approx(0.3, rel=1e-14)
    assert ss.drives.ThreePhase(u1=0.3, u3=drive.u3, w1=10.0, w2=60.0, w3=12.0) == drive


def test_a_bang_bang_drive_and_a_trapezoid_may_be_given_by_their_stroke():
    bang, smooth = ss.drives.BangBang.example(), ss.drives.Trapezoid.example()
    assert ss.drives.BangBang(a1=20.0, a2=40.0, stroke=bang.stroke).period == pytest.approx(0.03, rel=1e-14)
    assert ss.drives.BangBang(a1=20.0, a2=40.0, t1=bang.t1, t2=bang.t2).period == pytest.approx(0.03, rel=1e-14)
    assert ss.drives.Trapezoid(u1=0.05, u2=0.4, ramp=0.01, stroke=smooth.stroke).period == pytest.approx(0.25, rel=1e-13)


@each_row(
    ("make", "says"),
    [
        (lambda: ss.drives.TwoPhase(stroke=0.01, u1=0.05, u2=0.4, t1=0.3),
        "u1 t1 = .* m and stroke = 0.01 m; allowed is one stroke for both"),
        (lambda: ss.drives.TwoPhase(u1=0.05, t1=0.2, u2=0.4, t2=0.2), "allowed is one stroke for both phases"),
        (lambda: ss.drives.TwoPhase(u1=0.05, u2=0.4), "does not settle stroke"),
        (lambda: ss.drives.TwoPhase(stroke=0.01, u1=-0.05, u2=0.0), "2 problems"),
        (lambda: ss.drives.ThreePhase(u1=0.3, w1=10.0, w2=60.0, w3=12.0, u3=0.3), "u3 = 0.3 do not agree: u3 asks for u1 = 0.2777"),
        (lambda: ss.drives.ThreePhase(u1=0.3, stroke=0.01, w1=10.0, w2=60.0, w3=12.0), "allowed is a motion that closes"),
        (lambda: ss.drives.ThreePhase(w1=10.0, w2=60.0, w3=12.0), "u1 is missing; allowed is u1, stroke or u3"),
        (lambda: ss.drives.ThreePhase(u1=0.3, w1=10.0, w3=12.0), "w2 is missing"),
        (lambda: ss.drives.ThreePhase(u1=0.3, w1=10.0, w2=1e30, w3=12.0), "too short for double precision"),
        (lambda: ss.drives.BangBang(a1=20.0, a2=40.0, t1=0.02, t2=0.02), "do not agree: t2 asks for period = 0.06"),
        (lambda: ss.drives.BangBang(a1=20.0), "period is missing"),
        (lambda: ss.drives.BangBang(period=0.03), "a1 is missing"),
        (lambda: ss.drives.Trapezoid(u1=0.05, u2=0.4, ramp=0.03, period=0.25), "leaves no plateau"),
        (lambda: ss.drives.Trapezoid(u1=0.05, u2=0.4, ramp=0.0, period=0.25), "ramp = 0.0; allowed is a positive number"),
        (lambda: ss.MultiHarmonic(omega=205.0, amplitudes=(5e-4, 1e-4), phases=(0.0,)), "1 phases for 2 amplitudes"),
        (lambda: ss.MultiHarmonic(omega=205.0, amplitudes=()), "amplitudes is empty"),
        (lambda: ss.MultiHarmonic(omega=205.0, frequency=3.0, amplitudes=(1e-4,)), "exactly one of omega"),
        (lambda: ss.MultiHarmonic(omega=205.0, amplitudes=(1e-4, math.nan)), r"amplitudes\[1\] = nan"),
        (lambda: ss.drives.VerticalVibration(3.0, amplitude=1e-4), "allowed is a drive"),
        (lambda: ss.drives.VerticalVibration(ss.Harmonic.example(), amplitude=-1e-4, harmonic=0), "2 problems"),
        (lambda: ss.drives.Reversed(ss.Harmonic), "allowed is a drive"),
        (lambda: ss.drives.Recorded(period=0.1, cosines=(1e-4,), sines=()), "1 cosines and 0 sines"),
    ],
)  # fmt: skip
def test_what_does_not_make_a_drive_is_said(make, says):
    with pytest.raises(ss.InputError, match=says):
        make()


# records ----------------------------------------------------------------------------------------------------------


TRUE = ss.MultiHarmonic(frequency=50.0, amplitudes=(4e-4, 1e-4, 3e-5), phases=(0.3, 1.0, -2.0))
T = TRUE.period
EVEN = np.arange(400) * T / 100


INSTANTS = {
    "four periods": EVEN,
    "one": EVEN[:100],
    "one and its end": EVEN[:101],
    "later, not whole": 0.7 + EVEN[:273],
    "uneven": np.sort(EVEN + 0.3 * T / 100 * np.sin(np.arange(400) * 37.0)),
}


@each_row(("what", "which"), each_once(["position", "velocity", "acceleration"], INSTANTS))
def test_a_record_gives_back_its_harmonics(what, which):
    t = INSTANTS[which]
    drive = ss.drives.Recorded.from_samples(t, **{what: getattr(TRUE, what)(t)}, period=T)
    s = np.linspace(0, T, 57)
    assert drive.order == 3
    for motion in ("position", "velocity", "acceleration"):
        expected = getattr(TRUE, motion)(s)
        assert getattr(drive, motion)(s) == pytest.approx(expected, abs=1e-9 * np.max(abs(expected)))


def test_the_position_of_a_record_has_no_mean():
    drive = ss.drives.Recorded.from_samples(EVEN, position=0.3 + TRUE.position(EVEN), period=T)
    assert drive.position(EVEN) == pytest.approx(TRUE.position(EVEN), abs=1e-12)


def test_the_order_follows_the_tolerance_and_the_notes_say_what_is_left():
    saw = ss.drives.BangBang(a1=20.0, a2=40.0, period=0.03)
    t = np.arange(3000) * 1e-5
    orders, left = [], []
    for tolerance in (1e-1, 1e-2, 1e-3):
        drive = ss.drives.Recorded.from_samples(t, velocity=saw.velocity(t), period=0.03, tolerance=tolerance)
        misses = drive.velocity(t) - saw.velocity(t)
        left.append(float(np.sqrt(np.mean(misses**2)) / np.std(saw.velocity(t))))
        orders.append(drive.order)
        assert left[-1] <= tolerance
        assert f"{100 * left[-1]:.3g} per cent" in drive.notes[0] and f"{drive.order} harmonics" in drive.notes[0]
        assert rig(drive).notes == list(drive.notes)
    assert orders == sorted(orders) and orders[0] < orders[1] < orders[2]
    # the coefficients of a triangle fall as 1/k^2, so that what is left falls as 1/k^1.5
    assert left[2] / left[1] == pytest.approx((orders[1] / orders[2]) ** 1.5, rel=0.2)


def test_a_record_with_corners_keeps_most_harmonics_and_says_so():
    two = ss.drives.TwoPhase.example()
    t = np.arange(2000) * two.period / 2000
    drive = ss.drives.Recorded.from_samples(t, velocity=two.velocity(t) - two.velocity(t).mean(), period=two.period)
    assert drive.order == 64
    assert "more than tolerance" in drive.notes[0]


def test_noise_is_left_out_by_asking_for_an_order():
    noise = np.random.default_rng(1).normal(0, 1e-3, EVEN.size)
    drive = ss.drives.Recorded.from_samples(EVEN, velocity=TRUE.velocity(EVEN) + noise, period=T, order=3)
    assert drive.order == 3
    assert drive.velocity(EVEN) == pytest.approx(TRUE.velocity(EVEN), abs=5 * 1e-3 * math.sqrt(7 / 400))  # 7 numbers from 400


def test_a_copy_of_a_record_with_other_numbers_has_no_remark():
    drive = ss.drives.Recorded.from_samples(EVEN, position=TRUE.position(EVEN), period=T)
    assert drive.notes and drive.replace(period=0.04).notes is None


def bad(**changes):
    return lambda: ss.drives.Recorded.from_samples(**{"t": EVEN, "velocity": TRUE.velocity(EVEN), "period": T, **changes})


@each_row(
    ("make", "says"),
    [
        (bad(period=None), "period = None; allowed is the period of the record"),
        (bad(period=0.9 * T), "does not repeat with period"),
        (bad(velocity=TRUE.velocity(EVEN) * np.exp(-EVEN * 20)), "does not repeat"),
        (bad(velocity=None, position=0.1 * EVEN, t=EVEN), "does not repeat"),
        (bad(velocity=None, t=EVEN[:100], position=0.1 * EVEN[:100]), "does not repeat"),
        (bad(velocity=TRUE.velocity(EVEN) + 0.05), "mean of velocity .* take out the offset"),
        (bad(t=EVEN[:80], velocity=TRUE.velocity(EVEN[:80])), "lasts 0.016 s and its period is 0.02 s"),
        (bad(t=np.delete(EVEN, range(40, 50)), velocity=TRUE.velocity(np.delete(EVEN, range(40, 50)))), r"a gap of 0.0022 s after t\[39\]"),
        (bad(velocity=np.where(np.arange(400) == 17, np.nan, TRUE.velocity(EVEN))), r"velocity\[17\] = nan \(1 of 400"),
        (bad(t=EVEN[::-1]), "ascending instants"),
        (bad(velocity=TRUE.velocity(EVEN)[:-1]), "as many of one as of the other"),
        (bad(velocity=np.zeros(400)), "velocity is constant"),
        (bad(position=TRUE.position(EVEN)), "exactly one of position, velocity and acceleration; got position, velocity"),
        (bad(order=60), "an order up to 49"),
        (bad(tolerance=0.0), "tolerance = 0.0"),
        (bad(t=EVEN[::50], velocity=TRUE.velocity(EVEN[::50])), "samples in a period"),
        (bad(velocity="fast"), "allowed is a list of numbers"),
    ],
)  # fmt: skip
def test_a_record_that_cannot_be_used_is_refused_with_the_reason(make, says):
    with pytest.raises(ss.InputError, match=says):
        make()


# on a robot -------------------------------------------------------------------------------------------------------


def rig(drive, mu_plus=PLUS, mu_minus=MINUS, **more):
    """A robot of one kilogram."""
    return ss.Robot(body_mass=1 - MU, inner_mass=MU, drive=drive, friction=ss.Coulomb(mu_plus=mu_plus, mu_minus=mu_minus), **more)


@every_drive
def test_a_robot_takes_every_drive(drive):
    robot = rig(drive)
    assert robot.period == drive.period
    assert robot.breaks == drive.breaks
    assert robot.velocity_scale == drive.velocity_scale
    assert robot.impulses == tuple((t, -robot.mass_ratio * jump) for t, jump in drive.jumps)
    assert robot.free_velocity == drive.velocity_scale * robot.mass_ratio


def test_a_harmonic_robot_has_the_numbers_it_always_had():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4)
    assert robot.velocity_scale == robot.drive.amplitude * robot.drive.omega
    assert robot.free_velocity == robot.drive.amplitude * robot.drive.omega * robot.mass_ratio
    assert robot.load(0.1, 0.0) == robot.total_mass * robot.gravity
    assert robot.impulses == () and robot.breaks == ()


def test_a_drive_of_ones_own_needs_a_period_and_a_motion():
    @dataclasses.dataclass(frozen=True)
    class Own:
        period: float = 0.5

        def position(self, t):
            return 1e-3 * np.sin(4 * np.pi * t)

        def velocity(self, t):
            return 4e-3 * np.pi * np.cos(4 * np.pi * t)

        def acceleration(self, t):
            return -16e-3 * np.pi**2 * np.sin(4 * np.pi * t)

    robot = rig(Own())
    assert robot.velocity_scale == pytest.approx(4e-3 * np.pi)  # the velocity at the start of the period is the largest
    assert robot.impulses == () and robot.breaks == ()
    with pytest.raises(ss.InputError, match="an object with position, velocity, acceleration, period"):
        rig(object())
    bare = type("Bare", (), {name: getattr(Own, name) for name in ("position", "velocity", "acceleration", "period")})
    with pytest.raises(ss.InputError, match="not a dataclass; write @dataclass"):
        rig(bare())


@each_row(
    "drive, published",
    [
        (ss.drives.TwoPhase(stroke=0.01, u1=0.1, u2=0.1), 0.000470057764),
        (ss.drives.TwoPhase(stroke=0.01, u1=0.05, u2=0.4), 0.003305),
        (ss.drives.TwoPhase(stroke=0.01, u1=0.4, u2=0.05), None),
        (ss.drives.ThreePhase(u1=0.3, w1=10.0, w2=60.0, w3=12.0), 0.015990705704),
        (ss.drives.ThreePhase(u1=0.3, w1=17.0, w2=90.0, w3=18.0), None),
        (ss.drives.ThreePhase(u1=0.3, w1=4.0, w2=1e3, w3=18.0), None),
        (ss.drives.ThreePhase(u1=0.3, w1=12.0, w2=1e3, w3=18.0), None),
    ],
    ids=["rests twice", "slides on", "slides back", "three phases", "three, stronger", "a quick return", "slides into the next push"],
)  # fmt: skip
def test_mean_velocities_on_paper_are_those_of_the_arcs(drive, published):
    formula = (two_phase if isinstance(drive, ss.drives.TwoPhase) else three_phase)(drive, MU, PLUS, MINUS)
    twin = Coasting(drive, MU, PLUS * G, MINUS * G).mean_velocity()
    assert formula == pytest.approx(twin, abs=1e-13)  # the twin's instants are good to 1e-16 s at velocities below 1 m/s
    if published is not None:
        assert formula == pytest.approx(published, abs=1e-11)


@each_row("name", ["harmonic", "multiharmonic", "twophase", "threephase", "bangbang", "trapezoid", "recorded"])
def test_every_example_moves_the_robot_forwards_and_its_reverse_the_mirrored_one_back(name):
    drive = ss.drives.DRIVES[name].example()
    there = Coasting(drive, MU, 0.15 * G, 0.21 * G).mean_velocity(4)
    assert there > 1e-4
    assert Coasting(ss.drives.Reversed(drive), MU, 0.21 * G, 0.15 * G).mean_velocity(4) == pytest.approx(-there, rel=1e-9)


def test_one_of_the_two_phase_formulas_always_holds():
    rng = np.random.default_rng(3)
    for u1, u2, plus, minus in rng.uniform(0.05, 0.5, (10, 4)):
        drive = ss.drives.TwoPhase(stroke=0.02, u1=u1, u2=u2)
        twin = Coasting(drive, MU, plus * G, minus * G).mean_velocity(20)
        assert two_phase(drive, MU, plus, minus) == pytest.approx(twin, abs=1e-13)


def test_the_three_phase_drive_with_an_instant_return():
    # as the phase of -w2 becomes a jump; what is left of it is of the order g/w2
    stroke, w = 0.00525, MINUS * G / MU
    limit = MINUS / (MINUS + PLUS) * math.sqrt(2 * MU * stroke * MINUS * G)
    drive = ss.drives.ThreePhase(stroke=stroke, w1=w, w2=1e13, w3=w)
    assert three_phase(drive, MU, PLUS, MINUS) == pytest.approx(limit, rel=1e-11)
    assert Coasting(drive, MU, PLUS * G, MINUS * G).mean_velocity() == pytest.approx(limit, rel=1e-11)


def test_paper_has_no_answer_where_the_three_phase_body_slides_back():
    assert math.isnan(three_phase(ss.drives.ThreePhase(u1=0.3, w1=30.0, w2=60.0, w3=12.0), MU, PLUS, MINUS))
    assert three_phase(ss.drives.ThreePhase(u1=0.3, w1=5.0, w2=5.0, w3=5.0), MU, PLUS, MINUS) == 0
    with pytest.raises(ss.InputError, match="allowed is a TwoPhase"):
        two_phase(ss.Harmonic.example(), MU, PLUS, MINUS)


def test_a_vertical_vibration_changes_the_load_by_the_inner_mass_times_its_acceleration():
    drive = ss.drives.VerticalVibration(ss.Harmonic(amplitude=5e-4, omega=200.0), amplitude=1e-4, phase=math.pi)
    robot = rig(drive, track=ss.Incline(tilt=0.1))
    t, h = np.linspace(0, 0.1, 11), 1e-5
    rate = (drive.vertical_position(t + h) - 2 * drive.vertical_position(t) + drive.vertical_position(t - h)) / h**2
    assert robot.load(t, 0.0) == pytest.approx(G * math.cos(0.1) + MU * rate, rel=1e-5)
    assert robot.notes == []
    assert "takes the body off the track: its load falls to -" in rig(drive.replace(amplitude=4e-3)).notes[0]


def test_vertical_vibration_drives_a_robot_whose_friction_is_the_same_both_ways():
    # Fast oscillation -a cos t under small friction: V is where friction has no mean over a period (averaging),
    # arcsin(V/a) = b sin(phi) sqrt(1 - (V/a)^2); b = .5, phi = pi/2 gives V/a = .435130859037
    b, phase, a = 0.5, math.pi / 2, 1.0
    horizontal = ss.Harmonic(amplitude=a / MU, omega=1.0)  # body: a sin t
    robot = rig(ss.drives.VerticalVibration(horizontal, amplitude=b * G / MU, phase=phase + math.pi), mu_plus=1e-3, mu_minus=1e-3)
    t = (np.arange(200_000) + 0.5) * 2 * np.pi / 200_000
    assert robot.acceleration(t, 0.0, 0.0, 0.0) == pytest.approx(a * np.sin(t), abs=1e-13)
    V = 0.435130859037
    assert math.asin(V / a) == pytest.approx(b * math.sin(phase) * math.sqrt(1 - V**2), abs=1e-12)
    friction = np.where(V - a * np.cos(t) > 0, 1, -1) * robot.load(t, 0.0)
    assert np.mean(friction) / G == pytest.approx(0.0, abs=2e-5)  # two switches, each off by half an instant of 1/200 000


def test_a_reversed_drive_turns_the_jumps_and_keeps_the_vertical_motion():
    drive = ss.drives.VerticalVibration(ss.drives.TwoPhase.example(), amplitude=1e-5)
    back = ss.drives.Reversed(drive)
    assert back.jumps == tuple((t, -jump) for t, jump in drive.jumps)
    assert back.vertical_acceleration(0.01) == drive.vertical_acceleration(0.01)
    assert ss.drives.Reversed(ss.drives.TwoPhase.example()).vertical_acceleration is None


BODY = "[robot]\nbody_mass = 0.06\ninner_mass = 0.01\n[robot.friction]\nkind = 'coulomb'\nmu_plus = 0.1\nmu_minus = 0.2\n"
WAYS = [  # a drive as a file may give it, and the same in Python
    ("kind = 'harmonic'\namplitude = 1e-3\nfrequency = 30.0", ss.Harmonic(amplitude=1e-3, frequency=30.0)),
    ("kind = 'multiharmonic'\namplitudes = [1e-3]\nfrequency = 30.0", ss.MultiHarmonic(amplitudes=(1e-3,), frequency=30.0)),
    ("kind = 'twophase'\nu1 = 0.05\nt1 = 0.02\nt2 = 0.01", ss.drives.TwoPhase(u1=0.05, t1=0.02, t2=0.01)),
    (
        "kind = 'trapezoid'\nu1 = 0.1\nu2 = 0.1\nramp = 1e-3\nfrequency = 10.0",
        ss.drives.Trapezoid(u1=0.1, u2=0.1, ramp=1e-3, frequency=10.0),
    ),
]


@each_row(("text", "drive"), WAYS)
def test_a_file_takes_what_the_constructor_takes(text, drive):
    assert ss.Robot.from_toml(f"{BODY}[robot.drive]\n{text}\n").drive == drive
    around = f"{BODY}[robot.drive]\nkind = 'reversed'\n[robot.drive.drive]\n{text}\n"
    assert ss.Robot.from_toml(around).drive == ss.drives.DRIVES["reversed"](drive)


def test_a_file_takes_nothing_that_the_constructor_does_not_take():
    with pytest.raises(ss.InputError, match=r"robot\.drive\.frequency is not known; known: stroke, u1, u2, t1, t2"):
        ss.Robot.from_toml(f"{BODY}[robot.drive]\nkind = 'twophase'\nstroke = 1e-3\nu1 = 0.05\nu2 = 0.2\nfrequency = 30.0\n")
    with pytest.raises(ss.InputError, match=r"robot\.drive: give exactly one of omega .* got both"):
        ss.Robot.from_toml(f"{BODY}[robot.drive]\nkind = 'harmonic'\namplitude = 1e-3\nfrequency = 30.0\nomega = 3.0\n")


@each_row(("W", "V"), [(60.0, 0.043993752547554), (200.0, None)])
def test_the_verge_gait_is_as_fast_as_its_formula_and_faster_than_three_phases(W, V):
    drive = ss.drives.Pieces.verge(acceleration=W, stroke=0.01, mass_ratio=MU, mu_plus=PLUS, mu_minus=MINUS)
    p = MINUS / (PLUS + MINUS)
    told = p**2 * drive.period * (MU**2 * W**2 - (PLUS * G) ** 2) / (4 * MU * W)
    if V is not None:
        assert (told, drive.period) == (pytest.approx(V, abs=1e-14), pytest.approx(0.05915466243, abs=1e-11))
    found = ss.mean_velocity(ss.solve(rig(drive), periods=20, settle=10))
    assert found == pytest.approx(told, abs=1e-12)
    assert drive.stroke == pytest.approx(0.01, rel=1e-12)


def test_pieces_that_do_not_close_say_what_would():
    with pytest.raises(ss.InputError, match=r"changes by 0.1 m/s.*type accelerations\[1\] = -10"):
        ss.drives.Pieces(durations=(0.02, 0.01), accelerations=(5.0, 0.0))
    with pytest.raises(ss.InputError, match="2 durations and 3 accelerations"):
        ss.drives.Pieces(durations=(0.02, 0.01), accelerations=(5.0, -5.0, 0.0))
    with pytest.raises(ss.InputError, match=r"durations\[1\] = -0.01"):
        ss.drives.Pieces(durations=(0.02, -0.01), accelerations=(5.0, -5.0))


def test_a_sawtooth_is_two_phases_by_their_durations():
    saw, two = ss.drives.Sawtooth(stroke=0.01, rise=0.2, fall=0.025), ss.drives.TwoPhase(stroke=0.01, t1=0.2, t2=0.025)
    t = np.linspace(0.0, 0.5, 101)
    assert np.array_equal(saw.velocity(t), two.velocity(t)) and saw.jumps == two.jumps
    V = ss.mean_velocity(ss.solve(rig(saw), periods=20))
    assert V == ss.mean_velocity(ss.solve(rig(two), periods=20)) == pytest.approx(0.003305, abs=1e-11)


@each_row("share", [6e-13, 1e-13])
def test_a_piece_of_hardly_any_time_changes_hardly_anything(share):
    """Its break and the next one count as one instant, behind which the last piece holds: V is as if the first were longer by so little."""
    T, first, second = 0.05, -13.55, -39.9

    def V(short: float) -> float:
        durations = (6e-4, short, T)
        last = -(first * durations[0] + second * short) / T
        drive = ss.drives.Pieces(durations=durations, accelerations=(first, second, last))
        robot = ss.Robot(body_mass=0.87, inner_mass=0.13, drive=drive, friction=ss.Coulomb(0.15, 0.25))
        return ss.mean_velocity(ss.solve(robot, periods=20, settle=2, keep="summary"))

    assert V(share * T) == pytest.approx(V(1e-11 * T), rel=1e-6)
