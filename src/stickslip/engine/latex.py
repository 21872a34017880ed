"""The equations of a law or of a robot as LaTeX: their plain Python called with SymPy symbols, a law once for each direction."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from stickslip.arguments import LawOrModel, explains_arguments
from stickslip.errors import InputError
from stickslip.fields import leaves, replace_leaf
from stickslip.friction.adapter import LawAdapter, adapted, is_law, law_of
from stickslip.machine import is_machine
from stickslip.mechanics import normal_load

__all__ = ["latex", "written"]

_NAMES = {"plus": "+", "minus": "-", "load": "N"}
_GREEK = ("mu", "sigma", "alpha", "beta", "gamma", "tau", "kappa", "omega", "theta")
#: The letters of the numbers of robots, mechanisms, drives and tracks whose names are words.
_LETTERS = {
    "body_mass": "M", "inner_mass": "m", "gravity": "g", "amplitude": "A", "tilt": r"\theta", "load": "N",
    "mass": "m", "stiffness": "k", "damping": "c", "speed": "u", "force": "P",
    "amplitudes": "A", "phase": r"\varphi", "phases": r"\varphi", "period": "T", "stroke": "L", "cosines": "a", "sines": "b",
}  # fmt: skip


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
    if name in _LETTERS:
        return _LETTERS[name]
    head, _, tail = name.replace(".", "_").partition("_")
    letters = head.rstrip("0123456789")
    index = head[len(letters) :] + _NAMES.get(tail, tail)
    body = f"\\{letters}" if letters in _GREEK else _NAMES.get(letters, letters if len(letters) == 1 else rf"\mathrm{{{letters}}}")
    return body + (f"_{{{index}}}" if index else "")


@explains_arguments
def latex(model: LawOrModel) -> str:
    r"""The equations of a friction law, or of a whole robot, as LaTeX, derived from their own code.

    Parameters
    ----------
    model : Coulomb, LuGre or any law; Robot or mechanism
        Of a robot or a mechanism: the equation of motion with the jumps of the velocity, the load where it is no number of its own,
        and the law. Where the contact moves, the law's v is the velocity v_c at the contact.

    Returns
    -------
    str
        An ``aligned`` block: the friction force R and the rates of the inner states for v > 0 and v < 0; for a set-valued law
        the sliding forces and the interval of forces at rest. Memories of a law stand as m, what would hold the body as R_0.

    Raises
    ------
    InputError
        If it is neither, or if what drives it is no formula, such as a record.

    Examples
    --------
    >>> import stickslip as ss
    >>> print(ss.latex(ss.Coulomb(mu_plus=0.15, mu_minus=0.21)))
    \begin{aligned}
    R &= N \mu_{+}, && v > 0 \\
    R &= - N \mu_{-}, && v < 0 \\
    - N \mu_{-} \le R &\le N \mu_{+}, && v = 0
    \end{aligned}
    >>> print(ss.latex(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb")))
    \begin{aligned}
    \ddot x &= \frac{A \omega^{2} m \sin{\left(\omega t \right)}}{M + m} - \frac{R}{M + m} \\
    N &= g \left(M + m\right) \\
    R &= N \mu_{+}, && v > 0 \\
    R &= - N \mu_{-}, && v < 0 \\
    - N \mu_{-} \le R &\le N \mu_{+}, && v = 0
    \end{aligned}
    """
    moves = is_machine(model)
    law = law_of(model).law if moves else model
    if not is_law(law):
        given = f"{type(model).__name__} given; allowed is a friction law or a robot"
        raise InputError("latex", [f"{given}; type for example ss.latex(robot.friction)"])
    lines, load, slip = _of_motion(model) if moves else ([], _symbol("N"), "v")
    return "\\begin{aligned}\n" + " \\\\\n".join(lines + _of_law(law, load, slip)) + "\n\\end{aligned}"


def written(function: Callable[..., Any], **names: str) -> list[str]:
    r"""What a function of plain Python computes, as LaTeX, one text for each number that it returns; `names`: its arguments' symbols.

    Examples
    --------
    >>> from stickslip.tracks import fold
    >>> print(*written(fold, coefficient=r"\mu_{0}", tilt=r"\theta"), sep="\n")
    \mu_{0} \cos{\left(\theta \right)} - \sin{\left(\theta \right)}
    \mu_{0} \cos{\left(\theta \right)} + \sin{\left(\theta \right)}
    """
    import sympy

    symbols = {name: _symbol(text) for name, text in names.items()}
    slopes = {sympy.sin(s.expression) / sympy.cos(s.expression): sympy.tan(s.expression) for s in symbols.values()}
    found = function(**symbols)
    return [_text(_bare(value).subs(slopes)) for value in (found if isinstance(found, tuple) else (found,))]


def _symbol(text: str, **assumptions: bool) -> _Tex:
    import sympy

    return _Tex(sympy.Symbol(text, **(assumptions or {"positive": True})))


def _of_motion(model: Any) -> tuple[list[str], _Tex, str]:
    """The equation of motion and what else its law needs, as lines; the load as the law sees it; and the letter of its velocity."""
    traced = replace_leaf(model, _letters_of([name for name, _ in leaves(model) if not name.startswith("friction.")]))
    t, x, v, R, N = (*(_symbol(letter, real=True) for letter in ("t", "x", "v", "R")), _symbol("N"))
    try:
        lines = [rf"\ddot x &= {_text(traced.acceleration(t, x, v, R))}"]
        lines += [rf"\Delta v &= {_text(jump)}, && t = {_text(instant)}" for instant, jump in getattr(traced, "impulses", ())]
    except (TypeError, ValueError, AttributeError):  # a record, say: numbers and no formula
        why = f"what drives this {type(model).__name__} cannot be written as a formula"
        raise InputError("latex", [f"{why}; for its law alone type ss.latex(robot.friction)"]) from None
    load, slip = _bare(normal_load(traced, t, x)), _bare(traced.contact_velocity(v))
    if load not in (1, N.expression):
        lines.append(f"N &= {_text(load)}")
    if slip != v.expression:
        lines.append(f"v_{{c}} &= {_text(slip)}")
    return lines, _Tex(load) if load == 1 else N, "v" if slip == v.expression else "v_{c}"


def _letters_of(names: list[str]) -> dict[str, _Tex]:
    """A symbol for each number of a robot, by its dotted name; those that would share a letter have their place as its index."""
    places = [name.split(".") for name in names]
    short = [f"{symbol_text(p[-2])}_{{{p[-1]}}}" if p[-1].isdigit() else symbol_text(p[-1]) for p in places]
    long = [rf"{{{text}}}_{{\mathrm{{{'.'.join(p[:-1])}}}}}" for text, p in zip(short, places, strict=True)]
    return {n: _symbol(s if short.count(s) == 1 else own) for n, s, own in zip(names, short, long, strict=True)}


def _of_law(law: Any, load: _Tex, slip: str) -> list[str]:
    """The lines of a law."""
    traced = adapted(replace_leaf(law, {name: _symbol(symbol_text(name)) for name, _ in leaves(law)}))
    sides = [_equations(traced, _symbol(slip, **{sign: True}), load) for sign in ("positive", "negative")]
    lines = []
    for (left, plus), (_, minus) in zip(*sides, strict=True):
        if _text(plus) == _text(minus):
            lines.append(f"{left} &= {_text(plus)}")
        else:
            lines += [f"{left} &= {_text(plus)}, && {slip} > 0", f"{left} &= {_text(minus)}, && {slip} < 0"]
    if not traced.dynamic:
        low, high = traced.breakaway(load)
        lines.append(rf"{_text(low)} \le R &\le {_text(high)}, && {slip} = 0")
    return lines


def _text(expression: Any) -> str:
    import sympy

    return str(sympy.latex(_bare(expression)))


def _equations(law: LawAdapter, v: _Tex, load: _Tex) -> list[tuple[str, Any]]:
    """Left and right sides on one side of v = 0."""
    import sympy

    modes = tuple(_Tex(sympy.Symbol(f"m_{{{i + 1}}}", integer=True)) for i in range(law.modes))
    names = ["z"] if law.states == 1 else [f"z_{{{i + 1}}}" for i in range(law.states)]
    z, dots = (tuple(_symbol(dot + name, real=True) for name in names) for dot in ("", r"\dot "))
    force = law.force(v, z, dots, load, modes, _symbol("R_{0}", real=True))
    return [("R", force), *((rf"\dot {name}", rate) for name, rate in zip(names, law.rate(v, z, load, modes), strict=True))]
