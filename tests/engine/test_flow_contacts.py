"""Contacts of switching flows: against the machines that have the same equations, SciPy with events, and the judge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stickslip as ss
from rows import each_row
from stickslip.maths import cos, sin, where
from stickslip.solvers.plain.composed_flows import mode_of_state

G = 9.81


def by_hand(robot):
    """A robot whose equations are written as a flow with one contact."""
    foot = ss.machines.FlowContact(slip=lambda t, y: y[1], friction=robot.friction, load=robot.load)
    field = lambda t, y, R: (y[1], robot.acceleration(t, y[0], y[1], R.foot))  # noqa: E731
    return ss.SwitchingFlow(field, period=float(robot.period), states=("x", "v"), contacts={"foot": foot})


@pytest.fixture(scope="module")
def belt():
    law = ss.Stribeck(0.2, 0.2, 0.3, 0.3, v_s=0.1, exponent=1.0)
    contact = ss.machines.FlowContact(slip=lambda t, y, n: y[1] - n.speed, friction=law, load=9.81)
    field = lambda t, y, R, n: (y[1], -4.0 * y[0] - R.belt)  # noqa: E731
    return ss.SwitchingFlow(field, numbers={"speed": 0.1}, states=("x", "v"), contacts={"belt": contact})


@pytest.fixture(scope="module")
def stack():
    """A block that is pushed, on a block on the ground."""
    top = ss.machines.FlowContact(slip=lambda t, y: y[2] - y[3], friction=ss.Coulomb(2.0, 2.0), load=1.0)
    ground = ss.machines.FlowContact(slip=lambda t, y: y[3], friction=ss.Coulomb(0.8, 0.8, f_plus=1.0, f_minus=1.0), load=1.0)
    field = lambda t, y, R: (y[2], y[3], 5 * cos(4 * t) - R.top, (R.top - R.ground - 3 * y[1]) / 2.0)  # noqa: E731
    return ss.SwitchingFlow(field, period=np.pi / 2, states=("x1", "x2", "v1", "v2"), contacts={"top": top, "ground": ground})


@pytest.fixture(scope="module")
def cart():
    """A cart that is pushed, with a pendulum that presses it on its rail."""
    M, m, length = 1.0, 0.3, 0.5

    def field(t, y, R):
        s, c, F = sin(y[1]), cos(y[1]), 6 * cos(5 * t) - R.rail
        inertia = M + m * s * s
        a = (F + m * s * (length * y[3] * y[3] + G * c)) / inertia
        return (y[2], y[3], a, -(F * c + m * length * y[3] * y[3] * c * s + (M + m) * G * s) / (length * inertia))

    load = lambda t, y: (M + m) * G + m * length * y[3] * y[3] * cos(y[1])  # noqa: E731
    rail = ss.machines.FlowContact(slip=lambda t, y: y[2], friction=ss.Coulomb(0.15, 0.15, f_plus=0.2, f_minus=0.2), load=load)
    return ss.SwitchingFlow(field, period=0.4 * np.pi, states=("x", "angle", "v", "w"), contacts={"rail": rail})


def same_events(run, other, within):
    assert len(run.events) == len(other.events) > 4
    assert max(abs(a.t - b.t) for a, b in zip(run.events, other.events, strict=True)) < within


def test_a_robot_written_by_hand_is_the_robot():
    """Steps of both are exact to rounding: 1e-15 of an instant, which is below 0.7 s."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb-static")
    run, own = (ss.solve(model, periods=20, settle=0) for model in (by_hand(robot), robot))
    same_events(run, own, 1e-14)
    assert run.state == pytest.approx([own.x[-1], own.v[-1]], rel=1e-11)


