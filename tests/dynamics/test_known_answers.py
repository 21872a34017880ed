"""The table of known answers says what the public functions give."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

from rows import each_row

ROOT = Path(__file__).parents[2]
spec = importlib.util.spec_from_file_location("known_answers", ROOT / "verification" / "known_answers.py")
known_answers = importlib.util.module_from_spec(spec)
sys.path.insert(0, str(ROOT / "verification"))  # where its systems are
spec.loader.exec_module(known_answers)
ROWS = known_answers.ROWS
QUICK = (
    "meissner",
    "impact",
    "pitchfork",
    "cusp",
    "leine",
    "leine_rounded",
    "leine_lugre",
    "rig",
    "rig_lugre",
    "pecks",
    "pecks_down",
    "bends",
)
PAGE = (ROOT / "notes" / "known-answers.md").read_text(encoding="utf-8")
PRINTED = {
    line.split("|")[1].strip(): [cell.strip() for cell in line.split("|")[2:-1]] for line in PAGE.splitlines() if line.startswith("| ")
}


def numbers(cell):
    return [float(number) for number in cell.split(",")]


@each_row("name", ROWS)
def test_the_page_has_every_row_and_each_lies_within_what_it_says(name):
    row = ROWS[name]
    _, known, ours, _, within = PRINTED[row.system]
    np.testing.assert_allclose(numbers(known), row.known, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(numbers(ours), row.known, rtol=0, atol=row.within)
    assert float(within) == row.within


@pytest.mark.parametrize("name", [pytest.param(name, marks=[] if name in QUICK else pytest.mark.slow) for name in ROWS])
def test_a_known_answer_is_found_again(name):
    row = ROWS[name]
    np.testing.assert_allclose(row.ours(), row.known, rtol=0, atol=row.within)
