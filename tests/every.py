"""Every sort of machine, and every door it may be brought to: the table of the docs' page "Which machine" comes from here."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

import stickslip as ss
from stickslip.basics.fields import leaves
from stickslip.maths import cos, pi, sin
from stickslip.models.machine_adapter import machine_of
from stickslip.models.switching_flow import is_flow
from stickslip.solvers.simulation import Simulation

SHAKEN = ss.Robot(
    body_mass=0.06259, inner_mass=0.00948, drive=ss.Harmonic(amplitude=6e-4, omega=65.4 * np.pi), friction=ss.Coulomb(0.15, 0.21)
)  # fmt: skip
CAPSUBOT = ss.Robot(
    body_mass=0.193, inner_mass=0.074, friction=ss.Coulomb(0.25, 0.3),
    drive=ss.machines.Forced(ss.HarmonicForce(1.5, omega=104.7), stiffness=250.0, damping=0.5),
)  # fmt: skip
JOINT = ss.Joint(
    inertia=0.01, friction=ss.Coulomb(0.02, 0.02), gravity_torque=0.05,
    control=ss.machines.PID(kp=2.0, ki=4.0, kd=0.1, target=ss.Harmonic(amplitude=0.3, frequency=0.5), sample=0.05),
)  # fmt: skip
SERVO = ss.Joint(
    inertia=0.02, friction=ss.Coulomb(1.0, 1.0), gravity_torque=0.5, delay=0.1, motor=ss.machines.Motor(1.5, resistance=5.0, supply=12.0),
    load=ss.machines.ServoLoad(base=0.05, viscous=0.02, motor=0.1, external=0.1),
    control=ss.machines.PID(kp=12.0, ki=8.0, kd=0.0, target=ss.Harmonic(amplitude=0.3, frequency=0.5), sample=0.05),
)  # fmt: skip
DRY, STICTION = ss.Coulomb(mu_plus=0.2, mu_minus=0.3), ss.Coulomb(mu_plus=0.2, mu_minus=0.2, f_plus=0.3, f_minus=0.3)


@dataclass(frozen=True, eq=False)
class Capsule(ss.Machine):
    """A hammer on a spring inside a capsule, with an elastic stop."""

    stiffness: float
    friction: Any
    gap: float = 0.002
    wall: float = 2e4
    omega: float = 100.0

    @property
    def period(self):
        return 2 * pi / self.omega

    def bodies(self):
        def push(sign):
            return lambda t, x, v: sign * 0.8 * sin(self.omega * t)

        return {"capsule": ss.Body(0.1, force=push(-1.0)), "hammer": ss.Body(0.05, force=push(1.0))}

    def contacts(self):
        return {"capsule": ss.Contact("capsule", self.friction, load=1.5)}

    def links(self):
        return {("hammer", "capsule"): ss.Spring(self.stiffness, damping=0.05)}

    def stops(self):
        return {("hammer", "capsule"): ss.Stop(gap=self.gap, stiffness=self.wall, damping=1.0)}


@dataclass(frozen=True, eq=False)
class Tow(ss.Machine):
    """The machine of the page on machines of one's own: a shaken head that tows a sledge."""

    head: float
    sledge: float
    push: float
    omega: float
    stiffness: float
    damping: float
    friction: Any
    gravity: float = 9.81

    @property
    def period(self):
        return 2 * pi / self.omega

    def bodies(self):
        shaken = ss.Body(self.head, force=lambda t, x, v: self.push * sin(self.omega * t))
        return {"head": shaken, "sledge": ss.Body(self.sledge)}

    def contacts(self):
        return {name: ss.Contact(name, self.friction) for name in ("head", "sledge")}

    def links(self):
        return {("head", "sledge"): ss.Spring(self.stiffness, self.damping)}


@dataclass(frozen=True, eq=False)
class Hammer(ss.Machine):
    """Nothing rubs: a shaken mass drives another one through a spring, and that one hits a wall."""

    stiffness: float
    omega: float = 2.0
    gap: float = 0.5

    @property
    def period(self):
        return 2 * pi / self.omega

    def bodies(self):
        shaken = ss.Body(1.0, force=lambda t, x, v: sin(self.omega * t) - 0.3 * v - 4.0 * x)
        return {"shaker": shaken, "hammer": ss.Body(0.3, force=lambda t, x, v: -0.2 * v)}

    def links(self):
        return {("shaker", "hammer"): ss.Spring(self.stiffness, damping=0.1)}

    def stops(self):
        return {("hammer", None): ss.Stop(gap=self.gap, restitution=0.6)}