def test_a_robot_with_bristles_written_by_hand_is_the_robot():
    """`solve` is within its tolerance of 1e-10, of velocities of 0.1 m/s; the flow is exact to rounding."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="lugre")
    flow = by_hand(robot)
    run, own = ss.solve(flow, periods=3, settle=0), ss.solve(robot, periods=3, settle=0, rtol=1e-10)
    assert run.names == ("x", "v", "z_foot") and flow.modes == (0,)
    assert run.state[:2] == pytest.approx([own.x[-1], own.v[-1]], abs=1e-9)
    assert run.state[2] == pytest.approx(own.z[-1], rel=1e-6)


def test_a_block_on_a_belt_is_the_machine_and_what_scipy_says(belt):
    """SciPy's rest is the event at which the spring pulls as hard as static friction holds."""
    bench = ss.BlockOnBelt(mass=1.0, stiffness=4.0, speed=0.1, friction=belt.contacts["belt"].friction, load=9.81)
    run, own = (ss.solve(model, start={"x": 0.1}, duration=40.0) for model in (belt, bench))
    same_events(run, own, 1e-11)
    friction = lambda w: -G * (0.2 + 0.1 * np.exp(w / 0.1))  # noqa: E731  # of a block that is slower than the belt
    t, y, events = 0.0, [0.1, 0.0], []
    landing = lambda t, y: y[1] - 0.1  # noqa: E731
    landing.terminal, landing.direction = True, 1.0
    for _ in range(3):
        end = solve_ivp(lambda t, y: (y[1], -4 * y[0] - friction(y[1] - 0.1)), (t, t + 20), y, events=landing, rtol=1e-12, atol=1e-14)
        t, x = end.t[-1], end.y[0, -1]
        leaves = t + (0.3 * G / 4 - x) / 0.1
        events += [t, leaves]
        t, y = leaves + 1e-6, [0.3 * G / 4 + 1e-7, 0.1 - 2e-13]
    assert [event.t for event in run.events[:6]] == pytest.approx(events, abs=2e-3)


def test_contacts_go_as_the_judge_says(stack, cart):
    """Events of the judge are exact to 1e-12 of their instants at its tolerance of 1e-12; pushed together they grow ten times."""
    for flow, y, duration in ((stack, [0.0] * 4, 5.0), (cart, [0.0, 0.3, 0.0, 0.0], 3.0)):
        run, plain = (ss.dynamics.passage(flow, y, 0, duration, method=method) for method in ("exact", "dop853"))
        assert [event[1:] for event in run.events] == [event[1:] for event in plain.events]
        same = max(abs(a[0] - b[0]) for a, b in zip(run.events, plain.events, strict=True))
        assert same < 1e-11 and abs(run.state - plain.state).max() < 1e-11
        assert abs(run.monodromy - plain.monodromy).max() < 1e-10 * abs(plain.monodromy).max()


def test_what_a_contact_does_at_the_start_the_state_says(belt, stack):
    for state, mode in (([0.0, 0.0], "belt-"), ([0.2, 0.1], "belt0"), ([0.9, 0.1], "belt-"), ([-0.9, 0.1], "belt+"), ([0.0, 0.3], "belt+")):
        assert mode_of_state(belt, state) == mode
        run = ss.solve(belt, start=state, duration=1e-6)
        assert run.mode_at[0] == mode
    assert mode_of_state(stack, [0.0] * 4) == "top+ ground+"


def test_cycles_and_columns_of_contacts_are_those_of_the_machine(belt):
    """At rest the belt carries the block: the friction force is that of the spring."""
    bench = ss.BlockOnBelt(mass=1.0, stiffness=4.0, speed=0.1, friction=belt.contacts["belt"].friction, load=9.81)
    orbit, own = ss.periodic_orbit(belt), ss.periodic_orbit(bench)
    assert orbit.duration == pytest.approx(own.duration, rel=1e-11) and abs(orbit.multipliers[0]) < 1e-12
    run = ss.solve(belt, start={"x": 0.1}, duration=20.0)
    contact = run.contacts["belt"]
    rests = contact.mode == 0
    assert 0.5 < rests.mean() < 1.0 and (contact.mode[~rests] == -1).all()
    assert contact.slip == pytest.approx(run["v"] - 0.1, abs=1e-15) and (contact.load == 9.81).all()
    assert contact.friction_force[rests] == pytest.approx(-4.0 * run["x"][rests], abs=1e-13)
    sliding = -9.81 * (0.2 + 0.1 * np.exp(-abs(contact.slip) / 0.1))
    assert contact.friction_force[~rests] == pytest.approx(sliding[~rests], abs=1e-12)
    assert run.to_xarray().friction_force_belt.values.tolist() == contact.friction_force.tolist()


