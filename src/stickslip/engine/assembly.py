"""The equations of a machine while they are assembled, contact by contact."""

from __future__ import annotations

from typing import Any

from stickslip.engine.symbolic import Symbolic
from stickslip.engine.symbols import Sym
from stickslip.engine.system import TracedContact


class Assembly:
    """Collects what contact by contact makes of the equations."""

    def __init__(self, m: Symbolic, velocity_scale: Sym):
        self.m, self.velocity_scale, n = m, velocity_scale, len(m.y)
        self.forces: dict[int, Any] = {}  # of dynamic laws
        self.f: list[Any] = [None] * n  # of the coordinates, where a set-valued contact decides them
        self.inner: list[Sym] = []
        self.rates: list[Sym] = []
        self.scales: list[Sym | None] = []
        self.modes: list[Sym] = []
        self.first_modes: list[Sym] = []
        self.memories: dict[int, list[tuple[int, Sym]]] = {}  # modes that a law with inner states remembers, by number of the contact
        self.events: list[tuple[Sym, dict[int, Sym], dict[int, Sym], int]] = []  # guard, new modes, new states, status
        self.own_events: dict[int, int] = {}  # of a contact that decides for itself, the first of its three events
        self.at_rest: dict[int, tuple[dict[int, Sym], dict[int, Sym]]] = {}  # by number of the contact
        self.contacts: list[TracedContact] = []
        self.hits: dict[Any, tuple[int, Sym]] = {}  # of a stop with restitution, its event's number and the size of its impulse

    @property
    def known_forces(self) -> dict[int, Any]:
        """Forces of laws with inner states, which follow from the states whatever rests."""
        return {i: force for i, force in self.forces.items() if self.m.laws[i].dynamic}

    def mode(self, first: Sym) -> tuple[int, Sym]:
        """A new mode, and its number."""
        self.modes.append(self.m.graph.mode(f"mode{len(self.modes)}"))
        self.first_modes.append(first)
        return len(self.modes) - 1, self.modes[-1]

    def slip(self, i: int) -> Sym:
        """The slip of a contact that slides, as its law sees it; at rest zero, and not what rounding makes of a difference."""
        slip, zero = self.m.slips[i], self.m.graph.constant(0.0)
        return slip if i in self.m.owner else self.m.graph.by_side(self.modes[i], slip, slip, zero)

    def per_load(self, i: int, slip: Sym, side: float) -> Sym:
        """Friction of a contact for a load of one, at a slip that is to a side."""
        assumed = self.m.graph.assumed
        assumed[slip.number] = side
        force = self.m.lift(self.m.laws[i].sliding(slip, 1.0))
        assumed.clear()
        return force

    def position(self, number: int) -> Sym:
        """A position by its number among the states."""
        zero = self.m.graph.constant(0.0)
        return [position for position in self.m.places if position is not zero][number - self.first_position]

    @property
    def first_position(self) -> int:
        """The number of the first position among the states: behind velocities, inner states of laws and states of controllers."""
        return len(self.m.y) + len(self.inner) + len(self.m.held)
