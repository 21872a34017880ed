"""What plain Python may do that a trace freezes or ignores: it is solved as scipy solves it with floats, or refused with what to type."""

import dataclasses
import functools
import itertools
import math
import random
import time
from typing import Any, ClassVar

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stickslip as ss
from rows import each_row
from stickslip.maths import cos, maximum, pi, sin, sqrt, where
from stickslip.models.tables import to_toml

record = dataclasses.dataclass(frozen=True, eq=False)
START = {"x": {"block": 0.3}, "v": {"block": 0.4}}
DRAG = 0.2


@record
class Block(ss.Machine):
    """A block under viscous friction and a force of a user's own."""

    mass: float
    force: Any
    time_scale: ClassVar[float] = 1.0
    velocity_scale: ClassVar[float] = 1.0

    def bodies(self):
        return {"block": ss.Body(self.mass, force=self.force)}

    def contacts(self):
        return {"block": ss.Contact("block", ss.Viscous(DRAG, DRAG), load=1.0)}


def by_scipy(force, duration=3.0, mass=1.0):
    """Position and velocity at the end, of a machine whose force is called with floats."""
    drag = ss.Viscous(DRAG, DRAG).sliding

    def rates(t, y):
        return y[1], (force(t, float(y[0]), float(y[1])) - drag(float(y[1]), 1.0)) / mass

    return solve_ivp(rates, (0.0, duration), (0.3, 0.4), method="DOP853", rtol=1e-11, atol=1e-13, max_step=0.02).y[:, -1]


# functions that are no functions of their arguments ------------------------------------------------------------------

draw = np.random.default_rng(1)


def stored(step):
    """A force that changes something for its next call."""
    kept: dict[Any, Any] = {}
    return lambda t, x, v: step(kept, t, x, v)


def put(kept, key, value):
    kept[key] = value
    return value


UNREPEATABLE = {
    "a draw of numpy": lambda: lambda t, x, v: 3.0 * draw.normal() - x,
    "a draw of random": lambda: lambda t, x, v: random.random() - x,
    "a clock": lambda: lambda t, x, v: math.sin(1e3 * time.time()) - x,
    "a clock of large numbers": lambda: lambda t, x, v: 1e-9 * time.time() - x,
    "a counter": lambda: (lambda count: lambda t, x, v: 0.01 * next(count) - x)(itertools.count()),
    "a generator": lambda: (lambda wave: lambda t, x, v: next(wave) - x)(math.sin(0.1 * i) for i in range(10**9)),
    "an integral": lambda: stored(lambda kept, t, x, v: put(kept, "I", kept.get("I", 0.0) + 0.01 * (1.0 - x)) - x),
    "the value before": lambda: stored(lambda kept, t, x, v: kept.get("x", 0.0) - put(kept, "x", x) - v),
    "noise by its arguments": lambda: stored(lambda kept, t, x, v: (kept[t] if t in kept else put(kept, t, draw.normal())) - x),
    "a list that grows": lambda: stored(lambda kept, t, x, v: -x * (1.0 + 0.01 * len(kept)) + 0.0 * len(str(put(kept, len(kept), 0)))),
}


@each_row("name", UNREPEATABLE)
def test_a_force_that_is_no_function_of_its_arguments_is_refused_everywhere(name):
    force = UNREPEATABLE[name]
    doors = [
        lambda: ss.solve(Block(1.0, force()), duration=1.0),
        lambda: ss.solve(Block(1.0, force()), duration=1.0, method="dop853"),
        lambda: ss.solve(Block(np.array([1.0, 2.0]), force()), duration=1.0),
        lambda: ss.sweep(Block(1.0, force()), mass=[1.0, 2.0], duration=1.0),
    ]
    for door in doors:
        with pytest.raises(ss.InputError, match=r"RecordedForce|stored is used again"):
            door()


def test_what_is_to_be_typed_for_noise_is_solved_as_scipy_solves_it():
    phases, amplitudes = draw.uniform(0, 2 * np.pi, 4).tolist(), (0.3, 0.2, 0.2, 0.1)
    record = ss.drives.RecordedForce.from_samples(np.linspace(0.0, 2.9, 30), force=draw.normal(size=30), period=3.0, order=4)

    def wave(t, x, v):
        return sum(a * sin((1 + k) * t + phase) for k, (a, phase) in enumerate(zip(amplitudes, phases, strict=True))) + record.at(t) - x

    run = ss.solve(Block(1.0, wave), duration=3.0, start=START)
    assert [run.x[-1, 0], run.v[-1, 0]] == pytest.approx(by_scipy(wave), abs=1e-9)


