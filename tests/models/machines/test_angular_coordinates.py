"""Units of columns and axes where a machine has angles among its coordinates."""

from dataclasses import dataclass

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import pytest

import stickslip as ss
from rows import each_row
from stickslip.maths import cos, pi, sin
from stickslip.models.angular_coordinates import angles_of, unit_of_part
from stickslip.models.machine_adapter import machine_of
from stickslip.models.turning_coordinates import turning


@dataclass(frozen=True, eq=False)
class Hung(ss.Machine):
    length: float = 0.5
    coordinates = ("x", "angle")
    time_scale = 1.0

    def bodies(self):
        return {"cart": ss.Body(1.0), "bob": ss.Body(0.3)}

    def places(self, t, q):
        return {"cart": (q["x"], 0.0), "bob": (q["x"] + self.length * sin(q["angle"]), -self.length * cos(q["angle"]))}

    def contacts(self):
        law = ss.Coulomb(0.1, 0.1)
        return {"rail": ss.Contact("cart", law, load=13.0), "joint": ss.Contact("angle", law, load=0.01)}


class Kinetic(Hung):
    places = None

    def kinetic(self, q, u):
        return 0.5 * u["x"] ** 2 + 0.15 * u["angle"] ** 2 + 0.1 * cos(q["angle"]) * u["x"] * u["angle"]

    def contacts(self):
        return {}


class Rod(Hung):
    def bodies(self):
        return {"cart": ss.Body(1.0, inertia=0.1), "bob": ss.Body(0.3)}

    def places(self, t, q):
        return {"cart": (q["x"], 0.0, q["angle"]), "bob": (q["x"] + 1.0, 0.0)}


class Wire(Hung):
    """A bead on a wavy wire: a sine of 40 x is no angle."""

    def places(self, t, q):
        return {"cart": (q["x"], 0.01 * sin(40.0 * q["x"])), "bob": (q["angle"], 0.0)}


class Wheel(Hung):
    """It rolls: after a turn it is elsewhere."""

    coordinates = ("phi",)

    def bodies(self):
        return {"wheel": ss.Body(1.0, inertia=0.1)}

    def places(self, t, q):
        return {"wheel": (self.length * q["phi"], self.length, q["phi"])}

    def contacts(self):
        return {}


class ByItsHub(Wheel):
    """The same wheel by the place of its hub, with a radius of one."""

    coordinates = ("x",)

    def places(self, t, q):
        return {"wheel": (q["x"], self.length, q["x"] / self.length)}


class Said(Wire):
    angles = ("x",)


@each_row(
    ("machine", "angles"),
    [
        *((machine, ("angle",)) for machine in (Hung(), Kinetic(), Rod())),
        *((machine, ()) for machine in (Wire(), ss.Chain.example(), ByItsHub(1.0))),
        *((machine, ("phi",)) for machine in (Wheel(), Wheel(1.0))),
        (Said(), ("x",)),
    ],
)
def test_what_a_whole_turn_leaves_alone_or_turns_a_body_is_an_angle(machine, angles):
    assert angles_of(machine) == angles


@dataclass(frozen=True, eq=False)
class Pole(Hung):
    """Pushed to and fro."""

    push: float = 20.0
    omega: float = 3.0

    @property
    def period(self):
        return 2 * pi / self.omega

    def forces(self, t, q, u):
        return {"x": self.push * cos(self.omega * t), "angle": -0.3 * u["angle"]}

    def contacts(self):
        return {"rail": ss.Contact("cart", ss.Coulomb(0.1, 0.1), load=13.0)}


@dataclass(frozen=True, eq=False)
class Spun(ss.Machine):
    """A torque turns an arm on and on."""

    length: float
    torque: float
    omega: float = 3.0
    coordinates = ("angle",)

    @property
    def period(self):
        return 2 * pi / self.omega

    def bodies(self):
        return {"bob": ss.Body(0.5)}

    def places(self, t, q):
        return {"bob": (self.length * sin(q["angle"]), -self.length * cos(q["angle"]))}

    def contacts(self):
        return {"pin": ss.Contact("angle", ss.Coulomb(0.1, 0.1), load=1.0)}

    def forces(self, t, q, u):
        return {"angle": self.torque * (1.0 + 0.5 * cos(self.omega * t)) - 0.3 * u["angle"]}


