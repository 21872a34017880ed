"""Numbers with units as people type them, everywhere that a number is given; and remarks on units that were mistaken."""

import dataclasses
import math
import subprocess
import sys
from itertools import chain as joined

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.arguments import described_arguments
from stickslip.basics.typed_numbers import in_unit
from stickslip.drives import DRIVES
from stickslip.friction import LAWS
from stickslip.mechanisms import MECHANISMS
from stickslip.models.machine_adapter import machine_of
from stickslip.presets import PRESETS
from stickslip.show.cli.arguments import subject
from stickslip.tracks import TRACKS

TYPED = dict(tilt_deg="1.7 deg", amplitude="0.5525 mm", omega="32.7 Hz", mu0="18 %", body_mass="62.59 g")
PLAIN = dict(tilt_deg=1.7, amplitude=5.525e-4, omega=65.4 * math.pi, mu0=0.18, body_mass=62.59e-3)


@dataclasses.dataclass(frozen=True)
class Quantity:
    """As pint's: a number, a unit that writes itself, and the same in base units (`base` is how many of one that is, and which)."""

    magnitude: object
    units: object
    base: tuple[float, str] = (1.0, "")

    def to_base_units(self):
        return Quantity(self.magnitude * self.base[0], Unit(self.base[1]))


class Unit(str):
    def __format__(self, how):
        assert how == "~"
        return str(self)


def test_constructors_presets_shell_and_study_files_take_numbers_with_units(tmp_path):
    robot = ss.presets.piezo_rig(**PLAIN, law="coulomb")
    assert ss.presets.piezo_rig(**TYPED, law="coulomb") == robot
    assert ss.Harmonic(amplitude="0.5525 mm", frequency="1962 rpm").omega == pytest.approx(robot.drive.omega, rel=1e-15)
    words = [f"{name}={text}" for name, text in TYPED.items()]
    assert subject("piezo_rig", [*words, "law=coulomb"]).robot() == robot
    filed = "".join(f'{name} = "{text}"\n' for name, text in TYPED.items())
    path = tmp_path / "s.toml"
    path.write_text(f'make = "piezo_rig"\n[arguments]\nlaw = "coulomb"\n{filed}', encoding="utf-8")
    assert subject(str(path), []).robot() == robot
    text = robot.to_toml().replace("amplitude = 0.0005525", 'amplitude = "552.5 µm"')
    assert "µm" in text and ss.Robot.from_toml(text) == robot


def test_lists_and_ranges_with_units_are_axes_of_sweeps():
    made = subject("piezo_rig", ["tilt_deg=1.7", "amplitude=0.4mm..0.6mm:3"], many=True, solver=("periods",))
    assert made.arguments["amplitude"] == pytest.approx([4e-4, 5e-4, 6e-4], rel=1e-15)
    grid = ss.sweep(ss.presets.piezo_rig, tilt_deg="1.7 deg", amplitude=["0.4 mm", "0.5 mm"], law=["coulomb"], periods=2, settle=1)
    assert grid.amplitude.values.tolist() == [4e-4, 5e-4]
    assert ss.presets.piezo_rig(tilt_deg=1.7, amplitude=["0.4 mm", "0.5 mm"]).drive.amplitude.tolist() == [4e-4, 5e-4]


def test_every_unit_of_a_described_number_can_be_typed():
    told = [*map(described_arguments, PRESETS.values())]
    told += [{f.name: f.metadata for f in dataclasses.fields(c)} for kinds in (LAWS, DRIVES, MECHANISMS, TRACKS) for c in kinds.values()]
    units = {metadata["unit"] for metadata in joined.from_iterable(each.values() for each in told) if "unit" in metadata}
    assert len(units) > 15
    assert [in_unit(f"2.5 {unit}", unit) for unit in units] == [2.5] * len(units)


def test_quantities_of_pint_are_numbers_in_their_units():
    assert ss.Harmonic(amplitude=Quantity(0.55, Unit("mm")), omega=Quantity(32.7, Unit("Hz"))) == ss.Harmonic(5.5e-4, frequency=32.7)
    many = ss.Harmonic(amplitude=Quantity(np.array([0.4, 0.5]), Unit("mm")), omega=Quantity(205, Unit("rad / s")))
    assert many.amplitude == pytest.approx([4e-4, 5e-4], rel=1e-15)
    assert many.omega == 205.0
    assert in_unit(Quantity(2.0, Unit("nmi"), (1852.0, "m")), "m") == 3704.0  # a unit that pint alone knows
    with pytest.raises(ss.InputError, match="kg is a unit of mass"):
        ss.Harmonic(amplitude=Quantity(1.0, Unit("kg")), omega=205.0)


