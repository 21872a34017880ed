"""Formulas for readers: sums of products of letters and functions, made by calling plain Python with letters.

Equal terms are one, equal factors are powers, and brackets stay as they are; nothing else is simplified.
"""

from __future__ import annotations

import functools
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from stickslip.basics import maths
from stickslip.basics.contracts import Numeric
from stickslip.engine.symbols import FUNCTIONS

Factors = tuple[tuple["Atom", Fraction], ...]
_EVEN, _POSITIVE = ("cos", "cosh"), ("exp", "cosh", "abs")
_LONGEST = 10**12  # denominators of decimals that are taken as they are written
_WHETHER = "a symbol is neither true nor false; write stickslip.maths.where for a case distinction"


@dataclass(frozen=True)
class Atom(ABC):
    """A factor that is no product."""

    def sign(self) -> int:
        """+1 or -1 where its sign is known, else 0."""
        return 0

    def parts(self) -> tuple[Formula, ...]:
        """Formulas inside it."""
        return ()

    @abstractmethod
    def at(self, values: Mapping[Letter, Any]) -> Any:
        """Its value, or what it is with other letters."""


@dataclass(frozen=True)
class Letter(Atom):
    """A letter that prints as its text, with the sign that it is known to have."""

    text: str
    known: int = field(default=1, compare=False)

    def sign(self) -> int:
        """Its sign, where it is known."""
        return self.known

    def at(self, values: Mapping[Letter, Any]) -> Any:
        """Its value, or what it is with other letters."""
        return values.get(self, math.pi if self.text == r"\pi" and values and _numeric(values) else Formula.of(self))


@dataclass(frozen=True)
class Bracket(Atom):
    """A sum in brackets."""

    sum: Formula

    def sign(self) -> int:
        """Its sign, where it is known."""
        return self.sum.sign()

    def parts(self) -> tuple[Formula, ...]:
        """Formulas inside it."""
        return (self.sum,)

    def at(self, values: Mapping[Letter, Any]) -> Any:
        """Its value, or what it is with other letters."""
        return self.sum.at(values)


@dataclass(frozen=True)
class Call(Atom):
    """A function of a formula, or its absolute value ("abs")."""

    name: str
    argument: Formula

    def sign(self) -> int:
        """Its sign, where it is known."""
        return 1 if self.name in _POSITIVE else self.argument.sign() if self.name in ("sinh", "tanh", "asinh", "atan") else 0

    def parts(self) -> tuple[Formula, ...]:
        """Formulas inside it."""
        return (self.argument,)

    def at(self, values: Mapping[Letter, Any]) -> Any:
        """Its value, or what it is with other letters."""
        inner = self.argument.at(values)
        if self.name == "tan":
            return maths.sin(inner) / maths.cos(inner)
        return abs(inner) if self.name == "abs" else getattr(maths, self.name)(inner)


@dataclass(frozen=True)
class Power(Atom):
    """A power whose exponent is no plain number."""

    base: Formula
    exponent: Formula

    def sign(self) -> int:
        """Its sign, where it is known."""
        return self.base.sign()

    def parts(self) -> tuple[Formula, ...]:
        """Formulas inside it."""
        return self.base, self.exponent

    def at(self, values: Mapping[Letter, Any]) -> Any:
        """Its value, or what it is with other letters."""
        return self.base.at(values) ** self.exponent.at(values)


@dataclass(frozen=True)
class Extreme(Atom):
    """The larger ("max") or the smaller ("min") of two."""

    name: str
    one: Formula
    other: Formula

    def parts(self) -> tuple[Formula, ...]:
        """Formulas inside it."""
        return self.one, self.other

    def at(self, values: Mapping[Letter, Any]) -> Any:
        """Its value, or what it is with other letters."""
        return getattr(maths, f"{self.name}imum")(self.one.at(values), self.other.at(values))


@dataclass(frozen=True)
class Cases(Atom):
    """A case distinction."""

    condition: Comparison | Both
    yes: Formula
    no: Formula

    def parts(self) -> tuple[Formula, ...]:
        """Formulas inside it."""
        return (*self.condition.parts(), self.yes, self.no)

    def at(self, values: Mapping[Letter, Any]) -> Any:
        """Its value, or what it is with other letters."""
        return maths.where(self.condition.at(values), self.yes.at(values), self.no.at(values))


