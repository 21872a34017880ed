"""Formulas as LaTeX, and the letters of a record's numbers."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from stickslip.basics.fields import field_description
from stickslip.engine.letters import (
    Atom,
    Both,
    Bracket,
    Call,
    Cases,
    Extreme,
    Factors,
    Formula,
    Letter,
    Power,
    expanded,
    formula,
    order_of,
    symbol,
)

_NAMES = {"plus": "+", "minus": "-", "load": "N"}
_GREEK = ("mu", "sigma", "alpha", "beta", "gamma", "tau", "kappa", "omega", "theta")
#: The letters of the numbers of robots, mechanisms, drives, tracks and links whose names are words.
_LETTERS = {
    "body_mass": "M", "inner_mass": "m", "gravity": "g", "amplitude": "A", "tilt": r"\theta", "load": "N",
    "mass": "m", "stiffness": "k", "damping": "c", "bias": "P_{0}", "speed": "u", "force": "P", "length": r"\ell",
    "amplitudes": "A", "phase": r"\varphi", "phases": r"\varphi", "lag": r"\delta", "period": "T", "stroke": "L",
    "cosines": "a", "sines": "b",
}  # fmt: skip
_TAKEN = ("t", "x", "v", "R", "w", "F")  # the letters of an equation of motion
_SIGNS = {">": ">", "<": "<", ">=": r"\geq", "<=": r"\leq"}
_FRACTIONS = (2, 3)  # denominators that stay; others are decimals where these are short
_NAMED = ("sin", "cos", "tan", "sinh", "cosh", "tanh", "log")


# ---- formulas ----
def text_of(value: Any) -> str:
    r"""LaTeX of a formula or a number; words such as ``\mathrm{head}`` stand apart from their neighbours.

    Examples
    --------
    >>> v, N = symbol("v", 0), symbol("N")
    >>> print(text_of(N * v / (v + 1.2) - 0.8 * v**2))
    \frac{N v}{v + 1.2} - 0.8 v^{2}
    """
    text = _sum(formula(value))
    text = re.sub(r"(\\mathrm\{[^{}]*\}(?:_\{(?:[^{}]|\{[^{}]*\})*\})?) (?=[\\A-Za-z])(?!\\le|\\ge)", r"\1 \\, ", text)
    return re.sub(r"(?<=[\w}]) (?=\\mathrm)", r" \\, ", text)


def _sum(value: Formula) -> str:
    """Terms by their letters, then numbers, then terms with brackets; a sum does not begin with a minus if it has a positive term."""
    terms = sorted(
        (_rank(factors), [order_of(atom) for atom, _ in factors], _term(factors, number)) for factors, number in value.terms.items()
    )
    texts = [term for *_, term in terms]
    first = next((term for term in texts if not term.startswith("-")), None)
    if first is not None:
        texts.remove(first)
        texts.insert(0, first)
    text = " + ".join(texts).replace("+ -", "-")
    return (text.replace("- ", "-", 1) or "0") if value.is_number else text


def _rank(factors: Factors) -> int:
    """Where a term stands in a sum: 0 for letters and functions, 1 for a number, 2 for a term with a bracket."""
    return 1 if not factors else 2 if any(isinstance(atom, Bracket) for atom, _ in factors) else 0


def _term(factors: Factors, number: Fraction) -> str:
    above, below = _decimal(abs(number))
    over, under = ([pair for pair in factors if (pair[1] > 0) is up] for up in (True, False))
    top = _joined(above, over)
    if under or below != "1":
        top = rf"\frac{{{top}}}{{{_joined(below, [(atom, -e) for atom, e in under])}}}"
    return f"- {top}" if number < 0 else top


def _decimal(number: Fraction) -> tuple[str, str]:
    """A number as what stands above and below a line."""
    if number.denominator in (1, *_FRACTIONS) or 10**12 % number.denominator:
        return str(number.numerator), str(number.denominator)
    return repr(float(number)), "1"


def _joined(number: str, factors: Iterable[tuple[Atom, Fraction]]) -> str:
    """Factors side by side; a bracket alone needs no brackets."""
    atoms = list(factors)
    if number == "1" and len(atoms) == 1 and isinstance(atoms[0][0], Bracket) and atoms[0][1] == 1:
        return _sum(atoms[0][0].sum)
    return " ".join([number] * (number != "1" or not atoms) + [_text(atom, exponent) for atom, exponent in atoms])


def _text(atom: Atom, exponent: Fraction) -> str:
    """A factor with its power."""
    if exponent == Fraction(1, 2):
        return rf"\sqrt{{{_sum(atom.sum) if isinstance(atom, Bracket) else _text(atom, Fraction(1))}}}"
    raised = "" if exponent == 1 else f"^{{{_sum(formula(exponent))}}}"
    if isinstance(atom, Letter):
        return atom.text if not raised else f"{{{atom.text}}}{raised}" if "^" in atom.text else atom.text + raised
    if isinstance(atom, Bracket):
        return _bracketed(atom.sum) + raised
    if isinstance(atom, Call):
        return _called(atom, raised, exponent)
    if isinstance(atom, Power):
        return f"{_based(atom.base)}^{{{_sum(atom.exponent if exponent == 1 else atom.exponent * exponent)}}}"
    return (_extreme(atom) if isinstance(atom, Extreme) else _cases(atom)) + raised


def _bracketed(value: Formula) -> str:
    return rf"\left({_sum(value)}\right)"


def _based(base: Formula) -> str:
    """The base of a power: a letter or a number as it stands, anything else in brackets."""
    text = _sum(base)
    return text if not base.is_sum and re.fullmatch(r"\\?\w+(_\{.*\})?|\\left\|.*\\right\|", text) else rf"\left({text}\right)"


def _called(call: Call, raised: str, exponent: Fraction) -> str:
    inner = _sum(expanded(call.argument) if call.name in ("sin", "cos") else call.argument)
    if call.name == "exp":
        return f"e^{{{_sum(call.argument * exponent)}}}"
    if call.name == "abs":
        return rf"\left|{{{inner}}}\right|{raised}"
    name = rf"\{call.name}" if call.name in _NAMED else rf"\operatorname{{{call.name}}}"
    return rf"{name}{raised}{{\left({inner} \right)}}"


def _extreme(atom: Any) -> str:
    two = sorted((atom.one, atom.other), key=lambda value: not value.is_number)
    return rf"\{atom.name}\left({_sum(two[0])}, {_sum(two[1])}\right)"


def _cases(atom: Any) -> str:
    lines, rest = [], formula(1) * Formula.of(atom)
    while (cases := _only_cases(rest)) is not None:
        lines.append(rf"{_sum(cases.yes)} & \text{{for}}\: {_condition(cases.condition)}")
        rest = cases.no
    return r"\begin{cases} " + r" \\".join([*lines, rf"{_sum(rest)} & \text{{otherwise}}"]) + r" \end{cases}"


def _only_cases(value: Formula) -> Cases | None:
    """The case distinction that a formula is, if it is one."""
    (atom,) = atoms if len(atoms := [a for factors in value.terms for a, _ in factors]) == 1 else [None]
    return atom if isinstance(atom, Cases) and value == Formula.of(atom) else None


def _condition(condition: Any) -> str:
    if isinstance(condition, Both):
        return rf"{_condition(condition.one)} {condition.joined} {_condition(condition.other)}"
    return f"{_sum(condition.left)} {_SIGNS[condition.sign]} {_sum(condition.right)}"


# ---- letters ----
def subscripted(letter: str, *indices: str) -> str:
    r"""A letter with its indices: ``\mu_{+,1}``; those that are empty are left out."""
    joined = ",".join(index for index in indices if index)
    return letter + (f"_{{{joined}}}" if joined else "")


def _letter(name: str) -> tuple[str, str]:
    r"""A field's name as a letter and an index: ``mu_plus`` is \mu and +."""
    if name in _LETTERS:
        return _LETTERS[name], ""
    head, _, tail = name.partition("_")
    letters = head.rstrip("0123456789")
    index = head[len(letters) :] + _NAMES.get(tail, tail if len(tail) < 2 else _upright(tail))
    return f"\\{letters}" if letters in _GREEK else _NAMES.get(letters, letters if len(letters) == 1 else _upright(letters)), index