@dataclass(frozen=True, eq=False)
class Beam(ss.Machine):
    """A shaken beam by its first two modes, which rubs at one point of it."""

    place: float
    push: float
    friction: Any
    omega: float = 50.0

    @property
    def period(self):
        return 2 * pi / self.omega

    def bodies(self):
        def push(shape):
            return lambda t, x, v: shape * self.push * sin(self.omega * t)

        return {"bending": ss.Body(0.02, force=push(1.0)), "second": ss.Body(0.02, force=push(-0.6))}

    def links(self):
        return {("bending", None): ss.Spring(80.0, damping=0.05), ("second", None): ss.Spring(600.0, damping=0.1)}

    def contacts(self):
        return {"pad": ss.Contact({"bending": sin(pi * self.place), "second": sin(2 * pi * self.place)}, self.friction, load=0.4)}


def den_hartog(F, r=0.7):
    """x'' + x + F sgn x' = cos(r t), with rest."""
    offered = lambda t, y: -y[0] + cos(r * t)  # noqa: E731
    slide = lambda side: lambda t, y: (y[1], offered(t, y) - side * F)  # noqa: E731
    after = lambda t, y: 1 if offered(t, y) > F else -1 if offered(t, y) < -F else 0  # noqa: E731
    stop = lambda t, y: (y[0], 0.0)  # noqa: E731
    switches = {
        1: (ss.Switch(lambda t, y: y[1], after, stop),),
        -1: (ss.Switch(lambda t, y: -y[1], after, stop),),
        0: (ss.Switch(lambda t, y: F - offered(t, y), 1), ss.Switch(lambda t, y: F + offered(t, y), -1)),
    }
    return ss.SwitchingFlow({1: slide(1), -1: slide(-1), 0: lambda t, y: (0.0 * y[0], 0.0)}, switches, 2 * pi / r)


def _den_hartog():
    """The same with its numbers by name."""
    offered = lambda t, y, n: -y[0] + cos(n.r * t)  # noqa: E731
    slide = lambda side: lambda t, y, n: (y[1], offered(t, y, n) - side * n.F)  # noqa: E731
    after = lambda t, y, n: 1 if offered(t, y, n) > n.F else -1 if offered(t, y, n) < -n.F else 0  # noqa: E731
    stop = lambda t, y, n: (y[0], 0.0)  # noqa: E731
    switches = {
        1: (ss.Switch(lambda t, y, n: y[1], after, stop),),
        -1: (ss.Switch(lambda t, y, n: -y[1], after, stop),),
        0: (ss.Switch(lambda t, y, n: n.F - offered(t, y, n), 1), ss.Switch(lambda t, y, n: n.F + offered(t, y, n), -1)),
    }
    fields = {1: slide(1), -1: slide(-1), 0: lambda t, y, n: (0.0 * y[0], 0.0)}
    return ss.SwitchingFlow(fields, switches, lambda n: 2 * pi / n.r, numbers={"F": 0.3, "r": 0.7}, states=("x", "v"))


DEN_HARTOG = _den_hartog()


def _van_der_pol():
    """Van der Pol's oscillator with a stop on one side."""
    swing = lambda t, y, n: (y[1], n.mu * (1 - y[0] ** 2) * y[1] - y[0])  # noqa: E731
    hit = ss.Switch(lambda t, y, n: n.gap - y[0], 0, lambda t, y, n: (n.gap, -n.r * y[1]))
    return ss.SwitchingFlow({0: swing}, {0: (hit,)}, None, {"mu": 1.0, "gap": 1.2, "r": 0.6}, ("x", "v"))


def _hunted():
    """Prey that saturates, and a predator that is hunted while there are many of it: a Filippov flow that slides along the limit."""
    gain = lambda y: y[0] / (1 + 0.5 * y[0]) - 0.3  # noqa: E731
    prey = lambda y, n, eaten: y[0] * (1 - y[0] / n.k) - eaten * y[0] / (1 + 0.5 * y[0])  # noqa: E731
    after = lambda t, y, n: "hunted" if gain(y) > n.effort else "slides" if gain(y) > 0 else "free"  # noqa: E731
    stay = lambda t, y, n: (y[0], n.limit)  # noqa: E731
    return ss.SwitchingFlow(
        {
            "free": lambda t, y, n: (prey(y, n, y[1]), y[1] * gain(y)),
            "hunted": lambda t, y, n: (prey(y, n, y[1]), y[1] * (gain(y) - n.effort)),
            "slides": lambda t, y, n: (prey(y, n, n.limit), 0.0 * y[1]),
        },
        {
            "free": (ss.Switch(lambda t, y, n: n.limit - y[1], after, stay),),
            "hunted": (ss.Switch(lambda t, y, n: y[1] - n.limit, after, stay),),
            "slides": (ss.Switch(lambda t, y, n: gain(y), "free"), ss.Switch(lambda t, y, n: n.effort - gain(y), "hunted")),
        },
        None, {"k": 6.0, "effort": 0.35, "limit": 0.9}, ("prey", "predator"),
    )  # fmt: skip


