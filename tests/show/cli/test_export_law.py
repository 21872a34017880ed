"""Laws taken elsewhere: compiled C and Octave beside Python, TOML read back, and a MuJoCo joint held against the law that it stands for."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from compiled import CC, OCTAVE, compiled_laws, octave_steps
from rows import each_row
from stickslip.analysis.bench.contact import MovedContact, constant_velocity
from stickslip.analysis.bench.probe import Probe
from stickslip.engine.traced_law import TracedLaw
from stickslip.friction import LAWS
from stickslip.maths import tanh, where
from stickslip.models.friction.law_adapter import adapted

LOAD = 0.7
needs_cc = pytest.mark.skipif(CC is None, reason="there is no C compiler here (cc, gcc or clang)")
needs_octave = pytest.mark.skipif(OCTAVE is None, reason="there is no Octave here")


@dataclass(frozen=True)
class TwoBonds:
    """A law of a user's own: two inner states that pull on each other, and a name that C keeps for itself."""

    k: float
    double: float

    states = 2

    def rate(self, v: Any, z: Any, load: Any) -> Any:
        """The second follows the first."""
        a, b = z
        return v - abs(v) * self.k * a / (0.2 * load) - 50.0 * (a - b), self.double * (a - b)

    def force(self, v: Any, z: Any, zdot: Any, load: Any) -> Any:
        """Both pull."""
        return self.k * (0.8 * z[0] + 0.2 * z[1]) + 0.05 * tanh(v / 1e-3) * load


@dataclass(frozen=True)
class Slipping:
    """A bond that breaks at a deflection and begins again, without any memory."""

    k: float
    reach: float

    states = 1
    modes = 1

    def rate(self, v: Any, z: Any, load: Any, mode: Any) -> Any:
        """It bends with the body."""
        return 1.0 * v

    def force(self, v: Any, z: Any, zdot: Any, load: Any, mode: Any) -> Any:
        """A spring."""
        return self.k * z + where(mode[0] >= 3.0, 0.01, 0.0)

    def switches(self, v: Any, z: Any, load: Any, mode: Any) -> Any:
        """It breaks on either side, and counts."""
        return [(self.reach - z, (mode[0] + 1,), 0.25 * self.reach), (self.reach + z, (mode[0] + 1,), -0.25 * self.reach)]


def _laws() -> dict[str, Any]:
    found = {name: kind.example() for name, kind in LAWS.items() if adapted(kind.example()).compiles}
    found["brittle"] = ss.Dahl(0.15, 0.21, sigma0=4e5, exponent=0.6)
    found["slip_law"] = ss.friction.RateState(mu0=0.18, a=0.01, b=0.02, Dc=2e-6, v0=1e-3, evolution="slip")
    found["dry_and_oil"] = ss.Stribeck.example() + ss.Viscous.example()
    found["bristle_and_oil"] = ss.friction.GMS.example() + ss.Viscous.example()
    return {**found, "two_bonds": TwoBonds(k=4e5, double=300.0), "slipping": Slipping(k=4e5, reach=3e-7)}


EVERY = _laws()
MOVED = [name for name, law in EVERY.items() if adapted(law).states]


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Any:
    return compiled_laws(EVERY, tmp_path_factory.mktemp("laws"))


def _places(law: Any, count: int, seed: int) -> Any:
    """Velocities of all sizes and signs, with zero, and states and modes within and around what is usual."""
    rng, own, probe = np.random.default_rng(seed), adapted(law), Probe(law, LOAD)
    for i in range(count):
        v = 0.0 if i == 0 else float(rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-9, 0))
        z = tuple(float(s * rng.uniform(-1.2, 1.2)) for s in probe.scale)
        yield v, z, tuple(int(m) for m in rng.integers(-1, 2, own.modes)), float(rng.normal() * 0.3)


@needs_cc
@each_row("name", EVERY)
def test_compiled_c_gives_the_forces_and_rates_of_python(name: str, compiled: Any) -> None:
    law, c = adapted(EVERY[name]), compiled[name]
    for v, z, mode, applied in _places(EVERY[name], 200, seed=5):
        if not law.dynamic:
            low, high = law.breakaway(LOAD)
            expected = law.sliding(v, LOAD) if v else min(max(applied, low), high)
            assert c.breakaway(LOAD) == pytest.approx((low, high), rel=1e-14)
        else:
            expected, rates = law.response(v, z, LOAD, mode, applied)
            if z:
                # what rounding makes of the terms of a rate, which cancel as sliding becomes steady
                room = 1e-13 * (abs(v) + max(abs(rate) for rate in rates)) + 1e-12 * max(abs(rate) for rate in rates)
                assert c.rate(v, LOAD, z, mode) == pytest.approx(list(rates), rel=1e-11, abs=room)
        assert c.force(v, LOAD, z, mode, applied) == pytest.approx(float(expected), rel=1e-11, abs=1e-14), (v, z, mode)


