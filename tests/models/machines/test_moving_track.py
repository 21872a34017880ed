"""Masses on moving tracks: the step of a stage, the speed of a conveyor, hops with landings; closed formulas and the plain judge."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from stickslip.maths import sin, where
from stickslip.models.drives.shifted import Shifted

DRY = ss.Coulomb(mu_plus=0.1, mu_minus=0.1)
SAW = ss.drives.Sawtooth(stroke=5e-6, rise=0.95e-3, fall=0.05e-3)

SLOW = pytest.mark.slow  # beside the same with another number every day


def step(stroke, rise, fall, mass, friction, against):
    """The published step of a slider on a sawtooth: it slips only as the tip goes back, and comes to rest on it in time."""
    back, forth = (friction + against) / mass, (friction - against) / mass
    assert fall * back / forth <= rise
    return stroke / rise * (rise + fall) - 0.5 * back * fall**2 * (1 + back / forth)


# ---- stages ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("stroke", "rise", "fall", "mass", "load", "mu", "against"),
    [
        (5e-6, 0.95e-3, 0.05e-3, 0.02, 20.0, 0.1, 0.0),
        (5e-6, 0.95e-3, 0.05e-3, 0.02, 20.0, 0.1, 0.3),
        (5e-6, 0.95e-3, 0.05e-3, 0.02, 20.0, 0.1, -0.3),
        (2e-6, 0.4e-3, 0.1e-3, 0.05, 10.0, 0.12, 0.2),
        (20e-6, 1.8e-3, 0.02e-3, 0.01, 30.0, 0.2, -1.0),
    ],
)
def test_a_stage_walks_the_closed_formula(stroke, rise, fall, mass, load, mu, against):
    stage = ss.presets.stick_slip_stage(stroke=stroke, rise=rise, fall=fall, mass=mass, load=load, mu=mu, force=-against)
    expected = step(stroke, rise, fall, mass, mu * load, against)
    assert ss.analysis.step_per_cycle(ss.solve(stage, periods=10)) == pytest.approx(expected, rel=1e-12)
    judged = ss.solve(stage, periods=4, method="dop853", rtol=1e-12)
    assert float(judged.strobe_x[4] - judged.strobe_x[3]) == pytest.approx(expected, rel=1e-11)


def test_a_tilt_pulls_a_stage_as_a_force_does():
    tilt = -0.6  # uphill
    stage = ss.MovingTrack(mass=0.02, along=SAW, friction=DRY, load=20.0, tilt=tilt)
    against = 0.02 * 9.81 * math.sin(0.6)
    assert ss.analysis.step_per_cycle(ss.solve(stage, periods=10)) == pytest.approx(
        step(5e-6, 0.95e-3, 0.05e-3, 0.02, 2.0, against), rel=1e-12
    )


def test_a_stage_in_the_mirror_walks_back():
    stage = ss.presets.stick_slip_stage(force=0.2)
    assert ss.analysis.step_per_cycle(ss.solve(ss.dynamics.mirrored(stage), periods=10)) == pytest.approx(
        -ss.analysis.step_per_cycle(ss.solve(stage, periods=10)), rel=1e-12
    )


def test_a_batch_of_stages_is_each_of_them():
    strokes, loads = np.array([[2e-6], [5e-6], [20e-6]]), np.array([10.0, 20.0])
    many = ss.solve(ss.presets.stick_slip_stage(stroke=strokes, load=loads), periods=10)
    expected = [[step(s, 0.95e-3, 0.05e-3, 0.02, 0.1 * load, 0.0) for load in loads] for s in strokes[:, 0]]
    assert many.mean_velocity * 1e-3 == pytest.approx(np.array(expected), rel=1e-11)


@pytest.mark.slow  # the judge's steps, not ours
@pytest.mark.parametrize("name", ["Coulomb", "LuGre", "elasto-plastic", "GMS"])
def test_smooth_waveforms_walk_back_where_their_stroke_is_small(name):
    """Two harmonics that rise slowly and fall fast; steps over ten cycles from rest by lanes and by the judge, each to 1e-8 in a step."""
    contact = {"sigma0": 1e7, "v_s": 2e-3, "f_plus": None, "f_minus": None}
    law = {
        "Coulomb": ss.Coulomb(0.1, 0.1),
        "LuGre": ss.LuGre(0.1, 0.1, sigma1=100.0, sigma2=0.0, **contact),
        "elasto-plastic": ss.friction.ElastoPlastic(0.1, 0.1, sigma1=100.0, sigma2=0.0, z_ba=1.4e-7, **contact),
        "GMS": ss.friction.GMS(0.1, 0.1, attraction=1e5, **contact),
    }[name]
    A = np.array([7e-6 if name == "Coulomb" else 4.5e-6, 10e-6]) * 0.385
    tip = ss.MultiHarmonic(frequency=1000.0, amplitudes=(A, A / 4), phases=(0.0, np.pi))
    stage = ss.MovingTrack(mass=0.02, along=tip, friction=law, load=20.0)
    found = ss.solve(stage, periods=10, settle=0, keep="summary", rtol=1e-8).displacement
    alone = [stage.replace({"along.amplitudes": (a, a / 4)}) for a in A]
    method = "radau" if name in ("LuGre", "elasto-plastic") else "dop853"
    judged = [np.diff(ss.solve(each, periods=10, settle=0, method=method, rtol=1e-9).x[[0, -1]])[0] for each in alone]
    assert found == pytest.approx(np.array(judged), rel=1e-5, abs=1e-12)
    steps = ss.solve(stage, periods=40, keep="summary").mean_velocity
    assert steps[0] < 0 < steps[1]


# ---- conveyors -------------------------------------------------------------------------------------------------------
def test_a_conveyor_without_hops_has_its_speed():
    run = ss.solve(ss.presets.conveyor(throw_index=0.9), periods=60)
    assert ss.mean_velocity(run) == pytest.approx(0.022453807614, abs=1e-12)
    phases = [event.t / run.period_time % 1 for event in run.events[-2:]]
    assert phases == pytest.approx([0.1213236170, 0.7367936709], abs=1e-9)
    judged = ss.solve(ss.presets.conveyor(throw_index=0.9), periods=40, method="dop853")
    assert ss.mean_velocity(judged) == pytest.approx(0.022453807614, abs=1e-9)


@pytest.mark.parametrize("method", ["exact", "dop853"])
def test_a_conveyor_with_hops_has_its_speed(method):
    run = ss.solve(ss.presets.conveyor(throw_index=2.5), periods=40, method=method)
    assert ss.mean_velocity(run) == pytest.approx(0.130469302441, abs=1e-9)
    last = {event.kind: event.t / run.period_time % 1 for event in run.events}
    assert last["take-off"] == pytest.approx(math.asin(1 / 2.5) / (2 * math.pi), abs=1e-9)
    assert last["landing"] == pytest.approx(0.9228047642, abs=1e-9)
    assert not run.lost_contact


def test_a_slip_that_begins_without_acceleration_goes_on_beside_rounding():
    """Break-away of a law whose friction falls with velocity, on a track in motion: the slip is a difference, and zero to rounding only."""
    kicks = ss.drives.Pieces(durations=(0.008331600033387156, 0.023751674211302875), accelerations=(4.568129831501774, -1.6024062269490562))
    law = ss.Stribeck(
        0.18305265729373094, 0.15207224222760618, 0.21966318875247712, 0.17379684826012134, v_s=0.002, exponent=1.0, viscous=0.4
    )
    track = ss.MovingTrack(
        mass=0.01089761976106259, along=Shifted(kicks, -0.3097876670454349), tilt=-0.09928150942991286, friction=law,
        across=ss.Harmonic(amplitude=0.00038198413946804576, omega=195.83990272499975),
    )  # fmt: skip
    mine, other = ss.solve(track, periods=3), ss.solve(track, periods=3, method="dop853", rtol=1e-11)
    assert any(event.kind == "slip" for event in mine.events)
    t = np.linspace(0.0, 3 * track.period, 100)
    assert mine.at(t)["v"] == pytest.approx(other.at(t)["v"], abs=1e-9)


def test_nothing_rubs_in_flight():
    run = ss.solve(ss.presets.conveyor(throw_index=2.5, tilt_deg=3.0), periods=10)
    left, came = ([event.t for event in run.events if event.kind == kind][-2] for kind in ("take-off", "landing"))
    came = min(event.t for event in run.events if event.kind == "landing" and event.t > left)
    t = np.linspace(left, came, 50)[1:-1]
    at = run.at(t)
    assert np.all(at["friction_force"] == 0.0)
    assert np.all(at["load"] == 0.0)
    assert at["acceleration"] == pytest.approx(9.81 * math.sin(math.radians(3.0)) * np.ones(48), rel=1e-12)
    across, pull = run.model.across, 9.81 * math.cos(math.radians(3.0))
    s = t - left
    above = across.position(left) + across.velocity(left) * s - 0.5 * pull * s**2 - across.position(t)
    assert at["z"][:, 0] == pytest.approx(above, abs=1e-13)  # rounding of positions of a millimetre, three times over


@pytest.mark.parametrize(
    ("method", "restitution"),
    [
        ("exact", 0.0),
        ("exact", 0.4),
        ("exact", 0.8),
        ("dop853", 0.4),
        pytest.param("dop853", 0.0, marks=SLOW),
        pytest.param("dop853", 0.8, marks=SLOW),
    ],
)
def test_rebounds_brake_as_much_as_the_weight_would(method, restitution):
    """A ball that is dropped on a sliding plate: impulses across add up to its weight's, and so do those along, while it slides."""
    still = ss.Harmonic(amplitude=1e-9, omega=1.0)
    drop, speed, mu = 0.02, 3.0, 0.3
    plate = ss.MovingTrack(mass=0.5, along=still, across=still, friction=ss.Coulomb(mu, mu), restitution=restitution)
    run = ss.solve(plate, duration=0.9, method=method, start={"v": speed, "z": {"mass": (drop, 0.0)}})
    landings = [event.t for event in run.events if event.kind == "landing"]
    e, fall = restitution, math.sqrt(2 * drop / 9.81)
    assert landings[0] == pytest.approx(fall, rel=1e-6)  # the plate swings by a nanometre
    assert landings[-1] == pytest.approx(fall * (1 + e) / (1 - e), rel=1e-6)
    assert len(landings) == 1 if e == 0.0 else len(landings) > 10
    assert float(run.v[-1]) == pytest.approx(speed - mu * 9.81 * float(run.t[-1]), abs=1e-6)


