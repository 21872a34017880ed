"""The explorer behind its page: its robots are ours, what is asked is checked, answers are right, and strangers are refused."""

import contextlib
import json
import math
import subprocess
import sys
import threading
import time
import tomllib
from dataclasses import dataclass
from html.parser import HTMLParser
from urllib.parse import quote

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

import stickslip as ss
from explorers import PATIENCE, Explorer, answer, axis, curves, plane
from pairs import each_once
from rows import each_row
from stickslip.show.explorer import kernels as kernels_module
from stickslip.show.explorer.code import python
from stickslip.show.explorer.dropped_records import drive_response, velocity_response
from stickslip.show.explorer.effort import affordable, effort
from stickslip.show.explorer.exports import EXPORTS, export
from stickslip.show.explorer.first_picture import first_answer
from stickslip.show.explorer.frames import unpacked
from stickslip.show.explorer.kernels import Kernels, state_table
from stickslip.show.explorer.models import CONTACTS, DRIVES, FRICTION, TRACKS, active, robot
from stickslip.show.explorer.paper_figures import PRESETS
from stickslip.show.explorer.requests import DEFAULT, State, Stopped, message, state
from stickslip.show.explorer.sliders import PARAMETERS
from stickslip.show.explorer.surroundings import PATIENCE as MOST_SECONDS, progress_watch
from stickslip.show.paper.cases import CASES, EXPERIMENTS, rig

VALUES = {name: p.default for name, p in PARAMETERS.items()}


# robots -----------------------------------------------------------------------------------------------------------


@each_row(("drive", "law"), each_once(DRIVES, FRICTION))
def test_every_drive_goes_with_every_law_alone_and_as_a_map(drive, law):
    for track in TRACKS:
        for contact in CONTACTS:
            names = active(drive, track, contact, (law,))
            assert robot(drive, track, contact, law, VALUES).shape == ()
            x, y = np.linspace(0.9, 1.1, 3)[None, :], np.linspace(0.95, 1.05, 2)[:, None]
            many = robot(drive, track, contact, law, {**VALUES, names[0]: x * VALUES[names[0]], names[-1]: y * VALUES[names[-1]]})
            assert many.shape == (2, 3), (track, contact)


def test_every_drive_and_every_compiled_law_is_on_the_page_with_numbers_that_its_sliders_reach():
    assert set(ss.drives.DRIVES) <= set(DRIVES)
    assert set(FRICTION) == {name for name, law in ss.friction.LAWS.items() if not getattr(law, "scalar_only", False)}
    for p in PARAMETERS.values():
        assert p.least <= p.low <= p.default <= p.high <= p.most, p.name


def test_presets_are_the_papers_cases():
    for case in CASES:
        assert state(PRESETS[f"figure-{case.figure}"]["state"]).robot() == rig(case), case.figure
    for experiment in EXPERIMENTS:
        assert state(PRESETS[f"figure-{experiment.figure}"]["state"]).robot("coulomb") == rig(experiment, law="coulomb-static")


def test_a_static_coefficient_is_never_below_the_kinetic_one():
    law = State(values={**VALUES, "mu0": 0.3, "f0": 0.2}).robot("coulomb").friction
    assert (law.f_plus, law.f_minus) == (law.mu_plus, law.mu_minus)


def test_the_beam_is_the_preset_of_the_beam():
    found = State(drive="piezobeam").robot()
    assert found == ss.presets.piezo_beam_rig(voltage=VALUES["voltage"], frequency=VALUES["frequency"], tilt_deg=VALUES["tilt_deg"])


# what is asked ----------------------------------------------------------------------------------------------------


def problems_of(make):
    with pytest.raises(ss.InputError) as caught:
        make()
    return caught.value.problems


def test_everything_wrong_with_a_state_is_said_at_once():
    found = problems_of(lambda: state({"law": "coulom", "drive": 3, "values": {"amplitude": 1e9, "mu": 1, "mu0": "x"}, "more": 1}))
    assert len(found) == 6
    assert "did you mean 'coulomb'" in " ".join(found) and "amplitude = 1e+12 mm; allowed is 0 mm to 1600 mm" in " ".join(found)


@each_row(("name", "value"), each_once(PARAMETERS, [math.nan, math.inf, -math.inf, None, "1", True, [1.0], {}, 10**400]))
def test_no_parameter_takes_what_is_no_number(name, value):
    assert len(problems_of(lambda: state({"values": {name: value}}))) == 1


@each_row("name", PARAMETERS)
def test_no_parameter_goes_beyond_its_bounds(name):
    p = PARAMETERS[name]
    state({"values": {name: p.least}}), state({"values": {name: p.most}})
    for beyond in (p.least - 1e-6 * (abs(p.least) + 1), p.most * 1.001):
        assert len(problems_of(lambda beyond=beyond: state({"values": {name: beyond}}))) == 1


