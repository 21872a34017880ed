"""`ss.optimisation.gradient`: derivatives of what a machine does, against closed formulas, against differences,
and beside changes of mode."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.fields import leaves, replace_leaf
from stickslip.basics.number_names import numbers_meant
from stickslip.dynamics.derivatives.sensitivity import directions_of
from stickslip.dynamics.derivatives.tangents import jacobian_of
from stickslip.dynamics.stroboscopic.strobe_maps import coordinates, strobe_map
from stickslip.engine import lanes

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
    slopes = ss.optimisation.gradient(
        PAIR, "mean_velocity", wrt=["phases[1]", "modules.friction.mu_plus", "link.stiffness", "modules[1].drive.amplitude"]
    )
    assert slopes["phases[1]"] == pytest.approx(0.0084111490, abs=1e-10)
    assert slopes["modules.friction.mu_plus"] == pytest.approx(-0.2055046907, abs=1e-10)
    each = ss.optimisation.gradient(PAIR, wrt=["modules[0].friction.mu_plus", "modules[1].friction.mu_plus"])
    assert sum(each.values()) == pytest.approx(slopes["modules.friction.mu_plus"], rel=1e-9)


def test_derivatives_of_two_phases_are_those_of_the_formula():
    # V = mu^2 U^3 (1/mu_plus - 1/mu_minus) / (g L) for u1 = u2 = U where both phases end at rest
    mu, U, L, g = 0.1315, 0.2, 0.01, 9.81
    robot = ss.Robot(1.0 - mu, mu, ss.drives.TwoPhase(stroke=L, u1=U, u2=U), ss.Coulomb(0.15, 0.25))
    slopes = ss.optimisation.gradient(robot, wrt=["drive.stroke", "friction.mu_plus", "friction.mu_minus", "gravity"])
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


@each_row(
    ("robot", "tolerance"),
    [(MODULE, 1e-7), (ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4), 1e-5)],
    ids=["exact", "LuGre"],
)
def test_gradients_are_those_of_differences(robot, tolerance):
    names = ["drive.amplitude", "drive.omega", "body_mass"]
    slopes = ss.optimisation.gradient(robot, wrt=names)
    for name in names:
        own = float(dict(leaves(robot))[name])
        # a step of 1e-3 leaves (1e-3)^4 of a function that changes over its own size, and tolerance 1e-10 / 1e-3 of rounding
        assert slopes[name] == pytest.approx(_richardson(robot, name, 1e-3 * own), rel=tolerance, abs=tolerance * robot.free_velocity / own)
    assert not slopes.notes


@pytest.mark.slow
def test_gradients_are_those_of_differences_at_random_points_of_all_sorts_of_machines():
    """Some kinds of verification/random_gradients.py, where 1e-7 (exact) and 1e-5 (steps) of the change of V are derived."""
    folder = Path(__file__).parents[3] / "verification"
    spec = importlib.util.spec_from_file_location("random_gradients", folder / "random_gradients.py")
    module = importlib.util.module_from_spec(spec)
    sys.path.insert(0, str(folder))
    try:
        spec.loader.exec_module(module)
        names = [name for name in module.names(30) if name.partition(" #")[0] in SORTS]
        assert {name.partition(" #")[0] for name in names} == set(SORTS)  # the registries say what is drawn
        rows = [module.line(name, 8, 1, 60) for name in names]
    finally:
        sys.path.remove(str(folder))
    assert sum(row["points"] for row in rows) > 300
    assert not [row["missed"] for row in rows if row["missed"]]


SORTS = (
    "two modules", "capsule", "stage", "worm", "lugre+viscous · verticalvibration · varying friction",
    "tabulated+coulomb · recorded · incline", "capsule · dahl",
)  # fmt: skip


def test_all_gradients_take_a_run_two_calls_of_the_tangent_and_one_batch_beside(monkeypatch):
    """What a gradient costs is counted: a time would be another one on every machine."""
    calls, run = [], lanes.run

    def counted(kernel, rows, *args, **kwargs):
        calls.append(len(rows))
        return run(kernel, rows, *args, **kwargs)

    names = [name for name, _ in leaves(PAIR) if not name.endswith(("omega", "length"))]
    ss.optimisation.gradient(PAIR, wrt=names[:10])
    monkeypatch.setattr(lanes, "run", counted)
    ss.optimisation.gradient(PAIR, wrt=names[:10])
    # from rest one case; three states and ten directions, at most twice; and below, at and above each number
    assert calls[0] == 1
    assert set(calls[1:-1]) == {13}
    assert calls[-1] == 30
    assert len(calls) <= 4


def test_powers_states_and_means_of_a_users_own_have_exact_derivatives():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    own = [ss.observable(lambda s: s.v**2, reduce=reduce) for reduce in ("mean", "integral")]
    for of in ("friction_power", "drive_power", "cost_of_transport", "state.v", *own):
        _is_exact(robot, of, ["friction.mu_minus", "drive.omega"], 1e-9)


STEPS = (1e-3, -1e-3, 5e-4, -5e-4)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["chain", "jumps on an incline", "Stribeck", "LuGre"])
def test_powers_have_exact_derivatives_through_jumps_and_in_chains(name):
    law, own = ss.Stribeck(0.15, 0.21, f_plus=0.2, f_minus=0.25, v_s=0.02), ss.Coulomb(0.15, 0.25)
    machine, of, tolerance = {
        "chain": (PAIR, "friction_power.1", 1e-8),
        "jumps on an incline": (
            ss.Robot(0.0626, 0.0095, ss.drives.TwoPhase(0.01, 0.1, 0.3), own, track=INCLINE),
            0,
            1e-8,
        ),
        "Stribeck": (ss.Robot(0.0626, 0.0095, ss.drives.ThreePhase(0.01, 12.0, 40.0, 30.0), law, track=ss.Incline(-0.02)), 0, 1e-8),
        "LuGre": (ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4), 0, 1e-5),
    }[name]
    for quantity in [of] if of else ["friction_power", "drive_power", "cost_of_transport"]:
        _is_exact(machine, quantity, [number for number, value in leaves(machine) if value], tolerance)


def test_what_is_not_followed_is_found_by_differences_and_says_so():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    for of in ("forward_fraction", "multiplier"):
        slopes = ss.optimisation.gradient(robot, of, wrt="friction.mu_plus")
        assert any("differences" in note for note in slopes.notes)
    ends = [ss.periodic_orbit(robot.replace({"friction.mu_plus": robot.friction.mu_plus + h})).multipliers[0] for h in (-1e-5, 1e-5)]
    # central differences leave (1e-5)^2 of a third derivative, 1e-7 of the slope, and 1e-12 / 1e-5 of rounding
    assert slopes["friction.mu_plus"] == pytest.approx((abs(ends[1]) - abs(ends[0])) / 2e-5, rel=1e-5)


INCLINE = ss.Incline(0.02)
LARGEST_ACCELERATION = ss.observable(lambda s: s.acceleration, reduce="max")


def test_extremes_have_exact_derivatives_between_switches_and_at_corners():
    """A velocity is the largest where its rate is zero, or where it jumps by the drive; an acceleration where the body breaks away."""
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    for of in ("velocity_max", "velocity_min", LARGEST_ACCELERATION):
        _is_exact(robot, of, ["drive.amplitude", "drive.omega", "friction.mu_minus"], 1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["chain", "jumps", "Stribeck", "LuGre", "capsule"])
def test_extremes_have_exact_derivatives_in_all_sorts_of_machines(name):
    stroke = [ss.observable(lambda s: s.bodies["inner"].x - s.bodies["body"].x, reduce=reduce) for reduce in ("min", "max")]
    law, own = ss.Stribeck(0.15, 0.21, f_plus=0.2, f_minus=0.25, v_s=0.02), ss.Coulomb(0.15, 0.25)
    machine, quantities, tolerance = {
        "chain": (PAIR, ["velocity_max.0", "slip_min.1", ss.observable(lambda s: s.v[0] - s.v[1], reduce="max")], 1e-7),
        "jumps": (
            ss.Robot(0.0626, 0.0095, ss.drives.TwoPhase(0.01, 0.1, 0.3), own, track=INCLINE),
            ["velocity_max", "velocity_min"],
            1e-7,
        ),
        "Stribeck": (
            ss.Robot(0.0626, 0.0095, ss.drives.ThreePhase(0.01, 12.0, 40.0, 30.0), law),
            ["velocity_max", LARGEST_ACCELERATION],
            1e-7,
        ),
        "LuGre": (ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4), ["velocity_max", LARGEST_ACCELERATION], 1e-5),
        "capsule": (ss.presets.capsule(), ["velocity_max", "stop_force_max.0", *stroke], 1e-7),
    }[name]
    for of in quantities:
        _is_exact(machine, of, [number for number, value in leaves(machine) if value and not number.startswith("modules.0")], tolerance)


def _is_exact(machine, of, names, tolerance):
    """Against Richardson's extrapolation of values; its error is of the order (1e-3)^4, and theirs a thousandth of the tolerance."""
    names = [name for name in names if not name.endswith("exponent") and not (machine is PAIR and name.endswith("omega"))]
    slopes = ss.optimisation.gradient(machine, of, wrt=names)
    assert not slopes.notes
    for name in names:
        p = float(dict(leaves(machine))[name])
        values = [ss.optimisation.gradient(replace_leaf(machine, {name: p * (1 + h)}), of, wrt=name).value for h in STEPS]
        richardson = (4 * (values[2] - values[3]) / 1e-3 - (values[0] - values[1]) / 2e-3) / 3
        assert slopes[name] * p == pytest.approx(richardson, abs=tolerance * max(abs(slopes.value), abs(richardson))), (of, name)