def test_a_landing_stops_a_slip_that_is_slow_enough():
    still = ss.Harmonic(amplitude=1e-9, omega=1.0)
    plate = ss.MovingTrack(mass=0.5, along=still, across=still, friction=ss.Coulomb(0.3, 0.3))
    slow, fast = (ss.solve(plate, duration=0.08, start={"v": v, "z": {"mass": (0.02, 0.0)}}) for v in (-0.15, -0.3))
    thrown = 0.3 * math.sqrt(2 * 9.81 * 0.02)  # what the landing can take: mu v_n
    assert 0.15 < thrown < 0.3
    landing = next(event for event in slow.events if event.kind == "landing")
    assert (landing.after, landing.velocity) == (0, pytest.approx(-math.sqrt(2 * 9.81 * 0.02), rel=1e-6))
    after = next(event.t for event in fast.events if event.kind == "landing")
    assert float(fast.at(after)["v"]) == pytest.approx(thrown - 0.3, abs=1e-6)


@pytest.mark.parametrize(
    ("index", "restitution"),
    [(1.2, 0.5), (2.5, 0.0), (4.0, 0.5), *(pytest.param(*other, marks=SLOW) for other in ((1.2, 0.0), (2.5, 0.5), (4.0, 0.0)))],
)
def test_energy_of_hops_is_balanced_to_rounding(index, restitution):
    run = ss.solve(ss.presets.conveyor(throw_index=index, restitution=restitution, tilt_deg=-2.0), periods=12)
    assert any(event.kind == "landing" for event in run.events)
    assert np.max(abs(ss.energy(run).residual)) < 1e-11


