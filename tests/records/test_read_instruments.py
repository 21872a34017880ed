"""What instruments and people write: timestamps, LabVIEW's headers, JSON, data frames, volts, two rates, gaps, a million samples."""

import contextlib
import json

import numpy as np
import pandas as pd
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.errors import InputError

N = 60
V = np.round(np.sin(np.arange(N) / 5), 3)


def table(tmp_path, times, head="time,v [mm/s]", mark=",", decimal=".", name="run.csv"):
    lines = [f"{t}{mark}{f'{v:.3f}'.replace('.', decimal)}" for t, v in zip(times, V, strict=True)]
    path = tmp_path / name
    path.write_text("\n".join([head, *lines]) + "\n")
    return path


def expect(rec, rate=4.0, unit="mm/s"):
    c = rec["v"]
    assert c.unit == unit and c.axis_unit == "s" and c.rate == pytest.approx(rate) and c.values.tolist() == V.tolist()
    assert c.t[0] == 0.0 and np.diff(c.t) == pytest.approx(1 / rate, abs=1e-9)


def clock(i, start=0.0):
    seconds = start + 0.25 * i
    return f"{int(seconds // 3600) % 24:02d}:{int(seconds // 60) % 60:02d}:{seconds % 60:06.3f}"


@each_row(
    ("form", "head", "mark", "decimal"),
    [
        ("2026-03-01T{}Z", "timestamp,v [mm/s]", ",", "."),
        ("2026-03-01 {}+01:00", "time;v [mm/s]", ";", "."),
        ("2026-03-01 {}", "time;v [mm/s]", ";", ","),
        ("01.03.2026 {}", "Zeit;v [mm/s]", ";", ","),
        ("03/01/2026 {}", "Time\tv [mm/s]", "\t", "."),
        ('"2026/03/01 {}"', "time,v [mm/s]", ",", "."),
        ("2026-03-01,{}", "Date,Time,v [mm/s]", ",", "."),
        ("2026-03-01\t{}", "Date\tTime\tv [mm/s]", "\t", ","),
        ("{}", "time,v [mm/s]", ",", "."),
        ("{} AM", "time,v [mm/s]", ",", "."),
    ],
)
def test_timestamps_are_times(tmp_path, form, head, mark, decimal):
    times = [form.format(clock(i, 3600.0).replace(".", decimal if mark != "," else ".")) for i in range(N)]
    rec = ss.read(table(tmp_path, times, head, mark, decimal))
    expect(rec)
    assert any("first timestamp" in note for note in rec.notes) and list(rec) == ["v"]


def test_time_goes_on_over_midnight_and_over_the_end_of_a_month(tmp_path):
    expect(ss.read(table(tmp_path, [clock(i, 24 * 3600.0 - 5.0) for i in range(N)])))
    late = [f"2026-0{2 if i < 20 else 3}-{28 if i < 20 else 1:02d} {clock(i, 24 * 3600.0 - 5.0)}" for i in range(N)]
    expect(ss.read(table(tmp_path, late)))


def test_a_date_that_can_be_read_in_two_ways_is_an_error(tmp_path):
    with pytest.raises(InputError, match="day first or the month"):
        ss.read(table(tmp_path, [f"0{1 + i // 30}/03/2026 {clock(i)}" for i in range(N)]))
    assert ss.read(table(tmp_path, [f"{13 + i // 30}/03/2026 {clock(i % 30)}" for i in range(N)]))["v"].t[30] == pytest.approx(86400.0)


def test_a_wrong_timestamp_is_missing_and_said(tmp_path):
    times = [f"2026-{13 if i == 7 else 3:02d}-01 {clock(i)}" for i in range(N)]
    rec = ss.read(table(tmp_path, times))
    assert np.isnan(rec["v"].t[7]) and any("missing" in note for note in rec.notes)


LABVIEW = """LabVIEW Measurement\t
Writer_Version\t2
Separator\tTab
Decimal_Separator\t.
X_Columns\t{columns}
***End_of_Header***\t
\t
Channels\t2\t\t
Samples\t{n}\t{n}\t
Y_Unit_Label\tNewton\tmm/s\t
X_Dimension\tTime\tTime\t
X0\t0.0000000000000000E+0\t0.0000000000000000E+0\t
Delta_X\t0.010000\t0.010000\t
***End_of_Header***\t\t\t
X_Value\tForce\tVelocity\tComment
"""