#: A way with reversals, rests, slow and fast stretches: velocities of the steps.
WAY = [v for v in (1e-3, 3e-3, -2e-3, 0.0, 1e-4, 0.0, -5e-3, 2e-2, -1e-4) for _ in range(8)]


def _by_python(law: Any, velocities: list[float], dt: float) -> list[float]:
    """The same way by the integrator of the bench, which shares nothing with the exported step but the law."""
    moved = MovedContact(Probe(law, LOAD), 0.1 * LOAD * 1e-6, rtol=1e-10)
    found, side = [], 0.0
    for v in velocities:
        if side * v < 0 or (side and v == 0.0):
            moved.z, moved.mode = moved.probe.law.passed_zero(moved.z, LOAD, moved.mode, int(side))
        moved.follow(dt, constant_velocity(v or math.copysign(1e-300, side)))  # at rest time passes: contacts age
        side = math.copysign(1.0, v) if v else 0.0
        found.append(float(moved.probe.force(v, moved.z, moved.mode)))
    return found


@needs_cc
@each_row("name", MOVED)
def test_steps_of_c_follow_the_integrated_law(name: str, compiled: Any) -> None:
    law = EVERY[name]
    exact = TracedLaw(law).exact
    dt = 2e-5 if exact else 2e-6
    expected = np.array(_by_python(law, WAY, dt))
    errors = []
    for parts in (1, 2, 4) if not exact else (1,):
        steps = [v for v in WAY for _ in range(parts)]
        errors.append(np.abs(np.array(compiled[name].steps(steps, LOAD, dt / parts))[parts - 1 :: parts] - expected).max())
    room = 1e-6 * np.abs(expected).max()  # the integrator's tolerance, over some hundred steps
    assert errors[-1] < room if exact else errors[-1] < max(0.35 * errors[0], room), errors


HOLDING = [name for name, law in EVERY.items() if not adapted(law).dynamic and adapted(law).breakaway(LOAD)[1] > 0]


@needs_cc
@each_row("name", HOLDING)
def test_a_body_under_the_c_step_of_a_set_valued_law_stops_and_stays(name: str, compiled: Any) -> None:
    c, mass, dt, v = compiled[name], 0.3, 1e-4, 0.05
    low, high = c.breakaway(LOAD)
    applied = 0.5 * high  # all of these slide under more
    for _ in range(4000):
        v += dt * (applied - c.held(v, LOAD, applied + mass * v / dt)) / mass
    assert abs(v) < 1e-16  # the rounding of v + dt (applied - R) / mass
    assert [c.held(0.0, LOAD, share * low) for share in (0.3, 1.2)] == pytest.approx([0.3 * low, low])
    assert c.held(0.0, LOAD, 1.2 * high) == pytest.approx(high)


@needs_cc
def test_a_braking_block_stops_where_the_textbook_says(compiled: Any) -> None:
    law, c, mass, v, x, dt = EVERY["coulomb"], compiled["coulomb"], 0.3, 0.5, 0.0, 1e-5
    while v > 1e-15:
        R = c.held(v, LOAD, mass * v / dt)
        x += dt * (v - 0.5 * dt * R / mass)
        v -= dt * R / mass
    assert x == pytest.approx(0.5**2 * mass / (2 * law.mu_plus * LOAD), rel=2 * dt / (0.5 * mass / (law.mu_plus * LOAD)))


@needs_octave
def test_octave_gives_the_forces_of_c_and_python(tmp_path: Any, compiled: Any) -> None:
    found = octave_steps(EVERY, WAY, LOAD, 2e-6, tmp_path)
    for name, law in EVERY.items():
        own, c = adapted(law), compiled[name]
        expected = c.steps(WAY, LOAD, 2e-6) if own.states else [c.force(v, LOAD, applied=0.07) for v in WAY]
        assert found[name] == pytest.approx(expected, rel=1e-9, abs=1e-12), name


def test_numbers_of_a_fit_go_into_the_text() -> None:
    law = ss.LuGre(0.1234567890123456, 0.21, None, None, sigma0=4e5, sigma1=100.0, sigma2=0.04, v_s=2e-3)
    for language in ("c", "matlab", "octave", "toml"):
        assert "0.1234567890123456" in ss.export_law(law, language).text
    robot = ss.presets.piezo_rig(tilt_deg=0.0, amplitude=6e-4).replace(friction=law)
    assert ss.export_law(robot, "c").text == ss.export_law(law, "c").text