class _Condition(ABC):
    """Base class of conditions; one that the signs of letters decide is decided."""

    @abstractmethod
    def decided(self) -> bool | None:
        """Whether it holds; None where that is not known."""

    def __ss_where__(self, yes: Any, no: Any) -> Formula:
        if (known := self.decided()) is not None:
            return formula(yes if known else no)
        one, other = formula(yes), formula(no)
        return one if one == other else self._by_cases(one, other)

    def _by_cases(self, yes: Formula, no: Formula) -> Formula:
        return Formula.of(Cases(self, yes, no))  # type: ignore[arg-type]

    def __and__(self, other: Any) -> Both:
        return Both(r"\wedge", self, other)

    def __or__(self, other: Any) -> Both:
        return Both(r"\vee", self, other)

    def __bool__(self) -> bool:
        if (known := self.decided()) is None:
            raise TypeError(_WHETHER)
        return known


@dataclass(frozen=True)
class Comparison(_Condition):
    """One formula against another."""

    left: Formula
    sign: str
    right: Formula

    def decided(self) -> bool | None:
        """Whether it holds; None where that is not known."""
        difference = self.left - self.right
        if difference.is_number:
            return _holds(difference.number, self.sign)
        return None if not difference.sign() else _holds(difference.sign(), self.sign)

    def _by_cases(self, yes: Formula, no: Formula) -> Formula:
        way = expanded(yes - no), expanded(self.left - self.right)
        if way[0] in (way[1], -way[1]):
            return Formula.of(Extreme("max" if (way[0] == way[1]) == (">" in self.sign) else "min", yes, no))
        return super()._by_cases(yes, no)

    def parts(self) -> tuple[Formula, ...]:
        """Both sides."""
        return self.left, self.right

    def at(self, values: Mapping[Letter, Any]) -> Any:
        """The condition with other letters, or whether it holds."""
        return _compared(self.left.at(values), self.sign, self.right.at(values))

    def __invert__(self) -> Comparison:
        return Comparison(self.left, {">": "<=", ">=": "<", "<": ">=", "<=": ">"}[self.sign], self.right)


@dataclass(frozen=True)
class Both(_Condition):
    """Two conditions joined."""

    joined: str
    one: Any
    other: Any

    def decided(self) -> bool | None:
        """Whether it holds; None where that is not known."""
        known, settled = [c if isinstance(c, bool) else c.decided() for c in (self.one, self.other)], self.joined == r"\vee"
        return settled if settled in known else None if None in known else not settled

    def parts(self) -> tuple[Formula, ...]:
        """All sides."""
        return (*self.one.parts(), *self.other.parts())

    def at(self, values: Mapping[Letter, Any]) -> Any:
        """The conditions with other letters, or whether they hold."""
        one, other = self.one.at(values), self.other.at(values)
        return one & other if self.joined == r"\wedge" else one | other

    def __invert__(self) -> Both:
        return Both(r"\vee" if self.joined == r"\wedge" else r"\wedge", ~self.one, ~self.other)


def _compared(left: Any, sign: str, right: Any) -> Any:
    return {">": left > right, ">=": left >= right, "<": left < right, "<=": left <= right}[sign]


def _holds(difference: Any, sign: str) -> bool:
    return bool(_compared(difference, sign, 0))


def _numeric(values: Mapping[Letter, Any]) -> bool:
    return not any(isinstance(value, Formula) for value in values.values())