@each_row("columns", ["One", "No"])
def test_labview_files_have_times_and_units(tmp_path, columns):
    path = tmp_path / "run.lvm"
    lines = [f"{f'{0.01 * i:.6f}' if columns == 'One' else ''}\t{i}.000000\t{v:.6f}\t" for i, v in enumerate(V)]
    path.write_text(LABVIEW.format(columns=columns, n=N) + "\n".join(lines) + "\n")
    rec = ss.read(path)
    assert list(rec) == ["Force", "Velocity"] and rec["force"].unit == "Newton" and rec["velocity"].si.tolist() == (V * 1e-3).tolist()
    assert rec["force"].rate == pytest.approx(100.0) and rec["force"].rate_unit == "Hz" and not rec.notes


def test_labview_names_its_comments_and_most_rows_have_none(tmp_path):
    """The names were taken from another line of the header, and the time for the position."""
    path = tmp_path / "run.lvm"
    rows = "\n".join(f"{0.01 * i:.6f}\t{i}.000000\t{v:.6f}" for i, v in enumerate(V))
    path.write_text(LABVIEW.format(columns="One", n=N) + rows + "\n")
    rec = ss.read(path)
    assert list(rec) == ["Force", "Velocity"] and rec["velocity"].si.tolist() == (V * 1e-3).tolist()
    assert rec["force"].rate == pytest.approx(100.0)


def test_names_of_more_columns_than_there_are_name_none(tmp_path):
    path = tmp_path / "run.txt"
    path.write_text("set\tlow\nt\tv\tnote\n" + "\n".join(f"{0.01 * i:.2f}\t{v:.6f}" for i, v in enumerate(V)) + "\n")
    rec = ss.read(path)
    assert not {"set", "low"} & set(rec) and any("its names are not used" in note for note in rec.notes)


@each_row("stamped", [False, True])
def test_columns_of_words_are_left_out_and_said(tmp_path, stamped):
    """A log with remarks before it, the state of the logger in each row, and a value that is missing."""
    path = tmp_path / "run.csv"
    times = [f"2024-05-06T12:00:{0.01 * i:06.3f}" if stamped else f"{0.01 * i:.2f}" for i in range(N)]
    rows = "\n".join(f"{t},{'NaN' if i == 7 else f'{v:.3f}'},OK" for i, (t, v) in enumerate(zip(times, V, strict=True)))
    path.write_text(f"# log v1.2\n# fw 0x33\n{'time' if stamped else 'time (s)'},speed (mm/s),state\n{rows}\n")
    rec = ss.read(path)
    seen, true = (np.delete(values, 7) for values in (rec["speed"].values, np.round(V, 3)))
    assert list(rec) == ["speed"] and rec["speed"].rate == pytest.approx(100.0) and np.allclose(seen, true)
    assert np.isnan(rec["speed"].values[7]) and any("column state left out" in note for note in rec.notes)


FRAME = pd.DataFrame({"t [s]": 0.25 * np.arange(N), "v [mm/s]": V})


@each_row("orient", ["records", "columns", "split", "index", "values", "table", "list"])
def test_json_tables_are_read_in_every_form(tmp_path, orient):
    path = tmp_path / "run.json"
    path.write_text(json.dumps(FRAME.to_dict("list")) if orient == "list" else FRAME.to_json(orient=orient, double_precision=15))
    rec = ss.read(path, columns=["t [s]", "v [mm/s]"]) if orient == "values" else ss.read(path)
    expect(rec)


def test_json_lines_and_tables_within_objects_are_read(tmp_path):
    path = tmp_path / "run.json"
    path.write_text(FRAME.to_json(orient="records", lines=True))
    expect(ss.read(path))
    values = [None if i == 3 else x for i, x in enumerate(V.tolist())]
    data = {"t": [0.25 * i for i in range(N)], "v": values}
    path.write_text(json.dumps({"rig": {"name": "a", "n": 2}, "units": {"v": "mm/s", "t": "s"}, "data": data}))
    rec = ss.read(path)
    assert rec["v"].unit == "mm/s" and np.isnan(rec["v"].values[3]) and rec["v"].rate == pytest.approx(4.0)