def test_the_law_of_a_joint_goes_too() -> None:
    joint = ss.Joint(inertia=0.01, friction=ss.Coulomb(0.02, 0.02), torque=0.1)
    assert ss.export_law(joint, "matlab").text == ss.export_law(joint.friction, "matlab").text
    hinge = ss.export_law(joint, "mujoco", speeds=(0.01, 1.0))
    assert hinge.numbers["frictionloss"] == pytest.approx(0.02)
    assert "to 1 rad/s both ways" in hinge.text and " m/s" not in hinge.text
    # of a servo the law is that of its load, whose friction was left out: one of 1 N m was written
    load = ss.machines.ServoLoad(base=0.1, viscous=0.035, stribeck=0.05, v_s=0.8, exponent=1.3)
    servo = ss.Joint(0.01, ss.Coulomb(1.0, 1.0), load=load, motor=ss.machines.Motor(k_t=2.0, resistance=3.0), voltage=1.0)
    numbers = tomllib.loads(str(ss.export_law(servo, "toml")))["robot"]["friction"]
    law, none = ss.Stribeck(**{k: v for k, v in numbers.items() if k != "kind"}), {"motor": 0.0, "gravity": 0.0}
    v = [1e-3, 0.3, 2.0, 9.0]
    steady = law.coefficient(np.array(v)) + law.viscous * np.array(v)
    assert steady == pytest.approx([load(0.0, 0.0, each, none) for each in v], rel=1e-12)
    assert ss.export_law(servo.replace({"load.stribeck": 0.0}), "mujoco", speeds=(0.1, 5.0)).numbers["frictionloss"] == pytest.approx(0.1)
    with pytest.raises(ss.InputError, match=r"grows with its torques \(motor, external_quad\).*export_fmu"):
        ss.export_law(servo.replace({"load.motor": 0.1, "load.external_quad": 0.01}), "c")


@each_row("name", LAWS)
def test_toml_reads_back_as_the_same_law(name: str) -> None:
    law = LAWS[name].example()
    table = tomllib.loads(ss.export_law(law, "toml").text)["robot"]["friction"]
    kind = LAWS[table.pop("kind")]
    again = kind(**{key: tuple(value) if isinstance(value, list) else value for key, value in table.items()})
    assert repr(again) == repr(law)


@pytest.mark.parametrize("name", ["coulomb", "stribeck", "viscous", "lugre", "ratestate"])
def test_no_other_mujoco_joint_is_nearer_and_the_error_is_the_one_stated(name: str) -> None:
    law, low, high = EVERY[name], 2e-3, 0.2
    found = ss.export_law(law, "mujoco", load=LOAD, speeds=(low, high)).numbers
    speeds = np.geomspace(low, high, 41)
    own, probe = adapted(law), Probe(law, LOAD)

    def friction(v: float) -> float:
        if not own.states:
            return abs(float(own.force(v, (), (), LOAD)))
        moved = MovedContact(probe, 1e-6)
        moved.follow(2e-4 / abs(v), constant_velocity(v))  # far beyond the deflections of these laws
        return abs(moved.force(v))

    forces = np.array([[friction(side * v) for v in speeds] for side in (1.0, -1.0)])

    def error(dry: float, viscous: float) -> float:
        return float(np.abs(dry + viscous * speeds - forces).max())

    assert error(found["frictionloss"], found["damping"]) == pytest.approx(found["error"], rel=1e-6)
    size = found["largest"]
    for dry, viscous in np.random.default_rng(1).normal(size=(300, 2)) * [0.1 * size, 0.1 * size / high]:
        other = max(found["frictionloss"] + dry, 0.0), max(found["damping"] + viscous, 0.0)
        assert error(*other) > found["error"] * (1 - 1e-6)


def test_what_cannot_be_written_is_said_in_words() -> None:
    with pytest.raises(ss.InputError, match="solved in plain Python alone"):
        ss.export_law(ss.friction.Bristle.example(), "c")
    with pytest.raises(ss.InputError, match="did you mean 'c'"):
        ss.export_law(ss.Coulomb.example(), "cc")
    with pytest.raises(ss.InputError, match="speeds is missing"):
        ss.export_law(ss.Coulomb.example(), "mujoco")
    with pytest.raises(ss.InputError, match="arrays"):
        ss.export_law(ss.Coulomb([0.1, 0.2], 0.1), "matlab")
    with pytest.raises(ss.InputError, match="a range above it"):
        ss.export_law(ss.friction.Karnopp.example(), "mujoco", speeds=(1e-4, 0.1))
    with pytest.raises(ss.InputError, match="contacts; allowed is one with one contact"):
        ss.export_law(ss.Chain.example(), "c")
    with pytest.raises(ss.InputError, match="name = 'step'"):
        ss.export_law(ss.Coulomb.example(), "matlab", name="step")
