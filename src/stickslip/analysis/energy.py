"""Where the energy of a run went, period by period."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.analysis.flow_contacts import friction_work
from stickslip.analysis.losses_at_instants import at_landings, lost_at_hits
from stickslip.analysis.steady import is_run
from stickslip.basics.arguments import described_as, explains_arguments
from stickslip.basics.contracts import Array
from stickslip.basics.frozen_arrays import sealed
from stickslip.basics.notebook_display import Drawn
from stickslip.models.machine_adapter import machine_of
from stickslip.results.dense_output import HarmonicArcs

if TYPE_CHECKING:
    from stickslip.results.trajectory import Trajectory

#: Gauss-Legendre nodes on a piece. An arc may last a whole drive period: there 24 nodes integrate products of sines to rounding
#: (error below (2 pi)^48 / 48! = 2e-23); a step of an integrator is far shorter than a period.
NODES_ARC, NODES_STEP = 24, 10
_FLOOR = 1e-9  # of the largest energies of a run: less is exchanged by what is at rest but for rounding


@described_as("what ss.energy returns; type ss.energy(ss.solve(robot))")
@sealed
@dataclass(frozen=True, eq=False)
class Energy(Drawn):
    r"""Energy balance in each period, :math:`W_d + W_g - W_f - W_c = \Delta E + \Delta U` with :math:`E = (M+m)\dot x^2/2`.

    A run without a period is one row; so is what a run has left over behind its last whole period.

    Parameters
    ----------
    drive : array (periods,)
        W_d, work that comes in [J]: of the inertial drive force -m d²xi/dt² with its impulses, of the pulled end of a spring,
        of the motor of a belt, of a given force. Of a machine that lists its bodies that of all applied forces but gravity, of what moves
        the ground under a contact, and of what prescribes distances.
    gravity : array (periods,)
        W_g, work of gravity along the track [J]; of a machine that lists its bodies that of what they say is `gravity`.
    friction : array (periods,)
        W_f, work that friction takes at the contact, or at all of them [J].
    damping : array (periods,)
        W_c, work that the damping of a mechanism, or of links and elastic stops, takes, and what is lost across where points of bodies
        hit the ground [J].
    potential : array (periods,)
        Change of the energy U in the spring of a mechanism, or in links and elastic stops [J].
    kinetic : array (periods,)
        Change of the kinetic energy [J].
    actuator : array (periods,)
        Work of the actuator, which also moves the inner mass against the body [J]; 0 for a mechanism.
    residual : array (periods,)
        What is missing in the balance, over the largest energy that a force, the motion or a spring exchanges within a drive period [-]:
        the integral of the size of a power, and the range of the kinetic energy, for periods after settling their largest ones
        there. Works that cancel in a period, and a body that hardly moves, are no measure of an error.
    settle : int
        How many periods belong to settling.
    friction_of : dict of array (periods,)
        What friction takes at each contact, by its name [J].
    damping_of : dict of array (periods,)
        Of a machine that lists its parts, what each link and each stop takes, by the bodies that it joins [J]; a stop beside a link is
        "head-tail (stop)".
    """

    drive: Array
    gravity: Array
    friction: Array
    damping: Array
    potential: Array
    kinetic: Array
    actuator: Array
    residual: Array
    settle: int
    friction_of: dict[str, Array] = field(default_factory=dict)
    damping_of: dict[str, Array] = field(default_factory=dict)

    _drawn_by = "energy"
    unit = "J"

    @property
    def works(self) -> dict[str, Array]:
        """What a figure stacks for each period, negative where energy is taken."""
        return {"drive": self.drive, "gravity": self.gravity, "friction": -self.friction, "damping": -self.damping}

    @property
    def stored(self) -> Array:
        """Change of the kinetic and the potential energy in each period [J]."""
        return np.asarray(self.kinetic + self.potential)

    def _facts(self) -> dict[str, Any]:
        works = {name: getattr(self, name) for name in ("drive", "gravity", "friction", "damping")}
        for kind, parts in (("friction", self.friction_of), ("damping", self.damping_of)):
            works |= {f"{kind} of {name}": work for name, work in parts.items() if len(parts) > 1}
        means = {name: float(np.mean(work[self.settle :])) for name, work in works.items() if len(work) > self.settle}
        largest = max(map(abs, means.values()), default=0.0)
        shares = {f"work of {name}, a period": f"{mean:.6g} J" for name, mean in means.items() if abs(mean) > 1e-12 * largest}
        return {**shares, "worst residual": f"{self.worst:.1e}"}

    def __repr__(self) -> str:
        n = len(self.drive)
        last = {name: float(work[-1]) for name, work in (*self.works.items(), ("change of energy", self.stored))} if n else {}
        largest = max(map(abs, last.values()), default=0.0)
        shown = ", ".join(f"{name} {work:.4g} J" for name, work in last.items() if abs(work) > 1e-12 * largest) or "nothing moves"
        if n == 1:
            return f"<Energy of the run: {shown}; residual {self.worst:.1e}>"
        return f"<Energy of {n} periods; last: {shown}; worst residual {self.worst:.1e}>"

    @property
    def worst(self) -> float:
        """Largest size of the residual after settling."""
        return float(abs(self.residual[self.settle :]).max(initial=0.0))


@explains_arguments
def energy(run: Trajectory) -> Energy:
    """Energy balance of a run, period by period; of a run of a flow with contacts the work that friction takes.

    The forces in the integrals are those that the law and the drive give on the dense output, not those that the equation of motion
    implies, so the residual measures how well the run satisfies it.

    Parameters
    ----------
    run : Trajectory

    Returns
    -------
    Energy or FrictionWork

    Raises
    ------
    InputError
        Of a flow without contacts, which has no forces.

    Examples
    --------
    >>> import stickslip as ss
    >>> from stickslip.results.trajectory import Trajectory
    >>> robot = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=1e-4, law="coulomb")
    >>> at_rest = HarmonicArcs(np.array([0.0, robot.period]), np.array([0]), np.zeros(1), np.zeros(1), 0.555, robot.drive.omega, 1.77, 1.77)
    >>> ss.energy(Trajectory(robot, at_rest, periods=1, settle=0, rtol=1e-6, method="by hand")).friction.tolist()
    [0.0]
    """
    is_run("energy", run, bodies=False)
    if not run.pieces.layout.bodies:
        of_flow: Any = friction_work(run)
        return of_flow
    run, mechanics = run.with_axes, machine_of(run.model).mechanics
    borders, x, v = _borders(run)
    edges, index, owner = _cut(run, borders)
    nodes, weights = np.polynomial.legendre.leggauss(NODES_ARC if isinstance(run.pieces, HarmonicArcs) else NODES_STEP)
    count = len(borders) - 1
    parts = [
        _integrals(run, edges[first : last + 1], index[first:last], owner[first:last], count, (nodes, weights))
        for first, last in _stretches(len(index), len(nodes), len(run.pieces.layout.bodies))
    ]
    works, of_parts, gross, low, high = parts[0]
    for more, of_more, others, lower, higher in parts[1:]:
        works = {name: work + more[name] for name, work in works.items()}
        of_parts = {name: {part: work + of_more[name][part] for part, work in each.items()} for name, each in of_parts.items()}
        gross = [a + b for a, b in zip(gross, others, strict=True)]
        low, high = np.minimum(low, lower), np.maximum(high, higher)
    for (when, jump), row in zip(run._columns.impulses, _rows(run, borders), strict=True):
        _add_impulse(run, works, when, jump, row)
    for when, loss, given, stop in lost_at_hits(run, mechanics):
        row = _row_of_hit(run, borders, when)
        of_parts["damping"].setdefault(stop, np.zeros(count))[row] += loss
        works["drive"][row] += given
    for when, taken, lost, given, contact in at_landings(run, mechanics):
        row = np.clip(np.searchsorted(borders, when, side="right") - 1, 0, count - 1)
        of_parts["friction"][contact][row] += taken
        if mechanics.joined:
            of_parts["damping"].setdefault(f"{contact} (hits)", np.zeros(count))[row] += lost
        works["drive"][row] += given
    works |= {n: sum(of_parts[n].values(), np.zeros(count)) for n in of_parts if of_parts[n]}
    changes = {"kinetic": np.diff(mechanics.kinetic(v, x))}
    if (stored := mechanics.potential(borders, x)) is not None:
        changes["potential"] = np.diff(stored)
    gross = [*gross, *(abs(w) for n, w in {**works, **changes}.items() if n != "actuator")]
    residual = _residual(run, {**works, **changes}, gross, low, high)
    balance: dict[str, Any] = {**works, **changes}
    by_part: dict[str, Any] = {f"{n}_of": work for n, work in of_parts.items()}
    return Energy(**balance, residual=residual, settle=min(int(run.settle), count), **by_part)


#: Numbers of a column up to which it is computed as a whole; fewer of many bodies.
_AT_ONCE, _OF_MANY, _MANY = 30_000_000, 4_000_000, 16


def _stretches(pieces: int, nodes: int, bodies: int) -> list[tuple[int, int]]:
    """First and last of the pieces whose columns are computed together, with so many nodes on each."""
    size = max((_OF_MANY if bodies > _MANY else _AT_ONCE) // (nodes * bodies), 1)
    return [(first, min(first + size, pieces)) for first in range(0, pieces, size)]


def _integrals(run: Trajectory, edges: Array, index: Array, owner: Array, count: int, rule: tuple[Array, Array]) -> tuple[Any, ...]:
    """Works of pieces by name, and by part; integrals of the sizes of all powers; least and largest kinetic energy: each for every row."""
    nodes, weights = rule
    half = 0.5 * np.diff(edges)
    t = (edges[:-1] + half)[:, None] + half[:, None] * nodes
    powers = _powers(run, t.ravel(), np.repeat(index, len(nodes)))

    def integral(power: Array) -> Array:
        return np.bincount(owner, (power.reshape(t.shape) @ weights) * half, count)

    of_parts = _of_parts(run, powers, integral)
    works = {n: integral(p) for n, p in powers.items() if p.ndim == 1} | {n: np.zeros(count) for n, p in powers.items() if p.ndim == 2}
    gross = [integral(abs(p)) for n, part in powers.items() if n != "actuator" for p in (part.T if part.ndim == 2 else part[None])]
    x, v = run._states_at(t.ravel(), np.repeat(index, len(nodes)))[:2]
    kinetic = machine_of(run.model).mechanics.kinetic(v, x).reshape(t.shape)
    low, high = np.full(count, np.inf), np.zeros(count)
    np.minimum.at(low, owner, kinetic.min(axis=1))
    np.maximum.at(high, owner, kinetic.max(axis=1))
    return works, of_parts, gross, low, high


def _of_parts(run: Trajectory, powers: dict[str, Array], integral: Any) -> dict[str, dict[str, Array]]:
    """Works of friction by contact, and of damping by link; parts with the same ends are added."""
    names = {"friction": list(run.contacts), "damping": machine_of(run.model).mechanics.names_of_links}
    works_of: dict[str, dict[str, Array]] = {"friction": {}, "damping": {}}
    for of, works in works_of.items():
        for name, power in zip(names[of], powers[of].T if powers[of].ndim == 2 else (), strict=True):
            works[name] = works.get(name, 0.0) + integral(power)
    return works_of


def _borders(run: Trajectory) -> tuple[Array, Array, Array]:
    """Times between which energy is balanced, with x and v there: the strobe points and the end."""
    ends = run.pieces.t[[0, -1]]
    if run.model.period is None:
        x, v, _ = run._states_at(ends, np.array([0, len(run.pieces.mode) - 1]))
        return ends, x, v
    t, x, v = run.strobe_times, run.strobe_x, run.strobe_v
    if ends[1] - t[-1] <= 1e-9 * run.period_time:
        return t, x, v
    last = run._states_at(ends[1:], np.array([len(run.pieces.mode) - 1]))
    return np.append(t, ends[1]), np.append(x, last[0], axis=0), np.append(v, last[1], axis=0)


def _cut(run: Trajectory, borders: Array) -> tuple[Array, Array, Array]:
    """The pieces cut at the borders: their ends, their numbers, and the row that each belongs to."""
    edges = np.unique(np.concatenate([run.pieces.nodes, borders]))
    middle = 0.5 * (edges[1:] + edges[:-1])
    owner = np.searchsorted(borders, middle, side="right") - 1
    return edges, run._index(middle), np.minimum(owner, len(borders) - 2)


def _rows(run: Trajectory, borders: Array) -> Array:
    """The row of each impulse: on a border it belongs to what ends there."""
    times = np.array([t for t, _ in run._columns.impulses])
    slack = 1e-9 * run.period_time if len(times) else 0.0
    return np.clip(np.searchsorted(borders, times - slack, side="right") - 1, 0, len(borders) - 2)


def _row_of_hit(run: Trajectory, borders: Array, when: float) -> int:
    """The row of a hit: one at a known instant comes with it, so on a border it belongs to what ends there."""
    slack = 0.0 if run.model.period is None else 1e-9 * run.period_time
    known = any(abs(when - t) <= slack for t, _ in run._columns.impulses)
    return int(np.clip(np.searchsorted(borders, when - (slack if known else 0.0), side="right") - 1, 0, len(borders) - 2))


def _powers(run: Trajectory, t: Array, index: Array) -> dict[str, Array]:
    """Power of each force [W]."""
    x, v, z = run._states_at(t, index)
    return machine_of(run.model).mechanics.powers(run._columns.within(t, index), x, v, z, run._columns.forces_at(t, index, x, v, z))


def _add_impulse(run: Trajectory, works: dict[str, Array], t: float, jump: Any, row: int) -> None:
    """Work of an impulse: what the kinetic energy gains; that of an actuator is its force on the mass that it throws."""
    machine = machine_of(run.model)
    if machine.mechanics.stops and not np.any(jump):  # a body that is hit there is thrown by its stop
        return
    before, after = (int(run._index(t + d * run.period_time)) for d in (-1e-12, 1e-12))
    x, v = (of[0] for of in run._states_at(np.array([min(t, run.pieces.t[before + 1])]), np.array([before]))[:2])
    later = run._states_at(np.array([t]), np.array([after]))[1][0] if after > before else v + jump
    works["drive"][row] += float(machine.mechanics.kinetic(later, x) - machine.mechanics.kinetic(v, x))
    moment = 1e-12 * run.period_time
    for mass, drive in machine.inner_masses:  # each is thrown by its own jump and by the body's
        xi_rate, thrown = drive.velocity(t - moment), drive.velocity(t + moment)
        works["actuator"][row] += mass * (jump + thrown - xi_rate) * 0.5 * (xi_rate + thrown)


def _residual(run: Trajectory, works: dict[str, Array], gross: list[Array], low: Array, high: Array) -> Array:
    """Relative error of the energy balance; `low` and `high` are the extremes of the kinetic energy in each row."""
    missing = works["drive"] + works["gravity"] - works["friction"] - works["damping"] - works["kinetic"] - works["potential"]
    count, settle = len(missing), min(int(run.settle), len(missing))
    exchanged = np.max([*gross, high - np.minimum(low, high)], axis=0)
    largest = exchanged.max(initial=0.0)
    scale = np.where(np.arange(count) < settle, largest, exchanged[settle:].max(initial=0.0))
    floor = max(_FLOOR, float(run.rtol)) * max(largest, high.max(initial=0.0))
    nothing = (missing == 0) | (np.maximum(scale, floor) <= _of_rounding(run))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(nothing, 0.0, missing / np.maximum(scale, floor))


def _of_rounding(run: Trajectory) -> float:
    """What rounding of the forces that hold a machine at rest may make of its energy by the end of a run [J]."""
    mechanics, machine = machine_of(run.model).mechanics, machine_of(run.model)
    x, span = run._states_at(run.pieces.t[:1], np.zeros(1, int))[0], float(run.pieces.t[-1])
    at_speed = mechanics.kinetic(np.full(x.shape, float(machine.velocity_scale)), x)
    return float(64 * np.finfo(float).eps * np.max(at_speed) * max(1.0, span / float(machine.time_scale or 1.0)) ** 2)
