"""Cyclic coordinates of flows: a robot and a belt written by hand move as the same machines of parts do, and angles count modulo a turn."""

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.maths import cos, sin

ROUNDING = 1e-13  # of velocities and states of size 1, over some periods


def robot_and_flow():
    """A robot, and its equations written as a flow."""
    law = ss.Coulomb(mu_plus=0.4, mu_minus=0.5)
    robot = ss.Robot(body_mass=0.5, inner_mass=0.5, drive=ss.Harmonic(amplitude=2.0, omega=1.0), friction=law, gravity=1.0)
    ground = ss.machines.FlowContact(slip=lambda t, y, n: y[1], friction=law, load=1.0)

    def rates(t, y, R, n):
        return (y[1], 0.5 * n.A * sin(t) - R.ground)

    return robot, ss.SwitchingFlow(rates, None, 2 * np.pi, {"A": 2.0}, ("x", "v"), None, {"ground": ground}, "x")


def rotor(cyclic):
    """A pendulum that a constant and an alternating torque turn over."""

    def rates(t, y, n):
        return (y[1], n.M - sin(y[0]) - n.c * y[1] + 1.2 * cos(n.w * t))

    def period(n):
        return 2 * np.pi / n.w

    return ss.SwitchingFlow(rates, None, period, {"M": 0.8, "c": 0.4, "w": 2.0}, ("angle", "v"), cyclic=cyclic)


def test_a_robot_written_by_hand_moves_as_the_robot_does():
    robot, flow = robot_and_flow()
    by_parts, by_hand = ss.solve(robot, periods=60), ss.solve(flow, periods=60)
    assert abs(by_hand.mean_velocity - by_parts.mean_velocity) < ROUNDING and ss.mean_velocity(by_hand) == by_hand.mean_velocity
    moved = ss.motion(by_hand)
    assert (moved.type, moved.period) == ("periodic", 1) and abs(moved.mean_velocity - by_parts.mean_velocity) < ROUNDING
    assert abs(ss.analysis.periodic_mean_velocity(flow) - ss.analysis.periodic_mean_velocity(robot)) < ROUNDING
    one, other = ss.periodic_orbit(robot), ss.periodic_orbit(flow)
    assert other.multipliers.shape == one.multipliers.shape and abs(other.multipliers - one.multipliers).max() < ROUNDING
    assert abs(other.state[1] - one.state[0]) < ROUNDING and other.state[0] == 0.0
    assert abs(other.mean_velocity - one.mean_velocity) < ROUNDING


def test_basins_batches_and_exponents_know_the_mean_velocity():
    robot, flow = robot_and_flow()
    speeds = np.linspace(-2, 2, 5)
    (one,), (other,) = (ss.basins(model, v=speeds).attractors for model in (robot, flow))
    assert abs(other.mean_velocity - one.mean_velocity) < ROUNDING and (one.kind, one.period) == (other.kind, other.period)
    many = ss.solve(flow.replace(A=[2.0, 3.0]), periods=40)
    assert abs(many.mean_velocity[0] - one.mean_velocity) < 1e-9  # the mean over twenty periods, after twenty: 0.04^20 is left
    assert many.period.tolist() == [1, 1]
    one, other = ss.lyapunov(robot, periods=40), ss.lyapunov(flow, periods=40)
    assert other.spectrum.shape == one.spectrum.shape and abs(other.spectrum - one.spectrum).max() < 1e-9


def test_a_block_pulled_along_is_a_block_on_a_belt():
    law = ss.Coulomb(mu_plus=1.0, mu_minus=1.0, f_plus=1.5, f_minus=1.5)
    belt = ss.periodic_orbit(ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=law))
    ground = ss.machines.FlowContact(slip=lambda t, y: y[2], friction=law, load=1.0)

    def rates(t, y, R):
        return (y[2], 0.1 - y[2], 2.0 * y[1] - R.ground)

    pulled = ss.periodic_orbit(ss.SwitchingFlow(rates, states=("x", "d", "v"), contacts={"ground": ground}, cyclic="x"))
    assert abs(pulled.duration - belt.duration) < 1e-12 * belt.duration and pulled.multipliers.tolist() == belt.multipliers.tolist()
    assert abs(pulled.mean_velocity - 0.1) < ROUNDING


