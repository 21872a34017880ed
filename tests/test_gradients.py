"""`ss.gradient`: derivatives of what a machine does, against closed formulas, against differences, and beside changes of mode."""

import numpy as np
import pytest

import stickslip as ss
from stickslip.dynamics.named import numbers_meant
from stickslip.fields import leaves, replace_leaf

MODULE = ss.Robot(0.06259, 0.00948, ss.Harmonic(amplitude=6e-4, omega=65.4 * np.pi), ss.Coulomb(0.15, 0.21))
PAIR = ss.Chain((MODULE, MODULE), link=ss.Spring(1200.0, 0.4), phases=(0.0, 2.0))


def test_names_stand_for_one_number_or_for_those_of_all_parts():
    known = [name for name, _ in leaves(PAIR)]
    assert numbers_meant("modules[1].drive.amplitude", known) == ("modules.1.drive.amplitude",)
    assert numbers_meant("modules.drive.amplitude", known) == ("modules.0.drive.amplitude", "modules.1.drive.amplitude")
    assert numbers_meant("phases[1]", known) == ("phases.1",)
    assert numbers_meant("*.mu_plus", known) == ("modules.0.friction.mu_plus", "modules.1.friction.mu_plus")
    assert numbers_meant("drive.amplitude", known) == ()


def test_two_modules_have_the_published_derivatives():
    # M2q: differences of two steps of another solver, nine digits
    slopes = ss.gradient(
        PAIR, "mean_velocity", wrt=["phases[1]", "modules.friction.mu_plus", "link.stiffness", "modules[1].drive.amplitude"]
    )
    assert slopes["phases[1]"] == pytest.approx(0.0084111490, abs=1e-10)
    assert slopes["modules.friction.mu_plus"] == pytest.approx(-0.2055046907, abs=1e-10)
    each = ss.gradient(PAIR, wrt=["modules[0].friction.mu_plus", "modules[1].friction.mu_plus"])
    assert sum(each.values()) == pytest.approx(slopes["modules.friction.mu_plus"], rel=1e-9)


def test_derivatives_of_two_phases_are_those_of_the_formula():
    # V = mu^2 U^3 (1/mu_plus - 1/mu_minus) / (g L) for u1 = u2 = U where both phases end at rest
    mu, U, L, g = 0.1315, 0.2, 0.01, 9.81
    robot = ss.Robot(1.0 - mu, mu, ss.TwoPhase(stroke=L, u1=U, u2=U), ss.Coulomb(0.15, 0.25))
    slopes = ss.gradient(robot, wrt=["drive.stroke", "friction.mu_plus", "friction.mu_minus", "gravity"])
    V = mu**2 * U**3 * (1 / 0.15 - 1 / 0.25) / (g * L)
    assert slopes.value == pytest.approx(V, rel=1e-12)
    assert slopes["drive.stroke"] == pytest.approx(-V / L, rel=1e-10)
    assert slopes["gravity"] == pytest.approx(-V / g, rel=1e-10)
    assert slopes["friction.mu_plus"] == pytest.approx(-(mu**2) * U**3 / 0.15**2 / (g * L), rel=1e-10)
    assert slopes["friction.mu_minus"] == pytest.approx(mu**2 * U**3 / 0.25**2 / (g * L), rel=1e-10)


def _richardson(robot, name, step):
    """Differences of runs from rest, which share nothing with the tangent but the solver."""
    own = float(dict(leaves(robot))[name])
    sides = own + step * np.array([1.0, -1.0, 0.5, -0.5])
    V = ss.solve(replace_leaf(robot, {name: sides}), periods=400, settle="auto", keep="summary", rtol=1e-10).mean_velocity
    return (4 * (V[2] - V[3]) / step - (V[0] - V[1]) / (2 * step)) / 3


@pytest.mark.parametrize(
    ("robot", "tolerance"),
    [(MODULE, 1e-7), (ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4), 1e-5)],
    ids=["exact", "LuGre"],
)
def test_gradients_are_those_of_differences(robot, tolerance):
    names = ["drive.amplitude", "drive.omega", "body_mass"]
    slopes = ss.gradient(robot, wrt=names)
    for name in names:
        own = float(dict(leaves(robot))[name])
        # a step of 1e-3 leaves (1e-3)^4 of a function that changes over its own size, and tolerance 1e-10 / 1e-3 of rounding
        assert slopes[name] == pytest.approx(_richardson(robot, name, 1e-3 * own), rel=tolerance, abs=tolerance * robot.free_velocity / own)
    assert not slopes.notes


