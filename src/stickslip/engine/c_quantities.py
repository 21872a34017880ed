"""What can be read of a machine in C, as expressions of what a held lane holds: states as users know them, their rates, and outputs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from stickslip.basics.maths import pi
from stickslip.engine.graphs import Along, Copied
from stickslip.engine.lanes import states_of
from stickslip.engine.symbolic import Symbolic
from stickslip.engine.symbols import Sym
from stickslip.engine.system import System

WAY = "way"  # the variable that is the position of the first coordinate, where no equation needs it


@dataclass(frozen=True)
class Quantity:
    """A number of a machine at an instant.

    Parameters
    ----------
    name : str
    node : Sym
    kind : str
        "position", "velocity", "acceleration", "force", "inner" (of a law) or "control" (of a controller).
    of : str
        The body, contact or controller.
    """

    name: str
    node: Sym
    kind: str
    of: str


@dataclass(frozen=True)
class Quantities:
    """The states with their rates and typical sizes, in the order in which C has them, and all outputs by name."""

    states: tuple[Quantity, ...]
    rates: tuple[Sym, ...]
    sizes: tuple[Sym, ...]
    outputs: dict[str, Quantity]


def quantities_of(model: Any, eq: System) -> Quantities:
    """What can be read of a traced model.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.engine.trace import trace
    >>> belt = ss.BlockOnBelt(mass=2.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0))
    >>> read = quantities_of(belt, trace(belt))
    >>> [state.name for state in read.states], list(read.outputs)
    (['v', 'x'], ['x', 'v', 'a', 'friction_force'])
    """
    graph, layout, n = eq.graph, states_of(eq), eq.coordinates
    way, full = graph.variable(WAY), [y + offset for y, offset in zip(eq.y, eq.offsets, strict=False)]
    names = list(layout.names)
    values = [*full, *eq.y[n:]]
    kinds = ["velocity"] * n + ["inner"] * (eq.states - n)
    owners = [next((name for name, j in eq.bodies if j == i), "") for i in range(n)] + [""] * (eq.states - n)
    for part, kind in [*((c, "inner") for c in layout.contacts), *((c, "control") for c in layout.controllers)]:
        for i in part.inner:
            kinds[i], owners[i] = kind, part.name
    for k, i in enumerate(eq.positions):
        kinds[i], owners[i] = "position", owners[k + int(eq.cyclic)]
    states = [Quantity(*each) for each in zip(names, values, kinds, owners, strict=True)]
    rates, distance = list(eq.f), eq.velocity_scale * eq.period / (2 * pi)
    typical = [eq.velocity_scale if i < n else None if s is None else s for i, s in enumerate(eq.scales)]
    sizes = [graph.constant(1.0) if s is None else s for s in typical]
    sizes = [distance if kind == "position" else size for kind, size in zip(kinds, sizes, strict=True)]
    if eq.cyclic:
        states.insert(0, Quantity("x" if eq.single else f"x.{owners[0]}", way, "position", owners[0]))
        rates.insert(0, full[0])
        sizes.insert(0, distance)
    return Quantities(tuple(states), tuple(rates), tuple(sizes), _outputs(model, eq, states))


def _outputs(model: Any, eq: System, states: list[Quantity]) -> dict[str, Quantity]:
    """Positions, velocities and accelerations of the bodies, inner states, states of controllers; of one body its friction force."""
    m = Symbolic(model, eq.cyclic)
    m.graph.at_once = True
    way, n = m.graph.variable(WAY), eq.coordinates
    q = tuple(way if j == 0 and eq.cyclic else position + way if eq.cyclic else position for j, position in enumerate(m.places))
    a = tuple(m.graph.variable(f"acceleration {j}") for j in range(n))
    copied = Copied(eq.graph, {each.name: f for each, f in zip(a, eq.f, strict=False)})
    of_bodies: dict[str, tuple[Any, ...]] = {
        "position": m.equations.positions(m.t, q),
        "velocity": m.equations.velocities(m.t, m.v),
        "acceleration": m.equations.accelerations_of_bodies(m.t, a),
    }
    letters, outputs = {"position": "x", "velocity": "v", "acceleration": "a"}, []
    for kind, values in of_bodies.items():
        for (name, _), value in zip(eq.bodies, values, strict=True):
            own = letters[kind] if eq.single else f"{letters[kind]}.{name}"
            outputs.append(Quantity(own, copied.of(m.lift(value)), kind, name))
    if eq.single:
        outputs.append(Quantity("friction_force", eq.mass * (eq.free - eq.f[0]), "force", eq.contacts[0].name if eq.contacts else ""))
    outputs += [state for state in states if state.kind in ("inner", "control")]
    return {each.name: each for each in outputs}


def along_seeds(eq: System, cyclic: bool) -> Along:
    """Derivatives along a direction: ``seed0``, ``seed1``, … are its parts in the states, as users know them, and then in the numbers."""
    graph, first = eq.graph, int(cyclic)
    numbers = {name: graph.variable(f"seed{first + eq.states + j}") for j, name in enumerate(eq.names)}
    of_numbers = Along(graph, dict(numbers))
    leaves = dict(numbers)
    for i, y in enumerate(eq.y):
        seed = graph.variable(f"seed{first + i}")
        leaves[y.name] = seed - of_numbers.of(eq.offsets[i]) if i < eq.coordinates else seed
    if cyclic:
        leaves[WAY] = graph.variable("seed0")
    return Along(graph, leaves)
