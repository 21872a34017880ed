"""The presets of machines in sweeps and maps: any two of their numbers, by their own names and by dotted ones."""

import functools
import inspect
import itertools

import matplotlib.pyplot as plt
import numpy as np
import pytest

import stickslip as ss
from stickslip.basics.fields import leaves
from stickslip.models.naming import axis_of

OF_ROBOTS = ("piezo_rig", "piezo_beam_rig", "coulomb_robot")
PRESETS = tuple(name for name in ss.presets.PRESETS if name not in OF_ROBOTS)
LENGTH = {"servo": {"duration": 2.0}, "mode_coupling": {"duration": 5.0}}
#: Where other numbers than the defaults are begun with: a spring beside which damping means something, a number that is None.
BESIDE = {"cart_pole": {"stiffness": 2.0}, "bristle_bot": {"drag": 1.0}}
#: Values of numbers that are 0 or not given by default, or that have a border near it.
VALUES = {"count": [2, 3], "sample": [0.01, 0.02], "static": [1.5, 2.0], "gear_damping": [0.0]}


def _values(name, default):
    return VALUES.get(name) or ([0.0, 0.1] if default == 0.0 else [default, 1.02 * default])


def _numbers(preset):
    """What a preset takes that is a number."""
    kept = {p.name: p.default for p in inspect.signature(preset).parameters.values()} | BESIDE.get(preset.__name__, {})
    return {name: _values(name, value) for name, value in kept.items() if name == "sample" or type(value) in (int, float)}


def _dotted(machine):
    """The numbers of a machine; those that only go together by the name that means all of them."""
    found = {name: _values(name.rpartition(".")[2], float(value)) for name, value in leaves(machine)}
    together = [name for name in found if name.endswith(".omega")]
    if len(together) > 1:
        found = {name: of for name, of in found.items() if name not in together} | {"*.omega": found[together[0]]}
    rigid = {name for name, of in found.items() if name == "gear_damping" or (name == "backlash" and of[0] == 0.0)}
    return {name: of for name, of in found.items() if name not in rigid}  # those are of a gear that is elastic


@pytest.mark.slow
@pytest.mark.parametrize("name", PRESETS)
def test_any_two_numbers_of_a_preset_make_a_map(name):
    """Each number with the next one, as the preset calls them and as the machine does; and the pictures of it."""
    preset = getattr(ss.presets, name)
    made = preset(**BESIDE.get(name, {}))
    for make, numbers in ((functools.partial(preset, **BESIDE.get(name, {})), _numbers(preset)), (made, _dotted(made))):
        names = list(numbers)
        for x, y in itertools.pairwise([*names, names[0]]):
            grid = ss.map(make, **{x: numbers[x], y: numbers[y]}, **LENGTH.get(name, {"periods": 6}))
            assert grid.mean_velocity.shape == (len(numbers[x]), len(numbers[y])) and np.isfinite(grid.mean_velocity.values).all()
            assert set(np.unique(grid.status.values)) <= {0, 1}
            if len(numbers[x]) == len(numbers[y]) == 2:
                ax = ss.plot.velocity_map(grid)
                assert ax.get_xlabel() and ax.get_ylabel() and ax.get_xlabel() != ax.get_ylabel()
                assert ss.plot.motion_map(grid.isel(contact=0) if "contact" in grid.dims else grid)
                plt.close("all")


def test_a_name_may_mean_the_numbers_of_several_parts():
    """The frequency of a chain is that of all its modules, which alone would be refused."""
    pair = ss.presets.two_modules()
    for name in ("modules.drive.omega", "modules.*.drive.omega", "*.omega"):
        assert pair.replace({name: 210.0}) == ss.presets.two_modules(omega=210.0)
    assert pair.replace({"modules[1].body_mass": 0.07}) == pair.replace({"modules.1.body_mass": 0.07})
    with pytest.raises(ss.InputError, match=r'one common period; a name with a star.*type \.replace\(\{"\*\.omega": 205\.0\}\)'):
        pair.replace({"modules.0.drive.omega": 210.0})
    with pytest.raises(ss.InputError, match=r"modules\.1\.drive\.omega is given twice"):
        pair.replace({"modules.1.drive.omega": 210.0, "modules.drive.omega": 211.0})
    speeds = ss.sweep(pair, **{"modules.drive.omega": [200.0, 210.0]}, periods=20)
    assert np.array_equal(speeds.mean_velocity, ss.sweep(ss.presets.two_modules, omega=[200.0, 210.0], periods=20).mean_velocity)
    assert speeds["modules.drive.omega"].long_name == "angular frequency ω"