def test_derivatives_are_columns_of_sweeps():
    slopes = {
        "dV": ss.optimisation.derivative("mean_velocity", "friction.mu_plus"),
        "dC": ss.optimisation.derivative("cost_of_transport", "drive.amplitude"),
        "dw": ss.optimisation.derivative("mean_velocity", "drive.omega"),
        "dv": ss.optimisation.derivative("state.v", "drive.amplitude", "1/ms"),
    }
    more = {"v_square": ss.observable(lambda s: s.v**2)}
    rig = {"tilt_deg": 1.7, "law": "coulomb"}
    grid = ss.sweep(ss.presets.piezo_rig, amplitude=[5e-4, 6e-4, 8e-4], observe=slopes, **rig)
    for i, amplitude in enumerate(grid.amplitude.values):
        robot = ss.presets.piezo_rig(amplitude=float(amplitude), **rig)
        assert float(grid.dV[i]) == pytest.approx(ss.optimisation.gradient(robot, wrt="friction.mu_plus")["friction.mu_plus"], rel=1e-9)
        found = ss.optimisation.gradient(robot, "cost_of_transport", wrt="drive.amplitude")
        assert float(grid.dC[i]) == pytest.approx(found["drive.amplitude"], abs=1e-9 * found.value / amplitude)
    units = {name: grid[name].attrs["units"] for name in slopes}
    assert units == {"dV": "m/s", "dC": "1/m", "dw": "m/s/(rad/s)", "dv": "1/ms"}  # of the result over the number's
    assert "friction.mu_plus" in grid.dV.attrs["long_name"]
    with pytest.raises(ss.InputError, match="column of sweeps"):
        ss.solve(ss.presets.piezo_rig(amplitude=[5e-4, 6e-4], **rig), observe=slopes | more)
    for bad, told in (
        ({"observe": {"a": ss.optimisation.derivative("mean_velocity", "friction.mu")}}, "which differ; type one"),
        ({"observe": {"a": ss.optimisation.derivative("stick_fraction", "friction.mu_plus")}}, "not derived over a grid"),
        ({"observe": slopes, "start": {"v": 0.1}}, "from rest"),
    ):
        with pytest.raises(ss.InputError, match=told):
            ss.sweep(ss.presets.piezo_rig, amplitude=[5e-4], **rig, **bad)


