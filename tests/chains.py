"""Equations of k modules in a row, written by hand: shaken bodies on Coulomb friction with springs and dampers between them."""

from __future__ import annotations

import math

from stickslip.engine.symbols import Graph
from stickslip.engine.trace import Contact, Equations, Switch

#: As the page on several contacts has them; friction either way by its coefficient.
MASS, INNER, AMPLITUDE, OMEGA, GRAVITY = 0.07207, 0.00948, 6e-4, 65.4 * math.pi, 9.81
SPRING, DAMPER, FORWARDS, BACKWARDS = 1200.0, 0.4, 0.15, 0.21


def row(phases):
    """The numbers of a case."""
    shaken = INNER * AMPLITUDE * OMEGA**2
    return [MASS, SPRING, DAMPER, shaken, OMEGA, FORWARDS * MASS * GRAVITY, BACKWARDS * MASS * GRAVITY, shaken / MASS / OMEGA, *phases]


def equations(k):
    """The equations of k modules: velocities, then how far each spring is shortened."""
    graph = Graph()
    one, zero = graph.constant(1.0), graph.constant(0.0)
    names = ("mass", "spring", "damper", "shaken", "omega", "forwards", "backwards", "scale", *(f"phase{i}" for i in range(k)))
    mass, spring, damper, shaken, omega, forwards, backwards, scale, *phases = map(graph.case, names)
    t = graph.variable("t")
    v = [graph.variable("v" if i == 0 else f"v{i}") for i in range(k)]
    length = [graph.variable(f"l{i}") for i in range(k - 1)]
    graph.sign(v[0])
    mode = tuple(graph.mode(f"mode{i}") for i in range(k))
    pushed = [spring * length[i] + damper * (v[i] - v[i + 1]) for i in range(k - 1)]
    rates, events, first = [], [], []

    def by_mode(i, up, down, stuck):
        return graph.select(mode[i], up, graph.select(-mode[i], down, stuck))

    def switch(i, new, stopped=False):
        states = tuple(zero if stopped and j == i else None for j in range(2 * k - 1))
        return Switch((*mode[:i], new, *mode[i + 1 :]), states)

    for i in range(k):
        force = shaken * graph.call("cos", phases[i]) * graph.call("sin", omega * t)
        force = force + shaken * graph.call("sin", phases[i]) * graph.call("cos", omega * t)
        force = force - (pushed[i] if i < k - 1 else 0.0) + (pushed[i - 1] if i > 0 else 0.0)
        rates.append(by_mode(i, (force - forwards) / mass, (force + backwards) / mass, zero))
        push, pull = force - forwards, -force - backwards
        rest = graph.select(push, one, graph.select(pull, -one, zero))
        events += [(by_mode(i, v[i], -v[i], one), switch(i, rest, stopped=True)), (by_mode(i, one, one, -push), switch(i, one))]
        events.append((by_mode(i, one, one, -pull), switch(i, -one)))
        first.append(graph.select(v[i], one, graph.select(-v[i], -one, rest)))
    rates += [v[i] - v[i + 1] for i in range(k - 1)]
    return Equations(
        graph=graph, names=names, t=t, y=(*v, *length), f=tuple(rates), offset=zero, free=zero, inertia=None, jacobian=(), by_time=(),
        guards=(v[0], *(guard for guard, _ in events)), guard_rates=(), signs=1,
        switches={1 + j: change for j, (_, change) in enumerate(events)}, modes=mode, first_modes=tuple(first),
        clocks=(), instants=(), impulses=(), period=2 * math.pi / omega, velocity_scale=scale, free_velocity=scale,
        scales=(*(scale,) * (k - 1), *(None,) * (k - 1)), stribeck_velocity=None, cyclic=True, contact=Contact(one, one, one, one),
        mass=mass, offered=None, balances=False,
    )  # fmt: skip