def _belt_by_hand():
    """A block on a belt as a flow with a contact."""
    law = ss.Stribeck(0.2, 0.2, 0.3, 0.3, v_s=0.1, exponent=1.0)
    contact = ss.machines.FlowContact(slip=lambda t, y, n: y[1] - n.speed, friction=law, load=9.81)
    field = lambda t, y, R, n: (y[1], -n.k * y[0] - R.belt)  # noqa: E731
    return ss.SwitchingFlow(field, numbers={"speed": 0.1, "k": 4.0}, states=("x", "v"), contacts={"belt": contact})


def _chain(module):
    return ss.Chain((module, module), link=ss.Spring(stiffness=1200.0, damping=0.4), phases=(0.0, 1.57))


#: What stands in the rows of the table: a machine, and the name of a number of it with two values.
every_machine: dict[str, tuple[Any, str, tuple[float, float]]] = {
    "Robot": (SHAKEN, "drive.amplitude", (5e-4, 6e-4)),
    "PulledMass": (ss.PulledMass(1.0, 2.0, 0.1, STICTION, load=1.0), "speed", (0.1, 0.15)),
    "BlockOnBelt": (ss.BlockOnBelt(1.0, 2.0, 0.1, STICTION, load=1.0), "speed", (0.1, 0.15)),
    "ForcedOscillator": (ss.ForcedOscillator(1.0, 1.0, 1.0, 0.7, DRY, damping=0.01), "omega", (0.6, 0.7)),
    "Robot, inner mass driven by force": (CAPSUBOT, "drive.stiffness", (250.0, 260.0)),
    "Chain, set-valued laws": (_chain(SHAKEN), "phases.1", (0.5, 1.57)),
    "Chain, LuGre": (_chain(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4)), "link.stiffness", (500.0, 1200.0)),
    "capsule with an elastic stop": (Capsule(300.0, DRY), "stiffness", (280.0, 300.0)),
    "Joint": (JOINT, "control.kp", (1.5, 2.0)),
    "Joint, motor and friction of its torque": (SERVO, "motor.k_t", (1.4, 1.5)),
    "MovingTrack": (ss.presets.conveyor(throw_index=2.5), "along.amplitude", (4e-4, 4.3e-4)),
    "a machine of your own": (Tow(0.07, 0.03, 0.3, 205.0, 300.0, 0.1, DRY), "stiffness", (250.0, 300.0)),
    "a machine without contacts": (Hammer(5.0), "stiffness", (4.9, 5.0)),
    "a machine by its modes": (Beam(0.3, 0.5, DRY), "place", (0.3, 0.35)),
    "cart and pole": (ss.presets.cart_pole(), "length", (0.48, 0.5)),
    "a box that hops": (ss.presets.hopping_robot(), "unbalance", (1.6e-4, 1.65e-4)),
    "a SwitchingFlow": (DEN_HARTOG, "F", (0.3, 0.4)),
    "a flow without a period": (_van_der_pol(), "mu", (1.0, 1.1)),
    "a Filippov flow": (_hunted(), "k", (6.0, 6.2)),
    "a flow with contacts": (_belt_by_hand(), "speed", (0.1, 0.12)),
}
#: More machines whose bodies move in the plane, which go through the doors with the slow tests.
in_the_plane: dict[str, tuple[Any, str, tuple[float, float]]] = {
    "BristleBot": (ss.presets.bristle_bot(), "unbalance", (1e-6, 1.1e-6)),
    "BlockOnWedge": (ss.presets.block_on_wedge(), "slope", (0.35, 0.36)),
    "SlidingRod": (ss.presets.sliding_rod(mu=0.3, push=3.0), "length", (0.9, 1.0)),
    "TwoLinkArm": (ss.presets.two_link_arm(), "length", (0.45, 0.46)),
    "ModeCoupling": (ss.presets.mode_coupling(), "preload", (9.0, 10.0)),
}
all_machines = every_machine | in_the_plane
#: Those that have bodies: all but the flows.
with_bodies = {name: made for name, made in every_machine.items() if not is_flow(made[0])}
OWN = (Capsule, Tow, Hammer, Beam)


