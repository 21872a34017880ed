"""Pictures of runs: what is drawn, not how it looks."""

from __future__ import annotations

from dataclasses import dataclass

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
import pytest

import stickslip as ss
from every import DRY, Capsule, every_machine
from runs import coulomb_run, lugre_run


@pytest.fixture(scope="module")
def run():
    """Type I: two rests in each period."""
    return coulomb_run(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, law="coulomb"), 20)


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


def test_velocity_shows_the_last_periods_with_prefixes_and_rests(run):
    ax = ss.plot.velocity(run, periods=3)
    assert ax.get_ylabel() == "velocity $v$ (mm/s)" and "(ms)" in ax.get_xlabel()
    line = ax.lines[-1]
    assert line.get_xdata()[-1] == pytest.approx(3e3 * run.period_time)
    # two grids of 400 points per period miss a maximum by at most (2 pi / 400)^2 / 8 = 3e-5 of the amplitude
    assert line.get_ydata().max() == pytest.approx(1e3 * run.v[run.t > run.window[0]].max(), rel=1e-4)
    rests = sum(p.get_width() for p in ax.patches)
    assert rests == pytest.approx(3e3 * run.period_time * ss.motion(run).stick_fraction, rel=1e-9)


def test_phase_takes_the_drift_out_and_closes(run):
    ax = ss.plot.phase(run)
    s, v = ax.lines[1].get_data()
    assert s[-1] == pytest.approx(s[0], abs=1e-9 * np.ptp(s)) and v[-1] == pytest.approx(v[0], abs=1e-9 * np.ptp(v))
    assert len(ax.lines[2].get_xdata()) == 2  # the strobe point, at both ends of the period


def test_several_runs_share_the_axes_and_get_a_legend(run):
    ax = ss.plot.velocity([run, run], labels=["one", "two"])
    assert [t.get_text() for t in ax.get_legend().get_texts()] == ["one", "two", "one sticks"]
    with pytest.raises(ss.InputError, match="one for each run"):
        ss.plot.phase([run, run], labels=["one"])


def test_forces_show_friction_between_its_limits(run):
    ax = ss.plot.forces(run)
    limits = [line.get_ydata()[0] for line in ax.lines[:2]]
    R = ax.lines[-1].get_ydata()
    assert limits[0] * (1 + 1e-9) <= R.min() and R.max() <= limits[1] * (1 + 1e-9)


def test_a_dynamic_law_is_shaded_by_the_rule_of_motion():
    run = lugre_run(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4), 8, rtol=1e-5)
    for ax in (ss.plot.velocity(run), ss.plot.forces(run), ss.plot.phase(run)):
        ax.figure.canvas.draw()
    fraction = sum(p.get_width() for p in ss.plot.velocity(run, periods=2).patches) / (2e3 * run.period_time)
    assert fraction == pytest.approx(ss.motion(run).stick_fraction, rel=1e-6)


def test_the_caller_keeps_axes_and_settings(run):
    before = dict(matplotlib.rcParams)
    ax = plt.subplots()[1]
    assert ss.plot.velocity(run, ax=ax) is ax
    assert dict(matplotlib.rcParams) == before


def test_what_is_no_run_is_refused():
    with pytest.raises(ss.InputError, match="Trajectory"):
        ss.plot.velocity(3.0)


# what nothing drives -------------------------------------------------------------------------------------------------


def belt(**more):
    law = ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)
    return ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=law, **more)


def test_a_limit_cycle_is_a_closed_curve_of_displacement_and_velocity():
    cycle = ss.periodic_orbit(belt())
    ax = ss.plot.phase(cycle.run)
    x, v = ax.lines[1].get_data()
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("displacement $x$ (mm)", "velocity $v$ (mm/s)")
    assert x[-1] == pytest.approx(x[0], rel=1e-9) and v[-1] == pytest.approx(v[0], abs=1e-9 * np.ptp(v))
    assert v.max() == pytest.approx(100.0) and ax.get_legend() is None  # it rides the belt; no strobe points


