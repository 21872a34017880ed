"""Logs of robots: BAM's bench, MCAP, ROS bags and LeRobot's tables; a library that is missing is an error with what to type."""

import contextlib
import sqlite3
import sys

import numpy as np
import pytest

import robot_files
import stickslip as ss
from rows import each_row
from stickslip.basics.unpacking import Allowance
from stickslip.records.robot_logs import Topics


@each_row("more", [{}, {"dt": 0.01}], ids=["times", "a step"])
def test_a_log_of_bams_bench_has_the_units_of_its_recorder(more, tmp_path):
    (tmp_path / "log.json").write_bytes(robot_files.bam(**more))
    rec = ss.read(tmp_path / "log.json")
    assert (rec["position"].unit, rec["velocity"].unit, rec["position"].rate) == ("rad", "rad/s", pytest.approx(100.0))
    assert (
        rec.source["kp"] == "8"
        and "load" not in {c.role for c in rec.channels.values()}
        and any("torque_enable left out" in n for n in rec.notes)
    )


#: For each file what its channels are: name -> unit, and the last value of the first.
HELD = {
    "json.mcap": ({"pos_deg": "deg", "torque_Nm": "Nm"}, 29.5),
    "ros2.mcap": ({"hip.position": "rad", "hip.velocity": "rad/s", "hip.effort": "N m"}, 0.59),
    "ft.bag": ({f"wrench.{what}.{axis}": unit for what, unit in (("force", "N"), ("torque", "N m")) for axis in "xyz"}, 5.9),
    "rig.db3": (
        {"joint_states.hip.position": "rad", "joint_states.hip.velocity": "rad/s", "joint_states.hip.effort": "N m", "pad.force": "N"},
        0.59,
    ),
    "episodes.parquet": ({f"{what}.{k}": None for what in ("observation.state", "action") for k in (0, 1)}, 2.9),
}
LIBRARY = {"json.mcap": "mcap", "ros2.mcap": "rosbags", "ft.bag": "rosbags", "rig.db3": "rosbags", "episodes.parquet": "pyarrow"}
MODULES = {"mcap": ["mcap.reader"], "rosbags": ["rosbags.highlevel"], "pyarrow": ["pyarrow.parquet"]}
RATE = {"json.mcap": 100.0, "ros2.mcap": 50.0, "ft.bag": 100.0, "rig.db3": 50.0, "episodes.parquet": 30.0}


@pytest.mark.parametrize("name", HELD)
def test_a_log_of_a_robot_has_channels_with_times_and_units(name, tmp_path):
    pytest.importorskip(LIBRARY[name], reason="the extra [robot] is not installed")
    pytest.importorskip("mcap" if "mcap" in name else LIBRARY[name])
    robot_files.WRITERS[name](tmp_path / name)
    rec, (units, last) = ss.read(tmp_path / name), HELD[name]
    assert {c.name: c.unit for c in rec.channels.values()} == units
    first = next(iter(rec.channels.values()))
    assert first.values[-1] == pytest.approx(last) and first.rate == pytest.approx(RATE[name], rel=1e-6)
    assert np.all(np.diff(first.time) > 0)


@each_row(
    "data, name",
    [(b"\x89MCAP0\r\n rest", "mcap"), (b"#ROSBAG V2.0\n rest", "rosbags"), (b"PAR1 rest", "pyarrow")],
)
def test_a_library_that_is_missing_is_an_error_with_what_to_type(data, name, tmp_path, monkeypatch):
    for module in (name, *MODULES[name]):
        monkeypatch.setitem(sys.modules, module, None)
    (tmp_path / "log").write_bytes(data)
    with pytest.raises(ss.InputError, match=rf"{name}, which is not installed; type pip install \"stickslip\[robot\]\""):
        ss.read(tmp_path / "log")


def test_what_is_no_bag_in_sqlite_is_said_and_topics_of_unknown_types_are_named(tmp_path):
    with pytest.raises(ss.InputError, match="no message of the MCAP holds numbers that can be read; /pose left out"):
        Topics(Allowance("read", 100)).raw("MCAP", ["/pose left out"])
    pytest.importorskip("rosbags", reason="the extra [robot] is not installed")
    robot_files.WRITERS["rig.db3"](tmp_path / "rig.db3")
    assert any("/camera left out" in note and "vendor_msgs/msg/Frame" in note for note in ss.read(tmp_path / "rig.db3").notes)
    with contextlib.closing(sqlite3.connect(tmp_path / "other.db")) as file:
        file.execute("CREATE TABLE topics(a)")  # and messages that a view makes up without end
        file.execute("CREATE VIEW messages AS WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT x FROM n")
        file.commit()
    with pytest.raises(ss.InputError, match="is no bag of ROS 2"):
        ss.read(tmp_path / "other.db")


def test_another_episode_of_a_table_is_read_by_its_number(tmp_path):
    pytest.importorskip("pyarrow", reason="the extra [robot] is not installed")
    robot_files.WRITERS["episodes.parquet"](tmp_path / "a.parquet")
    first, second = ss.read(tmp_path / "a.parquet"), ss.read(tmp_path / "a.parquet", episode=1)
    assert second["observation.state.0"].values[0] == pytest.approx(first["observation.state.0"].values[-1] + 0.1)
    assert "of 2 episodes the first is read" in " ".join(first.notes) and not any("episodes" in note for note in second.notes)
    with pytest.raises(ss.InputError, match="episode = 2; allowed are those of the table, 0 to 1"):
        ss.read(tmp_path / "a.parquet", episode=2)


def test_an_episode_of_a_file_that_has_none_is_refused(tmp_path):
    (tmp_path / "a.csv").write_text("t [s],v [m/s]\n0,1\n1,2\n2,3\n")
    with pytest.raises(ss.InputError, match="allowed is the number of an episode"):
        ss.read(tmp_path / "a.csv", episode=1)