@each_row(
    "text",
    ["", "[]", "{", "null", "1", '"x"', "[" * 5000, '{"channel": "files", "id": 1}', '{"channel": "curves"}',
     '{"channel": "curves", "id": 1e3}',
     '{"channel": "curves", "id": true}', '{"channel": "map", "id": 1}', '{"channel": "curves", "id": 1, "state": []}',
     '{"channel": "curves", "id": 1, "state": {"also": ["coulomb", "gms", "dahl", "lugre", "viscous"]}}',
     '{"channel": "curves", "id": 1, "state": {"also": [["coulomb"]]}}', '{"channel": ["curves"], "id": 1}'],
)  # fmt: skip
def test_a_message_that_makes_no_sense_is_refused_with_a_sentence(text):
    assert problems_of(lambda: message(text))


@each_row(
    "shape",
    [None, [], [[1.0]], [[1.0], []], [[], []], [[0.0] * 33, [1.0] * 33], [[1.0], [11.0]], [[1.0], ["1"]], [[1.0], [True]], "shape"],
)
def test_a_shape_is_two_short_lists_of_small_numbers(shape):
    assert len(problems_of(lambda: state({"drive": "recorded", "shape": shape}))) == 1


@each_row(
    "axes",
    [[], [axis("amplitude", 0, 1e-3, 9)], [axis("amplitude", 0, 1e-3, 9)] * 2, [axis("amplitude", 1e-3, 0, 9), axis("mu0", 0.1, 0.2, 9)],
     [axis("amplitude", 0, 1e-3, 5000), axis("mu0", 0.1, 0.2, 9)], [axis("stroke", 1e-3, 1e-2, 9), axis("mu0", 0.1, 0.2, 9)],
     [axis("amplitude", 0, 1e9, 9), axis("mu0", 0.1, 0.2, 9)], "axes", [1, 2]],
)  # fmt: skip
def test_a_map_needs_two_axes_that_matter_and_are_bounded(axes):
    assert problems_of(lambda: message(json.dumps({"channel": "map", "id": 1, "state": {}, "axes": axes})))


# what is answered -------------------------------------------------------------------------------------------------


def test_curves_and_figures_are_those_of_the_solver(explorer):
    with explorer.page() as socket:
        socket.send(curves(7, fine=True, values={"tilt_deg": 2.7, "amplitude": 6.032e-4}))
        header, arrays = answer(socket, id=7)
    run = ss.solve(ss.presets.piezo_rig(tilt_deg=2.7, amplitude=6.032e-4), periods=200, rtol=1e-4)
    assert header["figures"]["mean_velocity"] == ss.mean_velocity(run)
    assert header["figures"]["motion_type"] == ss.motion(run).type == "III"
    assert [law["name"] for law in header["laws"]] == ["lugre", "coulomb"]
    assert arrays["lugre.v"].size == 3 * header["samples"] + 1
    start = run.strobe_times[-1] - 3 * run.period_time
    instants = np.linspace(0, 0.999, 5) * 3 * run.period_time
    shown = np.interp(instants, arrays["lugre.t"].astype(float), arrays["lugre.v"])
    # the page draws 256 instants a period: straight lines between them are off by h^2 v''/8, a thousandth of the amplitude of v
    assert shown == pytest.approx(run.at(start + instants)["v"], abs=1e-3 * abs(run.v).max())


def test_power_is_the_actuators_of_the_energy_balance(explorer):
    with explorer.page() as socket:
        socket.send(curves(fine=True, track="gravity", law="coulomb", also=[]))
        header, _ = answer(socket)
    run = ss.solve(State(track="gravity", law="coulomb").robot(), periods=200)
    work = ss.energy(run)
    # the trapezoid rule sees the corners of R v within one of 256 steps of a period
    assert header["figures"]["power"] == pytest.approx(float(work.actuator[-1]) / run.period_time, rel=2e-3)


def test_a_map_is_what_sweep_gives(explorer):
    x, y = np.linspace(3e-4, 6e-4, 5), np.linspace(-2, 2, 4)
    with explorer.page() as socket:
        socket.send(plane("map", axis("amplitude", x[0], x[-1], 5), axis("tilt_deg", y[0], y[-1], 4), law="coulomb"))
        header, arrays = answer(socket, "map")
    grid = ss.sweep(ss.presets.piezo_rig, tilt_deg=y, amplitude=x, law="coulomb-static")
    assert header["cells"] == [5, 4]
    # float32 on the way, and strobe points within 1e-8 on both sides
    np.testing.assert_allclose(arrays["mean_velocity"].reshape(4, 5), grid.mean_velocity.values, rtol=1e-5, atol=1e-9)
    assert [header["types"][int(code)] for code in arrays["motion_type"]] == grid.motion_type.values.ravel().tolist()


def test_cells_of_a_map_that_no_robot_can_have_are_left_out(explorer):
    with explorer.page() as socket:
        socket.send(plane("map", axis("tilt_deg", -20.0, 20.0, 5), axis("amplitude", 3e-4, 6e-4, 3), law="coulomb"))
        _, arrays = answer(socket, "map")
    missing = np.isnan(arrays["mean_velocity"]).reshape(3, 5)
    beyond = np.abs(np.linspace(-20, 20, 5)) > np.degrees(np.arctan(VALUES["mu0"]))  # the friction angle: folded mu is not positive
    assert (missing == beyond).all() and beyond.any() and not beyond.all()


