"""From files as loggers write them to friction, with what was decided and the Python that does the same."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest

import stickslip as ss
from bam_bench import chirp, pendulum, shown, sines, swung
from rows import each_row
from stickslip.inverse.logs.kinds import kinds_for
from stickslip.inverse.logs.plan import plan_of
from stickslip.records.candidates import candidate_unit

_COUNT = 2 * np.pi / 4096


def rig_file(path, backwards=2.4):
    """A rig as a German logger has it: a junk head, decimal commas, a gap, missing cells, a column of words; f = 3.4, mu = 2.4 N."""
    rng, t = np.random.default_rng(0), np.arange(0, 6, 0.004)
    x, v = 3.8e-3 * np.sin(4.4 * t), 3.8e-3 * 4.4 * np.cos(4.4 * t)
    F = np.where(v > 0, 2.4, -backwards) + np.sign(v) * np.exp(-((v / 8e-4) ** 2)) + rng.normal(0, 0.03, len(t))
    rows = ["Prüfstand 7;;;", "Datum;12.03.2026;;", "", "Zeit [ms];Weg [µm];Kraft [mN];Status"]
    for k in range(len(t)):
        if not 600 < k < 615:
            force = "" if k in (50, 51) else f"{1e3 * F[k]:.1f}"
            rows.append(f"{1e3 * t[k]:.1f};{1e6 * x[k]:.3f};{force};{'0x1F' if k % 97 == 0 else 'OK'}".replace(".", ","))
    path.write_text("\n".join(rows), encoding="latin-1")
    return path


def servo_file(path):
    """A servo with 4096 counts a turn, as its firmware logs it: units at the ends of names, and flags in hexadecimal."""
    rng, t = np.random.default_rng(1), np.arange(0, 8, 0.004)
    q, v = (sum(f(a, w, p) for a, w, p in ((1.1, 2.0, 0.3), (0.35, 5.3, 1.0))) for f in (_angle, _rate))
    a = -4.4 * np.sin(2 * t + 0.3) - 0.35 * 5.3**2 * np.sin(5.3 * t + 1.0)
    torque = 0.012 * a + 0.3 * np.sin(q) + 0.055 * np.sign(v) + 0.011 * v + 0.02 + rng.normal(0, 2e-3, len(t))
    rpm = (v + rng.normal(0, 0.01, len(t))) * 60 / (2 * np.pi)
    cells = zip(1e3 * t, np.degrees(_COUNT * np.round(q / _COUNT)), rpm, 1e3 * torque, strict=True)
    rows = [f"{ms:.1f},{deg:.4f},{rpm:.3f},{mNm:.3f},{31 + k // 900},0x{k % 4:02x}" for k, (ms, deg, rpm, mNm) in enumerate(cells)]
    path.write_text("\n".join(["# firmware 2.1.4", "time_ms,pos_deg,vel_rpm,torque_mNm,temp_C,flags", *rows]))
    return path


def _angle(a, w, p):
    return a * np.sin(w * np.arange(0, 8, 0.004) + p)


def _rate(a, w, p):
    return a * w * np.cos(w * np.arange(0, 8, 0.004) + p)


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    return ss.fit(rig_file(tmp_path_factory.mktemp("rig") / "rig.csv"), law="stribeck", starts=4)


@pytest.fixture(scope="module")
def servo(tmp_path_factory):
    return ss.fit(servo_file(tmp_path_factory.mktemp("servo") / "servo.log"), law="coulomb-viscous", starts=2)


def test_a_force_over_a_motion_is_a_rig_and_its_intervals_hold_the_truth(rig):
    assert rig.machine == "rig" and rig.supported
    for name, truth in {"mu": 2.4, "f": 3.4, "v_s": 8e-4}.items():
        low, high = rig.fit.interval(name, level=0.99)  # this draw has one of three at 1.96 standard errors
        assert low < truth < high, name
    assert "mu  = 2.4" in rig.report() and "column Status left out" in rig.report()
    assert "calibrate the gain of the sensor: with it known mu is" in rig.next[0] and '"gain": ("normal", 1.0, 0.001)' in rig.next[0]
    assert any("mu and f correlated" in said and "through the gain of the sensor" in said for said in rig.fit.warnings)


def test_a_torque_over_an_angle_is_a_joint_and_its_intervals_hold_the_truth(servo):
    assert servo.machine == "joint" and servo.supported
    for name, truth in {"inertia": 0.012, "gravity_torque": 0.3, "friction.mu": 0.055, "friction.viscous": 0.011}.items():
        low, high = servo.fit.interval(name, level=0.999)
        assert low < truth < high, name
    assert "N m s/rad" in servo.report() and " N m   95 %" in servo.report()


def test_the_python_of_a_fit_makes_the_same_numbers(rig, servo, capsys):
    for result in (rig, servo):
        made = {}
        exec(result.python, made)
        assert made["fit"].values == result.values and made["fit"].errors == result.fit.errors
    assert "Stribeck fitted" in capsys.readouterr().out


def test_every_proposal_says_why_and_how_to_change_it(servo):
    lines = {p.what: p for p in servo.proposals}
    assert lines["pos_deg"].taken == "position [deg]" and "at the end of its name" in lines["pos_deg"].why
    assert lines["temp_C"].taken == "left out" and lines["gear_ratio"].flag == "--set gear_ratio=VALUE"
    assert all(p.why for p in servo.proposals) and "law" in lines and "machine" in lines


def test_files_of_a_fit_are_pictures_a_page_and_a_script(rig, tmp_path):
    written = {path.name: path for path in rig.save(tmp_path / "new" / "folder")}
    assert set(written) == {"curve.png", "friction.png", "residuals.png", "report.html", "report.txt", "fit.py"}
    assert all(written[name].read_bytes()[:4] == b"\x89PNG" for name in written if name.endswith(".png"))
    assert written["fit.py"].read_text() == rig.python and "verdict" in written["report.txt"].read_text()


def test_the_friction_of_a_figure_is_the_law_and_the_cloud_about_it(rig):
    ax = rig.plot()
    cloud, backwards, forwards = (line.get_xydata() for line in ax.lines[:3])
    law = rig.fit.model()
    assert [law.sliding(v / 1e3, 1.0) for v, _ in forwards] == pytest.approx(forwards[:, 1])
    assert [law.sliding(v / 1e3, 1.0) for v, _ in backwards] == pytest.approx(backwards[:, 1])
    fast = cloud[np.abs(cloud[:, 0]) > 5.0]  # mm/s, far above the Stribeck velocity
    assert abs(np.abs(fast[:, 1]).mean() - rig.values["mu"]) < 5 * 0.03 / np.sqrt(len(fast))


def test_symmetry_is_tested_where_the_zero_of_the_sensor_is_known(tmp_path):
    """With an unknown zero only the mean is determined; with a known one a difference of .3 N in 2.55 is clear."""
    path = rig_file(tmp_path / "rig.csv", backwards=2.7)
    free = ss.fit(path, law="stribeck", starts=2)
    known = ss.fit(path, law="stribeck", starts=2, sensor={"offset": 0.0})
    assert not free.symmetry[0].determined and "half difference not determined" in free.report()
    assert known.symmetry[0].asymmetric and abs(known.symmetry[0].half + 0.15) < 4 * known.symmetry[0].error
    apart = ss.fit(path, law="coulomb", starts=2, asymmetric=True)
    assert apart.symmetry[0].name == "mu" and "mean of both directions" in apart.report()


def test_a_current_without_a_motor_constant_gives_numbers_in_amperes(servo, tmp_path):
    log = tmp_path / "current.csv"
    rec = servo.fit.records[0]
    rows = [f"{t},{q},{i}" for t, q, i in zip(rec["position"].time, rec["position"].si, rec["force"].si / 0.05, strict=True)]
    log.write_text("\n".join(["t_s,pos_rad,cur_A", *rows]))
    bare, known = (ss.fit(log, law="coulomb-viscous", starts=2, numbers=n) for n in (None, {"motor_constant": 0.05}))
    assert bare.in_amperes and " A   95 %" in bare.report() and "N m s/rad" not in bare.report() and "in amperes" in bare.python
    assert not known.in_amperes and known.values["friction.mu"] == pytest.approx(0.05 * bare.values["friction.mu"], rel=1e-3)


@each_row(
    "headings, given, said",
    [
        (("tick", "lvdt", "Fric"), {}, 'units={"tick": "ms", "lvdt": "mm", "Fric": "N"}'),
        (("t_s", "v_mm_s", "temp_C"), {}, "amplitude and tilt_deg are missing"),
        (("t_s", "temp_C", "p_bar"), {}, "no machine suits the file"),
        (("t_s", "x_mm", "F_N"), {"machine": "joint"}, "machine = 'joint' needs other channels"),
        (("t_s", "x_mm", "F_N"), {"machine": "rigg"}, "did you mean 'rig'"),
        (("t_s", "x_mm", "F_N"), {"law": "stribek"}, "did you mean 'stribeck'"),
        (("t_s", "x_mm", "F_N"), {"numbers": {"lode": 2.0}}, "did you mean 'load'"),
        (("t_s", "x_mm", "F_N"), {"numbers": {"load": -2.0}}, "the normal force is -2 N"),
    ],
)
def test_what_is_open_is_asked_with_what_to_type(headings, given, said):
    t = np.arange(200.0) * (10.0 if headings[0] == "tick" else 0.01)
    log = {headings[0]: t, headings[1]: np.sin(0.3 * np.arange(200)), headings[2]: np.cos(0.3 * np.arange(200)) + 20.0}
    with pytest.raises(ss.InputError) as told:
        ss.fit(log, **given)
    assert said in str(told.value)


@each_row(
    "columns, kinds",
    [
        ({"x [mm]": 1, "F [N]": 1}, ["rig", "slider"]),
        ({"v [mm/s]": 1, "F [N]": 1, "normal [N]": 1}, ["rig", "slider"]),
        ({"angle [deg]": 1, "torque [N m]": 1}, ["joint"]),
        ({"vel_rpm": 1, "cur_mA": 1}, ["joint"]),
        ({"v [m/s]": 1}, ["robot"]),
        ({"pressure [bar]": 1}, []),
    ],
)
def test_the_machine_follows_from_what_was_measured(columns, kinds):
    t = np.arange(100) * 0.01
    assert list(kinds_for([ss.read({"t [s]": t, **{name: np.sin(9 * t) for name in columns}})])) == kinds


@each_row(
    "name, values, unit",
    [
        ("tick", np.arange(5.0), "ms"), ("time", np.arange(5) * 1e-3, "s"), ("Drehmoment", [1.0], "N m"), ("angle", [90.0], "deg"),
        ("angle", [1.0], "rad"), ("cur", [0.1], "A"), ("battery", [12.0], "1"), ("load_cell", [3.0], "N"), ("LDV", [0.1], "m/s"),
        ("LDV", [9.0], "mm/s"),
    ],
)  # fmt: skip
def test_every_bare_channel_has_a_candidate_unit_of_its_own(name, values, unit):
    assert candidate_unit(name, values) == unit


def test_laws_of_a_long_record_are_compared_on_some_of_its_samples_and_the_best_is_fitted_to_all(rig, monkeypatch):
    monkeypatch.setattr("stickslip.inverse.logs.fitting._MOST", 750)
    result = ss.fit(rig.fit.records[0], starts=2, machine="rig")
    assert result.law == "stribeck" and result.fit.count == rig.fit.count and result.fits["coulomb"].count < 0.6 * rig.fit.count
    assert "one sample of 2" in next(p.why for p in result.proposals if p.what == "law")


# tables without times -----------------------------------------------------------------------------------------------


def bench_table(count=30, noise=0.02):
    """Forces of a bench at constant speeds both ways, in no order: mu = 2.4 N, f = 3.4 N, v_s = .8 mm/s, 3 N s/m."""
    rng = np.random.default_rng(3)
    v = rng.permutation(np.concatenate([side * np.geomspace(1e-4, 0.1, count) for side in (1.0, -1.0)]))
    F = np.sign(v) * (2.4 + np.exp(-((v / 8e-4) ** 2))) + 3.0 * v + rng.normal(0, noise, len(v))
    return {"v_mm_s": np.append(1e3 * v, 0.0), "F_N": np.append(F, 1.1)}


def test_forces_at_constant_speeds_are_a_bench_and_its_intervals_hold_the_truth():
    result = ss.fit(bench_table(), starts=4)
    assert result.machine == "bench" and result.law == "stribeck-viscous" and result.supported
    for name, truth in {"mu": 2.4, "f": 3.4, "v_s": 8e-4, "viscous": 3.0}.items():
        low, high = result.fit.interval(name, level=0.999)
        assert low < truth < high, name
    assert set(result.fit.sensor) == {"offset", "gain"}  # nobody knows when a row was taken
    assert "1 stand still or miss a value" in result.report()


def test_the_order_of_the_rows_of_a_bench_says_nothing():
    table = bench_table()
    again = ss.fit({name: column[::-1] for name, column in table.items()}, law="stribeck", starts=2)
    assert again.values == ss.fit(table, law="stribeck", starts=2).values


def test_a_law_with_inner_states_needs_times():
    with pytest.raises(ss.InputError, match="has no times, and Dahl has inner states"):
        ss.identify(ss.read(bench_table()), ss.Dahl, free={"mu": (1.0, 5.0)}, load=1.0, sigma0=1e5, exponent=1.0)


def test_mean_speeds_over_settings_are_a_shaken_robot_and_the_interval_holds_the_truth(tmp_path):
    rng, settings = np.random.default_rng(4), [(A, f) for A in (4e-4, 6e-4, 8e-4) for f in (25.0, 40.0)]
    made = [ss.presets.piezo_rig(tilt_deg=1.7, amplitude=A, omega=2 * np.pi * f, law="coulomb", mu0=0.19) for A, f in settings]
    speeds = [ss.periodic_orbit(robot).mean_velocity + rng.normal(0, 2e-5) for robot in made]
    rows = [f"{1e3 * A:.4f};{f};{1e3 * v:.5f};0.02" for (A, f), v in zip(settings, speeds, strict=True)]
    (tmp_path / "a.csv").write_text("\n".join(["amplitude_mm;freq_Hz;speed_mm_s;sd_mm_s", *rows]))
    with pytest.raises(ss.InputError, match="tilt_deg is missing"):
        ss.fit(tmp_path / "a.csv")
    result = ss.fit(tmp_path / "a.csv", law="coulomb", numbers={"tilt_deg": 1.7}, starts=4)
    low, high = result.fit.interval("mu0", level=0.999)
    assert result.machine == "speeds" and low < 0.19 < high and high - low < 0.01
    assert "6 mean velocities" in result.report()


def test_every_report_of_forces_over_a_motion_says_whether_friction_is_symmetric(tmp_path):
    rec = ss.read(rig_file(tmp_path / "rig.csv", backwards=2.7))
    how = {"load": 1.0, "starts": 2, "sensor": {"offset": 0.0}, "f": 3.4, "v_s": 8e-4}
    one = ss.identify(rec, ss.Stribeck, free={"mu": (1.0, 5.0)}, **how)
    both = ss.identify(rec, ss.Stribeck, free={"mu_plus": (1.0, 5.0), "mu_minus": (1.0, 5.0)}, **how)
    for fit in (one, both):
        (found,) = fit.symmetry
        assert found.asymmetric and abs(found.half + 0.15) < 4 * found.error and f"symmetry: {found}" in fit.report()
    own = ss.identify(rec, lambda mu: ss.Coulomb(mu), free={"mu": (1.0, 5.0)}, using="force", load=1.0, starts=2)
    assert own.symmetry == () and "symmetry" not in own.report()  # nobody knows what a user's own function makes of it


def test_a_level_robot_whose_friction_differs_by_direction_is_fitted_with_both_coefficients():
    drive, law = ss.Harmonic(amplitude=4e-4, frequency=40.0), ss.Coulomb(0.09, 0.15)
    rec = ss.virtual_rig(ss.Robot(0.05, 0.02, drive, law), noise=2e-4, seed=3)
    log = {"t_s": rec["velocity"].time, "v_m_s": rec["velocity"].si}
    numbers = {"amplitude": 4e-4, "tilt_deg": 0.0, "body_mass": 0.05, "inner_mass": 0.02, "frequency": 40.0}
    result = ss.fit(log, law="coulomb", numbers=numbers, asymmetric=True, starts=4)
    for name, truth in (("mu_plus", 0.09), ("mu_minus", 0.15)):
        low, high = result.fit.interval(f"friction.{name}", level=0.999)
        assert low < truth < high < 1.2 * low
    assert "incline='gravity'" in result.python and "friction.mu_minus" in result.python
    with pytest.raises(ss.InputError, match="amplitude differ from file to file"):
        ss.fit([log, log], law="coulomb", numbers=numbers | {"amplitude": [4e-4, 5e-4]}, asymmetric=True)
    one = ss.fit(log, law="coulomb", numbers=numbers, starts=2)
    assert not one.supported and "on a level track it is their difference that moves a robot" in one.report()


def test_numbers_may_have_units_and_those_that_measure_something_else_are_refused():
    t = np.arange(0.0, 1.0, 1e-3)
    rec = ss.read({"t_s": t, "v_mm_s": np.sin(250.0 * t)})
    typed = {"amplitude": "0.8 mm", "tilt_deg": "0.02 rad", "body_mass": "80 g", "inner_mass": 0.02}
    given = plan_of([rec], {}, {}, None, typed).given
    assert given == pytest.approx({"amplitude": 8e-4, "tilt_deg": np.degrees(0.02), "body_mass": 0.08, "inner_mass": 0.02}, rel=1e-14)
    with pytest.raises(ss.InputError, match="body_mass: m is a unit of position"):
        plan_of([rec], {}, {}, None, typed | {"body_mass": "80 m"})
    assert "body_mass and inner_mass [kg] are those of the paper's robot" in plan_of([rec], {}, {}, None, {}).problem


def test_a_command_is_known_by_its_name_and_alone_with_an_angle_it_is_no_log_of_friction():
    t = np.arange(0.0, 1.0, 1e-2)
    log = {"time_ms": 1e3 * t, "pos_deg": np.sin(t), "cmd_deg": np.sin(t)}
    rec = ss.read(log)
    assert rec["command"].name == "cmd_deg" and rec["position"].name == "pos_deg"
    assert "kp and motor_constant and resistance and inertia and gravity_torque are missing" in plan_of([rec], {}, {}, None, {}).problem
    assert plan_of([ss.read(log | {"cur_mA": np.cos(t)})], {}, {}, None, {}).kind.name == "joint"


def test_of_several_joints_the_first_that_moves_is_proposed_and_one_typed_role_names_another():
    t, names = np.arange(0.0, 1.0, 1e-2), [f"{joint} {what}" for joint in ("grip", "hip", "knee") for what in ("pos [rad]", "cur [A]")]
    columns = dict(zip(names, ([0 * t, 0 * t, np.sin(9 * t), np.cos(9 * t), np.sin(5 * t), np.cos(5 * t)]), strict=True))
    plan = plan_of([ss.read({"t [s]": t} | columns)], {}, {}, None, {})
    assert plan.kind.name == "joint" and {plan.records[0][role].name for role in ("position", "current")} == {"hip pos", "hip cur"}
    assert {p.what: p.flag for p in plan.channels if p.why == "of another joint"}["knee cur"] == '--role "knee cur"=current'
    for roles, own in ((plan.joint.roles, "hip cur"), ({"knee pos": "position"}, "knee cur")):
        assert ss.read({"t [s]": t} | columns, roles=roles)["current"].name == own  # as the Python of the fit reads it
    two = plan_of([ss.read({"t [s]": t, "x1 [mm]": t, "x2 [mm]": np.sin(t), "F [N]": t})], {}, {}, None, {})
    assert (
        two.problem.startswith("2 channels may be the position: 'x1', 'x2'") and len(two.channels) == 4
    )  # of which joint the force is, is open
    with pytest.raises(dataclasses.FrozenInstanceError):
        plan.channels[0].taken = "something else"


def test_friction_of_a_servo_from_a_file_of_command_and_angle(tmp_path, capsys):
    """Two logs of BAM's bench with other loads, in milliseconds and degrees: within 3 standard errors, and both begin at rest."""
    p = {"kt": 2.19, "R": 2.96, "armature": 0.0266, "friction_base": 0.1035, "friction_viscous": 0.0352}
    t, arms, files = np.arange(0, 3, 0.01), [pendulum(mass, 0.15, 0.1) for mass in (1.0, 0.5)], []
    for seed, (arm, command) in enumerate(zip(arms, (chirp, sines), strict=True)):
        rows = np.column_stack([1e3 * t, np.degrees(command(t)), np.degrees(shown(swung(p, *arm, 38.0, 14.4, command(t), 0.01, 8), seed))])
        files.append(tmp_path / f"{seed}.csv")
        np.savetxt(files[-1], rows, fmt="%.4f", delimiter=",", header="time_ms,cmd_deg,pos_deg", comments="")
    numbers = {"kp": 38, "supply": 14.4, "motor_constant": 2.19, "resistance": 2.96}
    numbers |= {"inertia": [J for J, _ in arms], "gravity_torque": [G for _, G in arms]}
    result = ss.fit(files, numbers=numbers, law="m1", starts=1)
    for name, value in {"motor_inertia": 0.0266, "load.base": 0.1035, "load.viscous": 0.0352}.items():
        assert abs(result.values[name] - value) < 3 * result.fit.errors[name] < value, name
    assert not any("begins with" in said for said in result.fit.warnings)
    made = {}
    exec(result.python, made)
    assert made["fit"].values == result.values and result.machine == "servo" and result.supported
    assert result.plot().get_xlabel().startswith("time")
    table = np.genfromtxt(files[0], delimiter=",", names=True)[:200]  # an angle that is counted from another zero than its command
    log = {"time_ms": table["time_ms"], "cmd_deg": table["cmd_deg"], "pos_deg": table["pos_deg"] + 6.0}
    one = {"law": "m1", "starts": 1, "numbers": numbers | {"inertia": arms[0][0], "gravity_torque": arms[0][1]}}
    plan = plan_of([ss.read(log)], {}, {}, None, one["numbers"])
    said = plan.checked().doubt(plan.records, plan.given)  # what a fit asks for that no law explains
    assert said.startswith("the command is -0.")
    moved = ss.fit(log, sensor=eval(re.search(r"sensor=({.*})", said)[1]), **one)
    goal, error = moved.fit.sensor["goal"]
    assert moved.supported and abs(goal + np.radians(6.0)) < 3 * error < 0.01


