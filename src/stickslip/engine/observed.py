"""Signals that lanes record over the last motion period of a machine, from its traced equations, and their reductions.

One body on one contact needs none of them: its step has its velocity, slip ratio and work at hand (``kernels/watching.py``). For all else
the expressions are evaluated on the dense output of each step in that period (``kernels/reducing.py``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from stickslip.engine.assembly import Assembly
from stickslip.engine.coupled import sliding_both_ways
from stickslip.engine.flight import touching
from stickslip.engine.kernel_text import function
from stickslip.engine.observing import WAY, observed_node
from stickslip.engine.symbols import Sym
from stickslip.engine.system import Signal, System
from stickslip.engine.values import needed_by
from stickslip.engine.write import Writer

#: What a signal is reduced to: sums of these; one that is taken where a guard falls to zero has the last and the place of that guard.
MEAN, MOST, LEAST, COUNTED, LAST, AT_GUARD = 1, 2, 4, 8, 16, 64
KINDS = {"mean": MEAN, "integral": MEAN, "max": MOST, "min": LEAST, "last": LAST}
#: A user's observables by name.
Observed = tuple[tuple[str, Any], ...]
_LEAST_SLIP = 1e-9  # of the velocity scale: where a slip ratio would be 0/0


def signals_of(parts: Assembly, first_event: int) -> tuple[Signal, ...]:
    """Velocities of the bodies, slips and friction powers of the contacts, what stops do."""
    m = parts.m
    bodies = zip(m.equations.bodies, m.equations.velocities(m.t, m.v), strict=True)
    velocities = [Signal((f"v.{name}",), m.lift(v), MOST | LEAST) for name, v in bodies]
    slips = [Signal((f"w.{name}",), slip, MEAN | MOST | LEAST) for name, slip in zip(m.equations.contacts, m.slips, strict=True)]
    powers = [Signal((f"P.{name}",), _force(parts, i) * m.slips[i], MEAN) for i, name in enumerate(m.equations.contacts)]
    return _merged([*velocities, *slips, *powers, *_of_stops(parts, first_event)])


def _merged(signals: list[Signal]) -> tuple[Signal, ...]:
    """Each expression once, with all that is made of it: a body's velocity is often a slip."""
    merged: dict[Any, Signal] = {}
    for each in signals:
        key = each.node.number, each.guard
        known = merged.get(key)
        merged[key] = each if known is None else Signal(known.names + each.names, each.node, known.kind | each.kind, each.guard)
    return tuple(merged.values())


def _force(parts: Assembly, i: int) -> Sym:
    """Friction force of a contact while it slips; at rest it does no work."""
    m = parts.m
    if m.laws[i].dynamic:
        return m.lift(parts.forces[i])
    forwards, backwards = sliding_both_ways(parts, i)
    return touching(parts, i, m.graph.by_side(parts.modes[i], forwards, backwards, m.graph.constant(0.0)))


def _of_stops(parts: Assembly, first_event: int) -> list[Signal]:
    """Of a stop with restitution the impulse of each hit; of an elastic one its force, and how often that begins."""
    m = parts.m
    signals = []
    for name, stop in m.equations.named_stops:
        if stop.part.restitution is not None:
            event, impulse = parts.hits[stop]
            signals.append(Signal((f"J.{name}",), impulse, 0, first_event + event))
        else:
            x, v = m.equations.positions(m.t, m.places), m.equations.velocities(m.t, m.v)
            signals.append(Signal((f"F.{name}",), m.lift(stop.pressed(x, v, m.t)), MOST | COUNTED))
    return signals


def ratios_of(parts: Assembly, scale: Sym) -> tuple[Sym, ...]:
    """Of each contact under a law with inner states the elastic part of its friction over that in steady sliding, on the side held."""
    m = parts.m
    return tuple(_ratio(parts, i, scale) for i in range(len(m.laws))) if any(law.dynamic for law in m.laws) else ()