# functions that treat symbols otherwise than numbers -----------------------------------------------------------------


def caught(work, instead):
    def force(t, x, v):
        try:
            return -work(x) - v
        except (TypeError, ValueError):
            return -instead(x) - v

    return force


def matched(t, x, v):
    match x:
        case float():
            return -2.0 * x
        case _:
            return -x


UNLIKE = {
    "isinstance": lambda t, x, v: -x * (3.0 if isinstance(x, float) else 1.0),
    "a type's name": lambda t, x, v: -x * (3.0 if type(v).__name__ == "float" else 1.0),
    "match": matched,
    "hasattr": lambda t, x, v: -x if hasattr(x, "is_integer") else -2.0 * x,
    "getattr": lambda t, x, v: -getattr(x, "real", 2.0 * x),
    "a caught float": caught(float, lambda x: 0.0),
    "a caught sine": caught(math.sin, lambda x: x),
    "a caught if": caught(lambda x: x if x > 0 else 2.0 * x, lambda x: x),
    "text": lambda t, x, v: -x * len(str(x)),
    "a dictionary": lambda t, x, v: -x * {True: 2.0}.get(isinstance(x, float), 1.0),
}


@each_row("name", UNLIKE)
def test_a_force_that_treats_symbols_otherwise_than_numbers_is_refused(name):
    for model, more in ((Block(1.0, UNLIKE[name]), {}), (Block(np.array([1.0, 2.0]), UNLIKE[name]), {})):
        with pytest.raises(ss.InputError, match=r"where it is called with numbers.* write where"):
            ss.solve(model, duration=1.0, start=START, **more)


UNTRACEABLE = {
    "if": lambda t, x, v: -2.0 * x if x > 0 else -x,
    "and, or": lambda t, x, v: (x > 0 and -2.0 * x) or -x,
    "not": lambda t, x, v: -x if not x > 0 else -2.0 * x,
    "a chain": lambda t, x, v: -x if 0 < x < 1 else -2.0 * x,
    "if on time": lambda t, x, v: -2.0 * x if t > 2.0 else -x,
    "all": lambda t, x, v: -x if all([x > 0, v > 0]) else -2.0 * x,
    "float": lambda t, x, v: -float(x),
    "int": lambda t, x, v: -x - int(v),
    "round": lambda t, x, v: -round(x),
    "floor": lambda t, x, v: -x - math.floor(v),
    "floor division": lambda t, x, v: -x - v // 1,
    "modulo": lambda t, x, v: -x - t % 1.0,
    "divmod": lambda t, x, v: -x - divmod(t, 1.0)[1],
    "math": lambda t, x, v: -math.sin(x),
    "copysign": lambda t, x, v: -x - math.copysign(0.1, v),
    "min": lambda t, x, v: -min(x, 0.2),
    "max": lambda t, x, v: -max(x, 0.2),
    "sorted": lambda t, x, v: -sorted([x, v])[0],
    "equal": lambda t, x, v: -x if v == 0 else -2.0 * x,
    "unequal": lambda t, x, v: -x if v != 0 else -2.0 * x,
    "in": lambda t, x, v: -x if v in (0.0, 1.0) else -2.0 * x,
    "looked up": lambda t, x, v: -x - {0.0: 1.0}[v],
    "an index": lambda t, x, v: [-x, -2.0 * x][x > 0],
    "format": lambda t, x, v: -float(f"{x:.2f}"),
    "read text": lambda t, x, v: -float(str(x)),
    "numpy's sine": lambda t, x, v: -np.sin(x),
    "numpy's sign": lambda t, x, v: -x - 0.1 * np.sign(v),
    "numpy's where": lambda t, x, v: np.where(x > 0, -2.0 * x, -x),
    "numpy's clip": lambda t, x, v: -np.clip(x, -0.2, 0.2),
    "numpy's interp": lambda t, x, v: np.interp(t, [0.0, 5.0], [0.0, 1.0]) - x,
    "numpy's solve": lambda t, x, v: -np.linalg.solve([[2.0, 0.0], [0.0, 1.0]], [x, v])[0],
    "a filled array": lambda t, x, v: -_filled(x, v).sum(),
    "complex": lambda t, x, v: -abs(complex(x, v)),
    "nothing": lambda t, x, v: None,
    "a condition": lambda t, x, v: x > 0,
    "text as a force": lambda t, x, v: "1",
    "a complex force": lambda t, x, v: 1j * x,
    "an endless force": lambda t, x, v: where(x > 0, -x, math.inf),
}