@each_row(
    ("text", "said"),
    [('{"a": [1, 2,', "cut short or damaged"), ("[" * 100_000, "nested too deeply"), ("{}", "0 tables"), ("[1, 2, 3]", "list of int"),
     ('{"a": {"t": [1, 2], "v": [1, 2]}, "b": {"t": [1], "v": [1]}}', "2 tables"), ("[[1, 2], [1]]", "2 values each"),
     ('{"columns": ["t"], "data": [[1, 2]]}', "1 values each")],
)  # fmt: skip
def test_json_that_is_no_table_is_an_error_in_words(tmp_path, text, said):
    (tmp_path / "x.json").write_text(text)
    with pytest.raises(InputError, match=said):
        ss.read(tmp_path / "x.json")


def test_data_frames_and_mappings_are_records():
    expect(ss.read(FRAME))
    expect(ss.read({"t [s]": FRAME["t [s]"].to_numpy(), "v [mm/s]": V}))
    dated = FRAME[["v [mm/s]"]].set_index(pd.date_range("2026-03-01", periods=N, freq="250ms"))
    expect(ss.read(dated))
    expect(ss.read(dated.reset_index()))
    expect(ss.read(FRAME[["v [mm/s]"]].set_index(pd.to_timedelta(FRAME["t [s]"], unit="s"))))
    assert any("not used" in note for note in ss.read({"t [s]": [0.0, 1.0], "v [m/s]": [1.0, 2.0, 3.0]}).notes)
    with pytest.raises(InputError, match="holds no numbers"):
        ss.read(pd.DataFrame())


@each_row(
    ("scale", "unit", "si"),
    [("25 mm/s/V", "V", 0.025), ("25 mm/s/V", "mV", 25e-6), ("40 V/(m/s)", "V", 0.025), ("100 mV/g", "V", 98.0665), ("10 mV/N", "V", 100.0),
     ("0.5 mm/V", None, 5e-4), ("2 Nm/V", "V", 2.0), (3.0, "mm/s", 3e-3), ("-3", "mm/s", -3e-3)],
)  # fmt: skip
def test_volts_and_a_sensitivity_are_what_was_measured(scale, unit, si):
    rec = ss.read({"t [s]": [0.0, 1.0, 2.0], f"signal{f' [{unit}]' if unit else ''}": [1.0, 2.0, 4.0]}, scale={"signal": scale})
    assert rec["signal"].si == pytest.approx(np.array([1.0, 2.0, 4.0]) * si, rel=1e-12) and any("scaled by" in note for note in rec.notes)


@each_row("scale", ["25 furlong/V", "V", 0.0, "0 mm/V", float("nan"), True, None, "1e999 mm/V", "5 V/V"])
def test_a_sensitivity_that_is_none_is_an_error(scale):
    with pytest.raises(InputError, match="scale of 'signal'"):
        ss.read({"t [s]": [0.0, 1.0], "signal [V]": [1.0, 2.0]}, scale={"signal": scale})


def test_multiples_of_gravity_are_no_ratio():
    rec = ss.read({"t [s]": [0.0, 1.0], "a [g0]": [1.0, 2.0]})
    assert rec["acceleration"].si.tolist() == [9.80665, 19.6133]


