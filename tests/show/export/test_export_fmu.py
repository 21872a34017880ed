"""Machines as units of FMI 3: the numbers and events of `solve`, saved states, Model Exchange, and what is refused."""

from __future__ import annotations

import random
import zipfile
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import stickslip as ss
from blocks import row
from every import with_bodies
from fmu_units import Unit
from rows import each_row
from stickslip.maths import sin
from stickslip.show.export.fmu import building

needs_cc = pytest.mark.skipif(building.compiler() is None, reason="there is no C compiler here (gcc, clang or cc)")
WARNING = ("-Wall", "-Wextra", "-Werror", "-O0")


@dataclass(frozen=True, eq=False)
class Hammer(ss.Machine):
    """A capsule in which a driven mass hits a wall that throws it back."""

    capsule: float
    mass: float
    push: float
    omega: float
    restitution: float
    friction: Any

    @property
    def period(self):
        return 2 * np.pi / self.omega

    def bodies(self):
        return {"capsule": ss.Body(self.capsule), "mass": ss.Body(self.mass, force=lambda t, x, v: self.push * sin(self.omega * t))}

    def contacts(self):
        return {"foot": ss.Contact("capsule", self.friction, load=1.0)}

    def links(self):
        return {("mass", "capsule"): ss.Spring(50.0, 0.02)}

    def stops(self):
        return {("mass", "capsule"): ss.Stop(gap=0.005, restitution=self.restitution)}


SLIPS = ss.Coulomb(0.1, 0.2, f_plus=0.12, f_minus=0.25)
BELT = ss.BlockOnBelt(mass=2.0, stiffness=2.0, speed=0.1, friction=ss.Stribeck(0.3, 0.3, f_plus=0.4, f_minus=0.4, v_s=0.05))
MACHINES = {
    "robot": ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4, law="coulomb-static"),
    "lugre": ss.presets.piezo_rig(tilt_deg=1.7, amplitude=5.56e-4),
    "belt": BELT,
    "chain": ss.Chain.example(),
    "hammer": Hammer(0.1, 0.05, 0.4, 30.0, 0.6, SLIPS),
    "servo": ss.presets.servo(sample=0.01),
}
SAMPLES = 40


@pytest.fixture(scope="module")
def unit_of(tmp_path_factory):
    """A new instance of the unit of one of the machines, which is compiled once, with warnings as errors."""
    made = {}

    def unit(name, **kinds):
        if name not in made:
            folder = tmp_path_factory.mktemp(name)
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(building, "FLAGS", (*building.FLAGS, *WARNING))
                made[name] = ss.export_fmu(MACHINES[name], folder, binary=True).path, folder
        return Unit(*made[name], **kinds)

    return unit


def lasting(machine, periods):
    return ss.solve(machine, duration=float(periods)) if machine.period is None else ss.solve(machine, periods=periods)


@needs_cc
@each_row(("name", "periods"), [("robot", 6), ("lugre", 6), ("belt", 20), ("chain", 6), ("hammer", 8), ("servo", 6)])
def test_a_unit_goes_where_solve_goes_with_the_same_events_also_from_states_that_were_saved(name, periods, unit_of):
    machine, run = MACHINES[name], lasting(MACHINES[name], periods)
    bodies = [] if machine.__class__.__name__ in ("Robot", "BlockOnBelt") else list(run.bodies)
    names = [f"{letter}.{body}" for body in bodies for letter in "xv"] or ["x", "v"]
    draws, end = random.Random(name), 0.999 * run.t[-1]
    unit, other = unit_of(name).start(), unit_of(name).start()
    ends = sorted(draws.uniform(0.0, end) for _ in range(SAMPLES))
    for instant in (*ends, end):
        before = unit.save()
        unit.step(instant - unit.t)
        there = unit.get(*names)
        for again in (unit, other):
            again.restore(before)
            again.step(instant - again.t)
            assert again.get(*names) == there, f"from the state that was saved at {before[1]}"
    at = run.at(unit.t) if not bodies else None
    wanted = [at["x"], at["v"]] if at else [np.interp(unit.t, *of) for body in bodies for of in _motion(run, body, unit.t)]
    tolerance = 1e-9 if name != "lugre" else 1e-5
    scale = np.max(np.abs(run.v))
    assert unit.get(*names) == pytest.approx(wanted, rel=tolerance, abs=tolerance * scale)
    assert unit.get("events") == [sum(event.t <= unit.t for event in run.events)]
    unit.close(), other.close()


def _motion(run, body, t):
    """Position and velocity of a body beside an instant, so close that they are straight."""
    at = run.at(t)
    number = list(run.bodies).index(body)
    return [([t, t + 1.0], [np.ravel(at[what])[number]] * 2) for what in ("x", "v")]


