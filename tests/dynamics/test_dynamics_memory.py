"""Laws that remember whole numbers: the strobe state with its memories, orbits, branches, exponents, basins, against second methods."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from slipping_elements import oscillator
from stickslip.basics.fields import replace_leaf
from stickslip.dynamics.derivatives.tangents import jacobian_of
from stickslip.dynamics.stroboscopic.differences import at_limits, difference_jacobian
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, strobe_map, strobe_states
from stickslip.maths import where

GMS = ss.friction.GMS(0.15, 0.21, 0.18, 0.24, sigma0=4e5, v_s=2e-3, attraction=100.0, sigma2=0.04)
RESET = ss.friction.ResetIntegrator(mu_plus=0.15, mu_minus=0.21, f_plus=0.18, f_minus=0.24, sigma0=4e5, sigma1=100.0)


@dataclass(frozen=True)
class Clipped:
    """A spring whose deflection stays at its limit, written with `where` instead of a memory."""

    limit: float
    states = 1

    def rate(self, v, z, load):
        return v * where((abs(z) >= self.limit * load) & (v * z > 0), 0.0, 1.0)

    def force(self, v, z, zdot, load):
        return z


def rig(law, amplitude=6e-4):
    return ss.presets.piezo_rig(tilt_deg=0.0, amplitude=amplitude).replace(friction=law)


def in_scales(robot, J):
    scales = coordinates(robot).scales[: len(J)]
    return J / scales[:, None] * scales


def test_a_run_goes_on_from_its_strobe_state_and_memory():
    """Thirty periods at once, and the last ten from what the first twenty left: to the tolerance of the runs."""
    robot = rig(GMS, 5e-4)
    whole = ss.solve(robot, periods=30, rtol=1e-10)
    names = coordinates(robot).names
    assert names == ("v", "z0", "z1", "z2", "z3", "memory0", "memory1", "memory2", "memory3")
    state = strobe_states(whole)[20]
    assert state[5:].tolist() == [1.0] * 4, "all elements slip on the strobe"
    start = coordinates(robot).start(state)
    on = ss.solve(robot, periods=10, rtol=1e-10, start=start)
    scales = coordinates(robot).scales
    np.testing.assert_allclose(strobe_states(on)[-1] / scales, strobe_states(whole)[-1] / scales, atol=1e-8)
    assert strobe_map(robot, state[None, :], 10, 1e-10).state[0, 5:].tolist() == strobe_states(whole)[-1][5:].tolist()
    # without its memory the same state goes elsewhere
    bare = ss.solve(robot, periods=1, rtol=1e-10, start={**start, "memory": 0.0})
    assert np.max(abs(strobe_states(bare)[-1] - strobe_states(whole)[21])[:5] / scales[:5]) > 1e-6


def test_plain_python_begins_with_the_same_memory():
    """The judge, which shares no line with the engine."""
    robot = rig(RESET.replace(sigma0=2e4, sigma1=20.0), 8e-4)
    state = strobe_states(ss.solve(robot, periods=5, rtol=1e-9))[-1]
    start = coordinates(robot).start(state)
    assert state[-1] != 0
    ends = [strobe_states(ss.solve(robot, periods=1, settle=0, rtol=1e-8, method=method, start=start))[-1] for method in ("auto", "radau")]
    np.testing.assert_allclose(ends[1] / coordinates(robot).scales, ends[0] / coordinates(robot).scales, atol=1e-5)


@pytest.mark.parametrize(
    ("law", "amplitude"), [(GMS, 3.5e-4), (GMS, 8e-4), (RESET, 3.5e-4), (RESET, 6e-4), (RESET, 8e-4)], ids=lambda x: str(x)[:5]
)
def test_orbits_and_multipliers_of_laws_with_memory(law, amplitude):
    """The tangent through every switch is the derivative of the map, by differences of two sizes."""
    robot = rig(law, amplitude)
    orbit = ss.periodic_orbit(robot)
    assert orbit.residual < 1e-12 and orbit.stable and "switch" in [event.kind for event in orbit.events]
    assert orbit.mean_velocity == pytest.approx(ss.mean_velocity(ss.solve(robot, periods=100, rtol=1e-9)), rel=1e-6)
    for step in (1e-6, 1e-5):
        J = difference_jacobian(robot, orbit.state, step=step)
        np.testing.assert_allclose(in_scales(robot, orbit.monodromy), in_scales(robot, J), atol=1e-6)
    np.testing.assert_allclose(np.sort(np.real(orbit.multipliers)), np.sort(orbit.differences.real), atol=1e-6)


@each_row("law", [GMS, RESET], ids=["gms", "reset"])
def test_the_derivative_is_right_away_from_orbits_too(law):
    robot = rig(law, 4e-4)
    state = strobe_map(robot, np.zeros((1, len(coordinates(robot).names))), 5).state[0]
    J = difference_jacobian(robot, state, step=1e-6)
    np.testing.assert_allclose(in_scales(robot, jacobian_of(robot, state)), in_scales(robot, J), atol=2e-6)


def test_a_reset_forgets():
    orbit = ss.periodic_orbit(rig(RESET, 8e-4))
    assert float(orbit.multipliers[-1]) == pytest.approx(0.0, abs=1e-15)
    found = ss.lyapunov(rig(RESET, 8e-4), periods=20, settle=20)
    assert found.spectrum[-1] == -math.inf and "anew" in found.note
    assert found.largest == pytest.approx(math.log(abs(orbit.multipliers[0])), abs=1e-5)


def test_exponents_two_ways():
    """The tangent, and two neighbours in the batch kernel."""
    robot = rig(GMS, 8e-4)
    orbit = ss.periodic_orbit(robot)
    found = ss.lyapunov(robot, periods=20, settle=20)
    other, _ = ss.dynamics.largest_exponents(robot, periods=20, settle=20)
    expected = math.log(abs(orbit.multipliers[0]))
    assert found.largest == pytest.approx(expected, abs=1e-5) and float(other[0]) == pytest.approx(expected, abs=1e-3)


def test_a_branch_goes_on_where_the_memory_on_the_strobe_changes():
    """Between 0.340 and 0.355 mm a second element begins to slip before t = 0; long runs agree on both sides."""
    b = ss.continuation(rig(GMS), parameter="drive.amplitude", start=3.4e-4, stop=3.55e-4, step=0.2)
    memories = [tuple(o.state[5:]) for o in b.orbits]
    assert "end of the range" in b.ended and (memories[0], memories[-1]) == ((1, 0, 0, 0), (1, 1, 0, 0))
    assert max(o.residual for o in b.orbits) < 1e-9
    for k in (0, -1):
        V = ss.mean_velocity(ss.solve(rig(GMS, float(b.values[k])), periods=100, rtol=1e-9))
        assert b.orbits[k].mean_velocity == pytest.approx(V, rel=1e-5)
    assert b.points.memory0.dims == ("point",)
    assert set(ss.plot.continuation(b, "memory1").lines[0].get_ydata()) == {0.0, 1.0}


@pytest.mark.slow
def test_a_corner_of_a_branch_is_passed():
    """At 0.361398 mm a new switch begins at a reversal: the branch has a corner there, and goes on."""
    b = ss.continuation(rig(GMS), parameter="drive.amplitude", start=3.6e-4, stop=3.63e-4, step=0.2)
    assert "end of the range" in b.ended and max(o.residual for o in b.orbits) < 1e-9
    switches = [sum(event.kind == "switch" for event in o.events) for o in (b.orbits[0], b.orbits[-1])]
    assert switches == [9, 10]
    again = ss.periodic_orbit(rig(GMS, 3.63e-4))
    np.testing.assert_allclose(b.orbits[-1].state, again.state, rtol=1e-6)


def test_brute_force_and_basins_know_the_memory():
    d = ss.bifurcation(rig(GMS), parameter="drive.amplitude", values=[3.5e-4, 4e-4], settle=40, points=8)
    orbit = ss.periodic_orbit(rig(GMS, 3.5e-4))
    assert (d.period == 1).all() and set(np.unique(d.memory0)) <= {0.0, 1.0}
    assert float(d.v[0, 0, -1]) == pytest.approx(orbit.state[0], abs=1e-6)
    assert float(d.mean_velocity[0, 0]) == pytest.approx(orbit.mean_velocity, rel=1e-5)
    found = ss.basins(rig(RESET), v=[-0.01], z=[-3.7e-7, 0.0], memory=[-1, 0], settle=40)
    assert found.map.attractor.dims == ("v", "z", "memory") and found.fractions == [1.0]
    assert found.attractors[0].orbit.stable


def test_following_along_an_axis_keeps_the_memory():
    """A case that goes on from its neighbour's end, memory and all, is where a run of both together is."""
    swept = ss.sweep(rig(GMS), continue_along="drive.amplitude", periods=30, rtol=1e-8, **{"drive.amplitude": [3.5e-4, 3.6e-4]})
    first = ss.solve(rig(GMS, 3.5e-4), periods=30, rtol=1e-8)
    on = ss.solve(rig(GMS, 3.6e-4), periods=30, rtol=1e-8, start=coordinates(rig(GMS)).start(strobe_states(first)[-1]))
    assert float(swept.mean_velocity.sel(way="up")[1]) == pytest.approx(ss.mean_velocity(on), rel=1e-6)


