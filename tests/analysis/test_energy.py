"""Energy per period."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
import pytest

import stickslip as ss
from rows import each_row
from runs import coulomb_run, lugre_run, unit_robot
from stickslip.analysis.steady import velocity_range
from stickslip.basics.fields import leaves
from stickslip.models.machine_adapter import machine_of

ALPHAS = [(0.5, 1.2), (0.7, 0.9), (0.4, 0.8), (0.4, 0.5)]


@each_row("alphas", ALPHAS)
def test_exact_runs_balance_to_rounding(alphas):
    """Rounding of omega t at 200 periods is 1e-13 of the phase: 1e-12 leaves a factor for cancellation."""
    assert ss.energy(coulomb_run(unit_robot(*alphas), 200)).worst < 1e-12


@each_row("alphas", ALPHAS)
def test_friction_takes_its_force_times_the_way(alphas):
    """W_f = mu+ N s+ + mu- N s-, with the ways forwards and backwards taken from the positions at the events."""
    run = coulomb_run(unit_robot(*alphas), 10)
    x = run.at(np.unique(np.concatenate([run.strobe_times, run.pieces.t])))["x"]
    steps, (plus, minus), load = np.diff(x), alphas, run.model.load(0, 0)
    taken = load * (plus * steps[steps > 0].sum() - minus * steps[steps < 0].sum())
    assert ss.energy(run).friction.sum() == pytest.approx(taken, rel=1e-13)


def test_with_true_gravity_its_work_enters():
    robot = ss.presets.piezo_rig(tilt_deg=2.7, amplitude=6.032e-4, law="coulomb", incline="gravity")
    run = coulomb_run(robot, 40)
    e = ss.energy(run)
    fall = robot.total_mass * 9.81 * np.sin(np.radians(2.7)) * np.diff(run.strobe_x)
    assert e.gravity == pytest.approx(fall, rel=1e-12) and e.worst < 1e-12


def test_in_periodic_motion_the_actuator_pays_for_friction():
    """Level track: over a period no energy is stored, so the actuator's work is what friction takes."""
    e = ss.energy(coulomb_run(unit_robot(0.7, 0.9), 20))
    assert e.actuator[-1] == pytest.approx(e.friction[-1], rel=1e-12)
    assert abs(e.kinetic[-1]) < 1e-12


def test_a_robot_at_rest_spends_nothing():
    e = ss.energy(coulomb_run(unit_robot(1.1, 1.2), 3))
    assert e.drive.tolist() == e.friction.tolist() == e.residual.tolist() == [0, 0, 0]


def test_a_dynamic_run_balances_to_its_tolerance():
    """Radau at rtol 1e-6; its cubic dense output is a little worse than its nodes."""
    run = lugre_run(ss.presets.piezo_rig(tilt_deg=2.7, amplitude=6.032e-4), 3, rtol=1e-6)
    e = ss.energy(run)
    assert e.worst < 1e-6 and (e.friction > 0).all()


@each_row("law", [ss.Coulomb(0.18, 0.18), ss.LuGre(0.18, 0.18, 0.21, 0.21, 4e5, 100.0, 0.04, 2e-3)], ids=["coulomb", "lugre"])
def test_the_numbers_of_a_body_that_slides_by_itself_fit_together(law):
    """Its mean velocity lies within its velocities, its balance is judged by the work of gravity, and a note says why it is not steady."""
    robot = ss.presets.piezo_rig(tilt_deg=3, amplitude=7e-4, incline="gravity").replace(friction=law)
    assert robot.notes == [note for note in robot.notes if "slides by itself" not in note]
    run = ss.solve(robot.replace({"track.tilt": 1.0}), periods=30)
    low, high = velocity_range(run)
    e = ss.energy(run)
    missing = e.drive + e.gravity - e.friction - e.kinetic
    assert low < ss.mean_velocity(run) < high and (abs(e.gravity) > abs(e.drive)).all()
    assert 0.2 < e.worst / abs(missing / e.gravity.max())[run.settle :].max() <= 1.0 and e.worst < 1e-4
    assert any("slides by itself" in note and "1.557 of the load" in note for note in run.notes)
    assert any("slides by itself" in note for note in robot.replace({"track.tilt": -1.0}).notes)
    assert any("slides by itself" in note for note in robot.replace({"track.tilt": np.array([0.0, 1.0])}).notes)