def test_a_strip_shows_period_two_where_the_paper_does(explorer):
    with explorer.page() as socket:
        socket.send(plane("strip", axis("mu0", 0.04, 0.18, 2), values={"amplitude": 6e-4}))
        header, arrays = answer(socket, "strip")
    strobes = arrays["strobes"].reshape(2, header["kept"])
    spread = [np.unique(np.round(row / abs(strobes).max(), 2)).size for row in strobes]
    assert spread == [2, 1]  # Fig. 23: period two at 0.04; one strobe point at 0.18
    assert arrays["settled"].tolist() == [1, 1] and header["said"] == ""


def test_a_strip_runs_on_what_does_not_repeat_and_says_what_still_moves(explorer):
    """At mu0 = 0.037 a flip is near, and the motion closes in on its two points very slowly."""
    with explorer.page() as socket:
        socket.send(plane("strip", axis("mu0", 0.037, 0.18, 2)))
        header, arrays = answer(socket, "strip")
    moving = arrays["settled"] == 0
    assert moving.tolist() == [True, False] and arrays["run"].tolist() == [256, 64]
    assert header["said"].startswith("1 of 2 values, drawn pale, do not repeat after 256 drive periods")


@pytest.mark.parametrize("law", ["lugre", "coulomb", pytest.param("gms", marks=pytest.mark.slow)])
def test_a_strip_is_what_a_run_for_each_value_gives(explorer, law):
    with explorer.page() as socket:
        socket.send(plane("strip", axis("mu0", 0.01, 0.4, 6), values={"amplitude": 6e-4}, law=law))
        header, arrays = answer(socket, "strip")
    strobes = arrays["strobes"].reshape(6, header["kept"])
    assert np.isnan(strobes[0]).all() and np.isnan(arrays["means"][0])  # mu0 = 0.01 is below tan 1.7 deg: no such robot
    for mu, points, mean, periods in zip(arrays["values"][1:], strobes[1:], arrays["means"][1:], arrays["run"][1:], strict=True):
        values = {**VALUES, "amplitude": 6e-4, "mu0": float(mu)}
        run = ss.solve(State(law=law, values=values).robot(), periods=int(periods), rtol=1e-4)
        size = 6e-4 * VALUES["omega"] * 9.48 / (9.48 + 62.59)  # of v where nothing holds the body
        assert points == pytest.approx(run.strobe_v[-16:], abs=3e-3 * size)  # rtol 1e-4 on both sides, over 64 periods
        way = (run.strobe_x[-1] - run.strobe_x[-17]) / (run.strobe_times[-1] - run.strobe_times[-17])
        assert mean == pytest.approx(way, abs=3e-3 * size) or law == "gms"  # its mean is that of the second half


def test_effort_of_a_batch_is_that_of_its_cases():
    for law in ("lugre", "viscous"):
        mass = np.array([0.03, 0.06, 0.2])
        many = effort(State(law=law, also=()).robot(body_mass=mass))
        one = [effort(State(law=law, also=()).robot(body_mass=float(m))) for m in mass]
        np.testing.assert_allclose(np.broadcast_to(many[0], 3), [a for a, _ in one], rtol=1e-14)
        np.testing.assert_allclose(np.broadcast_to(many[1], 3), [b for _, b in one], rtol=1e-14)


def test_numbers_that_no_robot_can_have_are_answered_with_a_sentence(explorer):
    with explorer.page() as socket:
        socket.send(curves(values={"tilt_deg": 30.0}))
        header, _ = answer(socket)
        assert header["kind"] == "problems" and "mu_plus" in header["problems"][0]
        socket.send("nonsense")
        header, _ = answer(socket, channel=None)
        assert header["kind"] == "problems"
        socket.send(curves(2))
        assert answer(socket, id=2)[0]["kind"] == "curves"


def test_a_map_does_not_keep_the_curves_waiting(explorer):
    with explorer.page() as socket:
        socket.send(plane("map", axis("amplitude", 1e-6, 1e-3, 96), axis("mu0", 0.02, 0.2, 96), id=0))
        answer(socket, "map")  # its kernel is ready from here on
        socket.send(plane("map", axis("amplitude", 1e-6, 1e-3, 96), axis("mu0", 0.02, 0.2, 95), id=1))
        time.sleep(0.02)
        for i in range(2, 5):
            socket.send(curves(i, also=[]))
            header = {"channel": "map", "id": 0}
            while header["id"] != i:  # one after another, each answered before the map that was asked for first
                header, _ = unpacked(socket.recv(timeout=PATIENCE))
                assert header["channel"] == "curves"


@each_row("values", [{"omega": 1.0, "amplitude": 0.0, "sigma0": 1e8}, {"omega": 1.0, "body_mass": 1e-4, "inner_mass": 1e-5}])
def test_a_run_that_would_take_too_long_is_refused_before_it_begins(explorer, values):
    with explorer.page() as socket:
        socket.send(curves(fine=True, values=values, also=[]))
        header, _ = answer(socket)
    assert header["kind"] == "problems" and "times in a drive period; allowed here" in header["problems"][0]


