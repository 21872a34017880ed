"""Servos from command and angle alone: logs of a bench in plain Python, whose numbers are known."""

from types import SimpleNamespace

import numpy as np
import pytest

import stickslip as ss
from bam_bench import COUNT, chirp, pendulum, shown, sines, swung
from stickslip.inverse.identification import ranking as of_ranking
from stickslip.inverse.identification.commanded_logs import command_log
from stickslip.inverse.identification.rounding import rounding_columns
from stickslip.inverse.identification.structure import Left, structures
from stickslip.inverse.identification.uncertainty import faults
from stickslip.models.naming import axis_of
from stickslip.solvers.followed import followed

STEP, KP, SUPPLY = 0.01, 38.0, 14.4
M1 = {"kt": 2.19, "R": 2.96, "armature": 0.0266, "friction_base": 0.1035, "friction_viscous": 0.0352}
M6 = {
    "kt": 2.21, "R": 2.03, "armature": 0.026, "friction_base": 0.01, "friction_stribeck": 0.12, "friction_viscous": 0.05,
    "load_friction_motor": 0.2, "load_friction_external": 0.02, "load_friction_motor_stribeck": 0.2,
    "load_friction_external_stribeck": 0.09, "load_friction_motor_quad": 0.01, "load_friction_external_quad": 0.05,
    "dtheta_stribeck": 1.75, "alpha": 1.14,
}  # fmt: skip


def servo(p=M1, mass=1.0):
    """The joint of a parameter set on the bench, commanded by an angle."""
    inertia, gravity = pendulum(mass, 0.15, 0.1)
    motor = ss.machines.Motor(k_t=p["kt"], resistance=p["R"], supply=SUPPLY)
    control = ss.machines.PID(kp=KP, ki=0.0, kd=0.0, target=0.0)
    return ss.Joint(
        inertia=inertia, gravity_torque=gravity, motor_inertia=p["armature"], motor=motor, control=control,
        friction=ss.Coulomb(1.0, 1.0), load=ss.machines.ServoLoad.from_bam(p),
    )  # fmt: skip


def angles(p, mass, command, duration, parts=8):
    t = np.arange(0, duration, STEP)
    return t, command(t), swung(p, *pendulum(mass, 0.15, 0.1), KP, SUPPLY, command(t), STEP, parts)


def log(p, mass, command, duration, seed):
    t, goal, q = angles(p, mass, command, duration)
    return ss.Record.of(t, {"command [rad]": goal, "angle [rad]": shown(q, seed)})


@pytest.mark.parametrize(("p", "command"), [(M1, chirp), (M6, sines)], ids=["M1, chirp", "M6, sines"])
def test_a_command_that_holds_between_its_samples(p, command):
    """Against steps of Runge and Kutta that stop where the velocity does, 4 and 16 in each sample: they come nearer as their square."""
    (t, goal, few), (_, _, many) = (angles(p, 1.0, command, 3.0, parts) for parts in (4, 16))
    x, v = followed(servo(p), np.append(t, 3.0), {"control.target": goal})
    near = abs(many - x[0, :-1]).max()
    assert near < 2e-5 and near < 0.15 * abs(few - x[0, :-1]).max() and abs(v).max() > 1.0
    assert x.shape == (1, len(t) + 1)