def _filled(x, v):
    a = np.zeros(2)
    a[0], a[1] = x, v
    return a


@each_row("name", UNTRACEABLE)
def test_what_only_numbers_can_do_is_refused_with_what_to_write(name):
    with pytest.raises(ss.InputError, match=r"write|call|allowed|return"):
        ss.solve(Block(1.0, UNTRACEABLE[name]), duration=1.0, start=START)


ALIKE = {
    "where": lambda t, x, v: where(x > 0.1, -2.0 * x, -x),
    "where with a branch that is not defined": lambda t, x, v: where(x > 0, -sqrt(abs(x) + 1e-3), where(x > -10.0, -x, -sqrt(x))),
    "where on time": lambda t, x, v: where(t > 1.0, -2.0 * x, -x),
    "abs": lambda t, x, v: -x - abs(v) * v,
    "sums of numpy": lambda t, x, v: -np.array([x, 0.1 * v]).sum() - np.dot([1.0, 0.1], [x, v]) + 0.1 * maximum(t, 1.0),
    "its own copy changed": lambda t, x, v: -functools.reduce(lambda a, b: a + b, [x, 0.5 * v]),
    "a cache of the same": functools.lru_cache(None)(lambda t, x, v: -x - 0.1 * v + cos(t)),
}


def test_a_machine_that_holds_a_function_is_not_written_to_a_file():
    with pytest.raises(ss.InputError, match="a study file holds numbers"):
        to_toml(Block(1.0, ALIKE["abs"]))


@pytest.mark.slow
@pytest.mark.parametrize("name", ALIKE)
def test_what_symbols_can_do_is_solved_as_scipy_solves_it(name):
    force = ALIKE[name]
    for method in ("auto", "dop853"):
        run = ss.solve(Block(1.0, force), duration=3.0, start=START, method=method, rtol=1e-9)
        assert [run.x[-1, 0], run.v[-1, 0]] == pytest.approx(by_scipy(force), abs=1e-6)
    grid = ss.sweep(Block(1.0, force), mass=[1.0, 2.0], duration=3.0, start=START)
    wanted = [(by_scipy(force, mass=mass)[0] - 0.3) / 3.0 for mass in (1.0, 2.0)]
    assert grid.mean_velocity.values.ravel() == pytest.approx(wanted, abs=1e-6)


# what functions read besides their arguments -------------------------------------------------------------------------

STIFFNESS = 1.0


def test_a_global_name_that_changes_changes_the_next_run():
    """The compiled equations of a kind are cached; a name that they read is no part of the kind."""
    global STIFFNESS

    def force(t, x, v):
        return -STIFFNESS * x

    machine, found = Block(1.0, force), {}
    for STIFFNESS in (1.0, 4.0, 1.0):
        run = ss.solve(machine, duration=3.0, start=START)
        judged = ss.solve(machine, duration=3.0, start=START, method="dop853", rtol=1e-10)
        found[STIFFNESS] = run.x[-1, 0]
        assert [run.x[-1, 0], judged.x[-1, 0]] == pytest.approx([by_scipy(force)[0]] * 2, abs=1e-8)
    assert abs(found[1.0] - found[4.0]) > 0.1


def test_parts_that_read_a_name_are_made_again_when_it_changes():
    held = {"load": 1.0, "mass": 1.0}

    @record
    class Pulled(ss.Machine):
        friction: Any
        time_scale: ClassVar[float] = 1.0

        def bodies(self):
            return {"block": ss.Body(held["mass"], force=1.0)}

        def contacts(self):
            return {"block": ss.Contact("block", self.friction, load=held["load"])}

    machine = Pulled(ss.Coulomb(0.1, 0.1))
    for load, mass in ((1.0, 1.0), (4.0, 1.0), (4.0, 2.0)):
        held |= {"load": load, "mass": mass}
        for method in ("auto", "dop853"):
            assert ss.solve(machine, duration=1.0, method=method).v[-1, 0] == pytest.approx((1.0 - 0.1 * load) / mass, rel=1e-9)


