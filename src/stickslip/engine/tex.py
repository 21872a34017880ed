"""Formulas as LaTeX, and the letters of a record's numbers."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import sympy
from sympy.printing.latex import LatexPrinter

from stickslip.basics.fields import field_description
from stickslip.engine.letters import Formula, Letter, expression_of, symbol

_NAMES = {"plus": "+", "minus": "-", "load": "N"}
_GREEK = (
    "mu", "sigma", "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "tau", "kappa", "lambda", "nu", "xi", "rho", "omega",
    "theta", "phi", "varphi", "chi", "psi",
)  # fmt: skip
#: The letters of the numbers of robots, mechanisms, drives, tracks and links whose names are words.
_LETTERS = {
    "body_mass": "M", "inner_mass": "m", "gravity": "g", "amplitude": "A", "tilt": r"\theta", "load": "N",
    "mass": "m", "stiffness": "k", "damping": "c", "bias": "P_{0}", "speed": "u", "force": "P", "length": r"\ell",
    "amplitudes": "A", "phase": r"\varphi", "phases": r"\varphi", "lag": r"\delta", "period": "T", "stroke": "L",
    "cosines": "a", "sines": "b",
}  # fmt: skip
_TAKEN = ("t", "x", "v", "R", "w", "F")  # the letters of an equation of motion
_FRACTIONS = (1, 2, 3)  # denominators that stay; others are decimals where these are short, and fractions where both are
_SHORT = 1000


# ---- formulas ----
def text_of(value: Any) -> str:
    r"""LaTeX of a formula or a number; words such as ``\mathrm{head}`` stand apart from their neighbours.

    Examples
    --------
    >>> v, N = symbol("v", 0), symbol("N")
    >>> print(text_of(N * v / (v + 1.2) - 0.8 * v**2))
    \frac{N v}{v + 1.2} - 0.8 v^{2}
    """
    text = _Printer().doprint(expression_of(value))
    text = re.sub(r"(\\mathrm\{[^{}]*\}(?:_\{(?:[^{}]|\{[^{}]*\})*\})?) (?=[\\A-Za-z])(?!\\le|\\ge|\\right)", r"\1 \\, ", text)
    return re.sub(r"(?<=[\w}]) (?=\\mathrm)", r" \\, ", text)


class _Printer(LatexPrinter):
    """SymPy's printer with terms in the order of the literature, and short decimals."""

    def _as_ordered_terms(self, expr: sympy.Add, order: Any = None) -> list[sympy.Expr]:
        """Terms by their letters, then numbers, then terms with brackets; no minus in front of a sum that has a positive term."""
        terms = sorted(expr.args, key=_rank)
        first = next((term for term in terms if term.as_coeff_Mul()[0] > 0), terms[0])
        return [first, *(term for term in terms if term is not first)]

    def _print_Mul(self, expr: sympy.Mul) -> str:
        number, rest = expr.as_coeff_Mul()
        factors = list(sympy.Mul.make_args(rest))
        for sine in [f for f in factors if isinstance(f, sympy.sin)]:
            if (below := 1 / sympy.cos(sine.args[0], evaluate=False)) in factors:
                factors = [f for f in factors if f not in (sine, below)] + [sympy.tan(sine.args[0], evaluate=False)]
        shown = sympy.Float(number) if _is_decimal(number) else number
        return super()._print_Mul(sympy.Mul(*([] if number == 1 else [shown]), *factors, evaluate=False))

    def _needs_mul_brackets(self, expr: sympy.Expr, first: bool = False, last: bool = False) -> bool:
        return not isinstance(expr, sympy.Piecewise) and super()._needs_mul_brackets(expr, first, last)

    def _print_Rational(self, expr: sympy.Rational) -> str:
        return self._print(sympy.Float(expr)) if _is_decimal(expr) else super()._print_Rational(expr)


def _rank(term: sympy.Expr) -> Any:
    """Where a term stands in a sum: 0 for letters and functions, 1 for a number, 2 for a term with a bracket; and its factors."""
    factors = term.as_coeff_Mul()[1].as_ordered_factors()
    rank = 1 if term.is_Number else 2 if any(f.as_base_exp()[0].is_Add for f in factors) else 0
    return rank, [f.sort_key() for f in factors]


def _is_decimal(number: sympy.Rational) -> bool:
    """Whether a number is written as a decimal."""
    return number.q not in _FRACTIONS and (10**12 % number.q == 0 or number.q > _SHORT)


# ---- letters ----
def subscripted(letter: str, *indices: str) -> str:
    r"""A letter with its indices: ``\mu_{+,1}``; those that are empty are left out."""
    joined = ",".join(index for index in indices if index)
    return letter + (f"_{{{joined}}}" if joined else "")


def letter_of(name: str) -> tuple[str, str]:
    r"""A field's name as a letter and an index: ``mu_plus`` is \mu and +."""
    if name in _LETTERS:
        return _LETTERS[name], ""
    head, _, tail = name.partition("_")
    letters = head.rstrip("0123456789")
    index = head[len(letters) :] + _NAMES.get(tail, tail if len(tail) < 2 else upright(tail))
    return f"\\{letters}" if letters in _GREEK else _NAMES.get(letters, letters if len(letters) == 1 else upright(letters)), index