class Formula:
    """A sum: products of atoms, each with its number. It has the hooks of `stickslip.maths`."""

    __slots__ = ("_hash", "terms")
    __array_ufunc__ = None

    def __init__(self, terms: Mapping[Factors, Fraction]):
        self.terms = {factors: number for factors, number in terms.items() if number}
        self._hash = hash(frozenset(self.terms.items()))

    @classmethod
    def of(cls, atom: Atom) -> Formula:
        """The formula that is one atom."""
        return cls({((atom, Fraction(1)),): Fraction(1)})

    # ---- what it is ----
    @property
    def is_number(self) -> bool:
        """Whether it has no letters."""
        return not any(self.terms)

    @property
    def number(self) -> Fraction:
        """Its value, if it is a number."""
        return self.terms.get((), Fraction(0))

    @property
    def is_sum(self) -> bool:
        """Whether it has several terms."""
        return len(self.terms) > 1

    def sign(self) -> int:
        """+1 or -1 where its sign is known, else 0."""
        signs = {_sign(factors, number) for factors, number in self.terms.items()}
        return signs.pop() if len(signs) == 1 else 0

    @property
    def atoms(self) -> frozenset[Atom]:
        """All atoms, and those inside them."""
        own = {atom for factors in self.terms for atom, _ in factors}
        return frozenset(own).union(*(part.atoms for atom in own for part in atom.parts()))

    def __eq__(self, other: object) -> bool:
        if isinstance(other, (int, float)):
            return self.is_number and self.number == other
        return isinstance(other, Formula) and self.terms == other.terms

    def __hash__(self) -> int:
        return self._hash

    def __bool__(self) -> bool:
        raise TypeError(_WHETHER)

    def at(self, values: Mapping[Letter, Any]) -> Any:
        """The formula with values, or other formulas, for some letters."""
        numeric = _numeric(values)
        total: Any = 0.0 if numeric else formula(0)
        for factors, number in self.terms.items():
            value: Any = float(number) if numeric else formula(number)
            for atom, exponent in factors:
                value = value * atom.at(values) ** (float(exponent) if numeric else exponent)
            total = total + value
        return total

    # ---- arithmetic ----
    def __add__(self, other: Numeric) -> Formula:
        terms = dict(self.terms)
        for factors, number in formula(other).terms.items():
            terms[factors] = terms.get(factors, Fraction(0)) + number
        return Formula(terms)

    def __neg__(self) -> Formula:
        return Formula({factors: -number for factors, number in self.terms.items()})

    def __sub__(self, other: Numeric) -> Formula:
        return self + -formula(other)

    def __rsub__(self, other: Numeric) -> Formula:
        return formula(other) - self

    def __mul__(self, other: Numeric) -> Formula:
        return _product([self, formula(other)])

    def __truediv__(self, other: Numeric) -> Formula:
        return self * formula(other) ** -1

    def __rtruediv__(self, other: Numeric) -> Formula:
        return formula(other) / self

    def __pow__(self, exponent: Numeric) -> Formula:
        power = formula(exponent)
        return _raised(self, power.number) if power.is_number else Formula.of(Power(self, power))

    def __rpow__(self, base: Numeric) -> Formula:
        return formula(base) ** self

    __radd__, __rmul__ = __add__, __mul__

    def __abs__(self) -> Formula:
        sign = self.sign()
        return self if sign > 0 else -self if sign < 0 else Formula.of(Call("abs", self))

    def __ss_power__(self, exponent: Numeric) -> Formula:
        return abs(self) ** exponent

    def __gt__(self, other: Numeric) -> Comparison:
        return Comparison(self, ">", formula(other))

    def __ge__(self, other: Numeric) -> Comparison:
        return Comparison(self, ">=", formula(other))

    def __lt__(self, other: Numeric) -> Comparison:
        return Comparison(self, "<", formula(other))

    def __le__(self, other: Numeric) -> Comparison:
        return Comparison(self, "<=", formula(other))

    def __ss_sqrt__(self) -> Formula:
        return self ** Fraction(1, 2)


def _hook(name: str) -> Callable[[Formula], Formula]:
    def hook(self: Formula) -> Formula:
        if self.is_number:
            return formula(getattr(math, name)(self.number))
        if all(number < 0 for number in self.terms.values()) and name not in ("exp", "log"):  # even or odd
            return hook(-self) if name in _EVEN else -hook(-self)
        return Formula.of(Call(name, self))

    return hook


for _name in FUNCTIONS:
    if _name != "sqrt":
        setattr(Formula, f"__ss_{_name}__", _hook(_name))


def symbol(text: str, sign: int = 1) -> Formula:
    """A letter; positive if nothing else is said, 0 for one of either sign."""
    return Formula.of(Letter(text, sign))


def formula(value: Any) -> Formula:
    """The formula of a value; a float as the decimal or the multiple of pi that it is near.

    Examples
    --------
    >>> [str(term) for term in formula(0.3).terms.values()]
    ['3/10']
    """
    if isinstance(value, Formula):
        return value
    if isinstance(value, float):
        exact = Fraction(repr(float(value)))
        ratio = Fraction(value / math.pi).limit_denominator(360)
        if exact.denominator > _LONGEST and abs(float(ratio) * math.pi - value) <= 1e-14 * abs(value):
            return symbol(r"\pi") * ratio
        near = exact.limit_denominator(1000)
        return Formula({(): near if abs(float(near) - value) <= 1e-15 * abs(value) else exact})
    return Formula({(): Fraction(value)})