def test_lanes_hop_as_single_runs_do():
    grid = ss.sweep(ss.presets.conveyor, throw_index=[0.9, 1.5, 2.5], angle_deg=[20.0, 35.0], periods=60)
    for case in (grid.isel(throw_index=i, angle_deg=k) for i in range(3) for k in range(2)):
        one = ss.solve(ss.presets.conveyor(throw_index=float(case.throw_index), angle_deg=float(case.angle_deg)), periods=60)
        assert float(case.mean_velocity) == pytest.approx(ss.mean_velocity(one), rel=3e-8)  # strobe points agree to 1e-8 where lanes stop


def test_the_time_in_flight_is_a_column():
    aloft = {"aloft": ss.observable(lambda s: where(s.contacts["mass"].load > 1e-9, 0.0, 1.0), reduce="mean")}
    grid = ss.sweep(ss.presets.conveyor, throw_index=[0.9, 2.5], periods=60, observe=aloft)
    expected = [ss.analysis.hops(ss.solve(ss.presets.conveyor(throw_index=g), periods=60)).fraction for g in (0.9, 2.5)]
    assert grid.aloft.values == pytest.approx(expected, abs=0.02)  # noted at the nodes of a quadrature on each step


def test_hops_are_counted():
    found = ss.analysis.hops(ss.solve(ss.presets.conveyor(throw_index=2.5), periods=40))
    assert found.landings == 1
    assert found.fraction == pytest.approx(0.9228047642 - 0.0654949402, abs=1e-9)
    none = ss.analysis.hops(ss.solve(ss.presets.conveyor(throw_index=0.9), periods=40))
    assert (none.landings, none.fraction, none.height) == (0, 0.0, 0.0)