def test_starts_of_maps_leave_the_mode_to_the_state(belt):
    """Every start goes to the one cycle, also those that a mode of the first start would hold at a slip."""
    basins = ss.basins(belt, x=[-1.0, 0.2, 1.0], v=[-1.0, 0.1, 1.0])
    assert [(a.period, a.share) for a in basins.attractors] == [(1, 1.0)]


def test_contacts_follow_switches_of_the_user():
    """A block that slides to a wall, is thrown back with half its velocity, and comes to rest."""
    wall = ss.Switch(lambda t, y: 1.0 - y[0], 0, lambda t, y: (1.0, -0.5 * y[1]))
    ground = ss.machines.FlowContact(slip=lambda t, y: y[1], friction=ss.Coulomb(0.1, 0.1), load=G)
    block = ss.SwitchingFlow(lambda t, y, R: (y[1], -R.ground), {0: (wall,)}, states=("x", "v"), contacts={"ground": ground})
    v, mu = 2.0, 0.1 * G
    hit = (v - np.sqrt(v * v - 2 * mu)) / mu
    back = 0.5 * (v - mu * hit)
    run = ss.solve(block, start={"v": v}, duration=5.0)
    assert [event[1:] for event in run.events] == [("ground+", "ground-"), ("ground-", "ground0")]
    assert [event.t for event in run.events] == pytest.approx([hit, hit + back / mu], rel=1e-13)
    assert run.state == pytest.approx([1.0 - back**2 / (2 * mu), 0.0], rel=1e-13)
    assert ss.dynamics.passage(block, [0.0, v], 0, 5.0, method="dop853").state == pytest.approx(run.state, rel=1e-10)


def test_a_law_may_follow_from_numbers():
    ground = ss.machines.FlowContact(
        slip=lambda t, y, n: y[0], friction=lambda n: ss.Coulomb(mu_plus=n.mu, mu_minus=n.mu), load=lambda t, y, n: n.N
    )
    block = ss.SwitchingFlow(
        lambda t, y, R, n: (-R.ground,), numbers={"mu": [0.1, 0.2], "N": G}, states=("v",), contacts={"ground": ground}
    )
    batch = ss.solve(block, start={"v": 1.0}, duration=0.25)
    assert batch.end_v.tolist() == pytest.approx([1 - 0.025 * G, 1 - 0.05 * G], rel=1e-14)


def test_a_run_ends_where_a_load_falls_to_zero():
    ground = ss.machines.FlowContact(slip=lambda t, y: y[0], friction=ss.Coulomb(0.1, 0.1), load=lambda t, y: 1.0 - t)
    block = ss.SwitchingFlow(lambda t, y, R: (-R.ground,), states=("v",), contacts={"ground": ground})
    for follow in (
        lambda: ss.solve(block, start={"v": 1.0}, duration=2.0),
        lambda: ss.dynamics.passage(block, [1.0], 0, 2.0, method="dop853"),
    ):
        with pytest.raises(ss.SolveError, match="load"):
            follow()


_LAW = ss.Coulomb(0.1, 0.1)


@each_row(
    "wrong, said",
    [
        (lambda: ss.machines.FlowContact(slip=1.0, friction=_LAW, load=1.0), "slip = 1.0; allowed is a function"),
        (lambda: ss.machines.FlowContact(slip=lambda t, y: y[0], friction=0.2, load=1.0), "friction = 0.2; allowed is a friction law"),
        (lambda: one_contact(lambda t, y, R: (-R.a,), contacts=[1]), "allowed is a dict of FlowContact"),
        (lambda: started(lambda t, y, R: (R.a,)), "does not brake"),
        (lambda: started(lambda t, y, R: (-R.a * R.a,)), "not linear in the friction force R.a"),
        (lambda: started(lambda t, y, R: (-where(R.a > 1.0, 1.0, R.a),)), "not linear in the friction force R.a"),
        (lambda: triangle(), "a, b, c: the slip of one follows.*write a Machine"),
    ],
)
def test_what_no_contact_can_do_is_said(wrong, said):
    with pytest.raises(ss.InputError, match=said):
        wrong()