def _sign(factors: Factors, number: Fraction) -> int:
    sign = 1 if number > 0 else -1
    for atom, exponent in factors:
        sign *= 1 if exponent.denominator == 1 and exponent % 2 == 0 else atom.sign()
    return sign


def _factors_of(value: Formula) -> tuple[Fraction, Factors]:
    """A formula as a number times factors."""
    if value.is_sum:
        return Fraction(1), ((Bracket(value), Fraction(1)),)
    return next(((number, factors) for factors, number in value.terms.items()), (Fraction(0), ()))


def _product(values: Iterable[Formula]) -> Formula:
    number, powers = Fraction(1), dict[Atom, Fraction]()
    for value in values:
        own, factors = _factors_of(value)
        number *= own
        for atom, exponent in factors:
            powers[atom] = powers.get(atom, Fraction(0)) + exponent
    for atom in list(powers):
        _join_tangent(atom, powers)
    factors = tuple(sorted(((atom, e) for atom, e in powers.items() if e), key=lambda pair: order_of(pair[0])))
    if len(factors) == 1 and isinstance(factors[0][0], Bracket) and factors[0][1] == 1:
        return Formula({own: n * number for own, n in factors[0][0].sum.terms.items()})
    return Formula({factors: number})


def _join_tangent(atom: Atom, powers: dict[Atom, Fraction]) -> None:
    """A sine over its cosine is a tangent."""
    if isinstance(atom, Call) and atom.name == "sin" and powers.get(atom) == 1:
        below = Call("cos", atom.argument)
        if powers.get(below) == -1:
            del powers[atom], powers[below]
            powers[Call("tan", atom.argument)] = Fraction(1)


def _raised(base: Formula, power: Fraction) -> Formula:
    number, factors = _factors_of(base)
    if power == 0:
        return formula(1)
    if power.denominator != 1:
        root = math.isqrt(number.numerator) if number > 0 else 0, math.isqrt(number.denominator)
        plain = power.denominator == 2 and Fraction(*root) ** 2 == number if root[0] else False
        if not plain or any(atom.sign() <= 0 for atom, _ in factors):
            return base if power == 1 else Formula({((Bracket(base), power),): Fraction(1)})
        return Formula({tuple((a, e * power) for a, e in factors): Fraction(*root) ** power.numerator})
    return _product([Formula({tuple((a, e * power) for a, e in factors): number**power.numerator})])


@functools.lru_cache(maxsize=4096)
def order_of(atom: Atom) -> tuple[int, str]:
    """Letters by their texts (a rate as the letter below its dots), then brackets, then functions."""
    kind = (Letter, Bracket, Power, Call, Extreme, Cases).index(type(atom))
    inner = "".join(str(sorted((order_of(a), e) for a, e in factors)) for part in atom.parts() for factors in part.terms)
    dots, _, letter = getattr(atom, "text", getattr(atom, "name", "")).rpartition(r"dot ")
    return kind, letter + dots + inner


def expanded(value: Formula) -> Formula:
    """Brackets multiplied out."""
    total = formula(0)
    for factors, number in value.terms.items():
        total = total + Formula({(): number}) * 1 if not factors else total + _distributed(number, factors)
    return total


def _distributed(number: Fraction, factors: Factors) -> Formula:
    for i, (atom, exponent) in enumerate(factors):
        if isinstance(atom, Bracket) and exponent == 1:
            rest = Formula({factors[:i] + factors[i + 1 :]: number})
            return sum((expanded(rest * Formula({own: n})) for own, n in atom.sum.terms.items()), formula(0))
    return Formula({factors: number})


def spread(value: Formula, by: Any = 1) -> Formula:
    r"""A sum times a factor, in which brackets with fractions are multiplied out, so that what stands before such a bracket may cancel.

    Examples
    --------
    >>> M, m, a, b = map(symbol, "Mmab")
    >>> spread(a / (M + m) + b, by=M + m) == a + b * (M + m)
    True
    """
    total = formula(0)
    for factors, number in value.terms.items():
        term = Formula({factors: number})
        fractions = [atom for atom, e in factors if e == 1 and isinstance(atom, Bracket) and _has_fractions(atom.sum)]
        rest = term / fractions[0].sum if fractions else term
        total = total + (spread(fractions[0].sum, rest * by) if fractions else term * by)
    return total


def _has_fractions(value: Formula) -> bool:
    return any(exponent < 0 for factors in value.terms for _, exponent in factors)