@needs_cc
@pytest.mark.slow
@each_row("name", [*with_bodies, "a row of blocks"])
def test_every_machine_goes_where_solve_goes(name, tmp_path, monkeypatch):
    given = row(20) if name == "a row of blocks" else with_bodies[name][0]
    monkeypatch.setattr(building, "FLAGS", (*building.FLAGS, *WARNING))
    made = ss.export_fmu(given, tmp_path)
    run, unit = lasting(given, 4), Unit(made.path, tmp_path).start()
    unit.step(0.997 * run.t[-1])
    for letter in "xv":
        outputs = [output for output in made.outputs if output.partition(".")[0] == letter]
        wanted, scale = run.at(unit.t)[letter], np.max(np.abs(getattr(run, letter)))
        found = unit.get(*outputs)
        assert (found if np.ndim(wanted) else found[:1]) == pytest.approx(np.atleast_1d(wanted).tolist(), rel=1e-5, abs=1e-5 * scale)
    assert unit.get("events") == [sum(event.t <= unit.t for event in run.events)]
    unit.close()


@needs_cc
def test_a_step_with_early_return_stops_at_each_event_of_solve(unit_of):
    run, unit, met = lasting(BELT, 20), unit_of("belt", stops=True).start(), []
    while unit.t < 19.9:
        if unit.step(19.95 - unit.t):
            met.append(unit.t)
    assert met == pytest.approx([event.t for event in run.events], abs=1e-9) and len(met) > 4
    unit.close()


@needs_cc
def test_inputs_and_parameters_act_as_those_of_a_simulation(unit_of):
    unit, sim = unit_of("robot").start(), ss.simulation(MACHINES["robot"])
    T = MACHINES["robot"].period
    for k, force in enumerate((0.0, 0.05, -0.02, 0.1)):
        unit.set("force", force)
        unit.set("friction.mu_plus", 0.15 + 0.01 * k)
        for size in (0.3 * T, 1.1 * T):
            unit.step(size)
            state = sim.step(size, inputs={"force": force, "friction.mu_plus": 0.15 + 0.01 * k})
            assert unit.get("x", "v") == pytest.approx([state["x"], state["v"]], rel=1e-12, abs=1e-15)
    unit.set("drive.omega", 200.0, good=False)
    assert unit.told[-1] == "a fixed parameter is set after the initialization"
    unit.close()


@needs_cc
def test_two_units_that_a_spring_couples_come_to_the_machine_of_both_as_their_steps_shorten(tmp_path):
    chain = ss.Chain.example().replace(phases=(0.0, 0.0))
    chain = chain.replace({"modules.1.drive.amplitude": 1.7 * chain.modules[0].drive.amplitude})
    path, link, T = ss.export_fmu(chain.modules[0], tmp_path).path, chain.link, chain.period
    run, errors = ss.solve(chain, periods=2), []
    for steps in (200, 400):
        units = [Unit(path, tmp_path) for _ in chain.modules]
        for unit, module in zip(units, chain.modules, strict=True):
            unit.set("drive.amplitude", module.drive.amplitude)
            unit.start()
        for _ in range(2 * steps):
            (x1, v1), (x2, v2) = (unit.get("x", "v") for unit in units)
            pull = link.stiffness * (x1 - x2 - link.length) + link.damping * (v1 - v2)
            for unit, side in zip(units, (-1.0, 1.0), strict=True):
                unit.set("force", side * pull)
                unit.step(T / steps)
        errors.append(max(abs(unit.get("x")[0] - x) for unit, x in zip(units, run.x[-1], strict=True)))
        [unit.close() for unit in units]
    assert errors[0] < 1e-2 * np.ptp(run.x) and errors[1] == pytest.approx(0.5 * errors[0], rel=0.15)  # of first order


@needs_cc
def test_derivatives_along_directions_are_those_of_the_rates(unit_of):
    unit = unit_of("belt", exchange=True).start(x=0.3, v=0.02)
    unit.update()
    x = unit.many("GetContinuousStates", 2)
    at, rates = {"state.v": 0, "state.x": 1}, ["der(state.v)", "der(state.x)", "friction_force"]
    for name, i in at.items():
        shifted = [[x[j] + side * 1e-6 * (i == j) for j in range(2)] for side in (1, -1)]
        ends = [(unit.put(0.0, each), unit.get(*rates))[1] for each in shifted]
        numeric = (np.array(ends[0]) - ends[1]) / 2e-6
        unit.put(0.0, x)
        assert unit.derivative(rates, name) == pytest.approx(numeric.tolist(), rel=1e-6, abs=1e-7)
    assert unit.derivative(["der(state.v)", "friction_force"], "force") == pytest.approx([0.5, 0.0], abs=1e-12)
    unit.close()


