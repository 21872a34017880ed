"""Motion types, periods and mean velocities."""

from __future__ import annotations

import itertools
from types import SimpleNamespace

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from runs import coulomb_run, lugre_run, unit_robot
from stickslip.analysis.motion import threshold_table
from stickslip.analysis.steady import period_number
from stickslip.models.state_layout import StateLayout
from stickslip.results.segments import intervals_of, type_of
from stickslip.results.steadiness import steadiness_of_run

TRUTH = {  # TRUTH section 2: (alpha+, alpha-) -> type, pattern, mean of w, lengths in the order of the pattern
    "T7": ((0.5, 1.2), "II", "+0", 0.201452203333669, (0.5241295584, 0.4758704416)),
    "T8": ((0.7, 0.9), "I", "+0-0", 0.0615227380297986, (0.3890396524, 0.1657688566, 0.2168745967, 0.2283168943)),
    "T9": ((0.4, 0.8), "III", "+-0", 0.269172787549942, (0.5891171251, 0.3047022137, 0.1061806613)),
    "T10": ((0.4, 0.5), "IV", "+-", 0.122475359974498, (0.5555555556, 0.4444444444)),
}


@pytest.fixture(scope="module", params=TRUTH, ids=list(TRUTH))
def known(request):
    alphas, *expected = TRUTH[request.param]
    return coulomb_run(unit_robot(*alphas), 200), *expected


def test_the_known_cases(known):
    run, kind, pattern, mean, lengths = known
    m = ss.motion(run)
    assert (m.type, m.pattern, m.period, m.direction) == (kind, pattern, 1, 1)
    assert [length for _, length, _ in m.intervals] == pytest.approx(lengths, abs=1e-10)  # as many digits as TRUTH prints
    assert ss.mean_velocity(run) == pytest.approx(mean, rel=1e-12)
    assert m.stick_fraction + m.forward_fraction + m.backward_fraction == pytest.approx(1, abs=1e-12)
    assert (m.slip_ratio, m.dwell, m.twin) == (None, None, kind)


def test_a_mirrored_robot_does_the_mirrored_motion(known):
    run, kind, _, mean, _ = known
    law = run.model.friction
    mirrored = coulomb_run(unit_robot(law.mu_minus, law.mu_plus), 200)
    m = ss.motion(mirrored)
    assert (m.type, m.direction) == (kind, -1)
    assert ss.mean_velocity(mirrored) == pytest.approx(-mean, rel=1e-12)


def test_starts_of_intervals_are_drive_phases(known):
    """A slip that follows rest starts when sin(tau) reaches break-away."""
    run, m = known[0], ss.motion(known[0])
    for (_, _, before), (start, _, sign) in zip((m.intervals[-1], *m.intervals[:-1]), m.intervals, strict=True):
        if before == 0:
            limit = run.model.friction.mu_plus if sign > 0 else -run.model.friction.mu_minus
            assert np.sin(2 * np.pi * start) == pytest.approx(limit, abs=1e-10)


def test_rest_has_a_margin_and_no_direction():
    m = ss.motion(coulomb_run(unit_robot(1.1, 1.25), 4))
    assert (m.type, m.pattern, m.period, m.direction, m.stick_fraction) == ("rest", "0", 1, 0, 1.0)
    assert m.margin == pytest.approx(1 - 1 / 1.1, abs=1e-12)


def test_the_margin_vanishes_at_the_border_of_types_I_and_II():
    """T5: the border is alpha- = 1. At e above it the offered force reaches 1/alpha-. At e below it there is a short backward slip:
    w' = s²/2 - e around the minimum of sin, so w returns to zero after 3 sqrt(2 e), with relative error of order e."""
    e = 1e-3
    above, below = (ss.motion(coulomb_run(unit_robot(0.7, alpha), 40)) for alpha in (1 + e, 1 - e))
    assert (above.type, below.type) == ("II", "I")
    assert above.margin == pytest.approx(1 - 1 / (1 + e), abs=1e-9)
    assert below.margin == pytest.approx(3 * np.sqrt(2 * e) / (2 * np.pi), rel=3 * e)


def test_the_margin_vanishes_at_the_border_of_types_III_and_IV():
    """T3 with k = 2: alpha+ = 0.284485276155916; at the reversal the offered force reaches break-away."""
    border = 0.284485276155916
    margins = [ss.motion(coulomb_run(unit_robot(border * s, 2 * border * s), 400)).margin for s in (0.99, 0.999, 0.9999)]
    assert margins[0] > 5 * margins[1] > 25 * margins[2] > 0


