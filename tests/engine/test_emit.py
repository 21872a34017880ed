"""The lines of a step as instructions: what they compute is what Python computes, on one lane and on many, and it is found again."""

from __future__ import annotations

import ast
import math
import os
import struct
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest

from rows import each_row
from stickslip.engine import cache, emit, expressions
from stickslip.engine.instructions import DOUBLE, VOID, Builder, Function, Module, function_type
from stickslip.engine.kernel_text import KernelSource, StepLines
from stickslip.engine.rosenbrock_step import Step
from stickslip.engine.steptext import Layout, step_text

LINES = """
_sum = _a + _b
_difference = _a - _b * 3
_product = -_a * (-2.5)
_quotient = _a / _b
_fused = fma(_a, _b, _c0)
_size = abs(_a) + abs(-0.0)
_root = math.sqrt(_size)
_more = 1.0 if _a > _b else 2.0
_less = 1.0 if _a < _b else 2.0
_not_less = 1.0 if _a >= 0.0 else 2.0
_not_more = 1.0 if _a <= 0.0 else 2.0
_same = 1.0 if _a == _b else 2.0
_other = 1.0 if _a != _b else 2.0
_number = 1.0 if _a == _a else 2.0
_holds = (_a > 0.0 and not _b > 0.0) or _a == _b or False
_chosen = (_a if _holds else _b) if _a > -1.0 else (rtol if True else budget)
_both = 1.0 if ((_a > 0.0) if _b > 0.0 else _holds) else 0.0
_power = as_float((as_bits(_a) + 1023) << 52)
_exponent = ((as_bits(_size) - 4604544271217802189) >> 52) * 1.0
_turned = as_float(as_bits(_a) ^ (as_bits(_b) << 63))
_masked = as_float((as_bits(_a) & 4503599627370495) | as_bits(_b))
_whole = np.int64(_small * 1e6) * 0.5
_late = math.nan if _a > 1e200 else (math.inf if _a > 1e100 else -math.inf)
_a = budget + 0.5 * _a
_tend = _a
_r = row(7)
_r[0] = 1.0 * _small
_r[1] = _b
_total = 0.0
_turn = 1.0
_before = 0.0
for m in range(2, 7):
    _inverse = 1 / m
    _between = 5.0
    for j in range(1, m):
        _between = fma(_r[j], _r[m - j], _between)
    _within = _inverse * _between
    _r[m] = m * _within - 2 * (m - 1) * _r[m - 1]
    _held[m - 2] = _within
    _total = _total + abs(_held[m - 2])
    _swapped = _before
    _before = _turn
    _turn = 1.0 + _swapped
for j in range(4, 4):
    _total = 77.0
_last = _r[6]
_around = 0.0
for j in each(1, 4):
    for m in outwards(1, j + 3):
        _around = fma(_r[m], _small, 0.5 * _around)
for m in halves(1, 6):
    _around = fma(_r[m], _r[6 - m], _around)
for m in middle(1, 6):
    _around = fma(_r[m], _r[m], _around + _around)
""".strip().splitlines()
ASKED = "void(f1, float64, float64)"
BRANCH = ["_twice = 1.0", "if _a > 0.0:", "    _within = 2.0 * _a", "    _twice = _within + _twice if _a > 0.0 else _twice"]
BRANCH += ["_after = _twice + _a"]
NUMBERS = [0.0, -0.0, 1.0, -1.0, 0.1, -2.5, 3e-310, 1e300, -1e-300, math.inf, -math.inf, 7.0, 1 / 3, 1e16, -1e150, 2.0]


def fma(a, b, c):
    """By fractions: rounded once."""
    if not all(map(math.isfinite, (a, b, c))):
        return a * b + c
    exact = Fraction(a) * Fraction(b) + Fraction(c)
    try:
        return float(exact) if exact else a * b + c
    except OverflowError:
        return math.inf if exact > 0 else -math.inf


def as_bits(x):
    return struct.unpack("<q", struct.pack("<d", x))[0]


def as_float(i):
    return struct.unpack("<d", struct.pack("<Q", int(i) % 2**64))[0]