def one_contact(field, law=_LAW, contacts=None, second=False):
    contact = ss.machines.FlowContact(slip=lambda t, y: y[0], friction=law, load=1.0)
    return ss.SwitchingFlow(field, states=("v",), contacts=contacts or ({"a": contact} | ({"b": contact} if second else {})))


def triangle():
    """Two bodies on the ground and on one another: three slips of two velocities."""
    slips = {"a": lambda t, y: y[0], "b": lambda t, y: y[1], "c": lambda t, y: y[0] - y[1]}
    contacts = {name: ss.machines.FlowContact(slip=slip, friction=_LAW, load=1.0) for name, slip in slips.items()}
    return ss.solve(ss.SwitchingFlow(lambda t, y, R: (-R.a - R.c, R.c - R.b), states=("v", "w"), contacts=contacts), duration=1.0)


def started(field, law=_LAW, second=False):
    return ss.solve(one_contact(field, law, second=second), start={"v": 0.0}, duration=1.0)


# ---- laws with inner states, memories, or a question after the force that would hold them ----
K, SPEED, LASTS = 50.0, 0.05, 1.5
LAWS = [ss.friction.LuGre, ss.friction.Dahl, ss.friction.ElastoPlastic, ss.friction.RateState]
LAWS += [ss.friction.GMS, ss.friction.ResetIntegrator, ss.friction.Karnopp]


def on_belt(law):
    """A block on a spring and on a belt, with one friction law: a flow, and the machine."""
    belt = ss.machines.FlowContact(slip=lambda t, y: y[1] - SPEED, friction=law, load=1.0)
    flow = ss.SwitchingFlow(lambda t, y, R: (y[1], -K * y[0] - R.belt), states=("x", "v"), contacts={"belt": belt})
    return flow, ss.BlockOnBelt(mass=1.0, stiffness=K, speed=SPEED, friction=law, load=1.0)


def by_scipy(law, end):
    """Position and velocity at the end by SciPy's implicit integrator, restarted where a memory of the law changes."""
    from stickslip.models.friction.law_adapter import adapted

    own = adapted(law)
    z, mode, t = own.start(1.0), (0,) * own.modes, 0.0
    y = np.array([0.0, 0.0, *z])

    def rates(t, y):
        R, zdot = own.response(y[1] - SPEED, tuple(y[2:]), 1.0, mode, -K * y[0])
        return [y[1], -K * y[0] - R, *zdot]

    def guard(k):
        def value(t, y):
            return y[1] - SPEED if passing[k] else own.switches(y[1] - SPEED, tuple(y[2:]), 1.0, mode)[k][0]

        value.terminal, value.direction = True, 0.0 if passing[k] else -1.0
        return value

    there = own.switches(-SPEED, z, 1.0, mode)
    passing = [each[0] == SPEED for each in there]  # the slip itself, by its size
    while t < end:
        scale = np.array([1e-3, 1e-2, *(own.scale(1.0) or (1.0,) * own.states)])
        done = solve_ivp(
            rates, (t, end), y, "Radau", rtol=1e-9, atol=1e-10 * scale, events=[guard(k) for k in range(len(there))] or None
        )  # fmt: skip
        t, y = float(done.t[-1]), done.y[:, -1].copy()
        if done.status == 1:
            k = next(k for k, times in enumerate(done.t_events) if len(times))
            _, mode, new = own.switches(y[1] - SPEED, tuple(y[2:]), 1.0, mode)[k]
            y[2:] = y[2:] if new is None else new
    return y[:2]