@pytest.fixture(scope="module")
def yielding():
    """Two Jenkins elements that both yield on the strobe."""
    return ss.periodic_orbit(oscillator((0.05, 0.2), 0.9, 0.4))


def test_where_elements_yield_on_the_strobe_the_derivative_is_the_one_sided_one_and_says_so(yielding):
    """Beyond its limit an element would go on in another way, so differences of both sides are of the size of 1/step."""
    robot, state = yielding.model, yielding.state
    assert state[2:].tolist() == pytest.approx([0.05, 0.2, 1.0, 1.0], abs=1e-12) and at_limits(robot, state) == ("z0", "z1")
    assert "one-sided: z0, z1 stand at a limit of the law" in yielding.evidence
    base, at = strobe_map(robot, state).state[0], coordinates(robot)
    for step in (1e-4, 1e-6):
        inwards = state - step * np.diag(at.scales)[: at.smooth]
        slopes = (base - strobe_map(robot, inwards).state)[:, : at.smooth].T / (step * at.scales[: at.smooth])
        np.testing.assert_allclose(in_scales(robot, yielding.monodromy), in_scales(robot, slopes), atol=20 * step + 1e-6)
        np.testing.assert_allclose(
            in_scales(robot, yielding.monodromy), in_scales(robot, difference_jacobian(robot, state, step=step)), atol=1e-5
        )
    np.testing.assert_allclose(yielding.multipliers, yielding.differences, atol=1e-6)