def test_friction_inertia_and_motor_of_a_servo_from_one_log():
    """Coulomb friction, armature, k_t and R from 4 s of command and counts: within 3.5 standard errors, and these are small."""
    rec = log(M1, 1.0, chirp, 4.0, seed=3)
    free = {"motor_inertia": (1e-3, 0.1), "load.base": (0.0, 0.3), "motor.k_t": (1.0, 3.0), "motor.resistance": (1.0, 6.0)}
    guess = servo().replace({"motor_inertia": 0.02, "motor.k_t": 2.0, "motor.resistance": 3.5, "load.base": 0.05})
    fit = ss.identify(rec, guess, free=free, starts=1)
    true = dict(zip(free, (M1["armature"], M1["friction_base"], M1["kt"], M1["R"]), strict=True))
    assert not fit.undetermined
    for name, value in true.items():
        assert abs(fit.values[name] - value) < 3.5 * fit.errors[name] < 0.2 * value, name
    rest = fit.predicted[0] - rec["angle"].si
    assert np.std(rest) == pytest.approx(2 * np.pi / 4096 * np.hypot(0.3, 1 / np.sqrt(12)), rel=0.15)
    assert "angle: rms" in fit.report() and set(fit.sensor) == {"delay", "zero", "begin"}
    # a tenth of a second is missing: what depends on the command in it is left out, and the rest follows the interpolated one
    t, goal, true = angles(M1, 1.0, sines, 4.0)
    y, there = shown(true, 5), (t < 2.0) | (t > 2.1)
    holes = command_log(servo(), ss.Record.of(t[there], {"command [rad]": goal[there], "angle [rad]": y[there]}), None, "record 0")
    x, _ = followed(servo(), holes.instants, {"control.target": holes.command})
    off = abs(np.interp(t, holes.instants, x[0]) - true)
    kept = np.isin(np.round(t, 9), np.round(holes.t, 9))
    assert off[kept].max() < 0.25 * holes.sigma < off[there & ~kept].max() and 20 < (there & ~kept).sum() < 200
    assert "the command is interpolated" in holes.cut and axis_of("control.kp", servo())[1] == "V/rad"
    assert servo().friction_name == "servo model M1"


def test_a_friction_that_is_not_there_ends_at_zero_and_is_no_fault(monkeypatch):
    """A servo without Coulomb friction: base = 0 is supported where it stands alone, and superfluous beside the law without it."""
    rec = log({**M1, "friction_base": 0.0}, 1.0, chirp, 3.0, seed=4)
    free = {"motor_inertia": (1e-3, 0.1), "load.viscous": (0.0, 0.3)}
    fits = {name: ss.identify(rec, servo().replace({"load.base": begin}), free=free | more, starts=1)
            for name, begin, more in (("viscous", 0.0, {}), ("with base", 0.05, {"load.base": (0.0, 0.3)}))}  # fmt: skip
    both, ranking = fits["with base"], ss.identification.rank(fits)
    assert both.point[2] < 1e-6 and faults(both) == [] and any("it is not negative" in said for said in both.warnings)
    assert ranking.supported == ("viscous",) and any("which makes it viscous" in fault for fault in ranking.rows[1].faults)
    # beside another part that does something, one that ends at zero says nothing against the law
    monkeypatch.setattr(of_ranking, "at_zero", lambda fit: ["load.external"])
    monkeypatch.setattr(of_ranking, "faults", lambda fit: [])
    for more, said in ((("load.external",), 1), (("load.external", "load.motor_quad"), 0)):
        laws = {"M5": SimpleNamespace(names=("load.base",)), "M6": SimpleNamespace(names=("load.base", *more))}
        assert len(of_ranking._superfluous(laws["M6"], "M6", laws, dict.fromkeys(laws, (0.0, 0.0)))) == said


def test_angles_that_a_model_cannot_follow_within_their_noise_leave_no_narrow_interval():
    """With a tenth too much gravity: the noise of an angle shows by itself, residuals are beyond it, and intervals grow by that."""
    rec, gravity = log(M1, 1.0, chirp, 4.0, seed=3), pendulum(1.0, 0.15, 0.1)[1]
    free = {"motor_inertia": (1e-3, 0.1), "load.base": (0.0, 0.3), "motor.k_t": (1.0, 3.0)}
    fits = [ss.identify(rec, servo().replace({"gravity_torque": G}), free=free, starts=1) for G in (gravity, 1.1 * gravity)]
    right, wrong = fits
    assert faults(right) == [] and right.misfit.is_none
    assert right.quality[0].noise == pytest.approx(2 * np.pi / 4096 * np.hypot(0.3, 1 / np.sqrt(12)), rel=0.15)
    assert wrong.misfit.factor > 1.5 and any("where the noise is" in said for said in faults(wrong))
    assert wrong.errors["load.base"] > 3 * right.errors["load.base"]