@each_row("law", [law.example() for law in LAWS], ids=[law.__name__ for law in LAWS])
def test_a_law_in_a_flow_does_what_it_does_in_a_machine_and_what_scipy_says(law):
    flow, machine = on_belt(law)
    run, own = ss.solve(flow, duration=LASTS), ss.solve(machine, duration=LASTS, rtol=1e-10)
    t = np.linspace(0.0, LASTS, 60)[1:]
    assert abs(run.at(t)["x"] - own.at(t)["x"]).max() < 1e-10 and abs(run.at(t)["v"] - own.at(t)["v"]).max() < 1e-10
    assert abs(run.contacts["belt"].friction_force[-1] - own.friction_force[-1]) < 1e-7  # stiff elements show a position 1e4 times
    assert abs(run.state[:2] - by_scipy(law, LASTS)).max() < 1e-7


@dataclass(frozen=True, eq=False)
class TwoFeet(ss.Machine):
    """A shaken block with two feet, one of which may stand on a belt."""

    speed: float
    laws: tuple = (ss.Coulomb(0.2, 0.2, f_plus=0.3, f_minus=0.3), ss.Stribeck(0.1, 0.15, f_plus=0.2, f_minus=0.2, v_s=0.1))
    velocity_scale = 1.0

    def bodies(self):
        return {"block": ss.Body(1.0, force=lambda t, x, v: 1.5 * sin(4.0 * t) - 2.0 * x)}

    def contacts(self):
        left, right = self.laws
        return {"left": ss.Contact("block", left, load=1.0), "right": ss.Contact("block", right, load=2.0, on=self.speed)}


@each_row("speed", [0.0, 0.15])
def test_several_feet_of_a_body_do_what_they_do_in_a_machine_and_what_the_judge_says(speed):
    machine = TwoFeet(speed)
    left = ss.machines.FlowContact(slip=lambda t, y: y[1], friction=machine.laws[0], load=1.0)
    right = ss.machines.FlowContact(slip=lambda t, y: y[1] - speed if speed else y[1], friction=machine.laws[1], load=2.0)
    field = lambda t, y, R: (y[1], 1.5 * sin(4.0 * t) - 2.0 * y[0] - R.left - R.right)  # noqa: E731
    flow = ss.SwitchingFlow(field, states=("x", "v"), contacts={"left": left, "right": right})
    run, own = ss.solve(flow, duration=5.0), ss.solve(machine, duration=5.0)
    t = np.linspace(0.0, 5.0, 60)[1:]
    assert abs(run.at(t)["x"] - np.ravel(own.at(t)["x"])).max() < 1e-13 and abs(run.at(t)["v"] - np.ravel(own.at(t)["v"])).max() < 1e-13
    forces = np.column_stack([[run.at(s)[f"friction_force_{name}"] for s in t] for name in ("left", "right")])
    assert abs(forces - own.at(t)["friction_force"]).max() < 1e-12
    plain = ss.dynamics.passage(flow, [0.0, 0.0], 0, 5.0, method="dop853")
    assert len(plain.events) > 5 and [e[1:] for e in plain.events] == [e[1:] for e in run.events]
    assert abs(plain.state - run.state).max() < 1e-11


def test_what_a_law_remembers_is_part_of_the_state():
    """A run that goes on from the state of another one is the run that was not cut."""
    flow, _ = on_belt(ss.friction.GMS.example())
    whole, first = ss.solve(flow, duration=2.0), ss.solve(flow, duration=0.9)
    assert first.names[-4:] == tuple(f"memory_belt_{k}" for k in range(4)) and set(first.state[-4:]) == {1.0}
    later = ss.solve(flow, start=dict(zip(first.names, first.state, strict=True)), duration=1.1)
    assert later.state == pytest.approx(whole.state, rel=1e-8, abs=1e-9)
    sim = ss.simulation(flow)
    for _ in range(20):
        sim.step(0.1)
    assert [sim.state[name] for name in whole.names] == pytest.approx(whole.state, rel=1e-8, abs=1e-9)


