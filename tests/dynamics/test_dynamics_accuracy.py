"""Special points carry their accuracy: it holds against closed answers and restarts from elsewhere, and no digit beyond it is told."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from scipy.optimize import brentq

import stickslip as ss
from dynamics.test_dynamics import BORDERS, by_ratio
from dynamics.test_dynamics_cycles import WEAK, belt
from stickslip.analysis.closed_form import border_iii_iv
from stickslip.dynamics.continuation.special_points.accuracy import Meeting, Special, certain


@pytest.mark.parametrize("case", BORDERS, ids=["II-I", "I-III", "III-IV k=2", "III-IV k=1", "II-III"])
def test_a_border_lies_within_its_accuracy_of_the_closed_one_from_both_sides(case):
    """2e-12: an arc shorter than 1e-13 of a period is not seen, which moves a border by as much."""
    make, parameter, start, stop, fixed, expected = case
    for begin, end in ((start, stop), (stop, start)):
        (border,) = ss.continuation(make, parameter=parameter, start=begin, stop=end, step=0.1, **fixed).special
        assert abs(border.value - expected()) <= border.accuracy <= 2e-12


def test_a_neimark_sacker_point_lies_within_its_accuracy():
    """Of a linear oscillator: at a = 0."""
    from dynamics.test_dynamics_special import Fed, W

    free = lambda a: ss.ForcedOscillator(1.0, 1.0, 1.0, W, Fed(a, 0.0))  # noqa: E731
    (point,) = ss.continuation(free, parameter="a", start=-0.2, stop=0.1, step=0.2).special
    assert abs(point.value) <= point.accuracy <= 1e-8


@pytest.mark.parametrize(
    ("period", "starts", "published"),
    [(2, ((5.6e-4, 5.5e-4), (5.7e-4, 5.45e-4)), 5.525802e-4), (1, ((8.6e-4, 8.3e-4), (8.35e-4, 8.55e-4)), 8.441508e-4)],
)
def test_flips_of_the_rig_are_the_same_from_other_places(period, starts, published):
    """mu0 = .04: period two from A = .5525802 to .8441508 mm; 5e-11 m is the rounding of these numbers."""
    rig = dict(tilt_deg=1.7, mu0=0.04, period=period)
    found = []
    for start, stop in starts:
        branch = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=start, stop=stop, step=0.1, **rig)
        found += [s for s in branch.special if s.kind == "flip"]
    assert len(found) == 2
    assert abs(found[0].value - found[1].value) <= found[0].accuracy + found[1].accuracy
    for flip in found:
        assert abs(flip.value - published) <= flip.accuracy + 5e-11 and flip.accuracy <= 1e-10
        assert flip.rounded == certain(flip.value, flip.accuracy)


WEAKER = ss.Stribeck(1.0, 1.0, 1.5, 1.5, v_s=0.4)


@pytest.mark.parametrize(
    ("law", "damping", "ranges"),
    [
        (WEAK, 0.3, ((0.62, 1.0, 0.04), (0.65, 0.7, 0.1))),
        (WEAKER, 0.2, ((0.3, 2.5, 0.04), (0.35, 2.2, 0.05))),
    ],
)
def test_the_speed_at_which_a_cycle_loses_its_rest_is_the_same_from_other_starts(law, damping, ranges):
    ends = []
    for start, stop, step in ranges:
        guess = dict(x=0.6, v=start)
        branch = ss.continuation(belt(law, start, damping=damping), parameter="speed", start=start, stop=stop, step=step, guess=guess)
        end, *more = branch.special
        assert end.kind == "type-border" and end.accuracy <= 1e-8
        assert not more or branch.orbits[-1].type == "slip", "it goes on as an unstable cycle without rest"
        ends.append(end)
    for a in ends:
        assert all(abs(a.value - b.value) <= a.accuracy + b.accuracy for b in ends)


def test_a_touch_under_a_bristle_law_is_known_far_better_than_words_for_the_motion_change():
    """The words are looked for to 1e-6 of the branch's range, 1e-11 m; the extreme of the slip is zero within 1e-13 m."""
    b = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=4.15e-4, stop=4.25e-4, tilt_deg=1.7, step=0.2)
    (grazing,) = (s for s in b.special if s.kind == "grazing")
    assert 1e-16 <= grazing.accuracy <= 1e-12
    beside = [ss.periodic_orbit(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=grazing.value + d)) for d in (-1e-12, 1e-12)]
    assert len(beside[0].events) != len(beside[1].events)
    assert f"grazing at {grazing.rounded};" in repr(b) or f"grazing at {grazing.rounded}; " in repr(b)