def test_the_throw_index_is_that_of_the_preset():
    indices = np.array([0.5, 1.0, 3.3])
    assert ss.analysis.throw_index(ss.presets.conveyor(throw_index=indices, tilt_deg=4.0)) == pytest.approx(indices, rel=1e-12)
    assert ss.analysis.throw_index(ss.presets.stick_slip_stage()) == 0.0
    kicks = ss.drives.Pieces(durations=(0.01, 0.03), accelerations=(15.0, -5.0))
    thrown = ss.MovingTrack(mass=0.3, along=kicks, across=kicks, friction=DRY)
    assert ss.analysis.throw_index(thrown) == pytest.approx(5.0 / 9.81, rel=1e-12)


# ---- laws with inner states ------------------------------------------------------------------------------------------
def test_a_bristle_lets_go_where_the_load_is_gone():
    track = ss.presets.conveyor(throw_index=1.5, law="lugre")
    run = ss.solve(track, periods=3)
    assert run.lost_contact
    assert float(run.t[-1]) / track.period == pytest.approx(math.asin(1 / 1.5) / (2 * math.pi), abs=1e-4)
    assert any("flies and lands" in note for note in track.notes)


@pytest.mark.slow
@pytest.mark.parametrize("law", ["lugre", "elastoplastic", "gms", "dahl"])
def test_stages_with_inner_states_agree_with_the_judge(law):
    friction = ss.friction.LAWS[law].example()
    soft = {"sigma0": 2e5, "sigma1": 20.0}
    stage = ss.presets.stick_slip_stage().replace(friction=friction.replace(**{k: v for k, v in soft.items() if hasattr(friction, k)}))
    mine, other = ss.solve(stage, periods=4, rtol=1e-9), ss.solve(stage, periods=4, rtol=1e-9, method="radau")
    t = np.linspace(0.0, 4 * stage.period, 300)
    assert mine.at(t)["x"] == pytest.approx(other.at(t)["x"], abs=1e-5 * 5e-6)


# ---- doors -----------------------------------------------------------------------------------------------------------
@each_row("track", [ss.presets.stick_slip_stage(force=-0.1), ss.presets.conveyor(throw_index=2.5, tilt_deg=2.0)], ids=["stage", "conveyor"])
def test_a_track_comes_back_from_its_toml_and_its_run_from_a_file(track, tmp_path):
    assert ss.MovingTrack.from_toml(track.to_toml()) == track
    run = ss.solve(track, periods=4)
    again = ss.load(run.save(tmp_path / "run.nc"))
    assert again.model == track
    assert np.array_equal(again.x, run.x)
    assert again.events == run.events


def test_what_is_wrong_is_said_with_what_to_type():
    wrong = {
        "restitution": (dict(restitution=1.0), "from 0 to below 1"),
        "tilt": (dict(tilt=math.pi / 2), "between -pi/2 and pi/2"),
        "load": (dict(load=0.0), "a positive force"),
        "mass": (dict(mass=-1.0), "a positive mass"),
        "period": (dict(across=ss.Harmonic(1e-4, omega=100.0)), "one common period"),
        "jumps": (dict(along=SAW, across=SAW), "infinite load"),
        "along": (dict(along=3.0), "type along=ss.drives.Sawtooth"),
        "friction": (dict(friction=None), "friction=ss.Coulomb"),
    }
    for name, (changes, said) in wrong.items():
        with pytest.raises(ss.InputError) as error:
            ss.MovingTrack(**{"mass": 0.02, "along": SAW, "friction": DRY} | changes)
        assert said in str(error.value), name
    with pytest.raises(ss.InputError, match="angle_deg"):
        ss.presets.conveyor(angle_deg=90.0)
    with pytest.raises(ss.InputError, match="law"):
        ss.presets.stick_slip_stage(law="glue")
    with pytest.raises(ss.InputError, match="none of its contacts can"):
        ss.analysis.hops(ss.solve(ss.presets.stick_slip_stage(), periods=3))