def test_two_rates_in_one_table_are_two_axes(tmp_path):
    fast, slow = 0.1 * np.arange(N), 0.3 * np.arange(N // 3)
    lines = [f"{t:.2f},{v:.3f}," + (f"{slow[i]:.2f},{i}" if i < len(slow) else ",") for i, (t, v) in enumerate(zip(fast, V, strict=True))]
    (tmp_path / "two.csv").write_text("\n".join(["t1 [s],v [mm/s],t2 [s],F [N]", *lines]) + "\n")
    rec = ss.read(tmp_path / "two.csv")
    assert rec["velocity"].rate == pytest.approx(10.0) and rec["force"].rate == pytest.approx(10 / 3) and len(rec["force"]) == N // 3
    assert not np.isnan(rec["force"].values).any()


def test_a_rising_force_is_no_frequency():
    rec = ss.read({"x [mm]": [3.0, 1.0, 2.0], "F [N]": [1.0, 2.0, 3.0]})
    assert rec["force"].values.tolist() == [1.0, 2.0, 3.0]


def test_segments_masks_and_joined_records(tmp_path):
    t = np.concatenate([0.01 * np.arange(200), 5 + 0.01 * np.arange(150), 9 + 0.01 * np.arange(20)])
    rec = ss.read({"t [s]": t, "v [mm/s]": np.arange(len(t)), "F [N]": np.ones(len(t))})
    parts = rec.segments(least=100)
    assert [len(p["v"]) for p in parts] == [200, 150] and not any(p["v"].gaps for p in parts) and parts[1]["F"].t[0] == 5.0
    again = ss.read({"t [s]": np.tile(0.01 * np.arange(100), 3), "v [mm/s]": np.arange(300)})
    assert [p["v"].values[0] for p in again.segments()] == [0.0, 100.0, 200.0]
    hidden = rec.masked(1.0, 1.5, "velocity")
    assert np.isnan(hidden["v"].values).sum() == 51 and not np.isnan(hidden["F"].values).any() and "masked" in hidden.notes[-1]
    other = ss.read({"t [ms]": [0.0, 1.0, 2.0], "i [mA]": [1.0, 2.0, 3.0]})
    both = rec.joined(other, delay=0.5)
    assert both["i"].time == pytest.approx([0.5, 0.501, 0.502]) and both["v"].rate == pytest.approx(100.0)
    with pytest.raises(InputError, match="both records have 'v'"):
        rec.joined(rec)
    with pytest.raises(InputError, match="smaller one"):
        rec.segments(least=1000)
    with pytest.raises(InputError, match="no sample from"):
        rec.masked(2.5, 3.0)


def test_means_say_so_and_cross_no_gap():
    t = np.concatenate([1e-3 * np.arange(1005), 3.0 + 1e-3 * np.arange(995)])
    rec = ss.read({"t [s]": t, "v [mm/s]": np.where(t < 2, 1.0, 5.0)})
    thin = rec.averaged(rate=100.0)
    assert set(thin["v"].values) == {1.0, 5.0} and len(thin["v"]) == 199 and "means of 10 samples each, 199 of 2000" in thin.notes[-1]
    assert thin["v"].rate == pytest.approx(100.0) and thin["v"].t[0] == pytest.approx(4.5e-3)
    assert rec.averaged(rate=5000.0)["v"].values.tolist() == rec["v"].values.tolist()


def test_saturation_and_a_dead_zone_are_noticed():
    t = np.arange(4000) / 1000
    rng = np.random.default_rng(1)
    clean = np.sin(2 * np.pi * 5 * t) + 0.002 * rng.normal(size=4000)
    assert not any("range" in n or "dead" in n for n in ss.read({"t [s]": t, "v [mm/s]": clean}).notes)
    clipped = ss.read({"t [s]": t, "v [mm/s]": np.clip(clean, -0.8, 0.8)})
    assert any("end of its range" in n for n in clipped.notes)
    dead = ss.read({"t [s]": t, "v [mm/s]": np.where(abs(clean) < 0.2, 0.0, clean)})
    assert any("dead zone" in n for n in dead.notes)


def test_damaged_files_are_read_or_refused_in_words(tmp_path):
    from stickslip.records.reading import read_bytes

    whole = [
        table(tmp_path, [f"2026-03-01,{clock(i)}" for i in range(N)], "Date,Time,v [mm/s]").read_bytes(),
        (LABVIEW.format(columns="No", n=N) + "\n".join(f"\t{i}.0\t{v:.6f}\t" for i, v in enumerate(V)) + "\n").encode(),
        FRAME.to_json(orient="split").encode(),
    ]
    rng = np.random.default_rng(4)
    for k in range(100):
        data = bytearray(whole[k % 3])
        for _ in range(int(rng.integers(1, 8))):
            at = int(rng.integers(len(data)))
            what = int(rng.integers(3))
            data[at : at + 12 * (what == 1)] = [b"2026-02-30 25:61:00", b"", bytes([int(rng.integers(256))])][what]
        with contextlib.suppress(InputError):
            read_bytes(bytes(data), "damaged")
