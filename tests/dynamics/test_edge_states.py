"""Edge states against closed answers and the unstable branches of continuation, and attractors of flows and maps along a number."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import stickslip as ss
from stickslip.maths import cos, pi

CUBIC = ss.SwitchingFlow.of_map(lambda y, n: (n.r * y[0] - y[0] ** 3 + n.h,), {"r": 1.5, "h": 0.0}, ("x",))
FOLD = 2 * (0.5 / 3) ** 1.5  # of h: where h + (r - 1) x - x^3 has a double root
HARDENING = ss.SwitchingFlow(
    {0: lambda t, y, n: (y[1], -y[0] - y[0] ** 3 - 0.1 * y[1] + n.F * cos(n.w * t))}, {}, lambda n: 2 * pi / n.w,
    {"F": 0.3, "w": 1.5}, ("x", "v"),
)  # fmt: skip
WEAKENED = {"tilt_deg": 1.7, "f0": 0.5}


@dataclass(frozen=True, eq=False)
class Hardening(ss.Machine):
    """The same oscillator made of parts, and a light mass that it carries along."""

    friction: ss.Coulomb
    F: float = 0.3
    w: float = 1.5

    @property
    def period(self):
        return 2 * pi / self.w

    def bodies(self):
        return {"block": ss.Body(1.0, force=lambda t, x, v: self.F * cos(self.w * t)), "rider": ss.Body(1e-6)}

    def contacts(self):
        return {"rider": ss.Contact("rider", self.friction, on="block", load=1.0)}

    def links(self):
        return {("block", None): ss.Spring(1.0, damping=0.1, cubic=1.0)}


def _middle_root(h):
    return float(np.sort(np.roots([-1.0, 0.0, 0.5, h]).real)[1])


@pytest.mark.parametrize("h", [-0.12, -0.05, 0.0, 0.1])
def test_the_edge_of_a_map_is_the_middle_root_with_its_multiplier(h):
    edge = ss.dynamics.edge_state(CUBIC.replace(h=h), {"x": -1.0}, {"x": 1.0})
    root = _middle_root(h)
    assert (edge.kind, edge.period, edge.notes) == ("repeller", 1, ())
    assert abs(edge.state[0] - root) <= edge.accuracy < 1e-10
    assert edge.multipliers == pytest.approx([1.5 - 3 * root**2], abs=6 * edge.accuracy)
    assert edge.sides == ("the first motion, period 1", "the second motion, period 1") and edge.miss < 1e-8


def test_the_edge_of_a_flow_is_on_the_unstable_branch_between_its_folds():
    """The branch is followed from the large motion through the fold at w = 1.7797, and comes back below it with no bisection."""
    found = ss.basins(HARDENING.replace(w=1.7), x=[-2.0, 0.0, 2.0], v=[-2.0, 0.0, 2.0], settle=100)
    edge = ss.dynamics.edge_state(found.model, *found.attractors, settle=100)
    branch = ss.continuation(HARDENING, parameter="w", start=1.65, stop=1.85, step=0.05, guess={"x": 0.77, "v": 2.1}, points=30)
    unstable = [k for k, orbit in enumerate(branch.orbits) if orbit.stability == "unstable"]
    assert branch.orbits[0].stable and branch.special[0].kind == "fold" and unstable
    nearest = min(unstable, key=lambda k: abs(branch.values[k] - 1.7))
    there = ss.periodic_orbit(found.model, guess=branch.orbits[nearest])
    assert edge.kind == "saddle" and edge.miss < 1e-2 and edge.accuracy < 1e-10
    np.testing.assert_allclose(edge.state, there.strobe_state, atol=1e-9)
    assert edge.multipliers == pytest.approx(there.multipliers, rel=1e-7)


def test_a_machine_made_of_parts_has_the_edge_of_the_flow():
    """A rider that never slips adds 1e-6 of the mass, which moves the orbit by about as much."""
    machine = Hardening(ss.Coulomb(50.0, 50.0))
    assert np.isfinite(ss.solve(machine, periods=2).v).all()
    high, low = {"x": {"block": 0.8, "rider": 0.8}, "v": {"block": 1.7, "rider": 1.7}}, None
    edge = ss.dynamics.edge_state(machine, high, low, settle=100)
    flow = ss.dynamics.edge_state(HARDENING, {"x": 0.8, "v": 1.7}, {"x": 0.0}, settle=100)
    block = [edge.names.index(name) for name in ("x.block", "v.block")]
    np.testing.assert_allclose(edge.state[block], flow.state[:2], atol=3e-5)
    assert edge.multipliers[0] == pytest.approx(flow.multipliers[0], rel=1e-4)


@pytest.mark.slow
def test_the_edge_of_the_rig_is_on_the_unstable_branch_between_its_folds():
    """LuGre, f0 = .5: slow and fast motions at A = 0.8 mm, and the unstable branch beside the fold where the fast one begins."""
    robot = ss.presets.piezo_rig(amplitude=8e-4, **WEAKENED)
    edge = ss.dynamics.edge_state(robot, {"v": 1.5e-4, "z": -4.6e-8}, {"v": 0.1, "z": 1e-6}, settle=80)
    start = ss.periodic_orbit(ss.presets.piezo_rig(amplitude=8.0047e-4, **WEAKENED), guess=[-7.189e-3, -3.7045e-7])
    branch = ss.continuation(ss.presets.piezo_rig, parameter="amplitude", start=8.0047e-4, stop=7.99e-4, guess=start, **WEAKENED)
    there = branch.at(8e-4)
    assert edge.kind == "saddle"
    assert edge.multipliers[0] == pytest.approx(there.multipliers[0], rel=1e-7)
    np.testing.assert_allclose(edge.state, there.state, rtol=1e-8)
    assert {side.partition("V = ")[2] for side in edge.sides} == {"0.002005917 m/s", "0.003552104 m/s"}


def test_a_chaotic_edge_is_not_called_periodic_and_its_track_stays_on_the_border():
    """y doubles or settles at about -0.7 or 0.7 while x moves chaotically: the border is invariant and attracts nothing periodic."""
    driven = lambda y: (3.9 * y[0] * (1 - y[0]), 1.5 * y[1] - y[1] ** 3 + 0.1 * (y[0] - 0.5))  # noqa: E731
    edge = ss.dynamics.edge_state(ss.SwitchingFlow.of_map(driven, states=("x", "y")), [0.3, -0.7], [0.3, 0.7], periods=8)
    assert edge.kind == "not periodic" and edge.orbit is None and edge.period == 0 and not edge.multipliers.size
    assert "does not repeat within 32 periods" in edge.notes[0] and len(edge.track) == 9
    for x, y, _ in edge.track[::2]:
        for side in (-1, 1):
            state = (x, y + side * 1e-3)
            for _ in range(40):
                state = driven(state)
            assert np.sign(state[1]) == side


def test_a_border_where_the_map_jumps_is_said_to_be_no_motion():
    jumping = ss.SwitchingFlow.of_map(lambda y: (0.5 * y[0] + (1.0 if y[0] > 0.1 else -1.0),), states=("x",))
    edge = ss.dynamics.edge_state(jumping, [-1.0], [1.0])
    assert edge.kind == "jump" and edge.state[0] == pytest.approx(0.1, abs=1e-9) and "jumps at the border" in edge.notes[0]


def test_a_third_basin_between_two_starts_is_said():
    """sin has rests at 0, 2 pi and 4 pi with borders at pi and 3 pi: between 0 and 4 pi lies the basin of 2 pi."""
    from stickslip.maths import sin

    wells = ss.SwitchingFlow({0: lambda t, y: (-sin(y[0]),)}, {}, 1.0, states=("x",))
    edge = ss.dynamics.edge_state(wells, {"x": 0.1}, {"x": 12.5})
    assert edge.state[0] % (2 * np.pi) == pytest.approx(np.pi, abs=1e-9)
    assert edge.multipliers == pytest.approx([np.e], rel=1e-9)
    assert "another motion" in edge.sides[1] and "the basin of another motion" in edge.notes[0]


def test_the_edge_of_what_nothing_drives_needs_no_more_than_a_time_between_two_looks():
    """A saddle with its two exponents."""
    wells = ss.SwitchingFlow({0: lambda t, y: (y[1], y[0] - y[0] ** 3 - 0.5 * y[1])}, {}, 1.0, {}, ("x", "v"))
    saddle = ss.dynamics.edge_state(wells, {"x": -0.9, "v": 0.2}, {"x": 1.2}, settle=20)
    assert saddle.kind == "saddle" and saddle.state[:2] == pytest.approx([0.0, 0.0], abs=1e-10)
    assert np.log(saddle.multipliers) == pytest.approx(-0.25 + np.sqrt(0.0625 + 1.0) * np.array([1.0, -1.0]), abs=1e-8)


@pytest.mark.slow
def test_the_edge_between_rest_and_a_cycle_is_the_unstable_cycle_of_known_radius():
    def round_about(t, y):
        r2 = y[0] ** 2 + y[1] ** 2
        growth = -0.5 + r2 - 0.25 * r2**2
        return growth * y[0] - 2.0 * y[1], growth * y[1] + 2.0 * y[0]

    cycle = ss.dynamics.edge_state(
        ss.SwitchingFlow({0: round_about}, {}, 1.0, {}, ("x", "y")), {"x": 0.1}, {"x": 1.8}, periods=3, settle=60
    )
    assert cycle.kind == "not periodic" and np.hypot(*cycle.state[:2]) == pytest.approx(np.sqrt(2.0 - np.sqrt(2.0)), abs=1e-9)
    loop = ss.dynamics.flow_orbit(ss.SwitchingFlow({0: round_about}, {}, None, {}, ("x", "y")), cycle.state[:2], 0, duration=np.pi)
    assert max(abs(loop.multipliers)) > 1.0 and np.hypot(*loop.state[:2]) == pytest.approx(np.sqrt(2.0 - np.sqrt(2.0)), abs=1e-9)


def test_edges_on_basins_and_their_tracks_are_drawn():
    found = ss.basins(HARDENING, x=np.linspace(-2, 2, 5), v=np.linspace(-2, 2, 5), settle=100)
    edge = ss.dynamics.edge_state(HARDENING, *found.attractors, settle=100)
    ax = found.plot(edges=edge)
    assert ax.lines[-1].get_marker() == "x" and ax.lines[-1].get_xdata()[0] == edge.state[0]
    assert not any("nan" in text.get_text() for text in ax.get_legend().get_texts())
    assert edge.plot().get_xlabel() == "x on the strobe" and "saddle" in edge._repr_html_()
    with pytest.raises(ss.InputError, match=r"edges = 3; allowed are edge states with x and v"):
        found.plot(edges=3)


def test_what_to_type_for_an_edge():
    with pytest.raises(ss.InputError, match=r"both starts lead to one motion, period 1; .*type ss\.basins"):
        ss.dynamics.edge_state(CUBIC, {"x": 0.5}, {"x": 1.0})
    with pytest.raises(ss.InputError) as wrong:
        ss.dynamics.edge_state(CUBIC, {"x": -1.0}, {"x": 1.0}, periods=0, settle=-1, rtol=2.0)
    assert len(wrong.value.problems) == 3
    with pytest.raises(ss.SolveError, match="the run from the second start runs away"):
        ss.dynamics.edge_state(CUBIC, {"x": -1.0}, {"x": 5.0})


def test_attractors_of_a_map_begin_and_end_at_its_folds_and_share_the_starts_at_the_middle_root():
    """Starts from -0.7 to 0.7 are cut at the unstable fixed point: the map rises there, so that nothing passes it."""
    d = ss.attractors(CUBIC, parameter="h", values=np.linspace(-0.2, 0.2, 9), starts={"x": np.linspace(-0.7, 0.7, 141)}, settle=300)
    lower, upper = d.isel(attractor=0), d.isel(attractor=1)
    h = d.h.values
    assert (lower.period.values > 0).tolist() == (h < FOLD).tolist() and (upper.period.values > 0).tolist() == (h > -FOLD).tolist()
    assert str(lower.ends.values) == "vanishes between 0.13125 and 0.1375; its last state leads to attractor 1"
    assert str(upper.begins.values) == "appears between -0.15 and -0.1" and str(upper.ends.values) == "is there at the last value"
    for k in np.flatnonzero(abs(h) < FOLD):
        share = (0.7 - _middle_root(h[k])) / 1.4
        assert abs(float(upper.share[k]) - share) <= 1 / 141 and float(upper.share_low[k]) < share < float(upper.share_high[k])
    np.testing.assert_allclose(upper.x.values[h > -FOLD], [np.roots([-1, 0, 0.5, v]).real.max() for v in h[h > -FOLD]], atol=1e-6)


def test_attractors_of_a_flow_live_between_the_folds_of_its_branch():
    """The folds, 1.3242362 and 1.7797195, are those that ss.continuation locates on the branch."""
    starts = {"x": np.linspace(-2, 2, 5), "v": np.linspace(-2, 2, 5)}
    d = ss.attractors(HARDENING, parameter="w", values=[1.3, 1.35, 1.75, 1.8], starts=starts, settle=150)
    assert (d.period.values > 0).tolist() == [[True, True, True, False], [False, True, True, True]]
    assert str(d.ends.values[0]).startswith("vanishes between 1.775 and 1.78125"), "though no start on it stays there in one step"
    assert np.allclose(d.share.sum("attractor"), 1.0) and "mean_velocity" not in d
    assert ss.plot.attractors(d).get_ylabel() == "x on the strobe"


@pytest.mark.slow
def test_the_folds_between_which_attractors_live_are_those_of_the_branch():
    branch = ss.continuation(HARDENING, parameter="w", start=1.2, stop=2.0, step=0.1)
    assert sorted(s.value for s in branch.special) == pytest.approx([1.3242362007706, 1.7797195242986], abs=1e-9)