@record
class Loose:
    """A law whose coefficient belongs to its class."""

    mu: ClassVar[float] = 0.1

    def sliding(self, v, load):
        return where(v > 0, self.mu, -self.mu) * load

    def breakaway(self, load):
        return -self.mu * load, self.mu * load


@record
class Pushed(ss.Machine):
    friction: Any
    time_scale: ClassVar[float] = 1.0

    def bodies(self):
        return {"block": ss.Body(1.0, force=1.0)}

    def contacts(self):
        return {"block": ss.Contact("block", self.friction, load=1.0)}


def test_a_law_whose_class_is_changed_is_solved_as_it_is_now(monkeypatch):
    for mu in (0.1, 0.3):
        monkeypatch.setattr(Loose, "mu", mu)
        for method in ("auto", "dop853"):
            assert ss.solve(Pushed(Loose()), duration=1.0, method=method).v[-1, 0] == pytest.approx(1.0 - mu, rel=1e-9)
    monkeypatch.setattr(Loose, "sliding", lambda self, v, load: where(v > 0, 0.05, -0.05) * load)
    assert ss.solve(Pushed(Loose()), duration=1.0).v[-1, 0] == pytest.approx(0.95, rel=1e-9)


def test_functions_of_a_flow_that_read_a_name_are_traced_again_when_it_changes():
    rate = {"k": 1.0}
    flow = ss.SwitchingFlow({0: lambda t, y: (-rate["k"] * y[0],)}, states=("y",))
    for k in (1.0, 2.0):
        rate["k"] = k
        assert ss.solve(flow, duration=1.0, start={"y": 1.0}).y[-1, 0] == pytest.approx(math.exp(-k), rel=1e-12)


# flows ---------------------------------------------------------------------------------------------------------------


def flow_with(field=lambda t, y: (y[1], -y[0]), guard=lambda t, y: y[0] + 5.0, reset=None, to=0):
    return ss.SwitchingFlow({0: field}, {0: (ss.Switch(guard, to, reset),)}, states=("x", "v"))


def _turned(t, y):
    y[1] = -y[1]
    return y


FLOWS = {
    "a random field": flow_with(field=lambda t, y: (y[1], draw.normal() - y[0])),
    "a random guard": flow_with(guard=lambda t, y: y[0] + 5.0 + draw.normal()),
    "a random reset": flow_with(reset=lambda t, y: (0.0, -draw.uniform(0.5, 0.9) * y[1])),
    "a counting field": flow_with(field=(lambda count: lambda t, y: (y[1], -y[0] * next(count)))(itertools.count())),
    "a field of types": flow_with(field=lambda t, y: (y[1], -y[0] * (2.0 if isinstance(y[0], float) else 1.0))),
    "a sum of lists": flow_with(field=lambda t, y: y[1:] + y[:1]),
}


@each_row("name", FLOWS)
def test_functions_of_a_flow_that_are_no_functions_are_refused(name):
    with pytest.raises(ss.InputError):
        ss.solve(FLOWS[name], duration=1.0, start=[1.0, 0.0])


@each_row("name", list(FLOWS)[:4])
def test_the_judge_of_flows_refuses_noise_too(name):
    with pytest.raises(ss.InputError, match="for the same arguments later"):
        ss.dynamics.passage(FLOWS[name], [1.0, 0.0], 0, 1.0, method="dop853")


def belt(mode_after=None):
    """A block on a belt that moves backwards, in modes of its slip."""

    def field(side):
        return lambda t, y, n: (y[1], -y[0] - side * n.mu)

    def carried(t, y, n):
        return y[0], n.u

    forwards, backwards = ss.Switch(lambda t, y, n: y[1] - n.u, "back", carried), ss.Switch(lambda t, y, n: n.u - y[1], "forth", carried)
    return ss.SwitchingFlow(
        {"back": field(-1.0), "forth": field(1.0)}, {"back": (backwards,), "forth": (forwards,)}, None, {"mu": 0.3, "u": -1.0}, ("x", "v")
    )


