"""From a model to its equations: call its plain Python with symbols and write down what comes out."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

from stickslip.engine.symbols import STATE, Graph, Sym, TraceError
from stickslip.errors import InputError, Problems
from stickslip.fields import leaves, replace_leaf
from stickslip.maths import maximum

__all__ = ["Equations", "label", "trace"]


@dataclass(frozen=True)
class Equations:
    """What a step needs to know of a model. States are y[0] = v and the law's inner states after it."""

    graph: Graph
    names: tuple[str, ...]  # the case's numbers, in the order of a row
    t: Sym
    y: tuple[Sym, ...]
    f: tuple[Sym, ...]  # dy/dt
    jacobian: tuple[tuple[Sym, ...], ...]
    by_time: tuple[Sym, ...]
    guards: tuple[Sym, ...]
    guard_rates: tuple[Sym, ...]  # total derivative of each guard along the flow
    period: Sym
    velocity_scale: Sym
    free_velocity: Sym  # what the body would do without friction: the unit of strobe distances
    inner_scales: tuple[Sym, ...] | None  # None: the law names no scale
    stribeck_velocity: Sym | None

    @property
    def states(self) -> int:
        """Number of states."""
        return len(self.y)


def label(model: Any) -> str:
    """What a model's kind is called: ``LuGre × Harmonic``."""
    parts = [type(model.friction).__name__] + ([type(model.drive).__name__] if hasattr(model, "drive") else [type(model).__name__])
    track = getattr(model, "track", None)
    if track is not None and type(track).__name__ != "Level":
        parts.append(type(track).__name__)
    return " × ".join(parts)


def inner_states(law: Any) -> int:
    """Number of inner states of a dynamic law."""
    return int(getattr(law, "states", 1))


def _as_tuple(value: Any, count: int, what: str) -> tuple[Any, ...]:
    values = tuple(value) if isinstance(value, (tuple, list)) else (value,)
    if len(values) != count:
        raise TraceError(
            f"{what} gives {len(values)} values; the law has {count} inner state{'s' if count > 1 else ''} (class attribute states)"
        )
    return values


def trace(model: Any) -> Equations:
    """The equations of a model with a dynamic law; `InputError` says what to change in a law that cannot be traced."""
    return _explained(_trace, model)


def _explained(work: Any, model: Any) -> Any:
    """Do some work on a user's law; what goes wrong in it is said as what to write."""
    law_name = type(model.friction).__name__
    check_signatures(model.friction)
    try:
        return work(model)
    except TraceError as error:
        raise InputError(law_name, [str(error)]) from error
    except AttributeError as error:
        raise InputError(
            law_name,
            [
                f"{error}; while a law is traced it has its dataclass fields and methods and nothing else: compute in the method, "
                "or make it a field"
            ],
        ) from error
    except TypeError as error:
        hint = "call functions from stickslip.maths in a law, not from math or numpy, and return a number"
        raise InputError(law_name, [f"{error}; {hint}"]) from error


ARGUMENTS = {
    "rate": ("v", "z", "load"), "force": ("v", "z", "zdot", "load"), "sliding": ("v", "load"), "breakaway": ("load",),
    "scale": ("load",), "velocity_scale": (),
}  # fmt: skip


def check_signatures(law: Any) -> None:
    """A law's methods take what the engine gives, in that order."""
    import inspect

    problems = Problems(type(law).__name__)
    for name, expected in ARGUMENTS.items():
        method = getattr(law, name, None)
        if not callable(method):
            continue
        given = tuple(p.name for p in inspect.signature(method).parameters.values() if p.default is p.empty)
        if len(given) != len(expected) or (set(given) == set(expected) and given != expected):
            problems.add(
                f"{name} takes ({', '.join(given)}); allowed is ({', '.join(expected)}), in this order; type def {name}(self, "
                f"{', '.join(expected)})"
            )
    problems.check()


