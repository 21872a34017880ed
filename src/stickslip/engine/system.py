"""The description of a machine for a step: states with rates, contacts, guards with their switches, known instants."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from stickslip.engine.graphs import Along
from stickslip.engine.symbols import Graph, Sym


@dataclass(frozen=True)
class Signal:
    """A quantity recorded over the last motion period, besides the states."""

    names: tuple[str, ...]  # of all that it is
    node: Sym
    kind: int  # what it is reduced to: a sum of the numbers in `observed`
    guard: int | None = None  # it is taken where this guard falls to zero, and nowhere else


@dataclass(frozen=True)
class TracedSwitch:
    """The effect of a guard that falls to zero, besides the flip of its flag."""

    modes: tuple[Sym, ...]  # the new modes
    states: tuple[Sym | None, ...]  # the new states; None: unchanged
    status: int = 0  # the run ends with this status


@dataclass(frozen=True)
class Branches:
    """Accelerations at a set-valued contact: while it slides, and how much is left at the limits of rest."""

    forwards: Sym
    backwards: Sym
    push: Sym  # > 0: the body breaks away forwards
    pull: Sym  # > 0: backwards


@dataclass(frozen=True)
class Flight:
    """Additions to a contact that can fly."""

    mode: int  # number of the mode that is 1 in flight, else 0
    aloft: Sym  # this mode
    first: Sym  # what it begins with
    inner: tuple[int, int]  # numbers of the states that are the gap and its rate
    point: tuple[Sym, ...] = ()  # the same two of a point of a body in the plane, as coordinates have them
    across: tuple[Any, ...] = ()  # how the coordinates change by a unit of impulse upwards
    along: tuple[Any, ...] = ()  # and by one forwards
    together: tuple[int, ...] = ()  # contacts that slip as one while they touch, itself among them


@dataclass(frozen=True)
class TracedContact:
    """One contact: where it stands in the states, guards and modes."""

    name: str
    slip: Sym
    direction: tuple[float, ...]  # what its slip takes of each coordinate's velocity; `SOME` where that is an expression of its row
    state: int | None  # the state that is its slip velocity; None where the slip is made of several, or of time
    guard: int | None  # the guard whose flag holds the side of its slip; None of a set-valued law of several contacts: its mode does
    inner: tuple[int, ...]  # its inner states among the states
    modes: tuple[int, ...]  # its modes among the modes: +1, -1 or 0 (at rest) of a set-valued law, else the law's memories
    branches: Branches | None  # of a set-valued law
    stribeck_velocity: Sym | None
    balances: bool  # a dynamic law that holds the body by the force that is applied: at rest its guards know time alone
    creep_velocity: Sym | None = None  # up to which friction is proportional to the velocity, where the law says it
    least: Sym | None = None  # the least velocity that is told from zero there
    flight: Flight | None = None  # of a contact that leaves where its load falls to zero, and lands again
    row: tuple[Any, ...] = ()  # the coefficients themselves, numbers and expressions, where they are not 1, -1 and 0 alone

    def taken(self, j: int) -> Any:
        """What its slip takes of a coordinate's velocity."""
        return self.row[j] if self.row else self.direction[j]