def plain(lines, given):
    """The same lines by Python itself, for one lane; numbers divide as processors do."""
    known = {"fma": fma, "as_bits": as_bits, "as_float": as_float, "math": math, "np": np, "rtol": 0.25, "budget": 8.0}
    known |= emit.ROUNDS | {"row": lambda length: [math.nan] * length, "_held": [math.nan] * 5}
    known |= {f"_{name}": np.float64(value) for name, value in given.items()}
    with np.errstate(all="ignore"):
        exec("\n".join(lines), known)
    return known | {f"_held_{m}": value for m, value in enumerate(known["_held"])}


def compiled(lines, lanes, group, width):
    """A kernel of these lines alone, on the numbers of each lane: what it gives a value to."""
    made = [line.partition(" = ")[0][1:] for line in lines if not line.startswith(("_holds", " ", "if", "for", "_r[", "_r ="))]
    fields = list(dict.fromkeys(["a", "b", "small", *made, *(f"held_{m}" for m in range(5))]))
    step = Step(tuple(lines), tuple(fields), (None,), 1)
    layout = Layout(lanes, group, width, {name: i * lanes for i, name in enumerate(fields)}, len(fields) * lanes)
    asked = f"@typed({ASKED})\ndef asked(S, rtol, budget):\n    step(S, rtol, budget)\n"
    step = cache.load(KernelSource(asked, {"asked": ASKED}, step_text(step, layout)), f"emit_{lanes}", "a test")["asked"]

    def act(given):
        S = np.full((len(fields) + 1, lanes), 77.0)
        for name in ("a", "b", "small"):
            S[fields.index(name)] = given[name]
        S[-1] = given["c0"]
        step(S.ravel(), 0.25, 8.0)
        return dict(zip(fields, S, strict=False))

    return act


def drawn(rng, count):
    """Numbers of each lane: special ones beside special ones, and others of all sizes; `small` fits a whole number."""
    pick = np.concatenate([NUMBERS, rng.normal(size=16) * 10.0 ** rng.integers(-9, 9, 16)])
    given = {name: rng.choice(pick, count) for name in ("a", "b", "c0")}
    return given | {"small": rng.uniform(-1e3, 1e3, count)}


def same(a, b):
    return np.float64(a).tobytes() == np.float64(b).tobytes() or (math.isnan(a) and math.isnan(b))