def without_line(made):
    """A sentence where `every_machine` has no machine of a class."""
    line = f'"{made.__name__}": ({made.__name__}(...), "name of a number of it", (one value, another)),'
    found = any(isinstance(machine, made) for machine, *_ in all_machines.values())
    return [] if found else [f"{made.__name__}: add a line to every_machine in tests/every.py: {line}"]


def wrong_line(name, line):
    """A sentence where a line of `every_machine` is not a machine, the name of a number of it and two values of that."""
    try:
        machine, number, (one, another) = line
        machine.replace({number: one}), machine.replace({number: another})
    except (AttributeError, TypeError, ValueError) as error:
        return [f"{name!r} in every_machine in tests/every.py: allowed is (machine, name of a number of it, (one value, another)): {error}"]
    return []


def not_on_page(name, kept):
    """A sentence where the table of notes/which-machine.md has no column of a machine."""
    told = f'{name!r}: notes/which-machine.md has no column of it; type python docs/_ext/which_machine.py "{name}"'
    return [] if any(machine == name for machine, _ in kept) else [told]


@dataclass(frozen=True)
class Case:
    """One machine at the doors: what they are called with is made here once."""

    name: str
    machine: Any
    number: str
    values: tuple[float, float]
    folder: Path

    @property
    def length(self):
        return {"duration": 4.0} if self.machine.period is None else {"periods": 12}

    @property
    def several(self):
        return not machine_of(self.machine).is_single

    @property
    def axes(self):
        """Whether columns have an axis for bodies and contacts."""
        return "body" in machine_of(self.machine).part_names

    @property
    def rubs(self):
        """Whether it has contacts."""
        return bool(self.parts.contacts)

    @property
    def parts(self):
        return machine_of(self.machine).mechanics

    @property
    def axis(self):
        return {self.number: list(self.values)}

    @property
    def other(self):
        """Another number, for a map."""
        names = {
            "modules.0.inner_mass": [0.009, 0.0095],
            "friction.mu_plus": [0.2, 0.25],
            "r": [0.7, 0.8],
            "gap": [0.45, 0.5],
            "tilt": [0.4, 0.41],
            "shoulder_torque": [24.0, 25.0],
            "effort": [0.3, 0.35],
        }
        names |= {"k": [4.0, 4.5]}
        known = dict(leaves(self.machine))
        return next({name: values} for name, values in names.items() if name in known)

    @cached_property
    def run(self):
        return ss.solve(self.machine, **self.length)

    @cached_property
    def branch(self):
        low, high = self.values
        return ss.continuation(self.machine, parameter=self.number, start=low, stop=low + 0.05 * (high - low))

    @cached_property
    def diagram(self):
        return ss.bifurcation(self.machine, parameter=self.number, values=list(self.values), settle=20, points=2, follow=False)


# ---- doors: each looks at what it got, so that a silent answer of the first body is none ----
def _solve(c):
    run = c.run
    assert run.status == "finished" and np.isfinite(ss.mean_velocity(run))
    bodies = (len(c.parts.placed) if c.parts.joined else len(c.parts.bodies)) if c.several else 1
    assert run.x.shape == ((len(run.t), 2) if c.axes else (len(run.t),)) and len(run.bodies) == bodies


def _simulation(c):
    sim, (number, (_, last)) = ss.simulation(c.machine), (c.number, c.values)
    sim.step(0.3)
    sim.step(0.2, inputs={number: last})
    again = Simulation.load(sim.save(c.folder / "sim.json"), machine=c.machine)
    assert sim.status == "finished" and sim.inputs[number] == last and str(again.step(0.1)) == str(sim.step(0.1))


def _batch(c):
    many = ss.solve(c.machine.replace({c.number: np.array(c.values)}), keep="summary", **c.length)
    alone = ss.solve(c.machine.replace({c.number: c.values[1]}), **c.length)
    assert np.isclose(many.mean_velocity[1], ss.mean_velocity(alone), rtol=1e-6, atol=1e-9)