@each_row(
    ("given", "said"),
    [
        ("0.55", "is not a number"),
        ("0,55 mm", "is not a number"),
        ("0.55 mmm", "'mmm' no unit that is known"),
        ("0.55 kg", "kg is a unit of mass"),
        ("nan mm", "is not a number"),
    ],
)
def test_what_is_no_length_is_refused_with_what_to_type(given, said):
    with pytest.raises(ss.InputError, match=said) as caught:
        ss.Harmonic(amplitude=given, omega=205.0)
    assert "type for example amplitude=0.000556" in str(caught.value)


def test_reciprocal_seconds_are_neither_hertz_nor_radians():
    with pytest.raises(ss.InputError, match="1/s may be Hz or rad/s"):
        ss.Harmonic(amplitude=1e-3, omega="205 1/s")


def test_a_start_has_the_units_of_the_machine():
    robot = ss.presets.piezo_rig(**PLAIN, law="coulomb")
    assert ss.solve(robot, start=dict(v="1 cm/s"), periods=1, settle=0, keep="trajectory").v[0] == 0.01
    with pytest.raises(ss.InputError, match="mm/s is a unit of velocity"):
        ss.solve(ss.Joint.example(), start=dict(v="1 mm/s"), periods=1)


def test_millimetres_typed_as_metres_are_remarked_on():
    robot = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=0.55, law="coulomb")
    note = next(note for note in robot.notes if "is a unit mistaken" in note)
    # 2 A, A omega and A omega^2/9.81, at 64 instants that miss the ends by at most 1 - cos(pi/64)
    assert all(text in note for text in ("stroke of 1.1 m", "113 m/s", "2.36e+03 g"))
    assert (
        note in machine_of(ss.presets.two_modules().replace({"modules.0.drive.amplitude": 0.55, "modules.1.drive.amplitude": 0.55})).notes
    )
    batch = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=np.array([5e-4, 0.5]), law="coulomb")
    assert any("is a unit mistaken" in note for note in batch.notes)


@each_row("name", PRESETS)
def test_no_preset_has_a_mistaken_unit(name):
    from inspect import signature

    told = described_arguments(PRESETS[name])
    needed = {p.name: told[p.name]["example"] for p in signature(PRESETS[name]).parameters.values() if p.default is p.empty}
    assert not [note for note in machine_of(PRESETS[name](**needed)).notes if "mistaken" in note]


def test_a_number_without_its_part_is_told_with_its_part():
    robot = ss.presets.piezo_rig(**PLAIN)
    with pytest.raises(ss.InputError, match=r'type replace\(\{"drive.amplitude": ...\}\)'):
        robot.replace(amplitude=1e-4)
    with pytest.raises(ss.InputError, match=r'"modules.0.drive.amplitude"'):
        ss.presets.two_modules().replace(amplitude=1e-4)


def test_one_robot_is_read_from_the_shell_without_loading_data_frames():
    typed = "'tilt_deg=1.7deg', 'amplitude=0.5mm', 'law=coulomb'"
    code = f"import sys; from stickslip.show.cli.arguments import subject; subject('piezo_rig', [{typed}]).robot(); "
    code += "print({'xarray', 'pandas'} & set(sys.modules))"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout == "set()\n"  # they take longer to load than such a robot to run


RIG = dict(tilt_deg=1.7, law="coulomb")
SHORT = dict(parameter="amplitude", mu0=0.18, step=0.2, **RIG)


def test_ranges_of_studies_may_have_units():
    """A branch, a curve, a diagram, an atlas, a fit and a distribution, from the same numbers with and without units."""
    make = ss.presets.piezo_rig
    plain, typed = (ss.continuation(make, start=a, stop=b, **SHORT) for a, b in ((3.6e-4, 3.8e-4), ("0.36 mm", "380 µm")))
    assert np.array_equal(plain.values, typed.values) and plain.special[0].value == typed.special[0].value
    steep = dict(amplitude=6e-4, law="coulomb")
    branch = ss.continuation(make, parameter="tilt_deg", start="1 deg", stop="0.035 rad", step=0.2, **steep)
    assert branch.values[-1] == pytest.approx(np.degrees(0.035), rel=1e-12)
    values = ([4e-4, 4.5e-4], ["0.4 mm", "0.45 mm"])
    assert all(ss.bifurcation(make, parameter="amplitude", values=v, **RIG).amplitude.values.tolist() == values[0] for v in values)
    over = [{"amplitude": ends, "mu0": (0.1, 0.3)} for ends in ((2e-4, 9e-4), ("0.2 mm", "0.9 mm"))]
    assert ss.dynamics.atlas_time(make, over=over[1], **RIG).most == ss.dynamics.atlas_time(make, over=over[0], **RIG).most
    record = ss.virtual_rig(make(amplitude=5.5e-4, **RIG), noise=1e-4, seed=1)
    fits = [ss.identify(record, make, free={"amplitude": ends}, **RIG) for ends in ((3e-4, 8e-4), ("0.3 mm", "0.8 mm"))]
    assert fits[0].values == fits[1].values
    robot = make(amplitude=5.5e-4, **RIG)
    spread = [
        ss.optimisation.propagate(robot, uncertain={"drive.amplitude": each}, samples=8) for each in ((5.5e-4, "1%"), ("0.55 mm", "1%"))
    ]
    assert np.array_equal(spread[0].values, spread[1].values)