def test_cost_of_transport_without_rest_does_not_depend_on_the_amplitude():
    # type IV: both ways grow with the amplitude alike, and the cost is that of their ratio
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=8e-4, law="coulomb")
    slopes = ss.optimisation.gradient(robot, "cost_of_transport", wrt=["drive.amplitude", "friction.mu_plus"])
    assert slopes.value == pytest.approx(0.43230907, rel=1e-7)
    assert abs(slopes["drive.amplitude"] * 8e-4) < 1e-13
    cost = [
        ss.optimisation.gradient(robot.replace({"friction.mu_plus": robot.friction.mu_plus + h}), "cost_of_transport", "gravity").value
        for h in (-1e-5, 1e-5)
    ]
    assert slopes["friction.mu_plus"] == pytest.approx((cost[1] - cost[0]) / 2e-5, rel=1e-6)


def test_beside_a_change_of_modes_the_derivative_is_one_sided_and_says_so():
    # with w1 = mu_minus g / mu the body waits on the verge of slipping back
    mu = 0.1315
    robot = ss.Robot(1.0 - mu, mu, ss.drives.ThreePhase(u1=0.5, w1=0.25 * 9.81 / mu, w2=60.0, w3=60.0), ss.Coulomb(0.15, 0.25))
    slopes = ss.optimisation.gradient(robot, wrt=["drive.w1", "drive.w3"])
    assert any(note.startswith("drive.w1: one-sided") for note in slopes.notes)
    assert not any(note.startswith("drive.w3") for note in slopes.notes)