def test_a_pulled_mass_is_drawn_from_its_spring_and_as_long_as_asked():
    run = ss.solve(ss.PulledMass(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)), duration=40.0)
    cycle = 7.6112592541013  # s, analysis.oscillators.belt_period
    assert np.ptp(ss.plot.phase(run, duration=cycle).lines[1].get_xdata()) < 600  # mm: no drift of 0.1 m/s
    assert ss.plot.velocity(run).get_xlim() == (0.0, 40.0) and ss.plot.forces(run).get_xlabel() == "time $t$ (s)"
    ax = ss.plot.velocity(run, duration=cycle)
    assert ax.get_xlim()[1] == pytest.approx(cycle) and "t - 32.3887$ s" in ax.get_xlabel()
    assert [t.get_text() for t in ax.get_legend().get_texts()] == ["sticks"]
    with pytest.raises(ss.InputError, match=r"periods = 3, but PulledMass has no drive period; type duration=10.0"):
        ss.plot.velocity(run, periods=3)


def test_bands_and_circles_are_named(run):
    assert [t.get_text() for t in ss.plot.velocity(run).get_legend().get_texts()] == ["sticks"]
    assert [t.get_text() for t in ss.plot.phase(run).get_legend().get_texts()] == ["start of a drive period"]


def test_driven_and_undriven_runs_do_not_share_axes(run):
    with pytest.raises(ss.InputError, match="some have none; draw them apart"):
        ss.plot.phase([run, ss.solve(belt(), duration=5.0)])


def test_branches_of_limit_cycles_are_drawn_by_their_amplitude():
    branch = ss.continuation(belt(), parameter="speed", start=0.08, stop=0.12)
    ax = ss.plot.continuation([branch])
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("speed of the belt or of the pull $u$ (mm/s)", "amplitude of the cycle (mm)")
    assert [t.get_text() for t in ax.get_legend().get_texts()] == ["limit cycle"]
    assert ax.lines[0].get_ydata()[0] == pytest.approx(1e3 * branch.orbits[0].amplitude)
    assert ss.plot.continuation(branch, observable="duration").get_ylabel() == "duration of the cycle (s)"
    still = ss.plot.continuation(branch, observable="mean_velocity")
    assert still.get_ylabel() == "mean velocity $V$ (m/s)" and not np.nansum(abs(still.lines[0].get_ydata()))  # 0, not its rounding
    assert ss.plot.continuation(branch, observable="x").get_ylabel() == "turning point of the spring $x$ (mm)"


def _bars(ax):
    """Start and end of the bars of each row, by the word that stands for their colour in the legend."""
    named = {p.get_facecolor(): p.get_label() for p in ax.get_legend().get_patches()}
    found = {}
    for bars in ax.collections:
        (colour,) = bars.get_facecolor()
        for path in bars.get_paths():
            (left, low), (right, high) = path.get_extents().get_points()
            found.setdefault((round((low + high) / 2), named[tuple(colour)]), []).append((left, right))
    return found


def test_the_bars_of_contacts_are_the_stretches_of_their_motion():
    """Under a set-valued law and under one with inner states: parts of the last period as `motion` tells them."""
    for name in ("Chain, set-valued laws", "Chain, LuGre"):
        run = ss.solve(every_machine[name][0], periods=60)
        ax = ss.plot.contacts(run, periods=1)
        bars, whole = _bars(ax), ax.get_xlim()[1]
        for row, told in enumerate(ss.motion(run).contacts.values()):
            shares = {"forwards": told.forward_fraction, "backwards": told.backward_fraction, "sticks": told.stick_fraction}
            for word, share in shares.items():
                length = sum(b - a for a, b in bars.get((row, word), [])) / whole
                assert length == pytest.approx(share, abs=2e-5), (name, row, word)  # two periods of a run that settles


