"""What is measured on a record without a model: frequency, mean velocity, motion type, period, noise, friction of strokes."""

import numpy as np
import pytest

import stickslip as ss
from measured import CYLINDER, CYLINDER_COLUMNS, LDV, LOOPS, needs_data, path
from rows import each_row
from stickslip.basics.errors import InputError
from stickslip.records.measures import loop_friction, mean_velocity
from stickslip.records.overview import clipped, noise
from stickslip.records.tones import drive_frequency


def rig(noise=0.0, law="coulomb", amplitude=5e-4, tilt_deg=1.7, **more):
    return ss.virtual_rig(ss.presets.piezo_rig(tilt_deg=tilt_deg, amplitude=amplitude, law=law), noise=noise, **more)


@each_row("level", [1e-6, 1e-3])
def test_the_drive_frequency_is_refined_to_its_own_standard_error(level):
    found = [rig(level, seed=seed, phase=0.1 * seed).drive_frequency() for seed in range(20)]
    off = np.array([(f.value - 32.7) / f.error for f in found])
    # 20 normal numbers stay below 4.5 with probability 0.9999; the error is far below the line width 1/T = 1.6 Hz
    assert abs(off).max() < 4.5 and max(f.error for f in found) < 0.01


def test_the_drive_frequency_survives_gaps_and_uneven_sampling():
    rec = rig(1e-4, seed=1)
    c = rec["velocity"]
    keep = np.random.default_rng(0).random(len(c)) > 0.3
    part = ss.Record.of(c.t[keep], {"v [m/s]": c.values[keep]})
    assert part.drive_frequency().value == pytest.approx(32.7, rel=1e-4)


@each_row(("tilt_deg", "amplitude", "value"), [(1.7, 5.525e-4, 0.002014682), (4.7, 4.564e-4, 0.004000482), (5.7, 1.487e-3, 0.028688951)])
def test_the_mean_velocity_of_a_record_is_that_of_the_motion(tilt_deg, amplitude, value):
    """P1, P3 and P4, exact Coulomb; 100 samples per period see corners to about 1e-4 of the range."""
    rec = rig(0.0, amplitude=amplitude, tilt_deg=tilt_deg, phase=0.37, settle=300)
    assert rec.mean_velocity == pytest.approx(value, abs=2e-5)
    assert ss.Record.of(rec["velocity"].t, {"x [m]": _position(rec)}).mean_velocity == pytest.approx(rec.mean_velocity, abs=5e-6)


def _position(rec):
    t, v = rec["velocity"].t, rec["velocity"].values
    return np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))])


def test_the_error_of_the_mean_velocity_is_that_of_repeats():
    found = [mean_velocity(rig(1e-3, seed=seed), 32.7) for seed in range(40)]
    spread = np.std([f.value for f in found], ddof=1)
    # 40 repeats know a spread to 1/sqrt(80) = 11 %; three of these are allowed
    assert np.mean([f.error for f in found]) == pytest.approx(spread, rel=0.4)


TYPES = [(3e-4, 1.7, "II"), (4.2e-4, 1.7, "I"), (5.5e-4, 2.7, "III"), (8e-4, 1.7, "IV")]  # P6, between the borders of P9, and near P2


@each_row("amplitude, tilt_deg, type, level", [(*row, level) for level in (1e-6, 1e-4) for row in TYPES])
def test_the_motion_type_of_a_record_is_that_of_the_motion(amplitude, tilt_deg, type, level):
    rec = rig(level, amplitude=amplitude, tilt_deg=tilt_deg, seed=2, periods=40, samples=200)
    truth = ss.motion(ss.solve(ss.presets.piezo_rig(tilt_deg=tilt_deg, amplitude=amplitude, law="coulomb"), periods=100))
    found = rec.motion
    assert (found.type, found.pattern) == (type, truth.pattern) and found.decided and rec.motion_type == type
    # both ends of a rest are known to a bin of 1/400 period, and a polynomial of third degree is off by as much again
    assert abs(found.stick_fraction - truth.stick_fraction) < 0.012 * truth.pattern.count("0") + 0.001
    assert len(rec.stick_intervals()) == truth.pattern.count("0")