@dataclass(frozen=True, eq=False)
class Stack(ss.Machine):
    """A body on a body, of which the upper one is told to fly."""

    mass: float = 1.0

    def bodies(self):
        return {"low": ss.Body(self.mass), "high": ss.Body(self.mass)}

    def contacts(self):
        return {"low": ss.Contact("low", DRY), "high": ss.Contact("high", DRY, on="low", restitution=0.0)}


def test_a_body_on_a_body_cannot_be_told_to_fly():
    with pytest.raises(ss.InputError, match="type restitution=None"):
        Stack()


@dataclass(frozen=True)
class Adhesive:
    """Friction of a soft sphere: it grows with a power of the load."""

    mu: float = 0.3

    def sliding(self, v, load):
        return where(v > 0, self.mu, -self.mu) * load**0.8

    def breakaway(self, load):
        return -self.mu * load**0.8, self.mu * load**0.8


def test_a_law_that_knows_no_impulse_is_told_and_loses_contact():
    swing = ss.presets.conveyor(throw_index=1.5)
    with pytest.raises(ss.InputError, match="not proportional to the load"):
        swing.replace(friction=Adhesive())
    assert ss.solve(swing.replace(friction=Adhesive(), restitution=None), periods=2).lost_contact


@dataclass(frozen=True, eq=False)
class Trough(ss.Machine):
    """Two parts on one conveyor, joined by a spring: each flies by itself."""

    index: float
    stiffness: float
    friction: Any
    omega: float = 314.159

    @property
    def period(self):
        return 2 * math.pi / self.omega

    def bodies(self):
        return {"front": ss.Body(0.02), "rear": ss.Body(0.05)}

    def contacts(self):
        along = ss.Harmonic(amplitude=2e-4, omega=self.omega)

        def load(mass, late):
            return lambda t, x: mass * 9.81 * (1.0 - self.index * sin(self.omega * t - late))

        return {
            "front": ss.Contact("front", self.friction, on=along, load=load(0.02, 0.0), restitution=0.0),
            "rear": ss.Contact("rear", self.friction, on=along, load=load(0.05, 1.0), restitution=0.3),
        }

    def links(self):
        return {("front", "rear"): ss.Spring(stiffness=self.stiffness, damping=0.1)}


def test_several_bodies_fly_and_land_each_by_itself():
    trough = Trough(index=1.6, stiffness=300.0, friction=ss.Coulomb(0.3, 0.4))
    mine, other = ss.solve(trough, periods=5), ss.solve(trough, periods=5, method="dop853", rtol=1e-12)
    assert {event.part for event in mine.events if event.kind == "landing"} == {"front", "rear"}
    t = np.linspace(0.0, 5 * trough.period, 300)
    assert mine.at(t)["v"] == pytest.approx(other.at(t)["v"], abs=1e-9)
    assert np.max(abs(ss.energy(mine).residual)) < 1e-11


# ---- orbits ----------------------------------------------------------------------------------------------------------
@pytest.mark.slow
@pytest.mark.parametrize("changes", [{"throw_index": 1.5}, {"throw_index": 2.5, "restitution": 0.2, "mu": 0.1}])
def test_multipliers_of_hops_are_those_of_differences(changes):
    """Through take-offs, landings and rebounds; one orbit is on the track at the strobe, where gap and rate have no change, one flies."""
    track = ss.presets.conveyor(**changes)
    orbit = ss.periodic_orbit(track)
    start = np.array([float(orbit.start["v"]["mass"]), *orbit.start["z"]["mass"]])

    def end(state):
        run = ss.solve(track, periods=1, start={"v": state[0], "z": {"mass": tuple(state[1:])}})
        return np.array([run.strobe_v[-1], *np.ravel(run.strobe_z[-1])])

    steps = np.array([1e-6, 1e-9, 1e-6])  # of velocities, and of a gap of some tenths of a millimetre
    for k in range(3 if start[1] > 0.0 else 1):
        shift = steps[k] * np.eye(3)[k]
        slope = (end(start + shift) - end(start - shift)) / (2 * steps[k])
        assert orbit.monodromy[:, k] == pytest.approx(slope, rel=1e-5, abs=1e-6)
    if start[1] == 0.0:
        assert np.all(orbit.monodromy[:, 1:] == 0.0)