@dataclass(frozen=True)
class System:
    """The description of a model for a step.

    States are the velocity of each coordinate (less that of what its contact rubs on, where that does not vary), the laws' inner states
    contact by contact, and then the positions that the equations need: of all coordinates, or of all but the first as differences to
    it, whose own position is the integral of its velocity (none, for a single body). For one body y[0] = velocity at the contact.
    Passive states come last.
    """

    graph: Graph
    names: tuple[str, ...]  # the case's numbers, in the order of a row
    t: Sym
    y: tuple[Sym, ...]
    f: tuple[Sym, ...]  # dy/dt
    bodies: tuple[tuple[str, int], ...]  # names, each with the number of the coordinate with which it moves
    slips_of: tuple[tuple[float, ...], ...]  # of each contact, what its slip takes of each body's velocity
    single: bool  # one body with one contact by its kind, as a robot
    offsets: tuple[Sym, ...]  # velocity of each coordinate less the state that stands for it
    contacts: tuple[TracedContact, ...]
    free: Sym  # acceleration of the first coordinate without friction
    inertia: Sym | None  # what the drive's mass does to the body [N], where there is one
    guards: tuple[Sym, ...]
    signs: int  # the first guards have flags that flip; the others are positive until their switch
    switches: dict[int, TracedSwitch]  # by number of the guard
    modes: tuple[Sym, ...]
    first_modes: tuple[Sym, ...]  # from the state, at the start and after an impulse
    clocks: tuple[Sym, ...]
    instants: tuple[Sym, ...]  # when each clock's flag changes
    impulses: tuple[tuple[Sym, tuple[Sym, ...]], ...]  # instant, jump of each coordinate's velocity
    period: Sym
    velocity_scale: Sym
    free_velocity: Sym  # what the body would do without friction: the unit of strobe distances
    scales: tuple[Sym | None, ...]  # typical size of each state; None: not known
    cyclic: bool
    mass: Sym  # all that moves with the first contact [kg]
    shares: tuple[Sym, ...]  # of each position among the states, in the way that the machine makes; none for one body
    offered: Sym | None  # what all forces but friction add up to [N], where time alone decides it; of one body
    principal: str | None = None  # the body whose motion is the machine's
    signals: tuple[Signal, ...] = ()
    ratios: tuple[Sym, ...] = ()  # slip ratios of the contacts, where laws have inner states and there are signals
    apart: tuple[Sym, Sym] | None = None  # of one body: its acceleration by its inner state's rate as a variable, and this variable
    lengths: tuple[Sym | None, ...] = ()  # of each state, after which it comes again in all equations, as an angle does; () if none does
    passive: int = 0  # the last states, on which no other state, no event and no step's length depends (see tangent.py)
    carried: tuple[Sym, ...] = ()  # rates of what the first passive states are changes of; the one after them is a change of an instant
    delays: tuple[Sym, ...] = ()  # change of each known instant, of clocks and then of impulses
    kicks: tuple[tuple[Sym, ...], ...] = ()  # change of each impulse
    forgetting: dict[int, Sym] = field(default_factory=dict)  # changes where an impulse takes v through zero, by number of the state
    settled: dict[int, Sym] = field(default_factory=dict)  # changes with which a run begins, by number of the state: of what rests there
    labels: int = 0  # without contacts, the first so many modes are kept with each piece; the very first one is given with a start
    controllers: tuple[tuple[str, tuple[str, ...], tuple[int, ...]], ...] = ()  # name, names of its states, their numbers
    sampling: tuple[Sym, ...] = ()  # time between samples, which are at its multiples; of a tangent the change of that too
    sampled: dict[int, Sym] = field(default_factory=dict)  # new states at a sample, by number of the state
    sizes: tuple[Sym, ...] = ()  # of the states where a step begins, if no machine says how large they are; a step is as exact as these
    tolerant: bool = False  # without contacts of its own it goes by Rosenbrock steps, which are held to a tolerance

    @property
    def dynamic(self) -> bool:
        """Whether there are laws with a rate and a force, which never rest exactly, and no others."""
        return bool(self.contacts) and all(contact.branches is None for contact in self.contacts)

    @property
    def heights(self) -> tuple[Sym, ...]:
        """Heights of the points that may fly, by the coordinates."""
        return tuple(contact.flight.point[0] for contact in self.contacts if contact.flight is not None and contact.flight.point)

    @property
    def stiff(self) -> bool:
        """Whether some laws have a rate and a force, so that it is solved to a tolerance; others may rest exactly."""
        return self.tolerant or any(contact.branches is None for contact in self.contacts)

    @property
    def sides(self) -> int:
        """How many modes are kept with each piece of the motion: of each contact one."""
        return len(self.contacts) or self.labels

    @property
    def memories(self) -> int:
        """How many modes are given with a start."""
        return sum(len(contact.modes) for contact in self.contacts) if self.dynamic else min(self.labels, 1)

    @property
    def states(self) -> int:
        """Number of states."""
        return len(self.y)

    @property
    def active(self) -> tuple[Sym, ...]:
        """The rates of the states that are not passive: what steps are chosen by."""
        return self.f[: self.states - self.passive]

    @property
    def coordinates(self) -> int:
        """Number of velocities, the first states."""
        return len(self.offsets)

    @property
    def positions(self) -> range:
        """The states that are positions, or differences of positions: the last ones."""
        count, end = self.coordinates - 1 if self.cyclic else self.coordinates, self.states - self.passive
        return range(end - count, end)

    @cached_property
    def jacobian(self) -> tuple[tuple[Sym, ...], ...]:
        """Derivatives of the rates by the states."""
        return tuple(tuple(self.graph.derivative(f, y) for y in self.y) for f in self.f)

    @cached_property
    def by_time(self) -> tuple[Sym, ...]:
        """Derivatives of the rates by time."""
        return tuple(self.graph.derivative(f, self.t) for f in self.f)

    @cached_property
    def guard_rates(self) -> tuple[Sym, ...]:
        """Derivative of each guard along the flow."""
        flow = Along(self.graph, {y.name: f for y, f in zip(self.y, self.f, strict=True)} | {self.t.name: self.graph.constant(1.0)})
        return tuple(map(flow.of, self.guards))

    @property
    def offset(self) -> Sym:
        """Velocity of the first coordinate less the state that stands for it."""
        return self.offsets[0]

    @property
    def contact(self) -> Branches | None:
        """Of a set-valued law of one contact."""
        return self.contacts[0].branches