def _sweep(c):
    grid = ss.sweep(c.machine, **c.axis, **c.length)
    assert grid.mean_velocity.dims == (c.number,) and np.isfinite(grid.mean_velocity.values).all()
    parts = [dim for dim in ("body", "contact") if dim in grid.dims]
    assert parts == (["body", "contact"][: 1 + c.rubs] if c.axes else [])
    assert grid.velocity_max.dims[1:] == tuple(parts[:1])
    assert not c.rubs or grid.motion_type.dims[1:] == tuple(parts[1:])
    assert np.isfinite(grid.velocity_max.values).all()


def _map(c):
    grid = ss.map(c.machine, **c.axis, **c.other, **c.length)
    assert grid.mean_velocity.shape == (2, 2)


def _velocity_map(c):
    assert ss.plot.velocity_map(ss.map(c.machine, **c.axis, **c.other, **c.length)).get_xlabel()


def _study(c):
    grid = ss.sweep(c.machine, **c.axis, **c.length, out=c.folder / "study")
    again = ss.open_study(c.folder / "study")
    assert np.array_equal(again.mean_velocity.values, grid.mean_velocity.values)


def _motion(c):
    m = ss.motion(c.run)
    if is_flow(c.machine):
        assert set(m.ranges) == set(c.machine.states) and abs(sum(m.modes.values()) - 1.0) < 1e-9
        return
    if c.machine.period is None:
        assert set(m.contacts) == set(c.run.contacts) and m.type in ("stick-slip", "slip", "steady", "not settled")
        return
    if c.several:
        assert set(m.contacts) == set(c.parts.contacts) and set(m.anchored) <= set(m.contacts)
    if not c.axes:
        assert m.type in ("rest", "presliding", "I", "II", "III", "IV", "other")


def _energy(c):
    balance = ss.energy(ss.solve(c.machine, **c.length, rtol=1e-9))
    assert balance.worst < 1e-6
    assert (balance.friction if c.rubs else balance.damping)[-1] > 0, "in its last period it rests"


def _check(c):
    length = {"periods": 1} if c.machine.period is not None else c.length
    assert ss.check(c.machine, **length, rk4_steps=()).digits >= 2


def _periodic_mean_velocity(c):
    assert np.isfinite(ss.analysis.periodic_mean_velocity(c.machine, periods=400))


def _orbit(c):
    orbit = ss.periodic_orbit(c.machine)
    assert len(np.atleast_1d(orbit.multipliers)) > 0


def _lyapunov(c):
    assert ss.lyapunov(c.machine, periods=50).spectrum is not None


def _continuation(c):
    assert len(c.branch.orbits) > 1


def _branch_drawn(c):
    """By each coordinate of its state, by mean velocity and multiplier, and over a diagram where there is one."""
    branch = c.branch
    known = [name for name in (*branch.orbits[0].names, "mean_velocity", "largest_multiplier") if name in branch.points]
    assert len(known) > 1 and all(ss.plot.continuation(branch, name).get_ylabel() for name in known)
    over = None if branch.orbits[0].model.period is None else c.diagram
    assert ss.plot.continuation(branch, diagram=over).get_xlabel()


def _basins(c):
    of = "v" if machine_of(c.machine).is_single else f"v.{machine_of(c.machine).mechanics.bodies[0]}"
    assert ss.basins(c.machine, **{of: [0.0, 0.05]}, settle=40).attractors


def _attractors(c):
    of = "v" if machine_of(c.machine).is_single else f"v.{machine_of(c.machine).mechanics.bodies[0]}"
    along = ss.attractors(c.machine, parameter=c.number, values=list(c.values), starts={of: [0.0, 0.05]}, settle=40)
    assert (along.share.sum("attractor") > 0.4).all() and all(map(str, along.ends.values))


def _edge_state(c, starts=(None, None)):
    """There is one motion: an edge is refused with its name."""
    try:
        edge = ss.dynamics.edge_state(c.machine, *starts, settle=60 if is_flow(c.machine) else 30)
    except ss.InputError as error:
        if "both starts lead to one motion" not in str(error):
            raise
    else:
        raise AssertionError(edge)


def _bifurcation(c):
    assert c.diagram.sizes[c.number] == 2


def _diagram_drawn(c):
    grid = c.diagram
    first = next(iter(grid.data_vars))
    assert ss.plot.bifurcation(grid).get_ylabel() == ss.plot.bifurcation(grid, first).get_ylabel()


def _toml(c):
    assert type(c.machine).from_toml(c.machine.to_toml()) == c.machine


