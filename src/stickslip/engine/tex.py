"""SymPy expressions that stand for numbers while plain Python is called, and the letters of a record's numbers."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from stickslip.fields import told_by_field

__all__ = ["Letters", "Tex", "bare", "indices", "letters_of", "spread", "subscripted", "symbol", "text_of"]

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


class Tex:
    """A SymPy expression with the hooks of `stickslip.maths`."""

    def __init__(self, expression: Any):
        self.expression = expression

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__ss_") and name.endswith("__"):
            import sympy

            function = getattr(sympy, name[5:-2])
            return lambda: Tex(function(self.expression))
        raise AttributeError(name)

    def __abs__(self) -> Tex:
        import sympy

        return Tex(sympy.Abs(self.expression))

    def __ss_power__(self, exponent: Any) -> Tex:
        import sympy

        return Tex(sympy.Abs(self.expression) ** bare(exponent))

    def __neg__(self) -> Tex:
        return Tex(-self.expression)

    def __bool__(self) -> bool:
        raise TypeError("a symbol is neither true nor false; write stickslip.maths.where for a case distinction")


class _Case:
    """A SymPy condition: decided where the side of v decides it, else a case distinction."""

    def __init__(self, condition: Any):
        self.condition = condition

    def __ss_where__(self, yes: Any, no: Any) -> Tex:
        import sympy

        return Tex(sympy.Piecewise((bare(yes), self.condition), (bare(no), True)))

    def __and__(self, other: _Case) -> _Case:
        return _Case(self.condition & other.condition)

    def __or__(self, other: _Case) -> _Case:
        return _Case(self.condition | other.condition)

    def __invert__(self) -> _Case:
        return _Case(~self.condition)

    def __bool__(self) -> bool:
        if self.condition in (True, False):
            return bool(self.condition)
        raise TypeError("a symbol is neither true nor false; write stickslip.maths.where for a case distinction")


def bare(value: Any) -> Any:
    """The SymPy expression of a value; a float as the fraction or multiple of pi that it is near."""
    import sympy

    if isinstance(value, float):
        return sympy.nsimplify(value, [sympy.pi])
    return sympy.sympify(value.expression if isinstance(value, Tex) else value)


def _binary(name: str) -> Any:
    def method(self: Tex, other: Any) -> Tex:
        return Tex(getattr(self.expression, name)(bare(other)))

    return method


for _name in ("add", "radd", "sub", "rsub", "mul", "rmul", "truediv", "rtruediv", "pow", "rpow"):
    setattr(Tex, f"__{_name}__", _binary(f"__{_name}__"))
for _name in ("gt", "ge", "lt", "le"):
    setattr(Tex, f"__{_name}__", (lambda n: lambda self, other: _Case(getattr(self.expression, n)(bare(other))))(f"__{_name}__"))


def symbol(text: str, **assumptions: bool) -> Tex:
    """A symbol that prints as `text`; positive if nothing else is said."""
    import sympy

    return Tex(sympy.Symbol(text, **(assumptions or {"positive": True})))


def text_of(expression: Any) -> str:
    r"""LaTeX of an expression; words such as ``\mathrm{head}`` stand apart from their neighbours."""
    import sympy

    text = str(sympy.latex(_decimal(_with_maxima(bare(expression)))))
    text = re.sub(r"(\\mathrm\{[^{}]*\}(?:_\{(?:[^{}]|\{[^{}]*\})*\})?) (?=[\\A-Za-z])(?!\\le|\\ge)", r"\1 \\, ", text)
    return re.sub(r"(?<=[\w}]) (?=\\mathrm)", r" \\, ", text)


def _decimal(expression: Any) -> Any:
    """Factors and terms such as 4/5 as 0.8; exponents, and fractions that are no short decimals, stay."""
    import sympy

    if expression.is_Rational and not expression.is_Integer and expression.q not in (2, 3):
        return sympy.Float(sympy.N(expression)) if 10**9 % expression.q == 0 else expression
    if expression.is_Pow:
        return _decimal(expression.base) ** expression.exp
    return expression.func(*map(_decimal, expression.args)) if expression.args else expression


def _with_maxima(expression: Any) -> Any:
    """Case distinctions that mean the larger of a value and zero written as that; sums in the arguments of functions multiplied out."""
    import sympy

    def larger(cases: Any) -> Any:
        (value, condition), *others = cases.args
        zero = len(others) == 1 and others[0].expr == 0 and isinstance(condition, (sympy.Gt, sympy.Lt, sympy.Ge, sympy.Le))
        sides = condition.gts - condition.lts if zero else None
        return sympy.Max(value, 0, evaluate=False) if zero and sympy.expand(sides - value) == 0 else cases

    found = expression.replace(lambda e: isinstance(e, sympy.Piecewise), larger)
    periodic = (sympy.sin, sympy.cos)
    return found.replace(lambda e: isinstance(e, periodic), lambda e: e.func(sympy.expand(e.args[0])))


def spread(expression: Any) -> Any:
    """A sum in which brackets of fractions are multiplied out, so that what stands before such a bracket may cancel.

    Examples
    --------
    >>> import sympy
    >>> M, m, a, b = sympy.symbols("M m a b")
    >>> print(spread((M + m) * (a / (M + m) + b)))
    a + b*(M + m)
    """
    import sympy

    found = 0
    for term in sympy.Add.make_args(bare(expression)):
        sums = [s for s in sympy.Mul.make_args(term) if s.is_Add and any(sympy.fraction(part)[1] != 1 for part in s.args)]
        if not sums:
            found += term
            continue
        rest = term / sums[0]
        found += sum((spread(rest * part) for part in sums[0].args), sympy.Integer(0))
    return found


# ---- letters ----
def subscripted(letter: str, *indices: str) -> str:
    r"""A letter with its indices: ``\mu_{+,1}``; those that are empty are left out."""
    told = ",".join(index for index in indices if index)
    return letter + (f"_{{{told}}}" if told else "")


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
    if all(numbered) and len({found[1] for found in numbered if found}) == 1:
        return [found[2] for found in numbered if found]
    return [name if len(name) == 1 else _upright(name) for name in names]


@dataclass(frozen=True)
class Letters:
    """The symbols of a record's numbers by their dotted names, and those that are one of several by their number."""

    symbols: dict[str, Tex]
    numbered: dict[Any, tuple[str, str]]  # of a symbol: how it prints with %s for its number, and its number

    def renumbered(self, expressions: Iterable[Any], index: str) -> dict[Any, Any]:
        """What puts an index for the number that all numbered symbols of some expressions share; nothing if they share none."""
        import sympy

        found = {s for expression in expressions for s in bare(expression).free_symbols if s in self.numbered}
        if len({self.numbered[s][1] for s in found}) != 1:
            return {}
        return {s: sympy.Symbol(self.numbered[s][0].replace("%s", index), positive=True) for s in found}