TWO_MASSES = ss.Robot(0.06, (0.006, 0.003), (ss.Harmonic(6e-4, omega=200.0), ss.Harmonic(3e-4, omega=400.0)), ss.Coulomb(0.15, 0.21))
#: Machine, how long, what it loses beside its contacts. The tilts are those whose work must stand apart.
MACHINES = {
    "two_modules": (ss.presets.two_modules(), {"periods": 60}, {"module 1-module 2"}),
    "worm": (ss.presets.worm(), {"periods": 20}, set()),
    "worm, gliding": (ss.presets.worm(frequency=6.0, mu_plus=0.15, mu_minus=0.25), {"periods": 20}, set()),
    "capsubot on a slope": (ss.presets.capsubot().replace(track=ss.Incline(tilt=-0.02)), {"periods": 60}, {"inner-body"}),
    "capsule": (ss.presets.capsule(), {"periods": 60}, {"inner-body", "inner-body (stop)"}),
    "stick_slip_stage": (ss.presets.stick_slip_stage(force=-0.5), {"periods": 20}, set()),
    "conveyor on a slope": (ss.presets.conveyor(throw_index=2.5, tilt_deg=-3.0, restitution=0.3), {"periods": 40}, set()),
    "servo": (ss.presets.servo(), {"duration": 10.0}, set()),
    "several inner masses": (TWO_MASSES, {"periods": 20}, set()),
}


@each_row("name", MACHINES)
def test_the_energy_of_every_preset_is_balanced_to_rounding_with_a_loss_for_each_part(name):
    """Exact runs: some hundred steps in a period, each to rounding of works that are up to ten times what is left."""
    model, length, links = MACHINES[name]
    run = ss.solve(model, **length)
    balance = ss.energy(run)
    assert run.method == "exact" and balance.worst < 1e-11 and abs(balance.residual).max() < 1e-6
    assert set(balance.friction_of) == set(run.contacts) and set(balance.damping_of) == links
    assert sum(balance.friction_of.values()) == pytest.approx(balance.friction, rel=1e-14) and (balance.friction > 0).any()
    assert sum(balance.damping_of.values(), 0.0 * balance.damping) == pytest.approx(balance.damping, rel=1e-14)


@each_row("name", ["capsubot on a slope", "conveyor on a slope"])
def test_gravity_of_a_machine_is_the_weight_of_each_body_times_its_way_down(name):
    """The ways come from the strobe points, and the work from the forces between them."""
    model, length, _ = MACHINES[name]
    run = ss.solve(model, **length)
    weights = [float(body.mass) * 9.81 for body in machine_of(model).mechanics.parts.values()]
    slope = np.sin(model.tilt if isinstance(model, ss.MovingTrack) else model.track.tilt)
    assert ss.energy(run).gravity == pytest.approx(np.diff(run._strobe[0], axis=0) @ weights * slope, rel=1e-10, abs=1e-15)


def test_what_prescribes_distances_gives_what_friction_takes():
    """A worm of equal feet that hands over: in each period every foot is dragged the same way, and each pays a third."""
    balance = ss.energy(ss.solve(ss.presets.worm(), periods=20))
    taken = 0.05 * 9.81 * 0.1 * 3 * 2e-3  # each foot goes 3 a in a period, and never back where one always holds
    assert balance.drive[-1] == pytest.approx(3 * taken, rel=1e-12) and balance.kinetic[-1] == pytest.approx(0.0, abs=1e-15)


def test_what_moves_bodies_apart_is_found_beside_gravity_and_springs():
    """A force that a link gives is a force of the machine: a told distance against a spring stores in it what it gives."""

    @dataclass(frozen=True, eq=False)
    class Press(ss.Machine):
        period = 0.5

        def bodies(self):
            return {"a": ss.Body(0.1), "b": ss.Body(0.1)}

        def contacts(self):
            return {"a": ss.Contact("a", ss.Coulomb(5.0, 5.0))}

        def links(self):
            return {("b", "a"): (ss.Harmonic(amplitude=1e-3, frequency=2.0), ss.Spring(800.0))}

    balance = ss.energy(ss.solve(Press(), duration=0.125))
    assert balance.potential[-1] == pytest.approx(0.5 * 800.0 * 1e-6, rel=1e-12) and balance.worst < 1e-12