def _save(c):
    run = c.run
    again = ss.load(run.save(c.folder / "run.nc"), machines=OWN)
    assert again.model == c.machine and np.array_equal(again.v, run.v) and np.array_equal(again.friction_force, run.friction_force)


def _xarray(c):
    data = c.run.to_xarray()
    assert ("body" in data.v.dims) == c.axes and "friction_force" in data


def _csv(c):
    run = c.run
    head = Path(run.save(c.folder / "run.csv")).read_text(encoding="utf-8").partition("\n")[0]
    assert head.count("v.") == (len(run.body_columns) if c.axes else 0)


def _report(c):
    from stickslip.show.reports import run_page

    assert "<h1>It moves</h1>" in run_page(c.run, "It moves")


def _velocity(c):
    lines = [line for line in ss.plot.velocity(c.run).lines if len(line.get_xdata()) > 2]
    assert len([line for line in lines if "rests" not in line.get_label()]) == (len(c.parts.bodies) if c.several else 1)


def _forces(c):
    run = c.run
    labels = [line.get_label() for line in ss.plot.forces(run).lines]
    named = all(name in labels for name in run.contacts)
    assert named if c.several else any("friction force" in label for label in labels)


def _phase(c):
    assert ss.plot.phase(c.run).get_ylabel().startswith("velocity")


def _contacts(c):
    run = c.run
    ax = ss.plot.contacts(run)
    assert [label.get_text() for label in ax.get_yticklabels()][: len(run.contacts)] == list(run.contacts)
    assert ax.collections if c.rubs else ax.lines


def _strobe(c):
    assert len(ss.dynamics.strobe(c.run).v)


def _spectrum(c):
    run = c.run if c.machine.period is not None else ss.solve(c.machine, duration=60.0)
    lines = ss.dynamics.spectrum(run)
    assert lines.amplitude.dims == (("body", "order") if c.axes else ("order",))
    last = ss.dynamics.spectrum(run, body=len(run.body_columns) - 1 if c.axes else 0)
    assert np.array_equal(last.amplitude, lines.amplitude.isel(body=-1) if c.axes else lines.amplitude)
    assert ss.plot.spectrum(last).get_xlabel()


def _latex(c):
    assert r"\begin{aligned}" in ss.latex(c.machine)


def _mirrored(c):
    run, image = c.run, ss.solve(ss.dynamics.mirrored(c.machine), **c.length)
    end = run.pieces.t[-1]
    there = image.at(end)["v"]
    assert np.allclose(there[::-1] if isinstance(c.machine, ss.Chain) else there, -run.at(end)["v"], rtol=1e-6, atol=1e-9)
    assert np.isclose(ss.mean_velocity(image), -ss.mean_velocity(run), rtol=1e-9)
    assert ss.dynamics.mirrored(ss.dynamics.mirrored(c.machine)) == c.machine


def _explorer(c):
    from stickslip.show.explorer.machines import Shown, picture

    found = picture(Shown(c.machine, options=c.length), True, c.machine, lambda done, whole: None)
    assert [body["name"] for body in found["picture"]["bodies"] if body["v"]] == list(c.run.body_columns)
    assert [row["name"] for row in found["picture"]["rows"]][: len(c.run.contacts)] == list(c.run.contacts) and found["facts"]


def _command(c):
    """`stickslip run` of a study file; of a machine of one's own the file names a function."""
    import contextlib
    import io

    from stickslip.show.cli import main

    how = "\n".join(f"{name} = {value}" for name, value in c.length.items())
    own = isinstance(c.machine, OWN)
    (c.folder / "mine_of_every.py").write_text(f"from every import all_machines\n\ndef rig():\n    return all_machines[{c.name!r}][0]\n")
    text = 'make = "mine_of_every.py:rig"\n' if own else c.machine.to_toml()
    (c.folder / "study.toml").write_text(f"{text}\n[solve]\n{how}\n", encoding="utf-8")
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        assert main(["run", str(c.folder / "study.toml"), *(["--allow-code"] if own else [])]) == 0
    assert "mean velocity" in out.getvalue() and (not c.several or all(name in out.getvalue() for name in c.parts.bodies))