@dataclass(frozen=True)
class OwnBristle:
    """A law of a user, who has other names for its numbers."""

    height: float = 0.15
    spring: float = 4e5

    def rate(self, v, z, load):
        return v - self.spring / (self.height * load) * abs(v) * z

    def force(self, v, z, zdot, load):
        return self.spring * z


@each_row("load", [0.3, 3.0])
def test_effort_is_told_by_the_equations_of_a_law_and_not_by_names_of_its_numbers(load):
    robot = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=5e-4, body_mass=load / 10)
    known = effort(robot.replace(friction=ss.Dahl(0.15, 0.15, sigma0=4e5)))
    assert known[0] > 5.0
    for law in (OwnBristle(), ss.LuGre.example().replace(sigma0=4e5), ss.Dahl(0.15, 0.15, sigma0=4e5) + ss.Viscous(1.0, 1.0)):
        assert effort(robot.replace(friction=law)) == pytest.approx(known, rel=1e-6)
    oil = effort(robot.replace(friction=ss.CoulombViscous(0.1, 0.1, viscous=7.0)))
    assert effort(robot.replace(friction=ss.Coulomb(0.1, 0.1) + ss.Viscous(7.0, 7.0))) == pytest.approx(oil, rel=1e-9) and oil[1] > 0.5
    assert effort(robot.replace(friction=ss.Coulomb(0.1, 0.1))) == (0.0, 0.0)


def test_a_run_with_many_swings_of_the_bristles_has_fewer_periods():
    robot = State().robot()
    assert affordable(robot, 200) == 200
    slow = robot.replace({"drive.omega": 5.0})  # 470 swings in a period
    assert 40 <= affordable(slow, 200) < 100 and affordable(slow, 40) == 40


def test_a_newer_map_takes_the_place_of_an_older_one(explorer):
    big = [axis("amplitude", 1e-6, 1e-3, 96), axis("mu0", 0.02, 0.2, 96)]
    with explorer.page() as socket:
        socket.send(plane("map", *big, id=0))
        answer(socket, "map")  # its kernel is ready from here on
        for i in range(1, 9):
            socket.send(plane("map", *big, id=i))
        socket.send(curves(99))
        seen = []
        while not seen or seen[-1] != 8:
            seen.append(answer(socket, "map")[0]["id"])
    assert len(seen) < 8


def test_work_that_nobody_waits_for_stops():
    with pytest.raises(Stopped):
        progress_watch(lambda: True)(1, 10)
    assert progress_watch(lambda: False)(1, 10) is None
    assert MOST_SECONDS < 60


# what is taken home -----------------------------------------------------------------------------------------------


@each_row("law", FRICTION)
def test_the_python_gives_the_same_robot(law):
    for drive in DRIVES:
        for track in TRACKS:
            found = State(drive=drive, track=track, law=law, also=())
            names = {}
            exec(python(found).partition("run =")[0], names)
            assert names["robot"] == found.robot(), (drive, track)


def test_the_python_runs():
    found = State(law="coulomb", also=("lugre",))
    text = python(found)
    names = {}
    exec(text, names)
    assert ss.mean_velocity(names["run"]) == ss.mean_velocity(ss.solve(found.robot(), periods=200, rtol=1e-4))


@each_row("drive", DRIVES)
def test_the_study_file_gives_the_same_robot(drive):
    found = State(drive=drive, track="varying")
    text = export("study.toml", found).decode()
    assert ss.Robot.from_toml(text) == found.robot()
    assert tomllib.loads(text)["solve"] == {"periods": 200, "rtol": 1e-4}


@each_row("name", EXPORTS)
def test_every_export_is_served_as_what_it_is(explorer, name):
    begins = {"figure.png": b"\x89PNG", "figure.svg": b"<?xml", "run.csv": b"t [s],x [m],v [m/s]", "study.toml": b"[robot]",
              "robot.py": b"import stickslip as ss", "report.html": b"<!doctype html>"}  # fmt: skip
    deadline = time.monotonic() + PATIENCE
    while True:
        status, headers, body = explorer.ask(f"/export/{name}?state={quote(json.dumps({'law': 'coulomb', 'also': []}))}")
        if status != 503 or time.monotonic() > deadline:
            break
        time.sleep(1)
    assert status == 200 and body.startswith(begins[name])
    assert headers["content-disposition"] == f'attachment; filename="{name}"'


def test_columns_keep_every_digit():
    found = State(law="coulomb")
    lines = export("run.csv", found).decode().splitlines()
    table = np.array([line.split(",") for line in lines[1:]], float)
    run = ss.solve(found.robot(), periods=200, rtol=1e-4)
    assert table[-1, 2] == run.at(run.strobe_times[-1])["v"]
    assert len(table) == 8 * 400 + 1


def test_the_report_needs_nothing_from_elsewhere():
    from stickslip.show.reports.html import outside_addresses

    text = export("report.html", DEFAULT).decode()
    assert outside_addresses(text) == []
    assert "LuGre" in text and "σ₀" in text and "ss.Robot(" in text


def test_exports_of_nonsense_are_refused_with_a_sentence(explorer):
    assert explorer.ask("/export/passwd")[0] == 404
    status, _, body = explorer.ask("/export/run.csv?state=" + quote('{"law": "coulom"}'))
    assert status == 400 and b"did you mean 'coulomb'" in body
    assert explorer.ask("/export/run.csv?state=%7B")[0] == 400


