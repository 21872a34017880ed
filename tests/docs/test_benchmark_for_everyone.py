"""The benchmark for everyone: its script judges as it says, its rows are posed as they say, and our adapter solves them."""

import importlib.util
import json
import math
import sys

import pytest

from house import ROOT
from rows import each_row

FOLDER = ROOT / "benchmarks" / "everyone"
ROWS = {row["id"]: row for row in json.loads((FOLDER / "rows.json").read_text(encoding="utf-8"))["rows"]}
#: One of each sort; the others run when asked for.
QUICK = ("T8", "P6 Coulomb 0.3 mm")


def loaded(name):
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in ROWS])
def test_our_adapter_is_within_the_tolerance_of_a_row(name):
    scored = loaded("score").score(ROWS[name], loaded("with_stickslip").mean_velocity)
    assert scored["verdict"] == "exact", scored


@each_row(
    ("answer", "verdict"), [(1.0, "exact"), (1.0 + 1e-4, "good"), (1.02, "rough"), (1.1, "wrong"), (math.nan, "wrong"), (None, "not posed")]
)
def test_an_answer_is_judged_by_its_distance_from_the_known_one(answer, verdict):
    row = {"id": "a", "mean_velocity": 1.0, "velocity_unit": 1.0, "tolerance": 1e-9}
    assert loaded("score").score(row, lambda row: answer)["verdict"] == verdict


def test_a_simulator_that_fails_is_wrong_and_the_table_says_how():
    row = {"id": "a", "mean_velocity": 0.0, "velocity_unit": 1.0, "tolerance": 1e-9}
    scored = loaded("score").score(row, lambda row: 1 / 0)
    assert scored["verdict"] == "wrong" and "division by zero" in loaded("score").line(scored)


def test_every_row_says_where_its_number_comes_from():
    for name, row in ROWS.items():
        assert row["methods"] and row["source"] and 0 < row["tolerance"] < 1e-5, name
        assert row["period"] > 0 and 0 <= row["of_body"] < len(row["bodies"]), name