def test_a_number_that_moves_the_period_of_one_drive_alone_is_refused():
    # pieces of constant acceleration are the same a period later nearly always, also where one of them has become longer
    drive = ss.drives.Pieces(durations=(0.01, 0.02, 0.01), accelerations=(20.0, -15.0, 10.0))
    pair = ss.Chain((MODULE.replace(drive=drive), MODULE.replace(drive=drive)), link=ss.Spring(1200.0, 0.4), phases=(0.0, 2.0))
    with pytest.raises(ss.InputError, match=r"repeat after the period; .* such as '\*.durations.0'"):
        ss.optimisation.gradient(pair, wrt="modules[1].drive.durations[0]")
    assert "modules.1.drive.durations.0" not in directions_of("gradient", pair, None)
    assert directions_of("gradient", pair, ["modules.drive.durations[0]", "modules[1].drive.accelerations[0]"])


@pytest.mark.slow
def test_a_hit_that_turns_a_bristle_over_has_exact_derivatives():
    """A hit throws the body backwards, and in the same instant the bristle begins to be bent the other way."""
    drive = ss.machines.Forced(
        ss.drives.Pulses(34.33, period=0.04646, duty=0.13586), 348.45, 0.0528, stops=(ss.Stop(0.00825, 0.1914, side=-1),), reaction=False
    )
    machine = ss.Robot(0.12277, 0.034, drive, ss.Dahl(9.4202, 13.453, 64291.0, 1.3084), track=ss.Incline(-0.026446))
    hits, turns = ({e.t for e in ss.solve(machine, periods=50).events if e.kind == kind} for kind in ("hit", "reversal"))
    assert hits & turns
    _is_exact(machine, "mean_velocity", ["body_mass", "drive.stops.0.restitution", "friction.sigma0", "gravity"], 1e-5)


@pytest.mark.parametrize("exponent", [pytest.param(0.6, marks=pytest.mark.slow), 1.6])
def test_powers_of_the_speed_have_exact_derivatives_beside_reversals(exponent):
    """Their second derivatives have no end where the body turns over: the motion does not show it to rounding, its changes do."""
    law = ss.Stribeck(2.7e-4, 4.0e-4, f_plus=3.7e-4, f_minus=4.5e-4, v_s=9.3e-5, exponent=exponent, viscous=0.235)
    robot = ss.Robot(0.0994, 0.06, ss.Harmonic(amplitude=4e-4, omega=24.5), law, track=ss.Incline(5e-5))
    at, x, h = coordinates(robot), ss.periodic_orbit(robot).state, 1e-6 * robot.free_velocity
    ends = strobe_map(robot, [x - h, x + h]).state
    # central differences leave (1e-6)^2 of a third derivative, and 1e-15 / 1e-6 of rounding
    assert jacobian_of(robot, x)[0, 0] == pytest.approx((ends[1, 0] - ends[0, 0]) / (2 * h), rel=1e-8)
    assert at.names == ("v",)