def _trace(model: Any) -> Equations:
    graph = Graph()
    names = tuple(name for name, _ in leaves(model))
    symbolic: Any = replace_leaf(model, {name: graph.case(name) for name in names})
    law, count = symbolic.friction, inner_states(model.friction)
    t, v = graph.variable("t"), graph.variable("v")
    z = tuple(graph.variable(f"z{i}") for i in range(count))
    graph.sign(v)  # flag 0 is always the side of v
    load = _lift(graph, symbolic.load(t, graph.constant(0.0)))
    contact = _lift(graph, symbolic.contact_velocity(v))
    zdot = tuple(_lift(graph, r) for r in _as_tuple(law.rate(contact, z if count > 1 else z[0], load), count, "rate"))
    force = law.force(contact, z if count > 1 else z[0], zdot if count > 1 else zdot[0], load)
    f = (_spread(_lift(graph, symbolic.acceleration(t, graph.constant(0.0), v, force))), *zdot)
    y = (v, *z)
    jacobian = tuple(tuple(graph.derivative(fi, yj) for yj in y) for fi in f)
    guards = tuple(graph.guards)
    rates = tuple(_along_flow(graph, g, t, y, f) for g in guards)
    scale, speed = getattr(law, "scale", None), getattr(law, "velocity_scale", None)
    return Equations(
        graph=graph,
        names=names,
        t=t,
        y=y,
        f=f,
        jacobian=jacobian,
        by_time=tuple(graph.derivative(fi, t) for fi in f),
        guards=guards,
        guard_rates=rates,
        period=_lift(graph, symbolic.period),
        velocity_scale=_velocity_scale(graph, symbolic.velocity_scale, speed),
        free_velocity=_velocity_scale(graph, getattr(symbolic, "free_velocity", symbolic.velocity_scale), speed),
        inner_scales=None if scale is None else tuple(_lift(graph, s) for s in _as_tuple(scale(load), count, "scale")),
        stribeck_velocity=None if speed is None else _lift(graph, speed()),
    )


def _velocity_scale(graph: Graph, driven: Any, speed: Any) -> Sym:
    """A velocity of the drive, and something positive where the drive is off."""
    driven = _lift(graph, driven)
    return driven if speed is None else maximum(driven, 1e-9 * _lift(graph, speed()))


def _lift(graph: Graph, value: Any) -> Sym:
    return value if isinstance(value, Sym) else graph.constant(value)


def _spread(node: Sym, factor: Sym | None = None) -> Sym:
    """A sum with the case's factors multiplied into its terms, where they are computed once per case."""
    graph = node.graph
    if node.op in ("add", "subtract"):
        a, b = (_spread(x, factor) for x in node.args)
        return a + b if node.op == "add" else a - b
    if node.op == "multiply" and node.args[0].level < STATE and node.args[1].op in ("add", "subtract"):
        return _spread(node.args[1], node.args[0] if factor is None else graph.multiply(factor, node.args[0]))
    return node if factor is None else graph.multiply(factor, node)


def _along_flow(graph: Graph, guard: Sym, t: Sym, y: tuple[Sym, ...], f: tuple[Sym, ...]) -> Sym:
    total = graph.derivative(guard, t)
    for yi, fi in zip(y, f, strict=True):
        total = total + graph.derivative(guard, yi) * fi
    return total


def check_numbers(model: Any) -> None:
    """Call the law with plain floats of the first case; a law that returns NaN is said here, before any compiling."""
    _explained(_check_numbers, model)


def _check_numbers(model: Any) -> None:
    import math

    from stickslip.batch import rows_of

    names = tuple(name for name, _ in leaves(model))
    case: Any = replace_leaf(model, dict(zip(names, (float(c) for c in rows_of(model, names)[0]), strict=True)))
    law, count = case.friction, inner_states(model.friction)
    load, speed = float(case.load(0.0, 0.0)), max(float(case.velocity_scale), 1e-9)
    z0 = (0.0,) * count if count > 1 else 0.0
    for v in (0.0, 1e-2 * speed, -1e-2 * speed, 1e-6 * speed):
        try:
            rate = _as_tuple(law.rate(v, z0, load), count, "rate")
            bad = [r for r in rate if not isinstance(r, (int, float))]
            if bad:
                values = {"rate": bad[0]}
            else:
                values = {"rate": max(map(abs, rate)), "force": law.force(v, z0, rate if count > 1 else rate[0], load)}
        except (ValueError, ZeroDivisionError, OverflowError) as error:
            values = {"rate or force": f"no number ({error})"}
        for what, value in values.items():
            if not isinstance(value, (int, float)) or not math.isfinite(value):
                numbers = {f.name: getattr(law, f.name) for f in dataclasses.fields(law)}
                raise InputError(
                    type(law).__name__,
                    [
                        f"{what}(v={v:.6g}, z=0, load={load:.6g}) is {value} with {numbers}; "
                        "allowed is a finite number; check the law's formula and fields"
                    ],
                )