@each_row("level", [1e-4, 1e-3, 3e-3])
@pytest.mark.parametrize(("amplitude", "tilt_deg", "type"), [*TYPES, (5e-4, 1.7, "I"), (6e-4, 1.7, "III")])
def test_noise_leaves_the_motion_type_open_instead_of_making_it_wrong(amplitude, tilt_deg, type, level):
    """At 0.5 mm the shorter rest lasts 0.04 drive periods, at 0.6 mm the only one 0.022; the ranges are 1 to 40 mm/s.

    In the smallest one the noise hides the drive, too: its frequency must be given there.
    """
    frequency = 32.7 if amplitude == 3e-4 and level >= 1e-3 else None
    for seed in range(3):
        found = ss.motion(rig(level, amplitude=amplitude, tilt_deg=tilt_deg, seed=seed, phase=0.1 * seed), frequency=frequency)
        shortest = {5e-4: 0.040, 6e-4: 0.022}.get(amplitude, 1.0)
        allowed = {type} if shortest > found.dwell else {"III", "IV"}  # a rest shorter than that does not count
        assert allowed & set(found.candidates), found.verdict
        assert found.noise == pytest.approx(level, rel=0.1)  # 2000 samples know it to 2 %; corners add to a small one
        assert found.decided or (found.verdict.startswith("undecided between") and "the noise is" in found.verdict)
        assert found.type == " or ".join(found.candidates)


def test_clean_enough_records_decide_and_noisy_ones_do_not():
    """Type I with rests of 0.13 and 0.20 drive periods, velocities of 5 mm/s; and type IV with 20 mm/s."""
    assert rig(1e-4, amplitude=4.2e-4, seed=1).motion_type == "I"
    assert set(rig(3e-3, amplitude=4.2e-4, seed=1).motion.candidates) > {"I", "III"}
    assert {rig(1e-3, amplitude=8e-4, seed=seed).motion_type for seed in range(4)} == {"IV"}


def test_the_interval_of_a_rest_covers_its_length():
    """0.126 and 0.200 drive periods (exact Coulomb); 95 % of 2 x 20 intervals, each at least 33 with probability 0.995."""
    truth = ss.motion(ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=4.2e-4, law="coulomb"), periods=100))
    lengths = sorted(length for _, length, sign in truth.intervals if sign == 0)
    hits = 0
    for seed in range(20):
        rests = rig(3e-4, amplitude=4.2e-4, seed=seed).motion.rests
        assert len(rests) == 2
        hits += sum(r.least <= true <= r.most for r, true in zip(sorted(rests, key=lambda r: r.length), lengths, strict=True))
    assert hits >= 33