def _own_letter(symbol: str) -> tuple[str, str]:
    r"""A field's own symbol as a letter and an index: ``\mu_{+}`` is \mu and +."""
    letter, _, index = symbol.partition("_")
    return letter, index.removeprefix("{").removesuffix("}") if index.startswith("{") else index


def upright(words: str) -> str:
    r"""Words as they stand, such as ``\mathrm{head}``; what is neither letter nor digit becomes a space."""
    return r"\mathrm{" + r"\ ".join(re.findall(r"[^\W_]+", words)) + "}"


def indices(names: Iterable[str]) -> list[str]:
    r"""Indices of bodies or contacts: none if there is one; the numbers of "module 1", "module 2"; else the names.

    Examples
    --------
    >>> indices(["body"]), indices(["module 1", "module 2"]), indices(["head", "sledge"])
    ([''], ['1', '2'], ['\\mathrm{head}', '\\mathrm{sledge}'])
    """
    names = list(names)
    if len(names) == 1:
        return [""]
    numbered = [re.fullmatch(r"(.*?)[ _]*(\d+)", name) for name in names]
    if all(numbered) and len({match[1] for match in numbered if match}) == 1:
        return [match[2] for match in numbered if match]
    return [name if len(name) == 1 else upright(name) for name in names]


@dataclass(frozen=True)
class Letters:
    """The symbols of a record's numbers by their dotted names, and those that are one of several by their number."""

    symbols: dict[str, Formula]
    numbered: dict[Letter, tuple[str, str]]  # of a symbol: how it prints with %s for its number, and its number

    def renumbered(self, expressions: Iterable[Any], index: str) -> dict[Any, Any]:
        """What replaces the number common to all numbered symbols by an index; nothing if there is none."""
        symbols = {s for value in expressions for s in expression_of(value).free_symbols if s in self.numbered}
        if len({self.numbered[s][1] for s in symbols}) != 1:
            return {}
        return {s: symbol(self.numbered[s][0].replace("%s", index)).expression for s in symbols}


def letters_of_coordinates(names: Iterable[str], reserved: Iterable[str] = ()) -> list[str]:
    r"""Letters of coordinates by their names; q with the name as index where the letter has another meaning in these equations.

    Examples
    --------
    >>> letters_of_coordinates(["x", "theta1", "bend", "z"], reserved=["z"])
    ['x', '\\theta_{1}', '\\mathrm{bend}', 'q_{z}']
    """
    letters, reserved = {name: subscripted(*letter_of(name)) if name not in _LETTERS else upright(name) for name in names}, tuple(reserved)
    return [letter if letter not in reserved else subscripted("q", name) for name, letter in letters.items()]


def dotted(dots: str, letter: str) -> str:
    r"""A letter with its index below a dot or two.

    Examples
    --------
    >>> dotted("dot", "x_{1}"), dotted("ddot", r"\mathrm{bend}")
    ('\\dot x_{1}', '\\ddot{\\mathrm{bend}}')
    """
    stem, index = re.fullmatch(r"(\\mathrm\{[^{}]*\}|[^_]*)(.*)", letter).groups()  # type: ignore[union-attr]
    return rf"\{dots}{{{stem}}}{index}" if "mathrm" in stem else rf"\{dots} {letter}"


def letters_of(record: Any, names: Iterable[str], taken: Iterable[str] = ()) -> Letters:
    """A symbol for each number of a record: its field's own (metadata "symbol"), else by its name; none of those that are taken.

    Numbers of tuples count from one. Names that would share a letter say whose they are, or are spelled out.
    """
    taken = (*_TAKEN, *taken)
    ways = {name: _ways(record, name) for name in names}
    chosen: dict[str, str] = {}
    for length in range(3):
        tried = {name: forms[length].replace("%s", number) for name, (forms, number) in ways.items()}
        for name, text in tried.items():
            is_own = list(tried.values()).count(text) == 1 and text not in taken and text not in _printed(chosen, ways)
            if name not in chosen and (is_own or length == 2):
                chosen[name] = ways[name][0][length]
    symbols = {name: symbol(form.replace("%s", ways[name][1])) for name, form in chosen.items()}
    numbered = {symbols[name].expression: (chosen[name], number) for name, (_, number) in ways.items() if number}
    return Letters(symbols, numbered)


def _printed(chosen: dict[str, str], ways: dict[str, Any]) -> set[str]:
    """How the letters that were chosen print."""
    return {form.replace("%s", ways[name][1]) for name, form in chosen.items()}


def _ways(record: Any, name: str) -> tuple[tuple[str, str, str], str]:
    """Three ways to write a number, from the shortest to the one that is always its own, with %s for its number; and the number."""
    places = name.split(".")
    words, number = [p for p in places if not p.isdigit()], ",".join(str(int(p) + 1) for p in places if p.isdigit())
    digits = "%s" if number else ""
    own = str(field_description(record, name).get("symbol", ""))
    stem, index = _own_letter(own) if own else letter_of(words[-1])
    owner = upright(" ".join(words[:-1])) if words[:-1] else ""
    return (
        subscripted(stem, index, digits),
        subscripted(stem, index, digits, owner),
        subscripted(upright(" ".join(words)), digits),
    ), number