def test_sensitivities_where_elements_yield_are_those_of_neighbouring_orbits(yielding):
    robot, h = yielding.model, 1e-5
    found = ss.dynamics.sensitivity(yielding, wrt=["force", "omega", "damping", "friction.limits.0"])
    for row, name in zip(found.state, found.names, strict=True):
        value = float(found.values[found.names.index(name)])
        ends = [ss.periodic_orbit(replace_leaf(robot, {name: value + side * h})).state[:4] for side in (1, -1)]
        np.testing.assert_allclose(row, (ends[0] - ends[1]) / (2 * h), rtol=1e-5, atol=1e-5)


def test_a_state_beyond_the_limit_of_an_element_is_no_orbit(yielding):
    """From the orbit of wider limits Newton's method comes to an element that yields for ever, beyond its limit."""
    narrower = replace_leaf(yielding.model, {"friction.limits.0": 0.04999})
    with pytest.raises(ss.SolveError, match=r"z0 is beyond the limit at which a memory of the law switches.*guess=ss\.solve"):
        ss.periodic_orbit(narrower, guess=yielding)


def test_a_law_that_stands_at_a_limit_of_its_equations_has_no_exponents_and_says_so():
    found = ss.lyapunov(ss.ForcedOscillator(1.0, 1.0, 0.9, 0.4, friction=Clipped(0.2), load=1.0, damping=0.02), periods=20, settle=20)
    assert np.isnan(found.largest) and "touched without being crossed" in found.note


def test_chance_is_no_map():
    law = ss.friction.Bristle(mu_plus=0.15, mu_minus=0.21, sigma0=4e5)
    for act in (ss.periodic_orbit, ss.lyapunov, ss.basins):
        with pytest.raises(ss.InputError, match=r"random places.*ss\.friction\.GMS.*ss\.dynamics\.strobe"):
            act(rig(law))
    with pytest.raises(ss.InputError, match="random places"):
        ss.periodic_orbit(rig(law + ss.Viscous(0.1, 0.1)))


def test_a_memory_that_is_no_whole_number_is_refused():
    with pytest.raises(ss.InputError, match=r"whole numbers; type memory=\(0, 0, 0, 0\)"):
        ss.solve(rig(GMS), periods=1, start=dict(memory=0.5))
    with pytest.raises(ss.InputError, match="start has no 'memory'"):
        ss.solve(ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4), periods=1, start=dict(memory=1))