@each_row(("lanes", "group", "width"), [(1, 1, 1), (4, 4, 4), (8, 4, 4), (16, 16, 8)])
def test_every_operation_is_what_python_computes(lanes, group, width):
    """To the bit: each is rounded once by both."""
    lines = LINES + BRANCH
    act, rng = compiled(lines, lanes, group, width), np.random.default_rng(5)
    for _ in range(640 // lanes):
        given = drawn(rng, lanes)
        found = act(given)
        for lane in range(lanes):
            expected = plain(lines, {name: values[lane] for name, values in given.items()})
            for name in found.keys() - {"b", "small"}:
                assert same(found[name][lane], float(expected[f"_{name}"])), (name, {n: v[lane] for n, v in given.items()})


def test_lanes_jump_over_what_none_of_them_asks_for():
    """Where one asks, all are given it."""
    lines = ["_c = 1.0", "if _a > 0.0:", "    _c = 2.0"]
    act = compiled(lines, 8, 4, 4)
    given = {name: np.zeros(8) for name in ("b", "c0", "small")}
    assert act(given | {"a": -np.ones(8)})["c"].tolist() == [1.0] * 8
    assert act(given | {"a": np.array([-1.0, -1.0, -1.0, -1.0, -1.0, 1.0, -1.0, -1.0])})["c"].tolist() == [1.0] * 4 + [2.0] * 4


def test_of_two_parts_the_one_that_more_lanes_ask_for_is_done():
    """All lanes of a group are counted, those of all its vectors; where none asks, nothing is done."""
    lines = ["_c = 1.0", "if more(_a > 0.0, _b > 0.0):", "    _c = 2.0"]
    act = compiled(lines, 8, 8, 4)
    given = {name: np.zeros(8) for name in ("c0", "small")}
    for these, those in ((1, 2), (2, 2), (5, 4), (0, 0)):
        found = act(given | {"a": np.arange(8.0) > 7.5 - these, "b": np.arange(8.0) < those})
        assert found["c"].tolist() == [2.0 if these >= those > 0 else 1.0] * 8


def test_rounds_of_sums_begin_in_the_middle():
    """What the outermost terms need is ready last."""
    rounds = {name: list(order(1, 7)) for name, order in emit.ROUNDS.items()}
    assert rounds == {"each": [1, 2, 3, 4, 5, 6], "outwards": [3, 4, 2, 5, 1, 6], "halves": [3, 2, 1], "middle": []}
    assert emit.ROUNDS["middle"](1, 6) == [3] and sorted(emit.ROUNDS["halves"](1, 6)) == [1, 2]


def test_vectors_that_do_not_fit_into_registers_lie_within_lines_of_the_cache():
    module = Module()
    emit._function(module, []).append_basic_block()
    assert "alignstack(64)" in module.text()


def test_the_lines_above_hold_every_operation_there_is():
    nodes = {type(node) for node in ast.walk(ast.parse("\n".join(LINES + BRANCH)))}
    assert nodes >= {*expressions.ON_FLOATS, *expressions.ON_INTEGERS, *expressions.COMPARED, *emit.JOIN}
    calls = {ast.unparse(node.func) for node in ast.walk(ast.parse("\n".join(LINES))) if isinstance(node, ast.Call)}
    assert calls == {*expressions.INTRINSICS, *emit.CASTS, "row", "range", *emit.ROUNDS}
    visited = {name.removeprefix("visit_") for name in dir(emit._Vector) if name.startswith("visit_")}
    assert visited | {"For"} <= {node.__name__ for node in nodes}


@each_row(
    "line",
    [
        "_x = _a ** 2.0", "_x = 5 % 2", "_x = 1.0 < 2.0 < 3.0", "_x = _unknown", "_x = sin(1.0)", "_x = as_bits(5)", "_x = not 1.0",
        "_x = 1.0 if 2.0 else 3.0", "_x = True + 1.0", "_x = 1.0 and 2.0", "_x, _y = 1.0, 2.0", "_x = 'text'", "_x = 2 < 3",
        "if 1.0:\n    _x = 1.0", "_x = math.tau", "_x += 1.0", "_x = 1.0 / True", "_x = -True", "_x = fma(1.0, 2.0)", "_x = _r[0]",
        "_x = row(5)\n_y = _x[1.0]", "_x = row(1.0)", "for m in range(4):\n    _x = 1.0", "for m in 5:\n    _x = 1.0",
        "for m in range(0, 2.0):\n    _x = 1.0", "for m, n in range(0, 2):\n    _x = 1.0", "_a.b[0] = 1.0", "_x = row(3)\n_x[0] = True",
    ],
)  # fmt: skip
def test_a_line_that_cannot_be_written_is_named(line):
    function = Function(Module(), function_type(VOID, (DOUBLE.as_pointer(),)), "f")
    builder = Builder(function.append_basic_block())
    with pytest.raises(TypeError, match="in a line of a step"):
        emit.write(builder, function.args[0], StepLines(line, 4, 4, 4, {}, {}, {}), {})


def test_a_line_that_asks_for_what_no_lane_holds_is_refused():
    with pytest.raises(AssertionError, match="_missing"):
        step_text(Step(("_a = _missing + _b",), ("a", "b"), (), 1), Layout(1, 1, 1, {"a": 0, "b": 1}, 2))


_KERNEL = """
import stickslip as ss
from stickslip.engine import lanes, tableaux
lanes.kernel_of(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4), tableaux.RODAS5P, record=True)
"""


def test_kernels_are_found_again_by_the_next_process(tmp_path):
    """The second process compiles nothing, and writes nothing."""
    told, files, environment = [], [], os.environ | {"STICKSLIP_CACHE_DIR": str(tmp_path)}
    for _ in range(2):
        done = subprocess.run([sys.executable, "-c", _KERNEL], env=environment, capture_output=True, text=True, check=True)
        told.append(done.stderr.count("once …"))
        files.append({file: file.stat().st_mtime_ns for file in tmp_path.iterdir()})
    assert told == [1, 0]
    assert files[0] == files[1] and len(files[0]) == 1