def test_an_angle_counts_modulo_a_turn():
    """In step with its drive a rotor makes a turn in each period; without `cyclic` it never comes back."""
    flow = rotor({"angle": 2 * np.pi})
    run = ss.solve(flow, periods=120, start={"angle": 30.0 * np.pi, "v": 2.0})
    assert ss.motion(run).period == 1 and abs(run.mean_velocity - 2.0) < 1e-9
    orbit = ss.periodic_orbit(flow, guess={"angle": 0.3, "v": 2.0})
    assert orbit.stable and abs(orbit.mean_velocity - 2.0) < ROUNDING and orbit.residual < 1e-11
    found = {round(float(a.mean_velocity), 9): a.kind for a in ss.basins(flow, angle=[0.0, 3.1, -3.1], v=[0.0, 2.0, 4.0]).attractors}
    assert found[2.0] == "periodic"
    assert ss.motion(ss.solve(rotor(None), periods=120, start={"v": 2.0})).type == "not settled"


def test_points_near_where_an_angle_begins_anew_are_one():
    cyclic = ss.SwitchingFlow(lambda t, y: (1.0,), period=1.0, states=("phase",), cyclic={"phase": 1.0})
    run = ss.solve(cyclic, periods=40, start={"phase": 0.5})  # it stands on the seam at every strobe
    assert ss.motion(run).period == 1 and abs(run.mean_velocity - 1.0) < ROUNDING
    assert ss.solve(cyclic, periods=40, start={"phase": 0.5}, keep="summary").period == 1


@each_row(
    "cyclic, said",
    [
        ("angle", "fields[0] depends on 'angle'"),
        ("v", "fields[0] depends on 'v'"),
        ({"angle": 3.0}, "does not repeat when 'angle' grows by 3"),
        ({"angle": lambda n: n.w * np.pi + 1e-3}, "does not repeat"),
        ("speed", "'speed', which is not a state"),
        ({"angle": -1.0}, "allowed is a positive length"),
        ({"angle": [1.0, 2.0]}, "the same for all cases"),
        (3, "allowed are names of states"),
    ],
)
def test_what_is_not_cyclic_is_refused(cyclic, said):
    with pytest.raises(ss.InputError, match="cyclic") as refused:
        ss.solve(rotor(cyclic), periods=2)
    assert said in str(refused.value)


def test_resets_guards_and_conditions_are_asked_too():
    """A dependence that plain numbers do not show, beyond x = 1000, is in the trace; a reset may carry the coordinate along."""

    def hit(reset):
        return {0: (ss.Switch(lambda t, y: y[1], 0, reset),)}

    field = {0: lambda t, y: (1.0, -1.0)}
    ss.solve(ss.SwitchingFlow(field, hit(lambda t, y: (y[0] + 0.5, 1.0)), states=("x", "h"), cyclic="x"), start=[0.0, 1.0], duration=3.0)
    far = {0: lambda t, y: (1.0, ss.maths.where(y[0] > 1000.0, 1.0, -1.0))}
    wrong = [
        (field, hit(lambda t, y: (0.0, 1.0)), "switches[0][0].reset"),
        (field, hit(lambda t, y: (y[0], 1.0 + y[0])), "switches[0][0].reset"),
        (field, {0: (ss.Switch(lambda t, y: y[0] - 5.0, 0),)}, "switches[0][0].guard"),
        (far, None, "fields[0]"),
    ]
    for fields, switches, name in wrong:
        with pytest.raises(ss.InputError) as refused:
            ss.solve(ss.SwitchingFlow(fields, switches, states=("x", "h"), cyclic="x"), start=[0.0, 1.0], duration=1.0)
        assert f"{name} depends on 'x'" in str(refused.value)


def test_a_section_is_cut_where_the_motion_comes_back():
    flow = ss.SwitchingFlow(lambda t, y: (y[1], y[2], -y[1]), states=("x", "v", "w"), cyclic="x")
    with pytest.raises(ss.InputError, match="'x' is not a name of the state"):
        ss.basins(flow, section="x", v=[0.5])