class Sprung(Pole):
    """Its torsion spring tells one turn from the next."""

    angles = ("angle",)

    def forces(self, t, q, u):
        return {**super().forces(t, q, u), "angle": -2.0 * q["angle"]}


@dataclass(frozen=True, eq=False)
class Rotor(ss.Machine):
    """A weight that is not balanced, on an axle: it is the sine in its equation that says that it is an angle."""

    torque: float
    omega: float = 2.0

    @property
    def period(self):
        return 2 * pi / self.omega

    def bodies(self):
        return {"rotor": ss.Body(1.0, force=lambda t, x, v: 0.9 + self.torque * sin(self.omega * t) - sin(x) - self.spring(x) - 0.3 * v)}

    def contacts(self):
        return {"bearing": ss.Contact("rotor", ss.Coulomb(0.2, 0.2), load=1.0)}

    def spring(self, x):
        return 0.0


@dataclass(frozen=True, eq=False)
class Wound(Rotor):
    """A spring on its axle tells one turn from the next, though it is so weak that it gives way for hundreds of turns."""

    stiffness: float = 1e-6

    def spring(self, x):
        return self.stiffness * x


class Regulator:
    """It holds a velocity, and what it has integrated fades."""

    states, scales, sample = ("sum",), (1.0,), None

    def start(self, t, x, v):
        return (0.0,)

    def rates(self, t, x, v, z):
        return (2.0 - v["rotor"] - z[0],)

    def sampled(self, t, x, v, z):
        return z

    def forces(self, t, x, v, z):
        return {"rotor": 0.5 * (2.0 - v["rotor"] + z[0])}


class OfPlace(Regulator):
    def forces(self, t, x, v, z):
        return {"rotor": 1e-6 * (2.0 - x["rotor"] + z[0])}


class Regulated(Rotor):
    """Beside it a pin on a spring that hits a stop."""

    regulator = Regulator

    def bodies(self):
        pin = ss.Body(0.1, force=lambda t, x, v: 0.05 * sin(self.omega * t) - 0.1 * v - 0.3 * x)
        return {**super().bodies(), "pin": pin}

    def controllers(self):
        return {"regulator": self.regulator()}

    def stops(self):
        return {("pin", None): ss.Stop(gap=0.02, restitution=0.5)}


class Positioned(Regulated):
    regulator = OfPlace


def test_what_turns_on_settles_and_whole_turns_apart_is_one_attractor():
    """A turn in each period is a motion of period one to runs, the judge and batches; where a spring winds up, nothing repeats yet."""
    run = ss.solve(Rotor(2.0), periods=100)
    assert (run.steadiness.word, run.steadiness.period) == ("steady", 1) and ss.mean_velocity(run) == pytest.approx(2.0, rel=1e-6)
    assert ss.solve(Rotor(2.0), periods=40, method="dop853").steadiness.period == 1
    wound = ss.solve(Wound(2.0, stiffness=[1e-6, 0.0]), periods=200, settle="auto", keep="summary")  # whether it winds up is a number
    assert wound.period.tolist() == [0, 1] and wound.mean_velocity[1] == pytest.approx(2.0, rel=1e-6)
    regulated, judged = (ss.solve(Regulated(2.0), **how) for how in ({"periods": 60}, {"periods": 1, "method": "dop853"}))
    assert regulated.steadiness.period == 1 and ss.mean_velocity(regulated, body="rotor") == pytest.approx(2.0, rel=1e-6)
    assert {event.kind for event in judged.events} >= {"hit"}
    assert regulated.strobe_x[1] == pytest.approx(judged.strobe_x[1], abs=1e-7)  # a hit leaves what the controller holds alone
    many = ss.solve(Rotor([0.5, 2.0, 4.0]), periods=400, settle="auto", keep="summary")
    assert many.mean_velocity == pytest.approx([0.0, 2.0, 2.0], abs=1e-6)
    assert many.period.tolist() == [1, 1, 1] and many.columns["periods_run"].max() < 100 and (many.steadiness == 0).all()
    starts = {"v.angle": [0.0], "x.angle": [0.5, 0.5 + 2 * pi, 0.5 - 4 * pi]}
    (only,) = ss.basins(Pole(), **starts).attractors
    assert only.share == 1.0
    (locked,) = ss.basins(Spun(0.05, 1.0), **{"v.angle": [8.0]}, settle=60).attractors
    assert locked.kind == "periodic" and locked.mean_velocity == pytest.approx(3.0, rel=1e-9)  # a turn in each period
    assert [turning(machine_of(kind()), (0, 1)) for kind in (Pole, Sprung, Hung)] == [(1,), (), (1,)]
    assert [turning(machine_of(kind(2.0)), (0, 1)) for kind in (Regulated, Positioned)] == [(0,), ()]