# ---- rules, on raw segments ----
def told(segments, period=1, net=1.0, dwell=0.03, **more):
    time, code = [s[0] for s in segments], [s[1] for s in segments]
    return {k: v[0] for k, v in type_of([len(time)], [time], [code], [period], [np.inf], [net], dwell, **more).items()}


@each_row("cut", range(4))
def test_the_pattern_does_not_depend_on_where_the_period_is_cut(cut):
    whole = [(0.4, 2), (0.2, 0), (0.25, -2), (0.15, 0)]
    turned = whole[cut:] + whole[:cut]
    halved = [(turned[0][0] / 2, turned[0][1]), *turned[1:], (turned[0][0] / 2, turned[0][1])]
    assert told(turned)["pattern"] == told(halved)["pattern"] == "+0-0"
    assert told(halved)["margin"] == pytest.approx(0.15)


def test_two_periods_have_one_canonical_pattern():
    whole = [(0.5, 2), (0.2, 0), (0.3, -2), (0.6, 2), (0.4, 0)]
    patterns = {told(whole[k:] + whole[:k], period=2)["pattern"] for k in range(5)}
    assert patterns == {"+0+0-"}
    assert told(whole, period=2)["motion_type"] == "other"
    assert told(whole, period=2)["margin"] == pytest.approx(0.2)


@each_row(
    ("segments", "kind", "pattern"),
    [
        ([(0.5, 2), (0.02, 1), (0.02, -1), (0.46, -2)], "III", "+0-"),  # together long enough to count as stuck
        ([(0.5, 2), (0.01, 1), (0.01, -1), (0.48, -2)], "IV", "+-"),  # too short: each goes with the sign of v
        ([(0.02, 1), (0.5, 2), (0.46, -2), (0.02, -1)], "III", "+-0"),  # the run goes across the end of the period
        ([(0.5, 1), (0.5, -1)], "presliding", "0"),
        ([(1.0, 2)], "other", "+"),
        ([(0.4, -2), (0.6, 0)], "II", "-0"),
        ([(0.2, 2), (0.3, 0), (0.2, 2), (0.3, 0)], "other", "+0+0"),
        ([(1.0, 0)], "rest", "0"),
    ],
)
def test_the_rules_of_dwell(segments, kind, pattern):
    found = told(segments)
    assert (found["motion_type"], found["pattern"]) == (kind, pattern)


@each_row("elastic", [0.025, 0.035])
def test_the_margin_of_a_rest_that_nearly_counts_is_how_far_it_lasts_from_dwell(elastic):
    assert told([(0.5, 2), (elastic, 1), (0.5 - elastic, -2)])["margin"] == pytest.approx(0.005)


def test_the_margin_vanishes_on_both_sides_of_a_border_under_a_dynamic_law():
    near = ss.sweep(ss.presets.piezo_rig, tilt_deg=1.7, amplitude=[0.565e-3, 0.569e-3])
    assert near.motion_type.values.tolist() == ["I", "III"]
    assert (near.margin < 1e-3).all() and (near.margin > 0).all()


def test_a_dynamic_law_that_does_not_move_rests():
    assert told([(1.0, 1)], moving=[False])["motion_type"] == "rest"


def test_too_many_segments_are_other_without_numbers():
    found = type_of([-1, 1], np.ones((2, 3)), np.zeros((2, 3), int), [1, 1], [np.inf, 0.2], [1.0, 0.0], 0.03)
    assert found["motion_type"][:].tolist() == ["other", "rest"] and np.isnan(found["margin"][0]) and found["margin"][1] == 0.2


def slow_intervals(segments, dwell):
    """The rule of the module, word by word, for one case: the slow twin of `intervals_of`."""
    n = len(segments)
    labels = []
    for i, (_, code) in enumerate(segments):
        if abs(code) != 1:
            labels.append((code > 0) - (code < 0))
            continue
        members = {i}
        for step in (1, -1):
            j = i
            while abs(segments[(j + step) % n][1]) == 1 and (j + step) % n not in members:
                j = (j + step) % n
                members.add(j)
        labels.append(0 if sum(segments[j][0] for j in members) >= dwell else code)
    merged = []
    for i, label in enumerate(labels):
        if i and label == labels[i - 1]:
            merged[-1][1] += segments[i][0]
        else:
            merged.append([label, segments[i][0]])
    if len(merged) > 1 and merged[0][0] == merged[-1][0]:
        merged[0][1] += merged.pop()[1]
    text = "".join({1: "+", 0: "0", -1: "-"}[label] for label, _ in merged)
    first = "+" if "+" in text else "-" if "-" in text else "0"
    turn = min((text[i:] + text[:i], i) for i in range(len(text)) if text[i] == first)
    return turn[0], [length for _, length in merged[turn[1] :] + merged[: turn[1]]]