#: Doors by what a user types.
every_door = {
    "ss.solve": _solve, "ss.simulation": _simulation,
    "a batch": _batch, "ss.sweep": _sweep, "ss.map": _map, "plot.velocity_map": _velocity_map, "a study folder": _study,
    "ss.motion": _motion, "ss.energy": _energy, "ss.check": _check, "ss.analysis.periodic_mean_velocity": _periodic_mean_velocity,
    "ss.periodic_orbit": _orbit,
    "ss.continuation": _continuation, "ss.lyapunov": _lyapunov, "ss.basins": _basins, "ss.attractors": _attractors,
    "ss.dynamics.edge_state": _edge_state, "ss.bifurcation": _bifurcation, "plot.continuation": _branch_drawn,
    "plot.bifurcation": _diagram_drawn,
    "to_toml, from_toml": _toml, "run.save, ss.load": _save, "run.to_xarray": _xarray,
    "CSV": _csv, "report": _report, "plot.velocity": _velocity,
    "plot.forces": _forces, "plot.phase": _phase, "plot.contacts": _contacts, "ss.dynamics.strobe": _strobe,
    "ss.dynamics.spectrum": _spectrum, "ss.latex": _latex,
    "ss.dynamics.mirrored": _mirrored, "explorer": _explorer, "stickslip run": _command,
}  # fmt: skip


# ---- the same doors for a flow, whose runs have its own states and no bodies ----
def _solve_flow(c):
    run = c.run
    assert run.status == "finished" and run.y.shape == (len(run.t), 2) and run.method == "exact"


def _batch_of_flow(c):
    many = ss.solve(c.machine.replace({c.number: np.array(c.values)}), keep="summary", **c.length)
    alone = ss.solve(c.machine.replace({c.number: c.values[1]}), **c.length)
    assert np.isclose(many.columns[f"end_{c.machine.states[0]}"][1], alone.state[0], rtol=1e-9, atol=1e-9)


def _sweep_of_flow(c):
    grid = ss.sweep(c.machine, **c.axis, **c.length)
    first, second = c.machine.states
    assert grid[f"mean_{first}"].dims == (c.number,) and np.isfinite(grid[f"max_{second}"].values).all() and "motion_type" not in grid


def _map_of_flow(c):
    assert ss.map(c.machine, **c.axis, **c.other, **c.length)[f"max_{c.machine.states[0]}"].shape == (2, 2)


def _basins_of_flow(c):
    assert ss.basins(c.machine, **{c.machine.states[0]: [0.0, 0.5]}, settle=40).attractors


def _attractors_of_flow(c):
    first = c.machine.states[0]
    along = ss.attractors(c.machine, parameter=c.number, values=list(c.values), starts={first: [0.0, 0.5]}, settle=40)
    assert along[first].shape[1] == 2 and "mean_velocity" not in along


def _xarray_of_flow(c):
    assert {*c.machine.states, "mode"} <= set(c.run.to_xarray())


def _csv_of_flow(c):
    head = Path(c.run.save(c.folder / "run.csv")).read_text(encoding="utf-8").partition("\n")[0].split(",")
    assert head[: 1 + len(c.machine.states)] == ["time", *c.machine.states] and head[-1] == "mode"


def _edge_state_of_flow(c):
    _edge_state(c, [{c.machine.states[0]: value} for value in (0.5, 1.0)])


def _phase_of_flow(c):
    assert ss.plot.phase(c.run).get_ylabel() == c.machine.states[1]


def _energy_of_flow(c):
    """What friction takes is what the law gives on samples of the run, by the trapezoidal rule."""
    run = ss.solve(c.machine, **(c.length if c.machine.period is not None else {"duration": 40.0}))
    name = next(iter(run.contacts), "")
    taken, t = ss.energy(run).friction_of[name][0], np.linspace(*run.nodes[[0, -1]], 400_001)
    at = run.at(t)
    samples = np.trapezoid(at[f"friction_force_{name}"] * at[f"slip_{name}"], t)
    assert abs(taken / samples - 1.0) < 1e-5  # the forces have corners and jumps at the switches


def _check_of_flow(c):
    length = {"periods": 2} if c.machine.period is not None else c.length
    sure = ss.check(c.machine, **length)
    assert sure.digits >= 9 and len(sure.judges) == 3


def _save_of_flow(c):
    run = c.run
    again = ss.load(run.save(c.folder / "run.nc"), machines=[c.machine.replace({c.number: c.values[1]})])
    assert again.model.numbers == c.machine.numbers and np.array_equal(again.y, run.y) and again.events == run.events


def _contacts_of_flow(c):
    ax = ss.plot.contacts(c.run)
    assert [label.get_text() for label in ax.get_yticklabels()] == list(c.machine.contacts) and ax.collections


def _forces_of_flow(c):
    assert ss.plot.forces(c.run).get_ylabel() == "friction force $R$"