def test_rounding_to_counts_is_noise_that_stays_while_the_servo_rests():
    """Products of what 4000 places of the counts make of three angles, beside the closed form; noise of a count hides the rounding."""
    h, noise = np.array([0.0, 0.3, 0.75]), np.random.default_rng(1)
    for before in (0.0, 0.2):
        places, size = noise.uniform(0, 1, (4000, 1)), np.sqrt(before**2 + 1 / 12)
        shown = np.round(h + places + noise.normal(0, before, (200, 4000, 3))).mean(axis=0) - h - places
        columns = columns_of(np.array([0.0, 1.0, 2.0]), h, size)
        assert columns @ columns.T == pytest.approx(shown.T @ shown / 4000, abs=0.005)
    assert columns_of(np.array([0.0, 1.0, 2.0]), h, np.hypot(1.0, np.sqrt(1 / 12))).shape == (3, 0)


def columns_of(y, h, size):
    """`rounding_columns` of one record of values y, for which a model has h, with so large a noise; in the unit of the values."""
    target = SimpleNamespace(within=0.0)
    problem = SimpleNamespace(y=y, sigma=np.full(len(y), size), targets=[target], parts=lambda each: [each])
    return rounding_columns(problem, (h - y) / size, 1.0)[0] * size


def test_the_motion_of_a_servo_that_rests_between_counts_is_not_blamed_on_its_law():
    """Of 60 logs of a true model at most one has structure (an angle that its noise moves is no place); with a count more all do."""
    t = np.arange(0, 6, 0.01)
    true, blamed = np.interp(t, [0, 1, 3, 4, 6], [0.0, 1.2, 1.2, 0.9, 0.9]), {0.0: 0, 1.0: 0}
    for seed in range(60):
        zero, noise = COUNT * np.random.default_rng(seed).uniform(), (0.0, 0.3, 1.0)[seed % 3]
        y = shown(true + zero, seed, noise) - zero
        log = command_log(servo(), ss.Record.of(t, {"command [rad]": true, "angle [rad]": y}), None, "record 0")
        for wrong in blamed:
            rest = (true + wrong * COUNT * (true > 1.0) - y) / COUNT
            problem = SimpleNamespace(y=y, sigma=np.full(len(t), COUNT), targets=[log], parts=lambda each: [each])
            own = rounding_columns(problem, rest, float(np.std(rest)))[0]
            left = Left(y + rest * COUNT, rest, np.ones(len(t), bool), np.zeros((len(t), 0)), own)
            blamed[wrong] += bool(structures(log, left))
    assert blamed[0.0] <= 1 and blamed[1.0] == 60, blamed


@pytest.mark.slow
def test_what_two_loads_do_not_tell_apart_is_said_before_the_search_and_after_it():
    """k_t/R and k_t²/R + c is all that Coulomb friction shows of k_t, R and c, whatever the load; friction and inertia are determined."""
    masses, commands = (1.0, 0.5), (chirp, sines)
    records = [log(M1, mass, command, 3.0, seed) for seed, (mass, command) in enumerate(zip(masses, commands, strict=True))]
    arms = [pendulum(mass, 0.15, 0.1) for mass in masses]
    free = {"motor_inertia": (1e-3, 0.1), "load.base": (0.0, 0.3), "load.viscous": (0.0, 0.3), "motor.k_t": (1.0, 3.0)}
    free["motor.resistance"] = (1.0, 6.0)
    guess = servo().replace({"motor_inertia": 0.02, "load.base": 0.08})
    fit = ss.identify(records, guess, free=free, starts=1, inertia=[J for J, _ in arms], gravity_torque=[G for _, G in arms])
    confounded = {"motor.k_t", "motor.resistance", "load.viscous"}
    assert set(fit.undetermined) == confounded and len(fit.combinations) == 2
    assert any("at the guess" in note and all(name in note for name in confounded) for note in fit.notes)
    k_t, R, c = fit.values["motor.k_t"], fit.values["motor.resistance"], fit.values["load.viscous"]
    assert k_t / R == pytest.approx(M1["kt"] / M1["R"], rel=0.01)
    assert k_t**2 / R + c == pytest.approx(M1["kt"] ** 2 / M1["R"] + M1["friction_viscous"], rel=0.005)
    for name, value in (("motor_inertia", M1["armature"]), ("load.base", M1["friction_base"])):
        assert abs(fit.values[name] - value) < 3.5 * fit.errors[name] < 0.2 * value, name
