"""Compiled = plain: every kind of robot by its kernel and by the solver in plain Python, which shares no line with it."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import stickslip as ss
from kinds import DRIVES, LAWS, TRACKS, robot
from stickslip.basics.batch import rows_of
from stickslip.engine import lanes, tableaux, trace
from stickslip.models.friction.law_adapter import adapted

COMPILED = [law for law in LAWS if not getattr(LAWS[law], "scalar_only", False)]
#: Those whose example runs are sensitive to what is special about them, whatever is drawn.
ALWAYS = {
    ("resetintegrator", "harmonic", "uphill"),  # z leaves zero with no speed, to the side that its flag does not hold
    ("karnopp", "trapezoid", "level"),  # at rest nothing moves that would keep steps short enough to see it break away
}


def drawn(seed=20261122):
    """Every law, drive and track, as few kernels as that takes: both sorts of law go through all drives, in an order that is drawn."""
    rng, found = np.random.default_rng(seed), set(ALWAYS)
    for dynamic in (False, True):
        laws = [law for law in COMPILED if adapted(LAWS[law]).dynamic == dynamic and law not in {case[0] for case in ALWAYS}]
        count = max(len(laws), len(DRIVES))
        columns = [np.resize(rng.permutation(names), count) for names in (laws, list(DRIVES), list(TRACKS))]
        found |= {tuple(map(str, case)) for case in zip(*columns, strict=True)}
    return found


COVERING = drawn()


def cases():
    """The covering set; everything else is slow."""
    for case in itertools.product(COMPILED, DRIVES, TRACKS):
        yield pytest.param(*case, id="-".join(case), marks=[] if case in COVERING else [pytest.mark.slow])


def instants(model, periods):
    """Instants at which the velocity of both runs is compared: none within a millionth of a period of a jump of v."""
    t = np.linspace(0.0, periods * model.period, 601)[1:-1]
    jumps = np.array([instant + k * model.period for instant, _ in model.impulses for k in range(periods + 1)])
    return t[np.all(abs(t[:, None] - jumps) > 1e-6 * model.period, axis=1)]


@pytest.mark.parametrize(("law", "drive", "track"), list(cases()))
def test_compiled_is_plain(law, drive, track):
    """Arcs are exact and the judge is held to 1e-12 a step; a law with inner states is held to 1e-9 a step by both.

    The judge steps over the corners of a table: between its tolerances 1e-11 and 1e-12 it differs from itself by 1e-8.
    """
    model = robot(law, drive, track)
    dynamic, corners = adapted(model.friction).dynamic, law == "tabulated"
    periods = 3 if (law, drive, track) in ALWAYS else 2  # after the second one only z of slow laws still changes
    run = ss.solve(model, periods=periods, rtol=1e-9)
    rtol = 1e-10 if dynamic and law != "karnopp" else 1e-12  # at a larger one it may step over a band
    judge = ss.solve(model, periods=periods, method="dop853", rtol=rtol)
    t = instants(model, periods)
    assert run.method in (("Rodas5P", "Taylor16", "Taylor18") if dynamic else ("exact",)) and judge.method == "dop853"
    assert run.at(t)["v"] == pytest.approx(judge.at(t)["v"], abs=(1e-7 if dynamic else 1e-7 if corners else 1e-9) * model.free_velocity)
    if not dynamic:
        assert [(e.kind, e.after) for e in run.events] == [(e.kind, e.after) for e in judge.events]
        assert [e.t for e in run.events] == pytest.approx([e.t for e in judge.events], abs=(1e-8 if corners else 1e-10) * model.period)


# one lane and sixteen ---------------------------------------------------------------------------------------------


def started(model, numbers):
    """A model's rows, and starts at rest: x, then the states."""
    table = rows_of(model, numbers)
    states = trace.trace(model).states
    return table, np.zeros((len(table), 1 + states))


@pytest.mark.parametrize(
    ("model", "tableau"),
    [
        (robot("gms", "harmonic").replace({"drive.amplitude": np.linspace(2e-4, 1.1e-3, 21)}), tableaux.RODAS5P),
        (robot("stribeck", "harmonic").replace({"drive.amplitude": np.linspace(2e-4, 1.1e-3, 21)}), None),
        (robot("coulomb", "twophase").replace({"drive.u2": np.linspace(0.06, 0.5, 21)}), None),
        (robot("tabulated", "verticalvibration").replace({"drive.drive.amplitude": np.linspace(2e-4, 1.1e-3, 21)}), None),
        (ss.ForcedOscillator(1.0, 1.0, np.linspace(0.5, 2.0, 21), 0.7, ss.Coulomb(0.3, 0.3, 0.35, 0.35), damping=0.02), None),
    ],
    ids=["a law with modes", "Taylor arcs", "impulses", "flags and a load that varies", "a mechanism"],
)  # fmt: skip
def test_one_lane_and_sixteen_give_the_same_bits(model, tableau):
    """21 cases: lanes take a second one while others are at their first."""
    wide, narrow = (lanes.kernel_of(model, tableau, record=one) for one in (False, True))
    table, start = started(model, wide.names)
    job = lanes.Job(12, 5, False, 1e-9, 0.75, 1e9)
    many, one = (lanes.run(kernel, table, start, job) for kernel in (wide, narrow))
    assert (wide.lanes, narrow.lanes) == (16, 1) and set(many.status) == {0}
    assert np.ptp(many.displacement) > 0 and np.ptp(many.accepted) > 0
    for name in ("displacement", "window", "v_max", "v_min", "end", "period", "seg_count", "seg_time", "seg_code", "accepted", "rejected"):
        assert np.array_equal(getattr(many, name), getattr(one, name)), name


def test_a_number_that_is_missing_is_another_kind():
    """A law without static coefficients, solved after one that has them: the same motion as with equal ones."""
    given = dict(mass=1.0, stiffness=2.0, speed=0.1, damping=0.5)
    with_static, without = (ss.BlockOnBelt(friction=ss.Coulomb(1.0, 1.0, **f), **given) for f in (dict(f_plus=1.0, f_minus=1.0), {}))
    ends = [ss.solve(bench, duration=5.0).at(5.0) for bench in (with_static, without)]
    assert ends[0]["x"] == pytest.approx(ends[1]["x"], rel=1e-12)