def test_a_record_is_handed_back_in_si_units(tmp_path):
    run = ss.solve(State(law="coulomb").robot(), periods=6)
    t = np.arange(1500) * 1e-4
    v = run.at(t)["v"]
    (tmp_path / "a.csv").write_text("t [ms];v [mm/s]\n" + "".join(f"{1e3 * a:.9g};{1e3 * b:.9g}\n" for a, b in zip(t, v, strict=True)))
    (tmp_path / "b.txt").write_text("".join(f"{a:.9g}\t{b:.9g}\n" for a, b in zip(t, v, strict=True)))
    for name, notes in (("a.csv", 0), ("b.txt", 2)):
        header, arrays = unpacked(velocity_response(name, (tmp_path / name).read_bytes()))
        assert arrays["v"] == pytest.approx(v, abs=1e-7 * abs(v).max())  # float32 on the way
        assert header["mean"] == pytest.approx(np.trapezoid(v, t) / np.ptp(t), rel=1e-6) and header["step"] == pytest.approx(1e-4)
        assert len(header["notes"]) == notes


FREQUENCY = 32.7
TIMES = np.arange(3000) * 1e-4
DRIVE = 0.1 * np.cos(2 * np.pi * FREQUENCY * TIMES) + 0.03 * np.sin(4 * np.pi * FREQUENCY * TIMES)


def rows(head, *columns):
    return (head + "\n" + "".join(",".join(f"{x:.10g}" for x in row) + "\n" for row in zip(TIMES, *columns, strict=True))).encode()


@each_row(
    ("data", "notes"),
    [(rows("t [s],drive [m/s]", DRIVE), 0), (rows("t [s],absolute velocity [m/s],v [m/s]", DRIVE + 0.5, 0 * DRIVE + 0.5), 0),
     (rows("t [s],v [m/s]", DRIVE), 1), (rows("t [s],drive [m/s]", DRIVE + 0.05), 1)],
)  # fmt: skip
def test_the_drive_of_a_record_is_the_motion_that_was_measured(data, notes):
    header, _ = unpacked(drive_response("record.csv", data))
    found = (
        State(drive="recorded", shape=tuple(map(tuple, header["shape"]))).robot(amplitude=header["amplitude"], omega=header["omega"]).drive
    )
    assert header["omega"] == pytest.approx(2 * np.pi * FREQUENCY, rel=1e-6)
    # its harmonics, integrated by hand: (0.1 / w) sin wt - (0.03 / 2w) cos 2wt; the record begins at t = 0 and ends with a whole period
    w = 2 * np.pi * FREQUENCY
    assert found.coefficients[1][0] == pytest.approx(0.1 / w, rel=1e-4) and found.coefficients[0][1] == pytest.approx(-0.015 / w, rel=1e-3)
    assert np.abs(np.delete(np.array(found.coefficients).ravel(), [1, 5])).max() < 1e-3 * 0.1 / w
    assert header["amplitude"] == pytest.approx(found.stroke / 2)
    assert len(header["notes"]) == notes + 1  # and how much the harmonics leave over


@each_row(
    "data",
    [b"no numbers\n", b"", b"t [s],F [N]\n0,1\n1,2\n2,3\n", rows("t [s],drive [m/s]", 0 * DRIVE), rows("t [s],drive [m/s]", 1e4 * DRIVE)],
)
def test_what_cannot_drive_a_robot_is_refused_with_a_sentence(data):
    assert problems_of(lambda: drive_response("record.csv", data))


def test_a_record_with_a_drive_alone_is_taken():
    header, arrays = unpacked(velocity_response("record.csv", rows("t [s],drive [m/s]", DRIVE)))
    assert arrays == {} and "but a drive" in header["notes"][0]


def test_a_recorded_shape_is_kept_by_the_python_the_study_file_and_the_kernels():
    found = State(drive="recorded", law="coulomb", also=(), shape=((0.0, -0.15), (1.0, 0.0)))
    names = {}
    exec(python(found).partition("run =")[0], names)
    assert names["robot"] == found.robot() != State(drive="recorded", law="coulomb", also=()).robot()
    assert ss.Robot.from_toml(export("study.toml", found).decode()) == found.robot()
    assert state(json.loads(json.dumps(state_table(found, "coulomb")))).robot() == found.robot()


@each_row(
    ("name", "data"),
    [("a.csv", b"no numbers\n"), ("a", b"1,2\n3,4\n"), ("../a.py/..", b""), ("a.mat", b"\x00" * 200), ("a.csv", b""),
     ("a.csv", b"t [s],F [N]\n0,1\n1,2\n2,3\n"), ("a.exe", b"MZ"), ("a.h5", b"\x89HDF")],
)  # fmt: skip
def test_what_is_no_record_is_refused_with_a_sentence(name, data):
    assert problems_of(lambda: velocity_response(name, data))


