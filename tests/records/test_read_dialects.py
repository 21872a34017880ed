"""Separators and decimal marks: headings decide, and what is left open is an error or a note that shows what to type."""

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.errors import InputError


def read(folder, text, **options):
    place = folder / "run.csv"
    place.write_text(text, encoding="utf-8")
    return ss.read(place, **options)


def table(rec):
    """All columns, the axis first."""
    first = next(iter(rec.channels.values()))
    axis = [] if first.axis_name == "sample" else [first.t]
    return np.column_stack([*axis, *(c.values for c in rec.channels.values())]).tolist()


@each_row(
    ("text", "rows", "names"),
    [
        ("t [ms],v [mm/s]\n1,2\n2,3\n3,5\n", [[1, 2], [2, 3], [3, 5]], ["v"]),  # two names: the commas part columns
        ("t [ms];v [mm/s]\n1,5;2,5\n2,5;3,25\n", [[1.5, 2.5], [2.5, 3.25]], ["v"]),
        ("t [ms];v [mm/s]\n1;2\n2;3\n", [[1, 2], [2, 3]], ["v"]),
        ("v [mm/s]\n1,5\n2,25\n", [[1.5], [2.25]], ["v"]),  # one name: they are decimal marks
        ("v [mm/s]\n1.5\n2.25\n", [[1.5], [2.25]], ["v"]),
        ("t [ms]\tv [mm/s]\n1,5\t2\n2,5\t3\n", [[1.5, 2], [2.5, 3]], ["v"]),
        ("t [ms] v [mm/s]\n1 2\n2 3\n", [[1, 2], [2, 3]], ["v"]),  # a unit in brackets belongs to its name
        ("t [ms]   v [mm/s]\n1,5 2,5\n2,5 3,5\n", [[1.5, 2.5], [2.5, 3.5]], ["v"]),
        ("t [ms],F [N, rms]\n1,2\n2,3\n", [[1, 2], [2, 3]], ["F"]),  # a comma in brackets parts nothing
        ('"t [ms]","v, left [mm/s]"\n1,2\n2,3\n', [[1, 2], [2, 3]], ["v, left"]),  # nor one in quotes
        ('"t [ms]","v [mm/s]"\n"1,5","2,5"\n"2,5","3,5"\n', [[1.5, 2.5], [2.5, 3.5]], ["v"]),  # quoted decimal commas
        ("a,b,c\n1,2,3\n2,3,4\n", [[1, 2, 3], [2, 3, 4]], ["a", "b", "c"]),
        ("1,2,3\n2,3,4\n", [[1, 2, 3], [2, 3, 4]], ["column 2", "column 3"]),  # three of them cannot be decimal marks
        ("1,2.5\n2,3\n", [[1, 2.5], [2, 3]], ["column 2"]),  # the point is the decimal mark
        ("1;2,5\n2;3,5\n", [[1, 2.5], [2, 3.5]], ["column 2"]),
        ("t,v\n" + "".join(f"{i},0\n" for i in range(2000)) + "2000,0.5\n", None, ["v"]),  # rest, and one point at the end
        ("t;v\n" + "".join(f"{i};0\n" for i in range(2000)) + "2000;0,5\n", None, ["v"]),
    ],
)  # fmt: skip
def test_headings_and_marks_decide_how_numbers_are_read(tmp_path, text, rows, names):
    rec = read(tmp_path, text)
    assert list(rec.channels) == names
    if rows is None:
        c = rec["v"]
        assert c.values[-1] == 0.5 and c.t[-1] == 2000 and len(c) == 2001 and not any("NaN" in n for n in rec.notes)
    else:
        assert table(rec) == rows


@each_row(
    ("text", "options"),
    [
        ("1,2\n2,3\n3,5\n", ['separator=","', 'decimal=","']),  # two whole numbers, or one with a decimal comma
        ("time, s\n1,5\n2,5\n", ['separator=","', 'decimal=","']),  # two names, or one with its unit
        ("t,v\n1,2,3,4\n2,3,4,5\n", ["name 2 columns", "decimal"]),  # commas as both
        ("0,001,1,234\n0,002,1,235\n", ["begin with a zero", "decimal"]),
        ("t;F\n1,000;1,234\n2,000;2,345\n", ['decimal=","', 'decimal="."']),  # decimals or thousands
        ("F [N]\n1,234\n2,345\n", ['decimal=","', 'decimal="."']),
        ("F [N]\n1 234\n2 345\n", ["thousands", 'decimal="."']),
        ("t [ms]\tF [N]\n1 000\t1 234\n2 000\t2 345\n", ["thousands", 'decimal="."']),
        ("1 000\t1 234\n2 000\t2 345\n", ["thousands", 'separator=" "']),
        ("t;F\n1,234.5;2\n2,345.5;3\n", ["decimal", "separator"]),
        ("t;v\n1,5;2.5\n2,5;3.5\n", ["decimal"]),  # mixed decimal marks
    ],
)  # fmt: skip
def test_what_can_be_read_in_two_ways_is_an_error_that_says_what_to_type(tmp_path, text, options):
    with pytest.raises(InputError) as error:
        read(tmp_path, text)
    assert all(word in str(error.value) for word in options), str(error.value)


@each_row(
    ("text", "options", "rows"),
    [
        ("1,2\n2,3\n", {"separator": ","}, [[1, 2], [2, 3]]),
        ("1,2\n2,3\n", {"decimal": ","}, [[1.2], [2.3]]),
        ("t;F\n1,000;1,234\n2,000;2,345\n", {"decimal": ","}, [[1, 1.234], [2, 2.345]]),
        ("t;F\n1,000;1,234\n2,000;2,345\n", {"decimal": "."}, [[1000, 1234], [2000, 2345]]),
        ("t;F\n1,234.5;2\n2,345.5;3\n", {"decimal": "."}, [[1234.5, 2], [2345.5, 3]]),
        ("t;F\n1.234,5;2\n2.345,5;3\n", {"decimal": ","}, [[1234.5, 2], [2345.5, 3]]),
        ("F [N]\n1 234\n2 345\n", {"separator": "\t", "decimal": "."}, [[1234], [2345]]),
        ("1,5, 2,5\n2,5, 3,5\n", {"separator": ", ", "decimal": ","}, [[1.5, 2.5], [2.5, 3.5]]),
    ],
)
def test_what_is_typed_decides(tmp_path, text, options, rows):
    assert table(read(tmp_path, text, **options)) == rows


def test_what_is_decided_without_proof_is_told(tmp_path):
    assert any('separator=","' in note for note in read(tmp_path, "v [mm/s]\n1,5\n2,25\n").notes)
    assert any("whole number" in note for note in read(tmp_path, "1,2,3,4\n2,3,4,5\n").notes)
    assert any("before exactly three digits" in note for note in read(tmp_path, "t;F\n1;1.234\n2;2.345\n").notes)
    assert any("names are not used" in note for note in read(tmp_path, "t;v;w\n1;2\n2;3\n").notes)


def test_the_command_takes_marks_too(tmp_path, capsys):
    from stickslip.show.cli import main

    (tmp_path / "run.csv").write_text("1,2\n2,3\n3,5\n")
    assert main(["read", str(tmp_path / "run.csv")]) == 2 and 'type --separator "," or --decimal ","' in capsys.readouterr().err
    assert main(["read", str(tmp_path / "run.csv"), "--decimal", ","]) == 0 and "1.2 to 3.5" in capsys.readouterr().out
