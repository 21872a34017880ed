"""Texts that were made to take long, and columns that are not numbers: each is read in one pass, or refused with a sentence."""

import json
import random
import tracemalloc

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.units import unit_of_heading
from stickslip.records import json_pieces, stamped_lines
from stickslip.records.reading import read_bytes
from stickslip.records.text import _Plain
from stickslip.records.text_lines import MOST_COLUMNS, TextLines

BIG = 400_000
HOSTILE = {
    "a heading of commas": (b"," * BIG, "characters; allowed are 200000"),
    "a heading of commas over numbers": (b"," * 150_000 + b"\n" + b"1,2\n" * 1000, None),
    "one long line": (b"7" * BIG, "characters; allowed are 200000"),
    "an open quote": (b't,v\n1,2\n"' + b"1,2\n" * BIG, None),
    "open quotes in all lines": (b"t,v\n" + b'"1,2\n' * BIG, ""),
    "quotes alone": (b'"\n' * BIG, "a quote that they do not close"),
    "open brackets": (b"[(" * 90_000 + b"\n1,2\n2,3\n", None),
    "many columns": ((b"1," * (MOST_COLUMNS + 9) + b"5\n") * 30, f"columns; allowed are {MOST_COLUMNS}"),
    "numbers of many digits": (b"t,v\n" + (b"1" * 100_000 + b",2\n") * 9, None),
    "tiny lines": (b"1\n" * BIG, None),
    "lines of one blank and tabs": (b"\t \t \t" * 30_000 + b"12:00:00\n", ""),
    "JSON of brackets": (b"[" * BIG, "nested too deeply"),
    "JSON within objects": (b'{"a":' * BIG, "nested too deeply"),
    "JSON of empty lists": (b"[" + b"[]," * BIG + b"[]]", "empty lists"),
    "JSON of other names in each row": (b"[" + b",".join(b'{"a%d":1}' % i for i in range(9000)) + b"]", "columns"),
    "JSON of names": (b"{" + b",".join(b'"a%d":[1]' % i for i in range(9000)) + b"}", "columns"),
    "JSON of one number": (b'{"a":[' + b"1" * BIG + b"]}", "damaged"),
    "a universal file of delimiters": (b"    -1\n    77\n" * 50_000, "universal file"),
    "a universal file of other data sets": (b"    -1\n    15\n" * 20_000, "universal file"),
    "NULs": (b"t,v\n" + b"\0" * BIG, "not text"),
    "byte order marks": (b"\xef\xbb\xbf" * 9000, "no table of numbers"),
}


@each_row("name", HOSTILE)
def test_a_text_made_to_take_long_is_read_or_refused_with_a_sentence(name, tmp_path):
    data, said = HOSTILE[name]
    (tmp_path / "x.txt").write_bytes(data)
    try:
        record = ss.read(tmp_path / "x.txt")
        assert not said and record.notes
    except ss.InputError as error:
        assert (said or "") in str(error) and len(str(error)) < 700


@each_row("cell", ["OK", "0x0f", "2026-03-01", "a1", "12:34", "v1.2.3", "-.-", "#REF!"])
@pytest.mark.parametrize(("mark", "point"), [(",", "."), (";", ","), ("\t", "."), (" ", ".")])
def test_a_column_that_is_not_numbers_is_left_out_whatever_it_holds(cell, mark, point, tmp_path):
    rows = [[f"{i * 0.01:.2f}".replace(".", point), cell, f"{i % 7}{point}5"] for i in range(50)]
    text = "\n".join(mark.join(row) for row in [["time_s", "state", "v_mm_s"], *rows])
    (tmp_path / "log.txt").write_text(text + "\n")
    record = ss.read(tmp_path / "log.txt")
    np.testing.assert_allclose(record["v_mm_s"].values, [i % 7 + 0.5 for i in range(50)])
    np.testing.assert_allclose(record["v_mm_s"].time, [i * 0.01 for i in range(50)], atol=1e-12)
    assert record["v_mm_s"].unit == "mm/s" and record["v_mm_s"].role == "velocity"
    assert any("state left out" in note and "line 2" in note and repr(cell) in note for note in record.notes)