def test_a_flow_begins_in_the_mode_of_its_state_and_another_mode_is_refused():
    """The guard of the first mode is -1 at the start: its reset would carry the block with the belt at once."""
    start = {"x": 0.5, "v": 0.0}
    run = ss.solve(belt(), duration=1.0, start=start)
    assert run.y[0].tolist() == [0.5, 0.0] and run.y[-1, 0] == pytest.approx(0.8 * math.cos(1.0) - 0.3, rel=1e-12)
    assert ss.solve(belt(), duration=1.0, start=start, mode="forth").y[-1, 0] == run.y[-1, 0]
    with pytest.raises(ss.InputError, match=r"beyond the guard of switches\['back'\]\[0\], which is -1.* type mode='forth'"):
        ss.solve(belt(), duration=1.0, start=start, mode="back")
    swept = ss.sweep(belt(), mu=[0.3, 0.4], duration=1.0, start=start)
    assert swept["end_x"].values == pytest.approx([(0.5 + mu) * math.cos(1.0) - mu for mu in (0.3, 0.4)], rel=1e-12)


# equations that solvers do not read ----------------------------------------------------------------------------------


@record
class CartPole(ss.Machine):
    """A cart with a pendulum, written into the mechanics: friction on the cart accelerates the pendulum too."""

    cart: float
    bob: float
    length: float
    push: float
    omega: float
    friction: Any

    @property
    def period(self):
        return 2 * pi / self.omega

    def bodies(self):
        return {"cart": ss.Body(self.cart + self.bob), "angle": ss.Body(self.bob * self.length**2, position=0.5)}

    def contacts(self):
        return {"cart": ss.Contact("cart", self.friction)}

    @property
    def mechanics(self):
        from stickslip.models.several_bodies import SeveralBodies

        class Coupled(SeveralBodies):
            def accelerations(self, t, q, u, R, z=None):
                p, c, s = self.model, cos(q[1]), sin(q[1])
                h1 = p.push * sin(p.omega * t) + p.bob * p.length * s * u[1] ** 2 - R[0]
                h2 = -p.bob * p.length * 9.81 * s
                a, b, d = p.cart + p.bob, p.bob * p.length * c, p.bob * p.length**2
                return (d * h1 - b * h2) / (a * d - b * b), (a * h2 - b * h1) / (a * d - b * b)

        return Coupled(self)


@each_row(
    "door",
    [
        lambda m: ss.solve(m, periods=2),
        lambda m: ss.solve(m, periods=2, method="dop853"),
        lambda m: ss.sweep(m, push=[3.0, 4.0], periods=2),
        lambda m: ss.periodic_orbit(m),
        lambda m: ss.dynamics.mirrored(m),
    ],
)
def test_an_overridden_mechanics_is_refused_at_every_door(door):
    for law in (ss.Coulomb(0.1, 0.1), ss.LuGre.example()):
        with pytest.raises(ss.InputError, match=r"overrides mechanics.*def forces\(self, t, x, v\).*SwitchingFlow"):
            door(CartPole(1.0, 0.3, 0.5, 4.0, 5.0, law))


@record
class Rolling(ss.BlockOnBelt):
    """A block with a flywheel, which total_mass does not know."""

    wheel: float = 1.0

    def acceleration(self, t, x, v, R):
        return super().acceleration(t, x, v, R) * self.mass / (self.mass + self.wheel)


@record
class Heavier(Rolling):
    @property
    def total_mass(self):
        return self.mass + self.wheel


def test_friction_that_accelerates_otherwise_than_the_mass_says_is_refused():
    for method in ("auto", "dop853"):
        with pytest.raises(ss.InputError, match=r"friction of .* allowed is -R/mass.*total_mass"):
            ss.solve(Rolling(1.0, 2.0, 0.1, ss.Coulomb(0.1, 0.1), load=1.0), duration=5.0, method=method)
    heavy, double = (c(m, 2.0, 0.1, ss.Coulomb(0.1, 0.1), load=1.0) for c, m in ((Heavier, 1.0), (ss.BlockOnBelt, 2.0)))
    assert ss.solve(heavy, duration=5.0).x[-1] == pytest.approx(ss.solve(double, duration=5.0).x[-1], rel=1e-10)


@record
class Pressed(ss.Contact):
    """A contact that computes its load itself."""

    def normal(self, t, x):
        return 2.0


@record
class Slider(ss.Machine):
    friction: Any
    time_scale: ClassVar[float] = 1.0

    def bodies(self):
        return {"block": ss.Body(1.0, force=1.0)}

    def contacts(self):
        return {"block": Pressed("block", self.friction)}

    def forces(self, t, x, v):
        x["block"] -= 100.0  # of its own dictionary: links and others are given another one
        return {"block": 0.0}

    def links(self):
        return {("block", None): ss.Spring(0.1)}


