"""Whether the traced equations of a switching flow are those of plain Python, and whether its functions are functions at all."""

from __future__ import annotations

import random
from collections.abc import Callable
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.basics.errors import InputError
from stickslip.basics.fields import is_array
from stickslip.engine.as_written import check_traces, compare, values_by_name
from stickslip.engine.flow_system import BEGIN, MOST, SIZE, TracedFlow
from stickslip.engine.kinds import First
from stickslip.engine.symbolic import SPAN
from stickslip.models.declaration import Calls, answers, check_repeatable

if TYPE_CHECKING:
    from stickslip.models.switching_flow import SwitchingFlow


_POINTS, _ASIDE = 6, 1e-12
_SIZES = (1.0, 0.1, 10.0, 1e-3, 1.0, 0.3)
_WHAT = "SwitchingFlow"


def _calls(flow: SwitchingFlow, t: float, y: list[float]) -> Calls:
    """Every function of a flow without numbers, each with a state of its own."""
    own, R = len(y) - len(flow.inner), (SimpleNamespace(**_forces(flow)),) if flow.contacts else ()

    def called(f: Callable[..., Any], *more: Any) -> Callable[[], Any]:
        return lambda: _numbers(f(t, np.array(y[:own]), *more))

    functions: dict[str, Callable[[], Any]] = {f"fields[{mode!r}]": called(f, *R) for mode, f in flow.fields.items()}
    for contact, each in flow.contacts.items():
        functions |= {f"contacts[{contact!r}].slip": called(each.slip), f"contacts[{contact!r}].load": called(each.normal)}
    for mode, exits in flow.switches.items():
        for k, switch in enumerate(exits):
            name = f"switches[{mode!r}][{k}]"
            functions[f"{name}.guard"] = called(switch.guard)
            if switch.reset is not None:
                functions[f"{name}.reset"] = called(switch.reset)
            if callable(switch.to):
                functions[f"{name}.to"] = lambda to=switch.to: (to(t, np.array(y[:own])),)
    return functions


def _forces(flow: SwitchingFlow) -> dict[str, float]:
    """Friction forces with which a field is asked."""
    return {name: 0.7 + 0.2 * k for k, name in enumerate(flow.contacts)}


def _numbers(value: Any) -> tuple[Any, ...]:
    rows = list(value) if hasattr(value, "__iter__") else [value]
    return tuple(float(row) if np.ndim(row) == 0 else float(np.ravel(row)[0]) for row in rows)


def single_plain(flow: SwitchingFlow) -> Any:
    """The flow with the numbers of its first case."""
    return flow.replace({name: float(np.ravel(v)[0]) if is_array(v) else v for name, v in flow.numbers.items()}).plain


def values_of_functions(plain: SwitchingFlow, t: float, y: list[float]) -> dict[str, Any]:
    """What every function of a flow without numbers gives at a state, by the function's name; the words of an error where it raises one."""
    return answers(_calls(plain, t, y))


def points_of(flow: SwitchingFlow, n: int) -> list[tuple[float, list[float]]]:
    """Times and states at which a flow is asked, always the same."""
    draw, period = random.Random(20261128), flow.period
    scales = [float(np.ravel(s)[0]) for s in flow.scales or (1.0,) * (n - len(flow.inner))] + [1.0] * len(flow.inner)
    span = 10.0 if period is None else float(np.ravel(period)[0])
    return [
        (span * draw.uniform(0.0, 1.0), [size * scale * draw.uniform(-1.0, 1.0) for scale in scales])
        for size in _SIZES[:_POINTS]
    ]  # fmt: skip


def first_of(flow: SwitchingFlow, n: int) -> First:
    """The functions of a flow, to be asked whether they have changed, and whether they give the same twice."""
    plain = single_plain(flow)
    (t, y), (s, x), *_ = points_of(flow, n)

    def check() -> Any:
        return check_repeatable(_WHAT, _calls(plain, t, y), _calls(plain, s, x), _calls(plain, t, y))

    return First(lambda: answers(_calls(plain, t, y)), check, (plain,))


def check_flow_as_written(flow: SwitchingFlow, n: int) -> None:
    """`InputError` where traced functions of a flow differ from trace to trace, or from what plain Python gives."""
    one, other = TracedFlow(flow, n), TracedFlow(flow, n)
    check_traces(_WHAT, one.expressions, other.expressions)
    points = points_of(flow, n)
    traced, aside = _values(one, flow, points, 0.0), _values(one, flow, points, _ASIDE)
    plain = single_plain(flow)
    for k, (t, y) in enumerate(points):
        for name, given in answers(_calls(plain, t, y)).items():
            if isinstance(given, str):
                continue
            if name.endswith(".to"):
                given = tuple(1.0 + one.modes.index(mode) for mode in given if mode in one.modes)
            values = [(value[k], moved[k]) for value, moved in zip(traced[name], aside[name], strict=True)]
            if len(values) != len(given):
                mistake = f"{name} gives {len(given)} numbers for an array of numbers and {len(values)} for a list of symbols"
                raise InputError(_WHAT, [f"{mistake}; write it coordinate by coordinate: (y[1], -y[0])"])
            compare(_WHAT, name, f"t = {t:.6g}, y = {[float(f'{v:.6g}') for v in y]}", given, values)


def _values(traced: TracedFlow, flow: SwitchingFlow, points: list[tuple[float, list[float]]], aside: float) -> dict[str, list[Any]]:
    """Values of the expressions at some states, which may be moved a little."""
    moved, count = np.random.default_rng(0), len(points)
    own = {name: float(np.ravel(value)[0]) for name, value in flow.numbers.items()} | dict(traced.graph.constants)
    known: dict[str, Any] = {name: value * (1 + aside * moved.uniform(-1, 1)) for name, value in own.items()}
    columns = {"t": [t for t, _ in points]} | {f"y{i}": [y[i] for _, y in points] for i in range(traced.n)}
    known |= {name: np.array(column) * (1 + aside * moved.uniform(-1, 1, count)) for name, column in columns.items()}
    known |= {f"R_{name}": force * (1 + aside * moved.uniform(-1, 1)) for name, force in _forces(flow).items()}
    known |= (
        {BEGIN: 0.0, MOST: 1e4, SPAN: 1.0}
        | {f"{SIZE}{i}": 1.0 for i in range(traced.n)}
        | {f"mode{k}": 1.0 for k in range(len(traced.held))}
    )
    return values_by_name(traced.graph, known, traced.expressions, (count,))