def test_fast_intervals_equal_the_slow_ones():
    random = np.random.default_rng(7)
    kinds = itertools.product(range(1, 13), ([-2, -1, 1, 2], [-2, 0, 2]), range(40))
    cases = [list(zip(random.dirichlet(np.ones(n)).tolist(), random.choice(codes, n).tolist(), strict=True)) for n, codes, _ in kinds]
    K = max(map(len, cases))
    time, code = np.zeros((len(cases), K)), np.zeros((len(cases), K), int)
    for i, case in enumerate(cases):
        time[i, : len(case)], code[i, : len(case)] = zip(*case, strict=True)
    fast = intervals_of(np.array([len(c) for c in cases]), time, code, 0.1)
    for i, case in enumerate(cases):
        pattern, lengths = slow_intervals(case, 0.1)
        assert fast.pattern[i] == pattern
        found = fast.length[i][fast.sign[i] != 9].tolist()
        several = pattern.count(pattern[0]) > 1  # then two beginnings may be equally good
        assert (sorted(found) if several else found) == pytest.approx(sorted(lengths) if several else lengths, abs=1e-14)


# ---- periods ----
def strobes(values, rtol=1e-6, settle=0):
    v = np.asarray(values, float)
    model = SimpleNamespace(
        period=1.0,
        velocity_scale=1.0,
        load=1.0,
        total_mass=1.0,
        acceleration=lambda t, x, v, R: -R,
        contact_velocity=lambda v: v,
        friction=SimpleNamespace(rate=1, force=1),
    )
    times = np.arange(float(len(v)))
    x = np.cumsum(v)
    points = dict(strobe_v=v[:, None], strobe_z=None, _strobe_inner=np.empty((len(v), 1, 0)), strobe_times=times, strobe_x=x[:, None])
    pieces = SimpleNamespace(layout=StateLayout.of_one(inner=1))
    run = SimpleNamespace(
        **points, pieces=pieces, settle=settle, rtol=rtol, model=model, method="Rodas5P", known_period=None, period_time=1.0
    )
    run.with_axes = run
    run.steadiness = steadiness_of_run(run)
    return run


@each_row("p", [1, 2, 3, 8, 16])
def test_a_repeating_strobe_point_has_its_period(p):
    noise = 1e-6 * np.random.default_rng(1).standard_normal(101)
    assert period_number(strobes(np.sin(2.4 * (np.arange(101) % p)) + noise)) == p


def test_no_period_is_found_where_there_is_none():
    k = np.arange(101)
    assert period_number(strobes(np.sin(2 * np.pi * k * (np.sqrt(5) - 1) / 2))) is None
    assert period_number(strobes(1e-5 * k)) is None  # drifts


@each_row(("ratio", "found"), [(0.5, 1), (0.99, None), (0.999, None), (0.9999, None)])
def test_a_slow_transient_is_not_a_period(ratio, found):
    """The steps of these transients are below the tolerance at the end or everywhere; what is left of them is not."""
    assert period_number(strobes(1e-2 * ratio ** np.arange(101))) == found


def test_a_slow_period_doubling_transient_is_not_period_two():
    assert period_number(strobes(1e-2 * (-0.995) ** np.arange(101))) is None


