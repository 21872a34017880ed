"""The mode in which a flow begins: from its state, and one that is given may not contradict it."""

import numpy as np
import pytest

import stickslip as ss
from rows import each_row

LAW = ss.Coulomb(mu_plus=0.2, mu_minus=0.2)
BELT = ss.machines.FlowContact(slip=lambda t, y: y[1] - 0.1, friction=LAW, load=9.81)
BLOCK = ss.SwitchingFlow(lambda t, y, R: (y[1], -4.0 * y[0] - R.belt), states=("x", "v"), contacts={"belt": BELT})


def room():
    """A ball between walls at 0 and 1 in one mode, and beyond the right one in another: each wall turns the velocity round."""

    def turned(t, y):
        return (y[0], -y[1])

    def fly(t, y):
        return (y[1], 0.0)

    inside = (ss.Switch(lambda t, y: y[0], "inside", turned), ss.Switch(lambda t, y: 1.0 - y[0], "inside", turned))
    outside = (ss.Switch(lambda t, y: y[0] - 1.0, "outside", turned),)
    return ss.SwitchingFlow({"inside": fly, "outside": fly}, {"inside": inside, "outside": outside}, states=("x", "v"))


def test_the_mode_follows_from_the_state_through_every_door():
    flow, starts = room(), np.array([0.5, 1.5])
    modes = [ss.solve(flow, start={"x": x, "v": 0.25}, duration=1.0).mode[0] for x in starts]
    assert modes == ["inside", "outside"]
    swept = ss.sweep(flow, **{"start.x": starts}, start={"v": 0.25}, duration=1.0)
    assert swept.end_mode.values.tolist() == [0, 1] and swept.switches.values.tolist() == [0, 0]
    assert [ss.simulation(flow, {"x": x, "v": 0.25}).state["mode"] for x in starts] == modes
    many = ss.solve(room(), start={"x": 1.5, "v": -1.0}, duration=1.0, keep="summary")
    assert abs(many.end_x - 1.5) < 1e-12 and int(many.switches) == 1  # to the wall and back


def test_starts_of_basins_are_in_their_modes():
    """Two wells apart, each with a wall that returns what comes to it: a start beyond the wall belongs to the well there."""

    def back(t, y):
        return (y[0], -0.5 * y[1])

    left = {"left": lambda t, y: (y[1], -(y[0] + 1.0) - 0.5 * y[1]), "right": lambda t, y: (y[1], -(y[0] - 1.0) - 0.5 * y[1])}
    walls = {"left": (ss.Switch(lambda t, y: -y[0], "left", back),), "right": (ss.Switch(lambda t, y: y[0], "right", back),)}
    basins = ss.basins(ss.SwitchingFlow(left, walls, 1.0, states=("x", "v")), x=[-1.5, -0.5, 0.5, 1.5], v=[0.1])
    places = sorted(round(float(a.state[0]), 6) for a in basins.attractors)
    assert places == [-1.0, 1.0] and [round(a.share, 9) for a in basins.attractors] == [0.5, 0.5]


@each_row(
    "flow, start, mode, said",
    [
        (room(), {"x": 1.5, "v": 0.25}, "inside", r"reset would make"),
        (room(), {"x": -0.5, "v": 0.25}, None, r"reset would make"),
        (BLOCK, {"x": 0.0, "v": 0.3}, "belt-", r"slip of 'belt' is 0.2 there, which is belt\+.*type mode='belt\+'"),
        (BLOCK, {"x": 0.0, "v": 0.3}, "belt0", r"contradicts the start"),
        (
            ss.SwitchingFlow({1: lambda t, y: (-1.0,), -1: lambda t, y: (1.0,)}, {1: (ss.Switch(lambda t, y: y[0], -1),)}, states=("x",)),
            {"x": -0.5},
            1,
            r"guard of switches\[1\]\[0\] is -0.5",
        ),
    ],
)
def test_a_mode_that_contradicts_the_state_is_refused(flow, start, mode, said):
    given = {} if mode is None else {"mode": mode}
    with pytest.raises(ss.InputError, match=said):
        ss.solve(flow, start=start, duration=1.0, **given)


def test_a_mode_on_its_border_is_taken():
    """What rounding puts beyond a guard or a slip of zero is on it: runs go on from where others end."""
    for v in (0.1, 0.1 * (1 + 1e-14), 0.1 * (1 - 1e-14)):
        run = ss.solve(BLOCK, start={"x": 0.2, "v": v}, mode="belt0", duration=0.1)
        assert abs(run["v"][-1] - 0.1) < 1e-12
