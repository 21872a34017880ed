"""A law's own equation as LaTeX: its plain Python called with SymPy symbols, once for each direction."""

from __future__ import annotations

from typing import Any

from stickslip.arguments import Law, explains_arguments
from stickslip.errors import InputError
from stickslip.fields import leaves, replace_leaf
from stickslip.forces import is_dynamic, states_of, wants_applied

__all__ = ["latex"]

_NAMES = {"plus": "+", "minus": "-", "load": "N"}
_GREEK = ("mu", "sigma", "alpha", "beta", "gamma", "tau", "kappa")


class _Tex:
    """A SymPy expression with the hooks of `stickslip.maths`."""

    def __init__(self, expression: Any):
        self.expression = expression

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__ss_") and name.endswith("__"):
            import sympy

            function = getattr(sympy, name[5:-2])
            return lambda: _Tex(function(self.expression))
        raise AttributeError(name)

    def __abs__(self) -> _Tex:
        import sympy

        return _Tex(sympy.Abs(self.expression))

    def __ss_power__(self, exponent: Any) -> _Tex:
        import sympy

        return _Tex(sympy.Abs(self.expression) ** _bare(exponent))

    def __neg__(self) -> _Tex:
        return _Tex(-self.expression)


class _Case:
    """A SymPy condition: decided where the side of v decides it, else a case distinction."""

    def __init__(self, condition: Any):
        self.condition = condition

    def __ss_where__(self, yes: Any, no: Any) -> _Tex:
        import sympy

        return _Tex(sympy.Piecewise((_bare(yes), self.condition), (_bare(no), True)))

    def __and__(self, other: _Case) -> _Case:
        return _Case(self.condition & other.condition)

    def __or__(self, other: _Case) -> _Case:
        return _Case(self.condition | other.condition)

    def __invert__(self) -> _Case:
        return _Case(~self.condition)


def _bare(value: Any) -> Any:
    import sympy

    if isinstance(value, float):
        return sympy.nsimplify(value, [sympy.pi])
    return value.expression if isinstance(value, _Tex) else value


def _binary(name: str) -> Any:
    def method(self: _Tex, other: Any) -> _Tex:
        return _Tex(getattr(self.expression, name)(_bare(other)))

    return method


for _name in ("add", "radd", "sub", "rsub", "mul", "rmul", "truediv", "rtruediv", "pow", "rpow"):
    setattr(_Tex, f"__{_name}__", _binary(f"__{_name}__"))
for _name in ("gt", "ge", "lt", "le"):
    setattr(_Tex, f"__{_name}__", (lambda n: lambda self, other: _Case(getattr(self.expression, n)(_bare(other))))(f"__{_name}__"))


def symbol_text(name: str) -> str:
    r"""A field's name as LaTeX: ``mu_plus`` is \mu_{+}."""
    head, _, tail = name.replace(".", "_").partition("_")
    letters = head.rstrip("0123456789")
    index = head[len(letters) :] + _NAMES.get(tail, tail)
    body = f"\\{letters}" if letters in _GREEK else _NAMES.get(letters, letters if len(letters) == 1 else rf"\mathrm{{{letters}}}")
    return body + (f"_{{{index}}}" if index else "")


@explains_arguments
def latex(law: Law) -> str:
    r"""The equations of a friction law as LaTeX, derived from the law's own code.

    Parameters
    ----------
    law : Coulomb, LuGre or any law

    Returns
    -------
    str
        An ``aligned`` block: the friction force R and the rates of the inner states for v > 0 and v < 0; for a set-valued law
        the sliding forces and the interval of forces at rest. Memories of a law stand as m, what would hold the body as R_0.

    Examples
    --------
    >>> import stickslip as ss
    >>> print(ss.latex(ss.Coulomb(mu_plus=0.15, mu_minus=0.21)))
    \begin{aligned}
    R &= N \mu_{+}, && v > 0 \\
    R &= - N \mu_{-}, && v < 0 \\
    - N \mu_{-} \le R &\le N \mu_{+}, && v = 0
    \end{aligned}
    """
    import sympy

    if not (is_dynamic(law) or hasattr(law, "sliding")):
        raise InputError("latex", [f"{type(law).__name__} given; allowed is a friction law; type for example ss.latex(robot.friction)"])
    symbols = {name: _Tex(sympy.Symbol(symbol_text(name), positive=True)) for name, _ in leaves(law)}
    traced, load = replace_leaf(law, symbols), _Tex(sympy.Symbol("N", positive=True))
    sides = [_equations(traced, _Tex(sympy.Symbol("v", **{sign: True})), load) for sign in ("positive", "negative")]
    lines = []
    for (left, plus), (_, minus) in zip(*sides, strict=True):
        if _text(plus) == _text(minus):
            lines.append(f"{left} &= {_text(plus)}")
        else:
            lines += [f"{left} &= {_text(plus)}, && v > 0", f"{left} &= {_text(minus)}, && v < 0"]
    if not is_dynamic(law):
        low, high = traced.breakaway(load)
        lines.append(rf"{_text(low)} \le R &\le {_text(high)}, && v = 0")
    return "\\begin{aligned}\n" + " \\\\\n".join(lines) + "\n\\end{aligned}"


def _text(expression: Any) -> str:
    import sympy

    return str(sympy.latex(_bare(expression)))


def _equations(law: Any, v: _Tex, load: _Tex) -> list[tuple[str, Any]]:
    """Left and right sides on one side of v = 0."""
    import sympy

    if not is_dynamic(law):
        return [("R", law.sliding(v, load))]
    count = states_of(law)
    memory = [_Tex(sympy.Symbol(f"m_{{{i + 1}}}", integer=True)) for i in range(int(getattr(law, "modes", 0)))]
    more = (tuple(memory),) if hasattr(law, "switches") else ()
    applied = (_Tex(sympy.Symbol("R_{0}", real=True)),) if wants_applied(law) else ()
    names = ["z"] if count == 1 else [f"z_{{{i + 1}}}" for i in range(count)]
    z = [_Tex(sympy.Symbol(name, real=True)) for name in names]
    dots = [_Tex(sympy.Symbol(rf"\dot {name}", real=True)) for name in names]
    rate = law.rate(v, z[0] if count == 1 else tuple(z), load, *more)
    force = law.force(v, z[0] if count == 1 else tuple(z), dots[0] if count == 1 else tuple(dots), load, *more, *applied)
    rates = [rate] if count == 1 else list(rate)
    return [("R", force), *((rf"\dot {name}", r) for name, r in zip(names, rates, strict=True))]