@each_row("method", ["exact", "rk4", "radau", "lsoda", "bdf", "dop853"])
def test_a_curve_and_a_summary_tell_one_period(method):
    """Arcs that an integrator found are as near as its tolerance, whatever the law."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb")
    asked = dict(periods=12, settle=4, method=method, rtol=1e-4, **({"steps": 20000} if method == "rk4" else {}))
    assert ss.motion(ss.solve(robot, **asked)).period == ss.solve(robot, keep="summary", **asked).period == 1


@each_row("steps", [200, 500, 1000, 2000])
def test_a_curve_and_a_summary_tell_one_period_of_points_that_jitter(steps):
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb")
    asked = dict(periods=60, method="rk4", steps=steps)
    assert (ss.motion(ss.solve(robot, **asked)).period or 0) == ss.solve(robot, keep="summary", **asked).period


def test_the_mean_covers_whole_motion_periods():
    run = strobes([1.0, 3.0] * 10 + [1.0, 3.0], settle=4)
    assert ss.mean_velocity(run) == pytest.approx(2.0, rel=1e-15)


# ---- a dynamic law ----
@pytest.fixture(scope="module")
def lugre():
    """P2: Coulomb type III."""
    return lugre_run(ss.presets.piezo_rig(tilt_deg=2.7, amplitude=6.032e-4), 14, settle=8, rtol=1e-5)


def test_lugre_is_judged_by_thresholds(lugre):
    m = ss.motion(lugre)
    assert (m.period, m.direction, m.slip_ratio, m.dwell) == (1, 1, 0.75, 0.03)
    assert m.type in ("III", "IV") and abs(sum(length for _, length, _ in m.intervals) - 1) < 1e-12
    loose, strict = ss.motion(lugre, dwell=0.0), ss.motion(lugre, dwell=0.5)
    assert loose.stick_fraction > 0 and strict.pattern == "+-" and strict.stick_fraction == 0


def test_lugre_slips_where_its_bristle_has_yielded(lugre):
    """At each edge between elastic and slipping the elastic force is slip_ratio of its steady value (Eq. 2.6)."""
    m, law = ss.motion(lugre, slip_ratio=0.6, dwell=0.0), lugre.model.friction
    begin = lugre.strobe_times[-2]
    edges = [(begin + (start % 1) * lugre.period_time, sign) for start, _, sign in m.intervals if sign != 0]
    for t, sign in edges:
        at = lugre.at(t)
        assert sign * at["z"] * law.sigma0 / (law.coefficient(at["v"]) * lugre.model.load(t, 0.0)) == pytest.approx(0.6, abs=1e-6)


def test_thresholds_are_reported(lugre, known):
    rows = threshold_table(lugre)
    assert len(rows) == 35 and {"slip_ratio", "dwell", "type", "pattern"} == set(rows[0])
    assert next(r["type"] for r in rows if (r["slip_ratio"], r["dwell"]) == (0.75, 0.03)) == ss.motion(lugre).type
    assert len(threshold_table(known[0])) == 1


def test_bad_thresholds_are_all_reported(known):
    with pytest.raises(ss.InputError) as caught:
        ss.motion(known[0], slip_ratio=2.0, dwell=-1.0)
    assert len(caught.value.problems) == 2


# ---- with the package's own solvers ----
@each_row("law", ["coulomb", "coulomb-static", "lugre"])
def test_a_batch_and_single_runs_say_the_same(law):
    """Two ways from the same segments: observers in the kernel, and the dense output of a run."""
    amplitudes = np.linspace(2.5e-4, 9e-4, 14)
    many = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=amplitudes, law=law), periods=60, settle=40, keep="summary")
    for i, amplitude in enumerate(amplitudes):
        run = ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=float(amplitude), law=law), periods=60, settle=40)
        m = ss.motion(run)
        assert (many.motion_type[i], many.pattern[i], many.period[i], many.direction[i]) == (m.type, m.pattern, m.period, m.direction)
        # the LuGre kernel finds the slip ratio's crossings by its own interpolation, at steps of its own
        close = 1e-9 if law != "lugre" else 2e-3
        assert many.margin[i] == pytest.approx(m.margin, abs=close)
        assert many.stick_fraction[i] == pytest.approx(m.stick_fraction, abs=2 * close)
        assert many.mean_velocity[i] == pytest.approx(
            ss.mean_velocity(run), abs=1e-12 if law != "lugre" else 3e-6 * run.model.velocity_scale
        )


@pytest.mark.parametrize("incline", ["folded", "gravity"])
@pytest.mark.parametrize("law", ["coulomb", "coulomb-static"])
def test_the_closed_periodic_velocity_is_that_of_long_runs(law, incline):
    robots = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=np.array([0.0, 2e-4, 4e-4, 5e-4, 8e-4]), law=law, incline=incline)
    many = ss.solve(robots, periods=600, settle=400, keep="summary")
    assert ss.analysis.periodic_mean_velocity(robots) == pytest.approx(many.mean_velocity, rel=1e-12, abs=1e-17)


def test_the_periodic_velocity_of_a_dynamic_law_is_the_converged_one():
    """P1 and P2 of TRUTH 3, to the digits printed there and 5e-8 A mu omega."""
    robots = ss.presets.piezo_rig(tilt_deg=np.array([1.7, 2.7]), amplitude=np.array([5.525e-4, 6.032e-4]))
    assert ss.analysis.periodic_mean_velocity(robots) == pytest.approx([0.001741322, 0.003681683], abs=1e-9)


def test_the_twin_is_solved_when_asked_for():
    m = ss.motion(ss.solve(ss.presets.piezo_rig(tilt_deg=4.7, amplitude=4.564e-4), periods=60))
    assert (m.type, m.twin) == ("I", "II")  # P3: the paper's type is that of the Coulomb run