def test_a_damaged_cell_in_a_column_of_numbers_leaves_the_column(tmp_path):
    rows = [f"{i},{'oops' if i == 20 else i % 5},0x0{i % 4}" for i in range(50)]
    (tmp_path / "log.csv").write_text("\n".join(["t [s],v [m/s],flags", *rows]) + "\n")
    record = ss.read(tmp_path / "log.csv")
    assert np.isnan(record["v"].values[20]) and np.isfinite(record["v"].values).sum() == 49
    assert any("1 cells are not numbers" in note and "line 22" in note for note in record.notes)


def test_a_column_of_timestamps_stays_beside_words(tmp_path):
    rows = [f"2026-03-01T12:00:{i:02d}.500,{i % 5},RUN{i % 3}" for i in range(50)]
    (tmp_path / "log.csv").write_text("\n".join(["when,v [m/s],state", *rows]) + "\n")
    record = ss.read(tmp_path / "log.csv")
    assert list(record) == ["v"] and record["v"].time[-1] == 49.0


def test_all_cells_of_quoted_tables_are_read_as_those_of_bare_ones(tmp_path):
    (tmp_path / "a.csv").write_text('"t [s]","v [m/s]"\n' + "".join(f'"{i}","{i % 7}.25"\n' for i in range(300)))
    (tmp_path / "b.csv").write_text("t [s];v [m/s]\n" + "".join(f'{i};"{i % 7},25"\n' for i in range(300)))
    for name in ("a.csv", "b.csv"):
        assert ss.read(tmp_path / name)["v"].values.tolist() == [i % 7 + 0.25 for i in range(300)]


@each_row("end", ["\n", "\r\n", "\r"])
def test_lines_are_those_of_a_list(end):
    text = end.join(["t,v", "", "1,2µ", "3"])
    lines = TextLines.of_text(text)
    assert list(lines) == text.split(end) == [lines[i] for i in range(4)]
    assert list(lines[1:3]) == ["", "1,2µ"] and lines[-1] == "3" and lines.from_line(2).data == "1,2µ\n3".encode()


@each_row(
    ("name", "unit"),
    [("time_ms", "ms"), ("pos_deg", "deg"), ("vel_rpm", "rpm"), ("cur_mA", "mA"), ("F_N", "N"), ("v_mm_s", "mm/s"), ("acc_m_s2", "m/s2"),
     ("v_min", None), ("F_max", None), ("v_s", None), ("z_0", None), ("x_pm", None), ("state_N", None)],
)  # fmt: skip
def test_names_that_end_in_a_unit_declare_it(name, unit):
    assert unit_of_heading(name) == (name, unit)


def test_units_in_names_give_times_and_roles():
    record = ss.read({"time_ms": [0.0, 1.0, 2.0], "pos_deg": [0.0, 90.0, 180.0], "vel_rpm": [60.0, 60.0, 60.0]})
    assert record["position"].name == "pos_deg" and record["position"].time.tolist() == [0.0, 1e-3, 2e-3]
    np.testing.assert_allclose(record["position"].si, [0.0, np.pi / 2, np.pi])
    np.testing.assert_allclose(record["velocity"].si, 2 * np.pi)


def read_of(data, by_hand=False):
    with pytest.MonkeyPatch.context() as patch:
        if by_hand:
            nothing = np.empty(0, int)
            patch.setattr(_Plain, "all_rows", lambda self, data: None)
            patch.setattr(_Plain, "rows", lambda self, data: (nothing, np.empty((0, self._dialect.width))))
        try:
            record = read_bytes(data, "log.txt")
            return {name: (record[name].unit, record[name].values.tolist()) for name in record}, record.notes
        except ss.InputError as error:
            return str(error)


ODD = ["", '""', "null", "-", "1,5",
       '"2.5"', '"a, b"', '"a ""b"""', "oops", "1-2", ".", "-INF", "1D3", " 7 ", '"9', "1\0", "µ", "1\xa0", '"1;2"',
       "1 000", "1_0", "-nan(ind)", "1e400", "9" * 1001]  # fmt: skip


