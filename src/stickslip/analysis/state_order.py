"""In which order the numbers of a strobe state stand, for one body or for several: velocities, inner states, positions, memories."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.basics.errors import InputError
from stickslip.engine.lanes import layout_of, needed_positions
from stickslip.engine.refused import refusal_of
from stickslip.models.friction.law_adapter import law_of
from stickslip.models.machine_adapter import MachineAdapter, machine_of
from stickslip.models.model_adapter import adapter_of
from stickslip.models.state_layout import StateLayout


@dataclass(frozen=True)
class Order:
    """Which of the numbers of a strobe state are what. Of one body by its kind a position comes first, of a machine of several last.

    Parameters
    ----------
    names : tuple of str
        Of the states, in order, without memories.
    velocities : slice
        Of the coordinates.
    inner : slice
        Inner states, contact by contact, but for those that follow from the coordinates.
    places : slice
        Positions, or what they are more than that of the first coordinate.
    kept : tuple of int
        Of which coordinates: those whose position no force depends on have none.
    cyclic : bool
        Whether no force depends on a common shift of all positions.
    own : tuple of int
        The numbers of the inner states in `inner` among all of them.
    all_inner : int
        How many there are.
    own_sections : dict or None
        `sections` of a model that names its states itself.
    """

    names: tuple[str, ...]
    velocities: slice
    inner: slice
    places: slice
    kept: tuple[int, ...]
    cyclic: bool
    own: tuple[int, ...] = ()
    all_inner: int = 0
    own_sections: Mapping[str, float] | None = None

    @property
    def sections(self) -> Mapping[str, float]:
        """The states by which a section may be cut, with a size of each, against which its motion is measured: all but inner states."""
        inner = self.names[self.inner]
        return {name: 1.0 for name in self.names if name not in inner} if self.own_sections is None else self.own_sections

    @property
    def states(self) -> int:
        """How many numbers there are, without memories."""
        return len(self.names)

    def split(self, y: Sequence[Any] | Array, zero: Any) -> tuple[tuple[Any, ...], tuple[Any, ...], tuple[Any, ...]]:
        """Positions and velocities of the coordinates, and all inner states; `zero` is one that is no number of the state."""
        q = [zero] * (self.velocities.stop - self.velocities.start)
        for j, position in zip(self.kept, y[self.places], strict=True):
            q[j] = position
        z = [zero] * self.all_inner
        for k, state in zip(self.own, y[self.inner], strict=True):
            z[k] = state
        return tuple(q), tuple(y[self.velocities]), tuple(z)

    def joined(self, q: Sequence[Any], u: Sequence[Any], z: Sequence[Any]) -> list[Any]:
        """The numbers of a state from positions, velocities and inner states."""
        numbers: list[Any] = [None] * self.states
        numbers[self.places] = [q[j] - q[0] if self.cyclic else q[j] for j in self.kept]
        numbers[self.velocities], numbers[self.inner] = list(u), [z[k] for k in self.own]
        return numbers


def order_of(model: Model, machine: MachineAdapter | None = None) -> Order:
    """The order of a model's strobe state; who has its adapter gives that too.

    Examples
    --------
    >>> import stickslip as ss
    >>> order_of(ss.Chain.example()).names
    ('v.module 1', 'v.module 2', 'l.module 2')
    >>> order_of(ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0))).names
    ('x', 'v')
    """
    own = adapter_of(model) if machine is None else machine
    if (names := own.own_states) is not None:
        return order_of_names(names, own.sections)
    machine = machine_of(model) if machine is None else machine
    if not machine.names_parts:
        count, placed = law_of(model).states, int(machine.mechanics.knows_place)
        names = (*(("x",) * placed), "v", *numbered_names("z", count))
        kept = tuple(range(placed))
        inner = slice(placed + 1, placed + 1 + count)
        return Order(names, slice(placed, placed + 1), inner, slice(0, placed), kept, not placed, tuple(range(count)), count)
    if why := refusal_of(machine):
        reason = why.partition("; type method=")[0]
        raise InputError(
            type(model).__name__,
            [f"its strobe map is not known: the compiled methods do not solve it, as {reason}; allowed are machines that they solve; "
             "type ss.solve(machine) for its motion from a start"],
        )  # fmt: skip
    return _of_layout(layout_of(model), needed_positions(model), machine.mechanics.flying)


def order_of_names(names: tuple[str, ...], sections: Mapping[str, float] | None = None) -> Order:
    """The order of states that a model names itself; `sections` are those by which a section may be cut."""
    return Order(names, slice(0, len(names)), slice(len(names), len(names)), slice(0, 0), (), False, own_sections=sections)


def _of_layout(layout: StateLayout, kept: tuple[int, ...], flying: tuple[int, ...]) -> Order:
    """The order; gaps of contacts that follow from the coordinates are left out."""
    n = 1 + max(body.velocity for body in layout.bodies)
    every = [(i, state) for i, part in enumerate(layout.with_inner) for state in part.inner]
    own = tuple(k for k, (i, _) in enumerate(every) if i not in flying)
    inner = len(own)
    places = {body.velocity: body.position or 0 for body in layout.bodies}
    states = (*range(n), *(every[k][1] for k in own), *(places[j] for j in kept))
    names = tuple(layout.names[i] for i in states)
    return Order(names, slice(0, n), slice(n, n + inner), slice(n + inner, len(names)), kept, bool(layout.ways), own, len(every))


def numbered_names(name: str, count: int) -> tuple[str, ...]:
    """Names of so many numbers of one kind."""
    return (name,) if count == 1 else tuple(f"{name}{i}" for i in range(count))


def coordinates_in(model: Model, x: Any, v: Any, z: Any) -> list[Array]:
    """The coordinates of a machine, without memories, from columns of a run: (time, body) and (time, contact, state)."""
    m = machine_of(model).mechanics
    q, u = (m.coordinates_of(tuple(np.reshape(each, (len(v), -1)).T)) for each in (x, v))
    inner = [np.reshape(z, (len(v), len(m.inner), -1))[:, i, k] for i, count in enumerate(m.inner) for k in range(count)]
    return order_of(model).joined(q, u, inner)


def states_of_run(run: Any, t: Array) -> dict[str, Array]:
    """The states of a run at some instants, by name, without what laws remember."""
    if not run.pieces.layout.bodies:
        at = run.at(t)
        return {name: np.asarray(at[name], float) for name in run.names}
    run = run.with_axes
    columns = coordinates_in(run.model, *run._states_at(t, run._index(t)))
    return dict(zip(order_of(run.model).names, (np.asarray(column, float) for column in columns), strict=True))


_ANY = "type ss.periodic_orbit(machine), ss.continuation or ss.basins, which take any machine"


def needs_one_body(what: str, model: Model, why: str, hint: str = _ANY) -> None:
    """`InputError` of a machine that lists its bodies, where one body on one contact is wanted; `why` says what for.

    Examples
    --------
    >>> import stickslip as ss
    >>> try:
    ...     needs_one_body("special_curve", ss.Chain.example(), "it follows the arcs of one contact")
    ... except InputError as error:
    ...     print(error.problems[0][:96])
    the Chain has 2 bodies (module 1, module 2) and 2 contacts; allowed is one body on one contact,
    """
    machine = machine_of(model)
    if machine.one_body is not None:
        return
    bodies, contacts = machine.mechanics.bodies, machine.mechanics.contacts
    count = f"{len(bodies)} {'body' if len(bodies) == 1 else 'bodies'} ({', '.join(bodies)}) and {len(contacts)} "
    count += "contact" if len(contacts) == 1 else "contacts"
    allowed = f"allowed is one body on one contact, such as a Robot, as {why}"
    raise InputError(what, [f"the {type(model).__name__} has {count}; {allowed}; {hint}"])