def test_parts_that_override_a_method_are_asked_for_it():
    wanted = 0.8 / math.sqrt(0.1) * math.sin(math.sqrt(0.1))  # x'' = 1 - 0.1 * 2 - 0.1 x
    for method in ("auto", "dop853"):
        assert ss.solve(Slider(ss.Coulomb(0.1, 0.1)), duration=1.0, method=method).v[-1, 0] == pytest.approx(wanted, rel=1e-9)


def test_an_observable_that_draws_is_refused():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=[5e-4, 6e-4])
    with pytest.raises(ss.InputError, match="noise is another expression each time"):
        ss.sweep(robot, periods=4, observe={"noise": ss.observable(lambda s: draw.normal() * s.v)})


@record
class Nervous(ss.Coulomb):
    """A law that draws its coefficient at each call."""

    def sliding(self, v, load):
        return draw.uniform(0.8, 1.0) * super().sliding(v, load)


class Uneven(ss.Harmonic):
    """A drive that jitters."""

    def acceleration(self, t):
        return super().acceleration(t + 1e-4 * draw.normal())


def test_a_law_or_a_drive_that_draws_is_refused_everywhere():
    rig = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb")
    for robot in (rig.replace(friction=Nervous(0.1, 0.2, f_plus=0.2, f_minus=0.3)), rig.replace(drive=Uneven(6e-4, omega=205.0))):
        for door in (
            lambda r: ss.solve(r, periods=3),
            lambda r: ss.solve(r, periods=3, method="dop853"),
            lambda r: ss.solve(r, periods=3, method="rk4"),
            lambda r: ss.sweep(r, **{"drive.amplitude": [5e-4, 6e-4]}, periods=3),
            lambda r: ss.periodic_orbit(r),
            lambda r: ss.continuation(r, parameter="drive.amplitude", start=5e-4, stop=6e-4),
            lambda r: ss.basins(r, v=np.array([-0.01, 0.01])),
        ):
            with pytest.raises(ss.InputError, match="for the same arguments later"):
                door(robot)


class Slipped(ss.Harmonic):
    """A motion whose velocity is not the rate of its position."""

    def velocity(self, t):
        return 2.0 * super().velocity(t)


def test_a_prescribed_motion_that_contradicts_itself_is_refused():
    @record
    class Carried(ss.Machine):
        friction: Any
        motion: Any

        @property
        def period(self):
            return self.motion.period

        def bodies(self):
            return {"part": ss.Body(1.0)}

        def contacts(self):
            return {"part": ss.Contact("part", self.friction, on=self.motion)}

    with pytest.raises(ss.InputError, match="is not the rate of its velocity"):
        ss.solve(Carried(ss.Coulomb(0.1, 0.1), Slipped(1e-3, omega=20.0)), periods=2)


@record
class AsksForTheType:
    """A law that does something else with symbols than with numbers."""

    stiffness: float

    def rate(self, v, z, load):
        return v - abs(v) * z * self.stiffness * (2.0 if isinstance(v, float) else 1.0)

    def force(self, v, z, zdot, load):
        return self.stiffness * z


@record
class Draws:
    """A law that draws a number whenever it is called."""

    mu: float

    def sliding(self, v, load):
        return where(v > 0, 1.0, -1.0) * self.mu * load * (1.0 + 0.1 * np.random.default_rng().normal())

    def breakaway(self, load):
        return self.mu * load, self.mu * load


@pytest.mark.parametrize("language", ["c", "matlab"])
@pytest.mark.parametrize(("law", "why"), [(AsksForTheType(100.0), "rate gives .* no isinstance"), (Draws(0.2), "no random draw")])
def test_a_law_is_exported_as_its_plain_python_or_not_at_all(law, why, language):
    with pytest.raises(ss.InputError, match=why):
        ss.export_law(law, language, name="own")


def test_steps_of_force_records_are_those_of_plain_python_or_are_not_compiled():
    from stickslip.engine.law_steps import law_steps
    from stickslip.models.friction.law_adapter import adapted

    assert law_steps(adapted(AsksForTheType(100.0))) is None
    assert law_steps(adapted(ss.Dahl(np.array([0.3, 0.4]), 0.3, sigma0=1e5))) is not None