def _strobe_of_flow(c):
    run = c.run
    points = ss.dynamics.strobe(run, settle=0)
    assert np.array_equal(points[c.machine.states[0]], run.strobe[:-1, 0])


def _spectrum_of_flow(c):
    """The mean is that of the cycle."""
    run = c.run if c.machine.period is not None else ss.solve(c.machine, duration=200.0, start=START_OF.get(c.name))
    lines = ss.dynamics.spectrum(run)
    assert lines.amplitude.dims == ("order",) and len(lines.order) > 40 and ss.plot.spectrum(lines).get_xlabel()


#: Where flows begin that would rest at zero.
START_OF = {"a flow without a period": {"x": 0.5}, "a Filippov flow": {"prey": 1.0, "predator": 0.5}}


def _command_of_flow(c):
    import contextlib
    import io

    from stickslip.show.cli import main

    (c.folder / "flow_of_every.py").write_text(f"from every import all_machines\n\ndef flow():\n    return all_machines[{c.name!r}][0]\n")
    how = "\n".join(f"{name} = {value}" for name, value in c.length.items())
    (c.folder / "flow.toml").write_text(f'make = "flow_of_every.py:flow"\n\n[solve]\n{how}\n', encoding="utf-8")
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        assert main(["run", str(c.folder / "flow.toml"), "--allow-code", "--figure", str(c.folder / "flow.png")]) == 0
    assert all(name in out.getvalue() for name in ("motion", "modes", *c.machine.states))


def _velocity_map_of_flow(c):
    ax = ss.plot.velocity_map(ss.map(c.machine, **c.axis, **c.other, **c.length), quantity=f"max_{c.machine.states[0]}")
    assert ax.get_xlabel() and ax.figure.axes[-1].get_ylabel().startswith(f"max {c.machine.states[0]}")


def _study_of_flow(c):
    first = f"mean_{c.machine.states[0]}"
    grid = ss.sweep(c.machine, **c.axis, **c.length, out=c.folder / "study")
    again, plain = ss.open_study(c.folder / "study"), ss.sweep(c.machine, **c.axis, **c.length)
    assert np.array_equal(again[first].values, grid[first].values) and np.array_equal(plain[first].values, grid[first].values)


_OF_FLOW = {
    "a study folder": _study_of_flow,
    "plot.velocity_map": _velocity_map_of_flow,
    "ss.energy": _energy_of_flow, "ss.check": _check_of_flow, "run.save, ss.load": _save_of_flow, "plot.contacts": _contacts_of_flow,
    "plot.forces": _forces_of_flow, "ss.dynamics.strobe": _strobe_of_flow, "ss.dynamics.spectrum": _spectrum_of_flow,
    "stickslip run": _command_of_flow,
    "ss.solve": _solve_flow, "a batch": _batch_of_flow, "ss.sweep": _sweep_of_flow, "ss.map": _map_of_flow, "ss.basins": _basins_of_flow,
    "ss.attractors": _attractors_of_flow, "ss.dynamics.edge_state": _edge_state_of_flow,
    "run.to_xarray": _xarray_of_flow, "CSV": _csv_of_flow, "plot.phase": _phase_of_flow,
}  # fmt: skip


def door_of(door, case):
    """What tries a door for a machine, or for a flow."""
    return _OF_FLOW.get(door, every_door[door]) if is_flow(case.machine) else every_door[door]


#: Results that have no `plot()`, and why.
without_picture = {
    "Certificate": "a proof about one motion: its periodic orbit draws itself",
    "Hops": "four numbers of a run: ss.plot.contacts draws the run",
    "Passage": "the two ends of a stretch: the run of the flow draws itself",
    "Gradient": "derivatives in different units; ss.dynamics.sensitivity(...).plot() draws relative ones",
    "ZeroOne": "one number of a series: ss.plot.phase draws the run that it comes from",
    "Rotation": "one number of a motion: ss.plot.phase draws the run that it comes from",
    "AtlasTime": "an estimate in seconds: its atlas draws itself",
    "Derived": "an axis of a sweep, no result",
    "BorderPiece": "a line of a map: ss.plot.motion_map draws the borders on the map",
    "Waveform": "what is to be searched, no result",
    "Observable": "a column to be, no result",
    "ExportedLaw": "source text",
    "DimensionlessRobot": "a machine",
    "SwitchingFlow": "a machine",
    "Simulation": "a machine at an instant: the trajectories that it recorded draw themselves",
}
