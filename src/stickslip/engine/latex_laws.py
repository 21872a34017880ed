"""The lines of one friction law: force, rates of inner states, and static friction limits."""

from __future__ import annotations

from typing import Any

from stickslip.basics.contracts import Law
from stickslip.engine.letters import Formula, symbol
from stickslip.engine.tex import subscripted, text_of
from stickslip.models.friction.law_adapter import LawAdapter, adapted


def lines_of_law(law: Law, load: Any, slip: str, index: str = "") -> list[str]:
    """The lines of a law whose numbers are symbols, under a load, with the letter of its velocity and the index of its contact."""
    traced, R = adapted(law), subscripted("R", index)
    sides = [_equations(traced, symbol(slip, sign), load, index) for sign in (1, -1)]
    lines = []
    for (left, plus), (_, minus) in zip(*sides, strict=True):
        if text_of(plus) == text_of(minus):
            lines.append(f"{left} &= {text_of(plus)}")
        else:
            lines += [f"{left} &= {text_of(plus)}, && {slip} > 0", f"{left} &= {text_of(minus)}, && {slip} < 0"]
    if not traced.dynamic:
        low, high = traced.breakaway(load)
        lines.append(rf"{text_of(low)} \le {R} &\le {text_of(high)}, && {slip} = 0")
    return lines


def _equations(law: LawAdapter, v: Formula, load: Any, index: str) -> list[tuple[str, Any]]:
    """Left and right sides on one side of v = 0."""
    modes = tuple(symbol(subscripted("m", str(i + 1), index), 0) for i in range(law.modes))
    names = [subscripted("z", str(i + 1) if law.states > 1 else "", index) for i in range(law.states)]
    z, dots = (tuple(symbol(dot + name, 0) for name in names) for dot in ("", r"\dot "))
    force = law.force(v, z, dots, load, modes, symbol(subscripted("R", "0", index), 0))
    rates = zip(names, law.rate(v, z, load, modes), strict=True)
    return [(subscripted("R", index), force), *((rf"\dot {name}", rate) for name, rate in rates)]
