"""Contacts of switching flows: against the machines that have the same equations, SciPy with events, and the judge."""

from __future__ import annotations

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
        (lambda: started(lambda t, y, R: (-R.a,), ss.friction.ResetIntegrator.example()), "allowed are laws"),
        (lambda: started(lambda t, y, R: (-R.a - R.b,), second=True), "a, b: the slip of one follows"),
    ],
)
def test_what_no_contact_can_do_is_said(wrong, said):
    with pytest.raises(ss.InputError, match=said):
        wrong()


def one_contact(field, law=_LAW, contacts=None, second=False):
    contact = ss.machines.FlowContact(slip=lambda t, y: y[0], friction=law, load=1.0)
    return ss.SwitchingFlow(field, states=("v",), contacts=contacts or ({"a": contact} | ({"b": contact} if second else {})))


def started(field, law=_LAW, second=False):
    return ss.solve(one_contact(field, law, second=second), start={"v": 0.0}, duration=1.0)


@each_row(
    "law, said",
    [
        (ss.friction.GMS.example(), "remembers whole numbers.*write a Machine of bodies and contacts"),
        (ss.friction.Karnopp.example(), "asks for the force that would hold it.*write a Machine"),
        (ss.friction.RateState.example(), "step budget used up.*z_belt may be stiff.*write a Machine"),
    ],
    ids=["memory", "applied force", "stiff at rest"],
)
def test_laws_that_flows_do_not_follow_say_what_to_write(law, said):
    with pytest.raises((ss.InputError, ss.SolveError), match=said):
        belt = ss.machines.FlowContact(slip=lambda t, y: y[1] - 0.01, friction=law, load=1.0)
        flow = ss.SwitchingFlow(lambda t, y, R: (y[1], -50.0 * y[0] - R.belt), states=("x", "v"), contacts={"belt": belt})
        ss.solve(flow, duration=1.0)


def test_a_stiff_law_that_turns_round_at_rest_is_not_called_a_flow_that_chatters():
    slow = ss.machines.FlowContact(slip=lambda t, y: y[1] - 0.1, friction=ss.friction.RateState.example(), load=1.0)
    flow = ss.SwitchingFlow(lambda t, y, R: (y[1], -y[0] - R.belt), states=("x", "v"), contacts={"belt": slow})
    with pytest.raises(ss.SolveError, match=r"turns round without end at t = .* z_belt may be stiff.*write a Machine"):
        ss.solve(flow, duration=10.0)
