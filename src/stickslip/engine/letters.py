"""Letters that stand for numbers while plain Python is called: SymPy's expressions with the hooks of `stickslip.maths`."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import sympy

from stickslip.basics.contracts import Numeric
from stickslip.basics.of_own import without_others
from stickslip.basics.time_rates import defers_to_jets
from stickslip.engine.symbols import FUNCTIONS

_LONGEST = 10**12  # denominators of decimals that are taken as they are written
_EVEN, _ODD = ("cos", "cosh"), ("sin", "sinh", "tanh", "asinh", "atan")
_WHETHER = "a symbol is neither true nor false; write stickslip.maths.where for a case distinction"


class Letter(sympy.Symbol):
    """A letter that prints as its name, and is sorted as the letter below its dots."""

    def _latex(self, printer: Any, **options: Any) -> str:
        return self.name

    def _sympystr(self, printer: Any) -> str:
        dots, _, letter = self.name.rpartition("dot ")
        return letter + dots

    def sort_key(self, order: Any = None) -> Any:
        """Where it stands among others."""
        return self.class_key(), (1, (str(self),)), sympy.S.One.sort_key(), sympy.S.One


@defers_to_jets
class Formula:
    """A SymPy expression that laws, drives and machines take for a number."""

    __slots__ = ("expression",)
    __array_ufunc__ = None  # NumPy scalars leave the operation to us

    def __init__(self, expression: sympy.Expr):
        self.expression = expression

    def __eq__(self, other: object) -> bool:
        return isinstance(other, (Formula, int, float)) and self.expression == expression_of(other)

    def __hash__(self) -> int:
        return hash(self.expression)

    def __bool__(self) -> bool:
        raise TypeError(_WHETHER)

    def __add__(self, other: Numeric) -> Formula:
        return Formula(self.expression + expression_of(other))

    def __neg__(self) -> Formula:
        return Formula(-self.expression)

    def __sub__(self, other: Numeric) -> Formula:
        return Formula(self.expression - expression_of(other))

    def __rsub__(self, other: Numeric) -> Formula:
        return Formula(expression_of(other) - self.expression)

    def __mul__(self, other: Numeric) -> Formula:
        return Formula(self.expression * expression_of(other))

    def __truediv__(self, other: Numeric) -> Formula:
        return Formula(self.expression / expression_of(other))

    def __rtruediv__(self, other: Numeric) -> Formula:
        return Formula(expression_of(other) / self.expression)

    def __pow__(self, exponent: Numeric) -> Formula:
        base, power = self.expression, expression_of(exponent)
        return Formula((base if power.is_number or base.is_Atom else sympy.UnevaluatedExpr(base)) ** power)  # (a/b)^p stays in brackets

    def __rpow__(self, base: Numeric) -> Formula:
        return Formula(expression_of(base) ** self.expression)

    __radd__, __rmul__ = __add__, __mul__

    def __abs__(self) -> Formula:
        a = self.expression
        return self if a.is_nonnegative else -self if a.is_nonpositive else Formula(sympy.Abs(a, evaluate=False))

    def __ss_power__(self, exponent: Numeric) -> Formula:
        return abs(self) ** exponent

    def __gt__(self, other: Numeric) -> SymbolicCondition:
        return SymbolicCondition(self.expression > expression_of(other))

    def __ge__(self, other: Numeric) -> SymbolicCondition:
        return SymbolicCondition(self.expression >= expression_of(other))

    def __lt__(self, other: Numeric) -> SymbolicCondition:
        return SymbolicCondition(self.expression < expression_of(other))

    def __le__(self, other: Numeric) -> SymbolicCondition:
        return SymbolicCondition(self.expression <= expression_of(other))

    def __ss_is_zero__(self) -> bool:
        return bool(self.expression == 0)

    def __ss_sqrt__(self) -> Formula:
        return Formula(sympy.sqrt(self.expression))


def _hook(name: str) -> Callable[[Formula], Formula]:
    function = getattr(sympy, name)

    def hook(self: Formula) -> Formula:
        a = self.expression
        if name in ("sin", "cos"):  # omega t + phi, of omega (t + phi/omega)
            a = min(a, _multiplied_out(a), key=sympy.count_ops)
        if name in _EVEN + _ODD and all(term.as_coeff_Mul()[0] < 0 for term in sympy.Add.make_args(a)):
            return hook(Formula(-a)) if name in _EVEN else -hook(Formula(-a))
        return Formula(function(a, evaluate=a.is_number or name == "exp"))  # SymPy may turn the sign of a difference

    return hook


for _name in FUNCTIONS:
    if _name != "sqrt":
        setattr(Formula, f"__ss_{_name}__", _hook(_name))


class SymbolicCondition:
    """A condition of SymPy; one that the signs of letters decide is decided."""

    def __init__(self, condition: Any):
        self.condition = condition

    def __ss_where__(self, yes: Any, no: Any) -> Formula:
        one, other = expression_of(yes), expression_of(no)
        if self.condition in (True, False) or one == other:
            return Formula(other if self.condition == False else one)  # noqa: E712
        if isinstance(self.condition, sympy.core.relational.Relational):
            difference, way = _multiplied_out(self.condition.gts - self.condition.lts), _multiplied_out(one - other)
            if difference in (way, -way):
                return Formula((sympy.Max if difference == way else sympy.Min)(one, other, evaluate=False))
        rest = other.args if isinstance(other, sympy.Piecewise) else ((other, True),)
        return Formula(sympy.Piecewise((one, self.condition), *rest, evaluate=False))

    def __and__(self, other: SymbolicCondition) -> SymbolicCondition:
        return SymbolicCondition(self.condition & other.condition)

    def __or__(self, other: SymbolicCondition) -> SymbolicCondition:
        return SymbolicCondition(self.condition | other.condition)

    def __invert__(self) -> SymbolicCondition:
        return SymbolicCondition(~self.condition)

    def __bool__(self) -> bool:
        if self.condition in (True, False):
            return bool(self.condition)
        raise TypeError(_WHETHER)


def symbol(text: str, sign: int = 1) -> Formula:
    """A letter; positive if nothing else is said, 0 for one of either sign."""
    return Formula(Letter(text, **{{1: "positive", -1: "negative", 0: "real"}[sign]: True}))


_PI = symbol(r"\pi").expression  # sorted among letters


def expression_of(value: Any) -> sympy.Expr:
    r"""The SymPy expression of a value; a float as the decimal or the multiple of pi that it is near.

    Examples
    --------
    >>> expression_of(0.3), expression_of(math.pi / 2)
    (3/10, \pi/2)
    """
    value = without_others(value)
    if isinstance(value, Formula):
        return value.expression
    if not isinstance(value, float):
        return sympy.sympify(value)
    exact = Fraction(repr(float(value)))
    ratio = Fraction(value / math.pi).limit_denominator(360)
    if exact.denominator > _LONGEST and abs(float(ratio) * math.pi - value) <= 1e-14 * abs(value):
        return _PI * sympy.Rational(ratio)
    near = exact.limit_denominator(1000)
    return sympy.Rational(near if abs(float(near) - value) <= 1e-15 * abs(value) else exact)


def _multiplied_out(expression: sympy.Expr) -> sympy.Expr:
    """Brackets of its terms multiplied out, not those within functions."""
    return sympy.Add(*(sympy.expand_mul(term, deep=False) for term in sympy.Add.make_args(expression)))


def spread(expression: sympy.Expr, by: sympy.Expr = sympy.S.One) -> sympy.Expr:
    r"""A sum times a factor, in which brackets with fractions are multiplied out, so that what stands before such a bracket may cancel.

    Examples
    --------
    >>> M, m, a, b = sympy.symbols("M m a b")
    >>> spread(a / (M + m) + b, by=M + m)
    a + b*(M + m)
    """
    terms = []
    for term in sympy.Add.make_args(expression):
        sums = [part for part in sympy.Mul.make_args(term) if part.is_Add and any(sympy.fraction(each)[1] != 1 for each in part.args)]
        terms.append(spread(sums[0], term / sums[0] * by) if sums else term * by)
    return sympy.Add(*terms)