def test_how_many_masses_may_be_an_axis():
    """Of three masses one always holds and the worm goes 3 a f; of two, with a third of a period between them, 2 a f."""
    grid = ss.sweep(ss.presets.worm, count=[2, 3], periods=20)
    assert grid["count"].dtype.kind == "i" and grid.mean_velocity.values == pytest.approx([0.008, 0.012], rel=1e-12)
    with pytest.raises(ss.InputError, match="whole number of bodies"):
        ss.sweep(ss.presets.worm, count=[2.5, 3.0])


def test_axes_say_what_they_are_of():
    """A target is an angle, a torque no force on an inner mass, and a number that several parts have says whose it is."""
    swinging = ss.presets.servo(target=ss.Harmonic(amplitude=0.3, frequency=0.5))
    assert axis_of("control.target.amplitude", swinging) == ("amplitude of the target A", "rad")
    driven = ss.Joint(inertia=0.01, friction=ss.Coulomb(0.02, 0.02), torque=ss.HarmonicForce(0.1, omega=3.0))
    assert axis_of("torque.amplitude", driven) == ("torque A", "N m")
    assert axis_of("along.stroke", ss.presets.stick_slip_stage()) == ("stroke of the motion along the track L", "m")
    assert axis_of("across.amplitude", ss.presets.conveyor()) == ("amplitude of the motion across the track A", "m")
    assert axis_of("link.drive.amplitude", ss.presets.worm()) == ("amplitude of the distance A", "m")
    assert axis_of("phases.1", ss.presets.two_modules()) == ("phase of the drive (phases.1) φ", "rad")
    assert axis_of("drive.stops.0.gap", ss.presets.capsule()) == ("gap of the stop δ", "m")


def test_a_branch_may_begin_where_a_number_may_not_be_less():
    """A restitution of 0: slopes along it are taken on one side."""
    hopping = ss.presets.conveyor(throw_index=2.5)
    branch = ss.continuation(hopping, parameter="restitution", start=0.0, stop=0.01, step=0.2)
    assert branch.ended == "it reached the end of the range"
    alone = ss.solve(hopping.replace(restitution=0.01), periods=200)
    assert branch.points.mean_velocity.values[-1] == pytest.approx(ss.mean_velocity(alone), rel=1e-9)


@pytest.mark.slow
def test_a_branch_passes_where_a_stop_begins_to_be_touched():
    """C6: a mass that swings in a resting capsule touches an elastic stop at alpha / sqrt((1 - omega^2)^2 + (2 xi omega)^2)."""
    grazing = 1.0 / np.sqrt((1.0 - 0.6**2) ** 2 + (2 * 0.05 * 0.6) ** 2)
    resting = ss.presets.capsule(force_ratio=1.0, omega=0.6, mass_ratio=4.0, gap=grazing + 0.05, reaction=True)
    orbit = ss.periodic_orbit(resting)
    number = "drive.stops.0.gap"
    branch = ss.continuation(resting, parameter=number, start=grazing + 0.05, stop=grazing - 0.05, guess=orbit.state)
    first = branch.special[0]
    assert (
        first.kind == "grazing" and "inner-body pressed once" in first.orbit.notes[0] and abs(first.value - grazing) <= 10 * first.accuracy
    )
    assert branch.ended == "it reached the end of the range" and first.accuracy < 1e-11
    alone = ss.solve(resting.replace({number: float(branch.values[-1])}), periods=400, settle=300)
    assert branch.points.mean_velocity.values[-1] == pytest.approx(ss.mean_velocity(alone), rel=1e-9)


@pytest.mark.slow
def test_a_branch_tells_where_a_part_begins_to_fly():
    """A part takes off where the throw index passes 1; a gap of rounding on the strobe is not a flight of its own."""
    branch = ss.continuation(ss.presets.conveyor, parameter="throw_index", start=0.95, stop=1.06)
    (there,) = branch.special
    assert there.kind == "grazing" and there.value == pytest.approx(1.0, abs=1e-11) and "mass takes off once" in there.orbit.notes[0]
    assert all(len(orbit.events) == (4 if value > 1.0 else 2) for value, orbit in zip(branch.values, branch.orbits, strict=True))