def _own_letter(symbol: str) -> tuple[str, str]:
    r"""A field's own symbol as a letter and an index: ``\mu_{+}`` is \mu and +."""
    letter, _, index = symbol.partition("_")
    return letter, index.removeprefix("{").removesuffix("}") if index.startswith("{") else index


def _upright(words: str) -> str:
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
    return [name if len(name) == 1 else _upright(name) for name in names]


@dataclass(frozen=True)
class Letters:
    """The symbols of a record's numbers by their dotted names, and those that are one of several by their number."""

    symbols: dict[str, Formula]
    numbered: dict[Atom, tuple[str, str]]  # of a symbol: how it prints with %s for its number, and its number

    def renumbered(self, expressions: Iterable[Any], index: str) -> dict[Any, Any]:
        """A function that replaces the number common to all numbered symbols by an index; nothing if there is none."""
        symbols = {s for expression in expressions for s in formula(expression).atoms if s in self.numbered}
        if len({self.numbered[s][1] for s in symbols}) != 1:
            return {}
        return {s: symbol(self.numbered[s][0].replace("%s", index)) for s in symbols}


def letters_of(record: Any, names: Iterable[str]) -> Letters:
    """A symbol for each number of a record: its field's own (metadata "symbol"), else by its name.

    Numbers of tuples count from one. Names that would share a letter say whose they are, or are spelled out.
    """
    ways = {name: _ways(record, name) for name in names}
    chosen: dict[str, str] = {}
    for length in range(3):
        tried = {name: forms[length].replace("%s", number) for name, (forms, number) in ways.items()}
        for name, text in tried.items():
            is_own = list(tried.values()).count(text) == 1 and text not in _TAKEN and text not in _printed(chosen, ways)
            if name not in chosen and (is_own or length == 2):
                chosen[name] = ways[name][0][length]
    texts = {name: form.replace("%s", ways[name][1]) for name, form in chosen.items()}
    symbols = {name: symbol(text) for name, text in texts.items()}
    numbered = {Letter(texts[name]): (chosen[name], number) for name, (_, number) in ways.items() if number}
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
    stem, index = _own_letter(own) if own else _letter(words[-1])
    owner = _upright(" ".join(words[:-1])) if words[:-1] else ""
    return (
        subscripted(stem, index, digits),
        subscripted(stem, index, digits, owner),
        subscripted(_upright(" ".join(words)), digits),
    ), number