@each_row(
    ("call", "sentence"),
    [
        (lambda: ss.continuation(ss.presets.piezo_rig, start="1 kg", stop=4e-4, **SHORT), "start: kg is a unit of mass"),
        (lambda: ss.bifurcation(ss.presets.piezo_rig, parameter="amplitude", values=["1 s", "2 s"], **RIG), "values: s is a unit of time"),
        (
            lambda: ss.dynamics.atlas_time(ss.presets.piezo_rig, over={"amplitude": ("1 Hz", 1.0), "mu0": (0.1, 0.3)}, **RIG),
            r"over\['amplitude'\]: Hz",
        ),
        (
            lambda: ss.identification.design(
                ss.presets.piezo_rig, free={"mu0": 0.1}, experiments={"amplitude": ["1 kg"]}, noise=1e-3, **RIG
            ),
            "kg is a unit",
        ),
    ],
)
def test_a_range_in_another_unit_is_an_error(call, sentence):
    with pytest.raises(ss.InputError, match=sentence):
        call()


def test_a_run_may_last_for_minutes():
    bench = ss.PulledMass(mass=1.0, stiffness=2.0, speed="10 cm/s", friction=ss.Coulomb(0.15, 0.15))
    assert ss.solve(bench, duration="0.5 min").t[-1] == ss.solve(bench, duration=30.0).t[-1] == 30.0
    with pytest.raises(ss.InputError, match="duration: kg is a unit of mass"):
        ss.solve(bench, duration="30 kg")


def test_coefficients_in_per_cent_are_remarked_on_and_a_run_repeats_the_remark():
    robot = ss.presets.coulomb_robot(alpha_plus=0.5, alpha_minus=0.9).replace({"friction.mu_plus": 13.0, "friction.mu_minus": 21.0})
    assert any(note.startswith("is a unit mistaken? friction.mu_plus = 13.0") for note in robot.notes)
    long = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=0.55, law="coulomb")
    assert "is a unit mistaken? This drive has a stroke of 1.1 m" in repr(ss.solve(long, periods=2, settle=0))
    usual = ss.presets.piezo_rig(tilt_deg=1.7, amplitude="0.55 mm", law="coulomb")
    assert "mistaken" not in repr(ss.solve(usual, periods=2, settle=0))


def test_the_table_of_a_robot_has_units_and_its_remarks():
    shown = ss.presets.piezo_rig(tilt_deg=1.7, amplitude=0.5, law="coulomb", incline="gravity")._repr_html_()
    assert "0.06259 kg" in shown and "32.7 Hz" in shown and "(1.7°)" in shown and "is a unit mistaken?" in shown and "None" not in shown


@each_row(
    ("wrong", "hint"),
    [
        (lambda: ss.Harmonic(amplitude=1e-3, freq=40), "type frequency=40"),
        (lambda: ss.Robot(body_mass=0.06, tilt_deg=3), r'type track=ss.Incline\(tilt="3 deg"\)'),
        (lambda: ss.Incline(tilt=3), 'or text such as "3 deg"'),
        (
            lambda: ss.sweep(ss.Robot.from_toml(ss.presets.piezo_rig(**PLAIN).to_toml()), **{"drive.frequency": [40.0, 50.0]}),
            'drive.omega="40 Hz"',
        ),
        (lambda: ss.presets.piezo_rigg, "did you mean 'piezo_rig'?"),
        (lambda: ss.simulate, "type ss.solve"),
        (lambda: ss.solve(ss.presets.coulomb_robot(0.5, 0.9), periods=2, settle=0).velocity, "type run.v"),
        (lambda: ss.solve(ss.presets.coulomb_robot(0.5, 0.9), periods=2, settle=0).contact_force, "this run has no|a run has no"),
    ],
)
def test_names_that_others_use_are_told_what_is_called_so_here(wrong, hint):
    with pytest.raises((ss.InputError, AttributeError), match=hint):
        wrong()