def letters_of(record: Any, names: Iterable[str]) -> Letters:
    """A symbol for each number of a record: its field's own (metadata "symbol"), else by its name.

    Numbers of tuples count from one. Names that would share a letter say whose they are, or are spelled out.
    """
    ways = {name: _ways(record, name) for name in names}
    chosen: dict[str, str] = {}
    for place in range(3):
        tried = {name: forms[place].replace("%s", number) for name, (forms, number) in ways.items()}
        for name, text in tried.items():
            is_own = list(tried.values()).count(text) == 1 and text not in _TAKEN and text not in _printed(chosen, ways)
            if name not in chosen and (is_own or place == 2):
                chosen[name] = ways[name][0][place]
    symbols = {name: symbol(form.replace("%s", ways[name][1])) for name, form in chosen.items()}
    numbered = {bare(symbols[name]): (chosen[name], number) for name, (_, number) in ways.items() if number}
    return Letters(symbols, numbered)


def _printed(chosen: dict[str, str], ways: dict[str, Any]) -> set[str]:
    """How the letters that were chosen print."""
    return {form.replace("%s", ways[name][1]) for name, form in chosen.items()}


def _ways(record: Any, name: str) -> tuple[tuple[str, str, str], str]:
    """Three ways to write a number, from the shortest to the one that is always its own, with %s for its number; and the number."""
    places = name.split(".")
    words, number = [p for p in places if not p.isdigit()], ",".join(str(int(p) + 1) for p in places if p.isdigit())
    place = "%s" if number else ""
    own = str(told_by_field(record, name).get("symbol", ""))
    letter, index = _own_letter(own) if own else _letter(words[-1])
    owner = _upright(" ".join(words[:-1])) if words[:-1] else ""
    return (
        subscripted(letter, index, place),
        subscripted(letter, index, place, owner),
        subscripted(_upright(" ".join(words)), place),
    ), number