def test_period_two_is_seen():
    """P8: mu0 = .04 gives period two at A = .6 mm."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, mu0=0.04)
    assert ss.virtual_rig(robot, noise=1e-5, settle=150).period(32.7) == 2
    assert rig(1e-5).period() == 1


def test_the_spectrum_shows_amplitudes():
    t = np.arange(4096) / 4096
    lines, amplitude = ss.Record.of(t, {"v [mm/s]": 3 * np.sin(2 * np.pi * 64 * t)}).spectrum()
    assert lines[np.argmax(amplitude)] == pytest.approx(64, rel=1e-3) and amplitude.max() == pytest.approx(3e-3, rel=1e-2)


@each_row("level", [1e-5, 1e-3])
def test_the_noise_of_a_record_is_found(level):
    rec = rig(level, seed=4, samples=400, periods=25)
    assert noise(rec["velocity"].values) == pytest.approx(level, rel=0.1)  # 10 000 samples know it to 2 %; the signal adds its bends


def test_clipping_is_counted_and_rest_is_not():
    v = rig(0.0, samples=200)["velocity"].values
    assert clipped(np.clip(v, None, 0.6 * v.max())) > 100 and clipped(v) == 0
    assert clipped(rig(0.0, amplitude=3e-4, samples=200)["velocity"].values) == 0  # type II rests at its smallest velocity


def test_the_papers_relative_velocity_gives_the_drive():
    rec = rig(0.0, channels=("velocity", "absolute velocity")).relative_velocity()
    drive, w = rec["drive"], 2 * np.pi * 32.7
    assert np.allclose(drive.values, 5e-4 * w * np.cos(w * drive.t), atol=1e-9 * w)


def test_summary_names_what_matters():
    rec = rig(1e-4, seed=1)
    text = str(rec.summary)
    assert "SYNTHETIC" in text and "drive frequency 32." in text and rec.summary.lines[0].noise == pytest.approx(1e-4, rel=0.15)


def test_a_missing_channel_is_an_error_that_says_what_to_type():
    rec = ss.Record.of([0.0, 1.0, 2.0], {"LDV": [0.0, 1.0, 0.0]})
    with pytest.raises(InputError, match=r'roles=\{"LDV": "velocity"\}'):
        _ = rec.mean_velocity
    with pytest.raises(InputError, match="'LDV'"):
        rec["LDw"]


@needs_data
@each_row("which", CYLINDER)
def test_friction_of_the_cylinder_is_the_published_one(which):
    name, force = CYLINDER[which]
    found = loop_friction(ss.read(path(name), columns=CYLINDER_COLUMNS), between=(8e-3, 28e-3), least_speed=1e-3, start=8.0)
    assert found.value == pytest.approx(force, rel=0.03) and found.error < 0.03 * force


@needs_data
def test_the_loops_repeat_every_four_seconds():
    found = ss.read(path(LOOPS)).between(20, 60).drive_frequency()
    assert found.value == pytest.approx(0.25, abs=1e-5)


def test_a_callers_array_stays_the_callers():
    t = np.arange(20.0)
    rec, mine = ss.Record.of(t, {"v [m/s]": t}), np.ones(20)
    made = rec.derived("x [m]", mine, like="v")
    mine[0] = t[0] = 2.0
    assert made["x"].values[0] == 1.0 and made["v"].t[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        made["x"].values[0] = 3.0
    assert made["x"].t is rec["v"].t  # what nobody can write into is shared


@each_row("kind", ["noise", "step", "chirp", "one period"])
def test_no_drive_is_invented_where_nothing_repeats(kind, tmp_path, capsys):
    from stickslip.show.cli import main

    t = np.arange(5000) / 1000
    noise = np.random.default_rng(0).normal(size=5000)
    v = {"noise": noise, "step": (t > 2) + 1e-3 * noise, "chirp": np.sin(6 * np.pi * t**2), "one period": np.sin(0.4 * np.pi * t)}[kind]
    rec = ss.Record.of(t, {"v [m/s]": v})
    for measure in (rec.drive_frequency, lambda: rec.mean_velocity, lambda: rec.motion):
        with pytest.raises(ss.InputError, match=r"'v' is not periodic: its strongest line, .*; if it is, type frequency="):
            measure()
    assert rec.summary.frequency is None and "no drive frequency: 'v' is not periodic" in str(rec.summary)
    assert ss.mean_velocity(rec, frequency=1.0) == pytest.approx(v[:5000].mean(), abs=1e-3)
    assert main(["read", str(rec.save(tmp_path / "r.csv"))]) == 0
    assert "motion type" not in capsys.readouterr().out


def test_a_drive_that_is_slow_beside_the_samples_is_found():
    """The beginning of a record with very many samples may hold no whole period."""
    t = np.arange(200_000) / 1e6
    assert ss.Record.of(t, {"v [m/s]": np.sin(2 * np.pi * 33.3 * t)}).drive_frequency().value == pytest.approx(33.3, rel=1e-6)


@needs_data
def test_a_step_response_has_no_drive():
    rec = ss.read(path(LDV), units={"LDV": "m/s", "t": "s"})
    assert rec.summary.frequency is None and rec.between(0, 1e-4).summary.frequency is None


def loops():
    """A record with force and position only, and one gap."""
    t = np.delete(np.arange(400) / 100, slice(50, 60))
    columns = {"Normal [uN]": 5e6 + t, "Position [mm]": np.sin(2 * np.pi * t), "Friction [uN]": np.sign(np.cos(2 * np.pi * t))}
    return ss.Record.of(t, columns)


def test_a_part_has_the_notes_of_the_part(tmp_path):
    rec = ss.read(loops().save(tmp_path / "loops.csv"))
    gap = "1 gap in time: the longest is 0.11 s, after 0.49 s"
    assert gap in rec.notes and set(rec.between(0, 1).notes) == set(rec.notes) and gap not in rec.between(1, 2).notes


def test_no_channel_is_proposed_for_what_its_unit_is_not(tmp_path):
    rec = ss.read(place := loops().save(tmp_path / "loops.csv"))
    with pytest.raises(InputError, match="none of them is in a unit of velocity or angular velocity; take a record that has one"):
        rec["velocity"]
    with pytest.raises(InputError, match=r"'Normal' is in uN, a unit of force, and cannot be the velocity"):
        ss.read(place, roles={"Normal": "velocity"})
    forced = ss.read(place, units={"Normal": "m/s"}, roles={"Normal": "velocity"})
    assert any("'uN' of the file, of force, is replaced by 'm/s', of velocity" in note for note in forced.notes)
    assert not any("replaced" in note for note in ss.read(place, units={"Normal": "mN"}).notes)


def test_a_figure_that_cannot_be_drawn_costs_no_summary(tmp_path, capsys):
    from stickslip.show.cli import main

    place, figure = str(loops().save(tmp_path / "loops.csv")), tmp_path / "f.png"
    assert main(["read", place, "--figure", str(figure)]) == 0
    assert f"figure: spectrum of Position, written to {figure}" in capsys.readouterr().out and figure.is_file()
    bare = tmp_path / "bare.csv"
    bare.write_text("t,a\n" + "\n".join(f"{i},{i % 3}" for i in range(50)))
    assert main(["read", str(bare), "--figure", str(tmp_path / "g.png")]) == 0
    out = capsys.readouterr().out
    assert "50 values" in out and "figure: left out: the unit of " in out and not (tmp_path / "g.png").exists()


def test_a_transient_does_not_shift_the_frequency():
    """A body that starts from rest, 1 % of noise: 40 Hz within four standard errors, of which the whole record is eight away."""
    robot = ss.Robot(body_mass=0.06, inner_mass=0.01, drive=ss.Harmonic(6e-4, frequency=40.0), friction=ss.Coulomb(0.13, 0.21))
    rec = ss.virtual_rig(robot, noise=2e-4, seed=2, settle=0, periods=60, samples=500)
    found = rec.drive_frequency()
    assert abs(found.value - 40.0) < 4 * found.error < 1e-3
    whole = drive_frequency(rec)
    assert abs(whole.value - 40.0) > 4 * whole.error
    assert str(found).endswith(" ± 4e-05 Hz (in 'velocity')")


def test_a_settled_record_says_what_was_left_out():
    robot = ss.Robot(body_mass=0.06, inner_mass=0.01, drive=ss.Harmonic(6e-4, frequency=40.0), friction=ss.Coulomb(0.13, 0.21))
    rec = ss.virtual_rig(robot, noise=2e-4, seed=2, settle=0, periods=60, samples=100)
    kept = rec.settled()
    steady = ss.analysis.periodic_mean_velocity(robot)
    assert "differ from the later ones" in kept.notes[-1] and abs(kept.mean_velocity - steady) < 1e-5 < abs(rec.mean_velocity - steady)
    assert rec.settled(settle=0) is rec


def test_volts_ask_for_a_sensitivity():
    t = np.arange(400) / 4000
    rec = ss.Record.of(t, {"LDV [V]": np.sin(80 * np.pi * t)})
    with pytest.raises(ss.InputError, match=r'scale=\{"LDV": "100 mm/s/V"\}'):
        _ = rec.mean_velocity


def test_a_body_at_rest_is_said_to_be_at_rest():
    """Such records came from a chain, one module of which stood still: they ended in sentences on spectra and on bounds."""
    rec = ss.Record.of(np.arange(400) / 100, {"v [m/s]": np.zeros(400)})
    with pytest.raises(ss.InputError, match="'v' is 0 at all 400 samples: nothing moves, and no frequency can be read of it; measure"):
        rec.drive_frequency()
    for known in ({}, {"frequency": 5.0}):
        with pytest.raises(ss.InputError, match=r"'v'.* is 0 at all 400 samples: nothing moves"):
            ss.identify(rec, ss.presets.piezo_rig, free={"mu0": (0.05, 0.4)}, tilt_deg=1.7, amplitude=5e-4, law="coulomb", **known)


def test_a_servo_log_has_no_drive_and_turns_in_radians(tmp_path, capsys):
    from stickslip.show.cli import main

    t = np.arange(4000) / 500
    rows = "\n".join(f"{1e3 * a:.0f},{b:.3f},{c:.2f},31" for a, b, c in zip(t, np.sin(5 * t), 10 * np.cos(5 * t), strict=True))
    path = tmp_path / "servo.csv"
    path.write_text(f"time_ms,torque_Nm,vel_rpm,temp_C\n{rows}\n", encoding="utf-8")
    main(["read", str(path)])
    said = capsys.readouterr().out
    assert "frequency of the motion 0.7957" in said and "rad/s" in said and "m/s" not in said
    assert "temp_C=" not in said and "motion type" not in said  # a temperature is nobody's channel