def test_a_law_of_a_fitted_log_is_exported_and_refused_in_amperes():
    log = read_joint()
    known = ss.fit(log, law="coulomb-viscous", numbers={"motor_constant": 0.5, "gravity_torque": 0.0}, starts=2)
    joint = ss.export_law(known, "mujoco", speeds=(0.1, 3.0))
    assert joint.numbers["frictionloss"] == pytest.approx(known.values["friction.mu"], rel=1e-9)
    assert joint.numbers["damping"] == pytest.approx(known.values["friction.viscous"], rel=1e-6)
    bare = ss.fit(log, law="coulomb-viscous", numbers={"gravity_torque": 0.0}, starts=2)
    for fit in (bare, bare.fit):
        with pytest.raises(ss.InputError, match="are in amperes"):
            ss.export_law(fit, "c")


def read_joint():
    """A log of a current and an angle, of a joint of 0.02 kg m^2 with friction of 0.1 N m and 0.03 N m s/rad at 0.5 N m/A."""
    t = np.arange(0.0, 5.0, 0.005)
    sines = ((0.8, 2.0, 0.3), (0.3, 5.0, 1.0))
    q, v = (sum(f(s, w, p)(t) for s, w, p in sines) for f in (_sine, _slope))
    a = -sum(w**2 * _sine(s, w, p)(t) for s, w, p in sines)
    current = (0.02 * a + 0.1 * np.sign(v) + 0.03 * v) / 0.5
    return {"time_ms": 1e3 * t, "pos_deg": np.degrees(q), "cur_mA": 1e3 * (current + np.random.default_rng(2).normal(0, 5e-3, len(t)))}


def _sine(size, omega, phase):
    return lambda t: size * np.sin(omega * t + phase)


def _slope(size, omega, phase):
    return lambda t: size * omega * np.cos(omega * t + phase)