def test_stops_have_rows_of_their_own():
    @dataclass(frozen=True, eq=False)
    class Struck(Capsule):
        def stops(self):
            return {("hammer", "capsule"): ss.Stop(gap=self.gap, restitution=0.4)}

    soft, hard = (ss.solve(cls(300.0, DRY), periods=40) for cls in (Capsule, Struck))
    ax = ss.plot.contacts(soft)
    assert [label.get_text() for label in ax.get_yticklabels()] == ["capsule", "hammer-capsule"]
    start = soft.strobe_times[-1] - 3 * soft.period_time
    for a, b in _bars(ax)[1, "stop pressed"]:
        ends = soft.at(start + 1e-3 * np.array([a, b]))["x"]
        assert ends[:, 1] - ends[:, 0] == pytest.approx(soft.model.gap, rel=1e-9)  # bisected to rounding
    ax = ss.plot.contacts(hard)
    (marks,) = [line for line in ax.lines if line.get_label() == "hit"]
    start = hard.strobe_times[-1] - 3 * hard.period_time
    assert 1e-3 * marks.get_xdata() + start == pytest.approx([e.t for e in hard.events if e.kind == "hit" and e.t >= start], rel=1e-12)
    assert set(marks.get_ydata()) == {1}


def test_a_stop_to_the_ground_is_not_taken_for_the_contact_of_its_body():
    @dataclass(frozen=True, eq=False)
    class Walled(Capsule):
        def stops(self):
            return {("capsule", None): ss.Stop(gap=0.001, stiffness=2e3)}

    ax = ss.plot.contacts(ss.solve(Walled(300.0, DRY), periods=6), periods=6)
    assert [label.get_text() for label in ax.get_yticklabels()] == ["capsule", "capsule (stop)"]
    assert {row for row, word in _bars(ax) if word == "stop pressed"} == {1}


def test_a_contact_that_is_lost_has_a_cross():
    lifted = ss.drives.VerticalVibration(ss.Harmonic(amplitude=6e-4, omega=205.0), amplitude=2e-2, phase=3.44)
    run = ss.solve(every_machine["Robot"][0].replace(drive=lifted), periods=3)
    assert run.lost_contact
    (mark,) = [line for line in ss.plot.contacts(run).lines if line.get_label() == "contact lost"]
    assert mark.get_xdata()[0] == pytest.approx(ss.plot.contacts(run).get_xlim()[1])


def test_contacts_of_a_bench_that_nothing_drives_are_shown_over_its_run():
    run = ss.solve(belt(), duration=20.0)
    bars = _bars(ss.plot.contacts(run))
    share = {word: sum(b - a for a, b in of) / 20.0 for (_, word), of in bars.items()}
    lengths, modes = np.diff(run.pieces.t), run.pieces.mode[:, 0]
    assert share == pytest.approx({"sticks": lengths[modes == 0].sum() / 20.0, "backwards": lengths[modes == -1].sum() / 20.0}, rel=1e-6)
    with pytest.raises(ss.InputError, match="allowed is a Trajectory"):
        ss.plot.contacts([run, run])


def test_a_spectrum_of_several_is_drawn_one_by_one():
    run = ss.solve(every_machine["a machine of your own"][0], periods=12)
    lines = ss.dynamics.spectrum(run)
    with pytest.raises(ss.InputError, match=r"the dimension body; allowed is one; type ss\.plot\.spectrum\(lines\.sel\(body='head'\)\)"):
        ss.plot.spectrum(lines)
    assert ss.plot.spectrum(lines.sel(body="head")).get_yscale() == "log"
    assert ss.plot.spectrum(lines.sel(body="sledge")).get_yscale() == "linear"  # it never moves