def test_curves_and_their_meetings_carry_their_accuracy():
    """The border of types III and IV at every k is closed; along its curve too."""
    make = lambda k, alpha_plus: by_ratio(k=k, alpha_plus=alpha_plus)  # noqa: E731
    b = ss.continuation(make, parameter="alpha_plus", start=0.32, stop=0.25, step=0.1, k=2.0)
    curve = ss.dynamics.special_curve(b, b.special[0], "k", stop=2.2, step=0.2)
    for (plus, k), (unsure, _) in zip(curve.values, curve.accuracy, strict=True):
        assert abs(plus - float(border_iii_iv(k))) <= unsure <= 1e-11
    assert np.array_equal(curve.points["alpha_plus_accuracy"].values, curve.accuracy[:, 0])


def test_no_digit_beyond_the_accuracy_is_told():
    point = Special("flip", 0.0468108467123, None, 3e-8)
    assert (point.rounded, repr(point)) == ("0.0468108", "<Special: flip at 0.0468108, accuracy 3e-08>")
    assert Meeting("triple-point", (0.21723362821, 1.0), None, (1e-6, 2e-15)).rounded == "(0.217234, 1)"
    kind, value, orbit = point
    assert (kind, value, orbit) == ("flip", 0.0468108467123, None)
    rng = np.random.default_rng(4)
    for value, accuracy in zip(rng.normal(size=200) * 10.0 ** rng.integers(-9, 9, 200), 10.0 ** rng.uniform(-12, 2, 200), strict=True):
        told = certain(value, accuracy)
        last = 10.0 ** -len(told.split("e")[0].partition(".")[2]) * 10.0 ** int(told.partition("e")[2] or 0)
        assert abs(float(told) - value) <= 5.0 * accuracy, "rounded to the next power of ten at most"
        assert told == "0" or last >= accuracy * (1 - 1e-6) or "." not in told or abs(value) / accuracy > 1e15


def test_the_table_of_a_branch_and_the_command_line_carry_it_too(capsys):
    from stickslip.show.cli import main

    b = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=5e-4, stop=6e-4, tilt_deg=1.7, law="coulomb")
    (told,) = json.loads(b.points.attrs["special"])
    assert told["accuracy"] == b.special[0].accuracy and f"type-border at {b.special[0].rounded}" in repr(b)
    words = ["bifurcation", "piezo_rig", "tilt_deg=1.7", "law=coulomb", "amplitude=5e-4..6e-4:2", "--follow"]
    assert main(words) == 0
    line = next(line for line in capsys.readouterr().out.splitlines() if "type-border" in line)
    value = float(line.split("amplitude = ")[1].split()[0])
    assert value == pytest.approx(b.special[0].value, abs=1e-12)


@pytest.mark.parametrize("start", [0.35, 1.1])
def test_a_branch_of_stick_slip_goes_back_as_the_unstable_cycle_that_only_slides(start):
    """Both meet at the border without a common tangent, and no cycle is left beyond it."""
    m = belt(ss.Stribeck(1.0, 1.0, 1.5, 1.5, v_s=0.1), start, damping=0.1)
    b = ss.continuation(m, parameter="speed", start=start, stop=1.2, step=0.02, guess={"x": 0.6, "v": start})
    turn = int(np.argmax(b.values))
    assert (np.diff(b.values[: turn + 1]) > 0).all() and (np.diff(b.values[turn:]) < 0).all()
    assert [o.pattern for o in b.orbits] == ["0-"] * (turn + 1) + ["-"] * (len(b.orbits) - turn - 1)
    assert all(o.stable == (k <= turn) for k, o in enumerate(b.orbits)) and b.orbits[turn + 1].multipliers[0] > 1.01
    (end,) = b.special
    assert abs(end.value - 1.154205) < 1e-6 and end.accuracy < 1e-8


def test_a_cycle_shrinks_to_steady_sliding_where_friction_takes_away_the_damping():
    """Steady sliding turns unstable where the damping is c = -dF/dv = v/v_s^2 exp(-(v/v_s)^2): there the unstable cycle is born."""
    b = ss.continuation(belt(WEAKER, 0.7, damping=0.2), parameter="speed", start=0.7, stop=1.2, guess={"x": 0.9, "v": 0.7})
    border, born = b.special
    assert border.kind == "type-border" and b.orbits[-1].type == "slip"
    closed = brentq(lambda v: v / 0.16 * math.exp(-v * v / 0.16) - 0.2, 0.5, 1.0, xtol=1e-15)
    assert born.kind == "hopf" and abs(born.value - closed) <= born.accuracy < 1e-6 and "shrinks" in b.ended
    told = [text.get_text() for text in ss.plot.continuation(b).get_legend().get_texts()]
    assert "birth of a limit cycle" in told