def test_units_of_columns_follow():
    units = [unit_of_part(column, Hung(), part) for column, part in (("v", "x"), ("v", "angle"), ("slip", "joint"), ("load", "rail"))]
    assert units == ["m/s", "rad/s", "rad/s", "N"]
    assert unit_of_part("v", Hung(), "") == "m/s"  # that of the first coordinate


def test_an_axis_of_lengths_and_angles_leaves_units_to_the_curves():
    run = ss.solve(Hung(), duration=0.3, start={"x": {"angle": 0.5}, "v": {}})
    ax = ss.plot.velocity(run)
    assert ax.get_ylabel() == "velocity $v$"
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["x (m/s)", "angle (rad/s)"]
    assert [text.get_text() for text in ss.plot.forces(run).get_legend().get_texts()] == ["rail (N)", "joint (mN m)"]
    assert run.to_xarray().v.attrs["units"] == "m/s, rad/s"
    plt.close("all")


def test_angles_that_are_no_coordinates_are_refused():
    class Wrong(Hung):
        angles = ("phi",)

    with pytest.raises(ss.InputError, match="angles = "):
        Wrong()


def test_texts_of_angles_are_in_radians():
    from stickslip.show.cli.bodies import _body, _of_body
    from stickslip.show.reports.facts import millimetres
    from stickslip.show.reports.moving import moments
    from stickslip.show.reports.run_charts import velocity

    run = ss.solve(Hung(), duration=0.3, start={"x": {"angle": 0.5}, "v": {}})
    assert _of_body(_body(run, "angle")).count(" rad/s") == 3 and " m/s" in _of_body(_body(run, "x"))
    assert (millimetres(0.5, model=run.model, part="angle"), millimetres(0.5, model=run.model, part="x")) == ("0.5 rad/s", "500 mm/s")
    picture = moments(run)
    assert (picture["lengths"], picture["speeds"]) == ("m, rad", "m/s, rad/s")
    assert picture["bodies"][1]["v"][-1] == pytest.approx(run.v[-1, 1], rel=1e-3)
    assert velocity(run)["up"] == ("velocity v", "")
    assert velocity(ss.solve(ss.Joint.example(), duration=0.1))["up"] == ("velocity v", "rad/s")


def test_sweeps_and_their_files_have_the_units_of_each_part(tmp_path):
    grid = ss.sweep(Hung(), length=[0.4, 0.5], duration=0.2)
    assert (grid.body_velocity.attrs["units"], grid.mean_velocity.attrs["units"]) == ("m/s, rad/s", "m/s")
    ss.studies.export(grid, tmp_path / "grid.csv")
    head = (tmp_path / "grid.csv").read_text(encoding="utf-8").splitlines()[0]
    assert "body_velocity.x [m/s]" in head and "body_velocity.angle [rad/s]" in head


def test_units_of_strobe_states_follow():
    from stickslip.dynamics.attractors.bifurcation_diagrams import state_attrs, velocity_attrs

    units = [state_attrs(name, "on the strobe", Hung())["units"] for name in ("v.x", "v.angle", "x.angle", "l.x")]
    assert units == ["m/s", "rad/s", "rad", "m"]
    joint = ss.Joint.example()
    assert state_attrs("v", "on the strobe", joint)["units"] == velocity_attrs(joint)["units"] == "rad/s"