@each_row("seed", range(60))
def test_rows_that_are_read_at_once_are_those_that_are_read_cell_by_cell(seed):
    rng = random.Random(seed)
    mark, width, words, part = rng.choice(",;\t "), rng.randint(1, 4), rng.random() < 0.4, rng.choice([0.02, 0.06])
    point = rng.choice(".,") if mark != "," else "."
    lines = [mark.join(f"name{i}_mm_s" for i in range(width + words))]
    for _ in range(50):
        row = [f"{rng.uniform(-9, 9):.3f}".replace(".", point) if rng.random() > part else rng.choice(ODD) for _ in range(width)]
        row = [*row[:1], rng.choice(["ok", f'"a{mark}b"', '"x ""y"""', "µ", "none"]), *row[1:]] if words else row
        row = [*row, ""] if rng.random() < part else row[: width - (rng.random() < part)] if not words else row
        lines += [rng.choice(["", " ", "\t", "7"])] if rng.random() < part else []
        lines.append(mark.join(row))
    data = "\n".join(lines).encode(rng.choice(["utf-8", "latin-1"]))
    assert repr(read_of(data)) == repr(read_of(data, by_hand=True))


FORMS = [
    "{Y}-{m:02d}-{d:02d}T{H:02d}:{M:02d}:{S:02d}.{f:03d}{zone}", "{d}.{m}.{Y} {H}:{M:02d}:{S:02d},{f:03d}",
    "{m:02d}/{d:02d}/{Y} {h}:{M:02d}:{S:02d} {half}", "{Y}/{m}/{d}{mark}{H:02d}:{M:02d}:{S:02d}", "{H}:{M:02d}:{S:02d}.{f}",
    '"{H:02d}:{M:02d}:{S:02d}"',
]  # fmt: skip


@each_row("seed", range(40))
def test_timestamps_that_are_read_at_once_are_those_that_are_read_line_by_line(seed, monkeypatch):
    rng = random.Random(seed)
    mark, form, index, words = rng.choice(",;\t "), rng.choice(FORMS), rng.random() < 0.4, rng.random() < 0.3
    lines, H = ["n" * index + mark * index + mark.join(["when", "v_mm_s", *["state"] * words])], rng.randrange(24)
    for i in range(120):
        H = (H + rng.randrange(5)) % (25 if rng.random() < 0.05 else 24)
        stamp = form.format(
            Y=rng.choice([2026, 2026, 1, 9999]) if rng.random() < 0.02 else 2026, m=rng.randint(1, 12), d=rng.randint(13, 31), H=H,
            h=rng.randint(1, 12), M=rng.randrange(60), S=rng.randrange(62), f=rng.randrange(1000), mark=mark,
            half=rng.choice(["AM", "pm"]), zone=rng.choice(["", "Z", "+01:00", "-0230"]),
        )  # fmt: skip
        odd = rng.choice(["", "oops", "12:3", stamp + "9", f"{stamp} 7", f"x{stamp}", f"{stamp}µ", f"{stamp}\tPM", f"{stamp} +0100"])
        stamp = odd if rng.random() < 0.04 else stamp
        cells = [*[str(i)] * index, stamp, f"{rng.uniform(-9, 9):.3f}", *["run"] * words]
        lines.append(mark.join(cells))
    data = "\n".join(lines).encode()
    monkeypatch.setattr(stamped_lines, "_TOGETHER", 32)
    at_once = read_of(data)
    monkeypatch.setattr(stamped_lines, "_FORMS", 0)
    assert repr(at_once) == repr(read_of(data))


def test_times_of_day_go_on_over_many_midnights(monkeypatch):
    monkeypatch.setattr(stamped_lines, "_TOGETHER", 7)
    lines = ["time;v [m/s]", *(f"{7 * i % 24:02d}:00:00;{i % 5},5" for i in range(50))]
    np.testing.assert_allclose(read_bytes("\n".join(lines).encode(), "log.csv")["v"].time, [7 * 3600.0 * i for i in range(50)], rtol=1e-15)


