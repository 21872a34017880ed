"""Every function of `stickslip.maths` is one function: on floats, arrays, symbols, dual numbers, in LaTeX and in compiled steps."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import mpmath as mp
import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip import maths
from stickslip.basics.forward_ad import variables
from stickslip.engine import cache
from stickslip.engine.kernel_text import KernelSource, function
from stickslip.engine.rows import write_rows
from stickslip.engine.symbols import FUNCTIONS, Graph, Sym
from stickslip.engine.write import Writer

#: Where each function is asked: large and small arguments of both signs, where it has a value.
EVERYWHERE = np.concatenate([s * 10.0 ** np.linspace(-12, 1.5, 400) for s in (1, -1)])
POINTS = {"log": abs(EVERYWHERE), "sqrt": abs(EVERYWHERE), "exp": np.linspace(-690, 690, 801)}
#: Absolute errors count for what turns (its argument is reduced by pi in parts) and for log near 1; elsewhere all digits do.
ABSOLUTE = ("sin", "cos", "log")
#: A reduction, a polynomial and two or three operations: a few roundings of 1.1e-16 each.
ROUNDINGS = 2e-15


def points(name):
    return POINTS.get(name, EVERYWHERE)


def exactly(name, x):
    with mp.workdps(30):
        return np.array([float(getattr(mp, name)(mp.mpf(float(value)))) for value in x])


def error(name, found, right):
    size = np.ones_like(right) + (name == "log") * abs(right) if name in ABSOLUTE else abs(right)
    return float(np.max(abs(np.asarray(found) - right) / size))


def test_every_function_that_equations_may_have_is_public():
    assert set(FUNCTIONS) <= set(maths.__all__)
    assert set(maths.__all__) - set(FUNCTIONS) == {"hypot", "is_symbol", "maximum", "minimum", "pi", "where", "within", "wrapped"}


@each_row("name", FUNCTIONS)
def test_floats_and_arrays_have_the_right_values(name):
    function, x = getattr(maths, name), points(name)
    right = exactly(name, x)
    assert error(name, function(x), right) < ROUNDINGS
    assert error(name, [function(float(value)) for value in x], right) < ROUNDINGS


def compiled(names):
    """One kernel that writes every function of its argument into a column."""
    graph, w = Graph(), Writer(prefix="_")
    x = graph.variable("x")
    lines = [w.value(getattr(maths, name)(x), {"x": "x[i]"}) for name in names]
    body = [*w.lines, *(f"out[{k}, i] = {value}" for k, value in enumerate(lines))]
    text = function("apply", "x, out", ["for i in range(len(x)):", *(f"    {line}" for line in body)], "void(f1, f2)")
    return cache.load(KernelSource(text, {"apply": "void(f1, f2)"}), "test_functions", "functions")["apply"]


def test_compiled_functions_are_exact_to_a_few_units_and_saturate_as_plain_ones_do():
    apply = compiled(FUNCTIONS)
    for k, name in enumerate(FUNCTIONS):
        x = np.ascontiguousarray(points(name))
        out = np.empty((len(FUNCTIONS), len(x)))
        apply(x, out)
        wrong = abs(out[k] - exactly(name, x)).max() if name == "tanh" else error(name, out[k], exactly(name, x))  # of its height, 1
        assert wrong < ROUNDINGS, name
    far = np.array([800.0, -800.0, 1e6, -1e6, 1e100, -1e100])
    out = np.empty((len(FUNCTIONS), len(far)))
    apply(far, out)
    for k, name in enumerate(FUNCTIONS):
        if name not in ("sin", "cos"):  # there the argument has no digits left to reduce
            np.testing.assert_allclose(out[k], getattr(maths, name)(far), rtol=1e-14, atol=1e-300, err_msg=name)


@each_row("name", FUNCTIONS)
def test_slopes_of_symbols_and_of_duals_are_the_derivative(name):
    """Against mpmath's derivative, in 30 digits."""
    from stickslip.engine.symbols import Sym as Node

    graph = Graph()
    x = graph.variable("x")
    slope = graph.derivative(getattr(maths, name)(x), x)

    def value(node, at):
        if not isinstance(node, Node):
            return node
        a = [value(arg, at) for arg in node.args]
        match node.op:
            case "constant":
                return node.value
            case "variable":
                return at
            case "add":
                return a[0] + a[1]
            case "subtract":
                return a[0] - a[1]
            case "multiply":
                return a[0] * a[1]
            case "reciprocal":
                return 1 / a[0]
            case "bell":
                return 1 / math.cosh(a[0]) ** 2
        return getattr(maths, node.op)(a[0])

    for at in (0.3, 1.7, 2.9) if name in ("log", "sqrt") else (-2.9, -0.3, 0.3, 1.7):
        with mp.workdps(30):
            right = float(mp.diff(getattr(mp, name), at))
        (dual,) = variables(np.array([at]))
        assert value(slope, at) == pytest.approx(right, rel=1e-14)
        assert getattr(maths, name)(dual).slope(0)[0] == pytest.approx(right, rel=1e-14)