@pytest.mark.slow
def test_gradients_are_those_of_differences_on_random_robots():
    rng, worst, tried = np.random.default_rng(20), 0.0, 0
    for _ in range(400):
        drive = [
            ss.Harmonic(rng.uniform(2e-4, 9e-4), rng.uniform(150, 260)),
            ss.TwoPhase(0.01, rng.uniform(0.05, 0.4), rng.uniform(0.05, 0.4)),
            ss.ThreePhase(u1=rng.uniform(0.2, 0.5), w1=rng.uniform(5, 18), w2=rng.uniform(20, 60), w3=rng.uniform(5, 60)),
        ][rng.integers(3)]
        robot = ss.Robot(0.0626, 0.0095, drive, ss.Coulomb(rng.uniform(0.1, 0.2), rng.uniform(0.15, 0.25)))
        name = rng.choice([name for name, _ in leaves(robot) if name.startswith(("drive", "friction.mu", "body"))])
        slopes = ss.gradient(robot, wrt=str(name))
        own = float(dict(leaves(robot))[name])
        pair = [_richardson(robot, name, step * own) for step in (1e-4, 5e-5)]
        if slopes.notes or abs(pair[0] - pair[1]) * own > 1e-9 * robot.free_velocity:
            continue  # beside a border
        tried += 1
        worst = max(worst, abs(slopes[str(name)] - pair[1]) * own / robot.free_velocity)
    assert tried > 300
    assert worst < 1e-7


def test_cost_of_transport_without_rest_does_not_depend_on_the_amplitude():
    # type IV: both ways grow with the amplitude alike, and the cost is that of their ratio
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    slopes = ss.gradient(robot, "cost_of_transport", wrt=["drive.amplitude", "friction.mu_plus"])
    assert slopes.value == pytest.approx(0.43230907, rel=1e-7)
    assert abs(slopes["drive.amplitude"] * 8e-4) < 1e-7
    cost = [
        ss.gradient(robot.replace({"friction.mu_plus": robot.friction.mu_plus + h}), "cost_of_transport", "gravity").value
        for h in (-1e-5, 1e-5)
    ]
    assert slopes["friction.mu_plus"] == pytest.approx((cost[1] - cost[0]) / 2e-5, rel=1e-6)


def test_beside_a_change_of_modes_the_derivative_is_one_sided_and_says_so():
    # with w1 = mu_minus g / mu the body waits on the verge of slipping back
    mu = 0.1315
    robot = ss.Robot(1.0 - mu, mu, ss.ThreePhase(u1=0.5, w1=0.25 * 9.81 / mu, w2=60.0, w3=60.0), ss.Coulomb(0.15, 0.25))
    slopes = ss.gradient(robot, wrt=["drive.w1", "drive.w3"])
    assert any(note.startswith("drive.w1: one-sided") for note in slopes.notes)
    assert not any(note.startswith("drive.w3") for note in slopes.notes)


def test_bad_input_of_gradients_is_told():
    with pytest.raises(ss.InputError, match=r"drive.amplitude"):
        ss.gradient(MODULE, wrt="drive.amplitud")
    with pytest.raises(ss.InputError, match="did you mean 'mean_velocity'"):
        ss.gradient(MODULE, "mean_velocit")
    with pytest.raises(ss.InputError, match="one robot"):
        ss.gradient(MODULE.replace({"body_mass": [0.05, 0.06]}))
    with pytest.raises(ss.InputError, match="has no period"):
        ss.gradient(ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)))


def test_a_small_normal_spread_goes_through_by_the_slope():
    slope = ss.gradient(MODULE, wrt="friction.mu_plus")["friction.mu_plus"]
    found = ss.propagate(MODULE, uncertain={"friction.mu_plus": ("normal", 0.15, 1e-4)}, of="mean_velocity", samples=512)
    # the curvature changes the standard deviation by its square times 1e-8 of that, and 512 Sobol points know it to a percent
    assert found.std == pytest.approx(abs(slope) * 1e-4, rel=2e-2)
    assert found.mean == pytest.approx(found.nominal, abs=0.02 * found.std)
    assert found.failed == 0


def test_a_uniform_number_takes_the_result_from_end_to_end():
    found = ss.propagate(MODULE, uncertain={"friction.mu_plus": ("uniform", 0.14, 0.16)}, samples=512)
    ends = [float(ss.periodic_orbit(MODULE.replace({"friction.mu_plus": mu})).mean_velocity) for mu in (0.14, 0.16)]
    assert found.inputs["friction.mu_plus"].min() > 0.14
    assert max(ends) - min(ends) == pytest.approx(np.ptp(found.values), rel=1e-2)


def test_bad_input_of_spreads_is_told():
    for given, told in (
        ({"friction.mu": ("normal", 0.15, 0.01)}, "is no number"),
        ({"friction.mu_plus": ("normal", 0.15, -0.01)}, "allowed is"),
        ({"friction.mu_plus": (0.14, 0.16)}, "allowed is"),
        ({}, "allowed is a dict"),
    ):
        with pytest.raises(ss.InputError, match=told):
            ss.propagate(MODULE, uncertain=given)
    with pytest.raises(ss.InputError, match="in the sample"):
        ss.propagate(MODULE, uncertain={"body_mass": ("normal", 0.06, 0.06)})