def nested(rng, rows):
    """A list of rows, or one of the forms in which programs put it into an object."""
    form = rng.randrange(7)
    if form == 0 and isinstance(rows[0], list):
        return {"columns": ["t", "v"], "data": rows[1:]}
    if form == 1:
        return {"about": {"made": "by hand"}, "rows": rows, "units": {"v": "m/s"}}
    if form == 2 and isinstance(rows[0], dict):
        return {str(i) if rng.random() < 0.999 else "last": row for i, row in enumerate(rows)}
    if form == 3:
        return {
            "t [s]": {str(i): i for i in range(len(rows))},
            "v": {str(i): row.get("v") if isinstance(row, dict) else row[1] for i, row in enumerate(rows)},
        }
    if form == 4:
        return {"t [s]": list(range(len(rows))), "v": [row.get("v") if isinstance(row, dict) else row[1] for row in rows], "note": "none"}
    return rows


@each_row("seed", range(90))
def test_json_that_is_read_in_pieces_is_that_which_is_read_as_a_whole(seed, monkeypatch):
    rng = random.Random(seed)
    odd = ["2.5", "},{", "a],[b", True, [1], [[1], [2]], {"a": {"b": 1}}, 10**400] * (rng.random() < 0.4)

    def cell():
        return rng.choice(odd) if odd and rng.random() < 0.03 else rng.choice([rng.random(), rng.randrange(9), None])

    if rng.random() < 0.5:
        rows = [{"t [s]": i, "v": cell()} | ({"w": cell()} if rng.random() < 0.2 else {}) for i in range(80)]
    else:
        rows = [["t [s]", "v"]] * (rng.random() < 0.5) + [[i, cell()] + [7] * (rng.random() < 0.002) for i in range(80)]
    data = json.dumps(nested(rng, rows), indent=rng.choice([None, None, 1])).encode()
    data = data[: rng.choice([len(data)] * 5 + [len(data) // 2, len(data) - 1])] + rng.choice([b"", b"\n", b"\n", b"]", b"}"])
    whole = read_of(data)
    monkeypatch.setattr(json_pieces, "_PIECE", 60)
    assert repr(read_of(data)) == repr(whole)


def test_an_object_of_too_many_columns_says_so_and_not_that_it_is_damaged():
    said = read_of(("{" + ",".join(f'"a{i}": 1' for i in range(BIG // 4)) + "}").encode())
    assert "the JSON has 4097 columns; allowed are 4096" in said and "damaged" not in said


def test_rows_of_json_lines_keep_the_heading_of_their_first():
    lines = ['["t [s]", "v"]', *(f"[{i}, {i % 7}.5]" for i in range(9000))]
    assert read_bytes("\n".join(lines).encode(), "log.jsonl")["v"].values.tolist() == [i % 7 + 0.5 for i in range(9000)]


def test_a_row_without_separators_is_no_row_of_a_table_with_words():
    record = read_bytes(b"v [m/s],state\n" + b"1.5,ok\n" * 30 + b"7\n" + b"2.5,ok\n" * 9, "log.csv")
    assert record["v"].values.tolist() == [1.5] * 30 + [2.5] * 9
    assert any("1 lines are left out, the first is line 32" in note for note in record.notes)


def test_a_byte_order_mark_is_no_part_of_a_name_whatever_follows_it():
    for data in (
        "\ufefft [ms];µ [N]\n1;2\n2;3\n".encode(),
        b"\xef\xbb\xbft [ms];\xb5 [N]\n1;2\n2;3\n",
        b"\xef\xbb\xbf" * 2 + b"t [ms];v\n1;2\n2;3\n",
    ):
        record = read_bytes(data, "log.csv")
        name = next(iter(record))
        assert name in ("µ", "v") and record[name].time.tolist() == [1e-3, 2e-3]


def test_a_table_is_looked_for_behind_a_long_preamble_or_the_error_says_how_far():
    note = b"# " + b"a remark of the logger; " * 20 + b"\n"
    record = read_bytes(note * 400 + b"t [s];v [mm/s]\n" + b"1,5;2,5\n2,5;3,5\n" * 20, "log.csv")
    assert record["v"].values[:2].tolist() == [2.5, 3.5] and record["v"].unit == "mm/s"
    said = read_of(note * 1200 + b"t [s];v [mm/s]\n" + b"1,5;2,5\n2,5;3,5\n" * 20)
    assert "none of its first 1000 lines is a row of numbers" in said


def test_a_utf_16_text_that_is_cut_within_a_letter_loses_that_letter():
    assert read_bytes("t [s],v [m/s]\n0,1\n1,2\n2,3\n".encode("utf-16")[:-1], "log.csv")["v"].values.tolist() == [1, 2, 3]


def test_json_of_lines_has_the_columns_of_all_its_lines():
    lines = [f'{{"t [s]": {i}, "v": {i % 7}.5}}' for i in range(9000)] + ['{"t [s]": 9000, "w": 3}']
    record = read_bytes("\n\n".join(lines).encode(), "log.jsonl")
    assert record["v"].values[:8999].tolist() == [i % 7 + 0.5 for i in range(8999)] and np.isnan(record["v"].values[9000])
    assert np.isnan(record["w"].values[:9000]).all() and record["w"].values[9000] == 3 and record["w"].time[-1] == 9000


def test_blank_lines_are_left_out_and_counted_in_the_numbers_of_lines():
    rows = [b"%d,%d.25" % (i, i % 7) for i in range(40)]
    rows[20] = b"20,oops"
    record = read_bytes(b"t [s],v [m/s]\n" + b"\n \n\t\n\n\n\n\n\n\n".join(rows), "log.csv")
    np.testing.assert_array_equal(record["v"].values, [i % 7 + 0.25 if i != 20 else np.nan for i in range(40)])
    assert any("the first is line 182: 'oops'" in note for note in record.notes), "nine lines for each row before it, and the heading"
    numbers = "\n\n\n1\n\n\n2\n\n\n"
    lines = TextLines.of_text(numbers * 3)
    assert list(lines) == ["1", "2"] * 3 + [""] and [lines.number(i) for i in range(7)] == [4, 7, 13, 16, 22, 25, 28]


SIZE = 600_000
PAIRS = [f"{i / 1000:.3f},{i % 89 / 7:.3f}" for i in range(SIZE // 14)]
NAMED = ['"t [s]":{},"v [m/s]":{}'.format(*pair.split(",")) for pair in PAIRS]
LARGE = {
    "blank lines": ("t [s],v [m/s]\n", [pair + 40 * "\n" for pair in PAIRS[: len(PAIRS) // 4]], "\n", ""),
    "lines of a blank": ("t [s],v [m/s]\n", [pair + 20 * "\n " for pair in PAIRS[: len(PAIRS) // 4]], "\n", ""),
    "rows in an object": ('{"columns": ["t [s]", "v [m/s]"], "data": [', [f"[{pair}]" for pair in PAIRS], ",", "]}"),
    "objects in an object": ('{"made": "by hand", "rows": [', ["{" + row + "}" for row in NAMED], ",", "]}"),
    "objects by name": ("{", [f'"{i}":{{{row}}}' for i, row in enumerate(NAMED)], ",", "}"),
    "columns by name": ('{"t [s]": {', [f'"{i}":{pair[:5]}' for i, pair in enumerate(PAIRS)], ",", "}}"),
    "columns": ('{"v [m/s]": [', [f"{i / 1e6:.9f}" for i in range(SIZE // 12)], ",", "]}"),
}


@each_row("form", LARGE)
def test_a_large_text_takes_about_five_times_its_size_at_most(form):
    """Python's objects and NumPy's arrays, beside the bytes themselves; twice the text takes twice as much and no more."""
    head, rows, between, tail = LARGE[form]
    peaks = []
    for part in (2, 1):
        data = (head + between.join(rows[: len(rows) // part]) + tail).encode()
        tracemalloc.start()
        try:
            record = read_bytes(data, "log")
            peaks.append(tracemalloc.get_traced_memory()[1])
        finally:
            tracemalloc.stop()
        assert len(record[next(iter(record))].values) == len(rows) // part
    grown = (peaks[1] - peaks[0]) / (len(data) / 2)
    assert grown < 5.5