@each_row("name", FUNCTIONS)
def test_taylor_series_of_every_function_are_those_of_mpmath(name):
    """y' = 1 - y/2 from y = 0.7: the series of f(y(t)), written by the engine and added up in Python, against mpmath's."""
    graph = Graph()
    y = graph.variable("v")
    slope = 1.0 - 0.5 * y

    w, wanted = Writer(prefix="_"), getattr(maths, name)(y)
    rows = write_rows((y,), (slope,), [wanted], w, {"v": "0.7"}, 8)
    w.line("_first", w.value(wanted, {"v": "0.7"}))
    space = {"fma": lambda a, b, c: a * b + c, "math": math, "as_bits": bits, "as_float": floats, "row": lambda length: [0.0] * length}
    exec("\n".join(w.lines), space)
    found = [space["_first"], *space[rows[wanted.number]][1:]]
    with mp.workdps(40):
        right = mp.taylor(lambda t: getattr(mp, name)(2 - mp.mpf("1.3") * mp.e ** (-t / 2)), 0, 8)
    np.testing.assert_allclose(found, [float(c) for c in right], rtol=1e-12, atol=1e-15)


def bits(x):
    return int(np.float64(x).view(np.int64))


def floats(i):
    return float(np.int64(((int(i) + 2**63) % 2**64) - 2**63).view(np.float64))


def test_no_function_raises_or_warns_wherever_it_is_asked():
    """A branch that `where` does not take is computed too."""
    strange = [0.0, -0.0, -1.0, 1e-320, 800.0, -800.0, 1e300, -1e300, math.inf, -math.inf, math.nan]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for name in FUNCTIONS:
            alone = [getattr(maths, name)(x) for x in strange]
            np.testing.assert_allclose(alone, getattr(maths, name)(np.array(strange)), rtol=1e-15, err_msg=name)


def test_hypot_is_one_function_too():
    assert maths.hypot(3.0, 4.0) == 5.0
    np.testing.assert_array_equal(maths.hypot(np.array([3.0, 5.0]), np.array([4.0, 12.0])), [5.0, 13.0])
    graph = Graph()
    x = graph.variable("x")
    assert isinstance(maths.hypot(x, 4.0), Sym)
    (dual,) = variables(np.array([3.0]))
    assert maths.hypot(dual, 4.0).slope(0)[0] == pytest.approx(0.6, rel=1e-15)


@dataclass(frozen=True)
class EveryFunction:
    """A set-valued law in which every function stands; all of them are smooth and of size 1 where it is asked."""

    mu: float = 0.15
    w: float = 0.02

    def sliding(self, v, load):
        u = abs(v) / self.w
        m = maths
        smooth = m.exp(-u) + m.log(1 + u) / 4 + m.sqrt(1 + u) / 4 + m.sin(u) / 8 + m.cos(u) / 8 + m.atan(u) / 8
        smooth = smooth + m.sinh(u / 4) / 8 + m.cosh(u / 4) / 8 + m.tanh(u) / 8 + m.asinh(u) / 8 + m.hypot(u, 1.0) / 8
        return m.where(v > 0, 1.0, -1.0) * self.mu * load * smooth

    def breakaway(self, load):
        return -2 * self.mu * load, 2 * self.mu * load


@dataclass(frozen=True)
class Creeping:
    """The same friction as a stiff law with an inner state: z relaxes to the side of v."""

    mu: float = 0.15
    w: float = 0.02

    def rate(self, v, z, load):
        return 300.0 * (maths.tanh(200.0 * v) - z)

    def force(self, v, z, zdot, load):
        return abs(EveryFunction(self.mu, self.w).sliding(abs(v), load)) * z


def test_every_function_is_in_the_latex_of_a_law():
    text = ss.latex(EveryFunction())
    for word in ("e^{", r"\log", r"\sqrt", r"\sin", r"\cos", "atan", r"\sinh", r"\cosh", r"\tanh", "asinh"):
        assert word in text, word


@pytest.mark.slow
@pytest.mark.parametrize("law", [EveryFunction, Creeping])
def test_a_law_with_every_function_moves_alike_in_compiled_steps_and_in_plain_python(law):
    robot = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=6e-4, law="coulomb").replace(friction=law())
    engine = ss.solve(robot, periods=6, settle=0, rtol=1e-9)
    judge = ss.solve(robot, periods=6, settle=0, rtol=1e-9, method="dop853" if law is EveryFunction else "radau")
    times = np.linspace(0, 6 * robot.period, 200)
    scale = robot.velocity_scale
    assert np.abs(engine.at(times)["v"] - judge.at(times)["v"]).max() < 1e-6 * scale  # the judge's rtol, over some hundred steps


@pytest.mark.filterwarnings("ignore:Bitwise inversion '~' on bool")  # from Python 3.12 on
@pytest.mark.parametrize("a", [True, False])
@pytest.mark.parametrize("b", [True, False])
def test_conditions_on_plain_numbers_are_negated_as_they_are_of_arrays(a, b):
    """`where(~(v > 0), ...)`: to Python ~True is -2, which is not false."""
    for condition in (lambda a, b: ~a, lambda a, b: ~(a & b), lambda a, b: ~a | b, lambda a, b: ~(~a & ~b)):
        of_arrays = maths.where(condition(np.array(a), np.array(b)), 1.0, 2.0)
        assert maths.where(condition(a, b), 1.0, 2.0) == of_arrays