def _ratio(parts: Assembly, i: int, scale: Sym) -> Sym:
    m, contact = parts.m, parts.contacts[i]
    law, graph, side = m.laws[i], m.graph, m.graph.sign(m.slips[i])
    if not law.dynamic or not contact.inner:
        return graph.constant(1.0)
    least = _LEAST_SLIP * scale
    slip = graph.select(side * m.slips[i] - least, m.slips[i], side * least)
    z = tuple(parts.inner[k - len(m.y)] for k in contact.inner)
    rate = m.lift(law.rate(slip, z, m.loads[i], tuple(parts.modes[k] for k in contact.modes))[0])
    return graph.constant(1.0) - rate / slip


def with_signals(eq: System, parts: Assembly, observe: Observed) -> System:
    """The equations of a machine with what is noted of its parts, and a user's observables."""
    own = [Signal((f"u.{name}",), observed_node(name, each.function, parts, eq), KINDS[each.reduce]) for name, each in observe]
    return replace(eq, signals=(*signals_of(parts, eq.signs), *own), ratios=ratios_of(parts, eq.velocity_scale))


def looked_at(eq: System) -> tuple[int, ...]:
    """Numbers of the states that signals and slip ratios are made of."""
    ends = [*eq.ratios, *(signal.node for signal in eq.signals)]
    names = {node.name for node in needed_by(ends) if node.op == "variable"}
    return tuple(i for i, y in enumerate(eq.y) if y.name in names)


def lists_of(eq: System, watched: Sequence[int]) -> tuple[tuple[int, ...], ...]:
    """The lists of a table (`driver.table`) on what is noted of several parts; `watched` are the guards of a step, in order."""
    if not eq.signals:
        return ()
    sides = [(c.guard or 0) if c.branches is None else eq.signs + c.modes[0] for c in eq.contacts]
    kinds = [s.kind if s.guard is None else AT_GUARD + watched.index(s.guard) for s in eq.signals]
    states = [next((i for i, y in enumerate(eq.y) if y is s.node), -1) for s in eq.signals]
    own = [next(k for k, s in enumerate(eq.signals) if f"v.{name}" in s.names) for name, _ in eq.bodies]
    return tuple(sides), tuple(kinds), tuple(states), tuple(j for _, j in eq.bodies), tuple(own), looked_at(eq)


def has_arms(eq: System) -> bool:
    """Whether a body moves otherwise than its coordinate, because its distance to another one is prescribed."""
    signals = {name: signal.node for signal in eq.signals for name in signal.names}
    return bool(signals) and any(signals[f"v.{name}"] is not eq.y[j] + eq.offsets[j] for name, j in eq.bodies)


def signals_text(eq: System, watched: Sequence[int]) -> str:
    """The function that evaluates all of them, from time, states, and what the step held: flags of guards that it watched."""
    w = Writer(prefix="s")
    bind = {name: f"row[{i}]" for i, name in enumerate(eq.names)} | {"t": "t"} | {s.name: f"y[{i}]" for i, s in enumerate(eq.y)}
    held = [*(f"b{k}" for k in range(eq.signs)), *(s.name for s in eq.modes), *(f"clk{k}" for k in range(len(eq.clocks)))]
    bind |= {name: f"held[{k}]" for k, name in enumerate(held) if k >= eq.signs or k in watched} | {WAY: "0.0"}  # nothing depends on it
    ends = [*eq.ratios, *(signal.node for signal in eq.signals)]
    for name in dict.fromkeys(node.name for node in needed_by(ends) if node.op == "flag" and node.name not in bind):
        condition = (eq.graph.guards if name[0] == "b" else eq.graph.clocks)[int(name.lstrip("bclk"))]
        bind[name] = w.line(name, f"-1.0 if {w.value(condition, bind)} < 0.0 else 1.0")  # the signals' own: no step ends at it
    lines = [f"out[{k}] = 1.0 * {w.value(node, bind)}" for k, node in enumerate(ends)]
    return function("signals", "row, t, y, held, out", [*w.lines, *lines])
