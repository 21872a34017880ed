"""From expressions to straight-line Python, which `emit.py` and `functions.py` write as instructions.

Local names begin with an underscore, so that a whole block can be renamed for a second group of lanes. Products that are
added are written as explicit fused multiply-adds: the compiler then has nothing left to contract, and one lane and eight
lanes round alike. Functions are branch-free polynomials (no vector library is needed).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from stickslip.basics.maths import LARGEST
from stickslip.engine.lines import Lines, literal
from stickslip.engine.symbols import CASE, STATE, Sym

LOG_OF_BITS = "2.220446049250313e-16"  # bits of a float times this: its binary logarithm + 1023, to about 6 %


def combine(base: str, terms: Iterable[tuple[float, str]]) -> str:
    """base + sum of coefficient times name, as fused multiply-adds; terms of coefficient 0 are left out."""
    text = base
    for coefficient, name in terms:
        if coefficient == 0.0:
            continue
        if not text:
            text = name if coefficient == 1.0 else f"{literal(coefficient)} * {name}"
        elif coefficient == 1.0:
            text = f"({text} + {name})"
        else:
            text = f"fma({literal(coefficient)}, {name}, {text})"
    return text or "0.0"


def horner(coefficients: Sequence[str], x: str) -> str:
    """Polynomial with ascending coefficients at x."""
    text = coefficients[-1]
    for c in reversed(coefficients[:-1]):
        text = f"fma({text}, {x}, {c})"
    return text


_SIN = (-1 / 6, 8.3333333333333333e-3, -1.9841269841269841e-4, 2.7557319223985893e-6, -2.5052108385441720e-8)
_SIN += (1.6059043836821613e-10, -7.6471637318198164e-13, 2.8114572543455206e-15, -8.2206352466243297e-18)  # sin r = r + r^3 (…)

_ATAN = tuple((-1) ** i / (2 * i + 1) for i in range(22))  # atan r = r (1 + r^2 (…)); the first term left out is 1e-18 at r = tan(pi/8)
_DEEP = {"atan": 30, "sinh": 20, "cosh": 18, "tanh": 18, "bell": 18, "asinh": 35}


def write_secants(w: Writer, rounds: int, value: Callable[[], str], name: str, span: str, ends: str = "") -> None:
    """The zero of a value at _th, by secants in a bracket from _lo, where it is positive, to _hi, in all lanes that _seek.

    It stands in `name` and is near enough within `span`; the last two points are _xa and _xb, with the values _ga and _gb. With `ends`
    of "=" a secant may lead to an end of the bracket.
    """
    w.begin(f"for q in while_any(_seek, {rounds})")
    w.line(name, value())
    w.line("_up", f"{name} > 0.0")
    w.line("_lo", "_th if (_up and _seek) else _lo")
    w.line("_hi", "_hi if (_up or not _seek) else _th")
    w.line("_nearer", "_seek and abs(_ga) < abs(_gb)")  # the nearer of the two points before and the new one: a secant
    w.line("_xb", "_xa if _nearer else _xb")
    w.line("_gb", "_ga if _nearer else _gb")
    w.line("_xa", "_th if _seek else _xa")
    w.line("_ga", f"{name} if _seek else _ga")
    w.line("_gap", "_gb - _ga")
    w.line("_seek", f"_seek and abs({name}) > {span}")
    w.line("_tn", f"_th - {name} * (_xb - _xa) / (_gap if _gap != 0.0 else 1.0)")
    w.line("_tn", f"_tn if (_tn >{ends} _lo and _tn <{ends} _hi) else 0.5 * (_lo + _hi)")
    w.line("_th", "_tn if _seek else _th")
    w.end()


def write_length(w: Writer, rows: Sequence[tuple[str, str]], order: int, bits: str, h: str) -> None:
    """Lines for `h`: where the last two terms of some series fall to what is tolerated, whose `bits` are given.

    Each series is a row of coefficients and the weight that multiplies its terms.
    """
    for m, power in ((order - 1, "_first"), (order, "_power")):
        for k, (row, weight) in enumerate(rows):
            w.line("_other", f"{weight} * abs({row}[{m}])")
            w.line("_term", "_term if _term > _other else _other" if k else "1.0 * _other")
        w.line(power, f"({bits} - as_bits(_term)) * {literal(float(LOG_OF_BITS) / m)}")
    w.line("_power", "_power if _power < _first else _first")
    w.line("_power", "_power if _power < 900.0 else 900.0")
    w.line(h, "as_float(np.int64(fma(_power, 4503599627370496.0, 4606988764016040448.0)))")


def _never_positive(node: Sym) -> bool:
    """Whether an expression is minus a square."""
    if node.op != "multiply" or node.args[0].op != "constant" or node.args[0].value >= 0:
        return False
    square = node.args[1]
    return square.op == "multiply" and square.args[0] is square.args[1]


class Writer(Lines):
    """Lines of a kernel: the numbers of a case are known by name, functions are polynomials, and sums are fused."""

    def __init__(self, prefix: str = "_") -> None:
        super().__init__(prefix)
        self.case_nodes: list[Sym] = []  # expressions of the case's numbers, computed once per case
        self._uses: dict[int, int] = {}
        self._depth: dict[int, int] = {}
        self._outside: list[dict[Any, str]] = []  # what was written before each part that was begun

    def begin(self, head: str) -> None:
        """Begins a loop, ``for m in range(1, 17)``, or, for kernels of one lane, a condition, ``if _a > 0.0``."""
        self.lines.append(f"{self.indent}{head}:")
        self.indent += "    "
        self._outside.append(dict(self._known))

    def end(self) -> None:
        """End of the innermost part that was begun, if there is one; what was written there first is written again where it is needed."""
        self.indent = self.indent[:-4]
        if self._outside:
            self._known = self._outside.pop()

    def count_uses(self, roots: Iterable[Sym]) -> None:
        """Note how often each node is used, so that a product used once can be fused."""
        visited: set[int] = set()
        stack = list(roots)
        for node in stack:
            self._uses[node.number] = self._uses.get(node.number, 0) + 1
        while stack:
            node = stack.pop()
            if node.number in visited:
                continue
            visited.add(node.number)
            for a in node.args:
                self._uses[a.number] = self._uses.get(a.number, 0) + 1
                stack.append(a)

    def value(self, node: Sym, bind: dict[str, str]) -> str:
        """The name (or literal) that holds a node's value; one of the case's numbers is computed before."""
        if node.level == CASE and self._prefix == "_":
            return self._case(node)
        return super().value(node, bind)

    def _case(self, node: Sym) -> str:
        for k, known in enumerate(self.case_nodes):
            if known is node:
                return f"_c{k}"
        self.case_nodes.append(node)
        return f"_c{len(self.case_nodes) - 1}"

    def _function(self, node: Sym, bind: dict[str, str]) -> str:
        if node.op in ("tanh", "bell"):
            return self._of_tanh(node, bind)
        x = self.value(node.args[0], bind)
        if node.op == "sqrt":
            return self.line(self.fresh(), f"math.sqrt({x})")
        return self._exp(x, _never_positive(node.args[0])) if node.op == "exp" else str(getattr(self, f"_{node.op}")(x))

    def _of_tanh(self, node: Sym, bind: dict[str, str]) -> str:
        """tanh x, or 1/cosh^2 x: both from e = exp(-2|x|), which is never large."""
        a, graph = node.args[0], node.graph
        e = self.value(graph.call("exp", graph.select(a, -2.0 * a, 2.0 * a)), bind)
        if node.op == "bell":
            return self.line(self.fresh(), f"4.0 * {e} / ((1.0 + {e}) * (1.0 + {e}))")
        height = self.line(self.fresh(), f"(1.0 - {e}) / (1.0 + {e})")
        return self.line(self.fresh(), f"{height} if {self.value(a, bind)} > 0.0 else -{height}")

    def _sum(self, node: Sym, bind: dict[str, str]) -> str:
        """A sum of any length, the term that is ready last added last; products used nowhere else are fused."""
        terms = sorted(self._terms(node, 1.0, top=True), key=lambda t: self._ready(t[1]))
        sign, first = terms[0]
        text = self.value(first, bind) if sign > 0 else f"-{self.value(first, bind)}"
        for sign, term in terms[1:]:
            if self._fusible(term):
                p, q = self.value(term.args[0], bind), self.value(term.args[1], bind)
                text = f"fma({p if sign > 0 else f'-{p}'}, {q}, {text})"
            else:
                text = f"({text} {'+' if sign > 0 else '-'} {self.value(term, bind)})"
        return self.line(self.fresh(), text)

    def _fusible(self, node: Sym) -> bool:
        return node.op == "multiply" and node.level == STATE and self._uses.get(node.number, 2) == 1

    def _terms(self, node: Sym, sign: float, top: bool = False) -> list[tuple[float, Sym]]:
        """The signed terms of a sum of sums that are used nowhere else."""
        inner = node.op in ("add", "subtract") and (top or (node.level == STATE and self._uses.get(node.number, 2) == 1))
        if not inner:
            return [(sign, node)]
        a, b = node.args
        return self._terms(a, sign) + self._terms(b, sign if node.op == "add" else -sign)

    def _ready(self, node: Sym) -> int:
        """How many operations deep a node is, functions and quotients counting for more."""
        if node.number not in self._depth:
            cost = {"exp": 12, "log": 20, "sin": 15, "cos": 15, "reciprocal": 4, "sqrt": 5, **_DEEP}.get(node.op, 1)
            deep = node.level == STATE and node.args
            self._depth[node.number] = cost + max(self._ready(a) for a in node.args) if deep else 0
        return self._depth[node.number]

    def _exp(self, x: str, falling: bool) -> str:
        """e^x: 2^k times a polynomial of degree 12 on |r| <= ln(2)/2 (error 2e-16)."""
        a = self.line(self.fresh(), f"{x} if {x} > -708.0 else -708.0")
        if not falling:
            self.line(a, f"{a} if {a} < {LARGEST} else {LARGEST}")
        k = self.line(self.fresh(), f"fma({a}, 1.4426950408889634, 6755399441055744.0)")
        whole = self.line(self.fresh(), f"{k} - 6755399441055744.0")
        if falling:  # what the second part of ln 2 would correct is below 1e-14 of a number below 1
            r = self.line(self.fresh(), f"fma({whole}, -0.6931471805599453, {a})")
        else:
            r = self.line(self.fresh(), f"fma({whole}, -6.93147180369123816490e-01, {a})")
            self.line(r, f"fma({whole}, -1.90821492927058770002e-10, {r})")
        p = self._estrin([1 / math.factorial(i) for i in range(13)], r)
        return self.line(self.fresh(), f"{p} * as_float((as_bits({k}) + 1023) << 52)")

    def _estrin(self, c: list[float], r: str) -> str:
        """Polynomial of degree 12 by Estrin's scheme: short chains keep both units busy."""
        r2 = self.line(self.fresh(), f"{r} * {r}")
        r4 = self.line(self.fresh(), f"{r2} * {r2}")
        pairs = [f"fma({literal(c[i + 1])}, {r}, {literal(c[i])})" for i in range(0, 12, 2)]
        quads = [self.line(self.fresh(), f"fma({pairs[i + 1]}, {r2}, {pairs[i]})") for i in (0, 2, 4)]
        low = self.line(self.fresh(), f"fma({quads[1]}, {r4}, {quads[0]})")
        high = self.line(self.fresh(), f"fma({literal(c[12])}, {r4}, {quads[2]})")
        return self.line(self.fresh(), f"fma({high}, {r4} * {r4}, {low})")

    def _sine(self, x: str, quarter: bool) -> str:
        """sin x, or cos x = sin(x + pi/2): reduction by pi in three parts, odd polynomial of degree 19."""
        k, r = self.fresh(), self.fresh()
        if quarter:
            self.line(k, f"fma({x}, 0.3183098861837907, 0.5) + 6755399441055744.0")
            whole = self.line(self.fresh(), f"({k} - 6755399441055744.0) - 0.5")
        else:
            self.line(k, f"fma({x}, 0.3183098861837907, 6755399441055744.0)")
            whole = self.line(self.fresh(), f"{k} - 6755399441055744.0")
        self.line(r, f"fma({whole}, -3.141592653589793116, {x})")
        self.line(r, f"fma({whole}, -1.2246467991473532e-16, {r})")
        r2 = self.line(self.fresh(), f"{r} * {r}")
        p = self.line(self.fresh(), horner([literal(c) for c in _SIN], r2))
        s = self.line(self.fresh(), f"fma({r} * {r2}, {p}, {r})")
        return self.line(self.fresh(), f"as_float(as_bits({s}) ^ (as_bits({k}) << 63))")

    def _sin(self, x: str) -> str:
        return self._sine(x, quarter=False)

    def _cos(self, x: str) -> str:
        return self._sine(x, quarter=True)

    def _log(self, x: str) -> str:
        """Natural logarithm: exponent, and the odd series of atanh on a mantissa between sqrt(1/2) and sqrt(2)."""
        bits = self.line(self.fresh(), f"as_bits({x})")
        e = self.line(self.fresh(), f"(({bits} - 4604544271217802189) >> 52) * 1.0")
        m = self.line(self.fresh(), f"as_float({bits} - ((({bits} - 4604544271217802189) >> 52) << 52))")
        s = self.line(self.fresh(), f"({m} - 1.0) / ({m} + 1.0)")
        s2 = self.line(self.fresh(), f"{s} * {s}")
        p = self.line(self.fresh(), horner([literal(1 / (2 * i + 3)) for i in range(10)], s2))
        low = self.line(self.fresh(), f"fma({s} * {s2}, 2.0 * {p}, 2.0 * {s})")
        natural = self.line(self.fresh(), f"fma({e}, 6.93147180369123816490e-01, fma({e}, 1.90821492927058770002e-10, {low}))")
        nan = self.line(self.fresh(), f"{natural} if {x} > 0.0 else math.nan")
        return self.line(self.fresh(), f"{nan} if {x} != 0.0 else -math.inf")

    def _expm1(self, x: str) -> str:
        """e^x - 1 for -708 <= x <= 690, without cancellation: 2^k (e^r - 1) + (2^k - 1)."""
        k = self.line(self.fresh(), f"fma({x}, 1.4426950408889634, 6755399441055744.0)")
        whole = self.line(self.fresh(), f"{k} - 6755399441055744.0")
        r = self.line(self.fresh(), f"fma({whole}, -6.93147180369123816490e-01, {x})")
        self.line(r, f"fma({whole}, -1.90821492927058770002e-10, {r})")
        p = self._estrin([1 / math.factorial(i + 1) for i in range(13)], r)
        power = self.line(self.fresh(), f"as_float((as_bits({k}) + 1023) << 52)")
        return self.line(self.fresh(), f"fma({r} * {p}, {power}, {power} - 1.0)")

    def _size(self, x: str, most: float) -> str:
        """The absolute value, `most` at most."""
        a = self.line(self.fresh(), f"abs({x})")
        return self.line(self.fresh(), f"{a} if {a} < {literal(most)} else {literal(most)}")

    def _signed(self, value: str, x: str) -> str:
        """An odd function: its value at |x| with the sign of x."""
        return self.line(self.fresh(), f"{value} if {x} > 0.0 else -{value}")

    def _sinh(self, x: str) -> str:
        u = self._expm1(self._size(x, LARGEST))
        return self._signed(self.line(self.fresh(), f"0.5 * ({u} + {u} / ({u} + 1.0))"), x)

    def _cosh(self, x: str) -> str:
        e = self._exp(self._size(x, LARGEST), falling=False)
        return self.line(self.fresh(), f"0.5 * {e} + 0.5 / {e}")

    def _asinh(self, x: str) -> str:
        """log(1 + y) with y = |x| + sqrt(x^2 + 1) - 1; what rounding takes from 1 + y is added again."""
        a = self.line(self.fresh(), f"abs({x})")
        i = self.line(self.fresh(), f"1.0 / {a}")
        y = self.line(self.fresh(), f"{a} + {a} / ({i} + math.sqrt(fma({i}, {i}, 1.0)))")
        w = self.line(self.fresh(), f"1.0 + {y}")
        natural = self._log(w)
        return self._signed(self.line(self.fresh(), f"{natural} + ({y} - ({w} - 1.0)) / {w}"), x)

    def _atan(self, x: str) -> str:
        """atan |x| = pi/2 - atan(1/|x|) beyond 1, and atan t = pi/4 + atan((t - 1)/(t + 1)) beyond tan(pi/8)."""
        a = self.line(self.fresh(), f"abs({x})")
        t = self.line(self.fresh(), f"1.0 / {a} if {a} > 1.0 else {a}")
        r = self.line(self.fresh(), f"({t} - 1.0) / ({t} + 1.0) if {t} > 0.4142135623730951 else {t}")
        r2 = self.line(self.fresh(), f"{r} * {r}")
        p = self.line(self.fresh(), horner([literal(c) for c in _ATAN[1:]], r2))
        small = self.line(self.fresh(), f"fma({r} * {r2}, {p}, {r})")
        angle = self.line(self.fresh(), f"{small} + 0.7853981633974483 if {t} > 0.4142135623730951 else {small}")
        return self._signed(self.line(self.fresh(), f"1.5707963267948966 - {angle} if {a} > 1.0 else {angle}"), x)