def test_a_number_at_the_end_of_its_range_has_the_derivative_of_its_own_side():
    capsubot, names = ss.presets.capsubot(), ["drive.damping", "drive.stiffness"]
    assert capsubot.drive.damping == 0.0
    for of in ("mean_velocity", "multiplier"):
        slopes = ss.optimisation.gradient(capsubot, of, wrt=names)
        value = [ss.optimisation.gradient(capsubot.replace({"drive.damping": h}), of, wrt="gravity").value for h in (0.0, 5e-5, 1e-4)]
        # three points on one side leave h^2 = 1e-8 of a third derivative, and a value is known to 1e-10 at least, 1e-6 of a change by h
        assert slopes["drive.damping"] == pytest.approx((4 * (value[1] - value[0]) - (value[2] - value[0])) / 1e-4, rel=1e-5)
    assert "differences" in slopes.notes[0]


def test_bad_input_of_gradients_is_told():
    with pytest.raises(ss.InputError, match=r"drive.amplitude"):
        ss.optimisation.gradient(MODULE, wrt="drive.amplitud")
    with pytest.raises(ss.InputError, match="did you mean 'mean_velocity'"):
        ss.optimisation.gradient(MODULE, "mean_velocit")
    with pytest.raises(ss.InputError, match=r"friction_power.0, friction_power.1 \(that of module 1, module 2\)"):
        ss.optimisation.gradient(PAIR, "friction_power")
    with pytest.raises(ss.InputError, match=r"not a state on the strobe; did you mean 'state.v'"):
        ss.optimisation.gradient(MODULE, "state.w")
    with pytest.raises(ss.InputError, match="one robot"):
        ss.optimisation.gradient(MODULE.replace({"body_mass": [0.05, 0.06]}))
    with pytest.raises(ss.InputError, match="has no period"):
        ss.optimisation.gradient(ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(1.0, 1.0, f_plus=1.5, f_minus=1.5)))


def test_a_small_normal_spread_goes_through_by_the_slope():
    slope = ss.optimisation.gradient(MODULE, wrt="friction.mu_plus")["friction.mu_plus"]
    found = ss.optimisation.propagate(MODULE, uncertain={"friction.mu_plus": ("normal", 0.15, 1e-4)}, of="mean_velocity", samples=512)
    # the curvature changes the standard deviation by its square times 1e-8 of that, and 512 Sobol points know it to a percent
    assert found.std == pytest.approx(abs(slope) * 1e-4, rel=2e-2)
    assert found.mean == pytest.approx(found.nominal, abs=0.02 * found.std)
    assert found.failed == 0


def test_a_uniform_number_takes_the_result_from_end_to_end():
    found = ss.optimisation.propagate(MODULE, uncertain={"friction.mu_plus": ("uniform", 0.14, 0.16)}, samples=512)
    ends = [float(ss.periodic_orbit(MODULE.replace({"friction.mu_plus": mu})).mean_velocity) for mu in (0.14, 0.16)]
    assert found.inputs["friction.mu_plus"].min() > 0.14
    assert max(ends) - min(ends) == pytest.approx(np.ptp(found.values), rel=1e-2)


def test_bad_input_of_spreads_is_told():
    for given, told in (
        ({"friction.mu": ("normal", 0.15, 0.01)}, "which differ; type one"),
        ({"friction.mu_plus": ("normal", 0.15, -0.01)}, "allowed is"),
        ({"friction.mu_plus": (0.14, 0.16)}, "allowed is"),
        ({}, "allowed is a dict"),
    ):
        with pytest.raises(ss.InputError, match=told):
            ss.optimisation.propagate(MODULE, uncertain=given)
    with pytest.raises(ss.InputError, match="in the sample"):
        ss.optimisation.propagate(MODULE, uncertain={"body_mass": ("normal", 0.06, 0.06)})