def test_the_bars_of_energy_add_up_to_the_line_of_its_change():
    balance = ss.energy(ss.solve(ss.presets.two_modules(), periods=12))
    ax = balance.plot()
    assert ax.get_ylabel() == "work in a drive period (µJ)" and ax.get_xlabel() == "drive period"
    heights = sum(np.array([bar.get_height() for bar in bars]) * np.sign([bar.get_y() + 0.5 * bar.get_height() for bar in bars])
                  * np.sign([bar.get_height() for bar in bars]) for bars in ax.containers)  # fmt: skip
    (line,) = [line for line in ax.lines if line.get_label() == "change of energy"]
    assert heights == pytest.approx(line.get_ydata(), abs=1e-9 * max(abs(heights).max(), 1e6 * abs(balance.drive).max()))
    assert [text.get_text() for text in balance.plot().get_legend().get_texts()][-1] == "damping"


def test_the_balance_of_a_bench_that_nothing_drives_is_one_bar():
    machine = every_machine["BlockOnBelt"][0]
    assert ss.energy(ss.solve(machine, duration=4.0)).plot().get_ylabel() == "work (mJ)"


def test_a_bar_of_sensitivity_is_the_relative_derivative():
    found = ss.dynamics.sensitivity(
        ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb"), wrt=["drive.amplitude", "friction.mu_plus"]
    )
    bars = {round(bar.get_y() + 0.5 * bar.get_height()): bar.get_width() for bar in found.plot().patches}
    assert [bars[0], bars[1]] == pytest.approx(list(found.relative), rel=1e-12) and bars[0] > 0 > bars[1]
    rest = ss.dynamics.sensitivity(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=1e-4, law="coulomb"), wrt=["drive.amplitude"])
    with pytest.raises(ss.InputError, match="no number has a relative derivative"):
        rest.plot()


def test_a_dot_of_check_is_the_difference_of_a_method_and_what_was_skipped_has_none():
    found = ss.check(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.525e-4, law="coulomb"), periods=20, rk4_steps=(200,), scipy=False)
    ax = found.plot()
    dots = {float(y): float(x) for line in ax.lines for x, y in line.get_xydata()}
    compared = [judge for judge in found.judges if np.isfinite(judge.difference)]
    assert len(dots) == len(compared) and dots[0.0] == abs(compared[-1].difference) and ax.get_xscale() == "log"


def test_indices_are_drawn_with_their_intervals():
    from stickslip.inverse.optimisation.propagation import Indices

    found = Indices({"a": 0.7, "b": 0.1}, {"a": 0.9, "b": 0.2}, {"a": (0.6, 0.8), "b": (0.0, 0.2)}, {"a": (0.8, 1.0), "b": (0.1, 0.3)})
    ax = found.plot()
    assert [label.get_text() for label in ax.get_yticklabels()] == ["b", "a"]
    assert [list(bars.lines[0].get_xdata()) for bars in ax.containers] == [[0.1, 0.7], [0.2, 0.9]]


def test_a_law_that_the_data_do_not_support_is_hollow():
    from stickslip.inverse.identification.ranking import Ranked, Ranking

    rows = (Ranked("lugre", 3, 1.0, 0.0, 0.0, 0.9, float("nan")), Ranked("coulomb", 2, 2.0, 50.0, float("inf"), 0.1, float("nan")))
    ax = Ranking(rows, True, "lugre is supported", 100.0, 100, ("lugre",)).plot()
    bars = {bar.get_width(): bar.get_facecolor() for bar in ax.patches if bar.get_height() == 0.5}
    assert set(bars) == {0.0, 50.0} and bars[50.0] == (1.0, 1.0, 1.0, 1.0)


def test_a_parameter_that_is_not_determined_stands_at_the_right_edge():
    from stickslip.inverse.identification.designing import Design, PlannedExperiment

    one = PlannedExperiment(({"amplitude": 4e-4},), {"mu0": 0.018, "sigma0": float("inf")}, float("nan"), {})
    ax = Design({"mu0": 0.18, "sigma0": 4e5}, (one,), ()).plot()
    dots = {line.get_label(): float(line.get_xdata()[0]) for line in ax.lines}
    assert dots["mu0"] == pytest.approx(10.0) and dots["sigma0"] == ax.get_xlim()[1]
    assert [label.get_text() for label in ax.get_yticklabels()] == ["amplitude = 0.0004"]