@needs_cc
@each_row(("name", "end"), [("belt", 8.0), ("hammer", 0.5)])
def test_model_exchange_with_a_plain_integrator_meets_the_same_events(name, end, unit_of):
    run, unit = lasting(MACHINES[name], 8), unit_of(name, exchange=True).start()
    unit.call("EnterContinuousTimeMode")
    t, known, h = 0.0, unit.update(), end / 2000
    x = unit.many("GetContinuousStates", unit.states)

    def moved(size):
        k1 = np.array(unit.rates(t, x))
        k2 = np.array(unit.rates(t + size / 2, list(x + size / 2 * k1)))
        k3 = np.array(unit.rates(t + size / 2, list(x + size / 2 * k2)))
        k4 = np.array(unit.rates(t + size, list(x + size * k3)))
        new = x + size / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        unit.put(t + size, list(new))
        return new

    while t < end - 1e-12:
        size = min(h, known - t, end - t)
        x, before = np.array(x), unit.indicators
        new = moved(size)
        if any(a >= 0.0 > b for a, b in zip(before, unit.indicators, strict=True)):
            low, high = 0.0, size
            for _ in range(50):
                middle = 0.5 * (low + high)
                moved(middle)
                low, high = (low, middle) if any(a >= 0.0 > b for a, b in zip(before, unit.indicators, strict=True)) else (middle, high)
            size, new = high, moved(high)
        t, x = t + size, new
        known = unit.update()
        x = unit.many("GetContinuousStates", unit.states)
    body = "" if name == "belt" else ".mass"
    wanted = run.at(end)["x"] if name == "belt" else run.at(end)["x"][1]
    assert unit.get(f"x{body}") == pytest.approx([wanted], rel=1e-6)
    assert unit.get("events") == [sum(event.t <= end for event in run.events)]
    unit.close()


def test_a_unit_of_sources_is_the_same_bytes_each_time_and_names_its_numbers(tmp_path):
    first, second = (ss.export_fmu(BELT, tmp_path / f"{k}.fmu", inputs=["speed"], outputs=["v"], binary=False) for k in range(2))
    assert first.path.read_bytes() == second.path.read_bytes() and first.platform is None
    assert first.inputs == ("speed",) and first.outputs == ("v", "mode", "events")
    with zipfile.ZipFile(first.path) as archive:
        assert {"modelDescription.xml", "sources/buildDescription.xml", "sources/fmu.c", "sources/machine.h"} <= {*archive.namelist()}
        text = archive.read("modelDescription.xml").decode()
    assert 'name="stiffness" valueReference="2" description="stiffness of the spring" causality="parameter"' in text
    assert '<Unit name="N/m">' in text and '<BaseUnit kg="1" s="-2" />' in text


@each_row(
    ("arguments", "told"),
    [
        ((BELT.replace(speed=np.array([0.1, 0.2])),), "is a batch of shape"),
        ((ss.LuGre.example(),), "is not a machine"),
        ((ss.SwitchingFlow(lambda t, y: (y[1], -9.81)),), "rates, switches and resets of its own in their place; write it as a machine"),
        ((BELT, {"inputs": ["sped"]}), "there is no input 'sped'; did you mean 'speed'?"),
        ((BELT, {"inputs": "speed"}), 'type for example inputs=["force"]'),
        ((BELT, {"outputs": ["w"]}), "there is no output 'w'"),
        ((MACHINES["robot"], {"inputs": ["drive.omega"]}), "sets the period of the machine"),
        ((BELT, {"name": "my belt"}), "allowed is a name of letters, digits and _"),
        ((MACHINES["robot"].replace(friction=ss.friction.Bristle.example()),), "the Robot has Bristle friction, which is random"),
    ],
    ids=range(9),
)
def test_what_cannot_be_exported_says_why(arguments, told, tmp_path):
    machine, more = (*arguments, {})[:2]
    with pytest.raises(ss.InputError) as raised:
        ss.export_fmu(machine, tmp_path / "none.fmu", binary=False, **more)
    assert told in str(raised.value) and str(raised.value).startswith("export_fmu")


@needs_cc
def test_fmpy_finds_nothing_wrong_and_runs_a_unit(tmp_path):
    fmpy = pytest.importorskip("fmpy", reason="fmpy is not installed; type pip install fmpy")
    from fmpy.validation import validate_fmu

    made = ss.export_fmu(BELT, tmp_path)
    assert validate_fmu(str(made.path)) == []
    runs = [
        fmpy.simulate_fmu(str(made.path), fmi_type=kind, stop_time=4.0, output_interval=0.1, relative_tolerance=1e-9, output=["x"])
        for kind in ("CoSimulation", "ModelExchange")
    ]
    assert runs[0]["x"][-1] == pytest.approx(runs[1]["x"][-1], rel=1e-6)