def test_a_record_that_is_too_large_or_not_ours_is_refused(explorer):
    import urllib.error
    import urllib.request

    def post(size, **headers):
        address, headers = f"http://127.0.0.1:{explorer.port}/record/a.csv", {"Cookie": explorer.cookie, **headers}
        with urllib.request.urlopen(urllib.request.Request(address, b"1" * size, headers, method="POST"), timeout=60) as reply:
            return reply.status

    assert post(100) == 200  # the answer is a sentence
    for size, headers, code in ((100, {"Origin": "http://evil.example"}, 403), (21_000_000, {}, 413)):
        with pytest.raises((urllib.error.HTTPError, ConnectionError, urllib.error.URLError)) as refused:
            post(size, **headers)
        assert getattr(refused.value, "code", code) == code
        if isinstance(refused.value, urllib.error.HTTPError):
            refused.value.close()
    assert explorer.ask("/record/a.csv")[0] == 405


# the page as it is served -----------------------------------------------------------------------------------------


class Elements(HTMLParser):
    """The elements of a page, as (tag, attributes)."""

    def __init__(self, text):
        super().__init__()
        self.found = []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.found.append((tag, dict(attributes)))


def test_the_page_has_its_sliders_and_figures_before_any_script_runs(explorer):
    status, headers, body = explorer.ask()
    assert status == 200 and headers["content-type"].startswith("text/html")
    found = Elements(body.decode()).found
    sliders = {a["name"]: a for tag, a in found if tag == "input" and a.get("type") == "range"}
    labelled = {a["for"] for tag, a in found if tag == "label" and "for" in a}
    assert set(sliders) == set(PARAMETERS)
    assert all(a["id"] in labelled and float(a["min"]) <= float(a["value"]) <= float(a["max"]) for a in sliders.values())
    quantities = {a["data-quantity"] for _, a in found if "data-quantity" in a}
    assert {"mean_velocity", "motion_type", "margin", "stick_fraction", "period", "power"} <= quantities


def test_nothing_in_the_page_comes_from_elsewhere(explorer):
    import re

    found = Elements(explorer.ask()[2].decode()).found
    wanted = [a["src"] for _, a in found if "src" in a] + [a["href"] for tag, a in found if tag == "link"]
    assert len(wanted) >= 5 and not [address for address in wanted if "//" in address or ":" in address]
    assert not [a["href"] for tag, a in found if tag == "a" and not a["href"].startswith("#")]
    for address in wanted:
        assert explorer.ask("/" + address)[0] == 200, address
    for name in ("main.js", "page.css"):
        assert b"//" not in re.sub(rb"(^|\s)//[^\n]*|www\.w3\.org", b"", explorer.ask(f"/assets/{name}")[2])


def test_only_files_of_the_page_are_served(explorer):
    for name in ("page.html", "../server.py", "..%2fserver.py", "%2e%2e/server.py", "/etc/passwd", "uPlot.LICENSE.txt/.."):
        assert explorer.ask(f"/assets/{name}")[0] == 404, name
    assert explorer.ask("/assets/uPlot.LICENSE.txt")[0] == 200
    assert explorer.ask("/", "POST")[0] == 405


# strangers --------------------------------------------------------------------------------------------------------


@each_row("host", ["evil.example", "evil.example:80", "127.0.0.1.evil.example", "", "192.168.0.1", "localhost@evil.example", "[::2]"])
def test_another_host_is_refused(explorer, host):
    assert explorer.ask(Host=host)[0] == 403


@each_row("host", ["127.0.0.1", "localhost", "[::1]"])
def test_this_machine_is_known_by_its_names(explorer, host):
    assert explorer.ask(Host=f"{host}:{explorer.port}")[0] == 200


def test_another_page_is_refused(explorer):
    for origin in ("http://evil.example", "null", f"http://localhost:{explorer.port + 1}", "http://127.0.0.1"):
        assert explorer.ask("/export/study.toml", Origin=origin)[0] == 403
        with pytest.raises(InvalidStatus), explorer.page(Origin=origin):
            pass
    assert explorer.ask("/export/study.toml", **{"Sec-Fetch-Site": "cross-site"})[0] == 403
    assert explorer.ask("/", **{"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate"})[0] == 200
    with explorer.page(Origin=f"http://127.0.0.1:{explorer.port}") as socket:
        socket.send(curves())
        assert answer(socket)[0]["kind"] == "curves"


def test_pages_run_no_script_but_ours(explorer):
    policy = explorer.ask()[1]["content-security-policy"]
    assert "default-src 'none'" in policy and "script-src 'self';" in policy and "frame-ancestors 'none'" in policy


def test_a_message_that_is_too_long_ends_the_connection(explorer):
    with explorer.page() as socket, pytest.raises(ConnectionClosed):
        socket.send("x" * 100_000)
        socket.recv(timeout=30)
    assert explorer.ask()[0] == 200


