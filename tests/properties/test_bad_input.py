"""Bad input, each kind: a message that names the field, the value, what is allowed and what to type; all at once."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from multiprocessing.reduction import ForkingPickler

import numpy as np
import pytest
import xarray as xr

import stickslip as ss
from rows import each_row
from stickslip.basics.fields import number
from stickslip.maths import where

RIG = {"tilt_deg": 1.7, "amplitude": 5.525e-4}


def rig(**changes):
    return ss.presets.piezo_rig(**{**RIG, **changes})


def robot(**changes):
    parts = {"body_mass": 0.06, "inner_mass": 0.01, "drive": ss.Harmonic(amplitude=5e-4, omega=205.0), "friction": ss.Coulomb(0.15, 0.21)}
    return ss.Robot(**{**parts, **changes})


def lugre(**changes):
    fields = {
        "mu_plus": 0.15,
        "mu_minus": 0.21,
        "f_plus": 0.18,
        "f_minus": 0.24,
        "sigma0": 4e5,
        "sigma1": 100.0,
        "sigma2": 0.04,
        "v_s": 2e-3,
    }
    return ss.LuGre(**{**fields, **changes})


def message(call):
    with pytest.raises(ss.InputError) as caught:
        call()
    return str(caught.value)


def says(call, *parts):
    told = message(call)
    missing = [part for part in parts if part not in told]
    assert not missing, f"{missing} not in: {told}"


# numbers ----------------------------------------------------------------------------------------------------------

LOOK_LIKE_NUMBERS = ["1.0", True, None, b"1", 1j]
IN_CONTAINERS = [lambda x: x, lambda x: [x], lambda x: (0.5, x), lambda x: np.array([x]), lambda x: xr.DataArray([x])]


def test_errors_come_through_a_pool_of_processes():
    """They are pickled there: what they were made from stays with them."""
    for error in (ss.InputError("Harmonic", ["a", "b"]), ss.SolveError("no step is short enough")):
        copy = ForkingPickler.loads(ForkingPickler.dumps(error))
        assert (type(copy), str(copy)) == (type(error), str(error))
    assert ForkingPickler.loads(ForkingPickler.dumps(ss.InputError("Harmonic", ["a", "b"]))).problems == ("a", "b")


@each_row(("inside", "value"), product(range(len(IN_CONTAINERS)), LOOK_LIKE_NUMBERS))
def test_what_is_no_number_alone_is_none_in_a_list_or_an_array(value, inside):
    with pytest.raises(ValueError, match=r"is not a number|is not an array of numbers"):
        number(IN_CONTAINERS[inside](value))


def test_what_is_a_number_stays_one():
    assert number(3) == 3.0 and number(np.float32(0.5)) == 0.5 and number(Fraction(1, 2)) == 0.5
    assert number([1, 2.5]).tolist() == [1.0, 2.5] and number(range(3)).tolist() == [0.0, 1.0, 2.0]


@each_row("make", [lambda x: ss.Harmonic(x, 200.0), lambda x: ss.Harmonic(1e-3, frequency=x), lambda x: rig(amplitude=[x])])
def test_an_integer_beyond_all_numbers_is_told_as_such(make):
    says(lambda: make(10**400), "an integer is too large for a number", "allowed is", "type ")


@each_row("law", ["lugre", "coulomb", "coulomb-static"])
def test_arrays_of_a_rig_that_do_not_fit_together_are_told_by_name(law):
    says(lambda: rig(tilt_deg=[1.0, 1.7], mu0=[0.1, 0.2, 0.3], law=law), "piezo_rig: ", "tilt_deg has shape (2,)", "mu0 has shape (3,)")
    assert rig(mu0=[0.1, 0.2, 0.3], f0=[0.3, 0.4], law="coulomb").shape == (3,)  # which has no use for f0
    assert rig(tilt_deg=[[1.0], [1.7]], mu0=[0.1, 0.2, 0.3], f0=0.4, law=law).shape == (2, 3)


BAD = [0.0, -0.06, math.nan, math.inf, -math.inf, "heavy", True, None, [0.06, "x"], {"kg": 0.06}, 1j]


@each_row(("field", "value"), product(["body_mass", "inner_mass", "gravity"], BAD))
def test_masses_and_gravity_must_be_positive_numbers(field, value):
    if field == "inner_mass" and isinstance(value, list):  # a robot may have several inner masses, and a batch of them
        says(lambda: robot(**{field: value}), field, "a list", "a tuple means one for each part, an array means cases")
        return
    says(lambda: robot(**{field: value}), field, "allowed is a positive", f"type for example {field}=")


@each_row("value", [0.0, -1.0, math.nan, math.inf, "fast"])
def test_drives_say_what_they_take(value):
    says(lambda: ss.Harmonic(amplitude=1e-4, omega=value), "omega", "positive angular frequency", "omega=205.46")
    says(lambda: ss.Harmonic(amplitude=1e-4, frequency=value), "positive")


def test_exactly_one_of_omega_and_frequency():
    says(lambda: ss.Harmonic(amplitude=1e-4), "exactly one of omega", "neither", "omega=205.46")
    says(lambda: ss.Harmonic(amplitude=1e-4, omega=1.0, frequency=1.0), "exactly one of omega", "both")


@each_row("value", [-1e-4, math.nan, math.inf, "big"])
def test_amplitudes_are_not_negative(value):
    says(lambda: ss.Harmonic(amplitude=value, omega=1.0), "amplitude", "zero or more", "amplitude=0.000556")
    says(lambda: rig(amplitude=value), "amplitude", "type for example amplitude=")


@each_row(("field", "value"), product(["mu_plus", "mu_minus", "sigma0", "v_s"], [0.0, -0.1, math.nan, "rough"]))
def test_lugre_numbers_must_be_positive(field, value):
    says(lambda: lugre(**{field: value}), field, "positive", f"type for example {field}=")


def test_one_bad_value_in_an_array_is_bad():
    says(lambda: robot(body_mass=np.array([0.06, -0.01])), "body_mass", "body_mass[1] = -0.01 (1 of 2 values", "positive mass")
    says(lambda: rig(amplitude=np.array([1e-4, np.nan])), "amplitude", "amplitude[1] = nan")


# relations --------------------------------------------------------------------------------------------------------


def test_static_friction_is_not_below_kinetic():
    for make in (lambda: ss.Coulomb(0.2, 0.2, f_plus=0.1), lambda: lugre(f_plus=0.1)):
        says(make, "f_plus = 0.1", "below mu_plus", "f_plus >= mu_plus", "f_plus=None")
    says(lambda: ss.Coulomb(0.2, 0.2, f_minus=0.1), "f_minus = 0.1 is below mu_minus = 0.2")
    says(lambda: rig(f0=0.1), "f0 = 0.1 is below mu0 = 0.18", "f0 >= mu0", "f0=0.21")


@each_row("tilt", [11.0, math.degrees(math.atan(0.18)), 90.0, -15.0, np.array([1.7, 12.0])])
def test_folding_needs_a_track_flatter_than_the_friction_angle(tilt):
    says(lambda: rig(tilt_deg=tilt), "tilt_deg", "friction angle", "10.2", 'type incline="gravity"')


def test_a_track_is_no_wall():
    says(lambda: rig(tilt_deg=95.0, incline="gravity"), "tilt_deg = 95", "between -90 and 90 degrees")
    says(lambda: ss.Incline(tilt=2.0), "tilt = 2.0", "between -pi/2 and pi/2")


def test_shapes_that_do_not_broadcast():
    says(
        lambda: rig(amplitude=np.full(3, 1e-4), mu0=np.full(4, 0.18), f0=0.21, tilt_deg=0.0),
        "do not broadcast",
        "amplitude has shape (3,)",
        "(4,)",
        "xarray.DataArray",
    )
    labelled = xr.DataArray([1e-4, 2e-4], dims="a", coords={"a": [1, 2]})
    other = xr.DataArray([200.0, 201.0], dims="a", coords={"a": [2, 3]})
    says(lambda: robot(drive=ss.Harmonic(amplitude=labelled, omega=other)), "do not fit together")
    says(
        lambda: robot(body_mass=np.full(2, 0.06), drive=ss.Harmonic(amplitude=labelled, omega=200.0)),
        "body_mass",
        "xarray.DataArray with dims",
    )


# names ------------------------------------------------------------------------------------------------------------


def test_unknown_names_get_a_proposal():
    says(lambda: robot().replace(body_mas=1.0), "'body_mas' is not a field", "did you mean 'body_mass'")
    says(lambda: robot().replace({"drive.amplitud": 1.0}), "did you mean 'amplitude'")
    says(lambda: rig(law="lugree"), "law = 'lugree'", "did you mean 'lugre'")
    says(lambda: rig(incline="gravitty"), "did you mean 'gravity'")
    says(lambda: ss.solve(rig(law="coulomb"), period=3), "'period' is not an argument of solve", "did you mean 'periods'")
    says(lambda: ss.solve(rig(law="coulomb"), method="exakt"), "did you mean 'exact'")
    says(lambda: ss.solve(rig(law="coulomb"), start={"w": 1.0}), "start has no 'w'")
    with pytest.raises(AttributeError, match="did you mean 'Coulomb'"):
        _ = ss.Coulom
    says(lambda: ss.sweep(ss.presets.piezo_rig, amplitude=[5e-4], tilt_deg=1.7, n_jobs=2), "type workers=4 for threads")
    says(lambda: ss.BlockOnBelt(mass=1.0, stiffness=2.0, speed=0.1), "type friction=ss.Coulomb(0.15, 0.21)")
    with pytest.raises(AttributeError, match="savefig"):
        _ = ss.solve(rig(law="coulomb"), periods=2).savefig


def test_a_machine_that_is_no_dataclass_says_what_to_write():
    class Block(ss.Machine):
        def bodies(self):
            return {"a": ss.Body(1.0)}

    says(lambda: ss.solve(Block(), duration=1.0), "it is not a dataclass; write @dataclass(frozen=True, eq=False) above class Block")


def test_parts_must_be_parts():
    says(lambda: robot(friction="coulomb"), "friction = 'coulomb'", "sliding and breakaway", "ss.Coulomb(")
    says(lambda: robot(friction=ss.Coulomb), "friction = <class", "type for example")
    says(lambda: robot(drive=205.0), "drive = 205.0", "ss.Harmonic(")
    says(lambda: robot(track=None), "track = None", "ss.Level()")
    says(lambda: ss.solve("robot"), "'robot' is not a model", "ss.presets.piezo_rig(")


# several at once --------------------------------------------------------------------------------------------------


def test_everything_wrong_is_reported_at_once():
    with pytest.raises(ss.InputError) as caught:
        robot(body_mass=-1, inner_mass="x", gravity=math.nan, drive=3, friction=4)
    assert len(caught.value.problems) == 5
    assert all(name in str(caught.value) for name in ("body_mass", "inner_mass", "gravity", "drive", "friction"))
    with pytest.raises(ss.InputError) as caught:
        ss.presets.piezo_rig(tilt_deg="flat", amplitude=-1, omega=0, law="glue")
    assert len(caught.value.problems) == 4
    with pytest.raises(ss.InputError) as caught:
        ss.solve(rig(law="coulomb"), periods=0, rtol=2, workers=0, samples=1, keep="all", method="magic", start=3)
    assert len(caught.value.problems) == 7


def test_solver_arguments_say_what_is_allowed():
    one = rig(law="coulomb")
    says(lambda: ss.solve(one, periods=10, settle=10), "settle = 10", "below periods = 10")
    says(lambda: ss.solve(one, periods=2.5), "periods = 2.5", "whole number", "periods=200")
    says(lambda: ss.solve(one, rtol=1e-14), "rtol = 1e-14", "1e-12 to 1e-3", "rtol=1e-6")
    says(lambda: ss.solve(one, start={"v": math.nan}), "is not finite")
    says(lambda: ss.solve(one, start={"v": "fast"}), "start['v'] = 'fast'", "finite number")
    says(lambda: ss.solve(one, start={"z": 1e-6}), "Coulomb has no inner state", "leave z out")
    says(lambda: ss.bifurcation(one), "parameter is missing; type parameter='mu0'", "values is missing; type values=[")
    says(lambda: ss.solve(rig(), method="exact"), "set-valued", 'method="auto"')
    says(lambda: ss.solve(one, method="rodas4"), "set-valued", 'method="auto"')
    says(lambda: ss.solve(rig(amplitude=np.array([1e-4, 2e-4])), keep="trajectory"), "batch of shape (2,)", 'keep="summary"')


# files ------------------------------------------------------------------------------------------------------------


def test_study_files_say_what_is_wrong_with_them():
    text = rig().to_toml()
    says(lambda: ss.Robot.from_toml("[robot"), "not readable as TOML")
    says(lambda: ss.Robot.from_toml("[x]"), "no [robot] table", "body_mass = 0.06259")
    says(
        lambda: ss.Robot.from_toml(text.replace("sigma0", "sigma_0")), "sigma_0 is not known", "did you mean 'sigma0'", "sigma0 is missing"
    )
    says(lambda: ss.Robot.from_toml(text.replace('"lugre"', '"lugree"')), "robot.friction.kind = 'lugree'", "did you mean 'lugre'")
    says(lambda: ss.Robot.from_toml(text.replace("body_mass = 0.06259", "body_mass = -1")), "body_mass = -1", "positive mass")


def test_folders_that_cannot_be_written_are_named(tmp_path):
    run = ss.solve(rig(law="coulomb"), periods=2, samples=20)
    (tmp_path / "file").touch()
    for save in (run.save, run.to_mat):
        says(lambda save=save: save(tmp_path / "nowhere" / "run.nc"), "cannot write", "nowhere", "does not exist")
        says(lambda save=save: save(tmp_path / "file" / "run.nc"), "cannot write", "run.nc", "folder that you may write to")
    says(lambda: ss.load(tmp_path / "nothing.nc"), "there is no file", "nothing.nc")
    says(lambda: ss.load(tmp_path / "file"), "is not a netCDF4 file")


# a user's own law -------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Branching:
    """A law with `if`: what most people write first."""

    mu: float

    def rate(self, v, z, load):
        if v > 0:
            return v - 1e5 * v * z
        return v + 1e5 * v * z

    def force(self, v, z, zdot, load):
        return self.mu * load * 1e5 * z


@dataclass(frozen=True)
class WithMath(Branching):
    """A law that calls math on a symbol."""

    def rate(self, v, z, load):
        return v - abs(v) * z * math.exp(v)


@dataclass(frozen=True)
class NaN(Branching):
    """A law that is not a number at rest."""

    def rate(self, v, z, load):
        return v - z * where(v > 0, 1.0, -1.0) * load / self.mu * (1e300 * 1e300 - 1e300 * 1e300)


@dataclass(frozen=True)
class Frozen(Branching):
    """A law that keeps a constant made at construction, which a sweep would not change."""

    def __post_init__(self):
        object.__setattr__(self, "made", 2 * self.mu)

    def rate(self, v, z, load):
        return v - abs(v) * z * self.made


@dataclass(frozen=True)
class BranchingSliding:
    """A set-valued law with `if`."""

    mu: float

    def sliding(self, v, load):
        return self.mu * load if v > 0 else -self.mu * load

    def breakaway(self, load):
        return -self.mu * load, self.mu * load


def test_a_law_with_if_is_told_to_use_where():
    says(lambda: ss.solve(robot(friction=Branching(0.2)), periods=2), "Branching", "`if`", "where(condition, yes, no)")
    says(
        lambda: ss.solve(robot(friction=BranchingSliding(0.2)), periods=2, method="rk4"),
        "BranchingSliding",
        "`if`",
        "where(condition, yes, no)",
    )


def test_a_law_with_math_is_told_where_the_functions_are():
    says(lambda: ss.solve(robot(friction=WithMath(0.2)), periods=2), "WithMath", "stickslip.maths")


def test_a_law_that_is_no_number_is_told_before_anything_compiles():
    says(lambda: ss.solve(robot(friction=NaN(0.2)), periods=2), "NaN", "nan", "'mu': 0.2", "finite number")


def test_a_law_with_hidden_constants_is_told_so():
    says(lambda: ss.solve(robot(friction=Frozen(0.2)), periods=2), "Frozen", "made", "field")


def test_a_law_must_be_a_dataclass():
    class Plain:
        def rate(self, v, z, load):
            return v

        def force(self, v, z, zdot, load):
            return z

    says(lambda: robot(friction=Plain()), "is not a dataclass", "@dataclass(frozen=True)")


def test_changes_of_records_are_checked_again():
    says(lambda: replace(robot(), body_mass=-1.0), "body_mass = -1.0")
    says(lambda: robot().replace({"friction.mu_plus": -0.1}), "mu_plus = -0.1")


def test_lints_are_notes_and_no_errors():
    steep = replace(rig(law="coulomb", incline="gravity"), track=ss.Incline(math.radians(12.0)))
    assert "slides by itself" in steep.notes[0] and rig(law="coulomb").notes == rig().notes == []


@dataclass(frozen=True, eq=False)
class Pair(ss.Machine):
    """Two bodies, and what a test puts between them."""

    parts: object = None
    between: object = None
    walls: object = None
    load: object = None

    period = 0.06

    def bodies(self):
        return {"a": ss.Body(0.1), "b": ss.Body(0.1)}

    def contacts(self):
        return {"a": ss.Contact("a", ss.Coulomb(0.15, 0.21), load=self.load)}

    def links(self):
        return self.between or {}

    def stops(self):
        return self.walls or {}


AHEAD, BEHIND = ss.Stop(-0.2, restitution=0.5), ss.Stop(0.1, restitution=0.5, side=-1)
SOFT = ss.Stop(-0.2, stiffness=9.0)


@each_row(
    ("made", "said"),
    [
        ({"walls": {("a", "b"): (BEHIND, AHEAD)}}, "a-b 1 and a-b 2, which face one another and overlap: .* -0.1 m; allowed is more than"),
        (
            {"walls": {("a", "b"): ss.Stop(-0.2, stiffness=9.0), ("b", "a"): ss.Stop(0.1, stiffness=9.0)}},
            "a-b and b-a, .* zero or more; type",
        ),
        ({"walls": {("a", None): (BEHIND, AHEAD)}}, "stops.. has a 1 and a 2, which face one another .* type gap=0.01 for both"),
        (
            {"walls": {("a", "b"): AHEAD}, "between": {("a", "b"): ss.machines.Rigid()}},
            "a-b, between two bodies whose distance is prescribed",
        ),
    ],
)
def test_stops_that_could_never_be_kept_are_said(made, said):
    with pytest.raises(ss.InputError, match=said):
        Pair(**made)


def test_stops_that_touch_without_play_are_a_gear_and_allowed():
    flanks = (ss.Stop(0.0, stiffness=9.0), ss.Stop(0.0, stiffness=9.0, side=-1))
    assert Pair(walls={("a", "b"): flanks}).stops() == {("a", "b"): flanks}


def test_a_start_beyond_a_stop_says_where_they_touch():
    with pytest.raises(ss.InputError, match=r"stop a-b, by 0.2 m; .* type start=\{.x.: \{.a.: -0.2\}\}, where they touch"):
        ss.solve(Pair(walls={("a", "b"): AHEAD}), periods=2)
    run = ss.solve(Pair(walls={("a", "b"): AHEAD}), periods=2, start={"x": {"a": -0.2}})
    assert run.status == "finished"


@pytest.mark.parametrize("method", ["auto", "dop853"])
@pytest.mark.parametrize("load", [-1.0, 0.0])
def test_a_load_that_is_not_there_at_the_start_is_said_by_every_method(load, method):
    pair = Pair(load=lambda t, x: load + 0.0 * x)
    with pytest.raises(
        ss.InputError, match=rf"the load of the contact 'a' is -?{abs(load):g} N at the start, .* restitution=0.0 for a body"
    ):
        ss.solve(pair, periods=2, method=method)


@dataclass(frozen=True)
class Away:
    """A distance that grows by a centimetre in each second."""

    period = 0.5

    def position(self, t):
        return 0.01 * t

    def velocity(self, t):
        return 0.01 + 0.0 * t

    def acceleration(self, t):
        return 0.0 * t


def test_a_gait_whose_distances_do_not_close_is_said():
    bodies = ss.machines.Bodies(mass=0.05, count=3, friction=ss.Coulomb(0.1, 0.3))
    with pytest.raises(ss.InputError, match=r"'body 2'\)\] prescribes a distance that does not close: it changes by 0.005 m in the period"):
        ss.Chain(bodies, link=ss.machines.Gait(Away(), lag=2.0))


@each_row(
    ("part", "said"),
    [
        (
            {"load": lambda t, x, v, forces, more: 1.0},
            r"load = .*: allowed is a function of t, of t and x, .*or of t, x, v and forces; type load=lambda t, x, v, forces: 1.0",
        ),
        ({"load": "heavy"}, r"load: 'heavy' is not a number; allowed is a positive force \[N\]"),
    ],
)
def test_a_load_that_is_neither_number_nor_function_of_the_state_and_forces_is_refused(part, said):
    with pytest.raises(ss.InputError, match=said):
        Pair(**part)


def test_a_chain_without_links_says_what_to_type():
    with pytest.raises(ss.InputError, match=r"link has 0 links for 2 bodies; .* type link=ss.Spring"):
        ss.Chain((robot(), robot()), link=())


def test_values_without_a_name_are_told_with_the_names_that_they_need():
    rig = ss.presets.piezo_rig
    says(
        lambda: ss.continuation(rig, "mu0", 0.048, 0.046), "allowed without a name is make", "type parameter='mu0', start=0.048, stop=0.046"
    )
    says(lambda: ss.bifurcation(rig, "mu0", (0.034, 0.05)), "type parameter='mu0', values=(0.034, 0.05)")


def test_a_law_that_a_preset_does_not_have_is_told_how_to_be_given():
    says(lambda: ss.presets.piezo_rig(1.7, 5e-4, law="stribeck"), 'incline="gravity").replace(friction=')
    says(lambda: ss.presets.piezo_rig(1.7, 5e-4, law="coulom"), "did you mean 'coulomb'?")
