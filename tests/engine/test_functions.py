"""Functions of plain numbers and arrays as instructions: what they compute is what Python computes from the same text."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from engine.test_emit import as_bits, as_float, fma
from rows import each_row
from stickslip.engine import cache, driver

TEXT = '''
HALF, FEW = 0.5, 3
WEIGHTS = [1.0 / (k + 1) for k in range(4)]


@typed("UniTuple(float64, 2)(float64, float64)")
def ordered(a, b):
    """Two numbers in order."""
    if a <= b:
        return a, b
    return b, a


@typed(Tuple((int64, float64))(int64, float64))
def counted(n, x):
    k = 0
    while True:
        k += 1
        if k % 3 == 0:
            continue
        if k > n:
            break
        x = x * HALF + k
    return k, x


@typed(boolean(i1, int64))
def guarded(numbers, at):
    return at < len(numbers) and numbers[at] > 2 or not (at != 1)


@typed(float64(f2, int64))
def weighed(table, row):
    """A row that is another one in each round, and numbers of constants."""
    total, here, k = 0.0, table[row], 0
    for i in range(table.shape[0]):
        here = table[i]
        for j in range(min(table.shape[1], len(WEIGHTS)) - 1, -1, -1):
            total = fma(total, WEIGHTS[j], here[j])
            k = j
    rest = here[1:]
    return total + rest[0] + len(rest) + k + 100 * i + 1000 * j


@typed(int64(int64, int64))
def bits(a, b):
    found = (a & b) | (a ^ 5) << 1
    found |= (a > b) << 4
    found = ~found >> 1
    return found - (a // b) + a % b + (-a) // FEW


@typed(void(f1, i1, b2, int64))
def worked(x, n, small, count):
    places, totals = np.zeros(count, dtype=np.int64), np.zeros(count)
    room = np.empty(2)
    for k in range(count):
        places[k] += k * k
        totals[k] -= 0.25 * k
    room[0], room[1] = totals[count - 1], places[count - 1]
    x[0], x[1] = room[1], room[0]
    low, high = ordered(x[2], x[3])
    x[4], x[5] = max(low, high, x[6]), min(x[3], x[2])
    k, x[6] = counted(n[0], x[2])
    n[1] = k
    x[7] = math.sqrt(abs(x[2])) + math.floor(x[3]) + math.copysign(1.5, x[3]) - abs(n[2])
    x[8] = (math.inf if x[2] > x[3] else 1) if guarded(n, 2) else -x[2]
    x[9] = counted(2, 1.0)[1] + (x[2] * x[2]) ** 0.5 + as_float(as_bits(x[3]))
    small[1, 0] = n[2] % 7
    n[3] = bits(n[0], n[2]) + small[1, 0] + np.int64(x[2] * 10.0)
    seen = False
    for i in range(n[0]):
        if i == 4:
            seen = True
        elif seen:
            n[4] = i
            break
    x[10] = float("nan") if seen else np.float64(n[0]) / 4
    x[11] = math.log2(abs(x[3]) + 1.0) + math.expm1(x[3]) if not seen and n[0] > 0 else 0.0
    n[5] = np.int64(seen) + (x[10] != x[10])


@typed(float64(float64, int64), fused=True)
def turned(x, count):
    """Functions of angles, an array of rows and one of small numbers; its products and sums are exact, however they are rounded."""
    grid, codes = np.zeros((count, 3)), np.empty(count, dtype=np.int8)
    for i in range(count):
        codes[i] = -2 * i
        for j in range(3):
            grid[i, j] = 0.5 * i + j * codes[i]
    if count < 1:
        angle = math.sin(x) if x > 0.0 else math.cos(x)
        return angle if angle * angle < 0.5 else math.asin(0.5 * angle) if angle > 0.0 else math.pi
    return grid[count - 1, 2] * 0.5 + codes[count - 1]


@typed(float64(f1, i1, f2, b2))
def entry(x, n, table, small):
    if n[0] < 0:
        return -1.0
    worked(x, n, small, n[0] + 2)
    x[0] = turned(x[2], n[0])
    return weighed(table, n[0] % 3)
'''


def compiled(text, entry="entry", takes="float64(f1, i1, f2, b2)"):
    """A function of a text, as kernels get theirs."""
    return cache.load(driver.source({entry: takes}, [text], ()), "functions_test", "a test")[entry]


def in_python(text):
    """The same text, run by Python itself."""

    def typed(*_, **__):
        return lambda function: function

    known = {"typed": typed, "np": np, "math": math, "fma": fma, "int64": type_of, "float64": type_of, "boolean": type_of}
    known |= {"void": type_of, "Tuple": lambda _: type_of, "f1": 0, "f2": 0, "i1": 0, "b2": 0}
    known |= {"as_bits": as_bits, "as_float": as_float}
    exec(text, known)
    return known["entry"]


def type_of(*_):
    """In place of a type."""


@pytest.mark.parametrize("count", [-1, 0, 1, 3, 6])
@each_row("seed", range(8))
def test_a_text_computes_what_python_computes(count, seed):
    rng = np.random.default_rng(seed)
    x = rng.normal(size=12) * 10.0 ** rng.integers(-2, 3, 12)
    n = np.array([count, 0, rng.integers(-9, 9) or 4, 0, 0, 0])
    table, results = rng.integers(-8, 8, (3, 4)).astype(float), []
    for act in (compiled(TEXT), in_python(TEXT)):
        given = x.copy(), n.copy(), table.copy(), np.zeros((2, 2), dtype=np.int8)
        results.append((act(*given), *given))
    for ours, theirs in zip(*results, strict=True):
        assert np.array_equal(ours, theirs, equal_nan=True)


@each_row(
    ("body", "what"),
    [
        ("k = 1\n    for i in range(3):\n        k = 0.5\n    return k", "is given to a name"),
        ("return sum(x)", "'sum(x)' in a function of plain numbers is not among"),
        ("return 1.0 if 0 < n[0] < 3 else 2.0", "0 < n[0] < 3"),
        ("return y", "'y' in a function of plain numbers has no value"),
        ("for k in range(3):\n        x[0] = k\n    else:\n        x[1] = 2.0\n    return x[0]", "else"),
        ("return table[0][1:].mean()", "mean"),
        ("rest = x[1:3]\n    return rest[0]", "x[1:3]"),
        ("for k in range(3, 0, -n[0]):\n        x[0] = k\n    return x[0]", "range(3, 0, -n[0])"),
    ],
)
def test_what_cannot_be_written_is_refused_with_its_text(body, what):
    with pytest.raises(Exception, match=re.escape(what)):
        compiled(f"@typed(float64(f1, i1, f2, b2))\ndef entry(x, n, table, small):\n    {body}\n")
