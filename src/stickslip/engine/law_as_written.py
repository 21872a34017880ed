"""Whether the traced equations of a law alone are those of its plain Python: what is exported, and what steps fits of force records."""

from __future__ import annotations

from typing import Any

import numpy as np

from stickslip.basics.batch import cases_of
from stickslip.basics.contracts import Law
from stickslip.basics.fields import leaves
from stickslip.engine.as_written import check_traces, compare, values_by_name
from stickslip.engine.symbols import Sym
from stickslip.engine.traced_law import TracedLaw
from stickslip.models.friction.law_adapter import LawAdapter, adapted

_POINTS = 6
_ASIDE = 1e-12  # of the arguments, to see what rounding does
_SIZE = 1e-5  # of an inner state whose size the law does not say
_SPEEDS, _LOADS, _PARTS = (1e-4, 1.0), (0.3, 3.0), (-0.9, 0.9)  # m/s both ways; N; of the size of an inner state


def traced_as_written(law: Law) -> TracedLaw:
    """The traced equations of a law; `InputError` where they differ from trace to trace, or from what plain Python gives.

    Examples
    --------
    >>> import stickslip as ss
    >>> traced_as_written(ss.Dahl.example()).exact
    True
    """
    traced, again, case = TracedLaw(law), TracedLaw(law), cases_of(law, slice(1))[0]
    plain, numbers_of_case = adapted(case), {name: float(value) for name, value in leaves(case) if value is not None}
    roots = _roots(traced)
    check_traces(plain.name, roots, _roots(again))
    draw = np.random.default_rng(0)
    for _ in range(_POINTS):
        v = float(draw.choice([-1.0, 1.0]) * np.exp(draw.uniform(*np.log(_SPEEDS))))
        load = float(draw.uniform(*_LOADS))
        sizes = [_SIZE if size is None else float(size) for size in np.ravel(np.array(plain.scale(load), object))] if plain.states else []
        z = tuple(float(size * draw.uniform(*_PARTS)) for size in (sizes * plain.states)[: plain.states])
        given, first = _given(plain, v, load, z), _values(traced, roots, numbers_of_case, v, load, z, 0.0)
        moved = _values(traced, roots, numbers_of_case, v, load, z, _ASIDE)
        for name, numbers in given.items():
            compare(plain.name, name, f"v = {v:.6g}, load = {load:.6g}", numbers, list(zip(first[name], moved[name], strict=True)))
    return traced


def _roots(traced: TracedLaw) -> dict[str, tuple[Sym, ...]]:
    if traced.law.dynamic:
        return {"rate": traced.rates, "force": (traced.force,)}
    return {"sliding": (traced.force,), "breakaway": traced.breakaway}


def _given(law: LawAdapter, v: float, load: float, z: tuple[float, ...]) -> dict[str, list[Any]]:
    """What plain Python gives."""
    memory = (0.0,) * law.modes
    if not law.dynamic:
        return {"sliding": [law.sliding(v, load)], "breakaway": list(law.breakaway(load))}
    rates = tuple(law.rate(v, z, load, memory))
    return {"rate": list(rates), "force": [law.force(v, z, rates, load, memory, 0.0)]}


def _values(
    traced: TracedLaw,
    roots: dict[str, tuple[Sym, ...]],
    numbers: dict[str, float],
    v: float,
    load: float,
    z: tuple[float, ...],
    aside: float,
) -> dict[str, list[float]]:
    """Values of the expressions, whose arguments may be moved a little."""
    known = {"v": v * (1 + aside), "load": load * (1 - aside), "applied": 0.0} | numbers
    known |= {symbol.name: value * (1 + aside) for symbol, value in zip(traced.z, z, strict=True)} | {
        mode.name: 0.0 for mode in traced.mode
    }
    return {name: [value[0] for value in values] for name, values in values_by_name(traced.graph, known, roots, (1,)).items()}