_DRIVEN, _UNDRIVEN = ss.Harmonic(amplitude=1e-3, omega=10.0), ss.Harmonic(amplitude=0.0, omega=10.0)
_SMOOTH = ss.LuGre(0.18, 0.18, 0.21, 0.21, 4e5, 100.0, 0.04, 2e-3)
_OSCILLATOR = ss.ForcedOscillator(1.0, 1.0, 0.0, 0.7, ss.Coulomb(0.0, 0.0), damping=0.3)
#: Right runs: machines that move, that hardly move, that rest, that exchange energy without losing any, and that have lost all of it.
RIGHT = {
    **{
        f"{law} at {amplitude} m on {tilt} degrees": (ss.presets.piezo_rig(tilt_deg=tilt, amplitude=amplitude, law=law), {"periods": 30})
        for law in ("lugre", "coulomb-static") for amplitude in (1e-6, 2e-5, 6e-4) for tilt in (0.0, 1.7)
    },
    "no friction": (ss.Robot(1.0, 0.5, _DRIVEN, ss.Coulomb(0.0, 0.0)), {"periods": 60}),
    "nearly no friction": (ss.Robot(1.0, 0.5, _DRIVEN, ss.Coulomb(1e-9, 2e-9)), {"periods": 60}),
    "coasting without friction": (ss.Robot(1.0, 0.5, _UNDRIVEN, ss.Coulomb(0.0, 0.0)), {"periods": 60, "start": {"v": 1.0}}),
    "coasting to rest": (ss.Robot(1.0, 0.5, _UNDRIVEN, _SMOOTH), {"periods": 30, "start": {"v": 1.0}}),
    "undamped oscillator": (_OSCILLATOR.replace(damping=0.0), {"periods": 60, "start": {"x": 1.0}}),
    "oscillator that has come to rest": (_OSCILLATOR, {"periods": 60, "start": {"x": 1.0}}),
    "bristles that have come to rest": (_OSCILLATOR.replace(friction=_SMOOTH), {"periods": 60, "start": {"x": 1.0}}),
    "block on a belt without friction": (ss.BlockOnBelt(1.0, 2.0, 0.1, ss.Coulomb(0.0, 0.0)), {"duration": 30.0, "start": {"x": 1.0}}),
}  # fmt: skip


@each_row("name", RIGHT)
def test_the_residual_of_a_right_run_is_small_whatever_it_exchanges(name):
    model, how = RIGHT[name]
    balance = ss.energy(ss.solve(model, **how))
    assert balance.worst <= abs(balance.residual).max() < 1e-6


@each_row(
    ("model", "number", "how"),
    [
        (ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="lugre"), "friction.sigma0", {"periods": 30}),
        (ss.presets.piezo_rig(tilt_deg=1.7, amplitude=6e-4, law="coulomb"), "friction.mu_plus", {"periods": 30}),
        (ss.presets.two_modules(), "modules.0.friction.mu_minus", {"periods": 30}),
        (ss.presets.capsule(), "friction.mu_plus", {"periods": 30}),
        (
            ss.Robot(1.0, 0.5, _UNDRIVEN, ss.Coulomb(0.01, 0.01)),
            "friction.mu_plus",
            {"periods": 30, "start": {"v": 1.0}},
        ),
        (_OSCILLATOR, "damping", {"periods": 60, "start": {"x": 1.0}}),
        (ss.BlockOnBelt(1.0, 2.0, 0.1, ss.Coulomb(0.2, 0.2, 0.3, 0.3), load=1.0), "stiffness", {"duration": 9.0}),
    ],
    ids=["lugre", "coulomb", "modules", "capsule", "coasting", "oscillator", "belt"],
)
def test_the_residual_of_a_wrong_run_grows_with_what_is_wrong(model, number, how):
    """The motion of a machine is balanced with the forces of one of whose numbers a part is wrong: in proportion to that part."""
    run, right = ss.solve(model, **how), dict(leaves(model))[number]
    wrong = (dataclasses.replace(run, model=model.replace({number: right * (1 + part)})) for part in (1e-3, 1e-1))
    small, large = (abs(ss.energy(each).residual).max() for each in wrong)
    assert small > 1e-5 and large == pytest.approx(100 * small, rel=0.15)