def needs_its_token(server):
    """The address carries it, the page keeps it as a cookie, and without it nothing is answered."""
    assert "?token=" in server.address and len(server.token) >= 24
    for wrong in ("", "stickslip_token=x", server.cookie[:-1], server.cookie.replace(str(server.port), "1"), f"{server.cookie}x"):
        for path in ("/", "/?token=wrong", "/?token=", "/assets/main.js", "/export/run.csv"):
            status, _, said = server.ask(path, Cookie=wrong)
            assert status == 403 and b"the token is missing" in said, (wrong, path)
        assert server.ask("/record/a.csv", "POST", Cookie=wrong, **{"Content-Length": "0"})[0] == 403
        with pytest.raises(InvalidStatus), server.page(Cookie=wrong):
            pass
    status, headers, _ = server.ask(f"/?token={server.token}", Cookie="")
    assert status == 200 and "HttpOnly" in headers["set-cookie"] and "SameSite=Strict" in headers["set-cookie"]
    cookie = headers["set-cookie"].partition(";")[0]
    assert server.ask("/assets/main.js", Cookie=cookie)[0] == 200
    with server.page(Cookie=cookie) as socket:
        socket.send(curves())
        assert answer(socket)[0]["kind"] == "curves"
    assert server.ask(f"/?token={server.token}", Host="evil.example")[0] == 403


def test_other_users_of_this_machine_need_a_token(explorer):
    needs_its_token(explorer)


def test_beyond_this_machine_a_token_is_needed():
    with contextlib.closing(Explorer("--host", "0.0.0.0")) as open_to_all:
        needs_its_token(open_to_all)


def test_without_a_token_the_address_can_be_kept_and_strangers_are_still_refused(capsys):
    from stickslip.show.cli import main

    with contextlib.closing(Explorer("--no-token")) as kept:
        assert "token" not in kept.address
        assert kept.ask(Cookie="")[0] == 200 and kept.ask(Cookie="", Host="evil.example")[0] == 403
        assert kept.ask("/export/study.toml", Cookie="", Origin="http://evil.example")[0] == 403
    assert main(["explore", "--no-browser", "--no-token", "--host", "0.0.0.0"]) == 2
    assert "leave one of them out" in capsys.readouterr().err


# the command ------------------------------------------------------------------------------------------------------


def test_a_port_that_is_taken_is_said_with_what_to_type(explorer, capsys):
    from stickslip.show.cli import main

    assert main(["explore", "--no-browser", "--port", str(explorer.port)]) == 2
    assert "type --port 0" in capsys.readouterr().err


@each_row("port", ["x", "-1", "70000", "8.5"])
def test_a_port_is_a_whole_number(port, capsys):
    from stickslip.show.cli import main

    assert main(["explore", "--no-browser", f"--port={port}"]) == 2
    assert "allowed is a whole number from 0 to 65535" in capsys.readouterr().err


# kernels ----------------------------------------------------------------------------------------------------------


def until(condition):
    deadline = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.02)


@pytest.fixture
def helpers(monkeypatch):
    """Stand-ins for the processes that compile, the one for later never done if asked so; and which kernels are loaded here."""
    seen = {"started": [], "loaded": [], "slow": False}

    def helper(later):
        seen["started"].append(later)
        text = "import time; time.sleep(600)" if later and seen["slow"] else "import sys; [print('ready', flush=True) for _ in sys.stdin]"
        return subprocess.Popen([sys.executable, "-c", text], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    monkeypatch.setattr(kernels_module, "QUIET", 0.05)
    monkeypatch.setattr(kernels_module, "_helper", helper)
    monkeypatch.setattr(kernels_module, "warm", lambda found, law, many: seen["loaded"].append((found.drive, law, many)))
    return seen


def test_kernels_of_presets_are_compiled_in_spare_time_and_loaded_when_wished_for(helpers):
    other, kernels = state(PRESETS["two-phase"]["state"]), Kernels()
    kernels.begin([other])
    until(lambda: len(kernels._compiled) == 2 and not kernels._processes.get(True))
    assert {drive for drive, _, _ in helpers["loaded"]} == {"harmonic"} and len(helpers["loaded"]) == 4
    compiled = len(helpers["started"])
    assert not kernels.ready(other, "coulomb", other.robot(), False)
    until(lambda: kernels.ready(other, "coulomb", other.robot(), False))
    assert helpers["loaded"][-1] == ("twophase", "coulomb", False) and len(helpers["started"]) == compiled
    kernels.end()


def test_a_wish_does_not_wait_for_what_is_compiled_in_spare_time(helpers):
    helpers["slow"] = True
    later, wish, kernels = state(PRESETS["two-phase"]["state"]), state(PRESETS["bang-bang"]["state"]), Kernels()
    kernels.begin([later])
    until(lambda: kernels._processes.get(True))
    stuck = kernels._processes[True]
    kernels.ready(wish, "coulomb", wish.robot(), False)
    until(lambda: kernels.ready(wish, "coulomb", wish.robot(), False))
    assert stuck.poll() is not None
    kernels.end()
    assert not kernels._processes


# several pages -------------------------------------------------------------------------------------------------------


def drag(explorer, clients, seconds):
    """As many pages as that, each dragging as fast as it is answered: of each its answers, as (kind, number asked, mean velocity)."""
    found, barrier = {}, threading.Barrier(clients)

    def page(who):
        with explorer.page() as socket:
            barrier.wait(60)
            mine, end = [], time.monotonic() + seconds
            while time.monotonic() < end:
                i = len(mine) + 1
                socket.send(curves(i, values={"amplitude": 3e-4 + 1e-6 * (who + i)}, also=[], law="coulomb"))
                header, _ = answer(socket)
                mine.append((header["kind"], header["id"] == i, header["figures"]["mean_velocity"]))
            found[who] = mine

    threads = [threading.Thread(target=page, args=(who,)) for who in range(clients)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(PATIENCE)
    return found


def test_pages_that_drag_at_once_get_their_own_answers(explorer):
    with explorer.page() as socket:  # the kernel is there
        socket.send(curves(law="coulomb", also=[]))
        answer(socket)
    found = drag(explorer, 4, 2)
    assert {(kind, own) for mine in found.values() for kind, own, _ in mine} == {("curves", True)}
    for who in range(4):
        i = len(found[who])
        robot = State(law="coulomb", values={**VALUES, "amplitude": 3e-4 + 1e-6 * (who + i)}).robot()
        assert found[who][-1][2] == ss.mean_velocity(ss.solve(robot, periods=40))


@pytest.mark.slow
def test_memory_stays_flat_while_pages_drag(explorer):
    drag(explorer, 4, 20)
    before, answered = explorer.memory(), 0
    for _ in range(3):
        answered += sum(map(len, drag(explorer, 4, 20).values()))
    assert answered > 1000
    assert explorer.memory() - before < 5e3 * answered  # an answer has 20 kB: keeping a quarter of them would show


def test_the_effort_of_a_strip_along_the_frequency_is_told_case_by_case():
    from stickslip.show.explorer.effort import effort

    each = [effort(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, omega=omega)) for omega in (100.0, 200.0)]
    both = effort(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5e-4, omega=[100.0, 200.0]))
    assert np.allclose(np.broadcast_to(both[0], 2), [one[0] for one in each]) and np.allclose(
        np.broadcast_to(both[1], 2), [one[1] for one in each]
    )