def test_laws_of_both_sorts_meet_in_a_flow_as_in_a_machine():
    """A block that rests on a sledge with bristles, both pushed."""
    top, ground = ss.Coulomb(0.3, 0.3, f_plus=0.4, f_minus=0.4), ss.friction.LuGre.example()
    contacts = {
        "top": ss.machines.FlowContact(slip=lambda t, y: y[2] - y[3], friction=top, load=1.0),
        "ground": ss.machines.FlowContact(slip=lambda t, y: y[3], friction=ground, load=3.0),
    }
    field = lambda t, y, R: (y[2], y[3], 0.6 * cos(4 * t) - R.top, 1.5 * sin(3 * t) - 3.0 * y[1] + R.top - R.ground)  # noqa: E731
    flow = ss.SwitchingFlow(field, states=("x1", "x2", "v1", "v2"), contacts=contacts)

    @dataclass(frozen=True, eq=False)
    class Sledge(ss.Machine):
        velocity_scale = 1.0

        def bodies(self):
            pushes = lambda t, x, v: 0.6 * cos(4 * t), lambda t, x, v: 1.5 * sin(3 * t) - 3.0 * x
            return {"block": ss.Body(1.0, force=pushes[0]), "sledge": ss.Body(1.0, force=pushes[1])}

        def contacts(self):
            return {
                "top": ss.Contact("block", top, on="sledge", load=1.0), "ground": ss.Contact("sledge", ground, load=3.0)
            }  # fmt: skip

    run, own = ss.solve(flow, duration=4.0), ss.solve(Sledge(), duration=4.0, rtol=1e-10)
    t = np.linspace(0.0, 4.0, 50)
    at, there = run.at(t), own.at(t)["v"]
    assert max(abs(at["v1"] - there[:, 0]).max(), abs(at["v2"] - there[:, 1]).max()) < 1e-9
    stops = [event.t for event in own.events if event.part == "top"]
    assert len(stops) > 2 and [event.t for event in run.events] == pytest.approx(stops, abs=1e-8)


SOFT = ss.friction.LuGre(0.2, 0.2, f_plus=0.3, f_minus=0.3, sigma0=1e4, sigma1=10.0, sigma2=0.1, v_s=0.05)
ELEMENTS = ss.friction.GMS(0.2, 0.2, 0.3, 0.3, sigma0=1e4, v_s=0.05, attraction=10.0)


@each_row("law", [SOFT, ELEMENTS], ids=["LuGre", "GMS"])
def test_cycles_and_multipliers_of_a_flow_with_inner_states_are_those_of_the_machine(law):
    flow, machine = on_belt(law)
    orbit, own = ss.periodic_orbit(flow), ss.periodic_orbit(machine, rtol=1e-10)
    assert orbit.duration == pytest.approx(own.duration, rel=1e-8)
    assert max(abs(orbit.multipliers)) == pytest.approx(max(abs(own.multipliers)), abs=1e-6)


def test_starts_of_maps_and_files_know_contacts_with_inner_states(tmp_path):
    """All starts come to the driven motion, after some 300 periods of 800 steps."""
    foot = ss.machines.FlowContact(slip=lambda t, y: y[1], friction=SOFT, load=1.0)
    shaken = lambda t, y, R: (y[1], -2.0 * y[0] + 0.6 * sin(2.0 * t) - R.foot)  # noqa: E731
    flow = ss.SwitchingFlow(shaken, period=np.pi, states=("x", "v"), contacts={"foot": foot})
    assert [(a.period, a.share) for a in ss.basins(flow, x=[-0.01, 0.3], v=[0.0, 0.05]).attractors] == [(1, 1.0)]
    run = ss.solve(flow, periods=3)
    again = ss.load(run.save(tmp_path / "run.nc"), machines=[flow])
    assert (run.method, run.rtol) == (again.method, again.rtol) == ("Rodas5P", 1e-9) and np.array_equal(run.state, again.state)


@each_row(
    "follow, said",
    [
        (lambda: started(lambda t, y, R: (-R.a,), ss.friction.Bristle.example()), "Bristle is random.*write a Machine of bodies"),
        (lambda: started(lambda t, y, R: (-R.a - R.b,), ss.friction.Karnopp.example(), second=True), "'b' rubs too; give both"),
        (lambda: ss.check(on_belt(ss.friction.GMS.example())[0], duration=1.0), 'remembers whole numbers.*method="radau"'),
    ],
    ids=["random", "applied force of two", "judge of memories"],
)
def test_what_flows_do_not_follow_says_what_to_type(follow, said):
    with pytest.raises(ss.InputError, match=said):
        follow()