class _Ready:
    """Kernels of some laws."""

    def __init__(self, *laws):
        self._laws = laws

    def ready(self, subject, law, robot, many):
        return law in self._laws


def test_the_stored_first_picture_is_the_solvers_and_only_of_the_numbers_that_the_page_has_at_first():
    asked = message(json.dumps({"channel": "curves", "id": 7, "fine": True, "state": {}}))
    header, arrays = unpacked(first_answer(asked, _Ready("coulomb")))
    assert (header["id"], header["fine"]) == (7, True) and header["python"] == python(DEFAULT)
    assert [(law["name"], "waits" in law, law.get("solved")) for law in header["laws"]] == [("lugre", True, True), ("coulomb", False, None)]
    for law, shown in zip(DEFAULT.laws, header["laws"], strict=True):
        run = ss.solve(DEFAULT.robot(law), periods=200, rtol=1e-6)
        assert shown["mean_velocity"] == pytest.approx(ss.mean_velocity(run), rel=1e-5), law
        at = run.at(run.strobe_times[-4] + arrays[f"{law}.t"][:-1])
        for name, drawn in (("v", at["v"]), ("x", at["x"] - at["x"][0]), ("R", at["friction_force"])):
            assert np.abs(arrays[f"{law}.{name}"][:-1] - drawn).max() < 1e-4 * np.ptp(drawn), (law, name)
    figures, motion = header["figures"], ss.motion(ss.solve(DEFAULT.robot(), periods=200, rtol=1e-6))
    assert (figures["motion_type"], figures["pattern"], figures["period_number"]) == (motion.type, motion.pattern, motion.period)
    for name in ("margin", "stick_fraction", "forward_fraction"):
        assert figures[name] == pytest.approx(getattr(motion, name), abs=2e-4), name
    assert first_answer(asked, _Ready("lugre", "coulomb")) is None  # the solver answers
    for other in ({"law": "coulomb", "also": []}, {"also": []}, {"values": {"tilt_deg": 1.71}}):
        assert first_answer(message(json.dumps({"channel": "curves", "id": 1, "state": other})), _Ready()) is None, other


def test_closed_arcs_are_drawn_before_a_law_with_inner_states_is_solved_without_its_kernel():
    from stickslip.show.explorer.responses import sooner

    asked = message(json.dumps({"channel": "curves", "id": 1, "state": {"law": "lugre", "also": ["coulomb"]}}))
    header, arrays = unpacked(sooner(asked, _Ready(), lambda: False))
    assert [law["name"] for law in header["laws"] if "waits" in law] == ["lugre", "coulomb"] and header["figures"] is None
    assert {name.partition(".")[0] for name in arrays} == {"coulomb"}
    exact = ss.solve(asked.state.robot("coulomb"), periods=6)
    t = arrays["coulomb.t"] + exact.strobe_times[-1] - arrays["coulomb.t"][-1]
    assert np.abs(arrays["coulomb.v"] - exact.at(np.minimum(t, exact.t[-1]))["v"]).max() < 1e-2 * exact.v.max()
    assert sooner(asked, _Ready("lugre"), lambda: False) is None  # nothing slow is left
    alone = message(json.dumps({"channel": "curves", "id": 1, "state": {"law": "lugre", "also": []}}))
    assert sooner(alone, _Ready(), lambda: False) is None
